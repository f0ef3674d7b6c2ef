//! Bins of spectra and correlation functions.

use super::border::Border;
use super::status::{code, fixpair_status_t};
use crate::estimate::binning::{Bin, Binning, Second, normalise, read_sums};
use crate::estimate::edges::{exact_edges, uniform_edges, wavenumber_edges};
use crate::status::{Error, Result};

/// Bins of |n| alone.
pub const FIXPAIR_SECOND_NONE: i32 = 0;
/// Wedges of mu = |n.a|/|n|.
pub const FIXPAIR_SECOND_COSINE: i32 = 1;
/// Bins of n_perp and |n.a|, for P(k_perp, k_par).
pub const FIXPAIR_SECOND_PARALLEL: i32 = 2;

/// In orders: the mean, l = 0.
pub const FIXPAIR_MULTIPOLE_0: u32 = 1;
/// In orders: the dipole, l = 1.
pub const FIXPAIR_MULTIPOLE_1: u32 = 2;
/// In orders: the quadrupole, l = 2.
pub const FIXPAIR_MULTIPOLE_2: u32 = 4;
/// In orders: l = 3.
pub const FIXPAIR_MULTIPOLE_3: u32 = 8;
/// In orders: the hexadecapole, l = 4.
pub const FIXPAIR_MULTIPOLE_4: u32 = 16;

/// What spectra and correlation functions are binned by. n is an integer vector: the mode k = (2 pi/L) n, or the separation x = (L/N) n,
/// N the cells on a side of the mesh.
///
/// Bin b holds edges[b] <= |n|^2 < edges[b+1]: integers, so that no mode lies on an edge by rounding. With a second coordinate bin (b, c) is number
/// b (second_edges_len - 1) + c. Wedges hold second_edges[c] <= mu < second_edges[c+1], edges in [0, 1], the last one inclusive, and mu = 0 at n = 0. With
/// FIXPAIR_SECOND_PARALLEL edges are those of n_perp^2 = |n|^2 - (n.a)^2 and second_edges those of |n.a|, a being the line of sight.
///
/// Fill it with fixpair_binning_init, then change what is to be otherwise. Functions refuse with FIXPAIR_ERROR_TABLE edges that do not increase, with
/// FIXPAIR_ERROR_RANGE an axis of length 0 and orders that are 0 or above 31, with FIXPAIR_ERROR_NOT_FINITE, FIXPAIR_ERROR_CHOICE and
/// FIXPAIR_ERROR_VERSION what these say, and with FIXPAIR_ERROR_OVERFLOW bins that do not fit memory.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct fixpair_binning {
    /// sizeof(fixpair_binning).
    pub struct_size: usize,
    /// Increasing values of |n|^2.
    pub edges: *const u64,
    /// How many: one more than bins of the first coordinate.
    pub edges_len: usize,
    /// FIXPAIR_SECOND_...
    pub second: i32,
    /// Multipoles: FIXPAIR_MULTIPOLE_0, or several: FIXPAIR_MULTIPOLE_0 | FIXPAIR_MULTIPOLE_2 | FIXPAIR_MULTIPOLE_4.
    pub orders: u32,
    /// Increasing edges of the second coordinate; NULL without one.
    pub second_edges: *const f64,
    /// How many; 0 without a second coordinate.
    pub second_edges_len: usize,
    /// The line of sight, of any length.
    pub axis: [f64; 3],
}

impl fixpair_binning {
    /// # Safety
    /// The edges are null or point to as many values as stated.
    pub(super) unsafe fn check<'a>(&self, border: &mut Border) -> Result<Binning<'a>> {
        if self.struct_size != size_of::<Self>() {
            return Err(Error::Version);
        }
        // SAFETY: the caller's promise.
        let edges = unsafe { border.read(self.edges, self.edges_len) }?;
        // SAFETY: the caller's promise.
        let second_edges = unsafe { border.read(self.second_edges, self.second_edges_len) }?;
        let second = match self.second {
            FIXPAIR_SECOND_NONE if second_edges.is_empty() => Second::None,
            FIXPAIR_SECOND_NONE => return Err(Error::Length),
            FIXPAIR_SECOND_COSINE => Second::Cosine(second_edges),
            FIXPAIR_SECOND_PARALLEL => Second::Parallel(second_edges),
            _ => return Err(Error::Choice),
        };
        Ok(Binning { edges, second, axis: self.axis, orders: self.orders })
    }
}

/// # Safety
/// `pointer` is null or points to a binning whose edges are null or point to as many values as stated.
pub(super) unsafe fn binning<'a>(
    border: &mut Border,
    pointer: *const fixpair_binning,
) -> Result<Binning<'a>> {
    // SAFETY: the caller's promise.
    unsafe {
        let binning = border.read_one(pointer)?;
        binning.check(border)
    }
}

/// Bins of |n| with the mean alone; the line of sight is z.
///
/// Out: binning  refers to the edges, which have to stay where they are
/// In:  edges    edges_len increasing values of |n|^2, see fixpair_edges_uniform and its neighbours
/// Returns: 0, FIXPAIR_ERROR_NULL, _ALIGNMENT, _OVERLAP, _OVERFLOW, _TABLE
///
/// # Safety
/// Pointers are null or point to as many values as stated.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_binning_init(
    binning: *mut fixpair_binning,
    edges: *const u64,
    edges_len: usize,
) -> fixpair_status_t {
    code((|| {
        let mut border = Border::new();
        // SAFETY: the caller's promise.
        let (binning, values) = unsafe { (border.write_one(binning)?, border.read(edges, edges_len)?) };
        let shells = Binning::shells(values);
        shells.bins()?;
        *binning = fixpair_binning {
            struct_size: size_of::<fixpair_binning>(),
            edges,
            edges_len,
            second: FIXPAIR_SECOND_NONE,
            orders: shells.orders,
            second_edges: core::ptr::null(),
            second_edges_len: 0,
            axis: shells.axis,
        };
        Ok(())
    })())
}

/// Lengths of the arrays that belong to a binning.
///
/// Out: bins     bins of both coordinates
///      values   of `spectra` spectra: spectra x bins x multipoles
///      words    int64_t of the sums of `spectra` spectra
/// In:  binning
///      spectra  pairs of fields, or correlation meshes, that are summed together: 1 or more
/// Returns: 0, FIXPAIR_ERROR_NULL, _ALIGNMENT, _OVERLAP, FIXPAIR_ERROR_LENGTH for no spectra, or why the binning is refused
///
/// # Safety
/// Pointers are null or point to as many values as stated.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_binning_lengths(
    bins: *mut usize,
    values: *mut usize,
    words: *mut usize,
    binning: *const fixpair_binning,
    spectra: usize,
) -> fixpair_status_t {
    code((|| {
        let mut border = Border::new();
        // SAFETY: the caller's promise.
        unsafe {
            let (bins, values) = (border.write_one(bins)?, border.write_one(values)?);
            let words = border.write_one(words)?;
            let binning = self::binning(&mut border, binning)?;
            let needed = binning.words(spectra)?;
            *bins = binning.bins()?;
            *values = *bins * spectra * binning.multipoles();
            *words = needed;
        }
        Ok(())
    })())
}

/// Turns sums into bins: what each holds, and the sums of p(n) L_l(mu) in it, rounded once.
///
/// Sums are integers. They begin as zeros; fixpair_power_sums_* and fixpair_correlation_sums_* add to them; and those of several bricks or ranks of one
/// mesh, added one by one (MPI_INT64_T, MPI_SUM) in any order, read as those of the whole mesh bit for bit.
///
/// Out: bins     bins_len bins
///      values   values_len numbers: for each spectrum, each bin, each multipole in increasing order
/// In:  sums     sums_len integers; all lengths as fixpair_binning_lengths
///      binning, spectra  as they were summed
/// Returns: 0, FIXPAIR_ERROR_NULL, _LENGTH, _ALIGNMENT, _OVERLAP, FIXPAIR_ERROR_NOT_FINITE if a product was NaN, infinite or above
///          1e198 (nothing is then written), or why the binning is refused
///
/// # Safety
/// Pointers are null or point to as many values as stated.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_binning_read(
    bins: *mut Bin,
    bins_len: usize,
    values: *mut f64,
    values_len: usize,
    sums: *const i64,
    sums_len: usize,
    binning: *const fixpair_binning,
    spectra: usize,
) -> fixpair_status_t {
    code((|| {
        let mut border = Border::new();
        // SAFETY: the caller's promise.
        unsafe {
            let (bins, values) = (border.write(bins, bins_len)?, border.write(values, values_len)?);
            let sums = border.read(sums, sums_len)?;
            let binning = self::binning(&mut border, binning)?;
            read_sums(bins, values, sums, &binning, spectra)
        }
    })())
}

/// Turns sums into multipoles: value_l <- (2l + 1) factor value_l / count, and 0 in empty bins.
///
/// For P_l in (Mpc/h)^3 the factor is L^3 times the scale of either field, what makes its modes those of f(x) = sum_k f_k exp(+i k.x): L^3/(sum of
/// weights)^2 for the density contrast of a deposit, L^3/n^6 for any other field (both after a transform that does not divide), L^3 for modes of this
/// library and those that fixpair_compensate_f64 brought to scale. For xi_l it is 1. The variance of P_0 of a Gaussian field is 2 P^2/count.
///
/// In/out: values  values_len numbers of one or more spectra
/// In:     bins    bins_len bins
///         orders  as in the binning
///         factor
/// Returns: 0, FIXPAIR_ERROR_NULL, _LENGTH, _ALIGNMENT, _OVERLAP, _RANGE for orders, _NOT_FINITE for the factor
///
/// # Safety
/// Pointers are null or point to as many values as stated.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_binning_normalise(
    values: *mut f64,
    values_len: usize,
    bins: *const Bin,
    bins_len: usize,
    orders: u32,
    factor: f64,
) -> fixpair_status_t {
    code((|| {
        let mut border = Border::new();
        // SAFETY: the caller's promise.
        let (values, bins) = unsafe { (border.write(values, values_len)?, border.read(bins, bins_len)?) };
        normalise(values, bins, orders, factor)
    })())
}

/// Edges at |n| = first + b width: the least integers |n|^2 that are not below, to 1e-9.
///
/// first = 1, width = 1: unit shells [1, 2), [2, 3)... First = w/2, width = w: shells about w, 2w, ..., where a mode goes to the nearest.
///
/// Out: edges  edges_len integers
/// In:  first, width
/// Returns: 0, FIXPAIR_ERROR_NULL, _ALIGNMENT, _OVERFLOW, _NOT_FINITE, FIXPAIR_ERROR_RANGE for edges below 0 or from 4e9 on, FIXPAIR_ERROR_TABLE for
///          fewer than two edges or edges that do not increase as integers; nothing is then written
///
/// # Safety
/// `edges` is null or points to as many values as stated.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_edges_uniform(
    edges: *mut u64,
    edges_len: usize,
    first: f64,
    width: f64,
) -> fixpair_status_t {
    // SAFETY: the caller's promise.
    code(
        unsafe { Border::new().write(edges, edges_len) }.and_then(|edges| uniform_edges(edges, first, width)),
    )
}

/// Edges at wavenumbers k: the least integers |n|^2 that are not below (k L/(2 pi))^2, to 1e-9, so that an edge on a mode is that mode.
///
/// Out: edges        edges_len integers
/// In:  wavenumbers  edges_len increasing values in h/Mpc
///      box_size     L in Mpc/h
/// Returns: as fixpair_edges_uniform, or FIXPAIR_ERROR_OVERLAP, FIXPAIR_ERROR_RANGE for a box that is not positive
///
/// # Safety
/// Pointers are null or point to as many values as stated.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_edges_wavenumbers(
    edges: *mut u64,
    wavenumbers: *const f64,
    edges_len: usize,
    box_size: f64,
) -> fixpair_status_t {
    code((|| {
        let mut border = Border::new();
        // SAFETY: the caller's promise.
        let (edges, wavenumbers) =
            unsafe { (border.write(edges, edges_len)?, border.read(wavenumbers, edges_len)?) };
        wavenumber_edges(edges, wavenumbers, box_size)
    })())
}

/// Every |n|^2 a bin of its own: first, first + 1, ... Bins of numbers that are no sum of three squares (7, 15...) stay empty.
///
/// Out: edges  edges_len integers
/// In:  first
/// Returns: 0, FIXPAIR_ERROR_NULL, _ALIGNMENT, FIXPAIR_ERROR_TABLE for fewer than two edges, _OVERFLOW; nothing is then written
///
/// # Safety
/// `edges` is null or points to as many values as stated.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_edges_exact(
    edges: *mut u64,
    edges_len: usize,
    first: u64,
) -> fixpair_status_t {
    // SAFETY: the caller's promise.
    code(unsafe { Border::new().write(edges, edges_len) }.and_then(|edges| exact_edges(edges, first)))
}
