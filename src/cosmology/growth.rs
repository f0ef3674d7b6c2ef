//! Growth of linear and second-order displacements, from their differential equations.
//!
//! With ' = d/dlna and matter alone clustering:
//!
//! ```text
//! D''  + (2 + dlnE/dlna) D'  = (3/2) Om(a) D,           D(1) = 1
//! D2'' + (2 + dlnE/dlna) D2' = (3/2) Om(a) (D2 - D^2),  x = q - D grad phi1 + D2 grad phi2
//! ```
//!
//! (Bouchet et al. 1995, astro-ph/9406013). In an Einstein-de Sitter universe D = a, D2 = -(3/7) a^2; otherwise D2 is near
//! -(3/7) D^2 Om(a)^(-1/143), which is a check here and not a source. D2 is not normalised to 1: it belongs to this D.
//!
//! The equations are solved for u = D/a and v = D2/a^2, which are constant while matter dominates, in equal steps of ln a
//! by the classical fourth-order Runge-Kutta rule. Start: without radiation, deep in matter domination at a = 1e-10. With it,
//! deep in radiation domination, y = a/a_eq <= 0.01, on the growing mode D = 1 + (3/2) y (Meszaros 1974) and the D2 that is
//! regular and zero at y = 0: -(3/2) y - (9/8) y^2 + y^3/16 - ..., that is, no second-order displacement before matter begins to fall.

use super::background::{Cosmology, EARLIEST, LATEST};
use crate::status::{Error, Result};

/// The earliest scale factor that growth is given for; what is left of the decaying modes of the start is below 1e-9 there.
pub const EARLIEST_GROWTH: f64 = 1e-5;

/// Step in ln a. The relative errors that it leaves today are 1e-10 in D and f, 1e-9 in D2 and f2.
const STEP: f64 = 1.0 / 128.0;

/// Growth functions at one scale factor.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C)]
pub struct Growth {
    /// First order, 1 at a = 1.
    pub d: f64,
    /// dlnD/dlna.
    pub f: f64,
    /// Second order, negative.
    pub d2: f64,
    /// dlnD2/dlna.
    pub f2: f64,
}

/// Growth at scale factor `a`.
///
/// # Errors
/// As [`Cosmology::check`]; `NotFinite` if a is; `Range` unless 1e-5 <= a <= 10 and the universe expands until a.
///
/// Cost: 0.4 ms.
pub fn growth(cosmology: &Cosmology, a: f64) -> Result<Growth> {
    let mut out = [Growth::default()];
    growth_many(cosmology, &[a], &mut out)?;
    Ok(out[0])
}

/// Growth at many scale factors, in any order, by one integration; each with the bits that [`growth`] gives.
///
/// # Errors
/// As [`growth`]; `Length` if `out` is not as long as `a`. `out` is then untouched.
///
/// Cost: 0.4 ms, and 2 microseconds a scale factor.
pub fn growth_many(cosmology: &Cosmology, a: &[f64], out: &mut [Growth]) -> Result<()> {
    cosmology.check()?;
    if a.len() != out.len() {
        return Err(Error::Length);
    }
    if a.iter().any(|a| !a.is_finite()) {
        return Err(Error::NotFinite);
    }
    if a.iter().any(|a| !(EARLIEST_GROWTH..=LATEST).contains(a)) {
        return Err(Error::Range);
    }
    let (first, last) =
        a.iter().fold((1.0, 1.0), |(first, last), &a| (f64::min(first, a), f64::max(last, a)));
    cosmology.check_expands(1.0, last)?;

    let mut today = State::default();
    integrate(cosmology, last, |from, to, step| {
        if from < 1.0 && 1.0 <= to {
            today = step(1.0);
        }
        if to < first {
            return;
        }
        for (&a, out) in a.iter().zip(out.iter_mut()) {
            if from < a && a <= to {
                *out = step(a).growth(a);
            }
        }
    });
    let [u, ..] = today.0;
    for growth in out {
        growth.d /= u;
        growth.d2 /= u * u;
    }
    Ok(())
}

/// g(z_rad)/g(0), g = (1 + z) D: how much the potential of matter domination exceeds today's (1.316 for Om = 0.27, Ode = 0.73).
///
/// Radiation, if any, is counted as dark energy here ([`Cosmology::without_radiation`]), for z_rad is a time when matter dominates
/// and g is constant, which with radiation never quite comes. What the radiation era did to the potential is in T(k).
///
/// # Errors
/// As [`Cosmology::check`].
///
/// Cost: 0.4 ms.
pub fn g_ratio(cosmology: &Cosmology) -> Result<f64> {
    let cosmology = cosmology.without_radiation();
    cosmology.check()?;
    let mut today = State::default();
    integrate(&cosmology, 1.0, |from, to, step| {
        if from < 1.0 && 1.0 <= to {
            today = step(1.0);
        }
    });
    Ok(1.0 / today.0[0])
}

/// u = D/a, u', v = D2/a^2, v'. Third order joins here: its sources are products of D and D2.
#[derive(Clone, Copy, Debug, Default)]
struct State([f64; 4]);

/// The background at one time: 2 + dlnE/dlna and (3/2) Om(a).
#[derive(Clone, Copy)]
struct Drive {
    friction: f64,
    attraction: f64,
}

impl Drive {
    fn at(cosmology: &Cosmology, a: f64) -> Self {
        let (slope, matter) = cosmology.slope_and_matter(a);
        Self { friction: 2.0 + slope, attraction: 1.5 * matter }
    }
}

impl State {
    /// The growing modes at the start, and the scale factor of the start.
    fn start(cosmology: &Cosmology) -> (f64, Self) {
        let equality = cosmology.omega_r / cosmology.omega_m;
        // Below this, radiation is gone at the start; what it changed decays as a^(-5/2).
        if equality < 1e-12 {
            return (EARLIEST, Self([1.0, 0.0, -3.0 / 7.0, 0.0]));
        }
        let a = EARLIEST.min(0.01 * equality);
        let y = a / equality;
        // Multiplied by (2/3) a_eq, so that D -> a after equality.
        let unit = equality / 1.5;
        let (d, d_prime) = ((1.0 + 1.5 * y) * unit, 1.5 * y * unit);
        // c[n+1] = (s[n] - (2n+3)(n-1) c[n])/(2 (n+1)^2), s = (-3, -9, -27/4): the equation, times 2y(1+y), order by order.
        let terms = [-1.5 * y, -1.125 * y * y, 0.0625 * y * y * y, -0.035_156_25 * y * y * y * y];
        let (mut d2, mut d2_prime) = (0.0, 0.0);
        for (n, term) in terms.into_iter().enumerate() {
            d2 += term * unit * unit;
            d2_prime += (n + 1) as f64 * term * unit * unit;
        }
        let (u, v) = (d / a, d2 / (a * a));
        (a, Self([u, d_prime / a - u, v, d2_prime / (a * a) - 2.0 * v]))
    }

    fn derivative(self, drive: Drive) -> Self {
        let Self([u, u1, v, v1]) = self;
        let Drive { friction: q, attraction: m } = drive;
        let u2 = m * u - q * (u + u1) - u - 2.0 * u1;
        let v2 = m * (v - u * u) - q * (2.0 * v + v1) - 4.0 * (v + v1);
        Self([u1, u2, v1, v2])
    }

    fn plus(self, h: f64, slope: Self) -> Self {
        Self(core::array::from_fn(|i| self.0[i] + h * slope.0[i]))
    }

    /// One step of the classical Runge-Kutta rule.
    fn step(self, h: f64, begin: Drive, middle: Drive, end: Drive) -> Self {
        let k1 = self.derivative(begin);
        let k2 = self.plus(0.5 * h, k1).derivative(middle);
        let k3 = self.plus(0.5 * h, k2).derivative(middle);
        let k4 = self.plus(h, k3).derivative(end);
        let sum = Self(core::array::from_fn(|i| k1.0[i] + 2.0 * (k2.0[i] + k3.0[i]) + k4.0[i]));
        self.plus(h / 6.0, sum)
    }

    /// Not yet normalised to D(1) = 1.
    fn growth(self, a: f64) -> Growth {
        let Self([u, u1, v, v1]) = self;
        Growth { d: a * u, f: 1.0 + u1 / u, d2: a * a * v, f2: 2.0 + v1 / v }
    }
}

/// Walks from the start to `last`. For each step `visit` gets its two ends and a function that steps to any a between them.
fn integrate(cosmology: &Cosmology, last: f64, mut visit: impl FnMut(f64, f64, &dyn Fn(f64) -> State)) {
    let (mut a, mut state) = State::start(cosmology);
    let first = libm::log(a);
    let mut begin = Drive::at(cosmology, a);
    let mut steps = 0_u32;
    while a < last {
        let x = first + f64::from(steps) * STEP;
        steps += 1;
        let next = libm::exp(first + f64::from(steps) * STEP);
        let to = |a_to: f64| {
            let h = libm::log(a_to) - x;
            let middle = Drive::at(cosmology, libm::exp(x + 0.5 * h));
            state.step(h, begin, middle, Drive::at(cosmology, a_to))
        };
        visit(a, next, &to);
        let middle = Drive::at(cosmology, libm::exp(x + 0.5 * STEP));
        let end = Drive::at(cosmology, next);
        state = state.step(STEP, begin, middle, end);
        (a, begin) = (next, end);
    }
}
