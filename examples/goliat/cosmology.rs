//! The cosmology of the GOLIAT-PNG suite (Avila & Adame 2022, Table 1; WMAP7) and its linear spectrum from CAMB.

use crate::Failure;

pub(crate) const OMEGA_MATTER: f64 = 0.27;
pub(crate) const OMEGA_LAMBDA: f64 = 0.73;
pub(crate) const SPECTRAL_INDEX: f64 = 0.96;
/// Redshift of the initial conditions.
pub(crate) const REDSHIFT: f64 = 32.0;

const CAMB: &str = include_str!("camb_goliat_linear.txt");

/// Linear theory at z = 0: k in h/Mpc, T(k -> 0) = 1, P in (Mpc/h)^3.
pub(crate) struct Spectrum {
    pub(crate) k: Vec<f64>,
    pub(crate) transfer: Vec<f64>,
    pub(crate) power: Vec<f64>,
}

/// The embedded CAMB table: total matter, sigma_8 = 0.8.
///
/// # Errors
/// A sentence with the line that is not a row of numbers.
pub(crate) fn spectrum() -> Result<Spectrum, Failure> {
    parse(CAMB)
}

/// Columns k, T, P(z = 0), and others that are not used: the initial spectrum is scaled back from z = 0 by the
/// growth of matter and Lambda, so that a simulation without radiation arrives at the right P(k) today.
fn parse(table: &str) -> Result<Spectrum, Failure> {
    let mut spectrum = Spectrum { k: Vec::new(), transfer: Vec::new(), power: Vec::new() };
    for (number, line) in table.lines().enumerate().filter(|(_, line)| !line.starts_with('#')) {
        let row: Result<Vec<f64>, _> = line.split_whitespace().map(str::parse).collect();
        match row.as_deref() {
            Ok([k, transfer, power, ..]) => {
                spectrum.k.push(*k);
                spectrum.transfer.push(*transfer);
                spectrum.power.push(*power);
            }
            _ => return Err(format!("line {} of the spectrum is not k, T, P: {line:?}", number + 1).into()),
        }
    }
    Ok(spectrum)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn embedded_table_is_increasing_in_k_and_has_the_stated_sigma8() {
        let table = spectrum().unwrap();
        assert!(table.k.windows(2).all(|pair| pair[0] < pair[1]));
        assert!((table.transfer[0] - 1.0).abs() < 1e-4);
        // sigma_8^2 = int dlnk k^3 P W^2(8 k) / 2 pi^2 by the trapezium rule: 0.1% is the error of its step.
        let window = |x: f64| 3.0 * (x.sin() - x * x.cos()) / x.powi(3);
        let density = |i: usize| {
            table.k[i].powi(3) * table.power[i] * window(8.0 * table.k[i]).powi(2)
                / (2.0 * std::f64::consts::PI.powi(2))
        };
        let variance: f64 = (1..table.k.len())
            .map(|i| 0.5 * (density(i) + density(i - 1)) * (table.k[i] / table.k[i - 1]).ln())
            .sum();
        assert!((variance.sqrt() - 0.8).abs() < 8e-4, "{}", variance.sqrt());
    }

    #[test]
    fn a_broken_line_is_named() {
        let message = parse("# k T P\n1 2 3\n1 x 3\n").err().unwrap().to_string();
        assert!(message.contains("line 3"), "{message}");
    }
}
