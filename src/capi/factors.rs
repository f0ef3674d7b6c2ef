//! How far a step drifts and kicks.

use super::border::Border;
use super::cosmology::fixpair_cosmology;
use super::status::{code, fixpair_status_t};
use crate::cosmology::Cosmology;
use crate::pm::factors::{self, StepFactors, Stepper};
use crate::status::{Error, Result};

/// FastPM (Feng et al. 2016, arXiv:1603.00476): exact for growing modes of linear theory, in steps of any length.
pub const FIXPAIR_STEPPER_FASTPM: i32 = 0;
/// Plain leapfrog: exact for free motion and constant forces.
pub const FIXPAIR_STEPPER_LEAPFROG: i32 = 1;
/// COLA (Tassev, Zaldarriaga & Eisenstein 2013, arXiv:1301.0322): exact for second-order Lagrangian theory.
pub const FIXPAIR_STEPPER_COLA: i32 = 2;

/// The exponent n_LPT of COLA that its authors recommend.
pub const FIXPAIR_COLA_EXPONENT: f64 = -2.5;
const _: () = assert!(FIXPAIR_COLA_EXPONENT == factors::COLA_EXPONENT, "the header and Rust agree");

pub(super) fn stepper(choice: i32, cola_exponent: f64) -> Result<Stepper> {
    match choice {
        FIXPAIR_STEPPER_FASTPM => Ok(Stepper::FastPm),
        FIXPAIR_STEPPER_LEAPFROG => Ok(Stepper::Leapfrog),
        FIXPAIR_STEPPER_COLA => Ok(Stepper::Cola { exponent: cola_exponent }),
        _ => Err(Error::Choice),
    }
}

/// The factors of a drift, for any integrator: x += factor v + first psi1 + second psi2.
///
/// Canonical velocity v = a^2 dx/dt/H0 in the unit of x: v = a u/H0 for the peculiar velocity u (H0 = 100 km/s per Mpc/h). At its time `at`, usually
/// between `from` and `to`, it is known; E = H/H0, D the growth factor, G = a^2 E f D:
///
///   FastPM    factor = [D(to) - D(from)]/G(at)
///   leapfrog  factor = int da/(a^3 E)
///   COLA      factor = int (a/at)^n da/(a^3 E), for v - v_LPT; first = D(to) - D(from) - factor G(at), second the same of D2
///
/// psi1 and psi2 are the displacements of both orders over D and over D2, so psi1 = x - q today in linear theory; first and second are 0 but for
/// COLA. v is the full velocity.
///
/// Out: factors
/// In:  cosmology
///      stepper        FIXPAIR_STEPPER_FASTPM, _LEAPFROG or _COLA
///      cola_exponent  n, usually FIXPAIR_COLA_EXPONENT; read for COLA only: not 0, within +-10
///      from, to, at   scale factors from 1e-5 to 10, in any order
/// Returns: 0, FIXPAIR_ERROR_NULL, _ALIGNMENT, _OVERLAP, _NOT_FINITE, _RANGE, _CHOICE, _VERSION, _CONVERGENCE
/// Cost: 0.4 ms
///
/// # Safety
/// Pointers are null or point to one value.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_drift_factors(
    factors: *mut StepFactors,
    cosmology: *const fixpair_cosmology,
    stepper: i32,
    cola_exponent: f64,
    from: f64,
    to: f64,
    at: f64,
) -> fixpair_status_t {
    // SAFETY: the caller's promise.
    code(unsafe { answer(factors, cosmology, stepper, cola_exponent, [from, to, at], Stepper::drift) })
}

/// The factors of a kick, for any integrator: v += factor F + first psi1 + second psi2.
///
/// F = -grad inverse-Laplacian delta, what fixpair_forces_f64 gives, is known at its time `at`; all else as for fixpair_drift_factors.
///
///   FastPM    factor = [G(to) - G(from)]/D(at)
///   leapfrog  factor = (3/2) Om int da/(a^2 E)
///   COLA      factor = (3/2) Om [to^n - from^n]/(n at^(n-1))/(at^2 E(at)), for F - F_LPT; first = G(to) - G(from) - factor D(at),
///             second = G2(to) - G2(from) - factor (D2 - D^2)(at), G2 = a^2 E f2 D2
///
/// Peculiar velocities u go by u_new = (from/to) u + (H0/to) (factor F + ...).
///
/// Out: factors
/// In:  as for fixpair_drift_factors
/// Returns: as fixpair_drift_factors
/// Cost: 0.4 ms
///
/// # Safety
/// Pointers are null or point to one value.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_kick_factors(
    factors: *mut StepFactors,
    cosmology: *const fixpair_cosmology,
    stepper: i32,
    cola_exponent: f64,
    from: f64,
    to: f64,
    at: f64,
) -> fixpair_status_t {
    // SAFETY: the caller's promise.
    code(unsafe { answer(factors, cosmology, stepper, cola_exponent, [from, to, at], Stepper::kick) })
}

unsafe fn answer(
    factors: *mut StepFactors,
    cosmology: *const fixpair_cosmology,
    choice: i32,
    cola_exponent: f64,
    [from, to, at]: [f64; 3],
    ask: fn(&Stepper, &Cosmology, f64, f64, f64) -> Result<StepFactors>,
) -> Result<()> {
    let mut border = Border::new();
    // SAFETY: the caller's promise.
    let (out, cosmology) = unsafe { (border.write_one(factors)?, border.read_one(cosmology)?) };
    let stepper = stepper(choice, cola_exponent)?;
    *out = ask(&stepper, &cosmology.check()?, from, to, at)?;
    Ok(())
}

/// Equal steps of the scale factor; the first and last entries are exactly `from` and `to`.
///
/// Out: scale_factors  len values: len - 1 steps
/// In:  from, to       0 < from < to
/// Returns: 0, FIXPAIR_ERROR_NULL, _LENGTH for fewer than two entries, _ALIGNMENT, _NOT_FINITE, _RANGE
///
/// # Safety
/// Pointers are null or point to as many values as stated.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_linear_steps(
    scale_factors: *mut f64,
    len: usize,
    from: f64,
    to: f64,
) -> fixpair_status_t {
    // SAFETY: the caller's promise.
    let out = unsafe { Border::new().write(scale_factors, len) };
    code(out.and_then(|out| factors::linear_steps(out, from, to)))
}

/// Equal steps of the logarithm of the scale factor; the first and last entries are exactly `from` and `to`.
///
/// Out, In, Returns: as fixpair_linear_steps
///
/// # Safety
/// Pointers are null or point to as many values as stated.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_logarithmic_steps(
    scale_factors: *mut f64,
    len: usize,
    from: f64,
    to: f64,
) -> fixpair_status_t {
    // SAFETY: the caller's promise.
    let out = unsafe { Border::new().write(scale_factors, len) };
    code(out.and_then(|out| factors::logarithmic_steps(out, from, to)))
}
