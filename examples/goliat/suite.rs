//! The suite: for each seed, eight variants of one universe, measured in parallel.

use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

use crate::Failure;
use crate::arguments::Arguments;
use crate::bispectrum::{Slice, Triangles};
use crate::measure::with_bench;
use crate::redshift_space::{Multipoles, linear_multipoles};
use crate::universe::Universe;

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

/// One of the eight initial conditions that share the random numbers of a seed.
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

/// What all initial conditions of the suite share.
pub(crate) struct Configuration {
    /// Cells and particles a side.
    pub(crate) size: usize,
    /// Side of the box, Mpc/h.
    pub(crate) length: f64,
    /// f_NL of the half that is not Gaussian (local, CMB convention).
    pub(crate) fnl: f64,
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

/// What is measured in one initial condition at z = 32. The first three columns, and all of `squeezed` but its values,
/// are the same for all variants.
#[derive(Clone, Debug)]
pub(crate) struct Measurement {
    /// Mean wavenumber of each bin, h/Mpc, increasing.
    pub(crate) k: Vec<f64>,
    /// Modes in each bin, counting k and -k.
    pub(crate) modes: Vec<u64>,
    /// Linear theory averaged over the modes of each bin, (Mpc/h)^3.
    pub(crate) theory: Vec<f64>,
    /// Measured power, (Mpc/h)^3.
    pub(crate) power: Vec<f64>,
    /// The bispectrum of squeezed triangles.
    pub(crate) squeezed: Slice,
    /// f_NL from all triangles of this one field.
    pub(crate) fnl: f64,
    /// Multipoles of the particles in redshift space, (Mpc/h)^3, in the same bins; only where they were asked for.
    pub(crate) multipoles: Option<Multipoles>,
    /// Density contrast in one plane of the mesh, `size` x `size`, x fastest; only where it was asked for.
    pub(crate) slice: Option<Vec<f32>>,
}

/// All measurements of all seeds.
pub(crate) struct Suite {
    pub(crate) configuration: Configuration,
    pub(crate) seeds: Vec<u64>,
    measurements: Vec<Measurement>,
}

impl Suite {
    /// The measurement of the seed with this place in `seeds`.
    pub(crate) fn get(&self, seed: usize, variant: Variant) -> &Measurement {
        &self.measurements[seed * Variant::COUNT + variant.index()]
    }

    /// Any measurement, for the columns that all share.
    pub(crate) fn bins(&self) -> &Measurement {
        &self.measurements[0]
    }

    /// A suite of given measurements, seed by seed in the order of `Variant::all`.
    ///
    /// # Errors
    /// If the bins differ, a bin is empty, or a number is not finite: no statistic is made of such a suite.
    pub(crate) fn new(
        configuration: Configuration,
        seeds: Vec<u64>,
        measurements: Vec<Measurement>,
    ) -> Result<Self, Failure> {
        let first = measurements.first().ok_or("there is no measurement")?;
        for measurement in &measurements {
            let columns = [&measurement.k, &measurement.theory, &measurement.power];
            let positive = columns.iter().all(|column| {
                column.len() == first.modes.len()
                    && column.iter().all(|&value| value.is_finite() && value > 0.0)
            });
            if !positive || measurement.modes != first.modes || first.modes.contains(&0) {
                return Err("a power spectrum has an empty bin or a value that is not positive".into());
            }
            let (squeezed, multipoles) = (&measurement.squeezed, measurement.multipoles.as_ref());
            let columns = [&squeezed.k, &squeezed.template, &squeezed.sigma, &squeezed.value];
            let whole = columns.iter().all(|column| column.len() == squeezed.count.len());
            let mut rest = columns.into_iter().chain(multipoles.into_iter().flatten()).flatten();
            if !whole || !measurement.fnl.is_finite() || rest.any(|value| !value.is_finite()) {
                return Err("a bispectrum or a multipole is not a number".into());
            }
        }
        Ok(Self { configuration, seeds, measurements })
    }

    #[cfg(test)]
    pub(crate) fn measurements_for_test(&self) -> Vec<Measurement> {
        self.measurements.clone()
    }

    /// Makes and measures everything; `done` is called after each initial condition, from any thread.
    ///
    /// Each worker makes whole initial conditions, one at a time, so memory grows with the threads and
    /// the numbers do not depend on them.
    ///
    /// # Errors
    /// The first failure of a measurement.
    pub(crate) fn run(arguments: &Arguments, done: &(dyn Fn() + Sync)) -> Result<Self, Failure> {
        let Arguments { size, length, fnl, .. } = *arguments;
        let universe = Universe::new(size, length)?;
        let triangles = Triangles::new(&universe)?;
        let configuration =
            Configuration { size, length, fnl, linear_multipoles: linear_multipoles(&universe)? };
        let seeds: Vec<u64> = (1..).take(arguments.seeds).collect();
        let jobs = seeds.len() * Variant::COUNT;
        let next = AtomicUsize::new(0);
        let results: Mutex<Vec<Option<Measurement>>> = Mutex::new(vec![None; jobs]);
        let failure: Mutex<Option<Failure>> = Mutex::new(None);
        std::thread::scope(|scope| {
            for _ in 0..arguments.threads.min(jobs) {
                scope.spawn(|| {
                    let outcome = with_bench(&configuration, &universe, &triangles, |bench| {
                        loop {
                            let job = next.fetch_add(1, Ordering::Relaxed);
                            if job >= jobs {
                                return Ok(());
                            }
                            let (seed, variant) =
                                (job / Variant::COUNT, Variant::all()[job % Variant::COUNT]);
                            let measurement = bench.measure(seeds[seed], variant, seed == 0)?;
                            lock(&results)[job] = Some(measurement);
                            done();
                        }
                    });
                    if let Err(error) = outcome {
                        lock(&failure).get_or_insert(error);
                        next.store(jobs, Ordering::Relaxed);
                    }
                });
            }
        });
        if let Some(error) = lock(&failure).take() {
            return Err(error);
        }
        let measurements: Option<Vec<_>> = lock(&results).drain(..).collect();
        Self::new(configuration, seeds, measurements.ok_or("a measurement is missing")?)
    }
}

/// A worker that panicked ends the program at the end of its scope, so poison needs no care here.
fn lock<T>(mutex: &Mutex<T>) -> std::sync::MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(std::sync::PoisonError::into_inner)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn variants_are_eight_different_ones_in_the_order_of_their_index() {
        for (i, variant) in Variant::all().into_iter().enumerate() {
            assert_eq!(variant.index(), i);
        }
    }
}
