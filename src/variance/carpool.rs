//! CARPool with a matrix of coefficients (Chartier et al. 2021, arXiv:2009.08970): each value of y is corrected by all values of c.
//!
//! ```text
//! x = <y> - B (<c> - mu),  B = C_yc (C_cc + N C_mu)^-1
//! ```
//!
//! N samples determine at most N - 3 columns of B, and each costs: prefer one control for each value
//! ([`control_variates`](super::control::control_variates)) unless there are many more samples than controls.

use super::check::{finite, table};
use super::covariance::{check_covariance, dense, square};
use super::ensemble::LARGEST_SAMPLE;
use crate::math::sqrt;
use crate::scratch::{Arena, Layout};
use crate::status::{Error, Result};

/// Matched samples, row by row, and the expectation of the controls.
#[derive(Clone, Copy, Debug)]
pub struct Carpool<'a> {
    /// N rows of what is wanted.
    pub y: &'a [f64],
    /// N rows of controls, of the same seeds.
    pub c: &'a [f64],
    /// N.
    pub samples: usize,
    /// Expectation of the controls.
    pub mu: &'a [f64],
    /// Covariance of `mu`, row by row: that of one cheap simulation over their number. None if `mu` is exact.
    pub covariance_of_mu: Option<&'a [f64]>,
}

/// Work space of [`carpool`] for `values` values of y and `controls` of c.
///
/// # Errors
/// `Overflow` for more than 65536 of either.
///
/// # Example
/// ```
/// use fixpair::variance::carpool::carpool_scratch;
///
/// assert!(carpool_scratch(14, 14)?.size >= 3 * 14 * 14 * 8);
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn carpool_scratch(values: usize, controls: usize) -> Result<Layout> {
    let columns = values.checked_add(1).ok_or(Error::Overflow)?;
    let right = columns.checked_mul(controls).ok_or(Error::Overflow)?;
    let sound = Layout::EMPTY
        .and::<f64>(square(controls)?)?
        .and::<f64>(right)?
        .and::<f64>(square(values)?)?
        .and::<f64>(controls)?
        .and::<f64>(controls)?
        .and::<f64>(values)?
        .and::<f64>(values)?
        .and::<f64>(values)?;
    sound.and::<u8>(bytes(values, controls))
}

fn bytes(values: usize, controls: usize) -> usize {
    dense::factor_bytes(controls).max(dense::solve_bytes(controls, values + 1))
}

/// The expectation of y, its covariance, and B: values numbers, values x values, values x controls, row by row.
///
/// The covariance is C_rest (1/N + d^T S^-1 d) + B C_mu B^T with d the mean of c less mu, S = (N - 1) (C_cc + N C_mu), and C_rest the covariance of what B leaves, of N - 1 - controls
/// degrees of freedom: estimating B is paid for, on average with the (N - 2)/(N - controls - 2) of
/// [`control_variate_loss`](super::control::control_variate_loss). Where its inverse is used, Hartlap's factor is due with N - controls for N.
///
/// # Errors
/// `Length` for arrays of other sizes or none, `Samples` unless N >= controls + 3, `NotFinite`, `Range` for samples beyond 1e140, a `covariance_of_mu` that is not one, or a result that overflows,
/// `Singular` where controls are combinations of others, `Scratch`. Outputs are untouched by all of them.
///
/// # Example
/// ```
/// use fixpair::variance::carpool::{Carpool, carpool};
/// # #[repr(align(64))] struct Memory([u8; 1 << 16]);
/// # let mut memory = Memory([0; 1 << 16]);
/// # let scratch = &mut memory.0;
///
/// let of = Carpool {
///     y: &[104.0, 97.0, 99.0, 101.0, 102.0, 98.0], // f100 of six seeds
///     c: &[4.0, -3.0, -1.0, 1.0, 2.0, -2.0],       // f0
///     samples: 6,
///     mu: &[0.0],
///     covariance_of_mu: None,
/// };
/// let (mut mean, mut covariance, mut beta) = ([0.0], [0.0], [0.0]);
/// carpool(&mut mean, &mut covariance, &mut beta, &of, scratch)?;
/// assert!((beta[0] - 1.0).abs() < 0.1 && (mean[0] - 100.0).abs() < 0.2);
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn carpool(
    mean: &mut [f64],
    covariance: &mut [f64],
    beta: &mut [f64],
    of: &Carpool<'_>,
    scratch: &mut [u8],
) -> Result<()> {
    let (values, controls, samples) = (mean.len(), of.mu.len(), of.samples);
    let sizes = [square(values)?, values.checked_mul(controls).ok_or(Error::Overflow)?];
    if values == 0 || controls == 0 || [covariance.len(), beta.len()] != sizes {
        return Err(Error::Length);
    }
    table(of.y, samples, values)?;
    table(of.c, samples, controls)?;
    finite(of.mu)?;
    if samples < controls.saturating_add(3) {
        return Err(Error::Samples);
    }
    if of.y.iter().chain(of.c).chain(of.mu).any(|x| x.abs() > LARGEST_SAMPLE) {
        return Err(Error::Range);
    }
    if let Some(of_mu) = of.covariance_of_mu {
        super::check::same_length(square(controls)?, &[of_mu.len()])?;
        check_covariance(of_mu, controls)?;
    }
    let mut arena = Arena::new(scratch, carpool_scratch(values, controls)?)?;
    let matrix = arena.take::<f64>(controls * controls)?;
    let right = arena.take::<f64>((values + 1) * controls)?;
    let result = arena.take::<f64>(values * values)?;
    let (c_mean, deviation) = (arena.take::<f64>(controls)?, arena.take::<f64>(controls)?);
    let (y_mean, rest, estimate) =
        (arena.take::<f64>(values)?, arena.take::<f64>(values)?, arena.take::<f64>(values)?);
    let work = arena.take::<u8>(bytes(values, controls))?;
    mean_of(c_mean, of.c);
    mean_of(y_mean, of.y);

    // C_cc + N C_mu, the cross-covariance, and d in the last column.
    let count = samples as f64;
    matrix.fill(0.0);
    right.fill(0.0);
    for (y, c) in of.y.chunks_exact(values).zip(of.c.chunks_exact(controls)) {
        for i in 0..controls {
            let x = (c[i] - c_mean[i]) / (count - 1.0);
            for j in 0..controls {
                matrix[i * controls + j] += x * (c[j] - c_mean[j]);
            }
            for j in 0..values {
                right[j * controls + i] += x * (y[j] - y_mean[j]);
            }
        }
    }
    if let Some(of_mu) = of.covariance_of_mu {
        matrix.iter_mut().zip(of_mu).for_each(|(sum, of_mu)| *sum += count * of_mu);
    }
    for i in 0..controls {
        deviation[i] = sqrt(matrix[i * controls + i]);
        if !deviation[i].is_finite() {
            return Err(Error::Range);
        }
        if deviation[i] == 0.0 {
            return Err(Error::Singular);
        }
        right[values * controls + i] = c_mean[i] - of.mu[i];
    }
    for (at, x) in matrix.iter_mut().enumerate() {
        *x = *x / deviation[at / controls] / deviation[at % controls];
    }
    dense::factor(matrix, controls, work)?;
    for column in right.chunks_exact_mut(controls) {
        column.iter_mut().zip(&*deviation).for_each(|(x, deviation)| *x /= deviation);
    }
    dense::solve(right, matrix, controls, values + 1, work);
    for column in right.chunks_exact_mut(controls) {
        column.iter_mut().zip(&*deviation).for_each(|(x, deviation)| *x /= deviation);
    }
    // Columns of `right` are now rows of B, and S^-1 d (N - 1).
    let (b, solved) = right.split_at(values * controls);
    let distance: f64 =
        (0..controls).map(|i| solved[i] * (c_mean[i] - of.mu[i])).sum::<f64>() / (count - 1.0);
    let dot = |row: &[f64], of: &dyn Fn(usize) -> f64| -> f64 {
        row.iter().enumerate().map(|(i, b)| b * of(i)).sum()
    };
    for (i, row) in b.chunks_exact(controls).enumerate() {
        estimate[i] = y_mean[i] - dot(row, &|j| c_mean[j] - of.mu[j]);
    }

    result.fill(0.0);
    let weight = (1.0 / count + distance) / (samples - 1 - controls) as f64;
    for (y, c) in of.y.chunks_exact(values).zip(of.c.chunks_exact(controls)) {
        for (i, row) in b.chunks_exact(controls).enumerate() {
            rest[i] = (y[i] - y_mean[i]) - dot(row, &|j| c[j] - c_mean[j]);
        }
        for i in 0..values {
            for j in 0..values {
                result[i * values + j] += weight * rest[i] * rest[j];
            }
        }
    }
    if let Some(of_mu) = of.covariance_of_mu {
        for (i, left) in b.chunks_exact(controls).enumerate() {
            for (j, right) in b.chunks_exact(controls).enumerate() {
                result[i * values + j] += dot(left, &|k| dot(right, &|l| of_mu[k * controls + l]));
            }
        }
    }
    finite(result).and_then(|()| finite(estimate)).and_then(|()| finite(b)).map_err(|_| Error::Range)?;
    mean.copy_from_slice(estimate);
    covariance.copy_from_slice(result);
    beta.copy_from_slice(b);
    Ok(())
}

/// Of the columns of a table.
fn mean_of(mean: &mut [f64], rows: &[f64]) {
    mean.fill(0.0);
    let (width, count) = (mean.len(), (rows.len() / mean.len()) as f64);
    for row in rows.chunks_exact(width) {
        mean.iter_mut().zip(row).for_each(|(mean, x)| *mean += x);
    }
    mean.iter_mut().for_each(|mean| *mean /= count);
}
