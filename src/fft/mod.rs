//! The three-dimensional real transform: a hook that the caller may fill, and the built-in transform that fills it too.
//!
//! Contract of the hook. `forward` replaces the reals f(x) of the configuration brick, in place, by the modes
//!     F(k) = sum_x f(x) exp(-i k.x)
//! of the Fourier brick; `inverse` replaces modes by
//!     f(x) = sum_k F(k) exp(+i k.x),
//! the sum running over both members of each Hermitian pair. Neither divides by n^3: kernels fold that factor
//! into a pass they make anyway. Both bricks describe one array of `length` reals; reals outside the bricks
//! (the padding of rows) hold nothing and may be overwritten. The imaginary parts of self-conjugate modes are
//! read as zero or as anything else that a real field cannot hold: callers pass Hermitian modes.
//!
//! The built-in transform ([`Transform`]) holds every vector lane of the processor in another row or column of the mesh,
//! so that no data moves between lanes except where rows are turned. Its [`Tables`] and workspace are the caller's.

use crate::mesh::Brick;
use crate::real::Real;
use crate::status::Result;

mod access;
#[cfg(target_arch = "x86_64")]
mod avx2;
mod butterfly;
mod lanes;
mod passes;
mod rows;
mod self_test;
mod sides;
mod tables;
mod transform;

pub use self_test::self_test;
pub use sides::next_side;
pub use tables::Tables;
pub use transform::{Transform, recommended_padding};

/// A transform of one mesh: the built-in one or the caller's.
pub trait Fft3<T: Real> {
    /// Where the cells lie.
    fn configuration(&self) -> &Brick;
    /// Where the modes lie.
    fn fourier(&self) -> &Brick;
    /// Reals in an array that is transformed: room for either brick.
    fn length(&self) -> usize;
    /// Cells to modes, not normalised.
    ///
    /// # Errors
    /// `Length` if `data` is not `length` reals; `Hook` if the caller's transform failed.
    fn forward(&mut self, data: &mut [T]) -> Result<()>;
    /// Modes to cells, not normalised.
    ///
    /// # Errors
    /// As [`Fft3::forward`].
    fn inverse(&mut self, data: &mut [T]) -> Result<()>;
    /// Replaces each value by its sum over all processes that hold a part of the mesh. The default is right for a whole
    /// mesh in one process.
    ///
    /// # Errors
    /// `Hook` if the mesh is not whole and the caller gave no sum.
    fn all_sum(&mut self, values: &mut [f64]) -> Result<()> {
        let _ = values;
        if self.configuration().is_whole() { Ok(()) } else { Err(crate::status::Error::Hook) }
    }
}

#[cfg(test)]
mod tests;
