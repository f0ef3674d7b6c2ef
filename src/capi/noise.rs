//! Random modes.

use super::border::Border;
use super::exec::{HostExec, fixpair_exec};
use super::fft::{Hook, HostFft, fixpair_fft_f32, fixpair_fft_f64};
use super::mesh::fixpair_brick;
use super::status::{code, fixpair_status_t};
use crate::fft::Fft3;
use crate::noise::philox::philox4x32_10;
use crate::noise::ranlux::Ranlxd1;
use crate::noise::{
    Realisation, impose, ngenic_seeds, unit_modes_from_field, white_modes, white_modes_coloured,
};
use crate::real::Real;
use crate::status::{Error, Result};

/// Philox4x32-10 at the signed mode number: a mode's numbers depend on the seed and on itself alone.
pub const FIXPAIR_SCHEME_NATIVE: i32 = 0;
/// RANLUX (ranlxd1) seeded for each (i, j) from a table: the scheme of N-GenIC, 2LPTic, 2LPTPNG and L-PICOLA.
pub const FIXPAIR_SCHEME_NGENIC: i32 = 1;
/// The same with FastPM's choices on the self-conjugate and Nyquist planes.
pub const FIXPAIR_SCHEME_FASTPM: i32 = 2;

/// Complex Gaussian modes.
pub const FIXPAIR_AMPLITUDE_NORMAL: i32 = 0;
/// |w| = 1, the root mean square: the field has exactly the input power.
pub const FIXPAIR_AMPLITUDE_FIXED: i32 = 1;
/// |w| = sqrt(pi)/2, the mean modulus (of self-conjugate modes sqrt(2/pi)): a biased choice, which leaves pi/4 of the input power.
pub const FIXPAIR_AMPLITUDE_FIXED_TO_MEAN: i32 = 2;

/// Phases as drawn.
pub const FIXPAIR_PHASE_ORIGINAL: i32 = 0;
/// All phases plus pi: the second member of a pair.
pub const FIXPAIR_PHASE_INVERTED: i32 = 1;

/// Modes with a mode number n/2 are zero.
pub const FIXPAIR_NYQUIST_ZERO: i32 = 0;
/// They are modes like the others.
pub const FIXPAIR_NYQUIST_FILLED: i32 = 1;

/// Modes (i, j, l) with |i|, |j| and |l| at most floor(sample/2) are drawn.
pub const FIXPAIR_SELECTION_CUBE: i32 = 0;
/// Modes with i^2 + j^2 + l^2 at most floor(sample/2)^2 are drawn.
pub const FIXPAIR_SELECTION_SPHERE: i32 = 1;

/// One realisation of the Gaussian field. Same seed, same phases and same moduli over their r.m.s., whatever the cosmology,
/// f_NL, redshift, precision, threads, decomposition, and for every mode that two meshes share, the mesh.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct fixpair_realisation {
    /// sizeof(fixpair_realisation).
    pub struct_size: usize,
    /// Any number.
    pub seed: u64,
    /// FIXPAIR_SCHEME_NATIVE, _NGENIC or _FASTPM.
    pub scheme: i32,
    /// FIXPAIR_AMPLITUDE_NORMAL, _FIXED or _FIXED_TO_MEAN.
    pub amplitude: i32,
    /// FIXPAIR_PHASE_ORIGINAL or _INVERTED.
    pub phase: i32,
    /// FIXPAIR_NYQUIST_ZERO or _FILLED.
    pub nyquist: i32,
    /// FIXPAIR_SELECTION_CUBE or _SPHERE: the modes outside are zero, in every scheme.
    pub selection: i32,
    /// Twice the largest mode number that is drawn (2LPTic's Nsample). 0 stands for the side of the mesh, with which a
    /// cube is all its modes.
    pub sample: u32,
}

impl fixpair_realisation {
    pub(super) fn new(seed: u64) -> Self {
        let struct_size = size_of::<Self>();
        Self { struct_size, seed, scheme: 0, amplitude: 0, phase: 0, nyquist: 0, selection: 0, sample: 0 }
    }

    pub(super) fn check(&self) -> Result<Realisation> {
        if self.struct_size != size_of::<Self>() {
            return Err(Error::Version);
        }
        Ok(Realisation {
            seed: self.seed,
            scheme: self.scheme.try_into()?,
            amplitude: self.amplitude.try_into()?,
            phase: self.phase.try_into()?,
            nyquist: self.nyquist.try_into()?,
            selection: self.selection.try_into()?,
            sample: self.sample,
        })
    }
}

/// Fills a realisation: native scheme, normal amplitudes, original phases, Nyquist modes zero, no other mode left out.
///
/// Out: realisation
/// In:  seed
/// Returns: 0, FIXPAIR_ERROR_NULL, FIXPAIR_ERROR_ALIGNMENT
///
/// # Safety
/// `realisation` is null or points to one.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_realisation_init(
    realisation: *mut fixpair_realisation,
    seed: u64,
) -> fixpair_status_t {
    code((|| {
        // SAFETY: the caller's promise.
        *unsafe { Border::new().write_one(realisation) }? = fixpair_realisation::new(seed);
        Ok(())
    })())
}

/// One block of Philox4x32-10 (Salmon et al. 2011), the generator of the native scheme, for draws of the host's own. The library
/// uses counters (i, l, j, 0x77686974) for the mode (i, j, l), signed, and the seed's low and high half as key: choose another last word.
///
/// Out: output   4 random words
/// In:  counter  4 words
///      key      2 words
/// Returns: 0, FIXPAIR_ERROR_NULL, FIXPAIR_ERROR_ALIGNMENT, FIXPAIR_ERROR_OVERLAP
///
/// # Safety
/// Pointers are null or point to as many values as stated.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_philox4x32_10(
    output: *mut u32,
    counter: *const u32,
    key: *const u32,
) -> fixpair_status_t {
    code((|| {
        let mut border = Border::new();
        // SAFETY: the caller's promise.
        let (output, counter, key) =
            unsafe { (border.write(output, 4)?, border.read(counter, 4)?, border.read(key, 2)?) };
        let block = philox4x32_10(core::array::from_fn(|i| counter[i]), core::array::from_fn(|i| key[i]));
        output.copy_from_slice(&block);
        Ok(())
    })())
}

/// Unit modes w: <|w|^2> = 1, Hermitian, DC zero. With a table of amplitudes, w times amplitude[|n|^2].
///
/// The phase is 2 pi u1 and the modulus sqrt(-ln u2), of two uniforms of 53 bits; fixing uses the same u1, so that fixed and
/// normal modes are matched. Self-conjugate modes are real: sqrt(-2 ln u2) cos(2 pi u1), fixed its sign. Single precision is the rounded double precision.
///
/// Schemes NGENIC and FASTPM draw u1 and u2, of 48 bits, from ranlxd1, seeded for each (i, j) with fixpair_ngenic_seeds, from l = 0
/// upwards; u2 is drawn again while it is zero. w is the mode that N-GenIC, 2LPTic, 2LPTPNG, L-PICOLA or FastPM multiply by
/// sqrt(P/V) in delta_k (they transform with exp(+i k.x), too). NGENIC has no modes with a mode number n/2, so that
/// FIXPAIR_NYQUIST_FILLED is refused; FASTPM filled has FastPM's, and its self-conjugate modes keep sqrt(-ln u2) cos(2 pi u1).
/// 2LPTic compares floating-point numbers with floor(Nsample/2): modes on the very boundary, which are drawn here, may be cut there.
///
/// Out: modes          len reals: modes of the brick
/// In:  brick          of Fourier space, any part of any mesh
///      realisation
///      amplitude      amplitude_len >= 3 (n/2)^2 + 1 factors by integer |n|^2, as fixpair_potential_amplitude_table gives; or NULL, 0
///      exec           or NULL
/// Returns: 0, FIXPAIR_ERROR_NULL, _LENGTH, _ALIGNMENT, _OVERLAP, _CHOICE, _VERSION, _HOOK, _NOT_FINITE for a factor that is NaN,
///          infinite, or within 16 times the largest number of the precision, or why the brick is refused
/// Cost: native about 11 ns a mode and core with AVX2. The others about 17 ns for each mode from l = 0 to the brick's last, and,
///       before the cores share the rest, 20 ns for each of n^2 entries of the table of seeds, whatever the brick.
///       No scratch
///
/// # Safety
/// Pointers are null or point to as many values as stated.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_white_modes_f64(
    modes: *mut f64,
    len: usize,
    brick: *const fixpair_brick,
    realisation: *const fixpair_realisation,
    amplitude: *const f64,
    amplitude_len: usize,
    exec: *const fixpair_exec,
) -> fixpair_status_t {
    // SAFETY: the caller's promise.
    code(unsafe { white(modes, len, brick, realisation, amplitude, amplitude_len, exec) })
}

/// fixpair_white_modes_f64 in single precision.
///
/// # Safety
/// Pointers are null or point to as many values as stated.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_white_modes_f32(
    modes: *mut f32,
    len: usize,
    brick: *const fixpair_brick,
    realisation: *const fixpair_realisation,
    amplitude: *const f64,
    amplitude_len: usize,
    exec: *const fixpair_exec,
) -> fixpair_status_t {
    // SAFETY: the caller's promise.
    code(unsafe { white(modes, len, brick, realisation, amplitude, amplitude_len, exec) })
}

/// The first numbers of GSL's ranlxd1, the generator of the schemes NGENIC and FASTPM: RANLUX in double precision at luxury
/// level 1 (Luescher 1994), multiples of 2^-48 in [0, 1), for draws and checks of the host's own.
///
/// Out: uniforms  len numbers
/// In:  seed      as gsl_rng_set takes it: 0 counts as 1; otherwise the lower 32 bits are a signed number of which the magnitude's
///                lower 31 bits are taken
/// Returns: 0, FIXPAIR_ERROR_NULL, FIXPAIR_ERROR_ALIGNMENT, FIXPAIR_ERROR_OVERFLOW
///
/// # Safety
/// `uniforms` is null or points to `len` numbers.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_ranlxd1(uniforms: *mut f64, len: usize, seed: u64) -> fixpair_status_t {
    code((|| {
        // SAFETY: the caller's promise.
        let uniforms = unsafe { Border::new().write(uniforms, len) }?;
        let mut stream = Ranlxd1::new(seed);
        uniforms.fill_with(|| stream.uniform());
        Ok(())
    })())
}

/// The seeds of the streams of the schemes NGENIC and FASTPM: entries of N-GenIC's table for the brick's columns (i, j).
///
/// Out: seeds  len = count[0] count[1] entries: that of the brick's row i and column j at i count[1] + j
/// In:  brick  of Fourier space; its third axis does not matter
///      seed   of the realisation, as fixpair_ranlxd1 takes it
/// Returns: 0, FIXPAIR_ERROR_NULL, _LENGTH, _ALIGNMENT, _OVERLAP, or why the brick is refused
/// Cost: the whole table is drawn for any brick, about 20 ns for each of its n^2 entries; no scratch
///
/// # Safety
/// Pointers are null or point to as many values as stated.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_ngenic_seeds(
    seeds: *mut u32,
    len: usize,
    brick: *const fixpair_brick,
    seed: u64,
) -> fixpair_status_t {
    code((|| {
        let mut border = Border::new();
        // SAFETY: the caller's promise.
        let (seeds, brick) = unsafe { (border.write(seeds, len)?, border.read_one(brick)?.check()?) };
        ngenic_seeds(seeds, &brick, seed)
    })())
}

unsafe fn white<T: Real>(
    modes: *mut T,
    len: usize,
    brick: *const fixpair_brick,
    realisation: *const fixpair_realisation,
    amplitude: *const f64,
    amplitude_len: usize,
    exec: *const fixpair_exec,
) -> Result<()> {
    let mut border = Border::new();
    // SAFETY: the caller's promise.
    unsafe {
        let modes = border.write(modes, len)?;
        let brick = border.read_one(brick)?.check()?;
        let realisation = border.read_one(realisation)?.check()?;
        let exec = HostExec::new(&mut border, exec)?;
        match border.read_optional(amplitude, amplitude_len)? {
            Some(amplitude) => white_modes_coloured(modes, &brick, &realisation, amplitude, &exec),
            None if amplitude_len > 0 => Err(Error::Null),
            None => white_modes(modes, &brick, &realisation, &exec),
        }
    }
}

/// Imposes the realisation's amplitude, phase, Nyquist choice and selection on unit modes that the host drew itself (its seed and
/// scheme are not used). Normal keeps w; fixed makes it w/|w|, or 1 where w = 0; fixed to the mean sqrt(pi)/2
/// times that, or sqrt(2/pi) where modes are self-conjugate; DC and modes outside the selection become zero.
///
/// In/Out: modes        len reals: Hermitian modes of the brick
/// In:     brick        of Fourier space
///         realisation
///         exec         or NULL
/// Returns: as fixpair_white_modes_f64, or FIXPAIR_ERROR_NOT_FINITE if a mode is NaN or infinite
///
/// # Safety
/// Pointers are null or point to as many values as stated.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_impose_f64(
    modes: *mut f64,
    len: usize,
    brick: *const fixpair_brick,
    realisation: *const fixpair_realisation,
    exec: *const fixpair_exec,
) -> fixpair_status_t {
    // SAFETY: the caller's promise.
    code(unsafe { imposed(modes, len, brick, realisation, exec) })
}

/// fixpair_impose_f64 in single precision.
///
/// # Safety
/// Pointers are null or point to as many values as stated.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_impose_f32(
    modes: *mut f32,
    len: usize,
    brick: *const fixpair_brick,
    realisation: *const fixpair_realisation,
    exec: *const fixpair_exec,
) -> fixpair_status_t {
    // SAFETY: the caller's promise.
    code(unsafe { imposed(modes, len, brick, realisation, exec) })
}

unsafe fn imposed<T: Real>(
    modes: *mut T,
    len: usize,
    brick: *const fixpair_brick,
    realisation: *const fixpair_realisation,
    exec: *const fixpair_exec,
) -> Result<()> {
    let mut border = Border::new();
    // SAFETY: the caller's promise.
    unsafe {
        let modes = border.write(modes, len)?;
        let brick = border.read_one(brick)?.check()?;
        let realisation = border.read_one(realisation)?.check()?;
        impose(modes, &brick, &realisation, &HostExec::new(&mut border, exec)?)
    }
}

/// Unit modes from the host's own real white noise (independent numbers of unit variance on the cells): transforms, multiplies by
/// n^(-3/2), and imposes amplitude, phase, Nyquist choice and selection as fixpair_impose_f64. So any existing suite whose
/// noise is known on cells can be fixed and paired.
///
/// In/Out: data         len = fft->length reals: white noise on the cells; on return modes
/// In:     fft          the transform
///         realisation
///         exec         or NULL
/// Returns: as fixpair_impose_f64; after FIXPAIR_ERROR_HOOK, or FIXPAIR_ERROR_NOT_FINITE from an overflow, data is undefined. On several processes, see that no
///          cell anywhere is NaN or infinite: a process that finds one does not take part in the transform
///
/// # Safety
/// Pointers are null or point to as many values as stated; the hooks keep their contracts.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_modes_from_field_f64(
    data: *mut f64,
    len: usize,
    fft: *const fixpair_fft_f64,
    realisation: *const fixpair_realisation,
    exec: *const fixpair_exec,
) -> fixpair_status_t {
    // SAFETY: the caller's promise.
    code(unsafe { from_field(data, len, fft, realisation, exec) })
}

/// fixpair_modes_from_field_f64 in single precision.
///
/// # Safety
/// Pointers are null or point to as many values as stated; the hooks keep their contracts.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_modes_from_field_f32(
    data: *mut f32,
    len: usize,
    fft: *const fixpair_fft_f32,
    realisation: *const fixpair_realisation,
    exec: *const fixpair_exec,
) -> fixpair_status_t {
    // SAFETY: the caller's promise.
    code(unsafe { from_field(data, len, fft, realisation, exec) })
}

unsafe fn from_field<H: Hook>(
    data: *mut H::Real,
    len: usize,
    fft: *const H,
    realisation: *const fixpair_realisation,
    exec: *const fixpair_exec,
) -> Result<()> {
    let mut border = Border::new();
    // SAFETY: the caller's promise.
    unsafe {
        let data = border.write(data, len)?;
        let mut fft = HostFft::new(&mut border, fft)?;
        let realisation = border.read_one(realisation)?.check()?;
        let fft: &mut dyn Fft3<H::Real> = &mut fft;
        unit_modes_from_field(fft, data, &realisation, &HostExec::new(&mut border, exec)?)
    }
}
