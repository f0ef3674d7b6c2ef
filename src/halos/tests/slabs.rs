//! Groups over the borders of slabs against those of the whole.

use super::*;

/// What one process has after labelling: its own particles by number, and labels of these and of its ghosts.
struct Slab {
    own: Vec<usize>,
    ghosts: Vec<usize>,
    labels: Vec<u64>,
}

/// Cuts the box along x, with ghosts from above or from both sides.
fn cut(places: &[[f64; 3]], slabs: usize, length: f64, both: bool) -> Vec<Slab> {
    let owner = |place: &[f64; 3]| ((place[0] * slabs as f64) as usize).min(slabs - 1);
    let slab = |rank: usize| {
        let (low, high) = (rank as f64 / slabs as f64, (rank + 1) as f64 / slabs as f64);
        // A little more than the linking length does no harm.
        let deep = length * (1.0 + 1e-9);
        let near = |x: f64| (x - high).rem_euclid(1.0) <= deep || (both && (low - x).rem_euclid(1.0) <= deep);
        let (own, others): (Vec<_>, Vec<_>) = (0..places.len()).partition(|&i| owner(&places[i]) == rank);
        let ghosts: Vec<_> = others.into_iter().filter(|&i| near(places[i][0])).collect();
        let all: Vec<_> = own.iter().chain(&ghosts).copied().collect();
        let here: Vec<_> = all.iter().map(|&i| places[i]).collect();
        let ids: Vec<_> = all.iter().map(|&i| id(i)).collect();
        let labels = labels_of(&here, Some(&ids), 1.0, length, &Serial).unwrap();
        Slab { own, ghosts, labels }
    };
    (0..slabs).map(slab).collect()
}

/// Ids in no order.
fn id(i: usize) -> u64 {
    (i as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15)
}

/// The map from all pairs of labels that ghosts and their originals have.
fn merged(slabs: &[Slab], particles: usize) -> Vec<[u64; 2]> {
    let mut of_owner = vec![0; particles];
    for slab in slabs {
        for (&i, &label) in slab.own.iter().zip(&slab.labels) {
            of_owner[i] = label;
        }
    }
    let pairs: Vec<[u64; 2]> = slabs
        .iter()
        .flat_map(|slab| slab.ghosts.iter().zip(&slab.labels[slab.own.len()..]))
        .map(|(&ghost, &label)| [label, of_owner[ghost]])
        .collect();
    let mut map = vec![[0; 2]; 2 * pairs.len()];
    let entries = fof_merge(&mut map, &pairs).unwrap();
    map.truncate(entries);
    map
}

/// Clumps, and a thread through all slabs and the edge of the box.
fn particles(random: &mut Random) -> Vec<[f64; 3]> {
    let mut places = clumps::<f64>(random, 2000);
    let wave = |x: f64| 0.01 * (std::f64::consts::TAU * x).sin();
    places.extend((0..200).map(|_| random.unit()).map(|x| [x, home(wave(x), 1.0), 0.5]));
    places
}

#[test]
fn slabs_of_a_whole_give_the_labels_of_the_whole() {
    let mut random = Random(11);
    for case in 0..12 {
        let places = particles(&mut random);
        let length = [0.005, 0.02, 0.05][case % 3];
        let ids: Vec<_> = (0..places.len()).map(id).collect();
        let whole = labels_of(&places, Some(&ids), 1.0, length, &Serial).unwrap();
        for slabs in [1, 2, 3, 5, 8] {
            for both in [false, true] {
                let cut = cut(&places, slabs, length, both);
                let map = merged(&cut, places.len());
                for slab in cut {
                    let mut labels = slab.labels[..slab.own.len()].to_vec();
                    fof_relabel(&mut labels, &map, &Serial).unwrap();
                    assert!(
                        slab.own.iter().zip(labels).all(|(&i, label)| whole[i] == label),
                        "{slabs} slabs"
                    );
                }
            }
        }
    }
}

#[test]
fn some_groups_of_these_tests_span_three_slabs_and_the_edge() {
    let places = particles(&mut Random(11));
    let whole = labels_of(&places, None, 1.0, 0.05, &Serial).unwrap();
    let mut slabs = vec![[false; 8]; places.len()];
    for (place, &label) in places.iter().zip(&whole) {
        slabs[label as usize][(place[0] * 8.0) as usize] = true;
    }
    assert!(
        slabs.iter().any(|slabs| slabs.iter().filter(|&&slab| slab).count() >= 3 && slabs[0] && slabs[7])
    );
}

#[test]
fn sums_of_slabs_give_the_catalogue_of_the_whole() {
    let mut random = Random(12);
    let places = particles(&mut random);
    let speeds: Vec<[f64; 3]> = places.iter().map(|_| [0; 3].map(|_| 300.0 * random.normal())).collect();
    let (length, n_min) = (0.015, 10);
    let ids: Vec<_> = (0..places.len()).map(id).collect();
    let whole = labels_of(&places, Some(&ids), 1.0, length, &Serial).unwrap();
    let expected = catalogues::catalogue(&whole, &places, Some(&speeds), n_min, &Serial).unwrap();
    assert!(expected.len() > 10);
    for slabs in [1, 2, 3, 5] {
        let cut = cut(&places, slabs, length, true);
        let map = merged(&cut, places.len());
        let mut sums = Vec::new();
        for slab in cut {
            let own = slab.own.len();
            let pick = |of: &[[f64; 3]]| slab.own.iter().map(|&i| of[i]).collect::<Vec<_>>();
            let (x, v) = (pick(&places), pick(&speeds));
            let [x, v] = [&x, &v].map(|of| Positions::triples(of.as_flattened()).unwrap());
            let mut of_slab = vec![HaloSums::default(); own / n_min as usize + map.len()];
            let mut memory = Memory::new(halos_scratch(own).unwrap());
            let labels = &slab.labels[..own];
            let count =
                halo_sums(&mut of_slab, labels, &x, Some(&v), 1.0, n_min, &map, memory.get(), &Serial)
                    .unwrap();
            sums.extend_from_slice(&of_slab[..count]);
        }
        let mut reversed: Vec<_> = sums.iter().rev().copied().collect();
        let groups = halo_sums_merge(&mut sums, 1.0).unwrap();
        halo_sums_merge(&mut reversed, 1.0).unwrap();
        assert!(sums[..groups] == reversed[..groups], "any order of processes gives the same bits");
        let mut halos = vec![Halo::default(); groups];
        let count = halos_finish(&mut halos, &sums[..groups], 1.0, n_min, 2.0).unwrap();
        assert_eq!(count, expected.len(), "{slabs} slabs");
        for (halo, expected) in halos.iter().zip(&expected) {
            assert_eq!(
                (halo.label, halo.members, halo.mass),
                (expected.label, expected.members, expected.mass)
            );
            // Rounding of some 10^3 terms; the thread is longer than half the box, and its centre depends on where one begins.
            if expected.extent[0] < 0.4 {
                catalogues::assert_close(halo, expected, 1e-12);
            }
        }
    }
}

#[test]
fn merged_labels_are_the_smallest_that_pairs_connect() {
    let mut random = Random(13);
    for _ in 0..2000 {
        let labels = 1 + random.below(40);
        let pairs: Vec<[u64; 2]> =
            (0..random.below(40)).map(|_| [0; 2].map(|_| 1000 - 7 * random.below(labels) as u64)).collect();
        let mut map = vec![[0; 2]; 2 * pairs.len()];
        let entries = fof_merge(&mut map, &pairs).unwrap();
        let mut expected: Vec<[u64; 2]> = pairs.as_flattened().iter().map(|&label| [label, label]).collect();
        expected.sort_unstable();
        expected.dedup();
        // Until nothing changes.
        for _ in 0..expected.len() {
            for pair in &pairs {
                let at = pair.map(|label| expected.iter().position(|entry| entry[0] == label).unwrap());
                let least = at.map(|i| expected[i][1]).into_iter().min().unwrap();
                for i in at {
                    expected[i][1] = least;
                }
            }
        }
        assert_eq!(map[..entries], expected);
    }
}

#[test]
fn maps_that_are_none_are_refused() {
    assert_eq!(fof_merge(&mut [[0; 2]; 3], &[[1, 2], [3, 4]]), Err(Error::Length));
    assert_eq!(fof_merge(&mut [], &[]), Ok(0));
    let mut labels = [5, 6];
    assert_eq!(fof_relabel(&mut labels, &[[5, 1], [5, 2]], &Serial), Err(Error::Table));
    assert_eq!(labels, [5, 6]);
    fof_relabel(&mut labels, &[[5, 1]], &Serial).unwrap();
    assert_eq!(labels, [1, 6]);
}
