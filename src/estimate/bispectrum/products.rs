//! Sums over a tile of cells of the products of three fields.
//!
//! The fields of a tile lie one after another in one array. Every sum is kept as lanes: lane l adds the cells l, l + L, l + 2 L ... in this
//! order, each as (D_i D_j) D_k with two roundings; the lanes are added in f64 when a stretch of tiles is done. A processor without
//! vectors takes the same steps, so the bits are the same.

use super::plan::{Block, COLUMNS, ROWS};
use crate::real::Real;
use crate::within::Within;

/// Lanes of f32: a 256-bit register.
pub(super) const LANES_F32: usize = 8;

/// Lanes of f64.
pub(super) const LANES_F64: usize = 4;

/// Lanes of a type.
pub(super) const fn lanes<T: Real>() -> usize {
    if size_of::<T>() == size_of::<f32>() { LANES_F32 } else { LANES_F64 }
}

/// Fields of one tile.
#[derive(Clone, Copy)]
pub(super) struct Tile<'a, T> {
    /// D_i and D_k; field s begins at s `apart`.
    pub(super) outer: &'a [T],
    /// D_j, perhaps weighted; laid out likewise.
    pub(super) middle: &'a [T],
    /// From one field to the next.
    pub(super) apart: usize,
    /// Where the tile begins in each field.
    pub(super) start: usize,
    /// Its cells: a multiple of the lanes.
    pub(super) length: usize,
}

impl<'a, T: Real> Tile<'a, T> {
    fn vectors<const L: usize>(&self, fields: &'a [T], shell: u32) -> &'a [[T; L]] {
        let start = shell as usize * self.apart + self.start;
        fields.part(start..start + self.length).as_chunks().0
    }
}

/// Adds a tile's sums to the lanes of each block. `sums`: [`lanes`] values for each sum of the plan from number `first` on.
#[inline(always)]
pub(super) fn add_tile<T: Real>(sums: &mut [T], first: usize, blocks: &[Block], tile: &Tile<'_, T>) {
    if lanes::<T>() == LANES_F32 {
        add_blocks::<T, LANES_F32>(sums.as_chunks_mut().0, first, blocks, tile);
    } else {
        add_blocks::<T, LANES_F64>(sums.as_chunks_mut().0, first, blocks, tile);
    }
}

#[inline(always)]
fn add_blocks<T: Real, const L: usize>(
    sums: &mut [[T; L]],
    first: usize,
    blocks: &[Block],
    tile: &Tile<'_, T>,
) {
    for block in blocks {
        let sums = sums.part_mut(block.first as usize - first..);
        match block.shape {
            [1, 1] => add_block::<T, L, 1, 1>(sums, block, tile),
            [1, 2] => add_block::<T, L, 1, 2>(sums, block, tile),
            [1, 3] => add_block::<T, L, 1, 3>(sums, block, tile),
            [1, 4] => add_block::<T, L, 1, 4>(sums, block, tile),
            [1, 5] => add_block::<T, L, 1, 5>(sums, block, tile),
            [1, _] => add_block::<T, L, 1, COLUMNS>(sums, block, tile),
            [_, 1] => add_block::<T, L, ROWS, 1>(sums, block, tile),
            [_, 2] => add_block::<T, L, ROWS, 2>(sums, block, tile),
            [_, 3] => add_block::<T, L, ROWS, 3>(sums, block, tile),
            [_, 4] => add_block::<T, L, ROWS, 4>(sums, block, tile),
            [_, 5] => add_block::<T, L, ROWS, 5>(sums, block, tile),
            [_, _] => add_block::<T, L, ROWS, COLUMNS>(sums, block, tile),
        }
    }
}

/// Lanes of sum `at`.
#[inline(always)]
fn read<T: Real, const L: usize>(sums: &[[T; L]], at: usize) -> [T; L] {
    sums.get(at).copied().unwrap_or([T::ZERO; L])
}

#[inline(always)]
fn add_block<T: Real, const L: usize, const R: usize, const C: usize>(
    sums: &mut [[T; L]],
    block: &Block,
    tile: &Tile<'_, T>,
) {
    let middle = tile.vectors::<L>(tile.middle, block.middle);
    let rows: [_; R] = core::array::from_fn(|r| tile.vectors::<L>(tile.outer, block.rows[r]));
    let columns: [_; C] = core::array::from_fn(|c| tile.vectors::<L>(tile.outer, block.columns[c]));
    let mut total: [[[T; L]; C]; R] =
        core::array::from_fn(|r| core::array::from_fn(|c| read(sums, r * C + c)));
    for v in 0..middle.len() {
        let mut pair = [[T::ZERO; L]; R];
        for r in 0..R {
            // SAFETY: all fields of a tile have the length of `middle`.
            let field = unsafe { rows[r].get_unchecked(v) };
            for l in 0..L {
                pair[r][l] = field[l] * middle[v][l];
            }
        }
        for c in 0..C {
            // SAFETY: as above.
            let field = unsafe { columns[c].get_unchecked(v) };
            for r in 0..R {
                for l in 0..L {
                    total[r][c][l] += pair[r][l] * field[l];
                }
            }
        }
    }
    for r in 0..R {
        for c in 0..C {
            sums.put(r * C + c, total[r][c]);
        }
    }
}
