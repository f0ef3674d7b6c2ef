//! Triangles, their counts, sums over cells and what follows from them.

use core::ptr::{null, null_mut};

use crate::bricks::{CELLS, brick, mesh};
use crate::c::*;
use crate::check::{Before, finite};
use crate::hooks::{exec, layout, pointer, scratch_for, some_double, some_single};
use crate::input::Input;
use crate::memory::Memory;
use crate::rooms::power::some_edges;

const WORDS: usize = FIXPAIR_BISPECTRUM_WORDS;

pub fn run(data: &[u8]) {
    let input = &mut Input::new(data);
    match input.few(7) {
        0 => triangles(input),
        1 => counts(input),
        2 => values(input),
        3 => sums_f64(input),
        4 => sums_f32(input),
        5 => whole_f64(input),
        _ => whole_f32(input),
    }
}

/// Numbers of shells, some that are not there.
fn some_triangles(input: &mut Input, count: usize) -> Memory<u32> {
    Memory::new(3 * count, |_| if input.odd(64) { input.word() as u32 } else { input.few(4) as u32 })
}

fn triangles(input: &mut Input) {
    let edges = some_edges(input, 7);
    let shells = edges.len().saturating_sub(1);
    let mut centres = Memory::new(shells, |place| 1.0 + place as f64);
    centres.spoil(input);
    let (edges_len, edges, centres) = (input.length(edges.len()), &edges, &centres);
    let mut count = 0;
    let with = input.optional(centres);
    let known = call!(fixpair_closed_triangle_count(&mut count, input.pointer(edges), edges_len, with));
    let room = if input.odd(8) || known != 0 { input.few(20) } else { count.min(200) };
    let out = Memory::new(3 * room, |_| 7_u32);
    let before = Before::of(&[&out]);
    let status = if input.flag() {
        call!(fixpair_closed_triangles(
            input.pointer(&out),
            input.length(room),
            input.pointer(edges),
            edges_len,
            with
        ))
    } else {
        call!(fixpair_squeezed_triangles(
            input.pointer(&out),
            input.length(room),
            input.about(4),
            input.about(8)
        ))
    };
    before.check(status, &[]);
}

fn counts(input: &mut Input) {
    let (edges, triangles_len, n) = (some_edges(input, 5), input.few(6), input.side());
    let triangles = some_triangles(input, triangles_len);
    let counts = Memory::new(triangles_len, |_| 7_u64);
    let mut layout = layout();
    let (of, with, edges_len) = (input.pointer(&triangles), input.pointer(&edges), input.length(edges.len()));
    let asked = call!(fixpair_triangle_counts_scratch(&mut layout, of, triangles_len, with, edges_len, n));
    let scratch = scratch_for(input, asked, layout);
    let exec = exec(input);
    let before = Before::of(&[&counts]);
    let status = call!(fixpair_triangle_counts(
        input.pointer(&counts),
        of,
        input.length(triangles_len),
        with,
        edges_len,
        n,
        input.pointer(&scratch).cast(),
        input.length(scratch.len()),
        pointer(&exec)
    ));
    before.check(status, &[FIXPAIR_ERROR_HOOK]);
}

fn values(input: &mut Input) {
    let len = input.few(5);
    let triangles = some_triangles(input, len);
    let mut random = input.random();
    let (small, spread) = (input.flag(), 60 - input.few(40));
    let sums =
        Memory::new(
            WORDS * len,
            |_| if small { random.below(9) as i64 } else { random.word() as i64 >> spread },
        );
    let values = Memory::new(len, |_| 7.0);
    let power = Memory::<f64>::floats(input, 4, 1.0, 1e4);
    let before = Before::of(&[&values]);
    let noise = input.about_number(1.0);
    let to = input.pointer(&values);
    let (declared, of, spectrum) = (input.length(len), input.pointer(&triangles), input.pointer(&power));
    let status = match input.few(4) {
        0 => call!(fixpair_bispectrum_values(to, declared, input.pointer(&sums), input.length(sums.len()))),
        1 => {
            let counts = Memory::new(len, |_| random.below(9));
            let (n, box_size) = (input.side(), input.about_number(100.0));
            call!(fixpair_bispectrum_normalise(to, input.pointer(&counts), declared, n, box_size, noise))
        }
        2 => call!(fixpair_bispectrum_shot_noise(to, of, declared, spectrum, 4, noise)),
        _ => {
            let bispectrum = Memory::<f64>::floats(input, len, -1.0, 1.0);
            call!(fixpair_bispectrum_reduced(to, input.pointer(&bispectrum), of, declared, spectrum, 4))
        }
    };
    before.check(status, &[]);
}

macro_rules! in_precision {
    ($r:ident, $some:ident) => {
        pastey::paste! {
            fn [<sums_ $r>](input: &mut Input) {
                let (brick, triangles_len, shells) = (brick(input, CELLS), input.few(5), 1 + input.few(4));
                let triangles = some_triangles(input, triangles_len);
                let all = [0; 4].map(|_| mesh::<$r>(input, &brick));
                let fields = [0, 1, 2, 3].map(|shell| if input.odd(32) { null() } else { all[shell].pointer().cast_const() });
                let len = all.iter().map(Memory::len).min().unwrap_or(0);
                let sums = Memory::new(WORDS * triangles_len, |_| 0_i64);
                let mut layout = layout();
                let asked = call!([<fixpair_bispectrum_sums_scratch_ $r>](&mut layout, &brick, shells, triangles_len));
                let scratch = scratch_for(input, asked, layout);
                let exec = exec(input);
                let before = Before::of(&[&sums]);
                let status = call!([<fixpair_bispectrum_sums_ $r>](
                    input.pointer(&sums), input.length(sums.len()), input.pointer(&triangles), input.length(triangles_len), fields.as_ptr(), shells,
                    input.length(len), &brick, input.pointer(&scratch).cast(), input.length(scratch.len()), pointer(&exec)
                ));
                before.check(status, &[]);
                let values = Memory::new(triangles_len, |_| 0.0);
                let read = call!(fixpair_bispectrum_values(values.pointer(), triangles_len, sums.pointer(), sums.len()));
                finite(read, values.values());
            }

            /// From modes to sums, with memory for all shells or for a few.
            fn [<whole_ $r>](input: &mut Input) {
                let (fft, edges, triangles_len) = ($some(input), some_edges(input, 5), input.few(5));
                let triangles = some_triangles(input, triangles_len);
                let shells = edges.len().saturating_sub(1);
                let modes = Memory::<$r>::floats(input, fft.length.min(4096), -1.0, 1.0);
                let sums = Memory::new(WORDS * triangles_len, |_| 0_i64);
                let mut reals = 0;
                let _ = call!([<fixpair_bispectrum_meshes_ $r>](&mut reals, &fft, 3 + input.few(3)));
                let fields = Memory::<$r>::new(reals.min(1 << 14), |_| 7.0);
                let mut layout = layout();
                let asked = call!([<fixpair_bispectrum_scratch_ $r>](&mut layout, &fft, shells, triangles_len));
                let scratch = scratch_for(input, asked, layout);
                let exec = exec(input);
                let mut transforms = 0;
                let before = Before::of(&[&sums]);
                let status = call!([<fixpair_bispectrum_ $r>](
                    input.pointer(&sums), input.length(sums.len()), if input.flag() { &mut transforms } else { null_mut() }, input.pointer(&triangles),
                    input.length(triangles_len), input.pointer(&edges), input.length(edges.len()), input.pointer(&modes), input.length(modes.len()),
                    &fft, input.pointer(&fields), input.length(fields.len()), input.pointer(&scratch).cast(), input.length(scratch.len()), pointer(&exec)
                ));
                before.check(status, &[]);
            }
        }
    };
}

in_precision!(f64, some_double);
in_precision!(f32, some_single);
