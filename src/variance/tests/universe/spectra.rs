//! Claims about the spectra themselves: what was drawn is what the statistics of ensembles find, and fits of it are tab:fits again.

use std::vec;
use std::vec::Vec;

use super::draws::Scatter;
use super::sky::{F_NL, KINDS, Kind, LARGEST, NOISE, Sky};
use super::{COUNT, LIMIT};
use crate::variance::ensemble::{
    Moments, ensemble_add, ensemble_correlation, ensemble_deviation, ensemble_init, ensemble_length,
    ensemble_mean, ensemble_merge,
};
use crate::variance::pairs::{relative_error_of_deviation, sigma_per_simulation};
use crate::variance::suppression::{Scatter as Measured, fit_suppression};

/// The state of all realisations of a kind, in which spectra of both universes are one sample; streamed by two processes and merged.
fn stream(sky: &Sky, kind: Kind, moments: Moments) -> Vec<f64> {
    let scatter = Scatter::new(sky);
    let values = 2 * sky.k.len();
    let [mut state, other] = [0..COUNT / 2, COUNT / 2..COUNT].map(|realisations| {
        let mut state = vec![0.0; ensemble_length(values, moments).unwrap()];
        ensemble_init(&mut state, values, moments).unwrap();
        for realisation in realisations {
            let mock = scatter.draw(realisation, 1.0);
            let sample = [mock.estimate(kind, 0), mock.estimate(kind, 1)].concat();
            ensemble_add(&mut state, &sample).unwrap();
        }
        state
    });
    ensemble_merge(&mut state, &other).unwrap();
    state
}

#[test]
fn ensembles_have_the_mean_scatter_and_correlation_that_were_drawn() {
    let sky = Sky::paper();
    let (bins, values) = (sky.k.len(), 2 * sky.k.len());
    let count = f64::from(COUNT);
    let relative = relative_error_of_deviation(COUNT.into()).unwrap();
    for kind in KINDS {
        let state = stream(&sky, kind, Moments::Covariance);
        let (mut mean, mut deviation) = (vec![0.0; values], vec![0.0; values]);
        let mut correlation = vec![0.0; values * values];
        ensemble_mean(&mut mean, &state).unwrap();
        ensemble_deviation(&mut deviation, &state).unwrap();
        ensemble_correlation(&mut correlation, &state, 0..values, 0..values).unwrap();
        let sigma = [sky.sigma(kind, 0), sky.sigma(kind, 1)].concat();
        let power = sky.power.concat();
        for i in 0..values {
            // 78 values: one of them reaches 4 errors in 200 universes.
            assert!((mean[i] - power[i]).abs() < 4.0 * sigma[i] / count.sqrt(), "{kind:?} {i}");
            assert!((deviation[i] / sigma[i] - 1.0).abs() < 4.0 * relative, "{kind:?} {i}");
            for j in 0..i {
                let rho = if j + bins == i { kind.rho() } else { 0.0 };
                let found = correlation[i * values + j];
                let pull = (found.atanh() - rho.atanh()) * (count - 3.0).sqrt();
                // 975 of them.
                assert!(pull.abs() < 4.5, "{kind:?} {i} {j}: {found} for {rho}");
            }
        }
    }
}

#[test]
fn the_fit_of_the_measured_scatter_is_tab_fits_within_its_errors() {
    // The paper's fits go to 0.4 h/Mpc.
    let sky = Sky::new(0.4, 1.0, F_NL);
    let bins = sky.k.len();
    assert!(sky.k[bins - 1] > 4.0 * LARGEST);
    for kind in [Kind::Fixed, Kind::Paired] {
        let state = stream(&sky, kind, Moments::Variance);
        let mut deviation = vec![0.0; 2 * bins];
        ensemble_deviation(&mut deviation, &state).unwrap();
        for (universe, deviation) in deviation.chunks(bins).enumerate() {
            let (mut sigma, mut error) = (vec![0.0; bins], vec![0.0; bins]);
            sigma_per_simulation(&mut sigma, &mut error, deviation, COUNT.into(), kind.simulations())
                .unwrap();
            let measured = Measured {
                sigma: &sigma,
                k: &sky.k,
                power: &sky.power[universe],
                modes: &sky.modes,
                noise: NOISE,
            };
            let fit = fit_suppression(&measured, COUNT.into()).unwrap();
            let truth = kind.suppression(universe);
            for (value, error, truth) in [
                (fit.value.cosmic_variance, fit.error.cosmic_variance, truth.cosmic_variance),
                (fit.value.softening, fit.error.softening, truth.softening),
                (fit.value.shot_noise, fit.error.shot_noise, truth.shot_noise),
            ] {
                assert!(
                    (value - truth).abs() < LIMIT * error,
                    "{kind:?} {universe}: {value} +- {error} for {truth}"
                );
                assert!(error < 0.1 * truth);
            }
            let degrees = fit.degrees as f64;
            assert!(
                (fit.chi_squared - degrees).abs() < LIMIT * (2.0 * degrees).sqrt(),
                "{}",
                fit.chi_squared
            );
        }
    }
}
