//! One pass over a brick that sums products of its points bin by bin: the engine of power spectra and correlation functions.
//!
//! Invariants: what is added to a bin for a row depends on the row alone; everything else is an exact sum. So the number of pieces that the
//! work is cut into, the threads that run them, and the bricks that a mesh is cut into along x or y change no bit.

use super::binning::{Checked, GEOMETRY, Second, add_geometry, carry_geometry};
use super::exact::{ExactSum, TERMS};
use super::line::{Line, Lines, Place};
use crate::exec::{Exec, Shared};
use crate::mesh::{Brick, Space};
use crate::scratch::{Arena, Layout};
use crate::simd::Simd;
use crate::status::{Error, Result};

/// The products p(n) of the points of a row.
pub(super) trait Source: Sync {
    /// Products to sum.
    fn spectra(&self) -> usize;

    /// Writes the products of the first points of row (i, j), which begins at element `offset`, times their weight: `even` for even
    /// multipoles, and `odd` for odd ones if `with_odd`.
    fn row(
        &self,
        spectrum: usize,
        index: [usize; 2],
        offset: usize,
        even: &mut [f64],
        odd: &mut [f64],
        with_odd: bool,
    );
}

/// Bytes of partial sums that pieces may take together.
const PARTIAL: usize = 1 << 26;

/// Pieces of the work: many enough for many threads, unless their sums take too much memory. Any number gives the same bits.
fn pieces(brick: &Brick, checked: &Checked<'_>, spectra: usize) -> Result<usize> {
    let bytes = checked.words(spectra)?.checked_mul(8).ok_or(Error::Overflow)?;
    let most = (PARTIAL / bytes).clamp(2, 64);
    Ok(if brick.is_empty() { 0 } else { brick.count()[outer_axis(brick)].min(most) })
}

/// The axis, 0 or 1, whose indices are dealt out to pieces: the outer one in memory.
fn outer_axis(brick: &Brick) -> usize {
    usize::from(brick.stride()[1] > brick.stride()[0])
}

/// |n|^2 beyond the mesh's corner need no entry.
fn lookup_length(brick: &Brick, checked: &Checked<'_>) -> Result<usize> {
    let half = brick.n() as u64 / 2;
    let last = checked.edges[checked.edges.len() - 1];
    usize::try_from(last.min(3 * half * half + 1)).map_err(|_| Error::Overflow)
}

/// Does the geometry of a row depend on n_x^2 + n_y^2 alone? Rows of one such number are then counted, and done once.
fn symmetric(checked: &Checked<'_>) -> bool {
    matches!(checked.second, Second::None) || (checked.axis[0] == 0.0 && checked.axis[1] == 0.0)
}

fn histogram_length(brick: &Brick, checked: &Checked<'_>) -> usize {
    let half = brick.n() / 2;
    if symmetric(checked) { 2 * half * half + 1 } else { 0 }
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
        let edge = edges[edges.len() - 1];
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
        .and::<ExactSum>(sums)?;
    let line = Line::layout(Layout::EMPTY, length)?.size;
    layout.and::<u8>(line.checked_mul(pieces).ok_or(Error::Overflow)?)
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
    let lines_memory = arena.take::<u8>(pieces * line_bytes.size)?;

    let mut range = 0;
    for (square, entry) in lookup.iter_mut().enumerate() {
        while range < checked.edges.len() && checked.edges[range] <= square as u64 {
            range += 1;
        }
        // Below the first edge 0; the last edge is beyond the table.
        *entry = range as u32;
    }
    thresholds(checked, thresholds_of);
    for m in 0..length {
        let mode = Brick::mode(brick.n(), brick.start()[2] + m);
        z[m] = mode as f64;
        z_square[m] = (mode * mode) as u64;
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

    let histogram = if symmetric(checked) { Some(count_rows(histogram, &rows)) } else { None };
    {
        let shared = Shared::new(geometry);
        exec.parallel_for(pieces, &|piece| {
            // SAFETY: each piece has `bins` entries of its own and runs once.
            let partial = unsafe { shared.part(piece * bins, bins) };
            partial.fill([0; GEOMETRY]);
            // The memory was laid out for it.
            let Ok(mut line) = line_of(piece) else { return };
            let mut add = |place: Place, times: i64| {
                lines.geometry(place, &mut line, |bin, stretch| {
                    add_geometry(&mut partial[bin], stretch, times);
                });
            };
            match &histogram {
                Some(histogram) => {
                    // Dealt out like cards: large squares have fewer points inside the last edge.
                    for (square, &times) in histogram.iter().enumerate().skip(piece).step_by(pieces) {
                        if times > 0 {
                            add(Place { square: square as u64, across: 0.0 }, i64::from(times));
                        }
                    }
                }
                None => rows.for_each(piece, |place, _, _| add(place, 1)),
            }
        })?;
    }
    {
        let shared = Shared::new(sums);
        exec.parallel_for(pieces, &|piece| {
            // SAFETY: each piece has `bins * each` sums of its own and runs once.
            let partial = unsafe { shared.part(piece * bins * each, bins * each) };
            partial.fill(ExactSum::ZERO);
            let Ok(mut line) = line_of(piece) else { return };
            let mut terms = 0;
            rows.for_each(piece, |place, index, offset| {
                terms += length as u64;
                if terms > TERMS {
                    partial.iter_mut().for_each(ExactSum::carry);
                    terms = length as u64;
                }
                simd.vectorise(
                    #[inline(always)]
                    || sum_row(partial, &lines, &mut line, source, place, index, offset),
                );
            });
            partial.iter_mut().for_each(ExactSum::carry);
        })?;
    }

    let (counts, products) = words.split_at_mut(bins * GEOMETRY);
    let counts = counts.as_chunks_mut::<GEOMETRY>().0;
    for partial in geometry.chunks_exact(bins) {
        for (words, partial) in counts.iter_mut().zip(partial) {
            words.iter_mut().zip(partial).for_each(|(word, term)| *word = word.wrapping_add(*term));
        }
    }
    counts.iter_mut().for_each(carry_geometry);
    let products = ExactSum::in_words(products);
    for partial in sums.chunks_exact(bins * each) {
        products.iter_mut().zip(partial).for_each(|(sum, partial)| sum.merge(partial));
    }
    products.iter_mut().for_each(ExactSum::carry);
    Ok(())
}

/// Adds one row to the sums of its bins.
#[inline(always)]
fn sum_row<S: Source>(
    sums: &mut [ExactSum],
    lines: &Lines<'_>,
    line: &mut Line<'_>,
    source: &S,
    place: Place,
    index: [usize; 2],
    offset: usize,
) {
    let (points, runs) = lines.bins(place, line);
    if points == 0 {
        return;
    }
    let orders = lines.checked.orders;
    let multipoles = orders.count_ones() as usize;
    let each = source.spectra() * multipoles;
    for spectrum in 0..source.spectra() {
        source.row(
            spectrum,
            index,
            offset,
            &mut line.even[..points],
            &mut line.odd[..points],
            orders & 0b1010 != 0,
        );
        for parity in [0, 1] {
            let (coefficients, places) = lanes(orders, parity);
            if places == [None; 4] {
                continue;
            }
            if parity == 0 {
                line.sum_even(points, &coefficients);
            } else {
                line.sum_odd(points, &coefficients);
            }
            line.for_each_run(runs, |bin, values| {
                let sums = &mut sums[bin * each + spectrum * multipoles..][..multipoles];
                for (lane, place) in places.iter().enumerate() {
                    if let Some(place) = *place {
                        sums[place].add(values[lane]);
                    }
                }
            });
        }
    }
}

/// Counts the rows of each n_x^2 + n_y^2.
fn count_rows<'h>(histogram: &'h mut [u32], rows: &Rows<'_>) -> &'h [u32] {
    histogram.fill(0);
    for piece in 0..rows.pieces {
        rows.for_each(piece, |place, _, _| histogram[place.square as usize] += 1);
    }
    histogram
}

/// The rows along axis 2 of a brick, in pieces.
struct Rows<'a> {
    brick: &'a Brick,
    axis: [f64; 3],
    pieces: usize,
}

impl Rows<'_> {
    /// Calls `visit(place, [i, j], offset)`.
    #[inline(always)]
    fn for_each(&self, piece: usize, mut visit: impl FnMut(Place, [usize; 2], usize)) {
        let (n, start, count, stride) =
            (self.brick.n(), self.brick.start(), self.brick.count(), self.brick.stride());
        let outer = outer_axis(self.brick);
        let inner = 1 - outer;
        // The product fits: there are at most 64 pieces.
        for o in piece * count[outer] / self.pieces..(piece + 1) * count[outer] / self.pieces {
            for i in 0..count[inner] {
                let mut index = [0; 2];
                index[outer] = start[outer] + o;
                index[inner] = start[inner] + i;
                let [x, y] = index.map(|index| Brick::mode(n, index));
                let place = Place {
                    square: (x * x + y * y) as u64,
                    across: self.axis[0] * x as f64 + self.axis[1] * y as f64,
                };
                visit(place, index, o * stride[outer] + i * stride[inner]);
            }
        }
    }
}
