//! Local primordial non-Gaussianity.
//!
//! Phi = Phi_G + f_NL (Phi_G^2 - <Phi_G^2>) + g_NL (Phi_G^3 - 3 <Phi_G^2> Phi_G)
//!
//! in configuration space, <> being the box mean (Avila & Adame 2022, arXiv:2204.11103, Eq. fnl). Phi is the primordial Bardeen
//! potential, dimensionless, with alpha > 0: positive f_NL skews the density positively.
//!
//! Products of modes below the Nyquist frequency N/2 reach N (squares) or 3N/2 (cubes) and fold back on a mesh of side N. On a
//! work mesh of side 3N/2 or more (2N or more with g_NL) they fold only onto modes that are dropped: dealiasing is exact.

use super::modes::{Copy, Scale, add_modes, map_modes};
use crate::exec::Exec;
use crate::fft::Fft3;
use crate::mesh::{Brick, Space};
use crate::real::Real;
use crate::scratch::Layout;
use crate::status::{Error, Result};
use crate::walk::{chunks, walk, walk_sum};

/// Local f_NL and g_NL.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Local {
    /// Coefficient of the square.
    pub f_nl: f64,
    /// Coefficient of the cube.
    pub g_nl: f64,
}

impl Local {
    /// Is there nothing to add to a Gaussian field?
    ///
    /// ```
    /// use fixpair::initial::png::Local;
    ///
    /// assert!(Local { f_nl: 0.0, g_nl: 0.0 }.is_gaussian());
    /// ```
    #[must_use]
    pub fn is_gaussian(&self) -> bool {
        self.f_nl == 0.0 && self.g_nl == 0.0
    }

    /// The least side of a work mesh on which the products of a mesh of side `n` do not alias.
    ///
    /// ```
    /// use fixpair::initial::png::Local;
    ///
    /// assert_eq!(Local { f_nl: 100.0, g_nl: 0.0 }.dealiased_side(64), 96);
    /// assert_eq!(Local { f_nl: 100.0, g_nl: 1e5 }.dealiased_side(64), 128);
    /// ```
    #[must_use]
    pub fn dealiased_side(&self, n: usize) -> usize {
        if self.g_nl == 0.0 { n.div_ceil(2) * 3 } else { 2 * n }
    }

    /// # Errors
    /// `NotFinite` for NaN or infinite coefficients.
    ///
    /// # Example
    /// ```
    /// use fixpair::initial::png::Local;
    ///
    /// assert!(Local { f_nl: f64::INFINITY, g_nl: 0.0 }.check().is_err());
    /// ```
    pub fn check(&self) -> Result<()> {
        if self.f_nl.is_finite() && self.g_nl.is_finite() { Ok(()) } else { Err(Error::NotFinite) }
    }
}

/// Scratch of [`add_local`] on the transform `work`: one sum for each chunk.
///
/// # Errors
/// `Overflow` if the bytes do not fit the address space.
///
/// # Example
/// ```
/// # use fixpair::{exec::Serial, fft::{Tables, Transform}, mesh::{Brick, Space}};
/// # #[repr(align(64))] struct Memory([u8; 1 << 16]);
/// # let (mut tables, mut work) = (Memory([0; 1 << 16]), Memory([0; 1 << 16]));
/// # let tables = Tables::<f64>::new(8, &mut tables.0)?;
/// # let mut fft = Transform::new(&tables, Brick::whole(8, Space::Configuration)?, &mut work.0, &Serial)?;
/// use fixpair::initial::png::add_local_scratch;
///
/// assert_eq!(add_local_scratch::<f64>(&fft)?.align, 64);
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn add_local_scratch<T: Real>(work: &dyn Fft3<T>) -> Result<Layout> {
    Layout::EMPTY.and::<[f64; 1]>(chunks(work.configuration()))
}

/// Adds the local quadratic and cubic terms to the modes of a Gaussian potential, in place.
///
/// `phi`: modes Phi_G of the Fourier brick `brick`; on return the modes of Phi. The Gaussian modes keep their bits where the added
/// terms vanish, and f_NL = g_NL = 0 changes nothing. The mean stays zero; the Nyquist modes receive nothing.
///
/// `work`: the transform on which products are taken, and `mesh`, its array of `work.length()` reals, overwritten.
/// Its side decides the aliasing: the side of `brick` leaves the folded modes in; [`Local::dealiased_side`] or more is exact.
/// Anything in between is refused, because it is neither.
///
/// # Errors
/// `NotFinite` for the coefficients, `Brick` for bricks that do not match, `Length`, `Scratch`, or what `work` returns.
///
/// Cost: one inverse and one forward transform of `work`, and 3 passes (4 with g_NL).
///
/// # Example
/// ```
/// # use fixpair::{exec::Serial, fft::{Tables, Transform}, mesh::{Brick, Space}};
/// # #[repr(align(64))] struct Memory([u8; 1 << 16]);
/// # let (mut tables, mut work) = (Memory([0; 1 << 16]), Memory([0; 1 << 16]));
/// # let tables = Tables::<f64>::new(8, &mut tables.0)?;
/// # let mut fft = Transform::new(&tables, Brick::whole(8, Space::Configuration)?, &mut work.0, &Serial)?;
/// use fixpair::fft::Fft3;
/// use fixpair::initial::png::{Local, add_local};
/// use fixpair::walk::chunks;
///
/// let (modes, mut phi, mut mesh) = (Brick::whole(8, Space::Fourier)?, vec![0.0; 640], vec![0.0; fft.length()]);
/// phi[2] = 0.5; // Phi_G = cos kz
/// let mut partial = vec![[0.0]; chunks(fft.configuration())];
/// let local = Local { f_nl: 0.1, g_nl: 0.0 };
/// add_local(&mut phi, &modes, local, &mut fft, &mut mesh, &mut partial, &Serial)?;
/// assert!((phi[4] - 0.1 * 0.25).abs() < 1e-15 && phi[0] == 0.0); // cos^2 = 1/2 + cos(2 kz)/2, less its mean
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn add_local<T: Real>(
    phi: &mut [T],
    brick: &Brick,
    local: Local,
    work: &mut dyn Fft3<T>,
    mesh: &mut [T],
    partial: &mut [[f64; 1]],
    exec: &dyn Exec,
) -> Result<()> {
    local.check()?;
    brick.check_space(Space::Fourier)?;
    brick.check_length(phi)?;
    let (n, m) = (brick.n(), work.configuration().n());
    if m != n && m < local.dealiased_side(n) {
        return Err(Error::Brick);
    }
    if local.is_gaussian() {
        return Ok(());
    }
    if local.g_nl != 0.0 {
        // Nothing to sum: is there a sum at all? Later would be too late.
        work.all_sum(&mut [])?;
    }
    let (cells, modes) = (*work.configuration(), *work.fourier());
    let mesh = mesh.get_mut(..work.length()).ok_or(Error::Length)?;
    map_modes(mesh, &modes, phi, brick, &Copy, exec)?;
    work.inverse(mesh)?;
    let mean_square = if local.g_nl == 0.0 { 0.0 } else { mean_square(mesh, work, partial, exec)? };
    let (f_nl, g_nl) = (local.f_nl, local.g_nl);
    walk::<T, 1, 0>(exec, &cells, [mesh], [], &|_, [row], []| {
        for value in row {
            let phi = value.to_f64();
            *value = T::from_f64(phi * (f_nl * phi + g_nl * (phi * phi - 3.0 * mean_square)));
        }
    })?;
    work.forward(mesh)?;
    let scale = 1.0 / (m as f64 * m as f64 * m as f64);
    add_modes(phi, brick, mesh, &modes, &Scale(scale), exec)
}

/// <f^2> over the whole box.
fn mean_square<T: Real>(
    mesh: &[T],
    work: &mut dyn Fft3<T>,
    partial: &mut [[f64; 1]],
    exec: &dyn Exec,
) -> Result<f64> {
    let cells = *work.configuration();
    let mut sum = walk_sum::<T, 0, 1, 1>(exec, &cells, [], [mesh], partial, &|_, [], [row], sum| {
        for value in row {
            sum[0] += value.to_f64() * value.to_f64();
        }
    })?;
    work.all_sum(&mut sum)?;
    let n = cells.n() as f64;
    Ok(sum[0] / (n * n * n))
}
