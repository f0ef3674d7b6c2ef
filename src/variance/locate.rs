//! Where a posterior is: the range of each free parameter that holds it, found from the fit outwards.

use super::bias::Bias;
use super::check::finite;
use super::fit::{BiasFit, Free, errors, fit_bias, minima};
use super::likelihood::BiasLikelihood;
use crate::status::{Error, Result};
use crate::within::Within;

/// Standard deviations to either side of the least chi^2 that a range begins with.
const SIGMAS: f64 = 5.0;
/// chi^2 above the least at which a range ends: there, a density of exp(-12.5).
const REACH: f64 = SIGMAS * SIGMAS;
/// What a place must be lower than the fit to be another minimum, relative to 1 + chi^2: rounding, and what the fit left.
const LOWER: f64 = 1e-9;
/// Places on an edge or side that are tried to find where it is reached.
const PLACES: usize = 65;
/// How often a range may grow, by a quarter each time.
const GROWTHS: usize = 100;
/// How often a search may find a lower place than the fit it began with.
const ATTEMPTS: usize = 5;

/// The i-th of so many values from the first to the last, which are there to the bit.
#[inline]
pub(super) fn at([low, high]: [f64; 2], points: usize, i: usize) -> f64 {
    if i == 0 {
        low
    } else if i == points - 1 {
        high
    } else {
        low + (high - low) * (i as f64 / (points - 1) as f64)
    }
}

/// The fit and the range. Where the search for the range meets a place lower than the fit, both are done again from there.
pub(super) fn locate(
    likelihood: &BiasLikelihood,
    start: &Bias,
    mask: u32,
) -> Result<(BiasFit, [[f64; 2]; 2])> {
    let free = Free::new(mask)?;
    let mut from = *start;
    for _ in 0..ATTEMPTS {
        let fit = fit_bias(likelihood, &from, mask)?;
        let (range, lowest) = range(likelihood, &from, &fit, &free)?;
        if lowest.chi_squared >= fit.chi_squared - LOWER * (1.0 + fit.chi_squared) {
            return Ok((fit, range));
        }
        from = lowest.place;
    }
    Err(Error::Convergence)
}

/// The lowest place of a search.
#[derive(Clone, Copy)]
struct Lowest {
    chi_squared: f64,
    place: Bias,
}

/// Where the chi^2 of a range is looked at.
struct Scan<'a> {
    likelihood: &'a BiasLikelihood,
    fixed: Bias,
    free: &'a Free,
    /// Places on the other axis.
    places: usize,
    lowest: Lowest,
}

impl Scan<'_> {
    /// The least chi^2 where parameter `axis` has one value.
    fn across(&mut self, range: &[[f64; 2]; 2], axis: usize, value: f64) -> f64 {
        let mut least = f64::INFINITY;
        let other = (axis + 1) % 2;
        for i in 0..self.places {
            let mut values = [value; 2];
            values[other] = at(range[other], self.places, i);
            let place = self.free.with(&self.fixed, values);
            let chi_squared = self.likelihood.at(&place);
            least = least.min(chi_squared);
            if chi_squared < self.lowest.chi_squared {
                self.lowest = Lowest { chi_squared, place };
            }
        }
        least
    }
}

/// The range, and the lowest place that was seen on the way.
fn range(
    likelihood: &BiasLikelihood,
    start: &Bias,
    fit: &BiasFit,
    free: &Free,
) -> Result<([[f64; 2]; 2], Lowest)> {
    let count = free.numbers().len();
    let floor = |axis: usize| if free.numbers()[axis] == 0 { 0.0 } else { f64::NEG_INFINITY };
    // Where b_g = p all f_NL are the same: a ridge without end, too narrow to be met on an edge.
    let ridge = free.with(&fit.value, [fit.value.p, 0.0]);
    if free.numbers() == [0, 2] && ridge.b_g > 0.0 && likelihood.at(&ridge) < fit.chi_squared + REACH {
        return Err(Error::Convergence);
    }
    // All valleys that are deep enough.
    let mut range = [[f64::INFINITY, f64::NEG_INFINITY]; 2];
    minima(likelihood, start, free, |place, chi_squared| {
        let Ok(errors) = errors(likelihood, place, free) else { return };
        if chi_squared < fit.chi_squared + REACH {
            for (axis, (centre, error)) in free.of(place).into_iter().zip(errors).enumerate() {
                let reach = SIGMAS * error;
                range[axis] = [range[axis][0].min(centre - reach), range[axis][1].max(centre + reach)];
            }
        }
    })?;
    for (axis, range) in range.iter_mut().enumerate().take(count) {
        range[0] = range[0].max(floor(axis));
    }
    let lowest = Lowest { chi_squared: fit.chi_squared, place: fit.value };
    let places = if count == 2 { PLACES } else { 1 };
    let mut scan = Scan { likelihood, fixed: fit.value, free, places, lowest };
    // Edges move out until the density has vanished on all of them.
    for growth in 0.. {
        let mut grown = false;
        for axis in 0..count {
            for end in 0..2 {
                let edge = range[axis][end];
                let least = scan.across(&range, axis, edge);
                if least < scan.lowest.chi_squared + REACH && edge > floor(axis) {
                    let step = 0.25 * (range[axis][1] - range[axis][0]);
                    range[axis][end] = if end == 0 { (edge - step).max(floor(axis)) } else { edge + step };
                    grown = true;
                }
            }
        }
        if !grown {
            break;
        }
        if growth == GROWTHS {
            return Err(Error::Convergence);
        }
    }
    // Then in, to where it has just vanished; once more, because a range that was much too wide is resolved by the second pass alone.
    for _ in 0..2 {
        let before = range;
        for (axis, &side) in before.iter().enumerate().take(count) {
            let least: [f64; PLACES] =
                core::array::from_fn(|i| scan.across(&before, axis, at(side, PLACES, i)));
            let limit = scan.lowest.chi_squared + REACH;
            let inside = |i: &usize| least[*i] < limit;
            let first = (0..PLACES).find(inside).unwrap_or(0);
            let last = (0..PLACES).rev().find(inside).unwrap_or(PLACES - 1);
            let ends = [first.saturating_sub(1), (last + 1).min(PLACES - 1)];
            range.put(axis, ends.map(|i| at(side, PLACES, i)));
        }
    }
    finite(range.part(..count).as_flattened()).map_err(|_| Error::Convergence)?;
    Ok((range, scan.lowest))
}
