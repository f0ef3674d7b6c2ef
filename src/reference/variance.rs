//! Statistics straight from their definitions: two passes, explicit inverses, one bin after another.

use std::vec;
use std::vec::Vec;

use crate::variance::bias::{Bias, Spectrum};

/// Mean of each of `values` columns.
pub(crate) fn means(rows: &[f64], values: usize) -> Vec<f64> {
    let count = (rows.len() / values) as f64;
    (0..values).map(|i| rows.iter().skip(i).step_by(values).sum::<f64>() / count).collect()
}

/// Covariance of the columns of two tables with the same number of rows, with N - 1.
pub(crate) fn cross_covariance(first: &[f64], second: &[f64], values: [usize; 2]) -> Vec<f64> {
    let (mean_first, mean_second) = (means(first, values[0]), means(second, values[1]));
    let count = (first.len() / values[0]) as f64;
    let mut out = Vec::new();
    for i in 0..values[0] {
        for j in 0..values[1] {
            let x = first.iter().skip(i).step_by(values[0]).map(|x| x - mean_first[i]);
            let y = second.iter().skip(j).step_by(values[1]).map(|y| y - mean_second[j]);
            out.push(x.zip(y).map(|(x, y)| x * y).sum::<f64>() / (count - 1.0));
        }
    }
    out
}

/// Covariance of the columns, with N - 1.
pub(crate) fn covariance(rows: &[f64], values: usize) -> Vec<f64> {
    cross_covariance(rows, rows, [values, values])
}

/// By Gauss and Jordan, with the largest pivot of each column.
pub(crate) fn inverse(matrix: &[f64], side: usize) -> Vec<f64> {
    let mut left: Vec<Vec<f64>> = matrix.chunks(side).map(<[f64]>::to_vec).collect();
    for (i, row) in left.iter_mut().enumerate() {
        row.extend((0..side).map(|j| f64::from(u8::from(i == j))));
    }
    for column in 0..side {
        let pivot =
            (column..side).max_by(|&a, &b| left[a][column].abs().total_cmp(&left[b][column].abs())).unwrap();
        left.swap(column, pivot);
        let by = left[column][column];
        left[column].iter_mut().for_each(|x| *x /= by);
        let from = left[column].clone();
        for (i, row) in left.iter_mut().enumerate() {
            let factor = row[column];
            if i != column {
                row.iter_mut().zip(&from).for_each(|(x, from)| *x -= factor * from);
            }
        }
    }
    left.iter().flat_map(|row| row[side..].to_vec()).collect()
}

/// Rows times columns.
pub(crate) fn product(left: &[f64], right: &[f64], inner: usize) -> Vec<f64> {
    let (rows, columns) = (left.len() / inner, right.len() / inner);
    let mut out = vec![0.0; rows * columns];
    for i in 0..rows {
        for j in 0..columns {
            for l in 0..inner {
                out[i * columns + j] += left[i * inner + l] * right[l * columns + j];
            }
        }
    }
    out
}

pub(crate) fn transpose(matrix: &[f64], columns: usize) -> Vec<f64> {
    let rows = matrix.len() / columns;
    (0..columns).flat_map(|j| (0..rows).map(move |i| matrix[i * columns + j])).collect()
}

/// P_hh or P_hm of one bin.
pub(crate) fn model(at: &Bias, spectrum: Spectrum, linear: f64, alpha: f64) -> f64 {
    let bias = at.b_g + 2.0 * at.delta_c * (at.b_g - at.p) * at.f_nl / alpha;
    match spectrum {
        Spectrum::HaloHalo => bias * bias * linear,
        Spectrum::HaloMatter => bias * linear,
    }
}

/// sum (d - m)^2/sigma^2 (Eq. chi2).
pub(crate) fn chi_squared(data: &[f64], model: &[f64], sigma: &[f64]) -> f64 {
    data.iter().zip(model).zip(sigma).map(|((d, m), sigma)| (d - m).powi(2) / sigma.powi(2)).sum()
}

/// (d - m)^T C^-1 (d - m).
#[cfg(feature = "linalg")]
pub(crate) fn chi_squared_full(data: &[f64], model: &[f64], covariance: &[f64]) -> f64 {
    let rest: Vec<f64> = data.iter().zip(model).map(|(d, m)| d - m).collect();
    product(&rest, &product(&inverse(covariance, rest.len()), &rest, rest.len()), rest.len())[0]
}

/// The x for which sum ((A x - y)/sigma)^2 is least, and its covariance, from the normal equations.
pub(crate) fn least_squares(a: &[f64], y: &[f64], sigma: &[f64]) -> (Vec<f64>, Vec<f64>) {
    let unknowns = a.len() / y.len();
    let scaled: Vec<f64> = a.iter().enumerate().map(|(i, a)| a / sigma[i / unknowns]).collect();
    let y: Vec<f64> = y.iter().zip(sigma).map(|(y, sigma)| y / sigma).collect();
    let turned = transpose(&scaled, unknowns);
    let covariance = inverse(&product(&turned, &scaled, y.len()), unknowns);
    (product(&covariance, &product(&turned, &y, y.len()), unknowns), covariance)
}

/// Modes with edges[b] <= |n|^2 < edges[b + 1], one by one.
pub(crate) fn lattice_modes(edges: &[u64]) -> Vec<u64> {
    let mut counts = vec![0; edges.len() - 1];
    let reach = edges[edges.len() - 1].isqrt() as i64 + 1;
    for i in -reach..=reach {
        for j in -reach..=reach {
            for l in -reach..=reach {
                let square = (i * i + j * j + l * l) as u64;
                let bin = edges.windows(2).position(|pair| pair[0] <= square && square < pair[1]);
                bin.into_iter().for_each(|bin| counts[bin] += 1);
            }
        }
    }
    counts
}

/// Mean, covariance and B of `carpool`, by its formula.
#[cfg(feature = "linalg")]
pub(crate) fn carpool(
    y: &[f64],
    c: &[f64],
    mu: &[f64],
    of_mu: &[f64],
    samples: usize,
) -> (Vec<f64>, Vec<f64>, Vec<f64>) {
    let (values, controls, count) = (y.len() / samples, mu.len(), samples as f64);
    let of_c = covariance(c, controls);
    let regular: Vec<f64> = of_c.iter().zip(of_mu).map(|(c, mu)| c + count * mu).collect();
    let inverse = inverse(&regular, controls);
    let beta = product(&cross_covariance(y, c, [values, controls]), &inverse, controls);
    let apart: Vec<f64> = means(c, controls).iter().zip(mu).map(|(c, mu)| c - mu).collect();
    let shift = product(&beta, &apart, controls);
    let mean: Vec<f64> = means(y, values).iter().zip(&shift).map(|(y, shift)| y - shift).collect();
    let fitted = product(c, &transpose(&beta, controls), controls);
    let rest: Vec<f64> = y.iter().zip(&fitted).map(|(y, fitted)| y - fitted).collect();
    let distance = product(&apart, &product(&inverse, &apart, controls), controls)[0] / (count - 1.0);
    let factor = (1.0 / count + distance) * (count - 1.0) / (count - 1.0 - controls as f64);
    let from_mu = product(&product(&beta, of_mu, controls), &transpose(&beta, controls), controls);
    let covariance =
        covariance(&rest, values).iter().zip(&from_mu).map(|(rest, mu)| factor * rest + mu).collect();
    (mean, covariance, beta)
}
