//! Runs: from initial conditions to late times.

use core::ffi::c_void;

use super::border::Border;
use super::cosmology::fixpair_cosmology;
use super::exec::{HostExec, fixpair_exec};
use super::factors::{FIXPAIR_COLA_EXPONENT, FIXPAIR_STEPPER_FASTPM, stepper};
use super::fft::{Hook, HostFft, fixpair_fft_f32, fixpair_fft_f64};
use super::force::{FIXPAIR_DIFFERENCE_FOUR_POINT, fixpair_force_law};
use super::particles::{Triple, components, components_of, fixpair_components_f32, fixpair_components_f64};
use super::pm::{FIXPAIR_WINDOW_CIC, Places, fixpair_positions_f32, fixpair_positions_f64, positions_of};
use super::status::{code, fixpair_status_t};
use crate::cosmology::Cosmology;
use crate::pm::evolve::{self, Displacements, Epoch, Gravity, Workshop};
use crate::pm::kick::Lpt;
use crate::pm::outputs::{Event, Outputs, Progress, Verdict};
use crate::real::Real;
use crate::scratch::Layout;
use crate::status::{Error, Result};

/// Positions have reached the next scale factor of the list.
pub const FIXPAIR_EVENT_STEP: i32 = 0;
/// An output is in its arrays.
pub const FIXPAIR_EVENT_OUTPUT: i32 = 1;

/// What moves the particles of a run. fixpair_gravity_init fills one.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct fixpair_gravity {
    /// sizeof(fixpair_gravity).
    pub struct_size: usize,
    /// Background.
    pub cosmology: fixpair_cosmology,
    /// Side of the box, in the unit of positions.
    pub box_size: f64,
    /// H0 in the unit of velocities over that of positions: 100 for km/s and Mpc/h, 0.1 for km/s and kpc/h.
    pub hubble: f64,
    /// From density to force.
    pub law: fixpair_force_law,
    /// n of FIXPAIR_STEPPER_COLA; not read by others.
    pub cola_exponent: f64,
    /// FIXPAIR_STEPPER_FASTPM, _LEAPFROG or _COLA.
    pub stepper: i32,
    /// FIXPAIR_WINDOW_NGP, _CIC, _TSC or _PCS, for the deposit of masses and the read-out of forces.
    pub window: i32,
}

impl fixpair_gravity {
    fn check(&self) -> Result<Gravity> {
        if self.struct_size != size_of::<Self>() {
            return Err(Error::Version);
        }
        Ok(Gravity {
            cosmology: self.cosmology.check()?,
            box_size: self.box_size,
            hubble: self.hubble,
            window: self.window.try_into()?,
            law: self.law.check()?,
            stepper: stepper(self.stepper, self.cola_exponent)?,
        })
    }
}

/// Fills the gravity: the GOLIAT cosmology, a box of 1000 Mpc/h, km/s, FastPM, cloud in cell, and the force law of fixpair_force_law_init but for a gradient of
/// four points, which does not see the lattice of the particles: FastPM's own choice.
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
            box_size: 1000.0,
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

/// What a run has just done.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct fixpair_progress {
    /// FIXPAIR_EVENT_STEP or FIXPAIR_EVENT_OUTPUT.
    pub event: i32,
    /// Entry of the list of scale factors that positions have reached.
    pub step: usize,
    /// The last entry of the list.
    pub steps: usize,
    /// The output that was written; after a step, the one that comes next.
    pub output: usize,
    /// Where the particles are: those of the run after a step, those of the output arrays after an output.
    pub epoch: Epoch,
}

/// Who is told of progress. It may read the particles of the run and of the output arrays, and save them, but not change them.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct fixpair_observer {
    /// Handed to observe as it is.
    pub context: *mut c_void,
    /// Returns 0 to go on; anything else ends the run after the step at hand with FIXPAIR_ERROR_STOPPED.
    pub observe: Option<unsafe extern "C" fn(context: *mut c_void, progress: *const fixpair_progress) -> i32>,
}

/// Displacements of the particles in Lagrangian perturbation theory, x = q + first + second, when the scale factor was `scale_factor`: what COLA needs. From
/// modes: fixpair_displace_f64 writes the first order as its velocity for c1 = 1, c2 = 0, the second for c1 = 0, c2 = 1.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct fixpair_displacements_f64 {
    /// First order, one a particle.
    pub first: fixpair_positions_f64,
    /// Second order, one a particle; of length 0 for none.
    pub second: fixpair_positions_f64,
    /// When.
    pub scale_factor: f64,
}

/// Where particles go at times between the steps of a run: each output overwrites the last.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct fixpair_outputs_f64 {
    /// When: increasing, inside the list of steps.
    pub scale_factors: *const f64,
    /// How many.
    pub length: usize,
    /// One a particle.
    pub position: fixpair_components_f64,
    /// Peculiar, one a particle.
    pub velocity: fixpair_components_f64,
}

/// Displacements of the particles in Lagrangian perturbation theory, x = q + first + second, when the scale factor was `scale_factor`: what COLA needs. From
/// modes: fixpair_displace_f32 writes the first order as its velocity for c1 = 1, c2 = 0, the second for c1 = 0, c2 = 1.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct fixpair_displacements_f32 {
    /// First order, one a particle.
    pub first: fixpair_positions_f32,
    /// Second order, one a particle; of length 0 for none.
    pub second: fixpair_positions_f32,
    /// When.
    pub scale_factor: f64,
}

/// Where particles go at times between the steps of a run: each output overwrites the last.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct fixpair_outputs_f32 {
    /// When: increasing, inside the list of steps.
    pub scale_factors: *const f64,
    /// How many.
    pub length: usize,
    /// One a particle.
    pub position: fixpair_components_f32,
    /// Peculiar, one a particle.
    pub velocity: fixpair_components_f32,
}

/// The structs of one precision, as one.
trait Structs: Hook {
    type Triple: Triple<Real = Self::Real>;
    type Places: Places<Real = Self::Real>;
    type Outputs: Copy;
    type Displacements: Copy;

    fn outputs(of: &Self::Outputs) -> (*const f64, usize, [Self::Triple; 2]);
    fn displacements(of: &Self::Displacements) -> ([Self::Places; 2], f64);
}

macro_rules! structs {
    ($hook:ty, $triple:ty, $places:ty, $outputs:ty, $displacements:ty) => {
        impl Structs for $hook {
            type Triple = $triple;
            type Places = $places;
            type Outputs = $outputs;
            type Displacements = $displacements;

            fn outputs(of: &$outputs) -> (*const f64, usize, [$triple; 2]) {
                (of.scale_factors, of.length, [of.position, of.velocity])
            }

            fn displacements(of: &$displacements) -> ([$places; 2], f64) {
                ([of.first, of.second], of.scale_factor)
            }
        }
    };
}
structs!(
    fixpair_fft_f64,
    fixpair_components_f64,
    fixpair_positions_f64,
    fixpair_outputs_f64,
    fixpair_displacements_f64
);
structs!(
    fixpair_fft_f32,
    fixpair_components_f32,
    fixpair_positions_f32,
    fixpair_outputs_f32,
    fixpair_displacements_f32
);

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
/// end of the list velocities are kicked to its last entry. A list of N entries costs N forces. On the way velocities are half a step behind positions:
/// `epoch` says where both are.
///
/// Positions, velocities and epoch are the whole state. Save them in the observer, and a later call with them and the same list gives the same bits as a
/// run that never stopped. Outputs up to the middle of the step at hand are then taken as written.
///
/// Outputs at any time: with the force of the nearest step, positions drift from it to the output and velocities are kicked, in arrays of their own; no
/// force is computed. They meet the steps exactly, with an error of second order between them.
///
/// At two cells a particle or more (B >= 2) keep the four-point gradient and leave law.window at 0: a lattice of particles has images of its modes there,
/// which an exact gradient lets grow (10% in P(k)) and sharpening amplifies. At one cell a particle FIXPAIR_WINDOW_PCS with law.window the same moves the
/// largest modes to 1e-5. Equal steps of a suit late times better than equal steps of ln a. With B = 2, CIC and 20 steps from z = 32, P(k) of
/// particles 2 Mpc/h apart is within 3% of HMcode's for k < 0.25 h/Mpc.
///
/// The same bits on any number of threads. One process holds all particles; a host with slabs builds its own loop of fixpair_deposit_f64, its transform,
/// fixpair_forces_f64, fixpair_kick_f64 and fixpair_drift_f64, with the factors of fixpair_kick_factors and fixpair_drift_factors.
///
/// In/Out: position  wrapped into [0, L)
///      velocity  peculiar, a dx/dt, as fixpair_initial_conditions_f64 makes them
///      epoch     where they are: positions at an entry of the list, velocities there too or in the middle of the step before
/// In:  gravity
///      displacements  for COLA; NULL for others
///      scale_factors  scale_factors_len entries, increasing, in 1e-5 ..= 10; see fixpair_linear_steps
///      outputs   or NULL
///      mesh1, mesh2, mesh3  mesh_len >= fft->length reals each, overwritten; aligned as the transform wants them
///      fft       of a whole mesh: side = particles a side times the mesh factor B, usually 1 or 2
///      scratch   scratch_len bytes, see fixpair_evolve_scratch_f64
///      observer  told of each step and output, and can stop the run; or NULL
///      exec      or NULL
/// Returns: 0; FIXPAIR_ERROR_STOPPED if the observer asked for it: go on with the same list whenever you like; FIXPAIR_ERROR_NULL (also for COLA
///          without displacements), _LENGTH, _ALIGNMENT, _OVERLAP, _OVERFLOW, _RANGE (also for a list that does not increase, an epoch or output outside
///          it, and no particles), _CHOICE, _VERSION, _SCRATCH, _BRICK for a part of a mesh, _NOT_FINITE: particles and epoch as they were, unless
///          NOT_FINITE comes from a velocity or displacement, or from particles that move beyond all numbers. After that and after
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

unsafe fn lagrangian<'a, S: Structs>(
    border: &mut Border,
    pointer: *const S::Displacements,
) -> Result<Option<Displacements<'a, S::Real>>> {
    if pointer.is_null() {
        return Ok(None);
    }
    // SAFETY: the caller's promise.
    unsafe {
        let ([first, second], scale_factor) = S::displacements(border.read_one(pointer)?);
        let first = positions_of(border, &first)?;
        let second = if second.parts().2 == 0 { None } else { Some(positions_of(border, &second)?) };
        Ok(Some(Displacements { lpt: Lpt { first, second }, scale_factor }))
    }
}

unsafe fn shown<'a, S: Structs>(
    border: &mut Border,
    pointer: *const S::Outputs,
) -> Result<Option<Outputs<'a, S::Real>>> {
    if pointer.is_null() {
        return Ok(None);
    }
    // SAFETY: the caller's promise.
    unsafe {
        let (scale_factors, length, [position, velocity]) = S::outputs(border.read_one(pointer)?);
        let scale_factors = border.read(scale_factors, length)?;
        let position = components_of(border, &position)?;
        let velocity = components_of(border, &velocity)?;
        Ok(Some(Outputs { scale_factors, position, velocity }))
    }
}

/// The host's observer as a function; without one, all is well.
unsafe fn told<T: Real>(
    border: &mut Border,
    pointer: *const fixpair_observer,
) -> Result<impl FnMut(&Progress<'_, T>) -> Verdict + use<T>> {
    let mut observer = None;
    if !pointer.is_null() {
        // SAFETY: the caller's promise.
        let fixpair_observer { context, observe } = *unsafe { border.read_one(pointer) }?;
        observer = Some((context, observe.ok_or(Error::Null)?));
    }
    Ok(move |progress: &Progress<'_, T>| {
        let Some((context, observe)) = observer else { return Verdict::Continue };
        let Progress { event, step, steps, output, epoch, .. } = *progress;
        let event = match event {
            Event::Step => FIXPAIR_EVENT_STEP,
            Event::Output => FIXPAIR_EVENT_OUTPUT,
        };
        let report = fixpair_progress { event, step, steps, output, epoch };
        // SAFETY: the host's function, with its own context; the report lives until it returns.
        if unsafe { observe(context, &raw const report) } == 0 { Verdict::Continue } else { Verdict::Stop }
    })
}
