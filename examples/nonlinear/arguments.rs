//! The command line: what can be chosen, and what each choice must satisfy.

use std::path::PathBuf;

use fixpair::pm::{Difference, ForceLaw, Window};
use lexopt::prelude::*;

use crate::Failure;

/// Printed by `--help`.
pub(crate) const HELP: &str = "\
nonlinear: particle-mesh runs of the library against HMcode and mass functions of halos

Evolves fixed pairs of 2LPT initial conditions from z = 32 in two boxes of the cosmology of the GOLIAT simulations.
The larger gives P(k) at z = 1 and 0, compared with HMcode; the smaller halos, compared with the mass functions of
Watson et al. (friends of friends) and Tinker et al. (spheres). Writes tables (CSV) and figures (PNG, SVG).
Fails if a claim does not hold.

Usage: cargo run --release --example nonlinear -- [options]

  -n, --particles N     particles a side: even, no prime factor above 7    [default: 256]
  -B, --mesh-factor B   cells a side for each particle: 1, 1.5, 2, 3       [default: 2]
  -L, --box LENGTH      box for P(k), Mpc/h; 0 for none                    [default: 512]
      --halo-box LENGTH box for halos, Mpc/h; 0 for none                   [default: 256]
      --steps N         steps of equal da from z = 32 to 0                 [default: 20]
  -s, --seeds N         pairs                                              [default: 1]
      --first-seed N    seed of the first pair                             [default: 1]
  -w, --window NAME     cic, tsc or pcs                                    [default: cic]
      --gradient NAME   exact, 2 or 4 (points)                             [default: 4]
      --laplacian NAME  exact, 2 or 4 (points)                             [default: exact]
      --deconvolve P    power of the window that is divided out of forces  [default: 0]
  -t, --threads N       threads; the results do not depend on it           [default: all cores]
  -o, --output FOLDER   where tables and figures go, made if missing       [default: nonlinear-output]
  -h, --help            print this and stop
";

/// A checked choice of everything that the program lets a person choose.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Arguments {
    /// Particles a side.
    pub(crate) particles: usize,
    /// Cells a side of the mesh of forces.
    pub(crate) mesh_factor: f64,
    /// Side of the box for P(k), Mpc/h.
    pub(crate) length: f64,
    /// Side of the box for halos, Mpc/h.
    pub(crate) halo_length: f64,
    /// Steps from the start to today.
    pub(crate) steps: usize,
    /// Pairs.
    pub(crate) seeds: u64,
    /// Seed of the first.
    pub(crate) first_seed: u64,
    /// Of deposit and read-out.
    pub(crate) window: Window,
    /// From density to force.
    pub(crate) law: ForceLaw,
    /// Threads.
    pub(crate) threads: usize,
    /// Folder for tables and figures.
    pub(crate) output: PathBuf,
}

impl Default for Arguments {
    fn default() -> Self {
        Self {
            particles: 256,
            mesh_factor: 2.0,
            length: 512.0,
            halo_length: 256.0,
            steps: 20,
            seeds: 1,
            first_seed: 1,
            window: Window::CloudInCell,
            law: ForceLaw::FOUR_POINT,
            threads: std::thread::available_parallelism().map_or(1, std::num::NonZero::get),
            output: PathBuf::from("nonlinear-output"),
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
    let mut power = 0;
    while let Some(argument) = parser.next()? {
        match argument {
            Short('n') | Long("particles") => arguments.particles = parser.value()?.parse()?,
            Short('B') | Long("mesh-factor") => arguments.mesh_factor = parser.value()?.parse()?,
            Short('L') | Long("box") => arguments.length = parser.value()?.parse()?,
            Long("halo-box") => arguments.halo_length = parser.value()?.parse()?,
            Long("steps") => arguments.steps = parser.value()?.parse()?,
            Short('s') | Long("seeds") => arguments.seeds = parser.value()?.parse()?,
            Long("first-seed") => arguments.first_seed = parser.value()?.parse()?,
            Short('w') | Long("window") => arguments.window = window(&parser.value()?.string()?)?,
            Long("gradient") => arguments.law.gradient = difference(&parser.value()?.string()?)?,
            Long("laplacian") => arguments.law.laplacian = difference(&parser.value()?.string()?)?,
            Long("deconvolve") => power = parser.value()?.parse()?,
            Short('t') | Long("threads") => arguments.threads = parser.value()?.parse()?,
            Short('o') | Long("output") => arguments.output = parser.value()?.into(),
            Short('h') | Long("help") => return Ok(Request::Help),
            _ => return Err(argument.unexpected().into()),
        }
    }
    arguments.law.window = (power > 0).then_some((arguments.window, power));
    arguments.check()?;
    Ok(Request::Run(arguments))
}

fn window(name: &str) -> Result<Window, Failure> {
    match name {
        "cic" => Ok(Window::CloudInCell),
        "tsc" => Ok(Window::TriangularShapedCloud),
        "pcs" => Ok(Window::PiecewiseCubicSpline),
        _ => Err("--window must be cic, tsc or pcs".into()),
    }
}

fn difference(name: &str) -> Result<Difference, Failure> {
    match name {
        "exact" => Ok(Difference::Exact),
        "2" => Ok(Difference::TwoPoint),
        "4" => Ok(Difference::FourPoint),
        _ => Err("--gradient and --laplacian must be exact, 2 or 4".into()),
    }
}

impl Arguments {
    /// Cells a side.
    pub(crate) fn mesh(&self) -> usize {
        (self.particles as f64 * self.mesh_factor).round() as usize
    }

    fn check(&self) -> Result<(), Failure> {
        let power = self.law.window.map_or(1, |(_, power)| power);
        let length = |length: f64| length.is_finite() && length >= 0.0;
        let demands = [
            (
                self.particles >= 32 && transformable(self.particles),
                "--particles must be even, at least 32, with no prime factor above 7",
            ),
            (
                (1.0..=4.0).contains(&self.mesh_factor) && transformable(self.mesh()),
                "--mesh-factor must be from 1 to 4 and make an even mesh with no prime factor above 7",
            ),
            (
                length(self.length) && length(self.halo_length),
                "--box and --halo-box must be lengths in Mpc/h",
            ),
            (self.length + self.halo_length > 0.0, "--box and --halo-box must not both be 0"),
            (self.steps >= 4, "--steps must be at least 4"),
            (self.seeds >= 1, "--seeds must be at least 1"),
            ((1..=4).contains(&power), "--deconvolve must be from 0 to 4"),
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
    size > 0 && size.is_multiple_of(2) && fixpair::fft::next_side(size) == Some(size)
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
        let law = ForceLaw {
            gradient: Difference::FourPoint,
            window: Some((Window::CloudInCell, 1)),
            ..ForceLaw::default()
        };
        let wanted = Arguments { particles: 128, law, window: Window::CloudInCell, ..Arguments::default() };
        let read_back = read("-n 128 --deconvolve 1 --gradient 4 --window cic").unwrap();
        assert_eq!(read_back, Request::Run(wanted));
        assert_eq!(read("--particles 3 --help").unwrap(), Request::Help);
    }

    #[test]
    fn impossible_choices_are_named() {
        for (line, option) in [
            ("--particles 66", "--particles"),
            ("--particles 16", "--particles"),
            ("--mesh-factor 0.5", "--mesh-factor"),
            ("--mesh-factor 1.03125", "--mesh-factor"),
            ("--box -1", "--box"),
            ("--box 0 --halo-box 0", "--box"),
            ("--steps 1", "--steps"),
            ("--seeds 0", "--seeds"),
            ("--window ngp", "--window"),
            ("--gradient 3", "--gradient"),
            ("--deconvolve 9", "--deconvolve"),
            ("--threads 0", "--threads"),
            ("--colour", "--colour"),
        ] {
            let message = read(line).unwrap_err().to_string();
            assert!(message.contains(option), "{line}: {message}");
        }
    }
}
