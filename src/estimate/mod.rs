//! Spectra of fields on meshes.

pub mod exact;
pub mod power;
