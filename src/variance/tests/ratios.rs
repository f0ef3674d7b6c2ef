//! Pairs, ratios and differences of means.

use super::{Draws, mean_and_deviation};
use crate::status::Error;
use crate::variance::pairs::*;
use crate::variance::ratios::*;

#[test]
fn a_pair_is_one_estimate_whose_scatter_counts_root_2() {
    // Two independent halves: their average scatters by 1/sqrt 2, per simulation by 1.
    let mut draws = Draws::of(41);
    let original: [f64; 20_000] = core::array::from_fn(|_| draws.normal());
    let inverted: [f64; 20_000] = core::array::from_fn(|_| draws.normal());
    let mut pairs = [0.0; 20_000];
    pair_average(&mut pairs, &original, &inverted).unwrap();
    assert!((0..20_000).all(|i| (pairs[i] - (original[i] + inverted[i]) / 2.0).abs() < 1e-15));
    let (mut sigma, mut error) = ([0.0], [0.0]);
    let deviation = mean_and_deviation(&pairs).1;
    sigma_per_simulation(&mut sigma, &mut error, &[deviation], 20_000, 2).unwrap();
    // 1/sqrt(2 N) = 0.5%, and it is the error that is returned.
    assert!((sigma[0] - 1.0).abs() < 4.0 * error[0]);
    assert!((error[0] / sigma[0] - 0.005).abs() < 1e-6);
    // Halves that linear theory makes equal: sqrt 2 sigma_Normal, exactly.
    pair_average(&mut pairs, &original, &original).unwrap();
    assert_eq!(pairs, original);
    let normal = mean_and_deviation(&original).1;
    sigma_per_simulation(&mut sigma, &mut error, &[normal], 41, 2).unwrap();
    assert!((sigma[0] / normal - 2_f64.sqrt()).abs() < 1e-15);
    sigma_per_simulation(&mut sigma, &mut error, &[normal], 41, 1).unwrap();
    assert_eq!(sigma[0], normal);
    // No overflow on the way.
    pair_average(&mut sigma, &[f64::MAX], &[f64::MAX]).unwrap();
    assert_eq!(sigma[0], f64::MAX);
}

#[test]
fn deviations_scatter_by_eq_errerr() {
    let mut draws = Draws::of(42);
    for estimates in [2_usize, 10, 41] {
        let mut sample = std::vec![0.0; estimates];
        let deviations: [f64; 4000] = core::array::from_fn(|_| {
            sample.iter_mut().for_each(|x| *x = draws.normal());
            mean_and_deviation(&sample).1
        });
        let (_, scatter) = mean_and_deviation(&deviations);
        let expected = relative_error_of_deviation(estimates as u64).unwrap();
        // Leading order in 1/(N - 1): a deviation of two scatters by 0.603 for 0.707. Sampling error 1.1%; three of them.
        let next = 0.25 / (estimates - 1) as f64;
        assert!((scatter / expected - 1.0).abs() < next + 0.034, "{estimates}: {scatter} {expected}");
    }
}

/// Two means of given errors and correlation, drawn.
fn drawn(draws: &mut Draws, means: [f64; 2], errors: [f64; 2], rho: f64) -> [f64; 2] {
    let [x, y] = draws.pair(rho);
    [means[0] + errors[0] * x, means[1] + errors[1] * y]
}

#[test]
fn errors_of_ratios_and_differences_are_their_scatter() {
    let mut draws = Draws::of(43);
    for (means, errors, rho) in [
        ([2.0, 3.0], [0.01, 0.03], 0.0),
        ([2.0, -3.0], [0.02, 0.01], 0.8),
        ([0.0, 5.0], [0.1, 0.05], 0.5),
        ([4.0, 4.0], [0.03, 0.03], -0.7),
    ] {
        let above = Means { mean: &means[..1], error: &errors[..1] };
        let below = Means { mean: &means[1..], error: &errors[1..] };
        let (mut ratio, mut error) = ([0.0], [0.0]);
        ratio_of_means(&mut ratio, &mut error, above, below, Some(&[rho])).unwrap();
        assert_eq!(ratio[0], means[0] / means[1]);
        let ratios: [f64; 20_000] = core::array::from_fn(|_| {
            let [a, b] = drawn(&mut draws, means, errors, rho);
            a / b
        });
        // Sampling error 0.5%, second order 1e-4; four of them.
        let (_, scatter) = mean_and_deviation(&ratios);
        assert!((scatter / error[0] - 1.0).abs() < 0.02, "{scatter} {}", error[0]);
        let mut difference = [0.0];
        difference_of_means(&mut difference, &mut error, above, below, Some(&[rho]), &[0.5]).unwrap();
        assert_eq!(difference[0], (means[0] - means[1]) / 0.5);
        let differences: [f64; 20_000] = core::array::from_fn(|_| {
            let [a, b] = drawn(&mut draws, means, errors, rho);
            (a - b) / 0.5
        });
        let (_, scatter) = mean_and_deviation(&differences);
        assert!((scatter / error[0] - 1.0).abs() < 0.02, "{scatter} {}", error[0]);
    }
}

#[test]
fn what_is_common_to_both_cancels() {
    let means = Means { mean: &[3.0, 5.0], error: &[0.3, 0.2] };
    let (mut value, mut error) = ([0.0; 2], [0.0; 2]);
    ratio_of_means(&mut value, &mut error, means, means, Some(&[1.0; 2])).unwrap();
    assert_eq!((value, error), ([1.0; 2], [0.0; 2]));
    difference_of_means(&mut value, &mut error, means, means, Some(&[1.0; 2]), &[1.0; 2]).unwrap();
    assert_eq!((value, error), ([0.0; 2], [0.0; 2]));
    // None is a correlation of zero.
    let mut independent = [0.0; 2];
    ratio_of_means(&mut value, &mut independent, means, means, None).unwrap();
    ratio_of_means(&mut value, &mut error, means, means, Some(&[0.0; 2])).unwrap();
    assert_eq!(independent, error);
    assert!((error[0] - 0.1 * 2_f64.sqrt()).abs() < 1e-15);
}

#[test]
fn means_that_are_none_are_refused() {
    let one = [1.0; 2];
    let good = Means { mean: &one, error: &one };
    let (mut value, mut error) = ([7.0; 2], [7.0; 2]);
    let mut ratio =
        |above, below, rho| ratio_of_means(&mut value, &mut error, above, below, rho).unwrap_err();
    assert_eq!(ratio(Means { mean: &one[1..], ..good }, good, None), Error::Length);
    assert_eq!(ratio(good, Means { error: &one[1..], ..good }, None), Error::Length);
    assert_eq!(ratio(good, good, Some(&one[1..])), Error::Length);
    assert_eq!(ratio(good, Means { mean: &[1.0, 0.0], ..good }, None), Error::Range);
    assert_eq!(ratio(good, Means { error: &[1.0, -1.0], ..good }, None), Error::Range);
    assert_eq!(ratio(good, Means { mean: &[1.0, f64::NAN], ..good }, None), Error::NotFinite);
    assert_eq!(ratio(good, good, Some(&[1.0, 1.1])), Error::Range);
    assert_eq!(ratio(good, good, Some(&[1.0, f64::NAN])), Error::NotFinite);
    assert_eq!(
        ratio(Means { mean: &[1.0, 1e300], ..good }, Means { mean: &[1.0, 1e-300], ..good }, None),
        Error::Range
    );
    let mut difference =
        |rho, sigma: &[f64]| difference_of_means(&mut value, &mut error, good, good, rho, sigma).unwrap_err();
    assert_eq!(difference(None, &one[1..]), Error::Length);
    assert_eq!(difference(None, &[1.0, 0.0]), Error::Range);
    assert_eq!(difference(None, &[1.0, f64::NAN]), Error::NotFinite);
    assert_eq!(difference(Some(&[1.0, -1.1]), &one), Error::Range);
    assert_eq!((value, error), ([7.0; 2], [7.0; 2]));

    let mut out = [7.0; 2];
    assert_eq!(pair_average(&mut out, &one, &one[1..]), Err(Error::Length));
    assert_eq!(pair_average(&mut out, &one, &[1.0, f64::NAN]), Err(Error::NotFinite));
    assert_eq!(relative_error_of_deviation(1), Err(Error::Samples));
    let mut sigma = |deviation: &[f64], estimates, simulations| {
        sigma_per_simulation(&mut out, &mut error, deviation, estimates, simulations).unwrap_err()
    };
    assert_eq!(sigma(&one[1..], 41, 2), Error::Length);
    assert_eq!(sigma(&one, 1, 2), Error::Samples);
    assert_eq!(sigma(&one, 41, 0), Error::Range);
    assert_eq!(sigma(&[1.0, -1.0], 41, 2), Error::Range);
    assert_eq!(sigma(&[1.0, f64::NAN], 41, 2), Error::NotFinite);
    assert_eq!(sigma(&[1.0, f64::MAX], 41, 2), Error::Range);
    assert_eq!((out, error), ([7.0; 2], [7.0; 2]));
}
