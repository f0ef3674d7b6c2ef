//! Statistics at z = 1: means against means, scatter against theory, bias.
//!
//! sigma_th = sqrt(2/N_k) (P + 1/n) (Avila & Adame 2022, Eq. sigma_th), P the mean of the Normal simulations without shot noise, n the number density of
//! halos; matter that began on a lattice has no shot noise. The bias that f_NL adds (Eq. bk, p = 1) is
//! 2 delta_c (b - 1) f_NL/alpha(k).

use std::ops::Range;

use fixpair::variance::bias::DELTA_C;
pub(crate) use fixpair::variance::matched::Estimate;

use crate::measurement::{Bins, Late};
use crate::statistics::{Band, Kind, deviation, error_of_mean, estimates, mean};
use crate::suite::{Amplitude, Half, Phase, Suite, Variant};

/// Fewer halos in a universe have no spectrum worth printing.
const ENOUGH: u64 = 50;

/// Whose spectra.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Tracer {
    Halos,
    Matter,
}

impl Tracer {
    pub(crate) const ALL: [Self; 2] = [Self::Halos, Self::Matter];

    pub(crate) const fn name(self) -> &'static str {
        match self {
            Self::Halos => "halos",
            Self::Matter => "matter",
        }
    }

    pub(crate) fn power(self, late: &Late) -> &[f64] {
        match self {
            Self::Halos => &late.halos,
            Self::Matter => &late.matter,
        }
    }

    pub(crate) fn squeezed(self, late: &Late) -> &[f64] {
        match self {
            Self::Halos => &late.halo_squeezed,
            Self::Matter => &late.matter_squeezed,
        }
    }

    /// Mean 1/n, (Mpc/h)^3.
    pub(crate) fn noise(self, suite: &Suite, half: Half) -> f64 {
        match self {
            Self::Halos => suite.configuration.length.powi(3) / halo_count(suite, half),
            Self::Matter => 0.0,
        }
    }
}

/// Mean number of halos in a universe.
pub(crate) fn halo_count(suite: &Suite, half: Half) -> f64 {
    let variants = || Variant::all().into_iter().filter(move |variant| variant.half == half);
    let counts: Vec<f64> = (0..suite.seeds.len())
        .flat_map(|seed| variants().map(move |variant| suite.get(seed, variant).late.count as f64))
        .collect();
    mean(&counts)
}

/// Whether each universe has enough of them.
pub(crate) fn have_halos(suite: &Suite) -> bool {
    (0..suite.seeds.len())
        .all(|seed| Variant::all().iter().all(|&variant| suite.get(seed, variant).late.count >= ENOUGH))
}

/// Mean of both phases of the Normal simulations, bin by bin.
fn normal_mean(suite: &Suite, tracer: Tracer, half: Half) -> Vec<f64> {
    (0..suite.bins().k.len())
        .map(|i| mean(&estimates(suite, Kind::NormalPaired, half, |one| tracer.power(&one.late)[i])))
        .collect()
}

/// The band of the spectrum of one type of simulation at z = 1.
pub(crate) fn late_band(suite: &Suite, tracer: Tracer, kind: Kind, half: Half) -> Band {
    let noise = tracer.noise(suite, half);
    let theory: Vec<f64> = normal_mean(suite, tracer, half)
        .iter()
        .zip(&suite.bins().modes)
        .map(|(power, &modes)| (power + noise) * (2.0 / modes as f64).sqrt())
        .collect();
    let column = |i: usize| estimates(suite, kind, half, |one| tracer.power(&one.late)[i]);
    Band::new(kind, (0..theory.len()).map(column), &theory)
}

/// Groups of bins that a figure shows as one point: each at least a sixth wider in k than the last.
pub(crate) fn groups(k: &[f64]) -> Vec<Range<usize>> {
    let mut groups: Vec<Range<usize>> = Vec::new();
    for (i, &at) in k.iter().enumerate() {
        match groups.last_mut() {
            Some(last) if at < 1.17 * k[last.start] => last.end = i + 1,
            _ => groups.push(i..i + 1),
        }
    }
    groups
}

/// Mean wavenumber of the modes of a range of bins.
pub(crate) fn mean_k(bins: &Bins, range: &Range<usize>) -> f64 {
    weighted(range, |i| bins.modes[i] as f64, |i| bins.k[i])
}

fn weighted(range: &Range<usize>, weight: impl Fn(usize) -> f64, value: impl Fn(usize) -> f64) -> f64 {
    let sum: f64 = range.clone().map(|i| weight(i) * value(i)).sum();
    sum / range.clone().map(weight).sum::<f64>()
}

/// The amplitude of a spectrum in a range of bins over b^2 times linear theory, with the weights of least variance, for each seed.
fn amplitudes(suite: &Suite, tracer: Tracer, variant: Variant, range: &Range<usize>) -> Vec<f64> {
    let bins = suite.bins();
    let (square, noise) = match tracer {
        Tracer::Halos => (bias(suite).powi(2), tracer.noise(suite, variant.half)),
        Tracer::Matter => (1.0, 0.0),
    };
    let model = |i: usize| square * bins.late_theory[i];
    let weight = |i: usize| bins.modes[i] as f64 * (model(i) / (model(i) + noise)).powi(2);
    (0..suite.seeds.len())
        .map(|seed| {
            let power = tracer.power(&suite.get(seed, variant).late);
            weighted(range, weight, |i| power[i] / model(i))
        })
        .collect()
}

/// sqrt(P_h/P_m) on the largest scales of the Gaussian simulations; 1 without halos.
pub(crate) fn bias(suite: &Suite) -> f64 {
    if !have_halos(suite) {
        return 1.0;
    }
    let bins = suite.bins();
    let [largest, ..] = crate::statistics::ranges(&bins.k);
    let sum = |tracer: Tracer| -> f64 {
        let both = [Kind::NormalPaired, Kind::FixedPaired];
        let power = |i: usize| {
            let of = |kind| mean(&estimates(suite, kind, Half::Gaussian, |one| tracer.power(&one.late)[i]));
            both.map(of).iter().sum::<f64>()
        };
        weighted(&largest, |i| bins.modes[i] as f64 / bins.late_theory[i], power)
    };
    let square = sum(Tracer::Halos) / sum(Tracer::Matter);
    // Noise may win where there are few modes.
    if square > 0.0 { square.sqrt() } else { 1.0 }
}

/// Mean of a variant over that of Normal-Original of the same f_NL, in a range of bins.
pub(crate) fn relative(suite: &Suite, tracer: Tracer, variant: Variant, range: &Range<usize>) -> Estimate {
    let reference = Variant { amplitude: Amplitude::Normal, phase: Phase::Original, half: variant.half };
    let of = |variant| amplitudes(suite, tracer, variant, range);
    quotient(&of(variant), &of(reference), variant.amplitude == Amplitude::Normal)
}

/// Relative standard deviation of one Normal simulation in a range of bins.
pub(crate) fn spread(suite: &Suite, tracer: Tracer, half: Half, range: &Range<usize>) -> f64 {
    let variant = Variant { amplitude: Amplitude::Normal, phase: Phase::Original, half };
    let amplitudes = amplitudes(suite, tracer, variant, range);
    deviation(&amplitudes) / mean(&amplitudes)
}

/// Mean of Inverted over that of Original.
pub(crate) fn inverted(
    suite: &Suite,
    tracer: Tracer,
    amplitude: Amplitude,
    half: Half,
    range: &Range<usize>,
) -> Estimate {
    let of = |phase| amplitudes(suite, tracer, Variant { amplitude, phase, half }, range);
    quotient(&of(Phase::Inverted), &of(Phase::Original), true)
}

/// Mean of P(f_NL) over that of P(0), both phases together, matched seed by seed.
pub(crate) fn response(
    suite: &Suite,
    tracer: Tracer,
    amplitude: Amplitude,
    range: &Range<usize>,
) -> Estimate {
    let of = |half| -> Vec<f64> {
        let [one, two] = [Phase::Original, Phase::Inverted]
            .map(|phase| amplitudes(suite, tracer, Variant { amplitude, phase, half }, range));
        one.iter().zip(two).map(|(one, two)| 0.5 * (one + two)).collect()
    };
    quotient(&of(Half::Local), &of(Half::Gaussian), true)
}

/// Of two means. Samples that share their fluctuations cancel them seed by seed; else their errors add in squares.
fn quotient(above: &[f64], below: &[f64], shared: bool) -> Estimate {
    let (a, b) = (mean(above), mean(below));
    let value = a / b;
    let error = if shared {
        let rest: Vec<f64> =
            above.iter().zip(below).map(|(above, below)| (above - value * below) / b).collect();
        error_of_mean(&rest)
    } else {
        let root = (above.len() as f64).sqrt();
        value.abs() * (deviation(above) / a).hypot(deviation(below) / b) / root
    };
    Estimate { value, error }
}

/// What Eq. bk expects of [`response`] for halos, with p = 1.
pub(crate) fn expected_response(suite: &Suite, range: &Range<usize>) -> f64 {
    let (bins, b) = (suite.bins(), bias(suite));
    let noise = Tracer::Halos.noise(suite, Half::Gaussian);
    let model = |i: usize| b * b * bins.late_theory[i];
    let weight = |i: usize| bins.modes[i] as f64 * (model(i) / (model(i) + noise)).powi(2);
    let shift = |i: usize| 2.0 * DELTA_C * (b - 1.0) * suite.configuration.fnl / bins.late_alpha[i];
    weighted(range, weight, |i| (1.0 + shift(i) / b).powi(2))
}

/// Largest k, in h/Mpc, of the triangles of [`squeezed_amplitude`]: beyond it linear theory says little of z = 1.
pub(crate) const SQUEEZED_REACH: f64 = 0.25;

/// The squeezed bispectrum in units of linear theory for f_NL = 1: a least-squares amplitude over the triangles of the slice.
pub(crate) fn squeezed_amplitude(one: &Late, tracer: Tracer, bins: &Bins) -> f64 {
    let slice = &bins.squeezed;
    // Noise grows with the spectra, as linear theory has it; the unit of sigma cancels.
    let weight = |i: usize| slice.template[i] / slice.sigma[i].powi(2);
    let count = slice.k.partition_point(|&k| k < SQUEEZED_REACH).max(1).min(slice.k.len());
    let sum = |values: &[f64]| -> f64 { (0..count).map(|i| weight(i) * values[i]).sum() };
    sum(tracer.squeezed(one)) / (bins.squeezed_growth * sum(&slice.template))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::statistics::tests::suite;

    #[test]
    fn groups_cover_all_bins_once_and_grow() {
        let k: Vec<f64> = (1..60).map(f64::from).collect();
        let groups = groups(&k);
        assert!(
            groups.windows(2).all(|pair| pair[0].end == pair[1].start && pair[0].len() <= pair[1].len() + 1)
        );
        assert_eq!((groups[0].clone(), groups.last().unwrap().end), (0..1, k.len()));
    }

    #[test]
    fn means_over_means_have_the_errors_of_what_they_do_not_share() {
        let [a, b] = [[1.0, 2.0, 3.0], [2.0, 4.0, 6.0]];
        assert_eq!(quotient(&b, &a, true), Estimate { value: 2.0, error: 0.0 });
        let apart = quotient(&b, &a, false);
        // Both have a relative error of 1/2/sqrt(3).
        assert!((apart.value - 2.0).abs() < 1e-15 && (apart.error - 2.0 / 6f64.sqrt()).abs() < 1e-15);
    }

    #[test]
    fn an_even_fluctuation_cancels_between_phases_and_f_nl_shifts_all() {
        let suite = suite();
        let ratio = inverted(&suite, Tracer::Matter, Amplitude::Normal, Half::Gaussian, &(0..1));
        assert_eq!(ratio, Estimate { value: 1.0, error: 0.0 });
        let shift = response(&suite, Tracer::Matter, Amplitude::Normal, &(1..2));
        assert!((shift.value - 1.4).abs() < 1e-14 && shift.error < 1e-14);
    }

    #[test]
    fn halos_have_their_shot_noise_in_sigma() {
        let suite = suite();
        let [halos, matter] =
            Tracer::ALL.map(|tracer| late_band(&suite, tracer, Kind::Normal, Half::Gaussian).ratio[0]);
        // 1/n = V/100 = 0.01 beside P = 10.625.
        assert!((matter / halos - (10.625 + 0.01) / 10.625).abs() < 1e-12);
    }
}
