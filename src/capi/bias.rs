//! Halo bias, and the likelihood of its parameters.

use core::ffi::c_void;

use super::border::Border;
use super::fof::query;
use super::status::{code, fixpair_status_t};
use crate::scratch::Layout;
use crate::status::{Error, Result};
use crate::variance::bias::{self, Bias, Spectrum};
use crate::variance::likelihood::{self, BiasLikelihood, Spectra};

/// P_hh = b^2 P_lin.
pub const FIXPAIR_SPECTRUM_HALO_HALO: i32 = 0;
/// P_hm = b P_lin.
pub const FIXPAIR_SPECTRUM_HALO_MATTER: i32 = 1;

fn spectrum(choice: i32) -> Result<Spectrum> {
    match choice {
        FIXPAIR_SPECTRUM_HALO_HALO => Ok(Spectrum::HaloHalo),
        FIXPAIR_SPECTRUM_HALO_MATTER => Ok(Spectrum::HaloMatter),
        _ => Err(Error::Choice),
    }
}

/// Fills the parameters of a bias: b_g = p = 1, f_NL = 0, delta_c = 1.686.
///
/// Out: bias
/// Returns: 0, FIXPAIR_ERROR_NULL, _ALIGNMENT
///
/// # Safety
/// `bias` is null or points to one.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_bias_init(bias: *mut Bias) -> fixpair_status_t {
    code((|| {
        // SAFETY: the caller's promise.
        *unsafe { Border::new().write_one(bias) }? = Bias::default();
        Ok(())
    })())
}

/// Bias with local primordial non-Gaussianity (Avila & Adame 2022, Eq. bk; Dalal et al. 2008, Slosar et al. 2008):
///
/// ```text
///     b(k) = b_g + b_phi f_NL/alpha(k, z),  b_phi = 2 delta_c (b_g - p)
/// ```
///
/// Out: out    len doubles
/// In:  bias   b_g, p, f_NL, delta_c
///      alpha  len values of fixpair_alpha at the redshift of the halos, in the convention of f_NL
/// Returns: 0, FIXPAIR_ERROR_NULL, _ALIGNMENT, _OVERLAP, _OVERFLOW, _NOT_FINITE, FIXPAIR_ERROR_RANGE for alpha or delta_c that is not positive, or a result that overflows
///
/// # Safety
/// Pointers are null or point to as many values as stated.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_bias_of_k(
    out: *mut f64,
    bias: *const Bias,
    alpha: *const f64,
    len: usize,
) -> fixpair_status_t {
    code((|| {
        let mut border = Border::new();
        // SAFETY: the caller's promise.
        unsafe {
            let out = border.write(out, len)?;
            bias::bias_of_k(out, border.read_one(bias)?, border.read(alpha, len)?)
        }
    })())
}

/// The spectrum of halos: b^2 P_lin or b P_lin.
///
/// Out: power   len doubles, (Mpc/h)^3
/// In:  bias
///      linear  len values of P_lin of matter at the redshift of the halos
///      alpha   as for fixpair_bias_of_k
///      spectrum  FIXPAIR_SPECTRUM_...
/// Returns: as fixpair_bias_of_k; FIXPAIR_ERROR_CHOICE
///
/// # Safety
/// Pointers are null or point to as many values as stated.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_halo_power(
    power: *mut f64,
    bias: *const Bias,
    linear: *const f64,
    alpha: *const f64,
    len: usize,
    spectrum: i32,
) -> fixpair_status_t {
    code((|| {
        let mut border = Border::new();
        // SAFETY: the caller's promise.
        unsafe {
            let (power, bias) = (border.write(power, len)?, border.read_one(bias)?);
            let (linear, alpha) = (border.read(linear, len)?, border.read(alpha, len)?);
            bias::halo_power(power, bias, self::spectrum(spectrum)?, linear, alpha)
        }
    })())
}

/// The bias of a measured spectrum, sqrt(P_hh/P_lin) or P_hm/P_lin, with the error that sigma makes.
///
/// Out: out, error  len doubles each
/// In:  power       len values of P_hh without shot noise, or of P_hm
///      sigma       len scatters of them
///      linear      len values of P_lin
///      spectrum    FIXPAIR_SPECTRUM_...
/// Returns: 0, FIXPAIR_ERROR_NULL, _ALIGNMENT, _OVERLAP, _OVERFLOW, _NOT_FINITE, _CHOICE, FIXPAIR_ERROR_RANGE for P_hh, sigma or P_lin that is not positive, or a
///          result that overflows
///
/// # Safety
/// Pointers are null or point to as many values as stated.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_measured_bias(
    out: *mut f64,
    error: *mut f64,
    power: *const f64,
    sigma: *const f64,
    linear: *const f64,
    len: usize,
    spectrum: i32,
) -> fixpair_status_t {
    code((|| {
        let mut border = Border::new();
        // SAFETY: the caller's promise.
        unsafe {
            let (out, error) = (border.write(out, len)?, border.write(error, len)?);
            let (power, sigma, linear) =
                (border.read(power, len)?, border.read(sigma, len)?, border.read(linear, len)?);
            bias::measured_bias(out, error, self::spectrum(spectrum)?, power, sigma, linear)
        }
    })())
}

/// A likelihood without data.
///
/// It holds all that measured spectra say of b_g, p and f_NL, exp(-chi^2/2) with (Eq. chi2, likelihood)
///
/// ```text
///     chi^2 = (d - m)^T C^-1 (d - m),  m = b(k)^2 P_lin or b(k) P_lin
/// ```
///
/// in 36 numbers, since m is a sum of P_lin, P_lin/alpha and P_lin/alpha^2: after spectra were added, chi^2 of any parameters takes 30 multiplications, whatever the number
/// of bins. Fill it with spectra of P_hh, of P_hm, or of both, at one redshift; only bins that are passed are fitted (the paper takes k <= 0.09 h/Mpc):
///
/// ```c
/// fixpair_likelihood_init(&likelihood);
/// fixpair_likelihood_add(&likelihood, power, sigma, linear, alpha, bins, FIXPAIR_SPECTRUM_HALO_HALO);
/// fixpair_bias_init(&start);                                    p = 1
/// fixpair_bias_posterior(&fit, posteriors, 2, &likelihood, &start, FIXPAIR_FREE_B_G | FIXPAIR_FREE_F_NL, 128, 0.68, scratch, scratch_len);
/// posteriors[1].peak is the estimate of f_NL, posteriors[1].centre +- posteriors[1].half_width its 68% region
/// ```
///
/// Out: likelihood
/// Returns: 0, FIXPAIR_ERROR_NULL, _ALIGNMENT
///
/// # Safety
/// `likelihood` is null or points to one.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_likelihood_init(likelihood: *mut BiasLikelihood) -> fixpair_status_t {
    code((|| {
        // SAFETY: the caller's promise.
        *unsafe { Border::new().write_one(likelihood) }? = BiasLikelihood::EMPTY;
        Ok(())
    })())
}

/// Adds bins that do not correlate, each with its sigma.
///
/// In/Out: likelihood
/// In:     power     len values of P_hh without shot noise, or of P_hm, (Mpc/h)^3
///         sigma     len standard deviations of them: of one simulation or one pair, or of the mean of an ensemble over sqrt(N)
///         linear    len values of P_lin at their redshift, averaged over the modes of each bin
///         alpha     len values of fixpair_alpha at their redshift
///         spectrum  FIXPAIR_SPECTRUM_...
/// Returns: 0, FIXPAIR_ERROR_NULL, _ALIGNMENT, _OVERLAP, _OVERFLOW, _NOT_FINITE, _CHOICE, FIXPAIR_ERROR_RANGE for sigma, P_lin or alpha that is not positive, a
///          likelihood that no data have made, or numbers too extreme
///
/// # Safety
/// Pointers are null or point to as many values as stated.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_likelihood_add(
    likelihood: *mut BiasLikelihood,
    power: *const f64,
    sigma: *const f64,
    linear: *const f64,
    alpha: *const f64,
    len: usize,
    spectrum: i32,
) -> fixpair_status_t {
    code((|| {
        let mut border = Border::new();
        // SAFETY: the caller's promise.
        unsafe {
            let likelihood = border.write_one(likelihood)?;
            let (power, sigma) = (border.read(power, len)?, border.read(sigma, len)?);
            let spectra =
                Spectra { power, linear: border.read(linear, len)?, alpha: border.read(alpha, len)? };
            likelihood.add(self::spectrum(spectrum)?, spectra, sigma)
        }
    })())
}

/// Scratch of fixpair_likelihood_add_correlated: 48 bytes a bin.
///
/// Out: scratch
/// In:  bins
/// Returns: 0, FIXPAIR_ERROR_NULL, _ALIGNMENT, _OVERFLOW
///
/// # Safety
/// `scratch` is null or points to one value.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_likelihood_add_correlated_scratch(
    scratch: *mut Layout,
    bins: usize,
) -> fixpair_status_t {
    // SAFETY: the caller's promise.
    code(unsafe { query(scratch, bins, likelihood::add_correlated_scratch) })
}

/// Adds bins that correlate, P_hh, P_hm, or P_hh and P_hm with their cross-covariance.
///
/// In/Out: likelihood
/// In:     power, linear, alpha  len doubles each, as for fixpair_likelihood_add: first those of P_hh, then those of P_hm
///         root       len x len doubles: the lower triangle L of their covariance L L^T, row by row (fixpair_covariance_root); what lies above the diagonal is finite and not used
///         halo_halo  how many of them are P_hh
///         precision  what the inverse covariance is multiplied by: 1, or for a covariance that was measured fixpair_hartlap_factor
///         scratch    scratch_len bytes
/// Returns: as fixpair_likelihood_add; FIXPAIR_ERROR_RANGE for halo_halo > len or a precision that is not positive, FIXPAIR_ERROR_SINGULAR for a root with a diagonal that is
///          not, FIXPAIR_ERROR_SCRATCH
///
/// # Safety
/// Pointers are null or point to as many values as stated.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_likelihood_add_correlated(
    likelihood: *mut BiasLikelihood,
    power: *const f64,
    linear: *const f64,
    alpha: *const f64,
    root: *const f64,
    len: usize,
    halo_halo: usize,
    precision: f64,
    scratch: *mut c_void,
    scratch_len: usize,
) -> fixpair_status_t {
    code((|| {
        let mut border = Border::new();
        let square = len.checked_mul(len).ok_or(Error::Overflow)?;
        // SAFETY: the caller's promise.
        unsafe {
            let likelihood = border.write_one(likelihood)?;
            let (power, linear, alpha) =
                (border.read(power, len)?, border.read(linear, len)?, border.read(alpha, len)?);
            let root = border.read(root, square)?;
            let scratch = border.scratch(scratch, scratch_len)?;
            likelihood.add_correlated(halo_halo, Spectra { power, linear, alpha }, root, precision, scratch)
        }
    })())
}

/// Adds the data of another likelihood, independent of these.
///
/// In/Out: likelihood
/// In:     other
/// Returns: 0, FIXPAIR_ERROR_NULL, _ALIGNMENT, _OVERLAP, FIXPAIR_ERROR_NOT_FINITE or FIXPAIR_ERROR_RANGE for numbers that no data have made, or too large
///
/// # Safety
/// Pointers are null or point to one value.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_likelihood_merge(
    likelihood: *mut BiasLikelihood,
    other: *const BiasLikelihood,
) -> fixpair_status_t {
    code((|| {
        let mut border = Border::new();
        // SAFETY: the caller's promise.
        let (likelihood, other) = unsafe { (border.write_one(likelihood)?, border.read_one(other)?) };
        likelihood.merge(other)
    })())
}

/// chi^2 of given parameters.
///
/// Out: chi_squared
/// In:  likelihood, bias
/// Returns: 0, FIXPAIR_ERROR_NULL, _ALIGNMENT, _OVERLAP, _NOT_FINITE, FIXPAIR_ERROR_RANGE for delta_c that is not positive, numbers that no data have made, or a result that
///          overflows
///
/// # Safety
/// Pointers are null or point to one value.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_likelihood_chi_squared(
    chi_squared: *mut f64,
    likelihood: *const BiasLikelihood,
    bias: *const Bias,
) -> fixpair_status_t {
    code((|| {
        let mut border = Border::new();
        // SAFETY: the caller's promise.
        unsafe {
            let chi_squared = border.write_one(chi_squared)?;
            *chi_squared = border.read_one(likelihood)?.chi_squared(border.read_one(bias)?)?;
        }
        Ok(())
    })())
}
