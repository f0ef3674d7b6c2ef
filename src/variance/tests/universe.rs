//! Proof by a known universe: the paper's bins, spectra, covariances (tab:fits) and correlations (tab:rho), 1000 times from mock P(k) to f_NL.
//!
//! Random numbers are fixed. Where a claim is statistical its tolerance is three of its standard errors, of N = 1000 unless said otherwise.

mod chain;
#[cfg(feature = "linalg")]
mod covariance;
mod derivatives;
mod draws;
mod estimates;
mod gains;
mod second_order;
mod sky;
mod spectra;

use std::sync::OnceLock;
use std::vec::Vec;

use crate::variance::posterior::{Constraints, Posterior};
use sky::{Kind, Sky};

/// Realisations of each kind.
const COUNT: u32 = 1000;
/// Standard errors that a fluctuation may reach.
const LIMIT: f64 = 3.0;
/// Which posterior is of which parameter.
const B_G: usize = 0;
const F_NL: usize = 1;

/// What the chain says of each realisation of the two matched universes.
struct Ensemble([Vec<Constraints>; 2]);

impl Ensemble {
    /// Computed once for all claims.
    fn of(kind: Kind) -> &'static Self {
        static ALL: [OnceLock<Ensemble>; 3] = [const { OnceLock::new() }; 3];
        ALL[kind as usize].get_or_init(|| Self(chain::run(&Sky::paper(), kind, 0..COUNT, 1.0)))
    }

    fn posteriors(&self, universe: usize, axis: usize) -> impl Iterator<Item = Posterior> {
        self.0[universe].iter().map(move |constraints| constraints.posterior[axis])
    }

    /// The paper's estimates.
    fn peaks(&self, universe: usize, axis: usize) -> Vec<f64> {
        self.posteriors(universe, axis).map(|posterior| posterior.peak).collect()
    }
}

/// Mean and standard deviation.
fn moments(values: &[f64]) -> [f64; 2] {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let square: f64 = values.iter().map(|x| (x - mean) * (x - mean)).sum();
    [mean, (square / (count - 1.0)).sqrt()]
}
