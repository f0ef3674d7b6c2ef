//! The whole way in two calls: unit modes to linear density, linear density to particles.

use super::lpt::{displacement, second_order_products, second_order_squares};
use super::modes::scale_by_table;
use super::particles::{Components, Step, displace};
use super::png::{Local, add_local};
use crate::exec::Exec;
use crate::fft::Fft3;
use crate::noise::{Realisation, white_modes_coloured};
use crate::real::Real;
use crate::scratch::ALIGN;
use crate::status::{Error, Result};

/// What a linear density field is made of.
#[derive(Clone, Copy, Debug)]
pub struct Field<'a> {
    /// Seed, amplitudes and phase of the Gaussian potential.
    pub realisation: Realisation,
    /// sqrt(P_Phi(k)/V) by integer |n|^2.
    pub potential_amplitude: &'a [f64],
    /// Local f_NL and g_NL.
    pub local: Local,
    /// alpha(k, z) by integer |n|^2.
    pub transfer: &'a [f64],
}

/// How the density moves particles: everything that depends on the cosmology and the starting time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion {
    /// Side of the box.
    pub box_size: f64,
    /// D2/D^2, near -3/7.
    pub second_order: f64,
    /// a H f1: velocity over first-order displacement.
    pub first_velocity: f64,
    /// a H f2: velocity over second-order displacement.
    pub second_velocity: f64,
}

/// The modes of the linear density at the starting time: noise -> fix -> invert -> colour -> PNG -> transfer.
///
/// `density`: `fft.length()` reals, on return the modes of delta. `fine`: a transform for products without aliasing (see
/// [`Local::dealiased_side`]); without it products alias. `mesh`: as long as `fine`, else `fft`, asks; overwritten.
/// `partial`: see [`super::png::add_local_scratch`].
///
/// # Errors
/// Those of the stages.
///
/// Cost: two passes, and with f_NL or g_NL those of [`add_local`].
pub fn linear_density<T: Real>(
    density: &mut [T],
    field: &Field<'_>,
    fft: &mut dyn Fft3<T>,
    fine: Option<&mut (dyn Fft3<T> + '_)>,
    mesh: &mut [T],
    partial: &mut [[f64; 1]],
    exec: &dyn Exec,
) -> Result<()> {
    let brick = *fft.fourier();
    white_modes_coloured(density, &brick, &field.realisation, field.potential_amplitude, exec)?;
    if !field.local.is_gaussian() {
        match fine {
            Some(fine) => add_local(density, &brick, field.local, fine, mesh, partial, exec)?,
            None => add_local(density, &brick, field.local, fft, mesh, partial, exec)?,
        }
    }
    scale_by_table(density, &brick, field.transfer, exec)
}

/// First-order (Zel'dovich) positions and velocities from the modes of the linear density.
///
/// `mesh`: `fft.length()` reals, overwritten.
///
/// # Errors
/// As [`displacement`] and [`displace`].
///
/// Cost: three transforms and six passes.
pub fn first_order_particles<T: Real>(
    position: &mut Components<'_, T>,
    velocity: &mut Components<'_, T>,
    density: &[T],
    motion: &Motion,
    fft: &mut dyn Fft3<T>,
    mesh: &mut [T],
    exec: &dyn Exec,
) -> Result<()> {
    let (modes, cells) = (*fft.fourier(), *fft.configuration());
    let unit = motion.box_size / core::f64::consts::TAU;
    let step = motion.step();
    let mesh = mesh.get_mut(..fft.length()).ok_or(Error::Length)?;
    // The transforms may be collective: a process whose particles are lost goes on to the end with the others.
    let mut outcome = Ok(());
    for axis in 0..3 {
        displacement(mesh, density, &modes, axis, unit, fft, exec)?;
        outcome = outcome.and(displace(position, velocity, mesh, None, &cells, axis, &step, exec));
    }
    outcome
}

/// Reals from one displacement mesh to the next in `rest` of [`second_order_particles`]: whole cache lines.
fn apart<T: Real>(fft: &dyn Fft3<T>) -> usize {
    fft.length().next_multiple_of(ALIGN / size_of::<T>())
}

/// Reals of `rest` of [`second_order_particles`]: two meshes of `fft`, or one of `fine` if that is more.
#[must_use]
pub fn second_order_rest<T: Real>(fft: &dyn Fft3<T>, fine: Option<&(dyn Fft3<T> + '_)>) -> usize {
    (2 * apart(fft)).max(fine.map_or(0, Fft3::length))
}

/// Second-order (2LPT) positions and velocities from the modes of the linear density.
///
/// `fine`: a transform of side 3N/2 or more for products without aliasing. `source`: as long as `fine`, else `fft`, asks;
/// `rest`: [`second_order_rest`] reals; both are overwritten.
///
/// # Errors
/// As [`super::lpt::second_order_source`], [`displacement`] and [`displace`].
///
/// Cost: six transforms of `fft`, and seven more of it and 26 passes, or eight of `fine` and as many passes over it: one transform
/// more in exchange for one mesh of `fine` less.
pub fn second_order_particles<T: Real>(
    position: &mut Components<'_, T>,
    velocity: &mut Components<'_, T>,
    density: &[T],
    motion: &Motion,
    fft: &mut dyn Fft3<T>,
    fine: Option<&mut (dyn Fft3<T> + '_)>,
    source: &mut [T],
    rest: &mut [T],
    exec: &dyn Exec,
) -> Result<()> {
    let (modes, cells, length, apart) = (*fft.fourier(), *fft.configuration(), fft.length(), apart(fft));
    if rest.len() < 2 * apart {
        return Err(Error::Length);
    }
    let source_modes = match fine {
        Some(fine) => {
            second_order_squares(density, &modes, fine, [&mut *source, &mut *rest], exec)?;
            *fine.fourier()
        }
        None => {
            let (a, b) = rest.split_at_mut(apart);
            second_order_products(density, &modes, fft, [&mut *source, a, b], exec)?;
            modes
        }
    };
    let m = source_modes.n() as f64;
    let unit = motion.box_size / core::f64::consts::TAU;
    // The products were left un-normalised: their 1/m^3 is folded in here.
    let second = -motion.second_order * unit / (m * m * m);
    let step = motion.step();
    let (one, two) = rest.split_at_mut(apart);
    let (one, two) = (&mut one[..length], &mut two[..length]);
    let mut outcome = Ok(());
    for axis in 0..3 {
        displacement(one, density, &modes, axis, unit, fft, exec)?;
        displacement(two, source, &source_modes, axis, second, fft, exec)?;
        outcome = outcome.and(displace(position, velocity, one, Some(two), &cells, axis, &step, exec));
    }
    outcome
}

impl Motion {
    fn step(&self) -> Step {
        Step {
            box_size: self.box_size,
            first_velocity: self.first_velocity,
            second_velocity: self.second_velocity,
        }
    }
}
