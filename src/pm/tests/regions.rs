//! Parts of a mesh, and particles at their edges.

use super::*;

#[test]
fn translation_by_whole_cells_permutes_the_mesh() {
    let n = 12;
    let region = region_of(n);
    // Multiples of 1/64: exact before and after.
    let triples: Vec<f64> = random(3000, 6).iter().map(|x| (x * 64.0 * 12.0).floor() / 64.0).collect();
    let moved: Vec<f64> =
        triples.iter().enumerate().map(|(i, x)| (x + [5.0, 11.0, 7.0][i % 3]) % 12.0).collect();
    for (window, shift) in choices() {
        let assignment = cells(n, window, shift);
        let here = put(&region, &triples, None, &assignment, &Serial).unwrap();
        let there = put(&region, &moved, None, &assignment, &Serial).unwrap();
        for c in 0..n * n * n {
            let [x, y, z] = [(c / (n * n) + 5) % n, (c / n + 11) % n, (c % n + 7) % n];
            let moved = there[(x * n + y) * n + z];
            // Sums of up to tens of particles a cell, in another order.
            assert!((here[c] - moved).abs() <= 1e-14 * (1.0 + here[c]), "{window:?}");
        }
    }
}

#[test]
fn layouts_hold_the_same_mesh() {
    let n = 10;
    let triples = crowd::<f64>(n);
    for (window, shift) in choices() {
        let assignment = cells(n, window, shift);
        let plain = put(&region_of(n), &triples, None, &assignment, &Serial).unwrap();
        for (start, stride) in [([0; 3], [1, n, n * n]), ([0; 3], [140, 14, 1]), ([3, 9, 4], [2, 240, 24])] {
            let region = Region::new(n, start, [n; 3], stride).unwrap();
            let mesh = put(&region, &triples, None, &assignment, &Serial).unwrap();
            for c in 0..n * n * n {
                let cell = [c / (n * n), c / n % n, c % n];
                let at: usize = (0..3).map(|axis| (cell[axis] + n - start[axis]) % n * stride[axis]).sum();
                assert!((mesh[at] - plain[c]).abs() <= 1e-14 * (1.0 + plain[c]), "{window:?} {stride:?}");
            }
        }
    }
}

/// Bricks that tile the mesh: slabs, thin slabs, pencils.
fn decompositions(n: usize) -> Vec<Vec<Brick>> {
    let brick = |start: [usize; 3], count: [usize; 3]| {
        let stride = [count[1] * (n + 2), n + 2, 1];
        Brick::general(n, Space::Configuration, start, count, stride).unwrap()
    };
    let slabs = |cuts: &[usize]| {
        cuts.windows(2).map(|cut| brick([cut[0], 0, 0], [cut[1] - cut[0], n, n])).collect::<Vec<_>>()
    };
    let mut pencils = Vec::new();
    for x in [[0, 5], [5, n]] {
        for y in [[0, 3], [3, n]] {
            pencils.push(brick([x[0], y[0], 0], [x[1] - x[0], y[1] - y[0], n]));
        }
    }
    let thin: Vec<usize> = (0..=n).collect();
    vec![slabs(&[0, n]), slabs(&[0, 4, n]), slabs(&[0, 2, n - 1, n]), slabs(&thin), pencils]
}

#[test]
fn slabs_and_pencils_with_folded_ghosts_are_the_whole() {
    fn check<T: Real>(tolerance: f64) {
        let n = 12;
        let whole = region_of(n);
        let triples: Vec<T> = random(6000, 9).iter().map(|x| T::from_f64(x * n as f64)).collect();
        for (window, shift) in choices() {
            let assignment = cells(n, window, shift);
            let expect = put(&whole, &triples, None, &assignment, &Serial).unwrap();
            let read = get(&whole, &expect, &triples, &assignment, &Serial).unwrap();
            for bricks in decompositions(n) {
                let mut joined = vec![T::ZERO; whole.reals()];
                let mut owners = 0;
                for brick in &bricks {
                    // Whose a particle is: the cell that holds it.
                    let mine: Vec<usize> = (0..triples.len() / 3)
                        .filter(|&i| {
                            (0..3).all(|axis| {
                                let cell = triples[3 * i + axis].to_f64() as usize;
                                (brick.start()[axis]..brick.start()[axis] + brick.count()[axis])
                                    .contains(&cell)
                            })
                        })
                        .collect();
                    owners += mine.len();
                    let own: Vec<T> = mine.iter().flat_map(|&i| triples[3 * i..3 * i + 3].to_vec()).collect();
                    let ghosted = Region::with_ghosts(brick, window, shift).unwrap();
                    let part = put(&ghosted, &own, None, &assignment, &Serial).unwrap();
                    add_cells(&mut joined, &whole, &part, &ghosted, &Serial).unwrap();
                    // The way back: cells of the region from the whole, then the same values.
                    let mut filled = vec![T::from_f64(f64::NAN); ghosted.reals()];
                    copy_cells(&mut filled, &ghosted, &expect, &whole, &Serial).unwrap();
                    let values = get(&ghosted, &filled, &own, &assignment, &Serial).unwrap();
                    for (&i, value) in mine.iter().zip(&values) {
                        let difference = (value.to_f64() - read[i].to_f64()).abs();
                        assert!(difference <= tolerance * 8.0, "{window:?} {brick:?}");
                    }
                }
                assert_eq!(owners, triples.len() / 3);
                for (a, b) in joined.iter().zip(&expect) {
                    let difference = (a.to_f64() - b.to_f64()).abs();
                    if window == Window::NearestGridPoint {
                        assert_eq!(difference, 0.0, "counts are exact");
                    }
                    assert!(difference <= tolerance * (1.0 + b.to_f64()), "{window:?} {bricks:?}");
                }
            }
        }
    }
    // A few particles a cell, each rounded a few times.
    check::<f64>(16.0 * f64::EPSILON);
    check::<f32>(16.0 * f64::from(f32::EPSILON));
}

#[test]
fn ghosts_are_no_more_than_needed() {
    let n = 16;
    let brick = Brick::slab(n, Space::Configuration, 4, 4).unwrap();
    for (window, shift) in choices() {
        let region = Region::with_ghosts(&brick, window, shift).unwrap();
        assert_eq!(region.count()[1..], [n, n]);
        // Densely: the planes that particles of the slab touch.
        let mut touched = [false; 16];
        for i in 0..4096 {
            let u = 4.0 + f64::from(i) / 1024.0;
            for (plane, touched) in touched.iter_mut().enumerate() {
                *touched |= crate::reference::deposit::weight(window, n, shift, u, plane) > 0.0;
            }
        }
        let planes = region.start()[0]..region.start()[0] + region.count()[0];
        let expect: Vec<bool> = (0..n).map(|plane| planes.contains(&plane)).collect();
        assert_eq!(touched[..], expect[..], "{window:?} {shift}");
    }
}

#[test]
fn a_rank_next_to_the_edge_reaches_round_it() {
    let brick = Brick::slab(8, Space::Configuration, 0, 3).unwrap();
    let region = Region::with_ghosts(&brick, Window::PiecewiseCubicSpline, 0.0).unwrap();
    assert_eq!((region.start(), region.count()), ([7, 0, 0], [6, 8, 8]));
    let closed = Brick::slab(8, Space::Configuration, 0, 6).unwrap();
    let region = Region::with_ghosts(&closed, Window::PiecewiseCubicSpline, 0.0).unwrap();
    assert_eq!((region.start(), region.count()), ([7, 0, 0], [8, 8, 8]), "ghosts meet");
    let empty = Brick::slab(8, Space::Configuration, 8, 0).unwrap();
    assert!(Region::with_ghosts(&empty, Window::CloudInCell, 0.0).unwrap().is_empty());
}

#[test]
fn rounding_at_the_edge_of_a_slab_is_forgiven() {
    let n = 12;
    let brick = Brick::slab(n, Space::Configuration, 4, 4).unwrap();
    for (window, shift) in choices() {
        let assignment = Assignment { box_size: 1.0, window, shift };
        let region = Region::with_ghosts(&brick, window, shift).unwrap();
        for edge in [4.0 / 12.0, 8.0 / 12.0] {
            let edge = edge as f32;
            for x in [edge.next_down().next_down(), edge.next_down(), edge, edge.next_up()] {
                let mesh = put(&region, &[x, 0.2, 0.9], None, &assignment, &Serial).unwrap();
                let mass: f32 = mesh.iter().sum();
                assert!((mass - 1.0).abs() < 1e-5, "{window:?} {shift} {x}");
            }
        }
        for x in [0.1_f32, 0.95, f32::MIN_POSITIVE] {
            let refused = put(&region, &[x, 0.2, 0.9], None, &assignment, &Serial);
            assert_eq!(refused, Err(Error::Outside), "{window:?} {x}");
        }
    }
}

#[test]
fn positions_are_wrapped_whatever_their_size() {
    let n = 8;
    let region = region_of(n);
    for (window, shift) in choices() {
        let assignment = Assignment { box_size: 10.0, window, shift };
        for (far, near) in [
            (-1e-300, 0.0),
            (10.0, 0.0),
            (-10.0, 0.0),
            (1e9 + 2.5, 2.5),
            (-1e9 - 2.5, 7.5),
            (f64::MAX, f64::MAX % 10.0),
            (-f64::MAX, 10.0 - f64::MAX % 10.0),
        ] {
            let there = put(&region, &[far, 1.0, 9.0], None, &assignment, &Serial).unwrap();
            let here = put(&region, &[near, 1.0, 9.0], None, &assignment, &Serial).unwrap();
            assert!(there.iter().zip(&here).all(|(a, b)| (a - b).abs() < 1e-14), "{window:?} {far}");
        }
        let single = put(&region, &[f32::MAX, -f32::MAX, 9.999_999_5], None, &assignment, &Serial).unwrap();
        assert!((single.iter().sum::<f32>() - 1.0).abs() < 1e-6);
    }
}

#[test]
fn what_cannot_be_placed_is_refused() {
    let n = 8;
    let region = region_of(n);
    let good = Assignment { box_size: 1.0, window: Window::CloudInCell, shift: 0.0 };
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        for axis in 0..3 {
            let mut triple = [0.5; 3];
            triple[axis] = bad;
            assert_eq!(put(&region, &triple, None, &good, &Serial), Err(Error::NotFinite));
            assert_eq!(get(&region, &[0.0; 512], &triple, &good, &Serial), Err(Error::NotFinite));
            let small = Region::new(n, [0; 3], [1; 3], [1; 3]).unwrap();
            assert_eq!(put(&small, &[0.5, bad, 0.5], None, &good, &Serial), Err(Error::NotFinite));
        }
        assert_eq!(put(&region, &[0.5; 3], Some(&[bad]), &good, &Serial), Err(Error::NotFinite));
        let box_size = Assignment { box_size: bad, ..good };
        assert_eq!(put(&region, &[0.5; 3], None, &box_size, &Serial), Err(Error::NotFinite));
        let shift = Assignment { shift: bad, ..good };
        assert_eq!(put(&region, &[0.5; 3], None, &shift, &Serial), Err(Error::NotFinite));
    }
    for box_size in [0.0, -1.0, 1e-320] {
        let bad = Assignment { box_size, ..good };
        assert_eq!(put(&region, &[0.5; 3], None, &bad, &Serial), Err(Error::Range), "{box_size}");
    }
    let tiny = Assignment { box_size: 1e-60, ..good };
    assert_eq!(put(&region, &[0.5_f32; 3], None, &tiny, &Serial), Err(Error::Range));
    for shift in [-0.5, 1.0] {
        let bad = Assignment { shift, ..good };
        assert_eq!(put(&region, &[0.5; 3], None, &bad, &Serial), Err(Error::Range));
    }
    assert_eq!(put(&region, &[0.5; 3], Some(&[1.0, 1.0]), &good, &Serial), Err(Error::Length));
    assert_eq!(put(&region, &[], None, &good, &Serial), Ok(vec![0.0; 512]), "nobody is welcome");
    let empty = Region::new(n, [0; 3], [0, 8, 8], [64, 8, 1]).unwrap();
    assert_eq!(put(&empty, &[0.5; 3], None, &good, &Serial), Err(Error::Outside));
    let mut short = [0.0; 511];
    let positions = Positions::triples(&[0.5; 3]).unwrap();
    let mut memory = Memory::new(deposit_scratch::<f64>(&region, 1, good.window).unwrap());
    let length = deposit(&mut short, &region, &positions, None, &good, memory.get(), &Serial);
    assert_eq!(length, Err(Error::Length));
    let scratch = deposit(&mut [0.0; 512], &region, &positions, None, &good, &mut [], &Serial);
    assert_eq!(scratch, Err(Error::Scratch));
    assert_eq!(Region::new(8, [8, 0, 0], [1; 3], [1; 3]), Err(Error::Brick));
    assert_eq!(Region::new(8, [0; 3], [9, 1, 1], [1; 3]), Err(Error::Brick));
    assert_eq!(Region::new(8, [7; 3], [2; 3], [2, 1, 1]), Err(Error::Brick), "two cells on one address");
}

#[test]
fn scratch_does_not_grow_with_particles() {
    let region = region_of(256);
    let most = deposit_scratch::<f32>(&region, 1 << 40, Window::CloudInCell).unwrap();
    let runs = 8 * (sort::BATCH / 8 + 64);
    assert_eq!(
        most.size,
        (16 + 2) * sort::BATCH + runs + 4 * 1024 * 64 + (4 * 1025_usize).next_multiple_of(64)
    );
    assert!(most.size < 39 << 20);
    let few = deposit_scratch::<f64>(&region, 1, Window::CloudInCell).unwrap();
    assert!(few.size < 16 << 10);
}
