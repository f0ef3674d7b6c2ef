//! fixpair: Fixed, Paired and Matched initial conditions with primordial non-Gaussianity.
//!
//! Numerical kernels over memory that the caller owns, after Avila & Adame 2022 (arXiv:2204.11103). The
//! data walks one way through the rooms below; each imports only rooms above it.
#![no_std]

#[cfg(any(feature = "std", test))]
extern crate std;

pub mod status;

pub mod scratch;

mod within;

mod sort;

pub mod real;

pub mod math;

pub mod simd;

pub mod mesh;

pub mod exec;

pub mod walk;

pub mod fft;

pub mod noise;

pub mod cosmology;

pub mod initial;

pub mod pm;

pub mod halos;

pub mod estimate;

pub mod variance;

pub mod capi;

#[cfg(all(feature = "freestanding", not(feature = "std"), not(test)))]
mod freestanding;

#[cfg(test)]
mod reference;

/// Runs the Rust of README.md.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
