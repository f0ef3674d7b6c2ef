//! chi^2 from 36 numbers against the sum over bins.

use std::vec;
use std::vec::Vec;

use super::{Draws, relative};
use crate::reference::variance as twin;
use crate::status::Error;
use crate::variance::bias::{Bias, DELTA_C, Spectrum};
use crate::variance::likelihood::*;

/// Bins of 1 Gpc/h at z = 1, k = k_f to 14 k_f, or so.
pub(super) struct Data {
    pub(super) power: Vec<f64>,
    pub(super) linear: Vec<f64>,
    pub(super) alpha: Vec<f64>,
    pub(super) sigma: Vec<f64>,
}

impl Data {
    /// Without noise; sigma is `scatter` of a Gaussian field's.
    pub(super) fn exact(truth: &Bias, spectrum: Spectrum, scatter: f64) -> Self {
        let mut new = Self { power: vec![], linear: vec![], alpha: vec![], sigma: vec![] };
        for i in 1..=14 {
            let k = f64::from(i) * core::f64::consts::TAU / 1000.0;
            let linear = 2e4 * (k / 0.016) / (1.0 + (k / 0.016).powf(1.2)).powf(1.9);
            let alpha = 1.05e7 * k * k / (1.0 + (k / 0.05).powf(1.5));
            let power = twin::model(truth, spectrum, linear, alpha);
            let modes = 4.0 * core::f64::consts::PI * f64::from(i * i);
            new.power.push(power);
            new.linear.push(linear);
            new.alpha.push(alpha);
            new.sigma.push(scatter * (2.0 / modes).sqrt() * (power.abs() + 4e3));
        }
        new
    }

    pub(super) fn noisy(truth: &Bias, spectrum: Spectrum, scatter: f64, draws: &mut Draws) -> Self {
        let mut new = Self::exact(truth, spectrum, scatter);
        new.power.iter_mut().zip(&new.sigma).for_each(|(power, sigma)| *power += sigma * draws.normal());
        new
    }

    pub(super) fn spectra(&self) -> Spectra<'_> {
        Spectra { power: &self.power, linear: &self.linear, alpha: &self.alpha }
    }

    pub(super) fn likelihood(&self, spectrum: Spectrum) -> BiasLikelihood {
        let mut likelihood = BiasLikelihood::EMPTY;
        likelihood.add(spectrum, self.spectra(), &self.sigma).unwrap();
        likelihood
    }

    pub(super) fn model(&self, at: &Bias, spectrum: Spectrum) -> Vec<f64> {
        let bins = self.linear.iter().zip(&self.alpha);
        bins.map(|(linear, alpha)| twin::model(at, spectrum, *linear, *alpha)).collect()
    }
}

pub(super) const TRUTH: Bias = Bias { b_g: 2.32, p: 1.0, f_nl: 100.0, delta_c: DELTA_C };
const BOTH: [Spectrum; 2] = [Spectrum::HaloHalo, Spectrum::HaloMatter];

fn anywhere(draws: &mut Draws) -> Bias {
    Bias { b_g: 0.5 + 4.0 * draws.unit(), p: 1.0 + draws.normal(), f_nl: 300.0 * draws.normal(), ..TRUTH }
}

#[test]
fn chi_squared_is_the_sum_over_bins() {
    let mut draws = Draws::of(71);
    for spectrum in BOTH {
        let data = Data::noisy(&TRUTH, spectrum, 1.0, &mut draws);
        let likelihood = data.likelihood(spectrum);
        assert_eq!(likelihood.bins, 14);
        for _ in 0..200 {
            let at = anywhere(&mut draws);
            let expected = twin::chi_squared(&data.power, &data.model(&at, spectrum), &data.sigma);
            assert!(relative(likelihood.chi_squared(&at).unwrap(), expected) < 1e-12);
        }
    }
}

#[test]
fn independent_spectra_add_and_their_order_is_only_rounding() {
    let mut draws = Draws::of(72);
    let [halo, matter] = BOTH.map(|spectrum| Data::noisy(&TRUTH, spectrum, 1.0, &mut draws));
    let mut together = halo.likelihood(Spectrum::HaloHalo);
    together.add(Spectrum::HaloMatter, matter.spectra(), &matter.sigma).unwrap();
    let mut merged = matter.likelihood(Spectrum::HaloMatter);
    merged.merge(&halo.likelihood(Spectrum::HaloHalo)).unwrap();
    // Bin by bin, the last first.
    let mut turned = BiasLikelihood::EMPTY;
    for (data, spectrum) in [(&matter, Spectrum::HaloMatter), (&halo, Spectrum::HaloHalo)] {
        for i in (0..14).rev() {
            let one =
                Spectra { power: &data.power[i..=i], linear: &data.linear[i..=i], alpha: &data.alpha[i..=i] };
            turned.add(spectrum, one, &data.sigma[i..=i]).unwrap();
        }
    }
    for _ in 0..100 {
        let at = anywhere(&mut draws);
        let expected = BOTH
            .into_iter()
            .zip([&halo, &matter])
            .map(|(spectrum, data)| twin::chi_squared(&data.power, &data.model(&at, spectrum), &data.sigma))
            .sum::<f64>();
        for likelihood in [&together, &merged, &turned] {
            assert_eq!(likelihood.bins, 28);
            assert!(relative(likelihood.chi_squared(&at).unwrap(), expected) < 1e-12);
        }
    }
    let mut with_none = together;
    with_none.merge(&BiasLikelihood::EMPTY).unwrap();
    assert_eq!(with_none, together);
    assert_eq!(BiasLikelihood::EMPTY.chi_squared(&TRUTH), Ok(0.0));
}

#[test]
fn exact_data_leave_roundings() {
    for spectrum in BOTH {
        let data = Data::exact(&TRUTH, spectrum, 1.0);
        let least = data.likelihood(spectrum).chi_squared(&TRUTH).unwrap();
        let signal: f64 =
            data.power.iter().zip(&data.sigma).map(|(power, sigma)| (power / sigma).powi(2)).sum();
        assert!((0.0..1e-28 * signal).contains(&least), "{least}");
    }
}

#[test]
fn chi_squared_keeps_its_digits_at_a_signal_to_noise_of_1e8() {
    let mut draws = Draws::of(73);
    let scatter = 1e-8;
    let data = Data::noisy(&TRUTH, Spectrum::HaloHalo, scatter, &mut draws);
    let found = data.likelihood(Spectrum::HaloHalo).chi_squared(&TRUTH).unwrap();
    let expected = twin::chi_squared(&data.power, &data.model(&TRUTH, Spectrum::HaloHalo), &data.sigma);
    // Residuals of 1e-8 of the data have 8 digits in both; the terms of an expanded square, of 1e17, would have none.
    assert!(relative(found, expected) < 1e-6, "{found} {expected}");
    assert!((1.0..60.0).contains(&found));
}

#[test]
fn chi_squared_is_never_negative() {
    let mut draws = Draws::of(74);
    for scatter in [1.0, 1e-4, 1e-8, 1e-12] {
        let data = Data::exact(&TRUTH, Spectrum::HaloHalo, scatter);
        let likelihood = data.likelihood(Spectrum::HaloHalo);
        for _ in 0..200 {
            let near = Bias { b_g: TRUTH.b_g * (1.0 + 1e-15 * draws.normal()), ..TRUTH };
            assert!(likelihood.chi_squared(&near).unwrap() >= 0.0);
        }
    }
}

#[cfg(feature = "linalg")]
mod correlated {
    use super::*;
    use crate::reference::built::Memory;
    use crate::variance::covariance::{covariance_root, covariance_root_scratch};

    fn root_of(covariance: &[f64], values: usize) -> Vec<f64> {
        let mut root = vec![f64::NAN; values * values];
        let mut memory = Memory::new(covariance_root_scratch(values).unwrap());
        covariance_root(&mut root, covariance, values, memory.get()).unwrap();
        root
    }

    fn add(
        halo_halo: usize,
        spectra: Spectra<'_>,
        root: &[f64],
        precision: f64,
    ) -> crate::status::Result<BiasLikelihood> {
        let mut likelihood = BiasLikelihood::EMPTY;
        let mut memory = Memory::new(add_correlated_scratch(spectra.power.len()).unwrap());
        let answer = likelihood.add_correlated(halo_halo, spectra, root, precision, memory.get());
        assert!(answer.is_ok() || likelihood == BiasLikelihood::EMPTY);
        answer.map(|()| likelihood)
    }

    /// P_hh and P_hm of the same halos, 28 bins, and a covariance of which all elements matter.
    fn joint(draws: &mut Draws) -> (Data, Vec<f64>) {
        let mut both = Data::noisy(&TRUTH, Spectrum::HaloHalo, 1.0, draws);
        let matter = Data::noisy(&TRUTH, Spectrum::HaloMatter, 1.0, draws);
        both.power.extend(matter.power);
        both.linear.extend(matter.linear);
        both.alpha.extend(matter.alpha);
        both.sigma.extend(matter.sigma);
        let rows: Vec<f64> = (0..200)
            .flat_map(|_| {
                let common = draws.normal();
                let x: Vec<f64> = (0..14).map(|_| draws.normal()).collect();
                (0..28)
                    .map(|i| both.sigma[i] * (0.3 * common + 0.6 * x[i % 14] + 0.7 * draws.normal()))
                    .collect::<Vec<f64>>()
            })
            .collect();
        let covariance = twin::covariance(&rows, 28);
        (both, covariance)
    }

    fn joint_model(data: &Data, at: &Bias) -> Vec<f64> {
        let [halo, matter] = BOTH.map(|spectrum| data.model(at, spectrum));
        [&halo[..14], &matter[14..]].concat()
    }

    #[test]
    fn chi_squared_is_that_of_the_inverse_covariance() {
        let mut draws = Draws::of(75);
        let (data, covariance) = joint(&mut draws);
        let root = root_of(&covariance, 28);
        for precision in [1.0, 0.625] {
            let likelihood = add(14, data.spectra(), &root, precision).unwrap();
            assert_eq!(likelihood.bins, 28);
            for _ in 0..100 {
                let at = anywhere(&mut draws);
                let expected = twin::chi_squared_full(&data.power, &joint_model(&data, &at), &covariance);
                // The condition of the correlation matrix, of order 100.
                assert!(relative(likelihood.chi_squared(&at).unwrap(), precision * expected) < 1e-11);
            }
        }
    }

    #[test]
    fn a_diagonal_covariance_is_sigma() {
        let mut draws = Draws::of(76);
        for (spectrum, halo_halo) in [(Spectrum::HaloHalo, 14), (Spectrum::HaloMatter, 0)] {
            let data = Data::noisy(&TRUTH, spectrum, 1.0, &mut draws);
            let covariance: Vec<f64> = (0..196)
                .map(|at| if at % 15 == 0 { data.sigma[at / 15] * data.sigma[at / 15] } else { 0.0 })
                .collect();
            let full = add(halo_halo, data.spectra(), &root_of(&covariance, 14), 1.0).unwrap();
            let diagonal = data.likelihood(spectrum);
            for _ in 0..50 {
                let at = anywhere(&mut draws);
                let [a, b] = [full, diagonal].map(|likelihood| likelihood.chi_squared(&at).unwrap());
                assert!(relative(a, b) < 1e-12);
            }
        }
    }

    #[test]
    fn the_root_times_itself_is_the_covariance_whatever_the_units() {
        let mut draws = Draws::of(77);
        for values in [1, 2, 7, 33] {
            let rows: Vec<f64> = (0..values * (values + 20))
                .map(|at| 10_f64.powi((at % values) as i32 * 4 - 60) * draws.normal())
                .collect();
            let covariance = twin::covariance(&rows, values);
            let root = root_of(&covariance, values);
            let back = twin::product(&root, &twin::transpose(&root, values), values);
            for at in 0..values * values {
                let (i, j) = (at / values, at % values);
                let scale = (covariance[i * values + i] * covariance[j * values + j]).sqrt();
                assert!((back[at] - covariance[at]).abs() < 1e-14 * scale);
                assert!(j <= i || root[at] == 0.0);
            }
        }
    }

    #[test]
    fn a_covariance_of_fewer_samples_than_values_is_singular() {
        let mut draws = Draws::of(78);
        for values in [2, 5, 14, 40] {
            let rows: Vec<f64> = (0..values * values).map(|_| draws.normal()).collect();
            let covariance = twin::covariance(&rows, values);
            let mut root = vec![7.0; values * values];
            let mut memory = Memory::new(covariance_root_scratch(values).unwrap());
            let answer = covariance_root(&mut root, &covariance, values, memory.get());
            assert_eq!(answer, Err(Error::Singular), "{values} samples");
            assert!(root.iter().all(|&x| x == 7.0));
        }
    }

    #[test]
    fn matrices_that_are_no_covariance_are_refused() {
        let mut root = [7.0; 4];
        let mut memory = Memory::new(covariance_root_scratch(2).unwrap());
        let mut refused =
            |covariance: &[f64]| covariance_root(&mut root, covariance, 2, memory.get()).unwrap_err();
        assert_eq!(refused(&[1.0, 0.5, 0.4, 1.0]), Error::Range);
        assert_eq!(refused(&[1.0, 1.5, 1.5, 1.0]), Error::Singular);
        assert_eq!(refused(&[1.0, 0.0, 0.0, 0.0]), Error::Singular);
        assert_eq!(refused(&[-1.0, 0.0, 0.0, 1.0]), Error::Singular);
        assert_eq!(refused(&[1.0, f64::NAN, 0.0, 1.0]), Error::NotFinite);
        assert_eq!(refused(&[1.0; 3]), Error::Length);
        let mut short = Memory::new(covariance_root_scratch(1).unwrap());
        let little = &mut short.get()[..64];
        assert_eq!(covariance_root(&mut root, &[1.0, 0.0, 0.0, 1.0], 2, little), Err(Error::Scratch));
        assert_eq!(root, [7.0; 4]);
        assert_eq!(covariance_root_scratch(usize::MAX), Err(Error::Overflow));
    }

    #[test]
    fn roots_that_are_none_are_refused() {
        let data = Data::exact(&TRUTH, Spectrum::HaloHalo, 1.0);
        let identity: Vec<f64> = (0..196).map(|at| f64::from(u8::from(at % 15 == 0))).collect();
        let refused =
            |halo_halo, root: &[f64], precision| add(halo_halo, data.spectra(), root, precision).unwrap_err();
        assert_eq!(refused(15, &identity, 1.0), Error::Range);
        assert_eq!(refused(14, &identity, 0.0), Error::Range);
        assert_eq!(refused(14, &identity, f64::NAN), Error::NotFinite);
        assert_eq!(refused(14, &identity[1..], 1.0), Error::Length);
        for (value, error) in [(0.0, Error::Singular), (-1.0, Error::Singular), (f64::NAN, Error::NotFinite)]
        {
            let mut root = identity.clone();
            root[13 * 15] = value;
            assert_eq!(refused(14, &root, 1.0), error);
        }
        let mut likelihood = BiasLikelihood::EMPTY;
        let answer = likelihood.add_correlated(14, data.spectra(), &identity, 1.0, &mut []);
        assert_eq!(answer, Err(Error::Scratch));
        assert_eq!(add_correlated_scratch(usize::MAX), Err(Error::Overflow));
    }
}

#[test]
fn data_that_are_none_are_refused_and_leave_the_likelihood() {
    let data = Data::exact(&TRUTH, Spectrum::HaloHalo, 1.0);
    let mut likelihood = data.likelihood(Spectrum::HaloHalo);
    let before = likelihood;
    let with = |of: &[f64], value: f64| {
        let mut values = of.to_vec();
        values[3] = value;
        values
    };
    for spectrum in BOTH {
        let mut refused =
            |spectra: Spectra<'_>, sigma: &[f64]| likelihood.add(spectrum, spectra, sigma).unwrap_err();
        let good = data.spectra();
        for value in [0.0, -1.0] {
            assert_eq!(refused(good, &with(&data.sigma, value)), Error::Range);
            assert_eq!(
                refused(Spectra { alpha: &with(&data.alpha, value), ..good }, &data.sigma),
                Error::Range
            );
            assert_eq!(
                refused(Spectra { linear: &with(&data.linear, value), ..good }, &data.sigma),
                Error::Range
            );
        }
        let nan = with(&data.power, f64::NAN);
        assert_eq!(refused(Spectra { power: &nan, ..good }, &data.sigma), Error::NotFinite);
        assert_eq!(refused(good, &with(&data.sigma, f64::INFINITY)), Error::NotFinite);
        assert_eq!(refused(good, &data.sigma[1..]), Error::Length);
        assert_eq!(refused(Spectra { alpha: &data.alpha[1..], ..good }, &data.sigma), Error::Length);
        assert_eq!(refused(good, &with(&data.sigma, 1e-306)), Error::Range);
    }
    for (value, error) in [(f64::NAN, Error::NotFinite), (1.0, Error::Range)] {
        let mut wrong = before;
        wrong.root[3][1] = value;
        assert_eq!(likelihood.merge(&wrong), Err(error));
        assert_eq!(wrong.chi_squared(&TRUTH), Err(error));
    }
    assert_eq!(likelihood, before);
    assert_eq!(likelihood.chi_squared(&Bias { f_nl: f64::NAN, ..TRUTH }), Err(Error::NotFinite));
    assert_eq!(likelihood.chi_squared(&Bias { delta_c: -1.0, ..TRUTH }), Err(Error::Range));
    assert_eq!(likelihood.chi_squared(&Bias { f_nl: 1e200, ..TRUTH }), Err(Error::Range));
}
