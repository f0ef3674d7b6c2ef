//! The third order, for hosts that put initial conditions together themselves.

use core::ffi::c_void;

use super::border::Border;
use super::exec::{HostExec, fixpair_exec};
use super::fft::{Hook, HostFft, fixpair_fft_f32, fixpair_fft_f64};
use super::status::{code, fixpair_status_t};
use crate::fft::Fft3;
use crate::initial::shifted::half_cells_length;
use crate::initial::third::{
    THIRD_ORDER_MESHES, second_order_exact, third_order_scratch, third_order_sources, transverse_displacement,
};
use crate::scratch::{Arena, Layout};
use crate::status::Result;

/// Scratch of fixpair_third_order_sources_f64: 12 meshes of fft->length reals, and 16 bytes for each of n/2 + 1, n the side, each array
/// rounded up to 64 bytes. 96 bytes a cell (f32: 48), and rows' padding.
///
/// Out: scratch
/// In:  fft
/// Returns: 0, FIXPAIR_ERROR_NULL, _OVERFLOW, or why the hook is refused
///
/// # Safety
/// Pointers are null or point to as many values as stated; the hooks keep their contracts.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_third_order_sources_scratch_f64(
    scratch: *mut Layout,
    fft: *const fixpair_fft_f64,
) -> fixpair_status_t {
    // SAFETY: the caller's promise.
    code(unsafe { sources_scratch(scratch, fft) })
}

/// fixpair_third_order_sources_scratch_f64 in single precision.
///
/// # Safety
/// Pointers are null or point to as many values as stated; the hooks keep their contracts.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_third_order_sources_scratch_f32(
    scratch: *mut Layout,
    fft: *const fixpair_fft_f32,
) -> fixpair_status_t {
    // SAFETY: the caller's promise.
    code(unsafe { sources_scratch(scratch, fft) })
}

unsafe fn sources_scratch<H: Hook>(scratch: *mut Layout, fft: *const H) -> Result<()> {
    let mut border = Border::new();
    // SAFETY: the caller's promise.
    unsafe {
        let scratch = border.write_one(scratch)?;
        *scratch = third_order_scratch(&HostFft::new(&mut border, fft)?)?;
        Ok(())
    }
}

/// The modes of the sources of the second and third orders, without aliasing and without a larger mesh, so that slabs need no exchange (Patterson &
/// Orszag 1971: the mean over eight meshes shifted by half cells). With p_ab and q_ab the second differences of the potentials whose
/// Laplacians are delta and S:
///
/// S = sum_a<b (p_aa p_bb - p_ab^2), A = det p, B = p_aa q_bb - p_ab q_ab (summed), C_i = eps_ijk p_lj q_lk,
///
/// and the displacements are Psi2_k = -(D2/D^2) i k/k^2 S, Psi3a_k = (D3a/D^3) i k/k^2 A, Psi3b_k = (D3b/D^3) i k/k^2 B by
/// fixpair_displacement_f64, and Psi3c_k = (D3c/D^3) i k x C/k^2 by fixpair_transverse_displacement_f64 (Bouchet et al. 1995, astro-ph/9406013;
/// Michaux et al. 2021, arXiv:2008.09588); the D are those of fixpair_growth_factors.
///
/// Out: second           len reals, as many as fft->fourier needs or more: modes of S
///      determinant      the same for A
///      mixed            the same for B
///      curl_x, _y, _z   the same for the components of C
/// In:  density          the same for delta
///      fft              the transform
///      scratch          scratch_len bytes, see fixpair_third_order_sources_scratch_f64
///      exec             or NULL
/// Returns: 0, FIXPAIR_ERROR_NULL, _LENGTH, _ALIGNMENT, _OVERLAP, _SCRATCH, _OVERFLOW, or why the hook is refused; after FIXPAIR_ERROR_HOOK outputs are
///          undefined
/// Cost: 192 transforms, which with the passes between them take as long as about 300
///
/// # Safety
/// Pointers are null or point to as many values as stated; the hooks keep their contracts.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_third_order_sources_f64(
    second: *mut f64,
    determinant: *mut f64,
    mixed: *mut f64,
    curl_x: *mut f64,
    curl_y: *mut f64,
    curl_z: *mut f64,
    density: *const f64,
    len: usize,
    fft: *const fixpair_fft_f64,
    scratch: *mut c_void,
    scratch_len: usize,
    exec: *const fixpair_exec,
) -> fixpair_status_t {
    let out = [second, determinant, mixed, curl_x, curl_y, curl_z];
    // SAFETY: the caller's promise.
    code(unsafe { sources(out, density, len, fft, scratch, scratch_len, exec) })
}

/// fixpair_third_order_sources_f64 in single precision.
///
/// # Safety
/// Pointers are null or point to as many values as stated; the hooks keep their contracts.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_third_order_sources_f32(
    second: *mut f32,
    determinant: *mut f32,
    mixed: *mut f32,
    curl_x: *mut f32,
    curl_y: *mut f32,
    curl_z: *mut f32,
    density: *const f32,
    len: usize,
    fft: *const fixpair_fft_f32,
    scratch: *mut c_void,
    scratch_len: usize,
    exec: *const fixpair_exec,
) -> fixpair_status_t {
    let out = [second, determinant, mixed, curl_x, curl_y, curl_z];
    // SAFETY: the caller's promise.
    code(unsafe { sources(out, density, len, fft, scratch, scratch_len, exec) })
}

unsafe fn sources<H: Hook>(
    out: [*mut H::Real; 6],
    density: *const H::Real,
    len: usize,
    fft: *const H,
    scratch: *mut c_void,
    scratch_len: usize,
    exec: *const fixpair_exec,
) -> Result<()> {
    let mut border = Border::new();
    let [second, a, b, x, y, z] = out;
    // SAFETY: the caller's promise.
    unsafe {
        let second = border.write(second, len)?;
        let third = [
            border.write(a, len)?,
            border.write(b, len)?,
            border.write(x, len)?,
            border.write(y, len)?,
            border.write(z, len)?,
        ];
        let density = border.read(density, len)?;
        let mut fft = HostFft::new(&mut border, fft)?;
        let mut arena = Arena::new(border.scratch(scratch, scratch_len)?, third_order_scratch(&fft)?)?;
        let exec = HostExec::new(&mut border, exec)?;
        for mesh in [&*second, density] {
            fft.fourier().check_length(mesh)?;
        }
        let table = arena.take(half_cells_length(fft.configuration().n()))?;
        let mut meshes = arena.take_each([fft.length(); THIRD_ORDER_MESHES])?;
        let [m0, m1, m2, m3, m4, m5, ..] = meshes.each_mut().map(|mesh| &mut **mesh);
        second_order_exact(second, density, &mut fft, [m0, m1, m2, m3, m4, m5], table, &exec)?;
        third_order_sources(third, density, second, &mut fft, meshes, table, &exec)
    }
}

/// One component of the transverse displacement of the third order: modes scale i (n x C)_axis/|n|^2, n = k L/(2 pi), brought to the cells.
/// With scale (D3c/D^3) L/(2 pi) this is Psi3c, in the unit of L.
///
/// Out: psi              psi_len = fft->length reals: one component on the cells of fft->configuration
/// In:  curl_x, _y, _z   curl_len reals each: modes of C on fft->fourier
///      axis             0, 1, 2
///      scale
///      fft              the transform
///      exec             or NULL
/// Returns: 0, FIXPAIR_ERROR_NULL, _LENGTH, _ALIGNMENT, _OVERLAP, _RANGE for an axis above 2, _NOT_FINITE, or why the hook is refused; after
///          FIXPAIR_ERROR_HOOK psi is undefined
/// Cost: 1 transform
///
/// # Safety
/// Pointers are null or point to as many values as stated; the hooks keep their contracts.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_transverse_displacement_f64(
    psi: *mut f64,
    psi_len: usize,
    curl_x: *const f64,
    curl_y: *const f64,
    curl_z: *const f64,
    curl_len: usize,
    axis: usize,
    scale: f64,
    fft: *const fixpair_fft_f64,
    exec: *const fixpair_exec,
) -> fixpair_status_t {
    // SAFETY: the caller's promise.
    code(unsafe { transverse(psi, psi_len, [curl_x, curl_y, curl_z], curl_len, axis, scale, fft, exec) })
}

/// fixpair_transverse_displacement_f64 in single precision.
///
/// # Safety
/// Pointers are null or point to as many values as stated; the hooks keep their contracts.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_transverse_displacement_f32(
    psi: *mut f32,
    psi_len: usize,
    curl_x: *const f32,
    curl_y: *const f32,
    curl_z: *const f32,
    curl_len: usize,
    axis: usize,
    scale: f64,
    fft: *const fixpair_fft_f32,
    exec: *const fixpair_exec,
) -> fixpair_status_t {
    // SAFETY: the caller's promise.
    code(unsafe { transverse(psi, psi_len, [curl_x, curl_y, curl_z], curl_len, axis, scale, fft, exec) })
}

unsafe fn transverse<H: Hook>(
    psi: *mut H::Real,
    psi_len: usize,
    [x, y, z]: [*const H::Real; 3],
    curl_len: usize,
    axis: usize,
    scale: f64,
    fft: *const H,
    exec: *const fixpair_exec,
) -> Result<()> {
    let mut border = Border::new();
    // SAFETY: the caller's promise.
    unsafe {
        let psi = border.write(psi, psi_len)?;
        let curl = [border.read(x, curl_len)?, border.read(y, curl_len)?, border.read(z, curl_len)?];
        let mut fft = HostFft::new(&mut border, fft)?;
        let exec = HostExec::new(&mut border, exec)?;
        transverse_displacement(psi, curl, axis, scale, &mut fft, &exec)
    }
}
