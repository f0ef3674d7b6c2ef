//! Memory as a caller of the C interface has it: exactly as long as declared, so that the address sanitizer sees each step beyond its ends.

use std::alloc::{Layout, alloc, dealloc, handle_alloc_error};

use crate::input::Input;

/// `len` values, which only the library touches during a call.
pub struct Memory<T> {
    base: *mut u8,
    pointer: *mut T,
    len: usize,
    layout: Layout,
}

/// As scratch and tables must be aligned.
const ALIGN: usize = 64;

impl<T> Memory<T> {
    /// Values by their place, aligned to 64 bytes.
    pub fn new(len: usize, value: impl FnMut(usize) -> T) -> Self {
        Self::behind(0, len, value)
    }

    /// The same, `lead` elements after an aligned address.
    pub fn behind(lead: usize, len: usize, mut value: impl FnMut(usize) -> T) -> Self {
        let memory = Self::uninitialised(lead, len);
        for place in 0..len {
            // SAFETY: in the allocation and aligned: a type's size is a multiple of its alignment, which is at most 64.
            unsafe { memory.pointer.add(place).write(value(place)) };
        }
        memory
    }

    fn uninitialised(lead: usize, len: usize) -> Self {
        let lead = lead * size_of::<T>();
        let layout = Layout::from_size_align((lead + len * size_of::<T>()).max(1), ALIGN).expect("small");
        // SAFETY: the size is not zero.
        let base = unsafe { alloc(layout) };
        if base.is_null() {
            handle_alloc_error(layout);
        }
        Self { base, pointer: base.wrapping_add(lead).cast(), len, layout }
    }

    /// A struct or structs of the header, all bytes zero, as C's memset leaves them. Only for numbers, raw pointers, optional functions, and structs of these.
    pub fn zeros(len: usize) -> Self
    where
        T: Copy + 'static,
    {
        // SAFETY: zero bytes are a value of all of these.
        Self::new(len, |_| unsafe { core::mem::zeroed() })
    }

    pub fn pointer(&self) -> *mut T {
        self.pointer
    }

    pub fn len(&self) -> usize {
        self.len
    }

    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    pub fn bytes(&self) -> usize {
        self.len * size_of::<T>()
    }

    /// Not during a call of the library.
    pub fn values(&self) -> &[T] {
        // SAFETY: initialised by `behind`; the library writes values of T alone.
        unsafe { core::slice::from_raw_parts(self.pointer, self.len) }
    }

    /// Not during a call of the library.
    pub fn values_mut(&mut self) -> &mut [T] {
        // SAFETY: as `values`, and not shared.
        unsafe { core::slice::from_raw_parts_mut(self.pointer, self.len) }
    }

    /// A hash of all bytes, to tell whether they changed.
    pub fn hash(&self) -> u64 {
        hash(self.pointer.cast(), self.bytes())
    }
}

impl<T> Drop for Memory<T> {
    fn drop(&mut self) {
        // SAFETY: allocated by `behind` with this layout.
        unsafe { dealloc(self.base, self.layout) };
    }
}

/// Of bytes that may hold padding, hence by pointer.
pub(crate) fn hash(bytes: *const u8, count: usize) -> u64 {
    let mix = |hash: u64, word: u64| (hash ^ word).wrapping_mul(0x9e37_79b9_7f4a_7c15).rotate_left(29);
    let mut hash = count as u64;
    for place in (0..count / 8).map(|word| 8 * word) {
        // SAFETY: within `count` bytes, as the callers promise.
        hash = mix(hash, unsafe { bytes.add(place).cast::<u64>().read_unaligned() });
    }
    for place in count / 8 * 8..count {
        // SAFETY: the same.
        hash = mix(hash, u64::from(unsafe { bytes.add(place).read() }));
    }
    hash
}

/// Numbers in single or double precision.
pub trait Float: Copy + PartialEq {
    fn of(value: f64) -> Self;
    fn to(self) -> f64;
}

impl Float for f32 {
    fn of(value: f64) -> Self {
        value as Self
    }

    fn to(self) -> f64 {
        self.into()
    }
}

impl Float for f64 {
    fn of(value: f64) -> Self {
        value
    }

    fn to(self) -> f64 {
        self
    }
}

impl<T: Float> Memory<T> {
    /// Random numbers in [low, high), some of them spoiled now and then.
    pub fn floats(input: &mut Input, len: usize, low: f64, high: f64) -> Self {
        let lead = if input.odd(8) { 1 + input.few(7) } else { 0 };
        let mut random = input.random();
        let mut all = Self::behind(lead, len, |_| T::of(low + (high - low) * random.unit()));
        all.spoil(input);
        all
    }

    /// Any number in up to four places, one time in eight.
    pub fn spoil(&mut self, input: &mut Input) {
        if self.len > 0 && input.odd(8) {
            for _ in 0..=input.few(4) {
                let place = (input.few(256) + 256 * input.few(16)) % self.len;
                self.values_mut()[place] = T::of(input.number());
            }
        }
    }

    pub fn all_finite(&self) -> bool {
        self.values().iter().all(|value| value.to().is_finite())
    }
}

/// Scratch of so many bytes, of contents that are no sensible number.
pub fn scratch(bytes: usize) -> Memory<u8> {
    let memory = Memory::<u8>::uninitialised(0, bytes);
    // SAFETY: all of the memory, which holds bytes.
    unsafe { memory.pointer.write_bytes(0xfb, bytes) };
    memory
}
