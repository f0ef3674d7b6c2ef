//! The universe of Avila & Adame 2022 as far as their analysis sees it: bins, spectra and their scatter.

use std::vec;
use std::vec::Vec;

use crate::cosmology::{Convention, Cosmology, Linear, Poisson, Table};
use crate::variance::bias::{Bias, Spectrum, halo_power};
use crate::variance::models::{Suppression, lattice_modes, sigma_gaussian, sigma_suppressed};

/// Largest k that the paper fits, h/Mpc.
pub(super) const LARGEST: f64 = 0.09;
/// Side of the box, Mpc/h.
const SIDE: f64 = 1000.0;
/// 1/n of n = 2.5e-4 halos per (Mpc/h)^3.
pub(super) const NOISE: f64 = 4000.0;
/// b_g of the paper's halos at z = 1.
pub(super) const B_G: f64 = 2.32;
/// f_NL of the two matched universes; p = 1 in both.
pub(super) const F_NL: [f64; 2] = [0.0, 100.0];

/// The rows sigma_F and sigma_FP of tab:fits, for both f_NL.
const FITS: [[[f64; 3]; 2]; 2] =
    [[[0.141, 0.114, 1.174], [0.110, 0.110, 1.081]], [[0.177, 0.224, 1.224], [0.120, 0.156, 1.056]]];

/// Three kinds of estimate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// One Normal simulation.
    Normal,
    /// One Fixed simulation.
    Fixed,
    /// The average of a Fixed simulation and its inverted partner: two simulations.
    Paired,
}

pub(super) const KINDS: [Kind; 3] = [Kind::Normal, Kind::Fixed, Kind::Paired];

impl Kind {
    /// rho of tab:rho.
    pub(super) fn rho(self) -> f64 {
        [0.97, 0.76, 0.85][self as usize]
    }

    pub(super) fn simulations(self) -> u64 {
        [1, 1, 2][self as usize]
    }

    /// The row of tab:fits that holds for a simulation of this kind.
    pub(super) fn suppression(self, universe: usize) -> Suppression {
        if self == Self::Normal {
            return Suppression::NONE;
        }
        let [cosmic_variance, softening, shot_noise] = FITS[self as usize - 1][universe];
        Suppression { cosmic_variance, softening, shot_noise }
    }
}

/// Bins of the fundamental frequency's width, and what is expected in them at z = 1.
pub(super) struct Sky {
    /// Mean |k| of the modes of each bin, h/Mpc.
    pub(super) k: Vec<f64>,
    /// Modes, counting k and -k.
    pub(super) modes: Vec<f64>,
    /// P_lin of matter, averaged over the modes.
    pub(super) linear: Vec<f64>,
    /// alpha of the mean k.
    pub(super) alpha: Vec<f64>,
    /// P_hh without shot noise, for both f_NL.
    pub(super) power: [Vec<f64>; 2],
}

/// Universal halos, p = 1.
pub(super) fn bias(f_nl: f64) -> Bias {
    Bias { b_g: B_G, f_nl, ..Bias::default() }
}

/// Columns k and P(z = 0) of CAMB.
fn camb() -> [Vec<f64>; 2] {
    let text = include_str!("../../../../examples/data/camb_goliat_linear.txt");
    let rows = || text.lines().filter(|line| !line.starts_with('#'));
    [0, 2].map(|column| {
        rows().map(|line| line.split_whitespace().nth(column).unwrap().parse().unwrap()).collect()
    })
}

impl Sky {
    /// All bins whose mean k is at most `largest`, in a box of so many times the paper's volume: its modes are counted, not its bins.
    pub(super) fn new(largest: f64, volume: f64, f_nl: [f64; 2]) -> Self {
        let [rows, power] = camb();
        let cosmology = Cosmology::goliat();
        let linear = Linear::from_power(Table::new(&rows, &power).unwrap(), cosmology.n_s).unwrap();
        let poisson = Poisson::new(&cosmology, linear, 0.5, Convention::Cmb).unwrap();
        let fundamental = core::f64::consts::TAU / SIDE;

        // Every |n|^2 by itself, for exact means over the modes.
        let shells = (largest / fundamental) as u64 + 1;
        let edges: Vec<u64> = (0..=shells * shells).collect();
        let mut counts = vec![0; edges.len() - 1];
        lattice_modes(&mut counts, &edges).unwrap();
        let mut sky =
            Self { k: vec![], modes: vec![], linear: vec![], alpha: vec![], power: [vec![], vec![]] };
        for shell in 1..shells {
            let inside = shell * shell..(shell + 1) * (shell + 1);
            let sum = |of: &dyn Fn(f64) -> f64| -> f64 {
                inside
                    .clone()
                    .map(|square| (counts[square as usize] as f64, fundamental * (square as f64).sqrt()))
                    .map(|(count, k)| if count > 0.0 { count * of(k) } else { 0.0 })
                    .sum()
            };
            let modes = sum(&|_| 1.0);
            let k = sum(&|k| k) / modes;
            if k > largest {
                break;
            }
            sky.k.push(k);
            sky.modes.push(volume * modes);
            sky.linear.push(sum(&|k| poisson.density_power(k).unwrap()) / modes);
            sky.alpha.push(poisson.alpha(k).unwrap());
        }
        for (universe, power) in sky.power.iter_mut().enumerate() {
            power.resize(sky.k.len(), 0.0);
            halo_power(power, &bias(f_nl[universe]), Spectrum::HaloHalo, &sky.linear, &sky.alpha).unwrap();
        }
        sky
    }

    /// The paper's analysis: k <= 0.09 h/Mpc.
    pub(super) fn paper() -> Self {
        Self::new(LARGEST, 1.0, F_NL)
    }

    /// Scatter per simulation (Eq. sigma_th, Eq. sigma_fix).
    pub(super) fn per_simulation(&self, kind: Kind, universe: usize) -> Vec<f64> {
        let mut sigma = vec![0.0; self.k.len()];
        let power = &self.power[universe];
        if kind == Kind::Normal {
            sigma_gaussian(&mut sigma, power, &self.modes, NOISE).unwrap();
        } else {
            let suppression = kind.suppression(universe);
            sigma_suppressed(&mut sigma, &suppression, &self.k, power, &self.modes, NOISE).unwrap();
        }
        sigma
    }

    /// Scatter of an estimate: sigma_FP/sqrt 2 of a pair (Eq. sigma_paired).
    pub(super) fn sigma(&self, kind: Kind, universe: usize) -> Vec<f64> {
        let root = (kind.simulations() as f64).sqrt();
        self.per_simulation(kind, universe).iter().map(|sigma| sigma / root).collect()
    }
}
