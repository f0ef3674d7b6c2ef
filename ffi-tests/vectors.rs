//! The cases: names, and the FNV-1a hash of the bytes that the Rust interface computes for each. The programs read them from a file of
//! lines "name hash". Inputs are made of integers, quotients and products, so that every language makes the same bits.

use std::path::PathBuf;
use std::sync::LazyLock;

use fixpair::cosmology::{
    Convention, Cosmology, EisensteinHu, Growth, Linear, Poisson, Table, Wiggles, alpha_table, g_ratio,
    growth_many, mode_table_length, potential_amplitude_table, primordial_amplitude, radiation_density,
};
use fixpair::exec::Serial;
use fixpair::fft::next_side;
use fixpair::initial::particles::particle_ids;
use fixpair::mesh::{Brick, Space};
use fixpair::noise::ngenic_seeds;
use fixpair::noise::philox::philox4x32_10;
use fixpair::noise::ranlux::Ranlxd1;
use fixpair::status::Error;

use crate::native::folder;
use crate::vectors_estimate::bin_cases;
use crate::vectors_gravity::time_cases;
use crate::vectors_halos::halo_scalars;
use crate::vectors_initial::species_cases;
use crate::vectors_particles::ghost_cases;
use crate::vectors_real::real_cases;
use crate::vectors_shape::shape_rows;
use crate::vectors_variance::variance_cases;

/// Side of the mesh, of the finer mesh for squares, and of that for cubes.
pub(crate) const N: usize = 12;
pub(crate) const FINE: usize = 18;
pub(crate) const FINER: usize = 24;
pub(crate) const BOX: f64 = 200.0;
pub(crate) const SEED: u64 = 0x0123_4567_89ab_cdef;
/// Modes of padding after each plane, in the cases that have some.
pub(crate) const PADDING: usize = 3;

/// FNV-1a of 64 bits.
#[derive(Clone, Copy)]
pub(crate) struct Hash(u64);

impl Hash {
    pub(crate) fn new() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }

    pub(crate) fn bytes(mut self, bytes: &[u8]) -> Self {
        for &byte in bytes {
            self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x100_0000_01b3);
        }
        self
    }

    pub(crate) fn doubles(self, values: &[f64]) -> Self {
        values.iter().fold(self, |hash, value| hash.bytes(&value.to_ne_bytes()))
    }

    pub(crate) fn integers(self, values: &[u64]) -> Self {
        values.iter().fold(self, |hash, value| hash.bytes(&value.to_ne_bytes()))
    }
}

#[derive(Default)]
pub(crate) struct Cases(String);

impl Cases {
    pub(crate) fn add(&mut self, name: &str, hash: Hash) {
        self.0 += &format!("{name} {:016x}\n", hash.0);
    }
}

/// A number in [-1, 1) that looks random.
pub(crate) fn noise(i: usize) -> f64 {
    f64::from((i as u32).wrapping_mul(2_654_435_761).wrapping_add(12345)) / 2_147_483_648.0 - 1.0
}

/// The file of all cases.
pub(crate) static VECTORS: LazyLock<PathBuf> = LazyLock::new(|| {
    let mut cases = Cases::default();
    scalar_cases(&mut cases);
    cosmology_cases(&mut cases);
    species_cases(&mut cases);
    ghost_cases(&mut cases);
    bin_cases(&mut cases);
    time_cases(&mut cases);
    halo_scalars(&mut cases);
    shape_rows(&mut cases);
    variance_cases(&mut cases);
    real_cases::<f32>(&mut cases, "f32");
    real_cases::<f64>(&mut cases, "f64");
    let path = folder().join("vectors.txt");
    std::fs::write(&path, cases.0).expect("the target folder can be written");
    path
});

fn scalar_cases(cases: &mut Cases) {
    let messages = Error::ALL
        .iter()
        .fold(Hash::new().bytes(b"ok"), |hash, error| hash.bytes(error.message().to_bytes()));
    cases.add("status_message", messages);
    cases.add("version", Hash::new().bytes(env!("CARGO_PKG_VERSION").as_bytes()));
    let block = philox4x32_10([1, 2, 3, 4], [5, 6]);
    cases.add("philox4x32_10", block.iter().fold(Hash::new(), |hash, word| hash.bytes(&word.to_ne_bytes())));
    let mut stream = Ranlxd1::new(SEED);
    cases.add("ranlxd1", (0..40).fold(Hash::new(), |hash, _| hash.bytes(&stream.uniform().to_ne_bytes())));
    for (name, brick) in bricks() {
        let mut seeds = vec![0; brick.count()[0] * brick.count()[1]];
        ngenic_seeds(&mut seeds, &brick, SEED).expect("seeds");
        let hash = seeds.iter().fold(Hash::new(), |hash, seed| hash.bytes(&seed.to_ne_bytes()));
        cases.add(&format!("ngenic_seeds.{name}"), hash);
    }
    cases.add("realisation_init", Hash::new().integers(&[SEED, 0, 0, 0, 0, 0, 0]));
    for (name, brick) in bricks() {
        cases.add(&format!("brick.{name}"), describe(&brick));
    }
    let sides = (0..400).map(|least| next_side(least).map_or(0, |side| side as u64));
    cases.add("fft_next_side", Hash::new().integers(&sides.collect::<Vec<_>>()));
    let slab = Brick::slab(N, Space::Configuration, 3, 5).expect("a slab");
    let mut ids = vec![0; slab.elements()];
    particle_ids(&mut ids, &slab, 1, &Serial).expect("ids");
    cases.add("particle_ids", Hash::new().integers(&ids));
}

/// The bricks of Fourier space on which kernels are tried: "general" is the whole mesh with i innermost.
pub(crate) fn bricks() -> [(&'static str, Brick); 5] {
    let row = N / 2 + 1;
    let general = Brick::general(N, Space::Fourier, [0; 3], [N, N, row], [1, N + 1, N * (N + 1) + 2]);
    [
        ("whole", Brick::whole(N, Space::Fourier).expect("a brick")),
        ("padded", Brick::whole_padded(N, Space::Fourier, PADDING).expect("a brick")),
        ("slab", Brick::slab(N, Space::Fourier, 3, 5).expect("a brick")),
        ("transposed", Brick::transposed_slab(N, 2, 7).expect("a brick")),
        ("general", general.expect("a brick")),
    ]
}

fn describe(brick: &Brick) -> Hash {
    let mut numbers = vec![brick.n(), brick.space() as usize];
    for triple in [brick.start(), brick.count(), brick.stride()] {
        numbers.extend(triple);
    }
    numbers.push(brick.reals());
    Hash::new().integers(&numbers.into_iter().map(|number| number as u64).collect::<Vec<_>>())
}

/// A universe with everything in it.
fn full() -> Cosmology {
    Cosmology { omega_de: 0.7, omega_r: 1e-4, w0: -0.9, wa: 0.1, ..Cosmology::goliat() }
}

/// Rows of k, P and T.
pub(crate) fn rows() -> [Vec<f64>; 3] {
    let squares = || (1..=40).map(|row| f64::from(row) * f64::from(row));
    [
        squares().map(|square| 0.0005 * square).collect(),
        squares().map(|square| 20000.0 / (1.0 + 0.05 * square)).collect(),
        squares().map(|square| 1.0 / (1.0 + 0.05 * square)).collect(),
    ]
}

fn cosmology_cases(cases: &mut Cases) {
    let c = Cosmology::goliat();
    let members = [c.omega_m, c.omega_de, c.omega_r, c.omega_b, c.h, c.n_s, c.w0, c.wa, c.t_cmb];
    cases.add("cosmology_init", Hash::new().doubles(&members));
    let omega_r = radiation_density(2.7255, 3.046, 0.7).expect("radiation");
    cases.add("radiation_density", Hash::new().doubles(&[omega_r]));
    let times: Vec<f64> = (1..=20).map(|i| f64::from(i) / 16.0).collect();
    let expansion = times.iter().map(|&a| full().expansion(a).expect("E(a)"));
    cases.add("expansion", Hash::new().doubles(&expansion.collect::<Vec<_>>()));
    let mut growth = vec![Growth::default(); times.len()];
    growth_many(&full(), &times, &mut growth).expect("growth");
    let members = |g: &Growth| [g.d, g.f, g.d2, g.f2, g.d3a, g.f3a, g.d3b, g.f3b, g.d3c, g.f3c];
    let growth = growth.iter().fold(Hash::new(), |hash, g| hash.doubles(&members(g)));
    cases.add("growth_factors", growth);
    cases.add("growth_suppression", Hash::new().doubles(&[g_ratio(&full()).expect("g")]));
    let [k, power, transfer] = rows();
    for (i, linear) in linears(&c, &k, &power, &transfer).into_iter().enumerate() {
        let of = |redshift: f64, convention| {
            Poisson::new(&c, linear, 1.0 / (1.0 + redshift), convention).expect("a spectrum")
        };
        let (then, start) = (of(1.0, Convention::Cmb), of(32.0, Convention::Cmb));
        let late = of(32.0, Convention::Lss);
        let waves = || (0..30).map(|i| 0.0004 * f64::from(i * i + 1));
        let mut values: Vec<f64> = waves().map(|k| then.density_power(k).expect("P")).collect();
        values.extend(waves().map(|k| linear.transfer(k).expect("T")));
        values.push(linear.sigma(5.0).expect("sigma"));
        values.extend(waves().map(|k| start.alpha(k).expect("alpha")));
        values.extend(waves().map(|k| late.alpha(k).expect("alpha")));
        cases.add(&format!("linear.{i}"), Hash::new().doubles(&values));
    }
    let length = mode_table_length(N).expect("a length");
    cases.add("mode_table_length", Hash::new().integers(&[length as u64]));
    let [amplitude, alpha] = mode_tables();
    cases.add("potential_amplitude_table", Hash::new().doubles(&amplitude));
    cases.add("alpha_table", Hash::new().doubles(&alpha));
}

/// Every source with every normalisation that it may have, more or less; in the order of the programs.
fn linears<'a>(c: &Cosmology, k: &'a [f64], power: &'a [f64], transfer: &'a [f64]) -> Vec<Linear<'a>> {
    let from_power = || Linear::from_power(Table::new(k, power).expect("rows"), c.n_s).expect("a spectrum");
    let from_transfer = |amplitude| {
        Linear::from_transfer(Table::new(k, transfer).expect("rows"), c.n_s, amplitude).expect("a spectrum")
    };
    let fit = |wiggles, amplitude| {
        let fit = EisensteinHu::new(c, wiggles).expect("a fit");
        Linear::from_eisenstein_hu(fit, c.n_s, amplitude).expect("a spectrum")
    };
    let primordial = primordial_amplitude(c, 2e-9, 0.05).expect("an amplitude");
    vec![
        from_power(),
        from_power().with_sigma8(0.8).expect("a spectrum"),
        from_power().with_amplitude(1e6).expect("a spectrum"),
        from_transfer(1.0).with_sigma8(0.8).expect("a spectrum"),
        from_transfer(1e6),
        from_transfer(primordial),
        fit(Wiggles::With, 1.0).with_sigma8(0.8).expect("a spectrum"),
        fit(Wiggles::Without, primordial),
    ]
}

/// The spectrum that fixpair_conditions_init gives.
pub(crate) fn default_linear() -> Linear<'static> {
    let c = Cosmology::goliat();
    let fit = EisensteinHu::new(&c, Wiggles::With).expect("a fit");
    Linear::from_eisenstein_hu(fit, c.n_s, 1.0)
        .and_then(|linear| linear.with_sigma8(0.8))
        .expect("a spectrum")
}

/// sqrt(P_Phi/V), and alpha at z = 32, by |n|^2.
pub(crate) fn mode_tables() -> [Vec<f64>; 2] {
    let poisson =
        Poisson::new(&Cosmology::goliat(), default_linear(), 1.0 / 33.0, Convention::Cmb).expect("alpha");
    let mut tables = [(); 2].map(|()| vec![0.0; mode_table_length(N).expect("a length")]);
    potential_amplitude_table(&Serial, &poisson, N, BOX, &mut tables[0]).expect("a table");
    alpha_table(&Serial, &poisson, N, BOX, &mut tables[1]).expect("a table");
    tables
}
