//! The peak of a posterior is biased at second order in the scatter, because the model is quadratic in its parameters.
//!
//! With the derivatives m_a, m_ab of the model over sigma, J_ab = sum m_a m_b and C = J^-1, least chi^2 is off by
//! -1/2 C_ab sum m_b tr(C m_cd) (Box 1971), and the peak of the marginal of a by -1/2 C_aa dlnH/da from there: H is the curvature of
//! chi^2/2 in the other parameter, over whose width ~ H^-1/2 the density is integrated, along the ridge.

use std::vec::Vec;

use super::chain::run;
use super::derivatives::Derivatives;
use super::sky::{B_G, F_NL, KINDS, Kind, LARGEST, Sky};
use super::{LIMIT, moments};

/// The bias of the peaks of b_g and f_NL to be expected.
pub(super) fn bias_of_peaks(sky: &Sky, kind: Kind, universe: usize) -> [f64; 2] {
    let model = Derivatives::new(sky, kind, universe);
    let (j, c) = (model.curvature, model.covariance);
    let trace = |m: [[f64; 2]; 2]| -> f64 { (0..4).map(|at| c[at / 2][at % 2] * m[at / 2][at % 2]).sum() };
    let pull = [0, 1].map(|a| model.sum(|m, second| m[a] * trace(second)));
    [0, 1].map(|a| {
        let other = 1 - a;
        let least = -0.5 * (c[a][0] * pull[0] + c[a][1] * pull[1]);
        let ridge = -j[a][other] / j[other][other];
        let change = model.sum(|m, second| {
            let along = second[a][other] + ridge * second[other][other];
            2.0 * m[other] * along + (m[a] + ridge * m[other]) * second[other][other]
        });
        least - 0.5 * c[a][a] * change / j[other][other]
    })
}

/// Realisations of each sign of the deviations: in the average of both all odd orders cancel.
const COUNT: u32 = 200;
/// Other random numbers than those of the other claims.
const FIRST: u32 = 1 << 20;

#[test]
fn peaks_are_biased_at_second_order_only_and_by_as_much_as_theory_says() {
    // A fourth of the variance is enough to see in one kind.
    for (volume, kinds) in [(1.0, &KINDS[..]), (4.0, &[Kind::Normal])] {
        let sky = Sky::new(LARGEST, volume, F_NL);
        for &kind in kinds {
            let [plus, minus] = [1.0, -1.0].map(|sign| run(&sky, kind, FIRST..FIRST + COUNT, sign));
            for universe in 0..2 {
                let expected = bias_of_peaks(&sky, kind, universe);
                for (axis, truth) in [B_G, F_NL[universe]].into_iter().enumerate() {
                    let both = plus[universe].iter().zip(&minus[universe]);
                    let even: Vec<f64> = both
                        .map(|(plus, minus)| [plus, minus].map(|c| c.posterior[axis].peak - truth))
                        .map(|[plus, minus]| 0.5 * (plus + minus))
                        .collect();
                    let [mean, deviation] = moments(&even);
                    let error = deviation / f64::from(COUNT).sqrt();
                    let expected = expected[axis];
                    assert!(
                        (mean - expected).abs() < LIMIT * error,
                        "{kind:?} {universe} {axis}, {volume} volumes: {mean} +- {error}, theory {expected}"
                    );
                    if axis == super::F_NL {
                        // It is seen, not only allowed.
                        assert!(error < 0.15 * expected.abs(), "{error} of {expected}");
                    }
                }
            }
        }
    }
}

#[test]
fn the_bias_of_a_peak_is_below_a_thirtieth_of_its_scatter_and_falls_with_volume() {
    let [sky, four] = [1.0, 4.0].map(|volume| Sky::new(LARGEST, volume, F_NL));
    for kind in KINDS {
        for universe in 0..2 {
            let scatter = Derivatives::new(&sky, kind, universe).covariance;
            let [once, less] = [&sky, &four].map(|sky| bias_of_peaks(sky, kind, universe));
            for axis in 0..2 {
                assert!((4.0 * less[axis] / once[axis] - 1.0).abs() < 1e-9);
                let ratio = once[axis] / scatter[axis][axis].sqrt();
                assert!(ratio.abs() < 1.0 / 30.0, "{kind:?} {universe} {axis}: {ratio}");
            }
        }
    }
}
