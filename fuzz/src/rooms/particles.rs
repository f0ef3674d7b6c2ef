//! Deposit, read-out, kicks, drifts and forces.

use core::ptr::null;

use crate::bricks::{CELLS, Gaps, MODES, mesh, region, whole};
use crate::c::*;
use crate::check::Before;
use crate::clouds::{BOX, Cloud};
use crate::hooks::{exec, layout, pointer, scratch_for};
use crate::input::Input;
use crate::memory::Memory;

pub fn run(data: &[u8]) {
    let input = &mut Input::new(data);
    match input.few(10) {
        0 => deposit_f64(input),
        1 => deposit_f32(input),
        2 => read_out_f64(input),
        3 => read_out_f32(input),
        4 => kick_f64(input),
        5 => kick_f32(input),
        6 => drift_f64(input),
        7 => drift_f32(input),
        8 => forces_f64(input),
        _ => forces_f32(input),
    }
}

/// A mesh that holds all particles for the most part.
fn some_region(input: &mut Input) -> fixpair_brick {
    if input.flag() { region(input) } else { whole(input.small_side(), CELLS) }
}

fn window(input: &mut Input) -> i32 {
    1 + input.choice(4).min(1 << 20)
}

fn shift(input: &mut Input) -> f64 {
    [0.0, 0.5, input.about_number(0.25)][input.few(3)]
}

/// The law of the initialiser, or any other.
pub fn force_law(input: &mut Input) -> fixpair_force_law {
    let of = Memory::<fixpair_force_law>::zeros(1);
    must!(fixpair_force_law_init(of.pointer()));
    let mut of = of.values()[0];
    if input.flag() {
        of.laplacian = input.choice(3);
        of.gradient = input.choice(3);
        of.window = input.choice(5);
        of.window_power = 1 + input.choice(2).min(1 << 20);
        let scale = [0.0, 10.0][input.few(2)];
        of.split_scale = input.about_number(scale);
    }
    if input.odd(64) {
        of.struct_size = input.size();
    }
    of
}

macro_rules! in_precision {
    ($r:ident) => {
        pastey::paste! {
            fn [<deposit_ $r>](input: &mut Input) {
                let region = some_region(input);
                let mesh = mesh::<$r>(input, &region);
                let count = input.few(40);
                let cloud = Cloud::<$r>::places(input, count, BOX);
                let weights_stride = 1 + input.few(2);
                let weights = Memory::<$r>::floats(input, weights_stride * count, -1.0, 2.0);
                let (box_size, window, shift) = (input.about_number(BOX), window(input), shift(input));
                let mut layout = layout();
                let asked = call!([<fixpair_deposit_scratch_ $r>](&mut layout, &region, count, window));
                let scratch = scratch_for(input, asked, layout);
                let (position, exec) = (cloud.positions(input), exec(input));
                let (before, gaps) = (Before::of(&[&mesh]), Gaps::of(&mesh, &region));
                let status = call!([<fixpair_deposit_ $r>](
                    input.pointer(&mesh), input.length(mesh.len()), &region, &position, input.optional(&weights), weights_stride, box_size,
                    window, shift, input.pointer(&scratch).cast(), input.length(scratch.len()), pointer(&exec)
                ));
                before.check(status, &[FIXPAIR_ERROR_HOOK, FIXPAIR_ERROR_NOT_FINITE, FIXPAIR_ERROR_OUTSIDE]);
                gaps.check(&mesh);
            }

            fn [<read_out_ $r>](input: &mut Input) {
                let region = some_region(input);
                let mesh = mesh::<$r>(input, &region);
                let count = input.few(40);
                let cloud = Cloud::<$r>::places(input, count, BOX);
                let values_stride = 1 + input.few(2);
                let values = Memory::<$r>::floats(input, values_stride * count, 7.0, 8.0);
                let (box_size, window, shift) = (input.about_number(BOX), window(input), shift(input));
                let mut layout = layout();
                let asked = call!([<fixpair_read_out_scratch_ $r>](&mut layout, &region, count, window));
                let scratch = scratch_for(input, asked, layout);
                let (position, exec) = (cloud.positions(input), exec(input));
                let before = Before::of(&[&values]);
                let status = call!([<fixpair_read_out_ $r>](
                    input.pointer(&values), values_stride, input.pointer(&mesh), input.length(mesh.len()), &region, &position, box_size,
                    window, shift, input.pointer(&scratch).cast(), input.length(scratch.len()), pointer(&exec)
                ));
                before.check(status, &[FIXPAIR_ERROR_HOOK, FIXPAIR_ERROR_NOT_FINITE, FIXPAIR_ERROR_OUTSIDE]);
            }

            fn [<kick_ $r>](input: &mut Input) {
                let region = some_region(input);
                let mesh = mesh::<$r>(input, &region);
                let (y, z) = (Memory::<$r>::floats(input, mesh.len(), -1.0, 1.0), Memory::<$r>::floats(input, mesh.len(), -1.0, 1.0));
                let count = input.few(40);
                let cloud = Cloud::<$r>::places(input, count, BOX);
                let [moved, first, second] = [0, 1, 2].map(|_| Cloud::<$r>::between(input, count, -1.0, 1.0));
                let (box_size, window, shift) = (input.about_number(BOX), window(input), shift(input));
                let mut layout = layout();
                let asked = call!([<fixpair_kick_scratch_ $r>](&mut layout, &region, count, window));
                let scratch = scratch_for(input, asked, layout);
                let (velocity, position) = (moved.components(input), cloud.positions(input));
                let (psi1, psi2) = (first.positions(input), second.positions(input));
                let [factor1, factor2] = [0, 1].map(|_| [0.0, input.about_number(1.0)][input.few(2)]);
                let exec = exec(input);
                let (before, gaps) = (Before::of(&[&moved.memory]), moved.gaps());
                let status = call!([<fixpair_kick_ $r>](
                    &velocity, &position, input.pointer(&mesh), input.pointer(&y), input.pointer(&z), input.length(mesh.len()), &region,
                    box_size, window, shift, input.about_number(1.0), input.about_number(1.0), factor1, factor2,
                    if input.flag() { &psi1 } else { null() }, if input.flag() { &psi2 } else { null() },
                    input.pointer(&scratch).cast(), input.length(scratch.len()), pointer(&exec)
                ));
                before.check(status, &[FIXPAIR_ERROR_HOOK, FIXPAIR_ERROR_NOT_FINITE, FIXPAIR_ERROR_OUTSIDE]);
                assert_eq!(gaps, moved.gaps(), "between the velocities");
            }

            fn [<drift_ $r>](input: &mut Input) {
                let count = input.few(40);
                let cloud = Cloud::<$r>::places(input, count, BOX);
                let [moved, first, second] = [0, 1, 2].map(|_| Cloud::<$r>::between(input, count, -1.0, 1.0));
                let (position, velocity) = (cloud.components(input), moved.positions(input));
                let (psi1, psi2) = (first.positions(input), second.positions(input));
                let [factor1, factor2] = [0, 1].map(|_| [0.0, input.about_number(1.0)][input.few(2)]);
                let (box_size, factor, exec) = (input.about_number(BOX), input.about_number(1.0), exec(input));
                let (before, gaps) = (Before::of(&[&cloud.memory]), cloud.gaps());
                let status = call!([<fixpair_drift_ $r>](
                    &position, &velocity, box_size, factor, factor1, factor2, if input.flag() { &psi1 } else { null() },
                    if input.flag() { &psi2 } else { null() }, pointer(&exec)
                ));
                before.check(status, &[FIXPAIR_ERROR_HOOK, FIXPAIR_ERROR_NOT_FINITE]);
                assert_eq!(gaps, cloud.gaps(), "between the positions");
                if status == 0 && cloud.shown(position.x, position.length) {
                    assert!(cloud.inside(box_size), "a drift leaves positions in the box");
                }
            }

            fn [<forces_ $r>](input: &mut Input) {
                let brick = crate::bricks::brick(input, MODES);
                let x = mesh::<$r>(input, &brick);
                let (y, z) = (Memory::<$r>::floats(input, x.len(), -1.0, 1.0), Memory::<$r>::floats(input, x.len(), -1.0, 1.0));
                let (law, box_size, mass) = (force_law(input), input.about_number(BOX), input.about_number(64.0));
                let mut layout = layout();
                let asked = call!(fixpair_force_scratch(&mut layout, brick.n));
                let scratch = scratch_for(input, asked, layout);
                let exec = exec(input);
                let which = input.few(3);
                // Scratch may be memory that a function does not get as a mesh.
                let before = if which == 0 { Before::of(&[&x, &y, &z]) } else { Before::of(&[&x]) };
                let gaps = Gaps::of(&x, &brick);
                let len = input.length(x.len());
                let [first, second, third] = [&x, &y, &z].map(|mesh| input.pointer(mesh));
                let (work, work_len) = (input.pointer(&scratch).cast(), input.length(scratch.len()));
                let status = match which {
                    0 => call!([<fixpair_forces_ $r>](first, second, third, len, &brick, &law, box_size, mass, work, work_len, pointer(&exec))),
                    1 => call!([<fixpair_force_ $r>](first, second, len, &brick, input.about(3), &law, box_size, mass, work, work_len, pointer(&exec))),
                    _ => call!([<fixpair_potential_ $r>](first, len, &brick, &law, box_size, mass, work, work_len, pointer(&exec))),
                };
                before.check(status, &[FIXPAIR_ERROR_HOOK]);
                gaps.check(&x);
            }
        }
    };
}

in_precision!(f64);
in_precision!(f32);
