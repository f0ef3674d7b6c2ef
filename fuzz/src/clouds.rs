//! Particles where a host may keep them: three arrays, triples, or members of a larger struct.

use crate::c::*;
use crate::input::Input;
use crate::memory::{Float, Memory};

/// Three coordinates for each of `count` particles, `stride` apart.
pub struct Cloud<T> {
    pub memory: Memory<T>,
    pub count: usize,
    pub stride: usize,
}

/// Side of the box of most particles.
pub const BOX: f64 = 100.0;

impl<T: Float> Cloud<T> {
    /// Places of any kind: anywhere, on a lattice with its edges and middles, in one cell, or all in one place; some far from the box.
    pub fn places(input: &mut Input, count: usize, box_size: f64) -> Self {
        let kind = input.few(6);
        let mut random = input.random();
        let mut all = Self::of(input, count, |_| match kind {
            0 | 1 => box_size * random.unit(),
            2 => box_size * random.below(33) as f64 / 32.0,
            3 => box_size * (0.5 + random.unit() / 64.0),
            4 => 0.25 * box_size,
            _ => box_size * (4.0 * random.unit() - 2.0),
        });
        all.memory.spoil(input);
        all
    }

    /// Numbers in [low, high), such as velocities.
    pub fn between(input: &mut Input, count: usize, low: f64, high: f64) -> Self {
        let mut random = input.random();
        let mut all = Self::of(input, count, |_| low + (high - low) * random.unit());
        all.memory.spoil(input);
        all
    }

    fn of(input: &mut Input, count: usize, mut value: impl FnMut(usize) -> f64) -> Self {
        let stride = [3, 1, 4, 7][input.few(4)];
        let len = if count == 0 {
            0
        } else if stride == 1 {
            3 * count
        } else {
            stride * (count - 1) + 3
        };
        let lead = if input.odd(8) { 1 + input.few(3) } else { 0 };
        Self { memory: Memory::behind(lead, len, |place| T::of(value(place))), count, stride }
    }

    /// Where coordinate `axis` of particle `i` is.
    pub fn place(&self, i: usize, axis: usize) -> usize {
        if self.stride == 1 { axis * self.count + i } else { i * self.stride + axis }
    }

    pub fn at(&self, i: usize) -> [T; 3] {
        [0, 1, 2].map(|axis| self.memory.values()[self.place(i, axis)])
    }

    /// Pointers to the coordinates of the first particle, stride, and particles, as the caller declares them.
    fn parts(&self, input: &mut Input) -> ([*mut T; 3], usize, usize) {
        let first = input.pointer(&self.memory);
        let of = |axis| if self.count == 0 { first } else { first.wrapping_add(self.place(0, axis)) };
        let shared = if first.is_null() { [first; 3] } else { [of(0), of(1), of(2)] };
        let stride = if input.odd(64) { [0, usize::MAX][input.few(2)] } else { self.stride };
        let count = if input.odd(64) { input.few(self.count.min(255) + 1) } else { self.count };
        // Far strides reach beyond all memory with two particles, and are not looked at with one.
        (shared, stride, count)
    }

    /// Are the numbers between the particles those of before?
    pub fn gaps(&self) -> u64 {
        let places = 0..self.memory.len();
        let gap = |place: &usize| self.stride > 3 && place % self.stride >= 3;
        places.filter(gap).fold(0, |hash: u64, place| {
            hash.rotate_left(5).wrapping_mul(0x9e37_79b9) ^ self.memory.values()[place].to().to_bits()
        })
    }

    /// Is it this cloud, all of it, that the library was shown?
    pub fn shown(&self, x: *const T, length: usize) -> bool {
        x == self.memory.pointer().cast_const() && length == self.count
    }

    pub fn inside(&self, box_size: f64) -> bool {
        let inside = |x: T| x.to() >= 0.0 && x.to() < box_size;
        (0..self.count).all(|i| self.at(i).into_iter().all(inside))
    }

    pub fn finite(&self) -> bool {
        (0..self.count).all(|i| self.at(i).into_iter().all(|x| x.to().is_finite()))
    }
}

macro_rules! declared {
    ($r:ident) => {
        pastey::paste! {
            impl Cloud<$r> {
                pub fn components(&self, input: &mut Input) -> [<fixpair_components_ $r>] {
                    let ([x, y, z], stride, length) = self.parts(input);
                    [<fixpair_components_ $r>] { x, y, z, stride, length }
                }

                pub fn positions(&self, input: &mut Input) -> [<fixpair_positions_ $r>] {
                    let ([x, y, z], stride, length) = self.parts(input);
                    [<fixpair_positions_ $r>] { x, y, z, stride, length }
                }
            }
        }
    };
}

declared!(f64);
declared!(f32);
