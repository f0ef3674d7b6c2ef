//! The built-in transform on memory of its own.

use fixpair::exec::Exec;
use fixpair::fft::{Tables, Transform};
use fixpair::mesh::{Brick, Space};
use fixpair::real::Real;

use crate::Failure;
use crate::memory::Memory;

/// Lends a transform of side n for the time of a call.
pub(crate) fn with_transform<T: Real, R>(
    n: usize,
    exec: &dyn Exec,
    body: impl FnOnce(&mut Transform<'_, T>) -> Result<R, Failure>,
) -> Result<R, Failure> {
    let mut tables = Memory::new(Tables::<T>::layout(n)?);
    let tables = Tables::<T>::new(n, tables.bytes())?;
    let mut workspace = Memory::new(Transform::<T>::workspace(n)?);
    let cells = Brick::whole(n, Space::Configuration)?;
    body(&mut Transform::new(&tables, cells, workspace.bytes(), exec)?)
}
