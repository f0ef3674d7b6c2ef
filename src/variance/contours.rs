//! Contours of a function on a grid, by marching squares (Lorensen & Cline 1987, in two dimensions).

use super::check::{finite, same_length};
use crate::status::{Error, Result};
use crate::within::Within;

/// The line of one level, as straight segments (x0, y0, x1, y1) in the grid's values, each with higher values to the same side.
///
/// `values`: as many rows as the first parameter has points, of as many values as the second; x is the first parameter, y the second, of uniform steps over their ranges. A segment crosses one cell;
/// its ends are interpolated on the cell's edges, to second order in the step, so that neighbours meet. Where a cell has two ways, the mean of its corners decides.
/// Returns how many segments there are; `segments` may be empty to count them, and is untouched if it is too short for all.
///
/// # Errors
/// `Length` for a grid of another size, or segments fewer than there are and not none, `NotFinite`, `Range` for fewer than two points, an empty range, or
/// differences that overflow.
///
/// # Example
/// ```
/// use fixpair::variance::contours::contours;
///
/// let (grid, range) = ([0.0, 0.0, 2.0, 2.0], [[0.0, 1.0], [0.0, 1.0]]); // 2 x 2 points
/// let mut segments = [[0.0; 4]];
/// assert_eq!(contours(&mut segments, &grid, [2, 2], range, 1.0)?, 1);
/// assert!((segments[0][0] - 0.5).abs() < 1e-12 && (segments[0][2] - 0.5).abs() < 1e-12); // x = 1/2
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn contours(
    segments: &mut [[f64; 4]],
    values: &[f64],
    points: [usize; 2],
    range: [[f64; 2]; 2],
    level: f64,
) -> Result<usize> {
    same_length(points[0].checked_mul(points[1]).ok_or(Error::Overflow)?, &[values.len()])?;
    finite(values)?;
    finite(range.as_flattened())?;
    finite(&[level])?;
    if points.iter().any(|&points| points < 2) || range.iter().any(|[low, high]| high <= low) {
        return Err(Error::Range);
    }
    let heights = values.iter().map(|value| value - level);
    let widths = range.iter().map(|[low, high]| high - low);
    if heights.chain(widths).any(|x| !x.is_finite()) {
        return Err(Error::Range);
    }
    let mut count = 0;
    each_segment(values, points, level, |_| count += 1);
    if segments.is_empty() {
        return Ok(count);
    }
    if segments.len() < count {
        return Err(Error::Length);
    }
    let value = |axis: usize, place: f64| {
        let [low, high] = range[axis];
        low + (high - low) * (place / (points[axis] - 1) as f64)
    };
    let mut next = segments.iter_mut();
    each_segment(values, points, level, |[x0, y0, x1, y1]| {
        if let Some(segment) = next.next() {
            *segment = [value(0, x0), value(1, y0), value(0, x1), value(1, y1)];
        }
    });
    Ok(count)
}

/// In units of points.
fn each_segment(values: &[f64], points: [usize; 2], level: f64, mut visit: impl FnMut([f64; 4])) {
    for i in 0..points[0] - 1 {
        for j in 0..points[1] - 1 {
            // Corners counterclockwise from (i, j), x to the right and y up.
            let corners = [[i, j], [i + 1, j], [i + 1, j + 1], [i, j + 1]];
            let height = corners.map(|[x, y]| values.at(x * points[1] + y) - level);
            let above = height.map(|h| h >= 0.0);
            let rises = |e: usize| !above[e % 4] && above[(e + 1) % 4];
            let falls = |e: usize| above[e % 4] && !above[(e + 1) % 4];
            // Where edge e, from corner e to the next, is crossed.
            let cross = |e: usize| -> [f64; 2] {
                let (a, b) = (e % 4, (e + 1) % 4);
                // From the lower corner, so that both cells of an edge get the same bits.
                let (low, high) = if corners[a] <= corners[b] { (a, b) } else { (b, a) };
                let t = height[low] / (height[low] - height[high]);
                [0, 1].map(|axis| {
                    let (from, to) = (corners[low][axis] as f64, corners[high][axis] as f64);
                    from + (to - from) * t
                })
            };
            let centre = height.iter().sum::<f64>() >= 0.0;
            let saddle = above[0] == above[2] && above[1] == above[3] && above[0] != above[1];
            // A segment enters where the walk about the cell goes up, and leaves where it goes down next.
            for up in (0..4).filter(|&e| rises(e)) {
                let downs = || (1..4).map(|step| (up + step) % 4).filter(|&e| falls(e));
                // Of a saddle with high ground in the middle, low corners are cut off.
                let down = if saddle && centre { downs().next_back() } else { downs().next() };
                if let Some(down) = down {
                    let ([x0, y0], [x1, y1]) = (cross(up), cross(down));
                    visit([x0, y0, x1, y1]);
                }
            }
        }
    }
}
