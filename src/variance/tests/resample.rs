//! Bootstrap and jackknife.

use std::vec;
use std::vec::Vec;

use super::{Draws, largest};
use crate::reference::variance as twin;
use crate::status::Error;
use crate::variance::ensemble::{Moments, ensemble_add, ensemble_covariance, ensemble_init};
use crate::variance::resample::*;

fn indices(count: usize, estimates: u64, seed: u64, replicate: u64) -> Vec<u64> {
    let mut out = vec![u64::MAX; count];
    bootstrap_indices(&mut out, estimates, seed, replicate).unwrap();
    out
}

/// How many sigma chi^2 of equal counts lies from its expectation (cube root of Wilson & Hilferty 1931).
fn unequal(counts: &[u32]) -> f64 {
    let degrees = (counts.len() - 1) as f64;
    let expected = counts.iter().copied().map(f64::from).sum::<f64>() / counts.len() as f64;
    let x: f64 = counts.iter().map(|&count| (f64::from(count) - expected).powi(2) / expected).sum();
    let spread = 2.0 / (9.0 * degrees);
    ((x / degrees).cbrt() - (1.0 - spread)) / spread.sqrt()
}

#[test]
fn a_draw_is_a_function_of_seed_replicate_and_place_alone() {
    for (seed, replicate) in [(0, 0), (7, 3), (u64::MAX, 1 << 40)] {
        let long = indices(101, 41, seed, replicate);
        for count in [0, 1, 2, 40, 41, 100] {
            assert_eq!(indices(count, 41, seed, replicate), long[..count]);
        }
    }
}

/// Computed with another implementation of the generator.
const GOLDEN: [[u64; 8]; 3] = [
    [16, 16, 35, 24, 1, 1, 4, 21],
    [31, 25, 33, 29, 12, 2, 35, 3],
    [533_985, 675_513, 879_988, 947_494, 716_245, 694_254, 155_365, 313_683],
];

#[test]
fn draws_do_not_change_between_versions() {
    assert_eq!(indices(8, 41, 0, 0), GOLDEN[0]);
    assert_eq!(indices(8, 41, 20_220_423, 999), GOLDEN[1]);
    assert_eq!(indices(8, 1_000_000, u64::MAX, u64::MAX), GOLDEN[2]);
}

#[test]
fn draws_are_uniform() {
    // |deviate| < 4 for chi^2 from both sides: p > 6e-5 each.
    for (estimates, seed) in [(2_u64, 0), (7, 1), (41, 2), (41, 1 << 63), (1000, 3)] {
        let mut counts = vec![0_u32; estimates as usize];
        for replicate in 0..1000 {
            indices(64, estimates, seed, replicate).iter().for_each(|&index| counts[index as usize] += 1);
        }
        let deviate = unequal(&counts);
        assert!(deviate.abs() < 4.0, "{estimates}: {deviate}");
    }
    // Estimates by the place that draws them.
    let mut counts = [0_u32; 8 * 9];
    for replicate in 0..10_000 {
        for (place, index) in indices(9, 8, 5, replicate).into_iter().enumerate() {
            counts[8 * place + index as usize] += 1;
        }
    }
    // Ten thousand draws in each of nine places: 63 degrees of freedom counted as 71, half a sigma of shift.
    assert!(unequal(&counts).abs() < 4.0);
    assert!(indices(100, u64::MAX, 1, 1).iter().all(|&index| index < u64::MAX));
    assert!(indices(100, 1, 1, 1).iter().all(|&index| index == 0));
}

#[test]
fn replicates_places_and_seeds_are_not_correlated() {
    let of = |seed: u64, replicate: u64| -> Vec<f64> {
        indices(20_001, 1 << 52, seed, replicate).iter().map(|&x| x as f64 / 2_f64.powi(52) - 0.5).collect()
    };
    let first = of(0, 0);
    let pairs = [
        of(0, 1),
        of(0, 2),
        of(0, 1 << 32),
        of(1, 0),
        of(1 << 32, 0),
        first[1..].to_vec(),
        first[2..].to_vec(),
    ];
    for (i, second) in pairs.iter().enumerate() {
        let products: f64 = first.iter().zip(second).map(|(x, y)| 12.0 * x * y).sum();
        let deviate = products / (second.len() as f64).sqrt();
        assert!(deviate.abs() < 4.0, "{i}: {deviate}");
    }
}

#[test]
fn the_bootstrap_covariance_of_a_mean_is_that_of_samples_over_n() {
    const N: usize = 25;
    const REPLICATES: u64 = 20_000;
    let mut draws = Draws::of(11);
    let samples: Vec<f64> = (0..N).flat_map(|_| draws.pair(0.6)).collect();
    let mut state = [0.0; 8];
    ensemble_init(&mut state, 2, Moments::Covariance).unwrap();
    for replicate in 0..REPLICATES {
        let mut mean = [0.0; 2];
        resampled_mean(&mut mean, &samples, &indices(N, N as u64, 1, replicate)).unwrap();
        ensemble_add(&mut state, &mean).unwrap();
    }
    let mut found = [0.0; 4];
    ensemble_covariance(&mut found, &state, 0..2, 0..2).unwrap();
    let expected = twin::covariance(&samples, 2).into_iter().map(|x| x * (N - 1) as f64 / (N * N) as f64);
    let expected: Vec<f64> = expected.collect();
    let scale = |i: usize, j: usize| (expected[3 * i] * expected[3 * j]).sqrt();
    // A covariance of B replicates has a relative error of sqrt(2/B) = 1% at most; four of them.
    assert!((0..4).all(|at| (found[at] - expected[at]).abs() < 0.04 * scale(at / 2, at % 2)));
}

#[test]
fn the_mean_of_named_rows_is_their_mean() {
    let samples = [1.0, 10.0, 2.0, 20.0, 4.0, 40.0];
    let mut mean = [0.0; 2];
    resampled_mean(&mut mean, &samples, &[0, 2, 2, 1]).unwrap();
    assert_eq!(mean, [2.75, 27.5]);
}

/// The jackknife of a statistic of rows of one value.
fn jackknifed(samples: &[f64], of: impl Fn(&[f64]) -> f64) -> [f64; 2] {
    let deleted: Vec<f64> =
        (0..samples.len()).map(|out| of(&[&samples[..out], &samples[out + 1..]].concat())).collect();
    let (mut corrected, mut error) = ([0.0], [0.0]);
    jackknife(&mut corrected, &mut error, &[of(samples)], &deleted).unwrap();
    [corrected[0], error[0]]
}

#[test]
fn the_jackknife_error_of_a_mean_is_that_of_the_mean() {
    let mut draws = Draws::of(12);
    for count in [2, 3, 41, 200] {
        let samples: Vec<f64> = (0..count).map(|_| 3.0 + draws.normal()).collect();
        let [mean, error] = jackknifed(&samples, |x| twin::means(x, 1)[0]);
        let expected = (twin::covariance(&samples, 1)[0] / count as f64).sqrt();
        // The differences of deleted means are 1/N of those of samples: N roundings more.
        let tolerance = 1e-15 * (10 * count) as f64;
        assert!((mean - twin::means(&samples, 1)[0]).abs() < tolerance);
        assert!((error / expected - 1.0).abs() < tolerance);
    }
}

#[test]
fn the_jackknife_takes_the_whole_bias_from_the_variance_with_n() {
    let mut draws = Draws::of(13);
    for count in [3, 10, 41] {
        let samples: Vec<f64> = (0..count).map(|_| draws.normal()).collect();
        let biased = |x: &[f64]| twin::covariance(x, 1)[0] * (x.len() - 1) as f64 / x.len() as f64;
        let [corrected, _] = jackknifed(&samples, biased);
        // N times numbers of order 1 cancel.
        assert!((corrected / twin::covariance(&samples, 1)[0] - 1.0).abs() < 1e-15 * (30 * count) as f64);
    }
}

#[test]
fn the_jackknife_error_of_a_deviation_covers_its_scatter() {
    // Over 2000 ensembles of 41 normal samples: <error^2> against the variance of the statistic. The jackknife's is conservative by order 1/N
    // (Efron & Stein 1981), the scatter of both leaves 3 sqrt(2/2000) = 10%.
    let mut draws = Draws::of(14);
    let (mut statistics, mut squares) = (Vec::new(), 0.0);
    for _ in 0..2000 {
        let samples: Vec<f64> = (0..41).map(|_| draws.normal()).collect();
        let [value, error] = jackknifed(&samples, |x| twin::covariance(x, 1)[0].sqrt());
        statistics.push(value);
        squares += error * error / 2000.0;
    }
    let ratio = squares / twin::covariance(&statistics, 1)[0];
    assert!((0.9..1.15).contains(&ratio), "{ratio}");
}

#[test]
fn deleted_means_are_means_of_the_other_rows() {
    let mut draws = Draws::of(15);
    let samples: Vec<f64> = (0..30).map(|_| draws.normal()).collect();
    let mut deleted = [0.0; 30];
    jackknife_means(&mut deleted, &samples, 3).unwrap();
    for row in 0..10 {
        let others = [&samples[..3 * row], &samples[3 * row + 3..]].concat();
        let expected = twin::means(&others, 3);
        assert!(largest((0..3).map(|i| (deleted[3 * row + i] - expected[i]).abs())) < 1e-15);
    }
    let mut covariance = [0.0; 9];
    jackknife_covariance(&mut covariance, &deleted, 10, 3).unwrap();
    let expected: Vec<f64> = twin::covariance(&samples, 3).iter().map(|x| x / 10.0).collect();
    assert!((0..9).all(|at| (covariance[at] - expected[at]).abs() < 1e-15), "covariance of the mean");
    let (mut corrected, mut error) = ([0.0; 3], [0.0; 3]);
    jackknife(&mut corrected, &mut error, &twin::means(&samples, 3), &deleted).unwrap();
    assert!((0..3).all(|i| (covariance[4 * i] / (error[i] * error[i]) - 1.0).abs() < 1e-15));
    assert!((0..9).all(|at| covariance[at] == covariance[at % 3 * 3 + at / 3]));
}

#[test]
fn what_cannot_be_resampled_is_refused() {
    let mut out = [7; 3];
    assert_eq!(bootstrap_indices(&mut out, 0, 1, 1), Err(Error::Samples));
    assert_eq!(out, [7; 3]);
    let mut mean = [7.0; 2];
    let mut refused =
        |samples: &[f64], indices: &[u64]| resampled_mean(&mut mean, samples, indices).unwrap_err();
    assert_eq!(refused(&[1.0; 3], &[0]), Error::Length);
    assert_eq!(refused(&[1.0; 4], &[]), Error::Samples);
    assert_eq!(refused(&[1.0; 4], &[0, 2]), Error::Range);
    assert_eq!(refused(&[1.0, f64::NAN], &[0]), Error::NotFinite);
    assert_eq!(refused(&[f64::MAX; 4], &[0, 1]), Error::Range);
    assert_eq!(mean, [7.0; 2]);
    assert_eq!(resampled_mean(&mut [], &[1.0; 4], &[0]), Err(Error::Length));

    let mut deleted = [7.0; 4];
    assert_eq!(jackknife_means(&mut deleted, &[1.0; 4], 0), Err(Error::Length));
    assert_eq!(jackknife_means(&mut deleted, &[1.0; 4], 3), Err(Error::Length));
    assert_eq!(jackknife_means(&mut deleted, &[1.0; 6], 2), Err(Error::Length));
    assert_eq!(jackknife_means(&mut deleted, &[1.0; 4], 4), Err(Error::Samples));
    assert_eq!(jackknife_means(&mut deleted, &[1.0, 1.0, f64::INFINITY, 1.0], 2), Err(Error::NotFinite));
    assert_eq!(jackknife_means(&mut deleted, &[f64::MAX; 4], 1), Err(Error::Range));
    assert_eq!(deleted, [7.0; 4]);

    let (mut corrected, mut error) = ([7.0; 2], [7.0; 2]);
    let mut refused =
        |whole: &[f64], deleted: &[f64]| jackknife(&mut corrected, &mut error, whole, deleted).unwrap_err();
    assert_eq!(refused(&[1.0; 3], &[1.0; 6]), Error::Length);
    assert_eq!(refused(&[1.0; 2], &[1.0; 5]), Error::Length);
    assert_eq!(refused(&[1.0; 2], &[1.0; 2]), Error::Samples);
    assert_eq!(refused(&[1.0, f64::NAN], &[1.0; 4]), Error::NotFinite);
    assert_eq!(refused(&[1.0; 2], &[1.0, 1.0, f64::NAN, 1.0]), Error::NotFinite);
    assert_eq!(refused(&[1.0, f64::MAX], &[1.0; 6]), Error::Range);
    assert_eq!((corrected, error), ([7.0; 2], [7.0; 2]));

    let mut covariance = [7.0; 4];
    let mut refused =
        |deleted: &[f64], rows| jackknife_covariance(&mut covariance, deleted, rows, 2).unwrap_err();
    assert_eq!(refused(&[1.0; 5], 2), Error::Length);
    assert_eq!(refused(&[1.0; 2], 1), Error::Samples);
    assert_eq!(refused(&[1.0, f64::NAN, 1.0, 1.0], 2), Error::NotFinite);
    assert_eq!(jackknife_covariance(&mut covariance[..3], &[1.0; 4], 2, 2), Err(Error::Length));
    assert_eq!(jackknife_covariance(&mut covariance, &[1.0; 4], usize::MAX, 2), Err(Error::Overflow));
    assert_eq!(covariance, [7.0; 4]);
}
