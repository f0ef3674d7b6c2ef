use super::*;

/// An unevaluated sum of two numbers, of about 106 bits: the oracle of this room.
#[derive(Clone, Copy)]
struct Twofold(f64, f64);

impl Twofold {
    fn add(self, other: Self) -> Self {
        let sum = self.0 + other.0;
        let part = sum - self.0;
        let error = (self.0 - (sum - part)) + (other.0 - part);
        Self::renormalised(sum, error + self.1 + other.1)
    }

    fn mul(self, other: Self) -> Self {
        let product = self.0 * other.0;
        let error = libm::fma(self.0, other.0, -product);
        Self::renormalised(product, error + self.0 * other.1 + self.1 * other.0)
    }

    fn div(self, other: Self) -> Self {
        let first = self.0 / other.0;
        let rest = self.add(other.mul(Self(-first, 0.0)));
        Self::renormalised(first, rest.0 / other.0)
    }

    fn renormalised(high: f64, low: f64) -> Self {
        let sum = high + low;
        Self(sum, low - (sum - high))
    }

    /// `x - self`.
    fn error_of(self, x: f64) -> f64 {
        (x - self.0) - self.1
    }
}

const LN_2: Twofold = Twofold(core::f64::consts::LN_2, 2.319_046_813_846_299_6e-17);
const TAU: Twofold = Twofold(core::f64::consts::TAU, 2.449_293_598_294_706_4e-16);

/// -ln u = -e ln 2 - 2 atanh((m-1)/(m+1)), summed until the terms vanish.
fn slow_neg_ln(u: f64) -> Twofold {
    let (mut m, mut e) = libm::frexp(u);
    if m < core::f64::consts::FRAC_1_SQRT_2 {
        (m, e) = (2.0 * m, e - 1);
    }
    let s = Twofold(m - 1.0, 0.0).div(Twofold(m, 0.0).add(Twofold(1.0, 0.0)));
    let square = s.mul(s);
    let (mut sum, mut power) = (Twofold(0.0, 0.0), s.mul(Twofold(-2.0, 0.0)));
    for odd in (1..60).step_by(2) {
        sum = sum.add(power.div(Twofold(f64::from(odd), 0.0)));
        power = power.mul(square);
    }
    LN_2.mul(Twofold(f64::from(-e), 0.0)).add(sum)
}

/// (sin, cos) of 2 pi r, |r| <= 1/2, by their Taylor series.
fn slow_sin_cos(r: f64) -> (Twofold, Twofold) {
    let x = TAU.mul(Twofold(r, 0.0));
    let (mut sine, mut cosine) = (Twofold(0.0, 0.0), Twofold(0.0, 0.0));
    let mut term = Twofold(1.0, 0.0);
    for k in 0..44 {
        let signed = if k % 4 < 2 { term } else { Twofold(-term.0, -term.1) };
        if k % 2 == 0 {
            cosine = cosine.add(signed);
        } else {
            sine = sine.add(signed);
        }
        term = term.mul(x).div(Twofold(f64::from(k + 1), 0.0));
    }
    (sine, cosine)
}

fn ulp(x: f64) -> f64 {
    let x = x.abs();
    f64::from_bits(x.to_bits() + 1) - x
}

/// Multiples of 2^-53 in (0, 1], and their shifts towards 0, where logarithms are large.
fn uniforms(count: usize) -> impl Iterator<Item = f64> {
    (0..count).map(move |i| {
        // Multiples of the golden ratio fill the interval evenly.
        let bits = ((i as u64 + 1).wrapping_mul(0x9E37_79B9_7F4A_7C15) >> 11) + 1;
        (bits >> if i % 4 == 0 { i % 53 } else { 0 }).max(1) as f64 / (1_u64 << 53) as f64
    })
}

#[test]
fn neg_ln_is_within_one_ulp() {
    let root = core::f64::consts::FRAC_1_SQRT_2;
    let step = 1.0 / (1_u64 << 53) as f64;
    let corners =
        [step, 2.0 * step, 3.0 * step, root - step, root, root + step, 1.0 - step, 1.0 - 2.0 * step];
    let powers = (1..53).map(|e| 1.0 / (1_u64 << e) as f64);
    let mut worst = 0.0_f64;
    for u in uniforms(200_000).chain(corners).chain(powers) {
        let exact = slow_neg_ln(u);
        if exact.0 != 0.0 {
            worst = worst.max((exact.error_of(neg_ln(u)) / ulp(exact.0)).abs());
        }
        assert!((neg_ln(u) + libm::log(u)).abs() <= 2.0 * ulp(exact.0), "libm is another witness");
    }
    assert!(worst < 1.0, "{worst} ulp");
    assert_eq!(neg_ln(1.0).to_bits(), 0, "+0");
}

#[test]
fn sin_cos_turns_is_within_a_unit_of_its_last_place_at_one() {
    // Half an ulp of the last sum, 2^-54.1 of the polynomial, and the roundings inside it.
    let bound = 2.3e-16;
    let mut worst = 0.0_f64;
    for u in uniforms(100_000) {
        let (sine, cosine) = sin_cos_turns(u);
        let r = if u > 0.5 { u - 1.0 } else { u };
        let (s, c) = slow_sin_cos(r);
        worst = worst.max(s.error_of(sine).abs()).max(c.error_of(cosine).abs());
    }
    assert!(worst < bound, "{worst}");
}

#[test]
fn small_angles_keep_their_relative_accuracy() {
    for e in 4..60 {
        for u in [1.0, 1.3, 1.7].map(|m| m / (1_u64 << e) as f64) {
            let (s, _) = slow_sin_cos(u);
            let error = s.error_of(sin_cos_turns(u).0).abs() / ulp(s.0);
            assert!(error < 1.5, "{u}: {error} ulp");
        }
    }
}

#[test]
fn quarter_turns_are_exact() {
    for (u, sine, cosine) in [
        (0.0, 0.0, 1.0),
        (0.25, 1.0, 0.0),
        (0.5, 0.0, -1.0),
        (0.75, -1.0, 0.0),
        (1.0, 0.0, 1.0),
        (-0.25, -1.0, 0.0),
    ] {
        assert_eq!(sin_cos_turns(u), (sine, cosine), "{u}");
    }
    // At the eighths, where the quadrants meet, nothing jumps.
    for eighth in [0.125, 0.375, 0.625, 0.875] {
        let (below, above) = (sin_cos_turns(eighth - 1e-16), sin_cos_turns(eighth + 1e-16));
        assert!((below.0 - above.0).abs() < 2e-15 && (below.1 - above.1).abs() < 2e-15);
    }
}

#[test]
fn sqrt_is_correctly_rounded() {
    let mut x: [f64; 7] = [0.0, 1.0, 2.0, 1e-300, 1e300, 36.7, f64::MIN_POSITIVE];
    let expected = x.map(f64::sqrt);
    assert_eq!(x.map(sqrt), expected);
    sqrt_in_place(&mut x);
    assert_eq!(x, expected);
}

#[test]
fn remainders_are_those_of_libm_bit_by_bit() {
    let check = |x: f64, y: f64| {
        let (ours, expected) = (fmod(x, y), libm::fmod(x, y));
        let same = ours.to_bits() == expected.to_bits() || (ours.is_nan() && expected.is_nan());
        assert!(same, "{x:e} modulo {y:e}: {ours:e} instead of {expected:e}");
    };
    let special =
        [0.0, 5e-324, 2e-308, f64::MIN_POSITIVE, 0.1, 1.0, 1.5, 3.0, 1e300, f64::MAX, f64::INFINITY];
    for x in special.into_iter().chain([f64::NAN]) {
        for y in special.into_iter().chain([f64::NAN]) {
            [(x, y), (-x, y), (x, -y), (-x, -y)].into_iter().for_each(|(x, y)| check(x, y));
        }
    }
    let mut state = 1_u64;
    let mut bits = || {
        // The upper bits of two steps of a linear congruence.
        let mut step = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            state >> 32
        };
        step() << 32 | step()
    };
    for _ in 0..500_000 {
        let (x, y) = (bits(), bits());
        check(f64::from_bits(x), f64::from_bits(y));
        // Near in size; subnormal; a subnormal divisor; whole multiples.
        let near = f64::from_bits((x >> 1).wrapping_add(y >> 6) >> 1);
        check(near, f64::from_bits(x >> 2));
        check(f64::from_bits(x >> 12), f64::from_bits(y >> (12 + x % 52)));
        check(f64::from_bits(x), f64::from_bits(y >> (12 + x % 52)));
        let y = f64::from_bits(y >> 2);
        check((x % 1000) as f64 * y, y);
    }
}
