use std::vec;
use std::vec::Vec;

use super::deposit::deposit_with;
use super::interlace::interlace_with;
use super::read_out::read_out_with;
use super::window::weights;
use super::*;
use crate::exec::{Exec, Serial, Threads};
use crate::mesh::{Brick, Space};
use crate::real::Real;
use crate::reference::deposit::{spline, windows};
use crate::scratch::Layout;
use crate::simd::Simd;
use crate::status::{Error, Result};

/// Aligned memory for a layout.
struct Memory(Vec<u8>, usize, usize);

impl Memory {
    fn new(layout: Layout) -> Self {
        let bytes = vec![0xff; layout.size + layout.align];
        let skip = bytes.as_ptr().align_offset(layout.align);
        Self(bytes, skip, layout.size)
    }

    fn get(&mut self) -> &mut [u8] {
        &mut self.0[self.1..self.1 + self.2]
    }
}

fn region_of(n: usize) -> Region {
    Region::new(n, [0; 3], [n; 3], [n * n, n, 1]).unwrap()
}

fn cells(n: usize, window: Window, shift: f64) -> Assignment {
    Assignment { box_size: n as f64, window, shift }
}

/// Deposits triples.
fn put<T: Real>(
    region: &Region,
    triples: &[T],
    weights: Option<&[T]>,
    assignment: &Assignment,
    exec: &dyn Exec,
) -> Result<Vec<T>> {
    let mut mesh = vec![T::ZERO; region.reals()];
    let positions = Positions::triples(triples).unwrap();
    let mut memory = Memory::new(deposit_scratch::<T>(region, positions.len(), assignment.window)?);
    let weights = weights.map(Column::new);
    deposit(&mut mesh, region, &positions, weights.as_ref(), assignment, memory.get(), exec)?;
    Ok(mesh)
}

/// Reads out at triples.
fn get<T: Real>(
    region: &Region,
    mesh: &[T],
    triples: &[T],
    assignment: &Assignment,
    exec: &dyn Exec,
) -> Result<Vec<T>> {
    let positions = Positions::triples(triples).unwrap();
    let mut values = vec![T::ZERO; positions.len()];
    let mut memory = Memory::new(read_out_scratch::<T>(region, positions.len(), assignment.window)?);
    let mut column = ColumnMut::new(&mut values);
    read_out(&mut column, mesh, region, &positions, assignment, memory.get(), exec)?;
    Ok(values)
}

/// Numbers in [0, 1), from a linear congruence.
fn random(count: usize, seed: u64) -> Vec<f64> {
    let mut state = seed;
    let mut next = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    };
    (0..count).map(|_| next()).collect()
}

fn bits<T: Real>(values: &[T]) -> Vec<u64> {
    values.iter().map(|value| value.to_f64().to_bits()).collect()
}

fn sum(values: &[f64]) -> f64 {
    values.iter().sum()
}

fn choices() -> impl Iterator<Item = (Window, f64)> {
    Window::ALL.into_iter().flat_map(|window| [0.0, 0.5].map(|shift| (window, shift)))
}

/// Coordinates on an axis of n cells: eighths of a cell, the edges of the box and what lies next to them, and boxes away.
fn coordinates(n: usize) -> Vec<f64> {
    let side = n as f64;
    let mut all: Vec<f64> = (0..8 * n).map(|i| i as f64 / 8.0).collect();
    all.extend([
        -1e-300,
        -1e-17,
        -0.25,
        side,
        side.next_down(),
        side + 0.375,
        -side,
        0.25 - side,
        3.0 * side + 0.5,
        0.3,
    ]);
    all
}

fn axis_weights<const P: usize>(f: f64) -> [f64; 4] {
    weights::<f64, P>(&[f, 0.25, f, 0.5]).map(|weight| weight[2])
}

#[test]
fn weights_are_splines_with_unit_sum_and_mirror_symmetry() {
    fn check<const P: usize>(window: Window) {
        for i in 0..=1000 {
            let f = f64::from(i) / 1000.0;
            let w = axis_weights::<P>(f);
            // Each weight is rounded a few times.
            assert!((sum(&w) - 1.0).abs() <= 2.0 * f64::EPSILON, "{window:?} {f}");
            for k in 0..4 {
                let s = f + window.before() as f64 - window.offset() - k as f64;
                let expect = if k < P && f < 1.0 { spline(window, s) } else { w[k] };
                assert!((w[k] - expect).abs() <= 4.0 * f64::EPSILON, "{window:?} {f} {k}");
                assert!(w[k] >= 0.0);
            }
            // 1 - (1 - g) is g for g in [1/2, 1].
            let g = 1.0 - f;
            if g >= 0.5 {
                let mirrored = axis_weights::<P>(g);
                let f = axis_weights::<P>(1.0 - g);
                assert!((0..P).all(|k| mirrored[k].to_bits() == f[P - 1 - k].to_bits()), "{window:?}");
            }
            // B-splines of order 2 and more reproduce linear functions: the mean place is the particle's.
            if P > 1 {
                let mean: f64 = (0..P).map(|k| w[k] * k as f64).sum();
                let place = f + window.before() as f64 - window.offset();
                assert!((mean - place).abs() <= 8.0 * f64::EPSILON);
            }
            // Their variance is p/12, from order 3 on at every place.
            if P > 2 {
                let place = f + window.before() as f64 - window.offset();
                let variance: f64 = (0..P).map(|k| w[k] * (k as f64 - place).powi(2)).sum();
                assert!((variance - P as f64 / 12.0).abs() <= 16.0 * f64::EPSILON);
            }
        }
    }
    check::<1>(Window::NearestGridPoint);
    check::<2>(Window::CloudInCell);
    check::<3>(Window::TriangularShapedCloud);
    check::<4>(Window::PiecewiseCubicSpline);
}

#[test]
fn every_place_on_tiny_meshes_is_deposited_as_defined() {
    for n in [2, 4] {
        let region = region_of(n);
        let along = coordinates(n);
        for (window, shift) in choices() {
            let assignment = cells(n, window, shift);
            let mut memory = Memory::new(deposit_scratch::<f64>(&region, 1, window).unwrap());
            let mut mesh = vec![0.0; region.reals()];
            for (i, &x) in along.iter().enumerate() {
                for (j, &y) in along.iter().enumerate() {
                    // On the larger mesh one of three z, another one for each (x, y).
                    for &z in along.iter().skip(if n == 2 { 0 } else { (i + j) % 3 }).step_by(n - 1) {
                        mesh.fill(0.0);
                        let triple = [x, y, z];
                        let positions = Positions::triples(&triple).unwrap();
                        let scratch = memory.get();
                        deposit_with(
                            Simd::Portable,
                            &mut mesh,
                            &region,
                            &positions,
                            None,
                            &assignment,
                            scratch,
                            &Serial,
                        )
                        .unwrap();
                        for (cell, expect) in windows(window, n, shift, triple).into_iter().enumerate() {
                            // Products of three weights, each good to 4 roundings of 1.
                            assert!(
                                (mesh[cell] - expect).abs() <= 16.0 * f64::EPSILON,
                                "{window:?} {shift} {triple:?} {cell}: {} {expect}",
                                mesh[cell]
                            );
                        }
                        assert!((sum(&mesh) - 1.0).abs() <= 16.0 * f64::EPSILON);
                    }
                }
            }
        }
    }
}

#[test]
fn read_out_is_the_adjoint_everywhere_on_tiny_meshes() {
    for n in [2, 4, 6] {
        let region = region_of(n);
        let mesh: Vec<f64> = random(n * n * n, 5).iter().map(|x| x - 0.5).collect();
        let along = coordinates(n);
        let mut triples = Vec::new();
        for &x in &along {
            for &y in along.iter().step_by(n / 2) {
                for &z in along.iter().step_by(n - 1) {
                    triples.extend([x, y, z]);
                }
            }
        }
        for (window, shift) in choices() {
            let assignment = cells(n, window, shift);
            let values = get(&region, &mesh, &triples, &assignment, &Serial).unwrap();
            for (triple, value) in triples.chunks(3).zip(&values) {
                let window = windows(window, n, shift, [triple[0], triple[1], triple[2]]);
                let expect: f64 = window.iter().zip(&mesh).map(|(w, m)| w * m).sum();
                assert!((value - expect).abs() <= 16.0 * f64::EPSILON);
            }
            let w = random(values.len(), 7);
            let deposited = put(&region, &triples, Some(&w), &assignment, &Serial).unwrap();
            let left: f64 = deposited.iter().zip(&mesh).map(|(d, m)| d * m).sum();
            let right: f64 = w.iter().zip(&values).map(|(w, v)| w * v).sum();
            // Sums of N terms below 1/2, with signs: errors add up like a random walk, here with room to spare.
            assert!((left - right).abs() <= 1e-12 * (values.len() as f64).sqrt(), "{left} {right}");
        }
    }
}

#[test]
fn mass_is_conserved() {
    let n = 16;
    let region = region_of(n);
    let triples: Vec<f64> = random(30_000, 1).iter().map(|x| x * 16.0).collect();
    let integers: Vec<f64> = random(10_000, 2).iter().map(|x| (x * 1e6).floor()).collect();
    for (window, shift) in choices() {
        let mesh = put(&region, &triples, Some(&integers), &cells(n, window, shift), &Serial).unwrap();
        let (mass, total) = (sum(&mesh), sum(&integers));
        if window == Window::NearestGridPoint {
            assert_eq!(mass, total, "sums of integers are exact");
        } else {
            // Each of 10^4 particles loses up to a few ulps of its weight, and cells round as they grow.
            assert!((mass - total).abs() <= 1e-14 * total, "{window:?}");
        }
        let single: Vec<f32> = triples.iter().map(|&x| x as f32).collect();
        let mesh = put(&region, &single, None, &cells(n, window, shift), &Serial).unwrap();
        let mass: f64 = mesh.iter().map(|&m| f64::from(m)).sum();
        assert!((mass - 1e4).abs() <= 1e4 * f64::from(f32::EPSILON), "{window:?}");
    }
}

/// A few thousand particles on a mesh of several tiles: in and out of the box, some of them in lattice order.
fn crowd<T: Real>(n: usize) -> Vec<T> {
    let side = n as f64;
    let mut all: Vec<f64> = random(9_000, 3).iter().map(|x| (3.0 * x - 1.0) * side).collect();
    for i in 0..n * n * 4 {
        let (x, y, z) = (i / (4 * n), i / 4 % n, i % 4);
        all.extend([x as f64 + 0.3, y as f64 + 0.7, 5.0 + z as f64 / 3.0]);
    }
    all.into_iter().map(T::from_f64).collect()
}

#[test]
fn bits_do_not_depend_on_threads_or_instructions() {
    fn check<T: Real>() {
        for n in [18, 24] {
            // Tiles in an odd ring, an even ring, and an open row.
            let whole = region_of(n);
            let part = Region::new(n, [n - 3, 0, 0], [n - 1, n, n], [n * (n + 2), n + 2, 1]).unwrap();
            let triples = crowd::<T>(n);
            // Inside the part for every window: first coordinates 2 .. n - 8.
            let kept: Vec<T> = triples
                .chunks(3)
                .filter(|triple| (2.0..n as f64 - 8.0).contains(&triple[0].to_f64()))
                .flatten()
                .copied()
                .collect();
            for (region, triples) in [(whole, &triples), (part, &kept)] {
                let positions = Positions::triples(triples).unwrap();
                let w: Vec<T> = random(positions.len(), 4).into_iter().map(T::from_f64).collect();
                let mut memory = Memory::new(
                    deposit_scratch::<T>(&region, positions.len(), Window::PiecewiseCubicSpline).unwrap(),
                );
                for (window, shift) in choices() {
                    let mut run = |simd: Simd, exec: &dyn Exec| {
                        let assignment = cells(n, window, shift);
                        let weights = Column::new(&w);
                        let mut mesh = vec![T::ZERO; region.reals()];
                        deposit_with(
                            simd,
                            &mut mesh,
                            &region,
                            &positions,
                            Some(&weights),
                            &assignment,
                            memory.get(),
                            exec,
                        )
                        .unwrap();
                        let mut values = vec![T::ZERO; positions.len()];
                        let mut column = ColumnMut::new(&mut values);
                        read_out_with(
                            simd,
                            &mut column,
                            &mesh,
                            &region,
                            &positions,
                            &assignment,
                            memory.get(),
                            exec,
                        )
                        .unwrap();
                        (bits(&mesh), bits(&values))
                    };
                    let first = run(Simd::Portable, &Serial);
                    for threads in [1, 2, 5] {
                        let pool = Threads::new(threads).unwrap();
                        assert!(run(Simd::detect(), &pool) == first, "{window:?} {shift} {threads}");
                    }
                }
            }
        }
    }
    check::<f32>();
    check::<f64>();
}

#[test]
fn batches_join_without_a_seam() {
    // Two batches and a bit, on few tiles; positions repeat, so the count in each cell is known.
    let n = 8;
    let particles = 2 * sort::BATCH + 77;
    let triples: Vec<f32> =
        (0..particles).flat_map(|i| [(i % 8) as f32, (i / 8 % 8) as f32, (i / 64 % 8) as f32]).collect();
    let region = region_of(n);
    let pool = Threads::new(2).unwrap();
    let assignment = cells(n, Window::CloudInCell, 0.0);
    let mesh = put(&region, &triples, None, &assignment, &pool).unwrap();
    for x in 0..8 {
        for y in 0..8 {
            for z in 0..8 {
                let number = x + 8 * y + 64 * z;
                let expect = (particles - number).div_ceil(512);
                assert_eq!(mesh[(x * 8 + y) * 8 + z], expect as f32);
            }
        }
    }
    let values = get(&region, &mesh, &triples, &assignment, &pool).unwrap();
    for (i, value) in values.iter().enumerate() {
        assert_eq!(*value, (particles - i % 512).div_ceil(512) as f32);
    }
}

#[test]
fn particles_in_runs_and_sorted_give_the_same_bits() {
    // The same order in each of two tiles, one after the other or by turns: a run each, or none.
    let n = 32;
    let region = region_of(n);
    let places: Vec<f64> = random(3 * 1501, 9).iter().map(|x| 7.0 * x).collect();
    let near: Vec<[f64; 4]> =
        places.chunks(3).map(|p| [p[0] + 0.2, p[1] + 0.3, 4.4 * p[2], p[0] - 2.0]).collect();
    let far: Vec<[f64; 4]> = near.iter().map(|p| [p[0] + 16.0, p[1], p[2] - 20.0, p[3]]).collect();
    let runs: Vec<[f64; 4]> = near.iter().chain(&far).copied().collect();
    let turns: Vec<[f64; 4]> = near.iter().zip(&far).flat_map(|(a, b)| [*a, *b]).collect();
    for (window, shift) in choices() {
        let assignment = cells(n, window, shift);
        let [runs, turns] = [&runs, &turns].map(|particles| {
            let triples: Vec<f64> = particles.iter().flat_map(|p| [p[0], p[1], p[2]]).collect();
            let masses: Vec<f64> = particles.iter().map(|p| p[3]).collect();
            let mut bad = masses.clone();
            bad[1700] = f64::INFINITY;
            let refused = put(&region, &triples, Some(&bad), &assignment, &Serial);
            assert_eq!(refused.err(), Some(Error::NotFinite));
            put(&region, &triples, Some(&masses), &assignment, &Serial).unwrap()
        });
        assert!(bits(&runs) == bits(&turns), "{window:?} {shift}");
    }
}

#[test]
fn read_out_in_order_and_sorted_gives_the_same_bits() {
    let n = 32;
    let region = region_of(n);
    let mesh: Vec<f64> = random(n * n * n, 8);
    // By tiles: few changes. Reversed in stretches of one: every particle changes its tile.
    let ordered: Vec<[f64; 3]> =
        (0..4000).map(|i| [f64::from(i) / 125.0, 1.25 + f64::from(i % 7), f64::from(i % 32) + 0.4]).collect();
    let mixed: Vec<[f64; 3]> = (0..4000).map(|i| ordered[i * 1601 % 4000]).collect();
    for (window, shift) in choices() {
        let assignment = cells(n, window, shift);
        let straight = get(&region, &mesh, ordered.as_flattened(), &assignment, &Serial).unwrap();
        let sorted = get(&region, &mesh, mixed.as_flattened(), &assignment, &Serial).unwrap();
        assert!((0..4000).all(|i| sorted[i].to_bits() == straight[i * 1601 % 4000].to_bits()));
    }
}

#[test]
fn translation_by_whole_cells_permutes_the_mesh() {
    let n = 12;
    let region = region_of(n);
    // Multiples of 1/64: exact before and after.
    let triples: Vec<f64> = random(3000, 6).iter().map(|x| (x * 64.0 * 12.0).floor() / 64.0).collect();
    let moved: Vec<f64> =
        triples.iter().enumerate().map(|(i, x)| (x + [5.0, 11.0, 7.0][i % 3]) % 12.0).collect();
    for (window, shift) in choices() {
        let assignment = cells(n, window, shift);
        let here = put(&region, &triples, None, &assignment, &Serial).unwrap();
        let there = put(&region, &moved, None, &assignment, &Serial).unwrap();
        for c in 0..n * n * n {
            let [x, y, z] = [(c / (n * n) + 5) % n, (c / n + 11) % n, (c % n + 7) % n];
            let moved = there[(x * n + y) * n + z];
            // Sums of up to tens of particles a cell, in another order.
            assert!((here[c] - moved).abs() <= 1e-14 * (1.0 + here[c]), "{window:?}");
        }
    }
}

#[test]
fn layouts_hold_the_same_mesh() {
    let n = 10;
    let triples = crowd::<f64>(n);
    for (window, shift) in choices() {
        let assignment = cells(n, window, shift);
        let plain = put(&region_of(n), &triples, None, &assignment, &Serial).unwrap();
        for (start, stride) in [([0; 3], [1, n, n * n]), ([0; 3], [140, 14, 1]), ([3, 9, 4], [2, 240, 24])] {
            let region = Region::new(n, start, [n; 3], stride).unwrap();
            let mesh = put(&region, &triples, None, &assignment, &Serial).unwrap();
            for c in 0..n * n * n {
                let cell = [c / (n * n), c / n % n, c % n];
                let at: usize = (0..3).map(|axis| (cell[axis] + n - start[axis]) % n * stride[axis]).sum();
                assert!((mesh[at] - plain[c]).abs() <= 1e-14 * (1.0 + plain[c]), "{window:?} {stride:?}");
            }
        }
    }
}

/// Bricks that tile the mesh: slabs, thin slabs, pencils.
fn decompositions(n: usize) -> Vec<Vec<Brick>> {
    let brick = |start: [usize; 3], count: [usize; 3]| {
        let stride = [count[1] * (n + 2), n + 2, 1];
        Brick::general(n, Space::Configuration, start, count, stride).unwrap()
    };
    let slabs = |cuts: &[usize]| {
        cuts.windows(2).map(|cut| brick([cut[0], 0, 0], [cut[1] - cut[0], n, n])).collect::<Vec<_>>()
    };
    let mut pencils = Vec::new();
    for x in [[0, 5], [5, n]] {
        for y in [[0, 3], [3, n]] {
            pencils.push(brick([x[0], y[0], 0], [x[1] - x[0], y[1] - y[0], n]));
        }
    }
    let thin: Vec<usize> = (0..=n).collect();
    vec![slabs(&[0, n]), slabs(&[0, 4, n]), slabs(&[0, 2, n - 1, n]), slabs(&thin), pencils]
}

#[test]
fn slabs_and_pencils_with_folded_ghosts_are_the_whole() {
    fn check<T: Real>(tolerance: f64) {
        let n = 12;
        let whole = region_of(n);
        let triples: Vec<T> = random(6000, 9).iter().map(|x| T::from_f64(x * n as f64)).collect();
        for (window, shift) in choices() {
            let assignment = cells(n, window, shift);
            let expect = put(&whole, &triples, None, &assignment, &Serial).unwrap();
            let read = get(&whole, &expect, &triples, &assignment, &Serial).unwrap();
            for bricks in decompositions(n) {
                let mut joined = vec![T::ZERO; whole.reals()];
                let mut owners = 0;
                for brick in &bricks {
                    // Whose a particle is: the cell that holds it.
                    let mine: Vec<usize> = (0..triples.len() / 3)
                        .filter(|&i| {
                            (0..3).all(|axis| {
                                let cell = triples[3 * i + axis].to_f64() as usize;
                                (brick.start()[axis]..brick.start()[axis] + brick.count()[axis])
                                    .contains(&cell)
                            })
                        })
                        .collect();
                    owners += mine.len();
                    let own: Vec<T> = mine.iter().flat_map(|&i| triples[3 * i..3 * i + 3].to_vec()).collect();
                    let ghosted = Region::with_ghosts(brick, window, shift).unwrap();
                    let part = put(&ghosted, &own, None, &assignment, &Serial).unwrap();
                    add_cells(&mut joined, &whole, &part, &ghosted, &Serial).unwrap();
                    // The way back: cells of the region from the whole, then the same values.
                    let mut filled = vec![T::from_f64(f64::NAN); ghosted.reals()];
                    copy_cells(&mut filled, &ghosted, &expect, &whole, &Serial).unwrap();
                    let values = get(&ghosted, &filled, &own, &assignment, &Serial).unwrap();
                    for (&i, value) in mine.iter().zip(&values) {
                        let difference = (value.to_f64() - read[i].to_f64()).abs();
                        assert!(difference <= tolerance * 8.0, "{window:?} {brick:?}");
                    }
                }
                assert_eq!(owners, triples.len() / 3);
                for (a, b) in joined.iter().zip(&expect) {
                    let difference = (a.to_f64() - b.to_f64()).abs();
                    if window == Window::NearestGridPoint {
                        assert_eq!(difference, 0.0, "counts are exact");
                    }
                    assert!(difference <= tolerance * (1.0 + b.to_f64()), "{window:?} {bricks:?}");
                }
            }
        }
    }
    // A few particles a cell, each rounded a few times.
    check::<f64>(16.0 * f64::EPSILON);
    check::<f32>(16.0 * f64::from(f32::EPSILON));
}

#[test]
fn ghosts_are_no_more_than_needed() {
    let n = 16;
    let brick = Brick::slab(n, Space::Configuration, 4, 4).unwrap();
    for (window, shift) in choices() {
        let region = Region::with_ghosts(&brick, window, shift).unwrap();
        assert_eq!(region.count()[1..], [n, n]);
        // Densely: the planes that particles of the slab touch.
        let mut touched = [false; 16];
        for i in 0..4096 {
            let u = 4.0 + f64::from(i) / 1024.0;
            for (plane, touched) in touched.iter_mut().enumerate() {
                *touched |= crate::reference::deposit::weight(window, n, shift, u, plane) > 0.0;
            }
        }
        let planes = region.start()[0]..region.start()[0] + region.count()[0];
        let expect: Vec<bool> = (0..n).map(|plane| planes.contains(&plane)).collect();
        assert_eq!(touched[..], expect[..], "{window:?} {shift}");
    }
}

#[test]
fn a_rank_next_to_the_edge_reaches_round_it() {
    let brick = Brick::slab(8, Space::Configuration, 0, 3).unwrap();
    let region = Region::with_ghosts(&brick, Window::PiecewiseCubicSpline, 0.0).unwrap();
    assert_eq!((region.start(), region.count()), ([7, 0, 0], [6, 8, 8]));
    let closed = Brick::slab(8, Space::Configuration, 0, 6).unwrap();
    let region = Region::with_ghosts(&closed, Window::PiecewiseCubicSpline, 0.0).unwrap();
    assert_eq!((region.start(), region.count()), ([7, 0, 0], [8, 8, 8]), "ghosts meet");
    let empty = Brick::slab(8, Space::Configuration, 8, 0).unwrap();
    assert!(Region::with_ghosts(&empty, Window::CloudInCell, 0.0).unwrap().is_empty());
}

#[test]
fn rounding_at_the_edge_of_a_slab_is_forgiven() {
    let n = 12;
    let brick = Brick::slab(n, Space::Configuration, 4, 4).unwrap();
    for (window, shift) in choices() {
        let assignment = Assignment { box_size: 1.0, window, shift };
        let region = Region::with_ghosts(&brick, window, shift).unwrap();
        for edge in [4.0 / 12.0, 8.0 / 12.0] {
            let edge = edge as f32;
            for x in [edge.next_down().next_down(), edge.next_down(), edge, edge.next_up()] {
                let mesh = put(&region, &[x, 0.2, 0.9], None, &assignment, &Serial).unwrap();
                let mass: f32 = mesh.iter().sum();
                assert!((mass - 1.0).abs() < 1e-5, "{window:?} {shift} {x}");
            }
        }
        for x in [0.1_f32, 0.95, f32::MIN_POSITIVE] {
            let refused = put(&region, &[x, 0.2, 0.9], None, &assignment, &Serial);
            assert_eq!(refused, Err(Error::Outside), "{window:?} {x}");
        }
    }
}

#[test]
fn positions_are_wrapped_whatever_their_size() {
    let n = 8;
    let region = region_of(n);
    for (window, shift) in choices() {
        let assignment = Assignment { box_size: 10.0, window, shift };
        for (far, near) in [
            (-1e-300, 0.0),
            (10.0, 0.0),
            (-10.0, 0.0),
            (1e9 + 2.5, 2.5),
            (-1e9 - 2.5, 7.5),
            (f64::MAX, f64::MAX % 10.0),
            (-f64::MAX, 10.0 - f64::MAX % 10.0),
        ] {
            let there = put(&region, &[far, 1.0, 9.0], None, &assignment, &Serial).unwrap();
            let here = put(&region, &[near, 1.0, 9.0], None, &assignment, &Serial).unwrap();
            assert!(there.iter().zip(&here).all(|(a, b)| (a - b).abs() < 1e-14), "{window:?} {far}");
        }
        let single = put(&region, &[f32::MAX, -f32::MAX, 9.999_999_5], None, &assignment, &Serial).unwrap();
        assert!((single.iter().sum::<f32>() - 1.0).abs() < 1e-6);
    }
}

#[test]
fn what_cannot_be_placed_is_refused() {
    let n = 8;
    let region = region_of(n);
    let good = Assignment { box_size: 1.0, window: Window::CloudInCell, shift: 0.0 };
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        for axis in 0..3 {
            let mut triple = [0.5; 3];
            triple[axis] = bad;
            assert_eq!(put(&region, &triple, None, &good, &Serial), Err(Error::NotFinite));
            assert_eq!(get(&region, &[0.0; 512], &triple, &good, &Serial), Err(Error::NotFinite));
            let small = Region::new(n, [0; 3], [1; 3], [1; 3]).unwrap();
            assert_eq!(put(&small, &[0.5, bad, 0.5], None, &good, &Serial), Err(Error::NotFinite));
        }
        assert_eq!(put(&region, &[0.5; 3], Some(&[bad]), &good, &Serial), Err(Error::NotFinite));
        let box_size = Assignment { box_size: bad, ..good };
        assert_eq!(put(&region, &[0.5; 3], None, &box_size, &Serial), Err(Error::NotFinite));
        let shift = Assignment { shift: bad, ..good };
        assert_eq!(put(&region, &[0.5; 3], None, &shift, &Serial), Err(Error::NotFinite));
    }
    for box_size in [0.0, -1.0, 1e-320] {
        let bad = Assignment { box_size, ..good };
        assert_eq!(put(&region, &[0.5; 3], None, &bad, &Serial), Err(Error::Range), "{box_size}");
    }
    let tiny = Assignment { box_size: 1e-60, ..good };
    assert_eq!(put(&region, &[0.5_f32; 3], None, &tiny, &Serial), Err(Error::Range));
    for shift in [-0.5, 1.0] {
        let bad = Assignment { shift, ..good };
        assert_eq!(put(&region, &[0.5; 3], None, &bad, &Serial), Err(Error::Range));
    }
    assert_eq!(put(&region, &[0.5; 3], Some(&[1.0, 1.0]), &good, &Serial), Err(Error::Length));
    assert_eq!(put(&region, &[], None, &good, &Serial), Ok(vec![0.0; 512]), "nobody is welcome");
    let empty = Region::new(n, [0; 3], [0, 8, 8], [64, 8, 1]).unwrap();
    assert_eq!(put(&empty, &[0.5; 3], None, &good, &Serial), Err(Error::Outside));
    let mut short = [0.0; 511];
    let positions = Positions::triples(&[0.5; 3]).unwrap();
    let mut memory = Memory::new(deposit_scratch::<f64>(&region, 1, good.window).unwrap());
    let length = deposit(&mut short, &region, &positions, None, &good, memory.get(), &Serial);
    assert_eq!(length, Err(Error::Length));
    let scratch = deposit(&mut [0.0; 512], &region, &positions, None, &good, &mut [], &Serial);
    assert_eq!(scratch, Err(Error::Scratch));
    assert_eq!(Region::new(8, [8, 0, 0], [1; 3], [1; 3]), Err(Error::Brick));
    assert_eq!(Region::new(8, [0; 3], [9, 1, 1], [1; 3]), Err(Error::Brick));
    assert_eq!(Region::new(8, [7; 3], [2; 3], [2, 1, 1]), Err(Error::Brick), "two cells on one address");
}

#[test]
fn scratch_does_not_grow_with_particles() {
    let region = region_of(256);
    let most = deposit_scratch::<f32>(&region, 1 << 40, Window::CloudInCell).unwrap();
    let runs = 8 * (sort::BATCH / 8 + 64);
    assert_eq!(
        most.size,
        (16 + 2) * sort::BATCH + runs + 4 * 1024 * 64 + (4 * 1025_usize).next_multiple_of(64)
    );
    assert!(most.size < 39 << 20);
    let few = deposit_scratch::<f64>(&region, 1, Window::CloudInCell).unwrap();
    assert!(few.size < 16 << 10);
}

/// F_k = sum over cells of m exp(-i k.x) of one mode of a mesh.
fn mode(mesh: &[f64], n: usize, k: [i64; 3]) -> [f64; 2] {
    let mut sum = [0.0; 2];
    for (c, m) in mesh.iter().enumerate() {
        let cell = [c / (n * n), c / n % n, c % n];
        let turns: i64 = (0..3).map(|axis| k[axis] * cell[axis] as i64).sum();
        let angle = -core::f64::consts::TAU * turns as f64 / n as f64;
        sum[0] += m * libm::cos(angle);
        sum[1] += m * libm::sin(angle);
    }
    sum
}

#[test]
fn interlacing_removes_odd_images_and_leaves_the_rest() {
    let n = 8;
    let brick = Brick::whole(n, Space::Fourier).unwrap();
    let region = region_of(n);
    for window in [Window::CloudInCell, Window::TriangularShapedCloud] {
        // Weights of a lattice four times finer are a plane wave with n + 1 periods along x, or n - 2 along z and n + 1 along y.
        for (wave, image, odd) in
            [([n as i64 + 1, 1, 0], [1, 1, 0], true), ([1, n as i64 + 2, n as i64 + 3], [1, 2, 3], false)]
        {
            let fine = 4 * n;
            let mut triples = Vec::new();
            let mut w = Vec::new();
            for c in 0..fine * fine * fine {
                let q = [c / (fine * fine), c / fine % fine, c % fine];
                let turns: i64 = (0..3).map(|axis| wave[axis] * q[axis] as i64).sum();
                triples.extend(q.map(|q| q as f64 / 4.0));
                w.push(libm::cos(core::f64::consts::TAU * turns as f64 / fine as f64));
            }
            let spectrum = |shift: f64| {
                let mesh = put(&region, &triples, Some(&w), &cells(n, window, shift), &Serial).unwrap();
                let mut modes = vec![0.0; brick.reals()];
                for x in 0..n {
                    for y in 0..n {
                        for z in 0..=n / 2 {
                            let k = [Brick::mode(n, x), Brick::mode(n, y), z as i64];
                            let at = 2 * ((x * n + y) * (n / 2 + 1) + z);
                            modes[at..at + 2].copy_from_slice(&mode(&mesh, n, k));
                        }
                    }
                }
                modes
            };
            let mut modes = spectrum(0.0);
            let before = modes.clone();
            interlace(&mut modes, &spectrum(0.5), &brick, &Serial).unwrap();
            let at = |k: [usize; 3]| 2 * ((k[0] * n + k[1]) * (n / 2 + 1) + k[2]);
            let image = at(image);
            let norm = w.len() as f64 / 2.0;
            // Two images of a cubic sinc are small.
            assert!(before[image].abs() > 1e-8 * norm, "the image is there");
            if odd {
                assert!(modes[image].abs() < 1e-12 * norm && modes[image + 1].abs() < 1e-12 * norm);
            } else {
                assert!((modes[image] - before[image]).abs() < 1e-12 * norm);
                assert!((modes[image + 1] - before[image + 1]).abs() < 1e-12 * norm);
            }
            // A Nyquist mode keeps half of the first mesh's.
            let nyquist = at([n / 2, 1, 1]);
            assert_eq!(modes[nyquist].to_bits(), (0.5 * before[nyquist]).to_bits());
        }
    }
}

#[test]
fn interlacing_agrees_between_bricks_and_with_its_definition() {
    let n = 144;
    let brick = Brick::general(n, Space::Fourier, [70, 5, 0], [4, 3, 73], [3 * 73, 73, 1]).unwrap();
    let modes: Vec<f64> = random(brick.reals(), 11);
    let shifted: Vec<f64> = random(brick.reals(), 12);
    let mut out = modes.clone();
    interlace(&mut out, &shifted, &brick, &Threads::new(3).unwrap()).unwrap();
    let mut portable = modes.clone();
    interlace_with(Simd::Portable, &mut portable, &shifted, &brick, &Serial).unwrap();
    assert_eq!(bits(&out), bits(&portable));
    for c in 0..4 * 3 * 73 {
        let [x, y, z] = [70 + c / (3 * 73), 5 + c / 73 % 3, c % 73];
        let k = (Brick::mode(n, x) + y as i64 + z as i64) as f64;
        let angle = -core::f64::consts::PI * k / n as f64;
        let nyquist = x == 72 || z == 72;
        let (cosine, sine) = if nyquist { (0.0, 0.0) } else { (libm::cos(angle), libm::sin(angle)) };
        let (re, im) = (shifted[2 * c], shifted[2 * c + 1]);
        let expect = [
            0.5 * (modes[2 * c] + cosine * re - sine * im),
            0.5 * (modes[2 * c + 1] + sine * re + cosine * im),
        ];
        assert!((out[2 * c] - expect[0]).abs() < 1e-14 && (out[2 * c + 1] - expect[1]).abs() < 1e-14);
    }
    // Runs of single modes, z outermost.
    let turned = Brick::general(n, Space::Fourier, [70, 5, 0], [4, 3, 73], [3, 1, 12]).unwrap();
    let turn = |data: &[f64]| {
        let mut turned = vec![0.0; data.len()];
        for c in 0..4 * 3 * 73 {
            let at = 3 * (c / (3 * 73)) + c / 73 % 3 + 12 * (c % 73);
            turned[2 * at..2 * at + 2].copy_from_slice(&data[2 * c..2 * c + 2]);
        }
        turned
    };
    let mut other = turn(&modes);
    interlace(&mut other, &turn(&shifted), &turned, &Serial).unwrap();
    for (a, b) in other.iter().zip(turn(&out)) {
        assert!((a - b).abs() < 1e-15);
    }
}

#[test]
fn columns_with_strides_are_read_and_written_where_they_lie() {
    let n = 8;
    let region = region_of(n);
    let assignment = cells(n, Window::TriangularShapedCloud, 0.0);
    // x y z mass value, as a struct would hold them.
    let mut structs: Vec<[f64; 5]> =
        random(500, 13).chunks(5).map(|c| [c[0] * 8.0, c[1] * 8.0, c[2] * 8.0, c[3], -1.0]).collect();
    let triples: Vec<f64> = structs.iter().flat_map(|s| [s[0], s[1], s[2]]).collect();
    let w: Vec<f64> = structs.iter().map(|s| s[3]).collect();
    let plain = put(&region, &triples, Some(&w), &assignment, &Serial).unwrap();
    let values = get(&region, &plain, &triples, &assignment, &Serial).unwrap();
    let axes = [0, 1, 2].map(|axis| structs.iter().map(|s| s[axis]).collect::<Vec<_>>());
    let separate = Positions::separate([&axes[0], &axes[1], &axes[2]]).unwrap();
    let mut memory = Memory::new(deposit_scratch::<f64>(&region, 100, assignment.window).unwrap());
    let mut mesh = vec![0.0; 512];
    deposit(&mut mesh, &region, &separate, Some(&Column::new(&w)), &assignment, memory.get(), &Serial)
        .unwrap();
    assert_eq!(bits(&mesh), bits(&plain));
    let first = structs.as_mut_ptr().cast::<f64>();
    // SAFETY: members 0 to 3 of the structs are read, member 4 is written, and nothing else touches them meanwhile.
    let (positions, masses, mut out) = unsafe {
        (
            Positions::strided([first, first.add(1), first.add(2)].map(<*mut f64>::cast_const), 5, 100),
            Column::strided(first.add(3).cast_const(), 5, 100),
            ColumnMut::strided(first.add(4), 5, 100),
        )
    };
    mesh.fill(0.0);
    deposit(&mut mesh, &region, &positions, Some(&masses), &assignment, memory.get(), &Serial).unwrap();
    assert_eq!(bits(&mesh), bits(&plain));
    read_out(&mut out, &plain, &region, &positions, &assignment, memory.get(), &Serial).unwrap();
    assert!(structs.iter().zip(&values).all(|(s, v)| s[4].to_bits() == v.to_bits()));
}
