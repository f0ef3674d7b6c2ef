//! Lagrangian perturbation theory to second order, from the modes of the linear density at the starting time.
//!
//! x = q + Psi1 + Psi2, with (Bouchet et al. 1995, astro-ph/9406013; Scoccimarro 1998, astro-ph/9711187)
//!
//! Psi1_k = i k/k^2 delta_k,     Psi2_k = -(D2/D^2) i k/k^2 S_k,
//! S(q) = sum_{a<b} [phi_aa phi_bb - phi_ab^2],     phi_ab,k = k_a k_b/k^2 delta_k,
//!
//! where D2/D^2 is near -3/7. Velocities are v = a H (f1 Psi1 + f2 Psi2). Lengths are in units of the box through a factor
//! L/(2 pi), since k = (2 pi/L) n. Modes with a Nyquist component move nothing.

use super::modes::{Copy, Factor, Scale, map_modes};
use crate::exec::Exec;
use crate::fft::Fft3;
use crate::mesh::{Brick, Space};
use crate::real::Real;
use crate::status::{Error, Result};
use crate::walk::walk;

/// The unit vector along an axis. n_a as a product with it costs less than picking a component in a loop over modes.
fn along(axis: usize) -> [f64; 3] {
    core::array::from_fn(|i| if i == axis { 1.0 } else { 0.0 })
}

#[inline(always)]
fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// i n_a/|n|^2 times a scale: minus the gradient of the inverse Laplacian, in units of L/(2 pi).
pub(super) struct InverseGradient {
    along: [f64; 3],
    scale: f64,
}

impl InverseGradient {
    pub(super) fn new(axis: usize, scale: f64) -> Self {
        Self { along: along(axis), scale }
    }
}

impl Factor for InverseGradient {
    const IMAGINARY: bool = true;

    #[inline(always)]
    fn at(&self, n: [f64; 3]) -> f64 {
        self.scale * dot(n, self.along) / dot(n, n).max(1.0)
    }
}

/// n_a n_b/|n|^2: the tidal tensor of the inverse Laplacian.
struct Tidal([f64; 3], [f64; 3]);

impl Factor for Tidal {
    const IMAGINARY: bool = false;

    #[inline(always)]
    fn at(&self, n: [f64; 3]) -> f64 {
        dot(n, self.0) * dot(n, self.1) / dot(n, n).max(1.0)
    }
}

/// One component of the displacement whose divergence is -`source`: out_k <- `scale` i n_a/|n|^2 source_k, then to
/// configuration space. With `scale` = L/(2 pi) and the linear density as source this is Psi1 in units of L; with
/// -(D2/D^2) L/(2 pi) and the source of [`second_order_source`] it is Psi2.
///
/// `out`: `fft.length()` reals, on return one component on the cells of `fft`; `source`: modes of `brick`, whose side is that of
/// `fft` or more.
///
/// # Errors
/// `Range` for an axis above 2, `NotFinite` for the scale, `Brick` for bricks that do not match, `Length`, or what `fft` returns.
///
/// Cost: one pass and one transform.
///
/// # Example
/// ```
/// # use fixpair::{exec::Serial, fft::{Fft3, Tables, Transform}, mesh::{Brick, Space}};
/// # #[repr(align(64))] struct Memory([u8; 1 << 16]);
/// # let (mut tables, mut work) = (Memory([0; 1 << 16]), Memory([0; 1 << 16]));
/// # let tables = Tables::<f64>::new(8, &mut tables.0)?;
/// # let mut fft = Transform::new(&tables, Brick::whole(8, Space::Configuration)?, &mut work.0, &Serial)?;
/// let modes = Brick::whole(8, Space::Fourier)?;
/// let mut delta = vec![0.0; fft.length()];
/// delta[2] = 0.01; // the mode (0, 0, 1) of a density contrast
/// use fixpair::initial::lpt::displacement;
///
/// let (mut psi, scale) = (vec![0.0; fft.length()], 100.0 / std::f64::consts::TAU); // L/(2 pi), L = 100 Mpc/h
/// displacement(&mut psi, &delta, &modes, 2, scale, &mut fft, &Serial)?; // along z
/// assert!((psi[2] + 2.0 * 0.01 * scale).abs() < 1e-12); // delta = 0.02 cos kz gives -0.02 L/(2 pi) sin kz
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn displacement<T: Real>(
    out: &mut [T],
    source: &[T],
    brick: &Brick,
    axis: usize,
    scale: f64,
    fft: &mut dyn Fft3<T>,
    exec: &dyn Exec,
) -> Result<()> {
    if axis > 2 {
        return Err(Error::Range);
    }
    if !scale.is_finite() {
        return Err(Error::NotFinite);
    }
    let modes = *fft.fourier();
    if modes.n() > brick.n() {
        return Err(Error::Brick);
    }
    // Before the first mode is written: the transform would find it too late.
    if out.len() != fft.length() {
        return Err(Error::Length);
    }
    map_modes(out, &modes, source, brick, &InverseGradient::new(axis, scale), exec)?;
    fft.inverse(out)
}

/// The modes of S, the source of the second order.
///
/// `out`: modes of S on `brick`; `density`: modes of delta on the same brick. `work`: the transform on which products are taken, and
/// `meshes`, three arrays of `work.length()` reals, overwritten; one of the side of `brick` leaves aliased modes in,
/// one of side 3N/2 or more is free of them, anything in between is refused.
/// `out` is written last and may be the caller's fourth array; nothing is read from it.
///
/// # Errors
/// `Brick` for bricks that do not match, `Length`, or what `work` returns.
///
/// Cost: six inverse and one forward transform of `work`, and 13 passes.
///
/// # Example
/// ```
/// # use fixpair::{exec::Serial, fft::{Fft3, Tables, Transform}, mesh::{Brick, Space}};
/// # #[repr(align(64))] struct Memory([u8; 1 << 16]);
/// # let (mut tables, mut work) = (Memory([0; 1 << 16]), Memory([0; 1 << 16]));
/// # let tables = Tables::<f64>::new(8, &mut tables.0)?;
/// # let mut fft = Transform::new(&tables, Brick::whole(8, Space::Configuration)?, &mut work.0, &Serial)?;
/// let modes = Brick::whole(8, Space::Fourier)?;
/// let mut delta = vec![0.0; fft.length()];
/// delta[2] = 0.01; // the mode (0, 0, 1) of a density contrast
/// use fixpair::initial::lpt::second_order_source;
///
/// let (mut source, mut a, mut b, mut c) = (delta.clone(), delta.clone(), delta.clone(), delta.clone());
/// second_order_source(&mut source, &delta, &modes, &mut fft, [&mut a, &mut b, &mut c], &Serial)?;
/// assert!(source.iter().all(|s| s.abs() < 1e-12)); // none of a plane wave: Zel'dovich is exact
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn second_order_source<T: Real>(
    out: &mut [T],
    density: &[T],
    brick: &Brick,
    work: &mut dyn Fft3<T>,
    meshes: [&mut [T]; 3],
    exec: &dyn Exec,
) -> Result<()> {
    brick.check_space(Space::Fourier)?;
    brick.check_length(out)?;
    let [sum, a, b] = meshes;
    second_order_products(density, brick, work, [&mut *sum, a, b], exec)?;
    let m = work.configuration().n() as f64;
    let modes = *work.fourier();
    map_modes(out, brick, sum, &modes, &Scale(1.0 / (m * m * m)), exec)
}

/// As [`second_order_products`] with one mesh less and one transform more: S = (delta^2 - sum_a phi_aa^2)/2 - sum_{a<b} phi_ab^2.
pub(crate) fn second_order_squares<T: Real>(
    density: &[T],
    brick: &Brick,
    work: &mut dyn Fft3<T>,
    meshes: [&mut [T]; 2],
    exec: &dyn Exec,
) -> Result<()> {
    let (cells, modes, length) = (*work.configuration(), *work.fourier(), work.length());
    let [Some(sum), Some(a)] = meshes.map(|mesh| mesh.get_mut(..length)) else {
        return Err(Error::Length);
    };
    map_modes(sum, &modes, density, brick, &Copy, exec)?;
    work.inverse(sum)?;
    let half = T::from_f64(0.5);
    walk::<T, 1, 0>(exec, &cells, [sum], [], &|_, [sum], []| {
        for s in sum {
            *s = half * *s * *s;
        }
    })?;
    for (i, j) in [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)] {
        map_modes(a, &modes, density, brick, &Tidal(along(i), along(j)), exec)?;
        work.inverse(a)?;
        let weight = if i == j { half } else { T::ONE };
        walk::<T, 1, 1>(exec, &cells, [sum], [a], &|_, [sum], [a]| {
            for (s, a) in sum.iter_mut().zip(a) {
                *s -= weight * *a * *a;
            }
        })?;
    }
    work.forward(sum)
}

/// S, left as the un-normalised modes of the side of `work` in the first of `meshes`.
pub(crate) fn second_order_products<T: Real>(
    density: &[T],
    brick: &Brick,
    work: &mut dyn Fft3<T>,
    meshes: [&mut [T]; 3],
    exec: &dyn Exec,
) -> Result<()> {
    let (cells, modes) = (*work.configuration(), *work.fourier());
    let (n, m) = (brick.n(), cells.n());
    if m != n && 2 * m < 3 * n {
        return Err(Error::Brick);
    }
    let length = work.length();
    let [Some(sum), Some(a), Some(b)] = meshes.map(|mesh| mesh.get_mut(..length)) else {
        return Err(Error::Length);
    };
    let tidal = |out: &mut [T], i: usize, j: usize, work: &mut dyn Fft3<T>| -> Result<()> {
        map_modes(out, &modes, density, brick, &Tidal(along(i), along(j)), exec)?;
        work.inverse(out)
    };
    tidal(a, 0, 0, work)?;
    tidal(b, 1, 1, work)?;
    walk::<T, 2, 1>(exec, &cells, [sum, a], [b], &|_, [sum, a], [b]| {
        for ((s, a), b) in sum.iter_mut().zip(a).zip(b) {
            *s = *a * *b;
            *a += *b;
        }
    })?;
    tidal(b, 2, 2, work)?;
    walk::<T, 1, 2>(exec, &cells, [sum], [a, b], &|_, [sum], [a, b]| {
        for ((s, a), b) in sum.iter_mut().zip(a).zip(b) {
            *s += *a * *b;
        }
    })?;
    tidal(a, 0, 1, work)?;
    tidal(b, 0, 2, work)?;
    walk::<T, 1, 2>(exec, &cells, [sum], [a, b], &|_, [sum], [a, b]| {
        for ((s, a), b) in sum.iter_mut().zip(a).zip(b) {
            *s -= *a * *a + *b * *b;
        }
    })?;
    tidal(a, 1, 2, work)?;
    walk::<T, 1, 1>(exec, &cells, [sum], [a], &|_, [sum], [a]| {
        for (s, a) in sum.iter_mut().zip(a) {
            *s -= *a * *a;
        }
    })?;
    work.forward(sum)
}
