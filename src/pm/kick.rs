//! Kicks: velocities changed by forces on meshes, u_i <- keep u_i + force F(x_i) + first psi1_i + second psi2_i.
//!
//! F(x_i) = sum_c W(x_c - x_i) F_c is read out of the three meshes as `read_out.rs` does; psi are displacements of the particles themselves, for
//! COLA (Tassev, Zaldarriaga & Eisenstein 2013, arXiv:1301.0322), whose velocities are those left over by Lagrangian perturbation theory. The four
//! coefficients are the stepper's: they carry all factors of time and all units.
//!
//! A kick is one pass over positions and velocities: no array of forces at particles is needed.

use core::sync::atomic::{AtomicU32, Ordering};

use super::columns::{Positions, load_components, store_components};
use super::deposit::deposit_scratch;
use super::frame::{Assignment, BLOCK, Frame, NOT_FINITE};
use super::gather::Meshes;
use super::region::Region;
use super::sort::{self, BATCH, Fourth, IN_ORDER, Sorter};
use super::tiles::Tiling;
use super::window::Window;
use crate::exec::Exec;
use crate::initial::particles::Components;
use crate::real::Real;
use crate::scratch::{Arena, Layout};
use crate::simd::Simd;
use crate::status::{Error, Result};

/// Coefficients of a kick: velocity <- `keep` velocity + `force` F + `first` psi1 + `second` psi2.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Kick {
    /// Of the velocity before.
    pub keep: f64,
    /// Of the force.
    pub force: f64,
    /// Of the first-order displacement.
    pub first: f64,
    /// Of the second-order displacement.
    pub second: f64,
}

/// Displacements of the particles by Lagrangian perturbation theory, one triple a particle.
#[derive(Clone, Copy)]
pub struct Lpt<'a, T> {
    /// First order.
    pub first: Positions<'a, T>,
    /// Second order, if there is one.
    pub second: Option<Positions<'a, T>>,
}

/// Scratch of [`kick`]: that of the deposit.
///
/// # Errors
/// As [`deposit_scratch`].
///
/// # Example
/// ```
/// use fixpair::mesh::{Brick, Space};
/// use fixpair::pm::Region;
///
/// let brick = Brick::whole(8, Space::Configuration)?;
/// let region = Region::from_brick(&brick)?;
/// use fixpair::pm::{Window, kick_scratch};
///
/// assert!(kick_scratch::<f32>(&region, 1 << 30, Window::CloudInCell)?.size < 41_000_000);
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn kick_scratch<T: Real>(region: &Region, particles: usize, window: Window) -> Result<Layout> {
    deposit_scratch::<T>(region, particles, window)
}

/// Kicks particles: u_i <- keep u_i + force F(x_i) + first psi1_i + second psi2_i, summed in `f64` and rounded once.
///
/// `velocity`: changed. `position`: as for the deposit. `forces`: the components of F on `region`, ghost planes filled (see
/// [`super::ghosts::copy_cells`]). `lpt`: needed where `first` or `second` is not 0.
///
/// # Errors
/// As [`super::deposit::deposit`]; `NotFinite` also for a coefficient, `Null` for displacements that a coefficient asks for and that are not
/// there. After `NotFinite` for a position, velocity, force or displacement and after `Outside` some velocities are kicked, some not.
///
/// The same bits for any number of threads. Cost on one core, `f32`, order 2: 18 ns a particle if neighbours in memory are neighbours in space,
/// 31 ns for a lattice displaced as far as clustering does, 50 ns in random order; order 3: 34, 51 and 80 ns.
///
/// # Example
/// ```
/// use fixpair::mesh::{Brick, Space};
/// use fixpair::pm::Region;
///
/// let brick = Brick::whole(8, Space::Configuration)?;
/// let region = Region::from_brick(&brick)?;
/// use fixpair::exec::Serial;
/// use fixpair::initial::particles::Components;
/// use fixpair::pm::{Assignment, Kick, Positions, Window, kick};
/// # #[repr(align(64))] struct Memory([u8; 1 << 16]);
/// # let mut memory = Memory([0; 1 << 16]);
/// # let scratch = &mut memory.0;
///
/// let (force, zero) = (vec![2.0; region.reals()], vec![0.0; region.reals()]);
/// let (x, mut v) = ([1.5, 1.0, 1.0], [1.0, 0.0, 0.0]);
/// let assignment = Assignment { box_size: 8.0, window: Window::CloudInCell, shift: 0.0 };
/// let step = Kick { keep: 1.0, force: 3.0, first: 0.0, second: 0.0 };
/// let (mut velocity, position) = (Components::triples(&mut v)?, Positions::triples(&x)?);
/// kick(&mut velocity, &position, [&force, &zero, &zero], &region, &assignment, &step, None, scratch, &Serial)?;
/// assert_eq!(v, [7.0, 0.0, 0.0]);
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn kick<T: Real>(
    velocity: &mut Components<'_, T>,
    position: &Positions<'_, T>,
    forces: [&[T]; 3],
    region: &Region,
    assignment: &Assignment,
    kick: &Kick,
    lpt: Option<&Lpt<'_, T>>,
    scratch: &mut [u8],
    exec: &dyn Exec,
) -> Result<()> {
    kick_with(Simd::detect(), velocity, position, forces, region, assignment, kick, lpt, scratch, exec)
}

pub(super) fn kick_with<T: Real>(
    simd: Simd,
    velocity: &mut Components<'_, T>,
    position: &Positions<'_, T>,
    forces: [&[T]; 3],
    region: &Region,
    assignment: &Assignment,
    kick: &Kick,
    lpt: Option<&Lpt<'_, T>>,
    scratch: &mut [u8],
    exec: &dyn Exec,
) -> Result<()> {
    let frame = Frame::new(region, assignment)?;
    let meshes = Meshes::new(forces, region, &frame, assignment.window)?;
    let particles = position.len();
    if velocity.len() != particles {
        return Err(Error::Length);
    }
    if !(kick.keep.is_finite() && kick.force.is_finite()) {
        return Err(Error::NotFinite);
    }
    let lpt = Terms::new(lpt, [kick.first, kick.second], particles)?;
    let tiling = Tiling::of(region, &frame);
    let mut arena = Arena::new(scratch, sort::layout::<T>(particles, tiling.len())?)?;
    let mut sorter = Sorter::new(&mut arena, particles, tiling.len())?;
    let velocity = &*velocity;
    let target = Target { velocity, kick, lpt, wrong: AtomicU32::new(0) };
    for first in (0..particles).step_by(BATCH) {
        let count = BATCH.min(particles - first);
        let changes = sorter.count(position, first, count, &frame, &tiling, simd, exec)?;
        // The sums of a particle do not depend on it.
        if changes < count / IN_ORDER {
            meshes.read_in_order(
                position,
                first,
                count,
                simd,
                exec,
                #[inline(always)]
                // SAFETY: the particles exist, and each is kicked by one thread.
                |begin, count, forces| unsafe { target.kick(first + begin, count, forces) },
            )?;
        } else {
            sorter.write(position, Fourth::One, first, count, &frame, simd, exec)?;
            meshes.read_sorted(&mut sorter, &tiling, simd, exec)?;
            sorter.unsort(
                count,
                simd,
                exec,
                #[inline(always)]
                // SAFETY: as above.
                |begin, count, forces| unsafe { target.kick(first + begin, count, forces) },
            )?;
        }
        sort::check(&target.wrong)?;
    }
    Ok(())
}

/// Velocities and what else changes them.
struct Target<'a, 'b, T> {
    velocity: &'a Components<'b, T>,
    kick: &'a Kick,
    lpt: Terms<'a, T>,
    /// What is wrong with any of them.
    wrong: AtomicU32,
}

impl<T: Real> Target<'_, '_, T> {
    /// Kicks a block of consecutive particles.
    ///
    /// # Safety
    /// The particles exist, `count` is at most [`BLOCK`], and no other thread touches their velocities now.
    #[inline(always)]
    unsafe fn kick(&self, first: usize, count: usize, forces: &[[T; BLOCK]; 3]) {
        let Kick { keep, force, .. } = *self.kick;
        let mut u = [[T::ZERO; BLOCK]; 3];
        // SAFETY: as the caller says.
        unsafe { load_components(self.velocity, first, count, &mut u) };
        let mut sum = [[0.0; BLOCK]; 3];
        for axis in 0..3 {
            for i in 0..BLOCK {
                sum[axis][i] = keep * u[axis][i].to_f64() + force * forces[axis][i].to_f64();
            }
        }
        // SAFETY: there are as many displacements as particles.
        unsafe { self.lpt.add(first, count, &mut sum) };
        let mut lost = 0;
        for axis in 0..3 {
            for i in 0..BLOCK {
                u[axis][i] = T::from_f64(sum[axis][i]);
                lost |= u32::from(!u[axis][i].is_finite() & (i < count));
            }
        }
        // SAFETY: as the caller says.
        unsafe { store_components(self.velocity, first, count, &u) };
        if lost != 0 {
            self.wrong.fetch_or(NOT_FINITE, Ordering::Relaxed);
        }
    }
}

/// Displacements that have a coefficient, and theirs.
pub(super) struct Terms<'a, T> {
    terms: [Option<(Positions<'a, T>, f64)>; 2],
}

impl<'a, T: Real> Terms<'a, T> {
    /// `NotFinite` for a coefficient, `Null` for one without displacements, `Length` unless there is one displacement a particle.
    pub(super) fn new(lpt: Option<&Lpt<'a, T>>, coefficients: [f64; 2], particles: usize) -> Result<Self> {
        let orders = [lpt.map(|lpt| lpt.first), lpt.and_then(|lpt| lpt.second)];
        let mut terms = [None; 2];
        for (order, (displacement, coefficient)) in orders.into_iter().zip(coefficients).enumerate() {
            if !coefficient.is_finite() {
                return Err(Error::NotFinite);
            }
            if displacement.is_some_and(|displacement| displacement.len() != particles) {
                return Err(Error::Length);
            }
            if coefficient != 0.0 {
                terms[order] = Some((displacement.ok_or(Error::Null)?, coefficient));
            }
        }
        Ok(Self { terms })
    }

    /// Adds coefficient times displacement to the sums of a block.
    ///
    /// # Safety
    /// `first + count` is at most the number of particles, and `count` at most [`BLOCK`].
    #[inline(always)]
    pub(super) unsafe fn add(&self, first: usize, count: usize, sum: &mut [[f64; BLOCK]; 3]) {
        let mut psi = [[T::ZERO; BLOCK]; 3];
        for (displacement, coefficient) in self.terms.iter().flatten() {
            // SAFETY: as the caller says.
            unsafe { displacement.load_all(first, count, 0, &mut psi) };
            for axis in 0..3 {
                for i in 0..BLOCK {
                    sum[axis][i] += coefficient * psi[axis][i].to_f64();
                }
            }
        }
    }
}
