//! Claims about the third order.

use core::f64::consts::TAU;
use std::vec;
use std::vec::Vec;

use super::shifted::half_cells_length;
use super::third::{SECOND_ORDER_MESHES, THIRD_ORDER_MESHES, second_order_exact, third_order_sources};
use crate::exec::Serial;
use crate::fft::Fft3;
use crate::mesh::{Brick, Space};
use crate::reference::transform::Slow;

/// A field given on the cells, as modes.
fn modes_of(n: usize, field: impl Fn([f64; 3]) -> f64) -> Vec<f64> {
    let mut fft = Slow::new(n);
    let cells = Brick::whole(n, Space::Configuration).unwrap();
    let stride = cells.stride();
    let mut data = vec![0.0; Fft3::<f64>::length(&fft)];
    for x in 0..n {
        for y in 0..n {
            for z in 0..n {
                let at = [x, y, z].map(|i| TAU * i as f64 / n as f64);
                data[x * stride[0] + y * stride[1] + z] = field(at) / (n * n * n) as f64;
            }
        }
    }
    fft.forward(&mut data).unwrap();
    data
}

/// S, A, B and C of a density.
fn sources(density: &[f64], n: usize) -> [Vec<f64>; 6] {
    let mut fft = Slow::new(n);
    let length = Fft3::<f64>::length(&fft);
    let mut table = vec![[0.0; 2]; half_cells_length(n)];
    let mut out: [Vec<f64>; 6] = core::array::from_fn(|_| vec![f64::NAN; length]);
    let mut meshes: Vec<Vec<f64>> = (0..THIRD_ORDER_MESHES).map(|_| vec![f64::NAN; length]).collect();
    let [second, third @ ..] = &mut out;
    let mut six = meshes.iter_mut().map(Vec::as_mut_slice);
    let six: [&mut [f64]; SECOND_ORDER_MESHES] = core::array::from_fn(|_| six.next().unwrap());
    second_order_exact(second, density, &mut fft, six, &mut table, &Serial).unwrap();
    let mut twelve = meshes.iter_mut().map(Vec::as_mut_slice);
    let twelve = core::array::from_fn(|_| twelve.next().unwrap());
    let third = third.each_mut().map(Vec::as_mut_slice);
    third_order_sources(third, density, second, &mut fft, twelve, &mut table, &Serial).unwrap();
    out
}

/// Modes inside the Nyquist planes; what is kept elsewhere is no mode.
fn difference(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

#[test]
fn crossed_waves_have_the_sources_of_the_closed_form() {
    let [a, b, c] = [0.3, -0.5, 0.7];
    // Products reach three times the fundamental mode on an axis: all are modes of the mesh.
    let n = 8;
    let density = modes_of(n, |[x, y, z]| a * x.cos() + b * y.cos() + c * z.cos());
    let [second, determinant, mixed, curl_x, curl_y, curl_z] = sources(&density, n);
    let waves = |[x, y, z]: [f64; 3]| [a * x.cos(), b * y.cos(), c * z.cos()];
    let slopes = |[x, y, z]: [f64; 3]| [a * x.sin(), b * y.sin(), c * z.sin()];
    // phi2 = -S/2, for each product in S is of two waves of the same length at right angles.
    let q = |at, i: usize| {
        let p = waves(at);
        0.5 * p[i] * (p[0] + p[1] + p[2] - p[i])
    };
    let twist = |at, i: usize, j: usize| {
        let (p, s) = (waves(at), slopes(at));
        -0.5 * s[i] * s[j] * (p[i] - p[j])
    };
    let expected = [
        modes_of(n, |at| {
            let [p, q, r] = waves(at);
            p * q + q * r + p * r
        }),
        modes_of(n, |at| waves(at).iter().product()),
        modes_of(n, |at| {
            let total: f64 = (0..3).map(|i| q(at, i)).sum();
            (0..3).map(|i| waves(at)[i] * (total - q(at, i))).sum()
        }),
        modes_of(n, |at| twist(at, 1, 2)),
        modes_of(n, |at| twist(at, 2, 0)),
        modes_of(n, |at| twist(at, 0, 1)),
    ];
    for (i, (found, expected)) in
        [second, determinant, mixed, curl_x, curl_y, curl_z].iter().zip(&expected).enumerate()
    {
        // Rounding of transforms of 512 cells.
        assert!(difference(found, expected) < 1e-16, "{i}: {}", difference(found, expected));
    }
}
