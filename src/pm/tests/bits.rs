//! The same bits however the work is done.

use super::*;

#[test]
fn bits_do_not_depend_on_threads_or_instructions() {
    fn check<T: Real>() {
        for n in [18, 24] {
            // Tiles in an odd ring, an even ring, and an open row.
            let whole = region_of(n);
            let part = Region::new(n, [n - 3, 0, 0], [n - 1, n, n], [n * (n + 2), n + 2, 1]).unwrap();
            let triples = crowd::<T>(n);
            // Inside the part for every window: first coordinates 2 .. n - 8.
            let kept: Vec<T> = triples
                .chunks(3)
                .filter(|triple| (2.0..n as f64 - 8.0).contains(&triple[0].to_f64()))
                .flatten()
                .copied()
                .collect();
            for (region, triples) in [(whole, &triples), (part, &kept)] {
                let positions = Positions::triples(triples).unwrap();
                let w: Vec<T> = random(positions.len(), 4).into_iter().map(T::from_f64).collect();
                let mut memory = Memory::new(
                    deposit_scratch::<T>(&region, positions.len(), Window::PiecewiseCubicSpline).unwrap(),
                );
                for (window, shift) in choices() {
                    let mut run = |simd: Simd, exec: &dyn Exec| {
                        let assignment = cells(n, window, shift);
                        let weights = Column::new(&w);
                        let mut mesh = vec![T::ZERO; region.reals()];
                        deposit_with(
                            simd,
                            &mut mesh,
                            &region,
                            &positions,
                            Some(&weights),
                            &assignment,
                            memory.get(),
                            exec,
                        )
                        .unwrap();
                        let mut values = vec![T::ZERO; positions.len()];
                        let mut column = ColumnMut::new(&mut values);
                        read_out_with(
                            simd,
                            &mut column,
                            &mesh,
                            &region,
                            &positions,
                            &assignment,
                            memory.get(),
                            exec,
                        )
                        .unwrap();
                        (bits(&mesh), bits(&values))
                    };
                    let first = run(Simd::Portable, &Serial);
                    for threads in [1, 2, 5] {
                        let pool = Threads::new(threads).unwrap();
                        assert!(run(Simd::detect(), &pool) == first, "{window:?} {shift} {threads}");
                    }
                }
            }
        }
    }
    check::<f32>();
    check::<f64>();
}

#[test]
fn batches_join_without_a_seam() {
    // Two batches and a bit, on few tiles; positions repeat, so the count in each cell is known.
    let n = 8;
    let particles = 2 * sort::BATCH + 77;
    let triples: Vec<f32> =
        (0..particles).flat_map(|i| [(i % 8) as f32, (i / 8 % 8) as f32, (i / 64 % 8) as f32]).collect();
    let region = region_of(n);
    let pool = Threads::new(2).unwrap();
    let assignment = cells(n, Window::CloudInCell, 0.0);
    let mesh = put(&region, &triples, None, &assignment, &pool).unwrap();
    for x in 0..8 {
        for y in 0..8 {
            for z in 0..8 {
                let number = x + 8 * y + 64 * z;
                let expect = (particles - number).div_ceil(512);
                assert_eq!(mesh[(x * 8 + y) * 8 + z], expect as f32);
            }
        }
    }
    let values = get(&region, &mesh, &triples, &assignment, &pool).unwrap();
    for (i, value) in values.iter().enumerate() {
        assert_eq!(*value, (particles - i % 512).div_ceil(512) as f32);
    }
}

#[test]
fn particles_in_runs_and_sorted_give_the_same_bits() {
    // The same order in each of two tiles, one after the other or by turns: a run each, or none.
    let n = 32;
    let region = region_of(n);
    let places: Vec<f64> = random(3 * 1501, 9).iter().map(|x| 7.0 * x).collect();
    let near: Vec<[f64; 4]> =
        places.chunks(3).map(|p| [p[0] + 0.2, p[1] + 0.3, 4.4 * p[2], p[0] - 2.0]).collect();
    let far: Vec<[f64; 4]> = near.iter().map(|p| [p[0] + 16.0, p[1], p[2] - 20.0, p[3]]).collect();
    let runs: Vec<[f64; 4]> = near.iter().chain(&far).copied().collect();
    let turns: Vec<[f64; 4]> = near.iter().zip(&far).flat_map(|(a, b)| [*a, *b]).collect();
    for (window, shift) in choices() {
        let assignment = cells(n, window, shift);
        let [runs, turns] = [&runs, &turns].map(|particles| {
            let triples: Vec<f64> = particles.iter().flat_map(|p| [p[0], p[1], p[2]]).collect();
            let masses: Vec<f64> = particles.iter().map(|p| p[3]).collect();
            let mut bad = masses.clone();
            bad[1700] = f64::INFINITY;
            let refused = put(&region, &triples, Some(&bad), &assignment, &Serial);
            assert_eq!(refused.err(), Some(Error::NotFinite));
            put(&region, &triples, Some(&masses), &assignment, &Serial).unwrap()
        });
        assert!(bits(&runs) == bits(&turns), "{window:?} {shift}");
    }
}

#[test]
fn read_out_in_order_and_sorted_gives_the_same_bits() {
    let n = 32;
    let region = region_of(n);
    let mesh: Vec<f64> = random(n * n * n, 8);
    // By tiles: few changes. Reversed in stretches of one: every particle changes its tile.
    let ordered: Vec<[f64; 3]> =
        (0..4000).map(|i| [f64::from(i) / 125.0, 1.25 + f64::from(i % 7), f64::from(i % 32) + 0.4]).collect();
    let mixed: Vec<[f64; 3]> = (0..4000).map(|i| ordered[i * 1601 % 4000]).collect();
    for (window, shift) in choices() {
        let assignment = cells(n, window, shift);
        let straight = get(&region, &mesh, ordered.as_flattened(), &assignment, &Serial).unwrap();
        let sorted = get(&region, &mesh, mixed.as_flattened(), &assignment, &Serial).unwrap();
        assert!((0..4000).all(|i| sorted[i].to_bits() == straight[i * 1601 % 4000].to_bits()));
    }
}
