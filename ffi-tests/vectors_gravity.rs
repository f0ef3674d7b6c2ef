//! The cases of forces, kicks and drifts, steps in time, and runs.

use fixpair::cosmology::Cosmology;
use fixpair::exec::Serial;
use fixpair::fft::Fft3;
use fixpair::initial::particles::Components;
use fixpair::mesh::{Brick, Space};
use fixpair::pm::evolve::{Displacements, Epoch, Gravity, Workshop};
use fixpair::pm::factors::{COLA_EXPONENT, Stepper, linear_steps, logarithmic_steps};
use fixpair::pm::outputs::{Event, Outputs, Progress, Verdict};
use fixpair::pm::{
    Assignment, Difference, Drift, ForceLaw, Kick, Lpt, Positions, Region, Window, copy_cells,
    copy_components, drift, evolve, evolve_scratch, force_scratch, forces, kick, kick_scratch, potential,
};
use fixpair::real::Real;

use crate::vectors::{BOX, Cases, Hash, N, PADDING, bricks, noise};
use crate::vectors_real::{Memory, elements, triples, with_transform};

const PARTICLES: usize = 500;

/// Particles a side of a run.
const LATTICE: usize = 6;

/// Entries of the list of a run.
const STEPS: usize = 5;

const OUTPUTS: [f64; 4] = [0.125, 0.3125, 0.75, 1.0];

const WINDOWS: [Window; 4] = [
    Window::NearestGridPoint,
    Window::CloudInCell,
    Window::TriangularShapedCloud,
    Window::PiecewiseCubicSpline,
];

const STEPPERS: [(&str, Stepper); 3] = [
    ("fastpm", Stepper::FastPm),
    ("leapfrog", Stepper::Leapfrog),
    ("cola", Stepper::Cola { exponent: COLA_EXPONENT }),
];

fn laws() -> [ForceLaw; 3] {
    let sharp = Some((Window::CloudInCell, 1));
    let sharper = Some((Window::PiecewiseCubicSpline, 2));
    let (exact, two, four) = (Difference::Exact, Difference::TwoPoint, Difference::FourPoint);
    [
        ForceLaw::default(),
        ForceLaw { laplacian: two, gradient: four, window: sharp, split_scale: 0.0 },
        ForceLaw { laplacian: exact, gradient: four, window: sharper, split_scale: 1.25 * BOX / N as f64 },
    ]
}

/// What is the same in both precisions.
pub(crate) fn time_cases(cases: &mut Cases) {
    let c = Cosmology::goliat();
    let members = [c.omega_m, c.omega_de, c.omega_r, c.omega_b, c.h, c.n_s, c.w0, c.wa, c.t_cmb];
    // Exact derivatives; a run begins with the four-point gradient.
    let law = |gradient| Hash::new().integers(&[0, gradient, 0, 2]).doubles(&[0.0]);
    cases.add("force_law_init", law(0));
    let gravity = law(2).doubles(&members).doubles(&[0.0, 100.0, COLA_EXPONENT]).integers(&[0, 2]);
    cases.add("gravity_init", gravity);
    let layout = force_scratch(N).expect("scratch");
    cases.add("force_scratch", Hash::new().integers(&[layout.size as u64, layout.align as u64]));
    let mut hash = Hash::new();
    for (_, stepper) in STEPPERS {
        for [from, to, at] in [[0.125, 0.25, 0.1875], [0.5, 0.25, 0.3125]] {
            let drift = stepper.drift(&c, from, to, at).expect("factors");
            let kick = stepper.kick(&c, from, to, at).expect("factors");
            for factors in [drift, kick] {
                hash = hash.doubles(&[factors.factor, factors.first, factors.second]);
            }
        }
    }
    cases.add("step_factors", hash);
    let [mut linear, mut logarithmic] = [[0.0; STEPS]; 2];
    linear_steps(&mut linear, 0.125, 1.0).expect("steps");
    logarithmic_steps(&mut logarithmic, 0.125, 1.0).expect("steps");
    cases.add("steps", Hash::new().doubles(&linear).doubles(&logarithmic));
}

pub(crate) fn gravity_cases<T: Real>(add: &mut dyn FnMut(&str, Hash)) {
    force_cases::<T>(add);
    kick_cases::<T>(add);
    slabs::<T>(add);
    for (number, (name, stepper)) in STEPPERS.into_iter().enumerate() {
        let [particles, reports] = run::<T>(number, stepper);
        add(&format!("evolve.{name}"), particles);
        add(&format!("evolve.{name}.reports"), reports);
    }
}

/// Values from place `from` of the sequence, `scale` large.
fn numbers<T: Real>(count: usize, from: usize, scale: f64) -> Vec<T> {
    (0..count).map(|i| T::from_f64(scale * noise(i + from))).collect()
}

fn force_cases<T: Real>(add: &mut dyn FnMut(&str, Hash)) {
    for (name, brick) in bricks() {
        let layout = force_scratch(N).expect("scratch");
        let mut memory = Memory::new(layout);
        let (mut hash, mut potentials) = (Hash::new(), Hash::new());
        for law in laws() {
            let scratch = memory.bytes(layout.size);
            let mut modes = numbers::<T>(brick.reals(), 0, 1.0);
            let [mut x, mut y, mut z] = [0, 1, 2].map(|_| modes.clone());
            let meshes = [&mut x[..], &mut y[..], &mut z[..]];
            forces(meshes, &brick, &law, BOX, 500.0, scratch, &Serial).expect("forces");
            for mesh in [x, y, z] {
                hash = elements(hash, &mesh, &brick);
            }
            potential(&mut modes, &brick, &law, BOX, 500.0, scratch, &Serial).expect("a potential");
            potentials = elements(potentials, &modes, &brick);
        }
        add(&format!("forces.{name}"), hash);
        add(&format!("potential.{name}"), potentials);
    }
}

fn kick_cases<T: Real>(add: &mut dyn FnMut(&str, Hash)) {
    let cells = Brick::whole_padded(N, Space::Configuration, PADDING).expect("a brick");
    let region = Region::from_brick(&cells).expect("a region");
    let mut places = numbers::<T>(3 * PARTICLES, 0, BOX);
    let mut speeds = numbers::<T>(3 * PARTICLES, 5000, 300.0);
    let meshes = [10_000, 20_000, 30_000].map(|from| numbers::<T>(region.reals(), from, 1.0));
    let psi = [40_000, 50_000].map(|from| numbers::<T>(3 * PARTICLES, from, 2.0));
    let [first, second] = [0, 1].map(|order| Positions::triples(&psi[order]).expect("triples"));
    let mut hash = Hash::new();
    for (i, window) in WINDOWS.into_iter().enumerate() {
        let layout = kick_scratch::<T>(&region, PARTICLES, window).expect("scratch");
        let mut scratch = Memory::new(layout);
        let shift = 0.25 * i as f64;
        let assignment = Assignment { box_size: BOX, window, shift };
        // Without displacements, with those of one order, and of both.
        let lpt = (i > 0).then_some(Lpt { first, second: (i > 1).then_some(second) });
        let factors = Kick {
            keep: 0.875,
            force: 2.5,
            first: if i > 0 { 0.25 } else { 0.0 },
            second: if i > 1 { -0.125 } else { 0.0 },
        };
        let places = Positions::triples(&places).expect("triples");
        let scratch = scratch.bytes(layout.size);
        kick(
            &mut Components::triples(&mut speeds).expect("triples"),
            &places,
            meshes.each_ref().map(|mesh| &mesh[..]),
            &region,
            &assignment,
            &factors,
            lpt.as_ref(),
            scratch,
            &Serial,
        )
        .expect("velocities");
        hash = triples(hash.integers(&[layout.size as u64, layout.align as u64]), &speeds);
    }
    add("kick", hash);
    let mut hash = Hash::new();
    for i in 0..3 {
        let lpt = (i > 0).then_some(Lpt { first, second: (i > 1).then_some(second) });
        let factors = Drift {
            velocity: 0.125,
            first: if i > 0 { 0.5 } else { 0.0 },
            second: if i > 1 { 0.25 } else { 0.0 },
        };
        let speeds = Positions::triples(&speeds).expect("triples");
        let mut to = Components::triples(&mut places).expect("triples");
        drift(&mut to, &speeds, BOX, &factors, lpt.as_ref(), &Serial).expect("positions");
        hash = triples(hash, &places);
    }
    add("drift", hash);
}

/// Two ranks with forces on slabs: ghosts are filled, each kicks its own particles.
fn slabs<T: Real>(add: &mut dyn FnMut(&str, Hash)) {
    let (window, shift) = (Window::PiecewiseCubicSpline, 0.5);
    let ranges = [[0, 5], [5, 7]];
    let bricks = ranges.map(|[first, planes]| Brick::slab(N, Space::Configuration, first, planes));
    let own = bricks.map(|brick| Region::from_brick(&brick.expect("a slab")).expect("a region"));
    let wide =
        bricks.map(|brick| Region::with_ghosts(&brick.expect("a slab"), window, shift).expect("a region"));
    let mut places: [Vec<T>; 2] = [Vec::new(), Vec::new()];
    for i in 0..PARTICLES {
        let particle = [0, 1, 2].map(|axis| T::from_f64(BOX * (noise(3 * i + axis) + 1.0) / 2.0));
        let low = particle[0].to_f64() * (N as f64) < ranges[1][0] as f64 * BOX;
        places[usize::from(!low)].extend(particle);
    }
    let mut hash = Hash::new();
    for rank in 0..2 {
        let mut ghosts = [(); 3].map(|()| vec![T::ZERO; wide[rank].reals()]);
        for (axis, ghost) in ghosts.iter_mut().enumerate() {
            for (other, own) in own.iter().enumerate() {
                let mesh = numbers::<T>(own.reals(), 10_000 * (3 * other + axis), 1.0);
                copy_cells(ghost, &wide[rank], &mesh, own, &Serial).expect("cells");
            }
        }
        let count = places[rank].len() / 3;
        let mut speeds = numbers::<T>(3 * count, 70_000 * rank, 300.0);
        let layout = kick_scratch::<T>(&wide[rank], count, window).expect("scratch");
        kick(
            &mut Components::triples(&mut speeds).expect("triples"),
            &Positions::triples(&places[rank]).expect("triples"),
            ghosts.each_ref().map(|mesh| &mesh[..]),
            &wide[rank],
            &Assignment { box_size: BOX, window, shift },
            &Kick { keep: 0.5, force: 1.5, first: 0.0, second: 0.0 },
            None,
            Memory::new(layout).bytes(layout.size),
            &Serial,
        )
        .expect("velocities");
        hash = triples(hash, &speeds);
    }
    add("kick.slabs", hash);
}

/// Positions, velocities, and both orders of their displacements: a lattice, displaced.
fn lattice<T: Real>() -> [Vec<T>; 4] {
    let mut of = [const { Vec::new() }; 4];
    for i in 0..3 * LATTICE.pow(3) {
        let (particle, axis) = (i / 3, i % 3);
        let cell = [particle / (LATTICE * LATTICE), particle / LATTICE % LATTICE, particle % LATTICE][axis];
        let (first, second) = (2.0 * noise(i), 0.25 * noise(i + 1000));
        let place = cell as f64 * BOX / LATTICE as f64 + first + second;
        for (to, value) in of.iter_mut().zip([place, 150.0 * noise(i + 2000), first, second]) {
            to.push(T::from_f64(value));
        }
    }
    of
}

/// From a = 1/8 to 1: the particles and their epoch at the end, and all reports with the particles of outputs.
fn run<T: Real>(number: usize, stepper: Stepper) -> [Hash; 2] {
    let [mut position, mut velocity, first, second] = lattice::<T>();
    let count = position.len();
    let window = WINDOWS[1 + number];
    let gravity = Gravity {
        cosmology: Cosmology::goliat(),
        box_size: BOX,
        hubble: 100.0,
        window,
        law: laws()[number],
        stepper,
    };
    let [first, second] = [&first, &second].map(|psi| Positions::triples(psi).expect("triples"));
    let displacements = Displacements { lpt: Lpt { first, second: Some(second) }, scale_factor: 0.125 };
    let mut scale_factors = [0.0; STEPS];
    logarithmic_steps(&mut scale_factors, 0.125, 1.0).expect("steps");
    let [mut x, mut v, mut shown] = [(); 3].map(|()| vec![T::ZERO; count]);
    let mut epoch = Epoch::at(0.125);
    let mut reports = Hash::new();
    let layout = with_transform::<T, _>(N, 0, |fft| {
        let layout = evolve_scratch(fft, count / 3, window).expect("scratch");
        let mut scratch = Memory::new(layout);
        let mut meshes = [(); 3].map(|()| vec![T::ZERO; fft.length()]);
        let mut workshop = Workshop {
            meshes: meshes.each_mut().map(|mesh| &mut mesh[..]),
            fft,
            scratch: scratch.bytes(layout.size),
            exec: &Serial,
        };
        let mut outputs = Outputs {
            scale_factors: &OUTPUTS,
            position: Components::triples(&mut x).expect("triples"),
            velocity: Components::triples(&mut v).expect("triples"),
        };
        let mut observe = |progress: &Progress<'_, T>| {
            let Progress { event, step, steps, output, epoch, .. } = *progress;
            let event = u64::from(event == Event::Output);
            reports = reports
                .integers(&[event, step as u64, steps as u64, output as u64])
                .doubles(&[epoch.position, epoch.velocity]);
            for of in [&progress.position, &progress.velocity] {
                let mut to = Components::triples(&mut shown).expect("triples");
                copy_components(&mut to, of, &Serial).expect("a copy");
                reports = triples(reports, &shown);
            }
            Verdict::Continue
        };
        evolve(
            &gravity,
            &mut epoch,
            &mut Components::triples(&mut position).expect("triples"),
            &mut Components::triples(&mut velocity).expect("triples"),
            Some(&displacements),
            &scale_factors,
            Some(&mut outputs),
            &mut workshop,
            &mut observe,
        )
        .expect("a run");
        layout
    });
    let hash = Hash::new().integers(&[layout.size as u64, layout.align as u64]);
    let hash = triples(triples(hash, &position), &velocity).doubles(&[epoch.position, epoch.velocity]);
    [hash, reports]
}
