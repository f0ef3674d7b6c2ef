//! Fits of bias and f_NL, as CSV.

use std::fmt::Write as _;

use fixpair::status::Result;
use fixpair::variance::control::Beta;

use crate::bias::{Case, Fit};
use crate::bias_report::{controlled, gaussian_difference};
use crate::fnl::{Analysis, HALVES, Row};
use crate::sigma::Model;
use crate::significance::claims;
use crate::statistics::{deviation, mean};
use crate::suite::Suite;

/// Name and content of each file.
///
/// # Errors
/// Of the kernels.
pub(crate) fn tables(suite: &Suite, analysis: &Analysis) -> Result<[(&'static str, String); 5]> {
    Ok([
        ("fnl.csv", each_csv(suite, analysis)),
        ("fnl_summary.csv", summary_csv(suite, analysis)),
        ("posteriors.csv", posteriors_csv(suite, analysis)?),
        ("suppression.csv", suppression_csv(suite, analysis)),
        ("claims.csv", claims_csv(suite, analysis)?),
    ])
}

/// Each row with each half.
fn halves<'a>(suite: &Suite, analysis: &'a Analysis) -> impl Iterator<Item = (&'a Row, usize, f64)> {
    let fnl = HALVES.map(|half| suite.configuration.fnl_of(half));
    analysis.rows.iter().flat_map(move |row| [0, 1].map(|half| (row, half, fnl[half])))
}

fn each_csv(suite: &Suite, analysis: &Analysis) -> String {
    let mut csv = String::from(
        "seed,type,f_NL,closed,f_NL measured,half width,low,high,b_g,half width,low,high,least chi^2,degrees\n",
    );
    for (row, half, fnl) in halves(suite, analysis) {
        for (seed, each) in suite.seeds.iter().zip(&row.halves[half].each) {
            let _ = write!(csv, "{seed},{},{fnl},{}", row.kind.name(), each.is_some());
            match each {
                None => csv.push_str(",,,,,,,,,,\n"),
                Some(each) => {
                    for of in [&each.fnl, &each.b_g] {
                        let _ = write!(csv, ",{},{},{},{}", of.peak, of.half_width, of.low, of.high);
                    }
                    let _ = writeln!(csv, ",{},{}", each.chi_squared, analysis.bins - 2);
                }
            }
        }
    }
    csv
}

/// The tables of the terminal, one number a line.
fn summary_csv(suite: &Suite, analysis: &Analysis) -> String {
    let mut csv =
        String::from("type,quantity,seeds,value,standard deviation or half width,error of the mean\n");
    let fnl = suite.configuration.fnl;
    let mut line = |row: &Row, quantity: &str, value: f64, width: f64, error: Option<f64>| {
        let error = error.map_or_else(String::new, |error| error.to_string());
        let _ = writeln!(csv, "{},{quantity},{},{value},{width},{error}", row.kind.name(), row.seeds.len());
    };
    for row in &analysis.rows {
        let lists = [
            (String::from("f0"), row.fnl[0].clone()),
            (format!("f{fnl}"), row.fnl[1].clone()),
            (format!("f{fnl} - f0"), row.differences()),
            (format!("p from f{fnl}"), row.p[0].clone()),
            (format!("p from f{fnl} - f0"), row.p[1].clone()),
        ];
        for (name, values) in lists.iter().filter(|(_, values)| values.len() >= 2) {
            let width = deviation(values);
            line(row, name, mean(values), width, Some(width / (values.len() as f64).sqrt()));
        }
        for (half, name) in [String::from("f0"), format!("f{fnl}")].iter().enumerate() {
            if let Some(of) = row.halves[half].one.as_ref().map(Fit::second) {
                line(row, &format!("{name}: posterior of the mean"), of.centre, of.half_width, None);
            }
        }
        if let Some([centre, sigma]) = gaussian_difference(row) {
            line(row, &format!("f{fnl} - f0 by Eq. correlation"), centre, sigma, None);
        }
        if let Some(of) = row.matched {
            line(row, "rho", of.correlation, of.correlation_error, None);
        }
        if let Some(of) = controlled(row, Beta::Optimal) {
            line(row, &format!("f{fnl} - beta f0"), of.mean, of.deviation, Some(of.error));
        }
    }
    csv
}

fn posteriors_csv(suite: &Suite, analysis: &Analysis) -> Result<String> {
    let mut csv = String::from("type,f_NL,error of,free,parameter,value,density\n");
    for (row, half, fnl) in halves(suite, analysis) {
        let of = &row.halves[half];
        let single = of.mean.iter().zip(Case::ALL).map(|(fit, case)| (fit.as_ref(), case, "one simulation"));
        let mut fits: Vec<_> = single.collect();
        if row.kind.simulations() == 2 {
            fits.push((of.one.as_ref(), Case::Fnl, "one pair"));
        }
        fits.push((of.all.as_ref(), Case::Universality, "the mean"));
        for (fit, case, error) in fits {
            let Some(fit) = fit else { continue };
            for (axis, parameter) in case.parameters().iter().enumerate() {
                let density = fit.density(axis)?;
                for (x, y) in density.x.iter().zip(&density.density) {
                    let (name, free) = (row.kind.name(), case.name());
                    let _ = writeln!(csv, "{name},{fnl},{error},{free},{parameter},{x},{y}");
                }
            }
        }
    }
    Ok(csv)
}

fn suppression_csv(suite: &Suite, analysis: &Analysis) -> String {
    let mut csv = String::from(
        "type,f_NL,model,R_cv,error,k_soft [h/Mpc],error,f_sn,error,chi^2,degrees,sigma/sigma_th where not fitted\n",
    );
    for (row, half, fnl) in halves(suite, analysis) {
        let _ = write!(csv, "{},{fnl},", row.kind.name());
        let _ = match &row.halves[half].scatter.model {
            Model::Gaussian => writeln!(csv, "Eq. sigma_th,,,,,,,,,1"),
            Model::Suppressed(fit) => {
                let (value, error) = (&fit.value, &fit.error);
                writeln!(
                    csv,
                    "Eq. sigma_fix,{},{},{},{},{},{},{},{},",
                    value.cosmic_variance,
                    error.cosmic_variance,
                    value.softening,
                    error.softening,
                    value.shot_noise,
                    error.shot_noise,
                    fit.chi_squared,
                    fit.degrees
                )
            }
            Model::Scaled { ratio, .. } => writeln!(csv, "scaled,,,,,,,,,{ratio}"),
        };
    }
    csv
}

fn claims_csv(suite: &Suite, analysis: &Analysis) -> Result<String> {
    let mut csv = String::from("claim,value,error,otherwise,errors away,significant\n");
    for claim in claims(analysis, suite.configuration.fnl)? {
        let (estimate, significant) = (claim.estimate, claim.is_significant());
        let _ = writeln!(
            csv,
            "\"{}\",{},{},{},{},{significant}",
            claim.name, estimate.value, estimate.error, claim.nothing, claim.sigmas
        );
    }
    Ok(csv)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fnl::tests::suite;

    #[test]
    fn every_line_has_the_columns_of_its_head() {
        for (seeds, fixed, noise) in [(12, 0.3, 1.0), (12, 1.0, 6.0), (2, 0.5, 1.0)] {
            let suite = suite(seeds, fixed, noise);
            let tables = tables(&suite, &Analysis::new(&suite).unwrap()).unwrap();
            for (name, csv) in &tables {
                // Names of claims are quoted and have commas.
                let plain: String = csv.split('"').step_by(2).collect();
                let mut counts = plain.lines().map(|line| line.matches(',').count());
                let head = counts.next().unwrap();
                assert!(counts.all(|count| count == head), "{name}");
                assert!(!csv.contains("NaN"), "{name}");
            }
            assert_eq!(tables[0].1.lines().count(), 1 + 8 * seeds);
        }
    }
}
