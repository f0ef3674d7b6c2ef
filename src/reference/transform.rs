//! The direct transform as a hook.

use std::vec;
use std::vec::Vec;

use super::dft;
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
        let cells: Vec<f64> = (0..n * n * n).map(|at| data[at / n * row + at % n].to_f64()).collect();
        let values = dft::forward(n, &cells);
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
        for (at, value) in dft::inverse(n, &values).iter().enumerate() {
            data[at / n * row + at % n] = T::from_f64(value[0]);
        }
        Ok(())
    }
}
