//! One species of several.

use super::border::Border;
use super::exec::{HostExec, fixpair_exec};
use super::status::{code, fixpair_status_t};
use crate::cosmology::{Ratio, Species, species_table};
use crate::status::{Error, Result};

/// T_m/reference: multiplies alpha, that is, the modes of total matter.
pub const FIXPAIR_RATIO_MATTER: i32 = 0;
/// T_s/T_m: from modes of total matter to those of the species.
pub const FIXPAIR_RATIO_DENSITY: i32 = 1;
/// V_s/T_m: from modes of total matter to v_s/(a H i k/k^2).
pub const FIXPAIR_RATIO_VELOCITY: i32 = 2;

/// One species of matter, cold dark matter or baryons, from the columns of CAMB or CLASS at the time of the particles, in any common unit, all
/// positive. `linear` of the conditions stays that of total matter. Called once for each species with one seed, initial conditions are matched:
/// the same phases, and the same moduli over their r.m.s.
///
/// delta_s = (T_s/T_m) delta_m and v_s,k = a H i k/k^2 (V_s/T_m) delta_m,k at first order; the second and third orders are those of total
/// matter, whose gravity moves both. What this leaves out: the coupling of the difference of the species at second order, isocurvature
/// that gravity does not remember, pressure, free streaming and thermal velocities (neutrinos are no particles here, only what they do to
/// linear growth), and growth of higher orders that depends on k. Growth after the start is the host's; it should move all species together.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct fixpair_species {
    /// sizeof(fixpair_species).
    pub struct_size: usize,
    /// Rows of each column, 2 or more.
    pub rows: usize,
    /// h/Mpc, increasing.
    pub k: *const f64,
    /// T_m of total matter, neutrinos included: what gravity acts by.
    pub matter: *const f64,
    /// T_s of the species: T_m itself, or that of matter without neutrinos, if there is but one.
    pub density: *const f64,
    /// V_s: f T_s where growth does not depend on k. CAMB: v_newtonian_cdm or v_newtonian_baryon as it stands beside the other columns.
    /// CLASS: theta_s/(a H) of the Newtonian gauge, or (theta_s + (h' + 6 eta')/2)/(a H) of the synchronous, with theta_s, h', eta'
    /// and a H all in CLASS's 1/Mpc; beside -d_s, for columns are positive.
    pub velocity: *const f64,
    /// What the linear spectrum, scaled back with D(a) of the background, stands for: T_m(k, z = 0) D(a). Then growth that depends on k is
    /// accounted for, and modes of total matter are T_m(k, a). NULL for T_m itself: growth as of the background.
    pub reference: *const f64,
}

/// # Safety
/// `species` is null, or it and its columns point to as many values as stated.
pub(super) unsafe fn optional_species<'a>(
    border: &mut Border,
    species: *const fixpair_species,
) -> Result<Option<Species<'a>>> {
    // SAFETY: the caller's promise.
    if species.is_null() { Ok(None) } else { unsafe { checked(border, species) }.map(Some) }
}

unsafe fn checked<'a>(border: &mut Border, species: *const fixpair_species) -> Result<Species<'a>> {
    // SAFETY: the caller's promise.
    unsafe {
        let fixpair_species { struct_size, rows, k, matter, density, velocity, reference } =
            *border.read_one(species)?;
        if struct_size != size_of::<fixpair_species>() {
            return Err(Error::Version);
        }
        let [k, matter, density, velocity] = [
            border.read(k, rows)?,
            border.read(matter, rows)?,
            border.read(density, rows)?,
            border.read(velocity, rows)?,
        ];
        let reference = if reference.is_null() { None } else { Some(border.read(reference, rows)?) };
        Species::new(k, matter, density, velocity, reference)
    }
}

/// Fills a species without columns: set them all but `reference`.
///
/// Out: species
/// Returns: 0, FIXPAIR_ERROR_NULL, FIXPAIR_ERROR_ALIGNMENT
///
/// # Safety
/// `species` is null or points to one.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_species_init(species: *mut fixpair_species) -> fixpair_status_t {
    let none = core::ptr::null();
    code((|| {
        // SAFETY: the caller's promise.
        *unsafe { Border::new().write_one(species) }? = fixpair_species {
            struct_size: size_of::<fixpair_species>(),
            rows: 0,
            k: none,
            matter: none,
            density: none,
            velocity: none,
            reference: none,
        };
        Ok(())
    })())
}

/// One ratio of a species' columns by integer |n|^2, for hosts that put initial conditions together stage by stage: with
/// fixpair_scale_modes_f64 it makes the modes of the species of those of total matter. Columns are interpolated as the linear
/// spectrum is; below the first row the ratio is constant.
///
/// Out: table    table_len = fixpair_mode_table_length(n) factors; entry 0 is 0
/// In:  species
///      ratio    FIXPAIR_RATIO_MATTER, _DENSITY or _VELOCITY
///      n        cells on a side of the mesh
///      box_size L
///      exec     or NULL
/// Returns: 0, FIXPAIR_ERROR_NULL, _LENGTH, _ALIGNMENT, _OVERLAP, _VERSION, _CHOICE, _NOT_FINITE, _RANGE, _TABLE for columns that are not positive or k that
///          does not increase, _MESH_SIZE, _OVERFLOW, _HOOK
///
/// # Safety
/// Pointers are null or point to as many values as stated.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_species_table(
    table: *mut f64,
    table_len: usize,
    species: *const fixpair_species,
    ratio: i32,
    n: usize,
    box_size: f64,
    exec: *const fixpair_exec,
) -> fixpair_status_t {
    code((|| {
        let mut border = Border::new();
        // SAFETY: the caller's promise.
        unsafe {
            let table = border.write(table, table_len)?;
            let species = checked(&mut border, species)?;
            let ratio = match ratio {
                FIXPAIR_RATIO_MATTER => Ratio::Matter,
                FIXPAIR_RATIO_DENSITY => Ratio::Density,
                FIXPAIR_RATIO_VELOCITY => Ratio::Velocity,
                _ => return Err(Error::Choice),
            };
            species_table(&HostExec::new(&mut border, exec)?, &species, ratio, n, box_size, table)
        }
    })())
}
