//! Batches of particles, sorted by tile.
//!
//! A stable counting sort in two passes over chunks of fixed length: each chunk counts its particles by tile, the counts are summed
//! to places (tile by tile, chunk by chunk inside a tile), and each chunk writes its particles there. The order does not depend on threads.

use core::sync::atomic::{AtomicU32, AtomicUsize, Ordering};

use super::cells::prefetch;
use super::columns::{Column, Positions};
use super::frame::{BLOCK, Frame, NOT_FINITE, OUTSIDE};
use super::tiles::Tiling;
use crate::exec::{Exec, Shared};
use crate::real::Real;
use crate::scratch::{Arena, Layout};
use crate::simd::Simd;
use crate::status::{Error, Result};
use crate::within::Within;

/// Particles sorted at a time. Fewer would visit the mesh more often, more would leave the last cache.
pub(super) const BATCH: usize = 1 << 21;

/// Particles that one chunk counts and writes.
pub(super) const CHUNK: usize = 1 << 15;

/// Particles that change tile no more than once in so many are near enough to some order that copying them to a better one gains nothing.
pub(super) const IN_ORDER: usize = 8;

/// Particles from asking for a record to reading it.
const AHEAD: usize = 16;

/// Consecutive particles in one tile: the first one's number in the batch, and how many they are.
pub(super) type Run = [u32; 2];

/// Three coordinates v, and a fourth number.
pub(super) type Record<T> = [T; 4];

/// What goes with the coordinates of a particle.
#[derive(Clone, Copy)]
pub(super) enum Fourth<'a, T> {
    /// Nothing: 1.
    One,
    /// Its weight.
    Weight(Column<'a, T>),
}

/// Scratch of a sorter.
pub(super) fn layout<T: Real>(particles: usize, tiles: usize) -> Result<Layout> {
    let batch = particles.min(BATCH);
    let counters = batch.div_ceil(CHUNK).checked_mul(tiles).ok_or(Error::Overflow)?;
    Layout::EMPTY
        .and::<Record<T>>(batch)?
        .and::<u16>(batch)?
        .and::<Run>(runs(batch))?
        .and::<u32>(counters)?
        .and::<u32>(tiles + 1)
}

/// Runs of a batch in order, at most: chunks begin with a new one.
fn runs(batch: usize) -> usize {
    batch / IN_ORDER + batch.div_ceil(CHUNK)
}

/// Memory for one batch.
pub(super) struct Sorter<'a, T> {
    records: &'a mut [Record<T>],
    keys: &'a mut [u16],
    runs: &'a mut [Run],
    counters: &'a mut [u32],
    starts: &'a mut [u32],
}

impl<'a, T: Real> Sorter<'a, T> {
    pub(super) fn new(arena: &mut Arena<'a>, particles: usize, tiles: usize) -> Result<Self> {
        let batch = particles.min(BATCH);
        Ok(Self {
            records: arena.take(batch)?,
            keys: arena.take(batch)?,
            runs: arena.take(runs(batch))?,
            counters: arena.take(batch.div_ceil(CHUNK) * tiles)?,
            starts: arena.take(tiles + 1)?,
        })
    }

    /// Particles of a tile of the sorted batch.
    pub(super) fn tile(&self, tile: usize) -> &[Record<T>] {
        self.records.part(range(self.starts, tile))
    }

    /// Runs of a tile of the batch.
    pub(super) fn runs(&self, tile: usize) -> &[Run] {
        self.runs.part(range(self.starts, tile))
    }

    /// Hands the particles of each tile to `change`.
    pub(super) fn each_tile(
        &mut self,
        exec: &dyn Exec,
        change: &(dyn Fn(usize, &mut [Record<T>]) + Sync),
    ) -> Result<()> {
        let starts = &*self.starts;
        let records = Shared::new(&mut *self.records);
        exec.parallel_for(starts.len() - 1, &|tile| {
            let range = range(starts, tile);
            // SAFETY: tiles are disjoint parts of the batch.
            change(tile, unsafe { records.part(range.start, range.len()) });
        })
    }

    /// Hands the first M numbers of the records of the batch of `count` sorted last to `take`, as columns for blocks of particles in the order
    /// they had before: the number of the first, how many they are, and the columns. Once a batch.
    pub(super) fn unsort<const M: usize>(
        &mut self,
        count: usize,
        simd: Simd,
        exec: &dyn Exec,
        take: impl Fn(usize, usize, &[[T; BLOCK]; M]) + Sync,
    ) -> Result<()> {
        let tiles = self.starts.len() - 1;
        let chunks = count.div_ceil(CHUNK);
        let (keys, records) = (self.keys.part(..count), &*self.records);
        let counters = Shared::new(self.counters.part_mut(..chunks * tiles));
        exec.parallel_for(chunks, &|chunk| {
            let begin = chunk * CHUNK;
            // SAFETY: chunks have counters of their own, inside the slice.
            let ends = unsafe { counters.part(chunk * tiles, tiles) };
            let keys = keys.part(begin..count.min(begin + CHUNK));
            simd.vectorise(
                #[inline(always)]
                || {
                    let mut columns = [[T::ZERO; BLOCK]; M];
                    // Writing left the counters behind each tile's last particle of the chunk.
                    for first in (0..keys.len()).step_by(BLOCK).rev() {
                        let length = BLOCK.min(keys.len() - first);
                        for i in (0..length).rev() {
                            // Where a particle some way ahead will be found, or near it.
                            let later = keys.at((first + i).saturating_sub(AHEAD));
                            let later = ends.at(usize::from(later)).wrapping_sub(1) as usize;
                            prefetch::<_, true>(records.as_ptr().wrapping_add(later));
                            let key = usize::from(keys.at(first + i));
                            let place = ends.at(key).wrapping_sub(1);
                            ends.put(key, place);
                            let record = records.at(place as usize);
                            for m in 0..M {
                                columns[m][i] = record[m];
                            }
                        }
                        take(begin + first, length, &columns);
                    }
                },
            );
        })
    }

    /// First half of the sort of particles `first .. first + count`, count <= [`BATCH`]: finds their tiles. Returns how often the tile changes from
    /// one particle to the next. `NotFinite` or `Outside` for what no cell can take.
    pub(super) fn count(
        &mut self,
        positions: &Positions<'_, T>,
        first: usize,
        count: usize,
        frame: &Frame<T>,
        tiling: &Tiling,
        simd: Simd,
        exec: &dyn Exec,
    ) -> Result<usize> {
        let tiles = tiling.len();
        let chunks = count.div_ceil(CHUNK);
        let wrong = AtomicU32::new(0);
        let changes = AtomicUsize::new(0);
        let keys = Shared::new(self.keys.part_mut(..count));
        let counters = Shared::new(self.counters.part_mut(..chunks * tiles));
        exec.parallel_for(chunks, &|chunk| {
            let begin = chunk * CHUNK;
            let length = CHUNK.min(count - begin);
            // SAFETY: chunks have keys and counters of their own, inside the slices.
            let (keys, counters) = unsafe { (keys.part(begin, length), counters.part(chunk * tiles, tiles)) };
            let (flags, changed) = simd.vectorise(
                #[inline(always)]
                || {
                    let flags = count_tiles(positions, first + begin, frame, tiling, keys, counters);
                    // No more than a chunk has particles, so 16 bits do, and are faster.
                    let changed: u16 = keys.windows(2).map(|pair| u16::from(pair[0] != pair[1])).sum();
                    (flags, changed)
                },
            );
            wrong.fetch_or(flags, Ordering::Relaxed);
            changes.fetch_add(usize::from(changed), Ordering::Relaxed);
        })?;
        check(&wrong)?;
        Ok(changes.into_inner())
    }

    /// Second half for particles in order, which change tile less often than once in [`IN_ORDER`]: writes their runs to their places, and not
    /// the particles. The order in each tile is that of `write`.
    pub(super) fn write_runs(&mut self, count: usize, exec: &dyn Exec) -> Result<()> {
        let tiles = self.starts.len() - 1;
        let chunks = count.div_ceil(CHUNK);
        let keys = self.keys.part(..count);
        let chunk_keys = |chunk: usize| keys.part(chunk * CHUNK..count.min((chunk + 1) * CHUNK));
        {
            let counters = Shared::new(self.counters.part_mut(..chunks * tiles));
            exec.parallel_for(chunks, &|chunk| {
                // SAFETY: chunks have counters of their own, inside the slice.
                let counters = unsafe { counters.part(chunk * tiles, tiles) };
                counters.fill(0);
                each_run(chunk_keys(chunk), |key, _| count_in(counters, key, 1));
            })?;
        }
        sum(self.counters.part_mut(..chunks * tiles), self.starts);
        let counters = Shared::new(self.counters.part_mut(..chunks * tiles));
        let runs = Shared::new(&mut *self.runs);
        exec.parallel_for(chunks, &|chunk| {
            // SAFETY: chunks have counters of their own, inside the slice.
            let places = unsafe { counters.part(chunk * tiles, tiles) };
            let mut begin = chunk * CHUNK;
            each_run(chunk_keys(chunk), |key, length| {
                let Some(place) = places.get_mut(usize::from(key)) else { return };
                // SAFETY: this run was counted for this tile and chunk, so the place is its own; runs of particles in order are no more than fit.
                unsafe { runs.part(*place as usize, 1).fill([begin as u32, length as u32]) };
                *place += 1;
                begin += length;
            });
        })
    }

    /// Second half: writes the particles that were counted to their places. `NotFinite` for a weight.
    pub(super) fn write(
        &mut self,
        positions: &Positions<'_, T>,
        fourth: Fourth<'_, T>,
        first: usize,
        count: usize,
        frame: &Frame<T>,
        simd: Simd,
        exec: &dyn Exec,
    ) -> Result<()> {
        let tiles = self.starts.len() - 1;
        let chunks = count.div_ceil(CHUNK);
        let wrong = AtomicU32::new(0);
        sum(self.counters.part_mut(..chunks * tiles), self.starts);
        let keys = self.keys.part(..count);
        let counters = Shared::new(self.counters.part_mut(..chunks * tiles));
        let records = Shared::new(&mut *self.records);
        exec.parallel_for(chunks, &|chunk| {
            let begin = chunk * CHUNK;
            let length = CHUNK.min(count - begin);
            // SAFETY: chunks have counters of their own, inside the slice.
            let places = unsafe { counters.part(chunk * tiles, tiles) };
            let keys = keys.part(begin..begin + length);
            let batch = Batch { positions, fourth, first, begin };
            let flags = simd.vectorise(
                #[inline(always)]
                || batch.write(frame, keys, places, &records),
            );
            wrong.fetch_or(flags, Ordering::Relaxed);
        })?;
        check(&wrong)
    }
}

/// Places of what belongs to a tile.
fn range(starts: &[u32], tile: usize) -> core::ops::Range<usize> {
    starts.at(tile) as usize..starts.at(tile + 1) as usize
}

/// Hands over the stretches of equal keys and their lengths.
#[inline(always)]
fn each_run(mut keys: &[u16], mut take: impl FnMut(u16, usize)) {
    const STEP: usize = 16;
    while let Some(&key) = keys.first() {
        let (steps, _) = keys.as_chunks::<STEP>();
        let whole = |step: &&[u16; STEP]| step.iter().fold(true, |same, &other| same & (other == key));
        let length = STEP * steps.iter().take_while(whole).count();
        let rest = keys.iter().skip(length).take_while(|&&other| other == key).count();
        take(key, length + rest);
        keys = keys.part(length + rest..);
    }
}

/// Adds to the counter of a tile.
#[inline(always)]
fn count_in(counters: &mut [u32], key: u16, particles: u32) {
    if let Some(counter) = counters.get_mut(usize::from(key)) {
        *counter += particles;
    }
}

pub(super) fn check(wrong: &AtomicU32) -> Result<()> {
    match wrong.load(Ordering::Relaxed) {
        0 => Ok(()),
        OUTSIDE => Err(Error::Outside),
        _ => Err(Error::NotFinite),
    }
}

/// Turns counts by chunk and tile into first places, and notes where each tile starts.
fn sum(counters: &mut [u32], starts: &mut [u32]) {
    let Some((end, starts)) = starts.split_last_mut() else { return };
    let tiles = starts.len().max(1);
    let mut place = 0;
    for (tile, start) in starts.iter_mut().enumerate() {
        *start = place;
        for counter in counters.iter_mut().skip(tile).step_by(tiles) {
            place += core::mem::replace(counter, place);
        }
    }
    *end = place;
}

/// Loads a block of up to [`BLOCK`] particles and turns it into coordinates and cells. Missing particles repeat the first one.
#[inline(always)]
pub(super) fn block<T: Real>(
    positions: &Positions<'_, T>,
    first: usize,
    count: usize,
    frame: &Frame<T>,
    v: &mut [[T; BLOCK]; 3],
    index: &mut [[i32; BLOCK]; 3],
) -> u32 {
    let mut wrong = 0;
    debug_assert!(first + count <= positions.len() && count <= BLOCK);
    // SAFETY: the block lies inside the particles, and is no longer than the arrays.
    unsafe { positions.load_all(first, count, 0, v) };
    for axis in 0..3 {
        if count < BLOCK {
            let repeated = v[axis][0];
            v[axis].part_mut(count..).fill(repeated);
        }
        wrong |= frame.locate(axis, &mut v[axis], &mut index[axis]);
    }
    wrong
}

/// First pass: keys of a chunk, and how many particles each tile gets from it.
#[inline(always)]
fn count_tiles<T: Real>(
    positions: &Positions<'_, T>,
    first: usize,
    frame: &Frame<T>,
    tiling: &Tiling,
    keys: &mut [u16],
    counters: &mut [u32],
) -> u32 {
    counters.fill(0);
    let mut wrong = 0;
    let (mut v, mut index) = ([[T::ZERO; BLOCK]; 3], [[0; BLOCK]; 3]);
    for (b, keys) in keys.chunks_mut(BLOCK).enumerate() {
        wrong |= block(positions, first + b * BLOCK, keys.len(), frame, &mut v, &mut index);
        let mut key = [0; BLOCK];
        for i in 0..BLOCK {
            key[i] = tiling.tile(index[0][i], index[1][i]);
        }
        for (key, &found) in keys.iter_mut().zip(&key) {
            *key = found;
        }
        if wrong == 0 {
            // One by one each count would wait for the last, where neighbours share a tile.
            if key.iter().fold(true, |same, &other| same & (other == key[0])) {
                count_in(counters, key[0], keys.len() as u32);
            } else {
                for &key in &*keys {
                    count_in(counters, key, 1);
                }
            }
        }
    }
    wrong
}

/// One chunk of a batch.
struct Batch<'a, 'b, T> {
    positions: &'a Positions<'b, T>,
    fourth: Fourth<'b, T>,
    first: usize,
    begin: usize,
}

impl<T: Real> Batch<'_, '_, T> {
    /// Second pass: writes the chunk's particles to their places.
    #[inline(always)]
    fn write(
        &self,
        frame: &Frame<T>,
        keys: &[u16],
        places: &mut [u32],
        records: &Shared<'_, Record<T>>,
    ) -> u32 {
        let mut wrong = 0;
        let (mut v, mut index) = ([[T::ZERO; BLOCK]; 3], [[0; BLOCK]; 3]);
        let mut fourth = [T::ONE; BLOCK];
        // Whole records first: as one store each they wait for memory in shorter a queue than as four.
        let mut packed = [[T::ZERO; 4]; BLOCK];
        for (b, keys) in keys.chunks(BLOCK).enumerate() {
            let at = self.begin + b * BLOCK;
            block(self.positions, self.first + at, keys.len(), frame, &mut v, &mut index);
            match self.fourth {
                Fourth::One => {}
                Fourth::Weight(weights) => {
                    // SAFETY: there are as many weights as positions, and the block is no longer than the array.
                    unsafe { weights.load(self.first + at, keys.len(), &mut fourth) };
                    let finite = fourth.iter().fold(true, |finite, weight| finite & weight.is_finite());
                    wrong |= if finite { 0 } else { NOT_FINITE };
                }
            }
            for i in 0..BLOCK {
                packed[i] = [v[0][i], v[1][i], v[2][i], fourth[i]];
            }
            for (record, &key) in packed.iter().zip(keys) {
                let Some(place) = places.get_mut(usize::from(key)) else { continue };
                // SAFETY: the first pass counted this particle for this tile and chunk, so the place is inside the batch and its own.
                unsafe { records.part(*place as usize, 1).fill(*record) };
                *place += 1;
            }
        }
        wrong
    }
}
