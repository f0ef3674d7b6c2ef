//! The square root: correctly rounded by IEEE 754, so one answer everywhere; only its instruction differs.

/// sqrt(x).
///
/// ```
/// use fixpair::math::sqrt;
///
/// assert_eq!(sqrt(2.0), 2.0_f64.sqrt()); // without std
/// ```
#[must_use]
#[inline(always)]
pub fn sqrt(x: f64) -> f64 {
    let mut pair = [x; 2];
    sqrt_in_place(&mut pair);
    pair[0]
}

/// Replaces each value by its square root.
///
/// ```
/// use fixpair::math::sqrt_in_place;
///
/// let mut x = [4.0, 9.0];
/// sqrt_in_place(&mut x);
/// assert_eq!(x, [2.0, 3.0]);
/// ```
#[inline(always)]
pub fn sqrt_in_place<const N: usize>(x: &mut [f64; N]) {
    let (pairs, rest) = x.as_chunks_mut::<2>();
    for pair in pairs {
        #[cfg(target_arch = "x86_64")]
        {
            use core::arch::x86_64::{_mm_loadu_pd, _mm_sqrt_pd, _mm_storeu_pd};
            // SAFETY: SSE2 belongs to x86-64; the loads and stores cover the two values of `pair`.
            unsafe {
                _mm_storeu_pd(pair.as_mut_ptr(), _mm_sqrt_pd(_mm_loadu_pd(pair.as_ptr())));
            }
        }
        #[cfg(not(target_arch = "x86_64"))]
        {
            *pair = pair.map(libm::sqrt);
        }
    }
    for value in rest {
        *value = sqrt(*value);
    }
}
