//! Particles as a survey sees them: multipoles of their power spectrum in redshift space.
//!
//! A particle at x with peculiar velocity v is seen at s = x + v_z/(a H) along the line of sight z. In linear theory delta_s = (1 + f mu^2) delta
//! (Kaiser 1987): P_0, P_2, P_4 are P times 1 + 2f/3 + f^2/5, 4f/3 + 4f^2/7, 8f^2/35.

use fixpair::estimate::binning::Binning;
use fixpair::estimate::compensation::Compensation;
use fixpair::fft::Fft3;
use fixpair::mesh::Brick;
use fixpair::real::Real;

use crate::Failure;
use crate::density::contrast;
use crate::universe::Universe;

/// P_0, P_2, P_4 in bins.
pub(crate) type Multipoles = [Vec<f64>; 3];

/// P_0, P_2, P_4 of linear theory, averaged over the modes of the unit shells: shells of few modes do not sample mu evenly.
pub(crate) fn linear_multipoles(universe: &Universe<'_>) -> Result<Multipoles, Failure> {
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
    multipoles_of(universe, &modes, &brick)
}

fn multipoles_of<T: Real>(
    universe: &Universe<'_>,
    modes: &[T],
    brick: &Brick,
) -> Result<Multipoles, Failure> {
    let binning = Binning { orders: 0b1_0101, ..Binning::shells(&universe.edges) };
    let (_, power) = universe.power(modes, brick, &binning, Compensation::None)?;
    Ok(std::array::from_fn(|l| power.iter().skip(l).step_by(3).copied().collect()))
}

/// Measures particles (triples of positions and velocities) in redshift space, in the unit shells of the universe.
pub(crate) fn multipoles(
    universe: &Universe<'_>,
    position: &[f32],
    velocity: &[f32],
    fine: &mut dyn Fft3<f32>,
) -> Result<Multipoles, Failure> {
    let mut seen = position.to_vec();
    for (place, velocity) in seen.iter_mut().zip(velocity).skip(2).step_by(3) {
        *place += velocity / universe.hubble as f32;
    }
    let modes = contrast(universe, &seen, fine)?;
    multipoles_of(universe, &modes, fine.fourier())
}

#[cfg(test)]
mod tests {
    use fixpair::exec::Serial;
    use fixpair::initial::png::Local;
    use fixpair::noise::{Amplitude, Realisation};

    use super::*;
    use crate::start::Start;
    use crate::transform::with_transform;
    use crate::universe::fine_side;

    #[test]
    fn kaiser_s_values_are_the_limit_of_many_modes() {
        let universe = Universe::new(48, 3000.0, &Serial).unwrap();
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
        let universe = Universe::new(32, 3000.0, &Serial).unwrap();
        let linear = linear_multipoles(&universe).unwrap();
        let realisation = Realisation { amplitude: Amplitude::Fixed, ..Realisation::new(1) };
        let start = Start::new(&universe, realisation, Local::default()).unwrap();
        let [position, velocity] = start.particles(&universe).unwrap();
        let side = fine_side(32).unwrap();
        let measured =
            with_transform(side, &Serial, |fine| multipoles(&universe, &position, &velocity, fine)).unwrap();
        for (l, (measured, linear_l)) in measured.iter().zip(&linear).enumerate() {
            for (i, (measured, linear_l)) in measured.iter().zip(linear_l).enumerate() {
                // Images of the lattice (see `WINDOW`) on up to three axes, and second order.
                let error = (measured - linear_l) / linear[0][i];
                assert!(error.abs() < 0.03, "P_{} in bin {i}: {error}", 2 * l);
            }
        }
    }
}
