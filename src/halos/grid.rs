//! Particles by cells of a grid, to find those near a point.

use core::ops::Range;

use super::periodic::{check_box, check_finite, pieces, place, view};
use super::sort::{Buckets, Record, Sizes, key, sort};
use crate::exec::{Exec, Shared, for_each_piece};
use crate::pm::columns::Positions;
use crate::real::Real;
use crate::scratch::{Arena, Layout};
use crate::status::Result;
use crate::within::Within;

/// Particles that one chunk handles.
const CHUNK: usize = 1 << 14;

/// Cells on a side at most.
const MOST_CELLS: usize = 1024;

/// Cells reach so much farther when looked for as rounding may have moved particles among them, in cells.
const MARGIN: f64 = 1e-6;

/// Particles in the order of their cells, z fastest.
pub(super) struct Grid<'a, T> {
    box_size: f64,
    cells: usize,
    places: &'a [[T; 3]],
    /// First particle of each cell, and the end.
    starts: &'a [u32],
}

/// On a side: about as many cells as particles.
fn cells(particles: usize) -> usize {
    (libm::cbrt(particles as f64) as usize).clamp(1, MOST_CELLS)
}

/// Bytes that hold first the records of the sort, then the places.
fn shared_bytes<T: Real>(particles: usize) -> Result<usize> {
    let layouts = [Layout::EMPTY.and::<Record>(particles)?, Layout::EMPTY.and::<[T; 3]>(particles)?];
    Ok(layouts.into_iter().map(|layout| layout.size).max().unwrap_or(0))
}

/// Bytes that hold first the keys, then the starts of cells.
fn table_bytes(particles: usize) -> Result<usize> {
    let n = cells(particles);
    let layouts = [Layout::EMPTY.and::<u64>(particles)?, Layout::EMPTY.and::<u32>(n * n * n + 1)?];
    Ok(layouts.into_iter().map(|layout| layout.size).max().unwrap_or(0))
}

/// With r = size of `T`: 3 r + 12 bytes a particle, and counters.
pub(super) fn layout<T: Real>(particles: usize) -> Result<Layout> {
    let sizes = Sizes::new(particles)?;
    let layout =
        Layout::EMPTY.and::<u8>(shared_bytes::<T>(particles)?)?.and::<u8>(table_bytes(particles)?)?;
    sizes.and_counters(layout.and::<u32>(particles)?)
}

impl<'a, T: Real> Grid<'a, T> {
    /// `NotFinite`, `Range` for the box, `Overflow`, `Scratch`, `Alignment`, `Hook`.
    pub(super) fn new(
        positions: &Positions<'_, T>,
        box_size: f64,
        scratch: &'a mut [u8],
        exec: &dyn Exec,
    ) -> Result<Self> {
        check_box::<T>(box_size)?;
        let particles = positions.len();
        let mut arena = Arena::new(scratch, layout::<T>(particles)?)?;
        check_finite(positions, exec)?;
        let shared = arena.take::<u8>(shared_bytes::<T>(particles)?)?;
        let table = arena.take::<u8>(table_bytes(particles)?)?;
        let order = arena.take::<u32>(particles)?;
        let sizes = Sizes::new(particles)?;
        let counters = sizes.counters_of(&mut arena)?;
        let n = cells(particles);
        let number = |x: T| ((x.to_f64() * (n as f64 / box_size)) as usize).min(n - 1);
        let keys = view::<u64>(table, particles)?;
        for_each_piece(exec, keys, CHUNK, &|chunk, keys| {
            for (i, key) in (chunk * CHUNK..).zip(keys) {
                // SAFETY: a key a particle.
                let [x, y, z] = unsafe { place(positions, i, box_size) }.map(number);
                *key = ((x * n + y) * n + z) as u64;
            }
        })?;
        let records = view::<Record>(shared, particles)?;
        let bound = (n * n * n) as u64;
        sort(records, counters, keys, &sizes, Buckets::Ordered(bound), exec)?;
        for_each_piece(exec, order, CHUNK, &|chunk, order| {
            for (record, order) in records.part(pieces(particles, CHUNK, chunk)).iter().zip(order) {
                *order = record[2];
            }
        })?;
        let starts = view::<u32>(table, n * n * n + 1)?;
        list(starts, records, exec)?;
        let places = view::<[T; 3]>(shared, particles)?;
        for_each_piece(exec, places, CHUNK, &|chunk, piece| {
            for (to, &i) in piece.iter_mut().zip(order.part(chunk * CHUNK..)) {
                // SAFETY: the order is of particles that there are.
                *to = unsafe { place(positions, i as usize, box_size) };
            }
        })?;
        Ok(Self { box_size, cells: n, places, starts })
    }

    /// Calls `visit` with lists of particles, among them each one within `radius` of `centre`, once, and others from nearby. The lists come
    /// in an order that the particles, centre and radius determine.
    #[inline(always)]
    pub(super) fn near(&self, centre: [f64; 3], radius: f64, mut visit: impl FnMut(&[[T; 3]])) {
        let n = self.cells;
        let scale = n as f64 / self.box_size;
        // First cell on each axis, and how many.
        let [x, y, z] = centre.map(|c| {
            let first = libm::floor((c - radius) * scale - MARGIN);
            let last = libm::floor((c + radius) * scale + MARGIN);
            let count = last - first + 1.0;
            if count >= n as f64 {
                (0, n)
            } else {
                let first = (first as i64).checked_rem_euclid(n as i64).unwrap_or_default();
                (first as usize, count as usize)
            }
        });
        let along = |(first, count): (usize, usize)| {
            (first..first + count).map(move |i| if i < n { i } else { i - n })
        };
        for x in along(x) {
            for y in along(y) {
                let row = (x * n + y) * n;
                let (first, end) = (z.0, z.0 + z.1);
                self.list(row + first..row + end.min(n), &mut visit);
                if end > n {
                    self.list(row..row + end - n, &mut visit);
                }
            }
        }
    }

    #[inline(always)]
    fn list(&self, cells: Range<usize>, visit: &mut impl FnMut(&[[T; 3]])) {
        let [first, end] = [cells.start, cells.end].map(|cell| self.starts.at(cell) as usize);
        visit(self.places.part(first..end));
    }
}

/// First record of each cell.
fn list(starts: &mut [u32], records: &[Record], exec: &dyn Exec) -> Result<()> {
    let particles = records.len();
    // Cells up to this one have their start before record i.
    let done = |i: usize| if i == 0 { 0 } else { key(&records.at(i - 1)) as usize + 1 };
    starts.part_mut(done(particles)..).fill(particles as u32);
    let starts = Shared::new(starts);
    exec.parallel_for(particles.div_ceil(CHUNK), &|chunk| {
        for i in pieces(particles, CHUNK, chunk) {
            let (first, cell) = (done(i), key(&records.at(i)) as usize);
            if first <= cell {
                // SAFETY: keys increase, so each cell's start is written for one record only, and all are below the number of cells.
                unsafe { starts.part(first, cell + 1 - first) }.fill(i as u32);
            }
        }
    })
}
