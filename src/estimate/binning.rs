//! What spectra and correlation functions are binned by, and how sums become bins.
//!
//! The points of a brick are integer vectors n: modes, k = (2 pi/L) n, or separations of cells, x = (L/N) n. A bin is a range
//! of |n|^2 between two integers, so that no point lies on an edge by rounding; within it, on request, a range of mu = |n.a|/|n| or, in place
//! of |n|, ranges of n_perp^2 and |n.a|, where a is the line of sight. In each bin products p(n) are summed with Legendre polynomials L_l(n.a/|n|).
//!
//! All sums are integers ([`ExactSum`], and fixed point for what depends on the geometry alone) in one array of i64 that the caller owns. It
//! begins as zeros; kernels add to it; arrays of several bricks, ranks (`MPI_INT64_T`, `MPI_SUM`) or chunks of work add up, in any order, to the bits of
//! the whole.

use super::exact::ExactSum;
use crate::status::{Error, Result};

/// The highest multipole.
pub const HIGHEST_ORDER: u32 = 4;

/// The second coordinate of a bin. Its edges increase; a range holds its lower edge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Second<'a> {
    /// Bins of |n| alone.
    None,
    /// Wedges: mu = |n.a|/|n| in [0, 1], 0 at n = 0; the last range holds its upper edge too. A mu within rounding of an edge lies on it.
    Cosine(&'a [f64]),
    /// |n.a| in units of k_f (or cells). The first coordinate is then n_perp^2 = |n|^2 - (n.a)^2, where what lies within
    /// 1e-12 |n|^2 below an integer counts as that integer.
    Parallel(&'a [f64]),
}

/// Bins and multipoles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Binning<'a> {
    /// Bin b holds `edges[b] <= |n|^2 < edges[b + 1]`.
    pub edges: &'a [u64],
    /// A second coordinate.
    pub second: Second<'a>,
    /// The line of sight, of any length but 0.
    pub axis: [f64; 3],
    /// Bit l asks for the multipole l = 0..=4: 1 for the mean alone, 0b10101 for 0, 2, 4.
    pub orders: u32,
}

/// What a bin holds besides its sums.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C)]
pub struct Bin {
    /// Modes, counting k and -k, or separations; 0 where none falls into the bin.
    pub count: u64,
    /// Their mean |n|, or mean n_perp; 0 where there are none. Times 2 pi/L it is a wavenumber, times L over the cells on a side a separation.
    pub first: f64,
    /// Their mean mu, or mean |n.a|; 0 without a second coordinate.
    pub second: f64,
}

impl<'a> Binning<'a> {
    /// Bins of |n| with the mean alone; the line of sight is z.
    ///
    /// ```
    /// use fixpair::estimate::binning::Binning;
    ///
    /// let binning = Binning { orders: 0b10101, ..Binning::shells(&[1, 4, 9, 16]) }; // P_0, P_2, P_4
    /// assert_eq!((binning.bins()?, binning.multipoles()), (3, 3));
    /// # Ok::<(), fixpair::status::Error>(())
    /// ```
    #[must_use]
    pub const fn shells(edges: &'a [u64]) -> Self {
        Self { edges, second: Second::None, axis: [0.0, 0.0, 1.0], orders: 1 }
    }

    /// Bins: ranges of the first coordinate times ranges of the second. Bin (b, c) is number `b * ranges of the second + c`.
    ///
    /// # Errors
    /// `Table` for fewer than two edges, edges that do not increase, and edges of mu outside [0, 1] or of |n.a| below 0; `NotFinite` for edges or
    /// axes that are not; `Range` for an axis of length 0 and for orders that are empty or above 4; `Overflow` for 2^31 bins and more.
    ///
    /// # Example
    /// ```
    /// use fixpair::estimate::binning::{Binning, Second};
    ///
    /// let wedges = Binning { second: Second::Cosine(&[0.0, 0.5, 1.0]), ..Binning::shells(&[1, 4, 9, 16]) };
    /// assert_eq!(wedges.bins()?, 6);
    /// # Ok::<(), fixpair::status::Error>(())
    /// ```
    pub fn bins(&self) -> Result<usize> {
        self.check().map(|checked| checked.bins())
    }

    /// Multipoles.
    ///
    /// ```
    /// use fixpair::estimate::binning::Binning;
    ///
    /// assert_eq!(Binning::shells(&[1, 4, 9]).multipoles(), 1);
    /// ```
    #[must_use]
    pub const fn multipoles(&self) -> usize {
        self.orders.count_ones() as usize
    }

    /// Length of the array of sums of `spectra` products (pairs of fields, or correlation meshes).
    ///
    /// # Errors
    /// As [`Binning::bins`]; `Length` for no spectra, `Overflow` if the bytes do not fit the address space.
    ///
    /// # Example
    /// ```
    /// use fixpair::estimate::binning::Binning;
    ///
    /// let sums = vec![0_i64; Binning::shells(&[1, 4, 9]).words(1)?]; // of one spectrum
    /// assert!(!sums.is_empty());
    /// # Ok::<(), fixpair::status::Error>(())
    /// ```
    pub fn words(&self, spectra: usize) -> Result<usize> {
        self.check()?.words(spectra)
    }

    pub(super) fn check(&self) -> Result<Checked<'a>> {
        check_edges(self.edges)?;
        let seconds = match self.second {
            Second::None => &[][..],
            Second::Cosine(edges) | Second::Parallel(edges) => {
                if edges.iter().any(|edge| !edge.is_finite()) {
                    return Err(Error::NotFinite);
                }
                let ends = edges.first().zip(edges.last()).ok_or(Error::Table)?;
                let beyond = matches!(self.second, Second::Cosine(_)) && *ends.1 > 1.0;
                if edges.len() < 2 || *ends.0 < 0.0 || beyond || !edges.is_sorted_by(|a, b| a < b) {
                    return Err(Error::Table);
                }
                edges
            }
        };
        if self.orders == 0 || self.orders >> (HIGHEST_ORDER + 1) != 0 {
            return Err(Error::Range);
        }
        let axis = unit(self.axis)?;
        let (first, ranges) = (self.edges.len() - 1, seconds.len().saturating_sub(1).max(1));
        let bins = first.checked_mul(ranges).filter(|&bins| i32::try_from(bins).is_ok());
        bins.ok_or(Error::Overflow)?;
        Ok(Checked { edges: self.edges, second: self.second, axis, orders: self.orders, first, ranges })
    }
}

fn check_edges(edges: &[u64]) -> Result<()> {
    let valid = edges.len() >= 2 && edges.is_sorted_by(|a, b| a < b);
    if valid { Ok(()) } else { Err(Error::Table) }
}

/// The axis divided by its length; exactly a unit vector where it is a coordinate axis, so that n.a is an integer there.
fn unit(axis: [f64; 3]) -> Result<[f64; 3]> {
    if axis.iter().any(|x| !x.is_finite()) {
        return Err(Error::NotFinite);
    }
    let largest = axis.iter().fold(0.0_f64, |largest, x| largest.max(x.abs()));
    if largest == 0.0 {
        return Err(Error::Range);
    }
    // Divided by the largest first: the squares neither overflow nor vanish together.
    let scaled = axis.map(|x| x / largest);
    let length = libm::sqrt(scaled[0] * scaled[0] + scaled[1] * scaled[1] + scaled[2] * scaled[2]);
    Ok(scaled.map(|x| x / length))
}

/// A binning that kernels may trust.
#[derive(Clone, Copy)]
pub(super) struct Checked<'a> {
    pub(super) edges: &'a [u64],
    pub(super) second: Second<'a>,
    pub(super) axis: [f64; 3],
    pub(super) orders: u32,
    first: usize,
    /// Ranges of the second coordinate.
    pub(super) ranges: usize,
}

/// Integers a bin holds for its geometry: the count, then two sums of non-negative numbers.
pub(super) const GEOMETRY: usize = 5;

/// Bits of the fraction of a fixed-point sum. 2^23 arrays of sums may be added before their fractions overflow.
const FRACTION: u32 = 40;

impl Checked<'_> {
    pub(super) const fn bins(&self) -> usize {
        self.first * self.ranges
    }

    /// `Overflow` if the sum of |n| over a bin of a mesh of side n may not fit an integer, for bins of more than 10^13 modes: narrower ones do.
    pub(super) fn check_geometry(&self, n: usize) -> Result<()> {
        // Up to here n^3 points of |n| <= n sqrt(3)/2 sum to less than 2^60.
        const SAFE_SIDE: usize = 1 << 15;
        // Somewhat above sqrt(3)/2: half the diagonal of a cell, by which the cells of a shell's points may reach out of the shell.
        const HALF_DIAGONAL: f64 = 0.867;
        if n <= SAFE_SIDE {
            return Ok(());
        }
        let farthest = HALF_DIAGONAL * n as f64;
        let last_square = 3 * (n as u64 / 2).pow(2);
        let volume = |radius: f64| 4.0 / 3.0 * core::f64::consts::PI * (radius * radius * radius);
        let fits = self.edges.windows(2).all(|edges| {
            let [low, high] = [edges[0], edges[1]].map(|edge| libm::sqrt(edge as f64).min(farthest));
            let points = volume(high + HALF_DIAGONAL) - volume((low - HALF_DIAGONAL).max(0.0));
            edges[0] > last_square || points * high < i64::MAX as f64
        });
        if fits { Ok(()) } else { Err(Error::Overflow) }
    }

    /// Sums of products in a bin.
    pub(super) fn sums(&self, spectra: usize) -> Result<usize> {
        if spectra == 0 {
            return Err(Error::Length);
        }
        spectra.checked_mul(self.orders.count_ones() as usize).ok_or(Error::Overflow)
    }

    pub(super) fn words(&self, spectra: usize) -> Result<usize> {
        let bin =
            self.sums(spectra)?.checked_mul(ExactSum::WORDS).and_then(|words| words.checked_add(GEOMETRY));
        let words = bin.and_then(|words| words.checked_mul(self.bins()));
        words.filter(|&words| words <= isize::MAX as usize / 8).ok_or(Error::Overflow)
    }
}

/// Adds `times` the count and the two sums of one stretch to a bin's integers. The same numbers give the same integers wherever they are added.
#[inline]
pub(super) fn add_geometry(words: &mut [i64; GEOMETRY], stretch: [f64; 3], times: i64) {
    let [count, first, second] = stretch;
    words[0] += times * count as i64;
    for (pair, value) in words[1..].chunks_exact_mut(2).zip([first, second]) {
        let whole = value as i64;
        let fraction = (value - whole as f64) * (1_i64 << FRACTION) as f64;
        pair[0] += times * whole;
        pair[1] += times * (fraction + 0.5) as i64;
    }
    carry_geometry(words);
}

/// Fractions into [0, 1).
#[inline]
pub(super) fn carry_geometry(words: &mut [i64; GEOMETRY]) {
    for pair in words[1..].chunks_exact_mut(2) {
        pair[0] = pair[0].wrapping_add(pair[1] >> FRACTION);
        pair[1] &= (1 << FRACTION) - 1;
    }
}

/// Turns sums into bins.
///
/// `bins`: [`Binning::bins`], overwritten. `values`: for each of `spectra` products, each bin, each multipole in increasing order: the sum of p(n) L_l,
/// rounded once; overwritten. `sums`: [`Binning::words`] integers that kernels have added to.
///
/// # Errors
/// As [`Binning::words`]; `Length`; `NotFinite` if a product was NaN, infinite or above 1e198 (nothing is then written).
///
/// # Example
/// ```
/// use fixpair::estimate::binning::{Bin, Binning, read_sums};
/// use fixpair::estimate::compensation::Compensation;
/// use fixpair::estimate::power::power_sums;
/// use fixpair::exec::Serial;
/// use fixpair::mesh::{Brick, Space};
/// use fixpair::noise::{Amplitude, Realisation, white_modes};
/// # #[repr(align(64))] struct Memory([u8; 1 << 18]);
/// # let mut memory = Memory([0; 1 << 18]);
/// # let scratch = &mut memory.0;
///
/// let brick = Brick::whole(8, Space::Fourier)?;
/// let mut modes = vec![0.0_f64; brick.reals()];
/// white_modes(&mut modes, &brick, &Realisation { amplitude: Amplitude::Fixed, ..Realisation::new(1) }, &Serial)?;
/// let binning = Binning::shells(&[1, 4, 9]);
/// let mut sums = vec![0; binning.words(1)?];
/// power_sums(&mut sums, &[&modes], &[[0, 0]], &[Compensation::None], &brick, &binning, scratch, &Serial)?;
/// let (mut bins, mut values) = ([Bin::default(); 2], [0.0; 2]);
/// read_sums(&mut bins, &mut values, &sums, &binning, 1)?;
/// assert_eq!((bins[0].count, bins[1].count), (26, 66));
/// assert!((values[0] - 26.0).abs() < 1e-12); // the sum of |w|^2
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn read_sums(
    bins: &mut [Bin],
    values: &mut [f64],
    sums: &[i64],
    binning: &Binning<'_>,
    spectra: usize,
) -> Result<()> {
    let checked = binning.check()?;
    let (count, each) = (checked.bins(), checked.sums(spectra)?);
    if sums.len() != checked.words(spectra)? || bins.len() != count || values.len() != count * each {
        return Err(Error::Length);
    }
    let (geometry, products) = sums.split_at_checked(count * GEOMETRY).ok_or(Error::Length)?;
    let products = ExactSum::of_words(products);
    if products.iter().any(ExactSum::is_lost) {
        return Err(Error::NotFinite);
    }
    for (bin, words) in bins.iter_mut().zip(geometry.as_chunks::<GEOMETRY>().0) {
        let count = words[0].max(0) as u64;
        let mean = |whole: i64, fraction: i64| {
            let sum = whole as f64 + fraction as f64 / (1_i64 << FRACTION) as f64;
            if count == 0 { 0.0 } else { sum / count as f64 }
        };
        *bin = Bin { count, first: mean(words[1], words[2]), second: mean(words[3], words[4]) };
    }
    let orders = each / spectra;
    for (spectrum, values) in values.chunks_exact_mut((count * orders).max(1)).enumerate() {
        for (bin, values) in values.chunks_exact_mut(orders.max(1)).enumerate() {
            for (order, value) in values.iter_mut().enumerate() {
                *value = products.get(bin * each + spectrum * orders + order).map_or(0.0, ExactSum::value);
            }
        }
    }
    Ok(())
}

/// Turns sums into multipoles, in place: value_l <- (2l + 1) factor value_l/count, and 0 where a bin is empty.
///
/// `values`: of one or more spectra, as [`read_sums`] writes them. For P_l the factor is V s^2, V = L^3, where s turns the fields' modes
/// into those of f(x) = sum_k f_k exp(+i k.x) (1/n^3 after an unnormalised transform); for xi_l of an inverse transform it is 1.
///
/// # Errors
/// `Range` for orders that are empty or above 4, `Length` if `values` is not a multiple of bins times multipoles, `NotFinite` for the factor.
///
/// # Example
/// ```
/// use fixpair::estimate::binning::{Bin, Binning, read_sums};
/// use fixpair::estimate::compensation::Compensation;
/// use fixpair::estimate::power::power_sums;
/// use fixpair::exec::Serial;
/// use fixpair::mesh::{Brick, Space};
/// use fixpair::noise::{Amplitude, Realisation, white_modes};
/// # #[repr(align(64))] struct Memory([u8; 1 << 18]);
/// # let mut memory = Memory([0; 1 << 18]);
/// # let scratch = &mut memory.0;
///
/// let brick = Brick::whole(8, Space::Fourier)?;
/// let mut modes = vec![0.0_f64; brick.reals()];
/// white_modes(&mut modes, &brick, &Realisation { amplitude: Amplitude::Fixed, ..Realisation::new(1) }, &Serial)?;
/// let binning = Binning::shells(&[1, 4, 9]);
/// let mut sums = vec![0; binning.words(1)?];
/// power_sums(&mut sums, &[&modes], &[[0, 0]], &[Compensation::None], &brick, &binning, scratch, &Serial)?;
/// let (mut bins, mut values) = ([Bin::default(); 2], [0.0; 2]);
/// read_sums(&mut bins, &mut values, &sums, &binning, 1)?;
/// use fixpair::estimate::binning::normalise;
///
/// normalise(&mut values, &bins, binning.orders, 1e9)?; // V: the modes are of variance P/V = 1
/// assert!((values[0] / 1e9 - 1.0).abs() < 1e-12);
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn normalise(values: &mut [f64], bins: &[Bin], orders: u32, factor: f64) -> Result<()> {
    let multipoles = check_values(values, bins, orders)?;
    if !factor.is_finite() {
        return Err(Error::NotFinite);
    }
    for values in values.chunks_exact_mut(multipoles * bins.len()) {
        for (values, bin) in values.chunks_exact_mut(multipoles).zip(bins) {
            let scale = if bin.count == 0 { 0.0 } else { factor / bin.count as f64 };
            for (value, order) in values.iter_mut().zip(order_numbers(orders)) {
                *value *= f64::from(2 * order + 1) * scale;
            }
        }
    }
    Ok(())
}

/// Multipoles asked for, if `values` are so many for each of the bins of one or more spectra.
pub(super) fn check_values(values: &[f64], bins: &[Bin], orders: u32) -> Result<usize> {
    if orders == 0 || orders >> (HIGHEST_ORDER + 1) != 0 {
        return Err(Error::Range);
    }
    let multipoles = orders.count_ones() as usize;
    let each = bins.len().checked_mul(multipoles).ok_or(Error::Overflow)?;
    let fits = each > 0 && !values.is_empty() && values.len().is_multiple_of(each);
    if fits { Ok(multipoles) } else { Err(Error::Length) }
}

/// The l that a mask asks for, in increasing order.
pub(super) fn order_numbers(orders: u32) -> impl Iterator<Item = u32> {
    (0..=HIGHEST_ORDER).filter(move |order| orders >> order & 1 == 1)
}
