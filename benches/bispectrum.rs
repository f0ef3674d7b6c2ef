//! The bispectrum stage by stage: triangle counts, shell transforms, triple products.
//!
//! Default: n = 128, 20 shells of 3 k_f; FIXPAIR_BENCH_LARGE=1: n = 360, 40 shells, 6350 triangles (7.8 GB). Each stage's median over
//! a few runs, in CPU seconds. Useful flops are 2 for each triangle and cell. The peak is that of separate multiplications and additions in registers of 256 bits,
//! measured here: what code whose bits must be the same everywhere can reach. FIXPAIR_BENCH_PYTHON=<python with pySpectrum>
//! runs the peer on the same mesh and shells.

use fixpair::estimate::bispectrum::{
    Triangle, bispectrum, bispectrum_meshes, bispectrum_scratch, bispectrum_sums, bispectrum_sums_scratch,
    closed_triangle_count, closed_triangles, shell_modes, triangle_counts, triangle_counts_scratch,
};
use fixpair::estimate::exact::ExactSum;
use fixpair::exec::Serial;
use fixpair::fft::{Fft3, Tables, Transform};
use fixpair::mesh::{Brick, Space};
use fixpair::noise::{Realisation, white_modes};

#[path = "../examples/common/memory.rs"]
mod memory;
#[path = "common/seconds.rs"]
mod seconds;

use memory::Memory;
use seconds::seconds;

/// Width of a shell in k_f.
const WIDTH: f64 = 3.0;

fn median(mut times: Vec<f64>) -> f64 {
    times.sort_by(f64::total_cmp);
    times[times.len() / 2]
}

/// GFLOP/s of independent multiplications and additions on registers.
#[cfg(target_arch = "x86_64")]
fn peak() -> f64 {
    use std::arch::x86_64::{_mm256_add_ps, _mm256_mul_ps, _mm256_set1_ps};
    const LOOPS: usize = 20_000_000;
    const CHAINS: usize = 6;
    #[target_feature(enable = "avx2")]
    fn work(start: f32) -> f32 {
        let mut products = [_mm256_set1_ps(start); CHAINS];
        let mut sums = products;
        let (factor, term) = (_mm256_set1_ps(0.999_999_9), _mm256_set1_ps(1e-9));
        for _ in 0..LOOPS {
            for c in 0..CHAINS {
                products[c] = _mm256_mul_ps(products[c], factor);
                sums[c] = _mm256_add_ps(sums[c], term);
            }
            std::hint::black_box(());
        }
        let total = products.into_iter().chain(sums).reduce(|a, b| _mm256_add_ps(a, b));
        total.map_or(0.0, |total| {
            let mut lanes = [0.0_f32; 8];
            // SAFETY: eight floats are a register.
            unsafe { std::arch::x86_64::_mm256_storeu_ps(lanes.as_mut_ptr(), total) };
            lanes.iter().sum()
        })
    }
    if !std::is_x86_feature_detected!("avx2") {
        return f64::NAN;
    }
    let flops = (LOOPS * CHAINS * 2 * 8) as f64;
    median(
        (0..5)
            .map(|_| {
                let time = seconds(|| {
                    // SAFETY: the processor has AVX2.
                    std::hint::black_box(unsafe { work(std::hint::black_box(1.0)) });
                });
                flops / time / 1e9
            })
            .collect(),
    )
}

#[cfg(not(target_arch = "x86_64"))]
fn peak() -> f64 {
    f64::NAN
}

fn main() {
    let large = std::env::var_os("FIXPAIR_BENCH_LARGE").is_some();
    let (n, shells, repeats) = if large { (360, 40, 3) } else { (128, 20, 5) };
    let edges: Vec<u64> = (0..=shells).map(|s| ((s as f64 + 0.5) * WIDTH).powi(2).ceil() as u64).collect();
    let centres: Vec<f64> = (1..=shells).map(|s| s as f64).collect();
    let mut triangles: Vec<Triangle> =
        vec![[0; 3]; closed_triangle_count(&edges, Some(&centres)).expect("shells are sound")];
    closed_triangles(&mut triangles, &edges, Some(&centres)).expect("as long as it was counted");
    println!("n = {n}, {shells} shells of {WIDTH} k_f, {} triangles, one thread", triangles.len());
    let peak = peak();
    println!("peak of mul and add in f32: {peak:.0} GFLOP/s");

    let mut scratch = Memory::new(triangle_counts_scratch(&edges, n, &triangles).expect("sound"));
    let mut counts = vec![0; triangles.len()];
    let counting = median(
        (0..repeats)
            .map(|_| {
                seconds(|| {
                    triangle_counts(&mut counts, &triangles, &edges, n, scratch.bytes(), &Serial)
                        .expect("counts");
                })
            })
            .collect(),
    );
    println!("counts            {counting:8.3} s  {:6.1} MB", scratch.bytes().len() as f64 / 1e6);
    drop(scratch);

    let mut tables = Memory::new(Tables::<f32>::layout(n).expect("a good side"));
    let tables = Tables::<f32>::new(n, tables.bytes()).expect("a good side");
    let mut workspace = Memory::new(Transform::<f32>::workspace(n).expect("a good side"));
    let cells = Brick::whole(n, Space::Configuration).expect("an even side");
    let mut fft = Transform::new(&tables, cells, workspace.bytes(), &Serial).expect("a whole mesh");
    let fourier = *fft.fourier();
    let mut modes = vec![0.0_f32; fourier.reals()];
    white_modes(&mut modes, &fourier, &Realisation::new(1), &Serial).expect("modes");
    let length = bispectrum_meshes(&fft, 1).expect("fits");
    let mut fields = vec![0.0_f32; bispectrum_meshes(&fft, shells).expect("fits")];
    // Pages are made by the first write.
    fields.fill(1.0);

    let (mut copies, mut transforms) = (0.0, 0.0);
    for (field, edge) in fields.chunks_exact_mut(length).zip(edges.windows(2)) {
        let field = &mut field[..fft.length()];
        copies +=
            seconds(|| shell_modes(field, &modes, &fourier, edge[0], edge[1], &Serial).expect("a shell"));
        transforms += seconds(|| fft.inverse(field).expect("a transform"));
    }
    println!("shell modes       {copies:8.3} s");
    println!("transforms        {transforms:8.3} s  {:.3} s each", transforms / shells as f64);

    let meshes: Vec<&[f32]> = fields.chunks_exact(length).collect();
    let mut sums = vec![ExactSum::ZERO; triangles.len()];
    let mut scratch =
        Memory::new(bispectrum_sums_scratch::<f32>(&cells, shells, triangles.len()).expect("fits"));
    let products = median(
        (0..repeats)
            .map(|_| {
                sums.fill(ExactSum::ZERO);
                seconds(|| {
                    bispectrum_sums(&mut sums, &triangles, &meshes, &cells, scratch.bytes(), &Serial)
                        .expect("sums");
                })
            })
            .collect(),
    );
    let flops = 2.0 * triangles.len() as f64 * (n * n * n) as f64;
    let rate = flops / products / 1e9;
    println!(
        "triple products   {products:8.3} s  {rate:.1} GFLOP/s useful, {:.0}% of peak, {:.1} MB of scratch",
        100.0 * rate / peak,
        scratch.bytes().len() as f64 / 1e6
    );

    let mut scratch = Memory::new(bispectrum_scratch(&fft, shells, triangles.len()).expect("fits"));
    for meshes in [shells, shells / 2, shells / 4] {
        if large && meshes < shells {
            continue;
        }
        let fields = &mut fields[..bispectrum_meshes(&fft, meshes).expect("fits")];
        sums.fill(ExactSum::ZERO);
        let mut made = 0;
        let whole = seconds(|| {
            let (sums, scratch) = (&mut sums, scratch.bytes());
            made = bispectrum(sums, &triangles, &edges, &modes, &mut fft, fields, scratch, &Serial)
                .expect("sums");
        });
        println!("all, {meshes:3} meshes   {whole:8.3} s  {made} transforms");
        if meshes == shells {
            let bytes = (fields.len() + modes.len()) * 4 + scratch.bytes().len();
            println!("with counts       {:8.3} s  {:.2} GB", whole + counting, bytes as f64 / 1e9);
        }
    }
    drop(fields);

    if let Some(python) = std::env::var_os("FIXPAIR_BENCH_PYTHON") {
        let script = concat!(env!("CARGO_MANIFEST_DIR"), "/benches/peers/pyspectrum_bispectrum.py");
        let status = std::process::Command::new(python)
            .arg(script)
            .args([n.to_string(), shells.to_string(), WIDTH.to_string()])
            .status();
        println!("pySpectrum: {status:?}");
    }
}
