//! The whole chain: spectra -> pair average -> likelihood -> posteriors of b_g and f_NL.

use core::ops::Range;
use std::vec;
use std::vec::Vec;

use super::draws::{Mock, Scatter};
use super::sky::{Kind, Sky, bias};
use crate::reference::built::Memory;
use crate::variance::bias::Spectrum;
use crate::variance::fit::{FREE_B_G, FREE_F_NL};
use crate::variance::likelihood::{BiasLikelihood, Spectra};
use crate::variance::pairs::pair_average;
use crate::variance::posterior::{Constraints, bias_posterior, bias_posterior_scratch};

/// Of each parameter: peaks to 5e-4 of their scatter, half-widths to 0.3%.
const POINTS: usize = 64;
/// The paper's region.
pub(super) const REGION: f64 = 0.68;

/// Case (iii): b_g and f_NL free, p = 1.
pub(super) fn constrain(likelihood: &BiasLikelihood, memory: &mut Memory) -> Constraints {
    let start = bias(0.0);
    bias_posterior(likelihood, &start, FREE_B_G | FREE_F_NL, POINTS, REGION, memory.get()).unwrap()
}

pub(super) fn memory() -> Memory {
    Memory::new(bias_posterior_scratch(POINTS).unwrap())
}

impl Sky {
    pub(super) fn spectra<'a>(&'a self, power: &'a [f64]) -> Spectra<'a> {
        Spectra { power, linear: &self.linear, alpha: &self.alpha }
    }

    pub(super) fn likelihood(&self, power: &[f64], sigma: &[f64]) -> BiasLikelihood {
        let mut likelihood = BiasLikelihood::EMPTY;
        likelihood.add(Spectrum::HaloHalo, self.spectra(power), sigma).unwrap();
        likelihood
    }
}

impl Mock {
    /// The estimate of a kind.
    pub(super) fn estimate(&self, kind: Kind, universe: usize) -> Vec<f64> {
        match kind {
            Kind::Normal => self.normal[universe].clone(),
            Kind::Fixed => self.original[universe].clone(),
            Kind::Paired => {
                let mut average = vec![0.0; self.original[universe].len()];
                pair_average(&mut average, &self.original[universe], &self.inverted[universe]).unwrap();
                average
            }
        }
    }
}

/// Constraints of each realisation, for both universes.
pub(super) fn run(sky: &Sky, kind: Kind, realisations: Range<u32>, sign: f64) -> [Vec<Constraints>; 2] {
    let scatter = Scatter::new(sky);
    let mut memory = memory();
    let mut found = [vec![], vec![]];
    for realisation in realisations {
        let mock = scatter.draw(realisation, sign);
        for universe in 0..2 {
            let power = mock.estimate(kind, universe);
            let likelihood = sky.likelihood(&power, &scatter.sigma(kind)[universe]);
            found[universe].push(constrain(&likelihood, &mut memory));
        }
    }
    found
}
