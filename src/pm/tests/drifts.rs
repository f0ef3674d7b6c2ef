//! Drifts, and copies of components.

use super::*;
use crate::pm::drift::drift_with;

fn moved<T: Real>(x: &[T], u: &[T], box_size: f64, velocity: f64) -> Result<Vec<T>> {
    let mut out = x.to_vec();
    let step = Drift { velocity, first: 0.0, second: 0.0 };
    let velocity = Positions::triples(u).unwrap();
    drift(&mut Components::triples(&mut out).unwrap(), &velocity, box_size, &step, None, &Serial)?;
    Ok(out)
}

#[test]
fn drift_moves_along_velocity_and_displacements() {
    let particles = 1000;
    let [x, u, one, two] = [1, 2, 3, 4].map(|seed| random(3 * particles, seed));
    let step = Drift { velocity: 2.5, first: -1.5, second: 0.25 };
    let lpt = Lpt { first: Positions::triples(&one).unwrap(), second: Positions::triples(&two).ok() };
    let mut out = x.clone();
    drift(
        &mut Components::triples(&mut out).unwrap(),
        &Positions::triples(&u).unwrap(),
        1.0,
        &step,
        Some(&lpt),
        &Serial,
    )
    .unwrap();
    for (i, place) in out.iter().enumerate() {
        let sum = x[i] + 2.5 * u[i] - 1.5 * one[i] + 0.25 * two[i];
        // Sums of up to 4 rounded a few times; where that crosses the edge, so does the place.
        let off = (place - sum.rem_euclid(1.0)).abs();
        assert!(off.min(1.0 - off) <= 8.0 * f64::EPSILON && (0.0..1.0).contains(place));
    }
}

#[test]
fn drift_wraps_exactly() {
    // Powers of two: no sum below rounds.
    let length = 64.0;
    for (x, step, expect) in [
        (1.0, 2.0, 3.0),
        (63.0, 1.0, 0.0),
        (63.0, 1.5, 0.5),
        (0.5, -1.0, 63.5),
        (0.0, -64.0, 0.0),
        (0.0, -6400.5, 63.5),
        (0.25, 64.0 * 1e9, 0.25),
        (-130.0, 0.0, 62.0),
        (64.0, 0.0, 0.0),
        (-64.0, 0.0, 0.0),
        (1e9, 0.0, 0.0),
    ] {
        assert_eq!(moved(&[x; 3], &[step; 3], length, 1.0), Ok(vec![expect; 3]), "{x} {step}");
        let single = moved(&[x as f32; 3], &[step as f32; 3], length, 1.0);
        assert_eq!(single, Ok(vec![expect as f32; 3]), "{x} {step}");
    }
}

#[test]
fn places_an_ulp_from_an_edge_are_brought_home() {
    let length = 1_077.188_352_077_819_7;
    for boxes in -20..20 {
        let edge = f64::from(boxes) * length;
        for x in [edge.next_down(), edge, edge.next_up()] {
            let out = moved(&[x; 3], &[0.0; 3], length, 1.0).unwrap();
            assert!(out.iter().all(|x| (0.0..length).contains(x)), "{x}: {out:?}");
        }
    }
}

#[test]
fn drift_never_ends_on_the_far_edge() {
    // 0.1 and 1/3 round up and down in f32.
    for length in [0.1, 1.0 / 3.0, 1.0, 256.0, 1000.0, 0.7] {
        let edge = length as f32;
        for x in
            [-f32::MIN_POSITIVE, -1e-30, -1e-10 * edge, edge.next_down(), edge, edge.next_up(), -edge, 0.0]
        {
            for step in [0.0, 1e-9 * edge, -1e-9 * edge, edge, -edge] {
                let out = moved(&[x; 3], &[step; 3], length, 1.0).unwrap();
                assert!(
                    out.iter().all(|&x| x >= 0.0 && f64::from(x) < length),
                    "{length} {x} {step}: {out:?}"
                );
            }
        }
        for x in [-f64::MIN_POSITIVE, -1e-30, -1e-17 * length, length.next_down(), length, -length] {
            let out = moved(&[x; 3], &[0.0; 3], length, 1.0).unwrap();
            assert!(out.iter().all(|&x| x >= 0.0 && x < length), "{length} {x}: {out:?}");
        }
    }
}

#[test]
fn drift_has_the_same_bits_on_any_threads_and_instructions() {
    fn check<T: Real>() {
        let particles = 2 * sort::CHUNK + 77;
        let [x, u, one, two] = [1, 2, 3, 4].map(|seed| {
            random(3 * particles, seed).iter().map(|x| T::from_f64(30.0 * x - 10.0)).collect::<Vec<_>>()
        });
        let lpt = Lpt { first: Positions::triples(&one).unwrap(), second: Positions::triples(&two).ok() };
        let step = Drift { velocity: 0.7, first: 0.3, second: -0.2 };
        let run = |simd: Simd, exec: &dyn Exec| {
            let mut out = x.clone();
            let position = &mut Components::triples(&mut out).unwrap();
            drift_with(simd, position, &Positions::triples(&u).unwrap(), 10.0, &step, Some(&lpt), exec)
                .unwrap();
            bits(&out)
        };
        let first = run(Simd::Portable, &Serial);
        for threads in [1, 2, 5] {
            assert!(run(Simd::detect(), &Threads::new(threads).unwrap()) == first);
        }
    }
    check::<f32>();
    check::<f64>();
}

#[test]
fn what_cannot_be_moved_is_refused() {
    for bad in [f64::NAN, f64::INFINITY, 1e300] {
        for axis in 0..3 {
            let mut triple = [0.5; 3];
            triple[axis] = bad;
            assert_eq!(moved(&triple, &[0.0; 3], 1.0, 1.0), Err(Error::NotFinite));
            assert_eq!(moved(&[0.0; 3], &triple, 1.0, 1.0), Err(Error::NotFinite));
        }
    }
    assert_eq!(moved(&[0.5; 3], &[3.0; 3], 1.0, 1e9), Err(Error::NotFinite), "too many boxes away");
    assert_eq!(moved(&[0.5; 3], &[0.0; 3], f64::NAN, 1.0), Err(Error::NotFinite));
    assert_eq!(moved(&[0.5; 3], &[0.0; 3], 1.0, f64::INFINITY), Err(Error::NotFinite));
    assert_eq!(moved(&[0.5; 3], &[0.0; 3], 0.0, 1.0), Err(Error::Range));
    assert_eq!(moved(&[0.5; 3], &[0.0; 3], -1.0, 1.0), Err(Error::Range));
    assert_eq!(moved(&[0.5_f32; 3], &[0.0; 3], 1e-60, 1.0), Err(Error::Range));
    assert_eq!(moved(&[0.5; 3], &[0.0; 6], 1.0, 1.0), Err(Error::Length));
    assert_eq!(moved::<f64>(&[], &[], 1.0, 1.0), Ok(vec![]), "nobody is welcome");
    let step = Drift { velocity: 1.0, first: 0.0, second: 1.0 };
    let (mut x, u) = ([0.5; 3], [0.0; 3]);
    let mut position = Components::triples(&mut x).unwrap();
    let velocity = Positions::triples(&u).unwrap();
    let lpt = Lpt { first: velocity, second: None };
    let refused = drift(&mut position, &velocity, 1.0, &step, Some(&lpt), &Serial);
    assert_eq!(refused, Err(Error::Null), "a factor of nothing");
}

#[test]
fn components_are_copied_between_any_layouts() {
    let particles = sort::CHUNK + 70;
    let from: Vec<f32> = random(3 * particles, 1).iter().map(|&x| x as f32).collect();
    let mut arrays = [(); 3].map(|()| vec![0.0; particles]);
    let [x, y, z] = &mut arrays;
    let mut separate = Components::separate([x, y, z]).unwrap();
    let pool = Threads::new(2).unwrap();
    copy_components(&mut separate, &Positions::triples(&from).unwrap(), &pool).unwrap();
    let mut back = vec![0.0; 3 * particles];
    let mut triples = Components::triples(&mut back).unwrap();
    copy_components(&mut triples, &Positions::from(&separate), &pool).unwrap();
    assert!(back == from && arrays[1][particles - 1] == from[3 * particles - 2]);
    let fewer = Positions::triples(&from[3..]).unwrap();
    let mut triples = Components::triples(&mut back).unwrap();
    assert_eq!(copy_components(&mut triples, &fewer, &pool), Err(Error::Length));
}
