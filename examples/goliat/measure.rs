//! One initial condition: from a seed and a variant to what is measured in it.

use fixpair::exec::Serial;
use fixpair::fft::Fft3;
use fixpair::initial::png::Local;
use fixpair::initial::realise::{Field, linear_density};
use fixpair::noise::{self, Realisation};

use crate::Failure;
use crate::suite::{Amplitude, Configuration, Measurement, Phase, Variant};
use crate::universe::{Universe, fine_side, with_transform};

/// Makes the initial density of `seed` and `variant` at z = 32 and measures it, on the calling thread; with `slice`,
/// keeps a plane of it.
pub(crate) fn measure(
    configuration: &Configuration,
    universe: &Universe,
    seed: u64,
    variant: Variant,
    slice: bool,
) -> Result<Measurement, Failure> {
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
    with_transform(universe.size, |fft| {
        with_transform(fine_side(universe.size)?, |fine| {
            let mut density = vec![0.0; fft.length()];
            let mut mesh = vec![0.0; fine.length()];
            let mut partial = vec![[0.0]; fine.configuration().n()];
            linear_density(&mut density, &field, fft, Some(fine), &mut mesh, &mut partial, &Serial)?;
            let (k, modes, power) = universe.power(&density)?;
            let theory = universe.theory()?;
            let squeezed = universe.squeezed(&density)?;
            let slice = if slice { Some(plane(density, fft)?) } else { None };
            Ok(Measurement { k, modes, theory, power, squeezed, slice })
        })
    })
}

/// The plane z = 0 of the density contrast, x fastest.
fn plane(mut density: Vec<f64>, fft: &mut dyn Fft3<f64>) -> Result<Vec<f32>, Failure> {
    fft.inverse(&mut density)?;
    let (n, [x, y, _]) = (fft.configuration().n(), fft.configuration().stride());
    Ok((0..n * n).map(|at| density[at % n * x + at / n * y] as f32).collect())
}
