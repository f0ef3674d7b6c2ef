//! Forces between particles: deposit, force, read-out, against Newton.

use core::f64::consts::PI;

use super::force::laws;
use super::*;
use crate::fft::{Fft3, Transform};
use crate::reference::built::serial;
use crate::reference::force::{ewald, norm};

/// The force at places, of weighted particles, in a box whose cells have side 1.
fn felt(
    fft: &mut Transform<'_, f64>,
    particles: &[f64],
    weights: Option<&[f64]>,
    places: &[f64],
    law: &ForceLaw,
    window: Window,
) -> Vec<[f64; 3]> {
    let (region, modes) = (Region::from_brick(fft.configuration()).unwrap(), *fft.fourier());
    let n = region.n();
    let assignment = cells(n, window, 0.0);
    let mass = weights.map_or(particles.len() as f64 / 3.0, sum);
    let mut meshes = [(); 3].map(|()| vec![0.0; fft.length()]);
    let deposited = put(&region, particles, weights, &assignment, &Serial).unwrap();
    meshes[0][..deposited.len()].copy_from_slice(&deposited);
    fft.forward(&mut meshes[0]).unwrap();
    let [x, y, z] = &mut meshes;
    let mut memory = Memory::new(force_scratch(n).unwrap());
    forces([x, y, z], &modes, law, n as f64, mass, memory.get(), &Serial).unwrap();
    let along = meshes.map(|mut mesh| {
        fft.inverse(&mut mesh).unwrap();
        get(&region, &mesh, places, &assignment, &Serial).unwrap()
    });
    (0..places.len() / 3).map(|i| [along[0][i], along[1][i], along[2][i]]).collect()
}

/// Every law with every window to assign by.
fn laws_and_windows() -> impl Iterator<Item = (ForceLaw, Window)> {
    laws().into_iter().flat_map(|law| Window::ALL.map(|window| (law, window)))
}

#[test]
fn no_particle_pulls_itself() {
    let mut fft = serial::<f64>(16);
    for (law, window) in laws_and_windows() {
        let at: Vec<f64> = random(3, 77).iter().map(|u| 16.0 * u).collect();
        let near: Vec<f64> =
            (0..3).flat_map(|a| [0, 1, 2].map(|b| at[b] + f64::from(u8::from(a == b)))).collect();
        let all = [&at[..], &near].concat();
        let forces = felt(&mut fft, &at, None, &all, &law, window);
        let scale = forces[1..].iter().fold(0.0, |scale: f64, force| scale.max(norm(*force)));
        // Terms of the size of the mesh's forces cancel, each off by a few epsilon.
        assert!(norm(forces[0]) < 1e-12 * scale, "{law:?} {window:?}: {:?} of {scale}", forces[0]);
    }
}

#[test]
fn two_particles_pull_each_other_equally() {
    let mut fft = serial::<f64>(16);
    let weights = [3.0, 0.5];
    for (law, window) in laws_and_windows() {
        let mut at: Vec<f64> = random(6, 5).iter().map(|u| 16.0 * u).collect();
        for axis in 0..3 {
            at[3 + axis] = at[axis] + [1.7, -0.9, 2.2][axis];
        }
        let [one, two] = felt(&mut fft, &at, Some(&weights), &at, &law, window)[..] else { panic!() };
        let sum = norm([0, 1, 2].map(|a| weights[0] * one[a] + weights[1] * two[a]));
        assert!(sum < 1e-12 * weights[0] * norm(one), "{law:?} {window:?}");
        if window as i32 > 1 && law.window.is_none() {
            assert!(
                (0..3).map(|a| one[a] * (at[3 + a] - at[a])).sum::<f64>() > 0.0,
                "{law:?} {window:?}: apart"
            );
        }
    }
}

#[test]
fn momentum_is_conserved_to_rounding() {
    let mut fft = serial::<f64>(16);
    let at: Vec<f64> = random(3 * 500, 31).iter().map(|u| 16.0 * u).collect();
    let weights = random(500, 8);
    for (law, window) in laws_and_windows() {
        let forces = felt(&mut fft, &at, Some(&weights), &at, &law, window);
        let pulls = || forces.iter().zip(&weights);
        let momentum = [0, 1, 2].map(|a| pulls().map(|(force, weight)| weight * force[a]).sum::<f64>());
        let all: f64 = pulls().map(|(force, weight)| weight * norm(*force)).sum();
        assert!(norm(momentum) < 1e-13 * all, "{law:?} {window:?}: {momentum:?} of {all}");
    }
}

#[test]
fn ewalds_sum_is_newton_nearby_and_the_same_for_any_alpha() {
    for r in [[0.01, 0.0, 0.0], [0.1, -0.2, 0.07], [0.45, 0.3, -0.5], [0.5, 0.0, 0.0]] {
        let [two, three] = [2.0, 3.0].map(|alpha| ewald(r, alpha));
        assert!(norm([0, 1, 2].map(|a| two[a] - three[a])) < 1e-10 * (1.0 + norm(two)), "{r:?}");
    }
    // 1/r^2 - 4 pi r/3 + O(r^3): the background inside r.
    let r = 0.01;
    assert!((ewald([0.0, 0.0, r], 2.0)[2] + 1.0 / (r * r) - 4.0 * PI * r / 3.0).abs() < 1e-3);
}

/// A pair of particles on a mesh.
struct Pair {
    /// Separation in cells.
    r: f64,
    /// The force along the line to the other particle, as a part of the true one.
    radial: f64,
    /// |F - F_true|/|F_true|.
    error: f64,
}

/// The force of single particles, at 20 random places of a box of 64 cells, on 400 others each, at separations in `range`, uniform in r, in random
/// directions; against Ewald's. With `tree` the short-range force of Springel 2005, eq. 21, is added.
fn pairs(law: &ForceLaw, window: Window, range: [f64; 2], tree: bool) -> Vec<Pair> {
    let (n, sources, targets) = (64, 20, 400);
    let mut fft = serial::<f64>(n);
    let side = n as f64;
    let mut all = Vec::new();
    for source in 0..sources {
        let numbers = random(3 + 3 * targets, 1 + source);
        let at: Vec<f64> = numbers[..3].iter().map(|u| u * side).collect();
        let separations: Vec<[f64; 3]> = numbers[3..]
            .chunks_exact(3)
            .map(|u| {
                let (r, cosine) = (range[0] + (range[1] - range[0]) * u[0], 2.0 * u[1] - 1.0);
                let (sine, turn) = ((1.0 - cosine * cosine).sqrt(), 2.0 * PI * u[2]);
                [r * sine * turn.cos(), r * sine * turn.sin(), r * cosine]
            })
            .collect();
        let places: Vec<f64> = separations.iter().flat_map(|d| [0, 1, 2].map(|a| at[a] + d[a])).collect();
        for (d, mut force) in separations.iter().zip(felt(&mut fft, &at, None, &places, law, window)) {
            let r = norm(*d);
            let truth = ewald(d.map(|d| d / side), 2.0).map(|pull| pull * side / (4.0 * PI));
            if tree {
                let u = r / (2.0 * law.split_scale);
                let near = libm::erfc(u) + 2.0 * u / PI.sqrt() * (-u * u).exp();
                let newton = side.powi(3) / (4.0 * PI * r * r);
                (0..3).for_each(|a| force[a] -= near * newton * d[a] / r);
            }
            let error = norm([0, 1, 2].map(|a| force[a] - truth[a])) / norm(truth);
            let radial = -(0..3).map(|a| force[a] * d[a]).sum::<f64>() / r / norm(truth);
            all.push(Pair { r, radial, error });
        }
    }
    all
}

/// Of the pairs with separations in `within`: how far the mean force is from the true one, the r.m.s. error of a pair, and the worst.
fn errors(pairs: &[Pair], within: [f64; 2]) -> [f64; 3] {
    let chosen = || pairs.iter().filter(|pair| (within[0]..within[1]).contains(&pair.r));
    let count = chosen().count() as f64;
    let mean = chosen().map(|pair| pair.radial - 1.0).sum::<f64>() / count;
    let square = chosen().map(|pair| pair.error * pair.error).sum::<f64>() / count;
    [mean.abs(), square.sqrt(), chosen().fold(0.0, |worst, pair| pair.error.max(worst))]
}

const BEYOND_THREE_CELLS: [[f64; 2]; 5] = [[3.0, 3.5], [3.5, 4.0], [4.0, 6.0], [6.0, 10.0], [10.0, 16.0]];

/// FastPM's default.
fn four_point() -> ForceLaw {
    ForceLaw { gradient: Difference::FourPoint, ..ForceLaw::default() }
}

#[test]
fn mean_pair_forces_are_newtons_to_two_per_cent_beyond_three_cells() {
    let two_point =
        ForceLaw { laplacian: Difference::TwoPoint, gradient: Difference::TwoPoint, ..ForceLaw::default() };
    for window in [Window::CloudInCell, Window::TriangularShapedCloud, Window::PiecewiseCubicSpline] {
        for law in [four_point(), two_point] {
            let pairs = pairs(&law, window, [3.0, 16.0], false);
            for within in BEYOND_THREE_CELLS {
                let [mean, ..] = errors(&pairs, within);
                assert!(mean < 0.02, "{window:?} {law:?} {within:?}: {mean}");
            }
        }
    }
}

#[test]
fn single_pair_forces_are_newtons_to_two_per_cent_beyond_three_cells() {
    // R.m.s. over places and directions. CIC does not reach it (5% at 3 cells), nor do two-point gradients
    // (6%), nor exact ones that nothing smooths, which ring along the axes.
    let window = Window::PiecewiseCubicSpline;
    let smoothed = ForceLaw { window: Some((window, 1)), split_scale: 0.53, ..four_point() };
    let both = ForceLaw { laplacian: Difference::FourPoint, ..four_point() };
    for (law, window) in [(smoothed, window), (both, window), (both, Window::TriangularShapedCloud)] {
        let pairs = pairs(&law, window, [3.0, 16.0], false);
        for within in BEYOND_THREE_CELLS {
            let [mean, rms, worst] = errors(&pairs, within);
            assert!(mean < 0.01 && rms < 0.02, "{law:?} {within:?}: {mean} {rms}");
            // The worst of 8000 pairs.
            let limit = if within[0] < 3.5 { 0.032 } else { 0.021 };
            assert!(worst < limit || law.window.is_none(), "{within:?}: {worst}");
        }
    }
}

#[test]
fn tree_and_mesh_make_newtons_force() {
    let every = [[0.5, 1.0], [1.0, 2.0], [2.0, 3.0], [3.0, 4.0], [4.0, 6.0], [6.0, 8.0]];
    // Dispersions of the split in cells; r.m.s. and worst error of a pair. Gadget's 1.25 leaves the mesh a per cent to get wrong, a wider one less.
    for (split_scale, rms_limit, worst_limit) in [(1.25, 0.015, 0.04), (2.0, 0.005, 0.015)] {
        let window = Window::CloudInCell;
        let law = ForceLaw { window: Some((window, 2)), split_scale, ..four_point() };
        let pairs = pairs(&law, window, [0.5, 8.0], true);
        for within in every {
            let [mean, rms, worst] = errors(&pairs, within);
            assert!(
                mean < 0.005 && rms < rms_limit && worst < worst_limit,
                "{within:?}: {mean} {rms} {worst}"
            );
        }
    }
}

#[test]
fn dividing_by_the_window_takes_its_smoothing_away() {
    for (window, smoothed) in [(Window::CloudInCell, 0.04), (Window::TriangularShapedCloud, 0.06)] {
        let law = ForceLaw { split_scale: 1.25, ..four_point() };
        let sharp = ForceLaw { window: Some((window, 2)), ..law };
        let [blunt, sharp] =
            [law, sharp].map(|law| errors(&pairs(&law, window, [2.0, 4.0], true), [2.0, 4.0]));
        assert!(blunt[0] > smoothed && sharp[0] < 0.005, "{window:?}: {blunt:?} {sharp:?}");
        assert!(sharp[1] < 0.4 * blunt[1], "{window:?}: {blunt:?} {sharp:?}");
    }
}
