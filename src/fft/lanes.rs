//! Lanes: one number from each of several columns that are transformed side by side.
//!
//! The kernels of this room are written once over [`Lanes`] and compiled for each kind of vector: `avx2` has the
//! registers of AVX2 and FMA; [`Portable`] is a plain array, as wide as the 128-bit registers that compilers target
//! where nothing is known of the processor. Portable arithmetic rounds after every operation, so it has the same bits
//! on every machine; AVX2 fuses each product with the sum around it.

use core::ops::{Add, Mul, Neg, Sub};

use crate::real::Real;

/// Most lanes times bytes of an element: what a line of the workspace has room for.
pub(super) const WIDEST: usize = 32;

/// Bytes of a complex vector of the widest lanes.
pub(super) const COMPLEX_BYTES: usize = 2 * WIDEST;

/// A loop that wants to be compiled with the instructions of some [`Lanes`].
pub(super) trait Kernel {
    /// # Safety
    /// As the kernel's fields demand; the processor has the instructions of the lanes.
    unsafe fn run(self);
}

/// A vector of numbers, one of each column. A value exists only on processors that have its instructions.
pub(super) trait Lanes:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Neg<Output = Self>
{
    /// `f32` or `f64`.
    type Element: Real;
    /// Numbers in a vector.
    const COUNT: usize;

    /// # Safety
    /// `COUNT` elements are readable at `from`.
    unsafe fn load(from: *const Self::Element) -> Self;
    /// # Safety
    /// `COUNT` elements are writable at `to`.
    unsafe fn store(self, to: *mut Self::Element);
    /// One number in every lane.
    /// # Safety
    /// One element is readable at `from`.
    unsafe fn broadcast(from: *const Self::Element) -> Self;
    /// `x` in every lane. The vector in hand only says which processor this is.
    fn filled(self, x: f64) -> Self;
    /// self b + c.
    fn mul_add(self, b: Self, c: Self) -> Self;
    /// self b - c.
    fn mul_sub(self, b: Self, c: Self) -> Self;
    /// c - self b.
    fn neg_mul_add(self, b: Self, c: Self) -> Self;
    /// `COUNT` neighbouring complex numbers, in any order of lanes that `store_columns` undoes.
    /// # Safety
    /// 2 `COUNT` elements are readable at `from`.
    unsafe fn load_columns(from: *const Self::Element) -> (Self, Self);
    /// Undoes `load_columns`.
    /// # Safety
    /// 2 `COUNT` elements are writable at `to`.
    unsafe fn store_columns(re: Self, im: Self, to: *mut Self::Element);
    /// Transposes `COUNT` elements of each of `COUNT` rows into `COUNT` consecutive vectors.
    /// # Safety
    /// Rows begin `stride` elements apart and are readable; `to` has room for `COUNT` vectors.
    unsafe fn load_rows(from: *const Self::Element, stride: usize, to: *mut Self::Element);
    /// Undoes `load_rows`.
    /// # Safety
    /// As `load_rows`, with the rows writable.
    unsafe fn store_rows(from: *const Self::Element, to: *mut Self::Element, stride: usize);
    /// Asks for the cache line at `address`, which may be any address.
    fn prefetch(address: *const Self::Element);
    /// Runs a kernel that was compiled with the instructions of these lanes.
    /// # Safety
    /// As [`Kernel::run`].
    unsafe fn enter<K: Kernel>(kernel: K);
}

/// A complex number in every lane.
#[derive(Clone, Copy)]
pub(super) struct Complex<V> {
    pub(super) re: V,
    pub(super) im: V,
}

impl<V: Lanes> Add for Complex<V> {
    type Output = Self;
    #[inline(always)]
    fn add(self, b: Self) -> Self {
        Self { re: self.re + b.re, im: self.im + b.im }
    }
}

impl<V: Lanes> Sub for Complex<V> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, b: Self) -> Self {
        Self { re: self.re - b.re, im: self.im - b.im }
    }
}

impl<V: Lanes> Complex<V> {
    /// self + i b.
    #[inline(always)]
    pub(super) fn add_i(self, b: Self) -> Self {
        Self { re: self.re - b.im, im: self.im + b.re }
    }

    /// self - i b.
    #[inline(always)]
    pub(super) fn sub_i(self, b: Self) -> Self {
        Self { re: self.re + b.im, im: self.im - b.re }
    }

    /// self times the complex number at `factor`, the same in every lane.
    ///
    /// # Safety
    /// Two elements are readable at `factor`.
    #[inline(always)]
    pub(super) unsafe fn times(self, factor: *const V::Element) -> Self {
        // SAFETY: the caller's.
        let (re, im) = unsafe { (V::broadcast(factor), V::broadcast(factor.add(1))) };
        Self { re: self.re.mul_sub(re, self.im * im), im: self.re.mul_add(im, self.im * re) }
    }
}

/// Lanes of any processor.
#[derive(Clone, Copy)]
pub(super) struct Portable<T, const N: usize>([T; N]);

impl<T: Real, const N: usize> Portable<T, N> {
    #[inline(always)]
    fn zip(mut self, b: Self, f: impl Fn(T, T) -> T) -> Self {
        for i in 0..N {
            self.0[i] = f(self.0[i], b.0[i]);
        }
        self
    }
}

impl<T: Real, const N: usize> Add for Portable<T, N> {
    type Output = Self;
    #[inline(always)]
    fn add(self, b: Self) -> Self {
        self.zip(b, |a, b| a + b)
    }
}

impl<T: Real, const N: usize> Sub for Portable<T, N> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, b: Self) -> Self {
        self.zip(b, |a, b| a - b)
    }
}

impl<T: Real, const N: usize> Mul for Portable<T, N> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, b: Self) -> Self {
        self.zip(b, |a, b| a * b)
    }
}

impl<T: Real, const N: usize> Neg for Portable<T, N> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        self.zip(self, |a, _| -a)
    }
}

impl<T: Real, const N: usize> Lanes for Portable<T, N> {
    type Element = T;
    const COUNT: usize = N;

    #[inline(always)]
    unsafe fn load(from: *const T) -> Self {
        // SAFETY: the caller's; unaligned because columns begin anywhere.
        Self(unsafe { from.cast::<[T; N]>().read_unaligned() })
    }

    #[inline(always)]
    unsafe fn store(self, to: *mut T) {
        // SAFETY: the caller's.
        unsafe { to.cast::<[T; N]>().write_unaligned(self.0) }
    }

    #[inline(always)]
    unsafe fn broadcast(from: *const T) -> Self {
        // SAFETY: the caller's.
        Self([unsafe { *from }; N])
    }

    #[inline(always)]
    fn filled(self, x: f64) -> Self {
        Self([T::from_f64(x); N])
    }

    #[inline(always)]
    fn mul_add(self, b: Self, c: Self) -> Self {
        self * b + c
    }

    #[inline(always)]
    fn mul_sub(self, b: Self, c: Self) -> Self {
        self * b - c
    }

    #[inline(always)]
    fn neg_mul_add(self, b: Self, c: Self) -> Self {
        c - self * b
    }

    #[inline(always)]
    unsafe fn load_columns(from: *const T) -> (Self, Self) {
        let (mut re, mut im) = (Self([T::ZERO; N]), Self([T::ZERO; N]));
        for i in 0..N {
            // SAFETY: 2 N elements are readable, says the caller.
            unsafe {
                re.0[i] = *from.add(2 * i);
                im.0[i] = *from.add(2 * i + 1);
            }
        }
        (re, im)
    }

    #[inline(always)]
    unsafe fn store_columns(re: Self, im: Self, to: *mut T) {
        for i in 0..N {
            // SAFETY: 2 N elements are writable, says the caller.
            unsafe {
                *to.add(2 * i) = re.0[i];
                *to.add(2 * i + 1) = im.0[i];
            }
        }
    }

    #[inline(always)]
    unsafe fn load_rows(from: *const T, stride: usize, to: *mut T) {
        for row in 0..N {
            for i in 0..N {
                // SAFETY: N elements of N rows are readable and N vectors writable, says the caller.
                unsafe { *to.add(i * N + row) = *from.add(row * stride + i) }
            }
        }
    }

    #[inline(always)]
    unsafe fn store_rows(from: *const T, to: *mut T, stride: usize) {
        for row in 0..N {
            for i in 0..N {
                // SAFETY: as in `load_rows`.
                unsafe { *to.add(row * stride + i) = *from.add(i * N + row) }
            }
        }
    }

    #[inline(always)]
    fn prefetch(_: *const T) {}

    #[inline(never)]
    unsafe fn enter<K: Kernel>(kernel: K) {
        // SAFETY: the caller's.
        unsafe { kernel.run() }
    }
}
