//! The command line: what can be chosen, and what each choice must satisfy.

use std::path::PathBuf;
use std::time::Duration;

use lexopt::prelude::*;

use crate::Failure;
use crate::presets::{self, PRESETS, Preset};

/// Printed by `--help`.
pub(crate) fn help() -> String {
    format!(
        "\
goliat: what Fix, Pair and Match do to the scatter of cosmological simulations

For each seed, makes the initial conditions of the GOLIAT-PNG suite at z = 32 (Avila & Adame 2022) in eight variants:
{{normal, fixed}} x {{original, inverted}} x {{f_NL = 0, 100}}; measures the power spectrum and the bispectrum, with f_NL
from all of its triangles, and of the first seed the particles in redshift space; evolves the particles to z = 1, finds
halos, and measures the power spectra and squeezed bispectra of halos and matter; fits bias and f_NL to the spectra of
halos; prints scatter, posteriors and what is significant; and writes tables (CSV) and figures (PNG, SVG).

A run that is stopped, by whatever, goes on where it was when it is started again with the same options and folder.

Usage: cargo run --release --example goliat -- [options]

  -p, --preset NAME        quick, medium or paper: sets the next five           [default: quick]
  -n, --size N             particles a side: even, no prime factor above 7
  -L, --box LENGTH         side of the periodic box in Mpc/h
  -s, --seeds N            number of seeds, at least 2
      --steps N            steps from z = 32 to z = 1, equal in scale factor
  -m, --mesh N             cells of the force a particle and axis: 1, 2 or 3
  -f, --fnl F              f_NL (local, CMB convention) of the non-Gaussian half [default: 100]
  -k, --k-max K            largest k in h/Mpc of the fits of bias and f_NL      [default: 0.09]
  -t, --threads N          threads; the results do not depend on it             [default: all cores]
  -o, --output FOLDER      where tables and figures go, made if missing         [default: goliat-output]
  -c, --checkpoint MINUTES how often a universe under way is saved              [default: 3]
      --fresh              do again what earlier runs have left in the folder
  -h, --help               print this and stop

{}",
        presets::table()
    )
}

/// A checked choice of everything that the program lets a person choose.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Arguments {
    /// Cells and particles a side.
    pub(crate) size: usize,
    /// Side of the box, Mpc/h.
    pub(crate) length: f64,
    /// Number of seeds.
    pub(crate) seeds: usize,
    /// Steps in time.
    pub(crate) steps: usize,
    /// Cells of the mesh of the force a particle and axis.
    pub(crate) mesh_factor: usize,
    /// f_NL of the non-Gaussian variants.
    pub(crate) fnl: f64,
    /// Largest k of the fits of bias, h/Mpc.
    pub(crate) k_max: f64,
    /// Worker threads.
    pub(crate) threads: usize,
    /// Folder for tables and figures.
    pub(crate) output: PathBuf,
    /// Between two checkpoints of a universe.
    pub(crate) checkpoint: Duration,
    /// Whether results in the folder are ignored.
    pub(crate) fresh: bool,
}

impl Arguments {
    /// What a preset leaves when nothing else is said.
    pub(crate) fn preset(preset: &Preset) -> Self {
        let Preset { size, length, seeds, steps, mesh_factor, .. } = *preset;
        Self {
            size,
            length,
            seeds,
            steps,
            mesh_factor,
            fnl: 100.0,
            k_max: 0.09,
            threads: std::thread::available_parallelism().map_or(1, std::num::NonZero::get),
            output: PathBuf::from("goliat-output"),
            checkpoint: Duration::from_secs(180),
            fresh: false,
        }
    }
}

/// What the command line asks for.
#[derive(Debug, PartialEq)]
pub(crate) enum Request {
    Help,
    Run(Arguments),
}

/// Reads and checks the command line. Options may come in any order.
///
/// # Errors
/// A sentence that names the option and what it must be.
pub(crate) fn parse(mut parser: lexopt::Parser) -> Result<Request, Failure> {
    let mut preset = &PRESETS[0];
    // What each option does to the preset, once that is known.
    let mut changes: Vec<Box<dyn FnOnce(&mut Arguments)>> = Vec::new();
    macro_rules! set {
        ($field:ident) => {{
            let value = parser.value()?.parse()?;
            changes.push(Box::new(move |arguments| arguments.$field = value));
        }};
    }
    while let Some(argument) = parser.next()? {
        match argument {
            Short('p') | Long("preset") => {
                let name = parser.value()?.string()?;
                let known = PRESETS.iter().find(|preset| preset.name == name);
                preset = known.ok_or("--preset must be quick, medium or paper")?;
            }
            Short('n') | Long("size") => set!(size),
            Short('L') | Long("box") => set!(length),
            Short('s') | Long("seeds") => set!(seeds),
            Long("steps") => set!(steps),
            Short('m') | Long("mesh") => set!(mesh_factor),
            Short('f') | Long("fnl") => set!(fnl),
            Short('k') | Long("k-max") => set!(k_max),
            Short('t') | Long("threads") => set!(threads),
            Short('o') | Long("output") => {
                let folder = parser.value()?.into();
                changes.push(Box::new(move |arguments| arguments.output = folder));
            }
            Short('c') | Long("checkpoint") => {
                let minutes: f64 = parser.value()?.parse()?;
                let time = Duration::try_from_secs_f64(60.0 * minutes);
                let time = time.map_err(|_| "--checkpoint must be a number of minutes, not below 0")?;
                changes.push(Box::new(move |arguments| arguments.checkpoint = time));
            }
            Long("fresh") => changes.push(Box::new(|arguments| arguments.fresh = true)),
            Short('h') | Long("help") => return Ok(Request::Help),
            _ => return Err(argument.unexpected().into()),
        }
    }
    let mut arguments = Arguments::preset(preset);
    changes.into_iter().for_each(|change| change(&mut arguments));
    arguments.check()?;
    Ok(Request::Run(arguments))
}

impl Arguments {
    fn check(&self) -> Result<(), Failure> {
        let demands = [
            // Below 16 cells there are not three ranges of k to report.
            (
                self.size >= 16 && transformable(self.size),
                "--size must be even, at least 16, with no prime factor above 7",
            ),
            // Ids and sorts of halo finding hold 32 bits.
            (self.size <= 1600, "--size must be at most 1600"),
            (self.length.is_finite() && self.length > 0.0, "--box must be a positive length in Mpc/h"),
            (self.seeds >= 2, "--seeds must be at least 2: one seed has no scatter"),
            ((1..=10_000).contains(&self.steps), "--steps must be 1 to 10000"),
            ((1..=3).contains(&self.mesh_factor), "--mesh must be 1, 2 or 3"),
            (
                self.fnl.is_finite() && self.fnl != 0.0,
                "--fnl must be a number other than 0: f_NL = 0 is always made",
            ),
            (self.k_max.is_finite() && self.k_max > 0.0, "--k-max must be a positive wavenumber in h/Mpc"),
            (self.threads >= 1, "--threads must be at least 1"),
        ];
        match demands.iter().find(|(met, _)| !met) {
            Some((_, demand)) => Err((*demand).into()),
            None => Ok(()),
        }
    }
}

/// Whether the built-in transform takes meshes of this side.
fn transformable(size: usize) -> bool {
    let mut rest = size;
    for factor in [2, 3, 5, 7] {
        while rest > 0 && rest.is_multiple_of(factor) {
            rest /= factor;
        }
    }
    rest == 1 && size.is_multiple_of(2)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(line: &str) -> Result<Request, Failure> {
        parse(lexopt::Parser::from_args(line.split_whitespace()))
    }

    #[test]
    fn no_options_give_the_quick_preset_and_options_replace_its_numbers() {
        let quick = Arguments::preset(&PRESETS[0]);
        assert_eq!(read("").unwrap(), Request::Run(quick.clone()));
        assert_eq!(read("-p quick").unwrap(), Request::Run(quick.clone()));
        let wanted = Arguments { size: 64, fnl: -30.0, output: PathBuf::from("x"), ..quick };
        assert_eq!(read("--size 64 --fnl=-30 -o x").unwrap(), Request::Run(wanted));
        assert_eq!(read("--size 3 --help").unwrap(), Request::Help);
    }

    #[test]
    fn the_order_of_options_does_not_matter() {
        let wanted = Arguments { seeds: 3, fresh: true, ..Arguments::preset(&PRESETS[2]) };
        let one = read("--seeds 3 --fresh --preset paper").unwrap();
        assert_eq!(one, read("--preset paper --fresh --seeds 3").unwrap());
        assert_eq!(one, Request::Run(wanted));
    }

    #[test]
    fn presets_are_choices_that_pass_the_checks_and_help_lists_them() {
        for preset in &PRESETS {
            Arguments::preset(preset).check().unwrap();
            assert!(help().contains(&format!("{}^3", preset.size)));
        }
    }

    #[test]
    fn impossible_choices_are_named() {
        for (line, option) in [
            ("--preset huge", "--preset"),
            ("--size 66", "--size"),
            ("--size 45", "--size"),
            ("--size 0", "--size"),
            ("--size 2048", "--size"),
            ("--box -1", "--box"),
            ("--box nan", "--box"),
            ("--seeds 1", "--seeds"),
            ("--steps 0", "--steps"),
            ("--mesh 4", "--mesh"),
            ("--fnl 0", "--fnl"),
            ("--k-max 0", "--k-max"),
            ("--threads 0", "--threads"),
            ("--checkpoint -1", "--checkpoint"),
            ("--colour", "--colour"),
        ] {
            let message = read(line).unwrap_err().to_string();
            assert!(message.contains(option), "{line}: {message}");
        }
    }
}
