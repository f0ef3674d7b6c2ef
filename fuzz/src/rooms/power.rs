//! Binnings, power spectra, correlation functions and shot noise.

use core::ptr::null;

use crate::bricks::{CELLS, Gaps, MODES, brick, mesh};
use crate::c::*;
use crate::check::Before;
use crate::hooks::{exec, layout, pointer, scratch_for};
use crate::input::Input;
use crate::memory::{Float, Memory};
use crate::rooms::meshes::compensation;

pub fn run(data: &[u8]) {
    let input = &mut Input::new(data);
    match input.few(9) {
        0 => power_f64(input),
        1 => power_f32(input),
        2 => correlation_f64(input),
        3 => correlation_f32(input),
        4 => modes_f64(input),
        5 => modes_f32(input),
        6 => shot_noise_f64(input),
        7 => shot_noise_f32(input),
        _ => edges(input),
    }
}

/// Increasing edges for the most part.
pub fn some_edges(input: &mut Input, most: usize) -> Memory<u64> {
    let mut edge = input.about(4) as u64;
    let len = if input.odd(16) { input.few(most + 1) } else { 2 + input.few(most - 1) };
    Memory::new(len, |_| {
        let this = edge;
        edge = if input.odd(32) { input.word() } else { edge.saturating_add(1 + input.few(8) as u64) };
        this
    })
}

fn edges(input: &mut Input) {
    let edges = Memory::new(input.few(8), |_| 7_u64);
    let before = Before::of(&[&edges]);
    let (to, len) = (input.pointer(&edges), input.length(edges.len()));
    let status = match input.few(3) {
        0 => call!(fixpair_edges_uniform(to, len, input.about_number(0.0), input.about_number(1.0))),
        1 => call!(fixpair_edges_exact(to, len, input.about(9) as u64)),
        _ => {
            let wavenumbers = Memory::floats(input, edges.len(), 0.0, 0.5);
            call!(fixpair_edges_wavenumbers(to, input.pointer(&wavenumbers), len, input.about_number(100.0)))
        }
    };
    before.check(status, &[]);
    assert!(
        status != 0 || edges.values()[..len.min(edges.len())].windows(2).all(|pair| pair[0] < pair[1]),
        "edges increase"
    );
}

/// A binning of all kinds, which refers to its edges.
struct Bins {
    edges: Memory<u64>,
    second_edges: Memory<f64>,
    binning: fixpair_binning,
}

impl Bins {
    fn new(input: &mut Input) -> Self {
        let edges = some_edges(input, 5);
        let of = Memory::<fixpair_binning>::zeros(1);
        let _ = call!(fixpair_binning_init(of.pointer(), input.pointer(&edges), input.length(edges.len())));
        let mut binning = of.values()[0];
        let mut second_edges = Memory::new(input.few(5), |place| place as f64 / 3.0);
        second_edges.spoil(input);
        if input.odd(16) {
            binning.struct_size = input.size();
        }
        if input.flag() {
            binning.orders = if input.odd(32) { input.word() as u32 } else { 1 + input.few(31) as u32 };
            binning.axis =
                [0, 0, 1].map(|axis| if input.odd(4) { input.about_number(1.0) } else { f64::from(axis) });
            binning.second = input.choice(3);
            if binning.second != 0 || input.odd(16) {
                binning.second_edges = input.pointer(&second_edges);
                binning.second_edges_len = input.length(second_edges.len());
            }
        }
        Self { edges, second_edges, binning }
    }

    /// Bins, values and words of so many spectra; a few where the binning is refused.
    fn lengths(&self, spectra: usize) -> [usize; 3] {
        assert!(self.edges.len() < 6 && self.second_edges.len() < 5);
        let mut lengths = [0; 3];
        let [bins, values, words] = &mut lengths;
        let status = call!(fixpair_binning_lengths(bins, values, words, &self.binning, spectra));
        if status == 0 { lengths.map(|length| length.min(1 << 12)) } else { [4, 4, 64] }
    }

    /// Reads sums into values, normalises these and subtracts shot noise, each with lengths that may be wrong.
    fn read(&self, input: &mut Input, sums: &Memory<i64>, spectra: usize, pairs: &Memory<usize>) {
        let [bins_len, values_len, _] = self.lengths(spectra);
        let (bins, values) = (Memory::zeros(bins_len), Memory::new(values_len, |_| 7.0));
        let before = Before::of(&[&bins, &values]);
        let status = call!(fixpair_binning_read(
            input.pointer(&bins),
            input.length(bins_len),
            input.pointer(&values),
            input.length(values_len),
            input.pointer(sums),
            input.length(sums.len()),
            &self.binning,
            spectra
        ));
        before.check(status, &[]);
        assert!(status != 0 || values.all_finite(), "what is read is finite");
        let before = Before::of(&[&values]);
        let factor = input.about_number(1e6);
        let status = call!(fixpair_binning_normalise(
            input.pointer(&values),
            input.length(values_len),
            input.pointer(&bins),
            input.length(bins_len),
            self.binning.orders,
            factor
        ));
        before.check(status, &[]);
        let noises = Memory::<f64>::floats(input, 2, 0.0, 1e3);
        let before = Before::of(&[&values]);
        let status = call!(fixpair_subtract_shot_noise(
            input.pointer(&values),
            input.length(values_len),
            input.pointer(pairs),
            input.length(spectra.min(pairs.len() / 2)),
            input.pointer(&bins),
            input.length(bins_len),
            self.binning.orders,
            input.pointer(&noises),
            input.length(2)
        ));
        before.check(status, &[]);
    }
}

macro_rules! in_precision {
    ($r:ident) => {
        pastey::paste! {
            fn [<power_ $r>](input: &mut Input) {
                let bins = Bins::new(input);
                let brick = brick(input, MODES);
                let (first, second) = (mesh::<$r>(input, &brick), mesh::<$r>(input, &brick));
                let fields = [first.pointer().cast_const(), second.pointer(), if input.odd(16) { null() } else { first.pointer() }];
                let spectra = input.few(3);
                let mut pairs = Memory::new(4, |place| place % 2);
                if input.odd(4) {
                    pairs.values_mut()[input.few(4)] = input.about(4);
                }
                let [_, _, words] = bins.lengths(spectra);
                let mut random = input.random();
                let sums = Memory::new(words, |_| (random.word() >> 60) as i64);
                let compensations = Memory::new(3, |_| compensation(input));
                let mut layout = layout();
                let asked = call!(fixpair_power_sums_scratch(&mut layout, &brick, &bins.binning, spectra));
                let scratch = scratch_for(input, asked, layout);
                let exec = exec(input);
                let before = Before::of(&[&sums]);
                let fields_len = 1 + input.few(3);
                let len = first.len().min(second.len());
                let status = call!([<fixpair_power_sums_ $r>](
                    input.pointer(&sums), input.length(words), fields.as_ptr(), fields_len, input.length(len), input.pointer(&pairs),
                    spectra, input.optional(&compensations), &brick, &bins.binning, input.pointer(&scratch).cast(), input.length(scratch.len()), pointer(&exec)
                ));
                before.check(status, &[FIXPAIR_ERROR_HOOK]);
                bins.read(input, &sums, spectra, &pairs);
            }

            fn [<correlation_ $r>](input: &mut Input) {
                let bins = Bins::new(input);
                let brick = brick(input, CELLS);
                let (first, second) = (mesh::<$r>(input, &brick), mesh::<$r>(input, &brick));
                let meshes = [first.pointer().cast_const(), second.pointer(), if input.odd(16) { null() } else { first.pointer() }];
                let spectra = input.few(4);
                let [_, _, words] = bins.lengths(spectra);
                let sums = Memory::new(words, |_| 0_i64);
                let mut layout = layout();
                let asked = call!(fixpair_correlation_sums_scratch(&mut layout, &brick, &bins.binning, spectra));
                let scratch = scratch_for(input, asked, layout);
                let exec = exec(input);
                let before = Before::of(&[&sums]);
                let len = first.len().min(second.len());
                let status = call!([<fixpair_correlation_sums_ $r>](
                    input.pointer(&sums), input.length(words), meshes.as_ptr(), spectra, input.length(len), &brick, &bins.binning,
                    input.pointer(&scratch).cast(), input.length(scratch.len()), pointer(&exec)
                ));
                before.check(status, &[FIXPAIR_ERROR_HOOK]);
                bins.read(input, &sums, spectra, &Memory::new(0, |_| 0));
            }

            fn [<modes_ $r>](input: &mut Input) {
                let brick = brick(input, MODES);
                let (modes, other) = (mesh::<$r>(input, &brick), mesh::<$r>(input, &brick));
                let [own, others] = [0; 2].map(|_| compensation(input));
                let mut layout = layout();
                let asked = call!(fixpair_correlation_modes_scratch(&mut layout, &brick));
                let scratch = scratch_for(input, asked, layout);
                let exec = exec(input);
                let (before, gaps) = (Before::of(&[&modes]), Gaps::of(&modes, &brick));
                let len = modes.len().min(other.len());
                let same = if input.flag() { input.pointer(&other) } else { modes.pointer() };
                let status = call!([<fixpair_correlation_modes_ $r>](
                    input.pointer(&modes), same, input.length(len), own, others, input.about_number(1.0), &brick, input.pointer(&scratch).cast(),
                    input.length(scratch.len()), pointer(&exec)
                ));
                before.check(status, &[FIXPAIR_ERROR_HOOK]);
                gaps.check(&modes);
            }

            fn [<shot_noise_ $r>](input: &mut Input) {
                let particles = input.few(64);
                let stride = input.few(3);
                let weights = Memory::<$r>::floats(input, particles * stride.max(1), 0.0, 2.0);
                let noise = Memory::new(1, |_| 7.0);
                let before = Before::of(&[&noise]);
                let status = call!([<fixpair_shot_noise_ $r>](
                    input.pointer(&noise), input.optional(&weights), stride, particles, input.about_number(100.0)
                ));
                before.check(status, &[]);
                assert!(status != 0 || noise.values()[0].to().is_finite(), "shot noise is finite");
            }
        }
    };
}

in_precision!(f64);
in_precision!(f32);
