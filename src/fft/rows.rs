//! Rows along z: n reals to n/2 + 1 modes and back, as n/2 complex numbers and an untangling step.
//!
//! With z_j = x_2j + i x_(2j+1), h = n/2, Z its transform and w = exp(-2 pi i k/n),
//!     2 X_k = Z_k + conj(Z_(h-k)) - i w (Z_k - conj(Z_(h-k))),   X_(h-k) from the conjugate of the difference,
//! and back, leaving out the factor 1/2 so that the pair of transforms multiplies by n,
//!     Z_k = X_k + conj(X_(h-k)) + i conj(w) (X_k - conj(X_(h-k)))
//! (Press et al., Numerical Recipes, section 12.3). A block of rows is transposed into lanes before and after.

use core::marker::PhantomData;

use super::access::{Access, Line, Swapped};
use super::lanes::{Complex, Kernel, Lanes};
use super::passes::transform;
use super::tables::Tables;
use crate::real::Real;

/// As many rows as there are lanes, or fewer: `count` rows, `stride` reals apart.
#[derive(Clone, Copy)]
pub(super) struct Rows<E> {
    pub(super) first: *mut E,
    pub(super) stride: usize,
    pub(super) count: usize,
}

/// The first `reals` of each row to consecutive vectors. Lanes without a row hold zeros.
struct Load<V: Lanes> {
    rows: Rows<V::Element>,
    reals: usize,
    to: *mut V::Element,
}

impl<V: Lanes> Kernel for Load<V> {
    #[inline(always)]
    unsafe fn run(self) {
        let Rows { first, stride, count } = self.rows;
        let mut done = 0;
        // SAFETY: `reals` elements of `count` rows are readable, and as many vectors writable.
        unsafe {
            if count == V::COUNT {
                while done + V::COUNT <= self.reals {
                    // The block of rows that comes next.
                    for row in 0..V::COUNT {
                        V::prefetch(first.wrapping_add((V::COUNT + row) * stride + done));
                    }
                    V::load_rows(first.add(done), stride, self.to.add(done * V::COUNT));
                    done += V::COUNT;
                }
            }
            for i in done..self.reals {
                for row in 0..V::COUNT {
                    let x = if row < count { *first.add(row * stride + i) } else { V::Element::ZERO };
                    *self.to.add(i * V::COUNT + row) = x;
                }
            }
        }
    }
}

/// Undoes [`Load`].
struct Store<V: Lanes> {
    rows: Rows<V::Element>,
    reals: usize,
    from: *const V::Element,
}

impl<V: Lanes> Kernel for Store<V> {
    #[inline(always)]
    unsafe fn run(self) {
        let Rows { first, stride, count } = self.rows;
        let mut done = 0;
        // SAFETY: `reals` elements of `count` rows are writable, and as many vectors readable.
        unsafe {
            if count == V::COUNT {
                while done + V::COUNT <= self.reals {
                    V::store_rows(self.from.add(done * V::COUNT), first.add(done), stride);
                    done += V::COUNT;
                }
            }
            for i in done..self.reals {
                for row in 0..count {
                    *first.add(row * stride + i) = *self.from.add(i * V::COUNT + row);
                }
            }
        }
    }
}

/// Z to X, in place: h elements become h + 1.
struct Untangle<V: Lanes> {
    line: *mut V::Element,
    half: usize,
    /// w/2 for k = 0 ..= h/2.
    roots: *const V::Element,
    lanes: PhantomData<V>,
}

impl<V: Lanes> Kernel for Untangle<V> {
    #[inline(always)]
    unsafe fn run(self) {
        let (line, h) = (Line(self.line), self.half);
        // SAFETY: the line has room for h + 1 elements, and there are h/2 + 1 roots.
        unsafe {
            let z: Complex<V> = line.get(0);
            let (one_half, zero) = (z.re.filled(0.5), z.re.filled(0.0));
            line.put(0, Complex { re: z.re + z.im, im: zero });
            line.put(h, Complex { re: z.re - z.im, im: zero });
            for k in 1..h.div_ceil(2) {
                let (x, y): (Complex<V>, Complex<V>) = (line.get(k), line.get(h - k));
                let sum = Complex { re: x.re + y.re, im: x.im - y.im };
                let turned = Complex { re: x.im + y.im, im: y.re - x.re }.times(self.roots.add(2 * k));
                let (re, im) = (one_half.mul_add(sum.re, turned.re), one_half.mul_add(sum.im, turned.im));
                line.put(k, Complex { re, im });
                let (re, im) = (one_half.mul_sub(sum.re, turned.re), one_half.neg_mul_add(sum.im, turned.im));
                line.put(h - k, Complex { re, im });
            }
            if h.is_multiple_of(2) {
                let z: Complex<V> = line.get(h / 2);
                line.put(h / 2, Complex { re: z.re, im: -z.im });
            }
        }
    }
}

/// X to Z with real and imaginary parts exchanged, in place: h + 1 elements become h.
struct Tangle<V: Lanes> {
    line: *mut V::Element,
    half: usize,
    roots: *const V::Element,
    lanes: PhantomData<V>,
}

impl<V: Lanes> Kernel for Tangle<V> {
    #[inline(always)]
    unsafe fn run(self) {
        let (line, h) = (Line(self.line), self.half);
        let to = Swapped(line);
        // SAFETY: the line holds h + 1 elements, and there are h/2 + 1 roots.
        unsafe {
            let (x, y): (Complex<V>, Complex<V>) = (line.get(0), line.get(h));
            to.put(0, Complex { re: x.re + y.re, im: x.re - y.re });
            for k in 1..h.div_ceil(2) {
                let (x, y): (Complex<V>, Complex<V>) = (line.get(k), line.get(h - k));
                let sum = Complex { re: x.re + y.re, im: x.im - y.im };
                let difference = Complex { re: x.re - y.re, im: x.im + y.im };
                // conj(w) d = conj(w conj(d)), and the roots are halves.
                let d = Complex { re: difference.re + difference.re, im: -(difference.im + difference.im) };
                let turned = d.times(self.roots.add(2 * k));
                // i conj(turned) = (turned.im, turned.re)
                to.put(k, Complex { re: sum.re + turned.im, im: sum.im + turned.re });
                to.put(h - k, Complex { re: sum.re - turned.im, im: turned.re - sum.im });
            }
            if h.is_multiple_of(2) {
                let x: Complex<V> = line.get(h / 2);
                to.put(h / 2, Complex { re: x.re + x.re, im: -(x.im + x.im) });
            }
        }
    }
}

/// Reals to modes, in place.
///
/// # Safety
/// The rows hold n + 2 reals each; `work` has room for n + 2 vectors; the processor has the lanes.
pub(super) unsafe fn forward<V: Lanes>(
    tables: &Tables<V::Element>,
    rows: Rows<V::Element>,
    work: *mut V::Element,
) {
    let n = tables.n();
    // SAFETY: the work splits into two lines of n/2 + 1 complex vectors; the first is read before it is overwritten.
    unsafe {
        let line = work.add((n + 2) * V::COUNT);
        let roots = tables.untangle.as_ptr();
        V::enter(Load::<V> { rows, reals: n, to: work });
        transform::<V, _, _>(&tables.rows, Line(work), Line(line), work);
        V::enter(Untangle::<V> { line, half: n / 2, roots, lanes: PhantomData });
        V::enter(Store::<V> { rows, reals: n + 2, from: line });
    }
}

/// Modes to reals, in place.
///
/// # Safety
/// As [`forward`].
pub(super) unsafe fn inverse<V: Lanes>(
    tables: &Tables<V::Element>,
    rows: Rows<V::Element>,
    work: *mut V::Element,
) {
    let n = tables.n();
    // SAFETY: the work splits into two lines of n/2 + 1 complex vectors.
    unsafe {
        let line = work.add((n + 2) * V::COUNT);
        let roots = tables.untangle.as_ptr();
        V::enter(Load::<V> { rows, reals: n + 2, to: line });
        V::enter(Tangle::<V> { line, half: n / 2, roots, lanes: PhantomData });
        transform::<V, _, _>(&tables.rows, Line(line), Swapped(Line(line)), work);
        V::enter(Store::<V> { rows, reals: n, from: line });
    }
}
