//! Processes that hold planes of one mesh, and transform it together.

use std::sync::{Barrier, Mutex};
use std::vec;
use std::vec::Vec;

use super::built::serial;
use crate::fft::Fft3;
use crate::mesh::{Brick, Space};
use crate::status::Result;

/// A process that holds some planes in configuration space and some transposed planes in Fourier space, as FFTW-MPI
/// does. All processes meet around one whole mesh.
pub(crate) struct Process<'a> {
    whole: &'a Mutex<Vec<f64>>,
    all: &'a Barrier,
    first: bool,
    cells: Brick,
    modes: Brick,
}

/// Runs `body` in one thread for each share of planes, (first plane, planes), the first of which does the transforms.
pub(crate) fn together(n: usize, planes: &[(usize, usize)], body: &(dyn Fn(&mut Process<'_>) + Sync)) {
    let whole = Mutex::new(vec![0.0; n * n * (n + 2)]);
    let all = Barrier::new(planes.len());
    std::thread::scope(|scope| {
        for (rank, &(first, count)) in planes.iter().enumerate() {
            let (whole, all) = (&whole, &all);
            scope.spawn(move || {
                let cells = Brick::slab(n, Space::Configuration, first, count).unwrap();
                let modes = Brick::transposed_slab(n, first, count).unwrap();
                body(&mut Process { whole, all, first: rank == 0, cells, modes });
            });
        }
    });
}

/// Copies what a brick holds to the whole mesh, or from it.
pub(crate) fn exchange(brick: &Brick, local: &mut [f64], whole: &mut [f64], to_whole: bool) {
    let (start, count, stride) = (brick.start(), brick.count(), brick.stride());
    let (n, width) = (brick.n(), brick.space().width());
    let row = (n + 2) / width;
    for i in 0..brick.elements() {
        let [x, y, z] = [i / (count[1] * count[2]), i / count[2] % count[1], i % count[2]];
        let here = width * (x * stride[0] + y * stride[1] + z * stride[2]);
        let there = width * (((start[0] + x) * n + start[1] + y) * row + start[2] + z);
        for part in 0..width {
            if to_whole {
                whole[there + part] = local[here + part];
            } else {
                local[here + part] = whole[there + part];
            }
        }
    }
}

impl Process<'_> {
    fn transform(&self, data: &mut [f64], forward: bool) -> Result<()> {
        let (from, to) = if forward { (&self.cells, &self.modes) } else { (&self.modes, &self.cells) };
        exchange(from, data, &mut self.whole.lock().unwrap(), true);
        self.all.wait();
        if self.first {
            let mut whole = self.whole.lock().unwrap();
            let mut fft = serial::<f64>(self.cells.n());
            // The built-in transform may pad its planes.
            let (cells, length) = (*fft.configuration(), fft.length());
            let mut data = vec![0.0; length];
            let inner = if forward { cells } else { *fft.fourier() };
            exchange(&inner, &mut data, &mut whole, false);
            let outcome = if forward { fft.forward(&mut data) } else { fft.inverse(&mut data) };
            let outer = if forward { *fft.fourier() } else { cells };
            exchange(&outer, &mut data, &mut whole, true);
            outcome?;
        }
        self.all.wait();
        exchange(to, data, &mut self.whole.lock().unwrap(), false);
        self.all.wait();
        Ok(())
    }
}

impl Fft3<f64> for Process<'_> {
    fn configuration(&self) -> &Brick {
        &self.cells
    }

    fn fourier(&self) -> &Brick {
        &self.modes
    }

    fn length(&self) -> usize {
        self.cells.reals().max(self.modes.reals())
    }

    fn forward(&mut self, data: &mut [f64]) -> Result<()> {
        self.transform(data, true)
    }

    fn inverse(&mut self, data: &mut [f64]) -> Result<()> {
        self.transform(data, false)
    }

    fn all_sum(&mut self, values: &mut [f64]) -> Result<()> {
        for value in values {
            self.whole.lock().unwrap()[0] = 0.0;
            self.all.wait();
            self.whole.lock().unwrap()[0] += *value;
            self.all.wait();
            *value = self.whole.lock().unwrap()[0];
            self.all.wait();
        }
        Ok(())
    }
}
