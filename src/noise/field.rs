//! Modes that the caller drew: fixing and inverting them, and unit modes from a white-noise field on cells.

use core::sync::atomic::{AtomicBool, Ordering};

use super::blocks::{NORMAL_MEAN, RAYLEIGH_MEAN};
use super::realisation::{Amplitude, Phase, Realisation};
use crate::exec::Exec;
use crate::fft::Fft3;
use crate::math::sqrt;
use crate::mesh::{Brick, Space};
use crate::real::Real;
use crate::status::{Error, Result};
use crate::walk;

/// Imposes amplitude, phase, Nyquist planes and selection of a realisation on unit modes w(k), in place: what [`white_modes`](super::white_modes) does to
/// its own numbers.
///
/// Normal keeps w; Fixed makes it w/|w|, a zero mode becoming 1; `FixedToMean` multiplies that by sqrt(pi)/2. Self-conjugate
/// modes lose their imaginary part; their Fixed value is their sign (+1 for zero), times sqrt(2/pi) for `FixedToMean`.
/// Inverted negates. DC and modes outside the selection become +0; Nyquist planes become +0 or, `Filled`, are treated like the rest.
///
/// `modes`: (re, im) in the layout of `brick`, Hermitian; |w| need not be near 1. The modulus is taken in f64, without
/// overflow or underflow. Seed and scheme of `choice` are not used.
///
/// # Errors
/// `Brick` if the brick is not in Fourier space, `Length` if `modes` is too short, `NotFinite` if one is NaN or infinite (DC and Nyquist
/// modes included): `modes` is then untouched. `Hook` if `exec` failed.
///
/// # Cost
/// A read of `modes` to check them, then one read-modify-write.
///
/// # Example
/// ```
/// use fixpair::exec::Serial;
/// use fixpair::mesh::{Brick, Space};
/// use fixpair::noise::{Phase, Realisation, impose, white_modes};
///
/// let brick = Brick::whole(8, Space::Fourier)?;
/// let mut modes = vec![0.0_f64; brick.reals()];
/// white_modes(&mut modes, &brick, &Realisation::new(1), &Serial)?; // or the host's own
/// let original = modes.clone();
/// let inverted = Realisation { phase: Phase::Inverted, ..Realisation::new(0) };
/// impose(&mut modes, &brick, &inverted, &Serial)?;
/// assert!(modes.iter().zip(&original).all(|(a, b)| *a == -b));
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn impose<T: Real>(modes: &mut [T], brick: &Brick, choice: &Realisation, exec: &dyn Exec) -> Result<()> {
    brick.check_space(Space::Fourier)?;
    check_finite(modes, brick, exec)?;
    scale_and_impose(modes, brick, 1.0, choice, exec)
}

/// Unit modes from the caller's own white noise: transforms forward, multiplies by n^(-3/2), and imposes the choices as
/// [`impose`] does.
///
/// `data`: the field on the cells of `fft.configuration()`, independent numbers of unit variance; on return the modes
/// of `fft.fourier()`. F(k) = sum_x f(x) exp(-i k.x) has mean square n^3, so w = n^(-3/2) F has <|w|^2> = 1.
///
/// # Errors
/// `Length` if `data` is not `fft.length()` reals, `Brick` if the transform's bricks are not one mesh's two spaces, `NotFinite` if a
/// cell is NaN or infinite: `data` is then untouched. `NotFinite` also if the transform overflows, `Hook` if `fft` or `exec` failed:
/// the contents of `data` are then undefined.
///
/// # Cost
/// One transform, two reads to check, one read-modify-write.
///
/// # Example
/// ```
/// # use fixpair::{exec::Serial, fft::{Tables, Transform}, mesh::{Brick, Space}};
/// # #[repr(align(64))] struct Memory([u8; 1 << 16]);
/// # let (mut tables, mut work) = (Memory([0; 1 << 16]), Memory([0; 1 << 16]));
/// # let tables = Tables::<f64>::new(8, &mut tables.0)?;
/// # let mut fft = Transform::new(&tables, Brick::whole(8, Space::Configuration)?, &mut work.0, &Serial)?;
/// use fixpair::fft::Fft3;
/// use fixpair::noise::{Amplitude, Realisation, unit_modes_from_field};
///
/// let mut data: Vec<f64> = (0..fft.length()).map(|i| (i as f64 * 1.7).sin()).collect(); // white noise on the cells
/// let fixed = Realisation { amplitude: Amplitude::Fixed, ..Realisation::new(0) };
/// unit_modes_from_field(&mut fft, &mut data, &fixed, &Serial)?;
/// assert!((data[2].hypot(data[3]) - 1.0).abs() < 1e-14);
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn unit_modes_from_field<T: Real>(
    fft: &mut dyn Fft3<T>,
    data: &mut [T],
    choice: &Realisation,
    exec: &dyn Exec,
) -> Result<()> {
    let (cells, modes) = (*fft.configuration(), *fft.fourier());
    cells.check_space(Space::Configuration)?;
    modes.check_space(Space::Fourier)?;
    if cells.n() != modes.n() {
        return Err(Error::Brick);
    }
    if data.len() != fft.length() {
        return Err(Error::Length);
    }
    modes.check_length(data)?;
    check_finite(data, &cells, exec)?;
    fft.forward(data)?;
    check_finite(data, &modes, exec)?;
    let n = modes.n() as f64;
    scale_and_impose(data, &modes, 1.0 / (n * sqrt(n)), choice, exec)
}

/// `NotFinite` if an element of the brick is NaN or infinite, `Length` if the array is short.
fn check_finite<T: Real>(data: &[T], brick: &Brick, exec: &dyn Exec) -> Result<()> {
    let width = brick.space().width();
    let bad = AtomicBool::new(false);
    walk::walk::<T, 0, 1>(exec, brick, [], [data], &|run, [], [row]| {
        debug_assert_eq!(row.len(), run.length * width);
        // Without an early exit the loop is a few vector instructions.
        if row.iter().fold(false, |bad, x| bad | !x.is_finite()) {
            bad.store(true, Ordering::Relaxed);
        }
    })?;
    if bad.into_inner() { Err(Error::NotFinite) } else { Ok(()) }
}

/// The passes behind the checks: w = scale * F, then the choices.
fn scale_and_impose<T: Real>(
    modes: &mut [T],
    brick: &Brick,
    scale: f64,
    choice: &Realisation,
    exec: &dyn Exec,
) -> Result<()> {
    let n = brick.n();
    let half = n / 2;
    let own_negative = |index: usize| index == 0 || index == half;
    let sign = if choice.phase == Phase::Inverted { -1.0 } else { 1.0 };
    walk::walk::<T, 1, 0>(exec, brick, [modes], [], &|run, [row], []| {
        let [x, y, first] = run.index;
        let within = choice.modes_along_l(n, Brick::mode(n, x), Brick::mode(n, y));
        for (mode, z) in row.as_chunks_mut::<2>().0.iter_mut().zip(first..) {
            if (x, y, z) == (0, 0, 0) || z >= within {
                *mode = [T::ZERO; 2];
                continue;
            }
            let mut w = mode.map(T::to_f64);
            let real = own_negative(x) && own_negative(y) && own_negative(z);
            if real {
                w[1] = 0.0;
            }
            let factor = match choice.amplitude {
                Amplitude::Normal => scale,
                Amplitude::Fixed => {
                    w = direction(w);
                    1.0
                }
                Amplitude::FixedToMean => {
                    w = direction(w);
                    if real { NORMAL_MEAN } else { RAYLEIGH_MEAN }
                }
            };
            *mode = w.map(|x| T::from_f64(sign * (factor * x)));
        }
    })
}

/// w/|w|, or 1 if w = 0.
#[inline(always)]
fn direction([re, im]: [f64; 2]) -> [f64; 2] {
    // Not f64::max: it is a call in some builds, and the arguments are finite.
    let (a, b) = (magnitude(re), magnitude(im));
    let largest = if a > b { a } else { b };
    if largest == 0.0 {
        return [1.0, 0.0];
    }
    // Divided by the larger part, the squares neither overflow nor vanish together.
    let (re, im) = (re / largest, im / largest);
    let modulus = sqrt(re * re + im * im);
    [re / modulus, im / modulus]
}

#[inline(always)]
const fn magnitude(x: f64) -> f64 {
    f64::from_bits(x.to_bits() & !(1 << 63))
}
