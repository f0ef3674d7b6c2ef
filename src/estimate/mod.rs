//! Spectra of fields on meshes.

pub mod bispectrum;
pub mod exact;
pub mod power;
