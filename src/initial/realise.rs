//! From unit modes to the modes of the linear density in one call.

use super::modes::{Scale, add_modes, scale_by_table};
use super::png::{Local, add_local};
use super::shape::{Quadratic, ShapeRow, quadratic_modes};
use crate::exec::Exec;
use crate::fft::Fft3;
use crate::mesh::Brick;
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
    /// f_NL, and local g_NL.
    pub local: Local,
    /// The kernel that f_NL multiplies: local, or another.
    pub shape: &'a [ShapeRow],
    /// Tilt of the primordial spectrum; shapes other than local need it.
    pub n_s: f64,
    /// alpha(k, z) by integer |n|^2.
    pub transfer: &'a [f64],
}

/// Arrays that are overwritten on the way to a linear density. Those of `rest` and `table` may be empty where f_NL is local.
pub struct FieldWork<'a, T> {
    /// As long as the transform on which products are taken asks.
    pub mesh: &'a mut [T],
    /// [`shape_rest`] reals.
    pub rest: &'a mut [T],
    /// [`crate::cosmology::mode_table_length`] values.
    pub table: &'a mut [f64],
    /// One for each chunk of the transform on which products are taken: see [`super::png::add_local_scratch`].
    pub partial: &'a mut [[f64; 1]],
}

/// Reals of `rest` in [`FieldWork`] where f_NL is not local: a mesh of `work`, on which products are taken, and one of `fft`.
///
/// ```
/// # use fixpair::{exec::Serial, fft::{Tables, Transform}, mesh::{Brick, Space}};
/// # #[repr(align(64))] struct Memory([u8; 1 << 16]);
/// # let (mut tables, mut work) = (Memory([0; 1 << 16]), Memory([0; 1 << 16]));
/// # let tables = Tables::<f64>::new(8, &mut tables.0)?;
/// # let mut fft = Transform::new(&tables, Brick::whole(8, Space::Configuration)?, &mut work.0, &Serial)?;
/// use fixpair::initial::realise::shape_rest;
///
/// assert!(shape_rest::<f64>(&fft, &fft) > 0); // reals beside the first mesh of the products
/// # Ok::<(), fixpair::status::Error>(())
/// ```
#[must_use]
pub fn shape_rest<T: Real>(fft: &dyn Fft3<T>, work: &dyn Fft3<T>) -> usize {
    apart(work) + fft.length()
}

/// The modes of the linear density at the starting time: noise -> fix -> invert -> colour -> PNG -> transfer.
///
/// `density`: `fft.length()` reals, on return the modes of delta. `fine`: a transform for products without aliasing (see
/// [`Local::dealiased_side`]); without it products alias.
///
/// # Errors
/// Those of the stages.
///
/// Cost: two passes, and with f_NL or g_NL those of [`add_local`] or [`super::shape::add_quadratic`].
///
/// # Example
/// ```
/// # use fixpair::{exec::Serial, fft::{Fft3, Tables, Transform}, mesh::{Brick, Space}};
/// # #[repr(align(64))] struct Memory([u8; 1 << 16]);
/// # let (mut tables, mut work) = (Memory([0; 1 << 16]), Memory([0; 1 << 16]));
/// # let tables = Tables::<f64>::new(8, &mut tables.0)?;
/// # let mut fft = Transform::new(&tables, Brick::whole(8, Space::Configuration)?, &mut work.0, &Serial)?;
/// use fixpair::cosmology::mode_table_length;
/// use fixpair::initial::{png::Local, realise::{Field, FieldWork, linear_density}, shape::Shape};
/// use fixpair::noise::{Amplitude, Realisation};
///
/// let (amplitude, transfer) = (vec![1e-5; mode_table_length(8)?], vec![1e4; mode_table_length(8)?]);
/// let realisation = Realisation { amplitude: Amplitude::Fixed, ..Realisation::new(1) };
/// let (local, shape) = (Local { f_nl: 0.0, g_nl: 0.0 }, Shape::Local.rows());
/// let field = Field { realisation, potential_amplitude: &amplitude, local, shape, n_s: 0.96, transfer: &transfer };
/// let (mut density, mut mesh) = (vec![0.0_f64; fft.length()], vec![0.0; fft.length()]);
/// let work = FieldWork { mesh: &mut mesh, rest: &mut [], table: &mut [], partial: &mut [[0.0]; 64] };
/// linear_density(&mut density, &field, &mut fft, None, work, &Serial)?;
/// assert!((density[2].hypot(density[3]) - 0.1).abs() < 1e-12); // fixed: alpha sqrt(P_Phi/V), of any seed
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn linear_density<T: Real>(
    density: &mut [T],
    field: &Field<'_>,
    fft: &mut dyn Fft3<T>,
    fine: Option<&mut (dyn Fft3<T> + '_)>,
    work: FieldWork<'_, T>,
    exec: &dyn Exec,
) -> Result<()> {
    let brick = *fft.fourier();
    white_modes_coloured(density, &brick, &field.realisation, field.potential_amplitude, exec)?;
    match fine {
        Some(fine) => add_non_gaussian(density, &brick, field, fine, work, exec)?,
        None => add_non_gaussian(density, &brick, field, fft, work, exec)?,
    }
    scale_by_table(density, &brick, field.transfer, exec)
}

/// f_NL of its shape and local g_NL, both of the Gaussian field.
fn add_non_gaussian<T: Real>(
    phi: &mut [T],
    brick: &Brick,
    field: &Field<'_>,
    products: &mut dyn Fft3<T>,
    work: FieldWork<'_, T>,
    exec: &dyn Exec,
) -> Result<()> {
    let Local { f_nl, g_nl } = field.local;
    let FieldWork { mesh, rest, table, partial } = work;
    if let Some(coefficient) = ShapeRow::local(field.shape) {
        let local = Local { f_nl: coefficient * f_nl, g_nl };
        return add_local(phi, brick, local, products, mesh, partial, exec);
    }
    let quadratic = Quadratic { f_nl, rows: field.shape, n_s: field.n_s };
    let (second, sum) = rest.split_at_mut_checked(apart(products)).ok_or(Error::Length)?;
    let meshes = [&mut *mesh, second];
    let scale = quadratic_modes(phi, brick, &quadratic, products, meshes, sum, table, exec)?;
    add_local(phi, brick, Local { f_nl: 0.0, g_nl }, products, mesh, partial, exec)?;
    match scale {
        Some(scale) => add_modes(phi, brick, sum, brick, &Scale(scale), exec),
        None => Ok(()),
    }
}

/// Reals from one mesh to the next in a row of them: whole cache lines.
pub(super) fn apart<T: Real>(fft: &dyn Fft3<T>) -> usize {
    fft.length().next_multiple_of(ALIGN / size_of::<T>())
}
