//! Shells of modes.

use crate::exec::Exec;
use crate::mesh::{Brick, Space};
use crate::real::Real;
use crate::status::{Error, Result};
use crate::walk::walk;
use crate::within::Within;

/// `Table` for edges that are fewer than two or not increasing.
pub(super) fn check_edges(edges: &[u64]) -> Result<()> {
    let increasing = edges.windows(2).all(|pair| pair[0] < pair[1]);
    if edges.len() < 2 || !increasing || u32::try_from(edges.len()).is_err() {
        Err(Error::Table)
    } else {
        Ok(())
    }
}

/// `Table` as [`check_edges`], `Range` for shells that reach the Nyquist planes of a mesh of side n.
pub(super) fn check_shells(edges: &[u64], n: usize) -> Result<()> {
    check_edges(edges)?;
    let half = n as u64 / 2;
    let last = edges.at(edges.len() - 1);
    if half.checked_mul(half).is_none_or(|square| last > square) { Err(Error::Range) } else { Ok(()) }
}

/// How many integers c >= 0 have c^2 < r.
pub(super) fn squares_below(r: u64) -> u64 {
    let mut c = libm::sqrt(r as f64) as u64;
    while c > 0 && (c - 1) * (c - 1) >= r {
        c -= 1;
    }
    while c * c < r {
        c += 1;
    }
    c
}

/// Copies the modes of one shell, `lo <= |n|^2 < hi`, and makes all others zero.
///
/// `out`, `modes`: on the Fourier brick `brick`, any layout. The inverse transform of `out` is D_s(x).
///
/// # Errors
/// `Brick` for a brick of configuration space, `Length` for short arrays, `Table` unless lo < hi, `Range` if the shell reaches the Nyquist
/// planes (hi > (n/2)^2). `Hook` as [`Exec::parallel_for`]. `out` is untouched by all but the last.
///
/// Cost: `out` is written once; of `modes` only the shell is read.
///
/// # Example
/// ```
/// use fixpair::estimate::bispectrum::shell_modes;
/// use fixpair::exec::Serial;
/// use fixpair::mesh::{Brick, Space};
///
/// let brick = Brick::whole(8, Space::Fourier)?;
/// let (modes, mut shell) = (vec![1.0_f64; brick.reals()], vec![0.0; brick.reals()]);
/// shell_modes(&mut shell, &modes, &brick, 1, 4, &Serial)?; // 1 <= |n|^2 < 4
/// assert_eq!((shell[0], shell[2], shell[4]), (0.0, 1.0, 0.0));
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn shell_modes<T: Real>(
    out: &mut [T],
    modes: &[T],
    brick: &Brick,
    lo: u64,
    hi: u64,
    exec: &dyn Exec,
) -> Result<()> {
    brick.check_space(Space::Fourier)?;
    check_shells(&[lo, hi], brick.n())?;
    brick.check_length(modes)?;
    brick.check_length(out)?;
    walk::<T, 1, 1>(exec, brick, [out], [modes], &|run, [row], [from]| {
        let mode = |axis: usize| Brick::mode(brick.n(), run.index[axis]).unsigned_abs();
        let square = mode(0) * mode(0) + mode(1) * mode(1);
        // In a row the shell is one stretch of l.
        let end = |edge: u64| {
            let l = squares_below(edge.saturating_sub(square)) as usize;
            2 * l.saturating_sub(run.index[2]).min(run.length)
        };
        let (first, last) = (end(lo), end(hi));
        row.part_mut(..first).fill(T::ZERO);
        row.part_mut(first..last).copy(from.part(first..last));
        row.part_mut(last..).fill(T::ZERO);
    })
}
