//! Where a line of complex vectors lies: in the workspace, or spread over the mesh.

use super::lanes::{Complex, Lanes, WIDEST};
use crate::real::Real;

/// A line of complex vectors that a pass reads or writes by index.
pub(super) trait Access<V: Lanes>: Copy {
    /// # Safety
    /// Element `index` of the line is readable.
    unsafe fn get(self, index: usize) -> Complex<V>;
    /// # Safety
    /// Element `index` of the line is writable.
    unsafe fn put(self, index: usize, value: Complex<V>);
}

/// Vectors one after the other: the real lanes, then the imaginary lanes of each element.
#[derive(Clone, Copy)]
pub(super) struct Line<E>(pub(super) *mut E);

impl<V: Lanes> Access<V> for Line<V::Element> {
    #[inline(always)]
    unsafe fn get(self, index: usize) -> Complex<V> {
        // SAFETY: element `index` is inside the line, says the caller.
        unsafe {
            let from = self.0.add(2 * V::COUNT * index);
            Complex { re: V::load(from), im: V::load(from.add(V::COUNT)) }
        }
    }

    #[inline(always)]
    unsafe fn put(self, index: usize, value: Complex<V>) {
        // SAFETY: element `index` is inside the line, says the caller.
        unsafe {
            let to = self.0.add(2 * V::COUNT * index);
            value.re.store(to);
            value.im.store(to.add(V::COUNT));
        }
    }
}

/// Neighbouring columns of the mesh: each element is `V::COUNT` complex numbers, `stride` reals after the last.
#[derive(Clone, Copy)]
pub(super) struct Columns<E> {
    pub(super) first: *mut E,
    pub(super) stride: usize,
    /// Whether to ask for the second and third block to the right while reading this one.
    pub(super) fetch_next_pair: bool,
}

impl<V: Lanes> Access<V> for Columns<V::Element> {
    #[inline(always)]
    unsafe fn get(self, index: usize) -> Complex<V> {
        // SAFETY: the columns are inside the mesh, says the caller.
        let from = unsafe { self.first.add(index * self.stride) };
        // Hardware does not guess strides of a page or more. Two blocks at a time, since memory likes long stretches.
        if self.fetch_next_pair {
            V::prefetch(from.wrapping_add(4 * V::COUNT));
            V::prefetch(from.wrapping_add(6 * V::COUNT));
        }
        // SAFETY: as above.
        let (re, im) = unsafe { V::load_columns(from) };
        Complex { re, im }
    }

    #[inline(always)]
    unsafe fn put(self, index: usize, value: Complex<V>) {
        // SAFETY: the columns are inside the mesh, says the caller.
        unsafe { V::store_columns(value.re, value.im, self.first.add(index * self.stride)) }
    }
}

/// Fewer columns than lanes, or columns that are no neighbours: `lanes` of them, `apart` reals from each other. The
/// other lanes compute with zeros.
#[derive(Clone, Copy)]
pub(super) struct Scattered<E> {
    pub(super) first: *mut E,
    pub(super) stride: usize,
    pub(super) lanes: usize,
    pub(super) apart: usize,
}

impl<V: Lanes> Access<V> for Scattered<V::Element> {
    #[inline(always)]
    unsafe fn get(self, index: usize) -> Complex<V> {
        let (mut re, mut im) = ([V::Element::ZERO; WIDEST / 4], [V::Element::ZERO; WIDEST / 4]);
        for lane in 0..self.lanes {
            // SAFETY: the columns are inside the mesh, says the caller, and there are at most V::COUNT.
            unsafe {
                let from = self.first.add(index * self.stride + lane * self.apart);
                *re.get_unchecked_mut(lane) = *from;
                *im.get_unchecked_mut(lane) = *from.add(1);
            }
        }
        // SAFETY: no lanes are more than WIDEST bytes, and no element less than 4.
        unsafe { Complex { re: V::load(re.as_ptr()), im: V::load(im.as_ptr()) } }
    }

    #[inline(always)]
    unsafe fn put(self, index: usize, value: Complex<V>) {
        let (mut re, mut im) = ([V::Element::ZERO; WIDEST / 4], [V::Element::ZERO; WIDEST / 4]);
        // SAFETY: as in `get`.
        unsafe {
            value.re.store(re.as_mut_ptr());
            value.im.store(im.as_mut_ptr());
        }
        for lane in 0..self.lanes {
            // SAFETY: as in `get`.
            unsafe {
                let to = self.first.add(index * self.stride + lane * self.apart);
                *to = *re.get_unchecked(lane);
                *to.add(1) = *im.get_unchecked(lane);
            }
        }
    }
}

/// Real and imaginary parts exchanged. A forward transform of exchanged parts, exchanged again, is the inverse.
#[derive(Clone, Copy)]
pub(super) struct Swapped<A>(pub(super) A);

impl<V: Lanes, A: Access<V>> Access<V> for Swapped<A> {
    #[inline(always)]
    unsafe fn get(self, index: usize) -> Complex<V> {
        // SAFETY: the caller's.
        let Complex { re, im } = unsafe { self.0.get(index) };
        Complex { re: im, im: re }
    }

    #[inline(always)]
    unsafe fn put(self, index: usize, value: Complex<V>) {
        // SAFETY: the caller's.
        unsafe { self.0.put(index, Complex { re: value.im, im: value.re }) }
    }
}
