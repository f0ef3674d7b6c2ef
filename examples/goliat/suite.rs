//! The suite: for each seed, eight variants of one universe, made and measured in parallel, or recalled from earlier runs.

use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

use fixpair::estimate::binning::Binning;
use fixpair::estimate::compensation::Compensation;
use fixpair::exec::{Exec, Serial, Threads};

use crate::Failure;
use crate::arguments::Arguments;
use crate::bispectrum::Triangles;
use crate::evolution::Plan;
use crate::measure::Bench;
use crate::measurement::{Bins, Measurement};
use crate::presets::{self, available, share};
use crate::redshift_space::{Multipoles, linear_multipoles};
use crate::store::Store;
use crate::universe::{END, REDSHIFT, Universe, bispectrum_sides};

/// The modulus of each mode: Rayleigh, or fixed to its r.m.s.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Amplitude {
    Normal,
    Fixed,
}

/// The phase of each mode: the seed's, or turned by pi.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Phase {
    Original,
    Inverted,
}

/// Which f_NL: 0, or that of the command line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Half {
    Gaussian,
    Local,
}

/// One of the eight universes that share the random numbers of a seed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Variant {
    pub(crate) amplitude: Amplitude,
    pub(crate) phase: Phase,
    pub(crate) half: Half,
}

impl Variant {
    pub(crate) const COUNT: usize = 8;

    /// All eight; `ALL[i].index() == i`.
    pub(crate) fn all() -> [Self; Self::COUNT] {
        std::array::from_fn(|i| Self {
            amplitude: if i & 4 == 0 { Amplitude::Normal } else { Amplitude::Fixed },
            phase: if i & 2 == 0 { Phase::Original } else { Phase::Inverted },
            half: if i & 1 == 0 { Half::Gaussian } else { Half::Local },
        })
    }

    pub(crate) const fn index(self) -> usize {
        self.amplitude as usize * 4 + self.phase as usize * 2 + self.half as usize
    }

    /// Names as they stand in tables: amplitude, phase.
    pub(crate) const fn names(self) -> [&'static str; 2] {
        [
            match self.amplitude {
                Amplitude::Normal => "normal",
                Amplitude::Fixed => "fixed",
            },
            match self.phase {
                Phase::Original => "original",
                Phase::Inverted => "inverted",
            },
        ]
    }
}

/// What all universes of the suite share.
pub(crate) struct Configuration {
    /// Cells and particles a side.
    pub(crate) size: usize,
    /// Side of the box, Mpc/h.
    pub(crate) length: f64,
    /// f_NL of the half that is not Gaussian (local, CMB convention).
    pub(crate) fnl: f64,
    /// Largest k of the fits of bias, h/Mpc.
    pub(crate) k_max: f64,
    /// Linear theory of the multipoles in redshift space, averaged over the modes of each bin, (Mpc/h)^3.
    pub(crate) linear_multipoles: Multipoles,
}

impl Configuration {
    pub(crate) const fn fnl_of(&self, half: Half) -> f64 {
        match half {
            Half::Gaussian => 0.0,
            Half::Local => self.fnl,
        }
    }
}

/// All measurements of all seeds.
pub(crate) struct Suite {
    pub(crate) configuration: Configuration,
    pub(crate) seeds: Vec<u64>,
    bins: Bins,
    measurements: Vec<Measurement>,
}

/// Whom a run tells how it goes. From any thread.
pub(crate) struct Watch<'a> {
    /// So many steps are done.
    pub(crate) advance: &'a (dyn Fn(usize) + Sync),
    /// Something that a person should know.
    pub(crate) say: &'a (dyn Fn(&str) + Sync),
}

impl Suite {
    /// The measurement of the seed with this place in `seeds`.
    pub(crate) fn get(&self, seed: usize, variant: Variant) -> &Measurement {
        &self.measurements[seed * Variant::COUNT + variant.index()]
    }

    /// What all measurements share.
    pub(crate) fn bins(&self) -> &Bins {
        &self.bins
    }

    /// A suite of given measurements, seed by seed in the order of `Variant::all`.
    ///
    /// # Errors
    /// If a bin is empty, or a measurement is not sound: no statistic is made of such a suite.
    pub(crate) fn new(
        configuration: Configuration,
        seeds: Vec<u64>,
        bins: Bins,
        measurements: Vec<Measurement>,
    ) -> Result<Self, Failure> {
        let theory = [&bins.k, &bins.theory, &bins.late_theory];
        let positive = theory.iter().all(|column| column.iter().all(|&value| value > 0.0));
        if !positive || bins.modes.contains(&0) || measurements.len() != seeds.len() * Variant::COUNT {
            return Err("a bin is empty".into());
        }
        if !measurements.iter().all(|measurement| measurement.is_sound(&bins)) {
            return Err("a spectrum lacks bins, is not a number, or is not positive".into());
        }
        Ok(Self { configuration, seeds, bins, measurements })
    }

    #[cfg(test)]
    pub(crate) fn measurements_for_test(&self) -> Vec<Measurement> {
        self.measurements.clone()
    }

    /// Steps that `Watch::advance` counts in a universe.
    pub(crate) fn steps_of_one(arguments: &Arguments) -> usize {
        arguments.steps + 1
    }

    /// Makes and measures everything that earlier runs have not left in the folder.
    ///
    /// Each worker makes whole universes, one at a time; where memory is short, all threads work on one universe. The numbers do not depend on it.
    ///
    /// # Errors
    /// The first failure of a measurement, or of writing.
    pub(crate) fn run(arguments: &Arguments, watch: &Watch<'_>) -> Result<Self, Failure> {
        let Arguments { size, length, fnl, k_max, steps, mesh_factor, checkpoint, .. } = *arguments;
        let need = memory(size, mesh_factor)?;
        let [workers, threads] = share(arguments.threads, need, available());
        let pool = if threads > 1 { Some(Threads::new(threads)?) } else { None };
        let exec: &dyn Exec = pool.as_ref().map_or(&Serial, |pool| pool);
        let universe = Universe::new(size, length, exec)?;
        let triangles = Triangles::new(&universe)?;
        let configuration =
            Configuration { size, length, fnl, k_max, linear_multipoles: linear_multipoles(&universe)? };
        let store = Store::new(&arguments.output, key(arguments))?;
        let stepped = || (watch.advance)(1);
        let plan = Plan { steps, mesh_factor, checkpoint, store: &store, stepped: &stepped };
        let bench = Bench {
            configuration: &configuration,
            universe: &universe,
            triangles: &triangles,
            plan,
            say: watch.say,
        };

        let seeds: Vec<u64> = (1..).take(arguments.seeds).collect();
        let jobs: Vec<(u64, Variant)> =
            seeds.iter().flat_map(|&seed| Variant::all().map(|variant| (seed, variant))).collect();
        if arguments.fresh {
            jobs.iter().for_each(|&(seed, variant)| bench.forget(seed, variant));
        }
        let recall = |&(seed, variant): &(u64, Variant)| bench.recall(seed, variant);
        let found: Vec<Option<Measurement>> = jobs.iter().map(recall).collect();
        let missing: Vec<usize> = (0..jobs.len()).filter(|&job| found[job].is_none()).collect();
        let old = jobs.len() - missing.len();
        if old > 0 {
            (watch.say)(&format!("{old} of {} universes are in {}", jobs.len(), store.folder().display()));
            (watch.advance)(old * Self::steps_of_one(arguments));
        }

        let next = AtomicUsize::new(0);
        let results = Mutex::new(found);
        let failure: Mutex<Option<Failure>> = Mutex::new(None);
        std::thread::scope(|scope| {
            for _ in 0..workers.min(missing.len()) {
                scope.spawn(|| {
                    while let Some(&job) = missing.get(next.fetch_add(1, Ordering::Relaxed)) {
                        let (seed, variant) = jobs[job];
                        match bench.make(seed, variant, seed == seeds[0]) {
                            Ok(measurement) => lock(&results)[job] = Some(measurement),
                            Err(error) => {
                                lock(&failure).get_or_insert(error);
                                next.store(missing.len(), Ordering::Relaxed);
                            }
                        }
                        (watch.advance)(1);
                    }
                });
            }
        });
        if let Some(error) = lock(&failure).take() {
            return Err(error);
        }
        let measurements: Option<Vec<_>> = lock(&results).drain(..).collect();
        let bins = bins(&universe, &triangles)?;
        Self::new(configuration, seeds, bins, measurements.ok_or("a measurement is missing")?)
    }
}

/// Everything that determines a universe but its seed and variant, for people and for the store.
fn key(arguments: &Arguments) -> String {
    let Arguments { size, length, fnl, steps, mesh_factor, .. } = arguments;
    let version = env!("CARGO_PKG_VERSION");
    format!(
        "goliat {version}, results {RESULTS}: {size}^3 particles in ({length} Mpc/h)^3, f_NL = {fnl}, \
         {steps} steps from z = {REDSHIFT} to z = {END}, mesh {mesh_factor}x\n"
    )
}

/// Increases with each change of the program that changes numbers.
const RESULTS: u32 = 2;

/// Bytes of one universe.
fn memory(size: usize, mesh_factor: usize) -> Result<usize, Failure> {
    let [reach, side] = bispectrum_sides(size)?;
    // The number of shells grows with the logarithm of the reach: 17 of them at most.
    let shells = if reach < 100 { 15 } else { 18 };
    Ok(presets::memory(size, mesh_factor, shells * side.pow(3)))
}

fn bins(universe: &Universe<'_>, triangles: &Triangles<'_>) -> Result<Bins, Failure> {
    let binning = Binning::shells(&universe.edges);
    let (bins, _) =
        universe.power(&universe.linear_modes()?, &universe.fourier()?, &binning, Compensation::None)?;
    let growth = universe.growth;
    Ok(Bins {
        k: bins.iter().map(|bin| universe.wavenumber(bin.first)).collect(),
        modes: bins.iter().map(|bin| bin.count).collect(),
        theory: universe.theory.clone(),
        late_theory: universe.theory.iter().map(|power| power * growth * growth).collect(),
        late_alpha: bins
            .iter()
            .map(|bin| growth * universe.alpha[(bin.first * bin.first).round() as usize])
            .collect(),
        squeezed: triangles.slice.clone(),
        squeezed_growth: growth.powi(3),
    })
}

/// A worker that panicked ends the program at the end of its scope, so poison needs no care here.
fn lock<T>(mutex: &Mutex<T>) -> std::sync::MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(std::sync::PoisonError::into_inner)
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;
    use crate::presets::PRESETS;
    use crate::store::tests::folder;

    #[test]
    fn variants_are_eight_different_ones_in_the_order_of_their_index() {
        for (i, variant) in Variant::all().into_iter().enumerate() {
            assert_eq!(variant.index(), i);
        }
    }

    #[test]
    fn what_is_there_is_not_made_again_and_what_is_damaged_is_with_the_same_bits() {
        let output = folder("suite");
        let arguments = Arguments {
            size: 16,
            length: 60.0,
            seeds: 2,
            steps: 3,
            threads: 1,
            output: output.clone(),
            ..Arguments::preset(&PRESETS[0])
        };
        let run = |arguments: &Arguments| {
            let (steps, lines) = (AtomicUsize::new(0), Mutex::new(Vec::new()));
            let advance = |more| {
                steps.fetch_add(more, Ordering::Relaxed);
            };
            let say = |line: &str| lock(&lines).push(String::from(line));
            let suite = Suite::run(arguments, &Watch { advance: &advance, say: &say }).unwrap();
            assert_eq!(steps.into_inner(), 16 * Suite::steps_of_one(arguments));
            (suite, lock(&lines).drain(..).collect::<Vec<_>>())
        };
        let (first, lines) = run(&arguments);
        assert!(lines.is_empty(), "{lines:?}");
        assert!(first.measurements.iter().any(|one| one.late.count > 0));

        let store = Store::new(&output, key(&arguments)).unwrap();
        let files = || {
            let mut files: Vec<_> =
                std::fs::read_dir(store.folder()).unwrap().map(|file| file.unwrap().path()).collect();
            files.retain(|file| file.extension().is_some_and(|kind| kind == "universe"));
            files.sort();
            files
        };
        assert_eq!(files().len(), 16);
        // One is gone, one cut, one of nonsense; other threads and checkpoints make them again.
        std::fs::remove_file(&files()[0]).unwrap();
        let whole = std::fs::read(&files()[1]).unwrap();
        std::fs::write(&files()[1], &whole[..whole.len() - 5]).unwrap();
        std::fs::write(&files()[2], b"nonsense").unwrap();
        let (second, lines) = run(&Arguments { threads: 3, checkpoint: Duration::ZERO, ..arguments.clone() });
        assert_eq!(second.measurements, first.measurements);
        assert_eq!(lines.iter().filter(|line| line.contains("cannot be used")).count(), 2, "{lines:?}");
        assert!(lines.iter().any(|line| line.starts_with("13 of 16 universes are in")), "{lines:?}");

        let (third, lines) = run(&Arguments { fresh: true, ..arguments.clone() });
        assert_eq!(third.measurements, first.measurements);
        assert!(lines.is_empty(), "{lines:?}");
        // Another run with other settings beside it.
        let (other, _) = run(&Arguments { fnl: 50.0, ..arguments });
        assert_ne!(other.measurements, first.measurements);
        std::fs::remove_dir_all(output).unwrap();
    }
}
