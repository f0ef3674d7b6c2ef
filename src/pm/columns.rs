//! Where particles lie in memory: columns of one real a particle, a fixed stride apart.

use core::marker::PhantomData;

use super::frame::BLOCK;
use super::sort::CHUNK;
use crate::exec::Exec;
use crate::initial::particles::Components;
use crate::real::Real;
use crate::status::{Error, Result};

/// Positions of particles, read only: coordinate a of particle i at `start[a] + i stride`. That covers triples, three separate
/// arrays, and a member of the caller's own particle struct.
#[derive(Clone, Copy)]
pub struct Positions<'a, T> {
    start: [*const T; 3],
    stride: usize,
    particles: usize,
    life: PhantomData<&'a [T]>,
}

// SAFETY: it stands for shared borrows of reals.
unsafe impl<T: Real> Sync for Positions<'_, T> {}
// SAFETY: as above.
unsafe impl<T: Real> Send for Positions<'_, T> {}

impl<'a, T: Real> Positions<'a, T> {
    /// x0 y0 z0 x1 y1 z1 ...
    ///
    /// # Errors
    /// `Length` if the array is not made of triples.
    ///
    /// # Example
    /// ```
    /// use fixpair::pm::Positions;
    ///
    /// assert_eq!(Positions::triples(&[1.0_f32, 2.0, 3.0, 4.0, 5.0, 6.0])?.len(), 2);
    /// # Ok::<(), fixpair::status::Error>(())
    /// ```
    pub fn triples(array: &'a [T]) -> Result<Self> {
        if !array.len().is_multiple_of(3) {
            return Err(Error::Length);
        }
        let first = array.as_ptr();
        let start = [first, first.wrapping_add(1), first.wrapping_add(2)];
        Ok(Self { start, stride: 3, particles: array.len() / 3, life: PhantomData })
    }

    /// x0 x1 ..., y0 y1 ..., z0 z1 ...
    ///
    /// # Errors
    /// `Length` if the arrays differ in length.
    ///
    /// # Example
    /// ```
    /// use fixpair::pm::Positions;
    ///
    /// assert_eq!(Positions::separate([&[1.0_f32, 4.0], &[2.0, 5.0], &[3.0, 6.0]])?.len(), 2);
    /// # Ok::<(), fixpair::status::Error>(())
    /// ```
    pub fn separate(arrays: [&'a [T]; 3]) -> Result<Self> {
        let particles = arrays[0].len();
        if arrays.iter().any(|array| array.len() != particles) {
            return Err(Error::Length);
        }
        Ok(Self { start: arrays.map(<[T]>::as_ptr), stride: 1, particles, life: PhantomData })
    }

    /// Any stride, in elements of `T`.
    ///
    /// # Safety
    /// For the life of the value, each `start[a] + i stride` with i < `particles` is an aligned element that nobody writes.
    ///
    /// # Example
    /// ```
    /// use fixpair::pm::Positions;
    ///
    /// let particles = [[1.0_f32, 2.0, 3.0, 0.5], [4.0, 5.0, 6.0, 0.5]]; // a host's struct: x, y, z, mass
    /// let first = particles.as_ptr().cast::<f32>();
    /// // SAFETY: there are so many particles, four floats apart, and they outlive the view.
    /// let position = unsafe { Positions::strided([first, first.wrapping_add(1), first.wrapping_add(2)], 4, 2) };
    /// assert_eq!(position.len(), 2);
    /// ```
    #[must_use]
    pub unsafe fn strided(start: [*const T; 3], stride: usize, particles: usize) -> Self {
        Self { start, stride, particles, life: PhantomData }
    }

    /// Particles.
    ///
    /// ```
    /// use fixpair::pm::Positions;
    ///
    /// assert_eq!(Positions::triples(&[0.0_f64; 9])?.len(), 3);
    /// # Ok::<(), fixpair::status::Error>(())
    /// ```
    #[must_use]
    pub const fn len(&self) -> usize {
        self.particles
    }

    /// No particles?
    ///
    /// ```
    /// use fixpair::pm::Positions;
    ///
    /// assert!(Positions::<f64>::triples(&[])?.is_empty());
    /// # Ok::<(), fixpair::status::Error>(())
    /// ```
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.particles == 0
    }

    /// The coordinates of one particle.
    ///
    /// # Safety
    /// `i` is below [`Positions::len`].
    #[inline(always)]
    pub(crate) unsafe fn get(&self, i: usize) -> [T; 3] {
        // SAFETY: the particle exists (caller).
        self.start.map(|start| unsafe { start.add(i * self.stride).read() })
    }

    /// Copies the coordinates of `count` consecutive particles to `to[axis][at ..]`.
    ///
    /// # Safety
    /// `first + count` is at most [`Positions::len`], and `at + count` at most `N`.
    #[inline(always)]
    pub(crate) unsafe fn load_all<const N: usize>(
        &self,
        first: usize,
        count: usize,
        at: usize,
        to: &mut [[T; N]; 3],
    ) {
        // SAFETY: as the caller says.
        unsafe { load_all(self.start, self.stride, first, count, at, to) }
    }
}

impl<'a, T: Real> From<&'a Components<'_, T>> for Positions<'a, T> {
    /// Reads what is elsewhere written.
    fn from(components: &'a Components<'_, T>) -> Self {
        let (start, stride) = components.parts();
        Self {
            start: start.map(<*mut T>::cast_const),
            stride,
            particles: components.len(),
            life: PhantomData,
        }
    }
}

/// Copies the components of `count` consecutive particles to the front of `to`.
///
/// # Safety
/// `first + count` is at most [`Components::len`], `count` at most `N`, and no other thread touches the particles now.
#[inline(always)]
pub(super) unsafe fn load_components<T: Real, const N: usize>(
    from: &Components<'_, T>,
    first: usize,
    count: usize,
    to: &mut [[T; N]; 3],
) {
    let (start, stride) = from.parts();
    // SAFETY: as the caller says.
    unsafe { load_all(start.map(<*mut T>::cast_const), stride, first, count, 0, to) }
}

/// Sets the components of `count` consecutive particles to the front of `from`.
///
/// # Safety
/// As [`load_components`].
#[inline(always)]
pub(super) unsafe fn store_components<T: Real, const N: usize>(
    to: &Components<'_, T>,
    first: usize,
    count: usize,
    from: &[[T; N]; 3],
) {
    let (start, stride) = to.parts();
    if are_triples(start.map(<*mut T>::cast_const), stride) && count == N {
        // SAFETY: the particles exist (caller), their components without a gap.
        let to = unsafe { &mut *start[0].add(3 * first).cast::<[[T; 3]; N]>() };
        for i in 0..N {
            for axis in 0..3 {
                to[i][axis] = from[axis][i];
            }
        }
    } else {
        for axis in 0..3 {
            // SAFETY: the particles exist (caller).
            let start = unsafe { start[axis].add(first * stride) };
            for (i, &value) in from[axis].iter().enumerate().take(count) {
                // SAFETY: as above.
                unsafe { start.add(i * stride).write(value) };
            }
        }
    }
}

/// x0 y0 z0 x1 y1 z1 ... ?
#[inline(always)]
fn are_triples<T>(start: [*const T; 3], stride: usize) -> bool {
    [0, 1, 2].map(|axis| start[0].wrapping_add(axis)) == start && stride == 3
}

/// Copies the components of `count` consecutive particles to `to[axis][at ..]`.
///
/// # Safety
/// The particles exist, nobody writes them now, and `at + count` is at most `N`.
#[inline(always)]
unsafe fn load_all<T: Real, const N: usize>(
    start: [*const T; 3],
    stride: usize,
    first: usize,
    count: usize,
    at: usize,
    to: &mut [[T; N]; 3],
) {
    if are_triples(start, stride) && count == N {
        // SAFETY: the particles exist (caller), their components without a gap.
        let from = unsafe { &*start[0].add(3 * first).cast::<[[T; 3]; N]>() };
        for i in 0..N {
            for axis in 0..3 {
                to[axis][i] = from[i][axis];
            }
        }
    } else {
        for axis in 0..3 {
            // SAFETY: the particles exist (caller).
            let start = unsafe { start[axis].add(first * stride) };
            for (i, to) in to[axis].iter_mut().skip(at).take(count).enumerate() {
                // SAFETY: as above.
                *to = unsafe { start.add(i * stride).read() };
            }
        }
    }
}

/// Copies the components of all particles, between any layouts.
///
/// # Errors
/// `Length` unless there are as many particles in both, `Hook`.
///
/// Cost: one pass over both.
///
/// # Example
/// ```
/// use fixpair::exec::Serial;
/// use fixpair::initial::particles::Components;
/// use fixpair::pm::{Positions, copy_components};
///
/// let (from, mut to) = ([1.0, 2.0, 3.0, 4.0, 5.0, 6.0], [[0.0; 2]; 3]);
/// let [x, y, z] = &mut to;
/// copy_components(&mut Components::separate([x, y, z])?, &Positions::triples(&from)?, &Serial)?;
/// assert_eq!(to, [[1.0, 4.0], [2.0, 5.0], [3.0, 6.0]]);
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn copy_components<T: Real>(
    to: &mut Components<'_, T>,
    from: &Positions<'_, T>,
    exec: &dyn Exec,
) -> Result<()> {
    let particles = from.len();
    if to.len() != particles {
        return Err(Error::Length);
    }
    let to = &*to;
    exec.parallel_for(particles.div_ceil(CHUNK), &|chunk| {
        let end = particles.min((chunk + 1) * CHUNK);
        let mut block = [[T::ZERO; BLOCK]; 3];
        for first in (chunk * CHUNK..end).step_by(BLOCK) {
            let count = BLOCK.min(end - first);
            // SAFETY: the particles exist, and blocks are each copied by one thread.
            unsafe {
                from.load_all(first, count, 0, &mut block);
                store_components(to, first, count, &block);
            }
        }
    })
}

/// One real a particle, read only: weights.
#[derive(Clone, Copy)]
pub struct Column<'a, T> {
    start: *const T,
    stride: usize,
    length: usize,
    life: PhantomData<&'a [T]>,
}

// SAFETY: it stands for a shared borrow of reals.
unsafe impl<T: Real> Sync for Column<'_, T> {}
// SAFETY: as above.
unsafe impl<T: Real> Send for Column<'_, T> {}

impl<'a, T: Real> Column<'a, T> {
    /// An array.
    ///
    /// ```
    /// use fixpair::pm::Column;
    ///
    /// assert_eq!(Column::new(&[1.0_f32, 0.5]).len(), 2); // weights, one a particle
    /// ```
    #[must_use]
    pub const fn new(array: &'a [T]) -> Self {
        Self { start: array.as_ptr(), stride: 1, length: array.len(), life: PhantomData }
    }

    /// Any stride, in elements of `T`.
    ///
    /// # Safety
    /// For the life of the value, each `start + i stride` with i < `length` is an aligned element that nobody writes.
    ///
    /// # Example
    /// ```
    /// use fixpair::pm::Column;
    ///
    /// let particles = [[1.0_f32, 2.0, 3.0, 0.5], [4.0, 5.0, 6.0, 0.5]]; // a host's struct: x, y, z, mass
    /// // SAFETY: there are so many particles, four floats apart, and they outlive the view.
    /// let mass = unsafe { Column::strided(particles.as_ptr().cast::<f32>().wrapping_add(3), 4, 2) };
    /// assert_eq!(mass.len(), 2);
    /// ```
    #[must_use]
    pub unsafe fn strided(start: *const T, stride: usize, length: usize) -> Self {
        Self { start, stride, length, life: PhantomData }
    }

    /// Particles.
    ///
    /// ```
    /// use fixpair::pm::Column;
    ///
    /// assert_eq!(Column::new(&[1.0_f32, 0.5]).len(), 2);
    /// ```
    #[must_use]
    pub const fn len(&self) -> usize {
        self.length
    }

    /// No particles?
    ///
    /// ```
    /// use fixpair::pm::Column;
    ///
    /// assert!(Column::<f32>::new(&[]).is_empty());
    /// ```
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.length == 0
    }

    /// Copies `count` consecutive elements to the front of `to`.
    ///
    /// # Safety
    /// `first + count` is at most [`Column::len`], and `count` at most the length of `to`.
    #[inline(always)]
    pub(super) unsafe fn load(&self, first: usize, count: usize, to: &mut [T]) {
        for i in 0..count {
            // SAFETY: the elements exist, and `to` is long enough (caller).
            unsafe { *to.get_unchecked_mut(i) = self.start.add((first + i) * self.stride).read() };
        }
    }
}

/// One real a particle, written: what a mesh is worth at each of them.
pub struct ColumnMut<'a, T> {
    start: *mut T,
    stride: usize,
    length: usize,
    life: PhantomData<&'a mut [T]>,
}

// SAFETY: it stands for an exclusive borrow of reals; kernels write each element from one chunk only.
unsafe impl<T: Real> Sync for ColumnMut<'_, T> {}
// SAFETY: as above.
unsafe impl<T: Real> Send for ColumnMut<'_, T> {}

impl<'a, T: Real> ColumnMut<'a, T> {
    /// An array.
    ///
    /// ```
    /// use fixpair::pm::ColumnMut;
    ///
    /// assert_eq!(ColumnMut::new(&mut [0.0_f32; 2]).len(), 2);
    /// ```
    #[must_use]
    pub const fn new(array: &'a mut [T]) -> Self {
        Self { start: array.as_mut_ptr(), stride: 1, length: array.len(), life: PhantomData }
    }

    /// Any stride, in elements of `T`.
    ///
    /// # Safety
    /// For the life of the value, each `start + i stride` with i < `length` is an aligned element that only this value touches, and no two
    /// of them are the same.
    ///
    /// # Example
    /// ```
    /// use fixpair::pm::ColumnMut;
    ///
    /// let mut particles = [[0.0_f32; 4]; 2]; // a host's struct: x, y, z, density
    /// // SAFETY: there are so many particles, four floats apart, and nothing else touches them.
    /// let density = unsafe { ColumnMut::strided(particles.as_mut_ptr().cast::<f32>().wrapping_add(3), 4, 2) };
    /// assert_eq!(density.len(), 2);
    /// ```
    #[must_use]
    pub unsafe fn strided(start: *mut T, stride: usize, length: usize) -> Self {
        Self { start, stride, length, life: PhantomData }
    }

    /// Particles.
    ///
    /// ```
    /// use fixpair::pm::ColumnMut;
    ///
    /// assert_eq!(ColumnMut::new(&mut [1.0_f32, 0.5]).len(), 2);
    /// ```
    #[must_use]
    pub const fn len(&self) -> usize {
        self.length
    }

    /// No particles?
    ///
    /// ```
    /// use fixpair::pm::ColumnMut;
    ///
    /// assert!(ColumnMut::<f32>::new(&mut []).is_empty());
    /// ```
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.length == 0
    }

    /// Writes consecutive elements.
    ///
    /// # Safety
    /// They exist, and no other thread touches them now.
    #[inline(always)]
    pub(super) unsafe fn store(&self, first: usize, from: &[T]) {
        for (i, &value) in from.iter().enumerate() {
            // SAFETY: the element belongs to this value (constructors), and to this thread (caller).
            unsafe { self.start.add((first + i) * self.stride).write(value) };
        }
    }
}
