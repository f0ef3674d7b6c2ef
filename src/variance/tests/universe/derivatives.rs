//! Derivatives of the model by b_g and f_NL, over sigma: what theory expects of small deviations.

use std::vec::Vec;

use super::sky::{B_G, F_NL, Kind, Sky};
use crate::variance::bias::DELTA_C;

/// Of m = (b + (b - 1) g f)^2 P/sigma with g = 2 delta_c/alpha, bin by bin, at the true parameters.
pub(super) struct Derivatives {
    /// m_a, and m_ab.
    pub(super) bins: Vec<([f64; 2], [[f64; 2]; 2])>,
    /// J_ab = sum m_a m_b.
    pub(super) curvature: [[f64; 2]; 2],
    /// Its inverse.
    pub(super) covariance: [[f64; 2]; 2],
}

impl Derivatives {
    pub(super) fn new(sky: &Sky, kind: Kind, universe: usize) -> Self {
        let sigma = sky.sigma(kind, universe);
        let bins: Vec<_> = (0..sigma.len())
            .map(|i| {
                let (g, scale) = (2.0 * DELTA_C / sky.alpha[i], 2.0 * sky.linear[i] / sigma[i]);
                let root = B_G + (B_G - 1.0) * g * F_NL[universe];
                let slope = [1.0 + g * F_NL[universe], (B_G - 1.0) * g];
                let mixed = [[0.0, g], [g, 0.0]];
                let second =
                    [0, 1].map(|a| [0, 1].map(|b| scale * (slope[a] * slope[b] + root * mixed[a][b])));
                (slope.map(|slope| scale * root * slope), second)
            })
            .collect();
        let curvature = [0, 1].map(|a| [0, 1].map(|b| bins.iter().map(|(m, _)| m[a] * m[b]).sum()));
        let [[bb, bf], [_, ff]]: [[f64; 2]; 2] = curvature;
        let covariance = [[ff, -bf], [-bf, bb]].map(|row| row.map(|x| x / (bb * ff - bf * bf)));
        Self { bins, curvature, covariance }
    }

    pub(super) fn sum(&self, of: impl Fn([f64; 2], [[f64; 2]; 2]) -> f64) -> f64 {
        self.bins.iter().map(|&(m, second)| of(m, second)).sum()
    }

    /// How the estimate of parameter a follows a deviation of each bin by its sigma.
    pub(super) fn response(&self, a: usize) -> Vec<f64> {
        self.bins.iter().map(|(m, _)| self.covariance[a][0] * m[0] + self.covariance[a][1] * m[1]).collect()
    }
}

/// Correlation of f_NL of the two universes whose spectra have the correlation rho in each bin: less, because the universes weigh bins differently.
pub(super) fn correlation_of_f_nl(sky: &Sky, kind: Kind) -> f64 {
    let [first, second] = [0, 1].map(|universe| Derivatives::new(sky, kind, universe).response(super::F_NL));
    let dot = |x: &[f64], y: &[f64]| -> f64 { x.iter().zip(y).map(|(x, y)| x * y).sum() };
    kind.rho() * dot(&first, &second) / (dot(&first, &first) * dot(&second, &second)).sqrt()
}
