//! Universes on several processes: pencils in general bricks, with unequal parts, an empty one, and modes in another order than cells.

use std::sync::Mutex;
use std::vec;
use std::vec::Vec;

use super::conditions::{InitialConditions, Order, initial_conditions, initial_conditions_scratch};
use super::particles::{Components, particle_ids};
use super::png::Local;
use super::realise::{Field, FieldWork, linear_density};
use super::shape::Shape;
use super::tests_whole::{conditions, particles, realisation, tables};
use crate::estimate::binning::{Bin, Binning, read_sums};
use crate::estimate::compensation::Compensation;
use crate::estimate::power::{power_sums, power_sums_scratch};
use crate::exec::Serial;
use crate::fft::Fft3;
use crate::mesh::{Brick, Space};
use crate::noise::{Amplitude, Phase, Realisation, Scheme, white_modes};
use crate::real::Real;
use crate::reference::built::{Memory, serial};
use crate::reference::parts::{Meeting, Part};

const SIDE: usize = 12;

/// Bricks of cells and of modes for each process of a 2 x 3 grid.
///
/// Cells: x and y are cut, z is whole. Modes: y and l are cut, x is whole and lies together in memory, as PFFT and heFFTe leave them. One process
/// has cells but no modes.
fn pencils() -> Vec<(Brick, Brick)> {
    let (x, y) = ([0, 5, SIDE], [0, 4, 5, SIDE]);
    let (j, l) = ([0, 7, SIDE], [0, 3, 3, SIDE / 2 + 1]);
    let mut all = vec![];
    for a in 0..2 {
        for b in 0..3 {
            let (start, count) = ([x[a], y[b], 0], [x[a + 1] - x[a], y[b + 1] - y[b], SIDE]);
            let stride = [count[1] * SIDE, SIDE, 1];
            let cells = Brick::general(SIDE, Space::Configuration, start, count, stride).unwrap();
            let (start, count) = ([0, j[a], l[b]], [SIDE, j[a + 1] - j[a], l[b + 1] - l[b]]);
            let modes =
                Brick::general(SIDE, Space::Fourier, start, count, [1, SIDE, SIDE * count[1]]).unwrap();
            all.push((cells, modes));
        }
    }
    all
}

/// Runs `body` on every process at once, with its transform.
fn on_pencils<T: Real>(body: impl Fn(&mut Part<'_, T>) + Sync) {
    let all = pencils();
    let meeting = Meeting::<T>::new(SIDE, all.len());
    std::thread::scope(|scope| {
        for (process, (cells, modes)) in all.into_iter().enumerate() {
            let (meeting, body) = (&meeting, &body);
            scope.spawn(move || body(&mut Part::new(meeting, process == 0, cells, modes)));
        }
    });
}

/// Addresses of a brick's modes in its own array and in one of the whole mesh.
fn addresses(modes: &Brick) -> impl Iterator<Item = (usize, usize)> {
    let (start, count, stride) = (modes.start(), modes.count(), modes.stride());
    (0..modes.elements()).map(move |i| {
        let at = [i / (count[1] * count[2]), i / count[2].max(1) % count[1].max(1), i % count[2].max(1)];
        let here = at[0] * stride[0] + at[1] * stride[1] + at[2] * stride[2];
        let there = ((start[0] + at[0]) * SIDE + start[1] + at[1]) * (SIDE / 2 + 1) + start[2] + at[2];
        (2 * here, 2 * there)
    })
}

#[test]
fn random_modes_of_pencils_have_the_bits_of_the_whole() {
    for scheme in [Scheme::Native, Scheme::NGenIc, Scheme::FastPm] {
        modes_have_the_bits_of_the_whole(scheme);
    }
}

fn modes_have_the_bits_of_the_whole(scheme: Scheme) {
    let random = Realisation { scheme, ..realisation(21, Amplitude::Normal, Phase::Inverted) };
    let whole = Brick::whole(SIDE, Space::Fourier).unwrap();
    let mut all = vec![0.0_f64; whole.reals()];
    white_modes(&mut all, &whole, &random, &Serial).unwrap();
    let mut seen = 0;
    for (_, modes) in pencils() {
        let mut part = vec![0.0; modes.reals()];
        white_modes(&mut part, &modes, &random, &Serial).unwrap();
        for (here, there) in addresses(&modes) {
            assert_eq!(part[here..here + 2], all[there..there + 2]);
            seen += 1;
        }
    }
    assert_eq!(seen, whole.elements(), "pencils are the mesh");
}

/// Positions and velocities by id, from all processes.
fn particles_of_pencils<T: Real>(conditions: &InitialConditions<'_>) -> (Vec<T>, Vec<T>) {
    let all = Mutex::new((vec![T::ZERO; 3 * SIDE.pow(3)], vec![T::ZERO; 3 * SIDE.pow(3)]));
    on_pencils::<T>(|fft| {
        let cells = *fft.configuration();
        let count = cells.elements();
        let (mut x, mut v, mut ids) = (vec![T::ZERO; 3 * count], vec![T::ZERO; 3 * count], vec![0; count]);
        let mut scratch =
            Memory::new(initial_conditions_scratch(conditions.parts(), fft as &dyn Fft3<T>, None).unwrap());
        let (mut position, mut velocity) =
            (Components::triples(&mut x).unwrap(), Components::triples(&mut v).unwrap());
        initial_conditions(&mut position, &mut velocity, conditions, fft, None, scratch.get(), &Serial)
            .unwrap();
        particle_ids(&mut ids, &cells, 0, &Serial).unwrap();
        let mut all = all.lock().unwrap();
        for (i, &id) in ids.iter().enumerate() {
            let id = 3 * id as usize;
            all.0[id..id + 3].copy_from_slice(&x[3 * i..3 * i + 3]);
            all.1[id..id + 3].copy_from_slice(&v[3 * i..3 * i + 3]);
        }
    });
    all.into_inner().unwrap()
}

/// From seed to 2LPT particles with f_NL: the transform of the pencils is that of the whole mesh behind copies, so that nothing else may differ.
#[test]
fn particles_of_pencils_have_the_bits_of_the_whole() {
    fn check<T: Real>(order: Order, shape: Shape) {
        let mut conditions = conditions(realisation(11, Amplitude::Fixed, Phase::Original), 100.0);
        (conditions.order, conditions.shape) = (order, shape.rows());
        let whole = particles::<T>(SIDE, &conditions, &Serial, false);
        let parts = particles_of_pencils::<T>(&conditions);
        assert!(parts.0 == whole.0, "positions");
        assert!(parts.1 == whole.1, "velocities");
    }
    check::<f64>(Order::Second, Shape::Local);
    check::<f32>(Order::Second, Shape::Local);
    check::<f64>(Order::First, Shape::Equilateral);
    check::<f64>(Order::Third, Shape::Local);
}

/// g_NL takes <Phi_G^2> from all processes.
#[test]
fn g_nl_of_pencils_is_that_of_the_whole() {
    let local = Local { f_nl: 50.0, g_nl: 1e6 };
    let mut conditions = conditions(realisation(11, Amplitude::Fixed, Phase::Original), 0.0);
    conditions.local = local;
    let whole = particles::<f64>(SIDE, &conditions, &Serial, false);
    let parts = particles_of_pencils::<f64>(&conditions);
    let fastest = whole.1.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
    for (a, b) in parts.1.iter().zip(&whole.1) {
        // The mean is a sum in another order: a few roundings of a term that is of the order of the field itself.
        assert!((a - b).abs() < 1e-14 * fastest);
    }
    conditions.local.g_nl = 0.0;
    let without = particles::<f64>(SIDE, &conditions, &Serial, false);
    assert!(whole.1.iter().zip(&without.1).any(|(a, b)| (a - b).abs() > 1e-6 * fastest), "and it is there");
}

/// Modes and sums of |f_k|^2 in shells.
fn shells(sums: &[i64], binning: &Binning<'_>) -> (Vec<u64>, Vec<f64>) {
    let mut bins = vec![Bin::default(); binning.bins().unwrap()];
    let mut power = vec![0.0; bins.len()];
    read_sums(&mut bins, &mut power, sums, binning, 1).unwrap();
    (bins.iter().map(|bin| bin.count).collect(), power)
}

#[test]
fn power_of_pencils_adds_up_to_that_of_the_whole() {
    let edges: Vec<u64> = (1..=SIDE as u64 / 2).map(|b| b * b).collect();
    let binning = Binning::shells(&edges);
    let (potential, alpha) = tables(SIDE);
    let measure = |fft: &mut dyn Fft3<f64>, sums: &mut [i64]| -> Vec<f64> {
        let brick = *fft.fourier();
        let (mut density, mut mesh) = (vec![0.0; fft.length()], vec![0.0; fft.length()]);
        let field = Field {
            realisation: realisation(4, Amplitude::Normal, Phase::Original),
            potential_amplitude: &potential,
            local: Local { f_nl: 100.0, g_nl: 0.0 },
            shape: Shape::Local.rows(),
            n_s: 1.0,
            transfer: &alpha,
        };
        let mut partial = vec![[0.0]; SIDE];
        let work = FieldWork { mesh: &mut mesh, rest: &mut [], table: &mut [], partial: &mut partial };
        linear_density(&mut density, &field, fft, None, work, &Serial).unwrap();
        let mut scratch = Memory::new(power_sums_scratch(&brick, &binning, 1).unwrap());
        let (none, modes) = ([Compensation::None], [&density[..]]);
        power_sums(sums, &modes, &[[0, 0]], &none, &brick, &binning, scratch.get(), &Serial).unwrap();
        density
    };
    let mut whole = vec![0; binning.words(1).unwrap()];
    let density = measure(&mut serial::<f64>(SIDE), &mut whole);
    let all = Mutex::new(vec![0; whole.len()]);
    on_pencils::<f64>(|fft| {
        let mut sums = vec![0; whole.len()];
        let part = measure(fft, &mut sums);
        for (here, there) in addresses(fft.fourier()) {
            assert_eq!(part[here..here + 2], density[there..there + 2]);
        }
        all.lock().unwrap().iter_mut().zip(&sums).for_each(|(all, sum)| *all += sum);
    });
    let (whole, parts) = (shells(&whole, &binning), shells(&all.into_inner().unwrap(), &binning));
    assert_eq!(parts.0, whole.0, "modes");
    for (part, whole) in parts.1.iter().zip(&whole.1) {
        // Lines along l are summed before they become integers, and these pencils cut them.
        assert!((part / whole - 1.0).abs() < 1e-14, "{part} {whole}");
    }
}
