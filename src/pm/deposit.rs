//! From particles to a mesh: m_c = sum_i w_i W(x_c - x_i).
//!
//! The window W is that of `window.rs`; cells get masses, so the sum over cells is the sum of weights. The density contrast has the modes
//! delta_k = F_k/F_0 for k != 0, with F the forward transform of the mesh without its factor, so that F_0 is the sum of weights.
//!
//! Particles are taken in batches of 2^21, each sorted into tiles (columns of 8 x 8 cells or more along z), and tiles of one colour
//! are filled at the same time. A cell so gets its contributions in an order that does not depend on threads.

use super::cells::{Cells, Touched};
use super::columns::{Column, Positions};
use super::frame::{Assignment, Frame};
use super::region::Region;
use super::sort::{self, BATCH, Fourth, Record, Sorter};
use super::tiles::Tiling;
use super::window::Window;
use crate::exec::{Exec, Shared};
use crate::real::Real;
use crate::scratch::{Arena, Layout};
use crate::simd::Simd;
use crate::status::{Error, Result};

/// Scratch of [`deposit`]: with m = min(particles, 2^21), t tiles (at most 4096, a function of region and window) and r = size of `T`,
/// 4 r m + 2 m + 4 t ceil(m/2^15) + 4 (t + 1) bytes, each rounded up to 64. No more than 39 MB in `f32`, 73 MB in `f64`.
///
/// # Errors
/// `Overflow` if the bytes do not fit the address space.
pub fn deposit_scratch<T: Real>(region: &Region, particles: usize, window: Window) -> Result<Layout> {
    // Tiles do not depend on the box or the shift.
    let frame = Frame::<T>::new(region, &Assignment { box_size: region.n() as f64, window, shift: 0.0 })?;
    sort::layout::<T>(particles, Tiling::of(region, &frame).len())
}

/// Adds the masses of particles to the cells of a region.
///
/// `mesh`: on `region`, added to. `positions`: any finite numbers, wrapped into the box [0, L) exactly. `weights`: one a particle, or
/// none for 1 each.
///
/// A particle that touches cells that the region does not hold is refused, unless it is within rounding (8 ulps of n cells) of one that
/// does not: that one is taken instead. So particles may be dealt out to slabs by any arithmetic that rounds well.
///
/// # Errors
/// `NotFinite`, `Range` for the assignment (see [`Assignment`]), `Length` unless there is one weight a particle or if the mesh is shorter than
/// the region, `Scratch`, `Alignment`, `Hook`; `NotFinite` for a position or weight and `Outside` for a particle as above: the mesh then
/// holds some of the particles.
///
/// The same bits for any number of threads; they may depend on the region, for addition rounds. Cost on one core, `f32`: 16, 19, 29 and 55 ns a
/// particle for order 1 to 4 if neighbours in memory are neighbours in space, 31 to 82 ns in random order.
pub fn deposit<T: Real>(
    mesh: &mut [T],
    region: &Region,
    positions: &Positions<'_, T>,
    weights: Option<&Column<'_, T>>,
    assignment: &Assignment,
    scratch: &mut [u8],
    exec: &dyn Exec,
) -> Result<()> {
    deposit_with(Simd::detect(), mesh, region, positions, weights, assignment, scratch, exec)
}

pub(super) fn deposit_with<T: Real>(
    simd: Simd,
    mesh: &mut [T],
    region: &Region,
    positions: &Positions<'_, T>,
    weights: Option<&Column<'_, T>>,
    assignment: &Assignment,
    scratch: &mut [u8],
    exec: &dyn Exec,
) -> Result<()> {
    let frame = Frame::new(region, assignment)?;
    region.check_length(mesh)?;
    let particles = positions.len();
    if weights.is_some_and(|weights| weights.len() != particles) {
        return Err(Error::Length);
    }
    let tiling = Tiling::of(region, &frame);
    let mut arena = Arena::new(scratch, sort::layout::<T>(particles, tiling.len())?)?;
    let mut sorter = Sorter::new(&mut arena, particles, tiling.len())?;
    let fourth = weights.map_or(Fourth::One, |weights| Fourth::Weight(*weights));
    let target = Target { mesh: Shared::new(mesh), cells: Cells::new(region), frame: &frame };
    for first in (0..particles).step_by(BATCH) {
        let count = BATCH.min(particles - first);
        sorter.count(positions, first, count, &frame, &tiling, simd, exec)?;
        sorter.write(positions, fourth, first, count, &frame, simd, exec)?;
        for colour in tiling.colours() {
            exec.parallel_for(colour.len(), &|i| {
                let tile = colour.tile(i);
                let records = sorter.tile(tile);
                let [x, y] = tiling.first_cells(tile);
                target.cells.fetch(target.mesh.as_ptr(), [x, y], records.len());
                simd.vectorise(
                    #[inline(always)]
                    || match assignment.window {
                        // SAFETY: tiles of one colour touch different cells, and each is filled once.
                        Window::NearestGridPoint => unsafe { target.add::<1, 1>(records) },
                        // SAFETY: as above.
                        Window::CloudInCell => unsafe { target.add::<2, 2>(records) },
                        // SAFETY: as above.
                        Window::TriangularShapedCloud => unsafe { target.add::<3, 4>(records) },
                        // SAFETY: as above.
                        Window::PiecewiseCubicSpline => unsafe { target.add::<4, 4>(records) },
                    },
                );
            })?;
        }
    }
    Ok(())
}

/// Of so many particles of higher windows, stretches are taken in turns. In lattice order particles follow each other from cell to cell, and a row
/// that is read as a vector while its last sum, one cell off, is still on its way to the cache stops the processor for that long.
const TURNS: usize = 4;
const STRETCH: usize = 64;

/// The mesh that is added to.
struct Target<'a, T> {
    mesh: Shared<'a, T>,
    cells: Cells,
    frame: &'a Frame<T>,
}

impl<T: Real> Target<'_, T> {
    /// Adds particles of window order P; rows of Q >= P reals, the last ones with weight 0, make full vectors.
    ///
    /// # Safety
    /// The particles' first cells are inside the frame's limits, and no other thread touches their cells now.
    #[inline(always)]
    unsafe fn add<const P: usize, const Q: usize>(&self, records: &[Record<T>]) {
        let (blocks, rest) = records.as_chunks::<{ TURNS * STRETCH }>();
        for block in blocks {
            for i in 0..block.len() {
                let next = if P > 2 { i % TURNS * STRETCH + i / TURNS } else { i };
                // SAFETY: as the caller says.
                unsafe { self.add_one::<P, Q>(&block[next]) };
            }
        }
        for record in rest {
            // SAFETY: as the caller says.
            unsafe { self.add_one::<P, Q>(record) };
        }
    }

    /// Adds one particle.
    ///
    /// # Safety
    /// As `add`.
    #[inline(always)]
    unsafe fn add_one<const P: usize, const Q: usize>(&self, record: &Record<T>) {
        let mesh = self.mesh.as_ptr();
        // SAFETY: as the caller says.
        let touched = unsafe { Touched::new::<P>(self.frame, record) };
        let [wx, wy, wz] = [0, 1, 2].map(|axis| touched.along(axis));
        if let Some(base) = self.cells.rows::<T, P, Q>(&touched) {
            let [x_step, y_step] = self.cells.steps();
            for i in 0..P {
                let mass = record[3] * wx[i];
                for j in 0..P {
                    let mass = mass * wy[j];
                    // SAFETY: `rows` says that the row is inside the region, and this thread's alone (caller).
                    let row = unsafe { &mut *mesh.add(base + i * x_step + j * y_step).cast::<[T; Q]>() };
                    for k in 0..Q {
                        row[k] += mass * wz[k];
                    }
                }
            }
        } else {
            for i in 0..P {
                let mass = record[3] * wx[i];
                for j in 0..P {
                    let mass = mass * wy[j];
                    for k in 0..P {
                        let offset = self.cells.offset(&touched, [i, j, k]);
                        // SAFETY: the offset of a cell of the region, this thread's alone (caller).
                        unsafe { *mesh.add(offset) += mass * wz[k] };
                    }
                }
            }
        }
    }
}
