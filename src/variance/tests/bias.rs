//! Scale-dependent bias and what a spectrum says of it.

use super::Draws;
use crate::reference::variance as twin;
use crate::status::Error;
use crate::variance::bias::*;

const GOLIAT: Bias = Bias { b_g: 2.32, p: 1.0, f_nl: 100.0, delta_c: DELTA_C };

#[test]
fn the_shift_is_0_4237_where_alpha_is_that_of_k_0_01() {
    let mut out = [0.0];
    bias_of_k(&mut out, &GOLIAT, &[1050.4]).unwrap();
    // Four digits are known.
    assert!((out[0] - 2.32 - 0.4237).abs() < 5e-5 + 1e-6);
}

#[test]
fn spectra_are_those_of_eq_bk_bin_by_bin() {
    let mut draws = Draws::of(21);
    for _ in 0..200 {
        let at = Bias {
            b_g: 4.0 * draws.unit(),
            p: draws.normal(),
            f_nl: 300.0 * draws.normal(),
            delta_c: 1.0 + draws.unit(),
        };
        let linear: [f64; 9] = core::array::from_fn(|_| 1e4 * draws.unit());
        let alpha: [f64; 9] = core::array::from_fn(|_| 10_f64.powf(1.0 + 4.0 * draws.unit()));
        for spectrum in [Spectrum::HaloHalo, Spectrum::HaloMatter] {
            let mut power = [0.0; 9];
            halo_power(&mut power, &at, spectrum, &linear, &alpha).unwrap();
            for i in 0..9 {
                let expected = twin::model(&at, spectrum, linear[i], alpha[i]);
                // Where b passes through zero its roundings are those of b_g.
                assert!((power[i] - expected).abs() <= 1e-13 * (expected.abs() + linear[i] * (1.0 + at.b_g)));
            }
        }
    }
}

#[test]
fn bias_is_scale_free_without_f_nl_and_where_b_g_is_p() {
    for at in [Bias { f_nl: 0.0, ..GOLIAT }, Bias { p: 2.32, ..GOLIAT }] {
        let mut out = [0.0; 2];
        bias_of_k(&mut out, &at, &[1.0, 1e6]).unwrap();
        assert_eq!(out, [2.32; 2]);
    }
}

#[test]
fn a_measured_bias_is_the_bias_that_made_the_spectrum() {
    let (linear, alpha, sigma) = ([2e4, 1.5e4, 900.0], [80.0, 1050.4, 2e4], [3e3, 1e3, 10.0]);
    let (mut expected, mut found, mut error) = ([0.0; 3], [0.0; 3], [0.0; 3]);
    bias_of_k(&mut expected, &GOLIAT, &alpha).unwrap();
    for spectrum in [Spectrum::HaloHalo, Spectrum::HaloMatter] {
        let mut power = [0.0; 3];
        halo_power(&mut power, &GOLIAT, spectrum, &linear, &alpha).unwrap();
        measured_bias(&mut found, &mut error, spectrum, &power, &sigma, &linear).unwrap();
        for i in 0..3 {
            assert!((found[i] / expected[i] - 1.0).abs() < 1e-15);
            // The error is the slope: a step of 1e-6 of the spectrum has a second order of 1e-7 of itself.
            let step = 1e-6 * power[i];
            let (mut moved, mut unused) = ([0.0; 3], [0.0; 3]);
            measured_bias(
                &mut moved,
                &mut unused,
                spectrum,
                &power.map(|x| x * (1.0 + 1e-6)),
                &sigma,
                &linear,
            )
            .unwrap();
            let slope = (moved[i] - found[i]) / step;
            assert!((error[i] / (slope * sigma[i]) - 1.0).abs() < 1e-6);
        }
    }
}

#[test]
fn what_has_no_bias_is_refused() {
    let mut out = [7.0; 2];
    let alpha = [1.0; 2];
    assert_eq!(bias_of_k(&mut out, &GOLIAT, &[1.0]), Err(Error::Length));
    assert_eq!(bias_of_k(&mut out, &GOLIAT, &[1.0, 0.0]), Err(Error::Range));
    assert_eq!(bias_of_k(&mut out, &GOLIAT, &[1.0, f64::NAN]), Err(Error::NotFinite));
    assert_eq!(bias_of_k(&mut out, &GOLIAT, &[1.0, 1e-307]), Err(Error::Range));
    for wrong in [
        Bias { b_g: f64::NAN, ..GOLIAT },
        Bias { p: f64::INFINITY, ..GOLIAT },
        Bias { f_nl: f64::NAN, ..GOLIAT },
        Bias { delta_c: f64::NAN, ..GOLIAT },
    ] {
        assert_eq!(bias_of_k(&mut out, &wrong, &alpha), Err(Error::NotFinite));
    }
    assert_eq!(bias_of_k(&mut out, &Bias { delta_c: 0.0, ..GOLIAT }, &alpha), Err(Error::Range));
    let mut power = |linear: &[f64], alpha: &[f64]| {
        halo_power(&mut out, &GOLIAT, Spectrum::HaloHalo, linear, alpha).unwrap_err()
    };
    assert_eq!(power(&[1.0], &alpha), Error::Length);
    assert_eq!(power(&[1.0, f64::NAN], &alpha), Error::NotFinite);
    assert_eq!(power(&[1.0, f64::MAX], &alpha), Error::Range);
    let mut error = [7.0; 2];
    let mut measured = |spectrum, power: &[f64], sigma: &[f64], linear: &[f64]| {
        measured_bias(&mut out, &mut error, spectrum, power, sigma, linear)
    };
    let one = [1.0; 2];
    assert_eq!(measured(Spectrum::HaloHalo, &[1.0, 0.0], &one, &one), Err(Error::Range));
    assert_eq!(measured(Spectrum::HaloHalo, &one, &[1.0, 0.0], &one), Err(Error::Range));
    assert_eq!(measured(Spectrum::HaloHalo, &one, &one, &[1.0, -1.0]), Err(Error::Range));
    assert_eq!(measured(Spectrum::HaloHalo, &[1.0, f64::NAN], &one, &one), Err(Error::NotFinite));
    assert_eq!(measured(Spectrum::HaloHalo, &one[1..], &one, &one), Err(Error::Length));
    assert_eq!(out, [7.0; 2]);
    assert_eq!(error, [7.0; 2]);
    let (mut out, mut error) = ([0.0; 2], [0.0; 2]);
    measured_bias(&mut out, &mut error, Spectrum::HaloMatter, &[-1.0, 0.0], &one, &one).unwrap();
    assert_eq!(out, [-1.0, 0.0], "P_hm may scatter below zero");
}
