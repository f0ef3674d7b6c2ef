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

/// Every even side to 50, some with a 7 or mixed radices after it, and powers.
const SIDES: [usize; 33] = [
    2, 4, 6, 8, 10, 12, 14, 16, 18, 20, 24, 28, 30, 32, 36, 40, 42, 48, 50, 54, 56, 60, 64, 70, 72, 80, 84,
    90, 96, 98, 100, 108, 112,
];

const PATHS: [Simd; 2] = [Simd::Portable, Simd::Avx2];

#[derive(Clone, Copy)]
#[repr(align(64))]
struct Block([u8; 64]);

/// Memory as a layout asks for, filled with garbage.
struct Memory(Vec<Block>);

impl Memory {
    fn new(layout: Layout) -> Self {
        Self(vec![Block([0xA5; 64]); layout.size.div_ceil(64)])
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

/// Numbers between -1 and 1 without structure (a multiplicative congruence).
fn noise(count: usize, seed: u64) -> Vec<f64> {
    let mut state = seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1;
    (0..count)
        .map(|_| {
            state = state.wrapping_mul(0xD134_2543_DE82_EF95).wrapping_add(1);
            (state >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
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
/// stays below 0.35 epsilon sqrt(log2 N), epsilon the distance from 1 to the next number. The largest of N errors of
/// normal distribution is below 6.5 times that for N < 2^25 except once in 300 times; 8 leaves room.
fn bounds<T: Real>(n: usize) -> (f64, f64) {
    let rms = 0.35 * T::EPSILON.to_f64() * (3.0 * (n as f64).log2()).sqrt();
    (8.0 * rms, rms)
}

fn half_space(n: usize, full: &[[f64; 2]]) -> Vec<[f64; 2]> {
    full.chunks(n).flat_map(|row| row[..=n / 2].to_vec()).collect()
}

fn agrees_with_direct_sums<T: Real>(n: usize, simd: Simd) {
    let cells = rounded::<T>(&noise(n * n * n, n as u64));
    let full = dft::forward(n, &cells);
    with_transform::<T, _>(n, 0, simd, &Serial, |fft| {
        let mut data = mesh_of(fft, &cells);
        fft.forward(&mut data).unwrap();
        let (largest, rms) = errors(modes_of(fft, &data).as_flattened(), half_space(n, &full).as_flattened());
        // The oracle errs by sqrt(n) epsilon of f64 (reference::dft).
        let oracle = f64::EPSILON * (n as f64).sqrt();
        let bound = (bounds::<T>(n).0 + 8.0 * oracle, bounds::<T>(n).1 + oracle);
        assert!(largest < bound.0 && rms < bound.1, "forward {n} {simd:?} {largest:e} {rms:e} {bound:?}");
        // Hermitian modes that T holds: those that came out, and their direct inverse.
        let modes = modes_of(fft, &data);
        let hermitian: Vec<[f64; 2]> = (0..n * n * n)
            .map(|i| {
                let [x, y, z] = [i / (n * n), i / n % n, i % n];
                let mirror = |i: usize| (n - i) % n;
                let at = |x: usize, y: usize, z: usize| modes[(x * n + y) * (n / 2 + 1) + z];
                let (a, b) = if z <= n / 2 {
                    (
                        at(x, y, z),
                        if z % (n / 2) == 0 { at(mirror(x), mirror(y), z) } else { at(x, y, z).map(|v| v) },
                    )
                } else {
                    let m = at(mirror(x), mirror(y), n - z);
                    ([m[0], -m[1]], [m[0], m[1]])
                };
                if z % (n / 2) == 0 { [0.5 * (a[0] + b[0]), 0.5 * (a[1] - b[1])] } else { a }
            })
            .collect();
        let direct = dft::inverse(n, &hermitian);
        fft.inverse(&mut data).unwrap();
        let real: Vec<f64> = direct.iter().map(|value| value[0]).collect();
        let (largest, rms) = errors(&cells_of(fft, &data), &real);
        assert!(largest < bound.0 && rms < bound.1, "inverse {n} {simd:?} {largest:e} {rms:e} {bound:?}");
    });
}

#[test]
fn every_size_agrees_with_direct_sums() {
    for n in SIDES {
        for simd in PATHS {
            agrees_with_direct_sums::<f64>(n, simd);
            agrees_with_direct_sums::<f32>(n, simd);
        }
    }
}
