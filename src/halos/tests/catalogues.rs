//! Catalogues against sums over each group's particles.

use super::*;

const MASS: f64 = 2.0;

pub(super) fn catalogue<T: Real>(
    labels: &[u64],
    places: &[[T; 3]],
    speeds: Option<&[[T; 3]]>,
    n_min: u64,
    exec: &dyn Exec,
) -> Result<Vec<Halo>> {
    let mut out = vec![Halo::default(); places.len() / (n_min.max(1) as usize)];
    let mut memory = Memory::new(halos_scratch(places.len())?);
    let x = Positions::triples(places.as_flattened())?;
    let v = speeds.map(|speeds| Positions::triples(speeds.as_flattened()).unwrap());
    let count = halos(&mut out, labels, &x, v.as_ref(), 1.0, n_min, MASS, memory.get(), exec)?;
    out.truncate(count);
    Ok(out)
}

/// The same to a part of the box side, and velocities to a part of 1000.
pub(super) fn assert_close(halo: &Halo, expected: &Halo, part: f64) {
    for axis in 0..3 {
        let apart = (halo.centre[axis] - expected.centre[axis]).abs();
        assert!(apart.min(1.0 - apart) < part, "{halo:?}, {expected:?}");
        assert!((0.0..1.0).contains(&halo.centre[axis]));
        assert!((halo.extent[axis] - expected.extent[axis]).abs() < part, "{halo:?}, {expected:?}");
        assert!((halo.velocity[axis] - expected.velocity[axis]).abs() < 1e3 * part, "{halo:?}, {expected:?}");
    }
    // Of a difference of squares, so that its own error is the root where all particles coincide.
    assert!((halo.radius.powi(2) - expected.radius.powi(2)).abs() < part, "{halo:?}, {expected:?}");
    let squares = halo.velocity_dispersion.powi(2) - expected.velocity_dispersion.powi(2);
    assert!(squares.abs() < 1e6 * part, "{halo:?}, {expected:?}");
}

/// From the definition, with the first particle as the origin.
fn by_definition(label: u64, members: &[usize], places: &[[f64; 3]], speeds: &[[f64; 3]]) -> Halo {
    let n = members.len() as f64;
    let wrap = |d: f64| d - d.round();
    let axes = [0, 1, 2];
    let d: Vec<_> =
        members.iter().map(|&i| axes.map(|a| wrap(places[i][a] - places[members[0]][a]))).collect();
    let mean = |of: &[[f64; 3]]| axes.map(|a| of.iter().map(|x| x[a]).sum::<f64>() / n);
    let scatter = |of: &[[f64; 3]]| {
        let mean = mean(of);
        (of.iter().map(|x| axes.map(|a| (x[a] - mean[a]).powi(2)).iter().sum::<f64>()).sum::<f64>() / n)
            .sqrt()
    };
    let u: Vec<_> = members.iter().map(|&i| speeds[i]).collect();
    let end = |axis: usize, pick: fn(f64, f64) -> f64| d.iter().map(|d| d[axis]).reduce(pick).unwrap();
    Halo {
        label,
        members: members.len() as u64,
        mass: n * MASS,
        centre: axes.map(|a| (places[members[0]][a] + mean(&d)[a]).rem_euclid(1.0)),
        velocity: mean(&u),
        radius: scatter(&d),
        extent: axes.map(|a| end(a, f64::max) - end(a, f64::min)),
        velocity_dispersion: scatter(&u),
    }
}

#[test]
fn halos_have_the_means_of_their_particles_and_come_in_order_of_size() {
    let mut random = Random(21);
    for n_min in [1, 2, 10, 20] {
        let places = clumps::<f64>(&mut random, 3000);
        let speeds: Vec<_> = places.iter().map(|_| [0; 3].map(|_| 500.0 + 300.0 * random.normal())).collect();
        let labels = labels_of(&places, None, 1.0, 0.01, &Serial).unwrap();
        let mut expected: Vec<Halo> = (0..places.len())
            .filter_map(|label| {
                let members: Vec<_> = (0..places.len()).filter(|&i| labels[i] == label as u64).collect();
                let kept = members.len() as u64 >= n_min;
                kept.then(|| by_definition(label as u64, &members, &places, &speeds))
            })
            .collect();
        expected.sort_by_key(|halo| (std::cmp::Reverse(halo.members), halo.label));
        let halos = catalogue(&labels, &places, Some(&speeds), n_min, &Serial).unwrap();
        assert_eq!(halos.len(), expected.len());
        assert!(halos.len() > 3 && (n_min > 1 || halos.len() > 30));
        for (halo, expected) in halos.iter().zip(&expected) {
            assert_eq!(
                (halo.label, halo.members, halo.mass),
                (expected.label, expected.members, expected.mass)
            );
            // Rounding of 10^3 terms.
            assert_close(halo, expected, 1e-12);
        }
    }
}

#[test]
fn the_least_number_of_members_is_inclusive() {
    let places: Vec<[f64; 3]> = [0.1, 0.1, 0.1, 0.5, 0.5, 0.9].map(|x| [x, 0.0, 0.0]).to_vec();
    let labels = labels_of(&places, None, 1.0, 0.01, &Serial).unwrap();
    let members = |n_min| {
        let halos = catalogue(&labels, &places, None, n_min, &Serial).unwrap();
        halos.iter().map(|halo| halo.members).collect::<Vec<_>>()
    };
    assert_eq!(
        (members(1), members(2), members(3), members(4)),
        (vec![3, 2, 1], vec![3, 2], vec![3], vec![])
    );
}

#[test]
fn a_halo_on_the_edge_has_its_centre_there() {
    let places = [[0.99, 0.02, 0.0], [0.01, 0.98, 0.0]];
    let halo = catalogue(&[4, 4], &places, None, 2, &Serial).unwrap()[0];
    let expected = Halo {
        label: 4,
        members: 2,
        mass: 2.0 * MASS,
        radius: (0.01_f64.powi(2) + 0.02_f64.powi(2)).sqrt(),
        extent: [0.02, 0.04, 0.0],
        ..Halo::default()
    };
    assert_close(&halo, &expected, 1e-15);
}

#[test]
fn catalogues_are_the_same_bits_on_any_number_of_threads() {
    let places = clumps::<f32>(&mut Random(22), 60_000);
    let labels = labels_of(&places, None, 1.0, 0.004, &Serial).unwrap();
    let halos = catalogue(&labels, &places, Some(&places), 5, &Serial).unwrap();
    assert!(halos.len() > 20);
    for threads in [2, 5] {
        let pool = Threads::new(threads).unwrap();
        assert!(catalogue(&labels, &places, Some(&places), 5, &pool).unwrap() == halos);
    }
}

#[test]
fn what_is_wrong_is_refused() {
    let places = [[0.5_f64; 3]; 4];
    let x = Positions::triples(places.as_flattened()).unwrap();
    let mut memory = Memory::new(halos_scratch(4).unwrap());
    let mut out = [Halo { label: 9, ..Halo::default() }; 2];
    let mut call = |labels: &[u64], n_min, mass| {
        let result = halos(&mut out, labels, &x, None, 1.0, n_min, mass, memory.get(), &Serial);
        assert!(result.is_ok() || out.iter().all(|halo| halo.label == 9), "refused calls write nothing");
        result
    };
    assert_eq!(call(&[0, 1, 2, 3], 1, 1.0), Err(Error::Length), "four groups, room for two");
    assert_eq!(call(&[0; 3], 1, 1.0), Err(Error::Length));
    assert_eq!(call(&[0; 4], 0, 1.0), Err(Error::Range));
    assert_eq!(call(&[0; 4], 1, 0.0), Err(Error::Range));
    assert_eq!(call(&[0; 4], 1, f64::NAN), Err(Error::NotFinite));
    assert_eq!(call(&[0, 0, 1, 1], 2, 1.0), Ok(2));
    let bad = [[f64::NAN; 3]; 4];
    assert_eq!(catalogue(&[0; 4], &bad, None, 1, &Serial), Err(Error::NotFinite));
    assert_eq!(catalogue(&[0; 4], &places, Some(&bad), 1, &Serial), Err(Error::NotFinite));
    let none = HaloSums::default();
    let infinite = HaloSums { members: 1, position_squared: f64::INFINITY, ..none };
    assert_eq!(halo_sums_merge(&mut [none], 1.0), Err(Error::Range));
    assert_eq!(halo_sums_merge(&mut [infinite], 1.0), Err(Error::NotFinite));
    assert_eq!(
        halo_sums_merge(&mut [HaloSums { members: 1, reference: [1.0; 3], ..none }], 1.0),
        Err(Error::Range)
    );
}
