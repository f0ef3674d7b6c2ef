//! Forces between particles: deposit, force, read-out, against Newton.

use super::*;
use crate::fft::{Fft3, Transform};
use crate::reference::built::serial;
use crate::reference::force::{ewald, norm};
use core::f64::consts::PI;

const N: usize = 32;

#[test]
fn explore() {
    for n in [32, 64] {
        let mut fft = serial::<f64>(n);
        for window in Window::ALL {
            for power in [0, 1, 2] {
                for (l, g) in [(0, 0), (0, 2), (0, 1), (1, 2), (2, 2), (1, 1)] {
                    let law = ForceLaw {
                        laplacian: l.try_into().unwrap(),
                        gradient: g.try_into().unwrap(),
                        window: (power > 0).then_some((window, power)),
                        split_scale: 0.0,
                    };
                    let pairs = pairs(&mut fft, &law, window, [3.0, n as f64 / 4.0], 20, 400);
                    let mut line = std::format!("{n} {window:?} {power} {l}{g}: ");
                    for (from, to) in
                        [(3.0, 3.5), (3.5, 4.0), (4.0, 5.0), (5.0, 6.0), (6.0, 8.0), (8.0, 16.0)]
                    {
                        let within: Vec<&Pair> = pairs.iter().filter(|p| p.r >= from && p.r < to).collect();
                        if within.is_empty() {
                            continue;
                        }
                        let mean = within.iter().map(|p| p.radial).sum::<f64>() / within.len() as f64;
                        let rms = (within.iter().map(|p| p.error * p.error).sum::<f64>()
                            / within.len() as f64)
                            .sqrt();
                        let worst = within.iter().fold(0.0, |w: f64, p| w.max(p.error));
                        line += &std::format!(
                            " [{:+.3} {:.3} {:.3}]%",
                            100.0 * (mean - 1.0),
                            100.0 * rms,
                            100.0 * worst
                        );
                    }
                    std::println!("{line}");
                }
            }
        }
    }
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

/// Forces of single particles of all the mass, at `sources` random places of a box of n cells, on `targets` others each, at separations in `range`, uniform
/// in r, in random directions; against Ewald's.
fn pairs(
    fft: &mut Transform<'_, f64>,
    law: &ForceLaw,
    window: Window,
    range: [f64; 2],
    sources: usize,
    targets: usize,
) -> Vec<Pair> {
    let n = fft.configuration().n();
    let side = n as f64;
    let mut all = Vec::new();
    for source in 0..sources {
        let numbers = random(3 + 3 * targets, 1 + source as u64);
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
        let forces = felt(fft, &at, None, &places, law, window);
        for (d, force) in separations.iter().zip(forces) {
            let r = norm(*d);
            let mut expect = ewald(d.map(|d| d / side), 2.0).map(|pull| pull * side / (4.0 * PI));
            if law.split_scale > 0.0 {
                // What the tree adds, moved to the other side.
                let u = r / (2.0 * law.split_scale);
                let near = libm::erfc(u) + 2.0 * u / PI.sqrt() * (-u * u).exp();
                let newton = side.powi(3) / (4.0 * PI * r * r);
                for a in 0..3 {
                    expect[a] += near * newton * d[a] / r;
                }
            }
            let whole = norm(ewald(d.map(|d| d / side), 2.0)) * side / (4.0 * PI);
            let error = norm([0, 1, 2].map(|a| force[a] - expect[a])) / whole;
            let along: f64 = (0..3).map(|a| (force[a] - expect[a]) * d[a] / r).sum();
            all.push(Pair { r, radial: 1.0 - along / whole, error });
        }
    }
    all
}

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
