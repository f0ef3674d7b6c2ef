//! Triangles of shells, and how many modes close them.

use core::ffi::c_void;

use super::border::Border;
use super::exec::{HostExec, fixpair_exec};
use super::status::{code, fixpair_status_t};
use crate::estimate::bispectrum::{self, Triangle};
use crate::scratch::Layout;

/// How many triangles fixpair_closed_triangles lists.
///
/// Out: count
/// In:  edges    edges_len increasing values of |n|^2, n = k L/(2 pi): shell s holds the modes edges[s] <= |n|^2 < edges[s+1]
///      centres  edges_len - 1 increasing numbers >= 0, or NULL
/// Returns: 0, FIXPAIR_ERROR_NULL, _ALIGNMENT, _OVERLAP, _OVERFLOW, FIXPAIR_ERROR_TABLE for edges or centres that do not increase or centres
///          below 0, FIXPAIR_ERROR_NOT_FINITE for centres
///
/// # Safety
/// Pointers are null or point to as many values as stated.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_closed_triangle_count(
    count: *mut usize,
    edges: *const u64,
    edges_len: usize,
    centres: *const f64,
) -> fixpair_status_t {
    code((|| {
        let mut border = Border::new();
        // SAFETY: the caller's promise.
        unsafe {
            let count = border.write_one(count)?;
            let edges = border.read(edges, edges_len)?;
            let centres = border.read_optional(centres, edges_len.saturating_sub(1))?;
            *count = bispectrum::closed_triangle_count(edges, centres)?;
            Ok(())
        }
    })())
}

/// Lists all triangles of shells that close: three shells i <= j <= k each, counted from 0, in lexicographic order.
///
/// With centres, one for each shell in any unit, those with c_k <= c_i + c_j (within 1e-9): for shells of one width centred on its multiples, or
/// counted by their floor, that is k <= i + j counted from 1, and 40 shells close 6350 triangles. Without, all that the modes of some
/// wave vectors may close: sqrt(edges[k]) <= sqrt(edges[i+1] - 1) + sqrt(edges[j+1] - 1).
///
/// Out: triangles  3 triangles_len numbers, triangles_len from fixpair_closed_triangle_count
/// In:  edges, centres as fixpair_closed_triangle_count
/// Returns: 0, FIXPAIR_ERROR_LENGTH for any other triangles_len, or as fixpair_closed_triangle_count
///
/// # Safety
/// Pointers are null or point to as many values as stated.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_closed_triangles(
    triangles: *mut u32,
    triangles_len: usize,
    edges: *const u64,
    edges_len: usize,
    centres: *const f64,
) -> fixpair_status_t {
    code((|| {
        let mut border = Border::new();
        // SAFETY: the caller's promise; a triangle is three numbers.
        unsafe {
            let triangles = border.write(triangles.cast::<Triangle>(), triangles_len)?;
            let edges = border.read(edges, edges_len)?;
            let centres = border.read_optional(centres, edges_len.saturating_sub(1))?;
            bispectrum::closed_triangles(triangles, edges, centres)
        }
    })())
}

/// Lists the squeezed slice of a shell: (shell, j, j) for j = shell .. shells - 1.
///
/// Out: triangles  3 triangles_len numbers, triangles_len = shells - shell
/// In:  shell      counted from 0
///      shells     how many there are
/// Returns: 0, FIXPAIR_ERROR_NULL, _ALIGNMENT, _OVERFLOW, FIXPAIR_ERROR_LENGTH for any other triangles_len, FIXPAIR_ERROR_RANGE unless shell < shells
///
/// # Safety
/// `triangles` is null or points to as many values as stated.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_squeezed_triangles(
    triangles: *mut u32,
    triangles_len: usize,
    shell: usize,
    shells: usize,
) -> fixpair_status_t {
    code((|| {
        // SAFETY: the caller's promise; a triangle is three numbers.
        let triangles = unsafe { Border::new().write(triangles.cast::<Triangle>(), triangles_len) }?;
        bispectrum::squeezed_triangles(triangles, shell, shells)
    })())
}

/// Scratch of fixpair_triangle_counts: for 40 shells of 3 k_f, n = 360 and their 6350 triangles 25 MB.
///
/// Out: scratch
/// In:  triangles, edges, n as fixpair_triangle_counts
/// Returns: 0, or as fixpair_triangle_counts
///
/// # Safety
/// Pointers are null or point to as many values as stated.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_triangle_counts_scratch(
    scratch: *mut Layout,
    triangles: *const u32,
    triangles_len: usize,
    edges: *const u64,
    edges_len: usize,
    n: usize,
) -> fixpair_status_t {
    code((|| {
        let mut border = Border::new();
        // SAFETY: the caller's promise; a triangle is three numbers.
        unsafe {
            let scratch = border.write_one(scratch)?;
            let triangles = border.read(triangles.cast::<Triangle>(), triangles_len)?;
            let edges = border.read(edges, edges_len)?;
            *scratch = bispectrum::triangle_counts_scratch(edges, n, triangles)?;
            Ok(())
        }
    })())
}

/// Counts, for each triangle, the ordered triples of modes k1, k2, k3, one from each of its shells, with k1 + k2 + k3 = 0. The numbers are exact.
///
/// A mesh knows mode numbers modulo n. Where n is less than the sum of a triangle's three upper radii, triples that close only modulo n are
/// counted too, as they are summed too by fixpair_bispectrum_sums_f64. Counts depend on nothing but the arguments: keep them.
///
/// Out: counts     triangles_len numbers
/// In:  triangles  3 triangles_len numbers of shells, counted from 0, in any order; triangles may repeat
///      edges      edges_len increasing values of |n|^2: shell s holds edges[s] <= |n|^2 < edges[s+1]; the last at most (n/2)^2
///      n          cells on a side of the mesh
///      scratch    scratch_len bytes, see fixpair_triangle_counts_scratch
///      exec       or NULL
/// Returns: 0, FIXPAIR_ERROR_NULL, _ALIGNMENT, _OVERLAP, _MESH_SIZE, _OVERFLOW, _SCRATCH, _HOOK; FIXPAIR_ERROR_TABLE for edges that do not
///          increase, FIXPAIR_ERROR_RANGE for edges beyond (n/2)^2 and shells that are not there, FIXPAIR_ERROR_CONVERGENCE
///          where rounding errors leave a count in doubt or one exceeds 2^48
/// Cost: for 40 shells of 3 k_f, n = 360 and 6350 triangles 22 Gflop in double precision
///
/// # Safety
/// Pointers are null or point to as many values as stated; the hook keeps its contract.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_triangle_counts(
    counts: *mut u64,
    triangles: *const u32,
    triangles_len: usize,
    edges: *const u64,
    edges_len: usize,
    n: usize,
    scratch: *mut c_void,
    scratch_len: usize,
    exec: *const fixpair_exec,
) -> fixpair_status_t {
    code((|| {
        let mut border = Border::new();
        // SAFETY: the caller's promise; a triangle is three numbers.
        unsafe {
            let counts = border.write(counts, triangles_len)?;
            let triangles = border.read(triangles.cast::<Triangle>(), triangles_len)?;
            let edges = border.read(edges, edges_len)?;
            let scratch = border.scratch(scratch, scratch_len)?;
            let exec = HostExec::new(&mut border, exec)?;
            bispectrum::triangle_counts(counts, triangles, edges, n, scratch, &exec)
        }
    })())
}
