//! Drifts: particles moved along their velocities, x_i <- x_i + velocity u_i + first psi1_i + second psi2_i, modulo the box.
//!
//! psi are displacements of the particles themselves, for COLA (Tassev, Zaldarriaga & Eisenstein 2013, arXiv:1301.0322). The coefficients are the
//! stepper's: they carry all factors of time and all units.

use core::sync::atomic::{AtomicBool, Ordering};

use super::columns::{Positions, load_components, store_components};
use super::frame::BLOCK;
use super::kick::{Lpt, Terms};
use super::sort::CHUNK;
use crate::exec::Exec;
use crate::initial::particles::{Components, wrap, wrap_once};
use crate::real::Real;
use crate::simd::Simd;
use crate::status::{Error, Result};

/// Coefficients of a drift: position <- position + `velocity` u + `first` psi1 + `second` psi2.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drift {
    /// Of the velocity.
    pub velocity: f64,
    /// Of the first-order displacement.
    pub first: f64,
    /// Of the second-order displacement.
    pub second: f64,
}

/// Moves particles: x_i <- x_i + velocity u_i + first psi1_i + second psi2_i, wrapped into [0, L), summed in `f64` and rounded once.
///
/// `position`: any finite numbers before, in [0, `box_size`) after. `lpt`: needed where `first` or `second` is not 0.
///
/// # Errors
/// `NotFinite` for the box or a coefficient, `Range` for a box that is not positive in `T`, `Null` for displacements that a coefficient asks for
/// and that are not there, `Length`, `Hook`; `NotFinite` also for a particle whose place is not finite or more than 1e9 boxes away: positions
/// are then written but meaningless.
///
/// The same bits for any number of threads. Cost: one pass over positions, velocities and displacements.
///
/// # Example
/// ```
/// use fixpair::exec::Serial;
/// use fixpair::initial::particles::Components;
/// use fixpair::pm::{Drift, Positions, drift};
///
/// let (mut x, v) = ([9.0, 5.0, 5.0], [2.0, 0.0, 0.0]);
/// let step = Drift { velocity: 1.0, first: 0.0, second: 0.0 };
/// drift(&mut Components::triples(&mut x)?, &Positions::triples(&v)?, 10.0, &step, None, &Serial)?;
/// assert_eq!(x, [1.0, 5.0, 5.0]); // wrapped
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn drift<T: Real>(
    position: &mut Components<'_, T>,
    velocity: &Positions<'_, T>,
    box_size: f64,
    drift: &Drift,
    lpt: Option<&Lpt<'_, T>>,
    exec: &dyn Exec,
) -> Result<()> {
    drift_with(Simd::detect(), position, velocity, box_size, drift, lpt, exec)
}

pub(super) fn drift_with<T: Real>(
    simd: Simd,
    position: &mut Components<'_, T>,
    velocity: &Positions<'_, T>,
    box_size: f64,
    drift: &Drift,
    lpt: Option<&Lpt<'_, T>>,
    exec: &dyn Exec,
) -> Result<()> {
    if !(box_size.is_finite() && drift.velocity.is_finite()) {
        return Err(Error::NotFinite);
    }
    let edge = T::from_f64(box_size);
    if !(edge > T::ZERO && edge.is_finite()) {
        return Err(Error::Range);
    }
    let particles = position.len();
    if velocity.len() != particles {
        return Err(Error::Length);
    }
    let lpt = Terms::new(lpt, [drift.first, drift.second], particles)?;
    let position = &*position;
    let moved = Moved { position, velocity, box_size, edge, factor: drift.velocity, lpt };
    let lost = AtomicBool::new(false);
    exec.parallel_for(particles.div_ceil(CHUNK), &|chunk| {
        let end = particles.min((chunk + 1) * CHUNK);
        let sound = simd.vectorise(
            #[inline(always)]
            || {
                let mut sound = true;
                for first in (chunk * CHUNK..end).step_by(BLOCK) {
                    // SAFETY: the particles exist, and each is moved by one thread.
                    sound &= unsafe { moved.block(first, BLOCK.min(end - first)) };
                }
                sound
            },
        );
        if !sound {
            lost.store(true, Ordering::Relaxed);
        }
    })?;
    if lost.into_inner() { Err(Error::NotFinite) } else { Ok(()) }
}

/// Particles on their way.
struct Moved<'a, 'b, T> {
    position: &'a Components<'b, T>,
    velocity: &'a Positions<'a, T>,
    box_size: f64,
    edge: T,
    factor: f64,
    lpt: Terms<'a, T>,
}

impl<T: Real> Moved<'_, '_, T> {
    /// Moves a block of consecutive particles; returns whether all of them have a place in the box.
    ///
    /// # Safety
    /// The particles exist, `count` is at most [`BLOCK`], and no other thread touches their positions now.
    #[inline(always)]
    unsafe fn block(&self, first: usize, count: usize) -> bool {
        let (mut x, mut u) = ([[T::ZERO; BLOCK]; 3], [[T::ZERO; BLOCK]; 3]);
        // SAFETY: as the caller says; velocities are as many as positions.
        unsafe {
            load_components(self.position, first, count, &mut x);
            self.velocity.load_all(first, count, 0, &mut u);
        }
        let mut sum = [[0.0; BLOCK]; 3];
        for axis in 0..3 {
            for i in 0..BLOCK {
                sum[axis][i] = x[axis][i].to_f64() + self.factor * u[axis][i].to_f64();
            }
        }
        // SAFETY: displacements are as many too.
        unsafe { self.lpt.add(first, count, &mut sum) };
        let mut lost = 0;
        for axis in 0..3 {
            let (place, sum) = (&mut x[axis], &mut sum[axis]);
            let mut outside = 0;
            for i in 0..BLOCK {
                sum[i] = wrap_once(sum[i], self.box_size);
                outside += u64::from(!(sum[i] >= 0.0 && sum[i] < self.box_size));
            }
            if outside > 0 {
                sum.iter_mut().for_each(|x| *x = wrap(*x, self.box_size));
            }
            for i in 0..BLOCK {
                // Rounding to the particles' type may reach the far edge, which is the near edge of the next box.
                let rounded = T::from_f64(sum[i]);
                place[i] = if rounded >= self.edge { T::ZERO } else { rounded };
                // NaN where it is lost.
                let found = place[i] >= T::ZERO;
                lost += u64::from(!found);
            }
        }
        // SAFETY: as the caller says.
        unsafe { store_components(self.position, first, count, &x) };
        lost == 0
    }
}
