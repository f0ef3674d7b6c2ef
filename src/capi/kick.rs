//! Kick and drift.

use core::ffi::c_void;

use super::border::Border;
use super::exec::{HostExec, fixpair_exec};
use super::mesh::fixpair_brick;
use super::particles::{Triple, components, fixpair_components_f32, fixpair_components_f64};
use super::pm::{Places, fixpair_positions_f32, fixpair_positions_f64, positions, query, region};
use super::status::{code, fixpair_status_t};
use crate::pm::{self, Assignment, Drift, Kick, Lpt};
use crate::scratch::Layout;
use crate::status::Result;

/// Displacements of the particles by Lagrangian perturbation theory, or none where the first pointer is null.
///
/// # Safety
/// Pointers are null or point to positions whose elements nobody writes.
pub(super) unsafe fn displacements<'a, P: Places>(
    border: &mut Border,
    psi1: *const P,
    psi2: *const P,
) -> Result<Option<Lpt<'a, P::Real>>> {
    if psi1.is_null() && psi2.is_null() {
        return Ok(None);
    }
    // SAFETY: the caller's promise.
    unsafe {
        let first = positions(border, psi1)?;
        let second = if psi2.is_null() { None } else { Some(positions(border, psi2)?) };
        Ok(Some(Lpt { first, second }))
    }
}

/// Scratch of fixpair_kick_f64: with m = min(particles, 2^21) and t tiles, 32 m + 2 m + 8 (m/8 + ceil(m/2^15)) + 4 t ceil(m/2^15) + 4 (t + 1)
/// bytes, each rounded up to 64; t is at most 4096 and depends on region and window alone. At most 75 MB, however many particles.
///
/// Out: scratch
/// In:  region     of configuration space; may run over the edge
///      particles  as many as will be passed, or more
///      window     FIXPAIR_WINDOW_NGP, _CIC, _TSC or _PCS
/// Returns: 0, FIXPAIR_ERROR_NULL, _ALIGNMENT, _OVERLAP, _OVERFLOW, _CHOICE, or why the region is refused
///
/// # Safety
/// Pointers are null or point to one value.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_kick_scratch_f64(
    scratch: *mut Layout,
    region: *const fixpair_brick,
    particles: usize,
    window: i32,
) -> fixpair_status_t {
    // SAFETY: the caller's promise.
    code(unsafe { query(scratch, region, particles, window, pm::kick_scratch::<f64>) })
}

/// fixpair_kick_scratch_f64 in single precision: 16 m instead of 32 m, at most 41 MB.
///
/// # Safety
/// Pointers are null or point to one value.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_kick_scratch_f32(
    scratch: *mut Layout,
    region: *const fixpair_brick,
    particles: usize,
    window: i32,
) -> fixpair_status_t {
    // SAFETY: the caller's promise.
    code(unsafe { query(scratch, region, particles, window, pm::kick_scratch::<f32>) })
}

/// Kicks particles: u_i <- keep u_i + force F(x_i) + first psi1_i + second psi2_i, F(x_i) = sum_c W(x_c - x_i) F_c as fixpair_read_out_f64 has it.
///
/// Peculiar velocities go from a0 to a1 with f of fixpair_kick_factors and H0 (100 for km/s and Mpc/h): keep = a0/a1, force = f.factor H0/a1, and
/// for COLA first = f.first H0/(a1 D), second = f.second H0/(a1 D2), D and D2 (fixpair_growth_factors) of the time at which psi1 and psi2 are the
/// displacements of both orders. Sums over the four terms are in double precision and rounded once; the result is the same, bit for bit, on any
/// number of threads.
///
/// In/Out: velocity  u; may share an array of structs with the positions
/// In:  position
///      force_x, force_y, force_z  components of F, mesh_len reals each on the region, ghost planes filled (fixpair_copy_cells_f64)
///      region    of configuration space; may run over the edge (fixpair_brick_with_ghosts)
///      box_size, window, shift  as fixpair_deposit_f64
///      keep, force, first, second  factors
///      psi1      or NULL if first and second are 0
///      psi2      or NULL if second is 0
///      scratch   scratch_len bytes, see fixpair_kick_scratch_f64
///      exec      or NULL
/// Returns: as fixpair_deposit_f64; FIXPAIR_ERROR_NULL also for displacements with a factor that are NULL; FIXPAIR_ERROR_NOT_FINITE for
///          box_size, shift and factors, or for a position, velocity, force or displacement, after which, as after FIXPAIR_ERROR_OUTSIDE,
///          some velocities are kicked, some not; after FIXPAIR_ERROR_HOOK they are undefined
/// Cost: on one core in single precision with CIC 18 ns a particle if neighbours in memory are neighbours in space,
///       31 ns for a lattice displaced as far as clustering does, 50 ns in random order; with TSC 34, 51 and 80 ns
///
/// # Safety
/// Pointers are null or point to as many values as stated; the hooks keep their contracts.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_kick_f64(
    velocity: *const fixpair_components_f64,
    position: *const fixpair_positions_f64,
    force_x: *const f64,
    force_y: *const f64,
    force_z: *const f64,
    mesh_len: usize,
    region: *const fixpair_brick,
    box_size: f64,
    window: i32,
    shift: f64,
    keep: f64,
    force: f64,
    first: f64,
    second: f64,
    psi1: *const fixpair_positions_f64,
    psi2: *const fixpair_positions_f64,
    scratch: *mut c_void,
    scratch_len: usize,
    exec: *const fixpair_exec,
) -> fixpair_status_t {
    let forces = [force_x, force_y, force_z];
    let factors = Kick { keep, force, first, second };
    // SAFETY: the caller's promise.
    code(unsafe {
        kick_particles(
            velocity,
            position,
            forces,
            mesh_len,
            region,
            (box_size, window, shift),
            &factors,
            [psi1, psi2],
            scratch,
            scratch_len,
            exec,
        )
    })
}

/// fixpair_kick_f64 in single precision: velocities, positions, displacements and meshes. Factors stay double.
///
/// # Safety
/// Pointers are null or point to as many values as stated; the hooks keep their contracts.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_kick_f32(
    velocity: *const fixpair_components_f32,
    position: *const fixpair_positions_f32,
    force_x: *const f32,
    force_y: *const f32,
    force_z: *const f32,
    mesh_len: usize,
    region: *const fixpair_brick,
    box_size: f64,
    window: i32,
    shift: f64,
    keep: f64,
    force: f64,
    first: f64,
    second: f64,
    psi1: *const fixpair_positions_f32,
    psi2: *const fixpair_positions_f32,
    scratch: *mut c_void,
    scratch_len: usize,
    exec: *const fixpair_exec,
) -> fixpair_status_t {
    let forces = [force_x, force_y, force_z];
    let factors = Kick { keep, force, first, second };
    // SAFETY: the caller's promise.
    code(unsafe {
        kick_particles(
            velocity,
            position,
            forces,
            mesh_len,
            region,
            (box_size, window, shift),
            &factors,
            [psi1, psi2],
            scratch,
            scratch_len,
            exec,
        )
    })
}

unsafe fn kick_particles<C: Triple, P: Places<Real = C::Real>>(
    velocity: *const C,
    position: *const P,
    forces: [*const C::Real; 3],
    mesh_len: usize,
    brick: *const fixpair_brick,
    (box_size, window, shift): (f64, i32, f64),
    factors: &Kick,
    [psi1, psi2]: [*const P; 2],
    scratch: *mut c_void,
    scratch_len: usize,
    exec: *const fixpair_exec,
) -> Result<()> {
    let mut border = Border::new();
    // SAFETY: the caller's promise.
    unsafe {
        let mut velocity = components(&mut border, velocity)?;
        let position = positions(&mut border, position)?;
        let [x, y, z] = forces;
        let forces = [border.read(x, mesh_len)?, border.read(y, mesh_len)?, border.read(z, mesh_len)?];
        let region = region(border.read_one(brick)?)?;
        let lpt = displacements(&mut border, psi1, psi2)?;
        let assignment = Assignment { box_size, window: window.try_into()?, shift };
        let scratch = border.scratch(scratch, scratch_len)?;
        let exec = HostExec::new(&mut border, exec)?;
        pm::kick(
            &mut velocity,
            &position,
            forces,
            &region,
            &assignment,
            factors,
            lpt.as_ref(),
            scratch,
            &exec,
        )
    }
}

/// Moves particles: x_i <- x_i + factor u_i + first psi1_i + second psi2_i, wrapped into [0, L).
///
/// With f of fixpair_drift_factors, and peculiar velocities of the time `at`: factor = f.factor at/H0, and for COLA first = f.first/D, second =
/// f.second/D2, D, D2, psi1 and psi2 as for fixpair_kick_f64. Sums are in double precision and rounded once; no position becomes L itself. The
/// result is the same, bit for bit, on any number of threads.
///
/// In/Out: position  any finite numbers before; may share an array of structs with the velocities
/// In:  velocity  u
///      box_size  L
///      factor, first, second
///      psi1      or NULL if first and second are 0
///      psi2      or NULL if second is 0
///      exec      or NULL
/// Returns: 0, FIXPAIR_ERROR_LENGTH, _ALIGNMENT, _OVERLAP, _OVERFLOW, _RANGE; FIXPAIR_ERROR_NULL also for displacements with a factor that are
///          NULL; FIXPAIR_ERROR_NOT_FINITE for box_size and factors, or for a particle that ends nowhere or more than 1e9 boxes away, after
///          which, as after FIXPAIR_ERROR_HOOK, positions are undefined
/// Cost: one pass over positions, velocities and displacements
///
/// # Safety
/// Pointers are null or point to as many values as stated; the hooks keep their contracts.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_drift_f64(
    position: *const fixpair_components_f64,
    velocity: *const fixpair_positions_f64,
    box_size: f64,
    factor: f64,
    first: f64,
    second: f64,
    psi1: *const fixpair_positions_f64,
    psi2: *const fixpair_positions_f64,
    exec: *const fixpair_exec,
) -> fixpair_status_t {
    let factors = Drift { velocity: factor, first, second };
    // SAFETY: the caller's promise.
    code(unsafe { drift_particles(position, velocity, box_size, &factors, [psi1, psi2], exec) })
}

/// fixpair_drift_f64 in single precision: positions, velocities and displacements. Factors stay double.
///
/// # Safety
/// Pointers are null or point to as many values as stated; the hooks keep their contracts.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_drift_f32(
    position: *const fixpair_components_f32,
    velocity: *const fixpair_positions_f32,
    box_size: f64,
    factor: f64,
    first: f64,
    second: f64,
    psi1: *const fixpair_positions_f32,
    psi2: *const fixpair_positions_f32,
    exec: *const fixpair_exec,
) -> fixpair_status_t {
    let factors = Drift { velocity: factor, first, second };
    // SAFETY: the caller's promise.
    code(unsafe { drift_particles(position, velocity, box_size, &factors, [psi1, psi2], exec) })
}

unsafe fn drift_particles<C: Triple, P: Places<Real = C::Real>>(
    position: *const C,
    velocity: *const P,
    box_size: f64,
    factors: &Drift,
    [psi1, psi2]: [*const P; 2],
    exec: *const fixpair_exec,
) -> Result<()> {
    let mut border = Border::new();
    // SAFETY: the caller's promise.
    unsafe {
        let mut position = components(&mut border, position)?;
        let velocity = positions(&mut border, velocity)?;
        let lpt = displacements(&mut border, psi1, psi2)?;
        let exec = HostExec::new(&mut border, exec)?;
        pm::drift(&mut position, &velocity, box_size, factors, lpt.as_ref(), &exec)
    }
}
