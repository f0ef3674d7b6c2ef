//! The density contrast of particles, as modes.
//!
//! Displacements on a lattice have images at k + G, G its reciprocal vectors, and those at twice the side n of the mesh fall back onto k even
//! after interlacing. With n 3/2 the side of the lattice the cubic spline leaves 6 (k/2n)^4 of them in the amplitude, 0.5% at the lattice's Nyquist
//! wavenumber; the quadratic window would leave 2 (k/2n)^2, 6%.

use fixpair::estimate::compensation::{Compensation, compensate, compensate_scratch};
use fixpair::fft::Fft3;
use fixpair::pm::{Assignment, Positions, Region, Window, deposit, deposit_scratch, interlace};

use crate::Failure;
use crate::memory::Memory;
use crate::universe::Universe;

const WINDOW: Window = Window::PiecewiseCubicSpline;

/// The modes of the density contrast of particles (triples), interlaced and free of the window.
pub(crate) fn contrast(
    universe: &Universe<'_>,
    position: &[f32],
    fft: &mut dyn Fft3<f32>,
) -> Result<Vec<f32>, Failure> {
    let (brick, exec) = (*fft.fourier(), universe.exec);
    let mut modes = mesh(universe, position, 0.0, fft)?;
    interlace(&mut modes, &mesh(universe, position, 0.5, fft)?, &brick, exec)?;
    let mut scratch = Memory::new(compensate_scratch(&brick)?);
    let scale = 3.0 / position.len() as f64;
    compensate(&mut modes, Compensation::Window(WINDOW), scale, &brick, scratch.bytes(), exec)?;
    Ok(modes)
}

/// The modes, times the number of particles, of the density contrast on a mesh shifted by part of a cell.
fn mesh(
    universe: &Universe<'_>,
    position: &[f32],
    shift: f64,
    fft: &mut dyn Fft3<f32>,
) -> Result<Vec<f32>, Failure> {
    let region = Region::from_brick(fft.configuration())?;
    let assignment = Assignment { box_size: universe.length, window: WINDOW, shift };
    let positions = Positions::triples(position)?;
    let mut scratch = Memory::new(deposit_scratch::<f32>(&region, position.len() / 3, WINDOW)?);
    let mut mesh = vec![0.0; fft.length()];
    deposit(&mut mesh, &region, &positions, None, &assignment, scratch.bytes(), universe.exec)?;
    fft.forward(&mut mesh)?;
    Ok(mesh)
}
