//! P_hh is b(k)^2: where data are weak, a bias that changes sign may fit as well as one that does not, or better.

use std::vec;
use std::vec::Vec;

use super::Draws;
use crate::reference::built::Memory;
use crate::status::Error;
use crate::variance::bias::{Bias, Spectrum, halo_power};
use crate::variance::fit::{FREE_B_G, FREE_F_NL, FREE_P, fit_bias};
use crate::variance::likelihood::{BiasLikelihood, Spectra};
use crate::variance::models::{lattice_modes, sigma_gaussian};
use crate::variance::posterior::*;

/// A box of 500 Mpc/h, an eighth of the paper's volume: 7 shells below k = 0.09 h/Mpc.
const SHELLS: usize = 7;

fn noisy(truth: &Bias, draws: &mut Draws) -> BiasLikelihood {
    let k: Vec<f64> = (1..=SHELLS).map(|b| core::f64::consts::TAU / 500.0 * (b as f64 + 0.5)).collect();
    let linear: Vec<f64> = k.iter().map(|k| 4e5 * k / (1.0 + (k / 0.02).powi(2)).powf(1.2)).collect();
    let alpha: Vec<f64> = k.iter().map(|k| 1.05e7 * k * k / (1.0 + (k / 0.05).powi(2))).collect();
    let edges: Vec<u64> = (1..=SHELLS as u64 + 1).map(|b| b * b).collect();
    let mut counts = [0; SHELLS];
    lattice_modes(&mut counts, &edges).unwrap();
    let (mut power, mut sigma) = (vec![0.0; SHELLS], vec![0.0; SHELLS]);
    halo_power(&mut power, truth, Spectrum::HaloHalo, &linear, &alpha).unwrap();
    sigma_gaussian(&mut sigma, &power, &counts.map(|count| count as f64), 4000.0).unwrap();
    power.iter_mut().zip(&sigma).for_each(|(power, sigma)| *power += sigma * draws.normal());
    let mut likelihood = BiasLikelihood::EMPTY;
    let spectra = Spectra { power: &power, linear: &linear, alpha: &alpha };
    likelihood.add(Spectrum::HaloHalo, spectra, &sigma).unwrap();
    likelihood
}

#[test]
fn no_point_of_a_grid_is_lower_than_the_fit_and_one_call_is_all_steps() {
    const POINTS: usize = 96;
    let mut draws = Draws::of(211);
    let mut memory = Memory::new(bias_posterior_scratch(POINTS).unwrap());
    let mut chi_squared = vec![0.0; POINTS * POINTS];
    let mut density = vec![0.0; POINTS];
    let (mut closed, mut open) = (0, 0);
    for (f_nl, free) in
        [(0.0, FREE_F_NL), (100.0, FREE_F_NL), (-100.0, FREE_F_NL), (-300.0, FREE_F_NL), (-300.0, FREE_P)]
    {
        let truth = Bias { b_g: 2.32, f_nl, ..Bias::default() };
        for _ in 0..300 {
            let likelihood = noisy(&truth, &mut draws);
            let free = FREE_B_G | free;
            let start = if f_nl == 0.0 { Bias::default() } else { truth };
            let fit = match bias_posterior(&likelihood, &start, free, POINTS, 0.68, memory.get()) {
                Ok(found) => {
                    bias_grid(&mut chi_squared, &likelihood, &start, free, &found.grid).unwrap();
                    for (axis, of) in found.posterior.iter().enumerate() {
                        let range = found.grid.range[axis];
                        marginal(&mut density, &chi_squared, found.grid.points, axis, range).unwrap();
                        let by_hand = read_posterior(&density, range, 0.68).unwrap();
                        // Sums of other order.
                        assert!((by_hand.centre - of.centre).abs() < 1e-9 * of.deviation, "{f_nl}");
                        assert!(of.edge < 1e-4, "{f_nl}: {}", of.edge);
                    }
                    closed += 1;
                    found.fit
                }
                Err(error) => {
                    assert_eq!(error, Error::Convergence);
                    open += 1;
                    continue;
                }
            };
            let lowest = chi_squared.iter().copied().fold(f64::INFINITY, f64::min);
            assert!(
                fit.chi_squared <= lowest + 1e-9 * (1.0 + lowest),
                "{f_nl}: {} {lowest}",
                fit.chi_squared
            );
        }
    }
    // b_g = p is not excluded by all data.
    assert!(closed > 1000 && open < closed / 10, "{closed} {open}");
}

#[test]
fn a_fit_finds_the_deeper_valley_from_the_other() {
    let mut draws = Draws::of(212);
    for _ in 0..200 {
        let truth = Bias { b_g: 2.32, f_nl: -800.0, ..Bias::default() };
        let likelihood = noisy(&truth, &mut draws);
        let fits = [0.0, 1000.0, -1000.0]
            .map(|f_nl| fit_bias(&likelihood, &Bias { f_nl, ..truth }, FREE_B_G | FREE_F_NL).unwrap());
        assert!(fits.iter().all(|fit| (fit.chi_squared - fits[0].chi_squared).abs() < 1e-8), "{fits:?}");
    }
}
