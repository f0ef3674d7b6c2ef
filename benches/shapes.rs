//! Initial conditions beyond local f_NL and second order: other shapes, and 3LPT.
//!
//! n = 128; 256 too where FIXPAIR_BENCH_LARGE is set. Throughput is in cells.
//!
//! Peers at 128^3 in f64 (whole programs, one core, CPU seconds, start-up and output included): 2LPTPNG 1.99 (equilateral) and 2.20
//! (orthogonal, LSS template); monofonIC, 3LPT with products dealiased, 13.3 (8.8 in f32), 171 bytes a cell (107).

use std::time::Duration;

use criterion::{Criterion, criterion_group, criterion_main};
use fixpair::cosmology::{Convention, Cosmology, EisensteinHu, Linear, Wiggles};
use fixpair::exec::{Exec, Serial, Threads};
use fixpair::initial::conditions::{InitialConditions, Order};
use fixpair::initial::png::Local;
use fixpair::initial::shape::Shape;
use fixpair::noise::Realisation;
use fixpair::real::Real;

#[path = "../examples/common/memory.rs"]
mod memory;
#[path = "common/one_call.rs"]
mod one_call;

use one_call::one_call;

fn conditions(n: usize, f_nl: f64, shape: Shape, order: Order) -> InitialConditions<'static> {
    let cosmology = Cosmology::goliat();
    let fit = EisensteinHu::new(&cosmology, Wiggles::With).unwrap();
    InitialConditions {
        realisation: Realisation::new(7),
        cosmology,
        linear: Linear::from_eisenstein_hu(fit, cosmology.n_s, 1.0).unwrap().with_sigma8(0.8).unwrap(),
        redshift: 32.0,
        box_size: n as f64,
        local: Local { f_nl, g_nl: 0.0 },
        shape: shape.rows(),
        species: None,
        convention: Convention::Cmb,
        order,
    }
}

fn all_of<T: Real>(criterion: &mut Criterion, name: &str) {
    let mut group = criterion.benchmark_group(format!("beyond/{name}"));
    group.sample_size(10).warm_up_time(Duration::from_millis(100)).measurement_time(Duration::from_secs(3));
    let pool = Threads::new(2).unwrap();
    let large = std::env::var_os("FIXPAIR_BENCH_LARGE").is_some();
    for n in if large { vec![128, 256] } else { vec![128] } {
        let shapes = [
            ("local", Shape::Local),
            ("equilateral", Shape::Equilateral),
            ("orthogonal", Shape::Orthogonal),
            ("orthogonal LSS", Shape::OrthogonalLss),
        ];
        for (shape_name, shape) in shapes {
            for (kind, dealiased) in [("aliased", false), ("dealiased", true)] {
                let conditions = conditions(n, 100.0, shape, Order::Second);
                one_call::<T>(
                    &mut group,
                    &format!("{shape_name}/{kind}"),
                    &conditions,
                    n,
                    dealiased,
                    &Serial,
                );
            }
        }
        let third = conditions(n, 0.0, Shape::Local, Order::Third);
        for (threads, exec) in [(1, &Serial as &dyn Exec), (2, &pool)] {
            one_call::<T>(&mut group, &format!("3LPT/{threads}"), &third, n, false, exec);
        }
    }
}

fn all(criterion: &mut Criterion) {
    all_of::<f64>(criterion, "f64");
    all_of::<f32>(criterion, "f32");
}

criterion_group!(benches, all);
criterion_main!(benches);
