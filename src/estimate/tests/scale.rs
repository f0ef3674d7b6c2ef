//! Small parts of meshes that no memory holds, and numbers and bins as no survey should have them.

use super::super::binning::Second;
use super::*;
use crate::mesh::{LARGEST_SIDE, Space};
use crate::status::Error;

const SMALL: usize = 16;

/// Signed mode numbers -3 .. 3 of axes 0 and 1 and 0 .. 5 of axis 2 as bricks: four corners of the mesh.
fn corners(n: usize) -> Vec<Brick> {
    let mut corners = vec![];
    for (x, columns) in [(0, 4), (n - 3, 3)] {
        for (y, rows) in [(0, 4), (n - 3, 3)] {
            let stride = [6 * rows, 6, 1];
            corners.push(Brick::general(n, Space::Fourier, [x, y, 0], [columns, rows, 6], stride).unwrap());
        }
    }
    corners
}

/// Sums over the corners of a field that depends on signed mode numbers alone.
fn sums_of_corners(n: usize, binning: &Binning<'_>) -> Vec<i64> {
    let mut all = vec![0_i64; binning.words(1).unwrap()];
    for brick in corners(n) {
        let (start, count) = (brick.start(), brick.count());
        let mut field = vec![0.0; brick.reals()];
        for (e, mode) in field.as_chunks_mut::<2>().0.iter_mut().enumerate() {
            let [a, b, c] = [e / (count[1] * count[2]), e / count[2] % count[1], e % count[2]];
            let [i, j] = [Brick::mode(n, start[0] + a), Brick::mode(n, start[1] + b)];
            *mode = [1.0 + i as f64 / 3.0, 0.7 * j as f64 - c as f64 / 7.0];
        }
        let words = sums(&[&field], &[[0, 0]], &[Compensation::None], &brick, binning, &Serial);
        all.iter_mut().zip(&words).for_each(|(all, word)| *all = all.wrapping_add(*word));
    }
    all
}

#[test]
fn power_of_a_part_of_the_largest_mesh_is_that_of_a_small_one() {
    let edges = [1, 4, 9, 16, 43];
    let orders = 0b10101;
    let wedges = [0.0, 0.5, 1.0];
    let about = |second, axis| Binning { edges: &edges, second, axis, orders };
    let all = [
        Binning::shells(&edges),
        about(Second::Cosine(&wedges), [0.0, 0.0, 1.0]),
        about(Second::Parallel(&[0.0, 2.0, 6.0]), [1.0, 2.0, -1.0]),
    ];
    for binning in all {
        let expect = sums_of_corners(SMALL, &binning);
        for n in [1_000_000, LARGEST_SIDE] {
            assert_eq!(sums_of_corners(n, &binning), expect, "{n} {binning:?}");
        }
    }
}

#[test]
fn scratch_of_a_part_grows_with_the_part_and_the_bins() {
    let binning = Binning::shells(&[1, 100]);
    for n in [1_000_000, LARGEST_SIDE] {
        for brick in corners(n) {
            let size = power_sums_scratch(&brick, &binning, 1).unwrap().size;
            // Factors of the compensation on each axis, and little else.
            assert!(size > 4 * n && size < 4 * n + 100_000, "{size}");
        }
    }
    // Bins far out need a table of squares, which has a size whether or not there is so much memory.
    let n = 1_000_000;
    let plane = Brick::slab(n, Space::Fourier, n / 2, 1).unwrap();
    let edges = [499_999, 500_000].map(|k: u64| k * k);
    assert!(power_sums_scratch(&plane, &Binning::shells(&edges), 1).unwrap().size > 1_000_000_000_000);
}

#[test]
fn bins_whose_sums_no_integer_holds_are_refused() {
    let refused = |n: usize, edges: &[u64]| {
        let brick = Brick::general(n, Space::Fourier, [1, 1, 1], [1; 3], [1; 3]).unwrap();
        power_sums_scratch(&brick, &Binning::shells(edges), 1).err()
    };
    assert_eq!(refused(1 << 15, &[0, u64::MAX]), None, "all 3.5 10^13 modes in one bin");
    assert_eq!(refused(1 << 17, &[0, u64::MAX]), Some(Error::Overflow));
    assert_eq!(refused(LARGEST_SIDE, &[0, 1 << 34]), Some(Error::Overflow));
    // A shell of modes as wide as one mode, at the edge of a mesh of 10^18: 4 pi k^2 of them.
    let k = 499_999_u64;
    assert_eq!(refused(1_000_000, &[k * k, (k + 1) * (k + 1)]), None);
    assert_eq!(refused(1_000_000, &[u64::MAX - 1, u64::MAX]), None, "no modes at all");
}

#[test]
fn a_mesh_of_eight_cells_has_spectra() {
    // n = 2: DC and seven self-conjugate modes.
    let modes = random_modes(2, 3);
    let (bins, values) = spectrum(&modes, 2, Compensation::None, &Binning::shells(&[0, 1, 2, 3, 4]));
    assert_eq!(bins.iter().map(|bin| bin.count).collect::<Vec<_>>(), [1, 3, 3, 1]);
    assert_eq!(values[0], modes[0] * modes[0]);
    assert!(values.iter().all(|value| value.is_finite()));
}

#[test]
fn one_mode_is_a_bin() {
    let n = SMALL;
    let modes = random_modes(n, 4);
    let brick = Brick::general(n, Space::Fourier, [3, 2, 1], [1; 3], [1; 3]).unwrap();
    let at = 2 * ((3 * n + 2) * (n / 2 + 1) + 1);
    let mode = &modes[at..at + 2];
    let binning = Binning::shells(&[14, 15]);
    let words = sums(&[mode], &[[0, 0]], &[Compensation::None], &brick, &binning, &Serial);
    let (bins, values) = read(&words, &binning, 1);
    assert_eq!(bins[0].count, 2, "it and its conjugate");
    // Sums of |n| count in units of 2^-40.
    assert!((bins[0].first - 14.0_f64.sqrt()).abs() < 1e-12);
    assert_eq!(values[0], 2.0 * (mode[0] * mode[0] + mode[1] * mode[1]));
}

#[test]
fn fields_without_power_have_none_and_empty_bins_are_zero() {
    let n = SMALL;
    let constant = modes_of(n, |_| 3.0);
    let zero = vec![0.0; constant.len()];
    let binning = Binning { orders: 0b10101, ..Binning::shells(&[0, 1, 7, 8, 100, 5000, 9000]) };
    for field in [&constant, &zero] {
        let (bins, values) = spectrum(field, n, Compensation::None, &binning);
        for (bin, values) in bins.iter().zip(values.chunks(3)) {
            // The transform of a constant is exact but for its mean.
            let expected = if bin.first == 0.0 && bin.count == 1 { field[0] * field[0] } else { 0.0 };
            assert_eq!(values[0], expected);
            assert!(values[1..].iter().all(|value| value.is_finite()));
        }
        assert_eq!(
            (bins[2].count, bins[5].count),
            (0, 0),
            "no three squares sum to 7, and the corner is at 192"
        );
        assert_eq!(bins[2].first, 0.0);
    }
    let nothing = Brick::slab(n, Space::Fourier, 5, 0).unwrap();
    let words = sums::<f64>(&[&[]], &[[0, 0]], &[Compensation::None], &nothing, &binning, &Serial);
    assert!(words.iter().all(|&word| word == 0));
}

#[test]
fn products_at_the_ends_of_the_number_range_are_summed_or_refused() {
    let brick = Brick::general(8, Space::Fourier, [1, 0, 0], [1, 1, 2], [2, 2, 1]).unwrap();
    let binning = Binning::shells(&[1, 4]);
    let power = |x: f64| {
        let field = [x, 0.0, x, 0.0];
        let words = sums(&[&field[..]], &[[0, 0]], &[Compensation::None], &brick, &binning, &Serial);
        let (mut bins, mut values) = (vec![Bin::default()], vec![7.0]);
        read_sums(&mut bins, &mut values, &words, &binning, 1).map(|()| values[0])
    };
    for x in [1e-80, 1.0, 1e98] {
        assert_eq!(power(x), Ok(3.0 * (x * x)));
    }
    // Far below 2^-640, where sums end.
    assert_eq!(power(1e-200), Ok(0.0));
    assert_eq!(power(f64::MIN_POSITIVE * f64::EPSILON), Ok(0.0));
    for x in [1e120, 1e155, 1e300, f64::INFINITY, f64::NAN] {
        assert_eq!(power(x), Err(Error::NotFinite), "{x:e}");
    }
    let extremes = [f32::MAX, f32::MIN_POSITIVE * f32::EPSILON, f32::MIN, 0.0];
    let words = sums(&[&extremes[..]], &[[0, 0]], &[Compensation::None], &brick, &binning, &Serial);
    let squares = extremes.map(|x| f64::from(x) * f64::from(x));
    assert_eq!(read(&words, &binning, 1).1, [squares[0] + squares[1] + 2.0 * squares[2]]);
}
