//! Jackknife and bootstrap: errors of any statistic of an ensemble, without a model of its distribution.
//!
//! The caller computes the statistic; these kernels say of what. Samples are rows of a table, one estimate each: resampling rows keeps matched
//! statistics matched, and a pair is one row.

use core::num::NonZero;

use super::check::{fill, fill_two, finite, same_length, table};
use crate::math::sqrt;
use crate::noise::philox::{key_of, philox4x32_10};
use crate::status::{Error, Result};
use crate::within::Within;

/// The fourth counter word: this use of the generator. Random modes of one seed take another.
const DOMAIN: u32 = u32::from_be_bytes(*b"boot");

/// Which estimates make up replicate number `replicate`: as many draws with replacement as `indices` has places, each of `0..estimates`.
///
/// The draws are a function of seed, replicate and place alone (Philox4x32-10), so replicates may be made in any order and on any process, and the
/// same replicate of matched ensembles draws the same seeds. An estimate is drawn with its probability to 1 part in 2^64/estimates.
///
/// # Errors
/// `Samples` for no estimates, `Overflow` for more than 2^33 draws.
///
/// # Example
/// ```
/// use fixpair::variance::resample::bootstrap_indices;
///
/// let mut indices = [0; 12];
/// bootstrap_indices(&mut indices, 12, 1, 0)?; // seed 1, the first replicate: the same on any machine
/// assert!(indices.iter().all(|&i| i < 12));
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn bootstrap_indices(indices: &mut [u64], estimates: u64, seed: u64, replicate: u64) -> Result<()> {
    if estimates == 0 {
        return Err(Error::Samples);
    }
    if indices.len() as u64 > 1 << 33 {
        return Err(Error::Overflow);
    }
    let key = key_of(seed);
    for (block, indices) in indices.chunks_mut(2).enumerate() {
        let words = philox4x32_10([block as u32, replicate as u32, (replicate >> 32) as u32, DOMAIN], key);
        let uniform = |i: usize| u128::from(words[2 * i]) | u128::from(words[2 * i + 1]) << 32;
        for (i, index) in indices.iter_mut().enumerate() {
            *index = ((uniform(i) * u128::from(estimates)) >> 64) as u64;
        }
    }
    Ok(())
}

/// The mean of the rows of `samples` that `indices` name, out.len() values a row.
///
/// # Errors
/// `Length` if the samples are not whole rows, `Samples` without indices, `Range` for an index of no row, `NotFinite`.
///
/// # Example
/// ```
/// use fixpair::variance::resample::resampled_mean;
///
/// let mut mean = [0.0; 2];
/// resampled_mean(&mut mean, &[1.0, 10.0, 3.0, 30.0], &[0, 1, 1, 1])?; // two samples of two values
/// assert_eq!(mean, [2.5, 25.0]);
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn resampled_mean(out: &mut [f64], samples: &[f64], indices: &[u64]) -> Result<()> {
    let values = out.len();
    let rows = rows_of(samples, values)?;
    finite(samples)?;
    if indices.is_empty() {
        return Err(Error::Samples);
    }
    if indices.iter().any(|&index| index >= rows as u64) {
        return Err(Error::Range);
    }
    fill(out, |i| {
        let sum: f64 = indices.iter().map(|&index| samples.at(index as usize * values + i)).sum();
        super::check::result(sum / indices.len() as f64)
    })
}

fn rows_of(samples: &[f64], values: usize) -> Result<usize> {
    if values == 0 || !samples.len().is_multiple_of(values) {
        return Err(Error::Length);
    }
    Ok(samples.len() / values)
}

/// Value i of each row.
fn column(rows: &[f64], values: usize, i: usize) -> impl Iterator<Item = &f64> {
    rows.iter().skip(i).step_by(values.max(1))
}

/// The mean of all rows but one, for each row: what a statistic of the mean is computed from by the jackknife.
///
/// # Errors
/// `Length` unless both tables are the same whole rows of `values`, `Samples` for fewer than two rows, `NotFinite`, `Range` if a sum overflows.
///
/// # Example
/// ```
/// use fixpair::variance::resample::jackknife_means;
///
/// let mut deleted = [0.0; 3];
/// jackknife_means(&mut deleted, &[1.0, 2.0, 6.0], 1)?; // each without one of the samples
/// assert_eq!(deleted, [4.0, 3.5, 1.5]);
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn jackknife_means(out: &mut [f64], samples: &[f64], values: usize) -> Result<()> {
    same_length(out.len(), &[samples.len()])?;
    let rows = rows_of(samples, values)?;
    finite(samples)?;
    if rows < 2 {
        return Err(Error::Samples);
    }
    let total = |i: usize| column(samples, values, i).sum::<f64>();
    let without = |total: f64, at: usize| super::check::result((total - samples.at(at)) / (rows - 1) as f64);
    for i in 0..values {
        let total = total(i);
        for at in (i..samples.len()).step_by(values) {
            without(total, at)?;
        }
    }
    for i in 0..values {
        let total = total(i);
        for at in (i..samples.len()).step_by(values) {
            out.put(at, without(total, at)?);
        }
    }
    Ok(())
}

/// What the jackknife makes of statistics without one row each: N whole - (N - 1) mean(deleted), whose bias of order 1/N is gone, and the error
/// sqrt((N - 1)/N sum (deleted - mean(deleted))^2) (Quenouille 1956, Tukey 1958).
///
/// `whole`: the statistic of all rows; `deleted`: one row of values for each row that was left out.
///
/// # Errors
/// `Length` for arrays that do not fit, `Samples` for fewer than two rows, `NotFinite`, `Range` if a result overflows.
///
/// # Example
/// ```
/// use fixpair::variance::resample::jackknife;
///
/// let (mut corrected, mut error) = ([0.0], [0.0]);
/// jackknife(&mut corrected, &mut error, &[3.0], &[4.0, 3.5, 1.5])?; // of a mean: the error of the mean
/// assert!((corrected[0] - 3.0).abs() < 1e-12 && (error[0] - 1.5275).abs() < 1e-4);
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn jackknife(corrected: &mut [f64], error: &mut [f64], whole: &[f64], deleted: &[f64]) -> Result<()> {
    let values = whole.len();
    same_length(values, &[corrected.len(), error.len()])?;
    let rows = rows_of(deleted, values)?;
    finite(whole)?;
    finite(deleted)?;
    if rows < 2 {
        return Err(Error::Samples);
    }
    let count = rows as f64;
    fill_two(corrected, error, |i| {
        let column = || column(deleted, values, i);
        let mean = column().sum::<f64>() / count;
        let square: f64 = column().map(|x| (x - mean) * (x - mean)).sum();
        let corrected = super::check::result(count * whole.at(i) - (count - 1.0) * mean)?;
        Ok([corrected, super::check::result(sqrt((count - 1.0) / count * square))?])
    })
}

/// Their covariance: values x values numbers, (N - 1)/N sum of products about the mean.
///
/// # Errors
/// As [`jackknife`].
///
/// # Example
/// ```
/// use fixpair::variance::resample::jackknife_covariance;
///
/// let mut covariance = [0.0];
/// jackknife_covariance(&mut covariance, &[4.0, 3.5, 1.5], 3, 1)?;
/// assert!((covariance[0] - 7.0 / 3.0).abs() < 1e-12); // of the mean of 1, 2, 6
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn jackknife_covariance(
    covariance: &mut [f64],
    deleted: &[f64],
    rows: usize,
    values: usize,
) -> Result<()> {
    let width = NonZero::new(values).ok_or(Error::Length)?;
    table(deleted, rows, values)?;
    same_length(values.checked_mul(values).ok_or(Error::Overflow)?, &[covariance.len()])?;
    if rows < 2 {
        return Err(Error::Samples);
    }
    let count = rows as f64;
    let column = |i: usize| column(deleted, values, i);
    let mean = |i: usize| column(i).sum::<f64>() / count;
    fill(covariance, |at| {
        let (i, j) = (at / width, at % width);
        let (mean_i, mean_j) = (mean(i), mean(j));
        let sum: f64 = column(i).zip(column(j)).map(|(x, y)| (x - mean_i) * (y - mean_j)).sum();
        super::check::result((count - 1.0) / count * sum)
    })
}
