//! Work memory: how much a kernel needs, and how it is cut into typed slices.
//!
//! A kernel's `..._scratch` twin returns a [`Layout`]; the kernel takes that many bytes, aligned to `align`, whose
//! contents do not matter before and mean nothing after.

use crate::status::{Error, Result};

/// Alignment of all scratch and tables: a cache line, and the widest vector register there is.
pub const ALIGN: usize = 64;

/// Bytes and alignment of a piece of memory that a kernel asks its caller for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(C)]
pub struct Layout {
    /// Bytes: a multiple of `align`, as aligned_alloc wants it.
    pub size: usize,
    /// Alignment of its first byte: a power of two.
    pub align: usize,
}

impl Layout {
    /// No memory.
    /// cbindgen:ignore
    pub const EMPTY: Self = Self { size: 0, align: ALIGN };

    /// Adds an array of `count` values of `T`, rounded up to whole cache lines.
    ///
    /// # Errors
    /// `Overflow` if the bytes do not fit the address space.
    ///
    /// # Example
    /// ```
    /// use fixpair::scratch::Layout;
    ///
    /// let layout = Layout::EMPTY.and::<f64>(5)?.and::<u32>(3)?;
    /// assert_eq!((layout.size, layout.align), (128, 64)); // each in whole cache lines
    /// # Ok::<(), fixpair::status::Error>(())
    /// ```
    pub fn and<T: Plain>(self, count: usize) -> Result<Self> {
        let bytes = count.checked_mul(size_of::<T>()).and_then(|b| b.checked_next_multiple_of(ALIGN));
        let size = bytes.and_then(|b| b.checked_add(self.size)).ok_or(Error::Overflow)?;
        if isize::try_from(size).is_err() { Err(Error::Overflow) } else { Ok(Self { size, align: ALIGN }) }
    }
}

pub(crate) mod sealed {
    pub trait Sealed {}
}

/// Number types for which every bit pattern is a value, so that any memory can be read as them.
pub trait Plain: sealed::Sealed + Copy + Send + Sync + 'static {}

macro_rules! plain {
    ($($t:ty),*) => { $(impl sealed::Sealed for $t {} impl Plain for $t {})* };
}
plain!(f32, f64, u8, u16, u32, u64, i64);
impl<T: Plain, const N: usize> sealed::Sealed for [T; N] {}
impl<T: Plain, const N: usize> Plain for [T; N] {}

/// Cuts one piece of memory into aligned typed slices, in the order in which a [`Layout`] was summed.
pub struct Arena<'a> {
    rest: &'a mut [u8],
}

impl<'a> Arena<'a> {
    /// Checks that `memory` satisfies `layout`.
    ///
    /// # Errors
    /// `Scratch` if it is shorter, `Alignment` if it does not begin on a multiple of `layout.align`.
    ///
    /// # Example
    /// ```
    /// use fixpair::scratch::{Arena, Layout};
    /// # #[repr(align(64))] struct Memory([u8; 128]);
    /// # let mut memory = Memory([0; 128]);
    /// # let bytes = &mut memory.0;
    ///
    /// let layout = Layout::EMPTY.and::<f64>(5)?;
    /// assert!(Arena::new(&mut bytes[..8], layout).is_err()); // too short
    /// assert!(Arena::new(bytes, layout).is_ok());
    /// # Ok::<(), fixpair::status::Error>(())
    /// ```
    pub fn new(memory: &'a mut [u8], layout: Layout) -> Result<Self> {
        if memory.len() < layout.size {
            return Err(Error::Scratch);
        }
        if layout.size > 0 && !memory.as_ptr().addr().is_multiple_of(layout.align) {
            return Err(Error::Alignment);
        }
        Ok(Self { rest: memory })
    }

    /// As [`Arena::take`] for each of `counts`.
    ///
    /// # Errors
    /// As [`Arena::take`].
    ///
    /// # Example
    /// ```
    /// use fixpair::scratch::{Arena, Layout};
    /// # #[repr(align(64))] struct Memory([u8; 128]);
    /// # let mut memory = Memory([0; 128]);
    /// # let bytes = &mut memory.0;
    ///
    /// let mut arena = Arena::new(bytes, Layout::EMPTY.and::<f64>(5)?.and::<f64>(2)?)?;
    /// let [five, two] = arena.take_each::<f64, 2>([5, 2])?;
    /// assert_eq!((five.len(), two.len()), (5, 2));
    /// # Ok::<(), fixpair::status::Error>(())
    /// ```
    pub fn take_each<T: Plain, const K: usize>(&mut self, counts: [usize; K]) -> Result<[&'a mut [T]; K]> {
        let mut failure = None;
        let pieces = counts.map(|count| match self.take(count) {
            Ok(piece) => piece,
            Err(error) => {
                failure = Some(error);
                &mut []
            }
        });
        failure.map_or(Ok(pieces), Err)
    }

    /// The next `count` values; their contents are whatever the memory held.
    ///
    /// # Errors
    /// `Scratch` if the memory is used up.
    ///
    /// # Example
    /// ```
    /// use fixpair::scratch::{Arena, Layout};
    /// # #[repr(align(64))] struct Memory([u8; 128]);
    /// # let mut memory = Memory([0; 128]);
    /// # let bytes = &mut memory.0;
    ///
    /// let mut arena = Arena::new(bytes, Layout::EMPTY.and::<f64>(5)?.and::<u32>(3)?)?;
    /// let (numbers, counts) = (arena.take::<f64>(5)?, arena.take::<u32>(3)?);
    /// assert_eq!((numbers.len(), counts.len()), (5, 3));
    /// # Ok::<(), fixpair::status::Error>(())
    /// ```
    pub fn take<T: Plain>(&mut self, count: usize) -> Result<&'a mut [T]> {
        let bytes = Layout::EMPTY.and::<T>(count)?.size;
        let rest = core::mem::take(&mut self.rest);
        if rest.len() < bytes {
            self.rest = rest;
            return Err(Error::Scratch);
        }
        let (piece, rest) = rest.split_at_mut(bytes);
        self.rest = rest;
        // SAFETY: every bit pattern is a `T` (Plain is sealed), and `align_to_mut` returns only the aligned middle.
        let (before, values, _) = unsafe { piece.align_to_mut::<T>() };
        if before.is_empty() && values.len() >= count {
            Ok(&mut values[..count])
        } else {
            Err(Error::Alignment)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[repr(align(64))]
    struct Aligned([u8; 1024]);

    #[test]
    fn an_arena_deals_out_what_its_layout_asked_for() {
        let layout = Layout::EMPTY.and::<f64>(5).unwrap().and::<u32>(17).unwrap().and::<[f64; 3]>(2).unwrap();
        assert_eq!(layout, Layout { size: 64 + 128 + 64, align: 64 });
        let mut memory = Aligned([7; 1024]);
        let mut arena = Arena::new(&mut memory.0[..layout.size], layout).unwrap();
        assert_eq!(arena.take::<f64>(5).unwrap().len(), 5);
        assert_eq!(arena.take::<u32>(17).unwrap().len(), 17);
        assert_eq!(arena.take::<[f64; 3]>(2).unwrap().len(), 2);
        assert_eq!(arena.take::<u8>(1).err(), Some(Error::Scratch));
    }

    #[test]
    fn short_and_misaligned_memory_is_refused() {
        let layout = Layout::EMPTY.and::<f32>(16).unwrap();
        let mut memory = Aligned([0; 1024]);
        assert_eq!(Arena::new(&mut memory.0[..63], layout).err(), Some(Error::Scratch));
        assert_eq!(Arena::new(&mut memory.0[4..], layout).err(), Some(Error::Alignment));
        assert_eq!(Layout::EMPTY.and::<f64>(usize::MAX).err(), Some(Error::Overflow));
        assert!(Arena::new(&mut [], Layout::EMPTY).is_ok());
    }
}
