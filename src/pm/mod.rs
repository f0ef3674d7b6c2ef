//! Particles and meshes: deposit, forces, read-out, kicks and drifts, whole runs, and what slabs and interlacing need beside them.
//!
//! Mesh point i of a box of side L lies at (i + shift) H, H = L/n. Positions are in the unit of L, masses in any. The cells that particles of
//! a slab touch reach beyond it: a [`Region`] holds them, and `ghosts.rs` says how processes exchange them.

pub mod columns;
pub mod deposit;
pub mod drift;
pub mod evolve;
pub mod factors;
pub mod force;
pub mod ghosts;
pub mod interlace;
pub mod kick;
pub mod outputs;
pub mod pre_initial;
pub mod read_out;
pub mod region;
pub mod window;

mod cells;
mod frame;
mod gather;
mod mover;
mod scatter;
mod sort;
mod tiles;

pub use columns::{Column, ColumnMut, Positions, copy_components};
pub use deposit::{deposit, deposit_scratch};
pub use drift::{Drift, drift};
pub use evolve::{evolve, evolve_scratch};
pub use force::{Difference, ForceLaw, force, force_scratch, forces, potential};
pub use frame::Assignment;
pub use ghosts::{add_cells, copy_cells};
pub use interlace::interlace;
pub use kick::{Kick, Lpt, kick, kick_scratch};
pub use pre_initial::{initial_conditions_at, initial_conditions_at_scratch};
pub use read_out::{read_out, read_out_scratch};
pub use region::Region;
pub use window::Window;

#[cfg(test)]
mod tests;
