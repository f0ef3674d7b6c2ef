//! Power spectrum.

use core::ffi::c_void;

use super::border::Border;
use super::exec::{HostExec, fixpair_exec};
use super::mesh::fixpair_brick;
use super::status::{code, fixpair_status_t};
use crate::estimate::power::{Bin, power_sums, power_sums_scratch};
use crate::real::Real;
use crate::scratch::Layout;
use crate::status::Result;

/// Scratch of fixpair_power_sums: 24 bytes for each bin and index of the brick's outermost axis, 4 bytes for each |n|^2 below the
/// last edge (at most 3 (n/2)^2 + 1 of them), each rounded up to 64.
///
/// Out: scratch
/// In:  brick  of Fourier space
///      edges  edges_len increasing values of |n|^2
/// Returns: 0, FIXPAIR_ERROR_NULL, FIXPAIR_ERROR_TABLE, FIXPAIR_ERROR_OVERFLOW, or why the brick is refused
///
/// # Safety
/// Pointers are null or point to as many values as stated.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_power_sums_scratch(
    scratch: *mut Layout,
    brick: *const fixpair_brick,
    edges: *const u64,
    edges_len: usize,
) -> fixpair_status_t {
    code((|| {
        let mut border = Border::new();
        // SAFETY: the caller's promise.
        let (scratch, brick, edges) =
            unsafe { (border.write_one(scratch)?, border.read_one(brick)?, border.read(edges, edges_len)?) };
        *scratch = power_sums_scratch(&brick.check()?, edges)?;
        Ok(())
    })())
}

/// Sums the power of modes in bins of |n|^2, n = k L/(2 pi): bin b holds edges[b] <= |n|^2 < edges[b+1].
///
/// With V = L^3, a bin's spectrum is P = V power/modes at mean k = (2 pi/L) wavenumber/modes. Its variance for a Gaussian field is
/// 2 P^2/modes. Edges b^2 (b = 1, 2, 3...) give the usual unit shells. Sums of several bricks of one mesh add up.
///
/// Out: bins     bins_len = edges_len - 1 raw sums, overwritten
/// In:  edges    edges_len increasing values of |n|^2
///      f        len reals: modes with f(x) = sum_k f_k exp(+i k.x)
///      g        len reals: a second field, for the cross spectrum Re f_k g_k*; NULL for the power of f
///      brick    where the modes lie
///      scratch  scratch_len bytes, see fixpair_power_sums_scratch
///      exec     or NULL
/// Returns: 0, FIXPAIR_ERROR_NULL, _LENGTH, _ALIGNMENT, _OVERLAP, _TABLE, _SCRATCH, _HOOK, FIXPAIR_ERROR_NOT_FINITE if a sum is
///          NaN or infinite, or why the brick is refused
///
/// # Safety
/// Pointers are null or point to as many values as stated.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_power_sums_f64(
    bins: *mut Bin,
    bins_len: usize,
    edges: *const u64,
    edges_len: usize,
    f: *const f64,
    g: *const f64,
    len: usize,
    brick: *const fixpair_brick,
    scratch: *mut c_void,
    scratch_len: usize,
    exec: *const fixpair_exec,
) -> fixpair_status_t {
    // SAFETY: the caller's promise.
    code(unsafe { sums(bins, bins_len, edges, edges_len, f, g, len, brick, scratch, scratch_len, exec) })
}

/// fixpair_power_sums_f64 for single precision; sums are in double precision all the same.
///
/// # Safety
/// Pointers are null or point to as many values as stated.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_power_sums_f32(
    bins: *mut Bin,
    bins_len: usize,
    edges: *const u64,
    edges_len: usize,
    f: *const f32,
    g: *const f32,
    len: usize,
    brick: *const fixpair_brick,
    scratch: *mut c_void,
    scratch_len: usize,
    exec: *const fixpair_exec,
) -> fixpair_status_t {
    // SAFETY: the caller's promise.
    code(unsafe { sums(bins, bins_len, edges, edges_len, f, g, len, brick, scratch, scratch_len, exec) })
}

unsafe fn sums<T: Real>(
    bins: *mut Bin,
    bins_len: usize,
    edges: *const u64,
    edges_len: usize,
    f: *const T,
    g: *const T,
    len: usize,
    brick: *const fixpair_brick,
    scratch: *mut c_void,
    scratch_len: usize,
    exec: *const fixpair_exec,
) -> Result<()> {
    let mut border = Border::new();
    // SAFETY: the caller's promise.
    unsafe {
        let bins = border.write(bins, bins_len)?;
        let edges = border.read(edges, edges_len)?;
        let f = border.read(f, len)?;
        let g = border.read_optional(g, len)?;
        let brick = border.read_one(brick)?.check()?;
        let scratch = border.scratch(scratch, scratch_len)?;
        power_sums(bins, edges, f, g, &brick, scratch, &HostExec::new(&mut border, exec)?)
    }
}
