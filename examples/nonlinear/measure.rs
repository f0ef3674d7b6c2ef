//! All runs of both boxes, and what is measured in them.

use std::time::{Duration, Instant};

use fixpair::cosmology::Cosmology;
use fixpair::exec::Exec;
use fixpair::halos::particle_mass;

use crate::Failure;
use crate::arguments::Arguments;
use crate::halos::{self, Counts};
use crate::mass_function::{Fit, MassFunction};
use crate::run::{PAIR, run};
use crate::spectrum;
use crate::theory::{Means, REDSHIFTS, Theory};

/// What all pairs of a box give at one redshift.
pub(crate) struct Power {
    /// Theory in each shell.
    pub(crate) theory: Vec<Means>,
    /// Mean P of all runs in each shell, (Mpc/h)^3.
    pub(crate) power: Vec<f64>,
    /// Error of the mean from the scatter of pairs, relative; none of one pair.
    pub(crate) error: Option<Vec<f64>>,
}

impl Power {
    /// Mean P over HMcode-2020 in a shell.
    pub(crate) fn ratio(&self, shell: usize) -> f64 {
        self.power[shell] / self.theory[shell].nonlinear[0]
    }
}

/// Halos of one definition in one bin of one redshift.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Bin {
    /// Fewest particles.
    pub(crate) particles: u64,
    /// Mean ln of the bin's edges as a mass, Msun/h.
    pub(crate) mass: f64,
    /// Halos of all runs.
    pub(crate) found: u64,
    /// Halos that the fit expects.
    pub(crate) expected: f64,
}

impl Bin {
    pub(crate) fn ratio(&self) -> f64 {
        self.found as f64 / self.expected
    }

    /// Poisson error of the ratio.
    pub(crate) fn error(&self) -> f64 {
        (self.found.max(1) as f64).sqrt() / self.expected
    }
}

/// Halos of one definition: the fit, and bins of each redshift.
pub(crate) struct Halos {
    pub(crate) fit: Fit,
    pub(crate) bins: [Vec<Bin>; 2],
}

/// All that is measured.
pub(crate) struct Results {
    /// Empty without a box for P(k); else one of each redshift.
    pub(crate) power: Vec<Power>,
    /// Empty without a box for halos; else groups and spheres.
    pub(crate) halos: Vec<Halos>,
    /// Of all runs.
    pub(crate) elapsed: Duration,
}

/// Runs in all: one each for the members of pairs in the boxes that are wanted.
pub(crate) fn runs(arguments: &Arguments) -> usize {
    let boxes = [arguments.length, arguments.halo_length].into_iter().filter(|&length| length > 0.0).count();
    boxes * PAIR.len() * arguments.seeds as usize
}

/// Makes all runs. `tick` is called after each step.
pub(crate) fn all(
    arguments: &Arguments,
    theory: &Theory,
    exec: &dyn Exec,
    tick: &dyn Fn(),
) -> Result<Results, Failure> {
    let start = Instant::now();
    let mut results = Results { power: Vec::new(), halos: Vec::new(), elapsed: Duration::ZERO };
    if arguments.length > 0.0 {
        results.power = power(arguments, theory, exec, tick)?;
    }
    if arguments.halo_length > 0.0 {
        results.halos = halos(arguments, theory, exec, tick)?;
    }
    results.elapsed = start.elapsed();
    Ok(results)
}

fn seeds(arguments: &Arguments) -> impl Iterator<Item = u64> {
    arguments.first_seed..arguments.first_seed + arguments.seeds
}

fn power(
    arguments: &Arguments,
    theory: &Theory,
    exec: &dyn Exec,
    tick: &dyn Fn(),
) -> Result<Vec<Power>, Failure> {
    let edges = spectrum::edges(arguments.particles);
    let length = arguments.length;
    // Of each output, of each pair, of each shell.
    let mut pairs: [Vec<Vec<f64>>; 2] = Default::default();
    for seed in seeds(arguments) {
        let mut sum = [(); 2].map(|()| vec![0.0; edges.len() - 1]);
        for phase in PAIR {
            run(arguments, theory, length, (seed, phase), exec, tick, &mut |snapshot| {
                let power = spectrum::power(snapshot, &edges, exec)?;
                sum[snapshot.output].iter_mut().zip(&power).for_each(|(sum, power)| *sum += 0.5 * power);
                Ok(())
            })?;
        }
        pairs.iter_mut().zip(sum).for_each(|(pairs, pair)| pairs.push(pair));
    }
    let at_output = |(output, pairs): (usize, &Vec<Vec<f64>>)| {
        let count = pairs.len() as f64;
        let mean = |shell: usize| pairs.iter().map(|pair| pair[shell]).sum::<f64>() / count;
        let power: Vec<f64> = (0..edges.len() - 1).map(mean).collect();
        let error = (pairs.len() > 1).then(|| {
            let of_shell = |(shell, mean): (usize, &f64)| {
                let squares: f64 = pairs.iter().map(|pair| (pair[shell] / mean - 1.0).powi(2)).sum();
                (squares / (count - 1.0) / count).sqrt()
            };
            power.iter().enumerate().map(of_shell).collect()
        });
        Ok(Power { theory: theory.shells(&edges, length, output)?, power, error })
    };
    pairs.iter().enumerate().map(at_output).collect()
}

fn halos(
    arguments: &Arguments,
    theory: &Theory,
    exec: &dyn Exec,
    tick: &dyn Fn(),
) -> Result<Vec<Halos>, Failure> {
    let edges = halos::edges();
    // Of each output, of groups and spheres, of each bin.
    let mut counts: [Counts; 2] = [(); 2].map(|()| [(); 2].map(|()| vec![0; edges.len() - 1]));
    for seed in seeds(arguments) {
        for phase in PAIR {
            run(arguments, theory, arguments.halo_length, (seed, phase), exec, tick, &mut |snapshot| {
                let found = halos::count(snapshot, exec)?;
                let sums = counts[snapshot.output].iter_mut().flatten();
                sums.zip(found.iter().flatten()).for_each(|(sum, found)| *sum += found);
                Ok(())
            })?;
        }
    }
    let particles = arguments.particles.pow(3) as u64;
    let particle = particle_mass(Cosmology::goliat().omega_m, arguments.halo_length, particles)?;
    let last = edges[edges.len() - 1] as f64;
    let function = MassFunction::new(&theory.linear()?, 10.0 * particle, last * particle)?;
    let volume = arguments.halo_length.powi(3) * (PAIR.len() as u64 * arguments.seeds) as f64;
    let bin = |shell: usize, found: u64, fit: Fit, output: usize| {
        // Halos of N particles stand for masses of N - 1/2 to N + 1/2.
        let [low, high] = [edges[shell], edges[shell + 1]].map(|n| (n as f64 - 0.5) * particle);
        let density = function.between(low, high, fit, REDSHIFTS[output], theory.growth()[output]);
        Bin { particles: edges[shell], mass: (low * high).sqrt(), found, expected: density * volume }
    };
    let of = |kind: usize, fit: Fit| Halos {
        fit,
        bins: [0, 1].map(|output| {
            let found = counts[output][kind].iter().enumerate();
            found.map(|(shell, &found)| bin(shell, found, fit, output)).collect()
        }),
    };
    Ok(vec![of(0, Fit::Watson), of(1, Fit::Tinker)])
}
