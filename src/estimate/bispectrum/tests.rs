//! Bispectra against their definition, and what their tests share.

use std::vec;
use std::vec::Vec;

use super::plan::{Block, plan};
use super::products::{Tile, add_tile, lanes};
use super::*;
use crate::estimate::exact::ExactSum;
use crate::exec::{Exec, Serial, Threads};
use crate::fft::Fft3;
use crate::mesh::{Brick, Space};
use crate::noise::{Realisation, white_modes};
use crate::real::Real;
use crate::reference::bispectrum as slow;
use crate::reference::built::{memory, serial};
use crate::scratch::{Arena, Layout};
use crate::simd::Simd;
use crate::status::{Error, Result};

mod bits;
mod f_nl;
mod refusals;

/// Edges of shells of `width` whose nearest multiple of it is 1, 2, 3 ...
fn nearest(width: f64, shells: usize) -> Vec<u64> {
    (0..=shells).map(|s| ((s as f64 + 0.5) * width).powi(2).ceil() as u64).collect()
}

fn centres(shells: usize) -> Vec<f64> {
    (1..=shells).map(|s| s as f64).collect()
}

fn closed(edges: &[u64], centres: Option<&[f64]>) -> Vec<Triangle> {
    let mut triangles = vec![[0; 3]; closed_triangle_count(edges, centres).unwrap()];
    closed_triangles(&mut triangles, edges, centres).unwrap();
    triangles
}

fn counts(triangles: &[Triangle], edges: &[u64], n: usize, exec: &dyn Exec) -> Result<Vec<u64>> {
    let mut counts = vec![0; triangles.len()];
    let scratch = memory(triangle_counts_scratch(edges, n, triangles)?);
    triangle_counts(&mut counts, triangles, edges, n, scratch, exec)?;
    Ok(counts)
}

fn modes<T: Real>(n: usize, seed: u64) -> Vec<T> {
    let brick = Brick::whole(n, Space::Fourier).unwrap();
    let mut modes = vec![T::ZERO; brick.reals()];
    white_modes(&mut modes, &brick, &Realisation::new(seed), &Serial).unwrap();
    modes
}

fn whole<T: Real>(
    triangles: &[Triangle],
    edges: &[u64],
    modes: &[T],
    n: usize,
    meshes: usize,
    exec: &dyn Exec,
) -> Result<(Vec<ExactSum>, usize)> {
    let mut fft = serial::<T>(n);
    let mut sums = vec![ExactSum::ZERO; triangles.len()];
    let mut fields = vec![T::from_f64(f64::NAN); bispectrum_meshes(&fft, meshes)?];
    let scratch = memory(bispectrum_scratch(&fft, edges.len() - 1, triangles.len())?);
    let made = bispectrum(&mut sums, triangles, edges, modes, &mut fft, &mut fields, scratch, exec)?;
    Ok((sums, made))
}

fn values(sums: &[ExactSum]) -> Vec<f64> {
    let mut values = vec![0.0; sums.len()];
    bispectrum_values(&mut values, sums).unwrap();
    values
}

/// Shells counted from 1: (1, 1, 1), (2, 1, 1), (2, 2, 1), (2, 2, 2).
#[test]
fn counts_of_shells_of_three_are_the_published_ones() {
    let edges = nearest(3.0, 3);
    for (shell, count) in [370, 1402, 3154].into_iter().enumerate() {
        assert_eq!(slow::shell(64, edges[shell], edges[shell + 1]).len(), count);
    }
    let triangles = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [1, 1, 1]];
    for n in [32, 64, 360] {
        assert_eq!(counts(&triangles, &edges, n, &Serial).unwrap(), [54066, 71166, 225_724, 470_232], "{n}");
    }
}

#[test]
fn forty_shells_close_6350_triangles() {
    let edges = nearest(3.0, 40);
    let by_centres = closed(&edges, Some(&centres(40)));
    assert_eq!(by_centres.len(), 6350);
    assert!(by_centres.iter().all(|&[i, j, k]| i <= j && j <= k && k <= i + j + 1 && k < 40));
    assert!(by_centres.is_sorted());
    let by_edges = closed(&edges, None);
    assert!(by_centres.iter().all(|triangle| by_edges.binary_search(triangle).is_ok()));
}

#[test]
fn counts_are_those_of_a_loop_over_modes_even_where_triples_wrap() {
    for (n, edges) in [
        (12, vec![1, 4, 9, 16, 30, 36]),
        (16, vec![0, 1, 5, 22, 64]),
        (14, nearest(1.5, 3)),
        (8, vec![3, 16]),
    ] {
        let shells: Vec<_> = edges.windows(2).map(|e| slow::shell(n, e[0], e[1])).collect();
        let triangles = closed(&edges, None);
        let data = vec![0.0; n * n * (n + 2)];
        let expected: Vec<u64> = triangles
            .iter()
            .map(|t| slow::triples(&data, n, t.map(|s| shells[s as usize].as_slice())).0)
            .collect();
        assert_eq!(counts(&triangles, &edges, n, &Serial).unwrap(), expected, "{n}");
        assert_eq!(counts(&triangles, &edges, n, &Threads::new(3).unwrap()).unwrap(), expected);
    }
}

fn agrees_with_modes<T: Real>(tolerance: f64) {
    for n in [8, 12, 16] {
        let half = n as u64 / 2;
        let edges = [1, 3, 7, half * half];
        let modes = modes::<T>(n, 7);
        let exact: Vec<f64> = modes.iter().map(|x| x.to_f64()).collect();
        let shells: Vec<_> = edges.windows(2).map(|e| slow::shell(n, e[0], e[1])).collect();
        let triangles = closed(&edges, None);
        let (sums, made) = whole(&triangles, &edges, &modes, n, 3, &Serial).unwrap();
        assert_eq!(made, 3);
        let cells = (n * n * n) as f64;
        for (value, t) in values(&sums).iter().zip(&triangles) {
            let shells = t.map(|s| shells[s as usize].as_slice());
            let (count, sum) = slow::triples(&exact, n, shells);
            let scale = shells.iter().map(|s| (s.len() as f64).sqrt()).product::<f64>() + count as f64;
            assert!((value / cells - sum).abs() < tolerance * scale, "{n} {t:?}: {} {sum}", value / cells);
        }
    }
}

#[test]
fn sums_are_those_of_a_loop_over_modes() {
    // Rounding of transforms and products against the product of the fields' r.m.s.: a few ulps.
    agrees_with_modes::<f64>(1e-14);
    agrees_with_modes::<f32>(3e-6);
}

/// Every triangle in every order of its shells, the list itself turned round, and one twice.
#[test]
fn triangles_come_in_any_order() {
    let (n, edges) = (16, [1, 4, 8, 14, 21, 30]);
    let modes = modes::<f32>(n, 3);
    let triangles = closed(&edges, None);
    let (sums, _) = whole(&triangles, &edges, &modes, n, 5, &Serial).unwrap();
    let exact = counts(&triangles, &edges, n, &Serial).unwrap();
    let shuffled: Vec<Triangle> =
        triangles.iter().rev().flat_map(|&[i, j, k]| [[k, i, j], [j, i, k], [k, j, i], [i, j, k]]).collect();
    let (other, _) = whole(&shuffled, &edges, &modes, n, 5, &Serial).unwrap();
    let other_counts = counts(&shuffled, &edges, n, &Serial).unwrap();
    for (t, (sum, count)) in other.iter().zip(&other_counts).enumerate() {
        let original = triangles.len() - 1 - t / 4;
        assert_eq!(sum, &sums[original]);
        assert_eq!(count, &exact[original]);
    }
    let one = [triangles[7]];
    assert_eq!(whole(&one, &edges, &modes, n, 3, &Serial).unwrap().0, sums[7..8]);
    assert!(whole(&[], &edges, &modes, n, 3, &Serial).unwrap().0.is_empty());
}

/// The transforms that the documentation names.
#[test]
fn forty_shells_take_the_stated_transforms() {
    assert_eq!([40, 20, 10, 3].map(transforms), [40, 116, 408, 5474]);
}

/// Transforms of all triangles of 40 shells, on a transform that only counts them.
fn transforms(meshes: usize) -> usize {
    struct Counting(Brick, Brick);
    impl Fft3<f32> for Counting {
        fn configuration(&self) -> &Brick {
            &self.0
        }
        fn fourier(&self) -> &Brick {
            &self.1
        }
        fn length(&self) -> usize {
            1
        }
        fn forward(&mut self, _: &mut [f32]) -> Result<()> {
            Ok(())
        }
        fn inverse(&mut self, _: &mut [f32]) -> Result<()> {
            Ok(())
        }
    }
    // A process that holds no part of the mesh.
    let cells = Brick::slab(248, Space::Configuration, 0, 0).unwrap();
    let mut fft = Counting(cells, Brick::slab(248, Space::Fourier, 0, 0).unwrap());
    let edges = nearest(3.0, 40);
    let triangles = closed(&edges, Some(&centres(40)));
    let mut sums = vec![ExactSum::ZERO; triangles.len()];
    let scratch = memory(bispectrum_scratch(&fft, 40, triangles.len()).unwrap());
    let mut fields = vec![0.0; bispectrum_meshes(&fft, meshes).unwrap()];
    bispectrum(&mut sums, &triangles, &edges, &[], &mut fft, &mut fields, scratch, &Serial).unwrap()
}

#[test]
fn shells_part_the_modes_in_every_layout() {
    let n = 12;
    let whole = Brick::whole(n, Space::Fourier).unwrap();
    let modes = modes::<f64>(n, 2);
    let edges = [0, 1, 6, 17, 36];
    let mut added = vec![0.0; modes.len()];
    for edge in edges.windows(2) {
        let mut shell = vec![f64::NAN; modes.len()];
        shell_modes(&mut shell, &modes, &whole, edge[0], edge[1], &Serial).unwrap();
        added.iter_mut().zip(&shell).for_each(|(a, s)| *a += s);
        let transposed = Brick::transposed_slab(n, 3, 5).unwrap();
        let at = |x: usize, y: usize, z: usize| 2 * ((x * n + y) * (n / 2 + 1) + z);
        let turn = |from: &[f64]| {
            let mut out = vec![0.0; transposed.reals()];
            for y in 0..5 {
                for x in 0..n {
                    let row = 2 * (y * n + x) * (n / 2 + 1);
                    out[row..row + n + 2].copy_from_slice(&from[at(x, y + 3, 0)..][..n + 2]);
                }
            }
            out
        };
        let mut part = vec![f64::NAN; transposed.reals()];
        shell_modes(&mut part, &turn(&modes), &transposed, edge[0], edge[1], &Serial).unwrap();
        assert_eq!(part, turn(&shell));
    }
    for m in slow::shell(n, 0, 36).iter().filter(|m| m[2] >= 0) {
        let index = |a: i64| a.rem_euclid(n as i64) as usize;
        let place = 2 * ((index(m[0]) * n + index(m[1])) * (n / 2 + 1) + m[2] as usize);
        assert_eq!(added[place..place + 2], modes[place..place + 2]);
        added[place..place + 2].fill(0.0);
    }
    assert!(added.iter().all(|&x| x == 0.0), "nothing beyond the shells");
}

#[test]
fn a_squeezed_slice_is_part_of_all_triangles() {
    let (n, shells) = (32, 9);
    let edges: Vec<u64> = (1..=shells + 1).map(|s| s * s).collect();
    let mut squeezed = vec![[0; 3]; 8];
    squeezed_triangles(&mut squeezed, 1, 9).unwrap();
    assert_eq!(squeezed[0], [1, 1, 1]);
    assert_eq!(squeezed[7], [1, 8, 8]);
    let modes = modes::<f64>(n, 1);
    let all = closed(&edges, None);
    let (sums, _) = whole(&all, &edges, &modes, n, 9, &Serial).unwrap();
    let (slice, _) = whole(&squeezed, &edges, &modes, n, 4, &Serial).unwrap();
    for (triangle, sum) in squeezed.iter().zip(&slice) {
        assert_eq!(sum, &sums[all.binary_search(triangle).unwrap()]);
    }
}

/// Two plane waves and the one that closes them: every step from sums to B and Q by hand.
#[test]
fn values_become_spectra() {
    let values = [54.0, -8.0, 3.0];
    let mut b = values;
    normalise(&mut b, &[2, 4, 0], 4, 10.0, 0.5).unwrap();
    // V^2 (1/2)^3/4^3 value/count.
    assert_eq!(b, [1e6 / 512.0 * 27.0, -1e6 / 512.0 * 2.0, 0.0]);
    let triangles = [[0, 0, 1], [1, 0, 2], [2, 2, 2]];
    let power = [3.0, 5.0, 0.0];
    let mut noise = [0.0; 3];
    shot_noise(&mut noise, &triangles, &power, 0.5).unwrap();
    assert_eq!(noise, [5.75, 4.25, 0.25]);
    let mut q = [0.0; 3];
    reduced(&mut q, &[39.0, 30.0, 7.0], &triangles, &power).unwrap();
    assert_eq!(q, [1.0, 2.0, 0.0]);
    assert_eq!(shot_noise(&mut noise, &triangles, &power[..2], 0.5), Err(Error::Range));
    assert_eq!(shot_noise(&mut noise, &triangles, &power, f64::NAN), Err(Error::NotFinite));
    assert_eq!(reduced(&mut q, &[f64::NAN; 3], &triangles, &power), Err(Error::NotFinite));
    assert_eq!(reduced(&mut q, &[1.0; 2], &triangles, &power), Err(Error::Length));
    assert_eq!(reduced(&mut q, &[1e308; 3], &triangles, &[1e-10; 3]), Err(Error::Range));
    for (box_size, scale, error) in [
        (0.0, 1.0, Error::Range),
        (-1.0, 1.0, Error::Range),
        (f64::INFINITY, 1.0, Error::NotFinite),
        (1.0, f64::NAN, Error::NotFinite),
        (1e60, 1.0, Error::Range),
    ] {
        let mut b = values;
        assert_eq!(normalise(&mut b, &[1; 3], 4, box_size, scale), Err(error));
        assert_eq!(b, values);
    }
    assert_eq!(normalise(&mut b, &[1; 3], 0, 1.0, 1.0), Err(Error::MeshSize));
    assert_eq!(normalise(&mut b, &[1; 2], 4, 1.0, 1.0), Err(Error::Length));
}
