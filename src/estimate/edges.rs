//! Edges of bins: integers |n|^2 from what a user has in mind.
//!
//! Bin b holds `edges[b] <= |n|^2 < edges[b+1]`. An edge at |n| = x becomes the least integer >= x^2; an x^2 that lies within 1e-9 (relative)
//! of an integer is that integer, so that k = 3 k_f given in h/Mpc is 9 whichever way it was rounded.

use crate::status::{Error, Result};
use crate::within::Within;

/// Relative distance at which x^2 is taken for an integer: far above the rounding of users' tables, and below 1/|n|^2 for
/// |n| < 3e4; beyond, edges go to the nearest integer.
const SNAP: f64 = 1e-9;

/// The integer edge at |n| = x.
fn edge(x: f64) -> Result<u64> {
    if !x.is_finite() {
        return Err(Error::NotFinite);
    }
    if !(0.0..4e9).contains(&x) {
        return Err(Error::Range);
    }
    let square = x * x;
    let nearest = libm::rint(square);
    let value = if (square - nearest).abs() <= SNAP * nearest { nearest } else { libm::ceil(square) };
    Ok(value as u64)
}

/// Writes edges once all of them are known to increase.
fn fill(edges: &mut [u64], at: impl Fn(usize) -> Result<u64>) -> Result<()> {
    if edges.len() < 2 {
        return Err(Error::Table);
    }
    let mut last = at(0)?;
    for b in 1..edges.len() {
        let next = at(b)?;
        if next <= last {
            return Err(Error::Table);
        }
        last = next;
    }
    for (b, edge) in edges.iter_mut().enumerate() {
        *edge = at(b)?;
    }
    Ok(())
}

/// Edges at |n| = first + b width, b = 0, 1, ...
///
/// first = 1, width = 1: unit shells [1, 2), [2, 3), ... First = w/2, width = w: shells about w, 2w, ...; a mode goes to the nearest.
///
/// # Errors
/// `NotFinite`; `Range` for an edge below 0 or at 4e9 and above; `Table` for fewer than two edges or edges that do not increase as integers.
///
/// # Example
/// ```
/// use fixpair::estimate::edges::uniform_edges;
///
/// let mut edges = [0; 4];
/// uniform_edges(&mut edges, 1.5, 3.0)?; // shells of 3 k_f about 3, 6, 9 k_f
/// assert_eq!(edges, [3, 21, 57, 111]);
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn uniform_edges(edges: &mut [u64], first: f64, width: f64) -> Result<()> {
    if !first.is_finite() || !width.is_finite() {
        return Err(Error::NotFinite);
    }
    fill(edges, |b| edge(first + b as f64 * width))
}

/// Edges at wavenumbers k in h/Mpc, for a box of side L in Mpc/h: |n| = k L/(2 pi).
///
/// # Errors
/// As [`uniform_edges`]; `Length` if there are not as many edges as wavenumbers; `Range` for a box that is not positive.
///
/// # Example
/// ```
/// use fixpair::estimate::edges::wavenumber_edges;
///
/// let mut edges = [0; 2];
/// wavenumber_edges(&mut edges, &[0.01, 0.02], 1000.0)?; // h/Mpc, Mpc/h
/// assert_eq!(edges, [3, 11]);
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn wavenumber_edges(edges: &mut [u64], wavenumbers: &[f64], box_size: f64) -> Result<()> {
    if !box_size.is_finite() {
        return Err(Error::NotFinite);
    }
    if box_size <= 0.0 {
        return Err(Error::Range);
    }
    if edges.len() != wavenumbers.len() {
        return Err(Error::Length);
    }
    fill(edges, |b| edge(wavenumbers.at(b) * box_size / core::f64::consts::TAU))
}

/// Every |n|^2 is its own bin: first, first + 1, first + 2, ... Bins of numbers that are no sum of three squares (7, 15, ...) stay empty.
///
/// # Errors
/// `Table` for fewer than two edges, `Overflow` beyond 2^64.
///
/// # Example
/// ```
/// use fixpair::estimate::edges::exact_edges;
///
/// let mut edges = [0; 4];
/// exact_edges(&mut edges, 1)?; // a bin for each |n|^2
/// assert_eq!(edges, [1, 2, 3, 4]);
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn exact_edges(edges: &mut [u64], first: u64) -> Result<()> {
    fill(edges, |b| first.checked_add(b as u64).ok_or(Error::Overflow))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unit_and_nearest_shells_have_the_usual_edges() {
        let mut edges = [0; 5];
        uniform_edges(&mut edges, 1.0, 1.0).unwrap();
        assert_eq!(edges, [1, 4, 9, 16, 25]);
        uniform_edges(&mut edges, 1.5, 3.0).unwrap();
        assert_eq!(edges, [3, 21, 57, 111, 183], "2.25, 20.25, 56.25, 110.25, 182.25");
        exact_edges(&mut edges, 7).unwrap();
        assert_eq!(edges, [7, 8, 9, 10, 11]);
    }

    #[test]
    fn a_wavenumber_on_a_mode_is_that_mode() {
        for box_size in [1000.0, 250.0, 739.1, 1.0 / 3.0] {
            let unit = core::f64::consts::TAU / box_size;
            let wavenumbers = core::array::from_fn::<_, 60, _>(|b| (b + 1) as f64 * unit);
            let mut edges = [0; 60];
            wavenumber_edges(&mut edges, &wavenumbers, box_size).unwrap();
            assert!(edges.iter().zip(1..).all(|(&edge, b)| edge == b * b));
        }
    }

    #[test]
    fn bad_edges_are_refused_and_nothing_is_written() {
        let mut edges = [5; 3];
        assert_eq!(uniform_edges(&mut edges, 1.0, 0.0), Err(Error::Table));
        assert_eq!(uniform_edges(&mut edges, -1.0, 2.0), Err(Error::Range));
        assert_eq!(uniform_edges(&mut edges, 0.1, 0.1), Err(Error::Table), "0.01 and 0.04 are both 1");
        assert_eq!(uniform_edges(&mut edges, f64::NAN, 1.0), Err(Error::NotFinite));
        assert_eq!(uniform_edges(&mut edges, 1.0, 1e300), Err(Error::Range));
        assert_eq!(uniform_edges(&mut edges[..1], 1.0, 1.0), Err(Error::Table));
        assert_eq!(wavenumber_edges(&mut edges, &[0.1, 0.2], 100.0), Err(Error::Length));
        assert_eq!(wavenumber_edges(&mut edges, &[0.1, 0.2, 0.3], 0.0), Err(Error::Range));
        assert_eq!(wavenumber_edges(&mut edges, &[0.1, 0.2, f64::INFINITY], 900.0), Err(Error::NotFinite));
        assert_eq!(exact_edges(&mut edges, u64::MAX - 1), Err(Error::Overflow));
        assert_eq!(edges, [5; 3]);
    }
}
