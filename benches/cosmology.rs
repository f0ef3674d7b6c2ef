//! The room's few costs: growth, sigma8, and the mode tables of a 512^3 mesh (196,609 entries).

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use fixpair::cosmology::{
    Convention, Cosmology, EisensteinHu, Growth, Linear, Poisson, Table, Wiggles, alpha_table, growth,
    growth_many, mode_table_length, potential_amplitude_table,
};
use fixpair::exec::{Exec, Serial, Threads};

#[allow(dead_code, reason = "only the embedded spectrum is read here")]
#[path = "../examples/common/boltzmann.rs"]
mod boltzmann;

fn background(c: &mut Criterion) {
    let cosmology = Cosmology::goliat();
    c.bench_function("growth", |b| b.iter(|| growth(black_box(&cosmology), black_box(0.5))));
    let a: Vec<f64> = (1..=1000).map(|i| f64::from(i) * 1e-3).collect();
    let mut out = vec![Growth::default(); a.len()];
    c.bench_function("growth_many/1000", |b| b.iter(|| growth_many(&cosmology, black_box(&a), &mut out)));
}

fn tables(c: &mut Criterion) {
    let cosmology = Cosmology::goliat();
    let file = boltzmann::embedded().expect("embedded data");
    let table = Table::new(&file.k, &file.value).expect("embedded data");
    let power = Linear::from_power(table, 0.96).expect("embedded data");
    let fit = EisensteinHu::new(&cosmology, Wiggles::With).expect("a cosmology like ours");
    let fit = Linear::from_eisenstein_hu(fit, 0.96, 4e6).expect("a cosmology like ours");
    c.bench_function("sigma8/table", |b| b.iter(|| black_box(&power).sigma(8.0)));
    c.bench_function("sigma8/eisenstein_hu", |b| b.iter(|| black_box(&fit).sigma(8.0)));

    let mut out = vec![0.0; mode_table_length(512).expect("even")];
    let pool = Threads::new(2).expect("threads");
    for (threads, exec) in [(1, &Serial as &dyn Exec), (2, &pool)] {
        for (name, linear) in [("table", power), ("eisenstein_hu", fit)] {
            let poisson = Poisson::new(&cosmology, linear, 1.0 / 33.0, Convention::Cmb).expect("sound");
            c.bench_function(&format!("alpha_table/512/{name}/{threads}"), |b| {
                b.iter(|| alpha_table(exec, black_box(&poisson), 512, 1000.0, &mut out));
            });
        }
        let poisson = Poisson::new(&cosmology, power, 1.0 / 33.0, Convention::Cmb).expect("sound");
        c.bench_function(&format!("potential_amplitude_table/512/{threads}"), |b| {
            b.iter(|| potential_amplitude_table(exec, black_box(&poisson), 512, 1000.0, &mut out));
        });
    }
}

criterion_group!(benches, background, tables);
criterion_main!(benches);
