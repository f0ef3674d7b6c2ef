//! The fuzz targets of fixpair: [`rooms`] calls each room of the library through its C interface as a C program would, [`same`] compares what it
//! answers with the slow twins of the kernels.

/// Every function, struct and constant of `fixpair.h`.
pub mod c {
    pub use fixpair::capi::{
        bias::*, binning::*, bispectrum::*, bispectrum_sums::*, bispectrum_values::*, built_in::*, cells::*,
        correlation::*, cosmology::*, covariance::*, ensemble::*, evolve::*, exec::*, factors::*, fft::*,
        fof::*, force::*, halos::*, initial::*, kick::*, matched::*, mesh::*, mode_table::*, noise::*,
        particles::*, pm::*, posterior::*, power::*, pre_initial::*, resample::*, run::*, scatter::*,
        shape::*, species::*, spheres::*, stages::*, status::*, third::*, triangles::*,
    };
    pub use fixpair::scratch::Layout;
}

#[macro_use]
pub mod check;

pub mod bricks;
pub mod clouds;
pub mod hooks;
pub mod input;
pub mod memory;
pub mod rooms;
pub mod same;
pub mod universe;

/// The slow and obvious versions of the kernels, from the sources of the library: its rooms have their names there.
#[path = "../../src/reference/mod.rs"]
#[allow(dead_code, reason = "the library's tests use all of them")]
mod reference;

use fixpair::{estimate, exec, fft, initial, math, mesh, noise, pm, real, scratch, status, variance};

#[cfg(test)]
mod tests {
    use super::*;

    /// Of bytes that are zero one time in two, as the first inputs of a fuzzer are.
    fn takes_anything(target: fn(&[u8])) {
        for seed in 0..2000 {
            let mut random = input::Random::from(seed);
            let len = random.below(200);
            let data: Vec<u8> = (0..len).map(|_| random.word() as u8 * (random.below(2) as u8)).collect();
            target(&data);
        }
    }

    macro_rules! take_anything {
        ($($target:path as $name:ident),* $(,)?) => { $(
            #[test]
            fn $name() {
                takes_anything($target);
            }
        )* };
    }

    take_anything!(
        rooms::bispectrum::run as bispectrum,
        rooms::cosmology::run as cosmology,
        rooms::fft::run as fft_tables,
        rooms::halos::run as halos,
        rooms::inference::run as inference,
        rooms::initial::run as initial_conditions,
        rooms::meshes::run as meshes,
        rooms::particles::run as particles,
        rooms::power::run as power,
        rooms::runs::run as runs,
        rooms::stages::run as stages,
        rooms::statistics::run as statistics,
        same::bispectrum::run as same_bispectrum,
        same::forces::run as same_forces,
        same::groups::run as same_groups,
        same::noise::run as same_noise,
        same::particles::run as same_particles,
        same::power::run as same_power,
        same::statistics::run as same_statistics,
        same::transform::run as same_transform,
    );
}
