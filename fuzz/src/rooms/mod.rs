//! One module for each target that calls what it can with whatever it gets.

pub mod bispectrum;
pub mod cosmology;
pub mod fft;
pub mod halos;
pub mod inference;
pub mod initial;
pub mod meshes;
pub mod particles;
pub mod power;
pub mod runs;
pub mod stages;
pub mod statistics;
