//! Initial conditions as one call, on their own lattice and at positions of the caller's.

use core::ptr::null;

use crate::c::*;
use crate::check::Before;
use crate::clouds::{BOX, Cloud};
use crate::hooks::{double, exec, layout, pointer, scratch_for, single, some_double, some_single};
use crate::input::Input;
use crate::universe::{Rows, conditions, shape_rows, species};

pub fn run(data: &[u8]) {
    let input = &mut Input::new(data);
    match input.few(4) {
        0 => lattice_f64(input),
        1 => lattice_f32(input),
        2 => at_f64(input),
        _ => at_f32(input),
    }
}

macro_rules! in_precision {
    ($r:ident, $some:ident, $of:ident) => {
        pastey::paste! {
            fn [<lattice_ $r>](input: &mut Input) {
                let (table, rows) = (Rows::new(input, 5), shape_rows(input));
                let species = species(input, &table);
                let conditions = conditions(input, &table, &rows, &species);
                let fft = $some(input);
                let fine = if input.odd(8) { Some($of(12)) } else { None };
                let n = fft.configuration.n;
                let count = if input.odd(16) || n > 14 { input.few(100) } else { n * n * n };
                let (places, moved) = (Cloud::<$r>::places(input, count, BOX), Cloud::<$r>::between(input, count, -1.0, 1.0));
                let mut layout = layout();
                let asked = call!([<fixpair_initial_conditions_scratch_ $r>](&mut layout, &conditions, &fft, pointer(&fine)));
                let scratch = scratch_for(input, asked, layout);
                let (position, velocity, exec) = (places.components(input), moved.components(input), exec(input));
                let before = Before::of(&[&places.memory, &moved.memory]);
                let gaps = [places.gaps(), moved.gaps()];
                let status = call!([<fixpair_initial_conditions_ $r>](
                    &position, &velocity, &conditions, &fft, pointer(&fine), input.pointer(&scratch).cast(), input.length(scratch.len()), pointer(&exec)
                ));
                before.check(status, &[FIXPAIR_ERROR_HOOK, FIXPAIR_ERROR_NOT_FINITE]);
                assert_eq!(gaps, [places.gaps(), moved.gaps()], "between the particles");
                if status == 0 && places.shown(position.x, position.length) && moved.shown(velocity.x, velocity.length) {
                    assert!(places.inside(conditions.box_size) && moved.finite(), "initial conditions are in the box");
                }
            }

            fn [<at_ $r>](input: &mut Input) {
                let (table, rows) = (Rows::new(input, 5), shape_rows(input));
                let species = species(input, &table);
                let conditions = conditions(input, &table, &rows, &species);
                let fft = $some(input);
                let fine = if input.odd(8) { Some($of(12)) } else { None };
                let count = input.few(40);
                let [before_all, places] = [0, 1].map(|_| Cloud::<$r>::places(input, count, BOX));
                let moved = Cloud::<$r>::between(input, count, -1.0, 1.0);
                let mut layout = layout();
                let asked = call!([<fixpair_initial_conditions_at_scratch_ $r>](&mut layout, &conditions, count, &fft, pointer(&fine)));
                let scratch = scratch_for(input, asked, layout);
                let (position, velocity, exec) = (places.components(input), moved.components(input), exec(input));
                let pre_initial = before_all.positions(input);
                let before = Before::of(&[&places.memory, &moved.memory]);
                let status = call!([<fixpair_initial_conditions_at_ $r>](
                    &position, &velocity, if input.odd(64) { null() } else { &pre_initial }, &conditions, &fft, pointer(&fine),
                    input.pointer(&scratch).cast(), input.length(scratch.len()), pointer(&exec)
                ));
                before.check(status, &[FIXPAIR_ERROR_HOOK, FIXPAIR_ERROR_NOT_FINITE]);
                if status == 0 && places.shown(position.x, position.length) && moved.shown(velocity.x, velocity.length) {
                    assert!(places.inside(conditions.box_size) && moved.finite(), "initial conditions are in the box");
                }
            }
        }
    };
}

in_precision!(f64, some_double, double);
in_precision!(f32, some_single, single);
