//! Samples one at a time, pairs, and their scatter.

use super::border::Border;
use super::status::{code, fixpair_status_t};
use crate::status::{Error, Result};
use crate::variance::ensemble::{self, Moments};
use crate::variance::pairs;

/// Mean and variance of each value.
pub const FIXPAIR_MOMENTS_VARIANCE: i32 = 0;
/// Mean of each value, covariance of all pairs.
pub const FIXPAIR_MOMENTS_COVARIANCE: i32 = 1;

fn moments(choice: i32) -> Result<Moments> {
    match choice {
        FIXPAIR_MOMENTS_VARIANCE => Ok(Moments::Variance),
        FIXPAIR_MOMENTS_COVARIANCE => Ok(Moments::Covariance),
        _ => Err(Error::Choice),
    }
}

/// Doubles in the state of an ensemble: 3 + 2 values with FIXPAIR_MOMENTS_VARIANCE, 3 + values + values (values + 1)/2 with _COVARIANCE.
///
/// The state holds the number of samples so far, their mean, and sums of products about the mean (Welford 1962; Chan, Golub & LeVeque 1979):
/// where the mean is large no more digits are lost than the samples themselves have lost. It may be copied, saved, and sent as doubles, and merges with that of another process:
///
/// ```c
/// fixpair_ensemble_length(&length, bins, FIXPAIR_MOMENTS_COVARIANCE);
/// fixpair_ensemble_init(state, length, bins, FIXPAIR_MOMENTS_COVARIANCE);
/// for each estimate (a simulation, or the average of a pair: a pair counts once)
///     fixpair_ensemble_add(state, length, power, bins);
/// gather the states of all processes; fixpair_ensemble_merge(state, length, other);
/// fixpair_ensemble_covariance(covariance, bins, bins, state, length, 0, 0);
/// ```
///
/// For cross-covariances of several vectors (P at f_NL = 0 and at f_NL = 100 of one seed, P and a cheap surrogate) a sample is all of them, one after another.
///
/// Out: length
/// In:  values   numbers in a sample, 1 or more
///      moments  FIXPAIR_MOMENTS_...
/// Returns: 0, FIXPAIR_ERROR_NULL, _ALIGNMENT, FIXPAIR_ERROR_LENGTH for no values, _OVERFLOW, _CHOICE
///
/// # Safety
/// `length` is null or points to one value.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_ensemble_length(
    length: *mut usize,
    values: usize,
    moments: i32,
) -> fixpair_status_t {
    code((|| {
        // SAFETY: the caller's promise.
        let length = unsafe { Border::new().write_one(length) }?;
        *length = ensemble::ensemble_length(values, self::moments(moments)?)?;
        Ok(())
    })())
}

/// A state without samples.
///
/// Out: state    state_len doubles, see fixpair_ensemble_length
/// In:  values, moments
/// Returns: 0, FIXPAIR_ERROR_NULL, _ALIGNMENT, _OVERFLOW, _CHOICE, FIXPAIR_ERROR_LENGTH for a state of another length or no values
///
/// # Safety
/// `state` is null or points to `state_len` values.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_ensemble_init(
    state: *mut f64,
    state_len: usize,
    values: usize,
    moments: i32,
) -> fixpair_status_t {
    code((|| {
        // SAFETY: the caller's promise.
        let state = unsafe { Border::new().write(state, state_len) }?;
        ensemble::ensemble_init(state, values, self::moments(moments)?)
    })())
}

/// Adds samples.
///
/// In/Out: state    of fixpair_ensemble_init
/// In:     samples  samples_len doubles: one sample or several, one after another
/// Returns: 0, FIXPAIR_ERROR_NULL, _ALIGNMENT, _OVERLAP, _OVERFLOW, FIXPAIR_ERROR_LENGTH for samples that are not whole or a state of fewer than three
///          doubles, FIXPAIR_ERROR_VERSION for a state that fixpair_ensemble_init did not make, FIXPAIR_ERROR_NOT_FINITE, FIXPAIR_ERROR_RANGE for numbers beyond 1e140
/// Cost: a multiplication and addition for each sample and number of the state
///
/// # Safety
/// Pointers are null or point to as many values as stated.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_ensemble_add(
    state: *mut f64,
    state_len: usize,
    samples: *const f64,
    samples_len: usize,
) -> fixpair_status_t {
    code((|| {
        let mut border = Border::new();
        // SAFETY: the caller's promise.
        let (state, samples) =
            unsafe { (border.write(state, state_len)?, border.read(samples, samples_len)?) };
        ensemble::ensemble_add(state, samples)
    })())
}

/// Adds all samples of another state. In which order states are merged changes results by rounding only.
///
/// In/Out: state  of fixpair_ensemble_init
/// In:     other  state_len doubles: a state for samples of as many values, with the same moments
/// Returns: 0, FIXPAIR_ERROR_NULL, _ALIGNMENT, _OVERLAP, _OVERFLOW, FIXPAIR_ERROR_LENGTH for other samples, FIXPAIR_ERROR_VERSION for what is no state
///
/// # Safety
/// Pointers are null or point to as many values as stated.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_ensemble_merge(
    state: *mut f64,
    state_len: usize,
    other: *const f64,
) -> fixpair_status_t {
    code((|| {
        let mut border = Border::new();
        // SAFETY: the caller's promise.
        let (state, other) = unsafe { (border.write(state, state_len)?, border.read(other, state_len)?) };
        ensemble::ensemble_merge(state, other)
    })())
}

/// How many samples there are.
///
/// Out: count
/// In:  state  of fixpair_ensemble_init
/// Returns: 0, FIXPAIR_ERROR_NULL, _ALIGNMENT, _OVERLAP, _OVERFLOW, FIXPAIR_ERROR_LENGTH or FIXPAIR_ERROR_VERSION for what is no state
///
/// # Safety
/// Pointers are null or point to as many values as stated.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_ensemble_count(
    count: *mut u64,
    state: *const f64,
    state_len: usize,
) -> fixpair_status_t {
    code((|| {
        let mut border = Border::new();
        // SAFETY: the caller's promise.
        let (count, state) = unsafe { (border.write_one(count)?, border.read(state, state_len)?) };
        *count = ensemble::ensemble_count(state)?;
        Ok(())
    })())
}

/// # Safety
/// Pointers are null or point to as many values as stated.
unsafe fn read(
    out: *mut f64,
    values: usize,
    state: *const f64,
    state_len: usize,
    of: fn(&mut [f64], &[f64]) -> Result<()>,
) -> fixpair_status_t {
    code((|| {
        let mut border = Border::new();
        // SAFETY: the caller's promise.
        let (out, state) = unsafe { (border.write(out, values)?, border.read(state, state_len)?) };
        of(out, state)
    })())
}

/// Mean of each value.
///
/// Out: mean   values doubles
/// In:  state  of fixpair_ensemble_init
/// Returns: as fixpair_ensemble_count; FIXPAIR_ERROR_LENGTH for another number of values, FIXPAIR_ERROR_SAMPLES without samples
///
/// # Safety
/// Pointers are null or point to as many values as stated.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_ensemble_mean(
    mean: *mut f64,
    values: usize,
    state: *const f64,
    state_len: usize,
) -> fixpair_status_t {
    // SAFETY: the caller's promise.
    unsafe { read(mean, values, state, state_len, ensemble::ensemble_mean) }
}

/// Standard deviation of each value, with N - 1.
///
/// Out: deviation  values doubles
/// In:  state      of fixpair_ensemble_init
/// Returns: as fixpair_ensemble_mean; FIXPAIR_ERROR_SAMPLES for fewer than two
///
/// # Safety
/// Pointers are null or point to as many values as stated.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_ensemble_deviation(
    deviation: *mut f64,
    values: usize,
    state: *const f64,
    state_len: usize,
) -> fixpair_status_t {
    // SAFETY: the caller's promise.
    unsafe { read(deviation, values, state, state_len, ensemble::ensemble_deviation) }
}

/// Standard error of the mean of each value: the deviation over sqrt(N).
///
/// Out: error  values doubles
/// In:  state  of fixpair_ensemble_init
/// Returns: as fixpair_ensemble_deviation
///
/// # Safety
/// Pointers are null or point to as many values as stated.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_ensemble_error_of_mean(
    error: *mut f64,
    values: usize,
    state: *const f64,
    state_len: usize,
) -> fixpair_status_t {
    // SAFETY: the caller's promise.
    unsafe { read(error, values, state, state_len, ensemble::ensemble_error_of_mean) }
}

/// # Safety
/// Pointers are null or point to as many values as stated.
unsafe fn block(
    out: *mut f64,
    [rows, columns]: [usize; 2],
    state: *const f64,
    state_len: usize,
    [row, column]: [usize; 2],
    of: fn(&mut [f64], &[f64], core::ops::Range<usize>, core::ops::Range<usize>) -> Result<()>,
) -> fixpair_status_t {
    code((|| {
        let mut border = Border::new();
        let len = rows.checked_mul(columns).ok_or(Error::Overflow)?;
        let last = |first: usize, count: usize| first.checked_add(count).ok_or(Error::Range);
        let (rows, columns) = (row..last(row, rows)?, column..last(column, columns)?);
        // SAFETY: the caller's promise.
        let (out, state) = unsafe { (border.write(out, len)?, border.read(state, state_len)?) };
        of(out, state, rows, columns)
    })())
}

/// A block of the covariance, with N - 1: of values first_row, ... with values first_column, ... All of it is (values, values, 0, 0); the
/// cross-covariance of the first p with the next q is (p, q, 0, p).
///
/// Out: covariance  rows x columns doubles, row by row
/// In:  state       of fixpair_ensemble_init
///      first_row, first_column
/// Returns: as fixpair_ensemble_deviation; FIXPAIR_ERROR_RANGE for values that samples do not have, FIXPAIR_ERROR_CHOICE for pairs that a state of variances does
///          not keep
///
/// # Safety
/// Pointers are null or point to as many values as stated.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_ensemble_covariance(
    covariance: *mut f64,
    rows: usize,
    columns: usize,
    state: *const f64,
    state_len: usize,
    first_row: usize,
    first_column: usize,
) -> fixpair_status_t {
    let (size, first) = ([rows, columns], [first_row, first_column]);
    // SAFETY: the caller's promise.
    unsafe { block(covariance, size, state, state_len, first, ensemble::ensemble_covariance) }
}

/// The same block of correlation coefficients.
///
/// Out: correlation  rows x columns doubles, row by row
/// In:  state        of fixpair_ensemble_init
///      first_row, first_column
/// Returns: as fixpair_ensemble_covariance; FIXPAIR_ERROR_SINGULAR where a value does not vary
///
/// # Safety
/// Pointers are null or point to as many values as stated.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_ensemble_correlation(
    correlation: *mut f64,
    rows: usize,
    columns: usize,
    state: *const f64,
    state_len: usize,
    first_row: usize,
    first_column: usize,
) -> fixpair_status_t {
    let (size, first) = ([rows, columns], [first_row, first_column]);
    // SAFETY: the caller's promise.
    unsafe { block(correlation, size, state, state_len, first, ensemble::ensemble_correlation) }
}

/// P_paired = (P_original + P_inverted)/2 (Avila & Adame 2022, Eq. pair): one estimate that costs two simulations.
///
/// Out: average             len doubles
/// In:  original, inverted  len doubles each
/// Returns: 0, FIXPAIR_ERROR_NULL, _ALIGNMENT, _OVERLAP, _OVERFLOW, _NOT_FINITE
///
/// # Safety
/// Pointers are null or point to as many values as stated.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_pair_average(
    average: *mut f64,
    original: *const f64,
    inverted: *const f64,
    len: usize,
) -> fixpair_status_t {
    code((|| {
        let mut border = Border::new();
        // SAFETY: the caller's promise.
        unsafe {
            let average = border.write(average, len)?;
            pairs::pair_average(average, border.read(original, len)?, border.read(inverted, len)?)
        }
    })())
}

/// Scatter per simulation: sqrt(simulations) times the standard deviation of estimates (Eq. sigma_paired), with its error sigma/sqrt(2 (N - 1)) (Eq. errerr).
/// It compares types of simulations. A likelihood of pair averages takes the scatter of one average: the deviation itself.
///
/// Out: sigma, error  len doubles each
/// In:  deviation     len standard deviations over estimates, with N - 1
///      estimates     N: independent ones; 41 pairs are 41
///      simulations   that one estimate costs: 2 for a pair
/// Returns: 0, FIXPAIR_ERROR_NULL, _ALIGNMENT, _OVERLAP, _OVERFLOW, _NOT_FINITE, FIXPAIR_ERROR_SAMPLES for fewer than two estimates, FIXPAIR_ERROR_RANGE for a negative deviation,
///          no simulations, or a result that overflows
///
/// # Safety
/// Pointers are null or point to as many values as stated.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_sigma_per_simulation(
    sigma: *mut f64,
    error: *mut f64,
    deviation: *const f64,
    len: usize,
    estimates: u64,
    simulations: u64,
) -> fixpair_status_t {
    code((|| {
        let mut border = Border::new();
        // SAFETY: the caller's promise.
        let (sigma, error, deviation) =
            unsafe { (border.write(sigma, len)?, border.write(error, len)?, border.read(deviation, len)?) };
        pairs::sigma_per_simulation(sigma, error, deviation, estimates, simulations)
    })())
}
