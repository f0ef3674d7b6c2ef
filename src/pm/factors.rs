//! How far a step drifts and kicks: scalar functions for any integrator.
//!
//! Canonical velocity v = a^2 dx/dt/H0, in the unit of the box side. With F = -grad inverse-Laplacian delta (what [`forces`](fn@super::forces) gives,
//! in that unit too) and E = H/H0,
//!
//! ```text
//! dx/da = v/(a^3 E),    dv/da = (3/2) Om F/(a^2 E).
//! ```
//!
//! A drift from a0 to a1 adds d v to positions, v being known at `at`; a kick adds k F to velocities, F being known at `at`. `at` is usually between
//! a0 and a1 and may be either of them.
//!
//! ```text
//!            drift d                                       kick k
//! leapfrog   int da/(a^3 E)                                (3/2) Om int da/(a^2 E)
//! FastPM     [D(a1) - D(a0)]/G(at)                         [G(a1) - G(a0)]/D(at)
//! COLA       int (a/at)^n da/(a^3 E), for v - v_LPT        (3/2) Om [a1^n - a0^n]/(n at^(n-1))/(at^2 E(at)), for F - F_LPT
//! ```
//!
//! D is the growth factor and G = a^3 E dD/da = a^2 E f D the canonical velocity of a growing mode of unit displacement. The growth equation is
//! dG/da = (3/2) Om D/(a^2 E), so FastPM's kick is Feng et al.'s (2016, arXiv:1603.00476) -(3/2) Om [G(a1) - G(a0)]/G'(at)/(at^2 E(at)) of
//! grad inverse-Laplacian delta: with F = D(at) psi it moves a growing mode exactly, in steps of any length. COLA (Tassev, Zaldarriaga & Eisenstein
//! 2013, arXiv:1301.0322; n is their n_LPT) keeps second-order Lagrangian theory exact and integrates what is left, which moves as int a^n dt.
//!
//! All three are exact in the limit of short steps and agree there to second order.

use super::drift::Drift;
use super::kick::Kick;
use crate::cosmology::quadrature::integrate;
use crate::cosmology::{Cosmology, Growth, growth_many};
use crate::status::{Error, Result};
use crate::within::Within;

/// Relative accuracy of the integrals over a.
const TOLERANCE: f64 = 1e-12;

/// The exponent n that Tassev et al. recommend for about ten steps from z = 9.
pub const COLA_EXPONENT: f64 = -2.5;

/// How the equation of motion is cut into steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Stepper {
    /// Exact for growing modes of linear theory.
    FastPm,
    /// Exact for free motion and constant forces.
    Leapfrog,
    /// Exact for second-order Lagrangian perturbation theory; needs each particle's displacements.
    Cola {
        /// n of v - v_LPT proportional to a^n: not 0, within +-10. [`COLA_EXPONENT`] is usual.
        exponent: f64,
    },
}

/// What a drift or a kick adds: factor times velocity or force, and first psi1 + second psi2, with psi1 and psi2 the displacements of both orders
/// over their growth, D and D2.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C)]
pub struct StepFactors {
    /// What a drift multiplies the velocity by, and a kick the force.
    pub factor: f64,
    /// Of the first-order displacement over D: 0 but for COLA.
    pub first: f64,
    /// Of the second-order displacement over D2: 0 but for COLA.
    pub second: f64,
}

impl Stepper {
    /// `Range` for a COLA exponent of 0 or beyond +-10, `NotFinite`.
    ///
    /// # Errors
    /// See above.
    ///
    /// # Example
    /// ```
    /// use fixpair::pm::factors::Stepper;
    ///
    /// assert!(Stepper::Cola { exponent: f64::NAN }.check().is_err());
    /// ```
    pub fn check(&self) -> Result<()> {
        match *self {
            Self::Cola { exponent } if !exponent.is_finite() => Err(Error::NotFinite),
            Self::Cola { exponent } if exponent == 0.0 || libm::fabs(exponent) > 10.0 => Err(Error::Range),
            _ => Ok(()),
        }
    }

    /// Adds factor v + first psi1/D + second psi2/D2 to positions, for a full velocity v known at `at`.
    ///
    /// COLA drifts v - v_LPT and adds what Lagrangian theory moves: first = D(a1) - D(a0) - d G(at), second = D2(a1) - D2(a0) - d G2(at), with
    /// G2 = a^2 E f2 D2.
    ///
    /// # Errors
    /// As [`Stepper::check`] and [`growth_many`], for the three scale factors; `Convergence` if an integral is not accurate to 1e-12.
    ///
    /// Cost: 0.4 ms (one integration of the growth equations).
    ///
    /// # Example
    /// ```
    /// use fixpair::cosmology::Cosmology;
    /// use fixpair::pm::factors::Stepper;
    ///
    /// let drift = Stepper::FastPm.drift(&Cosmology::goliat(), 0.5, 0.6, 0.55)?; // velocities of a = 0.55
    /// assert!(drift.factor > 0.0 && drift.first == 0.0);
    /// # Ok::<(), fixpair::status::Error>(())
    /// ```
    pub fn drift(&self, cosmology: &Cosmology, from: f64, to: f64, at: f64) -> Result<StepFactors> {
        let epochs = self.epochs(cosmology, [from, to, at])?;
        let [start, end, known] = epochs;
        match *self {
            Self::FastPm => Ok(StepFactors::plain((end.d - start.d) / known.velocity)),
            Self::Leapfrog => Ok(StepFactors::plain(free_drift(cosmology, from, to, |_| 1.0)?)),
            Self::Cola { exponent } => {
                let factor = free_drift(cosmology, from, to, |a| libm::pow(a / at, exponent))?;
                let first = end.d - start.d - factor * known.velocity;
                let second = end.d2 - start.d2 - factor * known.second_velocity;
                Ok(StepFactors { factor, first, second })
            }
        }
    }

    /// Adds factor F + first psi1/D + second psi2/D2 to canonical velocities, for a force known at `at`.
    ///
    /// COLA kicks by F - F_LPT, F_LPT = D psi1 + (D2 - D^2) psi2, and adds what the velocities of Lagrangian theory change: first = G(a1) - G(a0) -
    /// k D(at), second = G2(a1) - G2(a0) - k (D2 - D^2)(at).
    ///
    /// # Errors
    /// As [`Stepper::drift`].
    ///
    /// Cost: 0.4 ms.
    ///
    /// # Example
    /// ```
    /// use fixpair::cosmology::Cosmology;
    /// use fixpair::pm::factors::Stepper;
    ///
    /// let kick = Stepper::FastPm.kick(&Cosmology::goliat(), 0.5, 0.6, 0.55)?; // forces of a = 0.55
    /// assert!(kick.factor != 0.0 && kick.second == 0.0);
    /// # Ok::<(), fixpair::status::Error>(())
    /// ```
    pub fn kick(&self, cosmology: &Cosmology, from: f64, to: f64, at: f64) -> Result<StepFactors> {
        let [start, end, known] = self.epochs(cosmology, [from, to, at])?;
        match *self {
            Self::FastPm => Ok(StepFactors::plain((end.velocity - start.velocity) / known.d)),
            Self::Leapfrog => {
                let rate = |a: f64| 1.0 / (a * a * libm::sqrt(cosmology.e_squared(a)));
                Ok(StepFactors::plain(1.5 * cosmology.omega_m * integral(rate, from, to)?))
            }
            Self::Cola { exponent: n } => {
                // a^n - 1, which does not cancel where n is small.
                let beyond = |a: f64| libm::expm1(n * libm::log(a / at));
                let time = (beyond(to) - beyond(from)) * at / n;
                let expansion = libm::sqrt(cosmology.e_squared(at));
                let factor = 1.5 * cosmology.omega_m * time / (at * at * expansion);
                let first = end.velocity - start.velocity - factor * known.d;
                let second =
                    end.second_velocity - start.second_velocity - factor * (known.d2 - known.d * known.d);
                Ok(StepFactors { factor, first, second })
            }
        }
    }

    fn epochs(&self, cosmology: &Cosmology, a: [f64; 3]) -> Result<[Epoch; 3]> {
        self.check()?;
        let mut growth = [Growth::default(); 3];
        growth_many(cosmology, &a, &mut growth)?;
        Ok([0, 1, 2].map(|i| {
            let (Growth { d, f, d2, f2, .. }, a) = (growth.at(i), a.at(i));
            let rate = a * a * libm::sqrt(cosmology.e_squared(a));
            Epoch { d, d2, velocity: rate * f * d, second_velocity: rate * f2 * d2 }
        }))
    }
}

impl StepFactors {
    fn plain(factor: f64) -> Self {
        Self { factor, first: 0.0, second: 0.0 }
    }
}

/// Both orders of growth at one time: displacements and canonical velocities.
struct Epoch {
    d: f64,
    d2: f64,
    velocity: f64,
    second_velocity: f64,
}

fn free_drift(cosmology: &Cosmology, from: f64, to: f64, shape: impl Fn(f64) -> f64) -> Result<f64> {
    integral(|a| shape(a) / (a * a * a * libm::sqrt(cosmology.e_squared(a))), from, to)
}

/// The integral over a, taken in ln a, in which it is smooth.
fn integral(f: impl Fn(f64) -> f64, from: f64, to: f64) -> Result<f64> {
    let of_log = |x: f64| {
        let a = libm::exp(x);
        a * f(a)
    };
    integrate(of_log, libm::log(from), libm::log(to), TOLERANCE)
}

/// Where the caller's arrays stand, and in which unit: turns [`StepFactors`] into coefficients for them.
#[derive(Clone, Copy, Debug)]
pub(super) struct Units {
    /// H0 in the unit of peculiar velocities over that of the box side.
    pub(super) hubble: f64,
    /// Of the caller's displacements: 1/D and 1/D2 where they were taken.
    pub(super) lpt: [f64; 2],
}

impl Units {
    /// For positions and peculiar velocities u = H0 v/a known at `at`.
    pub(super) fn drift(&self, of: StepFactors, at: f64) -> Drift {
        Drift {
            velocity: of.factor * at / self.hubble,
            first: of.first * self.lpt[0],
            second: of.second * self.lpt[1],
        }
    }

    /// For peculiar velocities from `from` to `to`.
    pub(super) fn kick(&self, of: StepFactors, from: f64, to: f64) -> Kick {
        let unit = self.hubble / to;
        Kick {
            keep: from / to,
            force: unit * of.factor,
            first: unit * of.first * self.lpt[0],
            second: unit * of.second * self.lpt[1],
        }
    }
}

/// Where half a step ends: the geometric mean.
///
/// ```
/// use fixpair::pm::factors::half_step;
///
/// let middle = half_step(0.4, 0.6);
/// assert!(0.4 < middle && middle < 0.6);
/// ```
#[must_use]
pub fn half_step(from: f64, to: f64) -> f64 {
    libm::sqrt(from * to)
}

/// Fills a list of scale factors with equal steps of a; the first and last are exact.
///
/// # Errors
/// `NotFinite`; `Range` unless 0 < from < to; `Length` for fewer than two entries.
///
/// # Example
/// ```
/// use fixpair::pm::factors::linear_steps;
///
/// let mut a = [0.0; 3];
/// linear_steps(&mut a, 0.5, 1.0)?;
/// assert_eq!(a, [0.5, 0.75, 1.0]);
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn linear_steps(scale_factors: &mut [f64], from: f64, to: f64) -> Result<()> {
    steps(scale_factors, from, to, |part| from + (to - from) * part)
}

/// Fills a list of scale factors with equal steps of ln a; the first and last are exact.
///
/// # Errors
/// As [`linear_steps`].
///
/// # Example
/// ```
/// use fixpair::pm::factors::logarithmic_steps;
///
/// let mut a = [0.0; 3];
/// logarithmic_steps(&mut a, 0.25, 1.0)?;
/// assert!((a[1] - 0.5).abs() < 1e-15);
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn logarithmic_steps(scale_factors: &mut [f64], from: f64, to: f64) -> Result<()> {
    let (low, high) = (libm::log(from), libm::log(to));
    steps(scale_factors, from, to, |part| libm::exp(low + (high - low) * part))
}

fn steps(scale_factors: &mut [f64], from: f64, to: f64, at: impl Fn(f64) -> f64) -> Result<()> {
    if !from.is_finite() || !to.is_finite() {
        return Err(Error::NotFinite);
    }
    if !(from > 0.0 && from < to) {
        return Err(Error::Range);
    }
    let last = scale_factors.len().checked_sub(1).filter(|&last| last > 0).ok_or(Error::Length)?;
    let mut reached = from;
    for (i, a) in scale_factors.iter_mut().enumerate() {
        // By rounding a step could lead back, or beyond the end, where the ends are neighbours.
        reached = if i == last { to } else { at(i as f64 / last as f64).max(reached).min(to) };
        *a = if i == 0 { from } else { reached };
    }
    Ok(())
}
