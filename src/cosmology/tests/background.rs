use super::*;
use crate::cosmology::radiation_density;
use crate::status::Error;

#[test]
fn expansion_is_one_today_whatever_is_in_the_universe() {
    for cosmology in [
        Cosmology::goliat(),
        with_radiation(),
        Cosmology { omega_de: 0.5, ..Cosmology::goliat() },
        Cosmology { w0: -0.8, wa: -0.5, ..Cosmology::goliat() },
    ] {
        assert!(off(cosmology.expansion(1.0).unwrap(), 1.0) < 1e-15);
    }
}

#[test]
fn expansion_has_the_slope_it_says() {
    let cosmology =
        Cosmology { omega_m: 0.3, omega_de: 0.72, omega_r: 9e-5, w0: -0.9, wa: 0.3, ..Cosmology::goliat() };
    for a in [1e-7_f64, 1e-4, 0.1, 0.7, 1.0, 3.0] {
        let h = 1e-4_f64;
        let ends = [-h, h].map(|h| cosmology.expansion(a * h.exp()).unwrap().ln());
        let slope = (ends[1] - ends[0]) / (2.0 * h);
        // The symmetric difference is wrong by h^2/6 times the third derivative, which is of order 1.
        assert!((cosmology.expansion_slope(a).unwrap() - slope).abs() < 1e-8);
    }
}

#[test]
fn matter_fraction_tends_to_one_without_radiation_and_to_zero_with_it() {
    assert!(off(Cosmology::goliat().matter_fraction(1e-4).unwrap(), 1.0) < 1e-11);
    assert!(with_radiation().matter_fraction(1e-8).unwrap() < 1e-4);
    assert!(off(Cosmology::goliat().matter_fraction(1.0).unwrap(), 0.27) < 1e-15);
}

#[test]
fn radiation_is_that_of_the_embedded_spectrum() {
    // The header of the CAMB file: T = 2.7255 K, N_eff = 3.046, h = 0.7. CAMB's gravitational constant differs in the fifth digit.
    assert!(off(radiation_density(2.7255, 3.046, 0.7).unwrap(), 8.538_169e-5) < 2e-4);
    assert_eq!(radiation_density(2.7255, -1.0, 0.7), Err(Error::Range));
    assert_eq!(radiation_density(f64::NAN, 3.0, 0.7), Err(Error::NotFinite));
    // T^4 overflows, and h^2 is zero.
    assert_eq!(radiation_density(1e300, 3.0, 0.7), Err(Error::Range));
    assert_eq!(radiation_density(2.7, 3.0, 1e-300), Err(Error::Range));
    assert_eq!(radiation_density(2.7, 3.0, 1e200), Err(Error::Range));
}

#[test]
fn impossible_universes_are_refused() {
    let good = Cosmology::goliat();
    assert_eq!(good.check(), Ok(()));
    assert_eq!(with_radiation().check(), Ok(()));
    for bad in [f64::NAN, f64::INFINITY] {
        assert_eq!(Cosmology { omega_m: bad, ..good }.check(), Err(Error::NotFinite));
        assert_eq!(Cosmology { wa: bad, ..good }.check(), Err(Error::NotFinite));
        assert_eq!(good.expansion(bad), Err(Error::NotFinite));
    }
    for bad in [
        Cosmology { omega_m: 0.0, ..good },
        Cosmology { omega_m: -0.3, ..good },
        Cosmology { omega_b: 0.3, ..good },
        Cosmology { omega_r: -1e-5, ..good },
        Cosmology { h: 0.0, ..good },
        Cosmology { t_cmb: 0.0, ..good },
        Cosmology { w0: -0.5, wa: 0.7, ..good },
        // Bounces: E^2 < 0 between a = 0.4 and 0.9.
        Cosmology { omega_m: 0.1, omega_de: 2.5, omega_b: 0.04, ..good },
    ] {
        assert_eq!(bad.check(), Err(Error::Range), "{bad:?}");
    }
    assert_eq!(good.expansion(0.0), Err(Error::Range));
    assert_eq!(good.expansion(11.0), Err(Error::Range));
    // Om = 2 without dark energy turns round at a = 2.
    let closed = Cosmology { omega_m: 2.0, omega_de: 0.0, ..good };
    assert!(closed.expansion(1.8).is_ok());
    assert_eq!(closed.expansion(2.1), Err(Error::Range));
}
