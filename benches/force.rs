//! Forces from modes of a 256^3 density: three components, one, and the potential, both precisions, one thread and two; and a
//! plain copy of one mesh to three, the least that memory asks for.

use std::hint::black_box;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use fixpair::exec::{Exec, Serial, Threads};
use fixpair::mesh::{Brick, Space};
use fixpair::pm::{Difference, ForceLaw, Window, force, force_scratch, forces, potential};
use fixpair::real::Real;

const N: usize = 256;

fn kernels<T: Real>(c: &mut Criterion, real: &str) {
    let brick = Brick::whole(N, Space::Fourier).unwrap();
    let law = ForceLaw {
        gradient: Difference::FourPoint,
        window: Some((Window::CloudInCell, 2)),
        ..ForceLaw::default()
    };
    let mut memory = vec![0; force_scratch(N).unwrap().size + 64];
    let skip = memory.as_ptr().align_offset(64);
    let scratch = &mut memory[skip..];
    let pool = Threads::new(2).unwrap();
    let modes = (0..brick.reals()).map(|i| T::from_f64((i % 1021) as f64 - 510.0)).collect::<Vec<T>>();
    let [mut x, mut y, mut z] = [modes.clone(), modes.clone(), modes.clone()];
    for (threads, exec) in [(1, &Serial as &dyn Exec), (2, &pool)] {
        let mut group = c.benchmark_group(format!("force_{real}_{threads}"));
        group.sample_size(10).throughput(Throughput::Elements(brick.elements() as u64));
        // The first mesh is filled anew, outside the time: what a force leaves becomes subnormal when it is taken again and again.
        group.bench_function("forces", |b| {
            b.iter_custom(|times| {
                (0..times)
                    .map(|_| {
                        x.copy_from_slice(&modes);
                        let start = std::time::Instant::now();
                        let meshes = [&mut x, &mut y, &mut z].map(|mesh| black_box(&mut mesh[..]));
                        forces(meshes, &brick, &law, 1000.0, 1e3, scratch, exec).unwrap();
                        start.elapsed()
                    })
                    .sum()
            });
        });
        group.bench_function("force", |b| {
            b.iter(|| {
                force(black_box(&mut x), &modes, &brick, 2, &law, 1000.0, 1e3, scratch, exec).unwrap();
            });
        });
        group.bench_function("potential", |b| {
            b.iter_custom(|times| {
                (0..times)
                    .map(|_| {
                        x.copy_from_slice(&modes);
                        let start = std::time::Instant::now();
                        potential(black_box(&mut x), &brick, &law, 1000.0, 1e3, scratch, exec).unwrap();
                        start.elapsed()
                    })
                    .sum()
            });
        });
        if threads == 1 {
            group.bench_function("copy", |b| {
                b.iter(|| {
                    for i in (0..modes.len()).step_by(256) {
                        let part = i..modes.len().min(i + 256);
                        for mesh in [&mut x, &mut y, &mut z] {
                            mesh[part.clone()].copy_from_slice(&modes[part.clone()]);
                        }
                    }
                    black_box((&mut x, &mut y, &mut z));
                });
            });
        }
        group.finish();
    }
}

fn all(c: &mut Criterion) {
    kernels::<f32>(c, "f32");
    kernels::<f64>(c, "f64");
}

criterion_group!(benches, all);
criterion_main!(benches);
