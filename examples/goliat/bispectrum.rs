//! The bispectrum of the density, and f_NL from all of its triangles.
//!
//! Shells cover all modes from k_f to the Nyquist wavenumber or 120 k_f, and on meshes of three times that no triangle wraps. To the lowest order
//! B = f_NL T, where T, for f_NL = 1, is the average of 2 alpha_1 alpha_2 alpha_3 (P_1 P_2 + P_2 P_3 + P_3 P_1), P = P_Phi, over
//! the triples of modes that close the triangle. A Gaussian field gives B the variance s V P_i P_j P_k/N with N triples,
//! P those of the density and s = 1, 2, 6 for three, two and one different shells, and different triangles are
//! independent; weighting each by its inverse variance
//!     f_NL = sum_t (N B T/(s P P P))_t / sum_t (N T^2/(s P P P))_t
//! (Scoccimarro et al. 2004, astro-ph/0312286; Sefusatti, Crocce & Desjacques 2010, arXiv:1003.0007). The signal is in
//! squeezed triangles: long modes times the power of short ones. Shells are narrow where alpha changes fast, so that weights by shells
//! come close to weights by modes.

use fixpair::estimate::binning::Binning;
use fixpair::estimate::bispectrum::{
    Triangle, bispectrum, bispectrum_meshes, bispectrum_scratch, bispectrum_values, closed_triangle_count,
    closed_triangles, normalise, shot_noise, triangle_counts, triangle_counts_scratch,
};
use fixpair::estimate::compensation::Compensation;
use fixpair::estimate::exact::ExactSum;
use fixpair::fft::Fft3;
use fixpair::initial::modes::copy_modes;
use fixpair::mesh::Brick;
use fixpair::real::Real;

use crate::Failure;
use crate::memory::Memory;
use crate::transform::with_transform;
use crate::universe::{Universe, bispectrum_sides};

/// Edges in |n|^2 of the shells below 4 k_f, and where the first three, which hold k_f <= k < 2 k_f, end.
const LONG: [u64; 6] = [1, 2, 3, 4, 5, 9];
const SQUEEZED: u32 = 3;

/// Ratio of radii of the other shells.
const RATIO: f64 = 1.4;

/// The triangles (Delta k, k, k), k_f <= Delta k < 2 k_f.
#[derive(Clone, Debug, Default)]
pub(crate) struct Slice {
    /// Mean wavenumber of the two equal shells, h/Mpc.
    pub(crate) k: Vec<f64>,
    /// Ordered triples of modes.
    pub(crate) count: Vec<u64>,
    /// Linear theory for f_NL = 1, (Mpc/h)^6.
    pub(crate) template: Vec<f64>,
    /// Standard deviation for a Gaussian field, (Mpc/h)^6.
    pub(crate) sigma: Vec<f64>,
}

/// Which triangles are measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Those {
    All,
    /// Those of the squeezed slice.
    Squeezed,
}

/// The geometry, and what theory says on it.
pub(crate) struct Triangles<'a> {
    universe: &'a Universe<'a>,
    /// Side of its meshes.
    pub(crate) side: usize,
    edges: Vec<u64>,
    triangles: Vec<Triangle>,
    /// Ordered triples of modes that close each triangle.
    counts: Vec<u64>,
    /// T.
    template: Vec<f64>,
    /// Variance of B in a Gaussian field.
    variance: Vec<f64>,
    /// The numbers of the triangles of the squeezed slice.
    squeezed: Vec<usize>,
    /// The squeezed slice.
    pub(crate) slice: Slice,
}

fn edges(reach: usize) -> Vec<u64> {
    let (first, last) = (16.0, reach as f64 * reach as f64);
    let steps = ((last / first).ln() / (2.0 * RATIO.ln())).round().max(1.0) as u32;
    let inner = (0..steps).map(|i| (first * (last / first).powf(f64::from(i) / f64::from(steps))).ceil());
    LONG.into_iter().chain(inner.chain([last]).map(|edge| edge as u64)).collect()
}

impl<'a> Triangles<'a> {
    /// # Errors
    /// Those of the kernels.
    pub(crate) fn new(universe: &'a Universe<'a>) -> Result<Self, Failure> {
        let [reach, side] = bispectrum_sides(universe.size)?;
        let edges = edges(reach);
        let mut triangles = vec![[0; 3]; closed_triangle_count(&edges, None)?];
        closed_triangles(&mut triangles, &edges, None)?;
        let mut counts = vec![0; triangles.len()];
        let mut scratch = Memory::new(triangle_counts_scratch(&edges, side, &triangles)?);
        triangle_counts(&mut counts, &triangles, &edges, side, scratch.bytes(), universe.exec)?;
        let volume = universe.length.powi(3);
        let power = universe.linear_power(&edges)?;
        let variance = |(triangle, &count): (&Triangle, &u64)| {
            let same = match triangle {
                [i, j, k] if i == j && j == k => 6.0,
                [i, j, k] if i == j || j == k => 2.0,
                _ => 1.0,
            };
            triangle.map(|s| power[s as usize]).iter().product::<f64>() * same * volume / count.max(1) as f64
        };
        let variance = triangles.iter().zip(&counts).map(variance).collect();
        let slice_of = |t: &usize| matches!(triangles[*t], [i, j, k] if i < SQUEEZED && j == k && LONG.len() <= j as usize);
        let squeezed = (0..triangles.len()).filter(slice_of).collect();
        let mut this = Self {
            universe,
            side,
            edges,
            triangles,
            counts,
            template: Vec::new(),
            variance,
            squeezed,
            slice: Slice::default(),
        };
        this.template = this.local_template()?;
        this.slice = this.slice_of_theory()?;
        Ok(this)
    }

    /// T. The bispectrum of a field is cubic in it: of one with modes alpha (1 + p) and one with alpha (1 - p) the mean, less that of alpha alone,
    /// is alpha_1 alpha_2 alpha_3 (p_1 p_2 + p_2 p_3 + p_3 p_1), averaged over exactly the triples that a measurement averages over.
    fn local_template(&self) -> Result<Vec<f64>, Failure> {
        let Universe { size, exec, alpha, potential_amplitude, .. } = self.universe;
        // In units of its value half way through the shells, so that no term is lost beside another.
        let unit = potential_amplitude[size / 2];
        let brick = self.universe.fourier()?;
        with_transform(self.side, *exec, |fft| {
            // Half of the shells at a time: as much memory in double precision as a measurement has in single.
            let meshes = 1 + (self.edges.len() / 2).max(3);
            let mut fields = vec![0.0; bispectrum_meshes(fft, meshes)?];
            let mut field = |sign: f64| {
                let mode = |(alpha, p): (&f64, &f64)| alpha * (1.0 + sign * (p / unit) * (p / unit));
                let table: Vec<_> = alpha.iter().zip(potential_amplitude).map(mode).collect();
                self.measure(Those::All, &self.universe.real_modes(&table)?, &brick, fft, &mut fields)
            };
            let (plus, minus, none) = (field(1.0)?, field(-1.0)?, field(0.0)?);
            let scale = 2.0 * unit.powi(4);
            Ok((0..none.len()).map(|t| scale * (0.5 * (plus[t] + minus[t]) - none[t])).collect())
        })
    }

    /// B of triangles of a field whose modes are on `brick`, (Mpc/h)^6; 0 for those that are not asked for. `fft` has the side of the triangles;
    /// `fields` are [`Self::reals`].
    pub(crate) fn measure<T: Real>(
        &self,
        those: Those,
        modes: &[T],
        brick: &Brick,
        fft: &mut dyn Fft3<T>,
        fields: &mut [T],
    ) -> Result<Vec<f64>, Failure> {
        let (exec, edges) = (self.universe.exec, &self.edges);
        let (padded, fields) = fields.split_at_mut(bispectrum_meshes(fft, 1)?);
        copy_modes(padded, fft.fourier(), modes, brick, exec)?;
        let numbers: Vec<usize> = match those {
            Those::All => (0..self.triangles.len()).collect(),
            Those::Squeezed => self.squeezed.clone(),
        };
        let triangles: Vec<Triangle> = numbers.iter().map(|&t| self.triangles[t]).collect();
        let counts: Vec<u64> = numbers.iter().map(|&t| self.counts[t]).collect();
        let mut sums = vec![ExactSum::ZERO; triangles.len()];
        let mut scratch = Memory::new(bispectrum_scratch(fft, edges.len() - 1, triangles.len())?);
        bispectrum(&mut sums, &triangles, edges, padded, fft, fields, scratch.bytes(), exec)?;
        let mut values = vec![0.0; sums.len()];
        bispectrum_values(&mut values, &sums)?;
        normalise(&mut values, &counts, fft.configuration().n(), self.universe.length, 1.0)?;
        let mut all = vec![0.0; self.triangles.len()];
        numbers.iter().zip(values).for_each(|(&t, value)| all[t] = value);
        Ok(all)
    }

    /// The shot noise of every triangle of points of number density 1/`noise`, from the modes of their density on `brick`, (Mpc/h)^6.
    pub(crate) fn shot_noise(&self, modes: &[f32], brick: &Brick, noise: f64) -> Result<Vec<f64>, Failure> {
        let (_, mut power) =
            self.universe.power(modes, brick, &Binning::shells(&self.edges), Compensation::None)?;
        power.iter_mut().for_each(|power| *power -= noise);
        let mut out = vec![0.0; self.triangles.len()];
        shot_noise(&mut out, &self.triangles, &power, noise)?;
        Ok(out)
    }

    /// Reals that a measurement works on: a mesh for the modes and one for each shell.
    pub(crate) fn reals<T: Real>(&self, fft: &dyn Fft3<T>) -> Result<usize, Failure> {
        Ok(bispectrum_meshes(fft, self.edges.len())?)
    }

    /// f_NL from the B of every triangle.
    pub(crate) fn fnl(&self, bispectrum: &[f64]) -> f64 {
        let sum = |other: &[f64]| -> f64 {
            let closed = (0..self.counts.len()).filter(|&t| self.counts[t] > 0);
            closed.map(|t| other[t] * self.template[t] / self.variance[t]).sum()
        };
        sum(bispectrum) / sum(&self.template)
    }

    /// B of the squeezed slice from that of its triangles.
    pub(crate) fn slice_of(&self, bispectrum: &[f64]) -> Vec<f64> {
        self.squeezed(|t| self.counts[t] as f64 * bispectrum[t], 1)
    }

    /// For each short shell j: the sum of `term` over triangles (i, j, j) with a long i, over a power of the number of their triples.
    fn squeezed(&self, term: impl Fn(usize) -> f64, power: i32) -> Vec<f64> {
        (LONG.len() as u32..self.edges.len() as u32 - 1)
            .map(|j| {
                let numbers = || self.squeezed.iter().copied().filter(|&t| self.triangles[t][1] == j);
                let triples: u64 = numbers().map(|t| self.counts[t]).sum();
                numbers().map(&term).sum::<f64>() / (triples as f64).powi(power)
            })
            .collect()
    }

    fn slice_of_theory(&self) -> Result<Slice, Failure> {
        let shells = Binning::shells(&self.edges[LONG.len()..]);
        let universe = self.universe;
        let none = Compensation::None;
        let (bins, _) = universe.power(&universe.linear_modes()?, &universe.fourier()?, &shells, none)?;
        let count = |t: usize| self.counts[t] as f64;
        let variance = self.squeezed(|t| count(t).powi(2) * self.variance[t], 2);
        Ok(Slice {
            k: bins.iter().map(|bin| self.universe.wavenumber(bin.first)).collect(),
            count: self.squeezed(count, 0).into_iter().map(|count| count as u64).collect(),
            template: self.squeezed(|t| count(t) * self.template[t], 1),
            sigma: variance.into_iter().map(f64::sqrt).collect(),
        })
    }
}

#[cfg(test)]
mod tests {
    use fixpair::exec::Serial;

    use super::*;

    #[test]
    fn shells_increase_to_the_nyquist_wavenumber() {
        for reach in [8, 9, 16, 48, 120] {
            let edges = edges(reach);
            assert!(edges.is_sorted_by(|a, b| a < b), "{edges:?}");
            assert_eq!(edges.last(), Some(&((reach * reach) as u64)));
        }
    }

    #[test]
    fn the_template_of_one_triple_is_the_formula() {
        let universe = Universe::new(16, 500.0, &Serial).unwrap();
        let triangles = Triangles::new(&universe).unwrap();
        // (1,0,0), (0,1,0), (1,1,0): shells of one |n|^2 each.
        let t = triangles.triangles.iter().position(|&triangle| triangle == [0, 0, 1]).unwrap();
        assert_eq!(triangles.counts[t], 24);
        let [p1, p2] = [1, 2].map(|r: usize| universe.potential_amplitude[r].powi(2) * 500f64.powi(3));
        let alpha = universe.alpha[1].powi(2) * universe.alpha[2];
        let expected = 2.0 * alpha * (p1 * p1 + 2.0 * p1 * p2);
        // Differences of transforms in f64.
        assert!((triangles.template[t] / expected - 1.0).abs() < 1e-9);
        assert!((triangles.fnl(&triangles.template) - 1.0).abs() < 1e-12);
    }
}
