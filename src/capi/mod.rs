//! The C interface: checks everything at the border, then calls the kernels. It mirrors the rooms of the crate and is the only
//! `extern "C"` in it. The documentation of each function is written for `fixpair.h`.
#![allow(non_camel_case_types, reason = "the names of the header")]
#![allow(
    rustdoc::broken_intra_doc_links,
    rustdoc::invalid_html_tags,
    reason = "the text is that of the header"
)]

pub mod bias;
pub mod binning;
pub mod bispectrum;
pub mod bispectrum_sums;
pub mod bispectrum_values;
pub mod built_in;
pub mod cells;
pub mod correlation;
pub mod cosmology;
#[cfg(feature = "linalg")]
pub mod covariance;
pub mod ensemble;
pub mod evolve;
pub mod exec;
pub mod factors;
pub mod fft;
pub mod fof;
pub mod force;
pub mod halos;
pub mod initial;
pub mod kick;
pub mod matched;
pub mod mesh;
pub mod mode_table;
pub mod noise;
pub mod particles;
pub mod pm;
pub mod posterior;
pub mod power;
pub mod pre_initial;
pub mod resample;
pub mod run;
pub mod scatter;
pub mod shape;
pub mod species;
pub mod spheres;
pub mod stages;
pub mod status;
pub mod third;
pub mod triangles;

mod border;
