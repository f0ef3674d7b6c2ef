//! What all initial conditions of a suite share: linear theory on the mesh, spectra of modes, and transforms.

use fixpair::cosmology::{
    Convention, Cosmology, Linear, Table, alpha_table, growth, mode_table_length, potential_amplitude_table,
};
use fixpair::estimate::binning::{Bin, Binning, normalise, read_sums};
use fixpair::estimate::compensation::Compensation;
use fixpair::estimate::power::{power_sums, power_sums_scratch};
use fixpair::exec::Exec;
use fixpair::fft::next_side;
use fixpair::initial::conditions::{InitialConditions, Order};
use fixpair::initial::displacements::Motion;
use fixpair::initial::modes::scale_by_table;
use fixpair::initial::png::Local;
use fixpair::initial::shape::Shape;
use fixpair::mesh::{Brick, Space};
use fixpair::noise::Realisation;
use fixpair::real::Real;

use crate::Failure;
use crate::boltzmann::{Spectrum, embedded};
use crate::memory::Memory;

/// Redshift of the initial conditions.
pub(crate) const REDSHIFT: f64 = 32.0;

/// Redshift to which they evolve.
pub(crate) const END: f64 = 1.0;

/// Largest wavenumber of a bispectrum in k_f, as in the paper: its cost grows with the sixth power or so, its worth with the third at most.
const REACH: usize = 120;

/// Linear theory of one box on one mesh.
pub(crate) struct Universe<'a> {
    /// Who runs the loops.
    pub(crate) exec: &'a dyn Exec,
    /// Cells a side.
    pub(crate) size: usize,
    /// Side of the box, Mpc/h.
    pub(crate) length: f64,
    /// sqrt(P_Phi/V) by |n|^2.
    pub(crate) potential_amplitude: Vec<f64>,
    /// alpha by |n|^2.
    pub(crate) alpha: Vec<f64>,
    /// How the density moves particles.
    pub(crate) motion: Motion,
    /// a H in km/s per Mpc/h: a peculiar velocity over it is a distance in redshift space.
    pub(crate) hubble: f64,
    /// Unit shells: edges in |n|^2.
    pub(crate) edges: Vec<u64>,
    /// Linear theory at the start averaged over the modes of each unit shell, (Mpc/h)^3.
    pub(crate) theory: Vec<f64>,
    /// What linear theory multiplies densities by from the start to the end.
    pub(crate) growth: f64,
}

impl<'a> Universe<'a> {
    /// # Errors
    /// If the embedded spectrum cannot be read, or the box is too extreme for it.
    pub(crate) fn new(size: usize, length: f64, exec: &'a dyn Exec) -> Result<Self, Failure> {
        let Spectrum { k, value, .. } = embedded()?;
        let cosmology = Cosmology::goliat();
        let conditions = InitialConditions {
            realisation: Realisation::new(0),
            cosmology,
            linear: Linear::from_power(Table::new(&k, &value)?, cosmology.n_s)?,
            redshift: REDSHIFT,
            box_size: length,
            local: Local::default(),
            shape: Shape::Local.rows(),
            species: None,
            convention: Convention::Cmb,
            order: Order::Second,
        };
        let poisson = conditions.poisson()?;
        let mut potential_amplitude = vec![0.0; mode_table_length(size)?];
        let mut alpha = potential_amplitude.clone();
        potential_amplitude_table(exec, &poisson, size, length, &mut potential_amplitude)?;
        alpha_table(exec, &poisson, size, length, &mut alpha)?;
        let a = 1.0 / (1.0 + REDSHIFT);
        let [early, late] = [a, 1.0 / (1.0 + END)].map(|a| growth(&cosmology, a));
        let mut universe = Self {
            exec,
            size,
            length,
            potential_amplitude,
            alpha,
            motion: conditions.motion()?,
            hubble: a * 100.0 * cosmology.expansion(a)?,
            edges: (1..=size as u64 / 2).map(|b| b * b).collect(),
            theory: Vec::new(),
            growth: late?.d / early?.d,
        };
        universe.theory = universe.linear_power(&universe.edges)?;
        Ok(universe)
    }

    /// Its modes.
    pub(crate) fn fourier(&self) -> Result<Brick, Failure> {
        Ok(Brick::whole(self.size, Space::Fourier)?)
    }

    /// Growth rate f = dln D/dln a.
    pub(crate) fn growth_rate(&self) -> f64 {
        self.motion.step().first_velocity / self.hubble
    }

    /// A field whose modes are all real, with values by |n|^2.
    pub(crate) fn real_modes(&self, table: &[f64]) -> Result<Vec<f64>, Failure> {
        let brick = self.fourier()?;
        let mut modes = vec![0.0; brick.reals()];
        modes.iter_mut().step_by(2).for_each(|re| *re = 1.0);
        scale_by_table(&mut modes, &brick, table, self.exec)?;
        Ok(modes)
    }

    /// Bins of modes, and their multipoles P_l = (2l + 1) V <|delta_k|^2 L_l>, (Mpc/h)^3: of each bin one after another.
    pub(crate) fn power<T: Real>(
        &self,
        modes: &[T],
        brick: &Brick,
        binning: &Binning<'_>,
        compensation: Compensation,
    ) -> Result<(Vec<Bin>, Vec<f64>), Failure> {
        let mut sums = vec![0; binning.words(1)?];
        let mut scratch = Memory::new(power_sums_scratch(brick, binning, 1)?);
        let compensation = [compensation];
        power_sums(
            &mut sums,
            &[modes],
            &[[0, 0]],
            &compensation,
            brick,
            binning,
            scratch.bytes(),
            self.exec,
        )?;
        let mut bins = vec![Bin::default(); binning.bins()?];
        let mut power = vec![0.0; bins.len() * binning.multipoles()];
        read_sums(&mut bins, &mut power, &sums, binning, 1)?;
        normalise(&mut power, &bins, binning.orders, self.length.powi(3))?;
        Ok((bins, power))
    }

    /// Linear theory averaged over the modes of shells, (Mpc/h)^3.
    pub(crate) fn linear_power(&self, edges: &[u64]) -> Result<Vec<f64>, Failure> {
        let (modes, shells) = (self.linear_modes()?, Binning::shells(edges));
        Ok(self.power(&modes, &self.fourier()?, &shells, Compensation::None)?.1)
    }

    /// sqrt(P/V): a field of linear theory without scatter.
    pub(crate) fn linear_modes(&self) -> Result<Vec<f64>, Failure> {
        let root: Vec<f64> = self.potential_amplitude.iter().zip(&self.alpha).map(|(p, a)| p * a).collect();
        self.real_modes(&root)
    }

    /// |n| in h/Mpc.
    pub(crate) fn wavenumber(&self, n: f64) -> f64 {
        n * std::f64::consts::TAU / self.length
    }
}

/// The least side on which squares of fields of side `size` are free of aliasing.
pub(crate) fn fine_side(size: usize) -> Result<usize, Failure> {
    Ok(next_side(3 * size / 2).ok_or("the mesh is too large")?)
}

/// The largest |n| of a bispectrum, and the least side on which its triangles are free of aliasing.
pub(crate) fn bispectrum_sides(size: usize) -> Result<[usize; 2], Failure> {
    let reach = REACH.min(size / 2);
    Ok([reach, fine_side(2 * reach)?])
}

#[cfg(test)]
mod tests {
    use fixpair::exec::Serial;

    use super::*;

    #[test]
    fn theory_is_the_table_scaled_back() {
        let universe = Universe::new(16, 500.0, &Serial).unwrap();
        let Spectrum { k, value, .. } = embedded().unwrap();
        let cosmology = Cosmology::goliat();
        let linear = Linear::from_power(Table::new(&k, &value).unwrap(), cosmology.n_s).unwrap();
        // D(z = 32) of the radiation-free background.
        let growth = 0.039_871_354_7_f64;
        let first = linear.power(std::f64::consts::TAU / 500.0).unwrap() * growth * growth;
        // The first bin also holds |n|^2 = 2 and 3.
        assert!((universe.theory[0] / first - 1.0).abs() < 0.3, "{} {first}", universe.theory[0]);
        // Matter alone grows as a: f is 1 but for the last traces of Lambda.
        assert!((universe.growth_rate() - 1.0).abs() < 1e-3);
        // D(z = 1), of the same background.
        assert!((universe.growth * growth / 0.622_814_340_3 - 1.0).abs() < 1e-6);
    }
}
