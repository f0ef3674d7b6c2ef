//! Particles from z = 32 to z = 1, in steps that may be interrupted anywhere.
//!
//! FastPM with a force on a mesh (`fixpair::pm::evolve`). After each step that ends longer than the interval since the last checkpoint, the run is stopped,
//! what it is made of (positions, velocities, epoch) goes to disk, and it goes on; the library's promise is that nothing of
//! this shows in the bits.

use std::time::{Duration, Instant};

use fixpair::cosmology::Cosmology;
use fixpair::fft::Fft3;
use fixpair::initial::particles::Components;
use fixpair::pm::evolve::{Epoch, Gravity, Workshop, evolve, evolve_scratch};
use fixpair::pm::factors::{Stepper, linear_steps};
use fixpair::pm::outputs::Verdict;
use fixpair::pm::{ForceLaw, Window};
use fixpair::status::Error;

use crate::Failure;
use crate::measurement::Early;
use crate::memory::Memory;
use crate::store::{Content, Found, Part, Store};
use crate::transform::with_transform;
use crate::universe::{END, REDSHIFT, Universe};

const WINDOW: Window = Window::CloudInCell;

/// A universe under way, and what was measured at its start.
#[derive(Debug, PartialEq)]
pub(crate) struct Voyage {
    pub(crate) early: Early,
    /// Triples, Mpc/h.
    pub(crate) position: Vec<f32>,
    /// Triples, peculiar, km/s.
    pub(crate) velocity: Vec<f32>,
    pub(crate) epoch: Epoch,
}

/// How to go, and when to save.
pub(crate) struct Plan<'a> {
    pub(crate) steps: usize,
    pub(crate) mesh_factor: usize,
    pub(crate) checkpoint: Duration,
    pub(crate) store: &'a Store,
    /// Called after each step.
    pub(crate) stepped: &'a (dyn Fn() + Sync),
}

impl Voyage {
    /// Before the first step.
    pub(crate) fn new(early: Early, [position, velocity]: [Vec<f32>; 2]) -> Self {
        Self { early, position, velocity, epoch: Epoch::at(1.0 / (1.0 + REDSHIFT)) }
    }

    /// To z = 1, with checkpoints under this name.
    ///
    /// # Errors
    /// Those of the kernels, and of writing.
    pub(crate) fn run(
        &mut self,
        universe: &Universe<'_>,
        plan: &Plan<'_>,
        name: &str,
    ) -> Result<(), Failure> {
        let list = scale_factors(plan.steps)?;
        let exec = universe.exec;
        let gravity = Gravity {
            cosmology: Cosmology::goliat(),
            box_size: universe.length,
            hubble: 100.0,
            window: WINDOW,
            law: ForceLaw::FOUR_POINT,
            stepper: Stepper::FastPm,
        };
        with_transform(universe.size * plan.mesh_factor, exec, |fft| {
            let mut meshes = [(); 3].map(|()| vec![0.0; fft.length()]);
            let mut scratch = Memory::new(evolve_scratch(&*fft, self.position.len() / 3, WINDOW)?);
            loop {
                let mut workshop = Workshop {
                    meshes: meshes.each_mut().map(Vec::as_mut_slice),
                    fft: &mut *fft,
                    scratch: scratch.bytes(),
                    exec,
                };
                let x = &mut Components::triples(&mut self.position)?;
                let u = &mut Components::triples(&mut self.velocity)?;
                let since = Instant::now();
                let outcome = evolve(
                    &gravity,
                    &mut self.epoch,
                    x,
                    u,
                    None,
                    &list,
                    None,
                    &mut workshop,
                    &mut |progress| {
                        (plan.stepped)();
                        let due = progress.step < progress.steps && since.elapsed() >= plan.checkpoint;
                        if due { Verdict::Stop } else { Verdict::Continue }
                    },
                );
                match outcome {
                    Ok(()) => return Ok(()),
                    Err(Error::Stopped) => self.save(plan.store, name)?,
                    Err(error) => return Err(error.into()),
                }
            }
        })
    }

    fn save(&self, store: &Store, name: &str) -> Result<(), Failure> {
        let mut numbers = Content::default();
        self.early.put(&mut numbers);
        numbers.put_real(self.epoch.position);
        numbers.put_real(self.epoch.velocity);
        let parts = [Part::Numbers(&numbers), Part::Singles(&self.position), Part::Singles(&self.velocity)];
        store.write(name, &parts)
    }

    /// From a checkpoint, if there is one; `useless` is told why one is not used.
    pub(crate) fn resume(
        universe: &Universe<'_>,
        store: &Store,
        name: &str,
        useless: &dyn Fn(&str),
    ) -> Option<Self> {
        let mut content = match store.read(name) {
            Found::Nothing => return None,
            Found::Useless(why) => {
                useless(&why);
                return None;
            }
            Found::Content(content) => content,
        };
        let mut read = || {
            let early = Early::get(&mut content)?;
            let epoch = Epoch { position: content.get_real()?, velocity: content.get_real()? };
            let (position, velocity) = (content.get_singles()?, content.get_singles()?);
            let reals = 3 * universe.size.pow(3);
            let whole = position.len() == reals && velocity.len() == reals;
            whole.then_some(Self { early, position, velocity, epoch })
        };
        let voyage = read();
        if voyage.is_none() {
            useless("it lacks numbers");
        }
        voyage
    }

    /// Steps that are done.
    pub(crate) fn steps_done(&self, plan: &Plan<'_>) -> usize {
        let list = scale_factors(plan.steps).unwrap_or_default();
        list.iter().position(|&a| a == self.epoch.position).unwrap_or(0)
    }
}

/// Equal steps of a: where halos form, late, they are short.
fn scale_factors(steps: usize) -> Result<Vec<f64>, Failure> {
    let mut list = vec![0.0; steps + 1];
    linear_steps(&mut list, 1.0 / (1.0 + REDSHIFT), 1.0 / (1.0 + END))?;
    Ok(list)
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicUsize, Ordering};

    use fixpair::exec::Serial;
    use fixpair::initial::png::Local;
    use fixpair::noise::Realisation;

    use super::*;
    use crate::start::Start;
    use crate::store::tests::folder;

    #[test]
    fn a_run_that_goes_on_from_a_checkpoint_has_the_bits_of_one_that_never_stopped() {
        let output = folder("evolution");
        let store = Store::new(&output, String::from("a key")).unwrap();
        let universe = Universe::new(16, 100.0, &Serial).unwrap();
        let start = Start::new(&universe, Realisation::new(1), Local::default()).unwrap();
        let early = Early { power: vec![1.0], fnl: 2.0, ..Early::default() };
        let mut whole = Voyage::new(early, start.particles(&universe).unwrap());
        let mut stopped = copy(&whole);
        let nothing = || ();
        let plan =
            |checkpoint, stepped| Plan { steps: 6, mesh_factor: 2, checkpoint, store: &store, stepped };
        whole.run(&universe, &plan(Duration::MAX, &nothing), "never").unwrap();
        assert_eq!(store.read("never"), Found::Nothing);

        // While step 4 goes on, the disk has what a kill would leave: step 3.
        let steps = AtomicUsize::new(0);
        let steal = || {
            if steps.fetch_add(1, Ordering::Relaxed) == 3 {
                std::fs::copy(store.folder().join("often"), store.folder().join("third")).unwrap();
            }
        };
        stopped.run(&universe, &plan(Duration::ZERO, &steal), "often").unwrap();
        assert_eq!(stopped, whole);
        assert_eq!(steps.load(Ordering::Relaxed), 6);
        let mut resumed = Voyage::resume(&universe, &store, "third", &|why| panic!("{why}")).unwrap();
        let plan = plan(Duration::MAX, &nothing);
        assert_eq!(resumed.steps_done(&plan), 3);
        resumed.run(&universe, &plan, "third").unwrap();
        assert_eq!(resumed, whole);
        std::fs::remove_dir_all(output).unwrap();
    }

    fn copy(voyage: &Voyage) -> Voyage {
        let Voyage { early, position, velocity, epoch } = voyage;
        Voyage { early: early.clone(), position: position.clone(), velocity: velocity.clone(), epoch: *epoch }
    }
}
