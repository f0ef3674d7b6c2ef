//! Claims about bits: memory, slabs, threads, strides, instructions.

use super::*;

fn bits_do_not_depend_on_memory<T: Real>() {
    let (n, shells) = (32, 14);
    let edges: Vec<u64> = (0..=shells).map(|s| (s + 1) * (s + 1)).collect();
    let modes = modes::<T>(n, 11);
    let triangles = closed(&edges, Some(&centres(shells as usize)));
    let mut taken = Vec::new();
    let (sums, _) = whole(&triangles, &edges, &modes, n, 14, &Serial).unwrap();
    for meshes in 3..=15 {
        let (other, made) = whole(&triangles, &edges, &modes, n, meshes, &Serial).unwrap();
        assert_eq!(other, sums, "{meshes}");
        taken.push(made);
    }
    assert_eq!(taken[11..], [14, 14], "each shell once");
    // Shells that no triangle names are not transformed.
    let squeezed = [[0, 9, 9], [0, 10, 10], [0, 13, 13]];
    assert_eq!(whole(&squeezed, &edges, &modes, n, 5, &Serial).unwrap().1, 4);
    assert!(whole(&squeezed, &edges, &modes, n, 3, &Serial).unwrap().1 <= 6);
}

#[test]
fn any_number_of_meshes_gives_the_same_bits() {
    bits_do_not_depend_on_memory::<f32>();
    bits_do_not_depend_on_memory::<f64>();
}

fn slabs<T: Real>() {
    let (n, edges) = (24, [1, 5, 12, 30, 61, 100]);
    let mut fft = serial::<T>(n);
    let modes = modes::<T>(n, 5);
    let triangles = closed(&edges, None);
    let (sums, _) = whole(&triangles, &edges, &modes, n, 5, &Serial).unwrap();
    let fields: Vec<Vec<T>> = edges
        .windows(2)
        .map(|edge| {
            let mut field = vec![T::ZERO; fft.length()];
            shell_modes(&mut field, &modes, fft.fourier(), edge[0], edge[1], &Serial).unwrap();
            fft.inverse(&mut field).unwrap();
            // Padding is not read.
            for row in field.chunks_exact_mut(n + 2) {
                row[n..].fill(T::from_f64(f64::NAN));
            }
            field
        })
        .collect();
    let add = |sums: &mut [ExactSum], start: usize, count: usize, exec: &dyn Exec| {
        let slab = Brick::slab(n, Space::Configuration, start, count).unwrap();
        let plane = n * (n + 2);
        let parts: Vec<&[T]> = fields.iter().map(|f| &f[start * plane..(start + count) * plane]).collect();
        let scratch = memory(bispectrum_sums_scratch::<T>(&slab, parts.len(), triangles.len()).unwrap());
        bispectrum_sums(sums, &triangles, &parts, &slab, scratch, exec).unwrap();
    };
    for threads in [1, 2, 5] {
        let pool = Threads::new(threads).unwrap();
        let mut added = vec![ExactSum::ZERO; triangles.len()];
        add(&mut added, 0, n, &pool);
        assert_eq!(added, sums, "{threads} threads");
    }
    let mut added = vec![ExactSum::ZERO; triangles.len()];
    for (start, count) in [(17, 7), (0, 1), (4, 13), (1, 3), (24, 0)] {
        add(&mut added, start, count, &Serial);
    }
    assert_eq!(added, sums, "slabs");
    // The same cells with other strides: z outermost.
    let strides = [n, 1, n * n];
    let turned = Brick::general(n, Space::Configuration, [0; 3], [n; 3], strides).unwrap();
    let moved: Vec<Vec<T>> = fields
        .iter()
        .map(|field| {
            let mut out = vec![T::ZERO; n * n * n];
            for x in 0..n {
                for y in 0..n {
                    for z in 0..n {
                        out[x * n + y + z * n * n] = field[(x * n + y) * (n + 2) + z];
                    }
                }
            }
            out
        })
        .collect();
    let parts: Vec<&[T]> = moved.iter().map(Vec::as_slice).collect();
    let scratch = memory(bispectrum_sums_scratch::<T>(&turned, parts.len(), triangles.len()).unwrap());
    let mut added = vec![ExactSum::ZERO; triangles.len()];
    bispectrum_sums(&mut added, &triangles, &parts, &turned, scratch, &Serial).unwrap();
    assert_eq!(added, sums, "strides");
}

#[test]
fn slabs_threads_and_strides_give_the_same_bits() {
    slabs::<f32>();
    slabs::<f64>();
}

fn paths_agree<T: Real>() {
    let (shells, length) = (9, 64);
    let triangles = closed(&nearest(1.0, shells), Some(&centres(shells)));
    let mut order: Vec<u32> = (0..triangles.len() as u32).collect();
    let (layout, count) = (Layout::EMPTY.and::<Block>(triangles.len()).unwrap(), triangles.len());
    let mut arena = Arena::new(memory(layout), layout).unwrap();
    let mut slots = vec![0; count];
    let plan = plan(arena.take(count).unwrap(), &mut slots, &mut order, &triangles);
    let fields: Vec<T> = (0..shells * length).map(|i| T::from_f64(libm::sin(i as f64 * 1.7) / 3.0)).collect();
    let tile = Tile { outer: &fields, middle: &fields, apart: length, start: 0, length };
    let sums = |simd: Simd| {
        let mut sums = vec![T::ZERO; plan.sums * lanes::<T>()];
        simd.vectorise(
            #[inline(always)]
            || add_tile(&mut sums, 0, plan.blocks, &tile),
        );
        sums
    };
    let portable = sums(Simd::Portable);
    assert_eq!(portable, sums(Simd::detect()));
    for (&t, &slot) in order.iter().zip(plan.slots) {
        let lanes = lanes::<T>();
        for lane in 0..lanes {
            let field = |s: u32, cell: usize| fields[s as usize * length + cell];
            let [i, j, k] = triangles[t as usize];
            let cells = (lane..length).step_by(lanes);
            let sum = cells.fold(T::ZERO, |sum, x| sum + field(i, x) * field(j, x) * field(k, x));
            assert_eq!(portable[slot as usize * lanes + lane], sum, "{i} {j} {k}");
        }
    }
}

#[test]
fn portable_and_avx2_products_are_the_same_bits() {
    paths_agree::<f32>();
    paths_agree::<f64>();
}
