//! The error of a spectrum of halos: theory for Normal simulations, for all others a fit of Eq. sigma_fix to the measured scatter (the paper's
//! Table 1).

use fixpair::status::{Error, Result};
use fixpair::variance::ensemble::{
    Moments, ensemble_add, ensemble_deviation, ensemble_init, ensemble_length, ensemble_mean,
};
use fixpair::variance::models::{sigma_gaussian, sigma_suppressed};
use fixpair::variance::pairs::sigma_per_simulation;
use fixpair::variance::suppression::{self, SuppressionFit, fit_suppression};

use crate::late_statistics::Tracer;
use crate::statistics::{Kind, quadratic_mean, spectra};
use crate::suite::{Amplitude, Half, Suite};

/// The fit of Eq. sigma_fix takes k below this, h/Mpc, as the paper's.
pub(crate) const REACH: f64 = 0.4;

/// What stands for the scatter.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Model {
    /// Eq. sigma_th.
    Gaussian,
    /// Eq. sigma_fix.
    Suppressed(SuppressionFit),
    /// Eq. sigma_th times a number: what was measured over it where bias is fitted. For scatter that Eq. sigma_fix cannot be fitted to.
    Scaled { ratio: f64, why: Error },
}

/// The scatter of the spectrum of halos per simulation, bin by bin, (Mpc/h)^3.
pub(crate) struct Scatter {
    /// Mean of both phases without shot noise: what each simulation of these amplitudes is expected to have.
    pub(crate) power: Vec<f64>,
    /// From seed to seed.
    pub(crate) measured: Vec<f64>,
    pub(crate) model: Model,
    /// Of the model.
    pub(crate) sigma: Vec<f64>,
}

impl Scatter {
    /// `fitted`: bins from the first in which bias is fitted.
    ///
    /// # Errors
    /// Of the kernels: `Range` where nothing scatters.
    pub(crate) fn new(suite: &Suite, kind: Kind, half: Half, fitted: usize) -> Result<Self> {
        let bins = suite.bins();
        let noise = Tracer::Halos.noise(suite, half);
        let modes: Vec<f64> = bins.modes.iter().map(|&modes| modes as f64).collect();
        let mut theory = vec![0.0; modes.len()];
        sigma_gaussian(&mut theory, &mean_power(suite, Amplitude::Normal, half)?, &modes, noise)?;
        let power = mean_power(suite, kind.amplitude(), half)?;
        let measured = deviation(suite, kind, half)?;

        let reach = bins.k.partition_point(|&k| k < REACH);
        let scatter = suppression::Scatter {
            sigma: &measured[..reach],
            k: &bins.k[..reach],
            power: &power[..reach],
            modes: &modes[..reach],
            noise,
        };
        let suppressed = || {
            let fit = fit_suppression(&scatter, suite.seeds.len() as u64)?;
            let mut sigma = vec![0.0; modes.len()];
            sigma_suppressed(&mut sigma, &fit.value, &bins.k, &power, &modes, noise)?;
            Ok((Model::Suppressed(fit), sigma))
        };
        let (model, sigma) = match kind {
            Kind::Normal => (Model::Gaussian, theory.clone()),
            _ => suppressed().unwrap_or_else(|why| {
                let over: Vec<f64> =
                    measured.iter().zip(&theory).map(|(sigma, theory)| sigma / theory).collect();
                let ratio = quadratic_mean(&over[..fitted]);
                (Model::Scaled { ratio, why }, theory.iter().map(|theory| ratio * theory).collect())
            }),
        };
        Ok(Self { power, measured, model, sigma })
    }
}

/// Mean of both phases.
fn mean_power(suite: &Suite, amplitude: Amplitude, half: Half) -> Result<Vec<f64>> {
    let kind = match amplitude {
        Amplitude::Normal => Kind::NormalPaired,
        Amplitude::Fixed => Kind::FixedPaired,
    };
    let mut mean = vec![0.0; suite.bins().k.len()];
    ensemble_mean(&mut mean, &ensemble(suite, kind, half)?)?;
    Ok(mean)
}

/// From seed to seed, per simulation.
fn deviation(suite: &Suite, kind: Kind, half: Half) -> Result<Vec<f64>> {
    let mut deviation = vec![0.0; suite.bins().k.len()];
    ensemble_deviation(&mut deviation, &ensemble(suite, kind, half)?)?;
    let (mut sigma, mut error) = (deviation.clone(), deviation.clone());
    sigma_per_simulation(&mut sigma, &mut error, &deviation, suite.seeds.len() as u64, kind.simulations())?;
    Ok(sigma)
}

fn ensemble(suite: &Suite, kind: Kind, half: Half) -> Result<Vec<f64>> {
    let bins = suite.bins().k.len();
    let mut state = vec![0.0; ensemble_length(bins, Moments::Variance)?];
    ensemble_init(&mut state, bins, Moments::Variance)?;
    for spectrum in spectra(suite, kind, half, |one| &one.late.halos)? {
        ensemble_add(&mut state, &spectrum)?;
    }
    Ok(state)
}
