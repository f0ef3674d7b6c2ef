//! Against the slow twin, and bit for bit over layouts, threads and precision.

use std::format;
use std::vec;
use std::vec::Vec;

use super::*;
use crate::estimate::binning::Second;
use crate::estimate::correlation::{correlation_sums, correlation_sums_scratch};
use crate::estimate::power::power_sums_on;
use crate::exec::Threads;
use crate::mesh::Space;
use crate::pm::Window;
use crate::reference::power::{Slow, correlation, power};
use crate::simd::Simd;
use crate::status::Error;

const AXES: [[f64; 3]; 5] =
    [[0.0, 0.0, 1.0], [0.0, 3.3, 0.0], [-2.0, 0.0, 0.0], [1.0, 2.0, 3.0], [0.3, -0.8, 0.01]];

fn seconds() -> [Second<'static>; 5] {
    [
        Second::None,
        Second::Cosine(&[0.0, 0.21, 0.43, 0.77, 1.0]),
        Second::Cosine(&[0.11, 0.52, 0.9]),
        Second::Parallel(&[0.0, 1.0, 2.3, 8.0]),
        Second::Parallel(&[1.0, 1.7, 4.0]),
    ]
}

/// The bins of `words` are the twin's: `count` the same, means and sums to rounding.
fn agree(words: &[i64], binning: &Binning<'_>, spectra: &[Vec<Slow>], what: &str) {
    let (bins, values) = read(words, binning, spectra.len());
    let orders: Vec<usize> = (0..5).filter(|l| binning.orders >> l & 1 == 1).collect();
    for (bin, slow) in bins.iter().zip(&spectra[0]) {
        assert_eq!(bin.count, slow.count, "{what}");
        let count = slow.count.max(1) as f64;
        // 2^-40 a run in the fixed-point sums; and |n.a| = 0 may come out as 1e-16, the root of n_perp^2 = 0 as 1e-8.
        assert!((bin.first - slow.first / count).abs() < 1e-7, "{what}: {bin:?} {slow:?}");
        assert!((bin.second - slow.second / count).abs() < 1e-11, "{what}: {bin:?} {slow:?}");
    }
    let each = bins.len() * orders.len();
    for (values, slow) in values.chunks_exact(each).zip(spectra) {
        // A few thousand roundings of terms that do not exceed the largest bin's sum.
        let scale = slow.iter().flat_map(|bin| bin.sums[0]).fold(0.0, |m: f64, x| m.max(x.abs()));
        for (values, slow) in values.chunks_exact(orders.len()).zip(slow) {
            for (&value, &order) in values.iter().zip(&orders) {
                let expected = slow.sums[order][order % 2];
                assert!((value - expected).abs() <= 1e-12 * scale, "{what} l = {order}: {value} {expected}");
            }
        }
    }
}

#[test]
fn sweeps_equal_the_slow_twin() {
    let edges = [0, 1, 4, 7, 20, 21, 37, 60, 500];
    let comp = [
        Compensation::None,
        Compensation::Aliased(Window::TriangularShapedCloud),
        Compensation::Window(Window::CloudInCell),
    ];
    for n in [2, 6, 10] {
        let brick = *serial::<f64>(n).fourier();
        let fields = [1, 2, 3].map(|seed| random_modes(n, seed));
        let views = [&fields[0][..], &fields[1], &fields[2]];
        let pairs = [[0, 0], [0, 1], [2, 1]];
        for axis in AXES {
            for second in seconds() {
                for orders in [1, 0b10101, 0b11111, 0b01010, 0b00100] {
                    let binning = Binning { edges: &edges, second, axis, orders };
                    let words = sums(&views, &pairs, &comp, &brick, &binning, &Serial);
                    let slow = pairs.map(|[f, g]| power(views[f], views[g], [comp[f], comp[g]], n, &binning));
                    agree(&words, &binning, &slow, &format!("n = {n}, {binning:?}"));
                }
            }
        }
    }
}

#[test]
fn correlation_sums_equal_the_slow_twin() {
    let edges = [0, 1, 4, 7, 20, 21, 37, 500];
    for n in [2, 6, 8] {
        let brick = Brick::whole(n, Space::Configuration).unwrap();
        let mut next = noise(5);
        let meshes = [(); 2].map(|()| (0..brick.reals()).map(|_| next()).collect::<Vec<f64>>());
        for axis in AXES {
            for second in seconds() {
                let binning = Binning { edges: &edges, second, axis, orders: 0b11111 };
                let mut words = vec![0; binning.words(2).unwrap()];
                let scratch = memory(correlation_sums_scratch(&brick, &binning, 2).unwrap());
                let views = [&meshes[0][..], &meshes[1]];
                correlation_sums(&mut words, &views, &brick, &binning, scratch, &Serial).unwrap();
                let slow = views.map(|xi| {
                    let mut slow = correlation(xi, n, &binning);
                    // The twin adds xi as real and imaginary part alike.
                    slow.iter_mut().for_each(|bin| bin.sums.iter_mut().for_each(|s| s[1] = s[0]));
                    slow
                });
                let (bins, values) = read(&words, &binning, 2);
                for (m, slow) in slow.iter().enumerate() {
                    for (b, slow) in slow.iter().enumerate() {
                        assert_eq!(bins[b].count, slow.count);
                        for l in 0..5 {
                            let value = values[(m * bins.len() + b) * 5 + l];
                            assert!((value - slow.sums[l][0]).abs() < 1e-12 * (n * n * n) as f64);
                        }
                    }
                }
            }
        }
    }
}

#[test]
fn unit_shells_hold_the_published_numbers_of_modes() {
    let brick = Brick::whole(16, Space::Fourier).unwrap();
    let field = vec![1.0; brick.reals()];
    let edges = unit_shells(1, 7);
    let binning = Binning::shells(&edges);
    let words = sums(&[&field], &[[0, 0]], &[Compensation::None], &brick, &binning, &Serial);
    let (bins, values) = read(&words, &binning, 1);
    assert_eq!(bins.iter().map(|b| b.count).collect::<Vec<_>>(), [26, 66, 158, 234, 410, 470]);
    assert!(bins.iter().zip(values).all(|(bin, value)| value == 2.0 * bin.count as f64));
    // 6 modes of |n| = 1, 12 of sqrt 2, 8 of sqrt 3.
    let mean = (6.0 + 12.0 * 2.0_f64.sqrt() + 8.0 * 3.0_f64.sqrt()) / 26.0;
    assert!((bins[0].first - mean).abs() < 1e-11);
}

#[test]
fn every_square_can_be_a_bin_of_its_own() {
    let brick = Brick::whole(8, Space::Fourier).unwrap();
    let field = vec![1.0_f32; brick.reals()];
    let mut edges = [0; 50];
    crate::estimate::edges::exact_edges(&mut edges, 0).unwrap();
    let binning = Binning::shells(&edges);
    let words = sums(&[&field], &[[0, 0]], &[Compensation::None], &brick, &binning, &Serial);
    let (bins, _) = read(&words, &binning, 1);
    assert_eq!(bins.iter().map(|bin| bin.count).sum::<u64>(), 512, "all modes, k and -k");
    for (square, bin) in bins.iter().enumerate() {
        assert!(bin.count == 0 || (bin.first - (square as f64).sqrt()).abs() < 1e-11);
    }
    assert_eq!([7, 15, 23].map(|square: usize| bins[square].count), [0; 3], "no sums of three squares");
}

/// The same modes in another layout.
fn cut(field: &[f64], whole: &Brick, part: &Brick) -> Vec<f64> {
    let mut out = vec![0.0; part.reals()];
    let (start, count) = (part.start(), part.count());
    for a in 0..count[0] {
        for b in 0..count[1] {
            for c in 0..count[2] {
                let (w, p) = (whole.stride(), part.stride());
                let from = (start[0] + a) * w[0] + (start[1] + b) * w[1] + (start[2] + c) * w[2];
                let to = a * p[0] + b * p[1] + c * p[2];
                out[2 * to..2 * to + 2].copy_from_slice(&field[2 * from..2 * from + 2]);
            }
        }
    }
    out
}

#[test]
fn slabs_in_any_order_add_up_to_the_whole_bit_for_bit() {
    let n = 18;
    let whole = *serial::<f64>(n).fourier();
    let fields = [11, 12].map(|seed| random_modes(n, seed));
    let compensation = [Compensation::Aliased(Window::CloudInCell), Compensation::None];
    let pairs = [[0, 0], [0, 1]];
    let edges = unit_shells(0, 16);
    for (second, axis) in seconds().into_iter().zip([
        [0.0, 0.0, 1.0],
        [1.0, 0.0, 0.0],
        [0.0, 0.0, 1.0],
        [1.0, 1.0, 0.5],
        AXES[0],
    ]) {
        let binning = Binning { edges: &edges, second, axis, orders: 0b11111 };
        let measure = |part: &Brick| {
            let parts = fields.each_ref().map(|field| cut(field, &whole, part));
            sums(&[&parts[0], &parts[1]], &pairs, &compensation, part, &binning, &Serial)
        };
        let one = measure(&whole);
        let slab = |first, planes| Brick::slab(n, Space::Fourier, first, planes).unwrap();
        let turned = |first, rows| Brick::transposed_slab(n, first, rows).unwrap();
        let rows = n / 2 + 1;
        let general = |start, count, stride| Brick::general(n, Space::Fourier, start, count, stride).unwrap();
        let cuts: [Vec<Brick>; 5] = [
            vec![slab(7, 11), slab(0, 7)],
            (0..n).rev().map(|x| slab(x, 1)).collect(),
            vec![turned(5, 1), turned(6, 12), turned(0, 5)],
            vec![general([0; 3], [n, n, rows], [1, n, n * n])],
            // Blocks of x and y with other strides, and an empty one.
            vec![
                general([0; 3], [9, n, rows], [rows * n + 5, rows, 1]),
                general([9, 4, 0], [9, 14, rows], [rows, 9 * rows, 1]),
                general([9, 0, 0], [9, 4, rows], [2, 30, 200]),
                slab(18, 0),
            ],
        ];
        for bricks in cuts {
            let mut added = vec![0_i64; one.len()];
            for brick in &bricks {
                added.iter_mut().zip(measure(brick)).for_each(|(sum, word)| *sum += word);
            }
            let (bins, values) = read(&added, &binning, 2);
            let (expected, spectrum) = read(&one, &binning, 2);
            assert_eq!(bins, expected);
            assert!(values.iter().zip(spectrum).all(|(a, b)| a.to_bits() == b.to_bits()));
        }
        // Pencils that cut axis 2 cut runs: to rounding.
        let mut added = vec![0_i64; one.len()];
        for (first, rows) in [(4, rows - 4), (0, 4)] {
            let pencil = general([0, 0, first], [n, n, rows], [rows * n, rows, 1]);
            added.iter_mut().zip(measure(&pencil)).for_each(|(sum, word)| *sum += word);
        }
        let ((bins, values), (expected, spectrum)) = (read(&added, &binning, 2), read(&one, &binning, 2));
        assert!(bins.iter().zip(expected).all(|(a, b)| a.count == b.count));
        assert!(values.iter().zip(spectrum).all(|(a, b)| (a - b).abs() < 1e-14 * 1e7));
    }
}

#[test]
fn threads_code_paths_and_precision_do_not_change_a_bit() {
    let n = 20;
    let brick = *serial::<f64>(n).fourier();
    let single: Vec<f32> = random_modes(n, 4).iter().map(|&x| x as f32).collect();
    let double: Vec<f64> = single.iter().map(|&x| f64::from(x)).collect();
    let edges = unit_shells(1, 12);
    let compensation = [Compensation::Window(Window::PiecewiseCubicSpline)];
    for second in seconds() {
        let binning = Binning { edges: &edges, second, axis: [0.2, 0.5, -1.0], orders: 0b11111 };
        let one = sums(&[&double], &[[0, 0]], &compensation, &brick, &binning, &Serial);
        for threads in [1, 2, 5] {
            let pool = Threads::new(threads).unwrap();
            assert_eq!(sums(&[&double], &[[0, 0]], &compensation, &brick, &binning, &pool), one);
        }
        assert_eq!(sums(&[&single], &[[0, 0]], &compensation, &brick, &binning, &Serial), one);
        let mut words = vec![0; one.len()];
        let scratch = memory(power_sums_scratch(&brick, &binning, 1).unwrap());
        power_sums_on(
            &mut words,
            &[&double],
            &[[0, 0]],
            &compensation,
            &brick,
            &binning,
            scratch,
            &Serial,
            Simd::Portable,
        )
        .unwrap();
        assert_eq!(words, one);
    }
}

#[test]
fn sums_of_calls_add_up() {
    let n = 6;
    let brick = *serial::<f64>(n).fourier();
    let edges = unit_shells(1, 4);
    let binning = Binning::shells(&edges);
    let field = random_modes(n, 9);
    let none = [Compensation::None];
    let one = sums(&[&field], &[[0, 0]], &none, &brick, &binning, &Serial);
    let mut twice = one.clone();
    let scratch = memory(power_sums_scratch(&brick, &binning, 1).unwrap());
    power_sums(&mut twice, &[&field], &[[0, 0]], &none, &brick, &binning, scratch, &Serial).unwrap();
    let ((bins, values), (twice, doubled)) = (read(&one, &binning, 1), read(&twice, &binning, 1));
    assert!(bins.iter().zip(twice).all(|(a, b)| 2 * a.count == b.count && a.first == b.first));
    assert!(values.iter().zip(doubled).all(|(a, b)| 2.0 * a == b));
}

#[test]
fn what_is_wrong_is_refused_and_nothing_is_added() {
    let n = 4;
    let brick = Brick::whole(n, Space::Fourier).unwrap();
    let cells = Brick::whole(n, Space::Configuration).unwrap();
    let mut field = vec![0.5; brick.reals()];
    let edges = [1, 4, 9];
    let good = Binning::shells(&edges);
    let bad = |edges, second, axis, orders| Binning { edges, second, axis, orders }.bins();
    let z = [0.0, 0.0, 1.0];
    assert_eq!(bad(&[1], Second::None, z, 1), Err(Error::Table));
    assert_eq!(bad(&[4, 4], Second::None, z, 1), Err(Error::Table));
    assert_eq!(bad(&[], Second::None, z, 1), Err(Error::Table));
    assert_eq!(bad(&edges, Second::Cosine(&[]), z, 1), Err(Error::Table));
    assert_eq!(bad(&edges, Second::Cosine(&[0.0]), z, 1), Err(Error::Table));
    assert_eq!(bad(&edges, Second::Cosine(&[0.0, 1.1]), z, 1), Err(Error::Table));
    assert_eq!(bad(&edges, Second::Cosine(&[-0.1, 1.0]), z, 1), Err(Error::Table));
    assert_eq!(bad(&edges, Second::Cosine(&[0.5, 0.5]), z, 1), Err(Error::Table));
    assert_eq!(bad(&edges, Second::Parallel(&[0.0, f64::NAN]), z, 1), Err(Error::NotFinite));
    assert_eq!(bad(&edges, Second::None, [0.0; 3], 1), Err(Error::Range));
    assert_eq!(bad(&edges, Second::None, [0.0, f64::INFINITY, 0.0], 1), Err(Error::NotFinite));
    assert_eq!(bad(&edges, Second::None, z, 0), Err(Error::Range));
    assert_eq!(bad(&edges, Second::None, z, 32), Err(Error::Range));
    assert_eq!(good.words(0), Err(Error::Length));
    assert_eq!(good.words(usize::MAX / 8), Err(Error::Overflow));
    assert_eq!(power_sums_scratch(&cells, &good, 1), Err(Error::Brick));
    assert_eq!(correlation_sums_scratch(&brick, &good, 1), Err(Error::Brick));
    let mut words = vec![7; good.words(1).unwrap()];
    let scratch = memory(power_sums_scratch(&brick, &good, 1).unwrap());
    let none = [Compensation::None];
    let run = |words: &mut [i64], field: &[f64], pairs: &[[usize; 2]], scratch: &mut [u8]| {
        power_sums(words, &[field], pairs, &none, &brick, &good, scratch, &Serial)
    };
    let less = words.len() - 1;
    assert_eq!(run(&mut words[..less], &field, &[[0, 0]], scratch), Err(Error::Length));
    assert_eq!(run(&mut words, &field[1..], &[[0, 0]], scratch), Err(Error::Length));
    assert_eq!(run(&mut words, &field, &[[0, 1]], scratch), Err(Error::Range));
    assert_eq!(run(&mut words, &field, &[], scratch), Err(Error::Length));
    let short = scratch.len() - 1;
    assert_eq!(run(&mut words, &field, &[[0, 0]], &mut scratch[..short]), Err(Error::Scratch));
    assert_eq!(words, vec![7; words.len()]);
    words.fill(0);
    // One NaN among the modes of the second shell.
    field[2 * 2] = f64::NAN;
    run(&mut words, &field, &[[0, 0]], scratch).unwrap();
    let (mut bins, mut values) = ([Bin::default(); 2], [3.0; 2]);
    assert_eq!(read_sums(&mut bins, &mut values, &words, &good, 1), Err(Error::NotFinite));
    assert_eq!((values, bins), ([3.0; 2], [Bin::default(); 2]));
    assert_eq!(read_sums(&mut bins, &mut values[1..], &words, &good, 1), Err(Error::Length));
    assert_eq!(normalise(&mut values, &bins, 1, f64::NAN), Err(Error::NotFinite));
    assert_eq!(normalise(&mut values, &bins, 3, 1.0), Err(Error::Length));
    assert_eq!(normalise(&mut [], &[], 1, 1.0), Err(Error::Length));
    // Words that no sum can hold do not panic.
    words.fill(i64::MIN);
    let _ = read_sums(&mut bins, &mut values, &words, &good, 1);
    words.fill(i64::MAX);
    field.fill(1.0);
    run(&mut words, &field, &[[0, 0]], scratch).unwrap();
    let _ = read_sums(&mut bins, &mut values, &words, &good, 1);
}
