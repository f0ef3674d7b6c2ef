//! What a fuzzer's bytes mean: numbers, sizes and choices, sound for the most part and odd now and then.
//!
//! Where the bytes end, zeros follow, and a zero means what is sound. So short inputs get far, and each byte that the fuzzer adds spoils or
//! chooses something.

use crate::memory::Memory;

/// The bytes that are left, and the memory that this execution has shown to the library so far.
pub struct Input<'a> {
    rest: &'a [u8],
    pub(crate) shown: Vec<(*mut u8, usize)>,
}

/// Numbers where formulae change: zeros, ones, the ends of both precisions, denormals, and the sizes of boxes.
const SPECIAL: [f64; 28] = [
    0.0,
    -0.0,
    1.0,
    -1.0,
    0.5,
    -0.5,
    2.0,
    8.0,
    50.0,
    100.0,
    99.999_999_999_999_99,
    1e-300,
    1e300,
    5e-324,
    1e-45,
    f64::MIN_POSITIVE,
    f64::MAX,
    f64::MIN,
    f64::EPSILON,
    f32::MIN_POSITIVE as f64,
    f32::MAX as f64,
    1e19,
    9_007_199_254_740_992.0,
    -1e-17,
    1e-3,
    f64::NAN,
    f64::INFINITY,
    f64::NEG_INFINITY,
];

/// Sizes where arithmetic may overflow, and sides that the transform has and has not.
const SIZES: [usize; 24] = [
    0,
    1,
    2,
    3,
    4,
    6,
    8,
    10,
    11,
    12,
    14,
    22,
    64,
    4096,
    usize::MAX,
    usize::MAX - 1,
    usize::MAX / 2,
    usize::MAX / 2 + 1,
    usize::MAX / 16,
    usize::MAX / 64,
    1 << 20,
    1 << 21,
    1 << 32,
    2_097_150,
];

/// Sides of meshes: small ones, for a mesh twice as wide takes eight times as long, and now and then one of each factor of the transform.
const SIDES: [usize; 32] =
    [4, 2, 4, 6, 4, 2, 4, 6, 4, 2, 4, 8, 4, 2, 4, 6, 4, 2, 4, 8, 4, 2, 4, 6, 4, 2, 4, 10, 4, 14, 6, 12];

impl<'a> Input<'a> {
    pub fn new(data: &'a [u8]) -> Self {
        Self { rest: data, shown: Vec::with_capacity(16) }
    }

    pub fn byte(&mut self) -> u8 {
        let Some((&first, rest)) = self.rest.split_first() else { return 0 };
        self.rest = rest;
        first
    }

    /// Little-endian, of as many bytes as asked for.
    fn bytes(&mut self, count: usize) -> u64 {
        (0..count).fold(0, |word, place| word | u64::from(self.byte()) << (8 * place))
    }

    pub fn word(&mut self) -> u64 {
        self.bytes(8)
    }

    /// Below `below`, of one byte.
    pub fn few(&mut self, below: usize) -> usize {
        usize::from(self.byte()) % below
    }

    pub fn flag(&mut self) -> bool {
        self.byte() % 2 == 1
    }

    /// True once in `times` bytes; never at the end of the input.
    pub fn odd(&mut self, times: u8) -> bool {
        self.byte() % times == times - 1
    }

    /// Any size at all.
    pub fn size(&mut self) -> usize {
        match self.byte() {
            kind @ 0..128 => SIZES[usize::from(kind) % SIZES.len()],
            kind @ 128..192 => usize::from(kind) % 16,
            kind => (self.word() >> (kind % 64)) as usize,
        }
    }

    /// Below `below` for the most part, else any size.
    pub fn about(&mut self, below: usize) -> usize {
        if self.odd(16) { self.size() } else { self.few(below) }
    }

    /// The side of a small mesh: 2 to 14.
    pub fn small_side(&mut self) -> usize {
        SIDES[self.few(32)]
    }

    /// The same, or one time in 16 anything.
    pub fn side(&mut self) -> usize {
        if self.odd(16) { self.size() } else { self.small_side() }
    }

    /// One of `count` choices, or one time in 16 any number.
    pub fn choice(&mut self, count: usize) -> i32 {
        if self.odd(16) { self.bytes(4) as i32 } else { self.few(count) as i32 }
    }

    /// Any number at all.
    pub fn number(&mut self) -> f64 {
        match self.byte() {
            kind @ 0..192 => SPECIAL[usize::from(kind) % SPECIAL.len()],
            192..208 => f64::from_bits(self.word()),
            208..224 => f64::from(f32::from_bits(self.bytes(4) as u32)),
            _ => self.between(-2.0, 2.0),
        }
    }

    /// In [low, high), of three bytes; the lowest at the end of the input.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * (self.bytes(3) as f64 / f64::from(1 << 24))
    }

    /// `good` for the most part, else near it or any number.
    pub fn about_number(&mut self, good: f64) -> f64 {
        match self.byte() {
            kind if kind % 16 == 15 => self.number(),
            kind if kind % 4 == 3 => good * self.between(0.25, 2.0),
            _ => good,
        }
    }

    /// A length as the caller declares it: that of the memory for the most part, else shorter, or longer than any memory.
    pub fn length(&mut self, of: usize) -> usize {
        match self.byte() % 64 {
            61 => self.few(of.min(255) + 1),
            62 => of - usize::from(of > 0),
            63 => usize::MAX - self.few(3),
            _ => of,
        }
    }

    /// The pointer of a caller who errs now and then: null, misaligned, or to memory that another argument points to.
    pub fn pointer<T>(&mut self, of: &Memory<T>) -> *mut T {
        let (own, bytes) = (of.pointer(), of.bytes());
        let kind = self.byte() % 96;
        let shown = match kind {
            93 => core::ptr::null_mut(),
            94 if !of.is_empty() => own.wrapping_byte_add(1),
            // Never for scratch: an output of which no element is declared overlaps nothing, so that the library may write there, and the target would take
            // it for an output touched.
            95 if size_of::<T>() > 1 => {
                let place = self.few(self.shown.len().max(1));
                match self.shown.get(place) {
                    Some(&(other, long)) if long >= bytes && other.cast::<T>().is_aligned() => other.cast(),
                    _ => own,
                }
            }
            _ => own,
        };
        self.shown.push((own.cast(), bytes));
        shown
    }

    /// `of`, or null where the library allows it.
    pub fn optional<T>(&mut self, of: &Memory<T>) -> *mut T {
        if self.flag() { self.pointer(of) } else { core::ptr::null_mut() }
    }

    /// A generator seeded by two bytes, for what the fuzzer need not choose number by number.
    pub fn random(&mut self) -> Random {
        Random(self.bytes(2))
    }
}

/// splitmix64 (Steele, Lea & Flood 2014).
pub struct Random(u64);

impl From<u64> for Random {
    fn from(seed: u64) -> Self {
        Self(seed)
    }
}

impl Random {
    pub fn word(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ self.0 >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ z >> 31
    }

    /// In [0, 1).
    pub fn unit(&mut self) -> f64 {
        (self.word() >> 11) as f64 / 9_007_199_254_740_992.0
    }

    pub fn below(&mut self, below: u64) -> u64 {
        self.word() % below
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn after_its_end_an_input_is_sound() {
        let mut input = Input::new(&[]);
        assert!(!input.odd(4) && !input.flag());
        assert_eq!(input.length(7), 7);
        assert_eq!(input.about_number(100.0), 100.0);
        assert_eq!(input.side(), 4);
        let memory = Memory::<f64>::new(3, |_| 0.0);
        assert_eq!(input.pointer(&memory), memory.pointer());
    }
}
