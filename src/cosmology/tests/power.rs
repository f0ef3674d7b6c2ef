use super::*;
use crate::cosmology::quadrature::integrate;
use crate::cosmology::{
    Convention, EisensteinHu, Linear, Table, Wiggles, alpha_factor, growth, primordial_amplitude,
};
use crate::status::Error;

#[test]
fn embedded_spectrum_has_sigma8_of_0_8() {
    let file = camb();
    let linear = Linear::from_power(Table::new(&file[0], &file[2]).unwrap(), 0.96).unwrap();
    // CAMB's own integral over its own interpolation says 0.79999986.
    assert!((linear.sigma(8.0).unwrap() - 0.8).abs() < 1e-5, "{}", linear.sigma(8.0).unwrap());
}

#[test]
fn sigma_of_a_power_law_has_its_closed_form() {
    // P = k^n: sigma^2 = 9 R^-(n+3)/(2 pi^2) int x^(n-4) (sin x - x cos x)^2 dx; n = -2: the integral is pi/15.
    let k = [1e-8, 1.0, 1e8];
    let p = k.map(|k| f64::powi(k, -2));
    let linear = Linear::from_power(Table::new(&k, &p).unwrap(), -2.0).unwrap();
    for radius in [0.3, 8.0, 100.0] {
        let expected =
            (9.0 / (2.0 * core::f64::consts::PI.powi(2) * radius) * core::f64::consts::PI / 15.0).sqrt();
        // 1e-5 <= kR leaves out 1e-5 of this shallow spectrum's int dx W^2 = 3 pi/5, half of which shows in sigma.
        assert!(off(linear.sigma(radius).unwrap(), expected) < 3e-6);
    }
}

#[test]
fn spectrum_and_transfer_carry_the_same_information() {
    let file = camb();
    let from_power = Linear::from_power(Table::new(&file[0], &file[2]).unwrap(), 0.96).unwrap();
    let t: Vec<f64> = file[0].iter().map(|&k| 3e7 * from_power.transfer(k).unwrap()).collect();
    let table = Table::new(&file[0], &t).unwrap();
    let from_transfer = Linear::from_transfer(table, 0.96, from_power.amplitude()).unwrap();
    for &k in &[1e-7, 1e-6, 1e-5, 3e-4, 0.013, 0.2, 5.0, 50.0] {
        // Between rows the two interpolate different functions whose slopes may be limited at different places.
        let between = if file[0].contains(&k) || k < 1e-5 { 1e-13 } else { 1e-3 };
        assert!(off(from_transfer.power(k).unwrap(), from_power.power(k).unwrap()) < between, "{k}");
    }
    // The file's own T column is another output of the same run.
    for (row, &k) in file[0].iter().enumerate() {
        assert!(off(from_power.transfer(k).unwrap(), file[1][row]) < 1e-5, "{k}");
    }
}

#[test]
fn rows_of_p_are_returned_and_continued_as_the_primordial_power_law() {
    let file = camb();
    let linear = Linear::from_power(Table::new(&file[0], &file[2]).unwrap(), 0.96).unwrap();
    for (&k, &p) in file[0].iter().zip(&file[2]) {
        assert!(off(linear.power(k).unwrap(), p) < 4e-15);
    }
    assert!(off(linear.power(1e-7).unwrap(), file[2][0] * 0.01_f64.powf(0.96)) < 1e-13);
    assert!(off(linear.transfer(1e-7).unwrap(), 1.0) < 1e-13);
}

#[test]
fn normalisation_reaches_the_sigma8_asked_for() {
    let file = camb();
    let fit = EisensteinHu::new(&Cosmology::goliat(), Wiggles::With).unwrap();
    for linear in [
        Linear::from_power(Table::new(&file[0], &file[2]).unwrap(), 0.96).unwrap(),
        Linear::from_transfer(Table::new(&file[0], &file[1]).unwrap(), 0.96, 1.0).unwrap(),
        Linear::from_eisenstein_hu(fit, 0.96, 1.0).unwrap(),
    ] {
        let linear = linear.with_sigma8(0.8).unwrap();
        assert!(off(linear.sigma(8.0).unwrap(), 0.8) < 1e-9);
        let camb_power = file[2][350];
        assert!(off(linear.power(file[0][350]).unwrap(), camb_power) < 0.06);
    }
}

#[test]
fn primordial_amplitude_gives_the_file_s_sigma8() {
    let file = camb();
    let amplitude = primordial_amplitude(&Cosmology::goliat(), 2.142_974_83e-9, 0.05).unwrap();
    let table = Table::new(&file[0], &file[1]).unwrap();
    let sigma8 = Linear::from_transfer(table, 0.96, amplitude).unwrap().sigma(8.0).unwrap();
    // CAMB keeps radiation until today. Its delta_tot/(k^2 zeta) at the lowest k, 1e-5 h/Mpc, is 2.06370e7 Mpc^2, that of matter and a
    // cosmological constant 2.06519e7: 0.07%, about 2 Or/Om. That is the whole difference.
    assert!(off(sigma8, 0.8 * 2.065_19 / 2.063_70) < 5e-5, "{sigma8}");
    let factor = alpha_factor(&Cosmology::goliat(), 1.0, Convention::Cmb).unwrap();
    assert!(off(0.6 * factor / 0.49, 2.065_19e7) < 2e-6);
}

#[test]
fn a_boltzmann_spectrum_of_z_32_has_1_3_percent_more_power_than_the_back_scaled_one() {
    let file = camb();
    let sigma8 = |column: usize| {
        let table = Table::new(&file[0], &file[column]).unwrap();
        Linear::from_power(table, 0.96).unwrap().sigma(8.0).unwrap()
    };
    let d = growth(&Cosmology::goliat(), 1.0 / 33.0).unwrap().d;
    let excess = (sigma8(4) / (d * sigma8(2))).powi(2);
    assert!((excess - 1.0131).abs() < 5e-4, "{excess}");
    // With radiation in the background it is 1 to 1e-4.
    let d = growth(&with_radiation(), 1.0 / 33.0).unwrap().d;
    assert!(off((sigma8(4) / (d * sigma8(2))).powi(2), 1.0) < 1e-4);
    // At z = 1 radiation matters by 1.6e-4.
    let d = growth(&Cosmology::goliat(), 0.5).unwrap().d;
    assert!(off((sigma8(3) / (d * sigma8(2))).powi(2), 1.0) < 3e-4);
}

#[test]
fn sigma_agrees_with_an_integral_row_by_row() {
    let file = camb();
    let table = Table::new(&file[0], &file[2]).unwrap();
    let linear = Linear::from_power(table, 0.96).unwrap();
    for radius in [2.0, 8.0, 30.0] {
        let density = |x: f64| {
            let k = x.exp();
            let y = k * radius;
            let w = if y < 1e-2 { 1.0 - y * y / 10.0 } else { 3.0 * (y.sin() - y * y.cos()) / y.powi(3) };
            k.powi(3) * table.at(k).unwrap() * w * w
        };
        let pieces = file[0].windows(2).map(|k| integrate(density, k[0].ln(), k[1].ln(), 1e-9).unwrap());
        let sigma = (pieces.sum::<f64>() / 2.0).sqrt() / core::f64::consts::PI;
        // The rows end at k = 50, 3e-5 of which is missing at R = 2.
        assert!(off(linear.sigma(radius).unwrap(), sigma) < 1e-7, "{radius}");
    }
}

#[test]
fn bad_spectra_are_refused() {
    let (k, v) = ([0.1, 1.0], [1.0, 2.0]);
    let table = Table::new(&k, &v).unwrap();
    let linear = Linear::from_power(table, 1.0).unwrap();
    assert_eq!(Linear::from_power(table, f64::NAN).err(), Some(Error::NotFinite));
    assert_eq!(Linear::from_power(table, 11.0).err(), Some(Error::Range));
    assert_eq!(Linear::from_transfer(table, 1.0, 0.0).err(), Some(Error::Range));
    assert_eq!(linear.with_sigma8(-0.8).err(), Some(Error::Range));
    assert_eq!(linear.with_sigma8(f64::INFINITY).err(), Some(Error::NotFinite));
    assert_eq!(linear.sigma(0.0), Err(Error::Range));
    assert_eq!(linear.sigma(f64::NAN), Err(Error::NotFinite));
    assert_eq!(linear.power(-1.0), Err(Error::Range));
    assert_eq!(linear.transfer(f64::NAN), Err(Error::NotFinite));
}
