//! Poisson particles: their noise is flat where the compensation is right.

use core::f64::consts::PI;
use std::vec::Vec;

use super::*;
use crate::estimate::power::{shot_noise, subtract_shot_noise};
use crate::pm::Window;
use crate::status::Error;

/// The B-spline of the window at a distance of x cells.
fn spline(window: Window, x: f64) -> f64 {
    let x = x.abs();
    match window {
        Window::NearestGridPoint => f64::from(x < 0.5),
        Window::CloudInCell => (1.0 - x).max(0.0),
        Window::TriangularShapedCloud if x < 0.5 => 0.75 - x * x,
        Window::TriangularShapedCloud => (1.5 - x).max(0.0).powi(2) / 2.0,
        Window::PiecewiseCubicSpline if x < 1.0 => (4.0 - 6.0 * x * x + 3.0 * x * x * x) / 6.0,
        Window::PiecewiseCubicSpline => (2.0 - x).max(0.0).powi(3) / 6.0,
    }
}

/// The overdensity of particles at positions in cells, moved by `shift` cells first; un-normalised modes.
fn deposit(n: usize, particles: &[[f64; 3]], shift: f64, window: Window) -> Vec<f64> {
    let mut fft = serial::<f64>(n);
    let stride = fft.configuration().stride();
    let mut mesh = vec![0.0; fft.length()];
    let mean = particles.len() as f64 / (n * n * n) as f64;
    for position in particles {
        let axes = position.map(|u| {
            let u = u + shift;
            core::array::from_fn::<_, 5, _>(|c| {
                let cell = libm::floor(u) as i64 + c as i64 - 2;
                (cell.rem_euclid(n as i64) as usize, spline(window, u - cell as f64))
            })
        });
        for (x, wx) in axes[0] {
            for (y, wy) in axes[1] {
                for (z, wz) in axes[2] {
                    mesh[x * stride[0] + y * stride[1] + z] += wx * wy * wz / mean;
                }
            }
        }
    }
    fft.forward(&mut mesh).unwrap();
    mesh
}

fn poisson(n: usize, count: usize, seed: u64) -> Vec<[f64; 3]> {
    let mut next = noise(seed);
    (0..count).map(|_| [(); 3].map(|()| (next() + 1.0) / 2.0 * n as f64)).collect()
}

/// Mean of P V^-1 N over modes in a range, and its standard error for Gaussian modes.
fn ratio(modes: &[f64], n: usize, count: usize, compensation: Compensation, edges: [u64; 2]) -> (f64, f64) {
    let (bins, power) = spectrum(modes, n, compensation, &Binning::shells(&edges));
    let scale = (n as f64).powi(-6) * count as f64;
    (power[0] * scale, (2.0 / bins[0].count as f64).sqrt())
}

#[test]
fn poisson_noise_is_flat_to_the_nyquist_frequency_with_c1() {
    let (n, count) = (48, 60_000);
    let particles = poisson(n, count, 5);
    for window in Window::ALL {
        let modes = deposit(n, &particles, 0.0, window);
        for edges in [[1, 64], [64, 256], [256, 441], [441, 576]] {
            let (ratio, error) = ratio(&modes, n, count, Compensation::Aliased(window), edges);
            assert!((ratio - 1.0).abs() < 3.5 * error, "{window:?} {edges:?}: {ratio} +- {error}");
        }
        // A control: the other compensations are not flat there.
        if window != Window::NearestGridPoint {
            let none = ratio(&modes, n, count, Compensation::None, [441, 576]);
            assert!(none.0 < 1.0 - 10.0 * none.1);
        }
        if matches!(window, Window::NearestGridPoint | Window::CloudInCell) {
            let sinc = ratio(&modes, n, count, Compensation::Window(window), [441, 576]);
            assert!(sinc.0 > 1.0 + 10.0 * sinc.1);
        }
    }
}

#[test]
fn interlaced_noise_is_flat_with_the_window_itself() {
    let (n, count) = (48, 60_000);
    let particles = poisson(n, count, 6);
    let brick = *serial::<f64>(n).fourier();
    for window in [Window::TriangularShapedCloud, Window::PiecewiseCubicSpline] {
        let mut modes = deposit(n, &particles, 0.0, window);
        let shifted = deposit(n, &particles, 0.5, window);
        let stride = brick.stride();
        for i in 0..n {
            for j in 0..n {
                for l in 0..=n / 2 {
                    let sum = Brick::mode(n, i) + Brick::mode(n, j) + l as i64;
                    // Half a cell back: exp(+i k.d) with d = H/2 on each axis.
                    let phase = PI * sum as f64 / n as f64;
                    let (cos, sin) = (libm::cos(phase), libm::sin(phase));
                    let at = 2 * (i * stride[0] + j * stride[1] + l);
                    let [re, im] = [shifted[at], shifted[at + 1]];
                    modes[at] = (modes[at] + re * cos - im * sin) / 2.0;
                    modes[at + 1] = (modes[at + 1] + re * sin + im * cos) / 2.0;
                }
            }
        }
        // To 0.75 of the Nyquist frequency the even images that are left add less than 1% of the noise of these windows.
        for edges in [[1, 64], [64, 196], [196, 324]] {
            let (ratio, error) = ratio(&modes, n, count, Compensation::Window(window), edges);
            assert!((ratio - 1.0).abs() < 3.5 * error + 0.005, "{window:?} {edges:?}: {ratio} +- {error}");
        }
    }
}

#[test]
fn shot_noise_is_v_over_n_and_subtracted_from_auto_monopoles_alone() {
    assert_eq!(shot_noise::<f64>(None, 50, 10.0), Ok(20.0));
    assert_eq!(shot_noise(Some(&[2.0_f32; 50]), 50, 10.0), Ok(20.0));
    // (1 + 9)/(1 + 3)^2.
    assert_eq!(shot_noise(Some(&[1.0, 3.0]), 2, 2.0), Ok(5.0));
    assert_eq!(shot_noise(Some(&[1.0, -1.0]), 2, 2.0), Err(Error::Range));
    assert_eq!(shot_noise(Some(&[1.0, f64::NAN]), 2, 2.0), Err(Error::NotFinite));
    assert_eq!(shot_noise(Some(&[1.0]), 2, 2.0), Err(Error::Length));
    assert_eq!(shot_noise::<f64>(None, 0, 2.0), Err(Error::Range));
    assert_eq!(shot_noise::<f64>(None, 1, 0.0), Err(Error::Range));
    assert_eq!(shot_noise::<f64>(None, 1, f64::INFINITY), Err(Error::NotFinite));

    let full = Bin { count: 4, first: 1.0, second: 0.0 };
    let bins = [full, Bin::default()];
    let pairs = [[0, 0], [0, 1], [1, 1]];
    // Two multipoles, two bins, three pairs.
    let mut values = [10.0, 1.0, 0.0, 0.0, 10.0, 1.0, 0.0, 0.0, 10.0, 1.0, 0.0, 0.0];
    subtract_shot_noise(&mut values, &pairs, &bins, 0b101, &[3.0, 4.0]).unwrap();
    assert_eq!(values, [7.0, 1.0, 0.0, 0.0, 10.0, 1.0, 0.0, 0.0, 6.0, 1.0, 0.0, 0.0]);
    subtract_shot_noise(&mut values, &pairs, &bins, 0b110, &[3.0, 4.0]).unwrap();
    assert_eq!(values[0], 7.0, "no monopole, nothing to subtract");
    assert_eq!(subtract_shot_noise(&mut values, &pairs, &bins, 0b101, &[3.0]), Err(Error::Range));
    assert_eq!(subtract_shot_noise(&mut values, &pairs[..2], &bins, 0b101, &[3.0]), Err(Error::Length));
    assert_eq!(
        subtract_shot_noise(&mut values, &pairs, &bins, 0b101, &[3.0, f64::NAN]),
        Err(Error::NotFinite)
    );
}
