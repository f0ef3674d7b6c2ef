//! Regions: boxes of cells of the periodic mesh, which may run over its edge.
//!
//! A [`Brick`] is inside its mesh; the planes that particles of a slab touch are not always: those of the first slab reach back to plane n - 1. A
//! region holds cells (start + a) mod n, 0 <= a < count, on each axis, with any strides. An axis with count = n is whole: it closes on itself, and
//! particles cross its edge freely.
//!
//! Invariants: n is even; start < n; count <= n; no two cells share an address.

use super::window::Window;
use crate::mesh::{Brick, Space};
use crate::status::{Error, Result};

/// A box of cells of a periodic n^3 mesh, in memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Region {
    // Its shape and strides, as a brick that begins at 0.
    shape: Brick,
    start: [usize; 3],
}

impl Region {
    /// Any box and layout; strides in reals.
    ///
    /// # Errors
    /// `Brick` if start is n or more, count more than n, or two cells share an address; else as [`Brick::general`].
    ///
    /// # Example
    /// ```
    /// use fixpair::pm::Region;
    ///
    /// let corner = Region::new(64, [60, 0, 0], [8, 64, 64], [64 * 64, 64, 1])?; // runs over the edge
    /// assert_eq!(corner.reals(), 8 * 64 * 64);
    /// # Ok::<(), fixpair::status::Error>(())
    /// ```
    pub fn new(n: usize, start: [usize; 3], count: [usize; 3], stride: [usize; 3]) -> Result<Self> {
        let shape = Brick::general(n, Space::Configuration, [0; 3], count, stride)?;
        // An empty part at the end of the mesh is a brick, and begins where the mesh does.
        if (0..3).any(|axis| start[axis] > n || start[axis] == n && count[axis] > 0) {
            return Err(Error::Brick);
        }
        Ok(Self { shape, start: start.map(|first| first.checked_rem(n).unwrap_or(0)) })
    }

    /// The cells of a brick.
    ///
    /// # Errors
    /// `Brick` for a brick of Fourier space.
    ///
    /// # Example
    /// ```
    /// use fixpair::mesh::{Brick, Space};
    /// use fixpair::pm::Region;
    ///
    /// let brick = Brick::whole(8, Space::Configuration)?;
    /// let region = Region::from_brick(&brick)?;
    /// assert_eq!(region.reals(), brick.reals());
    /// # Ok::<(), fixpair::status::Error>(())
    /// ```
    pub fn from_brick(brick: &Brick) -> Result<Self> {
        brick.check_space(Space::Configuration)?;
        Self::new(brick.n(), brick.start(), brick.count(), brick.stride())
    }

    /// The cells that particles inside a brick touch: on each axis that the brick does not span, ghost planes before and after it.
    ///
    /// The particles are those with start H <= x < (start + count) H, H = L/n (a particle within rounding of the edge counts as inside, see
    /// [`super::deposit::deposit`]). Planes before and after, for mesh points at i H and, in brackets, at (i + 1/2) H:
    ///
    /// | window | before | after |
    /// |---|---|---|
    /// | nearest grid point | 0 (0) | 1 (0) |
    /// | cloud in cell | 0 (1) | 1 (1) |
    /// | triangular shaped cloud | 1 (1) | 2 (1) |
    /// | piecewise cubic spline | 1 (2) | 2 (2) |
    ///
    /// If they meet round the mesh, the axis is whole. The cells lie close together, z fastest: the array has as many reals as the region cells.
    ///
    /// # Errors
    /// `Brick` for a brick of Fourier space, `NotFinite` and `Range` for a shift outside [0, 1).
    ///
    /// # Example
    /// ```
    /// use fixpair::mesh::{Brick, Space};
    /// use fixpair::pm::Region;
    ///
    /// let brick = Brick::whole(8, Space::Configuration)?;
    /// let region = Region::from_brick(&brick)?;
    /// use fixpair::pm::Window;
    ///
    /// let slab = Brick::slab(8, Space::Configuration, 2, 4)?;
    /// let ghosts = Region::with_ghosts(&slab, Window::CloudInCell, 0.0)?;
    /// assert!(ghosts.count()[0] > 4);
    /// # let _ = region;
    /// # Ok::<(), fixpair::status::Error>(())
    /// ```
    pub fn with_ghosts(brick: &Brick, window: Window, shift: f64) -> Result<Self> {
        let owned = Self::from_brick(brick)?;
        check_shift(shift)?;
        let n = brick.n();
        // Coordinates in [0, count) have integer parts floor(lift) .. ceil(count + lift) - 1, lift in (-1, 1/2].
        let lift = window.offset() - shift;
        let below = usize::from(lift < 0.0);
        let above = usize::from(lift > 0.0);
        let before = window.before() + below;
        let after = window.order() - 1 + above - window.before();
        let (mut start, mut count) = (owned.start, brick.count());
        if !brick.is_empty() {
            for axis in 0..3 {
                if count[axis] + before + after >= n {
                    // All planes; where the brick is whole they keep their order.
                    if count[axis] < n {
                        start[axis] = (start[axis] + n - before % n) % n;
                    }
                    count[axis] = n;
                } else {
                    start[axis] = (start[axis] + n - before) % n;
                    count[axis] += before + after;
                }
            }
        }
        Self::new(n, start, count, [count[1] * count[2], count[2], 1])
    }

    /// Cells on a side of the whole mesh.
    ///
    /// ```
    /// use fixpair::mesh::{Brick, Space};
    /// use fixpair::pm::Region;
    ///
    /// let brick = Brick::whole(8, Space::Configuration)?;
    /// let region = Region::from_brick(&brick)?;
    /// assert_eq!(region.n(), 8);
    /// # Ok::<(), fixpair::status::Error>(())
    /// ```
    #[must_use]
    #[inline]
    pub const fn n(&self) -> usize {
        self.shape.n()
    }

    /// First cell on each axis.
    ///
    /// ```
    /// use fixpair::mesh::{Brick, Space};
    /// use fixpair::pm::Region;
    ///
    /// let brick = Brick::whole(8, Space::Configuration)?;
    /// let region = Region::from_brick(&brick)?;
    /// assert_eq!(region.start(), [0, 0, 0]);
    /// # Ok::<(), fixpair::status::Error>(())
    /// ```
    #[must_use]
    #[inline]
    pub const fn start(&self) -> [usize; 3] {
        self.start
    }

    /// Cells on each axis.
    ///
    /// ```
    /// use fixpair::mesh::{Brick, Space};
    /// use fixpair::pm::Region;
    ///
    /// let brick = Brick::whole(8, Space::Configuration)?;
    /// let region = Region::from_brick(&brick)?;
    /// assert_eq!(region.count(), [8, 8, 8]);
    /// # Ok::<(), fixpair::status::Error>(())
    /// ```
    #[must_use]
    #[inline]
    pub const fn count(&self) -> [usize; 3] {
        self.shape.count()
    }

    /// Reals from one cell to the next on each axis.
    ///
    /// ```
    /// use fixpair::mesh::{Brick, Space};
    /// use fixpair::pm::Region;
    ///
    /// let brick = Brick::whole(8, Space::Configuration)?;
    /// let region = Region::from_brick(&brick)?;
    /// assert_eq!(region.stride(), [80, 10, 1]);
    /// # Ok::<(), fixpair::status::Error>(())
    /// ```
    #[must_use]
    #[inline]
    pub const fn stride(&self) -> [usize; 3] {
        self.shape.stride()
    }

    /// Does it hold nothing?
    ///
    /// ```
    /// use fixpair::mesh::{Brick, Space};
    /// use fixpair::pm::Region;
    ///
    /// let brick = Brick::whole(8, Space::Configuration)?;
    /// let region = Region::from_brick(&brick)?;
    /// assert!(!region.is_empty());
    /// # Ok::<(), fixpair::status::Error>(())
    /// ```
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.shape.is_empty()
    }

    /// Reals from the first cell to the end of the last: the least length of its array.
    ///
    /// ```
    /// use fixpair::mesh::{Brick, Space};
    /// use fixpair::pm::Region;
    ///
    /// let brick = Brick::whole(8, Space::Configuration)?;
    /// let region = Region::from_brick(&brick)?;
    /// assert_eq!(region.reals(), 638); // to the last cell
    /// # Ok::<(), fixpair::status::Error>(())
    /// ```
    #[must_use]
    pub fn reals(&self) -> usize {
        self.shape.reals()
    }

    /// `Length` if `data` cannot hold it.
    ///
    /// # Errors
    /// See above.
    ///
    /// # Example
    /// ```
    /// use fixpair::mesh::{Brick, Space};
    /// use fixpair::pm::Region;
    ///
    /// let brick = Brick::whole(8, Space::Configuration)?;
    /// let region = Region::from_brick(&brick)?;
    /// assert!(region.check_length(&[0.0_f32; 8]).is_err());
    /// # Ok::<(), fixpair::status::Error>(())
    /// ```
    pub fn check_length<T>(&self, data: &[T]) -> Result<()> {
        self.shape.check_length(data)
    }
}

/// `NotFinite`, or `Range` outside [0, 1).
pub(super) fn check_shift(shift: f64) -> Result<()> {
    if !shift.is_finite() {
        Err(Error::NotFinite)
    } else if (0.0..1.0).contains(&shift) {
        Ok(())
    } else {
        Err(Error::Range)
    }
}
