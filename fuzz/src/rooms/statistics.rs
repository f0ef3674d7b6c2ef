//! Ensembles, resampling, scatter and its models, matched simulations, controls and covariances. What is OK is finite.

use core::ptr::null;

use crate::check::{Before, finite};
use crate::hooks::{layout, scratch_for};
use crate::input::Input;
use crate::memory::Memory;
use crate::rooms::power::some_edges;

pub fn run(data: &[u8]) {
    let input = &mut Input::new(data);
    match input.few(7) {
        0 => ensembles(input),
        1 => resampling(input),
        2 => scatter(input),
        3 => ratios(input),
        4 => factors(input),
        5 => controls(input),
        _ => matrices(input),
    }
}

/// After OK all are finite, after a failure none was touched.
pub fn answered(status: i32, before: &Before, out: &[&Memory<f64>]) {
    before.check(status, &[]);
    for values in out {
        finite(status, values.values());
    }
}

fn out(len: usize) -> Memory<f64> {
    Memory::new(len, |_| 7.0)
}

/// A number of estimates or of simulations.
fn amount(input: &mut Input) -> u64 {
    input.about(50) as u64
}

fn ensembles(input: &mut Input) {
    let (values, moments) = (1 + input.few(5), input.few(2) as i32);
    let mut len = 0;
    let _ = call!(fixpair_ensemble_length(&mut len, input.size(), input.choice(2)));
    must!(fixpair_ensemble_length(&mut len, values, moments));
    let mut state = out(len);
    let other = out(len);
    let before = Before::of(&[&state]);
    let status = call!(fixpair_ensemble_init(input.pointer(&state), input.length(len), values, moments));
    before.check(status, &[]);
    must!(fixpair_ensemble_init(state.pointer(), len, values, moments));
    must!(fixpair_ensemble_init(other.pointer(), len, values, moments));
    let rows = input.few(5);
    let samples = Memory::<f64>::floats(input, values * rows, -1.0, 1.0);
    let before = Before::of(&[&state]);
    let status = call!(fixpair_ensemble_add(
        input.pointer(&state),
        len,
        input.pointer(&samples),
        input.length(samples.len())
    ));
    before.check(status, &[]);
    let other_rows = input.few(5);
    let more = Memory::<f64>::floats(input, values * other_rows, 1e3, 1e5);
    let _ = call!(fixpair_ensemble_add(other.pointer(), len, more.pointer(), more.len()));
    state.spoil(input);
    let before = Before::of(&[&other]);
    let status =
        call!(fixpair_ensemble_merge(input.pointer(&other), input.length(len), input.pointer(&state)));
    before.check(status, &[]);
    let mut count = 0;
    let _ = call!(fixpair_ensemble_count(&mut count, input.pointer(&other), len));
    let [mean, matrix] = [values, 25].map(out);
    let before = Before::of(&[&mean, &matrix]);
    let (of, rows, columns) = (input.pointer(&other), input.few(6), input.few(6));
    let (to, square) = (input.pointer(&mean), input.pointer(&matrix));
    let status = match input.few(5) {
        0 => call!(fixpair_ensemble_mean(to, input.length(values), of, len)),
        1 => call!(fixpair_ensemble_deviation(to, input.length(values), of, len)),
        2 => call!(fixpair_ensemble_error_of_mean(to, input.length(values), of, len)),
        3 => {
            call!(fixpair_ensemble_covariance(square, rows, columns, of, len, input.about(6), input.about(6)))
        }
        _ => call!(fixpair_ensemble_correlation(
            square,
            rows,
            columns,
            of,
            len,
            input.about(6),
            input.about(6)
        )),
    };
    answered(status, &before, &[&mean, &matrix]);
}

fn resampling(input: &mut Input) {
    let (rows, values) = (input.few(6), input.few(5));
    let samples = Memory::<f64>::floats(input, rows * values, -1.0, 1.0);
    let mut indices = Memory::new(input.few(9), |_| 0_u64);
    let before = Before::of(&[&indices]);
    let status = call!(fixpair_bootstrap_indices(
        input.pointer(&indices),
        input.length(indices.len()),
        amount(input),
        input.word(),
        input.word()
    ));
    before.check(status, &[]);
    let len = indices.len();
    if len > 0 && input.flag() {
        indices.values_mut()[input.few(len)] = input.about(5) as u64;
    }
    let (mean, error, deleted, square) = (out(values), out(values), out(rows * values), out(values * values));
    let of = input.pointer(&samples);
    let before = Before::of(&[&mean, &error, &deleted, &square]);
    let status = match input.few(4) {
        0 => call!(fixpair_resampled_mean(
            input.pointer(&mean),
            values,
            of,
            rows,
            input.pointer(&indices),
            input.length(len)
        )),
        1 => call!(fixpair_jackknife_means(input.pointer(&deleted), of, rows, values)),
        2 => {
            let whole = Memory::<f64>::floats(input, values, -1.0, 1.0);
            call!(fixpair_jackknife(
                input.pointer(&mean),
                input.pointer(&error),
                input.pointer(&whole),
                input.length(values),
                of,
                rows
            ))
        }
        _ => call!(fixpair_jackknife_covariance(input.pointer(&square), of, rows, values)),
    };
    answered(status, &before, &[&mean, &error, &deleted, &square]);
}

fn scatter(input: &mut Input) {
    let len = input.few(8);
    let k = Memory::<f64>::floats(input, len, 0.01, 0.4);
    let power = Memory::<f64>::floats(input, len, 1e3, 1e4);
    let modes = Memory::<f64>::floats(input, len, 10.0, 1e4);
    let (sigma, noise) = (out(len), input.about_number(100.0));
    let left = fixpair::variance::models::Suppression {
        cosmic_variance: input.about_number(0.2),
        softening: input.about_number(0.05),
        shot_noise: input.about_number(0.9),
    };
    let (to, wave, spectrum, number) =
        (input.pointer(&sigma), input.pointer(&k), input.pointer(&power), input.pointer(&modes));
    let declared = input.length(len);
    let before = Before::of(&[&sigma]);
    let status = match input.few(5) {
        0 => call!(fixpair_continuum_modes(
            to,
            wave,
            declared,
            input.about_number(0.01),
            input.about_number(1e3)
        )),
        1 => call!(fixpair_sigma_gaussian(to, spectrum, number, declared, noise)),
        2 => call!(fixpair_sigma_suppressed(to, &left, wave, spectrum, number, declared, noise)),
        3 => {
            let edges = some_edges(input, 5);
            // Sound as far as 2^28, and then seconds long.
            if edges.values().iter().any(|edge| (1 << 12..=1 << 28).contains(edge)) {
                return;
            }
            let counts = Memory::new(edges.len().saturating_sub(1), |_| 7_u64);
            let before = Before::of(&[&counts]);
            let status = call!(fixpair_lattice_modes(
                input.pointer(&counts),
                input.pointer(&edges),
                input.length(edges.len())
            ));
            before.check(status, &[]);
            return;
        }
        _ => {
            let measured = Memory::<f64>::floats(input, len, 10.0, 1e3);
            let error = Memory::<f64>::floats(input, len, 1.0, 100.0);
            let fit = Memory::zeros(1);
            let before = Before::of(&[&fit]);
            let status = call!(fixpair_fit_suppression(
                input.pointer(&fit),
                input.pointer(&measured),
                input.optional(&error),
                wave,
                spectrum,
                number,
                declared,
                noise,
                amount(input)
            ));
            before.check(status, &[]);
            return;
        }
    };
    assert!(
        status != 0 || declared == len || sigma.len() > declared,
        "a length that was taken is one that is there"
    );
    before.check(status, &[]);
    finite(status, sigma.values());
}

fn ratios(input: &mut Input) {
    let len = input.few(8);
    let [first, second] = [0; 2].map(|_| Memory::<f64>::floats(input, len, 1e3, 1e4));
    let [error1, error2, sigma] = [0; 3].map(|_| Memory::<f64>::floats(input, len, 1.0, 100.0));
    let rho = Memory::<f64>::floats(input, len, -1.0, 1.0);
    let (value, error) = (out(len), out(len));
    let before = Before::of(&[&value, &error]);
    let (to, to_error, declared) = (input.pointer(&value), input.pointer(&error), input.length(len));
    let (above, below) = (input.pointer(&first), input.pointer(&second));
    let (above_error, below_error, with) =
        (input.pointer(&error1), input.pointer(&error2), input.optional(&rho));
    let status = match input.few(4) {
        0 => call!(fixpair_ratio_of_means(
            to,
            to_error,
            above,
            above_error,
            below,
            below_error,
            with,
            declared
        )),
        1 => call!(fixpair_difference_of_means(
            to,
            to_error,
            above,
            above_error,
            below,
            below_error,
            with,
            input.pointer(&sigma),
            declared
        )),
        2 => call!(fixpair_pair_average(to, above, below, declared)),
        _ => call!(fixpair_sigma_per_simulation(
            to,
            to_error,
            above_error,
            declared,
            amount(input),
            amount(input)
        )),
    };
    answered(status, &before, &[&value, &error]);
}

fn factors(input: &mut Input) {
    let values = out(2);
    let before = Before::of(&[&values]);
    let (to, other) = (values.pointer(), values.pointer().wrapping_add(1));
    let mut near = |good: f64| input.about_number(good);
    let numbers = [12.1, 11.8, 0.76, 1.0, 5.2, 0.0, 100.0].map(&mut near);
    let [first, second, rho, beta, error, covariance, f_true] = numbers;
    let status = match input.few(8) {
        0 => call!(fixpair_delta_chi_squared(to, rho, input.about(4) as u32)),
        1 => call!(fixpair_hartlap_factor(to, amount(input), amount(input))),
        2 => call!(fixpair_percival_factor(to, amount(input), amount(input), amount(input))),
        3 => call!(fixpair_difference_sigma(to, first, second, rho)),
        4 => call!(fixpair_effective_volume(to, first, amount(input), second, amount(input))),
        5 => call!(fixpair_universality(to, other, beta, rho, first, error, covariance, f_true)),
        6 => call!(fixpair_control_variate_gain(to, first, second, rho, beta)),
        _ => call!(fixpair_control_variate_loss(to, amount(input), amount(input))),
    };
    answered(status, &before, &[&values]);
}

fn controls(input: &mut Input) {
    let (rows, values) = (input.few(7), input.few(4));
    let [y, c] = [0; 2].map(|_| Memory::<f64>::floats(input, rows * values, -1.0, 1.0));
    if input.flag() {
        let difference = Memory::zeros(1);
        let before = Before::of(&[&difference]);
        let len = input.length(y.len());
        let status = call!(fixpair_matched_difference(
            input.pointer(&difference),
            input.pointer(&y),
            input.pointer(&c),
            len
        ));
        before.check(status, &[]);
        return;
    }
    let (mu, error) =
        (Memory::<f64>::floats(input, values, -1.0, 1.0), Memory::<f64>::floats(input, values, 0.0, 1.0));
    let mut layout = layout();
    let asked = call!(fixpair_control_variates_scratch(&mut layout, rows));
    let scratch = scratch_for(input, asked, layout);
    let found = Memory::zeros(values);
    let before = Before::of(&[&found]);
    let status = call!(fixpair_control_variates(
        input.pointer(&found),
        input.length(values),
        input.pointer(&y),
        input.pointer(&c),
        rows,
        input.pointer(&mu),
        input.optional(&error),
        input.choice(2),
        input.about_number(1.0),
        input.pointer(&scratch).cast(),
        input.length(scratch.len())
    ));
    before.check(status, &[]);
}

/// A matrix that is symmetric for the most part, with a diagonal that dominates.
pub fn symmetric(input: &mut Input, side: usize) -> Memory<f64> {
    let mut of = Memory::<f64>::floats(input, side * side, -0.5, 0.5);
    if !input.odd(16) {
        let diagonal = input.about_number(2.0);
        let values = of.values_mut();
        for i in 0..side {
            values[i * side + i] = diagonal;
            for j in 0..i {
                values[i * side + j] = values[j * side + i];
            }
        }
    }
    of
}

fn matrices(input: &mut Input) {
    let (rows, values, controls) = (input.few(9), input.few(4), input.few(4));
    let mut layout = layout();
    if input.flag() {
        let (root, covariance) = (out(values * values), symmetric(input, values));
        let asked = call!(fixpair_covariance_root_scratch(&mut layout, input.about(4)));
        let _ = (asked, call!(fixpair_covariance_root_scratch(&mut layout, values)));
        let scratch = scratch_for(input, 0, layout);
        let before = Before::of(&[&root]);
        let status = call!(fixpair_covariance_root(
            input.pointer(&root),
            input.pointer(&covariance),
            values,
            input.pointer(&scratch).cast(),
            input.length(scratch.len())
        ));
        answered(status, &before, &[&root]);
        return;
    }
    let y = Memory::<f64>::floats(input, rows * values, -1.0, 1.0);
    let c = Memory::<f64>::floats(input, rows * controls, -1.0, 1.0);
    let (mu, of_mu) = (Memory::<f64>::floats(input, controls, -1.0, 1.0), symmetric(input, controls));
    let asked = call!(fixpair_carpool_scratch(&mut layout, values, controls));
    let scratch = scratch_for(input, asked, layout);
    let (mean, covariance, beta) = (out(values), out(values * values), out(values * controls));
    let before = Before::of(&[&mean, &covariance, &beta]);
    let with = if input.flag() { input.pointer(&of_mu).cast_const() } else { null() };
    let status = call!(fixpair_carpool(
        input.pointer(&mean),
        input.pointer(&covariance),
        input.pointer(&beta),
        input.pointer(&y),
        input.pointer(&c),
        rows,
        values,
        input.pointer(&mu),
        with,
        controls,
        input.pointer(&scratch).cast(),
        input.length(scratch.len())
    ));
    answered(status, &before, &[&mean, &covariance, &beta]);
}
