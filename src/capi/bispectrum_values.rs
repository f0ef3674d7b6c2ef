//! From sums over triangles to bispectra.

use super::bispectrum_sums::check_words;
use super::border::Border;
use super::status::{code, fixpair_status_t};
use crate::estimate::bispectrum::{self, Triangle};
use crate::estimate::exact::ExactSum;

/// The sums of triangles as numbers, each rounded once.
///
/// Out: values  values_len numbers, one a triangle: sum over cells of D_i D_j D_k
/// In:  sums    sums_len = FIXPAIR_BISPECTRUM_WORDS * values_len integers
/// Returns: 0, FIXPAIR_ERROR_NULL, _LENGTH, _ALIGNMENT, _OVERLAP, _OVERFLOW, FIXPAIR_ERROR_NOT_FINITE if a sum lost a term that was not finite
///
/// # Safety
/// Pointers are null or point to as many values as stated.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_bispectrum_values(
    values: *mut f64,
    values_len: usize,
    sums: *const i64,
    sums_len: usize,
) -> fixpair_status_t {
    code((|| {
        let mut border = Border::new();
        // SAFETY: the caller's promise.
        let (values, words) = unsafe { (border.write(values, values_len)?, border.read(sums, sums_len)?) };
        check_words(sums_len, values_len)?;
        bispectrum::bispectrum_values(values, ExactSum::of_words(words))
    })())
}

/// From sums over cells to B = V^2 (scale^3/n^3) value/count, V = L^3; 0 where no modes close the triangle.
///
/// In/Out: values    len numbers of fixpair_bispectrum_values, then B
/// In:     counts    len counts of fixpair_triangle_counts
///         n         cells on a side of the mesh
///         box_size  L; B comes in its unit to the sixth power
///         scale     of the field, which enters three times: what makes its modes those of f(x) = sum_k f_k exp(+i k.x). 1/(sum of weights) for the
///                   density contrast of a deposit, 1/n^3 for any other field (both after a transform that does not divide), 1 for
///                   modes of this library and those that fixpair_compensate_f64 brought to scale
/// Returns: 0, FIXPAIR_ERROR_NULL, _ALIGNMENT, _OVERLAP, FIXPAIR_ERROR_MESH_SIZE for n = 0, FIXPAIR_ERROR_NOT_FINITE, FIXPAIR_ERROR_RANGE for a
///          box that is not positive or a result that overflows
///
/// # Safety
/// Pointers are null or point to as many values as stated.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_bispectrum_normalise(
    values: *mut f64,
    counts: *const u64,
    len: usize,
    n: usize,
    box_size: f64,
    scale: f64,
) -> fixpair_status_t {
    code((|| {
        let mut border = Border::new();
        // SAFETY: the caller's promise.
        let (values, counts) = unsafe { (border.write(values, len)?, border.read(counts, len)?) };
        bispectrum::normalise(values, counts, n, box_size, scale)
    })())
}

/// The shot noise of B of points of equal weight: (P_i + P_j + P_k) noise + noise^2.
///
/// With weights noise is V sum w^2/(sum w)^2 in the first term, and the second is V^2 sum w^3/(sum w)^3, which is larger than noise^2:
/// subtract that difference too.
///
/// Out: out        triangles_len numbers
/// In:  triangles  3 triangles_len numbers of shells, counted from 0
///      power      shells values of P, free of shot noise
///      noise      1/n for points of number density n
/// Returns: 0, FIXPAIR_ERROR_NULL, _ALIGNMENT, _OVERLAP, _NOT_FINITE, FIXPAIR_ERROR_RANGE for shells that are not there or a result that overflows
///
/// # Safety
/// Pointers are null or point to as many values as stated.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_bispectrum_shot_noise(
    out: *mut f64,
    triangles: *const u32,
    triangles_len: usize,
    power: *const f64,
    shells: usize,
    noise: f64,
) -> fixpair_status_t {
    code((|| {
        let mut border = Border::new();
        // SAFETY: the caller's promise; a triangle is three numbers.
        unsafe {
            let out = border.write(out, triangles_len)?;
            let triangles = border.read(triangles.cast::<Triangle>(), triangles_len)?;
            bispectrum::shot_noise(out, triangles, border.read(power, shells)?, noise)
        }
    })())
}

/// The reduced bispectrum Q = B/(P_i P_j + P_j P_k + P_k P_i); 0 where the denominator is.
///
/// Out: out         triangles_len numbers
/// In:  bispectrum  triangles_len values of B, free of shot noise
///      triangles   3 triangles_len numbers of shells, counted from 0
///      power       shells values of P, free of shot noise
/// Returns: as fixpair_bispectrum_shot_noise
///
/// # Safety
/// Pointers are null or point to as many values as stated.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_bispectrum_reduced(
    out: *mut f64,
    bispectrum: *const f64,
    triangles: *const u32,
    triangles_len: usize,
    power: *const f64,
    shells: usize,
) -> fixpair_status_t {
    code((|| {
        let mut border = Border::new();
        // SAFETY: the caller's promise; a triangle is three numbers.
        unsafe {
            let out = border.write(out, triangles_len)?;
            let spectrum = border.read(bispectrum, triangles_len)?;
            let triangles = border.read(triangles.cast::<Triangle>(), triangles_len)?;
            bispectrum::reduced(out, spectrum, triangles, border.read(power, shells)?)
        }
    })())
}
