use std::vec;
use std::vec::Vec;

use super::*;
use crate::cosmology::{Ratio, Species, growth, mode_table_length, species_table};
use crate::exec::{Serial, Threads};
use crate::status::Error;

/// k, and of total matter, cold matter and baryons T, T, T, then V of the latter two, all at z = 32, and T of total matter at z = 0: CAMB.
fn camb_species() -> Vec<Vec<f64>> {
    columns(include_str!("../../../examples/data/camb_goliat_species.txt"))
}

const RATIOS: [Ratio; 3] = [Ratio::Matter, Ratio::Density, Ratio::Velocity];

fn table(species: &Species<'_>, ratio: Ratio, n: usize, box_size: f64) -> Vec<f64> {
    let mut out = vec![f64::NAN; mode_table_length(n).unwrap()];
    species_table(&Serial, species, ratio, n, box_size, &mut out).unwrap();
    out
}

#[test]
fn ratios_of_power_laws_are_exact() {
    let k: Vec<f64> = (0..20).map(|i| 1e-3 * 1.5_f64.powi(i)).collect();
    let law = |amplitude: f64, slope: f64| k.iter().map(|k| amplitude * k.powf(slope)).collect::<Vec<f64>>();
    let columns = [law(3.0, -1.0), law(2.0, -1.5), law(7.0, -0.5), law(5.0, 0.25)];
    let [matter, density, velocity, reference] = columns.each_ref().map(Vec::as_slice);
    let species = Species::new(&k, matter, density, velocity, Some(reference)).unwrap();
    let (n, box_size) = (32, 500.0);
    let unit = core::f64::consts::TAU / box_size;
    for (ratio, amplitude, slope) in [
        (Ratio::Matter, 3.0 / 5.0, -1.25),
        (Ratio::Density, 2.0 / 3.0, -0.5),
        (Ratio::Velocity, 7.0 / 3.0, 0.5),
    ] {
        let table = table(&species, ratio, n, box_size);
        assert_eq!(table[0], 0.0);
        for (m, &found) in table.iter().enumerate().skip(1) {
            let expected = amplitude * (unit * (m as f64).sqrt()).powf(slope);
            // Rounding of logarithms of order ten.
            assert!(off(found, expected) < 1e-13, "{ratio:?} {m}: {found} {expected}");
        }
    }
}

#[test]
fn ratios_are_constant_below_the_first_row() {
    let k = [0.1, 0.2, 0.4];
    let species = Species::new(&k, &[4.0, 2.0, 1.0], &[2.0, 3.0, 1.0], &[1.0, 1.0, 1.0], None).unwrap();
    // Half the first wavenumber, and a hundredth of it.
    for box_size in [20.0 * core::f64::consts::TAU, 1000.0 * core::f64::consts::TAU] {
        assert!(off(table(&species, Ratio::Density, 8, box_size)[1], 0.5) < 1e-15);
        assert!(off(table(&species, Ratio::Velocity, 8, box_size)[1], 0.25) < 1e-15);
    }
}

#[test]
fn without_a_reference_matter_stays_as_it_is() {
    let k = [0.01, 0.1, 1.0];
    let species = Species::new(&k, &[4.0, 2.0, 1.0], &[2.0, 3.0, 1.0], &[1.0; 3], None).unwrap();
    assert!(!species.has_own_growth());
    assert!(table(&species, Ratio::Matter, 16, 300.0)[1..].iter().all(|&ratio| ratio == 1.0));
    let own = Species::new(&k, &[4.0, 2.0, 1.0], &[2.0, 3.0, 1.0], &[1.0; 3], Some(&[1.0; 3])).unwrap();
    assert!(own.has_own_growth());
}

#[test]
fn the_bits_do_not_depend_on_threads() {
    let columns = camb_species();
    let [k, matter, cold, _, velocity, _, today] = core::array::from_fn(|i| columns[i].as_slice());
    let species = Species::new(k, matter, cold, velocity, Some(today)).unwrap();
    for ratio in RATIOS {
        let one = table(&species, ratio, 64, 1000.0);
        for threads in [2, 5] {
            let mut many = vec![f64::NAN; one.len()];
            let threads = Threads::new(threads).unwrap();
            species_table(&threads, &species, ratio, 64, 1000.0, &mut many).unwrap();
            assert_eq!(one, many);
        }
    }
}

#[test]
fn bad_columns_are_refused() {
    let k = [0.1, 0.2];
    let good = [1.0, 2.0];
    let attempt = |column: &[f64], which: usize| {
        let pick = |i: usize| if i == which { column } else { &good[..] };
        Species::new(&k, pick(0), pick(1), pick(2), Some(pick(3))).map(|_| ())
    };
    for which in 0..4 {
        assert_eq!(attempt(&good[..1], which), Err(Error::Length));
        assert_eq!(attempt(&[1.0, f64::NAN], which), Err(Error::NotFinite));
        assert_eq!(attempt(&[1.0, 0.0], which), Err(Error::Table));
        assert_eq!(attempt(&[-1.0, 1.0], which), Err(Error::Table));
        assert_eq!(attempt(&good, which), Ok(()));
    }
    let species = Species::new(&k, &good, &good, &good, None).unwrap();
    let mut out = vec![7.0; mode_table_length(8).unwrap()];
    let mut fill = |n, box_size, length: usize| {
        species_table(&Serial, &species, Ratio::Density, n, box_size, &mut out[..length])
    };
    let length = mode_table_length(8).unwrap();
    assert!(fill(8, 0.0, length).is_err() && fill(8, f64::NAN, length).is_err());
    assert!(fill(7, 1.0, length).is_err() && fill(8, 1.0, length - 1).is_err());
    assert!(out.iter().all(|&x| x == 7.0));
    // A ratio that is a power law of slope 600 leaves the range of numbers.
    let steep = Species::new(&[1.0, 1.1], &[1.0, 1e-25], &[1.0, 1.0], &good, None).unwrap();
    let refused = species_table(&Serial, &steep, Ratio::Density, 8, 1e-3, &mut out);
    assert_eq!(refused, Err(Error::Range));
}

#[test]
fn camb_s_velocities_are_rates_of_growth_of_its_densities() {
    let columns = camb_species();
    let f = growth(&with_radiation(), 1.0 / 33.0).unwrap().f;
    let baryons = 0.044 / 0.27;
    for row in 0..columns[0].len() {
        let [k, total, cold, baryon, v_cold, v_baryon, _] = core::array::from_fn(|i| columns[i][row]);
        // Seven digits of the columns.
        assert!(off(baryons * baryon + (1.0 - baryons) * cold, total) < 1e-6);
        let velocity = baryons * v_baryon + (1.0 - baryons) * v_cold;
        if k > 0.05 {
            // Together they grow as matter does with a smooth radiation: no unit, sign or power of k lies between V and T.
            // What is left, 1.2e-4 at k = 19, is the baryons' pressure.
            assert!(off(velocity / total, f) < 2e-4, "{k} {}", velocity / total);
            // Apart they do not: baryons are still falling in.
            assert!(v_cold / cold < f - 0.01 && v_baryon / baryon > f + 0.03, "{k}");
        } else {
            // Towards the horizon velocities are of the Newtonian gauge and densities of the synchronous, and radiation clusters.
            assert!(off(velocity / total, f) < 0.005, "{k} {}", velocity / total);
        }
    }
}

#[test]
fn camb_s_growth_depends_on_scale_by_what_the_reference_column_mends() {
    let columns = camb_species();
    let d = growth(&with_radiation(), 1.0 / 33.0).unwrap().d;
    let ratio = |row: usize| columns[1][row] / columns[6][row] / d;
    let last = columns[0].len() - 1;
    // Small scales follow the background's growth but for a few 1e-4 that baryons leave; on the largest, radiation clusters too.
    assert!(off(ratio(last), 1.0) < 3e-4, "{}", ratio(last));
    assert!((ratio(0) - 0.974).abs() < 1e-3, "{}", ratio(0));
}
