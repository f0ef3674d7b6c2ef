//! The remainder of a division.

use core::num::NonZero;

/// Bits of the significand.
const BITS: u32 = 52;
const IMPLICIT: u64 = 1 << BITS;
/// So many bits more than a significand has a word.
const SPARE: u32 = u64::BITS - BITS - 1;

/// x - trunc(x/y) y, exactly, with the sign of x; NaN for x not finite, y = 0 or NaN.
///
/// Division by hand, a few binary digits at a time.
///
/// # Example
/// ```
/// assert_eq!(fixpair::math::fmod(-7.5, 2.0), -1.5);
/// ```
#[must_use]
pub fn fmod(x: f64, y: f64) -> f64 {
    let (size_x, size_y) = (x.abs(), y.abs());
    if !x.is_finite() || size_y.is_nan() {
        return f64::NAN;
    }
    if size_x < size_y {
        return x;
    }
    let ((x_digits, x_shift), (y_digits, y_shift)) = (split(size_x), split(size_y));
    let Some(divisor) = NonZero::new(y_digits) else { return f64::NAN };
    let mut rest = x_digits % divisor;
    let mut shift = x_shift - y_shift;
    while shift > 0 {
        let digits = shift.min(SPARE);
        rest = (rest << digits) % divisor;
        shift -= digits;
    }
    join(rest, y_shift).copysign(x)
}

/// Of a finite size: whole digits and shift, with the number digits 2^shift of the smallest subnormal.
fn split(size: f64) -> (u64, u32) {
    let bits = size.to_bits();
    match (bits >> BITS) as u32 {
        0 => (bits, 0),
        exponent => (bits % IMPLICIT + IMPLICIT, exponent - 1),
    }
}

fn join(digits: u64, shift: u32) -> f64 {
    if digits == 0 {
        return 0.0;
    }
    // Up to the implicit bit, or as far as there is shift to take.
    let up = shift.min(digits.leading_zeros() - SPARE);
    f64::from_bits((digits << up) + (u64::from(shift - up) << BITS))
}
