//! Matched simulations and control variates.

use core::ffi::c_void;

use super::border::Border;
use super::fof::query;
use super::status::{code, fixpair_status_t};
use crate::scratch::Layout;
use crate::status::Error;
use crate::variance::control::{self, Beta, ControlVariate};
use crate::variance::matched::{self, Estimate, MatchedDifference};

/// beta is a number of the caller's: 1 for a plain difference.
pub const FIXPAIR_BETA_GIVEN: i32 = 0;
/// beta of least scatter, from the samples themselves.
pub const FIXPAIR_BETA_OPTIMAL: i32 = 1;

/// The difference of matched estimates, Delta f = f100 - f0 (Avila & Adame 2022, Eq. diff), with both scatters, their correlation, and its own.
/// f100 is the first, f0 the second.
///
/// Out: difference
/// In:  first, second  len estimates each, of the same seeds in the same order; a pair is one estimate
/// Returns: 0, FIXPAIR_ERROR_NULL, _ALIGNMENT, _OVERLAP, _OVERFLOW, _NOT_FINITE, FIXPAIR_ERROR_SAMPLES for fewer than two, FIXPAIR_ERROR_SINGULAR where one of the two does not vary,
///          FIXPAIR_ERROR_RANGE if a sum overflows
///
/// # Safety
/// Pointers are null or point to as many values as stated.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_matched_difference(
    difference: *mut MatchedDifference,
    first: *const f64,
    second: *const f64,
    len: usize,
) -> fixpair_status_t {
    code((|| {
        let mut border = Border::new();
        // SAFETY: the caller's promise.
        unsafe {
            let difference = border.write_one(difference)?;
            *difference = matched::matched_difference(border.read(first, len)?, border.read(second, len)?)?;
        }
        Ok(())
    })())
}

/// Scatter of a difference: sqrt(s1^2 + s2^2 - 2 rho s1 s2) (Eq. correlation).
///
/// Out: sigma
/// In:  first, second  s1, s2
///      correlation    rho
/// Returns: 0, FIXPAIR_ERROR_NULL, _ALIGNMENT, _NOT_FINITE, FIXPAIR_ERROR_RANGE for negative scatter, |rho| > 1, or a result that overflows
///
/// # Safety
/// `sigma` is null or points to one value.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_difference_sigma(
    sigma: *mut f64,
    first: f64,
    second: f64,
    correlation: f64,
) -> fixpair_status_t {
    code((|| {
        // SAFETY: the caller's promise.
        let sigma = unsafe { Border::new().write_one(sigma) }?;
        *sigma = matched::difference_sigma(first, second, correlation)?;
        Ok(())
    })())
}

/// V_eff/V: how many simulations of the reference one simulation is worth, (sigma_ref/sigma)^2 (m_ref/m).
///
/// Each sigma is that of an estimate, which costs m simulations: 2 for a pair. In a matched difference count the other half too if it is run for the
/// purpose; the paper's table does not.
///
/// Out: volume
/// In:  reference, reference_simulations  sigma_ref, m_ref
///      sigma, simulations                sigma, m
/// Returns: 0, FIXPAIR_ERROR_NULL, _ALIGNMENT, _NOT_FINITE, FIXPAIR_ERROR_RANGE for sigma that is not positive, no simulations, or a result that overflows
///
/// # Safety
/// `volume` is null or points to one value.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_effective_volume(
    volume: *mut f64,
    reference: f64,
    reference_simulations: u64,
    sigma: f64,
    simulations: u64,
) -> fixpair_status_t {
    code((|| {
        // SAFETY: the caller's promise.
        let volume = unsafe { Border::new().write_one(volume) }?;
        *volume = matched::effective_volume(reference, reference_simulations, sigma, simulations)?;
        Ok(())
    })())
}

/// p = b - (b - 1) f/f_true of halos whose f_NL was measured as if p = 1, in a universe of f_true (Eq. p).
///
/// Out: p, error
/// In:  b_g, b_g_error, f_nl, f_nl_error  measured, with standard errors
///      covariance  of the two; 0 where it is not known
///      f_true
/// Returns: 0, FIXPAIR_ERROR_NULL, _ALIGNMENT, _OVERLAP, _NOT_FINITE, FIXPAIR_ERROR_RANGE for f_true = 0, negative errors, a covariance beyond the product of the errors, or a result that overflows
///
/// # Safety
/// Pointers are null or point to one value.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_universality(
    p: *mut f64,
    error: *mut f64,
    b_g: f64,
    b_g_error: f64,
    f_nl: f64,
    f_nl_error: f64,
    covariance: f64,
    f_true: f64,
) -> fixpair_status_t {
    code((|| {
        let mut border = Border::new();
        // SAFETY: the caller's promise.
        let (p, error) = unsafe { (border.write_one(p)?, border.write_one(error)?) };
        let b_g = Estimate { value: b_g, error: b_g_error };
        let f_nl = Estimate { value: f_nl, error: f_nl_error };
        let estimate = matched::universality(b_g, f_nl, covariance, f_true)?;
        (*p, *error) = (estimate.value, estimate.error);
        Ok(())
    })())
}

/// Scratch of fixpair_control_variates: 16 bytes a sample.
///
/// Out: scratch
/// In:  samples
/// Returns: 0, FIXPAIR_ERROR_NULL, _ALIGNMENT, _OVERFLOW
///
/// # Safety
/// `scratch` is null or points to one value.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_control_variates_scratch(
    scratch: *mut Layout,
    samples: usize,
) -> fixpair_status_t {
    // SAFETY: the caller's promise.
    code(unsafe { query(scratch, samples, control::control_variates_scratch) })
}

/// The expectation of y from few costly simulations, by controls c of the same seeds whose expectation mu is known: <y> - beta (<c> - mu), a control for each value (CARPool,
/// Chartier et al. 2021, arXiv:2009.08970). With y = f100, c = f0, mu = 0 and beta = 1 the mean is Delta f of Eq. diff; the optimal beta gains more:
///
/// ```text
///     beta = cov(y, c)/(var(c) + N error^2)
/// ```
///
/// The error is that of a regression: it pays for estimating beta, on average with fixpair_control_variate_loss, and for the error of mu. The optimal
/// beta trusts mu: where the model that gives it is wrong, <c> - mu is many errors from 0, the result is shifted by beta times that, and its error grows.
///
/// Out: values   values_len structs, one for each value of a sample
/// In:  y, c     samples x values_len doubles each, row by row; a pair is one sample
///      samples  N
///      mu       values_len expectations of c
///      error    values_len standard errors of mu: s_c/sqrt(N_c) from N_c cheap simulations of their own; NULL where mu is exact
///      choice   FIXPAIR_BETA_...
///      beta     read with FIXPAIR_BETA_GIVEN only
///      scratch  scratch_len bytes
/// Returns: 0, FIXPAIR_ERROR_NULL, _ALIGNMENT, _OVERLAP, _OVERFLOW, _NOT_FINITE, _CHOICE, _SCRATCH, FIXPAIR_ERROR_LENGTH for no values, FIXPAIR_ERROR_SAMPLES for fewer than two samples, or four for
///          the optimal beta, FIXPAIR_ERROR_SINGULAR where y or c does not vary, FIXPAIR_ERROR_RANGE for a negative error or a sum that overflows
///
/// # Safety
/// Pointers are null or point to as many values as stated.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_control_variates(
    values: *mut ControlVariate,
    values_len: usize,
    y: *const f64,
    c: *const f64,
    samples: usize,
    mu: *const f64,
    error: *const f64,
    choice: i32,
    beta: f64,
    scratch: *mut c_void,
    scratch_len: usize,
) -> fixpair_status_t {
    code((|| {
        let mut border = Border::new();
        let len = samples.checked_mul(values_len).ok_or(Error::Overflow)?;
        // SAFETY: the caller's promise.
        unsafe {
            let values = border.write(values, values_len)?;
            let (y, c) = (border.read(y, len)?, border.read(c, len)?);
            let (mu, error) = (border.read(mu, values_len)?, border.read_optional(error, values_len)?);
            let scratch = border.scratch(scratch, scratch_len)?;
            let beta = match choice {
                FIXPAIR_BETA_GIVEN => Beta::Given(beta),
                FIXPAIR_BETA_OPTIMAL => Beta::Optimal,
                _ => return Err(Error::Choice),
            };
            control::control_variates(values, y, c, mu, error, beta, scratch)
        }
    })())
}

/// V_eff of y - beta c over that of y, sigma_y^2/(sigma_y^2 - 2 beta rho sigma_y sigma_c + beta^2 sigma_c^2): 1/(1 - rho^2) for the optimum beta = rho sigma_y/sigma_c.
///
/// Out: gain
/// In:  sigma_y, sigma_c, correlation, beta
/// Returns: 0, FIXPAIR_ERROR_NULL, _ALIGNMENT, _NOT_FINITE, FIXPAIR_ERROR_RANGE for sigma_y = 0, negative scatter, |rho| > 1, or a gain that overflows
///
/// # Safety
/// `gain` is null or points to one value.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_control_variate_gain(
    gain: *mut f64,
    sigma_y: f64,
    sigma_c: f64,
    correlation: f64,
    beta: f64,
) -> fixpair_status_t {
    code((|| {
        // SAFETY: the caller's promise.
        let gain = unsafe { Border::new().write_one(gain) }?;
        *gain = control::control_variate_gain(sigma_y, sigma_c, correlation, beta)?;
        Ok(())
    })())
}

/// How much the variance of a mean grows, on average, because the coefficients of q controls come from the same N samples: (N - 2)/(N - q - 2) (Lavenberg & Welch 1981).
///
/// Out: loss
/// In:  estimates  N
///      controls   q: 1 for each value of fixpair_control_variates
/// Returns: 0, FIXPAIR_ERROR_NULL, _ALIGNMENT, FIXPAIR_ERROR_SAMPLES unless N >= q + 3
///
/// # Safety
/// `loss` is null or points to one value.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_control_variate_loss(
    loss: *mut f64,
    estimates: u64,
    controls: u64,
) -> fixpair_status_t {
    code((|| {
        // SAFETY: the caller's promise.
        let loss = unsafe { Border::new().write_one(loss) }?;
        *loss = control::control_variate_loss(estimates, controls)?;
        Ok(())
    })())
}
