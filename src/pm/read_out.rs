//! From a mesh to particles: g_i = sum_c W(x_c - x_i) m_c, the adjoint of the deposit.
//!
//! With the same assignment, sum_i w_i g_i = sum_c m_c D_c for any mesh m, where D is the deposit of the weights w. A force that is deposited
//! and read out with one window so does not push a particle by itself.

use super::columns::{ColumnMut, Positions};
use super::deposit::deposit_scratch;
use super::frame::{Assignment, Frame};
use super::gather::Meshes;
use super::region::Region;
use super::sort::{self, BATCH, Fourth, IN_ORDER, Sorter};
use super::tiles::Tiling;
use super::window::Window;
use crate::exec::Exec;
use crate::real::Real;
use crate::scratch::{Arena, Layout};
use crate::simd::Simd;
use crate::status::{Error, Result};
use crate::within::Within;

/// Scratch of [`read_out`]: that of the deposit.
///
/// # Errors
/// As [`deposit_scratch`].
///
/// # Example
/// ```
/// use fixpair::mesh::{Brick, Space};
/// use fixpair::pm::Region;
///
/// let brick = Brick::whole(8, Space::Configuration)?;
/// let region = Region::from_brick(&brick)?;
/// use fixpair::pm::{Window, read_out_scratch};
///
/// assert!(read_out_scratch::<f32>(&region, 1 << 30, Window::CloudInCell)?.size < 41_000_000);
/// # Ok::<(), fixpair::status::Error>(())
/// ```
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
/// The same bits for any number of threads. Cost on one core, `f32`: 15, 17, 25 and 38 ns a particle for order 1 to 4 if neighbours in memory are
/// neighbours in space, 43 to 78 ns in random order.
///
/// # Example
/// ```
/// use fixpair::mesh::{Brick, Space};
/// use fixpair::pm::Region;
///
/// let brick = Brick::whole(8, Space::Configuration)?;
/// let region = Region::from_brick(&brick)?;
/// use fixpair::exec::Serial;
/// use fixpair::pm::{Assignment, ColumnMut, Positions, Window, read_out};
/// # #[repr(align(64))] struct Memory([u8; 1 << 16]);
/// # let mut memory = Memory([0; 1 << 16]);
/// # let scratch = &mut memory.0;
///
/// let (mut mesh, mut values) = (vec![0.0_f64; region.reals()], [0.0]);
/// mesh[80] = 4.0; // cell (1, 0, 0)
/// let assignment = Assignment { box_size: 8.0, window: Window::CloudInCell, shift: 0.0 };
/// let at = Positions::triples(&[0.25, 0.0, 0.0])?;
/// read_out(&mut ColumnMut::new(&mut values), &mesh, &region, &at, &assignment, scratch, &Serial)?;
/// assert_eq!(values, [1.0]);
/// # Ok::<(), fixpair::status::Error>(())
/// ```
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
    let particles = positions.len();
    if values.len() != particles {
        return Err(Error::Length);
    }
    let tiling = Tiling::of(region, &frame);
    let mut arena = Arena::new(scratch, sort::layout::<T>(particles, tiling.len())?)?;
    let mut sorter = Sorter::new(&mut arena, particles, tiling.len())?;
    let meshes = Meshes::new([mesh], region, &frame, assignment.window)?;
    for first in (0..particles).step_by(BATCH) {
        let count = BATCH.min(particles - first);
        let changes = sorter.count(positions, first, count, &frame, &tiling, simd, exec)?;
        let values = &*values;
        // A value does not depend on it: each is a sum of its own.
        if changes < count / IN_ORDER {
            meshes.read_in_order(
                positions,
                first,
                count,
                simd,
                exec,
                #[inline(always)]
                // SAFETY: the particles exist, and each is handed over once.
                |begin, count, [column]| unsafe { values.store(first + begin, column.part(..count)) },
            )?;
        } else {
            sorter.write(positions, Fourth::One, first, count, &frame, simd, exec)?;
            meshes.read_sorted(&mut sorter, &tiling, simd, exec)?;
            sorter.unsort(
                count,
                simd,
                exec,
                #[inline(always)]
                // SAFETY: as above.
                |begin, count, [column]| unsafe { values.store(first + begin, column.part(..count)) },
            )?;
        }
    }
    Ok(())
}
