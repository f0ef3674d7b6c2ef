//! The estimator finds the f_NL of local non-Gaussianity.

use std::vec;
use std::vec::Vec;

use super::super::{Triangle, bispectrum_sums, bispectrum_sums_scratch, shell_modes};
use super::{values, whole};
use crate::estimate::exact::ExactSum;
use crate::exec::Serial;
use crate::fft::Fft3;
use crate::initial::png::{Local, add_local};
use crate::mesh::{Brick, Space};
use crate::noise::{Amplitude, Realisation, white_modes_coloured};
use crate::reference::built::{memory, serial};

/// Local f_NL in the squeezed slice (shell 0, j, j) of potentials with P ~ k^-3.
///
/// Expected is B = 2 f_NL (P1 P2 + P2 P3 + P3 P1), summed over the very triples of modes that the estimator takes: as sums over cells of
/// shell fields whose modes are P or 1. f_NL is the amplitude that fits best, triangles weighted by their inverse variance.
struct Squeezed {
    n: usize,
    edges: Vec<u64>,
    /// sqrt(P) by |n|^2.
    amplitude: Vec<f64>,
    triangles: Vec<Triangle>,
    /// For f_NL = 1.
    template: Vec<f64>,
    weight: Vec<f64>,
}

impl Squeezed {
    fn new() -> Self {
        let n = 32;
        let edges: Vec<u64> = (1..=16).map(|b| b * b).collect();
        let shells = edges.len() - 1;
        // R.m.s. potential 6e-4: f_NL = 100 adds 6%, its cube 0.02%.
        let amplitude: Vec<f64> =
            (0..=768).map(|m| if m == 0 { 0.0 } else { 1e-4 * f64::from(m).powf(-0.75) }).collect();
        let triangles: Vec<Triangle> = (1..shells as u32).map(|j| [0, j, j]).collect();
        let mut fft = serial::<f64>(n);
        let brick = *fft.fourier();
        let mut field = |shell: usize, power: bool| {
            let mut modes = vec![0.0; fft.length()];
            for x in 0..n {
                for y in 0..n {
                    for z in 0..=n / 2 {
                        let square = [x, y, z].map(|i| Brick::mode(n, i).pow(2)).iter().sum::<i64>();
                        let power = if power { amplitude[square as usize].powi(2) } else { 1.0 };
                        modes[2 * ((x * n + y) * (n / 2 + 1) + z)] = power;
                    }
                }
            }
            let mut out = vec![0.0; fft.length()];
            shell_modes(&mut out, &modes, &brick, edges[shell], edges[shell + 1], &Serial).unwrap();
            fft.inverse(&mut out).unwrap();
            out
        };
        // Shell s with modes 1, shell `shells` + s with modes P.
        let fields: Vec<Vec<f64>> = (0..2 * shells).map(|s| field(s % shells, s >= shells)).collect();
        let parts: Vec<&[f64]> = fields.iter().map(Vec::as_slice).collect();
        let p = shells as u32;
        let pairs: Vec<Triangle> = triangles
            .iter()
            .flat_map(|&[i, j, k]| {
                [[i, p + j, p + k], [p + i, j, p + k], [p + i, p + j, k], [p + i, p + j, p + k]]
            })
            .collect();
        let cells = *fft.configuration();
        let scratch = memory(bispectrum_sums_scratch::<f64>(&cells, parts.len(), pairs.len()).unwrap());
        let mut sums = vec![ExactSum::ZERO; pairs.len()];
        bispectrum_sums(&mut sums, &pairs, &parts, &cells, scratch, &Serial).unwrap();
        let sums = values(&sums);
        let template = sums.as_chunks::<4>().0.iter().map(|s| 2.0 * (s[0] + s[1] + s[2])).collect();
        // The variance is proportional to the sum of P1 P2 P3.
        let weight = sums.as_chunks::<4>().0.iter().map(|s| 1.0 / s[3]).collect();
        Self { n, edges, amplitude, triangles, template, weight }
    }

    fn f_nl(&self, seed: u64, amplitude: Amplitude, f_nl: f64) -> f64 {
        let (n, mut work) = (self.n, serial::<f64>(48));
        let brick = Brick::whole(n, Space::Fourier).unwrap();
        let mut phi = vec![0.0; brick.reals()];
        let realisation = Realisation { amplitude, ..Realisation::new(seed) };
        white_modes_coloured(&mut phi, &brick, &realisation, &self.amplitude, &Serial).unwrap();
        let mut mesh = vec![0.0; work.length()];
        let local = Local { f_nl, g_nl: 0.0 };
        add_local(&mut phi, &brick, local, &mut work, &mut mesh, &mut [[0.0]; 48], &Serial).unwrap();
        let (sums, _) = whole(&self.triangles, &self.edges, &phi, n, 15, &Serial).unwrap();
        let (mut product, mut square) = (0.0, 0.0);
        for ((sum, template), weight) in values(&sums).iter().zip(&self.template).zip(&self.weight) {
            product += sum * template * weight;
            square += template * template * weight;
        }
        product / square
    }
}

/// Mean and its error.
fn mean(values: &[f64]) -> (f64, f64) {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let variance = values.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / (count - 1.0);
    (mean, (variance / count).sqrt())
}

#[test]
fn squeezed_slices_return_their_f_nl() {
    let slice = Squeezed::new();
    for amplitude in [Amplitude::Normal, Amplitude::Fixed] {
        let of = |f_nl: f64| (1..=16).map(|seed| slice.f_nl(seed, amplitude, f_nl)).collect::<Vec<_>>();
        let (gaussian, local) = (of(0.0), of(100.0));
        for (values, truth) in [(&gaussian, 0.0), (&local, 100.0)] {
            let (mean, error) = mean(values);
            assert!((mean - truth).abs() < 2.0 * error, "{amplitude:?}, {truth}: {mean} +- {error}");
        }
        // Matched seeds take most of the scatter away.
        let difference: Vec<f64> = local.iter().zip(&gaussian).map(|(a, b)| a - b).collect();
        let (mean, error) = mean(&difference);
        assert!((mean - 100.0).abs() < 2.0 * error, "{amplitude:?}, matched: {mean} +- {error}");
    }
}
