//! Background, growth, linear theory, tables over modes, and numbers that follow from a cosmology.

use crate::c::*;
use crate::check::{Before, finite};
use crate::hooks::{exec, pointer};
use crate::input::Input;
use crate::memory::Memory;
use crate::universe::{Rows, cosmology, linear, species};

pub fn run(data: &[u8]) {
    let input = &mut Input::new(data);
    match input.few(5) {
        0 => background(input),
        1 => spectra(input),
        2 => tables(input),
        3 => steps(input),
        _ => scalars(input),
    }
}

/// Scale factors or wavenumbers, increasing, now and then spoiled.
fn abscissae(input: &mut Input, scale: f64) -> Memory<f64> {
    let mut of = Memory::new(input.few(6), |place| scale * (place + 1) as f64);
    of.spoil(input);
    of
}

fn background(input: &mut Input) {
    let (cosmology, a) = (cosmology(input), abscissae(input, 0.2));
    let len = input.length(a.len());
    if input.flag() {
        let e = Memory::new(a.len(), |_| 7.0);
        let before = Before::of(&[&e]);
        let status = call!(fixpair_expansion(input.pointer(&e), input.pointer(&a), len, &cosmology));
        before.check(status, &[]);
    } else {
        let growth = Memory::zeros(a.len());
        let before = Before::of(&[&growth]);
        let status =
            call!(fixpair_growth_factors(input.pointer(&growth), input.pointer(&a), len, &cosmology));
        before.check(status, &[]);
    }
    let mut ratio = 0.0;
    let status = call!(fixpair_growth_suppression(&mut ratio, &cosmology));
    finite(status, &[ratio]);
    let mut delta = 0.0;
    let status = call!(fixpair_overdensity(
        &mut delta,
        input.choice(3),
        input.about_number(200.0),
        &cosmology,
        input.about_number(0.5)
    ));
    finite(status, &[delta]);
}

fn spectra(input: &mut Input) {
    let rows = Rows::new(input, 2);
    let (cosmology, linear) = (cosmology(input), linear(input, &rows));
    let k = abscissae(input, 0.05);
    let out = Memory::new(k.len(), |_| 7.0);
    let before = Before::of(&[&out]);
    let len = input.length(k.len());
    let (to, from) = (input.pointer(&out), input.pointer(&k));
    let status = match input.few(4) {
        0 => call!(fixpair_linear_power(to, from, len, &cosmology, &linear, input.about_number(1.0))),
        1 => call!(fixpair_linear_transfer(to, from, len, &cosmology, &linear)),
        2 => {
            call!(fixpair_alpha(to, from, len, &cosmology, &linear, input.about_number(1.0), input.choice(2)))
        }
        _ => {
            let mut sigma = 0.0;
            let status =
                call!(fixpair_linear_sigma(&mut sigma, input.about_number(8.0), &cosmology, &linear));
            finite(status, &[sigma]);
            return;
        }
    };
    before.check(status, &[]);
}

fn tables(input: &mut Input) {
    let rows = Rows::new(input, 5);
    let (cosmology, n) = (cosmology(input), input.side());
    let (linear, species) = (linear(input, &rows), species(input, &rows));
    let mut entries = 0;
    let _ = call!(fixpair_mode_table_length(&mut entries, n));
    let table = Memory::new(entries.min(512), |_| 7.0);
    let before = Before::of(&[&table]);
    let exec = exec(input);
    let (to, len, box_size) = (input.pointer(&table), input.length(table.len()), input.about_number(100.0));
    let status = match input.few(3) {
        0 => call!(fixpair_potential_amplitude_table(
            to,
            len,
            n,
            box_size,
            &cosmology,
            &linear,
            input.choice(2),
            pointer(&exec)
        )),
        1 => call!(fixpair_alpha_table(
            to,
            len,
            n,
            box_size,
            &cosmology,
            &linear,
            input.about_number(1.0),
            input.choice(2),
            pointer(&exec)
        )),
        _ => call!(fixpair_species_table(to, len, &species, input.choice(3), n, box_size, pointer(&exec))),
    };
    before.check(status, &[FIXPAIR_ERROR_HOOK]);
}

fn steps(input: &mut Input) {
    let cosmology = cosmology(input);
    let factors = Memory::zeros(1);
    let before = Before::of(&[&factors]);
    let (stepper, exponent) = (input.choice(3), input.about_number(FIXPAIR_COLA_EXPONENT));
    let [from, to, at] = [0.25, 0.5, 0.375].map(|a| input.about_number(a));
    let status = if input.flag() {
        call!(fixpair_drift_factors(input.pointer(&factors), &cosmology, stepper, exponent, from, to, at))
    } else {
        call!(fixpair_kick_factors(input.pointer(&factors), &cosmology, stepper, exponent, from, to, at))
    };
    before.check(status, &[]);
    let list = Memory::new(input.few(8), |_| 7.0);
    let before = Before::of(&[&list]);
    let (first, last) = (input.about_number(0.25), input.about_number(1.0));
    let (to, len) = (input.pointer(&list), input.length(list.len()));
    let status = if input.flag() {
        call!(fixpair_linear_steps(to, len, first, last))
    } else {
        call!(fixpair_logarithmic_steps(to, len, first, last))
    };
    before.check(status, &[]);
    assert!(status != 0 || list.values()[..len].is_sorted(), "steps go forward");
}

fn scalars(input: &mut Input) {
    let mut value = 0.0;
    let status = match input.few(3) {
        0 => call!(fixpair_radiation_density(
            &mut value,
            input.about_number(2.7),
            input.about_number(3.0),
            input.about_number(0.7)
        )),
        1 => call!(fixpair_particle_mass(
            &mut value,
            input.about_number(0.3),
            input.about_number(100.0),
            input.size() as u64
        )),
        _ => call!(fixpair_linking_length(
            &mut value,
            input.about_number(0.2),
            input.about_number(100.0),
            input.size() as u64
        )),
    };
    finite(status, &[value]);
}
