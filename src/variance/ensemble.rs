//! Mean, variance, covariance and cross-covariance of samples that come one at a time.
//!
//! A state in the caller's memory holds the number of samples, their mean, and sums of squares about the mean (Welford 1962); states of
//! different processes merge (Chan, Golub & LeVeque 1979). Rounding errors grow with the mean over the deviation at most, as those
//! of the samples themselves do, and not with its square, as those of sums of squares about zero. A state is plain numbers: it may be copied, saved, and sent through MPI as it is.
//!
//! Several statistics vectors whose cross-covariances are wanted are one sample, one after another: every block of the covariance
//! can be read.

use core::num::NonZero;
use core::ops::Range;

use super::check::{fill, finite, same_length};
use crate::math::sqrt;
use crate::simd::Simd;
use crate::status::{Error, Result};
use crate::within::Within;

/// What a state keeps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Moments {
    /// Mean and variance of each value.
    Variance,
    /// Mean and covariance of all pairs of values.
    Covariance,
}

/// Larger samples are refused, so that no sum of squares overflows.
pub const LARGEST_SAMPLE: f64 = 1e140;

/// count, number of values, what is kept.
const HEAD: usize = 3;
/// Below it f64 holds every integer.
const EXACT: f64 = 9_007_199_254_740_992.0;

/// Numbers in a state for samples of `values` values: 3 + 2 values, or 3 + values + values (values + 1)/2.
///
/// # Errors
/// `Length` for no values, `Overflow` if the state does not fit the address space.
///
/// # Example
/// ```
/// use fixpair::variance::ensemble::{Moments, ensemble_length};
///
/// assert!(ensemble_length(14, Moments::Variance)? < ensemble_length(14, Moments::Covariance)?);
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn ensemble_length(values: usize, moments: Moments) -> Result<usize> {
    if values == 0 {
        return Err(Error::Length);
    }
    let squares = match moments {
        Moments::Variance => values,
        Moments::Covariance => {
            values.checked_add(1).and_then(|next| next.checked_mul(values)).ok_or(Error::Overflow)? / 2
        }
    };
    let length = squares.checked_add(values).and_then(|sum| sum.checked_add(HEAD)).ok_or(Error::Overflow)?;
    // As bytes too.
    if length > isize::MAX as usize / size_of::<f64>() { Err(Error::Overflow) } else { Ok(length) }
}

/// A state without samples.
///
/// # Errors
/// As [`ensemble_length`]; `Length` if the state does not have that many numbers.
///
/// # Example
/// ```
/// use fixpair::variance::ensemble::{Moments, ensemble_count, ensemble_init, ensemble_length};
///
/// let mut state = vec![0.0; ensemble_length(2, Moments::Variance)?];
/// ensemble_init(&mut state, 2, Moments::Variance)?;
/// assert_eq!(ensemble_count(&state)?, 0);
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn ensemble_init(state: &mut [f64], values: usize, moments: Moments) -> Result<()> {
    same_length(state.len(), &[ensemble_length(values, moments)?])?;
    state.fill(0.0);
    state[1] = values as f64;
    state[2] = f64::from(u8::from(moments == Moments::Covariance));
    Ok(())
}

/// A state as it is read.
struct View<'a> {
    count: f64,
    moments: Moments,
    mean: &'a [f64],
    squares: &'a [f64],
}

fn head(state: &[f64]) -> Result<(f64, usize, Moments)> {
    let [count, values, moments, ..] = *state else { return Err(Error::Length) };
    let moments = match moments {
        0.0 => Moments::Variance,
        1.0 => Moments::Covariance,
        _ => return Err(Error::Version),
    };
    let integers = [count, values].iter().all(|&x| (0.0..EXACT).contains(&x) && libm::floor(x) == x);
    if !integers || ensemble_length(values as usize, moments) != Ok(state.len()) {
        return Err(Error::Version);
    }
    Ok((count, values as usize, moments))
}

fn view(state: &[f64]) -> Result<View<'_>> {
    let (count, values, moments) = head(state)?;
    let (mean, squares) = state.part(HEAD..).split_at_checked(values).ok_or(Error::Version)?;
    let view = View { count, moments, mean, squares };
    let sound = finite(state).is_ok() && (0..values).all(|i| view.square(i, i).is_some_and(|x| x >= 0.0));
    if sound { Ok(view) } else { Err(Error::Version) }
}

/// Head, mean and squares of a state whose head was read.
fn parts_mut(state: &mut [f64], values: usize) -> Result<(&mut [f64; HEAD], &mut [f64], &mut [f64])> {
    let (head, rest) = state.split_first_chunk_mut().ok_or(Error::Length)?;
    let (mean, squares) = rest.split_at_mut_checked(values).ok_or(Error::Version)?;
    Ok((head, mean, squares))
}

impl View<'_> {
    /// Sum of squares of values i and j, where it is kept.
    fn square(&self, i: usize, j: usize) -> Option<f64> {
        match self.moments {
            Moments::Variance => (i == j).then(|| self.squares.at(i)),
            Moments::Covariance => {
                let (i, j) = (i.min(j), i.max(j));
                Some(self.squares.at(row(i, self.mean.len()) + j - i))
            }
        }
    }

    fn two_or_more(&self) -> Result<()> {
        if self.count < 2.0 { Err(Error::Samples) } else { Ok(()) }
    }
}

/// Of values i and j, with N - 1.
fn covariance(view: &View<'_>, i: usize, j: usize) -> Result<f64> {
    let square = view.square(i, j).ok_or(Error::Choice)?;
    super::check::result(square / (view.count - 1.0))
}

/// Where row i of an upper triangle begins.
fn row(i: usize, values: usize) -> usize {
    i * values - i * i.saturating_sub(1) / 2
}

/// Adds `weight` times the outer product of x - mean with itself.
#[inline(always)]
fn add_squares(squares: &mut [f64], moments: Moments, weight: f64, x: &[f64], mean: &[f64]) {
    match moments {
        Moments::Variance => {
            for ((square, x), mean) in squares.iter_mut().zip(x).zip(mean) {
                *square += weight * (x - mean) * (x - mean);
            }
        }
        Moments::Covariance => {
            let mut rest = squares;
            for i in 0..x.len() {
                let (x, mean) = (x.part(i..), mean.part(i..));
                let (row, next) = rest.split_at_mut_checked(x.len()).unwrap_or_default();
                let factor = weight * (x.at(0) - mean.at(0));
                for ((square, x), mean) in row.iter_mut().zip(x).zip(mean) {
                    *square += factor * (x - mean);
                }
                rest = next;
            }
        }
    }
}

/// To ask for the processor's instructions takes as long as so many multiplications.
const WORTH: usize = 1 << 16;

/// More samples, one after another. Cost: one multiplication and addition for each sample and number of the state.
///
/// # Errors
/// `Length` unless they are whole samples of as many values as the state has, `Version` for a state that [`ensemble_init`] did not make, `NotFinite`, and `Range`
/// for values beyond [`LARGEST_SAMPLE`]. The state is untouched by all of them.
///
/// # Example
/// ```
/// use fixpair::variance::ensemble::*;
///
/// let mut state = vec![0.0; ensemble_length(2, Moments::Covariance)?];
/// ensemble_init(&mut state, 2, Moments::Covariance)?;
/// ensemble_add(&mut state, &[1.0, 10.0, 2.0, 20.0, 6.0, 30.0])?; // three samples of two values
/// assert_eq!(ensemble_count(&state)?, 3);
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn ensemble_add(state: &mut [f64], samples: &[f64]) -> Result<()> {
    let (_, values, moments) = head(state)?;
    if !samples.len().is_multiple_of(values) {
        return Err(Error::Length);
    }
    finite(samples)?;
    if samples.iter().any(|x| x.abs() > LARGEST_SAMPLE) {
        return Err(Error::Range);
    }
    let ([count, ..], mean, squares) = parts_mut(state, values)?;
    let work = samples.len() / values * squares.len();
    let simd = if work < WORTH { Simd::Portable } else { Simd::detect() };
    simd.vectorise(
        #[inline(always)]
        || {
            for sample in samples.chunks_exact(values.max(1)) {
                let (before, total) = (*count, *count + 1.0);
                add_squares(squares, moments, before / total, sample, mean);
                for (mean, x) in mean.iter_mut().zip(sample) {
                    *mean += (x - *mean) / total;
                }
                *count = total;
            }
        },
    );
    Ok(())
}

/// Adds all samples of another state.
///
/// # Errors
/// `Length` for a state of other samples, `Version` as [`ensemble_add`]. The state is untouched by both.
///
/// # Example
/// ```
/// use fixpair::variance::ensemble::*;
///
/// let mut state = vec![0.0; ensemble_length(2, Moments::Covariance)?];
/// ensemble_init(&mut state, 2, Moments::Covariance)?;
/// ensemble_add(&mut state, &[1.0, 10.0, 2.0, 20.0, 6.0, 30.0])?; // three samples of two values
/// let other = state.clone(); // another process's
/// ensemble_merge(&mut state, &other)?;
/// assert_eq!(ensemble_count(&state)?, 6);
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn ensemble_merge(state: &mut [f64], other: &[f64]) -> Result<()> {
    let (count, values, moments) = head(state)?;
    let from = view(other)?;
    if from.mean.len() != values || from.moments != moments {
        return Err(Error::Length);
    }
    if from.count == 0.0 {
        return Ok(());
    }
    let (head, mean, squares) = parts_mut(state, values)?;
    let total = count + from.count;
    for (square, more) in squares.iter_mut().zip(from.squares) {
        *square += more;
    }
    add_squares(squares, moments, count * from.count / total, from.mean, mean);
    for (mean, other) in mean.iter_mut().zip(from.mean) {
        *mean += (other - *mean) * (from.count / total);
    }
    head[0] = total;
    Ok(())
}

/// Number of samples.
///
/// # Errors
/// `Length` or `Version` for a state that [`ensemble_init`] did not make.
///
/// # Example
/// ```
/// use fixpair::variance::ensemble::*;
///
/// let mut state = vec![0.0; ensemble_length(2, Moments::Covariance)?];
/// ensemble_init(&mut state, 2, Moments::Covariance)?;
/// ensemble_add(&mut state, &[1.0, 10.0, 2.0, 20.0, 6.0, 30.0])?; // three samples of two values
/// assert_eq!(ensemble_count(&state)?, 3);
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn ensemble_count(state: &[f64]) -> Result<u64> {
    Ok(view(state)?.count as u64)
}

/// Mean of each value.
///
/// # Errors
/// As [`ensemble_count`]; `Length` unless there is a place for each value; `Samples` without samples.
///
/// # Example
/// ```
/// use fixpair::variance::ensemble::*;
///
/// let mut state = vec![0.0; ensemble_length(2, Moments::Covariance)?];
/// ensemble_init(&mut state, 2, Moments::Covariance)?;
/// ensemble_add(&mut state, &[1.0, 10.0, 2.0, 20.0, 6.0, 30.0])?; // three samples of two values
/// let mut mean = [0.0; 2];
/// ensemble_mean(&mut mean, &state)?;
/// assert_eq!(mean, [3.0, 20.0]);
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn ensemble_mean(out: &mut [f64], state: &[f64]) -> Result<()> {
    let view = view(state)?;
    same_length(view.mean.len(), &[out.len()])?;
    if view.count == 0.0 {
        return Err(Error::Samples);
    }
    out.copy_from_slice(view.mean);
    Ok(())
}

/// Standard deviation of each value, with N - 1; over sqrt(N) it is the error of the mean.
///
/// # Errors
/// As [`ensemble_mean`]; `Samples` for fewer than two.
///
/// # Example
/// ```
/// use fixpair::variance::ensemble::*;
///
/// let mut state = vec![0.0; ensemble_length(2, Moments::Covariance)?];
/// ensemble_init(&mut state, 2, Moments::Covariance)?;
/// ensemble_add(&mut state, &[1.0, 10.0, 2.0, 20.0, 6.0, 30.0])?; // three samples of two values
/// let mut deviation = [0.0; 2];
/// ensemble_deviation(&mut deviation, &state)?; // with N - 1
/// assert!((deviation[1] - 10.0).abs() < 1e-12);
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn ensemble_deviation(out: &mut [f64], state: &[f64]) -> Result<()> {
    let view = view(state)?;
    same_length(view.mean.len(), &[out.len()])?;
    view.two_or_more()?;
    fill(out, |i| Ok(sqrt(covariance(&view, i, i)?)))
}

/// Standard error of the mean of each value.
///
/// # Errors
/// As [`ensemble_deviation`].
///
/// # Example
/// ```
/// use fixpair::variance::ensemble::*;
///
/// let mut state = vec![0.0; ensemble_length(2, Moments::Covariance)?];
/// ensemble_init(&mut state, 2, Moments::Covariance)?;
/// ensemble_add(&mut state, &[1.0, 10.0, 2.0, 20.0, 6.0, 30.0])?; // three samples of two values
/// let mut error = [0.0; 2];
/// ensemble_error_of_mean(&mut error, &state)?;
/// assert!((error[1] - 10.0 / 3.0_f64.sqrt()).abs() < 1e-12);
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn ensemble_error_of_mean(out: &mut [f64], state: &[f64]) -> Result<()> {
    ensemble_deviation(out, state)?;
    let root = sqrt(state.at(0));
    out.iter_mut().for_each(|error| *error /= root);
    Ok(())
}

/// A block of the covariance, with N - 1: rows.len() rows of columns.len() values. `0..p`, `0..p` is the whole; `0..p`, `p..p + q` the
/// cross-covariance of the first p values with the next q.
///
/// # Errors
/// As [`ensemble_deviation`]; `Range` for values that samples do not have; `Choice` for what a state of variances does not keep.
///
/// # Example
/// ```
/// use fixpair::variance::ensemble::*;
///
/// let mut state = vec![0.0; ensemble_length(2, Moments::Covariance)?];
/// ensemble_init(&mut state, 2, Moments::Covariance)?;
/// ensemble_add(&mut state, &[1.0, 10.0, 2.0, 20.0, 6.0, 30.0])?; // three samples of two values
/// let mut covariance = [0.0; 4];
/// ensemble_covariance(&mut covariance, &state, 0..2, 0..2)?;
/// assert!((covariance[0] - 7.0).abs() < 1e-12 && covariance[1] == covariance[2]);
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn ensemble_covariance(
    out: &mut [f64],
    state: &[f64],
    rows: Range<usize>,
    columns: Range<usize>,
) -> Result<()> {
    block(out, state, rows, columns, covariance)
}

/// The same block of correlation coefficients.
///
/// # Errors
/// As [`ensemble_covariance`]; `Singular` where a value does not vary.
///
/// # Example
/// ```
/// use fixpair::variance::ensemble::*;
///
/// let mut state = vec![0.0; ensemble_length(2, Moments::Covariance)?];
/// ensemble_init(&mut state, 2, Moments::Covariance)?;
/// ensemble_add(&mut state, &[1.0, 10.0, 2.0, 20.0, 6.0, 30.0])?; // three samples of two values
/// let mut correlation = [0.0; 4];
/// ensemble_correlation(&mut correlation, &state, 0..2, 0..2)?;
/// assert!((correlation[0] - 1.0).abs() < 1e-12 && correlation[1] > 0.9);
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn ensemble_correlation(
    out: &mut [f64],
    state: &[f64],
    rows: Range<usize>,
    columns: Range<usize>,
) -> Result<()> {
    block(out, state, rows, columns, |view, i, j| {
        let both = sqrt(covariance(view, i, i)?) * sqrt(covariance(view, j, j)?);
        if both > 0.0 { Ok((covariance(view, i, j)? / both).clamp(-1.0, 1.0)) } else { Err(Error::Singular) }
    })
}

fn block(
    out: &mut [f64],
    state: &[f64],
    rows: Range<usize>,
    columns: Range<usize>,
    of: impl Fn(&View<'_>, usize, usize) -> Result<f64>,
) -> Result<()> {
    let view = view(state)?;
    let inside = |range: &Range<usize>| range.start <= range.end && range.end <= view.mean.len();
    if !inside(&rows) || !inside(&columns) {
        return Err(Error::Range);
    }
    same_length(rows.len().checked_mul(columns.len()).ok_or(Error::Overflow)?, &[out.len()])?;
    view.two_or_more()?;
    // Of no columns there are no values.
    let width = NonZero::new(columns.len()).unwrap_or(NonZero::<usize>::MIN);
    fill(out, |at| of(&view, rows.start + at / width, columns.start + at % width))
}
