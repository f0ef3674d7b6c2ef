//! Sine and cosine of an angle given in turns.

/// 1.5 * 2^50: near it numbers are a quarter apart, so adding it rounds to a quarter turn.
const QUARTERS: f64 = 1_688_849_860_263_936.0;
const SIGN: u64 = 1 << 63;

/// (sin(2 pi r) - 2 pi r)/r^3 as a polynomial in r^2, for |r| <= 1/8; error of the sine 2^-58, relative.
const SINE: [f64; 6] = [
    -41.341_702_240_399_68,
    81.605_249_275_968_22,
    -76.705_859_708_784_33,
    42.058_685_506_710_32,
    -15.093_829_320_235_264,
    3.781_366_356_740_674_6,
];

/// (cos(2 pi r) - 1)/r^2 as a polynomial in r^2, for |r| <= 1/8; error of the cosine 2^-54.
const COSINE: [f64; 6] = [
    -19.739_208_802_178_513,
    64.939_394_022_413_54,
    -85.456_817_101_101_62,
    60.244_621_246_965_37,
    -26.424_316_959_360_514,
    7.811_478_063_821_716,
];

/// (sin 2 pi u, cos 2 pi u) for |u| < 2^48 turns.
///
/// The nearest quarter turn is taken off exactly (u is a multiple of its own ulp, and so is the rest), and the rest,
/// at most an eighth of a turn, goes into two polynomials. Multiples of a quarter turn give 0 and +-1 exactly. Absolute
/// error below 2.3e-16.
///
/// ```
/// use fixpair::math::sin_cos_turns;
///
/// let (sine, cosine) = sin_cos_turns(0.25); // of 2 pi u
/// assert!((sine - 1.0).abs() < 1e-15 && cosine.abs() < 1e-15);
/// ```
#[must_use]
#[inline(always)]
pub fn sin_cos_turns(u: f64) -> (f64, f64) {
    let shifted = u + QUARTERS;
    let quadrant = shifted.to_bits();
    let r = u - (shifted - QUARTERS);
    let z = r * r;
    let y = z * z;
    let (a, b) = (&SINE, &COSINE);
    let sine = (a[0] + y * (a[2] + y * a[4])) + z * (a[1] + y * (a[3] + y * a[5]));
    let sine = r * core::f64::consts::TAU + (r * z) * sine;
    let cosine = (b[0] + y * (b[2] + y * b[4])) + z * (b[1] + y * (b[3] + y * b[5]));
    let cosine = 1.0 + z * cosine;
    // Odd quadrants swap the two; the sine is negative in quadrants 2 and 3, the cosine in 1 and 2.
    let odd = (quadrant & 1).wrapping_neg();
    let (s, c) = (sine.to_bits(), cosine.to_bits());
    let swap = (s ^ c) & odd;
    let sine_sign = (quadrant << 62) & SIGN;
    let cosine_sign = (quadrant.wrapping_add(1) << 62) & SIGN;
    (f64::from_bits((s ^ swap) ^ sine_sign), f64::from_bits((c ^ swap) ^ cosine_sign))
}
