//! From the primordial potential to the density: delta(k, a) = alpha(k, a) Phi(k) (Eq. poisson, Eq. alpha of arXiv:2204.11103).
//!
//! alpha(k, a) = (2/3) (c/H0)^2 k^2 T(k) D(a)/Om * g(0)/g(z_rad), with Om today's (as Poisson's equation has it; the paper prints Om(z)),
//! T(k -> 0) = 1, D(1) = 1, g = (1 + z) D. Phi has the sign that makes alpha positive, so f_NL > 0 skews the density positively.
//! P_Phi(k) = P(k)/alpha^2(k, a = 1) = A_Phi k^(n_s - 4) exactly, whatever T is.

use super::HUBBLE_DISTANCE;
use super::background::Cosmology;
use super::growth::{Growth, g_ratio, growth};
use super::power::{Linear, finite};
use super::table::check_wavenumber;
use crate::status::{Error, Result};

/// Which potential Phi, and with it f_NL, means.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(i32)]
pub enum Convention {
    /// Phi of matter domination, as in studies of the microwave background. The default of this library.
    Cmb = 0,
    /// Phi extrapolated linearly to z = 0, as in some studies of large-scale structure: smaller than the other by
    /// g(z_rad)/g(0), so that f_NL(LSS) = g(z_rad)/g(0) f_NL(CMB).
    Lss = 1,
}

impl TryFrom<i32> for Convention {
    type Error = Error;

    fn try_from(value: i32) -> Result<Self> {
        match value {
            0 => Ok(Self::Cmb),
            1 => Ok(Self::Lss),
            _ => Err(Error::Choice),
        }
    }
}

/// alpha(k, a)/(k^2 T(k)) in (Mpc/h)^2: (2/3) (c/H0)^2 D(a)/Om, over g(z_rad)/g(0) in the CMB convention.
///
/// # Errors
/// As [`growth`](fn@growth).
///
/// # Example
/// ```
/// use fixpair::cosmology::{Convention, Cosmology, alpha_factor};
///
/// let factor = alpha_factor(&Cosmology::goliat(), 0.5, Convention::Cmb)?; // alpha/(k^2 T)
/// assert!((1e-4 * factor - 1050.4).abs() < 0.1); // at k = 0.01 h/Mpc, z = 1
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn alpha_factor(cosmology: &Cosmology, a: f64, convention: Convention) -> Result<f64> {
    let d = growth(cosmology, a)?.d;
    Ok(factor_today(cosmology, convention)? * d)
}

fn factor_today(cosmology: &Cosmology, convention: Convention) -> Result<f64> {
    let decay = match convention {
        Convention::Cmb => g_ratio(cosmology)?,
        Convention::Lss => 1.0,
    };
    Ok(2.0 / 3.0 * (HUBBLE_DISTANCE * HUBBLE_DISTANCE) / (cosmology.omega_m * decay))
}

/// A of P(k) = A k^n_s T^2(k) at z = 0 from A_s, the variance per ln k of the curvature perturbation at `pivot` in 1/Mpc (0.05 is
/// customary): Phi = (3/5) zeta in matter domination, so A = alpha_factor^2 (9/25) 2 pi^2 A_s k_pivot^(1 - n_s).
///
/// Boltzmann codes keep radiation until today, which changes the largest scales by a few Or/Om: for the paper's cosmology
/// sigma8 comes out 0.07% higher here.
///
/// # Errors
/// As [`Cosmology::check`]; `NotFinite`; `Range` if `a_s` or `pivot` is not positive or A overflows.
///
/// # Example
/// ```
/// use fixpair::cosmology::{Cosmology, primordial_amplitude};
///
/// let amplitude = primordial_amplitude(&Cosmology::goliat(), 2.1e-9, 0.05)?; // A of P = A k^n_s T^2
/// assert!(amplitude > 1e6);
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn primordial_amplitude(cosmology: &Cosmology, a_s: f64, pivot: f64) -> Result<f64> {
    if !(a_s.is_finite() && pivot.is_finite()) {
        return Err(Error::NotFinite);
    }
    if a_s <= 0.0 || pivot <= 0.0 {
        return Err(Error::Range);
    }
    let factor = factor_today(cosmology, Convention::Cmb)?;
    let pi2 = core::f64::consts::PI * core::f64::consts::PI;
    let tilt = libm::pow(pivot / cosmology.h, 1.0 - cosmology.n_s);
    finite(factor * factor * 0.36 * 2.0 * pi2 * a_s * tilt)
}

/// A linear spectrum, the potential that it came from, and the time at which the density is wanted.
#[derive(Clone, Copy, Debug)]
pub struct Poisson<'a> {
    linear: Linear<'a>,
    growth: Growth,
    /// alpha/(k^2 T) at this time.
    factor: f64,
    /// A_Phi of P_Phi = A_Phi k^(n_s - 4).
    potential: f64,
}

impl<'a> Poisson<'a> {
    /// `linear` is today's; the density is that at scale factor `a`.
    ///
    /// # Errors
    /// As [`growth`](fn@growth); `Range` if the amplitude of Phi under- or overflows, or if the cosmology's n_s is not the spectrum's.
    ///
    /// Cost: 0.8 ms.
    ///
    /// # Example
    /// ```
    /// use fixpair::cosmology::{Convention, Cosmology, EisensteinHu, Linear, Poisson, Wiggles};
    ///
    /// let cosmology = Cosmology::goliat();
    /// let fit = EisensteinHu::new(&cosmology, Wiggles::With)?;
    /// let linear = Linear::from_eisenstein_hu(fit, 0.96, 1.0)?.with_sigma8(0.8)?;
    /// let poisson = Poisson::new(&cosmology, linear, 0.5, Convention::Cmb)?; // z = 1
    /// assert!(poisson.alpha(0.01)? > 0.0); // f_NL > 0 raises the power of halos
    /// # Ok::<(), fixpair::status::Error>(())
    /// ```
    pub fn new(cosmology: &Cosmology, linear: Linear<'a>, a: f64, convention: Convention) -> Result<Self> {
        let growth = growth(cosmology, a)?;
        if linear.n_s() != cosmology.n_s {
            return Err(Error::Range);
        }
        let today = factor_today(cosmology, convention)?;
        let potential = finite(linear.amplitude() / (today * today))?;
        if potential < f64::MIN_POSITIVE {
            return Err(Error::Range);
        }
        Ok(Self { linear, growth, factor: today * growth.d, potential })
    }

    /// The spectrum of today.
    ///
    /// ```
    /// use fixpair::cosmology::{Convention, Cosmology, EisensteinHu, Linear, Poisson, Wiggles};
    ///
    /// let cosmology = Cosmology::goliat();
    /// let fit = EisensteinHu::new(&cosmology, Wiggles::With)?;
    /// let linear = Linear::from_eisenstein_hu(fit, 0.96, 1.0)?.with_sigma8(0.8)?;
    /// let poisson = Poisson::new(&cosmology, linear, 0.5, Convention::Cmb)?; // z = 1
    /// assert_eq!(poisson.linear().n_s(), 0.96);
    /// # Ok::<(), fixpair::status::Error>(())
    /// ```
    #[must_use]
    pub fn linear(&self) -> &Linear<'a> {
        &self.linear
    }

    /// Growth at the time of the density.
    ///
    /// ```
    /// use fixpair::cosmology::{Convention, Cosmology, EisensteinHu, Linear, Poisson, Wiggles};
    ///
    /// let cosmology = Cosmology::goliat();
    /// let fit = EisensteinHu::new(&cosmology, Wiggles::With)?;
    /// let linear = Linear::from_eisenstein_hu(fit, 0.96, 1.0)?.with_sigma8(0.8)?;
    /// let poisson = Poisson::new(&cosmology, linear, 0.5, Convention::Cmb)?; // z = 1
    /// assert!((poisson.growth().d - 0.6228).abs() < 1e-4);
    /// # Ok::<(), fixpair::status::Error>(())
    /// ```
    #[must_use]
    pub fn growth(&self) -> Growth {
        self.growth
    }

    /// alpha(k, a)/(k^2 T(k)) in (Mpc/h)^2.
    ///
    /// ```
    /// use fixpair::cosmology::{Convention, Cosmology, EisensteinHu, Linear, Poisson, Wiggles};
    ///
    /// let cosmology = Cosmology::goliat();
    /// let fit = EisensteinHu::new(&cosmology, Wiggles::With)?;
    /// let linear = Linear::from_eisenstein_hu(fit, 0.96, 1.0)?.with_sigma8(0.8)?;
    /// let poisson = Poisson::new(&cosmology, linear, 0.5, Convention::Cmb)?; // z = 1
    /// let k = 0.01;
    /// assert!((poisson.alpha(k)? / (poisson.factor() * k * k * poisson.linear().transfer(k)?) - 1.0).abs() < 1e-12);
    /// # Ok::<(), fixpair::status::Error>(())
    /// ```
    #[must_use]
    pub fn factor(&self) -> f64 {
        self.factor
    }

    /// A_Phi of P_Phi(k) = A_Phi k^(n_s - 4).
    ///
    /// ```
    /// use fixpair::cosmology::{Convention, Cosmology, EisensteinHu, Linear, Poisson, Wiggles};
    ///
    /// let cosmology = Cosmology::goliat();
    /// let fit = EisensteinHu::new(&cosmology, Wiggles::With)?;
    /// let linear = Linear::from_eisenstein_hu(fit, 0.96, 1.0)?.with_sigma8(0.8)?;
    /// let poisson = Poisson::new(&cosmology, linear, 0.5, Convention::Cmb)?; // z = 1
    /// assert!(poisson.potential_amplitude() > 0.0); // of P_Phi = A_Phi k^(n_s - 4)
    /// # Ok::<(), fixpair::status::Error>(())
    /// ```
    #[must_use]
    pub fn potential_amplitude(&self) -> f64 {
        self.potential
    }

    /// alpha(k, a), without unit, k in h/Mpc.
    ///
    /// # Errors
    /// `NotFinite` if k is; `Range` if k is not positive or alpha overflows.
    ///
    /// # Example
    /// ```
    /// use fixpair::cosmology::{Convention, Cosmology, EisensteinHu, Linear, Poisson, Wiggles};
    ///
    /// let cosmology = Cosmology::goliat();
    /// let fit = EisensteinHu::new(&cosmology, Wiggles::With)?;
    /// let linear = Linear::from_eisenstein_hu(fit, 0.96, 1.0)?.with_sigma8(0.8)?;
    /// let poisson = Poisson::new(&cosmology, linear, 0.5, Convention::Cmb)?; // z = 1
    /// let ratio = poisson.density_power(0.1)? / poisson.potential_power(0.1)?;
    /// assert!((poisson.alpha(0.1)?.powi(2) / ratio - 1.0).abs() < 1e-12); // delta = alpha Phi
    /// # Ok::<(), fixpair::status::Error>(())
    /// ```
    pub fn alpha(&self, k: f64) -> Result<f64> {
        check_wavenumber(k)?;
        finite(self.factor * (k * k) * self.linear.transfer(k)?)
    }

    /// P_Phi(k) in (Mpc/h)^3.
    ///
    /// # Errors
    /// As [`Poisson::alpha`].
    ///
    /// # Example
    /// ```
    /// use fixpair::cosmology::{Convention, Cosmology, EisensteinHu, Linear, Poisson, Wiggles};
    ///
    /// let cosmology = Cosmology::goliat();
    /// let fit = EisensteinHu::new(&cosmology, Wiggles::With)?;
    /// let linear = Linear::from_eisenstein_hu(fit, 0.96, 1.0)?.with_sigma8(0.8)?;
    /// let poisson = Poisson::new(&cosmology, linear, 0.5, Convention::Cmb)?; // z = 1
    /// let slope = (poisson.potential_power(0.2)? / poisson.potential_power(0.1)?).log2();
    /// assert!((slope - (0.96 - 4.0)).abs() < 1e-9);
    /// # Ok::<(), fixpair::status::Error>(())
    /// ```
    pub fn potential_power(&self, k: f64) -> Result<f64> {
        check_wavenumber(k)?;
        finite(self.potential * libm::pow(k, self.linear.n_s() - 4.0))
    }

    /// The linear density's P(k, a) = P(k) D^2(a) in (Mpc/h)^3.
    ///
    /// # Errors
    /// As [`Poisson::alpha`].
    ///
    /// # Example
    /// ```
    /// use fixpair::cosmology::{Convention, Cosmology, EisensteinHu, Linear, Poisson, Wiggles};
    ///
    /// let cosmology = Cosmology::goliat();
    /// let fit = EisensteinHu::new(&cosmology, Wiggles::With)?;
    /// let linear = Linear::from_eisenstein_hu(fit, 0.96, 1.0)?.with_sigma8(0.8)?;
    /// let poisson = Poisson::new(&cosmology, linear, 0.5, Convention::Cmb)?; // z = 1
    /// let today = poisson.linear().power(0.1)?;
    /// assert!((poisson.density_power(0.1)? / today - poisson.growth().d.powi(2)).abs() < 1e-12);
    /// # Ok::<(), fixpair::status::Error>(())
    /// ```
    pub fn density_power(&self, k: f64) -> Result<f64> {
        finite(self.linear.power(k)? * self.growth.d * self.growth.d)
    }
}
