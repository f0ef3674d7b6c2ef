//! The best parameters against searches that take no steps.

use std::vec::Vec;

use super::likelihood::{Data, TRUTH};
use super::{Draws, largest, mean_and_deviation};
use crate::reference::variance as twin;
use crate::status::Error;
use crate::variance::bias::{Bias, Spectrum};
use crate::variance::fit::*;
use crate::variance::likelihood::BiasLikelihood;

const CASES: [u32; 5] = [FREE_B_G, FREE_P, FREE_F_NL, FREE_B_G | FREE_P, FREE_B_G | FREE_F_NL];
const BOTH: [Spectrum; 2] = [Spectrum::HaloHalo, Spectrum::HaloMatter];

fn all(at: &Bias) -> [f64; 3] {
    [at.b_g, at.p, at.f_nl]
}

fn is_free(mask: u32, number: usize) -> bool {
    mask >> number & 1 == 1
}

fn with(at: &Bias, number: usize, value: f64) -> Bias {
    let mut all = all(at);
    all[number] = value;
    Bias { b_g: all[0], p: all[1], f_nl: all[2], delta_c: at.delta_c }
}

#[test]
fn exact_data_return_the_truth_from_anywhere() {
    let mut draws = Draws::of(81);
    for spectrum in BOTH {
        let likelihood = Data::exact(&TRUTH, spectrum, 1.0).likelihood(spectrum);
        for mask in CASES {
            for _ in 0..100 {
                let mut start = TRUTH;
                let far = [
                    0.5 * 20_f64.powf(draws.unit()),
                    20.0 * draws.unit() - 10.0,
                    2000.0 * draws.unit() - 1000.0,
                ];
                for number in (0..3).filter(|&number| is_free(mask, number)) {
                    start = with(&start, number, far[number]);
                }
                let fit = fit_bias(&likelihood, &start, mask).unwrap();
                let (found, truth) = (all(&fit.value), all(&TRUTH));
                assert!(
                    (0..3).all(|i| (found[i] - truth[i]).abs() < 1e-9 * truth[i]),
                    "{spectrum:?} {mask}: {start:?} {fit:?}"
                );
                assert!(fit.chi_squared < 1e-18);
                assert_eq!(fit.degrees, 14 - u64::from(mask.count_ones()));
            }
        }
    }
}

#[test]
fn the_minimum_is_that_of_a_search() {
    // Every minimum found is at least as low as the lowest of a grid about it, and of a wide coarse one.
    let mut draws = Draws::of(82);
    for spectrum in BOTH {
        for _ in 0..10 {
            let likelihood = Data::noisy(&TRUTH, spectrum, 1.0, &mut draws).likelihood(spectrum);
            for mask in CASES {
                let fit = fit_bias(&likelihood, &TRUTH, mask).unwrap();
                assert_eq!(fit.chi_squared, likelihood.chi_squared(&fit.value).unwrap());
                for width in [0.01, 1.0, 20.0] {
                    for i in -10..=10 {
                        for j in -10..=10 {
                            let mut at = fit.value;
                            let steps = [f64::from(i), f64::from(j), f64::from(j)];
                            for number in (0..3).filter(|&number| is_free(mask, number)) {
                                let value =
                                    all(&at)[number] + 0.1 * width * steps[number] * fit.error[number];
                                at = with(&at, number, value);
                            }
                            if at.b_g > 0.0 {
                                let there = likelihood.chi_squared(&at).unwrap();
                                assert!(there >= fit.chi_squared * (1.0 - 1e-12), "{mask} {at:?} {fit:?}");
                            }
                        }
                    }
                }
            }
        }
    }
}

#[test]
fn the_covariance_is_the_inverse_fisher_matrix() {
    for spectrum in BOTH {
        let data = Data::exact(&TRUTH, spectrum, 1.0);
        let likelihood = data.likelihood(spectrum);
        for mask in CASES {
            let fit = fit_bias(&likelihood, &TRUTH, mask).unwrap();
            let free: Vec<usize> = (0..3).filter(|&number| is_free(mask, number)).collect();
            // Central differences are exact for a model of second order in each parameter, but for roundings of 1e-16/1e-4.
            let slopes: Vec<Vec<f64>> = free
                .iter()
                .map(|&number| {
                    let value = all(&TRUTH)[number];
                    let [up, down] = [1.0 + 1e-4, 1.0 - 1e-4]
                        .map(|by| data.model(&with(&TRUTH, number, value * by), spectrum));
                    up.iter().zip(down).map(|(up, down)| (up - down) / (2e-4 * value)).collect()
                })
                .collect();
            let a: Vec<f64> = (0..14).flat_map(|i| slopes.iter().map(move |slope| slope[i])).collect();
            let (_, covariance) = twin::least_squares(&a, &data.power, &data.sigma);
            let mut expected = [0.0; 9];
            for (i, row) in free.iter().enumerate() {
                for (j, column) in free.iter().enumerate() {
                    expected[3 * row + column] = covariance[i * free.len() + j];
                }
            }
            for at in 0..9 {
                let scale = (expected[at / 3 * 4] * expected[at % 3 * 4]).sqrt();
                assert!((fit.covariance[at] - expected[at]).abs() <= 1e-8 * scale, "{spectrum:?} {mask}");
            }
            assert!((0..3).all(|i| fit.error[i] == fit.covariance[4 * i].sqrt()));
        }
    }
}

#[test]
fn p_and_f_nl_are_one_parameter() {
    // (b_g - 1) f_NL with p = 1 and (b_g - p) 100 are the same b(k).
    let mut draws = Draws::of(83);
    for spectrum in BOTH {
        for _ in 0..20 {
            let likelihood = Data::noisy(&TRUTH, spectrum, 1.0, &mut draws).likelihood(spectrum);
            let by_p = fit_bias(&likelihood, &TRUTH, FREE_B_G | FREE_P).unwrap();
            let by_f = fit_bias(&likelihood, &TRUTH, FREE_B_G | FREE_F_NL).unwrap();
            // A minimum is found to a part of 1e-10 of its errors and the root of a rounding of chi^2.
            assert!((by_p.chi_squared - by_f.chi_squared).abs() < 1e-10 * by_f.chi_squared);
            assert!((by_p.value.b_g - by_f.value.b_g).abs() < 1e-6 * by_f.error[0]);
            let shift = (by_p.value.b_g - by_p.value.p) * 100.0;
            let scale = by_f.error[2] * (by_f.value.b_g - 1.0);
            assert!((shift - (by_f.value.b_g - 1.0) * by_f.value.f_nl).abs() < 1e-5 * scale);
            assert!((by_p.error[0] / by_f.error[0] - 1.0).abs() < 1e-6);
        }
    }
}

#[test]
fn pulls_have_unit_width_and_chi_squared_its_degrees() {
    const COUNT: usize = 2000;
    let mut draws = Draws::of(84);
    for (spectrum, mask) in BOTH.into_iter().flat_map(|spectrum| CASES.map(|mask| (spectrum, mask))) {
        let mut pulls = [const { Vec::new() }; 3];
        let mut chi_squared = Vec::new();
        for _ in 0..COUNT {
            // A tenth of the scatter, so that the model is a straight line over it.
            let fit = {
                let likelihood = Data::noisy(&TRUTH, spectrum, 0.1, &mut draws).likelihood(spectrum);
                fit_bias(&likelihood, &TRUTH, mask).unwrap()
            };
            chi_squared.push(fit.chi_squared);
            for number in (0..3).filter(|&number| is_free(mask, number)) {
                pulls[number].push((all(&fit.value)[number] - all(&TRUTH)[number]) / fit.error[number]);
            }
        }
        for pulls in pulls.iter().filter(|pulls| !pulls.is_empty()) {
            let (mean, width) = mean_and_deviation(pulls);
            // 1/sqrt(N) = 2.2% and 1/sqrt(2 N) = 1.6%; four of them, and curvature: 1% or so.
            assert!(mean.abs() < 0.1 && (width - 1.0).abs() < 0.073, "{spectrum:?} {mask}: {mean} {width}");
        }
        let (mean, deviation) = mean_and_deviation(&chi_squared);
        let degrees = f64::from(14 - mask.count_ones());
        let sigma = (2.0 * degrees).sqrt();
        assert!((mean - degrees).abs() < 4.0 * sigma / (COUNT as f64).sqrt(), "{mask}: {mean}");
        assert!((deviation / sigma - 1.0).abs() < 0.15, "{mask}: {deviation}");
    }
}

#[test]
fn fits_to_noisy_data_do_not_depend_on_the_start() {
    let mut draws = Draws::of(85);
    for _ in 0..50 {
        let likelihood =
            Data::noisy(&TRUTH, Spectrum::HaloHalo, 0.3, &mut draws).likelihood(Spectrum::HaloHalo);
        let near = fit_bias(&likelihood, &TRUTH, FREE_B_G | FREE_F_NL).unwrap();
        for _ in 0..10 {
            let start = Bias { b_g: 0.5 + 9.5 * draws.unit(), f_nl: 2000.0 * draws.unit() - 1000.0, ..TRUTH };
            let far = fit_bias(&likelihood, &start, FREE_B_G | FREE_F_NL).unwrap();
            let (a, b) = (all(&near.value), all(&far.value));
            assert!(largest([0, 2].map(|i| (a[i] - b[i]).abs() / near.error[i])) < 1e-6, "{near:?} {far:?}");
        }
    }
}

#[test]
fn what_no_data_tell_is_singular() {
    for spectrum in BOTH {
        let likelihood = Data::exact(&TRUTH, spectrum, 1.0).likelihood(spectrum);
        let none = Bias { f_nl: 0.0, ..TRUTH };
        assert_eq!(fit_bias(&likelihood, &none, FREE_P), Err(Error::Singular));
        assert_eq!(fit_bias(&likelihood, &none, FREE_B_G | FREE_P), Err(Error::Singular));
        let universal = Bias { p: TRUTH.b_g, ..TRUTH };
        assert_eq!(fit_bias(&likelihood, &universal, FREE_F_NL), Err(Error::Singular));
        assert_eq!(fit_bias(&BiasLikelihood::EMPTY, &TRUTH, FREE_B_G), Err(Error::Singular));
        // One bin for two parameters.
        let mut one = BiasLikelihood::EMPTY;
        let data = Data::exact(&TRUTH, spectrum, 1.0);
        let bin = crate::variance::likelihood::Spectra {
            power: &data.power[..1],
            linear: &data.linear[..1],
            alpha: &data.alpha[..1],
        };
        one.add(spectrum, bin, &data.sigma[..1]).unwrap();
        assert_eq!(fit_bias(&one, &TRUTH, FREE_B_G | FREE_F_NL), Err(Error::Singular));
        assert!(fit_bias(&one, &TRUTH, FREE_B_G).is_ok());
    }
}

#[test]
fn sets_of_parameters_that_cannot_be_free_are_refused() {
    let likelihood = Data::exact(&TRUTH, Spectrum::HaloHalo, 1.0).likelihood(Spectrum::HaloHalo);
    for mask in [0, FREE_P | FREE_F_NL, 7, 8, FREE_B_G | 8] {
        assert_eq!(fit_bias(&likelihood, &TRUTH, mask), Err(Error::Choice));
    }
    let refused = |at: Bias| fit_bias(&likelihood, &at, FREE_B_G).unwrap_err();
    assert_eq!(refused(Bias { f_nl: f64::NAN, ..TRUTH }), Error::NotFinite);
    assert_eq!(refused(Bias { delta_c: 0.0, ..TRUTH }), Error::Range);
    let mut wrong = likelihood;
    wrong.root[5][5] = f64::NAN;
    assert_eq!(fit_bias(&wrong, &TRUTH, FREE_B_G), Err(Error::NotFinite));
}
