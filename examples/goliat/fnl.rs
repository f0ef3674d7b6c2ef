//! b_g and f_NL of each simulation or pair, and of the mean of all: what the paper's Table 3 and Figures 3 to 7 show.
//!
//! Each is fitted with p = 1 (case iii); the estimate is the peak of the posterior. The mean is that of both phases, with the error of one
//! simulation, or of one pair where pairs are compared with it.

use fixpair::status::Result;
use fixpair::variance::matched::{Estimate, MatchedDifference, matched_difference, universality};
use fixpair::variance::posterior::Posterior;

use crate::bias::{Case, Fit, likelihood};
use crate::late_statistics::have_halos;
use crate::sigma::Scatter;
use crate::statistics::{Kind, spectra};
use crate::suite::{Half, Suite};

/// Bins without which b_g and f_NL cannot both be fitted and found wanting.
const LEAST_BINS: usize = 3;

pub(crate) const HALVES: [Half; 2] = [Half::Gaussian, Half::Local];

/// The fit of one simulation or pair.
#[derive(Clone, Debug)]
pub(crate) struct Each {
    pub(crate) b_g: Posterior,
    pub(crate) fnl: Posterior,
    pub(crate) chi_squared: f64,
}

/// One type of simulations of one f_NL.
pub(crate) struct Ensemble {
    pub(crate) scatter: Scatter,
    /// Of the mean, with the error of one simulation, by `Case`; with f_NL = 0 the second is not there.
    pub(crate) mean: [Option<Fit>; 3],
    /// The third with the error of one estimate.
    pub(crate) one: Option<Fit>,
    /// The first with the measured scatter in place of its model.
    pub(crate) by_measured: Option<Fit>,
    /// The second with the error of the mean.
    pub(crate) all: Option<Fit>,
    /// By seed; none where the posterior is not closed.
    pub(crate) each: Vec<Option<Each>>,
}

/// One type of simulations: the estimates of the seeds whose posteriors are closed in both halves.
pub(crate) struct Row {
    pub(crate) kind: Kind,
    pub(crate) halves: [Ensemble; 2],
    /// Places of those seeds.
    pub(crate) seeds: Vec<usize>,
    /// Estimates of f_NL by half.
    pub(crate) fnl: [Vec<f64>; 2],
    /// None for fewer than two.
    pub(crate) matched: Option<MatchedDifference>,
    /// p of Eq. p, from f100 and from f100 - f0.
    pub(crate) p: [Vec<f64>; 2],
}

/// All that is fitted to spectra of halos.
pub(crate) struct Analysis {
    /// Bins from the first that are fitted.
    pub(crate) bins: usize,
    /// In the order of `Kind::ALL`.
    pub(crate) rows: [Row; 4],
}

impl Analysis {
    /// # Errors
    /// A sentence on why nothing can be fitted.
    pub(crate) fn new(suite: &Suite) -> std::result::Result<Self, String> {
        let (k, k_max) = (&suite.bins().k, suite.configuration.k_max);
        let bins = k.partition_point(|&k| k <= k_max);
        if !have_halos(suite) {
            return Err(String::from("there are too few halos"));
        }
        if bins < LEAST_BINS {
            return Err(format!(
                "{bins} bins are below k = {k_max} h/Mpc and {LEAST_BINS} are needed: a larger --box or --k-max has more"
            ));
        }
        let [first, second, third, fourth] = Kind::ALL.map(|kind| Row::new(suite, kind, bins));
        let rows = || Ok([first?, second?, third?, fourth?]);
        rows().map(|rows| Self { bins, rows }).map_err(|error: fixpair::status::Error| {
            format!("the scatter of {} seeds has no use as an error: {error}", suite.seeds.len())
        })
    }

    pub(crate) fn row(&self, kind: Kind) -> &Row {
        &self.rows[kind as usize]
    }
}

impl Ensemble {
    fn new(suite: &Suite, kind: Kind, half: Half, bins: usize) -> Result<Self> {
        let scatter = Scatter::new(suite, kind, half, bins)?;
        let fnl = suite.configuration.fnl_of(half);
        let (shared, simulations) = (suite.bins(), kind.simulations() as f64);
        let scaled = |sigma: &[f64], simulations: f64| -> Vec<f64> {
            sigma[..bins].iter().map(|sigma| sigma / simulations.sqrt()).collect()
        };
        let fit = |power: &[f64], sigma: &[f64], case| Fit::new(likelihood(shared, power, sigma)?, case, fnl);

        let single = scaled(&scatter.sigma, 1.0);
        let [first, second, third] = Case::ALL.map(|case| fit(&scatter.power, &single, case));
        let estimate = scaled(&scatter.sigma, simulations);
        // Both phases of N seeds make the mean; those of Normal repeat each other in linear theory.
        let independent = suite.seeds.len() as f64 * if kind == Kind::Normal { 1.0 } else { 2.0 };
        let each = |power: &Vec<f64>| {
            let fit = fit(power, &estimate, Case::Fnl)?;
            Ok(fit.map(|fit| Each {
                b_g: *fit.b_g(),
                fnl: *fit.second(),
                chi_squared: fit.constraints.fit.chi_squared,
            }))
        };
        Ok(Self {
            mean: [first?, second?, third?],
            one: fit(&scatter.power, &estimate, Case::Fnl)?,
            by_measured: fit(&scatter.power, &scaled(&scatter.measured, 1.0), Case::Bias)?,
            all: fit(&scatter.power, &scaled(&scatter.sigma, independent), Case::Universality)?,
            each: spectra(suite, kind, half, |one| &one.late.halos)?
                .iter()
                .map(each)
                .collect::<Result<_>>()?,
            scatter,
        })
    }
}

impl Row {
    fn new(suite: &Suite, kind: Kind, bins: usize) -> Result<Self> {
        let [gaussian, local] = HALVES.map(|half| Ensemble::new(suite, kind, half, bins));
        let halves = [gaussian?, local?];
        let both = |seed: usize| Some([halves[0].each[seed].as_ref()?, halves[1].each[seed].as_ref()?]);
        let seeds: Vec<usize> = (0..suite.seeds.len()).filter(|&seed| both(seed).is_some()).collect();
        let closed: Vec<[&Each; 2]> = seeds.iter().filter_map(|&seed| both(seed)).collect();
        let fnl = [0, 1].map(|half| closed.iter().map(|each| each[half].fnl.peak).collect::<Vec<_>>());
        let p = |of: &dyn Fn(&[&Each; 2]) -> f64| -> Result<Vec<f64>> {
            let exact = |value| Estimate { value, error: 0.0 };
            let one = |each: &[&Each; 2]| {
                universality(exact(each[1].b_g.peak), exact(of(each)), 0.0, suite.configuration.fnl)
            };
            closed.iter().map(|each| Ok(one(each)?.value)).collect()
        };
        let p = [p(&|each| each[1].fnl.peak)?, p(&|each| each[1].fnl.peak - each[0].fnl.peak)?];
        let matched = matched_difference(&fnl[1], &fnl[0]).ok();
        Ok(Self { kind, seeds, fnl, matched, p, halves })
    }

    /// Of each seed in `seeds`, f100 - f0.
    pub(crate) fn differences(&self) -> Vec<f64> {
        self.fnl[1].iter().zip(&self.fnl[0]).map(|(local, gaussian)| local - gaussian).collect()
    }

    /// Fits of each half that have no closed posterior.
    pub(crate) fn open(&self) -> [usize; 2] {
        [0, 1].map(|half| self.halves[half].each.iter().filter(|each| each.is_none()).count())
    }

    /// Half the width of the posterior of f_NL with the error of one estimate.
    pub(crate) fn half_width(&self, half: usize) -> Option<f64> {
        Some(self.halves[half].one.as_ref()?.second().half_width)
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use fixpair::variance::bias::{Bias, Spectrum, halo_power};

    use super::*;
    use crate::measurement::{Bins, Early, Late, Measurement};
    use crate::statistics::mean;
    use crate::suite::{Amplitude, Configuration, Phase, Variant};

    /// Uniform in (-sqrt 3, sqrt 3): mean 0, deviation 1; the same for all halves, and turned for the inverted.
    fn draw(seed: usize, bin: usize) -> f64 {
        let mut state = ((seed * 64 + bin + 1) as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        state ^= state >> 29;
        state = state.wrapping_mul(0xbf58_476d_1ce4_e5b9);
        state ^= state >> 32;
        12f64.sqrt() * ((state >> 11) as f64 / (1u64 << 53) as f64 - 0.5)
    }

    /// Halos of b_g = 2.5 and f_NL = 100 that scatter as linear theory has it, `fixed` times as much with fixed amplitudes.
    pub(crate) fn suite(seeds: usize, fixed: f64, noise: f64) -> Suite {
        let count = 20;
        let k: Vec<f64> = (1..=count).map(|i| 0.015 * i as f64).collect();
        let bins = Bins {
            modes: (1..=count as u64).map(|i| 26 * i * i).collect(),
            theory: k.iter().map(|k| 100.0 / (1.0 + 400.0 * k * k)).collect(),
            late_theory: k.iter().map(|k| 1e4 / (1.0 + 400.0 * k * k)).collect(),
            late_alpha: k.iter().map(|k| 1e7 * k * k / (1.0 + 25.0 * k)).collect(),
            k,
            squeezed_growth: 1.0,
            ..Bins::default()
        };
        let mut measurements = Vec::new();
        for seed in 0..seeds {
            for variant in Variant::all() {
                let truth = Bias {
                    b_g: 2.5,
                    f_nl: if variant.half == Half::Local { 100.0 } else { 0.0 },
                    ..Bias::default()
                };
                let mut halos = vec![0.0; count];
                halo_power(&mut halos, &truth, Spectrum::HaloHalo, &bins.late_theory, &bins.late_alpha)
                    .unwrap();
                for (i, power) in halos.iter_mut().enumerate() {
                    let scatter = noise * (2.0 / bins.modes[i] as f64).sqrt() * *power;
                    *power += scatter
                        * match variant.amplitude {
                            Amplitude::Normal => draw(seed, i),
                            // Of the two phases independent.
                            Amplitude::Fixed => fixed * draw(1000 * (1 + variant.phase as usize) + seed, i),
                        };
                }
                let late =
                    Late { matter: bins.late_theory.clone(), halos, count: 100_000, ..Late::default() };
                let early = Early { power: bins.theory.clone(), ..Early::default() };
                measurements.push(Measurement { early, late });
            }
        }
        let configuration = Configuration {
            size: 16,
            length: 1e3,
            fnl: 100.0,
            k_max: 0.09,
            linear_multipoles: Default::default(),
        };
        Suite::new(configuration, (1..=seeds as u64).collect(), bins, measurements).unwrap()
    }

    #[test]
    fn b_g_and_f_nl_that_made_the_spectra_are_found_and_matching_takes_the_scatter() {
        let suite = suite(12, 0.3, 1.0);
        let analysis = Analysis::new(&suite).unwrap();
        assert_eq!(analysis.bins, 6);
        for row in &analysis.rows {
            assert_eq!((row.seeds.len(), row.open()), (12, [0, 0]));
            let matched = row.matched.unwrap();
            assert!((matched.mean - 100.0).abs() < 4.0 * matched.error_of_mean, "{matched:?}");
            assert!(matched.deviation < 0.5 * matched.deviation_first, "{matched:?}");
            let [unmatched, matched] = [0, 1].map(|i| mean(&row.p[i]));
            assert!((matched - 1.0).abs() < 0.2 && (unmatched - 1.0).abs() < 0.6, "{unmatched} {matched}");
            let fit = row.halves[1].mean[Case::Fnl as usize].as_ref().unwrap();
            assert!((fit.second().centre - 100.0).abs() < fit.second().half_width);
            assert!((fit.b_g().centre - 2.5).abs() < 2.0 * fit.b_g().half_width);
            let scatter = mean(&row.differences()) - (mean(&row.fnl[1]) - mean(&row.fnl[0]));
            assert!(scatter.abs() < 1e-9);
        }
        let width = |kind| analysis.row(kind).half_width(1).unwrap();
        assert!(width(Kind::Fixed) < 0.6 * width(Kind::Normal));
        // A pair of fixed has half the variance of one; a pair of Normal is the same thing twice.
        assert!(width(Kind::FixedPaired) < 0.9 * width(Kind::Fixed));
        let open = &analysis.row(Kind::Normal).halves[0].mean;
        assert!(open[Case::Universality as usize].is_none() && open[Case::Fnl as usize].is_some());
    }

    #[test]
    fn open_posteriors_are_counted_and_left_out_of_both_halves() {
        let suite = suite(12, 1.0, 6.0);
        let analysis = Analysis::new(&suite).unwrap();
        let row = analysis.row(Kind::Normal);
        let [gaussian, local] = row.open();
        assert!(gaussian + local > 0);
        assert!(row.seeds.len() <= 12 - gaussian.max(local));
        assert_eq!([row.fnl[0].len(), row.fnl[1].len(), row.p[1].len()], [row.seeds.len(); 3]);
    }

    #[test]
    fn what_cannot_be_fitted_says_why() {
        let few = crate::statistics::tests::suite();
        assert!(Analysis::new(&few).err().unwrap().contains("bins"));
        let still = suite(2, 0.0, 1.0);
        assert!(Analysis::new(&still).err().unwrap().contains("scatter"));
        let phases = Variant { amplitude: Amplitude::Fixed, phase: Phase::Inverted, half: Half::Gaussian };
        assert_eq!(still.get(0, phases).late.halos, still.get(1, phases).late.halos);
    }
}
