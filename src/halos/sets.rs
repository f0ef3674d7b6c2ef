//! Disjoint sets of numbers that threads join at the same time (Anderson & Woll 1991): each number points to a smaller or equal one of its set,
//! and the smallest, the root, to itself. Which numbers are in a set depends on what was joined alone, and so does its root.

use core::sync::atomic::{AtomicU32, Ordering};

pub(super) struct Sets<'a> {
    parent: &'a [AtomicU32],
}

impl<'a> Sets<'a> {
    /// Every number alone.
    pub(super) fn new(parent: &'a mut [u32]) -> Self {
        for (i, parent) in parent.iter_mut().enumerate() {
            *parent = i as u32;
        }
        let (start, length) = (parent.as_mut_ptr(), parent.len());
        // SAFETY: an AtomicU32 has the size, alignment and bit patterns of a u32 here (checked below), and the exclusive borrow lasts as long.
        let parent = unsafe { core::slice::from_raw_parts(start.cast::<AtomicU32>(), length) };
        Self { parent }
    }

    /// A number nearer to the root, or the root. No order between threads is needed: a parent read late is still of the same set.
    #[inline(always)]
    pub(super) fn parent(&self, i: u32) -> u32 {
        self.parent.get(i as usize).map_or(i, |parent| parent.load(Ordering::Relaxed))
    }

    #[inline(always)]
    fn set_parent(&self, i: u32, to: u32) {
        if let Some(parent) = self.parent.get(i as usize) {
            parent.store(to, Ordering::Relaxed);
        }
    }

    /// The root, and shortens the way to it.
    #[inline(always)]
    pub(super) fn root(&self, mut i: u32) -> u32 {
        loop {
            let parent = self.parent(i);
            if parent == i {
                return i;
            }
            let next = self.parent(parent);
            if next != parent {
                // Only roots change by exchange, and this is none: any value stored here is one of its set below it.
                self.set_parent(i, next);
            }
            i = next;
        }
    }

    /// Makes two sets one.
    #[inline]
    pub(super) fn join(&self, a: u32, b: u32) {
        let (mut a, mut b) = (a, b);
        loop {
            (a, b) = (self.root(a), self.root(b));
            if a == b {
                return;
            }
            let (low, high) = (a.min(b), a.max(b));
            let Some(parent) = self.parent.get(high as usize) else { return };
            if parent.compare_exchange(high, low, Ordering::Relaxed, Ordering::Relaxed).is_ok() {
                return;
            }
        }
    }

    /// Points a number straight to its root, for good: once nothing is joined any more, threads may flatten different numbers at the same time.
    #[inline]
    pub(super) fn flatten(&self, i: u32) {
        // The way is only read: shortening it would write numbers that another thread has flattened, or is about to.
        let mut root = i;
        while self.parent(root) != root {
            root = self.parent(root);
        }
        self.set_parent(i, root);
    }
}

const _: () =
    assert!(align_of::<AtomicU32>() == align_of::<u32>() && size_of::<AtomicU32>() == size_of::<u32>());
