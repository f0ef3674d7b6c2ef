//! The built-in 3-D real transform against FFTW_MEASURE, in the same run and on the same layout.
//!
//! Floors: 5/2 N log2 N floating-point operations (the reported elements are these), and two sweeps that read and write N
//! numbers each. FIXPAIR_BENCH_LARGE=1 adds n = 512.

use std::hint::black_box;
use std::time::Duration;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use fixpair::exec::{Exec, Serial, Threads};
use fixpair::fft::{Fft3, Tables, Transform, recommended_padding};
use fixpair::mesh::{Brick, Space};
use fixpair::real::Real;

mod fftw;
#[path = "../examples/common/memory.rs"]
mod memory;

use memory::Memory;

fn bench<T: Real + fftw::Number>(criterion: &mut Criterion, name: &str) {
    let mut group = criterion.benchmark_group(name);
    group.sample_size(10).warm_up_time(Duration::from_millis(300)).measurement_time(Duration::from_secs(2));
    let large = std::env::var_os("FIXPAIR_BENCH_LARGE").is_some();
    let pool = Threads::new(2).unwrap();
    for n in [128_usize, 256, 384, 512] {
        if n == 512 && !large {
            continue;
        }
        let cells = (n * n * n) as f64;
        group.throughput(Throughput::Elements((2.5 * cells * cells.log2()) as u64));
        let values =
            |count: usize| (0..count).map(|i| T::from_f64((i % 1013) as f64 - 506.0)).collect::<Vec<T>>();
        if let Some(mut fftw) = fftw::Fftw::<T>::new(n, true, T::ZERO) {
            let scale = T::from_f64(1.0 / cells);
            // In place: the plans hold the array's address.
            fftw.data.copy_from_slice(&values(n * n * (n + 2)));
            pair(&mut group, "FFTW", n, &mut |direction| match direction {
                0 => fftw.forward(),
                1 => fftw.inverse(),
                _ => fftw.data.iter_mut().for_each(|x| *x = *x * scale),
            });
        }
        let mut tables = Memory::new(Tables::<T>::layout(n).unwrap());
        let tables = Tables::<T>::new(n, tables.bytes()).unwrap();
        let run = |name: &str, padding: usize, exec: &dyn Exec, group: &mut _| {
            let mut work = Memory::new(Transform::<T>::workspace(n).unwrap());
            let brick = Brick::whole_padded(n, Space::Configuration, padding).unwrap();
            let mut fft = Transform::new(&tables, brick, work.bytes(), exec).unwrap();
            let scale = T::from_f64(1.0 / cells);
            let mut data = values(fft.length());
            pair(group, name, n, &mut |direction| match direction {
                0 => fft.forward(black_box(&mut data)).unwrap(),
                1 => fft.inverse(black_box(&mut data)).unwrap(),
                _ => data.iter_mut().for_each(|x| *x = *x * scale),
            });
        };
        run("fixpair", 0, &Serial, &mut group);
        run("fixpair, padded", recommended_padding::<T>(n), &Serial, &mut group);
        run("fixpair, 2 threads", recommended_padding::<T>(n), &pool, &mut group);
    }
}

type Group<'a> = criterion::BenchmarkGroup<'a, criterion::measurement::WallTime>;

/// Forward and inverse, each timed alone; between them the mesh is scaled, so that it never overflows.
fn pair(group: &mut Group, name: &str, n: usize, call: &mut dyn FnMut(usize)) {
    for (which, label) in ["forward", "inverse"].into_iter().enumerate() {
        group.bench_function(BenchmarkId::new(format!("{name}, {label}"), n), |bencher| {
            bencher.iter_custom(|times| {
                let mut total = Duration::ZERO;
                for _ in 0..times {
                    for direction in 0..2 {
                        let start = std::time::Instant::now();
                        call(direction);
                        if direction == which {
                            total += start.elapsed();
                        }
                    }
                    call(2);
                }
                total
            });
        });
    }
}

fn all(criterion: &mut Criterion) {
    bench::<f64>(criterion, "f64");
    bench::<f32>(criterion, "f32");
}

criterion_group!(benches, all);
criterion_main!(benches);
