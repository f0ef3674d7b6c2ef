//! Spectra and correlation functions of fields on meshes.

pub mod binning;
pub mod bispectrum;
pub mod compensation;
pub mod correlation;
pub mod edges;
pub mod exact;
mod front;
mod line;
pub mod power;
mod rows;
mod sweep;

#[cfg(test)]
mod tests;
