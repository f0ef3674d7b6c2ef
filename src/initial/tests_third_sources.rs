//! Claims about the sources of the second and third order: exact products, symmetries, the same bits.

use std::sync::Mutex;
use std::vec;
use std::vec::Vec;

use super::lpt::second_order_source;
use super::shifted::{HalfCells, half_cells_length, tidal_tensor};
use super::tests::jumble;
use super::tests_third::{modes_of, sources_by};
use super::third::{third_order_sources, transverse_displacement};
use crate::exec::{Serial, Threads};
use crate::fft::Fft3;
use crate::mesh::{Brick, Space};
use crate::reference::built::serial;
use crate::reference::convolution::Dense;
use crate::reference::parts::{gather, scatter, together};
use crate::status::Error;

const N: usize = 8;

/// Names of the fields, for messages.
const NAMES: [&str; 6] = ["S", "A", "B", "C_x", "C_y", "C_z"];

fn exact(density: &[f64]) -> [Dense; 6] {
    sources_by(density, &mut serial::<f64>(N), &Serial).map(|source| Dense::from_mesh(&source, N))
}

/// n_a n_b/|n|^2 of a field.
fn tidal(field: &Dense, a: usize, b: usize) -> Dense {
    field.map(move |k| {
        let square = k.iter().map(|k| k * k).sum::<f64>();
        if square == 0.0 { 0.0 } else { k[a] * k[b] / square }
    })
}

/// All six sources as sums over modes.
fn convolved(density: &[f64]) -> [Dense; 6] {
    let delta = Dense::from_mesh(density, N);
    let half = delta.half;
    let p = |a, b| tidal(&delta, a, b);
    let sum = |terms: Vec<(f64, Dense)>, half| {
        terms.iter().fold(Dense::zero(half), |sum, (sign, term)| sum.plus(*sign, term))
    };
    // First minors p_aa p_bb - p_ab^2 and the like, with all their modes.
    let minor = |[a, b]: [usize; 2], [c, d]: [usize; 2]| {
        sum(
            vec![(1.0, p(a, c).times(&p(b, d), 2 * half)), (-1.0, p(a, d).times(&p(b, c), 2 * half))],
            2 * half,
        )
    };
    let second = [[0, 1], [0, 2], [1, 2]].map(|ab| (1.0, minor(ab, ab)));
    let second = sum(second.to_vec(), half);
    let determinant = sum(
        vec![
            (1.0, minor([1, 2], [1, 2]).times(&p(0, 0), half)),
            (-1.0, minor([1, 2], [0, 2]).times(&p(0, 1), half)),
            (1.0, minor([1, 2], [0, 1]).times(&p(0, 2), half)),
        ],
        half,
    );
    let q = |a, b| tidal(&second, a, b);
    let contracted = (0..9).map(|i| (-1.0, p(i / 3, i % 3).times(&q(i / 3, i % 3), half)));
    let mixed = sum(core::iter::once((1.0, delta.times(&second, half))).chain(contracted).collect(), half);
    let curl = |i: usize| {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        let terms = (0..3)
            .flat_map(|l| [(1.0, p(l, j).times(&q(l, k), half)), (-1.0, p(l, k).times(&q(l, j), half))]);
        sum(terms.collect(), half)
    };
    let curls = [0, 1, 2].map(curl);
    let [x, y, z] = curls;
    [second, determinant, mixed, x, y, z]
}

fn field() -> Vec<f64> {
    jumble(N, 21)
}

#[test]
fn all_sources_equal_the_direct_convolutions() {
    let density = field();
    let found = exact(&density);
    for ((name, expected), found) in NAMES.iter().zip(convolved(&density)).zip(&found) {
        // Eight transforms of 512 cells, and products of up to three fields of order one.
        assert!(expected.distance(found) < 1e-13, "{name}: {}", expected.distance(found));
    }
}

#[test]
fn one_mesh_alone_aliases() {
    let density = field();
    let found = exact(&density);
    let mut fft = serial::<f64>(N);
    let modes = *fft.fourier();
    let mut table = vec![[0.0; 2]; half_cells_length(N)];
    let half_cells = HalfCells::new(&mut table, N).unwrap();
    let mut p: [Vec<f64>; 6] = core::array::from_fn(|_| vec![0.0; fft.length()]);
    let tensor = p.each_mut().map(Vec::as_mut_slice);
    tidal_tensor(tensor, &density, &modes, 0, half_cells, &Serial).unwrap();
    p.iter_mut().for_each(|p| fft.inverse(p).unwrap());
    let mut determinant = vec![0.0; fft.length()];
    for (i, out) in determinant.iter_mut().enumerate() {
        let [xx, yy, zz, xy, xz, yz] = p.each_ref().map(|p| p[i]);
        let cube = xx * (yy * zz - yz * yz) - xy * (xy * zz - xz * yz) + xz * (xy * yz - yy * xz);
        *out = cube / (N * N * N) as f64;
    }
    fft.forward(&mut determinant).unwrap();
    let aliased = Dense::from_mesh(&determinant, N);
    assert!(found[1].distance(&aliased) > 0.1, "{}", found[1].distance(&aliased));
}

#[test]
fn second_order_equals_that_of_a_larger_mesh() {
    let density = field();
    let brick = Brick::whole(N, Space::Fourier).unwrap();
    let mut work = serial::<f64>(12);
    let mut meshes: [Vec<f64>; 3] = core::array::from_fn(|_| vec![0.0; work.length()]);
    let mut source = vec![0.0; brick.reals()];
    let three = meshes.each_mut().map(Vec::as_mut_slice);
    second_order_source(&mut source, &density, &brick, &mut work, three, &Serial).unwrap();
    let distance = Dense::from_mesh(&source, N).distance(&exact(&density)[0]);
    assert!(distance < 1e-13, "{distance}");
}

#[test]
fn single_precision_follows_double() {
    let density = field();
    let single: Vec<f32> = density.iter().map(|&x| x as f32).collect();
    let singles = sources_by(&single, &mut serial::<f32>(N), &Serial);
    for ((name, single), double) in NAMES.iter().zip(singles).zip(exact(&density)) {
        let single: Vec<f64> = single.iter().map(|&x| f64::from(x)).collect();
        let distance = double.distance(&Dense::from_mesh(&single, N));
        // A few roundings of 6e-8 for each of the products, and of the transforms.
        assert!(distance < 2e-6, "{name}: {distance}");
    }
}

#[test]
fn the_bits_do_not_depend_on_threads() {
    let density = field();
    let one = sources_by(&density, &mut serial::<f64>(N), &Serial);
    for threads in [1, 2, 5] {
        let many = sources_by(&density, &mut serial::<f64>(N), &Threads::new(threads).unwrap());
        assert_eq!(one, many, "{threads}");
    }
}

#[test]
fn processes_with_slabs_have_the_bits_of_one() {
    let density = field();
    let modes = Brick::whole(N, Space::Fourier).unwrap();
    let whole = sources_by(&density, &mut serial::<f64>(N), &Serial);
    let gathered = Mutex::new([0; 6].map(|_| vec![0.0; modes.reals()]));
    // The third process holds nothing.
    together::<f64>(N, &[(0, 5), (5, 3), (8, 0)], &|process| {
        let mut local = vec![0.0; process.length()];
        scatter(process.fourier(), &mut local, &density);
        let brick = *process.fourier();
        let sources = sources_by(&local, process, &Serial);
        for (source, whole) in sources.iter().zip(gathered.lock().unwrap().iter_mut()) {
            gather(&brick, source, whole);
        }
    });
    for (name, (whole, parts)) in NAMES.iter().zip(whole.iter().zip(&*gathered.lock().unwrap())) {
        assert_eq!(whole[..modes.reals()], parts[..], "{name}");
    }
}

/// Modes of a field turned so that mode n of the result is mode turn(n) of the field.
fn turned(field: &Dense, turn: impl Fn([i64; 3]) -> [i64; 3]) -> Dense {
    Dense::from_modes(field.half, |mode| field.at(turn(mode)))
}

#[test]
fn turning_the_axes_turns_the_sources() {
    let density = Dense::from_mesh(&field(), N);
    let turn = |[i, j, l]: [i64; 3]| [j, l, i];
    let [s, a, b, curls @ ..] = exact(&field());
    let found = exact(&turned(&density, turn).to_mesh(N));
    // What was the x axis is now the y axis.
    let expected = [&s, &a, &b, &curls[2], &curls[0], &curls[1]].map(|field| turned(field, turn));
    for ((name, expected), found) in NAMES.iter().zip(&expected).zip(&found) {
        assert!(expected.distance(found) < 1e-13, "{name}: {}", expected.distance(found));
    }
}

#[test]
fn a_mirror_mirrors_the_sources_and_keeps_the_curl_axial() {
    let density = Dense::from_mesh(&field(), N);
    let mirror = |[i, j, l]: [i64; 3]| [-i, j, l];
    let original = exact(&field());
    let found = exact(&turned(&density, mirror).to_mesh(N));
    for (i, sign) in [1.0, 1.0, 1.0, 1.0, -1.0, -1.0].into_iter().enumerate() {
        let expected = turned(&original[i], mirror).map(|_| sign);
        assert!(expected.distance(&found[i]) < 1e-13, "{}", NAMES[i]);
    }
    let minus = exact(&density.map(|_| -1.0).to_mesh(N));
    for (i, sign) in [1.0, -1.0, -1.0, -1.0, -1.0, -1.0].into_iter().enumerate() {
        assert!(original[i].map(|_| sign).distance(&minus[i]) < 1e-15, "orders two and three: {}", NAMES[i]);
    }
}

#[test]
fn the_transverse_source_has_no_divergence() {
    let [.., x, y, z] = exact(&field());
    let size =
        [&x, &y, &z].iter().flat_map(|c| c.values.iter().flatten()).fold(0.0_f64, |m, v| m.max(v.abs()));
    for mode in Dense::modes(x.half) {
        let values = [x.at(mode), y.at(mode), z.at(mode)];
        for part in 0..2 {
            let divergence: f64 = (0..3).map(|axis| mode[axis] as f64 * values[axis][part]).sum();
            assert!(divergence.abs() < 1e-13 * size, "{mode:?}: {divergence}");
        }
    }
}

#[test]
fn a_plane_wave_has_no_higher_orders() {
    // p_ab p_cd - p_ac p_bd vanishes where p_ab = n_a n_b cos: what is left is rounding of products.
    let density = modes_of(N, |[x, y, z]| (x - 2.0 * y + z).cos());
    for (name, source) in NAMES.iter().zip(sources_by(&density, &mut serial::<f64>(N), &Serial)) {
        assert!(source.iter().all(|x| x.abs() < 1e-16), "{name}");
    }
}

#[test]
fn nyquist_modes_of_sources_are_zero() {
    let sources = sources_by(&field(), &mut serial::<f64>(N), &Serial);
    let nyquist = N / 2;
    for (name, source) in NAMES.iter().zip(sources) {
        for at in 0..N * N * (nyquist + 1) {
            let index = [at / ((nyquist + 1) * N), at / (nyquist + 1) % N, at % (nyquist + 1)];
            if index.contains(&nyquist) {
                assert_eq!(source[2 * at..2 * at + 2], [0.0; 2], "{name} {index:?}");
            }
        }
    }
}

#[test]
fn short_arrays_and_senseless_numbers_are_refused() {
    let mut fft = serial::<f64>(N);
    let length = fft.length();
    let mut table = vec![[0.0; 2]; half_cells_length(N)];
    let (good, short) = (vec![1.0; length], vec![1.0; length / 2]);
    let mut out: [Vec<f64>; 5] = core::array::from_fn(|_| vec![0.0; length]);
    let mut attempt = |density: &[f64], second: &[f64], mesh: usize, entries: usize| {
        let mut meshes: [Vec<f64>; 12] = core::array::from_fn(|_| vec![0.0; mesh]);
        let meshes = meshes.each_mut().map(Vec::as_mut_slice);
        let out = out.each_mut().map(Vec::as_mut_slice);
        third_order_sources(out, density, second, &mut fft, meshes, &mut table[..entries], &Serial)
    };
    let entries = half_cells_length(N);
    assert_eq!(attempt(&good, &good, length - 1, entries), Err(Error::Length));
    assert_eq!(attempt(&short, &good, length, entries), Err(Error::Length));
    assert_eq!(attempt(&good, &short, length, entries), Err(Error::Length));
    assert_eq!(attempt(&good, &good, length, entries - 1), Err(Error::Length));
    assert_eq!(attempt(&good, &good, length, entries), Ok(()));

    let mut psi = vec![0.0; length];
    let mut transverse = |curl: [&[f64]; 3], axis, scale, length: usize| {
        transverse_displacement(&mut psi[..length], curl, axis, scale, &mut fft, &Serial)
    };
    let curl = [&good[..]; 3];
    assert_eq!(transverse(curl, 3, 1.0, length), Err(Error::Range));
    assert_eq!(transverse(curl, 0, f64::NAN, length), Err(Error::NotFinite));
    assert_eq!(transverse(curl, 0, 1.0, length - 1), Err(Error::Length));
    for axis in 0..3 {
        for bad in (0..3).filter(|&bad| bad != axis) {
            let mut curl = curl;
            curl[bad] = &short;
            assert_eq!(transverse(curl, axis, 1.0, length), Err(Error::Length), "{axis} {bad}");
        }
    }
}
