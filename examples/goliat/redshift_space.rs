//! Particles as a survey sees them: multipoles of their power spectrum in redshift space.
//!
//! A particle at x with peculiar velocity v is seen at s = x + v_z/(a H) along the line of sight z. In linear theory delta_s = (1 + f mu^2) delta
//! (Kaiser 1987): P_0, P_2, P_4 are P times 1 + 2f/3 + f^2/5, 4f/3 + 4f^2/7, 8f^2/35.

use fixpair::estimate::binning::Binning;
use fixpair::estimate::compensation::Compensation;
use fixpair::exec::Serial;
use fixpair::fft::Fft3;
use fixpair::initial::particles::Components;
use fixpair::initial::realise::{second_order_particles, second_order_rest};
use fixpair::mesh::Brick;
use fixpair::pm::{Assignment, Positions, Region, Window, deposit, deposit_scratch, interlace};

use crate::Failure;
use crate::memory::Memory;
use crate::universe::Universe;

/// P_0, P_2, P_4 in bins.
pub(crate) type Multipoles = [Vec<f64>; 3];

/// P_0, P_2, P_4 of linear theory, averaged over the modes of the unit shells: shells of few modes do not sample mu evenly.
pub(crate) fn linear_multipoles(universe: &Universe) -> Result<Multipoles, Failure> {
    let (mut modes, brick, f) = (universe.linear_modes()?, universe.fourier()?, universe.growth_rate());
    let [x, y, _] = brick.stride();
    let square = |index: usize| Brick::mode(brick.n(), index).pow(2) as f64;
    for i in 0..brick.count()[0] {
        for j in 0..brick.count()[1] {
            let row = &mut modes[2 * (i * x + j * y)..][..2 * brick.count()[2]];
            for (l, mode) in row.iter_mut().step_by(2).enumerate() {
                let (across, along) = (square(i) + square(j), square(l));
                *mode *= 1.0 + f * along / (across + along).max(1.0);
            }
        }
    }
    multipoles_of(universe, &modes, &brick, Compensation::None)
}

fn multipoles_of(
    universe: &Universe,
    modes: &[f64],
    brick: &Brick,
    compensation: Compensation,
) -> Result<Multipoles, Failure> {
    let binning = Binning { orders: 0b1_0101, ..Binning::shells(&universe.edges) };
    let (_, power) = universe.power(modes, brick, &binning, compensation)?;
    Ok(std::array::from_fn(|l| power.iter().skip(l).step_by(3).copied().collect()))
}

/// Moves the particles of a density field to second order and measures them in redshift space, in the unit shells of the universe.
pub(crate) fn multipoles(
    universe: &Universe,
    density: &[f64],
    fft: &mut dyn Fft3<f64>,
    fine: &mut dyn Fft3<f64>,
) -> Result<Multipoles, Failure> {
    let particles = universe.size.pow(3);
    let (mut position, mut velocity) = (vec![0.0; 3 * particles], vec![0.0; 3 * particles]);
    let mut source = vec![0.0; fine.length()];
    let mut rest = vec![0.0; second_order_rest(&*fft, Some(fine))];
    second_order_particles(
        &mut Components::triples(&mut position)?,
        &mut Components::triples(&mut velocity)?,
        density,
        &universe.motion,
        fft,
        Some(fine),
        &mut source,
        &mut rest,
        &Serial,
    )?;
    for (place, velocity) in position.iter_mut().zip(&velocity).skip(2).step_by(3) {
        *place += velocity / universe.hubble;
    }
    let mut modes = mesh(universe, &position, 0.0, fine)?;
    interlace(&mut modes, &mesh(universe, &position, 0.5, fine)?, fine.fourier(), &Serial)?;
    modes.iter_mut().for_each(|part| *part /= particles as f64);
    multipoles_of(universe, &modes, fine.fourier(), Compensation::Window(WINDOW))
}

/// Displacements on a lattice have images at k + G, G its reciprocal vectors, and those at twice the side n of the mesh fall back onto k even
/// after interlacing. With n 3/2 the side of the lattice this window leaves 6 (k/2n)^4 of them in the amplitude, 0.5% at the lattice's Nyquist
/// wavenumber; the quadratic window would leave 2 (k/2n)^2, 6%.
const WINDOW: Window = Window::PiecewiseCubicSpline;

/// The modes, times the number of particles, of the density contrast on a mesh shifted by part of a cell.
fn mesh(
    universe: &Universe,
    position: &[f64],
    shift: f64,
    fft: &mut dyn Fft3<f64>,
) -> Result<Vec<f64>, Failure> {
    let region = Region::from_brick(fft.configuration())?;
    let assignment = Assignment { box_size: universe.length, window: WINDOW, shift };
    let positions = Positions::triples(position)?;
    let mut scratch = Memory::new(deposit_scratch::<f64>(&region, position.len() / 3, WINDOW)?);
    let mut mesh = vec![0.0; fft.length()];
    deposit(&mut mesh, &region, &positions, None, &assignment, scratch.bytes(), &Serial)?;
    fft.forward(&mut mesh)?;
    Ok(mesh)
}

#[cfg(test)]
mod tests {
    use fixpair::initial::png::Local;
    use fixpair::initial::realise::{Field, linear_density};
    use fixpair::noise::{Amplitude, Realisation};

    use super::*;
    use crate::universe::{fine_side, with_transform};

    #[test]
    fn kaiser_s_values_are_the_limit_of_many_modes() {
        let universe = Universe::new(48, 3000.0).unwrap();
        let f = universe.growth_rate();
        let [p0, p2, p4] = linear_multipoles(&universe).unwrap();
        let last = p0.len() - 1;
        let theory = universe.theory[last];
        assert!((p0[last] / theory - (1.0 + 2.0 * f / 3.0 + f * f / 5.0)).abs() < 1e-3);
        // A shell of 7000 modes: cubic symmetry leaves the part of L_4 that is not isotropic.
        assert!((p2[last] / theory - (4.0 * f / 3.0 + 4.0 * f * f / 7.0)).abs() < 0.03);
        assert!((p4[last] / theory - 8.0 * f * f / 35.0).abs() < 0.03);
    }

    #[test]
    fn fixed_particles_follow_linear_theory_mode_by_mode() {
        let universe = Universe::new(32, 3000.0).unwrap();
        let linear = linear_multipoles(&universe).unwrap();
        let field = Field {
            realisation: Realisation { amplitude: Amplitude::Fixed, ..Realisation::new(1) },
            potential_amplitude: &universe.potential_amplitude,
            local: Local::default(),
            transfer: &universe.alpha,
        };
        let measured = with_transform(32, |fft| {
            with_transform(fine_side(32)?, |fine| {
                let mut density = vec![0.0; fft.length()];
                let mut mesh = vec![0.0; fine.length()];
                let mut partial = vec![[0.0]; 48];
                linear_density(&mut density, &field, fft, Some(fine), &mut mesh, &mut partial, &Serial)?;
                multipoles(&universe, &density, fft, fine)
            })
        })
        .unwrap();
        for (l, (measured, linear_l)) in measured.iter().zip(&linear).enumerate() {
            for (i, (measured, linear_l)) in measured.iter().zip(linear_l).enumerate() {
                // Images of the lattice (see `WINDOW`) on up to three axes, and second order.
                let error = (measured - linear_l) / linear[0][i];
                assert!(error.abs() < 0.03, "P_{} in bin {i}: {error}", 2 * l);
            }
        }
    }
}
