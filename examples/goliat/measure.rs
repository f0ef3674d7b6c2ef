//! One initial condition: from a seed and a variant to what is measured in it.

use fixpair::estimate::binning::Binning;
use fixpair::estimate::compensation::Compensation;
use fixpair::exec::Serial;
use fixpair::fft::Fft3;
use fixpair::initial::png::Local;
use fixpair::initial::realise::{Field, linear_density};
use fixpair::noise::{self, Realisation};

use crate::Failure;
use crate::bispectrum::Triangles;
use crate::redshift_space::multipoles;
use crate::suite::{Amplitude, Configuration, Measurement, Phase, Variant};
use crate::universe::{Universe, fine_side, with_transform};

/// A worker's transforms and memory.
pub(crate) struct Bench<'a> {
    configuration: &'a Configuration,
    universe: &'a Universe,
    triangles: &'a Triangles<'a>,
    fft: &'a mut (dyn Fft3<f64> + 'a),
    fine: &'a mut (dyn Fft3<f64> + 'a),
    /// Rounding to single precision moves f_NL by far less than its scatter, and halves the bispectrum's memory and time.
    single: &'a mut (dyn Fft3<f32> + 'a),
    density: Vec<f64>,
    mesh: Vec<f64>,
    rounded: Vec<f32>,
    fields: Vec<f32>,
}

/// Lends a bench for the time of a call.
pub(crate) fn with_bench<R>(
    configuration: &Configuration,
    universe: &Universe,
    triangles: &Triangles<'_>,
    body: impl FnOnce(&mut Bench<'_>) -> Result<R, Failure>,
) -> Result<R, Failure> {
    let side = fine_side(universe.size)?;
    with_transform(universe.size, |fft| {
        with_transform(side, |fine| {
            with_transform(side, |single| {
                body(&mut Bench {
                    configuration,
                    universe,
                    triangles,
                    density: vec![0.0; fft.length()],
                    mesh: vec![0.0; fine.length()],
                    rounded: vec![0.0; fft.length()],
                    fields: vec![0.0; triangles.reals(single)?],
                    fft,
                    fine,
                    single,
                })
            })
        })
    })
}

impl Bench<'_> {
    /// Makes the initial density of `seed` and `variant` at z = 32 and measures it, on the calling thread; with `more`, also its
    /// particles in redshift space, and keeps a plane of it.
    pub(crate) fn measure(
        &mut self,
        seed: u64,
        variant: Variant,
        more: bool,
    ) -> Result<Measurement, Failure> {
        let Self { configuration, universe, triangles, density, .. } = self;
        let field = Field {
            realisation: Realisation {
                amplitude: match variant.amplitude {
                    Amplitude::Normal => noise::Amplitude::Normal,
                    Amplitude::Fixed => noise::Amplitude::Fixed,
                },
                phase: match variant.phase {
                    Phase::Original => noise::Phase::Original,
                    Phase::Inverted => noise::Phase::Inverted,
                },
                ..Realisation::new(seed)
            },
            potential_amplitude: &universe.potential_amplitude,
            local: Local { f_nl: configuration.fnl_of(variant.half), g_nl: 0.0 },
            transfer: &universe.alpha,
        };
        let mut partial = vec![[0.0]; self.fine.configuration().n()];
        linear_density(
            density,
            &field,
            self.fft,
            Some(&mut *self.fine),
            &mut self.mesh,
            &mut partial,
            &Serial,
        )?;
        let binning = Binning::shells(&universe.edges);
        let (bins, power) = universe.power(density, self.fft.fourier(), &binning, Compensation::None)?;
        self.rounded.iter_mut().zip(&*density).for_each(|(single, &double)| *single = double as f32);
        let bispectrum = triangles.measure(&self.rounded, self.single, &mut self.fields)?;
        let multipoles = if more { Some(multipoles(universe, density, self.fft, self.fine)?) } else { None };
        let slice = if more { Some(plane(density, self.fft)?) } else { None };
        Ok(Measurement {
            k: bins.iter().map(|bin| universe.wavenumber(bin.first)).collect(),
            modes: bins.iter().map(|bin| bin.count).collect(),
            theory: universe.theory.clone(),
            power,
            squeezed: triangles.slice(&bispectrum),
            fnl: triangles.fnl(&bispectrum),
            multipoles,
            slice,
        })
    }
}

/// The plane z = 0 of the density contrast, x fastest, from its modes, which are lost.
fn plane(density: &mut [f64], fft: &mut dyn Fft3<f64>) -> Result<Vec<f32>, Failure> {
    fft.inverse(density)?;
    let (n, [x, y, _]) = (fft.configuration().n(), fft.configuration().stride());
    Ok((0..n * n).map(|at| density[at % n * x + at / n * y] as f32).collect())
}
