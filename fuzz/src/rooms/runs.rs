//! Particle-mesh runs of a few steps.

use core::ffi::c_void;
use core::ptr::null;

use crate::c::*;
use crate::check::Before;
use crate::clouds::{BOX, Cloud};
use crate::hooks::{exec, layout, pointer, scratch_for, some_double, some_single};
use crate::input::Input;
use crate::memory::Memory;

pub fn run(data: &[u8]) {
    let input = &mut Input::new(data);
    if input.flag() { run_f32(input) } else { run_f64(input) }
}

/// Stops after so many events.
unsafe extern "C" fn observe(context: *mut c_void, progress: *const fixpair_progress) -> i32 {
    // SAFETY: the library's promise, and the context of `run`.
    let (progress, left) = unsafe { (&*progress, &mut *context.cast::<usize>()) };
    assert!(progress.step <= progress.steps && (0..2).contains(&progress.event), "progress goes forward");
    *left = left.wrapping_sub(1);
    i32::from(*left == 0)
}

fn gravity(input: &mut Input) -> fixpair_gravity {
    let of = Memory::<fixpair_gravity>::zeros(1);
    must!(fixpair_gravity_init(of.pointer()));
    let mut of = of.values()[0];
    of.cosmology = crate::universe::cosmology(input);
    of.law = crate::rooms::particles::force_law(input);
    of.box_size = input.about_number(BOX);
    of.hubble = input.about_number(100.0);
    of.cola_exponent = input.about_number(FIXPAIR_COLA_EXPONENT);
    of.stepper = input.choice(3);
    of.window = 1 + input.choice(4).min(1 << 20);
    if input.odd(64) {
        of.struct_size = input.size();
    }
    of
}

/// Scale factors that increase for the most part.
fn times(input: &mut Input, most: usize) -> Memory<f64> {
    let mut of = Memory::new(input.few(most + 1), |place| 0.25 + 0.25 * place as f64);
    of.spoil(input);
    of
}

macro_rules! in_precision {
    ($r:ident, $some:ident) => {
        pastey::paste! {
            fn [<run_ $r>](input: &mut Input) {
                let fft = $some(input);
                let count = input.few(24);
                let places = Cloud::<$r>::places(input, count, BOX);
                let out_places = Cloud::<$r>::places(input, count, BOX);
                let [moved, out_moved, first, second] = [0; 4].map(|_| Cloud::<$r>::between(input, count, -10.0, 10.0));
                let (gravity, steps, dates) = (gravity(input), times(input, 4), times(input, 3));
                let outputs = [<fixpair_outputs_ $r>] {
                    scale_factors: input.pointer(&dates),
                    length: input.length(dates.len()),
                    position: out_places.components(input),
                    velocity: out_moved.components(input),
                };
                let displacements = [<fixpair_displacements_ $r>] {
                    first: first.positions(input),
                    second: second.positions(input),
                    scale_factor: input.about_number(0.25),
                };
                let mut layout = layout();
                let asked = call!([<fixpair_evolve_scratch_ $r>](&mut layout, &fft, count, gravity.window));
                let scratch = scratch_for(input, asked, layout);
                let meshes = [0; 3].map(|_| Memory::<$r>::new(fft.length.min(4096), |_| 7.0));
                let epoch = Memory::<fixpair::pm::evolve::Epoch>::zeros(1);
                // SAFETY: an epoch is two doubles, and nobody else touches this one.
                unsafe { epoch.pointer().cast::<[f64; 2]>().write([0, 1].map(|_| input.about_number(0.25))) };
                // SAFETY: as above.
                let began = unsafe { epoch.pointer().cast::<f64>().read() };
                let mut left = input.few(4);
                let observer = fixpair_observer { context: (&raw mut left).cast(), observe: Some(observe) };
                let exec = exec(input);
                let (position, velocity) = (places.components(input), moved.components(input));
                let before = Before::of(&[&places.memory, &moved.memory, &epoch]);
                let gaps = [places.gaps(), moved.gaps()];
                let [mesh1, mesh2, mesh3] = [0, 1, 2].map(|mesh| input.pointer(&meshes[mesh]));
                let status = call!([<fixpair_evolve_ $r>](
                    &position, &velocity, input.pointer(&epoch), &gravity, if input.flag() { &displacements } else { null() },
                    input.pointer(&steps), input.length(steps.len()), if input.flag() { &outputs } else { null() },
                    mesh1, mesh2, mesh3, input.length(meshes[0].len()), &fft, input.pointer(&scratch).cast(), input.length(scratch.len()),
                    if input.flag() { &observer } else { null() }, pointer(&exec)
                ));
                before.check(status, &[FIXPAIR_ERROR_HOOK, FIXPAIR_ERROR_NOT_FINITE, FIXPAIR_ERROR_STOPPED]);
                assert_eq!(gaps, [places.gaps(), moved.gaps()], "between the particles");
                // SAFETY: as above.
                let ended = unsafe { epoch.pointer().cast::<f64>().read() };
                if status == 0 && places.shown(position.x, position.length) && moved.shown(velocity.x, velocity.length) {
                    assert!(moved.finite(), "velocities are numbers at the end of a run");
                    assert!(began == ended || places.inside(gravity.box_size), "a run leaves particles that it moves in the box");
                }
            }
        }
    };
}

in_precision!(f64, some_double);
in_precision!(f32, some_single);
