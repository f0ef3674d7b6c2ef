//! Deposit and read-out.

use core::ffi::c_void;

use super::border::Border;
use super::exec::{HostExec, fixpair_exec};
use super::mesh::fixpair_brick;
use super::status::{code, fixpair_status_t};
use crate::mesh::Space;
use crate::pm::{self, Assignment, Column, ColumnMut, Positions, Region, Window};
use crate::real::Real;
use crate::scratch::Layout;
use crate::status::{Error, Result};

/// Nearest grid point: p = 1.
pub const FIXPAIR_WINDOW_NGP: i32 = 1;
/// Cloud in cell: p = 2.
pub const FIXPAIR_WINDOW_CIC: i32 = 2;
/// Triangular shaped cloud: p = 3.
pub const FIXPAIR_WINDOW_TSC: i32 = 3;
/// Piecewise cubic spline: p = 4.
pub const FIXPAIR_WINDOW_PCS: i32 = 4;

/// Positions of `length` particles, where the host keeps them, to be read: coordinate x of particle i is x[i * stride], and so on. Arrays of
/// triples: y = x + 1, z = x + 2, stride 3. Three arrays: stride 1. A member of the host's particle struct: stride
/// sizeof(struct) / sizeof(double). A stride of 0 is refused (FIXPAIR_ERROR_RANGE).
#[repr(C)]
#[derive(Clone, Copy)]
pub struct fixpair_positions_f64 {
    /// First x.
    pub x: *const f64,
    /// First y.
    pub y: *const f64,
    /// First z.
    pub z: *const f64,
    /// From one particle to the next, in elements.
    pub stride: usize,
    /// Particles.
    pub length: usize,
}

impl Places for fixpair_positions_f64 {
    type Real = f64;

    fn parts(&self) -> ([*const f64; 3], usize, usize) {
        ([self.x, self.y, self.z], self.stride, self.length)
    }
}

/// Positions of `length` particles, where the host keeps them, to be read: coordinate x of particle i is x[i * stride], and so on. Arrays of
/// triples: y = x + 1, z = x + 2, stride 3. Three arrays: stride 1. A member of the host's particle struct: stride
/// sizeof(struct) / sizeof(float). A stride of 0 is refused (FIXPAIR_ERROR_RANGE).
#[repr(C)]
#[derive(Clone, Copy)]
pub struct fixpair_positions_f32 {
    /// First x.
    pub x: *const f32,
    /// First y.
    pub y: *const f32,
    /// First z.
    pub z: *const f32,
    /// From one particle to the next, in elements.
    pub stride: usize,
    /// Particles.
    pub length: usize,
}

impl Places for fixpair_positions_f32 {
    type Real = f32;

    fn parts(&self) -> ([*const f32; 3], usize, usize) {
        ([self.x, self.y, self.z], self.stride, self.length)
    }
}

/// The two position structs, as one.
pub(super) trait Places: Copy {
    type Real: Real;

    /// Starts, stride, particles.
    fn parts(&self) -> ([*const Self::Real; 3], usize, usize);
}

/// # Safety
/// `pointer` is null or points to positions whose elements nobody writes.
pub(super) unsafe fn positions<'a, P: Places>(
    border: &mut Border,
    pointer: *const P,
) -> Result<Positions<'a, P::Real>> {
    // SAFETY: the caller's promise.
    unsafe {
        let of = border.read_one(pointer)?;
        positions_of(border, of)
    }
}

/// # Safety
/// Nobody writes the elements.
pub(super) unsafe fn positions_of<'a, P: Places>(
    border: &mut Border,
    of: &P,
) -> Result<Positions<'a, P::Real>> {
    let (start, stride, length) = of.parts();
    if stride == 0 {
        return Err(Error::Range);
    }
    for first in start {
        border.read_strided(first, stride, length)?;
    }
    // SAFETY: the border has checked that elements are aligned; the rest is the caller's promise.
    Ok(unsafe { Positions::strided(start, stride, length) })
}

/// Cells, which may run over the edge of the mesh.
pub(super) fn region(brick: &fixpair_brick) -> Result<Region> {
    if super::mesh::space(brick.space)? != Space::Configuration {
        return Err(Error::Brick);
    }
    Region::new(brick.n, brick.start, brick.count, brick.stride)
}

/// Scratch of fixpair_deposit_f64: with m = min(particles, 2^21) and t tiles, 32 m + 2 m + 8 (m/8 + ceil(m/2^15)) + 4 t ceil(m/2^15) + 4 (t + 1)
/// bytes, each rounded up to 64; t is at most 4096 and depends on region and window alone. At most 75 MB, however many particles.
///
/// Out: scratch
/// In:  region     of configuration space; may run over the edge
///      particles  as many as will be passed, or more
///      window     FIXPAIR_WINDOW_NGP, _CIC, _TSC or _PCS
/// Returns: 0, FIXPAIR_ERROR_NULL, _ALIGNMENT, _OVERLAP, _OVERFLOW, _CHOICE, or why the region is refused
///
/// # Safety
/// Pointers are null or point to one value.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_deposit_scratch_f64(
    scratch: *mut Layout,
    region: *const fixpair_brick,
    particles: usize,
    window: i32,
) -> fixpair_status_t {
    // SAFETY: the caller's promise.
    code(unsafe { query(scratch, region, particles, window, pm::deposit_scratch::<f64>) })
}

/// fixpair_deposit_scratch_f64 in single precision: 16 m instead of 32 m, at most 41 MB.
///
/// # Safety
/// Pointers are null or point to one value.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_deposit_scratch_f32(
    scratch: *mut Layout,
    region: *const fixpair_brick,
    particles: usize,
    window: i32,
) -> fixpair_status_t {
    // SAFETY: the caller's promise.
    code(unsafe { query(scratch, region, particles, window, pm::deposit_scratch::<f32>) })
}

unsafe fn query(
    scratch: *mut Layout,
    brick: *const fixpair_brick,
    particles: usize,
    window: i32,
    ask: fn(&Region, usize, Window) -> Result<Layout>,
) -> Result<()> {
    let mut border = Border::new();
    // SAFETY: the caller's promise.
    let (scratch, brick) = unsafe { (border.write_one(scratch)?, border.read_one(brick)?) };
    *scratch = ask(&region(brick)?, particles, window.try_into()?)?;
    Ok(())
}

/// Adds the masses of particles to cells: mesh_c += sum_i w_i W(x_c - x_i), W the product of B-splines of p factors a cell wide each.
///
/// The sum of weights is conserved. For k != 0 the density contrast has the modes F_k/F_0, F the forward transform. Positions are wrapped into
/// the box, whatever their size. A particle whose cells the region does not hold is refused, unless it is within rounding of one that is
/// taken. With n below p its cells wrap onto each other. The result is the same, bit for bit, on any number of threads; regions that share cells
/// agree to rounding.
///
/// In/Out: mesh   mesh_len reals on the region, added to: set them to zero first
/// In:  region    of configuration space; may run over the edge (fixpair_brick_with_ghosts)
///      position
///      weights   of particle i at weights[i * weights_stride]; NULL for 1 each
///      box_size  L
///      window    FIXPAIR_WINDOW_NGP, _CIC, _TSC or _PCS
///      shift     mesh point i lies at (i + shift) L/n: 0, or 1/2 for the second mesh of interlacing; 0 <= shift < 1
///      scratch   scratch_len bytes, see fixpair_deposit_scratch_f64
///      exec      or NULL
/// Returns: 0, FIXPAIR_ERROR_NULL, _LENGTH, _ALIGNMENT, _OVERLAP, _OVERFLOW, _RANGE, _CHOICE, _SCRATCH, or why the region is refused;
///          FIXPAIR_ERROR_NOT_FINITE for box_size and shift, or for a position or weight, after which, as after FIXPAIR_ERROR_OUTSIDE, the
///          mesh holds some of the particles; after FIXPAIR_ERROR_HOOK it is undefined
/// Cost: on one core in single precision 9 (NGP) to 20 ns (PCS) a particle if neighbours in memory are neighbours in space, 21 to 38 ns in
///       random order
///
/// # Safety
/// Pointers are null or point to as many values as stated; the hooks keep their contracts.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_deposit_f64(
    mesh: *mut f64,
    mesh_len: usize,
    region: *const fixpair_brick,
    position: *const fixpair_positions_f64,
    weights: *const f64,
    weights_stride: usize,
    box_size: f64,
    window: i32,
    shift: f64,
    scratch: *mut c_void,
    scratch_len: usize,
    exec: *const fixpair_exec,
) -> fixpair_status_t {
    // SAFETY: the caller's promise.
    code(unsafe {
        add_particles(
            mesh,
            mesh_len,
            region,
            position,
            weights,
            weights_stride,
            box_size,
            window,
            shift,
            scratch,
            scratch_len,
            exec,
        )
    })
}

/// fixpair_deposit_f64 in single precision.
///
/// # Safety
/// Pointers are null or point to as many values as stated; the hooks keep their contracts.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_deposit_f32(
    mesh: *mut f32,
    mesh_len: usize,
    region: *const fixpair_brick,
    position: *const fixpair_positions_f32,
    weights: *const f32,
    weights_stride: usize,
    box_size: f64,
    window: i32,
    shift: f64,
    scratch: *mut c_void,
    scratch_len: usize,
    exec: *const fixpair_exec,
) -> fixpair_status_t {
    // SAFETY: the caller's promise.
    code(unsafe {
        add_particles(
            mesh,
            mesh_len,
            region,
            position,
            weights,
            weights_stride,
            box_size,
            window,
            shift,
            scratch,
            scratch_len,
            exec,
        )
    })
}

unsafe fn add_particles<P: Places>(
    mesh: *mut P::Real,
    mesh_len: usize,
    brick: *const fixpair_brick,
    position: *const P,
    weights: *const P::Real,
    weights_stride: usize,
    box_size: f64,
    window: i32,
    shift: f64,
    scratch: *mut c_void,
    scratch_len: usize,
    exec: *const fixpair_exec,
) -> Result<()> {
    let mut border = Border::new();
    // SAFETY: the caller's promise.
    unsafe {
        let mesh = border.write(mesh, mesh_len)?;
        let region = region(border.read_one(brick)?)?;
        let position = positions(&mut border, position)?;
        let weights = if weights.is_null() {
            None
        } else if weights_stride == 0 {
            return Err(Error::Range);
        } else {
            border.read_strided(weights, weights_stride, position.len())?;
            Some(Column::strided(weights, weights_stride, position.len()))
        };
        let assignment = Assignment { box_size, window: window.try_into()?, shift };
        let scratch = border.scratch(scratch, scratch_len)?;
        let exec = HostExec::new(&mut border, exec)?;
        pm::deposit(mesh, &region, &position, weights.as_ref(), &assignment, scratch, &exec)
    }
}

/// Scratch of fixpair_read_out_f64: with m = min(particles, 2^21) and t tiles, 32 m + 2 m + 8 (m/8 + ceil(m/2^15)) + 4 t ceil(m/2^15) + 4 (t + 1)
/// bytes, each rounded up to 64; t is at most 4096 and depends on region and window alone. At most 75 MB, however many particles.
///
/// Out: scratch
/// In:  region     of configuration space; may run over the edge
///      particles  as many as will be passed, or more
///      window     FIXPAIR_WINDOW_NGP, _CIC, _TSC or _PCS
/// Returns: 0, FIXPAIR_ERROR_NULL, _ALIGNMENT, _OVERLAP, _OVERFLOW, _CHOICE, or why the region is refused
///
/// # Safety
/// Pointers are null or point to one value.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_read_out_scratch_f64(
    scratch: *mut Layout,
    region: *const fixpair_brick,
    particles: usize,
    window: i32,
) -> fixpair_status_t {
    // SAFETY: the caller's promise.
    code(unsafe { query(scratch, region, particles, window, pm::read_out_scratch::<f64>) })
}

/// fixpair_read_out_scratch_f64 in single precision: 16 m instead of 32 m, at most 41 MB.
///
/// # Safety
/// Pointers are null or point to one value.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_read_out_scratch_f32(
    scratch: *mut Layout,
    region: *const fixpair_brick,
    particles: usize,
    window: i32,
) -> fixpair_status_t {
    // SAFETY: the caller's promise.
    code(unsafe { query(scratch, region, particles, window, pm::read_out_scratch::<f32>) })
}

/// What a mesh is worth at particles: value_i = sum_c W(x_c - x_i) mesh_c, the exact adjoint of fixpair_deposit_f64.
///
/// Out: values    of particle i at values[i * values_stride], overwritten
/// In:  mesh      mesh_len reals on the region, ghost planes filled (fixpair_copy_cells_f64)
///      region    of configuration space; may run over the edge (fixpair_brick_with_ghosts)
///      position
///      box_size, window, shift  as fixpair_deposit_f64
///      scratch   scratch_len bytes, see fixpair_read_out_scratch_f64
///      exec      or NULL
/// Returns: as fixpair_deposit_f64; after FIXPAIR_ERROR_NOT_FINITE for a position and FIXPAIR_ERROR_OUTSIDE some values are written
/// Cost: as fixpair_deposit_f64, or less
///
/// # Safety
/// Pointers are null or point to as many values as stated; the hooks keep their contracts.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_read_out_f64(
    values: *mut f64,
    values_stride: usize,
    mesh: *const f64,
    mesh_len: usize,
    region: *const fixpair_brick,
    position: *const fixpair_positions_f64,
    box_size: f64,
    window: i32,
    shift: f64,
    scratch: *mut c_void,
    scratch_len: usize,
    exec: *const fixpair_exec,
) -> fixpair_status_t {
    // SAFETY: the caller's promise.
    code(unsafe {
        read_mesh(
            values,
            values_stride,
            mesh,
            mesh_len,
            region,
            position,
            box_size,
            window,
            shift,
            scratch,
            scratch_len,
            exec,
        )
    })
}

/// fixpair_read_out_f64 in single precision.
///
/// # Safety
/// Pointers are null or point to as many values as stated; the hooks keep their contracts.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_read_out_f32(
    values: *mut f32,
    values_stride: usize,
    mesh: *const f32,
    mesh_len: usize,
    region: *const fixpair_brick,
    position: *const fixpair_positions_f32,
    box_size: f64,
    window: i32,
    shift: f64,
    scratch: *mut c_void,
    scratch_len: usize,
    exec: *const fixpair_exec,
) -> fixpair_status_t {
    // SAFETY: the caller's promise.
    code(unsafe {
        read_mesh(
            values,
            values_stride,
            mesh,
            mesh_len,
            region,
            position,
            box_size,
            window,
            shift,
            scratch,
            scratch_len,
            exec,
        )
    })
}

unsafe fn read_mesh<P: Places>(
    values: *mut P::Real,
    values_stride: usize,
    mesh: *const P::Real,
    mesh_len: usize,
    brick: *const fixpair_brick,
    position: *const P,
    box_size: f64,
    window: i32,
    shift: f64,
    scratch: *mut c_void,
    scratch_len: usize,
    exec: *const fixpair_exec,
) -> Result<()> {
    let mut border = Border::new();
    // SAFETY: the caller's promise.
    unsafe {
        let mesh = border.read(mesh, mesh_len)?;
        let region = region(border.read_one(brick)?)?;
        let position = positions(&mut border, position)?;
        if values_stride == 0 {
            return Err(Error::Range);
        }
        border.strided(values, values_stride, position.len())?;
        let mut values = ColumnMut::strided(values, values_stride, position.len());
        let assignment = Assignment { box_size, window: window.try_into()?, shift };
        let scratch = border.scratch(scratch, scratch_len)?;
        let exec = HostExec::new(&mut border, exec)?;
        pm::read_out(&mut values, mesh, &region, &position, &assignment, scratch, &exec)
    }
}
