//! How many triples of modes close each triangle.
//!
//! The field of a shell whose modes are all 1 is I_s(x) = sum over n in s of cos(2 pi n.x/m), and N_ijk = m^-3 sum over x of I_i I_j I_k.
//! I_s is even and symmetric in the axes, so the cells 0 <= x <= y <= z <= m/2 stand for all of the mesh with their numbers of mirror images
//! as weights, and its cosines factorise: three contractions, each over one axis and no longer than the sphere allows. Planes of one z come
//! one after another, so that little memory is needed.
//!
//! The sum is an integer once divided by m^3. With M modes a shell, |I_s| <= M and <I_s^2> = M over the mesh (Parseval), so rounding errors
//! of at most c 2^-53 M for each factor, c = 3 radius + 150 counting every operation, move N_ijk by at most 3 c 2^-53 M_k sqrt(M_i M_j): 0.06
//! for the largest triangle of 40 shells of 3 k_f (M = 5.5e5). On larger geometries the bound exceeds 1/2, the errors, being
//! random, do not: no sum may then lie farther than 0.1 from an integer.

use super::contraction::{COLUMNS, ROWS, contract};
use super::plan::{Block, Plan, plan};
use super::products::{LANES_F64, Tile, add_tile};
use super::shells::{check_shells, squares_below};
use super::sums::{TILE, number};
use super::triangles::{Triangle, check_triangles};
use crate::exec::{Exec, Shared};
use crate::math::sin_cos_turns;
use crate::mesh::check_side;
use crate::scratch::{Arena, Layout};
use crate::simd::Simd;
use crate::status::{Error, Result};
use crate::within::Within;

/// The largest distance of a sum from an integer.
const RESIDUAL: f64 = 0.1;

/// Integers up to here are f64 numbers with bits to spare for the residual.
const LARGEST: f64 = (1_u64 << 48) as f64;

/// Blocks of triangles that a thread takes at a time.
const PIECE: usize = 64;

/// The lengths of the arrays in scratch.
#[derive(Clone, Copy)]
struct Sizes {
    shells: usize,
    triangles: usize,
    /// The last edge.
    edge: u64,
    /// Side of the mesh that the sums are taken on.
    side: usize,
    /// Mode numbers 0 .. depth - 1 on each axis.
    depth: usize,
    /// Rows of cells in a plane, with padding.
    row: usize,
    /// Rows of mode numbers, with padding.
    line: usize,
    /// From the field of one shell to the next.
    apart: usize,
}

impl Sizes {
    fn new(edges: &[u64], n: usize, triangles: &[Triangle]) -> Result<Self> {
        check_side(n)?;
        check_shells(edges, n)?;
        check_triangles(triangles, edges.len() - 1)?;
        let edge = edges.at(edges.len() - 1);
        let depth = squares_below(edge) as usize;
        // On a mesh of three radii and one nothing wraps; the caller's mesh may be smaller, and then wraps as it does.
        let side = n.min((3 * (depth - 1) + 1).next_multiple_of(2));
        let row = (side / 2 + 1).next_multiple_of(COLUMNS) + COLUMNS;
        let line = depth.next_multiple_of(ROWS);
        // An odd number of cache lines, so that fields do not share the same sets of the caches.
        let apart = ((points(side / 2) / 8) | 1) * 8;
        Ok(Self { shells: edges.len() - 1, triangles: triangles.len(), edge, side, depth, row, line, apart })
    }

    fn layout(&self) -> Result<Layout> {
        let each = |count: usize, times: usize| count.checked_mul(times).ok_or(Error::Overflow);
        let below = usize::try_from(self.edge).map_err(|_| Error::Overflow)?.checked_add(1);
        Layout::EMPTY
            .and::<u32>(self.triangles)?
            .and::<Block>(self.triangles)?
            .and::<u32>(self.triangles)?
            .and::<u32>(below.ok_or(Error::Overflow)?)?
            .and::<f64>(each(self.depth, self.row)?)?
            .and::<[f64; 2]>(self.depth + 1)?
            .and::<f64>(each(self.shells, self.line * (self.depth + self.row))?)?
            .and::<f64>(self.apart)?
            .and::<f64>(each(self.shells, self.apart)?)?
            .and::<f64>(each(self.shells, self.apart)?)?
            .and::<f64>(each(2 * self.triangles, LANES_F64)?)?
            .and::<[f64; 2]>(2 * self.triangles)
    }
}

/// Cells x <= y <= z of a plane, in rows of whole [`COLUMNS`], [`ROWS`] rows of the same length: those before row y = 4 q are
/// the sum over q' < q of 4 round_up(4 q' + 4, 8).
fn row_start(y: usize) -> usize {
    const { assert!(ROWS == 4 && COLUMNS == 8) };
    let q = y / 4;
    // Lengths are 8, 8, 16, 16, ...
    let (pairs, odd) = (q / 2, q % 2);
    32 * (pairs * (pairs + 1) + odd * (pairs + 1)) + y % 4 * row_length(y)
}

fn row_length(y: usize) -> usize {
    (y / ROWS * ROWS + ROWS).next_multiple_of(COLUMNS)
}

/// All of a plane, padding included.
fn points(z: usize) -> usize {
    row_start((z + 1).next_multiple_of(ROWS))
}

/// Scratch of [`triangle_counts`]: for 40 shells of 3 k_f, n = 360 and their 6350 triangles 25 MB.
///
/// # Errors
/// As [`triangle_counts`].
///
/// # Example
/// ```
/// use fixpair::estimate::bispectrum::triangle_counts_scratch;
///
/// assert!(triangle_counts_scratch(&[1, 4, 9], 16, &[[0, 0, 0]])?.size > 0);
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn triangle_counts_scratch(edges: &[u64], n: usize, triangles: &[Triangle]) -> Result<Layout> {
    Sizes::new(edges, n, triangles)?.layout()
}

/// N_ijk of every triangle of a list: the ordered triples (k1, k2, k3) of modes, one from each shell, with k1 + k2 + k3 = 0 on a mesh
/// of side `n`, that is modulo n.
///
/// `counts`: one for each triangle, overwritten. They depend on edges, n and triangles alone: keep them.
///
/// # Errors
/// `MeshSize`, `Overflow` for n, `Table` for edges that do not increase, `Range` for shells that reach the Nyquist planes and for triangles of
/// shells that are not there, `Length` unless there is a count for each triangle, `Scratch`, `Alignment`; `Convergence` if
/// rounding errors leave a count in doubt, or one exceeds 2^48; what `exec` returns. `counts` is untouched by all of them.
///
/// Cost: with H = m/2, m the lesser of n and three times the upper radius, H^3/6 cells: 2 flops for each triangle, and 4 times the radius of
/// each shell. For 40 shells of 3 k_f, n = 360 and 6350 triangles 22 Gflop.
///
/// # Example
/// ```
/// use fixpair::estimate::bispectrum::{triangle_counts, triangle_counts_scratch};
/// use fixpair::exec::Serial;
/// # #[repr(align(64))] struct Memory([u8; 1 << 18]);
/// # let mut memory = Memory([0; 1 << 18]);
/// # let scratch = &mut memory.0;
///
/// let mut counts = [0];
/// triangle_counts(&mut counts, &[[0, 0, 0]], &[3, 21], 16, scratch, &Serial)?; // ordered triples of modes that close
/// assert_eq!(counts, [54066]);
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn triangle_counts(
    counts: &mut [u64],
    triangles: &[Triangle],
    edges: &[u64],
    n: usize,
    scratch: &mut [u8],
    exec: &dyn Exec,
) -> Result<()> {
    let sizes = Sizes::new(edges, n, triangles)?;
    if counts.len() != triangles.len() {
        return Err(Error::Length);
    }
    let mut arena = Arena::new(scratch, sizes.layout()?)?;
    let Sizes { shells, side, depth, row, line, apart, .. } = sizes;
    let order = arena.take::<u32>(triangles.len())?;
    let blocks = arena.take::<Block>(triangles.len())?;
    let slots = arena.take::<u32>(triangles.len())?;
    let below = arena.take::<u32>(sizes.edge as usize + 1)?;
    let cosines = arena.take::<f64>(depth * row)?;
    let prefix = arena.take::<[f64; 2]>(depth + 1)?;
    let work = arena.take::<f64>(shells * line * (depth + row))?;
    let weights = arena.take::<f64>(apart)?;
    let fields = arena.take::<f64>(shells * apart)?;
    let weighted = arena.take::<f64>(shells * apart)?;
    let lanes = arena.take::<f64>(2 * triangles.len() * LANES_F64)?;
    let totals = arena.take::<[f64; 2]>(2 * triangles.len())?;

    number(order);
    let plan = plan(blocks, slots, order, triangles);
    let mut c = 0;
    for (r, below) in below.iter_mut().enumerate() {
        if (c * c) < r {
            c += 1;
        }
        *below = c as u32;
    }
    fill_cosines(cosines, row, side);
    totals.fill([0.0; 2]);
    let simd = Simd::detect();
    for z in 0..=side / 2 {
        fill_weights(weights, z, side);
        fill_prefix(prefix, z, side);
        let plane = Plane { z, sizes: &sizes, below, cosines, prefix, weights };
        {
            let (work, fields, weighted) = (Shared::new(work), Shared::new(fields), Shared::new(weighted));
            exec.parallel_for(shells, &|s| {
                let each = line * (depth + row);
                // SAFETY: each shell has its own part of the three arrays and runs once.
                let (work, field, weighted) = unsafe {
                    (
                        work.part(s * each, each),
                        fields.part(s * apart, apart),
                        weighted.part(s * apart, apart),
                    )
                };
                simd.vectorise(
                    #[inline(always)]
                    || plane.fill_field(field, weighted, work, edges.at(s), edges.at(s + 1)),
                );
            })?;
        }
        let (outer, middle) = (&*fields, &*weighted);
        let (lanes, totals) = (Shared::new(&mut *lanes), Shared::new(&mut *totals));
        exec.parallel_for(plan.blocks.len().div_ceil(PIECE), &|piece| {
            let (blocks, first, count) = piece_of(&plan, piece);
            // SAFETY: the sums of different blocks are different, and each piece runs once.
            let (lanes, totals) =
                unsafe { (lanes.part(first * LANES_F64, count * LANES_F64), totals.part(first, count)) };
            simd.vectorise(
                #[inline(always)]
                || {
                    for start in (0..points(z)).step_by(TILE) {
                        let length = TILE.min(points(z) - start);
                        let tile = Tile { outer, middle, apart, start, length };
                        lanes.fill(0.0);
                        add_tile(lanes, first, blocks, &tile);
                        for (total, lanes) in totals.iter_mut().zip(lanes.as_chunks::<LANES_F64>().0) {
                            add(total, (lanes[0] + lanes[1]) + (lanes[2] + lanes[3]));
                        }
                    }
                },
            );
        })?;
    }
    let cells = side as f64 * side as f64 * side as f64;
    let count = |slot: u32| {
        let [high, low] = totals.at(slot as usize);
        (high + low) / cells
    };
    let doubtful = |x: f64| !(libm::fabs(x - libm::rint(x)) < RESIDUAL && x < LARGEST);
    if plan.slots.iter().any(|&slot| doubtful(count(slot))) {
        return Err(Error::Convergence);
    }
    for (&t, &slot) in order.iter().zip(plan.slots) {
        counts.put(t as usize, libm::rint(count(slot)) as u64);
    }
    Ok(())
}

/// The blocks of a piece, their first sum, and the number of their sums.
fn piece_of<'a>(plan: &Plan<'a>, piece: usize) -> (&'a [Block], usize, usize) {
    let end = plan.blocks.len().min((piece + 1) * PIECE);
    let blocks = plan.blocks.part(piece * PIECE..end);
    let first = blocks.first().map_or(0, |block| block.first as usize);
    let last = plan.blocks.get(end).map_or(plan.sums, |block| block.first as usize);
    (blocks, first, last - first)
}

/// Adds to a sum in two parts, of which the second holds what rounding took from the first (Knuth's two-sum).
#[inline(always)]
fn add([high, low]: &mut [f64; 2], term: f64) {
    let sum = *high + term;
    let part = sum - *high;
    *low += (*high - (sum - part)) + (term - part);
    *high = sum;
}

/// cos(2 pi t/m), from the half turn where t and m - t are one number.
fn cosine(t: usize, side: usize) -> f64 {
    let t = t.checked_rem(side).unwrap_or(0);
    sin_cos_turns(t.min(side - t) as f64 / side as f64).1
}

/// Both signs of a mode number.
fn signs(mode: usize) -> f64 {
    if mode == 0 { 1.0 } else { 2.0 }
}

/// Row b, column x: cos(2 pi b x/m) for both signs of b.
fn fill_cosines(cosines: &mut [f64], row: usize, side: usize) {
    for (b, line) in cosines.chunks_exact_mut(row.max(1)).enumerate() {
        for (x, value) in line.iter_mut().enumerate() {
            *value = signs(b) * cosine(b * x, side);
        }
    }
}

/// Entry c: the sum over |c'| < c of cos(2 pi c' z/m), in two parts.
fn fill_prefix(prefix: &mut [[f64; 2]], z: usize, side: usize) {
    let mut sum = [0.0; 2];
    for (c, entry) in prefix.iter_mut().enumerate() {
        *entry = sum;
        add(&mut sum, signs(c) * cosine(c * z, side));
    }
}

/// How many cells of the mesh each cell x <= y <= z of a plane stands for; 0 in the padding.
fn fill_weights(weights: &mut [f64], z: usize, side: usize) {
    weights.fill(0.0);
    let mirrors = |a: usize| if a == 0 || 2 * a == side { 1.0 } else { 2.0 };
    for y in 0..=z {
        for (x, weight) in weights.part_mut(row_start(y)..).iter_mut().take(y + 1).enumerate() {
            let orders = match (x == y, y == z) {
                (true, true) => 1.0,
                (false, false) => 6.0,
                _ => 3.0,
            };
            *weight = orders * mirrors(x) * mirrors(y) * mirrors(z);
        }
    }
}

/// What the fields of one plane are made from.
struct Plane<'a> {
    z: usize,
    sizes: &'a Sizes,
    /// Entry r: the integers c >= 0 with c^2 < r.
    below: &'a [u32],
    cosines: &'a [f64],
    prefix: &'a [[f64; 2]],
    weights: &'a [f64],
}

impl Plane<'_> {
    /// I_s on the plane, and the same times the weights.
    #[inline(always)]
    fn fill_field(&self, field: &mut [f64], weighted: &mut [f64], work: &mut [f64], lo: u64, hi: u64) {
        let Sizes { line, row, depth, .. } = *self.sizes;
        let (over_l, over_j) = work.split_at_mut_checked(line * depth).unwrap_or_default();
        let (lo, hi) = (lo as usize, hi as usize);
        let within = |edge: usize, square: usize| self.below.at(edge.saturating_sub(square)) as usize;
        let radius = within(hi, 0);
        // Over l: rows j, columns i; zero beyond the sphere.
        let lines = radius.next_multiple_of(ROWS);
        for j in 0..radius {
            let line = over_l.part_mut(j * line..j * line + lines);
            for (i, value) in line.iter_mut().enumerate() {
                let square = i * i + j * j;
                let (upper, lower) = (self.prefix.at(within(hi, square)), self.prefix.at(within(lo, square)));
                *value = (upper[0] - lower[0]) + (upper[1] - lower[1]);
            }
        }
        // Over j: rows i, columns y.
        for i in (0..lines).step_by(ROWS) {
            let rows = over_j.part_mut(i * row..);
            contract(rows, row, over_l, line, i, self.cosines, row, self.z + ROWS, within(hi, i * i));
        }
        // Over i: rows y, columns x.
        for y in (0..=self.z).step_by(ROWS) {
            let (rows, length) = (field.part_mut(row_start(y)..), row_length(y));
            contract(rows, length, over_j, row, y, self.cosines, row, length, radius);
        }
        let cells = points(self.z);
        for ((weighted, value), weight) in weighted.iter_mut().zip(&*field).zip(self.weights).take(cells) {
            *weighted = value * weight;
        }
    }
}
