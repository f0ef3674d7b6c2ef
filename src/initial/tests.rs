use core::f64::consts::TAU;
use std::vec;
use std::vec::Vec;

use super::lpt::{displacement, second_order_source, second_order_squares};
use super::modes::{copy_modes, scale_by_table};
use super::particles::{Components, Step, displace, particle_ids};
use super::png::{Local, add_local};
use super::tests_whole::{conditions, particles};
use crate::cosmology::mode_table_length;
use crate::exec::{Serial, Threads};
use crate::fft::Fft3;
use crate::mesh::{Brick, Space};
use crate::noise::{Nyquist, Realisation, Scheme};
use crate::reference::convolution::Dense;
use crate::reference::transform::Slow;
use crate::status::Error;

/// Modes of some real field without mean and Nyquist modes: those of a deterministic jumble on the cells.
pub(super) fn jumble(n: usize, salt: u64) -> Vec<f64> {
    let mut fft = Slow::new(n);
    let brick = Brick::whole(n, Space::Fourier).unwrap();
    let mut state = salt.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1;
    let mut data: Vec<f64> = (0..brick.reals())
        .map(|_| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
        })
        .collect();
    fft.forward(&mut data).unwrap();
    let mut ones = vec![1.0; mode_table_length(n).unwrap()];
    ones[0] = 0.0;
    scale_by_table(&mut data, &brick, &ones, &Serial).unwrap();
    data
}

fn png(phi: &[f64], n: usize, local: Local, side: usize) -> Vec<f64> {
    let brick = Brick::whole(n, Space::Fourier).unwrap();
    let mut work = Slow::new(side);
    let mut mesh = vec![0.0; Fft3::<f64>::length(&work)];
    let mut out = phi.to_vec();
    let mut partial = vec![[0.0]; side];
    add_local(&mut out, &brick, local, &mut work, &mut mesh, &mut partial, &Serial).unwrap();
    out
}

#[test]
fn dealiased_square_equals_the_direct_convolution() {
    for (n, side) in [(8, 12), (10, 16), (12, 18), (16, 24)] {
        let phi = jumble(n, 1);
        let gaussian = Dense::from_mesh(&phi, n);
        let square = gaussian.times(&gaussian, gaussian.half);
        let f_nl = 0.37;
        let expected = gaussian.plus(f_nl, &square);
        let actual = Dense::from_mesh(&png(&phi, n, Local { f_nl, g_nl: 0.0 }, side), n);
        // Sums of n^3 products of order one against n^3-point transforms: rounding grows as log n.
        assert!(expected.distance(&actual) < 1e-13, "n = {n}: {}", expected.distance(&actual));
    }
}

#[test]
fn dealiased_cube_equals_the_direct_convolution() {
    for n in [8, 10, 12] {
        cube_equals_the_direct_convolution(n);
    }
}

fn cube_equals_the_direct_convolution(n: usize) {
    let phi = jumble(n, 2);
    let gaussian = Dense::from_mesh(&phi, n);
    let full = gaussian.times(&gaussian, 2 * gaussian.half);
    let mean_square = full.at([0; 3])[0];
    let cube = full.times(&gaussian, gaussian.half);
    let (f_nl, g_nl) = (0.3, -1.7);
    let expected = gaussian.plus(f_nl, &full).plus(g_nl, &cube).plus(-3.0 * g_nl * mean_square, &gaussian);
    let actual = Dense::from_mesh(&png(&phi, n, Local { f_nl, g_nl }, 2 * n), n);
    assert!(expected.distance(&actual) < 1e-13, "{}", expected.distance(&actual));
}

#[test]
fn aliasing_is_real_without_a_work_mesh() {
    let n = 8;
    let phi = jumble(n, 3);
    let local = Local { f_nl: 1.0, g_nl: 0.0 };
    let clean = Dense::from_mesh(&png(&phi, n, local, 12), n);
    let aliased = Dense::from_mesh(&png(&phi, n, local, n), n);
    assert!(clean.distance(&aliased) > 1e-3);
}

#[test]
fn png_adds_a_zero_mean_quadratic_term() {
    let n = 8;
    let phi = jumble(n, 4);
    for side in [8, 12] {
        let one = png(&phi, n, Local { f_nl: 1.0, g_nl: 0.0 }, side);
        let two = png(&phi, n, Local { f_nl: 2.0, g_nl: 0.0 }, side);
        assert_eq!(one[0..2], [0.0; 2], "mean");
        assert_eq!(png(&phi, n, Local::default(), side), phi, "f_NL = 0 keeps the bits");
        let doubled: Vec<f64> = phi.iter().map(|v| 2.0 * v).collect();
        let quadratic = png(&doubled, n, Local { f_nl: 1.0, g_nl: 0.0 }, side);
        for i in 0..phi.len() {
            let term = one[i] - phi[i];
            assert!((two[i] - phi[i] - 2.0 * term).abs() < 1e-12 * n as f64);
            assert!((quadratic[i] - 2.0 * phi[i] - 4.0 * term).abs() < 1e-12 * n as f64);
        }
    }
}

#[test]
fn inverted_pair_shares_the_quadratic_term_and_flips_the_rest() {
    let n = 8;
    let phi = jumble(n, 5);
    let minus: Vec<f64> = phi.iter().map(|v| -v).collect();
    let local = Local { f_nl: 0.8, g_nl: 0.5 };
    let (original, inverted) = (png(&phi, n, local, 16), png(&minus, n, local, 16));
    let square = png(&phi, n, Local { f_nl: 0.8, g_nl: 0.0 }, 16);
    let scale = original.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
    for i in 0..phi.len() {
        let even = 0.5 * (original[i] + inverted[i]);
        assert!(
            (even - (square[i] - phi[i])).abs() < 1e-13 * scale,
            "the even part is f_NL (Phi^2 - <Phi^2>)"
        );
    }
}

#[test]
fn half_dealiased_meshes_are_refused() {
    let brick = Brick::whole(8, Space::Fourier).unwrap();
    let mut phi = jumble(8, 6);
    let before = phi.clone();
    let mut mesh = vec![0.0; 14 * 14 * 16];
    for (side, local) in [(10, Local { f_nl: 1.0, g_nl: 0.0 }), (14, Local { f_nl: 1.0, g_nl: 1.0 })] {
        let mut work = Slow::new(side);
        let refused = add_local(&mut phi, &brick, local, &mut work, &mut mesh, &mut [[0.0]; 16], &Serial);
        assert_eq!(refused, Err(Error::Brick));
    }
    let nan = Local { f_nl: f64::NAN, g_nl: 0.0 };
    let refused = add_local(&mut phi, &brick, nan, &mut Slow::new(12), &mut mesh, &mut [[0.0]; 16], &Serial);
    assert_eq!(refused, Err(Error::NotFinite));
    assert_eq!(phi, before);
}

#[test]
fn modes_survive_padding_and_layouts() {
    let (small, large) =
        (Brick::whole(8, Space::Fourier).unwrap(), Brick::whole(12, Space::Fourier).unwrap());
    let field = jumble(8, 7);
    let mut padded = vec![f64::NAN; large.reals()];
    copy_modes(&mut padded, &large, &field, &small, &Serial).unwrap();
    assert!(padded.iter().all(|v| v.is_finite()), "modes that only the larger mesh has are zero");
    let mut back = vec![f64::NAN; small.reals()];
    copy_modes(&mut back, &small, &padded, &large, &Serial).unwrap();
    assert_eq!(back, field);

    let columns = Brick::general(8, Space::Fourier, [0; 3], [8, 8, 5], [1, 8, 64]).unwrap();
    let mut turned = vec![0.0; columns.reals()];
    copy_modes(&mut turned, &columns, &field, &small, &Serial).unwrap();
    let mut again = vec![0.0; large.reals()];
    copy_modes(&mut again, &large, &turned, &columns, &Serial).unwrap();
    assert_eq!(again, padded);

    let slab = Brick::slab(8, Space::Fourier, 0, 4).unwrap();
    assert_eq!(copy_modes(&mut back, &small, &field, &slab, &Serial), Err(Error::Brick));
    assert_eq!(copy_modes(&mut back[1..], &small, &field, &small, &Serial), Err(Error::Length));
}

/// delta(q) on the cells, as modes.
fn density(n: usize, delta: impl Fn([f64; 3]) -> f64) -> Vec<f64> {
    let mut fft = Slow::new(n);
    let brick = Brick::whole(n, Space::Configuration).unwrap();
    let mut data = vec![0.0; Fft3::<f64>::length(&fft)];
    for at in 0..n * n * n {
        let q = [at / (n * n), at / n % n, at % n];
        let place: usize = (0..3).map(|a| q[a] * brick.stride()[a]).sum();
        data[place] = delta(q.map(|i| TAU * i as f64 / n as f64)) / (n * n * n) as f64;
    }
    fft.forward(&mut data).unwrap();
    data
}

/// Largest distance of a field on the cells from a function of the angle 2 pi q/L.
fn worst(n: usize, data: &[f64], expected: impl Fn([f64; 3]) -> f64) -> f64 {
    let brick = Brick::whole(n, Space::Configuration).unwrap();
    (0..n * n * n).fold(0.0_f64, |worst, at| {
        let q = [at / (n * n), at / n % n, at % n];
        let place: usize = (0..3).map(|a| q[a] * brick.stride()[a]).sum();
        worst.max((data[place] - expected(q.map(|i| TAU * i as f64 / n as f64))).abs())
    })
}

#[test]
fn first_order_of_a_plane_wave_is_exact() {
    // delta = A cos(k.q) has Psi1 = -A k/k^2 sin(k.q); in units of L/(2 pi), k -> n.
    let n = 12;
    let wave = [2.0, -1.0, 3.0];
    let square: f64 = wave.iter().map(|k| k * k).sum();
    let phase = |q: [f64; 3]| q[0] * wave[0] + q[1] * wave[1] + q[2] * wave[2];
    let modes = density(n, |q| 0.1 * libm::cos(phase(q)));
    let brick = Brick::whole(n, Space::Fourier).unwrap();
    let mut out = vec![0.0; brick.reals()];
    for axis in 0..3 {
        displacement(&mut out, &modes, &brick, axis, 1.0, &mut Slow::new(n), &Serial).unwrap();
        let error = worst(n, &out, |q| -0.1 * wave[axis] / square * libm::sin(phase(q)));
        assert!(error < 1e-15, "a few roundings of 0.1: {error}");
    }
}

#[test]
fn second_order_of_crossed_waves_is_exact() {
    // delta = A cos(a q_x) + B cos(b q_y): S = A B cos(a q_x) cos(b q_y), and grad inverse-Laplacian of it by hand.
    let n = 12;
    let (a, b, amplitude_a, amplitude_b) = (2.0, 3.0, 0.3, 0.2);
    let modes = density(n, |q| amplitude_a * libm::cos(a * q[0]) + amplitude_b * libm::cos(b * q[1]));
    let brick = Brick::whole(n, Space::Fourier).unwrap();
    let size = brick.reals();
    for side in [12, 18] {
        let mut work = Slow::new(side);
        let length = Fft3::<f64>::length(&work);
        let (mut one, mut two, mut three) = (vec![0.0; length], vec![0.0; length], vec![0.0; length]);
        let mut source = vec![0.0; size];
        let meshes = [&mut one[..], &mut two[..], &mut three[..]];
        second_order_source(&mut source, &modes, &brick, &mut work, meshes, &Serial).unwrap();
        let ratio = -3.0 / 7.0;
        let mut psi = vec![0.0; size];
        let product = amplitude_a * amplitude_b / (a * a + b * b);
        for axis in 0..3 {
            displacement(&mut psi, &source, &brick, axis, -ratio, &mut Slow::new(n), &Serial).unwrap();
            let error = worst(n, &psi, |q| {
                ratio
                    * product
                    * match axis {
                        0 => a * libm::sin(a * q[0]) * libm::cos(b * q[1]),
                        1 => b * libm::cos(a * q[0]) * libm::sin(b * q[1]),
                        _ => 0.0,
                    }
            });
            assert!(error < 1e-16, "side {side}, axis {axis}: {error}");
        }
    }
}

#[test]
fn dealiased_second_order_equals_the_direct_convolution() {
    for (n, side) in [(8, 12), (12, 18), (16, 24)] {
        second_order_equals_the_direct_convolution(n, side);
    }
}

fn second_order_equals_the_direct_convolution(n: usize, side: usize) {
    let modes = jumble(n, 8);
    let brick = Brick::whole(n, Space::Fourier).unwrap();
    let delta = Dense::from_mesh(&modes, n);
    let tidal = |a: usize, b: usize| {
        delta.map(move |k| {
            let square = k[0] * k[0] + k[1] * k[1] + k[2] * k[2];
            if square == 0.0 { 0.0 } else { k[a] * k[b] / square }
        })
    };
    let mut expected = Dense::zero(delta.half);
    for (a, b) in [(0, 1), (0, 2), (1, 2)] {
        expected = expected.plus(1.0, &tidal(a, a).times(&tidal(b, b), delta.half));
        expected = expected.plus(-1.0, &tidal(a, b).times(&tidal(a, b), delta.half));
    }
    let mut work = Slow::new(side);
    let length = Fft3::<f64>::length(&work);
    let mut meshes = vec![0.0; 3 * length];
    let (one, rest) = meshes.split_at_mut(length);
    let (two, three) = rest.split_at_mut(length);
    let mut source = vec![0.0; brick.reals()];
    second_order_source(&mut source, &modes, &brick, &mut work, [one, two, three], &Serial).unwrap();
    assert!(expected.distance(&Dense::from_mesh(&source, n)) < 1e-13);
    let (one, rest) = meshes.split_at_mut(length);
    second_order_squares(&modes, &brick, &mut work, [&mut *one, rest], &Serial).unwrap();
    copy_modes(&mut source, &brick, one, &Brick::whole(side, Space::Fourier).unwrap(), &Serial).unwrap();
    source.iter_mut().for_each(|v| *v /= (side * side * side) as f64);
    assert!(expected.distance(&Dense::from_mesh(&source, n)) < 1e-13, "the way with one mesh less");
}

#[test]
fn particles_do_not_depend_on_the_decomposition() {
    let n = 6;
    let box_size = 100.0;
    let whole = Brick::whole(n, Space::Configuration).unwrap();
    let psi1: Vec<f64> = (0..whole.reals()).map(|i| 250.0 * libm::sin(i as f64)).collect();
    let psi2: Vec<f64> = (0..whole.reals()).map(|i| libm::cos(i as f64)).collect();
    let step = Step { box_size, first_velocity: 3.0, second_velocity: 5.0 };
    let move_all = |brick: &Brick, first: usize, threads: usize| {
        let pool = Threads::new(threads).unwrap();
        let count = brick.elements();
        let (mut x, mut v) = (vec![0.0; 3 * count], vec![0.0; 3 * count]);
        for axis in 0..3 {
            let (x, v) =
                (&mut Components::triples(&mut x).unwrap(), &mut Components::triples(&mut v).unwrap());
            displace(x, v, &psi1[first..], Some(&psi2[first..]), brick, axis, &step, &pool).unwrap();
        }
        let mut ids = vec![0; count];
        particle_ids(&mut ids, brick, 1, &pool).unwrap();
        (x, v, ids)
    };
    let all = move_all(&whole, 0, 1);
    assert!(all.0.iter().all(|x| (0.0..box_size).contains(x)), "wrapped, even far outside");
    assert_eq!(all.2, (1..=216).collect::<Vec<u64>>());
    for threads in [2, 5] {
        assert_eq!(move_all(&whole, 0, threads), all);
    }
    let slab = Brick::slab(n, Space::Configuration, 2, 3).unwrap();
    let part = move_all(&slab, 2 * whole.stride()[0], 2);
    let range = 2 * 36 * 3..5 * 36 * 3;
    assert_eq!((&part.0[..], &part.1[..]), (&all.0[range.clone()], &all.1[range]));
    assert_eq!(part.2, all.2[2 * 36..5 * 36]);

    let (mut x, mut v) = (vec![0.0; 3 * 216], vec![0.0; 3 * 216]);
    let (x0, x1) = x.split_at_mut(216);
    let (x1, x2) = x1.split_at_mut(216);
    let (v0, v1) = v.split_at_mut(216);
    let (v1, v2) = v1.split_at_mut(216);
    let (mut separate, mut speeds) =
        (Components::separate([x0, x1, x2]).unwrap(), Components::separate([v0, v1, v2]).unwrap());
    for axis in 0..3 {
        displace(&mut separate, &mut speeds, &psi1, Some(&psi2), &whole, axis, &step, &Serial).unwrap();
    }
    for i in 0..216 {
        for axis in 0..3 {
            assert_eq!((x[axis * 216 + i], v[axis * 216 + i]), (all.0[3 * i + axis], all.1[3 * i + axis]));
        }
    }
}

#[test]
fn positions_never_reach_the_far_edge() {
    let brick = Brick::whole(2, Space::Configuration).unwrap();
    for lost in [1e20_f32, -1e22] {
        let (mut x, mut v) = ([0.0_f32; 24], [0.0_f32; 24]);
        let step = Step { box_size: 100.0, first_velocity: 1.0, second_velocity: 0.0 };
        let (x, v) = (&mut Components::triples(&mut x).unwrap(), &mut Components::triples(&mut v).unwrap());
        assert_eq!(displace(x, v, &[lost; 16], None, &brick, 0, &step, &Serial), Err(Error::NotFinite));
        let step = Step { box_size: 1e-60, ..step };
        assert_eq!(displace(x, v, &[0.0; 16], None, &brick, 0, &step, &Serial), Err(Error::Range));
    }
    for shift in [-1e-30_f32, -1e-9, 1e-9, 99.999_999, 100.0, -100.0, 12_345.6, -12_345.6, 0.0] {
        let psi = [shift; 16];
        let (mut x, mut v) = ([0.0_f32; 24], [0.0_f32; 24]);
        let step = Step { box_size: 100.0, first_velocity: 1.0, second_velocity: 0.0 };
        {
            let (x, v) =
                (&mut Components::triples(&mut x).unwrap(), &mut Components::triples(&mut v).unwrap());
            displace(x, v, &psi, None, &brick, 0, &step, &Serial).unwrap();
        }
        assert!(x.iter().all(|x| (0.0..100.0).contains(x)), "{shift}: {x:?}");
    }
    let (mut x, mut v) = ([0.0_f32; 24], [0.0_f32; 24]);
    let step = Step { box_size: 100.0, first_velocity: 1.0, second_velocity: 0.0 };
    let (x, v) = (&mut Components::triples(&mut x).unwrap(), &mut Components::triples(&mut v).unwrap());
    assert_eq!(displace(x, v, &[f32::NAN; 16], None, &brick, 0, &step, &Serial), Err(Error::NotFinite));
    assert_eq!(displace(x, v, &[0.0; 16], None, &brick, 3, &step, &Serial), Err(Error::Range));
    assert_eq!(displace(x, v, &[0.0; 3], None, &brick, 0, &step, &Serial), Err(Error::Length));
}

#[test]
fn the_one_call_has_no_nyquist_modes_whatever_is_asked() {
    for scheme in [Scheme::Native, Scheme::NGenIc, Scheme::FastPm] {
        let of = |nyquist| {
            let realisation = Realisation { scheme, nyquist, ..Realisation::new(3) };
            particles::<f64>(8, &conditions(realisation, 100.0), &Serial, false)
        };
        assert!(of(Nyquist::Zero) == of(Nyquist::Filled), "{scheme:?}");
    }
}
