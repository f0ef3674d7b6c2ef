//! The correlation function of meshes, by the inverse transform of the power of each mode.
//!     xi(x) = <f(y + x) g(y)> = sum_k f_k g_k* exp(+i k.x)
//! for modes with f(x) = sum_k f_k exp(+i k.x): multiply modes ([`correlation_modes`]), transform back (a hook's un-normalised inverse is this sum), and
//! sum over separations ([`correlation_sums`]). Separations are x = (L/N) m with m_a in (-N/2, N/2]; bins hold ranges of |m|^2, mu = |m.a|/|m|, or
//! (m_perp^2, |m.a|), and multipoles are xi_l = (2l + 1) <xi L_l(m.a/|m|)>, odd ones too (0 if f is g).
//!
//! Shot noise sits at m = 0 alone (spread over a few cells without [`Compensation::Aliased`]): edges that begin at 1 leave it out.

use super::binning::Binning;
use super::compensation::Compensation;
use super::sweep::{Source, sweep, sweep_scratch};
use crate::exec::Exec;
use crate::mesh::{Brick, Space};
use crate::real::Real;
use crate::scratch::{Arena, Layout};
use crate::simd::Simd;
use crate::status::{Error, Result};
use crate::walk::walk;
use crate::within::Within;

/// Scratch of [`correlation_modes`]: N/2 + 1 numbers.
///
/// # Errors
/// `Brick` for a brick of configuration space, `Overflow`.
///
/// # Example
/// ```
/// use fixpair::estimate::correlation::correlation_modes_scratch;
/// use fixpair::mesh::{Brick, Space};
///
/// assert_eq!(correlation_modes_scratch(&Brick::whole(64, Space::Fourier)?)?.align, 64);
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn correlation_modes_scratch(brick: &Brick) -> Result<Layout> {
    brick.check_space(Space::Fourier)?;
    Layout::EMPTY.and::<f64>(brick.n() / 2 + 1)
}

/// f_k <- scale f_k g_k*, compensated, in place; the mode k = 0 becomes 0, so that xi sums to 0 over the box.
///
/// `modes`: f on the Fourier `brick`; `other`: g, or none for f itself; `compensation`: of f and of g (the second is not used where g is f); `scale`: the
/// product of the factors of both fields, 1/N^6 for modes of un-normalised transforms, so that nothing overflows in f32.
///
/// # Errors
/// `Brick` for a brick of configuration space, `Length`, `Scratch`, `Alignment`, `Hook`, `NotFinite` for a scale that is not.
/// Modes are not checked: a NaN shows in [`read_sums`](super::binning::read_sums).
///
/// Cost: one pass over the modes.
///
/// # Example
/// ```
/// use fixpair::estimate::{compensation::Compensation, correlation::correlation_modes};
/// use fixpair::exec::Serial;
/// use fixpair::mesh::{Brick, Space};
/// # #[repr(align(64))] struct Memory([u8; 1 << 16]);
/// # let mut memory = Memory([0; 1 << 16]);
/// # let scratch = &mut memory.0;
///
/// let modes = Brick::whole(8, Space::Fourier)?;
/// let mut field = vec![3.0_f64; modes.reals()];
/// correlation_modes(&mut field, None, [Compensation::None; 2], 1.0, &modes, scratch, &Serial)?; // |f_k|^2, and no k = 0
/// assert!(field[0] == 0.0 && (field[2] - 18.0).abs() < 1e-12 && field[3] == 0.0);
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn correlation_modes<T: Real>(
    modes: &mut [T],
    other: Option<&[T]>,
    compensation: [Compensation; 2],
    scale: f64,
    brick: &Brick,
    scratch: &mut [u8],
    exec: &dyn Exec,
) -> Result<()> {
    let layout = correlation_modes_scratch(brick)?;
    if !scale.is_finite() {
        return Err(Error::NotFinite);
    }
    let n = brick.n();
    let factor = Arena::new(scratch, layout)?.take::<f64>(n / 2 + 1)?;
    let second = if other.is_some() { compensation[1] } else { compensation[0] };
    for (m, factor) in factor.iter_mut().enumerate() {
        *factor = compensation[0].factor(m, n) * second.factor(m, n);
    }
    let factor = &*factor;
    let scale_of = |index: [usize; 3], m: usize| {
        let [x, y] = [index[0], index[1]].map(|index| Brick::mode(n, index).unsigned_abs() as usize);
        let z = index[2] + m;
        if x + y + z == 0 { 0.0 } else { scale * (factor.at(x) * factor.at(y) * factor.at(z)) }
    };
    match other {
        None => walk::<T, 1, 0>(exec, brick, [modes], [], &|run, [row], []| {
            for (m, f) in row.as_chunks_mut::<2>().0.iter_mut().enumerate() {
                let [re, im] = f.map(Real::to_f64);
                *f = [T::from_f64((re * re + im * im) * scale_of(run.index, m)), T::ZERO];
            }
        }),
        Some(other) => walk::<T, 1, 1>(exec, brick, [modes], [other], &|run, [row], [other]| {
            for (m, (f, g)) in row.as_chunks_mut::<2>().0.iter_mut().zip(other.as_chunks::<2>().0).enumerate()
            {
                let ([a, b], [c, d]) = (f.map(Real::to_f64), g.map(Real::to_f64));
                let scale = scale_of(run.index, m);
                *f = [T::from_f64((a * c + b * d) * scale), T::from_f64((b * c - a * d) * scale)];
            }
        }),
    }
}

/// Scratch of [`correlation_sums`] for `meshes` meshes: as [`power_sums_scratch`](super::power::power_sums_scratch).
///
/// # Errors
/// `Brick` for a brick of Fourier space; else as [`Binning::words`].
///
/// # Example
/// ```
/// use fixpair::estimate::binning::Binning;
/// use fixpair::estimate::correlation::correlation_sums_scratch;
/// use fixpair::mesh::{Brick, Space};
///
/// let brick = Brick::whole(64, Space::Configuration)?;
/// assert_eq!(correlation_sums_scratch(&brick, &Binning::shells(&[1, 4, 9]), 1)?.align, 64);
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn correlation_sums_scratch(brick: &Brick, binning: &Binning<'_>, meshes: usize) -> Result<Layout> {
    brick.check_space(Space::Configuration)?;
    sweep_scratch(brick, &binning.check()?, meshes)
}

/// Adds xi(x) L_l, summed over the separations of a brick bin by bin, to `sums`, for several meshes in one sweep.
///
/// `sums`: [`Binning::words`] integers, zero at first; [`read_sums`](super::binning::read_sums) turns them into bins. `meshes`: xi on the configuration `brick`.
///
/// # Errors
/// `Brick` for a brick of Fourier space, `Length`, `Scratch`, `Alignment`, `Hook`, as [`Binning::words`] for the binning; nothing is then
/// added. A NaN shows in `read_sums`.
///
/// Cost: one pass over each mesh.
///
/// # Example
/// ```
/// use fixpair::estimate::binning::{Bin, Binning, read_sums};
/// use fixpair::estimate::correlation::correlation_sums;
/// use fixpair::exec::Serial;
/// use fixpair::mesh::{Brick, Space};
/// # #[repr(align(64))] struct Memory([u8; 1 << 18]);
/// # let mut memory = Memory([0; 1 << 18]);
/// # let scratch = &mut memory.0;
///
/// let cells = Brick::whole(8, Space::Configuration)?;
/// let xi = vec![0.5_f64; cells.reals()]; // the inverse transform of correlation_modes
/// let binning = Binning::shells(&[1, 4]); // separations of 1 to 2 cells
/// let (mut sums, mut bins, mut values) = (vec![0; binning.words(1)?], [Bin::default()], [0.0]);
/// correlation_sums(&mut sums, &[&xi], &cells, &binning, scratch, &Serial)?;
/// read_sums(&mut bins, &mut values, &sums, &binning, 1)?;
/// assert_eq!((bins[0].count, values[0]), (26, 13.0));
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn correlation_sums<T: Real>(
    sums: &mut [i64],
    meshes: &[&[T]],
    brick: &Brick,
    binning: &Binning<'_>,
    scratch: &mut [u8],
    exec: &dyn Exec,
) -> Result<()> {
    brick.check_space(Space::Configuration)?;
    for mesh in meshes {
        brick.check_length(mesh)?;
    }
    let separations = Separations { meshes, stride: brick.stride()[2] };
    sweep(sums, brick, &binning.check()?, &separations, scratch, exec, Simd::detect())
}

/// Correlation functions on meshes.
struct Separations<'a, T> {
    meshes: &'a [&'a [T]],
    stride: usize,
}

impl<T: Real> Source for Separations<'_, T> {
    fn spectra(&self) -> usize {
        self.meshes.len()
    }

    #[inline(always)]
    fn row(&self, spectrum: usize, _: [usize; 2], offset: usize, _: bool, products: &mut [f64]) {
        let mesh = self.meshes.at(spectrum).part(offset..);
        if self.stride == 1 {
            products.iter_mut().zip(mesh).for_each(|(product, value)| *product = value.to_f64());
        } else {
            for (m, product) in products.iter_mut().enumerate() {
                *product = mesh.at(m * self.stride).to_f64();
            }
        }
    }
}
