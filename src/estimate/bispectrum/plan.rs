//! How a list of triangles is cut into blocks that fill the registers.
//!
//! For a pair of triangles' lower shells (i, j) and (i', j), each cell's products D_i D_j and D_i' D_j meet up to six D_k: twelve sums in
//! registers for nine loads. A block is these two rows and up to six columns.

use super::triangles::{Triangle, sorted};
use crate::scratch::Plain;
use crate::scratch::sealed::Sealed;
use crate::sort::sort_by_key;
use crate::within::Within;

/// Rows of a block.
pub(super) const ROWS: usize = 2;

/// Columns of a block: rows, columns, their products and one temporary are all that sixteen registers hold.
pub(super) const COLUMNS: usize = 6;

/// The sums over D_i D_j D_k for all i of `rows` and k of `columns`.
#[derive(Clone, Copy)]
#[repr(C)]
pub(super) struct Block {
    /// Number of its first sum; sums are numbered row by row.
    pub(super) first: u32,
    /// j.
    pub(super) middle: u32,
    /// Rows and columns in use.
    pub(super) shape: [u32; 2],
    pub(super) rows: [u32; ROWS],
    pub(super) columns: [u32; COLUMNS],
}

// Integers without padding: any bits are a block.
impl Sealed for Block {}
impl Plain for Block {}

/// The blocks of a list, and where each triangle's sum is.
#[derive(Clone, Copy)]
pub(super) struct Plan<'a> {
    pub(super) blocks: &'a [Block],
    /// Sum of each triangle of the order.
    pub(super) slots: &'a [u32],
    /// Sums of all blocks: at most two for each triangle.
    pub(super) sums: usize,
}

/// Sorts `order`, numbers of triangles, and plans their blocks.
///
/// `blocks` and `slots` are at least as long as `order`.
pub(super) fn plan<'a>(
    blocks: &'a mut [Block],
    slots: &'a mut [u32],
    order: &mut [u32],
    triangles: &[Triangle],
) -> Plan<'a> {
    let key = |t: u32| {
        let [i, j, k] = sorted(triangles.at(t as usize));
        (j, i, k)
    };
    sort_by_key(order, |&t| (key(t), t));
    let order = &*order;
    // The end of the row (i, j) that begins at `start`.
    let row_end = |start: usize| {
        let (j, i, _) = key(order.at(start));
        order.part(start..).partition_point(|&t| (key(t).0, key(t).1) == (j, i)) + start
    };
    let (mut used, mut sums, mut at) = (0, 0, 0);
    while at < order.len() {
        let (j, i, _) = key(order.at(at));
        let second = row_end(at);
        let paired = order.get(second).is_some_and(|&t| key(t).0 == j);
        let end = if paired { row_end(second) } else { second };
        let rows = [i, if paired { key(order.at(second)).1 } else { i }];
        let height = if paired { 2 } else { 1 };
        // The union of both rows' columns, in increasing order.
        let columns = || {
            let mut last = None;
            core::iter::from_fn(move || {
                let next = |row: core::ops::Range<usize>| {
                    let row = order.part(row);
                    let skip = row.partition_point(|&t| last.is_some_and(|last| key(t).2 <= last));
                    row.get(skip).map(|&t| key(t).2)
                };
                let (a, b) = (next(at..second), next(second..end));
                last = Some(a.unwrap_or(u32::MAX).min(b.unwrap_or(u32::MAX)));
                if a.is_none() && b.is_none() { None } else { last }
            })
        };
        // Groups of nearly equal width.
        let width = columns().count();
        let groups = width.div_ceil(COLUMNS);
        let mut union = columns();
        for group in 0..groups {
            let count = width / groups + usize::from(group < width % groups);
            let mut block = Block {
                first: sums as u32,
                middle: j,
                shape: [height, count as u32],
                rows,
                columns: [0; COLUMNS],
            };
            for (place, k) in block.columns.iter_mut().take(count).zip(union.by_ref()) {
                *place = k;
            }
            for (row, range) in [at..second, second..end].into_iter().enumerate() {
                for (slot, &t) in slots.part_mut(range.clone()).iter_mut().zip(order.part(range)) {
                    let column = block.columns.iter().take(count).position(|&k| k == key(t).2);
                    if let Some(column) = column {
                        *slot = (sums + row * count + column) as u32;
                    }
                }
            }
            if let Some(place) = blocks.get_mut(used) {
                *place = block;
            }
            used += 1;
            sums += height as usize * count;
        }
        at = end;
    }
    Plan { blocks: blocks.part(..used), slots: slots.part(..order.len()), sums }
}
