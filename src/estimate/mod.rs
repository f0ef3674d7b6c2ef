//! Spectra of fields on meshes.

pub mod power;
