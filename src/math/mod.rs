//! Elementary functions whose bits are the same everywhere.
//!
//! Each is a polynomial evaluated with plain `+ - * /` in one written order: no branch, no table, no fused
//! multiply-add, no call. IEEE arithmetic then gives one answer on every processor, and a loop over an array of
//! arguments turns into vector instructions of whatever width the caller compiles for. Coefficients are minimax fits
//! (Remez exchange in 50 digits, then rounded); the tests hold each function to its stated error.

mod fmod;
mod ln;
mod sqrt;
mod turns;

pub use fmod::fmod;
pub use ln::neg_ln;
pub use sqrt::{sqrt, sqrt_in_place};
pub use turns::sin_cos_turns;

#[cfg(test)]
mod tests;
