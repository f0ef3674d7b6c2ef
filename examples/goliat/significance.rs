//! What a suite of so many seeds can claim: each claim a number with its sampling error, and how far that is from what would be if it were false.
//!
//! Ratios of scatter are between types that share their seeds, so they correlate: their errors are those of the logarithm over bootstrap
//! replicates, which draw the same seeds for both.

use fixpair::status::Result;
use fixpair::variance::control::{Beta, control_variate};
use fixpair::variance::matched::Estimate;
use fixpair::variance::resample::bootstrap_indices;

use crate::fnl::{Analysis, Row};
use crate::statistics::{Kind, deviation, error_of_mean, mean};

/// Seeds without which a scatter is not resampled.
pub(crate) const LEAST_SEEDS: usize = 6;
/// Bootstrap replicates: their deviation is known to 1.6%.
const REPLICATES: u64 = 2000;
/// Of the bootstrap.
const SEED: u64 = 41;
/// Beyond so many standard errors a claim is called significant, where they are known well.
pub(crate) const ENOUGH: f64 = 2.0;

/// The level of Student's t for so many values that is as probable as [`ENOUGH`] of a Gaussian (Cornish & Fisher 1937): 2.25 for twelve.
fn level(values: usize) -> f64 {
    let (z, nu) = (ENOUGH, values as f64 - 1.0);
    z + (z.powi(3) + z) / (4.0 * nu) + (5.0 * z.powi(5) + 16.0 * z.powi(3) + 3.0 * z) / (96.0 * nu * nu)
}

/// A number, and what it would be if there were nothing to claim.
pub(crate) struct Claim {
    pub(crate) name: String,
    pub(crate) estimate: Estimate,
    pub(crate) nothing: f64,
    /// How many standard errors it is away.
    pub(crate) sigmas: f64,
    /// Beyond how many it is significant.
    enough: f64,
}

impl Claim {
    pub(crate) fn is_significant(&self) -> bool {
        self.sigmas.abs() > self.enough
    }

    fn of_mean(name: String, values: &[f64], nothing: f64) -> Option<Self> {
        let estimate = Estimate { value: mean(values), error: error_of_mean(values) };
        Self::of(name, estimate, nothing, level(values.len())).filter(|_| values.len() >= LEAST_SEEDS)
    }

    fn of(name: String, estimate: Estimate, nothing: f64, enough: f64) -> Option<Self> {
        let sigmas = (estimate.value - nothing) / estimate.error;
        sigmas.is_finite().then_some(Self { name, estimate, nothing, sigmas, enough })
    }
}

/// The standard deviation of a statistic over bootstrap replicates of so many seeds, for which it is written of places of the seeds; replicates
/// without a value are left out.
fn bootstrap(seeds: usize, statistic: impl Fn(&[usize]) -> Option<f64>) -> Result<f64> {
    let mut indices = vec![0; seeds];
    let mut values = Vec::new();
    for replicate in 0..REPLICATES {
        bootstrap_indices(&mut indices, seeds as u64, SEED, replicate)?;
        let places: Vec<usize> = indices.iter().map(|&index| index as usize).collect();
        values.extend(statistic(&places).filter(|value| value.is_finite()));
    }
    // A draw of N has the variance of (N - 1)/N of the parent's.
    Ok(deviation(&values) * (seeds as f64 / (seeds as f64 - 1.0)).sqrt())
}

fn at(values: &[f64], places: &[usize]) -> Vec<f64> {
    places.iter().map(|&place| values[place]).collect()
}

/// How many times less one list scatters than another, of the same seeds.
fn gain(name: String, reference: &[f64], values: &[f64]) -> Result<Option<Claim>> {
    if values.len() < LEAST_SEEDS {
        return Ok(None);
    }
    let ratio = deviation(reference) / deviation(values);
    let error = bootstrap(values.len(), |places| {
        Some((deviation(&at(reference, places)) / deviation(&at(values, places))).ln())
    })?;
    let sigmas = ratio.ln() / error;
    let estimate = Estimate { value: ratio, error: ratio * error };
    let enough = level(values.len());
    Ok(sigmas.is_finite().then_some(Claim { name, estimate, nothing: 1.0, sigmas, enough }))
}

/// Lists of the two rows for the seeds that both have.
fn shared(first: &Row, second: &Row, of: impl Fn(&Row) -> Vec<f64>) -> [Vec<f64>; 2] {
    let pick = |row: &Row, other: &Row| -> Vec<f64> {
        let both = |seed: &usize| other.seeds.contains(seed);
        row.seeds.iter().zip(of(row)).filter(|(seed, _)| both(seed)).map(|(_, value)| value).collect()
    };
    [pick(first, second), pick(second, first)]
}

fn times(values: &[f64], factor: f64) -> Vec<f64> {
    values.iter().map(|value| factor * value).collect()
}

/// beta of the control variate f0 of least scatter, of the seeds of a row.
fn best_beta(name: String, row: &Row) -> Result<Option<Claim>> {
    let [gaussian, local] = &row.fnl;
    let slope = |y: &[f64], c: &[f64]| Some(control_variate(y, c, 0.0, 0.0, Beta::Optimal).ok()?.beta);
    let Some(value) = slope(local, gaussian).filter(|_| local.len() >= LEAST_SEEDS) else { return Ok(None) };
    let error = bootstrap(local.len(), |places| slope(&at(local, places), &at(gaussian, places)))?;
    Ok(Claim::of(name, Estimate { value, error }, 1.0, level(local.len())))
}

/// Pairs of Normal have their own line on pairing; the rest of them is in the tables.
const KINDS: [Kind; 3] = [Kind::Normal, Kind::Fixed, Kind::FixedPaired];

/// All claims that can be put to the suite.
///
/// # Errors
/// Of the kernels.
pub(crate) fn claims(analysis: &Analysis, fnl: f64) -> Result<Vec<Claim>> {
    let row = |kind| analysis.row(kind);
    let (normal, fixed) = (row(Kind::Normal), row(Kind::Fixed));
    let pairs = [(Kind::NormalPaired, normal), (Kind::FixedPaired, fixed)];
    let mut claims = Vec::new();

    let [reference, values] = shared(normal, fixed, |row| row.fnl[1].clone());
    claims.push(gain(format!("fixing: sigma(f{fnl}), Normal / Fixed"), &reference, &values)?);
    for (kind, single) in pairs {
        let [reference, values] = shared(single, row(kind), |row| row.fnl[1].clone());
        let name = format!("pairing: sigma(f{fnl}) per simulation, {} / {}", single.kind.name(), kind.name());
        claims.push(gain(name, &reference, &times(&values, 2f64.sqrt()))?);
    }
    for kind in KINDS {
        let name = format!("matching: sigma(f{fnl}) / sigma(f{fnl} - f0), {}", kind.name());
        claims.push(gain(name, &row(kind).fnl[1], &row(kind).differences())?);
    }
    let [reference, _] = shared(normal, row(Kind::FixedPaired), |row| row.fnl[1].clone());
    let [_, matched] = shared(normal, row(Kind::FixedPaired), Row::differences);
    let name = format!("all three, per simulation: Normal sigma(f{fnl}) / Fixed-Paired sigma(f{fnl} - f0)");
    claims.push(gain(name, &reference, &times(&matched, 2f64.sqrt()))?);

    for kind in KINDS {
        claims.push(Claim::of_mean(format!("<f0>, {}", kind.name()), &row(kind).fnl[0], 0.0));
    }
    for kind in KINDS {
        claims.push(Claim::of_mean(format!("<f{fnl} - f0>, {}", kind.name()), &row(kind).differences(), fnl));
    }
    for kind in [Kind::Fixed, Kind::FixedPaired] {
        claims.push(Claim::of_mean(format!("p (Eq. p), Matched, {}", kind.name()), &row(kind).p[1], 1.0));
    }
    if let Some(fit) = &row(Kind::FixedPaired).halves[1].all {
        let p = fit.second();
        let estimate = Estimate { value: p.centre, error: p.half_width };
        claims.push(Claim::of(
            format!("p, fit to the mean of all Fixed of f_NL = {fnl}"),
            estimate,
            1.0,
            ENOUGH,
        ));
    }
    for kind in KINDS {
        claims.push(best_beta(format!("beta of least scatter, {}", kind.name()), row(kind))?);
    }
    Ok(claims.into_iter().flatten().collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fnl::tests::suite;

    #[test]
    fn the_level_is_that_of_tables_of_students_t() {
        // 0.9545 in the middle.
        for (values, expected) in [(6, 2.65), (12, 2.255), (41, 2.06)] {
            assert!((level(values) / expected - 1.0).abs() < 0.02, "{values} {}", level(values));
        }
    }

    #[test]
    fn the_bootstrap_of_a_mean_has_its_standard_error() {
        let values: Vec<f64> = (0..40).map(|i| f64::from(i * i % 17)).collect();
        let error = bootstrap(40, |places| Some(mean(&at(&values, places)))).unwrap();
        assert!((error / error_of_mean(&values) - 1.0).abs() < 0.05);
    }

    #[test]
    fn what_is_built_in_is_significant_and_what_is_not_is_not() {
        let suite = suite(24, 0.2, 1.0);
        let claims = claims(&Analysis::new(&suite).unwrap(), 100.0).unwrap();
        let find = |name: &str| claims.iter().find(|claim| claim.name.starts_with(name)).unwrap();
        let fixing = find("fixing");
        assert!(
            fixing.is_significant()
                && (fixing.estimate.value / 5.0).ln().abs()
                    < 3.0 * fixing.estimate.error / fixing.estimate.value
        );
        assert!(find("matching").is_significant());
        assert!(find("all three").estimate.value > fixing.estimate.value);
        // Normal pairs repeat each other: a simulation of them is worth half, but for other weights of bins.
        let pairing = find("pairing").estimate;
        assert!((pairing.value - 0.5f64.sqrt()).abs() < 0.05, "{pairing:?}");
        for name in ["<f100 - f0>, Fixed-Paired", "p (Eq. p), Matched, Fixed-Paired"] {
            assert!(!find(name).is_significant(), "{name} {:?}", find(name).estimate);
        }
    }

    #[test]
    fn few_seeds_claim_nothing_of_scatter() {
        let suite = suite(4, 0.2, 1.0);
        let claims = claims(&Analysis::new(&suite).unwrap(), 100.0).unwrap();
        assert!(claims.iter().all(|claim| claim.name.starts_with("p, fit")));
    }
}
