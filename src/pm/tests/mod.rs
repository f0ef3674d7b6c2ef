//! What the tests of deposits share, and deposits against their definition.

mod bits;
mod drifts;
mod evolve;
mod factors;
mod force;
mod hostile;
mod interlacing;
mod kicks;
mod pair_force;
mod pre_initial;
mod regions;
mod scale;
mod third;

use std::vec;
use std::vec::Vec;

use super::deposit::deposit_with;
use super::interlace::interlace_with;
use super::read_out::read_out_with;
use super::window::spline as weights;
use super::*;
use crate::exec::{Exec, Serial, Threads};
use crate::initial::particles::Components;
use crate::mesh::{Brick, Space};
use crate::real::Real;
use crate::reference::built::Memory;
use crate::reference::deposit::{spline, windows};
use crate::simd::Simd;
use crate::status::{Error, Result};

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
    weights::<f64, P>(f)
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
