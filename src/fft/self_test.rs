//! A test of a transform against the contract of this room, for hosts to run on their own hooks.
//!
//! A field of a few plane waves, f(x) = sum_m 2 Re(c_m exp(i k_m.x)), has the modes F(k_m) = n^3 c_m, F(-k_m) = n^3
//! conj(c_m) and no others. Wave numbers and coefficients differ in every axis, sign and phase, so that each way in which
//! transforms disagree moves some mode by a good part of n^3: the sign of the exponent, a division by n^3, axes exchanged,
//! the other half space, results put elsewhere. Elements outside the bricks are filled with a large number first, which a
//! transform that reads them would spread everywhere.

use super::Fft3;
use crate::mesh::{Brick, Space};
use crate::real::Real;
use crate::status::{Error, Result};
use crate::within::Within;

/// (i, j, l), Re c, Im c. Taken modulo n, so that small meshes have waves on top of each other, which is as good.
const WAVES: [([i64; 3], f64, f64); 7] = [
    ([0, 0, 0], 0.2, 0.0),
    ([1, 0, 0], 0.5, 0.9),
    ([0, 1, 0], -0.7, 0.4),
    ([0, 0, 1], 0.3, -1.1),
    ([-2, 1, 3], 0.8, 0.6),
    ([3, -4, 2], -0.6, 1.0),
    ([5, 7, -6], 1.2, -0.3),
];

/// What fills elements outside the bricks: anything that is not small. (A NaN could trap in a host that enables traps.)
const OUTSIDE: f64 = 1e12;

/// Checks that `fft` keeps the contract of this room, on the part of the mesh that this process holds: every process
/// calls it, with its own `data` of [`Fft3::length`] reals, which is overwritten.
///
/// Checked are the bricks (spaces, side, room), sign, scale, order of axes, half space and padding, each way. The tolerance
/// is 16 epsilon log2(n^3) of the largest possible value, where a mistake is of order 1. About 200 operations an
/// element beside the two transforms, and no threads.
///
/// # Errors
/// `Length` if `data` is not `length` reals; `Hook` if a brick cannot be right or a transform failed or gave something
/// else.
///
/// # Example
/// ```
/// # use fixpair::{exec::Serial, fft::{Tables, Transform}, mesh::{Brick, Space}};
/// # #[repr(align(64))] struct Memory([u8; 1 << 16]);
/// # let (mut tables, mut work) = (Memory([0; 1 << 16]), Memory([0; 1 << 16]));
/// # let tables = Tables::<f64>::new(8, &mut tables.0)?;
/// # let mut fft = Transform::new(&tables, Brick::whole(8, Space::Configuration)?, &mut work.0, &Serial)?;
/// use fixpair::fft::{Fft3, self_test};
///
/// let mut data = vec![0.0; fft.length()];
/// self_test(&mut fft, &mut data)?; // the same for a transform of the host's
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn self_test<T: Real>(fft: &mut dyn Fft3<T>, data: &mut [T]) -> Result<()> {
    let (cells, modes) = (*fft.configuration(), *fft.fourier());
    let n = cells.n();
    let spaces = cells.space() == Space::Configuration && modes.space() == Space::Fourier;
    if !spaces || modes.n() != n || fft.length() < cells.reals().max(modes.reals()) {
        return Err(Error::Hook);
    }
    if data.len() != fft.length() {
        return Err(Error::Length);
    }
    let waves = Waves::new(n);
    data.fill(T::from_f64(OUTSIDE));
    waves.visit_cells(&cells, |address, f| {
        data.put(address, T::from_f64(f));
        true
    });
    fft.forward(data)?;
    let good = waves.visit_modes(&modes, |address, f| {
        (0..2).all(|part| {
            (data.at(address + part).to_f64() - f[part]).abs() <= waves.tolerance(T::EPSILON.to_f64())
        })
    });
    if !good {
        return Err(Error::Hook);
    }

    data.fill(T::from_f64(OUTSIDE));
    waves.visit_modes(&modes, |address, f| {
        data.put(address, T::from_f64(f[0]));
        data.put(address + 1, T::from_f64(f[1]));
        true
    });
    fft.inverse(data)?;
    let cube = waves.cube;
    let good = waves.visit_cells(&cells, |address, f| {
        (data.at(address).to_f64() - cube * f).abs() <= waves.tolerance(T::EPSILON.to_f64())
    });
    if good { Ok(()) } else { Err(Error::Hook) }
}

/// The field and its modes on a mesh of side n.
struct Waves {
    n: usize,
    cube: f64,
    /// Index of each mode and its value over n^3: first all k, then all -k.
    modes: [([usize; 3], [f64; 2]); 2 * WAVES.len()],
}

impl Waves {
    fn new(n: usize) -> Self {
        let modes = core::array::from_fn(|m| {
            let (k, re, im) = WAVES[m % WAVES.len()];
            let sign = if m < WAVES.len() { 1 } else { -1 };
            let index = |k: i64| (sign * k).checked_rem_euclid(n as i64).unwrap_or_default() as usize;
            (k.map(index), [re, sign as f64 * im])
        });
        Self { n, cube: (n as f64) * (n as f64) * (n as f64), modes }
    }

    fn tolerance(&self, epsilon: f64) -> f64 {
        let largest: f64 = WAVES.iter().map(|(_, re, im)| 2.0 * (re.abs() + im.abs())).sum();
        16.0 * epsilon * libm::log2(self.cube) * largest * self.cube
    }

    /// exp(2 pi i turns/n).
    fn phase(&self, turns: usize) -> [f64; 2] {
        let turns = turns.checked_rem(self.n).unwrap_or_default();
        let (s, c) = libm::sincos(core::f64::consts::TAU * (turns as f64 / self.n as f64));
        [c, s]
    }

    /// Calls `body` with the address and the field of every cell until it returns false. Did it ever?
    fn visit_cells(&self, brick: &Brick, mut body: impl FnMut(usize, f64) -> bool) -> bool {
        let (start, count, stride) = (brick.start(), brick.count(), brick.stride());
        let steps = self.modes.map(|(k, _)| self.phase(k[2]));
        for x in 0..count[0] {
            for y in 0..count[1] {
                let at = |k: [usize; 3]| k[0] * (start[0] + x) + k[1] * (start[1] + y) + k[2] * start[2];
                let mut terms = self.modes.map(|(k, c)| product(c, self.phase(at(k))));
                for z in 0..count[2] {
                    let address = x * stride[0] + y * stride[1] + z * stride[2];
                    if !body(address, terms.iter().map(|term| term[0]).sum()) {
                        return false;
                    }
                    for (term, step) in terms.iter_mut().zip(steps) {
                        *term = product(*term, step);
                    }
                }
            }
        }
        true
    }

    /// As `visit_cells`, with the address in reals and the value of every mode.
    fn visit_modes(&self, brick: &Brick, mut body: impl FnMut(usize, [f64; 2]) -> bool) -> bool {
        let (start, count, stride) = (brick.start(), brick.count(), brick.stride());
        for x in 0..count[0] {
            for y in 0..count[1] {
                for z in 0..count[2] {
                    let mut f = [0.0; 2];
                    for (k, c) in self.modes {
                        if k == [start[0] + x, start[1] + y, start[2] + z] {
                            f = [f[0] + self.cube * c[0], f[1] + self.cube * c[1]];
                        }
                    }
                    if !body(2 * (x * stride[0] + y * stride[1] + z * stride[2]), f) {
                        return false;
                    }
                }
            }
        }
        true
    }
}

fn product(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0] * b[0] - a[1] * b[1], a[0] * b[1] + a[1] * b[0]]
}
