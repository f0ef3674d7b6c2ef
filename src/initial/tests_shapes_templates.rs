//! The rows of each shape against its published bispectrum.

use std::vec;
use std::vec::Vec;

use super::shape::{Quadratic, Shape, ShapeRow};
use super::tests_shapes::apply;
use crate::exec::Serial;
use crate::mesh::{Brick, Space};
use crate::reference::built::serial;
use crate::reference::shape::{close, template, tree_level};

const N: usize = 16;

/// The place of a mode in a whole mesh, which holds l >= 0.
fn place([i, j, l]: [i64; 3]) -> usize {
    let index = |m: i64| m.rem_euclid(N as i64) as usize;
    2 * ((index(i) * N + index(j)) * (N / 2 + 1) + l as usize)
}

/// Two real waves of unit amplitude.
fn waves(modes: [[i64; 3]; 2]) -> Vec<f64> {
    let mut field = vec![0.0; Brick::whole(N, Space::Fourier).unwrap().reals()];
    for mode in modes {
        for mode in [mode, mode.map(|m| -m)] {
            if mode[2] >= 0 {
                field[place(mode)] = 1.0;
            }
        }
    }
    field
}

/// What the engine adds to the mode a + b of two waves: its kernel.
fn measured(shape: Shape, n_s: f64, [a, b]: [[i64; 3]; 2]) -> f64 {
    let brick = Brick::whole(N, Space::Fourier).unwrap();
    let term = Quadratic { f_nl: 1.0, rows: shape.rows(), n_s };
    let field = apply(&waves([a, b]), &brick, &term, &mut serial::<f64>(3 * N / 2), &Serial).unwrap();
    let sum: [i64; 3] = core::array::from_fn(|i| a[i] + b[i]);
    let at = place(if sum[2] < 0 { sum.map(|m| -m) } else { sum });
    assert!(field[at + 1].abs() < 1e-12 * (1.0 + field[at].abs()), "real waves have a real product");
    field[at]
}

fn length(mode: [i64; 3]) -> f64 {
    libm::sqrt(mode.iter().map(|m| m * m).sum::<i64>() as f64)
}

/// The sum of what cancels in a bispectrum: rounding is relative to that.
fn size(shape: Shape, n_s: f64, k: [f64; 3]) -> f64 {
    let positive = |row: &ShapeRow| ShapeRow { coefficient: row.coefficient.abs(), ..*row };
    tree_level(&shape.rows().iter().map(positive).collect::<Vec<_>>(), n_s, k)
}

#[test]
fn the_engine_gives_the_bispectrum_of_the_template_on_every_triangle() {
    // Equilateral, squeezed, flattened, isosceles, and two of no kind.
    let triangles = [
        [[3, -3, 0], [0, 3, -3]],
        [[1, 0, 0], [0, 5, 4]],
        [[2, 0, 0], [3, 0, 0]],
        [[0, 0, 2], [5, 1, -1]],
        [[1, 2, 3], [2, -1, 1]],
        [[-4, 0, 3], [1, 2, 1]],
    ];
    for shape in Shape::ALL {
        for n_s in [1.0, 0.96, 0.9] {
            for [a, b] in triangles {
                let modes = [a, b, core::array::from_fn(|i| -a[i] - b[i])];
                let k = modes.map(length);
                let bispectrum = close(n_s, k, |[a, b, _]| measured(shape, n_s, [modes[a], modes[b]]));
                let (expected, size) = (template(shape, n_s, k), size(shape, n_s, k));
                // Transforms in f64, each of three kernels relative to its largest mode.
                let error = (bispectrum - expected).abs() / size;
                assert!(error < 1e-13, "{shape:?}, n_s = {n_s}, {modes:?}: {error}");
            }
        }
    }
}

#[test]
fn rows_and_templates_agree_for_any_sides() {
    for shape in Shape::ALL {
        for n_s in [1.0, 0.96, 0.9, 1.2] {
            for i in 0..200 {
                let random = |j: usize| libm::fmod(0.618_034 * (3 * i + j) as f64, 1.0);
                let k = [0, 1, 2].map(|j| libm::exp(6.0 * random(j) * random(j + 1) - 3.0));
                let error = (tree_level(shape.rows(), n_s, k) - template(shape, n_s, k)).abs();
                assert!(error < 1e-13 * size(shape, n_s, k), "{shape:?}, {k:?}: {error}");
            }
        }
    }
}

#[test]
fn equal_sides_and_flattened_ones_have_the_values_of_the_literature() {
    // B k^6 = 6 f_NL of equal sides is how f_NL of equilateral and both orthogonal shapes is defined, up to the sign of the CMB template.
    let equal = Shape::ALL.map(|shape| template(shape, 1.0, [1.0; 3]) / 6.0);
    for (value, expected) in equal.into_iter().zip([1.0, 1.0, 1.0, 1.0, 0.0]) {
        assert!((value - expected).abs() < 1e-13, "{value} and {expected}");
    }
    // Sides 1, 1, 2: the equilateral template has (k1 + k2 - k3) as a factor, and the folded one is half a local one there.
    let flat = [1.0, 1.0, 2.0];
    assert!(template(Shape::Equilateral, 1.0, flat).abs() < 1e-13);
    assert!(template(Shape::Folded, 1.0, flat) > 0.0 && template(Shape::Orthogonal, 1.0, flat) < 0.0);
    // folded = (equilateral - orthogonal)/2.
    for k in [[1.0; 3], flat, [1.0, 3.0, 3.5]] {
        let [equilateral, orthogonal, folded] = [Shape::Equilateral, Shape::Orthogonal, Shape::Folded]
            .map(|shape| tree_level(shape.rows(), 0.96, k));
        assert!((0.5 * (equilateral - orthogonal) - folded).abs() < 1e-13 * size(Shape::Orthogonal, 0.96, k));
    }
}

#[test]
fn squeezed_limits_are_those_that_halos_see() {
    // Sides (q, 1, 1): B -> c q^slope. Local bias 1/k^2 comes with q^-3; one power of q more makes it 1/k, two make it none.
    // The next terms are q or q^2 times as large.
    let q = 1e-3;
    let expected = [
        (Shape::Local, -3, 4.0),
        (Shape::Equilateral, -1, 12.0),
        (Shape::Orthogonal, -2, -12.0),
        (Shape::Folded, -2, 6.0),
    ];
    for (shape, slope, coefficient) in expected {
        let measured = template(shape, 1.0, [q, 1.0, 1.0]) / libm::pow(q, f64::from(slope));
        assert!((measured / coefficient - 1.0).abs() < 4.0 * q, "{shape:?}: {measured}");
    }
    // With k2 - k3 = q mu, D -> 2 q^2 (1 - mu^2) and G -> 4 q/3: q B -> 12 (1 + p) (1 - mu^2) - 128 p/9.
    let pi = core::f64::consts::PI;
    let p = 27.0 / (743.0 / (7.0 * (20.0 * pi * pi - 193.0)) - 21.0);
    for mu in [0.0, 0.5, 1.0] {
        let k = [q, 1.0 + 0.5 * q * mu, 1.0 - 0.5 * q * mu];
        let lss = q * template(Shape::OrthogonalLss, 1.0, k);
        let equilateral = q * template(Shape::Equilateral, 1.0, k);
        let expected = 12.0 * (1.0 + p) * (1.0 - mu * mu) - 128.0 * p / 9.0;
        assert!((lss - expected).abs() < 200.0 * q, "mu = {mu}: {lss} and {expected}");
        assert!((equilateral - 12.0 * (1.0 - mu * mu)).abs() < 20.0 * q, "mu = {mu}: {equilateral}");
    }
}
