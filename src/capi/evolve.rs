//! Runs: from initial conditions to late times.

use core::ffi::c_void;

use super::border::Border;
use super::cosmology::fixpair_cosmology;
use super::exec::{HostExec, fixpair_exec};
use super::factors::{FIXPAIR_COLA_EXPONENT, FIXPAIR_STEPPER_FASTPM};
use super::fft::{Hook, HostFft, fixpair_fft_f32, fixpair_fft_f64};
use super::force::{FIXPAIR_DIFFERENCE_FOUR_POINT, fixpair_force_law};
use super::particles::{components, fixpair_components_f32, fixpair_components_f64};
use super::pm::FIXPAIR_WINDOW_CIC;
use super::run::{
    Structs, fixpair_displacements_f32, fixpair_displacements_f64, fixpair_gravity, fixpair_observer,
    fixpair_outputs_f32, fixpair_outputs_f64, lagrangian, shown, told,
};
use super::status::{code, fixpair_status_t};
use crate::cosmology::Cosmology;
use crate::pm::evolve::{self, Epoch, Workshop};
use crate::scratch::Layout;
use crate::status::Result;

/// Fills the gravity: the GOLIAT cosmology, km/s and Mpc/h, FastPM, cloud in cell, and the force law of fixpair_force_law_init but for a gradient of
/// four points, which does not see the lattice of the particles: FastPM's kernel 1_4. box_size is 0, which runs refuse: set it, and the cosmology
/// that the initial conditions have.
///
/// Out: gravity
/// Returns: 0, FIXPAIR_ERROR_NULL, FIXPAIR_ERROR_ALIGNMENT
///
/// # Safety
/// `gravity` is null or points to one.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_gravity_init(gravity: *mut fixpair_gravity) -> fixpair_status_t {
    code((|| {
        // SAFETY: the caller's promise.
        *unsafe { Border::new().write_one(gravity) }? = fixpair_gravity {
            struct_size: size_of::<fixpair_gravity>(),
            cosmology: fixpair_cosmology::new(Cosmology::goliat()),
            box_size: 0.0,
            hubble: 100.0,
            law: fixpair_force_law {
                gradient: FIXPAIR_DIFFERENCE_FOUR_POINT,
                ..fixpair_force_law::initial()
            },
            cola_exponent: FIXPAIR_COLA_EXPONENT,
            stepper: FIXPAIR_STEPPER_FASTPM,
            window: FIXPAIR_WINDOW_CIC,
        };
        Ok(())
    })())
}

/// Scratch of fixpair_evolve_f64: the largest of those of the deposit, the kick and the forces, at most 75 MB however many particles.
///
/// Out: scratch
/// In:  fft        of a whole mesh
///      particles
///      window     FIXPAIR_WINDOW_...
/// Returns: 0, FIXPAIR_ERROR_NULL, _ALIGNMENT, _OVERLAP, _OVERFLOW, _CHOICE, _BRICK for a part of a mesh, or why the hook is refused
///
/// # Safety
/// Pointers are null or point to one value; the hooks keep their contracts.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_evolve_scratch_f64(
    scratch: *mut Layout,
    fft: *const fixpair_fft_f64,
    particles: usize,
    window: i32,
) -> fixpair_status_t {
    // SAFETY: the caller's promise.
    code(unsafe { query(scratch, fft, particles, window) })
}

/// fixpair_evolve_scratch_f64 in single precision: at most 41 MB.
///
/// # Safety
/// Pointers are null or point to one value; the hooks keep their contracts.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_evolve_scratch_f32(
    scratch: *mut Layout,
    fft: *const fixpair_fft_f32,
    particles: usize,
    window: i32,
) -> fixpair_status_t {
    // SAFETY: the caller's promise.
    code(unsafe { query(scratch, fft, particles, window) })
}

unsafe fn query<H: Hook>(scratch: *mut Layout, fft: *const H, particles: usize, window: i32) -> Result<()> {
    let mut border = Border::new();
    // SAFETY: the caller's promise.
    let (scratch, fft) = unsafe { (border.write_one(scratch)?, HostFft::new(&mut border, fft)?) };
    *scratch = evolve::evolve_scratch(&fft, particles, window.try_into()?)?;
    Ok(())
}

/// Moves particles of one mass under their gravity, by the particle-mesh method, through a list of scale factors: from initial conditions to today.
///
/// Step i has the force at a_i, kicks velocities to the middle of the next step, sqrt(a_i a_(i+1)), and drifts positions to a_(i+1) with them; at the
/// end of the list velocities are kicked to its last entry. A list of N entries costs N forces. On the way velocities are half a step behind
/// positions: `epoch` says where both are.
///
/// Positions, velocities and epoch are the whole state. Save them in the observer, and a later call with them and the same list gives the same bits
/// as a run that never stopped. Outputs up to the middle of the step at hand are then taken as written.
///
/// Outputs at any time: with the force of the nearest step, positions drift from it to the output and velocities are kicked, in arrays of their own;
/// no force is computed. They meet the steps exactly, with an error of second order between them.
///
/// At two cells a particle or more (B >= 2) keep the four-point gradient and leave law.window at 0: a lattice of particles has images of its modes
/// there, which an exact gradient lets grow (10% in P(k)) and sharpening amplifies. At one cell a particle FIXPAIR_WINDOW_PCS with law.window the
/// same gets the power of the largest modes right to 1e-4. Equal steps of a suit late times better than equal steps of ln a. With B = 2, CIC and 20 steps from z = 32,
/// P(k) of particles 2 Mpc/h apart is within 4% of HMcode's for k < 0.25 h/Mpc.
///
/// The same bits on any number of threads. One process holds all particles; a host with slabs builds its own loop of fixpair_deposit_f64, its
/// transform, fixpair_forces_f64, fixpair_kick_f64 and fixpair_drift_f64, with the factors of fixpair_kick_factors and fixpair_drift_factors.
///
/// In/Out: position  wrapped into [0, L) by each step; a list of one scale factor moves none
///      velocity  peculiar, a dx/dt, as fixpair_initial_conditions_f64 makes them
///      epoch     where they are: positions at an entry of the list, velocities there too or in the middle of the step before
/// In:  gravity
///      displacements  for COLA; NULL for others
///      scale_factors  scale_factors_len entries, increasing, from 1e-5 to 10; see fixpair_linear_steps
///      outputs   or NULL
///      mesh1, mesh2, mesh3  mesh_len >= fft->length reals each, overwritten; aligned as the transform wants them
///      fft       of a whole mesh: side = particles a side times the mesh factor B, usually 1 or 2
///      scratch   scratch_len bytes, see fixpair_evolve_scratch_f64
///      observer  told of each step and output, and can stop the run; or NULL
///      exec      or NULL
/// Returns: 0; FIXPAIR_ERROR_STOPPED if the observer asked for it: go on with the same list whenever you like; FIXPAIR_ERROR_NULL (also for COLA
///          without displacements), _LENGTH, _ALIGNMENT, _OVERLAP, _OVERFLOW, _RANGE (also for a list that does not increase, an epoch or output
///          outside it, and no particles), _CHOICE, _VERSION, _SCRATCH, _CONVERGENCE, _BRICK for a part of a mesh, or why the hook is refused, _NOT_FINITE: particles and epoch as they were,
///          unless NOT_FINITE comes from a velocity or displacement, or from particles that move beyond all numbers. After that and after
///          FIXPAIR_ERROR_HOOK they are undefined
/// Cost: a step is four transforms, a deposit, a kick and a drift; memory beyond the particles: three meshes
///
/// # Safety
/// Pointers are null or point to as many values as stated; the hooks keep their contracts.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_evolve_f64(
    position: *const fixpair_components_f64,
    velocity: *const fixpair_components_f64,
    epoch: *mut Epoch,
    gravity: *const fixpair_gravity,
    displacements: *const fixpair_displacements_f64,
    scale_factors: *const f64,
    scale_factors_len: usize,
    outputs: *const fixpair_outputs_f64,
    mesh1: *mut f64,
    mesh2: *mut f64,
    mesh3: *mut f64,
    mesh_len: usize,
    fft: *const fixpair_fft_f64,
    scratch: *mut c_void,
    scratch_len: usize,
    observer: *const fixpair_observer,
    exec: *const fixpair_exec,
) -> fixpair_status_t {
    // SAFETY: the caller's promise.
    code(unsafe {
        run(
            [position, velocity],
            epoch,
            gravity,
            displacements,
            (scale_factors, scale_factors_len),
            outputs,
            ([mesh1, mesh2, mesh3], mesh_len),
            fft,
            (scratch, scratch_len),
            observer,
            exec,
        )
    })
}

/// fixpair_evolve_f64 in single precision: 36 bytes a particle and 41 MB, at one cell a particle.
///
/// # Safety
/// Pointers are null or point to as many values as stated; the hooks keep their contracts.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_evolve_f32(
    position: *const fixpair_components_f32,
    velocity: *const fixpair_components_f32,
    epoch: *mut Epoch,
    gravity: *const fixpair_gravity,
    displacements: *const fixpair_displacements_f32,
    scale_factors: *const f64,
    scale_factors_len: usize,
    outputs: *const fixpair_outputs_f32,
    mesh1: *mut f32,
    mesh2: *mut f32,
    mesh3: *mut f32,
    mesh_len: usize,
    fft: *const fixpair_fft_f32,
    scratch: *mut c_void,
    scratch_len: usize,
    observer: *const fixpair_observer,
    exec: *const fixpair_exec,
) -> fixpair_status_t {
    // SAFETY: the caller's promise.
    code(unsafe {
        run(
            [position, velocity],
            epoch,
            gravity,
            displacements,
            (scale_factors, scale_factors_len),
            outputs,
            ([mesh1, mesh2, mesh3], mesh_len),
            fft,
            (scratch, scratch_len),
            observer,
            exec,
        )
    })
}

unsafe fn run<S: Structs>(
    [position, velocity]: [*const S::Triple; 2],
    epoch: *mut Epoch,
    gravity: *const fixpair_gravity,
    displacements: *const S::Displacements,
    (scale_factors, scale_factors_len): (*const f64, usize),
    outputs: *const S::Outputs,
    (meshes, mesh_len): ([*mut S::Real; 3], usize),
    fft: *const S,
    (scratch, scratch_len): (*mut c_void, usize),
    observer: *const fixpair_observer,
    exec: *const fixpair_exec,
) -> Result<()> {
    let mut border = Border::new();
    // SAFETY: the caller's promise.
    unsafe {
        let mut position = components(&mut border, position)?;
        let mut velocity = components(&mut border, velocity)?;
        let epoch = border.write_one(epoch)?;
        let gravity = border.read_one(gravity)?.check()?;
        let displacements = lagrangian::<S>(&mut border, displacements)?;
        let scale_factors = border.read(scale_factors, scale_factors_len)?;
        let mut outputs = shown::<S>(&mut border, outputs)?;
        let [mesh1, mesh2, mesh3] = meshes;
        let meshes =
            [border.write(mesh1, mesh_len)?, border.write(mesh2, mesh_len)?, border.write(mesh3, mesh_len)?];
        let mut fft = HostFft::new(&mut border, fft)?;
        let scratch = border.scratch(scratch, scratch_len)?;
        let mut tell = told(&mut border, observer)?;
        let exec = HostExec::new(&mut border, exec)?;
        let mut workshop = Workshop { meshes, fft: &mut fft, scratch, exec: &exec };
        evolve::evolve(
            &gravity,
            epoch,
            &mut position,
            &mut velocity,
            displacements.as_ref(),
            scale_factors,
            outputs.as_mut(),
            &mut workshop,
            &mut tell,
        )
    }
}
