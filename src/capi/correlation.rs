//! Correlation function.

use core::ffi::c_void;

use super::binning::{binning, fixpair_binning};
use super::border::Border;
use super::exec::{HostExec, fixpair_exec};
use super::mesh::fixpair_brick;
use super::power::{compensation, fields};
use super::status::{code, fixpair_status_t};
use crate::estimate::correlation::{
    correlation_modes, correlation_modes_scratch, correlation_sums, correlation_sums_scratch,
};
use crate::real::Real;
use crate::scratch::Layout;
use crate::status::Result;
use crate::within::Within;

/// Scratch of fixpair_correlation_modes_*: n/2 + 1 doubles.
///
/// Out: scratch
/// In:  brick  of Fourier space
/// Returns: 0, FIXPAIR_ERROR_NULL, _ALIGNMENT, _OVERLAP, or why the brick is refused
///
/// # Safety
/// Pointers are null or point to one value.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_correlation_modes_scratch(
    scratch: *mut Layout,
    brick: *const fixpair_brick,
) -> fixpair_status_t {
    code((|| {
        let mut border = Border::new();
        // SAFETY: the caller's promise.
        let (scratch, brick) = unsafe { (border.write_one(scratch)?, border.read_one(brick)?) };
        *scratch = correlation_modes_scratch(&brick.check()?)?;
        Ok(())
    })())
}

/// f_k <- scale f_k g_k*, compensated; k = 0 becomes 0. The inverse transform then gives xi(x) = <f(y + x) g(y)> on the mesh, as
/// xi(x) = sum_k f_k g_k* exp(+i k.x), which sums to 0 over the box.
///
/// In/out: modes         len reals: f, replaced
/// In:     other         len reals: g; NULL for f itself
///         compensation, other_compensation  as in fixpair_power_sums_*; the second is not read where other is NULL
///         scale         of both fields together, the product of what makes the modes of each those of f(x) = sum_k f_k exp(+i k.x): 1/(sum of
///                       weights)^2 for the density contrast of a deposit, 1/n^6 for any other field (both after a transform that does
///                       not divide), 1 for modes of this library
///         brick         of Fourier space
///         scratch       scratch_len bytes, see fixpair_correlation_modes_scratch
///         exec          or NULL
/// Returns: 0, FIXPAIR_ERROR_NULL, _LENGTH, _ALIGNMENT, _OVERLAP, _SCRATCH, _CHOICE, _NOT_FINITE for the scale, or why the brick is refused;
///          FIXPAIR_ERROR_HOOK, after which modes are undefined. Modes are not checked: a NaN shows in fixpair_binning_read.
///
/// # Safety
/// Pointers are null or point to as many values as stated.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_correlation_modes_f64(
    modes: *mut f64,
    other: *const f64,
    len: usize,
    compensation: i32,
    other_compensation: i32,
    scale: f64,
    brick: *const fixpair_brick,
    scratch: *mut c_void,
    scratch_len: usize,
    exec: *const fixpair_exec,
) -> fixpair_status_t {
    // SAFETY: the caller's promise.
    code(unsafe {
        let chosen = [compensation, other_compensation];
        multiply(modes, other, len, chosen, scale, brick, scratch, scratch_len, exec)
    })
}

/// fixpair_correlation_modes_f64 in single precision.
///
/// # Safety
/// Pointers are null or point to as many values as stated.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_correlation_modes_f32(
    modes: *mut f32,
    other: *const f32,
    len: usize,
    compensation: i32,
    other_compensation: i32,
    scale: f64,
    brick: *const fixpair_brick,
    scratch: *mut c_void,
    scratch_len: usize,
    exec: *const fixpair_exec,
) -> fixpair_status_t {
    // SAFETY: the caller's promise.
    code(unsafe {
        let chosen = [compensation, other_compensation];
        multiply(modes, other, len, chosen, scale, brick, scratch, scratch_len, exec)
    })
}

unsafe fn multiply<T: Real>(
    modes: *mut T,
    other: *const T,
    len: usize,
    chosen: [i32; 2],
    scale: f64,
    brick: *const fixpair_brick,
    scratch: *mut c_void,
    scratch_len: usize,
    exec: *const fixpair_exec,
) -> Result<()> {
    let mut border = Border::new();
    // SAFETY: the caller's promise.
    unsafe {
        let modes = border.write(modes, len)?;
        let other = border.read_optional(other, len)?;
        let first = compensation(chosen[0])?;
        let second = if other.is_some() { compensation(chosen[1])? } else { first };
        let brick = border.read_one(brick)?.check()?;
        let scratch = border.scratch(scratch, scratch_len)?;
        let exec = HostExec::new(&mut border, exec)?;
        correlation_modes(modes, other, [first, second], scale, &brick, scratch, &exec)
    }
}

/// Scratch of fixpair_correlation_sums_*: as fixpair_power_sums_scratch.
///
/// Out: scratch
/// In:  brick       of configuration space
///      binning
///      meshes_len  meshes summed together
/// Returns: 0, FIXPAIR_ERROR_NULL, _ALIGNMENT, _OVERLAP, FIXPAIR_ERROR_LENGTH for no meshes, FIXPAIR_ERROR_OVERFLOW, or why brick or binning are refused
///
/// # Safety
/// Pointers are null or point to as many values as stated.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_correlation_sums_scratch(
    scratch: *mut Layout,
    brick: *const fixpair_brick,
    binning: *const fixpair_binning,
    meshes_len: usize,
) -> fixpair_status_t {
    code((|| {
        let mut border = Border::new();
        // SAFETY: the caller's promise.
        unsafe {
            let scratch = border.write_one(scratch)?;
            let brick = border.read_one(brick)?.check()?;
            *scratch = correlation_sums_scratch(&brick, &self::binning(&mut border, binning)?, meshes_len)?;
        }
        Ok(())
    })())
}

/// Adds xi(x) L_l(mu), summed over the separations of a brick bin by bin, to sums. A cell of index i is the separation i L/n, or (i - n) L/n
/// above n/2; |n|^2 of the binning is that of the separation in cells. Read and normalise as spectra: fixpair_binning_read, fixpair_binning_normalise
/// with factor 1 give xi_l = (2l + 1) <xi L_l>. Shot noise sits at separation 0: edges that begin at 1 leave it out.
///
/// In/out: sums     sums_len integers, zeros at first
/// In:     meshes   meshes_len <= 8 pointers to xi on the brick, len reals each
///         brick    of configuration space
///         binning
///         scratch  scratch_len bytes, see fixpair_correlation_sums_scratch
///         exec     or NULL
/// Returns: as fixpair_power_sums_f64
/// Cost: one pass over each mesh
///
/// # Safety
/// Pointers are null or point to as many values as stated.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_correlation_sums_f64(
    sums: *mut i64,
    sums_len: usize,
    meshes: *const *const f64,
    meshes_len: usize,
    len: usize,
    brick: *const fixpair_brick,
    binning: *const fixpair_binning,
    scratch: *mut c_void,
    scratch_len: usize,
    exec: *const fixpair_exec,
) -> fixpair_status_t {
    // SAFETY: the caller's promise.
    code(unsafe { add(sums, sums_len, meshes, meshes_len, len, brick, binning, scratch, scratch_len, exec) })
}

/// fixpair_correlation_sums_f64 for single precision; sums are the same exact ones.
///
/// # Safety
/// Pointers are null or point to as many values as stated.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_correlation_sums_f32(
    sums: *mut i64,
    sums_len: usize,
    meshes: *const *const f32,
    meshes_len: usize,
    len: usize,
    brick: *const fixpair_brick,
    binning: *const fixpair_binning,
    scratch: *mut c_void,
    scratch_len: usize,
    exec: *const fixpair_exec,
) -> fixpair_status_t {
    // SAFETY: the caller's promise.
    code(unsafe { add(sums, sums_len, meshes, meshes_len, len, brick, binning, scratch, scratch_len, exec) })
}

unsafe fn add<T: Real>(
    sums: *mut i64,
    sums_len: usize,
    meshes: *const *const T,
    meshes_len: usize,
    len: usize,
    brick: *const fixpair_brick,
    binning: *const fixpair_binning,
    scratch: *mut c_void,
    scratch_len: usize,
    exec: *const fixpair_exec,
) -> Result<()> {
    let mut border = Border::new();
    // SAFETY: the caller's promise.
    unsafe {
        let sums = border.write(sums, sums_len)?;
        let (meshes, count) = fields(&mut border, meshes, meshes_len, len)?;
        let brick = border.read_one(brick)?.check()?;
        let binning = self::binning(&mut border, binning)?;
        let scratch = border.scratch(scratch, scratch_len)?;
        correlation_sums(
            sums,
            meshes.part(..count),
            &brick,
            &binning,
            scratch,
            &HostExec::new(&mut border, exec)?,
        )
    }
}
