//! Differences of matched estimates.

use std::vec::Vec;

use super::{Draws, mean_and_deviation, relative};
use crate::status::Error;
use crate::variance::matched::*;

fn matched(draws: &mut Draws, count: usize, rho: f64) -> (Vec<f64>, Vec<f64>) {
    (0..count).map(|_| draws.pair(rho)).map(|[x, y]| (100.0 + 12.1 * x, 3.0 + 11.8 * y)).unzip()
}

#[test]
fn the_difference_scatters_as_eq_correlation_of_its_own_moments() {
    let mut draws = Draws::of(101);
    for rho in [-0.9, 0.0, 0.76, 0.97] {
        for count in [2, 5, 41, 500] {
            let (first, second) = matched(&mut draws, count, rho);
            let found = matched_difference(&first, &second).unwrap();
            let expected =
                difference_sigma(found.deviation_first, found.deviation_second, found.correlation).unwrap();
            // Two estimates have rho = 1 exactly and differ by what is left.
            let cancelled = (found.deviation_first / found.deviation).powi(2).max(1.0);
            assert!(relative(found.deviation, expected) < 1e-14 * cancelled, "{rho} {count}");
            for ((mean, deviation), (of_mean, of_deviation)) in [
                (mean_and_deviation(&first), (found.mean_first, found.deviation_first)),
                (mean_and_deviation(&second), (found.mean_second, found.deviation_second)),
            ] {
                assert!(relative(of_mean, mean) < 1e-14 && relative(of_deviation, deviation) < 1e-14);
            }
            let differences: Vec<f64> = first.iter().zip(&second).map(|(x, y)| x - y).collect();
            let (mean, deviation) = mean_and_deviation(&differences);
            assert!(relative(found.mean, mean) < 1e-13 && relative(found.deviation, deviation) < 1e-12);
            assert!(relative(found.error_of_mean, deviation / (count as f64).sqrt()) < 1e-12);
            let swapped = matched_difference(&second, &first).unwrap();
            assert_eq!((swapped.mean, swapped.deviation), (-found.mean, found.deviation));
            assert_eq!(swapped.correlation, found.correlation);
        }
    }
}

#[test]
fn matching_to_nine_digits_keeps_the_others() {
    // Multiples of powers of two, so that sums and differences are exact.
    let mut draws = Draws::of(102);
    let round = |x: f64, unit: f64| (x / unit).round() * unit;
    let units = [0.5_f64.powi(18), 0.5_f64.powi(42)];
    let second: Vec<f64> = (0..64).map(|_| round(draws.normal(), units[0])).collect();
    let apart: Vec<f64> = (0..64).map(|_| round(1e-9 * draws.normal(), units[1])).collect();
    let first: Vec<f64> = second.iter().zip(&apart).map(|(x, apart)| x + apart).collect();
    let found = matched_difference(&first, &second).unwrap();
    let (mean, deviation) = mean_and_deviation(&apart);
    // The difference of means of order 1 has their roundings: 1e-16 of 1e-9.
    assert!((found.mean - mean).abs() < 1e-15);
    assert!(relative(found.deviation, deviation) < 1e-7);
    let lost = difference_sigma(found.deviation_first, found.deviation_second, found.correlation).unwrap();
    assert!(relative(lost, deviation) > 1e-3, "Eq. correlation cannot know: {lost}");
}

#[test]
fn the_scatter_of_rho_is_its_error() {
    let mut draws = Draws::of(103);
    for rho in [0.0, 0.76, 0.97] {
        let mut errors = Vec::new();
        let correlations: Vec<f64> = (0..4000)
            .map(|_| {
                let (first, second) = matched(&mut draws, 41, rho);
                let found = matched_difference(&first, &second).unwrap();
                errors.push(found.correlation_error);
                found.correlation
            })
            .collect();
        let (_, scatter) = mean_and_deviation(&correlations);
        let expected = (1.0 - rho * rho) / 40_f64.sqrt();
        // Sampling error 1.1%, of skewed distributions twice that; the next order is 11 rho^2/(4 N), 7% at most.
        assert!((scatter / expected - 1.0).abs() < 0.045 + 0.07 * rho * rho, "{rho}: {scatter} {expected}");
        let (mean, _) = mean_and_deviation(&errors);
        assert!((mean / expected - 1.0).abs() < 0.08, "{rho}: {mean}");
    }
}

#[test]
fn the_sigma_of_a_difference_is_symmetric_and_ends_at_sum_and_difference() {
    assert_eq!(difference_sigma(3.0, 4.0, 0.0), Ok(5.0));
    assert_eq!(difference_sigma(3.0, 4.0, 1.0), Ok(1.0));
    assert_eq!(difference_sigma(3.0, 4.0, -1.0), Ok(7.0));
    assert_eq!(difference_sigma(3.0, 3.0, 1.0), Ok(0.0));
    assert_eq!(difference_sigma(0.0, 3.0, 0.5), Ok(3.0));
    let mut draws = Draws::of(104);
    for _ in 0..100 {
        let (a, b, rho) = (draws.unit(), draws.unit(), 2.0 * draws.unit() - 1.0);
        let sigma = difference_sigma(a, b, rho).unwrap();
        assert!(relative(sigma, difference_sigma(b, a, rho).unwrap()) < 1e-15);
        assert!((sigma * sigma - (a * a + b * b - 2.0 * rho * a * b)).abs() < 1e-15);
    }
}

#[test]
fn volumes_multiply_and_pairs_cost_two() {
    let by = |reference, simulations, sigma, other| {
        effective_volume(reference, simulations, sigma, other).unwrap()
    };
    assert_eq!(by(10.0, 1, 5.0, 1), 4.0);
    assert_eq!(by(10.0, 1, 5.0, 2), 2.0);
    assert_eq!(by(10.0, 2, 5.0, 1), 8.0);
    assert!(relative(by(60.5, 1, 12.1, 1) * by(12.1, 1, 5.2, 2), by(60.5, 1, 5.2, 2)) < 1e-15);
}

#[test]
fn the_error_of_p_is_its_scatter() {
    let mut draws = Draws::of(105);
    for rho in [-0.8, 0.0, 0.9] {
        let (b_g, f_nl) = (Estimate { value: 2.32, error: 0.01 }, Estimate { value: 109.2, error: 5.2 });
        let found = universality(b_g, f_nl, rho * b_g.error * f_nl.error, 100.0).unwrap();
        let values: Vec<f64> = (0..20_000)
            .map(|_| {
                let [x, y] = draws.pair(rho);
                let b = b_g.value + b_g.error * x;
                b - (b - 1.0) * (f_nl.value + f_nl.error * y) / 100.0
            })
            .collect();
        // Sampling error 0.5%.
        assert!((mean_and_deviation(&values).1 / found.error - 1.0).abs() < 0.02);
    }
    let exact = |value| Estimate { value, error: 0.0 };
    assert_eq!(universality(exact(2.32), exact(100.0), 0.0, 100.0).unwrap().value, 1.0);
    assert_eq!(universality(exact(2.32), exact(0.0), 0.0, -100.0).unwrap().value, 2.32);
}

#[test]
fn what_is_not_matched_is_refused() {
    let refused = |first: &[f64], second: &[f64]| matched_difference(first, second).unwrap_err();
    assert_eq!(refused(&[1.0, 2.0], &[1.0]), Error::Length);
    assert_eq!(refused(&[1.0], &[1.0]), Error::Samples);
    assert_eq!(refused(&[], &[]), Error::Samples);
    assert_eq!(refused(&[1.0, f64::NAN], &[1.0, 2.0]), Error::NotFinite);
    assert_eq!(refused(&[1.0, 2.0], &[f64::INFINITY, 2.0]), Error::NotFinite);
    assert_eq!(refused(&[1.0, 2.0], &[3.0, 3.0]), Error::Singular);
    assert_eq!(refused(&[1e200, -1e200], &[1.0, 2.0]), Error::Range);
    assert_eq!(difference_sigma(-1.0, 1.0, 0.0), Err(Error::Range));
    assert_eq!(difference_sigma(1.0, 1.0, 1.1), Err(Error::Range));
    assert_eq!(difference_sigma(1.0, 1.0, f64::NAN), Err(Error::NotFinite));
    assert_eq!(difference_sigma(1e200, 1.0, 0.0), Err(Error::Range));
    assert_eq!(effective_volume(1.0, 1, 0.0, 1), Err(Error::Range));
    assert_eq!(effective_volume(1.0, 0, 1.0, 1), Err(Error::Range));
    assert_eq!(effective_volume(1.0, 1, 1.0, 0), Err(Error::Range));
    assert_eq!(effective_volume(1e200, 1, 1e-200, 1), Err(Error::Range));
    let good = Estimate { value: 2.0, error: 0.1 };
    assert_eq!(universality(good, good, 0.0, 0.0), Err(Error::Range));
    assert_eq!(universality(good, good, 0.011, 1.0), Err(Error::Range));
    assert_eq!(universality(good, Estimate { error: -0.1, ..good }, 0.0, 1.0), Err(Error::Range));
    assert_eq!(universality(good, Estimate { value: f64::NAN, ..good }, 0.0, 1.0), Err(Error::NotFinite));
}
