//! What Fix, Pair and Match do to the scatter of initial conditions with local primordial non-Gaussianity.
//!
//! `cargo run --release --example goliat` makes N seeds x 8 variants of the GOLIAT-PNG suite (Avila & Adame 2022,
//! arXiv:2204.11103) in miniature, from initial conditions at z = 32 to halos at z = 1, and writes tables and figures.
//! What it measures: at z = 32 P(k), the bispectrum and f_NL from it, and of the first seed's particles the multipoles in redshift space; at
//! z = 1 P(k) and squeezed bispectra of halos and matter. What it fits: bias and f_NL to the spectra of halos.
//! The data walks one way: arguments -> suite (measure: start -> evolution -> late; store) -> statistics, fnl (sigma, bias) -> significance -> report and
//! figures.

mod arguments;
mod axes;
mod bias;
mod bias_csv;
mod bias_report;
mod bispectrum;
#[path = "../common/boltzmann.rs"]
#[allow(dead_code, reason = "the readers of files are for other programs")]
mod boltzmann;
mod csv;
mod density;
mod drawing;
mod evolution;
mod figures;
mod fnl;
mod late;
mod late_report;
mod late_statistics;
mod measure;
mod measurement;
#[path = "../common/memory.rs"]
mod memory;
mod presets;
mod redshift_space;
mod report;
mod sigma;
mod significance;
mod start;
mod statistics;
mod store;
mod suite;
mod text;
#[path = "../common/transform.rs"]
mod transform;
mod universe;

use std::io::Write as _;
use std::process::ExitCode;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};

use arguments::{Arguments, Request};
use fnl::Analysis;
use suite::{Suite, Variant, Watch};

/// Whatever stops the program; it is shown to a person.
pub(crate) type Failure = Box<dyn std::error::Error + Send + Sync>;

fn main() -> ExitCode {
    match arguments::parse(lexopt::Parser::from_env()).and_then(answer) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            eprintln!("goliat: {failure}");
            ExitCode::FAILURE
        }
    }
}

fn answer(request: Request) -> Result<(), Failure> {
    match request {
        Request::Help => say(&arguments::help())?,
        Request::Run(arguments) => run(&arguments)?,
    }
    Ok(())
}

fn run(arguments: &Arguments) -> Result<(), Failure> {
    let output = arguments.output.as_path();
    let unwritable = |error| format!("cannot write to {}: {error}", output.display());
    // Before the work, so that a wrong folder costs nobody a minute.
    std::fs::create_dir_all(output).map_err(unwritable)?;

    let start = Instant::now();
    let universes = arguments.seeds * Variant::COUNT;
    let progress = bar("steps of universes", universes * Suite::steps_of_one(arguments))?;
    let suite = Suite::run(
        arguments,
        &Watch {
            advance: &|steps| progress.inc(steps as u64),
            say: &|line| progress.suspend(|| eprintln!("goliat: {line}")),
        },
    )?;
    progress.finish();
    let elapsed = start.elapsed();

    let analysis = Analysis::new(&suite);
    let analysis = analysis.as_ref().map_err(String::as_str);
    let mut tables = Vec::from(csv::tables(&suite));
    if let Ok(analysis) = analysis {
        tables.extend(bias_csv::tables(&suite, analysis)?);
    }
    for (name, content) in tables {
        std::fs::write(output.join(name), content).map_err(unwritable)?;
    }
    let pictures = figures::all(&suite, analysis.ok())?;
    let progress = bar("figures", pictures.len())?;
    for (name, drawing) in &pictures {
        std::fs::write(output.join(name).with_extension("svg"), drawing.svg()?).map_err(unwritable)?;
        std::fs::write(output.join(name).with_extension("png"), drawing.png()?).map_err(unwritable)?;
        progress.inc(1);
    }
    progress.finish();

    let names: Vec<_> = pictures.iter().map(|(name, _)| *name).collect();
    let table = report::text(&suite, analysis, arguments.threads, elapsed)?;
    let (names, folder) = (names.join(", "), output.display());
    say(&format!("{table}\nFigures ({names}; PNG and SVG) and tables (CSV) are in {folder}\n"))
}

/// Unlike `print!`, does not panic where the reader has gone.
fn say(text: &str) -> Result<(), Failure> {
    Ok(std::io::stdout().write_all(text.as_bytes())?)
}

/// A bar on the terminal's error stream; silent where that is not a terminal.
fn bar(name: &'static str, length: usize) -> Result<ProgressBar, Failure> {
    let style = ProgressStyle::with_template("{msg:>18} {wide_bar} {pos}/{len} {elapsed} (left: {eta})")?;
    let progress = ProgressBar::new(length as u64).with_style(style).with_message(name);
    progress.enable_steady_tick(Duration::from_millis(200));
    Ok(progress)
}
