//! The fuzz targets of fixpair: [`rooms`] calls each room of the library through its C interface as a C program would, [`same`] compares what it
//! answers with the slow twins of the kernels.

/// Every function, struct and constant of `fixpair.h`.
pub mod c {
    pub use fixpair::capi::{
        bias::*, binning::*, bispectrum::*, bispectrum_sums::*, bispectrum_values::*, built_in::*, cells::*,
        correlation::*, cosmology::*, covariance::*, ensemble::*, evolve::*, exec::*, factors::*, fft::*, fof::*,
        force::*, halos::*, initial::*, kick::*, matched::*, mesh::*, mode_table::*, noise::*, particles::*, pm::*,
        posterior::*, power::*, pre_initial::*, resample::*, run::*, scatter::*, shape::*, species::*, spheres::*,
        stages::*, status::*, third::*, triangles::*,
    };
    pub use fixpair::scratch::Layout;
}

#[macro_use]
pub mod check;

pub mod bricks;
pub mod clouds;
pub mod hooks;
pub mod input;
pub mod memory;
pub mod rooms;
pub mod same;
pub mod universe;

/// The slow and obvious versions of the kernels, from the sources of the library: its rooms have their names there.
#[path = "../../src/reference/mod.rs"]
#[allow(dead_code, reason = "the library's tests use all of them")]
mod reference;

use fixpair::{estimate, exec, fft, initial, math, mesh, noise, pm, real, scratch, status, variance};
