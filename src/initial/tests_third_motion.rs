//! Claims about third-order displacements: each order with its own rate, the sphere, and the equation of motion.

use std::vec;
use std::vec::Vec;

use super::displacements::{Motion, Order, Work, displacements, rest_length, table_length};
use super::lpt::displacement;
use super::shifted::half_cells_length;
use super::tests::jumble;
use super::tests_third::{modes_of, sources_by};
use super::third::transverse_displacement;
use crate::cosmology::{Cosmology, Growth, growth};
use crate::exec::{Exec, Serial, Threads};
use crate::fft::{Fft3, Transform};
use crate::mesh::Brick;
use crate::real::Real;
use crate::reference::built::serial;
use crate::reference::convolution::Dense;
use crate::status::Error;

/// Fields of three components on cells.
type Vector<T> = [Vec<T>; 3];

/// Rates and sizes of no universe, all different.
const ODD: Motion = Motion {
    box_size: 100.0,
    velocity: 30.0,
    rates: [0.9, 1.7],
    second_order: -0.43,
    third_order: [-0.31, 0.23, 0.15],
    third_rates: [2.6, 2.8, 3.1],
};

const EINSTEIN_DE_SITTER: Motion = Motion {
    box_size: core::f64::consts::TAU,
    velocity: 1.0,
    rates: [1.0, 2.0],
    second_order: -3.0 / 7.0,
    third_order: [-1.0 / 3.0, 5.0 / 21.0, 1.0 / 7.0],
    third_rates: [3.0; 3],
};

/// The two fields of `displacements`.
fn fields<T: Real>(
    density: &[T],
    n: usize,
    order: Order,
    motion: &Motion,
    exec: &dyn Exec,
) -> [Vector<T>; 2] {
    let mut fft = serial::<T>(n);
    let mut density = density.to_vec();
    let mut source = vec![T::from_f64(f64::NAN); fft.length()];
    let mut rest = vec![T::from_f64(f64::NAN); rest_length(order, false, &fft, None)];
    let mut table = vec![[f64::NAN; 2]; table_length(order, n)];
    let mut out = [(); 2].map(|()| [(); 3].map(|()| vec![T::ZERO; fft.length()]));
    let mut place = |axis: usize, first: &[T], second: Option<&[T]>| {
        out[0][axis].copy_from_slice(first);
        if let Some(second) = second {
            out[1][axis].copy_from_slice(second);
        }
        Ok(())
    };
    let work = Work { source: &mut source, rest: &mut rest, table: &mut table };
    displacements(&mut density, order, motion, None, &mut fft, None, work, &mut place, exec).unwrap();
    out
}

/// Psi1, Psi2, Psi3a, Psi3b and Psi3c, each by itself.
fn parts(density: &[f64], n: usize, motion: &Motion) -> [Vector<f64>; 5] {
    let mut fft = serial::<f64>(n);
    let brick = *fft.fourier();
    let [second, determinant, mixed, curl @ ..] = sources_by(density, &mut fft, &Serial);
    let unit = motion.box_size / core::f64::consts::TAU;
    let [d3a, d3b, d3c] = motion.third_order;
    let mut along = |source: &[f64], scale: f64| {
        [0, 1, 2].map(|axis| {
            let mut out = vec![0.0; fft.length()];
            displacement(&mut out, source, &brick, axis, scale * unit, &mut fft, &Serial).unwrap();
            out
        })
    };
    let first = along(density, 1.0);
    let second = along(&second, -motion.second_order);
    let (third_a, third_b) = (along(&determinant, d3a), along(&mixed, d3b));
    let third_c = [0, 1, 2].map(|axis| {
        let mut out = vec![0.0; fft.length()];
        let curl = curl.each_ref().map(Vec::as_slice);
        transverse_displacement(&mut out, curl, axis, d3c * unit, &mut fft, &Serial).unwrap();
        out
    });
    [first, second, third_a, third_b, third_c]
}

/// Indices of the cells in an array.
fn cells(n: usize) -> impl Iterator<Item = usize> {
    let stride = serial::<f64>(n).configuration().stride();
    (0..n * n * n).map(move |at| at / (n * n) * stride[0] + at / n % n * stride[1] + at % n * stride[2])
}

#[test]
fn every_order_has_its_own_place_and_velocity() {
    let n = 8;
    let density: Vec<f64> = jumble(n, 31).iter().map(|v| 1e-3 * v).collect();
    let Motion { rates: [f1, f2], third_rates: [f3a, f3b, f3c], .. } = ODD;
    let parts = parts(&density, n, &ODD);
    for (order, weights) in [(Order::First, [1.0, 0.0, 0.0, 0.0, 0.0]), (Order::Third, [1.0; 5])] {
        let [one, two] = fields(&density, n, order, &ODD, &Serial);
        let mut worst = [0.0_f64; 2];
        let mut size = [0.0_f64; 2];
        for axis in 0..3 {
            for at in cells(n) {
                let psi: [f64; 5] = core::array::from_fn(|part| weights[part] * parts[part][axis][at]);
                let place: f64 = psi.iter().sum();
                let speed =
                    psi.iter().zip([f1, f2, f3a, f3b, f3c]).map(|(psi, rate)| psi * rate).sum::<f64>();
                let (first, second) = (one[axis][at], two[axis][at]);
                let found = [first + second, f1 * first + f2 * second];
                for (i, expected) in [place, speed].into_iter().enumerate() {
                    worst[i] = worst[i].max((found[i] - expected).abs());
                    size[i] = size[i].max(expected.abs());
                }
            }
        }
        // Roundings of the shares of the two fields, which are up to three times what they share.
        assert!(worst[0] < 1e-14 * size[0] && worst[1] < 1e-14 * size[1], "{order:?} {worst:?} {size:?}");
    }
}

#[test]
fn displacements_have_the_same_bits_on_any_number_of_threads_and_in_single_precision_nearly() {
    let n = 8;
    let density: Vec<f64> = jumble(n, 32).iter().map(|v| 1e-3 * v).collect();
    let one = fields(&density, n, Order::Third, &ODD, &Serial);
    for threads in [1, 2, 5] {
        assert_eq!(one, fields(&density, n, Order::Third, &ODD, &Threads::new(threads).unwrap()));
    }
    let single: Vec<f32> = density.iter().map(|&x| x as f32).collect();
    let single = fields(&single, n, Order::Third, &ODD, &Serial);
    let size = one[0][0].iter().fold(0.0_f64, |size, x| size.max(x.abs()));
    for (double, single) in one.iter().flatten().zip(single.iter().flatten()) {
        for at in cells(n) {
            // Some tens of roundings of 6e-8.
            assert!((double[at] - f64::from(single[at])).abs() < 5e-6 * size);
        }
    }
}

/// Derivative along an axis, in units of 2 pi/L.
fn derivative(field: &[f64], axis: usize, fft: &mut Transform<'static, f64>) -> Vec<f64> {
    let brick: Brick = *fft.fourier();
    let (n, count, stride) = (brick.n(), brick.count(), brick.stride());
    let mut out = field.to_vec();
    fft.forward(&mut out).unwrap();
    for at in 0..brick.elements() {
        let index = [at / (count[1] * count[2]), at / count[2] % count[1], at % count[2]];
        let place = 2 * (0..3).map(|a| index[a] * stride[a]).sum::<usize>();
        let k = if index[axis] == n / 2 { 0.0 } else { Brick::mode(n, index[axis]) as f64 };
        let scale = k / (n * n * n) as f64;
        (out[place], out[place + 1]) = (-scale * out[place + 1], scale * out[place]);
    }
    fft.inverse(&mut out).unwrap();
    out
}

/// d_b of component a, by \[a\]\[b\].
fn gradient(vector: &Vector<f64>, n: usize) -> [Vector<f64>; 3] {
    let mut fft = serial::<f64>(n);
    vector.each_ref().map(|component| [0, 1, 2].map(|axis| derivative(component, axis, &mut fft)))
}

#[test]
fn longitudinal_parts_have_no_curl_and_the_transverse_part_no_divergence() {
    let n = 16;
    let density = Dense::from_mesh(&jumble(6, 33), 6).to_mesh(n);
    for (part, vector) in parts(&density, n, &ODD).iter().enumerate() {
        let g = gradient(vector, n);
        let size = g.iter().flatten().flatten().fold(0.0_f64, |m, x| m.max(x.abs()));
        for at in cells(n) {
            if part < 4 {
                for (a, b) in [(0, 1), (1, 2), (2, 0)] {
                    assert!((g[a][b][at] - g[b][a][at]).abs() < 1e-13 * size, "{part}");
                }
            } else {
                let divergence = g[0][0][at] + g[1][1][at] + g[2][2][at];
                assert!(divergence.abs() < 1e-13 * size, "{divergence} {size}");
            }
        }
    }
}

#[test]
fn a_sphere_contracts_as_the_exact_solution_expanded() {
    // At the origin three equal crossed waves are isotropic in every order: the neighbourhood moves as a sphere does.
    let n = 8;
    for delta in [0.3, -0.6, 1.2] {
        let density = modes_of(n, |[x, y, z]| delta / 3.0 * (x.cos() + y.cos() + z.cos()));
        let [one, two] = fields(&density, n, Order::Third, &EINSTEIN_DE_SITTER, &Serial);
        let both: Vector<f64> =
            core::array::from_fn(|a| one[a].iter().zip(&two[a]).map(|(x, y)| x + y).collect());
        let g = gradient(&both, n);
        let radius = 1.0 - delta / 3.0 - delta * delta / 21.0 - 23.0 * delta * delta * delta / 1701.0;
        for a in 0..3 {
            for b in 0..3 {
                let expected = if a == b { radius - 1.0 } else { 0.0 };
                assert!((g[a][b][0] - expected).abs() < 1e-14, "{a}{b}: {} {expected}", g[a][b][0]);
            }
        }
    }
}

/// Sizes of what the equation of motion leaves of displacements of each order, over (3/2) Om(a).
///
/// Gravity, D'' + (2 + dlnE/dlna) D' = T D, of a flow x = q + Psi without streams crossing is curl-free and has Poisson's divergence,
/// nabla_x . T Psi = -(3/2) Om (1/J - 1) and nabla_x x T Psi = 0. In Lagrangian coordinates, with F = dx/dq and A = T Psi/((3/2) Om),
///
/// ```text
/// cof(F)_ij d_j A_i = det F - 1,      eps_ijk F_lj d_k A_l = 0
/// ```
///
/// on each cell: polynomials of the displacements, in which no force is approximated. T acts on each part as its growth equation says.
fn residuals(density: &[f64], n: usize, now: &Growth) -> [[f64; 2]; 3] {
    let Growth { d, d2, d3a, d3b, d3c, f, f2, f3a, f3b, f3c } = *now;
    let (square, cube) = (d * d, d * d * d);
    let motion = Motion {
        rates: [f, f2],
        second_order: d2 / square,
        third_order: [d3a, d3b, d3c].map(|d3| d3 / cube),
        third_rates: [f3a, f3b, f3c],
        ..EINSTEIN_DE_SITTER
    };
    let pulled = [1.0, (d2 - square) / d2, (d3a - 2.0 * cube) / d3a, (d3b + cube - d * d2) / d3b, cube / d3c];
    let gradients = parts(density, n, &motion).map(|part| gradient(&part, n));
    [1, 2, 5].map(|orders| {
        let mut worst = [0.0_f64; 2];
        for at in cells(n) {
            let mut flow = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
            let mut pull = [[0.0; 3]; 3];
            for (g, factor) in gradients.iter().zip(pulled).take(orders) {
                for a in 0..3 {
                    for b in 0..3 {
                        flow[a][b] += g[a][b][at];
                        pull[a][b] += factor * g[a][b][at];
                    }
                }
            }
            let [along, across] = equation(&flow, &pull);
            worst = [worst[0].max(along), worst[1].max(across)];
        }
        worst
    })
}

fn equation(flow: &[[f64; 3]; 3], pull: &[[f64; 3]; 3]) -> [f64; 2] {
    let next = |a: usize| ((a + 1) % 3, (a + 2) % 3);
    let cofactor = |i: usize, j: usize| {
        let ((a, b), (c, d)) = (next(i), next(j));
        flow[a][c] * flow[b][d] - flow[a][d] * flow[b][c]
    };
    let determinant: f64 = (0..3).map(|j| flow[0][j] * cofactor(0, j)).sum();
    let divergence: f64 = (0..9).map(|ij| cofactor(ij / 3, ij % 3) * pull[ij / 3][ij % 3]).sum();
    let curl = (0..3).map(|i| {
        let (j, k) = next(i);
        (0..3).map(|l| flow[l][j] * pull[l][k] - flow[l][k] * pull[l][j]).sum::<f64>()
    });
    [(divergence - (determinant - 1.0)).abs(), curl.fold(0.0, |worst, curl| f64::max(worst, curl.abs()))]
}

#[test]
fn what_the_equation_of_motion_leaves_of_each_order_is_the_next() {
    // Modes up to 2 of a mesh of 16: those of the third order reach 6, so that none is lost.
    let n = 16;
    let field = Dense::from_mesh(&jumble(6, 34), 6).to_mesh(n);
    let rms = field.chunks_exact(2).map(|m| m[0] * m[0] + m[1] * m[1]).sum::<f64>().sqrt();
    for cosmology in
        [Cosmology::goliat(), Cosmology { omega_m: 0.3, omega_de: 0.5, omega_r: 9e-5, ..Cosmology::goliat() }]
    {
        let latest = growth(&cosmology, 0.1).unwrap().d;
        let at = |a: f64| {
            let now = growth(&cosmology, a).unwrap();
            // Small enough that two orders more are 1% of the next.
            let density: Vec<f64> = field.iter().map(|v| 0.004 * now.d / latest / rms * v).collect();
            (now.d, residuals(&density, n, &now))
        };
        let (early, late) = (at(0.02), at(0.1));
        let slope = |order: usize, kind: usize| {
            (late.1[order][kind] / early.1[order][kind]).ln() / (late.0 / early.0).ln()
        };
        for order in 0..3 {
            let expected = (order + 2) as f64;
            assert!((slope(order, 0) - expected).abs() < 0.03, "order {}: {}", order + 1, slope(order, 0));
        }
        // The first order by itself is free of vorticity; the second is not, from the third power of the density on.
        assert!(late.1[0][1] < 1e-16);
        assert!((slope(1, 1) - 3.0).abs() < 0.03 && (slope(2, 1) - 4.0).abs() < 0.03);
    }
}

#[test]
fn senseless_motions_are_refused() {
    let n = 8;
    let mut fft = serial::<f64>(n);
    let length = fft.length();
    let long = rest_length(Order::Third, false, &fft, None);
    let mut attempt = |motion: Motion, rest: usize, entries: usize| {
        let mut density = vec![1.0; length];
        let (mut source, mut rest) = (vec![0.0; length], vec![0.0; rest]);
        let mut table = vec![[0.0; 2]; entries];
        let work = Work { source: &mut source, rest: &mut rest, table: &mut table };
        let place = &mut |_: usize, _: &[f64], _: Option<&[f64]>| Ok(());
        displacements(&mut density, Order::Third, &motion, None, &mut fft, None, work, place, &Serial)
    };
    let entries = half_cells_length(n);
    assert_eq!(attempt(ODD, long, entries), Ok(()));
    assert_eq!(attempt(ODD, long - 1, entries), Err(Error::Length));
    assert_eq!(attempt(ODD, long, entries - 1), Err(Error::Length));
    let nan = f64::NAN;
    assert_eq!(attempt(Motion { velocity: nan, ..ODD }, long, entries), Err(Error::NotFinite));
    assert_eq!(attempt(Motion { third_order: [nan; 3], ..ODD }, long, entries), Err(Error::NotFinite));
    // Two fields of one rate cannot hold a third.
    assert_eq!(attempt(Motion { rates: [1.0; 2], ..ODD }, long, entries), Err(Error::Range));
    assert_eq!(Order::try_from(4), Err(Error::Choice));
    assert_eq!(Order::try_from(3), Ok(Order::Third));
}
