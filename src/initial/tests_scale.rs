//! Particles of small parts of meshes that no memory holds.

use std::vec;

use super::modes::scale_by_table;
use super::particles::{Components, Step, displace, particle_ids};
use crate::cosmology::mode_table_length;
use crate::exec::Serial;
use crate::mesh::{Brick, LARGEST_SIDE, Space};
use crate::status::Error;

/// The last 2 x 3 x 4 cells or modes of a mesh.
fn corner(n: usize, space: Space) -> Brick {
    let last = if space == Space::Configuration { n } else { n / 2 + 1 };
    Brick::general(n, space, [n - 2, n - 3, last - 4], [2, 3, 4], [12, 4, 1]).unwrap()
}

#[test]
fn ids_reach_2_63() {
    for n in [1_000_000, LARGEST_SIDE] {
        let brick = corner(n, Space::Configuration);
        let cells = (n as u64).pow(3);
        let mut ids = vec![0; brick.elements()];
        particle_ids(&mut ids, &brick, 1, &Serial).unwrap();
        assert_eq!(ids[brick.elements() - 1], cells);
        assert_eq!(ids[0], cells - 3 - 2 * n as u64 - (n as u64).pow(2));
        particle_ids(&mut ids, &brick, u64::MAX - cells, &Serial).unwrap();
        assert_eq!(ids[brick.elements() - 1], u64::MAX - 1);
        assert_eq!(particle_ids(&mut ids, &brick, u64::MAX - cells + 1, &Serial), Err(Error::Overflow));
    }
}

#[test]
fn the_last_cells_of_the_largest_mesh_move_round_the_box() {
    let n = LARGEST_SIDE;
    let brick = corner(n, Space::Configuration);
    let step = Step { box_size: n as f64, first_velocity: 2.0, second_velocity: 4.0 };
    let psi1 = vec![2.5_f64; brick.reals()];
    let psi2 = vec![0.25; brick.reals()];
    for axis in 0..3 {
        let (mut place, mut speed) = (vec![-1.0; 3 * brick.elements()], vec![0.0; 3 * brick.elements()]);
        let position = &mut Components::triples(&mut place).unwrap();
        let velocity = &mut Components::triples(&mut speed).unwrap();
        displace(position, velocity, &psi1, Some(&psi2), &brick, axis, &step, &Serial).unwrap();
        for (i, (place, speed)) in place.chunks(3).zip(speed.chunks(3)).enumerate() {
            let local = [i / 12, i / 4 % 3, i % 4][axis];
            let q = n - brick.count()[axis] + local;
            let x = q as f64 + 2.75;
            assert_eq!(place[axis], if x >= n as f64 { x - n as f64 } else { x });
            assert_eq!(speed[axis], 6.0);
        }
    }
}

#[test]
fn tables_by_square_have_a_length_at_any_size() {
    assert_eq!(mode_table_length(1_000_000), Ok(750_000_000_001));
    assert_eq!(mode_table_length(LARGEST_SIDE), Ok(3 * (1 << 40) + 1));
    assert_eq!(mode_table_length(LARGEST_SIDE + 2), Err(Error::Overflow));
    assert_eq!(mode_table_length(usize::MAX - 1), Err(Error::Overflow));
    let brick = corner(LARGEST_SIDE, Space::Fourier);
    let mut modes = vec![1.0; brick.reals()];
    assert_eq!(scale_by_table(&mut modes, &brick, &[1.0; 100], &Serial), Err(Error::Length));
}
