//! Separable kernels as formulae of wavenumbers, the templates that they stand for, and products as direct sums.

use super::convolution::Dense;
use crate::initial::shape::{Shape, ShapeRow};

/// e of P_Phi^(-1/3) = k^e.
fn exponent(n_s: f64) -> f64 {
    (4.0 - n_s) / 3.0
}

/// sum c k3^(e out) (k1^(e a) k2^(e b) + k1^(e b) k2^(e a)): what two waves of unit amplitude add to the wave k3 = k1 + k2.
pub(crate) fn kernel(rows: &[ShapeRow], n_s: f64, k: [f64; 2], k3: f64) -> f64 {
    let power = |k: f64, s: f64| libm::pow(k, exponent(n_s) * s);
    let term = |row: &ShapeRow| {
        let both = power(k[0], row.s_a) * power(k[1], row.s_b) + power(k[0], row.s_b) * power(k[1], row.s_a);
        row.coefficient * power(k3, row.s_out) * both
    };
    rows.iter().map(term).sum()
}

/// The three ways to take a side of a triangle as the sum of the two others, times the power of those.
pub(crate) fn close(n_s: f64, k: [f64; 3], kernel: impl Fn([usize; 3]) -> f64) -> f64 {
    let p = k.map(|k| libm::pow(k, n_s - 4.0));
    [[0, 1, 2], [1, 2, 0], [2, 0, 1]].map(|legs| kernel(legs) * p[legs[0]] * p[legs[1]]).iter().sum()
}

/// B of Phi for f_NL = 1 and P_Phi = k^(n_s - 4), from the rows.
pub(crate) fn tree_level(rows: &[ShapeRow], n_s: f64, k: [f64; 3]) -> f64 {
    close(n_s, k, |[a, b, c]| kernel(rows, n_s, [k[a], k[b]], k[c]))
}

/// The same from the published templates (the module of the rows has their sources).
pub(crate) fn template(shape: Shape, n_s: f64, k: [f64; 3]) -> f64 {
    let [p1, p2, p3] = k.map(|k| libm::pow(k, n_s - 4.0));
    let local = p1 * p2 + p2 * p3 + p3 * p1;
    let third = |p: f64| libm::cbrt(p);
    let flat = third(p1 * p2 * p3) * third(p1 * p2 * p3);
    let mixed = |a: f64, b: f64, c: f64| third(a) * third(b * b) * c;
    let six = mixed(p1, p2, p3)
        + mixed(p1, p3, p2)
        + mixed(p2, p1, p3)
        + mixed(p2, p3, p1)
        + mixed(p3, p1, p2)
        + mixed(p3, p2, p1);
    match shape {
        Shape::Local => 2.0 * local,
        Shape::Equilateral => 6.0 * (-local - 2.0 * flat + six),
        Shape::Orthogonal => 6.0 * (-3.0 * local - 8.0 * flat + 3.0 * six),
        Shape::Folded => 6.0 * (local + 3.0 * flat - six),
        Shape::OrthogonalLss => {
            let [a, b, c] = [p1, p2, p3].map(|p| 1.0 / third(p));
            let pi = core::f64::consts::PI;
            let p = 27.0 / (743.0 / (7.0 * (20.0 * pi * pi - 193.0)) - 21.0);
            let d = (b + c - a) * (c + a - b) * (a + b - c);
            let g = (2.0 * (a * b + b * c + c * a) - (a * a + b * b + c * c)) / 3.0;
            let product = a * b * c;
            6.0 * ((1.0 + p) * d - p * g * g * g / product) / (product * product * product)
        }
    }
}

/// X_out[(X_a phi)(X_b phi)], each mode a sum over all pairs of modes; without its mean.
pub(crate) fn product(phi: &Dense, row: &ShapeRow, n_s: f64) -> Dense {
    let scaled = |field: &Dense, s: f64| {
        field.map(|n| {
            let square = n[0] * n[0] + n[1] * n[1] + n[2] * n[2];
            if square == 0.0 { 0.0 } else { libm::pow(libm::sqrt(square), exponent(n_s) * s) }
        })
    };
    scaled(&scaled(phi, row.s_a).times(&scaled(phi, row.s_b), phi.half), row.s_out)
}
