//! Claims about the statistics, by subject.

mod acceptance;
mod bias;
#[cfg(feature = "linalg")]
mod carpool;
mod contours;
mod control;
mod ensemble;
mod fit;
mod levels;
mod likelihood;
mod matched;
mod models;
mod posterior;
mod ratios;
mod resample;
mod suppression;
mod universe;
mod valleys;

use rand_core::Rng;

use crate::noise::philox::Philox4x32;

/// Random numbers of a fixed seed, so that a statistical claim holds always or never.
struct Draws(Philox4x32);

impl Draws {
    fn of(seed: u64) -> Self {
        Self(Philox4x32::at(seed, [0; 4]))
    }

    /// In (0, 1).
    fn unit(&mut self) -> f64 {
        ((self.0.next_u64() >> 12) as f64 + 0.5) / (1_u64 << 52) as f64
    }

    fn below(&mut self, n: usize) -> usize {
        (self.unit() * n as f64) as usize
    }

    /// Normal with mean 0 and variance 1 (Box & Muller 1958).
    fn normal(&mut self) -> f64 {
        let (radius, angle) = ((-2.0 * self.unit().ln()).sqrt(), core::f64::consts::TAU * self.unit());
        radius * angle.cos()
    }

    /// Normal pairs of a given correlation.
    fn pair(&mut self, rho: f64) -> [f64; 2] {
        let (x, y) = (self.normal(), self.normal());
        [x, rho * x + (1.0 - rho * rho).sqrt() * y]
    }
}

/// Mean and standard deviation.
fn mean_and_deviation(values: &[f64]) -> (f64, f64) {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let square: f64 = values.iter().map(|x| (x - mean) * (x - mean)).sum();
    (mean, (square / (count - 1.0)).sqrt())
}

/// Distance relative to the second.
fn relative(value: f64, expected: f64) -> f64 {
    ((value - expected) / expected).abs()
}

fn largest(values: impl IntoIterator<Item = f64>) -> f64 {
    values.into_iter().fold(0.0, |most, x| if x > most || x.is_nan() { x } else { most })
}
