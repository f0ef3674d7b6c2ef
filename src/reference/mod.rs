//! Slow and obvious versions of the kernels: the oracles of the tests.

pub(crate) mod bispectrum;
pub(crate) mod built;
pub(crate) mod convolution;
pub(crate) mod deposit;
pub(crate) mod dft;
pub(crate) mod fof;
pub(crate) mod force;
pub(crate) mod kick;
pub(crate) mod ngenic;
pub(crate) mod parts;
pub(crate) mod power;
pub(crate) mod shape;
pub(crate) mod transform;
pub(crate) mod variance;
pub(crate) mod white;
