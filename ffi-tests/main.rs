//! The C interface as C, C++ and Python see it.
//!
//! [`vectors`] computes named cases through the Rust interface. The programs of this folder compute the same cases through
//! `fixpair.h` and compare, bit for bit; then they try every bad input that the header speaks of. [`native`] builds the
//! libraries and the programs, [`programs`] runs them. [`pages`] compiles the code of a page.

mod allocations;
mod header;
mod native;
mod pages;
mod programs;
mod vectors;
mod vectors_estimate;
mod vectors_gravity;
mod vectors_halos;
mod vectors_initial;
mod vectors_particles;
mod vectors_real;
mod vectors_shape;
mod vectors_variance;
