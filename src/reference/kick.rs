//! Kick straight from its definition: every mesh point for every particle.

use std::vec::Vec;

use super::deposit::windows;
use crate::pm::{Kick, Window};

/// Velocities after a kick on a whole mesh of n^3 cells of side 1, z fastest; `psi`: displacements of first and second order.
pub(crate) fn kick(
    velocity: &[[f64; 3]],
    position: &[[f64; 3]],
    forces: [&[f64]; 3],
    (n, window, shift): (usize, Window, f64),
    kick: &Kick,
    psi: [&[[f64; 3]]; 2],
) -> Vec<[f64; 3]> {
    (0..position.len())
        .map(|i| {
            let weights = windows(window, n, shift, position[i]);
            [0, 1, 2].map(|axis| {
                let force: f64 = weights.iter().zip(forces[axis]).map(|(w, f)| w * f).sum();
                let lpt = kick.first * psi[0][i][axis] + kick.second * psi[1][i][axis];
                kick.keep * velocity[i][axis] + kick.force * force + lpt
            })
        })
        .collect()
}
