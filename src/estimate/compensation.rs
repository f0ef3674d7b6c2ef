//! What a mass assignment does to modes, and how it is undone.
//!
//! Assigning particles with a window of order p (NGP 1, CIC 2, TSC 3, PCS 4) multiplies the modes of the density by
//!     W(k) = prod_a sinc(pi n_a/N)^p,     sinc x = sin(x)/x,
//! and folds the modes k + 2 k_Nyquist m onto k. Two corrections of the amplitude are usual:
//!
//! - 1/W. Right for the signal where aliasing is negligible: at low k, or up to nearly the Nyquist frequency after interlacing, which
//!   removes the odd images. The shot noise of a mesh that is not interlaced then rises towards the Nyquist frequency.
//! - C1^(-1/2), C1(k) = sum_m W(k + 2 k_Nyquist m)^2 (Jing 2005, arXiv:astro-ph/0409240, eq. 20; the product over axes as used by Sefusatti et al. 2016,
//!   arXiv:1512.07295). Exact for shot noise, which is white before it is aliased: V sum w^2/(sum w)^2 at all k, so that flat noise may be
//!   subtracted. Right for meshes that are not interlaced. With s = sin^2(pi n/N) one axis gives 1; 1 - 2s/3; 1 - s + 2s^2/15;
//!   1 - 4s/3 + 2s^2/5 - 4s^3/315.

use core::f64::consts::PI;

use crate::pm::Window;

/// What the modes of a field are multiplied by.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Compensation {
    /// 1.
    #[default]
    None,
    /// 1/W: for interlaced meshes, and for the signal at low k.
    Window(Window),
    /// C1^(-1/2): for meshes that are not interlaced; their shot noise becomes flat.
    Aliased(Window),
}

impl Compensation {
    /// The factor of one axis at mode number `m` of a mesh of side `n`, 0 <= m <= n/2.
    #[must_use]
    pub fn factor(self, m: usize, n: usize) -> f64 {
        let x = PI * m as f64 / n as f64;
        match self {
            Self::None => 1.0,
            Self::Window(_) if m == 0 => 1.0,
            Self::Window(window) => {
                let inverse = x / libm::sin(x);
                (1..window as i32).fold(inverse, |power, _| power * inverse)
            }
            Self::Aliased(window) => {
                let sine = libm::sin(x);
                let s = sine * sine;
                let c1 = match window {
                    Window::NearestGridPoint => 1.0,
                    Window::CloudInCell => 1.0 - 2.0 / 3.0 * s,
                    Window::TriangularShapedCloud => 1.0 - s * (1.0 - 2.0 / 15.0 * s),
                    Window::PiecewiseCubicSpline => 1.0 - s * (4.0 / 3.0 - s * (2.0 / 5.0 - 4.0 / 315.0 * s)),
                };
                1.0 / libm::sqrt(c1)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn closed_forms_are_the_sums_over_images() {
        let n = 32;
        for window in Window::ALL {
            let order = window as i32;
            for m in 0..=n / 2 {
                let images = 40_000;
                let sum: f64 = (-images..=images)
                    .map(|image| {
                        let x = PI * (m as f64 / n as f64 + f64::from(image));
                        if x == 0.0 { 1.0 } else { (libm::sin(x) / x).powi(2 * order) }
                    })
                    .sum();
                let factor = Compensation::Aliased(window).factor(m, n);
                // What is left out of the sum: 2/(pi^2 images) for NGP, nothing for the others.
                assert!((factor.powi(-2) - sum).abs() < 0.3 / f64::from(images), "{window:?} {m}");
                if order > 1 {
                    assert!((factor.powi(-2) - sum).abs() < 1e-12, "{window:?} {m}");
                }
            }
        }
    }

    #[test]
    fn the_window_is_undone() {
        for window in Window::ALL {
            let nyquist = Compensation::Window(window).factor(8, 16);
            assert!((nyquist - (PI / 2.0).powi(window as i32)).abs() < 1e-14);
            assert_eq!(Compensation::Window(window).factor(0, 16), 1.0);
            assert_eq!(Compensation::Aliased(window).factor(0, 16), 1.0);
        }
        assert_eq!(Compensation::None.factor(3, 16), 1.0);
    }
}
