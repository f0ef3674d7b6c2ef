use super::*;

#[test]
fn whole_meshes_share_memory_between_the_two_spaces() {
    let cells = Brick::whole(6, Space::Configuration).unwrap();
    let modes = Brick::whole(6, Space::Fourier).unwrap();
    assert_eq!(cells.stride(), [48, 8, 1]);
    assert_eq!(modes.stride(), [24, 4, 1]);
    assert_eq!(modes.reals(), 6 * 6 * 8);
    assert!(cells.reals() <= modes.reals());
    assert!(cells.is_whole() && modes.is_whole());
    let padded = Brick::whole_padded(6, Space::Fourier, 4).unwrap();
    assert_eq!(padded.stride()[0] * 2, Brick::whole_padded(6, Space::Configuration, 4).unwrap().stride()[0]);
}

#[test]
fn mode_numbers_are_signed_and_nyquist_is_positive() {
    let numbers: std::vec::Vec<i64> = (0..6).map(|i| Brick::mode(6, i)).collect();
    assert_eq!(numbers, [0, 1, 2, 3, -2, -1]);
}

#[test]
fn bad_bricks_are_refused() {
    let general = |n, start, count, stride| Brick::general(n, Space::Configuration, start, count, stride);
    assert_eq!(general(0, [0; 3], [1; 3], [1; 3]), Err(Error::MeshSize));
    assert_eq!(general(7, [0; 3], [1; 3], [1; 3]), Err(Error::MeshSize));
    assert_eq!(general(4, [4, 0, 0], [1; 3], [1; 3]), Err(Error::Brick), "outside");
    assert_eq!(general(4, [0; 3], [4; 3], [4, 4, 1]), Err(Error::Brick), "two axes on one address");
    assert_eq!(general(4, [0; 3], [4; 3], [16, 3, 1]), Err(Error::Brick), "rows overlap");
    assert_eq!(general(4, [0; 3], [4; 3], [usize::MAX / 2, 4, 1]), Err(Error::Overflow));
    assert_eq!(general(LARGEST_SIDE + 2, [0; 3], [1; 3], [1; 3]), Err(Error::Overflow));
    assert_eq!(general(usize::MAX - 1, [0; 3], [1; 3], [1; 3]), Err(Error::Overflow));
    for space in [Space::Configuration, Space::Fourier] {
        assert_eq!(Brick::whole(usize::MAX - 1, space), Err(Error::Overflow));
        assert_eq!(Brick::whole(usize::MAX, space), Err(Error::MeshSize), "odd before too large");
        assert_eq!(Brick::whole_padded(8, space, usize::MAX / 2), Err(Error::Overflow));
    }
    assert_eq!(Brick::transposed_slab(usize::MAX - 1, 0, 1), Err(Error::Overflow));
    assert!(general(4, [4, 0, 0], [0, 4, 4], [0; 3]).is_ok_and(|brick| brick.is_empty()));
    assert!(general(4, [0; 3], [4; 3], [1, 4, 16]).is_ok(), "x innermost");
}

#[test]
fn parts_of_a_mesh_that_no_memory_holds_are_bricks() {
    for n in [1_000_000, LARGEST_SIDE] {
        let (cells, modes) = (Space::Configuration, Space::Fourier);
        assert_eq!(Brick::whole(n, cells), Err(Error::Overflow), "10^18 cells and more");
        for space in [cells, modes] {
            let plane = Brick::slab(n, space, n - 1, 1).unwrap();
            assert_eq!(plane.elements(), n * if space == cells { n } else { n / 2 + 1 });
            assert!(plane.reals() <= n * (n + 2));
            let half = Brick::slab(n, space, n / 2, n / 2);
            // n = 10^6: 5 10^17 elements of 16 bytes are less than 2^63.
            assert_eq!(half.is_ok(), n == 1_000_000);
            let last = if space == cells { n } else { n / 2 + 1 };
            let corner = Brick::general(n, space, [n - 1, n - 1, last - 1], [1; 3], [0; 3]).unwrap();
            assert_eq!(corner.reals(), space.width());
            assert!(!corner.is_whole() && !plane.is_whole());
            assert_eq!(Brick::general(n, space, [n - 1, n - 1, last], [1; 3], [0; 3]), Err(Error::Brick));
            assert_eq!(Brick::general(n, space, [n - 1, 2, 0], [2, 1, 1], [1; 3]), Err(Error::Brick));
        }
        let row = Brick::transposed_slab(n, n - 1, 1).unwrap();
        assert_eq!(row.elements(), n * (n / 2 + 1));
        assert_eq!(Brick::mode(n, n / 2), n as i64 / 2);
        assert_eq!([n / 2 + 1, n - 1].map(|index| Brick::mode(n, index)), [1 - n as i64 / 2, -1]);
    }
}

#[test]
fn strides_may_reach_beyond_32_bits_but_not_beyond_memory() {
    let far = |stride| Brick::general(8, Space::Fourier, [0; 3], [2, 2, 2], stride);
    let brick = far([1 << 40, 1 << 38, 1 << 33]).unwrap();
    assert_eq!(brick.reals(), 2 * ((1 << 40) + (1 << 38) + (1 << 33) + 1));
    assert_eq!(far([1 << 59, 1 << 38, 1]), Err(Error::Overflow));
    assert_eq!(far([usize::MAX, 1 << 38, 1]), Err(Error::Overflow));
}

#[test]
fn axes_come_innermost_first() {
    let slab = Brick::transposed_slab(8, 2, 3).unwrap();
    assert_eq!(slab.axes_by_stride(), [2, 0, 1]);
    assert_eq!(Brick::whole(8, Space::Configuration).unwrap().axes_by_stride(), [2, 1, 0]);
}
