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

use crate::exec::Exec;
use crate::mesh::{Brick, Space};
use crate::pm::Window;
use crate::real::Real;
use crate::scratch::{Arena, Layout};
use crate::status::{Error, Result};
use crate::walk::walk;
use crate::within::Within;

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
    ///
    /// ```
    /// use fixpair::estimate::compensation::Compensation;
    /// use fixpair::pm::Window;
    ///
    /// let cic = Compensation::Window(Window::CloudInCell).factor(32, 64); // at the Nyquist frequency
    /// assert!((cic - (std::f64::consts::PI / 2.0).powi(2)).abs() < 1e-12); // 1/sinc^2
    /// ```
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

/// Scratch of [`compensate`]: N/2 + 1 numbers.
///
/// # Errors
/// `Brick` for a brick of configuration space, `Overflow`.
///
/// # Example
/// ```
/// use fixpair::estimate::compensation::compensate_scratch;
/// use fixpair::mesh::{Brick, Space};
///
/// assert!(compensate_scratch(&Brick::whole(64, Space::Fourier)?)?.size < 4096);
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn compensate_scratch(brick: &Brick) -> Result<Layout> {
    brick.check_space(Space::Fourier)?;
    Layout::EMPTY.and::<f64>(brick.n() / 2 + 1)
}

/// f_k <- scale a(|n_x|) a(|n_y|) a(|n_z|) f_k, in place, a the factor of the compensation: what kernels that do not compensate by
/// themselves, as those of the bispectrum, want their modes to be. With scale = 1/(sum of weights) a deposit becomes its density contrast.
///
/// # Errors
/// `Brick` for a brick of configuration space, `Length`, `Scratch`, `Alignment`, `Hook`, `NotFinite` for a scale that is not. Modes are not checked.
///
/// Cost: one pass over the modes.
///
/// # Example
/// ```
/// use fixpair::estimate::compensation::{Compensation, compensate};
/// use fixpair::exec::Serial;
/// use fixpair::mesh::{Brick, Space};
/// use fixpair::pm::Window;
/// # #[repr(align(64))] struct Memory([u8; 1 << 16]);
/// # let mut memory = Memory([0; 1 << 16]);
/// # let scratch = &mut memory.0;
///
/// let brick = Brick::whole(8, Space::Fourier)?;
/// let mut modes = vec![1.0_f64; brick.reals()];
/// compensate(&mut modes, Compensation::Window(Window::CloudInCell), 1.0, &brick, scratch, &Serial)?;
/// assert!(modes[0] == 1.0 && modes[2] > 1.0);
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn compensate<T: Real>(
    modes: &mut [T],
    compensation: Compensation,
    scale: f64,
    brick: &Brick,
    scratch: &mut [u8],
    exec: &dyn Exec,
) -> Result<()> {
    let layout = compensate_scratch(brick)?;
    if !scale.is_finite() {
        return Err(Error::NotFinite);
    }
    let n = brick.n();
    let factor = Arena::new(scratch, layout)?.take::<f64>(n / 2 + 1)?;
    for (m, factor) in factor.iter_mut().enumerate() {
        *factor = compensation.factor(m, n);
    }
    let factor = &*factor;
    walk::<T, 1, 0>(exec, brick, [modes], [], &|run, [row], []| {
        let [x, y] = [run.index[0], run.index[1]].map(|i| Brick::mode(n, i).unsigned_abs() as usize);
        let across = scale * (factor.at(x) * factor.at(y));
        for (mode, along) in row.as_chunks_mut::<2>().0.iter_mut().zip(factor.part(run.index[2]..)) {
            *mode = mode.map(|part| T::from_f64(part.to_f64() * (across * along)));
        }
    })
}

#[cfg(test)]
mod tests {
    use std::vec::Vec;

    use super::*;
    use crate::exec::Serial;
    use crate::reference::built::memory;

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

    #[test]
    fn compensated_modes_are_multiplied_axis_by_axis() {
        let chosen = Compensation::Window(Window::TriangularShapedCloud);
        for brick in [
            Brick::whole(6, Space::Fourier).unwrap(),
            Brick::transposed_slab(6, 1, 4).unwrap(),
            Brick::general(6, Space::Fourier, [1, 2, 1], [3, 2, 3], [1, 3, 6]).unwrap(),
        ] {
            let before: Vec<f64> = (0..brick.reals()).map(|i| libm::sin(i as f64)).collect();
            let mut after = before.clone();
            let scratch = memory(compensate_scratch(&brick).unwrap());
            compensate(&mut after, chosen, 0.5, &brick, scratch, &Serial).unwrap();
            let (start, count, stride) = (brick.start(), brick.count(), brick.stride());
            for local in (0..count[0] * count[1] * count[2])
                .map(|i| [i / (count[1] * count[2]), i / count[2] % count[1], i % count[2]])
            {
                let factor: f64 = (0..3)
                    .map(|axis| Brick::mode(6, start[axis] + local[axis]).unsigned_abs() as usize)
                    .map(|m| chosen.factor(m, 6))
                    .product();
                let at = 2 * (0..3).map(|axis| local[axis] * stride[axis]).sum::<usize>();
                for part in [at, at + 1] {
                    assert!((after[part] - 0.5 * factor * before[part]).abs() < 1e-15 * factor);
                }
            }
        }
    }
}
