//! Tables of a positive function of k, interpolated so that monotone data stay monotone.
//!
//! Between two rows ln value is a cubic in ln k whose slope at a row follows from the row and its two neighbours
//! (Steffen 1990, A&A 239, 443): it is continuous, never leaves the range of the two rows between them, and reproduces power
//! laws and the rows themselves to rounding. Nothing is computed beforehand: each lookup reads four rows.
//!
//! Outside the rows the table continues as a power law: above with the slope of its last row, below with the slope of its first,
//! or with one that the caller knows better ([`Table::with_slope_below`]).

use crate::status::{Error, Result};
use crate::within::Within;

/// Rows (k, value), k in h/Mpc and strictly increasing, both positive.
#[derive(Clone, Copy, Debug)]
pub struct Table<'a> {
    k: &'a [f64],
    value: &'a [f64],
    slope_below: Option<f64>,
}

impl<'a> Table<'a> {
    /// Borrows two columns and checks them.
    ///
    /// # Errors
    /// `Length` if they are not equally long; `NotFinite` if a number is NaN or infinite; `Table` if there are fewer than two rows, a number is
    /// not positive, or k does not increase (by at least 1e-12 of itself).
    ///
    /// # Example
    /// ```
    /// use fixpair::cosmology::Table;
    ///
    /// let table = Table::new(&[0.01, 0.1, 1.0], &[100.0, 10.0, 1.0])?;
    /// assert!(Table::new(&[0.1, 0.01], &[1.0, 2.0]).is_err()); // k increases
    /// # let _ = table;
    /// # Ok::<(), fixpair::status::Error>(())
    /// ```
    pub fn new(k: &'a [f64], value: &'a [f64]) -> Result<Self> {
        if k.len() != value.len() {
            return Err(Error::Length);
        }
        if k.iter().chain(value).any(|x| !x.is_finite()) {
            return Err(Error::NotFinite);
        }
        // Normal numbers only: the logarithm of a subnormal one has few digits.
        let positive = k.iter().chain(value).all(|&x| x >= f64::MIN_POSITIVE);
        let increasing = k.windows(2).all(|pair| pair[1] - pair[0] > 1e-12 * pair[1]);
        if k.len() < 2 || !positive || !increasing {
            return Err(Error::Table);
        }
        Ok(Self { k, value, slope_below: None })
    }

    /// Sets the logarithmic slope of the continuation below the first row.
    ///
    /// # Errors
    /// `NotFinite`.
    ///
    /// # Example
    /// ```
    /// use fixpair::cosmology::Table;
    ///
    /// let table = Table::new(&[0.01, 0.1, 1.0], &[100.0, 10.0, 1.0])?.with_slope_below(1.0)?;
    /// assert!((table.at(0.001)? - 10.0).abs() < 1e-9);
    /// # Ok::<(), fixpair::status::Error>(())
    /// ```
    pub fn with_slope_below(self, slope: f64) -> Result<Self> {
        if slope.is_finite() { Ok(Self { slope_below: Some(slope), ..self }) } else { Err(Error::NotFinite) }
    }

    /// The first column.
    ///
    /// ```
    /// use fixpair::cosmology::Table;
    ///
    /// assert_eq!(Table::new(&[0.01, 1.0], &[2.0, 3.0])?.k(), [0.01, 1.0]);
    /// # Ok::<(), fixpair::status::Error>(())
    /// ```
    #[must_use]
    pub fn k(&self) -> &'a [f64] {
        self.k
    }

    /// The second column.
    ///
    /// ```
    /// use fixpair::cosmology::Table;
    ///
    /// assert_eq!(Table::new(&[0.01, 1.0], &[2.0, 3.0])?.value(), [2.0, 3.0]);
    /// # Ok::<(), fixpair::status::Error>(())
    /// ```
    #[must_use]
    pub fn value(&self) -> &'a [f64] {
        self.value
    }

    /// The interpolated or continued value at k.
    ///
    /// # Errors
    /// `NotFinite` if k is; `Range` if k is not positive or the continuation overflows.
    ///
    /// Cost: a binary search, ten logarithms and an exponential.
    ///
    /// # Example
    /// ```
    /// use fixpair::cosmology::Table;
    ///
    /// let table = Table::new(&[0.01, 0.1, 1.0], &[100.0, 10.0, 1.0])?;
    /// assert!((table.at(0.5)? - 2.0).abs() < 1e-9); // a power law is met exactly
    /// # Ok::<(), fixpair::status::Error>(())
    /// ```
    pub fn at(&self, k: f64) -> Result<f64> {
        check_wavenumber(k)?;
        let value = libm::exp(Cursor::new(*self).ln_value(k, libm::log(k)));
        if value.is_finite() { Ok(value) } else { Err(Error::Range) }
    }

    /// The first row.
    pub(super) fn first(&self) -> (f64, f64) {
        (self.k.at(0), self.value.at(0))
    }

    fn ln_row(&self, i: usize) -> (f64, f64) {
        (libm::log(self.k.at(i)), libm::log(self.value.at(i)))
    }

    /// Length in ln k and mean slope of the segment from row i to row i + 1.
    fn secant(&self, i: usize) -> (f64, f64) {
        let ((x0, y0), (x1, y1)) = (self.ln_row(i), self.ln_row(i + 1));
        (x1 - x0, (y1 - y0) / (x1 - x0))
    }

    /// Steffen's slope at row i.
    fn slope(&self, i: usize) -> f64 {
        let last = self.k.len() - 1;
        if last == 1 {
            return self.secant(0).1;
        }
        if i == 0 {
            return end_slope(self.secant(0), self.secant(1));
        }
        if i == last {
            return end_slope(self.secant(last - 1), self.secant(last - 2));
        }
        let ((h0, s0), (h1, s1)) = (self.secant(i - 1), self.secant(i));
        if s0 * s1 <= 0.0 {
            return 0.0;
        }
        let parabola = (s0 * h1 + s1 * h0) / (h0 + h1);
        let least = libm::fabs(s0).min(libm::fabs(s1)).min(0.5 * libm::fabs(parabola));
        libm::copysign(2.0 * least, s0)
    }
}

/// The slope of the parabola through the last three rows, kept from overshooting (Steffen 1990, eq. 25).
fn end_slope((h0, s0): (f64, f64), (h1, s1): (f64, f64)) -> f64 {
    let parabola = s0 + (s0 - s1) * h0 / (h0 + h1);
    if parabola * s0 <= 0.0 {
        0.0
    } else if libm::fabs(parabola) > 2.0 * libm::fabs(s0) {
        2.0 * s0
    } else {
        parabola
    }
}

/// Wavenumbers are finite and positive.
pub(crate) fn check_wavenumber(k: f64) -> Result<()> {
    if !k.is_finite() {
        return Err(Error::NotFinite);
    }
    if k < f64::MIN_POSITIVE { Err(Error::Range) } else { Ok(()) }
}

/// Lookups that remember their segment: cheap while k stays near. The bits do not depend on what was looked up before.
#[derive(Clone, Copy)]
pub(crate) struct Cursor<'a> {
    table: Table<'a>,
    /// The segment holds for from <= k < to.
    from: f64,
    to: f64,
    /// ln value = c0 + t (c1 + t (c2 + t c3)), t = ln k - x0.
    x0: f64,
    c: [f64; 4],
}

impl<'a> Cursor<'a> {
    pub(crate) fn new(table: Table<'a>) -> Self {
        Self { table, from: 0.0, to: 0.0, x0: 0.0, c: [0.0; 4] }
    }

    /// ln value at k > 0, whose logarithm is `ln_k`.
    #[inline]
    pub(crate) fn ln_value(&mut self, k: f64, ln_k: f64) -> f64 {
        if !(self.from <= k && k < self.to) {
            self.seek(k);
        }
        let t = ln_k - self.x0;
        let [c0, c1, c2, c3] = self.c;
        c0 + t * (c1 + t * (c2 + t * c3))
    }

    #[inline(never)]
    fn seek(&mut self, k: f64) {
        let table = self.table;
        let last = table.k.len() - 1;
        let above = table.k.partition_point(|&row| row <= k);
        let row = above.saturating_sub(1);
        let (x0, y0) = table.ln_row(row);
        self.x0 = x0;
        self.from = if above == 0 { 0.0 } else { table.k.at(row) };
        self.to = if above > last { f64::INFINITY } else { table.k.at(above) };
        self.c = if above == 0 {
            [y0, table.slope_below.unwrap_or_else(|| table.slope(0)), 0.0, 0.0]
        } else if above > last {
            [y0, table.slope(last), 0.0, 0.0]
        } else {
            let (h, secant) = table.secant(row);
            let (left, right) = (table.slope(row), table.slope(row + 1));
            [y0, left, (3.0 * secant - 2.0 * left - right) / h, (left + right - 2.0 * secant) / (h * h)]
        };
    }
}
