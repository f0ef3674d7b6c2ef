//! Products of fields without aliasing, on meshes of the fields' own side: the second differences of a potential, shifted by
//! half cells.
//!
//! A mesh of side 2N is eight meshes of side N, each shifted by none or half a cell on each axis. On it a product of up to three
//! fields whose modes lie below N/2 folds only onto modes that are dropped. So the mean over the eight shifts of what each mesh of
//! side N gives, shifted back, is exact: a fold on any axis changes sign between the two shifts of that axis (Patterson & Orszag 1971,
//! Phys. Fluids 14, 2538). It costs what the mesh of side 2N would, in an eighth of its memory, and asks for no mode that the caller's
//! part of the mesh does not hold: slabs need no exchange.

use super::modes::inside;
use crate::exec::Exec;
use crate::math::sin_cos_turns;
use crate::mesh::Brick;
use crate::real::Real;
use crate::simd::Simd;
use crate::status::{Error, Result};
use crate::walk::walk;
use crate::within::Within;

/// Shifts that make a product exact.
pub(super) const SHIFTS: usize = 8;

/// The pairs of axes of a symmetric tensor, in the order of every array of six here.
const PAIRS: [[usize; 2]; 6] = [[0, 0], [1, 1], [2, 2], [0, 1], [0, 2], [1, 2]];

/// Modes whose factors are computed at a time.
const BLOCK: usize = 32;

/// What half a cell does to modes: exp(i pi m/N) for m = 0 .. N/2.
#[derive(Clone, Copy)]
pub struct HalfCells<'a>(&'a [[f64; 2]]);

/// Entries of [`HalfCells`] of a mesh of side `n`.
///
/// ```
/// use fixpair::initial::shifted::half_cells_length;
///
/// assert!(half_cells_length(8) > 0);
/// ```
#[must_use]
pub const fn half_cells_length(n: usize) -> usize {
    n / 2 + 1
}

impl<'a> HalfCells<'a> {
    /// Fills the table for a mesh of side `n`.
    ///
    /// # Errors
    /// `Length` if it has less than [`half_cells_length`] entries.
    ///
    /// # Example
    /// ```
    /// use fixpair::initial::shifted::{HalfCells, half_cells_length};
    ///
    /// let mut table = vec![[0.0; 2]; half_cells_length(8)];
    /// assert!(HalfCells::new(&mut table, 8).is_ok());
    /// ```
    pub fn new(table: &'a mut [[f64; 2]], n: usize) -> Result<Self> {
        let table = table.get_mut(..half_cells_length(n)).ok_or(Error::Length)?;
        for (m, phase) in table.iter_mut().enumerate() {
            let (sine, cosine) = sin_cos_turns(m as f64 / (2.0 * n as f64));
            *phase = [cosine, sine];
        }
        Ok(Self(table))
    }

    /// exp(i pi m/N) for any signed m.
    fn at(self, m: i64) -> [f64; 2] {
        let [re, im] = Within::at(self.0, m.unsigned_abs() as usize);
        [re, if m < 0 { -im } else { im }]
    }

    /// The factor of one shift that a row (x, y) of modes shares, and the table along the row if the shift has a z.
    fn row(self, shift: usize, [x, y]: [i64; 2]) -> ([f64; 2], Option<&'a [[f64; 2]]>) {
        let mut phase = [1.0, 0.0];
        if shift & 1 != 0 {
            phase = self.at(x);
        }
        if shift & 2 != 0 {
            phase = times(phase, self.at(y));
        }
        (phase, (shift & 4 != 0).then_some(self.0))
    }
}

#[inline(always)]
fn times(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0] * b[0] - a[1] * b[1], a[0] * b[1] + a[1] * b[0]]
}

/// Factors of a block of modes from z on.
#[inline(always)]
fn phases(row: [f64; 2], along: Option<&[[f64; 2]]>, z: usize, out: &mut [[f64; 2]; BLOCK]) {
    match along {
        None => out.fill(row),
        Some(table) => {
            for (phase, &step) in out.iter_mut().zip(table.part(z..)) {
                *phase = times(row, step);
            }
        }
    }
}

/// out_ab,k <- n_a n_b/|n|^2 exp(i k.d) modes_k, d the shift: the modes of the six second differences of the potential whose Laplacian is
/// the field, seen from a mesh shifted by d. Nyquist modes become zero.
///
/// Cost: one pass that reads one mesh and writes six.
pub(super) fn tidal_tensor<T: Real>(
    out: [&mut [T]; 6],
    modes: &[T],
    brick: &Brick,
    shift: usize,
    half_cells: HalfCells<'_>,
    exec: &dyn Exec,
) -> Result<()> {
    let n = brick.n();
    let simd = Simd::detect();
    walk::<T, 6, 1>(exec, brick, out, [modes], &|run, out, [row]| {
        let xy = [Brick::mode(n, run.index[0]), Brick::mode(n, run.index[1])];
        let z = run.index[2];
        let inside = inside(z, run.length, xy, n / 2);
        let mut out = out.map(|mesh| {
            mesh.part_mut(2 * inside..).fill(T::ZERO);
            mesh.part_mut(..2 * inside)
        });
        let (phase, along) = half_cells.row(shift, xy);
        simd.vectorise(
            #[inline(always)]
            || tidal_row(&mut out, row.part(..2 * inside), xy, z, phase, along),
        );
    })
}

#[inline(always)]
fn tidal_row<T: Real>(
    out: &mut [&mut [T]; 6],
    row: &[T],
    [x, y]: [i64; 2],
    z: usize,
    phase: [f64; 2],
    along: Option<&[[f64; 2]]>,
) {
    let (x, y) = (x as f64, y as f64);
    let mut factors = [[0.0; 2]; BLOCK];
    let mut values = [[0.0; 2]; BLOCK];
    for (block, from) in row.chunks(2 * BLOCK).enumerate() {
        let first = block * BLOCK;
        phases(phase, along, z + first, &mut factors);
        for ((m, value), from) in values.iter_mut().enumerate().zip(from.chunks_exact(2)) {
            let l = (z + first + m) as f64;
            let inverse = 1.0 / (x * x + y * y + l * l).max(1.0);
            *value = times(factors[m], [from[0].to_f64() * inverse, from[1].to_f64() * inverse]);
        }
        for (out, [a, b]) in out.iter_mut().zip(PAIRS) {
            let to = out.part_mut(2 * first..2 * first + from.len());
            for ((m, to), value) in to.chunks_exact_mut(2).enumerate().zip(&values) {
                let n = [x, y, (z + first + m) as f64];
                let tensor = n[a] * n[b];
                to[0] = T::from_f64(tensor * value[0]);
                to[1] = T::from_f64(tensor * value[1]);
            }
        }
    }
}

/// sum_k <- sum_k + scale exp(-i k.d) modes_k for each of `K` fields: back from a mesh shifted by d. The first shift sets the sums, Nyquist modes
/// to zero, instead.
///
/// Cost: one pass that reads K meshes and changes K.
pub(super) fn gather_shift<T: Real, const K: usize>(
    sums: [&mut [T]; K],
    modes: [&[T]; K],
    brick: &Brick,
    scale: f64,
    shift: usize,
    half_cells: HalfCells<'_>,
    exec: &dyn Exec,
) -> Result<()> {
    let n = brick.n();
    let simd = Simd::detect();
    walk::<T, K, K>(exec, brick, sums, modes, &|run, sums, rows| {
        let xy = [Brick::mode(n, run.index[0]), Brick::mode(n, run.index[1])];
        let z = run.index[2];
        let inside = inside(z, run.length, xy, n / 2);
        let ([re, im], along) = half_cells.row(shift, xy);
        let phase = [scale * re, scale * im];
        for (sum, row) in sums.into_iter().zip(rows) {
            if shift == 0 {
                sum.fill(T::ZERO);
            }
            let (sum, row) = (sum.part_mut(..2 * inside), row.part(..2 * inside));
            simd.vectorise(
                #[inline(always)]
                || gather_row(sum, row, z, phase, along),
            );
        }
    })
}

#[inline(always)]
fn gather_row<T: Real>(sum: &mut [T], row: &[T], z: usize, phase: [f64; 2], along: Option<&[[f64; 2]]>) {
    let mut factors = [[0.0; 2]; BLOCK];
    for (block, (sum, from)) in sum.chunks_mut(2 * BLOCK).zip(row.chunks(2 * BLOCK)).enumerate() {
        phases(phase, along, z + block * BLOCK, &mut factors);
        for ((sum, from), &[re, im]) in sum.chunks_exact_mut(2).zip(from.chunks_exact(2)).zip(&factors) {
            let back = times([re, -im], [from[0].to_f64(), from[1].to_f64()]);
            sum[0] = T::from_f64(sum[0].to_f64() + back[0]);
            sum[1] = T::from_f64(sum[1].to_f64() + back[1]);
        }
    }
}
