//! Deposit, read-out and kick, on whole meshes and windows, against sums over all mesh points.

use core::ptr::null;

use crate::bricks::{CELLS, reals, whole};
use crate::c::*;
use crate::clouds::Cloud;
use crate::hooks::{layout, scratch_for};
use crate::input::Input;
use crate::memory::{Float, Memory};
use crate::pm::{Kick, Window};
use crate::reference::{deposit::windows, kick::kick};
use crate::same::close;

pub fn run(data: &[u8]) {
    let input = &mut Input::new(data);
    if input.flag() { in_f32(input) } else { in_f64(input) }
}

const WINDOWS: [Window; 4] = [
    Window::NearestGridPoint,
    Window::CloudInCell,
    Window::TriangularShapedCloud,
    Window::PiecewiseCubicSpline,
];

/// Multiples of 1/64, edges and middles of cells among them, from two boxes below to two above: exact in both precisions, so that no particle
/// is on the other side of an edge by rounding.
fn places(input: &mut Input, count: usize, n: usize) -> Vec<[f64; 3]> {
    let coarse = [1, 32, 64][input.few(3)];
    let mut random = input.random();
    let mut place = || (random.below(4 * 64 * n as u64) / coarse * coarse) as f64 / 64.0 - 2.0 * n as f64;
    (0..count).map(|_| [place(), place(), place()]).collect()
}

macro_rules! in_precision {
    ($r:ident) => {
        pastey::paste! {
            fn [<in_ $r>](input: &mut Input) {
                let n = [4, 6, 4, 4, 8, 4, 6, 10][input.few(8)];
                let (which, shift, count) = (input.few(4), [0.0, 0.5, 0.25][input.few(3)], input.few(10));
                let (window, code) = (WINDOWS[which], which as i32 + 1);
                let all = places(input, count, n);
                let stride = 3 + input.few(2);
                let flat = Memory::<$r>::new(stride * count, |at| $r::of(if at % stride < 3 { all[at / stride][at % stride] } else { 7.0 }));
                let position = [<fixpair_positions_ $r>] {
                    x: flat.pointer(), y: flat.pointer().wrapping_add(1), z: flat.pointer().wrapping_add(2), stride, length: count,
                };
                let mut random = input.random();
                let weights = Memory::<$r>::new(count, |_| $r::of(random.unit()));
                let mut brick = whole(n, CELLS);
                brick.stride[1] += input.few(2);
                brick.stride[0] = brick.stride[1] * n + input.few(3);
                let mut mesh = Memory::<$r>::new(reals(&brick), |_| $r::of(random.unit() - 0.5));
                let at = |c: usize| c / (n * n) * brick.stride[0] + c / n % n * brick.stride[1] + c % n * brick.stride[2];
                let before: Vec<f64> = (0..n * n * n).map(|c| mesh.values()[at(c)].to()).collect();
                let own: Vec<Vec<f64>> = all.iter().map(|&place| windows(window, n, shift, place)).collect();
                // A weight is a product of three splines of a few operations each; a cell adds them.
                let tolerance = 32.0 * f64::from($r::EPSILON) * (1 + count) as f64;
                let mut layout = layout();
                match input.few(3) {
                    0 => {
                        must!([<fixpair_deposit_scratch_ $r>](&mut layout, &brick, count, code));
                        let scratch = scratch_for(&mut Input::new(&[]), 0, layout);
                        let with = if input.flag() { weights.pointer().cast_const() } else { null() };
                        must!([<fixpair_deposit_ $r>](
                            mesh.pointer(), mesh.len(), &brick, &position, with, 1, n as f64, code, shift, scratch.pointer().cast(), scratch.len(), null()
                        ));
                        for c in 0..n * n * n {
                            let weight = |i: usize| if with.is_null() { 1.0 } else { weights.values()[i].to() };
                            let added: f64 = (0..count).map(|i| weight(i) * own[i][c]).sum();
                            close(mesh.values()[at(c)].to(), before[c] + added, tolerance, "deposit");
                        }
                    }
                    1 => {
                        must!([<fixpair_read_out_scratch_ $r>](&mut layout, &brick, count, code));
                        let scratch = scratch_for(&mut Input::new(&[]), 0, layout);
                        let values = Memory::<$r>::new(count, |_| 7.0);
                        must!([<fixpair_read_out_ $r>](
                            values.pointer(), 1, mesh.pointer(), mesh.len(), &brick, &position, n as f64, code, shift, scratch.pointer().cast(),
                            scratch.len(), null()
                        ));
                        for (value, own) in values.values().iter().zip(&own) {
                            let expected: f64 = own.iter().zip(&before).map(|(w, f)| w * f).sum();
                            close(value.to(), expected, tolerance, "read-out");
                        }
                    }
                    _ => {
                        must!([<fixpair_kick_scratch_ $r>](&mut layout, &brick, count, code));
                        let scratch = scratch_for(&mut Input::new(&[]), 0, layout);
                        let [moved, first, second] = [0; 3].map(|_| Cloud::<$r>::between(&mut Input::new(&[]), count, -1.0, 1.0));
                        let of = |cloud: &Cloud<$r>| -> Vec<[f64; 3]> { (0..count).map(|i| cloud.at(i).map(Float::to)).collect() };
                        let [keep, force, lpt1, lpt2] = [0; 4].map(|_| f64::from(input.between(-1.0, 1.0) as f32));
                        let asked = Kick { keep, force, first: lpt1, second: lpt2 };
                        let expected = kick(
                            &of(&moved), &all, [&before, &before, &before], (n, window, shift), &asked, [&of(&first), &of(&second)]
                        );
                        let sound = &mut Input::new(&[]);
                        let velocity = moved.components(sound);
                        let (psi1, psi2) = (first.positions(sound), second.positions(sound));
                        let force_mesh = mesh.pointer();
                        must!([<fixpair_kick_ $r>](
                            &velocity, &position, force_mesh, force_mesh, force_mesh, mesh.len(), &brick, n as f64, code, shift, keep, force, lpt1, lpt2,
                            &psi1, &psi2, scratch.pointer().cast(), scratch.len(), null()
                        ));
                        for (found, expected) in of(&moved).iter().zip(&expected) {
                            for axis in 0..3 {
                                close(found[axis], expected[axis], tolerance, "kick");
                            }
                        }
                    }
                }
                let _ = mesh.values_mut();
            }
        }
    };
}

in_precision!(f64);
in_precision!(f32);
