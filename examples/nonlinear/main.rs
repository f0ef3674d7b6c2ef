//! Particle-mesh runs of the library held against the outside: HMcode's P(k), and mass functions of halos.
//!
//! `cargo run --release --example nonlinear` evolves fixed pairs (a field and its negative, with the moduli of linear theory) of 2LPT
//! particles with FastPM steps, and takes the mean of a pair: most of the variance of a box is gone (Angulo & Pontzen 2016, arXiv:1603.05253).
//!
//! Two boxes, because a mesh resolves a fixed number of particles and not a length. P(k) at k = 0.25 h/Mpc to 4% needs modes: 512 Mpc/h with
//! 256^3 particles and cells of 1 Mpc/h, where a pair scatters by about 1%. A halo of 100 particles has a radius of half their mean
//! separation, one cell of a mesh of factor 2, in every box; but in 256 Mpc/h it weighs 7.5e12 Msun/h, where halos are many
//! and their number falls slowly with mass, so that mass that the soft force misses costs fewer of them.
//!
//! Between particles two cells apart a mesh has room for one more wave: the first images of the particles' lattice lie at the mesh's Nyquist
//! wavenumber. With the cloud-in-cell window and the exact gradient they push the particles, and small waves grow too much: P is 4% too high
//! at k = 0.08 h/Mpc and 10 to 15% at 0.5, and more for an earlier start. Differences of two or four points vanish there. So the default is the
//! four-point gradient; with it a mesh of factor 3 changes P by less than 0.4% for k < 0.25.
//!
//! The data walks one way: arguments -> theory -> run -> (spectrum, halos) -> measure -> report and figures.

mod arguments;
#[path = "../goliat/axes.rs"]
#[allow(dead_code, reason = "some kinds of axes are for other programs")]
mod axes;
#[path = "../common/boltzmann.rs"]
#[allow(dead_code, reason = "the readers of files are for other programs")]
mod boltzmann;
#[path = "../goliat/drawing.rs"]
#[allow(dead_code, reason = "some shapes are for other programs")]
mod drawing;
mod figures;
mod halos;
mod mass_function;
mod measure;
#[path = "../common/memory.rs"]
mod memory;
mod report;
mod run;
mod spectrum;
#[path = "../goliat/text.rs"]
mod text;
mod theory;
#[path = "../common/transform.rs"]
mod transform;

use std::io::Write as _;
use std::process::ExitCode;
use std::time::Duration;

use fixpair::exec::Threads;
use indicatif::{ProgressBar, ProgressStyle};

use arguments::{Arguments, Request};
use theory::Theory;

/// Whatever stops the program; it is shown to a person.
pub(crate) type Failure = Box<dyn std::error::Error + Send + Sync>;

fn main() -> ExitCode {
    match arguments::parse(lexopt::Parser::from_env()).and_then(answer) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            eprintln!("nonlinear: {failure}");
            ExitCode::FAILURE
        }
    }
}

fn answer(request: Request) -> Result<(), Failure> {
    match request {
        Request::Help => say(arguments::HELP),
        Request::Run(arguments) => run(&arguments),
    }
}

fn run(arguments: &Arguments) -> Result<(), Failure> {
    let output = arguments.output.as_path();
    let unwritable = |error| format!("cannot write to {}: {error}", output.display());
    // Before the work, so that a wrong folder costs nobody a minute.
    std::fs::create_dir_all(output).map_err(unwritable)?;

    let exec = Threads::new(arguments.threads)?;
    let theory = Theory::new()?;
    let style = ProgressStyle::with_template("{msg:>18} {wide_bar} {pos}/{len} {elapsed} (left: {eta})")?;
    let progress = ProgressBar::new((measure::runs(arguments) * arguments.steps) as u64).with_style(style);
    progress.set_message("steps");
    progress.enable_steady_tick(Duration::from_millis(200));
    let results = measure::all(arguments, &theory, &exec, &|| progress.inc(1))?;
    progress.finish();

    for (name, content) in report::tables(&results) {
        std::fs::write(output.join(name), content).map_err(unwritable)?;
    }
    for (name, drawing) in figures::all(&results) {
        std::fs::write(output.join(name).with_extension("svg"), drawing.svg()?).map_err(unwritable)?;
        std::fs::write(output.join(name).with_extension("png"), drawing.png()?).map_err(unwritable)?;
    }
    let claims = report::claims(&results);
    let text = report::text(arguments, &results, &claims);
    say(&format!("{text}\nFigures (PNG and SVG) and tables (CSV) are in {}\n", output.display()))?;
    let broken = claims.iter().filter(|claim| !claim.holds).count();
    if broken > 0 {
        return Err(format!("{broken} of {} claims do not hold", claims.len()).into());
    }
    Ok(())
}

/// Unlike `print!`, does not panic where the reader has gone.
fn say(text: &str) -> Result<(), Failure> {
    Ok(std::io::stdout().write_all(text.as_bytes())?)
}
