//! Meshes read out at blocks of particles, the adjoint of `scatter.rs`: weights and offsets of all of a block by lanes, once for all meshes, then
//! row by row out of the meshes.

use super::cells::{Cells, prefetch};
use super::columns::Positions;
use super::frame::{BLOCK, Frame};
use super::region::Region;
use super::sort::{CHUNK, Record, Sorter, block};
use super::tiles::Tiling;
use super::window::{Window, spline};
use crate::exec::Exec;
use crate::real::Real;
use crate::simd::Simd;
use crate::status::Result;
use crate::within::Within;

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
struct Places<T> {
    count: usize,
    v: [[T; BLOCK]; 3],
    index: [[i32; BLOCK]; 3],
}

impl<T: Real> Places<T> {
    #[inline(always)]
    const fn new() -> Self {
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

    /// Reads the meshes at a batch of `count` particles where they are, and hands the values of block after block to `take`: the number of its
    /// first particle, how many they are, and the values. The sorter has found them all inside.
    pub(super) fn read_in_order(
        &self,
        positions: &Positions<'_, T>,
        first: usize,
        count: usize,
        simd: Simd,
        exec: &dyn Exec,
        take: impl Fn(usize, usize, &[[T; BLOCK]; M]) + Sync,
    ) -> Result<()> {
        exec.parallel_for(count.div_ceil(CHUNK), &|chunk| {
            let end = count.min((chunk + 1) * CHUNK);
            simd.vectorise(
                #[inline(always)]
                || {
                    let (mut places, mut values) = (Places::new(), [[T::ZERO; BLOCK]; M]);
                    for begin in (chunk * CHUNK..end).step_by(BLOCK) {
                        places.count = BLOCK.min(end - begin);
                        let Places { count, v, index } = &mut places;
                        block(positions, first + begin, *count, self.frame, v, index);
                        // SAFETY: all particles of the batch are inside.
                        unsafe { self.read(&places, &mut values) };
                        take(begin, places.count, &values);
                    }
                },
            );
        })
    }

    /// Replaces the first M numbers of a sorter's records by what the meshes are worth there.
    pub(super) fn read_sorted(
        &self,
        sorter: &mut Sorter<'_, T>,
        tiling: &Tiling,
        simd: Simd,
        exec: &dyn Exec,
    ) -> Result<()> {
        sorter.each_tile(exec, &|tile, records| {
            for mesh in self.meshes {
                self.cells.fetch(mesh.as_ptr(), tiling.first_cells(tile), records.len());
            }
            simd.vectorise(
                #[inline(always)]
                // SAFETY: the sorter's records, on this frame.
                || unsafe { self.read_records(records) },
            );
        })
    }

    /// Replaces the first M numbers of records by what the meshes are worth there.
    ///
    /// # Safety
    /// A sorter made the records on the same frame.
    #[inline(always)]
    unsafe fn read_records(&self, records: &mut [Record<T>]) {
        let mut places = Places::new();
        let mut values = [[T::ZERO; BLOCK]; M];
        for records in records.chunks_mut(BLOCK) {
            places.count = records.len();
            for (i, record) in records.iter().enumerate().take(BLOCK) {
                for axis in 0..3 {
                    places.v[axis][i] = record[axis];
                }
            }
            for axis in 0..3 {
                let repeated = places.v[axis][0];
                places.v[axis].part_mut(records.len()..).fill(repeated);
                self.frame.index_all(axis, &places.v[axis], &mut places.index[axis]);
            }
            // SAFETY: as the caller says.
            unsafe { self.read(&places, &mut values) };
            for (i, record) in records.iter_mut().enumerate().take(BLOCK) {
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
    unsafe fn read(&self, places: &Places<T>, values: &mut [[T; BLOCK]; M]) {
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
        for i in 0..places.count.min(BLOCK) {
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
                    sums[m][i] = self.sum_cells(self.meshes[m], places.first(i), &x, &y);
                }
                continue;
            }
            let mut sum = [[T::ZERO; Q]; M];
            for row in 0..P * P {
                let weight = x[row / P] * y[row % P];
                let at = start[i] + row / P * x_step + row % P * y_step;
                for m in 0..M {
                    debug_assert!(at + Q <= self.meshes[m].len());
                    // SAFETY: no row of it runs over an edge, so it is inside the region, and the mesh holds the region.
                    let row = unsafe { &*self.meshes[m].as_ptr().add(at).cast::<[T; Q]>() };
                    for k in 0..Q {
                        sum[m][k] += weight * row[k];
                    }
                }
            }
            for m in 0..M {
                sums[m][i] = sum[m];
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
        mesh: &[T],
        first: [usize; 3],
        x: &[T; P],
        y: &[T; P],
    ) -> [T; Q] {
        let [along_x, along_y, along_z] = self.cells.offsets::<P>(first);
        let mut sum = [T::ZERO; Q];
        for i in 0..P {
            for j in 0..P {
                let (weight, rows) = (x[i] * y[j], along_x[i] + along_y[j]);
                for k in 0..P {
                    sum[k] += weight * mesh.at(rows + along_z[k]);
                }
            }
        }
        sum
    }
}
