//! The cases of the statistics: ensembles, scatter, bias and f_NL, matched simulations, matrices.

use fixpair::scratch::Layout;
use fixpair::variance::bias::{Bias, Spectrum, bias_of_k, halo_power, measured_bias};
use fixpair::variance::carpool::{Carpool, carpool, carpool_scratch};
use fixpair::variance::contours::contours;
use fixpair::variance::control::{
    Beta, ControlVariate, control_variate_gain, control_variate_loss, control_variates,
    control_variates_scratch,
};
use fixpair::variance::covariance::{covariance_root, covariance_root_scratch};
use fixpair::variance::ensemble::{
    Moments, ensemble_add, ensemble_correlation, ensemble_count, ensemble_covariance, ensemble_deviation,
    ensemble_error_of_mean, ensemble_init, ensemble_length, ensemble_mean, ensemble_merge,
};
use fixpair::variance::fit::{BiasFit, FREE_B_G, FREE_F_NL, FREE_P, fit_bias};
use fixpair::variance::levels::{delta_chi_squared, hartlap_factor, percival_factor};
use fixpair::variance::likelihood::{BiasLikelihood, Spectra, add_correlated_scratch};
use fixpair::variance::matched::{
    Estimate, difference_sigma, effective_volume, matched_difference, universality,
};
use fixpair::variance::models::{
    Suppression, continuum_modes, lattice_modes, sigma_gaussian, sigma_suppressed,
};
use fixpair::variance::pairs::{pair_average, sigma_per_simulation};
use fixpair::variance::posterior::{
    Grid, Posterior, bias_grid, bias_posterior, bias_posterior_scratch, bias_range, marginal, read_posterior,
};
use fixpair::variance::ratios::{Means, difference_of_means, ratio_of_means};
use fixpair::variance::resample::{
    bootstrap_indices, jackknife, jackknife_covariance, jackknife_means, resampled_mean,
};
use fixpair::variance::suppression::{Scatter, SuppressionFit, fit_suppression, fit_suppression_weighted};

use crate::vectors::{Cases, Hash, SEED, noise};
use crate::vectors_real::Memory;

const VALUES: usize = 5;
const SAMPLES: usize = 12;
/// Samples of the first of two processes.
const FIRST: usize = 7;
const BINS: usize = 14;
/// Bins of P_hh where P_hm follow.
const HALO_HALO: usize = 9;
const CONTROLS: usize = 3;
/// Side of a matrix that needs more than one block.
const SIDE: usize = 40;
/// Points of a grid.
const POINTS: [usize; 2] = [20, 30];
const WIDE: usize = 64;
const SHOT_NOISE: f64 = 250.0;

const TRUTH: Bias = Bias { b_g: 2.32, p: 1.0, f_nl: 100.0, delta_c: 1.686 };
const START: Bias = Bias { b_g: 2.2, p: 1.0, f_nl: 80.0, delta_c: 1.686 };

pub(crate) fn variance_cases(cases: &mut Cases) {
    let (y, c) = samples();
    let state = ensembles(cases, &y, &c);
    resampling(cases, &y, &state);
    let bins = Bins::new();
    scatters(cases, &bins);
    let likelihood = biases(cases, &bins);
    posteriors(cases, &likelihood);
    matched(cases, &y, &c);
    matrices(cases, &y, &c);
}

/// Rows of what is wanted and of what correlates with it.
fn samples() -> (Vec<f64>, Vec<f64>) {
    let of = |i: usize| (i % VALUES) as f64;
    let y = |i| 100.0 + 10.0 * of(i) + 3.0 * noise(i) + 2.0 * noise(i + 7000);
    let c = |i| 90.0 + 5.0 * of(i) + 2.0 * noise(i) + 0.5 * noise(i + 9000);
    ((0..VALUES * SAMPLES).map(y).collect(), (0..VALUES * SAMPLES).map(c).collect())
}

fn ensembles(cases: &mut Cases, y: &[f64], c: &[f64]) -> Vec<f64> {
    let both = [Moments::Variance, Moments::Covariance];
    let lengths =
        both.iter().flat_map(|&of| (1..=10).map(move |n| ensemble_length(n, of).expect("a length")));
    cases.add("ensemble_length", Hash::new().integers(&lengths.map(|n| n as u64).collect::<Vec<_>>()));
    let mut hash = Hash::new();
    let mut state = Vec::new();
    for moments in both {
        let length = ensemble_length(VALUES, moments).expect("a length");
        let mut other = vec![1.0; length];
        state = vec![1.0; length];
        ensemble_init(&mut state, VALUES, moments).expect("a state");
        ensemble_init(&mut other, VALUES, moments).expect("a state");
        ensemble_add(&mut state, &y[..FIRST * VALUES]).expect("samples");
        ensemble_add(&mut other, &y[FIRST * VALUES..]).expect("samples");
        hash = hash.doubles(&state).doubles(&other);
        ensemble_merge(&mut state, &other).expect("two states");
        hash = hash.doubles(&state);
    }
    cases.add("ensemble_state", hash);
    let mut moments = [[0.0; VALUES]; 3];
    ensemble_mean(&mut moments[0], &state).expect("means");
    ensemble_deviation(&mut moments[1], &state).expect("deviations");
    ensemble_error_of_mean(&mut moments[2], &state).expect("errors");
    let count = ensemble_count(&state).expect("a number");
    cases.add("ensemble_moments", Hash::new().integers(&[count]).doubles(moments.as_flattened()));
    let (mut whole, mut cross) = ([0.0; VALUES * VALUES], [0.0; 6]);
    ensemble_covariance(&mut whole, &state, 0..VALUES, 0..VALUES).expect("a covariance");
    ensemble_covariance(&mut cross, &state, 0..2, 2..5).expect("a covariance");
    cases.add("ensemble_covariance", Hash::new().doubles(&whole).doubles(&cross));
    ensemble_correlation(&mut whole, &state, 0..VALUES, 0..VALUES).expect("coefficients");
    ensemble_correlation(&mut cross, &state, 0..2, 2..5).expect("coefficients");
    cases.add("ensemble_correlation", Hash::new().doubles(&whole).doubles(&cross));
    let mut average = vec![0.0; y.len()];
    pair_average(&mut average, y, c).expect("averages");
    cases.add("pair_average", Hash::new().doubles(&average));
    let (mut sigma, mut error) = ([0.0; VALUES], [0.0; VALUES]);
    sigma_per_simulation(&mut sigma, &mut error, &moments[1], SAMPLES as u64, 2).expect("scatter");
    cases.add("sigma_per_simulation", Hash::new().doubles(&sigma).doubles(&error));
    state
}

fn resampling(cases: &mut Cases, y: &[f64], state: &[f64]) {
    let mut indices = [0; SAMPLES];
    bootstrap_indices(&mut indices, SAMPLES as u64, SEED, (1 << 40) + 3).expect("draws");
    cases.add("bootstrap_indices", Hash::new().integers(&indices));
    let (mut mean, mut corrected, mut error) = ([0.0; VALUES], [0.0; VALUES], [0.0; VALUES]);
    resampled_mean(&mut mean, y, &indices).expect("a mean");
    cases.add("resampled_mean", Hash::new().doubles(&mean));
    let (mut deleted, mut covariance) = (vec![0.0; y.len()], [0.0; VALUES * VALUES]);
    jackknife_means(&mut deleted, y, VALUES).expect("means");
    cases.add("jackknife_means", Hash::new().doubles(&deleted));
    ensemble_mean(&mut mean, state).expect("means");
    jackknife(&mut corrected, &mut error, &mean, &deleted).expect("errors");
    cases.add("jackknife", Hash::new().doubles(&corrected).doubles(&error));
    jackknife_covariance(&mut covariance, &deleted, SAMPLES, VALUES).expect("a covariance");
    cases.add("jackknife_covariance", Hash::new().doubles(&covariance));
}

/// Spectra of halos and of halos with matter, bin by bin, and what they are made of.
struct Bins {
    k: [f64; BINS],
    linear: [f64; BINS],
    alpha: [f64; BINS],
    modes: [f64; BINS],
    power: [[f64; BINS]; 2],
    sigma: [[f64; BINS]; 2],
}

impl Bins {
    fn new() -> Self {
        let of = |make: &dyn Fn(f64) -> f64| core::array::from_fn(|b| make((b + 1) as f64));
        let linear = of(&|x| 20000.0 / (1.0 + 0.5 * x));
        let alpha = of(&|x| 500.0 * x * x / (1.0 + 0.1 * x));
        let power = [Spectrum::HaloHalo, Spectrum::HaloMatter].map(|spectrum| {
            let mut power = [0.0; BINS];
            halo_power(&mut power, &TRUTH, spectrum, &linear, &alpha).expect("P");
            core::array::from_fn(|b| power[b] * (1.0 + 0.02 * noise(b + 300)))
        });
        let sigma = power.map(|power| core::array::from_fn(|b| 0.05 * power[b] / (b + 1) as f64));
        Self { k: of(&|x| 0.005 * x), linear, alpha, modes: of(&|x| 26.0 * x * x), power, sigma }
    }

    fn spectra(&self, which: usize) -> Spectra<'_> {
        Spectra { power: &self.power[which], linear: &self.linear, alpha: &self.alpha }
    }
}

fn of_fit(hash: Hash, fit: &SuppressionFit) -> Hash {
    let triples = [fit.value, fit.error].map(|s: Suppression| [s.cosmic_variance, s.softening, s.shot_noise]);
    let hash = hash.doubles(triples.as_flattened()).doubles(&fit.covariance);
    hash.doubles(&[fit.chi_squared]).integers(&[fit.degrees])
}

fn scatters(cases: &mut Cases, bins: &Bins) {
    let (k, modes, power) = (&bins.k, &bins.modes, &bins.power[0]);
    let mut out = [0.0; BINS];
    let mut error = [0.0; BINS];
    continuum_modes(&mut out, k, 0.005, 1000.0).expect("modes");
    cases.add("continuum_modes", Hash::new().doubles(&out));
    let mut counts = [0; 5];
    lattice_modes(&mut counts, &[0, 1, 4, 9, 16, 1000]).expect("modes");
    cases.add("lattice_modes", Hash::new().integers(&counts));
    sigma_gaussian(&mut out, power, modes, SHOT_NOISE).expect("scatter");
    cases.add("sigma_gaussian", Hash::new().doubles(&out));
    let left = Suppression { cosmic_variance: 0.25, softening: 0.04, shot_noise: 0.9 };
    sigma_suppressed(&mut out, &left, k, power, modes, SHOT_NOISE).expect("scatter");
    cases.add("sigma_suppressed", Hash::new().doubles(&out));
    let sigma: [f64; BINS] = core::array::from_fn(|b| out[b] * (1.0 + 0.05 * noise(b + 500)));
    let errors = sigma.map(|sigma| 0.1 * sigma);
    let scatter = Scatter { sigma: &sigma, k, power, modes, noise: SHOT_NOISE };
    let weighted = fit_suppression_weighted(&scatter, &errors).expect("a fit");
    let iterated = fit_suppression(&scatter, 41).expect("a fit");
    cases.add("fit_suppression", of_fit(of_fit(Hash::new(), &weighted), &iterated));
    let rho: [f64; BINS] = core::array::from_fn(|b| 0.5 * noise(b + 600));
    let means = [0, 1].map(|which| Means { mean: &bins.power[which], error: &bins.sigma[which] });
    let (mut ratios, mut differences) = (Hash::new(), Hash::new());
    for rho in [None, Some(&rho[..])] {
        ratio_of_means(&mut out, &mut error, means[0], means[1], rho).expect("ratios");
        ratios = ratios.doubles(&out).doubles(&error);
        difference_of_means(&mut out, &mut error, means[0], means[1], rho, &sigma).expect("differences");
        differences = differences.doubles(&out).doubles(&error);
    }
    cases.add("ratio_of_means", ratios);
    cases.add("difference_of_means", differences);
}

fn of_likelihood(hash: Hash, likelihood: &BiasLikelihood) -> Hash {
    hash.integers(&[likelihood.bins]).doubles(likelihood.root.as_flattened())
}

fn biases(cases: &mut Cases, bins: &Bins) -> BiasLikelihood {
    let both = [Spectrum::HaloHalo, Spectrum::HaloMatter];
    let none = Bias::default();
    cases.add("bias_init", Hash::new().doubles(&[none.b_g, none.p, none.f_nl, none.delta_c]));
    let (mut out, mut error) = ([0.0; BINS], [0.0; BINS]);
    bias_of_k(&mut out, &TRUTH, &bins.alpha).expect("b");
    cases.add("bias_of_k", Hash::new().doubles(&out));
    let (mut power, mut measured, mut added) = (Hash::new(), Hash::new(), Hash::new());
    let mut likelihoods = [BiasLikelihood::EMPTY; 2];
    for (which, spectrum) in both.into_iter().enumerate() {
        halo_power(&mut out, &TRUTH, spectrum, &bins.linear, &bins.alpha).expect("P");
        power = power.doubles(&out);
        let (of, sigma) = (&bins.power[which], &bins.sigma[which]);
        measured_bias(&mut out, &mut error, spectrum, of, sigma, &bins.linear).expect("b");
        measured = measured.doubles(&out).doubles(&error);
        likelihoods[which].add(spectrum, bins.spectra(which), sigma).expect("data");
        added = of_likelihood(added, &likelihoods[which]);
    }
    cases.add("halo_power", power);
    cases.add("measured_bias", measured);
    cases.add("likelihood_add", added);

    let [mut likelihood, matter] = likelihoods;
    let mixed: [f64; BINS] = core::array::from_fn(|b| bins.power[usize::from(b >= HALO_HALO)][b]);
    let mut root = [[0.0; BINS]; BINS];
    for i in 0..BINS {
        for j in 0..=i {
            let sigma = bins.sigma[0][i];
            root[i][j] = if i == j { sigma } else { 0.1 * sigma * noise(17 * i + j) };
        }
    }
    let layout = add_correlated_scratch(BINS).expect("scratch");
    let mut memory = Memory::new(layout);
    let mut correlated = BiasLikelihood::EMPTY;
    let spectra = Spectra { power: &mixed, ..bins.spectra(0) };
    let scratch = memory.bytes(layout.size);
    correlated.add_correlated(HALO_HALO, spectra, root.as_flattened(), 0.75, scratch).expect("data");
    cases.add("likelihood_add_correlated", of_likelihood(sizes(Hash::new(), layout), &correlated));
    likelihood.merge(&matter).expect("two");
    likelihood.merge(&correlated).expect("two");
    cases.add("likelihood_merge", of_likelihood(Hash::new(), &likelihood));
    let chi_squared = likelihood.chi_squared(&TRUTH).expect("chi^2");
    cases.add("likelihood_chi_squared", Hash::new().doubles(&[chi_squared]));
    likelihood
}

fn sizes(hash: Hash, layout: Layout) -> Hash {
    hash.integers(&[layout.size as u64, layout.align as u64])
}

fn of_bias_fit(hash: Hash, fit: &BiasFit) -> Hash {
    let Bias { b_g, p, f_nl, delta_c } = fit.value;
    let hash = hash.doubles(&[b_g, p, f_nl, delta_c]).doubles(&fit.error).doubles(&fit.covariance);
    hash.doubles(&[fit.chi_squared]).integers(&[fit.degrees])
}

fn of_posterior(hash: Hash, of: &Posterior) -> Hash {
    hash.doubles(&[of.peak, of.mean, of.deviation, of.low, of.high, of.centre, of.half_width, of.edge])
}

fn posteriors(cases: &mut Cases, likelihood: &BiasLikelihood) {
    let sets = [FREE_B_G, FREE_P, FREE_F_NL, FREE_B_G | FREE_P, FREE_B_G | FREE_F_NL];
    let layout = bias_posterior_scratch(WIDE).expect("scratch");
    let mut memory = Memory::new(layout);
    let (mut fits, mut read) = (Hash::new(), sizes(Hash::new(), layout));
    for free in sets {
        let fit = fit_bias(likelihood, &START, free).expect("a fit");
        fits = of_bias_fit(fits, &fit);
        let all = bias_posterior(likelihood, &START, free, WIDE, 0.68, memory.bytes(layout.size)).expect("p");
        read = of_bias_fit(read, &all.fit);
        for posterior in &all.posterior[..free.count_ones() as usize] {
            read = of_posterior(read, posterior);
        }
    }
    cases.add("fit_bias", fits);
    cases.add("bias_posterior", read);

    let mut range = [[0.0; 2]; 2];
    bias_range(&mut range, likelihood, &START, FREE_B_G | FREE_F_NL).expect("a range");
    cases.add("bias_range", Hash::new().doubles(range.as_flattened()));
    let mut grid = vec![0.0; POINTS[0] * POINTS[1]];
    let places = Grid { range, points: POINTS };
    bias_grid(&mut grid, likelihood, &START, FREE_B_G | FREE_F_NL, &places).expect("chi^2");
    cases.add("bias_grid", Hash::new().doubles(&grid));
    let (mut densities, mut read) = (Hash::new(), Hash::new());
    for axis in 0..2 {
        let mut density = vec![0.0; POINTS[axis]];
        marginal(&mut density, &grid, POINTS, axis, range[axis]).expect("a density");
        densities = densities.doubles(&density);
        read = of_posterior(read, &read_posterior(&density, range[axis], 0.95).expect("a posterior"));
    }
    cases.add("marginal", densities);
    cases.add("read_posterior", read);
    let levels = [(0.68, 1), (0.95, 1), (0.68, 2), (0.95, 2)];
    let levels = levels.map(|(probability, of)| delta_chi_squared(probability, of).expect("a level"));
    cases.add("delta_chi_squared", Hash::new().doubles(&levels));
    let level = grid.iter().copied().fold(f64::INFINITY, f64::min) + levels[2];
    let count = contours(&mut [], &grid, POINTS, range, level).expect("a number");
    let mut segments = vec![[0.0; 4]; count];
    contours(&mut segments, &grid, POINTS, range, level).expect("a contour");
    assert!(count > 4, "a contour closes");
    cases.add("contours", Hash::new().integers(&[count as u64]).doubles(segments.as_flattened()));
    let factors =
        [hartlap_factor(41, 14), percival_factor(41, 14, 2)].map(|factor| factor.expect("a factor"));
    cases.add("factors", Hash::new().doubles(&factors));
}

fn of_controls(hash: Hash, values: &[ControlVariate]) -> Hash {
    values.iter().fold(hash, |hash, of| {
        hash.doubles(&[of.mean, of.error, of.beta, of.correlation, of.deviation, of.gain])
    })
}

/// The expectation of control `i`.
fn mu(i: usize) -> f64 {
    90.0 + 5.0 * i as f64
}

fn matched(cases: &mut Cases, y: &[f64], c: &[f64]) {
    let of = matched_difference(&y[..SAMPLES], &c[..SAMPLES]).expect("a difference");
    let numbers = [of.mean_first, of.mean_second, of.deviation_first, of.deviation_second, of.correlation];
    let hash = Hash::new().doubles(&numbers);
    let hash = hash.doubles(&[of.correlation_error, of.mean, of.deviation, of.error_of_mean]);
    cases.add("matched_difference", hash);
    let (b_g, f_nl) = (Estimate { value: 2.32, error: 0.01 }, Estimate { value: 109.2, error: 8.3 });
    let p = universality(b_g, f_nl, -0.05, 100.0).expect("p");
    let numbers = [
        difference_sigma(12.1, 11.8, 0.76).expect("sigma"),
        effective_volume(60.5, 1, 12.1, 2).expect("a volume"),
        p.value,
        p.error,
        control_variate_gain(12.1, 11.8, 0.76, 0.5).expect("a gain"),
        control_variate_loss(12, 3).expect("a loss"),
    ];
    cases.add("matched_numbers", Hash::new().doubles(&numbers));
    let layout = control_variates_scratch(SAMPLES).expect("scratch");
    let mut memory = Memory::new(layout);
    let nothing =
        ControlVariate { mean: 0.0, error: 0.0, beta: 0.0, correlation: 0.0, deviation: 0.0, gain: 0.0 };
    let mut values = [nothing; VALUES];
    let (mu, error): ([f64; VALUES], [f64; VALUES]) = (core::array::from_fn(mu), [0.125; VALUES]);
    let mut hash = sizes(Hash::new(), layout);
    for (error, beta) in [(None, Beta::Given(1.0)), (None, Beta::Optimal), (Some(&error[..]), Beta::Optimal)]
    {
        control_variates(&mut values, y, c, &mu, error, beta, memory.bytes(layout.size)).expect("a mean");
        hash = of_controls(hash, &values);
    }
    cases.add("control_variates", hash);
}

fn matrices(cases: &mut Cases, y: &[f64], c: &[f64]) {
    let matrix: Vec<f64> = (0..SIDE * SIDE)
        .map(|at| {
            let (i, j) = (at / SIDE, at % SIDE);
            let correlation = if i == j { 1.5 } else { 1.0 / (1.0 + i.abs_diff(j) as f64) };
            correlation * ((i + 1) * (j + 1)) as f64
        })
        .collect();
    let layout = covariance_root_scratch(SIDE).expect("scratch");
    let mut memory = Memory::new(layout);
    let mut root = vec![0.0; matrix.len()];
    covariance_root(&mut root, &matrix, SIDE, memory.bytes(layout.size)).expect("a root");
    cases.add("covariance_root", sizes(Hash::new(), layout).doubles(&root));

    let layout = carpool_scratch(VALUES, CONTROLS).expect("scratch");
    let mut memory = Memory::new(layout);
    let controls: Vec<f64> =
        (0..SAMPLES * CONTROLS).map(|i| c[i / CONTROLS * VALUES + i % CONTROLS]).collect();
    let mu: [f64; CONTROLS] = core::array::from_fn(mu);
    let mut of_mu = [0.0; CONTROLS * CONTROLS];
    for i in 0..CONTROLS {
        of_mu[i * CONTROLS + i] = 0.015625;
    }
    let (mut mean, mut covariance) = ([0.0; VALUES], [0.0; VALUES * VALUES]);
    let mut beta = [0.0; VALUES * CONTROLS];
    let mut hash = sizes(Hash::new(), layout);
    for covariance_of_mu in [None, Some(&of_mu[..])] {
        let of = Carpool { y, c: &controls, samples: SAMPLES, mu: &mu, covariance_of_mu };
        let scratch = memory.bytes(layout.size);
        carpool(&mut mean, &mut covariance, &mut beta, &of, scratch).expect("a mean");
        hash = hash.doubles(&mean).doubles(&covariance).doubles(&beta);
    }
    cases.add("carpool", hash);
}
