//! The initial conditions of one universe: its density at z = 32, and its particles.

use fixpair::cosmology::Cosmology;
use fixpair::fft::Fft3;
use fixpair::initial::displacements::{Order, Work, displacements, rest_length};
use fixpair::initial::particles::{Components, displace};
use fixpair::initial::png::Local;

use fixpair::initial::realise::{Field, FieldWork, linear_density};
use fixpair::initial::shape::Shape;
use fixpair::noise::Realisation;

use crate::Failure;
use crate::transform::with_transform;
use crate::universe::{Universe, fine_side};

/// Density at z = 32, in modes.
pub(crate) struct Start {
    pub(crate) density: Vec<f64>,
}

impl Start {
    /// Noise, fixed and inverted, coloured, with f_NL.
    ///
    /// # Errors
    /// Those of the kernels.
    pub(crate) fn new(
        universe: &Universe<'_>,
        realisation: Realisation,
        local: Local,
    ) -> Result<Self, Failure> {
        let Universe { size, exec, potential_amplitude, alpha, .. } = universe;
        let shape = Shape::Local.rows();
        let n_s = Cosmology::goliat().n_s;
        let field = Field { realisation, potential_amplitude, local, shape, n_s, transfer: alpha };
        with_transform(*size, *exec, |fft| {
            with_transform(fine_side(*size)?, *exec, |fine| {
                let mut density = vec![0.0; fft.length()];
                let mut mesh = vec![0.0; fine.length()];
                let mut partial = vec![[0.0]; fine.configuration().n()];
                let work =
                    FieldWork { mesh: &mut mesh, rest: &mut [], table: &mut [], partial: &mut partial };
                linear_density(&mut density, &field, fft, Some(fine), work, *exec)?;
                Ok(Self { density })
            })
        })
    }

    /// In single precision: rounding moves f_NL and particles by far less than the mesh does, and halves memory and time of what follows.
    pub(crate) fn rounded(&self) -> Vec<f32> {
        self.density.iter().map(|&part| part as f32).collect()
    }

    /// The plane z = 0 of the density contrast, x fastest.
    ///
    /// # Errors
    /// Those of the transform.
    pub(crate) fn plane(&self, universe: &Universe<'_>) -> Result<Vec<f32>, Failure> {
        with_transform(universe.size, universe.exec, |fft| {
            let mut density = self.density.clone();
            fft.inverse(&mut density)?;
            let (n, [x, y, _]) = (fft.configuration().n(), fft.configuration().stride());
            Ok((0..n * n).map(|at| density[at % n * x + at / n * y] as f32).collect())
        })
    }

    /// Positions and velocities (triples, Mpc/h and km/s) to second order. The density is not needed afterwards.
    ///
    /// # Errors
    /// Those of the kernels.
    pub(crate) fn particles(self, universe: &Universe<'_>) -> Result<[Vec<f32>; 2], Failure> {
        let mut density = self.rounded();
        drop(self);
        let Universe { size, exec, motion, .. } = universe;
        let reals = 3 * size.pow(3);
        let (mut position, mut velocity) = (vec![0.0; reals], vec![0.0; reals]);
        with_transform(*size, *exec, |fft| {
            with_transform(fine_side(*size)?, *exec, |fine| {
                let mut source = vec![0.0; fine.length()];
                let mut rest = vec![0.0; rest_length(Order::Second, false, &*fft, Some(fine))];
                let position = &mut Components::triples(&mut position)?;
                let velocity = &mut Components::triples(&mut velocity)?;
                let (cells, step) = (*fft.configuration(), motion.step());
                displacements(
                    &mut density,
                    Order::Second,
                    motion,
                    None,
                    fft,
                    Some(fine),
                    Work { source: &mut source, rest: &mut rest, table: &mut [] },
                    &mut |axis, first, second| {
                        displace(position, velocity, first, second, &cells, axis, &step, *exec)
                    },
                    *exec,
                )?;
                Ok(())
            })
        })?;
        Ok([position, velocity])
    }
}
