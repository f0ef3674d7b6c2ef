//! What the runs are compared with: linear theory and nonlinear spectra, averaged over the modes of a box.
//!
//! Nonlinear spectra are a ratio to linear theory, smooth where the spectrum wiggles, times the linear table that initial conditions come from.

use std::f64::consts::TAU;

use fixpair::cosmology::{Cosmology, Linear, Table, growth};

use crate::Failure;
use crate::boltzmann::{Spectrum, embedded};

/// Redshifts of the outputs, the earlier first.
pub(crate) const REDSHIFTS: [f64; 2] = [1.0, 0.0];

/// A model of the nonlinear spectrum.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Model {
    /// Mead et al. 2021, arXiv:2009.01858, without baryonic feedback: the one that claims are about.
    Hmcode2020,
    /// Mead et al. 2016, arXiv:1602.02154.
    Hmcode2016,
    /// Takahashi et al. 2012, arXiv:1208.2701.
    Takahashi,
}

impl Model {
    pub(crate) const ALL: [Self; 3] = [Self::Hmcode2020, Self::Hmcode2016, Self::Takahashi];

    pub(crate) const fn name(self) -> &'static str {
        match self {
            Self::Hmcode2020 => "HMcode-2020",
            Self::Hmcode2016 => "HMcode-2016",
            Self::Takahashi => "Takahashi 2012",
        }
    }
}

/// Linear and nonlinear spectra of the paper's cosmology.
pub(crate) struct Theory {
    /// The linear table of z = 0.
    linear: Spectrum,
    /// Wavenumbers of the nonlinear table.
    k: Vec<f64>,
    /// Nonlinear over linear, by model, of each redshift.
    boost: [[Vec<f64>; 2]; 3],
    /// D of each redshift.
    growth: [f64; 2],
}

impl Theory {
    /// # Errors
    /// If a table of the program cannot be read.
    pub(crate) fn new() -> Result<Self, Failure> {
        let mut k = Vec::new();
        let mut boost: [[Vec<f64>; 2]; 3] = Default::default();
        for line in include_str!("../data/hmcode_goliat.txt").lines().filter(|line| !line.starts_with('#')) {
            let row = line.split_whitespace().map(str::parse).collect::<Result<Vec<f64>, _>>()?;
            let Ok(row) = <[f64; 9]>::try_from(row) else {
                return Err("hmcode_goliat.txt: a row does not have 9 columns".into());
            };
            k.push(row[0]);
            for (model, boost) in boost.iter_mut().enumerate() {
                // Columns are of z = 0 and 1.
                boost[0].push(row[4 + 2 * model] / row[2]);
                boost[1].push(row[3 + 2 * model] / row[1]);
            }
        }
        let mut d = [0.0; 2];
        for (d, z) in d.iter_mut().zip(REDSHIFTS) {
            *d = growth(&Cosmology::goliat(), 1.0 / (1.0 + z))?.d;
        }
        Ok(Self { linear: embedded()?, k, boost, growth: d })
    }

    /// Linear theory at z = 0.
    pub(crate) fn linear(&self) -> Result<Linear<'_>, Failure> {
        Ok(Linear::from_power(Table::new(&self.linear.k, &self.linear.value)?, Cosmology::goliat().n_s)?)
    }

    /// D at each of [`REDSHIFTS`].
    pub(crate) const fn growth(&self) -> [f64; 2] {
        self.growth
    }

    /// Means over all modes of shells `edges[i] <= |n|^2 < edges[i + 1]` in a box: of linear theory and of each model, (Mpc/h)^3.
    pub(crate) fn shells(&self, edges: &[u64], box_size: f64, output: usize) -> Result<Vec<Means>, Failure> {
        let linear = self.linear()?;
        let boost: Vec<_> =
            self.boost.iter().map(|boost| Table::new(&self.k, &boost[output])).collect::<Result<_, _>>()?;
        let squares = modes_by_square(edges.last().copied().unwrap_or(0));
        let mut shells = Vec::new();
        for shell in edges.windows(2) {
            let mut means = Means::default();
            for square in shell[0]..shell[1] {
                let modes = squares[square as usize] as f64;
                if modes > 0.0 {
                    let k = TAU / box_size * (square as f64).sqrt();
                    let power = self.growth[output].powi(2) * linear.power(k)?;
                    means.modes += modes;
                    means.k += modes * k;
                    means.linear += modes * power;
                    for (mean, boost) in means.nonlinear.iter_mut().zip(&boost) {
                        *mean += modes * power * boost.at(k)?;
                    }
                }
            }
            for sum in [&mut means.k, &mut means.linear].into_iter().chain(&mut means.nonlinear) {
                *sum /= means.modes;
            }
            shells.push(means);
        }
        Ok(shells)
    }
}

/// Means over the modes of a shell.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Means {
    /// Modes, k and -k.
    pub(crate) modes: f64,
    /// Wavenumber, h/Mpc.
    pub(crate) k: f64,
    /// Linear theory, (Mpc/h)^3.
    pub(crate) linear: f64,
    /// Each of [`Model::ALL`], (Mpc/h)^3.
    pub(crate) nonlinear: [f64; 3],
}

/// How many integer vectors have each |n|^2 below `end`.
fn modes_by_square(end: u64) -> Vec<u64> {
    let end = end as usize;
    let mut count = vec![0; end];
    let sides = || (0..).take_while(move |i| i * i < end);
    for (i, j) in sides().flat_map(|i| sides().map(move |j| (i, j))) {
        for l in sides().take_while(|l| i * i + j * j + l * l < end) {
            // Each number that is not 0 has two signs.
            count[i * i + j * j + l * l] += 1 << [i, j, l].into_iter().filter(|&number| number > 0).count();
        }
    }
    count
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn modes_are_counted_with_both_signs() {
        assert_eq!(modes_by_square(7), [1, 6, 12, 8, 6, 24, 24]);
        let unit_shell = |b: usize| modes_by_square(49)[b * b..(b + 1) * (b + 1)].iter().sum::<u64>();
        assert_eq!([1, 2, 3, 4, 5, 6].map(unit_shell), [26, 66, 158, 234, 410, 470]);
    }

    #[test]
    fn models_agree_with_linear_theory_on_large_scales_and_with_each_other_to_six_percent() {
        let theory = Theory::new().unwrap();
        for output in 0..2 {
            // A shell at k = 0.006 and one at k = 0.5 of a box of 1000 Mpc/h.
            let shells = theory.shells(&[1, 2, 6300, 6400], 1000.0, output).unwrap();
            for model in 0..3 {
                assert!((shells[0].nonlinear[model] / shells[0].linear - 1.0).abs() < 0.006);
                assert!((shells[2].nonlinear[model] / shells[2].nonlinear[0] - 1.0).abs() < 0.06);
            }
        }
        assert!((theory.growth()[0] - 0.622_814_340_3).abs() < 1e-7);
    }
}
