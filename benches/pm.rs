//! Deposit, read-out, kick and drift of N^3 particles on an N^3 mesh, both precisions, one thread and two. Orders in memory: `lattice` (displaced
//! by a smooth wave of 3 cells), `clustered` (a lattice too, displaced as far as the Zel'dovich approximation has it today, 5 cells rms on
//! each axis: what the particles of a simulation end as), `random`. FIXPAIR_BENCH_PYTHON names a Python with Pylians3 to be timed in the same run.

use std::hint::black_box;
use std::process::Command;
use std::time::Instant;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use fixpair::cosmology::{Convention, Cosmology, EisensteinHu, Linear, Wiggles};
use fixpair::exec::{Exec, Serial, Threads};
use fixpair::fft::{Tables, Transform, recommended_padding};
use fixpair::initial::conditions::{
    InitialConditions, Order, initial_conditions, initial_conditions_scratch,
};
use fixpair::initial::particles::Components;
use fixpair::initial::png::Local;
use fixpair::initial::shape::Shape;
use fixpair::mesh::{Brick, Space};
use fixpair::noise::Realisation;
use fixpair::pm::{
    Assignment, ColumnMut, Drift, Kick, Positions, Region, Window, deposit, deposit_scratch, drift, kick,
    kick_scratch, read_out, read_out_scratch,
};
use fixpair::real::Real;

#[path = "../examples/common/memory.rs"]
mod memory;

use memory::Memory;

const N: usize = 256;
/// In Mpc/h.
const BOX_SIZE: f64 = 256.0;

/// Particles on a lattice of the mesh's spacing, z fastest, displaced along each axis by a wave of 3 cells.
fn lattice<T: Real>() -> Vec<T> {
    let cell = BOX_SIZE / N as f64;
    let wave = |i: usize, j: usize| {
        let turns = |m: f64, i: usize| std::f64::consts::TAU * m * i as f64 / N as f64;
        3.0 * cell * turns(2.0, i).sin() * turns(3.0, j).cos()
    };
    let displaced = |q: [usize; 3]| {
        [0, 1, 2].map(|a| (q[a] as f64 * cell + wave(q[a], q[(a + 1) % 3])).rem_euclid(BOX_SIZE))
    };
    (0..N * N * N).flat_map(|i| displaced([i / (N * N), i / N % N, i % N])).map(T::from_f64).collect()
}

/// The same lattice, displaced by the Zel'dovich approximation of today.
fn clustered<T: Real>() -> Vec<T> {
    let cosmology = Cosmology::goliat();
    let fit = EisensteinHu::new(&cosmology, Wiggles::With).unwrap();
    let conditions = InitialConditions {
        realisation: Realisation::new(7),
        cosmology,
        linear: Linear::from_eisenstein_hu(fit, cosmology.n_s, 1.0).unwrap().with_sigma8(0.8).unwrap(),
        redshift: 0.0,
        box_size: BOX_SIZE,
        local: Local { f_nl: 0.0, g_nl: 0.0 },
        shape: Shape::Local.rows(),
        species: None,
        convention: Convention::Cmb,
        order: Order::First,
    };
    let mut tables = Memory::new(Tables::<T>::layout(N).unwrap());
    let tables = Tables::<T>::new(N, tables.bytes()).unwrap();
    let cells = Brick::whole_padded(N, Space::Configuration, recommended_padding::<T>(N)).unwrap();
    let mut work = Memory::new(Transform::<T>::workspace(N).unwrap());
    let mut fft = Transform::new(&tables, cells, work.bytes(), &Serial).unwrap();
    let mut scratch = Memory::new(initial_conditions_scratch::<T>(Order::First.into(), &fft, None).unwrap());
    let (mut x, mut v) = (vec![T::ZERO; 3 * N * N * N], vec![T::ZERO; 3 * N * N * N]);
    let position = &mut Components::triples(&mut x).unwrap();
    let velocity = &mut Components::triples(&mut v).unwrap();
    initial_conditions(position, velocity, &conditions, &mut fft, None, scratch.bytes(), &Serial).unwrap();
    x
}

/// The same number anywhere in the box, in no order.
fn random<T: Real>() -> Vec<T> {
    let mut state = 1_u64;
    let mut next = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    };
    (0..3 * N * N * N).map(|_| T::from_f64(BOX_SIZE * next())).collect()
}

fn region() -> Region {
    Region::from_brick(&Brick::whole(N, Space::Configuration).unwrap()).unwrap()
}

const NAMES: [&str; 4] = ["ngp", "cic", "tsc", "pcs"];

fn kernels<T: Real>(c: &mut Criterion, real: &str) {
    let region = region();
    let pool = Threads::new(2).unwrap();
    let mut mesh = vec![T::ZERO; region.reals()];
    let forces = [1, 2, 3].map(|axis| {
        (0..region.reals()).map(|i| T::from_f64((axis * i % 101) as f64 - 50.0)).collect::<Vec<_>>()
    });
    type Order<T> = fn() -> Vec<T>;
    for (order, make) in
        [("lattice", lattice::<T> as Order<T>), ("clustered", clustered::<T>), ("random", random::<T>)]
    {
        let mut triples = make();
        let mut velocity = vec![T::ONE; triples.len()];
        let mut values = vec![T::ZERO; triples.len() / 3];
        for (threads, exec) in [(1, &Serial as &dyn Exec), (2, &pool)] {
            let mut group = c.benchmark_group(format!("{real}_{order}_{threads}"));
            group.sample_size(10).throughput(Throughput::Elements(values.len() as u64));
            let positions = Positions::triples(&triples).unwrap();
            for (window, name) in Window::ALL.into_iter().zip(NAMES) {
                let assignment = Assignment { box_size: BOX_SIZE, window, shift: 0.0 };
                let layout = deposit_scratch::<T>(&region, positions.len(), window).unwrap();
                let mut memory = Memory::new(layout);
                let scratch = memory.bytes();
                group.bench_function(format!("deposit_{name}"), |b| {
                    b.iter(|| {
                        deposit(black_box(&mut mesh), &region, &positions, None, &assignment, scratch, exec)
                            .unwrap();
                    });
                });
                let layout = read_out_scratch::<T>(&region, positions.len(), window).unwrap();
                let mut memory = Memory::new(layout);
                let scratch = memory.bytes();
                group.bench_function(format!("read_out_{name}"), |b| {
                    b.iter(|| {
                        let mut values = ColumnMut::new(black_box(&mut values));
                        read_out(&mut values, &mesh, &region, &positions, &assignment, scratch, exec)
                            .unwrap();
                    });
                });
                let mut memory = Memory::new(kick_scratch::<T>(&region, positions.len(), window).unwrap());
                let scratch = memory.bytes();
                let factors = Kick { keep: 0.9, force: 0.01, first: 0.0, second: 0.0 };
                group.bench_function(format!("kick_{name}"), |b| {
                    b.iter(|| {
                        let velocity = &mut Components::triples(black_box(&mut velocity)).unwrap();
                        let forces = forces.each_ref().map(Vec::as_slice);
                        kick(
                            velocity,
                            &positions,
                            forces,
                            &region,
                            &assignment,
                            &factors,
                            None,
                            scratch,
                            exec,
                        )
                        .unwrap();
                    });
                });
            }
            // Back and forth, so that the order stays what it is.
            let mut factors = Drift { velocity: 1e-3, first: 0.0, second: 0.0 };
            group.bench_function("drift", |b| {
                b.iter(|| {
                    let position = &mut Components::triples(black_box(&mut triples)).unwrap();
                    let velocity = Positions::triples(&velocity).unwrap();
                    factors.velocity = -factors.velocity;
                    drift(position, &velocity, BOX_SIZE, &factors, None, exec).unwrap();
                });
            });
            group.finish();
        }
    }
}

/// Pylians3 and this library by turns, single precision, one thread: seconds, medians of five of ours, and the ratio.
fn peers(_: &mut Criterion) {
    let Some(python) = std::env::var_os("FIXPAIR_BENCH_PYTHON") else { return };
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/benches/peers/pylians_deposit.py");
    let output = Command::new(python).arg(script).arg(N.to_string()).output().unwrap();
    let text = String::from_utf8_lossy(&output.stdout);
    let region = region();
    let mut mesh = vec![0.0_f32; region.reals()];
    for (order, triples) in [("lattice", lattice::<f32>()), ("random", random::<f32>())] {
        let positions = Positions::triples(&triples).unwrap();
        for (window, name) in Window::ALL.into_iter().zip(NAMES) {
            let name = format!("{name}_{order}");
            let mut words = text.lines().map(str::split_whitespace);
            let theirs = words.find_map(|mut words| {
                (words.next() == Some(&name)).then(|| words.next()?.parse::<f64>().ok()).flatten()
            });
            let Some(theirs) = theirs else { continue };
            let assignment = Assignment { box_size: BOX_SIZE, window, shift: 0.0 };
            let layout = deposit_scratch::<f32>(&region, positions.len(), window).unwrap();
            let mut memory = Memory::new(layout);
            let scratch = memory.bytes();
            let mut seconds = [0.0; 5].map(|_: f64| {
                mesh.fill(0.0);
                let start = Instant::now();
                deposit(&mut mesh, &region, &positions, None, &assignment, scratch, &Serial).unwrap();
                start.elapsed().as_secs_f64()
            });
            seconds.sort_by(f64::total_cmp);
            println!("{name}: {:.3} s, Pylians3 {theirs:.3} s: x{:.2}", seconds[2], theirs / seconds[2]);
        }
    }
}

fn all(c: &mut Criterion) {
    peers(c);
    kernels::<f32>(c, "f32");
    kernels::<f64>(c, "f64");
}

criterion_group!(benches, all);
criterion_main!(benches);
