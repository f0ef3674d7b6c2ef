//! Cosmologies, linear spectra, species and conditions, with tables of a few rows.

use core::ptr::null;

use fixpair::initial::shape::ShapeRow;

use crate::c::*;
use crate::input::Input;
use crate::memory::Memory;

/// The cosmology of the header's initialiser, with up to all of its members spoiled.
pub fn cosmology(input: &mut Input) -> fixpair_cosmology {
    let of = Memory::<fixpair_cosmology>::zeros(1);
    must!(fixpair_cosmology_init(of.pointer()));
    let mut of = of.values()[0];
    if input.odd(4) {
        for _ in 0..=input.few(3) {
            let members = [
                &mut of.omega_m,
                &mut of.omega_de,
                &mut of.omega_r,
                &mut of.omega_b,
                &mut of.h,
                &mut of.n_s,
                &mut of.w0,
                &mut of.wa,
                &mut of.t_cmb,
            ];
            let which = input.few(9);
            for (_, member) in members.into_iter().enumerate().filter(|(place, _)| *place == which) {
                *member = if input.flag() { input.number() } else { *member * input.between(0.5, 1.5) };
            }
        }
    }
    if input.odd(64) {
        of.struct_size = input.size();
    }
    of
}

/// Columns of positive numbers, rising or falling, the first of them increasing.
pub struct Rows {
    columns: Vec<Memory<f64>>,
    rows: usize,
}

impl Rows {
    pub fn new(input: &mut Input, columns: usize) -> Self {
        let rows = if input.odd(8) { input.few(4) } else { 4 + input.few(4) };
        let mut random = input.random();
        let mut columns: Vec<_> = (0..columns)
            .map(|column| {
                let value = |row: usize| match column {
                    0 => 1e-3 * 4_f64.powi(row as i32),
                    _ => 1e3 * 2_f64.powi(-(row as i32)) * (0.5 + random.unit()),
                };
                Memory::new(rows, value)
            })
            .collect();
        if input.odd(4) {
            let column = input.few(columns.len());
            columns[column].spoil(input);
        }
        Self { columns, rows }
    }
}

/// For the most part by A_s or an amplitude; seldom by sigma_8, which is an integral.
const NORMALISATIONS: [i32; 8] = {
    use {
        FIXPAIR_NORMALISE_A_S as A_S, FIXPAIR_NORMALISE_AMPLITUDE as AMPLITUDE,
        FIXPAIR_NORMALISE_SIGMA8 as SIGMA8,
    };
    [A_S, A_S, AMPLITUDE, A_S, SIGMA8, A_S, AMPLITUDE, A_S]
};

/// A fit without rows, or rows of P(k) or T(k).
pub fn linear(input: &mut Input, rows: &Rows) -> fixpair_linear {
    let source = [2, 0, 1, 3][input.few(4)];
    let source = if input.odd(32) { input.choice(4) } else { source };
    let normalisation = if source == 0 && input.flag() { 0 } else { NORMALISATIONS[input.few(8)] };
    let normalisation = if input.odd(32) { input.choice(4) } else { normalisation };
    let with = source < 2 || input.odd(32);
    let [k, value] = if with {
        [0, 1].map(|column| input.pointer(&rows.columns[column]).cast_const())
    } else {
        [null(); 2]
    };
    fixpair_linear {
        struct_size: if input.odd(64) { input.size() } else { size_of::<fixpair_linear>() },
        source,
        normalisation,
        k,
        value,
        rows: if with { input.length(rows.rows) } else { 0 },
        amount: input.about_number([0.8, 0.8, 1e6, 2e-9][normalisation.rem_euclid(4) as usize]),
    }
}

pub fn species(input: &mut Input, rows: &Rows) -> fixpair_species {
    let of = Memory::<fixpair_species>::zeros(1);
    must!(fixpair_species_init(of.pointer()));
    let mut of = of.values()[0];
    let mut column = |place: usize| input.pointer(&rows.columns[place]).cast_const();
    (of.k, of.matter, of.density, of.velocity) = (column(0), column(1), column(2), column(3));
    of.reference = if input.flag() { input.pointer(&rows.columns[4]) } else { null() };
    of.rows = input.length(rows.rows);
    if input.odd(64) {
        of.struct_size = input.size();
    }
    of
}

/// Rows of a kernel, of exponents that sum to zero for the most part.
pub fn shape_rows(input: &mut Input) -> Memory<ShapeRow> {
    let mut rows = Memory::<ShapeRow>::zeros(input.few(4));
    for row in rows.values_mut() {
        let mut exponent = || if input.odd(8) { input.number() } else { input.few(5) as f64 - 2.0 };
        let (s_a, s_b) = (exponent(), exponent());
        row.s_a = s_a;
        row.s_b = s_b;
        row.s_out = if input.odd(16) { input.number() } else { -(s_a + s_b) };
        row.coefficient = input.about_number(2.0);
    }
    rows
}

/// Everything that initial conditions ask, small; `rows` are read where it says so.
pub fn conditions(
    input: &mut Input,
    table: &Rows,
    rows: &Memory<ShapeRow>,
    species: &fixpair_species,
) -> fixpair_conditions {
    let of = Memory::<fixpair_conditions>::zeros(1);
    must!(fixpair_conditions_init(of.pointer(), input.word()));
    let mut of = of.values()[0];
    of.realisation = crate::rooms::meshes::realisation(input, 8);
    of.cosmology = cosmology(input);
    if !input.odd(16) {
        of.linear = linear(input, table);
    }
    of.redshift = input.about_number(32.0);
    of.box_size = input.about_number(100.0);
    of.f_nl = [0.0, 100.0, input.about_number(-100.0)][input.few(3)];
    of.g_nl = [0.0, 1e5, input.about_number(1e5)][input.few(3)];
    of.convention = input.choice(2);
    of.order = if input.odd(16) { input.choice(5) } else { [2, 1, 2, 1, 2, 1, 2, 3][input.few(8)] };
    of.shape = input.choice(6);
    of.rows = input.pointer(rows);
    of.rows_len = input.length(rows.len());
    of.species = if input.odd(4) { species } else { null() };
    if input.odd(64) {
        of.struct_size = input.size();
    }
    of
}
