//! From unit modes to particles: potential, primordial non-Gaussianity, density, displacements.
//!
//! The order is fixed: noise -> fix -> invert -> colour -> PNG -> transfer -> displace. [`conditions::initial_conditions`] does
//! all of it in one call; the stages are public, one file each. Modes are normalised so that an inverse transform without a factor
//! gives the field: f(x) = sum_k f_k exp(+i k.x).

pub mod conditions;
pub mod displacements;
pub mod lpt;
pub mod modes;
pub mod particles;
pub mod png;
pub mod realise;
pub mod shape;
mod shape_rows;
pub mod shifted;
pub mod third;

#[cfg(test)]
mod tests;
#[cfg(test)]
mod tests_parts;
#[cfg(test)]
mod tests_scale;
#[cfg(test)]
mod tests_shapes;
#[cfg(test)]
mod tests_shapes_estimate;
#[cfg(test)]
mod tests_shapes_templates;
#[cfg(test)]
mod tests_species;
#[cfg(test)]
mod tests_third;
#[cfg(test)]
mod tests_third_motion;
#[cfg(test)]
mod tests_third_sizes;
#[cfg(test)]
mod tests_third_sources;
#[cfg(test)]
mod tests_whole;
