//! Philox4x32-10 (Salmon et al. 2011, "Parallel random numbers: as easy as 1, 2, 3", SC11): 128 random bits
//! as a bijection of a 128-bit counter under a 64-bit key.
//!
//! There is no state to advance: any process computes the numbers of any mode at once, in any order.

use core::convert::Infallible;

use rand_core::{SeedableRng, TryRng, utils};

const MULTIPLIER: [u64; 2] = [0xD251_1F53, 0xCD9E_8D57];
/// Added to the key after each round: the golden ratio and sqrt(3) - 1.
const WEYL: [u32; 2] = [0x9E37_79B9, 0xBB67_AE85];
const ROUNDS: u32 = 10;
const LOW: u64 = 0xFFFF_FFFF;

/// The block of `counter` under `key`.
///
/// ```
/// use fixpair::noise::philox::philox4x32_10;
///
/// let words = philox4x32_10([0; 4], [0; 2]); // the first vector of Random123
/// assert_eq!(words, [0x6627_e8d5, 0xe169_c58d, 0xbc57_ac4c, 0x9b00_dbd8]);
/// ```
#[must_use]
#[inline]
pub fn philox4x32_10(counter: [u32; 4], key: [u32; 2]) -> [u32; 4] {
    rounds(counter.map(u64::from), key).map(|word| word as u32)
}

/// The rounds on the low halves of four 64-bit words; the high halves of the result are without meaning. This is the
/// form that becomes vector instructions: their 32 by 32 bit product reads the low half of each 64-bit lane.
#[inline(always)]
pub(crate) fn rounds(mut x: [u64; 4], key: [u32; 2]) -> [u64; 4] {
    for round in 0..ROUNDS {
        let key0 = u64::from(key[0].wrapping_add(WEYL[0].wrapping_mul(round)));
        let key1 = u64::from(key[1].wrapping_add(WEYL[1].wrapping_mul(round)));
        let product0 = MULTIPLIER[0] * (x[0] & LOW);
        let product1 = MULTIPLIER[1] * (x[2] & LOW);
        x = [(product1 >> 32) ^ x[1] ^ key0, product1, (product0 >> 32) ^ x[3] ^ key1, product0];
    }
    x
}

/// The two words of a 64-bit seed.
#[must_use]
#[inline]
pub(crate) const fn key_of(seed: u64) -> [u32; 2] {
    [seed as u32, (seed >> 32) as u32]
}

/// The blocks of consecutive counters as a stream of 32-bit words, through the traits of `rand_core` 0.10.
///
/// The seed is the key. A stream begins at counter 0 or at [`Philox4x32::at`], and the counter (word 0 lowest) wraps
/// after 2^128 blocks. Not for cryptography.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Philox4x32 {
    key: [u32; 2],
    counter: u128,
    block: [u32; 4],
    used: usize,
}

impl Philox4x32 {
    /// The stream of `seed` that begins with the block of `counter`.
    ///
    /// ```
    /// use fixpair::noise::philox::{Philox4x32, philox4x32_10};
    ///
    /// let stream = Philox4x32::at(0, [7, 0, 0, 0]);
    /// assert_eq!(stream.counter(), [7, 0, 0, 0]);
    /// ```
    #[must_use]
    pub fn at(seed: u64, counter: [u32; 4]) -> Self {
        let mut stream = Self { key: key_of(seed), counter: 0, block: [0; 4], used: 4 };
        stream.set_counter(counter);
        stream
    }

    /// Goes to the beginning of the block of `counter`.
    ///
    /// ```
    /// use fixpair::noise::philox::Philox4x32;
    ///
    /// let mut stream = Philox4x32::at(1, [0; 4]);
    /// stream.set_counter([9, 0, 0, 0]); // any place of the stream at once
    /// assert_eq!(stream.counter(), [9, 0, 0, 0]);
    /// ```
    pub fn set_counter(&mut self, counter: [u32; 4]) {
        self.counter = (0..4).map(|i| u128::from(counter[i]) << (32 * i)).sum();
        self.used = 4;
    }

    /// The counter of the next block that will be computed.
    ///
    /// ```
    /// use fixpair::noise::philox::Philox4x32;
    ///
    /// assert_eq!(Philox4x32::at(1, [3, 2, 1, 0]).counter(), [3, 2, 1, 0]);
    /// ```
    #[must_use]
    pub fn counter(&self) -> [u32; 4] {
        core::array::from_fn(|i| (self.counter >> (32 * i)) as u32)
    }
}

impl TryRng for Philox4x32 {
    type Error = Infallible;

    #[inline]
    fn try_next_u32(&mut self) -> Result<u32, Infallible> {
        if self.used == 4 {
            self.block = philox4x32_10(self.counter(), self.key);
            self.counter = self.counter.wrapping_add(1);
            self.used = 0;
        }
        let word = self.block[self.used];
        self.used += 1;
        Ok(word)
    }

    #[inline]
    fn try_next_u64(&mut self) -> Result<u64, Infallible> {
        utils::next_u64_via_u32(self)
    }

    fn try_fill_bytes(&mut self, bytes: &mut [u8]) -> Result<(), Infallible> {
        utils::fill_bytes_via_next_word(bytes, || self.try_next_u32())
    }
}

impl SeedableRng for Philox4x32 {
    /// The key, little-endian.
    type Seed = [u8; 8];

    fn from_seed(seed: [u8; 8]) -> Self {
        Self::at(u64::from_le_bytes(seed), [0; 4])
    }

    /// The seed is the key itself: Philox needs no mixing of similar seeds.
    fn seed_from_u64(seed: u64) -> Self {
        Self::at(seed, [0; 4])
    }
}

#[cfg(test)]
mod tests {
    use rand_core::Rng;

    use super::*;

    /// The lines "philox4x32 10" of kat_vectors in Random123 1.14.
    const KNOWN: [([u32; 4], [u32; 2], [u32; 4]); 3] = [
        ([0; 4], [0; 2], [0x6627_E8D5, 0xE169_C58D, 0xBC57_AC4C, 0x9B00_DBD8]),
        ([u32::MAX; 4], [u32::MAX; 2], [0x408F_276D, 0x41C8_3B0E, 0xA20B_C7C6, 0x6D54_51FD]),
        (
            [0x243F_6A88, 0x85A3_08D3, 0x1319_8A2E, 0x0370_7344],
            [0xA409_3822, 0x299F_31D0],
            [0xD16C_FE09, 0x94FD_CCEB, 0x5001_E420, 0x2412_6EA1],
        ),
    ];

    #[test]
    fn blocks_are_those_that_random123_publishes() {
        for (counter, key, block) in KNOWN {
            assert_eq!(philox4x32_10(counter, key), block);
        }
    }

    #[test]
    fn a_stream_is_the_blocks_of_consecutive_counters() {
        for (counter, key, block) in KNOWN {
            let seed = u64::from(key[0]) | u64::from(key[1]) << 32;
            let mut stream = Philox4x32::at(seed, counter);
            assert_eq!(stream.counter(), counter);
            assert_eq!(block.map(|_| stream.next_u32()), block);
            let next = stream.counter();
            assert_eq!(next[0], counter[0].wrapping_add(1));
            let following = philox4x32_10(next, key);
            assert_eq!(following.map(|_| stream.next_u32()), following);
            stream.set_counter(counter);
            assert_eq!(stream.next_u64(), u64::from(block[0]) | u64::from(block[1]) << 32);
            let mut bytes = [0; 6];
            stream.fill_bytes(&mut bytes);
            assert_eq!(bytes[..4], block[2].to_le_bytes());
            assert_eq!(bytes[4..], block[3].to_le_bytes()[..2]);
        }
        let mut last = Philox4x32::at(0, [u32::MAX; 4]);
        last.next_u32();
        assert_eq!(last.counter(), [0; 4], "the counter carries and wraps");
    }

    #[test]
    fn seeds_are_keys() {
        let seed = 0x0123_4567_89AB_CDEF;
        let key = [0x89AB_CDEF, 0x0123_4567];
        let first = philox4x32_10([0; 4], key)[0];
        assert_eq!(Philox4x32::seed_from_u64(seed).next_u32(), first);
        assert_eq!(Philox4x32::from_seed(u64::to_le_bytes(seed)).next_u32(), first);
    }
}
