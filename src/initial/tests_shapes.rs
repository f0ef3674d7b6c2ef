//! The engine of separable kernels against direct sums, and what it leaves alone.

use std::sync::Mutex;
use std::vec;
use std::vec::Vec;

use super::shape::{LARGEST_EXPONENT, Quadratic, Shape, ShapeRow, add_quadratic, add_quadratic_scratch};
use super::tests::jumble;
use crate::cosmology::mode_table_length;
use crate::exec::{Exec, Serial, Threads};
use crate::fft::Fft3;
use crate::mesh::{Brick, Space};
use crate::real::Real;
use crate::reference::built::{serial, transform};
use crate::reference::convolution::Dense;
use crate::reference::parts::{Meeting, Part, gather, scatter};
use crate::reference::shape::product;
use crate::reference::transform::Slow;
use crate::status::{Error, Result};

const fn row(coefficient: f64, s_out: f64, s_a: f64, s_b: f64) -> ShapeRow {
    ShapeRow { coefficient, s_out, s_a, s_b }
}

/// Rows that meet every way through the engine: nothing held, the first or the second factor held, a square that joins and one that does
/// not, no coefficient.
const OWN: [ShapeRow; 7] = [
    row(1.5, 0.5, -1.25, 0.75),
    row(-2.0, 0.5, -1.0, 0.5),
    row(0.7, 1.5, -0.5, -1.0),
    row(0.3, 1.5, -0.75, -0.75),
    row(5.0, 0.0, 0.0, 0.0),
    row(0.0, 1.0, -3.0, 2.0),
    row(1.1, 1.5, -1.0, -0.5),
];

pub(super) fn apply<T: Real>(
    phi: &[T],
    brick: &Brick,
    quadratic: &Quadratic<'_>,
    work: &mut dyn Fft3<T>,
    exec: &dyn Exec,
) -> Result<Vec<T>> {
    // What scratch holds before does not matter.
    let nan = T::from_f64(f64::NAN);
    let (mut one, mut two) = (vec![nan; work.length()], vec![nan; work.length()]);
    let (mut sum, mut out) = (vec![nan; brick.reals()], phi.to_vec());
    let mut table = vec![f64::NAN; mode_table_length(brick.n())?];
    let outcome =
        add_quadratic(&mut out, brick, quadratic, work, [&mut one, &mut two], &mut sum, &mut table, exec);
    if outcome.is_err() {
        assert!(out == phi, "an error leaves the modes as they were");
    }
    outcome.map(|()| out)
}

fn whole(n: usize) -> Brick {
    Brick::whole(n, Space::Fourier).unwrap()
}

#[test]
fn every_shape_equals_the_direct_sum() {
    // Sides that the transform has, 3n/2 or more.
    let side = |n: usize| n.div_ceil(4) * 6;
    for (n, n_s) in [(8, 1.0), (8, 0.96), (8, 0.9), (10, 0.96), (16, 0.96)] {
        let phi = jumble(n, 11);
        let gaussian = Dense::from_mesh(&phi, n);
        let single: Vec<f32> = phi.iter().map(|&v| v as f32).collect();
        // Shapes share most of their products.
        let mut known: Vec<(ShapeRow, Dense)> = Vec::new();
        let mut direct = |row: &ShapeRow| {
            let row = ShapeRow { coefficient: 1.0, ..*row };
            let at = known.iter().position(|(other, _)| *other == row).unwrap_or_else(|| {
                known.push((row, product(&gaussian, &row, n_s)));
                known.len() - 1
            });
            known[at].1.clone()
        };
        let shapes = Shape::ALL.map(Shape::rows);
        for rows in shapes.into_iter().chain((n < 16).then_some(&OWN[..])) {
            let add = |sum: Dense, row: &ShapeRow| sum.plus(0.37 * row.coefficient, &direct(row));
            let expected = rows.iter().fold(gaussian.clone(), add);
            let term = Quadratic { f_nl: 0.37, rows, n_s };
            let actual = apply(&phi, &whole(n), &term, &mut serial::<f64>(side(n)), &Serial).unwrap();
            let error = expected.distance(&Dense::from_mesh(&actual, n));
            // Of a white field the products are far larger than what is left of them, where X_2 meets X_-1 most of all: 1e-15 for the local
            // shape, 2e-13 for the orthogonal one of eight rows.
            assert!(error < 4e-13, "n = {n}, {rows:?}: {error}");
            let actual = apply(&single, &whole(n), &term, &mut serial::<f32>(side(n)), &Serial).unwrap();
            let actual: Vec<f64> = actual.into_iter().map(f64::from).collect();
            let error = expected.distance(&Dense::from_mesh(&actual, n));
            // 3e-7 and 2e-5.
            assert!(error < 5e-5, "n = {n}, {rows:?}: {error}");
        }
    }
}

#[test]
fn aliasing_is_real_without_a_work_mesh() {
    let n = 8;
    let phi = jumble(n, 3);
    for shape in Shape::ALL {
        let term = Quadratic { f_nl: 1.0, rows: shape.rows(), n_s: 0.96 };
        let [clean, aliased] = [12, 8].map(|side| {
            Dense::from_mesh(&apply(&phi, &whole(n), &term, &mut Slow::new(side), &Serial).unwrap(), n)
        });
        assert!(clean.distance(&aliased) > 1e-3, "{shape:?}");
    }
}

/// Counts transforms.
struct Counting {
    inner: Slow,
    inverse: usize,
    forward: usize,
}

impl Fft3<f64> for Counting {
    fn configuration(&self) -> &Brick {
        Fft3::<f64>::configuration(&self.inner)
    }

    fn fourier(&self) -> &Brick {
        Fft3::<f64>::fourier(&self.inner)
    }

    fn length(&self) -> usize {
        Fft3::<f64>::length(&self.inner)
    }

    fn forward(&mut self, data: &mut [f64]) -> Result<()> {
        self.forward += 1;
        self.inner.forward(data)
    }

    fn inverse(&mut self, data: &mut [f64]) -> Result<()> {
        self.inverse += 1;
        self.inner.inverse(data)
    }
}

#[test]
fn the_shapes_need_as_many_transforms_as_documented() {
    let n = 4;
    let expected = [[1, 1], [4, 3], [4, 3], [8, 6], [4, 3]];
    for (shape, expected) in Shape::ALL.into_iter().zip(expected) {
        let mut work = Counting { inner: Slow::new(6), inverse: 0, forward: 0 };
        let term = Quadratic { f_nl: 1.0, rows: shape.rows(), n_s: 0.96 };
        apply(&jumble(n, 1), &whole(n), &term, &mut work, &Serial).unwrap();
        assert_eq!([work.inverse, work.forward], expected, "{shape:?}");
    }
}

#[test]
fn no_coefficient_keeps_every_bit() {
    let n = 8;
    let mut phi = jumble(n, 4);
    phi[40] = -0.0;
    let bits = |modes: &[f64]| modes.iter().map(|v| v.to_bits()).collect::<Vec<_>>();
    let nothing = [row(0.0, 0.0, 0.0, 0.0)];
    for (f_nl, rows) in [(0.0, Shape::Equilateral.rows()), (5.0, &[]), (5.0, &nothing[..])] {
        let term = Quadratic { f_nl, rows, n_s: 0.96 };
        let out = apply(&phi, &whole(n), &term, &mut Slow::new(12), &Serial).unwrap();
        assert_eq!(bits(&out), bits(&phi));
    }
}

#[test]
fn mean_and_nyquist_modes_receive_nothing() {
    let n = 8;
    let mut phi = jumble(n, 5);
    // A mean of the input is none of the potential's fluctuations.
    phi[0] = 1e6;
    let clean = {
        let mut clean = phi.clone();
        clean[0] = 0.0;
        clean
    };
    for shape in Shape::ALL {
        let term = Quadratic { f_nl: 1.0, rows: shape.rows(), n_s: 0.96 };
        let of = |phi: &[f64]| apply(phi, &whole(n), &term, &mut Slow::new(12), &Serial).unwrap();
        let (with, without) = (of(&phi), of(&clean));
        assert_eq!(with[..2], [1e6, 0.0]);
        assert_eq!(with[2..], without[2..]);
        for (at, mode) in with.chunks_exact(2).enumerate() {
            let index = [at / (n * (n / 2 + 1)), at / (n / 2 + 1) % n, at % (n / 2 + 1)];
            if index.contains(&(n / 2)) {
                assert_eq!(mode, [0.0; 2]);
            }
        }
    }
}

#[test]
fn inverted_is_minus_the_gaussian_and_the_same_term_bit_for_bit() {
    let n = 8;
    let phi = jumble(n, 6);
    let minus: Vec<f64> = phi.iter().map(|v| -v).collect();
    for rows in Shape::ALL.map(Shape::rows).into_iter().chain([&OWN[..]]) {
        let term = |f_nl: f64| Quadratic { f_nl, rows, n_s: 0.96 };
        let of = |phi: &[f64], f_nl: f64| {
            apply(phi, &whole(n), &term(f_nl), &mut serial::<f64>(12), &Serial).unwrap()
        };
        // -(phi + f q) = -phi + (-f) q: rounding is symmetric, so these are equal if and only if q is.
        let flipped: Vec<f64> = of(&phi, -3.0).iter().map(|v| -v).collect();
        assert!(flipped == of(&minus, 3.0));
    }
}

#[test]
fn threads_and_layouts_do_not_change_a_bit() {
    let n = 16;
    let phi = jumble(n, 7);
    let columns = Brick::general(n, Space::Fourier, [0; 3], [n, n, n / 2 + 1], [1, n, n * n]).unwrap();
    let mut turned = vec![0.0; columns.reals()];
    super::modes::copy_modes(&mut turned, &columns, &phi, &whole(n), &Serial).unwrap();
    for shape in Shape::ALL {
        let term = Quadratic { f_nl: 0.5, rows: shape.rows(), n_s: 0.96 };
        let expected = apply(&phi, &whole(n), &term, &mut serial::<f64>(24), &Serial).unwrap();
        for threads in [1, 2, 5] {
            let pool = std::boxed::Box::leak(std::boxed::Box::new(Threads::new(threads).unwrap()));
            let mut work = transform::<f64>(24, pool);
            assert!(apply(&phi, &whole(n), &term, &mut work, pool).unwrap() == expected);
        }
        let out = apply(&turned, &columns, &term, &mut serial::<f64>(24), &Serial).unwrap();
        let mut back = vec![0.0; phi.len()];
        super::modes::copy_modes(&mut back, &whole(n), &out, &columns, &Serial).unwrap();
        assert!(back == expected);
    }
}

#[test]
fn slabs_hold_the_modes_of_the_whole() {
    let (n, side) = (8, 12);
    let phi = jumble(n, 8);
    // Slabs of both meshes with the same modes below n/2: rows 0..4 and 4..8 of one are 0..6 and 6..12 of the other.
    let rows = [[(0, 4), (0, 6)], [(4, 4), (6, 6)]];
    for (shape, dealiased) in
        [(Shape::Local, false), (Shape::Equilateral, true), (Shape::OrthogonalLss, true)]
    {
        let term = Quadratic { f_nl: 0.5, rows: shape.rows(), n_s: 0.96 };
        let m = if dealiased { side } else { n };
        let expected = apply(&phi, &whole(n), &term, &mut serial::<f64>(m), &Serial).unwrap();
        let meeting = Meeting::new(m, 2);
        let result = Mutex::new(vec![0.0; phi.len()]);
        std::thread::scope(|scope| {
            for [own, work] in rows {
                let (meeting, phi, result, term) = (&meeting, &phi, &result, &term);
                scope.spawn(move || {
                    let brick = Brick::transposed_slab(n, own.0, own.1).unwrap();
                    let (first, count) = if dealiased { work } else { own };
                    let cells = Brick::slab(m, Space::Configuration, first, count).unwrap();
                    let modes = Brick::transposed_slab(m, first, count).unwrap();
                    let mut process = Part::new(meeting, first == 0, cells, modes);
                    let mut part = vec![0.0; brick.reals()];
                    scatter(&brick, &mut part, phi);
                    let out = apply(&part, &brick, term, &mut process, &Serial).unwrap();
                    gather(&brick, &out, &mut result.lock().unwrap());
                });
            }
        });
        assert!(*result.lock().unwrap() == expected, "{shape:?}");
    }
}

#[test]
fn what_is_no_kernel_is_refused() {
    let n = 8;
    let phi = jumble(n, 9);
    let refused = |f_nl: f64, rows: &[ShapeRow], n_s: f64, side: usize| {
        let term = Quadratic { f_nl, rows, n_s };
        apply(&phi, &whole(n), &term, &mut Slow::new(side), &Serial).err()
    };
    let local = Shape::Local.rows();
    assert_eq!(refused(f64::NAN, local, 1.0, 12), Some(Error::NotFinite));
    assert_eq!(refused(1.0, local, f64::INFINITY, 12), Some(Error::NotFinite));
    assert_eq!(refused(1.0, local, 10.1, 12), Some(Error::Range));
    for bad in [row(f64::NAN, 0.0, 0.0, 0.0), row(1.0, f64::INFINITY, 0.0, 0.0), row(1.0, 0.0, 0.0, f64::NAN)]
    {
        assert_eq!(refused(1.0, &[local[0], bad], 1.0, 12), Some(Error::NotFinite));
    }
    assert_eq!(refused(1.0, &[row(1.0, 1.0, 0.0, -0.999)], 1.0, 12), Some(Error::Range), "it has a unit");
    let large = LARGEST_EXPONENT + 1.0;
    assert_eq!(refused(1.0, &[row(1.0, 0.0, large, -large)], 1.0, 12), Some(Error::Range));
    // 8^(8 x 14/3) is beyond 1e18.
    assert_eq!(refused(1.0, &[row(1.0, 0.0, 8.0, -8.0)], -10.0, 12), Some(Error::Range));
    assert_eq!(refused(1.0, local, 1.0, 10), Some(Error::Brick), "half dealiased");
    assert_eq!(refused(1.0, &[row(1.0, 0.0, 8.0, -8.0)], 1.0, 12), None);

    let brick = whole(n);
    let mut work = Slow::new(12);
    let length = Fft3::<f64>::length(&work);
    let term = Quadratic { f_nl: 1.0, rows: local, n_s: 1.0 };
    let entries = mode_table_length(n).unwrap();
    let mut attempt = |missing: [usize; 5]| {
        let mut modes = phi[missing[0]..].to_vec();
        let (mut one, mut two) = (vec![0.0; length - missing[1]], vec![0.0; length - missing[2]]);
        let (mut sum, mut table) = (vec![0.0; phi.len() - missing[3]], vec![0.0; entries - missing[4]]);
        let meshes = [&mut one[..], &mut two[..]];
        add_quadratic(&mut modes, &brick, &term, &mut work, meshes, &mut sum, &mut table, &Serial)
    };
    assert_eq!(attempt([0; 5]), Ok(()));
    for short in 0..5 {
        let mut missing = [0; 5];
        missing[short] = 1;
        assert_eq!(attempt(missing), Err(Error::Length), "{short}");
    }
    assert_eq!([-1, 5].map(Shape::try_from), [Err(Error::Choice); 2]);
    assert!((0..5).all(|number| Shape::try_from(number).unwrap() as i32 == number));
}

#[test]
fn scratch_is_two_meshes_the_modes_and_a_table() {
    let n = 16;
    let rounded = |bytes: usize| bytes.next_multiple_of(64);
    let work = serial::<f32>(24);
    let expected = 2 * rounded(4 * work.length()) + rounded(4 * whole(n).reals()) + rounded(8 * (3 * 64 + 1));
    assert_eq!(add_quadratic_scratch(&whole(n), &work).unwrap().size, expected);
}
