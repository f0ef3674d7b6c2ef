//! Friends of friends: the smallest id of each particle's group.
//!
//! Particles are sorted into cells of friends (`friends.rs`), occupied cells are joined (`link.rs`), and each set of cells gets the smallest id
//! in it.

use core::sync::atomic::{AtomicBool, Ordering};

use super::friends::{BLOCK, Friends};
use super::link::Cells;
use super::periodic::{check_box, pieces, place, span, view};
use super::sets::Sets;
use super::sort::{Buckets, Record, Sizes, key, sort};
use crate::exec::{Exec, Shared, for_each_piece};
use crate::pm::columns::Positions;
use crate::real::Real;
use crate::scratch::{Arena, Layout};
use crate::simd::Simd;
use crate::status::{Error, Result};
use crate::within::Within;

/// l = b L/N^(1/3), N the particles of the whole simulation.
///
/// # Errors
/// `NotFinite`; `Range` unless b and L are positive and there are particles, and for a length that no number holds.
///
/// # Example
/// ```
/// use fixpair::halos::linking_length;
///
/// assert!((linking_length(0.2, 1000.0, 512 * 512 * 512)? - 0.2 * 1000.0 / 512.0).abs() < 1e-12);
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn linking_length(b: f64, box_size: f64, particles_total: u64) -> Result<f64> {
    if !(b.is_finite() && box_size.is_finite()) {
        return Err(Error::NotFinite);
    }
    if !(b > 0.0 && box_size > 0.0 && particles_total > 0) {
        return Err(Error::Range);
    }
    let length = b * box_size / libm::cbrt(particles_total as f64);
    if length.is_normal() { Ok(length) } else { Err(Error::Range) }
}

/// Particles whose keys, or cells whose labels, one chunk computes.
const CHUNK: usize = 1 << 14;

/// Bytes that hold first the records of a sort, then the places in order, then the least id of each cell.
fn shared_bytes<T: Real>(particles: usize) -> Result<usize> {
    let layouts = [
        Layout::EMPTY.and::<Record>(particles)?,
        Layout::EMPTY.and::<[T; 3]>(particles)?,
        Layout::EMPTY.and::<u64>(particles)?,
    ];
    Ok(layouts.into_iter().map(|layout| layout.size).max().unwrap_or(0))
}

/// Scratch of [`fof_labels`]: with r = size of `T`, (3 r + 12) particles bytes, and at most 5.3 MB.
///
/// # Errors
/// `Overflow` for 2^32 particles and more, or if the bytes do not fit the address space.
///
/// # Example
/// ```
/// use fixpair::halos::fof_labels_scratch;
///
/// assert!(fof_labels_scratch::<f32>(1 << 24)?.size < 25 << 24); // some 24 bytes a particle
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn fof_labels_scratch<T: Real>(particles: usize) -> Result<Layout> {
    let layout = Layout::EMPTY
        .and::<u8>(shared_bytes::<T>(particles)?)?
        .and::<u32>(particles)?
        .and::<u32>(particles + 1)?
        .and::<u32>(particles)?;
    let layout = Sizes::new(particles)?.and_counters(layout)?;
    layout.and::<u32>(particles.div_ceil(CHUNK))
}

/// Writes the label of each particle: the smallest id in its group. A particle without friends is a group of its own.
///
/// `labels`: one a particle. `position`: any finite numbers. `ids`: one a particle, all different; without them a particle's id is its number,
/// 0, 1... `linking_length` in the unit of `box_size`, from L/10^6 to L/2: see [`linking_length`](fn@linking_length).
///
/// Of a slab: all labels are those of the groups that these particles alone make; see [`slabs`](mod@super::slabs).
///
/// # Errors
/// `Length`; `NotFinite`; `Range` for the linking length or a box not in 1e-100 ..= 1e100; `Overflow`, `Scratch`, `Alignment`; `Hook`, after
/// which labels are undefined, as they are after `NotFinite` for a position.
///
/// The same labels for any number of threads. Cost on one core, `f32`: 120 ns a particle of a simulation at z = 0 with l = 0.2 of the mean
/// separation, and no more where particles coincide. Two cells of many particles that nearly touch and hold no friends cost all their pairs.
///
/// # Example
/// ```
/// use fixpair::exec::Serial;
/// use fixpair::halos::fof_labels;
/// use fixpair::pm::Positions;
/// # #[repr(align(64))] struct Memory([u8; 1 << 16]);
/// # let mut memory = Memory([0; 1 << 16]);
/// # let scratch = &mut memory.0;
///
/// let position = Positions::triples(&[9.9_f64, 5.0, 5.0, 0.1, 5.0, 5.0, 5.0, 5.0, 5.0])?; // two are friends over the edge
/// let mut labels = [0; 3];
/// fof_labels(&mut labels, &position, None, 10.0, 0.5, scratch, &Serial)?;
/// assert_eq!(labels, [0, 0, 2]); // the smallest id of each group
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn fof_labels<T: Real>(
    labels: &mut [u64],
    position: &Positions<'_, T>,
    ids: Option<&[u64]>,
    box_size: f64,
    linking_length: f64,
    scratch: &mut [u8],
    exec: &dyn Exec,
) -> Result<()> {
    let particles = position.len();
    check_box::<T>(box_size)?;
    let friends = Friends::new(box_size, linking_length)?;
    if labels.len() != particles || ids.is_some_and(|ids| ids.len() != particles) {
        return Err(Error::Length);
    }
    let mut arena = Arena::new(scratch, fof_labels_scratch::<T>(particles)?)?;
    let shared = arena.take::<u8>(shared_bytes::<T>(particles)?)?;
    let order = arena.take::<u32>(particles)?;
    let starts = arena.take::<u32>(particles + 1)?;
    let parents = arena.take::<u32>(particles)?;
    let sizes = Sizes::new(particles)?;
    let counters = sizes.counters_of(&mut arena)?;
    let firsts = arena.take::<u32>(particles.div_ceil(CHUNK))?;

    // Until the last step the labels' memory holds the keys of particles, then of cells.
    cell_keys(labels, position, &friends, exec)?;
    let records = view::<Record>(shared, particles)?;
    sort(records, counters, labels, &sizes, Buckets::Ordered(friends.bound()), exec)?;
    let cells = collect(labels, starts, order, records, firsts, exec)?;
    let (starts, parents) = (starts.part(..=cells), parents.part_mut(..cells));
    let places = view::<[T; 3]>(shared, particles)?;
    for_each_piece(exec, places, CHUNK, &|chunk, piece| {
        for (to, &i) in piece.iter_mut().zip(order.part(chunk * CHUNK..)) {
            // SAFETY: the order is of particles that there are.
            *to = unsafe { place(position, i as usize, box_size) };
        }
    })?;
    let sets = Sets::new(parents);
    Cells { friends: &friends, keys: labels.part(..cells), starts, places, sets: &sets }.link(exec)?;
    let least = view::<u64>(shared, cells)?;
    least_ids(least, starts, order, ids, &sets, exec)?;
    let to = Shared::new(labels);
    exec.parallel_for(cells.div_ceil(CHUNK), &|chunk| {
        for cell in pieces(cells, CHUNK, chunk) {
            let label = least.at(sets.parent(cell as u32) as usize);
            for &i in order.part(span(starts, cell)) {
                // SAFETY: each particle is in one cell.
                unsafe { to.part(i as usize, 1)[0] = label };
            }
        }
    })
}

/// The cell of each particle.
fn cell_keys<T: Real>(
    keys: &mut [u64],
    position: &Positions<'_, T>,
    friends: &Friends,
    exec: &dyn Exec,
) -> Result<()> {
    let simd = Simd::detect();
    let lost = AtomicBool::new(false);
    for_each_piece(exec, keys, CHUNK, &|chunk, keys| {
        let finite = simd.vectorise(
            #[inline(always)]
            || {
                let mut blocks = keys.chunks_mut(BLOCK).enumerate();
                blocks.all(|(block, keys)| friends.keys(position, chunk * CHUNK + block * BLOCK, keys))
            },
        );
        if !finite {
            lost.store(true, Ordering::Relaxed);
        }
    })?;
    if lost.load(Ordering::Relaxed) { Err(Error::NotFinite) } else { Ok(()) }
}

/// Lists the occupied cells: keys and first particles; and the particles in their order. Returns how many cells there are.
fn collect(
    keys: &mut [u64],
    starts: &mut [u32],
    order: &mut [u32],
    records: &[Record],
    firsts: &mut [u32],
    exec: &dyn Exec,
) -> Result<usize> {
    let particles = records.len();
    let begins = |i: usize| i == 0 || key(&records.at(i)) != key(&records.at(i - 1));
    for_each_piece(exec, firsts, 1, &|chunk, first| {
        first.fill(pieces(particles, CHUNK, chunk).map(|i| u32::from(begins(i))).sum());
    })?;
    let mut cells = 0;
    for first in firsts.iter_mut() {
        cells += core::mem::replace(first, cells);
    }
    let (to_keys, to_starts) = (Shared::new(keys), Shared::new(&mut *starts));
    for_each_piece(exec, order, CHUNK, &|chunk, order| {
        let mut cell = firsts.at(chunk) as usize;
        for (i, order) in pieces(particles, CHUNK, chunk).zip(order) {
            let record = records.at(i);
            *order = record[2];
            if begins(i) {
                // SAFETY: cells are numbered in the order of records, so each is written by one chunk.
                unsafe {
                    to_keys.part(cell, 1)[0] = key(&record);
                    to_starts.part(cell, 1)[0] = i as u32;
                }
                cell += 1;
            }
        }
    })?;
    starts.put(cells as usize, particles as u32);
    Ok(cells as usize)
}

/// The least id of each set, at its root. Points every cell to its root.
fn least_ids(
    least: &mut [u64],
    starts: &[u32],
    order: &[u32],
    ids: Option<&[u64]>,
    sets: &Sets<'_>,
    exec: &dyn Exec,
) -> Result<()> {
    for_each_piece(exec, least, CHUNK, &|chunk, least| {
        for (cell, least) in (chunk * CHUNK..).zip(least) {
            sets.flatten(cell as u32);
            let members = order.part(span(starts, cell));
            let id = |&i: &u32| ids.map_or(u64::from(i), |ids| ids.at(i as usize));
            *least = members.iter().map(id).min().unwrap_or(u64::MAX);
        }
    })?;
    // A root comes before the other cells of its set.
    for cell in 0..least.len() {
        let root = sets.parent(cell as u32) as usize;
        least.put(root, least.at(root).min(least.at(cell)));
    }
    Ok(())
}
