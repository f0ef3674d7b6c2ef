//! RANLUX in double precision at luxury level 1, "ranlxd1" (Luescher 1994, hep-lat/9309020; James 1994): a
//! subtract-with-borrow generator that throws 190 of 202 numbers away.
//!
//! The twelve numbers of its state are multiples of 2^-48 in [0, 1). Here they are integers below 2^48: a difference in
//! 64-bit arithmetic modulo 2^48 is its lower 48 bits, and the borrow is its sign. That is exact, has no branch, and is four
//! vector instructions for as many generators as a register has lanes.
//!
//! The state is turned after each use so that its oldest word stands first: all indices are known to the compiler.

use crate::within::Within;

const WORDS: usize = 12;
/// Updates between two dozens of numbers: the luxury level.
const UPDATES: usize = 202;
/// From the word that is updated to the one that it is subtracted from.
const LAG: usize = 7;
const BITS: usize = 48;
const MASK: u64 = (1 << BITS) - 1;
/// Bits of the shift register that a seed fills.
const SEED_BITS: usize = 31;
const SEED_MASK: u64 = (1 << SEED_BITS) - 1;

/// `L` generators, each with a seed of its own, that draw a dozen numbers together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Lanes<const L: usize> {
    words: [[u64; L]; WORDS],
    borrow: [u64; L],
}

impl<const L: usize> Lanes<L> {
    /// The generators before their first dozen.
    ///
    /// A shift register begins with the seed's 31 bits, the least significant first, and goes on as s(t + 31) = s(t) ^ s(t + 18);
    /// each word takes 48 of its bits, inverted, the most significant first.
    #[inline(always)]
    pub(super) fn new(seeds: [u64; L]) -> Self {
        // The earliest bit of a window of 31 is its highest, as in the words.
        let mut window = seeds.map(first_window);
        let mut words = [[0; L]; WORDS];
        let mut begin = 0;
        for (k, word) in words.iter_mut().enumerate() {
            // Bits 48 k .. 48 k + 48 are in the windows that begin at `begin`, `begin + 31` and `begin + 62`.
            let end = BITS * (k + 1);
            loop {
                let window_end = begin + SEED_BITS;
                for lane in 0..L {
                    word[lane] |= if window_end > end {
                        window[lane] >> (window_end - end)
                    } else {
                        window[lane] << (end - window_end)
                    };
                }
                if window_end > end {
                    break;
                }
                window = window.map(next_window);
                begin = window_end;
            }
            *word = word.map(|bits| !bits & MASK);
        }
        Self { words, borrow: [0; L] }
    }

    /// The next dozen, in the order in which they are drawn: integers below 2^48.
    #[inline(always)]
    pub(super) fn dozen(&mut self) -> &[[u64; L]; WORDS] {
        let mut words = self.words;
        let mut borrow = self.borrow;
        for _ in 0..UPDATES / WORDS {
            for r in 0..WORDS {
                update(&mut words, &mut borrow, r);
            }
        }
        for r in 0..UPDATES % WORDS {
            update(&mut words, &mut borrow, r);
        }
        words.rotate_left(UPDATES % WORDS);
        self.words = words;
        self.borrow = borrow;
        &self.words
    }

    /// One of the generators.
    pub(super) fn lane(&self, lane: usize) -> Lanes<1> {
        Lanes { words: self.words.map(|word| [word[lane]]), borrow: [self.borrow[lane]] }
    }
}

/// x(r) <- x(r + 7) - x(r) - borrow, modulo 1, and whether that borrowed.
#[inline(always)]
fn update<const L: usize>(words: &mut [[u64; L]; WORDS], borrow: &mut [u64; L], r: usize) {
    // Whole rows are read before one is written: then the compiler makes vectors of them.
    let (minuend, mut row) = (words[(r + LAG) % WORDS], words[r]);
    for lane in 0..L {
        let difference = minuend[lane].wrapping_sub(row[lane]).wrapping_sub(borrow[lane]);
        borrow[lane] = difference >> 63;
        row[lane] = difference & MASK;
    }
    words[r] = row;
}

/// The first 31 bits of the shift register.
///
/// GSL takes an unsigned long but looks at its lower 32 bits as a signed number, of which it loads the magnitude; 0 counts as 1.
#[inline(always)]
fn first_window(seed: u64) -> u64 {
    let seed = if seed == 0 { 1 } else { seed };
    let magnitude = (seed as u32).cast_signed().unsigned_abs();
    u64::from(magnitude.reverse_bits() >> 1)
}

/// The 31 bits after these: the first 13 need old bits alone, the others also those 13 before themselves.
#[inline(always)]
fn next_window(window: u64) -> u64 {
    let own = window ^ ((window << 18) & SEED_MASK);
    own ^ (own >> 13) ^ (own >> 26)
}

/// x 2^-48 for x below 2^48, exactly.
#[inline(always)]
pub(super) fn uniform(x: u64) -> f64 {
    f64::from_bits(1_f64.to_bits() | (x << 4)) - 1.0
}

/// One generator: GSL's `gsl_rng_ranlxd1`, bit for bit, for every seed.
///
/// Not for cryptography.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Ranlxd1 {
    state: Lanes<1>,
    used: usize,
}

impl Ranlxd1 {
    /// The stream of a seed. The lower 32 bits count as a signed number of which the magnitude is taken, without its 31st bit;
    /// 0 stands for 1. So distinct streams have seeds in 1 ..= 2^31.
    ///
    /// ```
    /// use fixpair::noise::ranlux::Ranlxd1;
    ///
    /// assert_eq!(Ranlxd1::new(0).uniform(), Ranlxd1::new(1).uniform()); // as in GSL
    /// ```
    #[must_use]
    pub fn new(seed: u64) -> Self {
        Self::resume(Lanes::new([seed]), WORDS)
    }

    /// The stream of a state of which `used` of the present dozen are drawn.
    pub(super) const fn resume(state: Lanes<1>, used: usize) -> Self {
        Self { state, used }
    }

    /// The next number: a multiple of 2^-48 in [0, 1).
    ///
    /// ```
    /// use fixpair::noise::ranlux::Ranlxd1;
    ///
    /// let mut stream = Ranlxd1::new(5001);
    /// let (first, second) = (stream.uniform(), stream.uniform());
    /// assert!((0.0..1.0).contains(&first) && first != second);
    /// ```
    #[inline]
    pub fn uniform(&mut self) -> f64 {
        uniform(self.word())
    }

    /// 2^48 times the next number.
    #[inline(always)]
    pub(super) fn word(&mut self) -> u64 {
        if self.used == WORDS {
            self.state.dozen();
            self.used = 0;
        }
        let [word] = self.state.words.at(self.used);
        self.used += 1;
        word
    }

    /// u1 and u2 of a mode, times 2^48: the second is drawn again while it is zero.
    #[inline(always)]
    pub(super) fn pair(&mut self) -> [u64; 2] {
        let first = self.word();
        loop {
            let second = self.word();
            if second != 0 {
                return [first, second];
            }
        }
    }
}

#[cfg(test)]
impl<const L: usize> Lanes<L> {
    /// Generators side by side.
    pub(super) fn side_by_side(lanes: [Lanes<1>; L]) -> Self {
        Self {
            words: core::array::from_fn(|k| core::array::from_fn(|lane| lanes[lane].words[k][0])),
            borrow: core::array::from_fn(|lane| lanes[lane].borrow[0]),
        }
    }
}

#[cfg(test)]
impl Lanes<1> {
    /// The generator whose next dozen is this: all updates undone. A word is larger than its minuend where its update borrowed.
    pub(super) fn before(dozen: [u64; WORDS]) -> Self {
        let mut words = dozen;
        words.rotate_right(UPDATES % WORDS);
        let borrowed = |words: &[u64; WORDS], r: usize| u64::from(words[r] > words[(r + LAG) % WORDS]);
        let mut borrow = 0;
        for update in (0..UPDATES).rev() {
            let r = update % WORDS;
            borrow = borrowed(&words, (r + WORDS - 1) % WORDS);
            words[r] = words[(r + LAG) % WORDS].wrapping_sub(words[r]).wrapping_sub(borrow) & MASK;
        }
        let mut state = Self { words: words.map(|word| [word]), borrow: [borrow] };
        let before = state;
        assert_eq!(*state.dozen(), dozen.map(|word| [word]), "undone");
        before
    }
}
