use std::vec;

use super::*;
use crate::cosmology::{
    Convention, EisensteinHu, Linear, Poisson, Table, Wiggles, alpha_table, mode_table_length,
    potential_amplitude_table,
};
use crate::exec::{Serial, Threads};
use crate::status::Error;

fn with_poisson(test: impl Fn(Poisson<'_>)) {
    let file = camb();
    let cosmology = Cosmology::goliat();
    let fit = EisensteinHu::new(&cosmology, Wiggles::With).unwrap();
    for linear in [
        Linear::from_power(Table::new(&file[0], &file[2]).unwrap(), 0.96).unwrap(),
        Linear::from_transfer(Table::new(&file[0], &file[1]).unwrap(), 0.96, 4e6).unwrap(),
        Linear::from_eisenstein_hu(fit, 0.96, 4e6).unwrap(),
    ] {
        test(Poisson::new(&cosmology, linear, 0.03, Convention::Cmb).unwrap());
    }
}

#[test]
fn entries_have_the_bits_of_the_functions() {
    with_poisson(|poisson| {
        let (n, side) = (96, 1000.0);
        let length = mode_table_length(n).unwrap();
        let (mut amplitude, mut alpha) = (vec![0.5; length], vec![0.5; length]);
        potential_amplitude_table(&Serial, &poisson, n, side, &mut amplitude).unwrap();
        alpha_table(&Serial, &poisson, n, side, &mut alpha).unwrap();
        assert_eq!((amplitude[0], alpha[0]), (0.0, 0.0));
        let k_f = 2.0 * core::f64::consts::PI / side;
        for m in 1..length {
            let k = k_f * (m as f64).sqrt();
            assert_eq!(alpha[m].to_bits(), poisson.alpha(k).unwrap().to_bits());
            let power = poisson.potential_power(k).unwrap() / side.powi(3);
            assert!(off(amplitude[m] * amplitude[m], power) < 4e-15);
            let density = (amplitude[m] * alpha[m]).powi(2) * side.powi(3);
            assert!(off(density, poisson.density_power(k).unwrap()) < 2e-14);
        }
    });
}

#[test]
fn threads_do_not_change_bits() {
    with_poisson(|poisson| {
        let n = 128;
        let length = mode_table_length(n).unwrap();
        let (mut one, mut three) = (vec![0.0; length], vec![0.0; length]);
        let pool = Threads::new(3).unwrap();
        alpha_table(&Serial, &poisson, n, 500.0, &mut one).unwrap();
        alpha_table(&pool, &poisson, n, 500.0, &mut three).unwrap();
        assert!(one.iter().zip(&three).all(|(a, b)| a.to_bits() == b.to_bits()));
        potential_amplitude_table(&Serial, &poisson, n, 500.0, &mut one).unwrap();
        potential_amplitude_table(&pool, &poisson, n, 500.0, &mut three).unwrap();
        assert!(one.iter().zip(&three).all(|(a, b)| a.to_bits() == b.to_bits()));
    });
}

#[test]
fn a_finer_mesh_of_the_same_box_begins_with_the_coarser_table() {
    with_poisson(|poisson| {
        let [coarse, fine] = [16, 24].map(|n| {
            let mut table = vec![0.0; mode_table_length(n).unwrap()];
            alpha_table(&Serial, &poisson, n, 100.0, &mut table).unwrap();
            table
        });
        assert_eq!(coarse, fine[..coarse.len()]);
    });
}

#[test]
fn lengths_follow_the_corner_of_the_mesh() {
    assert_eq!(mode_table_length(512), Ok(196_609));
    assert_eq!(mode_table_length(2), Ok(4));
    assert_eq!(mode_table_length(0), Err(Error::MeshSize));
    assert_eq!(mode_table_length(9), Err(Error::MeshSize));
    assert_eq!(mode_table_length(usize::MAX - 1), Err(Error::Overflow));
}

#[test]
fn bad_arguments_are_refused_and_leave_no_trace() {
    with_poisson(|poisson| {
        let mut out = [7.0; 13];
        for (n, side, length, error) in [
            (4, 100.0, 12, Error::Length),
            (5, 100.0, 13, Error::MeshSize),
            (4, 0.0, 13, Error::Range),
            (4, -1.0, 13, Error::Range),
            (4, f64::NAN, 13, Error::NotFinite),
            (4, 1e31, 13, Error::Range),
        ] {
            let out = &mut out[..length];
            assert_eq!(alpha_table(&Serial, &poisson, n, side, out), Err(error));
            assert_eq!(potential_amplitude_table(&Serial, &poisson, n, side, out), Err(error));
        }
        assert!(out.iter().all(|&x| x == 7.0));
    });
}
