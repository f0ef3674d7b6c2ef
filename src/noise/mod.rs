//! White noise: unit modes w(k) of a Gaussian field, <|w|^2> = 1, each a function of the seed and of its mode number alone.
//!
//! seed -> Philox block at the mode number -> two uniforms -> modulus and phase -> amplitude choice -> phase choice. Nothing
//! else enters: not the mesh side, the brick, the threads, the number type or the processor. So whatever two
//! simulations share a seed share every mode that both hold (Matched), Fixed modes keep the phases of Normal ones, and Inverted
//! modes are their exact negatives (Avila & Adame 2022, arXiv:2204.11103, section 2).
//!
//! So it is in the native scheme. Those of N-GenIC and FastPM, in which existing suites were drawn, take their uniforms from streams
//! along l whose seeds come from a table ([`Scheme`]); all that follows the uniforms is the same, so that those suites can be
//! fixed, paired and matched, too.
//!
//! Invariants of every output: w(-k) = conj w(k), bit for bit; self-conjugate modes are real; DC is +0.

mod blocks;
mod field;
mod ngenic;
pub mod philox;
pub mod ranlux;
mod realisation;
mod seeds;
mod white;

pub use field::{impose, unit_modes_from_field};
pub use realisation::{Amplitude, Nyquist, Phase, Realisation, Scheme, Selection};
pub use seeds::ngenic_seeds;
pub use white::{white_modes, white_modes_coloured};

#[cfg(test)]
mod statistics;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod tests_ngenic;
#[cfg(test)]
mod tests_scale;
