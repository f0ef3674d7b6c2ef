//! Timing the one call from a seed to particles.

use std::hint::black_box;

use criterion::measurement::WallTime;
use criterion::{BenchmarkGroup, BenchmarkId, Throughput};
use fixpair::exec::Exec;
use fixpair::fft::{Fft3, Tables, Transform, next_side, recommended_padding};
use fixpair::initial::conditions::{InitialConditions, initial_conditions, initial_conditions_scratch};
use fixpair::initial::particles::Components;
use fixpair::mesh::{Brick, Space};
use fixpair::real::Real;

use crate::memory::Memory;

/// A built-in transform of side n on memory of its own.
pub(crate) struct Built<'a, T: Real> {
    tables: &'a Tables<'a, T>,
    work: Memory,
    exec: &'a dyn Exec,
}

impl<'a, T: Real> Built<'a, T> {
    pub(crate) fn new(tables: &'a Tables<'a, T>, exec: &'a dyn Exec) -> Self {
        Self { tables, work: Memory::new(Transform::<T>::workspace(tables.n()).unwrap()), exec }
    }

    pub(crate) fn transform(&mut self) -> Transform<'_, T> {
        let n = self.tables.n();
        let cells = Brick::whole_padded(n, Space::Configuration, recommended_padding::<T>(n)).unwrap();
        Transform::new(self.tables, cells, self.work.bytes(), self.exec).unwrap()
    }
}

/// Positions and velocities on a mesh of side n, in cells a second; prints the scratch.
pub(crate) fn one_call<T: Real>(
    group: &mut BenchmarkGroup<'_, WallTime>,
    name: &str,
    conditions: &InitialConditions<'_>,
    n: usize,
    dealiased: bool,
    exec: &dyn Exec,
) {
    let cells = n * n * n;
    group.throughput(Throughput::Elements(cells as u64));
    let m = next_side(3 * n / 2).unwrap();
    let (mut coarse, mut fine) =
        (Memory::new(Tables::<T>::layout(n).unwrap()), Memory::new(Tables::<T>::layout(m).unwrap()));
    let coarse = Tables::<T>::new(n, coarse.bytes()).unwrap();
    let fine = Tables::<T>::new(m, fine.bytes()).unwrap();
    let (mut coarse, mut fine) = (Built::new(&coarse, exec), Built::new(&fine, exec));
    let (mut fft, mut work) = (coarse.transform(), fine.transform());
    let (mut x, mut v) = (vec![T::ZERO; 3 * cells], vec![T::ZERO; 3 * cells]);
    let optional = dealiased.then_some(&work as &dyn Fft3<T>);
    let layout = initial_conditions_scratch(conditions.parts(), &fft, optional).unwrap();
    let mut scratch = Memory::new(layout);
    eprintln!("{name}, n = {n}: {:.1} bytes of scratch a cell", layout.size as f64 / cells as f64);
    group.bench_function(BenchmarkId::new(name, n), |bencher| {
        bencher.iter(|| {
            initial_conditions(
                &mut Components::triples(black_box(&mut x)).unwrap(),
                &mut Components::triples(black_box(&mut v)).unwrap(),
                conditions,
                &mut fft,
                dealiased.then_some(&mut work as &mut dyn Fft3<T>),
                scratch.bytes(),
                exec,
            )
            .unwrap();
        });
    });
}
