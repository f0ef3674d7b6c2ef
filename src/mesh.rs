//! Bricks: which part of an n x n x n mesh an array holds, and where each element lies.
//!
//! A mesh covers a periodic cube. In configuration space its elements are reals at (x, y, z), each index in
//! `0..n`. In Fourier space they are complex numbers, stored as (re, im) pairs of reals, at the mode
//! k = (2 pi/L) (i, j, l): axis 0 and 1 hold i and j in the order 0, 1, ..., n/2, -(n/2-1), ..., -1, axis 2 holds the
//! half l = 0..=n/2. Strides count elements: reals in configuration space, complex numbers in Fourier space.
//!
//! Invariants of a [`Brick`], checked when it is made: n is even, positive and at most 2^21; it is inside its mesh and fits the address
//! space, which its mesh need not; no two of its elements share an address, because the axes nest (sorted by stride, each stride spans the axes
//! before it).

use crate::status::{Error, Result};
use crate::within::Within;

/// Whether a brick holds real cells or complex modes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(i32)]
pub enum Space {
    /// Real numbers on cells.
    Configuration = 0,
    /// Complex modes of the half space l >= 0.
    Fourier = 1,
}

impl Space {
    /// Reals in one element: 1 or 2.
    ///
    /// ```
    /// # use fixpair::mesh::Space;
    /// assert_eq!((Space::Configuration.width(), Space::Fourier.width()), (1, 2)); // reals an element
    /// ```
    #[must_use]
    #[inline]
    pub const fn width(self) -> usize {
        match self {
            Self::Configuration => 1,
            Self::Fourier => 2,
        }
    }
}

/// The largest side of a mesh, whatever part of it is in memory. Its 2^63 cells still have numbers of 64 bits, and |n|^2 is exact in `f64`.
pub const LARGEST_SIDE: usize = 1 << 21;

/// `MeshSize` if n is zero or odd; `Overflow` above [`LARGEST_SIDE`], or if a table by |n|^2 does not fit the address space.
pub(crate) fn check_side(n: usize) -> Result<()> {
    if n == 0 || !n.is_multiple_of(2) {
        return Err(Error::MeshSize);
    }
    let table = (n / 2).checked_mul(n / 2).and_then(|square| square.checked_mul(24)?.checked_add(8));
    let fits = n <= LARGEST_SIDE && table.is_some_and(|bytes| isize::try_from(bytes).is_ok());
    if fits { Ok(()) } else { Err(Error::Overflow) }
}

/// A rectangular part of a mesh in memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Brick {
    n: usize,
    space: Space,
    start: [usize; 3],
    count: [usize; 3],
    stride: [usize; 3],
}

impl Brick {
    /// Any layout, such as a pencil or a transposed slab.
    ///
    /// # Errors
    /// `MeshSize` if n is zero or odd, `Overflow` if it is above [`LARGEST_SIDE`] or if elements of 16 bytes from the brick's first to
    /// its last do not fit the address space, `Brick` if the other invariants of this module fail.
    ///
    /// # Example
    /// ```
    /// use fixpair::mesh::{Brick, Space};
    ///
    /// // A pencil of a mesh of 64^3 modes: all i, 16 j, 11 l.
    /// let pencil = Brick::general(64, Space::Fourier, [0, 32, 0], [64, 16, 11], [16 * 11, 11, 1])?;
    /// assert_eq!(pencil.elements(), 64 * 16 * 11);
    /// # Ok::<(), fixpair::status::Error>(())
    /// ```
    pub fn general(
        n: usize,
        space: Space,
        start: [usize; 3],
        count: [usize; 3],
        stride: [usize; 3],
    ) -> Result<Self> {
        check_side(n)?;
        let brick = Self { n, space, start, count, stride };
        let extent = brick.extent();
        for axis in 0..3 {
            if start[axis] > extent[axis] || count[axis] > extent[axis] - start[axis] {
                return Err(Error::Brick);
            }
        }
        let mut last = 0_usize; // offset of the last element of the axes seen so far
        for axis in brick.axes_by_stride() {
            let (count, stride) = (count.at(axis), stride.at(axis));
            if count > 1 && !brick.is_empty() {
                if stride <= last {
                    return Err(Error::Brick);
                }
                let span = stride.checked_mul(count - 1).ok_or(Error::Overflow)?;
                last = last.checked_add(span).ok_or(Error::Overflow)?;
            }
        }
        let bytes = last.checked_add(1).and_then(|elements| elements.checked_mul(16));
        if bytes.is_none_or(|bytes| isize::try_from(bytes).is_err()) {
            return Err(Error::Overflow);
        }
        Ok(brick)
    }

    /// The whole mesh as an in-place real transform wants it: rows of n + 2 reals or n/2 + 1 modes.
    ///
    /// # Errors
    /// As [`Brick::general`].
    ///
    /// # Example
    /// ```
    /// use fixpair::mesh::{Brick, Space};
    ///
    /// let modes = Brick::whole(64, Space::Fourier)?; // FFTW's r2c in place
    /// assert_eq!(modes.reals(), 64 * 64 * 66);
    /// # Ok::<(), fixpair::status::Error>(())
    /// ```
    pub fn whole(n: usize, space: Space) -> Result<Self> {
        Self::slab(n, space, 0, n)
    }

    /// The whole mesh with `padding` unused modes (twice as many reals) after each x plane. Where n is a power of
    /// two, planes that are not a multiple of 1 KiB apart spare the transform cache conflicts.
    ///
    /// # Errors
    /// As [`Brick::general`].
    ///
    /// # Example
    /// ```
    /// use fixpair::mesh::{Brick, Space};
    ///
    /// let padded = Brick::whole_padded(64, Space::Fourier, 4)?; // 4 modes after each plane
    /// assert_eq!(padded.stride(), [64 * 33 + 4, 33, 1]);
    /// # Ok::<(), fixpair::status::Error>(())
    /// ```
    pub fn whole_padded(n: usize, space: Space, padding: usize) -> Result<Self> {
        let mut brick = Self::whole(n, space)?;
        brick.stride[0] = padding
            .checked_mul(2 / space.width())
            .and_then(|p| p.checked_add(brick.stride[0]))
            .ok_or(Error::Overflow)?;
        Self::general(n, space, brick.start, brick.count, brick.stride)
    }

    /// The x planes `first .. first + planes`, as FFTW-MPI deals them out.
    ///
    /// # Errors
    /// As [`Brick::general`].
    ///
    /// # Example
    /// ```
    /// use fixpair::mesh::{Brick, Space};
    ///
    /// let mine = Brick::slab(64, Space::Configuration, 16, 8)?; // planes 16 to 23, as FFTW-MPI deals them
    /// assert_eq!((mine.start()[0], mine.count()[0]), (16, 8));
    /// # Ok::<(), fixpair::status::Error>(())
    /// ```
    pub fn slab(n: usize, space: Space, first: usize, planes: usize) -> Result<Self> {
        let row = Self::row(n, space)?;
        let last = if space == Space::Configuration { n } else { n / 2 + 1 };
        Self::general(n, space, [first, 0, 0], [planes, n, last], [row * n, row, 1])
    }

    /// The modes with y index `first .. first + rows`, y outermost: FFTW-MPI's transposed output.
    ///
    /// # Errors
    /// As [`Brick::general`].
    ///
    /// # Example
    /// ```
    /// use fixpair::mesh::Brick;
    ///
    /// let mine = Brick::transposed_slab(64, 16, 8)?; // FFTW_MPI_TRANSPOSED_OUT: rows j = 16 to 23
    /// assert_eq!((mine.start()[1], mine.count()[1]), (16, 8));
    /// # Ok::<(), fixpair::status::Error>(())
    /// ```
    pub fn transposed_slab(n: usize, first: usize, rows: usize) -> Result<Self> {
        let row = Self::row(n, Space::Fourier)?;
        Self::general(n, Space::Fourier, [0, first, 0], [n, rows, row], [row, row * n, 1])
    }

    /// Elements from one row to the next.
    fn row(n: usize, space: Space) -> Result<usize> {
        check_side(n)?;
        Ok((n / 2 + 1) * (2 / space.width()))
    }

    /// Cells or modes on a side of the whole mesh.
    ///
    /// ```
    /// # use fixpair::mesh::{Brick, Space};
    /// let brick = Brick::whole(64, Space::Fourier)?;
    /// assert_eq!(brick.n(), 64);
    /// # Ok::<(), fixpair::status::Error>(())
    /// ```
    #[must_use]
    #[inline]
    pub const fn n(&self) -> usize {
        self.n
    }

    /// Cells or modes?
    ///
    /// ```
    /// # use fixpair::mesh::{Brick, Space};
    /// let brick = Brick::whole(64, Space::Fourier)?;
    /// assert_eq!(brick.space(), Space::Fourier);
    /// # Ok::<(), fixpair::status::Error>(())
    /// ```
    #[must_use]
    #[inline]
    pub const fn space(&self) -> Space {
        self.space
    }

    /// First index on each axis.
    ///
    /// ```
    /// # use fixpair::mesh::{Brick, Space};
    /// let brick = Brick::whole(64, Space::Fourier)?;
    /// assert_eq!(brick.start(), [0, 0, 0]);
    /// # Ok::<(), fixpair::status::Error>(())
    /// ```
    #[must_use]
    #[inline]
    pub const fn start(&self) -> [usize; 3] {
        self.start
    }

    /// Elements on each axis.
    ///
    /// ```
    /// # use fixpair::mesh::{Brick, Space};
    /// let brick = Brick::whole(64, Space::Fourier)?;
    /// assert_eq!(brick.count(), [64, 64, 33]);
    /// # Ok::<(), fixpair::status::Error>(())
    /// ```
    #[must_use]
    #[inline]
    pub const fn count(&self) -> [usize; 3] {
        self.count
    }

    /// Elements from one index to the next on each axis.
    ///
    /// ```
    /// # use fixpair::mesh::{Brick, Space};
    /// let brick = Brick::whole(64, Space::Fourier)?;
    /// assert_eq!(brick.stride(), [64 * 33, 33, 1]);
    /// # Ok::<(), fixpair::status::Error>(())
    /// ```
    #[must_use]
    #[inline]
    pub const fn stride(&self) -> [usize; 3] {
        self.stride
    }

    /// Elements on each axis of the whole mesh: (n, n, n) or (n, n, n/2 + 1).
    ///
    /// ```
    /// # use fixpair::mesh::{Brick, Space};
    /// let brick = Brick::whole(64, Space::Fourier)?;
    /// assert_eq!(brick.extent(), [64, 64, 33]); // of the whole mesh
    /// # Ok::<(), fixpair::status::Error>(())
    /// ```
    #[must_use]
    #[inline]
    pub const fn extent(&self) -> [usize; 3] {
        match self.space {
            Space::Configuration => [self.n, self.n, self.n],
            Space::Fourier => [self.n, self.n, self.n / 2 + 1],
        }
    }

    /// Does it hold every element of the mesh?
    ///
    /// ```
    /// # use fixpair::mesh::{Brick, Space};
    /// let brick = Brick::whole(64, Space::Fourier)?;
    /// assert!(brick.is_whole() && !Brick::slab(64, Space::Fourier, 0, 8)?.is_whole());
    /// # Ok::<(), fixpair::status::Error>(())
    /// ```
    #[must_use]
    pub fn is_whole(&self) -> bool {
        self.count == self.extent()
    }

    /// Does it hold nothing?
    ///
    /// ```
    /// # use fixpair::mesh::{Brick, Space};
    /// let brick = Brick::whole(64, Space::Fourier)?;
    /// assert!(!brick.is_empty() && Brick::slab(64, Space::Fourier, 0, 0)?.is_empty());
    /// # Ok::<(), fixpair::status::Error>(())
    /// ```
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.count.contains(&0)
    }

    /// Elements that it holds.
    ///
    /// ```
    /// # use fixpair::mesh::{Brick, Space};
    /// let brick = Brick::whole(64, Space::Fourier)?;
    /// assert_eq!(brick.elements(), 64 * 64 * 33);
    /// # Ok::<(), fixpair::status::Error>(())
    /// ```
    #[must_use]
    pub fn elements(&self) -> usize {
        self.count[0] * self.count[1] * self.count[2]
    }

    /// Reals from the first element to the end of the last: the least length of its array.
    ///
    /// ```
    /// # use fixpair::mesh::{Brick, Space};
    /// let brick = Brick::whole(64, Space::Fourier)?;
    /// assert_eq!(brick.reals(), 2 * brick.elements());
    /// # Ok::<(), fixpair::status::Error>(())
    /// ```
    #[must_use]
    pub fn reals(&self) -> usize {
        if self.is_empty() {
            return 0;
        }
        let last: usize = (0..3).map(|axis| (self.count[axis] - 1) * self.stride[axis]).sum();
        (last + 1) * self.space.width()
    }

    /// The axes, innermost first.
    ///
    /// ```
    /// # use fixpair::mesh::{Brick, Space};
    /// let brick = Brick::whole(64, Space::Fourier)?;
    /// assert_eq!(brick.axes_by_stride(), [2, 1, 0]); // the fastest first
    /// # Ok::<(), fixpair::status::Error>(())
    /// ```
    #[must_use]
    pub fn axes_by_stride(&self) -> [usize; 3] {
        let mut axes = [2, 1, 0];
        axes.sort_unstable_by_key(|&axis| (self.stride[axis], 2 - axis));
        axes
    }

    /// The signed mode number of a Fourier index on axis 0 or 1: 0, 1, ..., n/2, -(n/2-1), ..., -1. (On axis 2 the
    /// index is the mode number.)
    ///
    /// ```
    /// use fixpair::mesh::Brick;
    ///
    /// assert_eq!([0, 1, 4, 5, 7].map(|i| Brick::mode(8, i)), [0, 1, 4, -3, -1]);
    /// ```
    #[must_use]
    #[inline]
    pub const fn mode(n: usize, index: usize) -> i64 {
        if index <= n / 2 { index as i64 } else { index as i64 - n as i64 }
    }

    /// `Length` if `data` cannot hold it.
    ///
    /// # Errors
    /// See above.
    ///
    /// # Example
    /// ```
    /// # use fixpair::mesh::{Brick, Space};
    /// let brick = Brick::whole(64, Space::Fourier)?;
    /// assert!(brick.check_length(&[0.0_f32; 8]).is_err());
    /// # Ok::<(), fixpair::status::Error>(())
    /// ```
    pub fn check_length<T>(&self, data: &[T]) -> Result<()> {
        if data.len() < self.reals() { Err(Error::Length) } else { Ok(()) }
    }

    /// `Brick` if it does not live in `space`.
    ///
    /// # Errors
    /// See above.
    ///
    /// # Example
    /// ```
    /// # use fixpair::mesh::{Brick, Space};
    /// let brick = Brick::whole(64, Space::Fourier)?;
    /// assert!(brick.check_space(Space::Fourier).is_ok() && brick.check_space(Space::Configuration).is_err());
    /// # Ok::<(), fixpair::status::Error>(())
    /// ```
    pub fn check_space(&self, space: Space) -> Result<()> {
        if self.space == space { Ok(()) } else { Err(Error::Brick) }
    }
}

#[cfg(test)]
mod tests;
