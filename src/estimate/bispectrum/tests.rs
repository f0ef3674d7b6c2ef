use std::vec;
use std::vec::Vec;

use super::*;
use crate::estimate::exact::ExactSum;
use crate::exec::{Exec, Serial, Threads};
use crate::fft::Fft3;
use crate::mesh::{Brick, Space};
use crate::noise::{Realisation, white_modes};
use crate::real::Real;
use crate::reference::bispectrum as slow;
use crate::reference::built::{memory, serial};
use crate::status::{Error, Result};

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

/// Triangles of modes 1, 2, 3 ... counted from 1.
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
