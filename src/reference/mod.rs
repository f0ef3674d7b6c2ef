//! Slow and obvious versions of the kernels: the oracles of the tests.

pub(crate) mod dft;
