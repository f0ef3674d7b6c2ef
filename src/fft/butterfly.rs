//! Butterflies: discrete Fourier transforms of 1 to 8 numbers, Y_k = sum_j x_j exp(-2 pi i j k / R), in registers.

use super::lanes::{Complex, Lanes};

/// Chooses the butterfly of a radix.
pub(super) struct Radix<const R: usize>;

/// The transform of `R` complex numbers in every lane.
pub(super) trait Butterfly<V: Lanes, const R: usize> {
    /// From x to Y.
    fn transformed(x: [Complex<V>; R]) -> [Complex<V>; R];
}

impl<V: Lanes> Butterfly<V, 1> for Radix<1> {
    #[inline(always)]
    fn transformed(x: [Complex<V>; 1]) -> [Complex<V>; 1] {
        x
    }
}

impl<V: Lanes> Butterfly<V, 2> for Radix<2> {
    #[inline(always)]
    fn transformed(x: [Complex<V>; 2]) -> [Complex<V>; 2] {
        [x[0] + x[1], x[0] - x[1]]
    }
}

impl<V: Lanes> Butterfly<V, 4> for Radix<4> {
    #[inline(always)]
    fn transformed(x: [Complex<V>; 4]) -> [Complex<V>; 4] {
        let (a, b) = (x[0] + x[2], x[0] - x[2]);
        let (c, d) = (x[1] + x[3], x[1] - x[3]);
        [a + c, b.sub_i(d), a - c, b.add_i(d)]
    }
}

impl<V: Lanes> Butterfly<V, 8> for Radix<8> {
    #[inline(always)]
    fn transformed(x: [Complex<V>; 8]) -> [Complex<V>; 8] {
        let even = Radix::<4>::transformed([x[0], x[2], x[4], x[6]]);
        let odd = Radix::<4>::transformed([x[1], x[3], x[5], x[7]]);
        // odd[1] exp(-i pi/4) = s p and odd[3] exp(-3 i pi/4) = s (q.re, -q.im), with s = sqrt(1/2).
        let s = x[0].re.filled(core::f64::consts::FRAC_1_SQRT_2);
        let p = Complex { re: odd[1].re + odd[1].im, im: odd[1].im - odd[1].re };
        let q = Complex { re: odd[3].im - odd[3].re, im: odd[3].re + odd[3].im };
        let (e1, e3) = (even[1], even[3]);
        [
            even[0] + odd[0],
            Complex { re: s.mul_add(p.re, e1.re), im: s.mul_add(p.im, e1.im) },
            even[2].sub_i(odd[2]),
            Complex { re: s.mul_add(q.re, e3.re), im: s.neg_mul_add(q.im, e3.im) },
            even[0] - odd[0],
            Complex { re: s.neg_mul_add(p.re, e1.re), im: s.neg_mul_add(p.im, e1.im) },
            even[2].add_i(odd[2]),
            Complex { re: s.neg_mul_add(q.re, e3.re), im: s.mul_add(q.im, e3.im) },
        ]
    }
}

/// An odd radix R = 2 H + 1 from its H cosines and sines of 2 pi k/R: with a_j = x_j + x_(R-j) and b_j = x_j - x_(R-j),
/// Y_k = m_k - i s_k and Y_(R-k) = m_k + i s_k, m_k = x_0 + sum cos(jk) a_j, s_k = sum sin(jk) b_j.
#[inline(always)]
fn odd<V: Lanes, const R: usize, const H: usize>(
    x: [Complex<V>; R],
    cos: [f64; H],
    sin: [f64; H],
) -> [Complex<V>; R] {
    let mut a = [x[0]; H];
    let mut b = [x[0]; H];
    let mut y = x;
    for j in 0..H {
        a[j] = x[j + 1] + x[R - 1 - j];
        b[j] = x[j + 1] - x[R - 1 - j];
        y[0] = y[0] + a[j];
    }
    for k in 1..=H {
        // The angle of term j is 2 pi j k/R, brought to the first half turn.
        let (c, s) = (x[0].re.filled(cos[k - 1]), x[0].re.filled(sin[k - 1]));
        let mut m = Complex { re: c.mul_add(a[0].re, x[0].re), im: c.mul_add(a[0].im, x[0].im) };
        let mut n = Complex { re: s * b[0].re, im: s * b[0].im };
        for j in 1..H {
            let turn = (j + 1) * k % R;
            let (index, sign) = if turn > H { (R - turn, -1.0) } else { (turn, 1.0) };
            let (c, s) = (x[0].re.filled(cos[index - 1]), x[0].re.filled(sign * sin[index - 1]));
            m = Complex { re: c.mul_add(a[j].re, m.re), im: c.mul_add(a[j].im, m.im) };
            n = Complex { re: s.mul_add(b[j].re, n.re), im: s.mul_add(b[j].im, n.im) };
        }
        y[k] = m.sub_i(n);
        y[R - k] = m.add_i(n);
    }
    y
}

const COS_3: [f64; 1] = [-0.5];
const SIN_3: [f64; 1] = [0.866_025_403_784_438_6];
const COS_5: [f64; 2] = [0.309_016_994_374_947_4, -0.809_016_994_374_947_5];
const SIN_5: [f64; 2] = [0.951_056_516_295_153_5, 0.587_785_252_292_473_1];
const COS_7: [f64; 3] = [0.623_489_801_858_733_5, -0.222_520_933_956_314_4, -0.900_968_867_902_419_1];
const SIN_7: [f64; 3] = [0.781_831_482_468_029_8, 0.974_927_912_181_823_6, 0.433_883_739_117_558_1];

impl<V: Lanes> Butterfly<V, 3> for Radix<3> {
    #[inline(always)]
    fn transformed(x: [Complex<V>; 3]) -> [Complex<V>; 3] {
        odd(x, COS_3, SIN_3)
    }
}

impl<V: Lanes> Butterfly<V, 5> for Radix<5> {
    #[inline(always)]
    fn transformed(x: [Complex<V>; 5]) -> [Complex<V>; 5] {
        odd(x, COS_5, SIN_5)
    }
}

impl<V: Lanes> Butterfly<V, 7> for Radix<7> {
    #[inline(always)]
    fn transformed(x: [Complex<V>; 7]) -> [Complex<V>; 7] {
        odd(x, COS_7, SIN_7)
    }
}

impl<V: Lanes> Butterfly<V, 6> for Radix<6> {
    /// Good and Thomas: 6 = 2 x 3 without twiddles, j = 3 j2 + 2 j3, so that k mod 3 and k mod 2 separate.
    #[inline(always)]
    fn transformed(x: [Complex<V>; 6]) -> [Complex<V>; 6] {
        let e = Radix::<3>::transformed([x[0], x[2], x[4]]);
        let o = Radix::<3>::transformed([x[3], x[5], x[1]]);
        [e[0] + o[0], e[1] - o[1], e[2] + o[2], e[0] - o[0], e[1] + o[1], e[2] - o[2]]
    }
}

#[cfg(test)]
mod tests {
    use super::super::lanes::Portable;
    use super::*;

    #[test]
    fn constants_are_the_cosines_and_sines() {
        for (r, cos, sin) in [(3, &COS_3[..], &SIN_3[..]), (5, &COS_5, &SIN_5), (7, &COS_7, &SIN_7)] {
            for (k, (&c, &s)) in cos.iter().zip(sin).enumerate() {
                let angle = core::f64::consts::TAU * (k + 1) as f64 / f64::from(r);
                assert!((libm::cos(angle) - c).abs() < 3e-16 && (libm::sin(angle) - s).abs() < 3e-16);
            }
        }
    }

    fn check<const R: usize>()
    where
        Radix<R>: Butterfly<Portable<f64, 1>, R>,
    {
        let value = |x: f64| {
            // SAFETY: one element is readable.
            unsafe { Portable::<f64, 1>::load(&raw const x) }
        };
        let number = |v: Portable<f64, 1>| {
            let mut x = 0.0;
            // SAFETY: one element is writable.
            unsafe { v.store(&raw mut x) };
            x
        };
        let x: [(f64, f64); R] = core::array::from_fn(|j| (1.0 + j as f64, 0.5 - (j * j) as f64));
        let y = Radix::<R>::transformed(x.map(|(re, im)| Complex { re: value(re), im: value(im) }));
        for (k, y) in y.into_iter().enumerate() {
            let (mut re, mut im) = (0.0, 0.0);
            for (j, (a, b)) in x.into_iter().enumerate() {
                let angle = core::f64::consts::TAU * (j * k % R) as f64 / R as f64;
                let (s, c) = libm::sincos(angle);
                re += a * c + b * s;
                im += b * c - a * s;
            }
            // Inputs are below 50, sums have R terms.
            assert!((number(y.re) - re).abs() < 1e-13 && (number(y.im) - im).abs() < 1e-13, "{R} {k}");
        }
    }

    #[test]
    fn each_butterfly_is_the_discrete_fourier_transform() {
        check::<1>();
        check::<2>();
        check::<3>();
        check::<4>();
        check::<5>();
        check::<6>();
        check::<7>();
        check::<8>();
    }
}
