//! Slow and obvious versions of the kernels: what the tests believe.

pub(crate) mod convolution;
pub(crate) mod transform;
