//! Claims about the physics of runs.

mod restart;

use std::boxed::Box;
use std::vec;
use std::vec::Vec;

use crate::cosmology::{Convention, Cosmology, EisensteinHu, Linear, Wiggles, growth};
use crate::exec::{Exec, Serial};
use crate::fft::Fft3;
use crate::initial::conditions::{InitialConditions, Order, initial_conditions, initial_conditions_scratch};
use crate::initial::particles::Components;
use crate::initial::png::Local;
use crate::initial::shape::Shape;
use crate::noise::{Amplitude, Realisation};
use crate::pm::evolve::*;
use crate::pm::factors::{COLA_EXPONENT, Stepper, half_step, logarithmic_steps};
use crate::pm::force::{Difference, ForceLaw};
use crate::pm::kick::Lpt;
use crate::pm::outputs::{Outputs, Progress, Verdict};
use crate::pm::{Positions, Window};
use crate::real::Real;
use crate::reference::built::{memory, transform};
use crate::status::{Error, Result};

const BOX: f64 = 400.0;
const START: f64 = 1.0 / 33.0;
const COLA: Stepper = Stepper::Cola { exponent: COLA_EXPONENT };

/// Undoes deposit and read-out, so that linear modes feel the whole force.
fn sharp(window: Window) -> ForceLaw {
    ForceLaw { window: Some((window, 2)), ..ForceLaw::default() }
}

fn gravity(stepper: Stepper) -> Gravity {
    let window = Window::CloudInCell;
    Gravity {
        cosmology: Cosmology::goliat(),
        box_size: BOX,
        hubble: 100.0,
        window,
        law: ForceLaw::default(),
        stepper,
    }
}

/// Particles of one time.
#[derive(Clone, Debug, PartialEq)]
struct Particles<T> {
    x: Vec<T>,
    u: Vec<T>,
    epoch: Epoch,
}

/// Initial conditions of n^3 particles with `part` of the amplitude of GOLIAT's.
fn start<T: Real>(n: usize, part: f64, order: Order) -> Particles<T> {
    let cosmology = Cosmology::goliat();
    let fit = EisensteinHu::new(&cosmology, Wiggles::With).unwrap();
    let linear = Linear::from_eisenstein_hu(fit, cosmology.n_s, 1.0).unwrap();
    let conditions = InitialConditions {
        realisation: Realisation { amplitude: Amplitude::Fixed, ..Realisation::new(5) },
        cosmology,
        linear: linear.with_sigma8(0.8 * part).unwrap(),
        redshift: 1.0 / START - 1.0,
        box_size: BOX,
        local: Local::default(),
        shape: Shape::Local.rows(),
        species: None,
        convention: Convention::Cmb,
        order,
    };
    let mut fft = transform::<T>(n, &Serial);
    let scratch = memory(initial_conditions_scratch(order.into(), &fft, None).unwrap());
    let (mut x, mut u) = (vec![T::ZERO; 3 * n * n * n], vec![T::ZERO; 3 * n * n * n]);
    let position = &mut Components::triples(&mut x).unwrap();
    let velocity = &mut Components::triples(&mut u).unwrap();
    initial_conditions(position, velocity, &conditions, &mut fft, None, scratch, &Serial).unwrap();
    Particles { x, u, epoch: Epoch::at(START) }
}

/// Cells a side of the mesh, and threads.
#[derive(Clone, Copy)]
struct Machine {
    mesh: usize,
    exec: &'static dyn Exec,
}

const fn serial(mesh: usize) -> Machine {
    Machine { mesh, exec: &Serial }
}

impl Machine {
    fn run<T: Real>(
        self,
        gravity: &Gravity,
        particles: &mut Particles<T>,
        displacements: Option<&Displacements<'_, T>>,
        list: &[f64],
        outputs: Option<&mut Outputs<'_, T>>,
        observe: &mut dyn FnMut(&Progress<'_, T>) -> Verdict,
    ) -> Result<()> {
        let mut fft = transform::<T>(self.mesh, self.exec);
        let mut meshes = [0; 3].map(|_| vec![T::ZERO; fft.length()]);
        let [one, two, three] = &mut meshes;
        let count = particles.x.len() / 3;
        let scratch = memory(evolve_scratch(&fft, count, gravity.window)?);
        let workshop = &mut Workshop { meshes: [one, two, three], fft: &mut fft, scratch, exec: self.exec };
        let position = &mut Components::triples(&mut particles.x)?;
        let velocity = &mut Components::triples(&mut particles.u)?;
        let epoch = &mut particles.epoch;
        evolve(gravity, epoch, position, velocity, displacements, list, outputs, workshop, observe)
    }

    /// Through a list without looking.
    fn through<T: Real>(self, gravity: &Gravity, particles: &mut Particles<T>, list: &[f64]) {
        self.run(gravity, particles, None, list, None, &mut |_| Verdict::Continue).unwrap();
    }
}

fn logarithmic(steps: usize, from: f64, to: f64) -> Vec<f64> {
    let mut list = vec![0.0; steps + 1];
    logarithmic_steps(&mut list, from, to).unwrap();
    list
}

/// The density's mode (i, j, l) of particles, by its sum.
fn mode(x: &[f64], n: [i32; 3]) -> [f64; 2] {
    let unit = core::f64::consts::TAU / BOX;
    let mut sum = [0.0; 2];
    for x in x.chunks_exact(3) {
        let phase = unit * (0..3).map(|axis| f64::from(n[axis]) * x[axis]).sum::<f64>();
        sum[0] += phase.cos();
        sum[1] -= phase.sin();
    }
    sum.map(|s| s / (x.len() / 3) as f64)
}

#[test]
fn one_fastpm_step_follows_linear_theory_on_the_largest_scales() {
    let cosmology = Cosmology::goliat();
    let wanted = growth(&cosmology, 1.0).unwrap().d / growth(&cosmology, START).unwrap().d;
    // So small that second order is far below 1e-3.
    let first = start::<f64>(32, 1e-4, Order::First);
    for steps in [1, 3] {
        let mut last = first.clone();
        let window = Window::PiecewiseCubicSpline;
        let gravity = Gravity { window, law: sharp(window), ..gravity(Stepper::FastPm) };
        serial(32).through(&gravity, &mut last, &logarithmic(steps, START, 1.0));
        for n in [[1, 0, 0], [0, 1, 0], [0, 0, 1]] {
            let (before, after) = (mode(&first.x, n), mode(&last.x, n));
            let power = |m: [f64; 2]| m[0] * m[0] + m[1] * m[1];
            let ratio = power(after) / power(before) / (wanted * wanted);
            assert!((ratio - 1.0).abs() < 1e-4, "{steps} steps, {n:?}: {ratio}");
        }
    }
}

/// n^3 particles on a lattice, moved along z by a growing plane wave that crosses itself at `crossing`, at a = START.
fn plane_wave(n: usize, crossing: f64) -> (Particles<f64>, impl Fn(f64, usize) -> [f64; 2]) {
    let cosmology = Cosmology::goliat();
    let unit = core::f64::consts::TAU / BOX;
    let at_crossing = growth(&cosmology, crossing).unwrap().d;
    // x = q - sin(k q) D/(k D_c), whose derivative vanishes at D_c and q = 0.
    let exact = move |a: f64, i: usize| {
        let growth = growth(&cosmology, a).unwrap();
        let q = i as f64 * BOX / n as f64;
        let moved = -(unit * q).sin() / unit * growth.d / at_crossing;
        [q + moved, moved * a * 100.0 * cosmology.expansion(a).unwrap() * growth.f]
    };
    let (mut x, mut u) = (Vec::new(), Vec::new());
    let along: Vec<[f64; 2]> = (0..n).map(|i| exact(START, i)).collect();
    for i in 0..n * n * n {
        let cell = BOX / n as f64;
        x.extend([(i / (n * n)) as f64 * cell, (i / n % n) as f64 * cell, along[i % n][0].rem_euclid(BOX)]);
        u.extend([0.0, 0.0, along[i % n][1]]);
    }
    (Particles { x, u, epoch: Epoch::at(START) }, exact)
}

#[test]
fn a_plane_wave_follows_zeldovich_to_shell_crossing() {
    let n = 32;
    let window = Window::PiecewiseCubicSpline;
    // Before and at the crossing: of the wave's amplitude and its fastest velocity. One cell a particle, sharpened; two cells, soft: there the force
    // lacks up to a cell's width. At the crossing velocities differ where the caustic is thinner than a cell.
    for (mesh, law, [[x1, u1], [x2, u2]]) in [
        (n, sharp(window), [[0.003, 0.01], [0.005, 0.06]]),
        (2 * n, ForceLaw::default(), [[0.015, 0.03], [0.02, 0.07]]),
    ] {
        for (stepper, steps) in [(Stepper::FastPm, 20), (Stepper::Leapfrog, 60)] {
            for (end, x_bound, u_bound) in [(0.4, x1, u1), (0.5, x2, u2)] {
                let (mut particles, exact) = plane_wave(n, 0.5);
                let gravity = Gravity { window, law, ..gravity(stepper) };
                serial(mesh).through(&gravity, &mut particles, &logarithmic(steps, START, end));
                let amplitude = BOX / core::f64::consts::TAU;
                let wanted: Vec<[f64; 2]> = (0..n).map(|i| exact(end, i)).collect();
                let fastest = wanted.iter().map(|[_, u]| u.abs()).fold(0.0, f64::max);
                for (i, [x, u]) in wanted.into_iter().enumerate() {
                    let x = (particles.x[3 * i + 2] - x + 0.5 * BOX).rem_euclid(BOX) - 0.5 * BOX;
                    let u = particles.u[3 * i + 2] - u;
                    assert!(x.abs() < x_bound * amplitude, "{stepper:?} {mesh} {end} {i}: {x}");
                    assert!(u.abs() < u_bound * fastest, "{stepper:?} {mesh} {end} {i}: {u}");
                }
            }
        }
    }
}

#[test]
fn momentum_is_conserved_to_rounding() {
    for (factor, law, window) in [
        (2, ForceLaw::default(), Window::CloudInCell),
        (1, sharp(Window::TriangularShapedCloud), Window::TriangularShapedCloud),
        (
            2,
            ForceLaw {
                laplacian: Difference::TwoPoint,
                gradient: Difference::TwoPoint,
                ..ForceLaw::default()
            },
            Window::CloudInCell,
        ),
        (3, ForceLaw::FOUR_POINT, Window::PiecewiseCubicSpline),
    ] {
        let gravity = Gravity { law, window, ..gravity(Stepper::FastPm) };
        let mut particles = start::<f64>(16, 1.0, Order::Second);
        serial(factor * 16).through(&gravity, &mut particles, &logarithmic(6, START, 1.0));
        let momentum: Vec<f64> = (0..3).map(|axis| particles.u.iter().skip(axis).step_by(3).sum()).collect();
        let size: f64 = particles.u.iter().map(|u| u.abs()).sum();
        // Roundings of 2^12 particles and up to 2^17 cells add up at random.
        assert!(momentum.iter().all(|p: &f64| p.abs() < 1e-13 * size), "{momentum:?} of {size}");
    }
}

/// Root mean square of the distances between particles.
fn distance(a: &[f64], b: &[f64]) -> f64 {
    let squares = a.iter().zip(b).map(|(a, b)| ((a - b + 0.5 * BOX).rem_euclid(BOX) - 0.5 * BOX).powi(2));
    (squares.sum::<f64>() / a.len() as f64).sqrt()
}

#[test]
fn steppers_converge_with_the_square_of_the_step() {
    // A spline that is smooth enough for the force not to jump as particles cross cells.
    let window = Window::PiecewiseCubicSpline;
    let first = start::<f64>(16, 1.0, Order::Second);
    for stepper in [Stepper::Leapfrog, Stepper::FastPm] {
        let gravity = Gravity { window, ..gravity(stepper) };
        let after = |steps| {
            let mut particles = first.clone();
            serial(16).through(&gravity, &mut particles, &logarithmic(steps, START, 0.5));
            particles.x
        };
        let truth = after(256);
        let errors: Vec<f64> = [8, 16, 32].map(|steps| distance(&after(steps), &truth)).to_vec();
        for pair in errors.windows(2) {
            let order = (pair[0] / pair[1]).log2();
            assert!((1.8..2.3).contains(&order), "{stepper:?}: {errors:?}");
        }
    }
}

/// The displacements of Lagrangian theory that made the particles, by x - q = psi1 + psi2 and u = c1 psi1 + c2 psi2.
fn displacements(particles: &Particles<f64>, n: usize) -> [Vec<f64>; 2] {
    let cosmology = Cosmology::goliat();
    let growth = growth(&cosmology, START).unwrap();
    let unit = START * 100.0 * cosmology.expansion(START).unwrap();
    let (c1, c2) = (unit * growth.f, unit * growth.f2);
    let (mut one, mut two) = (Vec::new(), Vec::new());
    for (i, (x, u)) in particles.x.iter().zip(&particles.u).enumerate() {
        let (particle, axis) = (i / 3, i % 3);
        let q = [particle / (n * n), particle / n % n, particle % n][axis] as f64 * BOX / n as f64;
        let moved = (x - q + 0.5 * BOX).rem_euclid(BOX) - 0.5 * BOX;
        two.push((u - c1 * moved) / (c2 - c1));
        one.push(moved - two[i]);
    }
    [one, two]
}

#[test]
fn cola_needs_few_steps_for_large_scales_and_agrees_with_fastpm_in_the_limit() {
    let n = 16;
    let first = start::<f64>(n, 1.0, Order::Second);
    let [one, two] = displacements(&first, n);
    let lpt =
        Lpt { first: Positions::triples(&one).unwrap(), second: Some(Positions::triples(&two).unwrap()) };
    let displacements = Displacements { lpt, scale_factor: START };
    let window = Window::PiecewiseCubicSpline;
    let gravity = |stepper| Gravity { window, law: sharp(window), ..gravity(stepper) };
    let cola = |steps| {
        let mut particles = first.clone();
        let list = logarithmic(steps, START, 0.5);
        let observe = &mut |_: &Progress<'_, f64>| Verdict::Continue;
        serial(n).run(&gravity(COLA), &mut particles, Some(&displacements), &list, None, observe).unwrap();
        particles.x
    };
    let mut truth = first.clone();
    serial(n).through(&gravity(Stepper::FastPm), &mut truth, &logarithmic(256, START, 0.5));
    let moved = distance(&truth.x, &first.x);
    let errors = [4, 8, 16, 32].map(|steps| distance(&cola(steps), &truth.x) / moved);
    assert!(errors[0] < 0.05, "{errors:?}");
    assert!(errors[3] < 1e-3, "{errors:?}");
    for pair in errors.windows(2) {
        assert!((1.7..2.5).contains(&(pair[0] / pair[1]).log2()), "{errors:?}");
    }
}
