//! Built-in transforms for tests, on memory that is never freed.

use std::boxed::Box;
use std::vec;

use crate::exec::{Exec, Serial};
use crate::fft::{Tables, Transform};
use crate::mesh::{Brick, Space};
use crate::real::Real;
use crate::scratch::Layout;

/// As many bytes as asked for, aligned as asked for.
pub(crate) fn memory(layout: Layout) -> &'static mut [u8] {
    let bytes = Box::leak(vec![0; layout.size + layout.align].into_boxed_slice());
    let start = bytes.as_ptr().align_offset(layout.align);
    &mut bytes[start..start + layout.size]
}

pub(crate) fn transform<T: Real>(n: usize, exec: &'static dyn Exec) -> Transform<'static, T> {
    let tables = Tables::<T>::new(n, memory(Tables::<T>::layout(n).unwrap())).unwrap();
    let workspace = memory(Transform::<T>::workspace(n).unwrap());
    let cells = Brick::whole(n, Space::Configuration).unwrap();
    Transform::new(Box::leak(Box::new(tables)), cells, workspace, exec).unwrap()
}

pub(crate) fn serial<T: Real>(n: usize) -> Transform<'static, T> {
    transform(n, &Serial)
}
