//! Matched simulations: the difference of two estimates that share their random numbers, and what it is worth.

use super::check::{finite, not_negative, positive, result, same_length};
use crate::math::sqrt;
use crate::status::{Error, Result};

/// Two lists of estimates, one of each seed, in the same order.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct MatchedDifference {
    /// Means of both.
    pub mean_first: f64,
    /// See `mean_first`.
    pub mean_second: f64,
    /// Standard deviations of both, with N - 1.
    pub deviation_first: f64,
    /// See `deviation_first`.
    pub deviation_second: f64,
    /// Pearson's correlation coefficient rho.
    pub correlation: f64,
    /// Its standard error, (1 - rho^2)/sqrt(N - 1).
    pub correlation_error: f64,
    /// Mean of first - second (Eq. diff).
    pub mean: f64,
    /// Its standard deviation, with N - 1. Of these very deviations and rho Eq. correlation gives this.
    pub deviation: f64,
    /// Standard error of the mean, deviation/sqrt(N).
    pub error_of_mean: f64,
}

/// Sums about the means.
pub(super) struct Moments {
    pub(super) count: f64,
    pub(super) mean: [f64; 2],
    /// Sums of squares of the first and of the second, and of products.
    pub(super) squares: [f64; 3],
}

impl Moments {
    pub(super) fn of(first: &[f64], second: &[f64]) -> Result<Self> {
        same_length(first.len(), &[second.len()])?;
        finite(first)?;
        finite(second)?;
        if first.len() < 2 {
            return Err(Error::Samples);
        }
        let count = first.len() as f64;
        let mean = [first, second].map(|values| values.iter().sum::<f64>() / count);
        let mut squares = [0.0; 3];
        for (x, y) in first.iter().zip(second) {
            let (x, y) = (x - mean[0], y - mean[1]);
            squares[0] += x * x;
            squares[1] += y * y;
            squares[2] += x * y;
        }
        finite(&squares).map_err(|_| Error::Range)?;
        Ok(Self { count, mean, squares })
    }

    pub(super) fn correlation(&self) -> Result<f64> {
        let both = sqrt(self.squares[0]) * sqrt(self.squares[1]);
        if both > 0.0 { Ok((self.squares[2] / both).clamp(-1.0, 1.0)) } else { Err(Error::Singular) }
    }
}

/// Delta f = f100 - f0 and all that belongs to it (Eq. diff, Eq. correlation).
///
/// # Errors
/// `Length` for lists of different lengths, `Samples` for fewer than two estimates, `NotFinite`, `Range` if a sum overflows, `Singular` where one of the
/// two does not vary.
///
/// # Example
/// ```
/// use fixpair::variance::matched::matched_difference;
///
/// let found = matched_difference(&[104.0, 97.0, 99.0, 101.0], &[3.0, -3.0, 0.0, 1.0])?;
/// assert!(found.correlation > 0.9 && found.deviation < found.deviation_first / 2.0);
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn matched_difference(first: &[f64], second: &[f64]) -> Result<MatchedDifference> {
    let moments = Moments::of(first, second)?;
    let Moments { count, mean, squares } = moments;
    let rho = moments.correlation()?;
    let deviation = |square: f64| sqrt(square / (count - 1.0));
    let centre = mean[0] - mean[1];
    // Not from rho, which would lose the digits that matching wins.
    let square: f64 = first.iter().zip(second).map(|(x, y)| (x - y - centre) * (x - y - centre)).sum();
    result(square)?;
    Ok(MatchedDifference {
        mean_first: mean[0],
        mean_second: mean[1],
        deviation_first: deviation(squares[0]),
        deviation_second: deviation(squares[1]),
        correlation: rho,
        correlation_error: (1.0 - rho * rho) / sqrt(count - 1.0),
        mean: centre,
        deviation: deviation(square),
        error_of_mean: deviation(square) / sqrt(count),
    })
}

/// sqrt(s_1^2 + s_2^2 - 2 rho s_1 s_2), the scatter of a difference (Eq. correlation).
///
/// # Errors
/// `NotFinite`, `Range` for negative scatter, |rho| > 1, or a result that overflows.
///
/// # Example
/// ```
/// use fixpair::variance::matched::difference_sigma;
///
/// assert!((difference_sigma(12.1, 11.8, 0.76)? - 8.3).abs() < 0.05); // the paper's Fixed simulations
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn difference_sigma(first: f64, second: f64, correlation: f64) -> Result<f64> {
    not_negative(&[first, second])?;
    finite(&[correlation])?;
    if correlation.abs() > 1.0 {
        return Err(Error::Range);
    }
    let apart = first - second;
    result(sqrt(apart * apart + 2.0 * (1.0 - correlation) * first * second))
}

/// V_eff/V: the number of simulations of the reference that one simulation is worth, (sigma_ref/sigma)^2 (m_ref/m).
///
/// Each sigma is that of an estimate which costs so many simulations: m = 2 for a pair. Count the simulations of the matched half as you pay for them: m = 1 if f_NL = 0
/// exists already, as in the paper's table, m = 2 if both are run for the difference.
///
/// # Errors
/// `NotFinite`, `Range` for sigma that is not positive, no simulations, or a result that overflows.
///
/// # Example
/// ```
/// use fixpair::variance::matched::effective_volume;
///
/// assert!((effective_volume(60.5, 1, 12.1, 1)? - 25.0).abs() < 1e-9); // Fixed
/// assert!((effective_volume(60.5, 1, 12.1, 2)? - 12.5).abs() < 1e-9); // at the cost of two simulations
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn effective_volume(
    reference: f64,
    reference_simulations: u64,
    sigma: f64,
    simulations: u64,
) -> Result<f64> {
    positive(&[reference, sigma])?;
    if simulations == 0 || reference_simulations == 0 {
        return Err(Error::Range);
    }
    let ratio = reference / sigma;
    result(ratio * ratio * (reference_simulations as f64 / simulations as f64))
}

/// A number and its standard error.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct Estimate {
    /// The number.
    pub value: f64,
    /// Its standard error.
    pub error: f64,
}

/// p = b - (b - 1) f/f_true, where f was measured with p = 1 in a universe of f_true (Eq. p); its error from those of b and f and their covariance.
///
/// # Errors
/// `NotFinite`, `Range` for f_true = 0, negative errors, a covariance beyond the product of the errors, or a result that overflows.
///
/// # Example
/// ```
/// use fixpair::variance::matched::{Estimate, universality};
///
/// let b_g = Estimate { value: 2.32, error: 0.0 };
/// let p = universality(b_g, Estimate { value: 109.2, error: 1.0 }, 0.0, 100.0)?;
/// assert!((p.value - 0.8786).abs() < 1e-4); // b - (b - 1) f/f_true
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn universality(b_g: Estimate, f_nl: Estimate, covariance: f64, f_true: f64) -> Result<Estimate> {
    finite(&[b_g.value, f_nl.value, covariance, f_true])?;
    not_negative(&[b_g.error, f_nl.error])?;
    // A correlation of 1, rounded.
    if f_true == 0.0 || covariance.abs() > b_g.error * f_nl.error * (1.0 + 1e-12) {
        return Err(Error::Range);
    }
    let ratio = f_nl.value / f_true;
    let (by_b, by_f) = (1.0 - ratio, -(b_g.value - 1.0) / f_true);
    let (first, second) = (by_b * b_g.error, by_f * f_nl.error);
    let square = first * first + second * second + 2.0 * by_b * by_f * covariance;
    Ok(Estimate {
        value: result(b_g.value - (b_g.value - 1.0) * ratio)?,
        error: sqrt(result(square)?.max(0.0)),
    })
}
