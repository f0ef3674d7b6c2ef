//! The direct discrete Fourier transform of a cube, one axis after the other: O(n^4) operations.
//!
//! Each sum has n terms of roots that are correct to half a unit in the last place, added in f64: the r.m.s. error is
//! below n^(1/2) epsilon of the r.m.s. value for each axis.

use std::vec;
use std::vec::Vec;

/// A complex number.
pub(crate) type Complex = [f64; 2];

/// Transforms each line of n elements, `stride` apart, of a cube of side n, with exp(sign 2 pi i jk/n).
fn axis(n: usize, sign: f64, stride: usize, cube: &mut [Complex]) {
    let roots: Vec<Complex> = (0..n)
        .map(|k| {
            let (s, c) = libm::sincos(2.0 * core::f64::consts::PI * k as f64 / n as f64);
            [c, sign * s]
        })
        .collect();
    let mut line = vec![[0.0; 2]; n];
    // Lines begin at the first `stride` elements of each block.
    for first in (0..cube.len()).step_by(n * stride).flat_map(|block| block..block + stride) {
        for (j, x) in line.iter_mut().enumerate() {
            *x = cube[first + j * stride];
        }
        for k in 0..n {
            let mut sum = [0.0; 2];
            // jk modulo n.
            let mut turn = 0;
            for x in &line {
                let w = roots[turn];
                sum[0] += x[0] * w[0] - x[1] * w[1];
                sum[1] += x[0] * w[1] + x[1] * w[0];
                turn += k;
                if turn >= n {
                    turn -= n;
                }
            }
            cube[first + k * stride] = sum;
        }
    }
}

/// All n^3 modes of a cube of n^3 cells, F(k) = sum_x f(x) exp(-i k.x), z innermost.
pub(crate) fn forward(n: usize, cells: &[f64]) -> Vec<Complex> {
    let mut cube: Vec<Complex> = cells.iter().map(|&x| [x, 0.0]).collect();
    for stride in [1, n, n * n] {
        axis(n, -1.0, stride, &mut cube);
    }
    cube
}

/// All n^3 cells of all n^3 modes, f(x) = sum_k F(k) exp(i k.x), z innermost.
pub(crate) fn inverse(n: usize, modes: &[Complex]) -> Vec<Complex> {
    let mut cube = modes.to_vec();
    for stride in [1, n, n * n] {
        axis(n, 1.0, stride, &mut cube);
    }
    cube
}
