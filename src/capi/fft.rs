//! The transform hook.

use core::ffi::c_void;

use super::border::Border;
use super::mesh::fixpair_brick;
use super::status::{code, fixpair_status_t};
use crate::fft::{Fft3, self_test};
use crate::mesh::{Brick, Space};
use crate::real::Real;
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
///
/// Functions refuse with FIXPAIR_ERROR_VERSION another struct_size, with FIXPAIR_ERROR_NULL a missing forward or inverse, with FIXPAIR_ERROR_BRICK bricks of
/// the wrong space or of two meshes, with FIXPAIR_ERROR_LENGTH a length that is too short, and a brick as fixpair_brick says. That is what "why the hook is
/// refused" means below.
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
    /// Replaces each of count values by its sum over all processes that share the mesh. NULL where one process holds it all. Asked
    /// for by g_nl alone, which on a part of a mesh is FIXPAIR_ERROR_HOOK without it.
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
    /// Replaces each of count values by its sum over all processes that share the mesh. NULL where one process holds it all. Asked
    /// for by g_nl alone, which on a part of a mesh is FIXPAIR_ERROR_HOOK without it.
    pub sum: Option<unsafe extern "C" fn(context: *mut c_void, values: *mut f64, count: usize) -> i32>,
    /// Where the cells lie.
    pub configuration: fixpair_brick,
    /// Where the modes lie in the same array.
    pub fourier: fixpair_brick,
    /// Reals in the array that is transformed: at least what either brick needs.
    pub length: usize,
}

pub(super) type Pass<T> = unsafe extern "C" fn(*mut c_void, *mut T) -> i32;

/// The two hook structs, as one.
pub(super) trait Hook: Copy {
    type Real: Real;

    /// Its members.
    fn parts(&self) -> Parts<Self::Real>;

    /// The other way.
    fn from_parts(parts: Parts<Self::Real>) -> Self;
}

pub(super) struct Parts<T> {
    pub(super) struct_size: usize,
    pub(super) context: *mut c_void,
    pub(super) forward: Option<Pass<T>>,
    pub(super) inverse: Option<Pass<T>>,
    pub(super) sum: Option<unsafe extern "C" fn(*mut c_void, *mut f64, usize) -> i32>,
    pub(super) configuration: fixpair_brick,
    pub(super) fourier: fixpair_brick,
    pub(super) length: usize,
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
            Some(_) if values.is_empty() => Ok(()),
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

unsafe fn tried<H: Hook>(fft: *const H, data: *mut H::Real, len: usize) -> Result<()> {
    let mut border = Border::new();
    // SAFETY: the caller's promise.
    unsafe {
        let data = border.write(data, len)?;
        self_test(&mut HostFft::new(&mut border, fft)?, data)
    }
}
