//! Halo bias with primordial non-Gaussianity.
//!
//! ```text
//! b(k) = b_g + b_phi f_NL/alpha(k, z),  b_phi = 2 delta_c (b_g - p)                  (Eq. bk)
//! P_hh = b^2 P_lin,  P_hm = b P_lin
//! ```
//!
//! alpha is that of [`Poisson::alpha`](crate::cosmology::Poisson::alpha) at the redshift of the halos, in the convention of f_NL. p = 1 is universality (Dalal et al. 2008, Slosar et al. 2008):
//! b_phi depends on mass through b_g alone.

use super::check::{fill, fill_two, finite, positive, result, same_length};
use crate::math::sqrt;
use crate::status::{Error, Result};
use crate::within::Within;

/// Overdensity of spherical collapse.
pub const DELTA_C: f64 = 1.686;

/// The parameters of Eq. bk.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct Bias {
    /// b_g: bias of a Gaussian universe.
    pub b_g: f64,
    /// p: 1 for universality.
    pub p: f64,
    /// f_NL, in the convention of alpha.
    pub f_nl: f64,
    /// delta_c: 1.686.
    pub delta_c: f64,
}

impl Default for Bias {
    /// b_g = p = 1, f_NL = 0.
    fn default() -> Self {
        Self { b_g: 1.0, p: 1.0, f_nl: 0.0, delta_c: DELTA_C }
    }
}

impl Bias {
    pub(super) fn check(&self) -> Result<()> {
        finite(&[self.b_g, self.p, self.f_nl])?;
        positive(&[self.delta_c])
    }

    /// b_phi f_NL: what 1/alpha is multiplied by.
    pub(super) fn shift(&self) -> f64 {
        2.0 * self.delta_c * (self.b_g - self.p) * self.f_nl
    }
}

/// Whose spectrum.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Spectrum {
    /// P_hh.
    HaloHalo,
    /// P_hm.
    HaloMatter,
}

/// b(k) (Eq. bk).
///
/// # Errors
/// `Length` for arrays of different lengths, `NotFinite`, `Range` for alpha or delta_c that is not positive, or a result that overflows.
///
/// # Example
/// ```
/// use fixpair::variance::bias::{Bias, bias_of_k};
///
/// let (galaxies, mut b) = (Bias { b_g: 2.32, p: 1.0, f_nl: 100.0, delta_c: 1.686 }, [0.0]);
/// bias_of_k(&mut b, &galaxies, &[1050.4])?; // alpha at k = 0.01 h/Mpc, z = 1 and T = 1
/// assert!((b[0] - 2.32 - 0.4237).abs() < 1e-4);
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn bias_of_k(out: &mut [f64], parameters: &Bias, alpha: &[f64]) -> Result<()> {
    same_length(out.len(), &[alpha.len()])?;
    parameters.check()?;
    positive(alpha)?;
    fill(out, |i| result(parameters.b_g + parameters.shift() / alpha.at(i)))
}

/// b^2 P_lin or b P_lin.
///
/// # Errors
/// As [`bias_of_k`].
///
/// # Example
/// ```
/// use fixpair::variance::bias::{Bias, Spectrum, halo_power};
///
/// let (galaxies, mut power) = (Bias { b_g: 2.0, p: 1.0, f_nl: 0.0, delta_c: 1.686 }, [0.0]);
/// halo_power(&mut power, &galaxies, Spectrum::HaloHalo, &[1000.0], &[1050.0])?;
/// assert_eq!(power, [4000.0]); // b^2 P
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn halo_power(
    out: &mut [f64],
    parameters: &Bias,
    spectrum: Spectrum,
    linear: &[f64],
    alpha: &[f64],
) -> Result<()> {
    same_length(out.len(), &[linear.len(), alpha.len()])?;
    parameters.check()?;
    positive(alpha)?;
    finite(linear)?;
    fill(out, |i| {
        let bias = parameters.b_g + parameters.shift() / alpha.at(i);
        result(match spectrum {
            Spectrum::HaloHalo => bias * bias * linear.at(i),
            Spectrum::HaloMatter => bias * linear.at(i),
        })
    })
}

/// The bias of a measured spectrum, sqrt(P_hh/P_lin) or P_hm/P_lin, with the error that sigma of the spectrum makes.
///
/// # Errors
/// `Length` for arrays of different lengths, `NotFinite`, `Range` for P_lin or sigma that is not positive, P_hh that is not positive, or a result that
/// overflows.
///
/// # Example
/// ```
/// use fixpair::variance::bias::{Spectrum, measured_bias};
///
/// let (mut b, mut error) = ([0.0], [0.0]);
/// measured_bias(&mut b, &mut error, Spectrum::HaloHalo, &[4000.0], &[80.0], &[1000.0])?;
/// assert!((b[0] - 2.0).abs() < 1e-14 && (error[0] - 0.02).abs() < 1e-14); // sigma/(2 b P)
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn measured_bias(
    out: &mut [f64],
    error: &mut [f64],
    spectrum: Spectrum,
    power: &[f64],
    sigma: &[f64],
    linear: &[f64],
) -> Result<()> {
    same_length(out.len(), &[power.len(), sigma.len(), linear.len()])?;
    finite(power)?;
    positive(sigma)?;
    positive(linear)?;
    fill_two(out, error, |i| {
        let (ratio, sigma) = (result(power.at(i) / linear.at(i))?, result(sigma.at(i) / linear.at(i))?);
        match spectrum {
            Spectrum::HaloHalo if ratio > 0.0 => {
                let bias = sqrt(ratio);
                Ok([bias, result(sigma / (2.0 * bias))?])
            }
            Spectrum::HaloHalo => Err(Error::Range),
            Spectrum::HaloMatter => Ok([ratio, sigma]),
        }
    })
}
