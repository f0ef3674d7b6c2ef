//! The rows of a brick along axis 2, dealt out to pieces of the work.
//!
//! Rows (+-i, +-j) have the same |n|^2 and so the same bins: they are visited together where the brick has them.

use core::ops::Range;

use super::line::{Place, TOGETHER};
use crate::mesh::Brick;
use crate::within::Within;

/// The axis, 0 or 1, whose indices are dealt out to pieces: the outer one in memory.
pub(super) fn outer_axis(brick: &Brick) -> usize {
    usize::from(brick.stride()[1] > brick.stride()[0])
}

/// Indices on an axis whose negative is not in the brick or has a larger index: each stands for both.
pub(super) fn leaders(brick: &Brick, axis: usize) -> usize {
    let (low, high) = leader_ranges(brick, axis);
    low.len() + high.len()
}

/// They are two ranges: 0, 1, ..., n/2, and those beyond n - start.
fn leader_ranges(brick: &Brick, axis: usize) -> (Range<usize>, Range<usize>) {
    let (n, start) = (brick.n(), brick.start()[axis]);
    let end = start + brick.count()[axis];
    let low = start..end.min(n / 2 + 1).max(start);
    let high = (n - start + 1).max(n / 2 + 1).max(start);
    (low, high..end.max(high))
}

/// The rows along axis 2 of a brick, in pieces.
pub(super) struct Rows<'a> {
    pub(super) brick: &'a Brick,
    pub(super) axis: [f64; 3],
    pub(super) pieces: usize,
}

/// A row: i and j, where it lies in space and in memory.
#[derive(Clone, Copy)]
pub(super) struct Row {
    pub(super) place: Place,
    pub(super) index: [usize; 2],
    pub(super) offset: usize,
}

impl Rows<'_> {
    /// Calls `visit` for each set of rows (+-i, +-j) in the brick: 1, 2 or 4 of them.
    #[inline(always)]
    pub(super) fn for_each(&self, piece: usize, mut visit: impl FnMut(&[Row])) {
        let (n, start, stride) = (self.brick.n(), self.brick.start(), self.brick.stride());
        let outer = outer_axis(self.brick);
        let inner = 1 - outer;
        let row = |o: usize, i: usize| {
            let mut index = [0; 2];
            index.put(outer, o);
            index.put(inner, i);
            let [x, y] = index.map(|index| Brick::mode(n, index));
            let place = Place {
                square: (x * x + y * y) as u64,
                across: self.axis[0] * x as f64 + self.axis[1] * y as f64,
            };
            Row {
                place,
                index,
                offset: (o - start[outer]) * stride[outer] + (i - start[inner]) * stride[inner],
            }
        };
        let (low, high) = leader_ranges(self.brick, outer);
        let leaders = low.len() + high.len();
        // The product fits: there are at most 64 pieces.
        let cut = |piece: usize| (piece * leaders).checked_div(self.pieces).unwrap_or(0);
        for o in cut(piece)..cut(piece + 1) {
            let o = if o < low.len() { low.start + o } else { high.start + (o - low.len()) };
            let (inner_low, inner_high) = leader_ranges(self.brick, inner);
            for i in inner_low.chain(inner_high) {
                let (os, is) = (self.signs(outer, o), self.signs(inner, i));
                let mut group = [row(o, i); TOGETHER];
                let mut count = 0;
                for &o in os.iter().flatten() {
                    for &i in is.iter().flatten() {
                        group.put(count, row(o, i));
                        count += 1;
                    }
                }
                visit(group.part(..count));
            }
        }
    }

    /// An index, and that of the negative mode number where the brick has it too.
    #[inline(always)]
    fn signs(&self, axis: usize, index: usize) -> [Option<usize>; 2] {
        let (n, start) = (self.brick.n(), self.brick.start()[axis]);
        let other = n - index;
        let apart = index > 0 && other != index;
        let inside = (start..start + self.brick.count()[axis]).contains(&other);
        [Some(index), (apart && inside).then_some(other)]
    }
}
