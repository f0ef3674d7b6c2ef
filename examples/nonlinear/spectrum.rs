//! P(k) of particles, in shells.
//!
//! Deposit with the cubic window on the mesh of the run, interlaced, divided by the window. No shot noise is subtracted: the particles begin on a
//! lattice, which has none, and where they leave it the noise is below V/N.

use fixpair::estimate::binning::{Bin, Binning, normalise, read_sums};
use fixpair::estimate::compensation::Compensation;
use fixpair::estimate::power::{power_sums, power_sums_scratch};
use fixpair::exec::Exec;
use fixpair::fft::Fft3;
use fixpair::pm::{Assignment, Positions, Region, Window, deposit, deposit_scratch, interlace};

use crate::Failure;
use crate::memory::Memory;
use crate::run::Snapshot;

const WINDOW: Window = Window::PiecewiseCubicSpline;

/// Edges in |n|^2 up to half the lattice's side: shells of two modes' width, then of 8%.
pub(crate) fn edges(particles: usize) -> Vec<u64> {
    let mut edges = vec![1];
    let mut side = 1_u64;
    loop {
        side = (side + 2).max((side as f64 * 1.08) as u64);
        if side > particles as u64 / 2 {
            return edges;
        }
        edges.push(side * side);
    }
}

/// P in the shells between `edges`, (Mpc/h)^3. Overwrites two meshes.
pub(crate) fn power(
    snapshot: &mut Snapshot<'_>,
    edges: &[u64],
    exec: &dyn Exec,
) -> Result<Vec<f64>, Failure> {
    let Snapshot { box_size, position, fft, meshes: [first, second, _], .. } = snapshot;
    let positions = Positions::triples(position)?;
    for (mesh, shift) in [(&mut **first, 0.0), (&mut **second, 0.5)] {
        modes(mesh, &positions, &Assignment { box_size: *box_size, window: WINDOW, shift }, *fft, exec)?;
    }
    let brick = fft.fourier();
    interlace(first, second, brick, exec)?;
    let binning = Binning::shells(edges);
    let mut sums = vec![0; binning.words(1)?];
    let mut scratch = Memory::new(power_sums_scratch(brick, &binning, 1)?);
    let compensation = [Compensation::Window(WINDOW)];
    power_sums(&mut sums, &[&**first], &[[0, 0]], &compensation, brick, &binning, scratch.bytes(), exec)?;
    let mut bins = vec![Bin::default(); binning.bins()?];
    let mut power = vec![0.0; bins.len()];
    read_sums(&mut bins, &mut power, &sums, &binning, 1)?;
    // The modes are those of the contrast times the number of particles.
    let factor = box_size.powi(3) / (positions.len() as f64).powi(2);
    normalise(&mut power, &bins, binning.orders, factor)?;
    Ok(power)
}

fn modes(
    mesh: &mut [f32],
    positions: &Positions<'_, f32>,
    assignment: &Assignment,
    fft: &mut dyn Fft3<f32>,
    exec: &dyn Exec,
) -> Result<(), Failure> {
    let region = Region::from_brick(fft.configuration())?;
    let mut scratch = Memory::new(deposit_scratch::<f32>(&region, positions.len(), assignment.window)?);
    mesh.fill(0.0);
    deposit(mesh, &region, positions, None, assignment, scratch.bytes(), exec)?;
    Ok(fft.forward(mesh)?)
}
