//! The numbers that Avila & Adame 2022 print, as far as they can be recomputed, with their misprints mended.

use crate::status::Error;
use crate::variance::control::control_variate_gain;
use crate::variance::levels::{delta_chi_squared, hartlap_factor, percival_factor};
use crate::variance::matched::{Estimate, difference_sigma, effective_volume, universality};
use crate::variance::models::{
    Suppression, continuum_modes, lattice_modes, sigma_gaussian, sigma_suppressed,
};
use crate::variance::pairs::relative_error_of_deviation;

/// (s100, s0, rho, sigma of the difference with rho 0.005 higher and lower).
const CORRELATION: [([f64; 3], [f64; 2]); 6] = [
    ([60.5, 47.0, 0.97], [18.0, 19.5]),
    ([12.1, 11.8, 0.76], [8.2, 8.4]),
    ([9.3, 9.5, 0.85], [5.1, 5.2]),
    ([50.7, 40.3, 0.97], [14.5, 15.9]),
    ([12.4, 12.0, 0.76], [8.4, 8.6]),
    ([8.2, 8.3, 0.85], [4.4, 4.6]),
];
/// What the paper prints for them.
const PRINTED: [f64; 6] = [18.1, 8.3, 5.2, 14.6, 8.4, 4.6];

#[test]
fn the_scatter_of_differences_is_that_of_tab_rho() {
    for (([first, second, rho], [low, high]), printed) in CORRELATION.into_iter().zip(PRINTED) {
        let [from, to] = [0.005, -0.005].map(|shift| difference_sigma(first, second, rho + shift).unwrap());
        // Bounds have one decimal, some of them rounded outwards.
        assert!((from - low).abs() < 0.055 && (to - high).abs() < 0.055, "{from} to {to}");
        assert!((low..=high).contains(&printed));
    }
}

#[test]
fn effective_volumes_are_those_of_tab_rho_with_69_for_89_and_63_for_3() {
    let cells = [
        (60.5, [(12.1, 25.0), (13.2, 21.0), (18.1, 11.0), (8.3, 53.0), (7.3, 69.0)]),
        (50.7, [(12.4, 17.0), (11.7, 19.0), (14.6, 12.0), (8.4, 36.0), (6.4, 63.0)]),
    ];
    for (reference, cells) in cells {
        for (sigma, gain) in cells {
            assert_eq!(effective_volume(reference, 1, sigma, 1).unwrap().round(), gain);
        }
    }
    // A pair costs two: the row of "x sqrt 2" from the row of pairs.
    let per_pair = effective_volume(60.5, 1, 5.2, 2).unwrap();
    let per_simulation = effective_volume(60.5, 1, 5.2 * 2_f64.sqrt(), 1).unwrap();
    assert!((per_pair / per_simulation - 1.0).abs() < 1e-14);
}

#[test]
fn the_best_beta_gains_1_63_for_normal_and_1_11_for_fixed() {
    for ([first, second, rho], further) in [([60.5, 47.0, 0.97], 1.63), ([12.1, 11.8, 0.76], 1.11)] {
        let gain = |beta| control_variate_gain(first, second, rho, beta).unwrap();
        let best = gain(rho * first / second);
        assert!((best * (1.0 - rho * rho) - 1.0).abs() < 1e-12);
        assert_eq!((100.0 * best / gain(1.0)).round() / 100.0, further);
    }
}

#[test]
fn p_follows_from_f_nl_measured_as_if_p_were_one() {
    for (measured, p) in [(109.2, 0.8786), (107.6, 0.8997)] {
        let of = |error| Estimate { value: measured, error };
        let b_g = Estimate { value: 2.32, error: 0.0 };
        let found = universality(b_g, of(5.2), 0.0, 100.0).unwrap();
        assert!((found.value - p).abs() < 5e-5);
        assert!((found.error - 1.32 * 0.052).abs() < 1e-12);
    }
}

#[test]
fn the_error_of_a_deviation_of_41_is_11_per_cent() {
    assert_eq!((1e4 * relative_error_of_deviation(41).unwrap()).round(), 1118.0);
}

/// V, n, dk, k and P of physics' check of tab:fits.
#[test]
fn sigma_of_tab_fits_with_the_plus_sign() {
    let box_size = 1000.0;
    let k_f = core::f64::consts::TAU / box_size;
    let (k, power, noise) = ([0.05], [2e4], 1.0 / 2.5e-4);
    let mut modes = [0.0];
    continuum_modes(&mut modes, &k, k_f, box_size).unwrap();
    let mut sigma = [0.0];
    sigma_gaussian(&mut sigma, &power, &modes, noise).unwrap();
    assert!((sigma[0] - 1203.182).abs() < 5e-4);
    for ([cosmic_variance, softening, shot_noise], expected) in [
        ([0.141, 0.114, 1.174], 603.428),
        ([0.177, 0.224, 1.224], 538.288),
        ([0.110, 0.110, 1.081], 569.429),
        ([0.120, 0.156, 1.056], 506.303),
    ] {
        let fit = Suppression { cosmic_variance, softening, shot_noise };
        sigma_suppressed(&mut sigma, &fit, &k, &power, &modes, noise).unwrap();
        assert!((sigma[0] - expected).abs() < 5e-4);
    }
    let mut none = [0.0];
    sigma_suppressed(&mut none, &Suppression::NONE, &k, &power, &modes, noise).unwrap();
    sigma_gaussian(&mut sigma, &power, &modes, noise).unwrap();
    assert!((none[0] / sigma[0] - 1.0).abs() < 1e-15);
}

#[test]
fn floor_shells_have_26_66_158_234_410_470_modes() {
    let mut counts = [0; 6];
    lattice_modes(&mut counts, &[1, 4, 9, 16, 25, 36, 49]).unwrap();
    assert_eq!(counts, [26, 66, 158, 234, 410, 470]);
    let mut wide = [0; 3];
    lattice_modes(&mut wide, &[3, 21, 57, 111]).unwrap();
    assert_eq!(wide, [370, 1402, 3154], "nearest-bin shells of width 3");
}

#[test]
fn levels_are_those_of_textbooks() {
    for (probability, parameters, level) in [
        (0.682_689_492_137_086, 1, 1.0),
        (0.954_499_736_103_642, 1, 4.0),
        (0.682_689_492_137_086, 2, 2.295_748_928_898_636),
        (0.954_499_736_103_642, 2, 6.180_074_306_244_168),
    ] {
        assert!((delta_chi_squared(probability, parameters).unwrap() - level).abs() < 1e-11);
    }
    assert_eq!(delta_chi_squared(1.0, 2), Err(Error::Range));
    assert_eq!(delta_chi_squared(0.5, 3), Err(Error::Range));
}

#[test]
fn covariances_of_few_simulations_cost_what_hartlap_and_percival_say() {
    assert_eq!(hartlap_factor(41, 14).unwrap(), 25.0 / 40.0);
    assert_eq!(hartlap_factor(16, 14), Err(Error::Samples));
    // A = 2/(26 * 23), B = 25/(26 * 23).
    let (a, b) = (2.0 / 598.0, 25.0 / 598.0);
    let expected = (1.0 + b * 12.0) / (1.0 + a + b * 3.0);
    assert!((percival_factor(41, 14, 2).unwrap() - expected).abs() < 1e-15);
    assert!((percival_factor(1_000_000, 14, 2).unwrap() - 1.0).abs() < 1e-4);
    assert_eq!(percival_factor(18, 14, 2), Err(Error::Samples));
}
