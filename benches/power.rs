//! Spectra of a 256^3 mesh on one core, in seconds and in nanoseconds a mode.
//!
//! `whole/256`: a mesh of single precision in configuration space, transformed in place, to P_0, P_2 and P_4 in unit shells up to the corner of the
//! mesh: what Pylians3 does in 1.06 s. `sweep/...`: the pass over modes alone, for other multipoles, bins and precision. `xi/...`: the pass
//! over separations. Shells end at the corner, or at the Nyquist frequency where the name says so.
//!
//! With FIXPAIR_BENCH_PYTHON=<python that has Pylians3> the peer runs on the same core and machine, and the ratio is printed.

use std::env;
use std::hint::black_box;
use std::process::Command;
use std::time::{Duration, Instant};

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use fixpair::estimate::binning::{Bin, Binning, Second, normalise, read_sums};
use fixpair::estimate::compensation::Compensation;
use fixpair::estimate::correlation::{correlation_sums, correlation_sums_scratch};
use fixpair::estimate::power::{power_sums, power_sums_scratch};
use fixpair::exec::Serial;
use fixpair::fft::{Fft3, Tables, Transform, recommended_padding};
use fixpair::mesh::{Brick, Space};
use fixpair::pm::Window;
use fixpair::real::Real;

#[path = "../examples/common/memory.rs"]
mod memory;

use memory::Memory;

const N: usize = 256;

/// Noise, at the address of each real.
fn noise<T: Real>(length: usize) -> Vec<T> {
    let mut state = 1_u64;
    let mut next = || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        T::from_f64((state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5)
    };
    (0..length).map(|_| next()).collect()
}

/// b^2 to the corner of the mesh, or to the Nyquist frequency.
fn shells(corner: bool) -> Vec<u64> {
    let last = if corner { (N as f64 / 2.0 * 3.0_f64.sqrt()) as u64 + 1 } else { N as u64 / 2 };
    (1..=last).map(|b| b * b).collect()
}

fn sweep<T: Real>(criterion: &mut Criterion, name: &str, binning: &Binning<'_>, fields: usize) {
    let brick = Brick::whole_padded(N, Space::Fourier, recommended_padding::<T>(N)).unwrap();
    let data: Vec<Vec<T>> = (0..fields).map(|_| noise(brick.reals())).collect();
    let fields: Vec<&[T]> = data.iter().map(Vec::as_slice).collect();
    let pairs: Vec<[usize; 2]> = if fields.len() == 1 { vec![[0, 0]] } else { vec![[0, 0], [0, 1], [1, 1]] };
    let compensation = vec![Compensation::Aliased(Window::CloudInCell); fields.len()];
    let mut scratch = Memory::new(power_sums_scratch(&brick, binning, pairs.len()).unwrap());
    let mut words = vec![0; binning.words(pairs.len()).unwrap()];
    let mut group = criterion.benchmark_group("sweep");
    group.throughput(Throughput::Elements(brick.elements() as u64));
    group.bench_function(name, |bench| {
        bench.iter(|| {
            power_sums(
                black_box(&mut words),
                &fields,
                &pairs,
                &compensation,
                &brick,
                binning,
                scratch.bytes(),
                &Serial,
            )
            .unwrap();
        });
    });
    group.finish();
}

fn sweeps(criterion: &mut Criterion) {
    let (corner, nyquist) = (shells(true), shells(false));
    let wedges: Vec<f64> = (0..=10).map(|c| f64::from(c) / 10.0).collect();
    let even = Binning { orders: 0b10101, ..Binning::shells(&corner) };
    sweep::<f32>(criterion, "f32/l = 0", &Binning::shells(&corner), 1);
    sweep::<f32>(criterion, "f32/l = 0, 2, 4", &even, 1);
    sweep::<f32>(criterion, "f32/l = 0, 2, 4 to Nyquist", &Binning { edges: &nyquist, ..even }, 1);
    sweep::<f32>(
        criterion,
        "f32/l = 0..4 about (1, 2, 3)",
        &Binning { axis: [1.0, 2.0, 3.0], orders: 31, ..even },
        1,
    );
    sweep::<f32>(
        criterion,
        "f32/10 wedges",
        &Binning { second: Second::Cosine(&wedges), orders: 1, ..even },
        1,
    );
    sweep::<f32>(criterion, "f32/l = 0, 2, 4 of 3 pairs of 2 fields", &even, 2);
    sweep::<f64>(criterion, "f64/l = 0, 2, 4", &even, 1);
}

fn xi(criterion: &mut Criterion) {
    let edges = shells(false);
    let binning = Binning { orders: 0b10101, ..Binning::shells(&edges) };
    let brick = Brick::whole_padded(N, Space::Configuration, recommended_padding::<f32>(N)).unwrap();
    let mesh = noise::<f32>(brick.reals());
    let mut scratch = Memory::new(correlation_sums_scratch(&brick, &binning, 1).unwrap());
    let mut words = vec![0; binning.words(1).unwrap()];
    let mut group = criterion.benchmark_group("xi");
    group.throughput(Throughput::Elements(brick.elements() as u64));
    group.bench_function("f32/l = 0, 2, 4", |bench| {
        bench.iter(|| {
            correlation_sums(black_box(&mut words), &[&mesh], &brick, &binning, scratch.bytes(), &Serial)
                .unwrap();
        });
    });
    group.finish();
}

/// From cells to P_l: one call after another, as a user writes it.
fn whole(criterion: &mut Criterion) {
    let mut tables = Memory::new(Tables::<f32>::layout(N).unwrap());
    let tables = Tables::<f32>::new(N, tables.bytes()).unwrap();
    let mut work = Memory::new(Transform::<f32>::workspace(N).unwrap());
    let cells = Brick::whole_padded(N, Space::Configuration, recommended_padding::<f32>(N)).unwrap();
    let mut fft = Transform::new(&tables, cells, work.bytes(), &Serial).unwrap();
    let brick = *fft.fourier();
    let mut mesh = noise::<f32>(fft.length());
    let edges = shells(true);
    let binning = Binning { orders: 0b10101, ..Binning::shells(&edges) };
    let compensation = [Compensation::Aliased(Window::CloudInCell)];
    let mut scratch = Memory::new(power_sums_scratch(&brick, &binning, 1).unwrap());
    let mut words = vec![0; binning.words(1).unwrap()];
    let mut bins = vec![Bin::default(); binning.bins().unwrap()];
    let mut power = vec![0.0; bins.len() * 3];
    let cells = mesh.clone();
    let mut measure = |mesh: &mut [f32]| {
        fft.forward(mesh).unwrap();
        words.fill(0);
        power_sums(&mut words, &[mesh], &[[0, 0]], &compensation, &brick, &binning, scratch.bytes(), &Serial)
            .unwrap();
        read_sums(&mut bins, &mut power, &words, &binning, 1).unwrap();
        normalise(&mut power, &bins, binning.orders, 1.0).unwrap();
        black_box(power[0])
    };
    let mut group = criterion.benchmark_group("whole");
    let mut times = Vec::new();
    group.bench_function("256", |bench| {
        bench.iter_custom(|iterations| {
            let mut total = Duration::ZERO;
            for _ in 0..iterations {
                mesh.copy_from_slice(&cells);
                let start = Instant::now();
                measure(&mut mesh);
                total += start.elapsed();
            }
            times.push(total / iterations as u32);
            total
        });
    });
    group.finish();
    times.sort();
    if let (Some(ours), Some(python)) = (times.get(times.len() / 2), env::var_os("FIXPAIR_BENCH_PYTHON")) {
        let script = concat!(env!("CARGO_MANIFEST_DIR"), "/benches/peers/pylians_power.py");
        let output = Command::new(python).arg(script).arg(N.to_string()).output().expect("the peer runs");
        for line in String::from_utf8_lossy(&output.stdout).lines() {
            if let Some((name, seconds)) = line.rsplit_once(' ')
                && let Ok(seconds) = seconds.parse::<f64>()
            {
                println!(
                    "{name}: {seconds:.3} s, {:.1} times ours ({:.3} s)",
                    seconds / ours.as_secs_f64(),
                    ours.as_secs_f64()
                );
            }
        }
    }
}

fn few() -> Criterion {
    Criterion::default()
        .sample_size(15)
        .warm_up_time(Duration::from_millis(500))
        .measurement_time(Duration::from_secs(3))
}

criterion_group! { name = power; config = few(); targets = whole, sweeps, xi }
criterion_main!(power);
