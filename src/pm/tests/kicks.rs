//! Kicks against their definition, wherever particles and meshes lie.

use super::*;
use crate::pm::kick::kick_with;
use crate::reference;

const PLAIN: Kick = Kick { keep: 1.0, force: 1.0, first: 0.0, second: 0.0 };

/// Three meshes of numbers in [-1/2, 1/2).
fn meshes<T: Real>(cells: usize) -> [Vec<T>; 3] {
    [21, 22, 23].map(|seed| random(cells, seed).iter().map(|x| T::from_f64(x - 0.5)).collect())
}

fn triples_of<T: Real>(particles: usize, seed: u64, scale: f64) -> Vec<T> {
    random(3 * particles, seed).iter().map(|x| T::from_f64(scale * (x - 0.5))).collect()
}

/// Kicks triples, with displacements or without.
fn kicked<T: Real>(
    velocity: &[T],
    position: &[T],
    forces: &[Vec<T>; 3],
    region: &Region,
    assignment: &Assignment,
    factors: &Kick,
    psi: Option<(&[T], Option<&[T]>)>,
    (simd, exec): (Simd, &dyn Exec),
) -> Result<Vec<T>> {
    let mut out = velocity.to_vec();
    let position = Positions::triples(position).unwrap();
    let mut memory = Memory::new(kick_scratch::<T>(region, position.len(), assignment.window)?);
    let lpt = psi.map(|(first, second)| Lpt {
        first: Positions::triples(first).unwrap(),
        second: second.map(|second| Positions::triples(second).unwrap()),
    });
    let velocity = &mut Components::triples(&mut out).unwrap();
    let forces = forces.each_ref().map(Vec::as_slice);
    kick_with(
        simd,
        velocity,
        &position,
        forces,
        region,
        assignment,
        factors,
        lpt.as_ref(),
        memory.get(),
        exec,
    )?;
    Ok(out)
}

fn here() -> (Simd, &'static dyn Exec) {
    (Simd::detect(), &Serial)
}

#[test]
fn kick_is_its_definition() {
    let n = 6;
    let region = region_of(n);
    let forces = meshes::<f64>(n * n * n);
    let particles = 300;
    let [x, u, one, two] = [(31, 14.0), (32, 2.0), (33, 4.0), (34, 1.0)]
        .map(|(seed, scale)| triples_of::<f64>(particles, seed, scale));
    let rows = |flat: &[f64]| flat.chunks(3).map(|c| [c[0], c[1], c[2]]).collect::<Vec<_>>();
    let factors = Kick { keep: 0.75, force: -1.5, first: 0.3, second: -2.0 };
    for (window, shift) in choices() {
        let assignment = cells(n, window, shift);
        let psi = Some((&one[..], Some(&two[..])));
        let out = kicked(&u, &x, &forces, &region, &assignment, &factors, psi, here()).unwrap();
        let expect = reference::kick::kick(
            &rows(&u),
            &rows(&x),
            forces.each_ref().map(Vec::as_slice),
            (n, window, shift),
            &factors,
            [&rows(&one), &rows(&two)],
        );
        for (a, b) in out.iter().zip(expect.as_flattened()) {
            // Terms up to 1, a few roundings each; positions in cells up to 8 ulps of n off, on slopes of up to 1 a cell and force factor 1.5.
            assert!((a - b).abs() <= 128.0 * f64::EPSILON, "{window:?} {shift}: {a} {b}");
        }
    }
}

#[test]
fn kick_adds_what_three_read_outs_give() {
    fn check<T: Real>() {
        let n = 24;
        let region = region_of(n);
        let forces = meshes::<T>(n * n * n);
        let x = crowd::<T>(n);
        let u = triples_of::<T>(x.len() / 3, 5, 2.0);
        let factors = Kick { keep: 0.8, force: 3.0, ..PLAIN };
        for (window, shift) in choices() {
            let assignment = cells(n, window, shift);
            let out = kicked(&u, &x, &forces, &region, &assignment, &factors, None, here()).unwrap();
            for axis in 0..3 {
                let force = get(&region, &forces[axis], &x, &assignment, &Serial).unwrap();
                for (i, force) in force.iter().enumerate() {
                    let at = 3 * i + axis;
                    // The same sums in the mesh's type, then f64, rounded once.
                    let expect = T::from_f64(0.8 * u[at].to_f64() + 3.0 * force.to_f64());
                    assert_eq!(out[at].to_f64().to_bits(), expect.to_f64().to_bits(), "{window:?}");
                }
            }
        }
    }
    check::<f32>();
    check::<f64>();
}

#[test]
fn kick_has_the_same_bits_on_any_threads_and_instructions() {
    fn check<T: Real>() {
        let n = 24;
        let region = region_of(n);
        let forces = meshes::<T>(n * n * n);
        let crowd = crowd::<T>(n);
        // More than one chunk, in lattice order and in none.
        let ordered: Vec<T> = (0..2 * sort::CHUNK + 99)
            .flat_map(|i| [i / 4000, i / 200 % 20, i % 24].map(|c| T::from_f64(c as f64 + 0.3)))
            .collect();
        let mixed = triples_of::<T>(2 * sort::CHUNK + 99, 6, 70.0);
        for x in [&crowd, &ordered, &mixed] {
            let [u, one, two] = [7, 8, 9].map(|seed| triples_of::<T>(x.len() / 3, seed, 3.0));
            let factors = Kick { keep: 0.9, force: 1.7, first: 0.2, second: -0.1 };
            for window in [Window::CloudInCell, Window::TriangularShapedCloud] {
                let assignment = cells(n, window, 0.0);
                let run = |how: (Simd, &dyn Exec)| {
                    let psi = Some((&one[..], Some(&two[..])));
                    bits(&kicked(&u, x, &forces, &region, &assignment, &factors, psi, how).unwrap())
                };
                let first = run((Simd::Portable, &Serial));
                for threads in [1, 2, 5] {
                    let pool = Threads::new(threads).unwrap();
                    assert!(run((Simd::detect(), &pool)) == first, "{window:?} {threads}");
                }
            }
        }
    }
    check::<f32>();
    check::<f64>();
}

#[test]
fn kick_does_not_depend_on_the_order_of_particles() {
    let n = 32;
    let region = region_of(n);
    let forces = meshes::<f32>(n * n * n);
    let ordered: Vec<[f32; 3]> = (0..4000_u16)
        .map(|i| [f32::from(i) / 125.0, 1.25 + f32::from(i % 7), f32::from(i % 32) + 0.4])
        .collect();
    // Every particle in another tile than the last.
    let mixed: Vec<[f32; 3]> = (0..4000).map(|i| ordered[i * 1601 % 4000]).collect();
    let u = vec![0.5_f32; 12000];
    for (window, shift) in choices() {
        let assignment = cells(n, window, shift);
        let [straight, sorted] = [&ordered, &mixed].map(|x| {
            kicked(&u, x.as_flattened(), &forces, &region, &assignment, &PLAIN, None, here()).unwrap()
        });
        for i in 0..4000 {
            let from = i * 1601 % 4000;
            assert_eq!(bits(&sorted[3 * i..3 * i + 3]), bits(&straight[3 * from..3 * from + 3]));
        }
    }
}

#[test]
fn slabs_with_filled_ghosts_kick_as_the_whole() {
    let n = 12;
    let whole = region_of(n);
    let forces = meshes::<f32>(n * n * n);
    let x: Vec<f32> = random(6000, 9).iter().map(|x| (x * n as f64) as f32).collect();
    let u = triples_of::<f32>(2000, 10, 1.0);
    for (window, shift) in choices() {
        let assignment = cells(n, window, shift);
        let expect = kicked(&u, &x, &forces, &whole, &assignment, &PLAIN, None, here()).unwrap();
        let mut owners = 0;
        for (start, planes) in [(0, 5), (5, 1), (6, 6)] {
            let brick = Brick::slab(n, Space::Configuration, start, planes).unwrap();
            let region = Region::with_ghosts(&brick, window, shift).unwrap();
            let ghosted = forces.each_ref().map(|force| {
                let mut filled = vec![f32::NAN; region.reals()];
                copy_cells(&mut filled, &region, force, &whole, &Serial).unwrap();
                filled
            });
            let mine: Vec<usize> =
                (0..2000).filter(|&i| (start..start + planes).contains(&(x[3 * i] as usize))).collect();
            owners += mine.len();
            let own =
                |all: &[f32]| mine.iter().flat_map(|&i| all[3 * i..3 * i + 3].to_vec()).collect::<Vec<_>>();
            let out =
                kicked(&own(&u), &own(&x), &ghosted, &region, &assignment, &PLAIN, None, here()).unwrap();
            for (a, b) in out.iter().zip(own(&expect)) {
                // A particle at the very edge may be moved by 8 ulps of n cells, on slopes of up to 1 a cell.
                assert!((a - b).abs() <= 16.0 * 12.0 * f32::EPSILON, "{window:?} {shift}: {a} {b}");
            }
        }
        assert_eq!(owners, 2000);
    }
}

#[test]
fn members_of_one_struct_array_are_kicked_and_moved_where_they_lie() {
    let n = 8;
    let region = region_of(n);
    let forces = meshes::<f64>(512);
    let slices = forces.each_ref().map(Vec::as_slice);
    let assignment = cells(n, Window::CloudInCell, 0.0);
    let x: Vec<f64> = random(300, 41).iter().map(|x| 8.0 * x).collect();
    let [u, one, two] = [42, 43, 44].map(|seed| triples_of::<f64>(100, seed, 1.0));
    let factors = Kick { keep: 1.0, force: 2.0, first: 3.0, second: 4.0 };
    let step = Drift { velocity: 3.0, first: -1.0, second: 0.5 };
    let plain = Lpt { first: Positions::triples(&one).unwrap(), second: Positions::triples(&two).ok() };
    let mut memory = Memory::new(kick_scratch::<f64>(&region, 100, assignment.window).unwrap());
    let (mut straight_x, mut straight_u) = (x.clone(), u.clone());
    {
        let (mut x, mut u) =
            (Components::triples(&mut straight_x).unwrap(), Components::triples(&mut straight_u).unwrap());
        let at = Positions::from(&x);
        kick(&mut u, &at, slices, &region, &assignment, &factors, Some(&plain), memory.get(), &Serial)
            .unwrap();
        drift(&mut x, &Positions::from(&u), 8.0, &step, Some(&plain), &Serial).unwrap();
    }
    // x u psi1 psi2 id of a particle, and x and u in turns.
    let mut structs: Vec<[f64; 13]> = (0..100)
        .map(|i| {
            let of = |all: &[f64], axis| all[3 * i + axis];
            let mut one_particle = [7.0; 13];
            for axis in 0..3 {
                one_particle[2 * axis] = of(&x, axis);
                one_particle[2 * axis + 1] = of(&u, axis);
                one_particle[6 + axis] = of(&one, axis);
                one_particle[9 + axis] = of(&two, axis);
            }
            one_particle
        })
        .collect();
    let first = structs.as_mut_ptr().cast::<f64>();
    let at = |member: [usize; 3]| member.map(|member| first.wrapping_add(member));
    let read = |member: [usize; 3]| at(member).map(<*mut f64>::cast_const);
    // SAFETY: members of structs that nothing else touches meanwhile; each is written through one value.
    let (mut position, mut velocity, lpt) = unsafe {
        (
            Components::strided(at([0, 2, 4]), 13, 100),
            Components::strided(at([1, 3, 5]), 13, 100),
            Lpt {
                first: Positions::strided(read([6, 7, 8]), 13, 100),
                second: Some(Positions::strided(read([9, 10, 11]), 13, 100)),
            },
        )
    };
    let places = Positions::from(&position);
    kick(&mut velocity, &places, slices, &region, &assignment, &factors, Some(&lpt), memory.get(), &Serial)
        .unwrap();
    drift(&mut position.reborrow(), &Positions::from(&velocity), 8.0, &step, Some(&lpt), &Serial).unwrap();
    for (i, particle) in structs.iter().enumerate() {
        for axis in 0..3 {
            assert_eq!(particle[2 * axis].to_bits(), straight_x[3 * i + axis].to_bits());
            assert_eq!(particle[2 * axis + 1].to_bits(), straight_u[3 * i + axis].to_bits());
            assert_eq!(particle[6 + axis].to_bits(), one[3 * i + axis].to_bits(), "only read");
        }
        assert_eq!(particle[12], 7.0, "not touched");
    }
}

#[test]
fn what_cannot_be_kicked_is_refused() {
    let n = 8;
    let region = region_of(n);
    let forces = meshes::<f64>(512);
    let good = cells(n, Window::CloudInCell, 0.0);
    let run = |u: &[f64], x: &[f64], factors: &Kick, psi: Option<(&[f64], Option<&[f64]>)>| {
        kicked(u, x, &forces, &region, &good, factors, psi, here())
    };
    for bad in [f64::NAN, f64::INFINITY] {
        for axis in 0..3 {
            let mut triple = [0.5; 3];
            triple[axis] = bad;
            assert_eq!(run(&[0.0; 3], &triple, &PLAIN, None), Err(Error::NotFinite), "position");
            assert_eq!(run(&triple, &[0.5; 3], &PLAIN, None), Err(Error::NotFinite), "velocity");
            let factors = Kick { first: 1.0, ..PLAIN };
            let psi = Some((&triple[..], None));
            assert_eq!(run(&[0.0; 3], &[0.5; 3], &factors, psi), Err(Error::NotFinite), "displacement");
            let mut mesh = forces.clone();
            mesh[axis].fill(bad);
            let refused = kicked(&[0.0; 3], &[0.5; 3], &mesh, &region, &good, &PLAIN, None, here());
            assert_eq!(refused, Err(Error::NotFinite), "force");
        }
        for factors in [
            Kick { keep: bad, ..PLAIN },
            Kick { force: bad, ..PLAIN },
            Kick { first: bad, ..PLAIN },
            Kick { second: bad, ..PLAIN },
        ] {
            assert_eq!(run(&[0.0; 3], &[0.5; 3], &factors, None), Err(Error::NotFinite));
        }
    }
    let single: [Vec<f32>; 3] = meshes(512);
    let large = Kick { force: 1e60, ..PLAIN };
    let refused = kicked(&[0.0; 3], &[0.5; 3], &single, &region, &good, &large, None, here());
    assert_eq!(refused, Err(Error::NotFinite), "too large for the velocity's type");
    let lonely = [Kick { first: 1.0, ..PLAIN }, Kick { second: 1.0, ..PLAIN }];
    for factors in lonely {
        assert_eq!(run(&[0.0; 3], &[0.5; 3], &factors, None), Err(Error::Null), "a factor of nothing");
    }
    assert_eq!(run(&[0.0; 3], &[0.5; 3], &lonely[1], Some((&[0.0; 3], None))), Err(Error::Null));
    assert_eq!(run(&[0.0; 6], &[0.5; 3], &PLAIN, None), Err(Error::Length));
    assert_eq!(run(&[0.0; 3], &[0.5; 3], &PLAIN, Some((&[0.0; 6], None))), Err(Error::Length));
    let short = forces.each_ref().map(|mesh| mesh[1..].to_vec());
    assert_eq!(
        kicked(&[0.0; 3], &[0.5; 3], &short, &region, &good, &PLAIN, None, here()),
        Err(Error::Length)
    );
    assert_eq!(run(&[], &[], &PLAIN, Some((&[], Some(&[])))), Ok(vec![]), "nobody is welcome");
    let part = Region::new(n, [0; 3], [4, 8, 8], [64, 8, 1]).unwrap();
    let outside = kicked(&[0.0; 3], &[5.5; 3], &forces, &part, &good, &PLAIN, None, here());
    assert_eq!(outside, Err(Error::Outside));
    let mut u = [0.0; 3];
    let x = [0.5; 3];
    let refused = kick(
        &mut Components::triples(&mut u).unwrap(),
        &Positions::triples(&x).unwrap(),
        forces.each_ref().map(Vec::as_slice),
        &region,
        &good,
        &PLAIN,
        None,
        &mut [],
        &Serial,
    );
    assert_eq!(refused, Err(Error::Scratch));
}
