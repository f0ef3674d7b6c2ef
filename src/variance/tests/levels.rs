//! What covariances of few simulations do to fits, by drawing them.

use std::vec;
use std::vec::Vec;

use super::Draws;
use crate::reference::variance as twin;
use crate::status::Error;
use crate::variance::levels::*;

/// <(x - truth)^2> over <variance that the fit reports> for a line through p values of unit covariance that is measured from N samples; and the
/// mean of the first element of the inverse covariance, both with Hartlap's factor.
fn drawn(estimates: usize, values: usize, realisations: usize) -> [f64; 2] {
    let mut draws = Draws::of(estimates as u64);
    let line: Vec<f64> = (0..values).flat_map(|i| [1.0, i as f64 / values as f64 - 0.5]).collect();
    let turned = twin::transpose(&line, 2);
    let hartlap = hartlap_factor(estimates as u64, values as u64).unwrap();
    let (mut square, mut reported, mut precision_mean) = (0.0, 0.0, 0.0);
    for _ in 0..realisations {
        let mut samples = vec![0.0; estimates * values];
        samples.iter_mut().for_each(|x| *x = draws.normal());
        let mut precision = twin::inverse(&twin::covariance(&samples, values), values);
        precision.iter_mut().for_each(|x| *x *= hartlap);
        precision_mean += precision[0] / realisations as f64;
        let data: Vec<f64> = (0..values).map(|_| draws.normal()).collect();
        let weighted = twin::product(&turned, &precision, values);
        let covariance = twin::inverse(&twin::product(&weighted, &line, values), 2);
        let found = twin::product(&covariance, &twin::product(&weighted, &data, values), 2);
        // Both parameters in units of their true errors: 1/p and 12/p to order 1/p^2.
        square += found[0] * found[0] + found[1] * found[1] / 12.0;
        reported += covariance[0] + covariance[3] / 12.0;
    }
    [square / reported, precision_mean]
}

/// The same ratio from the distribution of Wishart matrices: with n = N - 1, the inverse Fisher matrix has n - p + q degrees of freedom, and the
/// variance of the parameters is (n - 1)/(n - p + q - 1) times the true one.
fn exact(estimates: u64, values: u64, parameters: u64) -> f64 {
    let [n, p, q] = [estimates - 1, values, parameters].map(|x| x as f64);
    (n - 1.0) * (n - p - 1.0) / ((n - p + q - 1.0) * (n - p + q))
}

#[test]
fn percival_is_what_hartlap_leaves_to_be_paid_to_second_order() {
    for (estimates, values) in [(100, 14), (1000, 14), (1000, 100), (100_000, 300)] {
        for parameters in [1, 2, 5] {
            let percival = percival_factor(estimates, values, parameters).unwrap();
            let order = (values as f64 / estimates as f64).powi(2);
            assert!((percival - exact(estimates, values, parameters)).abs() < order);
        }
    }
    // 41 simulations of 14 bins: variances 3% too large, errors 1.6%.
    assert!((percival_factor(41, 14, 2).unwrap() / exact(41, 14, 2) - 1.0).abs() < 0.033);
}

#[test]
fn drawn_covariances_cost_what_the_factors_say() {
    const REALISATIONS: usize = 4000;
    for (estimates, values) in [(41, 14), (120, 14)] {
        let [ratio, precision] = drawn(estimates, values, REALISATIONS);
        let expected = exact(estimates as u64, values as u64, 2);
        // Two parameters each: sqrt(2/8000) = 1.6%; four of them with the scatter of what is reported.
        assert!((ratio / expected - 1.0).abs() < 0.065, "{ratio} for {expected}");
        // The precision of one value has a relative variance of 2/(N - p - 4); four sigma of the mean.
        let sigma = (2.0 / (estimates - values - 4) as f64 / REALISATIONS as f64).sqrt();
        assert!((precision - 1.0).abs() < 4.0 * sigma, "{precision}");
    }
}

#[test]
fn levels_invert_the_probabilities_of_normal_parameters() {
    for i in 1..200 {
        let probability = f64::from(i) / 200.0;
        let one = delta_chi_squared(probability, 1).unwrap();
        assert!((libm::erf((0.5 * one).sqrt()) - probability).abs() < 1e-15);
        let two = delta_chi_squared(probability, 2).unwrap();
        assert!((1.0 - (-0.5 * two).exp() - probability).abs() < 1e-15);
        assert!(two > one);
    }
    // Far out and close in too.
    for missing in [0.5_f64.powi(20), 0.5_f64.powi(52)] {
        let far = delta_chi_squared(1.0 - missing, 1).unwrap();
        assert!((libm::erfc((0.5 * far).sqrt()) / missing - 1.0).abs() < 1e-12, "{far}");
    }
    let tiny = delta_chi_squared(1e-9, 1).unwrap().sqrt();
    // erf(x/sqrt 2) = x sqrt(2/pi); 1 - probability is rounded to 1e-16 of 1, 1e-7 of this.
    assert!((tiny / (1e-9 * (0.5 * core::f64::consts::PI).sqrt()) - 1.0).abs() < 2e-7);
    for wrong in [0.0, 1.0, -0.1, 1.1] {
        assert_eq!(delta_chi_squared(wrong, 1), Err(Error::Range));
    }
    assert_eq!(delta_chi_squared(f64::NAN, 1), Err(Error::NotFinite));
    assert_eq!(delta_chi_squared(0.5, 0), Err(Error::Range));
}

#[test]
fn factors_of_nothing_are_refused() {
    assert_eq!(hartlap_factor(41, 0), Err(Error::Range));
    assert_eq!(hartlap_factor(0, 14), Err(Error::Samples));
    assert_eq!(hartlap_factor(u64::MAX, u64::MAX), Err(Error::Samples));
    assert_eq!(hartlap_factor(17, 14), Ok(1.0 / 16.0));
    assert_eq!(percival_factor(41, 14, 0), Err(Error::Range));
    assert_eq!(percival_factor(41, 14, 15), Err(Error::Range));
    assert!(percival_factor(19, 14, 14).is_ok());
}
