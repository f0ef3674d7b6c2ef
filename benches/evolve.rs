//! Particle-mesh runs, and their steps stage by stage, on one core.
//!
//! Each job runs 10 steps from 2LPT at z = 9 to z = 0, spacing of the lattice 1 Mpc/h, and prints CPU seconds beside those that L-PICOLA took for the same
//! job on this kind of processor (PM, COLA; output to disk included). Then the stages of the last step, on the clustered particles: their times, the bytes
//! that each must move once, and how long this machine takes to move as many by copying. At 256^3 in both precisions and at 128^3 with two cells a
//! particle on a side. FIXPAIR_BENCH_SMALL=1: 64^3, to try it.

use fixpair::cosmology::{Convention, Cosmology, EisensteinHu, Linear, Wiggles};
use fixpair::exec::Serial;
use fixpair::fft::{Fft3, Tables, Transform, recommended_padding};
use fixpair::initial::conditions::{
    InitialConditions, Order, initial_conditions, initial_conditions_scratch,
};
use fixpair::initial::particles::Components;
use fixpair::initial::png::Local;
use fixpair::initial::shape::Shape;
use fixpair::mesh::{Brick, Space};
use fixpair::noise::Realisation;
use fixpair::pm::evolve::{Epoch, Gravity, Workshop};
use fixpair::pm::factors::{Stepper, linear_steps};
use fixpair::pm::force::{ForceLaw, forces};
use fixpair::pm::outputs::{Progress, Verdict};
use fixpair::pm::{
    Assignment, Drift, Kick, Positions, Region, Window, deposit, drift, evolve, evolve_scratch, kick,
};
use fixpair::real::Real;

#[path = "../examples/common/memory.rs"]
mod memory;
#[path = "common/seconds.rs"]
mod seconds;

use memory::Memory;
use seconds::seconds;

/// Steps of a run.
const STEPS: usize = 10;

/// A stage is repeated until it has taken this long.
const ENOUGH: f64 = 0.2;

/// Mean of as many runs as tell more than the clock's ticks, after one that warms up.
fn mean(mut run: impl FnMut()) -> f64 {
    run();
    let (mut runs, mut total) = (0, 0.0);
    while total < ENOUGH {
        total += seconds(&mut run);
        runs += 1;
    }
    total / f64::from(runs)
}

/// A whole cubic mesh and what transforms it.
struct Job {
    name: &'static str,
    /// Particles on a side.
    particles: usize,
    /// Cells on a side.
    mesh: usize,
    /// CPU seconds of L-PICOLA.
    peer: f64,
}

impl Job {
    fn conditions(&self) -> InitialConditions<'static> {
        let cosmology = Cosmology::goliat();
        let fit = EisensteinHu::new(&cosmology, Wiggles::With).expect("a sound cosmology");
        let linear = Linear::from_eisenstein_hu(fit, cosmology.n_s, 1.0).expect("a sound cosmology");
        InitialConditions {
            realisation: Realisation::new(1),
            cosmology,
            linear: linear.with_sigma8(0.8).expect("a spectrum"),
            redshift: 9.0,
            box_size: self.particles as f64,
            local: Local::default(),
            shape: Shape::Local.rows(),
            species: None,
            convention: Convention::Cmb,
            order: Order::Second,
        }
    }

    /// Positions and velocities of z = 9.
    fn start<T: Real>(&self) -> [Vec<T>; 2] {
        let (conditions, count) = (self.conditions(), 3 * self.particles.pow(3));
        let (mut x, mut u) = (vec![T::ZERO; count], vec![T::ZERO; count]);
        with_transform::<T>(self.particles, |fft| {
            let layout = initial_conditions_scratch(Order::Second.into(), &*fft, None).expect("fits");
            let mut scratch = Memory::new(layout);
            let position = &mut Components::triples(&mut x).expect("triples");
            let velocity = &mut Components::triples(&mut u).expect("triples");
            initial_conditions(position, velocity, &conditions, fft, None, scratch.bytes(), &Serial)
                .expect("particles");
        });
        [x, u]
    }

    fn run<T: Real>(&self) {
        let [mut x, mut u] = self.start::<T>();
        let count = x.len() / 3;
        let window = Window::CloudInCell;
        let gravity = Gravity {
            cosmology: Cosmology::goliat(),
            box_size: self.particles as f64,
            hubble: 100.0,
            window,
            law: ForceLaw::FOUR_POINT,
            stepper: Stepper::FastPm,
        };
        let mut list = [0.0; STEPS + 1];
        linear_steps(&mut list, 0.1, 1.0).expect("increasing");
        with_transform::<T>(self.mesh, |fft| {
            let mut meshes = [0; 3].map(|_| vec![T::ZERO; fft.length()]);
            let mut scratch = Memory::new(evolve_scratch(&*fft, count, window).expect("fits"));
            let bytes = size_of::<T>() * (6 * count + 3 * fft.length()) + scratch.bytes().len();
            let total = seconds(|| {
                let mut epoch = Epoch::at(list[0]);
                let [one, two, three] = &mut meshes;
                let meshes: [&mut [T]; 3] = [one, two, three];
                let workshop = &mut Workshop { meshes, fft, scratch: scratch.bytes(), exec: &Serial };
                let position = &mut Components::triples(&mut x).expect("triples");
                let velocity = &mut Components::triples(&mut u).expect("triples");
                let go = &mut |_: &Progress<'_, T>| Verdict::Continue;
                evolve(&gravity, &mut epoch, position, velocity, None, &list, None, workshop, go)
                    .expect("a run");
            });
            println!(
                "\n{}: {total:.2} s of CPU for {STEPS} steps ({} forces), L-PICOLA {}: {:.1}x; {:.1} bytes a particle",
                self.name,
                STEPS + 1,
                self.peer,
                self.peer / total,
                bytes as f64 / count as f64
            );
            self.stages(fft, &mut meshes, &mut x, &mut u, &gravity, scratch.bytes());
        });
    }

    fn stages<T: Real>(
        &self,
        fft: &mut Transform<'_, T>,
        meshes: &mut [Vec<T>; 3],
        x: &mut [T],
        u: &mut [T],
        gravity: &Gravity,
        scratch: &mut [u8],
    ) {
        let size = size_of::<T>() as f64;
        let (particles, cells) = ((x.len() / 3) as f64, fft.length() as f64);
        let speed = copy_speed(&mut meshes[0]);
        println!("  stage        seconds   ns/particle   bytes once   copying as many   times the copy");
        let row = |name: &str, seconds: f64, bytes: f64| {
            let floor = bytes / speed;
            println!(
                "  {name:10} {seconds:9.4} {:13.1} {:9.0} MB {floor:15.4} s {:14.1}",
                1e9 * seconds / particles,
                1e-6 * bytes,
                seconds / floor
            );
        };
        let region = Region::from_brick(fft.configuration()).expect("cells");
        let Gravity { box_size, window, law, .. } = *gravity;
        let assignment = Assignment { box_size, window, shift: 0.0 };
        let [density, second, third] = meshes;
        let time = mean(|| {
            density.fill(T::ZERO);
            let at = Positions::triples(x).expect("triples");
            deposit(density, &region, &at, None, &assignment, scratch, &Serial).expect("deposit");
        });
        row("deposit", time, size * (3.0 * particles + 2.0 * cells));
        // Transforms of transforms are transforms: values do not matter here.
        let time = mean(|| fft.forward(density).expect("transform"));
        row("forward", time, size * 2.0 * cells);
        let fourier = *fft.fourier();
        let time = mean(|| {
            let meshes: [&mut [T]; 3] = [density, second, third];
            forces(meshes, &fourier, &law, box_size, particles, scratch, &Serial).expect("forces");
        });
        row("forces", time, size * 4.0 * cells);
        for mesh in [&mut *density, &mut *second, &mut *third] {
            mesh.fill(T::ZERO);
        }
        let time = 3.0 * mean(|| fft.inverse(density).expect("transform"));
        row("3 inverse", time, size * 6.0 * cells);
        let push = Kick { keep: 1.0, force: 1.0, first: 0.0, second: 0.0 };
        let time = mean(|| {
            let at = Positions::triples(x).expect("triples");
            let velocity = &mut Components::triples(u).expect("triples");
            let forces: [&[T]; 3] = [density, second, third];
            kick(velocity, &at, forces, &region, &assignment, &push, None, scratch, &Serial).expect("kick");
        });
        row("kick", time, size * (9.0 * particles + 3.0 * cells));
        let move_on = Drift { velocity: 0.0, first: 0.0, second: 0.0 };
        let time = mean(|| {
            let position = &mut Components::triples(x).expect("triples");
            let with = Positions::triples(u).expect("triples");
            drift(position, &with, box_size, &move_on, None, &Serial).expect("drift");
        });
        row("drift", time, size * 9.0 * particles);
    }
}

/// Bytes a second of a large copy, reads and writes counted.
fn copy_speed<T: Real>(mesh: &mut [T]) -> f64 {
    let (from, to) = mesh.split_at_mut(mesh.len() / 2);
    let time = mean(|| to[..from.len()].copy_from_slice(from));
    2.0 * size_of_val(from) as f64 / time
}

/// Lends a transform with the padding that suits it.
fn with_transform<T: Real>(n: usize, body: impl FnOnce(&mut Transform<'_, T>)) {
    let mut tables = Memory::new(Tables::<T>::layout(n).expect("a good side"));
    let tables = Tables::<T>::new(n, tables.bytes()).expect("a good side");
    let mut workspace = Memory::new(Transform::<T>::workspace(n).expect("a good side"));
    let cells =
        Brick::whole_padded(n, Space::Configuration, recommended_padding::<T>(n)).expect("an even side");
    body(&mut Transform::new(&tables, cells, workspace.bytes(), &Serial).expect("a whole mesh"));
}

fn main() {
    let job = |name, particles, mesh, peer| Job { name, particles, mesh, peer };
    if std::env::var_os("FIXPAIR_BENCH_SMALL").is_some() {
        job("64^3, mesh 1x, f32", 64, 64, f64::NAN).run::<f32>();
        return;
    }
    job("128^3, mesh 1x, f32", 128, 128, 4.4).run::<f32>();
    job("128^3, mesh 2x, f32", 128, 256, 34.0).run::<f32>();
    job("128^3, mesh 2x, f64", 128, 256, 49.0).run::<f64>();
    job("256^3, mesh 1x, f32", 256, 256, 53.0).run::<f32>();
    job("256^3, mesh 1x, f64", 256, 256, 67.0).run::<f64>();
}
