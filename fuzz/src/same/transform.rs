//! The built-in transform, forward and inverse, against direct sums.

use crate::hooks::{double, single};
use crate::input::Input;
use crate::memory::{Float, Memory};
use crate::reference::dft;

pub fn run(data: &[u8]) {
    let input = &mut Input::new(data);
    let n = input.small_side().min(if input.odd(4) { 14 } else { 8 });
    if input.flag() { in_f32(input, n) } else { in_f64(input, n) }
}

/// Numbers of one size, or one spike among zeros, which are exact in both precisions.
fn cells(input: &mut Input, n: usize) -> Vec<f64> {
    let mut cells = vec![0.0; n * n * n];
    if input.flag() {
        let place = input.few(256) + 256 * input.few(8);
        cells[place % (n * n * n)] = 1.0;
    } else {
        let mut random = input.random();
        cells.iter_mut().for_each(|cell| *cell = f64::from((random.unit() - 0.5) as f32));
    }
    cells
}

macro_rules! in_precision {
    ($r:ident, $of:ident) => {
        pastey::paste! {
            fn [<in_ $r>](input: &mut Input, n: usize) {
                let fft = $of(n);
                let cells = cells(input, n);
                let [x, y, _] = fft.configuration.stride;
                let mut memory = Memory::<$r>::new(fft.length, |_| 0.0);
                for (cell, &value) in cells.iter().enumerate() {
                    memory.values_mut()[cell / (n * n) * x + cell / n % n * y + cell % n] = $r::of(value);
                }
                let (Some(forward), Some(inverse)) = (fft.forward, fft.inverse) else { unreachable!("the built-in transform has both") };
                // SAFETY: `length` reals of the layout that the transform says.
                assert_eq!(unsafe { forward(fft.context, memory.pointer()) }, 0);
                let expected = dft::forward(n, &cells);
                // Rounding of log2 n passes an axis, 12 in all at most, each an epsilon of the largest possible mode.
                let sum: f64 = cells.iter().map(|cell| cell.abs()).sum();
                let tolerance = 12.0 * f64::from($r::EPSILON) * sum;
                let [i_stride, j_stride, _] = fft.fourier.stride;
                for (mode, expected) in expected.iter().enumerate() {
                    let [i, j, l] = [mode / (n * n), mode / n % n, mode % n];
                    if l <= n / 2 {
                        let at = 2 * (i * i_stride + j * j_stride + l);
                        for part in 0..2 {
                            crate::same::close(memory.values()[at + part].to(), expected[part], tolerance, "forward");
                        }
                    }
                }
                // SAFETY: the same.
                assert_eq!(unsafe { inverse(fft.context, memory.pointer()) }, 0);
                let count = (n * n * n) as f64;
                for (cell, &value) in cells.iter().enumerate() {
                    let found = memory.values()[cell / (n * n) * x + cell / n % n * y + cell % n].to();
                    crate::same::close(found, count * value, 2.0 * count * tolerance, "back");
                }
            }
        }
    };
}

in_precision!(f64, double);
in_precision!(f32, single);
