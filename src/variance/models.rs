//! What the scatter of a power spectrum should be.
//!
//! For a Gaussian field sampled by Poisson points, N_k modes counting k and -k have
//!
//! ```text
//! sigma = sqrt(2/N_k) (P + 1/n)                                                      (Eq. sigma_th)
//! ```
//!
//! with N_k = V k^2 dk/(2 pi^2) in the continuum, or the exact number. Fixing takes the cosmic variance away from large scales only:
//!
//! ```text
//! sigma_r = sqrt(2/N_k) (P [R_cv + (1 - R_cv) (2/pi) atan(k/k_soft)] + f_sn/n)       (Eq. sigma_fix)
//! ```
//!
//! The paper prints a minus before (1 - R_cv); its text, and its own fits, need the plus: sigma_r must go from R_cv P at small k to
//! P at large k.

use core::f64::consts::{FRAC_2_PI, PI};

use super::check::{fill, finite, not_negative, positive, result, same_length};
use crate::math::sqrt;
use crate::status::{Error, Result};
use crate::within::Within;

/// Modes of a shell of width dk about k in a box of side L, counting k and -k: L^3 k^2 dk/(2 pi^2).
///
/// # Errors
/// `Length` for arrays of different lengths, `NotFinite`, `Range` for numbers that are not positive or a result that over- or underflows.
///
/// # Example
/// ```
/// use fixpair::variance::models::continuum_modes;
///
/// let mut modes = [0.0];
/// continuum_modes(&mut modes, &[0.1], 0.01, 1000.0)?; // V k^2 dk/(2 pi^2)
/// assert!((modes[0] - 5066.06).abs() < 0.01);
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn continuum_modes(out: &mut [f64], k: &[f64], width: f64, box_size: f64) -> Result<()> {
    same_length(out.len(), &[k.len()])?;
    positive(&[width, box_size])?;
    positive(k)?;
    let volume = box_size * box_size * box_size;
    fill(out, |i| {
        let modes = result(volume * k.at(i) * k.at(i) * width / (2.0 * PI * PI))?;
        if modes > 0.0 { Ok(modes) } else { Err(Error::Range) }
    })
}

/// Largest |n| of [`lattice_modes`].
const REACH: u64 = 1 << 14;

/// The exact number of modes n, integers in three dimensions, with |n|^2 from one edge to just below the next: n and -n are two.
///
/// Modes beyond the Nyquist frequency of some mesh are counted too, and n = 0 by an edge of 0. Cost: n^2/8 square roots for each edge, n the largest |n|.
///
/// # Errors
/// `Length` unless there is one number fewer than edges, `Table` for fewer than two edges or edges that do not increase, `Range` for an edge
/// beyond 2^28.
///
/// # Example
/// ```
/// use fixpair::variance::models::lattice_modes;
///
/// let mut modes = [0; 3];
/// lattice_modes(&mut modes, &[1, 4, 9, 16])?;
/// assert_eq!(modes, [26, 66, 158]);
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn lattice_modes(counts: &mut [u64], edges: &[u64]) -> Result<()> {
    if edges.len() < 2 || edges.windows(2).any(|pair| pair[0] >= pair[1]) {
        return Err(Error::Table);
    }
    same_length(counts.len(), &[edges.len() - 1])?;
    let last = edges[edges.len() - 1];
    if last > REACH * REACH {
        return Err(Error::Range);
    }
    counts.fill(0);
    // Points of all signs and of both orders of the first two numbers, from 0 <= j <= i.
    for i in (0..REACH).take_while(|i| i * i < last) {
        for j in (0..=i).take_while(|j| i * i + j * j < last) {
            let images = [1, 2][usize::from(i > 0)] * [1, 2][usize::from(j > 0)] * [1, 2][usize::from(i > j)];
            let column =
                |edge: u64| edge.checked_sub(i * i + j * j + 1).map_or(0, |rest| 2 * rest.isqrt() + 1);
            let mut below = column(edges[0]);
            for (count, &edge) in counts.iter_mut().zip(&edges[1..]) {
                let inside = column(edge);
                *count += images * (inside - below);
                below = inside;
            }
        }
    }
    Ok(())
}

/// sqrt(2/N_k) (P + noise) (Eq. sigma_th); noise = 1/n of points, 0 for none.
///
/// # Errors
/// `Length` for arrays of different lengths, `NotFinite`, `Range` for modes that are not positive, negative noise, P + noise that is not positive,
/// or a result that overflows.
///
/// # Example
/// ```
/// use fixpair::variance::models::sigma_gaussian;
///
/// let mut sigma = [0.0];
/// sigma_gaussian(&mut sigma, &[900.0], &[200.0], 100.0)?; // sqrt(2/N_k) (P + 1/n)
/// assert!((sigma[0] - 100.0).abs() < 1e-12);
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn sigma_gaussian(out: &mut [f64], power: &[f64], modes: &[f64], noise: f64) -> Result<()> {
    same_length(out.len(), &[power.len(), modes.len()])?;
    positive(modes)?;
    finite(power)?;
    not_negative(&[noise])?;
    fill(out, |i| {
        let sigma = result(sqrt(2.0 / modes.at(i)) * (power.at(i) + noise))?;
        if sigma > 0.0 { Ok(sigma) } else { Err(Error::Range) }
    })
}

/// What fixing, or fixing and pairing, leaves of the scatter (Eq. sigma_fix).
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct Suppression {
    /// R_cv: cosmic variance that is left at small k, over that of a Gaussian field.
    pub cosmic_variance: f64,
    /// k_soft, h/Mpc: where it comes back.
    pub softening: f64,
    /// f_sn: shot noise over that of Poisson points.
    pub shot_noise: f64,
}

impl Suppression {
    /// None: sigma_r = sigma_th.
    /// cbindgen:ignore
    pub const NONE: Self = Self { cosmic_variance: 1.0, softening: 1.0, shot_noise: 1.0 };

    pub(super) fn check(&self) -> Result<()> {
        positive(&[self.softening])?;
        not_negative(&[self.cosmic_variance, self.shot_noise])
    }
}

/// The step (2/pi) atan(k/k_soft): 0 at small k, 1 at large.
pub(super) fn step(k: f64, softening: f64) -> f64 {
    FRAC_2_PI * libm::atan(k / softening)
}

/// sigma_r (Eq. sigma_fix with the plus).
///
/// `k`: of each bin, h/Mpc. `power`, `modes`, `noise`: as [`sigma_gaussian`].
///
/// # Errors
/// As [`sigma_gaussian`]; `Range` for k or k_soft that is not positive, and for negative R_cv or f_sn.
///
/// # Example
/// ```
/// use fixpair::variance::models::{Suppression, sigma_suppressed};
///
/// let left = Suppression { cosmic_variance: 0.1, softening: 0.05, shot_noise: 1.0 };
/// let mut sigma = [0.0; 2];
/// sigma_suppressed(&mut sigma, &left, &[1e-6, 10.0], &[1000.0; 2], &[200.0; 2], 0.0)?;
/// assert!((sigma[0] - 10.0).abs() < 0.01); // a tenth of the Gaussian scatter at small k,
/// assert!((sigma[1] - 100.0).abs() < 0.5); // all of it at large k
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn sigma_suppressed(
    out: &mut [f64],
    suppression: &Suppression,
    k: &[f64],
    power: &[f64],
    modes: &[f64],
    noise: f64,
) -> Result<()> {
    same_length(out.len(), &[k.len(), power.len(), modes.len()])?;
    suppression.check()?;
    positive(k)?;
    positive(modes)?;
    finite(power)?;
    not_negative(&[noise])?;
    let Suppression { cosmic_variance, softening, shot_noise } = *suppression;
    fill(out, |i| {
        let cosmic = cosmic_variance + (1.0 - cosmic_variance) * step(k.at(i), softening);
        let sigma = result(sqrt(2.0 / modes.at(i)) * (power.at(i) * cosmic + shot_noise * noise))?;
        if sigma > 0.0 { Ok(sigma) } else { Err(Error::Range) }
    })
}
