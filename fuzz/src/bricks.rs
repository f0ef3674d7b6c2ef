//! Parts of meshes, and memory for them.

use crate::c::*;
use crate::input::Input;
use crate::memory::{Float, Memory};

/// No mesh of the targets has more reals: 14 * 14 * 16 and some.
const MOST: usize = 4096;

pub const CELLS: i32 = FIXPAIR_SPACE_CONFIGURATION;
pub const MODES: i32 = FIXPAIR_SPACE_FOURIER;

const NOTHING: fixpair_brick = fixpair_brick { n: 0, space: 0, start: [0; 3], count: [0; 3], stride: [0; 3] };

pub fn whole(n: usize, space: i32) -> fixpair_brick {
    let mut brick = NOTHING;
    must!(fixpair_brick_whole(&mut brick, n, space, 0));
    brick
}

/// The whole mesh, a slab, a pencil in any order of axes with gaps, or numbers that make no brick.
pub fn brick(input: &mut Input, space: i32) -> fixpair_brick {
    let n = input.side();
    let space = if input.odd(16) { input.choice(2) } else { space };
    let mut brick = NOTHING;
    match input.few(8) {
        0..2 => {
            let padding = if input.odd(8) { input.about(5) } else { 0 };
            let _ = call!(fixpair_brick_whole(&mut brick, n, space, padding));
        }
        2 => {
            let _ = call!(fixpair_brick_slab(&mut brick, n, space, input.about(8), input.about(8)));
        }
        3 => {
            let _ = call!(fixpair_brick_transposed_slab(&mut brick, n, input.about(8), input.about(8)));
        }
        4..7 => brick = pencil(input, n, space),
        _ => {
            brick = fixpair_brick {
                n,
                space,
                start: [0; 3].map(|_| input.about(8)),
                count: [0; 3].map(|_| input.about(8)),
                stride: [0; 3].map(|_| input.about(64)),
            };
        }
    }
    brick
}

/// Axes nested in any order, each with a gap.
fn pencil(input: &mut Input, n: usize, space: i32) -> fixpair_brick {
    let extent = |axis| if axis == 2 && space == MODES { n / 2 + 1 } else { n };
    let mut brick = fixpair_brick { n, space, ..NOTHING };
    let order = [[2, 1, 0], [2, 0, 1], [1, 2, 0], [1, 0, 2], [0, 1, 2], [0, 2, 1]][input.few(6)];
    let mut stride = 1 + input.few(3);
    for axis in order {
        let extent = extent(axis);
        brick.start[axis] = input.few(extent.clamp(1, 14));
        let left = extent - brick.start[axis];
        brick.count[axis] = if input.flag() { input.about(extent.clamp(1, 14)) } else { left.min(14) };
        brick.stride[axis] = stride;
        stride = stride.saturating_mul(brick.count[axis].max(1)).saturating_add(input.few(3));
    }
    brick
}

/// A part that may run over the edge of the mesh.
pub fn region(input: &mut Input) -> fixpair_brick {
    let inner = brick(input, CELLS);
    let mut ghosted = inner;
    if input.flag() {
        let shift = [0.0, 0.5, input.about_number(0.5)][input.few(3)];
        let _ =
            call!(fixpair_brick_with_ghosts(&mut ghosted, &inner, 1 + input.choice(4).min(1 << 20), shift));
    }
    ghosted
}

/// How many reals the brick needs, if it is one.
fn needed(brick: &fixpair_brick) -> Option<usize> {
    let mut reals = 0;
    (call!(fixpair_brick_reals(&mut reals, brick)) == 0).then_some(reals)
}

/// The same; a few where there is no brick or it needs more than the targets use.
pub fn reals(brick: &fixpair_brick) -> usize {
    needed(brick).unwrap_or(64).min(MOST)
}

/// Numbers for a brick, sometimes too few or more than it needs.
pub fn mesh<T: Float>(input: &mut Input, brick: &fixpair_brick) -> Memory<T> {
    let needed = reals(brick);
    let len = if input.odd(32) { needed.saturating_sub(1 + input.few(3)) } else { needed + input.few(2) };
    Memory::floats(input, len, -1.0, 1.0)
}

/// Places of the reals that belong to elements: what lies between them is no business of the library.
pub fn elements(brick: &fixpair_brick, len: usize) -> Vec<bool> {
    let mut of = vec![false; len];
    let width = if brick.space == MODES { 2 } else { 1 };
    if needed(brick).is_some_and(|needed| needed <= len) {
        let [x, y, z] = brick.count;
        for (a, b, c) in (0..x).flat_map(|a| (0..y).flat_map(move |b| (0..z).map(move |c| (a, b, c)))) {
            let at = width * (a * brick.stride[0] + b * brick.stride[1] + c * brick.stride[2]);
            of[at..at + width].fill(true);
        }
    }
    of
}

/// What lies between the elements, to be compared before and after.
pub struct Gaps(Vec<(usize, u64)>);

impl Gaps {
    pub fn of<T: Float>(memory: &Memory<T>, brick: &fixpair_brick) -> Self {
        let of = elements(brick, memory.len());
        let between = (0..memory.len()).filter(|&place| !of[place]);
        Self(between.map(|place| (place, memory.values()[place].to().to_bits())).collect())
    }

    pub fn check<T: Float>(&self, memory: &Memory<T>) {
        for &(place, bits) in &self.0 {
            assert_eq!(memory.values()[place].to().to_bits(), bits, "between the elements, at {place}");
        }
    }
}
