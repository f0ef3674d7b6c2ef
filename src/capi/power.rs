//! Power spectrum.

use core::ffi::c_void;

use super::binning::{binning, fixpair_binning};
use super::border::Border;
use super::exec::{HostExec, fixpair_exec};
use super::mesh::fixpair_brick;
use super::status::{code, fixpair_status_t};
use crate::estimate::binning::Bin;
use crate::estimate::compensation::{Compensation, compensate, compensate_scratch};
use crate::estimate::power::{power_sums, power_sums_scratch, shot_noise_of, subtract_shot_noise};
use crate::pm::Window;
use crate::real::Real;
use crate::scratch::Layout;
use crate::status::{Error, Result};
use crate::within::Within;

/// Modes are taken as they are.
pub const FIXPAIR_COMPENSATION_NONE: i32 = 0;
/// Plus FIXPAIR_WINDOW_...: modes are divided by the window, sinc^p an axis. For interlaced meshes, and for the signal at low k.
pub const FIXPAIR_COMPENSATION_WINDOW: i32 = 16;
/// Plus FIXPAIR_WINDOW_...: modes are divided by the root of the window's aliased power (Jing 2005's C1), so that shot noise is flat. For meshes that are
/// not interlaced.
pub const FIXPAIR_COMPENSATION_ALIASED: i32 = 32;

/// Fields in one call.
const FIELDS: usize = 8;

pub(super) fn compensation(value: i32) -> Result<Compensation> {
    match value & !15 {
        FIXPAIR_COMPENSATION_NONE if value == 0 => Ok(Compensation::None),
        FIXPAIR_COMPENSATION_WINDOW => Window::try_from(value & 15).map(Compensation::Window),
        FIXPAIR_COMPENSATION_ALIASED => Window::try_from(value & 15).map(Compensation::Aliased),
        _ => Err(Error::Choice),
    }
}

/// Several arrays of `len` reals.
///
/// # Safety
/// `fields` is null or points to `count` pointers that are null or point to `len` reals.
pub(super) unsafe fn fields<'a, T>(
    border: &mut Border,
    fields: *const *const T,
    count: usize,
    len: usize,
) -> Result<([&'a [T]; FIELDS], usize)> {
    if count > FIELDS {
        return Err(Error::Length);
    }
    // SAFETY: the caller's promise.
    let pointers = unsafe { border.read(fields, count) }?;
    let mut out: [&[T]; FIELDS] = [&[]; FIELDS];
    for (out, pointer) in out.iter_mut().zip(pointers) {
        // SAFETY: the caller's promise.
        *out = unsafe { border.read(*pointer, len) }?;
    }
    Ok((out, count))
}

/// Scratch of fixpair_power_sums_*, in bytes. For each of w pieces of the work: 8 words, words from fixpair_binning_lengths; 128 for each bin, pair and
/// parity (even, odd) that orders has; and 192 for each l of the brick; and at most 512. Besides: 4 for each |n|^2 below the last edge (at most
/// 3 (n/2)^2 + 1 of them); 4 for each of the 2 (n/2)^2 + 1 values of i^2 + j^2, unless the brick has less than a row for each 16 of them, or a second
/// coordinate a line of sight other than z; 24 for each l; for each pair 8 for each l and 4 n; 8 for each second edge; and a few cache lines. w is
/// at most 64, and at most as many as have 64 MiB of words together, or 2; for the whole mesh it is at most n/2 + 1.
///
/// Out: scratch
/// In:  brick      of Fourier space
///      binning
///      pairs_len  pairs of fields
/// Returns: 0, FIXPAIR_ERROR_NULL, _ALIGNMENT, _OVERLAP, FIXPAIR_ERROR_LENGTH for no pairs, FIXPAIR_ERROR_OVERFLOW, also for bins of so many modes (10^13 and
///          more) that no integer need hold the sum of their |n|, or why brick or binning are refused
///
/// # Safety
/// Pointers are null or point to as many values as stated.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_power_sums_scratch(
    scratch: *mut Layout,
    brick: *const fixpair_brick,
    binning: *const fixpair_binning,
    pairs_len: usize,
) -> fixpair_status_t {
    code((|| {
        let mut border = Border::new();
        // SAFETY: the caller's promise.
        unsafe {
            let scratch = border.write_one(scratch)?;
            let brick = border.read_one(brick)?.check()?;
            *scratch = power_sums_scratch(&brick, &self::binning(&mut border, binning)?, pairs_len)?;
        }
        Ok(())
    })())
}

/// Adds f_k g_k* L_l(mu), summed over the modes of a brick bin by bin, to sums, for several pairs of fields in one sweep.
///
/// For modes with f(x) = sum_k f_k exp(+i k.x) and V = L^3, P_l(k) = (2l + 1) V <f_k g_k* L_l(k.a/|k|)>. The mean runs over k and -k, so that even multipoles
/// are real and odd ones imaginary: for odd l the sums hold Im f g* L_l, and P_l is i times the result; the dipole is positive where g is f moved
/// by a small step along the line of sight a. Nothing is normalised or subtracted here:
///
///    int64_t *sums = calloc(words, sizeof *sums);         see fixpair_binning_lengths
///    fixpair_power_sums_f64(sums, words, ...);            on each rank, then MPI_Allreduce(MPI_INT64_T, MPI_SUM)
///    fixpair_binning_read(bins, bins_len, P, P_len, sums, words, &binning, pairs_len);
///    fixpair_binning_normalise(P, P_len, bins, bins_len, binning.orders, L*L*L);    L*L*L/(W*W) for a deposit whose weights sum to W
///    fixpair_subtract_shot_noise(P, P_len, pairs, pairs_len, bins, bins_len, binning.orders, noise, fields_len);    if wanted
///
/// The bits do not depend on threads or on how the mesh is cut along x or y; bricks that cut axis 2 agree to rounding.
///
/// In/out: sums          sums_len integers, zeros at first
/// In:     fields        fields_len <= 8 pointers to modes on the brick, len reals each
///         pairs         2 pairs_len numbers of fields: {0, 0, 0, 1} for the spectrum of the first and its cross spectrum with the second
///         compensation  one for each field: FIXPAIR_COMPENSATION_ALIASED + FIXPAIR_WINDOW_CIC and so on; NULL for none
///         brick         of Fourier space
///         binning
///         scratch       scratch_len bytes, see fixpair_power_sums_scratch
///         exec          or NULL
/// Returns: 0, FIXPAIR_ERROR_NULL, _LENGTH, _ALIGNMENT, _OVERLAP, _SCRATCH, _HOOK, FIXPAIR_ERROR_RANGE for a pair of a field that there is not,
///          FIXPAIR_ERROR_CHOICE for a compensation, or why brick or binning are refused; nothing is then added. A NaN in a mesh shows in
///          fixpair_binning_read.
/// Cost: one pass over each field
///
/// # Safety
/// Pointers are null or point to as many values as stated.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_power_sums_f64(
    sums: *mut i64,
    sums_len: usize,
    fields: *const *const f64,
    fields_len: usize,
    len: usize,
    pairs: *const usize,
    pairs_len: usize,
    compensation: *const i32,
    brick: *const fixpair_brick,
    binning: *const fixpair_binning,
    scratch: *mut c_void,
    scratch_len: usize,
    exec: *const fixpair_exec,
) -> fixpair_status_t {
    // SAFETY: the caller's promise.
    code(unsafe {
        add(
            sums,
            sums_len,
            fields,
            fields_len,
            len,
            pairs,
            pairs_len,
            compensation,
            brick,
            binning,
            scratch,
            scratch_len,
            exec,
        )
    })
}

/// fixpair_power_sums_f64 for single precision; sums are the same exact ones.
///
/// # Safety
/// Pointers are null or point to as many values as stated.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_power_sums_f32(
    sums: *mut i64,
    sums_len: usize,
    fields: *const *const f32,
    fields_len: usize,
    len: usize,
    pairs: *const usize,
    pairs_len: usize,
    compensation: *const i32,
    brick: *const fixpair_brick,
    binning: *const fixpair_binning,
    scratch: *mut c_void,
    scratch_len: usize,
    exec: *const fixpair_exec,
) -> fixpair_status_t {
    // SAFETY: the caller's promise.
    code(unsafe {
        add(
            sums,
            sums_len,
            fields,
            fields_len,
            len,
            pairs,
            pairs_len,
            compensation,
            brick,
            binning,
            scratch,
            scratch_len,
            exec,
        )
    })
}

unsafe fn add<T: Real>(
    sums: *mut i64,
    sums_len: usize,
    fields: *const *const T,
    fields_len: usize,
    len: usize,
    pairs: *const usize,
    pairs_len: usize,
    compensation: *const i32,
    brick: *const fixpair_brick,
    binning: *const fixpair_binning,
    scratch: *mut c_void,
    scratch_len: usize,
    exec: *const fixpair_exec,
) -> Result<()> {
    let mut border = Border::new();
    // SAFETY: the caller's promise; a pair is two numbers.
    unsafe {
        let sums = border.write(sums, sums_len)?;
        let (fields, count) = self::fields(&mut border, fields, fields_len, len)?;
        let pairs = border.read(pairs.cast::<[usize; 2]>(), pairs_len)?;
        let mut chosen = [Compensation::None; FIELDS];
        for (chosen, value) in
            chosen.iter_mut().zip(border.read_optional(compensation, count)?.unwrap_or(&[]))
        {
            *chosen = self::compensation(*value)?;
        }
        let brick = border.read_one(brick)?.check()?;
        let binning = self::binning(&mut border, binning)?;
        let scratch = border.scratch(scratch, scratch_len)?;
        let exec = HostExec::new(&mut border, exec)?;
        power_sums(sums, fields.part(..count), pairs, chosen.part(..count), &brick, &binning, scratch, &exec)
    }
}

/// The shot noise of particles: V sum w^2/(sum w)^2, or V/N without weights, V = L^3.
///
/// Out: noise      in the unit of L^3
/// In:  weights    of particle i at weights[i * weights_stride]; NULL for equal weights, of which no stride is read
///      particles  how many
///      box_size   L
/// Returns: 0, FIXPAIR_ERROR_NULL, _ALIGNMENT, _OVERLAP, _OVERFLOW, _NOT_FINITE, FIXPAIR_ERROR_RANGE for a box that is not positive or whose volume
///          no number holds, no particles, weights that sum to 0, or weights with a stride of 0
///
/// # Safety
/// Pointers are null or point to as many values as stated.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_shot_noise_f64(
    noise: *mut f64,
    weights: *const f64,
    weights_stride: usize,
    particles: usize,
    box_size: f64,
) -> fixpair_status_t {
    // SAFETY: the caller's promise.
    code(unsafe { noise_of(noise, weights, weights_stride, particles, box_size) })
}

/// fixpair_shot_noise_f64 for weights in single precision.
///
/// # Safety
/// Pointers are null or point to as many values as stated.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_shot_noise_f32(
    noise: *mut f64,
    weights: *const f32,
    weights_stride: usize,
    particles: usize,
    box_size: f64,
) -> fixpair_status_t {
    // SAFETY: the caller's promise.
    code(unsafe { noise_of(noise, weights, weights_stride, particles, box_size) })
}

unsafe fn noise_of<T: Real>(
    noise: *mut f64,
    weights: *const T,
    weights_stride: usize,
    particles: usize,
    box_size: f64,
) -> Result<()> {
    let mut border = Border::new();
    // SAFETY: the caller's promise.
    let noise = unsafe { border.write_one(noise)? };
    let weighted = !weights.is_null();
    if weighted {
        if weights_stride == 0 {
            return Err(Error::Range);
        }
        border.read_strided(weights, weights_stride, particles)?;
    }
    // SAFETY: these lie in memory, aligned (checked at the border); the rest is the caller's promise.
    let weight = |i: usize| unsafe { *weights.add(i * weights_stride) }.to_f64();
    *noise = shot_noise_of(weighted.then(|| (0..particles).map(weight)), particles as u64, box_size)?;
    Ok(())
}

/// Subtracts shot noise from the monopoles of auto spectra. Cross spectra of different particles have none. Other multipoles stay as they are:
/// their noise (2l + 1) noise <L_l> vanishes where a bin holds many modes in all directions, not in wedges.
///
/// Flat noise is right for meshes compensated by FIXPAIR_COMPENSATION_ALIASED, and for interlaced ones compensated by FIXPAIR_COMPENSATION_WINDOW
/// well below the Nyquist frequency.
///
/// In/out: values  values_len numbers: the normalised spectra of all pairs
/// In:     pairs   2 pairs_len numbers of fields
///         bins    bins_len bins; empty ones stay 0
///         orders  as in the binning
///         noise   noise_len values: one for each field that a pair names, be it in cross spectra alone
/// Returns: 0, FIXPAIR_ERROR_NULL, _LENGTH, _ALIGNMENT, _OVERLAP, _NOT_FINITE, FIXPAIR_ERROR_RANGE for a pair of a field without noise or for orders
///
/// # Safety
/// Pointers are null or point to as many values as stated.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_subtract_shot_noise(
    values: *mut f64,
    values_len: usize,
    pairs: *const usize,
    pairs_len: usize,
    bins: *const Bin,
    bins_len: usize,
    orders: u32,
    noise: *const f64,
    noise_len: usize,
) -> fixpair_status_t {
    code((|| {
        let mut border = Border::new();
        // SAFETY: the caller's promise; a pair is two numbers.
        unsafe {
            let values = border.write(values, values_len)?;
            let pairs = border.read(pairs.cast::<[usize; 2]>(), pairs_len)?;
            let bins = border.read(bins, bins_len)?;
            subtract_shot_noise(values, pairs, bins, orders, border.read(noise, noise_len)?)
        }
    })())
}

/// Scratch of fixpair_compensate_*: n/2 + 1 doubles.
///
/// Out: scratch
/// In:  brick  of Fourier space
/// Returns: 0, FIXPAIR_ERROR_NULL, _ALIGNMENT, _OVERLAP, or why the brick is refused
///
/// # Safety
/// Pointers are null or point to one value.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_compensate_scratch(
    scratch: *mut Layout,
    brick: *const fixpair_brick,
) -> fixpair_status_t {
    code((|| {
        let mut border = Border::new();
        // SAFETY: the caller's promise.
        let (scratch, brick) = unsafe { (border.write_one(scratch)?, border.read_one(brick)?) };
        *scratch = compensate_scratch(&brick.check()?)?;
        Ok(())
    })())
}

/// f_k <- scale f_k, compensated: for functions that take modes as they are, as fixpair_bispectrum_* and fixpair_shell_modes_* do.
///
/// fixpair_power_sums_* and fixpair_correlation_modes_* compensate by themselves: modes that were compensated here go there with
/// FIXPAIR_COMPENSATION_NONE.
///
/// In/out: modes         len reals
/// In:     compensation  FIXPAIR_COMPENSATION_WINDOW + FIXPAIR_WINDOW_TSC and so on
///         scale         of the field: what makes its modes those of f(x) = sum_k f_k exp(+i k.x). 1/(sum of weights) for the density contrast of a
///                       deposit, 1/n^3 for any other field (both after a transform that does not divide), 1 for modes of this library
///         brick         of Fourier space
///         scratch       scratch_len bytes, see fixpair_compensate_scratch
///         exec          or NULL
/// Returns: 0, FIXPAIR_ERROR_NULL, _LENGTH, _ALIGNMENT, _OVERLAP, _SCRATCH, _CHOICE, _NOT_FINITE for the scale, or why the brick is refused;
///          FIXPAIR_ERROR_HOOK, after which modes are undefined. Modes are not checked.
/// Cost: one pass over the modes
///
/// # Safety
/// Pointers are null or point to as many values as stated.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_compensate_f64(
    modes: *mut f64,
    len: usize,
    compensation: i32,
    scale: f64,
    brick: *const fixpair_brick,
    scratch: *mut c_void,
    scratch_len: usize,
    exec: *const fixpair_exec,
) -> fixpair_status_t {
    // SAFETY: the caller's promise.
    code(unsafe { divide(modes, len, compensation, scale, brick, scratch, scratch_len, exec) })
}

/// fixpair_compensate_f64 in single precision.
///
/// # Safety
/// Pointers are null or point to as many values as stated.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_compensate_f32(
    modes: *mut f32,
    len: usize,
    compensation: i32,
    scale: f64,
    brick: *const fixpair_brick,
    scratch: *mut c_void,
    scratch_len: usize,
    exec: *const fixpair_exec,
) -> fixpair_status_t {
    // SAFETY: the caller's promise.
    code(unsafe { divide(modes, len, compensation, scale, brick, scratch, scratch_len, exec) })
}

unsafe fn divide<T: Real>(
    modes: *mut T,
    len: usize,
    compensation: i32,
    scale: f64,
    brick: *const fixpair_brick,
    scratch: *mut c_void,
    scratch_len: usize,
    exec: *const fixpair_exec,
) -> Result<()> {
    let mut border = Border::new();
    // SAFETY: the caller's promise.
    unsafe {
        let modes = border.write(modes, len)?;
        let chosen = self::compensation(compensation)?;
        let brick = border.read_one(brick)?.check()?;
        let scratch = border.scratch(scratch, scratch_len)?;
        compensate(modes, chosen, scale, &brick, scratch, &HostExec::new(&mut border, exec)?)
    }
}
