//! Spherical overdensities.

use core::ffi::c_void;

use super::border::Border;
use super::cosmology::fixpair_cosmology;
use super::exec::{HostExec, fixpair_exec};
use super::fof::query;
use super::pm::{Places, fixpair_positions_f32, fixpair_positions_f64, positions};
use super::status::{code, fixpair_status_t};
use crate::halos::{self, Density, Overdensity, Shrink, Sphere};
use crate::scratch::Layout;
use crate::status::{Error, Result};

/// So many times the mean density of matter: 200 for 200b.
pub const FIXPAIR_OVERDENSITY_MEAN: i32 = 0;
/// So many times the critical density: 200 for 200c.
pub const FIXPAIR_OVERDENSITY_CRITICAL: i32 = 1;
/// Of a virialised halo (Bryan & Norman 1998, astro-ph/9710107, Eq. 6).
pub const FIXPAIR_OVERDENSITY_VIRIAL: i32 = 2;

/// Delta, a halo's density over the mean density of matter: `times` (MEAN), times/Om(a) (CRITICAL), or Delta_c/Om(a) (VIRIAL), with x = Om(a) - 1,
/// Delta_c = 18 pi^2 + 82 x - 39 x^2 in a flat universe with dark energy, 18 pi^2 + 60 x - 32 x^2 in an open one without.
///
/// The virial one falls from 337 today (Om = 0.3) to 178 in matter domination: before z = 1.1 virial masses exceed those of 200 times the mean.
///
/// Out: delta
/// In:  definition  FIXPAIR_OVERDENSITY_MEAN, _CRITICAL or _VIRIAL
///      times       200, say; not read with FIXPAIR_OVERDENSITY_VIRIAL
///      cosmology
///      a           scale factor
/// Returns: 0, FIXPAIR_ERROR_NULL, _ALIGNMENT, _OVERLAP, _NOT_FINITE, _CHOICE, _VERSION; FIXPAIR_ERROR_RANGE for a or `times` not positive, for the
///          virial one in a curved universe with dark energy (|1 - Om - Ode - Or| > 1e-3), or for the cosmology
///
/// # Safety
/// Pointers are null or point to one value.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_overdensity(
    delta: *mut f64,
    definition: i32,
    times: f64,
    cosmology: *const fixpair_cosmology,
    a: f64,
) -> fixpair_status_t {
    code((|| {
        let mut border = Border::new();
        // SAFETY: the caller's promise.
        let (delta, cosmology) = unsafe { (border.write_one(delta)?, border.read_one(cosmology)?.check()?) };
        let overdensity = match definition {
            FIXPAIR_OVERDENSITY_MEAN => Overdensity::Mean(times),
            FIXPAIR_OVERDENSITY_CRITICAL => Overdensity::Critical(times),
            FIXPAIR_OVERDENSITY_VIRIAL => Overdensity::Virial,
            _ => return Err(Error::Choice),
        };
        *delta = overdensity.over_mean(&cosmology, a)?;
        Ok(())
    })())
}

/// Scratch of fixpair_spheres_f64 and fixpair_refine_centres_f64: 36 bytes a particle, and at most 4.2 MB.
///
/// Out: scratch
/// In:  particles  as many as will be passed, or more
/// Returns: 0, FIXPAIR_ERROR_NULL, _ALIGNMENT, FIXPAIR_ERROR_OVERFLOW for 2^32 particles and more
///
/// # Safety
/// `scratch` is null or points to one value.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_spheres_scratch_f64(
    scratch: *mut Layout,
    particles: usize,
) -> fixpair_status_t {
    // SAFETY: the caller's promise.
    code(unsafe { query(scratch, particles, halos::spheres_scratch::<f64>) })
}

/// Scratch of fixpair_spheres_f32 and fixpair_refine_centres_f32: 24 bytes a particle, and at most 4.2 MB.
///
/// # Safety
/// `scratch` is null or points to one value.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_spheres_scratch_f32(
    scratch: *mut Layout,
    particles: usize,
) -> fixpair_status_t {
    // SAFETY: the caller's promise.
    code(unsafe { query(scratch, particles, halos::spheres_scratch::<f32>) })
}

/// Spherical overdensity masses: grows spheres about given centres until their mean density has fallen to Delta times that of matter.
///
/// R and M = k m are the solution of R = R_k = (3 k L^3/(4 pi Delta N))^(1/3) with k particles within R_k (inclusive) that has the smallest k not
/// below n_min: going outwards from where n_min particles would do, the first radius at which the density has fallen to Delta. So
/// M = (4 pi/3) R^3 Delta rho_m holds exactly. Members, mass and radius are 0 if fewer than n_min particles lie within R_n_min: not that dense.
///
/// Out: spheres            for each centre, each overdensity; spheres_len = centres_len x overdensities_len
/// In:  centres            centres_len of them, 3 numbers each; any finite numbers, taken modulo L. See fixpair_refine_centres_f64
///      overdensities      overdensities_len values of Delta, each at least 2; see fixpair_overdensity
///      position           all particles that may lie in the spheres; with several processes: with ghosts as deep as the largest radius
///      box_size           L
///      particles_total    N, of the whole simulation on all processes
///      particle_mass      m, see fixpair_particle_mass
///      n_min              1 or more
///      scratch            scratch_len bytes, see fixpair_spheres_scratch_f64
///      exec               or NULL
/// Returns: 0, FIXPAIR_ERROR_NULL, _LENGTH, _ALIGNMENT, _OVERLAP, _OVERFLOW, _NOT_FINITE, _RANGE, _SCRATCH; FIXPAIR_ERROR_HOOK, after which spheres
///          are undefined
/// Cost: a sort of the particles, 60 ns each on one core, then a few counts of those in each sphere
///
/// # Safety
/// Pointers are null or point to as many values as stated; the hooks keep their contracts.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_spheres_f64(
    spheres: *mut Sphere,
    spheres_len: usize,
    centres: *const f64,
    centres_len: usize,
    overdensities: *const f64,
    overdensities_len: usize,
    position: *const fixpair_positions_f64,
    box_size: f64,
    particles_total: u64,
    particle_mass: f64,
    n_min: u64,
    scratch: *mut c_void,
    scratch_len: usize,
    exec: *const fixpair_exec,
) -> fixpair_status_t {
    let density = Density { box_size, particles_total, particle_mass, n_min };
    // SAFETY: the caller's promise.
    code(unsafe {
        grow(
            spheres,
            spheres_len,
            centres,
            centres_len,
            overdensities,
            overdensities_len,
            position,
            &density,
            scratch,
            scratch_len,
            exec,
        )
    })
}

/// fixpair_spheres_f64 in single precision.
///
/// # Safety
/// Pointers are null or point to as many values as stated; the hooks keep their contracts.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_spheres_f32(
    spheres: *mut Sphere,
    spheres_len: usize,
    centres: *const f64,
    centres_len: usize,
    overdensities: *const f64,
    overdensities_len: usize,
    position: *const fixpair_positions_f32,
    box_size: f64,
    particles_total: u64,
    particle_mass: f64,
    n_min: u64,
    scratch: *mut c_void,
    scratch_len: usize,
    exec: *const fixpair_exec,
) -> fixpair_status_t {
    let density = Density { box_size, particles_total, particle_mass, n_min };
    // SAFETY: the caller's promise.
    code(unsafe {
        grow(
            spheres,
            spheres_len,
            centres,
            centres_len,
            overdensities,
            overdensities_len,
            position,
            &density,
            scratch,
            scratch_len,
            exec,
        )
    })
}

unsafe fn grow<P: Places>(
    spheres: *mut Sphere,
    spheres_len: usize,
    centres: *const f64,
    centres_len: usize,
    overdensities: *const f64,
    overdensities_len: usize,
    position: *const P,
    density: &Density,
    scratch: *mut c_void,
    scratch_len: usize,
    exec: *const fixpair_exec,
) -> Result<()> {
    let mut border = Border::new();
    // SAFETY: the caller's promise.
    unsafe {
        let spheres = border.write(spheres, spheres_len)?;
        let centres = border.read(centres.cast::<[f64; 3]>(), centres_len)?;
        let overdensities = border.read(overdensities, overdensities_len)?;
        let position = positions(&mut border, position)?;
        let scratch = border.scratch(scratch, scratch_len)?;
        let exec = HostExec::new(&mut border, exec)?;
        halos::spheres(spheres, centres, overdensities, &position, density, scratch, &exec)
    }
}

/// Moves centres to the densest place near them: shrinking spheres (Power et al. 2003, astro-ph/0201544).
///
/// Each centre moves to the centre of mass of the particles within its radius, then the radius shrinks by a factor, until a sphere would hold
/// fewer than n_min particles.
///
/// In/out: centres   centres_len of them, 3 numbers each; any finite numbers; on return in [0, L). One whose first sphere holds fewer than n_min
///                   particles stays
/// In:  radii        centres_len radii of first spheres, 0 or more, taken as L/4 if larger; about twice the radius of a fixpair_halo
///      position     all particles that may lie in the spheres
///      box_size     L
///      factor       0.975 in the source; from 0.5 to 0.99
///      n_min        1 or more; 100, or 1% of the first sphere's, in the source
///      scratch      scratch_len bytes, see fixpair_spheres_scratch_f64
///      exec         or NULL
/// Returns: 0, FIXPAIR_ERROR_NULL, _ALIGNMENT, _OVERLAP, _OVERFLOW, _NOT_FINITE, _RANGE, _SCRATCH; FIXPAIR_ERROR_HOOK, after which some centres
///          are moved
/// Cost: a sort of the particles, then log(last radius/first)/log(factor) sums over those in each sphere
///
/// # Safety
/// Pointers are null or point to as many values as stated; the hooks keep their contracts.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_refine_centres_f64(
    centres: *mut f64,
    centres_len: usize,
    radii: *const f64,
    position: *const fixpair_positions_f64,
    box_size: f64,
    factor: f64,
    n_min: u64,
    scratch: *mut c_void,
    scratch_len: usize,
    exec: *const fixpair_exec,
) -> fixpair_status_t {
    let shrink = Shrink { factor, n_min };
    // SAFETY: the caller's promise.
    code(unsafe {
        refine(centres, centres_len, radii, position, box_size, &shrink, scratch, scratch_len, exec)
    })
}

/// fixpair_refine_centres_f64 in single precision.
///
/// # Safety
/// Pointers are null or point to as many values as stated; the hooks keep their contracts.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_refine_centres_f32(
    centres: *mut f64,
    centres_len: usize,
    radii: *const f64,
    position: *const fixpair_positions_f32,
    box_size: f64,
    factor: f64,
    n_min: u64,
    scratch: *mut c_void,
    scratch_len: usize,
    exec: *const fixpair_exec,
) -> fixpair_status_t {
    let shrink = Shrink { factor, n_min };
    // SAFETY: the caller's promise.
    code(unsafe {
        refine(centres, centres_len, radii, position, box_size, &shrink, scratch, scratch_len, exec)
    })
}

unsafe fn refine<P: Places>(
    centres: *mut f64,
    centres_len: usize,
    radii: *const f64,
    position: *const P,
    box_size: f64,
    shrink: &Shrink,
    scratch: *mut c_void,
    scratch_len: usize,
    exec: *const fixpair_exec,
) -> Result<()> {
    let mut border = Border::new();
    // SAFETY: the caller's promise.
    unsafe {
        let centres = border.write(centres.cast::<[f64; 3]>(), centres_len)?;
        let radii = border.read(radii, centres_len)?;
        let position = positions(&mut border, position)?;
        let scratch = border.scratch(scratch, scratch_len)?;
        let exec = HostExec::new(&mut border, exec)?;
        halos::refine_centres(centres, radii, &position, box_size, shrink, scratch, &exec)
    }
}
