//! Initial conditions from seed to particles, and their stages.
//!
//! `whole/...`: one call, 2LPT, f_NL = 100, products aliasing or dealiased on a mesh of 3/2 the side. `stage/...`: what it is made of.
//! n = 128 and 256; 512 too where FIXPAIR_BENCH_LARGE is set. Throughput is in cells.
//!
//! Peers (whole programs, one core, CPU seconds, start-up and output included): 2LPTPNG at 256^3, f64, local f_NL: 11.8;
//! monofonIC, dealiased: 27.9 in f64 and 21.2 in f32. Memory: 122 bytes a cell for 2LPTPNG; the bench prints ours.

use std::time::Duration;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use fixpair::cosmology::{
    Convention, Cosmology, EisensteinHu, Linear, Wiggles, alpha_table, mode_table_length,
    potential_amplitude_table,
};
use fixpair::exec::{Exec, Serial, Threads};
use fixpair::fft::{Fft3, Tables};
use fixpair::initial::conditions::{InitialConditions, Order};
use fixpair::initial::lpt::{displacement, second_order_source};
use fixpair::initial::modes::scale_by_table;
use fixpair::initial::particles::{Components, Step, displace};
use fixpair::initial::png::{Local, add_local};
use fixpair::initial::shape::Shape;
use fixpair::noise::{Realisation, white_modes_coloured};
use fixpair::real::Real;

#[path = "../examples/common/memory.rs"]
mod memory;
#[path = "common/one_call.rs"]
mod one_call;

use memory::Memory;
use one_call::{Built, one_call};

fn conditions(box_size: f64) -> InitialConditions<'static> {
    let cosmology = Cosmology::goliat();
    let fit = EisensteinHu::new(&cosmology, Wiggles::With).unwrap();
    InitialConditions {
        realisation: Realisation::new(7),
        cosmology,
        linear: Linear::from_eisenstein_hu(fit, cosmology.n_s, 1.0).unwrap().with_sigma8(0.8).unwrap(),
        redshift: 32.0,
        box_size,
        local: Local { f_nl: 100.0, g_nl: 0.0 },
        shape: Shape::Local.rows(),
        species: None,
        convention: Convention::Cmb,
        order: Order::Second,
    }
}

fn sides() -> Vec<usize> {
    let large = std::env::var_os("FIXPAIR_BENCH_LARGE").is_some();
    if large { vec![128, 256, 512] } else { vec![128, 256] }
}

fn whole<T: Real>(criterion: &mut Criterion, name: &str) {
    let mut group = criterion.benchmark_group(format!("whole/{name}"));
    group.sample_size(10).warm_up_time(Duration::from_millis(100)).measurement_time(Duration::from_secs(5));
    let pool = Threads::new(2).unwrap();
    for n in sides() {
        let conditions = conditions(n as f64);
        for (kind, dealiased) in [("aliased", false), ("dealiased", true)] {
            for (threads, exec) in [(1, &Serial as &dyn Exec), (2, &pool)] {
                one_call::<T>(&mut group, &format!("{kind}/{threads}"), &conditions, n, dealiased, exec);
            }
        }
    }
}

fn stages<T: Real>(criterion: &mut Criterion, name: &str) {
    let mut group = criterion.benchmark_group(format!("stage/{name}"));
    group.sample_size(10).warm_up_time(Duration::from_millis(100)).measurement_time(Duration::from_secs(2));
    let exec = &Serial;
    for n in sides() {
        let cells = n * n * n;
        group.throughput(Throughput::Elements(cells as u64));
        let mut tables = Memory::new(Tables::<T>::layout(n).unwrap());
        let tables = Tables::<T>::new(n, tables.bytes()).unwrap();
        let mut built = Built::new(&tables, exec);
        let mut fft = built.transform();
        let (modes, lattice) = (*fft.fourier(), *fft.configuration());
        let conditions = conditions(n as f64);
        let poisson = conditions.poisson().unwrap();
        let mut amplitude = vec![0.0; mode_table_length(n).unwrap()];
        let mut alpha = amplitude.clone();
        let mut meshes: Vec<Vec<T>> = (0..5).map(|_| vec![T::ZERO; fft.length()]).collect();
        let [density, source, a, b, c] = meshes.get_disjoint_mut([0, 1, 2, 3, 4]).unwrap();
        let (mut x, mut v) = (vec![T::ZERO; 3 * cells], vec![T::ZERO; 3 * cells]);
        group.bench_function(BenchmarkId::new("tables", n), |bencher| {
            bencher.iter(|| {
                potential_amplitude_table(exec, &poisson, n, conditions.box_size, &mut amplitude).unwrap();
                alpha_table(exec, &poisson, n, conditions.box_size, &mut alpha).unwrap();
            });
        });
        group.bench_function(BenchmarkId::new("noise", n), |bencher| {
            let realisation = conditions.realisation;
            bencher.iter(|| white_modes_coloured(density, &modes, &realisation, &amplitude, exec).unwrap());
        });
        group.bench_function(BenchmarkId::new("png", n), |bencher| {
            let mut partial = vec![[0.0]; n];
            bencher.iter(|| {
                add_local(density, &modes, conditions.local, &mut fft, a, &mut partial, exec).unwrap();
            });
        });
        group.bench_function(BenchmarkId::new("alpha", n), |bencher| {
            bencher.iter(|| scale_by_table(density, &modes, &alpha, exec).unwrap());
        });
        white_modes_coloured(density, &modes, &conditions.realisation, &amplitude, exec).unwrap();
        scale_by_table(density, &modes, &alpha, exec).unwrap();
        group.bench_function(BenchmarkId::new("second-order source", n), |bencher| {
            bencher.iter(|| {
                second_order_source(source, density, &modes, &mut fft, [&mut a[..], b, c], exec).unwrap();
            });
        });
        group.bench_function(BenchmarkId::new("one displacement", n), |bencher| {
            bencher.iter(|| displacement(a, density, &modes, 0, 1.0, &mut fft, exec).unwrap());
        });
        group.bench_function(BenchmarkId::new("one transform", n), |bencher| {
            bencher.iter(|| fft.inverse(b).unwrap());
        });
        group.bench_function(BenchmarkId::new("one axis of particles", n), |bencher| {
            b.fill(T::ZERO);
            let step = Step { box_size: conditions.box_size, first_velocity: 1.0, second_velocity: 2.0 };
            bencher.iter(|| {
                displace(
                    &mut Components::triples(&mut x).unwrap(),
                    &mut Components::triples(&mut v).unwrap(),
                    a,
                    Some(b),
                    &lattice,
                    1,
                    &step,
                    exec,
                )
                .unwrap();
            });
        });
    }
}

fn all(criterion: &mut Criterion) {
    whole::<f64>(criterion, "f64");
    whole::<f32>(criterion, "f32");
    stages::<f64>(criterion, "f64");
    stages::<f32>(criterion, "f32");
}

criterion_group!(benches, all);
criterion_main!(benches);
