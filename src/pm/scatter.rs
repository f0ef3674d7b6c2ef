//! Blocks of particles on their way to the cells: coordinates, weights and offsets of all of them by lanes, then row by row into the mesh.

use super::cells::{Cells, prefetch};
use super::frame::BLOCK;
use super::window::spline;
use crate::real::Real;
use crate::within::Within;

/// Of so many particles, stretches are taken in turns. In lattice order particles follow each other from cell to cell, and a row that is read as a
/// vector while its last sum, one cell off, is still on its way to the cache stops the processor for that long.
const TURNS: usize = 4;
const STRETCH: usize = BLOCK / TURNS;

/// Particles from asking for cells to adding to them.
const AHEAD: usize = 8;

/// In place of the offset of a particle whose rows run over an edge.
const OVER: usize = usize::MAX;

/// Up to 64 particles of one tile, located.
pub(super) struct Block<T> {
    pub(super) count: usize,
    pub(super) v: [[T; BLOCK]; 3],
    pub(super) index: [[i32; BLOCK]; 3],
    pub(super) mass: [T; BLOCK],
}

impl<T: Real> Block<T> {
    /// No particles; each will have mass 1.
    #[inline(always)]
    pub(super) const fn new() -> Self {
        Self { count: 0, v: [[T::ZERO; BLOCK]; 3], index: [[0; BLOCK]; 3], mass: [T::ONE; BLOCK] }
    }

    /// Makes the places of missing particles repeat the first one, for they are located too.
    #[inline(always)]
    pub(super) fn repeat_first(&mut self) {
        if self.count < BLOCK {
            for place in self.v.iter_mut().chain([&mut self.mass]) {
                let first = place[0];
                place.part_mut(self.count..).fill(first);
            }
        }
    }

    /// Adds the particles to a mesh, with window order P; rows of Q >= P reals, the last ones with weight 0, make full vectors.
    ///
    /// `ahead`: ask for the cells of particles ahead, which are likely to be far from those of the last ones.
    ///
    /// # Safety
    /// Coordinates are in [0, n), also those past `count`, indices inside the mesh, and no other thread touches their cells now.
    #[inline(always)]
    pub(super) unsafe fn add<const P: usize, const Q: usize>(
        &self,
        cells: &Cells,
        mesh: *mut T,
        ahead: bool,
    ) {
        let (mut along_x, mut along_y) = ([[T::ZERO; BLOCK]; P], [[T::ZERO; BLOCK]; P]);
        let mut along_z = [[T::ZERO; Q]; BLOCK];
        for i in 0..BLOCK {
            // SAFETY: in [0, n) (caller), and n is an i32.
            let f = [0, 1, 2].map(|axis| unsafe { self.v[axis][i].split() }.1);
            let (x, y, z) = (spline::<T, P>(f[0]), spline::<T, P>(f[1]), spline::<T, P>(f[2]));
            for k in 0..P {
                along_x[k][i] = self.mass[i] * x[k];
                along_y[k][i] = y[k];
            }
            along_z[i].copy_from_slice(&z[..Q]);
        }
        let mut start = [OVER; BLOCK];
        let last = cells.last_rows::<P, Q>();
        for i in 0..BLOCK {
            let over = (0..3).fold(false, |over, axis| over | (self.index[axis][i] > last[axis]));
            // All bits set, or none.
            start[i] = cells.start(self.first(i)) | usize::from(over).wrapping_neg();
        }
        let steps = cells.steps();
        let count = self.count.min(BLOCK);
        let at = |turn: usize| if count == BLOCK { turn % TURNS * STRETCH + turn / TURNS } else { turn };
        for turn in 0..BLOCK {
            let i = at(turn);
            if i >= count {
                break;
            }
            if ahead {
                let later = mesh.wrapping_add(start.at(at((turn + AHEAD) % BLOCK)));
                for row in 0..P * P {
                    prefetch::<T, true>(later.wrapping_add(row / P * steps[0] + row % P * steps[1]));
                }
            }
            let x: [T; P] = core::array::from_fn(|k| along_x[k][i]);
            let y: [T; P] = core::array::from_fn(|k| along_y[k][i]);
            let z = &along_z[i];
            if start[i] == OVER {
                // SAFETY: as the caller says.
                unsafe { add_cells(cells, mesh, self.first(i), &x, &y, z) };
            } else {
                // SAFETY: `rows` says that they are inside the mesh, and this thread's alone (caller).
                unsafe { add_rows(mesh.add(start[i]), steps, &x, &y, z) };
            }
        }
    }

    #[inline(always)]
    fn first(&self, i: usize) -> [usize; 3] {
        [0, 1, 2].map(|axis| self.index[axis][i] as usize)
    }
}

/// Adds one particle, row by row.
///
/// # Safety
/// The rows may be written by this thread alone.
#[inline(always)]
unsafe fn add_rows<T: Real, const P: usize, const Q: usize>(
    start: *mut T,
    [x_step, y_step]: [usize; 2],
    x: &[T; P],
    y: &[T; P],
    z: &[T; Q],
) {
    let plane: [[T; Q]; P] = core::array::from_fn(|j| core::array::from_fn(|k| y[j] * z[k]));
    for i in 0..P {
        for j in 0..P {
            // SAFETY: as the caller says.
            let row = unsafe { &mut *start.add(i * x_step + j * y_step).cast::<[T; Q]>() };
            for k in 0..Q {
                row[k] += x[i] * plane[j][k];
            }
        }
    }
}

/// Adds one particle, cell by cell, in any layout and round any edge.
///
/// # Safety
/// The cells may be written by this thread alone.
#[inline(never)]
unsafe fn add_cells<T: Real, const P: usize, const Q: usize>(
    cells: &Cells,
    mesh: *mut T,
    first: [usize; 3],
    x: &[T; P],
    y: &[T; P],
    z: &[T; Q],
) {
    let [along_x, along_y, along_z] = cells.offsets::<P>(first);
    for i in 0..P {
        for j in 0..P {
            for k in 0..P {
                // SAFETY: the offset of a cell of the mesh, this thread's alone (caller).
                unsafe { *mesh.add(along_x[i] + along_y[j] + along_z[k]) += x[i] * (y[j] * z[k]) };
            }
        }
    }
}
