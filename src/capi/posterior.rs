//! Fits and posteriors of the bias parameters.

use core::ffi::c_void;

use super::border::Border;
use super::fof::query;
use super::status::{code, fixpair_status_t};
use crate::scratch::Layout;
use crate::status::{Error, Result};
use crate::variance::bias::Bias;
use crate::variance::fit::{self, BiasFit};
use crate::variance::likelihood::BiasLikelihood;
use crate::variance::posterior::{self, Grid, Posterior};
use crate::variance::{contours, levels};
use crate::within::Within;

/// b_g is free.
pub const FIXPAIR_FREE_B_G: u32 = 1;
/// p is free.
pub const FIXPAIR_FREE_P: u32 = 2;
/// f_NL is free.
pub const FIXPAIR_FREE_F_NL: u32 = 4;

/// The best parameters, by Gauss-Newton steps.
///
/// The paper's cases are FIXPAIR_FREE_B_G (i), FIXPAIR_FREE_B_G | FIXPAIR_FREE_P (ii), FIXPAIR_FREE_B_G | FIXPAIR_FREE_F_NL (iii); each of the three may be free alone. p and f_NL
/// enter as one product, so they cannot be free together. b_g > 0, since P_hh is the same with all signs turned.
///
/// Out: fit         the minimum, errors from the curvature there, covariance, chi^2, degrees of freedom
/// In:  likelihood
///      start       the parameters that are not free, and a place to begin, which need not be near: those of fixpair_bias_init do
///      free        FIXPAIR_FREE_... together
/// Returns: 0, FIXPAIR_ERROR_NULL, _ALIGNMENT, _OVERLAP, _NOT_FINITE, FIXPAIR_ERROR_CHOICE for other sets of parameters, FIXPAIR_ERROR_RANGE for delta_c that is not positive, or
///          numbers that no data have made, FIXPAIR_ERROR_SINGULAR where the data do not constrain a parameter (p where f_NL = 0, f_NL where b_g = p), FIXPAIR_ERROR_CONVERGENCE
///          if there is no minimum at b_g > 0
///
/// # Safety
/// Pointers are null or point to one value.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_fit_bias(
    fit: *mut BiasFit,
    likelihood: *const BiasLikelihood,
    start: *const Bias,
    free: u32,
) -> fixpair_status_t {
    code((|| {
        let mut border = Border::new();
        // SAFETY: the caller's promise.
        unsafe {
            let fit = border.write_one(fit)?;
            *fit = fit::fit_bias(border.read_one(likelihood)?, border.read_one(start)?, free)?;
        }
        Ok(())
    })())
}

/// Scratch of fixpair_bias_posterior: 16 bytes a point.
///
/// Out: scratch
/// In:  points  16 to 8192
/// Returns: 0, FIXPAIR_ERROR_NULL, _ALIGNMENT, _RANGE
///
/// # Safety
/// `scratch` is null or points to one value.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_bias_posterior_scratch(
    scratch: *mut Layout,
    points: usize,
) -> fixpair_status_t {
    // SAFETY: the caller's promise.
    code(unsafe { query(scratch, points, posterior::bias_posterior_scratch) })
}

/// The fit, and the posterior of each free parameter, in one call: range, grid and integrals of fixpair_bias_range, _bias_grid, _marginal and _read_posterior.
///
/// Priors are flat in the free parameters, with b_g > 0. Weak data of P_hh may be fitted by b(k) of either sign at small k: the posterior then has two humps, both in its
/// range, and peak and central region need not agree.
///
/// Out: fit             as fixpair_fit_bias
///      posteriors      parameters structs, one for each free parameter, in the order b_g, p, f_NL
/// In:  likelihood, start, free as for fixpair_fit_bias
///      points          of the grid, for each parameter: 128 for three digits and more
///      probability     of the central region: 0.68 in the paper
///      scratch         scratch_len bytes
/// Returns: as fixpair_fit_bias; _OVERFLOW, FIXPAIR_ERROR_LENGTH for another number of parameters, FIXPAIR_ERROR_RANGE for points or a probability outside (0, 1), FIXPAIR_ERROR_SCRATCH, FIXPAIR_ERROR_CONVERGENCE if the
///          posterior does not end anywhere, as that of f_NL where b_g = p cannot be excluded
/// Cost: 30 ns a point of the grid, 0.6 ms for 128 x 128
///
/// # Safety
/// Pointers are null or point to as many values as stated.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_bias_posterior(
    fit: *mut BiasFit,
    posteriors: *mut Posterior,
    parameters: usize,
    likelihood: *const BiasLikelihood,
    start: *const Bias,
    free: u32,
    points: usize,
    probability: f64,
    scratch: *mut c_void,
    scratch_len: usize,
) -> fixpair_status_t {
    code((|| {
        let mut border = Border::new();
        // SAFETY: the caller's promise.
        unsafe {
            let (fit, posteriors) = (border.write_one(fit)?, border.write(posteriors, parameters)?);
            let (likelihood, start) = (border.read_one(likelihood)?, border.read_one(start)?);
            let scratch = border.scratch(scratch, scratch_len)?;
            check_parameters(free, parameters)?;
            let all = posterior::bias_posterior(likelihood, start, free, points, probability, scratch)?;
            *fit = all.fit;
            posteriors.copy(all.posterior.part(..parameters));
        }
        Ok(())
    })())
}

/// `Length` unless `free` names as many parameters.
fn check_parameters(free: u32, parameters: usize) -> Result<()> {
    if parameters != free.count_ones() as usize {
        return Err(if fit::is_set(free) { Error::Length } else { Error::Choice });
    }
    if fit::is_set(free) { Ok(()) } else { Err(Error::Choice) }
}

/// Where the posterior is: a range of each free parameter beyond which its density is below exp(-12.5) of the peak.
///
/// Out: ranges      2 parameters doubles: lowest and highest of the first free parameter, then of the second, in the order b_g, p, f_NL
/// In:  likelihood, start, free as for fixpair_fit_bias
/// Returns: as fixpair_bias_posterior
///
/// # Safety
/// Pointers are null or point to as many values as stated.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_bias_range(
    ranges: *mut f64,
    parameters: usize,
    likelihood: *const BiasLikelihood,
    start: *const Bias,
    free: u32,
) -> fixpair_status_t {
    code((|| {
        let mut border = Border::new();
        // SAFETY: the caller's promise; a range is two doubles.
        unsafe {
            let ranges = border.write(ranges.cast::<[f64; 2]>(), parameters)?;
            let (likelihood, start) = (border.read_one(likelihood)?, border.read_one(start)?);
            check_parameters(free, parameters)?;
            posterior::bias_range(ranges, likelihood, start, free)
        }
    })())
}

/// chi^2 on a grid of uniform steps, ends included, the second free parameter fastest.
///
/// Out: chi_squared  len doubles, len the product of all points
/// In:  likelihood
///      fixed        the parameters that are not free
///      free         FIXPAIR_FREE_... together
///      ranges       2 parameters doubles, as from fixpair_bias_range
///      points       parameters numbers of points, 2 or more
/// Returns: 0, FIXPAIR_ERROR_NULL, _ALIGNMENT, _OVERLAP, _OVERFLOW, _NOT_FINITE, _CHOICE, FIXPAIR_ERROR_LENGTH, FIXPAIR_ERROR_RANGE for empty ranges, fewer than two points, delta_c
///          that is not positive, numbers that no data have made, or chi^2 that overflows
/// Cost: 10 ns a point
///
/// # Safety
/// Pointers are null or point to as many values as stated.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_bias_grid(
    chi_squared: *mut f64,
    len: usize,
    likelihood: *const BiasLikelihood,
    fixed: *const Bias,
    free: u32,
    ranges: *const f64,
    points: *const usize,
    parameters: usize,
) -> fixpair_status_t {
    code((|| {
        let mut border = Border::new();
        // SAFETY: the caller's promise; a range is two doubles.
        unsafe {
            let chi_squared = border.write(chi_squared, len)?;
            let (likelihood, fixed) = (border.read_one(likelihood)?, border.read_one(fixed)?);
            let ranges = border.read(ranges.cast::<[f64; 2]>(), parameters)?;
            let points = border.read(points, parameters)?;
            check_parameters(free, parameters)?;
            let mut grid = Grid { range: [[0.0; 2]; 2], points: [1; 2] };
            grid.range.part_mut(..parameters).copy(ranges);
            grid.points.part_mut(..parameters).copy(points);
            posterior::bias_grid(chi_squared, likelihood, fixed, free, &grid)
        }
    })())
}

/// The posterior density of one parameter of a grid of chi^2, integrated over the other and normalised.
///
/// Out: density      as many doubles as that parameter has points
/// In:  chi_squared  points_first x points_second doubles, the second fastest; 1 for the second of a grid of one parameter
///      axis         0 for the first parameter, 1 for the second
///      low, high    the ends of its range, in whose inverse unit the density comes
/// Returns: 0, FIXPAIR_ERROR_NULL, _ALIGNMENT, _OVERLAP, _OVERFLOW, _NOT_FINITE, FIXPAIR_ERROR_CHOICE for another axis, FIXPAIR_ERROR_RANGE for an axis of one point, another without points, or a range
///          that is empty or too extreme
///
/// # Safety
/// Pointers are null or point to as many values as stated.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_marginal(
    density: *mut f64,
    chi_squared: *const f64,
    points_first: usize,
    points_second: usize,
    axis: i32,
    low: f64,
    high: f64,
) -> fixpair_status_t {
    code((|| {
        let mut border = Border::new();
        let points = [points_first, points_second];
        let axis = usize::try_from(axis).ok().filter(|&axis| axis < 2).ok_or(Error::Choice)?;
        let len = points_first.checked_mul(points_second).ok_or(Error::Overflow)?;
        // SAFETY: the caller's promise.
        let (density, chi_squared) =
            unsafe { (border.write(density, points.at(axis))?, border.read(chi_squared, len)?) };
        posterior::marginal(density, chi_squared, points, axis, [low, high])
    })())
}

/// Peak, mean, deviation and central region of a density on a uniform grid.
///
/// Out: posterior
/// In:  density      points doubles, zero or more, normalised or not
///      low, high    of the first point and of the last
///      probability  of the central region: 0.68 in the paper
/// Returns: 0, FIXPAIR_ERROR_NULL, _ALIGNMENT, _OVERLAP, _OVERFLOW, _NOT_FINITE, FIXPAIR_ERROR_LENGTH for fewer than three points, FIXPAIR_ERROR_RANGE for an empty range, negative densities
///          or none above zero, a probability outside (0, 1), or numbers too extreme
///
/// # Safety
/// Pointers are null or point to as many values as stated.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_read_posterior(
    posterior: *mut Posterior,
    density: *const f64,
    points: usize,
    low: f64,
    high: f64,
    probability: f64,
) -> fixpair_status_t {
    code((|| {
        let mut border = Border::new();
        // SAFETY: the caller's promise.
        let (posterior, density) = unsafe { (border.write_one(posterior)?, border.read(density, points)?) };
        *posterior = posterior::read_posterior(density, [low, high], probability)?;
        Ok(())
    })())
}

/// A contour of a grid of two parameters, as straight segments (x0, y0, x1, y1), x the first parameter, y the second. Levels: the least chi^2 plus 1 or 4 (the paper's), or plus those of
/// fixpair_delta_chi_squared for two parameters.
///
/// Neighbouring segments share their ends bit for bit; ends lie on the contour to second order in the step.
///
/// Out: segments      4 segments_len doubles; only as many as there are segments are written
///      count         how many there are. With segments_len = 0 they are only counted
/// In:  chi_squared   points_first x points_second doubles, the second fastest
///      ranges        4 doubles: lowest and highest of the first parameter, and of the second
///      level
/// Returns: 0, FIXPAIR_ERROR_NULL, _ALIGNMENT, _OVERLAP, _OVERFLOW, _NOT_FINITE, FIXPAIR_ERROR_LENGTH for fewer places than segments, FIXPAIR_ERROR_RANGE for fewer than two points,
///          empty ranges, or differences that overflow
///
/// # Safety
/// Pointers are null or point to as many values as stated.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_contours(
    segments: *mut f64,
    segments_len: usize,
    count: *mut usize,
    chi_squared: *const f64,
    points_first: usize,
    points_second: usize,
    ranges: *const f64,
    level: f64,
) -> fixpair_status_t {
    code((|| {
        let mut border = Border::new();
        let len = points_first.checked_mul(points_second).ok_or(Error::Overflow)?;
        // SAFETY: the caller's promise; a segment is four doubles, a range two.
        unsafe {
            let segments = border.write(segments.cast::<[f64; 4]>(), segments_len)?;
            let count = border.write_one(count)?;
            let chi_squared = border.read(chi_squared, len)?;
            let ranges = *border.read_one(ranges.cast::<[[f64; 2]; 2]>())?;
            *count = contours::contours(segments, chi_squared, [points_first, points_second], ranges, level)?;
        }
        Ok(())
    })())
}

/// Delta chi^2 of the region that holds the given probability of Gaussian parameters: 1 and 4 hold 0.6827 and 0.9545 of one parameter, 2.30 and 6.18 of two.
///
/// Out: delta
/// In:  probability  between 0 and 1
///      parameters   1 or 2
/// Returns: 0, FIXPAIR_ERROR_NULL, _ALIGNMENT, _NOT_FINITE, _RANGE
///
/// # Safety
/// `delta` is null or points to one value.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_delta_chi_squared(
    delta: *mut f64,
    probability: f64,
    parameters: u32,
) -> fixpair_status_t {
    code((|| {
        // SAFETY: the caller's promise.
        let delta = unsafe { Border::new().write_one(delta) }?;
        *delta = levels::delta_chi_squared(probability, parameters)?;
        Ok(())
    })())
}

/// What the inverse of a covariance of p values from N independent estimates must be multiplied by to be unbiased: (N - p - 2)/(N - 1) (Hartlap,
/// Simon & Schneider 2007, astro-ph/0608064).
///
/// Out: factor
/// In:  estimates  N: a pair is one
///      values     p
/// Returns: 0, FIXPAIR_ERROR_NULL, _ALIGNMENT, FIXPAIR_ERROR_SAMPLES unless N >= p + 3, FIXPAIR_ERROR_RANGE for no values
///
/// # Safety
/// `factor` is null or points to one value.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_hartlap_factor(
    factor: *mut f64,
    estimates: u64,
    values: u64,
) -> fixpair_status_t {
    code((|| {
        // SAFETY: the caller's promise.
        let factor = unsafe { Border::new().write_one(factor) }?;
        *factor = levels::hartlap_factor(estimates, values)?;
        Ok(())
    })())
}

/// What the variance of q parameters fitted with such an inverse, Hartlap's factor included, must be multiplied by; errors by its root (Percival et al. 2014,
/// arXiv:1312.4841, Eq. 18).
///
/// Out: factor
/// In:  estimates   N: a pair is one
///      values      p
///      parameters  q
/// Returns: 0, FIXPAIR_ERROR_NULL, _ALIGNMENT, FIXPAIR_ERROR_SAMPLES unless N >= p + 5, FIXPAIR_ERROR_RANGE for no parameters or more of them than values
///
/// # Safety
/// `factor` is null or points to one value.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_percival_factor(
    factor: *mut f64,
    estimates: u64,
    values: u64,
    parameters: u64,
) -> fixpair_status_t {
    code((|| {
        // SAFETY: the caller's promise.
        let factor = unsafe { Border::new().write_one(factor) }?;
        *factor = levels::percival_factor(estimates, values, parameters)?;
        Ok(())
    })())
}
