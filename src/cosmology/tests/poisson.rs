use super::*;
use crate::cosmology::{
    Convention, EisensteinHu, Linear, Poisson, Table, Wiggles, alpha_factor, g_ratio, primordial_amplitude,
};
use crate::status::Error;

#[test]
fn alpha_has_the_paper_s_numbers() {
    let cosmology = Cosmology::goliat();
    let k2 = 1e-4;
    let alpha = k2 * alpha_factor(&cosmology, 0.5, Convention::Cmb).unwrap();
    // physics.md, section 3, to its printed digits.
    assert!((alpha - 1050.4).abs() < 0.05, "{alpha}");
    let lss = k2 * alpha_factor(&cosmology, 0.5, Convention::Lss).unwrap();
    assert!((lss / 1.31 - 1055.1).abs() < 0.1, "{lss}");
    assert!(off(lss / alpha, g_ratio(&cosmology).unwrap()) < 1e-15);
    // Eq. bk: b_g = 2.32, p = 1, f_NL = 100, delta_c = 1.686.
    let shift = 2.0 * 1.686 * (2.32 - 1.0) * 100.0 / alpha;
    assert!((shift - 0.4237).abs() < 1e-4, "{shift}");
}

#[test]
fn density_is_alpha_times_potential_to_rounding() {
    let file = camb();
    let fit = EisensteinHu::new(&Cosmology::goliat(), Wiggles::With).unwrap();
    for convention in [Convention::Cmb, Convention::Lss] {
        for linear in [
            Linear::from_power(Table::new(&file[0], &file[2]).unwrap(), 0.96).unwrap(),
            Linear::from_power(Table::new(&file[0], &file[2]).unwrap(), 0.96)
                .unwrap()
                .with_sigma8(0.7)
                .unwrap(),
            Linear::from_transfer(Table::new(&file[0], &file[1]).unwrap(), 0.96, 4e6).unwrap(),
            Linear::from_eisenstein_hu(fit, 0.96, 4e6).unwrap(),
        ] {
            for a in [1.0 / 33.0, 1.0] {
                let poisson = Poisson::new(&Cosmology::goliat(), linear, a, convention).unwrap();
                for &k in file[0].iter().chain(&[1e-6, 0.0123, 0.3, 80.0]) {
                    let alpha = poisson.alpha(k).unwrap();
                    let power = poisson.potential_power(k).unwrap() * alpha * alpha;
                    assert!(off(power, poisson.density_power(k).unwrap()) < 1e-14, "{k}");
                }
            }
        }
    }
}

#[test]
fn potential_is_a_power_law_with_the_primordial_amplitude() {
    let cosmology = Cosmology::goliat();
    let fit = EisensteinHu::new(&cosmology, Wiggles::With).unwrap();
    let amplitude = primordial_amplitude(&cosmology, 2e-9, 0.05).unwrap();
    let linear = Linear::from_eisenstein_hu(fit, 0.96, amplitude).unwrap();
    let poisson = Poisson::new(&cosmology, linear, 0.1, Convention::Cmb).unwrap();
    let pivot = 0.05 / 0.7;
    // k^3 P_Phi/(2 pi^2) = (9/25) A_s at the pivot.
    let variance =
        |k: f64| k.powi(3) * poisson.potential_power(k).unwrap() / (2.0 * core::f64::consts::PI.powi(2));
    assert!(off(variance(pivot), 0.36 * 2e-9) < 1e-14);
    assert!(off(variance(1.0) / variance(0.1), 10_f64.powf(-0.04)) < 1e-13);
}

#[test]
fn conventions_and_times_only_rescale() {
    let file = camb();
    let linear = Linear::from_power(Table::new(&file[0], &file[2]).unwrap(), 0.96).unwrap();
    let cosmology = Cosmology::goliat();
    let cmb = Poisson::new(&cosmology, linear, 0.5, Convention::Cmb).unwrap();
    let lss = Poisson::new(&cosmology, linear, 0.5, Convention::Lss).unwrap();
    let early = Poisson::new(&cosmology, linear, 0.25, Convention::Cmb).unwrap();
    let ratio = g_ratio(&cosmology).unwrap();
    for k in [1e-3, 0.1, 1.0] {
        assert!(off(lss.alpha(k).unwrap() / cmb.alpha(k).unwrap(), ratio) < 1e-14);
        assert!(
            off(cmb.potential_power(k).unwrap() / lss.potential_power(k).unwrap(), ratio * ratio) < 1e-14
        );
        assert_eq!(early.potential_power(k), cmb.potential_power(k));
        let growth = early.growth().d / cmb.growth().d;
        assert!(off(early.alpha(k).unwrap() / cmb.alpha(k).unwrap(), growth) < 1e-14);
    }
}

#[test]
fn bad_arguments_are_refused() {
    let file = camb();
    let linear = Linear::from_power(Table::new(&file[0], &file[2]).unwrap(), 0.96).unwrap();
    let good = Cosmology::goliat();
    let new = |cosmology, a| Poisson::new(&cosmology, linear, a, Convention::Cmb).err();
    assert_eq!(new(good, 0.0), Some(Error::Range));
    assert_eq!(new(good, f64::NAN), Some(Error::NotFinite));
    assert_eq!(new(Cosmology { n_s: 1.0, ..good }, 1.0), Some(Error::Range), "not the spectrum's tilt");
    assert_eq!(new(Cosmology { omega_m: -1.0, ..good }, 1.0), Some(Error::Range));
    assert_eq!(Convention::try_from(2), Err(Error::Choice));
    assert_eq!(Convention::try_from(0), Ok(Convention::Cmb));
    assert_eq!(primordial_amplitude(&good, -1.0, 0.05), Err(Error::Range));
    assert_eq!(primordial_amplitude(&good, f64::NAN, 0.05), Err(Error::NotFinite));
    let poisson = Poisson::new(&good, linear, 1.0, Convention::Cmb).unwrap();
    assert_eq!(poisson.alpha(0.0), Err(Error::Range));
    assert_eq!(poisson.potential_power(f64::INFINITY), Err(Error::NotFinite));
}
