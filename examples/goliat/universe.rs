//! What all initial conditions of a suite share: linear theory on the mesh, and the estimator of the squeezed signal.
//!
//! The squeezed signal of a field is f_NL as sum_k Re Phi_k* (Phi^2)_k/P_Phi(k) over its expectation for f_NL = 1: a cubic
//! estimator in which each mode is weighted by its inverse variance. Phi/P_Phi lives on small scales, Phi on large ones,
//! so what it sees is the modulation of small-scale power by long modes. With products free of aliasing,
//! <Phi_k* (Phi^2)_k> = f_NL [2 sum_q P_q P_(k-q) + 4 P_k sum_q P_q], where the second sum keeps pairs with k + q on the mesh.

use fixpair::cosmology::{
    Convention, Cosmology, Linear, Table, alpha_table, mode_table_length, potential_amplitude_table,
};
use fixpair::estimate::binning::{Bin, Binning, normalise, read_sums};
use fixpair::estimate::compensation::Compensation;
use fixpair::estimate::power::{power_sums, power_sums_scratch};
use fixpair::exec::Serial;
use fixpair::fft::{Fft3, Tables, Transform, next_side};
use fixpair::initial::conditions::{InitialConditions, Order};
use fixpair::initial::modes::{copy_modes, scale_by_table};
use fixpair::initial::png::Local;
use fixpair::mesh::{Brick, Space};
use fixpair::noise::Realisation;
use fixpair::scratch::Layout;

use crate::Failure;
use crate::boltzmann::{Spectrum, embedded};

/// Redshift of the initial conditions.
pub(crate) const REDSHIFT: f64 = 32.0;

/// Linear theory of one box on one mesh.
pub(crate) struct Universe {
    /// Cells a side.
    pub(crate) size: usize,
    /// sqrt(P_Phi/V) by |n|^2.
    pub(crate) potential_amplitude: Vec<f64>,
    /// alpha by |n|^2.
    pub(crate) alpha: Vec<f64>,
    /// Side of the box, Mpc/h.
    length: f64,
    /// Edges of the bins, in |n|^2.
    edges: Vec<u64>,
    /// 1/P_Phi, times 1/V, by |n|^2.
    inverse_power: Vec<f64>,
    /// 1/alpha by |n|^2.
    inverse_alpha: Vec<f64>,
    /// Of the estimator, for f_NL = 1.
    expectation: f64,
}

impl Universe {
    /// # Errors
    /// If the embedded spectrum cannot be read, or the box is too extreme for it.
    pub(crate) fn new(size: usize, length: f64) -> Result<Self, Failure> {
        let Spectrum { k, value, .. } = embedded()?;
        let cosmology = Cosmology::goliat();
        let conditions = InitialConditions {
            realisation: Realisation::new(0),
            cosmology,
            linear: Linear::from_power(Table::new(&k, &value)?, cosmology.n_s)?,
            redshift: REDSHIFT,
            box_size: length,
            local: Local::default(),
            convention: Convention::Cmb,
            order: Order::Second,
        };
        let poisson = conditions.poisson()?;
        let mut potential_amplitude = vec![0.0; mode_table_length(size)?];
        let mut alpha = potential_amplitude.clone();
        potential_amplitude_table(&Serial, &poisson, size, length, &mut potential_amplitude)?;
        alpha_table(&Serial, &poisson, size, length, &mut alpha)?;
        let invert = |values: &[f64]| values.iter().map(|&v| if v > 0.0 { 1.0 / v } else { 0.0 }).collect();
        let power: Vec<f64> = potential_amplitude.iter().map(|p| p * p).collect();
        let mut universe = Self {
            size,
            length,
            edges: (1..=size as u64 / 2).map(|b| b * b).collect(),
            inverse_power: invert(&power),
            inverse_alpha: invert(&alpha),
            expectation: 1.0,
            potential_amplitude,
            alpha,
        };
        universe.expectation = universe.expected(&power)?;
        Ok(universe)
    }

    fn fourier(&self) -> Result<Brick, Failure> {
        Ok(Brick::whole(self.size, Space::Fourier)?)
    }

    /// A field whose modes are all real, with values by |n|^2.
    fn real_modes(&self, table: &[f64]) -> Result<Vec<f64>, Failure> {
        let brick = self.fourier()?;
        let mut modes = vec![0.0; brick.reals()];
        modes.iter_mut().step_by(2).for_each(|re| *re = 1.0);
        scale_by_table(&mut modes, &brick, table, &Serial)?;
        Ok(modes)
    }

    fn expected(&self, power: &[f64]) -> Result<f64, Failure> {
        let spectrum = self.real_modes(power)?;
        let inverse = self.real_modes(&self.inverse_power)?;
        let mut every = vec![1.0; power.len()];
        every[0] = 0.0;
        let every = self.real_modes(&every)?;
        let long = self.sum(&self.product(&spectrum, &every)?, &every)?;
        let short = self.sum(&self.product(&spectrum, &spectrum)?, &inverse)?;
        Ok(4.0 * long + 2.0 * short)
    }

    /// sum_k Re f_k g_k* over all modes but the mean.
    fn sum(&self, f: &[f64], g: &[f64]) -> Result<f64, Failure> {
        let edges = [1, self.alpha.len() as u64];
        Ok(self.sums(&Binning::shells(&edges), f, g)?.1[0])
    }

    /// Bins, and the sum of Re f_k g_k* in each.
    fn sums(&self, binning: &Binning<'_>, f: &[f64], g: &[f64]) -> Result<(Vec<Bin>, Vec<f64>), Failure> {
        let brick = self.fourier()?;
        let mut sums = vec![0; binning.words(1)?];
        let mut scratch = Memory::new(power_sums_scratch(&brick, binning, 1)?);
        let none = [Compensation::None; 2];
        power_sums(&mut sums, &[f, g], &[[0, 1]], &none, &brick, binning, scratch.bytes(), &Serial)?;
        let mut bins = vec![Bin::default(); binning.bins()?];
        let mut power = vec![0.0; bins.len()];
        read_sums(&mut bins, &mut power, &sums, binning, 1)?;
        Ok((bins, power))
    }

    /// The modes of f(x) g(x), free of aliasing.
    fn product(&self, f: &[f64], g: &[f64]) -> Result<Vec<f64>, Failure> {
        let brick = self.fourier()?;
        with_transform(fine_side(self.size)?, |fine| {
            let large = *fine.fourier();
            let cells = |modes: &[f64], fine: &mut Transform<'_, f64>| -> Result<Vec<f64>, Failure> {
                let mut mesh = vec![0.0; fine.length()];
                copy_modes(&mut mesh, &large, modes, &brick, &Serial)?;
                fine.inverse(&mut mesh)?;
                Ok(mesh)
            };
            let mut product = cells(f, fine)?;
            let other = cells(g, fine)?;
            let scale = (large.n() as f64).powi(-3);
            product.iter_mut().zip(other).for_each(|(f, g)| *f *= g * scale);
            fine.forward(&mut product)?;
            let mut modes = vec![0.0; brick.reals()];
            copy_modes(&mut modes, &brick, &product, &large, &Serial)?;
            Ok(modes)
        })
    }

    /// The bins: mean k in h/Mpc, modes counting k and -k, and V <|delta_k|^2> in (Mpc/h)^3.
    pub(crate) fn power(&self, density: &[f64]) -> Result<(Vec<f64>, Vec<u64>, Vec<f64>), Failure> {
        let binning = Binning::shells(&self.edges);
        let (bins, mut power) = self.sums(&binning, density, density)?;
        normalise(&mut power, &bins, binning.orders, self.length.powi(3))?;
        let unit = std::f64::consts::TAU / self.length;
        Ok((
            bins.iter().map(|bin| unit * bin.first).collect(),
            bins.iter().map(|bin| bin.count).collect(),
            power,
        ))
    }

    /// Linear theory, averaged over the modes of each bin.
    pub(crate) fn theory(&self) -> Result<Vec<f64>, Failure> {
        let root: Vec<f64> = self.potential_amplitude.iter().zip(&self.alpha).map(|(p, a)| p * a).collect();
        Ok(self.power(&self.real_modes(&root)?)?.2)
    }

    /// f_NL of one density field.
    pub(crate) fn squeezed(&self, density: &[f64]) -> Result<f64, Failure> {
        let brick = self.fourier()?;
        let mut phi = density.to_vec();
        scale_by_table(&mut phi, &brick, &self.inverse_alpha, &Serial)?;
        let square = self.product(&phi, &phi)?;
        scale_by_table(&mut phi, &brick, &self.inverse_power, &Serial)?;
        Ok(self.sum(&phi, &square)? / self.expectation)
    }
}

/// The least side on which squares of fields of side `size` are free of aliasing.
pub(crate) fn fine_side(size: usize) -> Result<usize, Failure> {
    Ok(next_side(3 * size / 2).ok_or("the mesh is too large")?)
}

/// Bytes that begin on a cache line.
pub(crate) struct Memory {
    bytes: Vec<u8>,
    start: usize,
}

impl Memory {
    pub(crate) fn new(layout: Layout) -> Self {
        let bytes = vec![0; layout.size + layout.align];
        let start = bytes.as_ptr().align_offset(layout.align);
        Self { bytes, start }
    }

    pub(crate) fn bytes(&mut self) -> &mut [u8] {
        &mut self.bytes[self.start..]
    }
}

/// Lends a transform of side n for the time of a call.
pub(crate) fn with_transform<R>(
    n: usize,
    body: impl FnOnce(&mut Transform<'_, f64>) -> Result<R, Failure>,
) -> Result<R, Failure> {
    let mut tables = Memory::new(Tables::<f64>::layout(n)?);
    let tables = Tables::<f64>::new(n, tables.bytes())?;
    let mut workspace = Memory::new(Transform::<f64>::workspace(n)?);
    let cells = Brick::whole(n, Space::Configuration)?;
    body(&mut Transform::new(&tables, cells, workspace.bytes(), &Serial)?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn theory_is_the_table_scaled_back() {
        let universe = Universe::new(16, 500.0).unwrap();
        let theory = universe.theory().unwrap();
        let Spectrum { k, value, .. } = embedded().unwrap();
        let cosmology = Cosmology::goliat();
        let linear = Linear::from_power(Table::new(&k, &value).unwrap(), cosmology.n_s).unwrap();
        // D(z = 32) of the radiation-free background.
        let growth = 0.039_871_354_7_f64;
        let first = linear.power(std::f64::consts::TAU / 500.0).unwrap() * growth * growth;
        // The first bin also holds |n|^2 = 2 and 3.
        assert!((theory[0] / first - 1.0).abs() < 0.3, "{} {first}", theory[0]);
    }
}
