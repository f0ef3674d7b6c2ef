//! The built-in transform as a hook.

use core::ffi::c_void;

use super::border::Border;
use super::exec::{HostExec, fixpair_exec};
use super::fft::{Hook, Parts, fixpair_fft_f32, fixpair_fft_f64};
use super::status::{code, fixpair_status_t};
use crate::fft::{Fft3, Tables, Transform, next_side, recommended_padding};
use crate::mesh::{Brick, Space};
use crate::real::Real;
use crate::scratch::Layout;
use crate::status::{Error, Result};

/// Padding of planes, in modes, with which the built-in transform is fastest: 0 unless planes would begin a multiple of 1 KiB apart.
#[unsafe(no_mangle)]
pub extern "C" fn fixpair_fft_padding_f64(n: usize) -> usize {
    recommended_padding::<f64>(n)
}

/// fixpair_fft_padding_f64 for single precision.
#[unsafe(no_mangle)]
pub extern "C" fn fixpair_fft_padding_f32(n: usize) -> usize {
    recommended_padding::<f32>(n)
}

/// The smallest side that the built-in transform takes (even, factors 2, 3, 5, 7) and that is not below `least`; 0 if there is none.
/// For products without aliasing: next_side(3 n/2), or next_side(2 n) with g_nl.
#[unsafe(no_mangle)]
pub extern "C" fn fixpair_fft_next_side(least: usize) -> usize {
    next_side(least).unwrap_or(0)
}

/// Memory for the tables of the built-in transform of side n: about 3 n numbers.
///
/// Out: size
/// In:  n  even, with no prime factor but 2, 3, 5, 7
/// Returns: 0, FIXPAIR_ERROR_NULL, FIXPAIR_ERROR_MESH_SIZE, FIXPAIR_ERROR_OVERFLOW
///
/// # Safety
/// Pointers are null or point to as many values as stated; hooks keep their contracts.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_fft_tables_scratch_f64(size: *mut Layout, n: usize) -> fixpair_status_t {
    // SAFETY: the caller's promise.
    code(unsafe { put_layout(size, || Tables::<f64>::layout(n)) })
}

/// fixpair_fft_tables_scratch_f64 for single precision.
///
/// # Safety
/// Pointers are null or point to as many values as stated; hooks keep their contracts.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_fft_tables_scratch_f32(size: *mut Layout, n: usize) -> fixpair_status_t {
    // SAFETY: the caller's promise.
    code(unsafe { put_layout(size, || Tables::<f32>::layout(n)) })
}

/// Builds the tables of side n. They never change afterwards: any number of transforms and threads may share them.
///
/// Out: tables  tables_len bytes, see fixpair_fft_tables_scratch_f64
/// In:  n
/// Returns: 0, FIXPAIR_ERROR_NULL, _MESH_SIZE, _OVERFLOW, _SCRATCH, _ALIGNMENT
///
/// # Safety
/// Pointers are null or point to as many values as stated; hooks keep their contracts.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_fft_tables_init_f64(
    tables: *mut c_void,
    tables_len: usize,
    n: usize,
) -> fixpair_status_t {
    // SAFETY: the caller's promise.
    code(unsafe { build_tables::<f64>(tables, tables_len, n) })
}

/// fixpair_fft_tables_init_f64 for single precision.
///
/// # Safety
/// Pointers are null or point to as many values as stated; hooks keep their contracts.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_fft_tables_init_f32(
    tables: *mut c_void,
    tables_len: usize,
    n: usize,
) -> fixpair_status_t {
    // SAFETY: the caller's promise.
    code(unsafe { build_tables::<f32>(tables, tables_len, n) })
}

/// Work space of one built-in transform of side n: 4096 (n + 2) bytes and 256 more.
///
/// Out: size
/// In:  n
/// Returns: as fixpair_fft_tables_scratch_f64
///
/// # Safety
/// Pointers are null or point to as many values as stated; hooks keep their contracts.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_fft_scratch_f64(size: *mut Layout, n: usize) -> fixpair_status_t {
    // SAFETY: the caller's promise.
    code(unsafe { put_layout(size, || workspace_layout::<f64>(n)) })
}

/// fixpair_fft_scratch_f64 for single precision.
///
/// # Safety
/// Pointers are null or point to as many values as stated; hooks keep their contracts.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_fft_scratch_f32(size: *mut Layout, n: usize) -> fixpair_status_t {
    // SAFETY: the caller's promise.
    code(unsafe { put_layout(size, || workspace_layout::<f32>(n)) })
}

/// Makes a hook of the built-in transform for the whole mesh. The bits of its results depend on the data, n and the instructions of
/// the processor alone.
///
/// Out: fft          ready to use, as long as tables, scratch and exec's context live. One call at a time may run on it; for
///                   more, make more from the same tables
/// In:  tables       tables_len bytes, from fixpair_fft_tables_init_f64
///      padding      modes after each plane, as fixpair_brick_whole: 0, or fixpair_fft_padding_f64(n)
///      scratch      scratch_len bytes, see fixpair_fft_scratch_f64; belongs to the hook from now on
///      exec         whom it runs on; copied; or NULL
/// Returns: 0, FIXPAIR_ERROR_NULL, _ALIGNMENT, _OVERLAP, _SCRATCH, _OVERFLOW; FIXPAIR_ERROR_VERSION if `tables` holds no tables of this
///          precision
///
/// # Safety
/// Pointers are null or point to as many values as stated; hooks keep their contracts.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_fft_init_f64(
    fft: *mut fixpair_fft_f64,
    tables: *const c_void,
    tables_len: usize,
    padding: usize,
    scratch: *mut c_void,
    scratch_len: usize,
    exec: *const fixpair_exec,
) -> fixpair_status_t {
    // SAFETY: the caller's promise.
    code(unsafe { init::<fixpair_fft_f64>(fft, tables, tables_len, padding, scratch, scratch_len, exec) })
}

/// fixpair_fft_init_f64 for single precision.
///
/// # Safety
/// Pointers are null or point to as many values as stated; hooks keep their contracts.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_fft_init_f32(
    fft: *mut fixpair_fft_f32,
    tables: *const c_void,
    tables_len: usize,
    padding: usize,
    scratch: *mut c_void,
    scratch_len: usize,
    exec: *const fixpair_exec,
) -> fixpair_status_t {
    // SAFETY: the caller's promise.
    code(unsafe { init::<fixpair_fft_f32>(fft, tables, tables_len, padding, scratch, scratch_len, exec) })
}

/// # Safety
/// `size` is null or points to a layout.
unsafe fn put_layout(size: *mut Layout, layout: impl FnOnce() -> Result<Layout>) -> Result<()> {
    // SAFETY: the caller's promise.
    *unsafe { Border::new().write_one(size) }? = layout()?;
    Ok(())
}

unsafe fn build_tables<T: Real>(tables: *mut c_void, tables_len: usize, n: usize) -> Result<()> {
    Tables::<T>::layout(n)?;
    // SAFETY: the caller's promise.
    let memory = unsafe { Border::new().scratch(tables, tables_len) }?;
    Tables::<T>::new(n, memory).map(|_| ())
}

/// What a built-in hook's context points to: the start of its work space.
#[repr(C, align(64))]
struct BuiltIn {
    tables: *const u8,
    tables_len: usize,
    exec: fixpair_exec,
    configuration: Brick,
    workspace: *mut u8,
    workspace_len: usize,
}

/// Bytes set aside for it at the start of the work space, on every platform: a part of the documented size.
const HEAD: usize = 256;
const _: () = assert!(size_of::<BuiltIn>() <= HEAD);

fn workspace_layout<T: Real>(n: usize) -> Result<Layout> {
    let workspace = Transform::<T>::workspace(n)?;
    Layout::EMPTY.and::<u8>(HEAD)?.and::<u8>(workspace.size)
}

unsafe fn init<H: Hook>(
    fft: *mut H,
    tables: *const c_void,
    tables_len: usize,
    padding: usize,
    scratch: *mut c_void,
    scratch_len: usize,
    exec: *const fixpair_exec,
) -> Result<()> {
    let mut border = Border::new();
    // SAFETY: the caller's promise.
    unsafe {
        let fft = border.write_one(fft)?;
        let tables = border.read(tables.cast::<u8>(), tables_len)?;
        let n = Tables::<H::Real>::view(tables)?.n();
        let scratch = border.scratch(scratch, scratch_len)?;
        if scratch.len() < workspace_layout::<H::Real>(n)?.size {
            return Err(Error::Scratch);
        }
        let exec = match HostExec::new(&mut border, exec)? {
            HostExec::Serial => fixpair_exec { context: core::ptr::null_mut(), parallel_for: None },
            HostExec::Hook(hook) => hook,
        };
        let configuration = Brick::whole_padded(n, Space::Configuration, padding)?;
        let fourier = Brick::whole_padded(n, Space::Fourier, padding)?;
        let start = scratch.as_mut_ptr();
        let built_in = BuiltIn {
            tables: tables.as_ptr(),
            tables_len,
            exec,
            configuration,
            workspace: start.add(HEAD),
            workspace_len: scratch.len() - HEAD,
        };
        start.cast::<BuiltIn>().write(built_in);
        let parts = Parts {
            struct_size: size_of::<H>(),
            context: start.cast(),
            forward: Some(built_in_forward::<H::Real>),
            inverse: Some(built_in_inverse::<H::Real>),
            sum: None,
            configuration: configuration.into(),
            fourier: fourier.into(),
            length: n * configuration.stride()[0],
        };
        *fft = H::from_parts(parts);
        Ok(())
    }
}

unsafe extern "C" fn built_in_forward<T: Real>(context: *mut c_void, data: *mut T) -> i32 {
    // SAFETY: a hook is called with its own context and data.
    unsafe { run(context, data, |transform, data| transform.forward(data)) }
}

unsafe extern "C" fn built_in_inverse<T: Real>(context: *mut c_void, data: *mut T) -> i32 {
    // SAFETY: a hook is called with its own context and data.
    unsafe { run(context, data, |transform, data| transform.inverse(data)) }
}

unsafe fn run<T: Real>(
    context: *mut c_void,
    data: *mut T,
    pass: impl FnOnce(&mut Transform<'_, T>, &mut [T]) -> Result<()>,
) -> i32 {
    let attempt = || {
        if context.is_null() || data.is_null() {
            return Err(Error::Null);
        }
        // SAFETY: `init` wrote a `BuiltIn` there, and its caller keeps tables, work space and executor alive.
        let (built_in, tables, workspace) = unsafe {
            let built_in = &*context.cast::<BuiltIn>();
            let tables = core::slice::from_raw_parts(built_in.tables, built_in.tables_len);
            let workspace = core::slice::from_raw_parts_mut(built_in.workspace, built_in.workspace_len);
            (built_in, Tables::view(tables)?, workspace)
        };
        let exec = match built_in.exec.parallel_for {
            None => HostExec::Serial,
            Some(_) => HostExec::Hook(built_in.exec),
        };
        let mut transform = Transform::new(&tables, built_in.configuration, workspace, &exec)?;
        // SAFETY: the hook's contract: `length` reals from `data` on.
        let data = unsafe { core::slice::from_raw_parts_mut(data, transform.length()) };
        pass(&mut transform, data)
    };
    attempt().map_or_else(Error::code, |()| 0)
}
