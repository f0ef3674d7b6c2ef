//! Claims about drift and kick factors.

use std::vec;
use std::vec::Vec;

use crate::cosmology::{Cosmology, Growth, growth};
use crate::pm::factors::*;
use crate::status::Error;

const ALL: [Stepper; 3] = [Stepper::FastPm, Stepper::Leapfrog, Stepper::Cola { exponent: COLA_EXPONENT }];

/// Displacement and canonical velocity of a growing mode: D, D2, G, G2.
fn mode(cosmology: &Cosmology, a: f64) -> [f64; 4] {
    let Growth { d, f, d2, f2, .. } = growth(cosmology, a).unwrap();
    let rate = a * a * cosmology.expansion(a).unwrap();
    [d, d2, rate * f * d, rate * f2 * d2]
}

fn close(got: f64, wanted: f64, tolerance: f64) {
    assert!((got - wanted).abs() <= tolerance * wanted.abs(), "{got} is not {wanted}");
}

/// Kick, drift, kick, from a to b, of x = psi and v under F(a) and F(b); COLA's displacements are (1, second).
fn step(
    stepper: Stepper,
    cosmology: &Cosmology,
    [a, b]: [f64; 2],
    second: f64,
    force: [f64; 2],
    x: f64,
    v: f64,
) -> [f64; 2] {
    let middle = half_step(a, b);
    let apply = |f: StepFactors, to: f64| f.factor * to + f.first + f.second * second;
    let v = v + apply(stepper.kick(cosmology, a, middle, a).unwrap(), force[0]);
    let x = x + apply(stepper.drift(cosmology, a, b, middle).unwrap(), v);
    let v = v + apply(stepper.kick(cosmology, middle, b, b).unwrap(), force[1]);
    [x, v]
}

#[test]
fn fastpm_moves_a_growing_mode_exactly_in_one_step() {
    let curved = Cosmology { omega_de: 0.6, w0: -0.9, wa: 0.2, ..Cosmology::goliat() };
    for cosmology in [Cosmology::goliat(), curved, Cosmology::flat(1.0, 0.05, 0.7, 1.0)] {
        for [a, b] in [[1.0 / 33.0, 1.0], [0.5, 0.51], [0.1, 2.0]] {
            let ([start, _, speed, _], [end, _, last, _]) = (mode(&cosmology, a), mode(&cosmology, b));
            let [x, v] = step(Stepper::FastPm, &cosmology, [a, b], 0.0, [start, end], start, speed);
            // Growth is accurate to 1e-10.
            close(x, end, 1e-9);
            close(v, last, 1e-9);
        }
    }
}

#[test]
fn cola_moves_second_order_lagrangian_theory_exactly_in_one_step() {
    let cosmology = Cosmology::goliat();
    let second = 0.3;
    for exponent in [COLA_EXPONENT, 1.0, -0.7] {
        for [a, b] in [[1.0 / 33.0, 1.0], [0.5, 0.51]] {
            let [[d, d2, g, g2], [e, e2, h, h2]] = [a, b].map(|a| mode(&cosmology, a));
            let force = [d + (d2 - d * d) * second, e + (e2 - e * e) * second];
            let (x, v) = (d + d2 * second, g + g2 * second);
            let [x, v] = step(Stepper::Cola { exponent }, &cosmology, [a, b], second, force, x, v);
            close(x, e + e2 * second, 1e-8);
            close(v, h + h2 * second, 1e-8);
        }
    }
}

#[test]
fn leapfrog_has_the_closed_forms_of_einstein_de_sitter() {
    let cosmology = Cosmology::flat(1.0, 0.05, 0.7, 1.0);
    let (a, b) = (0.1_f64, 0.7_f64);
    let drift = Stepper::Leapfrog.drift(&cosmology, a, b, 0.3).unwrap();
    close(drift.factor, 2.0 / a.sqrt() - 2.0 / b.sqrt(), 1e-12);
    let kick = Stepper::Leapfrog.kick(&cosmology, a, b, 0.3).unwrap();
    close(kick.factor, 3.0 * (b.sqrt() - a.sqrt()), 1e-12);
    assert_eq!([drift.first, drift.second, kick.first, kick.second], [0.0; 4]);
}

#[test]
fn short_steps_of_all_steppers_agree_to_second_order() {
    let cosmology = Cosmology::goliat();
    for part in [Stepper::drift, Stepper::kick] {
        for stepper in [ALL[0], ALL[2]] {
            let difference = |width: f64| {
                let (a, b) = (0.5 * (1.0 - width), 0.5 * (1.0 + width));
                let wanted = part(&ALL[1], &cosmology, a, b, 0.5).unwrap().factor;
                (part(&stepper, &cosmology, a, b, 0.5).unwrap().factor / wanted - 1.0).abs()
            };
            let ratio = difference(0.08) / difference(0.04);
            assert!((ratio - 4.0).abs() < 0.1, "{stepper:?} {ratio}");
        }
    }
}

#[test]
fn factors_of_any_stepper_add_up_and_turn_round() {
    let cosmology = Cosmology::goliat();
    for part in [Stepper::drift, Stepper::kick] {
        for stepper in ALL {
            let factors = |a, b| {
                let StepFactors { factor, first, second } = part(&stepper, &cosmology, a, b, 0.4).unwrap();
                [factor, first, second]
            };
            let (whole, one, two) = (factors(0.2, 0.6), factors(0.2, 0.35), factors(0.35, 0.6));
            let (back, none) = (factors(0.6, 0.2), factors(0.3, 0.3));
            for i in 0..3 {
                // The growth of two calls differs by rounding only; terms of first and second cancel in part.
                assert!((whole[i] - one[i] - two[i]).abs() < 1e-11, "{stepper:?}");
                assert!((whole[i] + back[i]).abs() < 1e-11, "{stepper:?}");
                assert_eq!(none[i], 0.0, "{stepper:?}");
            }
        }
    }
}

#[test]
fn cola_has_the_limit_of_a_logarithm_for_small_exponents() {
    let cosmology = Cosmology::goliat();
    let kick = |exponent| Stepper::Cola { exponent }.kick(&cosmology, 0.3, 0.5, 0.4).unwrap().factor;
    let expansion = cosmology.expansion(0.4).unwrap();
    let wanted = 1.5 * cosmology.omega_m * 0.4 * (0.5_f64 / 0.3).ln() / (0.16 * expansion);
    for exponent in [1e-9, -1e-12, 1e-15, 1e-300] {
        close(kick(exponent), wanted, 1e-8);
    }
}

#[test]
fn lists_of_steps_begin_and_end_exactly() {
    let (mut linear, mut logarithmic) = (vec![0.0; 8], vec![0.0; 8]);
    linear_steps(&mut linear, 1.0 / 33.0, 1.0).unwrap();
    logarithmic_steps(&mut logarithmic, 1.0 / 33.0, 1.0).unwrap();
    for list in [&linear, &logarithmic] {
        assert_eq!([list[0], list[7]], [1.0 / 33.0, 1.0]);
    }
    let ratios: Vec<f64> = logarithmic.windows(2).map(|pair| pair[1] / pair[0]).collect();
    let widths: Vec<f64> = linear.windows(2).map(|pair| pair[1] - pair[0]).collect();
    for i in 0..7 {
        close(ratios[i], 33_f64.powf(1.0 / 7.0), 1e-14);
        close(widths[i], 32.0 / 33.0 / 7.0, 1e-13);
    }
    // Ends that are neighbours, where a logarithm and back is off by more than lies between them, and the ends of all numbers.
    let ends = [
        (0.001_250_636_489_843_252_2, 0.001_250_636_489_843_253),
        (5.576_475_516_412_832, 5.576_475_516_412_833),
        (5e-324, 1e-323),
        (5e-324, f64::MAX),
    ];
    for (from, to) in ends {
        for steps in [linear_steps, logarithmic_steps] {
            steps(&mut linear, from, to).unwrap();
            assert!(linear.is_sorted() && (linear[0], linear[7]) == (from, to), "{linear:?}");
        }
    }
    assert_eq!(linear_steps(&mut linear[..1], 0.1, 1.0), Err(Error::Length));
    assert_eq!(linear_steps(&mut linear, 1.0, 1.0), Err(Error::Range));
    assert_eq!(logarithmic_steps(&mut linear, 0.0, 1.0), Err(Error::Range));
    assert_eq!(logarithmic_steps(&mut linear, f64::NAN, 1.0), Err(Error::NotFinite));
}

#[test]
fn impossible_times_and_exponents_are_refused() {
    let cosmology = Cosmology::goliat();
    for stepper in ALL {
        for part in [Stepper::drift, Stepper::kick] {
            let ask = |a, b, at| part(&stepper, &cosmology, a, b, at);
            assert_eq!(ask(0.0, 0.5, 0.1), Err(Error::Range));
            assert_eq!(ask(0.1, 11.0, 0.1), Err(Error::Range));
            assert_eq!(ask(0.1, 0.5, f64::NAN), Err(Error::NotFinite));
        }
    }
    for (exponent, error) in [(0.0, Error::Range), (11.0, Error::Range), (f64::NAN, Error::NotFinite)] {
        assert_eq!(Stepper::Cola { exponent }.kick(&cosmology, 0.1, 0.2, 0.1), Err(error));
    }
}
