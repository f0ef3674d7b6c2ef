use super::growth::SCIPY;
use super::*;
use crate::cosmology::{Growth, growth};

/// D3a, f3a, D3b, f3b, D3c, f3c at the scale factors and for the cosmologies of [`SCIPY`], by the same integration in scipy: from the constants of
/// matter domination at a = 1e-10 (without radiation), or from the leading terms -3 y, (3/2) y, (3/2) y at y = 1e-9 (with it).
const THIRD: [[[f64; 6]; 5]; 6] = [
    [
        [
            -7.593128324283e-07,
            2.999995693746e+00,
            5.423663096157e-07,
            2.999995697830e+00,
            3.254197848342e-07,
            2.999995689208e+00,
        ],
        [
            -2.112818529036e-05,
            2.999880178706e+00,
            1.509156149334e-05,
            2.999880292338e+00,
            9.054936171909e-06,
            2.999880052447e+00,
        ],
        [
            -7.582258792166e-04,
            2.995702514652e+00,
            5.415906500256e-04,
            2.995706587828e+00,
            3.249534573605e-04,
            2.995697988725e+00,
        ],
        [
            -8.087577669899e-02,
            2.569175834364e+00,
            5.777689626441e-02,
            2.569558063830e+00,
            3.465537976239e-02,
            2.568749316475e+00,
        ],
        [
            -3.399653071556e-01,
            1.482381816314e+00,
            2.429892994556e-01,
            1.483402153800e+00,
            1.455938483290e-01,
            1.481225523387e+00,
        ],
    ],
    [
        [
            -8.235062437714e-07,
            2.917192497183e+00,
            5.960324186818e-07,
            2.911548106623e+00,
            3.506317271403e-07,
            2.924143368484e+00,
        ],
        [
            -2.167965962318e-05,
            2.972704032772e+00,
            1.559470588943e-05,
            2.968010382093e+00,
            9.272754752059e-06,
            2.974829754193e+00,
        ],
        [
            -7.634690156847e-04,
            2.987546273854e+00,
            5.469490344637e-04,
            2.985274456959e+00,
            3.270141312839e-04,
            2.988131219805e+00,
        ],
        [
            -8.092619882231e-02,
            2.568010961714e+00,
            5.786148839529e-02,
            2.567789458627e+00,
            3.467298140169e-02,
            2.567686000778e+00,
        ],
        [
            -3.400394992490e-01,
            1.482188701557e+00,
            2.431781516036e-01,
            1.482969648360e+00,
            1.456154082262e-01,
            1.481069351574e+00,
        ],
    ],
    [
        [
            -1.207670743802e-06,
            2.988970963695e+00,
            8.626517439574e-07,
            2.989005386507e+00,
            5.175582817875e-07,
            2.988942267963e+00,
        ],
        [
            -3.286423043810e-05,
            2.966852875443e+00,
            2.347689181840e-05,
            2.966955965121e+00,
            1.408344886162e-05,
            2.966766863896e+00,
        ],
        [
            -1.095064489434e-03,
            2.892096536522e+00,
            7.824523830164e-04,
            2.892424699127e+00,
            4.691813495923e-04,
            2.891821551543e+00,
        ],
        [
            -8.638788766758e-02,
            2.365391874467e+00,
            6.180089716515e-02,
            2.366765706324e+00,
            3.697471162984e-02,
            2.364177864268e+00,
        ],
        [
            -3.452379671948e-01,
            1.552431204280e+00,
            2.472665669446e-01,
            1.554310837261e+00,
            1.476073880948e-01,
            1.550647220424e+00,
        ],
    ],
    [
        [
            -5.166375540093e-07,
            3.005550934142e+00,
            3.690204249312e-07,
            3.005533568811e+00,
            2.214192939618e-07,
            3.005565401756e+00,
        ],
        [
            -1.453913068357e-05,
            3.016801256761e+00,
            1.038454627073e-05,
            3.016748407138e+00,
            6.231329424438e-06,
            3.016845244667e+00,
        ],
        [
            -5.426424650440e-04,
            3.052389586332e+00,
            3.875341679652e-04,
            3.052215492433e+00,
            2.325947409454e-04,
            3.052533260810e+00,
        ],
        [
            -7.137989778516e-02,
            2.774565839964e+00,
            5.094929211898e-02,
            2.774222343655e+00,
            3.060807204438e-02,
            2.774722159916e+00,
        ],
        [
            -3.361523342673e-01,
            1.580023010018e+00,
            2.399452297366e-01,
            1.580520059725e+00,
            1.441149506425e-01,
            1.579247376214e+00,
        ],
    ],
    [
        [
            -7.154934668253e-07,
            2.999999753853e+00,
            5.110667620369e-07,
            2.999999753997e+00,
            3.066400571975e-07,
            2.999999753684e+00,
        ],
        [
            -1.990956882310e-05,
            2.999981976450e+00,
            1.422112062690e-05,
            2.999981987078e+00,
            8.532672325112e-06,
            2.999981963890e+00,
        ],
        [
            -7.151702627134e-04,
            2.998291665944e+00,
            5.108360419673e-04,
            2.998292714713e+00,
            3.065014420946e-04,
            2.998290430512e+00,
        ],
        [
            -7.812998420249e-02,
            2.593495789421e+00,
            5.581241596082e-02,
            2.593790809011e+00,
            3.348058839001e-02,
            2.593153597838e+00,
        ],
        [
            -3.395647301023e-01,
            1.595109900703e+00,
            2.426780048378e-01,
            1.596134845721e+00,
            1.454362478113e-01,
            1.593924723328e+00,
        ],
    ],
    [
        [
            -8.967009748528e-07,
            2.922124860602e+00,
            6.488115313115e-07,
            2.916368429290e+00,
            3.819340527817e-07,
            2.928711640872e+00,
        ],
        [
            -2.369406269875e-05,
            2.974590892921e+00,
            1.703939982525e-05,
            2.970011003414e+00,
            1.013551667585e-05,
            2.976600972314e+00,
        ],
        [
            -8.319720628588e-04,
            2.976175326478e+00,
            5.959508609570e-04,
            2.974005258355e+00,
            3.563674582219e-04,
            2.976710172537e+00,
        ],
        [
            -8.111530975753e-02,
            2.496525641624e+00,
            5.800681527657e-02,
            2.496637931768e+00,
            3.474723678681e-02,
            2.495906957834e+00,
        ],
        [
            -3.416301946108e-01,
            1.563003074335e+00,
            2.444191897185e-01,
            1.564145464709e+00,
            1.462361082406e-01,
            1.561567803415e+00,
        ],
    ],
];

const AT: [f64; 5] = [0.01, 1.0 / 33.0, 0.1, 0.5, 1.0];

fn third(growth: &Growth) -> [f64; 6] {
    let Growth { d3a, f3a, d3b, f3b, d3c, f3c, .. } = *growth;
    [d3a, f3a, d3b, f3b, d3c, f3c]
}

#[test]
fn third_order_agrees_with_another_integration() {
    for ((cosmology, _), rows) in SCIPY.into_iter().zip(THIRD) {
        for (a, row) in AT.into_iter().zip(rows) {
            for (found, expected) in third(&growth(&cosmology, a).unwrap()).into_iter().zip(row) {
                // The error of the step, 5e-9 at most, where dark energy rules.
                assert!(off(found, expected) < 1e-8, "{a} {found} {expected} {cosmology:?}");
            }
        }
    }
}

#[test]
fn einstein_de_sitter_has_its_closed_forms_at_third_order() {
    let eds = Cosmology { omega_m: 1.0, omega_de: 0.0, ..Cosmology::goliat() };
    for a in [1e-5, 1e-3, 0.3, 1.0, 7.0] {
        let cube = a * a * a;
        let expected = [-cube / 3.0, 3.0, 5.0 / 21.0 * cube, 3.0, cube / 7.0, 3.0];
        for (found, expected) in third(&growth(&eds, a).unwrap()).into_iter().zip(expected) {
            // The ratios to a^3 are constant, so only rounding is left.
            assert!(off(found, expected) < 1e-12, "{a}: {found} {expected}");
        }
    }
}

#[test]
fn rates_of_third_order_are_near_three_times_the_first() {
    for (cosmology, _) in SCIPY {
        for a in AT {
            let growth = growth(&cosmology, a).unwrap();
            // D2 and D3 over powers of D vary as Om(a)^(-1/143) and the like, so that rates leave 2 f and 3 f by no more than 3%; with radiation as
            // much early on, where D3b is not yet what matter alone gives.
            assert!(off(growth.f2, 2.0 * growth.f) < 0.03, "{a} {growth:?}");
            for f3 in [growth.f3a, growth.f3b, growth.f3c] {
                assert!(off(f3, 3.0 * growth.f) < 0.03, "{a} {growth:?}");
            }
        }
    }
}

#[test]
fn third_order_satisfies_its_equations() {
    for (cosmology, _) in SCIPY {
        for a in [1e-3_f64, 0.05, 0.4, 1.0] {
            let h = 0.002;
            let [before, now, after] = [-h, 0.0, h].map(|x: f64| growth(&cosmology, a * x.exp()).unwrap());
            let q = 2.0 + cosmology.expansion_slope(a).unwrap();
            let m = 1.5 * cosmology.matter_fraction(a).unwrap();
            let cube = now.d * now.d * now.d;
            let pulls = [now.d3a - 2.0 * cube, now.d3b + cube - now.d * now.d2, cube];
            let [before, now, after] = [before, now, after].map(|growth| third(&growth));
            for (i, pull) in pulls.into_iter().enumerate() {
                let slope = |g: &[f64; 6]| g[2 * i] * g[2 * i + 1];
                let residual = (slope(&after) - slope(&before)) / (2.0 * h) + q * slope(&now) - m * pull;
                // h^2/6 times the third derivative of D3', at most 81 D3: 6e-5 of it.
                assert!(residual.abs() < 1e-4 * now[2 * i].abs(), "{i} {a} {residual}");
            }
        }
    }
}

#[test]
fn third_order_begins_with_matter_s_own_fall() {
    // Deep in radiation domination nothing of the higher orders is there yet: D2 = -(3/2) y D^2 and D3 = -3 y, (3/2) y, (3/2) y to first order in y.
    let omega_r = 0.5;
    let cosmology = Cosmology { omega_m: 0.5, omega_de: 0.0, omega_r, ..Cosmology::goliat() };
    let growth = growth(&cosmology, 1e-5).unwrap();
    let expected = [(growth.d2, -1.5, 2), (growth.d3a, -3.0, 3), (growth.d3b, 1.5, 3), (growth.d3c, 1.5, 3)];
    for (found, coefficient, order) in expected {
        // D(a)/D(0) = 1 + 1.5e-5; the next terms are of relative size y too.
        let scaled = found / growth.d.powi(order) / 1e-5;
        assert!(off(scaled, coefficient) < 1e-4, "{scaled} {coefficient}");
    }
}

#[test]
fn a_trace_of_radiation_changes_little_of_the_third_order() {
    let at = |omega_r| {
        let cosmology = Cosmology { omega_r, omega_de: 0.73 - omega_r, ..Cosmology::goliat() };
        third(&growth(&cosmology, 0.03).unwrap())
    };
    let none = at(0.0);
    for omega_r in [1e-20, 2e-13, 3e-13] {
        for (some, none) in at(omega_r).into_iter().zip(none) {
            assert!(off(some, none) < 1e-9, "{omega_r} {some} {none}");
        }
    }
}
