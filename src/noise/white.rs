//! The modes of a brick.

use super::blocks::Draw;
use super::ngenic;
use super::realisation::{Nyquist, Realisation, Scheme};
use crate::exec::Exec;
use crate::mesh::{Brick, Space};
use crate::real::Real;
use crate::simd::Simd;
use crate::status::{Error, Result};
use crate::walk;
use crate::within::Within;

/// Runs shorter than this are drawn mode by mode.
const SHORT: usize = 4;

/// Unit modes w(k), <|w|^2> = 1, of the Fourier brick.
///
/// From the Philox block of the mode number come u1 in [0, 1) and u2 in (0, 1], of 53 bits each; then
///
/// | | complex modes | self-conjugate modes |
/// |---|---|---|
/// | Normal | sqrt(-ln u2) exp(2 pi i u1) | sqrt(-2 ln u2) cos(2 pi u1) |
/// | Fixed | exp(2 pi i u1) | the sign of cos(2 pi u1) |
/// | `FixedToMean` | sqrt(pi)/2 exp(2 pi i u1) | sqrt(2/pi) times that sign |
///
/// and Inverted is the exact negative. Of the two modes k and -k where both are stored (l = 0 and l = n/2) the one drawn is that with j > 0,
/// or, where j is its own negative, that with i > 0; the other is its conjugate. Here 0 and n/2 are their own negatives, and
/// n/2 enters the counter as +n/2. DC is +0, and so are the Nyquist planes unless `Filled`.
///
/// In the scheme `NGenIc` u1 and u2, of 48 bits, come from the stream of their (i, j): ranlxd1 under the seed that [`ngenic_seeds`](super::ngenic_seeds)
/// gives, two numbers for each l from 0 upwards, the second again while it is zero. (i, j, 0) with i > n/2, or i = 0 and j > n/2, is the
/// conjugate of (-i, -j, 0). `FastPm` draws l = n/2 and, `Filled`, the other Nyquist modes, too: it takes conjugates on l = 0 and l = n/2
/// where -i < i as an index, or i is its own negative and -j < j; and its Normal self-conjugate modes are sqrt(-ln u2) cos(2 pi u1), of
/// half the power. Those programs multiply w by sqrt(P/V) as delta_k of exp(+i k.x), as here: no sign differs.
///
/// Modes outside the realisation's [`Selection`](super::Selection) are +0. 2LPTic compares floating-point numbers with floor(Nsample/2), so
/// that modes on the very boundary may be cut there and are drawn here.
///
/// `out`: modes as (re, im) in the layout of `brick`; what lies between rows is left alone. f32 modes are the rounded
/// f64 modes. Each mode depends on the realisation and its number alone, in every bit.
///
/// # Errors
/// `Brick` if the brick is not in Fourier space, `Length` if `out` is too short, `Choice` for `Filled` with `NGenIc`, which has no such
/// modes: `out` is then untouched. `Hook` if `exec` failed.
///
/// # Cost
/// Native: about 10 ns a mode on one AVX2 core where l is contiguous; ten times that in layouts that put l elsewhere, whose modes are
/// drawn one by one. One write of `out`, no scratch.
///
/// `NGenIc`, `FastPm`: about 17 ns for each mode from l = 0 to the last that is drawn, in any layout, so that a brick which cuts l draws what
/// it does not hold; `FastPm` `Filled` half as much again. Before that one thread draws the whole table of seeds, about 20 ns for each of n^2
/// entries, whatever the brick. No scratch: a column's seeds lie in its first two modes until the modes take their place.
///
/// # Sources
/// Salmon et al. 2011 (Philox); Box & Muller 1958; Angulo & Pontzen 2016 (arXiv:1603.05253); Eq. rayleigh and Eq. dirac of
/// arXiv:2204.11103. Luescher 1994 (hep-lat/9309020) for ranlxd1; Springel et al. 2005 (N-GenIC), Crocce, Pueblas & Scoccimarro
/// 2006 (2LPTic), Feng et al. 2016 (FastPM) for the schemes.
///
/// # Example
/// ```
/// use fixpair::exec::Serial;
/// use fixpair::mesh::{Brick, Space};
/// use fixpair::noise::{Amplitude, Realisation, white_modes};
///
/// let brick = Brick::whole(8, Space::Fourier)?;
/// let mut modes = vec![0.0_f64; brick.reals()];
/// let fixed = Realisation { amplitude: Amplitude::Fixed, ..Realisation::new(1) };
/// white_modes(&mut modes, &brick, &fixed, &Serial)?;
/// let [re, im] = [modes[2], modes[3]]; // (0, 0, 1)
/// assert!((re * re + im * im - 1.0).abs() < 1e-15);
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn white_modes<T: Real>(
    out: &mut [T],
    brick: &Brick,
    realisation: &Realisation,
    exec: &dyn Exec,
) -> Result<()> {
    draw(out, brick, realisation, None, exec, Simd::detect())
}

/// As [`white_modes`], each mode times `amplitude[i^2 + j^2 + l^2]` before it is rounded to `T`: colours in the same pass.
///
/// `amplitude`: one real factor for each squared mode number, at least 3 (n/2)^2 + 1 of them. Entry 0 is not
/// used, for DC stays +0. With amplitude sqrt(P(k)/V) the modes are those of a field of power P.
///
/// # Errors
/// As [`white_modes`]; `Length` also if `amplitude` is too short, `NotFinite` if a factor is NaN or so large that 16
/// times it is not finite in `T` (unit modes stay below 9). `out` is then untouched.
///
/// # Example
/// ```
/// use fixpair::exec::Serial;
/// use fixpair::mesh::{Brick, Space};
/// use fixpair::noise::{Amplitude, Realisation, white_modes_coloured};
///
/// let brick = Brick::whole(8, Space::Fourier)?;
/// let mut modes = vec![0.0_f64; brick.reals()];
/// let fixed = Realisation { amplitude: Amplitude::Fixed, ..Realisation::new(1) };
/// let amplitude = [3.0; 49]; // by |n|^2
/// white_modes_coloured(&mut modes, &brick, &fixed, &amplitude, &Serial)?;
/// assert!((modes[2].hypot(modes[3]) - 3.0).abs() < 1e-14);
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn white_modes_coloured<T: Real>(
    out: &mut [T],
    brick: &Brick,
    realisation: &Realisation,
    amplitude: &[f64],
    exec: &dyn Exec,
) -> Result<()> {
    let half = brick.n() / 2;
    let table = amplitude.get(..=3 * half * half).ok_or(Error::Length)?;
    brick.check_space(Space::Fourier)?;
    brick.check_length(out)?;
    if table[1..].iter().any(|&a| !T::from_f64(16.0 * a).is_finite()) {
        return Err(Error::NotFinite);
    }
    draw(out, brick, realisation, Some(table), exec, Simd::detect())
}

/// Both of the above, on a given code path.
pub(super) fn draw<T: Real>(
    out: &mut [T],
    brick: &Brick,
    realisation: &Realisation,
    colour: Option<&[f64]>,
    exec: &dyn Exec,
    simd: Simd,
) -> Result<()> {
    brick.check_space(Space::Fourier)?;
    brick.check_length(out)?;
    match (realisation.scheme, realisation.nyquist) {
        (Scheme::Native, _) => {}
        // It has no such modes.
        (Scheme::NGenIc, Nyquist::Filled) => return Err(Error::Choice),
        (Scheme::NGenIc | Scheme::FastPm, _) => {
            return ngenic::draw(out, brick, realisation, colour, exec, simd);
        }
    }
    let drawn = Draw::new(realisation);
    let n = brick.n();
    walk::walk::<T, 1, 0>(exec, brick, [out], [], &|run, [out], []| {
        let [i, j] = [0, 1].map(|axis| Brick::mode(n, run.index[axis]));
        let row = Row { half: (n / 2) as i32, i: i as i32, j: j as i32, draw: drawn, colour };
        let out = out.as_chunks_mut().0;
        let within = realisation.modes_along_l(n, i, j).saturating_sub(run.index[2]).min(out.len());
        let (within, beyond) = out.split_at_mut(within);
        row.fill(run.index[2], within, simd);
        beyond.fill([T::ZERO; 2]);
    })
}

/// The modes of one (i, j).
struct Row<'a> {
    half: i32,
    i: i32,
    j: i32,
    draw: Draw,
    colour: Option<&'a [f64]>,
}

impl Row<'_> {
    /// Modes l = `first ..`.
    fn fill<T: Real>(&self, first: usize, out: &mut [[T; 2]], simd: Simd) {
        let half = self.half as usize;
        // l = 0 and l = n/2 hold both members of pairs; between them each mode is drawn as it stands.
        let begin = usize::from(first == 0).min(out.len());
        let end = out.len().min(half - first.min(half)).max(begin);
        let (before, rest) = out.split_at_mut(begin);
        let (inner, after) = rest.split_at_mut_checked(end - begin).unwrap_or_default();
        for (mode, l) in before.iter_mut().zip(first..).chain(after.iter_mut().zip(first + end..)) {
            *mode = self.single(l as u32);
        }
        let l = (first + begin) as u32;
        if inner.len() < SHORT {
            for (mode, l) in inner.iter_mut().zip(l..) {
                *mode = self.single(l);
            }
            return;
        }
        let colour = self.colour.map(|table| table.part(self.square()..));
        match simd {
            #[cfg(target_arch = "x86_64")]
            // SAFETY: `Simd::Avx2` exists only where the processor has AVX2.
            Simd::Avx2 => unsafe { row_avx2(&self.draw, self.i, self.j, l, colour, inner) },
            _ => self.draw.row(self.i, self.j, l, colour, inner),
        }
    }

    /// i^2 + j^2.
    fn square(&self) -> usize {
        let (i, j) = (i64::from(self.i), i64::from(self.j));
        (i * i + j * j) as usize
    }

    /// The mode l, whatever it is.
    fn single<T: Real>(&self, l: u32) -> [T; 2] {
        let (i, j, half) = (self.i, self.j, self.half);
        let own_negative = |m: i32| m == 0 || m == half;
        let negative = |m: i32| if own_negative(m) { m } else { -m };
        let unit = if (i, j, l) == (0, 0, 0) {
            return [T::ZERO; 2];
        } else if !own_negative(l as i32) {
            self.draw.complex(i, j, l)
        } else if own_negative(i) && own_negative(j) {
            self.draw.real(i, j, l)
        } else if j > 0 && !own_negative(j) || own_negative(j) && i > 0 {
            self.draw.complex(i, j, l)
        } else {
            let [re, im] = self.draw.complex(negative(i), negative(j), l);
            [re, -im]
        };
        let l = l as usize;
        match self.colour {
            Some(table) => unit.map(|x| T::from_f64(x * table.at(self.square() + l * l))),
            None => unit.map(T::from_f64),
        }
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn row_avx2<T: Real>(draw: &Draw, i: i32, j: i32, first: u32, colour: Option<&[f64]>, out: &mut [[T; 2]]) {
    draw.row(i, j, first, colour, out);
}
