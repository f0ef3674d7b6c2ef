//! Sorting particles by a 64-bit key: a counting sort into buckets that fit the cache, then each bucket by itself.

use core::cmp::Reverse;

use super::periodic::{pieces, span};
use crate::exec::{Exec, Shared};
use crate::scratch::Layout;
use crate::sort::sort_by_key;
use crate::status::{Error, Result};
use crate::within::Within;

/// Key, high half first, and number of a particle.
pub(super) type Record = [u32; 3];

#[inline(always)]
pub(super) fn key(record: &Record) -> u64 {
    u64::from(record[0]) << 32 | u64::from(record[1])
}

/// Which bucket a key goes into.
#[derive(Clone, Copy)]
pub(super) enum Buckets {
    /// By size, for keys below a bound: bucket after bucket the records are in order.
    Ordered(u64),
    /// By a hash: equal keys meet, in no order.
    Hashed,
}

/// Particles in a bucket for which the number of buckets is chosen, and the most buckets there are.
const AIM: usize = 256;
const MOST_BUCKETS: usize = 4096;
/// Particles that one chunk counts and moves: at least so many, and at most 256 chunks.
const CHUNK: usize = 1 << 14;
const MOST_CHUNKS: usize = 256;

/// Counters of a sort.
#[derive(Clone, Copy)]
pub(super) struct Sizes {
    particles: usize,
    pub(super) buckets: usize,
    chunk: usize,
}

impl Sizes {
    /// `Overflow` for 2^32 particles and more.
    pub(super) fn new(particles: usize) -> Result<Self> {
        if u32::try_from(particles).is_err() {
            return Err(Error::Overflow);
        }
        let buckets = (particles / AIM).clamp(1, MOST_BUCKETS);
        let chunk = particles.div_ceil(MOST_CHUNKS).max(CHUNK);
        Ok(Self { particles, buckets, chunk })
    }

    fn chunks(&self) -> usize {
        self.particles.div_ceil(self.chunk.max(1))
    }

    fn counters(&self) -> usize {
        self.chunks() * self.buckets + self.buckets + 1
    }

    /// Adds what the counters need.
    pub(super) fn and_counters(&self, layout: Layout) -> Result<Layout> {
        layout.and::<u32>(self.counters())
    }

    pub(super) fn counters_of<'a>(&self, arena: &mut crate::scratch::Arena<'a>) -> Result<&'a mut [u32]> {
        arena.take(self.counters())
    }
}

/// Sorts all keys. Returns where each bucket starts, and the end.
///
/// Records of one bucket are in order of key, then of particle.
pub(super) fn sort<'a>(
    records: &mut [Record],
    counters: &'a mut [u32],
    keys: &[u64],
    sizes: &Sizes,
    by: Buckets,
    exec: &dyn Exec,
) -> Result<&'a [u32]> {
    let Sizes { particles, buckets, chunk } = *sizes;
    let (starts, counters) = counters.split_at_mut_checked(buckets + 1).ok_or(Error::Scratch)?;
    let bucket = Bucket::new(by, buckets);
    crate::exec::for_each_piece(exec, counters, buckets, &|i, counters| {
        counters.fill(0);
        for &key in keys.part(pieces(particles, chunk, i)) {
            if let Some(counter) = counters.get_mut(bucket.of(key)) {
                *counter += 1;
            }
        }
    })?;
    sum(counters, starts);
    {
        let (records, counters) = (Shared::new(records), Shared::new(counters));
        exec.parallel_for(sizes.chunks(), &|i| {
            // SAFETY: a row of counters a chunk.
            let places = unsafe { counters.part(i * buckets, buckets) };
            let piece = pieces(particles, chunk, i);
            for (i, &key) in piece.clone().zip(keys.part(piece)) {
                let Some(place) = places.get_mut(bucket.of(key)) else { continue };
                // SAFETY: the first pass counted this particle for this bucket and chunk, so the place is its own.
                unsafe { records.part(*place as usize, 1)[0] = [(key >> 32) as u32, key as u32, i as u32] };
                *place += 1;
            }
        })?;
    }
    let starts = &*starts;
    let records = Shared::new(records);
    exec.parallel_for(buckets, &|b| {
        let bucket = span(starts, b);
        // SAFETY: buckets are disjoint, and each is sorted once.
        let bucket = unsafe { records.part(bucket.start, bucket.len()) };
        // One number is compared sooner than two.
        sort_by_key(bucket, |record| u128::from(key(record)) << 32 | u128::from(record[2]));
    })?;
    Ok(starts)
}

#[derive(Clone, Copy)]
struct Bucket {
    scale: f64,
    last: usize,
    hashed: bool,
}

impl Bucket {
    fn new(by: Buckets, buckets: usize) -> Self {
        let (bound, hashed) = match by {
            Buckets::Ordered(bound) => (bound as f64, false),
            Buckets::Hashed => (9_007_199_254_740_992.0, true), // 2^53
        };
        Self { scale: buckets as f64 / bound, last: buckets - 1, hashed }
    }

    /// Grows with the key, or with its hash.
    #[inline(always)]
    fn of(self, key: u64) -> usize {
        // The odd number nearest to 2^64 over the golden ratio: high bits of the product depend on all of the key.
        let key = if self.hashed { key.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 11 } else { key };
        ((key as i64 as f64 * self.scale) as usize).min(self.last)
    }
}

/// Turns counts by chunk and bucket into first places, and notes where each bucket starts.
fn sum(counters: &mut [u32], starts: &mut [u32]) {
    let buckets = starts.len() - 1;
    let mut place = 0;
    for bucket in 0..buckets {
        starts.put(bucket, place);
        for counter in counters.iter_mut().skip(bucket).step_by(buckets) {
            place += core::mem::replace(counter, place);
        }
    }
    starts.put(buckets, place);
}

/// In place, by decreasing first and then increasing second number, which together are different for all values.
pub(super) fn sort_by_size<T: Copy + Default>(values: &mut [T], numbers: impl Fn(&T) -> (u64, u64)) {
    sort_by_key(values, |value| {
        let (size, label) = numbers(value);
        (Reverse(size), label)
    });
}
