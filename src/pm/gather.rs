//! Meshes read out at blocks of particles, the adjoint of `scatter.rs`: weights and offsets of all of a block by lanes, once for all meshes, then
//! row by row out of the meshes.

use core::ops::Range;

use super::cells::{Cells, prefetch};
use super::frame::{BLOCK, Frame};
use super::region::Region;
use super::sort::Record;
use super::window::{Window, spline};
use crate::real::Real;
use crate::status::Result;

/// Particles from asking for cells to reading them.
const AHEAD: usize = 8;

/// In place of the offset of a particle whose rows run over an edge.
const OVER: usize = usize::MAX;

/// M meshes on one region.
pub(super) struct Meshes<'a, T, const M: usize> {
    meshes: [&'a [T]; M],
    cells: Cells,
    frame: &'a Frame<T>,
    window: Window,
}

/// Up to 64 particles, located; missing ones repeat another.
pub(super) struct Places<T> {
    pub(super) count: usize,
    pub(super) v: [[T; BLOCK]; 3],
    pub(super) index: [[i32; BLOCK]; 3],
}

impl<T: Real> Places<T> {
    #[inline(always)]
    pub(super) const fn new() -> Self {
        Self { count: 0, v: [[T::ZERO; BLOCK]; 3], index: [[0; BLOCK]; 3] }
    }

    #[inline(always)]
    fn first(&self, i: usize) -> [usize; 3] {
        [0, 1, 2].map(|axis| self.index[axis][i] as usize)
    }
}

impl<'a, T: Real, const M: usize> Meshes<'a, T, M> {
    /// `Length` if one of them is shorter than the region.
    pub(super) fn new(
        meshes: [&'a [T]; M],
        region: &Region,
        frame: &'a Frame<T>,
        window: Window,
    ) -> Result<Self> {
        for mesh in meshes {
            region.check_length(mesh)?;
        }
        Ok(Self { meshes, cells: Cells::new(region), frame, window })
    }

    /// Asks the cache for the cells of a tile's particles.
    pub(super) fn fetch(&self, first_cells: &[Range<usize>; 2], particles: usize) {
        for mesh in self.meshes {
            self.cells.fetch(mesh.as_ptr(), first_cells.clone(), particles);
        }
    }

    /// Replaces the first M numbers of records by what the meshes are worth there.
    ///
    /// # Safety
    /// A sorter made the records on the same frame.
    #[inline(always)]
    pub(super) unsafe fn read_records(&self, records: &mut [Record<T>]) {
        let mut places = Places::new();
        let mut values = [[T::ZERO; BLOCK]; M];
        for records in records.chunks_mut(BLOCK) {
            places.count = records.len();
            for (i, record) in records.iter().enumerate() {
                for axis in 0..3 {
                    places.v[axis][i] = record[axis];
                }
            }
            for axis in 0..3 {
                let repeated = places.v[axis][0];
                places.v[axis][records.len()..].fill(repeated);
                self.frame.index_all(axis, &places.v[axis], &mut places.index[axis]);
            }
            // SAFETY: as the caller says.
            unsafe { self.read(&places, &mut values) };
            for (i, record) in records.iter_mut().enumerate() {
                for m in 0..M {
                    record[m] = values[m][i];
                }
            }
        }
    }

    /// What the meshes are worth at a block of particles.
    ///
    /// # Safety
    /// Coordinates are in [0, n), also those past `count`, and first cells inside the frame's limits.
    #[inline(always)]
    pub(super) unsafe fn read(&self, places: &Places<T>, values: &mut [[T; BLOCK]; M]) {
        // SAFETY: as the caller says.
        unsafe {
            match self.window {
                Window::NearestGridPoint => self.read_rows::<1, 1>(places, values),
                Window::CloudInCell => self.read_rows::<2, 2>(places, values),
                Window::TriangularShapedCloud => self.read_rows::<3, 4>(places, values),
                Window::PiecewiseCubicSpline => self.read_rows::<4, 4>(places, values),
            }
        }
    }

    /// `read` for window order P; rows of Q >= P reals make full vectors. Columns of the P x P rows are summed first, then weighted along z.
    ///
    /// # Safety
    /// As `read`.
    #[inline(always)]
    unsafe fn read_rows<const P: usize, const Q: usize>(
        &self,
        places: &Places<T>,
        values: &mut [[T; BLOCK]; M],
    ) {
        let mut along = [[[T::ZERO; BLOCK]; P]; 3];
        for axis in 0..3 {
            for i in 0..BLOCK {
                // SAFETY: in [0, n) (caller), and n is an i32.
                let weights = spline::<T, P>(unsafe { places.v[axis][i].split() }.1);
                for k in 0..P {
                    along[axis][k][i] = weights[k];
                }
            }
        }
        let mut start = [OVER; BLOCK];
        let last = self.cells.last_rows::<P, Q>();
        for i in 0..BLOCK {
            let over = (0..3).fold(false, |over, axis| over | (places.index[axis][i] > last[axis]));
            // All bits set, or none.
            start[i] = self.cells.start(places.first(i)) | usize::from(over).wrapping_neg();
        }
        let [x_step, y_step] = self.cells.steps();
        let mut sums = [[[T::ZERO; Q]; BLOCK]; M];
        for i in 0..places.count {
            let later = start[(i + AHEAD) % BLOCK];
            for mesh in self.meshes {
                let later = mesh.as_ptr().wrapping_add(later);
                for row in 0..P * P {
                    prefetch::<T, true>(later.wrapping_add(row / P * x_step + row % P * y_step));
                }
            }
            let [x, y]: [[T; P]; 2] =
                core::array::from_fn(|axis| core::array::from_fn(|k| along[axis][k][i]));
            if start[i] == OVER {
                for m in 0..M {
                    sums[m][i] = self.sum_cells(m, places.first(i), &x, &y);
                }
                continue;
            }
            let weight: [[T; P]; P] = core::array::from_fn(|i| core::array::from_fn(|j| x[i] * y[j]));
            for m in 0..M {
                let mut sum = [T::ZERO; Q];
                for i_row in 0..P {
                    for j_row in 0..P {
                        let at = start[i] + i_row * x_step + j_row * y_step;
                        debug_assert!(at + Q <= self.meshes[m].len());
                        // SAFETY: no row of it runs over an edge, so it is inside the region, and the mesh holds the region.
                        let row = unsafe { &*self.meshes[m].as_ptr().add(at).cast::<[T; Q]>() };
                        for k in 0..Q {
                            sum[k] += weight[i_row][j_row] * row[k];
                        }
                    }
                }
                sums[m][i] = sum;
            }
        }
        for m in 0..M {
            for i in 0..BLOCK {
                let mut value = sums[m][i][0] * along[2][0][i];
                for k in 1..P {
                    value += sums[m][i][k] * along[2][k][i];
                }
                values[m][i] = value;
            }
        }
    }

    /// The weighted sum of a particle's rows, cell by cell, in any layout and round any edge.
    #[inline(never)]
    fn sum_cells<const P: usize, const Q: usize>(
        &self,
        m: usize,
        first: [usize; 3],
        x: &[T; P],
        y: &[T; P],
    ) -> [T; Q] {
        let mut sum = [T::ZERO; Q];
        for i in 0..P {
            for j in 0..P {
                let weight = x[i] * y[j];
                for k in 0..P {
                    sum[k] += weight * self.meshes[m][self.cells.offset(first, [i, j, k])];
                }
            }
        }
        sum
    }
}
