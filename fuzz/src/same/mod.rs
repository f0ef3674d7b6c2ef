//! One module for each target that compares the library with the slow twins of its kernels, on input that is sound.

pub mod bispectrum;
pub mod forces;
pub mod groups;
pub mod noise;
pub mod particles;
pub mod power;
pub mod statistics;
pub mod transform;

/// Are both sides the same but for so much?
fn close(found: f64, expected: f64, tolerance: f64, what: impl core::fmt::Display) {
    assert!(
        (found - expected).abs() <= tolerance,
        "{what}: {found:e} instead of {expected:e}, tolerance {tolerance:e}"
    );
}
