//! White noise of all schemes, on parts of meshes of any layout, against the definition of one mode.

use crate::bricks::{MODES, whole};
use crate::c::*;
use crate::input::Input;
use crate::memory::Memory;
use crate::noise::{Amplitude, Nyquist, Phase, Realisation, Scheme, Selection};
use crate::reference::{ngenic, white::white_mode};
use crate::same::close;

pub fn run(data: &[u8]) {
    let input = &mut Input::new(data);
    let n = input.small_side();
    let [amplitude, phase, nyquist, selection, scheme] = [3, 2, 2, 2, 3].map(|count| input.few(count));
    // The twin of N-GenIC's scheme makes two generators a column.
    let n = if scheme > 0 { n.min(6) } else { n };
    // It knows seeds of 31 bits only.
    let seeds = if scheme > 0 { (1 << 31) - 1 } else { u64::MAX };
    let choice = Realisation {
        seed: input.word() & seeds,
        scheme: [Scheme::Native, Scheme::NGenIc, Scheme::FastPm][scheme],
        amplitude: [Amplitude::Normal, Amplitude::Fixed, Amplitude::FixedToMean][amplitude],
        phase: [Phase::Original, Phase::Inverted][phase],
        nyquist: [Nyquist::Zero, Nyquist::Filled][nyquist],
        selection: [Selection::Cube, Selection::Sphere][selection],
        sample: [0, 2, 4, 6, 8][input.few(5)],
    };
    let asked = fixpair_realisation {
        struct_size: size_of::<fixpair_realisation>(),
        seed: choice.seed,
        scheme: scheme as i32,
        amplitude: amplitude as i32,
        phase: phase as i32,
        nyquist: nyquist as i32,
        selection: selection as i32,
        sample: choice.sample,
    };
    // A window of the mesh, with strides of the whole and one more.
    let mut brick = whole(n, MODES);
    for axis in 0..3 {
        brick.start[axis] = input.few(brick.count[axis]);
        brick.count[axis] -= brick.start[axis];
        brick.stride[axis] += usize::from(axis == 0);
    }
    let memory = Memory::new(crate::bricks::reals(&brick), |_| 7.0_f64);
    let status = call!(fixpair_white_modes_f64(
        memory.pointer(),
        memory.len(),
        &brick,
        &asked,
        core::ptr::null(),
        0,
        core::ptr::null()
    ));
    // A sample beyond the mesh, or one that the scheme does not know.
    if status != 0 {
        return;
    }
    let slow = (scheme > 0).then(|| ngenic::modes(n, &choice));
    let signed = |i: usize| if i > n / 2 { i as i64 - n as i64 } else { i as i64 };
    let [x, y, z] = brick.count;
    for (a, b, c) in (0..x).flat_map(|a| (0..y).flat_map(move |b| (0..z).map(move |c| (a, b, c)))) {
        let at = 2 * (a * brick.stride[0] + b * brick.stride[1] + c * brick.stride[2]);
        let [i, j, l] = [a + brick.start[0], b + brick.start[1], c + brick.start[2]];
        let found = [memory.values()[at], memory.values()[at + 1]];
        let same = |part: usize, expected: f64, tolerance: f64| {
            close(found[part], expected, tolerance, format_args!("mode {:?} of {n}, {choice:?}", [i, j, l]));
        };
        match &slow {
            // The same uniforms; only the product of modulus and phase may be rounded otherwise.
            Some(modes) => {
                let expected = modes[(i * n + j) * (n / 2 + 1) + l];
                for part in 0..2 {
                    same(part, expected[part], 2.0 * f64::EPSILON * expected[part].abs());
                }
            }
            None => {
                let expected = white_mode(n as i64, [signed(i), signed(j), signed(l)], &choice);
                let expected =
                    if cut(&choice, n, [signed(i), signed(j), signed(l)]) { [0.0; 2] } else { expected };
                // -ln u2 carries 1 ulp, its root half of that, the angle of the twin 2 pi u1 half an ulp of 2 pi. A mode that is its own conjugate
                // is a cosine, possibly small, times at most sqrt(2 * 53 ln 2) = 8.6.
                let scale = if expected[1] == 0.0 { 8.6 } else { expected[0].hypot(expected[1]) };
                for part in 0..2 {
                    same(part, expected[part], 1.5e-15 * scale);
                }
            }
        }
    }
}

/// Is the mode outside the selection?
fn cut(choice: &Realisation, n: usize, mode: [i64; 3]) -> bool {
    let half = if choice.sample == 0 { n as i64 / 2 } else { i64::from(choice.sample) / 2 };
    match choice.selection {
        Selection::Cube => mode.iter().any(|m| m.abs() > half),
        Selection::Sphere => mode.iter().map(|m| m * m).sum::<i64>() > half * half,
    }
}
