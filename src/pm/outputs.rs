//! What a run shows on its way: progress, and particles at times between its steps.

use super::columns::{Positions, copy_components};
use super::evolve::{Epoch, Workshop};
use super::mover::Mover;
use crate::initial::particles::Components;
use crate::real::Real;
use crate::status::{Error, Result};

/// Where particles go at times between steps.
pub struct Outputs<'a, T> {
    /// When: increasing, inside the list of steps. Empty for none.
    pub scale_factors: &'a [f64],
    /// One a particle: each output overwrites the last.
    pub position: Components<'a, T>,
    /// Peculiar, one a particle.
    pub velocity: Components<'a, T>,
}

/// What has just been done.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Event {
    /// Positions have reached scale factor number `step` of the list.
    Step,
    /// Output number `output` is in its arrays.
    Output,
}

/// A report on the way. The views are of the state after a step, and of the output arrays after an output.
pub struct Progress<'a, T> {
    /// Why it comes.
    pub event: Event,
    /// Scale factors of the list that positions have reached: 1 after the first step.
    pub step: usize,
    /// The last of them.
    pub steps: usize,
    /// Number of the output that was written; after a step, of the next one.
    pub output: usize,
    /// Where what is shown stands.
    pub epoch: Epoch,
    /// Positions then.
    pub position: Positions<'a, T>,
    /// Peculiar velocities then.
    pub velocity: Positions<'a, T>,
}

/// Whether to go on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// Go on.
    Continue,
    /// Stop after the step at hand.
    Stop,
}

/// Outputs still to be written, and who is told.
pub(super) struct Queue<'a, 'b, T> {
    outputs: Option<&'a mut Outputs<'b, T>>,
    next: usize,
    observe: &'a mut dyn FnMut(&Progress<'_, T>) -> Verdict,
    /// The step that positions have reached, and the last.
    pub(super) steps: [usize; 2],
    /// The sternest yet.
    pub(super) verdict: Verdict,
}

impl<'a, 'b, T: Real> Queue<'a, 'b, T> {
    pub(super) fn new(
        outputs: Option<&'a mut Outputs<'b, T>>,
        scale_factors: &[f64],
        epoch: Epoch,
        particles: usize,
        observe: &'a mut dyn FnMut(&Progress<'_, T>) -> Verdict,
    ) -> Result<Self> {
        let mut next = 0;
        if let Some(Outputs { scale_factors: times, position, velocity }) = &outputs {
            if position.len() != particles || velocity.len() != particles {
                return Err(Error::Length);
            }
            if times.iter().any(|a| !a.is_finite()) {
                return Err(Error::NotFinite);
            }
            let span = scale_factors[0]..=scale_factors[scale_factors.len() - 1];
            if times.iter().any(|a| !span.contains(a)) || times.windows(2).any(|pair| pair[0] >= pair[1]) {
                return Err(Error::Range);
            }
            // Between steps, one at the velocities' epoch belongs to the step before: it followed that kick.
            let done =
                |&a: &f64| a < epoch.velocity || a == epoch.velocity && epoch.velocity < epoch.position;
            next = times.iter().take_while(|a| done(a)).count();
        }
        Ok(Self { outputs, next, observe, steps: [0; 2], verdict: Verdict::Continue })
    }

    /// Writes the outputs up to a time, with the force at hand.
    pub(super) fn write_until(
        &mut self,
        last: f64,
        position: &Components<'_, T>,
        velocity: &Components<'_, T>,
        epoch: Epoch,
        mover: &Mover<'_, '_, T>,
        workshop: &mut Workshop<'_, T>,
    ) -> Result<()> {
        let (x, u) = (Positions::from(position), Positions::from(velocity));
        while let Some(outputs) = &mut self.outputs {
            let Some(&a) = outputs.scale_factors.get(self.next).filter(|&&a| a <= last) else { break };
            copy_components(&mut outputs.position, &x, workshop.exec)?;
            copy_components(&mut outputs.velocity, &u, workshop.exec)?;
            mover.drift(&mut outputs.position, &u, epoch, a, workshop)?;
            mover.kick(&mut outputs.velocity, &x, epoch, a, workshop)?;
            self.next += 1;
            let progress = Progress {
                event: Event::Output,
                step: self.steps[0],
                steps: self.steps[1],
                output: self.next - 1,
                epoch: Epoch::at(a),
                position: Positions::from(&outputs.position),
                velocity: Positions::from(&outputs.velocity),
            };
            if (self.observe)(&progress) == Verdict::Stop {
                self.verdict = Verdict::Stop;
            }
        }
        Ok(())
    }

    /// Reports a step.
    pub(super) fn tell(&mut self, epoch: Epoch, position: &Components<'_, T>, velocity: &Components<'_, T>) {
        let progress = Progress {
            event: Event::Step,
            step: self.steps[0],
            steps: self.steps[1],
            output: self.next,
            epoch,
            position: Positions::from(position),
            velocity: Positions::from(velocity),
        };
        if (self.observe)(&progress) == Verdict::Stop {
            self.verdict = Verdict::Stop;
        }
    }
}
