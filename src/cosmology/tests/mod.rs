//! Checks of the room against the embedded CAMB files, independent integrations and closed forms.

mod background;
mod eisenstein_hu;
mod growth;
mod growth_third;
mod mode_table;
mod poisson;
mod power;
mod species;
mod table;

use std::vec::Vec;

use super::Cosmology;

/// Relative difference.
fn off(value: f64, expected: f64) -> f64 {
    (value / expected - 1.0).abs()
}

/// The columns of a file of `examples/data`.
fn columns(text: &str) -> Vec<Vec<f64>> {
    let mut columns = Vec::new();
    for line in text.lines().filter(|line| !line.starts_with('#')) {
        for (i, word) in line.split_whitespace().enumerate() {
            if columns.len() <= i {
                columns.push(Vec::new());
            }
            columns[i].push(word.parse().unwrap());
        }
    }
    columns
}

/// k, T(z=0), P(z=0), P(z=1), P(z=32) of CAMB for the paper's cosmology, with radiation, scaled to sigma8 = 0.8.
fn camb() -> Vec<Vec<f64>> {
    columns(include_str!("../../../examples/data/camb_goliat_linear.txt"))
}

/// z, D and f without radiation, D and f with it, sigma8, f and D of CAMB, 0.8 D.
fn growth_file() -> Vec<Vec<f64>> {
    columns(include_str!("../../../examples/data/growth_goliat.txt"))
}

/// The paper's cosmology with the radiation that CAMB has.
fn with_radiation() -> Cosmology {
    let omega_r = 8.538_169e-5;
    Cosmology { omega_r, omega_de: 0.73 - omega_r, ..Cosmology::goliat() }
}
