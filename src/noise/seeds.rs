//! The table of seeds of N-GenIC: one for each (i, j), drawn in growing square shells of the four corners, so that meshes
//! of all sides share the entries of their common modes.

use super::ranlux::Ranlxd1;
use crate::mesh::{Brick, Space};
use crate::real::Real;
use crate::status::{Error, Result};
use crate::within::Within;

/// The entries of the n x n table in the order in which they are drawn.
///
/// With p(m) = m and m(m) = n - 1 - m, shell i = 0 .. n/2 - 1 visits (p i, p j), (p j, p i), (m i, p j), (m j, p i), (p i, m j),
/// (p j, m i), (m i, m j), (m j, m i): eight passes over j = 0 .. i - 1 and, the even ones, j = i too.
fn for_each(n: usize, seed: u64, mut visit: impl FnMut([usize; 2], u32)) {
    let mut stream = Ranlxd1::new(seed);
    for i in 0..n / 2 {
        for pass in 0..8 {
            let swapped = pass % 2 == 1;
            for j in 0..i + usize::from(swapped) {
                let mut cell = if swapped { [j, i] } else { [i, j] };
                for (axis, index) in cell.iter_mut().enumerate() {
                    if pass & (2 << axis) != 0 {
                        *index = n - 1 - *index;
                    }
                }
                visit(cell, (f64::from(i32::MAX) * stream.uniform()) as u32);
            }
        }
    }
}

/// The seeds of a brick's columns in the schemes of N-GenIC and FastPM: that of (i, j) is in row i, column j.
///
/// Entry = floor((2^31 - 1) u) of the uniforms of ranlxd1 under `seed`, in growing shells: a mesh of another side has the same
/// entries at the same signed (i, j) below both n/2 (their entry at -m is that at index n - m).
///
/// `seeds`: `count[0] count[1]` of them; `brick`: of Fourier space, whose third axis does not matter.
///
/// # Errors
/// `Brick` if the brick is not in Fourier space, `Length` if `seeds` has another length: it is then untouched.
///
/// # Cost
/// The whole table is drawn for any brick: about 20 ns for each of n^2 entries.
///
/// # Example
/// ```
/// use fixpair::mesh::{Brick, Space};
/// use fixpair::noise::ngenic_seeds;
///
/// let brick = Brick::whole(8, Space::Fourier)?;
/// let mut seeds = [0; 64]; // one a column (i, j)
/// ngenic_seeds(&mut seeds, &brick, 5001)?;
/// assert!(seeds.iter().any(|&seed| seed != seeds[0]));
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn ngenic_seeds(seeds: &mut [u32], brick: &Brick, seed: u64) -> Result<()> {
    brick.check_space(Space::Fourier)?;
    if brick.count()[0].checked_mul(brick.count()[1]) != Some(seeds.len()) {
        return Err(Error::Length);
    }
    if seeds.is_empty() {
        return Ok(());
    }
    let row = brick.count()[1];
    for_each(brick.n(), seed, |column, entry| {
        if let Some([i, j]) = local(brick, column) {
            seeds.put(i * row + j, entry);
        }
    });
    Ok(())
}

/// A column's place in the brick, if it is there.
#[inline(always)]
fn local(brick: &Brick, column: [usize; 2]) -> Option<[usize; 2]> {
    let [i, j] = [0, 1].map(|axis| column[axis].wrapping_sub(brick.start()[axis]));
    (i < brick.count()[0] && j < brick.count()[1]).then_some([i, j])
}

/// The index of -m where m has this index.
#[inline(always)]
const fn negative(n: usize, index: usize) -> usize {
    if index == 0 { 0 } else { n - index }
}

/// Does (i, j) take the conjugates of (-i, -j) on the planes that are their own mirror images?
#[inline(always)]
pub(super) const fn mirrored(n: usize, i: usize, j: usize) -> bool {
    let (other_i, other_j) = (negative(n, i), negative(n, j));
    other_i < i || other_i == i && other_j < j
}

/// Seeds that lie in the output until the modes take their place: in each column of the brick its own, as the real and
/// imaginary part of the first mode, and that of its mirror image in the second mode. They are small integers, exact in both precisions.
#[derive(Clone, Copy)]
pub(super) struct Slots {
    /// Is the mode beside the first there?
    second: bool,
    /// Is l = 0 or l = n/2 in the brick, so that mirrored columns need the other seed?
    planes: bool,
}

/// Bits of a seed in the real part.
const LOW: u32 = 16;

impl Slots {
    pub(super) fn new(brick: &Brick) -> Self {
        let (first, count) = (brick.start()[2], brick.count()[2]);
        Self { second: count > 1, planes: first == 0 || first + count > brick.n() / 2 }
    }

    /// Draws the table and leaves the seeds in `out`.
    pub(super) fn leave<T: Real>(self, out: &mut [T], brick: &Brick, seed: u64) {
        let n = brick.n();
        let stride = brick.stride();
        let mut put = |[i, j]: [usize; 2], slot: usize, entry: u32| {
            let at = 2 * (i * stride[0] + j * stride[1] + slot * stride[2]);
            out.put(at, T::from_f64(f64::from(entry & ((1 << LOW) - 1))));
            out.put(at + 1, T::from_f64(f64::from(entry >> LOW)));
        };
        for_each(n, seed, |column, entry| {
            // A brick of one plane has room for one seed, and needs but one.
            if let Some(place) = local(brick, column)
                && (self.second || !self.planes || !mirrored(n, column[0], column[1]))
            {
                put(place, 0, entry);
            }
            let image = column.map(|index| negative(n, index));
            if self.planes
                && mirrored(n, image[0], image[1])
                && let Some(place) = local(brick, image)
            {
                put(place, usize::from(self.second), entry);
            }
        });
    }

    /// The column's own seed and the one that it takes on the planes, from its first two modes.
    #[inline(always)]
    pub(super) fn read<T: Real>(self, mirrored: bool, mode: impl Fn(usize) -> [T; 2]) -> [u64; 2] {
        let seed = |slot| {
            let [low, high] = mode(slot).map(|x| x.to_f64() as u64);
            high << LOW | low
        };
        let own = seed(0);
        [own, if mirrored && self.planes { seed(usize::from(self.second)) } else { own }]
    }
}
