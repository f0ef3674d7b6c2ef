//! Particles and small parts of meshes that no memory holds.

use super::*;
use crate::mesh::LARGEST_SIDE;
use crate::pm::ghosts::copy_cells;
use crate::pm::kick::kick_with;

const SIDES: [usize; 3] = [1_000_000, 1 << 20, LARGEST_SIDE];
const SMALL: usize = 16;
const COUNT: usize = 10;

/// The same ten cells on each axis of a large mesh and of one of 16, from a cell `first` steps before the edge of the box.
fn twins(n: usize, first: usize) -> [Region; 2] {
    [n, SMALL].map(|n| Region::new(n, [n - first; 3], [COUNT; 3], [COUNT * COUNT, COUNT, 1]).unwrap())
}

/// Places in quarters of a cell, in the same cells of both meshes: exact in both, and in `f32` up to 2^21 cells and half a cell more.
fn places<T: Real>(n: usize, first: usize) -> [Vec<T>; 2] {
    let steps: Vec<f64> = random(300, 61).iter().map(|x| 2.0 + (x * 20.0).floor() / 4.0).collect();
    [n, SMALL].map(|n| {
        let side = n as f64;
        steps.iter().map(|step| T::from_f64((side - first as f64 + step) % side)).collect()
    })
}

fn are_twins<T: Real>() {
    for n in SIDES {
        // Before the edge of the box, and over it.
        for first in [COUNT, 5] {
            let [region, twin] = twins(n, first);
            let [triples, twins] = places::<T>(n, first);
            for (window, shift) in choices() {
                let mesh = put(&region, &triples, None, &cells(n, window, shift), &Serial).unwrap();
                let expect = put(&twin, &twins, None, &cells(SMALL, window, shift), &Serial).unwrap();
                // In single precision a place plus half a cell is exact, too.
                assert_eq!(bits(&mesh), bits(&expect), "{n} {window:?} {shift}");
                let read = get(&region, &mesh, &triples, &cells(n, window, shift), &Serial).unwrap();
                let expect = get(&twin, &expect, &twins, &cells(SMALL, window, shift), &Serial).unwrap();
                assert_eq!(bits(&read), bits(&expect), "{n} {window:?} {shift}");
            }
        }
    }
}

#[test]
fn cells_of_the_largest_mesh_are_filled_as_those_of_a_small_one() {
    are_twins::<f32>();
    are_twins::<f64>();
}

#[test]
fn particles_of_the_largest_mesh_are_kicked_as_those_of_a_small_one() {
    for n in SIDES {
        let [region, twin] = twins(n, 5);
        let [triples, twins] = places::<f64>(n, 5);
        let force: Vec<f64> = random(region.reals(), 62);
        let kicked = |region: &Region, places: &[f64], n| {
            let assignment = cells(n, Window::PiecewiseCubicSpline, 0.5);
            let mut speeds = vec![1.0; places.len()];
            let positions = Positions::triples(places).unwrap();
            let mut memory =
                Memory::new(kick_scratch::<f64>(region, positions.len(), assignment.window).unwrap());
            let velocity = &mut Components::triples(&mut speeds).unwrap();
            let factors = Kick { keep: 0.5, force: 2.0, first: 0.0, second: 0.0 };
            let forces = [&force[..]; 3];
            let scratch = memory.get();
            let simd = Simd::detect();
            kick_with(
                simd,
                velocity,
                &positions,
                forces,
                region,
                &assignment,
                &factors,
                None,
                scratch,
                &Serial,
            )
            .unwrap();
            speeds
        };
        assert_eq!(bits(&kicked(&region, &triples, n)), bits(&kicked(&twin, &twins, SMALL)));
    }
}

#[test]
fn a_particle_just_outside_a_part_of_the_largest_mesh_is_refused() {
    for n in SIDES {
        let [region, _] = twins(n, COUNT);
        let cell = (n - COUNT) as f64;
        let assignment = cells(n, Window::CloudInCell, 0.0);
        for outside in [cell - 0.5, cell / 2.0, 0.5] {
            let triple = [cell + 2.0, outside, cell + 2.0];
            assert_eq!(put(&region, &triple, None, &assignment, &Serial), Err(Error::Outside), "{n}");
        }
    }
}

#[test]
fn ghosts_of_the_last_cells_are_the_first() {
    // Small parts of small meshes, too: what they do not share lies beyond the end of their arrays.
    for n in SIDES.into_iter().chain([64]) {
        let last = Brick::general(n, Space::Configuration, [n - 2, 0, n / 2], [2, 3, 4], [12, 4, 1]).unwrap();
        let wide = Region::with_ghosts(&last, Window::PiecewiseCubicSpline, 0.5).unwrap();
        assert_eq!(wide.start(), [n - 4, n - 2, n / 2 - 2]);
        assert_eq!(wide.count(), [6, 7, 8]);
        let first = Region::new(n, [0, 0, n / 2], [3, 3, 4], [12, 4, 1]).unwrap();
        let cells: Vec<f64> = (0..first.reals()).map(|i| 1.0 + i as f64).collect();
        let mut ghosts = vec![0.0; wide.reals()];
        copy_cells(&mut ghosts, &wide, &cells, &first, &Serial).unwrap();
        // Planes n = 0 and n + 1 = 1 are the fifth and sixth of the region.
        let stride = wide.stride();
        for (x, from) in [(4, 0), (5, 12)] {
            for y in 0..3 {
                for z in 0..4 {
                    let at = x * stride[0] + (y + 2) * stride[1] + z + 2;
                    assert_eq!(ghosts[at], cells[from + 4 * y + z]);
                }
            }
        }
        let full = ghosts.iter().filter(|&&cell| cell != 0.0).count();
        assert_eq!(full, 2 * 3 * 4);
    }
}

#[test]
fn scratch_does_not_grow_with_10_10_particles() {
    let region = region_of(64);
    for window in Window::ALL {
        let [few, many] = [1 << 21, 10_000_000_000]
            .map(|particles| deposit_scratch::<f32>(&region, particles, window).unwrap());
        assert_eq!(few, many);
        assert!(many.size <= 41_000_000);
        let kick = kick_scratch::<f32>(&region, 10_000_000_000, window).unwrap();
        assert_eq!(kick, kick_scratch::<f32>(&region, 1 << 21, window).unwrap());
        let read = read_out_scratch::<f64>(&region, usize::MAX, window).unwrap();
        assert_eq!(read, read_out_scratch::<f64>(&region, 1 << 21, window).unwrap());
    }
}
