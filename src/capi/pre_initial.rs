//! Initial conditions at the host's own pre-initial positions.

use core::ffi::c_void;

use super::border::Border;
use super::exec::{HostExec, fixpair_exec};
use super::fft::{Hook, HostFft, fixpair_fft_f32, fixpair_fft_f64};
use super::initial::{fixpair_conditions, optional_fft, some_dyn};
use super::particles::{Triple, components, fixpair_components_f32, fixpair_components_f64};
use super::pm::{Places, fixpair_positions_f32, fixpair_positions_f64, positions};
use super::status::{code, fixpair_status_t};
use crate::pm::{initial_conditions_at, initial_conditions_at_scratch};
use crate::scratch::Layout;
use crate::status::Result;

/// Scratch of fixpair_initial_conditions_at_f64: that of fixpair_initial_conditions_f64 and that of fixpair_read_out_f64 with FIXPAIR_WINDOW_CIC.
///
/// Out: scratch
/// In:  conditions  its order, its shape with its rows, and whether it has a species
///      particles   as many as will be passed, or more
///      fft, fine   as fixpair_initial_conditions_at_f64
/// Returns: as fixpair_initial_conditions_scratch_f64, and FIXPAIR_ERROR_BRICK for a mesh that is not whole
///
/// # Safety
/// Pointers are null or point to as many values as stated; the hooks keep their contracts.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_initial_conditions_at_scratch_f64(
    scratch: *mut Layout,
    conditions: *const fixpair_conditions,
    particles: usize,
    fft: *const fixpair_fft_f64,
    fine: *const fixpair_fft_f64,
) -> fixpair_status_t {
    // SAFETY: the caller's promise.
    code(unsafe { scratch_at(scratch, conditions, particles, fft, fine) })
}

/// fixpair_initial_conditions_at_scratch_f64 in single precision.
///
/// # Safety
/// Pointers are null or point to as many values as stated; the hooks keep their contracts.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_initial_conditions_at_scratch_f32(
    scratch: *mut Layout,
    conditions: *const fixpair_conditions,
    particles: usize,
    fft: *const fixpair_fft_f32,
    fine: *const fixpair_fft_f32,
) -> fixpair_status_t {
    // SAFETY: the caller's promise.
    code(unsafe { scratch_at(scratch, conditions, particles, fft, fine) })
}

unsafe fn scratch_at<H: Hook>(
    scratch: *mut Layout,
    conditions: *const fixpair_conditions,
    particles: usize,
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
        *scratch = initial_conditions_at_scratch(parts, particles, &fft, some_dyn(&mut fine).as_deref())?;
        Ok(())
    }
}

/// fixpair_initial_conditions_f64 for particles that do not begin on the lattice of the mesh: a glass, another lattice, another number of them. The
/// displacements are made on the mesh of `fft`, which must be whole, and read out by cloud in cell at the pre-initial positions q: x = q + Psi(q).
///
/// The read-out multiplies modes of the displacement by sinc^2(k_a H/2) on each axis, H = L/n: at half the Nyquist frequency along an axis by 0.81;
/// with a mesh of twice the side by 0.95. On slabs, make the meshes by fixpair_displacement_f64, exchange ghost planes, and read out by fixpair_read_out_f64.
///
/// Out: position     Mpc/h, in [0, L), one for each of pre_initial
///      velocity     peculiar, km/s: the same length
/// In:  pre_initial  q in Mpc/h, within 1e9 boxes of the box, taken periodically; shares no memory with position and velocity
///      conditions, fft, fine, scratch, exec as fixpair_initial_conditions_f64
/// Returns: as fixpair_initial_conditions_f64, and FIXPAIR_ERROR_BRICK for a mesh that is not whole; after FIXPAIR_ERROR_NOT_FINITE for a
///          position of pre_initial outputs are undefined too
/// Cost: that of fixpair_initial_conditions_f64, and 6 read-outs, 3 at first order
///
/// # Safety
/// Pointers are null or point to as many values as stated; the hooks keep their contracts.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_initial_conditions_at_f64(
    position: *const fixpair_components_f64,
    velocity: *const fixpair_components_f64,
    pre_initial: *const fixpair_positions_f64,
    conditions: *const fixpair_conditions,
    fft: *const fixpair_fft_f64,
    fine: *const fixpair_fft_f64,
    scratch: *mut c_void,
    scratch_len: usize,
    exec: *const fixpair_exec,
) -> fixpair_status_t {
    // SAFETY: the caller's promise.
    code(unsafe { at(position, velocity, pre_initial, conditions, fft, fine, scratch, scratch_len, exec) })
}

/// fixpair_initial_conditions_at_f64 in single precision.
///
/// # Safety
/// Pointers are null or point to as many values as stated; the hooks keep their contracts.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_initial_conditions_at_f32(
    position: *const fixpair_components_f32,
    velocity: *const fixpair_components_f32,
    pre_initial: *const fixpair_positions_f32,
    conditions: *const fixpair_conditions,
    fft: *const fixpair_fft_f32,
    fine: *const fixpair_fft_f32,
    scratch: *mut c_void,
    scratch_len: usize,
    exec: *const fixpair_exec,
) -> fixpair_status_t {
    // SAFETY: the caller's promise.
    code(unsafe { at(position, velocity, pre_initial, conditions, fft, fine, scratch, scratch_len, exec) })
}

unsafe fn at<H: Hook, C: Triple<Real = H::Real>, P: Places<Real = H::Real>>(
    position: *const C,
    velocity: *const C,
    pre_initial: *const P,
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
        let pre_initial = positions(&mut border, pre_initial)?;
        let conditions = border.read_one(conditions)?.check(&mut border)?;
        let mut fft = HostFft::new(&mut border, fft)?;
        let mut fine = optional_fft(&mut border, fine)?;
        let scratch = border.scratch(scratch, scratch_len)?;
        let (fine, exec) = (some_dyn(&mut fine), HostExec::new(&mut border, exec)?);
        let (x, v) = (&mut position, &mut velocity);
        initial_conditions_at(x, v, &pre_initial, &conditions, &mut fft, fine, scratch, &exec)
    }
}
