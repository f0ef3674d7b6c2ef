//! Friends of friends and spherical overdensities straight from their definition: all pairs, all distances.

use std::vec::Vec;

use crate::real::Real;

/// d^2 to the nearest image, of coordinates in [0, L).
pub(crate) fn distance_squared(a: [f64; 3], b: [f64; 3], box_size: f64) -> f64 {
    let [x, y, z] = [0, 1, 2].map(|axis| {
        let direct = (a[axis] - b[axis]).abs();
        direct.min(box_size - direct)
    });
    (x * x + y * y) + z * z
}

/// Labels of places in [0, L).
pub(crate) fn labels<T: Real>(
    places: &[[T; 3]],
    ids: Option<&[u64]>,
    box_size: f64,
    length: f64,
) -> Vec<u64> {
    let places: Vec<_> = places.iter().map(|place| place.map(T::to_f64)).collect();
    let mut labels: Vec<u64> = ids.map_or_else(|| (0..places.len() as u64).collect(), <[u64]>::to_vec);
    for i in 0..places.len() {
        for j in 0..i {
            if distance_squared(places[i], places[j], box_size) <= length * length {
                let (a, b) = (labels[i].min(labels[j]), labels[i].max(labels[j]));
                labels.iter_mut().filter(|label| **label == b).for_each(|label| *label = a);
            }
        }
    }
    labels
}

/// The fewest particles, `n_min` or more, that fill their radius exactly, if `n_min` more than fill theirs.
pub(crate) fn members<T: Real>(
    places: &[[T; 3]],
    centre: [f64; 3],
    box_size: f64,
    n_min: u64,
    radius: impl Fn(u64) -> f64,
) -> Option<u64> {
    let within = |r: f64| {
        let near = |place: &&[T; 3]| distance_squared(place.map(T::to_f64), centre, box_size) <= r * r;
        places.iter().filter(near).count() as u64
    };
    (within(radius(n_min)) >= n_min).then(|| (n_min..).find(|&k| within(radius(k)) == k)).flatten()
}
