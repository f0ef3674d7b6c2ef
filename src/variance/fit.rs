//! The best bias parameters, by Gauss-Newton steps that cannot go uphill (Levenberg 1944, Marquardt 1963).

use super::bias::Bias;
use super::check::result;
use super::likelihood::{BiasLikelihood, COLUMNS};
use super::small::Triangle;
use crate::math::sqrt;
use crate::status::{Error, Result};
use crate::within::Within;

/// b_g is fitted.
pub const FREE_B_G: u32 = 1;
/// p is fitted.
pub const FREE_P: u32 = 2;
/// f_NL is fitted.
pub const FREE_F_NL: u32 = 4;

/// The best parameters, their errors and their covariance.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct BiasFit {
    /// Where chi^2 is least.
    pub value: Bias,
    /// Standard errors of (b_g, p, f_NL), from the curvature there; 0 for those that are not free.
    pub error: [f64; 3],
    /// Covariance of (b_g, p, f_NL), row by row.
    pub covariance: [f64; 9],
    /// Least chi^2.
    pub chi_squared: f64,
    /// Bins less free parameters; 0 if there are not as many.
    pub degrees: u64,
}

/// Which parameters are free: one, or b_g and one of the others, in the order b_g, p, f_NL.
///
/// p and f_NL enter as one product, so no data can tell them apart.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Free {
    number: [usize; 2],
    count: usize,
}

impl Free {
    pub(super) fn new(mask: u32) -> Result<Self> {
        let (number, count) = match mask {
            FREE_B_G => ([0, 0], 1),
            FREE_P => ([1, 0], 1),
            FREE_F_NL => ([2, 0], 1),
            m if m == FREE_B_G | FREE_P => ([0, 1], 2),
            m if m == FREE_B_G | FREE_F_NL => ([0, 2], 2),
            _ => return Err(Error::Choice),
        };
        Ok(Self { number, count })
    }

    /// Their numbers among (b_g, p, f_NL).
    pub(super) fn numbers(&self) -> &[usize] {
        self.number.part(..self.count)
    }

    /// `at` with other values of those that are free.
    #[inline]
    pub(super) fn with(&self, at: &Bias, values: [f64; 2]) -> Bias {
        let mut all = [at.b_g, at.p, at.f_nl];
        for (number, value) in self.numbers().iter().zip(values) {
            all.put(*number, value);
        }
        Bias { b_g: all[0], p: all[1], f_nl: all[2], delta_c: at.delta_c }
    }

    pub(super) fn of(&self, at: &Bias) -> [f64; 2] {
        self.number.map(|number| [at.b_g, at.p, at.f_nl].at(number))
    }

    fn b_g(&self) -> bool {
        self.number[0] == 0
    }
}

/// Is this a set of parameters that can be fitted?
pub(crate) fn is_set(mask: u32) -> bool {
    Free::new(mask).is_ok()
}

/// Derivatives of the six coefficients by (b_g, p, f_NL).
fn slopes(at: &Bias) -> [[f64; COLUMNS]; 3] {
    let (b, x) = (at.b_g, at.shift());
    let of = |b_slope: f64, x_slope: f64| {
        [2.0 * b * b_slope, 2.0 * (b_slope * x + b * x_slope), 2.0 * x * x_slope, b_slope, x_slope, 0.0]
    };
    let factor = 2.0 * at.delta_c;
    [of(1.0, factor * at.f_nl), of(0.0, -factor * at.f_nl), of(0.0, factor * (at.b_g - at.p))]
}

/// The Jacobian by the free parameters and the residuals, as a triangle.
fn linearised(likelihood: &BiasLikelihood, at: &Bias, free: &Free) -> Triangle<3> {
    let root = Triangle(likelihood.root);
    let slopes = slopes(at);
    let mut columns = [[0.0; COLUMNS]; 2];
    for (column, &number) in columns.iter_mut().zip(free.numbers()) {
        *column = root.times(&slopes.at(number));
    }
    let rest = likelihood.residuals(at);
    let mut triangle = Triangle::EMPTY;
    for i in 0..COLUMNS {
        triangle.push([columns[0][i], columns[1][i], -rest[i]]);
    }
    triangle
}

const STEPS: usize = 500;
/// A step that moves the model by less, in units of its errors, is the last.
const SMALL: f64 = 1e-10;

/// From one place downhill to a minimum with b_g > 0.
fn descend(likelihood: &BiasLikelihood, start: &Bias, free: &Free) -> Result<(Bias, f64)> {
    let count = free.numbers().len();
    let (mut at, mut chi_squared) = (*start, likelihood.at(start));
    let mut damping = 1e-3;
    for _ in 0..STEPS {
        let triangle = linearised(likelihood, &at, free);
        let column = |j: usize| sqrt(triangle.0.iter().take(j + 1).map(|row| row.at(j) * row.at(j)).sum());
        let mut damped = triangle;
        for j in 0..count {
            let mut row = [0.0; 3];
            row.put(j, sqrt(damping) * column(j));
            damped.push(row);
        }
        let step = damped.solve(count)?;
        let moved = (0..count).map(|j| (column(j) * step.at(j)).abs()).fold(0.0, f64::max);
        let values = free.of(&at);
        let next = free.with(&at, [values[0] + step[0], values[1] + step[1]]);
        let trial = likelihood.at(&next);
        let small = SMALL * (1.0 + sqrt(chi_squared));
        if trial <= chi_squared && (next.b_g > 0.0 || !free.b_g()) {
            (at, chi_squared) = (next, trial);
            damping = (0.1 * damping).max(1e-12);
            if moved < small {
                return Ok((at, chi_squared));
            }
        } else if moved < small {
            // Rounding decides which of the two is lower.
            return Ok((at, chi_squared));
        } else {
            damping *= 10.0;
        }
    }
    Err(Error::Convergence)
}

/// A descent that was held at b_g = 0, with downhill beyond, found no minimum.
fn check_inside(likelihood: &BiasLikelihood, at: &Bias, free: &Free) -> Result<()> {
    if free.b_g() {
        let step = linearised(likelihood, at, free).solve(free.numbers().len())?;
        let beyond = at.b_g + step[0] <= 0.0;
        return if beyond { Err(Error::Convergence) } else { Ok(()) };
    }
    Ok(())
}

/// Visits the minima that are found, and returns the lowest.
///
/// P_hh is b(k)^2, so besides the valley of a bias of one sign there may be another where b(k) changes sign: with x/alpha at small k turned into -x/alpha - 2 b_g. Descents begin at
/// `start`, at the bias that fits best without f_NL, and on the other side of what they find.
pub(super) fn minima(
    likelihood: &BiasLikelihood,
    start: &Bias,
    free: &Free,
    mut visit: impl FnMut(&Bias, f64),
) -> Result<(Bias, f64)> {
    let square = |j: usize| (0..=j).map(|i| likelihood.root[i][j] * likelihood.root[i][j]).sum::<f64>();
    let on =
        |j: usize| (0..=j).map(|i| likelihood.root[i][j] * likelihood.root[i][5]).sum::<f64>() / square(j);
    let b_g = if square(0) > 0.0 { sqrt(on(0).abs()) } else { on(3).abs() };
    let plain = Bias { b_g, ..*start };
    let mut best: Result<(Bias, f64)> = Err(Error::Singular);
    let mut descend_from = |place: Bias, best: &mut Result<(Bias, f64)>| {
        // Of what is not free the caller's value holds.
        let place = free.with(start, free.of(&place));
        let positive = place.b_g > 0.0;
        if free.b_g() && !positive {
            return;
        }
        let found = descend(likelihood, &place, free);
        let found = found.and_then(|of| check_inside(likelihood, &of.0, free).map(|()| of));
        if let Ok((at, chi_squared)) = found {
            visit(&at, chi_squared);
        }
        match (found, &*best) {
            (Ok(new), Ok(old)) if old.1 <= new.1 => {}
            (Ok(new), _) => *best = Ok(new),
            (Err(error), Err(_)) => *best = Err(error),
            (Err(_), Ok(_)) => {}
        }
    };
    for place in [*start, plain, Bias { f_nl: 0.0, ..plain }] {
        descend_from(place, &mut best);
    }
    if square(0) > 0.0 {
        // alpha where most of the data are, and where f_NL shows most.
        for alpha in [sqrt(square(0) / square(1)), sqrt(square(1) / square(2))] {
            let Ok((near, _)) = best else { break };
            descend_from(across(&near, alpha, free), &mut best);
        }
    }
    best
}

/// The place where b(k) has the other sign at this alpha.
fn across(at: &Bias, alpha: f64, free: &Free) -> Bias {
    let x = -2.0 * at.b_g * alpha - at.shift();
    match free.numbers() {
        [.., 2] => Bias { f_nl: x / (2.0 * at.delta_c * (at.b_g - at.p)), ..*at },
        [.., 1] => Bias { p: at.b_g - x / (2.0 * at.delta_c * at.f_nl), ..*at },
        // b_g + x/alpha is linear in b_g.
        _ => {
            let slope = 1.0 + 2.0 * at.delta_c * at.f_nl / alpha;
            Bias { b_g: at.b_g - 2.0 * (at.b_g + at.shift() / alpha) / slope, ..*at }
        }
    }
}

/// The best values of the parameters in `free` (FREE_...), the others as in `start`.
///
/// The paper's cases: (i) b_g, (ii) b_g and p, (iii) b_g and f_NL; each of the three alone too. b_g > 0, since P_hh is the same for all signs turned.
/// What is free need not be near: descents begin at `start`, at the bias of the spectrum itself, and where b(k) would change sign.
///
/// # Errors
/// `NotFinite`, `Choice` for other sets of parameters, `Range` for delta_c that is not positive, `Singular` where the data do not constrain a parameter (p where f_NL = 0,
/// f_NL where b_g = p), `Convergence` if no minimum is found at b_g > 0.
///
/// # Example
/// ```
/// use fixpair::variance::bias::{Bias, Spectrum, halo_power};
/// use fixpair::variance::likelihood::{BiasLikelihood, Spectra};
///
/// let truth = Bias { b_g: 2.0, p: 1.0, f_nl: 100.0, delta_c: 1.686 };
/// let (linear, alpha, sigma, mut power) = ([2e4, 1e4, 5e3], [100.0, 1000.0, 4000.0], [900.0, 200.0, 50.0], [0.0; 3]);
/// halo_power(&mut power, &truth, Spectrum::HaloHalo, &linear, &alpha)?; // or a measured one, without its shot noise
/// let mut likelihood = BiasLikelihood::EMPTY;
/// likelihood.add(Spectrum::HaloHalo, Spectra { power: &power, linear: &linear, alpha: &alpha }, &sigma)?;
/// use fixpair::variance::fit::{FREE_B_G, FREE_F_NL, fit_bias};
///
/// let start = Bias { b_g: 1.5, f_nl: 0.0, ..truth };
/// let fit = fit_bias(&likelihood, &start, FREE_B_G | FREE_F_NL)?;
/// assert!((fit.value.f_nl - 100.0).abs() < 1e-4 && (fit.value.b_g - 2.0).abs() < 1e-6);
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn fit_bias(likelihood: &BiasLikelihood, start: &Bias, free: u32) -> Result<BiasFit> {
    let free = Free::new(free)?;
    likelihood.check()?;
    start.check()?;
    let (value, chi_squared) = minima(likelihood, start, &free, |_, _| {})?;
    finish(likelihood, value, chi_squared, &free)
}

/// Standard errors of the free parameters at a minimum.
pub(super) fn errors(likelihood: &BiasLikelihood, at: &Bias, free: &Free) -> Result<[f64; 2]> {
    let inverse = linearised(likelihood, at, free).covariance(free.numbers().len())?;
    Ok([0, 1].map(|axis| sqrt(inverse[axis][axis])))
}

fn finish(likelihood: &BiasLikelihood, value: Bias, chi_squared: f64, free: &Free) -> Result<BiasFit> {
    let inverse = linearised(likelihood, &value, free).covariance(free.numbers().len())?;
    let mut covariance = [0.0; 9];
    for (&row, values) in free.numbers().iter().zip(&inverse) {
        for (&column, &value) in free.numbers().iter().zip(values) {
            covariance.put(3 * row + column, result(value)?);
        }
    }
    let error = [0, 4, 8].map(|at| sqrt(covariance[at]));
    let degrees = likelihood.bins.saturating_sub(free.numbers().len() as u64);
    Ok(BiasFit { value, error, covariance, chi_squared: result(chi_squared)?, degrees })
}
