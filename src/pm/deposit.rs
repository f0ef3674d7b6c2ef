//! From particles to a mesh: m_c = sum_i w_i W(x_c - x_i).
//!
//! The window W is that of `window.rs`; cells get masses, so the sum over cells is the sum of weights. The density contrast has the modes
//! delta_k = F_k/F_0 for k != 0, with F the forward transform of the mesh without its factor, so that F_0 is the sum of weights.
//!
//! Particles are taken in batches of 2^21, each sorted into tiles (columns of 8 x 8 cells or more along z), and tiles of one colour
//! are filled at the same time. Where neighbours in memory mostly share a tile, their runs are sorted and not they themselves. A cell gets its
//! contributions in an order that does not depend on threads.

use core::sync::atomic::{AtomicU32, Ordering};

use super::cells::Cells;
use super::columns::{Column, Positions};
use super::frame::{Assignment, BLOCK, Frame, NOT_FINITE};
use super::region::Region;
use super::scatter::Block;
use super::sort::{self, BATCH, Fourth, IN_ORDER, Record, Run, Sorter};
use super::tiles::Tiling;
use super::window::Window;
use crate::exec::{Exec, Shared};
use crate::real::Real;
use crate::scratch::{Arena, Layout};
use crate::simd::Simd;
use crate::status::{Error, Result};
use crate::within::Within;

/// Scratch of [`deposit`]: with m = min(particles, 2^21), t tiles (at most 4096, a function of region and window) and r = size of `T`,
/// 4 r m + 2 m + 8 (m/8 + ceil(m/2^15)) + 4 t ceil(m/2^15) + 4 (t + 1) bytes, m/8 rounded down, each term up to 64.
/// No more than 41 MB in `f32`, 75 MB in `f64`.
///
/// # Errors
/// `Overflow` if the bytes do not fit the address space.
///
/// # Example
/// ```
/// use fixpair::mesh::{Brick, Space};
/// use fixpair::pm::Region;
///
/// let brick = Brick::whole(8, Space::Configuration)?;
/// let region = Region::from_brick(&brick)?;
/// use fixpair::pm::{Window, deposit_scratch};
///
/// assert!(deposit_scratch::<f32>(&region, 1 << 30, Window::CloudInCell)?.size < 41_000_000);
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn deposit_scratch<T: Real>(region: &Region, particles: usize, window: Window) -> Result<Layout> {
    // Tiles do not depend on the box or the shift.
    let frame = Frame::<T>::new(region, &Assignment { box_size: region.n() as f64, window, shift: 0.0 })?;
    sort::layout::<T>(particles, Tiling::of(region, &frame).len())
}

/// Adds the masses of particles to the cells of a region.
///
/// `mesh`: on `region`, added to. `positions`: any finite numbers, wrapped into the box [0, L). `weights`: one a particle, or
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
/// The same bits for any number of threads; they may depend on the region, for addition rounds. Cost on one core, `f32`: 9, 11, 15 and 20 ns a
/// particle for order 1 to 4 if neighbours in memory are neighbours in space, 21 to 38 ns in random order.
///
/// # Example
/// ```
/// use fixpair::mesh::{Brick, Space};
/// use fixpair::pm::Region;
///
/// let brick = Brick::whole(8, Space::Configuration)?;
/// let region = Region::from_brick(&brick)?;
/// use fixpair::exec::Serial;
/// use fixpair::pm::{Assignment, Positions, Window, deposit};
/// # #[repr(align(64))] struct Memory([u8; 1 << 16]);
/// # let mut memory = Memory([0; 1 << 16]);
/// # let scratch = &mut memory.0;
///
/// let mut mesh = vec![0.0_f64; region.reals()];
/// let assignment = Assignment { box_size: 8.0, window: Window::CloudInCell, shift: 0.0 };
/// deposit(&mut mesh, &region, &Positions::triples(&[0.25, 0.0, 0.0])?, None, &assignment, scratch, &Serial)?;
/// assert_eq!((mesh[0], mesh[80]), (0.75, 0.25));
/// # Ok::<(), fixpair::status::Error>(())
/// ```
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
        let changes = sorter.count(positions, first, count, &frame, &tiling, simd, exec)?;
        // A property of the particles alone, like everything on which the order of sums depends.
        let in_runs = changes < count / IN_ORDER;
        if in_runs {
            sorter.write_runs(count, exec)?;
        } else {
            sorter.write(positions, fourth, first, count, &frame, simd, exec)?;
        }
        let source = Source { positions, fourth, first, in_runs, tiling: &tiling };
        let wrong = AtomicU32::new(0);
        for colour in tiling.colours() {
            exec.parallel_for(colour.len(), &|i| {
                let tile = colour.tile(i);
                // SAFETY: tiles of one colour touch different cells, and each is filled once.
                let flags = simd.vectorise(
                    #[inline(always)]
                    || unsafe {
                        match assignment.window {
                            Window::NearestGridPoint => target.fill::<1, 1>(&source, &sorter, tile),
                            Window::CloudInCell => target.fill::<2, 2>(&source, &sorter, tile),
                            Window::TriangularShapedCloud => target.fill::<3, 4>(&source, &sorter, tile),
                            Window::PiecewiseCubicSpline => target.fill::<4, 4>(&source, &sorter, tile),
                        }
                    },
                );
                wrong.fetch_or(flags, Ordering::Relaxed);
            })?;
        }
        sort::check(&wrong)?;
    }
    Ok(())
}

/// A batch of particles: sorted, or in runs.
struct Source<'a, 'b, T> {
    positions: &'a Positions<'b, T>,
    fourth: Fourth<'b, T>,
    first: usize,
    in_runs: bool,
    tiling: &'a Tiling,
}

/// The mesh that is added to.
struct Target<'a, T> {
    mesh: Shared<'a, T>,
    cells: Cells,
    frame: &'a Frame<T>,
}

impl<T: Real> Target<'_, T> {
    /// Adds the particles of a tile. Returns what is wrong with any of them.
    ///
    /// # Safety
    /// No other thread touches the cells of the tile now.
    #[inline(always)]
    unsafe fn fill<const P: usize, const Q: usize>(
        &self,
        source: &Source<'_, '_, T>,
        sorter: &Sorter<'_, T>,
        tile: usize,
    ) -> u32 {
        let Source { positions, fourth, first, in_runs, tiling } = *source;
        if in_runs {
            // SAFETY: the sorter found the particles to be in this tile.
            unsafe { self.add_runs::<P, Q>(positions, fourth, first, sorter.runs(tile)) }
        } else {
            let records = sorter.tile(tile);
            self.cells.fetch(self.mesh.as_ptr(), tiling.first_cells(tile), records.len());
            // SAFETY: as above.
            unsafe { self.add::<P, Q>(records) };
            0
        }
    }

    /// Adds particles of window order P.
    ///
    /// # Safety
    /// The particles' first cells are inside the frame's limits, and no other thread touches their cells now.
    #[inline(always)]
    unsafe fn add<const P: usize, const Q: usize>(&self, records: &[Record<T>]) {
        let mut block = Block::new();
        for records in records.chunks(BLOCK) {
            block.count = records.len();
            for (i, record) in records.iter().enumerate().take(BLOCK) {
                for axis in 0..3 {
                    block.v[axis][i] = record[axis];
                }
                block.mass[i] = record[3];
            }
            block.repeat_first();
            for axis in 0..3 {
                self.frame.index_all(axis, &block.v[axis], &mut block.index[axis]);
            }
            // SAFETY: as the caller says; past the records the first one is repeated.
            unsafe { block.add::<P, Q>(&self.cells, self.mesh.as_ptr(), true) };
        }
    }

    /// Adds particles of window order P from where the caller keeps them.
    ///
    /// # Safety
    /// As `add`; the runs are of particles that there are.
    #[inline(always)]
    unsafe fn add_runs<const P: usize, const Q: usize>(
        &self,
        positions: &Positions<'_, T>,
        fourth: Fourth<'_, T>,
        first: usize,
        runs: &[Run],
    ) -> u32 {
        let mut block = Block::new();
        let mut wrong = 0;
        let mut runs = runs.iter();
        let mut rest = 0..0;
        loop {
            block.count = 0;
            while block.count < BLOCK {
                if rest.is_empty() {
                    let Some(&[begin, length]) = runs.next() else { break };
                    rest = first + begin as usize..first + (begin + length) as usize;
                }
                let filled = block.count;
                let count = rest.len().min(BLOCK - filled);
                // SAFETY: the particles exist (caller), and the block has room for so many.
                unsafe { positions.load_all(rest.start, count, filled, &mut block.v) };
                if let Fourth::Weight(weights) = fourth {
                    // SAFETY: as above, and there are as many weights as positions.
                    unsafe { weights.load(rest.start, count, block.mass.part_mut(filled..)) };
                }
                rest.start += count;
                block.count += count;
            }
            if block.count == 0 {
                return wrong;
            }
            block.repeat_first();
            for axis in 0..3 {
                self.frame.locate(axis, &mut block.v[axis], &mut block.index[axis]);
            }
            if let Fourth::Weight(_) = fourth {
                let finite = block.mass.iter().fold(true, |finite, weight| finite & weight.is_finite());
                wrong |= if finite { 0 } else { NOT_FINITE };
            }
            // SAFETY: as the caller says.
            unsafe { block.add::<P, Q>(&self.cells, self.mesh.as_ptr(), false) };
        }
    }
}
