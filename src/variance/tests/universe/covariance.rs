//! The chain with a covariance that was measured from 100 mocks, and what that costs (Hartlap et al. 2007, Percival et al. 2014).

use std::vec;
use std::vec::Vec;

use super::LIMIT;
use super::chain::{REGION, constrain, memory};
use super::draws::Normals;
use super::sky::{B_G, F_NL, Kind, Sky};
use crate::reference::built::Memory;
use crate::variance::covariance::{covariance_root, covariance_root_scratch};
use crate::variance::ensemble::{Moments, ensemble_add, ensemble_covariance, ensemble_init, ensemble_length};
use crate::variance::levels::{delta_chi_squared, hartlap_factor, percival_factor};
use crate::variance::likelihood::{BiasLikelihood, add_correlated_scratch};

/// Mocks of each covariance.
const MOCKS: u64 = 100;
const REALISATIONS: u32 = 2000;
/// The universe of f_NL = 100.
const UNIVERSE: usize = 1;

/// A Fixed spectrum whose neighbouring bins share scatter, so that the covariance is not diagonal: rho = 0.48.
fn draw(sky: &Sky, sigma: &[f64], normals: &mut Normals) -> Vec<f64> {
    let mut last = normals.next();
    (sky.power[UNIVERSE].iter().zip(sigma))
        .map(|(mean, sigma)| {
            let next = normals.next();
            let x = 0.8 * next + 0.6 * last;
            last = next;
            mean + sigma * x
        })
        .collect()
}

#[test]
fn a_measured_covariance_covers_68_per_cent_with_its_factors_and_fewer_without() {
    let sky = Sky::paper();
    let sigma = sky.sigma(Kind::Fixed, UNIVERSE);
    let bins = sky.k.len();
    let mut state = vec![0.0; ensemble_length(bins, Moments::Covariance).unwrap()];
    let (mut covariance, mut root) = (vec![0.0; bins * bins], vec![0.0; bins * bins]);
    let mut for_root = Memory::new(covariance_root_scratch(bins).unwrap());
    let mut for_sum = Memory::new(add_correlated_scratch(bins).unwrap());
    let mut for_grid = memory();
    let hartlap = hartlap_factor(MOCKS, bins as u64).unwrap();
    let percival = percival_factor(MOCKS, bins as u64, 2).unwrap();

    // Of (b_g, f_NL): how often the truth is inside.
    let (mut with, mut without) = ([0_u32; 2], [0_u32; 2]);
    for realisation in 0..REALISATIONS {
        let mut normals = Normals::new(realisation, 1);
        ensemble_init(&mut state, bins, Moments::Covariance).unwrap();
        for _ in 0..MOCKS {
            ensemble_add(&mut state, &draw(&sky, &sigma, &mut normals)).unwrap();
        }
        ensemble_covariance(&mut covariance, &state, 0..bins, 0..bins).unwrap();
        covariance_root(&mut root, &covariance, bins, for_root.get()).unwrap();
        let data = draw(&sky, &sigma, &mut normals);
        for (precision, widening, count) in [(hartlap, percival.sqrt(), &mut with), (1.0, 1.0, &mut without)]
        {
            let mut likelihood = BiasLikelihood::EMPTY;
            likelihood.add_correlated(bins, sky.spectra(&data), &root, precision, for_sum.get()).unwrap();
            let found = constrain(&likelihood, &mut for_grid).posterior;
            for (axis, truth) in [B_G, F_NL[UNIVERSE]].into_iter().enumerate() {
                let inside = (found[axis].centre - truth).abs() <= widening * found[axis].half_width;
                count[axis] += u32::from(inside);
            }
        }
    }
    // Regions that are too narrow by sqrt(hartlap/percival): 0.89, and 62%.
    let within = (delta_chi_squared(REGION, 1).unwrap() * hartlap / percival).sqrt();
    let narrow = libm::erf(within * core::f64::consts::FRAC_1_SQRT_2);
    let error = (REGION * (1.0 - REGION) / f64::from(REALISATIONS)).sqrt();
    for axis in 0..2 {
        let [with, without] = [with, without].map(|count| f64::from(count[axis]) / f64::from(REALISATIONS));
        assert!((with - REGION).abs() < LIMIT * error, "{axis}: {with}");
        assert!(without < REGION - LIMIT * error, "{axis}: {without}");
        assert!((without - narrow).abs() < LIMIT * error, "{axis}: {without} for {narrow}");
    }
}
