//! What is measured in one universe, and what all universes share.

use crate::bispectrum::Slice;
use crate::redshift_space::Multipoles;
use crate::store::Content;

/// What the measurements of all universes share.
#[derive(Clone, Debug, Default)]
pub(crate) struct Bins {
    /// Mean wavenumber of each bin, h/Mpc, increasing.
    pub(crate) k: Vec<f64>,
    /// Modes in each bin, counting k and -k.
    pub(crate) modes: Vec<u64>,
    /// Linear theory at z = 32 averaged over the modes of each bin, (Mpc/h)^3.
    pub(crate) theory: Vec<f64>,
    /// The same at z = 1.
    pub(crate) late_theory: Vec<f64>,
    /// alpha at z = 1 in the middle of each bin.
    pub(crate) late_alpha: Vec<f64>,
    /// The squeezed triangles, with theory at z = 32.
    pub(crate) squeezed: Slice,
    /// What the theory of B is multiplied by from z = 32 to z = 1.
    pub(crate) squeezed_growth: f64,
}

/// At z = 32.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Early {
    /// Measured power, (Mpc/h)^3.
    pub(crate) power: Vec<f64>,
    /// The bispectrum of squeezed triangles, (Mpc/h)^6.
    pub(crate) squeezed: Vec<f64>,
    /// f_NL from all triangles of this one field.
    pub(crate) fnl: f64,
    /// Multipoles of the particles in redshift space, (Mpc/h)^3, in the same bins; only where they were asked for.
    pub(crate) multipoles: Option<Multipoles>,
    /// Density contrast in one plane of the mesh, `size` x `size`, x fastest; only where it was asked for.
    pub(crate) slice: Option<Vec<f32>>,
}

/// At z = 1. Spectra of halos are zero where there are none.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Late {
    /// Of matter, (Mpc/h)^3.
    pub(crate) matter: Vec<f64>,
    /// Of halos, without shot noise, (Mpc/h)^3.
    pub(crate) halos: Vec<f64>,
    /// Halos.
    pub(crate) count: u64,
    /// The bispectrum of squeezed triangles of matter, (Mpc/h)^6.
    pub(crate) matter_squeezed: Vec<f64>,
    /// The same of halos, without shot noise.
    pub(crate) halo_squeezed: Vec<f64>,
}

/// One universe.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Measurement {
    pub(crate) early: Early,
    pub(crate) late: Late,
}

impl Early {
    pub(crate) fn put(&self, content: &mut Content) {
        content.put_reals(&self.power);
        content.put_reals(&self.squeezed);
        content.put_real(self.fnl);
        // Empty for none: neither has no bins.
        let none = Multipoles::default();
        self.multipoles.as_ref().unwrap_or(&none).iter().for_each(|power| content.put_reals(power));
        content.put_singles(self.slice.as_deref().unwrap_or(&[]));
    }

    pub(crate) fn get(content: &mut Content) -> Option<Self> {
        let (power, squeezed, fnl) = (content.get_reals()?, content.get_reals()?, content.get_real()?);
        let multipoles = [content.get_reals()?, content.get_reals()?, content.get_reals()?];
        let slice = content.get_singles()?;
        Some(Self {
            power,
            squeezed,
            fnl,
            multipoles: (!multipoles[0].is_empty()).then_some(multipoles),
            slice: (!slice.is_empty()).then_some(slice),
        })
    }
}

impl Measurement {
    pub(crate) fn content(&self) -> Content {
        let mut content = Content::default();
        self.early.put(&mut content);
        let Late { matter, halos, count, matter_squeezed, halo_squeezed } = &self.late;
        content.put(*count);
        [matter, halos, matter_squeezed, halo_squeezed].iter().for_each(|column| content.put_reals(column));
        content
    }

    /// None where numbers are missing.
    pub(crate) fn of(content: &mut Content) -> Option<Self> {
        let (early, count) = (Early::get(content)?, content.get()?);
        let [matter, halos, matter_squeezed, halo_squeezed] =
            [content.get_reals()?, content.get_reals()?, content.get_reals()?, content.get_reals()?];
        Some(Self { early, late: Late { matter, halos, count, matter_squeezed, halo_squeezed } })
    }

    /// Whether all of it is there, finite, and positive where theory says so.
    pub(crate) fn is_sound(&self, bins: &Bins) -> bool {
        let Self { early, late } = self;
        let [bin, triangle] = [bins.k.len(), bins.squeezed.k.len()];
        let spectra = [&early.power, &late.matter];
        let positive = spectra.iter().all(|power| power.iter().all(|&power| power > 0.0));
        let whole = [&early.power, &late.matter, &late.halos].iter().all(|column| column.len() == bin)
            && [&early.squeezed, &late.matter_squeezed, &late.halo_squeezed]
                .iter()
                .all(|column| column.len() == triangle)
            && early.multipoles.iter().flatten().all(|column| column.len() == bin);
        let columns = [
            &early.power,
            &early.squeezed,
            &late.matter,
            &late.halos,
            &late.matter_squeezed,
            &late.halo_squeezed,
        ];
        let mut numbers = columns.into_iter().chain(early.multipoles.iter().flatten()).flatten();
        positive && whole && early.fnl.is_finite() && numbers.all(|number| number.is_finite())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_measurement_is_read_as_it_was_written() {
        let early = Early { power: vec![1.0, 2.0], squeezed: vec![-3.0], fnl: 4.5, ..Early::default() };
        let late = Late {
            matter: vec![5.0],
            halos: vec![],
            count: 6,
            matter_squeezed: vec![7.0],
            halo_squeezed: vec![8.0],
        };
        let plain = Measurement { early: early.clone(), late };
        let more = Early {
            multipoles: Some([1.0, 2.0, 3.0].map(|x| vec![x; 2])),
            slice: Some(vec![0.5; 4]),
            ..early
        };
        let more = Measurement { early: more, ..plain.clone() };
        for measurement in [plain, more] {
            assert_eq!(Measurement::of(&mut measurement.content()), Some(measurement));
        }
        assert_eq!(Measurement::of(&mut Content::default()), None);
    }
}
