//! The modes of N-GenIC, 2LPTic and FastPM: each column (i, j) has a stream of its own along l, from the seed of a table.
//!
//! A first pass draws the table, in order, and leaves in each column the seeds that it needs, where its modes will be
//! ([`Slots`]). A second, in any order, draws the streams of a few columns together, in the lanes of vector instructions.

use core::num::NonZero;

use super::blocks::Shape;
use super::ranlux::{Lanes, Ranlxd1, uniform};
use super::realisation::{Realisation, Scheme};
use super::seeds::{Slots, mirrored};
use crate::exec::{Exec, Shared};
use crate::mesh::Brick;
use crate::real::Real;
use crate::simd::Simd;
use crate::status::Result;
use crate::within::Within;

/// Columns that are drawn together.
pub(super) const LANES: usize = 8;
/// Modes of a column in a dozen of numbers.
const MODES: usize = 6;
const BLOCK: usize = MODES * LANES;

/// The brick's modes in the scheme of N-GenIC or FastPM; `out` holds the brick.
pub(super) fn draw<T: Real>(
    out: &mut [T],
    brick: &Brick,
    realisation: &Realisation,
    colour: Option<&[f64]>,
    exec: &dyn Exec,
    simd: Simd,
) -> Result<()> {
    if brick.is_empty() {
        return Ok(());
    }
    let slots = Slots::new(brick);
    slots.leave(out, brick, realisation.seed);
    // Columns that are drawn together lie near each other.
    let (start, count, stride) = (brick.start(), brick.count(), brick.stride());
    let inner = usize::from(count[0] == 1 || count[1] > 1 && stride[1] <= stride[0]);
    let (along, across) = (count[inner], count[1 - inner]);
    let groups = NonZero::new(along.div_ceil(LANES)).unwrap_or(NonZero::<usize>::MIN);
    let columns = Columns {
        n: brick.n(),
        first: start[2],
        end: start[2] + count[2],
        stride: stride[2],
        out: Shared::new(out),
        slots,
        realisation,
        shape: Shape::new(realisation),
        colour,
    };
    exec.parallel_for(groups.get() * across, &|chunk| {
        let (outer, group) = (chunk / groups, chunk % groups);
        let begin = group * LANES;
        let column = |lane: usize| {
            let local = if inner == 0 { [begin + lane, outer] } else { [outer, begin + lane] };
            columns.column(
                [start[0] + local[0], start[1] + local[1]],
                local[0] * stride[0] + local[1] * stride[1],
            )
        };
        let length = LANES.min(along - begin);
        // Lanes to spare draw the last column once more, for nobody.
        let group: [Column; LANES] = core::array::from_fn(|lane| column(lane.min(length - 1)));
        simd.vectorise(
            #[inline(always)]
            || columns.fill(&group, length),
        );
    })
}

/// What the columns of a brick share.
struct Columns<'a, T> {
    n: usize,
    /// The brick's l, and elements from one to the next.
    first: usize,
    end: usize,
    stride: usize,
    out: Shared<'a, T>,
    slots: Slots,
    realisation: &'a Realisation,
    shape: Shape,
    colour: Option<&'a [f64]>,
}

/// The modes of one (i, j).
#[derive(Clone, Copy)]
struct Column {
    index: [usize; 2],
    /// Its first element in the brick.
    offset: usize,
    /// i^2 + j^2.
    square: usize,
    /// Modes from l on are zero.
    drawn: usize,
    /// Is it on the planes the conjugate of (-i, -j)?
    mirrored: bool,
    /// The seed of its stream, and of the stream from which it takes the planes.
    seeds: [u64; 2],
}

impl<T: Real> Columns<'_, T> {
    /// A column whose seeds still lie in the output.
    #[inline(always)]
    fn column(&self, index: [usize; 2], offset: usize) -> Column {
        let [i, j] = index.map(|index| Brick::mode(self.n, index));
        let mirrored = mirrored(self.n, index[0], index[1]);
        Column {
            index,
            offset,
            square: (i * i + j * j) as usize,
            drawn: self.realisation.modes_along_l(self.n, i, j).min(self.end),
            mirrored,
            seeds: self.slots.read(mirrored, |slot| {
                let mode = self.mode(offset, slot);
                [mode[0], mode[1]]
            }),
        }
    }

    /// A mode of the column that begins at `offset`, by its place in the brick.
    #[inline(always)]
    #[expect(
        clippy::mut_from_ref,
        reason = "each column belongs to one chunk, and each borrow ends before the next"
    )]
    fn mode(&self, offset: usize, local: usize) -> &mut [T] {
        // SAFETY: the element is inside the brick, and the brick inside `out` (checked by `white_modes`). No two elements of
        // a brick share an address, chunks have no column in common, each runs once, and none keeps the reference.
        unsafe { self.out.part(2 * (offset + local * self.stride), 2) }
    }

    /// The mode l.
    #[inline(always)]
    fn set(&self, column: &Column, l: usize, mode: [T; 2]) {
        self.mode(column.offset, l - self.first).copy_from_slice(&mode);
    }

    /// Writes the unit mode l.
    #[inline(always)]
    fn put(&self, column: &Column, l: usize, unit: [f64; 2]) {
        let factor = self.colour.map_or(1.0, |table| table.at(column.square + l * l));
        self.set(column, l, unit.map(|x| T::from_f64(x * factor)));
    }

    /// All modes of a group of columns, of which the first `length` are written.
    #[inline(always)]
    fn fill(&self, group: &[Column; LANES], length: usize) {
        let columns = group.part(..length);
        let last = columns.iter().map(|column| column.drawn).max().unwrap_or(0);
        let mut streams = Streams::new(group.map(|column| column.seeds[0]));
        for l in (0..last).step_by(MODES) {
            let [u1, u2] = streams.uniforms();
            let from = l.max(self.first);
            if l + MODES <= self.first {
                continue;
            }
            let [re, im] = self.shape.block(&u1, &u2);
            for (lane, column) in columns.iter().enumerate() {
                for l_here in from..column.drawn.min(l + MODES) {
                    let at = (l_here - l) * LANES + lane;
                    self.put(column, l_here, [re.at(at), im.at(at)]);
                }
            }
        }
        for column in columns {
            for l in column.drawn.max(self.first)..self.end {
                self.set(column, l, [T::ZERO; 2]);
            }
        }
        self.planes(columns, group);
    }

    /// The planes where modes have their mirror images: l = 0 and l = n/2.
    #[inline(always)]
    fn planes(&self, columns: &[Column], group: &[Column; LANES]) {
        let half = self.n / 2;
        let own_negative = |index: usize| index == 0 || index == half;
        for plane in [0, half] {
            let held = |column: &Column| self.first <= plane && plane < column.drawn;
            if columns.iter().any(|column| column.mirrored && held(column)) {
                let mut streams = Streams::new(group.map(|column| column.seeds[1]));
                for _ in 0..plane / MODES {
                    streams.uniforms();
                }
                let [u1, u2] = streams.uniforms();
                for (lane, column) in columns.iter().enumerate() {
                    if column.mirrored && held(column) {
                        let at = plane % MODES * LANES + lane;
                        let [re, im] = self.shape.complex(u1.at(at), u2.at(at));
                        self.put(column, plane, [re, -im]);
                    }
                }
            }
            for column in columns {
                if column.index.map(own_negative) == [true; 2] && held(column) {
                    self.own_image(column, plane);
                }
            }
        }
    }

    /// A mode that is its own mirror image: DC, or a real mode of FastPM.
    fn own_image(&self, column: &Column, plane: usize) {
        if column.index == [0; 2] && plane == 0 {
            self.set(column, 0, [T::ZERO; 2]);
            return;
        }
        debug_assert!(self.realisation.scheme == Scheme::FastPm);
        let mut stream = Ranlxd1::new(column.seeds[0]);
        let mut pair = stream.pair();
        for _ in 0..plane {
            pair = stream.pair();
        }
        // FastPM drops the imaginary part of a mode of unit mean square, and with it half the power.
        let [u1, u2] = pair.map(uniform);
        self.put(column, plane, self.shape.real(u1, u2, 0.5));
    }
}

/// The streams of a group of columns: together, until one of them has to draw a number again.
pub(super) enum Streams {
    Together(Lanes<LANES>),
    Apart([Ranlxd1; LANES]),
}

impl Streams {
    #[inline(always)]
    pub(super) fn new(seeds: [u64; LANES]) -> Self {
        Self::Together(Lanes::new(seeds))
    }

    /// u1 and u2 of the next six modes of each column: that of mode m and column c at index m `LANES` + c.
    #[inline(always)]
    pub(super) fn uniforms(&mut self) -> [[f64; BLOCK]; 2] {
        let mut uniforms = [[0.0; BLOCK]; 2];
        if let Self::Together(lanes) = self {
            let dozen = lanes.dozen();
            let mut none_is_zero = true;
            for m in 0..MODES {
                for lane in 0..LANES {
                    let [u1, u2] = [dozen[2 * m][lane], dozen[2 * m + 1][lane]];
                    none_is_zero &= u2 != 0;
                    uniforms[0][m * LANES + lane] = uniform(u1);
                    uniforms[1][m * LANES + lane] = uniform(u2);
                }
            }
            if none_is_zero {
                return uniforms;
            }
            // Once in 2^48 draws: its column falls behind the others, for good.
            let lanes = *lanes;
            *self = Self::Apart(core::array::from_fn(|lane| Ranlxd1::resume(lanes.lane(lane), 0)));
        }
        if let Self::Apart(streams) = self {
            for (lane, stream) in streams.iter_mut().enumerate() {
                for m in 0..MODES {
                    let pair = stream.pair().map(uniform);
                    [uniforms[0][m * LANES + lane], uniforms[1][m * LANES + lane]] = pair;
                }
            }
        }
        uniforms
    }
}
