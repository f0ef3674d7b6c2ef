//! Interlacing: two meshes, half a cell apart, whose odd images cancel.
//!
//! A mesh at points i H has F_k = sum over images m of f_(k + 2 pi m/H); one at (i + 1/2) H has the same with factors exp(i (k + 2 pi m/H).H/2),
//! that is, (-1)^(m1 + m2 + m3) beside exp(+i k.H/2). The mean of F_k and exp(-i k.H/2) F'_k so keeps images with even m1 + m2 + m3 alone
//! (Hockney & Eastwood 1981, sec. 7-3; Sefusatti et al. 2016, arXiv:1512.07295, eq. 3.3). H stands for (H, H, H).

use crate::exec::Exec;
use crate::math::sin_cos_turns;
use crate::mesh::{Brick, Space};
use crate::real::Real;
use crate::simd::Simd;
use crate::status::Result;
use crate::walk::walk;
use crate::within::Within;

/// Modes that share a table of phases.
const BLOCK: usize = 64;

/// Modes of the interlaced mesh: (modes + exp(-i k.H/2) shifted)/2, in place.
///
/// `modes`: of a deposit with shift 0. `shifted`: of one with shift 1/2. Both with f(x) = sum_k f_k exp(+i k.x), or both times the same factor.
///
/// A mode with a number n/2 stands for +n/2 and -n/2, which are odd images of each other. It becomes the mean of the two interlaced
/// modes, which is `modes`/2, so that the field remains real; its power is about half of one mode's: end bins at |n|^2 = (n/2)^2.
///
/// # Errors
/// `Brick` for a brick of configuration space, `Length`, `Hook`.
///
/// The same bits on any threads and bricks. Cost: one pass; phases are products of two tabulated ones, right to 1e-15.
///
/// # Example
/// ```
/// use fixpair::exec::Serial;
/// use fixpair::mesh::{Brick, Space};
/// use fixpair::pm::interlace;
///
/// let brick = Brick::whole(8, Space::Fourier)?;
/// let (mut modes, shifted) = (vec![1.0_f64; brick.reals()], vec![1.0; brick.reals()]);
/// interlace(&mut modes, &shifted, &brick, &Serial)?; // the mean of both, turned back by half a cell
/// assert_eq!(modes[0], 1.0);
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn interlace<T: Real>(modes: &mut [T], shifted: &[T], brick: &Brick, exec: &dyn Exec) -> Result<()> {
    interlace_with(Simd::detect(), modes, shifted, brick, exec)
}

pub(super) fn interlace_with<T: Real>(
    simd: Simd,
    modes: &mut [T],
    shifted: &[T],
    brick: &Brick,
    exec: &dyn Exec,
) -> Result<()> {
    brick.check_space(Space::Fourier)?;
    let n = brick.n();
    // k.H/2 = pi (i + j + l)/n; half of the phase's modulus is the mean's factor.
    let turns_per_mode = -0.5 / n as f64;
    let mut table = [[0.0; 2]; BLOCK];
    for (l, phase) in table.iter_mut().enumerate() {
        let (sine, cosine) = sin_cos_turns(turns_per_mode * l as f64);
        *phase = [0.5 * cosine, 0.5 * sine];
    }
    walk::<T, 1, 1>(exec, brick, [modes], [shifted], &|run, [modes], [shifted]| {
        simd.vectorise(
            #[inline(always)]
            || {
                let [x, y, z] = run.index;
                let sum = Brick::mode(n, x) + Brick::mode(n, y);
                let nyquist = 2 * x == n || 2 * y == n;
                let ordinary = if nyquist { 0 } else { run.length.min(n / 2 - z.min(n / 2)) };
                let (modes, halved) = modes.split_at_mut_checked(2 * ordinary).unwrap_or_default();
                let (mut modes, mut shifted, mut l) = (modes, shifted.part(..2 * ordinary), z);
                while !modes.is_empty() {
                    // Blocks begin at multiples of their length, wherever the run does: a mode has one phase in all bricks.
                    let step = l % BLOCK;
                    let length = BLOCK.min(step + modes.len() / 2) - step;
                    let Some((block, later)) = modes.split_at_mut_checked(2 * length) else { break };
                    let Some((from, shifted_later)) = shifted.split_at_checked(2 * length) else { break };
                    let (sine, cosine) = sin_cos_turns(turns_per_mode * (sum + (l - step) as i64) as f64);
                    mean(block, from, [cosine, sine], table.part(step..));
                    (modes, shifted, l) = (later, shifted_later, l + length);
                }
                let half = T::from_f64(0.5);
                halved.iter_mut().for_each(|part| *part = half * *part);
            },
        );
    })
}

/// modes/2 + first table shifted.
#[inline(always)]
fn mean<T: Real>(modes: &mut [T], shifted: &[T], first: [f64; 2], table: &[[f64; 2]]) {
    for ((mode, shifted), step) in modes.chunks_exact_mut(2).zip(shifted.chunks_exact(2)).zip(table) {
        let phase = [first[0] * step[0] - first[1] * step[1], first[0] * step[1] + first[1] * step[0]];
        let (re, im) = (shifted[0].to_f64(), shifted[1].to_f64());
        mode[0] = T::from_f64(0.5 * mode[0].to_f64() + (re * phase[0] - im * phase[1]));
        mode[1] = T::from_f64(0.5 * mode[1].to_f64() + (re * phase[1] + im * phase[0]));
    }
}
