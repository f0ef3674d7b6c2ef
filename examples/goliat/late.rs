//! What is measured at z = 1: spectra and squeezed bispectra of matter and of halos.
//!
//! Halos are friends of friends, b = 0.2, of ten particles and more, as the paper's; each counts once. The shot noise of Poisson
//! points, 1/n, is subtracted from their spectra, and (P_1 + P_2 + P_3)/n + 1/n^2 from their bispectra.

use fixpair::estimate::binning::Binning;
use fixpair::estimate::compensation::Compensation;
use fixpair::fft::Fft3;
use fixpair::halos::{
    Halo, fof_labels, fof_labels_scratch, halo_count, halos, halos_scratch, linking_length, particle_mass,
};
use fixpair::pm::Positions;

use crate::Failure;
use crate::bispectrum::{Those, Triangles};
use crate::density::contrast;
use crate::measurement::Late;
use crate::memory::Memory;
use crate::transform::with_transform;
use crate::universe::{Universe, fine_side};

/// Linking length in mean separations of particles.
const LINKING: f64 = 0.2;

/// Particles of the least halo.
pub(crate) const LEAST: u64 = 10;

impl Late {
    /// Measures particles (triples, Mpc/h).
    ///
    /// # Errors
    /// Those of the kernels.
    pub(crate) fn of(
        universe: &Universe<'_>,
        triangles: &Triangles<'_>,
        position: &[f32],
    ) -> Result<Self, Failure> {
        let (matter, matter_squeezed) = spectra(universe, triangles, position, 0.0)?;
        let centres = centres(universe, position)?;
        let count = centres.len() as u64 / 3;
        let (halos, halo_squeezed) = if count == 0 {
            (vec![0.0; matter.len()], vec![0.0; matter_squeezed.len()])
        } else {
            spectra(universe, triangles, &centres, universe.length.powi(3) / count as f64)?
        };
        Ok(Self { matter, halos, count, matter_squeezed, halo_squeezed })
    }
}

/// P in the unit shells and B of the squeezed slice, of points with this shot noise, without it.
fn spectra(
    universe: &Universe<'_>,
    triangles: &Triangles<'_>,
    position: &[f32],
    noise: f64,
) -> Result<(Vec<f64>, Vec<f64>), Failure> {
    let (modes, brick) = with_transform(fine_side(universe.size)?, universe.exec, |fine| {
        Ok((contrast(universe, position, fine)?, *fine.fourier()))
    })?;
    let (_, mut power) =
        universe.power(&modes, &brick, &Binning::shells(&universe.edges), Compensation::None)?;
    power.iter_mut().for_each(|power| *power -= noise);
    let mut bispectrum = with_transform(triangles.side, universe.exec, |fft| {
        let mut fields = vec![0.0; triangles.reals(&*fft)?];
        triangles.measure(Those::Squeezed, &modes, &brick, fft, &mut fields)
    })?;
    if noise > 0.0 {
        let shot_noise = triangles.shot_noise(&modes, &brick, noise)?;
        bispectrum.iter_mut().zip(shot_noise).for_each(|(value, noise)| *value -= noise);
    }
    Ok((power, triangles.slice_of(&bispectrum)))
}

/// Where halos are: triples.
fn centres(universe: &Universe<'_>, position: &[f32]) -> Result<Vec<f32>, Failure> {
    let (particles, exec) = (position.len() / 3, universe.exec);
    let positions = Positions::triples(position)?;
    let length = linking_length(LINKING, universe.length, particles as u64)?;
    let mut labels = vec![0; particles];
    let mut scratch = Memory::new(fof_labels_scratch::<f32>(particles)?);
    fof_labels(&mut labels, &positions, None, universe.length, length, scratch.bytes(), exec)?;
    drop(scratch);
    let mut scratch = Memory::new(halos_scratch(particles)?);
    let groups = halo_count(&labels, LEAST, scratch.bytes(), exec)?;
    let mut catalogue = vec![Halo::default(); groups];
    let mass = mass(universe.size, universe.length)?;
    let length = universe.length;
    let count = halos(&mut catalogue, &labels, &positions, None, length, LEAST, mass, scratch.bytes(), exec)?;
    Ok(catalogue[..count].iter().flat_map(|halo| halo.centre.map(|x| x as f32)).collect())
}

/// Of one particle, Msun/h.
pub(crate) fn mass(size: usize, length: f64) -> Result<f64, Failure> {
    let omega_m = fixpair::cosmology::Cosmology::goliat().omega_m;
    Ok(particle_mass(omega_m, length, size.pow(3) as u64)?)
}
