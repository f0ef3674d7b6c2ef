//! Memory and built-in transforms for tests.

use std::boxed::Box;
use std::vec;
use std::vec::Vec;

use crate::exec::{Exec, Serial};
use crate::fft::{Tables, Transform};
use crate::mesh::{Brick, Space};
use crate::real::Real;
use crate::scratch::Layout;

/// As many bytes as asked for, aligned as asked for, and never freed.
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

/// Memory for a layout that is freed with it, and is not zero at first.
pub(crate) struct Memory(Vec<u8>, usize, usize);

impl Memory {
    pub(crate) fn new(layout: Layout) -> Self {
        let bytes = vec![0xff; layout.size + layout.align];
        let skip = bytes.as_ptr().align_offset(layout.align);
        Self(bytes, skip, layout.size)
    }

    pub(crate) fn get(&mut self) -> &mut [u8] {
        &mut self.0[self.1..self.1 + self.2]
    }
}
