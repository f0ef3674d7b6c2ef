//! What every kernel of this room asks of its numbers before it writes the first of them.

use crate::status::{Error, Result};

pub(super) fn finite(values: &[f64]) -> Result<()> {
    if values.iter().all(|x| x.is_finite()) { Ok(()) } else { Err(Error::NotFinite) }
}

/// Finite, and greater than zero.
pub(super) fn positive(values: &[f64]) -> Result<()> {
    finite(values)?;
    if values.iter().all(|&x| x > 0.0) { Ok(()) } else { Err(Error::Range) }
}

/// Finite, and zero or more.
pub(super) fn not_negative(values: &[f64]) -> Result<()> {
    finite(values)?;
    if values.iter().all(|&x| x >= 0.0) { Ok(()) } else { Err(Error::Range) }
}

/// A result that must not be infinite or NaN: if it is, some parameter was too extreme.
pub(super) fn result(value: f64) -> Result<f64> {
    if value.is_finite() { Ok(value) } else { Err(Error::Range) }
}

pub(super) fn same_length(len: usize, others: &[usize]) -> Result<()> {
    if others.iter().all(|&other| other == len) { Ok(()) } else { Err(Error::Length) }
}

/// `rows` rows of `columns` values.
pub(super) fn table(values: &[f64], rows: usize, columns: usize) -> Result<()> {
    let len = rows.checked_mul(columns).ok_or(Error::Overflow)?;
    same_length(len, &[values.len()])?;
    finite(values)
}

/// Writes `of(i)` to `out[i]`, all of them or none.
pub(super) fn fill(out: &mut [f64], of: impl Fn(usize) -> Result<f64>) -> Result<()> {
    for i in 0..out.len() {
        of(i)?;
    }
    for (i, out) in out.iter_mut().enumerate() {
        *out = of(i)?;
    }
    Ok(())
}

/// As [`fill`], for a value and its error.
pub(super) fn fill_two(
    first: &mut [f64],
    second: &mut [f64],
    of: impl Fn(usize) -> Result<[f64; 2]>,
) -> Result<()> {
    same_length(first.len(), &[second.len()])?;
    for i in 0..first.len() {
        of(i)?;
    }
    for (i, (first, second)) in first.iter_mut().zip(second).enumerate() {
        [*first, *second] = of(i)?;
    }
    Ok(())
}
