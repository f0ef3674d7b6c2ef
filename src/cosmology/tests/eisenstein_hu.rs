use super::*;
use crate::cosmology::{EisensteinHu, Wiggles};
use crate::status::Error;

/// k in h/Mpc, T with wiggles, T without.
type Row = [f64; 3];

/// By the Python package colossus 1.4.0 (Diemer 2018, arXiv:1712.04512), `transferFunction` with the models `eisenstein98` and
/// `eisenstein98_zb`: the paper's cosmology, and Om = 1, Ob = 0.1, h = 0.5, T = 2.728 K.
const COLOSSUS: [(Cosmology, [Row; 7]); 2] = [
    (
        Cosmology::goliat(),
        [
            [1e-3, 9.906596661387e-01, 9.904713867004e-01],
            [0.01, 7.561234440754e-01, 7.622504284008e-01],
            [0.05, 2.453358084727e-01, 2.512961556107e-01],
            [0.1, 1.137125929839e-01, 1.172398398832e-01],
            [0.2, 4.692358930332e-02, 4.703919966424e-02],
            [1.0, 3.930302401492e-03, 3.903180863450e-03],
            [10.0, 7.405420604147e-05, 7.330574994650e-05],
        ],
    ),
    (
        Cosmology { t_cmb: 2.728, ..Cosmology::flat(1.0, 0.1, 0.5, 1.0) },
        [
            [1e-3, 9.984513113390e-01, 9.983722894980e-01],
            [0.01, 9.216248104322e-01, 9.239229762490e-01],
            [0.05, 5.554852532900e-01, 5.575043273338e-01],
            [0.1, 3.400545133893e-01, 3.406446024254e-01],
            [0.2, 1.759693775085e-01, 1.751017967979e-01],
            [1.0, 2.044002091789e-02, 2.043168236400e-02],
            [10.0, 4.664474150481e-04, 4.611317630560e-04],
        ],
    ),
];

#[test]
fn both_fits_agree_with_another_program() {
    for (cosmology, rows) in COLOSSUS {
        let with = EisensteinHu::new(&cosmology, Wiggles::With).unwrap();
        let without = EisensteinHu::new(&cosmology, Wiggles::Without).unwrap();
        for [k, wiggly, smooth] in rows {
            assert!(off(with.transfer(k).unwrap(), wiggly) < 1e-11, "{k}");
            assert!(off(without.transfer(k).unwrap(), smooth) < 1e-11, "{k}");
        }
    }
}

#[test]
fn fits_follow_camb_to_a_few_percent() {
    let file = camb();
    let with = EisensteinHu::new(&Cosmology::goliat(), Wiggles::With).unwrap();
    let without = EisensteinHu::new(&Cosmology::goliat(), Wiggles::Without).unwrap();
    for (&k, &t) in file[0].iter().zip(&file[1]).filter(|(k, _)| **k < 1.0) {
        // Their fit predates the present recombination codes: it is 3% off at most; the smooth shape misses the wiggles, 6% in T.
        assert!(off(with.transfer(k).unwrap(), t) < 0.04, "{k}");
        assert!(off(without.transfer(k).unwrap(), t) < 0.08, "{k}");
    }
}

#[test]
fn large_scales_have_unit_transfer_and_extremes_stay_finite() {
    for wiggles in [Wiggles::With, Wiggles::Without] {
        let fit = EisensteinHu::new(&Cosmology::goliat(), wiggles).unwrap();
        assert!(off(fit.transfer(1e-7).unwrap(), 1.0) < 1e-5);
        assert_eq!(fit.transfer(1e-300).unwrap(), 1.0);
        assert!(fit.transfer(1e300).unwrap().abs() < 1e-30);
    }
}

#[test]
fn bad_fits_are_refused() {
    let good = Cosmology::goliat();
    let no_baryons = Cosmology { omega_b: 0.0, ..good };
    assert_eq!(EisensteinHu::new(&no_baryons, Wiggles::With), Err(Error::Range));
    assert!(EisensteinHu::new(&no_baryons, Wiggles::Without).is_ok());
    assert_eq!(EisensteinHu::new(&Cosmology { h: 10.0, ..good }, Wiggles::With), Err(Error::Range));
    let fit = EisensteinHu::new(&good, Wiggles::With).unwrap();
    assert_eq!(fit.transfer(0.0), Err(Error::Range));
    assert_eq!(fit.transfer(f64::NAN), Err(Error::NotFinite));
    assert_eq!(Wiggles::try_from(2), Err(Error::Choice));
    assert_eq!(Wiggles::try_from(1), Ok(Wiggles::With));
}
