//! What was found, in words and numbers: a table for the terminal, claims with the numbers that they stand on, and CSV files.

use std::fmt::Write as _;

use crate::arguments::Arguments;
use crate::mass_function::Fit;
use crate::measure::{Bin, Power, Results};
use crate::theory::{Model, REDSHIFTS};

/// P(k) is claimed to agree with HMcode-2020 to this part below this wavenumber, h/Mpc.
pub(crate) const POWER_CLAIM: f64 = 0.04;
pub(crate) const POWER_REACH: f64 = 0.25;

/// Numbers of groups are claimed to agree with Watson et al. to this part from this many particles.
pub(crate) const HALO_CLAIM: f64 = 0.2;
pub(crate) const HALO_REACH: u64 = 100;

/// Bins of fewer halos than this do not tell.
const FEW: f64 = 100.0;

/// Something that must be so.
pub(crate) struct Claim {
    pub(crate) holds: bool,
    text: String,
}

/// Every claim that these runs can be held to.
pub(crate) fn claims(results: &Results) -> Vec<Claim> {
    let mut claims = Vec::new();
    for (power, z) in results.power.iter().zip(REDSHIFTS) {
        let shells = (0..power.power.len()).filter(|&shell| power.theory[shell].k < POWER_REACH);
        let worst = shells.max_by(|&a, &b| {
            let off = |shell| (power.ratio(shell) - 1.0).abs();
            off(a).total_cmp(&off(b))
        });
        if let Some(worst) = worst {
            let (off, k) = (power.ratio(worst) - 1.0, power.theory[worst].k);
            claims.push(Claim {
                holds: off.abs() <= POWER_CLAIM,
                text: format!(
                    "P(k < {POWER_REACH}) at z = {z} within {:.0}% of HMcode-2020: worst {:+.1}% at k = {k:.3}",
                    100.0 * POWER_CLAIM,
                    100.0 * off
                ),
            });
        }
    }
    // Spheres are measured and not claimed: a soft force spreads the mass of small halos beyond their radius, and friends follow it.
    for halos in results.halos.iter().filter(|halos| halos.fit == Fit::Watson) {
        for (bins, z) in halos.bins.iter().zip(REDSHIFTS) {
            let worst = telling(bins).max_by(|a, b| excess(a).total_cmp(&excess(b)));
            if let Some(worst) = worst {
                claims.push(Claim {
                    holds: excess(worst) <= HALO_CLAIM,
                    text: format!(
                        "{} of {HALO_REACH} particles and more at z = {z} within {:.0}% of {}: worst {:+.0}% at {:.1e} Msun/h",
                        name(halos.fit)[0],
                        100.0 * HALO_CLAIM,
                        name(halos.fit)[1],
                        100.0 * (worst.ratio() - 1.0),
                        worst.mass
                    ),
                });
            }
        }
    }
    claims
}

fn telling(bins: &[Bin]) -> impl Iterator<Item = &Bin> {
    bins.iter().filter(|bin| bin.particles >= HALO_REACH && bin.expected >= FEW)
}

fn excess(bin: &Bin) -> f64 {
    (bin.ratio() - 1.0).abs()
}

/// Which halos, and whose fit.
pub(crate) const fn name(fit: Fit) -> [&'static str; 2] {
    match fit {
        Fit::Watson => ["groups of friends", "Watson et al. 2013"],
        Fit::Tinker => ["spheres of 200b", "Tinker et al. 2008"],
    }
}

/// The tables that a person reads, and the list of claims.
pub(crate) fn text(arguments: &Arguments, results: &Results, claims: &[Claim]) -> String {
    let (side, mesh) = (arguments.particles, arguments.mesh());
    let mut text = format!(
        "\n{} pair(s) of {side}^3 particles, mesh {mesh}^3, {} steps from z = 32; {:.0} s on {} threads{}\n",
        arguments.seeds,
        arguments.steps,
        results.elapsed.as_secs_f64(),
        arguments.threads,
        peak_memory().map_or_else(String::new, |gigabytes| format!(", at most {gigabytes:.1} GB")),
    );
    power_table(&mut text, arguments, &results.power);
    for halos in &results.halos {
        let [kind, fit] = name(halos.fit);
        let _ = writeln!(
            text,
            "\nHalos in {} Mpc/h: {kind} over {fit} +- Poisson (number found)\n  {:>9} {:>10}{:>28}{:>26}",
            arguments.halo_length, "particles", "Msun/h", "z = 1", "z = 0"
        );
        for (early, late) in halos.bins[0].iter().zip(&halos.bins[1]) {
            if late.expected < 1.0 {
                continue;
            }
            let column = |bin: &Bin| {
                if bin.expected < 1.0 {
                    return String::from("-");
                }
                format!("{:.3} +- {:.3} ({})", bin.ratio(), bin.error(), bin.found)
            };
            let _ = writeln!(
                text,
                "  {:>9} {:>10.2e}{:>28}{:>26}",
                late.particles,
                late.mass,
                column(early),
                column(late)
            );
        }
    }
    text.push_str("\nClaims\n");
    if claims.is_empty() {
        text.push_str("  none: no shell below k = 0.25 h/Mpc, and no bin of 100 particles and more with 100 halos expected\n");
    }
    for claim in claims {
        let _ = writeln!(text, "  [{}] {}", if claim.holds { "x" } else { " " }, claim.text);
    }
    text
}

fn power_table(text: &mut String, arguments: &Arguments, power: &[Power]) {
    let [early, late] = power else { return };
    let [first, second] = [Model::Hmcode2016, Model::Takahashi].map(Model::name);
    let _ = writeln!(
        text,
        "\nP(k) in {} Mpc/h over HMcode-2020, and what other models give\n  {:>8}{:>34}{:>34}\n  {:>8}{:>10} {first:>11} {second:>11}{:>11} {first:>11} {second:>11}",
        arguments.length, "", "z = 1      ", "z = 0      ", "k", "run", "run"
    );
    for shell in 0..early.power.len() {
        let _ = write!(text, "  {:>8.4}", early.theory[shell].k);
        for power in [early, late] {
            let [hmcode, other, third] = power.theory[shell].nonlinear;
            let _ = write!(
                text,
                "{:>10.4} {:>11.3} {:>14.3}",
                power.ratio(shell),
                other / hmcode,
                third / hmcode
            );
        }
        text.push('\n');
    }
}

/// The most memory that the process ever held, in GB, where the system tells.
fn peak_memory() -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kilobytes: f64 = line.split_whitespace().next()?.parse().ok()?;
    Some(kilobytes * 1024.0 / 1e9)
}

/// Name and content of each CSV file.
pub(crate) fn tables(results: &Results) -> Vec<(&'static str, String)> {
    let mut tables = Vec::new();
    if !results.power.is_empty() {
        tables.push(("power.csv", power_csv(&results.power)));
    }
    if !results.halos.is_empty() {
        tables.push(("halos.csv", halos_csv(results)));
    }
    tables
}

fn power_csv(power: &[Power]) -> String {
    let mut csv = String::from("z,k [h/Mpc],modes,P [(Mpc/h)^3],relative error from pairs,linear P");
    for model in Model::ALL {
        let _ = write!(csv, ",{}", model.name());
    }
    csv.push('\n');
    for (power, z) in power.iter().zip(REDSHIFTS) {
        for (shell, theory) in power.theory.iter().enumerate() {
            let error = power.error.as_ref().map_or_else(String::new, |error| error[shell].to_string());
            let [first, second, third] = theory.nonlinear;
            let _ = writeln!(
                csv,
                "{z},{},{},{},{error},{},{first},{second},{third}",
                theory.k, theory.modes, power.power[shell], theory.linear
            );
        }
    }
    csv
}

fn halos_csv(results: &Results) -> String {
    let mut csv =
        String::from("halos,fit,z,particles from,mass [Msun/h],found,expected,ratio,Poisson error\n");
    for halos in &results.halos {
        let [kind, fit] = name(halos.fit);
        for (bins, z) in halos.bins.iter().zip(REDSHIFTS) {
            for bin in bins {
                let Bin { particles, mass, found, expected } = bin;
                let (ratio, error) = (bin.ratio(), bin.error());
                let _ =
                    writeln!(csv, "{kind},{fit},{z},{particles},{mass},{found},{expected},{ratio},{error}");
            }
        }
    }
    csv
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;
    use crate::measure::Halos;
    use crate::theory::Means;

    fn power(ratios: [f64; 3]) -> Power {
        let theory = [0.1, 0.24, 0.3].map(|k| Means { modes: 10.0, k, linear: 90.0, nonlinear: [100.0; 3] });
        Power { theory: theory.to_vec(), power: ratios.map(|ratio| 100.0 * ratio).to_vec(), error: None }
    }

    #[test]
    fn claims_look_where_they_say_and_nowhere_else() {
        let bin = |particles, found, expected| Bin { particles, mass: 1e13, found, expected };
        let bins = |near: u64| vec![bin(63, 10, 1000.0), bin(100, near, 1000.0), bin(158, 1, 50.0)];
        let halos = Halos { fit: Fit::Watson, bins: [bins(801), bins(799)] };
        let power = vec![power([1.0, 1.039, 2.0]), power([0.959, 1.0, 1.0])];
        let results = Results { power, halos: vec![halos], elapsed: Duration::ZERO };
        let claims = claims(&results);
        assert_eq!(claims.iter().map(|claim| claim.holds).collect::<Vec<_>>(), [true, false, true, false]);
        assert!(claims[1].text.ends_with("worst -4.1% at k = 0.100"), "{}", claims[1].text);
        let text = text(&Arguments::default(), &results, &claims);
        assert!(text.contains("[ ] groups of friends of 100 particles and more at z = 0"), "{text}");
        assert_eq!(tables(&results).len(), 2);
    }
}
