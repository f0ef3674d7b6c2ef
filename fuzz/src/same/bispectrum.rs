//! Counts of triangles and sums of products against loops over triples of modes.

use core::ptr::{null, null_mut};

use crate::c::*;
use crate::hooks::{double, layout, scratch_for};
use crate::input::Input;
use crate::memory::Memory;
use crate::reference::bispectrum::{shell, triples};
use crate::same::close;

const WORDS: usize = FIXPAIR_BISPECTRUM_WORDS;

pub fn run(data: &[u8]) {
    let input = &mut Input::new(data);
    let n = if input.few(16) == 15 { 6 } else { 4 };
    let last = (n / 2 * (n / 2)) as u64;
    let mut edge = input.few(2) as u64;
    let mut edges: Vec<u64> = vec![edge];
    while edge < last && edges.len() < 5 {
        edge = (edge + 1 + input.few(6) as u64).min(last);
        edges.push(edge);
    }
    let shells: Vec<_> = edges.windows(2).map(|pair| shell(n, pair[0], pair[1])).collect();
    // Two at most, or one of the many triples of a wider mesh: slow twins are slow.
    let triangles: Vec<u32> = (0..3 * (1 + input.few(if n == 4 { 2 } else { 1 })))
        .map(|_| input.few(shells.len()) as u32)
        .collect();
    let count = triangles.len() / 3;
    let mut random = input.random();
    let fft = double(n);
    let modes = Memory::new(fft.length, |_| random.unit() - 0.5);
    // Reality: conjugates on the planes l = 0 and n/2 come from a transform of reals.
    let (Some(forward), true) = (fft.forward, fft.length > 0) else {
        unreachable!("the built-in transform has both")
    };
    // SAFETY: `length` reals of the layout that the transform says.
    assert_eq!(unsafe { forward(fft.context, modes.pointer()) }, 0);
    let mut layout = layout();
    must!(fixpair_triangle_counts_scratch(
        &mut layout,
        triangles.as_ptr(),
        count,
        edges.as_ptr(),
        edges.len(),
        n
    ));
    let scratch = scratch_for(&mut Input::new(&[]), 0, layout);
    let counts = Memory::new(count, |_| 7_u64);
    must!(fixpair_triangle_counts(
        counts.pointer(),
        triangles.as_ptr(),
        count,
        edges.as_ptr(),
        edges.len(),
        n,
        scratch.pointer().cast(),
        scratch.len(),
        null()
    ));
    let mut reals = 0;
    must!(fixpair_bispectrum_meshes_f64(&mut reals, &fft, 3 + input.few(3)));
    let fields = Memory::new(reals, |_| 7.0);
    must!(fixpair_bispectrum_scratch_f64(&mut layout, &fft, edges.len() - 1, count));
    let scratch = scratch_for(&mut Input::new(&[]), 0, layout);
    let (sums, values) = (Memory::new(WORDS * count, |_| 0_i64), Memory::new(count, |_| 7.0));
    must!(fixpair_bispectrum_f64(
        sums.pointer(),
        sums.len(),
        null_mut(),
        triangles.as_ptr(),
        count,
        edges.as_ptr(),
        edges.len(),
        modes.pointer(),
        modes.len(),
        &fft,
        fields.pointer(),
        fields.len(),
        scratch.pointer().cast(),
        scratch.len(),
        null()
    ));
    must!(fixpair_bispectrum_values(values.pointer(), count, sums.pointer(), sums.len()));
    let cells = (n * n * n) as f64;
    for (place, triangle) in triangles.chunks_exact(3).enumerate() {
        let of = [0, 1, 2].map(|side| shells[triangle[side] as usize].as_slice());
        let (expected_count, sum) = triples(modes.values(), n, of);
        assert_eq!(counts.values()[place], expected_count, "n = {n}, {edges:?}, {triangle:?}");
        // Rounding of transforms and products against the product of the fields' r.m.s.; modes are of the size of sqrt(n^3/12).
        let size = (cells / 12.0).powf(1.5);
        let scale =
            of.iter().map(|shell| (shell.len() as f64).sqrt()).product::<f64>() + expected_count as f64;
        close(
            values.values()[place] / cells,
            sum,
            1e-13 * scale * size,
            format_args!("n = {n}, {edges:?}, {triangle:?}"),
        );
    }
}
