use core::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};
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
fn callers_at_once_each_get_all_their_chunks() {
    const LOOPS: usize = if cfg!(miri) { 4 } else { 200 };
    let pool = Threads::new(3).unwrap();
    std::thread::scope(|scope| {
        for caller in 0..4 {
            let pool = &pool;
            scope.spawn(move || {
                let mut data = vec![0; 97];
                for turn in 0..LOOPS {
                    for_each_piece(pool, &mut data, 10, &|i, piece| {
                        piece
                            .iter_mut()
                            .enumerate()
                            .for_each(|(j, value)| *value += (10 * i + j) * (caller + turn));
                    })
                    .unwrap();
                }
                let sum: usize = (0..LOOPS).map(|turn| caller + turn).sum();
                assert!(data.into_iter().enumerate().all(|(i, value)| value == i * sum));
            });
        }
    });
}

#[test]
fn after_a_chunk_that_panics_all_threads_work_on() {
    let pool = Threads::new(3).unwrap();
    for bad in [0, 7] {
        let calls = AtomicUsize::new(0);
        let result = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| {
            pool.parallel_for(8, &|i| {
                calls.fetch_add(1, Ordering::Relaxed);
                assert_ne!(i, bad, "the chunk that panics");
            })
        }));
        assert!(result.is_err(), "the caller learns of it");
        // Each chunk waits for the other, which one thread alone could not do.
        let (met, begin) = (AtomicUsize::new(0), Instant::now());
        pool.parallel_for(2, &|_| {
            met.fetch_add(1, Ordering::Relaxed);
            while met.load(Ordering::Relaxed) < 2 && begin.elapsed() < Duration::from_secs(20) {
                std::thread::yield_now();
            }
            assert_eq!(met.load(Ordering::Relaxed), 2, "two threads run chunks");
        })
        .unwrap();
    }
}

#[test]
fn pools_come_and_go() {
    for round in 0..if cfg!(miri) { 10 } else { 100 } {
        let pool = Threads::new(1 + round % 5).unwrap();
        if round % 2 == 0 {
            pool.parallel_for(3, &|_| ()).unwrap();
        }
    }
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
