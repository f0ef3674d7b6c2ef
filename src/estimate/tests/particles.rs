//! Poisson particles: their noise is flat where the compensation is right.

use std::vec::Vec;

use super::*;
use crate::estimate::power::{shot_noise, subtract_shot_noise};
use crate::pm::{Assignment, Positions, Region, Window, deposit, deposit_scratch, interlace};
use crate::status::Error;

/// Un-normalised modes of particles with positions in cells, their mean density being 1.
fn deposited(n: usize, particles: &[[f64; 3]], shift: f64, window: Window) -> Vec<f64> {
    let mut fft = serial::<f64>(n);
    let region = Region::from_brick(fft.configuration()).unwrap();
    let mut mesh = vec![0.0; fft.length()];
    let positions = Positions::triples(particles.as_flattened()).unwrap();
    let assignment = Assignment { box_size: n as f64, window, shift };
    let scratch = memory(deposit_scratch::<f64>(&region, particles.len(), window).unwrap());
    deposit(&mut mesh, &region, &positions, None, &assignment, scratch, &Serial).unwrap();
    fft.forward(&mut mesh).unwrap();
    let mean = particles.len() as f64 / (n * n * n) as f64;
    mesh.iter_mut().for_each(|part| *part /= mean);
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
        let modes = deposited(n, &particles, 0.0, window);
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
        let mut modes = deposited(n, &particles, 0.0, window);
        let shifted = deposited(n, &particles, 0.5, window);
        interlace(&mut modes, &shifted, &brick, &Serial).unwrap();
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
    // L^3 overflows.
    assert_eq!(shot_noise::<f64>(None, 1, 1e103), Err(Error::Range));
    assert_eq!(shot_noise::<f64>(None, 1, 1e-110), Err(Error::Range));
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
