//! From a mesh to particles: g_i = sum_c W(x_c - x_i) m_c, the adjoint of the deposit.
//!
//! With the same assignment, sum_i w_i g_i = sum_c m_c D_c for any mesh m, where D is the deposit of the weights w. A force that is deposited
//! and read out with one window so does not push a particle by itself.

use super::cells::{Cells, Touched};
use super::columns::{ColumnMut, Positions};
use super::deposit::deposit_scratch;
use super::frame::{Assignment, Frame};
use super::region::Region;
use super::sort::{self, BATCH, Fourth, Record, Sorter};
use super::tiles::Tiling;
use super::window::Window;
use crate::exec::Exec;
use crate::real::Real;
use crate::scratch::{Arena, Layout};
use crate::simd::Simd;
use crate::status::{Error, Result};

/// Scratch of [`read_out`]: that of the deposit.
///
/// # Errors
/// As [`deposit_scratch`].
pub fn read_out_scratch<T: Real>(region: &Region, particles: usize, window: Window) -> Result<Layout> {
    deposit_scratch::<T>(region, particles, window)
}

/// What a mesh is worth at each particle.
///
/// `values`: one a particle, overwritten. `mesh`: on `region`, ghost planes filled (see [`super::ghosts::copy_cells`]). `positions`: as for
/// the deposit.
///
/// # Errors
/// As [`super::deposit::deposit`]; after `NotFinite` for a position and `Outside`, some values are written.
///
/// The same bits for any number of threads. Cost: about 15 ns a particle and core.
pub fn read_out<T: Real>(
    values: &mut ColumnMut<'_, T>,
    mesh: &[T],
    region: &Region,
    positions: &Positions<'_, T>,
    assignment: &Assignment,
    scratch: &mut [u8],
    exec: &dyn Exec,
) -> Result<()> {
    read_out_with(Simd::detect(), values, mesh, region, positions, assignment, scratch, exec)
}

pub(super) fn read_out_with<T: Real>(
    simd: Simd,
    values: &mut ColumnMut<'_, T>,
    mesh: &[T],
    region: &Region,
    positions: &Positions<'_, T>,
    assignment: &Assignment,
    scratch: &mut [u8],
    exec: &dyn Exec,
) -> Result<()> {
    let frame = Frame::new(region, assignment)?;
    region.check_length(mesh)?;
    let particles = positions.len();
    if values.len() != particles {
        return Err(Error::Length);
    }
    let tiling = Tiling::of(region, &frame);
    let mut arena = Arena::new(scratch, sort::layout::<T>(particles, tiling.len())?)?;
    let mut sorter = Sorter::new(&mut arena, particles, tiling.len())?;
    let source = Source { mesh, cells: Cells::new(region), frame: &frame };
    for first in (0..particles).step_by(BATCH) {
        let count = BATCH.min(particles - first);
        sorter.sort(positions, Fourth::Number, first, count, &frame, &tiling, simd, exec)?;
        let values = &*values;
        exec.parallel_for(tiling.len(), &|tile| {
            let records = sorter.tile(tile);
            // SAFETY: each particle of the batch is in one tile, and its number is its own.
            let put = |number: usize, value: T| unsafe { values.write(first + number, value) };
            simd.vectorise(
                #[inline(always)]
                || match assignment.window {
                    Window::NearestGridPoint => source.read::<1, 1>(records, put),
                    Window::CloudInCell => source.read::<2, 2>(records, put),
                    Window::TriangularShapedCloud => source.read::<3, 4>(records, put),
                    Window::PiecewiseCubicSpline => source.read::<4, 4>(records, put),
                },
            );
        })?;
    }
    Ok(())
}

/// The mesh that is read.
struct Source<'a, T> {
    mesh: &'a [T],
    cells: Cells,
    frame: &'a Frame<T>,
}

impl<T: Real> Source<'_, T> {
    /// Hands the value at each particle to `put`, with its number. Columns of the P x P rows are summed first, then weighted along z.
    #[inline(always)]
    fn read<const P: usize, const Q: usize>(&self, records: &[Record<T>], put: impl Fn(usize, T)) {
        for record in records {
            let touched = Touched::new::<P>(self.frame, record);
            let [wx, wy, wz] = &touched.weight;
            let mut sum = [T::ZERO; Q];
            if let Some(base) = self.cells.rows::<T, P, Q>(&touched) {
                let [x_step, y_step] = self.cells.steps();
                for i in 0..P {
                    for j in 0..P {
                        let weight = wx[i] * wy[j];
                        let start = base + i * x_step + j * y_step;
                        debug_assert!(start + Q <= self.mesh.len());
                        // SAFETY: `rows` says that the row is inside the region, and the mesh holds the region.
                        let row = unsafe { &*self.mesh.as_ptr().add(start).cast::<[T; Q]>() };
                        for k in 0..Q {
                            sum[k] += weight * row[k];
                        }
                    }
                }
            } else {
                for i in 0..P {
                    for j in 0..P {
                        let weight = wx[i] * wy[j];
                        for k in 0..P {
                            sum[k] += weight * self.mesh[self.cells.offset(&touched, [i, j, k])];
                        }
                    }
                }
            }
            let mut value = sum[0] * wz[0];
            for k in 1..P {
                value += sum[k] * wz[k];
            }
            put(record[3].to_f64() as usize, value);
        }
    }
}
