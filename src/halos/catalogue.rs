//! The catalogue: mass, centre, velocity and sizes of each group.
//!
//! With d and u the differences of positions and velocities from the means over the group's N particles of mass m:
//!
//! ```text
//! M = N m,   radius = sqrt(<d^2>),   dispersion = sqrt(<u^2>)
//! ```

use core::sync::atomic::{AtomicBool, Ordering};

use super::members::{self, Members};
use super::periodic::{check_finite, home};
use super::sort::sort_by_size;
use super::sums::{HaloSums, check, check_sums};
use crate::exec::Exec;
use crate::pm::columns::Positions;
use crate::real::Real;
use crate::scratch::Layout;
use crate::status::{Error, Result};

/// One group.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C)]
pub struct Halo {
    /// The smallest id in it.
    pub label: u64,
    /// Particles.
    pub members: u64,
    /// Members times the mass of a particle.
    pub mass: f64,
    /// Mean position, periodic, in [0, L).
    pub centre: [f64; 3],
    /// Mean velocity; 0 where none were given.
    pub velocity: [f64; 3],
    /// Root mean square distance from the centre.
    pub radius: f64,
    /// Sides of the smallest box parallel to the axes that holds it.
    pub extent: [f64; 3],
    /// Root mean square of the velocity about the mean, in three dimensions: sqrt(3) times that along a line, if isotropic.
    pub velocity_dispersion: f64,
}

impl Halo {
    fn new(sums: &HaloSums, particle_mass: f64, box_size: f64) -> Self {
        let n = sums.members as f64;
        let (d, u) = (sums.position.map(|x| x / n), sums.velocity.map(|x| x / n));
        let scatter = |squares: f64, mean: [f64; 3]| {
            let variance = squares / n - ((mean[0] * mean[0] + mean[1] * mean[1]) + mean[2] * mean[2]);
            libm::sqrt(variance.max(0.0))
        };
        Self {
            label: sums.label,
            members: sums.members,
            mass: n * particle_mass,
            centre: [0, 1, 2].map(|axis| home(sums.reference[axis] + d[axis], box_size)),
            velocity: [0, 1, 2].map(|axis| sums.reference_velocity[axis] + u[axis]),
            radius: scatter(sums.position_squared, d),
            extent: [0, 1, 2].map(|axis| sums.high[axis] - sums.low[axis]),
            velocity_dispersion: scatter(sums.velocity_squared, u),
        }
    }
}

/// `NotFinite`; `Range` unless the mass is positive and 2^64 of it are finite.
fn check_mass(particle_mass: f64) -> Result<()> {
    const MOST_MEMBERS: f64 = u64::MAX as f64;
    if !particle_mass.is_finite() {
        return Err(Error::NotFinite);
    }
    let sensible = particle_mass > 0.0 && (MOST_MEMBERS * particle_mass).is_finite();
    if sensible { Ok(()) } else { Err(Error::Range) }
}

/// Largest first; of equal ones the smaller label first.
fn sort(halos: &mut [Halo]) {
    sort_by_size(halos, |halo| (halo.members, halo.label));
}

/// Scratch of [`halo_count`], [`halos`] and [`halo_sums`](super::halo_sums): 12 bytes a particle, and at most 4.3 MB.
///
/// # Errors
/// `Overflow` for 2^32 particles and more, or if the bytes do not fit the address space.
///
/// # Example
/// ```
/// use fixpair::halos::halos_scratch;
///
/// assert!(halos_scratch(1 << 24)?.size < 13 << 24); // some 12 bytes a particle
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn halos_scratch(particles: usize) -> Result<Layout> {
    members::layout(particles)
}

/// How many groups have `n_min` particles and more: the places that [`halos`] needs.
///
/// `labels`: as for [`halos`]. `scratch`: see [`halos_scratch`].
///
/// # Errors
/// `Range` for `n_min` = 0; `Overflow`, `Scratch`, `Alignment`, `Hook`.
///
/// Cost: most of that of [`halos`].
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
/// use fixpair::halos::halo_count;
///
/// assert_eq!(halo_count(&labels, 2, scratch, &Serial)?, 1); // of two particles and more
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn halo_count(labels: &[u64], n_min: u64, scratch: &mut [u8], exec: &dyn Exec) -> Result<usize> {
    if n_min == 0 {
        return Err(Error::Range);
    }
    Ok(Members::new(labels, &|_, members| members >= n_min, scratch, exec)?.groups())
}

/// Writes the groups of `n_min` particles and more, the largest first and of equal ones the smaller label first. Returns how many.
///
/// `halos`: [`halo_count`] says how many; particles / `n_min` of them are always enough. `labels`: one a particle, from [`fof_labels`](super::fof_labels), or any other
/// numbers that tell groups apart. `particle_mass`: see [`particle_mass`](super::particle_mass).
///
/// # Errors
/// `Length`, also if `halos` is too short; `NotFinite`; `Range` for `n_min` = 0, the mass or the box; `Overflow`, `Scratch`, `Alignment`;
/// `Hook`, after which halos are undefined, as they are after `NotFinite` for velocities whose squares no number holds.
///
/// The same bits for any number of threads.
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
/// use fixpair::halos::{Halo, halos};
///
/// let mut found = [Halo::default()];
/// let count = halos(&mut found, &labels, &position, None, 10.0, 2, 1e10, scratch, &Serial)?;
/// assert!(count == 1 && found[0].members == 2 && found[0].mass == 2e10);
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn halos<T: Real>(
    halos: &mut [Halo],
    labels: &[u64],
    position: &Positions<'_, T>,
    velocity: Option<&Positions<'_, T>>,
    box_size: f64,
    n_min: u64,
    particle_mass: f64,
    scratch: &mut [u8],
    exec: &dyn Exec,
) -> Result<usize> {
    check(labels, position, velocity, box_size, n_min)?;
    check_mass(particle_mass)?;
    let keep = |_, members| members >= n_min;
    let members = Members::new(labels, &keep, scratch, exec)?;
    let groups = members.groups();
    let halos = halos.get_mut(..groups).ok_or(Error::Length)?;
    check_finite(position, exec)?;
    velocity.map_or(Ok(()), |velocity| check_finite(velocity, exec))?;
    let lost = AtomicBool::new(false);
    members.write(halos, exec, &|label, records| {
        let sums = HaloSums::of(label, records, position, velocity, box_size);
        if !sums.is_sound(box_size) {
            lost.store(true, Ordering::Relaxed);
        }
        Halo::new(&sums, particle_mass, box_size)
    })?;
    if lost.into_inner() {
        return Err(Error::NotFinite);
    }
    sort(halos);
    Ok(groups)
}

/// Turns sums of whole groups into a catalogue, ordered as by [`halos`], of those of `n_min` particles and more. Returns how many.
///
/// `halos`: as long as `sums`, or long enough.
///
/// # Errors
/// `Length`; `NotFinite`; `Range` for `n_min` = 0, the mass, the box, or a reference outside it. Nothing is then written.
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
/// use fixpair::halos::{Halo, HaloSums, halo_sums, halos_finish};
///
/// let (mut sums, mut found) = ([HaloSums::default()], [Halo::default()]);
/// halo_sums(&mut sums, &labels, &position, None, 10.0, 2, &[], scratch, &Serial)?;
/// assert_eq!(halos_finish(&mut found, &sums, 10.0, 2, 1e10)?, 1);
/// assert!(found[0].centre[0] < 1e-12 || found[0].centre[0] > 10.0 - 1e-12); // over the edge
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn halos_finish(
    halos: &mut [Halo],
    sums: &[HaloSums],
    box_size: f64,
    n_min: u64,
    particle_mass: f64,
) -> Result<usize> {
    check_sums(sums, box_size)?;
    check_mass(particle_mass)?;
    if n_min == 0 {
        return Err(Error::Range);
    }
    let kept = || sums.iter().filter(|sums| sums.members >= n_min);
    let halos = halos.get_mut(..kept().count()).ok_or(Error::Length)?;
    for (halo, sums) in halos.iter_mut().zip(kept()) {
        *halo = Halo::new(sums, particle_mass, box_size);
    }
    sort(halos);
    Ok(halos.len())
}
