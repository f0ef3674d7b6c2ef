//! Sums over triangles of shells that the host transforms itself.

use core::ffi::c_void;

use super::border::Border;
use super::exec::{HostExec, fixpair_exec};
use super::mesh::fixpair_brick;
use super::status::{code, fixpair_status_t};
use crate::estimate::bispectrum::{self, Triangle};
use crate::estimate::exact::ExactSum;
use crate::real::Real;
use crate::scratch::Layout;
use crate::status::{Error, Result};

/// 64-bit integers in the sum of one triangle. Sums of parts of a mesh are added integer by integer: MPI_Allreduce with MPI_INT64_T and
/// MPI_SUM makes those of the whole mesh of them, bit for bit.
pub const FIXPAIR_BISPECTRUM_WORDS: usize = 42;

const _: () = assert!(FIXPAIR_BISPECTRUM_WORDS == ExactSum::WORDS);

/// Copies the modes of one shell, lo <= |n|^2 < hi, and makes all others zero. Their inverse transform is what fixpair_bispectrum_sums_f64
/// takes.
///
/// Out: out    len reals
/// In:  modes  len reals: modes with delta(x) = sum_k delta_k exp(+i k.x); those of a deposit compensated before, by fixpair_compensate_f64
///      brick  of Fourier space, where both lie, in any layout
///      lo, hi edges of the shell; hi at most (n/2)^2
///      exec   or NULL
/// Returns: 0, FIXPAIR_ERROR_NULL, _LENGTH, _ALIGNMENT, _OVERLAP, _HOOK, FIXPAIR_ERROR_TABLE unless lo < hi, FIXPAIR_ERROR_RANGE for hi beyond
///          (n/2)^2, or why the brick is refused
///
/// # Safety
/// Pointers are null or point to as many values as stated; the hook keeps its contract.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_shell_modes_f64(
    out: *mut f64,
    modes: *const f64,
    len: usize,
    brick: *const fixpair_brick,
    lo: u64,
    hi: u64,
    exec: *const fixpair_exec,
) -> fixpair_status_t {
    // SAFETY: the caller's promise.
    code(unsafe { shell(out, modes, len, brick, lo, hi, exec) })
}

/// fixpair_shell_modes_f64 in single precision.
///
/// # Safety
/// As fixpair_shell_modes_f64.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_shell_modes_f32(
    out: *mut f32,
    modes: *const f32,
    len: usize,
    brick: *const fixpair_brick,
    lo: u64,
    hi: u64,
    exec: *const fixpair_exec,
) -> fixpair_status_t {
    // SAFETY: the caller's promise.
    code(unsafe { shell(out, modes, len, brick, lo, hi, exec) })
}

unsafe fn shell<T: Real>(
    out: *mut T,
    modes: *const T,
    len: usize,
    brick: *const fixpair_brick,
    lo: u64,
    hi: u64,
    exec: *const fixpair_exec,
) -> Result<()> {
    let mut border = Border::new();
    // SAFETY: the caller's promise.
    unsafe {
        let out = border.write(out, len)?;
        let modes = border.read(modes, len)?;
        let brick = border.read_one(brick)?.check()?;
        bispectrum::shell_modes(out, modes, &brick, lo, hi, &HostExec::new(&mut border, exec)?)
    }
}

/// Scratch of fixpair_bispectrum_sums_f64. For T triangles, S shells, cells of b = 8 bytes (4 in single precision) and w = 64, or the brick's x
/// planes if those are fewer: 392 T + 4 S + w (520 S b + 80 T) bytes and a few cache lines.
///
/// Out: scratch
/// In:  brick          of configuration space
///      shells         S
///      triangles_len  T
/// Returns: 0, FIXPAIR_ERROR_NULL, _ALIGNMENT, _OVERLAP, _OVERFLOW, or why the brick is refused
///
/// # Safety
/// Pointers are null or point to one value.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_bispectrum_sums_scratch_f64(
    scratch: *mut Layout,
    brick: *const fixpair_brick,
    shells: usize,
    triangles_len: usize,
) -> fixpair_status_t {
    // SAFETY: the caller's promise.
    code(unsafe { sums_scratch::<f64>(scratch, brick, shells, triangles_len) })
}

/// fixpair_bispectrum_sums_scratch_f64 in single precision.
///
/// # Safety
/// As fixpair_bispectrum_sums_scratch_f64.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_bispectrum_sums_scratch_f32(
    scratch: *mut Layout,
    brick: *const fixpair_brick,
    shells: usize,
    triangles_len: usize,
) -> fixpair_status_t {
    // SAFETY: the caller's promise.
    code(unsafe { sums_scratch::<f32>(scratch, brick, shells, triangles_len) })
}

unsafe fn sums_scratch<T: Real>(
    scratch: *mut Layout,
    brick: *const fixpair_brick,
    shells: usize,
    triangles_len: usize,
) -> Result<()> {
    let mut border = Border::new();
    // SAFETY: the caller's promise.
    let (scratch, brick) = unsafe { (border.write_one(scratch)?, border.read_one(brick)?) };
    *scratch = bispectrum::bispectrum_sums_scratch::<T>(&brick.check()?, shells, triangles_len)?;
    Ok(())
}

/// Adds sum over cells x of D_i(x) D_j(x) D_k(x), for each triangle of a list, to its sum: D_s(x) = sum over the modes k of shell s of
/// delta_k exp(+i k.x), from fixpair_shell_modes_f64 and the host's inverse transform.
///
/// A sum is FIXPAIR_BISPECTRUM_WORDS integers, zero at first. The sums of x slabs, added integer by integer, are those of the whole mesh bit for
/// bit. fixpair_bispectrum_values makes numbers of them. In single precision products of three fields vanish below 1e-38 and
/// overflow above 3e38.
///
/// In/Out: sums     sums_len = FIXPAIR_BISPECTRUM_WORDS * triangles_len integers
/// In:     triangles  3 triangles_len numbers of shells, counted from 0, in any order; triangles may repeat
///         fields   shells pointers to len reals each; those of shells that no triangle names may be NULL
///         brick    of configuration space, where each field lies; what lies between its rows is not read
///         scratch  scratch_len bytes, see fixpair_bispectrum_sums_scratch_f64
///         exec     or NULL
/// Returns: 0, FIXPAIR_ERROR_NULL, _LENGTH, _ALIGNMENT, _OVERLAP, _OVERFLOW, _SCRATCH, _HOOK, FIXPAIR_ERROR_RANGE for shells that are not
///          there, FIXPAIR_ERROR_NOT_FINITE if a sum is NaN or infinite, or why the brick is refused; sums are untouched by all
/// Cost: each field is read once; for all triangles of many shells 2 flops for each triangle and cell
///
/// # Safety
/// Pointers are null or point to as many values as stated; the hook keeps its contract.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_bispectrum_sums_f64(
    sums: *mut i64,
    sums_len: usize,
    triangles: *const u32,
    triangles_len: usize,
    fields: *const *const f64,
    shells: usize,
    len: usize,
    brick: *const fixpair_brick,
    scratch: *mut c_void,
    scratch_len: usize,
    exec: *const fixpair_exec,
) -> fixpair_status_t {
    // SAFETY: the caller's promise.
    code(unsafe {
        field_sums(
            sums,
            sums_len,
            triangles,
            triangles_len,
            fields,
            shells,
            len,
            brick,
            scratch,
            scratch_len,
            exec,
        )
    })
}

/// fixpair_bispectrum_sums_f64 in single precision.
///
/// # Safety
/// As fixpair_bispectrum_sums_f64.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_bispectrum_sums_f32(
    sums: *mut i64,
    sums_len: usize,
    triangles: *const u32,
    triangles_len: usize,
    fields: *const *const f32,
    shells: usize,
    len: usize,
    brick: *const fixpair_brick,
    scratch: *mut c_void,
    scratch_len: usize,
    exec: *const fixpair_exec,
) -> fixpair_status_t {
    // SAFETY: the caller's promise.
    code(unsafe {
        field_sums(
            sums,
            sums_len,
            triangles,
            triangles_len,
            fields,
            shells,
            len,
            brick,
            scratch,
            scratch_len,
            exec,
        )
    })
}

/// The sums of `triangles` triangles: as many, and no more.
pub(super) fn sums_of(words: &mut [i64], triangles: usize) -> Result<&mut [ExactSum]> {
    check_words(words.len(), triangles)?;
    Ok(ExactSum::in_words(words))
}

pub(super) fn check_words(words: usize, triangles: usize) -> Result<()> {
    let expected = triangles.checked_mul(FIXPAIR_BISPECTRUM_WORDS);
    if expected == Some(words) { Ok(()) } else { Err(Error::Length) }
}

/// Pointers to fields that all threads read.
struct Fields<'a, T> {
    starts: &'a [*const T],
    length: usize,
}

// SAFETY: they are only read from, and only while the caller keeps them.
unsafe impl<T: Real> Sync for Fields<'_, T> {}

impl<'a, T: Real> Fields<'a, T> {
    fn field(&self, shell: usize) -> &'a [T] {
        let start = self.starts.get(shell).copied().filter(|start| !start.is_null());
        // SAFETY: not null, aligned and apart from what is written (checked at the border); the rest is the caller's promise.
        start.map_or(&[], |start| unsafe { core::slice::from_raw_parts(start, self.length) })
    }
}

unsafe fn field_sums<T: Real>(
    sums: *mut i64,
    sums_len: usize,
    triangles: *const u32,
    triangles_len: usize,
    fields: *const *const T,
    shells: usize,
    len: usize,
    brick: *const fixpair_brick,
    scratch: *mut c_void,
    scratch_len: usize,
    exec: *const fixpair_exec,
) -> Result<()> {
    let mut border = Border::new();
    // SAFETY: the caller's promise; a triangle is three numbers.
    unsafe {
        let words = border.write(sums, sums_len)?;
        let starts = border.read(fields, shells)?;
        for &start in starts {
            // More fields than a border has room for: each is compared with what is written.
            let mut border = Border::new();
            border.strided(sums, 1, sums_len)?;
            border.strided(scratch.cast::<u8>(), 1, scratch_len)?;
            border.read_optional(start, len)?;
        }
        let triangles = border.read(triangles.cast::<Triangle>(), triangles_len)?;
        let sums = sums_of(words, triangles_len)?;
        let missing = |&shell: &u32| starts.get(shell as usize).is_some_and(|start| start.is_null());
        if len > 0 && triangles.iter().flatten().any(missing) {
            return Err(Error::Null);
        }
        let brick = border.read_one(brick)?.check()?;
        let scratch = border.scratch(scratch, scratch_len)?;
        let exec = HostExec::new(&mut border, exec)?;
        let fields = Fields { starts, length: len };
        let field = |shell: usize| fields.field(shell);
        bispectrum::sums_of_fields(sums, triangles, shells, &field, &brick, scratch, &exec)
    }
}

#[cfg(test)]
mod tests {
    use std::vec;
    use std::vec::Vec;

    use super::super::bispectrum_values::fixpair_bispectrum_values;
    use super::*;
    use crate::mesh::{Brick, Space};
    use crate::status::Error;

    #[test]
    fn fields_of_shells_that_nobody_names_may_be_null() {
        const SHELLS: usize = 30;
        let cells = Brick::whole(4, Space::Configuration).unwrap();
        let brick = fixpair_brick::from(cells);
        let mesh: Vec<f64> = (0..cells.reals()).map(|i| f64::from(i as u32 % 7) - 3.0).collect();
        let mut fields = [core::ptr::null(); SHELLS];
        fields[2] = mesh.as_ptr();
        fields[29] = mesh.as_ptr();
        let mut layout = Layout::EMPTY;
        let mut sums = [0_i64; 2 * FIXPAIR_BISPECTRUM_WORDS];
        let (mut values, expected) = ([0.0; 2], mesh.chunks(6).flat_map(|row| &row[..4]).map(|x| x * x * x));
        let expected: f64 = expected.sum();
        // SAFETY: every pointer points to as many values as stated.
        unsafe {
            assert_eq!(fixpair_bispectrum_sums_scratch_f64(&raw mut layout, &raw const brick, SHELLS, 2), 0);
            let mut scratch = vec![[0_u64; 8]; layout.size.div_ceil(64) + 1];
            let start = scratch.as_mut_ptr().cast::<u8>();
            let start = start.add(start.align_offset(layout.align)).cast::<c_void>();
            let add = |triangles: &[u32; 6], sums: *mut i64, len: usize| {
                fixpair_bispectrum_sums_f64(
                    sums,
                    2 * FIXPAIR_BISPECTRUM_WORDS,
                    triangles.as_ptr(),
                    2,
                    fields.as_ptr(),
                    SHELLS,
                    len,
                    &raw const brick,
                    start,
                    layout.size,
                    core::ptr::null(),
                )
            };
            let (good, missing) = ([2, 2, 2, 29, 2, 29], [2, 2, 2, 29, 3, 29]);
            let words = sums.as_mut_ptr();
            assert_eq!(add(&good, words, mesh.len()), 0);
            assert_eq!(add(&missing, words, mesh.len()), Error::Null.code());
            assert_eq!(add(&good, words, mesh.len() - 3), Error::Length.code());
            assert_eq!(add(&good, mesh.as_ptr().cast_mut().cast(), mesh.len()), Error::Overlap.code());
            assert_eq!(
                fixpair_bispectrum_values(values.as_mut_ptr(), 2, words, 2 * FIXPAIR_BISPECTRUM_WORDS),
                0
            );
        }
        assert_eq!(values, [expected; 2]);
    }
}
