//! Averages of pairs, and the scatter per simulation.

use super::check::{fill, fill_two, finite, not_negative, same_length};
use crate::math::sqrt;
use crate::status::{Error, Result};
use crate::within::Within;

/// P_paired = (P_original + P_inverted)/2 (Eq. pair): one estimate that costs two simulations.
///
/// # Errors
/// `Length` for arrays of different lengths, `NotFinite`.
///
/// # Example
/// ```
/// use fixpair::variance::pairs::pair_average;
///
/// let mut average = [0.0; 2];
/// pair_average(&mut average, &[110.0, 52.0], &[90.0, 48.0])?;
/// assert_eq!(average, [100.0, 50.0]);
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn pair_average(out: &mut [f64], original: &[f64], inverted: &[f64]) -> Result<()> {
    same_length(out.len(), &[original.len(), inverted.len()])?;
    finite(original)?;
    finite(inverted)?;
    // Halves first: no average overflows.
    fill(out, |i| Ok(0.5 * original.at(i) + 0.5 * inverted.at(i)))
}

/// The relative error of a standard deviation of so many estimates, 1/sqrt(2 (N - 1)) (Eq. errerr; Lehmann & Casella 1998).
///
/// # Errors
/// `Samples` for fewer than two.
///
/// # Example
/// ```
/// use fixpair::variance::pairs::relative_error_of_deviation;
///
/// assert!((relative_error_of_deviation(41)? - 0.1118).abs() < 1e-4); // the paper's 41 simulations
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn relative_error_of_deviation(estimates: u64) -> Result<f64> {
    if estimates < 2 { Err(Error::Samples) } else { Ok(1.0 / sqrt(2.0 * (estimates - 1) as f64)) }
}

/// The scatter per simulation, sqrt(m) times the standard deviation of estimates of m simulations each (Eq. sigma_paired for m = 2), and its error
/// by Eq. errerr.
///
/// `estimates` counts independent ones: of 41 pairs 41, not 82.
///
/// # Errors
/// `Length` for arrays of different lengths, `Samples` for fewer than two estimates, `NotFinite`, `Range` for negative deviations, no
/// simulations, or a result that overflows.
///
/// # Example
/// ```
/// use fixpair::variance::pairs::sigma_per_simulation;
///
/// let (mut sigma, mut error) = ([0.0], [0.0]);
/// sigma_per_simulation(&mut sigma, &mut error, &[10.0], 41, 2)?; // of 41 averages of pairs
/// assert!((sigma[0] - 14.142).abs() < 1e-3 && (error[0] - 1.581).abs() < 1e-3);
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn sigma_per_simulation(
    sigma: &mut [f64],
    error: &mut [f64],
    deviation: &[f64],
    estimates: u64,
    simulations: u64,
) -> Result<()> {
    same_length(sigma.len(), &[error.len(), deviation.len()])?;
    let relative = relative_error_of_deviation(estimates)?;
    not_negative(deviation)?;
    if simulations == 0 {
        return Err(Error::Range);
    }
    let root = sqrt(simulations as f64);
    fill_two(sigma, error, |i| {
        let sigma = super::check::result(root * deviation.at(i))?;
        Ok([sigma, relative * sigma])
    })
}
