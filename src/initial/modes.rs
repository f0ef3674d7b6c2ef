//! Multiplying modes by functions of k, and moving modes between meshes of different side.
//!
//! Mode numbers are n = (i, j, l), k = (2 pi/L) n. The Nyquist modes, |n_a| = N/2 on any axis of the smaller mesh, stand for two
//! wave vectors at once; derivatives of them are not defined, products alias onto them, and they are set to zero.

use crate::cosmology::mode_table_length;
use crate::exec::Exec;
use crate::mesh::{Brick, Space};
use crate::real::Real;
use crate::simd::Simd;
use crate::status::{Error, Result};
use crate::walk::walk;
use crate::within::Within;

/// What a mode is multiplied by: a real function of its mode number, times 1 or i.
pub(crate) trait Factor: Sync {
    /// Multiply by i as well.
    const IMAGINARY: bool;
    /// The real part of the story.
    fn at(&self, n: [f64; 3]) -> f64;
}

/// f_k <- f_k table(|n|^2), in place; Nyquist modes become zero.
///
/// `modes`: Fourier `brick`; `table`: at least [`mode_table_length`] values.
///
/// # Errors
/// `Brick` for a brick of configuration space, `Length` for short arrays, `NotFinite` for a table with such an entry. The modes
/// themselves are not checked.
///
/// Cost: one pass over the modes.
///
/// # Example
/// ```
/// use fixpair::exec::Serial;
/// use fixpair::initial::modes::scale_by_table;
/// use fixpair::mesh::{Brick, Space};
///
/// let brick = Brick::whole(8, Space::Fourier)?;
/// let (mut modes, table) = (vec![1.0_f64; brick.reals()], core::array::from_fn::<_, 49, _>(|square| square as f64));
/// scale_by_table(&mut modes, &brick, &table, &Serial)?; // by |n|^2
/// assert_eq!((modes[0], modes[2], modes[4]), (0.0, 1.0, 4.0));
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn scale_by_table<T: Real>(modes: &mut [T], brick: &Brick, table: &[f64], exec: &dyn Exec) -> Result<()> {
    brick.check_space(Space::Fourier)?;
    let n = brick.n();
    let table = table.get(..mode_table_length(n)?).ok_or(Error::Length)?;
    if table.iter().any(|factor| !factor.is_finite()) {
        return Err(Error::NotFinite);
    }
    walk::<T, 1, 0>(exec, brick, [modes], [], &|run, [row], []| {
        let (x, y) = (Brick::mode(n, run.index[0]), Brick::mode(n, run.index[1]));
        let inside = inside(run.index[2], run.length, [x, y], n / 2);
        let square = (x * x + y * y) as usize;
        for (m, mode) in row.chunks_exact_mut(2).enumerate() {
            let z = run.index[2] + m;
            let scale = if m < inside { table.at(square + z * z) } else { 0.0 };
            mode[0] = T::from_f64(mode[0].to_f64() * scale);
            mode[1] = T::from_f64(mode[1].to_f64() * scale);
        }
    })
}

/// to_k <- factor(n) from_k for the modes that both meshes hold as proper modes (|n_a| < half the smaller side), zero for
/// all others. With `to` larger this pads for an alias-free product; with `to` smaller it drops what lies beyond.
///
/// # Errors
/// `Brick` for bricks of configuration space or where `from` lacks a mode that `to` holds, `Length` for short arrays.
pub(crate) fn map_modes<T: Real, F: Factor>(
    to: &mut [T],
    to_brick: &Brick,
    from: &[T],
    from_brick: &Brick,
    factor: &F,
    exec: &dyn Exec,
) -> Result<()> {
    combine_modes::<T, F, false>(to, to_brick, from, from_brick, factor, exec)
}

/// to_k <- to_k + factor(n) from_k for the same modes; all others keep their bits.
///
/// # Errors
/// As [`map_modes`].
pub(crate) fn add_modes<T: Real, F: Factor>(
    to: &mut [T],
    to_brick: &Brick,
    from: &[T],
    from_brick: &Brick,
    factor: &F,
    exec: &dyn Exec,
) -> Result<()> {
    combine_modes::<T, F, true>(to, to_brick, from, from_brick, factor, exec)
}

fn combine_modes<T: Real, F: Factor, const ADD: bool>(
    to: &mut [T],
    to_brick: &Brick,
    from: &[T],
    from_brick: &Brick,
    factor: &F,
    exec: &dyn Exec,
) -> Result<()> {
    to_brick.check_space(Space::Fourier)?;
    from_brick.check_space(Space::Fourier)?;
    from_brick.check_length(from)?;
    if !holds_modes_of(from_brick, to_brick) {
        return Err(Error::Brick);
    }
    let half = to_brick.n().min(from_brick.n()) / 2;
    let (start, stride) = (from_brick.start(), from_brick.stride());
    let simd = Simd::detect();
    walk::<T, 1, 0>(exec, to_brick, [to], [], &|run, [row], []| {
        let x = Brick::mode(to_brick.n(), run.index[0]);
        let y = Brick::mode(to_brick.n(), run.index[1]);
        let z = run.index[2];
        let inside = inside(z, run.length, [x, y], half);
        if !ADD {
            row.part_mut(2 * inside..).fill(T::ZERO);
        }
        if inside == 0 {
            return;
        }
        let offset = (index(x, from_brick.n()) - start[0]) * stride[0]
            + (index(y, from_brick.n()) - start[1]) * stride[1]
            + (z - start[2]) * stride[2];
        let n = [x as f64, y as f64, z as f64];
        if stride[2] == 1 {
            let source = from.part(2 * offset..2 * (offset + inside));
            simd.vectorise(
                #[inline(always)]
                || multiply_row::<T, F, ADD>(row.part_mut(..2 * inside), source, n, factor),
            );
        } else {
            for (m, mode) in row.chunks_exact_mut(2).enumerate().take(inside) {
                let at = 2 * (offset + m * stride[2]);
                let n = [n[0], n[1], n[2] + m as f64];
                multiply_row::<T, F, ADD>(mode, from.part(at..at + 2), n, factor);
            }
        }
    })
}

/// Modes whose factors are computed at a time.
const BLOCK: usize = 32;

#[inline(always)]
fn multiply_row<T: Real, F: Factor, const ADD: bool>(to: &mut [T], from: &[T], n: [f64; 3], factor: &F) {
    let mut factors = [0.0; BLOCK];
    for (block, (to, from)) in to.chunks_mut(2 * BLOCK).zip(from.chunks(2 * BLOCK)).enumerate() {
        // The whole block at any length of the row: a loop of fixed length becomes vectors.
        let z = n[2] + (block * BLOCK) as f64;
        for (m, c) in factors.iter_mut().enumerate() {
            *c = factor.at([n[0], n[1], z + f64::from(m as i32)]);
        }
        for ((t, f), &c) in to.chunks_exact_mut(2).zip(from.chunks_exact(2)).zip(&factors) {
            let (mut re, mut im) = (c * f[0].to_f64(), c * f[1].to_f64());
            if F::IMAGINARY {
                (re, im) = (-im, re);
            }
            if ADD {
                (re, im) = (t[0].to_f64() + re, t[1].to_f64() + im);
            }
            t[0] = T::from_f64(re);
            t[1] = T::from_f64(im);
        }
    }
}

/// Of `length` modes from z on, in the row (x, y): how many lie inside |n_a| < half.
pub(super) fn inside(z: usize, length: usize, [x, y]: [i64; 2], half: usize) -> usize {
    if x.unsigned_abs() as usize >= half || y.unsigned_abs() as usize >= half {
        return 0;
    }
    half.saturating_sub(z).min(length)
}

/// The index on axis 0 or 1 of a signed mode number.
fn index(mode: i64, n: usize) -> usize {
    if mode < 0 { n - mode.unsigned_abs() as usize } else { mode as usize }
}

/// Does `from` hold each proper mode that `to` holds?
fn holds_modes_of(from: &Brick, to: &Brick) -> bool {
    let half = to.n().min(from.n()) / 2;
    let held = |axis: usize, at: usize| {
        let start = from.start()[axis];
        (start..start + from.count()[axis]).contains(&at)
    };
    let needed = |axis: usize| {
        let start = to.start()[axis];
        (start..start + to.count()[axis]).filter_map(move |at| {
            let mode = if axis == 2 { at as i64 } else { Brick::mode(to.n(), at) };
            (mode.unsigned_abs() < half as u64).then(|| index(mode, from.n()))
        })
    };
    to.is_empty() || (0..3).all(|axis| needed(axis).all(|at| held(axis, at)))
}

/// f_k <- f_k.
pub(crate) struct Copy;

impl Factor for Copy {
    const IMAGINARY: bool = false;

    #[inline(always)]
    fn at(&self, _: [f64; 3]) -> f64 {
        1.0
    }
}

/// f_k <- scale f_k, and no mean.
pub(crate) struct Scale(pub(crate) f64);

impl Factor for Scale {
    const IMAGINARY: bool = false;

    #[inline(always)]
    fn at(&self, n: [f64; 3]) -> f64 {
        if n == [0.0; 3] { 0.0 } else { self.0 }
    }
}

/// f_k <- table(|n|^2) f_k, for modes inside the table.
pub(crate) struct ByTable<'a>(pub(crate) &'a [f64]);

impl Factor for ByTable<'_> {
    const IMAGINARY: bool = false;

    #[inline(always)]
    fn at(&self, n: [f64; 3]) -> f64 {
        // Blocks of factors reach beyond the last mode of a row, and so beyond the table.
        let square = (n[0] * n[0] + n[1] * n[1] + n[2] * n[2]) as usize;
        self.0.get(square).copied().unwrap_or(0.0)
    }
}

/// Copies modes from one mesh to another of any side; modes that only the larger has are dropped or become zero, and so do the
/// Nyquist modes of the smaller.
///
/// # Errors
/// `Brick` for bricks of configuration space or where `from` lacks a mode that `to` holds (slabs of different sides
/// have to be exchanged by the host), `Length` for short arrays.
///
/// Cost: one pass over `to`.
///
/// # Example
/// ```
/// use fixpair::exec::Serial;
/// use fixpair::initial::modes::copy_modes;
/// use fixpair::mesh::{Brick, Space};
///
/// let (coarse, fine) = (Brick::whole(8, Space::Fourier)?, Brick::whole(12, Space::Fourier)?);
/// let (from, mut to) = (vec![1.0_f64; coarse.reals()], vec![0.0_f64; fine.reals()]);
/// copy_modes(&mut to, &fine, &from, &coarse, &Serial)?; // what they share; the rest is zero
/// assert_eq!((to[2], to[2 * 5]), (1.0, 0.0));
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn copy_modes<T: Real>(
    to: &mut [T],
    to_brick: &Brick,
    from: &[T],
    from_brick: &Brick,
    exec: &dyn Exec,
) -> Result<()> {
    map_modes(to, to_brick, from, from_brick, &Copy, exec)
}
