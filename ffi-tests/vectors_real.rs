//! The cases that exist in both precisions.

use fixpair::cosmology::{Convention, Cosmology, Linear, Table};
use fixpair::exec::Serial;
use fixpair::fft::{Fft3, Tables, Transform, recommended_padding};
use fixpair::initial::conditions::{
    InitialConditions, Order, initial_conditions, initial_conditions_scratch,
};
use fixpair::initial::lpt::{displacement, second_order_source};
use fixpair::initial::modes::{copy_modes, scale_by_table};
use fixpair::initial::particles::{Components, Step, displace};
use fixpair::initial::png::{Local, add_local, add_local_scratch};
use fixpair::initial::shape::Shape;
use fixpair::mesh::{Brick, Space};
use fixpair::noise::{
    Amplitude, Nyquist, Phase, Realisation, Scheme, Selection, impose, unit_modes_from_field, white_modes,
    white_modes_coloured,
};
use fixpair::real::Real;
use fixpair::scratch::Layout;

use crate::vectors::{
    BOX, Cases, FINE, FINER, Hash, N, PADDING, SEED, bricks, default_linear, mode_tables, noise, rows,
};
use crate::vectors_estimate::estimate_cases;
use crate::vectors_gravity::gravity_cases;
use crate::vectors_halos::halo_cases;
use crate::vectors_initial::initial_cases;
use crate::vectors_particles::particle_cases;
use crate::vectors_shape::shape_cases;

/// Memory that begins on a cache line.
pub(crate) struct Memory(Vec<[u64; 8]>);

impl Memory {
    pub(crate) fn new(layout: Layout) -> Self {
        Self(vec![[0; 8]; layout.size / 64 + 2])
    }

    pub(crate) fn bytes(&mut self, size: usize) -> &mut [u8] {
        // SAFETY: any bytes are integers and the other way round.
        let bytes = unsafe { self.0.align_to_mut::<u8>().1 };
        let skip = bytes.as_ptr().align_offset(64);
        &mut bytes[skip..skip + size]
    }
}

fn bytes<T: Real>(value: T) -> Vec<u8> {
    if size_of::<T>() == 4 {
        (value.to_f64() as f32).to_ne_bytes().to_vec()
    } else {
        value.to_f64().to_ne_bytes().to_vec()
    }
}

/// The elements of a brick in the order of their indices, wherever they lie.
pub(crate) fn elements<T: Real>(mut hash: Hash, data: &[T], brick: &Brick) -> Hash {
    let (count, stride, width) = (brick.count(), brick.stride(), brick.space().width());
    for x in 0..count[0] {
        for y in 0..count[1] {
            for z in 0..count[2] {
                let at = width * (x * stride[0] + y * stride[1] + z * stride[2]);
                for &part in &data[at..at + width] {
                    hash = hash.bytes(&bytes(part));
                }
            }
        }
    }
    hash
}

pub(crate) fn with_transform<T: Real, R>(
    n: usize,
    padding: usize,
    body: impl FnOnce(&mut Transform<'_, T>) -> R,
) -> R {
    let layout = Tables::<T>::layout(n).expect("a side");
    let mut memory = Memory::new(layout);
    let tables = Tables::<T>::new(n, memory.bytes(layout.size)).expect("tables");
    let workspace = Transform::<T>::workspace(n).expect("a side");
    let mut scratch = Memory::new(workspace);
    let cells = Brick::whole_padded(n, Space::Configuration, padding).expect("a brick");
    let transform = Transform::new(&tables, cells, scratch.bytes(workspace.size), &Serial);
    body(&mut transform.expect("a transform"))
}

pub(crate) fn real_cases<T: Real>(cases: &mut Cases, suffix: &str) {
    let mut add = |name: &str, hash: Hash| cases.add(&format!("{name}.{suffix}"), hash);
    transform_cases::<T>(&mut add);
    white_cases::<T>(&mut add);
    stage_cases::<T>(&mut add);
    shape_cases::<T>(&mut add);
    particle_cases::<T>(&mut add);
    estimate_cases::<T>(&mut add);
    gravity_cases::<T>(&mut add);
    halo_cases::<T>(&mut add);
    for (name, order, fine, realisation, local) in conditions() {
        add(name, universe::<T>(order, fine, realisation, local));
    }
    initial_cases::<T>(&mut add);
}

fn transform_cases<T: Real>(add: &mut dyn FnMut(&str, Hash)) {
    let padding = (0..300).map(|n| recommended_padding::<T>(n) as u64);
    add("fft_padding", Hash::new().integers(&padding.collect::<Vec<_>>()));
    let layout = Tables::<T>::layout(N).expect("a side");
    // As the header has it: 4096 (n + 2) bytes and 256 more.
    let scratch = 4096 * (N as u64 + 2) + 256;
    add("fft_sizes", Hash::new().integers(&[layout.size as u64, layout.align as u64, scratch, 64]));
    let mut memory = Memory::new(layout);
    Tables::<T>::new(N, memory.bytes(layout.size)).expect("tables");
    add("fft_tables", Hash::new().bytes(memory.bytes(layout.size)));
    for (padding, name) in [(0, "fft_pair"), (PADDING, "fft_pair_padded")] {
        let hash = with_transform::<T, _>(N, padding, |fft| {
            let mut data: Vec<T> = (0..fft.length()).map(|i| T::from_f64(noise(i))).collect();
            fft.forward(&mut data).expect("modes");
            let hash = elements(Hash::new(), &data, fft.fourier());
            fft.inverse(&mut data).expect("cells");
            elements(hash, &data, fft.configuration())
        });
        add(name, hash);
    }
}

fn white_cases<T: Real>(add: &mut dyn FnMut(&str, Hash)) {
    let [table, _] = mode_tables();
    for (name, brick) in bricks() {
        let mut modes = vec![T::ZERO; brick.reals()];
        white_modes(&mut modes, &brick, &Realisation::new(SEED), &Serial).expect("modes");
        add(&format!("white_modes.{name}"), elements(Hash::new(), &modes, &brick));
        let fixed = Realisation { amplitude: Amplitude::Fixed, ..Realisation::new(SEED) };
        white_modes_coloured(&mut modes, &brick, &fixed, &table, &Serial).expect("modes");
        add(&format!("white_modes.coloured_{name}"), elements(Hash::new(), &modes, &brick));
        let ngenic = Realisation {
            scheme: Scheme::NGenIc,
            selection: Selection::Sphere,
            sample: N as u32 - 3,
            ..Realisation::new(SEED)
        };
        white_modes(&mut modes, &brick, &ngenic, &Serial).expect("modes");
        add(&format!("white_modes.ngenic_{name}"), elements(Hash::new(), &modes, &brick));
        let fast_pm = Realisation { scheme: Scheme::FastPm, nyquist: Nyquist::Filled, ..fixed };
        white_modes_coloured(&mut modes, &brick, &fast_pm, &table, &Serial).expect("modes");
        add(&format!("white_modes.fastpm_{name}"), elements(Hash::new(), &modes, &brick));
    }
    let brick = Brick::whole(N, Space::Fourier).expect("a brick");
    let mut modes = vec![T::ZERO; brick.reals()];
    let mean = Realisation {
        amplitude: Amplitude::FixedToMean,
        phase: Phase::Inverted,
        nyquist: Nyquist::Filled,
        ..Realisation::new(SEED)
    };
    white_modes(&mut modes, &brick, &mean, &Serial).expect("modes");
    add("white_modes.mean", elements(Hash::new(), &modes, &brick));
    white_modes(&mut modes, &brick, &Realisation::new(SEED), &Serial).expect("modes");
    let imposed = Realisation { amplitude: Amplitude::Fixed, ..mean };
    impose(&mut modes, &brick, &imposed, &Serial).expect("modes");
    add("impose", elements(Hash::new(), &modes, &brick));
    let hash = with_transform::<T, _>(N, 0, |fft| {
        let mut data: Vec<T> = (0..fft.length()).map(|i| T::from_f64(noise(i))).collect();
        let inverted = Realisation { phase: Phase::Inverted, ..Realisation::new(SEED) };
        unit_modes_from_field(fft, &mut data, &inverted, &Serial).expect("modes");
        elements(Hash::new(), &data, fft.fourier())
    });
    add("modes_from_field", hash);
}

fn stage_cases<T: Real>(add: &mut dyn FnMut(&str, Hash)) {
    let [amplitude, alpha] = mode_tables();
    let brick = Brick::whole(N, Space::Fourier).expect("a brick");
    let cells = Brick::whole(N, Space::Configuration).expect("a brick");
    let mut phi = vec![T::ZERO; brick.reals()];
    white_modes_coloured(&mut phi, &brick, &Realisation::new(SEED), &amplitude, &Serial).expect("modes");
    for (name, side, g_nl) in [("add_local.aliased", N, 0.0), ("add_local.exact", FINER, 1e7)] {
        let mut phi = phi.clone();
        with_transform::<T, _>(side, 0, |work| {
            let mut mesh = vec![T::ZERO; work.length()];
            let mut partial = vec![[0.0]; add_local_scratch::<T>(work).expect("scratch").size / 8];
            let local = Local { f_nl: 5000.0, g_nl };
            add_local(&mut phi, &brick, local, work, &mut mesh, &mut partial, &Serial).expect("modes");
        });
        add(name, elements(Hash::new(), &phi, &brick));
    }
    let mut density = phi;
    scale_by_table(&mut density, &brick, &alpha, &Serial).expect("modes");
    add("scale_modes", elements(Hash::new(), &density, &brick));
    let fine = Brick::whole(FINE, Space::Fourier).expect("a brick");
    let mut copy = vec![T::ZERO; fine.reals()];
    copy_modes(&mut copy, &fine, &density, &brick, &Serial).expect("modes");
    add("copy_modes", elements(Hash::new(), &copy, &fine));
    let mut source = vec![T::ZERO; brick.reals()];
    with_transform::<T, _>(FINE, 0, |work| {
        let [mut one, mut two, mut three] = [(); 3].map(|()| vec![T::ZERO; work.length()]);
        second_order_source(&mut source, &density, &brick, work, [&mut one, &mut two, &mut three], &Serial)
            .expect("a source");
    });
    add("second_order_source", elements(Hash::new(), &source, &brick));
    // As long as the transform asks: the padding of the last row too.
    let mut psi = [(); 2].map(|()| vec![T::ZERO; N * N * (N + 2)]);
    with_transform::<T, _>(N, 0, |fft| {
        // Scales that all languages write alike.
        displacement(&mut psi[0], &density, &brick, 1, 32.0, fft, &Serial).expect("a displacement");
        displacement(&mut psi[1], &source, &brick, 1, 13.5, fft, &Serial).expect("a displacement");
    });
    add("displacement", elements(elements(Hash::new(), &psi[0], &cells), &psi[1], &cells));
    let [mut position, mut velocity] = [(); 2].map(|()| vec![T::ZERO; 3 * cells.elements()]);
    let step = Step { box_size: BOX, first_velocity: 600.0, second_velocity: 1200.0 };
    {
        let mut position = Components::triples(&mut position).expect("triples");
        let mut velocity = Components::triples(&mut velocity).expect("triples");
        displace(&mut position, &mut velocity, &psi[0], Some(&psi[1]), &cells, 1, &step, &Serial)
            .expect("particles");
    }
    add("displace", triples(triples(Hash::new(), &position), &velocity));
}

pub(crate) fn triples<T: Real>(hash: Hash, values: &[T]) -> Hash {
    values.iter().fold(hash, |hash, &value| hash.bytes(&bytes(value)))
}

/// Name, order, side of the finer mesh, realisation, f_NL and g_NL.
fn conditions() -> [(&'static str, Order, Option<usize>, Realisation, Local); 4] {
    let normal = Realisation::new(SEED);
    let pair = Realisation { amplitude: Amplitude::Fixed, phase: Phase::Inverted, ..normal };
    let local = Local { f_nl: 100.0, g_nl: 0.0 };
    [
        ("initial.gaussian", Order::Second, None, normal, Local::default()),
        ("initial.local", Order::Second, Some(FINE), pair, local),
        ("initial.cubic", Order::Second, Some(FINER), pair, Local { g_nl: 1e5, ..local }),
        ("initial.first", Order::First, None, pair, local),
    ]
}

/// At first order with the rows as spectrum, z = 49 and the LSS convention; else as fixpair_conditions_init has it.
fn universe<T: Real>(order: Order, fine: Option<usize>, realisation: Realisation, local: Local) -> Hash {
    let [k, power, _] = rows();
    let mut conditions = InitialConditions {
        realisation,
        cosmology: Cosmology::goliat(),
        linear: default_linear(),
        redshift: 32.0,
        box_size: BOX,
        local,
        shape: Shape::Local.rows(),
        convention: Convention::Cmb,
        order,
        species: None,
    };
    if order == Order::First {
        conditions.redshift = 49.0;
        conditions.convention = Convention::Lss;
        let table = Table::new(&k, &power).expect("rows");
        conditions.linear = Linear::from_power(table, conditions.cosmology.n_s).expect("a spectrum");
    }
    with_transform::<T, _>(N, 0, |fft| match fine {
        None => particles(&conditions, fft, None),
        Some(side) => with_transform::<T, _>(side, 0, |fine| particles(&conditions, fft, Some(fine))),
    })
}

/// One call, on the lattice of the mesh.
pub(crate) fn particles<T: Real>(
    conditions: &InitialConditions<'_>,
    fft: &mut dyn Fft3<T>,
    mut fine: Option<&mut dyn Fft3<T>>,
) -> Hash {
    let layout = initial_conditions_scratch(conditions.parts(), fft, fine.as_deref()).expect("scratch");
    let mut scratch = Memory::new(layout);
    let [mut position, mut velocity] = [(); 2].map(|()| vec![T::ZERO; 3 * N * N * N]);
    {
        let mut position = Components::triples(&mut position).expect("triples");
        let mut velocity = Components::triples(&mut velocity).expect("triples");
        let scratch = scratch.bytes(layout.size);
        let fine = fine.take();
        initial_conditions(&mut position, &mut velocity, conditions, fft, fine, scratch, &Serial)
            .expect("particles");
    }
    let hash = Hash::new().integers(&[layout.size as u64, layout.align as u64]);
    triples(triples(hash, &position), &velocity)
}
