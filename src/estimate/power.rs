//! The power spectrum of modes, its multipoles and its wedges.
//!
//! P(k) = V <|f_k|^2> for modes with f(x) = sum_k f_k exp(+i k.x) in a box of volume V; the cross spectrum of f and g is V <f_k g_k*>, and
//!     P_l(k) = (2l + 1) V <f_k g_k* L_l(k.a/|k|)>
//! about a line of sight a (Kaiser 1987; Cole, Fisher & Weinberg 1994). The mean runs over k and -k, so that even multipoles are real, and odd
//! ones imaginary: there the sums hold Im f g* L_l, and P_l is i times the result. Its sign: where g is f moved by a small step along +a,
//! f g* = |f|^2 exp(+i k.d), and the dipole is positive.
//!
//! N_modes counts both k and -k: 26, 66, 158, 234, 410, 470 for the unit shells b^2 <= |n|^2 < (b+1)^2, b = 1..6. Modes of the plane
//! l = n/2, and of n/2 on other axes, count as +n/2 in mu. Nothing is subtracted and nothing normalised: see [`normalise`](super::binning::normalise),
//! [`shot_noise`] and [`subtract_shot_noise`].
//!
//! Bricks that leave axis 2 whole (all slabs) add up to the bits of the whole mesh, in every memory layout; pencils that cut axis 2 agree
//! to rounding, because a run of modes is cut where they end.

use super::binning::{Bin, Binning, check_values, order_numbers};
use super::compensation::Compensation;
use super::sweep::{Source, sweep, sweep_scratch, weights};
use crate::exec::Exec;
use crate::mesh::{Brick, Space};
use crate::real::Real;
use crate::scratch::{Arena, Layout};
use crate::simd::Simd;
use crate::status::{Error, Result};
use crate::within::Within;

/// Scratch of [`power_sums`] for `pairs` pairs of fields. At most 64 sets of partial sums, or 64 MiB of them (two sets if one is more), 4 bytes for
/// each |n|^2 up to the last edge, 4 for each square of (i, j), and some twenty rows of f64 for each set.
///
/// # Errors
/// `Brick` for a brick of configuration space; else as [`Binning::words`].
///
/// # Example
/// ```
/// use fixpair::estimate::binning::Binning;
/// use fixpair::estimate::power::power_sums_scratch;
/// use fixpair::mesh::{Brick, Space};
///
/// let layout = power_sums_scratch(&Brick::whole(64, Space::Fourier)?, &Binning::shells(&[1, 4, 9]), 1)?;
/// assert_eq!(layout.align, 64);
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn power_sums_scratch(brick: &Brick, binning: &Binning<'_>, pairs: usize) -> Result<Layout> {
    brick.check_space(Space::Fourier)?;
    let factors = factors_layout(brick, pairs)?;
    let sweep = sweep_scratch(brick, &binning.check()?, pairs)?;
    factors.and::<u8>(sweep.size)
}

fn factors_layout(brick: &Brick, pairs: usize) -> Result<Layout> {
    let axis = pairs.checked_mul(brick.n() / 2 + 1).ok_or(Error::Overflow)?;
    let row = pairs.checked_mul(brick.count()[2]).ok_or(Error::Overflow)?;
    Layout::EMPTY.and::<f64>(axis)?.and::<f64>(row)
}

/// Adds f_k g_k* L_l, summed over the modes of a brick bin by bin, to `sums`, for several pairs (f, g) of fields in one sweep.
///
/// `sums`: [`Binning::words`] integers, zero at first; [`read_sums`](super::binning::read_sums) turns them into bins. `fields`: modes on the Fourier `brick`.
/// `pairs`: numbers of fields: `[0, 0]` for the spectrum of the first, `[0, 1]` for its cross spectrum with the second. `compensation`:
/// one for each field.
///
/// # Errors
/// `Brick` for a brick of configuration space, `Length` for arrays of other lengths, `Range` for a pair of a field that there is not, as
/// [`Binning::words`] for the binning, `Scratch`, `Alignment`, `Hook`; nothing is then added. A NaN or an infinite product shows in `read_sums`.
///
/// Cost: one pass over each field for each pair it is in (its row stays in cache).
///
/// # Example
/// ```
/// use fixpair::estimate::binning::{Bin, Binning, read_sums};
/// use fixpair::estimate::compensation::Compensation;
/// use fixpair::estimate::power::power_sums;
/// use fixpair::exec::Serial;
/// use fixpair::mesh::{Brick, Space};
/// use fixpair::noise::{Amplitude, Realisation, white_modes};
/// # #[repr(align(64))] struct Memory([u8; 1 << 18]);
/// # let mut memory = Memory([0; 1 << 18]);
/// # let scratch = &mut memory.0;
///
/// let brick = Brick::whole(8, Space::Fourier)?;
/// let mut modes = vec![0.0_f64; brick.reals()];
/// white_modes(&mut modes, &brick, &Realisation { amplitude: Amplitude::Fixed, ..Realisation::new(1) }, &Serial)?;
/// let binning = Binning::shells(&[1, 4, 9]);
/// let mut sums = vec![0; binning.words(1)?];
/// power_sums(&mut sums, &[&modes], &[[0, 0]], &[Compensation::None], &brick, &binning, scratch, &Serial)?;
/// let (mut bins, mut values) = ([Bin::default(); 2], [0.0; 2]);
/// read_sums(&mut bins, &mut values, &sums, &binning, 1)?;
/// assert!(bins[0].first > 1.0 && bins[0].first < 2.0); // mean |n|
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn power_sums<T: Real>(
    sums: &mut [i64],
    fields: &[&[T]],
    pairs: &[[usize; 2]],
    compensation: &[Compensation],
    brick: &Brick,
    binning: &Binning<'_>,
    scratch: &mut [u8],
    exec: &dyn Exec,
) -> Result<()> {
    power_sums_on(sums, fields, pairs, compensation, brick, binning, scratch, exec, Simd::detect())
}

/// [`power_sums`] on a given code path.
pub(super) fn power_sums_on<T: Real>(
    sums: &mut [i64],
    fields: &[&[T]],
    pairs: &[[usize; 2]],
    compensation: &[Compensation],
    brick: &Brick,
    binning: &Binning<'_>,
    scratch: &mut [u8],
    exec: &dyn Exec,
    simd: Simd,
) -> Result<()> {
    let layout = power_sums_scratch(brick, binning, pairs.len())?;
    for field in fields {
        brick.check_length(field)?;
    }
    if compensation.len() != fields.len() {
        return Err(Error::Length);
    }
    if pairs.as_flattened().iter().any(|&field| field >= fields.len()) {
        return Err(Error::Range);
    }
    let mut arena = Arena::new(scratch, layout)?;
    let (half, length) = (brick.n() / 2 + 1, brick.count()[2]);
    let factor = arena.take::<f64>(pairs.len() * half)?;
    let along = arena.take::<f64>(pairs.len() * length)?;
    let checked = binning.check()?;
    let rest = arena.take::<u8>(sweep_scratch(brick, &checked, pairs.len())?.size)?;
    for ((pair, factor), along) in
        pairs.iter().zip(factor.chunks_exact_mut(half)).zip(along.chunks_exact_mut(length.max(1)))
    {
        for (m, factor) in factor.iter_mut().enumerate() {
            let [f, g] = pair.map(|field| compensation.at(field).factor(m, brick.n()));
            *factor = f * g;
        }
        weights(brick, along);
        for (along, factor) in along.iter_mut().zip(factor.part(brick.start()[2]..)) {
            *along *= factor;
        }
    }
    let modes = Modes { fields, pairs, factor, along, brick };
    sweep(sums, brick, &checked, &modes, rest, exec, simd)
}

/// Pairs of fields of modes.
struct Modes<'a, T> {
    fields: &'a [&'a [T]],
    pairs: &'a [[usize; 2]],
    /// Compensation of each pair along an axis, by |n_a|.
    factor: &'a [f64],
    /// The same along the row, times the weight.
    along: &'a [f64],
    brick: &'a Brick,
}

impl<T: Real> Source for Modes<'_, T> {
    fn spectra(&self) -> usize {
        self.pairs.len()
    }

    #[inline(always)]
    fn row(&self, spectrum: usize, index: [usize; 2], offset: usize, odd: bool, products: &mut [f64]) {
        let n = self.brick.n();
        let factor = self.factor.part(spectrum * (n / 2 + 1)..);
        let [x, y] = index.map(|index| factor.at(Brick::mode(n, index).unsigned_abs() as usize));
        let across = x * y;
        let length = self.brick.count()[2];
        let along = self.along.part(spectrum * length..spectrum * length + products.len());
        let [f, g] = self.pairs.at(spectrum).map(|field| self.fields.at(field));
        let stride = self.brick.stride()[2];
        if stride == 1 {
            let range = 2 * offset..2 * (offset + products.len());
            let (f, g) = (f.part(range.clone()).as_chunks::<2>().0, g.part(range).as_chunks::<2>().0);
            let points = products.iter_mut().zip(f).zip(g).zip(along);
            if odd {
                points.for_each(|(((product, f), g), along)| {
                    *product = imaginary_part(f, g) * (across * along);
                });
            } else {
                points.for_each(|(((product, f), g), along)| *product = real_part(f, g) * (across * along));
            }
        } else {
            for (m, (product, along)) in products.iter_mut().zip(along).enumerate() {
                let at = 2 * (offset + m * stride);
                let (f, g) = (&[f.at(at), f.at(at + 1)], &[g.at(at), g.at(at + 1)]);
                *product = if odd { imaginary_part(f, g) } else { real_part(f, g) } * (across * along);
            }
        }
    }
}

#[inline(always)]
fn real_part<T: Real>(f: &[T; 2], g: &[T; 2]) -> f64 {
    f[0].to_f64() * g[0].to_f64() + f[1].to_f64() * g[1].to_f64()
}

#[inline(always)]
fn imaginary_part<T: Real>(f: &[T; 2], g: &[T; 2]) -> f64 {
    f[1].to_f64() * g[0].to_f64() - f[0].to_f64() * g[1].to_f64()
}

/// The shot noise of particles in a box of side L: V sum w^2/(sum w)^2, V/N without weights, in (Mpc/h)^3 for L in Mpc/h.
///
/// `weights`: one for each particle, or none for equal weights; `particles`: how many there are.
///
/// # Errors
/// `Length` for weights of another number than `particles`; `Range` for a box that is not positive or whose volume no number holds, no particles, or weights that sum to
/// 0; `NotFinite`.
///
/// # Example
/// ```
/// use fixpair::estimate::power::shot_noise;
///
/// assert_eq!(shot_noise::<f32>(None, 1000, 100.0)?, 1000.0); // V/N
/// assert_eq!(shot_noise(Some(&[1.0, 3.0]), 2, 1.0)?, 10.0 / 16.0); // V sum w^2/(sum w)^2
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn shot_noise<T: Real>(weights: Option<&[T]>, particles: u64, box_size: f64) -> Result<f64> {
    if weights.is_some_and(|weights| weights.len() as u64 != particles) {
        return Err(Error::Length);
    }
    shot_noise_of(weights.map(|weights| weights.iter().map(|weight| weight.to_f64())), particles, box_size)
}

/// [`shot_noise`] of as many weights as particles.
pub(crate) fn shot_noise_of(
    weights: Option<impl Iterator<Item = f64>>,
    particles: u64,
    box_size: f64,
) -> Result<f64> {
    if !box_size.is_finite() {
        return Err(Error::NotFinite);
    }
    if box_size <= 0.0 || particles == 0 {
        return Err(Error::Range);
    }
    let volume = box_size * box_size * box_size;
    if !(volume > 0.0 && volume.is_finite()) {
        return Err(Error::Range);
    }
    let Some(weights) = weights else { return Ok(volume / particles as f64) };
    let (mut sum, mut squares) = (0.0, 0.0);
    for weight in weights {
        sum += weight;
        squares += weight * weight;
    }
    let noise = volume * squares / (sum * sum);
    match (sum == 0.0, noise.is_finite()) {
        (true, _) => Err(Error::Range),
        (_, false) => Err(Error::NotFinite),
        _ => Ok(noise),
    }
}

/// Subtracts shot noise from the monopoles of auto spectra, in place: P_0 <- P_0 - noise where a bin is not empty. Cross spectra of
/// different particles have none. Other multipoles stay as they are: their noise (2l + 1) noise <L_l> vanishes where a bin holds many modes in all directions.
///
/// `values`: spectra of `pairs`, normalised; `noise`: of each field. Flat noise is what meshes have that are compensated by
/// [`Compensation::Aliased`], and interlaced ones by [`Compensation::Window`] well below the Nyquist frequency.
///
/// # Errors
/// As [`normalise`](super::binning::normalise); `Length` if there are not as many spectra as pairs, `Range` for a pair of a field without noise.
///
/// # Example
/// ```
/// use fixpair::estimate::binning::{Bin, Binning, read_sums};
/// use fixpair::estimate::compensation::Compensation;
/// use fixpair::estimate::power::power_sums;
/// use fixpair::exec::Serial;
/// use fixpair::mesh::{Brick, Space};
/// use fixpair::noise::{Amplitude, Realisation, white_modes};
/// # #[repr(align(64))] struct Memory([u8; 1 << 18]);
/// # let mut memory = Memory([0; 1 << 18]);
/// # let scratch = &mut memory.0;
///
/// let brick = Brick::whole(8, Space::Fourier)?;
/// let mut modes = vec![0.0_f64; brick.reals()];
/// white_modes(&mut modes, &brick, &Realisation { amplitude: Amplitude::Fixed, ..Realisation::new(1) }, &Serial)?;
/// let binning = Binning::shells(&[1, 4, 9]);
/// let mut sums = vec![0; binning.words(1)?];
/// power_sums(&mut sums, &[&modes], &[[0, 0]], &[Compensation::None], &brick, &binning, scratch, &Serial)?;
/// let (mut bins, mut values) = ([Bin::default(); 2], [0.0; 2]);
/// read_sums(&mut bins, &mut values, &sums, &binning, 1)?;
/// use fixpair::estimate::binning::normalise;
/// use fixpair::estimate::power::subtract_shot_noise;
///
/// normalise(&mut values, &bins, binning.orders, 1000.0)?;
/// subtract_shot_noise(&mut values, &[[0, 0]], &bins, binning.orders, &[100.0])?;
/// assert!((values[0] - 900.0).abs() < 1e-9);
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn subtract_shot_noise(
    values: &mut [f64],
    pairs: &[[usize; 2]],
    bins: &[Bin],
    orders: u32,
    noise: &[f64],
) -> Result<()> {
    let multipoles = check_values(values, bins, orders)?;
    if values.len() / (multipoles * bins.len()) != pairs.len() {
        return Err(Error::Length);
    }
    if pairs.as_flattened().iter().any(|&field| field >= noise.len()) {
        return Err(Error::Range);
    }
    if noise.iter().any(|noise| !noise.is_finite()) {
        return Err(Error::NotFinite);
    }
    if order_numbers(orders).next() != Some(0) {
        return Ok(());
    }
    for (values, pair) in values.chunks_exact_mut(multipoles * bins.len()).zip(pairs) {
        if pair[0] == pair[1] {
            for (values, bin) in values.chunks_exact_mut(multipoles).zip(bins) {
                values[0] -= if bin.count > 0 { noise.at(pair[0]) } else { 0.0 };
            }
        }
    }
    Ok(())
}
