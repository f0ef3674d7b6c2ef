//! Control variates: what matching is a case of.
//!
//! y is wanted, c correlates with it, and the expectation mu of c is known, exactly or to an error: y - beta (c - mu) has the expectation of y for
//! every beta, and the least scatter, sqrt(1 - rho^2) sigma_y, for beta = rho sigma_y/sigma_c (Chartier et al. 2021, CARPool, arXiv:2009.08970). With y = f100, c = f0 and mu = 0
//! the paper's difference is beta = 1.

use super::check::{finite, not_negative, result, same_length};
use super::matched::Moments;
use crate::math::sqrt;
use crate::status::{Error, Result};
use crate::within::Within;

/// How beta is chosen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Beta {
    /// A number that does not depend on these samples: 1 for a plain difference.
    Given(f64),
    /// The least scatter, from these very samples: cov(y, c)/(var(c) + N error^2), where `error` is that of mu.
    Optimal,
}

/// The expectation of y.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct ControlVariate {
    /// mean(y) - beta (mean(c) - mu).
    pub mean: f64,
    /// Its standard error, with the costs of estimating beta and of the error of mu.
    pub error: f64,
    /// beta.
    pub beta: f64,
    /// Correlation of y and c.
    pub correlation: f64,
    /// Scatter of one estimate y - beta (c - mu).
    pub deviation: f64,
    /// (error of mean(y)/error)^2: how many times fewer simulations the same error takes.
    pub gain: f64,
}

/// The expectation of y by a control variate, from matched samples of both.
///
/// `mu`, `error`: expectation of c, and its standard error; 0 if it is exact. N_c cheap simulations of their own give s_c/sqrt(N_c).
///
/// The error is that of a regression: with beta from the samples the scatter about the line has N - 2 degrees of freedom, and the error includes that of the slope,
/// s sqrt(1/N + (mean(c) - mu)^2/S) with S = (N - 1) (var(c) + N error^2): on average (N - 2)/(N - 3) times s^2/N. With a given beta it is s/sqrt(N). beta^2 error^2 is added to the square of both.
///
/// # Errors
/// `Length` for lists of different lengths, `Samples` for fewer than two, or four for [`Beta::Optimal`], `NotFinite`, `Range` for a negative error or a sum that overflows, `Singular` where
/// y or c does not vary.
///
/// # Example
/// ```
/// use fixpair::variance::control::{Beta, control_variate};
///
/// let (f100, f0) = ([104.0, 97.0, 99.0, 101.0], [4.0, -3.0, -1.0, 1.0]);
/// let found = control_variate(&f100, &f0, 0.0, 0.0, Beta::Optimal)?;
/// assert!((found.beta - 1.0).abs() < 1e-12 && (found.mean - 100.0).abs() < 1e-12);
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn control_variate(y: &[f64], c: &[f64], mu: f64, error: f64, beta: Beta) -> Result<ControlVariate> {
    let moments = Moments::of(y, c)?;
    finite(&[mu])?;
    not_negative(&[error])?;
    let correlation = moments.correlation()?;
    let Moments { count, mean, squares } = moments;
    // (N - 1) (var(c) + N error^2): a mu that is hardly known has a small slope, of a small error.
    let spread = squares[1] + count * (count - 1.0) * error * error;
    let (slope, lost) = match beta {
        Beta::Given(beta) => {
            finite(&[beta])?;
            (beta, 1.0)
        }
        Beta::Optimal if count < 4.0 => return Err(Error::Samples),
        Beta::Optimal => (squares[2] / spread, 2.0),
    };
    let rest: f64 =
        y.iter().zip(c).map(|(y, c)| (y - mean[0]) - slope * (c - mean[1])).map(|rest| rest * rest).sum();
    let apart = mean[1] - mu;
    let of_slope = if beta == Beta::Optimal { apart * apart / spread } else { 0.0 };
    let variance = rest / (count - lost);
    let square = result(variance * (1.0 / count + of_slope) + slope * slope * error * error)?;
    let plain = squares[0] / (count - 1.0) / count;
    Ok(ControlVariate {
        mean: result(mean[0] - slope * apart)?,
        error: sqrt(square),
        beta: slope,
        correlation,
        deviation: sqrt(variance),
        // Infinite where y is c times beta and mu is exact: said as the largest number.
        gain: (plain / square).min(f64::MAX),
    })
}

/// What estimating coefficients of q control variates from the same N samples costs: the variance of the mean grows by (N - 2)/(N - q - 2), on
/// average (Lavenberg & Welch 1981).
///
/// # Errors
/// `Samples` unless N >= q + 3.
///
/// # Example
/// ```
/// use fixpair::variance::control::control_variate_loss;
///
/// assert_eq!(control_variate_loss(12, 1)?, 10.0 / 9.0); // (N - 2)/(N - q - 2)
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn control_variate_loss(estimates: u64, controls: u64) -> Result<f64> {
    let needed = controls.checked_add(3).ok_or(Error::Samples)?;
    if estimates < needed {
        return Err(Error::Samples);
    }
    Ok((estimates - 2) as f64 / (estimates - controls - 2) as f64)
}

/// V_eff of y - beta c over that of y: sigma_y^2/(sigma_y^2 - 2 beta rho sigma_y sigma_c + beta^2 sigma_c^2). With the optimal beta that is
/// 1/(1 - rho^2).
///
/// # Errors
/// `NotFinite`, `Range` for sigma_y = 0, negative scatter, |rho| > 1, or a gain that overflows.
///
/// # Example
/// ```
/// use fixpair::variance::control::control_variate_gain;
///
/// let plain = control_variate_gain(60.5, 47.0, 0.97, 1.0)?;
/// let best = control_variate_gain(60.5, 47.0, 0.97, 0.97 * 60.5 / 47.0)?;
/// assert!(best > plain && (best - 1.0 / (1.0 - 0.97 * 0.97)).abs() < 1e-9);
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn control_variate_gain(sigma_y: f64, sigma_c: f64, correlation: f64, beta: f64) -> Result<f64> {
    not_negative(&[sigma_y, sigma_c])?;
    finite(&[correlation, beta])?;
    let rest = super::matched::difference_sigma(
        sigma_y,
        result(beta.abs() * sigma_c)?,
        if beta < 0.0 { -correlation } else { correlation },
    )?;
    let ratio = sigma_y / rest;
    if sigma_y == 0.0 { Err(Error::Range) } else { result(ratio * ratio) }
}

/// One control variate for each value: samples are rows of `values.len()` values, of y and of c alike.
///
/// `mu`: expectation of c; `error`: of mu, None if it is exact.
///
/// # Errors
/// As [`control_variate`]; `values` is untouched by all of them.
///
/// # Example
/// ```
/// use fixpair::variance::control::{Beta, ControlVariate, control_variates};
/// # #[repr(align(64))] struct Memory([u8; 1 << 16]);
/// # let mut memory = Memory([0; 1 << 16]);
/// # let scratch = &mut memory.0;
///
/// let (f100, f0) = ([104.0, 97.0, 99.0, 101.0], [4.0, -3.0, -1.0, 1.0]); // four samples of one value
/// let mut found = [ControlVariate { mean: 0.0, error: 0.0, beta: 0.0, correlation: 0.0, deviation: 0.0, gain: 0.0 }];
/// control_variates(&mut found, &f100, &f0, &[0.0], None, Beta::Given(1.0), scratch)?;
/// assert!((found[0].mean - 100.0).abs() < 1e-12);
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn control_variates(
    values: &mut [ControlVariate],
    y: &[f64],
    c: &[f64],
    mu: &[f64],
    error: Option<&[f64]>,
    beta: Beta,
    scratch: &mut [u8],
) -> Result<()> {
    let width = values.len();
    same_length(width, &[mu.len(), error.map_or(width, <[f64]>::len)])?;
    if width == 0 || !y.len().is_multiple_of(width) {
        return Err(Error::Length);
    }
    same_length(y.len(), &[c.len()])?;
    let rows = y.len() / width;
    let mut arena = crate::scratch::Arena::new(scratch, control_variates_scratch(rows)?)?;
    let (y_column, c_column) = (arena.take::<f64>(rows)?, arena.take::<f64>(rows)?);
    let mut one = |i: usize| {
        for row in 0..rows {
            y_column.put(row, y.at(row * width + i));
            c_column.put(row, c.at(row * width + i));
        }
        control_variate(y_column, c_column, mu.at(i), error.map_or(0.0, |error| error.at(i)), beta)
    };
    for i in 0..width {
        one(i)?;
    }
    for (i, value) in values.iter_mut().enumerate() {
        *value = one(i)?;
    }
    Ok(())
}

/// Work space of [`control_variates`]: 16 bytes a sample.
///
/// # Errors
/// `Overflow` if it does not fit the address space.
///
/// # Example
/// ```
/// use fixpair::variance::control::control_variates_scratch;
///
/// assert_eq!(control_variates_scratch(100)?.size, 1664); // 16 bytes a sample, in whole cache lines
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn control_variates_scratch(samples: usize) -> Result<crate::scratch::Layout> {
    crate::scratch::Layout::EMPTY.and::<f64>(samples)?.and::<f64>(samples)
}
