//! Who runs the loops: the caller's threads, the built-in pool, or nobody but the calling thread.
//!
//! A kernel cuts its work into chunks by the problem, never by the number of threads, and every chunk writes memory of
//! its own; so results do not depend on who runs it.

use crate::status::Result;

#[cfg(feature = "std")]
mod threads;
#[cfg(feature = "std")]
pub use threads::Threads;

/// Runs the chunks of a kernel.
///
/// # Safety
/// `parallel_for` must call `body(i)` exactly once for each `i` in `0..count`, in any order and on any threads, and
/// return only when all calls have returned: kernels hand each chunk exclusive memory on that promise. If it cannot,
/// it returns an error and must have no call still running.
pub unsafe trait Exec: Sync {
    /// Calls `body(i)` for all `i` in `0..count`.
    ///
    /// # Errors
    /// `Hook` if the chunks could not all be run; outputs are then undefined.
    fn parallel_for(&self, count: usize, body: &(dyn Fn(usize) + Sync)) -> Result<()>;
}

/// The calling thread.
#[derive(Clone, Copy, Debug, Default)]
pub struct Serial;

// SAFETY: the loop calls each index once and returns after the last.
unsafe impl Exec for Serial {
    fn parallel_for(&self, count: usize, body: &(dyn Fn(usize) + Sync)) -> Result<()> {
        (0..count).for_each(body);
        Ok(())
    }
}

/// A mutable slice that the chunks of one `parallel_for` share, each taking a part of its own.
pub struct Shared<'a, T> {
    start: *mut T,
    length: usize,
    life: core::marker::PhantomData<&'a mut [T]>,
}

// SAFETY: it only hands out parts of a `&mut [T]`, and `part` asks its callers to keep them apart.
unsafe impl<T: Send> Sync for Shared<'_, T> {}
// SAFETY: as a `&mut [T]`.
unsafe impl<T: Send> Send for Shared<'_, T> {}

impl<'a, T> Shared<'a, T> {
    /// Borrows `data` until the value is dropped.
    ///
    /// ```
    /// use fixpair::exec::{Exec, Serial, Shared};
    ///
    /// let mut data = [0; 4];
    /// let shared = Shared::new(&mut data);
    /// // SAFETY: each index takes a part of its own.
    /// Serial.parallel_for(4, &|i| unsafe { shared.part(i, 1) }[0] = i)?;
    /// assert_eq!(data, [0, 1, 2, 3]);
    /// # Ok::<(), fixpair::status::Error>(())
    /// ```
    pub fn new(data: &'a mut [T]) -> Self {
        Self { start: data.as_mut_ptr(), length: data.len(), life: core::marker::PhantomData }
    }

    /// The address of element 0, for kernels that walk memory by strides.
    ///
    /// ```
    /// use fixpair::exec::Shared;
    ///
    /// let mut data = [7];
    /// let shared = Shared::new(&mut data);
    /// // SAFETY: nobody else uses the data.
    /// assert_eq!(unsafe { *shared.as_ptr() }, 7);
    /// ```
    #[must_use]
    pub const fn as_ptr(&self) -> *mut T {
        self.start
    }

    /// Elements `start .. start + length`.
    ///
    /// # Safety
    /// The range lies inside the slice, and no other part that is alive overlaps it.
    ///
    /// # Example
    /// ```
    /// use fixpair::exec::Shared;
    ///
    /// let mut data = [1, 2, 3, 4];
    /// let shared = Shared::new(&mut data);
    /// // SAFETY: the only part that is taken.
    /// assert_eq!(unsafe { shared.part(1, 2) }, [2, 3]);
    /// ```
    #[must_use]
    #[inline]
    #[expect(clippy::mut_from_ref, reason = "disjoint parts of one exclusive borrow")]
    pub unsafe fn part(&self, start: usize, length: usize) -> &mut [T] {
        debug_assert!(start <= self.length && length <= self.length - start);
        // SAFETY: the caller keeps the range inside the slice and apart from other parts.
        unsafe { core::slice::from_raw_parts_mut(self.start.add(start), length) }
    }
}

/// Runs `body(i, piece)` for consecutive pieces of `length` elements of `data` (the last may be shorter).
///
/// # Errors
/// As [`Exec::parallel_for`].
///
/// # Example
/// ```
/// use fixpair::exec::{Serial, for_each_piece};
///
/// let mut data = [0; 10];
/// for_each_piece(&Serial, &mut data, 4, &|piece, values| values.fill(piece))?;
/// assert_eq!(data, [0, 0, 0, 0, 1, 1, 1, 1, 2, 2]);
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn for_each_piece<T: Send>(
    exec: &dyn Exec,
    data: &mut [T],
    length: usize,
    body: &(dyn Fn(usize, &mut [T]) + Sync),
) -> Result<()> {
    let total = data.len();
    let length = length.max(1);
    let shared = Shared::new(data);
    exec.parallel_for(total.div_ceil(length), &|i| {
        let start = i * length;
        // SAFETY: pieces of different chunks are disjoint and inside the slice; each chunk runs once.
        body(i, unsafe { shared.part(start, length.min(total - start)) });
    })
}

#[cfg(test)]
mod tests;
