//! Noise of small parts of meshes that no memory holds: up to 2^63 cells.

use std::vec;
use std::vec::Vec;

use super::tests::{bits, modes, same_bits, signed, white, whole};
use super::*;
use crate::exec::Serial;
use crate::mesh::{Brick, LARGEST_SIDE, Space};
use crate::reference::white::white_mode;
use crate::status::Error;

const SIDES: [usize; 3] = [1_000_000, 1 << 20, LARGEST_SIDE];

/// Bricks of 4 x 4 columns at the origin, about the Nyquist planes and at the far corner, with l contiguous and outermost.
fn parts(n: usize) -> Vec<Brick> {
    let mut parts = vec![];
    let starts = [0, n / 2 - 2, n - 4];
    for x in starts {
        for y in starts {
            // Rows long enough for vectors; the last one ends on the Nyquist plane.
            for l in [0, 12_345, n / 2 + 1 - 40] {
                for stride in [[160, 40, 1], [1, 4, 16]] {
                    parts.push(Brick::general(n, Space::Fourier, [x, y, l], [4, 4, 40], stride).unwrap());
                }
            }
        }
    }
    parts
}

#[test]
fn modes_of_a_mesh_of_10_18_cells_are_those_of_the_slow_reference() {
    let choices = [
        Realisation::new(5),
        Realisation { amplitude: Amplitude::Fixed, nyquist: Nyquist::Filled, ..Realisation::new(6) },
        Realisation { phase: Phase::Inverted, nyquist: Nyquist::Filled, ..Realisation::new(u64::MAX) },
    ];
    for n in SIDES {
        for brick in parts(n) {
            for choice in &choices {
                let mesh = white::<f64>(&brick, choice);
                for (index, at) in modes(&brick) {
                    let expected = white_mode(n as i64, signed(n, index), choice);
                    let scale = if expected[1] == 0.0 { 8.6 } else { expected[0].hypot(expected[1]) };
                    for part in 0..2 {
                        // As for small meshes: the number of a mode goes into the generator alone.
                        let error = (mesh[at + part] - expected[part]).abs();
                        assert!(error <= 1.5e-15 * scale, "n = {n}, {index:?}, {choice:?}");
                    }
                }
            }
        }
    }
}

#[test]
fn the_largest_mesh_shares_its_modes_with_a_small_one() {
    let small = 32;
    let choice = Realisation { amplitude: Amplitude::Fixed, ..Realisation::new(77) };
    let coarse = white::<f32>(&whole(small), &choice);
    let stride = whole(small).stride();
    for n in SIDES {
        for x in [0, n - 6] {
            for y in [0, n - 6] {
                let brick = Brick::general(n, Space::Fourier, [x, y, 0], [6, 6, 14], [90, 15, 1]).unwrap();
                let fine = white::<f32>(&brick, &choice);
                for (index, at) in modes(&brick) {
                    let [i, j, l] = signed(n, index);
                    let [i, j] = [i, j].map(|m| m.rem_euclid(small as i64) as usize);
                    let there = 2 * (i * stride[0] + j * stride[1] + l as usize);
                    assert_eq!(bits(fine[at]), bits(coarse[there]), "{index:?}");
                    assert_eq!(bits(fine[at + 1]), bits(coarse[there + 1]), "{index:?}");
                }
            }
        }
    }
}

#[test]
fn selections_are_squared_without_overflow() {
    for n in SIDES {
        let brick =
            Brick::general(n, Space::Fourier, [n / 2 - 2, n / 2 + 1, n / 2 - 3], [2, 2, 4], [8, 4, 1]);
        let brick = brick.unwrap();
        let all = Realisation { nyquist: Nyquist::Filled, ..Realisation::new(3) };
        for selection in [Selection::Cube, Selection::Sphere] {
            let drawn = white::<f64>(&brick, &Realisation { selection, sample: u32::MAX, ..all });
            assert!(same_bits(&drawn, &white(&brick, &all)), "beyond the mesh");
            let none = white::<f64>(&brick, &Realisation { selection, sample: 10, ..all });
            assert!(none.iter().all(|x| x.to_bits() == 0), "far outside");
        }
        // The corner of the cube is sqrt(3) times as far as the sphere reaches.
        let sphere =
            white::<f64>(&brick, &Realisation { selection: Selection::Sphere, sample: n as u32, ..all });
        assert!(sphere.iter().all(|x| x.to_bits() == 0));
    }
}

#[test]
fn a_table_for_every_square_is_asked_for_at_any_size() {
    let brick = Brick::general(LARGEST_SIDE, Space::Fourier, [0; 3], [1, 1, 8], [8, 8, 1]).unwrap();
    let mut out = vec![7.0; brick.reals()];
    let result = white_modes_coloured(&mut out, &brick, &Realisation::new(1), &[1.0; 1000], &Serial);
    assert_eq!(result, Err(Error::Length));
    assert!(out.iter().all(|&x| x == 7.0));
}
