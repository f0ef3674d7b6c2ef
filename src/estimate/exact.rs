//! Sums without rounding, so that parts of a mesh add up to the whole bit for bit.
//!
//! A sum is an integer times 2^-640, in limbs of 32 bits that lie in 64-bit integers: adding the integers of two sums, one by one,
//! adds the sums, in any order and on any number of ranks (`MPI_INT64_T`, `MPI_SUM`). Terms of magnitude below 2^660 are taken
//! exactly down to 2^-640 (1e198 and 1e-193: the squares of all f32), what lies below is cut off. After Kulisch's long accumulator.

use crate::scratch::Plain;
use crate::scratch::sealed::Sealed;

/// Limbs that hold the value: limb i counts 2^(32 i - 640).
const VALUE: usize = 41;

/// 2^-[`BIAS`] is the unit of limb 0.
const BIAS: i32 = 640;

/// Terms that an [`ExactSum`] takes between two calls of [`ExactSum::carry`].
pub const TERMS: u64 = 1 << 30;

/// A sum of f64 numbers, exact and independent of their order. All zero is an empty sum.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(C)]
pub struct ExactSum {
    value: [i64; VALUE],
    /// Terms that were NaN, infinite or beyond 2^660.
    lost: i64,
}

// Integers without padding: any bits are a sum.
impl Sealed for ExactSum {}
impl Plain for ExactSum {}

const _: () = assert!(size_of::<ExactSum>() == 8 * ExactSum::WORDS);

impl ExactSum {
    /// The empty sum.
    pub const ZERO: Self = Self { value: [0; VALUE], lost: 0 };

    /// 64-bit integers in a sum.
    pub const WORDS: usize = VALUE + 1;

    /// The sums that lie in an array of integers, [`ExactSum::WORDS`] each; what is left over is not seen.
    ///
    /// ```
    /// use fixpair::estimate::exact::ExactSum;
    ///
    /// let mut words = [0_i64; 2 * ExactSum::WORDS]; // what MPI adds
    /// assert_eq!(ExactSum::in_words(&mut words).len(), 2);
    /// ```
    #[must_use]
    pub const fn in_words(words: &mut [i64]) -> &mut [Self] {
        let (sums, _) = words.as_chunks_mut::<{ Self::WORDS }>();
        // SAFETY: a sum is WORDS integers, with their alignment and without padding.
        unsafe { core::slice::from_raw_parts_mut(sums.as_mut_ptr().cast::<Self>(), sums.len()) }
    }

    /// As [`ExactSum::in_words`], to read.
    ///
    /// ```
    /// use fixpair::estimate::exact::ExactSum;
    ///
    /// assert_eq!(ExactSum::of_words(&[0_i64; ExactSum::WORDS])[0].value(), 0.0);
    /// ```
    #[must_use]
    pub const fn of_words(words: &[i64]) -> &[Self] {
        let (sums, _) = words.as_chunks::<{ Self::WORDS }>();
        // SAFETY: a sum is WORDS integers, with their alignment and without padding.
        unsafe { core::slice::from_raw_parts(sums.as_ptr().cast::<Self>(), sums.len()) }
    }

    /// Was a term NaN, infinite or beyond 2^660?
    ///
    /// ```
    /// use fixpair::estimate::exact::ExactSum;
    ///
    /// let mut sum = ExactSum::ZERO;
    /// sum.add(f64::NAN);
    /// assert!(sum.is_lost());
    /// ```
    #[must_use]
    pub const fn is_lost(&self) -> bool {
        self.lost != 0
    }

    /// Adds a term. At most [`TERMS`] of them may follow one another without a [`ExactSum::carry`].
    ///
    /// ```
    /// use fixpair::estimate::exact::ExactSum;
    ///
    /// let mut sum = ExactSum::ZERO;
    /// for term in [1e30, 1.0, -1e30] {
    ///     sum.add(term);
    /// }
    /// assert_eq!(sum.value(), 1.0); // rounded once
    /// ```
    #[inline]
    pub fn add(&mut self, term: f64) {
        let bits = term.to_bits();
        let exponent = (bits >> 52 & 0x7ff) as i32;
        let fraction = bits & ((1 << 52) - 1);
        // A denormal counts the same units as the smallest normal number, without its leading bit.
        let place = exponent.max(1) - 1075 + BIAS;
        let mantissa = if exponent == 0 { fraction } else { fraction | 1 << 52 };
        if place < 0 {
            let kept = mantissa.checked_shr(place.unsigned_abs()).unwrap_or(0) as i64;
            self.value[0] += (if term < 0.0 { -kept } else { kept }) & 0xffff_ffff;
            self.value[1] += (if term < 0.0 { -kept } else { kept }) >> 32;
            return;
        }
        let (limb, shift) = (place as usize / 32, place as u32 % 32);
        let Some([low, middle, high]) = self.value.get_mut(limb..limb + 3) else {
            self.lost += 1;
            return;
        };
        let wide = u128::from(mantissa) << shift;
        let sign = if term < 0.0 { -1 } else { 1 };
        *low += sign * (wide as u32 as i64);
        *middle += sign * ((wide >> 32) as u32 as i64);
        *high += sign * ((wide >> 64) as i64);
    }

    /// Adds another sum.
    ///
    /// ```
    /// use fixpair::estimate::exact::ExactSum;
    ///
    /// let mut sum = ExactSum::ZERO;
    /// let mut other = sum;
    /// sum.add(1.0);
    /// other.add(2.0);
    /// sum.merge(&other);
    /// assert_eq!(sum.value(), 3.0);
    /// ```
    #[inline]
    pub fn merge(&mut self, other: &Self) {
        for (sum, term) in self.value.iter_mut().zip(&other.value) {
            *sum = sum.wrapping_add(*term);
        }
        self.lost = self.lost.wrapping_add(other.lost);
    }

    /// Brings the limbs into [0, 2^32), the last one apart: the one form that each value has.
    ///
    /// ```
    /// use fixpair::estimate::exact::ExactSum;
    ///
    /// let mut sum = ExactSum::ZERO;
    /// sum.add(1.5);
    /// sum.carry(); // makes room for more terms, and changes no value
    /// assert_eq!(sum.value(), 1.5);
    /// ```
    pub fn carry(&mut self) {
        let mut carry = 0;
        for limb in &mut self.value[..VALUE - 1] {
            let sum = limb.wrapping_add(carry);
            *limb = sum & 0xffff_ffff;
            carry = sum >> 32;
        }
        self.value[VALUE - 1] = self.value[VALUE - 1].wrapping_add(carry);
    }

    /// The sum, rounded once to the nearest f64; NaN if a term was not finite or too large.
    ///
    /// ```
    /// use fixpair::estimate::exact::ExactSum;
    ///
    /// let mut sum = ExactSum::ZERO;
    /// sum.add(0.1);
    /// sum.add(0.2);
    /// assert_eq!(sum.value(), 0.1 + 0.2);
    /// ```
    #[must_use]
    pub fn value(&self) -> f64 {
        if self.lost != 0 {
            return f64::NAN;
        }
        let mut sum = *self;
        sum.carry();
        let negative = sum.value[VALUE - 1] < 0;
        if negative {
            sum.value.iter_mut().for_each(|limb| *limb = limb.wrapping_neg());
            sum.carry();
        }
        let Some(top) = sum.value.iter().rposition(|&limb| limb != 0) else {
            return 0.0;
        };
        // 65 bits or more, and no more than 127 even of a last limb that took carries: rounding them once is rounding the sum once, given a last
        // bit that stands for all below.
        let first = top.saturating_sub(2);
        let mut wide =
            sum.value[first..=top].iter().rev().fold(0_u128, |wide, &limb| wide << 32 | limb as u128);
        if sum.value[..first].iter().any(|&limb| limb != 0) {
            wide |= 1;
        }
        let magnitude = libm::scalbn(wide as f64, 32 * first as i32 - BIAS);
        if negative { -magnitude } else { magnitude }
    }
}

#[cfg(test)]
mod tests {
    use std::vec::Vec;

    use super::*;

    fn sum(terms: impl IntoIterator<Item = f64>) -> ExactSum {
        let mut sum = ExactSum::ZERO;
        terms.into_iter().for_each(|term| sum.add(term));
        sum.carry();
        sum
    }

    /// Numbers of both signs over 2^-200 .. 2^200.
    fn terms() -> Vec<f64> {
        (0..2000_i32)
            .map(|i| {
                let x = f64::from(i.wrapping_mul(0x5851_f42d) >> 3) + 0.123;
                libm::scalbn(x, (i * 37) % 400 - 230)
            })
            .collect()
    }

    #[test]
    fn one_term_comes_back_as_it_was() {
        for x in [
            0.0,
            1.0,
            -1.0,
            1.0 / 3.0,
            -1e300_f64.sqrt(),
            1e-150,
            f64::from(f32::MIN_POSITIVE).powi(2),
            2.5e197,
        ] {
            assert_eq!(sum([x]).value().to_bits(), x.to_bits(), "{x:e}");
        }
        assert_eq!(sum([f64::MIN_POSITIVE, 5e-324]).value(), 0.0, "far below 2^-640");
    }

    #[test]
    fn order_and_grouping_do_not_matter() {
        let terms = terms();
        let forward = sum(terms.iter().copied());
        assert_eq!(sum(terms.iter().rev().copied()), forward);
        for parts in [2, 7, 100] {
            let mut merged = ExactSum::ZERO;
            terms.chunks(parts).for_each(|part| merged.merge(&sum(part.iter().copied())));
            merged.carry();
            assert_eq!(merged, forward);
        }
    }

    #[test]
    fn the_result_is_rounded_once() {
        assert_eq!(sum([1e100, 1.0, -1e100]).value(), 1.0);
        assert_eq!(sum([1.0, 1e-30, -1.0]).value(), 1e-30);
        let half_ulp = f64::EPSILON / 2.0;
        assert_eq!(sum([1.0, half_ulp]).value(), 1.0, "ties go to even");
        assert_eq!(sum([1.0, half_ulp, 1e-150]).value(), 1.0 + f64::EPSILON, "beyond the tie");
        assert_eq!(sum([-1.0, -half_ulp, -1e-150]).value(), -1.0 - f64::EPSILON);
        let terms = terms();
        assert_eq!(sum(terms.iter().map(|x| -x)).value(), -sum(terms.iter().copied()).value());
        assert_eq!(sum(terms.iter().flat_map(|&x| [x, -x])).value(), 0.0);
    }

    #[test]
    fn many_of_the_largest_terms_are_summed_exactly() {
        for count in [1000, 5000, 1 << 20] {
            assert_eq!(
                sum((0..count).map(|_| libm::scalbn(1.0, 659))).value(),
                f64::from(count) * libm::scalbn(1.0, 659)
            );
            assert_eq!(
                sum((0..count).map(|_| -libm::scalbn(1.0, 659))).value(),
                -f64::from(count) * libm::scalbn(1.0, 659)
            );
        }
    }

    #[test]
    fn what_lies_below_the_unit_is_cut_off_towards_zero() {
        let unit = libm::scalbn(1.0, -BIAS);
        assert_eq!(sum([1.75 * unit]).value(), unit);
        assert_eq!(sum([-1.75 * unit]).value(), -unit);
        assert_eq!(sum([-0.75 * unit]).value(), 0.0);
    }

    #[test]
    fn a_lost_term_is_never_silent() {
        for x in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, f64::MAX, 1e199] {
            let mut merged = sum([1.0]);
            merged.merge(&sum([x, 2.0]));
            assert!(merged.value().is_nan(), "{x:e}");
        }
    }
}
