use core::sync::atomic::{AtomicUsize, Ordering};
use std::vec;
use std::vec::Vec;

use super::*;

#[test]
fn each_chunk_runs_exactly_once() {
    for threads in [1, 2, 5] {
        let pool = Threads::new(threads).unwrap();
        for count in [0, 1, 2, 3, 64, 1000] {
            let calls: Vec<AtomicUsize> = (0..count).map(|_| AtomicUsize::new(0)).collect();
            pool.parallel_for(count, &|i| {
                calls[i].fetch_add(1, Ordering::Relaxed);
            })
            .unwrap();
            assert!(calls.iter().all(|c| c.load(Ordering::Relaxed) == 1));
        }
    }
}

#[test]
fn a_chunk_may_call_its_own_pool() {
    let pool = Threads::new(3).unwrap();
    let calls = AtomicUsize::new(0);
    let inner = |_| {
        calls.fetch_add(1, Ordering::Relaxed);
    };
    pool.parallel_for(4, &|_| pool.parallel_for(5, &inner).unwrap()).unwrap();
    assert_eq!(calls.into_inner(), 20);
}

#[test]
fn pieces_cover_the_slice() {
    let pool = Threads::new(2).unwrap();
    let mut data = vec![0; 103];
    for_each_piece(&pool, &mut data, 10, &|i, piece| {
        for (j, value) in piece.iter_mut().enumerate() {
            *value += 10 * i + j;
        }
    })
    .unwrap();
    assert!(data.into_iter().enumerate().all(|(i, value)| i == value));
}

#[test]
fn absurd_pools_are_refused() {
    assert_eq!(Threads::new(0).err(), Some(crate::status::Error::Range));
    assert_eq!(Threads::new(1 << 20).err(), Some(crate::status::Error::Range));
}
