//! Bias, its likelihood, fits, posteriors and contours. What is OK is finite.

use fixpair::variance::bias::Bias;
use fixpair::variance::likelihood::BiasLikelihood as Likelihood;

use crate::check::{Before, finite};
use crate::hooks::{layout, scratch_for};
use crate::input::Input;
use crate::memory::Memory;
use crate::rooms::statistics::answered;

pub fn run(data: &[u8]) {
    let input = &mut Input::new(data);
    match input.few(4) {
        0 => models(input),
        1 => fits(input),
        2 => grids(input),
        _ => readings(input),
    }
}

fn bias(input: &mut Input) -> Bias {
    let of = Memory::<Bias>::zeros(1);
    must!(fixpair_bias_init(of.pointer()));
    let mut of = of.values()[0];
    of.b_g = input.about_number(2.0);
    of.p = input.about_number(1.0);
    of.f_nl = input.about_number(50.0);
    of.delta_c = input.about_number(1.686);
    of
}

/// Bins of a halo spectrum: P, sigma, P_lin, alpha.
struct Data {
    power: Memory<f64>,
    sigma: Memory<f64>,
    linear: Memory<f64>,
    alpha: Memory<f64>,
}

impl Data {
    fn new(input: &mut Input, len: usize) -> Self {
        Self {
            power: Memory::floats(input, len, 1e4, 2e4),
            sigma: Memory::floats(input, len, 100.0, 1e3),
            linear: Memory::floats(input, len, 1e3, 1e4),
            alpha: Memory::floats(input, len, 100.0, 1e4),
        }
    }
}

fn models(input: &mut Input) {
    let len = input.few(8);
    let (data, bias) = (Data::new(input, len), bias(input));
    let [value, error] = [0; 2].map(|_| Memory::new(len, |_| 7.0));
    let before = Before::of(&[&value, &error]);
    let (to, to_error, declared) = (input.pointer(&value), input.pointer(&error), input.length(len));
    let (linear, spectrum) = (input.pointer(&data.linear), input.choice(2));
    let status = match input.few(3) {
        0 => call!(fixpair_bias_of_k(to, &bias, input.pointer(&data.alpha), declared)),
        1 => call!(fixpair_halo_power(to, &bias, linear, input.pointer(&data.alpha), declared, spectrum)),
        _ => call!(fixpair_measured_bias(
            to,
            to_error,
            input.pointer(&data.power),
            input.pointer(&data.sigma),
            linear,
            declared,
            spectrum
        )),
    };
    answered(status, &before, &[&value, &error]);
}

/// A likelihood of a few bins, merged from two, or one that the caller received from anywhere.
fn likelihood(input: &mut Input) -> Memory<Likelihood> {
    let (mut of, other) = (Memory::<Likelihood>::zeros(1), Memory::<Likelihood>::zeros(1));
    must!(fixpair_likelihood_init(of.pointer()));
    must!(fixpair_likelihood_init(other.pointer()));
    let len = 1 + input.few(7);
    let data = Data::new(input, len);
    let before = Before::of(&[&of]);
    let status = call!(fixpair_likelihood_add(
        of.pointer(),
        input.pointer(&data.power),
        input.pointer(&data.sigma),
        input.pointer(&data.linear),
        input.pointer(&data.alpha),
        input.length(len),
        input.choice(2)
    ));
    before.check(status, &[]);
    if input.flag() {
        let root = Memory::<f64>::floats(input, len * len, 1.0, 1e3);
        let mut layout = layout();
        let asked = call!(fixpair_likelihood_add_correlated_scratch(&mut layout, len));
        let scratch = scratch_for(input, asked, layout);
        let before = Before::of(&[&other]);
        let status = call!(fixpair_likelihood_add_correlated(
            other.pointer(),
            input.pointer(&data.power),
            input.pointer(&data.linear),
            input.pointer(&data.alpha),
            input.pointer(&root),
            input.length(len),
            input.about(8),
            input.about_number(1.0),
            input.pointer(&scratch).cast(),
            input.length(scratch.len())
        ));
        before.check(status, &[]);
        let before = Before::of(&[&of]);
        let status = call!(fixpair_likelihood_merge(of.pointer(), other.pointer()));
        before.check(status, &[]);
    }
    if input.odd(8) {
        of.values_mut()[0].root[input.few(6)][input.few(6)] = input.number();
    }
    // What the data's pointers led to is gone.
    input.shown.clear();
    of
}

fn free(input: &mut Input) -> (u32, usize) {
    let free = if input.odd(32) { input.word() as u32 } else { [1, 5, 4, 2, 3, 0, 6, 7][input.few(8)] };
    let parameters = (free & 7).count_ones() as usize;
    (free, if input.odd(16) { input.few(4) } else { parameters })
}

fn fits(input: &mut Input) {
    let (likelihood, start, (free, parameters)) = (likelihood(input), bias(input), free(input));
    let fit = Memory::zeros(1);
    let mut value = 0.0;
    let status = call!(fixpair_likelihood_chi_squared(&mut value, likelihood.pointer(), &start));
    finite(status, &[value]);
    let before = Before::of(&[&fit]);
    if input.flag() {
        let status = call!(fixpair_fit_bias(input.pointer(&fit), likelihood.pointer(), &start, free));
        before.check(status, &[]);
        return;
    }
    let (posteriors, points) = (Memory::zeros(parameters), 16 + input.few(16));
    let mut layout = layout();
    let _ = call!(fixpair_bias_posterior_scratch(&mut layout, input.about(64)));
    let asked = call!(fixpair_bias_posterior_scratch(&mut layout, points));
    let scratch = scratch_for(input, asked, layout);
    let status = call!(fixpair_bias_posterior(
        input.pointer(&fit),
        input.pointer(&posteriors),
        input.length(parameters),
        likelihood.pointer(),
        &start,
        free,
        points,
        input.about_number(0.68),
        input.pointer(&scratch).cast(),
        input.length(scratch.len())
    ));
    before.check(status, &[]);
}

fn grids(input: &mut Input) {
    let (likelihood, start, (free, parameters)) = (likelihood(input), bias(input), free(input));
    let mut ranges = Memory::new(2 * parameters, |place| place as f64);
    let before = Before::of(&[&ranges]);
    let status = call!(fixpair_bias_range(
        input.pointer(&ranges),
        input.length(parameters),
        likelihood.pointer(),
        &start,
        free
    ));
    answered(status, &before, &[&ranges]);
    ranges.spoil(input);
    let points = Memory::new(parameters, |_| input.about(6));
    let cells = points.values().iter().fold(1_usize, |cells, &points| cells.saturating_mul(points));
    let grid = Memory::new(if cells > 256 || parameters == 0 { 8 } else { cells }, |_| 7.0);
    let before = Before::of(&[&grid]);
    let status = call!(fixpair_bias_grid(
        input.pointer(&grid),
        input.length(grid.len()),
        likelihood.pointer(),
        &start,
        free,
        input.pointer(&ranges),
        input.pointer(&points),
        parameters
    ));
    answered(status, &before, &[&grid]);
}

fn readings(input: &mut Input) {
    let points = [1 + input.few(7), 1 + input.few(7)];
    let grid = Memory::<f64>::floats(input, points[0] * points[1], 0.0, 10.0);
    let ranges = Memory::<f64>::new(4, |place| (place % 2) as f64);
    let (low, high) = (input.about_number(0.0), input.about_number(1.0));
    let of = input.pointer(&grid);
    match input.few(3) {
        0 => {
            let axis = input.choice(2);
            let density = Memory::new(if axis == 1 { points[1] } else { points[0] }, |_| 7.0);
            let before = Before::of(&[&density]);
            let status =
                call!(fixpair_marginal(input.pointer(&density), of, points[0], points[1], axis, low, high));
            answered(status, &before, &[&density]);
        }
        1 => {
            let posterior = Memory::zeros(1);
            let before = Before::of(&[&posterior]);
            let len = input.length(grid.len());
            let status = call!(fixpair_read_posterior(
                input.pointer(&posterior),
                of,
                len,
                low,
                high,
                input.about_number(0.68)
            ));
            before.check(status, &[]);
        }
        _ => {
            let (level, mut count) = (input.about_number(5.0), 0);
            let with = input.pointer(&ranges);
            let status = call!(fixpair_contours(
                core::ptr::null_mut(),
                0,
                &mut count,
                of,
                points[0],
                points[1],
                with,
                level
            ));
            let room = if status == 0 && !input.odd(4) { count } else { input.few(64) };
            let segments = Memory::new(4 * room, |_| 7.0);
            let before = Before::of(&[&segments]);
            let to = input.pointer(&segments);
            let mut again = 0;
            let status = call!(fixpair_contours(
                to,
                input.length(room),
                &mut again,
                of,
                points[0],
                points[1],
                with,
                level
            ));
            before.check(status, &[]);
            assert!(status != 0 || again <= room.max(count), "segments fit");
            finite(status, segments.values());
        }
    }
}
