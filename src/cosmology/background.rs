//! The homogeneous universe: E(a) = H/H0 and the fractions of its contents.
//!
//! E^2(a) = Or a^-4 + Om a^-3 + Ok a^-2 + Ode X(a), X = a^(-3(1+w0+wa)) exp(-3 wa (1-a)), Ok = 1 - Om - Ode - Or
//! (Chevallier & Polarski 2001, gr-qc/0009008; Linder 2003, astro-ph/0208512). Massive neutrinos count as matter.

use crate::status::{Error, Result};

/// The earliest scale factor at which the background is asked for.
pub const EARLIEST: f64 = 1e-10;

/// The latest scale factor at which the background is asked for.
pub const LATEST: f64 = 10.0;

/// Step in ln a between the places where a cosmology is checked.
const CHECK_STEP: f64 = 0.0625;

/// Where E^2 is less than this part of the sum of its terms' sizes, expansion counts as stopped: so no root hides between two checks, and the
/// fixed steps of [`growth`](mod@super::growth) stay short against the time in which E changes.
const STANDSTILL: f64 = 0.03;

/// A homogeneous universe and the primordial tilt. Densities are today's, in units of the critical density.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct Cosmology {
    /// All matter: cold dark matter, baryons, massive neutrinos.
    pub omega_m: f64,
    /// Dark energy (the cosmological constant where w0 = -1, wa = 0).
    pub omega_de: f64,
    /// Radiation: photons and massless neutrinos. Zero for a simulation without radiation in its background.
    pub omega_r: f64,
    /// Baryons, a part of `omega_m`. Only the Eisenstein-Hu transfer functions read it.
    pub omega_b: f64,
    /// H0 in units of 100 km/s/Mpc.
    pub h: f64,
    /// Tilt of the primordial spectrum: P(k) -> A k^n_s for small k.
    pub n_s: f64,
    /// Dark energy's pressure over density today.
    pub w0: f64,
    /// Its change: w(a) = w0 + wa (1 - a).
    pub wa: f64,
    /// Temperature of the microwave background in K. Only the Eisenstein-Hu transfer functions read it.
    pub t_cmb: f64,
}

impl Cosmology {
    /// Matter and a cosmological constant, flat and without radiation.
    ///
    /// ```
    /// use fixpair::cosmology::Cosmology;
    ///
    /// let planck = Cosmology::flat(0.31, 0.049, 0.677, 0.967);
    /// assert_eq!(planck.omega_de, 0.69);
    /// ```
    #[must_use]
    pub const fn flat(omega_m: f64, omega_b: f64, h: f64, n_s: f64) -> Self {
        Self {
            omega_m,
            omega_de: 1.0 - omega_m,
            omega_r: 0.0,
            omega_b,
            h,
            n_s,
            w0: -1.0,
            wa: 0.0,
            t_cmb: 2.7255,
        }
    }

    /// The GOLIAT simulations (Avila & Adame 2022, arXiv:2204.11103): Om = 0.27, Ode = 0.73, h = 0.7, n_s = 0.96; sigma8 is 0.8.
    /// Their Ob = 0.044 is that of the spectrum in `examples/data`.
    ///
    /// ```
    /// use fixpair::cosmology::Cosmology;
    ///
    /// assert_eq!(Cosmology::goliat().omega_m, 0.27);
    /// ```
    #[must_use]
    pub const fn goliat() -> Self {
        Self { omega_de: 0.73, ..Self::flat(0.27, 0.044, 0.7, 0.96) }
    }

    /// Curvature today, Ok = 1 - Om - Ode - Or: positive where the universe is open.
    ///
    /// ```
    /// use fixpair::cosmology::Cosmology;
    ///
    /// let open = Cosmology { omega_de: 0.0, ..Cosmology::goliat() };
    /// assert!((open.curvature() - 0.73).abs() < 1e-15);
    /// ```
    #[must_use]
    pub fn curvature(&self) -> f64 {
        1.0 - self.omega_m - self.omega_de - self.omega_r
    }

    /// The same universe with its radiation counted as dark energy, so that curvature stays.
    ///
    /// ```
    /// use fixpair::cosmology::Cosmology;
    ///
    /// let hot = Cosmology { omega_r: 8e-5, ..Cosmology::goliat() };
    /// let cold = hot.without_radiation();
    /// assert!(cold.omega_r == 0.0 && (cold.curvature() - hot.curvature()).abs() < 1e-15);
    /// ```
    #[must_use]
    pub fn without_radiation(&self) -> Self {
        Self { omega_de: self.omega_de + self.omega_r, omega_r: 0.0, ..*self }
    }

    /// Is this a universe that grew out of matter or radiation?
    ///
    /// # Errors
    /// `NotFinite` if a number is NaN or infinite. `Range` unless 0 < Om <= 100, 0 <= Or <= 1, |Ode| <= 100, 0 <= Ob <= Om,
    /// 0.01 <= h <= 100, |n_s| <= 10, |w0| and |wa| <= 10, 0 < t_cmb <= 100; or if E^2, anywhere in 1e-10 <= a <= 1, is less than 3% of the sum of its terms' sizes (expansion stops or nearly so); or
    /// if dark energy and curvature are more than 1% of E^2 at a = 1e-6. (w0 + wa < -0.3 and Om of order 1 are safe.)
    /// Cost: 15 microseconds.
    ///
    /// # Example
    /// ```
    /// use fixpair::cosmology::Cosmology;
    ///
    /// assert!(Cosmology { omega_m: f64::NAN, ..Cosmology::goliat() }.check().is_err());
    /// ```
    pub fn check(&self) -> Result<()> {
        let all = [
            self.omega_m,
            self.omega_de,
            self.omega_r,
            self.omega_b,
            self.h,
            self.n_s,
            self.w0,
            self.wa,
            self.t_cmb,
        ];
        if all.iter().any(|x| !x.is_finite()) {
            return Err(Error::NotFinite);
        }
        let sensible = self.omega_m > 0.0
            && self.omega_m <= 100.0
            && (0.0..=1.0).contains(&self.omega_r)
            && libm::fabs(self.omega_de) <= 100.0
            && (0.0..=self.omega_m).contains(&self.omega_b)
            && (0.01..=100.0).contains(&self.h)
            && libm::fabs(self.n_s) <= 10.0
            && libm::fabs(self.w0) <= 10.0
            && libm::fabs(self.wa) <= 10.0
            && self.t_cmb > 0.0
            && self.t_cmb <= 100.0;
        if !sensible {
            return Err(Error::Range);
        }
        self.check_expands(EARLIEST, 1.0)?;
        let early = 1e-6;
        let [radiation, matter, curvature, dark] = self.densities(early);
        if libm::fabs(curvature + dark) > 0.01 * (radiation + matter) {
            return Err(Error::Range);
        }
        Ok(())
    }

    /// `Range` if expansion stops or nearly stops between `from` and `to`.
    pub(crate) fn check_expands(&self, from: f64, to: f64) -> Result<()> {
        let (mut x, end) = (libm::log(from), libm::log(to));
        loop {
            let densities = self.densities(libm::exp(x));
            let e2: f64 = densities.iter().sum();
            let sizes: f64 = densities.into_iter().map(libm::fabs).sum();
            if !(sizes.is_finite() && e2 > STANDSTILL * sizes) {
                return Err(Error::Range);
            }
            if x >= end {
                return Ok(());
            }
            x = (x + CHECK_STEP).min(end);
        }
    }

    /// E(a) = H(a)/H0.
    ///
    /// # Errors
    /// As [`Cosmology::check`]; `NotFinite` if a is; `Range` if a is not in 1e-10 ..= 10 or the universe does not expand from 1 to a.
    ///
    /// # Example
    /// ```
    /// use fixpair::cosmology::Cosmology;
    ///
    /// assert!((Cosmology::goliat().expansion(0.5)? - (0.27_f64 * 8.0 + 0.73).sqrt()).abs() < 1e-14);
    /// # Ok::<(), fixpair::status::Error>(())
    /// ```
    pub fn expansion(&self, a: f64) -> Result<f64> {
        self.check_at(a)?;
        Ok(libm::sqrt(self.e_squared(a)))
    }

    /// dlnE/dlna.
    ///
    /// # Errors
    /// As [`Cosmology::expansion`].
    ///
    /// # Example
    /// ```
    /// use fixpair::cosmology::Cosmology;
    ///
    /// let slope = Cosmology::flat(1.0, 0.05, 0.7, 1.0).expansion_slope(0.5)?; // dlnE/dlna of matter alone
    /// assert!((slope + 1.5).abs() < 1e-14);
    /// # Ok::<(), fixpair::status::Error>(())
    /// ```
    pub fn expansion_slope(&self, a: f64) -> Result<f64> {
        self.check_at(a)?;
        Ok(self.slope_and_matter(a).0)
    }

    /// Om(a) = Om a^-3/E^2(a), matter's part of the critical density at a.
    ///
    /// # Errors
    /// As [`Cosmology::expansion`].
    ///
    /// # Example
    /// ```
    /// use fixpair::cosmology::Cosmology;
    ///
    /// let at_z_1 = Cosmology::goliat().matter_fraction(0.5)?; // Omega_m(a) = Omega_m a^-3/E^2
    /// assert!((at_z_1 - 2.16 / 2.89).abs() < 1e-14);
    /// # Ok::<(), fixpair::status::Error>(())
    /// ```
    pub fn matter_fraction(&self, a: f64) -> Result<f64> {
        self.check_at(a)?;
        Ok(self.slope_and_matter(a).1)
    }

    pub(crate) fn check_at(&self, a: f64) -> Result<()> {
        self.check()?;
        if !a.is_finite() {
            return Err(Error::NotFinite);
        }
        if !(EARLIEST..=LATEST).contains(&a) {
            return Err(Error::Range);
        }
        if a > 1.0 { self.check_expands(1.0, a) } else { Ok(()) }
    }

    /// E^2(a) by contents: radiation, matter, curvature, dark energy.
    #[inline]
    fn densities(&self, a: f64) -> [f64; 4] {
        let power = -3.0 * (1.0 + self.w0 + self.wa);
        let mut dark = self.omega_de;
        if power != 0.0 {
            dark *= libm::pow(a, power);
        }
        if self.wa != 0.0 {
            dark *= libm::exp(-3.0 * self.wa * (1.0 - a));
        }
        let a2 = a * a;
        [self.omega_r / (a2 * a2), self.omega_m / (a2 * a), self.curvature() / a2, dark]
    }

    /// E^2(a), of a checked cosmology.
    #[inline]
    pub(crate) fn e_squared(&self, a: f64) -> f64 {
        let [radiation, matter, curvature, dark] = self.densities(a);
        radiation + matter + curvature + dark
    }

    /// (dlnE/dlna, Om(a)), of a checked cosmology.
    #[inline]
    pub(crate) fn slope_and_matter(&self, a: f64) -> (f64, f64) {
        let [radiation, matter, curvature, dark] = self.densities(a);
        let e2 = radiation + matter + curvature + dark;
        let w = self.w0 + self.wa * (1.0 - a);
        let slope = -0.5 * (4.0 * radiation + 3.0 * matter + 2.0 * curvature + 3.0 * (1.0 + w) * dark) / e2;
        (slope, matter / e2)
    }
}

/// Or of photons at `t_cmb` (K) and `n_eff` massless neutrinos: (1 + (7/8) (4/11)^(4/3) N_eff) (4 sigma_SB/c^3) T^4/rho_crit.
///
/// # Errors
/// `NotFinite`; `Range` unless `t_cmb` and `h` are positive and `n_eff` is not negative, and for a density that no number holds.
///
/// # Example
/// ```
/// use fixpair::cosmology::radiation_density;
///
/// assert!((radiation_density(2.7255, 3.046, 0.7)? - 8.54e-5).abs() < 1e-7);
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn radiation_density(t_cmb: f64, n_eff: f64, h: f64) -> Result<f64> {
    if !(t_cmb.is_finite() && n_eff.is_finite() && h.is_finite()) {
        return Err(Error::NotFinite);
    }
    if t_cmb <= 0.0 || n_eff < 0.0 || h <= 0.0 {
        return Err(Error::Range);
    }
    const STEFAN_BOLTZMANN: f64 = 5.670_374_419e-8; // W m^-2 K^-4, CODATA 2018
    const LIGHT: f64 = 299_792_458.0; // m/s
    const GRAVITY: f64 = 6.674_30e-11; // m^3 kg^-1 s^-2, CODATA 2018
    const MEGAPARSEC: f64 = 3.085_677_581_491_367e22; // m
    let hubble = 1e5 * h / MEGAPARSEC;
    let critical = 3.0 * hubble * hubble / (8.0 * core::f64::consts::PI * GRAVITY);
    let photons = 4.0 * STEFAN_BOLTZMANN / (LIGHT * LIGHT * LIGHT) * libm::pow(t_cmb, 4.0);
    let neutrinos = 0.875 * libm::pow(4.0 / 11.0, 4.0 / 3.0) * n_eff;
    let density = (1.0 + neutrinos) * photons / critical;
    // Of squares that under- or overflow it would be 0 or infinite.
    if density > 0.0 && density.is_finite() { Ok(density) } else { Err(Error::Range) }
}
