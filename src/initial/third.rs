//! Lagrangian perturbation theory to third order, with products free of aliasing.
//!
//! With the potentials phi1, phi2 of the density and of the second-order source, nabla^2 phi1 = delta, nabla^2 phi2 = S, and
//! their second differences p_ab = d_a d_b phi1, q_ab = d_a d_b phi2 (Bouchet et al. 1995, astro-ph/9406013; Catelan 1995,
//! astro-ph/9406016; Michaux et al. 2021, arXiv:2008.09588, section 2), Psi3 is the sum of
//!
//! ```text
//! Psi3a_k = (D3a/D^3) i k/k^2 A_k,      A = det p
//! Psi3b_k = (D3b/D^3) i k/k^2 B_k,      B = p_aa q_bb - p_ab q_ab
//! Psi3c_k = (D3c/D^3) i k x C_k/k^2,    C_i = eps_ijk p_lj q_lk
//! ```
//!
//! (repeated indices summed). D3a, D3b, D3c are those of [growth](mod@crate::cosmology::growth); in an Einstein-de Sitter universe their ratios to D^3 are -1/3,
//! 5/21 and 1/7. The third, transverse in Lagrangian space, is what keeps the flow free of vorticity in Eulerian space. A sphere
//! contracts by R/q = 1 - delta/3 - delta^2/21 - 23 delta^3/1701, as the exact solution expanded.
//!
//! All products are exact, by [`super::shifted`]: S as well, unlike that of [`super::lpt`], whose aliasing the work mesh decides.

use super::lpt::InverseGradient;
use super::modes::add_modes;
use super::shifted::{HalfCells, SHIFTS, gather_shift, half_cells_length, tidal_tensor};
use crate::exec::Exec;
use crate::fft::Fft3;
use crate::mesh::Brick;
use crate::real::Real;
use crate::scratch::Layout;
use crate::status::{Error, Result};
use crate::walk::walk;
use crate::within::Within;

/// Meshes that [`second_order_exact`] works on.
pub const SECOND_ORDER_MESHES: usize = 6;
/// Meshes that [`third_order_sources`] works on.
pub const THIRD_ORDER_MESHES: usize = 12;

/// The modes of S = sum_{a<b} (p_aa p_bb - p_ab^2), without aliasing.
///
/// `out`, `density`: modes on the Fourier brick of `fft`. `meshes`: `fft.length()` reals each, overwritten. `table`:
/// [`half_cells_length`] entries.
///
/// # Errors
/// `Length` for short arrays, or what `fft` and `exec` return.
///
/// Cost: 56 transforms, 24 passes.
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
/// use fixpair::initial::{shifted::half_cells_length, third::second_order_exact};
///
/// let mut out = vec![0.0; fft.length()];
/// let mut meshes = core::array::from_fn(|_| vec![0.0; fft.length()]);
/// let mut table = vec![[0.0; 2]; half_cells_length(8)];
/// second_order_exact(&mut out, &delta, &mut fft, meshes.each_mut().map(|mesh| &mut mesh[..]), &mut table, &Serial)?;
/// assert!(out.iter().all(|s| s.abs() < 1e-12)); // none of a plane wave
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn second_order_exact<T: Real>(
    out: &mut [T],
    density: &[T],
    fft: &mut dyn Fft3<T>,
    meshes: [&mut [T]; SECOND_ORDER_MESHES],
    table: &mut [[f64; 2]],
    exec: &dyn Exec,
) -> Result<()> {
    let (cells, modes) = (*fft.configuration(), *fft.fourier());
    let (scale, half_cells) = prepare(&modes, table)?;
    let mut meshes = exact_length(meshes, fft.length())?;
    for shift in 0..SHIFTS {
        tidal_tensor(meshes.each_mut().map(|mesh| &mut **mesh), density, &modes, shift, half_cells, exec)?;
        for mesh in &mut meshes {
            fft.inverse(mesh)?;
        }
        let [xx, yy, zz, xy, xz, yz] = meshes.each_mut();
        walk::<T, 1, 5>(exec, &cells, [xx], [yy, zz, xy, xz, yz], &|_, [sum], rows| {
            for (i, s) in sum.iter_mut().enumerate() {
                let [yy, zz, xy, xz, yz] = rows.map(|row| row.at(i));
                *s = *s * (yy + zz) + yy * zz - (xy * xy + xz * xz + yz * yz);
            }
        })?;
        fft.forward(meshes[0])?;
        gather_shift([&mut *out], [&*meshes[0]], &modes, scale, shift, half_cells, exec)?;
    }
    Ok(())
}

/// The sources of the third order.
///
/// `out`: modes of A, B, C_x, C_y and C_z; `density` and `second`: those of delta and S; all on the Fourier brick of `fft`.
/// `meshes`: `fft.length()` reals each, overwritten. `table`: [`half_cells_length`] entries.
///
/// # Errors
/// As [`second_order_exact`].
///
/// Cost: 136 transforms, which with the passes between them take as long as about 200.
///
/// # Example
/// ```
/// # use fixpair::{exec::Serial, fft::{Fft3, Tables, Transform}, mesh::{Brick, Space}};
/// # #[repr(align(64))] struct Memory([u8; 1 << 16]);
/// # let (mut tables, mut work) = (Memory([0; 1 << 16]), Memory([0; 1 << 16]));
/// # let tables = Tables::<f64>::new(8, &mut tables.0)?;
/// # let mut fft = Transform::new(&tables, Brick::whole(8, Space::Configuration)?, &mut work.0, &Serial)?;
/// use fixpair::initial::{shifted::half_cells_length, third::third_order_sources};
///
/// let mut delta = vec![0.0; fft.length()];
/// delta[2] = 0.01; // the mode (0, 0, 1) of a density contrast
/// let second = vec![0.0; fft.length()]; // second_order_exact gives none for it
/// let mut sources: [_; 5] = core::array::from_fn(|_| vec![1.0; fft.length()]);
/// let mut meshes: [_; 12] = core::array::from_fn(|_| vec![0.0; fft.length()]);
/// let (out, meshes) = (sources.each_mut().map(|mesh| &mut mesh[..]), meshes.each_mut().map(|mesh| &mut mesh[..]));
/// let mut table = vec![[0.0; 2]; half_cells_length(8)];
/// third_order_sources(out, &delta, &second, &mut fft, meshes, &mut table, &Serial)?;
/// // Nor is there any of the third order.
/// let brick = *fft.fourier();
/// assert!(sources.iter().all(|source| source.iter().take(brick.reals()).all(|part| part.abs() < 1e-12)));
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn third_order_sources<T: Real>(
    mut out: [&mut [T]; 5],
    density: &[T],
    second: &[T],
    fft: &mut dyn Fft3<T>,
    meshes: [&mut [T]; THIRD_ORDER_MESHES],
    table: &mut [[f64; 2]],
    exec: &dyn Exec,
) -> Result<()> {
    let (cells, modes) = (*fft.configuration(), *fft.fourier());
    let (scale, half_cells) = prepare(&modes, table)?;
    let mut meshes = exact_length(meshes, fft.length())?;
    for shift in 0..SHIFTS {
        let [a, b, c, d, e, f, g, h, i, j, k, l] = meshes.each_mut().map(|mesh| &mut **mesh);
        tidal_tensor([a, b, c, d, e, f], density, &modes, shift, half_cells, exec)?;
        tidal_tensor([g, h, i, j, k, l], second, &modes, shift, half_cells, exec)?;
        for mesh in &mut meshes {
            fft.inverse(mesh)?;
        }
        let [a, b, c, d, e, f, g, h, i, j, k, l] = meshes.each_mut().map(|mesh| &mut **mesh);
        walk::<T, 5, 7>(exec, &cells, [a, b, c, d, e], [f, g, h, i, j, k, l], &|_, mut sources, rows| {
            for x in 0..rows[0].len() {
                let [a, b, c, d, e] = sources.each_ref().map(|row| row.at(x));
                let [f, q @ ..] = rows.map(|row| row.at(x));
                for (source, value) in sources.iter_mut().zip(products([a, b, c, d, e, f], q)) {
                    source.put(x, value);
                }
            }
        })?;
        for mesh in &mut meshes[..5] {
            fft.forward(mesh)?;
        }
        let [a, b, c, d, e, ..] = meshes.each_ref().map(|mesh| &**mesh);
        let sums = out.each_mut().map(|mesh| &mut **mesh);
        gather_shift(sums, [a, b, c, d, e], &modes, scale, shift, half_cells, exec)?;
    }
    Ok(())
}

/// Scratch of [`second_order_exact`] followed by [`third_order_sources`]: twelve meshes and the table.
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
/// use fixpair::initial::third::third_order_scratch;
///
/// assert_eq!(third_order_scratch::<f64>(&fft)?.align, 64);
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn third_order_scratch<T: Real>(fft: &dyn Fft3<T>) -> Result<Layout> {
    let table = Layout::EMPTY.and::<[f64; 2]>(half_cells_length(fft.configuration().n()))?;
    (0..THIRD_ORDER_MESHES).try_fold(table, |layout, _| layout.and::<T>(fft.length()))
}

/// One component of the transverse displacement: out_k <- `scale` i (n x C_k)_axis/|n|^2, then to configuration space. With `scale` =
/// (D3c/D^3) L/(2 pi) this is Psi3c in units of L.
///
/// `out`: `fft.length()` reals, on return one component on the cells of `fft`; `curl`: modes of C on its Fourier brick.
///
/// # Errors
/// `Range` for an axis above 2, `NotFinite` for the scale, `Length`, or what `fft` returns.
///
/// Cost: three passes and one transform.
///
/// # Example
/// ```
/// # use fixpair::{exec::Serial, fft::{Fft3, Tables, Transform}, mesh::{Brick, Space}};
/// # #[repr(align(64))] struct Memory([u8; 1 << 16]);
/// # let (mut tables, mut work) = (Memory([0; 1 << 16]), Memory([0; 1 << 16]));
/// # let tables = Tables::<f64>::new(8, &mut tables.0)?;
/// # let mut fft = Transform::new(&tables, Brick::whole(8, Space::Configuration)?, &mut work.0, &Serial)?;
/// use fixpair::initial::third::transverse_displacement;
///
/// let (mut x, zero) = (vec![0.0; fft.length()], vec![0.0; fft.length()]);
/// x[2] = 0.5; // C = (cos 2 pi z, 0, 0)
/// let mut y = vec![0.0_f64; fft.length()];
/// transverse_displacement(&mut y, [&x, &zero, &zero], 1, 1.0, &mut fft, &Serial)?;
/// assert!((y[2] + 1.0).abs() < 1e-12 && y[0].abs() < 1e-12); // along y: -sin 2 pi z, at z = 1/4 and 0
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn transverse_displacement<T: Real>(
    out: &mut [T],
    curl: [&[T]; 3],
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
    if out.len() != fft.length() {
        return Err(Error::Length);
    }
    let modes = *fft.fourier();
    for component in curl {
        modes.check_length(component)?;
    }
    out.fill(T::ZERO);
    add_transverse(out, curl, axis, scale, &modes, exec)?;
    fft.inverse(out)
}

/// to_k <- to_k + `scale` i (n x C_k)_axis/|n|^2.
pub(super) fn add_transverse<T: Real>(
    to: &mut [T],
    curl: [&[T]; 3],
    axis: usize,
    scale: f64,
    modes: &Brick,
    exec: &dyn Exec,
) -> Result<()> {
    let (b, c) = ((axis + 1) % 3, (axis + 2) % 3);
    add_modes(to, modes, curl[c], modes, &InverseGradient::new(b, scale), exec)?;
    add_modes(to, modes, curl[b], modes, &InverseGradient::new(c, -scale), exec)
}

/// A, B, C of one cell.
#[inline(always)]
fn products<T: Real>(p: [T; 6], q: [T; 6]) -> [T; 5] {
    let [xx, yy, zz, xy, xz, yz] = p;
    let [q_xx, q_yy, q_zz, q_xy, q_xz, q_yz] = q;
    let determinant = xx * (yy * zz - yz * yz) - xy * (xy * zz - xz * yz) + xz * (xy * yz - yy * xz);
    let off_diagonal = xy * q_xy + xz * q_xz + yz * q_yz;
    let mixed = xx * (q_yy + q_zz) + yy * (q_xx + q_zz) + zz * (q_xx + q_yy) - (off_diagonal + off_diagonal);
    [
        determinant,
        mixed,
        xy * q_xz - xz * q_xy + (yy - zz) * q_yz - yz * (q_yy - q_zz),
        yz * q_xy - xy * q_yz + (zz - xx) * q_xz - xz * (q_zz - q_xx),
        xz * q_yz - yz * q_xz + (xx - yy) * q_xy - xy * (q_xx - q_yy),
    ]
}

/// The factor of each transform, and the table of shifts.
fn prepare<'a>(modes: &Brick, table: &'a mut [[f64; 2]]) -> Result<(f64, HalfCells<'a>)> {
    let n = modes.n() as f64;
    Ok((1.0 / (SHIFTS as f64 * (n * n * n)), HalfCells::new(table, modes.n())?))
}

/// The first `length` reals of each mesh.
fn exact_length<T, const K: usize>(meshes: [&mut [T]; K], length: usize) -> Result<[&mut [T]; K]> {
    if meshes.iter().any(|mesh| mesh.len() < length) {
        return Err(Error::Length);
    }
    Ok(meshes.map(|mesh| &mut mesh[..length]))
}
