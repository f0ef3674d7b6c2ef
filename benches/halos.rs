//! Friends of friends, catalogue and spherical overdensities of 128^3 particles in a box of 256 Mpc/h, clustered and not, both precisions, one
//! thread and two. FIXPAIR_BENCH_PYTHON names a Python with kdcount to be timed in the same run.
//!
//! Clustered: Zel'dovich at z = 0, with 40% of the particles in Plummer spheres of 20 to 30000 particles, dN/dM as M^-1.9, each
//! taken from its own part of the lattice, so that neighbours in memory are mostly neighbours in space, as after a simulation.

use std::hint::black_box;
use std::process::Command;
use std::time::Instant;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use fixpair::cosmology::{Convention, Cosmology, EisensteinHu, Linear, Wiggles};
use fixpair::exec::{Exec, Serial, Threads};
use fixpair::fft::{Fft3, Tables, Transform, recommended_padding};
use fixpair::halos::{
    Density, Halo, Shrink, Sphere, fof_labels, fof_labels_scratch, halos, halos_scratch, linking_length,
    particle_mass, refine_centres, spheres, spheres_scratch,
};
use fixpair::initial::conditions::{
    InitialConditions, Order, initial_conditions, initial_conditions_scratch,
};
use fixpair::initial::particles::Components;
use fixpair::initial::png::Local;
use fixpair::initial::shape::Shape;
use fixpair::mesh::{Brick, Space};
use fixpair::noise::Realisation;
use fixpair::pm::Positions;
use fixpair::real::Real;

#[path = "../examples/common/memory.rs"]
mod memory;

use memory::Memory;

const N: usize = 128;
const BOX_SIZE: f64 = 256.0;
const TOTAL: u64 = (N * N * N) as u64;

/// Numbers in no order.
struct Random(u64);

impl Random {
    /// In [0, 1).
    fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }
}

/// Triples of coordinates of Zel'dovich particles at z = 0.
fn linear() -> Vec<f64> {
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
    let mut tables = Memory::new(Tables::<f64>::layout(N).unwrap());
    let tables = Tables::<f64>::new(N, tables.bytes()).unwrap();
    let mut work = Memory::new(Transform::<f64>::workspace(N).unwrap());
    let cells = Brick::whole_padded(N, Space::Configuration, recommended_padding::<f64>(N)).unwrap();
    let mut fft = Transform::new(&tables, cells, work.bytes(), &Serial).unwrap();
    let (mut x, mut v) = (vec![0.0; 3 * N * N * N], vec![0.0; 3 * N * N * N]);
    let mut scratch = Memory::new(initial_conditions_scratch(Order::First.into(), &fft, None).unwrap());
    initial_conditions(
        &mut Components::triples(&mut x).unwrap(),
        &mut Components::triples(&mut v).unwrap(),
        &conditions,
        &mut fft as &mut dyn Fft3<f64>,
        None,
        scratch.bytes(),
        &Serial,
    )
    .unwrap();
    x
}

/// The same with 40% of the particles in clumps.
fn clustered() -> Vec<f64> {
    let mut x = linear();
    let mut random = Random(3);
    let mut free = vec![true; N * N * N];
    let mut left = 2 * N * N * N / 5;
    while left > 0 {
        // dN/dM as M^-1.9 from 20 to 30000.
        let (low, high) = (20_f64.powf(-0.9), 30_000_f64.powf(-0.9));
        let members = (low + random.unit() * (high - low)).powf(-1.0 / 0.9);
        let side = members.cbrt().ceil() as usize;
        let corner = [0; 3].map(|_| (random.unit() * N as f64) as usize);
        let cube = (0..side * side * side).map(|i| {
            let [a, b, c] = [i / (side * side), i / side % side, i % side];
            ((corner[0] + a) % N * N + (corner[1] + b) % N) * N + (corner[2] + c) % N
        });
        let taken: Vec<usize> = cube.filter(|&i| free[i]).take((members as usize).min(left)).collect();
        let Some(&first) = taken.get(taken.len() / 2) else { continue };
        let centre = [0, 1, 2].map(|axis| x[3 * first + axis]);
        // Radius of 200 times the mean density; the core a tenth of it.
        let radius = BOX_SIZE / N as f64 * (3.0 * taken.len() as f64 / (800.0 * std::f64::consts::PI)).cbrt();
        let core = 0.1 * radius;
        left -= taken.len();
        for i in taken {
            free[i] = false;
            let r = loop {
                let r = core / (random.unit().powf(-2.0 / 3.0) - 1.0).sqrt();
                if r < radius {
                    break r;
                }
            };
            let (cos, turn) = (2.0 * random.unit() - 1.0, std::f64::consts::TAU * random.unit());
            let sin = (1.0 - cos * cos).sqrt();
            let direction = [sin * turn.cos(), sin * turn.sin(), cos];
            for axis in 0..3 {
                x[3 * i + axis] = (centre[axis] + r * direction[axis]).rem_euclid(BOX_SIZE);
            }
        }
    }
    x
}

/// In no order and not clustered.
fn uniform() -> Vec<f64> {
    let mut random = Random(1);
    (0..3 * N * N * N).map(|_| BOX_SIZE * random.unit()).collect()
}

/// The clustered particles in random order.
fn shuffled() -> Vec<f64> {
    let mut x = clustered();
    let mut random = Random(5);
    for i in (1..N * N * N).rev() {
        let j = (random.unit() * (i + 1) as f64) as usize;
        for axis in 0..3 {
            x.swap(3 * i + axis, 3 * j + axis);
        }
    }
    x
}

fn to<T: Real>(x: &[f64]) -> Vec<T> {
    x.iter().map(|&x| T::from_f64(x)).collect()
}

fn length() -> f64 {
    linking_length(0.2, BOX_SIZE, TOTAL).unwrap()
}

fn kernels<T: Real>(c: &mut Criterion, real: &str) {
    let pool = Threads::new(2).unwrap();
    let sets = [("clustered", clustered()), ("shuffled", shuffled()), ("uniform", uniform())];
    for (name, x) in &sets {
        let x = to::<T>(x);
        let position = Positions::triples(&x).unwrap();
        let particles = position.len();
        let mut labels = vec![0; particles];
        let mut found = vec![Halo::default(); particles / 20];
        let layouts =
            [fof_labels_scratch::<T>(particles), halos_scratch(particles), spheres_scratch::<T>(particles)];
        let [mut fof, mut list, mut grow] = layouts.map(|layout| Memory::new(layout.unwrap()));
        let mass = particle_mass(0.27, BOX_SIZE, TOTAL).unwrap();
        for (threads, exec) in [(1, &Serial as &dyn Exec), (2, &pool)] {
            let mut group = c.benchmark_group(format!("{real}_{name}_{threads}"));
            group.sample_size(10).throughput(Throughput::Elements(particles as u64));
            group.bench_function("fof_labels", |b| {
                b.iter(|| {
                    let labels = black_box(&mut labels);
                    fof_labels(labels, &position, None, BOX_SIZE, length(), fof.bytes(), exec).unwrap();
                });
            });
            let mut count = 0;
            group.bench_function("halos", |b| {
                b.iter(|| {
                    let velocity = Some(&position);
                    let scratch = list.bytes();
                    count =
                        halos(&mut found, &labels, &position, velocity, BOX_SIZE, 20, mass, scratch, exec)
                            .unwrap();
                });
            });
            let first: Vec<[f64; 3]> = found[..count].iter().map(|halo| halo.centre).collect();
            let radii: Vec<f64> = found[..count].iter().map(|halo| 2.0 * halo.radius).collect();
            let mut centres = first.clone();
            group.bench_function("refine_centres", |b| {
                b.iter(|| {
                    centres.copy_from_slice(&first);
                    let shrink = Shrink { factor: 0.9, n_min: 20 };
                    refine_centres(&mut centres, &radii, &position, BOX_SIZE, &shrink, grow.bytes(), exec)
                        .unwrap();
                });
            });
            let mut around = vec![Sphere::default(); count];
            let density =
                Density { box_size: BOX_SIZE, particles_total: TOTAL, particle_mass: mass, n_min: 20 };
            group.bench_function("spheres", |b| {
                b.iter(|| {
                    spheres(&mut around, &centres, &[200.0], &position, &density, grow.bytes(), exec)
                        .unwrap();
                });
            });
            group.finish();
        }
    }
}

/// kdcount and this library, clustered, one thread: seconds, medians of five of ours, and the ratio.
fn peers(_: &mut Criterion) {
    let Some(python) = std::env::var_os("FIXPAIR_BENCH_PYTHON") else { return };
    let x = clustered();
    let file = std::env::temp_dir().join("fixpair_bench_fof.f64");
    std::fs::write(&file, x.iter().flat_map(|x| x.to_le_bytes()).collect::<Vec<u8>>()).unwrap();
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/benches/peers/fof.py");
    let arguments = [BOX_SIZE, length()].map(|x| x.to_string());
    let output = Command::new(python).arg(script).arg(&file).args(arguments).output().unwrap();
    std::fs::remove_file(&file).unwrap();
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    for [name, theirs, groups] in text.lines().filter_map(|line| {
        let words: Vec<&str> = line.split_whitespace().collect();
        <[&str; 3]>::try_from(words).ok()
    }) {
        let (Ok(theirs), Ok(groups)) = (theirs.parse::<f64>(), groups.parse::<usize>()) else { continue };
        let position = Positions::triples(&x).unwrap();
        let mut labels = vec![0; position.len()];
        let mut scratch = Memory::new(fof_labels_scratch::<f64>(position.len()).unwrap());
        let mut seconds = [0.0; 5].map(|_: f64| {
            let start = Instant::now();
            fof_labels(&mut labels, &position, None, BOX_SIZE, length(), scratch.bytes(), &Serial).unwrap();
            start.elapsed().as_secs_f64()
        });
        seconds.sort_by(f64::total_cmp);
        let ours = labels.iter().enumerate().filter(|&(i, &label)| i as u64 == label).count();
        println!(
            "{name}: {theirs:.3} s, {groups} groups; fixpair {:.3} s, {ours} groups: x{:.1}",
            seconds[2],
            theirs / seconds[2]
        );
    }
}

fn all(c: &mut Criterion) {
    peers(c);
    kernels::<f32>(c, "f32");
    kernels::<f64>(c, "f64");
}

criterion_group!(benches, all);
criterion_main!(benches);
