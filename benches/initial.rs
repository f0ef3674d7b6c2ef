//! Initial conditions from seed to particles, and their stages.
//!
//! `whole/...`: one call, 2LPT, f_NL = 100, products aliasing or dealiased on a mesh of 3/2 the side. `stage/...`: what it is made of.
//! n = 128 and 256; 512 too where FIXPAIR_BENCH_LARGE is set. Throughput is in cells.
//!
//! Peers (whole programs, one core, CPU seconds, start-up and output included): 2LPTPNG at 256^3, f64, local f_NL: 11.8;
//! monofonIC, dealiased: 27.9 in f64 and 21.2 in f32. Memory: 122 bytes a cell for 2LPTPNG; the bench prints ours.

use std::hint::black_box;
use std::time::Duration;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use fixpair::cosmology::{
    Convention, Cosmology, EisensteinHu, Linear, Wiggles, alpha_table, mode_table_length, potential_amplitude_table,
};
use fixpair::exec::{Exec, Serial, Threads};
use fixpair::fft::{Fft3, Tables, Transform, next_side, recommended_padding};
use fixpair::initial::conditions::{InitialConditions, Order, initial_conditions, initial_conditions_scratch};
use fixpair::initial::lpt::displacement;
use fixpair::initial::modes::{copy_modes, scale_by_table};
use fixpair::initial::particles::{Components, Step, displace};
use fixpair::initial::png::Local;
use fixpair::mesh::{Brick, Space};
use fixpair::noise::{Realisation, white_modes_coloured};
use fixpair::real::Real;
use fixpair::scratch::Layout;

/// Memory aligned to 64 bytes.
struct Memory(Vec<[u64; 8]>);

#[repr(align(64))]
#[derive(Clone, Copy)]
struct Line([u64; 8]);

struct Aligned(Vec<Line>, usize);

impl Aligned {
    fn new(layout: Layout) -> Self {
        Self(vec![Line([0; 8]); layout.size.div_ceil(64)], layout.size)
    }

    fn bytes(&mut self) -> &mut [u8] {
        // SAFETY: any number may be read and written as bytes, and the lines hold at least that many.
        unsafe { std::slice::from_raw_parts_mut(self.0.as_mut_ptr().cast(), self.1) }
    }
}
