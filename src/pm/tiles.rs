//! Tiles: columns of cells along z that one thread fills alone.
//!
//! A particle belongs to the tile of the first cell that it touches, and touches at most 3 cells more on an axis; tiles are at least 8 cells
//! wide, so it reaches into the next tile at most. Tiles of one colour have a tile between them on each axis: they touch no common cell.

use core::ops::Range;

use super::frame::Frame;
use super::region::Region;
use crate::real::Real;

/// Tiles at most. More would make the counting sort write to more places than the cache has lines.
const MOST: usize = 4096;

/// How a region is cut into tiles; a function of the region and the window alone.
#[derive(Clone, Copy, Debug)]
pub(super) struct Tiling {
    log_width: u32,
    count: [usize; 2],
    limit: [usize; 2],
    whole: [bool; 2],
}

/// Tiles of one colour.
#[derive(Clone, Copy, Debug)]
pub(super) struct Colour {
    first: [usize; 2],
    count: [usize; 2],
    stride: usize,
}

impl Colour {
    /// Tiles.
    pub(super) const fn len(&self) -> usize {
        self.count[0] * self.count[1]
    }

    /// The number of its tile `i`.
    pub(super) fn tile(&self, i: usize) -> usize {
        let row = i.checked_div(self.count[1]).unwrap_or(0);
        let x = self.first[0] + 2 * row;
        let y = self.first[1] + 2 * (i - row * self.count[1]);
        x * self.stride + y
    }
}

impl Tiling {
    /// `limit`: first cells on each axis.
    pub(super) fn new(region: &Region, limit: [usize; 2]) -> Self {
        let count = region.count();
        let whole = [0, 1].map(|axis| count[axis] == region.n());
        let mut tiling = Self { log_width: 3, count: [1; 2], limit, whole };
        loop {
            tiling.count = limit.map(|cells| (cells >> tiling.log_width).max(1));
            if tiling.len() <= MOST {
                return tiling;
            }
            tiling.log_width += 1;
        }
    }

    pub(super) fn of<T: Real>(region: &Region, frame: &Frame<T>) -> Self {
        Self::new(region, [0, 1].map(|axis| frame.limit[axis].max(0) as usize))
    }

    /// Tiles.
    pub(super) const fn len(&self) -> usize {
        self.count[0] * self.count[1]
    }

    /// The tile of a particle whose first cell has these indices. The last tile on an axis takes what is left over.
    #[inline(always)]
    pub(super) fn tile(&self, x: i32, y: i32) -> u16 {
        let [last_x, last_y] = self.count.map(|count| count as i32 - 1);
        let (x, y) = ((x >> self.log_width).min(last_x), (y >> self.log_width).min(last_y));
        (x * (last_y + 1) + y) as u16
    }

    /// The first cells of a tile's particles on axes 0 and 1.
    pub(super) fn first_cells(&self, tile: usize) -> [Range<usize>; 2] {
        let row = tile.checked_div(self.count[1]).unwrap_or(0);
        let at = [row, tile - row * self.count[1]];
        [0, 1].map(|axis| {
            let last = at[axis] + 1 == self.count[axis];
            let end = if last { self.limit[axis] } else { (at[axis] + 1) << self.log_width };
            at[axis] << self.log_width..end
        })
    }

    /// Colours: on each axis even and odd tiles, and where an odd number closes a ring, the last tile alone.
    pub(super) fn colours(&self) -> impl Iterator<Item = Colour> {
        let classes = |axis: usize| {
            let count = self.count[axis];
            let alone = usize::from(self.whole[axis] && count > 1 && count % 2 == 1);
            let paired = count - alone;
            [(0, paired.div_ceil(2)), (1, paired / 2), (count - 1, alone)]
        };
        let (x, y) = (classes(0), classes(1));
        let stride = self.count[1];
        x.into_iter()
            .flat_map(move |x| y.into_iter().map(move |y| (x, y)))
            .map(move |(x, y)| Colour { first: [x.0, y.0], count: [x.1, y.1], stride })
            .filter(|colour| colour.len() > 0)
    }
}
