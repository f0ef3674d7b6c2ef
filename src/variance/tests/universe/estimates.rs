//! Claims about b_g and f_NL of single realisations.

use std::vec::Vec;

use super::chain::{REGION, constrain, memory};
use super::second_order::bias_of_peaks;
use super::sky::{self, KINDS, Kind, LARGEST, Sky};
use super::{COUNT, Ensemble, F_NL, LIMIT, moments};
use crate::variance::levels::delta_chi_squared;
use crate::variance::pairs::relative_error_of_deviation;

/// Of 0.68: the half-width of a Gaussian in units of its deviation.
fn half_width_of_deviation() -> f64 {
    delta_chi_squared(REGION, 1).unwrap().sqrt()
}

/// Every kind, universe and parameter, with its true value.
fn all() -> impl Iterator<Item = (Kind, usize, usize, f64)> {
    KINDS.into_iter().flat_map(|kind| {
        (0..4).map(move |at| {
            let (universe, axis) = (at / 2, at % 2);
            (kind, universe, axis, [sky::B_G, sky::F_NL[universe]][axis])
        })
    })
}

#[test]
fn b_g_and_f_nl_are_unbiased() {
    let sky = Sky::paper();
    for (kind, universe, axis, truth) in all() {
        let [mean, deviation] = moments(&Ensemble::of(kind).peaks(universe, axis));
        let error = deviation / f64::from(COUNT).sqrt();
        // Of f_NL -1.3 for Normal and -0.1 for Fixed, measured in `second_order`.
        let expected = truth + bias_of_peaks(&sky, kind, universe)[axis];
        assert!(
            (mean - expected).abs() < LIMIT * error,
            "{kind:?} {universe} {axis}: {mean} +- {error}, expected {expected}"
        );
    }
}

#[test]
fn regions_of_68_per_cent_hold_the_truth_in_68_per_cent() {
    let error = (REGION * (1.0 - REGION) / f64::from(COUNT)).sqrt();
    for (kind, universe, axis, truth) in all() {
        let held =
            Ensemble::of(kind).posteriors(universe, axis).filter(|p| p.low <= truth && truth <= p.high);
        let coverage = held.count() as f64 / f64::from(COUNT);
        assert!((coverage - REGION).abs() < LIMIT * error, "{kind:?} {universe} {axis}: {coverage}");
    }
}

#[test]
fn posteriors_are_as_wide_as_peaks_scatter() {
    let relative = relative_error_of_deviation(COUNT.into()).unwrap();
    for (kind, universe, axis, _) in all() {
        let [_, deviation] = moments(&Ensemble::of(kind).peaks(universe, axis));
        let widths: Vec<f64> = Ensemble::of(kind).posteriors(universe, axis).map(|p| p.half_width).collect();
        let [width, _] = moments(&widths);
        let ratio = width / (half_width_of_deviation() * deviation);
        // Widths vary by a few per cent from one realisation to the next, so their mean has no error to speak of.
        assert!((ratio - 1.0).abs() < LIMIT * relative, "{kind:?} {universe} {axis}: {ratio}");
    }
}

#[test]
fn no_posterior_is_cut_off() {
    for (kind, universe, axis, _) in all() {
        let edges = Ensemble::of(kind).posteriors(universe, axis).map(|p| p.edge);
        // exp(-12.5) for a density that has only just vanished at the end of its range.
        assert!(edges.fold(0.0, f64::max) < 5e-6);
    }
}

/// Where the paper's mocks lie, and the width of the posterior of f_NL on their mean.
const ON_THE_MEAN: [[(f64, f64); 2]; 3] =
    [[(1.1, 40.3), (108.7, 50.7)], [(-1.9, 12.0), (107.5, 12.4)], [(-1.2, 8.3), (107.5, 8.2)]];

#[test]
fn posteriors_on_the_mean_are_as_wide_as_the_papers() {
    for (kind, cells) in KINDS.into_iter().zip(ON_THE_MEAN) {
        let sky = Sky::new(LARGEST, 1.0, cells.map(|(centre, _)| centre));
        for (universe, (_, printed)) in cells.into_iter().enumerate() {
            let likelihood = sky.likelihood(&sky.power[universe], &sky.sigma(kind, universe));
            let width = constrain(&likelihood, &mut memory()).posterior[F_NL].half_width;
            // Bins, and b_g of their mean, are not printed: one more bin at 0.09 h/Mpc is 2%, and b_g to 0.02 is 2%.
            assert!((width / printed - 1.0).abs() < 0.04, "{kind:?} {universe}: {width} for {printed}");
        }
    }
}
