//! Background, growth, linear power, and the tables by |n|^2.

use super::border::Border;
use super::status::{code, fixpair_status_t};
use crate::cosmology::{
    Convention, Cosmology, EisensteinHu, Growth, Linear, Poisson, Table, Wiggles, g_ratio, growth_many,
    primordial_amplitude, radiation_density,
};
use crate::status::{Error, Result};

/// f_NL of the potential in matter domination, as in studies of the microwave background: the usual one.
pub const FIXPAIR_CONVENTION_CMB: i32 = 0;
/// f_NL of the potential extrapolated linearly to z = 0: larger by g(z_rad)/g(0), 1.3 in LCDM, for the same field, and
/// g_NL by its square.
pub const FIXPAIR_CONVENTION_LSS: i32 = 1;

/// Rows (k, P(k)) of z = 0.
pub const FIXPAIR_LINEAR_POWER: i32 = 0;
/// Rows (k, T(k)), in any unit: normalised to 1 at the first row.
pub const FIXPAIR_LINEAR_TRANSFER: i32 = 1;
/// The fit of Eisenstein & Hu 1998, with acoustic oscillations; no rows.
pub const FIXPAIR_LINEAR_EISENSTEIN_HU: i32 = 2;
/// Their fit without oscillations; no rows.
pub const FIXPAIR_LINEAR_EISENSTEIN_HU_SMOOTH: i32 = 3;

/// As the rows are; only for FIXPAIR_LINEAR_POWER.
pub const FIXPAIR_NORMALISE_AS_GIVEN: i32 = 0;
/// The r.m.s. in spheres of 8 Mpc/h at z = 0 becomes `amount`.
pub const FIXPAIR_NORMALISE_SIGMA8: i32 = 1;
/// `amount` is A of P = A k^n_s T^2 in (Mpc/h)^(3 + n_s).
pub const FIXPAIR_NORMALISE_AMPLITUDE: i32 = 2;
/// `amount` is A_s, the variance per ln k of the curvature perturbation at 0.05/Mpc.
pub const FIXPAIR_NORMALISE_A_S: i32 = 3;

/// Where A_s is given, in 1/Mpc.
const PIVOT: f64 = 0.05;

/// A homogeneous universe and the tilt of its primordial spectrum. Densities are today's over the critical density; curvature is
/// 1 minus their sum. fixpair_cosmology_init fills one.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct fixpair_cosmology {
    /// sizeof(fixpair_cosmology).
    pub struct_size: usize,
    /// All matter.
    pub omega_m: f64,
    /// Dark energy.
    pub omega_de: f64,
    /// Photons and massless neutrinos; 0 for a simulation without radiation in its background.
    pub omega_r: f64,
    /// Baryons, a part of omega_m; read by the Eisenstein-Hu fits only.
    pub omega_b: f64,
    /// H0 over 100 km/s/Mpc.
    pub h: f64,
    /// Primordial tilt.
    pub n_s: f64,
    /// w(a) = w0 + wa (1 - a).
    pub w0: f64,
    /// See w0.
    pub wa: f64,
    /// Temperature of the microwave background in K; read by the Eisenstein-Hu fits only.
    pub t_cmb: f64,
}

impl fixpair_cosmology {
    pub(super) fn new(from: Cosmology) -> Self {
        let Cosmology { omega_m, omega_de, omega_r, omega_b, h, n_s, w0, wa, t_cmb } = from;
        Self { struct_size: size_of::<Self>(), omega_m, omega_de, omega_r, omega_b, h, n_s, w0, wa, t_cmb }
    }

    pub(super) fn check(&self) -> Result<Cosmology> {
        let Self { struct_size, omega_m, omega_de, omega_r, omega_b, h, n_s, w0, wa, t_cmb } = *self;
        if struct_size != size_of::<Self>() {
            return Err(Error::Version);
        }
        let cosmology = Cosmology { omega_m, omega_de, omega_r, omega_b, h, n_s, w0, wa, t_cmb };
        cosmology.check()?;
        Ok(cosmology)
    }
}

/// The linear power spectrum of z = 0, as the caller has it. It is scaled to other redshifts with the growth of the cosmology in use, so that
/// a simulation without radiation gets the right linear spectrum at low redshift. (A Boltzmann code's spectrum of z = 32 used
/// directly would have 1.3% more power in the paper's cosmology.)
///
/// Between rows ln P is interpolated in ln k by monotone cubics. Below the first row, which should be below k = 1e-3 h/Mpc,
/// T is constant and P goes as k^n_s; above the last, a power law with the last slope. P and T follow from one another by
/// P = A k^n_s T^2: n_s of the cosmology must be that of the spectrum.
///
/// fixpair_conditions_init fills one; else fill all members by hand.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct fixpair_linear {
    /// sizeof(fixpair_linear).
    pub struct_size: usize,
    /// FIXPAIR_LINEAR_...
    pub source: i32,
    /// FIXPAIR_NORMALISE_...
    pub normalisation: i32,
    /// k in h/Mpc, strictly increasing; NULL for the fits.
    pub k: *const f64,
    /// P(k) in (Mpc/h)^3, or T(k); positive; NULL for the fits.
    pub value: *const f64,
    /// Rows: 2 or more; 0 for the fits.
    pub rows: usize,
    /// What the spectrum is normalised to; not read with FIXPAIR_NORMALISE_AS_GIVEN.
    pub amount: f64,
}

impl fixpair_linear {
    pub(super) fn eisenstein_hu(sigma8: f64) -> Self {
        Self {
            struct_size: size_of::<Self>(),
            source: FIXPAIR_LINEAR_EISENSTEIN_HU,
            normalisation: FIXPAIR_NORMALISE_SIGMA8,
            k: core::ptr::null(),
            value: core::ptr::null(),
            rows: 0,
            amount: sigma8,
        }
    }

    /// # Safety
    /// `k` and `value` are null or point to `rows` values.
    pub(super) unsafe fn check<'a>(&self, border: &mut Border, cosmology: &Cosmology) -> Result<Linear<'a>> {
        if self.struct_size != size_of::<Self>() {
            return Err(Error::Version);
        }
        let amplitude = match self.normalisation {
            FIXPAIR_NORMALISE_AS_GIVEN if self.source == FIXPAIR_LINEAR_POWER => None,
            FIXPAIR_NORMALISE_SIGMA8 => None,
            FIXPAIR_NORMALISE_AMPLITUDE => Some(self.amount),
            FIXPAIR_NORMALISE_A_S => Some(primordial_amplitude(cosmology, self.amount, PIVOT)?),
            _ => return Err(Error::Choice),
        };
        let first = amplitude.unwrap_or(1.0);
        let linear = match self.source {
            FIXPAIR_LINEAR_POWER | FIXPAIR_LINEAR_TRANSFER => {
                // SAFETY: the caller's promise.
                let (k, value) =
                    unsafe { (border.read(self.k, self.rows)?, border.read(self.value, self.rows)?) };
                let table = Table::new(k, value)?;
                if self.source == FIXPAIR_LINEAR_TRANSFER {
                    Linear::from_transfer(table, cosmology.n_s, first)?
                } else {
                    let given = Linear::from_power(table, cosmology.n_s)?;
                    amplitude.map_or(Ok(given), |amplitude| given.with_amplitude(amplitude))?
                }
            }
            FIXPAIR_LINEAR_EISENSTEIN_HU | FIXPAIR_LINEAR_EISENSTEIN_HU_SMOOTH => {
                let smooth = self.source == FIXPAIR_LINEAR_EISENSTEIN_HU_SMOOTH;
                let wiggles = if smooth { Wiggles::Without } else { Wiggles::With };
                Linear::from_eisenstein_hu(EisensteinHu::new(cosmology, wiggles)?, cosmology.n_s, first)?
            }
            _ => return Err(Error::Choice),
        };
        if self.normalisation == FIXPAIR_NORMALISE_SIGMA8 {
            linear.with_sigma8(self.amount)
        } else {
            Ok(linear)
        }
    }
}

/// Fills a cosmology: that of the GOLIAT simulations (Avila & Adame 2022), flat, a cosmological constant, no radiation:
/// Omega_m = 0.27, Omega_b = 0.044, h = 0.7, n_s = 0.96. Change what differs in yours.
///
/// Out: cosmology
/// Returns: 0, FIXPAIR_ERROR_NULL, FIXPAIR_ERROR_ALIGNMENT
///
/// # Safety
/// `cosmology` is null or points to one.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_cosmology_init(cosmology: *mut fixpair_cosmology) -> fixpair_status_t {
    code((|| {
        // SAFETY: the caller's promise.
        *unsafe { Border::new().write_one(cosmology) }? = fixpair_cosmology::new(Cosmology::goliat());
        Ok(())
    })())
}

/// Omega_r of photons at temperature t_cmb and n_eff massless neutrinos.
///
/// Out: omega_r
/// In:  t_cmb in K, n_eff (3.046), h
/// Returns: 0, FIXPAIR_ERROR_NULL, FIXPAIR_ERROR_NOT_FINITE, FIXPAIR_ERROR_RANGE
///
/// # Safety
/// `omega_r` is null or points to a double.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_radiation_density(
    omega_r: *mut f64,
    t_cmb: f64,
    n_eff: f64,
    h: f64,
) -> fixpair_status_t {
    code((|| {
        // SAFETY: the caller's promise.
        let out = unsafe { Border::new().write_one(omega_r) }?;
        *out = radiation_density(t_cmb, n_eff, h)?;
        Ok(())
    })())
}

/// E(a) = H(a)/H0; H0 is 100 km/s per Mpc/h.
///
/// Out: e          len values
/// In:  a          len scale factors, 1e-10 to 10
///      cosmology
/// Returns: 0, FIXPAIR_ERROR_NULL, _ALIGNMENT, _OVERLAP, _VERSION, FIXPAIR_ERROR_NOT_FINITE and FIXPAIR_ERROR_RANGE for
///          scale factors or parameters
/// Cost: 30 microseconds a scale factor, most of it to check the cosmology
///
/// # Safety
/// Pointers are null or point to as many values as stated.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_expansion(
    e: *mut f64,
    a: *const f64,
    len: usize,
    cosmology: *const fixpair_cosmology,
) -> fixpair_status_t {
    code((|| {
        let mut border = Border::new();
        // SAFETY: the caller's promise.
        let (e, a) = unsafe { (border.write(e, len)?, border.read(a, len)?) };
        // SAFETY: the caller's promise.
        let cosmology = unsafe { border.read_one(cosmology) }?.check()?;
        map(e, a, |a| cosmology.expansion(a))
    })())
}

/// All or nothing: errors are found before the first value is written.
fn map(out: &mut [f64], input: &[f64], f: impl Fn(f64) -> Result<f64>) -> Result<()> {
    for &x in input {
        f(x)?;
    }
    for (out, &x) in out.iter_mut().zip(input) {
        *out = f(x)?;
    }
    Ok(())
}

/// Growth D, f = dlnD/dlna, D2, f2 = dlnD2/dlna, and those of the third order, by their differential equations, to 1e-8. D = 1 today; D2 is
/// negative, near -3/7 D^2: displacements are x = q - D grad phi1 + D2 grad phi2 + third order. D3a, D3b and D3c are near -1/3, 5/21 and 1/7 D^3;
/// fixpair_third_order_sources_f64 says which belongs to what.
///
/// Out: growth     len structs
/// In:  a          len scale factors, 1e-5 to 10, in any order
///      cosmology
/// Returns: as fixpair_expansion
/// Cost: 0.4 ms and 2 microseconds a scale factor
///
/// # Safety
/// Pointers are null or point to as many values as stated.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_growth_factors(
    growth: *mut Growth,
    a: *const f64,
    len: usize,
    cosmology: *const fixpair_cosmology,
) -> fixpair_status_t {
    code((|| {
        let mut border = Border::new();
        // SAFETY: the caller's promise.
        unsafe {
            let growth = border.write(growth, len)?;
            let a = border.read(a, len)?;
            growth_many(&border.read_one(cosmology)?.check()?, a, growth)
        }
    })())
}

/// g(z_rad)/g(0), g = (1 + z) D: f_NL(LSS) = this times f_NL(CMB). 1.316 for the GOLIAT cosmology.
///
/// Out: ratio
/// In:  cosmology  its radiation, if any, counts as dark energy here
/// Returns: as fixpair_expansion
///
/// # Safety
/// Pointers are null or point to one value.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_growth_suppression(
    ratio: *mut f64,
    cosmology: *const fixpair_cosmology,
) -> fixpair_status_t {
    code((|| {
        let mut border = Border::new();
        // SAFETY: the caller's promise.
        let (ratio, cosmology) = unsafe { (border.write_one(ratio)?, border.read_one(cosmology)?) };
        *ratio = g_ratio(&cosmology.check()?)?;
        Ok(())
    })())
}

pub(super) unsafe fn with_poisson(
    border: &mut Border,
    cosmology: *const fixpair_cosmology,
    linear: *const fixpair_linear,
    convention: i32,
    redshift: f64,
) -> Result<Poisson<'static>> {
    // SAFETY: the caller's promise; the tables are used during the call only.
    unsafe {
        let cosmology = border.read_one(cosmology)?.check()?;
        let linear = border.read_one(linear)?.check(border, &cosmology)?;
        if !redshift.is_finite() {
            return Err(Error::NotFinite);
        }
        if redshift <= -1.0 {
            return Err(Error::Range);
        }
        Poisson::new(&cosmology, linear, 1.0 / (1.0 + redshift), Convention::try_from(convention)?)
    }
}

/// The linear power spectrum at a redshift, P(k) D^2(z).
///
/// Out: power      len values in (Mpc/h)^3
/// In:  k          len wavenumbers in h/Mpc, positive
///      cosmology, linear
///      redshift
/// Returns: 0, FIXPAIR_ERROR_NULL, _ALIGNMENT, _OVERLAP, _VERSION, _CHOICE, _NOT_FINITE, _RANGE; _TABLE for rows that are fewer than 2,
///          not increasing or not positive; _CONVERGENCE where sigma8 cannot be integrated
///
/// # Safety
/// Pointers are null or point to as many values as stated.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_linear_power(
    power: *mut f64,
    k: *const f64,
    len: usize,
    cosmology: *const fixpair_cosmology,
    linear: *const fixpair_linear,
    redshift: f64,
) -> fixpair_status_t {
    code((|| {
        let mut border = Border::new();
        // SAFETY: the caller's promise.
        unsafe {
            let (power, k) = (border.write(power, len)?, border.read(k, len)?);
            let poisson = with_poisson(&mut border, cosmology, linear, FIXPAIR_CONVENTION_CMB, redshift)?;
            map(power, k, |k| poisson.density_power(k))
        }
    })())
}

/// T(k) of the spectrum, 1 for k -> 0.
///
/// Out: transfer   len values
/// In:  k          len wavenumbers in h/Mpc, positive
///      cosmology, linear
/// Returns: as fixpair_linear_power
///
/// # Safety
/// Pointers are null or point to as many values as stated.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_linear_transfer(
    transfer: *mut f64,
    k: *const f64,
    len: usize,
    cosmology: *const fixpair_cosmology,
    linear: *const fixpair_linear,
) -> fixpair_status_t {
    code((|| {
        let mut border = Border::new();
        // SAFETY: the caller's promise.
        unsafe {
            let (transfer, k) = (border.write(transfer, len)?, border.read(k, len)?);
            let poisson = with_poisson(&mut border, cosmology, linear, FIXPAIR_CONVENTION_CMB, 0.0)?;
            map(transfer, k, |k| poisson.linear().transfer(k))
        }
    })())
}

/// sigma(R), the r.m.s. of the linear density in spheres at z = 0, by adaptive quadrature to 1e-8.
///
/// Out: sigma
/// In:  radius     in Mpc/h; 8 gives sigma8
///      cosmology, linear
/// Returns: as fixpair_linear_power
///
/// # Safety
/// Pointers are null or point to one value.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_linear_sigma(
    sigma: *mut f64,
    radius: f64,
    cosmology: *const fixpair_cosmology,
    linear: *const fixpair_linear,
) -> fixpair_status_t {
    code((|| {
        let mut border = Border::new();
        // SAFETY: the caller's promise.
        unsafe {
            let sigma = border.write_one(sigma)?;
            let poisson = with_poisson(&mut border, cosmology, linear, FIXPAIR_CONVENTION_CMB, 0.0)?;
            *sigma = poisson.linear().sigma(radius)?;
            Ok(())
        }
    })())
}

/// alpha(k, z) of delta = alpha Phi: (2/3) (c/H0)^2 k^2 T(k) D(z)/Omega_m, over g(z_rad)/g(0) in the CMB convention. Without unit,
/// positive: f_NL > 0 skews the density positively and raises the large-scale power of haloes.
///
/// Out: alpha      len values
/// In:  k          len wavenumbers in h/Mpc, positive
///      cosmology, linear
///      redshift
///      convention FIXPAIR_CONVENTION_CMB or _LSS
/// Returns: as fixpair_linear_power
///
/// # Safety
/// Pointers are null or point to as many values as stated.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_alpha(
    alpha: *mut f64,
    k: *const f64,
    len: usize,
    cosmology: *const fixpair_cosmology,
    linear: *const fixpair_linear,
    redshift: f64,
    convention: i32,
) -> fixpair_status_t {
    code((|| {
        let mut border = Border::new();
        // SAFETY: the caller's promise.
        unsafe {
            let (alpha, k) = (border.write(alpha, len)?, border.read(k, len)?);
            let poisson = with_poisson(&mut border, cosmology, linear, convention, redshift)?;
            map(alpha, k, |k| poisson.alpha(k))
        }
    })())
}
