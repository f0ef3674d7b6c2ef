//! The Cholesky factor of a covariance matrix, by faer.

use super::check::{finite, same_length};
use crate::math::sqrt;
use crate::scratch::{Arena, Layout};
use crate::status::{Error, Result};

/// Off-diagonal elements may differ from their mirror images by this much, as correlation coefficients: users' covariances are sums of products.
const SYMMETRY: f64 = 1e-9;

/// Most rows of a matrix: 34 GB, beyond which sums of sizes inside faer need not be trusted.
const MOST: usize = 1 << 16;

/// Numbers in a square matrix.
pub(super) fn square(side: usize) -> Result<usize> {
    if side > MOST { Err(Error::Overflow) } else { Ok(side * side) }
}

/// Work space of [`covariance_root`]: the matrix, its deviations, and what faer asks for.
///
/// # Errors
/// `Overflow` for more than 65536 values.
///
/// # Example
/// ```
/// use fixpair::variance::covariance::covariance_root_scratch;
///
/// assert!(covariance_root_scratch(14)?.size >= 14 * 14 * 8);
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn covariance_root_scratch(values: usize) -> Result<Layout> {
    Layout::EMPTY.and::<f64>(square(values)?)?.and::<f64>(values)?.and::<u8>(dense::factor_bytes(values))
}

/// The lower triangle L of C = L L^T, row by row with zeros above; C is values x values and symmetric.
///
/// The bits depend on the processor's instructions, through faer. Cost: values^3/3 multiplications and additions. faer may allocate inside for
/// hundreds of values.
///
/// # Errors
/// `Length` for arrays of other sizes, `NotFinite`, `Range` for a matrix that is not symmetric, `Singular` for one that is not positive definite to
/// rounding: a covariance of N estimates is singular for values >= N. `root` is untouched by all of them.
///
/// # Example
/// ```
/// use fixpair::variance::covariance::covariance_root;
/// # #[repr(align(64))] struct Memory([u8; 1 << 16]);
/// # let mut memory = Memory([0; 1 << 16]);
/// # let scratch = &mut memory.0;
///
/// let mut root = [0.0; 4];
/// covariance_root(&mut root, &[4.0, 2.0, 2.0, 10.0], 2, scratch)?; // the lower triangle
/// assert!((root[0] - 2.0).abs() < 1e-12 && (root[2] - 1.0).abs() < 1e-12 && (root[3] - 3.0).abs() < 1e-12);
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn covariance_root(
    root: &mut [f64],
    covariance: &[f64],
    values: usize,
    scratch: &mut [u8],
) -> Result<()> {
    let layout = covariance_root_scratch(values)?;
    same_length(square(values)?, &[root.len(), covariance.len()])?;
    let mut arena = Arena::new(scratch, layout)?;
    let work = arena.take::<f64>(root.len())?;
    let deviation = arena.take::<f64>(values)?;
    check_covariance(covariance, values)?;
    for (i, deviation) in deviation.iter_mut().enumerate() {
        *deviation = sqrt(covariance[i * values + i]);
    }
    // The correlation matrix has the smallest condition number, to a factor of its side, and pivots without unit.
    for (at, work) in work.iter_mut().enumerate() {
        let (i, j) = (at / values, at % values);
        *work = covariance[at] / deviation[i] / deviation[j];
    }
    dense::factor(work, values, arena.take::<u8>(dense::factor_bytes(values))?)?;
    for (at, root) in root.iter_mut().enumerate() {
        let (i, j) = (at / values, at % values);
        *root = if j <= i { deviation[i] * work[j * values + i] } else { 0.0 };
    }
    Ok(())
}

/// Finite, symmetric, with variances greater than zero.
pub(super) fn check_covariance(covariance: &[f64], values: usize) -> Result<()> {
    finite(covariance)?;
    let variance = |i: usize| covariance[i * values + i];
    if (0..values).any(|i| variance(i) <= 0.0) {
        return Err(Error::Singular);
    }
    for i in 0..values {
        for j in 0..i {
            let difference = (covariance[i * values + j] - covariance[j * values + i]).abs();
            if difference > SYMMETRY * sqrt(variance(i)) * sqrt(variance(j)) {
                return Err(Error::Range);
            }
        }
    }
    Ok(())
}

/// faer, on column-major matrices in the caller's memory.
pub(super) mod dense {
    use faer::dyn_stack::MemStack;
    use faer::linalg::cholesky::llt::{factor, solve};
    use faer::{Conj, MatMut, MatRef, Par};

    use crate::status::{Error, Result};

    /// Work space of [`factor()`], with room to align it.
    pub(crate) fn factor_bytes(side: usize) -> usize {
        factor::cholesky_in_place_scratch::<f64>(side, Par::Seq, Default::default())
            .unaligned_bytes_required()
    }

    /// L in the lower triangle in place of a matrix of unit diagonal, of which the lower triangle is read.
    pub(crate) fn factor(matrix: &mut [f64], side: usize, work: &mut [u8]) -> Result<()> {
        let view = MatMut::from_column_major_slice_mut(matrix, side, side);
        let stack = MemStack::new(uninitialised(work));
        factor::cholesky_in_place(view, Default::default(), Par::Seq, stack, Default::default())
            .map_err(|_| Error::Singular)?;
        // What rounding leaves of the pivot of a row that is a combination of others.
        let least = 8.0 * side as f64 * f64::EPSILON;
        let sound = (0..side).all(|i| matrix[i * side + i] * matrix[i * side + i] > least);
        if sound { Ok(()) } else { Err(Error::Singular) }
    }

    /// Work space of [`solve()`], with room to align it.
    pub(crate) fn solve_bytes(side: usize, columns: usize) -> usize {
        solve::solve_in_place_scratch::<f64>(side, columns, Par::Seq).unaligned_bytes_required()
    }

    /// `right` becomes C^-1 `right`, `columns` columns of `side` values, with L of [`factor()`].
    pub(crate) fn solve(right: &mut [f64], factor: &[f64], side: usize, columns: usize, work: &mut [u8]) {
        let factor = MatRef::from_column_major_slice(factor, side, side);
        let right = MatMut::from_column_major_slice_mut(right, side, columns);
        solve::solve_in_place_with_conj(
            factor,
            Conj::No,
            right,
            Par::Seq,
            MemStack::new(uninitialised(work)),
        );
    }

    fn uninitialised(bytes: &mut [u8]) -> &mut [core::mem::MaybeUninit<u8>] {
        let (start, length) = (bytes.as_mut_ptr(), bytes.len());
        // SAFETY: the same bytes, borrowed for as long; faer's stack hands out memory and takes only bytes that may be anything, and every
        // value that it leaves is one that `u8` may have, initialised before.
        unsafe { core::slice::from_raw_parts_mut(start.cast(), length) }
    }
}
