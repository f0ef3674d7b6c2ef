//! A fixed pair with f_NL = 100, and its power spectrum: the Rust of docs/five-minutes.md.

use std::f64::consts::TAU;
use std::fmt::Write;

use fixpair::cosmology::{Convention, Cosmology, EisensteinHu, Linear, Wiggles};
use fixpair::estimate::binning::{Bin, Binning, normalise, read_sums};
use fixpair::estimate::compensation::Compensation;
use fixpair::estimate::edges::uniform_edges;
use fixpair::estimate::power::{power_sums, power_sums_scratch};
use fixpair::exec::Serial;
use fixpair::fft::{Fft3, Tables, Transform, recommended_padding};
use fixpair::initial::conditions::{
    InitialConditions, Order, initial_conditions, initial_conditions_scratch,
};
use fixpair::initial::particles::Components;
use fixpair::initial::png::Local;
use fixpair::initial::shape::Shape;
use fixpair::mesh::{Brick, Space};
use fixpair::noise::{Amplitude, Phase, Realisation};
use fixpair::pm::{Assignment, Positions, Region, Window, deposit, deposit_scratch};
use fixpair::scratch::Layout;
use fixpair::status::Result;
use fixpair::variance::pairs::pair_average;

const N: usize = 64;
const SHELLS: usize = 8;
const L: f64 = 1000.0; // Mpc/h

/// Room for what a layout asks for, and for its alignment.
fn take(layout: Layout) -> Vec<u8> {
    vec![0; layout.size + layout.align]
}

fn aligned(memory: &mut [u8]) -> &mut [u8] {
    let start = memory.as_ptr().align_offset(64);
    &mut memory[start..]
}

/// Initial conditions of one member of a pair, and their power spectrum.
fn universe(phase: Phase) -> Result<([Bin; SHELLS], [f64; SHELLS])> {
    let (mut tables, mut work) = (take(Tables::<f64>::layout(N)?), take(Transform::<f64>::workspace(N)?));
    let tables = Tables::<f64>::new(N, aligned(&mut tables))?;
    let cells = Brick::whole_padded(N, Space::Configuration, recommended_padding::<f64>(N))?;
    let mut fft = Transform::new(&tables, cells, aligned(&mut work), &Serial)?;

    let cosmology = Cosmology::goliat(); // the paper's
    let fit = EisensteinHu::new(&cosmology, Wiggles::With)?;
    let conditions = InitialConditions {
        realisation: Realisation { amplitude: Amplitude::Fixed, phase, ..Realisation::new(1) }, // the seed
        linear: Linear::from_eisenstein_hu(fit, cosmology.n_s, 1.0)?.with_sigma8(0.8)?,
        cosmology,
        redshift: 32.0,
        box_size: L,
        local: Local { f_nl: 100.0, g_nl: 0.0 },
        shape: Shape::Local.rows(),
        species: None,
        convention: Convention::Cmb,
        order: Order::Second,
    };
    let (mut x, mut v) = (vec![0.0; 3 * N * N * N], vec![0.0; 3 * N * N * N]);
    let (mut position, mut velocity) = (Components::triples(&mut x)?, Components::triples(&mut v)?);
    let mut scratch = take(initial_conditions_scratch(conditions.parts(), &fft, None)?);
    initial_conditions(
        &mut position,
        &mut velocity,
        &conditions,
        &mut fft,
        None,
        aligned(&mut scratch),
        &Serial,
    )?;

    let mut mesh = vec![0.0; fft.length()]; // deposits add to it
    let (at, region) = (Positions::triples(&x)?, Region::from_brick(&cells)?);
    let assignment = Assignment { box_size: L, window: Window::CloudInCell, shift: 0.0 };
    let mut scratch = take(deposit_scratch::<f64>(&region, at.len(), assignment.window)?);
    deposit(&mut mesh, &region, &at, None, &assignment, aligned(&mut scratch), &Serial)?;
    fft.forward(&mut mesh)?;

    let mut edges = [0; SHELLS + 1]; // of |n|^2, n = k L/(2 pi): shells one wide
    uniform_edges(&mut edges, 1.0, 1.0)?;
    let (binning, window) = (Binning::shells(&edges), Compensation::Window(assignment.window));
    let mut sums = vec![0; binning.words(1)?];
    let mut scratch = take(power_sums_scratch(fft.fourier(), &binning, 1)?);
    power_sums(
        &mut sums,
        &[&mesh],
        &[[0, 0]],
        &[window],
        fft.fourier(),
        &binning,
        aligned(&mut scratch),
        &Serial,
    )?;
    let (mut bins, mut power) = ([Bin::default(); SHELLS], [0.0; SHELLS]);
    read_sums(&mut bins, &mut power, &sums, &binning, 1)?;
    normalise(&mut power, &bins, binning.orders, L.powi(3) / (N as f64).powi(6))?;
    Ok((bins, power))
}

/// k, P of both members of the pair, and their average.
pub(crate) fn table() -> Result<String> {
    let (bins, original) = universe(Phase::Original)?;
    let (_, inverted) = universe(Phase::Inverted)?;
    let mut average = [0.0; SHELLS];
    pair_average(&mut average, &original, &inverted)?;
    let mut table = String::new();
    for b in 0..SHELLS {
        let k = TAU / L * bins[b].first;
        let _ = writeln!(table, "{k:.6} {:.6} {:.6} {:.6}", original[b], inverted[b], average[b]);
    }
    Ok(table)
}

fn main() -> Result<()> {
    print!("{}", table()?);
    Ok(())
}
