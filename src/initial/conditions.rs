//! One call from a seed to particles.

use super::particles::Components;
use super::png::Local;
use super::realise::{
    Field, Motion, first_order_particles, linear_density, second_order_particles, second_order_rest,
};
use crate::cosmology::background::Cosmology;
use crate::cosmology::growth::Growth;
use crate::cosmology::mode_table::{alpha_table, mode_table_length, potential_amplitude_table};
use crate::cosmology::poisson::{Convention, Poisson};
use crate::cosmology::power::Linear;
use crate::exec::Exec;
use crate::fft::Fft3;
use crate::noise::Realisation;
use crate::real::Real;
use crate::scratch::{Arena, Layout};
use crate::status::{Error, Result};
use crate::walk::chunks;

/// Order of the displacements.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(i32)]
pub enum Order {
    /// Zel'dovich.
    First = 1,
    /// 2LPT.
    #[default]
    Second = 2,
}

impl TryFrom<i32> for Order {
    type Error = Error;

    /// `Choice` for any number but 1 and 2.
    fn try_from(number: i32) -> Result<Self> {
        match number {
            1 => Ok(Self::First),
            2 => Ok(Self::Second),
            _ => Err(Error::Choice),
        }
    }
}

/// A universe, and when and how large to start it.
#[derive(Clone, Copy, Debug)]
pub struct InitialConditions<'a> {
    /// Which realisation.
    pub realisation: Realisation,
    /// Background of the simulation that will run.
    pub cosmology: Cosmology,
    /// Linear spectrum of z = 0, scaled back with the growth of `cosmology`.
    pub linear: Linear<'a>,
    /// Redshift of the particles.
    pub redshift: f64,
    /// Side of the box in Mpc/h.
    pub box_size: f64,
    /// Local f_NL and g_NL.
    pub local: Local,
    /// In which convention f_NL is given.
    pub convention: Convention,
    /// 1LPT or 2LPT.
    pub order: Order,
}

impl<'a> InitialConditions<'a> {
    fn check(&self) -> Result<()> {
        self.local.check()?;
        if !self.redshift.is_finite() || !self.box_size.is_finite() {
            return Err(Error::NotFinite);
        }
        if self.redshift <= -1.0 || self.box_size <= 0.0 {
            return Err(Error::Range);
        }
        Ok(())
    }

    fn scale_factor(&self) -> f64 {
        1.0 / (1.0 + self.redshift)
    }

    /// alpha, P_Phi and growth at the starting time.
    ///
    /// # Errors
    /// `NotFinite` or `Range` for parameters out of range.
    pub fn poisson(&self) -> Result<Poisson<'a>> {
        self.check()?;
        Poisson::new(&self.cosmology, self.linear, self.scale_factor(), self.convention)
    }

    /// D2/D^2, and velocities over displacements: a H f in km/s per Mpc/h.
    ///
    /// # Errors
    /// As [`InitialConditions::poisson`].
    pub fn motion(&self) -> Result<Motion> {
        self.motion_of(self.poisson()?.growth())
    }

    fn motion_of(&self, growth: Growth) -> Result<Motion> {
        let a = self.scale_factor();
        let hubble = 100.0 * self.cosmology.expansion(a)?;
        Ok(Motion {
            box_size: self.box_size,
            second_order: growth.d2 / (growth.d * growth.d),
            first_velocity: a * hubble * growth.f,
            second_velocity: a * hubble * growth.f2,
        })
    }
}

/// Lengths of the arrays in scratch, in the order in which they lie there.
struct Sizes {
    table: usize,
    partial: usize,
    density: usize,
    mesh: usize,
    rest: usize,
}

impl Sizes {
    fn new<T: Real>(order: Order, fft: &dyn Fft3<T>, fine: Option<&(dyn Fft3<T> + '_)>) -> Result<Self> {
        let work = fine.unwrap_or(fft);
        Ok(Self {
            table: mode_table_length(fft.configuration().n())?,
            partial: chunks(work.configuration()),
            density: fft.length(),
            mesh: work.length().max(fft.length()),
            rest: if order == Order::First { 0 } else { second_order_rest(fft, fine) },
        })
    }

    fn layout<T: Real>(&self) -> Result<Layout> {
        Layout::EMPTY
            .and::<f64>(self.table)?
            .and::<f64>(self.table)?
            .and::<[f64; 1]>(self.partial)?
            .and::<T>(self.density)?
            .and::<T>(self.mesh)?
            .and::<T>(self.rest)
    }
}

/// Scratch of [`initial_conditions`]: at second order one mesh of `fft` and two of `fine`, or four of `fft` without it; at first
/// order one of `fft` and one of `fine`, or two of `fft`. And 16 bytes for each |n|^2 up to 3 (N/2)^2. In bytes a cell, second order,
/// with a `fine` of 3/2 the side: 63 in f64, 32 in f32; without it 33 and 17.
///
/// # Errors
/// `Overflow` if the bytes do not fit the address space.
pub fn initial_conditions_scratch<T: Real>(
    order: Order,
    fft: &dyn Fft3<T>,
    fine: Option<&(dyn Fft3<T> + '_)>,
) -> Result<Layout> {
    Sizes::new(order, fft, fine)?.layout::<T>()
}

/// Positions and velocities of a Fixed, Paired or Matched universe with local primordial non-Gaussianity: noise -> fix -> invert -> colour ->
/// PNG -> transfer -> displace.
///
/// `position` in Mpc/h, in [0, L); `velocity`: peculiar, in km/s (Gadget files store it divided by sqrt(a)). One particle for each cell
/// of `fft`, in the order of [`super::particles`]. `fine`: a transform for products without aliasing, of side 3N/2 or more, 2N
/// or more with g_NL; without it products alias.
///
/// # Errors
/// Those of the stages; outputs are untouched unless it is `Hook`, or `NotFinite` because the fields overflow.
///
/// Cost: with f_NL and second order 15 transforms, or 6 of `fft` and 10 of `fine`; one noise field, and about 33 passes.
pub fn initial_conditions<T: Real>(
    position: &mut Components<'_, T>,
    velocity: &mut Components<'_, T>,
    conditions: &InitialConditions<'_>,
    fft: &mut dyn Fft3<T>,
    mut fine: Option<&mut (dyn Fft3<T> + '_)>,
    scratch: &mut [u8],
    exec: &dyn Exec,
) -> Result<()> {
    let poisson = conditions.poisson()?;
    let motion = conditions.motion_of(poisson.growth())?;
    let n = fft.configuration().n();
    let particles = fft.configuration().elements();
    position.check_length(particles)?;
    velocity.check_length(particles)?;
    if let Some(fine) = fine.as_deref() {
        let least = conditions.local.dealiased_side(n).max(3 * n / 2);
        if fine.configuration().n() < least {
            return Err(Error::Brick);
        }
    }
    let sizes = Sizes::new(conditions.order, fft, fine.as_deref())?;
    let mut arena = Arena::new(scratch, sizes.layout::<T>()?)?;
    let potential_amplitude = arena.take::<f64>(sizes.table)?;
    let transfer = arena.take::<f64>(sizes.table)?;
    let partial = arena.take::<[f64; 1]>(sizes.partial)?;
    let density = arena.take::<T>(sizes.density)?;
    let mesh = arena.take::<T>(sizes.mesh)?;
    potential_amplitude_table(exec, &poisson, n, conditions.box_size, potential_amplitude)?;
    alpha_table(exec, &poisson, n, conditions.box_size, transfer)?;
    let field =
        Field { realisation: conditions.realisation, potential_amplitude, local: conditions.local, transfer };
    linear_density(density, &field, fft, fine.as_deref_mut(), mesh, partial, exec)?;
    match conditions.order {
        Order::First => first_order_particles(position, velocity, density, &motion, fft, mesh, exec),
        Order::Second => {
            let rest = arena.take::<T>(sizes.rest)?;
            second_order_particles(position, velocity, density, &motion, fft, fine, mesh, rest, exec)
        }
    }
}
