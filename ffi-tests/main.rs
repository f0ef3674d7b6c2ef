//! The C interface as C, C++ and Python see it.
//!
//! [`vectors`] computes named cases through the Rust interface. The programs of this folder compute the same cases through
//! `fixpair.h` and compare, bit for bit; then they try every bad input that the header speaks of. [`native`] builds the
//! libraries and the programs, [`programs`] runs them, [`freestanding`] without a system. [`pages`] compiles the code of a page,
//! [`five_minutes`] runs that of another. [`abi`] holds the interface to what was recorded of it.
//! [`allocations`] counts those of each call.

mod abi;
mod abi_header;
mod abi_structs;
mod allocations;
mod examples_of_functions;
mod five_minutes;
mod freestanding;
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
