//! Slices by index, without a panic.
//!
//! Kernels index what their constructors have measured, so an index is always within its slice. The compiler sees that of some and not
//! of others, and where it does not, `slice[index]` leaves a panic in the machine code that a program without an operating system
//! cannot link (see `freestanding.rs`). Here an index beyond the end is a failed assertion in builds that have debug assertions, as those of the
//! tests, and in those of the fuzzer, and in others reads a default, writes nothing, or is the empty slice: a wrong number at worst, never another's memory.
//!
//! For the rest `get`, `get_mut`, `split_at_mut_checked`, `checked_div` and `checked_rem` of the language do.

use core::slice::SliceIndex;

/// Builds in which an index beyond the end is a failed assertion.
const CHECKED: bool = cfg!(any(debug_assertions, fixpair_fuzzing));

pub(crate) trait Within<T> {
    /// The element at `index`.
    fn at(&self, index: usize) -> T
    where
        T: Copy + Default;

    /// Writes the element at `index`.
    fn put(&mut self, index: usize, value: T);

    /// The elements of `range`.
    fn part(&self, range: impl SliceIndex<[T], Output = [T]>) -> &[T];

    /// The elements of `range`, to be written.
    fn part_mut(&mut self, range: impl SliceIndex<[T], Output = [T]>) -> &mut [T];

    /// Copies as many elements of `from` as both have.
    fn copy(&mut self, from: &[T])
    where
        T: Copy;
}

impl<T> Within<T> for [T] {
    #[inline(always)]
    #[track_caller]
    fn at(&self, index: usize) -> T
    where
        T: Copy + Default,
    {
        assert!(!CHECKED || index < self.len(), "element {index} of {}", self.len());
        self.get(index).copied().unwrap_or_default()
    }

    #[inline(always)]
    #[track_caller]
    fn put(&mut self, index: usize, value: T) {
        assert!(!CHECKED || index < self.len(), "element {index} of {}", self.len());
        if let Some(element) = self.get_mut(index) {
            *element = value;
        }
    }

    #[inline(always)]
    #[track_caller]
    fn part(&self, range: impl SliceIndex<[T], Output = [T]>) -> &[T] {
        let part = self.get(range);
        assert!(!CHECKED || part.is_some(), "a part beyond {} elements", self.len());
        part.unwrap_or_default()
    }

    #[inline(always)]
    #[track_caller]
    fn part_mut(&mut self, range: impl SliceIndex<[T], Output = [T]>) -> &mut [T] {
        let len = self.len();
        let part = self.get_mut(range);
        assert!(!CHECKED || part.is_some(), "a part beyond {len} elements");
        part.unwrap_or_default()
    }

    #[inline(always)]
    #[track_caller]
    fn copy(&mut self, from: &[T])
    where
        T: Copy,
    {
        assert!(!CHECKED || self.len() == from.len());
        for (to, &from) in self.iter_mut().zip(from) {
            *to = from;
        }
    }
}
