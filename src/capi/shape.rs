//! Quadratic primordial non-Gaussianity of separable shapes.

use core::ffi::c_void;

use super::border::Border;
use super::exec::{HostExec, fixpair_exec};
use super::fft::{Hook, HostFft, fixpair_fft_f32, fixpair_fft_f64};
use super::mesh::fixpair_brick;
use super::status::{code, fixpair_status_t};
use crate::cosmology::mode_table_length;
use crate::fft::Fft3;
use crate::initial::shape::{Quadratic, Shape, ShapeRow, add_quadratic, add_quadratic_scratch};
use crate::scratch::{Arena, Layout};
use crate::status::{Error, Result};

/// The local shape: Phi_G^2.
pub const FIXPAIR_SHAPE_LOCAL: i32 = 0;
/// The equilateral template.
pub const FIXPAIR_SHAPE_EQUILATERAL: i32 = 1;
/// The orthogonal template of the CMB.
pub const FIXPAIR_SHAPE_ORTHOGONAL: i32 = 2;
/// The orthogonal template whose squeezed limit is right, as halos need it.
pub const FIXPAIR_SHAPE_ORTHOGONAL_LSS: i32 = 3;
/// The folded (enfolded) template.
pub const FIXPAIR_SHAPE_FOLDED: i32 = 4;
/// The caller's own kernel, in the rows of fixpair_conditions: see fixpair_shape_row.
pub const FIXPAIR_SHAPE_ROWS: i32 = 5;

/// Copies the rows of a shape: to see them, to change them, or to add others.
///
/// Out: rows   the first `count` of rows_len; no shape has more than 8
///      count
/// In:  shape  FIXPAIR_SHAPE_LOCAL, _EQUILATERAL, _ORTHOGONAL, _ORTHOGONAL_LSS or _FOLDED
/// Returns: 0, FIXPAIR_ERROR_NULL, _ALIGNMENT, _OVERLAP, _CHOICE, _LENGTH for too few rows; `count` is then written all the same
///
/// # Safety
/// Pointers are null or point to as many values as stated.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_shape_rows(
    rows: *mut ShapeRow,
    rows_len: usize,
    count: *mut usize,
    shape: i32,
) -> fixpair_status_t {
    code((|| {
        let mut border = Border::new();
        // SAFETY: the caller's promise.
        let (rows, count) = unsafe { (border.write(rows, rows_len)?, border.write_one(count)?) };
        let shape = Shape::try_from(shape)?.rows();
        *count = shape.len();
        rows.get_mut(..shape.len()).ok_or(Error::Length)?.copy_from_slice(shape);
        Ok(())
    })())
}

/// Scratch of fixpair_add_shape_f64: two meshes of work->length reals, one of the reals of `brick`, and 8 bytes for each |n|^2 up to
/// 3 (n/2)^2, each array rounded up to 64 bytes. With a `work` of 3/2 the side 63 bytes a cell (f32: 32).
///
/// Out: scratch
/// In:  brick, work  as fixpair_add_shape_f64
/// Returns: 0, FIXPAIR_ERROR_NULL, _OVERFLOW, or why the brick or the hook is refused
///
/// # Safety
/// Pointers are null or point to as many values as stated; the hooks keep their contracts.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_add_shape_scratch_f64(
    scratch: *mut Layout,
    brick: *const fixpair_brick,
    work: *const fixpair_fft_f64,
) -> fixpair_status_t {
    // SAFETY: the caller's promise.
    code(unsafe { shape_scratch(scratch, brick, work) })
}

/// fixpair_add_shape_scratch_f64 in single precision.
///
/// # Safety
/// Pointers are null or point to as many values as stated; the hooks keep their contracts.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_add_shape_scratch_f32(
    scratch: *mut Layout,
    brick: *const fixpair_brick,
    work: *const fixpair_fft_f32,
) -> fixpair_status_t {
    // SAFETY: the caller's promise.
    code(unsafe { shape_scratch(scratch, brick, work) })
}

unsafe fn shape_scratch<H: Hook>(
    scratch: *mut Layout,
    brick: *const fixpair_brick,
    work: *const H,
) -> Result<()> {
    let mut border = Border::new();
    // SAFETY: the caller's promise.
    unsafe {
        let scratch = border.write_one(scratch)?;
        let brick = border.read_one(brick)?.check()?;
        *scratch = add_quadratic_scratch(&brick, &HostFft::new(&mut border, work)?)?;
        Ok(())
    }
}

/// Quadratic primordial non-Gaussianity, in place: Phi_G -> Phi_G + f_nl sum over rows of c X_out[(X_a Phi_G)(X_b Phi_G)], without its mean.
///
/// (X_s f)_k is |n|^(e s) f_k, e = (4 - n_s)/3, n = k L/(2 pi): to a factor P_Phi(k)^(-s/3) f_k. The exponents of a row sum to 0. Apply it to the
/// modes of Phi, after fixing and inverting and before alpha. The mean stays zero, modes with a mode number n/2 receive nothing, and f_nl = 0 or
/// no rows change no bit. See docs/shapes.md for the rows, their bispectra and their signs.
///
/// In/Out: phi      phi_len reals: Phi_G, then Phi; untouched by every error but FIXPAIR_ERROR_HOOK, after which it is undefined
/// In:     brick    of Fourier space, side n
///         f_nl
///         n_s      tilt: P_Phi is proportional to k^(n_s - 4)
///         rows     rows_len rows; fixpair_shape_rows has those of the usual templates
///         work     transform on which products are taken: of side n (they alias), or of side 3n/2 or more (exact)
///         scratch  scratch_len bytes, see fixpair_add_shape_scratch_f64
///         exec     or NULL
/// Returns: 0, FIXPAIR_ERROR_NULL, _LENGTH, _ALIGNMENT, _OVERLAP, _NOT_FINITE, _SCRATCH, _HOOK, _BRICK for a side of work other than n and below 3n/2, or
///          why the brick or the hook is refused, _RANGE for
///          |n_s| above 10, for exponents above 8, that do not sum to 0 within 1e-12, or with n^|e s| above 1e18
/// Cost: transforms of work: local 2, equilateral, orthogonal and folded 7, orthogonal LSS 14
///
/// # Safety
/// Pointers are null or point to as many values as stated; the hooks keep their contracts.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_add_shape_f64(
    phi: *mut f64,
    phi_len: usize,
    brick: *const fixpair_brick,
    f_nl: f64,
    n_s: f64,
    rows: *const ShapeRow,
    rows_len: usize,
    work: *const fixpair_fft_f64,
    scratch: *mut c_void,
    scratch_len: usize,
    exec: *const fixpair_exec,
) -> fixpair_status_t {
    // SAFETY: the caller's promise.
    code(unsafe { shape(phi, phi_len, brick, f_nl, n_s, rows, rows_len, work, scratch, scratch_len, exec) })
}

/// fixpair_add_shape_f64 in single precision.
///
/// # Safety
/// Pointers are null or point to as many values as stated; the hooks keep their contracts.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_add_shape_f32(
    phi: *mut f32,
    phi_len: usize,
    brick: *const fixpair_brick,
    f_nl: f64,
    n_s: f64,
    rows: *const ShapeRow,
    rows_len: usize,
    work: *const fixpair_fft_f32,
    scratch: *mut c_void,
    scratch_len: usize,
    exec: *const fixpair_exec,
) -> fixpair_status_t {
    // SAFETY: the caller's promise.
    code(unsafe { shape(phi, phi_len, brick, f_nl, n_s, rows, rows_len, work, scratch, scratch_len, exec) })
}

unsafe fn shape<H: Hook>(
    phi: *mut H::Real,
    phi_len: usize,
    brick: *const fixpair_brick,
    f_nl: f64,
    n_s: f64,
    rows: *const ShapeRow,
    rows_len: usize,
    work: *const H,
    scratch: *mut c_void,
    scratch_len: usize,
    exec: *const fixpair_exec,
) -> Result<()> {
    let mut border = Border::new();
    // SAFETY: the caller's promise.
    unsafe {
        let phi = border.write(phi, phi_len)?;
        let brick = border.read_one(brick)?.check()?;
        let quadratic = Quadratic { f_nl, rows: border.read(rows, rows_len)?, n_s };
        let mut work = HostFft::new(&mut border, work)?;
        let layout = add_quadratic_scratch(&brick, &work)?;
        let mut arena = Arena::new(border.scratch(scratch, scratch_len)?, layout)?;
        let meshes = [arena.take(work.length())?, arena.take(work.length())?];
        let sum = arena.take(brick.reals())?;
        let table = arena.take(mode_table_length(brick.n())?)?;
        let exec = HostExec::new(&mut border, exec)?;
        add_quadratic(phi, &brick, &quadratic, &mut work, meshes, sum, table, &exec)
    }
}
