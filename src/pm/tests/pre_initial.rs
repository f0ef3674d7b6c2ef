//! Claims about initial conditions of particles that begin anywhere.

use std::vec;
use std::vec::Vec;

use crate::cosmology::{Convention, Cosmology, EisensteinHu, Linear, Species, Wiggles};
use crate::exec::{Exec, Serial, Threads};
use crate::fft::{Fft3, Transform};
use crate::initial::conditions::{InitialConditions, Order, initial_conditions, initial_conditions_scratch};
use crate::initial::particles::Components;
use crate::initial::png::Local;
use crate::initial::shape::Shape;
use crate::mesh::Brick;
use crate::noise::{Amplitude, Realisation};
use crate::pm::pre_initial::{initial_conditions_at, initial_conditions_at_scratch};
use crate::pm::{Positions, Window, deposit_scratch};
use crate::real::Real;
use crate::reference::built::{Memory, serial};
use crate::reference::deposit::weight;
use crate::reference::parts::together;
use crate::status::{Error, Result};

const N: usize = 8;
const BOX: f64 = 200.0;
const ORDERS: [Order; 3] = [Order::First, Order::Second, Order::Third];

fn conditions(order: Order, species: Option<Species<'_>>) -> InitialConditions<'_> {
    let cosmology = Cosmology::goliat();
    let fit = EisensteinHu::new(&cosmology, Wiggles::With).unwrap();
    let linear = Linear::from_eisenstein_hu(fit, cosmology.n_s, 1.0).unwrap();
    InitialConditions {
        realisation: Realisation { amplitude: Amplitude::Fixed, ..Realisation::new(23) },
        cosmology,
        linear: linear.with_sigma8(0.8).unwrap(),
        redshift: 32.0,
        box_size: BOX,
        local: Local::default(),
        shape: Shape::Local.rows(),
        species,
        convention: Convention::Cmb,
        order,
    }
}

/// Positions and velocities of the lattice.
fn on_lattice(conditions: &InitialConditions<'_>) -> [Vec<f64>; 2] {
    let mut fft = serial::<f64>(N);
    let (mut x, mut v) = (vec![0.0; 3 * N * N * N], vec![0.0; 3 * N * N * N]);
    let mut scratch = Memory::new(initial_conditions_scratch(conditions.parts(), &fft, None).unwrap());
    let position = &mut Components::triples(&mut x).unwrap();
    let velocity = &mut Components::triples(&mut v).unwrap();
    initial_conditions(position, velocity, conditions, &mut fft, None, scratch.get(), &Serial).unwrap();
    [x, v]
}

/// Positions and velocities of particles that begin at q.
fn at<T: Real>(q: &[T], conditions: &InitialConditions<'_>, exec: &dyn Exec) -> Result<[Vec<T>; 2]> {
    let mut fft = serial::<T>(N);
    let (mut x, mut v) = (vec![T::ZERO; q.len()], vec![T::ZERO; q.len()]);
    let layout = initial_conditions_at_scratch(conditions.parts(), q.len() / 3, &fft, None)?;
    let mut scratch = Memory::new(layout);
    let position = &mut Components::triples(&mut x)?;
    let velocity = &mut Components::triples(&mut v)?;
    let q = Positions::triples(q)?;
    initial_conditions_at(position, velocity, &q, conditions, &mut fft, None, scratch.get(), exec)?;
    Ok([x, v])
}

/// The lattice, moved by a part of its spacing.
fn lattice(shift: [f64; 3]) -> Vec<f64> {
    let place = |i: usize, axis: usize| [i / (N * N), i / N % N, i % N][axis] as f64 + shift[axis];
    (0..3 * N * N * N).map(|i| place(i / 3, i % 3) * BOX / N as f64).collect()
}

/// Points without order, in the box and up to a box outside it.
fn scattered(count: usize) -> Vec<f64> {
    let mut state = 7_u64;
    let mut uniform = || {
        // Knuth's linear congruential generator.
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    };
    (0..3 * count).map(|_| (3.0 * uniform() - 1.0) * BOX).collect()
}

fn shortest(d: f64) -> f64 {
    d - BOX * (d / BOX).round()
}

fn species_columns() -> [Vec<f64>; 4] {
    let k: Vec<f64> = (0..20).map(|i| 1e-3 * 2_f64.powi(i)).collect();
    let law = |amplitude: f64, slope: f64| k.iter().map(|k| amplitude * k.powf(slope)).collect();
    [law(1.0, 1.0), law(1.0, -1.0), law(1.1, -1.1), law(0.9, -0.9)]
}

/// Every order, and cold matter at each.
fn all(columns: &[Vec<f64>; 4]) -> Vec<InitialConditions<'_>> {
    let [k, matter, density, velocity] = columns;
    let species = Species::new(k, matter, density, velocity, None).unwrap();
    ORDERS.into_iter().flat_map(|order| [conditions(order, None), conditions(order, Some(species))]).collect()
}

#[test]
fn particles_on_the_lattice_are_those_of_the_lattice() {
    let columns = species_columns();
    for conditions in all(&columns) {
        let [x, v] = on_lattice(&conditions);
        let [x_at, v_at] = at(&lattice([0.0; 3]), &conditions, &Serial).unwrap();
        let fastest = v.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
        for i in 0..x.len() {
            // Positions are rounded at the size of the box. The read-out's weights are 1 and 0 to a rounding of q in cells.
            assert!(shortest(x[i] - x_at[i]).abs() < 1e-13 * BOX, "{:?}", conditions.order);
            assert!((v[i] - v_at[i]).abs() < 1e-13 * fastest, "{:?} {} {}", conditions.order, v[i], v_at[i]);
        }
    }
}

/// Cloud in cell at q of what the lattice's particles have.
fn interpolated(field: &[f64], q: [f64; 3]) -> [f64; 3] {
    let u = q.map(|q| q * N as f64 / BOX);
    let weights = u.map(|u| (0..N).map(|i| weight(Window::CloudInCell, N, 0.0, u, i)).collect::<Vec<_>>());
    let mut sum = [0.0; 3];
    for c in 0..N * N * N {
        let w = weights[0][c / (N * N)] * weights[1][c / N % N] * weights[2][c % N];
        for axis in 0..3 {
            sum[axis] += w * field[3 * c + axis];
        }
    }
    sum
}

#[test]
fn scattered_particles_read_the_lattice_s_displacements_by_cloud_in_cell() {
    let q = scattered(300);
    let origin = lattice([0.0; 3]);
    let columns = species_columns();
    for conditions in all(&columns) {
        let [x, v] = on_lattice(&conditions);
        let psi: Vec<f64> = x.iter().zip(&origin).map(|(x, q)| shortest(x - q)).collect();
        let [x_at, v_at] = at(&q, &conditions, &Serial).unwrap();
        let fastest = v.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
        for i in 0..q.len() / 3 {
            let place = [q[3 * i], q[3 * i + 1], q[3 * i + 2]];
            let (expected, speed) = (interpolated(&psi, place), interpolated(&v, place));
            for axis in 0..3 {
                let (x, v) = (x_at[3 * i + axis], v_at[3 * i + axis]);
                assert!((0.0..BOX).contains(&x));
                // Roundings at the size of the box, and of q in cells, as steep as displacements are.
                assert!(shortest(x - place[axis] - expected[axis]).abs() < 1e-12 * BOX);
                assert!((v - speed[axis]).abs() < 1e-12 * fastest);
            }
        }
    }
}

/// Modes of one component of triples on a lattice.
fn modes(triples: &[f64], axis: usize, fft: &mut Transform<'static, f64>) -> Vec<f64> {
    let stride = fft.configuration().stride();
    let mut data = vec![0.0; fft.length()];
    for c in 0..N * N * N {
        data[c / (N * N) * stride[0] + c / N % N * stride[1] + c % N * stride[2]] = triples[3 * c + axis];
    }
    fft.forward(&mut data).unwrap();
    data
}

#[test]
fn a_shifted_lattice_samples_waves_through_the_window() {
    // Half a cell along x halves two neighbours each: exp(i k H/2) cos(k H/2) of each wave, which is the window sinc^2 with its images.
    let conditions = conditions(Order::Second, None);
    let [_, v] = on_lattice(&conditions);
    let [_, shifted] = at(&lattice([0.5, 0.0, 0.0]), &conditions, &Serial).unwrap();
    let mut fft = serial::<f64>(N);
    let brick = *fft.fourier();
    let (count, stride) = (brick.count(), brick.stride());
    for axis in 0..3 {
        let (before, after) = (modes(&v, axis, &mut fft), modes(&shifted, axis, &mut fft));
        let size = before.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
        for c in 0..brick.elements() {
            let index = [c / (count[1] * count[2]), c / count[2] % count[1], c % count[2]];
            let place = 2 * (0..3).map(|a| index[a] * stride[a]).sum::<usize>();
            let half = core::f64::consts::PI * Brick::mode(N, index[0]) as f64 / N as f64;
            let (re, im) = (half.cos() * half.cos(), half.sin() * half.cos());
            let expected =
                [re * before[place] - im * before[place + 1], im * before[place] + re * before[place + 1]];
            for part in 0..2 {
                assert!((after[place + part] - expected[part]).abs() < 1e-12 * size, "{index:?}");
            }
        }
    }
}

#[test]
fn the_bits_do_not_depend_on_threads_and_single_follows_double() {
    let q = scattered(5000);
    let columns = species_columns();
    for conditions in all(&columns) {
        let one = at(&q, &conditions, &Serial).unwrap();
        for threads in [1, 2, 5] {
            assert_eq!(one, at(&q, &conditions, &Threads::new(threads).unwrap()).unwrap());
        }
        let single: Vec<f32> = q.iter().map(|&q| q as f32).collect();
        let [x, v] = at(&single, &conditions, &Serial).unwrap();
        let fastest = one[1].iter().fold(0.0_f64, |m, v| m.max(v.abs()));
        for i in 0..q.len() {
            // q itself is rounded by up to 2e-5 of a cell, a velocity's own range away from the next cell.
            assert!(shortest(one[0][i] - f64::from(x[i])).abs() < 1e-6 * BOX);
            assert!((one[1][i] - f64::from(v[i])).abs() < 1e-4 * fastest);
        }
    }
}

#[test]
fn uniform_particles_move_by_the_mean_of_none() {
    let count = 4000;
    let q = scattered(count);
    for order in ORDERS {
        let [x, v] = at(&q, &conditions(order, None), &Serial).unwrap();
        for axis in 0..3 {
            let psi: Vec<f64> = (0..count).map(|i| shortest(x[3 * i + axis] - q[3 * i + axis])).collect();
            let mean = psi.iter().sum::<f64>() / count as f64;
            let variance = psi.iter().map(|p| p * p).sum::<f64>() / count as f64;
            // Of independent draws of a field without mean: three sigma.
            assert!(mean.abs() < 3.0 * (variance / count as f64).sqrt(), "{order:?} {mean} {variance}");
            assert!(variance > 0.0 && v.iter().all(|v| v.is_finite()));
        }
    }
}

#[test]
fn scratch_is_that_of_the_mesh_and_of_the_read_out() {
    let fft = serial::<f64>(N);
    let region = crate::pm::Region::from_brick(fft.configuration()).unwrap();
    for order in ORDERS {
        let parts = conditions(order, None).parts();
        let of_mesh = initial_conditions_scratch(parts, &fft, None).unwrap();
        let of_particles = deposit_scratch::<f64>(&region, 1000, Window::CloudInCell).unwrap();
        let all = initial_conditions_at_scratch(parts, 1000, &fft, None).unwrap();
        assert_eq!(all.size.next_multiple_of(64), (of_mesh.size + of_particles.size).next_multiple_of(64));
    }
}

#[test]
fn bad_requests_are_refused() {
    let good = conditions(Order::Second, None);
    let q = lattice([0.1; 3]);
    let attempt = |conditions: &InitialConditions<'_>, q: &[f64], particles: [usize; 2], less: usize| {
        let mut fft = serial::<f64>(N);
        let (mut x, mut v) = (vec![7.0; 3 * particles[0]], vec![7.0; 3 * particles[1]]);
        let layout = initial_conditions_at_scratch(good.parts(), q.len() / 3, &fft, None).unwrap();
        let mut scratch = Memory::new(layout);
        let scratch = &mut scratch.get()[..layout.size - less];
        let position = &mut Components::triples(&mut x).unwrap();
        let velocity = &mut Components::triples(&mut v).unwrap();
        let q = Positions::triples(q).unwrap();
        let outcome =
            initial_conditions_at(position, velocity, &q, conditions, &mut fft, None, scratch, &Serial);
        let untouched = x.iter().chain(&v).all(|&x| x == 7.0);
        (outcome, untouched)
    };
    let all = N * N * N;
    assert_eq!(attempt(&good, &q, [all; 2], 0), (Ok(()), false));
    assert_eq!(attempt(&good, &q, [all - 1, all], 0), (Err(Error::Length), true));
    assert_eq!(attempt(&good, &q, [all, all + 1], 0), (Err(Error::Length), true));
    assert_eq!(attempt(&good, &q, [all; 2], 64), (Err(Error::Scratch), true));
    let bad = InitialConditions { box_size: 0.0, ..good };
    assert_eq!(attempt(&bad, &q, [all; 2], 0), (Err(Error::Range), true));
    let bad = InitialConditions { redshift: f64::NAN, ..good };
    assert_eq!(attempt(&bad, &q, [all; 2], 0), (Err(Error::NotFinite), true));
    for value in [f64::NAN, f64::INFINITY] {
        let mut bad = q.clone();
        bad[100] = value;
        assert_eq!(attempt(&good, &bad, [all; 2], 0).0, Err(Error::NotFinite));
    }
    assert_eq!(attempt(&good, &[], [0; 2], 0).0, Ok(()), "no particles are none to move");
}

#[test]
fn parts_of_a_mesh_are_refused() {
    together::<f64>(N, &[(0, 5), (5, 3)], &|process| {
        let conditions = conditions(Order::First, None);
        let q = lattice([0.0; 3]);
        let (mut x, mut v) = (q.clone(), q.clone());
        let refused = initial_conditions_at_scratch(conditions.parts(), q.len() / 3, process, None);
        assert_eq!(refused.map(|_| ()), Err(Error::Brick));
        let position = &mut Components::triples(&mut x).unwrap();
        let velocity = &mut Components::triples(&mut v).unwrap();
        let q = Positions::triples(&q).unwrap();
        let refused =
            initial_conditions_at(position, velocity, &q, &conditions, process, None, &mut [], &Serial);
        assert_eq!(refused, Err(Error::Brick));
    });
}
