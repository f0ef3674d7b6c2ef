//! Dense matrices, by faer.

use core::ffi::c_void;

use super::border::Border;
use super::fof::query;
use super::status::{code, fixpair_status_t};
use crate::scratch::Layout;
use crate::status::Error;
use crate::variance::carpool::{self, Carpool};
use crate::variance::covariance;

/// Scratch of fixpair_covariance_root: 8 values^2 bytes and a little.
///
/// Out: scratch
/// In:  values
/// Returns: 0, FIXPAIR_ERROR_NULL, _ALIGNMENT, FIXPAIR_ERROR_OVERFLOW for more than 65536 values
///
/// # Safety
/// `scratch` is null or points to one value.
#[cfg(feature = "linalg")]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_covariance_root_scratch(
    scratch: *mut Layout,
    values: usize,
) -> fixpair_status_t {
    // SAFETY: the caller's promise.
    code(unsafe { query(scratch, values, covariance::covariance_root_scratch) })
}

/// The Cholesky factor L of a covariance C = L L^T, by faer. Not in a library without the feature "linalg": there define FIXPAIR_NO_LINALG before
/// this header, which hides this section.
///
/// Inside faer this function and fixpair_carpool may allocate, for hundreds of values; no other of the statistics does. Bits depend on the instructions of the processor.
///
/// Out: root        values x values doubles: the lower triangle, row by row, zeros above
/// In:  covariance  values x values doubles, symmetric
///      scratch     scratch_len bytes
/// Returns: 0, FIXPAIR_ERROR_NULL, _ALIGNMENT, _OVERLAP, _OVERFLOW, _NOT_FINITE, _SCRATCH, FIXPAIR_ERROR_RANGE for a matrix that is not symmetric, FIXPAIR_ERROR_SINGULAR for one that is
///          not positive definite to rounding: as the covariance of N estimates for values >= N
/// Cost: values^3/3 multiplications
///
/// # Safety
/// Pointers are null or point to as many values as stated.
#[cfg(feature = "linalg")]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_covariance_root(
    root: *mut f64,
    covariance: *const f64,
    values: usize,
    scratch: *mut c_void,
    scratch_len: usize,
) -> fixpair_status_t {
    code((|| {
        let mut border = Border::new();
        let square = values.checked_mul(values).ok_or(Error::Overflow)?;
        // SAFETY: the caller's promise.
        unsafe {
            let (root, covariance) = (border.write(root, square)?, border.read(covariance, square)?);
            covariance::covariance_root(root, covariance, values, border.scratch(scratch, scratch_len)?)
        }
    })())
}

/// Scratch of fixpair_carpool: 8 (values^2 + controls^2 + values controls) bytes and a little.
///
/// Out: scratch
/// In:  values, controls
/// Returns: 0, FIXPAIR_ERROR_NULL, _ALIGNMENT, FIXPAIR_ERROR_OVERFLOW for more than 65536 of either
///
/// # Safety
/// `scratch` is null or points to one value.
#[cfg(feature = "linalg")]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_carpool_scratch(
    scratch: *mut Layout,
    values: usize,
    controls: usize,
) -> fixpair_status_t {
    code((|| {
        // SAFETY: the caller's promise.
        let scratch = unsafe { Border::new().write_one(scratch) }?;
        *scratch = carpool::carpool_scratch(values, controls)?;
        Ok(())
    })())
}

/// CARPool with a matrix of coefficients (Chartier et al. 2021, arXiv:2009.08970): each value of y is corrected by all controls. Not in a library without the feature "linalg".
///
/// ```text
///     <y> - B (<c> - mu),  B = C_yc (C_cc + N C_mu)^-1
/// ```
///
/// Each control costs a degree of freedom: where N is not much larger than their number, fixpair_control_variates does better.
///
/// Out: mean        values doubles: the expectation of y
///      covariance  values x values doubles: of that mean, with the costs of estimating B and of the error of mu
///      beta        values x controls doubles: B
/// In:  y           samples x values doubles, row by row
///      c           samples x controls doubles, of the same seeds
///      samples     N; a pair is one
///      values
///      mu          controls expectations of c
///      covariance_of_mu  controls x controls doubles: that of c over N_c, from N_c cheap simulations of their own; NULL where mu is exact
///      controls
///      scratch     scratch_len bytes
/// Returns: 0, FIXPAIR_ERROR_NULL, _ALIGNMENT, _OVERLAP, _OVERFLOW, _NOT_FINITE, _SCRATCH, FIXPAIR_ERROR_LENGTH for no values or controls, FIXPAIR_ERROR_SAMPLES unless N >= controls + 3,
///          FIXPAIR_ERROR_SINGULAR where controls are combinations of others or mu has a variance of 0 (leave out its covariance), FIXPAIR_ERROR_RANGE for samples beyond 1e140, a covariance that is not symmetric, or a result that overflows
///
/// # Safety
/// Pointers are null or point to as many values as stated.
#[cfg(feature = "linalg")]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_carpool(
    mean: *mut f64,
    covariance: *mut f64,
    beta: *mut f64,
    y: *const f64,
    c: *const f64,
    samples: usize,
    values: usize,
    mu: *const f64,
    covariance_of_mu: *const f64,
    controls: usize,
    scratch: *mut c_void,
    scratch_len: usize,
) -> fixpair_status_t {
    code((|| {
        let mut border = Border::new();
        let product = |a: usize, b: usize| a.checked_mul(b).ok_or(Error::Overflow);
        // SAFETY: the caller's promise.
        unsafe {
            let mean = border.write(mean, values)?;
            let covariance = border.write(covariance, product(values, values)?)?;
            let beta = border.write(beta, product(values, controls)?)?;
            let of = Carpool {
                y: border.read(y, product(samples, values)?)?,
                c: border.read(c, product(samples, controls)?)?,
                samples,
                mu: border.read(mu, controls)?,
                covariance_of_mu: border.read_optional(covariance_of_mu, product(controls, controls)?)?,
            };
            carpool::carpool(mean, covariance, beta, &of, border.scratch(scratch, scratch_len)?)
        }
    })())
}
