//! The likelihood on a grid: range, marginals, and what is read off them.
//!
//! Priors are flat in the free parameters, with b_g > 0. A grid has uniform steps, ends included; of two free parameters the second is
//! fastest. Integrals are trapezoidal sums, which for a density that has vanished at both ends converge faster than any power of the step.

use core::num::NonZero;

use super::bias::Bias;
use super::check::{finite, result, same_length};
use super::fit::{BiasFit, Free};
use super::likelihood::BiasLikelihood;
use super::locate::{at, locate};
use crate::math::sqrt;
use crate::scratch::{Arena, Layout};
use crate::status::{Error, Result};
use crate::within::Within;

/// Uniform grids of one or two parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grid {
    /// First and last value of each parameter, in the order b_g, p, f_NL of those that are free; the second is not used where one is free.
    pub range: [[f64; 2]; 2],
    /// Values of each; 1 for the second where one is free.
    pub points: [usize; 2],
}

impl Grid {
    fn check(&self, free: &Free) -> Result<usize> {
        let count = free.numbers().len();
        for axis in 0..count {
            let [low, high] = self.range[axis];
            finite(&[low, high])?;
            if high <= low || self.points[axis] < 2 {
                return Err(Error::Range);
            }
        }
        if count == 1 && self.points[1] != 1 {
            return Err(Error::Range);
        }
        self.points[0].checked_mul(self.points[1]).ok_or(Error::Overflow)
    }

    #[inline]
    fn value(&self, axis: usize, i: usize) -> f64 {
        at(self.range[axis], self.points[axis], i)
    }
}

/// Where the free parameters' posterior is: a range of each, in the order b_g, p, f_NL, beyond which the density is below exp(-12.5) of its peak.
///
/// # Errors
/// As [`fit_bias`](super::fit::fit_bias); `Length` unless there is a range for each free parameter; `Convergence` if the posterior does not end anywhere, as that of f_NL where b_g = p cannot be
/// excluded.
///
/// # Example
/// ```
/// use fixpair::variance::{bias::*, fit::FREE_B_G, likelihood::*, posterior::bias_range};
///
/// let spectra = Spectra { power: &[8e4, 4e4, 2e4], linear: &[2e4, 1e4, 5e3], alpha: &[100.0, 1000.0, 4000.0] };
/// let mut likelihood = BiasLikelihood::EMPTY;
/// likelihood.add(Spectrum::HaloHalo, spectra, &[900.0, 200.0, 50.0])?; // P = 4 P_lin: b_g = 2
/// let fixed = Bias { b_g: 1.5, p: 1.0, f_nl: 0.0, delta_c: 1.686 };
/// let mut ranges = [[0.0; 2]];
/// bias_range(&mut ranges, &likelihood, &fixed, FREE_B_G)?;
/// assert!(ranges[0][0] < 2.0 && 2.0 < ranges[0][1]);
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn bias_range(
    ranges: &mut [[f64; 2]],
    likelihood: &BiasLikelihood,
    fixed: &Bias,
    free: u32,
) -> Result<()> {
    let numbers = Free::new(free)?;
    same_length(numbers.numbers().len(), &[ranges.len()])?;
    let (_, found) = locate(likelihood, fixed, free)?;
    ranges.copy_from_slice(&found[..ranges.len()]);
    Ok(())
}

/// chi^2 on a grid (Eq. chi2), whose marginals and contours the functions below make.
///
/// `fixed`: the parameters that are not free.
///
/// # Errors
/// `Choice` for a set of parameters that [`fit_bias`](super::fit::fit_bias) does not take, `Length` unless there is a place for each point, `NotFinite`, `Range` for a range that is empty, fewer than two points, or a
/// chi^2 that overflows.
///
/// # Example
/// ```
/// use fixpair::variance::{bias::*, fit::FREE_B_G, likelihood::*, posterior::{Grid, bias_grid}};
///
/// let spectra = Spectra { power: &[8e4, 4e4, 2e4], linear: &[2e4, 1e4, 5e3], alpha: &[100.0, 1000.0, 4000.0] };
/// let mut likelihood = BiasLikelihood::EMPTY;
/// likelihood.add(Spectrum::HaloHalo, spectra, &[900.0, 200.0, 50.0])?; // P = 4 P_lin: b_g = 2
/// let fixed = Bias { b_g: 1.5, p: 1.0, f_nl: 0.0, delta_c: 1.686 };
/// let mut chi_squared = [0.0; 3];
/// bias_grid(&mut chi_squared, &likelihood, &fixed, FREE_B_G, &Grid { range: [[1.9, 2.1], [0.0; 2]], points: [3, 1] })?;
/// assert!(chi_squared[1] < 1e-12 && chi_squared[0] > 1.0 && chi_squared[2] > 1.0);
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn bias_grid(
    out: &mut [f64],
    likelihood: &BiasLikelihood,
    fixed: &Bias,
    free: u32,
    grid: &Grid,
) -> Result<()> {
    let free = Free::new(free)?;
    likelihood.check()?;
    fixed.check()?;
    same_length(grid.check(&free)?, &[out.len()])?;
    let width = NonZero::new(grid.points[1]).ok_or(Error::Range)?;
    super::check::fill(out, |point| {
        let values = [grid.value(0, point / width), grid.value(1, point % width)];
        result(likelihood.at(&free.with(fixed, values)))
    })
}

/// Steps of a grid with which no density of [`marginal`] over- or underflows.
const STEPS: core::ops::RangeInclusive<f64> = 1e-280..=1e280;

/// The posterior density of one parameter of a grid of chi^2, integrated over the other and normalised.
///
/// `axis`: 0 or 1; `range`: of that parameter, in whose inverse unit the density is.
///
/// # Errors
/// `Length` for arrays that do not fit, `NotFinite`, `Range` for an axis of one point, or a range that is empty or too extreme.
///
/// # Example
/// ```
/// use fixpair::variance::posterior::marginal;
///
/// let mut density = [0.0; 5];
/// marginal(&mut density, &[36.0, 9.0, 0.0, 9.0, 36.0], [5, 1], 0, [-6.0, 6.0])?; // chi^2 = x^2, in steps of 3
/// assert!((3.0 * density.iter().sum::<f64>() - 1.0).abs() < 1e-7);
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn marginal(
    out: &mut [f64],
    chi_squared: &[f64],
    points: [usize; 2],
    axis: usize,
    range: [f64; 2],
) -> Result<()> {
    same_length(points[0].checked_mul(points[1]).ok_or(Error::Overflow)?, &[chi_squared.len()])?;
    finite(chi_squared)?;
    finite(&range)?;
    if axis > 1 || points[axis] < 2 || points[1 - axis] == 0 || range[1] <= range[0] {
        return Err(Error::Range);
    }
    same_length(points[axis], &[out.len()])?;
    if !STEPS.contains(&((range[1] - range[0]) / (points[axis] - 1) as f64)) {
        return Err(Error::Range);
    }
    let least = chi_squared.iter().copied().fold(f64::INFINITY, f64::min);
    let other = points[1 - axis];
    for (i, out) in out.iter_mut().enumerate() {
        let point = |j: usize| if axis == 0 { i * points[1] + j } else { j * points[1] + i };
        *out = (0..other)
            .map(|j| end_weight(j, other) * libm::exp(0.5 * (least - chi_squared.at(point(j)))))
            .sum();
    }
    normalise(out, range)
}

/// Of the trapezoidal sum.
fn end_weight(i: usize, points: usize) -> f64 {
    if points > 1 && (i == 0 || i == points - 1) { 0.5 } else { 1.0 }
}

fn normalise(density: &mut [f64], range: [f64; 2]) -> Result<()> {
    let points = density.len();
    let step = (range[1] - range[0]) / (points - 1) as f64;
    let sum: f64 = density.iter().enumerate().map(|(i, x)| end_weight(i, points) * x).sum();
    let factor = 1.0 / (sum * step);
    if !(factor.is_finite() && factor > 0.0) {
        return Err(Error::Range);
    }
    density.iter_mut().for_each(|x| *x *= factor);
    Ok(())
}

/// What one reads off the posterior of a parameter.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C)]
pub struct Posterior {
    /// Where the density is largest: the paper's estimate of f_NL.
    pub peak: f64,
    /// Its mean.
    pub mean: f64,
    /// Its standard deviation.
    pub deviation: f64,
    /// Below this value lies half of what the central region leaves out, and above `high` the other half.
    pub low: f64,
    /// See `low`.
    pub high: f64,
    /// (low + high)/2: with `half_width` the paper's "centre +- semi-width".
    pub centre: f64,
    /// (high - low)/2.
    pub half_width: f64,
    /// The larger density at the two ends over that of the peak. If it is not small, the range cuts the posterior off.
    pub edge: f64,
}

/// Peak (of a parabola through the logarithm of three points), mean, deviation, and the central region of the given probability, 0.68 in the paper, of a density on a
/// uniform grid.
///
/// # Errors
/// `Length` for fewer than three points, `NotFinite`, `Range` for an empty range, negative densities, none above zero, a probability outside (0, 1), or
/// numbers too extreme.
///
/// # Example
/// ```
/// use fixpair::variance::posterior::read_posterior;
///
/// let normal: Vec<f64> = (0..=200).map(|i| (-0.5 * (0.05 * f64::from(i) - 5.0).powi(2)).exp()).collect();
/// let read = read_posterior(&normal, [-5.0, 5.0], 0.6827)?;
/// assert!(read.peak.abs() < 1e-9 && (read.deviation - 1.0).abs() < 1e-4 && (read.half_width - 1.0).abs() < 2e-3);
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn read_posterior(density: &[f64], range: [f64; 2], probability: f64) -> Result<Posterior> {
    finite(density)?;
    finite(&[range[0], range[1], probability])?;
    let points = density.len();
    if points < 3 {
        return Err(Error::Length);
    }
    let sum: f64 = density.iter().enumerate().map(|(i, x)| end_weight(i, points) * x).sum();
    let sound = density.iter().all(|&x| x >= 0.0) && sum > 0.0 && sum.is_finite();
    if !sound || range[1] <= range[0] || !(probability > 0.0 && probability < 1.0) {
        return Err(Error::Range);
    }
    let value = |i: f64| range[0] + (range[1] - range[0]) * (i / (points - 1) as f64);
    let moment = |of: &dyn Fn(f64) -> f64| -> f64 {
        density.iter().enumerate().map(|(i, x)| end_weight(i, points) * x / sum * of(value(i as f64))).sum()
    };
    let mean = moment(&|x| x);
    let deviation = sqrt(moment(&|x| (x - mean) * (x - mean)));
    let tail = 0.5 * (1.0 - probability);
    let larger = |(top, unit), (i, &x)| if x > unit { (i, x) } else { (top, unit) };
    let (top, unit) = density.iter().enumerate().fold((0, 0.0), larger);
    let [low, high] = [tail, 1.0 - tail].map(|below| value(quantile(density, unit, below * (sum / unit))));
    let read = Posterior {
        peak: value(peak(density, top)),
        mean,
        deviation,
        low,
        high,
        centre: 0.5 * (low + high),
        half_width: 0.5 * (high - low),
        edge: density.at(0).max(density.at(points - 1)) / unit,
    };
    finite(&[read.peak, mean, deviation, low, high, read.centre, read.half_width])
        .map_err(|_| Error::Range)?;
    Ok(read)
}

/// The place of the maximum about point `top`, between points.
fn peak(density: &[f64], top: usize) -> f64 {
    if top == 0 || top == density.len() - 1 {
        return top as f64;
    }
    let [left, centre, right] = [top - 1, top, top + 1].map(|i| libm::log(density.at(i)));
    let bend = (centre - left) + (centre - right);
    // Neighbours of zero density have no logarithm.
    let shift = 0.5 * (right - left) / bend;
    if shift.is_finite() { top as f64 + shift.clamp(-0.5, 0.5) } else { top as f64 }
}

/// The place, in points, below which the sum of the density, linear between points and in units of its peak, is `wanted`.
fn quantile(density: &[f64], unit: f64, wanted: f64) -> f64 {
    let mut below = 0.0;
    for (i, pair) in density.windows(2).enumerate() {
        let pair = [pair[0] / unit, pair[1] / unit];
        let inside = 0.5 * (pair[0] + pair[1]);
        if below + inside >= wanted && inside > 0.0 {
            // pair[0] t + (pair[1] - pair[0]) t^2/2 = rest, in the form that holds for equal densities too.
            let rest = wanted - below;
            let slope = pair[1] - pair[0];
            let root = sqrt((pair[0] * pair[0] + 2.0 * slope * rest).max(0.0));
            return i as f64 + (2.0 * rest / (pair[0] + root)).clamp(0.0, 1.0);
        }
        below += inside;
    }
    (density.len() - 1) as f64
}

/// All of it in one call: the fit, the range, and the posterior of each free parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Constraints {
    /// The best parameters.
    pub fit: BiasFit,
    /// The grid that was integrated.
    pub grid: Grid,
    /// Of the free parameters in the order b_g, p, f_NL; the second is all zeros where one is free.
    pub posterior: [Posterior; 2],
}

/// Least and most points of a grid of [`bias_posterior`].
pub const POINTS: core::ops::RangeInclusive<usize> = 16..=8192;

/// Work space of [`bias_posterior`]: 16 bytes a point.
///
/// # Errors
/// `Range` for points outside [`POINTS`].
///
/// # Example
/// ```
/// use fixpair::variance::posterior::bias_posterior_scratch;
///
/// assert_eq!(bias_posterior_scratch(128)?.size, 16 * 128);
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn bias_posterior_scratch(points: usize) -> Result<Layout> {
    if !POINTS.contains(&points) {
        return Err(Error::Range);
    }
    Layout::EMPTY.and::<f64>(points)?.and::<f64>(points)
}

/// Fit, automatic range, and posteriors on a grid of `points` values of each free parameter, 128 for three digits and more.
///
/// `start`: the parameters that are not free, and where the fit of the others may begin. The peak of the posterior of f_NL is the paper's estimate.
/// Cost: 30 ns a point of the grid.
///
/// # Errors
/// As [`bias_range`] and [`read_posterior`]; `Range` for points outside [`POINTS`], `Scratch`.
/// # Example
/// ```
/// # use fixpair::variance::{bias::*, fit::*, likelihood::*, posterior::bias_posterior};
/// # #[repr(align(64))] struct Memory([u8; 1 << 16]);
/// let (start, mut scratch) = (Bias { b_g: 1.5, p: 1.0, f_nl: 10.0, delta_c: 1.686 }, Memory([0; 1 << 16]));
/// let spectra = Spectra { power: &[8e4, 4e4, 2e4], linear: &[2e4, 1e4, 5e3], alpha: &[100.0, 1000.0, 4000.0] };
/// let mut likelihood = BiasLikelihood::EMPTY;
/// likelihood.add(Spectrum::HaloHalo, spectra, &[900.0, 200.0, 50.0]).unwrap(); // P = 4 P_lin: b_g = 2, f_NL = 0
/// let found = bias_posterior(&likelihood, &start, FREE_B_G | FREE_F_NL, 64, 0.68, &mut scratch.0).unwrap();
/// assert!(found.posterior[1].peak.abs() < 0.1 * found.posterior[1].half_width);
/// ```
pub fn bias_posterior(
    likelihood: &BiasLikelihood,
    start: &Bias,
    free: u32,
    points: usize,
    probability: f64,
    scratch: &mut [u8],
) -> Result<Constraints> {
    let mut arena = Arena::new(scratch, bias_posterior_scratch(points)?)?;
    let (fit, range) = locate(likelihood, start, free)?;
    let free = Free::new(free)?;
    let count = free.numbers().len();
    let grid = Grid { range, points: [points, if count == 2 { points } else { 1 }] };
    let (first, second) = (arena.take::<f64>(points)?, arena.take::<f64>(points)?);
    first.fill(0.0);
    second.fill(0.0);
    for (i, first) in first.iter_mut().enumerate() {
        for (j, second) in second.iter_mut().take(grid.points[1]).enumerate() {
            let at = free.with(&fit.value, [grid.value(0, i), grid.value(1, j)]);
            let chi_squared = likelihood.at(&at);
            if chi_squared.is_nan() {
                return Err(Error::Range);
            }
            // Above 1 only by rounding, or in a valley narrower than the search; and never infinite.
            let density = libm::exp((0.5 * (fit.chi_squared - chi_squared)).min(300.0));
            *first += end_weight(j, grid.points[1]) * density;
            *second += end_weight(i, points) * density;
        }
    }
    let mut read = [Posterior::default(); 2];
    for (axis, density) in [first, second].into_iter().enumerate().take(count) {
        normalise(density, range[axis])?;
        read[axis] = read_posterior(density, range[axis], probability)?;
    }
    Ok(Constraints { fit, grid, posterior: read })
}
