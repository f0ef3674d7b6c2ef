//! How many halos there are: dn/dlnM = f(sigma) (rho_m/M) dln(1/sigma)/dlnM.
//!
//! sigma(M) is the r.m.s. of the linear density in spheres that hold M on average. Both f are fits to simulations:
//!
//! - Watson et al. 2013 (arXiv:1212.0095, eq. 12): friends of friends with b = 0.2, at all redshifts;
//! - Tinker et al. 2008 (arXiv:0803.2706, eq. 3 and 5-8, table 2): spheres of 200 times the mean density.

use std::f64::consts::PI;

use fixpair::cosmology::{Cosmology, Linear};
use fixpair::halos::overdensity::CRITICAL_DENSITY;

use crate::Failure;

/// Which halos.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Fit {
    /// Friends of friends.
    Watson,
    /// Spheres.
    Tinker,
}

impl Fit {
    /// f(sigma) at redshift z.
    fn multiplicity(self, sigma: f64, z: f64) -> f64 {
        let form = |a: f64, alpha: f64, beta: f64, gamma: f64| {
            a * ((beta / sigma).powf(alpha) + 1.0) * (-gamma / (sigma * sigma)).exp()
        };
        match self {
            Self::Watson => form(0.282, 2.163, 1.406, 1.210),
            Self::Tinker => {
                let evolution = 10_f64.powf(-(0.75 / (200.0_f64 / 75.0).log10()).powf(1.2));
                let past = 1.0 + z;
                form(0.186 * past.powf(-0.14), 1.47 * past.powf(-0.06), 2.57 * past.powf(-evolution), 1.19)
            }
        }
    }
}

/// sigma(M) on a grid of ln M.
pub(crate) struct MassFunction {
    first: f64,
    sigma: Vec<f64>,
    density: f64,
}

/// Step in ln M: sigma is nearly a power law, and its slope is a difference over two steps.
const STEP: f64 = 0.1;

impl MassFunction {
    /// For masses from `least` to `most`, Msun/h.
    ///
    /// # Errors
    /// If sigma cannot be integrated.
    pub(crate) fn new(linear: &Linear<'_>, least: f64, most: f64) -> Result<Self, Failure> {
        let density = CRITICAL_DENSITY * Cosmology::goliat().omega_m;
        let first = least.ln() - 2.0 * STEP;
        let steps = ((most / least).ln() / STEP).ceil() as usize + 5;
        let sigma = (0..steps).map(|i| {
            let mass = (first + STEP * i as f64).exp();
            linear.sigma((3.0 * mass / (4.0 * PI * density)).cbrt())
        });
        Ok(Self { first, sigma: sigma.collect::<Result<_, _>>()?, density })
    }

    /// dn/dlnM at a node of the grid, (h/Mpc)^3.
    fn at_node(&self, node: usize, fit: Fit, z: f64, growth: f64) -> f64 {
        let slope = (self.sigma[node - 1] / self.sigma[node + 1]).ln() / (2.0 * STEP);
        let mass = (self.first + STEP * node as f64).exp();
        fit.multiplicity(self.sigma[node] * growth, z) * self.density / mass * slope
    }

    /// dn/dlnM at mass M, (h/Mpc)^3: geometric between nodes. `growth` is D(z).
    pub(crate) fn at(&self, mass: f64, fit: Fit, z: f64, growth: f64) -> f64 {
        let place = (mass.ln() - self.first) / STEP;
        let node = (place as usize).clamp(1, self.sigma.len() - 3);
        let [low, high] = [node, node + 1].map(|node| self.at_node(node, fit, z, growth).ln());
        (low + (high - low) * (place - node as f64)).exp()
    }

    /// Halos of masses `low` to `high` in a unit of volume, (h/Mpc)^3: Simpson's rule.
    pub(crate) fn between(&self, low: f64, high: f64, fit: Fit, z: f64, growth: f64) -> f64 {
        const INTERVALS: usize = 8;
        let width = (high / low).ln() / INTERVALS as f64;
        let sum: f64 = (0..=INTERVALS)
            .map(|i| {
                let weight = match i {
                    0 | INTERVALS => 1.0,
                    i if i % 2 == 1 => 4.0,
                    _ => 2.0,
                };
                weight * self.at(low * (width * i as f64).exp(), fit, z, growth)
            })
            .sum();
        sum * width / 3.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::theory::Theory;

    /// dn/dlnM of colossus 1.4.0 (Diemer 2018, arXiv:1712.04512) from the same linear table, at 1e12, 1e13, 1e14, 1e15 Msun/h.
    const COLOSSUS: [(Fit, f64, [f64; 4]); 4] = [
        (Fit::Tinker, 0.0, [3.631012e-03, 4.518185e-04, 3.765698e-05, 4.738135e-07]),
        (Fit::Watson, 0.0, [3.279386e-03, 3.959577e-04, 3.573279e-05, 5.609472e-07]),
        (Fit::Tinker, 1.0, [3.136564e-03, 2.465628e-04, 5.243056e-06, 5.960072e-10]),
        (Fit::Watson, 1.0, [3.178254e-03, 2.773817e-04, 7.264216e-06, 1.064201e-09]),
    ];

    #[test]
    fn mass_functions_are_those_of_colossus() {
        let theory = Theory::new().unwrap();
        let linear = theory.linear().unwrap();
        let function = MassFunction::new(&linear, 1e12, 1e15).unwrap();
        for (fit, z, wanted) in COLOSSUS {
            let growth = theory.growth()[usize::from(z == 0.0)];
            for (mass, wanted) in [1e12, 1e13, 1e14, 1e15].into_iter().zip(wanted) {
                let ratio = function.at(mass, fit, z, growth) / wanted;
                // Colossus interpolates sigma; its growth has 2e-5 more at z = 1, where the last value goes as D^30.
                assert!((ratio - 1.0).abs() < 5e-3, "{fit:?}, z = {z}, {mass:e}: {ratio}");
            }
        }
    }

    #[test]
    fn bins_add_up_to_the_sum() {
        let theory = Theory::new().unwrap();
        let function = MassFunction::new(&theory.linear().unwrap(), 1e12, 1e14).unwrap();
        let between = |low, high| function.between(low, high, Fit::Watson, 0.0, 1.0);
        let (whole, parts) = (between(1e13, 2e13), between(1e13, 1.3e13) + between(1.3e13, 2e13));
        // Geometric interpolation has kinks that Simpson's rule does not see.
        assert!((whole / parts - 1.0).abs() < 1e-4, "{whole} {parts}");
    }
}
