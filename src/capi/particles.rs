//! Particles.

use super::border::Border;
use super::exec::{HostExec, fixpair_exec};
use super::mesh::fixpair_brick;
use super::status::{code, fixpair_status_t};
use crate::initial::particles::{self, Components, Step};
use crate::real::Real;
use crate::status::{Error, Result};

/// Three components for each of `length` particles, where the host keeps them: component x of particle i is x[i * stride], and so on. Arrays
/// of triples: y = x + 1, z = x + 2, stride 3. Three arrays: stride 1. A member of the host's particle struct: stride
/// sizeof(struct) / sizeof(double). A stride of 0 is refused (FIXPAIR_ERROR_RANGE), and so are two arguments of
/// one call that lie in the same memory with strides of different bytes (FIXPAIR_ERROR_OVERLAP).
#[repr(C)]
#[derive(Clone, Copy)]
pub struct fixpair_components_f64 {
    /// First x.
    pub x: *mut f64,
    /// First y.
    pub y: *mut f64,
    /// First z.
    pub z: *mut f64,
    /// From one particle to the next, in elements.
    pub stride: usize,
    /// Particles.
    pub length: usize,
}

impl Triple for fixpair_components_f64 {
    type Real = f64;

    fn parts(&self) -> ([*mut f64; 3], usize, usize) {
        ([self.x, self.y, self.z], self.stride, self.length)
    }
}

/// Three components for each of `length` particles, where the host keeps them: component x of particle i is x[i * stride], and so on. Arrays
/// of triples: y = x + 1, z = x + 2, stride 3. Three arrays: stride 1. A member of the host's particle struct: stride
/// sizeof(struct) / sizeof(float). A stride of 0 is refused (FIXPAIR_ERROR_RANGE), and so are two arguments of
/// one call that lie in the same memory with strides of different bytes (FIXPAIR_ERROR_OVERLAP).
#[repr(C)]
#[derive(Clone, Copy)]
pub struct fixpair_components_f32 {
    /// First x.
    pub x: *mut f32,
    /// First y.
    pub y: *mut f32,
    /// First z.
    pub z: *mut f32,
    /// From one particle to the next, in elements.
    pub stride: usize,
    /// Particles.
    pub length: usize,
}

impl Triple for fixpair_components_f32 {
    type Real = f32;

    fn parts(&self) -> ([*mut f32; 3], usize, usize) {
        ([self.x, self.y, self.z], self.stride, self.length)
    }
}

/// The two component structs, as one.
pub(super) trait Triple: Copy {
    type Real: Real;

    /// Starts, stride, particles.
    fn parts(&self) -> ([*mut Self::Real; 3], usize, usize);
}

/// # Safety
/// `pointer` is null or points to components whose elements nobody else touches.
pub(super) unsafe fn components<'a, C: Triple>(
    border: &mut Border,
    pointer: *const C,
) -> Result<Components<'a, C::Real>> {
    // SAFETY: the caller's promise.
    unsafe {
        let of = border.read_one(pointer)?;
        components_of(border, of)
    }
}

/// # Safety
/// Nobody else touches the elements.
pub(super) unsafe fn components_of<'a, C: Triple>(
    border: &mut Border,
    of: &C,
) -> Result<Components<'a, C::Real>> {
    let (start, stride, length) = of.parts();
    if stride == 0 {
        return Err(Error::Range);
    }
    for first in start {
        border.strided(first, stride, length)?;
    }
    // SAFETY: the border has checked that elements are aligned and apart; the rest is the caller's promise.
    Ok(unsafe { Components::strided(start, stride, length) })
}

/// Moves the particles of a brick's cells along one axis: x = q + psi1 + psi2, wrapped into [0, L); v = c1 psi1 + c2 psi2.
///
/// Out: position  component `axis` of one particle a cell, numbered with z fastest whatever the strides of the brick
///      velocity  the same
/// In:  psi1      psi_len reals on the brick
///      psi2      psi_len reals, or NULL at first order
///      brick     of configuration space
///      axis      0, 1, 2
///      box_size  L
///      c1, c2    velocity over displacement: a H f1 and a H f2, H = 100 E(a) km/s per Mpc/h
///      exec      or NULL
/// Returns: 0, FIXPAIR_ERROR_NULL, _LENGTH, _ALIGNMENT, _OVERLAP, _RANGE, _HOOK, or why the brick is refused; FIXPAIR_ERROR_NOT_FINITE for box_size, c1 and c2, or
///          for displacements that are NaN, infinite or beyond 1e9 boxes and velocities beyond the numbers, after which both are undefined
///
/// # Safety
/// Pointers are null or point to as many values as stated; the hooks keep their contracts.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_displace_f64(
    position: *const fixpair_components_f64,
    velocity: *const fixpair_components_f64,
    psi1: *const f64,
    psi2: *const f64,
    psi_len: usize,
    brick: *const fixpair_brick,
    axis: usize,
    box_size: f64,
    c1: f64,
    c2: f64,
    exec: *const fixpair_exec,
) -> fixpair_status_t {
    // SAFETY: the caller's promise.
    code(unsafe {
        move_particles(position, velocity, psi1, psi2, psi_len, brick, axis, box_size, c1, c2, exec)
    })
}

/// fixpair_displace_f64 in single precision.
///
/// # Safety
/// Pointers are null or point to as many values as stated; the hooks keep their contracts.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_displace_f32(
    position: *const fixpair_components_f32,
    velocity: *const fixpair_components_f32,
    psi1: *const f32,
    psi2: *const f32,
    psi_len: usize,
    brick: *const fixpair_brick,
    axis: usize,
    box_size: f64,
    c1: f64,
    c2: f64,
    exec: *const fixpair_exec,
) -> fixpair_status_t {
    // SAFETY: the caller's promise.
    code(unsafe {
        move_particles(position, velocity, psi1, psi2, psi_len, brick, axis, box_size, c1, c2, exec)
    })
}

unsafe fn move_particles<C: Triple>(
    position: *const C,
    velocity: *const C,
    psi1: *const C::Real,
    psi2: *const C::Real,
    psi_len: usize,
    brick: *const fixpair_brick,
    axis: usize,
    box_size: f64,
    c1: f64,
    c2: f64,
    exec: *const fixpair_exec,
) -> Result<()> {
    let mut border = Border::new();
    // SAFETY: the caller's promise.
    unsafe {
        let mut position = components(&mut border, position)?;
        let mut velocity = components(&mut border, velocity)?;
        let psi1 = border.read(psi1, psi_len)?;
        let psi2 = border.read_optional(psi2, psi_len)?;
        let brick = border.read_one(brick)?.check()?;
        let step = Step { box_size, first_velocity: c1, second_velocity: c2 };
        let exec = HostExec::new(&mut border, exec)?;
        particles::displace(&mut position, &mut velocity, psi1, psi2, &brick, axis, &step, &exec)
    }
}

/// Ids of the particles of a brick: ((x n) + y) n + z + first_id, the same in every decomposition.
///
/// Out: ids       len = cells of the brick, numbered with z fastest
/// In:  brick     of configuration space
///      first_id  0, or 1 as Gadget files have it
///      exec      or NULL
/// Returns: 0, FIXPAIR_ERROR_NULL, _LENGTH, _ALIGNMENT, _OVERFLOW, _HOOK, or why the brick is refused
///
/// # Safety
/// Pointers are null or point to as many values as stated.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_particle_ids(
    ids: *mut u64,
    len: usize,
    brick: *const fixpair_brick,
    first_id: u64,
    exec: *const fixpair_exec,
) -> fixpair_status_t {
    code((|| {
        let mut border = Border::new();
        // SAFETY: the caller's promise.
        unsafe {
            let ids = border.write(ids, len)?;
            let brick = border.read_one(brick)?.check()?;
            particles::particle_ids(ids, &brick, first_id, &HostExec::new(&mut border, exec)?)
        }
    })())
}
