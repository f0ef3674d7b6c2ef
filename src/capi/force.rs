//! Forces on a mesh.

use core::ffi::c_void;

use super::border::Border;
use super::exec::{HostExec, fixpair_exec};
use super::mesh::fixpair_brick;
use super::status::{code, fixpair_status_t};
use crate::pm::{self, Difference, ForceLaw, Window};
use crate::real::Real;
use crate::scratch::Layout;
use crate::status::{Error, Result};

/// Spectral: i k and k^2.
pub const FIXPAIR_DIFFERENCE_EXACT: i32 = 0;
/// The nearest neighbour on either side: i sin(theta)/H and (2/H)^2 sin^2(theta/2), theta = k_a H, H = L/n. Second order.
pub const FIXPAIR_DIFFERENCE_TWO_POINT: i32 = 1;
/// Two neighbours on either side: i (8 sin theta - sin 2 theta)/(6 H) and (15 - 16 cos theta + cos 2 theta)/(6 H^2). Fourth order.
pub const FIXPAIR_DIFFERENCE_FOUR_POINT: i32 = 2;

/// The force on a mesh: what the modes of the density contrast delta are multiplied by.
///
///    phi_k = - S(k) / (W(k)^power K2(k)) delta_k,    F_k = - i K_a(k) phi_k,    S(k) = exp(-k^2 r_s^2)
///
/// K2 is minus the Laplacian, i K_a the gradient. The laws of known codes (EXACT stands for FIXPAIR_DIFFERENCE_EXACT, init for
/// fixpair_force_law_init):
///
///    code                                 laplacian   gradient    window, power   split_scale
///    (init); FastPM naive                 EXACT       EXACT       none            0
///    FastPM 1_4, fixpair_gravity_init     EXACT       FOUR_POINT  none            0
///    FastPM 3_4                           TWO_POINT   FOUR_POINT  none            0
///    FastPM 5_4                           FOUR_POINT  FOUR_POINT  none            0
///    FastPM 3_2                           TWO_POINT   EXACT       none            0
///    FastPM eastwood                      EXACT       EXACT       CIC, 2          0
///    FastPM gadget                        EXACT       FOUR_POINT  CIC, 2          0
///    7-point Laplacian, centred differences
///    in real space                        TWO_POINT   TWO_POINT   none            0
///    Gadget-2's Tree-PM, its mesh part    EXACT       FOUR_POINT  CIC, 2          1.25 L/n
///
/// A Tree-PM host adds 1/r^2 [erfc(r/2 r_s) + r/(r_s sqrt pi) exp(-r^2/4 r_s^2)] of Newton's force for near pairs (Springel 2005,
/// astro-ph/0505010, eq. 19-21).
///
/// Error of a pair's force between 3 and 3.5 cells, r.m.s. over places and directions (less beyond): with FOUR_POINT gradients CIC 5%, TSC and PCS
/// 2.2%, 1.3% if the Laplacian is FOUR_POINT too; 1.8% for PCS with EXACT, FOUR_POINT, (PCS, 1), 0.53 L/n. An EXACT gradient rings along the axes
/// unless a split smooths it, and more so with a window divided out. Tree and mesh with a split of 1.25 L/n: 1.2% (CIC), 0.4% (TSC, PCS), 0.03% with
/// PCS and EXACT; 5 to 9% too weak if the window is not divided out.
///
/// Fill it with fixpair_force_law_init, then change what is to be otherwise. Functions refuse with FIXPAIR_ERROR_VERSION, _CHOICE and
/// _NOT_FINITE what these say, and with FIXPAIR_ERROR_RANGE a power that is not 1 to 4 or a negative split scale.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct fixpair_force_law {
    /// sizeof(fixpair_force_law).
    pub struct_size: usize,
    /// K2: FIXPAIR_DIFFERENCE_...
    pub laplacian: i32,
    /// K_a: FIXPAIR_DIFFERENCE_...
    pub gradient: i32,
    /// W: 0 for none, or FIXPAIR_WINDOW_..., the window of the deposit.
    pub window: i32,
    /// 1 undoes the smoothing of the deposit, 2 that of the deposit and the read-out; means nothing without a window.
    pub window_power: i32,
    /// r_s, in the unit of the box: 0 for the whole force. A Gaussian filter of dispersion s in x is s/sqrt 2.
    pub split_scale: f64,
}

impl fixpair_force_law {
    /// The law of `fixpair_force_law_init`.
    pub(super) fn initial() -> Self {
        let law = ForceLaw::default();
        Self {
            struct_size: size_of::<Self>(),
            laplacian: law.laplacian as i32,
            gradient: law.gradient as i32,
            window: 0,
            window_power: 2,
            split_scale: law.split_scale,
        }
    }

    pub(super) fn check(&self) -> Result<ForceLaw> {
        let Self { struct_size, laplacian, gradient, window, window_power, split_scale } = *self;
        if struct_size != size_of::<Self>() {
            return Err(Error::Version);
        }
        let window = match window {
            0 => None,
            _ => Some((Window::try_from(window)?, u32::try_from(window_power).map_err(|_| Error::Range)?)),
        };
        let (laplacian, gradient) = (Difference::try_from(laplacian)?, Difference::try_from(gradient)?);
        Ok(ForceLaw { laplacian, gradient, window, split_scale })
    }
}

/// The whole force, exact derivatives, no window; window_power is 2, so that setting window is enough to sharpen.
///
/// Out: law
/// Returns: 0, FIXPAIR_ERROR_NULL, _ALIGNMENT
///
/// # Safety
/// `law` is null or points to a law.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_force_law_init(law: *mut fixpair_force_law) -> fixpair_status_t {
    code((|| {
        // SAFETY: the caller's promise.
        let law = unsafe { Border::new().write_one(law) }?;
        *law = fixpair_force_law::initial();
        Ok(())
    })())
}

/// Scratch of fixpair_forces_*, fixpair_force_* and fixpair_potential_*: 24 n bytes.
///
/// Out: scratch
/// In:  n  cells on a side
/// Returns: 0, FIXPAIR_ERROR_NULL, _ALIGNMENT, _OVERFLOW
///
/// # Safety
/// `scratch` is null or points to one value.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_force_scratch(scratch: *mut Layout, n: usize) -> fixpair_status_t {
    code((|| {
        // SAFETY: the caller's promise.
        let scratch = unsafe { Border::new().write_one(scratch) }?;
        *scratch = pm::force_scratch(n)?;
        Ok(())
    })())
}

/// From modes of the density to modes of F = -grad inverse-Laplacian delta, all three components in one pass.
///
/// F is in the unit of L: for a linear field the Zel'dovich displacement x - q itself. The peculiar acceleration is 3/2 Omega_m H0^2/a^2 times F
/// where F is in comoving lengths. A particle of weight w pulls another with w/mass L^3/(4 pi r^2). Read out with the window of the deposit, the
/// force of any law conserves momentum to rounding, and no particle pulls itself. k = 0 and the Nyquist modes (|n_a| = n/2 on any axis: an odd
/// derivative has no value there) become zero. A whole force, beside the density two meshes:
///
///    memset(x, 0, len * sizeof *x);
///    fixpair_deposit_f64(x, len, &cells, ...);
///    fft.forward(fft.context, x);
///    fixpair_forces_f64(x, y, z, len, &modes, &law, L, total_weight, ...);
///    fft.inverse(fft.context, x);                        and y, z
///    fixpair_read_out_f64(force_x, 3, x, len, &cells, ...);    and y, z, with the same window
///
/// In/Out: x     len reals on the brick: F_k, the forward transform of deposited weights, not normalised; then the modes of F_x,
///               whose inverse transform, not normalised, is the force on the cells
/// Out: y, z     len reals each: the modes of F_y and F_z
/// In:  brick    of Fourier space
///      law
///      box_size L
///      mass     the sum of all weights, of all processes
///      scratch  scratch_len bytes, see fixpair_force_scratch
///      exec     or NULL
/// Returns: 0, FIXPAIR_ERROR_NULL, _LENGTH, _ALIGNMENT, _OVERLAP, _OVERFLOW, _SCRATCH, _NOT_FINITE, FIXPAIR_ERROR_RANGE if the box or the mass is not
///          positive or L/(n mass) no normal number, or why brick or law are refused; after FIXPAIR_ERROR_HOOK the meshes are undefined.
///          Modes are not checked.
/// Cost: one pass, which reads one mesh and writes three
///
/// # Safety
/// Pointers are null or point to as many values as stated; the hooks keep their contracts.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_forces_f64(
    x: *mut f64,
    y: *mut f64,
    z: *mut f64,
    len: usize,
    brick: *const fixpair_brick,
    law: *const fixpair_force_law,
    box_size: f64,
    mass: f64,
    scratch: *mut c_void,
    scratch_len: usize,
    exec: *const fixpair_exec,
) -> fixpair_status_t {
    // SAFETY: the caller's promise.
    code(unsafe { all_three([x, y, z], len, brick, law, box_size, mass, scratch, scratch_len, exec) })
}

/// fixpair_forces_f64 in single precision: the same arithmetic in double precision, rounded once.
///
/// # Safety
/// Pointers are null or point to as many values as stated; the hooks keep their contracts.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_forces_f32(
    x: *mut f32,
    y: *mut f32,
    z: *mut f32,
    len: usize,
    brick: *const fixpair_brick,
    law: *const fixpair_force_law,
    box_size: f64,
    mass: f64,
    scratch: *mut c_void,
    scratch_len: usize,
    exec: *const fixpair_exec,
) -> fixpair_status_t {
    // SAFETY: the caller's promise.
    code(unsafe { all_three([x, y, z], len, brick, law, box_size, mass, scratch, scratch_len, exec) })
}

unsafe fn all_three<T: Real>(
    [x, y, z]: [*mut T; 3],
    len: usize,
    brick: *const fixpair_brick,
    law: *const fixpair_force_law,
    box_size: f64,
    mass: f64,
    scratch: *mut c_void,
    scratch_len: usize,
    exec: *const fixpair_exec,
) -> Result<()> {
    let mut border = Border::new();
    // SAFETY: the caller's promise.
    unsafe {
        let meshes = [border.write(x, len)?, border.write(y, len)?, border.write(z, len)?];
        let brick = border.read_one(brick)?.check()?;
        let law = border.read_one(law)?.check()?;
        let scratch = border.scratch(scratch, scratch_len)?;
        let exec = HostExec::new(&mut border, exec)?;
        pm::forces(meshes, &brick, &law, box_size, mass, scratch, &exec)
    }
}

/// One component of fixpair_forces_f64, the same bits, to another mesh: for hosts with one mesh to spare beside the density.
///
/// Out: out     len reals on the brick: the modes of F_axis
/// In:  density  len reals: F_k as for fixpair_forces_f64
///      axis     0, 1, 2 for x, y, z
///      brick, law, box_size, mass, scratch, scratch_len, exec  as fixpair_forces_f64
/// Returns: as fixpair_forces_f64, and FIXPAIR_ERROR_RANGE for another axis
/// Cost: one pass, which reads one mesh and writes one
///
/// # Safety
/// Pointers are null or point to as many values as stated; the hooks keep their contracts.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_force_f64(
    out: *mut f64,
    density: *const f64,
    len: usize,
    brick: *const fixpair_brick,
    axis: usize,
    law: *const fixpair_force_law,
    box_size: f64,
    mass: f64,
    scratch: *mut c_void,
    scratch_len: usize,
    exec: *const fixpair_exec,
) -> fixpair_status_t {
    // SAFETY: the caller's promise.
    code(unsafe { one(out, density, len, brick, axis, law, box_size, mass, scratch, scratch_len, exec) })
}

/// fixpair_force_f64 in single precision.
///
/// # Safety
/// Pointers are null or point to as many values as stated; the hooks keep their contracts.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_force_f32(
    out: *mut f32,
    density: *const f32,
    len: usize,
    brick: *const fixpair_brick,
    axis: usize,
    law: *const fixpair_force_law,
    box_size: f64,
    mass: f64,
    scratch: *mut c_void,
    scratch_len: usize,
    exec: *const fixpair_exec,
) -> fixpair_status_t {
    // SAFETY: the caller's promise.
    code(unsafe { one(out, density, len, brick, axis, law, box_size, mass, scratch, scratch_len, exec) })
}

unsafe fn one<T: Real>(
    out: *mut T,
    density: *const T,
    len: usize,
    brick: *const fixpair_brick,
    axis: usize,
    law: *const fixpair_force_law,
    box_size: f64,
    mass: f64,
    scratch: *mut c_void,
    scratch_len: usize,
    exec: *const fixpair_exec,
) -> Result<()> {
    let mut border = Border::new();
    // SAFETY: the caller's promise.
    unsafe {
        let (out, density) = (border.write(out, len)?, border.read(density, len)?);
        let brick = border.read_one(brick)?.check()?;
        let law = border.read_one(law)?.check()?;
        let scratch = border.scratch(scratch, scratch_len)?;
        let exec = HostExec::new(&mut border, exec)?;
        pm::force(out, density, &brick, axis, &law, box_size, mass, scratch, &exec)
    }
}

/// The inverse Laplacian of delta: phi_k = -S/(W^power K2) delta_k, in the unit of L^2; the peculiar potential is 3/2 Omega_m H0^2/a times it.
///
/// For hosts that take differences in real space, which gives them the force of the law with that gradient, and for energies. The law's own gradient
/// means nothing here.
///
/// In/Out: modes  len reals on the brick: F_k as for fixpair_forces_f64, then phi_k
/// In:  brick, law, box_size, mass, scratch, scratch_len, exec  as fixpair_forces_f64
/// Returns: as fixpair_forces_f64, and FIXPAIR_ERROR_RANGE if L^2/(n^2 mass) is no normal number
/// Cost: one pass over one mesh
///
/// # Safety
/// Pointers are null or point to as many values as stated; the hooks keep their contracts.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_potential_f64(
    modes: *mut f64,
    len: usize,
    brick: *const fixpair_brick,
    law: *const fixpair_force_law,
    box_size: f64,
    mass: f64,
    scratch: *mut c_void,
    scratch_len: usize,
    exec: *const fixpair_exec,
) -> fixpair_status_t {
    // SAFETY: the caller's promise.
    code(unsafe { inverse_laplacian(modes, len, brick, law, box_size, mass, scratch, scratch_len, exec) })
}

/// fixpair_potential_f64 in single precision.
///
/// # Safety
/// Pointers are null or point to as many values as stated; the hooks keep their contracts.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_potential_f32(
    modes: *mut f32,
    len: usize,
    brick: *const fixpair_brick,
    law: *const fixpair_force_law,
    box_size: f64,
    mass: f64,
    scratch: *mut c_void,
    scratch_len: usize,
    exec: *const fixpair_exec,
) -> fixpair_status_t {
    // SAFETY: the caller's promise.
    code(unsafe { inverse_laplacian(modes, len, brick, law, box_size, mass, scratch, scratch_len, exec) })
}

unsafe fn inverse_laplacian<T: Real>(
    modes: *mut T,
    len: usize,
    brick: *const fixpair_brick,
    law: *const fixpair_force_law,
    box_size: f64,
    mass: f64,
    scratch: *mut c_void,
    scratch_len: usize,
    exec: *const fixpair_exec,
) -> Result<()> {
    let mut border = Border::new();
    // SAFETY: the caller's promise.
    unsafe {
        let modes = border.write(modes, len)?;
        let brick = border.read_one(brick)?.check()?;
        let law = border.read_one(law)?.check()?;
        let scratch = border.scratch(scratch, scratch_len)?;
        let exec = HostExec::new(&mut border, exec)?;
        pm::potential(modes, &brick, &law, box_size, mass, scratch, &exec)
    }
}
