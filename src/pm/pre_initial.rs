//! Initial conditions for particles that do not begin on the lattice of the mesh: a glass, a body-centred lattice, another resolution.
//!
//! Their pre-initial positions q sample displacements that live on the mesh, by cloud in cell: x = q + Psi(q). The read-out
//! multiplies the modes of the displacement by sinc^2(k_a H/2) on each axis, H = L/n: at half the Nyquist frequency along an axis by 0.81. A mesh of
//! twice the side makes that 0.95.

use core::sync::atomic::{AtomicBool, Ordering};

use super::columns::{ColumnMut, Positions, load_components, store_components};
use super::frame::{Assignment, BLOCK};
use super::read_out::{read_out, read_out_scratch};
use super::region::Region;
use super::sort::CHUNK;
use super::window::Window;
use crate::exec::Exec;
use crate::fft::Fft3;
use crate::initial::conditions::{InitialConditions, Parts, displaced, initial_conditions_scratch};
use crate::initial::particles::{Components, Step, wrap};
use crate::real::Real;
use crate::scratch::Layout;
use crate::status::{Error, Result};

/// Scratch of [`initial_conditions_at`]: that of [`initial_conditions`](crate::initial::conditions::initial_conditions), and that of the read-out.
///
/// # Errors
/// `Overflow`; `Brick` for a mesh that is not whole.
///
/// # Example
/// ```
/// use fixpair::cosmology::{Convention, Cosmology, EisensteinHu, Linear, Wiggles};
/// use fixpair::initial::conditions::{InitialConditions, Order};
/// use fixpair::initial::{png::Local, shape::Shape};
/// use fixpair::noise::{Amplitude, Realisation};
///
/// let cosmology = Cosmology::goliat();
/// let fit = EisensteinHu::new(&cosmology, Wiggles::With)?;
/// let conditions = InitialConditions {
///     realisation: Realisation { amplitude: Amplitude::Fixed, ..Realisation::new(1) },
///     linear: Linear::from_eisenstein_hu(fit, 0.96, 1.0)?.with_sigma8(0.8)?,
///     cosmology,
///     redshift: 32.0,
///     box_size: 1000.0,
///     local: Local { f_nl: 100.0, g_nl: 0.0 },
///     shape: Shape::Local.rows(),
///     species: None,
///     convention: Convention::Cmb,
///     order: Order::Second,
/// };
/// # use fixpair::{exec::Serial, fft::{Tables, Transform}, mesh::{Brick, Space}};
/// # #[repr(align(64))] struct Memory([u8; 1 << 16]);
/// # let (mut tables, mut work) = (Memory([0; 1 << 16]), Memory([0; 1 << 16]));
/// # let tables = Tables::<f64>::new(8, &mut tables.0)?;
/// # let mut fft = Transform::new(&tables, Brick::whole(8, Space::Configuration)?, &mut work.0, &Serial)?;
/// use fixpair::pm::initial_conditions_at_scratch;
///
/// assert!(initial_conditions_at_scratch(conditions.parts(), 100, &fft, None)?.size > 0);
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn initial_conditions_at_scratch<T: Real>(
    parts: Parts,
    particles: usize,
    fft: &dyn Fft3<T>,
    fine: Option<&(dyn Fft3<T> + '_)>,
) -> Result<Layout> {
    let region = whole(fft)?;
    let fields = initial_conditions_scratch(parts, fft, fine)?;
    fields.and::<u8>(read_out_scratch::<T>(&region, particles, Window::CloudInCell)?.size)
}

/// Positions and velocities of particles that begin at `pre_initial`: as
/// [`initial_conditions`](crate::initial::conditions::initial_conditions), but displacements are read out by cloud in cell where each particle is.
///
/// `position`, `velocity`: as many as `pre_initial`, in its order. `pre_initial`: in Mpc/h, within 1e9 boxes of the box, taken periodically. `fft`:
/// the transform of a whole mesh of any side.
///
/// # Errors
/// As `initial_conditions`; `Brick` also for a mesh that is not whole: on slabs a host reads displacements out itself. After
/// `NotFinite` for a position outputs are undefined.
///
/// The same bits for any number of threads. Cost: that of `initial_conditions`, and three or six read-outs.
///
/// # Example
/// ```
/// use fixpair::cosmology::{Convention, Cosmology, EisensteinHu, Linear, Wiggles};
/// use fixpair::initial::conditions::{InitialConditions, Order};
/// use fixpair::initial::{png::Local, shape::Shape};
/// use fixpair::noise::{Amplitude, Realisation};
///
/// let cosmology = Cosmology::goliat();
/// let fit = EisensteinHu::new(&cosmology, Wiggles::With)?;
/// let conditions = InitialConditions {
///     realisation: Realisation { amplitude: Amplitude::Fixed, ..Realisation::new(1) },
///     linear: Linear::from_eisenstein_hu(fit, 0.96, 1.0)?.with_sigma8(0.8)?,
///     cosmology,
///     redshift: 32.0,
///     box_size: 1000.0,
///     local: Local { f_nl: 100.0, g_nl: 0.0 },
///     shape: Shape::Local.rows(),
///     species: None,
///     convention: Convention::Cmb,
///     order: Order::Second,
/// };
/// # use fixpair::{exec::Serial, fft::{Tables, Transform}, mesh::{Brick, Space}};
/// # #[repr(align(64))] struct Memory([u8; 1 << 16]);
/// # let (mut tables, mut work) = (Memory([0; 1 << 16]), Memory([0; 1 << 16]));
/// # let tables = Tables::<f64>::new(8, &mut tables.0)?;
/// # let mut fft = Transform::new(&tables, Brick::whole(8, Space::Configuration)?, &mut work.0, &Serial)?;
/// use fixpair::initial::particles::Components;
/// use fixpair::pm::{Positions, initial_conditions_at};
/// # let mut memory = Memory([0; 1 << 16]);
/// # let scratch = &mut memory.0;
///
/// let (glass, mut x, mut v) = ([500.0, 500.0, 500.0], [0.0; 3], [0.0; 3]); // one particle of a glass
/// let (mut position, mut velocity) = (Components::triples(&mut x)?, Components::triples(&mut v)?);
/// let from = Positions::triples(&glass)?;
/// initial_conditions_at(&mut position, &mut velocity, &from, &conditions, &mut fft, None, scratch, &Serial)?;
/// assert!(x != glass && (x[0] - 500.0).abs() < 5.0);
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn initial_conditions_at<T: Real>(
    position: &mut Components<'_, T>,
    velocity: &mut Components<'_, T>,
    pre_initial: &Positions<'_, T>,
    conditions: &InitialConditions<'_>,
    fft: &mut dyn Fft3<T>,
    fine: Option<&mut (dyn Fft3<T> + '_)>,
    scratch: &mut [u8],
    exec: &dyn Exec,
) -> Result<()> {
    let region = whole(fft)?;
    let particles = pre_initial.len();
    if position.len() != particles || velocity.len() != particles {
        return Err(Error::Length);
    }
    let start = conditions.start()?;
    let step = start.1.step();
    let edge = T::from_f64(step.box_size);
    if !(edge > T::ZERO && edge.is_finite()) {
        return Err(Error::Range);
    }
    let layout = initial_conditions_scratch(conditions.parts(), fft, fine.as_deref())?;
    let needs = read_out_scratch::<T>(&region, particles, Window::CloudInCell)?;
    let (fields, own) = scratch.split_at_mut_checked(layout.size).ok_or(Error::Scratch)?;
    if own.len() < needs.size {
        return Err(Error::Scratch);
    }
    let assignment = Assignment { box_size: step.box_size, window: Window::CloudInCell, shift: 0.0 };
    // Until all axes are there, positions hold the first field and velocities the second.
    let has_second = conditions.has_second_field();
    let mut place = |axis: usize, first: &[T], second: Option<&[T]>| {
        let mut read = |to: &mut Components<'_, T>, field: &[T]| {
            let (start, stride) = to.parts();
            let start = *start.get(axis).ok_or(Error::Range)?;
            // SAFETY: one component of what `to` stands for, borrowed for as long.
            let mut column = unsafe { ColumnMut::strided(start, stride, to.len()) };
            read_out(&mut column, field, &region, pre_initial, &assignment, own, exec)
        };
        read(position, first)?;
        second.map_or(Ok(()), |second| read(velocity, second))
    };
    displaced(conditions, &start, fft, fine, fields, &mut place, exec)?;
    move_from(position, velocity, pre_initial, has_second, &step, exec)
}

/// x = q + first + second, wrapped, and v = c1 first + c2 second, where `position` holds the first field and `velocity` the second.
fn move_from<T: Real>(
    position: &mut Components<'_, T>,
    velocity: &mut Components<'_, T>,
    pre_initial: &Positions<'_, T>,
    has_second: bool,
    step: &Step,
    exec: &dyn Exec,
) -> Result<()> {
    let Step { box_size, first_velocity, second_velocity } = *step;
    let edge = T::from_f64(box_size);
    let particles = pre_initial.len();
    let (position, velocity) = (&*position, &*velocity);
    let lost = AtomicBool::new(false);
    exec.parallel_for(particles.div_ceil(CHUNK), &|chunk| {
        let end = particles.min((chunk + 1) * CHUNK);
        let [mut q, mut x, mut v] = [[[T::ZERO; BLOCK]; 3]; 3];
        let mut sound = true;
        for from in (chunk * CHUNK..end).step_by(BLOCK) {
            let count = BLOCK.min(end - from);
            // SAFETY: the particles exist, and blocks are each moved by one thread.
            unsafe {
                pre_initial.load_all(from, count, 0, &mut q);
                load_components(position, from, count, &mut x);
                if has_second {
                    load_components(velocity, from, count, &mut v);
                }
            }
            for axis in 0..3 {
                for i in 0..count {
                    let (first, second) = (x[axis][i].to_f64(), v[axis][i].to_f64());
                    let place = T::from_f64(wrap(q[axis][i].to_f64() + (first + second), box_size));
                    // Rounding may reach the far edge, which is the near edge of the next box.
                    x[axis][i] = if place >= edge { T::ZERO } else { place };
                    v[axis][i] = T::from_f64(first_velocity * first + second_velocity * second);
                    sound &= place >= T::ZERO && v[axis][i].is_finite();
                }
            }
            // SAFETY: as above.
            unsafe {
                store_components(position, from, count, &x);
                store_components(velocity, from, count, &v);
            }
            v = [[T::ZERO; BLOCK]; 3];
        }
        if !sound {
            lost.store(true, Ordering::Relaxed);
        }
    })?;
    if lost.into_inner() { Err(Error::NotFinite) } else { Ok(()) }
}

/// The region of a whole mesh.
fn whole<T: Real>(fft: &dyn Fft3<T>) -> Result<Region> {
    let cells = fft.configuration();
    if cells.is_whole() { Region::from_brick(cells) } else { Err(Error::Brick) }
}
