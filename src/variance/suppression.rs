//! The fit of R_cv, k_soft and f_sn to a measured scatter (Eq. sigma_fix, tab:fits).
//!
//! For a given k_soft the model is linear in R_cv and f_sn, so the search is in one dimension: all of k_soft on a logarithmic grid, then the
//! best place by golden sections. Nothing to start from, and no local minimum to end in.

use core::f64::consts::FRAC_2_PI;

use super::check::{finite, not_negative, positive, same_length};
use super::models::{Suppression, step};
use super::pairs::relative_error_of_deviation;
use super::small::Triangle;
use crate::math::sqrt;
use crate::status::{Error, Result};
use crate::within::Within;

/// Least-squares values with their errors.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct SuppressionFit {
    /// The best values.
    pub value: Suppression,
    /// Their standard errors.
    pub error: Suppression,
    /// Covariance of (R_cv, k_soft, f_sn), row by row.
    pub covariance: [f64; 9],
    /// Sum of ((sigma - sigma_r)/error)^2.
    pub chi_squared: f64,
    /// Bins less parameters.
    pub degrees: u64,
}

/// Measured scatter, and what the model is made of.
#[derive(Clone, Copy, Debug)]
pub struct Scatter<'a> {
    /// Scatter per simulation of each bin.
    pub sigma: &'a [f64],
    /// k of each bin, h/Mpc.
    pub k: &'a [f64],
    /// P without shot noise.
    pub power: &'a [f64],
    /// N_k, counting k and -k.
    pub modes: &'a [f64],
    /// 1/n; 0 where there is none, and then f_sn is 1 and has no error.
    pub noise: f64,
}

/// Places of k_soft, from a hundredth of the smallest k to a hundred times the largest.
const PLACES: usize = 160;
const MARGIN: f64 = 100.0;
/// Golden sections: 0.618^44 of a grid step.
const SECTIONS: usize = 44;
/// Rounds in which errors follow the model, until it moves by less in units of them.
const ROUNDS: usize = 100;
const SETTLED: f64 = 1e-6;
/// What k_soft does to the model must be more than its roundings.
const FLAT: f64 = 1e-11;

impl Scatter<'_> {
    fn check(&self) -> Result<()> {
        let Self { sigma, k, power, modes, noise } = *self;
        same_length(sigma.len(), &[k.len(), power.len(), modes.len()])?;
        positive(sigma)?;
        positive(k)?;
        positive(modes)?;
        finite(power)?;
        not_negative(&[noise])
    }

    fn unknowns(&self) -> usize {
        if self.noise > 0.0 { 3 } else { 2 }
    }

    /// sigma_r of bin i.
    fn model(&self, at: &Suppression, i: usize) -> f64 {
        let step = step(self.k.at(i), at.softening);
        let cosmic = at.cosmic_variance + (1.0 - at.cosmic_variance) * step;
        sqrt(2.0 / self.modes.at(i)) * (self.power.at(i) * cosmic + at.shot_noise * self.noise)
    }

    /// The best R_cv and f_sn, zero or more, for a given k_soft, and chi^2.
    fn linear(&self, softening: f64, error: &dyn Fn(usize) -> f64) -> Result<(Suppression, f64)> {
        let linear = self.unknowns() - 1;
        let mut triangle = Triangle::<3>::EMPTY;
        for i in 0..self.sigma.len() {
            let (step, root) = (step(self.k.at(i), softening), sqrt(2.0 / self.modes.at(i)));
            let power = root * self.power.at(i);
            let row = [power * (1.0 - step), root * self.noise, self.sigma.at(i) - power * step];
            triangle.push(row.map(|x| x / error(i)));
        }
        let [cosmic_variance, shot_noise, _] = triangle.solve(linear)?;
        let rest = triangle.0[2][2] * triangle.0[2][2];
        let (mut best, mut chi_squared) = ([cosmic_variance, shot_noise], rest);
        if cosmic_variance < 0.0 || shot_noise < 0.0 {
            // Convex: the least of the allowed quarter is on one of its edges.
            let edge = |axis: usize| {
                let rows = triangle.0.iter().take(axis + 1);
                let dot = |j: usize| rows.clone().map(|row| row.at(axis) * row.at(j)).sum::<f64>();
                let mut place = [0.0; 2];
                place.put(axis, (dot(2) / dot(axis)).max(0.0));
                let left = triangle.times(&[place[0], place[1], -1.0]);
                (place, left.iter().map(|x| x * x).sum::<f64>())
            };
            (best, chi_squared) = edge(0);
            if linear == 2 {
                let other = edge(1);
                if other.1 < chi_squared {
                    (best, chi_squared) = other;
                }
            }
        }
        let shot_noise = if linear == 2 { best[1] } else { 1.0 };
        Ok((Suppression { cosmic_variance: best[0], softening, shot_noise }, chi_squared))
    }

    /// Where k_soft is looked for: the first and last ln k_soft, and the step of the grid.
    fn places(&self) -> [f64; 3] {
        let [low, high] =
            self.k.iter().fold([f64::INFINITY, 0.0], |[low, high], &k| [k.min(low), k.max(high)]);
        let (first, last) = (libm::log(low / MARGIN), libm::log(high * MARGIN));
        [first, last, (last - first) / (PLACES - 1) as f64]
    }

    /// The best of all k_soft.
    fn search(&self, error: &dyn Fn(usize) -> f64) -> Result<Suppression> {
        let [first, _, step] = self.places();
        let place = |i: usize| first + step * i as f64;
        let mut best = (0, f64::INFINITY);
        for i in 0..PLACES {
            let x = self.chi_squared(place(i), error);
            if x < best.1 {
                best = (i, x);
            }
        }
        if best.0 == 0 || best.0 == PLACES - 1 {
            // No step in the data.
            return Err(Error::Singular);
        }
        self.between(place(best.0 - 1), place(best.0 + 1), error)
    }

    /// The best near an earlier one, or of all where that is not far enough.
    fn follow(&self, last: &Suppression, error: &dyn Fn(usize) -> f64) -> Result<Suppression> {
        let [_, _, step] = self.places();
        let centre = libm::log(last.softening);
        let found = self.between(centre - step, centre + step, error)?;
        let moved = (libm::log(found.softening) - centre).abs();
        if moved < 0.9 * step { Ok(found) } else { self.search(error) }
    }

    /// At the ends of the grid R_cv and f_sn may be degenerate to rounding: no minimum there.
    fn chi_squared(&self, place: f64, error: &dyn Fn(usize) -> f64) -> f64 {
        self.linear(libm::exp(place), error).map_or(f64::INFINITY, |(_, x)| x)
    }

    /// The minimum between two values of ln k_soft, by golden sections.
    fn between(&self, mut left: f64, mut right: f64, error: &dyn Fn(usize) -> f64) -> Result<Suppression> {
        const GOLDEN: f64 = 0.618_033_988_749_894_8;
        let chi_squared = |place: f64| self.chi_squared(place, error);
        let mut inner = [right - GOLDEN * (right - left), left + GOLDEN * (right - left)];
        let mut values = inner.map(chi_squared);
        for _ in 0..SECTIONS {
            if values[0] <= values[1] {
                right = inner[1];
                inner = [right - GOLDEN * (right - left), inner[0]];
                values = [chi_squared(inner[0]), values[0]];
            } else {
                left = inner[0];
                inner = [inner[1], left + GOLDEN * (right - left)];
                values = [values[1], chi_squared(inner[1])];
            }
        }
        Ok(self.linear(libm::exp(0.5 * (left + right)), error)?.0)
    }

    fn finish(&self, value: Suppression, error: &dyn Fn(usize) -> f64) -> Result<SuppressionFit> {
        let unknowns = self.unknowns();
        let mut triangle = Triangle::<4>::EMPTY;
        let (mut chi_squared, mut flat) = (0.0, true);
        for i in 0..self.sigma.len() {
            let (k, root) = (self.k.at(i), sqrt(2.0 / self.modes.at(i)));
            let (sigma, power) = (self.sigma.at(i), root * self.power.at(i));
            let Suppression { cosmic_variance, softening, .. } = value;
            let slope = -FRAC_2_PI * k / (softening * softening + k * k);
            let rest = sigma - self.model(&value, i);
            let row = [
                power * (1.0 - step(k, softening)),
                power * (1.0 - cosmic_variance) * slope,
                root * self.noise,
                rest,
            ];
            triangle.push(row.map(|x| x / error(i)));
            flat &= (softening * row[1]).abs() <= FLAT * sigma;
            chi_squared += (rest / error(i)) * (rest / error(i));
        }
        if flat {
            return Err(Error::Singular);
        }
        let inverse = triangle.covariance(unknowns)?;
        let covariance: [f64; 9] = core::array::from_fn(|at| inverse[at / 3][at % 3]);
        let [cosmic_variance, softening, shot_noise] = [0, 4, 8].map(|at| sqrt(covariance[at]));
        finite(&covariance).map_err(|_| Error::Range)?;
        finite(&[chi_squared]).map_err(|_| Error::Range)?;
        Ok(SuppressionFit {
            value,
            error: Suppression { cosmic_variance, softening, shot_noise },
            covariance,
            chi_squared,
            degrees: (self.sigma.len() - unknowns) as u64,
        })
    }
}

/// Fits sigma_r to a scatter with the given errors, one a bin.
///
/// Errors in proportion to the measured scatter, which Eq. errerr has, favour bins that happen to scatter little: sigma_r then comes out low by
/// about 1/N. [`fit_suppression`] does not.
///
/// R_cv and f_sn are kept at zero or more, without which sigma_r is none; their errors are those of the curvature there too.
///
/// # Errors
/// `Length` for arrays of different lengths, `Samples` for fewer bins than parameters, `NotFinite`, `Range` for k, modes, sigma or errors that are not
/// positive, `Singular` where the data have no step.
///
/// # Example
/// ```
/// use fixpair::variance::models::{Suppression, sigma_suppressed};
/// use fixpair::variance::suppression::{Scatter, fit_suppression_weighted};
///
/// let left = Suppression { cosmic_variance: 0.3, softening: 0.1, shot_noise: 0.8 };
/// let k: Vec<f64> = (1..64).map(|b| 0.00628 * f64::from(b)).collect();
/// let (power, modes) = (k.iter().map(|k| 500.0 / k).collect::<Vec<_>>(), k.iter().map(|k| 1e6 * k * k).collect::<Vec<_>>());
/// let mut sigma = vec![0.0; k.len()];
/// sigma_suppressed(&mut sigma, &left, &k, &power, &modes, 4000.0)?;
/// let error: Vec<f64> = sigma.iter().map(|sigma| 0.1 * sigma).collect();
/// let scatter = Scatter { sigma: &sigma, k: &k, power: &power, modes: &modes, noise: 4000.0 };
/// let fit = fit_suppression_weighted(&scatter, &error)?;
/// assert!((fit.value.softening - 0.1).abs() < 1e-3);
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn fit_suppression_weighted(scatter: &Scatter<'_>, error: &[f64]) -> Result<SuppressionFit> {
    scatter.check()?;
    same_length(scatter.sigma.len(), &[error.len()])?;
    positive(error)?;
    if error.len() < scatter.unknowns() {
        return Err(Error::Samples);
    }
    let error = |i: usize| error.at(i);
    scatter.finish(scatter.search(&error)?, &error)
}

/// Fits sigma_r to the scatter of so many independent estimates, with errors sigma_r/sqrt(2 (N - 1)) (Eq. errerr) of the model itself,
/// found by iteration. R_cv and f_sn are zero or more.
///
/// # Errors
/// As [`fit_suppression_weighted`]; `Samples` for fewer than two estimates; `Convergence` if the errors do not settle.
///
/// # Example
/// ```
/// use fixpair::variance::models::{Suppression, sigma_suppressed};
/// use fixpair::variance::suppression::{Scatter, fit_suppression};
///
/// let left = Suppression { cosmic_variance: 0.3, softening: 0.1, shot_noise: 0.8 };
/// let k: Vec<f64> = (1..64).map(|b| 0.00628 * f64::from(b)).collect();
/// let (power, modes) = (k.iter().map(|k| 500.0 / k).collect::<Vec<_>>(), k.iter().map(|k| 1e6 * k * k).collect::<Vec<_>>());
/// let mut sigma = vec![0.0; k.len()];
/// sigma_suppressed(&mut sigma, &left, &k, &power, &modes, 4000.0)?;
/// let scatter = Scatter { sigma: &sigma, k: &k, power: &power, modes: &modes, noise: 4000.0 };
/// let fit = fit_suppression(&scatter, 41)?;
/// assert!((fit.value.cosmic_variance - 0.3).abs() < 1e-3);
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn fit_suppression(scatter: &Scatter<'_>, estimates: u64) -> Result<SuppressionFit> {
    scatter.check()?;
    let relative = relative_error_of_deviation(estimates)?;
    if scatter.sigma.len() < scatter.unknowns() {
        return Err(Error::Samples);
    }
    let mut value = scatter.search(&|i| relative * scatter.sigma.at(i))?;
    for _ in 0..ROUNDS {
        let last = value;
        // A model that is negative somewhere on the way has an error all the same.
        let error = |i: usize| relative * scatter.model(&last, i).abs().max(1e-3 * scatter.sigma.at(i));
        value = scatter.follow(&last, &error)?;
        let settled = |i: usize| {
            let [new, old] = [&value, &last].map(|at| scatter.model(at, i));
            (new - old).abs() <= SETTLED * error(i)
        };
        if (0..scatter.sigma.len()).all(settled) {
            return scatter.finish(value, &error);
        }
    }
    Err(Error::Convergence)
}
