//! What a kernel on modes multiplies by, as tables over m = |n|^2 = i^2 + j^2 + l^2, the squared mode number.
//!
//! On a mesh of side n in a box of side L all |k| are k_f sqrt(m), k_f = 2 pi/L, 0 <= m <= 3 (n/2)^2: that many logarithms instead of one
//! for each of n^3/2 modes. Entry 0, the mean, is 0. Entries carry the bits of the functions of [`Poisson`] at k = k_f sqrt(m).

use super::poisson::Poisson;
use crate::exec::{Exec, for_each_piece};
use crate::mesh::check_side;
use crate::status::{Error, Result};

/// Entries that a thread computes at a time.
const PIECE: usize = 4096;

/// Entries of a mode table: 3 (n/2)^2 + 1.
///
/// # Errors
/// `MeshSize` if n is zero or odd; `Overflow` above [`LARGEST_SIDE`](crate::mesh::LARGEST_SIDE), or if the table does not fit the address space.
///
/// # Example
/// ```
/// use fixpair::cosmology::mode_table_length;
///
/// assert_eq!(mode_table_length(8)?, 3 * 16 + 1); // |n|^2 = 0 .. 3 (n/2)^2
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn mode_table_length(n: usize) -> Result<usize> {
    check_side(n)?;
    Ok(3 * (n / 2) * (n / 2) + 1)
}

/// Fills `out` with sqrt(P_Phi(k)/L^3), the r.m.s. modulus of a mode of Phi.
///
/// # Errors
/// `MeshSize`, `Overflow` as [`mode_table_length`]; `Length` if `out` is not that long; `NotFinite` if L is; `Range` if L is
/// not positive or a value overflows; `Hook` as [`Exec::parallel_for`]. `out` is untouched by all but the last.
///
/// Cost: 50 ns an entry.
///
/// # Example
/// ```
/// use fixpair::cosmology::{Convention, Cosmology, EisensteinHu, Linear, Poisson, Wiggles};
///
/// let cosmology = Cosmology::goliat();
/// let fit = EisensteinHu::new(&cosmology, Wiggles::With)?;
/// let linear = Linear::from_eisenstein_hu(fit, 0.96, 1.0)?.with_sigma8(0.8)?;
/// let poisson = Poisson::new(&cosmology, linear, 0.5, Convention::Cmb)?; // z = 1
/// use fixpair::cosmology::{mode_table_length, potential_amplitude_table};
///
/// let mut table = vec![0.0; mode_table_length(8)?]; // sqrt(P/V)/alpha by |n|^2
/// potential_amplitude_table(&fixpair::exec::Serial, &poisson, 8, 1000.0, &mut table)?;
/// assert!(table[0] == 0.0 && table[1] > table[4]);
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn potential_amplitude_table(
    exec: &dyn Exec,
    poisson: &Poisson<'_>,
    n: usize,
    box_size: f64,
    out: &mut [f64],
) -> Result<()> {
    let k_f = check(n, box_size, out)?;
    let slope = 0.5 * (poisson.linear().n_s() - 4.0);
    let volume = box_size * box_size * box_size;
    let scale = libm::sqrt(poisson.potential_amplitude() / volume);
    // As accurate as a power to 1e-15, and twice as fast: the exponent is of order 10.
    let amplitude = |k: f64| scale * libm::exp(slope * libm::log(k));
    let ends = [k_f, k_f * libm::sqrt((out.len() - 1) as f64)];
    if !(scale > 0.0 && ends.into_iter().all(|k| amplitude(k).is_finite())) {
        return Err(Error::Range);
    }
    fill(exec, out, &|first, piece| {
        for (i, entry) in piece.iter_mut().enumerate() {
            *entry = amplitude(k_f * libm::sqrt((first + i) as f64));
        }
    })
}

/// Fills `out` with alpha(k, a) at the time of `poisson`: density modes are alpha times potential modes.
///
/// # Errors
/// As [`potential_amplitude_table`].
///
/// Cost: 60 ns an entry from tables of P or T, and a binary search whenever k enters another row; 270 ns from Eisenstein & Hu.
///
/// # Example
/// ```
/// use fixpair::cosmology::{Convention, Cosmology, EisensteinHu, Linear, Poisson, Wiggles};
///
/// let cosmology = Cosmology::goliat();
/// let fit = EisensteinHu::new(&cosmology, Wiggles::With)?;
/// let linear = Linear::from_eisenstein_hu(fit, 0.96, 1.0)?.with_sigma8(0.8)?;
/// let poisson = Poisson::new(&cosmology, linear, 0.5, Convention::Cmb)?; // z = 1
/// use fixpair::cosmology::{alpha_table, mode_table_length};
///
/// let mut table = vec![0.0; mode_table_length(8)?];
/// alpha_table(&fixpair::exec::Serial, &poisson, 8, 1000.0, &mut table)?;
/// let k = std::f64::consts::TAU / 1000.0 * 2.0; // |n|^2 = 4
/// assert!((table[4] / poisson.alpha(k)? - 1.0).abs() < 1e-6);
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn alpha_table(
    exec: &dyn Exec,
    poisson: &Poisson<'_>,
    n: usize,
    box_size: f64,
    out: &mut [f64],
) -> Result<()> {
    let k_f = check(n, box_size, out)?;
    // Between the rows of a table T lies between its neighbours, and outside it is a power law: only the ends can overflow.
    for k in [k_f, k_f * libm::sqrt((out.len() - 1) as f64)] {
        poisson.alpha(k)?;
    }
    let factor = poisson.factor();
    fill(exec, out, &|first, piece| {
        let mut reader = poisson.linear().reader();
        for (i, entry) in piece.iter_mut().enumerate() {
            let k = k_f * libm::sqrt((first + i) as f64);
            *entry = factor * (k * k) * reader.transfer(k, libm::log(k));
        }
    })
}

/// Fills `out` with |n|^power, whatever the box and the spectrum.
///
/// # Errors
/// `Hook` as [`Exec::parallel_for`].
///
/// Cost: 50 ns an entry.
pub(crate) fn mode_power_table(exec: &dyn Exec, power: f64, out: &mut [f64]) -> Result<()> {
    fill(exec, out, &|first, piece| {
        for (i, entry) in piece.iter_mut().enumerate() {
            *entry = libm::exp(0.5 * power * libm::log((first + i) as f64));
        }
    })
}

/// k_f, if the arguments of a table are sound.
pub(super) fn check(n: usize, box_size: f64, out: &[f64]) -> Result<f64> {
    if out.len() != mode_table_length(n)? {
        return Err(Error::Length);
    }
    if !box_size.is_finite() {
        return Err(Error::NotFinite);
    }
    if !(1e-30..=1e30).contains(&box_size) {
        return Err(Error::Range);
    }
    Ok(2.0 * core::f64::consts::PI / box_size)
}

/// Entry 0 is 0; `body(m, piece)` fills the entries from m on.
pub(super) fn fill(
    exec: &dyn Exec,
    out: &mut [f64],
    body: &(dyn Fn(usize, &mut [f64]) + Sync),
) -> Result<()> {
    let Some((mean, modes)) = out.split_first_mut() else { return Err(Error::Length) };
    *mean = 0.0;
    for_each_piece(exec, modes, PIECE, &|i, piece| body(1 + i * PIECE, piece))
}
