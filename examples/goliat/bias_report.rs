//! What the suite says about bias and f_NL: the paper's Tables 1 and 3, and what is significant.

use std::fmt::Write as _;

use fixpair::status::Result;
use fixpair::variance::control::{Beta, ControlVariate, control_variate};
use fixpair::variance::matched::{difference_sigma, effective_volume};
use fixpair::variance::pairs::relative_error_of_deviation;
use fixpair::variance::posterior::Posterior;
use fixpair::variance::suppression::SuppressionFit;

use crate::Failure;
use crate::bias::{Case, Fit};
use crate::fnl::{Analysis, HALVES, Row};
use crate::sigma::{Model, REACH};
use crate::significance::{Claim, ENOUGH, LEAST_SEEDS, claims};
use crate::statistics::{Kind, deviation, mean};
use crate::suite::Suite;

/// Writes the tables, or the sentence on why there are none.
///
/// # Errors
/// Of the kernels.
pub(crate) fn write(
    text: &mut String,
    suite: &Suite,
    analysis: std::result::Result<&Analysis, &str>,
) -> std::result::Result<(), Failure> {
    let analysis = match analysis {
        Ok(analysis) => analysis,
        Err(why) => {
            let _ = writeln!(text, "\nBias and f_NL of halos at z = 1: nothing is fitted, since\n{why}");
            return Ok(());
        }
    };
    scatter_table(text, suite, analysis);
    mean_table(text, suite, analysis);
    fnl_table(text, suite, analysis);
    matched_table(text, suite, analysis)?;
    statement(text, suite, &claims(analysis, suite.configuration.fnl)?);
    Ok(())
}

/// "value +/- error" with so many decimals.
fn measured(value: f64, error: f64, decimals: usize) -> String {
    format!("{value:.decimals$} +/-{error:>6.decimals$}")
}

fn region(posterior: Option<&Posterior>, decimals: usize) -> String {
    posterior.map_or_else(dash, |of| measured(of.centre, of.half_width, decimals))
}

fn dash() -> String {
    String::from("-")
}

/// Mean and standard deviation; of fewer than two values none.
fn moments(values: &[f64], decimals: usize) -> String {
    if values.len() < 2 { dash() } else { measured(mean(values), deviation(values), decimals) }
}

fn volume_text(volume: Option<f64>) -> String {
    match volume {
        None => dash(),
        Some(volume) if volume < 9.95 => format!("{volume:.1}"),
        Some(volume) => format!("{volume:.0}"),
    }
}

/// V_eff/V of one simulation of a row against one Normal simulation.
fn volume(reference: Option<f64>, sigma: Option<f64>, kind: Kind) -> Option<f64> {
    effective_volume(reference?, 1, sigma?, kind.simulations()).ok()
}

fn scatter_table(text: &mut String, suite: &Suite, analysis: &Analysis) {
    let _ = write!(
        text,
        "\nScatter of P of halos: Eq. sigma_fix fitted to k < {REACH} h/Mpc; R_cv is what is left of cosmic variance at small k\n  {:<30}{:>18}{:>18}{:>18}{:>10} / degrees\n",
        "", "R_cv", "k_soft [h/Mpc]", "f_sn", "chi^2"
    );
    for (half, place) in HALVES.into_iter().zip(0..) {
        for row in &analysis.rows {
            let title = format!("f_NL = {:<6} {}", suite.configuration.fnl_of(half), row.kind.name());
            let line = match &row.halves[place].scatter.model {
                Model::Gaussian => format!("{:>18}", "sigma_th"),
                Model::Suppressed(SuppressionFit { value, error, chi_squared, degrees, .. }) => format!(
                    "{:>18}{:>18}{:>18}{chi_squared:>10.1} / {degrees}",
                    measured(value.cosmic_variance, error.cosmic_variance, 3),
                    measured(value.softening, error.softening, 3),
                    measured(value.shot_noise, error.shot_noise, 3),
                ),
                Model::Scaled { ratio, why } => {
                    format!("{:>18}   measured below k_max; no fit: {why}", format!("{ratio:.3} sigma_th"))
                }
            };
            let _ = writeln!(text, "  {title:<30}{line}");
        }
    }
}

fn mean_table(text: &mut String, suite: &Suite, analysis: &Analysis) {
    let fnl = suite.configuration.fnl;
    let _ = write!(
        text,
        "\nPosteriors on the mean of {} halo spectra of each amplitude, k <= {} h/Mpc ({} bins), with the error of one simulation: 68% regions\n  \
         {:<14}{:>18}{:>37}{:>37}{:>37}\n  {:<14}{:>18}",
        2 * suite.seeds.len(),
        suite.configuration.k_max,
        analysis.bins,
        "",
        "f_NL = 0",
        format!("f_NL = {fnl}: (i) p = 1"),
        format!("(ii) f_NL = {fnl}"),
        "(iii) p = 1",
        "",
        "b_g"
    );
    for [first, second] in [["b_g", "chi^2"], ["b_g", "p"], ["b_g", "f_NL"]] {
        let _ = write!(text, "{first:>19}{second:>18}");
    }
    text.push('\n');
    for row in &analysis.rows {
        let [gaussian, local] = [0, 1].map(|half| &row.halves[half].mean);
        let fit = |case: Case| local[case as usize].as_ref();
        let b_g = |fit: Option<&Fit>| region(fit.map(Fit::b_g), 3);
        let chi_squared = fit(Case::Bias).map_or_else(dash, |fit| {
            let fit = &fit.constraints.fit;
            format!("{:.2} / {}", fit.chi_squared, fit.degrees)
        });
        let _ = writeln!(
            text,
            "  {:<14}{:>18}{:>19}{:>18}{:>19}{:>18}{:>19}{:>18}",
            row.kind.name(),
            b_g(gaussian[Case::Bias as usize].as_ref()),
            b_g(fit(Case::Bias)),
            chi_squared,
            b_g(fit(Case::Universality)),
            region(fit(Case::Universality).map(Fit::second), 2),
            b_g(fit(Case::Fnl)),
            region(fit(Case::Fnl).map(Fit::second), 1),
        );
    }
}

/// Of the scatter of a list, if it has any.
fn scatter(values: &[f64]) -> Option<f64> {
    (values.len() >= 2).then(|| deviation(values)).filter(|&deviation| deviation > 0.0)
}

fn fnl_table(text: &mut String, suite: &Suite, analysis: &Analysis) {
    let fnl = suite.configuration.fnl;
    let _ = write!(
        text,
        "\nf_NL of halos at z = 1, p = 1: mean and scatter of the fits of each simulation or pair, and the posterior of the mean with the error of one\n  \
         {:<14}{:>36}{:>36}\n  {:<14}{:>18}{:>18}{:>18}{:>18}{:>14}\n",
        "",
        "f_NL = 0",
        format!("f_NL = {fnl}"),
        "",
        "each",
        "of the mean",
        "each",
        "of the mean",
        "V_eff/V"
    );
    let normal = analysis.row(Kind::Normal);
    let reference = [scatter(&normal.fnl[1]), normal.half_width(1)];
    for row in &analysis.rows {
        let [gaussian, local] = [0, 1].map(|half| {
            let posterior = row.halves[half].one.as_ref().map(Fit::second);
            [moments(&row.fnl[half], 1), region(posterior, 1)]
        });
        let sigmas = [scatter(&row.fnl[1]), row.half_width(1)];
        let [by_each, by_mean] = [0, 1].map(|i| volume_text(volume(reference[i], sigmas[i], row.kind)));
        let _ = writeln!(
            text,
            "  {:<14}{:>18}{:>18}{:>18}{:>18}{:>14}",
            row.kind.name(),
            gaussian[0],
            gaussian[1],
            local[0],
            local[1],
            format!("{by_each} [{by_mean}]"),
        );
        if row.kind.simulations() == 2 {
            let _ = write!(text, "  {:<14}", "  x sqrt 2");
            for half in [0, 1] {
                for sigma in [scatter(&row.fnl[half]), row.half_width(half)] {
                    let sigma = sigma.map_or_else(dash, |sigma| format!("+/-{:>6.1}", 2f64.sqrt() * sigma));
                    let _ = write!(text, "{sigma:>18}");
                }
            }
            text.push('\n');
        }
    }
    let open = |row: &Row| row.open().iter().sum::<usize>();
    let total: usize = analysis.rows.iter().map(open).sum();
    let fits = 8 * suite.seeds.len();
    if total == 0 {
        let _ = writeln!(text, "  All {fits} fits of one simulation or pair have a closed posterior.");
    } else {
        let each: Vec<_> =
            analysis.rows.iter().map(|row| format!("{} {}", row.kind.name(), open(row))).collect();
        let _ = writeln!(
            text,
            "  {total} of {fits} fits have no closed posterior ({}): their seeds are left out of both f_NL of their type.",
            each.join(", ")
        );
    }
}

/// f_NL with the matched half as a control variate.
pub(crate) fn controlled(row: &Row, beta: Beta) -> Option<ControlVariate> {
    control_variate(&row.fnl[1], &row.fnl[0], 0.0, 0.0, beta).ok()
}

/// Eq. correlation with the posteriors of the means, and the difference of their peaks.
pub(crate) fn gaussian_difference(row: &Row) -> Option<[f64; 2]> {
    let [gaussian, local] = [0, 1].map(|half| row.halves[half].one.as_ref().map(Fit::second));
    let (gaussian, local) = (gaussian?, local?);
    let sigma = difference_sigma(local.half_width, gaussian.half_width, row.matched?.correlation).ok()?;
    Some([local.peak - gaussian.peak, sigma])
}

fn matched_table(text: &mut String, suite: &Suite, analysis: &Analysis) -> Result<()> {
    let fnl = suite.configuration.fnl;
    let _ = write!(
        text,
        "\nMatched: f{fnl} - f0 of the same seeds, f{fnl} - beta f0 with beta of least scatter, and p of Eq. p; what f0 costs is not counted\n  \
         {:<14}{:>10}{:>18}{:>18}{:>12}{:>8}{:>18}{:>9}{:>16}{:>16}\n",
        "",
        "rho",
        "each",
        "Eq. correlation",
        "V_eff/V",
        "beta",
        "mean, its error",
        "V_eff/V",
        format!("p from f{fnl}"),
        format!("f{fnl} - f0")
    );
    let normal = analysis.row(Kind::Normal);
    let reference = [scatter(&normal.fnl[1]), normal.half_width(1)];
    for row in &analysis.rows {
        let gaussian = gaussian_difference(row);
        let rho = row
            .matched
            .map_or_else(dash, |of| format!("{:.3}({:.0})", of.correlation, 1e3 * of.correlation_error));
        let sigmas = [row.matched.map(|of| of.deviation), gaussian.map(|[_, sigma]| sigma)];
        let [by_each, by_mean] = [0, 1].map(|i| volume_text(volume(reference[i], sigmas[i], row.kind)));
        let best = controlled(row, Beta::Optimal);
        let _ = writeln!(
            text,
            "  {:<14}{:>10}{:>18}{:>18}{:>12}{:>8}{:>18}{:>9}{:>16}{:>16}",
            row.kind.name(),
            rho,
            moments(&row.differences(), 1),
            gaussian.map_or_else(dash, |[centre, sigma]| measured(centre, sigma, 1)),
            format!("{by_each} [{by_mean}]"),
            best.map_or_else(dash, |of| format!("{:.2}", of.beta)),
            best.map_or_else(dash, |of| measured(of.mean, of.error, 1)),
            volume_text(volume(reference[0], best.map(|of| of.deviation), row.kind)),
            moments(&row.p[0], 2),
            moments(&row.p[1], 2),
        );
        if row.kind.simulations() == 2 {
            let [first, second] = sigmas
                .map(|sigma| sigma.map_or_else(dash, |sigma| format!("+/-{:>6.1}", 2f64.sqrt() * sigma)));
            let _ = writeln!(text, "  {:<14}{:>10}{first:>18}{second:>18}", "  x sqrt 2", "");
        }
    }
    Ok(())
}

fn statement(text: &mut String, suite: &Suite, claims: &[Claim]) {
    let seeds = suite.seeds.len();
    let known = relative_error_of_deviation(seeds as u64).unwrap_or(f64::NAN);
    let _ = writeln!(
        text,
        "\nWhat is significant with {seeds} seeds, of which each sigma is known to {:.0}%: beyond {ENOUGH} sigma (by Student's t; of ratios in the logarithm) from what it would be otherwise",
        100.0 * known
    );
    if seeds < LEAST_SEEDS {
        let _ = writeln!(text, "  Of scatter nothing: it takes {LEAST_SEEDS} seeds and more.");
    }
    for claim in claims {
        let Claim { name, estimate, nothing, sigmas, .. } = claim;
        let decimals = if estimate.error < 5.0 { 2 } else { 1 };
        let _ = writeln!(
            text,
            "  {name:<76}{:>18}{:>22}   {}",
            measured(estimate.value, estimate.error, decimals),
            format!("{:.1} sigma from {nothing}", sigmas.abs()),
            if claim.is_significant() { "significant" } else { "not significant" },
        );
    }
    if claims.iter().any(|claim| claim.name.starts_with("<f0>") && claim.is_significant()) {
        text.push_str(
            "  Where <f0> is not 0, b(k) is not the model's below k_max even without f_NL. What is fitted to f_NL alone, and p of it, inherits that;\n  \
             the matched difference does not.\n",
        );
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fnl::tests::suite;

    fn text(suite: &Suite) -> String {
        let (mut text, analysis) = (String::new(), Analysis::new(suite));
        write(&mut text, suite, analysis.as_ref().map_err(String::as_str)).unwrap();
        text
    }

    #[test]
    fn the_tables_have_a_line_for_each_type_and_no_number_that_is_none() {
        let text = text(&suite(12, 0.3, 1.0));
        assert_eq!(text.matches("  x sqrt 2").count(), 4);
        assert_eq!(text.matches("\n  Fixed-Paired ").count(), 3);
        assert!(text.contains("All 96 fits") && text.contains("significant"), "{text}");
        assert!(!text.contains("NaN") && !text.contains("inf"), "{text}");
    }

    #[test]
    fn open_fits_and_few_seeds_are_said_to_be_so() {
        let noisy = text(&suite(12, 1.0, 6.0));
        assert!(noisy.contains("have no closed posterior"), "{noisy}");
        let few = text(&suite(2, 0.3, 1.0));
        assert!(few.contains("Of scatter nothing") && !few.contains("NaN"), "{few}");
        assert!(text(&suite(2, 0.0, 1.0)).contains("nothing is fitted"));
    }
}
