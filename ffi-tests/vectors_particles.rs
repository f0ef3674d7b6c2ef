//! The cases of particles and meshes: deposit, read-out, ghosts, interlacing.

use fixpair::exec::Serial;
use fixpair::fft::Fft3;
use fixpair::mesh::{Brick, Space};
use fixpair::pm::{
    Assignment, Column, ColumnMut, Positions, Region, Window, add_cells, copy_cells, deposit,
    deposit_scratch, interlace, read_out, read_out_scratch,
};
use fixpair::real::Real;

use crate::vectors::{BOX, Cases, Hash, N, PADDING, noise};
use crate::vectors_real::{Memory, elements, triples, with_transform};

const PARTICLES: usize = 500;

const WINDOWS: [Window; 4] = [
    Window::NearestGridPoint,
    Window::CloudInCell,
    Window::TriangularShapedCloud,
    Window::PiecewiseCubicSpline,
];

/// First plane and planes of two slabs.
const SLABS: [[usize; 2]; 2] = [[0, 5], [5, 7]];

/// What a slab needs beside it, for each window and shift.
pub(crate) fn ghost_cases(cases: &mut Cases) {
    let slab = Brick::slab(N, Space::Configuration, 5, 7).expect("a slab");
    let mut numbers = Vec::new();
    for window in WINDOWS {
        for shift in [0.0, 0.5] {
            let region = Region::with_ghosts(&slab, window, shift).expect("a region");
            numbers.push(region.n() as u64);
            for triple in [region.start(), region.count(), region.stride()] {
                numbers.extend(triple.map(|number| number as u64));
            }
        }
    }
    cases.add("brick_with_ghosts", Hash::new().integers(&numbers));
}

pub(crate) fn particle_cases<T: Real>(add: &mut dyn FnMut(&str, Hash)) {
    // All over the box and the one before it.
    let places: Vec<T> = (0..3 * PARTICLES).map(|i| T::from_f64(BOX * noise(i))).collect();
    let weights: Vec<T> = (0..PARTICLES).map(|i| T::from_f64(1.25 + noise(5 * i))).collect();
    let cells = Brick::whole_padded(N, Space::Configuration, PADDING).expect("a brick");
    let region = Region::from_brick(&cells).expect("a region");
    let mut hash = Hash::new();
    for window in WINDOWS {
        for shift in [0.0, 0.5] {
            let mut mesh = vec![T::ZERO; region.reals()];
            let weights = (window as usize > 2).then_some(&weights[..]);
            hash = put(hash, &mut mesh, &region, &places, weights, window, shift);
            hash = elements(hash, &mesh, &cells);
        }
    }
    add("deposit", hash);
    let mesh: Vec<T> = (0..region.reals()).map(|i| T::from_f64(noise(i))).collect();
    let mut hash = Hash::new();
    for window in WINDOWS {
        let shift = 0.25 * (window as usize - 1) as f64;
        hash = triples(hash, &get(&mesh, &region, &places, window, shift));
    }
    add("read_out", hash);
    slabs::<T>(add);
    let mut meshes = [(); 2].map(|()| vec![T::ZERO; N * N * (N + 2)]);
    let hash = with_transform::<T, _>(N, 0, |fft| {
        let region = Region::from_brick(fft.configuration()).expect("a region");
        for (mesh, shift) in meshes.iter_mut().zip([0.0, 0.5]) {
            put(Hash::new(), mesh, &region, &places, None, Window::TriangularShapedCloud, shift);
            fft.forward(mesh).expect("modes");
        }
        let [mut modes, shifted] = meshes;
        interlace(&mut modes, &shifted, fft.fourier(), &Serial).expect("modes");
        elements(Hash::new(), &modes, fft.fourier())
    });
    add("interlace", hash);
}

/// Two ranks: each deposits its own particles, ghosts are folded; ghosts are filled, each reads out at its own particles.
fn slabs<T: Real>(add: &mut dyn FnMut(&str, Hash)) {
    let (window, shift) = (Window::PiecewiseCubicSpline, 0.5);
    let mut places: [Vec<T>; 2] = [Vec::new(), Vec::new()];
    for i in 0..PARTICLES {
        let particle = [0, 1, 2].map(|axis| T::from_f64(BOX * (noise(3 * i + axis) + 1.0) / 2.0));
        let low = particle[0].to_f64() * (N as f64) < SLABS[1][0] as f64 * BOX;
        places[usize::from(!low)].extend(particle);
    }
    let bricks =
        SLABS.map(|[first, planes]| Brick::slab(N, Space::Configuration, first, planes).expect("a slab"));
    let own = bricks.map(|brick| Region::from_brick(&brick).expect("a region"));
    let wide = bricks.map(|brick| Region::with_ghosts(&brick, window, shift).expect("a region"));
    let mut meshes = [0, 1].map(|rank| vec![T::ZERO; own[rank].reals()]);
    let mut ghosts = [0, 1].map(|rank| vec![T::ZERO; wide[rank].reals()]);
    for rank in 0..2 {
        put(Hash::new(), &mut ghosts[rank], &wide[rank], &places[rank], None, window, shift);
    }
    let mut hash = Hash::new();
    for rank in 0..2 {
        for other in 0..2 {
            add_cells(&mut meshes[rank], &own[rank], &ghosts[other], &wide[other], &Serial).expect("cells");
        }
        hash = elements(hash, &meshes[rank], &bricks[rank]);
    }
    add("deposit.slabs", hash);
    let mut hash = Hash::new();
    for rank in 0..2 {
        ghosts[rank].fill(T::ZERO);
        for other in 0..2 {
            copy_cells(&mut ghosts[rank], &wide[rank], &meshes[other], &own[other], &Serial).expect("cells");
        }
        hash = triples(hash, &get(&ghosts[rank], &wide[rank], &places[rank], window, shift));
    }
    add("read_out.slabs", hash);
}

/// Deposits triples; goes on with the hash of the scratch's layout.
fn put<T: Real>(
    hash: Hash,
    mesh: &mut [T],
    region: &Region,
    places: &[T],
    weights: Option<&[T]>,
    window: Window,
    shift: f64,
) -> Hash {
    let layout = deposit_scratch::<T>(region, places.len() / 3, window).expect("scratch");
    let mut scratch = Memory::new(layout);
    let positions = Positions::triples(places).expect("triples");
    let weights = weights.map(Column::new);
    let assignment = Assignment { box_size: BOX, window, shift };
    let scratch = scratch.bytes(layout.size);
    deposit(mesh, region, &positions, weights.as_ref(), &assignment, scratch, &Serial).expect("a mesh");
    hash.integers(&[layout.size as u64, layout.align as u64])
}

fn get<T: Real>(mesh: &[T], region: &Region, places: &[T], window: Window, shift: f64) -> Vec<T> {
    let layout = read_out_scratch::<T>(region, places.len() / 3, window).expect("scratch");
    let mut scratch = Memory::new(layout);
    let positions = Positions::triples(places).expect("triples");
    let assignment = Assignment { box_size: BOX, window, shift };
    let mut values = vec![T::ZERO; places.len() / 3];
    let scratch = scratch.bytes(layout.size);
    let mut column = ColumnMut::new(&mut values);
    read_out(&mut column, mesh, region, &positions, &assignment, scratch, &Serial).expect("values");
    values
}
