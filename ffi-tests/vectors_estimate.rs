//! The cases of spectra, correlation functions and bispectra.

use fixpair::estimate::binning::{Bin, Binning, Second, normalise, read_sums};
use fixpair::estimate::bispectrum::{
    self, Triangle, bispectrum, bispectrum_meshes, bispectrum_scratch, bispectrum_sums,
    bispectrum_sums_scratch, bispectrum_values, closed_triangle_count, closed_triangles, shell_modes,
    squeezed_triangles, triangle_counts, triangle_counts_scratch,
};
use fixpair::estimate::compensation::{Compensation, compensate, compensate_scratch};
use fixpair::estimate::correlation::{
    correlation_modes, correlation_modes_scratch, correlation_sums, correlation_sums_scratch,
};
use fixpair::estimate::edges::{exact_edges, uniform_edges, wavenumber_edges};
use fixpair::estimate::exact::ExactSum;
use fixpair::estimate::power::{power_sums, power_sums_scratch, shot_noise, subtract_shot_noise};
use fixpair::exec::Serial;
use fixpair::fft::Fft3;
use fixpair::mesh::{Brick, Space};
use fixpair::noise::{Amplitude, Phase, Realisation, white_modes};
use fixpair::pm::Window;
use fixpair::real::Real;
use fixpair::scratch::Layout;

use crate::vectors::{BOX, Cases, Hash, N, SEED, noise};
use crate::vectors_real::{Memory, elements, with_transform};

/// Edges of the shells of triangles, and of spectra with one more.
const EDGES: [u64; 7] = [1, 4, 9, 16, 25, 36, 49];
const SHELLS: usize = 5;
const CENTRES: [f64; SHELLS] = [1.0, 2.0, 3.0, 4.0, 5.0];
const WEDGES: [f64; 5] = [0.0, 0.25, 0.5, 0.75, 1.0];
const PARALLEL: [f64; 4] = [0.0, 1.0, 3.0, 7.0];

fn sizes(hash: Hash, layout: Layout) -> Hash {
    hash.integers(&[layout.size as u64, layout.align as u64])
}

fn words(hash: Hash, sums: &[i64]) -> Hash {
    sums.iter().fold(hash, |hash, word| hash.bytes(&word.to_ne_bytes()))
}

fn numbers(hash: Hash, triangles: &[Triangle]) -> Hash {
    triangles.iter().flatten().fold(hash, |hash, number| hash.bytes(&number.to_ne_bytes()))
}

fn closed(centres: Option<&[f64]>) -> Vec<Triangle> {
    let edges = &EDGES[..=SHELLS];
    let mut triangles = vec![[0; 3]; closed_triangle_count(edges, centres).expect("a count")];
    closed_triangles(&mut triangles, edges, centres).expect("triangles");
    triangles
}

/// Of the triangles that are closed without centres.
fn counts() -> (Layout, Vec<u64>) {
    let (edges, triangles) = (&EDGES[..=SHELLS], closed(None));
    let layout = triangle_counts_scratch(edges, N, &triangles).expect("scratch");
    let mut scratch = Memory::new(layout);
    let mut counts = vec![0; triangles.len()];
    triangle_counts(&mut counts, &triangles, edges, N, scratch.bytes(layout.size), &Serial).expect("counts");
    (layout, counts)
}

/// What does not depend on the precision.
pub(crate) fn bin_cases(cases: &mut Cases) {
    let mut edges = [[0; 5]; 3];
    uniform_edges(&mut edges[0], 1.5, 3.0).expect("edges");
    wavenumber_edges(&mut edges[1], &[0.03, 0.06, 0.1, 0.2, 0.4], BOX).expect("edges");
    exact_edges(&mut edges[2], 3).expect("edges");
    cases.add("edges", Hash::new().integers(edges.as_flattened()));
    let binning = Binning { second: Second::Cosine(&WEDGES), orders: 0b11, ..Binning::shells(&EDGES) };
    let bins = binning.bins().expect("bins");
    let lengths = [bins, 3 * bins * binning.multipoles(), binning.words(3).expect("words")];
    cases.add("binning_lengths", Hash::new().integers(&lengths.map(|length| length as u64)));
    let mut squeezed = [[0; 3]; SHELLS - 1];
    squeezed_triangles(&mut squeezed, 1, SHELLS).expect("triangles");
    let hash = numbers(numbers(Hash::new(), &closed(None)), &closed(Some(&CENTRES)));
    cases.add("triangles", numbers(hash, &squeezed));
    let (layout, counts) = counts();
    cases.add("triangle_counts", sizes(Hash::new(), layout).integers(&counts));
}

pub(crate) fn estimate_cases<T: Real>(add: &mut dyn FnMut(&str, Hash)) {
    let brick = Brick::whole(N, Space::Fourier).expect("a brick");
    let [mut f, mut g] = [(); 2].map(|()| vec![T::ZERO; brick.reals()]);
    let pair = Realisation { amplitude: Amplitude::Fixed, phase: Phase::Inverted, ..Realisation::new(SEED) };
    white_modes(&mut f, &brick, &Realisation::new(SEED), &Serial).expect("modes");
    white_modes(&mut g, &brick, &pair, &Serial).expect("modes");
    power_cases(add, &f, &g, &brick);
    compensation_cases(add, &f, &brick);
    correlation_cases(add, &f, &g, &brick);
    bispectrum_cases(add, &f);
    let weights: Vec<T> = (0..500).map(|i| T::from_f64(1.25 + noise(5 * i))).collect();
    let noises = [shot_noise(Some(&weights), 500, BOX), shot_noise::<T>(None, 500, BOX)];
    add("shot_noise", Hash::new().doubles(&noises.map(|noise| noise.expect("noise"))));
}

/// Bins and their values, un-normalised.
fn read(sums: &[i64], binning: &Binning<'_>, spectra: usize) -> (Vec<Bin>, Vec<f64>) {
    let mut bins = vec![Bin::default(); binning.bins().expect("bins")];
    let mut values = vec![0.0; bins.len() * spectra * binning.multipoles()];
    read_sums(&mut bins, &mut values, sums, binning, spectra).expect("bins");
    (bins, values)
}

fn described(hash: Hash, bins: &[Bin], values: &[f64]) -> Hash {
    let each = |hash: Hash, bin: &Bin| hash.integers(&[bin.count]).doubles(&[bin.first, bin.second]);
    bins.iter().fold(hash, each).doubles(values)
}

fn power_cases<T: Real>(add: &mut dyn FnMut(&str, Hash), f: &[T], g: &[T], brick: &Brick) {
    let run = |binning: &Binning<'_>, pairs: &[[usize; 2]], compensation: &[Compensation]| {
        let layout = power_sums_scratch(brick, binning, pairs.len()).expect("scratch");
        let mut sums = vec![0_i64; binning.words(pairs.len()).expect("words")];
        let mut memory = Memory::new(layout);
        let scratch = memory.bytes(layout.size);
        power_sums(&mut sums, &[f, g], pairs, compensation, brick, binning, scratch, &Serial).expect("sums");
        (layout, sums)
    };
    let multipoles = Binning { axis: [0.0, 0.0, 2.0], orders: 0b10101, ..Binning::shells(&EDGES) };
    let pairs = [[0, 0], [0, 1]];
    let aliased = Compensation::Aliased(Window::CloudInCell);
    let (layout, sums) = run(&multipoles, &pairs, &[Compensation::None, aliased]);
    add("power_sums", words(sizes(Hash::new(), layout), &sums));
    let (bins, mut values) = read(&sums, &multipoles, 2);
    normalise(&mut values, &bins, multipoles.orders, BOX * BOX * BOX).expect("spectra");
    subtract_shot_noise(&mut values, &pairs, &bins, multipoles.orders, &[1.5, 2.5]).expect("spectra");
    add("power", described(Hash::new(), &bins, &values));
    let wedges = Binning { second: Second::Cosine(&WEDGES), orders: 0b11, ..Binning::shells(&EDGES) };
    let window = Compensation::Window(Window::TriangularShapedCloud);
    let (_, sums) = run(&wedges, &[[0, 0], [1, 1], [1, 0]], &[window; 2]);
    let (bins, values) = read(&sums, &wedges, 3);
    add("power.wedges", described(words(Hash::new(), &sums), &bins, &values));
}

fn compensation_cases<T: Real>(add: &mut dyn FnMut(&str, Hash), f: &[T], brick: &Brick) {
    let layout = compensate_scratch(brick).expect("scratch");
    let (mut memory, mut modes, mut hash) = (Memory::new(layout), f.to_vec(), sizes(Hash::new(), layout));
    let (window, aliased) = (Window::TriangularShapedCloud, Window::PiecewiseCubicSpline);
    for (chosen, scale) in [(Compensation::Window(window), 0.3), (Compensation::Aliased(aliased), -2.0)] {
        compensate(&mut modes, chosen, scale, brick, memory.bytes(layout.size), &Serial).expect("modes");
        hash = elements(hash, &modes, brick);
    }
    add("compensate", hash);
}

fn correlation_cases<T: Real>(add: &mut dyn FnMut(&str, Hash), f: &[T], g: &[T], brick: &Brick) {
    let layout = correlation_modes_scratch(brick).expect("scratch");
    let mut memory = Memory::new(layout);
    let mut meshes = [f.to_vec(), f.to_vec()];
    let chosen =
        [Compensation::Window(Window::CloudInCell), Compensation::Aliased(Window::PiecewiseCubicSpline)];
    let mut hash = sizes(Hash::new(), layout);
    for (mesh, other) in meshes.iter_mut().zip([None, Some(g)]) {
        let scratch = memory.bytes(layout.size);
        // Without another field, both are the first.
        let chosen = if other.is_some() { chosen } else { [chosen[0]; 2] };
        correlation_modes(mesh, other, chosen, 0.5, brick, scratch, &Serial).expect("modes");
        hash = elements(hash, mesh, brick);
    }
    add("correlation_modes", hash);
    let binning = Binning { second: Second::Parallel(&PARALLEL), ..Binning::shells(&EDGES) };
    let cells = with_transform::<T, _>(N, 0, |fft| {
        for mesh in &mut meshes {
            fft.inverse(mesh).expect("cells");
        }
        *fft.configuration()
    });
    let layout = correlation_sums_scratch(&cells, &binning, 2).expect("scratch");
    let mut sums = vec![0_i64; binning.words(2).expect("words")];
    let mut memory = Memory::new(layout);
    let [first, second] = &meshes;
    let scratch = memory.bytes(layout.size);
    correlation_sums(&mut sums, &[first, second], &cells, &binning, scratch, &Serial).expect("sums");
    let (bins, mut values) = read(&sums, &binning, 2);
    normalise(&mut values, &bins, binning.orders, 1.0).expect("xi");
    add("correlation", described(words(sizes(Hash::new(), layout), &sums), &bins, &values));
}

fn bispectrum_cases<T: Real>(add: &mut dyn FnMut(&str, Hash), modes: &[T]) {
    let (edges, triangles, (_, counts)) = (&EDGES[..=SHELLS], closed(None), counts());
    let mut sums = vec![0_i64; ExactSum::WORDS * triangles.len()];
    let mut values = vec![0.0; triangles.len()];
    let mut sizes_hash = Hash::new();
    with_transform::<T, _>(N, 0, |fft| {
        let (cells, fourier) = (*fft.configuration(), *fft.fourier());
        let mut hash = Hash::new();
        let mut fields = vec![vec![T::ZERO; fft.length()]; SHELLS];
        for (shell, field) in fields.iter_mut().enumerate() {
            shell_modes(field, modes, &fourier, edges[shell], edges[shell + 1], &Serial).expect("modes");
            hash = elements(hash, field, &fourier);
            fft.inverse(field).expect("cells");
        }
        add("shell_modes", hash);
        let layout = bispectrum_sums_scratch::<T>(&cells, SHELLS, triangles.len()).expect("scratch");
        sizes_hash = sizes(sizes_hash, layout);
        let mut memory = Memory::new(layout);
        let fields: Vec<&[T]> = fields.iter().map(Vec::as_slice).collect();
        let words = ExactSum::in_words(&mut sums);
        bispectrum_sums(words, &triangles, &fields, &cells, memory.bytes(layout.size), &Serial)
            .expect("sums");
        bispectrum_values(&mut values, ExactSum::of_words(&sums)).expect("values");
        let layout = bispectrum_scratch(fft, SHELLS, triangles.len()).expect("scratch");
        sizes_hash = sizes(sizes_hash, layout);
        let mut memory = Memory::new(layout);
        for meshes in [3, SHELLS] {
            let reals = bispectrum_meshes(fft, meshes).expect("a length");
            let mut fields = vec![T::ZERO; reals];
            let mut again = vec![0_i64; sums.len()];
            let words = ExactSum::in_words(&mut again);
            let scratch = memory.bytes(layout.size);
            let transforms = bispectrum(words, &triangles, edges, modes, fft, &mut fields, scratch, &Serial);
            sizes_hash = sizes_hash.integers(&[reals as u64, transforms.expect("sums") as u64]);
            assert_eq!(again, sums, "with {meshes} meshes");
        }
    });
    add("bispectrum_sizes", sizes_hash);
    add("bispectrum_sums", words(Hash::new(), &sums));
    bispectrum::normalise(&mut values, &counts, N, BOX, 0.75).expect("B");
    let power = [100.0, 200.0, 300.0, 400.0, 500.0];
    let [mut noises, mut reduced] = [(); 2].map(|()| vec![0.0; values.len()]);
    bispectrum::shot_noise(&mut noises, &triangles, &power, 3.5).expect("noise");
    bispectrum::reduced(&mut reduced, &values, &triangles, &power).expect("Q");
    add("bispectrum", Hash::new().doubles(&values).doubles(&noises).doubles(&reduced));
}
