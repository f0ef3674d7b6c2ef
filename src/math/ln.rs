//! The logarithm of a uniform deviate.

/// Bits of 1.
const ONE: u64 = 0x3FF0_0000_0000_0000;
/// Bits of sqrt(1/2): the significand is reduced to [sqrt(1/2), sqrt(2)), where the polynomial is shortest.
const SQRT_HALF: u64 = 0x3FE6_A09E_667F_3BCD;
/// Bits of the significand.
const FRACTION: u64 = 0x000F_FFFF_FFFF_FFFF;
/// Bits of 2^52: a small integer put below them reads as 2^52 plus that integer.
const TWO_52: u64 = 0x4330_0000_0000_0000;

/// The upper 32 bits of ln 2: times a binary exponent it is exact.
const LN_2_HIGH: f64 = 0.693_147_180_369_123_816_490;
/// ln 2 less its upper bits.
const LN_2_LOW: f64 = 1.908_214_929_270_587_700_02e-10;

/// (2 atanh(s) - 2s)/s^3 as a polynomial in z = s^2, for |s| <= (sqrt(2)-1)/(sqrt(2)+1); error of the logarithm 2^-58.
const SERIES: [f64; 7] = [
    0.666_666_666_666_673_4,
    0.399_999_999_994_143_04,
    0.285_714_287_424_780_5,
    0.222_221_985_631_971_76,
    0.181_835_648_795_635_16,
    0.153_140_355_555_980_27,
    0.147_961_077_930_189_92,
];

/// -ln u for a normal positive number u; +0 at u = 1.
///
/// u = 2^e (1 + f) with 1 + f in [sqrt(1/2), sqrt(2)); with s = f/(2 + f), ln(1 + f) = 2 atanh(s) = f - f^2/2 + s (f^2/2 + R(s^2)),
/// whose first terms are exact or nearly so (the arrangement of fdlibm). Error below 1 ulp. Zero, subnormal, negative
/// and NaN arguments give a number without meaning.
///
/// ```
/// use fixpair::math::neg_ln;
///
/// assert!((neg_ln(0.5) - std::f64::consts::LN_2).abs() < 1e-15);
/// ```
#[must_use]
#[inline(always)]
pub fn neg_ln(u: f64) -> f64 {
    let shifted = u.to_bits().wrapping_add(ONE - SQRT_HALF);
    let minus_e = (TWO_52_F64 + 1023.0) - f64::from_bits((shifted >> 52) | TWO_52);
    let f = f64::from_bits((shifted & FRACTION) + SQRT_HALF) - 1.0;
    let s = f / (2.0 + f);
    let z = s * s;
    let c = &SERIES;
    // Two interleaved chains, even and odd powers, so that neither the latency nor the count of operations dominates.
    let y = z * z;
    let even = c[0] + y * (c[2] + y * (c[4] + y * c[6]));
    let odd = c[1] + y * (c[3] + y * c[5]);
    let series = z * (even + z * odd);
    let half_square = 0.5 * (f * f);
    minus_e * LN_2_HIGH + ((half_square - (s * (half_square + series) - minus_e * LN_2_LOW)) - f)
}

/// 2^52.
const TWO_52_F64: f64 = f64::from_bits(TWO_52);
