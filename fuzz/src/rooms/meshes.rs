//! Bricks, loops, random numbers, and kernels on one mesh.

use core::ptr::null_mut;

use crate::bricks::{CELLS, Gaps, MODES, brick, mesh, region};
use crate::c::*;
use crate::check::Before;
use crate::hooks::{exec, layout, pointer, scratch_for};
use crate::input::Input;
use crate::memory::Memory;

pub fn run(data: &[u8]) {
    let input = &mut Input::new(data);
    match input.few(12) {
        0 => loops(input),
        1 => generators(input),
        2 => numbers(input),
        kind if kind % 2 == 0 => in_f64(input, kind / 2),
        kind => in_f32(input, kind / 2),
    }
}

/// A realisation of any scheme; `n` bounds what the schemes with a table of seeds draw.
pub fn realisation(input: &mut Input, n: usize) -> fixpair_realisation {
    let mut of = fixpair_realisation {
        struct_size: 0,
        seed: 0,
        scheme: 0,
        amplitude: 0,
        phase: 0,
        nyquist: 0,
        selection: 0,
        sample: 0,
    };
    must!(fixpair_realisation_init(&mut of, input.word()));
    if input.odd(4) {
        of.struct_size = if input.odd(16) { input.size() } else { of.struct_size };
        of.amplitude = input.choice(3);
        of.phase = input.choice(2);
        of.nyquist = input.choice(2);
        of.selection = input.choice(2);
        of.sample = input.about(10) as u32;
    }
    if n <= 64 {
        of.scheme = input.choice(3);
    }
    of
}

fn loops(input: &mut Input) {
    let exec = exec(input);
    let status = call!(fixpair_exec_self_test(pointer(&exec)));
    assert!(exec.is_some() || status == 0);
    if input.odd(64) {
        let (mut threads, mut made) = (null_mut(), fixpair_exec { context: null_mut(), parallel_for: None });
        if call!(fixpair_threads_create(&mut threads, &mut made, 1 + input.few(3))) == 0 {
            assert_eq!(call!(fixpair_exec_self_test(&made)), 0);
            // SAFETY: made above, and not used afterwards.
            unsafe { ask!(fixpair_threads_destroy(threads)) };
        }
    }
    let message = ask!(fixpair_status_message(-(input.byte() as i32)));
    assert!(!message.is_null() && !ask!(fixpair_version()).is_null());
}

fn generators(input: &mut Input) {
    let [output, counter, key] = [4, 4, 2].map(|len| Memory::new(len, |_| input.word() as u32));
    let _ =
        call!(fixpair_philox4x32_10(input.pointer(&output), input.pointer(&counter), input.pointer(&key)));
    let uniforms = Memory::new(input.few(64), |_| 2.0);
    let before = Before::of(&[&uniforms]);
    let status = call!(fixpair_ranlxd1(input.pointer(&uniforms), input.length(uniforms.len()), input.word()));
    before.check(status, &[]);
    let brick = brick(input, MODES);
    if brick.n <= 64 {
        let len = if input.odd(8) {
            input.few(64)
        } else {
            brick.count[0].saturating_mul(brick.count[1]).min(4096)
        };
        let seeds = Memory::new(len, |_| 0_u32);
        let before = Before::of(&[&seeds]);
        let status =
            call!(fixpair_ngenic_seeds(input.pointer(&seeds), input.length(len), &brick, input.word()));
        before.check(status, &[]);
    }
}

fn numbers(input: &mut Input) {
    let brick = brick(input, CELLS);
    let [x, y, z] = brick.count;
    let cells = x.saturating_mul(y).saturating_mul(z);
    let ids = Memory::new(if cells <= 4096 { cells } else { 16 }, |_| 7_u64);
    let before = Before::of(&[&ids]);
    let exec = exec(input);
    let status = call!(fixpair_particle_ids(
        input.pointer(&ids),
        input.length(ids.len()),
        &brick,
        input.word(),
        pointer(&exec)
    ));
    before.check(status, &[FIXPAIR_ERROR_HOOK]);
    let mut length = 0;
    let n = input.side();
    if call!(fixpair_mode_table_length(&mut length, n)) == 0 {
        assert!(length > n / 2, "modes along an axis have entries of their own");
    }
}

macro_rules! in_precision {
    ($r:ident) => {
        pastey::paste! {
            fn [<in_ $r>](input: &mut Input, kind: usize) {
                match kind {
                    2 => [<noise_ $r>](input),
                    3 => [<scale_ $r>](input),
                    4 => [<copies_ $r>](input),
                    _ => [<cells_ $r>](input),
                }
            }

            /// Noise into a brick of modes, or imposed upon what is in it.
            fn [<noise_ $r>](input: &mut Input) {
                let brick = brick(input, MODES);
                let modes = mesh::<$r>(input, &brick);
                let realisation = realisation(input, brick.n);
                let exec = exec(input);
                let (before, gaps) = (Before::of(&[&modes]), Gaps::of(&modes, &brick));
                let status = if input.odd(4) {
                    call!([<fixpair_impose_ $r>](
                        input.pointer(&modes), input.length(modes.len()), &brick, &realisation, pointer(&exec)
                    ))
                } else {
                    let mut entries = 0;
                    let _ = call!(fixpair_mode_table_length(&mut entries, brick.n));
                    let table = Memory::floats(input, entries.min(512), 0.0, 2.0);
                    let with = if input.flag() { input.length(table.len()) } else { 0 };
                    call!([<fixpair_white_modes_ $r>](
                        input.pointer(&modes), input.length(modes.len()), &brick, &realisation, input.pointer(&table), with, pointer(&exec)
                    ))
                };
                before.check(status, &[FIXPAIR_ERROR_HOOK]);
                gaps.check(&modes);
            }

            fn [<scale_ $r>](input: &mut Input) {
                let brick = brick(input, MODES);
                let modes = mesh::<$r>(input, &brick);
                let exec = exec(input);
                let (before, gaps) = (Before::of(&[&modes]), Gaps::of(&modes, &brick));
                let status = if input.flag() {
                    let mut entries = 0;
                    let _ = call!(fixpair_mode_table_length(&mut entries, brick.n));
                    let table = Memory::floats(input, entries.min(512), -1.0, 1.0);
                    call!([<fixpair_scale_modes_ $r>](
                        input.pointer(&modes), input.length(modes.len()), &brick, input.pointer(&table), input.length(table.len()), pointer(&exec)
                    ))
                } else {
                    let mut layout = layout();
                    let asked = call!(fixpair_compensate_scratch(&mut layout, &brick));
                    let scratch = scratch_for(input, asked, layout);
                    call!([<fixpair_compensate_ $r>](
                        input.pointer(&modes), input.length(modes.len()), compensation(input), input.about_number(1.0), &brick,
                        input.pointer(&scratch).cast(), input.length(scratch.len()), pointer(&exec)
                    ))
                };
                before.check(status, &[FIXPAIR_ERROR_HOOK]);
                gaps.check(&modes);
            }

            /// From one brick of modes to another of any mesh.
            fn [<copies_ $r>](input: &mut Input) {
                let (to_brick, from_brick) = (brick(input, MODES), brick(input, MODES));
                let (to, from) = (mesh::<$r>(input, &to_brick), mesh::<$r>(input, &from_brick));
                let exec = exec(input);
                let (before, gaps) = (Before::of(&[&to]), Gaps::of(&to, &to_brick));
                let status = match input.few(3) {
                    0 => call!([<fixpair_copy_modes_ $r>](
                        input.pointer(&to), input.length(to.len()), &to_brick, input.pointer(&from), input.length(from.len()), &from_brick, pointer(&exec)
                    )),
                    1 => call!([<fixpair_interlace_ $r>](
                        input.pointer(&to), input.pointer(&from), to.len().min(from.len()), &to_brick, pointer(&exec)
                    )),
                    _ => call!([<fixpair_shell_modes_ $r>](
                        input.pointer(&to), input.pointer(&from), to.len().min(from.len()), &to_brick, input.about(8) as u64, input.about(64) as u64,
                        pointer(&exec)
                    )),
                };
                before.check(status, &[FIXPAIR_ERROR_HOOK]);
                gaps.check(&to);
            }

            /// From one region of cells to another.
            fn [<cells_ $r>](input: &mut Input) {
                let to_region = region(input);
                let mut from_region = region(input);
                if !input.odd(8) {
                    from_region.n = to_region.n;
                }
                let (to, from) = (mesh::<$r>(input, &to_region), mesh::<$r>(input, &from_region));
                let exec = exec(input);
                let before = Before::of(&[&to]);
                let (to_pointer, to_len) = (input.pointer(&to), input.length(to.len()));
                let (from_pointer, from_len) = (input.pointer(&from), input.length(from.len()));
                let status = if input.flag() {
                    call!([<fixpair_add_cells_ $r>](to_pointer, to_len, &to_region, from_pointer, from_len, &from_region, pointer(&exec)))
                } else {
                    call!([<fixpair_copy_cells_ $r>](to_pointer, to_len, &to_region, from_pointer, from_len, &from_region, pointer(&exec)))
                };
                before.check(status, &[FIXPAIR_ERROR_HOOK]);
            }
        }
    };
}

in_precision!(f64);
in_precision!(f32);

/// No compensation, or one for each window.
pub fn compensation(input: &mut Input) -> i32 {
    let window = 1 + input.choice(4).clamp(-1 << 20, 1 << 20);
    [0, FIXPAIR_COMPENSATION_WINDOW + window, FIXPAIR_COMPENSATION_ALIASED + window][input.few(3)]
}
