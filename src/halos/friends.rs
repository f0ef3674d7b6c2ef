//! Cells so small that all particles in one are friends, and blocks of them so large that friends are in one block or in neighbours.
//!
//! With a side below l/sqrt(3) no two points of a cell are farther apart than l. A block is s x s x s cells, s = 2 where its side is then at
//! least l, else 3. Occupied cells are kept in a list in order of their key, block before cell, so that memory does not depend on L/l.

use super::periodic::home;
use crate::pm::columns::Positions;
use crate::real::Real;
use crate::status::{Error, Result};
use crate::within::Within;

/// Coordinates computed at a time.
pub(super) const BLOCK: usize = 64;

/// What rounding may do to a coordinate in units of cells is far below this.
const MARGIN: f64 = 1e-6;

/// Blocks on a side have so many bits at most.
const MOST_BITS: u32 = 20;

#[derive(Clone, Copy, Debug)]
pub(super) struct Friends {
    pub(super) box_size: f64,
    /// l^2.
    pub(super) length_squared: f64,
    /// Blocks on a side of the box.
    pub(super) blocks: u64,
    /// Cells on a side of a block: 2 or 3.
    pub(super) cells: u64,
    /// Bits of a block's number on each axis, and of a cell's number in its block.
    pub(super) bits: u32,
    pub(super) cell_bits: u32,
    cells_per_length: f64,
    last: f64,
}

impl Friends {
    /// Of a checked box. `NotFinite`; `Range` unless L/10^6 <= l <= L/2.
    pub(super) fn new(box_size: f64, length: f64) -> Result<Self> {
        if !length.is_finite() {
            return Err(Error::NotFinite);
        }
        let lengths = box_size / length;
        if !(2.0..=1e6).contains(&lengths) {
            return Err(Error::Range);
        }
        // Two cells: no more than l/sqrt(3) each.
        let two = libm::ceil(libm::sqrt(0.75) * lengths * (1.0 + MARGIN));
        let wide = lengths / (1.0 + MARGIN);
        // With three blocks on a side all are neighbours.
        let (blocks, cells) = if two <= 3.0 || two <= wide { (two, 2.0) } else { (libm::floor(wide), 3.0) };
        debug_assert!(blocks * cells >= libm::sqrt(3.0) * lengths);
        let bits = u64::BITS - (blocks as u64 - 1).leading_zeros();
        debug_assert!(bits <= MOST_BITS);
        Ok(Self {
            box_size,
            length_squared: length * length,
            blocks: blocks as u64,
            cells: cells as u64,
            bits,
            cell_bits: if cells == 2.0 { 3 } else { 6 },
            cells_per_length: blocks * cells / box_size,
            last: blocks * cells - 1.0,
        })
    }

    /// Keys are below this.
    pub(super) fn bound(&self) -> u64 {
        self.blocks << (2 * self.bits + self.cell_bits)
    }

    /// The block of a cell, as a key.
    #[inline(always)]
    pub(super) fn block(&self, cell: u64) -> u64 {
        cell >> self.cell_bits
    }

    /// Number of a block on each axis.
    #[inline(always)]
    pub(super) fn numbers(&self, block: u64) -> [u64; 3] {
        let mask = (1 << self.bits) - 1;
        [block >> (2 * self.bits), block >> self.bits & mask, block & mask]
    }

    /// The key of a block.
    #[inline(always)]
    pub(super) fn of_numbers(&self, [x, y, z]: [u64; 3]) -> u64 {
        ((x << self.bits) | y) << self.bits | z
    }

    /// Keys of the cells of up to [`BLOCK`] particles from `first` on. Returns whether all coordinates are finite.
    #[inline(always)]
    pub(super) fn keys<T: Real>(&self, positions: &Positions<'_, T>, first: usize, keys: &mut [u64]) -> bool {
        let mut v = [[T::ZERO; BLOCK]; 3];
        debug_assert!(keys.len() <= BLOCK && first + keys.len() <= positions.len());
        // SAFETY: the particles exist, and the arrays have room for them.
        unsafe { positions.load_all(first, keys.len(), 0, &mut v) };
        let mut cells = [[0; BLOCK]; 3];
        for axis in 0..3 {
            let mut inside = true;
            for i in 0..BLOCK {
                let x = v[axis][i].to_f64();
                inside &= (x >= 0.0) & (x < self.box_size);
            }
            if !inside {
                if v[axis].iter().any(|x| !x.is_finite()) {
                    return false;
                }
                v[axis].iter_mut().for_each(|x| *x = home(*x, self.box_size));
            }
            for i in 0..BLOCK {
                let cell = (v[axis][i].to_f64() * self.cells_per_length).min(self.last);
                // SAFETY: at home, so 0 <= cell <= last < 2^22.
                cells[axis][i] = unsafe { cell.split() }.0 as u32;
            }
        }
        if self.cells == 2 {
            self.join::<2>(&cells, keys);
        } else {
            self.join::<3>(&cells, keys);
        }
        true
    }

    /// Block and cell of each particle, from the numbers of its cell in the box.
    #[inline(always)]
    fn join<const S: u32>(&self, cells: &[[u32; BLOCK]; 3], keys: &mut [u64]) {
        let each = self.cell_bits / 3;
        let mut all = [0; BLOCK];
        for i in 0..BLOCK {
            let block = [0, 1, 2].map(|axis| cells[axis][i] / S);
            let cell = [0, 1, 2].map(|axis| cells[axis][i] % S);
            let block = self.of_numbers(block.map(u64::from));
            let [x, y, z] = cell;
            all[i] = block << self.cell_bits | u64::from(((x << each) | y) << each | z);
        }
        keys.copy(all.part(..keys.len()));
    }
}
