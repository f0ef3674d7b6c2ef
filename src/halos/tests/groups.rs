//! Friends of friends against all pairs.

use super::*;
use crate::reference;

fn agrees<T: Real>(places: &[[T; 3]], box_size: f64, length: f64, what: &str) {
    let labels = labels_of(places, None, box_size, length, &Serial).unwrap();
    assert!(labels == reference::fof::labels(places, None, box_size, length), "{what}, l = {length:e}");
}

/// Any number of particles, any linking length, any clustering.
fn random_case<T: Real>(random: &mut Random, most: usize) {
    let particles = random.below(most);
    let box_size = 10.0_f64.powf(6.0 * random.unit() - 3.0);
    let length = box_size * 0.5 * 10.0_f64.powf(-2.5 * random.unit());
    let places: Vec<[T; 3]> = if random.below(2) == 0 {
        clumps::<f64>(random, particles)
            .iter()
            .map(|place| place.map(|x| home(x * box_size, box_size)))
            .collect()
    } else {
        // Many on the corners of cells, and so at equal distances and on edges.
        let steps = 1 + random.below(12);
        let corner =
            |random: &mut Random| home(box_size * random.below(steps) as f64 / steps as f64, box_size);
        (0..particles).map(|_| [0; 3].map(|_| corner(random))).collect()
    };
    let length = if random.below(4) == 0 {
        (box_size / (2 + random.below(12)) as f64).min(0.5 * box_size)
    } else {
        length
    };
    agrees(&places, box_size, length, "random case");
}

#[test]
fn labels_are_those_of_all_pairs_in_thousands_of_random_cases() {
    let mut random = Random(1);
    for _ in 0..3000 {
        random_case::<f64>(&mut random, 60);
        random_case::<f32>(&mut random, 60);
    }
    for _ in 0..100 {
        random_case::<f64>(&mut random, 700);
        random_case::<f32>(&mut random, 700);
    }
}

#[test]
fn labels_are_right_where_few_cells_fit_the_box() {
    let mut random = Random(2);
    // About the ratios L/l at which blocks have as many cells on a side as they need, or one more.
    for whole in 2..=12 {
        for part in [0.0, 1e-12, 1e-7, 1e-6, 2e-6, 1e-3, 0.5] {
            let length = 1.0 / (f64::from(whole) + part);
            for _ in 0..4 {
                let places = clumps::<f64>(&mut random, 60);
                agrees(&places, 1.0, length, "few cells");
                let steps = 4 * whole as usize;
                let corner =
                    |random: &mut Random| home::<f64>(random.below(steps) as f64 / steps as f64, 1.0);
                let places: Vec<_> = (0..60).map(|_| [0; 3].map(|_| corner(&mut random))).collect();
                agrees(&places, 1.0, length, "few cells, on edges");
            }
        }
    }
}

/// A lattice of spacing 1 with n points on a side.
fn lattice<T: Real>(n: usize) -> Vec<[T; 3]> {
    (0..n * n * n).map(|i| [i / (n * n), i / n % n, i % n].map(|x| T::from_f64(x as f64))).collect()
}

#[test]
fn a_lattice_is_one_group_if_its_spacing_is_the_linking_length_and_none_if_it_is_more() {
    let just_below = f64::from_bits(1.0_f64.to_bits() - 1);
    for n in [2, 3, 4, 5, 8, 13] {
        let (places, size) = (lattice::<f32>(n), n as f64);
        let labels = labels_of(&places, None, size, 1.0, &Serial).unwrap();
        assert!(labels.iter().all(|&label| label == 0), "n = {n}");
        let labels = labels_of(&places, None, size, just_below, &Serial).unwrap();
        assert!(labels.into_iter().eq(0..places.len() as u64), "n = {n}");
    }
}

#[test]
fn coincident_particles_are_one_group_and_cost_no_pairs() {
    // All pairs would be 10^11 distances.
    let half = 1 << 18;
    let length = 0.01;
    for apart in [0.0, 0.99 * length, 1.01 * length] {
        let places: Vec<[f32; 3]> = (0..2 * half)
            .map(|i| [0.999, 0.5, home(0.5 + if i < half { 0.0 } else { apart }, 1.0)])
            .collect();
        let labels = labels_of(&places, None, 1.0, length, &Serial).unwrap();
        let second = if apart > length { half as u64 } else { 0 };
        assert!(labels[..half].iter().all(|&label| label == 0));
        assert!(labels[half..].iter().all(|&label| label == second));
    }
}

#[test]
fn a_group_may_wind_around_the_box() {
    let places: Vec<[f64; 3]> = (0..1000).map(|i| [f64::from(i) / 1000.0, 0.9999, 0.0001]).collect();
    let labels = labels_of(&places, None, 1.0, 0.001_000_1, &Serial).unwrap();
    assert!(labels.iter().all(|&label| label == 0));
    agrees(&places, 1.0, 0.000_999_9, "a line with gaps");
}

#[test]
fn labels_are_the_smallest_ids() {
    let mut random = Random(4);
    for _ in 0..200 {
        let places = clumps::<f32>(&mut random, 80);
        let ids: Vec<u64> = (0..80).map(|_| random.next() << 20 | random.next()).collect();
        let labels = labels_of(&places, Some(&ids), 1.0, 0.04, &Serial).unwrap();
        assert_eq!(labels, reference::fof::labels(&places, Some(&ids), 1.0, 0.04));
    }
}

#[test]
fn labels_do_not_depend_on_threads() {
    let places = clumps::<f32>(&mut Random(5), 150_000);
    let labels = labels_of(&places, None, 1.0, 0.004, &Serial).unwrap();
    let groups = labels.iter().enumerate().filter(|&(i, &label)| i as u64 == label).count();
    assert!((1000..100_000).contains(&groups), "{groups} groups");
    for threads in [2, 5] {
        let pool = Threads::new(threads).unwrap();
        for _ in 0..3 {
            assert!(labels_of(&places, None, 1.0, 0.004, &pool).unwrap() == labels);
        }
    }
}

#[test]
fn thousands_of_particles_agree_with_all_pairs() {
    let mut random = Random(6);
    let places = clumps::<f32>(&mut random, 4000);
    for length in [0.3, 0.03, 0.01, 1e-4] {
        agrees(&places, 1.0, length, "thousands");
    }
}

#[test]
fn places_are_taken_modulo_the_box() {
    let mut random = Random(7);
    let places = clumps::<f64>(&mut random, 300);
    // Eighths, so that moving by a box of 8 rounds nothing.
    let places: Vec<_> = places.iter().map(|place| place.map(|x| (x * 512.0).floor() / 64.0)).collect();
    let moved: Vec<_> =
        places.iter().map(|place| place.map(|x| x + 8.0 * (random.below(5) as f64 - 2.0))).collect();
    let labels = labels_of(&places, None, 8.0, 0.25, &Serial).unwrap();
    assert_eq!(labels_of(&moved, None, 8.0, 0.25, &Serial).unwrap(), labels);
    // What rounds up to the far edge is on the near one.
    let labels = labels_of(&[[-1e-30_f32, 0.0, 0.0], [0.0; 3]], None, 1.0, 1e-5, &Serial).unwrap();
    assert_eq!(labels, [0, 0]);
}

#[test]
fn positions_may_lie_in_separate_arrays() {
    let places = clumps::<f64>(&mut Random(8), 500);
    let axis = |axis: usize| places.iter().map(|place| place[axis]).collect::<Vec<_>>();
    let (x, y, z) = (axis(0), axis(1), axis(2));
    let positions = Positions::separate([&x, &y, &z]).unwrap();
    let mut memory = Memory::new(fof_labels_scratch::<f64>(500).unwrap());
    let mut labels = vec![0; 500];
    fof_labels(&mut labels, &positions, None, 1.0, 0.01, memory.get(), &Serial).unwrap();
    assert_eq!(labels, labels_of(&places, None, 1.0, 0.01, &Serial).unwrap());
}

#[test]
fn scratch_is_24_bytes_a_particle_in_single_and_36_in_double_precision() {
    for particles in [0, 1, 1000, 1 << 21, 1 << 27] {
        let [single, double] = [fof_labels_scratch::<f32>(particles), fof_labels_scratch::<f64>(particles)];
        let beyond = |layout: Result<Layout>, each: usize| layout.unwrap().size - each * particles;
        assert!(beyond(single, 24) <= 4_300_000 && beyond(double, 36) <= 4_300_000);
    }
    assert_eq!(fof_labels_scratch::<f32>(1 << 32), Err(Error::Overflow));
}

#[test]
fn the_linking_length_is_a_part_of_the_mean_separation() {
    assert!((linking_length(0.2, 256.0, 1 << 21).unwrap() - 0.4).abs() < 1e-15);
    for (b, size, total) in [(0.0, 1.0, 8), (0.2, -1.0, 8), (0.2, 1.0, 0)] {
        assert_eq!(linking_length(b, size, total), Err(Error::Range));
    }
    assert_eq!(linking_length(f64::NAN, 1.0, 8), Err(Error::NotFinite));
}

#[test]
fn what_is_wrong_is_refused() {
    let places = [[0.5_f32; 3]; 4];
    let refused = |size, length| labels_of(&places, None, size, length, &Serial).unwrap_err();
    assert_eq!(refused(1.0, 0.500_001), Error::Range);
    assert_eq!(refused(1.0, 0.0), Error::Range);
    assert_eq!(refused(1.0, -0.1), Error::Range);
    assert_eq!(refused(1.0, 0.9e-6), Error::Range);
    assert_eq!(refused(0.0, 0.1), Error::Range);
    assert_eq!(refused(1e60, 1e59), Error::Range);
    assert_eq!(refused(f64::INFINITY, 0.1), Error::NotFinite);
    assert_eq!(refused(1.0, f64::NAN), Error::NotFinite);
    for bad in [f32::NAN, f32::INFINITY] {
        let mut places = places;
        places[2][1] = bad;
        assert_eq!(labels_of(&places, None, 1.0, 0.1, &Serial), Err(Error::NotFinite));
    }
    let positions = Positions::triples(places.as_flattened()).unwrap();
    let layout = fof_labels_scratch::<f32>(4).unwrap();
    let mut memory = Memory::new(layout);
    let mut labels = [7; 4];
    let call = |labels: &mut [u64], ids: Option<&[u64]>, scratch: &mut [u8]| {
        fof_labels(labels, &positions, ids, 1.0, 0.1, scratch, &Serial)
    };
    assert_eq!(call(&mut labels[..3], None, memory.get()), Err(Error::Length));
    assert_eq!(call(&mut labels, Some(&[1, 2, 3]), memory.get()), Err(Error::Length));
    assert_eq!(call(&mut labels, None, &mut memory.get()[1..]), Err(Error::Scratch));
    assert_eq!(labels, [7; 4], "refused calls write nothing");
    assert_eq!(call(&mut labels, None, memory.get()), Ok(()));
    assert_eq!(labels_of::<f64>(&[], None, 1.0, 0.1, &Serial), Ok(vec![]));
}
