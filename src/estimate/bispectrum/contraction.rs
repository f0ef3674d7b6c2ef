//! Small matrix products.

use crate::within::Within;

/// Rows that are made at a time.
pub(super) const ROWS: usize = 4;

/// Columns that are made at a time: two registers of f64.
pub(super) const COLUMNS: usize = 8;

/// `out[r][c] = sum over k < depth of left[k][r] right[k][c]` for [`ROWS`] rows from `row` on and `columns` columns, rounded up to whole
/// [`COLUMNS`]. The terms are added in the order of k.
///
/// `out`: rows of `out_row` values, the first of them row `row`. `left`, `right`: rows of `left_row` and `right_row` values.
#[inline(always)]
pub(super) fn contract(
    out: &mut [f64],
    out_row: usize,
    left: &[f64],
    left_row: usize,
    row: usize,
    right: &[f64],
    right_row: usize,
    columns: usize,
    depth: usize,
) {
    for start in (0..columns).step_by(COLUMNS) {
        let mut total = [[0.0; COLUMNS]; ROWS];
        let lefts = left.chunks(left_row.max(1)).map(|left| left.part(row..).first_chunk::<ROWS>());
        let rights = right.chunks(right_row.max(1)).map(|right| right.part(start..).first_chunk::<COLUMNS>());
        for (left, right) in lefts.zip(rights).take(depth) {
            let (Some(left), Some(right)) = (left, right) else { continue };
            for r in 0..ROWS {
                for c in 0..COLUMNS {
                    total[r][c] += left[r] * right[c];
                }
            }
        }
        for (r, total) in total.iter().enumerate() {
            let at = r * out_row + start;
            out.part_mut(at..at + COLUMNS).copy(total);
        }
    }
}
