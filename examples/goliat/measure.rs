//! One initial condition: from a seed and a variant to what is measured in it.

use crate::Failure;
use crate::suite::{Configuration, Measurement, Variant};

/// Makes the initial condition of `seed` and `variant` at z = 32 and measures it, on the calling thread; with `slice`,
/// keeps a plane of its density.
pub(crate) fn measure(
    configuration: &Configuration,
    seed: u64,
    variant: Variant,
    slice: bool,
) -> Result<Measurement, Failure> {
    let _ = (&configuration.spectrum, seed, variant, slice);
    Err("the initial conditions are not built yet".into())
}
