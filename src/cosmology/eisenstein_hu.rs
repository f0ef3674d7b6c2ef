//! The transfer functions of Eisenstein & Hu 1998 (astro-ph/9709112): fits for cold dark matter and baryons.
//!
//! Equation numbers are theirs. They hold to a few percent for 0.025 <= Om h^2 <= 0.25 and any baryon fraction up to a half; T is normalised
//! to 1 at k -> 0, k is in h/Mpc and converted inside.

use core::f64::consts::E;

use super::background::Cosmology;
use super::table::check_wavenumber;
use crate::status::{Error, Result};

/// Which of the two fits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(i32)]
pub enum Wiggles {
    /// The smooth shape (section 4.2), without acoustic oscillations.
    Without = 0,
    /// The full fit (section 3), with them.
    With = 1,
}

impl TryFrom<i32> for Wiggles {
    type Error = Error;

    fn try_from(value: i32) -> Result<Self> {
        match value {
            0 => Ok(Self::Without),
            1 => Ok(Self::With),
            _ => Err(Error::Choice),
        }
    }
}

/// The coefficients of a fit for one cosmology.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EisensteinHu {
    /// 1/Mpc in h/Mpc.
    h: f64,
    fit: Fit,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Fit {
    Without(Smooth),
    With(Full),
}

/// Section 4.2.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Smooth {
    /// Om h^2.
    matter: f64,
    /// (T_cmb/2.7 K)^2.
    theta2: f64,
    /// Eq. 26, Mpc.
    sound_horizon: f64,
    /// Eq. 31.
    alpha_gamma: f64,
}

/// Section 3.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Full {
    baryon_fraction: f64,
    /// Eq. 3, 1/Mpc.
    k_equality: f64,
    /// Eq. 6, Mpc.
    sound_horizon: f64,
    /// Eq. 7, 1/Mpc.
    k_silk: f64,
    /// Eq. 11.
    alpha_c: f64,
    /// Eq. 12.
    beta_c: f64,
    /// Eq. 14.
    alpha_b: f64,
    /// Eq. 24.
    beta_b: f64,
    /// Eq. 23.
    beta_node: f64,
}

impl EisensteinHu {
    /// The fit for Om, Ob, h and t_cmb of a cosmology.
    ///
    /// # Errors
    /// As [`Cosmology::check`]; `Range` if Om h^2 is not in 0.005 ..= 2, or if wiggles are asked for and Ob is less than 1e-6 Om.
    ///
    /// # Example
    /// ```
    /// use fixpair::cosmology::{Cosmology, EisensteinHu, Wiggles};
    ///
    /// let smooth = EisensteinHu::new(&Cosmology::goliat(), Wiggles::Without)?;
    /// let wiggly = EisensteinHu::new(&Cosmology::goliat(), Wiggles::With)?;
    /// assert!((smooth.transfer(0.1)? / wiggly.transfer(0.1)? - 1.0).abs() < 0.1);
    /// # Ok::<(), fixpair::status::Error>(())
    /// ```
    pub fn new(cosmology: &Cosmology, wiggles: Wiggles) -> Result<Self> {
        cosmology.check()?;
        let Cosmology { omega_m, omega_b, h, t_cmb, .. } = *cosmology;
        let (matter, baryons) = (omega_m * h * h, omega_b * h * h);
        if !(0.005..=2.0).contains(&matter) {
            return Err(Error::Range);
        }
        let theta2 = (t_cmb / 2.7) * (t_cmb / 2.7);
        let fit = match wiggles {
            Wiggles::Without => Fit::Without(Smooth::new(matter, baryons, theta2)),
            Wiggles::With if omega_b < 1e-6 * omega_m => return Err(Error::Range),
            Wiggles::With => Fit::With(Full::new(matter, baryons, theta2)),
        };
        Ok(Self { h, fit })
    }

    /// T(k), k in h/Mpc.
    ///
    /// # Errors
    /// `NotFinite` if k is; `Range` if k is not positive.
    ///
    /// # Example
    /// ```
    /// use fixpair::cosmology::{Cosmology, EisensteinHu, Wiggles};
    ///
    /// let fit = EisensteinHu::new(&Cosmology::goliat(), Wiggles::With)?;
    /// assert!((fit.transfer(1e-5)? - 1.0).abs() < 1e-3 && fit.transfer(1.0)? < 0.01);
    /// # Ok::<(), fixpair::status::Error>(())
    /// ```
    pub fn transfer(&self, k: f64) -> Result<f64> {
        check_wavenumber(k)?;
        Ok(self.transfer_unchecked(k))
    }

    pub(crate) fn transfer_unchecked(&self, k: f64) -> f64 {
        // Below the first bound every fit is 1 to rounding, above the second T has no digits left that mean anything; the
        // bounds keep powers of k from under- and overflow.
        let k = (k * self.h).clamp(1e-30, 1e30);
        match &self.fit {
            Fit::Without(fit) => fit.transfer(k),
            Fit::With(fit) => fit.transfer(k),
        }
    }
}

impl Smooth {
    fn new(matter: f64, baryons: f64, theta2: f64) -> Self {
        let fraction = baryons / matter;
        let sound_horizon =
            44.5 * libm::log(9.83 / matter) / libm::sqrt(1.0 + 10.0 * libm::pow(baryons, 0.75)); // 26
        let alpha_gamma = 1.0 - 0.328 * libm::log(431.0 * matter) * fraction
            + 0.38 * libm::log(22.3 * matter) * fraction * fraction; // 31
        Self { matter, theta2, sound_horizon, alpha_gamma }
    }

    /// k in 1/Mpc.
    fn transfer(&self, k: f64) -> f64 {
        let x = 0.43 * k * self.sound_horizon;
        let gamma = self.alpha_gamma + (1.0 - self.alpha_gamma) / (1.0 + (x * x) * (x * x)); // 30
        let q = k * self.theta2 / (self.matter * gamma); // 28
        let l = libm::log(2.0 * E + 1.8 * q);
        let c = 14.2 + 731.0 / (1.0 + 62.5 * q);
        l / (l + c * q * q) // 29
    }
}

impl Full {
    fn new(matter: f64, baryons: f64, theta2: f64) -> Self {
        let pow = libm::pow;
        let fraction = baryons / matter;
        let z_equality = 2.5e4 * matter / (theta2 * theta2); // 2
        let k_equality = 0.0746 * matter / theta2; // 3
        let b1 = 0.313 * pow(matter, -0.419) * (1.0 + 0.607 * pow(matter, 0.674));
        let b2 = 0.238 * pow(matter, 0.223);
        let z_drag =
            1291.0 * pow(matter, 0.251) / (1.0 + 0.659 * pow(matter, 0.828)) * (1.0 + b1 * pow(baryons, b2)); // 4
        let ratio = |z: f64| 31.5 * baryons / (theta2 * theta2) * (1e3 / z); // 5
        let (r_drag, r_equality) = (ratio(z_drag), ratio(z_equality));
        let sound_horizon = 2.0 / (3.0 * k_equality)
            * libm::sqrt(6.0 / r_equality)
            * libm::log(
                (libm::sqrt(1.0 + r_drag) + libm::sqrt(r_drag + r_equality)) / (1.0 + libm::sqrt(r_equality)),
            ); // 6
        let k_silk = 1.6 * pow(baryons, 0.52) * pow(matter, 0.73) * (1.0 + pow(10.4 * matter, -0.95)); // 7
        let a1 = pow(46.9 * matter, 0.670) * (1.0 + pow(32.1 * matter, -0.532));
        let a2 = pow(12.0 * matter, 0.424) * (1.0 + pow(45.0 * matter, -0.582));
        let alpha_c = pow(a1, -fraction) * pow(a2, -fraction * fraction * fraction); // 11
        let b1 = 0.944 / (1.0 + pow(458.0 * matter, -0.708));
        let b2 = pow(0.395 * matter, -0.0266);
        let beta_c = 1.0 / (1.0 + b1 * (pow(1.0 - fraction, b2) - 1.0)); // 12
        let y = (1.0 + z_equality) / (1.0 + z_drag);
        let root = libm::sqrt(1.0 + y);
        let g = y * (-6.0 * root + (2.0 + 3.0 * y) * libm::log((root + 1.0) / (root - 1.0))); // 15
        let alpha_b = 2.07 * k_equality * sound_horizon * pow(1.0 + r_drag, -0.75) * g; // 14
        let x = 17.2 * matter;
        let beta_b = 0.5 + fraction + (3.0 - 2.0 * fraction) * libm::sqrt(x * x + 1.0); // 24
        let beta_node = 8.41 * pow(matter, 0.435); // 23
        Self {
            baryon_fraction: fraction,
            k_equality,
            sound_horizon,
            k_silk,
            alpha_c,
            beta_c,
            alpha_b,
            beta_b,
            beta_node,
        }
    }

    /// k in 1/Mpc.
    fn transfer(&self, k: f64) -> f64 {
        let cube = |x: f64| x * x * x;
        let q = k / (13.41 * self.k_equality); // 10
        let bend = 386.0 / (1.0 + 69.9 * libm::exp(1.08 * libm::log(q)));
        let [plain, shallow] = [1.0, self.beta_c].map(|beta| libm::log(E + 1.8 * beta * q));
        let pressureless = |l: f64, alpha: f64| l / (l + (14.2 / alpha + bend) * q * q); // 19, 20
        let ks = k * self.sound_horizon;
        let x = ks / 5.4;
        let f = 1.0 / (1.0 + (x * x) * (x * x)); // 18
        let cold = f * pressureless(shallow, 1.0) + (1.0 - f) * pressureless(shallow, self.alpha_c); // 17
        let shifted = ks / libm::cbrt(1.0 + cube(self.beta_node / ks)); // 22
        let sinc = if shifted < 1e-4 { 1.0 - shifted * shifted / 6.0 } else { libm::sin(shifted) / shifted };
        let baryons = (pressureless(plain, 1.0) / (1.0 + (ks / 5.2) * (ks / 5.2))
            + self.alpha_b / (1.0 + cube(self.beta_b / ks))
                * libm::exp(-libm::exp(1.4 * libm::log(k / self.k_silk))))
            * sinc; // 21
        self.baryon_fraction * baryons + (1.0 - self.baryon_fraction) * cold // 16
    }
}
