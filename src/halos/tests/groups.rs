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
