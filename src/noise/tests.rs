//! What holds exactly, bit by bit, and to rounding.

use std::vec;
use std::vec::Vec;

use super::blocks::{NORMAL_MEAN, RAYLEIGH_MEAN};
use super::white::draw;
use super::*;
use crate::exec::{Exec, Serial, Threads};
use crate::fft::Fft3;
use crate::mesh::{Brick, Space};
use crate::real::Real;
use crate::reference::white::white_mode;
use crate::simd::Simd;
use crate::status::{Error, Result};

const AMPLITUDES: [Amplitude; 3] = [Amplitude::Normal, Amplitude::Fixed, Amplitude::FixedToMean];
const NYQUISTS: [Nyquist; 2] = [Nyquist::Zero, Nyquist::Filled];

/// Every choice of a seed.
fn choices(seed: u64) -> Vec<Realisation> {
    let mut all = Vec::new();
    for amplitude in AMPLITUDES {
        for phase in [Phase::Original, Phase::Inverted] {
            for nyquist in NYQUISTS {
                all.push(Realisation { amplitude, phase, nyquist, ..Realisation::new(seed) });
            }
        }
    }
    all
}

pub(super) fn whole(n: usize) -> Brick {
    Brick::whole(n, Space::Fourier).unwrap()
}

pub(super) fn white<T: Real>(brick: &Brick, realisation: &Realisation) -> Vec<T> {
    let mut out = vec![T::from_f64(7.0); brick.reals()];
    white_modes(&mut out, brick, realisation, &Serial).unwrap();
    out
}

/// Indices of all modes of a brick, with the address of their real part.
pub(super) fn modes(brick: &Brick) -> impl Iterator<Item = ([usize; 3], usize)> {
    let (start, count, stride) = (brick.start(), brick.count(), brick.stride());
    (0..brick.elements()).map(move |e| {
        let local = [e / (count[1] * count[2]), e / count[2] % count[1], e % count[2]];
        let index = core::array::from_fn(|a| start[a] + local[a]);
        (index, 2 * (0..3).map(|a| local[a] * stride[a]).sum::<usize>())
    })
}

pub(super) fn signed(n: usize, index: [usize; 3]) -> [i64; 3] {
    [Brick::mode(n, index[0]), Brick::mode(n, index[1]), index[2] as i64]
}

pub(super) fn bits<T: Real>(x: T) -> u64 {
    x.to_f64().to_bits()
}

pub(super) fn same_bits<T: Real>(a: &[T], b: &[T]) -> bool {
    a.len() == b.len() && a.iter().zip(b).all(|(&a, &b)| bits(a) == bits(b))
}

#[test]
fn modes_are_those_of_the_slow_reference() {
    // -ln u2 carries 1 ulp, its root half of that, the angle of the reference 2 pi u1 up to half an ulp of 2 pi: 4.4e-16.
    let tolerance = 1.5e-15;
    for n in [2, 4, 6, 16, 72] {
        for choice in choices(0xDEAD_BEEF_0BAD_CAFE) {
            let mesh = white::<f64>(&whole(n), &choice);
            for (index, at) in modes(&whole(n)) {
                let expected = white_mode(n as i64, signed(n, index), &choice);
                // A self-conjugate mode is a cosine, possibly small, times at most sqrt(2 * 53 ln 2).
                let scale = if expected[1] == 0.0 { 8.6 } else { expected[0].hypot(expected[1]) };
                for part in 0..2 {
                    assert!(
                        (mesh[at + part] - expected[part]).abs() <= tolerance * scale,
                        "n = {n}, {index:?}, {choice:?}: {} {expected:?}",
                        mesh[at + part]
                    );
                }
            }
        }
    }
}

#[test]
fn modes_are_hermitian() {
    for n in [2, 6, 16] {
        let brick = whole(n);
        let stride = brick.stride();
        for choice in choices(11) {
            let mesh = white::<f64>(&brick, &choice);
            for l in [0, n / 2] {
                for i in 0..n {
                    for j in 0..n {
                        let at = |i, j| 2 * (i * stride[0] + j * stride[1] + l);
                        let (a, b) = (at(i, j), at((n - i) % n, (n - j) % n));
                        assert_eq!(mesh[a], mesh[b], "{i} {j} {l} {choice:?}");
                        assert_eq!(mesh[a + 1], -mesh[b + 1], "{i} {j} {l} {choice:?}");
                    }
                }
            }
            assert_eq!([mesh[0], mesh[1]].map(f64::to_bits), [0; 2], "DC is +0");
        }
    }
}

#[test]
fn nyquist_planes_are_zero_or_filled() {
    let n = 8;
    for choice in choices(5) {
        let mesh = white::<f64>(&whole(n), &choice);
        for (index, at) in modes(&whole(n)).skip(1) {
            if index.contains(&(n / 2)) && choice.nyquist == Nyquist::Zero {
                assert_eq!([mesh[at], mesh[at + 1]].map(f64::to_bits), [0; 2], "+0");
            } else {
                assert!(mesh[at] != 0.0);
            }
        }
    }
}

#[test]
fn inverted_is_bitwise_negation() {
    fn check<T: Real>(n: usize) {
        for original in choices(3).into_iter().filter(|c| c.phase == Phase::Original) {
            let inverted = Realisation { phase: Phase::Inverted, ..original };
            let (a, b) = (white::<T>(&whole(n), &original), white::<T>(&whole(n), &inverted));
            for (index, at) in modes(&whole(n)) {
                let zero = index == [0; 3] || index.contains(&(n / 2)) && original.nyquist == Nyquist::Zero;
                for part in [at, at + 1] {
                    let flip = if zero { 0 } else { 1 << 63 };
                    assert_eq!(bits(b[part]), bits(a[part]) ^ flip, "{index:?} {original:?}");
                }
            }
        }
    }
    check::<f64>(20);
    check::<f32>(20);
}

#[test]
fn fixed_has_unit_modulus_and_the_phases_of_normal() {
    let n = 20;
    let with = |amplitude| {
        white::<f64>(&whole(n), &Realisation { amplitude, nyquist: Nyquist::Filled, ..Realisation::new(9) })
    };
    let (normal, fixed, mean) =
        (with(Amplitude::Normal), with(Amplitude::Fixed), with(Amplitude::FixedToMean));
    for (index, at) in modes(&whole(n)).skip(1) {
        let (w, f, m) = ([normal[at], normal[at + 1]], [fixed[at], fixed[at + 1]], [mean[at], mean[at + 1]]);
        // Both parts of a unit vector within 2.3e-16 move its modulus by at most 3.3e-16.
        assert!((f[0].hypot(f[1]) - 1.0).abs() < 4.5e-16, "{index:?}");
        let modulus = w[0].hypot(w[1]);
        // Two roundings of each part of w, one of each product.
        assert!((w[0] * f[1] - w[1] * f[0]).abs() <= 4.5e-16 * modulus, "same phase at {index:?}");
        assert!(w[0] * f[0] + w[1] * f[1] > 0.0);
        let self_conjugate = index.iter().all(|m| m % (n / 2) == 0);
        let factor = if self_conjugate { NORMAL_MEAN } else { RAYLEIGH_MEAN };
        assert_eq!(m, f.map(|x| factor * x));
    }
    assert!((RAYLEIGH_MEAN - libm::sqrt(core::f64::consts::PI) / 2.0).abs() < 1.2e-16);
    assert!((NORMAL_MEAN - libm::sqrt(core::f64::consts::FRAC_2_PI)).abs() < 1.2e-16);
}

#[test]
fn meshes_and_number_types_share_modes() {
    for amplitude in AMPLITUDES {
        let choice = Realisation { amplitude, ..Realisation::new(2024) };
        let fine = white::<f64>(&whole(64), &choice);
        let stride = whole(64).stride();
        for n in [32, 48, 64] {
            let (coarse, single) = (white::<f64>(&whole(n), &choice), white::<f32>(&whole(n), &choice));
            for (index, at) in modes(&whole(n)) {
                if index.contains(&(n / 2)) {
                    continue;
                }
                let wrap = |m: i64| m.rem_euclid(64) as usize;
                let [i, j, l] = signed(n, index).map(wrap);
                let there = 2 * (i * stride[0] + j * stride[1] + l);
                for part in 0..2 {
                    assert_eq!(coarse[at + part].to_bits(), fine[there + part].to_bits());
                    assert_eq!(single[at + part].to_bits(), (fine[there + part] as f32).to_bits());
                }
            }
        }
    }
}

#[test]
fn every_brick_holds_the_bits_of_the_whole_mesh() {
    fn check<T: Real>() {
        let n = 24;
        let fourier = |start, count, stride| Brick::general(n, Space::Fourier, start, count, stride).unwrap();
        let bricks = [
            Brick::slab(n, Space::Fourier, 7, 9).unwrap(),
            Brick::slab(n, Space::Fourier, 0, 1).unwrap(),
            Brick::transposed_slab(n, 11, 3).unwrap(),
            Brick::whole_padded(n, Space::Fourier, 5).unwrap(),
            fourier([3, 12, 1], [8, 7, 12], [7 * 12, 12, 1]),
            fourier([0, 0, 5], [24, 24, 3], [24 * 3, 3, 1]),
            fourier([0, 0, 0], [24, 24, 13], [1, 24, 576]),
            fourier([20, 5, 2], [4, 6, 9], [9, 36, 1]),
            fourier([2, 5, 0], [4, 6, 13], [13 * 3, 12 * 13, 3]),
            fourier([24, 0, 0], [0, 24, 13], [1, 1, 1]),
        ];
        for choice in choices(77) {
            let mesh = white::<T>(&whole(n), &choice);
            let stride = whole(n).stride();
            for brick in &bricks {
                let part = white::<T>(brick, &choice);
                let mut written = 0;
                for ([i, j, l], at) in modes(brick) {
                    let there = 2 * (i * stride[0] + j * stride[1] + l);
                    assert!(same_bits(&part[at..at + 2], &mesh[there..there + 2]), "{brick:?} {choice:?}");
                    written += 2;
                }
                let untouched = part.iter().filter(|&&x| x == T::from_f64(7.0)).count();
                assert_eq!(untouched + written, part.len(), "gaps are left alone");
            }
        }
    }
    check::<f64>();
    check::<f32>();
}

#[test]
fn threads_and_code_paths_give_the_same_bits() {
    fn check<T: Real>(n: usize) {
        let table: Vec<f64> = (0..=3 * n * n / 4).map(|s| 1.0 / (1.0 + s as f64)).collect();
        for choice in choices(1 << 40) {
            for colour in [None, Some(&table[..])] {
                let run = |exec: &dyn Exec, simd| {
                    let mut out = vec![T::ZERO; whole(n).reals()];
                    draw(&mut out, &whole(n), &choice, colour, exec, simd).unwrap();
                    out
                };
                let portable = run(&Serial, Simd::Portable);
                assert!(same_bits(&portable, &run(&Serial, Simd::detect())));
                for threads in [1, 2, 5] {
                    assert!(same_bits(&portable, &run(&Threads::new(threads).unwrap(), Simd::detect())));
                }
            }
        }
    }
    check::<f64>(30);
    check::<f64>(80);
    check::<f32>(80);
}

#[test]
fn the_bits_are_pinned() {
    // A fixed realisation is a promise to every simulation already run: this sum may never change.
    let sum = |choice: &Realisation| {
        white::<f64>(&whole(16), choice)
            .iter()
            .fold(0xCBF2_9CE4_8422_2325, |hash: u64, x| (hash ^ x.to_bits()).wrapping_mul(0x0100_0000_01B3))
    };
    let normal = Realisation { nyquist: Nyquist::Filled, ..Realisation::new(20_220_423) };
    let fixed = Realisation { amplitude: Amplitude::Fixed, ..normal };
    assert_eq!([sum(&normal), sum(&fixed)], [12_776_329_132_086_726_128, 2_051_692_975_801_941_136]);
}

#[test]
fn colouring_multiplies_the_double_precision_mode() {
    let n = 18;
    let table: Vec<f64> =
        (0..=3 * n * n / 4).map(|s| if s == 0 { f64::INFINITY } else { 3.7 / s as f64 }).collect();
    for choice in choices(8) {
        let unit = white::<f64>(&whole(n), &choice);
        let mut double = unit.clone();
        let mut single = vec![0_f32; unit.len()];
        white_modes_coloured(&mut double, &whole(n), &choice, &table, &Serial).unwrap();
        white_modes_coloured(&mut single, &whole(n), &choice, &table, &Serial).unwrap();
        for (index, at) in modes(&whole(n)).skip(1) {
            let square: i64 = signed(n, index).iter().map(|m| m * m).sum();
            for at in [at, at + 1] {
                let expected = unit[at] * table[square as usize];
                assert_eq!(double[at].to_bits(), expected.to_bits(), "{index:?}");
                assert_eq!(single[at].to_bits(), (expected as f32).to_bits());
            }
        }
        assert_eq!([double[0], double[1]].map(f64::to_bits), [0; 2], "DC needs no amplitude");
    }
}

#[test]
fn bad_arguments_are_refused_and_outputs_untouched() {
    let n = 8;
    let (brick, cells) = (whole(n), Brick::whole(n, Space::Configuration).unwrap());
    let choice = Realisation::new(1);
    let table = vec![1.0; 3 * n * n / 4 + 1];
    let mut out = vec![7.0_f32; brick.reals()];
    let short = out.len() - 1;
    assert_eq!(white_modes(&mut out, &cells, &choice, &Serial), Err(Error::Brick));
    assert_eq!(white_modes(&mut out[..short], &brick, &choice, &Serial), Err(Error::Length));
    let mut coloured = |brick: &Brick, length: usize, table: &[f64]| {
        white_modes_coloured(&mut out[..length], brick, &choice, table, &Serial)
    };
    assert_eq!(coloured(&cells, short + 1, &table), Err(Error::Brick));
    assert_eq!(coloured(&brick, short, &table), Err(Error::Length));
    assert_eq!(coloured(&brick, short + 1, &table[1..]), Err(Error::Length));
    for bad in [f64::NAN, f64::INFINITY, -f64::INFINITY, 1e38] {
        let mut table = table.clone();
        *table.last_mut().unwrap() = bad;
        assert_eq!(coloured(&brick, short + 1, &table), Err(Error::NotFinite), "{bad}");
    }
    let fixed = Realisation { amplitude: Amplitude::Fixed, ..choice };
    assert_eq!(impose(&mut out, &cells, &fixed, &Serial), Err(Error::Brick));
    assert_eq!(impose(&mut out[..short], &brick, &fixed, &Serial), Err(Error::Length));
    assert!(out.iter().all(|&x| x == 7.0));
    for bad in [f32::NAN, f32::INFINITY] {
        let last = out.len() - 1;
        out[last] = bad;
        assert_eq!(impose(&mut out, &brick, &fixed, &Serial), Err(Error::NotFinite));
        assert!(out[..last].iter().all(|&x| x == 7.0));
    }
}

#[test]
fn imposing_on_normal_modes_gives_the_modes_drawn_that_way() {
    let n = 20;
    let normal = white::<f64>(&whole(n), &Realisation { nyquist: Nyquist::Filled, ..Realisation::new(31) });
    for choice in choices(31) {
        let expected = white::<f64>(&whole(n), &choice);
        let mut imposed = normal.clone();
        impose(&mut imposed, &whole(n), &choice, &Serial).unwrap();
        if choice.amplitude == Amplitude::Normal {
            assert!(same_bits(&imposed, &expected));
        }
        for (a, b) in imposed.iter().zip(&expected) {
            // The modulus has three roundings, the quotient two, the drawn mode 2.3e-16.
            assert!((a - b).abs() < 1e-15, "{choice:?}: {a} {b}");
        }
    }
}

#[test]
fn imposing_is_defined_for_every_finite_mode() {
    let n = 4;
    let brick = whole(n);
    for value in [0.0, -0.0, f64::MIN_POSITIVE * f64::EPSILON, 1e-200, 1e200, f64::MAX] {
        let mut out = vec![value; brick.reals()];
        let fixed =
            Realisation { amplitude: Amplitude::Fixed, nyquist: Nyquist::Filled, ..Realisation::new(0) };
        impose(&mut out, &brick, &fixed, &Serial).unwrap();
        for (index, at) in modes(&brick).skip(1) {
            let self_conjugate = index.iter().all(|m| m % (n / 2) == 0);
            let expected = if self_conjugate || value == 0.0 { [1.0, 0.0] } else { [0.5_f64.sqrt(); 2] };
            for part in 0..2 {
                assert!((out[at + part] - expected[part]).abs() < 3e-16, "{value} {index:?}");
            }
        }
        assert_eq!([out[0], out[1]].map(f64::to_bits), [0; 2]);
    }
}

/// The transform by its definition.
struct Direct {
    cells: Brick,
    modes: Brick,
}

impl Fft3<f64> for Direct {
    fn configuration(&self) -> &Brick {
        &self.cells
    }

    fn fourier(&self) -> &Brick {
        &self.modes
    }

    fn length(&self) -> usize {
        self.modes.reals()
    }

    fn forward(&mut self, data: &mut [f64]) -> Result<()> {
        let n = self.cells.n();
        let stride = self.cells.stride();
        let field = data.to_vec();
        for ([i, j, l], at) in modes(&self.modes) {
            let mut sum = [0.0; 2];
            for e in 0..n * n * n {
                let [x, y, z] = [e / (n * n), e / n % n, e % n];
                let angle = -core::f64::consts::TAU * ((i * x + j * y + l * z) % n) as f64 / n as f64;
                let value = field[x * stride[0] + y * stride[1] + z];
                sum = [sum[0] + value * angle.cos(), sum[1] + value * angle.sin()];
            }
            data[at..at + 2].copy_from_slice(&sum);
        }
        Ok(())
    }

    fn inverse(&mut self, _: &mut [f64]) -> Result<()> {
        Err(Error::Hook)
    }
}

#[test]
fn unit_modes_of_a_field_have_its_phases_and_unit_power() {
    let n = 6;
    let cells = Brick::whole(n, Space::Configuration).unwrap();
    let mut fft = Direct { cells, modes: whole(n) };
    // White noise with unit mean square to rounding: +-1 by the parity of a block.
    let field: Vec<f64> = (0..fft.length())
        .map(|i| if philox::philox4x32_10([i as u32, 0, 0, 0], [1, 2])[0] & 1 == 0 { 1.0 } else { -1.0 })
        .collect();
    let mut transform = field.clone();
    fft.forward(&mut transform).unwrap();
    let unit = |fft: &mut Direct, amplitude, phase, nyquist| {
        let mut data = field.clone();
        let choice = Realisation { amplitude, phase, nyquist, ..Realisation::new(0) };
        unit_modes_from_field(fft, &mut data, &choice, &Serial).unwrap();
        data
    };
    let normal = unit(&mut fft, Amplitude::Normal, Phase::Original, Nyquist::Filled);
    let fixed = unit(&mut fft, Amplitude::Fixed, Phase::Original, Nyquist::Filled);
    let inverted = unit(&mut fft, Amplitude::Normal, Phase::Inverted, Nyquist::Filled);
    let zeroed = unit(&mut fft, Amplitude::Normal, Phase::Original, Nyquist::Zero);
    let scale = (n as f64).powf(-1.5);
    let mut power = (transform[0] * scale).powi(2);
    for (index, at) in modes(&whole(n)).skip(1) {
        let w = [normal[at], normal[at + 1]];
        // Self-conjugate modes of the direct sum keep imaginary parts of rounding, 1e-15 n^1.5.
        assert!((w[0] - scale * transform[at]).abs() < 1e-14);
        assert!((w[1] - scale * transform[at + 1]).abs() < 1e-14);
        assert_eq!([inverted[at], inverted[at + 1]], w.map(|x| -x));
        let modulus = w[0].hypot(w[1]);
        assert!((fixed[at] * modulus - w[0]).abs() < 1e-15 && (fixed[at + 1] * modulus - w[1]).abs() < 1e-15);
        let on_nyquist = index.contains(&(n / 2));
        assert_eq!([zeroed[at], zeroed[at + 1]], if on_nyquist { [0.0; 2] } else { w });
        let stored_twice = index[2] % (n / 2) == 0;
        power += if stored_twice { 1.0 } else { 2.0 } * modulus * modulus;
    }
    // Parseval: sum over all n^3 modes of |w|^2 is the sum over cells of f^2.
    let cells = (n * n * n) as f64;
    assert!((power / cells - 1.0).abs() < 1e-13);
}

#[test]
fn a_bad_field_is_refused_before_it_is_transformed() {
    let n = 4;
    let cells = Brick::whole(n, Space::Configuration).unwrap();
    let mut fft = Direct { cells, modes: whole(n) };
    let mut data = vec![1.0; fft.length()];
    let length = data.len();
    let call = |fft: &mut Direct, data: &mut [f64]| {
        let fixed = Realisation { amplitude: Amplitude::Fixed, ..Realisation::new(0) };
        unit_modes_from_field(fft, data, &fixed, &Serial)
    };
    assert_eq!(call(&mut fft, &mut data[..length - 1]), Err(Error::Length));
    data[3] = f64::NAN;
    assert_eq!(call(&mut fft, &mut data), Err(Error::NotFinite));
    assert!(data.iter().enumerate().all(|(i, &x)| x == 1.0 || i == 3));
    data[3] = 1e308;
    data[0] = 1e308;
    assert_eq!(call(&mut fft, &mut data), Err(Error::NotFinite), "the transform overflows");
    let mut mixed = Direct { cells, modes: whole(6) };
    assert_eq!(call(&mut mixed, &mut vec![1.0; whole(6).reals()]), Err(Error::Brick));
}
