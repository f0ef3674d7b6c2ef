//! Claims about runs as programs: stopped and gone on with, shown between steps, on threads, refused.

use super::*;
use crate::exec::Threads;
use crate::pm::factors::linear_steps;
use crate::pm::outputs::Event;

#[test]
fn runs_stopped_at_any_step_go_on_with_the_same_bits() {
    fn check<T: Real>(stepper: Stepper) {
        let first = start::<T>(8, 1.0, Order::Second);
        let list = logarithmic(5, START, 1.0);
        let mut whole = first.clone();
        serial(16).through(&gravity(stepper), &mut whole, &list);
        for stop in 1..=5 {
            let mut parts = first.clone();
            let mut observe = |progress: &Progress<'_, T>| {
                if progress.step == stop { Verdict::Stop } else { Verdict::Continue }
            };
            let stopped = serial(16).run(&gravity(stepper), &mut parts, None, &list, None, &mut observe);
            assert_eq!(stopped, Err(Error::Stopped));
            assert_eq!(parts.epoch.position, list[stop]);
            assert_eq!(parts.epoch.velocity, half_step(list[stop - 1], list[stop]));
            serial(16).through(&gravity(stepper), &mut parts, &list);
            assert_eq!(parts, whole, "stopped at {stop}");
        }
        assert_eq!(whole.epoch, Epoch::at(1.0));
    }
    check::<f32>(Stepper::FastPm);
    check::<f64>(Stepper::Leapfrog);
}

#[test]
fn threads_change_no_bit() {
    fn check<T: Real>(stepper: Stepper) {
        let run = |exec: &'static dyn Exec| {
            // More than one chunk of particles.
            let mut particles = start::<T>(40, 1.0, Order::Second);
            let machine = Machine { mesh: 40, exec };
            machine.through(&gravity(stepper), &mut particles, &logarithmic(3, START, 1.0));
            particles
        };
        let one = run(&Serial);
        for threads in [2, 5] {
            assert!(run(Box::leak(Box::new(Threads::new(threads).unwrap()))) == one, "{threads} threads");
        }
    }
    check::<f32>(Stepper::FastPm);
    check::<f64>(Stepper::Leapfrog);
}

/// Runs with outputs; returns them.
fn shown(
    first: &Particles<f64>,
    list: &[f64],
    times: &[f64],
    stop: usize,
) -> (Particles<f64>, Vec<Particles<f64>>) {
    let mut particles = first.clone();
    let mut seen = Vec::new();
    loop {
        let (mut x, mut u) = (first.x.clone(), first.u.clone());
        // The arrays are the outputs' alone while they exist; the observer copies what it is shown.
        let mut outputs = Outputs {
            scale_factors: times,
            position: Components::triples(&mut x).unwrap(),
            velocity: Components::triples(&mut u).unwrap(),
        };
        let mut observe = |progress: &Progress<'_, f64>| {
            if progress.event == Event::Output {
                assert_eq!(progress.epoch, Epoch::at(times[progress.output]));
                let [x, u] = [&progress.position, &progress.velocity].map(|from| {
                    let mut to = vec![0.0; 3 * from.len()];
                    let components = &mut Components::triples(&mut to).unwrap();
                    crate::pm::copy_components(components, from, &Serial).unwrap();
                    to
                });
                seen.push(Particles { x, u, epoch: progress.epoch });
            }
            if progress.step == stop && progress.event == Event::Step {
                Verdict::Stop
            } else {
                Verdict::Continue
            }
        };
        let gravity = gravity(Stepper::FastPm);
        match serial(16).run(&gravity, &mut particles, None, list, Some(&mut outputs), &mut observe) {
            Ok(()) => return (particles, seen),
            Err(error) => assert_eq!(error, Error::Stopped),
        }
    }
}

#[test]
fn outputs_at_steps_are_the_steps_and_between_them_converge() {
    let first = start::<f64>(8, 1.0, Order::Second);
    let list = logarithmic(4, START, 1.0);
    let (last, seen) = shown(&first, &list, &list, usize::MAX);
    assert_eq!(seen.len(), 5);
    assert_eq!(seen[0], first, "the start, as it was");
    assert_eq!(seen[4], last, "the end, bit for bit");
    for end in 1..4 {
        let mut short = first.clone();
        serial(16).through(&gravity(Stepper::FastPm), &mut short, &list[..=end]);
        assert_eq!(seen[end], short, "a run that ends there, bit for bit");
    }
    // Against a fine run that has a step there.
    let time = 0.37;
    let mut truth = first.clone();
    serial(16).through(&gravity(Stepper::FastPm), &mut truth, &logarithmic(400, START, time));
    let errors = [16, 32, 64].map(|steps| {
        let (_, seen) = shown(&first, &logarithmic(steps, START, 1.0), &[time], usize::MAX);
        [distance(&seen[0].x, &truth.x), distance(&seen[0].u, &truth.u)]
    });
    for i in 0..2 {
        let order = 0.5 * (errors[0][i] / errors[2][i]).log2();
        assert!(order > 1.5, "{errors:?}");
    }
}

#[test]
fn outputs_come_once_and_alike_from_a_run_that_was_stopped() {
    let first = start::<f64>(8, 1.0, Order::Second);
    let list = logarithmic(4, START, 1.0);
    let middle = half_step(list[2], list[3]);
    let times = [START, 0.1, list[2], 0.2, middle, 0.99 * list[3], 0.9, 1.0];
    let (whole, seen) = shown(&first, &list, &times, usize::MAX);
    assert_eq!(seen.len(), times.len());
    for stop in 1..=4 {
        let (parts, again) = shown(&first, &list, &times, stop);
        assert_eq!(parts, whole);
        assert_eq!(again, seen, "stopped at {stop}");
    }
}

#[test]
fn a_run_told_to_stop_at_an_output_ends_after_its_step() {
    let first = start::<f64>(8, 1.0, Order::Second);
    let list = logarithmic(4, START, 1.0);
    let mut whole = first.clone();
    serial(16).through(&gravity(Stepper::FastPm), &mut whole, &list);
    // Just after the third entry, and in the last step's second half, behind which there is nothing left to stop.
    for (time, stopped_at) in [(1.01 * list[2], Some(3)), (0.99, None)] {
        let (mut x, mut u) = (first.x.clone(), first.u.clone());
        let mut outputs = Outputs {
            scale_factors: &[time],
            position: Components::triples(&mut x).unwrap(),
            velocity: Components::triples(&mut u).unwrap(),
        };
        let mut parts = first.clone();
        let mut observe = |progress: &Progress<'_, f64>| {
            if progress.event == Event::Output { Verdict::Stop } else { Verdict::Continue }
        };
        let fastpm = gravity(Stepper::FastPm);
        let outcome = serial(16).run(&fastpm, &mut parts, None, &list, Some(&mut outputs), &mut observe);
        assert_eq!(outcome, stopped_at.map_or(Ok(()), |_| Err(Error::Stopped)));
        assert_eq!(parts.epoch.position, list[stopped_at.unwrap_or(4)]);
        if stopped_at.is_some() {
            serial(16).through(&fastpm, &mut parts, &list);
        }
        assert_eq!(parts, whole);
    }
}

#[test]
fn what_cannot_be_run_is_refused_before_particles_move() {
    let first = start::<f64>(8, 1.0, Order::Second);
    let good = logarithmic(3, START, 1.0);
    let fastpm = gravity(Stepper::FastPm);
    let refused = |gravity: &Gravity, list: &[f64], epoch: Epoch, error: Error| {
        let mut particles = Particles { epoch, ..first.clone() };
        let outcome = serial(16).run(gravity, &mut particles, None, list, None, &mut |_| Verdict::Continue);
        assert_eq!(outcome, Err(error));
        assert_eq!(particles, Particles { epoch, ..first.clone() });
    };
    let here = Epoch::at(START);
    refused(&fastpm, &[], here, Error::Length);
    refused(&fastpm, &[START, START], here, Error::Range);
    refused(&fastpm, &[START, f64::NAN], here, Error::NotFinite);
    refused(&fastpm, &[START, 11.0], here, Error::Range);
    refused(&fastpm, &good, Epoch::at(0.5), Error::Range);
    refused(&fastpm, &good, Epoch { velocity: 0.031, ..here }, Error::Range);
    refused(&gravity(COLA), &good, here, Error::Null);
    refused(&Gravity { hubble: 0.0, ..fastpm }, &good, here, Error::Range);
    refused(&Gravity { hubble: f64::NAN, ..fastpm }, &good, here, Error::NotFinite);
    refused(&Gravity { box_size: -1.0, ..fastpm }, &good, here, Error::Range);
    let mut linear = vec![0.0; 3];
    linear_steps(&mut linear, START, 1.0).unwrap();
    for times in [[0.5, 0.5], [0.01, 0.5], [0.5, 1.1]] {
        let (mut x, mut u) = (first.x.clone(), first.u.clone());
        let mut outputs = Outputs {
            scale_factors: &times,
            position: Components::triples(&mut x).unwrap(),
            velocity: Components::triples(&mut u).unwrap(),
        };
        let mut particles = first.clone();
        let mut go = |_: &Progress<'_, f64>| Verdict::Continue;
        let outcome = serial(16).run(&fastpm, &mut particles, None, &linear, Some(&mut outputs), &mut go);
        assert_eq!(outcome, Err(Error::Range));
    }
}
