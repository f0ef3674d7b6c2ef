//! All triangles of a field in one call, with as many meshes as there is memory for.
//!
//! With M meshes for U shells in use, M < U, the shells are dealt out in groups of a = (M - c)/2, c = max(1, M/5). Two groups at a time stay
//! in memory, every pair of groups once, in an order in which each step brings in one new group; of the triangles whose two lower shells
//! lie in them the third shell is brought in, c shells at a time. Pairs and shells that no triangle asks for are skipped, and
//! the mesh that was not needed for longest makes room. The bits do not depend on M: only the order of the triangles does.

use super::shells::{check_shells, shell_modes};
use super::sums::{Work, accumulate, distinct, merge, number};
use super::triangles::{Triangle, check_triangles, sorted};
use crate::estimate::exact::ExactSum;
use crate::exec::Exec;
use crate::fft::Fft3;
use crate::real::Real;
use crate::scratch::{ALIGN, Arena, Layout};
use crate::sort::sort_by_key;
use crate::status::{Error, Result};
use crate::within::Within;

/// No shell, no mesh.
const NONE: u32 = u32::MAX;

/// Reals of `count` meshes for [`bispectrum`]: each is `fft.length()`, rounded up to whole cache lines.
///
/// # Errors
/// `Overflow` if they do not fit the address space.
///
/// # Example
/// ```
/// # use fixpair::{exec::Serial, fft::{Tables, Transform}, mesh::{Brick, Space}};
/// # #[repr(align(64))] struct Memory([u8; 1 << 16]);
/// # let (mut tables, mut work) = (Memory([0; 1 << 16]), Memory([0; 1 << 16]));
/// # let tables = Tables::<f64>::new(8, &mut tables.0)?;
/// # let mut fft = Transform::new(&tables, Brick::whole(8, Space::Configuration)?, &mut work.0, &Serial)?;
/// use fixpair::estimate::bispectrum::bispectrum_meshes;
///
/// assert!(bispectrum_meshes::<f64>(&fft, 3)? >= 3 * 8 * 8 * 10); // reals of three meshes
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn bispectrum_meshes<T: Real>(fft: &dyn Fft3<T>, count: usize) -> Result<usize> {
    let reals = apart(fft).checked_mul(count).ok_or(Error::Overflow)?;
    Layout::EMPTY.and::<T>(reals).map(|_| reals)
}

fn apart<T: Real>(fft: &dyn Fft3<T>) -> usize {
    fft.length().next_multiple_of(ALIGN / size_of::<T>())
}

/// Scratch of [`bispectrum`]: that of [`super::bispectrum_sums_scratch`] on the cells of `fft`, 16 S bytes more, and a few cache lines.
///
/// # Errors
/// `Overflow` if the bytes do not fit the address space.
///
/// # Example
/// ```
/// # use fixpair::{exec::Serial, fft::{Tables, Transform}, mesh::{Brick, Space}};
/// # #[repr(align(64))] struct Memory([u8; 1 << 16]);
/// # let (mut tables, mut work) = (Memory([0; 1 << 16]), Memory([0; 1 << 16]));
/// # let tables = Tables::<f64>::new(8, &mut tables.0)?;
/// # let mut fft = Transform::new(&tables, Brick::whole(8, Space::Configuration)?, &mut work.0, &Serial)?;
/// use fixpair::estimate::bispectrum::bispectrum_scratch;
///
/// assert!(bispectrum_scratch::<f64>(&fft, 2, 4)?.size > 0);
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn bispectrum_scratch<T: Real>(fft: &dyn Fft3<T>, shells: usize, triangles: usize) -> Result<Layout> {
    let layout = Layout::EMPTY.and::<ExactSum>(triangles)?.and::<u32>(triangles)?;
    let layout = layout.and::<u32>(shells)?.and::<u32>(shells)?.and::<[u32; 2]>(shells)?;
    Work::<T>::layout(layout, fft.configuration(), shells, triangles)
}

/// Adds sum over cells of D_i D_j D_k, for every triangle of a list, to `sums`, and returns the number of transforms that it took.
///
/// `sums`: one for each triangle, all zero at first. `modes`: delta_k on `fft.fourier()`. `fields`: M >= 3 meshes of
/// [`bispectrum_meshes`]`(fft, 1)` reals each, overwritten; with M = S, the number of shells, each shell is transformed once. With 40 shells
/// and all their triangles 20 meshes take 116 transforms, 10 meshes 408, 3 meshes 5474. `edges`: S + 1 of them.
/// The bits of `sums` depend on none of these, nor on threads. Where `fft` holds a part of the mesh, all processes call with the same M and
/// triangles, and add their sums.
///
/// # Errors
/// `Table` for edges that do not increase, `Range` for shells that reach the Nyquist planes and for triangles of shells that are
/// not there, `Length` for short arrays, fewer than 3 meshes, or unless there is a sum for each triangle; `Overflow` for more than 2^30
/// triangles, `Scratch`, `Alignment`; `NotFinite` as [`super::bispectrum_sums`]; what `fft` and `exec` return. `sums` is
/// untouched by all of them.
///
/// Cost: for each transform also one pass over `modes` and a mesh; products as [`super::bispectrum_sums`].
///
/// # Example
/// ```
/// # use fixpair::{exec::Serial, fft::{Tables, Transform}, mesh::{Brick, Space}};
/// # #[repr(align(64))] struct Memory([u8; 1 << 16]);
/// # let (mut tables, mut work) = (Memory([0; 1 << 16]), Memory([0; 1 << 16]));
/// # let tables = Tables::<f64>::new(8, &mut tables.0)?;
/// # let mut fft = Transform::new(&tables, Brick::whole(8, Space::Configuration)?, &mut work.0, &Serial)?;
/// use fixpair::estimate::bispectrum::{bispectrum, bispectrum_meshes, bispectrum_values};
/// use fixpair::estimate::exact::ExactSum;
/// # #[repr(align(64))] struct Large([u8; 1 << 18]);
/// # let mut memory = Large([0; 1 << 18]);
/// # let scratch = &mut memory.0;
///
/// let modes = vec![1.0; 640]; // one cell of mass n^3: every mode is 1
/// let (mut sums, mut value) = ([ExactSum::ZERO], [0.0]);
/// let mut fields = vec![0.0; bispectrum_meshes::<f64>(&fft, 3)?];
/// bispectrum(&mut sums, &[[0, 0, 0]], &[1, 4], &modes, &mut fft, &mut fields, scratch, &Serial)?;
/// bispectrum_values(&mut value, &sums)?;
/// let triples = value[0] / 512.0; // each of the ordered triples that close adds n^3
/// assert!(triples > 100.0 && (triples - triples.round()).abs() < 1e-9);
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn bispectrum<T: Real>(
    sums: &mut [ExactSum],
    triangles: &[Triangle],
    edges: &[u64],
    modes: &[T],
    fft: &mut dyn Fft3<T>,
    fields: &mut [T],
    scratch: &mut [u8],
    exec: &dyn Exec,
) -> Result<usize> {
    let (cells, fourier, length, apart) = (*fft.configuration(), *fft.fourier(), fft.length(), apart(fft));
    check_shells(edges, cells.n())?;
    let shells = edges.len() - 1;
    check_triangles(triangles, shells)?;
    fourier.check_length(modes)?;
    let meshes = fields.len().checked_div(apart).unwrap_or(shells);
    if sums.len() != triangles.len() || meshes < 3.min(shells) {
        return Err(Error::Length);
    }
    let layout = bispectrum_scratch(fft, shells, triangles.len())?;
    let mut arena = Arena::new(scratch, layout)?;
    let exact = arena.take::<ExactSum>(triangles.len())?;
    let order = arena.take::<u32>(triangles.len())?;
    let ranks = arena.take::<u32>(shells)?;
    let needed = arena.take::<u32>(shells)?;
    // Shell in each mesh, and the last batch that needed it. More meshes than shells are of no use.
    let places = arena.take::<[u32; 2]>(shells)?;
    let mut work = Work::take(&mut arena, &cells, shells, triangles.len())?;
    let places = places.part_mut(..shells.min(meshes));
    exact.fill(ExactSum::ZERO);
    number(order);
    places.fill([NONE, 0]);
    needed.fill(0);
    let groups = Groups::new(ranks, triangles, places.len());
    sort_by_key(order, |&t| (groups.turn(triangles.at(t as usize)), t));
    let (mut transforms, mut batch, mut at) = (0, 0, 0);
    // Transforms may be collective: a process whose sums are not finite goes on to the end with the others.
    let mut outcome = Ok(());
    while at < order.len() {
        let turn = |t: u32| groups.turn(triangles.at(t as usize));
        let pair = turn(order.at(at)).0;
        let pair_end = at + order.part(at..).partition_point(|&t| turn(t).0 == pair);
        let resident = at..pair_end;
        while at < pair_end {
            batch += 1;
            let end = groups.batch_end(order, at, pair_end, triangles);
            let in_pair = order
                .part(resident.clone())
                .iter()
                .flat_map(|&t| distinct(triangles.at(t as usize)).filter(|&s| groups.in_pair(pair, s)));
            let in_batch = order.part(at..end).iter().flat_map(|&t| distinct(triangles.at(t as usize)));
            for shell in in_pair.chain(in_batch) {
                needed.put(shell as usize, batch);
            }
            for [shell, last] in places.iter_mut() {
                if *shell != NONE && needed.at(*shell as usize) == batch {
                    *last = batch;
                }
            }
            for shell in 0..shells {
                if needed.at(shell) != batch || places.iter().any(|place| place[0] == shell as u32) {
                    continue;
                }
                let oldest = places.iter().enumerate().min_by_key(|(_, place)| place[1]);
                let Some(mesh) = oldest.map(|(mesh, _)| mesh) else { return Err(Error::Length) };
                places.put(mesh, [shell as u32, batch]);
                let field = fields.part_mut(mesh * apart..mesh * apart + length);
                shell_modes(field, modes, &fourier, edges.at(shell), edges.at(shell + 1), exec)?;
                fft.inverse(field)?;
                transforms += 1;
            }
            let (shared, places) = (&*fields, &*places);
            let field = |shell: usize| {
                let mesh = places.iter().position(|place| place[0] == shell as u32);
                mesh.map_or(&shared[..0], |mesh| shared.part(mesh * apart..mesh * apart + length))
            };
            if outcome.is_ok() {
                let order = order.part_mut(at..end);
                match accumulate(exact, triangles, order, &field, &cells, &mut work, exec) {
                    Err(Error::NotFinite) => outcome = Err(Error::NotFinite),
                    other => other?,
                }
            }
            at = end;
        }
    }
    outcome?;
    merge(sums, exact);
    Ok(transforms)
}

/// How shells are dealt out.
struct Groups<'a> {
    /// Place of each shell among those in use.
    ranks: &'a [u32],
    /// Shells of a group.
    size: u32,
    /// Shells that are brought in at a time.
    third: usize,
    count: u32,
}

impl<'a> Groups<'a> {
    fn new(ranks: &'a mut [u32], triangles: &[Triangle], meshes: usize) -> Self {
        ranks.fill(NONE);
        for &shell in triangles.iter().flatten() {
            ranks.put(shell as usize, 0);
        }
        let mut used = 0;
        for rank in ranks.iter_mut().filter(|rank| **rank == 0) {
            *rank = used;
            used += 1;
        }
        let third = (meshes / 5).max(1);
        let size = if used as usize <= meshes { used.max(1) } else { ((meshes - third) as u32 / 2).max(1) };
        Self { ranks, size, third, count: used.div_ceil(size) }
    }

    fn group(&self, shell: u32) -> u32 {
        self.ranks.at(shell as usize) / self.size.max(1)
    }

    /// When a triangle has its turn: with which pair of groups, and with which third shell, 0 where all are in the pair.
    fn turn(&self, triangle: Triangle) -> ((u32, u32), u32) {
        let [i, j, k] = sorted(triangle);
        let [a, b, c] = [i, j, k].map(|shell| self.group(shell));
        let (a, b) = match (a == b, b == c) {
            (false, _) => (a, b),
            (true, false) => (b, c),
            (true, true) if a + 1 < self.count => (a, a + 1),
            (true, true) => (a.saturating_sub(1), a),
        };
        // Up and down in turns, so that only one group changes from pair to pair.
        let step = if a % 2 == 0 { b } else { self.count - 1 - b };
        let third = if self.in_pair((a, step), k) { 0 } else { 1 + self.ranks.at(k as usize) };
        ((a, step), third)
    }

    fn in_pair(&self, (a, step): (u32, u32), shell: u32) -> bool {
        let b = if a.is_multiple_of(2) { step } else { self.count - 1 - step };
        let group = self.group(shell);
        group == a || group == b
    }

    /// The end of the triangles from `at` on that the meshes can serve together.
    fn batch_end(&self, order: &[u32], at: usize, end: usize, triangles: &[Triangle]) -> usize {
        let third = |place: usize| self.turn(triangles.at(order.at(place) as usize)).1;
        let (mut last, mut thirds) = (0, 0);
        for place in at..end {
            if third(place) != last {
                if thirds == self.third {
                    return place;
                }
                (last, thirds) = (third(place), thirds + 1);
            }
        }
        end
    }
}
