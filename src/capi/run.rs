//! The structs of runs.

use core::ffi::c_void;

use super::border::Border;
use super::cosmology::fixpair_cosmology;
use super::factors::stepper;
use super::fft::{Hook, fixpair_fft_f32, fixpair_fft_f64};
use super::force::fixpair_force_law;
use super::particles::{Triple, components_of, fixpair_components_f32, fixpair_components_f64};
use super::pm::{Places, fixpair_positions_f32, fixpair_positions_f64, positions_of};
use crate::pm::evolve::{Displacements, Epoch, Gravity};
use crate::pm::kick::Lpt;
use crate::pm::outputs::{Event, Outputs, Progress, Verdict};
use crate::real::Real;
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
    pub(super) fn check(&self) -> Result<Gravity> {
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

/// Who is told of progress, on the thread that the run was called from. It may read the particles of the run and of the output arrays, and save
/// them, but not change them; and it may call the library with other scratch and meshes, also with the run's transform and threads.
///
/// Saved after a step, particles and epoch are what a later call goes on from. Outputs told of by then count as written; so where one could not be
/// saved, save nothing after it. The step after an answer other than 0 is still told of. The last step is told of before its final kick: save the
/// end of a run after the call.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct fixpair_observer {
    /// Handed to observe as it is.
    pub context: *mut c_void,
    /// Returns 0 to go on; anything else ends the run after the step at hand with FIXPAIR_ERROR_STOPPED, unless there is none after it.
    pub observe: Option<unsafe extern "C" fn(context: *mut c_void, progress: *const fixpair_progress) -> i32>,
}

/// Displacements of the particles in Lagrangian perturbation theory, x = q + first + second, when the scale factor was `scale_factor`: what COLA
/// needs. From modes: fixpair_displace_f64 writes the first order as its velocity for c1 = 1, c2 = 0, the second for c1 = 0, c2 = 1.
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

/// Displacements of the particles in Lagrangian perturbation theory, x = q + first + second, when the scale factor was `scale_factor`: what COLA
/// needs. From modes: fixpair_displace_f32 writes the first order as its velocity for c1 = 1, c2 = 0, the second for c1 = 0, c2 = 1.
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
pub(super) trait Structs: Hook {
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

pub(super) unsafe fn lagrangian<'a, S: Structs>(
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

pub(super) unsafe fn shown<'a, S: Structs>(
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
pub(super) unsafe fn told<T: Real>(
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
