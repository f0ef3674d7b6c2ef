//! States of ensembles against two passes over all samples.

use std::vec;
use std::vec::Vec;

use super::{Draws, largest};
use crate::reference::variance as twin;
use crate::status::{Error, Result};
use crate::variance::ensemble::*;

/// Correlated samples with means and deviations of all sizes.
fn samples(draws: &mut Draws, count: usize, values: usize) -> Vec<f64> {
    let mut rows = Vec::new();
    for _ in 0..count {
        let common = draws.normal();
        rows.extend((0..values).map(|i| {
            let scale = 10_f64.powi(3 * i as i32 - 4);
            scale * (2.0 + common * i as f64 + draws.normal())
        }));
    }
    rows
}

fn state_of(rows: &[f64], values: usize, moments: Moments) -> Vec<f64> {
    let mut state = vec![f64::NAN; ensemble_length(values, moments).unwrap()];
    ensemble_init(&mut state, values, moments).unwrap();
    rows.chunks(values).for_each(|row| ensemble_add(&mut state, row).unwrap());
    state
}

fn covariance_of(state: &[f64], values: usize) -> Vec<f64> {
    let mut out = vec![0.0; values * values];
    ensemble_covariance(&mut out, state, 0..values, 0..values).unwrap();
    out
}

/// Largest difference of two covariances in units of the deviations.
fn apart(a: &[f64], b: &[f64], values: usize) -> f64 {
    largest((0..values * values).map(|at| {
        let (i, j) = (at / values, at % values);
        (a[at] - b[at]).abs() / (b[i * values + i] * b[j * values + j]).sqrt()
    }))
}

fn bits(values: &[f64]) -> Vec<u64> {
    values.iter().map(|x| x.to_bits()).collect()
}

#[test]
fn moments_are_those_of_two_passes() {
    let mut draws = Draws::of(1);
    for (count, values) in [(2, 1), (3, 5), (41, 5), (1000, 3)] {
        let rows = samples(&mut draws, count, values);
        let expected = twin::covariance(&rows, values);
        let full = state_of(&rows, values, Moments::Covariance);
        // Roundings of N terms.
        let tolerance = 1e-15 * (count as f64).sqrt() + 1e-15;
        assert!(apart(&covariance_of(&full, values), &expected, values) < 10.0 * tolerance);
        for state in [&full, &state_of(&rows, values, Moments::Variance)] {
            assert_eq!(ensemble_count(state), Ok(count as u64));
            let (mut mean, mut deviation, mut error) =
                (vec![0.0; values], vec![0.0; values], vec![0.0; values]);
            ensemble_mean(&mut mean, state).unwrap();
            ensemble_deviation(&mut deviation, state).unwrap();
            ensemble_error_of_mean(&mut error, state).unwrap();
            for (i, expected_mean) in twin::means(&rows, values).into_iter().enumerate() {
                let sigma = expected[i * values + i].sqrt();
                assert!((mean[i] - expected_mean).abs() < 10.0 * tolerance * sigma);
                assert!((deviation[i] / sigma - 1.0).abs() < 10.0 * tolerance);
                assert!((error[i] * (count as f64).sqrt() / deviation[i] - 1.0).abs() < 1e-15);
            }
        }
    }
}

#[test]
fn blocks_are_parts_of_the_whole_and_the_whole_is_symmetric() {
    let rows = samples(&mut Draws::of(2), 30, 6);
    let state = state_of(&rows, 6, Moments::Covariance);
    let whole = covariance_of(&state, 6);
    assert!((0..36).all(|at| whole[at] == whole[at % 6 * 6 + at / 6]));
    for (rows, columns) in [(0..2, 2..6), (2..6, 0..2), (1..4, 3..5), (5..6, 5..6), (3..3, 0..6)] {
        let mut block = vec![0.0; rows.len() * columns.len()];
        ensemble_covariance(&mut block, &state, rows.clone(), columns.clone()).unwrap();
        let expected: Vec<f64> =
            rows.flat_map(|i| columns.clone().map(move |j| (i, j))).map(|(i, j)| whole[6 * i + j]).collect();
        assert_eq!(block, expected);
    }
    let variances = state_of(&rows, 6, Moments::Variance);
    for i in 0..6 {
        let mut one = [0.0];
        ensemble_covariance(&mut one, &variances, i..i + 1, i..i + 1).unwrap();
        assert!((one[0] / whole[7 * i] - 1.0).abs() < 1e-15, "variances need no covariance");
    }
}

#[test]
fn a_mean_of_1e8_deviations_costs_no_digits_that_samples_have() {
    let mut draws = Draws::of(3);
    let rows: Vec<f64> = (0..2000).map(|_| 1e8 + draws.normal()).collect();
    // Exact: what the sample lost by being rounded is not asked for.
    let shifted: Vec<f64> = rows.iter().map(|x| x - 1e8).collect();
    let expected = twin::covariance(&shifted, 1)[0];
    let state = state_of(&rows, 1, Moments::Covariance);
    let variance = covariance_of(&state, 1)[0];
    // A mean of 1e8 is rounded to 1.5e-8, as samples are. Squares about zero would be rounded to 2.
    assert!((variance / expected - 1.0).abs() < 1.5e-8, "{}", variance / expected - 1.0);
    let mut halves = state_of(&rows[..1000], 1, Moments::Covariance);
    ensemble_merge(&mut halves, &state_of(&rows[1000..], 1, Moments::Covariance)).unwrap();
    assert!((covariance_of(&halves, 1)[0] / expected - 1.0).abs() < 1.5e-8);
}

#[test]
fn any_split_merged_in_any_order_is_the_whole() {
    let mut draws = Draws::of(4);
    let rows = samples(&mut draws, 60, 4);
    for moments in [Moments::Covariance, Moments::Variance] {
        let whole = state_of(&rows, 4, moments);
        for _ in 0..50 {
            let mut parts = vec![Vec::new(); 1 + draws.below(8)];
            for row in rows.chunks(4) {
                let part = draws.below(parts.len());
                parts[part].extend_from_slice(row);
            }
            let mut sum = state_of(&[], 4, moments);
            for part in &parts {
                ensemble_merge(&mut sum, &state_of(part, 4, moments)).unwrap();
            }
            assert_eq!(ensemble_count(&sum), Ok(60));
            let (mut a, mut b) = ([0.0; 4], [0.0; 4]);
            ensemble_mean(&mut a, &sum).unwrap();
            ensemble_mean(&mut b, &whole).unwrap();
            assert!(largest((0..4).map(|i| (a[i] / b[i] - 1.0).abs())) < 1e-14);
            ensemble_deviation(&mut a, &sum).unwrap();
            ensemble_deviation(&mut b, &whole).unwrap();
            assert!(largest((0..4).map(|i| (a[i] / b[i] - 1.0).abs())) < 1e-14);
            if moments == Moments::Covariance {
                assert!(apart(&covariance_of(&sum, 4), &covariance_of(&whole, 4), 4) < 1e-14);
            }
        }
    }
}

#[test]
fn merging_with_an_empty_state_changes_no_bit() {
    let rows = samples(&mut Draws::of(5), 7, 3);
    for moments in [Moments::Covariance, Moments::Variance] {
        let (full, empty) = (state_of(&rows, 3, moments), state_of(&[], 3, moments));
        for (first, second) in [(&full, &empty), (&empty, &full)] {
            let mut sum = first.clone();
            ensemble_merge(&mut sum, second).unwrap();
            assert_eq!(bits(&sum), bits(&full));
        }
        let mut none = empty.clone();
        ensemble_merge(&mut none, &empty).unwrap();
        assert_eq!(bits(&none), bits(&empty));
    }
}

#[test]
fn a_saved_state_goes_on_where_it_was() {
    let rows = samples(&mut Draws::of(6), 20, 3);
    let whole = state_of(&rows, 3, Moments::Covariance);
    let bytes: Vec<[u8; 8]> =
        state_of(&rows[..27], 3, Moments::Covariance).into_iter().map(f64::to_le_bytes).collect();
    let mut loaded: Vec<f64> = bytes.into_iter().map(f64::from_le_bytes).collect();
    rows[27..].chunks(3).for_each(|row| ensemble_add(&mut loaded, row).unwrap());
    assert_eq!(bits(&loaded), bits(&whole));
}

#[test]
fn correlations_of_stacked_vectors_are_those_of_their_parts() {
    let mut draws = Draws::of(7);
    // (x, -2 x, y) with a correlation of 0.9 between x and y.
    let pairs: Vec<[f64; 2]> = (0..4000).map(|_| draws.pair(0.9)).collect();
    let rows: Vec<f64> = pairs.iter().flat_map(|[x, y]| [*x, -2.0 * x, 1e6 + 3.0 * y]).collect();
    let state = state_of(&rows, 3, Moments::Covariance);
    let mut rho = [0.0; 9];
    ensemble_correlation(&mut rho, &state, 0..3, 0..3).unwrap();
    assert!((0..3).all(|i| (rho[4 * i] - 1.0).abs() < 1e-15));
    assert!((rho[1] + 1.0).abs() < 1e-15);
    // (1 - rho^2)/sqrt(N) = 0.003; four of them.
    assert!((rho[2] - 0.9).abs() < 0.012);
    let covariance = covariance_of(&state, 3);
    assert!((0..9).all(|at| {
        let (i, j) = (at / 3, at % 3);
        let expected = covariance[at] / (covariance[4 * i] * covariance[4 * j]).sqrt();
        (rho[at] - expected).abs() < 1e-14
    }));
    let mut block = [0.0; 2];
    ensemble_correlation(&mut block, &state, 0..2, 2..3).unwrap();
    assert_eq!(block, [rho[2], rho[5]]);
    let constant = state_of(&[1.0, 5.0, 2.0, 5.0], 2, Moments::Covariance);
    let mut out = [7.0; 4];
    assert_eq!(ensemble_correlation(&mut out, &constant, 0..2, 0..2), Err(Error::Singular));
    assert_eq!(out, [7.0; 4]);
}

#[test]
fn lengths_are_3_plus_2_v_and_3_plus_v_plus_the_triangle() {
    assert_eq!(ensemble_length(40, Moments::Variance), Ok(83));
    assert_eq!(ensemble_length(40, Moments::Covariance), Ok(3 + 40 + 820));
    assert_eq!(ensemble_length(0, Moments::Variance), Err(Error::Length));
    for moments in [Moments::Variance, Moments::Covariance] {
        assert_eq!(ensemble_length(usize::MAX, moments), Err(Error::Overflow));
        assert_eq!(ensemble_length(usize::MAX / 16, moments), Err(Error::Overflow));
    }
}

#[test]
fn refused_samples_leave_the_state_as_it_was() {
    let rows = samples(&mut Draws::of(8), 5, 3);
    for moments in [Moments::Variance, Moments::Covariance] {
        let mut state = state_of(&rows, 3, moments);
        let before = bits(&state);
        let mut refused = |sample: &[f64]| ensemble_add(&mut state, sample).unwrap_err();
        assert_eq!(refused(&[1.0, 2.0, f64::NAN]), Error::NotFinite);
        assert_eq!(refused(&[f64::NEG_INFINITY, 2.0, 3.0]), Error::NotFinite);
        assert_eq!(refused(&[1.0, -1e141, 3.0]), Error::Range);
        assert_eq!(refused(&[1.0, 2.0]), Error::Length);
        assert_eq!(refused(&[1.0, 2.0, 3.0, 4.0]), Error::Length);
        assert_eq!(refused(&[1.0, 2.0, 3.0, 4.0, 5.0, f64::INFINITY]), Error::NotFinite);
        let other = if moments == Moments::Variance { Moments::Covariance } else { Moments::Variance };
        let mut merged = |from: &[f64]| ensemble_merge(&mut state, from).unwrap_err();
        assert_eq!(merged(&state_of(&rows, 3, other)), Error::Length);
        assert_eq!(merged(&state_of(&rows[..4], 2, moments)), Error::Length);
        assert_eq!(merged(&[0.0; 9]), Error::Version);
        assert_eq!(bits(&state), before);
    }
}

#[test]
fn the_largest_samples_overflow_nothing() {
    let mut state = state_of(&[], 2, Moments::Covariance);
    for i in 0..100 {
        let sign = if i % 2 == 0 { 1.0 } else { -1.0 };
        ensemble_add(&mut state, &[sign * LARGEST_SAMPLE, -sign * LARGEST_SAMPLE]).unwrap();
    }
    let mut rho = [0.0; 4];
    ensemble_correlation(&mut rho, &state, 0..2, 0..2).unwrap();
    assert!(rho.iter().all(|rho| (rho.abs() - 1.0).abs() < 1e-15));
}

#[test]
fn states_that_nobody_made_are_refused() {
    let good = state_of(&[1.0, 2.0, 4.0, 3.0], 2, Moments::Covariance);
    let change = |at: usize, to: f64| {
        let mut state = good.clone();
        state[at] = to;
        state
    };
    let mut out = [7.0; 2];
    let mut refused = |state: &[f64]| -> Error {
        let error = ensemble_mean(&mut out, state).unwrap_err();
        let mut copy = state.to_vec();
        assert_eq!(ensemble_add(&mut copy, &[1.0, 2.0]), Err(error));
        assert_eq!(bits(&copy), bits(state));
        assert_eq!(ensemble_count(state), Err(error));
        error
    };
    assert_eq!(refused(&[]), Error::Length);
    assert_eq!(refused(&good[..2]), Error::Length);
    for state in [
        vec![0.0; good.len()],
        vec![f64::NAN; good.len()],
        vec![1.0; 1000],
        good[..good.len() - 1].to_vec(),
        change(0, -1.0),
        change(0, 0.5),
        change(0, 1e300),
        change(1, 3.0),
        change(1, f64::INFINITY),
        change(2, 2.0),
        change(2, 0.0),
    ] {
        assert_eq!(refused(&state), Error::Version, "{state:?}");
    }
    assert_eq!(out, [7.0; 2]);
}

#[test]
fn too_few_samples_and_places_that_are_not_kept_are_refused() {
    let none = state_of(&[], 2, Moments::Covariance);
    let one = state_of(&[1.0, 2.0], 2, Moments::Covariance);
    let mut two = [7.0; 2];
    assert_eq!(ensemble_mean(&mut two, &none), Err(Error::Samples));
    for call in [ensemble_deviation, ensemble_error_of_mean] {
        assert_eq!(call(&mut two, &one), Err(Error::Samples));
    }
    for call in [ensemble_covariance, ensemble_correlation] {
        let blocks = |state: &[f64], rows, columns, len: usize| -> Result<()> {
            let mut out = [7.0; 4];
            let answer = call(&mut out[..len], state, rows, columns);
            assert!(answer.is_ok() || out == [7.0; 4]);
            answer
        };
        assert_eq!(blocks(&one, 0..2, 0..2, 4), Err(Error::Samples));
        let full = state_of(&[1.0, 2.0, 4.0, 3.0], 2, Moments::Covariance);
        assert_eq!(blocks(&full, 0..3, 0..1, 3), Err(Error::Range));
        #[allow(clippy::reversed_empty_ranges)]
        let backwards = 2..1;
        assert_eq!(blocks(&full, backwards, 0..1, 0), Err(Error::Range));
        assert_eq!(blocks(&full, 0..2, 0..2, 3), Err(Error::Length));
        let variances = state_of(&[1.0, 2.0, 4.0, 3.0], 2, Moments::Variance);
        assert_eq!(blocks(&variances, 0..2, 0..2, 4), Err(Error::Choice));
        assert_eq!(blocks(&variances, 0..1, 1..2, 1), Err(Error::Choice));
    }
    assert_eq!(ensemble_mean(&mut two[..1], &one), Err(Error::Length));
    assert_eq!(two, [7.0; 2]);
    let mut state = [7.0; 6];
    assert_eq!(ensemble_init(&mut state, 2, Moments::Variance), Err(Error::Length));
    assert_eq!(state, [7.0; 6]);
}
