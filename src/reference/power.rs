//! Spectra and correlation functions by plain loops: each point, its partner, its bin by search, Legendre polynomials by recurrence.

use std::vec;
use std::vec::Vec;

use crate::estimate::binning::{Binning, Second};
use crate::estimate::compensation::Compensation;
use crate::mesh::{Brick, Space};

/// One bin: points, sums of both coordinates, and the real and imaginary part of the sum for l = 0..=4.
#[derive(Clone, Debug, Default)]
pub(crate) struct Slow {
    pub(crate) count: u64,
    pub(crate) first: f64,
    pub(crate) second: f64,
    pub(crate) sums: [[f64; 2]; 5],
}

fn legendre(mu: f64) -> [f64; 5] {
    let mut p = [1.0, mu, 0.0, 0.0, 0.0];
    for l in 1..4 {
        p[l + 1] = ((2 * l + 1) as f64 * mu * p[l] - l as f64 * p[l - 1]) / (l + 1) as f64;
    }
    p
}

fn range(edges: &[f64], value: f64, closed: bool) -> Option<usize> {
    let last = edges.len() - 2;
    (0..=last).find(|&b| {
        edges[b] <= value && (value < edges[b + 1] || closed && b == last && value == edges[b + 1])
    })
}

/// Adds one point with product re + i im.
fn add(bins: &mut [Slow], binning: &Binning<'_>, n: [i64; 3], [re, im]: [f64; 2]) {
    let length = binning.axis.iter().map(|a| a * a).sum::<f64>().sqrt();
    let square = n.iter().map(|n| n * n).sum::<i64>() as f64;
    let parallel = (0..3).map(|a| n[a] as f64 * binning.axis[a]).sum::<f64>() / length;
    let mu = if square == 0.0 { 0.0 } else { parallel / square.sqrt() };
    let (first, second, ranges, at) = match binning.second {
        Second::None => (square, 0.0, 1, Some(0)),
        Second::Cosine(edges) => (square, mu.abs(), edges.len() - 1, range(edges, mu.abs(), true)),
        Second::Parallel(edges) => (
            (square - parallel * parallel).max(0.0),
            parallel.abs(),
            edges.len() - 1,
            range(edges, parallel.abs(), false),
        ),
    };
    let edges: Vec<f64> = binning.edges.iter().map(|&edge| edge as f64).collect();
    // A perpendicular square that is an integer may come out just below it.
    let Some((b, c)) = range(&edges, first + 1e-10, false).zip(at) else { return };
    let bin = &mut bins[b * ranges + c];
    bin.count += 1;
    bin.first += first.sqrt();
    bin.second += second;
    for (sum, polynomial) in bin.sums.iter_mut().zip(legendre(mu)) {
        *sum = [sum[0] + re * polynomial, sum[1] + im * polynomial];
    }
}

/// The spectrum of f and g over all modes of a whole mesh, both members of each pair.
pub(crate) fn power(
    f: &[f64],
    g: &[f64],
    compensation: [Compensation; 2],
    n: usize,
    binning: &Binning<'_>,
) -> Vec<Slow> {
    let mut bins = vec![Slow::default(); binning.bins().unwrap()];
    let stride = Brick::whole(n, Space::Fourier).unwrap().stride();
    for i in 0..n {
        for j in 0..n {
            for l in 0..=n / 2 {
                let at = 2 * (i * stride[0] + j * stride[1] + l);
                let k = [Brick::mode(n, i), Brick::mode(n, j), l as i64];
                let factor: f64 = k
                    .iter()
                    .flat_map(|&m| compensation.map(|c| c.factor(m.unsigned_abs() as usize, n)))
                    .product();
                let re = factor * (f[at] * g[at] + f[at + 1] * g[at + 1]);
                let im = factor * (f[at + 1] * g[at] - f[at] * g[at + 1]);
                add(&mut bins, binning, k, [re, im]);
                if l > 0 && 2 * l < n {
                    add(&mut bins, binning, k.map(|m| -m), [re, -im]);
                }
            }
        }
    }
    bins
}

/// A correlation function over all separations of a whole mesh.
pub(crate) fn correlation(xi: &[f64], n: usize, binning: &Binning<'_>) -> Vec<Slow> {
    let mut bins = vec![Slow::default(); binning.bins().unwrap()];
    let stride = Brick::whole(n, Space::Configuration).unwrap().stride();
    for i in 0..n {
        for j in 0..n {
            for l in 0..n {
                let value = xi[i * stride[0] + j * stride[1] + l];
                add(&mut bins, binning, [i, j, l].map(|i| Brick::mode(n, i)), [value, value]);
            }
        }
    }
    bins
}
