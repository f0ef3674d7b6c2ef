//! Lanes in the 256-bit registers of x86-64 processors with AVX2 and FMA: four f64 or eight f32.

use core::arch::x86_64::*;
use core::ops::{Add, Mul, Neg, Sub};

use super::lanes::{Kernel, Lanes};

/// Four columns of f64.
#[derive(Clone, Copy)]
pub(super) struct F64x4(__m256d);

/// Eight columns of f32.
#[derive(Clone, Copy)]
pub(super) struct F32x8(__m256);

/// Compiles `kernel`, and all that it inlines, with AVX2 and FMA.
///
/// # Safety
/// As [`Kernel::run`].
#[target_feature(enable = "avx2,fma")]
#[inline(never)]
unsafe fn with_avx2<K: Kernel>(kernel: K) {
    // SAFETY: the caller's.
    unsafe { kernel.run() }
}

macro_rules! arithmetic {
    ($lanes:ident, $add:ident, $sub:ident, $mul:ident, $xor:ident, $set:ident) => {
        impl Add for $lanes {
            type Output = Self;
            #[inline(always)]
            fn add(self, b: Self) -> Self {
                // SAFETY: a value exists, so the processor has AVX2.
                Self(unsafe { $add(self.0, b.0) })
            }
        }
        impl Sub for $lanes {
            type Output = Self;
            #[inline(always)]
            fn sub(self, b: Self) -> Self {
                // SAFETY: a value exists, so the processor has AVX2.
                Self(unsafe { $sub(self.0, b.0) })
            }
        }
        impl Mul for $lanes {
            type Output = Self;
            #[inline(always)]
            fn mul(self, b: Self) -> Self {
                // SAFETY: a value exists, so the processor has AVX2.
                Self(unsafe { $mul(self.0, b.0) })
            }
        }
        impl Neg for $lanes {
            type Output = Self;
            #[inline(always)]
            fn neg(self) -> Self {
                // SAFETY: a value exists, so the processor has AVX2.
                Self(unsafe { $xor(self.0, $set(-0.0)) })
            }
        }
    };
}

arithmetic!(F64x4, _mm256_add_pd, _mm256_sub_pd, _mm256_mul_pd, _mm256_xor_pd, _mm256_set1_pd);
arithmetic!(F32x8, _mm256_add_ps, _mm256_sub_ps, _mm256_mul_ps, _mm256_xor_ps, _mm256_set1_ps);

macro_rules! memory_and_fma {
    ($element:ty, $load:ident, $store:ident, $set:ident, $fma:ident, $fms:ident, $fnma:ident) => {
        #[inline(always)]
        unsafe fn load(from: *const $element) -> Self {
            // SAFETY: the caller's; the load need not be aligned.
            Self(unsafe { $load(from) })
        }

        #[inline(always)]
        unsafe fn store(self, to: *mut $element) {
            // SAFETY: the caller's; the store need not be aligned.
            unsafe { $store(to, self.0) }
        }

        #[inline(always)]
        unsafe fn broadcast(from: *const $element) -> Self {
            // SAFETY: the caller's.
            Self(unsafe { $set(*from) })
        }

        #[inline(always)]
        fn filled(self, x: f64) -> Self {
            // SAFETY: a value exists, so the processor has AVX2.
            Self(unsafe { $set(x as $element) })
        }

        #[inline(always)]
        fn mul_add(self, b: Self, c: Self) -> Self {
            // SAFETY: a value exists, so the processor has FMA.
            Self(unsafe { $fma(self.0, b.0, c.0) })
        }

        #[inline(always)]
        fn mul_sub(self, b: Self, c: Self) -> Self {
            // SAFETY: a value exists, so the processor has FMA.
            Self(unsafe { $fms(self.0, b.0, c.0) })
        }

        #[inline(always)]
        fn neg_mul_add(self, b: Self, c: Self) -> Self {
            // SAFETY: a value exists, so the processor has FMA.
            Self(unsafe { $fnma(self.0, b.0, c.0) })
        }

        #[inline(always)]
        fn prefetch(address: *const $element) {
            // SAFETY: a prefetch of any address is harmless.
            unsafe { _mm_prefetch::<_MM_HINT_T0>(address.cast()) }
        }

        #[inline(always)]
        unsafe fn enter<K: Kernel>(kernel: K) {
            // SAFETY: the caller's.
            unsafe { with_avx2(kernel) }
        }
    };
}

impl Lanes for F64x4 {
    type Element = f64;
    const COUNT: usize = 4;

    memory_and_fma!(
        f64,
        _mm256_loadu_pd,
        _mm256_storeu_pd,
        _mm256_set1_pd,
        _mm256_fmadd_pd,
        _mm256_fmsub_pd,
        _mm256_fnmadd_pd
    );

    #[inline(always)]
    unsafe fn load_columns(from: *const f64) -> (Self, Self) {
        // SAFETY: 8 elements are readable, says the caller, on a processor with AVX2.
        unsafe {
            let (a, b) = (_mm256_loadu_pd(from), _mm256_loadu_pd(from.add(4)));
            (Self(_mm256_unpacklo_pd(a, b)), Self(_mm256_unpackhi_pd(a, b)))
        }
    }

    #[inline(always)]
    unsafe fn store_columns(re: Self, im: Self, to: *mut f64) {
        // SAFETY: 8 elements are writable, says the caller, on a processor with AVX2.
        unsafe {
            _mm256_storeu_pd(to, _mm256_unpacklo_pd(re.0, im.0));
            _mm256_storeu_pd(to.add(4), _mm256_unpackhi_pd(re.0, im.0));
        }
    }

    #[inline(always)]
    unsafe fn load_rows(from: *const f64, stride: usize, to: *mut f64) {
        // SAFETY: 4 elements of 4 rows are readable and 4 vectors writable, says the caller, on a processor with AVX2.
        unsafe {
            // Halves of rows 0 and 2, or 1 and 3: they load where a full row would need a shuffle later.
            let pair = |row: usize, i: usize| {
                let low = _mm256_castpd128_pd256(_mm_loadu_pd(from.add(row * stride + i)));
                _mm256_insertf128_pd::<1>(low, _mm_loadu_pd(from.add((row + 2) * stride + i)))
            };
            for i in [0, 2] {
                let (even, odd) = (pair(0, i), pair(1, i));
                _mm256_storeu_pd(to.add(4 * i), _mm256_unpacklo_pd(even, odd));
                _mm256_storeu_pd(to.add(4 * i + 4), _mm256_unpackhi_pd(even, odd));
            }
        }
    }

    #[inline(always)]
    unsafe fn store_rows(from: *const f64, to: *mut f64, stride: usize) {
        // SAFETY: as in `load_rows`, with the rows writable.
        unsafe {
            let v = [0, 4, 8, 12].map(|i| _mm256_loadu_pd(from.add(i)));
            let (a, b) = (_mm256_unpacklo_pd(v[0], v[1]), _mm256_unpackhi_pd(v[0], v[1]));
            let (c, d) = (_mm256_unpacklo_pd(v[2], v[3]), _mm256_unpackhi_pd(v[2], v[3]));
            _mm256_storeu_pd(to, _mm256_permute2f128_pd::<0x20>(a, c));
            _mm256_storeu_pd(to.add(stride), _mm256_permute2f128_pd::<0x20>(b, d));
            _mm256_storeu_pd(to.add(2 * stride), _mm256_permute2f128_pd::<0x31>(a, c));
            _mm256_storeu_pd(to.add(3 * stride), _mm256_permute2f128_pd::<0x31>(b, d));
        }
    }
}

/// The transpose of eight rows of eight.
///
/// # Safety
/// The processor has AVX2.
#[inline(always)]
unsafe fn transposed(rows: [__m256; 8]) -> [__m256; 8] {
    // SAFETY: the caller's.
    unsafe {
        let mut pairs = rows;
        for i in [0, 2, 4, 6] {
            pairs[i] = _mm256_unpacklo_ps(rows[i], rows[i + 1]);
            pairs[i + 1] = _mm256_unpackhi_ps(rows[i], rows[i + 1]);
        }
        let mut fours = rows;
        for i in [0, 4] {
            fours[i] = _mm256_shuffle_ps::<0x44>(pairs[i], pairs[i + 2]);
            fours[i + 1] = _mm256_shuffle_ps::<0xEE>(pairs[i], pairs[i + 2]);
            fours[i + 2] = _mm256_shuffle_ps::<0x44>(pairs[i + 1], pairs[i + 3]);
            fours[i + 3] = _mm256_shuffle_ps::<0xEE>(pairs[i + 1], pairs[i + 3]);
        }
        let mut eights = rows;
        for i in 0..4 {
            eights[i] = _mm256_permute2f128_ps::<0x20>(fours[i], fours[i + 4]);
            eights[i + 4] = _mm256_permute2f128_ps::<0x31>(fours[i], fours[i + 4]);
        }
        eights
    }
}

impl Lanes for F32x8 {
    type Element = f32;
    const COUNT: usize = 8;

    memory_and_fma!(
        f32,
        _mm256_loadu_ps,
        _mm256_storeu_ps,
        _mm256_set1_ps,
        _mm256_fmadd_ps,
        _mm256_fmsub_ps,
        _mm256_fnmadd_ps
    );

    #[inline(always)]
    unsafe fn load_columns(from: *const f32) -> (Self, Self) {
        // SAFETY: 16 elements are readable, says the caller, on a processor with AVX2.
        unsafe {
            let (a, b) = (_mm256_loadu_ps(from), _mm256_loadu_ps(from.add(8)));
            (Self(_mm256_shuffle_ps::<0x88>(a, b)), Self(_mm256_shuffle_ps::<0xDD>(a, b)))
        }
    }

    #[inline(always)]
    unsafe fn store_columns(re: Self, im: Self, to: *mut f32) {
        // SAFETY: 16 elements are writable, says the caller, on a processor with AVX2.
        unsafe {
            _mm256_storeu_ps(to, _mm256_unpacklo_ps(re.0, im.0));
            _mm256_storeu_ps(to.add(8), _mm256_unpackhi_ps(re.0, im.0));
        }
    }

    #[inline(always)]
    unsafe fn load_rows(from: *const f32, stride: usize, to: *mut f32) {
        // SAFETY: 8 elements of 8 rows are readable and 8 vectors writable, says the caller, on a processor with AVX2.
        unsafe {
            let mut rows = [_mm256_setzero_ps(); 8];
            for i in 0..8 {
                rows[i] = _mm256_loadu_ps(from.add(i * stride));
            }
            let columns = transposed(rows);
            for i in 0..8 {
                _mm256_storeu_ps(to.add(8 * i), columns[i]);
            }
        }
    }

    #[inline(always)]
    unsafe fn store_rows(from: *const f32, to: *mut f32, stride: usize) {
        // SAFETY: as in `load_rows`, with the rows writable.
        unsafe {
            let mut columns = [_mm256_setzero_ps(); 8];
            for i in 0..8 {
                columns[i] = _mm256_loadu_ps(from.add(8 * i));
            }
            let rows = transposed(columns);
            for i in 0..8 {
                _mm256_storeu_ps(to.add(i * stride), rows[i]);
            }
        }
    }
}
