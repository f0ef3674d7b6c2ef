//! Ensembles, likelihoods, counts of modes and controls against their definitions.

use core::ptr::null;

use crate::c::*;
use crate::hooks::{layout, scratch_for};
use crate::input::Input;
use crate::memory::Memory;
use crate::reference::variance::{carpool, chi_squared, covariance, lattice_modes, means, model};
use crate::same::close;
use crate::variance::bias::{Bias, Spectrum};
use crate::variance::likelihood::BiasLikelihood;

pub fn run(data: &[u8]) {
    let input = &mut Input::new(data);
    match input.few(4) {
        0 => ensembles(input),
        1 => likelihoods(input),
        2 => lattices(input),
        _ => controls(input),
    }
}

fn samples(input: &mut Input, len: usize) -> Vec<f64> {
    let (offset, mut random) = ([0.0, 1.0, 1000.0][input.few(3)], input.random());
    (0..len).map(|_| offset + random.unit() - 0.5).collect()
}

/// Samples in two parts, added one after the other and merged.
fn ensembles(input: &mut Input) {
    let (values, rows) = (1 + input.few(4), 2 + input.few(6));
    let all = samples(input, rows * values);
    let first = values * input.few(rows + 1);
    let mut len = 0;
    must!(fixpair_ensemble_length(&mut len, values, FIXPAIR_MOMENTS_COVARIANCE));
    let states = [0; 2].map(|_| Memory::new(len, |_| 7.0_f64));
    for (state, part) in states.iter().zip([&all[..first], &all[first..]]) {
        must!(fixpair_ensemble_init(state.pointer(), len, values, FIXPAIR_MOMENTS_COVARIANCE));
        must!(fixpair_ensemble_add(state.pointer(), len, part.as_ptr(), part.len()));
    }
    must!(fixpair_ensemble_merge(states[0].pointer(), len, states[1].pointer()));
    let (mean, matrix) = (Memory::new(values, |_| 7.0), Memory::new(values * values, |_| 7.0));
    must!(fixpair_ensemble_mean(mean.pointer(), values, states[0].pointer(), len));
    must!(fixpair_ensemble_covariance(matrix.pointer(), values, values, states[0].pointer(), len, 0, 0));
    // A dozen roundings of samples up to 1000.
    mean.values()
        .iter()
        .zip(means(&all, values))
        .for_each(|(&mean, expected)| close(mean, expected, 1e-11, "mean"));
    let expected = covariance(&all, values);
    matrix
        .values()
        .iter()
        .zip(expected)
        .for_each(|(&found, expected)| close(found, expected, 1e-11, "covariance"));
}

fn likelihoods(input: &mut Input) {
    let len = 1 + input.few(8);
    let mut random = input.random();
    let mut some =
        |low: f64, high: f64| -> Vec<f64> { (0..len).map(|_| low + (high - low) * random.unit()).collect() };
    let (power, sigma) = (some(1e4, 2e4), some(100.0, 1000.0));
    let (linear, alpha) = (some(1e3, 1e4), some(100.0, 1e4));
    let [b_g, p, f_nl] =
        [(1.0, 3.0), (0.5, 1.5), (-100.0, 100.0)].map(|(low, high)| input.between(low, high));
    let at = Bias { b_g, p, f_nl, delta_c: 1.686 };
    let matter = input.few(2);
    let spectrum = [Spectrum::HaloHalo, Spectrum::HaloMatter][matter];
    let likelihood = Memory::<BiasLikelihood>::zeros(1);
    must!(fixpair_likelihood_init(likelihood.pointer()));
    must!(fixpair_likelihood_add(
        likelihood.pointer(),
        power.as_ptr(),
        sigma.as_ptr(),
        linear.as_ptr(),
        alpha.as_ptr(),
        len,
        matter as i32
    ));
    let mut found = 0.0;
    must!(fixpair_likelihood_chi_squared(&mut found, likelihood.pointer(), &at));
    let models: Vec<f64> =
        linear.iter().zip(&alpha).map(|(&linear, &alpha)| model(&at, spectrum, linear, alpha)).collect();
    let expected = chi_squared(&power, &models, &sigma);
    // Terms of chi^2 before they cancel: data and model over sigma, squared.
    let terms = |of: &[f64]| of.iter().zip(&sigma).map(|(value, sigma)| (value / sigma).powi(2)).sum::<f64>();
    close(found, expected, 1e-12 * (terms(&power) + terms(&models)), "chi^2");
}

fn lattices(input: &mut Input) {
    let mut edge = input.few(4) as u64;
    let edges: Vec<u64> = (0..2 + input.few(4))
        .map(|_| {
            edge += 1 + input.few(20) as u64;
            edge - 1
        })
        .collect();
    let counts = Memory::new(edges.len() - 1, |_| 7_u64);
    must!(fixpair_lattice_modes(counts.pointer(), edges.as_ptr(), edges.len()));
    assert_eq!(counts.values(), lattice_modes(&edges), "{edges:?}");
}

fn controls(input: &mut Input) {
    let (values, controls) = (1 + input.few(3), 1 + input.few(2));
    let rows = controls + 6 + input.few(8);
    let mut random = input.random();
    let mut some = |len: usize| -> Vec<f64> { (0..len).map(|_| random.unit() - 0.5).collect() };
    let (y, c, mu) = (some(rows * values), some(rows * controls), some(controls));
    let of_mu: Vec<f64> =
        (0..controls * controls).map(|at| if at % (controls + 1) == 0 { 0.01 } else { 0.0 }).collect();
    let exact = input.flag();
    let mut layout = layout();
    must!(fixpair_carpool_scratch(&mut layout, values, controls));
    let scratch = scratch_for(&mut Input::new(&[]), 0, layout);
    let [mean, matrix, beta] =
        [values, values * values, values * controls].map(|len| Memory::new(len, |_| 7.0));
    must!(fixpair_carpool(
        mean.pointer(),
        matrix.pointer(),
        beta.pointer(),
        y.as_ptr(),
        c.as_ptr(),
        rows,
        values,
        mu.as_ptr(),
        if exact { null() } else { of_mu.as_ptr() },
        controls,
        scratch.pointer().cast(),
        scratch.len()
    ));
    let zeros = vec![0.0; controls * controls];
    let expected = carpool(&y, &c, &mu, if exact { &zeros } else { &of_mu }, rows);
    // Samples of a control and its regression are of order one; their covariance is not worse conditioned than 1e3.
    for (found, expected) in [(&mean, expected.0), (&matrix, expected.1), (&beta, expected.2)] {
        found
            .values()
            .iter()
            .zip(expected)
            .for_each(|(&found, expected)| close(found, expected, 1e-10, "carpool"));
    }
}
