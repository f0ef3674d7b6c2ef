//! The cells that one particle touches: their weights and where they lie.

use super::frame::Frame;
use super::region::Region;
use super::sort::Record;
use super::window::weights;
use crate::real::Real;

/// A region's memory, and how its axes close.
#[derive(Clone, Copy)]
pub(super) struct Cells {
    count: [usize; 3],
    stride: [usize; 3],
}

/// A particle of window order P on its region: index of the first cell and weights on each axis.
pub(super) struct Touched<T> {
    first: [usize; 3],
    pub(super) weight: [[T; 4]; 3],
}

impl<T: Real> Touched<T> {
    #[inline(always)]
    pub(super) fn new<const P: usize>(frame: &Frame<T>, record: &Record<T>) -> Self {
        let mut touched = Self { first: [0; 3], weight: [[T::ZERO; 4]; 3] };
        for axis in 0..3 {
            let (index, fraction) = frame.cell(axis, record[axis]);
            touched.first[axis] = index as usize;
            touched.weight[axis] = weights::<T, P>(fraction);
        }
        touched
    }
}

impl Cells {
    pub(super) fn new(region: &Region) -> Self {
        Self { count: region.count(), stride: region.stride() }
    }

    /// Offsets of the first of the P x P rows of Q reals that a particle touches, if none of them runs over an edge and rows have unit
    /// stride; row (i, j) then begins i stride[0] + j stride[1] further.
    #[inline(always)]
    pub(super) fn rows<T, const P: usize, const Q: usize>(&self, touched: &Touched<T>) -> Option<usize> {
        let [x, y, z] = touched.first;
        let inside = (x + P <= self.count[0]) & (y + P <= self.count[1]) & (z + Q <= self.count[2]);
        if inside & (self.stride[2] == 1) { Some(x * self.stride[0] + y * self.stride[1] + z) } else { None }
    }

    /// From one row to the next on axes 0 and 1.
    #[inline(always)]
    pub(super) const fn steps(&self) -> [usize; 2] {
        [self.stride[0], self.stride[1]]
    }

    /// Offset of cell (i, j, k) of those that a particle touches, in any layout and round any edge.
    #[inline(always)]
    pub(super) fn offset<T>(&self, touched: &Touched<T>, cell: [usize; 3]) -> usize {
        (0..3).map(|axis| (touched.first[axis] + cell[axis]) % self.count[axis] * self.stride[axis]).sum()
    }
}
