//! Growth of displacements to third order, from their differential equations.
//!
//! With ' = d/dlna and matter alone clustering:
//!
//! ```text
//! D''  + (2 + dlnE/dlna) D'  = (3/2) Om(a) D,           D(1) = 1
//! D2'' + (2 + dlnE/dlna) D2' = (3/2) Om(a) (D2 - D^2),  x = q - D grad phi1 + D2 grad phi2 + third order
//! D3a'' + (2 + dlnE/dlna) D3a' = (3/2) Om(a) (D3a - 2 D^3)
//! D3b'' + (2 + dlnE/dlna) D3b' = (3/2) Om(a) (D3b + D^3 - D D2)
//! D3c'' + (2 + dlnE/dlna) D3c' = (3/2) Om(a) D^3
//! ```
//!
//! (Bouchet et al. 1995, astro-ph/9406013; Catelan 1995, astro-ph/9406016; which spatial term goes with which is said in
//! [`crate::initial::third`]). In an Einstein-de Sitter universe D = a, D2 = -(3/7) a^2, D3a = -(1/3) a^3, D3b = (5/21) a^3, D3c = (1/7) a^3;
//! otherwise D2 is near -(3/7) D^2 Om(a)^(-1/143), which is a check here and not a source. Only D is normalised to 1: the others belong to it.
//!
//! The equations are solved for D/a, D2/a^2 and D3/a^3, which are constant while matter dominates, in equal steps of ln a
//! by the classical fourth-order Runge-Kutta rule. Start: without radiation, deep in matter domination at a = 1e-10. With it,
//! deep in radiation domination, y = a/a_eq <= 0.01, on the growing mode D = 1 + (3/2) y (Meszaros 1974) and the higher orders that are
//! regular and zero at y = 0, such as D2 = -(3/2) y - (9/8) y^2 + y^3/16 - ..., that is, no such displacement before matter begins to fall.

use super::background::{Cosmology, EARLIEST, LATEST};
use crate::status::{Error, Result};

/// The earliest scale factor that growth is given for; what is left of the decaying modes of the start is below 1e-9 there.
pub const EARLIEST_GROWTH: f64 = 1e-5;

/// Step in ln a. The relative errors that it leaves today are 1e-10 in D and f, 2e-9 in the second order and 5e-9 in the third.
/// The targets of `fuzz/` do not look at digits, and have ten million calls to make.
const STEP: f64 = if cfg!(fixpair_fuzzing) { 0.5 } else { 1.0 / 128.0 };

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
    /// Third order, of the determinant; negative.
    pub d3a: f64,
    /// dlnD3a/dlna.
    pub f3a: f64,
    /// Third order, of the first and the second together.
    pub d3b: f64,
    /// dlnD3b/dlna.
    pub f3b: f64,
    /// Third order, transverse.
    pub d3c: f64,
    /// dlnD3c/dlna.
    pub f3c: f64,
}

/// Growth at scale factor `a`.
///
/// # Errors
/// As [`Cosmology::check`]; `NotFinite` if a is; `Range` unless 1e-5 <= a <= 10 and the universe expands until a.
///
/// Cost: 0.4 ms.
///
/// # Example
/// ```
/// use fixpair::cosmology::{Cosmology, growth};
///
/// let at_z_1 = growth(&Cosmology::goliat(), 0.5)?;
/// assert!((at_z_1.d - 0.6228).abs() < 1e-4 && (at_z_1.d2 / at_z_1.d.powi(2) + 3.0 / 7.0).abs() < 2e-3);
/// # Ok::<(), fixpair::status::Error>(())
/// ```
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
///
/// # Example
/// ```
/// use fixpair::cosmology::{Cosmology, Growth, growth_many};
///
/// let mut found = [Growth::default(); 2];
/// growth_many(&Cosmology::goliat(), &[0.5, 1.0], &mut found)?; // one integration for both
/// assert!((found[1].d - 1.0).abs() < 1e-12);
/// # Ok::<(), fixpair::status::Error>(())
/// ```
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
        for d3 in [&mut growth.d3a, &mut growth.d3b, &mut growth.d3c] {
            *d3 /= u * u * u;
        }
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
///
/// # Example
/// ```
/// use fixpair::cosmology::{Cosmology, g_ratio};
///
/// let lss_over_cmb = g_ratio(&Cosmology::goliat())?; // f_NL(LSS)/f_NL(CMB)
/// assert!((lss_over_cmb - 1.316).abs() < 1e-3);
/// # Ok::<(), fixpair::status::Error>(())
/// ```
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

/// D/a, D2/a^2, and D3a, D3b, D3c over a^3, each followed by its derivative.
#[derive(Clone, Copy, Debug, Default)]
struct State([f64; 10]);

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
            return (
                EARLIEST,
                Self([1.0, 0.0, -3.0 / 7.0, 0.0, -1.0 / 3.0, 0.0, 5.0 / 21.0, 0.0, 1.0 / 7.0, 0.0]),
            );
        }
        let a = EARLIEST.min(0.01 * equality);
        let y = a / equality;
        // Multiplied by (2/3) a_eq for each order, so that D -> a after equality.
        let unit = equality / 1.5;
        let mut state = [0.0; 10];
        let mut set = |order: i32, at: usize, d: f64, d_prime: f64| {
            let scale = libm::pow(unit / a, f64::from(order));
            state[at] = d * scale;
            state[at + 1] = (d_prime - f64::from(order) * d) * scale;
        };
        set(1, 0, 1.0 + 1.5 * y, 1.5 * y);
        // Sources over (3/2) y, in powers of y: -D^2, -2 D^3, D^3 - D D2, D^3.
        for (order, at, source, attracted) in [
            (2, 2, [-1.0, -3.0, -2.25, 0.0], true),
            (3, 4, [-2.0, -9.0, -13.5, -6.75], true),
            (3, 6, [1.0, 6.0, 10.125, 5.0], true),
            (3, 8, [1.0, 4.5, 6.75, 3.375], false),
        ] {
            let (d, d_prime) = in_radiation(y, source, attracted);
            set(order, at, d, d_prime);
        }
        (a, Self(state))
    }

    fn derivative(self, drive: Drive) -> Self {
        let Self([u, u1, v, v1, wa, wa1, wb, wb1, wc, wc1]) = self;
        let Drive { friction: q, attraction: m } = drive;
        let cube = u * u * u;
        let u2 = m * u - q * (u + u1) - u - 2.0 * u1;
        let v2 = m * (v - u * u) - q * (2.0 * v + v1) - 4.0 * (v + v1);
        let third = |pull: f64, w: f64, w1: f64| m * pull - q * (3.0 * w + w1) - 9.0 * w - 6.0 * w1;
        let wa2 = third(wa - 2.0 * cube, wa, wa1);
        let wb2 = third(wb + cube - u * v, wb, wb1);
        let wc2 = third(cube, wc, wc1);
        Self([u1, u2, v1, v2, wa1, wa2, wb1, wb2, wc1, wc2])
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
        let Self([u, u1, v, v1, wa, wa1, wb, wb1, wc, wc1]) = self;
        let cube = a * a * a;
        Growth {
            d: a * u,
            f: 1.0 + u1 / u,
            d2: a * a * v,
            f2: 2.0 + v1 / v,
            d3a: cube * wa,
            f3a: 3.0 + wa1 / wa,
            d3b: cube * wb,
            f3b: 3.0 + wb1 / wb,
            d3c: cube * wc,
            f3c: 3.0 + wc1 / wc,
        }
    }
}

/// A growth function early in radiation domination, zero at y = 0, and its derivative by ln y: the solution of
/// (1 + y) G'' + (y/2) G' - (3/2) y G = (3/2) y s(y), s = sum of source\[n\] y^n, order by order; without the third term unless `attracted`.
fn in_radiation(y: f64, source: [f64; 4], attracted: bool) -> (f64, f64) {
    let (mut value, mut slope) = (0.0, 0.0);
    let (mut coefficient, mut power) = (0.0, y);
    for (n, source) in source.into_iter().enumerate() {
        let n = n as f64;
        let pull = if attracted { 1.5 } else { 0.0 };
        coefficient = (1.5 * source - (n * n + 0.5 * n - pull) * coefficient) / ((n + 1.0) * (n + 1.0));
        value += coefficient * power;
        slope += (n + 1.0) * coefficient * power;
        power *= y;
    }
    (value, slope)
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
