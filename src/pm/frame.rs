//! Coordinates of particles in cells of a region.
//!
//! On each axis v = x n/L + offset - shift, wrapped into [0, n), in the particles' type: off by no more than the position itself is, about an ulp
//! of x. Its integer part c is a cell, its fraction f goes into the weights. The first cell touched has the index a = (c - base) mod n in the region.

use super::region::{Region, check_shift};
use super::window::Window;
use crate::real::Real;
use crate::status::{Error, Result};

/// How particles are assigned to a mesh.
#[derive(Clone, Copy, Debug)]
pub struct Assignment {
    /// Side of the box, in the unit of the positions.
    pub box_size: f64,
    /// How a particle is shared among cells.
    pub window: Window,
    /// Mesh point i lies at (i + shift) H, H = L/n, on every axis: 0, or 1/2 for the second mesh of interlacing. In [0, 1).
    pub shift: f64,
}

/// Particles located at a time: enough for full vectors, few enough to stay in the first cache.
pub(super) const BLOCK: usize = 64;

/// What keeps a particle from being placed.
pub(super) const OUTSIDE: u32 = 1;
pub(super) const NOT_FINITE: u32 = 2;

/// Positions closer than this to the edge of a region, in ulps of n, count as inside: whoever cut the particles into regions rounded too.
const SLACK: f64 = 8.0;

/// From positions to cells.
pub(super) struct Frame<T> {
    box_size: f64,
    cells_per_length: f64,
    lift: f64,
    scale: T,
    add: T,
    side: T,
    n: i32,
    /// The cell c of particles whose first cell is the region's first, on each axis.
    base: [i32; 3],
    /// First cells that leave room for the window, on each axis: 0 .. limit.
    pub(super) limit: [i32; 3],
}

impl<T: Real> Frame<T> {
    /// `NotFinite` for the box or shift, `Range` for a shift outside [0, 1) or a box that is not positive in `T`.
    pub(super) fn new(region: &Region, assignment: &Assignment) -> Result<Self> {
        let Assignment { box_size, window, shift } = *assignment;
        check_shift(shift)?;
        if !box_size.is_finite() {
            return Err(Error::NotFinite);
        }
        let n = region.n();
        let cells_per_length = n as f64 / box_size;
        let scale = T::from_f64(cells_per_length);
        let rounding = libm::fabs(scale.to_f64() - cells_per_length);
        let represented = rounding <= T::EPSILON.to_f64() * cells_per_length;
        if !(box_size > 0.0 && scale > T::ZERO && scale.is_finite() && represented) {
            return Err(Error::Range);
        }
        let lift = window.offset() - shift;
        let (start, count) = (region.start(), region.count());
        let index = |i: usize| i32::try_from(i).map_err(|_| Error::Overflow);
        let mut frame = Self {
            box_size,
            cells_per_length,
            lift,
            scale,
            add: T::from_f64(lift),
            side: T::from_f64(n as f64),
            n: index(n)?,
            base: [0; 3],
            limit: [0; 3],
        };
        for axis in 0..3 {
            let room = if count[axis] == n { n } else { (count[axis] + 1).saturating_sub(window.order()) };
            frame.base[axis] = index((start[axis] + window.before()).checked_rem(n).ok_or(Error::MeshSize)?)?;
            frame.limit[axis] = if region.is_empty() { 0 } else { index(room)? };
        }
        Ok(frame)
    }

    /// Index in the region of the first cell touched on an axis.
    fn index(&self, axis: usize, v: T) -> i32 {
        let ahead = v.to_f64() as i32 - self.base[axis];
        if ahead < 0 { ahead + self.n } else { ahead }
    }

    /// Indices in the region of the first cells touched on an axis, of a block with coordinates v in [0, n).
    #[inline(always)]
    pub(super) fn index_all(&self, axis: usize, v: &[T; BLOCK], index: &mut [i32; BLOCK]) {
        let (base, n) = (self.base[axis], self.n);
        for i in 0..BLOCK {
            debug_assert!(v[i] >= T::ZERO && v[i] < self.side);
            // SAFETY: in [0, n), and n is an i32.
            let ahead = unsafe { v[i].split() }.0 - base;
            index[i] = if ahead < 0 { ahead + n } else { ahead };
        }
    }

    /// v of a position in the box or not far from it, and whether it is one.
    #[inline(always)]
    fn near(&self, x: T) -> (T, bool) {
        let raw = x * self.scale + self.add;
        let raw = if raw < T::ZERO { raw + self.side } else { raw };
        let wrapped = if raw >= self.side { raw - self.side } else { raw };
        // A NaN fails the comparisons.
        (wrapped, (wrapped >= T::ZERO) & (wrapped < self.side))
    }

    /// Turns one coordinate of a block of particles into v, and finds their first cells. Returns what is wrong with any of them. What becomes of a
    /// particle does not depend on the others.
    #[inline(always)]
    pub(super) fn locate(&self, axis: usize, x: &mut [T; BLOCK], index: &mut [i32; BLOCK]) -> u32 {
        let mut astray = 0;
        let (base, n, limit) = (self.base[axis], self.n, self.limit[axis]);
        let mut v = [T::ZERO; BLOCK];
        for i in 0..BLOCK {
            let (wrapped, inside) = self.near(x[i]);
            v[i] = if inside { wrapped } else { T::ZERO };
            // SAFETY: in [0, n), and n is an i32.
            let ahead = unsafe { v[i].split() }.0 - base;
            index[i] = if ahead < 0 { ahead + n } else { ahead };
            astray |= u32::from(!inside) | u32::from(index[i] >= limit);
        }
        let mut wrong = 0;
        if astray != 0 {
            wrong = self.locate_each(axis, x, &mut v, index);
        }
        *x = v;
        wrong
    }

    /// As `locate`, one by one, for blocks with particles astray.
    #[inline(never)]
    fn locate_each(&self, axis: usize, x: &[T; BLOCK], v: &mut [T; BLOCK], index: &mut [i32; BLOCK]) -> u32 {
        let mut wrong = 0;
        for i in 0..BLOCK {
            if !x[i].is_finite() {
                wrong |= NOT_FINITE;
                continue;
            }
            if !self.near(x[i]).1 {
                v[i] = self.wrap(x[i]);
            }
            index[i] = self.index(axis, v[i]);
            if index[i] >= self.limit[axis] {
                match self.nudge(axis, v[i]) {
                    Some(nudged) => v[i] = nudged,
                    None => wrong |= OUTSIDE,
                }
                index[i] = self.index(axis, v[i]);
            }
        }
        wrong
    }

    /// v of a position boxes away: its remainder by L is exact.
    fn wrap(&self, x: T) -> T {
        let side = self.side.to_f64();
        let v = crate::math::fmod(x.to_f64(), self.box_size) * self.cells_per_length;
        // First into the box: the lift may take a place near its lower edge out again.
        let v = if v < 0.0 { v + side } else { v } + self.lift;
        let v = if v < 0.0 { v + side } else { v };
        let v = T::from_f64(if v >= side { v - side } else { v });
        // Rounding may reach the far edge, which is the near edge of the next box.
        if v < self.side { v } else { T::ZERO }
    }

    /// The nearest place inside the region, for a particle outside by no more than rounding.
    fn nudge(&self, axis: usize, v: T) -> Option<T> {
        let (n, base) = (f64::from(self.n), f64::from(self.base[axis]));
        let limit = f64::from(self.limit[axis]);
        let slack = SLACK * T::EPSILON.to_f64() * n;
        let beyond = v.to_f64() - base;
        let beyond = if beyond < 0.0 { beyond + n } else { beyond };
        if limit < 1.0 {
            None
        } else if n - beyond <= slack {
            Some(T::from_f64(base))
        } else if beyond - limit <= slack {
            let edge = if base + limit > n { base + limit - n } else { base + limit };
            let edge = T::from_f64(edge);
            Some(edge - edge * T::EPSILON)
        } else {
            None
        }
    }
}
