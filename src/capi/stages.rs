//! The stages of the initial conditions, for hosts that put them together themselves.

use core::ffi::c_void;

use super::border::Border;
use super::exec::{HostExec, fixpair_exec};
use super::fft::{Hook, HostFft, fixpair_fft_f32, fixpair_fft_f64};
use super::mesh::fixpair_brick;
use super::status::{code, fixpair_status_t};
use crate::initial::png::{Local, add_local, add_local_scratch};
use crate::initial::{lpt, modes};
use crate::real::Real;
use crate::scratch::{Arena, Layout};
use crate::status::Result;

/// f_k <- f_k table[|n|^2], n = k L/(2 pi); modes with a mode number n/2 become zero. With a table of alpha: from Phi to the density.
///
/// In/Out: modes  len reals
/// In:     brick  of Fourier space
///         table  table_len >= fixpair_mode_table_length(n) factors
///         exec   or NULL
/// Returns: 0, FIXPAIR_ERROR_NULL, _LENGTH, _ALIGNMENT, _OVERLAP, _HOOK, _NOT_FINITE for such a factor, or why the brick is refused
///
/// # Safety
/// Pointers are null or point to as many values as stated; the hooks keep their contracts.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_scale_modes_f64(
    modes: *mut f64,
    len: usize,
    brick: *const fixpair_brick,
    table: *const f64,
    table_len: usize,
    exec: *const fixpair_exec,
) -> fixpair_status_t {
    // SAFETY: the caller's promise.
    code(unsafe { scale(modes, len, brick, table, table_len, exec) })
}

/// fixpair_scale_modes_f64 in single precision.
///
/// # Safety
/// Pointers are null or point to as many values as stated; the hooks keep their contracts.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_scale_modes_f32(
    modes: *mut f32,
    len: usize,
    brick: *const fixpair_brick,
    table: *const f64,
    table_len: usize,
    exec: *const fixpair_exec,
) -> fixpair_status_t {
    // SAFETY: the caller's promise.
    code(unsafe { scale(modes, len, brick, table, table_len, exec) })
}

unsafe fn scale<T: Real>(
    modes: *mut T,
    len: usize,
    brick: *const fixpair_brick,
    table: *const f64,
    table_len: usize,
    exec: *const fixpair_exec,
) -> Result<()> {
    let mut border = Border::new();
    // SAFETY: the caller's promise.
    unsafe {
        let modes = border.write(modes, len)?;
        let brick = border.read_one(brick)?.check()?;
        let table = border.read(table, table_len)?;
        modes::scale_by_table(modes, &brick, table, &HostExec::new(&mut border, exec)?)
    }
}

/// Copies modes to a mesh of another side or layout. Modes that only one of the meshes has are dropped or become zero, and so do
/// those with a mode number of half the smaller side.
///
/// Out: to          to_len reals
/// In:  to_brick    of Fourier space
///      from        from_len reals
///      from_brick  of Fourier space; must hold every mode that `to_brick` shares with its mesh
///      exec        or NULL
/// Returns: 0, FIXPAIR_ERROR_NULL, _LENGTH, _ALIGNMENT, _OVERLAP, _HOOK, or why a brick is refused
///
/// # Safety
/// Pointers are null or point to as many values as stated; the hooks keep their contracts.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_copy_modes_f64(
    to: *mut f64,
    to_len: usize,
    to_brick: *const fixpair_brick,
    from: *const f64,
    from_len: usize,
    from_brick: *const fixpair_brick,
    exec: *const fixpair_exec,
) -> fixpair_status_t {
    // SAFETY: the caller's promise.
    code(unsafe { copy(to, to_len, to_brick, from, from_len, from_brick, exec) })
}

/// fixpair_copy_modes_f64 in single precision.
///
/// # Safety
/// Pointers are null or point to as many values as stated; the hooks keep their contracts.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_copy_modes_f32(
    to: *mut f32,
    to_len: usize,
    to_brick: *const fixpair_brick,
    from: *const f32,
    from_len: usize,
    from_brick: *const fixpair_brick,
    exec: *const fixpair_exec,
) -> fixpair_status_t {
    // SAFETY: the caller's promise.
    code(unsafe { copy(to, to_len, to_brick, from, from_len, from_brick, exec) })
}

unsafe fn copy<T: Real>(
    to: *mut T,
    to_len: usize,
    to_brick: *const fixpair_brick,
    from: *const T,
    from_len: usize,
    from_brick: *const fixpair_brick,
    exec: *const fixpair_exec,
) -> Result<()> {
    let mut border = Border::new();
    // SAFETY: the caller's promise.
    unsafe {
        let to = border.write(to, to_len)?;
        let to_brick = border.read_one(to_brick)?.check()?;
        let from = border.read(from, from_len)?;
        let from_brick = border.read_one(from_brick)?.check()?;
        modes::copy_modes(to, &to_brick, from, &from_brick, &HostExec::new(&mut border, exec)?)
    }
}

/// Scratch of fixpair_add_local_f64: 8 bytes for each index of the outermost axis of work->configuration, rounded up to 64.
///
/// Out: scratch
/// In:  work
/// Returns: 0, FIXPAIR_ERROR_NULL, or why the hook is refused
///
/// # Safety
/// Pointers are null or point to as many values as stated; the hooks keep their contracts.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_add_local_scratch_f64(
    scratch: *mut Layout,
    work: *const fixpair_fft_f64,
) -> fixpair_status_t {
    // SAFETY: the caller's promise.
    code(unsafe { local_scratch(scratch, work) })
}

/// fixpair_add_local_scratch_f64 in single precision.
///
/// # Safety
/// Pointers are null or point to as many values as stated; the hooks keep their contracts.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_add_local_scratch_f32(
    scratch: *mut Layout,
    work: *const fixpair_fft_f32,
) -> fixpair_status_t {
    // SAFETY: the caller's promise.
    code(unsafe { local_scratch(scratch, work) })
}

unsafe fn local_scratch<H: Hook>(scratch: *mut Layout, work: *const H) -> Result<()> {
    let mut border = Border::new();
    // SAFETY: the caller's promise.
    unsafe {
        let scratch = border.write_one(scratch)?;
        *scratch = add_local_scratch(&HostFft::new(&mut border, work)?)?;
        Ok(())
    }
}

/// Local primordial non-Gaussianity, in place: Phi_G -> Phi_G + f_nl (Phi_G^2 - <Phi_G^2>) + g_nl (Phi_G^3 - 3 <Phi_G^2> Phi_G).
///
/// Apply it to the modes of Phi, after fixing and inverting and before alpha. The mean stays zero, modes with a mode number n/2 receive
/// nothing, and f_nl = g_nl = 0 changes no bit.
///
/// In/Out: modes    len reals: Phi_G, then Phi
/// In:     brick    of Fourier space, side n
///         f_nl, g_nl
///         work     transform on which products are taken: of side n (they alias), or of side 3n/2 or more (2n with g_nl: exact)
///         mesh     mesh_len >= work->length reals, overwritten
///         scratch  scratch_len bytes, see fixpair_add_local_scratch_f64
///         exec     or NULL
/// Returns: 0, FIXPAIR_ERROR_NULL, _LENGTH, _ALIGNMENT, _OVERLAP, _NOT_FINITE, _SCRATCH, _BRICK for a side of work other than n and below
///          3n/2 (with g_nl 2n), or why the brick or the hook is refused;
///          after FIXPAIR_ERROR_HOOK modes are undefined
///
/// # Safety
/// Pointers are null or point to as many values as stated; the hooks keep their contracts.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_add_local_f64(
    modes: *mut f64,
    len: usize,
    brick: *const fixpair_brick,
    f_nl: f64,
    g_nl: f64,
    work: *const fixpair_fft_f64,
    mesh: *mut f64,
    mesh_len: usize,
    scratch: *mut c_void,
    scratch_len: usize,
    exec: *const fixpair_exec,
) -> fixpair_status_t {
    // SAFETY: the caller's promise.
    code(unsafe { local(modes, len, brick, f_nl, g_nl, work, mesh, mesh_len, scratch, scratch_len, exec) })
}

/// fixpair_add_local_f64 in single precision.
///
/// # Safety
/// Pointers are null or point to as many values as stated; the hooks keep their contracts.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_add_local_f32(
    modes: *mut f32,
    len: usize,
    brick: *const fixpair_brick,
    f_nl: f64,
    g_nl: f64,
    work: *const fixpair_fft_f32,
    mesh: *mut f32,
    mesh_len: usize,
    scratch: *mut c_void,
    scratch_len: usize,
    exec: *const fixpair_exec,
) -> fixpair_status_t {
    // SAFETY: the caller's promise.
    code(unsafe { local(modes, len, brick, f_nl, g_nl, work, mesh, mesh_len, scratch, scratch_len, exec) })
}

unsafe fn local<H: Hook>(
    modes: *mut H::Real,
    len: usize,
    brick: *const fixpair_brick,
    f_nl: f64,
    g_nl: f64,
    work: *const H,
    mesh: *mut H::Real,
    mesh_len: usize,
    scratch: *mut c_void,
    scratch_len: usize,
    exec: *const fixpair_exec,
) -> Result<()> {
    let mut border = Border::new();
    // SAFETY: the caller's promise.
    unsafe {
        let modes = border.write(modes, len)?;
        let brick = border.read_one(brick)?.check()?;
        let mut work = HostFft::new(&mut border, work)?;
        let mesh = border.write(mesh, mesh_len)?;
        let layout = add_local_scratch(&work)?;
        let mut arena = Arena::new(border.scratch(scratch, scratch_len)?, layout)?;
        let partial = arena.take::<[f64; 1]>(layout.size / size_of::<f64>())?;
        let local = Local { f_nl, g_nl };
        add_local(modes, &brick, local, &mut work, mesh, partial, &HostExec::new(&mut border, exec)?)
    }
}

/// The source of second-order displacements, S = sum over a < b of phi_aa phi_bb - phi_ab^2, where phi_ab has modes k_a k_b/k^2 delta_k.
///
/// Out: source   source_len reals: modes of S
/// In:  density  density_len reals: modes of the linear density
///      brick    of Fourier space, where both lie
///      work     transform on which products are taken: of the side of the brick (they alias), or 3/2 of it or more (exact)
///      mesh1, mesh2, mesh3  mesh_len >= work->length reals each, overwritten
///      exec     or NULL
/// Returns: 0, FIXPAIR_ERROR_NULL, _LENGTH, _ALIGNMENT, _OVERLAP, _BRICK for a side of work other than that of the brick and below 3/2
///          of it, or why the brick or the hook is refused; after FIXPAIR_ERROR_HOOK source is undefined
/// Cost: 7 transforms of work
///
/// # Safety
/// Pointers are null or point to as many values as stated; the hooks keep their contracts.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_second_order_source_f64(
    source: *mut f64,
    source_len: usize,
    density: *const f64,
    density_len: usize,
    brick: *const fixpair_brick,
    work: *const fixpair_fft_f64,
    mesh1: *mut f64,
    mesh2: *mut f64,
    mesh3: *mut f64,
    mesh_len: usize,
    exec: *const fixpair_exec,
) -> fixpair_status_t {
    // SAFETY: the caller's promise.
    code(unsafe {
        source_modes(
            source,
            source_len,
            density,
            density_len,
            brick,
            work,
            mesh1,
            mesh2,
            mesh3,
            mesh_len,
            exec,
        )
    })
}

/// fixpair_second_order_source_f64 in single precision.
///
/// # Safety
/// Pointers are null or point to as many values as stated; the hooks keep their contracts.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_second_order_source_f32(
    source: *mut f32,
    source_len: usize,
    density: *const f32,
    density_len: usize,
    brick: *const fixpair_brick,
    work: *const fixpair_fft_f32,
    mesh1: *mut f32,
    mesh2: *mut f32,
    mesh3: *mut f32,
    mesh_len: usize,
    exec: *const fixpair_exec,
) -> fixpair_status_t {
    // SAFETY: the caller's promise.
    code(unsafe {
        source_modes(
            source,
            source_len,
            density,
            density_len,
            brick,
            work,
            mesh1,
            mesh2,
            mesh3,
            mesh_len,
            exec,
        )
    })
}

unsafe fn source_modes<H: Hook>(
    source: *mut H::Real,
    source_len: usize,
    density: *const H::Real,
    density_len: usize,
    brick: *const fixpair_brick,
    work: *const H,
    mesh1: *mut H::Real,
    mesh2: *mut H::Real,
    mesh3: *mut H::Real,
    mesh_len: usize,
    exec: *const fixpair_exec,
) -> Result<()> {
    let mut border = Border::new();
    // SAFETY: the caller's promise.
    unsafe {
        let source = border.write(source, source_len)?;
        let density = border.read(density, density_len)?;
        let brick = border.read_one(brick)?.check()?;
        let mut work = HostFft::new(&mut border, work)?;
        let meshes =
            [border.write(mesh1, mesh_len)?, border.write(mesh2, mesh_len)?, border.write(mesh3, mesh_len)?];
        let exec = HostExec::new(&mut border, exec)?;
        lpt::second_order_source(source, density, &brick, &mut work, meshes, &exec)
    }
}

/// One component of a displacement: modes scale i n_a/|n|^2 source_k, n = k L/(2 pi), brought to the cells. The linear density with scale
/// L/(2 pi) gives Psi1; S with scale -(D2/D^2) L/(2 pi) gives Psi2; in the unit of L.
///
/// Out: psi     psi_len = fft->length reals: one component on the cells of fft->configuration
/// In:  source  source_len reals: modes
///      brick   of Fourier space, where the source lies; its side is that of fft or more
///      axis    0, 1, 2
///      scale
///      fft     the transform
///      exec    or NULL
/// Returns: 0, FIXPAIR_ERROR_NULL, _LENGTH, _ALIGNMENT, _OVERLAP, _RANGE for an axis above 2, _NOT_FINITE, _BRICK for a side of
///          fft above that of the brick, or why the brick or the hook is refused; after FIXPAIR_ERROR_HOOK psi is undefined
/// Cost: 1 transform
///
/// # Safety
/// Pointers are null or point to as many values as stated; the hooks keep their contracts.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_displacement_f64(
    psi: *mut f64,
    psi_len: usize,
    source: *const f64,
    source_len: usize,
    brick: *const fixpair_brick,
    axis: usize,
    scale: f64,
    fft: *const fixpair_fft_f64,
    exec: *const fixpair_exec,
) -> fixpair_status_t {
    // SAFETY: the caller's promise.
    code(unsafe { psi_component(psi, psi_len, source, source_len, brick, axis, scale, fft, exec) })
}

/// fixpair_displacement_f64 in single precision.
///
/// # Safety
/// Pointers are null or point to as many values as stated; the hooks keep their contracts.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_displacement_f32(
    psi: *mut f32,
    psi_len: usize,
    source: *const f32,
    source_len: usize,
    brick: *const fixpair_brick,
    axis: usize,
    scale: f64,
    fft: *const fixpair_fft_f32,
    exec: *const fixpair_exec,
) -> fixpair_status_t {
    // SAFETY: the caller's promise.
    code(unsafe { psi_component(psi, psi_len, source, source_len, brick, axis, scale, fft, exec) })
}

unsafe fn psi_component<H: Hook>(
    psi: *mut H::Real,
    psi_len: usize,
    source: *const H::Real,
    source_len: usize,
    brick: *const fixpair_brick,
    axis: usize,
    scale: f64,
    fft: *const H,
    exec: *const fixpair_exec,
) -> Result<()> {
    let mut border = Border::new();
    // SAFETY: the caller's promise.
    unsafe {
        let psi = border.write(psi, psi_len)?;
        let source = border.read(source, source_len)?;
        let brick = border.read_one(brick)?.check()?;
        let mut fft = HostFft::new(&mut border, fft)?;
        let exec = HostExec::new(&mut border, exec)?;
        lpt::displacement(psi, source, &brick, axis, scale, &mut fft, &exec)
    }
}
