//! The likelihood of bias and f_NL, in the space of 36 numbers.
//!
//! ```text
//! chi^2 = (d - m)^T C^-1 (d - m),  L ~ exp(-chi^2/2)                                  (Eq. chi2, likelihood)
//! ```
//!
//! With x = 2 delta_c (b_g - p) f_NL, P_hh = b_g^2 P + 2 b_g x P/alpha + x^2 P/alpha^2 and P_hm = b_g P + x P/alpha: the model is a sum of five
//! columns with coefficients (b_g^2, 2 b_g x, x^2, b_g, x). Columns and data, divided by sigma or by the root of the covariance, go row by
//! row into a triangle R of 6 x 6 (Givens rotations), and chi^2 = |R c|^2 with c = (b_g^2, 2 b_g x, x^2, b_g, x, -1) from then on, whatever the number of bins.
//! Being a sum of squares it loses no digits and is never negative.
//!
//! Only bins that are handed over are fitted: the paper takes k <= 0.09 h/Mpc.

use super::bias::{Bias, Spectrum};
use super::check::{finite, positive, result, same_length};
use super::small::Triangle;
use crate::math::sqrt;
use crate::scratch::{Arena, Layout};
use crate::status::{Error, Result};
use crate::within::Within;

/// Five columns and the data.
pub(super) const COLUMNS: usize = 6;

/// All that measured spectra say of b_g, p and f_NL. Begins empty; spectra that are independent are added, of P_hh, P_hm or both.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct BiasLikelihood {
    /// Values that were added.
    pub bins: u64,
    /// R of chi^2 = |R c|^2 with c = (b_g^2, 2 b_g x, x^2, b_g, x, -1) and x = 2 delta_c (b_g - p) f_NL; upper triangular.
    pub root: [[f64; 6]; 6],
}

/// Measured spectra and what their model is made of, bin by bin.
#[derive(Clone, Copy, Debug)]
pub struct Spectra<'a> {
    /// P_hh without shot noise, or P_hm, (Mpc/h)^3.
    pub power: &'a [f64],
    /// P_lin of matter at their redshift, averaged over the modes of the bin as theirs are.
    pub linear: &'a [f64],
    /// alpha(k, z) at their redshift.
    pub alpha: &'a [f64],
}

impl Spectra<'_> {
    fn check(&self) -> Result<()> {
        same_length(self.power.len(), &[self.linear.len(), self.alpha.len()])?;
        finite(self.power)?;
        positive(self.linear)?;
        positive(self.alpha)
    }

    /// The row of bin i.
    fn row(&self, spectrum: Spectrum, i: usize) -> [f64; COLUMNS] {
        let (power, linear, alpha) = (self.power.at(i), self.linear.at(i), self.alpha.at(i));
        let over = linear / alpha;
        match spectrum {
            Spectrum::HaloHalo => [linear, over, over / alpha, 0.0, 0.0, power],
            Spectrum::HaloMatter => [0.0, 0.0, 0.0, linear, over, power],
        }
    }
}

impl BiasLikelihood {
    /// No data.
    /// cbindgen:ignore
    pub const EMPTY: Self = Self { bins: 0, root: [[0.0; COLUMNS]; COLUMNS] };

    fn with(&self, rows: u64, triangle: Triangle<COLUMNS>) -> Result<Self> {
        finite(triangle.0.as_flattened()).map_err(|_| Error::Range)?;
        Ok(Self { bins: self.bins.saturating_add(rows), root: triangle.0 })
    }

    /// Adds bins that do not correlate, each with its sigma (Eq. chi2).
    ///
    /// # Errors
    /// `Length` for arrays of different lengths, `NotFinite`, `Range` for sigma, P_lin or alpha that is not positive, `self` that no data have made, or numbers too extreme.
    ///
    /// # Example
    /// ```
    /// use fixpair::variance::bias::{Bias, Spectrum, halo_power};
    /// use fixpair::variance::likelihood::{BiasLikelihood, Spectra};
    ///
    /// let truth = Bias { b_g: 2.0, p: 1.0, f_nl: 100.0, delta_c: 1.686 };
    /// let (linear, alpha, sigma, mut power) = ([2e4, 1e4, 5e3], [100.0, 1000.0, 4000.0], [900.0, 200.0, 50.0], [0.0; 3]);
    /// halo_power(&mut power, &truth, Spectrum::HaloHalo, &linear, &alpha)?; // or a measured one, without its shot noise
    /// let mut likelihood = BiasLikelihood::EMPTY;
    /// likelihood.add(Spectrum::HaloHalo, Spectra { power: &power, linear: &linear, alpha: &alpha }, &sigma)?;
    /// assert_eq!(likelihood.bins, 3);
    /// # Ok::<(), fixpair::status::Error>(())
    /// ```
    pub fn add(&mut self, spectrum: Spectrum, spectra: Spectra<'_>, sigma: &[f64]) -> Result<()> {
        self.check()?;
        spectra.check()?;
        same_length(sigma.len(), &[spectra.power.len()])?;
        positive(sigma)?;
        let mut triangle = Triangle(self.root);
        for (i, sigma) in sigma.iter().enumerate() {
            triangle.push(spectra.row(spectrum, i).map(|x| x / sigma));
        }
        *self = self.with(sigma.len() as u64, triangle)?;
        Ok(())
    }

    /// Adds bins that correlate: the first `halo_halo` are P_hh, the rest P_hm.
    ///
    /// `root`: the lower triangle of their covariance, from [`covariance_root`](super::covariance). `precision`: what the inverse covariance is multiplied by:
    /// 1, or [`hartlap_factor`](super::levels::hartlap_factor) for a covariance that was measured.
    ///
    /// # Errors
    /// As [`BiasLikelihood::add`]; `Range` for `halo_halo` beyond the bins and for a precision that is not positive, `Singular` for a root with a zero on its diagonal,
    /// `Scratch`.
    ///
    /// # Example
    /// ```
    /// # #[repr(align(64))] struct Memory([u8; 1 << 16]);
    /// # let mut memory = Memory([0; 1 << 16]);
    /// # let scratch = &mut memory.0;
    /// use fixpair::variance::bias::Bias;
    /// use fixpair::variance::likelihood::{BiasLikelihood, Spectra};
    ///
    /// let spectra = Spectra { power: &[8e4, 4e4, 2e4], linear: &[2e4, 1e4, 5e3], alpha: &[100.0, 1000.0, 4000.0] };
    /// let root = [900.0, 0.0, 0.0, 50.0, 200.0, 0.0, 0.0, 10.0, 50.0]; // L of the covariance L L^T
    /// let mut likelihood = BiasLikelihood::EMPTY;
    /// likelihood.add_correlated(3, spectra, &root, 1.0, scratch)?; // all P_hh; 1, or Hartlap's factor
    /// assert!(likelihood.chi_squared(&Bias { b_g: 2.0, p: 1.0, f_nl: 0.0, delta_c: 1.686 })? < 1e-12);
    /// # Ok::<(), fixpair::status::Error>(())
    /// ```
    pub fn add_correlated(
        &mut self,
        halo_halo: usize,
        spectra: Spectra<'_>,
        root: &[f64],
        precision: f64,
        scratch: &mut [u8],
    ) -> Result<()> {
        let bins = spectra.power.len();
        self.check()?;
        spectra.check()?;
        super::check::table(root, bins, bins)?;
        positive(&[precision])?;
        if halo_halo > bins {
            return Err(Error::Range);
        }
        let mut arena = Arena::new(scratch, add_correlated_scratch(bins)?)?;
        let white = arena.take::<[f64; COLUMNS]>(bins)?;
        let scale = sqrt(precision);
        let mut triangle = Triangle(self.root);
        for i in 0..bins {
            let spectrum = if i < halo_halo { Spectrum::HaloHalo } else { Spectrum::HaloMatter };
            let line = root.part(i * bins..=i * bins + i);
            let Some((&pivot, factors)) = line.split_last() else { return Err(Error::Length) };
            let mut row = spectra.row(spectrum, i);
            for (factor, before) in factors.iter().zip(white.iter()) {
                for (x, before) in row.iter_mut().zip(before) {
                    *x -= factor * before;
                }
            }
            if pivot <= 0.0 {
                return Err(Error::Singular);
            }
            let row = row.map(|x| x / pivot);
            triangle.push(row.map(|x| scale * x));
            white.put(i, row);
        }
        *self = self.with(bins as u64, triangle)?;
        Ok(())
    }

    /// Adds the data of another likelihood, independent of these.
    ///
    /// # Errors
    /// `NotFinite` or `Range` for numbers that no data have made.
    ///
    /// # Example
    /// ```
    /// use fixpair::variance::bias::{Bias, Spectrum, halo_power};
    /// use fixpair::variance::likelihood::{BiasLikelihood, Spectra};
    ///
    /// let truth = Bias { b_g: 2.0, p: 1.0, f_nl: 100.0, delta_c: 1.686 };
    /// let (linear, alpha, sigma, mut power) = ([2e4, 1e4, 5e3], [100.0, 1000.0, 4000.0], [900.0, 200.0, 50.0], [0.0; 3]);
    /// halo_power(&mut power, &truth, Spectrum::HaloHalo, &linear, &alpha)?; // or a measured one, without its shot noise
    /// let mut likelihood = BiasLikelihood::EMPTY;
    /// likelihood.add(Spectrum::HaloHalo, Spectra { power: &power, linear: &linear, alpha: &alpha }, &sigma)?;
    /// let other = likelihood; // another box
    /// likelihood.merge(&other)?;
    /// assert_eq!(likelihood.bins, 6);
    /// # Ok::<(), fixpair::status::Error>(())
    /// ```
    pub fn merge(&mut self, other: &Self) -> Result<()> {
        self.check()?;
        other.check()?;
        let mut triangle = Triangle(self.root);
        other.root.iter().for_each(|&row| triangle.push(row));
        *self = self.with(other.bins, triangle)?;
        Ok(())
    }

    /// chi^2 of given parameters (Eq. chi2).
    ///
    /// # Errors
    /// `NotFinite`, `Range` for delta_c that is not positive or a result that overflows.
    ///
    /// # Example
    /// ```
    /// use fixpair::variance::bias::{Bias, Spectrum, halo_power};
    /// use fixpair::variance::likelihood::{BiasLikelihood, Spectra};
    ///
    /// let truth = Bias { b_g: 2.0, p: 1.0, f_nl: 100.0, delta_c: 1.686 };
    /// let (linear, alpha, sigma, mut power) = ([2e4, 1e4, 5e3], [100.0, 1000.0, 4000.0], [900.0, 200.0, 50.0], [0.0; 3]);
    /// halo_power(&mut power, &truth, Spectrum::HaloHalo, &linear, &alpha)?; // or a measured one, without its shot noise
    /// let mut likelihood = BiasLikelihood::EMPTY;
    /// likelihood.add(Spectrum::HaloHalo, Spectra { power: &power, linear: &linear, alpha: &alpha }, &sigma)?;
    /// assert!(likelihood.chi_squared(&truth)? < 1e-12);
    /// # Ok::<(), fixpair::status::Error>(())
    /// ```
    pub fn chi_squared(&self, parameters: &Bias) -> Result<f64> {
        self.check()?;
        parameters.check()?;
        result(self.at(parameters))
    }

    pub(super) fn check(&self) -> Result<()> {
        finite(self.root.as_flattened())?;
        let below = |i: usize| self.root[i][..i].iter().any(|&x| x != 0.0);
        if (0..COLUMNS).any(below) { Err(Error::Range) } else { Ok(()) }
    }

    /// The same for numbers that were checked.
    #[inline]
    pub(super) fn at(&self, parameters: &Bias) -> f64 {
        self.residuals(parameters).iter().map(|r| r * r).sum()
    }

    /// R c: its squares sum to chi^2.
    #[inline]
    pub(super) fn residuals(&self, parameters: &Bias) -> [f64; COLUMNS] {
        let (b, x) = (parameters.b_g, parameters.shift());
        Triangle(self.root).times(&[b * b, 2.0 * b * x, x * x, b, x, -1.0])
    }
}

/// Work space of [`BiasLikelihood::add_correlated`]: 48 bytes a bin.
///
/// # Errors
/// `Overflow` if it does not fit the address space.
///
/// # Example
/// ```
/// use fixpair::variance::likelihood::add_correlated_scratch;
///
/// assert!(add_correlated_scratch(14)?.size >= 14 * 8);
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn add_correlated_scratch(bins: usize) -> Result<Layout> {
    Layout::EMPTY.and::<[f64; COLUMNS]>(bins)
}
