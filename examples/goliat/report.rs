//! What the suite says in words and numbers: the tables of a terminal.

use std::fmt::Write as _;
use std::ops::Range;
use std::time::Duration;

use fixpair::cosmology::Cosmology;

use crate::Failure;
use crate::bias_report;
use crate::fnl::Analysis;
use crate::late_report;
use crate::redshift_space::Multipoles;
use crate::statistics::{
    Kind, ROUNDING, band, correlation, deviation, differences, error_of_mean, estimates, mean,
    power_difference, quadratic_mean, ranges,
};
use crate::suite::{Amplitude, Half, Phase, Suite, Variant};
use crate::universe::{END, REDSHIFT};

/// Sigma and what it is worth, as text: a scatter that is only rounding is exact.
pub(crate) fn sigma_text(ratio: f64) -> String {
    match ratio {
        ratio if ratio < ROUNDING => String::from("exact"),
        ratio if ratio < 0.01 => format!("{ratio:.1e}"),
        ratio => format!("{ratio:.3}"),
    }
}

fn worth_text(ratio: f64) -> String {
    match ratio.powi(-2) {
        worth if worth.is_nan() => String::from("-"),
        _ if ratio < ROUNDING => String::from("inf"),
        worth if worth < 9.95 => format!("{worth:.1}"),
        worth if worth < 9_999.5 => format!("{worth:.0}"),
        worth => format!("{worth:.0e}"),
    }
}

fn rho_text(rho: Option<f64>) -> String {
    rho.map_or_else(|| String::from("-"), |rho| format!("{rho:.3}"))
}

/// One line of the table of P(k): a title, sigma in three ranges, and the sigma that counts as one simulation.
fn power_line(title: &str, sigma: [f64; 3], reference: [f64; 3], rho: &str) -> String {
    let mut line = format!("  {title:<32}");
    for sigma in sigma {
        let _ = write!(line, "{:>9}", sigma_text(sigma));
    }
    line.push_str("  ");
    for (sigma, reference) in sigma.into_iter().zip(reference) {
        let _ = write!(line, "{:>9}", worth_text(sigma / reference));
    }
    let _ = write!(line, "{rho:>9}");
    format!("{}\n", line.trim_end())
}

/// The table that a person reads.
///
/// # Errors
/// Of the kernels that say what is significant.
pub(crate) fn text(
    suite: &Suite,
    analysis: Result<&Analysis, &str>,
    threads: usize,
    elapsed: Duration,
) -> Result<String, Failure> {
    let configuration = &suite.configuration;
    let (size, length, fnl) = (configuration.size, configuration.length, configuration.fnl);
    let Cosmology { omega_m, omega_de, n_s, .. } = Cosmology::goliat();
    let mut text = format!(
        "\nGOLIAT in miniature: {seeds} seeds x {variants} variants of {size}^3 particles in ({length} Mpc/h)^3, \
         from z = {REDSHIFT} to z = {END}\n\
         Omega_m = {omega_m}, Omega_Lambda = {omega_de}, n_s = {n_s}, sigma_8 = 0.8; \
         f_NL = 0 and {fnl}; {time:.1} s on {threads} threads\n\n",
        seeds = suite.seeds.len(),
        variants = Variant::COUNT,
        time = elapsed.as_secs_f64(),
    );
    power_table(&mut text, suite);
    squeezed_table(&mut text, suite);
    multipole_table(&mut text, suite);
    late_report::write(&mut text, suite);
    bias_report::write(&mut text, suite, analysis)?;
    Ok(text)
}

fn power_table(text: &mut String, suite: &Suite) {
    let fnl = suite.configuration.fnl;
    let bins = suite.bins();
    let ranges = ranges(&bins.k);
    let in_ranges = |ratio: &[f64]| ranges.clone().map(|range| quadratic_mean(&ratio[range]));
    text.push_str(
        "Initial conditions, power spectrum: scatter from seed to seed, per simulation, in units of sigma_th = sqrt(2/N_k) P,\n\
         and the number of Normal simulations that one simulation is worth\n",
    );
    let _ = writeln!(text, "  {:<32}{:>27}  {:>27}", "", "sigma / sigma_th  ", "worth  ");
    let mut header = format!("  {:<32}", "k [h/Mpc] up to");
    for block in ["", "  "] {
        header.push_str(block);
        for range in &ranges {
            let edge = bins.k.get(range.end.max(1) - 1).copied().unwrap_or(0.0);
            let _ = write!(header, "{edge:>9.3}");
        }
    }
    let _ = writeln!(text, "{header}{:>9}", "rho");
    for half in [Half::Gaussian, Half::Local] {
        let reference = in_ranges(&band(suite, Kind::Normal, half).ratio);
        for kind in Kind::ALL {
            let title = format!("f_NL = {:<6} {}", suite.configuration.fnl_of(half), kind.name());
            text.push_str(&power_line(&title, in_ranges(&band(suite, kind, half).ratio), reference, ""));
        }
    }
    let _ = writeln!(text, "  P(f_NL = {fnl}) - P(f_NL = 0), where one \"simulation\" is one of each f_NL:");
    let unmatched = in_ranges(&power_difference(suite, Kind::Normal, false).ratio);
    text.push_str(&power_line("Normal, different seeds", unmatched, unmatched, ""));
    for kind in Kind::ALL {
        let difference = power_difference(suite, kind, true);
        let rho: Option<Vec<f64>> = difference.correlation.into_iter().collect();
        let rho = rho_text(rho.map(|rho| mean(&rho)));
        let title = format!("{}, Matched", kind.name());
        text.push_str(&power_line(&title, in_ranges(&difference.ratio), unmatched, &rho));
    }
}

/// A row of the table of the squeezed signal: mean with its error, and scatter per simulation.
struct Squeezed {
    title: String,
    mean: f64,
    error: f64,
    sigma: f64,
    /// sigma over that of the reference.
    relative: f64,
    rho: Option<f64>,
}

fn squeezed_rows(suite: &Suite) -> Vec<Squeezed> {
    let read = |kind, half| estimates(suite, kind, half, |one| one.early.fnl);
    let row = |title, kind: Kind, values: &[f64], reference: f64, rho| Squeezed {
        title,
        mean: mean(values),
        error: error_of_mean(values),
        sigma: kind.sigma(values),
        relative: kind.sigma(values) / reference,
        rho,
    };
    let mut rows = Vec::new();
    for half in [Half::Gaussian, Half::Local] {
        let reference = deviation(&read(Kind::Normal, half));
        for kind in Kind::ALL {
            let title = format!("f_NL = {:<6} {}", suite.configuration.fnl_of(half), kind.name());
            rows.push(row(title, kind, &read(kind, half), reference, None));
        }
    }
    let halves = |kind| (read(kind, Half::Local), read(kind, Half::Gaussian));
    let (local, gaussian) = halves(Kind::Normal);
    let unmatched = differences(&local, &gaussian, false);
    let reference = deviation(&unmatched);
    rows.push(row(String::from("difference, different seeds"), Kind::Normal, &unmatched, reference, None));
    for kind in Kind::ALL {
        let (local, gaussian) = halves(kind);
        let title = format!("difference, {}, Matched", kind.name());
        let rho = correlation(&local, &gaussian);
        rows.push(row(title, kind, &differences(&local, &gaussian, true), reference, rho));
    }
    rows
}

fn squeezed_table(text: &mut String, suite: &Suite) {
    text.push_str(
        "\nInitial conditions, bispectrum: f_NL from all triangles of each field; mean with its error, scatter per simulation\n",
    );
    let _ =
        writeln!(text, "  {:<39}{:>9} {:>11}{:>12}{:>9}{:>9}", "", "mean", "error", "sigma", "worth", "rho");
    for row in squeezed_rows(suite) {
        let _ = writeln!(
            text,
            "  {:<39}{:>9.2} +/-{:>8.2}{:>12.3}{:>9}{}",
            row.title,
            row.mean,
            row.error,
            row.sigma,
            worth_text(row.relative),
            row.rho.map_or_else(String::new, |rho| format!("{rho:>9.3}")),
        );
    }
}

/// P_2 and P_4 over P_0 of the particles of the first seed: mean over the modes of each range.
fn multipole_table(text: &mut String, suite: &Suite) {
    let bins = suite.bins();
    let ranges = ranges(&bins.k);
    text.push_str(
        "\nInitial conditions, redshift space: multipoles of the 2LPT particles of the first seed about the z axis, mean over modes\n",
    );
    let _ = writeln!(text, "  {:<32}{:>27}  {:>27}", "", "P_2 / P_0", "P_4 / P_0");
    let mut line = |title: &str, value: &dyn Fn(usize, &Range<usize>) -> f64| {
        let _ = write!(text, "  {title:<32}");
        for (l, end) in [(1, "  "), (2, "\n")] {
            for range in &ranges {
                let _ = write!(text, "{:>9.3}", value(l, range));
            }
            text.push_str(end);
        }
    };
    line("k [h/Mpc] up to", &|_, range| bins.k.get(range.end.max(1) - 1).copied().unwrap_or(0.0));
    let mut ratios = |title: &str, multipoles: &Multipoles| {
        line(title, &|l, range| {
            let modes = |i: usize| bins.modes[i] as f64;
            let sum: f64 = range.clone().map(|i| modes(i) * multipoles[l][i] / multipoles[0][i]).sum();
            sum / range.clone().map(modes).sum::<f64>()
        });
    };
    for half in [Half::Gaussian, Half::Local] {
        for (amplitude, name) in [(Amplitude::Normal, "Normal"), (Amplitude::Fixed, "Fixed")] {
            let variant = Variant { amplitude, phase: Phase::Original, half };
            if let Some(multipoles) = &suite.get(0, variant).early.multipoles {
                ratios(&format!("f_NL = {:<6} {name}", suite.configuration.fnl_of(half)), multipoles);
            }
        }
    }
    ratios("Kaiser 1987, on the same modes", &suite.configuration.linear_multipoles);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_scatter_of_rounding_is_exact_and_a_half_is_worth_four() {
        assert_eq!([sigma_text(1e-12), worth_text(1e-12)], ["exact", "inf"]);
        assert_eq!([sigma_text(0.5), worth_text(0.5)], ["0.500", "4.0"]);
        assert_eq!([sigma_text(0.001), worth_text(0.001)], ["1.0e-3", "1e6"]);
    }
}
