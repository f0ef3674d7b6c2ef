//! Where the cells that a particle touches lie.

use core::ops::Range;

use super::region::Region;

/// A region's memory, and how its axes close.
#[derive(Clone, Copy)]
pub(super) struct Cells {
    count: [usize; 3],
    stride: [usize; 3],
}

impl Cells {
    pub(super) fn new(region: &Region) -> Self {
        Self { count: region.count(), stride: region.stride() }
    }

    /// Last indices of first cells from which P x P rows of Q reals run over no edge; negative where rows do not have unit stride.
    #[inline(always)]
    pub(super) fn last_rows<const P: usize, const Q: usize>(&self) -> [i32; 3] {
        let last = |axis: usize, reach: usize| self.count[axis] as i32 - reach as i32;
        [last(0, P), last(1, P), if self.stride[2] == 1 { last(2, Q) } else { -1 }]
    }

    /// Offset of a cell.
    #[inline(always)]
    pub(super) fn start(&self, [x, y, z]: [usize; 3]) -> usize {
        x * self.stride[0] + y * self.stride[1] + z * self.stride[2]
    }

    /// Asks the cache for the rows in which particles of a tile begin, where they are many enough to use most lines: in random order each would
    /// wait for memory on its own.
    pub(super) fn fetch<T>(&self, mesh: *const T, [x, y]: [Range<usize>; 2], particles: usize) {
        const LINE: usize = 64;
        let per_line = LINE / size_of::<T>();
        let lines = self.count[2].div_ceil(per_line);
        if self.stride[2] != 1 || 2 * particles < x.len() * y.len() * lines {
            return;
        }
        for x in x {
            for y in y.clone() {
                let row = x * self.stride[0] + y * self.stride[1];
                for line in 0..lines {
                    prefetch::<T, false>(mesh.wrapping_add(row + line * per_line));
                }
            }
        }
    }

    /// From one row to the next on axes 0 and 1.
    #[inline(always)]
    pub(super) const fn steps(&self) -> [usize; 2] {
        [self.stride[0], self.stride[1]]
    }

    /// Offsets along each axis of the P cells from the first that a particle touches, in any layout and round any edge.
    #[inline(always)]
    pub(super) fn offsets<const P: usize>(&self, first: [usize; 3]) -> [[usize; P]; 3] {
        let along = |mut index: usize, count: usize, stride: usize| {
            debug_assert!(index < count);
            core::array::from_fn(|_| {
                let offset = index * stride;
                index = if index + 1 < count { index + 1 } else { 0 };
                offset
            })
        };
        let ([x, y, z], count, stride) = (first, self.count, self.stride);
        [along(x, count[0], stride[0]), along(y, count[1], stride[1]), along(z, count[2], stride[2])]
    }
}

/// A hint, which changes nothing but time.
#[inline(always)]
pub(super) fn prefetch<T, const FIRST_CACHE: bool>(address: *const T) {
    #[cfg(target_arch = "x86_64")]
    {
        use core::arch::x86_64::{_MM_HINT_T0, _MM_HINT_T1, _mm_prefetch};
        // SAFETY: prefetches of any address do no harm, and every x86-64 has the instruction.
        unsafe {
            if FIRST_CACHE {
                _mm_prefetch::<_MM_HINT_T0>(address.cast());
            } else {
                _mm_prefetch::<_MM_HINT_T1>(address.cast());
            }
        }
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = address;
}
