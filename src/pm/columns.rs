//! Where particles lie in memory: columns of one real a particle, a fixed stride apart.

use core::marker::PhantomData;

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
    #[must_use]
    pub unsafe fn strided(start: [*const T; 3], stride: usize, particles: usize) -> Self {
        Self { start, stride, particles, life: PhantomData }
    }

    /// Particles.
    #[must_use]
    pub const fn len(&self) -> usize {
        self.particles
    }

    /// No particles?
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
        let triples =
            [0, 1, 2].map(|axis| self.start[0].wrapping_add(axis)) == self.start && self.stride == 3;
        if triples && count == N {
            // SAFETY: the particles exist (caller), their coordinates without a gap.
            let from = unsafe { &*self.start[0].add(3 * first).cast::<[[T; 3]; N]>() };
            for i in 0..N {
                for axis in 0..3 {
                    to[axis][i] = from[i][axis];
                }
            }
        } else {
            for axis in 0..3 {
                // SAFETY: as the caller says.
                unsafe { self.load(axis, first, count, &mut to[axis][at..]) };
            }
        }
    }

    /// Copies one coordinate of `count` consecutive particles to the front of `to`.
    ///
    /// # Safety
    /// `first + count` is at most [`Positions::len`], and `count` at most the length of `to`.
    #[inline(always)]
    unsafe fn load(&self, axis: usize, first: usize, count: usize, to: &mut [T]) {
        let stride = self.stride;
        // SAFETY: the particles exist (caller).
        let start = unsafe { self.start[axis].add(first * stride) };
        for i in 0..count {
            // SAFETY: as above; `to` is long enough (caller).
            unsafe { *to.get_unchecked_mut(i) = start.add(i * stride).read() };
        }
    }
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
    #[must_use]
    pub const fn new(array: &'a [T]) -> Self {
        Self { start: array.as_ptr(), stride: 1, length: array.len(), life: PhantomData }
    }

    /// Any stride, in elements of `T`.
    ///
    /// # Safety
    /// For the life of the value, each `start + i stride` with i < `length` is an aligned element that nobody writes.
    #[must_use]
    pub unsafe fn strided(start: *const T, stride: usize, length: usize) -> Self {
        Self { start, stride, length, life: PhantomData }
    }

    /// Particles.
    #[must_use]
    pub const fn len(&self) -> usize {
        self.length
    }

    /// No particles?
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
    #[must_use]
    pub const fn new(array: &'a mut [T]) -> Self {
        Self { start: array.as_mut_ptr(), stride: 1, length: array.len(), life: PhantomData }
    }

    /// Any stride, in elements of `T`.
    ///
    /// # Safety
    /// For the life of the value, each `start + i stride` with i < `length` is an aligned element that only this value touches, and no two
    /// of them are the same.
    #[must_use]
    pub unsafe fn strided(start: *mut T, stride: usize, length: usize) -> Self {
        Self { start, stride, length, life: PhantomData }
    }

    /// Particles.
    #[must_use]
    pub const fn len(&self) -> usize {
        self.length
    }

    /// No particles?
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.length == 0
    }

    /// Writes one element.
    ///
    /// # Safety
    /// `i` is below [`ColumnMut::len`], and no other thread touches the element now.
    #[inline(always)]
    pub(super) unsafe fn write(&self, i: usize, value: T) {
        // SAFETY: the element belongs to this value (constructors), and to this thread (caller).
        unsafe { self.start.add(i * self.stride).write(value) }
    }
}
