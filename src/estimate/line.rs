//! One row of points along axis 2: their bins, their angles, and their sums over runs.
//!
//! A *run* is a stretch of a row whose points fall into one bin. Its sum is a plain f64 sum in the order of the row, and is what is added exactly to
//! the bin; rows are never cut by slabs of x or y, so the bits of a bin depend on the mesh alone. No branch depends on where runs end: a mask
//! restarts the sum, so that runs of one or two points (unit shells) cost no mispredicted jump.

use super::binning::{Checked, Second};
use crate::math;
use crate::scratch::{Arena, Layout};
use crate::status::Result;
use crate::within::Within;

/// What is the same for all rows of a brick.
pub(super) struct Lines<'a> {
    pub(super) checked: Checked<'a>,
    /// The range of the first coordinate by its square, counted from 1; 0 is outside.
    pub(super) lookup: &'a [u32],
    /// Edges of the second coordinate, squared.
    pub(super) thresholds: &'a [f64],
    /// Signed n_z and its square.
    pub(super) z: &'a [f64],
    pub(super) z_square: &'a [u64],
    /// How many points of the whole mesh each point stands for.
    pub(super) weight: &'a [f64],
    /// n_z^2 increases along the row.
    pub(super) increasing: bool,
}

/// Where a row lies: n_x^2 + n_y^2 and n_x a_x + n_y a_y.
#[derive(Clone, Copy)]
pub(super) struct Place {
    pub(super) square: u64,
    pub(super) across: f64,
}

/// Work space of one row.
pub(super) struct Line<'a> {
    /// All ones where a point goes on with the run before it, else 0.
    keep: &'a mut [u64],
    bin: &'a mut [u32],
    /// Bin of each run, counted from 1 (0 is outside); runs too count from 1.
    run_bin: &'a mut [u32],
    /// Sums of runs: those of a first row, of a second, ...
    runs: &'a mut [[f64; 4]],
    /// mu^2 and mu, where multipoles or wedges need them.
    mu_square: &'a mut [f64],
    mu: &'a mut [f64],
    /// Products of a first row, of a second, ...
    products: &'a mut [f64],
    length: usize,
}

/// Rows (+-i, +-j) that have the same bins, and are summed side by side.
pub(super) const TOGETHER: usize = 4;

impl<'a> Line<'a> {
    pub(super) fn layout(layout: Layout, length: usize) -> Result<Layout> {
        let layout = layout.and::<u64>(length)?.and::<u32>(length)?.and::<u32>(length + 1)?;
        let layout = layout.and::<[f64; 4]>(TOGETHER * (length + 1))?;
        layout.and::<f64>(length)?.and::<f64>(length)?.and::<f64>(TOGETHER * length)
    }

    pub(super) fn take(arena: &mut Arena<'a>, length: usize) -> Result<Self> {
        let line = Self {
            keep: arena.take(length)?,
            bin: arena.take(length)?,
            run_bin: arena.take(length + 1)?,
            runs: arena.take(TOGETHER * (length + 1))?,
            mu_square: arena.take(length)?,
            mu: arena.take(length)?,
            products: arena.take(TOGETHER * length)?,
            length,
        };
        // Where no angle is needed it is multiplied by 0 and must be a number.
        line.mu_square.fill(0.0);
        line.mu.fill(0.0);
        Ok(line)
    }

    /// Calls `add(bin, sums)` for each run of row `row` inside a bin.
    #[inline(always)]
    pub(super) fn for_each_run(&self, row: usize, runs: usize, mut add: impl FnMut(usize, &[f64; 4])) {
        let first = row * (self.length + 1);
        let sums = self.runs.part(first + 1..first + runs + 1);
        for (&bin, sums) in self.run_bin.part(1..runs + 1).iter().zip(sums) {
            if bin > 0 {
                add(bin as usize - 1, sums);
            }
        }
    }

    /// Where the products of the first `points` points of row `row` go.
    #[inline(always)]
    pub(super) fn products(&mut self, row: usize, points: usize) -> &mut [f64] {
        self.products.part_mut(row * self.length..row * self.length + points)
    }

    /// Sums the products of `rows` rows times polynomials in mu^2, lane by lane and run by run.
    #[inline(always)]
    pub(super) fn sum(&mut self, rows: usize, points: usize, lanes: &[[f64; 4]; 3]) {
        match rows {
            1 => self.sum_rows::<1>(points, lanes),
            2 => self.sum_rows::<2>(points, lanes),
            _ => self.sum_rows::<TOGETHER>(points, lanes),
        }
    }

    /// As [`Line::sum`] for one row, times mu.
    #[inline(always)]
    pub(super) fn sum_odd(&mut self, points: usize, lanes: &[[f64; 4]; 3]) {
        for (value, mu) in self.products.iter_mut().zip(&*self.mu).take(points) {
            *value *= mu;
        }
        self.sum_rows::<1>(points, lanes);
    }

    /// Adds up `product (c0 + mu^2 (c2 + mu^2 c4))` in four lanes; a point that is not kept begins the next run. Several rows
    /// are several chains of additions that do not wait for one another.
    #[inline(always)]
    fn sum_rows<const ROWS: usize>(&mut self, points: usize, [c0, c2, c4]: &[[f64; 4]; 3]) {
        let mut sum = [[0.0_f64; 4]; ROWS];
        let mut run = 0;
        let length = self.length;
        let products: [&[f64]; ROWS] =
            core::array::from_fn(|row| self.products.part(row * length..row * length + points));
        let mut rest = &mut *self.runs;
        let runs: [&mut [[f64; 4]]; ROWS] = core::array::from_fn(|_| {
            let (first, others) =
                core::mem::take(&mut rest).split_at_mut_checked(length + 1).unwrap_or_default();
            rest = others;
            first
        });
        for (m, (&keep, &mu_square)) in self.keep.iter().zip(&*self.mu_square).take(points).enumerate() {
            run += usize::from(keep == 0);
            let mut polynomial = [0.0; 4];
            for lane in 0..4 {
                polynomial[lane] = c0[lane] + mu_square * (c2[lane] + mu_square * c4[lane]);
            }
            for row in 0..ROWS {
                let product = products[row].at(m);
                for lane in 0..4 {
                    let kept = f64::from_bits(sum[row][lane].to_bits() & keep);
                    sum[row][lane] = kept + product * polynomial[lane];
                }
                runs[row].put(run, sum[row]);
            }
        }
    }
}

impl Lines<'_> {
    fn multipoles(&self) -> bool {
        self.checked.orders != 1
    }

    /// Do rows (+-i, +-j) have the same bins?
    pub(super) fn same_bins(&self) -> bool {
        matches!(self.checked.second, Second::None) || self.same_angles()
    }

    /// Do they have the same mu^2?
    pub(super) fn same_angles(&self) -> bool {
        self.checked.axis.iter().filter(|&&x| x != 0.0).count() == 1
    }

    /// Finds the bins of a row: returns the points that can lie in one (all others come after them) and their runs.
    #[inline(always)]
    pub(super) fn bins(&self, place: Place, line: &mut Line<'_>) -> (usize, usize) {
        let mut points = self.z.len();
        if self.increasing && !matches!(self.checked.second, Second::Parallel(_)) {
            let end = self.lookup.len() as u64;
            points = self.z_square.partition_point(|zz| place.square + zz < end);
        }
        if points == 0 {
            return (0, 0);
        }
        let z_square = self.z_square.part(..points);
        if self.multipoles() || matches!(self.checked.second, Second::Cosine(_)) {
            self.angles(place, line, points);
        }
        let bins = line.bin.part_mut(..points);
        let at = |square: u64| self.lookup.get(square as usize).copied().unwrap_or(0);
        match self.checked.second {
            Second::None => {
                for (bin, zz) in bins.iter_mut().zip(z_square) {
                    *bin = at(place.square + zz);
                }
            }
            Second::Cosine(_) => {
                let mut range = 0;
                for ((bin, zz), &mu) in bins.iter_mut().zip(z_square).zip(&*line.mu_square) {
                    range = self.hunt(range, mu);
                    *bin = self.joined(at(place.square + zz), range);
                }
            }
            Second::Parallel(_) => {
                let mut range = 0;
                for ((bin, &zz), z) in bins.iter_mut().zip(z_square).zip(self.z) {
                    let (perpendicular, parallel) = self.split(place, zz, *z);
                    range = self.hunt(range, parallel * parallel);
                    let square = (place.square + zz) as f64;
                    *bin = self.joined(at((perpendicular + 1e-12 * square) as u64), range);
                }
            }
        }
        let mut last = !bins.at(0);
        let mut runs = 0;
        for (&bin, keep) in bins.iter().zip(line.keep.iter_mut()) {
            *keep = u64::from(bin != last).wrapping_sub(1);
            runs += usize::from(bin != last);
            line.run_bin.put(runs, bin);
            last = bin;
        }
        (points, runs)
    }

    #[inline(always)]
    pub(super) fn angles(&self, place: Place, line: &mut Line<'_>, points: usize) {
        let along = self.checked.axis[2];
        let square = place.square as f64;
        for (mu, &z) in line.mu_square.iter_mut().zip(self.z).take(points) {
            let parallel = place.across + along * z;
            // n = 0 has mu = 0; all other squares are 1 or more.
            let square = square + z * z;
            *mu = parallel * parallel / if square < 1.0 { 1.0 } else { square };
        }
        if self.checked.orders & 0b1010 != 0 {
            for (mus, zs) in line.mu.part_mut(..points).chunks_mut(4).zip(self.z.chunks(4)) {
                let mut length = [1.0; 4];
                for (length, z) in length.iter_mut().zip(zs) {
                    let square = square + z * z;
                    *length = if square < 1.0 { 1.0 } else { square };
                }
                math::sqrt_in_place(&mut length);
                for ((mu, z), length) in mus.iter_mut().zip(zs).zip(length) {
                    *mu = (place.across + along * z) / length;
                }
            }
        }
    }

    /// n_perp^2 and n.a.
    #[inline(always)]
    fn split(&self, place: Place, z_square: u64, z: f64) -> (f64, f64) {
        let parallel = place.across + self.checked.axis[2] * z;
        let rest = (place.square + z_square) as f64 - parallel * parallel;
        (if rest > 0.0 { rest } else { 0.0 }, parallel)
    }

    /// How many thresholds do not exceed `value`, from a guess nearby.
    #[inline(always)]
    fn hunt(&self, mut range: usize, value: f64) -> usize {
        while self.thresholds.get(range).is_some_and(|&next| next <= value) {
            range += 1;
        }
        while range > 0 && self.thresholds.at(range - 1) > value {
            range -= 1;
        }
        range
    }

    /// The bin of ranges of both coordinates, all counted from 1.
    #[inline(always)]
    fn joined(&self, first: u32, second: usize) -> u32 {
        let ranges = self.checked.ranges as u32;
        let inside = first > 0 && second > 0 && second <= self.checked.ranges;
        if inside { (first - 1) * ranges + second as u32 } else { 0 }
    }

    /// Calls `add(bin, [count, sum of the first coordinate, sum of the second])` for each run inside a bin.
    #[inline(always)]
    pub(super) fn geometry(&self, place: Place, line: &mut Line<'_>, mut add: impl FnMut(usize, [f64; 3])) {
        let (points, runs) = self.bins(place, line);
        let (length, weight) = (line.length, self.weight.part(..points));
        let (first, second) = line.products.split_at_mut_checked(length).unwrap_or_default();
        let (first, second) = (first.part_mut(..points), second.part_mut(..points));
        match self.checked.second {
            Second::Parallel(_) => {
                let points = first.iter_mut().zip(&mut *second).zip(self.z_square).zip(self.z);
                for (((first, second), &z_square), &z) in points {
                    let (rest, parallel) = self.split(place, z_square, z);
                    (*first, *second) = (rest, parallel.abs());
                }
            }
            Second::None | Second::Cosine(_) => {
                let square = place.square as f64;
                first.iter_mut().zip(self.z).for_each(|(first, z)| *first = square + z * z);
                if matches!(self.checked.second, Second::None) {
                    second.fill(0.0);
                } else {
                    second.copy(line.mu_square.part(..points));
                    roots(second);
                }
            }
        }
        roots(first);
        let mut sum = [0.0_f64; 3];
        let mut run = 0;
        for (((&keep, &weight), &first), &second) in line.keep.iter().zip(weight).zip(&*first).zip(&*second) {
            run += usize::from(keep == 0);
            let point = [weight, weight * first, weight * second];
            sum = core::array::from_fn(|i| f64::from_bits(sum[i].to_bits() & keep) + point[i]);
            line.runs.put(run, [sum[0], sum[1], sum[2], 0.0]);
        }
        line.for_each_run(0, runs, |bin, sums| add(bin, [sums[0], sums[1], sums[2]]));
    }
}

/// Square roots, in place.
#[inline(always)]
fn roots(values: &mut [f64]) {
    let (fours, rest) = values.as_chunks_mut::<4>();
    fours.iter_mut().for_each(math::sqrt_in_place);
    rest.iter_mut().for_each(|value| *value = math::sqrt(*value));
}
