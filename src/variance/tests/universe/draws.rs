//! Mock spectra: Gaussian scatter of the given sigma, matched between the two universes.

use std::vec;
use std::vec::Vec;

use rand_core::TryRng;

use super::sky::{KINDS, Kind, Sky};
use crate::noise::philox::Philox4x32;

/// The paper's number in the arXiv.
const SEED: u64 = 220_411_103;

/// Standard normal numbers (Box & Muller 1958).
pub(super) struct Normals {
    stream: Philox4x32,
    spare: Option<f64>,
}

impl Normals {
    /// Every realisation of every purpose has its own.
    pub(super) fn new(realisation: u32, purpose: u32) -> Self {
        Self { stream: Philox4x32::at(SEED, [0, 0, realisation, purpose]), spare: None }
    }

    pub(super) fn next(&mut self) -> f64 {
        if let Some(spare) = self.spare.take() {
            return spare;
        }
        // In (0, 1): never the logarithm of zero.
        let mut uniform = || {
            let Ok(word) = self.stream.try_next_u64();
            ((word >> 11) as f64 + 0.5) / (1_u64 << 53) as f64
        };
        let (radius, angle) = ((-2.0 * uniform().ln()).sqrt(), core::f64::consts::TAU * uniform());
        self.spare = Some(radius * angle.sin());
        radius * angle.cos()
    }

    /// Two of correlation rho.
    pub(super) fn matched(&mut self, rho: f64) -> [f64; 2] {
        let (x, y) = (self.next(), self.next());
        [x, rho * x + (1.0 - rho * rho).sqrt() * y]
    }
}

/// Spectra of the universes f_NL = 0 and 100 from the same random numbers.
pub(super) struct Mock {
    pub(super) normal: [Vec<f64>; 2],
    /// A Fixed simulation, and its inverted partner.
    pub(super) original: [Vec<f64>; 2],
    pub(super) inverted: [Vec<f64>; 2],
}

/// What the scatter of a sky is, computed once.
pub(super) struct Scatter<'a> {
    sky: &'a Sky,
    /// Of estimates, for each kind and universe.
    sigma: [[Vec<f64>; 2]; 3],
    /// Of half the difference of original and inverted, and its correlation between the universes.
    odd: [Vec<f64>; 2],
    odd_rho: Vec<f64>,
}

impl<'a> Scatter<'a> {
    /// Original and inverted are S + D and S - D. The average S has sigma_FP/sqrt 2 and the correlation of pairs; D makes up
    /// what a Fixed simulation by itself has: sigma_F, and the correlation of Fixed ones.
    pub(super) fn new(sky: &'a Sky) -> Self {
        let sigma = KINDS.map(|kind| [0, 1].map(|universe| sky.sigma(kind, universe)));
        let [_, fixed, even] = &sigma;
        let bins = sky.k.len();
        let odd: [Vec<f64>; 2] = [0, 1].map(|u| {
            (0..bins).map(|i| (fixed[u][i] * fixed[u][i] - even[u][i] * even[u][i]).sqrt()).collect()
        });
        let odd_rho = (0..bins)
            .map(|i| {
                let wanted = Kind::Fixed.rho() * fixed[0][i] * fixed[1][i];
                (wanted - Kind::Paired.rho() * even[0][i] * even[1][i]) / (odd[0][i] * odd[1][i])
            })
            .collect();
        Self { sky, sigma, odd, odd_rho }
    }

    pub(super) fn sigma(&self, kind: Kind) -> &[Vec<f64>; 2] {
        &self.sigma[kind as usize]
    }

    /// `sign`: -1 turns all deviations from the mean.
    pub(super) fn draw(&self, realisation: u32, sign: f64) -> Mock {
        let mut normals = Normals::new(realisation, 0);
        let empty = || [0, 1].map(|_| vec![0.0; self.sky.k.len()]);
        let mut mock = Mock { normal: empty(), original: empty(), inverted: empty() };
        let [normal, _, even] = &self.sigma;
        for i in 0..self.sky.k.len() {
            let x = normals.matched(Kind::Normal.rho());
            let s = normals.matched(Kind::Paired.rho());
            let d = normals.matched(self.odd_rho[i]);
            for u in 0..2 {
                let mean = self.sky.power[u][i];
                let (s, d) = (even[u][i] * s[u], self.odd[u][i] * d[u]);
                mock.normal[u][i] = mean + sign * normal[u][i] * x[u];
                mock.original[u][i] = mean + sign * (s + d);
                mock.inverted[u][i] = mean + sign * (s - d);
            }
        }
        mock
    }
}
