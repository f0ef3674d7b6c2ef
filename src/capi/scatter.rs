//! Models of the scatter of spectra, their fit, and comparisons of means.

use super::border::Border;
use super::status::{code, fixpair_status_t};
use crate::status::{Error, Result};
use crate::variance::models::{self, Suppression};
use crate::variance::ratios::{self, Means};
use crate::variance::suppression::{self, Scatter, SuppressionFit};

/// Modes in shells of the continuum, counting k and -k: N_k = L^3 k^2 dk/(2 pi^2). With them fixpair_sigma_gaussian is Eq. sigma_th as printed; exact
/// numbers are those of fixpair_lattice_modes and fixpair_binning_read.
///
/// Out: modes     len doubles
/// In:  k         len wavenumbers, h/Mpc
///      width     dk, h/Mpc
///      box_size  L, Mpc/h
/// Returns: 0, FIXPAIR_ERROR_NULL, _ALIGNMENT, _OVERLAP, _OVERFLOW, _NOT_FINITE, FIXPAIR_ERROR_RANGE for numbers that are not positive, or too extreme
///
/// # Safety
/// Pointers are null or point to as many values as stated.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_continuum_modes(
    modes: *mut f64,
    k: *const f64,
    len: usize,
    width: f64,
    box_size: f64,
) -> fixpair_status_t {
    code((|| {
        let mut border = Border::new();
        // SAFETY: the caller's promise.
        let (modes, k) = unsafe { (border.write(modes, len)?, border.read(k, len)?) };
        models::continuum_modes(modes, k, width, box_size)
    })())
}

/// The exact number of modes with edges[b] <= |n|^2 < edges[b + 1], n the integers k L/(2 pi), counting n and -n: 26, 66, 158, 234, ... of edges 1, 4, 9, 16, ... An edge of 0 counts n = 0 too.
///
/// Out: counts  edges_len - 1 numbers
/// In:  edges   edges_len integers, increasing
/// Returns: 0, FIXPAIR_ERROR_NULL, _ALIGNMENT, _OVERLAP, _OVERFLOW, FIXPAIR_ERROR_TABLE for fewer than two edges or edges that do not increase, FIXPAIR_ERROR_RANGE for an edge beyond 2^28
///
/// # Safety
/// Pointers are null or point to as many values as stated.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_lattice_modes(
    counts: *mut u64,
    edges: *const u64,
    edges_len: usize,
) -> fixpair_status_t {
    code((|| {
        let mut border = Border::new();
        let len = edges_len.checked_sub(1).ok_or(Error::Table)?;
        // SAFETY: the caller's promise.
        let (counts, edges) = unsafe { (border.write(counts, len)?, border.read(edges, edges_len)?) };
        models::lattice_modes(counts, edges)
    })())
}

/// Scatter of P of a Gaussian field sampled by Poisson points: sigma = sqrt(2/N_k) (P + noise) (Avila & Adame 2022, Eq. sigma_th).
///
/// Out: sigma  len doubles, (Mpc/h)^3
/// In:  power  len values of P without shot noise
///      modes  len numbers N_k
///      noise  1/n; 0 for a field
/// Returns: 0, FIXPAIR_ERROR_NULL, _ALIGNMENT, _OVERLAP, _OVERFLOW, _NOT_FINITE, FIXPAIR_ERROR_RANGE for modes or a sigma that are not positive, negative noise, or a
///          sigma that overflows
///
/// # Safety
/// Pointers are null or point to as many values as stated.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_sigma_gaussian(
    sigma: *mut f64,
    power: *const f64,
    modes: *const f64,
    len: usize,
    noise: f64,
) -> fixpair_status_t {
    code((|| {
        let mut border = Border::new();
        // SAFETY: the caller's promise.
        let (sigma, power, modes) =
            unsafe { (border.write(sigma, len)?, border.read(power, len)?, border.read(modes, len)?) };
        models::sigma_gaussian(sigma, power, modes, noise)
    })())
}

/// Scatter of P of fixed simulations, per simulation (Eq. sigma_fix with the plus that its text and its fits need):
///
/// ```text
///     sigma_r = sqrt(2/N_k) (P [R_cv + (1 - R_cv) (2/pi) atan(k/k_soft)] + f_sn noise)
/// ```
///
/// Out: sigma        len doubles, (Mpc/h)^3
/// In:  suppression  R_cv, k_soft, f_sn
///      k            len wavenumbers, in the unit of k_soft
///      power, modes, noise as for fixpair_sigma_gaussian
/// Returns: as fixpair_sigma_gaussian; FIXPAIR_ERROR_RANGE for k or k_soft that is not positive, negative R_cv or f_sn
///
/// # Safety
/// Pointers are null or point to as many values as stated.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_sigma_suppressed(
    sigma: *mut f64,
    suppression: *const Suppression,
    k: *const f64,
    power: *const f64,
    modes: *const f64,
    len: usize,
    noise: f64,
) -> fixpair_status_t {
    code((|| {
        let mut border = Border::new();
        // SAFETY: the caller's promise.
        unsafe {
            let (sigma, suppression) = (border.write(sigma, len)?, border.read_one(suppression)?);
            let (k, power, modes) =
                (border.read(k, len)?, border.read(power, len)?, border.read(modes, len)?);
            models::sigma_suppressed(sigma, suppression, k, power, modes, noise)
        }
    })())
}

/// Fits R_cv, k_soft and f_sn to a measured scatter by weighted least squares (tab:fits; the paper takes k < 0.4 h/Mpc). All of k_soft is searched: there is nothing to
/// start from.
///
/// Without errors they are sigma_r/sqrt(2 (N - 1)) (Eq. errerr) of the model, found by iteration. Errors in proportion to the measured scatter, as the
/// paper's, favour bins that happen to scatter little: sigma_r then comes out low by about 1/N.
///
/// Out: fit
/// In:  sigma      len measured scatters per simulation, see fixpair_sigma_per_simulation
///      error      len errors of them, or NULL
///      k, power, modes, noise as for fixpair_sigma_suppressed; with noise = 0 f_sn is 1 and has no error
///      estimates  N, independent ones; not read where there are errors
/// Returns: 0, FIXPAIR_ERROR_NULL, _ALIGNMENT, _OVERLAP, _OVERFLOW, _NOT_FINITE, FIXPAIR_ERROR_RANGE for k, modes, sigma or errors that are not positive, or negative noise,
///          FIXPAIR_ERROR_SAMPLES for fewer bins than parameters or fewer than two estimates, FIXPAIR_ERROR_SINGULAR where the data have no step (use the measured scatter, or that of fixpair_sigma_gaussian), FIXPAIR_ERROR_CONVERGENCE
/// Cost: 5 microseconds a bin and search, some ten searches without errors
///
/// # Safety
/// Pointers are null or point to as many values as stated.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_fit_suppression(
    fit: *mut SuppressionFit,
    sigma: *const f64,
    error: *const f64,
    k: *const f64,
    power: *const f64,
    modes: *const f64,
    len: usize,
    noise: f64,
    estimates: u64,
) -> fixpair_status_t {
    code((|| {
        let mut border = Border::new();
        // SAFETY: the caller's promise.
        unsafe {
            let fit = border.write_one(fit)?;
            let (sigma, error) = (border.read(sigma, len)?, border.read_optional(error, len)?);
            let (k, power, modes) =
                (border.read(k, len)?, border.read(power, len)?, border.read(modes, len)?);
            let scatter = Scatter { sigma, k, power, modes, noise };
            *fit = match error {
                Some(error) => suppression::fit_suppression_weighted(&scatter, error)?,
                None => suppression::fit_suppression(&scatter, estimates)?,
            };
        }
        Ok(())
    })())
}

/// # Safety
/// Pointers are null or point to `len` values.
unsafe fn means<'a>(
    border: &mut Border,
    mean: *const f64,
    error: *const f64,
    len: usize,
) -> Result<Means<'a>> {
    // SAFETY: the caller's promise.
    unsafe { Ok(Means { mean: border.read(mean, len)?, error: border.read(error, len)? }) }
}

/// Ratio of two means a/b, Fixed over Normal, and its error |a/b| sqrt(r_a^2 + r_b^2 - 2 rho r_a r_b) with the relative errors r.
///
/// Out: ratio, error   len doubles each
/// In:  above, above_error, below, below_error  len means a and b and their standard errors
///      correlation    len coefficients rho of the two means: for simulations that share their seeds that of their values; NULL where they are independent
/// Returns: 0, FIXPAIR_ERROR_NULL, _ALIGNMENT, _OVERLAP, _OVERFLOW, _NOT_FINITE, FIXPAIR_ERROR_RANGE for b = 0, negative errors, |rho| > 1, or a result that overflows
///
/// # Safety
/// Pointers are null or point to as many values as stated.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_ratio_of_means(
    ratio: *mut f64,
    error: *mut f64,
    above: *const f64,
    above_error: *const f64,
    below: *const f64,
    below_error: *const f64,
    correlation: *const f64,
    len: usize,
) -> fixpair_status_t {
    code((|| {
        let mut border = Border::new();
        // SAFETY: the caller's promise.
        unsafe {
            let (ratio, error) = (border.write(ratio, len)?, border.write(error, len)?);
            let above = means(&mut border, above, above_error, len)?;
            let below = means(&mut border, below, below_error, len)?;
            ratios::ratio_of_means(ratio, error, above, below, border.read_optional(correlation, len)?)
        }
    })())
}

/// Difference of two means in units of a scatter, (B_Fixed - B_Normal)/sigma_Normal, and its error.
///
/// Out: difference, error  len doubles each
/// In:  first, first_error, second, second_error  len means and their standard errors
///      correlation        as for fixpair_ratio_of_means, or NULL
///      sigma              len scatters
/// Returns: as fixpair_ratio_of_means; FIXPAIR_ERROR_RANGE for sigma that is not positive
///
/// # Safety
/// Pointers are null or point to as many values as stated.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_difference_of_means(
    difference: *mut f64,
    error: *mut f64,
    first: *const f64,
    first_error: *const f64,
    second: *const f64,
    second_error: *const f64,
    correlation: *const f64,
    sigma: *const f64,
    len: usize,
) -> fixpair_status_t {
    code((|| {
        let mut border = Border::new();
        // SAFETY: the caller's promise.
        unsafe {
            let (difference, error) = (border.write(difference, len)?, border.write(error, len)?);
            let first = means(&mut border, first, first_error, len)?;
            let second = means(&mut border, second, second_error, len)?;
            let correlation = border.read_optional(correlation, len)?;
            ratios::difference_of_means(
                difference,
                error,
                first,
                second,
                correlation,
                border.read(sigma, len)?,
            )
        }
    })())
}
