//! Turning pointers into slices, once they are known to be sound to read and write together.

use core::ffi::c_void;

use crate::scratch::ALIGN;
use crate::status::{Error, Result};

/// Memory that one call touches: `count` elements of `size` bytes, `stride` bytes apart.
#[derive(Clone, Copy)]
struct Span {
    start: usize,
    size: usize,
    stride: usize,
    count: usize,
    written: bool,
}

impl Span {
    fn end(&self) -> usize {
        self.start + (self.count - 1) * self.stride + self.size
    }

    /// May some element of one share a byte with some element of the other? Members of one array of structs do not.
    fn meets(&self, other: &Self) -> bool {
        if self.count == 0 || other.count == 0 || self.end() <= other.start || other.end() <= self.start {
            return false;
        }
        if self.stride != other.stride {
            return true;
        }
        let shift = self.start.abs_diff(other.start) % self.stride;
        let (first, second) = if self.start <= other.start { (self, other) } else { (other, self) };
        shift < first.size || self.stride - shift < second.size
    }
}

/// The pointers of one call, each checked for null, alignment, size, and overlap with those before it.
pub(super) struct Border {
    spans: [Span; Self::SPANS],
    used: usize,
}

impl Border {
    const SPANS: usize = 40;

    pub(super) fn new() -> Self {
        let none = Span { start: 0, size: 0, stride: 1, count: 0, written: false };
        Self { spans: [none; Self::SPANS], used: 0 }
    }

    fn enter<T>(&mut self, pointer: *const T, stride: usize, count: usize, written: bool) -> Result<()> {
        if count == 0 {
            return Ok(());
        }
        if pointer.is_null() {
            return Err(Error::Null);
        }
        if !pointer.is_aligned() {
            return Err(Error::Alignment);
        }
        let size = size_of::<T>();
        let stride = stride.checked_mul(size).ok_or(Error::Overflow)?;
        let bytes = stride.checked_mul(count - 1).and_then(|b| b.checked_add(size)).ok_or(Error::Overflow)?;
        if isize::try_from(bytes).is_err() || pointer.addr().checked_add(bytes).is_none() {
            return Err(Error::Overflow);
        }
        let span = Span { start: pointer.addr(), size, stride: stride.max(1), count, written };
        if self.spans.iter().take(self.used).any(|other| (written || other.written) && span.meets(other)) {
            return Err(Error::Overlap);
        }
        let place = self.spans.get_mut(self.used).ok_or(Error::Overflow)?;
        *place = span;
        self.used += 1;
        Ok(())
    }

    /// `count` values to read.
    ///
    /// # Safety
    /// If not null, `pointer` points to `count` initialised values that nobody changes during the call.
    pub(super) unsafe fn read<'a, T>(&mut self, pointer: *const T, count: usize) -> Result<&'a [T]> {
        self.enter(pointer, 1, count, false)?;
        if count == 0 {
            return Ok(&[]);
        }
        // SAFETY: not null, aligned and of valid size; the rest is the caller's promise.
        Ok(unsafe { core::slice::from_raw_parts(pointer, count) })
    }

    /// `count` values to read, or none where the pointer is null.
    ///
    /// # Safety
    /// As [`Border::read`].
    pub(super) unsafe fn read_optional<'a, T>(
        &mut self,
        pointer: *const T,
        count: usize,
    ) -> Result<Option<&'a [T]>> {
        if pointer.is_null() {
            return Ok(None);
        }
        // SAFETY: as the caller promised.
        unsafe { self.read(pointer, count) }.map(Some)
    }

    /// One struct to read.
    ///
    /// # Safety
    /// As [`Border::read`].
    pub(super) unsafe fn read_one<'a, T>(&mut self, pointer: *const T) -> Result<&'a T> {
        // SAFETY: as the caller promised; one value was asked for.
        unsafe { self.read(pointer, 1) }?.first().ok_or(Error::Null)
    }

    /// `count` values to write.
    ///
    /// # Safety
    /// If not null, `pointer` points to `count` initialised values that nobody else touches during the call.
    pub(super) unsafe fn write<'a, T>(&mut self, pointer: *mut T, count: usize) -> Result<&'a mut [T]> {
        self.enter(pointer.cast_const(), 1, count, true)?;
        if count == 0 {
            return Ok(&mut []);
        }
        // SAFETY: not null, aligned, of valid size, apart from the call's other memory; the rest is the caller's promise.
        Ok(unsafe { core::slice::from_raw_parts_mut(pointer, count) })
    }

    /// One struct to write.
    ///
    /// # Safety
    /// As [`Border::write`].
    pub(super) unsafe fn write_one<'a, T>(&mut self, pointer: *mut T) -> Result<&'a mut T> {
        // SAFETY: as the caller promised; one value was asked for.
        unsafe { self.write(pointer, 1) }?.first_mut().ok_or(Error::Null)
    }

    /// Scratch or tables of `bytes` bytes, which must begin on a cache line.
    ///
    /// # Safety
    /// As [`Border::write`] for bytes, which need not be initialised.
    pub(super) unsafe fn scratch<'a>(&mut self, pointer: *mut c_void, bytes: usize) -> Result<&'a mut [u8]> {
        if !pointer.addr().is_multiple_of(ALIGN) {
            return Err(Error::Alignment);
        }
        // SAFETY: as the caller promised.
        unsafe { self.write(pointer.cast::<u8>(), bytes) }
    }

    /// Elements `stride` apart, to be read.
    pub(super) fn read_strided<T>(&mut self, pointer: *const T, stride: usize, count: usize) -> Result<()> {
        self.enter(pointer, stride, count, false)
    }

    /// Elements `stride` apart, to be written.
    pub(super) fn strided<T>(&mut self, pointer: *mut T, stride: usize, count: usize) -> Result<()> {
        self.enter(pointer.cast_const(), stride, count, true)
    }
}

#[cfg(test)]
mod tests {
    use std::vec;

    use super::*;

    #[test]
    fn overlap_is_seen_between_writes_and_anything() {
        let mut data = vec![0.0_f64; 16];
        let start = data.as_mut_ptr();
        let mut border = Border::new();
        // SAFETY: the ranges are inside `data`, and no slice of overlapping ranges is made.
        unsafe {
            assert!(border.read(start, 8).is_ok());
            assert!(border.read(start.add(4), 8).is_ok(), "two reads may overlap");
            assert_eq!(border.write(start.add(11), 2).err(), Some(Error::Overlap));
            assert!(border.write(start.add(12), 4).is_ok());
            assert_eq!(border.read(start.add(15), 1).err(), Some(Error::Overlap));
            assert_eq!(border.read(start, usize::MAX / 8).err(), Some(Error::Overflow));
            assert_eq!(border.read(start.wrapping_byte_add(1), 1).err(), Some(Error::Alignment));
            assert_eq!(border.read::<f64>(core::ptr::null(), 1).err(), Some(Error::Null));
            assert!(border.read::<f64>(core::ptr::null(), 0).is_ok_and(<[f64]>::is_empty));
        }
    }

    #[test]
    fn members_of_one_array_of_structs_do_not_overlap() {
        let mut data = vec![0.0_f32; 60];
        let start = data.as_mut_ptr();
        let mut border = Border::new();
        for member in 0..6 {
            assert!(border.strided(start.wrapping_add(member), 6, 10).is_ok());
        }
        assert_eq!(border.strided(start.wrapping_add(5), 6, 9).err(), Some(Error::Overlap));
        let other = start.wrapping_add(6 * 10 - 1);
        assert_eq!(
            border.strided(other, 5, 2).err(),
            Some(Error::Overlap),
            "other strides are not compared closely"
        );
    }
}
