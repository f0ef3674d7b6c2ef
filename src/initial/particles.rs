//! Particles on the lattice, moved by a displacement field.
//!
//! Particle (x, y, z) of the local brick has its place q = (x, y, z) L/N, its number in the arrays ((x - x0) c_y + (y - y0)) c_z +
//! (z - z0) with the brick's counts c, whatever its strides, and its id ((x N) + y) N + z + `first_id`, the same in every
//! decomposition. Positions are in [0, L), in the unit of L; velocities in the unit of their factor.

use core::marker::PhantomData;
use core::sync::atomic::{AtomicBool, Ordering};

use crate::exec::Exec;
use crate::mesh::{Brick, Space};
use crate::real::Real;
use crate::simd::Simd;
use crate::status::{Error, Result};
use crate::walk::{Run, walk};
use crate::within::Within;

/// Where three components of each particle lie: component a of particle i at `start[a] + i stride`. That covers triples, three
/// separate arrays, and a member of the caller's own particle struct.
pub struct Components<'a, T> {
    start: [*mut T; 3],
    stride: usize,
    particles: usize,
    life: PhantomData<&'a mut [T]>,
}

// SAFETY: it stands for exclusive borrows of reals; kernels write each element from one chunk only.
unsafe impl<T: Real> Sync for Components<'_, T> {}

impl<'a, T: Real> Components<'a, T> {
    /// x0 y0 z0 x1 y1 z1 ...
    ///
    /// # Errors
    /// `Length` if the array is not made of triples.
    ///
    /// # Example
    /// ```
    /// use fixpair::initial::particles::Components;
    ///
    /// assert_eq!(Components::triples(&mut [0.0_f32; 6])?.len(), 2);
    /// # Ok::<(), fixpair::status::Error>(())
    /// ```
    pub fn triples(array: &'a mut [T]) -> Result<Self> {
        if !array.len().is_multiple_of(3) {
            return Err(Error::Length);
        }
        let (particles, first) = (array.len() / 3, array.as_mut_ptr());
        let start = [first, first.wrapping_add(1), first.wrapping_add(2)];
        Ok(Self { start, stride: 3, particles, life: PhantomData })
    }

    /// x0 x1 ..., y0 y1 ..., z0 z1 ...
    ///
    /// # Errors
    /// `Length` if the arrays differ in length.
    ///
    /// # Example
    /// ```
    /// use fixpair::initial::particles::Components;
    ///
    /// let (mut x, mut y, mut z) = ([0.0_f32; 2], [0.0; 2], [0.0; 2]);
    /// assert_eq!(Components::separate([&mut x, &mut y, &mut z])?.len(), 2);
    /// # Ok::<(), fixpair::status::Error>(())
    /// ```
    pub fn separate(arrays: [&'a mut [T]; 3]) -> Result<Self> {
        let particles = arrays[0].len();
        if arrays.iter().any(|array| array.len() != particles) {
            return Err(Error::Length);
        }
        Ok(Self { start: arrays.map(<[T]>::as_mut_ptr), stride: 1, particles, life: PhantomData })
    }

    /// Any stride, in elements of `T`.
    ///
    /// # Safety
    /// For the life of the value, each `start[a] + i stride` with i < `particles` is an aligned element that only this value touches, and no
    /// two of them are the same.
    ///
    /// # Example
    /// ```
    /// use fixpair::initial::particles::Components;
    ///
    /// let mut particles = [[0.0_f32; 4]; 2]; // a host's struct: x, y, z, mass
    /// let first = particles.as_mut_ptr().cast::<f32>();
    /// // SAFETY: there are so many particles, four floats apart, and nothing else touches them.
    /// let position = unsafe { Components::strided([first, first.wrapping_add(1), first.wrapping_add(2)], 4, 2) };
    /// assert_eq!(position.len(), 2);
    /// ```
    #[must_use]
    pub unsafe fn strided(start: [*mut T; 3], stride: usize, particles: usize) -> Self {
        Self { start, stride, particles, life: PhantomData }
    }

    /// Particles.
    ///
    /// ```
    /// use fixpair::initial::particles::Components;
    ///
    /// assert_eq!(Components::triples(&mut [0.0_f64; 9])?.len(), 3);
    /// # Ok::<(), fixpair::status::Error>(())
    /// ```
    #[must_use]
    pub const fn len(&self) -> usize {
        self.particles
    }

    /// No particles?
    ///
    /// ```
    /// use fixpair::initial::particles::Components;
    ///
    /// assert!(Components::<f64>::triples(&mut [])?.is_empty());
    /// # Ok::<(), fixpair::status::Error>(())
    /// ```
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.particles == 0
    }

    /// The same elements, lent on: for a call that takes the value while the caller keeps it.
    ///
    /// ```
    /// use fixpair::initial::particles::Components;
    ///
    /// let mut array = [0.0_f64; 3];
    /// let mut components = Components::triples(&mut array)?;
    /// assert_eq!(components.reborrow().len(), components.len()); // one call after the other
    /// # Ok::<(), fixpair::status::Error>(())
    /// ```
    #[must_use]
    pub const fn reborrow(&mut self) -> Components<'_, T> {
        Components { start: self.start, stride: self.stride, particles: self.particles, life: PhantomData }
    }

    /// First elements, and the stride.
    #[inline(always)]
    pub(crate) const fn parts(&self) -> ([*mut T; 3], usize) {
        (self.start, self.stride)
    }

    pub(super) fn check_length(&self, particles: usize) -> Result<()> {
        if self.particles == particles { Ok(()) } else { Err(Error::Length) }
    }

    /// Writes one component of consecutive particles.
    ///
    /// # Safety
    /// The particles exist, and no other thread touches them now.
    #[inline(always)]
    unsafe fn write(&self, axis: usize, first: usize, values: &[T]) {
        let stride = self.stride;
        let Some(start) = self.start.get(axis) else { return };
        // SAFETY: the element belongs to this value (constructors).
        let start = unsafe { start.add(first * stride) };
        for (i, &value) in values.iter().enumerate() {
            // SAFETY: as above, and to the calling thread alone (caller).
            unsafe { start.add(i * stride).write(value) }
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
/// `NotFinite` for the step, `Range` for an axis above 2 or a box that is not positive, `Brick`, `Length`; `NotFinite` also if a
/// displacement is NaN or infinite or so large that the position is lost: outputs are then written but meaningless.
///
/// Cost: one pass over the displacements and the two outputs.
///
/// # Example
/// ```
/// use fixpair::exec::Serial;
/// use fixpair::initial::particles::{Components, Step, displace};
/// use fixpair::mesh::{Brick, Space};
///
/// let cells = Brick::whole(2, Space::Configuration)?;
/// let (psi, mut x, mut v) = (vec![0.25; cells.reals()], [0.0; 24], [0.0; 24]);
/// let step = Step { box_size: 2.0, first_velocity: 10.0, second_velocity: 0.0 };
/// let (mut position, mut velocity) = (Components::triples(&mut x)?, Components::triples(&mut v)?);
/// displace(&mut position, &mut velocity, &psi, None, &cells, 0, &step, &Serial)?; // along x
/// assert_eq!((x[0], x[12], v[0]), (0.25, 1.25, 2.5));
/// # Ok::<(), fixpair::status::Error>(())
/// ```
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
    let Step { box_size, first_velocity, second_velocity } = *step;
    if [box_size, first_velocity, second_velocity].iter().any(|x| !x.is_finite()) {
        return Err(Error::NotFinite);
    }
    // In the particles' type too.
    let edge = T::from_f64(box_size);
    if axis > 2 || !(edge > T::ZERO && edge.is_finite()) {
        return Err(Error::Range);
    }
    let particles = brick.elements();
    position.check_length(particles)?;
    velocity.check_length(particles)?;
    let lost = AtomicBool::new(false);
    let simd = Simd::detect();
    let (position, velocity) = (&*position, &*velocity);
    let write = |run: Run, psi1: &[T], psi2: Option<&[T]>| {
        let first = number(brick, run.index);
        let moved = Moved { run, n: brick.n(), axis, step, psi1, psi2 };
        let put = |i: usize, place: &[T], speed: &[T]| {
            // SAFETY: a run's particles are numbered consecutively and inside the checked length, and runs hold different particles.
            unsafe {
                position.write(axis, first + i, place);
                velocity.write(axis, first + i, speed);
            }
        };
        let sound = simd.vectorise(
            #[inline(always)]
            || moved.each(put),
        );
        if !sound {
            lost.store(true, Ordering::Relaxed);
        }
    };
    match psi2 {
        Some(psi2) => walk::<T, 0, 2>(exec, brick, [], [psi1, psi2], &|run, [], [one, two]| {
            write(run, one, Some(two));
        })?,
        None => walk::<T, 0, 1>(exec, brick, [], [psi1], &|run, [], [one]| write(run, one, None))?,
    }
    if lost.load(Ordering::Relaxed) { Err(Error::NotFinite) } else { Ok(()) }
}

/// The number of a particle in the arrays.
fn number(brick: &Brick, index: [usize; 3]) -> usize {
    let (start, count) = (brick.start(), brick.count());
    ((index[0] - start[0]) * count[1] + index[1] - start[1]) * count[2] + index[2] - start[2]
}

/// Particles moved at a time: enough for full vectors, few enough to stay in the first cache.
const BLOCK: usize = 64;

/// One run of particles on one axis.
struct Moved<'a, T> {
    run: Run,
    n: usize,
    axis: usize,
    step: &'a Step,
    psi1: &'a [T],
    psi2: Option<&'a [T]>,
}

impl<T: Real> Moved<'_, T> {
    /// Hands positions and velocities to `put`, block by block; returns whether all of them are finite.
    #[inline(always)]
    fn each(&self, mut put: impl FnMut(usize, &[T], &[T])) -> bool {
        let mut sound = true;
        let (mut one, mut two) = ([0.0; BLOCK], [0.0; BLOCK]);
        let (mut place, mut speed) = ([T::ZERO; BLOCK], [T::ZERO; BLOCK]);
        for (block, psi1) in self.psi1.chunks(BLOCK).enumerate() {
            let first = block * BLOCK;
            load(&mut one, psi1);
            if let Some(psi2) = self.psi2 {
                load(&mut two, psi2.part(first..first + psi1.len()));
            }
            sound &= self.block(first, &one, &two, &mut place, &mut speed);
            put(first, &place[..psi1.len()], &speed[..psi1.len()]);
        }
        sound
    }

    /// Loops over whole blocks without branches, so that the compiler makes vectors of them.
    #[inline(always)]
    fn block(
        &self,
        first: usize,
        one: &[f64; BLOCK],
        two: &[f64; BLOCK],
        place: &mut [T; BLOCK],
        speed: &mut [T; BLOCK],
    ) -> bool {
        let box_size = self.step.box_size;
        let cell = box_size / self.n as f64;
        let along = if self.axis == 2 { 1.0 } else { 0.0 };
        let q = self.run.index.at(self.axis) as f64 + along * first as f64;
        let edge = T::from_f64(box_size);
        let mut x = [0.0; BLOCK];
        let mut outside = 0;
        for i in 0..BLOCK {
            let unwrapped = (q + along * f64::from(i as i32)) * cell + (one[i] + two[i]);
            x[i] = wrap_once(unwrapped, box_size);
            outside += u64::from(!(x[i] >= 0.0 && x[i] < box_size));
        }
        if outside > 0 {
            x.iter_mut().for_each(|x| *x = wrap(*x, box_size));
        }
        let mut lost = 0;
        for i in 0..BLOCK {
            // Rounding to the mesh's type may reach the far edge, which is the near edge of the next box.
            let rounded = T::from_f64(x[i]);
            place[i] = if rounded >= edge { T::ZERO } else { rounded };
            speed[i] = T::from_f64(self.step.first_velocity * one[i] + self.step.second_velocity * two[i]);
            lost += u64::from(!(place[i] >= T::ZERO && speed[i].is_finite()));
        }
        lost == 0
    }
}

#[inline(always)]
fn load<T: Real>(block: &mut [f64; BLOCK], values: &[T]) {
    for (to, from) in block.iter_mut().zip(values) {
        *to = from.to_f64();
    }
}

/// x modulo L where x lies in the box or the ones beside it.
#[inline(always)]
pub(crate) fn wrap_once(x: f64, box_size: f64) -> f64 {
    let x = if x < 0.0 { x + box_size } else { x };
    if x >= box_size { x - box_size } else { x }
}

/// Boxes from home beyond which a position has too few digits left to mean anything.
const FARTHEST: f64 = 1e9;

/// x modulo L; NaN where x is not finite or so far away that its place in the box is lost.
pub(crate) fn wrap(x: f64, box_size: f64) -> f64 {
    let once = wrap_once(x, box_size);
    if once >= 0.0 && once < box_size {
        return once;
    }
    if libm::fabs(x) > FARTHEST * box_size {
        return f64::NAN;
    }
    // The remainder is exact; a tiny negative one rounds up to the edge itself.
    let rest = crate::math::fmod(x, box_size);
    let wrapped = if rest < 0.0 { rest + box_size } else { rest };
    if wrapped >= box_size { 0.0 } else { wrapped }
}

/// Writes the ids of the brick's particles: ((x N) + y) N + z + `first_id`.
///
/// # Errors
/// `Brick` for a brick of Fourier space, `Length` unless there is one id a cell, `Overflow` if the last id exceeds 64 bits.
///
/// # Example
/// ```
/// use fixpair::exec::Serial;
/// use fixpair::initial::particles::particle_ids;
/// use fixpair::mesh::{Brick, Space};
///
/// let mut ids = [0; 512];
/// particle_ids(&mut ids, &Brick::whole(8, Space::Configuration)?, 1, &Serial)?; // Gadget's begin at 1
/// assert_eq!((ids[0], ids[511]), (1, 512));
/// # Ok::<(), fixpair::status::Error>(())
/// ```
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
            let row = at.checked_div(count[2]).unwrap_or(0);
            let (y, z) = (start[1] + row, start[2] + at - row * count[2]);
            *id = (((start[0] + x) as u64 * n) + y as u64) * n + z as u64 + first_id;
        }
    })
}
