//! Windows: how a particle is shared among the cells near it.
//!
//! The window of order p is the B-spline of p factors, W_p = top hat convolved with itself p times (Hockney & Eastwood 1981), one cell wide
//! each; on a mesh of spacing H its transform is sinc^p(k H/2). In three dimensions it is the product over the axes. A particle at u
//! (in cells) touches p cells on an axis; with v = u + (p odd ? 1/2 : 0), c = floor v and f = v - c, the first of them is
//! c - (p-1)/2 (rounded down) and the weights are polynomials in f and 1 - f:
//!
//! | p | name | weights, g = 1 - f |
//! |---|---|---|
//! | 1 | nearest grid point | 1 |
//! | 2 | cloud in cell | g, f |
//! | 3 | triangular shaped cloud | g^2/2, 1/2 + f g, f^2/2 |
//! | 4 | piecewise cubic spline | g^3/6, 2/3 - f^2 (1 + g)/2, 2/3 - g^2 (1 + f)/2, f^3/6 |
//!
//! Invariants: no weight is negative; they sum to 1 within one unit in the last place or two; and f <-> g mirrors them exactly, which
//! a last weight made as the remainder of the others would not.

use crate::real::Real;
use crate::status::{Error, Result};

/// Mass assignment window; the number is its order p, the power of its sinc.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(i32)]
pub enum Window {
    /// NGP: all to the nearest mesh point.
    NearestGridPoint = 1,
    /// CIC: linear.
    CloudInCell = 2,
    /// TSC: quadratic.
    TriangularShapedCloud = 3,
    /// PCS: cubic.
    PiecewiseCubicSpline = 4,
}

impl Window {
    /// All windows, by order.
    pub const ALL: [Self; 4] =
        [Self::NearestGridPoint, Self::CloudInCell, Self::TriangularShapedCloud, Self::PiecewiseCubicSpline];

    /// Cells that it touches on an axis: p.
    ///
    /// ```
    /// use fixpair::pm::Window;
    ///
    /// assert_eq!(Window::CloudInCell.order(), 2);
    /// ```
    #[must_use]
    #[inline]
    pub const fn order(self) -> usize {
        self as usize
    }

    /// Cells touched before the one that holds v.
    pub(super) const fn before(self) -> usize {
        (self.order() - 1) / 2
    }

    /// What is added to a coordinate in cells so that its integer part counts cells: v = u + offset - shift.
    pub(super) const fn offset(self) -> f64 {
        if self.order() % 2 == 1 { 0.5 } else { 0.0 }
    }
}

impl TryFrom<i32> for Window {
    type Error = Error;

    fn try_from(order: i32) -> Result<Self> {
        Self::ALL.into_iter().find(|&window| window as i32 == order).ok_or(Error::Choice)
    }
}

/// The P weights of a particle at fraction 0 <= f < 1 of an axis, then zeros.
#[inline(always)]
pub(super) fn spline<T: Real, const P: usize>(f: T) -> [T; 4] {
    let half = T::from_f64(0.5);
    let (sixth, two_thirds) = (T::from_f64(1.0 / 6.0), T::from_f64(2.0 / 3.0));
    let g = T::ONE - f;
    let (ff, gg) = (f * f, g * g);
    match P {
        1 => [T::ONE, T::ZERO, T::ZERO, T::ZERO],
        2 => [g, f, T::ZERO, T::ZERO],
        3 => [half * gg, half + f * g, half * ff, T::ZERO],
        _ => [
            sixth * (gg * g),
            two_thirds - half * (ff * (T::ONE + g)),
            two_thirds - half * (gg * (T::ONE + f)),
            sixth * (ff * f),
        ],
    }
}
