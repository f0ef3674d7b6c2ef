//! The schemes of N-GenIC and FastPM: the bits of the slow reference, in every layout.

use std::vec;
use std::vec::Vec;

use super::ngenic::{LANES, Streams};
use super::ranlux::{Lanes, Ranlxd1};
use super::tests::{bits, modes, same_bits, signed, white, whole};
use super::white::draw;
use super::*;
use crate::exec::{Exec, Serial, Threads};
use crate::mesh::{Brick, Space};
use crate::real::Real;
use crate::reference::ngenic as reference;
use crate::simd::Simd;
use crate::status::Error;

const UNIT: f64 = (1_u64 << 48) as f64;

/// Every choice of both schemes that is not refused.
fn choices(seed: u64) -> Vec<Realisation> {
    let mut all = Vec::new();
    for amplitude in [Amplitude::Normal, Amplitude::Fixed, Amplitude::FixedToMean] {
        for phase in [Phase::Original, Phase::Inverted] {
            let choice = Realisation { amplitude, phase, ..Realisation::new(seed) };
            all.push(Realisation { scheme: Scheme::NGenIc, ..choice });
            all.push(Realisation { scheme: Scheme::FastPm, ..choice });
            all.push(Realisation { scheme: Scheme::FastPm, nyquist: Nyquist::Filled, ..choice });
        }
    }
    all
}

#[test]
fn the_generator_is_that_of_gsl() {
    // The first two numbers of gsl_rng_ranlxd1, GSL 2.7, times 2^48. It reads the lower half of the seed as a signed number.
    let first = [
        (0, [234_896_157_671_761, 173_586_188_755_874]),
        (1, [234_896_157_671_761, 173_586_188_755_874]),
        (2, [258_185_565_666_446, 227_530_581_813_260]),
        (2_147_483_647, [180_341_811_685_814, 157_790_195_044_407]),
        (2_147_483_648, [1_791_209, 2_136_571]),
        (2_147_483_649, [180_341_811_685_814, 157_790_195_044_407]),
        (3_000_000_000, [183_940_011_396_393, 52_254_953_463_109]),
        (4_294_967_296, [1_791_209, 2_136_571]),
        (u64::MAX, [234_896_157_671_761, 173_586_188_755_874]),
    ];
    for (seed, expected) in first {
        let mut stream = Ranlxd1::new(seed);
        assert_eq!(
            [stream.uniform() * UNIT, stream.uniform() * UNIT],
            expected.map(|x: u64| x as f64),
            "{seed}"
        );
    }
}

#[test]
fn lanes_and_single_generators_draw_the_numbers_of_the_reference() {
    let seeds: [u64; LANES] = [1, 2, 77, 12_345, 1 << 30, (1 << 31) - 1, 0x5555_5555, 0x2AAA_AAAA];
    let mut lanes = Lanes::new(seeds);
    let mut single = seeds.map(Ranlxd1::new);
    let mut expected = seeds.map(|seed| reference::Ranlxd1::new(seed as u32));
    for _ in 0..50 {
        for words in lanes.dozen() {
            for lane in 0..LANES {
                let u = expected[lane].uniform();
                assert_eq!(words[lane] as f64 / UNIT, u);
                assert_eq!(single[lane].uniform().to_bits(), u.to_bits());
            }
        }
    }
}

#[test]
fn a_second_uniform_of_zero_is_drawn_again() {
    let ordinary = |lane: usize| Lanes::new([lane as u64 + 1]);
    let dozen = |zeros: &[usize]| {
        core::array::from_fn(|k| {
            if zeros.contains(&k) { 0 } else { 0x1234_5678_9ABC * (2 * k as u64 + 3) % (1 << 48) }
        })
    };
    // The first number of a mode may be zero, the second may not; nor may the second draw of it.
    let states = |lane| match lane {
        2 => Lanes::before(dozen(&[5])),
        3 => Lanes::before(dozen(&[4, 7, 8, 11])),
        5 => Lanes::before(dozen(&[0, 2, 4])),
        _ => ordinary(lane),
    };
    let states: [Lanes<1>; LANES] = core::array::from_fn(states);
    let mut streams = Streams::Together(Lanes::side_by_side(states));
    let mut numbers = states.map(|state| {
        let mut stream = Ranlxd1::resume(state, 12);
        core::iter::repeat_with(move || stream.uniform())
    });
    let mut again = 0;
    for _ in 0..5 {
        let [u1, u2] = streams.uniforms();
        for at in 0..u1.len() {
            let numbers = &mut numbers[at % LANES];
            assert_eq!(u1[at], numbers.next().unwrap());
            let mut second = numbers.next().unwrap();
            while second == 0.0 {
                second = numbers.next().unwrap();
                again += 1;
            }
            assert_eq!(u2[at], second);
        }
    }
    assert_eq!(again, 4, "one for lane 2, three for lane 3");
}

#[test]
fn seeds_are_those_of_the_table() {
    for n in [2, 4, 18, 32] {
        let table = reference::seed_table(n, 4321);
        let mut seeds = vec![0; n * n];
        ngenic_seeds(&mut seeds, &whole(n), 4321).unwrap();
        assert_eq!(seeds, table);
        let [i, j] = [n / 2 - 1, n / 4];
        let brick = Brick::general(n, Space::Fourier, [i, j, 0], [n - i, n / 2 - j, 1], [n, 1, 1]).unwrap();
        let mut part = vec![0; (n - i) * (n / 2 - j)];
        ngenic_seeds(&mut part, &brick, 4321).unwrap();
        for (at, seed) in part.iter().enumerate() {
            let [row, column] = [at / (n / 2 - j), at % (n / 2 - j)];
            assert_eq!(*seed, table[(i + row) * n + j + column]);
        }
        assert_eq!(ngenic_seeds(&mut part[1..], &brick, 1), Err(Error::Length));
    }
    let cells = Brick::whole(4, Space::Configuration).unwrap();
    assert_eq!(ngenic_seeds(&mut [0; 16], &cells, 1), Err(Error::Brick));
}

#[test]
fn modes_are_those_of_the_slow_reference() {
    for n in [2, 4, 6, 16, 34] {
        for choice in choices(2_022_042) {
            for (selection, sample) in [
                (Selection::Cube, 0),
                (Selection::Cube, n as u32 / 2 + 1),
                (Selection::Sphere, 0),
                (Selection::Sphere, 12),
            ] {
                let choice = Realisation { selection, sample, ..choice };
                let expected = reference::modes(n, &choice);
                let (double, single) = (white::<f64>(&whole(n), &choice), white::<f32>(&whole(n), &choice));
                for ([i, j, l], at) in modes(&whole(n)) {
                    let expected = expected[(i * n + j) * (n / 2 + 1) + l];
                    for part in 0..2 {
                        let (x, y) = (double[at + part], expected[part]);
                        if choice.amplitude == Amplitude::FixedToMean {
                            // The two compute the mean modulus differently.
                            assert!((x - y).abs() < 3e-16, "{i} {j} {l} {choice:?}: {x} {y}");
                        } else {
                            assert_eq!(x.to_bits(), y.to_bits(), "{i} {j} {l} {choice:?}: {x} {y}");
                        }
                        assert_eq!(single[at + part].to_bits(), (x as f32).to_bits());
                    }
                }
            }
        }
    }
}

#[test]
fn modes_are_hermitian() {
    for n in [2, 6, 16] {
        let stride = whole(n).stride();
        for choice in choices(11) {
            let mesh = white::<f64>(&whole(n), &choice);
            for l in [0, n / 2] {
                for i in 0..n {
                    for j in 0..n {
                        let at = |i, j| 2 * (i * stride[0] + j * stride[1] + l);
                        let (a, b) = (at(i, j), at((n - i) % n, (n - j) % n));
                        assert_eq!([mesh[a], mesh[a + 1]], [mesh[b], -mesh[b + 1]], "{i} {j} {l} {choice:?}");
                        let filled =
                            choice.nyquist == Nyquist::Filled || [i, j, l].iter().all(|&m| m != n / 2);
                        assert_eq!(mesh[a] != 0.0, filled && (i, j, l) != (0, 0, 0));
                    }
                }
            }
            assert_eq!([mesh[0], mesh[1]].map(f64::to_bits), [0; 2], "DC is +0");
        }
    }
}

#[test]
fn fixed_inverted_and_normal_modes_are_matched() {
    let n = 20;
    for choice in
        choices(9).into_iter().filter(|c| c.amplitude == Amplitude::Normal && c.phase == Phase::Original)
    {
        let normal = white::<f64>(&whole(n), &choice);
        let fixed = white::<f64>(&whole(n), &Realisation { amplitude: Amplitude::Fixed, ..choice });
        let inverted = white::<f64>(&whole(n), &Realisation { phase: Phase::Inverted, ..choice });
        for (_, at) in modes(&whole(n)).skip(1) {
            let (w, f) = ([normal[at], normal[at + 1]], [fixed[at], fixed[at + 1]]);
            assert_eq!([inverted[at], inverted[at + 1]], w.map(|x| -x));
            let modulus = w[0].hypot(w[1]);
            // As in the native scheme: two roundings of each part of w, one of each product.
            assert!((w[0] * f[1] - w[1] * f[0]).abs() <= 4.5e-16 * modulus);
            assert!(modulus == 0.0 || (f[0].hypot(f[1]) - 1.0).abs() < 4.5e-16);
            assert!(modulus == 0.0 || w[0] * f[0] + w[1] * f[1] > 0.0);
        }
    }
}

#[test]
fn meshes_share_modes() {
    for scheme in [Scheme::NGenIc, Scheme::FastPm] {
        let choice = Realisation { scheme, ..Realisation::new(2024) };
        let fine = white::<f64>(&whole(64), &choice);
        let stride = whole(64).stride();
        for n in [16, 32] {
            let coarse = white::<f64>(&whole(n), &choice);
            for (index, at) in modes(&whole(n)) {
                if index.contains(&(n / 2)) {
                    continue;
                }
                let [i, j, l] = signed(n, index).map(|m| m.rem_euclid(64) as usize);
                let there = 2 * (i * stride[0] + j * stride[1] + l);
                assert!(same_bits(&coarse[at..at + 2], &fine[there..there + 2]), "{n} {index:?}");
            }
        }
    }
}

#[test]
fn without_nyquist_planes_fastpm_has_the_modes_of_ngenic() {
    let choice = Realisation { scheme: Scheme::NGenIc, ..Realisation::new(5) };
    let fast_pm = Realisation { scheme: Scheme::FastPm, ..choice };
    assert!(same_bits(&white::<f64>(&whole(24), &choice), &white::<f64>(&whole(24), &fast_pm)));
}

#[test]
fn every_brick_holds_the_bits_of_the_whole_mesh_on_any_threads() {
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
            fourier([0, 0, 0], [24, 24, 1], [24, 1, 1]),
            fourier([0, 0, 7], [24, 24, 1], [1, 25, 1]),
            fourier([0, 0, 12], [24, 24, 1], [24, 1, 1]),
            fourier([0, 0, 11], [24, 24, 2], [24, 1, 24 * 24]),
            fourier([0, 0, 0], [24, 24, 13], [1, 24, 576]),
            fourier([20, 5, 2], [4, 6, 9], [9, 36, 1]),
            fourier([2, 5, 0], [4, 6, 13], [13 * 3, 12 * 13, 3]),
            fourier([23, 0, 0], [1, 24, 13], [1, 13, 1]),
            fourier([24, 0, 0], [0, 24, 13], [1, 1, 1]),
        ];
        let pools = [1, 2, 5].map(|threads| Threads::new(threads).unwrap());
        for choice in choices(77) {
            let choice = Realisation { selection: Selection::Sphere, sample: 22, ..choice };
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
                let run = |exec: &dyn Exec, simd| {
                    let mut out = vec![T::from_f64(7.0); brick.reals()];
                    draw(&mut out, brick, &choice, None, exec, simd).unwrap();
                    out
                };
                assert!(same_bits(&part, &run(&Serial, Simd::Portable)));
                for pool in &pools {
                    assert!(same_bits(&part, &run(pool, Simd::detect())));
                }
            }
        }
    }
    check::<f64>();
    check::<f32>();
}

#[test]
fn the_selection_leaves_modes_as_they_are_or_zero_in_every_scheme() {
    let n = 18;
    let mut all = choices(3);
    all.push(Realisation { nyquist: Nyquist::Filled, ..Realisation::new(3) });
    all.push(Realisation::new(3));
    for choice in all {
        let mesh = white::<f64>(&whole(n), &choice);
        for (selection, sample) in [
            (Selection::Cube, 0),
            (Selection::Cube, 1),
            (Selection::Cube, 11),
            (Selection::Cube, u32::MAX),
            (Selection::Sphere, 0),
            (Selection::Sphere, 10),
            (Selection::Sphere, 17),
            (Selection::Sphere, 4_000_000_000),
        ] {
            let choice = Realisation { selection, sample, ..choice };
            let part = white::<f64>(&whole(n), &choice);
            let mut imposed = mesh.clone();
            let kept = Realisation { amplitude: Amplitude::Normal, phase: Phase::Original, ..choice };
            impose(&mut imposed, &whole(n), &kept, &Serial).unwrap();
            let reach = if sample == 0 { n as i64 } else { i64::from(sample) } / 2;
            for (index, at) in modes(&whole(n)) {
                let mode = signed(n, index);
                let inside = match selection {
                    Selection::Cube => mode.iter().all(|m| m.abs() <= reach),
                    Selection::Sphere => mode.iter().map(|m| m * m).sum::<i64>() <= reach * reach,
                };
                for at in [at, at + 1] {
                    assert_eq!(
                        bits(part[at]),
                        if inside { bits(mesh[at]) } else { 0 },
                        "{index:?} {choice:?}"
                    );
                    assert_eq!(imposed[at], part[at]);
                }
            }
        }
    }
}

#[test]
fn colouring_multiplies_the_double_precision_mode() {
    let n = 18;
    let table: Vec<f64> = (0..=3 * n * n / 4).map(|s| 3.7 / (1.0 + s as f64)).collect();
    for choice in choices(8) {
        let unit = white::<f64>(&whole(n), &choice);
        let mut double = unit.clone();
        let mut single = vec![0_f32; unit.len()];
        white_modes_coloured(&mut double, &whole(n), &choice, &table, &Serial).unwrap();
        white_modes_coloured(&mut single, &whole(n), &choice, &table, &Serial).unwrap();
        for (index, at) in modes(&whole(n)) {
            let square: i64 = signed(n, index).iter().map(|m| m * m).sum();
            for at in [at, at + 1] {
                let expected = unit[at] * table[square as usize];
                assert_eq!(double[at].to_bits(), expected.to_bits(), "{index:?}");
                assert_eq!(single[at].to_bits(), (expected as f32).to_bits());
            }
        }
    }
}

#[test]
fn nyquist_modes_of_ngenic_are_refused() {
    let choice = Realisation { scheme: Scheme::NGenIc, nyquist: Nyquist::Filled, ..Realisation::new(1) };
    let mut out = vec![7.0; whole(8).reals()];
    assert_eq!(white_modes(&mut out, &whole(8), &choice, &Serial), Err(Error::Choice));
    let last = out.len() - 1;
    let fast_pm = Realisation { scheme: Scheme::FastPm, ..choice };
    assert_eq!(white_modes(&mut out[..last], &whole(8), &fast_pm, &Serial), Err(Error::Length));
    assert!(out.iter().all(|&x| x == 7.0));
}
