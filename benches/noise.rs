//! Modes of white noise a second, one core; beside it raw Philox, and the obvious scalar code with libm as a peer. Then the noise of
//! N-GenIC, whole, against its draws alone through GSL's ranlxd1 in the same run.

use std::hint::black_box;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use fixpair::exec::Serial;
use fixpair::mesh::{Brick, Space};
use fixpair::noise::philox::philox4x32_10;
use fixpair::noise::{
    Amplitude, Nyquist, Realisation, Scheme, ngenic_seeds, white_modes, white_modes_coloured,
};
use fixpair::real::Real;

mod gsl;

const N: usize = 256;

fn modes<T: Real>(c: &mut Criterion, name: &str) {
    let brick = Brick::whole(N, Space::Fourier).unwrap();
    let mut out = vec![T::ZERO; brick.reals()];
    let table: Vec<f64> = (0..=3 * (N / 2) * (N / 2)).map(|s| 1.0 / (1.0 + s as f64)).collect();
    let mut group = c.benchmark_group(format!("white_{name}_{N}"));
    group.sample_size(20).throughput(Throughput::Elements(brick.elements() as u64));
    for amplitude in [Amplitude::Normal, Amplitude::Fixed] {
        let realisation = Realisation { amplitude, ..Realisation::new(7) };
        group.bench_function(format!("{amplitude:?}"), |b| {
            b.iter(|| white_modes(black_box(&mut out), &brick, &realisation, &Serial).unwrap());
        });
    }
    let normal = Realisation::new(7);
    group.bench_function("Normal coloured", |b| {
        b.iter(|| white_modes_coloured(black_box(&mut out), &brick, &normal, &table, &Serial).unwrap());
    });
    group.finish();
}

/// u1 and u2 of every mode of N-GenIC's half space, as 2LPTic draws them.
fn draws_of_gsl(stream: &mut gsl::Ranlxd1, table: &[u32], mut use_it: impl FnMut(f64, f64)) {
    for &seed in table {
        stream.set(seed);
        for _ in 0..N / 2 {
            let u1 = stream.uniform();
            let mut u2 = stream.uniform();
            while u2 == 0.0 {
                u2 = stream.uniform();
            }
            use_it(u1, u2);
        }
    }
}

fn ngenic(c: &mut Criterion) {
    let brick = Brick::whole(N, Space::Fourier).unwrap();
    let mut group = c.benchmark_group(format!("ngenic_{N}"));
    group.sample_size(10).throughput(Throughput::Elements((N * N * N / 2) as u64));
    let choice = Realisation { scheme: Scheme::NGenIc, ..Realisation::new(7) };
    let filled = Realisation { scheme: Scheme::FastPm, nyquist: Nyquist::Filled, ..choice };
    let mut double = vec![0.0_f64; brick.reals()];
    let mut single = vec![0.0_f32; brick.reals()];
    let mut table = vec![0; N * N];
    group.bench_function("seeds", |b| b.iter(|| ngenic_seeds(black_box(&mut table), &brick, 7).unwrap()));
    for (name, choice) in [("modes", choice), ("modes of FastPM, filled", filled)] {
        group.bench_function(format!("{name}, f64"), |b| {
            b.iter(|| white_modes(black_box(&mut double), &brick, &choice, &Serial).unwrap());
        });
        group.bench_function(format!("{name}, f32"), |b| {
            b.iter(|| white_modes(black_box(&mut single), &brick, &choice, &Serial).unwrap());
        });
    }
    if let Some(mut stream) = gsl::Ranlxd1::new() {
        group.bench_function("draws of GSL", |b| {
            b.iter(|| {
                let mut sum = 0.0;
                draws_of_gsl(&mut stream, &table, |u1, u2| sum += u1 - u2);
                black_box(sum)
            });
        });
        group.bench_function("modes with GSL and libm", |b| {
            b.iter(|| {
                let mut sum = 0.0;
                draws_of_gsl(&mut stream, &table, |u1, u2| {
                    let modulus = libm::sqrt(-libm::log(u2));
                    let (sine, cosine) = libm::sincos(core::f64::consts::TAU * u1);
                    sum += modulus * cosine + modulus * sine;
                });
                black_box(sum)
            });
        });
    } else {
        println!("no GSL (libgsl-dev) on this machine");
    }
    group.finish();
}

fn peers(c: &mut Criterion) {
    const COUNT: u32 = 1 << 20;
    let mut group = c.benchmark_group("scalar");
    group.sample_size(20).throughput(Throughput::Elements(u64::from(COUNT)));
    group.bench_function("philox blocks", |b| {
        b.iter(|| (0..COUNT).fold(0, |sum, l| sum ^ philox4x32_10([1, l, 2, 3], black_box([4, 5]))[0]));
    });
    let mut out = vec![[0.0; 2]; COUNT as usize];
    group.bench_function("modes with libm", |b| {
        b.iter(|| {
            for (l, mode) in (0_u32..).zip(black_box(&mut out)) {
                let words = philox4x32_10([1, l, 2, 3], [4, 5]).map(u64::from);
                let scale = 1.0 / (1_u64 << 53) as f64;
                let u1 = ((words[1] << 32 | words[0]) >> 11) as f64 * scale;
                let u2 = (((words[3] << 32 | words[2]) >> 11) + 1) as f64 * scale;
                let modulus = libm::sqrt(-libm::log(u2));
                let (sine, cosine) = libm::sincos(core::f64::consts::TAU * u1);
                *mode = [modulus * cosine, modulus * sine];
            }
        });
    });
    group.finish();
}

fn all(c: &mut Criterion) {
    modes::<f64>(c, "f64");
    modes::<f32>(c, "f32");
    peers(c);
    ngenic(c);
}

criterion_group!(benches, all);
criterion_main!(benches);
