//! One of several species of matter: its own density and velocity at first order, from the columns of a Boltzmann code.
//!
//! A species' modes are those of the total matter, times the ratio of two transfer functions of the time of the particles: every
//! species has the phases and, where amplitudes are fixed, the moduli of one noise. With T_m, T_s and V_s of total
//! matter, the species, and its velocity,
//!
//! delta_s = (T_s/T_m) delta_m,     v_s,k = a H i k/k^2 (V_s/T_m) delta_m,k
//!
//! so that V_s = f T_s where growth does not depend on k. All columns are positive and in one unit, which drops out:
//!
//! - CAMB's transfer data, file or `get_matter_transfer_data`, are such columns as they stand: "delta_cdm" and "v_newtonian_cdm" (-v k/H, H the
//!   conformal rate, over the same k^2), and those of baryons. They obey V_s = dlnT_s/dlna T_s to 3e-5 for k > 0.05 h/Mpc at z = 32. Above the
//!   horizon velocities are of the Newtonian gauge and densities of the synchronous: 6e-4 at k = 0.01, 2% at k = 1e-4.
//! - CLASS's d_s are of the other sign: take -d_s, and V_s = theta_s/H of its t_s = theta_s with a conformal H in 1/Mpc. Where the gauge is synchronous,
//!   theta_s + alpha k^2 with alpha = (h' + 6 eta')/(2 k^2) stands for theta_s, for cold matter is at rest there.
//!
//! A column `reference` takes growth that depends on k into account, massive neutrinos' or any other: it is what the linear spectrum, scaled
//! back with D of the background alone, stands for. With T_m(k, 0) D(a) there, modes of total matter are T_m(k, a)/(T_m(k, 0) D(a)) times those of
//! the scaled spectrum, which makes them the Boltzmann code's own of that time.

use super::mode_table::{check, fill};
use super::table::{Cursor, Table};
use crate::exec::Exec;
use crate::status::{Error, Result};

/// Columns of one species at the time of the particles, all in one unit, which drops out.
#[derive(Clone, Copy, Debug)]
pub struct Species<'a> {
    /// T_m: total matter, what gravity acts by.
    matter: Table<'a>,
    /// T_s.
    density: Table<'a>,
    /// V_s.
    velocity: Table<'a>,
    /// What the scaled linear spectrum stands for; T_m if there is none.
    reference: Option<Table<'a>>,
}

/// Which ratio of columns a table holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ratio {
    /// T_m/reference, to multiply alpha by.
    Matter,
    /// T_s/T_m.
    Density,
    /// V_s/T_m.
    Velocity,
}

impl<'a> Species<'a> {
    /// Borrows the columns. Below the first row ratios are constant; above the last they go on as power laws.
    ///
    /// # Errors
    /// As [`Table::new`].
    ///
    /// # Example
    /// ```
    /// use fixpair::cosmology::Species;
    ///
    /// let k = [1e-4, 0.01, 1.0]; // columns of a Boltzmann code at the time of the particles
    /// let (matter, density, velocity) = ([6e5, 5e5, 1e3], [5.9e5, 4.8e5, 9e2], [6e5, 5e5, 1e3]);
    /// let baryons = Species::new(&k, &matter, &density, &velocity, None)?;
    /// assert!(!baryons.has_own_growth());
    /// # Ok::<(), fixpair::status::Error>(())
    /// ```
    pub fn new(
        k: &'a [f64],
        matter: &'a [f64],
        density: &'a [f64],
        velocity: &'a [f64],
        reference: Option<&'a [f64]>,
    ) -> Result<Self> {
        let table = |column| Table::new(k, column)?.with_slope_below(0.0);
        let reference = reference.map(table).transpose()?;
        Ok(Self { matter: table(matter)?, density: table(density)?, velocity: table(velocity)?, reference })
    }

    fn tables(&self, ratio: Ratio) -> [Table<'a>; 2] {
        match ratio {
            Ratio::Matter => [self.matter, self.reference.unwrap_or(self.matter)],
            Ratio::Density => [self.density, self.matter],
            Ratio::Velocity => [self.velocity, self.matter],
        }
    }

    /// Is the linear spectrum to be corrected by T_m/reference?
    ///
    /// ```
    /// use fixpair::cosmology::Species;
    ///
    /// let k = [1e-4, 0.01, 1.0]; // columns of a Boltzmann code at the time of the particles
    /// let (matter, density, velocity) = ([6e5, 5e5, 1e3], [5.9e5, 4.8e5, 9e2], [6e5, 5e5, 1e3]);
    /// let baryons = Species::new(&k, &matter, &density, &velocity, None)?;
    /// assert!(!baryons.has_own_growth()); // there is no column to refer growth to
    /// # Ok::<(), fixpair::status::Error>(())
    /// ```
    #[must_use]
    pub fn has_own_growth(&self) -> bool {
        self.reference.is_some()
    }
}

/// Fills `out` with a ratio by |n|^2.
///
/// # Errors
/// As [`super::mode_table::alpha_table`].
///
/// Cost: 100 ns an entry.
///
/// # Example
/// ```
/// use fixpair::cosmology::Species;
///
/// let k = [1e-4, 0.01, 1.0]; // columns of a Boltzmann code at the time of the particles
/// let (matter, density, velocity) = ([6e5, 5e5, 1e3], [5.9e5, 4.8e5, 9e2], [6e5, 5e5, 1e3]);
/// let baryons = Species::new(&k, &matter, &density, &velocity, None)?;
/// use fixpair::cosmology::{Ratio, mode_table_length, species_table};
///
/// let mut table = vec![0.0; mode_table_length(8)?];
/// species_table(&fixpair::exec::Serial, &baryons, Ratio::Density, 8, 1000.0, &mut table)?;
/// assert!(table[1] < 1.0); // T_b/T_m
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn species_table(
    exec: &dyn Exec,
    species: &Species<'_>,
    ratio: Ratio,
    n: usize,
    box_size: f64,
    out: &mut [f64],
) -> Result<()> {
    let k_f = check(n, box_size, out)?;
    let tables = species.tables(ratio);
    let value = |above: &mut Cursor<'_>, below: &mut Cursor<'_>, m: usize| {
        let k = k_f * libm::sqrt(m as f64);
        let ln_k = libm::log(k);
        libm::exp(above.ln_value(k, ln_k) - below.ln_value(k, ln_k))
    };
    // Inside the rows the ratio is bounded by them, and outside it is a power law: only the ends can overflow.
    let [mut above, mut below] = tables.map(Cursor::new);
    if ![1, out.len() - 1].into_iter().all(|m| value(&mut above, &mut below, m).is_finite()) {
        return Err(Error::Range);
    }
    fill(exec, out, &|first, piece| {
        let [mut above, mut below] = tables.map(Cursor::new);
        for (i, entry) in piece.iter_mut().enumerate() {
            *entry = value(&mut above, &mut below, first + i);
        }
    })
}
