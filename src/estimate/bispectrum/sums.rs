//! Sums over cells of the products of three shell fields.
//!
//! A plane of cells is one chunk. Its cells, z fastest, are copied tile by tile from all fields into memory that stays in the second cache,
//! where every triangle of the list passes over them: a field is read once from main memory, whatever the number of triangles.

use super::plan::{Block, Plan, plan};
use super::products::{Tile, add_tile, lanes};
use super::triangles::{Triangle, check_triangles, sorted};
use crate::estimate::exact::ExactSum;
use crate::exec::{Exec, Shared};
use crate::mesh::{Brick, Space};
use crate::real::Real;
use crate::scratch::{Arena, Layout};
use crate::simd::Simd;
use crate::status::{Error, Result};
use crate::within::Within;

/// Cells of a tile: whole registers, small enough for the fields of many shells in the second cache. Not a power of two: fields that far
/// apart would share the same sets of it.
pub(super) const TILE: usize = 520;

/// Tiles between two flushes of lanes to f64: a lane of f32 adds a thousand products.
const STRETCH: usize = 16;

/// Planes that are worked on together, each with its own work space.
const WAVE: usize = 64;

/// The work space of [`accumulate`].
pub(super) struct Work<'a, T> {
    blocks: &'a mut [Block],
    slots: &'a mut [u32],
    used: &'a mut [u32],
    tiles: &'a mut [T],
    sums: &'a mut [T],
    partial: &'a mut [f64],
    wave: usize,
}

/// Sums of a plan, at most.
fn sums_of(triangles: usize) -> Result<usize> {
    triangles.checked_mul(2).ok_or(Error::Overflow)
}

fn each(count: usize, planes: usize) -> Result<usize> {
    count.checked_mul(planes).ok_or(Error::Overflow)
}

fn wave(brick: &Brick) -> usize {
    WAVE.min(brick.count()[0])
}

/// Values from one plane's sums to the next: whole cache lines.
fn apart<T: Real>(values: usize) -> usize {
    values.next_multiple_of(64 / size_of::<T>())
}

impl<'a, T: Real> Work<'a, T> {
    pub(super) fn layout(layout: Layout, brick: &Brick, shells: usize, triangles: usize) -> Result<Layout> {
        let (sums, wave) = (sums_of(triangles)?, wave(brick));
        layout
            .and::<Block>(triangles)?
            .and::<u32>(triangles)?
            .and::<u32>(shells)?
            .and::<T>(each(apart::<T>(each(shells, TILE)?), wave)?)?
            .and::<T>(each(apart::<T>(each(sums, lanes::<T>())?), wave)?)?
            .and::<f64>(each(apart::<f64>(sums), wave)?)
    }

    pub(super) fn take(
        arena: &mut Arena<'a>,
        brick: &Brick,
        shells: usize,
        triangles: usize,
    ) -> Result<Self> {
        let (sums, wave) = (sums_of(triangles)?, wave(brick));
        Ok(Self {
            blocks: arena.take(triangles)?,
            slots: arena.take(triangles)?,
            used: arena.take(shells)?,
            tiles: arena.take(apart::<T>(shells * TILE) * wave)?,
            sums: arena.take(apart::<T>(sums * lanes::<T>()) * wave)?,
            partial: arena.take(apart::<f64>(sums) * wave)?,
            wave,
        })
    }
}

/// Adds the sums of the triangles in `order`, which it sorts, to `exact`. Every field that a triangle names holds the brick.
///
/// # Errors
/// `NotFinite` if a sum is NaN or infinite, or what `exec` returns; `exact` then holds part of the sums.
pub(super) fn accumulate<'f, T: Real>(
    exact: &mut [ExactSum],
    triangles: &[Triangle],
    order: &mut [u32],
    field: &(dyn Fn(usize) -> &'f [T] + Sync),
    brick: &Brick,
    work: &mut Work<'_, T>,
    exec: &dyn Exec,
) -> Result<()> {
    let plan = plan(work.blocks, work.slots, order, triangles);
    if plan.sums == 0 || brick.is_empty() {
        return Ok(());
    }
    let shells = work.used.len();
    let used = used_shells(work.used, triangles, order);
    let simd = Simd::detect();
    let lengths = [apart::<T>(shells * TILE), apart::<T>(plan.sums * lanes::<T>()), apart::<f64>(plan.sums)];
    let planes = brick.count()[0];
    for first in (0..planes).step_by(work.wave.max(1)) {
        let count = work.wave.min(planes - first);
        {
            let (tiles, sums) = (Shared::new(work.tiles), Shared::new(work.sums));
            let partial = Shared::new(work.partial);
            exec.parallel_for(count, &|i| {
                // SAFETY: each plane of the wave has its own part of the work space and runs once.
                let (tiles, sums, partial) = unsafe {
                    (
                        tiles.part(i * lengths[0], lengths[0]),
                        sums.part(i * lengths[1], lengths[1]),
                        partial.part(i * lengths[2], lengths[2]),
                    )
                };
                let plane = Plane { brick, x: first + i, used, field, plan };
                simd.vectorise(
                    #[inline(always)]
                    || plane.sum(partial.part_mut(..plan.sums), tiles, sums),
                );
            })?;
        }
        let partial = work.partial.part(..count * lengths[2]);
        for (&t, &slot) in order.iter().zip(plan.slots) {
            for plane in partial.chunks_exact(lengths[2].max(1)) {
                let term = plane.at(slot as usize);
                if !term.is_finite() {
                    return Err(Error::NotFinite);
                }
                if let Some(sum) = exact.get_mut(t as usize) {
                    sum.add(term);
                }
            }
        }
    }
    Ok(())
}

/// The shells that some triangle names, in increasing order.
fn used_shells<'a>(used: &'a mut [u32], triangles: &[Triangle], order: &[u32]) -> &'a [u32] {
    used.fill(0);
    for shell in order.iter().flat_map(|&t| triangles.at(t as usize)) {
        used.put(shell as usize, 1);
    }
    let mut count = 0;
    for shell in 0..used.len() {
        if used[shell] == 1 {
            used.put(count, shell as u32);
            count += 1;
        }
    }
    used.part(..count)
}

struct Plane<'a, 'f, T> {
    brick: &'a Brick,
    x: usize,
    used: &'a [u32],
    field: &'a (dyn Fn(usize) -> &'f [T] + Sync),
    plan: Plan<'a>,
}

impl<T: Real> Plane<'_, '_, T> {
    /// The f64 sums of one plane.
    #[inline(always)]
    fn sum(&self, partial: &mut [f64], tiles: &mut [T], sums: &mut [T]) {
        let lanes = lanes::<T>();
        let sums = sums.part_mut(..lanes * self.plan.sums);
        partial.fill(0.0);
        let cells = self.brick.count()[1] * self.brick.count()[2];
        for stretch in (0..cells).step_by(STRETCH * TILE) {
            sums.fill(T::ZERO);
            let end = cells.min(stretch + STRETCH * TILE);
            for start in (stretch..end).step_by(TILE) {
                let count = TILE.min(end - start);
                let length = count.next_multiple_of(lanes);
                for &shell in self.used {
                    let at = shell as usize * TILE;
                    self.load(tiles.part_mut(at..at + count), (self.field)(shell as usize), start);
                    tiles.part_mut(at + count..at + length).fill(T::ZERO);
                }
                let tile = Tile { outer: tiles, middle: tiles, apart: TILE, start: 0, length };
                add_tile(sums, 0, self.plan.blocks, &tile);
            }
            for (total, lanes) in partial.iter_mut().zip(sums.chunks_exact(lanes)) {
                *total += lanes.iter().fold(0.0, |sum, lane| sum + lane.to_f64());
            }
        }
    }

    /// Cells `start ..` of the plane, numbered with z fastest.
    #[inline(always)]
    fn load(&self, tile: &mut [T], field: &[T], start: usize) {
        let (row, stride) = (self.brick.count()[2], self.brick.stride());
        let (mut y, mut z) = (start.checked_div(row).unwrap_or(0), start.checked_rem(row).unwrap_or(0));
        let mut rest = tile;
        while !rest.is_empty() {
            let count = rest.len().min((row - z).max(1));
            let (now, later) = rest.split_at_mut(count);
            let offset = self.x * stride[0] + y * stride[1] + z * stride[2];
            if stride[2] == 1 {
                now.copy(field.part(offset..offset + count));
            } else {
                for (i, cell) in now.iter_mut().enumerate() {
                    *cell = field.at(offset + i * stride[2]);
                }
            }
            (rest, y, z) = (later, y + 1, 0);
        }
    }
}

/// Scratch of [`bispectrum_sums`] over `shells` shells and `triangles` triangles.
///
/// For T triangles, S shells and w = 64 planes, or the brick's if those are fewer: 392 T + 4 S + w (520 S b + 64 T + 16 T) bytes and a few
/// cache lines, b = 4 or 8 bytes being a cell.
///
/// # Errors
/// `Brick` for a brick of Fourier space, `Overflow` if the bytes do not fit the address space.
///
/// # Example
/// ```
/// use fixpair::estimate::bispectrum::bispectrum_sums_scratch;
/// use fixpair::mesh::{Brick, Space};
///
/// assert!(bispectrum_sums_scratch::<f32>(&Brick::whole(8, Space::Configuration)?, 2, 4)?.size > 0);
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn bispectrum_sums_scratch<T: Real>(brick: &Brick, shells: usize, triangles: usize) -> Result<Layout> {
    brick.check_space(Space::Configuration)?;
    let layout = Layout::EMPTY.and::<ExactSum>(triangles)?.and::<u32>(triangles)?;
    Work::<T>::layout(layout, brick, shells, triangles)
}

/// Adds sum over cells of D_i D_j D_k, for every triangle of a list, to `sums`.
///
/// `sums`: one for each triangle; all zero at first. Sums of the x slabs of a mesh, added in any order ([`ExactSum::merge`], or their
/// integers with `MPI_SUM`), are the whole mesh's bit for bit. `fields`: D_s of all shells on the configuration brick `brick`; those
/// that no triangle names may be empty. Only cells are read: the padding of rows may hold anything.
///
/// # Errors
/// `Brick` for a brick of Fourier space, `Length` unless there is a sum for each triangle, and for short fields; `Range` for a
/// triangle of a shell that is not there, `Overflow` for more than 2^30 triangles, `Scratch`, `Alignment`; `NotFinite` if a
/// sum is NaN or infinite, which in f32 it also is where the product of three fields passes 3e38; what `exec` returns. `sums` is
/// untouched by all of them. In f32 products below 1e-38 vanish: scale fields that are smaller than 1e-12.
///
/// Cost: each field is read once. For all triangles of 40 shells 2 flops for each triangle and cell, in vectors of the cells' type.
///
/// # Example
/// ```
/// use fixpair::estimate::bispectrum::{bispectrum_sums, bispectrum_values};
/// use fixpair::estimate::exact::ExactSum;
/// use fixpair::exec::Serial;
/// use fixpair::mesh::{Brick, Space};
/// # #[repr(align(64))] struct Memory([u8; 1 << 18]);
/// # let mut memory = Memory([0; 1 << 18]);
/// # let scratch = &mut memory.0;
///
/// let cells = Brick::whole(8, Space::Configuration)?;
/// let (shell, mut sums, mut value) = (vec![2.0_f64; cells.reals()], [ExactSum::ZERO], [0.0]);
/// bispectrum_sums(&mut sums, &[[0, 0, 0]], &[&shell], &cells, scratch, &Serial)?; // of shells transformed by the host
/// bispectrum_values(&mut value, &sums)?;
/// assert_eq!(value, [8.0 * 512.0]);
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn bispectrum_sums<T: Real>(
    sums: &mut [ExactSum],
    triangles: &[Triangle],
    fields: &[&[T]],
    brick: &Brick,
    scratch: &mut [u8],
    exec: &dyn Exec,
) -> Result<()> {
    sums_of_fields(sums, triangles, fields.len(), &|shell| fields.at(shell), brick, scratch, exec)
}

/// [`bispectrum_sums`] of fields that a function finds.
pub(crate) fn sums_of_fields<'f, T: Real>(
    sums: &mut [ExactSum],
    triangles: &[Triangle],
    shells: usize,
    field: &(dyn Fn(usize) -> &'f [T] + Sync),
    brick: &Brick,
    scratch: &mut [u8],
    exec: &dyn Exec,
) -> Result<()> {
    brick.check_space(Space::Configuration)?;
    check_triangles(triangles, shells)?;
    if sums.len() != triangles.len() {
        return Err(Error::Length);
    }
    for &shell in triangles.iter().flatten() {
        brick.check_length(field(shell as usize))?;
    }
    let layout = bispectrum_sums_scratch::<T>(brick, shells, triangles.len())?;
    let mut arena = Arena::new(scratch, layout)?;
    let exact = arena.take::<ExactSum>(triangles.len())?;
    let order = arena.take::<u32>(triangles.len())?;
    let mut work = Work::take(&mut arena, brick, shells, triangles.len())?;
    exact.fill(ExactSum::ZERO);
    number(order);
    accumulate(exact, triangles, order, field, brick, &mut work, exec)?;
    merge(sums, exact);
    Ok(())
}

/// 0, 1, 2 ...
pub(super) fn number(order: &mut [u32]) {
    for (i, place) in order.iter_mut().enumerate() {
        *place = i as u32;
    }
}

/// Adds sums to the caller's, and leaves them in their one form.
pub(super) fn merge(sums: &mut [ExactSum], exact: &[ExactSum]) {
    for (sum, exact) in sums.iter_mut().zip(exact) {
        sum.merge(exact);
        sum.carry();
    }
}

/// The shells of `triangle`, distinct and in increasing order.
pub(super) fn distinct(triangle: Triangle) -> impl Iterator<Item = u32> {
    let [i, j, k] = sorted(triangle);
    [Some(i), (j != i).then_some(j), (k != j).then_some(k)].into_iter().flatten()
}
