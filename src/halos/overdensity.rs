//! How dense a halo is by definition, and how heavy its particles.
//!
//! M = (4 pi/3) R^3 Delta rho_m, rho_m the mean density of matter. Delta = 200 (200b); 200/Om(a) (200c); Delta_c/Om(a) (virial) with
//!
//! ```text
//! Delta_c = 18 pi^2 + 82 x - 39 x^2   flat, with dark energy,       x = Om(a) - 1
//! Delta_c = 18 pi^2 + 60 x - 32 x^2   without dark energy, open
//! ```
//!
//! (Bryan & Norman 1998, astro-ph/9710107, Eq. 6), good to 1% for Om(a) from 0.1 to 1 with a cosmological constant.

use core::f64::consts::PI;

use crate::cosmology::Cosmology;
use crate::status::{Error, Result};

/// A halo's mean density, against which mean.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Overdensity {
    /// So many times the mean density of matter: 200 for 200b.
    Mean(f64),
    /// So many times the critical density at a: 200 for 200c.
    Critical(f64),
    /// Bryan & Norman 1998.
    Virial,
}

/// What counts as flat for the virial overdensity.
const FLAT: f64 = 1e-3;

impl Overdensity {
    /// Delta, the density over the mean density of matter at the scale factor a.
    ///
    /// # Errors
    /// As [`Cosmology::expansion`]; `NotFinite`; `Range` for a density that is not positive, and for the virial one in a universe with both
    /// dark energy and |1 - Om - Ode - Or| > 1e-3.
    ///
    /// # Example
    /// ```
    /// use fixpair::cosmology::Cosmology;
    /// use fixpair::halos::Overdensity;
    ///
    /// let in_means = Overdensity::Critical(200.0).over_mean(&Cosmology::goliat(), 1.0)?;
    /// assert!((in_means - 200.0 / 0.27).abs() < 1e-9);
    /// # Ok::<(), fixpair::status::Error>(())
    /// ```
    pub fn over_mean(self, cosmology: &Cosmology, a: f64) -> Result<f64> {
        let matter = cosmology.matter_fraction(a)?;
        let delta = match self {
            Self::Mean(delta) => delta,
            Self::Critical(delta) => delta / matter,
            Self::Virial => virial(cosmology, matter)? / matter,
        };
        if !delta.is_finite() {
            return Err(Error::NotFinite);
        }
        if delta > 0.0 { Ok(delta) } else { Err(Error::Range) }
    }
}

/// Delta_c of a virialised halo.
fn virial(cosmology: &Cosmology, matter: f64) -> Result<f64> {
    let x = matter - 1.0;
    let curvature = 1.0 - cosmology.omega_m - cosmology.omega_de - cosmology.omega_r;
    if libm::fabs(curvature) <= FLAT {
        Ok(18.0 * PI * PI + 82.0 * x - 39.0 * x * x)
    } else if cosmology.omega_de == 0.0 {
        Ok(18.0 * PI * PI + 60.0 * x - 32.0 * x * x)
    } else {
        Err(Error::Range)
    }
}

/// Critical density of today in h^2 Msun/Mpc^3: 3 H0^2/(8 pi G) with H0 = 100 km/s/Mpc and G Msun = 1.3271244e20 m^3/s^2 (IAU 2015, resolution B3),
/// which is known far better than G: 2.77536627e11.
pub const CRITICAL_DENSITY: f64 = {
    const MEGAPARSEC: f64 = 3.085_677_581_491_367e22; // m
    const SUN: f64 = 1.327_124_4e20; // m^3/s^2
    3.0 * 1e10 * MEGAPARSEC / (8.0 * PI * SUN)
};

/// Mass of a particle in Msun/h: Om rho_crit L^3/N, L in Mpc/h, N the particles of the whole box.
///
/// # Errors
/// `NotFinite`; `Range` unless Om and L are positive and there are particles.
///
/// # Example
/// ```
/// use fixpair::halos::particle_mass;
///
/// assert!((particle_mass(0.27, 1000.0, 512 * 512 * 512)? / 5.583e11 - 1.0).abs() < 1e-3); // Msun/h
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn particle_mass(omega_m: f64, box_size: f64, particles_total: u64) -> Result<f64> {
    if !(omega_m.is_finite() && box_size.is_finite()) {
        return Err(Error::NotFinite);
    }
    if !(omega_m > 0.0 && box_size > 0.0 && particles_total > 0) {
        return Err(Error::Range);
    }
    let mass = CRITICAL_DENSITY * omega_m * (box_size * box_size * box_size) / particles_total as f64;
    if mass.is_finite() { Ok(mass) } else { Err(Error::Range) }
}
