//! Claims about sets that threads join and flatten.

use std::vec;
use std::vec::Vec;

use super::*;
use crate::halos::sets::Sets;

#[test]
fn deep_ways_are_flat_after_threads_have_flattened_them() {
    const LENGTH: u32 = 40;
    let pool = Threads::new(2).unwrap();
    for _ in 0..50_000 {
        let mut memory = vec![0; LENGTH as usize];
        let sets = Sets::new(&mut memory);
        // Each to the one before it: the deepest way there is.
        for i in (1..LENGTH).rev() {
            sets.join(i, i - 1);
        }
        // Both ends towards the middle, so that ways cross.
        pool.parallel_for(2, &|end| {
            for i in 0..LENGTH / 2 {
                sets.flatten(if end == 0 { LENGTH - 1 - i } else { i });
            }
        })
        .unwrap();
        let parents: Vec<u32> = (0..LENGTH).map(|i| sets.parent(i)).collect();
        assert!(parents.iter().all(|&parent| parent == 0), "{parents:?}");
    }
}
