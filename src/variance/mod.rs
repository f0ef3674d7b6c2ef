//! The statistics of Avila & Adame 2022 (arXiv:2204.11103): scatter of ensembles, models of it, bias and f_NL, and what fixing, pairing and
//! matching are worth.
//!
//! Everything here works on arrays of f64 that the caller owns: spectra in, numbers out. An *estimate* is what one runs to measure
//! something once: a simulation, or the average of a pair of inverted ones. Numbers of estimates count independent ones, so a pair counts once;
//! numbers of *simulations* per estimate (2 for a pair) enter where costs are compared, always as an argument.
//!
//! The data walks: samples -> [`ensemble`], [`resample`] -> [`pairs`] -> [`models`], [`suppression`] -> [`bias`], [`likelihood`], [`fit`],
//! [`posterior`] -> [`matched`], [`control`], [`carpool`].
//!
//! With the feature `linalg` faer factors matrices of any size; all else needs neither it nor memory of its own.

pub mod bias;
#[cfg(feature = "linalg")]
pub mod carpool;
mod check;
pub mod contours;
pub mod control;
#[cfg(feature = "linalg")]
pub mod covariance;
pub mod ensemble;
pub mod fit;
pub mod levels;
pub mod likelihood;
mod locate;
pub mod matched;
pub mod models;
pub mod pairs;
pub mod posterior;
pub mod ratios;
pub mod resample;
mod small;
pub mod suppression;

#[cfg(test)]
mod tests;
