//! Friends of friends and spheres against all pairs and all distances: labels and members are the same, not nearly so.

use core::ptr::{null, null_mut};

use crate::c::*;
use crate::hooks::{layout, scratch_for};
use crate::input::Input;
use crate::memory::{Float, Memory};
use crate::reference::fof;

pub fn run(data: &[u8]) {
    let input = &mut Input::new(data);
    if input.flag() { in_f32(input) } else { in_f64(input) }
}

/// Places in [0, L): anywhere, near the edges, in a clump, or on a lattice of many equal distances.
fn places(input: &mut Input, count: usize, box_size: f64) -> Vec<[f64; 3]> {
    let (kind, mut random) = (input.few(4), input.random());
    let mut place = || {
        let u = match kind {
            0 => random.unit(),
            1 => (random.unit() / 16.0 + 31.0 / 32.0) % 1.0,
            2 => 0.5 + random.unit() / 16.0,
            _ => random.below(8) as f64 / 8.0,
        };
        f64::from((u * box_size) as f32)
    };
    let all = (0..count).map(|_| [place(), place(), place()]);
    all.map(|at| at.map(|x| if x < box_size { x } else { 0.0 })).collect()
}

macro_rules! in_precision {
    ($r:ident) => {
        pastey::paste! {
            fn [<in_ $r>](input: &mut Input) {
                let (count, box_size) = (input.few(48), [64.0, 1.0, 1000.0][input.few(3)]);
                let all = places(input, count, box_size);
                let narrow: Vec<[$r; 3]> = all.iter().map(|place| place.map($r::of)).collect();
                let flat = Memory::<$r>::new(3 * count, |at| narrow[at / 3][at % 3]);
                let position = [<fixpair_positions_ $r>] {
                    x: flat.pointer(), y: flat.pointer().wrapping_add(1), z: flat.pointer().wrapping_add(2), stride: 3, length: count,
                };
                let mut layout = layout();
                if input.flag() {
                    let length = [1.0 / 8.0, 1.0 / 64.0, 0.25, 0.5, 0.1, 1e-6][input.few(6)] * box_size;
                    let given = input.flag();
                    let ids = Memory::new(if given { count } else { 0 }, |place| 1000 - 7 * place as u64);
                    let labels = Memory::new(count, |_| 7_u64);
                    must!([<fixpair_fof_labels_scratch_ $r>](&mut layout, count));
                    let scratch = scratch_for(&mut Input::new(&[]), 0, layout);
                    must!([<fixpair_fof_labels_ $r>](
                        labels.pointer(), count, &position, if given { ids.pointer() } else { null_mut() }, ids.len(), box_size, length, scratch.pointer().cast(), scratch.len(), null()
                    ));
                    let expected = fof::labels(&narrow, given.then(|| ids.values()), box_size, length);
                    assert_eq!(labels.values(), expected, "length {length}, {narrow:?}");
                } else {
                    let centre = [0; 3].map(|_| f64::from(input.between(0.0, 1.0) as f32) * box_size);
                    let (density, n_min) = ([200.0, 2.0, 20.0][input.few(3)], 1 + input.few(4) as u64);
                    let total = 1 + count as u64 + input.few(64) as u64;
                    let sphere = Memory::<fixpair::halos::Sphere>::zeros(1);
                    must!([<fixpair_spheres_scratch_ $r>](&mut layout, count));
                    let scratch = scratch_for(&mut Input::new(&[]), 0, layout);
                    let status = call!([<fixpair_spheres_ $r>](
                        sphere.pointer(), 1, centre.as_ptr(), 1, &density, 1, &position, box_size, total, 1.0, n_min, scratch.pointer().cast(),
                        scratch.len(), null()
                    ));
                    assert_eq!(status, 0);
                    let found = sphere.values()[0];
                    let radius = |members: u64| {
                        box_size * (3.0 * members as f64 / (4.0 * core::f64::consts::PI * density * total as f64)).cbrt()
                    };
                    // The radius of a sphere that a particle lies on may go either way by rounding: those are skipped.
                    let near = |r: f64| {
                        let on = |place: &[f64; 3]| (fof::distance_squared(*place, centre, box_size).sqrt() / r - 1.0).abs() < 1e-9;
                        all.iter().any(on)
                    };
                    if !(n_min..=count as u64 + 1).any(|members| near(radius(members))) {
                        let expected = fof::members(&narrow, centre, box_size, n_min, radius).unwrap_or(0);
                        assert_eq!(found.members, expected, "{found:?}, centre {centre:?}, density {density}, {narrow:?}");
                    }
                }
            }
        }
    };
}

in_precision!(f64);
in_precision!(f32);
