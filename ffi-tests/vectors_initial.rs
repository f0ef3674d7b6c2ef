//! The cases of the one call beyond local f_NL and second order: the third order, shapes, species, pre-initial positions; and the stages of the
//! third order.

use fixpair::cosmology::{Convention, Cosmology, Ratio, Species, mode_table_length, species_table};
use fixpair::exec::Serial;
use fixpair::fft::Fft3;
use fixpair::initial::conditions::{InitialConditions, Order};
use fixpair::initial::modes::scale_by_table;
use fixpair::initial::particles::Components;
use fixpair::initial::png::Local;
use fixpair::initial::shape::{Shape, ShapeRow};
use fixpair::initial::shifted::half_cells_length;
use fixpair::initial::third::{
    second_order_exact, third_order_scratch, third_order_sources, transverse_displacement,
};
use fixpair::noise::{Amplitude, Phase, Realisation, white_modes_coloured};
use fixpair::pm::{Positions, initial_conditions_at, initial_conditions_at_scratch};
use fixpair::real::Real;

use crate::vectors::{
    BOX, Cases, FINE, FINER, Hash, N, PADDING, SEED, default_linear, mode_tables, noise, rows,
};
use crate::vectors_real::{Memory, elements, particles, triples, with_transform};

/// Particles that do not begin on the lattice.
const PARTICLES: usize = 500;

/// A caller's own kernel.
const KERNEL: [ShapeRow; 3] =
    [row(2.0, [0.0, 0.0, 0.0]), row(-1.5, [-1.0, 0.0, 1.0]), row(0.5, [1.0, -0.5, -0.5])];

const fn row(coefficient: f64, [s_out, s_a, s_b]: [f64; 3]) -> ShapeRow {
    ShapeRow { coefficient, s_out, s_a, s_b }
}

/// k, T_m, T_s, V_s, and what the linear spectrum stands for.
fn columns() -> [Vec<f64>; 5] {
    let [k, _, matter] = rows();
    let column = |top: f64, slope: f64| {
        (1..=40)
            .map(|row| f64::from(row) * f64::from(row))
            .map(|square| top / (1.0 + slope * square))
            .collect()
    };
    [k, matter, column(1.25, 0.0625), column(0.875, 0.04), column(1.0, 0.045)]
}

fn species(columns: &[Vec<f64>; 5], reference: bool) -> Species<'_> {
    let [k, matter, density, velocity, spectrum] = columns;
    Species::new(k, matter, density, velocity, reference.then_some(&spectrum[..])).expect("columns")
}

/// All ratios of a species without and with a reference.
pub(crate) fn species_cases(cases: &mut Cases) {
    let columns = columns();
    let mut table = vec![0.0; mode_table_length(N).expect("a length")];
    let mut hash = Hash::new();
    for reference in [false, true] {
        for ratio in [Ratio::Matter, Ratio::Density, Ratio::Velocity] {
            species_table(&Serial, &species(&columns, reference), ratio, N, BOX, &mut table).expect("ratios");
            hash = hash.doubles(&table);
        }
    }
    cases.add("species_table", hash);
}

/// What differs from fixpair_conditions_init: a fixed, inverted realisation, f_NL = 100 and these.
#[derive(Clone, Copy)]
struct Universe {
    order: Order,
    /// Side of the finer mesh.
    fine: Option<usize>,
    shape: &'static [ShapeRow],
    g_nl: f64,
    /// A species, and whether it has a reference.
    species: Option<bool>,
}

fn universes() -> [(&'static str, Universe); 11] {
    let second =
        Universe { order: Order::Second, fine: None, shape: Shape::Local.rows(), g_nl: 0.0, species: None };
    let third = Universe { order: Order::Third, ..second };
    let equilateral = Universe { shape: Shape::Equilateral.rows(), ..second };
    let own = Universe { shape: &KERNEL, ..second };
    let cubic = Universe { fine: Some(FINER), g_nl: 1e5, ..own };
    let [alone, with_reference] =
        [false, true].map(|reference| Universe { species: Some(reference), ..second });
    [
        ("third", third),
        ("third_exact", Universe { fine: Some(FINE), ..third }),
        ("equilateral", equilateral),
        ("equilateral_exact", Universe { fine: Some(FINE), ..equilateral }),
        ("rows", own),
        ("rows_cubic", cubic),
        ("species", alone),
        ("species_reference", Universe { fine: Some(FINE), ..with_reference }),
        ("species_first", Universe { order: Order::First, ..alone }),
        ("species_third", Universe { order: Order::Third, ..with_reference }),
        ("everything", Universe { order: Order::Third, species: Some(true), ..cubic }),
    ]
}

/// Which of them begin at positions of their own too.
const AT: [&str; 4] = ["third", "equilateral_exact", "species_first", "everything"];

pub(crate) fn initial_cases<T: Real>(add: &mut dyn FnMut(&str, Hash)) {
    for (name, universe) in universes() {
        add(&format!("initial.{name}"), universe.make::<T>(particles));
        if AT.contains(&name) {
            add(&format!("initial_at.{name}"), universe.make::<T>(particles_at));
        }
    }
    third_order_stages::<T>(add);
}

type Make<T> = fn(&InitialConditions<'_>, &mut dyn Fft3<T>, Option<&mut dyn Fft3<T>>) -> Hash;

impl Universe {
    fn make<T: Real>(&self, make: Make<T>) -> Hash {
        let columns = columns();
        let pair =
            Realisation { amplitude: Amplitude::Fixed, phase: Phase::Inverted, ..Realisation::new(SEED) };
        let conditions = InitialConditions {
            realisation: pair,
            cosmology: Cosmology::goliat(),
            linear: default_linear(),
            redshift: 32.0,
            box_size: BOX,
            local: Local { f_nl: 100.0, g_nl: self.g_nl },
            shape: self.shape,
            convention: Convention::Cmb,
            order: self.order,
            species: self.species.map(|reference| species(&columns, reference)),
        };
        with_transform::<T, _>(N, 0, |fft| match self.fine {
            None => make(&conditions, fft, None),
            Some(side) => with_transform::<T, _>(side, 0, |fine| make(&conditions, fft, Some(fine))),
        })
    }
}

/// Particles from all over the box and the one before it.
fn particles_at<T: Real>(
    conditions: &InitialConditions<'_>,
    fft: &mut dyn Fft3<T>,
    fine: Option<&mut dyn Fft3<T>>,
) -> Hash {
    let places: Vec<T> = (0..3 * PARTICLES).map(|i| T::from_f64(BOX * noise(i))).collect();
    let pre_initial = Positions::triples(&places).expect("triples");
    let layout = initial_conditions_at_scratch(conditions.parts(), PARTICLES, fft, fine.as_deref());
    let layout = layout.expect("scratch");
    let mut scratch = Memory::new(layout);
    let [mut position, mut velocity] = [(); 2].map(|()| vec![T::ZERO; 3 * PARTICLES]);
    {
        let mut position = Components::triples(&mut position).expect("triples");
        let mut velocity = Components::triples(&mut velocity).expect("triples");
        let (x, v) = (&mut position, &mut velocity);
        let scratch = scratch.bytes(layout.size);
        let fine = fine.map(|fine| fine as &mut dyn Fft3<T>);
        initial_conditions_at(x, v, &pre_initial, conditions, fft, fine, scratch, &Serial)
            .expect("particles");
    }
    let hash = Hash::new().integers(&[layout.size as u64, layout.align as u64]);
    triples(triples(hash, &position), &velocity)
}

/// On a mesh whose planes are padded.
fn third_order_stages<T: Real>(add: &mut dyn FnMut(&str, Hash)) {
    let [amplitude, alpha] = mode_tables();
    with_transform::<T, _>(N, PADDING, |fft| {
        let (brick, cells) = (*fft.fourier(), *fft.configuration());
        let mesh = || vec![T::ZERO; fft.length()];
        let mut density = mesh();
        let realisation = Realisation::new(SEED);
        white_modes_coloured(&mut density, &brick, &realisation, &amplitude, &Serial).expect("modes");
        scale_by_table(&mut density, &brick, &alpha, &Serial).expect("modes");
        let layout = third_order_scratch(fft).expect("scratch");
        let mut hash = Hash::new().integers(&[layout.size as u64, layout.align as u64]);
        let mut out = [(); 6].map(|()| mesh());
        let mut work = [(); 12].map(|()| mesh());
        let mut psi = mesh();
        let mut table = vec![[0.0; 2]; half_cells_length(N)];
        let [second, third @ ..] = out.each_mut().map(|mesh| &mut mesh[..]);
        let [a, b, c, d, e, f, ..] = work.each_mut().map(|mesh| &mut mesh[..]);
        second_order_exact(second, &density, fft, [a, b, c, d, e, f], &mut table, &Serial).expect("S");
        let work = work.each_mut().map(|mesh| &mut mesh[..]);
        third_order_sources(third, &density, second, fft, work, &mut table, &Serial).expect("sources");
        hash = out.iter().fold(hash, |hash, modes| elements(hash, modes, &brick));
        add("third_order_sources", hash);
        let curl = [&out[3][..], &out[4], &out[5]];
        let mut hash = Hash::new();
        for axis in 0..3 {
            // A scale that all languages write alike.
            transverse_displacement(&mut psi, curl, axis, 32.0, fft, &Serial).expect("a displacement");
            hash = elements(hash, &psi, &cells);
        }
        add("transverse_displacement", hash);
    });
}
