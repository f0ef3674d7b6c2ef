//! Sums of power spectra and correlation functions against plain loops.

use core::ptr::null;

use crate::bricks::{CELLS, MODES, reals, whole};
use crate::c::*;
use crate::estimate::binning::{Bin, Binning, Second};
use crate::estimate::compensation::Compensation;
use crate::hooks::{layout, scratch_for};
use crate::input::Input;
use crate::memory::Memory;
use crate::pm::Window;
use crate::reference::power::{Slow, correlation, power};
use crate::same::close;

/// Edges that no mu or |n.a| of an axis below lies on by rounding, but for those of the ends.
const COSINES: [&[f64]; 2] = [&[0.0, 0.21, 0.43, 0.77, 1.0], &[0.11, 0.52, 0.9]];
const PARALLELS: [&[f64]; 2] = [&[0.0, 1.0, 2.3, 8.0], &[1.0, 1.7, 4.0]];
const AXES: [[f64; 3]; 5] =
    [[0.0, 0.0, 1.0], [0.0, 3.3, 0.0], [-2.0, 0.0, 0.0], [1.0, 2.0, 3.0], [0.3, -0.8, 0.01]];

const WINDOWS: [Window; 4] = [
    Window::NearestGridPoint,
    Window::CloudInCell,
    Window::TriangularShapedCloud,
    Window::PiecewiseCubicSpline,
];

fn compensation(input: &mut Input) -> (Compensation, i32) {
    let which = input.few(4);
    match input.few(3) {
        0 => (Compensation::None, FIXPAIR_COMPENSATION_NONE),
        1 => (Compensation::Window(WINDOWS[which]), FIXPAIR_COMPENSATION_WINDOW + which as i32 + 1),
        _ => (Compensation::Aliased(WINDOWS[which]), FIXPAIR_COMPENSATION_ALIASED + which as i32 + 1),
    }
}

pub fn run(data: &[u8]) {
    let input = &mut Input::new(data);
    let n = [4, 2, 4, 6, 4, 2, 4, 8][input.few(8)];
    let mut edge = input.few(4) as u64;
    let edges = Memory::new(2 + input.few(5), |_| {
        edge += 1 + input.few(12) as u64;
        edge - 1
    });
    let axis = AXES[input.few(5)];
    let second = match input.few(3) {
        0 => Second::None,
        1 => Second::Cosine(COSINES[input.few(2)]),
        _ => Second::Parallel(PARALLELS[input.few(2)]),
    };
    let binning = Binning { edges: edges.values(), second, axis, orders: 1 + input.few(31) as u32 };
    let (kind, second_edges) = match second {
        Second::None => (FIXPAIR_SECOND_NONE, &[][..]),
        Second::Cosine(edges) => (FIXPAIR_SECOND_COSINE, edges),
        Second::Parallel(edges) => (FIXPAIR_SECOND_PARALLEL, edges),
    };
    let asked = fixpair_binning {
        struct_size: size_of::<fixpair_binning>(),
        edges: edges.pointer(),
        edges_len: edges.len(),
        second: kind,
        orders: binning.orders,
        second_edges: second_edges.as_ptr(),
        second_edges_len: second_edges.len(),
        axis,
    };
    let (mut bins_len, mut values_len, mut words) = (0, 0, 0);
    must!(fixpair_binning_lengths(&mut bins_len, &mut values_len, &mut words, &asked, 1));
    let sums = Memory::new(words, |_| 0_i64);
    let mut layout = layout();
    let mut random = input.random();
    let of_modes = input.flag();
    let brick = whole(n, if of_modes { MODES } else { CELLS });
    let len = reals(&brick);
    let [first, other] = [0; 2].map(|_| Memory::new(len, |_| random.unit() - 0.5));
    let fields = [first.pointer().cast_const(), other.pointer()];
    let slow = if of_modes {
        let pair = [0, input.few(2)];
        let (own, code) = compensation(input);
        let (others, other_code) = if pair[1] == 0 { (own, code) } else { compensation(input) };
        must!(fixpair_power_sums_scratch(&mut layout, &brick, &asked, 1));
        let scratch = scratch_for(&mut Input::new(&[]), 0, layout);
        must!(fixpair_power_sums_f64(
            sums.pointer(),
            words,
            fields.as_ptr(),
            2,
            len,
            pair.as_ptr(),
            1,
            [code, other_code].as_ptr(),
            &brick,
            &asked,
            scratch.pointer().cast(),
            scratch.len(),
            null()
        ));
        power(first.values(), [&first, &other][pair[1]].values(), [own, others], n, &binning)
    } else {
        must!(fixpair_correlation_sums_scratch(&mut layout, &brick, &asked, 1));
        let scratch = scratch_for(&mut Input::new(&[]), 0, layout);
        must!(fixpair_correlation_sums_f64(
            sums.pointer(),
            words,
            fields.as_ptr(),
            1,
            len,
            &brick,
            &asked,
            scratch.pointer().cast(),
            scratch.len(),
            null()
        ));
        correlation(first.values(), n, &binning)
    };
    let (bins, values) = (Memory::<Bin>::zeros(bins_len), Memory::new(values_len, |_| 7.0));
    must!(fixpair_binning_read(
        bins.pointer(),
        bins_len,
        values.pointer(),
        values_len,
        sums.pointer(),
        words,
        &asked,
        1
    ));
    compare(&binning, bins.values(), values.values(), &slow, of_modes);
}

fn compare(binning: &Binning<'_>, bins: &[Bin], values: &[f64], slow: &[Slow], of_modes: bool) {
    let orders: Vec<usize> = (0..5).filter(|l| binning.orders >> l & 1 == 1).collect();
    // Roundings of a thousand terms, none above the largest product: both fields are below 0.5, a compensation of PCS is below 40.
    let scale = slow.iter().flat_map(|bin| bin.sums[0]).fold(1.0, |most: f64, sum| most.max(sum.abs()));
    for ((bin, slow), values) in bins.iter().zip(slow).zip(values.chunks_exact(orders.len())) {
        assert_eq!(bin.count, slow.count, "{binning:?}");
        let count = slow.count.max(1) as f64;
        // 2^-40 in the fixed-point sums; and |n.a| = 0 may come out as 1e-16, the root of n_perp^2 = 0 as 1e-8.
        close(bin.first, slow.first / count, 1e-7, "first coordinate");
        close(bin.second, slow.second / count, 1e-11, "second coordinate");
        for (&value, &order) in values.iter().zip(&orders) {
            let expected = slow.sums[order][if of_modes { order % 2 } else { 0 }];
            close(value, expected, 1e-11 * scale, "sum");
        }
    }
}
