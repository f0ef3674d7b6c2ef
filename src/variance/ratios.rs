//! Are two kinds of simulations the same on average? Ratios of their means, and differences in units of a scatter.

use super::check::{fill_two, finite, not_negative, positive, result, same_length};
use crate::math::sqrt;
use crate::status::{Error, Result};
use crate::within::Within;

/// Means over an ensemble, bin by bin, with their errors.
#[derive(Clone, Copy, Debug)]
pub struct Means<'a> {
    /// Mean of each bin.
    pub mean: &'a [f64],
    /// Its standard error.
    pub error: &'a [f64],
}

impl Means<'_> {
    fn check(&self, len: usize) -> Result<()> {
        same_length(len, &[self.mean.len(), self.error.len()])?;
        finite(self.mean)?;
        not_negative(self.error)
    }
}

/// Correlation of two means: of simulations that share their seeds, that of their values. None are independent.
fn check_correlation(correlation: Option<&[f64]>, len: usize) -> Result<()> {
    let Some(rho) = correlation else { return Ok(()) };
    same_length(len, &[rho.len()])?;
    finite(rho)?;
    if rho.iter().all(|rho| rho.abs() <= 1.0) { Ok(()) } else { Err(Error::Range) }
}

/// a/b, Fixed over Normal, and its error |a/b| sqrt(r_a^2 + r_b^2 - 2 rho r_a r_b) with the relative errors r.
///
/// # Errors
/// `Length` for arrays of different lengths, `NotFinite`, `Range` for b = 0, negative errors, |rho| > 1, or a result that overflows.
///
/// # Example
/// ```
/// use fixpair::variance::ratios::{Means, ratio_of_means};
///
/// let (fixed, normal) = (Means { mean: &[101.0], error: &[1.0] }, Means { mean: &[100.0], error: &[5.0] });
/// let (mut ratio, mut error) = ([0.0], [0.0]);
/// ratio_of_means(&mut ratio, &mut error, fixed, normal, None)?;
/// assert!((ratio[0] - 1.01).abs() < 1e-12 && (error[0] - 0.0515).abs() < 1e-3);
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn ratio_of_means(
    ratio: &mut [f64],
    error: &mut [f64],
    above: Means<'_>,
    below: Means<'_>,
    correlation: Option<&[f64]>,
) -> Result<()> {
    let len = ratio.len();
    above.check(len)?;
    below.check(len)?;
    check_correlation(correlation, len)?;
    fill_two(ratio, error, |i| {
        let ratio = result(above.mean.at(i) / below.mean.at(i))?;
        // Written so that a = 0 has an error too.
        let (first, second) =
            (above.error.at(i) / below.mean.at(i), ratio * (below.error.at(i) / below.mean.at(i)));
        let rho = correlation.map_or(0.0, |rho| rho.at(i));
        let square = first * first + second * second - 2.0 * rho * first * second;
        Ok([ratio, sqrt(result(square)?.max(0.0))])
    })
}

/// (a - b)/sigma, as (B_Fixed - B_Normal)/sigma_Normal, and its error.
///
/// # Errors
/// As [`ratio_of_means`]; `Range` for sigma that is not positive.
///
/// # Example
/// ```
/// use fixpair::variance::ratios::{Means, difference_of_means};
///
/// let (fixed, normal) = (Means { mean: &[101.0], error: &[1.0] }, Means { mean: &[100.0], error: &[5.0] });
/// let (mut difference, mut error) = ([0.0], [0.0]);
/// difference_of_means(&mut difference, &mut error, fixed, normal, None, &[10.0])?; // in units of sigma
/// assert!((difference[0] - 0.1).abs() < 1e-12);
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn difference_of_means(
    difference: &mut [f64],
    error: &mut [f64],
    first: Means<'_>,
    second: Means<'_>,
    correlation: Option<&[f64]>,
    sigma: &[f64],
) -> Result<()> {
    let len = difference.len();
    first.check(len)?;
    second.check(len)?;
    check_correlation(correlation, len)?;
    same_length(len, &[sigma.len()])?;
    positive(sigma)?;
    fill_two(difference, error, |i| {
        let (a, b) = (first.error.at(i) / sigma.at(i), second.error.at(i) / sigma.at(i));
        let rho = correlation.map_or(0.0, |rho| rho.at(i));
        let square = a * a + b * b - 2.0 * rho * a * b;
        let difference = result((first.mean.at(i) - second.mean.at(i)) / sigma.at(i))?;
        Ok([difference, sqrt(result(square)?.max(0.0))])
    })
}
