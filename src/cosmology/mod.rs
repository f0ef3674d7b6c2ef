//! Background, growth, linear power and the way from the primordial potential to the density.
//!
//! With a the scale factor, H = H0 E(a), and k in h/Mpc:
//!
//! - E^2(a) = Or a^-4 + Om a^-3 + Ok a^-2 + Ode a^(-3(1+w0+wa)) e^(-3 wa (1-a)) ([`background`]);
//! - D'' + (2 + dlnE/dlna) D' = (3/2) Om(a) D, and higher orders with sources made of it ([`growth`](mod@growth));
//! - P(k, a) = A k^n_s T^2(k) D^2(a) (Mpc/h)^3 ([`power`]), from a [`table`] or from [`eisenstein_hu`];
//! - delta(k, a) = alpha(k, a) Phi(k) ([`poisson`]), and both as tables over |n|^2 for the mode kernels ([`mode_table`]);
//! - delta_s = (T_s/T_m) delta of one species of matter ([`species`]).
//!
//! Invariants: D(a = 1) = 1; T -> 1 for k -> 0; Phi is the primordial Bardeen potential with the sign that makes alpha > 0.
//! All numbers are f64, all functions are pure, and elementary functions come from `libm`: the same bits everywhere.
//!
//! # Which spectrum to begin from
//! A simulation grows its modes with the D of its own background. Most have no radiation in it, so their initial conditions
//! come from the spectrum of z = 0 scaled *back* with that D: then the linear spectrum at low redshift is right. A
//! Boltzmann code's spectrum of z = 32, used directly, has felt radiation, which slows growth at early times and so asks for more
//! power at the start: for the cosmology of arXiv:2204.11103 sigma8^2(z = 32) is 1.3% higher than the back-scaled one, and the
//! simulation would carry these 1.3% of power to z = 0.

pub mod background;
pub mod eisenstein_hu;
pub mod growth;
pub mod mode_table;
pub mod poisson;
pub mod power;
pub mod quadrature;
pub mod species;
pub mod table;

pub use background::{Cosmology, radiation_density};
pub use eisenstein_hu::{EisensteinHu, Wiggles};
pub use growth::{Growth, g_ratio, growth, growth_many};
pub(crate) use mode_table::mode_power_table;
pub use mode_table::{alpha_table, mode_table_length, potential_amplitude_table};
pub use poisson::{Convention, Poisson, alpha_factor, primordial_amplitude};
pub use power::Linear;
pub use species::{Ratio, Species, species_table};
pub use table::Table;

/// c/H0 in Mpc/h: 299792.458 km/s over 100 km/s per Mpc/h.
pub const HUBBLE_DISTANCE: f64 = 2_997.924_58;

#[cfg(test)]
mod tests;
