//! Friends of friends.

use core::ffi::c_void;

use super::border::Border;
use super::exec::{HostExec, fixpair_exec};
use super::pm::{Places, fixpair_positions_f32, fixpair_positions_f64, positions};
use super::status::{code, fixpair_status_t};
use crate::halos;
use crate::scratch::Layout;
use crate::status::Result;

/// The linking length l = b L/N^(1/3).
///
/// Out: length           in the unit of box_size
/// In:  b                0.2 by custom
///      box_size         L
///      particles_total  N, of the whole simulation on all processes
/// Returns: 0, FIXPAIR_ERROR_NULL, _ALIGNMENT, _NOT_FINITE, FIXPAIR_ERROR_RANGE for b or L not positive or N = 0
///
/// # Safety
/// `length` is null or points to one value.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_linking_length(
    length: *mut f64,
    b: f64,
    box_size: f64,
    particles_total: u64,
) -> fixpair_status_t {
    code((|| {
        // SAFETY: the caller's promise.
        let length = unsafe { Border::new().write_one(length) }?;
        *length = halos::linking_length(b, box_size, particles_total)?;
        Ok(())
    })())
}

/// Scratch of fixpair_fof_labels_f64: 36 bytes a particle, and at most 5.3 MB.
///
/// Out: scratch
/// In:  particles  as many as will be passed, or more
/// Returns: 0, FIXPAIR_ERROR_NULL, _ALIGNMENT, FIXPAIR_ERROR_OVERFLOW for 2^32 particles and more
///
/// # Safety
/// `scratch` is null or points to one value.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_fof_labels_scratch_f64(
    scratch: *mut Layout,
    particles: usize,
) -> fixpair_status_t {
    // SAFETY: the caller's promise.
    code(unsafe { query(scratch, particles, halos::fof_labels_scratch::<f64>) })
}

/// fixpair_fof_labels_scratch_f64 in single precision: 24 bytes a particle, and at most 5.3 MB.
///
/// # Safety
/// `scratch` is null or points to one value.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_fof_labels_scratch_f32(
    scratch: *mut Layout,
    particles: usize,
) -> fixpair_status_t {
    // SAFETY: the caller's promise.
    code(unsafe { query(scratch, particles, halos::fof_labels_scratch::<f32>) })
}

/// # Safety
/// `scratch` is null or points to one value.
pub(super) unsafe fn query(
    scratch: *mut Layout,
    particles: usize,
    ask: fn(usize) -> Result<Layout>,
) -> Result<()> {
    // SAFETY: the caller's promise.
    let scratch = unsafe { Border::new().write_one(scratch) }?;
    *scratch = ask(particles)?;
    Ok(())
}

/// Friends of friends: the label of each particle, the smallest id in its group. A particle without friends is a group of its own.
///
/// Particles are friends if d^2 <= l^2, d the distance to the nearest image, in double precision: dx = min(|x_i - x_j|, L - |x_i - x_j|),
/// d^2 = (dx dx + dy dy) + dz dz. A group is all that friends of friends reach.
///
/// One process:
///
/// ```c
/// fixpair_linking_length(&l, 0.2, box_size, n);
/// fixpair_fof_labels_f32(labels, n, &position, NULL, 0, box_size, l, scratch, scratch_len, exec);
/// fixpair_particle_mass(&mass, omega_m, box_size, n);
/// fixpair_halos_f32(halos, n / 20, &count, labels, n, &position, &velocity, box_size, 20, mass, scratch, scratch_len, exec);
/// ```
///
/// Several processes, each with the particles of a region (a slab, or any other shape):
///
/// ```c
/// receive ghosts: copies, with ids, of all particles of other processes within l of the region, periodically;
///     put them behind the own ones;
/// fixpair_fof_labels_f32(labels, own + ghosts, &position, ids, own + ghosts, box_size, l_of_all, ...);
/// for each ghost, get from its owner the label that it has there: pairs[2 g] = label here, pairs[2 g + 1] = label there;
/// gather the pairs of all processes on all; equal ones may be dropped;
/// fixpair_fof_merge(map, map_len, &entries, pairs, pairs_len);
/// fixpair_halo_sums_f32(sums, ..., labels, own, ..., n_min, map, entries, ...);   only own particles
/// fixpair_fof_relabel(labels, own, map, entries, exec);                           where labels themselves are wanted
/// gather the sums of all processes;
/// fixpair_halo_sums_merge(sums, sums_len, &groups, box_size);
/// fixpair_halos_finish(halos, ..., sums, groups, box_size, n_min, mass);
/// ```
///
/// It is enough to have ghosts from one side of each border, for then one process sees each pair of friends.
///
/// Out: labels          len labels, the same for any number of threads
/// In:  position        of len particles; any finite numbers, taken modulo L
///      ids             ids_len = len ids, all different; or NULL and 0: a particle's id is then its number, 0, 1...
///      box_size        L, from 1e-100 to 1e100
///      linking_length  l, from L/10^6 to L/2
///      scratch         scratch_len bytes, see fixpair_fof_labels_scratch_f64
///      exec            or NULL
/// Returns: 0, FIXPAIR_ERROR_NULL, _LENGTH, _ALIGNMENT, _OVERLAP, _OVERFLOW, _RANGE, _SCRATCH; FIXPAIR_ERROR_NOT_FINITE for box_size and
///          linking_length, or for a position, after which, as after FIXPAIR_ERROR_HOOK, labels are undefined
/// Cost: on one core in single precision 120 ns a particle of a simulation at z = 0, l = 0.2 of the mean separation; no more for particles that
///       coincide
///
/// # Safety
/// Pointers are null or point to as many values as stated; the hooks keep their contracts.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_fof_labels_f64(
    labels: *mut u64,
    len: usize,
    position: *const fixpair_positions_f64,
    ids: *const u64,
    ids_len: usize,
    box_size: f64,
    linking_length: f64,
    scratch: *mut c_void,
    scratch_len: usize,
    exec: *const fixpair_exec,
) -> fixpair_status_t {
    // SAFETY: the caller's promise.
    code(unsafe {
        find(labels, len, position, ids, ids_len, box_size, linking_length, scratch, scratch_len, exec)
    })
}

/// fixpair_fof_labels_f64 in single precision.
///
/// # Safety
/// Pointers are null or point to as many values as stated; the hooks keep their contracts.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_fof_labels_f32(
    labels: *mut u64,
    len: usize,
    position: *const fixpair_positions_f32,
    ids: *const u64,
    ids_len: usize,
    box_size: f64,
    linking_length: f64,
    scratch: *mut c_void,
    scratch_len: usize,
    exec: *const fixpair_exec,
) -> fixpair_status_t {
    // SAFETY: the caller's promise.
    code(unsafe {
        find(labels, len, position, ids, ids_len, box_size, linking_length, scratch, scratch_len, exec)
    })
}

unsafe fn find<P: Places>(
    labels: *mut u64,
    len: usize,
    position: *const P,
    ids: *const u64,
    ids_len: usize,
    box_size: f64,
    linking_length: f64,
    scratch: *mut c_void,
    scratch_len: usize,
    exec: *const fixpair_exec,
) -> Result<()> {
    let mut border = Border::new();
    // SAFETY: the caller's promise.
    unsafe {
        let labels = border.write(labels, len)?;
        let position = positions(&mut border, position)?;
        let ids = if ids_len == 0 { border.read_optional(ids, 0)? } else { Some(border.read(ids, ids_len)?) };
        let scratch = border.scratch(scratch, scratch_len)?;
        let exec = HostExec::new(&mut border, exec)?;
        halos::fof_labels(labels, &position, ids, box_size, linking_length, scratch, &exec)
    }
}

/// From pairs of labels that belong to one group to the final label of each: the smallest of all that pairs connect.
///
/// Out: map      entries, one after the other: label, final label; labels increase. Labels that occur in no pair stay as they are
///      entries  how many: at most 2 pairs_len
/// In:  map_len  entries that fit, 2 numbers each: 2 pairs_len or more
///      pairs    pairs_len pairs of labels, 2 numbers each, in any order; see fixpair_fof_labels_f64
/// Returns: 0, FIXPAIR_ERROR_NULL, _LENGTH, _ALIGNMENT, _OVERLAP, _OVERFLOW
/// Cost: a sort of 2 pairs_len entries
///
/// # Safety
/// Pointers are null or point to as many values as stated.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_fof_merge(
    map: *mut u64,
    map_len: usize,
    entries: *mut usize,
    pairs: *const u64,
    pairs_len: usize,
) -> fixpair_status_t {
    code((|| {
        let mut border = Border::new();
        // SAFETY: the caller's promise.
        unsafe {
            let (map, entries) = (border.write(map.cast(), map_len)?, border.write_one(entries)?);
            *entries = halos::fof_merge(map, border.read(pairs.cast(), pairs_len)?)?;
        }
        Ok(())
    })())
}

/// Replaces labels by their final ones, where the map holds them.
///
/// In/out: labels  len labels
/// In:     map     map_len entries of fixpair_fof_merge, 2 numbers each
///         exec    or NULL
/// Returns: 0, FIXPAIR_ERROR_NULL, _ALIGNMENT, _OVERLAP, _OVERFLOW, FIXPAIR_ERROR_TABLE unless the labels of the map increase,
///          FIXPAIR_ERROR_HOOK, after which some labels are replaced
///
/// # Safety
/// Pointers are null or point to as many values as stated; the hooks keep their contracts.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_fof_relabel(
    labels: *mut u64,
    len: usize,
    map: *const u64,
    map_len: usize,
    exec: *const fixpair_exec,
) -> fixpair_status_t {
    code((|| {
        let mut border = Border::new();
        // SAFETY: the caller's promise.
        unsafe {
            let (labels, map) = (border.write(labels, len)?, border.read(map.cast(), map_len)?);
            halos::fof_relabel(labels, map, &HostExec::new(&mut border, exec)?)
        }
    })())
}
