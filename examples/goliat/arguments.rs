//! The command line: what can be chosen, and what each choice must satisfy.

use std::path::PathBuf;

use lexopt::prelude::*;

use crate::Failure;

/// Printed by `--help`.
pub(crate) const HELP: &str = "\
goliat: what Fix, Pair and Match do to the scatter of cosmological initial conditions

For each seed, makes the initial conditions of the GOLIAT-PNG suite at z = 32 (Avila & Adame 2022) in eight variants:
{normal, fixed} x {original, inverted} x {f_NL = 0, 100}; measures the power spectrum and the bispectrum, with f_NL
from all of its triangles, and of the first seed the particles in redshift space; prints their scatter; and writes
tables (CSV) and figures (PNG, SVG).

Usage: cargo run --release --example goliat -- [options]

  -n, --size N        cells and particles a side: even, no prime factor above 7   [default: 96]
  -L, --box LENGTH    side of the periodic box in Mpc/h                           [default: 1000]
  -s, --seeds N       number of seeds, at least 2                                 [default: 20]
  -f, --fnl F         f_NL (local, CMB convention) of the non-Gaussian half       [default: 100]
  -t, --threads N     worker threads; the results do not depend on it             [default: all cores]
  -o, --output FOLDER where tables and figures go, made if missing                [default: goliat-output]
  -h, --help          print this and stop
";

/// A checked choice of everything that the program lets a person choose.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Arguments {
    /// Cells a side.
    pub(crate) size: usize,
    /// Side of the box, Mpc/h.
    pub(crate) length: f64,
    /// Number of seeds.
    pub(crate) seeds: usize,
    /// f_NL of the non-Gaussian variants.
    pub(crate) fnl: f64,
    /// Worker threads.
    pub(crate) threads: usize,
    /// Folder for tables and figures.
    pub(crate) output: PathBuf,
}

impl Default for Arguments {
    fn default() -> Self {
        Self {
            size: 96,
            length: 1000.0,
            seeds: 20,
            fnl: 100.0,
            threads: std::thread::available_parallelism().map_or(1, std::num::NonZero::get),
            output: PathBuf::from("goliat-output"),
        }
    }
}

/// What the command line asks for.
#[derive(Debug, PartialEq)]
pub(crate) enum Request {
    Help,
    Run(Arguments),
}

/// Reads and checks the command line.
///
/// # Errors
/// A sentence that names the option and what it must be.
pub(crate) fn parse(mut parser: lexopt::Parser) -> Result<Request, Failure> {
    let mut arguments = Arguments::default();
    while let Some(argument) = parser.next()? {
        match argument {
            Short('n') | Long("size") => arguments.size = parser.value()?.parse()?,
            Short('L') | Long("box") => arguments.length = parser.value()?.parse()?,
            Short('s') | Long("seeds") => arguments.seeds = parser.value()?.parse()?,
            Short('f') | Long("fnl") => arguments.fnl = parser.value()?.parse()?,
            Short('t') | Long("threads") => arguments.threads = parser.value()?.parse()?,
            Short('o') | Long("output") => arguments.output = parser.value()?.into(),
            Short('h') | Long("help") => return Ok(Request::Help),
            _ => return Err(argument.unexpected().into()),
        }
    }
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
            (self.length.is_finite() && self.length > 0.0, "--box must be a positive length in Mpc/h"),
            (self.seeds >= 2, "--seeds must be at least 2: one seed has no scatter"),
            (
                self.fnl.is_finite() && self.fnl != 0.0,
                "--fnl must be a number other than 0: f_NL = 0 is always made",
            ),
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
    fn no_options_give_the_defaults_and_options_replace_them() {
        assert_eq!(read("").unwrap(), Request::Run(Arguments::default()));
        let wanted = Arguments { size: 64, fnl: -30.0, output: PathBuf::from("x"), ..Arguments::default() };
        assert_eq!(read("--size 64 --fnl=-30 -o x").unwrap(), Request::Run(wanted));
        assert_eq!(read("--size 3 --help").unwrap(), Request::Help);
    }

    #[test]
    fn impossible_choices_are_named() {
        for (line, option) in [
            ("--size 66", "--size"),
            ("--size 45", "--size"),
            ("--size 0", "--size"),
            ("--box -1", "--box"),
            ("--box nan", "--box"),
            ("--seeds 1", "--seeds"),
            ("--fnl 0", "--fnl"),
            ("--threads 0", "--threads"),
            ("--colour", "--colour"),
        ] {
            let message = read(line).unwrap_err().to_string();
            assert!(message.contains(option), "{line}: {message}");
        }
    }
}
