//! Adaptive quadrature without a heap.
//!
//! The interval with the largest error estimate is halved until the estimates sum to less than the tolerance. On each interval
//! the 21-point Kronrod rule gives the value and its distance from the 10-point Gauss rule the error (Kronrod 1965; nodes and weights
//! as tabulated in Piessens et al. 1983, QUADPACK). That estimate is far above the true error of a smooth integrand.

use crate::status::{Error, Result};
use crate::within::Within;

/// The most intervals that are kept (32 bytes each, on the stack).
const INTERVALS: usize = 256;

/// Kronrod's nodes in 0..1, outermost first; the odd entries are Gauss's. The node 0 follows them.
const NODES: [f64; 10] = [
    0.995_657_163_025_808_080_74,
    0.973_906_528_517_171_720_08,
    0.930_157_491_355_708_226_00,
    0.865_063_366_688_984_510_73,
    0.780_817_726_586_416_897_06,
    0.679_409_568_299_024_406_23,
    0.562_757_134_668_604_683_34,
    0.433_395_394_129_247_190_80,
    0.294_392_862_701_460_198_13,
    0.148_874_338_981_631_210_88,
];
const KRONROD: [f64; 10] = [
    0.011_694_638_867_371_874_28,
    0.032_558_162_307_964_727_48,
    0.054_755_896_574_351_996_03,
    0.075_039_674_810_919_952_77,
    0.093_125_454_583_697_605_54,
    0.109_387_158_802_297_641_90,
    0.123_491_976_262_065_851_08,
    0.134_709_217_311_473_325_93,
    0.142_775_938_577_060_080_80,
    0.147_739_104_901_338_491_37,
];
const KRONROD_CENTRE: f64 = 0.149_445_554_002_916_905_66;
const GAUSS: [f64; 5] = [
    0.066_671_344_308_688_137_59,
    0.149_451_349_150_580_593_15,
    0.219_086_362_515_982_044_00,
    0.269_266_719_309_996_355_09,
    0.295_524_224_714_752_870_17,
];

#[derive(Clone, Copy)]
struct Interval {
    from: f64,
    to: f64,
    value: f64,
    error: f64,
}

impl Interval {
    fn new(f: &mut impl FnMut(f64) -> f64, from: f64, to: f64) -> Result<Self> {
        let (centre, half) = (0.5 * (from + to), 0.5 * (to - from));
        let mut kronrod = KRONROD_CENTRE * f(centre);
        let mut gauss = 0.0;
        for i in 0..10 {
            let pair = f(centre - half * NODES[i]) + f(centre + half * NODES[i]);
            kronrod += KRONROD[i] * pair;
            if i % 2 == 1 {
                gauss += GAUSS[i / 2] * pair;
            }
        }
        if !kronrod.is_finite() {
            return Err(Error::NotFinite);
        }
        Ok(Self { from, to, value: half * kronrod, error: libm::fabs(half * (kronrod - gauss)) })
    }
}

/// The integral of `f` from `from` to `to`, to a relative error of `tolerance` (1e-14 ..= 0.1).
///
/// # Errors
/// `NotFinite` if a limit or a value of `f` is; `Range` if the tolerance is not in its range; `Convergence` if 256 intervals do not
/// reach it.
///
/// Cost: 21 evaluations of `f` for the first interval and 42 for each halving.
///
/// # Example
/// ```
/// use fixpair::cosmology::quadrature::integrate;
///
/// let third = integrate(|x| x * x, 0.0, 1.0, 1e-12)?;
/// assert!((third - 1.0 / 3.0).abs() < 1e-12);
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn integrate(mut f: impl FnMut(f64) -> f64, from: f64, to: f64, tolerance: f64) -> Result<f64> {
    if !(from.is_finite() && to.is_finite() && (to - from).is_finite()) {
        return Err(Error::NotFinite);
    }
    if !(1e-14..=0.1).contains(&tolerance) {
        return Err(Error::Range);
    }
    let first = Interval::new(&mut f, from, to)?;
    let mut intervals = [first; INTERVALS];
    let mut count = 1;
    loop {
        let (mut value, mut error) = (0.0, 0.0);
        let (mut worst, mut largest) = (0, intervals[0].error);
        for (i, interval) in intervals.iter().take(count).enumerate() {
            value += interval.value;
            error += interval.error;
            if interval.error > largest {
                (worst, largest) = (i, interval.error);
            }
        }
        if error <= tolerance * libm::fabs(value) {
            return Ok(value);
        }
        if count == INTERVALS {
            return Err(Error::Convergence);
        }
        let Some(halved) = intervals.get_mut(worst) else { return Err(Error::Convergence) };
        let Interval { from, to, .. } = *halved;
        let middle = 0.5 * (from + to);
        *halved = Interval::new(&mut f, from, middle)?;
        intervals.put(count, Interval::new(&mut f, middle, to)?);
        count += 1;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn polynomials_of_degree_31_are_exact_at_once() {
        let mut calls = 0;
        let power = |n: i32, x: f64| x.powi(n);
        for n in 0..=31 {
            let interval = Interval::new(&mut |x| power(n, x), 0.0, 2.0).unwrap();
            let exact = 2_f64.powi(n + 1) / f64::from(n + 1);
            // Rounding of 21 products.
            assert!((interval.value / exact - 1.0).abs() < 4e-15, "{n}: {}", interval.value / exact - 1.0);
        }
        let sum = integrate(
            |x| {
                calls += 1;
                power(19, x)
            },
            0.0,
            2.0,
            1e-13,
        )
        .unwrap();
        assert!((sum / (2_f64.powi(20) / 20.0) - 1.0).abs() < 4e-15);
        assert_eq!(calls, 21, "the Gauss rule is exact to degree 19, so there is nothing to halve");
    }

    #[test]
    fn kinks_and_peaks_are_found() {
        let kink = integrate(|x| (x - 0.3).abs(), 0.0, 1.0, 1e-10).unwrap();
        assert!((kink - (0.045 + 0.245)).abs() < 1e-10);
        let peak = integrate(|x| 1e-4 / (1e-8 + x * x), -1.0, 2.0, 1e-10).unwrap();
        let exact = (1e4_f64).atan() + (2e4_f64).atan();
        assert!((peak / exact - 1.0).abs() < 1e-10);
    }

    #[test]
    fn reversed_limits_change_the_sign() {
        let (there, back) = (integrate(f64::exp, 0.0, 1.0, 1e-12), integrate(f64::exp, 1.0, 0.0, 1e-12));
        assert!((there.unwrap() + back.unwrap()).abs() < 1e-15);
    }

    #[test]
    fn failures_are_told_apart() {
        assert_eq!(integrate(|x| 1.0 / x, -1.0, 1.0, 1e-6), Err(Error::NotFinite));
        assert_eq!(integrate(|x| (1e6 * x).sin(), 0.0, 1.0, 1e-9), Err(Error::Convergence));
        assert_eq!(integrate(|x| x, 0.0, f64::INFINITY, 1e-6), Err(Error::NotFinite));
        assert_eq!(integrate(|x| x, 0.0, 1.0, 0.0), Err(Error::Range));
        assert_eq!(integrate(|_| 0.0, 0.0, 1.0, 1e-6), Ok(0.0));
    }
}
