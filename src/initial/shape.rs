//! Quadratic primordial non-Gaussianity of any separable shape.
//!
//! Phi = Phi_G + f_NL sum_rows c X_out[(X_a Phi_G) (X_b Phi_G)], without its mean, where (X_s f)_k is proportional to P_Phi(k)^(-s/3) f_k,
//! P_Phi being A k^(n_s - 4): multiplication by k^(e s), e = (4 - n_s)/3. The three exponents of a row sum to 0, so that A and the unit
//! of k drop out, and k is counted in mode numbers. To lowest order in f_NL, with P = P_Phi and x = P^(1/3),
//!
//! B(k1, k2, k3) = f_NL sum_rows c [x3^-out (x1^(3-a) x2^(3-b) + x1^(3-b) x2^(3-a)) + 2 cyclic]
//!
//! (the way of Scoccimarro et al. 2012, arXiv:1108.5512). [`Shape`] has the rows of the usual templates.

use super::modes::{ByTable, Scale, add_modes, map_modes};
pub use super::shape_rows::{Shape, ShapeRow};
use crate::cosmology::{mode_power_table, mode_table_length};
use crate::exec::Exec;
use crate::fft::Fft3;
use crate::mesh::{Brick, Space};
use crate::real::Real;
use crate::scratch::Layout;
use crate::status::{Error, Result};
use crate::walk::walk;

/// Largest |s| of a row.
pub const LARGEST_EXPONENT: f64 = 8.0;

/// Largest n^|e s|: the product of two such factors is far inside single precision.
const LARGEST_FACTOR: f64 = 1e18;

/// Coefficients and kernel of a quadratic term.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quadratic<'a> {
    /// Coefficient of the sum of all rows.
    pub f_nl: f64,
    /// The kernel: a sum of separable products.
    pub rows: &'a [ShapeRow],
    /// Tilt of the primordial spectrum: P_Phi is proportional to k^(n_s - 4).
    pub n_s: f64,
}

impl Quadratic<'_> {
    /// Is there nothing to add to a Gaussian field?
    ///
    /// ```
    /// use fixpair::initial::shape::{Quadratic, Shape};
    ///
    /// let quadratic = Quadratic { f_nl: 0.0, rows: Shape::Equilateral.rows(), n_s: 0.96 };
    /// assert!(quadratic.is_gaussian());
    /// ```
    #[must_use]
    pub fn is_gaussian(&self) -> bool {
        self.f_nl == 0.0 || self.rows.iter().all(|row| row.coefficient == 0.0)
    }

    /// # Errors
    /// `NotFinite` for NaN or infinite numbers; `Range` for |n_s| > 10, an |s| above [`LARGEST_EXPONENT`], or a row whose exponents do
    /// not sum to 0 within 1e-12 and which therefore has a unit.
    ///
    /// # Example
    /// ```
    /// use fixpair::initial::shape::{Quadratic, Shape};
    ///
    /// let quadratic = Quadratic { f_nl: f64::NAN, rows: Shape::Equilateral.rows(), n_s: 0.96 };
    /// assert!(quadratic.check().is_err());
    /// ```
    pub fn check(&self) -> Result<()> {
        if !(self.f_nl.is_finite() && self.n_s.is_finite()) {
            return Err(Error::NotFinite);
        }
        if libm::fabs(self.n_s) > 10.0 {
            return Err(Error::Range);
        }
        self.rows.iter().try_for_each(ShapeRow::check)
    }

    /// `Range` where a power of |n| on a mesh of side `n` is so large that products of it may overflow.
    fn check_powers(&self, n: usize) -> Result<()> {
        let limit = libm::log(LARGEST_FACTOR);
        let ln_n = libm::log(n as f64) * libm::fabs(self.exponent());
        let small = |s: f64| libm::fabs(s) * ln_n <= limit;
        let all = self.rows.iter().all(|row| [row.s_out, row.s_a, row.s_b].into_iter().all(small));
        if all { Ok(()) } else { Err(Error::Range) }
    }

    /// e: P_Phi^(-1/3) is proportional to k^e.
    fn exponent(&self) -> f64 {
        (4.0 - self.n_s) / 3.0
    }
}

/// Scratch of [`add_quadratic`], in the order of its arguments: two meshes, the sum, the table.
///
/// # Errors
/// `Overflow` if the bytes do not fit the address space.
///
/// # Example
/// ```
/// # use fixpair::{exec::Serial, fft::{Tables, Transform}, mesh::{Brick, Space}};
/// # #[repr(align(64))] struct Memory([u8; 1 << 16]);
/// # let (mut tables, mut work) = (Memory([0; 1 << 16]), Memory([0; 1 << 16]));
/// # let tables = Tables::<f64>::new(8, &mut tables.0)?;
/// # let mut fft = Transform::new(&tables, Brick::whole(8, Space::Configuration)?, &mut work.0, &Serial)?;
/// use fixpair::initial::shape::add_quadratic_scratch;
///
/// assert_eq!(add_quadratic_scratch::<f64>(&Brick::whole(8, Space::Fourier)?, &fft)?.align, 64);
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn add_quadratic_scratch<T: Real>(brick: &Brick, work: &dyn Fft3<T>) -> Result<Layout> {
    let layout = Layout::EMPTY.and::<T>(work.length())?.and::<T>(work.length())?;
    layout.and::<T>(brick.reals())?.and::<f64>(mode_table_length(brick.n())?)
}

/// Adds a quadratic term to the modes of a Gaussian potential, in place.
///
/// `phi`: modes Phi_G of the Fourier brick `brick`; on return the modes of Phi. The mean and the Nyquist modes receive nothing, and
/// f_NL = 0 or no rows change nothing. `phi` is read until the last row and written once: an error leaves it as it was, unless `exec` fails in the last pass.
///
/// `work`: the transform on which products are taken. Its side decides the aliasing: the side of `brick` leaves the
/// folded modes in; 3N/2 or more is exact; anything in between is refused, because it is neither.
///
/// Overwritten: `meshes`, twice `work.length()` reals: the first holds X_a phi from row to row, the second X_b phi and then the product;
/// `sum`, `brick.reals()` reals: the term's modes; `table`, [`mode_table_length`] values: powers of |n|.
///
/// # Errors
/// As [`Quadratic::check`]; `Range` also where n^|e s| exceeds 1e18 for an exponent of a row; `Brick` for bricks that do not match,
/// `Length`, or what `work` returns.
///
/// Cost: a forward transform of `work` for each row, and inverse ones for those of its factors that the first mesh does not hold
/// yet. A square whose s_out is that of the row before shares its forward transform. Local 1 + 1, equilateral, orthogonal and folded
/// 4 + 3, orthogonal LSS 8 + 6. And as many passes over modes as transforms, one over cells for each row, and 50 ns for each
/// entry of `table` and each transform with s other than 0.
///
/// # Example
/// ```
/// # use fixpair::{exec::Serial, fft::{Tables, Transform}, mesh::{Brick, Space}};
/// # #[repr(align(64))] struct Memory([u8; 1 << 16]);
/// # let (mut tables, mut work) = (Memory([0; 1 << 16]), Memory([0; 1 << 16]));
/// # let tables = Tables::<f64>::new(8, &mut tables.0)?;
/// # let mut fft = Transform::new(&tables, Brick::whole(8, Space::Configuration)?, &mut work.0, &Serial)?;
/// use fixpair::fft::Fft3;
/// use fixpair::initial::shape::{Quadratic, Shape, add_quadratic};
///
/// let (modes, mut phi) = (Brick::whole(8, Space::Fourier)?, vec![0.0; 640]);
/// phi[2] = 0.5; // Phi_G = cos kz
/// let (mut a, mut b, mut sum, mut table) = (vec![0.0; fft.length()], vec![0.0; fft.length()], vec![0.0; 640], [0.0; 49]);
/// let quadratic = Quadratic { f_nl: 0.1, rows: Shape::Local.rows(), n_s: 0.96 };
/// add_quadratic(&mut phi, &modes, &quadratic, &mut fft, [&mut a, &mut b], &mut sum, &mut table, &Serial)?;
/// assert!((phi[4] - 0.1 * 0.25).abs() < 1e-15); // as add_local
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn add_quadratic<T: Real>(
    phi: &mut [T],
    brick: &Brick,
    quadratic: &Quadratic<'_>,
    work: &mut dyn Fft3<T>,
    meshes: [&mut [T]; 2],
    sum: &mut [T],
    table: &mut [f64],
    exec: &dyn Exec,
) -> Result<()> {
    match quadratic_modes(phi, brick, quadratic, work, meshes, sum, table, exec)? {
        Some(scale) => add_modes(phi, brick, sum, brick, &Scale(scale), exec),
        None => Ok(()),
    }
}

/// The modes that [`add_quadratic`] adds, in `sum`, up to the factor that is returned; or `None` if there is nothing to add.
pub(super) fn quadratic_modes<T: Real>(
    phi: &[T],
    brick: &Brick,
    quadratic: &Quadratic<'_>,
    work: &mut dyn Fft3<T>,
    meshes: [&mut [T]; 2],
    sum: &mut [T],
    table: &mut [f64],
    exec: &dyn Exec,
) -> Result<Option<f64>> {
    quadratic.check()?;
    brick.check_space(Space::Fourier)?;
    brick.check_length(phi)?;
    let (n, m) = (brick.n(), work.configuration().n());
    if m != n && m < n / 2 * 3 {
        return Err(Error::Brick);
    }
    quadratic.check_powers(n)?;
    if quadratic.is_gaussian() {
        return Ok(None);
    }
    brick.check_length(sum)?;
    let table = table.get_mut(..mode_table_length(n)?).ok_or(Error::Length)?;
    let length = work.length();
    let [Some(a), Some(b)] = meshes.map(|mesh| mesh.get_mut(..length)) else {
        return Err(Error::Length);
    };
    let (cells, modes) = (*work.configuration(), *work.fourier());
    let mut powers = Powers { exponent: quadratic.exponent(), table, exec };

    // The s of the field in `a`, and the s_out of the product in `b`.
    let (mut held, mut pending) = (None, None);
    let mut empty = true;
    let mut finish =
        |b: &mut [T], s_out: f64, work: &mut dyn Fft3<T>, powers: &mut Powers<'_>| -> Result<()> {
            work.forward(b)?;
            powers.apply(sum, brick, b, &modes, s_out, !core::mem::take(&mut empty))
        };
    for row in quadratic.rows.iter().filter(|row| row.coefficient != 0.0) {
        let joins = row.s_a == row.s_b && pending == Some(row.s_out);
        if let Some(s_out) = pending.filter(|_| !joins) {
            finish(b, s_out, work, &mut powers)?;
        }
        let (first, second) = if held == Some(row.s_b) { (row.s_b, row.s_a) } else { (row.s_a, row.s_b) };
        if held != Some(first) {
            powers.apply(a, &modes, phi, brick, first, false)?;
            work.inverse(a)?;
            held = Some(first);
        }
        if first == second {
            square(b, a, row.coefficient, joins, &cells, exec)?;
        } else {
            powers.apply(b, &modes, phi, brick, second, false)?;
            work.inverse(b)?;
            multiply(b, a, row.coefficient, &cells, exec)?;
        }
        pending = Some(row.s_out);
    }
    if let Some(s_out) = pending {
        finish(b, s_out, work, &mut powers)?;
    }
    Ok(Some(quadratic.f_nl / (m as f64 * m as f64 * m as f64)))
}

/// X_s, by a table that is filled anew for each s.
struct Powers<'a> {
    exponent: f64,
    table: &'a mut [f64],
    exec: &'a dyn Exec,
}

impl Powers<'_> {
    /// to_k <- |n|^(e s) from_k, or to_k <- to_k + that; no mean.
    fn apply<T: Real>(
        &mut self,
        to: &mut [T],
        to_brick: &Brick,
        from: &[T],
        from_brick: &Brick,
        s: f64,
        add: bool,
    ) -> Result<()> {
        let power = self.exponent * s;
        if power == 0.0 {
            let factor = Scale(1.0);
            return if add {
                add_modes(to, to_brick, from, from_brick, &factor, self.exec)
            } else {
                map_modes(to, to_brick, from, from_brick, &factor, self.exec)
            };
        }
        mode_power_table(self.exec, power, self.table)?;
        let factor = ByTable(self.table);
        if add {
            add_modes(to, to_brick, from, from_brick, &factor, self.exec)
        } else {
            map_modes(to, to_brick, from, from_brick, &factor, self.exec)
        }
    }
}

/// b <- c a^2, or b <- b + c a^2.
fn square<T: Real>(b: &mut [T], a: &[T], c: f64, add: bool, cells: &Brick, exec: &dyn Exec) -> Result<()> {
    walk::<T, 1, 1>(exec, cells, [b], [a], &|_, [b], [a]| {
        for (b, a) in b.iter_mut().zip(a) {
            let before = if add { b.to_f64() } else { 0.0 };
            *b = T::from_f64(before + c * a.to_f64() * a.to_f64());
        }
    })
}

/// b <- c a b.
fn multiply<T: Real>(b: &mut [T], a: &[T], c: f64, cells: &Brick, exec: &dyn Exec) -> Result<()> {
    walk::<T, 1, 1>(exec, cells, [b], [a], &|_, [b], [a]| {
        for (b, a) in b.iter_mut().zip(a) {
            *b = T::from_f64(c * a.to_f64() * b.to_f64());
        }
    })
}
