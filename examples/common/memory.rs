//! Memory for kernels that take it from their caller.

use fixpair::scratch::Layout;

/// As many bytes as a layout asks for, aligned as it asks.
pub(crate) struct Memory {
    bytes: Vec<u8>,
    start: usize,
    size: usize,
}

impl Memory {
    pub(crate) fn new(layout: Layout) -> Self {
        let bytes = vec![0; layout.size + layout.align];
        let start = bytes.as_ptr().align_offset(layout.align);
        Self { bytes, start, size: layout.size }
    }

    pub(crate) fn bytes(&mut self) -> &mut [u8] {
        &mut self.bytes[self.start..][..self.size]
    }
}
