//! Bispectrum.

use core::ffi::c_void;

use super::bispectrum_sums::sums_of;
use super::border::Border;
use super::exec::{HostExec, fixpair_exec};
use super::fft::{Hook, HostFft, fixpair_fft_f32, fixpair_fft_f64};
use super::status::{code, fixpair_status_t};
use crate::estimate::bispectrum::{self, Triangle};
use crate::scratch::Layout;
use crate::status::Result;

/// Reals in `count` meshes for fixpair_bispectrum_f64: each is fft->length, rounded up to 64 bytes.
///
/// Out: reals
/// In:  fft
///      count
/// Returns: 0, FIXPAIR_ERROR_NULL, _ALIGNMENT, _OVERLAP, _OVERFLOW, or why the hook is refused
///
/// # Safety
/// Pointers are null or point to one value.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_bispectrum_meshes_f64(
    reals: *mut usize,
    fft: *const fixpair_fft_f64,
    count: usize,
) -> fixpair_status_t {
    // SAFETY: the caller's promise.
    code(unsafe { meshes(reals, fft, count) })
}

/// fixpair_bispectrum_meshes_f64 in single precision.
///
/// # Safety
/// As fixpair_bispectrum_meshes_f64.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_bispectrum_meshes_f32(
    reals: *mut usize,
    fft: *const fixpair_fft_f32,
    count: usize,
) -> fixpair_status_t {
    // SAFETY: the caller's promise.
    code(unsafe { meshes(reals, fft, count) })
}

unsafe fn meshes<H: Hook>(reals: *mut usize, fft: *const H, count: usize) -> Result<()> {
    let mut border = Border::new();
    // SAFETY: the caller's promise.
    unsafe {
        let reals = border.write_one(reals)?;
        *reals = bispectrum::bispectrum_meshes(&HostFft::new(&mut border, fft)?, count)?;
        Ok(())
    }
}

/// Scratch of fixpair_bispectrum_f64: that of fixpair_bispectrum_sums_scratch_f64 on the cells of fft, 16 bytes a shell and a few cache lines
/// more.
///
/// Out: scratch
/// In:  fft
///      shells, triangles_len  how many there are
/// Returns: 0, FIXPAIR_ERROR_NULL, _ALIGNMENT, _OVERLAP, _OVERFLOW, or why the hook is refused
///
/// # Safety
/// Pointers are null or point to one value.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_bispectrum_scratch_f64(
    scratch: *mut Layout,
    fft: *const fixpair_fft_f64,
    shells: usize,
    triangles_len: usize,
) -> fixpair_status_t {
    // SAFETY: the caller's promise.
    code(unsafe { whole_scratch(scratch, fft, shells, triangles_len) })
}

/// fixpair_bispectrum_scratch_f64 in single precision.
///
/// # Safety
/// As fixpair_bispectrum_scratch_f64.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_bispectrum_scratch_f32(
    scratch: *mut Layout,
    fft: *const fixpair_fft_f32,
    shells: usize,
    triangles_len: usize,
) -> fixpair_status_t {
    // SAFETY: the caller's promise.
    code(unsafe { whole_scratch(scratch, fft, shells, triangles_len) })
}

unsafe fn whole_scratch<H: Hook>(
    scratch: *mut Layout,
    fft: *const H,
    shells: usize,
    triangles_len: usize,
) -> Result<()> {
    let mut border = Border::new();
    // SAFETY: the caller's promise.
    unsafe {
        let scratch = border.write_one(scratch)?;
        let fft = HostFft::new(&mut border, fft)?;
        *scratch = bispectrum::bispectrum_scratch(&fft, shells, triangles_len)?;
        Ok(())
    }
}

/// From modes to the sums of all triangles of a list: what fixpair_bispectrum_sums_f64 adds, with the shells' transforms, in as much memory as
/// there is. The whole way, for a deposit of weights whose sum is W:
///
///    fixpair_squeezed_triangles(triangles, T, 0, edges_len - 1);    T = edges_len - 1; or fixpair_closed_triangles
///    fixpair_triangle_counts(counts, triangles, T, edges, edges_len, n, ...);    once: save counts with triangles, edges and n
///    fixpair_compensate_f64(modes, len, FIXPAIR_COMPENSATION_WINDOW + FIXPAIR_WINDOW_TSC, 1.0/W, &fft.fourier, ...);
///    fixpair_bispectrum_f64(sums, words, NULL, triangles, T, edges, edges_len, modes, ...);    then MPI_Allreduce(MPI_INT64_T, MPI_SUM)
///    fixpair_bispectrum_values(B, T, sums, words);
///    fixpair_bispectrum_normalise(B, counts, T, n, L, 1.0);
///
/// P of the same shells, which fixpair_bispectrum_shot_noise and fixpair_bispectrum_reduced take, comes from fixpair_power_sums_f64: edges as here,
/// and FIXPAIR_COMPENSATION_NONE for modes that are compensated already. Every transform is a call of fft: in a long call a hook that counts its
/// calls can tell how far it is.
///
/// With a mesh for each shell each shell is transformed once. With fewer, at least 3, shells come and go: for 40 shells and all their
/// triangles 40 meshes take 40 transforms, 20 meshes 116, 10 meshes 408, 3 meshes 5474. The bits do not depend on it. Where fft holds a
/// part of the mesh, all processes call with as many meshes and the same triangles, and add their sums.
///
/// In/Out: sums        sums_len = FIXPAIR_BISPECTRUM_WORDS * triangles_len integers, zero at first
/// Out:    transforms  how many it took; or NULL
/// In:     triangles   3 triangles_len numbers of shells, counted from 0, in any order; triangles may repeat
///         edges       edges_len increasing values of |n|^2: shell s holds edges[s] <= |n|^2 < edges[s+1]; the last at most (n/2)^2
///         modes       len reals on fft->fourier: delta(x) = sum_k delta_k exp(+i k.x); those of a deposit compensated before, by
///                     fixpair_compensate_f64
///         fft         the transform
///         fields      fields_len reals, overwritten: those of fixpair_bispectrum_meshes_f64 for as many meshes as can be had
///         scratch     scratch_len bytes, see fixpair_bispectrum_scratch_f64
///         exec        or NULL
/// Returns: 0, FIXPAIR_ERROR_NULL, _ALIGNMENT, _OVERLAP, _OVERFLOW, _SCRATCH, _HOOK; FIXPAIR_ERROR_LENGTH also for fewer than 3 meshes,
///          FIXPAIR_ERROR_TABLE for edges that do not increase, FIXPAIR_ERROR_RANGE for edges beyond (n/2)^2 and shells that are not there,
///          FIXPAIR_ERROR_NOT_FINITE if a sum is NaN or infinite, or why the hook is refused; sums are untouched by all
///
/// # Safety
/// Pointers are null or point to as many values as stated; the hooks keep their contracts.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_bispectrum_f64(
    sums: *mut i64,
    sums_len: usize,
    transforms: *mut usize,
    triangles: *const u32,
    triangles_len: usize,
    edges: *const u64,
    edges_len: usize,
    modes: *const f64,
    len: usize,
    fft: *const fixpair_fft_f64,
    fields: *mut f64,
    fields_len: usize,
    scratch: *mut c_void,
    scratch_len: usize,
    exec: *const fixpair_exec,
) -> fixpair_status_t {
    // SAFETY: the caller's promise.
    code(unsafe {
        whole(
            sums,
            sums_len,
            transforms,
            triangles,
            triangles_len,
            edges,
            edges_len,
            modes,
            len,
            fft,
            fields,
            fields_len,
            scratch,
            scratch_len,
            exec,
        )
    })
}

/// fixpair_bispectrum_f64 in single precision.
///
/// # Safety
/// As fixpair_bispectrum_f64.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_bispectrum_f32(
    sums: *mut i64,
    sums_len: usize,
    transforms: *mut usize,
    triangles: *const u32,
    triangles_len: usize,
    edges: *const u64,
    edges_len: usize,
    modes: *const f32,
    len: usize,
    fft: *const fixpair_fft_f32,
    fields: *mut f32,
    fields_len: usize,
    scratch: *mut c_void,
    scratch_len: usize,
    exec: *const fixpair_exec,
) -> fixpair_status_t {
    // SAFETY: the caller's promise.
    code(unsafe {
        whole(
            sums,
            sums_len,
            transforms,
            triangles,
            triangles_len,
            edges,
            edges_len,
            modes,
            len,
            fft,
            fields,
            fields_len,
            scratch,
            scratch_len,
            exec,
        )
    })
}

unsafe fn whole<H: Hook>(
    sums: *mut i64,
    sums_len: usize,
    transforms: *mut usize,
    triangles: *const u32,
    triangles_len: usize,
    edges: *const u64,
    edges_len: usize,
    modes: *const H::Real,
    len: usize,
    fft: *const H,
    fields: *mut H::Real,
    fields_len: usize,
    scratch: *mut c_void,
    scratch_len: usize,
    exec: *const fixpair_exec,
) -> Result<()> {
    let mut border = Border::new();
    // SAFETY: the caller's promise; a triangle is three numbers.
    unsafe {
        let words = border.write(sums, sums_len)?;
        let transforms = border.write(transforms, usize::from(!transforms.is_null()))?;
        let triangles = border.read(triangles.cast::<Triangle>(), triangles_len)?;
        let edges = border.read(edges, edges_len)?;
        let modes = border.read(modes, len)?;
        let mut fft = HostFft::new(&mut border, fft)?;
        let sums = sums_of(words, triangles_len)?;
        let fields = border.write(fields, fields_len)?;
        let scratch = border.scratch(scratch, scratch_len)?;
        let exec = HostExec::new(&mut border, exec)?;
        let made = bispectrum::bispectrum(sums, triangles, edges, modes, &mut fft, fields, scratch, &exec)?;
        transforms.fill(made);
        Ok(())
    }
}
