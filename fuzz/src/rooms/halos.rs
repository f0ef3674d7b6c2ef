//! Friends of friends on one process and on slabs, halos, their sums, spheres and centres.

use core::ptr::{null, null_mut};

use crate::c::*;
use crate::check::Before;
use crate::clouds::{BOX, Cloud};
use crate::hooks::{exec, layout, pointer, scratch_for};
use crate::input::Input;
use crate::memory::Memory;

pub fn run(data: &[u8]) {
    let input = &mut Input::new(data);
    match input.few(8) {
        0 => labels_f64(input),
        1 => labels_f32(input),
        2 => halos_f64(input),
        3 => halos_f32(input),
        4 => spheres_f64(input),
        5 => spheres_f32(input),
        6 => maps(input),
        _ => sums(input),
    }
}

/// Labels of a few groups, some anything.
fn some_labels(input: &mut Input, count: usize) -> Memory<u64> {
    let groups = 1 + input.few(8) as u64;
    let mut random = input.random();
    let mut of = Memory::new(count, |_| random.below(groups));
    if count > 0 && input.odd(8) {
        of.values_mut()[input.few(count)] = input.word();
    }
    of
}

/// Pairs of labels, or a map in increasing order of its labels.
fn pairs(input: &mut Input, entries: usize, increasing: bool) -> Memory<u64> {
    let mut random = input.random();
    let mut of = Memory::new(2 * entries, |place| match place % 2 {
        0 if increasing => place as u64 / 2,
        _ => random.below(8),
    });
    if entries > 0 && input.odd(8) {
        of.values_mut()[input.few(2 * entries)] = input.word();
    }
    of
}

fn maps(input: &mut Input) {
    let entries = input.few(9);
    if input.flag() {
        let (pairs, map) = (pairs(input, entries, false), Memory::new(4 * entries, |_| 7_u64));
        let mut found = 0;
        let before = Before::of(&[&map]);
        let map_len = input.length(2 * entries);
        let status = call!(fixpair_fof_merge(
            input.pointer(&map),
            map_len,
            &mut found,
            input.pointer(&pairs),
            input.length(entries)
        ));
        before.check(status, &[]);
        assert!(status != 0 || found <= 2 * entries, "a map has no more entries than labels");
    } else {
        let map = pairs(input, entries, true);
        let count = input.few(40);
        let labels = some_labels(input, count);
        let exec = exec(input);
        let before = Before::of(&[&labels]);
        let status = call!(fixpair_fof_relabel(
            input.pointer(&labels),
            input.length(count),
            input.pointer(&map),
            input.length(entries),
            pointer(&exec)
        ));
        before.check(status, &[FIXPAIR_ERROR_HOOK]);
    }
}

/// Sums of parts of halos, which the caller may have received from anywhere.
fn sums(input: &mut Input) {
    let len = input.few(6);
    let mut random = input.random();
    let mut sums = Memory::<fixpair::halos::HaloSums>::zeros(len);
    for sum in sums.values_mut() {
        sum.label = random.below(3);
        sum.members = 1 + random.below(4);
        sum.reference = [0; 3].map(|_| BOX * random.unit());
        sum.position = [0; 3].map(|_| random.unit());
        sum.position_squared = 8.0;
        sum.velocity = [0; 3].map(|_| random.unit());
        sum.velocity_squared = 8.0;
        sum.high = [1.0; 3];
        if input.odd(8) {
            match input.few(5) {
                0 => sum.members = input.word(),
                1 => sum.reference[input.few(3)] = input.number(),
                2 => sum.position[input.few(3)] = input.number(),
                3 => sum.velocity_squared = input.number(),
                _ => sum.low[input.few(3)] = input.number(),
            }
        }
    }
    let (mut groups, box_size) = (0, input.about_number(BOX));
    let before = Before::of(&[&sums]);
    let status =
        call!(fixpair_halo_sums_merge(input.pointer(&sums), input.length(len), &mut groups, box_size));
    before.check(status, &[]);
    assert!(status != 0 || groups <= len, "there are no more groups than sums");
    let halos = Memory::zeros(len);
    let mut count = 0;
    let before = Before::of(&[&halos]);
    let status = call!(fixpair_halos_finish(
        input.pointer(&halos),
        input.length(len),
        &mut count,
        input.pointer(&sums),
        if status == 0 { groups } else { len },
        box_size,
        input.about(4) as u64,
        input.about_number(1e10)
    ));
    before.check(status, &[]);
    assert!(status != 0 || count <= len, "there are no more halos than sums");
}

macro_rules! in_precision {
    ($r:ident) => {
        pastey::paste! {
            fn [<labels_ $r>](input: &mut Input) {
                let count = input.few(64);
                let cloud = Cloud::<$r>::places(input, count, BOX);
                let labels = Memory::new(count, |_| 7_u64);
                let given = input.flag();
                let ids = Memory::new(if given { count } else { 0 }, |place| (count - place) as u64 * 3);
                let mut layout = layout();
                let asked = call!([<fixpair_fof_labels_scratch_ $r>](&mut layout, count));
                let scratch = scratch_for(input, asked, layout);
                let (position, exec) = (cloud.positions(input), exec(input));
                let (box_size, near) = (input.about_number(BOX), [5.0, 0.0, 30.0, 1e-6][input.few(4)]);
                let linking_length = input.about_number(near);
                let before = Before::of(&[&labels]);
                let status = call!([<fixpair_fof_labels_ $r>](
                    input.pointer(&labels), input.length(count), &position, if given { input.pointer(&ids) } else { null_mut() }, ids.len(), box_size, linking_length,
                    input.pointer(&scratch).cast(), input.length(scratch.len()), pointer(&exec)
                ));
                before.check(status, &[FIXPAIR_ERROR_HOOK, FIXPAIR_ERROR_NOT_FINITE]);
            }

            fn [<halos_ $r>](input: &mut Input) {
                let particles = input.few(48);
                let labels = some_labels(input, particles);
                let cloud = Cloud::<$r>::places(input, particles, BOX);
                let moved = Cloud::<$r>::between(input, particles, -100.0, 100.0);
                let (box_size, n_min, mass) = (input.about_number(BOX), input.about(4) as u64, input.about_number(1e10));
                let mut layout = layout();
                let asked = call!(fixpair_halos_scratch(&mut layout, particles));
                let scratch = scratch_for(input, asked, layout);
                let (position, velocity, exec) = (cloud.positions(input), moved.positions(input), exec(input));
                let mut count = 0;
                let at_most = input.few(10);
                let (of, of_len) = (input.pointer(&labels), input.length(particles));
                let (work, work_len) = (input.pointer(&scratch).cast(), input.length(scratch.len()));
                match input.few(3) {
                    0 => {
                        let _ = call!(fixpair_halo_count(&mut count, of, of_len, n_min, work, work_len, pointer(&exec)));
                    }
                    1 => {
                        let halos = Memory::zeros(at_most);
                        let before = Before::of(&[&halos]);
                        let status = call!([<fixpair_halos_ $r>](
                            input.pointer(&halos), input.length(at_most), &mut count, of, of_len, &position,
                            if input.odd(8) { null() } else { &velocity }, box_size, n_min, mass, work, work_len, pointer(&exec)
                        ));
                        before.check(status, &[FIXPAIR_ERROR_HOOK, FIXPAIR_ERROR_NOT_FINITE]);
                        assert!(status != 0 || count <= at_most, "halos fit");
                    }
                    _ => {
                        let entries = input.few(9);
                        let (sums, map) = (Memory::zeros(at_most), pairs(input, entries, true));
                        let before = Before::of(&[&sums]);
                        let status = call!([<fixpair_halo_sums_ $r>](
                            input.pointer(&sums), input.length(at_most), &mut count, of, of_len, &position,
                            if input.odd(8) { null() } else { &velocity }, box_size, n_min, input.pointer(&map), input.length(entries), work, work_len,
                            pointer(&exec)
                        ));
                        before.check(status, &[FIXPAIR_ERROR_HOOK, FIXPAIR_ERROR_NOT_FINITE]);
                        assert!(status != 0 || count <= at_most, "sums fit");
                    }
                }
            }

            fn [<spheres_ $r>](input: &mut Input) {
                let particles = input.few(64);
                let cloud = Cloud::<$r>::places(input, particles, BOX);
                let of = input.few(4);
                let centres = Memory::<f64>::floats(input, 3 * of, 0.0, BOX);
                let mut layout = layout();
                let asked = call!([<fixpair_spheres_scratch_ $r>](&mut layout, particles));
                let scratch = scratch_for(input, asked, layout);
                let (position, exec, box_size) = (cloud.positions(input), exec(input), input.about_number(BOX));
                let (work, work_len) = (input.pointer(&scratch).cast(), input.length(scratch.len()));
                if input.flag() {
                    let densities = input.few(3);
                    let overdensities = Memory::<f64>::floats(input, densities, 1.5, 400.0);
                    let spheres = Memory::zeros(of * overdensities.len());
                    let before = Before::of(&[&spheres]);
                    let status = call!([<fixpair_spheres_ $r>](
                        input.pointer(&spheres), input.length(spheres.len()), input.pointer(&centres), input.length(of), input.pointer(&overdensities),
                        input.length(overdensities.len()), &position, box_size, input.about(64) as u64, input.about_number(1e10), input.about(4) as u64,
                        work, work_len, pointer(&exec)
                    ));
                    before.check(status, &[FIXPAIR_ERROR_HOOK]);
                } else {
                    let radii = Memory::<f64>::floats(input, of, 0.0, 40.0);
                    let before = Before::of(&[&centres]);
                    let status = call!([<fixpair_refine_centres_ $r>](
                        input.pointer(&centres), input.length(of), input.pointer(&radii), &position, box_size, input.about_number(0.9),
                        input.about(4) as u64, work, work_len, pointer(&exec)
                    ));
                    before.check(status, &[FIXPAIR_ERROR_HOOK]);
                }
            }
        }
    };
}

in_precision!(f64);
in_precision!(f32);
