//! Statuses and the version.

use core::ffi::c_char;

use crate::status::{Error, Result};

/// What functions that can fail return: 0, or one of the negative FIXPAIR_ERROR_ codes, with outputs as rule 3 says.
pub type fixpair_status_t = i32;

/// Done.
pub const FIXPAIR_OK: i32 = 0;
/// A required pointer is null.
pub const FIXPAIR_ERROR_NULL: i32 = -1;
/// An array has the wrong length.
pub const FIXPAIR_ERROR_LENGTH: i32 = -2;
/// A pointer is not aligned to its element, or scratch not as its query says.
pub const FIXPAIR_ERROR_ALIGNMENT: i32 = -3;
/// Memory that must be separate overlaps.
pub const FIXPAIR_ERROR_OVERLAP: i32 = -4;
/// An input is NaN or infinite.
pub const FIXPAIR_ERROR_NOT_FINITE: i32 = -5;
/// The mesh side is zero, odd, or has a prime factor that the transform lacks.
pub const FIXPAIR_ERROR_MESH_SIZE: i32 = -6;
/// A brick does not fit its mesh, its memory, or the function.
pub const FIXPAIR_ERROR_BRICK: i32 = -7;
/// A size does not fit the address space, 2^21 cells a side, or a sum of 64 bits.
pub const FIXPAIR_ERROR_OVERFLOW: i32 = -8;
/// A table is too short, not increasing, or not positive.
pub const FIXPAIR_ERROR_TABLE: i32 = -9;
/// A parameter is out of range.
pub const FIXPAIR_ERROR_RANGE: i32 = -10;
/// Scratch is smaller than its query says.
pub const FIXPAIR_ERROR_SCRATCH: i32 = -11;
/// A hook failed or left work undone.
pub const FIXPAIR_ERROR_HOOK: i32 = -12;
/// A struct_size is unknown.
pub const FIXPAIR_ERROR_VERSION: i32 = -13;
/// An enumeration has an unknown value.
pub const FIXPAIR_ERROR_CHOICE: i32 = -14;
/// The system refused to start a thread.
pub const FIXPAIR_ERROR_THREAD: i32 = -15;
/// An iteration did not converge.
pub const FIXPAIR_ERROR_CONVERGENCE: i32 = -16;
/// A particle lies outside the brick of cells, or its window reaches beyond it.
pub const FIXPAIR_ERROR_OUTSIDE: i32 = -17;
/// The host's observer asked a run to stop; it can go on.
pub const FIXPAIR_ERROR_STOPPED: i32 = -18;
/// There are fewer independent estimates than the statistic needs.
pub const FIXPAIR_ERROR_SAMPLES: i32 = -19;
/// A matrix is singular or not positive definite, or the data say nothing about a parameter.
pub const FIXPAIR_ERROR_SINGULAR: i32 = -20;

pub(super) fn code(result: Result<()>) -> fixpair_status_t {
    result.map_or_else(Error::code, |()| FIXPAIR_OK)
}

/// One sentence, in English, about a status: what is wrong and what to do. Static memory, never null, for any number.
#[unsafe(no_mangle)]
pub extern "C" fn fixpair_status_message(status: fixpair_status_t) -> *const c_char {
    if status == FIXPAIR_OK {
        return c"ok".as_ptr();
    }
    let known = Error::ALL.into_iter().find(|error| error.code() == status);
    known.map_or(c"unknown status: not a number that this library returns", Error::message).as_ptr()
}

/// The version of the library that runs, as "major.minor.patch". Static memory.
#[unsafe(no_mangle)]
pub extern "C" fn fixpair_version() -> *const c_char {
    concat!(env!("CARGO_PKG_VERSION"), "\0").as_ptr().cast()
}
