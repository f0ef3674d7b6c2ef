//! What the tests of spectra share.

mod fields;
mod particles;
mod scale;
mod twin;

use std::vec;
use std::vec::Vec;

use super::binning::{Bin, Binning, normalise, read_sums};
use super::compensation::Compensation;
use super::power::{power_sums, power_sums_scratch};
use crate::exec::{Exec, Serial};
use crate::fft::Fft3;
use crate::mesh::Brick;
use crate::real::Real;
use crate::reference::built::{memory, serial};

/// Numbers in (-1, 1) that look like noise.
fn noise(seed: u64) -> impl FnMut() -> f64 {
    let mut state = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1;
    move || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }
}

/// Modes of a random real field of n^3 cells: white, of variance 1/3 a cell; the whole mesh.
fn random_modes(n: usize, seed: u64) -> Vec<f64> {
    let mut fft = serial::<f64>(n);
    let mut next = noise(seed);
    let mut data: Vec<f64> = (0..fft.length()).map(|_| next()).collect();
    fft.forward(&mut data).unwrap();
    data
}

/// The modes of a field given in configuration space, f(x) = sum_k f_k exp(+i k.x).
fn modes_of(n: usize, field: impl Fn([usize; 3]) -> f64) -> Vec<f64> {
    let mut fft = serial::<f64>(n);
    let mut data = vec![0.0; fft.length()];
    let stride = fft.configuration().stride();
    for x in 0..n {
        for y in 0..n {
            for z in 0..n {
                data[x * stride[0] + y * stride[1] + z] = field([x, y, z]) / (n * n * n) as f64;
            }
        }
    }
    fft.forward(&mut data).unwrap();
    data
}

fn sums<T: Real>(
    fields: &[&[T]],
    pairs: &[[usize; 2]],
    compensation: &[Compensation],
    brick: &Brick,
    binning: &Binning<'_>,
    exec: &dyn Exec,
) -> Vec<i64> {
    let mut words = vec![0; binning.words(pairs.len()).unwrap()];
    let scratch = memory(power_sums_scratch(brick, binning, pairs.len()).unwrap());
    power_sums(&mut words, fields, pairs, compensation, brick, binning, scratch, exec).unwrap();
    words
}

fn read(words: &[i64], binning: &Binning<'_>, spectra: usize) -> (Vec<Bin>, Vec<f64>) {
    let mut bins = vec![Bin::default(); binning.bins().unwrap()];
    let mut values = vec![f64::NAN; bins.len() * spectra * binning.multipoles()];
    read_sums(&mut bins, &mut values, words, binning, spectra).unwrap();
    (bins, values)
}

/// Bins and multipoles of one field in a box of volume 1.
fn spectrum(
    modes: &[f64],
    n: usize,
    compensation: Compensation,
    binning: &Binning<'_>,
) -> (Vec<Bin>, Vec<f64>) {
    let brick = *serial::<f64>(n).fourier();
    let words = sums(&[modes], &[[0, 0]], &[compensation], &brick, binning, &Serial);
    let (bins, mut values) = read(&words, binning, 1);
    normalise(&mut values, &bins, binning.orders, 1.0).unwrap();
    (bins, values)
}

/// b^2 for b = first ..= last.
fn unit_shells(first: u64, last: u64) -> Vec<u64> {
    (first..=last).map(|b| b * b).collect()
}
