//! Models of scatter, and numbers of modes.

use core::f64::consts::{FRAC_2_PI, TAU};
use std::vec;
use std::vec::Vec;

use super::{Draws, largest};
use crate::reference::variance as twin;
use crate::status::Error;
use crate::variance::models::*;

#[test]
fn lattice_counts_are_those_of_counting() {
    let mut draws = Draws::of(31);
    for _ in 0..30 {
        let mut edges: Vec<u64> = (0..2 + draws.below(12)).map(|_| draws.below(400) as u64).collect();
        edges.sort_unstable();
        edges.dedup();
        if edges.len() < 2 {
            continue;
        }
        let mut counts = vec![u64::MAX; edges.len() - 1];
        lattice_modes(&mut counts, &edges).unwrap();
        assert_eq!(counts, twin::lattice_modes(&edges), "{edges:?}");
    }
    // Shells of one |n|^2 each: the numbers of ways to write 0..9 as three squares, of which 7 is none.
    let edges: Vec<u64> = (0..=9).collect();
    let mut counts = [0; 9];
    lattice_modes(&mut counts, &edges).unwrap();
    assert_eq!(counts, [1, 6, 12, 8, 6, 24, 24, 0, 12]);
}

#[test]
fn modes_of_joined_shells_add() {
    let edges: Vec<u64> = (1..60).map(|i| i * i).collect();
    let mut parts = vec![0; edges.len() - 1];
    lattice_modes(&mut parts, &edges).unwrap();
    let mut whole = [0];
    lattice_modes(&mut whole, &[1, 59 * 59]).unwrap();
    assert_eq!(parts.iter().sum::<u64>(), whole[0]);
}

#[test]
fn the_lattice_becomes_the_continuum() {
    let box_size = 1000.0;
    let k_f = TAU / box_size;
    for n in [8_u64, 30, 100, 300, 1000] {
        let mut lattice = [0];
        lattice_modes(&mut lattice, &[n * n, (n + 1) * (n + 1)]).unwrap();
        let mut continuum = [0.0];
        continuum_modes(&mut continuum, &[k_f * (n as f64 + 0.5)], k_f, box_size).unwrap();
        // Points in a ball of radius n scatter about its volume by little more than n (Gauss' circle problem in three dimensions).
        let difference = (lattice[0] as f64 - continuum[0]).abs() / n as f64;
        assert!(difference < 20.0, "{n}: {difference}");
    }
}

#[test]
fn the_gaussian_scatter_is_a_part_of_power_and_noise() {
    let mut sigma = [0.0; 3];
    sigma_gaussian(&mut sigma, &[2e4, 2e4, 0.0], &[2.0, 800.0, 2.0], 4000.0).unwrap();
    let expected = [24_000.0, 1200.0, 4000.0];
    assert!(largest((0..3).map(|i| (sigma[i] / expected[i] - 1.0).abs())) < 1e-15);
    // P alone, and P that has been scattered below zero above the noise.
    sigma_gaussian(&mut sigma, &[1.0, 2.0, 3.0], &[2.0; 3], 0.0).unwrap();
    assert_eq!(sigma, [1.0, 2.0, 3.0]);
    sigma_gaussian(&mut sigma, &[-1.0; 3], &[2.0; 3], 1.5).unwrap();
    assert_eq!(sigma, [0.5; 3]);
}

/// sigma_r of one bin, for N_k = 2.
fn suppressed(fit: &Suppression, k: f64, power: f64, noise: f64) -> f64 {
    let mut sigma = [0.0];
    sigma_suppressed(&mut sigma, fit, &[k], &[power], &[2.0], noise).unwrap();
    sigma[0]
}

#[test]
fn suppression_goes_from_r_cv_to_one() {
    let fit = Suppression { cosmic_variance: 0.141, softening: 0.114, shot_noise: 1.174 };
    let (power, noise) = (2e4, 4e3);
    let cosmic = |k: f64| (suppressed(&fit, k, power, noise) - 1.174 * noise) / power;
    // (2/pi) atan(x) is (2/pi) x at small x and 1 - 2/(pi x) at large.
    assert!((cosmic(1e-9 * 0.114) - 0.141).abs() < 1e-8);
    assert!((cosmic(1e9 * 0.114) - 1.0).abs() < 1e-8);
    assert!((cosmic(0.114) - (0.141 + 0.859 * 0.5)).abs() < 1e-14);
    let ks = (0..200).map(|i| 1e-4 * 1.1_f64.powi(i));
    let all: Vec<f64> = ks.map(cosmic).collect();
    assert!(all.windows(2).all(|pair| pair[0] < pair[1]));
    // With the minus that is printed it would end at 2 R_cv - 1: not positive, so no scatter.
    let printed = |k: f64| 0.141 - 0.859 * FRAC_2_PI * (k / 0.114_f64).atan();
    assert!(printed(1.0) < 0.0 && cosmic(1.0) > 0.0);
}

#[test]
fn nothing_suppressed_is_the_gaussian_scatter_and_all_suppressed_is_shot_noise() {
    let all = Suppression { cosmic_variance: 0.0, softening: 1.0, shot_noise: 1.0 };
    for k in [0.01, 0.1, 1.0] {
        let mut gaussian = [0.0];
        sigma_gaussian(&mut gaussian, &[2e4], &[2.0], 4e3).unwrap();
        assert!((suppressed(&Suppression::NONE, k, 2e4, 4e3) / gaussian[0] - 1.0).abs() < 1e-15);
        let step = FRAC_2_PI * (k / 1.0_f64).atan();
        assert!((suppressed(&all, k, 2e4, 4e3) / (2e4 * step + 4e3) - 1.0).abs() < 1e-15);
    }
}

#[test]
fn scatter_of_what_is_not_is_refused() {
    let mut out = [7.0; 2];
    let one = [1.0; 2];
    let mut gaussian =
        |power: &[f64], modes: &[f64], noise: f64| sigma_gaussian(&mut out, power, modes, noise).unwrap_err();
    assert_eq!(gaussian(&one[1..], &one, 0.0), Error::Length);
    assert_eq!(gaussian(&one, &[1.0; 3], 0.0), Error::Length);
    assert_eq!(gaussian(&one, &[1.0, 0.0], 0.0), Error::Range);
    assert_eq!(gaussian(&one, &one, -1e-9), Error::Range);
    assert_eq!(gaussian(&[1.0, -2.0], &one, 2.0), Error::Range);
    assert_eq!(gaussian(&[1.0, f64::MAX], &one, f64::MAX), Error::Range);
    assert_eq!(gaussian(&[1.0, f64::NAN], &one, 0.0), Error::NotFinite);
    assert_eq!(gaussian(&one, &one, f64::INFINITY), Error::NotFinite);
    let good = Suppression { cosmic_variance: 0.1, softening: 0.1, shot_noise: 1.0 };
    let mut refused =
        |fit: &Suppression, k: &[f64]| sigma_suppressed(&mut out, fit, k, &one, &one, 1.0).unwrap_err();
    assert_eq!(refused(&good, &[1.0, 0.0]), Error::Range);
    assert_eq!(refused(&good, &one[1..]), Error::Length);
    assert_eq!(refused(&good, &[1.0, f64::NAN]), Error::NotFinite);
    assert_eq!(refused(&Suppression { softening: 0.0, ..good }, &one), Error::Range);
    assert_eq!(refused(&Suppression { cosmic_variance: -0.1, ..good }, &one), Error::Range);
    assert_eq!(refused(&Suppression { shot_noise: -0.1, ..good }, &one), Error::Range);
    assert_eq!(refused(&Suppression { shot_noise: f64::NAN, ..good }, &one), Error::NotFinite);
    let mut modes = |k: &[f64], width: f64, size: f64| continuum_modes(&mut out, k, width, size).unwrap_err();
    assert_eq!(modes(&[1.0], 1.0, 1.0), Error::Length);
    assert_eq!(modes(&[1.0, 0.0], 1.0, 1.0), Error::Range);
    assert_eq!(modes(&one, 0.0, 1.0), Error::Range);
    assert_eq!(modes(&one, 1.0, -1.0), Error::Range);
    assert_eq!(modes(&one, f64::NAN, 1.0), Error::NotFinite);
    assert_eq!(modes(&one, 1.0, 1e200), Error::Range);
    assert_eq!(modes(&[1.0, 1e-300], 1.0, 1.0), Error::Range);
    assert_eq!(out, [7.0; 2]);
    let mut counts = [7; 2];
    let mut refused = |edges: &[u64]| lattice_modes(&mut counts, edges).unwrap_err();
    assert_eq!(refused(&[1]), Error::Table);
    assert_eq!(refused(&[1, 4, 4]), Error::Table);
    assert_eq!(refused(&[1, 4]), Error::Length);
    assert_eq!(refused(&[1, 4, (1 << 28) + 1]), Error::Range);
    assert_eq!(counts, [7; 2]);
}
