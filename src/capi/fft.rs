//! The transform hook, and the built-in transform that fills it.

use core::ffi::c_void;

use super::border::Border;
use super::exec::{HostExec, fixpair_exec};
use super::mesh::fixpair_brick;
use super::status::{code, fixpair_status_t};
use crate::fft::{Fft3, Tables, Transform, next_side, recommended_padding, self_test};
use crate::mesh::{Brick, Space};
use crate::real::Real;
use crate::scratch::Layout;
use crate::status::{Error, Result};

/// A three-dimensional real transform in double precision: the host's, or the built-in one after fixpair_fft_init_f64.
///
/// forward replaces, in place, the reals f(x) of the configuration brick by the modes F(k) = sum_x f(x) exp(-i k.x) of the fourier
/// brick; inverse replaces modes by f(x) = sum_k F(k) exp(+i k.x) over both members of each Hermitian pair. Neither divides by
/// n^3: the library does. That is FFTW's r2c and c2r, in place, as they are. Both return 0, or anything else to give up,
/// which makes the kernel return FIXPAIR_ERROR_HOOK. fixpair_fft_self_test_f64 tries a hook.
///
/// Kernels call it from the thread that they were called from, once at a time, on arrays that lie in their scratch, aligned to 64 bytes,
/// or that the host passed, aligned as the host has them: plans for another array than their own need that.
///
/// Fill it by hand: zeros, then struct_size, the functions, the bricks (fixpair_brick_whole with padding 0 is FFTW's layout in one
/// process) and the length (the larger of fixpair_brick_reals of both).
#[repr(C)]
#[derive(Clone, Copy)]
pub struct fixpair_fft_f64 {
    /// sizeof(fixpair_fft_f64).
    pub struct_size: usize,
    /// Handed to the functions as it is.
    pub context: *mut c_void,
    /// Cells to modes, un-normalised.
    pub forward: Option<unsafe extern "C" fn(context: *mut c_void, data: *mut f64) -> i32>,
    /// Modes to cells, un-normalised.
    pub inverse: Option<unsafe extern "C" fn(context: *mut c_void, data: *mut f64) -> i32>,
    /// Replaces each of count values by its sum over all processes that share the mesh. NULL where one process holds it all.
    pub sum: Option<unsafe extern "C" fn(context: *mut c_void, values: *mut f64, count: usize) -> i32>,
    /// Where the cells lie.
    pub configuration: fixpair_brick,
    /// Where the modes lie in the same array.
    pub fourier: fixpair_brick,
    /// Reals in the array that is transformed: at least what either brick needs.
    pub length: usize,
}

/// A three-dimensional real transform in single precision; see fixpair_fft_f64.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct fixpair_fft_f32 {
    /// sizeof(fixpair_fft_f32).
    pub struct_size: usize,
    /// Handed to the functions as it is.
    pub context: *mut c_void,
    /// Cells to modes, un-normalised.
    pub forward: Option<unsafe extern "C" fn(context: *mut c_void, data: *mut f32) -> i32>,
    /// Modes to cells, un-normalised.
    pub inverse: Option<unsafe extern "C" fn(context: *mut c_void, data: *mut f32) -> i32>,
    /// Replaces each of count values by its sum over all processes that share the mesh. NULL where one process holds it all.
    pub sum: Option<unsafe extern "C" fn(context: *mut c_void, values: *mut f64, count: usize) -> i32>,
    /// Where the cells lie.
    pub configuration: fixpair_brick,
    /// Where the modes lie in the same array.
    pub fourier: fixpair_brick,
    /// Reals in the array that is transformed: at least what either brick needs.
    pub length: usize,
}

type Pass<T> = unsafe extern "C" fn(*mut c_void, *mut T) -> i32;

/// The two hook structs, as one.
pub(super) trait Hook: Copy {
    type Real: Real;

    /// Its members.
    fn parts(&self) -> Parts<Self::Real>;

    /// The other way.
    fn from_parts(parts: Parts<Self::Real>) -> Self;
}

pub(super) struct Parts<T> {
    struct_size: usize,
    context: *mut c_void,
    forward: Option<Pass<T>>,
    inverse: Option<Pass<T>>,
    sum: Option<unsafe extern "C" fn(*mut c_void, *mut f64, usize) -> i32>,
    configuration: fixpair_brick,
    fourier: fixpair_brick,
    length: usize,
}

macro_rules! hook {
    ($hook:ty, $real:ty) => {
        impl Hook for $hook {
            type Real = $real;

            fn parts(&self) -> Parts<$real> {
                let Self { struct_size, context, forward, inverse, sum, configuration, fourier, length } =
                    *self;
                Parts { struct_size, context, forward, inverse, sum, configuration, fourier, length }
            }

            fn from_parts(parts: Parts<$real>) -> Self {
                let Parts { struct_size, context, forward, inverse, sum, configuration, fourier, length } =
                    parts;
                Self { struct_size, context, forward, inverse, sum, configuration, fourier, length }
            }
        }
    };
}
hook!(fixpair_fft_f32, f32);
hook!(fixpair_fft_f64, f64);

/// A hook from C, checked.
pub(super) struct HostFft<T> {
    context: *mut c_void,
    forward: Pass<T>,
    inverse: Pass<T>,
    sum: Option<unsafe extern "C" fn(*mut c_void, *mut f64, usize) -> i32>,
    configuration: Brick,
    fourier: Brick,
    length: usize,
}

impl<T: Real> HostFft<T> {
    /// # Safety
    /// `hook` is null or points to a hook that keeps its contract.
    pub(super) unsafe fn new<H: Hook<Real = T>>(border: &mut Border, hook: *const H) -> Result<Self> {
        // SAFETY: the caller's promise.
        let parts = unsafe { border.read_one(hook) }?.parts();
        if parts.struct_size != size_of::<H>() {
            return Err(Error::Version);
        }
        let (Some(forward), Some(inverse)) = (parts.forward, parts.inverse) else { return Err(Error::Null) };
        let (configuration, fourier) = (parts.configuration.check()?, parts.fourier.check()?);
        configuration.check_space(Space::Configuration)?;
        fourier.check_space(Space::Fourier)?;
        if configuration.n() != fourier.n() {
            return Err(Error::Brick);
        }
        if parts.length < configuration.reals().max(fourier.reals()) {
            return Err(Error::Length);
        }
        let Parts { context, sum, length, .. } = parts;
        Ok(Self { context, forward, inverse, sum, configuration, fourier, length })
    }

    fn call(&self, pass: Pass<T>, data: &mut [T]) -> Result<()> {
        if data.len() < self.length {
            return Err(Error::Length);
        }
        // SAFETY: the hook's contract: it touches `length` reals from here on.
        let status = unsafe { pass(self.context, data.as_mut_ptr()) };
        if status == 0 { Ok(()) } else { Err(Error::Hook) }
    }
}

impl<T: Real> Fft3<T> for HostFft<T> {
    fn configuration(&self) -> &Brick {
        &self.configuration
    }

    fn fourier(&self) -> &Brick {
        &self.fourier
    }

    fn length(&self) -> usize {
        self.length
    }

    fn forward(&mut self, data: &mut [T]) -> Result<()> {
        self.call(self.forward, data)
    }

    fn inverse(&mut self, data: &mut [T]) -> Result<()> {
        self.call(self.inverse, data)
    }

    fn all_sum(&mut self, values: &mut [f64]) -> Result<()> {
        match self.sum {
            // SAFETY: the hook's contract: it touches `count` values.
            Some(sum) => match unsafe { sum(self.context, values.as_mut_ptr(), values.len()) } {
                0 => Ok(()),
                _ => Err(Error::Hook),
            },
            None if self.configuration.is_whole() => Ok(()),
            None => Err(Error::Hook),
        }
    }
}

/// Padding of planes, in modes, with which the built-in transform is fastest: 0 unless planes would begin a multiple of 4 KiB apart.
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

/// Tries a hook: sign, normalisation, order of the axes, half space and both directions, with plane waves whose transform is known. On
/// several processes all call it together, each with its bricks.
///
/// In: fft   the hook to try
///     data  len = fft->length reals, overwritten
/// Returns: 0, FIXPAIR_ERROR_HOOK if the hook fails or breaks its contract, FIXPAIR_ERROR_NULL, _VERSION, _LENGTH, or why a brick is
///          refused
/// Cost: a few transforms
///
/// # Safety
/// Pointers are null or point to as many values as stated; hooks keep their contracts.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_fft_self_test_f64(
    fft: *const fixpair_fft_f64,
    data: *mut f64,
    len: usize,
) -> fixpair_status_t {
    // SAFETY: the caller's promise.
    code(unsafe { tried(fft, data, len) })
}

/// fixpair_fft_self_test_f64 for single precision.
///
/// # Safety
/// Pointers are null or point to as many values as stated; hooks keep their contracts.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_fft_self_test_f32(
    fft: *const fixpair_fft_f32,
    data: *mut f32,
    len: usize,
) -> fixpair_status_t {
    // SAFETY: the caller's promise.
    code(unsafe { tried(fft, data, len) })
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

unsafe fn tried<H: Hook>(fft: *const H, data: *mut H::Real, len: usize) -> Result<()> {
    let mut border = Border::new();
    // SAFETY: the caller's promise.
    unsafe {
        let data = border.write(data, len)?;
        self_test(&mut HostFft::new(&mut border, fft)?, data)
    }
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
        let exec = match HostExec::new(exec)? {
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
