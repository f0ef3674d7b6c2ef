//! Which force: how derivatives are taken, what is divided out, and what is left to a short-range solver.

use core::f64::consts::PI;

use crate::mesh::Brick;
use crate::pm::Window;
use crate::scratch::{Arena, Layout};
use crate::status::{Error, Result};
use crate::within::Within;

/// How a derivative is taken on a mesh of spacing H = L/n; theta = k_a H on one axis, the Laplacian is the sum over the axes.
///
/// | | gradient / i | -Laplacian | error |
/// |---|---|---|---|
/// | `Exact` | k | k^2 | none |
/// | `TwoPoint` | sin(theta)/H | (2/H)^2 sin^2(theta/2) | O(H^2) |
/// | `FourPoint` | (8 sin theta - sin 2 theta)/(6 H) | (15 - 16 cos theta + cos 2 theta)/(6 H^2) | O(H^4) |
///
/// They are the transforms of the centred stencils (Hockney & Eastwood 1988): f' = [f(+1) - f(-1)]/(2 H) and [8 (f(+1) - f(-1)) - (f(+2) -
/// f(-2))]/(12 H); f'' = [f(+1) - 2 f(0) + f(-1)]/H^2, summed over the axes the 7-point Laplacian, and [16 (f(+1) + f(-1)) - (f(+2) + f(-2)) - 30
/// f(0)]/(12 H^2), the 13-point one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(i32)]
pub enum Difference {
    /// Spectral.
    #[default]
    Exact = 0,
    /// The nearest neighbour on either side: second order.
    TwoPoint = 1,
    /// Two neighbours on either side: fourth order.
    FourPoint = 2,
}

impl Difference {
    /// The gradient at theta, without i, times H: odd, as a function of |theta| and its sign.
    fn gradient(self, theta: f64) -> f64 {
        let (sine, cosine) = libm::sincos(theta);
        match self {
            Self::Exact => theta,
            Self::TwoPoint => sine,
            Self::FourPoint => sine * (4.0 - cosine) / 3.0,
        }
    }

    /// Minus the Laplacian at theta, times H^2; in s = sin^2(theta/2), which does not cancel at small theta.
    fn laplacian(self, theta: f64) -> f64 {
        let sine = libm::sin(0.5 * theta);
        let s = sine * sine;
        match self {
            Self::Exact => theta * theta,
            Self::TwoPoint => 4.0 * s,
            Self::FourPoint => 4.0 * s * (1.0 + s / 3.0),
        }
    }
}

impl TryFrom<i32> for Difference {
    type Error = Error;

    fn try_from(value: i32) -> Result<Self> {
        [Self::Exact, Self::TwoPoint, Self::FourPoint]
            .into_iter()
            .find(|&difference| difference as i32 == value)
            .ok_or(Error::Choice)
    }
}

/// Highest power of a window that is divided out.
const HIGHEST_POWER: u32 = 4;

/// The force on a mesh: what the modes of the density contrast are multiplied by.
///
/// ```text
/// phi_k = - S(k) / (W(k)^power K2(k)) delta_k,     F_k = - i K_a(k) phi_k,     S(k) = exp(-k^2 r_s^2)
/// ```
///
/// K2 is minus the Laplacian, i K_a the gradient. The default is exact in both, with no window and no split; for runs with more than one cell a
/// particle [`ForceLaw::FOUR_POINT`] is the better one.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ForceLaw {
    /// K2.
    pub laplacian: Difference,
    /// K_a.
    pub gradient: Difference,
    /// W and its power, 1 to 4: 1 undoes the smoothing of the deposit, 2 that of the deposit and the read-out.
    pub window: Option<(Window, u32)>,
    /// r_s >= 0, in the unit of the box: 0 for the whole force. A Gaussian filter of dispersion s in x is r_s = s/sqrt 2.
    pub split_scale: f64,
}

impl ForceLaw {
    /// Exact Laplacian and four-point gradient: FastPM's kernel 1_4. The gradient vanishes at the Nyquist wavenumber of the mesh,
    /// where with two cells a particle the lattice of the particles has its first images; an exact one lets them grow, which adds 10% to P(k) at
    /// half the particles' Nyquist wavenumber by z = 0.
    pub const FOUR_POINT: Self = Self {
        laplacian: Difference::Exact,
        gradient: Difference::FourPoint,
        window: None,
        split_scale: 0.0,
    };

    fn check(&self) -> Result<()> {
        if !self.split_scale.is_finite() {
            return Err(Error::NotFinite);
        }
        let power = self.window.map_or(1, |(_, power)| power);
        if self.split_scale < 0.0 || !(1..=HIGHEST_POWER).contains(&power) {
            Err(Error::Range)
        } else {
            Ok(())
        }
    }

    /// What theta on one axis contributes to S/W^power.
    fn factor(&self, theta: f64, cells_per_length: f64) -> f64 {
        if theta == 0.0 {
            return 1.0;
        }
        let inverse = 0.5 * theta / libm::sin(0.5 * theta);
        let window = self.window.map_or(1.0, |(window, power)| {
            (0..window as u32 * power).fold(1.0, |product, _| product * inverse)
        });
        let kr = theta * (self.split_scale * cells_per_length);
        window * libm::exp(-kr * kr)
    }
}

/// The factors of one axis, mode by mode, in units of H; scratch of the kernels.
pub(super) struct Tables<'a> {
    n: usize,
    /// K_a H.
    pub(super) gradient: &'a [f64],
    /// K_a's share of K2 H^2.
    pub(super) laplacian: &'a [f64],
    /// Its share of S/W^power.
    pub(super) factor: &'a [f64],
    /// H.
    pub(super) spacing: f64,
}

impl<'a> Tables<'a> {
    /// Scratch of the tables.
    pub(super) fn layout(n: usize) -> Result<Layout> {
        Layout::EMPTY.and::<f64>(n)?.and::<f64>(n)?.and::<f64>(n)
    }

    /// `NotFinite`, `Range` for the law or the box; `Scratch`, `Alignment`.
    pub(super) fn new(n: usize, law: &ForceLaw, box_size: f64, scratch: &'a mut [u8]) -> Result<Self> {
        law.check()?;
        if !box_size.is_finite() {
            return Err(Error::NotFinite);
        }
        let (spacing, cells_per_length) = (box_size / n as f64, n as f64 / box_size);
        if !(spacing.is_normal() && cells_per_length.is_normal() && spacing > 0.0) {
            return Err(Error::Range);
        }
        let mut arena = Arena::new(scratch, Self::layout(n)?)?;
        let gradient = arena.take::<f64>(n)?;
        let laplacian = arena.take::<f64>(n)?;
        let factor = arena.take::<f64>(n)?;
        for m in 0..=n / 2 {
            let theta = 2.0 * PI * m as f64 / n as f64;
            // -m first: 0 and n/2 are their own mirrors, and keep the sign of +m.
            for (i, sign) in [(if m == 0 { 0 } else { n - m }, -1.0), (m, 1.0)] {
                gradient.put(i, sign * law.gradient.gradient(theta));
                laplacian.put(i, law.laplacian.laplacian(theta));
                factor.put(i, law.factor(theta, cells_per_length));
            }
        }
        Ok(Self { n, gradient, laplacian, factor, spacing })
    }

    /// Of `length` modes from z on, in the row (x, y): how many are no Nyquist modes.
    pub(super) fn inside(&self, [x, y, z]: [usize; 3], length: usize) -> usize {
        let half = self.n / 2;
        let nyquist = [x, y].iter().any(|&i| Brick::mode(self.n, i).unsigned_abs() as usize == half);
        if nyquist { 0 } else { half.saturating_sub(z).min(length) }
    }
}
