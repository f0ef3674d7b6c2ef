//! Tables by |n|^2.

use super::border::Border;
use super::cosmology::{fixpair_cosmology, fixpair_linear, with_poisson};
use super::exec::{HostExec, fixpair_exec};
use super::status::{code, fixpair_status_t};
use crate::cosmology::{alpha_table, mode_table_length, potential_amplitude_table};

/// Entries of a table by |n|^2 for a mesh of side n: 3 (n/2)^2 + 1.
///
/// Out: length
/// In:  n
/// Returns: 0, FIXPAIR_ERROR_NULL, FIXPAIR_ERROR_MESH_SIZE, FIXPAIR_ERROR_OVERFLOW
///
/// # Safety
/// `length` is null or points to one value.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_mode_table_length(length: *mut usize, n: usize) -> fixpair_status_t {
    code((|| {
        // SAFETY: the caller's promise.
        let length = unsafe { Border::new().write_one(length) }?;
        *length = mode_table_length(n)?;
        Ok(())
    })())
}

/// sqrt(P_Phi(k)/L^3) by integer |n|^2, n = k L/(2 pi): what unit modes are multiplied by to become Phi. P_Phi = P(k)/alpha(k)^2 at z = 0.
///
/// Out: table      table_len = fixpair_mode_table_length(n) values; entry 0 is 0
/// In:  n          side of the mesh
///      box_size   L in Mpc/h
///      cosmology, linear
///      convention FIXPAIR_CONVENTION_CMB or _LSS
///      exec       or NULL
/// Returns: as fixpair_linear_power, or FIXPAIR_ERROR_LENGTH, _MESH_SIZE, _HOOK
///
/// # Safety
/// Pointers are null or point to as many values as stated.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_potential_amplitude_table(
    table: *mut f64,
    table_len: usize,
    n: usize,
    box_size: f64,
    cosmology: *const fixpair_cosmology,
    linear: *const fixpair_linear,
    convention: i32,
    exec: *const fixpair_exec,
) -> fixpair_status_t {
    code((|| {
        let mut border = Border::new();
        // SAFETY: the caller's promise.
        unsafe {
            let table = border.write(table, table_len)?;
            let poisson = with_poisson(&mut border, cosmology, linear, convention, 0.0)?;
            potential_amplitude_table(&HostExec::new(&mut border, exec)?, &poisson, n, box_size, table)
        }
    })())
}

/// alpha(k, z) by integer |n|^2: what modes of Phi are multiplied by to become the linear density.
///
/// Out: table      table_len = fixpair_mode_table_length(n) values; entry 0 is 0
/// In:  redshift; all others as fixpair_potential_amplitude_table
/// Returns: as fixpair_potential_amplitude_table
///
/// # Safety
/// Pointers are null or point to as many values as stated.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_alpha_table(
    table: *mut f64,
    table_len: usize,
    n: usize,
    box_size: f64,
    cosmology: *const fixpair_cosmology,
    linear: *const fixpair_linear,
    redshift: f64,
    convention: i32,
    exec: *const fixpair_exec,
) -> fixpair_status_t {
    code((|| {
        let mut border = Border::new();
        // SAFETY: the caller's promise.
        unsafe {
            let table = border.write(table, table_len)?;
            let poisson = with_poisson(&mut border, cosmology, linear, convention, redshift)?;
            alpha_table(&HostExec::new(&mut border, exec)?, &poisson, n, box_size, table)
        }
    })())
}
