//! A transform hook that sums every axis directly: f(x) -> sum_x f(x) exp(-i k.x), one axis after another.

use std::vec;
use std::vec::Vec;

use crate::fft::Fft3;
use crate::mesh::{Brick, Space};
use crate::real::Real;
use crate::status::{Error, Result};

/// The whole mesh of side n, unpadded planes, computed in f64.
pub(crate) struct Slow {
    configuration: Brick,
    fourier: Brick,
}

impl Slow {
    pub(crate) fn new(n: usize) -> Self {
        Self {
            configuration: Brick::whole(n, Space::Configuration).unwrap(),
            fourier: Brick::whole(n, Space::Fourier).unwrap(),
        }
    }
}

/// All n^3 complex values, row-major, transformed along each axis with exp(sign 2 pi i j k/n).
fn all_axes(values: &mut [[f64; 2]], n: usize, sign: f64) {
    let roots: Vec<[f64; 2]> = (0..n)
        .map(|j| {
            let angle = sign * core::f64::consts::TAU * j as f64 / n as f64;
            [libm::cos(angle), libm::sin(angle)]
        })
        .collect();
    for step in [1, n, n * n] {
        for first in (0..n * n * n).filter(|at| (at / step).is_multiple_of(n)) {
            let line: Vec<[f64; 2]> = (0..n).map(|j| values[first + j * step]).collect();
            for k in 0..n {
                let mut sum = [0.0; 2];
                for (j, value) in line.iter().enumerate() {
                    let root = roots[j * k % n];
                    sum[0] += value[0] * root[0] - value[1] * root[1];
                    sum[1] += value[0] * root[1] + value[1] * root[0];
                }
                values[first + k * step] = sum;
            }
        }
    }
}

impl<T: Real> Fft3<T> for Slow {
    fn configuration(&self) -> &Brick {
        &self.configuration
    }

    fn fourier(&self) -> &Brick {
        &self.fourier
    }

    fn length(&self) -> usize {
        self.fourier.reals()
    }

    fn forward(&mut self, data: &mut [T]) -> Result<()> {
        let (n, row) = (self.fourier.n(), self.configuration.stride()[1]);
        if data.len() < self.fourier.reals() {
            return Err(Error::Length);
        }
        let mut values: Vec<[f64; 2]> =
            (0..n * n * n).map(|at| [data[at / n * row + at % n].to_f64(), 0.0]).collect();
        all_axes(&mut values, n, -1.0);
        for (at, mode) in data.chunks_exact_mut(2).take(n * n * (n / 2 + 1)).enumerate() {
            let (line, z) = (at / (n / 2 + 1), at % (n / 2 + 1));
            let value = values[line * n + z];
            mode[0] = T::from_f64(value[0]);
            mode[1] = T::from_f64(value[1]);
        }
        Ok(())
    }

    fn inverse(&mut self, data: &mut [T]) -> Result<()> {
        let (n, row) = (self.fourier.n(), self.configuration.stride()[1]);
        if data.len() < self.fourier.reals() {
            return Err(Error::Length);
        }
        let mut values = vec![[0.0; 2]; n * n * n];
        for x in 0..n {
            for y in 0..n {
                for z in 0..n {
                    let (conjugate, [a, b, c]) = if z > n / 2 {
                        (true, [(n - x) % n, (n - y) % n, n - z])
                    } else {
                        (false, [x, y, z])
                    };
                    let at = 2 * ((a * n + b) * (n / 2 + 1) + c);
                    let im = data[at + 1].to_f64();
                    values[(x * n + y) * n + z] = [data[at].to_f64(), if conjugate { -im } else { im }];
                }
            }
        }
        all_axes(&mut values, n, 1.0);
        for (at, value) in values.iter().enumerate() {
            data[at / n * row + at % n] = T::from_f64(value[0]);
        }
        Ok(())
    }
}
