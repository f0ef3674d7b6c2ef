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

mod f_nl;

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

fn bits_do_not_depend_on_memory<T: Real>() {
    let (n, shells) = (32, 14);
    let edges: Vec<u64> = (0..=shells).map(|s| (s + 1) * (s + 1)).collect();
    let modes = modes::<T>(n, 11);
    let triangles = closed(&edges, Some(&centres(shells as usize)));
    let mut taken = Vec::new();
    let (sums, _) = whole(&triangles, &edges, &modes, n, 14, &Serial).unwrap();
    for meshes in 3..=15 {
        let (other, made) = whole(&triangles, &edges, &modes, n, meshes, &Serial).unwrap();
        assert_eq!(other, sums, "{meshes}");
        taken.push(made);
    }
    assert_eq!(taken[11..], [14, 14], "each shell once");
    // Shells that no triangle names are not transformed.
    let squeezed = [[0, 9, 9], [0, 10, 10], [0, 13, 13]];
    assert_eq!(whole(&squeezed, &edges, &modes, n, 5, &Serial).unwrap().1, 4);
    assert!(whole(&squeezed, &edges, &modes, n, 3, &Serial).unwrap().1 <= 6);
}

#[test]
fn any_number_of_meshes_gives_the_same_bits() {
    bits_do_not_depend_on_memory::<f32>();
    bits_do_not_depend_on_memory::<f64>();
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

fn slabs<T: Real>() {
    let (n, edges) = (24, [1, 5, 12, 30, 61, 100]);
    let mut fft = serial::<T>(n);
    let modes = modes::<T>(n, 5);
    let triangles = closed(&edges, None);
    let (sums, _) = whole(&triangles, &edges, &modes, n, 5, &Serial).unwrap();
    let fields: Vec<Vec<T>> = edges
        .windows(2)
        .map(|edge| {
            let mut field = vec![T::ZERO; fft.length()];
            shell_modes(&mut field, &modes, fft.fourier(), edge[0], edge[1], &Serial).unwrap();
            fft.inverse(&mut field).unwrap();
            // Padding is not read.
            for row in field.chunks_exact_mut(n + 2) {
                row[n..].fill(T::from_f64(f64::NAN));
            }
            field
        })
        .collect();
    let add = |sums: &mut [ExactSum], start: usize, count: usize, exec: &dyn Exec| {
        let slab = Brick::slab(n, Space::Configuration, start, count).unwrap();
        let plane = n * (n + 2);
        let parts: Vec<&[T]> = fields.iter().map(|f| &f[start * plane..(start + count) * plane]).collect();
        let scratch = memory(bispectrum_sums_scratch::<T>(&slab, parts.len(), triangles.len()).unwrap());
        bispectrum_sums(sums, &triangles, &parts, &slab, scratch, exec).unwrap();
    };
    for threads in [1, 2, 5] {
        let pool = Threads::new(threads).unwrap();
        let mut added = vec![ExactSum::ZERO; triangles.len()];
        add(&mut added, 0, n, &pool);
        assert_eq!(added, sums, "{threads} threads");
    }
    let mut added = vec![ExactSum::ZERO; triangles.len()];
    for (start, count) in [(17, 7), (0, 1), (4, 13), (1, 3), (24, 0)] {
        add(&mut added, start, count, &Serial);
    }
    assert_eq!(added, sums, "slabs");
    // The same cells with other strides: z outermost.
    let strides = [n, 1, n * n];
    let turned = Brick::general(n, Space::Configuration, [0; 3], [n; 3], strides).unwrap();
    let moved: Vec<Vec<T>> = fields
        .iter()
        .map(|field| {
            let mut out = vec![T::ZERO; n * n * n];
            for x in 0..n {
                for y in 0..n {
                    for z in 0..n {
                        out[x * n + y + z * n * n] = field[(x * n + y) * (n + 2) + z];
                    }
                }
            }
            out
        })
        .collect();
    let parts: Vec<&[T]> = moved.iter().map(Vec::as_slice).collect();
    let scratch = memory(bispectrum_sums_scratch::<T>(&turned, parts.len(), triangles.len()).unwrap());
    let mut added = vec![ExactSum::ZERO; triangles.len()];
    bispectrum_sums(&mut added, &triangles, &parts, &turned, scratch, &Serial).unwrap();
    assert_eq!(added, sums, "strides");
}

#[test]
fn slabs_threads_and_strides_give_the_same_bits() {
    slabs::<f32>();
    slabs::<f64>();
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

#[test]
fn bad_lists_are_refused() {
    let edges = [1, 4, 9, 16];
    let mut triangles = [[0; 3]; 2];
    for (edges, centres, error) in [
        (&[1_u64][..], None, Error::Table),
        (&[1, 1], None, Error::Table),
        (&[4, 1], None, Error::Table),
        (&edges, Some(&[1.0, 2.0][..]), Error::Length),
        (&edges, Some(&[1.0, 1.0, 2.0]), Error::Table),
        (&edges, Some(&[-1.0, 1.0, 2.0]), Error::Table),
        (&edges, Some(&[1.0, f64::NAN, 2.0]), Error::NotFinite),
        (&edges, None, Error::Length),
    ] {
        assert_eq!(closed_triangles(&mut triangles, edges, centres), Err(error));
    }
    assert_eq!(squeezed_triangles(&mut triangles, 3, 3), Err(Error::Range));
    assert_eq!(squeezed_triangles(&mut triangles, 0, 3), Err(Error::Length));

    let counting = |triangles: &[Triangle], edges: &[u64], n| counts(triangles, edges, n, &Serial);
    assert_eq!(counting(&[[0, 1, 3]], &edges, 8), Err(Error::Range), "no such shell");
    assert_eq!(counting(&[[0, 1, 2]], &[1, 4, 9, 17], 8), Err(Error::Range), "beyond n/2");
    assert_eq!(counting(&[[0, 0, 0]], &[2, 1], 8), Err(Error::Table));
    assert_eq!(counting(&[[0, 0, 0]], &edges, 9), Err(Error::MeshSize));
    let scratch = memory(triangle_counts_scratch(&edges, 8, &[[0; 3]]).unwrap());
    assert_eq!(triangle_counts(&mut [0; 2], &[[0; 3]], &edges, 8, scratch, &Serial), Err(Error::Length));
    assert_eq!(
        triangle_counts(&mut [0], &[[0; 3]], &edges, 8, &mut scratch[64..], &Serial),
        Err(Error::Scratch)
    );

    let n = 8;
    let data = modes::<f64>(n, 1);
    let summing = |triangles: &[Triangle], edges: &[u64], meshes| {
        whole(triangles, edges, &data, n, meshes, &Serial).map(|_| ())
    };
    assert_eq!(summing(&[[0, 1, 3]], &edges, 3), Err(Error::Range));
    assert_eq!(summing(&[[0, 1, 2]], &edges, 2), Err(Error::Length));
    assert_eq!(summing(&[[0, 1, 2]], &[1, 4, 9, 20], 3), Err(Error::Range));
    let mut brick = Brick::whole(n, Space::Fourier).unwrap();
    let mut out = data.clone();
    assert_eq!(shell_modes(&mut out[1..], &data, &brick, 1, 4, &Serial), Err(Error::Length));
    assert_eq!(shell_modes(&mut out, &data, &brick, 4, 4, &Serial), Err(Error::Table));
    assert_eq!(shell_modes(&mut out, &data, &brick, 4, 17, &Serial), Err(Error::Range));
    assert_eq!(out, data);
    brick = Brick::whole(n, Space::Configuration).unwrap();
    assert_eq!(shell_modes(&mut out, &data, &brick, 1, 4, &Serial), Err(Error::Brick));

    let scratch = memory(bispectrum_sums_scratch::<f64>(&brick, 2, 1).unwrap());
    let mut sums = [ExactSum::ZERO];
    let mut add = |triangle: Triangle, fields: &[&[f64]], scratch: &mut [u8]| {
        bispectrum_sums(&mut sums, &[triangle], fields, &brick, scratch, &Serial)
    };
    assert_eq!(add([0, 0, 2], &[&data, &data], scratch), Err(Error::Range));
    assert_eq!(add([0, 0, 1], &[&data, &data[..9]], scratch), Err(Error::Length));
    assert_eq!(add([0, 0, 1], &[&data, &data], &mut scratch[64..]), Err(Error::Scratch));
    assert_eq!(add([0, 0, 0], &[&data, &[]], scratch), Ok(()), "a field that nobody asks for");
}

#[test]
fn what_is_not_finite_is_never_silent() {
    let n = 8;
    let brick = Brick::whole(n, Space::Configuration).unwrap();
    let scratch = memory(bispectrum_sums_scratch::<f32>(&brick, 2, 2).unwrap());
    let good = vec![1.0_f32; brick.reals()];
    for (bad, error) in
        [(f32::NAN, Error::NotFinite), (f32::INFINITY, Error::NotFinite), (1e30, Error::NotFinite)]
    {
        let mut field = good.clone();
        field[(7 * n + 3) * (n + 2) + 5] = bad;
        let mut sums = [ExactSum::ZERO; 2];
        let list = [[0, 0, 0], [1, 1, 0]];
        let added = bispectrum_sums(&mut sums, &list, &[&good, &field], &brick, scratch, &Serial);
        assert_eq!(added, Err(error), "{bad}");
        assert_eq!(sums, [ExactSum::ZERO; 2], "untouched");
    }
    let mut bad = modes::<f64>(n, 1);
    bad[2 * (n / 2 + 1)] = f64::NAN;
    assert_eq!(whole(&[[0, 1, 1]], &[1, 4, 9], &bad, n, 3, &Serial).err(), Some(Error::NotFinite));
    let mut lost = ExactSum::ZERO;
    lost.add(f64::NAN);
    let mut values = [1.0];
    assert_eq!(bispectrum_values(&mut values, &[lost]), Err(Error::NotFinite));
    assert_eq!(bispectrum_values(&mut values, &[]), Err(Error::Length));
    assert_eq!(values, [1.0]);
}

fn paths_agree<T: Real>() {
    let (shells, length) = (9, 64);
    let triangles = closed(&nearest(1.0, shells), Some(&centres(shells)));
    let mut order: Vec<u32> = (0..triangles.len() as u32).collect();
    let (layout, count) = (Layout::EMPTY.and::<Block>(triangles.len()).unwrap(), triangles.len());
    let mut arena = Arena::new(memory(layout), layout).unwrap();
    let mut slots = vec![0; count];
    let plan = plan(arena.take(count).unwrap(), &mut slots, &mut order, &triangles);
    let fields: Vec<T> = (0..shells * length).map(|i| T::from_f64(libm::sin(i as f64 * 1.7) / 3.0)).collect();
    let tile = Tile { outer: &fields, middle: &fields, apart: length, start: 0, length };
    let sums = |simd: Simd| {
        let mut sums = vec![T::ZERO; plan.sums * lanes::<T>()];
        simd.vectorise(
            #[inline(always)]
            || add_tile(&mut sums, 0, plan.blocks, &tile),
        );
        sums
    };
    let portable = sums(Simd::Portable);
    assert_eq!(portable, sums(Simd::detect()));
    for (&t, &slot) in order.iter().zip(plan.slots) {
        let lanes = lanes::<T>();
        for lane in 0..lanes {
            let field = |s: u32, cell: usize| fields[s as usize * length + cell];
            let [i, j, k] = triangles[t as usize];
            let cells = (lane..length).step_by(lanes);
            let sum = cells.fold(T::ZERO, |sum, x| sum + field(i, x) * field(j, x) * field(k, x));
            assert_eq!(portable[slot as usize * lanes + lane], sum, "{i} {j} {k}");
        }
    }
}

#[test]
fn portable_and_avx2_products_are_the_same_bits() {
    paths_agree::<f32>();
    paths_agree::<f64>();
}
