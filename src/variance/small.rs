//! Least squares with a handful of unknowns, on the stack.
//!
//! Rows of N numbers go one by one into an upper triangle R by Givens rotations, so that the sum of squares |A x|^2 over all rows
//! is |R x|^2 for every x. The condition number is that of A, not its square as in normal equations, and triangles merge.

use crate::math::sqrt;
use crate::status::{Error, Result};

/// R^T R = A^T A for all rows so far.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Triangle<const N: usize>(pub(super) [[f64; N]; N]);

/// sqrt(a^2 + b^2). The slow way only where squares over- or underflow.
fn length(a: f64, b: f64) -> f64 {
    let square = a * a + b * b;
    if (1e-280..1e280).contains(&square) { sqrt(square) } else { libm::hypot(a, b) }
}

impl<const N: usize> Triangle<N> {
    pub(super) const EMPTY: Self = Self([[0.0; N]; N]);

    /// One more row of A.
    pub(super) fn push(&mut self, mut row: [f64; N]) {
        for (i, pivot) in self.0.iter_mut().enumerate() {
            if row[i] == 0.0 {
                continue;
            }
            let length = length(pivot[i], row[i]);
            let (cosine, sine) = (pivot[i] / length, row[i] / length);
            for j in i..N {
                let (above, below) = (pivot[j], row[j]);
                pivot[j] = cosine * above + sine * below;
                row[j] = cosine * below - sine * above;
            }
            pivot[i] = length;
        }
    }

    /// R x.
    pub(super) fn times(&self, x: &[f64; N]) -> [f64; N] {
        core::array::from_fn(|i| (i..N).map(|j| self.0[i][j] * x[j]).sum())
    }

    /// Is the length of each of the first `unknowns` columns above rounding after the columns before it are projected out?
    fn check(&self, unknowns: usize) -> Result<()> {
        for j in 0..unknowns {
            let column = sqrt((0..=j).map(|i| self.0[i][j] * self.0[i][j]).sum());
            // A column that is a combination of others keeps a few roundings of its length; NaN is not above it either.
            let apart = self.0[j][j].abs() > 1e-13 * column;
            if !apart {
                return Err(Error::Singular);
            }
        }
        Ok(())
    }

    /// The x of the first N - 1 columns for which A x is nearest to the last column, of which only the first `unknowns` are not zero.
    pub(super) fn solve(&self, unknowns: usize) -> Result<[f64; N]> {
        self.check(unknowns)?;
        let mut x = [0.0; N];
        for i in (0..unknowns).rev() {
            let rest: f64 = (i + 1..unknowns).map(|j| self.0[i][j] * x[j]).sum();
            x[i] = (self.0[i][N - 1] - rest) / self.0[i][i];
        }
        Ok(x)
    }

    /// (A^T A)^-1 of the first `unknowns` columns.
    pub(super) fn covariance(&self, unknowns: usize) -> Result<[[f64; N]; N]> {
        self.check(unknowns)?;
        let mut inverse = [[0.0; N]; N];
        for j in 0..unknowns {
            inverse[j][j] = 1.0 / self.0[j][j];
            for i in (0..j).rev() {
                let sum: f64 = (i + 1..=j).map(|l| self.0[i][l] * inverse[l][j]).sum();
                inverse[i][j] = -sum / self.0[i][i];
            }
        }
        let product = |i: usize, j: usize| (i.max(j)..unknowns).map(|l| inverse[i][l] * inverse[j][l]).sum();
        Ok(core::array::from_fn(|i| {
            core::array::from_fn(|j| if i.max(j) < unknowns { product(i, j) } else { 0.0 })
        }))
    }
}
