//! The steps of initial conditions one by one: shapes, sources of the second and third order, displacements.

use crate::bricks::{CELLS, MODES, brick, mesh, whole};
use crate::c::*;
use crate::check::Before;
use crate::clouds::{BOX, Cloud};
use crate::hooks::{exec, layout, pointer, scratch_for, some_double, some_single};
use crate::input::Input;
use crate::memory::Memory;
use crate::universe::shape_rows;

pub fn run(data: &[u8]) {
    let input = &mut Input::new(data);
    match input.few(11) {
        0 => local_f64(input),
        1 => local_f32(input),
        2 => shape_f64(input),
        3 => shape_f32(input),
        4 => second_f64(input),
        5 => second_f32(input),
        6 => third_f64(input),
        7 => third_f32(input),
        8 => displace_f64(input),
        9 => displace_f32(input),
        _ => rows(input),
    }
}

/// The kernels of the shapes that have a name.
fn rows(input: &mut Input) {
    let rows = Memory::zeros(input.few(12));
    let mut count = 0;
    let before = Before::of(&[&rows]);
    let status = call!(fixpair_shape_rows(
        input.pointer(&rows),
        input.length(rows.len()),
        &mut count,
        input.choice(5)
    ));
    before.check(status, &[]);
}

/// The brick of a transform's modes, or for the most part of another mesh.
fn modes_of(input: &mut Input, fourier: &fixpair_brick) -> fixpair_brick {
    match input.few(8) {
        0 => brick(input, MODES),
        1 => whole([2, 4, 6, 8][input.few(4)], MODES),
        _ => *fourier,
    }
}

macro_rules! in_precision {
    ($r:ident, $some:ident) => {
        pastey::paste! {
            fn [<local_ $r>](input: &mut Input) {
                let work = $some(input);
                let brick = modes_of(input, &work.fourier);
                let modes = mesh::<$r>(input, &brick);
                let mesh = Memory::<$r>::new(work.length.min(4096), |_| 7.0);
                let (f_nl, g_nl) = (input.about_number(100.0), input.about_number(0.0));
                let mut layout = layout();
                let asked = call!([<fixpair_add_local_scratch_ $r>](&mut layout, &work));
                let scratch = scratch_for(input, asked, layout);
                let exec = exec(input);
                let before = Before::of(&[&modes]);
                let status = call!([<fixpair_add_local_ $r>](
                    input.pointer(&modes), input.length(modes.len()), &brick, f_nl, g_nl, &work, input.pointer(&mesh), input.length(mesh.len()),
                    input.pointer(&scratch).cast(), input.length(scratch.len()), pointer(&exec)
                ));
                before.check(status, &[FIXPAIR_ERROR_HOOK]);
            }

            fn [<shape_ $r>](input: &mut Input) {
                let work = $some(input);
                let brick = modes_of(input, &work.fourier);
                let modes = mesh::<$r>(input, &brick);
                let rows = shape_rows(input);
                let (f_nl, n_s) = (input.about_number(100.0), input.about_number(0.96));
                let mut layout = layout();
                let asked = call!([<fixpair_add_shape_scratch_ $r>](&mut layout, &brick, &work));
                let scratch = scratch_for(input, asked, layout);
                let exec = exec(input);
                let before = Before::of(&[&modes]);
                let status = call!([<fixpair_add_shape_ $r>](
                    input.pointer(&modes), input.length(modes.len()), &brick, f_nl, n_s, input.pointer(&rows), input.length(rows.len()), &work,
                    input.pointer(&scratch).cast(), input.length(scratch.len()), pointer(&exec)
                ));
                before.check(status, &[FIXPAIR_ERROR_HOOK]);
            }

            /// The source of the second order, or one component of a displacement.
            fn [<second_ $r>](input: &mut Input) {
                let work = $some(input);
                let brick = modes_of(input, &work.fourier);
                let density = mesh::<$r>(input, &brick);
                let source = Memory::<$r>::new(if input.flag() { density.len() } else { work.length.min(4096) }, |_| 7.0);
                let meshes = [0; 3].map(|_| Memory::<$r>::new(work.length.min(4096), |_| 7.0));
                let exec = exec(input);
                let before = Before::of(&[&source]);
                let status = if input.flag() {
                    let [mesh1, mesh2, mesh3] = [0, 1, 2].map(|mesh| input.pointer(&meshes[mesh]));
                    call!([<fixpair_second_order_source_ $r>](
                        input.pointer(&source), input.length(source.len()), input.pointer(&density), input.length(density.len()), &brick, &work,
                        mesh1, mesh2, mesh3, input.length(meshes[0].len()), pointer(&exec)
                    ))
                } else {
                    call!([<fixpair_displacement_ $r>](
                        input.pointer(&source), input.length(source.len()), input.pointer(&density), input.length(density.len()), &brick,
                        input.about(3), input.about_number(30.0), &work, pointer(&exec)
                    ))
                };
                before.check(status, &[FIXPAIR_ERROR_HOOK]);
            }

            /// The sources of the third order, or one component of a transverse displacement.
            fn [<third_ $r>](input: &mut Input) {
                let fft = $some(input);
                let len = fft.length.min(4096);
                let density = Memory::<$r>::floats(input, len, -1.0, 1.0);
                let out = [0; 6].map(|_| Memory::<$r>::new(len, |place| place as $r));
                let exec = exec(input);
                if input.flag() {
                    let mut layout = layout();
                    let asked = call!([<fixpair_third_order_sources_scratch_ $r>](&mut layout, &fft));
                    let scratch = scratch_for(input, asked, layout);
                    let [a, b, c, d, e, f] = [0, 1, 2, 3, 4, 5].map(|mesh| input.pointer(&out[mesh]));
                    let before = Before::of(&[&out[0], &out[1], &out[2], &out[3], &out[4], &out[5]]);
                    let status = call!([<fixpair_third_order_sources_ $r>](
                        a, b, c, d, e, f, input.pointer(&density), input.length(len), &fft, input.pointer(&scratch).cast(), input.length(scratch.len()), pointer(&exec)
                    ));
                    before.check(status, &[FIXPAIR_ERROR_HOOK]);
                } else {
                    let before = Before::of(&[&density]);
                    let [x, y, z] = [0, 1, 2].map(|mesh| input.pointer(&out[mesh]));
                    let status = call!([<fixpair_transverse_displacement_ $r>](
                        input.pointer(&density), input.length(len), x, y, z, input.length(len), input.about(3), input.about_number(30.0), &fft, pointer(&exec)
                    ));
                    before.check(status, &[FIXPAIR_ERROR_HOOK]);
                }
            }

            /// Displacements on a brick of cells move the particles of that brick.
            fn [<displace_ $r>](input: &mut Input) {
                let brick = brick(input, CELLS);
                let psi = [0; 2].map(|_| mesh::<$r>(input, &brick));
                let [x, y, z] = brick.count;
                let cells = x.saturating_mul(y).saturating_mul(z);
                let count = if cells > 4096 || input.odd(16) { input.few(64) } else { cells };
                let (places, moved) = (Cloud::<$r>::places(input, count, BOX), Cloud::<$r>::between(input, count, -1.0, 1.0));
                let (position, velocity) = (places.components(input), moved.components(input));
                let (box_size, c1, c2, exec) = (input.about_number(BOX), input.about_number(1.0), input.about_number(1.0), exec(input));
                let before = Before::of(&[&places.memory, &moved.memory]);
                let gaps = [places.gaps(), moved.gaps()];
                let len = psi[0].len().min(psi[1].len());
                let first = input.pointer(&psi[0]);
                let status = call!([<fixpair_displace_ $r>](
                    &position, &velocity, first, input.optional(&psi[1]), input.length(len), &brick, input.about(3), box_size, c1, c2, pointer(&exec)
                ));
                before.check(status, &[FIXPAIR_ERROR_HOOK, FIXPAIR_ERROR_NOT_FINITE]);
                assert_eq!(gaps, [places.gaps(), moved.gaps()], "between the particles");
            }
        }
    };
}

in_precision!(f64, some_double);
in_precision!(f32, some_single);
