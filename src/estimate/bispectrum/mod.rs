//! The bispectrum of modes.
//!
//! <delta_k1 delta_k2 delta_k3> = B(k1, k2, k3)/V^2 for k1 + k2 + k3 = 0, with delta(x) = sum_k delta_k exp(+i k.x) in a box of volume V.
//! The estimator averages over all triples of modes in three shells (Scoccimarro 2015, arXiv:1506.02729):
//!     D_s(x) = sum over modes k in shell s of delta_k exp(+i k.x),
//!     B_ijk = V^2/(n^3 N_ijk) sum over cells x of D_i(x) D_j(x) D_k(x),
//! N_ijk being the number of ordered triples (k1, k2, k3), one from each shell, with k1 + k2 + k3 = 0: an integer, found exactly.
//!
//! - A shell holds the modes of integer `edges[s] <= |n|^2 < edges[s+1]`, n = k L/(2 pi), as in [`super::power`]; the last edge is at most
//!   (n/2)^2, so that no shell reaches the Nyquist planes.
//! - A [`Triangle`] is three numbers of shells, counted from 0, in any order; a list may be in any order and name one twice.
//! - A mesh knows mode numbers modulo n. Where n is at least the sum of the three upper radii the sum is over closed triangles alone. Else
//!   triples that close only modulo n are in the sum, and in N_ijk as well: the average is over a few more triples, by 0.55% in the
//!   largest triangle of 40 shells of 3 k_f on a mesh of 360.
//! - Sums over cells are [`ExactSum`](super::exact::ExactSum)s of one f64 for each x plane: the same bits for any number of threads, on every
//!   processor, from any x slabs, and in any memory.
//!
//! The way through it: [`closed_triangles`] or [`squeezed_triangles`]; [`triangle_counts`], once for a geometry; [`bispectrum`] for a mesh in
//! one process, or [`shell_modes`], the host's transform and [`bispectrum_sums`] for any part of a mesh; [`bispectrum_values`],
//! [`normalise`], and where wanted [`shot_noise`] and [`reduced`].

mod contraction;
mod counts;
mod plan;
mod products;
mod shells;
mod streaming;
mod sums;
mod triangles;
mod values;

pub use counts::{triangle_counts, triangle_counts_scratch};
pub use shells::shell_modes;
pub use streaming::{bispectrum, bispectrum_meshes, bispectrum_scratch};
pub(crate) use sums::sums_of_fields;
pub use sums::{bispectrum_sums, bispectrum_sums_scratch};
pub use triangles::{Triangle, closed_triangle_count, closed_triangles, squeezed_triangles};
pub use values::{bispectrum_values, normalise, reduced, shot_noise};

#[cfg(test)]
mod tests;
