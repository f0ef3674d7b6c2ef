//! Forces on a mesh: from modes of the density to modes of the force.
//!
//! ```text
//! F = -grad inverse-Laplacian delta,     in Fourier space F_k = + i k/k^2 delta_k,
//! ```
//!
//! (Hockney & Eastwood 1988), in the unit of the box side L: for a linear field it is the Zel'dovich displacement x - q itself, and
//! div F = -delta. The peculiar potential is 3/2 Omega_m H0^2/a times [`potential`]. [`ForceLaw`] says how derivatives are taken, what is divided
//! out and what is left to a short-range solver. The laws of known codes, with the window that they deposit with:
//!
//! | code | `laplacian` | `gradient` | `window` | `split_scale` |
//! |---|---|---|---|---|
//! | the default; FastPM `naive` | `Exact` | `Exact` | none | 0 |
//! | FastPM `1_4`; [`ForceLaw::FOUR_POINT`] | `Exact` | `FourPoint` | none | 0 |
//! | FastPM `3_4`; `5_4`; `3_2` | `TwoPoint`; `FourPoint`; `TwoPoint` | `FourPoint`; `FourPoint`; `Exact` | none | 0 |
//! | FastPM `eastwood`; `gadget` | `Exact` | `Exact`; `FourPoint` | (CIC, 2) | 0 |
//! | real-space PM: 7-point Laplacian, centred differences | `TwoPoint` | `TwoPoint` | none | 0 |
//! | Gadget-2's Tree-PM, its mesh part | `Exact` | `FourPoint` | (CIC, 2) | 1.25 L/n |
//!
//! A Tree-PM host adds the short-range force of Springel 2005, astro-ph/0505010, eq. 19-21: its potential is that of a point times erfc(r/2 r_s), so
//! that a pair feels
//!
//! ```text
//! 1/r^2 [erfc(r/2 r_s) + r/(r_s sqrt pi) exp(-r^2/4 r_s^2)]
//! ```
//!
//! of Newton's force directly and the rest from the mesh.
//!
//! Of total weight M, a particle of weight w pulls with w/M L^3/(4 pi r^2). Any of these forces, read out with the window of the deposit, is
//! antisymmetric in the two particles: no self-force, and momentum is conserved to rounding.
//!
//! How near that is to Newton's force in the periodic box, for pairs 3 to 16 cells apart on a mesh of 64^3 (measured; tests hold the averages to 2%): averaged over places and
//! directions, within 1.2% for CIC, TSC and PCS with any gradient but an exact one. R.m.s. of single pairs, as they lie to the mesh, at its largest
//! (3 to 3.5 cells): with `FourPoint` gradients 5% for CIC, 2.2% for TSC and PCS, 1.3% if the Laplacian is `FourPoint` too; 1.8% for PCS with
//! `Exact`, `FourPoint`, (PCS, 1), 0.53 L/n, where no pair beyond 3.5 cells is off by more than 2.1%. What ends at the edge of the mesh's modes
//! without being small there rings along the axes: exact gradients do, and the more so where the window is divided out without a split (CIC, exact:
//! 13%; sharpened: above 100%). With the split 1.25 L/n and `FourPoint` gradients, tree and mesh together are right to 1.2% (CIC), 0.37% (TSC) and
//! 0.35% (PCS) r.m.s. at any separation, and to 0.03% with PCS and exact gradients; without division by the window 5 to 9% too weak.
//!
//! Zero modes: k = 0, for the mean density pulls nowhere; and the Nyquist modes, |n_a| = n/2 on any axis. They stand for two wave vectors at once,
//! which ask for opposite forces, so that an odd derivative has no value there; dropping them from all components and the potential leaves one
//! potential for all three.

use crate::exec::Exec;
use crate::mesh::{Brick, Space};
use crate::real::Real;
use crate::scratch::Layout;
use crate::simd::Simd;
use crate::status::{Error, Result};
use crate::walk::{Run, walk};
use crate::within::Within;

mod law;

use law::Tables;
pub use law::{Difference, ForceLaw};

/// Scratch of [`forces`], [`force`] and [`potential`] on a mesh of side n: 24 n bytes.
///
/// # Errors
/// `Overflow` if the bytes do not fit the address space.
///
/// # Example
/// ```
/// use fixpair::pm::force_scratch;
///
/// assert_eq!(force_scratch(64)?.size, 24 * 64);
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn force_scratch(n: usize) -> Result<Layout> {
    Tables::layout(n)
}

/// All three components in one pass: three forces with two meshes beyond the density's.
///
/// `meshes`: on `brick`, of Fourier space and any layout; the first holds on entry F_k, the un-normalised forward transform of deposited weights. On
/// exit mesh a holds the modes of component a, such that the un-normalised inverse transform gives the force on the cells. `box_size`: L, the unit
/// of the force. `mass`: the sum of all weights, of all processes: delta_k = F_k/mass.
///
/// # Errors
/// `Brick` for a brick of configuration space, `Length` for short arrays; `NotFinite` for the box, the mass or the split scale; `Range` if the box
/// or the mass is not positive, the split scale negative, the power not 1 to 4, or L/(n mass) no normal number; `Scratch`, `Alignment`, `Hook`. The
/// modes themselves are not checked.
///
/// The same bits on any threads and bricks; `f32` modes are the rounded results of `f64` arithmetic. Cost: one pass, which reads one mesh and writes
/// three.
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
/// use fixpair::pm::{ForceLaw, forces};
/// # let mut memory = Memory([0; 1 << 16]);
/// # let scratch = &mut memory.0;
///
/// let (mut y, mut z) = (vec![0.0; fft.length()], vec![0.0; fft.length()]);
/// forces([&mut delta, &mut y, &mut z], &modes, &ForceLaw::default(), 100.0, 1.0, scratch, &Serial)?; // x is the density at first
/// assert!(y[3] == 0.0 && z[3] != 0.0);
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn forces<T: Real>(
    meshes: [&mut [T]; 3],
    brick: &Brick,
    law: &ForceLaw,
    box_size: f64,
    mass: f64,
    scratch: &mut [u8],
    exec: &dyn Exec,
) -> Result<()> {
    forces_with(Simd::detect(), meshes, brick, law, box_size, mass, scratch, exec)
}

pub(super) fn forces_with<T: Real>(
    simd: Simd,
    meshes: [&mut [T]; 3],
    brick: &Brick,
    law: &ForceLaw,
    box_size: f64,
    mass: f64,
    scratch: &mut [u8],
    exec: &dyn Exec,
) -> Result<()> {
    let tables = tables(brick, law, box_size, mass, scratch)?;
    let scale = scale(tables.spacing, mass)?;
    walk::<T, 3, 0>(exec, brick, meshes, [], &|run, mut rows, []| {
        let row = Row::new(&tables, &run, scale);
        simd.vectorise(
            #[inline(always)]
            || row.forces(&mut rows),
        );
        for modes in rows {
            row.drop_zero_modes(modes);
        }
    })
}

/// One component, along `axis` (0, 1, 2), to another mesh: for hosts with one mesh to spare.
///
/// `out`, `density`: on `brick`; the rest as for [`forces`], and the same bits.
///
/// # Errors
/// As [`forces`]; `Range` for an axis above 2.
///
/// Cost: one pass, which reads one mesh and writes one.
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
/// use fixpair::pm::{ForceLaw, force};
/// # let mut memory = Memory([0; 1 << 16]);
/// # let scratch = &mut memory.0;
///
/// let mut along_z = vec![0.0_f64; fft.length()];
/// force(&mut along_z, &delta, &modes, 2, &ForceLaw::default(), 100.0, 1.0, scratch, &Serial)?;
/// assert!(along_z[3].abs() > 0.0 && along_z[2] == 0.0); // i k/k^2 delta
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn force<T: Real>(
    out: &mut [T],
    density: &[T],
    brick: &Brick,
    axis: usize,
    law: &ForceLaw,
    box_size: f64,
    mass: f64,
    scratch: &mut [u8],
    exec: &dyn Exec,
) -> Result<()> {
    force_with(Simd::detect(), out, density, brick, axis, law, box_size, mass, scratch, exec)
}

pub(super) fn force_with<T: Real>(
    simd: Simd,
    out: &mut [T],
    density: &[T],
    brick: &Brick,
    axis: usize,
    law: &ForceLaw,
    box_size: f64,
    mass: f64,
    scratch: &mut [u8],
    exec: &dyn Exec,
) -> Result<()> {
    let tables = tables(brick, law, box_size, mass, scratch)?;
    let scale = scale(tables.spacing, mass)?;
    if axis > 2 {
        return Err(Error::Range);
    }
    walk::<T, 1, 1>(exec, brick, [out], [density], &|run, [out], [density]| {
        let row = Row::new(&tables, &run, scale);
        simd.vectorise(
            #[inline(always)]
            || row.force(out, density, axis),
        );
        row.drop_zero_modes(out);
    })
}

/// The inverse Laplacian of delta, in place: phi_k = -S/(W^power K2) delta_k, in the unit of L^2. For hosts that take differences in real space, and
/// for energies.
///
/// `modes`: on `brick`, F_k as for [`forces`]; the law's gradient does not matter. Real-space differences of it are the forces of the law with that
/// gradient.
///
/// # Errors
/// As [`forces`], with L^2/(n^2 mass) a normal number too.
///
/// Cost: one pass over one mesh.
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
/// use fixpair::pm::{ForceLaw, potential};
/// # let mut memory = Memory([0; 1 << 16]);
/// # let scratch = &mut memory.0;
///
/// potential(&mut delta, &modes, &ForceLaw::default(), 100.0, 1.0, scratch, &Serial)?;
/// let k = std::f64::consts::TAU / 100.0;
/// assert!((delta[2] + 0.01 / (k * k)).abs() < 1e-10); // -delta/k^2
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn potential<T: Real>(
    modes: &mut [T],
    brick: &Brick,
    law: &ForceLaw,
    box_size: f64,
    mass: f64,
    scratch: &mut [u8],
    exec: &dyn Exec,
) -> Result<()> {
    potential_with(Simd::detect(), modes, brick, law, box_size, mass, scratch, exec)
}

pub(super) fn potential_with<T: Real>(
    simd: Simd,
    modes: &mut [T],
    brick: &Brick,
    law: &ForceLaw,
    box_size: f64,
    mass: f64,
    scratch: &mut [u8],
    exec: &dyn Exec,
) -> Result<()> {
    let tables = tables(brick, law, box_size, mass, scratch)?;
    let scale = scale(tables.spacing * tables.spacing, mass)?;
    walk::<T, 1, 0>(exec, brick, [modes], [], &|run, [modes], []| {
        let row = Row::new(&tables, &run, scale);
        simd.vectorise(
            #[inline(always)]
            || row.potential(modes),
        );
        row.drop_zero_modes(modes);
    })
}

/// What is checked before anything is written. Lengths are, by the walk.
fn tables<'a>(
    brick: &Brick,
    law: &ForceLaw,
    box_size: f64,
    mass: f64,
    scratch: &'a mut [u8],
) -> Result<Tables<'a>> {
    brick.check_space(Space::Fourier)?;
    if !mass.is_finite() {
        return Err(Error::NotFinite);
    }
    if mass <= 0.0 {
        return Err(Error::Range);
    }
    Tables::new(brick.n(), law, box_size, scratch)
}

/// unit/mass, if it is worth multiplying by.
fn scale(unit: f64, mass: f64) -> Result<f64> {
    let scale = unit / mass;
    if scale.is_normal() { Ok(scale) } else { Err(Error::Range) }
}

/// Modes whose factors are computed at a time.
const BLOCK: usize = 32;

/// What the modes of one run are multiplied by.
struct Row<'a> {
    /// Modes before the Nyquist mode.
    inside: usize,
    /// Does it begin with k = 0?
    mean: bool,
    /// scale S/W^power of the axes across.
    across: f64,
    /// K2 of the axes across.
    laplacian: f64,
    /// K_a of the axes across.
    gradient: [f64; 2],
    /// K_z, K2 and S/W^power of the modes along the run.
    along: [&'a [f64]; 3],
}

impl<'a> Row<'a> {
    fn new(tables: &Tables<'a>, run: &Run, scale: f64) -> Self {
        let [x, y, z] = run.index;
        let inside = tables.inside(run.index, run.length);
        let along = [tables.gradient, tables.laplacian, tables.factor].map(|table| table.part(z..z + inside));
        Self {
            inside,
            mean: run.index == [0; 3] && inside > 0,
            across: scale * (tables.factor.at(x) * tables.factor.at(y)),
            laplacian: tables.laplacian.at(x) + tables.laplacian.at(y),
            gradient: [tables.gradient.at(x), tables.gradient.at(y)],
            along,
        }
    }

    /// Calls `body` for the modes `first..last` of each block with their scale S/(W^power K2); infinite at k = 0.
    #[inline(always)]
    fn blocks(&self, mut body: impl FnMut(usize, usize, &[f64; BLOCK])) {
        let mut inverse = [0.0; BLOCK];
        let [_, laplacian, factor] = self.along;
        for first in (0..self.inside).step_by(BLOCK) {
            let last = self.inside.min(first + BLOCK);
            for ((inverse, laplacian), factor) in
                inverse.iter_mut().zip(laplacian.part(first..last)).zip(factor.part(first..last))
            {
                *inverse = self.across * factor / (self.laplacian + laplacian);
            }
            body(first, last, &inverse);
        }
    }

    #[inline(always)]
    fn forces<T: Real>(&self, [x, y, z]: &mut [&mut [T]; 3]) {
        let [gradient, ..] = self.along;
        self.blocks(|first, last, inverse| {
            let [x, y, z] = [&mut *x, &mut *y, &mut *z]
                .map(|modes| modes.part_mut(2 * first..2 * last).as_chunks_mut::<2>().0.iter_mut());
            for ((((x, y), z), inverse), along) in
                x.zip(y).zip(z).zip(inverse).zip(gradient.part(first..last))
            {
                let density = *x;
                *x = turned(inverse * self.gradient[0], density);
                *y = turned(inverse * self.gradient[1], density);
                *z = turned(inverse * along, density);
            }
        });
    }

    #[inline(always)]
    fn force<T: Real>(&self, out: &mut [T], density: &[T], axis: usize) {
        let [gradient, ..] = self.along;
        self.blocks(|first, last, inverse| {
            let out = out.part_mut(2 * first..2 * last).as_chunks_mut::<2>().0.iter_mut();
            let density = density.part(2 * first..2 * last).as_chunks::<2>().0;
            if let Some(gradient) = self.gradient.get(axis) {
                for ((out, &density), inverse) in out.zip(density).zip(inverse) {
                    *out = turned(inverse * gradient, density);
                }
            } else {
                for (((out, &density), inverse), along) in
                    out.zip(density).zip(inverse).zip(gradient.part(first..last))
                {
                    *out = turned(inverse * along, density);
                }
            }
        });
    }

    #[inline(always)]
    fn potential<T: Real>(&self, modes: &mut [T]) {
        self.blocks(|first, last, inverse| {
            let modes = modes.part_mut(2 * first..2 * last).as_chunks_mut::<2>().0;
            for (mode, inverse) in modes.iter_mut().zip(inverse) {
                *mode = mode.map(|part| T::from_f64(-inverse * part.to_f64()));
            }
        });
    }

    /// k = 0 and the Nyquist modes.
    fn drop_zero_modes<T: Real>(&self, modes: &mut [T]) {
        modes.part_mut(2 * self.inside..).fill(T::ZERO);
        if self.mean {
            modes.part_mut(..2).fill(T::ZERO);
        }
    }
}

/// i scale mode.
#[inline(always)]
fn turned<T: Real>(scale: f64, [re, im]: [T; 2]) -> [T; 2] {
    [T::from_f64(-scale * im.to_f64()), T::from_f64(scale * re.to_f64())]
}
