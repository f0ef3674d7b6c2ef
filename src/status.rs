//! Every way in which a kernel can refuse: one fixed negative number and one sentence each.
//!
//! A kernel that refuses leaves its outputs untouched unless its documentation says otherwise.

/// Why a kernel refused. The discriminants are the numbers that C sees and never change meaning.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(i32)]
pub enum Error {
    /// A pointer that must not be null was null.
    Null = -1,
    /// An array is shorter or longer than its documentation asks for.
    Length = -2,
    /// A pointer is not aligned to its element, or scratch not to the alignment its query gave.
    Alignment = -3,
    /// Two arrays that must be separate overlap.
    Overlap = -4,
    /// An input is NaN or infinite.
    NotFinite = -5,
    /// The mesh side is zero, odd, or has a prime factor other than 2, 3, 5 and 7.
    MeshSize = -6,
    /// A brick is not a part of its mesh, its strides fold two elements onto one address, or its space,
    /// side or extent is not what the kernel needs.
    Brick = -7,
    /// A size does not fit the address space, 2^21 cells a side, or a sum of 64 bits.
    Overflow = -8,
    /// A table is too short, not strictly increasing in its first column, or not positive.
    Table = -9,
    /// A parameter lies outside the range that its documentation gives.
    Range = -10,
    /// Scratch is smaller than its query says.
    Scratch = -11,
    /// A hook of the caller's (transform, threads, sum) failed or did not do all its work.
    Hook = -12,
    /// The `struct_size` of a struct is not one that this library knows.
    Version = -13,
    /// An enumeration has a value that this library does not know.
    Choice = -14,
    /// The operating system refused to start a thread.
    Thread = -15,
    /// An iteration did not reach the accuracy that its documentation promises.
    Convergence = -16,
    /// A particle lies outside the region of cells, or so near its edge that its window reaches beyond it.
    Outside = -17,
    /// The caller's observer asked a run to stop: what it leaves behind is sound, and it can go on.
    Stopped = -18,
    /// There are fewer independent estimates than the statistic needs.
    Samples = -19,
    /// A matrix is singular or not positive definite, or the data say nothing about a parameter.
    Singular = -20,
}

/// What every kernel returns.
pub type Result<T> = core::result::Result<T, Error>;

impl Error {
    /// All errors, in the order of their numbers.
    pub const ALL: [Self; 20] = [
        Self::Null,
        Self::Length,
        Self::Alignment,
        Self::Overlap,
        Self::NotFinite,
        Self::MeshSize,
        Self::Brick,
        Self::Overflow,
        Self::Table,
        Self::Range,
        Self::Scratch,
        Self::Hook,
        Self::Version,
        Self::Choice,
        Self::Thread,
        Self::Convergence,
        Self::Outside,
        Self::Stopped,
        Self::Samples,
        Self::Singular,
    ];

    /// The number that C sees.
    ///
    /// ```
    /// use fixpair::status::Error;
    ///
    /// assert_eq!(Error::MeshSize.code(), -6); // as in C
    /// ```
    #[must_use]
    pub const fn code(self) -> i32 {
        self as i32
    }

    /// What went wrong and what to do about it: one sentence, NUL-terminated for C.
    ///
    /// ```
    /// use fixpair::status::Error;
    ///
    /// assert!(!Error::MeshSize.message().to_bytes().is_empty());
    /// ```
    #[must_use]
    pub const fn message(self) -> &'static core::ffi::CStr {
        match self {
            Self::Null => c"a required pointer is null: pass memory for every argument not marked optional",
            Self::Length => {
                c"an array has the wrong length: compare with the length its documentation asks for"
            }
            Self::Alignment => {
                c"a pointer is misaligned: align arrays to their element and scratch as its query says"
            }
            Self::Overlap => c"two arrays overlap: outputs and scratch need memory of their own",
            Self::NotFinite => c"an input is NaN or infinite: check the numbers and arrays passed in",
            Self::MeshSize => {
                c"the mesh side is zero, odd, or has a factor other than 2, 3, 5, 7: choose another side"
            }
            Self::Brick => c"a brick does not fit: check its space, side, start, count and strides",
            Self::Overflow => c"a size is beyond the address space, 2^21 cells a side, or a sum of 64 bits: take less at a time",
            Self::Table => {
                c"a table is invalid: use two or more rows, k strictly increasing, all values positive"
            }
            Self::Range => c"a parameter is out of range: see the range in its documentation",
            Self::Scratch => c"scratch is too small: ask the function's _scratch twin for the size",
            Self::Hook => {
                c"a hook failed: the transform, thread or sum hook reported an error or left work undone"
            }
            Self::Version => c"struct_size is unknown: fill the struct with its _init function first",
            Self::Choice => c"an enumeration has an unknown value: use the FIXPAIR_ constants",
            Self::Thread => {
                c"a thread could not be started: ask for fewer threads or raise the system's limit"
            }
            Self::Convergence => {
                c"an iteration did not converge: the parameters are too extreme for the stated accuracy"
            }
            Self::Outside => {
                c"a particle lies outside the brick: add ghost planes or send it to the process whose it is"
            }
            Self::Stopped => c"the observer asked to stop: call again with the same list to go on",
            Self::Samples => {
                c"too few independent estimates: add simulations or take fewer bins, see the documentation for how many"
            }
            Self::Singular => {
                c"singular: a matrix is not positive definite, or the data do not constrain a parameter that is free"
            }
        }
    }
}

impl core::fmt::Display for Error {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(self.message().to_str().unwrap_or("fixpair error"))
    }
}

impl core::error::Error for Error {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_error_has_its_own_negative_number_and_a_message() {
        for (i, error) in Error::ALL.into_iter().enumerate() {
            assert_eq!(error.code(), -1 - i32::try_from(i).unwrap());
            assert!(error.message().to_str().unwrap().contains(':'), "says what to do");
        }
    }
}
