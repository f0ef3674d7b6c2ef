//! Control variates: unbiased, and as exact as they say.

use std::vec;
use std::vec::Vec;

use super::{Draws, mean_and_deviation, relative};
use crate::reference::built::Memory;
use crate::status::Error;
use crate::variance::control::*;
use crate::variance::matched::matched_difference;

/// y = 5 + 3 x and c = 2 + 0.5 x' with a correlation of x and x'.
fn matched(draws: &mut Draws, count: usize, rho: f64) -> (Vec<f64>, Vec<f64>) {
    (0..count).map(|_| draws.pair(rho)).map(|[x, y]| (5.0 + 3.0 * x, 2.0 + 0.5 * y)).unzip()
}

#[test]
fn a_coefficient_of_one_is_the_matched_difference() {
    let mut draws = Draws::of(111);
    for count in [2, 10, 41] {
        let (y, c) = matched(&mut draws, count, 0.9);
        let found = control_variate(&y, &c, 0.0, 0.0, Beta::Given(1.0)).unwrap();
        let difference = matched_difference(&y, &c).unwrap();
        assert_eq!((found.mean, found.correlation), (difference.mean, difference.correlation));
        assert!(relative(found.deviation, difference.deviation) < 1e-13);
        assert!(relative(found.error, difference.error_of_mean) < 1e-13);
    }
}

#[test]
fn no_coefficient_leaves_less_than_the_optimal_one() {
    let mut draws = Draws::of(112);
    for count in [4, 10, 41] {
        let (y, c) = matched(&mut draws, count, 0.8);
        let left = |beta| {
            let degrees = if beta == Beta::Optimal { count - 2 } else { count - 1 };
            let found = control_variate(&y, &c, 2.0, 0.0, beta).unwrap();
            (found.deviation * found.deviation * degrees as f64, found)
        };
        let (least, found) = left(Beta::Optimal);
        let covariance = crate::reference::variance::cross_covariance(&y, &c, [1, 1])[0];
        let variance = crate::reference::variance::covariance(&c, 1)[0];
        assert!(relative(found.beta, covariance / variance) < 1e-13);
        for i in -50..=50 {
            assert!(left(Beta::Given(found.beta + 0.1 * f64::from(i))).0 >= least * (1.0 - 1e-13));
        }
        // Parabola: sqrt(1 - rho^2) of the scatter of y.
        let of_y = mean_and_deviation(&y).1;
        let rho = found.correlation;
        assert!(relative(least, of_y * of_y * (count - 1) as f64 * (1.0 - rho * rho)) < 1e-12);
    }
}

/// (<x - truth>, <(x - truth)^2>, <error^2>) over realisations, and sigma of the ratio of the last two.
fn over_realisations(
    draws: &mut Draws,
    count: usize,
    rho: f64,
    error: f64,
    beta: Beta,
) -> (f64, f64, f64, f64) {
    const REALISATIONS: usize = 8000;
    let (mut shifts, mut squares, mut errors) = (Vec::new(), Vec::new(), Vec::new());
    for _ in 0..REALISATIONS {
        let (y, c) = matched(draws, count, rho);
        let mu = 2.0 + error * draws.normal();
        let found = control_variate(&y, &c, mu, error, beta).unwrap();
        shifts.push(found.mean - 5.0);
        squares.push((found.mean - 5.0).powi(2));
        errors.push(found.error.powi(2));
    }
    let root = (REALISATIONS as f64).sqrt();
    let ((mean, deviation), (square, of_square), (error, of_error)) =
        (mean_and_deviation(&shifts), mean_and_deviation(&squares), mean_and_deviation(&errors));
    (mean / deviation * root, square, error, (of_square / square).hypot(of_error / error) / root)
}

#[test]
fn the_mean_is_unbiased_and_its_squared_error_too() {
    let mut draws = Draws::of(113);
    for count in [5, 10, 41] {
        for rho in [0.0, 0.76, 0.97] {
            for beta in [Beta::Optimal, Beta::Given(6.0), Beta::Given(-1.0)] {
                let (mean, square, error, sigma) = over_realisations(&mut draws, count, rho, 0.0, beta);
                assert!(mean.abs() < 4.0, "{count} {rho} {beta:?}: {mean}");
                let deviate = (square / error - 1.0) / sigma;
                assert!(deviate.abs() < 4.0, "{count} {rho} {beta:?}: {} {deviate}", square / error);
            }
        }
    }
}

#[test]
fn an_error_of_mu_is_counted() {
    let mut draws = Draws::of(114);
    let count = 10;
    let of_mean = 0.5 / (count as f64).sqrt();
    for rho in [0.5, 0.97] {
        // Better, as well and worse known than the mean of c.
        for error in [0.1 * of_mean, of_mean, 10.0 * of_mean] {
            let (mean, square, reported, sigma) =
                over_realisations(&mut draws, count, rho, error, Beta::Given(6.0 * rho));
            assert!(mean.abs() < 4.0);
            assert!(((square / reported - 1.0) / sigma).abs() < 4.0, "{rho} {error}: {}", square / reported);
            let (mean, square, reported, sigma) =
                over_realisations(&mut draws, count, rho, error, Beta::Optimal);
            assert!(mean.abs() < 4.0);
            // Where shrinking leaves no slope, two degrees of freedom and the slope's error are counted for one and none: (N - 2)/(N - 1) and (N - 1)/N.
            let ratio = square / reported;
            assert!(ratio < 1.0 + 4.0 * sigma && ratio > 0.8 - 4.0 * sigma, "{rho} {error}: {ratio}");
        }
    }
}

#[test]
fn a_mu_that_nobody_knows_costs_nothing() {
    let (y, c) = matched(&mut Draws::of(115), 10, 0.97);
    let (mean, deviation) = mean_and_deviation(&y);
    for mu in [2.0, 1e6] {
        let found = control_variate(&y, &c, mu, 1e9, Beta::Optimal).unwrap();
        assert!((found.mean - mean).abs() < 1e-3);
        assert!(
            relative(found.error, deviation / 10_f64.sqrt()) < 0.07,
            "of N - 2 degrees of freedom for N - 1"
        );
    }
}

#[test]
fn estimating_the_coefficient_costs_one_estimate_in_n() {
    let mut draws = Draws::of(116);
    for count in [6, 10, 20] {
        let (_, square, _, sigma) = over_realisations(&mut draws, count, 0.9, 0.0, Beta::Optimal);
        let known = 9.0 * (1.0 - 0.81) / count as f64;
        let loss = control_variate_loss(count as u64, 1).unwrap();
        assert!((square / known / loss - 1.0).abs() < 4.0 * sigma, "{count}: {} {loss}", square / known);
    }
    assert_eq!(control_variate_loss(41, 0), Ok(1.0));
    assert_eq!(control_variate_loss(10, 7), Ok(8.0));
    assert_eq!(control_variate_loss(10, 8), Err(Error::Samples));
    assert_eq!(control_variate_loss(10, u64::MAX), Err(Error::Samples));
}

#[test]
fn the_gain_is_that_of_the_moments() {
    let mut draws = Draws::of(117);
    let (y, c) = matched(&mut draws, 41, 0.9);
    let difference = matched_difference(&y, &c).unwrap();
    for beta in [-2.0, 0.0, 1.0, 5.4] {
        let found = control_variate(&y, &c, 2.0, 0.0, Beta::Given(beta)).unwrap();
        let (of_y, of_c) = (difference.deviation_first, difference.deviation_second);
        let gain = control_variate_gain(of_y, of_c, difference.correlation, beta).unwrap();
        assert!(relative(found.gain, gain) < 1e-12);
    }
    assert_eq!(control_variate_gain(3.0, 0.5, 0.9, 0.0), Ok(1.0));
    let best = control_variate_gain(3.0, 0.5, 0.9, 0.9 * 6.0).unwrap();
    assert!(relative(best, 1.0 / (1.0 - 0.81)) < 1e-14);
    let same =
        control_variate(&[1.0, 2.0, 4.0, 8.0], &[1.0, 2.0, 4.0, 8.0], 3.0, 0.0, Beta::Given(1.0)).unwrap();
    assert_eq!((same.mean, same.error, same.gain), (3.0, 0.0, f64::MAX));
    for wrong in [
        control_variate_gain(0.0, 1.0, 0.5, 1.0),
        control_variate_gain(1.0, -1.0, 0.5, 1.0),
        control_variate_gain(1.0, 1.0, 2.0, 1.0),
    ] {
        assert_eq!(wrong, Err(Error::Range));
    }
    assert_eq!(control_variate_gain(1.0, 1.0, 0.5, f64::NAN), Err(Error::NotFinite));
}

#[test]
fn columns_are_control_variates_of_their_own_bit_for_bit() {
    let mut draws = Draws::of(118);
    let (rows, width) = (12, 5);
    let mut tables = [vec![0.0; rows * width], vec![0.0; rows * width]];
    for at in 0..rows * width {
        [tables[0][at], tables[1][at]] = draws.pair(0.8);
    }
    let [y, c] = tables;
    let (mu, error) = ([0.1, 0.0, -0.1, 0.2, 0.3], [0.0, 0.1, 0.2, 0.0, 0.05]);
    let mut memory = Memory::new(control_variates_scratch(rows).unwrap());
    let nothing = control_variate(&[1.0, 2.0], &[2.0, 1.0], 0.0, 0.0, Beta::Given(0.0)).unwrap();
    for beta in [Beta::Optimal, Beta::Given(0.7)] {
        for error in [None, Some(&error[..])] {
            let mut found = [nothing; 5];
            control_variates(&mut found, &y, &c, &mu, error, beta, memory.get()).unwrap();
            for i in 0..width {
                let column =
                    |table: &[f64]| table.iter().skip(i).step_by(width).copied().collect::<Vec<f64>>();
                let error = error.map_or(0.0, |error| error[i]);
                assert_eq!(found[i], control_variate(&column(&y), &column(&c), mu[i], error, beta).unwrap());
            }
        }
    }
    let mut found = [nothing; 5];
    let mut refused = |y: &[f64], c: &[f64], mu: &[f64], error, scratch: &mut [u8]| {
        control_variates(&mut found, y, c, mu, error, Beta::Optimal, scratch).unwrap_err()
    };
    assert_eq!(refused(&y[1..], &c, &mu, None, memory.get()), Error::Length);
    assert_eq!(refused(&y, &c[5..], &mu, None, memory.get()), Error::Length);
    assert_eq!(refused(&y, &c, &mu[1..], None, memory.get()), Error::Length);
    assert_eq!(refused(&y, &c, &mu, Some(&mu[1..]), memory.get()), Error::Length);
    assert_eq!(refused(&y, &c, &mu, None, &mut []), Error::Scratch);
    // Of the last column alone.
    let mut hole = y.clone();
    hole[14] = f64::NAN;
    assert_eq!(refused(&hole, &c, &mu, None, memory.get()), Error::NotFinite);
    assert_eq!(found, [nothing; 5]);
}

#[test]
fn what_controls_nothing_is_refused() {
    let four = [1.0, 2.0, 4.0, 8.0];
    let refused = |y: &[f64], c: &[f64], mu, error, beta| control_variate(y, c, mu, error, beta).unwrap_err();
    assert_eq!(refused(&four, &four[1..], 0.0, 0.0, Beta::Optimal), Error::Length);
    assert_eq!(refused(&four[1..], &four[1..], 0.0, 0.0, Beta::Optimal), Error::Samples);
    assert_eq!(refused(&four[3..], &four[3..], 0.0, 0.0, Beta::Given(1.0)), Error::Samples);
    assert_eq!(refused(&four, &[3.0; 4], 0.0, 0.0, Beta::Optimal), Error::Singular);
    assert_eq!(refused(&[3.0; 4], &four, 0.0, 0.0, Beta::Given(1.0)), Error::Singular);
    assert_eq!(refused(&four, &four, f64::NAN, 0.0, Beta::Optimal), Error::NotFinite);
    assert_eq!(refused(&four, &four, 0.0, f64::NAN, Beta::Optimal), Error::NotFinite);
    assert_eq!(refused(&four, &four, 0.0, 0.0, Beta::Given(f64::NAN)), Error::NotFinite);
    assert_eq!(refused(&four, &four, 0.0, -1.0, Beta::Optimal), Error::Range);
    assert_eq!(refused(&four, &four, 1e300, 0.0, Beta::Given(1e300)), Error::Range);
}
