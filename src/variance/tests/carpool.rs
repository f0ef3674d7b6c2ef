//! CARPool against its formula, and against the truth.

use std::vec;
use std::vec::Vec;

use super::{Draws, largest, mean_and_deviation, relative};
use crate::reference::built::Memory;
use crate::reference::variance as twin;
use crate::status::{Error, Result};
use crate::variance::carpool::*;
use crate::variance::control::{Beta, control_variate, control_variate_loss};

type Found = (Vec<f64>, Vec<f64>, Vec<f64>);

fn pooled(values: usize, of: &Carpool<'_>) -> Result<Found> {
    let controls = of.mu.len();
    let mut found = (vec![7.0; values], vec![7.0; values * values], vec![7.0; values * controls]);
    let mut memory = Memory::new(carpool_scratch(values, controls)?);
    let answer = carpool(&mut found.0, &mut found.1, &mut found.2, of, memory.get());
    let touched = [&found.0, &found.1, &found.2].into_iter().flatten().any(|&x| x != 7.0);
    assert!(answer.is_ok() || !touched);
    answer.map(|()| found)
}

/// Controls of mean 2 and correlated with one another; y = 1 + sums of them + noise, of unlike units.
fn matched(draws: &mut Draws, samples: usize, values: usize, controls: usize) -> (Vec<f64>, Vec<f64>) {
    let (mut y, mut c) = (Vec::new(), Vec::new());
    for _ in 0..samples {
        let common = draws.normal();
        let x: Vec<f64> = (0..controls).map(|_| common + draws.normal()).collect();
        for i in 0..values {
            let sum: f64 = x.iter().enumerate().map(|(j, x)| x / (1.0 + i.abs_diff(j) as f64)).sum();
            y.push(10_f64.powi(2 * i as i32) * (1.0 + sum + 0.5 * draws.normal()));
        }
        c.extend(x.iter().enumerate().map(|(j, x)| 10_f64.powi(j as i32) * (2.0 + x)));
    }
    (y, c)
}

fn truth(controls: usize) -> Vec<f64> {
    (0..controls).map(|j| 2.0 * 10_f64.powi(j as i32)).collect()
}

#[test]
fn carpool_is_its_formula() {
    let mut draws = Draws::of(121);
    for (samples, values, controls) in [(4, 1, 1), (10, 3, 2), (41, 6, 14), (60, 2, 20), (12, 5, 9)] {
        let (y, c) = matched(&mut draws, samples, values, controls);
        let mu = truth(controls);
        let cheap = matched(&mut draws, controls + 30, 1, controls).1;
        let of_mu: Vec<f64> = twin::covariance(&cheap, controls).iter().map(|x| x / 100.0).collect();
        let none = vec![0.0; controls * controls];
        for (covariance_of_mu, of_mu) in [(None, &none), (Some(&of_mu[..]), &of_mu)] {
            let of = Carpool { y: &y, c: &c, samples, mu: &mu, covariance_of_mu };
            let (mean, covariance, beta) = pooled(values, &of).unwrap();
            let expected = twin::carpool(&y, &c, &mu, of_mu, samples);
            // Condition numbers of correlation matrices of few samples: 1e4 at most; the twin's is that of all units too, 1e12 and more for 14.
            let tolerance = if controls < 5 { 1e-11 } else { 1e-7 };
            for i in 0..values {
                let sigma = expected.1[i * (values + 1)].sqrt();
                assert!((mean[i] - expected.0[i]).abs() < tolerance * sigma, "{samples} {controls}");
                for j in 0..values {
                    let scale = sigma * expected.1[j * (values + 1)].sqrt();
                    assert!(
                        (covariance[i * values + j] - expected.1[i * values + j]).abs() < tolerance * scale
                    );
                }
                for j in 0..controls {
                    // In units of scatter of y over that of c.
                    let unit = 10_f64.powi(2 * i as i32 - j as i32);
                    assert!((beta[i * controls + j] - expected.2[i * controls + j]).abs() < tolerance * unit);
                }
            }
        }
    }
}

#[test]
fn one_value_and_one_control_are_a_control_variate() {
    let mut draws = Draws::of(122);
    for samples in [4, 10, 41] {
        let (y, c) = matched(&mut draws, samples, 1, 1);
        for error in [0.0, 0.1, 3.0] {
            let of_mu = [error * error];
            let covariance_of_mu = (error > 0.0).then_some(&of_mu[..]);
            let of = Carpool { y: &y, c: &c, samples, mu: &[2.0], covariance_of_mu };
            let (mean, covariance, beta) = pooled(1, &of).unwrap();
            let single = control_variate(&y, &c, 2.0, error, Beta::Optimal).unwrap();
            assert!(relative(mean[0], single.mean) < 1e-13);
            assert!(relative(beta[0], single.beta) < 1e-13);
            assert!(relative(covariance[0].sqrt(), single.error) < 1e-13);
        }
    }
}

#[test]
fn means_are_unbiased_and_covariances_too() {
    const REALISATIONS: usize = 4000;
    let mut draws = Draws::of(123);
    let (samples, values, controls) = (12, 2, 4);
    let mu = truth(controls);
    let (mut shifts, mut squares, mut reported) =
        ([const { Vec::new() }; 2], [const { Vec::new() }; 3], [const { Vec::new() }; 3]);
    for _ in 0..REALISATIONS {
        let (y, c) = matched(&mut draws, samples, values, controls);
        let of = Carpool { y: &y, c: &c, samples, mu: &mu, covariance_of_mu: None };
        let (mean, covariance, _) = pooled(values, &of).unwrap();
        let apart = [mean[0] - 1.0, mean[1] / 100.0 - 1.0];
        (0..2).for_each(|i| shifts[i].push(apart[i]));
        for (at, (i, j)) in [(0, 0), (1, 1), (0, 1)].into_iter().enumerate() {
            squares[at].push(apart[i] * apart[j]);
            reported[at].push(covariance[2 * i + j] / 100_f64.powi((i + j) as i32));
        }
    }
    let root = (REALISATIONS as f64).sqrt();
    for shifts in &shifts {
        let (mean, deviation) = mean_and_deviation(shifts);
        assert!((mean / deviation * root).abs() < 4.0);
    }
    // Noise of 0.5 is left, and the loss of four coefficients.
    let known = 0.25 / samples as f64 * control_variate_loss(samples as u64, controls as u64).unwrap();
    for at in 0..3 {
        let ((square, of_square), (error, of_error)) =
            (mean_and_deviation(&squares[at]), mean_and_deviation(&reported[at]));
        let sigma = of_square.hypot(of_error) / root;
        assert!((square - error).abs() < 4.0 * sigma, "{at}: {square} {error}");
        if at < 2 {
            assert!((square - known).abs() < 4.0 * sigma, "{at}: {square} {known}");
        }
    }
}

#[test]
fn other_units_and_another_order_of_controls_change_nothing() {
    let mut draws = Draws::of(124);
    let (samples, values, controls) = (20, 2, 3);
    let (y, c) = matched(&mut draws, samples, values, controls);
    let mu = truth(controls);
    let plain = pooled(values, &Carpool { y: &y, c: &c, samples, mu: &mu, covariance_of_mu: None }).unwrap();
    let turn = |row: &[f64]| [1e9 * row[2], 1e-20 * row[0], row[1]];
    let turned: Vec<f64> = c.chunks(3).flat_map(turn).collect();
    let of = Carpool { y: &y, c: &turned, samples, mu: &turn(&mu), covariance_of_mu: None };
    let other = pooled(values, &of).unwrap();
    assert!(largest((0..2).map(|i| relative(other.0[i], plain.0[i]))) < 1e-12);
    assert!(largest((0..4).map(|i| relative(other.1[i], plain.1[i]))) < 1e-10);
}

#[test]
fn too_few_samples_and_controls_that_repeat_are_refused() {
    let mut draws = Draws::of(125);
    let (y, c) = matched(&mut draws, 10, 2, 3);
    let mu = truth(3);
    let good = Carpool { y: &y, c: &c, samples: 10, mu: &mu, covariance_of_mu: None };
    let refused = |of: &Carpool<'_>| pooled(2, of).unwrap_err();
    let few = |samples: usize| Carpool { y: &y[..2 * samples], c: &c[..3 * samples], samples, ..good };
    assert_eq!(refused(&few(5)), Error::Samples);
    assert!(pooled(2, &few(6)).is_ok());
    assert_eq!(refused(&Carpool { samples: 0, y: &[], c: &[], ..good }), Error::Samples);
    let twice: Vec<f64> = c.chunks(3).flat_map(|row| [row[0], row[1], -3.0 * row[0]]).collect();
    assert_eq!(refused(&Carpool { c: &twice, ..good }), Error::Singular);
    let sum: Vec<f64> = c.chunks(3).flat_map(|row| [row[0], row[1], row[0] + row[1]]).collect();
    assert_eq!(refused(&Carpool { c: &sum, ..good }), Error::Singular);
    let constant: Vec<f64> = c.chunks(3).flat_map(|row| [row[0], row[1], 5.0]).collect();
    assert_eq!(refused(&Carpool { c: &constant, ..good }), Error::Singular);
    assert_eq!(refused(&Carpool { y: &y[1..], ..good }), Error::Length);
    assert_eq!(refused(&Carpool { c: &c[1..], ..good }), Error::Length);
    assert_eq!(refused(&Carpool { mu: &[], ..good }), Error::Length);
    assert_eq!(refused(&Carpool { covariance_of_mu: Some(&[1.0; 8]), ..good }), Error::Length);
    let skewed = [1.0, 0.5, 0.0, 0.4, 1.0, 0.0, 0.0, 0.0, 1.0];
    assert_eq!(refused(&Carpool { covariance_of_mu: Some(&skewed), ..good }), Error::Range);
    for (value, error) in [(f64::NAN, Error::NotFinite), (1e141, Error::Range)] {
        let mut hole = y.clone();
        hole[3] = value;
        assert_eq!(refused(&Carpool { y: &hole, ..good }), error);
        let mut hole = c.clone();
        hole[3] = value;
        assert_eq!(refused(&Carpool { c: &hole, ..good }), error);
        assert_eq!(refused(&Carpool { mu: &[2.0, value, 200.0], ..good }), error);
    }
    let (mut mean, mut covariance, mut beta) = ([7.0; 2], [7.0; 4], [7.0; 6]);
    let answer = carpool(&mut mean, &mut covariance, &mut beta, &good, &mut []);
    assert_eq!(answer, Err(Error::Scratch));
    let answer = carpool(&mut mean, &mut covariance, &mut beta[1..], &good, &mut []);
    assert_eq!(answer, Err(Error::Length));
    assert_eq!((mean, covariance, beta), ([7.0; 2], [7.0; 4], [7.0; 6]));
    assert_eq!(carpool_scratch(usize::MAX, 2), Err(Error::Overflow));
}
