//! One universe: from a seed and a variant to what is measured in it.

use fixpair::estimate::binning::Binning;
use fixpair::estimate::compensation::Compensation;
use fixpair::initial::png::Local;
use fixpair::noise::{self, Realisation};

use crate::Failure;
use crate::bispectrum::{Those, Triangles};
use crate::evolution::{Plan, Voyage};
use crate::measurement::{Early, Late, Measurement};
use crate::redshift_space::multipoles;
use crate::start::Start;
use crate::store::{Found, Part};
use crate::suite::{Amplitude, Configuration, Phase, Variant};
use crate::transform::with_transform;
use crate::universe::{Universe, fine_side};

/// What making a universe takes. Memory is taken and given back stage by stage.
pub(crate) struct Bench<'a> {
    pub(crate) configuration: &'a Configuration,
    pub(crate) universe: &'a Universe<'a>,
    pub(crate) triangles: &'a Triangles<'a>,
    pub(crate) plan: Plan<'a>,
    /// Told of files that are of no use.
    pub(crate) say: &'a (dyn Fn(&str) + Sync),
}

impl Bench<'_> {
    /// The measurement that an earlier run has left, if it is whole.
    pub(crate) fn recall(&self, seed: u64, variant: Variant) -> Option<Measurement> {
        let name = self.name(seed, variant, "universe");
        match self.plan.store.read(&name) {
            Found::Nothing => None,
            Found::Useless(why) => {
                self.useless(&name, &why);
                None
            }
            Found::Content(mut content) => {
                let measurement = Measurement::of(&mut content);
                if measurement.is_none() {
                    self.useless(&name, "it lacks numbers");
                }
                measurement
            }
        }
    }

    /// Removes what an earlier run has left of a universe.
    pub(crate) fn forget(&self, seed: u64, variant: Variant) {
        ["universe", "checkpoint"]
            .iter()
            .for_each(|kind| self.plan.store.remove(&self.name(seed, variant, kind)));
    }

    /// Makes the universe of `seed` and `variant`, or goes on with it, measures it and writes the measurement; with `more`, also measures its
    /// particles at z = 32 in redshift space and keeps a plane of its density.
    ///
    /// # Errors
    /// Those of the kernels, and of writing.
    pub(crate) fn make(&self, seed: u64, variant: Variant, more: bool) -> Result<Measurement, Failure> {
        let (universe, plan) = (self.universe, &self.plan);
        let checkpoint = self.name(seed, variant, "checkpoint");
        let useless = |why: &str| self.useless(&checkpoint, why);
        let resume = || Voyage::resume(universe, plan.store, &checkpoint, &useless);
        let mut voyage = match resume() {
            Some(voyage) => {
                (0..voyage.steps_done(plan)).for_each(|_| (plan.stepped)());
                voyage
            }
            None => self.start(seed, variant, more)?,
        };
        voyage.run(universe, plan, &checkpoint)?;
        let Voyage { early, position, velocity, .. } = voyage;
        drop(velocity);
        let measurement = Measurement { early, late: Late::of(universe, self.triangles, &position)? };
        let content = measurement.content();
        plan.store.write(&self.name(seed, variant, "universe"), &[Part::Numbers(&content)])?;
        plan.store.remove(&checkpoint);
        Ok(measurement)
    }

    /// Makes the initial conditions and measures them.
    fn start(&self, seed: u64, variant: Variant, more: bool) -> Result<Voyage, Failure> {
        let Self { configuration, universe, triangles, .. } = *self;
        let realisation = Realisation {
            amplitude: match variant.amplitude {
                Amplitude::Normal => noise::Amplitude::Normal,
                Amplitude::Fixed => noise::Amplitude::Fixed,
            },
            phase: match variant.phase {
                Phase::Original => noise::Phase::Original,
                Phase::Inverted => noise::Phase::Inverted,
            },
            ..Realisation::new(seed)
        };
        let local = Local { f_nl: configuration.fnl_of(variant.half), g_nl: 0.0 };
        let start = Start::new(universe, realisation, local)?;
        let (brick, binning) = (universe.fourier()?, Binning::shells(&universe.edges));
        let (_, power) = universe.power(&start.density, &brick, &binning, Compensation::None)?;
        let bispectrum = with_transform(triangles.side, universe.exec, |fft| {
            let mut fields = vec![0.0; triangles.reals(&*fft)?];
            triangles.measure(Those::All, &start.rounded(), &brick, fft, &mut fields)
        })?;
        let slice = if more { Some(start.plane(universe)?) } else { None };
        let [position, velocity] = start.particles(universe)?;
        let multipoles = if more {
            let fine = fine_side(universe.size)?;
            Some(with_transform(fine, universe.exec, |fft| multipoles(universe, &position, &velocity, fft))?)
        } else {
            None
        };
        let (squeezed, fnl) = (triangles.slice_of(&bispectrum), triangles.fnl(&bispectrum));
        Ok(Voyage::new(Early { power, squeezed, fnl, multipoles, slice }, [position, velocity]))
    }

    fn name(&self, seed: u64, variant: Variant, kind: &str) -> String {
        let [amplitude, phase] = variant.names();
        let fnl = self.configuration.fnl_of(variant.half);
        format!("{seed:04}_{amplitude}_{phase}_fnl{fnl}.{kind}")
    }

    fn useless(&self, name: &str, why: &str) {
        let place = self.plan.store.folder().join(name);
        (self.say)(&format!("{} cannot be used ({why}): its universe is made again", place.display()));
    }
}
