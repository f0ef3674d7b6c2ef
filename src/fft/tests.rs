use std::vec;
use std::vec::Vec;
use std::{eprintln, println};

use super::*;
use crate::exec::{Exec, Serial, Threads};
use crate::mesh::Space;
use crate::reference::dft;
use crate::scratch::Layout;
use crate::simd::Simd;
use crate::status::Error;

#[path = "../../benches/fftw/mod.rs"]
mod fftw;

mod hooks;

/// Every side to 60, and two with more passes.
const SIDES: [usize; 24] =
    [2, 4, 6, 8, 10, 12, 14, 16, 18, 20, 24, 28, 30, 32, 36, 40, 42, 48, 50, 54, 56, 60, 64, 70];

const PATHS: [Simd; 2] = [Simd::Portable, Simd::Avx2];

#[derive(Clone, Copy)]
#[repr(align(64))]
struct Block([u8; 64]);

/// Memory as a layout asks for, filled with garbage.
struct Memory(Vec<Block>);

impl Memory {
    fn new(layout: Layout) -> Self {
        Self(vec![Block([0xA5; 64]); layout.size.div_ceil(64) + 1])
    }

    fn bytes(&mut self) -> &mut [u8] {
        // SAFETY: every bit pattern of a block is bytes.
        unsafe { self.0.align_to_mut::<u8>().1 }
    }
}

/// Runs `body` with a transform of side n.
fn with_transform<T: Real, R>(
    n: usize,
    padding: usize,
    simd: Simd,
    exec: &dyn Exec,
    body: impl FnOnce(&mut Transform<'_, T>) -> R,
) -> R {
    let mut memory = Memory::new(Tables::<T>::layout(n).unwrap());
    let mut work = Memory::new(Transform::<T>::workspace(n).unwrap());
    let tables = Tables::<T>::new(n, memory.bytes()).unwrap();
    let cells = Brick::whole_padded(n, Space::Configuration, padding).unwrap();
    body(&mut Transform::new(&tables, cells, work.bytes(), exec).unwrap().with_simd(simd))
}

/// Numbers between -1 and 1 without structure (SplitMix64, Steele et al. 2014).
fn noise(count: usize, seed: u64) -> Vec<f64> {
    (1..=count as u64)
        .map(|i| {
            let mut z = seed.wrapping_add(i).wrapping_mul(0x9E37_79B9_7F4A_7C15);
            z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
            z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
            ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
        })
        .collect()
}

/// The mesh that holds n^3 cells, rounded to T; elements outside the brick hold NaN.
fn mesh_of<T: Real>(fft: &Transform<T>, cells: &[f64]) -> Vec<T> {
    let n = fft.configuration().n();
    let [sx, sy, _] = fft.configuration().stride();
    let mut data = vec![T::from_f64(f64::NAN); fft.length()];
    for (i, &value) in cells.iter().enumerate() {
        data[i / (n * n) * sx + i / n % n * sy + i % n] = T::from_f64(value);
    }
    data
}

/// The n^3 cells of a mesh.
fn cells_of<T: Real>(fft: &Transform<T>, data: &[T]) -> Vec<f64> {
    let n = fft.configuration().n();
    let [sx, sy, _] = fft.configuration().stride();
    (0..n * n * n).map(|i| data[i / (n * n) * sx + i / n % n * sy + i % n].to_f64()).collect()
}

/// The n n (n/2 + 1) modes of a mesh.
fn modes_of<T: Real>(fft: &Transform<T>, data: &[T]) -> Vec<[f64; 2]> {
    let (n, h) = (fft.fourier().n(), fft.fourier().n() / 2 + 1);
    let [sx, sy, _] = fft.fourier().stride();
    (0..n * n * h)
        .map(|i| 2 * (i / (n * h) * sx + i / h % n * sy + i % h))
        .map(|address| [data[address].to_f64(), data[address + 1].to_f64()])
        .collect()
}

/// Rounded to T.
fn rounded<T: Real>(values: &[f64]) -> Vec<f64> {
    values.iter().map(|&x| T::from_f64(x).to_f64()).collect()
}

/// Largest and r.m.s. difference over the r.m.s. value of `b`.
fn errors<'a>(a: impl IntoIterator<Item = &'a f64>, b: impl IntoIterator<Item = &'a f64>) -> (f64, f64) {
    let (mut largest, mut squares, mut power, mut count) = (0.0_f64, 0.0, 0.0, 0.0);
    for (a, b) in a.into_iter().zip(b) {
        let d = (a - b).abs();
        largest = if d > largest || d.is_nan() { d } else { largest };
        squares += d * d;
        power += b * b;
        count += 1.0;
    }
    (largest / (power / count).sqrt(), (squares / power).sqrt())
}

/// The r.m.s. error of a fast transform grows as epsilon sqrt(log2 N) (Gentleman & Sande 1966; Schatzman 1996); ours
/// stays below 0.45 epsilon sqrt(log2 N), epsilon the distance from 1 to the next number. The largest of N errors of
/// normal distribution is below 6.5 times that for N < 2^25 except once in 300 times; 8 leaves room.
fn bounds<T: Real>(n: usize) -> (f64, f64) {
    let rms = 0.45 * T::EPSILON.to_f64() * (3.0 * (n as f64).log2()).sqrt();
    (8.0 * rms, rms)
}

/// The half l = 0 ..= n/2 of all n^3 modes.
fn half_space(n: usize, full: &[[f64; 2]]) -> Vec<[f64; 2]> {
    full.chunks(n).flat_map(|row| row[..=n / 2].to_vec()).collect()
}

/// All n^3 modes of a real field, rounded to T and exactly Hermitian: of each pair, the second is made from the first.
fn hermitian<T: Real>(n: usize, full: &[[f64; 2]]) -> Vec<[f64; 2]> {
    (0..n * n * n)
        .map(|i| {
            let [x, y, z] = [i / (n * n), i / n % n, i % n].map(|i| (n - i) % n);
            let mirror = (x * n + y) * n + z;
            let [re, im] = full[i.min(mirror)].map(|x| T::from_f64(x).to_f64());
            [
                re,
                if i == mirror {
                    0.0
                } else if i < mirror {
                    im
                } else {
                    -im
                },
            ]
        })
        .collect()
}

fn agrees_with_direct_sums<T: Real>(n: usize, direct: [&[f64]; 2], modes: [&[[f64; 2]]; 2]) {
    // The oracle errs by sqrt(n) epsilon of f64 (reference::dft).
    let oracle = f64::EPSILON * (n as f64).sqrt();
    let bound = (bounds::<T>(n).0 + 8.0 * oracle, bounds::<T>(n).1 + oracle);
    for simd in PATHS {
        with_transform::<T, _>(n, 0, simd, &Serial, |fft| {
            let mut data = mesh_of(fft, direct[0]);
            fft.forward(&mut data).unwrap();
            let expected = half_space(n, modes[0]);
            let (largest, rms) = errors(modes_of(fft, &data).as_flattened(), expected.as_flattened());
            assert!(largest < bound.0 && rms < bound.1, "forward {n} {simd:?} {largest:e} {rms:e}");

            let given = half_space(n, modes[1]);
            data.copy_from_slice(&given.as_flattened().iter().map(|&x| T::from_f64(x)).collect::<Vec<_>>());
            fft.inverse(&mut data).unwrap();
            let (largest, rms) = errors(&cells_of(fft, &data), direct[1]);
            assert!(largest < bound.0 && rms < bound.1, "inverse {n} {simd:?} {largest:e} {rms:e}");
        });
    }
}

#[test]
fn every_size_agrees_with_direct_sums() {
    for n in SIDES {
        let cells = rounded::<f32>(&noise(n * n * n, n as u64));
        let modes = dft::forward(n, &cells);
        let given = hermitian::<f32>(n, &modes);
        let field: Vec<f64> = dft::inverse(n, &given).into_iter().map(|value| value[0]).collect();
        agrees_with_direct_sums::<f64>(n, [&cells, &field], [&modes, &given]);
        agrees_with_direct_sums::<f32>(n, [&cells, &field], [&modes, &given]);
    }
}

fn agrees_with_fftw<T: Real + fftw::Number>(n: usize) {
    let Some(mut peer) = fftw::Fftw::<T>::new(n, false, T::ZERO) else {
        assert!(std::env::var_os("FIXPAIR_REQUIRE_FFTW").is_none(), "{} is not on this machine", T::LIBRARY);
        eprintln!("skipped: {} is not on this machine", T::LIBRARY);
        return;
    };
    let cells = noise(n * n * n, 7);
    with_transform::<T, _>(n, 0, Simd::detect(), &Serial, |fft| {
        let mut data = mesh_of(fft, &cells);
        peer.data.copy_from_slice(&data);
        // Both err, independently: sqrt(2) of the bound of one.
        let bound = (1.5 * bounds::<T>(n).0, 1.5 * bounds::<T>(n).1);
        for direction in ["forward", "inverse"] {
            let (largest, rms) = if direction == "forward" {
                fft.forward(&mut data).unwrap();
                peer.forward();
                errors(modes_of(fft, &data).as_flattened(), modes_of(fft, &peer.data).as_flattened())
            } else {
                data.copy_from_slice(&peer.data);
                fft.inverse(&mut data).unwrap();
                peer.inverse();
                errors(&cells_of(fft, &data), &cells_of(fft, &peer.data))
            };
            let unit = T::EPSILON.to_f64() * (3.0 * (n as f64).log2()).sqrt();
            println!(
                "{} {n} {direction}: r.m.s. {:.3}, largest {:.2} epsilon sqrt(log2 N)",
                T::PREFIX,
                rms / unit,
                largest / unit
            );
            assert!(largest < bound.0 && rms < bound.1, "{direction} {n} {largest:e} {rms:e}");
        }
    });
}

#[test]
fn agrees_with_fftw_up_to_256() {
    for n in [16, 32, 70, 96, 128, 180, 256] {
        agrees_with_fftw::<f64>(n);
        agrees_with_fftw::<f32>(n);
    }
}

fn modes_do_not_depend_on_threads_or_padding<T: Real>(n: usize) {
    let cells = noise(n * n * n, 3);
    let pools = [1, 2, 5].map(|threads| Threads::new(threads).unwrap());
    for simd in PATHS {
        let run = |padding: usize, exec: &dyn Exec| {
            with_transform::<T, _>(n, padding, simd, exec, |fft| {
                let mut data = mesh_of(fft, &cells);
                fft.forward(&mut data).unwrap();
                let modes = modes_of(fft, &data);
                fft.inverse(&mut data).unwrap();
                let bits = |x: &f64| x.to_bits();
                let cells = cells_of(fft, &data);
                (
                    modes.as_flattened().iter().map(bits).collect::<Vec<_>>(),
                    cells.iter().map(bits).collect::<Vec<_>>(),
                )
            })
        };
        let serial = run(0, &Serial);
        for pool in &pools {
            for padding in [0, 3, recommended_padding::<T>(n)] {
                assert!(run(padding, pool) == serial, "{n} {simd:?} {padding}");
            }
        }
    }
}

#[test]
fn bits_do_not_depend_on_threads_or_padding() {
    for n in [2, 10, 28, 50, 64, 96] {
        modes_do_not_depend_on_threads_or_padding::<f64>(n);
        modes_do_not_depend_on_threads_or_padding::<f32>(n);
    }
}

fn paths_agree<T: Real>(n: usize) {
    let cells = noise(n * n * n, 11);
    let [a, b] = PATHS.map(|simd| {
        with_transform::<T, _>(n, 0, simd, &Serial, |fft| {
            let mut data = mesh_of(fft, &cells);
            fft.forward(&mut data).unwrap();
            modes_of(fft, &data)
        })
    });
    // Both err, independently: sqrt(2) of the bound of one.
    let (largest, rms) = errors(a.as_flattened(), b.as_flattened());
    assert!(largest < 1.5 * bounds::<T>(n).0 && rms < 1.5 * bounds::<T>(n).1, "{n} {largest:e} {rms:e}");
}

#[test]
fn portable_and_avx2_paths_agree_to_rounding() {
    for n in [2, 4, 10, 14, 30, 64, 112, 128] {
        paths_agree::<f64>(n);
        paths_agree::<f32>(n);
    }
}

fn theorems_hold<T: Real>(n: usize) {
    let cube = (n * n * n) as f64;
    let (a, b) = (noise(n * n * n, 1), noise(n * n * n, 2));
    let bound = 4.0 * bounds::<T>(n).0; // sums of a few transforms
    with_transform::<T, _>(n, 1, Simd::detect(), &Serial, |fft| {
        let forward = |fft: &mut Transform<'_, T>, cells: &[f64]| {
            let mut data = mesh_of(fft, cells);
            fft.forward(&mut data).unwrap();
            (modes_of(fft, &data), data)
        };
        let turn = |turns: usize| {
            let (s, c) = libm::sincos(core::f64::consts::TAU * (turns % n) as f64 / n as f64);
            [c, -s]
        };
        let times = |a: [f64; 2], b: [f64; 2]| [a[0] * b[0] - a[1] * b[1], a[0] * b[1] + a[1] * b[0]];
        let h = n / 2 + 1;
        let index = |i: usize| [i / (n * h), i / h % n, i % h];
        let (fa, data) = forward(fft, &a);
        let (fb, _) = forward(fft, &b);

        let mut back = data;
        fft.inverse(&mut back).unwrap();
        let back: Vec<f64> = cells_of(fft, &back).iter().map(|x| x / cube).collect();
        assert!(errors(&back, &a).0 < bound, "round trip {n}");

        let power = |modes: &[[f64; 2]]| -> f64 {
            let twice = |i: usize| if index(i)[2] % (n / 2) == 0 { 1.0 } else { 2.0 };
            modes.iter().enumerate().map(|(i, [re, im])| twice(i) * (re * re + im * im)).sum()
        };
        let cells: f64 = a.iter().map(|x| x * x).sum();
        // The sums of the test have n^3 terms.
        let tolerance = bound + cube * f64::EPSILON;
        assert!((power(&fa) / (cube * cells) - 1.0).abs() < tolerance, "Parseval {n}");

        let sum: Vec<f64> = a.iter().zip(&b).map(|(a, b)| 0.5 * a - 2.0 * b).collect();
        let expected: Vec<f64> =
            fa.as_flattened().iter().zip(fb.as_flattened()).map(|(a, b)| 0.5 * a - 2.0 * b).collect();
        assert!(errors(forward(fft, &sum).0.as_flattened(), &expected).0 < bound, "linear {n}");

        let by = [1, n - 1, n / 2];
        let shifted: Vec<f64> = (0..n * n * n)
            .map(|i| {
                let [x, y, z] = [i / (n * n), i / n % n, i % n];
                a[((x + by[0]) % n * n + (y + by[1]) % n) * n + (z + by[2]) % n]
            })
            .collect();
        // f(x + s) has modes F(k) exp(+i k.s).
        let expected: Vec<[f64; 2]> = (0..n * n * h)
            .map(|i| {
                let [re, im] = turn((0..3).map(|axis| index(i)[axis] * by[axis]).sum());
                times(fa[i], [re, -im])
            })
            .collect();
        assert!(
            errors(forward(fft, &shifted).0.as_flattened(), expected.as_flattened()).0 < bound,
            "shift {n}"
        );

        for (i, value) in fa.iter().enumerate().filter(|&(i, _)| index(i)[2] % (n / 2) == 0) {
            let [x, y, z] = index(i);
            let mirror = fa[((n - x) % n * n + (n - y) % n) * h + z];
            let d = (value[0] - mirror[0]).abs().max((value[1] + mirror[1]).abs());
            assert!(d < bound * cube.sqrt(), "Hermitian {n}");
        }

        let (x, y, z) = (n - 1, n / 2, 1);
        let mut impulse = vec![0.0; n * n * n];
        impulse[(x * n + y) * n + z] = 1.0;
        for (i, value) in forward(fft, &impulse).0.into_iter().enumerate() {
            let [kx, ky, kz] = index(i);
            let expected = turn(x * kx + y * ky + z * kz);
            assert!((0..2).all(|part| (value[part] - expected[part]).abs() < bound), "impulse {n} {i}");
        }

        let k = [n - 1, 1, n / 2 - 1];
        let wave: Vec<f64> =
            (0..n * n * n).map(|i| turn(i / (n * n) * k[0] + i / n % n * k[1] + i % n * k[2])[0]).collect();
        let self_conjugate = k.iter().all(|&k| k % (n / 2) == 0);
        for (i, value) in forward(fft, &wave).0.into_iter().enumerate() {
            let mirrored = k.map(|k| (n - k) % n);
            let expected = match index(i) {
                at if at == k && self_conjugate => cube,
                at if at == k || at == mirrored => 0.5 * cube,
                _ => 0.0,
            };
            // Rounding errors of a wave may all gather in one mode.
            let near = (value[0] - expected).abs().max(value[1].abs()) < bound * cube;
            assert!(near, "plane wave {n} {:?} {value:?} {expected}", index(i));
        }
    });
}

#[test]
fn the_theorems_of_fourier_transforms_hold() {
    for n in [2, 4, 6, 14, 16, 20, 36, 42] {
        theorems_hold::<f64>(n);
        theorems_hold::<f32>(n);
    }
}

#[test]
fn nan_comes_out_where_nan_goes_in() {
    with_transform::<f64, _>(12, 0, Simd::detect(), &Serial, |fft| {
        let mut cells = noise(12 * 12 * 12, 5);
        cells[100] = f64::NAN;
        let mut data = mesh_of(fft, &cells);
        fft.forward(&mut data).unwrap();
        // A part may be a sum of exact zeros, such as the imaginary part of the mean.
        assert!(modes_of(fft, &data).iter().all(|value| value[0].is_nan() || value[1].is_nan()));
        fft.inverse(&mut data).unwrap();
        assert!(cells_of(fft, &data).iter().all(|x| x.is_nan()));
    });
}

#[test]
fn sizes_that_cannot_be_transformed_are_refused() {
    for n in [0, 1, 3, 7, 22, 26, 2 * 11 * 13, 254] {
        assert_eq!(Tables::<f64>::layout(n), Err(Error::MeshSize), "{n}");
        assert_eq!(Transform::<f32>::workspace(n), Err(Error::MeshSize), "{n}");
    }
    for n in [1 << 21, 1 << 40, usize::MAX - 1] {
        assert_eq!(Tables::<f64>::layout(n), Err(Error::Overflow), "{n}");
        assert_eq!(Transform::<f32>::workspace(n), Err(Error::Overflow), "{n}");
    }
}

#[test]
fn tables_are_recognised_and_damage_is_refused() {
    let layout = Tables::<f64>::layout(20).unwrap();
    let mut memory = Memory::new(layout);
    assert_eq!(Tables::<f64>::view(memory.bytes()).err(), Some(Error::Version), "never built");
    assert_eq!(Tables::<f64>::new(20, &mut memory.bytes()[..layout.size - 1]).err(), Some(Error::Scratch));
    assert_eq!(Tables::<f64>::new(20, &mut memory.bytes()[8..]).err(), Some(Error::Alignment));
    assert_eq!(Tables::<f64>::view(&memory.bytes()[8..]).err(), Some(Error::Alignment));
    assert_eq!(Tables::<f64>::new(20, memory.bytes()).unwrap().n(), 20);
    assert_eq!(Tables::<f64>::view(memory.bytes()).unwrap().n(), 20);
    assert_eq!(Tables::<f64>::view(&memory.bytes()[..layout.size - 64]).err(), Some(Error::Scratch));
    assert_eq!(Tables::<f64>::view(&[]).err(), Some(Error::Scratch));
    assert_eq!(Tables::<f32>::view(memory.bytes()).err(), Some(Error::Version), "another number type");
    let good = memory.0.clone();
    for byte in (0..32).step_by(3) {
        memory.0[0].0[byte] ^= 0x40;
        assert_eq!(Tables::<f64>::view(memory.bytes()).err(), Some(Error::Version), "header byte {byte}");
        memory.0.clone_from(&good);
    }
    // Reversed digits that would store outside the mesh.
    let roots = Tables::<f64>::view(memory.bytes()).unwrap().columns.roots.len() * 8;
    memory.0[1 + roots.div_ceil(64)].0[3] = 0x80;
    assert_eq!(Tables::<f64>::view(memory.bytes()).err(), Some(Error::Version));
}

#[test]
fn meshes_that_do_not_fit_are_refused() {
    let mut memory = Memory::new(Tables::<f32>::layout(8).unwrap());
    let tables = Tables::<f32>::new(8, memory.bytes()).unwrap();
    let layout = Transform::<f32>::workspace(8).unwrap();
    let mut work = Memory::new(layout);
    let refused = |brick: Brick| Transform::new(&tables, brick, Memory::new(layout).bytes(), &Serial).err();
    let cells = |stride| Brick::general(8, Space::Configuration, [0; 3], [8; 3], stride).unwrap();
    assert_eq!(refused(Brick::whole(10, Space::Configuration).unwrap()), Some(Error::Brick));
    assert_eq!(refused(Brick::whole(8, Space::Fourier).unwrap()), Some(Error::Brick));
    assert_eq!(refused(Brick::slab(8, Space::Configuration, 0, 4).unwrap()), Some(Error::Brick));
    assert_eq!(refused(cells([64, 8, 1])), Some(Error::Brick), "rows without padding");
    assert_eq!(refused(cells([78, 10, 1])), Some(Error::Brick), "planes too close");
    assert_eq!(refused(cells([81, 10, 1])), Some(Error::Brick), "odd planes");
    assert_eq!(refused(cells([1, 10, 80])), Some(Error::Brick), "x innermost");
    let whole = Brick::whole(8, Space::Configuration).unwrap();
    let bytes = layout.size;
    assert_eq!(
        Transform::new(&tables, whole, &mut work.bytes()[..bytes - 1], &Serial).err(),
        Some(Error::Scratch)
    );
    assert_eq!(Transform::new(&tables, whole, &mut work.bytes()[4..], &Serial).err(), Some(Error::Alignment));
    let mut fft = Transform::new(&tables, whole, work.bytes(), &Serial).unwrap();
    for length in [0, 639, 641] {
        let mut data = vec![1.5; length];
        assert_eq!(fft.forward(&mut data), Err(Error::Length));
        assert_eq!(fft.inverse(&mut data), Err(Error::Length));
        assert!(data.iter().all(|&x| x == 1.5));
    }
}
