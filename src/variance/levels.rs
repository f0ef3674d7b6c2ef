//! Numbers that statistics textbooks tabulate: levels of chi^2, and what a covariance from a finite number of simulations costs.

use super::check::finite;
use crate::status::{Error, Result};

/// Delta chi^2 of the region that holds the given probability of `parameters` Gaussian parameters, 1 or 2: 1 and 4 hold 0.6827 and 0.9545 of one
/// parameter, 2.30 and 6.18 of two.
///
/// # Errors
/// `NotFinite`; `Range` for a probability outside (0, 1), or parameters other than 1 and 2.
///
/// # Example
/// ```
/// use fixpair::variance::levels::delta_chi_squared;
///
/// assert!((delta_chi_squared(0.6827, 1)? - 1.0).abs() < 1e-3);
/// assert!((delta_chi_squared(0.68, 2)? - 2.279).abs() < 1e-3);
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn delta_chi_squared(probability: f64, parameters: u32) -> Result<f64> {
    finite(&[probability])?;
    if !(probability > 0.0 && probability < 1.0) {
        return Err(Error::Range);
    }
    match parameters {
        1 => {
            // erf(x/sqrt 2) = probability by Newton's steps from below, where erf is concave: they cannot overshoot.
            let mut x = 0.0;
            for _ in 0..200 {
                let missing = libm::erfc(x * core::f64::consts::FRAC_1_SQRT_2) - (1.0 - probability);
                let slope = core::f64::consts::FRAC_2_SQRT_PI * core::f64::consts::FRAC_1_SQRT_2;
                let step = missing / (slope * libm::exp(-0.5 * x * x));
                if x + step <= x {
                    break;
                }
                x += step;
            }
            Ok(x * x)
        }
        2 => Ok(-2.0 * libm::log1p(-probability)),
        _ => Err(Error::Range),
    }
}

/// N - p - 1 of N estimates of p values, checked to be at least `least`.
fn surplus(estimates: u64, values: u64, least: u64) -> Result<f64> {
    let needed = values.checked_add(1).and_then(|taken| taken.checked_add(least)).ok_or(Error::Samples)?;
    if values == 0 {
        return Err(Error::Range);
    }
    if estimates < needed { Err(Error::Samples) } else { Ok((estimates - values - 1) as f64) }
}

/// What the inverse of a covariance of p values measured from N independent estimates must be multiplied by to be unbiased: (N - p - 2)/(N - 1)
/// (Hartlap, Simon & Schneider 2007, astro-ph/0608064).
///
/// # Errors
/// `Samples` unless N >= p + 3, `Range` for no values.
///
/// # Example
/// ```
/// use fixpair::variance::levels::hartlap_factor;
///
/// assert_eq!(hartlap_factor(100, 14)?, 84.0 / 99.0); // (N - p - 2)/(N - 1) on the inverse covariance
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn hartlap_factor(estimates: u64, values: u64) -> Result<f64> {
    Ok((surplus(estimates, values, 2)? - 1.0) / (estimates - 1) as f64)
}

/// What the *variance* of parameters fitted with such an inverse, Hartlap's factor included, must be multiplied by to include the noise of the
/// covariance: (1 + B (p - q))/(1 + A + B (q + 1)) for q parameters, A = 2/((N - p - 1)(N - p - 4)), B = (N - p - 2)/((N - p - 1)(N - p - 4))
/// (Percival et al. 2014, arXiv:1312.4841, Eq. 18). Errors are multiplied by its root.
///
/// # Errors
/// `Samples` unless N >= p + 5, `Range` for no values, no parameters, or more of them than values.
///
/// # Example
/// ```
/// use fixpair::variance::levels::percival_factor;
///
/// assert!(percival_factor(100, 14, 2)? > 1.0); // on the variance of two parameters
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn percival_factor(estimates: u64, values: u64, parameters: u64) -> Result<f64> {
    if parameters == 0 || parameters > values {
        return Err(Error::Range);
    }
    let rest = surplus(estimates, values, 4)?;
    let below = rest * (rest - 3.0);
    let (a, b) = (2.0 / below, (rest - 1.0) / below);
    Ok((1.0 + b * (values - parameters) as f64) / (1.0 + a + b * (parameters + 1) as f64))
}
