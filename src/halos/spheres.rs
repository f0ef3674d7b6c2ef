//! Spherical overdensity masses, by counting.
//!
//! The mean density within r of a centre is Delta times the mean of the box at R with n(<=R) particles if
//!
//! ```text
//! R = R_k = (3 k L^3/(4 pi Delta N))^(1/3),   k = n(<=R_k)
//! ```
//!
//! The smallest such k that is not below `n_min` is taken: going outwards from the radius where `n_min` particles would do, the first one at which
//! the density has fallen to Delta. It is found without sorting: from k the number n(<=R_k) is the next k, for below it there is no solution.
//! Nothing is interpolated, and M = k m = (4 pi/3) R^3 Delta rho_m holds exactly.

use super::grid::{self, Grid};
use super::periodic::along;
use crate::exec::{Exec, for_each_piece};
use crate::pm::columns::Positions;
use crate::real::Real;
use crate::scratch::Layout;
use crate::status::{Error, Result};
use crate::within::Within;

/// What lies around a centre above a density. All zero if the centre is not that dense.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C)]
pub struct Sphere {
    /// Particles within the radius.
    pub members: u64,
    /// Members times the mass of a particle.
    pub mass: f64,
    /// R.
    pub radius: f64,
}

/// What spheres are measured against.
#[derive(Clone, Copy, Debug)]
pub struct Density {
    /// Side of the box.
    pub box_size: f64,
    /// Particles of the whole simulation.
    pub particles_total: u64,
    /// Mass of each.
    pub particle_mass: f64,
    /// The fewest particles of a sphere.
    pub n_min: u64,
}

/// Below this density a sphere need not fit the box.
const LEAST_OVERDENSITY: f64 = 2.0;

/// R_k: the radius at which k particles have the mean density Delta.
pub(super) fn radius(k: u64, overdensity: f64, box_size: f64, particles_total: u64) -> f64 {
    box_size
        * libm::cbrt(k as f64 * 3.0 / (4.0 * core::f64::consts::PI * overdensity * particles_total as f64))
}

/// Scratch of [`spheres`] and [`refine_centres`](super::refine_centres): with r = size of `T`, (3 r + 12) particles bytes, and at most 4.2 MB.
///
/// # Errors
/// `Overflow` for 2^32 particles and more, or if the bytes do not fit the address space.
///
/// # Example
/// ```
/// use fixpair::halos::spheres_scratch;
///
/// assert!(spheres_scratch::<f32>(1 << 24)?.size < 25 << 24);
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn spheres_scratch<T: Real>(particles: usize) -> Result<Layout> {
    grid::layout::<T>(particles)
}

/// Grows spheres about given centres until their mean density has fallen to each of some multiples of the mean density of matter.
///
/// `spheres`: `overdensities.len()` of them for each centre, in that order. `centres`: any finite places, taken modulo L. `overdensities`: Delta,
/// 2 and more: see [`Overdensity`](super::Overdensity). `position`: all particles that may lie in the spheres; of a slab: with ghosts as
/// deep as the largest radius.
///
/// # Errors
/// `Length`; `NotFinite`; `Range` for the box, the mass, no particles in total or fewer than there are here, `n_min` = 0, or an overdensity
/// below 2; `Overflow`, `Scratch`, `Alignment`; `Hook`, after which spheres are undefined.
///
/// Cost: a sort of the particles, then a few counts of those in each sphere. The same bits for any number of threads.
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
/// use fixpair::halos::{Density, Sphere, spheres};
///
/// let mut found = [Sphere { members: 0, mass: 0.0, radius: 0.0 }];
/// let density = Density { box_size: 10.0, particles_total: 3, particle_mass: 1e10, n_min: 2 };
/// spheres(&mut found, &[[0.0, 5.0, 5.0]], &[200.0], &position, &density, scratch, &Serial)?;
/// assert!(found[0].members == 2 && found[0].mass == 2e10); // R: two particles fill it to 200 means
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn spheres<T: Real>(
    spheres: &mut [Sphere],
    centres: &[[f64; 3]],
    overdensities: &[f64],
    position: &Positions<'_, T>,
    density: &Density,
    scratch: &mut [u8],
    exec: &dyn Exec,
) -> Result<()> {
    let Density { box_size, particles_total, particle_mass, n_min } = *density;
    let finite = centres.as_flattened().iter().chain(overdensities).all(|x| x.is_finite());
    if !(finite && particle_mass.is_finite()) {
        return Err(Error::NotFinite);
    }
    let sensible = particle_mass > 0.0
        && n_min > 0
        && particles_total >= position.len() as u64
        && particles_total > 0
        && overdensities.iter().all(|&delta| delta >= LEAST_OVERDENSITY);
    if !sensible {
        return Err(Error::Range);
    }
    let each = overdensities.len();
    if centres.len().checked_mul(each) != Some(spheres.len()) {
        return Err(Error::Length);
    }
    let grid = Grid::new(position, box_size, scratch, exec)?;
    for_each_piece(exec, spheres, each, &|i, spheres| {
        for (sphere, &delta) in spheres.iter_mut().zip(overdensities) {
            let radius = |k| radius(k, delta, box_size, particles_total);
            let centre = centres.at(i).map(|x| super::periodic::home(x, box_size));
            let members = grow(n_min, |k| count(&grid, centre, radius(k), box_size));
            *sphere = members.map_or_else(Sphere::default, |members| Sphere {
                members,
                mass: members as f64 * particle_mass,
                radius: radius(members),
            });
        }
    })
}

/// The smallest k >= `n_min` with count(k) = k, if count(`n_min`) >= `n_min`; count increases.
fn grow(n_min: u64, count: impl Fn(u64) -> u64) -> Option<u64> {
    let mut k = n_min;
    loop {
        let next = count(k);
        if next == k {
            return Some(k);
        }
        if next < k {
            return None;
        }
        k = next;
    }
}

/// Particles within r of a centre.
fn count<T: Real>(grid: &Grid<'_, T>, centre: [f64; 3], radius: f64, box_size: f64) -> u64 {
    let mut count = 0;
    grid.near(centre, radius, |places| {
        for place in places {
            let [x, y, z] = [0, 1, 2].map(|axis| along(place[axis].to_f64(), centre[axis], box_size));
            count += u64::from((x * x + y * y) + z * z <= radius * radius);
        }
    });
    count
}
