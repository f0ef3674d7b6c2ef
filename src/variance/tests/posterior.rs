//! What is read off the likelihood on grids.

use std::vec;
use std::vec::Vec;

use super::likelihood::{Data, TRUTH};
use super::{Draws, largest, relative};
use crate::reference::built::Memory;
use crate::reference::variance as twin;
use crate::status::{Error, Result};
use crate::variance::bias::{Bias, Spectrum};
use crate::variance::fit::{FREE_B_G, FREE_F_NL, FREE_P};
use crate::variance::levels::delta_chi_squared;
use crate::variance::likelihood::BiasLikelihood;
use crate::variance::posterior::*;

fn read(likelihood: &BiasLikelihood, start: &Bias, free: u32, points: usize) -> Result<Constraints> {
    let mut memory = Memory::new(bias_posterior_scratch(points)?);
    bias_posterior(likelihood, start, free, points, 0.68, memory.get())
}

fn all(of: &Posterior) -> [f64; 5] {
    [of.peak, of.mean, of.deviation, of.centre, of.half_width]
}

/// Largest difference in units of the deviation.
fn apart(a: &Posterior, b: &Posterior) -> f64 {
    largest(all(a).into_iter().zip(all(b)).map(|(a, b)| (a - b).abs())) / b.deviation
}

#[test]
fn a_gaussian_posterior_is_its_closed_form() {
    // P_hm is linear in each parameter alone.
    let mut draws = Draws::of(131);
    let width = delta_chi_squared(0.68, 1).unwrap().sqrt();
    for (free, number) in [(FREE_B_G, 0), (FREE_P, 1), (FREE_F_NL, 2)] {
        for _ in 0..20 {
            let likelihood =
                Data::noisy(&TRUTH, Spectrum::HaloMatter, 0.3, &mut draws).likelihood(Spectrum::HaloMatter);
            let found = read(&likelihood, &TRUTH, free, 128).unwrap();
            let fit = &found.fit;
            let (value, error) = ([fit.value.b_g, fit.value.p, fit.value.f_nl][number], fit.error[number]);
            let one = &found.posterior[0];
            // The logarithm is a parabola, and sums of a Gaussian are exact but for the ends at 5 sigma: 1e-5 of its square.
            assert!((one.peak - value).abs() < 1e-8 * error);
            assert!((one.mean - value).abs() < 1e-5 * error);
            assert!(relative(one.deviation, error) < 3e-5);
            // The density is linear between points 0.08 sigma apart: h^2/8.
            assert!((one.centre - value).abs() < 8e-4 * error);
            assert!((one.half_width / error - width).abs() < 8e-4);
            assert!(one.edge < 1e-5);
            assert_eq!(found.posterior[1], Posterior::default());
            assert_eq!(found.grid.points, [128, 1]);
            assert_eq!(
                (one.centre, one.half_width),
                (0.5 * (one.low + one.high), 0.5 * (one.high - one.low))
            );
        }
    }
}

#[test]
fn a_narrow_posterior_is_the_fit_and_its_error() {
    for spectrum in [Spectrum::HaloHalo, Spectrum::HaloMatter] {
        let likelihood = Data::exact(&TRUTH, spectrum, 1e-4).likelihood(spectrum);
        for (free, numbers) in [(FREE_B_G | FREE_P, [0, 1]), (FREE_B_G | FREE_F_NL, [0, 2])] {
            let found = read(&likelihood, &TRUTH, free, 256).unwrap();
            for (one, number) in found.posterior.iter().zip(numbers) {
                let value = [2.32, 1.0, 100.0][number];
                let error = found.fit.error[number];
                // The skewness of errors of 1e-4.
                assert!((one.peak - value).abs() < 3e-3 * error && (one.mean - value).abs() < 3e-3 * error);
                assert!(relative(one.deviation, error) < 1e-3);
                assert!(relative(one.half_width, error * delta_chi_squared(0.68, 1).unwrap().sqrt()) < 3e-3);
            }
        }
    }
}

#[test]
fn steps_of_a_grid_by_hand_are_the_same() {
    let mut draws = Draws::of(132);
    let likelihood = Data::noisy(&TRUTH, Spectrum::HaloHalo, 1.0, &mut draws).likelihood(Spectrum::HaloHalo);
    for free in [FREE_B_G | FREE_F_NL, FREE_B_G | FREE_P, FREE_F_NL] {
        let whole = read(&likelihood, &TRUTH, free, 64).unwrap();
        let parameters = free.count_ones() as usize;
        let mut range = [[0.0; 2]; 2];
        bias_range(&mut range[..parameters], &likelihood, &TRUTH, free).unwrap();
        let points = [64, if parameters == 2 { 64 } else { 1 }];
        assert_eq!(whole.grid.range[..parameters], range[..parameters]);
        assert_eq!(whole.grid.points, points);
        let mut values = vec![0.0; points[0] * points[1]];
        bias_grid(&mut values, &likelihood, &TRUTH, free, &Grid { range, points }).unwrap();
        for axis in 0..parameters {
            let mut density = [0.0; 64];
            marginal(&mut density, &values, points, axis, range[axis]).unwrap();
            let ends = 0.5 * (density[0] + density[63]);
            let step = (range[axis][1] - range[axis][0]) / 63.0;
            assert!(((density.iter().sum::<f64>() - ends) * step - 1.0).abs() < 1e-14, "normalised");
            let one = read_posterior(&density, range[axis], 0.68).unwrap();
            assert!(apart(&one, &whole.posterior[axis]) < 1e-11);
        }
    }
}

#[test]
fn chi_squared_of_a_grid_is_that_of_its_points() {
    let likelihood = Data::exact(&TRUTH, Spectrum::HaloHalo, 1.0).likelihood(Spectrum::HaloHalo);
    let grid = Grid { range: [[2.0, 3.0], [-50.0, 150.0]], points: [3, 5] };
    let mut values = [0.0; 15];
    bias_grid(&mut values, &likelihood, &TRUTH, FREE_B_G | FREE_F_NL, &grid).unwrap();
    for (at, value) in values.into_iter().enumerate() {
        let there = Bias { b_g: 2.0 + 0.5 * (at / 5) as f64, f_nl: -50.0 + 50.0 * (at % 5) as f64, ..TRUTH };
        assert!(relative(value, likelihood.chi_squared(&there).unwrap()) < 1e-12);
    }
}

/// Mean, deviation and central 68% of f_NL from a sum over all bins on a grid of steps ten times finer, without interpolation.
fn brute_force(data: &Data, range: [[f64; 2]; 2]) -> [f64; 4] {
    const STEPS: usize = 1000;
    let middle = |axis: usize, i: usize| {
        range[axis][0] + (range[axis][1] - range[axis][0]) * ((i as f64 + 0.5) / STEPS as f64)
    };
    let mut density = vec![0.0; STEPS];
    for i in 0..STEPS {
        for (j, density) in density.iter_mut().enumerate() {
            let at = Bias { b_g: middle(0, i), f_nl: middle(1, j), ..TRUTH };
            let model = data.model(&at, Spectrum::HaloHalo);
            *density += (-0.5 * twin::chi_squared(&data.power, &model, &data.sigma)).exp();
        }
    }
    let sum: f64 = density.iter().sum();
    let moment = |of: &dyn Fn(f64) -> f64| -> f64 {
        density.iter().enumerate().map(|(j, x)| x / sum * of(middle(1, j))).sum()
    };
    let mean = moment(&|x| x);
    let deviation = moment(&|x| (x - mean).powi(2)).sqrt();
    let quantile = |below: f64| {
        let mut total = 0.0;
        let place = density.iter().position(|x| {
            total += x / sum;
            total >= below
        });
        middle(1, place.unwrap())
    };
    [mean, deviation, quantile(0.16), quantile(0.84)]
}

#[test]
fn a_skewed_posterior_is_that_of_brute_force() {
    let mut draws = Draws::of(133);
    let data = Data::noisy(&TRUTH, Spectrum::HaloHalo, 2.0, &mut draws);
    let found = read(&data.likelihood(Spectrum::HaloHalo), &TRUTH, FREE_B_G | FREE_F_NL, 128).unwrap();
    let one = &found.posterior[1];
    let skew = (one.mean - one.peak) / one.deviation;
    assert!(skew.abs() > 0.02, "not a Gaussian: {skew}");
    // Twice as wide: nothing was cut off.
    let range = found.grid.range.map(|[low, high]| {
        let more = 0.25 * (high - low);
        [low - more, high + more]
    });
    let [mean, deviation, low, high] = brute_force(&data, range);
    let step = (range[1][1] - range[1][0]) / 1000.0;
    assert!((one.mean - mean).abs() < 1e-3 * deviation, "{} {mean}", one.mean);
    assert!(relative(one.deviation, deviation) < 1e-3);
    assert!((one.low - low).abs() < step && (one.high - high).abs() < step);
}

#[test]
fn points_of_128_are_converged_to_three_digits() {
    let mut draws = Draws::of(134);
    for _ in 0..5 {
        let likelihood =
            Data::noisy(&TRUTH, Spectrum::HaloHalo, 1.0, &mut draws).likelihood(Spectrum::HaloHalo);
        let [coarse, usual, fine, finest] = [32, 128, 256, 512]
            .map(|points| read(&likelihood, &TRUTH, FREE_B_G | FREE_F_NL, points).unwrap());
        for axis in 0..2 {
            let of = |found: &Constraints| apart(&found.posterior[axis], &finest.posterior[axis]);
            assert!(of(&usual) < 1e-3 && of(&usual) < 0.2 * of(&coarse) && of(&fine) < 0.5 * of(&usual));
        }
    }
}

#[test]
fn ranges_hold_all_of_the_posterior_and_little_else() {
    let mut draws = Draws::of(135);
    for (spectrum, scatter) in
        [(Spectrum::HaloHalo, 0.01), (Spectrum::HaloHalo, 1.5), (Spectrum::HaloMatter, 1.0)]
    {
        for _ in 0..20 {
            let likelihood = Data::noisy(&TRUTH, spectrum, scatter, &mut draws).likelihood(spectrum);
            for free in [FREE_B_G, FREE_F_NL, FREE_B_G | FREE_F_NL, FREE_B_G | FREE_P] {
                let found = read(&likelihood, &TRUTH, free, 64).unwrap();
                for axis in 0..free.count_ones() as usize {
                    let (one, [low, high]) = (&found.posterior[axis], found.grid.range[axis]);
                    assert!(one.edge < 1e-4, "{free}: {one:?}");
                    // Ten sigma of a Gaussian; of two humps less, of long tails more.
                    assert!((4.0..20.0).contains(&((high - low) / one.deviation)), "{free} {found:?}");
                    assert!(low < one.low && one.low < one.high && one.high < high);
                }
            }
        }
    }
}

#[test]
fn the_central_region_has_the_probability_asked_for() {
    // Of a triangle and of a box, in closed form.
    let triangle: [f64; 101] = core::array::from_fn(|i| i as f64);
    let found = read_posterior(&triangle, [0.0, 1.0], 0.5).unwrap();
    assert!((found.low - 0.5).abs() < 1e-14 && (found.high - 0.75_f64.sqrt()).abs() < 1e-14);
    assert!((found.mean - 2.0 / 3.0).abs() < 1e-4, "trapezoidal");
    assert_eq!((found.peak, found.edge), (1.0, 1.0));
    let flat = read_posterior(&[2.0; 11], [-1.0, 1.0], 0.68).unwrap();
    assert!((flat.low + 0.68).abs() < 1e-14 && (flat.high - 0.68).abs() < 1e-14 && flat.mean.abs() < 1e-15);
    // Zeros on both sides; the whole mass about one point.
    let mut spike = [0.0; 21];
    spike[10] = 3.0;
    let found = read_posterior(&spike, [0.0, 20.0], 0.68).unwrap();
    assert_eq!((found.peak, found.centre, found.mean, found.edge), (10.0, 10.0, 10.0, 0.0));
    assert!((found.high - 11.0 + 0.32_f64.sqrt()).abs() < 1e-14);
}

#[test]
fn a_posterior_without_an_end_is_refused() {
    // Halos of b_g = p do not feel f_NL, and these may be of that kind.
    for b_g in [1.001, 1.01, 1.05] {
        let truth = Bias { b_g, f_nl: 0.0, ..TRUTH };
        let likelihood = Data::exact(&truth, Spectrum::HaloHalo, 1.0).likelihood(Spectrum::HaloHalo);
        assert_eq!(read(&likelihood, &truth, FREE_B_G | FREE_F_NL, 64), Err(Error::Convergence));
        assert_eq!(
            bias_range(&mut [[0.0; 2]; 2], &likelihood, &truth, FREE_B_G | FREE_F_NL),
            Err(Error::Convergence)
        );
        assert!(read(&likelihood, &truth, FREE_B_G, 64).is_ok());
    }
}

#[test]
fn what_is_no_grid_and_no_density_is_refused() {
    let likelihood = Data::exact(&TRUTH, Spectrum::HaloHalo, 1.0).likelihood(Spectrum::HaloHalo);
    let both = FREE_B_G | FREE_F_NL;
    for points in [15, 8193] {
        assert_eq!(bias_posterior_scratch(points), Err(Error::Range));
    }
    let mut memory = Memory::new(bias_posterior_scratch(16).unwrap());
    for (probability, error) in [(0.0, Error::Range), (1.0, Error::Range), (f64::NAN, Error::NotFinite)] {
        assert_eq!(bias_posterior(&likelihood, &TRUTH, both, 16, probability, memory.get()), Err(error));
    }
    assert_eq!(bias_posterior(&likelihood, &TRUTH, both, 16, 0.68, &mut []), Err(Error::Scratch));
    assert_eq!(bias_posterior(&likelihood, &TRUTH, 6, 16, 0.68, memory.get()), Err(Error::Choice));
    assert_eq!(bias_range(&mut [[0.0; 2]; 1], &likelihood, &TRUTH, both), Err(Error::Length));

    let good = Grid { range: [[2.0, 3.0], [0.0, 100.0]], points: [2, 3] };
    let mut values = [7.0; 6];
    let mut refused =
        |free, grid: Grid| bias_grid(&mut values, &likelihood, &TRUTH, free, &grid).unwrap_err();
    assert_eq!(refused(6, good), Error::Choice);
    assert_eq!(refused(both, Grid { points: [2, 2], ..good }), Error::Length);
    assert_eq!(refused(both, Grid { points: [6, 1], ..good }), Error::Range);
    assert_eq!(refused(FREE_B_G, good), Error::Range);
    assert_eq!(refused(both, Grid { points: [usize::MAX, 2], ..good }), Error::Overflow);
    assert_eq!(refused(both, Grid { range: [[3.0, 2.0], [0.0, 1.0]], ..good }), Error::Range);
    assert_eq!(refused(both, Grid { range: [[2.0, 3.0], [0.0, f64::NAN]], ..good }), Error::NotFinite);
    assert_eq!(refused(both, Grid { range: [[2.0, 3.0], [0.0, 1e200]], ..good }), Error::Range);
    assert_eq!(values, [7.0; 6]);

    let mut out = [7.0; 2];
    let mut refused =
        |values: &[f64], points, axis, range| marginal(&mut out, values, points, axis, range).unwrap_err();
    assert_eq!(refused(&[1.0; 6], [2, 2], 0, [0.0, 1.0]), Error::Length);
    assert_eq!(refused(&[1.0; 6], [3, 2], 0, [0.0, 1.0]), Error::Length);
    assert_eq!(refused(&[1.0; 6], [2, 3], 2, [0.0, 1.0]), Error::Range);
    assert_eq!(refused(&[1.0; 6], [2, 3], 0, [1.0, 1.0]), Error::Range);
    assert_eq!(refused(&[], [2, 0], 0, [0.0, 1.0]), Error::Range);
    assert_eq!(refused(&[1.0, f64::NAN], [2, 1], 0, [0.0, 1.0]), Error::NotFinite);
    assert_eq!(out, [7.0; 2]);

    let refused =
        |density: &[f64], range, probability| read_posterior(density, range, probability).unwrap_err();
    assert_eq!(refused(&[1.0; 2], [0.0, 1.0], 0.68), Error::Length);
    assert_eq!(refused(&[1.0, -1.0, 1.0], [0.0, 1.0], 0.68), Error::Range);
    assert_eq!(refused(&[0.0; 3], [0.0, 1.0], 0.68), Error::Range);
    assert_eq!(refused(&[1.0; 3], [1.0, 0.0], 0.68), Error::Range);
    assert_eq!(refused(&[1.0; 3], [0.0, 1.0], 1.0), Error::Range);
    assert_eq!(refused(&[1.0, f64::INFINITY, 1.0], [0.0, 1.0], 0.68), Error::NotFinite);
}

#[test]
fn readings_follow_the_units_of_the_parameter() {
    let density: Vec<f64> = (0..50).map(|i| (-0.5 * (f64::from(i) / 8.0 - 3.0).powi(2)).exp()).collect();
    let [a, b] = [[0.0, 1.0], [-500.0, 1500.0]].map(|range| read_posterior(&density, range, 0.68).unwrap());
    for (a, b) in [(a.peak, b.peak), (a.mean, b.mean), (a.low, b.low), (a.high, b.high)] {
        assert!((2000.0 * a - 500.0 - b).abs() < 1e-9);
    }
    assert!(relative(2000.0 * a.deviation, b.deviation) < 1e-12);
}
