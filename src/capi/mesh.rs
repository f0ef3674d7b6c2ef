//! Bricks.

use super::border::Border;
use super::status::{code, fixpair_status_t};
use crate::mesh::{Brick, Space};
use crate::status::{Error, Result};

/// Real cells.
pub const FIXPAIR_SPACE_CONFIGURATION: i32 = 0;
/// Complex modes of the half space l >= 0.
pub const FIXPAIR_SPACE_FOURIER: i32 = 1;

/// Which part of an n x n x n mesh an array holds, and where each element lies.
///
/// Configuration space: element (x, y, z) is a real. Fourier space: element (i, j, l) is a complex number, stored as (re, im), of
/// the mode k = (2 pi/L) (i, j, l); axes 0 and 1 hold i and j in the order 0, 1, ..., n/2, -(n/2-1), ..., -1, axis 2 holds
/// l = 0..n/2. The element with local indices (a, b, c) is at a stride[0] + b stride[1] + c stride[2].
/// Strides count elements: reals in configuration space, complex numbers in Fourier space. What lies between the elements is
/// ignored by all functions, and overwritten by transforms alone.
///
/// Fill it with one of the functions below, or by hand for any other layout (a pencil, say). Functions refuse with
/// FIXPAIR_ERROR_MESH_SIZE an n that is zero or odd, with FIXPAIR_ERROR_OVERFLOW one above 2^21 and a part that no memory holds (the whole mesh
/// need not fit any), with FIXPAIR_ERROR_CHOICE an unknown space, and with FIXPAIR_ERROR_BRICK a part outside the mesh, strides that put two elements on
/// one address, and the space that they do not take. That is what "why the brick is refused" means below.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct fixpair_brick {
    /// Cells on a side of the whole mesh: even.
    pub n: usize,
    /// FIXPAIR_SPACE_CONFIGURATION or FIXPAIR_SPACE_FOURIER.
    pub space: i32,
    /// First index of the part on each axis.
    pub start: [usize; 3],
    /// Elements of the part on each axis; may be 0.
    pub count: [usize; 3],
    /// Elements in memory from one index to the next on each axis.
    pub stride: [usize; 3],
}

pub(super) fn space(value: i32) -> Result<Space> {
    match value {
        FIXPAIR_SPACE_CONFIGURATION => Ok(Space::Configuration),
        FIXPAIR_SPACE_FOURIER => Ok(Space::Fourier),
        _ => Err(Error::Choice),
    }
}

impl fixpair_brick {
    pub(super) fn check(&self) -> Result<Brick> {
        Brick::general(self.n, space(self.space)?, self.start, self.count, self.stride)
    }
}

impl From<Brick> for fixpair_brick {
    fn from(brick: Brick) -> Self {
        Self {
            n: brick.n(),
            space: brick.space() as i32,
            start: brick.start(),
            count: brick.count(),
            stride: brick.stride(),
        }
    }
}

/// # Safety
/// As [`Border::write`].
unsafe fn put(out: *mut fixpair_brick, brick: impl FnOnce() -> Result<Brick>) -> fixpair_status_t {
    code((|| {
        // SAFETY: as the caller promised.
        let out = unsafe { Border::new().write_one(out) }?;
        *out = brick()?.into();
        Ok(())
    })())
}

/// The whole mesh, laid out for a transform in place: rows of n + 2 reals or n/2 + 1 modes, x outermost.
///
/// Out: brick
/// In:  n        cells on a side, even
///      space    FIXPAIR_SPACE_CONFIGURATION or FIXPAIR_SPACE_FOURIER
///      padding  unused modes (twice as many reals) after each x plane: 0, or fixpair_fft_padding_f64(n) to be faster where
///               n is a power of two; the same for both spaces
/// Returns: 0, FIXPAIR_ERROR_NULL, _ALIGNMENT, _MESH_SIZE, _CHOICE, _OVERFLOW
///
/// # Safety
/// `brick` is null or points to a brick.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_brick_whole(
    brick: *mut fixpair_brick,
    n: usize,
    space: i32,
    padding: usize,
) -> fixpair_status_t {
    // SAFETY: the caller's promise.
    unsafe { put(brick, || Brick::whole_padded(n, self::space(space)?, padding)) }
}

/// The x planes first .. first + planes - 1: how FFTW-MPI deals out a mesh.
///
/// Out: brick
/// In:  n, space as fixpair_brick_whole; first, planes: the x range
/// Returns: 0, or as fixpair_brick_whole, or FIXPAIR_ERROR_BRICK for a range outside the mesh
///
/// # Safety
/// `brick` is null or points to a brick.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_brick_slab(
    brick: *mut fixpair_brick,
    n: usize,
    space: i32,
    first: usize,
    planes: usize,
) -> fixpair_status_t {
    // SAFETY: the caller's promise.
    unsafe { put(brick, || Brick::slab(n, self::space(space)?, first, planes)) }
}

/// The modes with y index first .. first + rows - 1, y outermost: FFTW-MPI's FFTW_MPI_TRANSPOSED_OUT.
///
/// Out: brick, in Fourier space
/// In:  n as fixpair_brick_whole; first, rows: the y range
/// Returns: 0, or as fixpair_brick_slab
///
/// # Safety
/// `brick` is null or points to a brick.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_brick_transposed_slab(
    brick: *mut fixpair_brick,
    n: usize,
    first: usize,
    rows: usize,
) -> fixpair_status_t {
    // SAFETY: the caller's promise.
    unsafe { put(brick, || Brick::transposed_slab(n, first, rows)) }
}

/// Checks a brick, and says how many reals its array must at least have.
///
/// Out: reals  from the first element to the end of the last; for an in-place transform take the larger of both spaces
/// In:  brick  in configuration space it may run over the edge (fixpair_brick_with_ghosts)
/// Returns: 0, FIXPAIR_ERROR_NULL, _ALIGNMENT, _OVERLAP, or why the brick is refused
///
/// # Safety
/// Both pointers are null or point to one value.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fixpair_brick_reals(
    reals: *mut usize,
    brick: *const fixpair_brick,
) -> fixpair_status_t {
    code((|| {
        let mut border = Border::new();
        // SAFETY: the caller's promise.
        let (reals, brick) = unsafe { (border.write_one(reals)?, border.read_one(brick)?) };
        *reals = match space(brick.space)? {
            Space::Configuration => super::pm::region(brick)?.reals(),
            Space::Fourier => brick.check()?.reals(),
        };
        Ok(())
    })())
}
