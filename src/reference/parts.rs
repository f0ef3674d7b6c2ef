//! A transform of a mesh that several processes share, each with a brick of cells and a brick of modes of any layout: threads that meet around one
//! whole mesh.

use std::sync::{Barrier, Mutex};
use std::vec;
use std::vec::Vec;

use super::built::serial;
use crate::fft::{Fft3, Transform};
use crate::mesh::{Brick, Space};
use crate::real::Real;
use crate::status::Result;

/// Where the processes meet.
pub(crate) struct Meeting<T> {
    whole: Mutex<Vec<T>>,
    sums: Mutex<Vec<f64>>,
    all: Barrier,
}

impl<T: Real> Meeting<T> {
    pub(crate) fn new(n: usize, processes: usize) -> Self {
        Self {
            whole: Mutex::new(vec![T::ZERO; n * n * (n + 2)]),
            sums: Mutex::new(vec![]),
            all: Barrier::new(processes),
        }
    }
}

/// One of the processes.
pub(crate) struct Part<'a, T: Real> {
    meeting: &'a Meeting<T>,
    cells: Brick,
    modes: Brick,
    /// Of the one process that transforms.
    fft: Option<Transform<'static, T>>,
}

impl<'a, T: Real> Part<'a, T> {
    /// `first` for exactly one process; the bricks of all together are the mesh.
    pub(crate) fn new(meeting: &'a Meeting<T>, first: bool, cells: Brick, modes: Brick) -> Self {
        Self { meeting, cells, modes, fft: first.then(|| serial(cells.n())) }
    }

    fn together(&mut self, data: &mut [T], to: Space) -> Result<()> {
        let (from, to_brick) = match to {
            Space::Fourier => (self.cells, self.modes),
            Space::Configuration => (self.modes, self.cells),
        };
        let Meeting { whole, all, .. } = self.meeting;
        gather(&from, data, &mut whole.lock().unwrap());
        all.wait();
        if let Some(fft) = &mut self.fft {
            let mut whole = whole.lock().unwrap();
            if to == Space::Fourier { fft.forward(&mut whole)? } else { fft.inverse(&mut whole)? }
        }
        all.wait();
        scatter(&to_brick, data, &whole.lock().unwrap());
        all.wait();
        Ok(())
    }
}

/// Where each element of a brick lies in its array and in the whole mesh, in reals.
fn places(brick: &Brick) -> impl Iterator<Item = (usize, usize)> {
    let (start, count, stride) = (brick.start(), brick.count(), brick.stride());
    let (n, width) = (brick.n(), brick.space().width());
    let row = (n + 2) / width;
    (0..brick.elements()).flat_map(move |i| {
        let [x, y, z] = [i / (count[1] * count[2]), i / count[2] % count[1], i % count[2]];
        let here = width * (x * stride[0] + y * stride[1] + z * stride[2]);
        let there = width * (((start[0] + x) * n + start[1] + y) * row + start[2] + z);
        (0..width).map(move |part| (here + part, there + part))
    })
}

/// Copies a part to the whole mesh, n x n x (n + 2) reals.
pub(crate) fn gather<T: Real>(brick: &Brick, part: &[T], whole: &mut [T]) {
    places(brick).for_each(|(here, there)| whole[there] = part[here]);
}

/// Copies a part from the whole mesh.
pub(crate) fn scatter<T: Real>(brick: &Brick, part: &mut [T], whole: &[T]) {
    places(brick).for_each(|(here, there)| part[here] = whole[there]);
}

impl<T: Real> Fft3<T> for Part<'_, T> {
    fn configuration(&self) -> &Brick {
        &self.cells
    }

    fn fourier(&self) -> &Brick {
        &self.modes
    }

    fn length(&self) -> usize {
        self.cells.reals().max(self.modes.reals())
    }

    fn forward(&mut self, data: &mut [T]) -> Result<()> {
        self.together(data, Space::Fourier)
    }

    fn inverse(&mut self, data: &mut [T]) -> Result<()> {
        self.together(data, Space::Configuration)
    }

    fn all_sum(&mut self, values: &mut [f64]) -> Result<()> {
        let Meeting { sums, all, .. } = self.meeting;
        {
            let mut sums = sums.lock().unwrap();
            sums.resize(values.len(), 0.0);
            sums.iter_mut().zip(&*values).for_each(|(sum, value)| *sum += value);
        }
        all.wait();
        values.copy_from_slice(&sums.lock().unwrap());
        all.wait();
        if self.fft.is_some() {
            sums.lock().unwrap().clear();
        }
        all.wait();
        Ok(())
    }
}
