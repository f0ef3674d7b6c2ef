//! From spectra of halos to posteriors of b_g, p and f_NL: the paper's fits (Eq. chi2, likelihood).
//!
//! P_lin is linear theory of matter at z = 1, averaged over the modes of each bin.

use fixpair::status::{Error, Result};
use fixpair::variance::bias::{self, Bias, Spectrum};
use fixpair::variance::contours::contours;
use fixpair::variance::fit::{FREE_B_G, FREE_F_NL, FREE_P};
use fixpair::variance::likelihood::{BiasLikelihood, Spectra};
use fixpair::variance::posterior::{
    Constraints, Grid, Posterior, bias_grid, bias_posterior, bias_posterior_scratch, marginal,
};

use crate::measurement::Bins;
use crate::memory::Memory;

/// Probability of the region that is quoted, centre and half its width.
const REGION: f64 = 0.68;
/// Values of each parameter on the grid of a posterior, and on that of a contour, which is narrow and aslant.
const POINTS: usize = 128;
const FINE: usize = 320;

/// What is free.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Case {
    /// (i) b_g; p = 1 and the true f_NL.
    Bias,
    /// (ii) b_g and p; the true f_NL.
    Universality,
    /// (iii) b_g and f_NL; p = 1.
    Fnl,
}

impl Case {
    pub(crate) const ALL: [Self; 3] = [Self::Bias, Self::Universality, Self::Fnl];

    pub(crate) const fn name(self) -> &'static str {
        match self {
            Self::Bias => "b_g",
            Self::Universality => "b_g and p",
            Self::Fnl => "b_g and f_NL",
        }
    }

    const fn free(self) -> u32 {
        match self {
            Self::Bias => FREE_B_G,
            Self::Universality => FREE_B_G | FREE_P,
            Self::Fnl => FREE_B_G | FREE_F_NL,
        }
    }

    /// Names of the free parameters.
    pub(crate) const fn parameters(self) -> &'static [&'static str] {
        match self {
            Self::Bias => &["b_g"],
            Self::Universality => &["b_g", "p"],
            Self::Fnl => &["b_g", "f_NL"],
        }
    }
}

/// The likelihood of a spectrum of halos in as many bins from the first as `sigma` has values.
pub(crate) fn likelihood(bins: &Bins, power: &[f64], sigma: &[f64]) -> Result<BiasLikelihood> {
    let count = sigma.len();
    let mut likelihood = BiasLikelihood::EMPTY;
    let spectra = Spectra {
        power: &power[..count],
        linear: &bins.late_theory[..count],
        alpha: &bins.late_alpha[..count],
    };
    likelihood.add(Spectrum::HaloHalo, spectra, sigma)?;
    Ok(likelihood)
}

/// A posterior that is closed: it vanishes all around.
#[derive(Clone, Debug)]
pub(crate) struct Fit {
    case: Case,
    likelihood: BiasLikelihood,
    pub(crate) constraints: Constraints,
}

/// A density on a uniform grid.
pub(crate) struct Density {
    pub(crate) x: Vec<f64>,
    pub(crate) density: Vec<f64>,
}

impl Fit {
    /// `fnl`: the truth, for the cases in which it is known.
    ///
    /// None where the data leave a parameter open.
    ///
    /// # Errors
    /// Of the kernels, other than those that say so.
    pub(crate) fn new(likelihood: BiasLikelihood, case: Case, fnl: f64) -> Result<Option<Self>> {
        let start = Bias { b_g: 2.0, f_nl: if case == Case::Fnl { 0.0 } else { fnl }, ..Bias::default() };
        let mut scratch = Memory::new(bias_posterior_scratch(POINTS)?);
        match bias_posterior(&likelihood, &start, case.free(), POINTS, REGION, scratch.bytes()) {
            Ok(constraints) => Ok(Some(Self { case, likelihood, constraints })),
            Err(Error::Convergence | Error::Singular) => Ok(None),
            Err(error) => Err(error),
        }
    }

    /// Of b_g.
    pub(crate) fn b_g(&self) -> &Posterior {
        &self.constraints.posterior[0]
    }

    /// Of p or f_NL.
    pub(crate) fn second(&self) -> &Posterior {
        &self.constraints.posterior[1]
    }

    pub(crate) fn best(&self) -> &Bias {
        &self.constraints.fit.value
    }

    /// b(k) of the best parameters.
    ///
    /// # Errors
    /// Of the kernel.
    pub(crate) fn bias(&self, alpha: &[f64]) -> Result<Vec<f64>> {
        let mut curve = vec![0.0; alpha.len()];
        bias::bias_of_k(&mut curve, self.best(), alpha)?;
        Ok(curve)
    }

    fn grid(&self, points: usize) -> Result<(Grid, Vec<f64>)> {
        let Constraints { fit, grid, .. } = &self.constraints;
        let grid = Grid { points: grid.points.map(|of| if of > 1 { points } else { 1 }), ..*grid };
        let mut values = vec![0.0; grid.points[0] * grid.points[1]];
        bias_grid(&mut values, &self.likelihood, &fit.value, self.case.free(), &grid)?;
        Ok((grid, values))
    }

    /// The posterior of a free parameter: 0 is b_g, 1 the other.
    ///
    /// # Errors
    /// Of the kernels: `Range` for a parameter that is not free.
    pub(crate) fn density(&self, axis: usize) -> Result<Density> {
        let (grid, values) = self.grid(POINTS)?;
        let (points, range) = (grid.points[axis], grid.range[axis]);
        let mut density = vec![0.0; points];
        marginal(&mut density, &values, grid.points, axis, range)?;
        let step = (range[1] - range[0]) / (points.max(2) - 1) as f64;
        Ok(Density { x: (0..points).map(|i| range[0] + step * i as f64).collect(), density })
    }

    /// The contour of two free parameters at chi^2 so much above the least: segments (b_g, other, b_g, other).
    ///
    /// # Errors
    /// Of the kernels: `Range` where one is free.
    pub(crate) fn contour(&self, above: f64) -> Result<Vec<[f64; 4]>> {
        let (grid, values) = self.grid(FINE)?;
        let level = self.constraints.fit.chi_squared + above;
        let mut segments = vec![[0.0; 4]; contours(&mut [], &values, grid.points, grid.range, level)?];
        contours(&mut segments, &values, grid.points, grid.range, level)?;
        Ok(segments)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Six bins of a Gpc/h, more or less, with the spectrum of Eq. bk.
    fn data(truth: &Bias, error: f64) -> (Bins, Vec<f64>, Vec<f64>) {
        let bins = Bins {
            k: vec![0.01, 0.02, 0.03, 0.05, 0.07, 0.09],
            late_theory: vec![9e3, 1.1e4, 1e4, 7e3, 5e3, 4e3],
            late_alpha: vec![8e2, 2.2e3, 3.8e3, 6e3, 8e3, 1e4],
            ..Bins::default()
        };
        let mut power = vec![0.0; 6];
        bias::halo_power(&mut power, truth, Spectrum::HaloHalo, &bins.late_theory, &bins.late_alpha).unwrap();
        let sigma = power.iter().map(|power| error * power).collect();
        (bins, power, sigma)
    }

    #[test]
    fn the_three_cases_find_the_parameters_that_made_the_spectrum() {
        let truth = Bias { b_g: 2.3, p: 1.0, f_nl: 100.0, ..Bias::default() };
        let (bins, power, sigma) = data(&truth, 0.03);
        for case in Case::ALL {
            let fit = Fit::new(likelihood(&bins, &power, &sigma).unwrap(), case, 100.0).unwrap().unwrap();
            assert!(fit.constraints.fit.chi_squared < 1e-12);
            let Bias { b_g, p, f_nl, .. } = *fit.best();
            assert!((b_g - 2.3).abs() < 1e-6 && (p - 1.0).abs() < 1e-5 && (f_nl - 100.0).abs() < 1e-3);
            let density = fit.density(0).unwrap();
            assert_eq!(density.x.len(), density.density.len());
            assert_eq!(fit.density(1).is_ok(), case != Case::Bias);
        }
        let flat = Bias { f_nl: 0.0, ..truth };
        let (bins, power, sigma) = data(&flat, 0.03);
        let fit = Fit::new(likelihood(&bins, &power, &sigma).unwrap(), Case::Fnl, 0.0).unwrap().unwrap();
        assert!(fit.second().peak.abs() < 5.0 && fit.second().half_width > 5.0);
    }

    #[test]
    fn the_contour_at_one_is_as_wide_as_the_error() {
        let truth = Bias { b_g: 2.3, p: 1.0, f_nl: 100.0, ..Bias::default() };
        // Errors so small that the likelihood is Gaussian.
        let (bins, power, sigma) = data(&truth, 1e-3);
        let fit = Fit::new(likelihood(&bins, &power, &sigma).unwrap(), Case::Fnl, 0.0).unwrap().unwrap();
        let segments = fit.contour(1.0).unwrap();
        let widest = segments.iter().flat_map(|&[_, y, _, z]| [y, z]).fold(0.0, f64::max);
        let error = fit.constraints.fit.error[2];
        assert!(((widest - 100.0) / error - 1.0).abs() < 0.02, "{widest} {error}");
    }
}
