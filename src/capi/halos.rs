//! Catalogues of halos.

use core::ffi::c_void;

use super::border::Border;
use super::exec::{HostExec, fixpair_exec};
use super::fof::query;
use super::pm::{Places, fixpair_positions_f32, fixpair_positions_f64, positions};
use super::status::{code, fixpair_status_t};
use crate::halos::{self, Halo, HaloSums};
use crate::pm::Positions;
use crate::scratch::Layout;
use crate::status::Result;

/// Mass of a particle in Msun/h: 2.77536627e11 Om L^3/N.
///
/// The number is today's critical density in h^2 Msun/Mpc^3, 3 H0^2/(8 pi G), with G Msun = 1.3271244e20 m^3/s^2 (IAU 2015, resolution B3).
///
/// Out: mass
/// In:  omega_m          of all matter that the particles stand for
///      box_size         L in Mpc/h
///      particles_total  N, of the whole simulation on all processes
/// Returns: 0, FIXPAIR_ERROR_NULL, _ALIGNMENT, _NOT_FINITE, FIXPAIR_ERROR_RANGE for Om or L not positive or N = 0
///
/// # Safety
/// `mass` is null or points to one value.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_particle_mass(
    mass: *mut f64,
    omega_m: f64,
    box_size: f64,
    particles_total: u64,
) -> fixpair_status_t {
    code((|| {
        // SAFETY: the caller's promise.
        let mass = unsafe { Border::new().write_one(mass) }?;
        *mass = halos::particle_mass(omega_m, box_size, particles_total)?;
        Ok(())
    })())
}

/// Scratch of fixpair_halo_count, fixpair_halos_* and fixpair_halo_sums_*: 12 bytes a particle, and at most 4.3 MB.
///
/// Out: scratch
/// In:  particles  as many as will be passed, or more
/// Returns: 0, FIXPAIR_ERROR_NULL, _ALIGNMENT, FIXPAIR_ERROR_OVERFLOW for 2^32 particles and more
///
/// # Safety
/// `scratch` is null or points to one value.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_halos_scratch(scratch: *mut Layout, particles: usize) -> fixpair_status_t {
    // SAFETY: the caller's promise.
    code(unsafe { query(scratch, particles, halos::halos_scratch) })
}

/// How many groups have n_min particles and more: the places that fixpair_halos_* needs.
///
/// Out: count
/// In:  labels   len labels, as for fixpair_halos_f64
///      n_min    1 or more
///      scratch  scratch_len bytes, see fixpair_halos_scratch
///      exec     or NULL
/// Returns: 0, FIXPAIR_ERROR_NULL, _ALIGNMENT, _OVERLAP, _OVERFLOW, _SCRATCH, _HOOK, FIXPAIR_ERROR_RANGE for n_min = 0
/// Cost: most of that of fixpair_halos_f64
///
/// # Safety
/// Pointers are null or point to as many values as stated; the hooks keep their contracts.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_halo_count(
    count: *mut usize,
    labels: *const u64,
    len: usize,
    n_min: u64,
    scratch: *mut c_void,
    scratch_len: usize,
    exec: *const fixpair_exec,
) -> fixpair_status_t {
    code((|| {
        let mut border = Border::new();
        // SAFETY: the caller's promise.
        unsafe {
            let (count, labels) = (border.write_one(count)?, border.read(labels, len)?);
            let scratch = border.scratch(scratch, scratch_len)?;
            let exec = HostExec::new(&mut border, exec)?;
            *count = halos::halo_count(labels, n_min, scratch, &exec)?;
            Ok(())
        }
    })())
}

/// Catalogue of the groups of n_min particles and more: the largest first, of equal ones the smaller label first.
///
/// Out: halos          the first `count` are written
///      count          how many: see fixpair_halo_count; at most len / n_min
/// In:  halos_len      places in halos
///      labels         len labels: of fixpair_fof_labels_f64, or any other numbers that tell groups apart
///      position       of len particles
///      velocity       of len particles, or NULL
///      box_size       L
///      n_min          1 or more
///      particle_mass  see fixpair_particle_mass
///      scratch        scratch_len bytes, see fixpair_halos_scratch
///      exec           or NULL
/// Returns: 0, FIXPAIR_ERROR_NULL, _ALIGNMENT, _OVERLAP, _OVERFLOW, _NOT_FINITE, _RANGE, _SCRATCH; FIXPAIR_ERROR_LENGTH, also if there are more
///          than halos_len; FIXPAIR_ERROR_HOOK, after which halos are undefined, and so after FIXPAIR_ERROR_NOT_FINITE for velocities whose squares
///          no number holds
/// Cost: on one core in single precision 50 ns a particle of a simulation at z = 0
///
/// # Safety
/// Pointers are null or point to as many values as stated; the hooks keep their contracts.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_halos_f64(
    halos: *mut Halo,
    halos_len: usize,
    count: *mut usize,
    labels: *const u64,
    len: usize,
    position: *const fixpair_positions_f64,
    velocity: *const fixpair_positions_f64,
    box_size: f64,
    n_min: u64,
    particle_mass: f64,
    scratch: *mut c_void,
    scratch_len: usize,
    exec: *const fixpair_exec,
) -> fixpair_status_t {
    // SAFETY: the caller's promise.
    code(unsafe {
        list(
            halos,
            halos_len,
            count,
            labels,
            len,
            position,
            velocity,
            box_size,
            n_min,
            particle_mass,
            scratch,
            scratch_len,
            exec,
        )
    })
}

/// fixpair_halos_f64 in single precision.
///
/// # Safety
/// Pointers are null or point to as many values as stated; the hooks keep their contracts.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_halos_f32(
    halos: *mut Halo,
    halos_len: usize,
    count: *mut usize,
    labels: *const u64,
    len: usize,
    position: *const fixpair_positions_f32,
    velocity: *const fixpair_positions_f32,
    box_size: f64,
    n_min: u64,
    particle_mass: f64,
    scratch: *mut c_void,
    scratch_len: usize,
    exec: *const fixpair_exec,
) -> fixpair_status_t {
    // SAFETY: the caller's promise.
    code(unsafe {
        list(
            halos,
            halos_len,
            count,
            labels,
            len,
            position,
            velocity,
            box_size,
            n_min,
            particle_mass,
            scratch,
            scratch_len,
            exec,
        )
    })
}

unsafe fn list<P: Places>(
    halos: *mut Halo,
    halos_len: usize,
    count: *mut usize,
    labels: *const u64,
    len: usize,
    position: *const P,
    velocity: *const P,
    box_size: f64,
    n_min: u64,
    particle_mass: f64,
    scratch: *mut c_void,
    scratch_len: usize,
    exec: *const fixpair_exec,
) -> Result<()> {
    let mut border = Border::new();
    // SAFETY: the caller's promise.
    unsafe {
        let (halos, count) = (border.write(halos, halos_len)?, border.write_one(count)?);
        let labels = border.read(labels, len)?;
        let (position, velocity) = particles(&mut border, position, velocity)?;
        let scratch = border.scratch(scratch, scratch_len)?;
        let exec = HostExec::new(&mut border, exec)?;
        *count = halos::halos(
            halos,
            labels,
            &position,
            velocity.as_ref(),
            box_size,
            n_min,
            particle_mass,
            scratch,
            &exec,
        )?;
    }
    Ok(())
}

/// Positions and, where they are not null, velocities.
///
/// # Safety
/// Pointers are null or point to positions whose elements nobody writes.
unsafe fn particles<'a, P: Places>(
    border: &mut Border,
    position: *const P,
    velocity: *const P,
) -> Result<(Positions<'a, P::Real>, Option<Positions<'a, P::Real>>)> {
    // SAFETY: the caller's promise.
    unsafe {
        let position = positions(border, position)?;
        let velocity = if velocity.is_null() { None } else { Some(positions(border, velocity)?) };
        Ok((position, velocity))
    }
}

/// Sums over the particles of each group that has at least n_min of them here, and of each, however few, whose label is in the map, under its
/// final label. Processes add them up with fixpair_halo_sums_merge; see fixpair_fof_labels_f64 for the whole way.
///
/// Out: sums      in order of their label; the first `count` are written
///      count     how many: at most len / n_min + map_len
/// In:  sums_len  places in sums
///      labels    len labels: of the process's own particles, without ghosts
///      position  of len particles
///      velocity  of len particles, or NULL
///      box_size  L
///      n_min     1 or more
///      map       map_len entries of fixpair_fof_merge, 2 numbers each; or NULL and 0 for a whole box
///      scratch   scratch_len bytes, see fixpair_halos_scratch
///      exec      or NULL
/// Returns: 0, FIXPAIR_ERROR_NULL, _ALIGNMENT, _OVERLAP, _OVERFLOW, _NOT_FINITE, _RANGE, _SCRATCH, _TABLE for the map; FIXPAIR_ERROR_LENGTH, also if
///          there are more than sums_len; FIXPAIR_ERROR_HOOK, after which sums are undefined, and so after FIXPAIR_ERROR_NOT_FINITE for velocities
///          whose squares no number holds
/// Cost: on one core in single precision 50 ns a particle of a simulation at z = 0
///
/// # Safety
/// Pointers are null or point to as many values as stated; the hooks keep their contracts.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_halo_sums_f64(
    sums: *mut HaloSums,
    sums_len: usize,
    count: *mut usize,
    labels: *const u64,
    len: usize,
    position: *const fixpair_positions_f64,
    velocity: *const fixpair_positions_f64,
    box_size: f64,
    n_min: u64,
    map: *const u64,
    map_len: usize,
    scratch: *mut c_void,
    scratch_len: usize,
    exec: *const fixpair_exec,
) -> fixpair_status_t {
    // SAFETY: the caller's promise.
    code(unsafe {
        sum(
            sums,
            sums_len,
            count,
            labels,
            len,
            position,
            velocity,
            box_size,
            n_min,
            map,
            map_len,
            scratch,
            scratch_len,
            exec,
        )
    })
}

/// fixpair_halo_sums_f64 in single precision.
///
/// # Safety
/// Pointers are null or point to as many values as stated; the hooks keep their contracts.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_halo_sums_f32(
    sums: *mut HaloSums,
    sums_len: usize,
    count: *mut usize,
    labels: *const u64,
    len: usize,
    position: *const fixpair_positions_f32,
    velocity: *const fixpair_positions_f32,
    box_size: f64,
    n_min: u64,
    map: *const u64,
    map_len: usize,
    scratch: *mut c_void,
    scratch_len: usize,
    exec: *const fixpair_exec,
) -> fixpair_status_t {
    // SAFETY: the caller's promise.
    code(unsafe {
        sum(
            sums,
            sums_len,
            count,
            labels,
            len,
            position,
            velocity,
            box_size,
            n_min,
            map,
            map_len,
            scratch,
            scratch_len,
            exec,
        )
    })
}

unsafe fn sum<P: Places>(
    sums: *mut HaloSums,
    sums_len: usize,
    count: *mut usize,
    labels: *const u64,
    len: usize,
    position: *const P,
    velocity: *const P,
    box_size: f64,
    n_min: u64,
    map: *const u64,
    map_len: usize,
    scratch: *mut c_void,
    scratch_len: usize,
    exec: *const fixpair_exec,
) -> Result<()> {
    let mut border = Border::new();
    // SAFETY: the caller's promise.
    unsafe {
        let (sums, count) = (border.write(sums, sums_len)?, border.write_one(count)?);
        let labels = border.read(labels, len)?;
        let (position, velocity) = particles(&mut border, position, velocity)?;
        let map = border.read(map.cast(), map_len)?;
        let scratch = border.scratch(scratch, scratch_len)?;
        let exec = HostExec::new(&mut border, exec)?;
        *count = halos::halo_sums(
            sums,
            labels,
            &position,
            velocity.as_ref(),
            box_size,
            n_min,
            map,
            scratch,
            &exec,
        )?;
    }
    Ok(())
}

/// Adds up sums of the same label, from all processes.
///
/// The result is the same, bit for bit, in whatever order the sums are; it differs from fixpair_halos_* of the whole by rounding.
///
/// In/out: sums    sums_len of them; the first `groups` become one for each group, in order of their label, the others are undefined
/// Out: groups     how many
/// In:  box_size   L
/// Returns: 0, FIXPAIR_ERROR_NULL, _ALIGNMENT, _OVERLAP, _OVERFLOW, _NOT_FINITE, FIXPAIR_ERROR_RANGE for L, a reference outside [0, L) or no members;
///          nothing is then written
///
/// # Safety
/// Pointers are null or point to as many values as stated.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_halo_sums_merge(
    sums: *mut HaloSums,
    sums_len: usize,
    groups: *mut usize,
    box_size: f64,
) -> fixpair_status_t {
    code((|| {
        let mut border = Border::new();
        // SAFETY: the caller's promise.
        let (sums, groups) = unsafe { (border.write(sums, sums_len)?, border.write_one(groups)?) };
        *groups = halos::halo_sums_merge(sums, box_size)?;
        Ok(())
    })())
}

/// Turns sums of whole groups into a catalogue, ordered as by fixpair_halos_f64, of those of n_min particles and more.
///
/// Out: halos          the first `count` are written
///      count          how many: at most sums_len
/// In:  halos_len      places in halos
///      sums           sums_len of them
///      box_size       L
///      n_min          1 or more
///      particle_mass  see fixpair_particle_mass
/// Returns: 0, FIXPAIR_ERROR_NULL, _ALIGNMENT, _OVERLAP, _OVERFLOW, _NOT_FINITE, _RANGE, FIXPAIR_ERROR_LENGTH if there are more than halos_len
///
/// # Safety
/// Pointers are null or point to as many values as stated.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_halos_finish(
    halos: *mut Halo,
    halos_len: usize,
    count: *mut usize,
    sums: *const HaloSums,
    sums_len: usize,
    box_size: f64,
    n_min: u64,
    particle_mass: f64,
) -> fixpair_status_t {
    code((|| {
        let mut border = Border::new();
        // SAFETY: the caller's promise.
        unsafe {
            let (halos, count) = (border.write(halos, halos_len)?, border.write_one(count)?);
            let sums = border.read(sums, sums_len)?;
            *count = halos::halos_finish(halos, sums, box_size, n_min, particle_mass)?;
        }
        Ok(())
    })())
}
