//! Four exact sums at once, for terms of like magnitude: what stands in front of [`ExactSum`]s in inner loops.
//!
//! A term v with |v| < 2^L is cut at fixed places into three parts, multiples of 2^(L-26), 2^(L-53) and 2^(L-80) that are 26 bits long at
//! most, by adding and subtracting a large number (Dekker's and Rump's extraction). Sums of up to 2^27 such parts are exact in f64, so the three
//! sums hold the sum of the terms without rounding, whatever their order. Terms that do not fit (larger ones, or those with bits below) go
//! to the exact sums directly. Either way the bits of the result are those of adding each term to an [`ExactSum`].

use super::exact::ExactSum;
use crate::scratch::Plain;
use crate::scratch::sealed::Sealed;

/// Terms between two calls of [`Front::flush`].
pub(super) const FRONT_TERMS: u64 = 1 << 26;

/// 2^27: from one part to the next.
const STEP: f64 = 134_217_728.0;

const SIGN: u64 = 1 << 63;

/// Exact sums of four numbers each. All zero is empty.
#[derive(Clone, Copy)]
#[repr(C, align(32))]
pub(super) struct Front {
    parts: [[f64; 4]; 3],
    /// 2^L, or 0 before the first term.
    limit: f64,
    unused: [f64; 3],
}

impl Sealed for Front {}
impl Plain for Front {}

impl Front {
    pub(super) const ZERO: Self = Self { parts: [[0.0; 4]; 3], limit: 0.0, unused: [0.0; 3] };

    /// Adds a term to each lane; false, and nothing is added, if one does not fit.
    #[inline(always)]
    pub(super) fn add(&mut self, term: &[f64; 4]) -> bool {
        let limit = self.limit;
        let mut place = limit * (1.5 * 67_108_864.0);
        let mut rest = *term;
        let mut parts = [[0.0; 4]; 3];
        for part in &mut parts {
            *part = core::array::from_fn(|lane| (rest[lane] + place) - place);
            rest = core::array::from_fn(|lane| rest[lane] - part[lane]);
            place *= 1.0 / STEP;
        }
        // Nothing is left, and each |term| is below the limit: positive numbers are in the order of their bits, NaN above all.
        let mut bad = 0;
        for lane in 0..4 {
            let below = (term[lane].to_bits() & !SIGN).wrapping_sub(limit.to_bits());
            bad |= rest[lane].to_bits() | (!below & SIGN);
        }
        let fits = bad == 0;
        if fits {
            for (sum, part) in self.parts.iter_mut().zip(&parts) {
                *sum = core::array::from_fn(|lane| sum[lane] + part[lane]);
            }
        }
        fits
    }

    /// Adds a term that does not fit to the exact sums of its lanes, and makes room for its like if it was too large.
    #[cold]
    #[inline(never)]
    pub(super) fn add_slowly(&mut self, term: &[f64; 4], sums: &mut [ExactSum], places: &[Option<usize>; 4]) {
        let largest = term.iter().fold(0.0_f64, |largest, x| largest.max(x.abs()));
        for (&term, place) in term.iter().zip(places) {
            if let Some(sum) = place.and_then(|place| sums.get_mut(place)) {
                sum.add(term);
            }
        }
        // Far from where an exact sum ends (2^660, 2^-640) parts and their sums are as good as terms.
        if largest >= self.limit && (1e-140..1e170).contains(&largest) {
            self.flush(sums, places);
            // 2^12 above this term, so that it is seldom raised again; terms down to 2^-16 of this one have no bit below.
            let exponent = (largest.to_bits() >> 52) + 13;
            self.limit = f64::from_bits(exponent << 52);
        }
    }

    /// Moves what it holds to the exact sums.
    pub(super) fn flush(&mut self, sums: &mut [ExactSum], places: &[Option<usize>; 4]) {
        for part in &mut self.parts {
            for (value, place) in part.iter_mut().zip(places) {
                if let Some(sum) = place.and_then(|place| sums.get_mut(place)) {
                    sum.add(*value);
                }
                *value = 0.0;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bits_are_those_of_adding_each_term_to_an_exact_sum() {
        let places = [Some(2), Some(0), None, Some(1)];
        for spread in [1, 8, 60, 900] {
            let mut front = Front::ZERO;
            let (mut fast, mut slow) = ([ExactSum::ZERO; 3], [ExactSum::ZERO; 3]);
            let mut fitted = 0;
            for i in 0..20_000_i32 {
                let draw = |lane: i32| {
                    let x = f64::from((i * 4 + lane).wrapping_mul(0x5851_f42d)) + 1.0 / 3.0;
                    libm::scalbn(x, (i * 37 + lane * 11) % spread - spread / 2 - 31)
                };
                let term = [draw(0), draw(1), 0.0, if i % 1000 == 999 { 0.0 } else { draw(3) }];
                for (&term, place) in term.iter().zip(&places) {
                    if let Some(place) = *place {
                        slow[place].add(term);
                    }
                }
                if front.add(&term) {
                    fitted += 1;
                } else {
                    front.add_slowly(&term, &mut fast, &places);
                }
            }
            front.flush(&mut fast, &places);
            fast.iter_mut().chain(&mut slow).for_each(ExactSum::carry);
            assert_eq!(fast, slow);
            assert!(spread > 8 || fitted > 19_900, "like terms fit: {fitted}");
        }
    }

    #[test]
    fn what_is_not_finite_is_not_taken() {
        let mut front = Front::ZERO;
        let places = [Some(0), None, None, None];
        for x in [f64::NAN, f64::INFINITY, 1e199] {
            let mut sums = [ExactSum::ZERO];
            let term = [x, 0.0, 0.0, 0.0];
            front.add_slowly(&[1.0, 0.0, 0.0, 0.0], &mut sums, &places);
            assert!(!front.add(&term));
            front.add_slowly(&term, &mut sums, &places);
            assert!(sums[0].is_lost());
        }
    }
}
