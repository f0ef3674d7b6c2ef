//! From the centre of mass of a group to its densest place: shrinking spheres (Power et al. 2003, astro-ph/0201544, section 2.5).
//!
//! The centre moves to the centre of mass of the particles within r, then r shrinks by a factor, until a sphere would hold fewer than
//! `n_min` particles.

use super::grid::Grid;
use super::periodic::{difference, home};
use crate::exec::{Exec, Shared};
use crate::pm::columns::Positions;
use crate::real::Real;
use crate::status::{Error, Result};
use crate::within::Within;

/// How spheres shrink.
#[derive(Clone, Copy, Debug)]
pub struct Shrink {
    /// From one radius to the next: 0.975 in the source; from 0.5 to 0.99.
    pub factor: f64,
    /// The fewest particles of a sphere: 100, or 1% of the first, in the source.
    pub n_min: u64,
}

/// Spheres that are smaller than this part of L are not made.
const SMALLEST: f64 = 1e-9;

/// Moves each centre to the densest place within its radius.
///
/// `centres`: any finite places; on return in [0, L). `radii`: of the first spheres, one a centre, taken as L/4 if larger: twice the
/// [`radius`](field@super::Halo::radius) of the group, say. A centre whose first sphere holds fewer than `n_min` particles stays. `position`: all
/// particles that may lie in the spheres. `scratch`: see [`spheres_scratch`](super::spheres_scratch).
///
/// # Errors
/// `Length`; `NotFinite`; `Range` for the box, a negative radius, a factor not in 0.5 ..= 0.99, `n_min` = 0; `Overflow`, `Scratch`,
/// `Alignment`; `Hook`, after which some centres are moved.
///
/// The same bits for any number of threads. Cost: a sort of the particles, then log(radius ratio)/log(factor) sums over those of each sphere.
///
/// # Example
/// ```
/// use fixpair::exec::Serial;
/// use fixpair::halos::fof_labels;
/// use fixpair::pm::Positions;
/// # #[repr(align(64))] struct Memory([u8; 1 << 16]);
/// # let mut memory = Memory([0; 1 << 16]);
/// # let scratch = &mut memory.0;
///
/// let position = Positions::triples(&[9.9_f64, 5.0, 5.0, 0.1, 5.0, 5.0, 5.0, 5.0, 5.0])?; // two are friends over the edge
/// let mut labels = [0; 3];
/// fof_labels(&mut labels, &position, None, 10.0, 0.5, scratch, &Serial)?;
/// use fixpair::halos::{Shrink, refine_centres};
///
/// let mut centres = [[0.05, 5.0, 5.0]];
/// refine_centres(&mut centres, &[1.0], &position, 10.0, &Shrink { factor: 0.9, n_min: 1 }, scratch, &Serial)?;
/// assert!((centres[0][1] - 5.0).abs() < 0.1);
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn refine_centres<T: Real>(
    centres: &mut [[f64; 3]],
    radii: &[f64],
    position: &Positions<'_, T>,
    box_size: f64,
    shrink: &Shrink,
    scratch: &mut [u8],
    exec: &dyn Exec,
) -> Result<()> {
    let Shrink { factor, n_min } = *shrink;
    if !centres.as_flattened().iter().chain(radii).chain([&factor, &box_size]).all(|x| x.is_finite()) {
        return Err(Error::NotFinite);
    }
    let sensible = (0.5..=0.99).contains(&factor)
        && n_min > 0
        && box_size > 0.0
        && radii.iter().all(|&radius| radius >= 0.0);
    if !sensible {
        return Err(Error::Range);
    }
    if radii.len() != centres.len() {
        return Err(Error::Length);
    }
    let grid = Grid::new(position, box_size, scratch, exec)?;
    let centres = Shared::new(centres);
    exec.parallel_for(radii.len(), &|i| {
        // SAFETY: one centre a chunk, and as many radii as centres.
        let centre = unsafe { &mut centres.part(i, 1)[0] };
        let mut place = centre.map(|x| home(x, box_size));
        let mut radius = radii.at(i).min(0.25 * box_size);
        loop {
            let (count, sum) = centre_of_mass(&grid, place, radius, box_size);
            if count < n_min {
                break;
            }
            place = [0, 1, 2].map(|axis| home(place[axis] + sum[axis] / count as f64, box_size));
            radius *= factor;
            // Particles that all but coincide would keep it shrinking.
            if radius < SMALLEST * box_size {
                break;
            }
        }
        *centre = place;
    })
}

/// Particles within r of a centre, and the sum of their differences from it.
fn centre_of_mass<T: Real>(
    grid: &Grid<'_, T>,
    centre: [f64; 3],
    radius: f64,
    box_size: f64,
) -> (u64, [f64; 3]) {
    let (mut count, mut sum) = (0, [0.0; 3]);
    grid.near(centre, radius, |places| {
        for place in places {
            let d = [0, 1, 2].map(|axis| difference(place[axis].to_f64(), centre[axis], box_size));
            if (d[0] * d[0] + d[1] * d[1]) + d[2] * d[2] <= radius * radius {
                count += 1;
                for axis in 0..3 {
                    sum[axis] += d[axis];
                }
            }
        }
    });
    (count, sum)
}
