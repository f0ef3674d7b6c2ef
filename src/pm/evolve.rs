//! From initial conditions to late times: force, kick, drift, and so on through a list of scale factors.
//!
//! Step i has the force at a_i, kicks velocities to the middle of the next step, sqrt(a_i a_(i+1)), and drifts positions to a_(i+1) with them; at
//! the end of the list velocities are kicked to the last scale factor. So velocities are half a step behind positions on the way, each step costs
//! one force, and the list of N scale factors N forces. [`Epoch`] says where both are: state is positions, velocities and epoch, and nothing else,
//! so that a run that goes on from what was saved at any step gives the same bits as one that never stopped.
//!
//! Particles that start from a lattice have images of their modes about multiples of its wavenumber. On two cells a particle the first lie at the
//! mesh's Nyquist wavenumber: an exact gradient lets them grow, which adds 10% to P(k) at half the particles' Nyquist wavenumber, and a force whose
//! windows are undone (`ForceLaw::window`) is wrong by tens of per cent. So with two cells or more take [`ForceLaw::FOUR_POINT`]; with one cell
//! windows may be undone, and the power of the largest modes then grows right to 1e-4. Equal steps of a suit late times better than equal steps of ln a.
//!
//! Output at any a between: with the force of the nearest step, positions drift from a_i to a and velocities are kicked to a, in arrays of their
//! own. That is the path that the leapfrog takes anyway; it meets the steps exactly, and its error is of second order, as theirs.

use super::Positions;
use super::deposit::deposit_scratch;
use super::factors::{Stepper, half_step};
use super::force::{ForceLaw, force_scratch};
use super::kick::{Lpt, kick_scratch};
use super::mover::{Mover, whole};
use super::outputs::{Outputs, Progress, Queue, Verdict};
use super::window::Window;
use crate::cosmology::Cosmology;
use crate::exec::Exec;
use crate::fft::Fft3;
use crate::initial::particles::Components;
use crate::real::Real;
use crate::scratch::Layout;
use crate::status::{Error, Result};
use crate::within::Within;

/// What moves the particles.
#[derive(Clone, Copy, Debug)]
pub struct Gravity {
    /// Background.
    pub cosmology: Cosmology,
    /// Side of the box.
    pub box_size: f64,
    /// H0 in the unit of velocity over that of the box: 100 for km/s and Mpc/h, 0.1 for km/s and kpc/h.
    pub hubble: f64,
    /// How particles are shared among cells, and forces read out.
    pub window: Window,
    /// From density to force.
    pub law: ForceLaw,
    /// From force to motion.
    pub stepper: Stepper,
}

/// The scale factors at which positions and velocities are.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct Epoch {
    /// Of positions.
    pub position: f64,
    /// Of velocities: the same at the start and the end of a run, half a step behind between its steps.
    pub velocity: f64,
}

impl Epoch {
    /// Both at one time, as initial conditions are.
    ///
    /// ```
    /// use fixpair::pm::evolve::Epoch;
    ///
    /// assert_eq!(Epoch::at(0.1).velocity, 0.1);
    /// ```
    #[must_use]
    pub const fn at(scale_factor: f64) -> Self {
        Self { position: scale_factor, velocity: scale_factor }
    }
}

/// Displacements of the particles in Lagrangian perturbation theory, x = q + psi1 + psi2, at some time. COLA needs them.
pub struct Displacements<'a, T> {
    /// Of each particle, in the order of the positions.
    pub lpt: Lpt<'a, T>,
    /// When they have this size.
    pub scale_factor: f64,
}

/// Three meshes for the density and the force, and what else a run borrows.
pub struct Workshop<'a, T> {
    /// Of the transform's length each; overwritten.
    pub meshes: [&'a mut [T]; 3],
    /// Of a whole mesh, of any side: that of the particles' lattice times the mesh factor.
    pub fft: &'a mut dyn Fft3<T>,
    /// See [`evolve_scratch`].
    pub scratch: &'a mut [u8],
    /// Threads.
    pub exec: &'a dyn Exec,
}

/// Scratch of [`evolve`]: the largest of deposit, forces and kick.
///
/// # Errors
/// `Overflow`, and `Brick` for a mesh that is not whole.
///
/// # Example
/// ```
/// # use fixpair::{exec::Serial, fft::{Tables, Transform}, mesh::{Brick, Space}};
/// # #[repr(align(64))] struct Memory([u8; 1 << 16]);
/// # let (mut tables, mut work) = (Memory([0; 1 << 16]), Memory([0; 1 << 16]));
/// # let tables = Tables::<f64>::new(8, &mut tables.0)?;
/// # let mut fft = Transform::new(&tables, Brick::whole(8, Space::Configuration)?, &mut work.0, &Serial)?;
/// use fixpair::pm::{Window, evolve_scratch};
///
/// assert!(evolve_scratch::<f64>(&fft, 1 << 30, Window::CloudInCell)?.size < 75_000_000);
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn evolve_scratch<T: Real>(fft: &dyn Fft3<T>, particles: usize, window: Window) -> Result<Layout> {
    let region = whole(fft)?;
    let needs = [
        deposit_scratch::<T>(&region, particles, window)?,
        kick_scratch::<T>(&region, particles, window)?,
        force_scratch(region.n())?,
    ];
    Ok(needs.into_iter().fold(Layout::EMPTY, |most, need| if need.size > most.size { need } else { most }))
}

/// Moves particles of one mass through `scale_factors`, which increase strictly.
///
/// `position`: in the box (any finite numbers on entry). `velocity`: peculiar, u = a dx/dt. `epoch`: where they stand; its position is an entry of
/// `scale_factors`, and its velocity is that entry too, or the middle of the step before it. The run starts from there, and `epoch` follows.
/// `displacements`: for COLA, ignored by others. `outputs` that lie before the velocity's epoch are taken as written already.
///
/// `observe` is called after each step and each output. Where it says stop, the run ends after the step with [`Error::Stopped`], and particles and
/// `epoch` are where a later call with the same list goes on, with the bits of a run that was never stopped. Outputs between the middle of that step
/// and its end come with the later call. Said of an output of the last step's second half, there is nothing left to stop.
///
/// # Errors
/// `Length` for arrays that differ or an empty list, `Range` for scale factors that do not increase or an epoch or output that is not in the list,
/// `NotFinite`, `Null` for COLA without displacements, as [`deposit`](fn@super::deposit::deposit), [`forces`](fn@super::force::forces),
/// [`Stepper::kick`] for parameters; all before anything is touched. `Stopped` as above. `NotFinite` for particles that are or become so, and
/// `Hook`: `epoch` is then of no use.
///
/// The same bits for any number of threads. Memory: particles, three meshes, scratch. Cost of a step: four transforms, a deposit, a kick, a drift,
/// 1.6 ms of scalar factors, half of it before the first step.
///
/// # Example
/// ```
/// # use fixpair::{exec::Serial, fft::{Tables, Transform}, mesh::{Brick, Space}};
/// # #[repr(align(64))] struct Memory([u8; 1 << 16]);
/// # let (mut tables, mut work) = (Memory([0; 1 << 16]), Memory([0; 1 << 16]));
/// # let tables = Tables::<f64>::new(8, &mut tables.0)?;
/// # let mut fft = Transform::new(&tables, Brick::whole(8, Space::Configuration)?, &mut work.0, &Serial)?;
/// use fixpair::cosmology::Cosmology;
/// use fixpair::fft::Fft3;
/// use fixpair::initial::particles::Components;
/// use fixpair::pm::evolve::{Epoch, Gravity, Workshop, evolve};
/// use fixpair::pm::{ForceLaw, Window, factors::Stepper, outputs::Verdict};
/// # let mut memory = Memory([0; 1 << 16]);
/// # let scratch = &mut memory.0;
///
/// let gravity = Gravity {
///     cosmology: Cosmology::goliat(),
///     box_size: 8.0,
///     hubble: 100.0,
///     window: Window::CloudInCell,
///     law: ForceLaw::default(),
///     stepper: Stepper::FastPm,
/// };
/// let (mut x, mut v) = ([1.0, 4.0, 4.0, 3.0, 4.0, 4.0], [0.0; 6]); // two particles
/// let [mut a, mut b, mut c] = [0; 3].map(|_| vec![0.0; fft.length()]);
/// let mut epoch = Epoch::at(0.5);
/// let mut workshop = Workshop { meshes: [&mut a, &mut b, &mut c], fft: &mut fft, scratch, exec: &Serial };
/// let (mut position, mut velocity) = (Components::triples(&mut x)?, Components::triples(&mut v)?);
/// evolve(&gravity, &mut epoch, &mut position, &mut velocity, None, &[0.5, 0.6], None, &mut workshop, &mut |_| Verdict::Continue)?;
/// assert!(x[0] != 1.0 && (x[0] + x[3] - 4.0).abs() < 1e-12 && epoch.position == 0.6); // momentum is conserved
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn evolve<T: Real>(
    gravity: &Gravity,
    epoch: &mut Epoch,
    position: &mut Components<'_, T>,
    velocity: &mut Components<'_, T>,
    displacements: Option<&Displacements<'_, T>>,
    scale_factors: &[f64],
    outputs: Option<&mut Outputs<'_, T>>,
    workshop: &mut Workshop<'_, T>,
    observe: &mut dyn FnMut(&Progress<'_, T>) -> Verdict,
) -> Result<()> {
    let first = start(scale_factors, *epoch)?;
    let last = scale_factors.len() - 1;
    let mover = Mover::new(gravity, displacements, [position.len(), velocity.len()], workshop)?;
    let mut queue = Queue::new(outputs, scale_factors, *epoch, position.len(), observe)?;
    mover.try_steps(scale_factors.part(first..), epoch.velocity)?;
    for step in first..=last {
        let a = scale_factors.at(step);
        queue.steps = [step, last];
        mover.force(&Positions::from(&*position), workshop)?;
        queue.write_until(a, position, velocity, *epoch, &mover, workshop)?;
        if step == last {
            mover.kick(velocity, &Positions::from(&*position), *epoch, a, workshop)?;
            epoch.velocity = a;
            break;
        }
        let next = scale_factors.at(step + 1);
        let middle = half_step(a, next);
        mover.kick(velocity, &Positions::from(&*position), *epoch, middle, workshop)?;
        epoch.velocity = middle;
        queue.write_until(middle, position, velocity, *epoch, &mover, workshop)?;
        mover.drift(position, &Positions::from(&*velocity), *epoch, next, workshop)?;
        epoch.position = next;
        queue.steps = [step + 1, last];
        queue.tell(*epoch, position, velocity);
        if queue.verdict == Verdict::Stop {
            return Err(Error::Stopped);
        }
    }
    Ok(())
}

/// The entry of the list where a run begins.
fn start(scale_factors: &[f64], epoch: Epoch) -> Result<usize> {
    if scale_factors.is_empty() {
        return Err(Error::Length);
    }
    if scale_factors.iter().any(|a| !a.is_finite()) {
        return Err(Error::NotFinite);
    }
    if scale_factors.windows(2).any(|pair| pair[0] >= pair[1]) {
        return Err(Error::Range);
    }
    let Epoch { position, velocity } = epoch;
    let first = scale_factors.iter().position(|&a| a == position).ok_or(Error::Range)?;
    let behind = first > 0 && velocity == half_step(scale_factors[first - 1], position);
    if velocity == position || behind { Ok(first) } else { Err(Error::Range) }
}
