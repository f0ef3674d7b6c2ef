//! Force, kick and drift of a whole mesh, with the factors of its stepper.

use super::columns::Positions;
use super::deposit::deposit;
use super::drift::drift;
use super::evolve::{Displacements, Epoch, Gravity, Workshop};
use super::factors::{Stepper, Units, half_step};
use super::force::forces;
use super::frame::Assignment;
use super::kick::{Lpt, kick};
use super::region::Region;
use crate::cosmology::growth;
use crate::exec::for_each_piece;
use crate::fft::Fft3;
use crate::initial::particles::Components;
use crate::real::Real;
use crate::status::{Error, Result};
use crate::within::Within;

/// Reals that one chunk sets to zero.
const PIECE: usize = 1 << 16;

/// Everything of a run that does not change.
pub(super) struct Mover<'a, 'b, T> {
    gravity: &'a Gravity,
    units: Units,
    region: Region,
    assignment: Assignment,
    lpt: Option<&'a Lpt<'b, T>>,
}

impl<'a, 'b, T: Real> Mover<'a, 'b, T> {
    pub(super) fn new(
        gravity: &'a Gravity,
        displacements: Option<&'a Displacements<'b, T>>,
        particles: [usize; 2],
        workshop: &Workshop<'_, T>,
    ) -> Result<Self> {
        gravity.stepper.check()?;
        if !gravity.hubble.is_finite() {
            return Err(Error::NotFinite);
        }
        if gravity.hubble <= 0.0 {
            return Err(Error::Range);
        }
        let length = workshop.fft.length();
        if particles[0] != particles[1] || workshop.meshes.iter().any(|mesh| mesh.len() < length) {
            return Err(Error::Length);
        }
        let (mut units, mut lpt) = (Units { hubble: gravity.hubble, lpt: [0.0; 2] }, None);
        if let Stepper::Cola { .. } = gravity.stepper {
            let Displacements { lpt: given, scale_factor } = displacements.ok_or(Error::Null)?;
            if [Some(given.first), given.second].iter().flatten().any(|order| order.len() != particles[0]) {
                return Err(Error::Length);
            }
            let then = growth(&gravity.cosmology, *scale_factor)?;
            units.lpt = [1.0 / then.d, given.second.map_or(0.0, |_| 1.0 / then.d2)];
            lpt = Some(given);
        }
        let region = whole(workshop.fft)?;
        let assignment = Assignment { box_size: gravity.box_size, window: gravity.window, shift: 0.0 };
        Ok(Self { gravity, units, region, assignment, lpt })
    }

    /// Works out what all steps of a list need, so that nothing is refused when half of them are done.
    pub(super) fn try_steps(&self, list: &[f64], velocity: f64) -> Result<()> {
        let Gravity { stepper, cosmology, box_size, .. } = self.gravity;
        let edge = T::from_f64(*box_size);
        if !box_size.is_finite() {
            return Err(Error::NotFinite);
        }
        if !(edge > T::ZERO && edge.is_finite()) {
            return Err(Error::Range);
        }
        let mut from = velocity;
        for (i, &a) in list.iter().enumerate() {
            let next = list.get(i + 1).copied();
            let to = next.map_or(a, |next| half_step(a, next));
            let kick = self.units.kick(stepper.kick(cosmology, from, to, a)?, from, to);
            let drift = stepper.drift(cosmology, a, next.unwrap_or(a), to)?;
            let drift = self.units.drift(drift, to);
            let all =
                [kick.keep, kick.force, kick.first, kick.second, drift.velocity, drift.first, drift.second];
            if all.iter().any(|factor| !factor.is_finite()) {
                return Err(Error::NotFinite);
            }
            from = to;
        }
        Ok(())
    }

    /// The force of particles at `at` into the meshes.
    pub(super) fn force(&self, at: &Positions<'_, T>, workshop: &mut Workshop<'_, T>) -> Result<()> {
        let Workshop { meshes, fft, scratch, exec } = workshop;
        let [density, second, third] = meshes.each_mut().map(|mesh| mesh.part_mut(..fft.length()));
        for_each_piece(*exec, density, PIECE, &|_, piece| piece.fill(T::ZERO))?;
        deposit(density, &self.region, at, None, &self.assignment, scratch, *exec)?;
        fft.forward(density)?;
        let (modes, mass) = (*fft.fourier(), at.len() as f64);
        let Gravity { law, box_size, .. } = self.gravity;
        forces([&mut *density, &mut *second, &mut *third], &modes, law, *box_size, mass, scratch, *exec)?;
        for mesh in [density, second, third] {
            fft.inverse(mesh)?;
        }
        Ok(())
    }

    /// Velocities of `epoch` go to `to`, with the force that the meshes hold of the particles at `at`.
    pub(super) fn kick(
        &self,
        velocity: &mut Components<'_, T>,
        at: &Positions<'_, T>,
        epoch: Epoch,
        to: f64,
        workshop: &mut Workshop<'_, T>,
    ) -> Result<()> {
        let Gravity { stepper, cosmology, .. } = self.gravity;
        let factors = stepper.kick(cosmology, epoch.velocity, to, epoch.position)?;
        let factors = self.units.kick(factors, epoch.velocity, to);
        let Workshop { meshes, scratch, exec, .. } = workshop;
        let forces = meshes.each_ref().map(|mesh| &**mesh);
        kick(velocity, at, forces, &self.region, &self.assignment, &factors, self.lpt, scratch, *exec)
    }

    /// Positions of `epoch` go to `to`, with the velocities `with`.
    pub(super) fn drift(
        &self,
        position: &mut Components<'_, T>,
        with: &Positions<'_, T>,
        epoch: Epoch,
        to: f64,
        workshop: &Workshop<'_, T>,
    ) -> Result<()> {
        let Gravity { stepper, cosmology, .. } = self.gravity;
        let factors = stepper.drift(cosmology, epoch.position, to, epoch.velocity)?;
        let factors = self.units.drift(factors, epoch.velocity);
        drift(position, with, self.gravity.box_size, &factors, self.lpt, workshop.exec)
    }
}

/// The cells of a transform's mesh, all of them.
pub(super) fn whole<T: Real>(fft: &dyn Fft3<T>) -> Result<Region> {
    let cells = fft.configuration();
    if cells.is_whole() && fft.fourier().is_whole() { Region::from_brick(cells) } else { Err(Error::Brick) }
}
