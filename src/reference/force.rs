//! Forces from their definition: the direct transform, each mode by the textbook's formula; and Newton's force in a periodic box by Ewald's sum.

use core::f64::consts::PI;
use std::vec::Vec;

use super::dft;
use crate::mesh::Brick;
use crate::pm::{Difference, ForceLaw};

/// The gradient without i, and minus the Laplacian, on an axis of spacing h, at wave number k.
pub(crate) fn derivatives(law: &ForceLaw, k: f64, h: f64) -> (f64, f64) {
    let theta = k * h;
    let gradient = match law.gradient {
        Difference::Exact => k,
        Difference::TwoPoint => theta.sin() / h,
        Difference::FourPoint => (8.0 * theta.sin() - (2.0 * theta).sin()) / (6.0 * h),
    };
    let laplacian = match law.laplacian {
        Difference::Exact => k * k,
        Difference::TwoPoint => (2.0 / h * (theta / 2.0).sin()).powi(2),
        Difference::FourPoint => (15.0 - 16.0 * theta.cos() + (2.0 * theta).cos()) / (6.0 * h * h),
    };
    (gradient, laplacian)
}

/// S/W^power at a wave vector.
pub(crate) fn shape(law: &ForceLaw, k: [f64; 3], h: f64) -> f64 {
    let square: f64 = k.iter().map(|k| k * k).sum();
    let window: f64 = law.window.map_or(1.0, |(window, power)| {
        let sinc = |k: f64| if k == 0.0 { 1.0 } else { (k * h / 2.0).sin() / (k * h / 2.0) };
        k.iter().map(|&k| sinc(k).powi((window as u32 * power) as i32)).product()
    });
    (-square * law.split_scale.powi(2)).exp() / window
}

/// The three components of the force, and the potential, on the n^3 cells (z innermost) of a box of side `box_size`, of masses in cells.
pub(crate) fn fields(n: usize, box_size: f64, masses: &[f64], law: &ForceLaw) -> [Vec<f64>; 4] {
    core::array::from_fn(|which| field(which, n, box_size, masses, law))
}

/// One of the four.
pub(crate) fn field(which: usize, n: usize, box_size: f64, masses: &[f64], law: &ForceLaw) -> Vec<f64> {
    let mass: f64 = masses.iter().sum();
    let h = box_size / n as f64;
    let modes = dft::forward(n, masses);
    let transformed: Vec<dft::Complex> = (0..n * n * n)
        .map(|at| {
            let number = [at / (n * n), at / n % n, at % n].map(|i| Brick::mode(n, i));
            if number == [0; 3] || number.iter().any(|m| m.unsigned_abs() as usize == n / 2) {
                return [0.0; 2];
            }
            let k = number.map(|m| 2.0 * PI * m as f64 / box_size);
            let along = k.map(|k| derivatives(law, k, h));
            let laplacian: f64 = along.iter().map(|&(_, laplacian)| laplacian).sum();
            let [re, im] = modes[at].map(|part| -part / mass * shape(law, k, h) / laplacian);
            match which {
                // - i K (re + i im)
                0..3 => [along[which].0 * im, -along[which].0 * re],
                _ => [re, im],
            }
        })
        .collect();
    dft::inverse(n, &transformed).into_iter().map(|[re, _]| re).collect()
}

/// The pull of a point at the origin of a periodic box of side 1, 1/r^2 near it, on a point at r, with the uniform background that keeps
/// the mean density zero (Hernquist, Bouchet & Suto 1991). Any alpha gives the same; 2 and 3 are good to 1e-11.
pub(crate) fn ewald(r: [f64; 3], alpha: f64) -> [f64; 3] {
    let mut force = [0.0; 3];
    let cube = |side: i32| {
        let along = -side..=side;
        along.clone().flat_map(move |x| {
            let along = along.clone();
            along.clone().flat_map(move |y| along.clone().map(move |z| [x, y, z].map(f64::from)))
        })
    };
    for image in cube(2) {
        let d: [f64; 3] = core::array::from_fn(|a| r[a] - image[a]);
        let s = norm(d);
        let ar = alpha * s;
        let pull = (libm::erfc(ar) + 2.0 * ar / PI.sqrt() * (-ar * ar).exp()) / (s * s * s);
        for a in 0..3 {
            force[a] -= pull * d[a];
        }
    }
    for h in cube(4) {
        let square: f64 = h.iter().map(|h| h * h).sum();
        if square > 0.0 {
            let phase: f64 = 2.0 * PI * (0..3).map(|a| h[a] * r[a]).sum::<f64>();
            let pull = 2.0 / square * (-(PI / alpha).powi(2) * square).exp() * phase.sin();
            for a in 0..3 {
                force[a] -= pull * h[a];
            }
        }
    }
    force
}

pub(crate) fn norm(v: [f64; 3]) -> f64 {
    v.iter().map(|x| x * x).sum::<f64>().sqrt()
}
