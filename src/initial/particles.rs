//! Particles on the lattice, moved by a displacement field.
//!
//! Particle (x, y, z) of the local brick has its place q = (x, y, z) L/N, its number in the arrays ((x - x0) c_y + (y - y0)) c_z +
//! (z - z0) with the brick's counts c, whatever its strides, and its id ((x N) + y) N + z + `first_id`, the same in every
//! decomposition. Positions are in [0, L), in the unit of L; velocities in the unit of their factor.

use core::sync::atomic::{AtomicBool, Ordering};

use crate::exec::{Exec, Shared};
use crate::mesh::{Brick, Space};
use crate::real::Real;
use crate::status::{Error, Result};
use crate::walk::{Run, walk};

/// Three components for each particle, as one array of triples or as three arrays.
pub enum Components<'a, T> {
    /// x0 y0 z0 x1 y1 z1 ...: 3 N reals.
    Triples(&'a mut [T]),
    /// x0 x1 ..., y0 y1 ..., z0 z1 ...: N reals each.
    Separate([&'a mut [T]; 3]),
}

impl<T: Real> Components<'_, T> {
    /// `Length` unless there is room for exactly `particles`.
    ///
    /// # Errors
    /// See above.
    pub fn check_length(&self, particles: usize) -> Result<()> {
        let fits = match self {
            Self::Triples(triples) => Some(triples.len()) == particles.checked_mul(3),
            Self::Separate(arrays) => arrays.iter().all(|array| array.len() == particles),
        };
        if fits { Ok(()) } else { Err(Error::Length) }
    }

    /// One component, to be written by many chunks: the array, the offset of its first value, and the step to the next.
    fn component(&mut self, axis: usize) -> (Shared<'_, T>, usize, usize) {
        match self {
            Self::Triples(triples) => (Shared::new(triples), axis, 3),
            Self::Separate(arrays) => (Shared::new(arrays[axis]), 0, 1),
        }
    }
}

/// What [`displace`] does with one component of the two orders.
#[derive(Clone, Copy, Debug)]
pub struct Step {
    /// Side of the box.
    pub box_size: f64,
    /// Multiply the first-order displacement for the velocity: a H f1.
    pub first_velocity: f64,
    /// Multiply the second-order displacement for the velocity: a H f2.
    pub second_velocity: f64,
}

/// Sets one component of positions and velocities: x = q + psi1 + psi2 wrapped into [0, L), v = c1 psi1 + c2 psi2.
///
/// `psi1`, `psi2` (absent at first order): component `axis` of the displacements on `brick`, in the unit of the box. Both outputs
/// hold exactly as many particles as the brick cells.
///
/// # Errors
/// `Range` for an axis above 2 or a box that is not positive, `Brick`, `Length`; `NotFinite` if a displacement is NaN or infinite or
/// so large that the position is lost: outputs are then written but meaningless.
///
/// Cost: one pass over the displacements and the two outputs.
pub fn displace<T: Real>(
    position: &mut Components<'_, T>,
    velocity: &mut Components<'_, T>,
    psi1: &[T],
    psi2: Option<&[T]>,
    brick: &Brick,
    axis: usize,
    step: &Step,
    exec: &dyn Exec,
) -> Result<()> {
    brick.check_space(Space::Configuration)?;
    if axis > 2 || !(step.box_size > 0.0 && T::from_f64(step.box_size).is_finite()) {
        return Err(Error::Range);
    }
    if !(step.first_velocity.is_finite() && step.second_velocity.is_finite()) {
        return Err(Error::NotFinite);
    }
    let particles = brick.elements();
    position.check_length(particles)?;
    velocity.check_length(particles)?;
    let lost = AtomicBool::new(false);
    let (x, x_first, x_step) = position.component(axis);
    let (v, v_first, v_step) = velocity.component(axis);
    let write = |run: Run, psi1: &[T], psi2: Option<&[T]>| {
        let first = number(brick, run.index);
        // SAFETY: a run's particles are numbered consecutively, runs hold different particles, and `check_length` made room for
        // all of them; the two arrays are separate exclusive borrows.
        let (x, v) = unsafe {
            (
                x.part(x_first + first * x_step, (run.length - 1) * x_step + 1),
                v.part(v_first + first * v_step, (run.length - 1) * v_step + 1),
            )
        };
        let sound = move_run(run, brick.n(), axis, step, psi1, psi2, (x, x_step), (v, v_step));
        if !sound {
            lost.store(true, Ordering::Relaxed);
        }
    };
    match psi2 {
        Some(psi2) => {
            walk::<T, 0, 2>(exec, brick, [], [psi1, psi2], &|run, [], [one, two]| {
                write(run, one, Some(two))
            })?;
        }
        None => walk::<T, 0, 1>(exec, brick, [], [psi1], &|run, [], [one]| write(run, one, None))?,
    }
    if lost.load(Ordering::Relaxed) { Err(Error::NotFinite) } else { Ok(()) }
}

/// The number of a particle in the arrays.
fn number(brick: &Brick, index: [usize; 3]) -> usize {
    let (start, count) = (brick.start(), brick.count());
    ((index[0] - start[0]) * count[1] + index[1] - start[1]) * count[2] + index[2] - start[2]
}

/// Returns whether all positions are finite.
#[inline(always)]
fn move_run<T: Real>(
    run: Run,
    n: usize,
    axis: usize,
    step: &Step,
    psi1: &[T],
    psi2: Option<&[T]>,
    (x, x_step): (&mut [T], usize),
    (v, v_step): (&mut [T], usize),
) -> bool {
    let cell = step.box_size / n as f64;
    let along = if axis == 2 { 1.0 } else { 0.0 };
    let q = run.index[axis] as f64;
    let edge = T::from_f64(step.box_size);
    let mut sound = true;
    for i in 0..run.length {
        let one = psi1[i].to_f64();
        let two = psi2.map_or(0.0, |psi2| psi2[i].to_f64());
        let place = wrap((q + along * i as f64) * cell + (one + two), step.box_size);
        let speed = step.first_velocity * one + step.second_velocity * two;
        let place = T::from_f64(place);
        // Rounding to the mesh's type may reach the far edge, which is the near edge of the next box.
        let place = if place >= edge { T::ZERO } else { place };
        let speed = T::from_f64(speed);
        sound &= place >= T::ZERO && speed.is_finite();
        x[i * x_step] = place;
        v[i * v_step] = speed;
    }
    sound
}

/// x modulo L; NaN where x is not finite.
#[inline(always)]
fn wrap(x: f64, box_size: f64) -> f64 {
    if x >= 0.0 && x < box_size {
        return x;
    }
    let once = if x < 0.0 { x + box_size } else { x - box_size };
    if once >= 0.0 && once < box_size {
        return once;
    }
    let wrapped = x - box_size * libm::floor(x / box_size);
    // A tiny negative x rounds up to the edge itself.
    if wrapped >= box_size { 0.0 } else { wrapped }
}

/// Writes the ids of the brick's particles: ((x N) + y) N + z + `first_id`.
///
/// # Errors
/// `Brick` for a brick of Fourier space, `Length` unless there is one id a cell, `Overflow` if the last id exceeds 64 bits.
pub fn particle_ids(ids: &mut [u64], brick: &Brick, first_id: u64, exec: &dyn Exec) -> Result<()> {
    brick.check_space(Space::Configuration)?;
    if ids.len() != brick.elements() {
        return Err(Error::Length);
    }
    let n = brick.n() as u64;
    if first_id.checked_add(n * n * n).is_none() {
        return Err(Error::Overflow);
    }
    let [start, count] = [brick.start(), brick.count()];
    let plane = count[1] * count[2];
    crate::exec::for_each_piece(exec, ids, plane, &|x, piece| {
        for (at, id) in piece.iter_mut().enumerate() {
            let (y, z) = (start[1] + at / count[2], start[2] + at % count[2]);
            *id = (((start[0] + x) as u64 * n) + y as u64) * n + z as u64 + first_id;
        }
    })
}
