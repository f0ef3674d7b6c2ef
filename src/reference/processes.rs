//! Processes that share a mesh as FFTW-MPI deals it out: slabs of cells, transposed slabs of modes.

use std::sync::{Barrier, Mutex};
use std::vec::Vec;

use super::transform::Slow;
use crate::fft::Fft3;
use crate::mesh::Brick;
use crate::status::Result;

/// One of the processes: all meet around one whole mesh, n x n x (n + 2) reals, which the first transforms.
pub(crate) struct Process<'a> {
    pub(crate) whole: &'a Mutex<Vec<f64>>,
    pub(crate) all: &'a Barrier,
    pub(crate) first: bool,
    pub(crate) cells: Brick,
    pub(crate) modes: Brick,
}

impl Process<'_> {
    fn together(&self, data: &mut [f64], forward: bool) -> Result<()> {
        let (from, to) = if forward { (&self.cells, &self.modes) } else { (&self.modes, &self.cells) };
        gather(from, data, &mut self.whole.lock().unwrap());
        self.all.wait();
        if self.first {
            let (mut slow, mut whole) = (Slow::new(self.cells.n()), self.whole.lock().unwrap());
            if forward { slow.forward(&mut whole) } else { slow.inverse(&mut whole) }?;
        }
        self.all.wait();
        scatter(to, data, &self.whole.lock().unwrap());
        self.all.wait();
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

/// Copies a part to the whole mesh.
pub(crate) fn gather(brick: &Brick, part: &[f64], whole: &mut [f64]) {
    places(brick).for_each(|(here, there)| whole[there] = part[here]);
}

/// Copies a part from the whole mesh.
pub(crate) fn scatter(brick: &Brick, part: &mut [f64], whole: &[f64]) {
    places(brick).for_each(|(here, there)| part[here] = whole[there]);
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
        self.together(data, true)
    }

    fn inverse(&mut self, data: &mut [f64]) -> Result<()> {
        self.together(data, false)
    }
}
