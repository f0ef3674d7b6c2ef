//! Numbers and crowds as no simulation should have them: right answers or a status.

use super::*;
use crate::pm::drift::{Drift, drift};

/// The cells of a mesh of 8 that hold mass, and how much.
fn occupied<T: Real>(mesh: &[T]) -> Vec<(usize, f64)> {
    let cells = mesh.iter().enumerate().filter(|(_, m)| **m != T::ZERO);
    cells.map(|(cell, m)| (cell, m.to_f64())).collect()
}

#[test]
fn places_at_the_ends_of_the_number_range_are_in_the_box() {
    let n = 8;
    let region = region_of(n);
    let assignment = cells(n, Window::NearestGridPoint, 0.0);
    let tiny = f32::MIN_POSITIVE * f32::EPSILON;
    for x in
        [0.0, -0.0, tiny, -tiny, f32::MIN_POSITIVE, 8.0, 8.0_f32.next_down(), 1e30, -1e30, f32::MAX, f32::MIN]
    {
        let mesh = put(&region, &[x, 4.0, 2.0], None, &assignment, &Serial).unwrap();
        // Boxes of a power of two: the remainder of a large f32 is 0; the last f32 before the edge is nearest to its point.
        assert_eq!(occupied(&mesh), [(4 * n + 2, 1.0)], "{x:e}");
        let value = get(&region, &mesh, &[x, 4.0, 2.0], &assignment, &Serial).unwrap();
        assert_eq!(value, [1.0], "{x:e}");
    }
    for x in [1e300, -1e300, f64::MAX, f64::MIN_POSITIVE * f64::EPSILON] {
        let mesh = put(&region, &[x, 4.0, 2.0], None, &assignment, &Serial).unwrap();
        assert_eq!(occupied(&mesh), [(4 * n + 2, 1.0)], "{x:e}");
    }
}

#[test]
fn a_box_of_another_size_by_all_powers_of_ten_gives_the_same_mesh() {
    let n = 8;
    let region = region_of(n);
    let unit: Vec<f64> = random(300, 71);
    let places = |size: f64| -> Vec<f64> { unit.iter().map(|x| x * size).collect() };
    let window = Window::CloudInCell;
    let expect = put(&region, &places(1.0), None, &Assignment { box_size: 1.0, window, shift: 0.0 }, &Serial);
    let expect = expect.unwrap();
    for exponent in [-300, -150, -30, 30, 150, 300] {
        let box_size = 10.0_f64.powi(exponent);
        let assignment = Assignment { box_size, window, shift: 0.0 };
        let mesh = put(&region, &places(box_size), None, &assignment, &Serial).unwrap();
        for (a, b) in mesh.iter().zip(&expect) {
            // A coordinate rounds twice, by an ulp of 8 cells each time; a few particles share a cell.
            assert!((a - b).abs() < 1e-13, "{exponent}: {a} {b}");
        }
    }
    // n/L would not be a number of full precision.
    for box_size in [1e-310, f64::MIN_POSITIVE * f64::EPSILON] {
        let assignment = Assignment { box_size, window, shift: 0.0 };
        assert_eq!(put(&region, &[0.0_f64; 3], None, &assignment, &Serial), Err(Error::Range));
    }
}

#[test]
fn a_quarter_of_a_million_particles_in_one_cell_are_summed_as_they_round() {
    let n = 8;
    let region = region_of(n);
    let particles = 1 << 18;
    let triples: Vec<f32> = [3.0, 7.0, 5.0].repeat(particles);
    for window in Window::ALL {
        let assignment = cells(n, window, 0.0);
        let mesh = put(&region, &triples, None, &assignment, &Threads::new(2).unwrap()).unwrap();
        let mass: f64 = mesh.iter().map(|&m| f64::from(m)).sum();
        match window {
            // Sums of ones.
            Window::NearestGridPoint | Window::CloudInCell => {
                assert_eq!(occupied(&mesh), [((3 * n + 7) * n + 5, particles as f64)]);
            }
            // Each of 3 10^5 additions to a cell rounds by half an ulp of what is there already, mostly to one side where all terms are equal.
            _ => {
                assert!(
                    (mass / particles as f64 - 1.0).abs() < 0.5 * 1.2e-7 * particles as f64,
                    "{window:?}"
                );
            }
        }
        let values = get(&region, &mesh, &triples[..300], &assignment, &Serial).unwrap();
        assert!(values.iter().all(|value| value.to_bits() == values[0].to_bits()));
    }
}

#[test]
fn none_and_one_particle_and_no_weight_are_deposited() {
    let n = 4;
    let region = region_of(n);
    let nothing = Region::new(n, [0; 3], [0, 4, 4], [16, 4, 1]).unwrap();
    for (window, shift) in choices() {
        let assignment = cells(n, window, shift);
        assert!(occupied(&put::<f64>(&region, &[], None, &assignment, &Serial).unwrap()).is_empty());
        assert_eq!(put::<f32>(&nothing, &[], None, &assignment, &Serial), Ok(vec![]));
        assert_eq!(put(&nothing, &[1.0_f64; 3], None, &assignment, &Serial), Err(Error::Outside));
        assert_eq!(get::<f64>(&region, &[1.0; 64], &[], &assignment, &Serial), Ok(vec![]));
        let weightless = put(&region, &[1.25_f64; 30], Some(&[0.0; 10]), &assignment, &Serial).unwrap();
        assert!(occupied(&weightless).is_empty());
        let one = get(&region, &[2.5_f64; 64], &[3.75; 3], &assignment, &Serial).unwrap();
        // The 64 weights of the widest window add up to 1 within a few roundings.
        assert!((one[0] - 2.5).abs() < 1e-14, "a constant is read as it is");
    }
}

#[test]
fn drifts_go_round_the_box_or_are_refused() {
    let moved = |x: f32, u: f32, factor: f64| {
        let mut place = [x; 3];
        let velocity = [u; 3];
        let position = &mut Components::triples(&mut place).unwrap();
        let by = Drift { velocity: factor, first: 0.0, second: 0.0 };
        drift(position, &Positions::triples(&velocity).unwrap(), 4.0, &by, None, &Serial).map(|()| place[0])
    };
    assert_eq!(moved(3.5, 1.0, 1.0), Ok(0.5));
    assert_eq!(moved(0.5, -1.0, 1.0), Ok(3.5));
    assert_eq!(moved(0.5, 3.9e9, 1.0), Ok(0.5), "not quite a thousand million boxes");
    assert_eq!(moved(0.5, 5e9, 1.0), Err(Error::NotFinite));
    for u in [1e38, f32::MAX, f32::MIN] {
        assert_eq!(moved(0.5, u, 1.0), Err(Error::NotFinite), "{u:e}");
        assert_eq!(moved(0.5, u, 1e300), Err(Error::NotFinite), "{u:e}");
        assert_eq!(moved(0.5, u, 0.0), Ok(0.5));
    }
    let tiny = f32::MIN_POSITIVE * f32::EPSILON;
    assert_eq!(moved(-tiny, 0.0, 1.0), Ok(0.0));
    assert_eq!(moved(0.0, -tiny, 1.0), Ok(0.0));
}

#[test]
fn a_kick_beyond_the_numbers_is_refused() {
    let n = 4;
    let region = region_of(n);
    let assignment = cells(n, Window::CloudInCell, 0.0);
    let kicked = |u: f32, force: f32, keep: f64| {
        let mut speeds = [u; 3];
        let forces = vec![force; 64];
        let mut memory = Memory::new(kick_scratch::<f32>(&region, 1, assignment.window).unwrap());
        let velocity = &mut Components::triples(&mut speeds).unwrap();
        let factors = Kick { keep, force: 1.0, first: 0.0, second: 0.0 };
        let position = Positions::triples(&[1.0; 3]).unwrap();
        let scratch = memory.get();
        kick(velocity, &position, [&forces; 3], &region, &assignment, &factors, None, scratch, &Serial)
            .map(|()| speeds[0])
    };
    assert_eq!(kicked(1e38, 1e38, 1.0), Ok(2e38));
    assert_eq!(kicked(3e38, 3e38, 1.0), Err(Error::NotFinite));
    assert_eq!(kicked(3e38, 0.0, 2.0), Err(Error::NotFinite));
    assert_eq!(kicked(0.0, f32::INFINITY, 1.0), Err(Error::NotFinite));
    let tiny = f32::MIN_POSITIVE * f32::EPSILON;
    assert_eq!(kicked(tiny, tiny, 1.0), Ok(2.0 * tiny));
}
