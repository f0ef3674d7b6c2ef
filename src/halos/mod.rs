//! Halos: friends of friends, their catalogue, and spherical overdensities.
//!
//! Two particles are friends if their distance to the nearest periodic image is not above the linking length l; a group is all that friends of
//! friends reach (Davis et al. 1985). l = b L/N^(1/3), N the particles of the whole simulation, b = 0.2 by custom ([`linking_length`]). A
//! group's label is the smallest id in it, so labels depend on nothing but the particles. Distances are computed in `f64` from the
//! coordinates as they are:
//!
//! ```text
//! d^2 = (dx dx + dy dy) + dz dz <= l l,    dx = min(|x_i - x_j|, L - |x_i - x_j|)
//! ```
//!
//! each operation rounded once, and so any program that evaluates this line finds the same groups. Coordinates outside [0, L) are first brought
//! home: the exact remainder, rounded to the particles' type.
//!
//! Units: lengths in that of the box side, velocities in any; masses in Msun/h where lengths are Mpc/h ([`particle_mass`]).
//!
//! Several processes: each labels its own particles together with ghosts, copies of its neighbours' particles that lie within l of its
//! borders ([`slabs`]); sums of a group's particles add up over processes ([`sums`]).

pub mod catalogue;
pub mod fof;
pub mod overdensity;
pub mod refine;
pub mod slabs;
pub mod spheres;
pub mod sums;

mod friends;
mod grid;
mod link;
mod members;
mod periodic;
mod sets;
mod sort;

pub use catalogue::{Halo, halo_count, halos, halos_finish, halos_scratch};
pub use fof::{fof_labels, fof_labels_scratch, linking_length};
pub use overdensity::{Overdensity, particle_mass};
pub use refine::{Shrink, refine_centres};
pub use slabs::{fof_merge, fof_relabel};
pub use spheres::{Density, Sphere, spheres, spheres_scratch};
pub use sums::{HaloSums, halo_sums, halo_sums_merge};

#[cfg(test)]
mod tests;
