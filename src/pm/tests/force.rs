//! Forces mode by mode: against their definition, waves, stencils, bricks, and what is refused.

use core::f64::consts::PI;

use super::*;
use crate::fft::Fft3;
use crate::pm::force::{force_with, forces_with, potential_with};
use crate::reference::built::serial;
use crate::reference::force::fields;

const DIFFERENCES: [Difference; 3] = [Difference::Exact, Difference::TwoPoint, Difference::FourPoint];

/// All pairs of derivatives, and what else a law may hold.
fn laws() -> Vec<ForceLaw> {
    let pairs =
        DIFFERENCES.into_iter().flat_map(|laplacian| DIFFERENCES.map(|gradient| (laplacian, gradient)));
    let mut laws: Vec<ForceLaw> =
        pairs.map(|(laplacian, gradient)| ForceLaw { laplacian, gradient, ..ForceLaw::default() }).collect();
    laws.extend(Window::ALL.map(|window| ForceLaw { window: Some((window, 2)), ..laws[7] }));
    laws.push(ForceLaw { window: Some((Window::CloudInCell, 1)), split_scale: 0.17, ..laws[2] });
    laws
}

fn scratch(n: usize) -> Memory {
    Memory::new(force_scratch(n).unwrap())
}

/// The three forces, and the potential, on the cells of a box, z innermost, of masses there.
fn on_cells(n: usize, box_size: f64, masses: &[f64], law: &ForceLaw) -> [Vec<f64>; 4] {
    let mut fft = serial::<f64>(n);
    let (length, modes) = (fft.length(), *fft.fourier());
    let mut meshes: [Vec<f64>; 4] = core::array::from_fn(|_| vec![0.0; length]);
    let address = |c: usize| c / n * (n + 2) + c % n;
    for field in [0, 3] {
        (0..n * n * n).for_each(|c| meshes[field][address(c)] = masses[c]);
        fft.forward(&mut meshes[field]).unwrap();
    }
    let (mass, mut memory) = (sum(masses), scratch(n));
    let [x, y, z, phi] = &mut meshes;
    forces([x, y, z], &modes, law, box_size, mass, memory.get(), &Serial).unwrap();
    potential(phi, &modes, law, box_size, mass, memory.get(), &Serial).unwrap();
    meshes.map(|mut mesh| {
        fft.inverse(&mut mesh).unwrap();
        (0..n * n * n).map(|c| mesh[address(c)]).collect()
    })
}

fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |largest, value| value.abs().max(largest))
}

fn largest_difference(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).fold(0.0, |largest, (a, b)| (a - b).abs().max(largest))
}

/// A value of each cell, z innermost.
fn cells_of(n: usize, value: impl Fn([usize; 3]) -> f64) -> Vec<f64> {
    (0..n * n * n).map(|c| value([c / (n * n), c / n % n, c % n])).collect()
}

#[test]
fn forces_and_potential_are_what_their_formulas_say() {
    let (n, box_size) = (10, 3.7);
    let masses = random(n * n * n, 5);
    for law in laws() {
        let expect = fields(n, box_size, &masses, &law);
        let found = on_cells(n, box_size, &masses, &law);
        for (found, expect) in found.iter().zip(&expect) {
            // Two transforms of 1000 cells, each off by a few epsilon of the r.m.s.
            assert!(largest_difference(found, expect) < 1e-13 * largest(expect), "{law:?}");
        }
    }
}

#[test]
fn a_plane_wave_is_pulled_to_its_crests() {
    // delta = A cos k.x has F = -A k/k^2 sin k.x, the displacement of Zel'dovich.
    let (n, box_size, amplitude) = (16, 100.0, 0.3);
    let m = [2.0, -3.0, 1.0];
    let k = m.map(|m| 2.0 * PI * m / box_size);
    let square: f64 = k.iter().map(|k| k * k).sum();
    let phase = |c: [usize; 3]| (0..3).map(|a| k[a] * c[a] as f64 * box_size / n as f64).sum::<f64>();
    let masses = cells_of(n, |c| 2.5 * (1.0 + amplitude * phase(c).cos()));
    let found = on_cells(n, box_size, &masses, &ForceLaw::default());
    for a in 0..3 {
        let expect = cells_of(n, |c| -amplitude * k[a] / square * phase(c).sin());
        assert!(largest_difference(&found[a], &expect) < 1e-13 * largest(&expect));
    }
    let expect = cells_of(n, |c| -amplitude / square * phase(c).cos());
    assert!(largest_difference(&found[3], &expect) < 1e-13 * largest(&expect));
}

#[test]
fn two_point_differences_converge_in_second_and_four_point_in_fourth_order() {
    let error = |n: usize, laplacian, gradient| {
        let phase = |c: [usize; 3]| 2.0 * PI * (c[0] as f64 + 2.0 * c[1] as f64) / n as f64;
        let masses = cells_of(n, |c| 1.0 + phase(c).cos());
        let law = |laplacian, gradient| ForceLaw { laplacian, gradient, ..ForceLaw::default() };
        let found = on_cells(n, 1.0, &masses, &law(laplacian, gradient));
        let exact = on_cells(n, 1.0, &masses, &ForceLaw::default());
        largest_difference(&found[1], &exact[1]) / largest(&exact[1])
    };
    for (difference, order) in [(Difference::TwoPoint, 2.0), (Difference::FourPoint, 4.0)] {
        for pair in
            [(difference, Difference::Exact), (Difference::Exact, difference), (difference, difference)]
        {
            let [coarse, fine] = [32, 64].map(|n| error(n, pair.0, pair.1));
            // The next order is (k H)^2 ~ 0.15 of the error on the coarse mesh.
            assert!(((coarse / fine).log2() - order).abs() < 0.1, "{pair:?}: {coarse} {fine}");
        }
    }
}

#[test]
fn differences_of_the_potential_in_real_space_are_the_forces_and_the_density() {
    let n = 12;
    let h = 5.0 / n as f64;
    let masses = random(n * n * n, 9);
    let shifted = |field: &[f64], axis: usize, by: usize| {
        cells_of(n, |mut c| {
            c[axis] = (c[axis] + by) % n;
            field[(c[0] * n + c[1]) * n + c[2]]
        })
    };
    for difference in [Difference::TwoPoint, Difference::FourPoint] {
        let law = ForceLaw { laplacian: difference, gradient: difference, ..ForceLaw::default() };
        let [x, y, z, phi] = on_cells(n, n as f64 * h, &masses, &law);
        // delta without its Nyquist modes: the force law's density is -div F for exact derivatives.
        let mut delta = vec![0.0; n * n * n];
        for (axis, force) in [x, y, z].iter().enumerate() {
            let [near, far] = [1, 2].map(|by| [shifted(&phi, axis, by), shifted(&phi, axis, n - by)]);
            let (first, second): (Vec<f64>, Vec<f64>) = (0..n * n * n)
                .map(|c| {
                    let (odd, even) = (near[0][c] - near[1][c], near[0][c] + near[1][c]);
                    let (far_odd, far_even) = (far[0][c] - far[1][c], far[0][c] + far[1][c]);
                    match difference {
                        Difference::TwoPoint => (odd / (2.0 * h), (even - 2.0 * phi[c]) / (h * h)),
                        _ => (
                            (8.0 * odd - far_odd) / (12.0 * h),
                            (16.0 * even - far_even - 30.0 * phi[c]) / (12.0 * h * h),
                        ),
                    }
                })
                .unzip();
            let negative: Vec<f64> = first.iter().map(|x| -x).collect();
            assert!(largest_difference(force, &negative) < 1e-13 * largest(force), "{difference:?}");
            delta.iter_mut().zip(second).for_each(|(sum, part)| *sum += part);
        }
        // Exact derivatives of the exact potential give the same density.
        let exact = on_cells(n, n as f64 * h, &masses, &ForceLaw::default());
        let divergence = fields_divergence(n, h, &exact);
        assert!(largest_difference(&delta, &divergence) < 1e-12 * largest(&delta), "{difference:?}");
    }
}

/// -div F of the exact force, by spectral derivatives.
fn fields_divergence(n: usize, h: f64, force: &[Vec<f64>; 4]) -> Vec<f64> {
    use crate::reference::dft;
    let mut total = vec![0.0; n * n * n];
    for axis in 0..3 {
        let mut modes = dft::forward(n, &force[axis]);
        for (at, mode) in modes.iter_mut().enumerate() {
            let m = Brick::mode(n, [at / (n * n), at / n % n, at % n][axis]) as f64;
            let k = 2.0 * PI * m / (n as f64 * h);
            *mode = [k * mode[1], -k * mode[0]].map(|part| part / (n * n * n) as f64);
        }
        let part = dft::inverse(n, &modes);
        total.iter_mut().zip(part).for_each(|(sum, [re, _])| *sum += re);
    }
    total
}

#[test]
fn the_mean_and_nyquist_modes_exert_no_force() {
    let n = 8;
    let brick = Brick::whole(n, Space::Fourier).unwrap();
    for law in laws() {
        let mut meshes = [(); 3].map(|()| vec![1.0; brick.reals()]);
        let mut phi = meshes[0].clone();
        let mut memory = scratch(n);
        let [x, y, z] = &mut meshes;
        forces([x, y, z], &brick, &law, 2.0, 3.0, memory.get(), &Serial).unwrap();
        potential(&mut phi, &brick, &law, 2.0, 3.0, memory.get(), &Serial).unwrap();
        for (at, mode) in phi.chunks_exact(2).enumerate() {
            let index = [at / (n * (n / 2 + 1)), at / (n / 2 + 1) % n, at % (n / 2 + 1)];
            let none = index == [0; 3] || index.contains(&(n / 2));
            assert_eq!(mode == [0.0; 2], none, "{index:?}");
            let force = meshes.each_ref().map(|mesh| [mesh[2 * at], mesh[2 * at + 1]]);
            assert!(force.as_flattened().iter().all(|part| part.is_finite()));
            assert_eq!(force == [[0.0; 2]; 3], none, "{law:?} {index:?}");
        }
    }
}

/// The bits of each element of a brick, by its place in the whole mesh.
fn elements<T: Real>(brick: &Brick, data: &[T]) -> Vec<(usize, [u64; 2])> {
    let (start, count, stride) = (brick.start(), brick.count(), brick.stride());
    let all =
        (0..brick.elements()).map(|i| [i / (count[1] * count[2]), i / count[2] % count[1], i % count[2]]);
    all.map(|local| {
        let at = 2 * (0..3).map(|a| local[a] * stride[a]).sum::<usize>();
        let place = (0..3).fold(0, |place, a| place * brick.n() + start[a] + local[a]);
        (place, [data[at], data[at + 1]].map(|part| part.to_f64().to_bits()))
    })
    .collect()
}

/// A brick filled with modes that depend on their place alone, and NaN between them.
fn filled<T: Real>(brick: &Brick) -> Vec<T> {
    let mut data = vec![T::from_f64(f64::NAN); brick.reals()];
    let (start, count, stride) = (brick.start(), brick.count(), brick.stride());
    for i in 0..brick.elements() {
        let local = [i / (count[1] * count[2]), i / count[2] % count[1], i % count[2]];
        let at = 2 * (0..3).map(|a| local[a] * stride[a]).sum::<usize>();
        let place = (0..3).fold(0, |place, a| place * brick.n() + start[a] + local[a]);
        for part in 0..2 {
            data[at + part] = T::from_f64(libm::sin((2 * place + part) as f64));
        }
    }
    data
}

/// Elements of the three forces, of each as one, and of the potential; by any path.
fn results<T: Real>(
    simd: Simd,
    brick: &Brick,
    law: &ForceLaw,
    exec: &dyn Exec,
) -> Vec<Vec<(usize, [u64; 2])>> {
    let density = filled::<T>(brick);
    let mut memory = scratch(brick.n());
    let mut meshes = [(); 3].map(|()| density.clone());
    let [x, y, z] = &mut meshes;
    forces_with(simd, [x, y, z], brick, law, 7.0, 11.0, memory.get(), exec).unwrap();
    let mut results = Vec::from(meshes.each_ref().map(|mesh| elements(brick, mesh)));
    for axis in 0..3 {
        let mut out = density.clone();
        force_with(simd, &mut out, &density, brick, axis, law, 7.0, 11.0, memory.get(), exec).unwrap();
        assert!(elements(brick, &out) == results[axis], "one force is one of three");
    }
    let mut phi = density;
    potential_with(simd, &mut phi, brick, law, 7.0, 11.0, memory.get(), exec).unwrap();
    results.push(elements(brick, &phi));
    let kept = meshes[0].iter().chain(&phi).filter(|part| !part.is_finite()).count();
    assert_eq!(kept, 2 * (brick.reals() - 2 * brick.elements()), "what lies between elements is left alone");
    results
}

fn the_same_bits<T: Real>(n: usize, law: &ForceLaw) {
    let pools = [2, 5].map(|threads| Threads::new(threads).unwrap());
    let half = n / 2 + 1;
    let whole = Brick::whole(n, Space::Fourier).unwrap();
    let expect = results::<T>(Simd::Portable, &whole, law, &Serial);
    let bricks = [
        whole,
        Brick::slab(n, Space::Fourier, 1, n / 2).unwrap(),
        Brick::transposed_slab(n, 0, n / 2 + 1).unwrap(),
        Brick::transposed_slab(n, n / 2, n / 2).unwrap(),
        Brick::general(n, Space::Fourier, [1, 0, 1], [n - 1, n, half - 2], [1, n, n * n]).unwrap(),
        Brick::general(n, Space::Fourier, [0, 2, 0], [n, 1, half], [half + 3, 0, 1]).unwrap(),
    ];
    for brick in bricks {
        for simd in [Simd::Portable, Simd::detect()] {
            for exec in [&Serial as &dyn Exec, &pools[0], &pools[1]] {
                for (found, expect) in results::<T>(simd, &brick, law, exec).iter().zip(&expect) {
                    let mut all = expect.iter();
                    for element in found {
                        let same = if brick.stride()[2] == 1 && brick.is_whole() {
                            all.next()
                        } else {
                            expect.iter().find(|(place, _)| *place == element.0)
                        };
                        assert_eq!(same, Some(element), "{brick:?}");
                    }
                }
            }
        }
    }
}

#[test]
fn bricks_threads_and_paths_give_the_same_bits() {
    let all = laws();
    the_same_bits::<f64>(12, &all[1]);
    the_same_bits::<f32>(12, &all[13]);
    the_same_bits::<f32>(20, &all[5]);
}

#[test]
fn long_rows_are_the_same_bits_by_any_path() {
    // More than two blocks, and a rest that fills no vector.
    let brick = Brick::slab(138, Space::Fourier, 5, 2).unwrap();
    for law in &laws()[7..10] {
        let portable = results::<f32>(Simd::Portable, &brick, law, &Serial);
        assert!(portable == results::<f32>(Simd::detect(), &brick, law, &Serial));
        let portable = results::<f64>(Simd::Portable, &brick, law, &Serial);
        assert!(portable == results::<f64>(Simd::detect(), &brick, law, &Serial));
    }
}

#[test]
fn single_precision_is_double_precision_rounded_once() {
    let brick = Brick::whole(16, Space::Fourier).unwrap();
    let law = laws()[13];
    let single = filled::<f32>(&brick);
    let mut memory = scratch(16);
    let mut narrow = [(); 3].map(|()| single.clone());
    let mut wide = [(); 3].map(|()| single.iter().map(|&part| f64::from(part)).collect::<Vec<f64>>());
    let [x, y, z] = &mut narrow;
    forces([x, y, z], &brick, &law, 1.0, 2.0, memory.get(), &Serial).unwrap();
    let [x, y, z] = &mut wide;
    forces([x, y, z], &brick, &law, 1.0, 2.0, memory.get(), &Serial).unwrap();
    for (narrow, wide) in narrow.iter().zip(&wide) {
        assert!(narrow.iter().zip(wide).all(|(narrow, &wide)| narrow.to_bits() == (wide as f32).to_bits()));
    }
}

#[test]
fn what_cannot_be_a_force_is_refused_and_nothing_is_written() {
    let n = 8;
    let modes = Brick::whole(n, Space::Fourier).unwrap();
    let cells = Brick::whole(n, Space::Configuration).unwrap();
    let before = filled::<f64>(&modes);
    let law = ForceLaw::default();
    let check = |brick: &Brick, law: &ForceLaw, box_size: f64, mass: f64, error: Error| {
        let mut memory = scratch(n);
        let mut meshes = [(); 3].map(|()| before.clone());
        let [x, y, z] = &mut meshes;
        let three = forces([x, y, z], brick, law, box_size, mass, memory.get(), &Serial);
        let mut others = [(); 2].map(|()| before.clone());
        let [one, phi] = &mut others;
        let one = force(one, &before, brick, 0, law, box_size, mass, memory.get(), &Serial);
        let phi = potential(phi, brick, law, box_size, mass, memory.get(), &Serial);
        assert_eq!([three, one, phi], [Err(error); 3], "{law:?} {box_size} {mass}");
        assert!(meshes.iter().chain(&others).all(|mesh| bits(mesh) == bits(&before)));
    };
    check(&cells, &law, 1.0, 1.0, Error::Brick);
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        check(&modes, &law, bad, 1.0, Error::NotFinite);
        check(&modes, &law, 1.0, bad, Error::NotFinite);
        check(&modes, &ForceLaw { split_scale: bad, ..law }, 1.0, 1.0, Error::NotFinite);
    }
    for bad in [0.0, -0.0, -1.0] {
        check(&modes, &law, bad, 1.0, Error::Range);
        check(&modes, &law, 1.0, bad, Error::Range);
    }
    check(&modes, &law, 1e-308, 1.0, Error::Range);
    check(&modes, &law, 1e308, 1.0, Error::Range);
    check(&modes, &law, 1e-200, 1e200, Error::Range);
    check(&modes, &law, 1e200, 1e-200, Error::Range);
    check(&modes, &ForceLaw { split_scale: -1e-9, ..law }, 1.0, 1.0, Error::Range);
    for power in [0, 5, u32::MAX] {
        let window = Some((Window::CloudInCell, power));
        check(&modes, &ForceLaw { window, ..law }, 1.0, 1.0, Error::Range);
    }
    let larger = Brick::whole(n + 2, Space::Fourier).unwrap();
    let mut memory = scratch(n + 2);
    let (mut y, mut z) = (vec![0.0; larger.reals()], vec![0.0; larger.reals()]);
    let mut x = before.clone();
    let short = forces([&mut x, &mut y, &mut z], &larger, &law, 1.0, 1.0, memory.get(), &Serial);
    assert_eq!(short, Err(Error::Length));
    assert!(bits(&x) == bits(&before) && largest(&y) == 0.0);
    let axis = force(&mut x, &before, &modes, 3, &law, 1.0, 1.0, memory.get(), &Serial);
    assert_eq!(axis, Err(Error::Range));
    let small = force_scratch(n).unwrap().size - 1;
    let short = potential(&mut x, &modes, &law, 1.0, 1.0, &mut memory.get()[..small], &Serial);
    assert_eq!(short, Err(Error::Scratch));
    let askew = potential(&mut x, &modes, &law, 1.0, 1.0, &mut memory.get()[8..], &Serial);
    assert_eq!(askew, Err(Error::Alignment));
    assert_eq!(bits(&x), bits(&before));
    assert_eq!(force_scratch(usize::MAX), Err(Error::Overflow));
}

#[test]
fn extreme_split_scales_leave_no_force_and_no_nan() {
    let brick = Brick::whole(8, Space::Fourier).unwrap();
    for (split_scale, box_size) in [(1e300, 1e-5), (f64::MAX, 1.0), (1e-300, 1e5)] {
        let mut modes = vec![1.0; brick.reals()];
        let law = ForceLaw { split_scale, ..ForceLaw::default() };
        potential(&mut modes, &brick, &law, box_size, 1.0, scratch(8).get(), &Serial).unwrap();
        assert!(modes.iter().all(|part| part.is_finite()));
        assert_eq!(largest(&modes) == 0.0, split_scale > 1.0);
    }
}
