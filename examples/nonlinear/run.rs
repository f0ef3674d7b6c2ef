//! One run: 2LPT initial conditions of a fixed field at z = 32, and FastPM steps to z = 1 and 0.
//!
//! A run stops at each output, where velocities meet positions, and goes on with another list of steps: nothing else is kept between them.

use fixpair::cosmology::{Convention, Cosmology};
use fixpair::exec::Exec;
use fixpair::fft::Fft3;
use fixpair::initial::conditions::{
    InitialConditions, Order, initial_conditions, initial_conditions_scratch,
};
use fixpair::initial::particles::Components;
use fixpair::initial::png::Local;
use fixpair::initial::shape::Shape;
use fixpair::noise::{Amplitude, Phase, Realisation};
use fixpair::pm::evolve::{Epoch, Gravity, Workshop, evolve, evolve_scratch};
use fixpair::pm::factors::{Stepper, linear_steps};
use fixpair::pm::outputs::{Event, Verdict};

use crate::Failure;
use crate::arguments::Arguments;
use crate::memory::Memory;
use crate::theory::{REDSHIFTS, Theory};
use crate::transform::with_transform;

/// Redshift of the initial conditions.
const START: f64 = 32.0;

/// The members of a pair.
pub(crate) const PAIR: [Phase; 2] = [Phase::Original, Phase::Inverted];

/// Particles at an output, and meshes that may be overwritten.
pub(crate) struct Snapshot<'a> {
    /// Which of [`REDSHIFTS`].
    pub(crate) output: usize,
    /// Side of the box, Mpc/h.
    pub(crate) box_size: f64,
    /// Triples, Mpc/h.
    pub(crate) position: &'a [f32],
    /// A transform of the mesh of the run.
    pub(crate) fft: &'a mut dyn Fft3<f32>,
    /// Three meshes of its length.
    pub(crate) meshes: [&'a mut [f32]; 3],
}

/// Scale factors from each stop to the next: equal steps of a, shared out by the length of the way.
pub(crate) fn scale_factors(steps: usize) -> Result<[Vec<f64>; 2], Failure> {
    let [start, middle, end] = [START, REDSHIFTS[0], REDSHIFTS[1]].map(|z| 1.0 / (1.0 + z));
    let early = ((steps as f64 * (middle - start) / (end - start)).round() as usize).clamp(1, steps - 1);
    let mut lists = [vec![0.0; early + 1], vec![0.0; steps - early + 1]];
    linear_steps(&mut lists[0], start, middle)?;
    linear_steps(&mut lists[1], middle, end)?;
    Ok(lists)
}

/// Runs one member of a pair in a box. `tick` is called after each step, `measure` at each output.
pub(crate) fn run(
    arguments: &Arguments,
    theory: &Theory,
    box_size: f64,
    (seed, phase): (u64, Phase),
    exec: &dyn Exec,
    tick: &dyn Fn(),
    measure: &mut dyn FnMut(&mut Snapshot<'_>) -> Result<(), Failure>,
) -> Result<(), Failure> {
    let realisation = Realisation { amplitude: Amplitude::Fixed, phase, ..Realisation::new(seed) };
    let particles = arguments.particles.pow(3);
    let mut position = vec![0.0_f32; 3 * particles];
    let mut velocity = vec![0.0_f32; 3 * particles];
    let x = &mut Components::triples(&mut position)?;
    let u = &mut Components::triples(&mut velocity)?;
    start(x, u, theory, arguments.particles, box_size, realisation, exec)?;
    let gravity = Gravity {
        cosmology: Cosmology::goliat(),
        box_size,
        hubble: 100.0,
        window: arguments.window,
        law: arguments.law,
        stepper: Stepper::FastPm,
    };
    with_transform(arguments.mesh(), exec, |fft| {
        let mut meshes = [(); 3].map(|()| vec![0.0; fft.length()]);
        let mut epoch = Epoch::at(1.0 / (1.0 + START));
        for (output, list) in scale_factors(arguments.steps)?.iter().enumerate() {
            let mut scratch = Memory::new(evolve_scratch(fft, particles, arguments.window)?);
            let mut workshop = Workshop {
                meshes: meshes.each_mut().map(Vec::as_mut_slice),
                fft,
                scratch: scratch.bytes(),
                exec,
            };
            let x = &mut Components::triples(&mut position)?;
            let u = &mut Components::triples(&mut velocity)?;
            evolve(&gravity, &mut epoch, x, u, None, list, None, &mut workshop, &mut |progress| {
                if progress.event == Event::Step {
                    tick();
                }
                Verdict::Continue
            })?;
            measure(&mut Snapshot {
                output,
                box_size,
                position: &position,
                fft,
                meshes: meshes.each_mut().map(Vec::as_mut_slice),
            })?;
        }
        Ok(())
    })
}

/// Particles at z = 32.
fn start(
    position: &mut Components<'_, f32>,
    velocity: &mut Components<'_, f32>,
    theory: &Theory,
    side: usize,
    box_size: f64,
    realisation: Realisation,
    exec: &dyn Exec,
) -> Result<(), Failure> {
    let conditions = InitialConditions {
        realisation,
        cosmology: Cosmology::goliat(),
        linear: theory.linear()?,
        redshift: START,
        box_size,
        local: Local::default(),
        shape: Shape::Local.rows(),
        species: None,
        convention: Convention::Cmb,
        order: Order::Second,
    };
    with_transform(side, exec, |fft| {
        let mut scratch = Memory::new(initial_conditions_scratch(conditions.parts(), fft, None)?);
        Ok(initial_conditions(position, velocity, &conditions, fft, None, scratch.bytes(), exec)?)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_are_shared_out_and_lists_meet() {
        let [early, late] = scale_factors(40).unwrap();
        assert_eq!((early.len() - 1) + (late.len() - 1), 40);
        assert_eq!((early[0], early[early.len() - 1]), (1.0 / 33.0, 0.5));
        assert_eq!((late[0], late[late.len() - 1]), (0.5, 1.0));
        // Steps of both parts are the same but for rounding to whole steps.
        assert!(((early[1] - early[0]) / (late[1] - late[0]) - 1.0).abs() < 0.05);
    }
}
