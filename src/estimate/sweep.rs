//! One pass over a brick that sums products of its points bin by bin: the engine of power spectra and correlation functions.
//!
//! Invariants: what is added to a bin for a row depends on the row alone; everything else is an exact sum. So the number of pieces that the
//! work is cut into, the threads that run them, and the bricks that a mesh is cut into along x or y change no bit.

use super::binning::{Checked, GEOMETRY, Second, add_geometry, carry_geometry};
use super::exact::ExactSum;
use super::front::{FRONT_TERMS, Front};
use super::line::{Line, Lines, Place, TOGETHER};
use super::rows::{Row, Rows, leaders, outer_axis};
use crate::exec::{Exec, Shared};
use crate::mesh::{Brick, Space};
use crate::scratch::{Arena, Layout};
use crate::simd::Simd;
use crate::status::{Error, Result};
use crate::within::Within;

/// The products p(n) of the points of a row.
pub(super) trait Source: Sync {
    /// Products to sum.
    fn spectra(&self) -> usize;

    /// Writes the products of the first points of row (i, j), which begins at element `offset`, times their weight: those for even multipoles,
    /// or those for odd ones.
    fn row(&self, spectrum: usize, index: [usize; 2], offset: usize, odd: bool, products: &mut [f64]);
}

/// Bytes of partial sums that pieces may take together.
const PARTIAL: usize = 1 << 26;

/// Pieces of the work: many enough for many threads, unless their sums take too much memory. Any number gives the same bits.
fn pieces(brick: &Brick, checked: &Checked<'_>, spectra: usize) -> Result<usize> {
    let bytes = checked.words(spectra)?.checked_mul(8).ok_or(Error::Overflow)?;
    let most = PARTIAL.checked_div(bytes).unwrap_or(0).clamp(2, 64);
    Ok(if brick.is_empty() { 0 } else { leaders(brick, outer_axis(brick)).min(most) })
}

/// |n|^2 beyond the mesh's corner need no entry.
fn lookup_length(brick: &Brick, checked: &Checked<'_>) -> Result<usize> {
    let half = brick.n() as u64 / 2;
    let last = checked.edges.last().copied().unwrap_or(0);
    usize::try_from(last.min(3 * half * half + 1)).map_err(|_| Error::Overflow)
}

/// Numbers n_x^2 + n_y^2 for each row of a brick, at most, for which rows of one number are counted together.
const NUMBERS_PER_ROW: usize = 16;

/// Entries to count rows of one n_x^2 + n_y^2 in, whose geometry is then done once: 0 where it depends on more than that number, and where a
/// small part of a large mesh has few rows of many numbers.
fn histogram_length(brick: &Brick, checked: &Checked<'_>) -> usize {
    let half = brick.n() / 2;
    let numbers = 2 * half * half + 1;
    let symmetric =
        matches!(checked.second, Second::None) || (checked.axis[0] == 0.0 && checked.axis[1] == 0.0);
    let rows = brick.count()[0] * brick.count()[1];
    if symmetric && numbers / NUMBERS_PER_ROW <= rows { numbers } else { 0 }
}

/// Edges of the second coordinate to hold its square against.
fn thresholds(checked: &Checked<'_>, out: &mut [f64]) {
    // A mu or |n.a| on an edge, however it was rounded, lies above it.
    const LOWER: f64 = 1.0 - 4.0 * f64::EPSILON;
    const UPPER: f64 = 1.0 + 8.0 * f64::EPSILON;
    match checked.second {
        Second::None => {}
        Second::Cosine(edges) | Second::Parallel(edges) => {
            for (out, edge) in out.iter_mut().zip(edges) {
                *out = edge * edge * LOWER;
            }
        }
    }
    if let (Second::Cosine(edges), Some(last)) = (checked.second, out.last_mut()) {
        let edge = edges.at(edges.len() - 1);
        *last = edge * edge * UPPER;
    }
}

fn second_length(checked: &Checked<'_>) -> usize {
    match checked.second {
        Second::None => 0,
        Second::Cosine(edges) | Second::Parallel(edges) => edges.len(),
    }
}

/// Scratch of [`sweep`].
pub(super) fn sweep_scratch(brick: &Brick, checked: &Checked<'_>, spectra: usize) -> Result<Layout> {
    checked.check_geometry(brick.n())?;
    let pieces = pieces(brick, checked, spectra)?;
    let length = brick.count()[2];
    let bins = checked.bins().checked_mul(pieces).ok_or(Error::Overflow)?;
    let sums = bins.checked_mul(checked.sums(spectra)?).ok_or(Error::Overflow)?;
    let layout = Layout::EMPTY
        .and::<u32>(lookup_length(brick, checked)?)?
        .and::<f64>(second_length(checked))?
        .and::<f64>(length)?
        .and::<u64>(length)?
        .and::<f64>(length)?
        .and::<u32>(histogram_length(brick, checked))?
        .and::<[i64; GEOMETRY]>(bins)?
        .and::<ExactSum>(sums)?
        .and::<Front>(bins.checked_mul(fronts(checked, spectra)?).ok_or(Error::Overflow)?)?;
    let line = Line::layout(Layout::EMPTY, length)?.size;
    layout.and::<u8>(line.checked_mul(pieces).ok_or(Error::Overflow)?)
}

/// Fronts of a bin: one for even multipoles and one for odd ones of each spectrum.
fn fronts(checked: &Checked<'_>, spectra: usize) -> Result<usize> {
    checked.sums(spectra)?;
    Ok(spectra * [0b10101, 0b01010].iter().filter(|&&mask| checked.orders & mask != 0).count())
}

/// Weights of the points of a row: the planes l = 0 and l = n/2 hold both members of each Hermitian pair, the others one.
pub(super) fn weights(brick: &Brick, out: &mut [f64]) {
    for (m, weight) in out.iter_mut().enumerate() {
        let z = brick.start()[2] + m;
        let both = brick.space() == Space::Configuration || z == 0 || 2 * z == brick.n();
        *weight = if both { 1.0 } else { 2.0 };
    }
}

/// Legendre polynomials in powers of mu^2 (odd ones: after a factor mu), a lane each.
fn lanes(orders: u32, parity: u32) -> ([[f64; 4]; 3], [Option<usize>; 4]) {
    let mut coefficients = [[0.0; 4]; 3];
    let mut places = [None; 4];
    for (place, order) in super::binning::order_numbers(orders).enumerate() {
        if order % 2 == parity {
            let lane = order as usize / 2;
            let polynomial = match order {
                0 | 1 => [1.0, 0.0, 0.0],
                2 => [-0.5, 1.5, 0.0],
                3 => [-1.5, 2.5, 0.0],
                _ => [0.375, -3.75, 4.375],
            };
            for (power, coefficient) in polynomial.into_iter().enumerate() {
                coefficients[power][lane] = coefficient;
            }
            places[lane] = Some(place);
        }
    }
    (coefficients, places)
}

/// Adds the sums of all points of a brick to `words`.
///
/// # Errors
/// `Length` for words of another binning, `Scratch`, `Alignment`, `Hook`; nothing is then added.
pub(super) fn sweep<S: Source>(
    words: &mut [i64],
    brick: &Brick,
    checked: &Checked<'_>,
    source: &S,
    scratch: &mut [u8],
    exec: &dyn Exec,
    simd: Simd,
) -> Result<()> {
    let spectra = source.spectra();
    if words.len() != checked.words(spectra)? {
        return Err(Error::Length);
    }
    let mut arena = Arena::new(scratch, sweep_scratch(brick, checked, spectra)?)?;
    let (pieces, length) = (pieces(brick, checked, spectra)?, brick.count()[2]);
    let (bins, each) = (checked.bins(), checked.sums(spectra)?);
    let lookup = arena.take::<u32>(lookup_length(brick, checked)?)?;
    let thresholds_of = arena.take::<f64>(second_length(checked))?;
    let (z, z_square, weight) =
        (arena.take::<f64>(length)?, arena.take::<u64>(length)?, arena.take::<f64>(length)?);
    let histogram = arena.take::<u32>(histogram_length(brick, checked))?;
    let geometry = arena.take::<[i64; GEOMETRY]>(pieces * bins)?;
    let sums = arena.take::<ExactSum>(pieces * bins * each)?;
    let line_bytes = Line::layout(Layout::EMPTY, length)?;
    let apart = fronts(checked, spectra)?;
    let front_count = bins * apart;
    let fronts_memory = arena.take::<Front>(pieces * front_count)?;
    let lines_memory = arena.take::<u8>(pieces * line_bytes.size)?;

    let mut range = 0;
    for (square, entry) in lookup.iter_mut().enumerate() {
        while checked.edges.get(range).is_some_and(|&edge| edge <= square as u64) {
            range += 1;
        }
        // Below the first edge 0; the last edge is beyond the table.
        *entry = range as u32;
    }
    thresholds(checked, thresholds_of);
    for (m, (z, z_square)) in z.iter_mut().zip(&mut *z_square).enumerate() {
        let mode = Brick::mode(brick.n(), brick.start()[2] + m);
        *z = mode as f64;
        *z_square = (mode * mode) as u64;
    }
    weights(brick, weight);
    let lines = Lines {
        checked: *checked,
        lookup,
        thresholds: thresholds_of,
        z,
        z_square,
        weight,
        increasing: brick.space() == Space::Fourier,
    };
    let rows = Rows { brick, axis: checked.axis, pieces };
    let memory = Shared::new(lines_memory);
    let line_of = |piece: usize| {
        // SAFETY: each piece has `line_bytes.size` bytes of its own and runs once at a time.
        let memory = unsafe { memory.part(piece * line_bytes.size, line_bytes.size) };
        Arena::new(memory, line_bytes).and_then(|mut arena| Line::take(&mut arena, length))
    };

    let histogram = if histogram.is_empty() { None } else { Some(count_rows(histogram, &rows)) };
    {
        let shared = Shared::new(geometry);
        exec.parallel_for(pieces, &|piece| {
            // SAFETY: each piece has `bins` entries of its own and runs once.
            let partial = unsafe { shared.part(piece * bins, bins) };
            partial.fill([0; GEOMETRY]);
            // The memory was laid out for it.
            let Ok(mut line) = line_of(piece) else { return };
            let mut add = |place: Place, times: i64| {
                simd.vectorise(
                    #[inline(always)]
                    || {
                        lines.geometry(place, &mut line, |bin, stretch| {
                            if let Some(sums) = partial.get_mut(bin) {
                                add_geometry(sums, stretch, times);
                            }
                        });
                    },
                );
            };
            match &histogram {
                Some(histogram) => {
                    // Dealt out like cards: large squares have fewer points inside the last edge.
                    for (square, &times) in histogram.iter().enumerate().skip(piece).step_by(pieces.max(1)) {
                        if times > 0 {
                            add(Place { square: square as u64, across: 0.0 }, i64::from(times));
                        }
                    }
                }
                None => rows.for_each(piece, |group| group.iter().for_each(|row| add(row.place, 1))),
            }
        })?;
    }
    {
        let (shared, shared_fronts) = (Shared::new(sums), Shared::new(fronts_memory));
        let groups = groups(checked);
        exec.parallel_for(pieces, &|piece| {
            // SAFETY: each piece has so many sums and fronts of its own and runs once.
            let (sums, fronts) = unsafe {
                (
                    shared.part(piece * bins * each, bins * each),
                    shared_fronts.part(piece * front_count, front_count),
                )
            };
            sums.fill(ExactSum::ZERO);
            fronts.fill(Front::ZERO);
            let Ok(mut line) = line_of(piece) else { return };
            let multipoles = each.checked_div(spectra).unwrap_or(0);
            let mut partial = Partial { sums, fronts, apart, each, multipoles, groups: &groups, spectra };
            let mut terms = 0;
            rows.for_each(piece, |group| {
                // No row adds more than `length` runs to a bin.
                terms += (TOGETHER * length) as u64;
                if terms > FRONT_TERMS {
                    partial.settle();
                    terms = (TOGETHER * length) as u64;
                }
                simd.vectorise(
                    #[inline(always)]
                    || sum_rows(&mut partial, &lines, &mut line, source, group),
                );
            });
            partial.settle();
        })?;
    }

    let (counts, products) = words.split_at_mut_checked(bins * GEOMETRY).ok_or(Error::Length)?;
    let counts = counts.as_chunks_mut::<GEOMETRY>().0;
    for partial in geometry.chunks_exact(bins.max(1)) {
        for (words, partial) in counts.iter_mut().zip(partial) {
            words.iter_mut().zip(partial).for_each(|(word, term)| *word = word.wrapping_add(*term));
        }
    }
    counts.iter_mut().for_each(carry_geometry);
    let products = ExactSum::in_words(products);
    for partial in sums.chunks_exact((bins * each).max(1)) {
        products.iter_mut().zip(partial).for_each(|(sum, partial)| sum.merge(partial));
    }
    products.iter_mut().for_each(ExactSum::carry);
    Ok(())
}

/// Multipoles of one parity: their polynomials, a lane each, and their places among all multipoles.
struct Group {
    odd: bool,
    polynomials: [[f64; 4]; 3],
    places: [Option<usize>; 4],
}

/// Even multipoles and odd ones, where there are any.
fn groups(checked: &Checked<'_>) -> [Option<Group>; 2] {
    let group = |parity: u32| {
        let (polynomials, places) = lanes(checked.orders, parity);
        (places != [None; 4]).then_some(Group { odd: parity == 1, polynomials, places })
    };
    [group(0), group(1)]
}

/// What one piece has summed.
struct Partial<'a> {
    sums: &'a mut [ExactSum],
    fronts: &'a mut [Front],
    /// Fronts and sums of a bin, and its sums of one spectrum.
    apart: usize,
    each: usize,
    multipoles: usize,
    groups: &'a [Option<Group>; 2],
    spectra: usize,
}

impl Partial<'_> {
    /// Adds the runs of one row; `front` counts the fronts of a bin.
    #[inline(always)]
    fn add(
        &mut self,
        line: &Line<'_>,
        row: usize,
        runs: usize,
        spectrum: usize,
        front: usize,
        group: &Group,
    ) {
        line.for_each_run(row, runs, |bin, values| {
            let Some(front) = self.fronts.get_mut(bin * self.apart + front) else { return };
            if !front.add(values) {
                let first = bin * self.each + spectrum * self.multipoles;
                let sums = self.sums.part_mut(first..first + self.multipoles);
                front.add_slowly(values, sums, &group.places);
            }
        });
    }

    /// Moves everything to the exact sums, in their one form.
    fn settle(&mut self) {
        let bins =
            self.fronts.chunks_exact_mut(self.apart.max(1)).zip(self.sums.chunks_exact_mut(self.each.max(1)));
        for (fronts, sums) in bins {
            let mut fronts = fronts.iter_mut();
            for sums in sums.chunks_exact_mut(self.multipoles.max(1)) {
                for (group, front) in self.groups.iter().flatten().zip(&mut fronts) {
                    front.flush(sums, &group.places);
                }
            }
        }
        self.sums.iter_mut().for_each(ExactSum::carry);
    }
}

/// Adds rows (+-i, +-j) to the sums of their bins.
#[inline(always)]
fn sum_rows<S: Source>(
    partial: &mut Partial<'_>,
    lines: &Lines<'_>,
    line: &mut Line<'_>,
    source: &S,
    rows: &[Row],
) {
    let (together, same_angles) = (lines.same_bins(), lines.same_angles() || lines.checked.orders == 1);
    let groups = partial.groups;
    let parities = groups.iter().flatten().count();
    let (mut points, mut runs) = (0, 0);
    // Rows summed side by side: all of them (1, 2 or 4) where they have the same angles, else one after another.
    let step = if together && same_angles { rows.len() } else { 1 };
    for (part, rows) in rows.chunks(step.max(1)).enumerate() {
        let Some(first) = rows.first() else { continue };
        if part == 0 || !together {
            (points, runs) = lines.bins(first.place, line);
        } else if !same_angles {
            lines.angles(first.place, line, points);
        }
        if points == 0 {
            continue;
        }
        for spectrum in 0..partial.spectra {
            for (parity, group) in groups.iter().flatten().enumerate() {
                let front = spectrum * parities + parity;
                if group.odd {
                    for row in rows {
                        if rows.len() > 1 {
                            lines.angles(row.place, line, points);
                        }
                        source.row(spectrum, row.index, row.offset, true, line.products(0, points));
                        line.sum_odd(points, &group.polynomials);
                        partial.add(line, 0, runs, spectrum, front, group);
                    }
                } else {
                    for (r, row) in rows.iter().enumerate() {
                        source.row(spectrum, row.index, row.offset, false, line.products(r, points));
                    }
                    line.sum(rows.len(), points, &group.polynomials);
                    for r in 0..rows.len() {
                        partial.add(line, r, runs, spectrum, front, group);
                    }
                }
            }
        }
    }
}

/// Counts the rows of each n_x^2 + n_y^2.
fn count_rows<'h>(histogram: &'h mut [u32], rows: &Rows<'_>) -> &'h [u32] {
    histogram.fill(0);
    for piece in 0..rows.pieces {
        rows.for_each(piece, |group| {
            let place = group.first().map_or(0, |row| row.place.square as usize);
            if let Some(times) = histogram.get_mut(place) {
                *times += group.len() as u32;
            }
        });
    }
    histogram
}
