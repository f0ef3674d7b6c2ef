//! Claims about whole universes: power, pairs, matching, f_NL, convergence.

use std::vec;
use std::vec::Vec;

use super::conditions::{InitialConditions, Order, initial_conditions, initial_conditions_scratch};
use super::modes::{copy_modes, scale_by_table};
use super::particles::Components;
use super::png::Local;
use super::realise::{Field, FieldWork, linear_density};
use super::shape::Shape;
use crate::cosmology::{
    Convention, Cosmology, EisensteinHu, Linear, Wiggles, alpha_table, mode_table_length,
    potential_amplitude_table,
};
use crate::estimate::binning::{Bin, Binning, read_sums};
use crate::estimate::bispectrum::{
    Triangle, bispectrum, bispectrum_meshes, bispectrum_scratch, bispectrum_values, closed_triangle_count,
    closed_triangles,
};
use crate::estimate::compensation::Compensation;
use crate::estimate::exact::ExactSum;
use crate::estimate::power::{power_sums, power_sums_scratch};
use crate::exec::{Exec, Serial, Threads};
use crate::fft::{Fft3, Transform};
use crate::mesh::Brick;
use crate::noise::{Amplitude, Phase, Realisation};
use crate::real::Real;
use crate::reference::built::{memory, serial};
use crate::status::Error;

pub(super) const BOX: f64 = 1000.0;

pub(super) fn conditions(realisation: Realisation, f_nl: f64) -> InitialConditions<'static> {
    let cosmology = Cosmology::goliat();
    let fit = EisensteinHu::new(&cosmology, Wiggles::With).unwrap();
    let linear = Linear::from_eisenstein_hu(fit, cosmology.n_s, 1.0).unwrap();
    InitialConditions {
        realisation,
        cosmology,
        linear: linear.with_sigma8(0.8).unwrap(),
        redshift: 32.0,
        box_size: BOX,
        local: Local { f_nl, g_nl: 0.0 },
        shape: Shape::Local.rows(),
        species: None,
        convention: Convention::Cmb,
        order: Order::Second,
    }
}

pub(super) fn realisation(seed: u64, amplitude: Amplitude, phase: Phase) -> Realisation {
    Realisation { amplitude, phase, ..Realisation::new(seed) }
}

/// sqrt(P_Phi/V) and alpha by |n|^2.
pub(super) fn tables(n: usize) -> (Vec<f64>, Vec<f64>) {
    let poisson = conditions(Realisation::new(0), 0.0).poisson().unwrap();
    let mut potential = vec![0.0; mode_table_length(n).unwrap()];
    let mut alpha = potential.clone();
    potential_amplitude_table(&Serial, &poisson, n, BOX, &mut potential).unwrap();
    alpha_table(&Serial, &poisson, n, BOX, &mut alpha).unwrap();
    (potential, alpha)
}

/// The modes of delta, products taken on a mesh of 3/2 the side.
pub(super) fn density<T: Real>(n: usize, realisation: Realisation, f_nl: f64) -> Vec<T> {
    let (potential_amplitude, transfer) = tables(n);
    let (mut fft, mut fine) = (serial::<T>(n), serial::<T>(3 * n / 2));
    let mut out = vec![T::ZERO; fft.length()];
    let mut mesh = vec![T::ZERO; fine.length()];
    let local = Local { f_nl, g_nl: 0.0 };
    let field = Field {
        realisation,
        potential_amplitude: &potential_amplitude,
        local,
        shape: Shape::Local.rows(),
        n_s: 1.0,
        transfer: &transfer,
    };
    let mut partial = vec![[0.0]; 3 * n / 2];
    let work = FieldWork { mesh: &mut mesh, rest: &mut [], table: &mut [], partial: &mut partial };
    linear_density(&mut out, &field, &mut fft, Some(&mut fine), work, &Serial).unwrap();
    out
}

/// A field whose modes are all real, with values by |n|^2.
fn real_modes(n: usize, table: &[f64]) -> Vec<f64> {
    let brick = *serial::<f64>(n).fourier();
    let mut modes = vec![0.0; brick.reals()];
    modes.iter_mut().step_by(2).for_each(|re| *re = 1.0);
    scale_by_table(&mut modes, &brick, table, &Serial).unwrap();
    modes
}

/// Modes and sums of |f_k|^2 in shells.
fn bins<T: Real>(n: usize, modes: &[T], edges: &[u64]) -> Vec<(u64, f64)> {
    let brick = *serial::<T>(n).fourier();
    let binning = Binning::shells(edges);
    let mut sums = vec![0; binning.words(1).unwrap()];
    let scratch = memory(power_sums_scratch(&brick, &binning, 1).unwrap());
    let none = [Compensation::None];
    power_sums(&mut sums, &[modes], &[[0, 0]], &none, &brick, &binning, scratch, &Serial).unwrap();
    let mut bins = vec![Bin::default(); binning.bins().unwrap()];
    let mut power = vec![0.0; bins.len()];
    read_sums(&mut bins, &mut power, &sums, &binning, 1).unwrap();
    bins.iter().zip(power).map(|(bin, power)| (bin.count, power)).collect()
}

#[test]
fn fixed_field_has_exactly_the_input_power() {
    let n = 32;
    let (potential, alpha) = tables(n);
    let edges: Vec<u64> = (1..=16).map(|b| b * b).collect();
    // The input's mean over the modes of each bin, from the same sums over a field of its square roots.
    let root: Vec<f64> = potential.iter().zip(&alpha).map(|(p, a)| p * a).collect();
    let expected = bins(n, &real_modes(n, &root), &edges);
    for phase in [Phase::Original, Phase::Inverted] {
        let double = bins(n, &density::<f64>(n, realisation(3, Amplitude::Fixed, phase), 0.0), &edges);
        let single = bins(n, &density::<f32>(n, realisation(3, Amplitude::Fixed, phase), 0.0), &edges);
        for ((bin, double), single) in expected.iter().zip(double).zip(single) {
            assert_eq!(bin.0, double.0);
            // |w| = 1 and two products: a few roundings.
            assert!((double.1 / bin.1 - 1.0).abs() < 4.0 * f64::EPSILON);
            assert!((single.1 / bin.1 - 1.0).abs() < 4.0 * f64::from(f32::EPSILON));
        }
    }
    let mean =
        bins(n, &density::<f64>(n, realisation(3, Amplitude::FixedToMean, Phase::Original), 0.0), &edges);
    for (bin, mean) in expected.iter().zip(mean) {
        assert!((mean.1 / bin.1 / core::f64::consts::FRAC_PI_4 - 1.0).abs() < 1e-14);
    }
}

#[test]
fn normal_field_scatters_about_the_input_power() {
    let n = 32;
    let edges = [1, 256];
    let fixed =
        bins(n, &density::<f64>(n, realisation(1, Amplitude::Fixed, Phase::Original), 0.0), &edges)[0];
    // Each ratio of power-weighted sums has a relative scatter of order sqrt(2/effective modes); a mean of 16 seeds within 3 sigma.
    let ratios: Vec<f64> = (1..=16)
        .map(|seed| {
            let normal = density::<f64>(n, realisation(seed, Amplitude::Normal, Phase::Original), 0.0);
            bins(n, &normal, &edges)[0].1 / fixed.1
        })
        .collect();
    let (mean, error) = mean_and_error(&ratios);
    assert!((mean - 1.0).abs() < 3.0 * error, "{mean} +- {error}");
    assert!(error > 1e-4);
}

fn mean_and_error(values: &[f64]) -> (f64, f64) {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let variance = values.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>() / (count - 1.0);
    (mean, libm::sqrt(variance / count))
}

#[test]
fn pairs_are_negatives_without_png_and_share_the_quadratic_term_with_it() {
    let n = 16;
    let pair = |f_nl: f64| {
        let [original, inverted] = [Phase::Original, Phase::Inverted]
            .map(|phase| density::<f64>(n, realisation(5, Amplitude::Normal, phase), f_nl));
        (original, inverted)
    };
    let (original, inverted) = pair(0.0);
    assert!(original.iter().zip(&inverted).all(|(a, b)| *a == -*b));
    let (plus, minus) = pair(100.0);
    let (double, _) = pair(200.0);
    let size = original.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
    for i in 0..plus.len() {
        let even = 0.5 * (plus[i] + minus[i]);
        let odd = 0.5 * (plus[i] - minus[i]);
        assert!((odd - original[i]).abs() < 1e-15 * size, "the linear part is that of f_NL = 0");
        assert!(
            (double[i] - original[i] - 2.0 * even).abs() < 1e-15 * size,
            "the even part is linear in f_NL"
        );
    }
    let (flipped, _) = pair(-100.0);
    let opposite =
        |a: &[f64], b: &[f64], within: f64| a.iter().zip(b).all(|(a, b)| (a + b).abs() <= within * size);
    assert!(!opposite(&plus, &minus, 1e-4), "inverting does not flip the whole field");
    assert!(opposite(&flipped, &minus, 1e-15), "that would be f_NL -> -f_NL");
}

/// f_NL from the bispectrum of all closed triangles below the Nyquist wavenumber, each weighted by its inverse variance in a Gaussian field
/// (Scoccimarro et al. 2004, astro-ph/0312286; Sefusatti, Crocce & Desjacques 2010, arXiv:1003.0007):
///     f_NL = sum_t (N B T/(s P P P))_t / sum_t (N T^2/(s P P P))_t,
/// T being B for f_NL = 1 and s = 1, 2, 6 for three, two and one different shells. The mesh of 3/2 the side closes triangles exactly.
struct FromTriangles {
    fft: Transform<'static, f64>,
    coarse: Brick,
    triangles: Vec<Triangle>,
    fields: Vec<f64>,
    scratch: &'static mut [u8],
    /// N T, and T/(s P P P).
    template: Vec<f64>,
    weight: Vec<f64>,
}

impl FromTriangles {
    const EDGES: [u64; 11] = [1, 2, 3, 4, 5, 9, 16, 32, 64, 128, 256];

    fn new(n: usize) -> Self {
        let (fft, shells) = (serial::<f64>(3 * n / 2), Self::EDGES.len() - 1);
        let mut triangles = vec![[0; 3]; closed_triangle_count(&Self::EDGES, None).unwrap()];
        closed_triangles(&mut triangles, &Self::EDGES, None).unwrap();
        let mut this = Self {
            coarse: *serial::<f64>(n).fourier(),
            fields: vec![0.0; bispectrum_meshes(&fft, shells).unwrap()],
            scratch: memory(bispectrum_scratch(&fft, shells, triangles.len()).unwrap()),
            template: vec![],
            weight: vec![],
            fft,
            triangles,
        };
        // B is cubic: of fields alpha (1 + p) and alpha (1 - p) the mean, less that of alpha, is alpha alpha alpha (p p + p p + p p).
        let (potential, alpha) = tables(n);
        let unit = potential[n / 2] * potential[n / 2];
        let [plus, minus, none] = [1.0, -1.0, 0.0].map(|sign| {
            let table = potential.iter().zip(&alpha).map(|(p, alpha)| alpha * (1.0 + sign * p * p / unit));
            this.sums(&real_modes(n, &table.collect::<Vec<f64>>()))
        });
        let counts = this.sums(&real_modes(n, &vec![1.0; alpha.len()]));
        let root: Vec<f64> = potential.iter().zip(&alpha).map(|(p, a)| p * a).collect();
        let shells = bins(n, &real_modes(n, &root), &Self::EDGES);
        for (t, (&[i, j, k], &count)) in this.triangles.iter().zip(&counts).enumerate() {
            let template = 2.0 * unit * unit * (0.5 * (plus[t] + minus[t]) - none[t]);
            let power = [i, j, k].map(|s| shells[s as usize].1 / shells[s as usize].0 as f64);
            let same = [1.0, 2.0, 6.0][usize::from(i == j) + usize::from(j == k)];
            this.template.push(template);
            this.weight.push(template / (same * count.max(1.0) * power.iter().product::<f64>()));
        }
        this
    }

    /// N B of each triangle.
    fn sums(&mut self, modes: &[f64]) -> Vec<f64> {
        let mut padded = vec![0.0; self.fft.length()];
        copy_modes(&mut padded, self.fft.fourier(), modes, &self.coarse, &Serial).unwrap();
        let mut sums = vec![ExactSum::ZERO; self.triangles.len()];
        let Self { fft, triangles, fields, scratch, .. } = self;
        bispectrum(&mut sums, triangles, &Self::EDGES, &padded, fft, fields, scratch, &Serial).unwrap();
        let mut values = vec![0.0; sums.len()];
        bispectrum_values(&mut values, &sums).unwrap();
        values
    }

    fn f_nl(&mut self, density: &[f64]) -> f64 {
        let sums = self.sums(density);
        let weigh =
            |sums: &[f64]| sums.iter().zip(&self.weight).map(|(sum, weight)| sum * weight).sum::<f64>();
        weigh(&sums) / weigh(&self.template)
    }
}

#[test]
fn bispectrum_of_the_density_returns_the_input_f_nl() {
    let n = 32;
    let mut estimator = FromTriangles::new(n);
    for amplitude in [Amplitude::Normal, Amplitude::Fixed] {
        let mut measured = |f_nl: f64| -> Vec<f64> {
            (1..=40)
                .map(|seed| estimator.f_nl(&density(n, realisation(seed, amplitude, Phase::Original), f_nl)))
                .collect()
        };
        let (zero, hundred) = (measured(0.0), measured(100.0));
        for (values, input) in [(&zero, 0.0), (&hundred, 100.0)] {
            let (mean, error) = mean_and_error(values);
            assert!((mean - input).abs() < 2.0 * error, "{amplitude:?}: {mean} +- {error} for {input}");
        }
        let differences: Vec<f64> = hundred.iter().zip(&zero).map(|(a, b)| a - b).collect();
        let (mean, error) = mean_and_error(&differences);
        let (_, unmatched) = mean_and_error(&hundred);
        assert!((mean - 100.0).abs() < 3.0 * error && error < 0.5 * unmatched, "matched: {mean} +- {error}");
    }
}

pub(super) fn particles<T: Real>(
    n: usize,
    conditions: &InitialConditions<'_>,
    exec: &dyn Exec,
    fine: bool,
) -> (Vec<T>, Vec<T>) {
    let (mut fft, mut work) = (serial::<T>(n), serial::<T>(3 * n / 2));
    let (mut x, mut v) = (vec![T::ZERO; 3 * n * n * n], vec![T::ZERO; 3 * n * n * n]);
    let optional = fine.then_some(&work as &dyn Fft3<T>);
    let scratch = memory(initial_conditions_scratch(conditions.parts(), &fft, optional).unwrap());
    initial_conditions(
        &mut Components::triples(&mut x).unwrap(),
        &mut Components::triples(&mut v).unwrap(),
        conditions,
        &mut fft,
        fine.then_some(&mut work as &mut dyn Fft3<T>),
        scratch,
        exec,
    )
    .unwrap();
    (x, v)
}

/// Distance of positions across the periodic edge.
fn shift(a: f64, b: f64) -> f64 {
    let d = a - b;
    d - BOX * libm::round(d / BOX)
}

#[test]
fn second_order_is_a_correction_that_scales_as_the_growth_squared() {
    let n = 16;
    let at = |redshift: f64, order: Order| {
        let mut conditions = conditions(realisation(9, Amplitude::Normal, Phase::Original), 0.0);
        conditions.redshift = redshift;
        conditions.order = order;
        let growth = conditions.poisson().unwrap().growth();
        let (x, v) = particles::<f64>(n, &conditions, &Serial, true);
        (x, v, growth)
    };
    let correction = |redshift: f64| {
        let (first, second) = (at(redshift, Order::First), at(redshift, Order::Second));
        let x: Vec<f64> = second.0.iter().zip(&first.0).map(|(a, b)| shift(*a, *b)).collect();
        let v: Vec<f64> = second.1.iter().zip(&first.1).map(|(a, b)| a - b).collect();
        (x, v, second.2)
    };
    let (early, late) = (correction(63.0), correction(31.0));
    let ratio = late.2.d2 / early.2.d2;
    let size = late.0.iter().fold(0.0_f64, |m, d| m.max(d.abs()));
    for (a, b) in early.0.iter().zip(&late.0) {
        // Differences of positions of order 1000 in f64.
        assert!((b - ratio * a).abs() < 1e-9 * size.max(1.0));
    }
    // v2 = a H f2 Psi2, so that velocity and displacement of the correction are parallel.
    let a = 1.0 / 32.0;
    let factor = a * 100.0 * Cosmology::goliat().expansion(a).unwrap() * late.2.f2;
    for (x, v) in late.0.iter().zip(&late.1) {
        assert!((v - factor * x).abs() < 1e-9 * factor * size.max(1.0));
    }
    assert!(size > 1e-3, "and it is there");
}

#[test]
fn the_one_call_does_not_depend_on_threads_and_single_follows_double() {
    let n = 16;
    let conditions = conditions(realisation(11, Amplitude::Fixed, Phase::Inverted), 100.0);
    for fine in [false, true] {
        let (x, v) = particles::<f64>(n, &conditions, &Serial, fine);
        assert!(x.iter().all(|x| (0.0..BOX).contains(x)));
        for threads in [2, 5] {
            assert_eq!(
                particles::<f64>(n, &conditions, &Threads::new(threads).unwrap(), fine),
                (x.clone(), v.clone())
            );
        }
        let (x32, v32) = particles::<f32>(n, &conditions, &Serial, fine);
        let fastest = v.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
        for i in 0..x.len() {
            // Positions are rounded at the size of the box; displacements carry the error of f32 transforms.
            assert!(shift(x[i], f64::from(x32[i])).abs() < 2e-7 * BOX);
            assert!((v[i] - f64::from(v32[i])).abs() < 1e-5 * fastest);
        }
    }
}

#[test]
fn coarse_and_fine_meshes_share_their_modes() {
    let (coarse, fine) =
        (density::<f64>(16, Realisation::new(2), 0.0), density::<f64>(24, Realisation::new(2), 0.0));
    let mut shared = vec![0.0; coarse.len()];
    let (small, large) = (*serial::<f64>(16).fourier(), *serial::<f64>(24).fourier());
    copy_modes(&mut shared, &small, &fine, &large, &Serial).unwrap();
    assert_eq!(shared, coarse);
}

#[test]
fn bad_conditions_are_refused_before_anything_is_written() {
    let n = 8;
    let good = conditions(Realisation::new(1), 10.0);
    let (mut x, mut v) = (vec![7.0; 3 * 512], vec![7.0; 3 * 512]);
    let mut attempt = |conditions: &InitialConditions<'_>, fine: usize, bytes: usize| {
        let (mut fft, mut work) = (serial::<f64>(n), serial::<f64>(fine));
        let layout =
            initial_conditions_scratch(conditions.parts(), &fft, Some(&work as &dyn Fft3<f64>)).unwrap();
        let scratch = memory(layout);
        let scratch = &mut scratch[..bytes.min(layout.size)];
        let outcome = initial_conditions(
            &mut Components::triples(&mut x).unwrap(),
            &mut Components::triples(&mut v).unwrap(),
            conditions,
            &mut fft,
            Some(&mut work as &mut dyn Fft3<f64>),
            scratch,
            &Serial,
        );
        if outcome.is_err() {
            assert!(x.iter().chain(&v).all(|&value| value == 7.0));
        }
        outcome
    };
    let all = usize::MAX;
    let mut bad = good;
    bad.redshift = f64::NAN;
    assert_eq!(attempt(&bad, 12, all), Err(Error::NotFinite));
    bad = good;
    bad.redshift = -1.0;
    assert_eq!(attempt(&bad, 12, all), Err(Error::Range));
    bad = good;
    bad.box_size = 0.0;
    assert_eq!(attempt(&bad, 12, all), Err(Error::Range));
    bad = good;
    bad.local.g_nl = f64::INFINITY;
    assert_eq!(attempt(&bad, 12, all), Err(Error::NotFinite));
    bad = good;
    bad.local.g_nl = 1.0;
    assert_eq!(attempt(&bad, 12, all), Err(Error::Brick), "a cube needs twice the side");
    assert_eq!(attempt(&good, 10, all), Err(Error::Brick));
    assert_eq!(attempt(&good, 12, 1000), Err(Error::Scratch));
    assert_eq!(attempt(&good, 12, all), Ok(()));
}

#[test]
fn scratch_stays_within_the_documented_bytes_a_cell() {
    fn bytes<T: Real>(order: Order, dealiased: bool) -> f64 {
        let n = 64;
        let (fft, fine) = (serial::<T>(n), serial::<T>(3 * n / 2));
        let fine = dealiased.then_some(&fine as &dyn Fft3<T>);
        initial_conditions_scratch(order.into(), &fft, fine).unwrap().size as f64 / (n * n * n) as f64
    }
    // A row of n = 64 has 3% of padding, and the tables by |n|^2 add 12/n bytes; both shrink with n.
    assert!(bytes::<f64>(Order::Second, false) < 33.3);
    assert!(bytes::<f64>(Order::Second, true) < 64.0);
    assert!(bytes::<f32>(Order::Second, false) < 16.8);
    assert!(bytes::<f32>(Order::Second, true) < 32.1);
    assert!(bytes::<f64>(Order::First, false) < 16.8);
}

#[test]
fn tables_have_the_same_bits_on_every_machine() {
    // FNV-1a of the bits: a change breaks every universe that was made before, and belongs in the changelog.
    let hash = |values: &[f64]| {
        let bytes = values.iter().flat_map(|v| v.to_bits().to_le_bytes());
        bytes.fold(0xcbf2_9ce4_8422_2325_u64, |h, byte| (h ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3))
    };
    let (potential, alpha) = tables(16);
    let motion = conditions(Realisation::new(0), 0.0).motion().unwrap();
    let factors = [motion.second_order, motion.step().first_velocity, motion.step().second_velocity];
    let pinned = [0xdc23_07d9_7a55_3429, 0xa564_6dd2_f72f_1193, 0x8c4b_7be2_5e33_8079];
    assert_eq!([hash(&potential), hash(&alpha), hash(&factors)], pinned);
}
