//! Products of fields as sums over modes: (f g)_k = sum_q f_q g_{k-q}, over the proper modes |n_a| < N/2 only.

use std::vec;
use std::vec::Vec;

/// Modes n in -h..=h on each axis, as a dense array of complex numbers.
#[derive(Clone)]
pub(crate) struct Dense {
    pub(crate) half: i64,
    pub(crate) values: Vec<[f64; 2]>,
}

impl Dense {
    pub(crate) fn zero(half: i64) -> Self {
        let side = (2 * half + 1) as usize;
        Self { half, values: vec![[0.0; 2]; side * side * side] }
    }

    /// The proper modes of a whole mesh of side `n`, rows of n/2 + 1 modes.
    pub(crate) fn from_mesh(data: &[f64], n: usize) -> Self {
        let half = n as i64 / 2 - 1;
        let mut dense = Self::zero(half);
        for i in -half..=half {
            for j in -half..=half {
                for l in -half..=half {
                    let (sign, [a, b, c]) = if l < 0 { (-1.0, [-i, -j, -l]) } else { (1.0, [i, j, l]) };
                    let index = |m: i64| m.rem_euclid(n as i64) as usize;
                    let at = 2 * ((index(a) * n + index(b)) * (n / 2 + 1) + c as usize);
                    let place = dense.place([i, j, l]);
                    dense.values[place] = [data[at], sign * data[at + 1]];
                }
            }
        }
        dense
    }

    /// A field from a rule for its modes.
    pub(crate) fn from_modes(half: i64, value: impl Fn([i64; 3]) -> [f64; 2]) -> Self {
        let mut dense = Self::zero(half);
        for mode in Self::modes(half) {
            let place = dense.place(mode);
            dense.values[place] = value(mode);
        }
        dense
    }

    /// Modes of a whole mesh of side `n`, rows of n/2 + 1 modes; those that the mesh alone has are zero.
    pub(crate) fn to_mesh(&self, n: usize) -> Vec<f64> {
        let mut data = vec![0.0; n * n * (n + 2)];
        for [i, j, l] in Self::modes(self.half).filter(|mode| mode[2] >= 0) {
            let index = |m: i64| m.rem_euclid(n as i64) as usize;
            let at = 2 * ((index(i) * n + index(j)) * (n / 2 + 1) + l as usize);
            data[at..at + 2].copy_from_slice(&self.at([i, j, l]));
        }
        data
    }

    fn place(&self, [i, j, l]: [i64; 3]) -> usize {
        let side = 2 * self.half + 1;
        (((i + self.half) * side + j + self.half) * side + l + self.half) as usize
    }

    pub(crate) fn at(&self, mode: [i64; 3]) -> [f64; 2] {
        if mode.iter().any(|m| m.abs() > self.half) { [0.0; 2] } else { self.values[self.place(mode)] }
    }

    pub(crate) fn modes(half: i64) -> impl Iterator<Item = [i64; 3]> {
        let range = move || -half..=half;
        range().flat_map(move |i| range().flat_map(move |j| range().map(move |l| [i, j, l])))
    }

    /// The product with another field, for the modes up to `half`.
    pub(crate) fn times(&self, other: &Self, half: i64) -> Self {
        let mut product = Self::zero(half);
        for k in Self::modes(half) {
            let mut sum = [0.0; 2];
            for q in Self::modes(self.half) {
                let f = self.at(q);
                let g = other.at([k[0] - q[0], k[1] - q[1], k[2] - q[2]]);
                sum[0] += f[0] * g[0] - f[1] * g[1];
                sum[1] += f[0] * g[1] + f[1] * g[0];
            }
            let place = product.place(k);
            product.values[place] = sum;
        }
        product
    }

    /// Multiplies each mode by a real function of its number.
    pub(crate) fn map(&self, factor: impl Fn([f64; 3]) -> f64) -> Self {
        let mut out = self.clone();
        for mode in Self::modes(self.half) {
            let c = factor(mode.map(|m| m as f64));
            let place = out.place(mode);
            out.values[place] = out.values[place].map(|v| c * v);
        }
        out
    }

    /// self + scale other, for modes that both hold.
    pub(crate) fn plus(&self, scale: f64, other: &Self) -> Self {
        let mut out = self.clone();
        for mode in Self::modes(self.half) {
            let (place, b) = (out.place(mode), other.at(mode));
            let a = out.values[place];
            out.values[place] = [a[0] + scale * b[0], a[1] + scale * b[1]];
        }
        out
    }

    /// Largest difference over all modes but the mean, relative to the largest mode.
    pub(crate) fn distance(&self, other: &Self) -> f64 {
        let size = self.values.iter().flatten().fold(0.0_f64, |m, v| m.max(v.abs()));
        let worst = Self::modes(self.half).filter(|&m| m != [0; 3]).fold(0.0_f64, |worst, mode| {
            let (a, b) = (self.at(mode), other.at(mode));
            worst.max((a[0] - b[0]).abs()).max((a[1] - b[1]).abs())
        });
        worst / size
    }
}
