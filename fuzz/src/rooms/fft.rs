//! The transform, its tables and its self-test.

use core::ptr::null_mut;

use crate::bricks::whole;
use crate::c::*;
use crate::check::Before;
use crate::hooks::{self, exec, layout, pointer, scratch_for};
use crate::input::Input;
use crate::memory::Memory;
use crate::rooms::meshes::realisation;

pub fn run(data: &[u8]) {
    let input = &mut Input::new(data);
    match input.few(4) {
        0 => made_f64(input),
        1 => made_f32(input),
        2 => used_f64(input),
        _ => used_f32(input),
    }
}

macro_rules! in_precision {
    ($r:ident, $some:ident) => {
        pastey::paste! {
            /// Tables and a transform of any side, and one round trip through it.
            fn [<made_ $r>](input: &mut Input) {
                let n = input.side();
                let (mut tables_layout, mut scratch_layout) = (layout(), layout());
                assert!(ask!(fixpair_fft_next_side(n)).is_multiple_of(2));
                let padding = ask!([<fixpair_fft_padding_ $r>](n));
                let asked = call!([<fixpair_fft_tables_scratch_ $r>](&mut tables_layout, n));
                let tables = scratch_for(input, asked, tables_layout);
                let asked = call!([<fixpair_fft_scratch_ $r>](&mut scratch_layout, n));
                let scratch = scratch_for(input, asked, scratch_layout);
                let before = Before::of(&[&tables]);
                let n = if input.odd(16) { input.side() } else { n };
                let status = call!([<fixpair_fft_tables_init_ $r>](input.pointer(&tables).cast(), input.length(tables.len()), n));
                before.check(status, &[]);
                let brick = whole(2, 0);
                let mut fft = [<fixpair_fft_ $r>] {
                    struct_size: 0, context: null_mut(), forward: None, inverse: None, sum: None,
                    configuration: brick, fourier: brick, length: 0,
                };
                let padding = if input.odd(4) { input.about(8) } else { padding };
                let exec = exec(input);
                let status = call!([<fixpair_fft_init_ $r>](
                    &mut fft, input.pointer(&tables).cast(), input.length(tables.len()), padding, input.pointer(&scratch).cast(),
                    input.length(scratch.len()), pointer(&exec)
                ));
                if status == 0 && fft.length <= 8192 {
                    let data = Memory::new(fft.length, |_| 0.0);
                    let status = call!([<fixpair_fft_self_test_ $r>](&fft, data.pointer(), data.len()));
                    assert!(status == 0 || exec.is_some(), "the built-in transform fails its own test: {status}");
                }
            }

            fn [<used_ $r>](input: &mut Input) {
                let fft = hooks::$some(input);
                let data = Memory::<$r>::floats(input, fft.length, -1.0, 1.0);
                let exec = exec(input);
                if input.odd(4) {
                    let _ = call!([<fixpair_fft_self_test_ $r>](&fft, input.pointer(&data), input.length(data.len())));
                } else {
                    let before = Before::of(&[&data]);
                    let realisation = realisation(input, 8);
                    let status = call!([<fixpair_modes_from_field_ $r>](
                        input.pointer(&data), input.length(data.len()), &fft, &realisation, pointer(&exec)
                    ));
                    before.check(status, &[FIXPAIR_ERROR_HOOK, FIXPAIR_ERROR_NOT_FINITE]);
                }
            }
        }
    };
}

in_precision!(f64, some_double);
in_precision!(f32, some_single);
