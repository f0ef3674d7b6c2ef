//! The kernels of the usual templates, as rows.
//!
//! With x = P_Phi^(1/3), x1 x2 x3 in the place of the three wavenumbers, and S = x1 x2^2 x3^3 + 5 permutations, B = 6 f_NL F,
//!
//! - local: F = (x1^3 x2^3 + 2 cyclic)/3, that is B = 2 f_NL (P1 P2 + 2 cyclic);
//! - equilateral: F = -(P1 P2 + 2 cyclic) - 2 (P1 P2 P3)^(2/3) + S (Creminelli et al. 2006, astro-ph/0509029);
//! - orthogonal: F = -3 (P1 P2 + 2 cyclic) - 8 (P1 P2 P3)^(2/3) + 3 S (Senatore, Smith & Zaldarriaga 2010, arXiv:0905.3746);
//! - folded: F = (equilateral - orthogonal)/2 = (P1 P2 + 2 cyclic) + 3 (P1 P2 P3)^(2/3) - S (Meerburg, van der Schaar & Corasaniti 2009,
//!   arXiv:0901.4044);
//! - orthogonal LSS: F = (1 + p) D/(k1 k2 k3)^3 - p G^3/(k1 k2 k3)^4 with k = 1/x, D = (k_T - 2 k1)(k_T - 2 k2)(k_T - 2 k3), k_T = k1 + k2 + k3,
//!   G = 2 (k1 k2 + 2 cyclic)/3 - (k1^2 + 2 cyclic)/3 and p = 27/(-21 + 743/(7 (20 pi^2 - 193))) (the same paper, appendix B).
//!
//! A template leaves the kernel open: S is that of X_-1[phi X_1 phi] and that of X_-2[phi X_2 phi] alike. Here the terms X_-2 come as
//! X_-2[phi X_2 phi - (X_1 phi)^2], whose kernel is (k1 - k2)^2/k3^2, so that short modes do not add power as k3^-4 to long ones; what is left goes
//! as k3^-2 (Scoccimarro et al. 2012, arXiv:1108.5512), less steep than P_Phi.

use super::shape::LARGEST_EXPONENT;
use crate::status::{Error, Result};

/// One separable product: c X_out[(X_a phi)(X_b phi)].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C)]
pub struct ShapeRow {
    /// c.
    pub coefficient: f64,
    /// Exponent on the product; the three sum to 0, and none is above 8 in modulus.
    pub s_out: f64,
    /// Exponent on one factor.
    pub s_a: f64,
    /// Exponent on the other factor; exchanging the two changes nothing.
    pub s_b: f64,
}

impl ShapeRow {
    const fn new(coefficient: f64, s_out: i32, [s_a, s_b]: [i32; 2]) -> Self {
        Self { coefficient, s_out: s_out as f64, s_a: s_a as f64, s_b: s_b as f64 }
    }

    /// The coefficient, if all that the rows are is Phi^2.
    ///
    /// ```
    /// use fixpair::initial::shape::{Shape, ShapeRow};
    ///
    /// assert_eq!(ShapeRow::local(Shape::Local.rows()), Some(1.0));
    /// assert_eq!(ShapeRow::local(Shape::Equilateral.rows()), None);
    /// ```
    #[must_use]
    pub fn local(rows: &[Self]) -> Option<f64> {
        match rows {
            [Self { coefficient, s_out: 0.0, s_a: 0.0, s_b: 0.0 }] => Some(*coefficient),
            _ => None,
        }
    }

    /// # Errors
    /// As [`super::shape::Quadratic::check`].
    ///
    /// # Example
    /// ```
    /// use fixpair::initial::shape::ShapeRow;
    ///
    /// let row = ShapeRow { coefficient: 1.0, s_out: -1.0, s_a: 1.0, s_b: 0.5 };
    /// assert!(row.check().is_err()); // exponents sum to 0
    /// ```
    pub fn check(&self) -> Result<()> {
        let exponents = [self.s_out, self.s_a, self.s_b];
        if !(self.coefficient.is_finite() && exponents.iter().all(|s| s.is_finite())) {
            return Err(Error::NotFinite);
        }
        let sum: f64 = exponents.iter().sum();
        if libm::fabs(sum) > 1e-12 || exponents.iter().any(|&s| libm::fabs(s) > LARGEST_EXPONENT) {
            return Err(Error::Range);
        }
        Ok(())
    }
}

/// The usual templates. The discriminants are the numbers that C sees.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(i32)]
pub enum Shape {
    /// Phi^2.
    #[default]
    Local = 0,
    /// Largest for equal sides.
    Equilateral = 1,
    /// Orthogonal to local and equilateral on the sky. Squeezed it goes as k^-2 of the long mode, but the theory behind it as k^-1.
    Orthogonal = 2,
    /// The orthogonal template that goes as k^-1 where squeezed, as single-field inflation does; for halos.
    OrthogonalLss = 3,
    /// Largest where two sides add to the third.
    Folded = 4,
}

/// p of the orthogonal LSS template.
const P: f64 = {
    let pi = core::f64::consts::PI;
    27.0 / (-21.0 + 743.0 / (7.0 * (20.0 * pi * pi - 193.0)))
};

const LOCAL: [ShapeRow; 1] = [ShapeRow::new(1.0, 0, [0, 0])];

/// c_1 phi^2 + c_2 X_-1[phi X_1 phi] + c_3 X_-2[phi X_2 phi - (X_1 phi)^2].
const fn four(local: f64, first: f64, second: f64) -> [ShapeRow; 4] {
    [
        ShapeRow::new(local, 0, [0, 0]),
        ShapeRow::new(first, -1, [0, 1]),
        ShapeRow::new(second, -2, [0, 2]),
        ShapeRow::new(-second, -2, [1, 1]),
    ]
}

const EQUILATERAL: [ShapeRow; 4] = four(-3.0, 4.0, 2.0);
const ORTHOGONAL: [ShapeRow; 4] = four(-9.0, 10.0, 8.0);
const FOLDED: [ShapeRow; 4] = four(3.0, -3.0, -3.0);

/// In the order that needs the fewest transforms.
const ORTHOGONAL_LSS: [ShapeRow; 8] = [
    ShapeRow::new(P / 9.0, 2, [-1, -1]),
    ShapeRow::new(-20.0 * P / 9.0, -1, [-1, 2]),
    ShapeRow::new(10.0 * P / 3.0, 0, [-1, 1]),
    ShapeRow::new(-(3.0 + P), 0, [0, 0]),
    ShapeRow::new(4.0 + 10.0 * P / 9.0, -1, [0, 1]),
    ShapeRow::new(-4.0 * P / 3.0, 1, [0, -1]),
    ShapeRow::new(2.0 + 20.0 * P / 9.0, -2, [0, 2]),
    ShapeRow::new(-(2.0 + 20.0 * P / 9.0), -2, [1, 1]),
];

impl Shape {
    /// All shapes, in the order of their numbers.
    pub const ALL: [Self; 5] =
        [Self::Local, Self::Equilateral, Self::Orthogonal, Self::OrthogonalLss, Self::Folded];

    /// The rows of its kernel.
    ///
    /// ```
    /// use fixpair::initial::shape::Shape;
    ///
    /// assert_eq!(Shape::Equilateral.rows().len(), 4); // separable products
    /// ```
    #[must_use]
    pub const fn rows(self) -> &'static [ShapeRow] {
        match self {
            Self::Local => &LOCAL,
            Self::Equilateral => &EQUILATERAL,
            Self::Orthogonal => &ORTHOGONAL,
            Self::OrthogonalLss => &ORTHOGONAL_LSS,
            Self::Folded => &FOLDED,
        }
    }
}

impl TryFrom<i32> for Shape {
    type Error = Error;

    /// `Choice` for any number without a name.
    fn try_from(number: i32) -> Result<Self> {
        Self::ALL.into_iter().find(|&shape| shape as i32 == number).ok_or(Error::Choice)
    }
}
