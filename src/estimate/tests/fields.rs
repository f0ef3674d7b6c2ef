//! Fields whose spectra are known.

use core::f64::consts::TAU;
use std::vec::Vec;

use super::*;
use crate::estimate::binning::Second;
use crate::estimate::correlation::{
    correlation_modes, correlation_modes_scratch, correlation_sums, correlation_sums_scratch,
};
use crate::mesh::Space;
use crate::status::Error;

fn wave(n: usize, k: [i64; 3], x: [usize; 3]) -> f64 {
    let phase: i64 = (0..3).map(|a| k[a] * x[a] as i64).sum();
    libm::cos(TAU * phase as f64 / n as f64)
}

#[test]
fn a_plane_wave_is_one_pair_of_modes() {
    let n = 12;
    let (amplitude, k) = (3.0, [2, -1, 3]);
    let modes = modes_of(n, |x| amplitude * wave(n, k, x));
    let edges = unit_shells(1, 6);
    let binning = Binning { orders: 0b10101, ..Binning::shells(&edges) };
    let (bins, power) = spectrum(&modes, n, Compensation::None, &binning);
    // |n|^2 = 14 is the third shell; mu^2 = 9/14; each of the two modes is A/2.
    let m: f64 = 9.0 / 14.0;
    let legendre = [1.0, (3.0 * m - 1.0) / 2.0, (35.0 * m * m - 30.0 * m + 3.0) / 8.0];
    for (b, power) in power.chunks_exact(3).enumerate() {
        for (i, value) in power.iter().enumerate() {
            let expected =
                (4 * i + 1) as f64 * amplitude * amplitude / 2.0 * legendre[i] / bins[2].count as f64;
            let expected = if b == 2 { expected } else { 0.0 };
            assert!((value - expected).abs() < 1e-14, "{b} {i}: {value} {expected}");
        }
    }
}

#[test]
fn white_noise_has_flat_power_with_the_gaussian_scatter() {
    let n = 48;
    let modes = random_modes(n, 77);
    let edges = unit_shells(1, 25);
    let (bins, power) = spectrum(&modes, n, Compensation::None, &Binning::shells(&edges));
    // Variance 1/3 a cell, n^3 cells; un-normalised modes.
    let expected = (n * n * n) as f64 / 3.0;
    let pulls: Vec<f64> = bins
        .iter()
        .zip(power)
        .map(|(bin, power)| (power / expected - 1.0) / (2.0 / bin.count as f64).sqrt())
        .collect();
    let chi_square: f64 = pulls.iter().map(|pull| pull * pull).sum();
    // 24 bins: 24 +- 7; three sigma.
    assert!((3.0..45.0).contains(&chi_square), "{chi_square}");
}

/// The modes of a field with |f_k|^2 = (1 + beta mu^2)^2 at all modes but Nyquist and the mean.
fn kaiser(n: usize, beta: f64, axis: [f64; 3]) -> Vec<f64> {
    let brick = *serial::<f64>(n).fourier();
    let mut modes = vec![0.0; brick.reals()];
    let stride = brick.stride();
    let mut next = noise(3);
    for i in 0..n {
        for j in 0..n {
            for l in 0..n / 2 {
                let k = [Brick::mode(n, i), Brick::mode(n, j), l as i64].map(|m| m as f64);
                let square: f64 = k.iter().map(|k| k * k).sum();
                let length: f64 = axis.iter().map(|a| a * a).sum();
                let along: f64 = k.iter().zip(axis).map(|(k, a)| k * a).sum();
                if square > 0.0 {
                    let amplitude = 1.0 + beta * along * along / (square * length);
                    // Phases do not matter to an auto spectrum.
                    let phase = TAU * next();
                    let at = 2 * (i * stride[0] + j * stride[1] + l);
                    modes[at] = amplitude * libm::cos(phase);
                    modes[at + 1] = amplitude * libm::sin(phase);
                }
            }
        }
    }
    modes
}

#[test]
fn a_kaiser_field_has_kaisers_multipoles_about_any_axis() {
    let n = 48;
    let beta = 0.7;
    let expected = [
        1.0 + 2.0 * beta / 3.0 + beta * beta / 5.0,
        4.0 * beta / 3.0 + 4.0 * beta * beta / 7.0,
        8.0 * beta * beta / 35.0,
    ];
    for axis in [[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, -5.0, 0.0], [1.0, 1.0, 1.0], [0.2, -0.7, 0.4]] {
        let binning = Binning { edges: &[100, 500], second: Second::None, axis, orders: 0b10101 };
        let (bins, power) = spectrum(&kaiser(n, beta, axis), n, Compensation::None, &binning);
        assert!(bins[0].count > 40_000);
        for ((power, expected), order) in power.iter().zip(expected).zip([0, 2, 4]) {
            // Amplitudes are fixed, so there is no sample variance. <mu^2> over a shell is 1/3 by cubic symmetry; what is left is
            // that <L_4> and beyond do not vanish over the lattice points of a shell: 6e-4 here, times 2 beta (2l + 1).
            let tolerance = 1e-3 * f64::from(2 * order + 1);
            assert!((power - expected).abs() < tolerance, "{axis:?}: {power} {expected}");
        }
    }
}

#[test]
fn a_field_moved_along_the_axis_gives_a_positive_dipole() {
    let n = 32;
    for (axis, step) in
        [([0.0, 0.0, 1.0], [0, 0, 1]), ([0.0, 2.0, 0.0], [0, 1, 0]), ([-1.0, 0.0, 0.0], [n - 1, 0, 0])]
    {
        let mut fft = serial::<f64>(n);
        let stride = fft.configuration().stride();
        let mut next = noise(8);
        let cells: Vec<f64> = (0..n * n * n).map(|_| next()).collect();
        let at = |x: [usize; 3]| cells[(x[0] * n + x[1]) * n + x[2]];
        let (mut f, mut g) = (vec![0.0; fft.length()], vec![0.0; fft.length()]);
        for x in 0..n {
            for y in 0..n {
                for z in 0..n {
                    let back = [0, 1, 2].map(|a| ([x, y, z][a] + n - step[a]) % n);
                    f[x * stride[0] + y * stride[1] + z] = at([x, y, z]);
                    g[x * stride[0] + y * stride[1] + z] = at(back);
                }
            }
        }
        fft.forward(&mut f).unwrap();
        fft.forward(&mut g).unwrap();
        let edges = [9, 16, 25, 36];
        let binning = Binning { edges: &edges, second: Second::None, axis, orders: 0b01011 };
        let none = [Compensation::None; 2];
        let words = sums(&[&f, &g], &[[0, 1], [1, 0], [0, 0]], &none, fft.fourier(), &binning, &Serial);
        let (bins, mut power) = read(&words, &binning, 3);
        normalise(&mut power, &bins, binning.orders, 1.0).unwrap();
        for (b, bin) in bins.iter().enumerate() {
            // g_k = f_k exp(-i k.d), d one cell: the mean of sin(kd mu) L_1 over the sphere is j_1(kd), that of L_3 is -j_3.
            let x = TAU * bin.first / n as f64;
            let j1 = libm::sin(x) / (x * x) - libm::cos(x) / x;
            let j3 =
                (15.0 / (x * x * x) - 6.0 / x) * libm::sin(x) / x - (15.0 / (x * x) - 1.0) * libm::cos(x) / x;
            let auto = power[(2 * 3 + b) * 3];
            let [_, dipole, octupole] = [0, 1, 2].map(|l| power[b * 3 + l] / auto);
            let dipole_scatter = 3.0 * (1.0 / bin.count as f64).sqrt();
            assert!((dipole - 3.0 * j1).abs() < dipole_scatter, "{dipole} {j1}");
            assert!(dipole > 0.0);
            // Sin(kd mu) = sum (2l + 1) (-1)^((l-1)/2) j_l L_l over odd l.
            assert!((octupole + 7.0 * j3).abs() < 7.0 * dipole_scatter, "{octupole} {j3}");
            let turned = power[(3 + b) * 3 + 1];
            assert!((turned + dipole * auto).abs() < 1e-10 * auto, "the other order has the other sign");
            assert_eq!(power[(2 * 3 + b) * 3 + 1], 0.0, "an auto spectrum has no dipole");
        }
    }
}

#[test]
fn wedges_hold_all_modes_of_their_shell_and_no_nan() {
    let n = 16;
    let modes = random_modes(n, 2);
    let edges = unit_shells(0, 15);
    let tenths: Vec<f64> = (0..=10).map(|c| f64::from(c) / 10.0).collect();
    for axis in [[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [3.0, 0.0, 4.0]] {
        let shells = Binning { axis, ..Binning::shells(&edges) };
        let wedges = Binning { second: Second::Cosine(&tenths), ..shells };
        let brick = *serial::<f64>(n).fourier();
        let of = |binning: &Binning<'_>| {
            let words = sums(&[&modes[..]], &[[0, 0]], &[Compensation::None], &brick, binning, &Serial);
            read(&words, binning, 1)
        };
        let ((bins, power), (parts, mut shares)) = (of(&shells), of(&wedges));
        assert_eq!(bins.iter().map(|bin| bin.count).sum::<u64>(), 16 * 16 * 16);
        for (b, bin) in bins.iter().enumerate() {
            let wedge = b * 10..(b + 1) * 10;
            assert_eq!(bin.count, parts[wedge.clone()].iter().map(|part| part.count).sum::<u64>());
            let sum: f64 = shares[wedge].iter().sum();
            assert!((sum - power[b]).abs() <= 1e-13 * power[b]);
        }
        normalise(&mut shares, &parts, 1, 1.0).unwrap();
        assert!(parts.iter().any(|part| part.count == 0) && shares.iter().all(|p| p.is_finite()));
        let in_wedge = |c: usize, part: &Bin| {
            part.count == 0 || (tenths[c] - 1e-12..=tenths[c + 1]).contains(&part.second)
        };
        assert!(parts.iter().enumerate().all(|(b, part)| in_wedge(b % 10, part)));
    }
    // The mode (3, 0, 4) about z has mu = 4/5, a lower edge; (0, 0, 5) has mu = 1, the last edge.
    let binning = Binning { second: Second::Cosine(&[0.0, 0.6, 0.8, 1.0]), ..Binning::shells(&[25, 26]) };
    let words =
        sums(&[&modes[..]], &[[0, 0]], &[Compensation::None], serial::<f64>(n).fourier(), &binning, &Serial);
    let (parts, _) = read(&words, &binning, 1);
    assert_eq!(parts.iter().map(|part| part.count).collect::<Vec<_>>(), [12, 8, 10]);
}

#[test]
fn bins_of_k_perp_and_k_par_hold_all_modes() {
    let n = 12;
    let modes = random_modes(n, 6);
    let edges = [0, 1, 5, 30, 73];
    let parallel = [0.0, 1.0, 2.0, 7.0];
    let binning = Binning { second: Second::Parallel(&parallel), ..Binning::shells(&edges) };
    let (bins, _) = spectrum(&modes, n, Compensation::None, &binning);
    assert_eq!(bins.iter().map(|bin| bin.count).sum::<u64>(), 12 * 12 * 12);
    assert_eq!(bins[1].count, 2, "n_perp = 0 and n_z = +-1");
    assert_eq!((bins[1].first, bins[1].second), (0.0, 1.0));
}

#[test]
fn a_plane_wave_correlates_as_a_plane_wave() {
    let n = 12;
    let k = [1, -2, 2];
    let mut fft = serial::<f64>(n);
    let brick = *fft.fourier();
    let mut modes = modes_of(n, |x| 2.0 * wave(n, k, x) + 5.0);
    let scratch = memory(correlation_modes_scratch(&brick).unwrap());
    correlation_modes(&mut modes, None, [Compensation::None; 2], 1.0, &brick, scratch, &Serial).unwrap();
    fft.inverse(&mut modes).unwrap();
    let stride = fft.configuration().stride();
    for x in [[0, 0, 0], [1, 5, 3], [11, 2, 7]] {
        let xi = modes[x[0] * stride[0] + x[1] * stride[1] + x[2]];
        assert!((xi - 2.0 * wave(n, k, x)).abs() < 1e-13, "A^2/2 cos k.x, and no trace of the mean");
    }
}

/// xi of f and g in bins of separation.
fn correlate(n: usize, f: &[f64], g: Option<&[f64]>, binning: &Binning<'_>) -> (Vec<Bin>, Vec<f64>) {
    let mut fft = serial::<f64>(n);
    let brick = *fft.fourier();
    let mut modes = f.to_vec();
    let scratch = memory(correlation_modes_scratch(&brick).unwrap());
    correlation_modes(&mut modes, g, [Compensation::None; 2], 1.0, &brick, scratch, &Serial).unwrap();
    fft.inverse(&mut modes).unwrap();
    let cells = *fft.configuration();
    let mut words = vec![0; binning.words(1).unwrap()];
    let scratch = memory(correlation_sums_scratch(&cells, binning, 1).unwrap());
    correlation_sums(&mut words, &[&modes], &cells, binning, scratch, &Serial).unwrap();
    let (bins, mut xi) = read(&words, binning, 1);
    normalise(&mut xi, &bins, binning.orders, 1.0).unwrap();
    (bins, xi)
}

#[test]
fn correlation_functions_are_the_mean_products_of_cells() {
    let n = 8;
    let mut next = noise(21);
    let mut draw = || {
        let cells: Vec<f64> = (0..n * n * n).map(|_| next()).collect();
        let mean = cells.iter().sum::<f64>() / cells.len() as f64;
        cells.iter().map(|x| x - mean).collect::<Vec<f64>>()
    };
    let (f, g) = (draw(), draw());
    let at = |x: [usize; 3]| (x[0] % n * n + x[1] % n) * n + x[2] % n;
    let [f_modes, g_modes] = [&f, &g].map(|cells| modes_of(n, |x| cells[at(x)]));
    let edges = [0, 1, 2, 3, 6, 20];
    let axis = [0.5, 1.0, 0.0];
    let binning = Binning { edges: &edges, second: Second::None, axis, orders: 0b10111 };
    for (other, g, g_modes) in [(false, &f, None), (true, &g, Some(&g_modes[..]))] {
        let (bins, xi) = correlate(n, &f_modes, g_modes, &binning);
        let mut slow = vec![0.0; bins.len() * 4];
        for m in 0..n * n * n {
            let m = [m / (n * n), m / n % n, m % n];
            let mut product = 0.0;
            for y in 0..n * n * n {
                let y = [y / (n * n), y / n % n, y % n];
                product += f[at([0, 1, 2].map(|a| y[a] + m[a]))] * g[at(y)] / (n * n * n) as f64;
            }
            let r = m.map(|i| Brick::mode(n, i) as f64);
            let square: f64 = r.iter().map(|x| x * x).sum();
            let length = 1.25_f64.sqrt();
            let mu = (r[0] * 0.5 + r[1]) / length / square.max(1.0).sqrt();
            let polynomials =
                [1.0, mu, (3.0 * mu * mu - 1.0) / 2.0, (35.0 * mu.powi(4) - 30.0 * mu * mu + 3.0) / 8.0];
            let Some(b) = (0..bins.len()).find(|&b| (edges[b]..edges[b + 1]).contains(&(square as u64)))
            else {
                continue;
            };
            for (l, polynomial) in polynomials.into_iter().enumerate() {
                let order = [0, 1, 2, 4][l];
                slow[b * 4 + l] += f64::from(2 * order + 1) * product * polynomial / bins[b].count as f64;
            }
        }
        for (a, b) in xi.iter().zip(slow) {
            assert!((a - b).abs() < 1e-13, "{other}: {a} {b}");
        }
    }
}

#[test]
fn bad_correlations_are_refused() {
    let brick = Brick::whole(4, Space::Fourier).unwrap();
    let mut modes = vec![1.0; brick.reals()];
    let scratch = memory(correlation_modes_scratch(&brick).unwrap());
    let none = [Compensation::None; 2];
    let run = |modes: &mut [f64], scale, brick: &Brick, scratch: &mut [u8]| {
        correlation_modes(modes, None, none, scale, brick, scratch, &Serial)
    };
    let cells = Brick::whole(4, Space::Configuration).unwrap();
    assert_eq!(run(&mut modes, 1.0, &cells, scratch), Err(Error::Brick));
    assert_eq!(run(&mut modes, f64::NAN, &brick, scratch), Err(Error::NotFinite));
    assert_eq!(run(&mut modes[1..], 1.0, &brick, scratch), Err(Error::Length));
    assert_eq!(run(&mut modes, 1.0, &brick, &mut []), Err(Error::Scratch));
    assert!(modes.iter().all(|&x| x == 1.0));
}
