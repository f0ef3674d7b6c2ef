//! Jackknife and bootstrap.

use super::border::Border;
use super::status::{code, fixpair_status_t};
use crate::status::{Error, Result};
use crate::variance::resample;

fn product(rows: usize, values: usize) -> Result<usize> {
    rows.checked_mul(values).ok_or(Error::Overflow)
}

/// Which estimates make up a replicate of a bootstrap: draws with replacement.
///
/// The draws are a function of seed, replicate and place alone (Philox4x32-10): replicates may be made in any order and on any process. The same replicate
/// of matched ensembles draws the same seeds, so that what they share stays shared.
///
/// ```c
/// for (replicate = 0; replicate < 1000; replicate++) {
///     fixpair_bootstrap_indices(indices, n, n, seed, replicate);
///     compute the statistic of estimates indices[0], ..., indices[n - 1]; fixpair_resampled_mean does for functions of a mean
///     fixpair_ensemble_add(state, state_len, &statistic, 1);
/// }
/// fixpair_ensemble_deviation(&error, 1, state, state_len);
/// ```
///
/// Out: indices    len numbers in 0, ..., estimates - 1; len is that of the ensemble, or fewer
/// In:  estimates  independent ones: a pair is one
///      seed, replicate
/// Returns: 0, FIXPAIR_ERROR_NULL, _ALIGNMENT, FIXPAIR_ERROR_SAMPLES for no estimates, FIXPAIR_ERROR_OVERFLOW for more than 2^33 draws
///
/// # Safety
/// `indices` is null or points to `len` values.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_bootstrap_indices(
    indices: *mut u64,
    len: usize,
    estimates: u64,
    seed: u64,
    replicate: u64,
) -> fixpair_status_t {
    code((|| {
        // SAFETY: the caller's promise.
        let indices = unsafe { Border::new().write(indices, len) }?;
        resample::bootstrap_indices(indices, estimates, seed, replicate)
    })())
}

/// Mean of the rows that indices name.
///
/// Out: mean     values doubles
/// In:  samples  rows x values doubles, an estimate a row
///      indices  indices_len numbers of rows
/// Returns: 0, FIXPAIR_ERROR_NULL, _ALIGNMENT, _OVERLAP, _OVERFLOW, _NOT_FINITE, FIXPAIR_ERROR_LENGTH for no values, FIXPAIR_ERROR_SAMPLES for no indices, FIXPAIR_ERROR_RANGE for a
///          row that is not there or a sum that overflows
///
/// # Safety
/// Pointers are null or point to as many values as stated.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_resampled_mean(
    mean: *mut f64,
    values: usize,
    samples: *const f64,
    rows: usize,
    indices: *const u64,
    indices_len: usize,
) -> fixpair_status_t {
    code((|| {
        let mut border = Border::new();
        let len = product(rows, values)?;
        // SAFETY: the caller's promise.
        let (mean, samples, indices) = unsafe {
            (border.write(mean, values)?, border.read(samples, len)?, border.read(indices, indices_len)?)
        };
        resample::resampled_mean(mean, samples, indices)
    })())
}

/// The mean of all rows but one, for each row: what a statistic of the mean is computed from for fixpair_jackknife.
///
/// Out: means    rows x values doubles
/// In:  samples  rows x values doubles, an estimate a row
/// Returns: 0, FIXPAIR_ERROR_NULL, _ALIGNMENT, _OVERLAP, _OVERFLOW, _NOT_FINITE, FIXPAIR_ERROR_LENGTH for no values, FIXPAIR_ERROR_SAMPLES for fewer than two rows, FIXPAIR_ERROR_RANGE if a
///          sum overflows
///
/// # Safety
/// Pointers are null or point to as many values as stated.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_jackknife_means(
    means: *mut f64,
    samples: *const f64,
    rows: usize,
    values: usize,
) -> fixpair_status_t {
    code((|| {
        let mut border = Border::new();
        let len = product(rows, values)?;
        // SAFETY: the caller's promise.
        let (means, samples) = unsafe { (border.write(means, len)?, border.read(samples, len)?) };
        resample::jackknife_means(means, samples, values)
    })())
}

/// The jackknife: N whole - (N - 1) <deleted>, free of the bias of order 1/N, and the error sqrt((N - 1)/N sum (deleted - <deleted>)^2) (Quenouille 1956,
/// Tukey 1958).
///
/// Out: corrected, error  values doubles each
/// In:  whole             values statistics of all rows
///      deleted           rows x values: the same without row 0, without row 1, ...
/// Returns: as fixpair_jackknife_means
///
/// # Safety
/// Pointers are null or point to as many values as stated.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_jackknife(
    corrected: *mut f64,
    error: *mut f64,
    whole: *const f64,
    values: usize,
    deleted: *const f64,
    rows: usize,
) -> fixpair_status_t {
    code((|| {
        let mut border = Border::new();
        let len = product(rows, values)?;
        // SAFETY: the caller's promise.
        unsafe {
            let (corrected, error) = (border.write(corrected, values)?, border.write(error, values)?);
            let (whole, deleted) = (border.read(whole, values)?, border.read(deleted, len)?);
            resample::jackknife(corrected, error, whole, deleted)
        }
    })())
}

/// The jackknife's covariance of statistics: (N - 1)/N times the sum of products of their deviations from the mean over the deleted rows.
///
/// Out: covariance  values x values doubles
/// In:  deleted     rows x values, as for fixpair_jackknife
/// Returns: as fixpair_jackknife_means
///
/// # Safety
/// Pointers are null or point to as many values as stated.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_jackknife_covariance(
    covariance: *mut f64,
    deleted: *const f64,
    rows: usize,
    values: usize,
) -> fixpair_status_t {
    code((|| {
        let mut border = Border::new();
        let (square, len) = (product(values, values)?, product(rows, values)?);
        // SAFETY: the caller's promise.
        let (covariance, deleted) =
            unsafe { (border.write(covariance, square)?, border.read(deleted, len)?) };
        resample::jackknife_covariance(covariance, deleted, rows, values)
    })())
}
