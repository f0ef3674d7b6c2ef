//! The statistics that are called most: an ensemble's covariance, factors of covariances, fits and posteriors of bias and f_NL, the fit of a scatter, CARPool.
//! One core. FIXPAIR_BENCH_PYTHON names a Python with numpy, which does the same by array operations in the same run.

use std::env;
use std::hint::black_box;
use std::process::Command;
use std::time::Duration;

use criterion::{Criterion, criterion_group, criterion_main};
use fixpair::variance::bias::{Bias, Spectrum, halo_power};
use fixpair::variance::carpool::{Carpool, carpool, carpool_scratch};
use fixpair::variance::covariance::{covariance_root, covariance_root_scratch};
use fixpair::variance::ensemble::{
    Moments, ensemble_add, ensemble_covariance, ensemble_init, ensemble_length,
};
use fixpair::variance::fit::{FREE_B_G, FREE_F_NL, fit_bias};
use fixpair::variance::likelihood::{BiasLikelihood, Spectra};
use fixpair::variance::models::{Suppression, sigma_suppressed};
use fixpair::variance::posterior::{bias_posterior, bias_posterior_scratch};
use fixpair::variance::suppression::{Scatter, fit_suppression};

#[path = "../examples/common/memory.rs"]
mod memory;
#[path = "common/seconds.rs"]
mod seconds;

use memory::Memory;
use seconds::seconds;

/// Simulations and bins.
const SAMPLES: usize = 1000;
const BINS: usize = 200;
/// Of the grid of a posterior, a side.
const POINTS: usize = 128;

/// Numbers in (-1, 1) without order.
fn noise(count: usize) -> Vec<f64> {
    let mut state = 1_u64;
    let mut next = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    };
    (0..count).map(|_| next()).collect()
}

/// k, P_lin, alpha, modes: bins of the paper's box, of a smooth spectrum like that of the paper's cosmology at z = 1.
fn spectrum(bins: usize) -> [Vec<f64>; 4] {
    let k: Vec<f64> = (1..=bins).map(|b| 0.006_283 * b as f64).collect();
    let linear = k.iter().map(|k| 4e5 * k / (1.0 + (k / 0.02).powi(2)).powf(1.2)).collect();
    let alpha = k.iter().map(|k| 1.05e7 * k * k / (1.0 + (k / 0.05).powi(2))).collect();
    let modes = (1..=bins).map(|b| 4.0 * std::f64::consts::PI * (b * b) as f64).collect();
    [k, linear, alpha, modes]
}

fn covariance_of(samples: &[f64], state: &mut [f64], out: &mut [f64]) {
    ensemble_init(state, BINS, Moments::Covariance).unwrap();
    ensemble_add(state, samples).unwrap();
    ensemble_covariance(out, state, 0..BINS, 0..BINS).unwrap();
}

fn likelihood() -> BiasLikelihood {
    let [_, linear, alpha, modes] = spectrum(14);
    let truth = Bias { b_g: 2.32, f_nl: 100.0, ..Bias::default() };
    let mut power = vec![0.0; 14];
    halo_power(&mut power, &truth, Spectrum::HaloHalo, &linear, &alpha).unwrap();
    let sigma: Vec<f64> = power
        .iter()
        .zip(&modes)
        .map(|(power, modes)| 0.3 * (power + 4000.0) * (2.0 / modes).sqrt())
        .collect();
    let mut likelihood = BiasLikelihood::EMPTY;
    let spectra = Spectra { power: &power, linear: &linear, alpha: &alpha };
    likelihood.add(Spectrum::HaloHalo, spectra, &sigma).unwrap();
    likelihood
}

/// Names and seconds of the peer, where there is one.
fn peer() -> Vec<(String, f64)> {
    let Some(python) = env::var_os("FIXPAIR_BENCH_PYTHON") else { return Vec::new() };
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/benches/peers/numpy_statistics.py");
    // One core of it, as of ours.
    let output =
        Command::new(python).arg(script).env("OPENBLAS_NUM_THREADS", "1").output().expect("the peer runs");
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    let line = |line: &str| {
        let (name, seconds) = line.rsplit_once(' ')?;
        Some((name.to_owned(), seconds.parse().ok()?))
    };
    text.lines().filter_map(line).collect()
}

/// Runs a kernel under criterion, and beside the peer's time for the same.
fn compare(c: &mut Criterion, peers: &[(String, f64)], name: &str, mut run: impl FnMut()) {
    c.bench_function(name, |b| b.iter(&mut run));
    let Some((_, theirs)) = peers.iter().find(|(peer, _)| peer == name) else { return };
    // The clock of the processor ticks every few milliseconds.
    let mut count = 1;
    while seconds(|| (0..count).for_each(|_| run())) < 0.03 {
        count *= 2;
    }
    let mut times: Vec<f64> =
        (0..9).map(|_| seconds(|| (0..count).for_each(|_| run())) / count as f64).collect();
    times.sort_by(f64::total_cmp);
    println!("{name}: {:.3e} s, numpy {theirs:.3e} s: x{:.2}", times[4], theirs / times[4]);
}

fn all(c: &mut Criterion) {
    let peers = peer();
    let samples = noise(SAMPLES * BINS);
    let mut state = vec![0.0; ensemble_length(BINS, Moments::Covariance).unwrap()];
    let mut covariance = vec![0.0; BINS * BINS];
    compare(c, &peers, "covariance", || covariance_of(black_box(&samples), &mut state, &mut covariance));

    let mut root = vec![0.0; BINS * BINS];
    let mut scratch = Memory::new(covariance_root_scratch(BINS).unwrap());
    compare(c, &peers, "root", || {
        covariance_root(&mut root, black_box(&covariance), BINS, scratch.bytes()).unwrap();
    });

    let likelihood = likelihood();
    let start = Bias::default();
    compare(c, &peers, "fit", || {
        black_box(fit_bias(black_box(&likelihood), &start, FREE_B_G | FREE_F_NL).unwrap());
    });
    let mut scratch = Memory::new(bias_posterior_scratch(POINTS).unwrap());
    compare(c, &peers, "posterior", || {
        let free = FREE_B_G | FREE_F_NL;
        black_box(
            bias_posterior(black_box(&likelihood), &start, free, POINTS, 0.68, scratch.bytes()).unwrap(),
        );
    });

    let [k, power, _, modes] = spectrum(63);
    let truth = Suppression { cosmic_variance: 0.141, softening: 0.114, shot_noise: 1.174 };
    let mut sigma = vec![0.0; 63];
    sigma_suppressed(&mut sigma, &truth, &k, &power, &modes, 4000.0).unwrap();
    sigma.iter_mut().zip(noise(63)).for_each(|(sigma, noise)| *sigma *= 1.0 + 0.15 * noise);
    let scatter = Scatter { sigma: &sigma, k: &k, power: &power, modes: &modes, noise: 4000.0 };
    compare(c, &peers, "suppression", || {
        black_box(fit_suppression(black_box(&scatter), 41).unwrap());
    });

    let (values, controls, few) = (60, 60, 200);
    let c_samples = noise(few * controls);
    let y: Vec<f64> = c_samples.iter().zip(noise(few * values)).map(|(c, rest)| c + 0.3 * rest).collect();
    let mu = vec![0.0; controls];
    let (mut mean, mut of_mean, mut beta) =
        (vec![0.0; values], vec![0.0; values * values], vec![0.0; values * controls]);
    let mut scratch = Memory::new(carpool_scratch(values, controls).unwrap());
    let of = Carpool { y: &y, c: &c_samples, samples: few, mu: &mu, covariance_of_mu: None };
    compare(c, &peers, "carpool", || {
        carpool(&mut mean, &mut of_mean, &mut beta, black_box(&of), scratch.bytes()).unwrap();
    });
}

fn few() -> Criterion {
    Criterion::default()
        .sample_size(20)
        .warm_up_time(Duration::from_millis(300))
        .measurement_time(Duration::from_secs(2))
}

criterion_group! { name = variance; config = few(); targets = all }
criterion_main!(variance);
