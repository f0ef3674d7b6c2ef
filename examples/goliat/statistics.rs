//! Scatter from seed to seed: of each type of simulation, of pairs, and of matched differences.
//!
//! Per simulation throughout: a pair costs two simulations, so its sigma is sqrt(2) times the standard deviation over
//! pairs (Avila & Adame 2022, Eq. sigma_paired), and a simulation is worth (sigma_ref/sigma)^2 of the reference.
//! sigma_th = sqrt(2/N_k) P with N_k counting k and -k (Eq. sigma_th, without shot noise).

use std::ops::Range;

use fixpair::status::Result;
use fixpair::variance::matched::matched_difference;
use fixpair::variance::pairs::pair_average;

use crate::measurement::{Bins, Measurement};
use crate::suite::{Amplitude, Half, Phase, Suite, Variant};

/// Below this ratio to `sigma_th` a scatter is the rounding of sums: the estimate is exact.
pub(crate) const ROUNDING: f64 = 1e-6;

/// What one runs to estimate something once: a simulation, or a pair of inverted ones.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    Normal,
    NormalPaired,
    Fixed,
    FixedPaired,
}

impl Kind {
    pub(crate) const ALL: [Self; 4] = [Self::Normal, Self::NormalPaired, Self::Fixed, Self::FixedPaired];

    pub(crate) const fn name(self) -> &'static str {
        match self {
            Self::Normal => "Normal",
            Self::NormalPaired => "Normal-Paired",
            Self::Fixed => "Fixed",
            Self::FixedPaired => "Fixed-Paired",
        }
    }

    pub(crate) const fn amplitude(self) -> Amplitude {
        match self {
            Self::Normal | Self::NormalPaired => Amplitude::Normal,
            Self::Fixed | Self::FixedPaired => Amplitude::Fixed,
        }
    }

    /// Simulations that one estimate costs.
    pub(crate) const fn simulations(self) -> u64 {
        match self {
            Self::Normal | Self::Fixed => 1,
            Self::NormalPaired | Self::FixedPaired => 2,
        }
    }

    /// Standard deviation per simulation: that of the estimates, times the root of what one costs.
    pub(crate) fn sigma(self, estimates: &[f64]) -> f64 {
        (self.simulations() as f64).sqrt() * deviation(estimates)
    }
}

pub(crate) fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// Standard deviation with N - 1; zero for fewer than two values.
pub(crate) fn deviation(values: &[f64]) -> f64 {
    let centre = mean(values);
    let sum: f64 = values.iter().map(|value| (value - centre).powi(2)).sum();
    (sum / (values.len().max(2) - 1) as f64).sqrt()
}

/// Standard error of the mean.
pub(crate) fn error_of_mean(values: &[f64]) -> f64 {
    deviation(values) / (values.len() as f64).sqrt()
}

/// Correlation coefficient; none where one of the two varies by no more than the rounding of the numbers at hand.
pub(crate) fn correlation(a: &[f64], b: &[f64]) -> Option<f64> {
    // A thousand times the rounding of f64 sums of a million terms.
    const STILL: f64 = 1e-10;
    let (centre_a, centre_b) = (mean(a), mean(b));
    let (sigma_a, sigma_b) = (deviation(a), deviation(b));
    let scale = [centre_a.abs(), centre_b.abs(), sigma_a, sigma_b].into_iter().fold(0.0, f64::max);
    if sigma_a <= STILL * scale || sigma_b <= STILL * scale {
        return None;
    }
    matched_difference(a, b).ok().map(|difference| difference.correlation)
}

/// One estimate for each seed: of the original, or the average of the pair.
pub(crate) fn estimates(
    suite: &Suite,
    kind: Kind,
    half: Half,
    quantity: impl Fn(&Measurement) -> f64,
) -> Vec<f64> {
    let value = |seed, phase| quantity(suite.get(seed, Variant { amplitude: kind.amplitude(), phase, half }));
    (0..suite.seeds.len())
        .map(|seed| match kind {
            Kind::Normal | Kind::Fixed => value(seed, Phase::Original),
            Kind::NormalPaired | Kind::FixedPaired => {
                0.5 * (value(seed, Phase::Original) + value(seed, Phase::Inverted))
            }
        })
        .collect()
}

/// One spectrum for each seed: of the original, or the average of the pair (Eq. pair).
pub(crate) fn spectra(
    suite: &Suite,
    kind: Kind,
    half: Half,
    quantity: impl Fn(&Measurement) -> &[f64],
) -> Result<Vec<Vec<f64>>> {
    let spectrum =
        |seed, phase| quantity(suite.get(seed, Variant { amplitude: kind.amplitude(), phase, half }));
    let of = |seed| {
        let original = spectrum(seed, Phase::Original);
        let mut spectra = original.to_vec();
        if kind.simulations() == 2 {
            pair_average(&mut spectra, original, spectrum(seed, Phase::Inverted))?;
        }
        Ok(spectra)
    };
    (0..suite.seeds.len()).map(of).collect()
}

/// Mean and scatter of the squeezed bispectrum of one type of simulation, triangle by triangle; its ratio is to sigma in a Gaussian field.
pub(crate) fn squeezed_band(suite: &Suite, kind: Kind, half: Half) -> Band {
    let sigma = &suite.bins().squeezed.sigma;
    let column = |i: usize| estimates(suite, kind, half, |one| one.early.squeezed[i]);
    Band::new(kind, (0..sigma.len()).map(column), sigma)
}

/// f_NL minus Gaussian: of the same seed (matched), or of one seed and the next (not matched).
pub(crate) fn differences(local: &[f64], gaussian: &[f64], matched: bool) -> Vec<f64> {
    let shift = usize::from(!matched);
    let partner = gaussian.iter().cycle().skip(shift);
    local.iter().zip(partner).map(|(local, gaussian)| local - gaussian).collect()
}

/// Mean and scatter of a spectrum, bin by bin.
pub(crate) struct Band {
    pub(crate) mean: Vec<f64>,
    /// Standard deviation of the estimates, in the unit of the spectrum.
    pub(crate) deviation: Vec<f64>,
    /// sigma/sigma_th per simulation.
    pub(crate) ratio: Vec<f64>,
}

impl Band {
    pub(crate) fn new(kind: Kind, columns: impl Iterator<Item = Vec<f64>>, theory: &[f64]) -> Self {
        let columns: Vec<_> = columns.collect();
        Self {
            mean: columns.iter().map(|column| mean(column)).collect(),
            deviation: columns.iter().map(|column| deviation(column)).collect(),
            ratio: columns.iter().zip(theory).map(|(column, theory)| kind.sigma(column) / theory).collect(),
        }
    }
}

/// sqrt(2/N_k) P for each bin.
pub(crate) fn sigma_theory(bins: &Bins) -> Vec<f64> {
    bins.theory.iter().zip(&bins.modes).map(|(power, &modes)| power * (2.0 / modes as f64).sqrt()).collect()
}

/// The band of the power spectrum of one type of simulation.
pub(crate) fn band(suite: &Suite, kind: Kind, half: Half) -> Band {
    let theory = sigma_theory(suite.bins());
    let column = |i: usize| estimates(suite, kind, half, |one| one.early.power[i]);
    Band::new(kind, (0..theory.len()).map(column), &theory)
}

/// The scatter of P(f_NL) - P(0), bin by bin.
pub(crate) struct Difference {
    /// sigma/sigma_th per simulation, where a simulation of both halves counts as one.
    pub(crate) ratio: Vec<f64>,
    /// Correlation of the two halves.
    pub(crate) correlation: Vec<Option<f64>>,
}

/// The difference of the two halves for one type of simulation.
pub(crate) fn power_difference(suite: &Suite, kind: Kind, matched: bool) -> Difference {
    let theory = sigma_theory(suite.bins());
    let (mut ratio, mut rho) = (Vec::new(), Vec::new());
    for (i, theory) in theory.iter().enumerate() {
        let [local, gaussian] =
            [Half::Local, Half::Gaussian].map(|half| estimates(suite, kind, half, |one| one.early.power[i]));
        ratio.push(kind.sigma(&differences(&local, &gaussian, matched)) / theory);
        rho.push(if matched { correlation(&local, &gaussian) } else { None });
    }
    Difference { ratio, correlation: rho }
}

/// Three ranges of bins, of equal width in log k as far as bins allow, none of them empty.
pub(crate) fn ranges(k: &[f64]) -> [Range<usize>; 3] {
    let count = k.len();
    let (Some(first), Some(last)) = (k.first(), k.last()) else {
        return [0..0, 0..0, 0..0];
    };
    let edge = |third: f64| {
        let limit = first * (last / first).powf(third / 3.0);
        k.partition_point(|&k| k <= limit)
    };
    let low = edge(1.0).clamp(1.min(count), count.saturating_sub(2).max(1));
    let high = edge(2.0).clamp((low + 1).min(count), count.saturating_sub(1).max(low));
    [0..low, low..high, high..count]
}

/// Root mean square over a range of bins: the scatter averages as a variance.
pub(crate) fn quadratic_mean(values: &[f64]) -> f64 {
    mean(&values.iter().map(|value| value * value).collect::<Vec<_>>()).sqrt()
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::measurement::{Early, Late};
    use crate::suite::Configuration;

    /// Two bins; the power at both times of seed s is 10 + d(s) with the sign of the phase on an odd part, halved if fixed.
    pub(crate) fn suite() -> Suite {
        let draws = [1.0, -2.0, 0.5, 3.0];
        let mut measurements = Vec::new();
        for draw in draws {
            for variant in Variant::all() {
                let size = if variant.amplitude == Amplitude::Fixed { 0.5 } else { 1.0 };
                let sign = if variant.phase == Phase::Inverted { -1.0 } else { 1.0 };
                let shift = if variant.half == Half::Local { 4.0 } else { 0.0 };
                let power = vec![10.0 + size * draw + shift, 10.0 + sign * draw + shift];
                let late =
                    Late { matter: power.clone(), halos: power.clone(), count: 100, ..Late::default() };
                let early = Early { power, fnl: shift * 25.0 + sign * draw, ..Early::default() };
                measurements.push(Measurement { early, late });
            }
        }
        let configuration = Configuration {
            size: 16,
            length: 1.0,
            fnl: 100.0,
            k_max: 0.09,
            linear_multipoles: Default::default(),
        };
        let bins = Bins {
            k: vec![0.1, 0.2],
            modes: vec![8, 200],
            theory: vec![10.0; 2],
            late_theory: vec![10.0; 2],
            late_alpha: vec![1e3; 2],
            squeezed_growth: 1.0,
            ..Bins::default()
        };
        Suite::new(configuration, (1..=4).collect(), bins, measurements).unwrap()
    }

    #[test]
    fn moments_are_those_of_the_textbook() {
        let values = [2.0, 4.0, 4.0, 4.0, 5.0, 5.0, 7.0, 9.0];
        assert_eq!(mean(&values), 5.0);
        assert!((deviation(&values) - (32.0f64 / 7.0).sqrt()).abs() < 1e-15);
        assert_eq!(deviation(&[3.0]), 0.0);
        let opposite = values.map(|value| -2.0 * value);
        assert!((correlation(&values, &opposite).unwrap() + 1.0).abs() < 1e-15);
        assert_eq!(correlation(&values, &[1.0; 8]), None);
        assert_eq!(correlation(&values, &values.map(|value| 1e-15 * value)), None);
    }

    #[test]
    fn sigma_theory_is_sqrt_two_over_modes_times_power() {
        assert_eq!(sigma_theory(suite().bins()), [5.0, 1.0]);
    }

    #[test]
    fn pairing_costs_sqrt2_for_an_even_quantity_and_removes_an_odd_one() {
        let suite = suite();
        let [normal, paired, fixed] =
            [Kind::Normal, Kind::NormalPaired, Kind::Fixed].map(|kind| band(&suite, kind, Half::Gaussian));
        assert!((paired.ratio[0] / normal.ratio[0] - 2f64.sqrt()).abs() < 1e-14);
        assert_eq!(paired.ratio[1], 0.0);
        assert!((fixed.ratio[0] / normal.ratio[0] - 0.5).abs() < 1e-14);
        assert_eq!(paired.mean[1], 10.0);
    }

    #[test]
    fn matched_difference_has_only_the_signal_and_the_unmatched_one_both_scatters() {
        let suite = suite();
        let matched = power_difference(&suite, Kind::Normal, true);
        assert_eq!((matched.ratio[0], matched.ratio[1]), (0.0, 0.0));
        assert!((matched.correlation[0].unwrap() - 1.0).abs() < 1e-14);
        let other = power_difference(&suite, Kind::Normal, false);
        assert!(other.ratio[0] > band(&suite, Kind::Normal, Half::Local).ratio[0]);
        assert_eq!(differences(&[1.0, 2.0, 3.0], &[10.0, 20.0, 30.0], false), [-19.0, -28.0, -7.0]);
    }

    #[test]
    fn ranges_cover_all_bins_once_and_none_is_empty() {
        for count in 3..60 {
            let k: Vec<f64> = (1..=count).map(f64::from).collect();
            let [low, middle, high] = ranges(&k);
            assert_eq!((low.start, low.end, middle.end, high.end), (0, middle.start, high.start, k.len()));
            assert!(!low.is_empty() && !middle.is_empty() && !high.is_empty(), "{count}");
        }
    }

    #[test]
    fn a_suite_with_a_broken_number_is_refused() {
        let suite = suite();
        let mut measurements = suite.measurements_for_test();
        measurements[3].early.power[0] = f64::NAN;
        let bins = suite.bins().clone();
        assert!(Suite::new(suite.configuration, suite.seeds, bins, measurements).is_err());
    }
}
