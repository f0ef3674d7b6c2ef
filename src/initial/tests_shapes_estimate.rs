//! f_NL of each shape from the bispectrum of all closed triangles, by the library's own estimator.

use std::collections::BTreeMap;
use std::vec;
use std::vec::Vec;

use super::modes::{copy_modes, scale_by_table};
use super::shape::{Quadratic, Shape};
use super::tests_shapes::apply;
use crate::cosmology::mode_table_length;
use crate::estimate::bispectrum::{
    Triangle, bispectrum, bispectrum_meshes, bispectrum_scratch, bispectrum_values, closed_triangle_count,
    closed_triangles,
};
use crate::estimate::exact::ExactSum;
use crate::exec::Serial;
use crate::fft::{Fft3, Transform};
use crate::mesh::{Brick, Space};
use crate::noise::{Amplitude, Phase, Realisation, white_modes_coloured};
use crate::reference::built::{memory, serial};

const N: usize = 64;
const N_S: f64 = 0.96;
const E: f64 = (4.0 - N_S) / 3.0;

/// Shells of |n|^2 up to a quarter of the mesh: on 48 cells a side no triangle wraps.
const EDGES: [u64; 11] = [1, 2, 3, 4, 6, 9, 16, 32, 64, 128, 256];
const SIDE: usize = 48;

/// |n|^power by |n|^2.
fn table(power: f64) -> Vec<f64> {
    let entry = |square: usize| if square == 0 { 0.0 } else { libm::pow(square as f64, 0.5 * power) };
    (0..mode_table_length(N).unwrap()).map(entry).collect()
}

/// Potentials have P = |n|^(n_s - 4). They are divided by sqrt(P) before their bispectrum is measured, so that all modes of a triangle of shells
/// have one weight; of N triples in a Gaussian field their sum has the variance s N, s = 1, 2, 6 for three, two and one different shells:
///     f_NL = sum_t (N B N T/(s N))_t / sum_t (N T N T/(s N))_t.
struct Triangles {
    fft: Transform<'static, f64>,
    coarse: Brick,
    triangles: Vec<Triangle>,
    fields: Vec<f64>,
    scratch: &'static mut [u8],
    /// s N.
    variance: Vec<f64>,
    white: Vec<f64>,
}

impl Triangles {
    fn new() -> Self {
        let (fft, shells) = (serial::<f64>(SIDE), EDGES.len() - 1);
        let mut triangles = vec![[0; 3]; closed_triangle_count(&EDGES, None).unwrap()];
        closed_triangles(&mut triangles, &EDGES, None).unwrap();
        let mut this = Self {
            coarse: Brick::whole(N, Space::Fourier).unwrap(),
            fields: vec![0.0; bispectrum_meshes(&fft, shells).unwrap()],
            scratch: memory(bispectrum_scratch(&fft, shells, triangles.len()).unwrap()),
            variance: vec![],
            white: table(1.5 * E),
            fft,
            triangles,
        };
        let counts = this.real(&table(0.0));
        let same = |[i, j, k]: Triangle| [1.0, 2.0, 6.0][usize::from(i == j) + usize::from(j == k)];
        this.variance = this.triangles.iter().zip(counts).map(|(&t, n)| same(t) * n.max(1.0)).collect();
        this
    }

    /// N B of each triangle.
    fn sums(&mut self, modes: &[f64]) -> Vec<f64> {
        let mut padded = vec![0.0; self.fft.length()];
        copy_modes(&mut padded, self.fft.fourier(), modes, &self.coarse, &Serial).unwrap();
        let mut sums = vec![ExactSum::ZERO; self.triangles.len()];
        let Self { fft, triangles, fields, scratch, .. } = self;
        bispectrum(&mut sums, triangles, &EDGES, &padded, fft, fields, scratch, &Serial).unwrap();
        let mut values = vec![0.0; sums.len()];
        bispectrum_values(&mut values, &sums).unwrap();
        // The product of three shells on the cells counts each triple once for each cell.
        values.iter_mut().for_each(|value| *value /= (SIDE * SIDE * SIDE) as f64);
        values
    }

    /// The same of a field whose modes are all real, with values by |n|^2.
    fn real(&mut self, table: &[f64]) -> Vec<f64> {
        let mut modes = vec![0.0; self.coarse.reals()];
        modes.iter_mut().step_by(2).for_each(|re| *re = 1.0);
        scale_by_table(&mut modes, &self.coarse, table, &Serial).unwrap();
        self.sums(&modes)
    }

    /// The same of a potential divided by sqrt(P).
    fn of(&mut self, phi: &[f32]) -> Vec<f64> {
        let mut modes: Vec<f64> = phi.iter().map(|&v| f64::from(v)).collect();
        scale_by_table(&mut modes, &self.coarse, &self.white, &Serial).unwrap();
        self.sums(&modes)
    }

    /// Sums over triples of f_1 g_2 h_3 + 5 permutations, for powers of |n|. The bispectrum is cubic in the field: a quarter of the sum over signs
    /// of (+-)(+-) B(f +- g +- h) is what has each of them once.
    fn permutations(&mut self, powers: [f64; 3]) -> Vec<f64> {
        let largest = 16.0;
        // Each at most 1, or one of them drowns the others.
        let tops = powers.map(|power| libm::pow(largest, power.max(0.0)));
        let [f, g, h] =
            [0, 1, 2].map(|i| table(powers[i]).into_iter().map(|v| v / tops[i]).collect::<Vec<_>>());
        let mut sums = vec![0.0; self.triangles.len()];
        for (a, b) in [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)] {
            let field: Vec<f64> = (0..f.len()).map(|i| f[i] + a * g[i] + b * h[i]).collect();
            let scale = 0.25 * a * b * tops[0] * tops[1] * tops[2];
            sums.iter_mut().zip(self.real(&field)).for_each(|(sum, value)| *sum += scale * value);
        }
        sums
    }

    /// N T of each shape: T is B of Phi/sqrt(P) for f_NL = 1, whatever the estimator finds between the modes of a bin.
    fn templates(&mut self) -> [Vec<f64>; 5] {
        let mut known: BTreeMap<[i32; 3], Vec<f64>> = BTreeMap::new();
        Shape::ALL.map(|shape| {
            let mut sums = vec![0.0; self.triangles.len()];
            for row in shape.rows() {
                // |n|^(e s) for the output, |n|^(e s) P for the factors; and 1/sqrt(P) for all.
                let mut steps = [row.s_out as i32, row.s_a as i32 - 3, row.s_b as i32 - 3];
                steps.sort_unstable();
                let powers = steps.map(|step| E * (f64::from(step) + 1.5));
                let terms = known.entry(steps).or_insert_with(|| self.permutations(powers));
                sums.iter_mut().zip(terms).for_each(|(sum, term)| *sum += row.coefficient * *term);
            }
            sums
        })
    }

    fn f_nl(&self, sums: &[f64], template: &[f64]) -> f64 {
        let weigh =
            |sums: &[f64]| -> f64 { (0..sums.len()).map(|t| sums[t] * template[t] / self.variance[t]).sum() };
        weigh(sums) / weigh(template)
    }

    /// The standard deviation of f_NL from a Gaussian field.
    fn sigma(&self, template: &[f64]) -> f64 {
        let information: f64 =
            (0..template.len()).map(|t| template[t] * template[t] / self.variance[t]).sum();
        1.0 / libm::sqrt(information)
    }
}

/// In single precision, as large simulations have it.
fn gaussian(seed: u64, amplitude: Amplitude, phase: Phase) -> Vec<f32> {
    let brick = Brick::whole(N, Space::Fourier).unwrap();
    let mut phi = vec![0.0; brick.reals()];
    let realisation = Realisation { amplitude, phase, ..Realisation::new(seed) };
    white_modes_coloured(&mut phi, &brick, &realisation, &table(-1.5 * E), &Serial).unwrap();
    phi
}

fn mean_and_error(values: &[f64]) -> (f64, f64) {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let variance = values.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>() / (count - 1.0);
    (mean, libm::sqrt(variance / count))
}

/// Seeds 1 to this.
const SEEDS: u64 = 8;

/// f_NL is the standard deviation of one estimate from a Gaussian field: with all seeds 2.8 of them, and in pairs, where that noise cancels, 20 to
/// 100. Terms of third order in f_NL are below the error of pairs: with three times f_NL they shift the orthogonal shapes, the most sensitive, by
/// -1.7%, and they go as f_NL^2.
fn every_shape_returns_its_f_nl(amplitude: Amplitude) {
    let mut triangles = Triangles::new();
    let templates = triangles.templates();
    let brick = triangles.coarse;
    let mut work = serial::<f32>(3 * N / 2);
    let (mut none, mut local, mut pairs) = (vec![[0.0; 5]; 0], vec![[0.0; 5]; 0], vec![[0.0; 5]; 0]);
    let unit: [f64; 5] = core::array::from_fn(|i| triangles.sigma(&templates[i]));
    for seed in 1..=SEEDS {
        let fields = [Phase::Original, Phase::Inverted].map(|phase| gaussian(seed, amplitude, phase));
        let sums = triangles.of(&fields[0]);
        if seed == 1 {
            let inverted = triangles.of(&fields[1]);
            assert!(sums.iter().zip(&inverted).all(|(a, b)| *a == -*b), "the mean of a Gaussian pair is 0");
        }
        none.push(core::array::from_fn(|i| triangles.f_nl(&sums, &templates[i]) / unit[i]));
        let estimates = Shape::ALL.map(|shape| {
            let i = shape as usize;
            let term = Quadratic { f_nl: unit[i], rows: shape.rows(), n_s: N_S };
            [0, 1].map(|phase| {
                let field = apply(&fields[phase], &brick, &term, &mut work, &Serial).unwrap();
                let sums = triangles.of(&field);
                triangles.f_nl(&sums, &templates[i]) / unit[i]
            })
        });
        local.push(estimates.map(|[original, _]| original));
        pairs.push(estimates.map(|[original, inverted]| 0.5 * (original + inverted)));
    }
    for shape in Shape::ALL {
        let of = |values: &[[f64; 5]]| {
            mean_and_error(&values.iter().map(|all| all[shape as usize]).collect::<Vec<_>>())
        };
        let theory = 1.0 / libm::sqrt(SEEDS as f64);
        for (values, input) in [(&none, 0.0), (&local, 1.0)] {
            let (mean, error) = of(values);
            // The scatter of a Gaussian field, fixed or not: what fixing takes from P it leaves in B.
            assert!((mean - input).abs() < 2.0 * theory, "{amplitude:?} {shape:?}: {mean} for {input}");
            // Of 8 values, within 4 sigma.
            assert!((error / theory - 1.0).abs() < 1.0, "{amplitude:?} {shape:?}: {error} for {theory}");
        }
        let (mean, error) = of(&pairs);
        assert!((mean - 1.0).abs() < 2.0 * error, "{amplitude:?} {shape:?} pairs: {mean} +- {error}");
        assert!(error < 0.2 * theory, "{amplitude:?} {shape:?}: the odd part cancels: {error}");
    }
}

#[test]
fn normal_fields_and_pairs_return_the_f_nl_of_every_shape() {
    every_shape_returns_its_f_nl(Amplitude::Normal);
}

#[test]
fn fixed_fields_and_pairs_return_the_f_nl_of_every_shape() {
    every_shape_returns_its_f_nl(Amplitude::Fixed);
}
