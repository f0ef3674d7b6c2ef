//! From unit modes to particles.

use core::ffi::c_void;

use super::border::Border;
use super::cosmology::{FIXPAIR_CONVENTION_CMB, fixpair_cosmology, fixpair_linear};
use super::exec::{HostExec, fixpair_exec};
use super::fft::{Hook, HostFft, fixpair_fft_f32, fixpair_fft_f64};
use super::noise::fixpair_realisation;
use super::particles::{Triple, components, fixpair_components_f32, fixpair_components_f64};
use super::shape::FIXPAIR_SHAPE_ROWS;
use super::species::{fixpair_species, optional_species};
use super::status::{code, fixpair_status_t};
use crate::cosmology::{Convention, Cosmology};
use crate::fft::Fft3;
use crate::initial::conditions::{
    InitialConditions, Order, Parts, initial_conditions, initial_conditions_scratch,
};
use crate::initial::png::Local;
use crate::initial::shape::{Shape, ShapeRow};
use crate::real::Real;
use crate::scratch::Layout;
use crate::status::{Error, Result};

/// Zel'dovich displacements.
pub const FIXPAIR_ORDER_FIRST: i32 = 1;
/// Second-order Lagrangian perturbation theory.
pub const FIXPAIR_ORDER_SECOND: i32 = 2;
/// Third order, longitudinal and transverse, whose products never alias.
pub const FIXPAIR_ORDER_THIRD: i32 = 3;

/// A universe, and when and how large to start it: everything that fixpair_initial_conditions_f64 asks.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct fixpair_conditions {
    /// sizeof(fixpair_conditions).
    pub struct_size: usize,
    /// Seed, amplitudes, phase. (Nyquist modes are zero whatever it says: displacements have none.)
    pub realisation: fixpair_realisation,
    /// Background of the simulation that will run.
    pub cosmology: fixpair_cosmology,
    /// Linear spectrum of z = 0.
    pub linear: fixpair_linear,
    /// Redshift of the particles.
    pub redshift: f64,
    /// Side of the box in Mpc/h.
    pub box_size: f64,
    /// Local: Phi = Phi_G + f_nl (Phi_G^2 - <Phi_G^2>) + g_nl (Phi_G^3 - 3 <Phi_G^2> Phi_G). Other shapes have another kernel than Phi_G^2.
    pub f_nl: f64,
    /// See f_nl; always local.
    pub g_nl: f64,
    /// In which convention f_nl and g_nl are: FIXPAIR_CONVENTION_CMB or _LSS.
    pub convention: i32,
    /// FIXPAIR_ORDER_FIRST, _SECOND or _THIRD.
    pub order: i32,
    /// What f_nl multiplies: FIXPAIR_SHAPE_LOCAL, _EQUILATERAL, _ORTHOGONAL, _ORTHOGONAL_LSS, _FOLDED, or _ROWS for the rows below.
    pub shape: i32,
    /// Rows of FIXPAIR_SHAPE_ROWS.
    pub rows_len: usize,
    /// The caller's kernel; read for FIXPAIR_SHAPE_ROWS only.
    pub rows: *const ShapeRow,
    /// Which species the particles are, see fixpair_species; NULL for all matter as one.
    pub species: *const fixpair_species,
}

/// # Safety
/// `pointer` is null or points to a hook that keeps its contract.
pub(super) unsafe fn optional_fft<H: Hook>(
    border: &mut Border,
    pointer: *const H,
) -> Result<Option<HostFft<H::Real>>> {
    // SAFETY: the caller's promise.
    if pointer.is_null() { Ok(None) } else { unsafe { HostFft::new(border, pointer) }.map(Some) }
}

pub(super) fn some_dyn<T: Real>(fft: &mut Option<HostFft<T>>) -> Option<&mut dyn Fft3<T>> {
    fft.as_mut().map(|fft| {
        let fft: &mut dyn Fft3<T> = fft;
        fft
    })
}

/// Fills the conditions: the GOLIAT cosmology, a normal original Gaussian field, second order, z = 32, a box of 1000 Mpc/h, and the Eisenstein-Hu
/// spectrum with sigma8 = 0.8. Change what differs in yours; give your own spectrum in `linear`.
///
/// Out: conditions
/// In:  seed
/// Returns: 0, FIXPAIR_ERROR_NULL, FIXPAIR_ERROR_ALIGNMENT
///
/// # Safety
/// `conditions` is null or points to one.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_conditions_init(
    conditions: *mut fixpair_conditions,
    seed: u64,
) -> fixpair_status_t {
    code((|| {
        // SAFETY: the caller's promise.
        let out = unsafe { Border::new().write_one(conditions) }?;
        *out = fixpair_conditions {
            struct_size: size_of::<fixpair_conditions>(),
            realisation: fixpair_realisation::new(seed),
            cosmology: fixpair_cosmology::new(Cosmology::goliat()),
            linear: fixpair_linear::eisenstein_hu(0.8),
            redshift: 32.0,
            box_size: 1000.0,
            f_nl: 0.0,
            g_nl: 0.0,
            convention: FIXPAIR_CONVENTION_CMB,
            order: FIXPAIR_ORDER_SECOND,
            shape: Shape::Local as i32,
            rows_len: 0,
            rows: core::ptr::null(),
            species: core::ptr::null(),
        };
        Ok(())
    })())
}

impl fixpair_conditions {
    /// What scratch depends on.
    ///
    /// # Safety
    /// `rows` is null or points to as many as it says.
    pub(super) unsafe fn parts(&self, border: &mut Border) -> Result<Parts> {
        if self.struct_size != size_of::<Self>() {
            return Err(Error::Version);
        }
        // SAFETY: the caller's promise.
        let local = ShapeRow::local(unsafe { self.shape(border) }?).is_some();
        Ok(Parts { order: Order::try_from(self.order)?, local, species: !self.species.is_null() })
    }

    /// # Safety
    /// As `parts`.
    unsafe fn shape<'a>(&self, border: &mut Border) -> Result<&'a [ShapeRow]> {
        if self.shape == FIXPAIR_SHAPE_ROWS {
            // SAFETY: the caller's promise.
            return unsafe { border.read(self.rows, self.rows_len) };
        }
        Shape::try_from(self.shape).map(Shape::rows)
    }

    /// # Safety
    /// The table of `linear`, rows and species are null or point to as many values as they say.
    pub(super) unsafe fn check<'a>(&self, border: &mut Border) -> Result<InitialConditions<'a>> {
        if self.struct_size != size_of::<Self>() {
            return Err(Error::Version);
        }
        let cosmology = self.cosmology.check()?;
        Ok(InitialConditions {
            realisation: self.realisation.check()?,
            cosmology,
            // SAFETY: the caller's promise.
            linear: unsafe { self.linear.check(border, &cosmology) }?,
            redshift: self.redshift,
            box_size: self.box_size,
            local: Local { f_nl: self.f_nl, g_nl: self.g_nl },
            // SAFETY: the caller's promise.
            shape: unsafe { self.shape(border) }?,
            convention: Convention::try_from(self.convention)?,
            order: Order::try_from(self.order)?,
            // SAFETY: the caller's promise.
            species: unsafe { optional_species(border, self.species) }?,
        })
    }
}

/// Scratch of fixpair_initial_conditions_f64. With f = fft->length and m = fine->length, or f without `fine`, in reals: at first order
/// f + m, or 3 f + m for a species; at second f + m + max(2 f, m); at third 18 f + m; with a shape other than local 2 f + 2 m, if that is more. And,
/// with n the side of fft, 8 bytes for each |n|^2 up to 3 (n/2)^2 in 2 tables, 1 more for such a shape, 2 more for a species; 8 for each plane; 16
/// for each of n/2 + 1 at third order; each array rounded up to 64 bytes. Second order with a `fine` of 3/2 the side: 63 bytes a cell (f32: 32);
/// without it 33 (17). Third order without it: 155 (78).
///
/// Out: scratch
/// In:  conditions  its order, its shape with its rows, and whether it has a species
///      fft, fine   as fixpair_initial_conditions_f64
/// Returns: 0, FIXPAIR_ERROR_NULL, _ALIGNMENT, _OVERLAP, _VERSION, _CHOICE, _OVERFLOW, or why a hook is refused
///
/// # Safety
/// Pointers are null or point to as many values as stated; the hooks keep their contracts.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_initial_conditions_scratch_f64(
    scratch: *mut Layout,
    conditions: *const fixpair_conditions,
    fft: *const fixpair_fft_f64,
    fine: *const fixpair_fft_f64,
) -> fixpair_status_t {
    // SAFETY: the caller's promise.
    code(unsafe { conditions_scratch(scratch, conditions, fft, fine) })
}

/// fixpair_initial_conditions_scratch_f64 in single precision.
///
/// # Safety
/// Pointers are null or point to as many values as stated; the hooks keep their contracts.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_initial_conditions_scratch_f32(
    scratch: *mut Layout,
    conditions: *const fixpair_conditions,
    fft: *const fixpair_fft_f32,
    fine: *const fixpair_fft_f32,
) -> fixpair_status_t {
    // SAFETY: the caller's promise.
    code(unsafe { conditions_scratch(scratch, conditions, fft, fine) })
}

unsafe fn conditions_scratch<H: Hook>(
    scratch: *mut Layout,
    conditions: *const fixpair_conditions,
    fft: *const H,
    fine: *const H,
) -> Result<()> {
    let mut border = Border::new();
    // SAFETY: the caller's promise.
    unsafe {
        let scratch = border.write_one(scratch)?;
        let parts = border.read_one(conditions)?.parts(&mut border)?;
        let fft = HostFft::new(&mut border, fft)?;
        let mut fine = optional_fft(&mut border, fine)?;
        *scratch = initial_conditions_scratch(parts, &fft, some_dyn(&mut fine).as_deref())?;
        Ok(())
    }
}

/// One call from a seed to particles: Fixed, Paired or Matched initial conditions with primordial non-Gaussianity, in the only right order:
/// noise -> fix -> invert -> colour -> PNG -> transfer -> displace.
///
/// One particle for each cell of fft->configuration, numbered with z fastest; ids from fixpair_particle_ids. Two calls that differ in
/// phase give a pair; two that differ in f_nl, cosmology or redshift, with one seed, are matched.
///
/// ```c
/// fixpair_layout size;                                       new(size): aligned_alloc(size.align, size.size)
/// fixpair_fft_tables_scratch_f64(&size, n);
/// void *tables = new(size);  size_t tables_len = size.size;
/// fixpair_fft_tables_init_f64(tables, tables_len, n);
/// fixpair_fft_f64 fft;                                       or FFTW by hand
/// fixpair_fft_scratch_f64(&size, n);
/// fixpair_fft_init_f64(&fft, tables, tables_len, fixpair_fft_padding_f64(n), new(size), size.size, NULL);
/// fixpair_conditions c;
/// fixpair_conditions_init(&c, seed);
/// c.realisation.amplitude = FIXPAIR_AMPLITUDE_FIXED;
/// c.f_nl = 100.0;
/// fixpair_components_f64 position = {x, x + 1, x + 2, 3, n * n * n}, velocity = {v, v + 1, v + 2, 3, n * n * n};
/// fixpair_initial_conditions_scratch_f64(&size, &c, &fft, NULL);
/// fixpair_initial_conditions_f64(&position, &velocity, &c, &fft, NULL, new(size), size.size, NULL);
/// ```
///
/// Out: position    Mpc/h, in [0, L): length = cells of fft->configuration
///      velocity    peculiar, km/s (Gadget files store it divided by sqrt(a)): the same length
/// In:  conditions
///      fft         the transform; its bricks decide which part of the mesh and so which particles this process makes
///      fine        a transform of side 3n/2 or more (2n with g_nl), on which products are free of aliasing; NULL to let f_nl, g_nl and
///                  the second order alias. FIXPAIR_ORDER_THIRD does without: its products, those of the second order too, never alias.
///                  On more than one process, each must hold the same modes of both meshes below n/2: the slabs that FFTW-MPI deals out
///                  for two sides do not
///      scratch     scratch_len bytes, see fixpair_initial_conditions_scratch_f64
///      exec        or NULL
/// Returns: 0, FIXPAIR_ERROR_NULL, _LENGTH, _ALIGNMENT, _OVERLAP, _NOT_FINITE, _RANGE, _TABLE, _SCRATCH, _CHOICE, _VERSION, _CONVERGENCE, _OVERFLOW,
///          _MESH_SIZE, _BRICK for a `fine` that is too small; after FIXPAIR_ERROR_HOOK, or FIXPAIR_ERROR_NOT_FINITE from fields that overflow, position and
///          velocity are undefined; on several processes NOT_FINITE may be the answer of some only
/// Cost: at second order 13 transforms of fft, or 6 of it and 8 of fine; 2 more with local f_nl or g_nl, 7 or 14 with other shapes; at third
///       198 transforms of fft
///
/// # Safety
/// Pointers are null or point to as many values as stated; the hooks keep their contracts.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_initial_conditions_f64(
    position: *const fixpair_components_f64,
    velocity: *const fixpair_components_f64,
    conditions: *const fixpair_conditions,
    fft: *const fixpair_fft_f64,
    fine: *const fixpair_fft_f64,
    scratch: *mut c_void,
    scratch_len: usize,
    exec: *const fixpair_exec,
) -> fixpair_status_t {
    // SAFETY: the caller's promise.
    code(unsafe { all(position, velocity, conditions, fft, fine, scratch, scratch_len, exec) })
}

/// fixpair_initial_conditions_f64 in single precision.
///
/// # Safety
/// Pointers are null or point to as many values as stated; the hooks keep their contracts.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_initial_conditions_f32(
    position: *const fixpair_components_f32,
    velocity: *const fixpair_components_f32,
    conditions: *const fixpair_conditions,
    fft: *const fixpair_fft_f32,
    fine: *const fixpair_fft_f32,
    scratch: *mut c_void,
    scratch_len: usize,
    exec: *const fixpair_exec,
) -> fixpair_status_t {
    // SAFETY: the caller's promise.
    code(unsafe { all(position, velocity, conditions, fft, fine, scratch, scratch_len, exec) })
}

unsafe fn all<H: Hook, C: Triple<Real = H::Real>>(
    position: *const C,
    velocity: *const C,
    conditions: *const fixpair_conditions,
    fft: *const H,
    fine: *const H,
    scratch: *mut c_void,
    scratch_len: usize,
    exec: *const fixpair_exec,
) -> Result<()> {
    let mut border = Border::new();
    // SAFETY: the caller's promise.
    unsafe {
        let mut position = components(&mut border, position)?;
        let mut velocity = components(&mut border, velocity)?;
        let conditions = border.read_one(conditions)?.check(&mut border)?;
        let mut fft = HostFft::new(&mut border, fft)?;
        let mut fine = optional_fft(&mut border, fine)?;
        let scratch = border.scratch(scratch, scratch_len)?;
        let (fine, exec) = (some_dyn(&mut fine), HostExec::new(&mut border, exec)?);
        initial_conditions(&mut position, &mut velocity, &conditions, &mut fft, fine, scratch, &exec)
    }
}
