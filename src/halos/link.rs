//! Joining cells that hold friends.
//!
//! First the cells of each block are joined among themselves, then each block with the 13 neighbours that follow it. Neighbours in the list of
//! cells are found by five fingers that move forward as the sweep does; blocks at the edge of the box are looked up instead. Most pairs of
//! cells in dense places are of one set already and cost no distances.

use core::ops::Range;

use super::friends::Friends;
use super::periodic::{distance_squared, span};
use super::sets::Sets;
use crate::exec::Exec;
use crate::real::Real;
use crate::status::Result;
use crate::within::Within;

/// Cells that one chunk sweeps.
const CHUNK: usize = 1 << 12;

/// Pairs of particles from which on boxes around the two cells' particles are compared first.
const MANY: usize = 64;

/// Rows of blocks that follow a row, dx and dy; each is met in three blocks, z - 1 to z + 1.
const ROWS: [[i64; 2]; 4] = [[0, 1], [1, -1], [1, 0], [1, 1]];

/// Occupied cells in order of their key, their particles, and the sets that they are joined to.
pub(super) struct Cells<'a, T> {
    pub(super) friends: &'a Friends,
    pub(super) keys: &'a [u64],
    /// First particle of each cell, and the end.
    pub(super) starts: &'a [u32],
    pub(super) places: &'a [[T; 3]],
    pub(super) sets: &'a Sets<'a>,
}

impl<T: Real> Cells<'_, T> {
    /// Joins all cells that hold friends.
    pub(super) fn link(&self, exec: &dyn Exec) -> Result<()> {
        let chunks = self.keys.len().div_ceil(CHUNK);
        exec.parallel_for(chunks, &|chunk| {
            for block in self.blocks(chunk) {
                for a in block.clone() {
                    for b in a + 1..block.end {
                        self.link_cells(a, b);
                    }
                }
            }
        })?;
        exec.parallel_for(chunks, &|chunk| self.sweep(chunk))
    }

    fn block_of(&self, cell: usize) -> u64 {
        self.friends.block(self.keys.at(cell))
    }

    /// The first cell from `at` on that is in another block than the one before it.
    fn border(&self, mut at: usize) -> usize {
        while at > 0 && at < self.keys.len() && self.block_of(at) == self.block_of(at - 1) {
            at += 1;
        }
        at.min(self.keys.len())
    }

    /// Blocks that begin in a chunk: the ranges of their cells.
    fn blocks(&self, chunk: usize) -> impl Iterator<Item = Range<usize>> {
        let end = self.border((chunk + 1) * CHUNK);
        let mut at = self.border(chunk * CHUNK);
        core::iter::from_fn(move || {
            (at < end).then(|| {
                let first = at;
                at = self.border(at + 1);
                first..at
            })
        })
    }

    /// Joins the blocks of a chunk with those that follow.
    fn sweep(&self, chunk: usize) {
        let mut fingers = [None; ROWS.len()];
        let last = self.friends.blocks - 1;
        for block in self.blocks(chunk) {
            let key = self.block_of(block.start);
            let numbers = self.friends.numbers(key);
            if numbers.iter().any(|&number| number == 0 || number == last) {
                self.link_at_edge(&block, numbers);
                continue;
            }
            if block.end < self.keys.len() && self.block_of(block.end) == key + 1 {
                self.link_blocks(&block, block.end);
            }
            for ([dx, dy], finger) in ROWS.into_iter().zip(&mut fingers) {
                let shift = (dx << (2 * self.friends.bits)) + (dy << self.friends.bits);
                let middle = key.wrapping_add_signed(shift);
                let mut at = finger.unwrap_or_else(|| self.find(middle - 1));
                while at < self.keys.len() && self.block_of(at) < middle - 1 {
                    at += 1;
                }
                *finger = Some(at);
                self.link_row(&block, at, middle + 1);
            }
        }
    }

    /// Joins a block with those from cell `at` up to block `last`.
    fn link_row(&self, block: &Range<usize>, mut at: usize, last: u64) {
        while at < self.keys.len() && self.block_of(at) <= last {
            at = self.link_blocks(block, at);
        }
    }

    /// The first cell of a block, or what would follow it.
    fn find(&self, block: u64) -> usize {
        self.keys.partition_point(|&key| self.friends.block(key) < block)
    }

    /// Joins a block with those that follow it, over the edge of the box. In a small box a pair may be met twice.
    fn link_at_edge(&self, block: &Range<usize>, numbers: [u64; 3]) {
        let n = self.friends.blocks;
        let step =
            |number: u64, by: i64| (number + n).wrapping_add_signed(by).checked_rem(n).unwrap_or_default();
        let meet = |dx, dy, dz| {
            let [x, y, z] = numbers;
            let other = self.friends.of_numbers([step(x, dx), step(y, dy), step(z, dz)]);
            let at = self.find(other);
            if at != block.start && at < self.keys.len() && self.block_of(at) == other {
                self.link_blocks(block, at);
            }
        };
        meet(0, 0, 1);
        for [dx, dy] in ROWS {
            for dz in -1..=1 {
                meet(dx, dy, dz);
            }
        }
    }

    /// Joins the cells of a block with those of the block that begins at cell `start`; returns where that ends.
    fn link_blocks(&self, block: &Range<usize>, start: usize) -> usize {
        let end = self.border(start + 1);
        let other = start..end;
        if self.is_one_set(block) && self.is_one_set(&other) {
            let (a, b) = (block.start, other.start);
            if self.sets.root(a as u32) == self.sets.root(b as u32) {
                return end;
            }
            for a in block.clone() {
                for b in other.clone() {
                    if self.are_friends(a, b) {
                        self.sets.join(a as u32, b as u32);
                        return end;
                    }
                }
            }
        } else {
            for a in block.clone() {
                for b in other.clone() {
                    self.link_cells(a, b);
                }
            }
        }
        end
    }

    /// Whether the cells are seen to be of one set at a glance.
    fn is_one_set(&self, cells: &Range<usize>) -> bool {
        let first = self.sets.parent(cells.start as u32);
        cells.clone().all(|cell| self.sets.parent(cell as u32) == first)
    }

    #[inline]
    fn link_cells(&self, a: usize, b: usize) {
        if self.sets.root(a as u32) != self.sets.root(b as u32) && self.are_friends(a, b) {
            self.sets.join(a as u32, b as u32);
        }
    }

    fn places(&self, cell: usize) -> &[[T; 3]] {
        self.places.part(span(self.starts, cell))
    }

    /// Is any particle of one cell a friend of any of the other?
    #[inline]
    fn are_friends(&self, a: usize, b: usize) -> bool {
        let (a, b) = (self.places(a), self.places(b));
        if a.len() * b.len() > MANY {
            return self.far_cells_are_friends(a, b);
        }
        a.iter().any(|&a| self.is_friend_of_any(a, b))
    }

    #[inline]
    fn is_friend_of_any(&self, a: [T; 3], b: &[[T; 3]]) -> bool {
        let Friends { box_size, length_squared, .. } = *self.friends;
        b.iter().any(|&b| distance_squared(a, b, box_size) <= length_squared)
    }

    /// The same where there are many pairs: only particles that reach the box around the others are compared one by one.
    #[inline(never)]
    fn far_cells_are_friends(&self, a: &[[T; 3]], b: &[[T; 3]]) -> bool {
        let Friends { box_size, length_squared, .. } = *self.friends;
        let (of_a, of_b) = (Extent::of(a), Extent::of(b));
        if of_a.distance_squared(&of_b, box_size) > length_squared {
            return false;
        }
        a.iter().any(|&place| {
            Extent::of(&[place]).distance_squared(&of_b, box_size) <= length_squared
                && self.is_friend_of_any(place, b)
        })
    }
}

/// The box around some particles.
struct Extent {
    low: [f64; 3],
    high: [f64; 3],
}

impl Extent {
    fn of<T: Real>(places: &[[T; 3]]) -> Self {
        let mut low = places.at(0);
        let mut high = low;
        for place in places {
            for axis in 0..3 {
                low[axis] = if place[axis] < low[axis] { place[axis] } else { low[axis] };
                high[axis] = if place[axis] > high[axis] { place[axis] } else { high[axis] };
            }
        }
        Self { low: low.map(T::to_f64), high: high.map(T::to_f64) }
    }

    /// Not above the computed d^2 of any two particles: every step is the same or smaller, and rounding keeps order.
    fn distance_squared(&self, other: &Self, box_size: f64) -> f64 {
        let [x, y, z] = [0, 1, 2].map(|axis| {
            let least = (self.low[axis] - other.high[axis]).max(other.low[axis] - self.high[axis]).max(0.0);
            let most = (self.high[axis] - other.low[axis]).max(other.high[axis] - self.low[axis]);
            least.min(box_size - most)
        });
        (x * x + y * y) + z * z
    }
}
