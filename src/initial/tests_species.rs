//! Claims about species in the one call: matched, in the ratio of their columns, and a single fluid where they are one.

use std::vec;
use std::vec::Vec;

use super::conditions::{InitialConditions, Order, initial_conditions, initial_conditions_scratch};
use super::particles::Components;
use super::png::Local;
use super::shape::Shape;
use crate::cosmology::{Convention, Cosmology, EisensteinHu, Linear, Species, Table, Wiggles};
use crate::exec::{Exec, Serial, Threads};
use crate::fft::Fft3;
use crate::mesh::Brick;
use crate::noise::{Amplitude, Realisation};
use crate::reference::built::{memory, serial};

const BOX: f64 = 400.0;
const N: usize = 12;
const ORDERS: [Order; 3] = [Order::First, Order::Second, Order::Third];

pub(super) fn conditions(order: Order, species: Option<Species<'_>>) -> InitialConditions<'_> {
    let cosmology = Cosmology::goliat();
    let fit = EisensteinHu::new(&cosmology, Wiggles::With).unwrap();
    let linear = Linear::from_eisenstein_hu(fit, cosmology.n_s, 1.0).unwrap();
    InitialConditions {
        realisation: Realisation { amplitude: Amplitude::Fixed, ..Realisation::new(17) },
        cosmology,
        linear: linear.with_sigma8(0.8).unwrap(),
        redshift: 32.0,
        box_size: BOX,
        local: Local::default(),
        shape: Shape::Local.rows(),
        species,
        convention: Convention::Cmb,
        order,
    }
}

/// Displacements from the lattice, and velocities.
pub(super) fn moved(conditions: &InitialConditions<'_>, exec: &dyn Exec) -> [Vec<f64>; 2] {
    // Of 3/2 the side, so that the second order is the third's, without aliasing.
    let (mut fft, mut fine) = (serial::<f64>(N), serial::<f64>(3 * N / 2));
    let (mut x, mut v) = (vec![0.0; 3 * N * N * N], vec![0.0; 3 * N * N * N]);
    let scratch = memory(initial_conditions_scratch(conditions.parts(), &fft, Some(&fine)).unwrap());
    let position = &mut Components::triples(&mut x).unwrap();
    let velocity = &mut Components::triples(&mut v).unwrap();
    initial_conditions(position, velocity, conditions, &mut fft, Some(&mut fine), scratch, exec).unwrap();
    for (i, x) in x.iter_mut().enumerate() {
        let lattice = [i / 3 / (N * N), i / 3 / N % N, i / 3 % N][i % 3] as f64 * BOX / N as f64;
        *x -= lattice;
        *x -= BOX * libm::round(*x / BOX);
    }
    [x, v]
}

/// Largest difference over the largest value.
fn apart(a: &[f64], b: &[f64]) -> f64 {
    let size = a.iter().fold(0.0_f64, |size, a| size.max(a.abs()));
    a.iter().zip(b).fold(0.0_f64, |worst, (a, b)| worst.max((a - b).abs())) / size
}

/// Minus the divergence of a field on the lattice, as modes: (mode, i n . field), without Nyquist modes.
fn divergence(triples: &[f64]) -> Vec<([i64; 3], [f64; 2])> {
    let mut fft = serial::<f64>(N);
    let (cells, modes) = (*fft.configuration(), *fft.fourier());
    let mut out: Vec<([i64; 3], [f64; 2])> = vec![];
    for axis in 0..3 {
        let mut data = vec![0.0; fft.length()];
        let stride = cells.stride();
        for at in 0..N * N * N {
            let place = at / (N * N) * stride[0] + at / N % N * stride[1] + at % N * stride[2];
            data[place] = triples[3 * at + axis] / (N * N * N) as f64;
        }
        fft.forward(&mut data).unwrap();
        let (count, stride) = (modes.count(), modes.stride());
        let mut m = 0;
        for at in 0..modes.elements() {
            let index = [at / (count[1] * count[2]), at / count[2] % count[1], at % count[2]];
            if index.contains(&(N / 2)) || at == 0 {
                continue;
            }
            let place = 2 * (index[0] * stride[0] + index[1] * stride[1] + index[2] * stride[2]);
            let mode = index.map(|i| Brick::mode(N, i));
            let k = mode[axis] as f64;
            if axis == 0 {
                out.push((mode, [0.0; 2]));
            }
            out[m].1[0] += k * data[place + 1];
            out[m].1[1] -= k * data[place];
            m += 1;
        }
    }
    out
}

/// Columns of smooth functions over wavenumbers that span the mesh's.
struct Columns {
    k: Vec<f64>,
    matter: Vec<f64>,
    cold: Vec<f64>,
    baryon: Vec<f64>,
    v_cold: Vec<f64>,
    v_baryon: Vec<f64>,
}

/// Part of the matter that is baryons.
const BARYONS: f64 = 0.2;

impl Columns {
    /// Power laws: what lies between the rows is exact.
    fn new() -> Self {
        let k: Vec<f64> = (0..30).map(|i| 1e-3 * 1.4_f64.powi(i)).collect();
        let law = |amplitude: f64, slope: f64| k.iter().map(|k| amplitude * k.powf(slope)).collect();
        let matter = law(1.0, -1.0);
        // One slope for all, so that the weighted sum of the two is a power law too.
        let (cold, baryon) = (law(1.05, -1.0), law(0.8, -1.0));
        let (v_cold, v_baryon) = (law(0.97, -1.1), law(0.9, -0.8));
        Self { k, matter, cold, baryon, v_cold, v_baryon }
    }

    fn cold(&self) -> Species<'_> {
        Species::new(&self.k, &self.matter, &self.cold, &self.v_cold, None).unwrap()
    }

    fn baryon(&self) -> Species<'_> {
        Species::new(&self.k, &self.matter, &self.baryon, &self.v_baryon, None).unwrap()
    }
}

#[test]
fn a_species_that_grows_as_matter_does_is_the_single_fluid() {
    let f = conditions(Order::First, None).motion().unwrap().rates[0];
    let Columns { k, matter, .. } = Columns::new();
    let velocity: Vec<f64> = matter.iter().map(|t| f * t).collect();
    let species = Species::new(&k, &matter, &matter, &velocity, None).unwrap();
    for order in ORDERS {
        let fluid = moved(&conditions(order, None), &Serial);
        let found = moved(&conditions(order, Some(species)), &Serial);
        for (fluid, found) in fluid.iter().zip(&found) {
            // Displacements are differences of positions of order 400 that are 1e-3 of it, so that 1e-13 of them is rounding.
            assert!(apart(fluid, found) < 1e-12, "{order:?} {}", apart(fluid, found));
        }
    }
}

#[test]
fn species_of_one_noise_are_matched_in_the_ratio_of_their_columns() {
    let columns = Columns::new();
    let one = |species| moved(&conditions(Order::First, Some(species)), &Serial);
    let [fluid, _] = moved(&conditions(Order::First, None), &Serial);
    let ([x_c, v_c], [x_b, v_b]) = (one(columns.cold()), one(columns.baryon()));
    let modes = [&fluid, &x_c, &x_b, &v_c, &v_b].map(|field| divergence(field));
    let unit = core::f64::consts::TAU / BOX;
    let velocity = conditions(Order::First, None).motion().unwrap().velocity;
    let size = modes[0].iter().fold(0.0_f64, |m, (_, v)| m.max(v[0].abs()));
    for (i, (mode, total)) in modes[0].iter().enumerate() {
        let k = unit * mode.iter().map(|m| (m * m) as f64).sum::<f64>().sqrt();
        let expected = [1.05, 0.8, velocity * 0.97 * k.powf(-0.1), velocity * 0.9 * k.powf(0.2)];
        for (field, factor) in modes[1..].iter().zip(expected) {
            for part in 0..2 {
                // Same phase, and the modulus in the ratio of the columns; rounding of positions as above.
                let off = field[i].1[part] / factor - total[part];
                assert!(off.abs() < 1e-11 * size, "{mode:?} {off}");
            }
        }
    }
}

#[test]
fn species_weighted_by_their_densities_are_total_matter() {
    let columns = Columns::new();
    // (1 - f_b) 1.05 + f_b 0.8 = 1.
    let fluid = moved(&conditions(Order::Third, None), &Serial);
    let one = |species| moved(&conditions(Order::Third, Some(species)), &Serial);
    let (cold, baryon) = (one(columns.cold()), one(columns.baryon()));
    let total: Vec<f64> =
        cold[0].iter().zip(&baryon[0]).map(|(c, b)| (1.0 - BARYONS) * c + BARYONS * b).collect();
    assert!(apart(&fluid[0], &total) < 1e-12, "{}", apart(&fluid[0], &total));
}

#[test]
fn higher_orders_of_a_species_are_those_of_total_matter() {
    let columns = Columns::new();
    let difference = |a: &[Vec<f64>; 2], b: &[Vec<f64>; 2]| -> [Vec<f64>; 2] {
        [0, 1].map(|i| a[i].iter().zip(&b[i]).map(|(a, b)| a - b).collect())
    };
    for order in [Order::Second, Order::Third] {
        let higher = |species: Option<Species<'_>>| {
            let first = moved(&conditions(Order::First, species), &Serial);
            difference(&moved(&conditions(order, species), &Serial), &first)
        };
        let (fluid, cold) = (higher(None), higher(Some(columns.cold())));
        for (fluid, cold) in fluid.iter().zip(&cold) {
            // The higher orders are some 1e-2 of the first.
            assert!(apart(fluid, cold) < 1e-9, "{order:?} {}", apart(fluid, cold));
        }
    }
}

#[test]
fn the_bits_of_a_species_do_not_depend_on_threads() {
    let columns = Columns::new();
    for order in ORDERS {
        let conditions = conditions(order, Some(columns.cold()));
        let one = moved(&conditions, &Serial);
        for threads in [2, 5] {
            assert_eq!(one, moved(&conditions, &Threads::new(threads).unwrap()), "{order:?}");
        }
    }
}

/// Columns of the file of CAMB's species, and k, T(0), P(0), P(1), P(32) of its linear spectrum.
fn file(text: &str) -> Vec<Vec<f64>> {
    let rows: Vec<Vec<f64>> = text
        .lines()
        .filter(|line| !line.starts_with('#'))
        .map(|line| line.split_whitespace().map(|word| word.parse().unwrap()).collect())
        .collect();
    (0..rows[0].len()).map(|column| rows.iter().map(|row| row[column]).collect()).collect()
}

#[test]
fn with_a_reference_the_power_at_the_start_is_the_boltzmann_code_s_own() {
    let linear = file(include_str!("../../examples/data/camb_goliat_linear.txt"));
    let species = file(include_str!("../../examples/data/camb_goliat_species.txt"));
    let [k, matter, _, _, _, _, today] = core::array::from_fn(|i| species[i].as_slice());
    // Growth of the background alone, without radiation even: the columns repair it.
    let d = conditions(Order::First, None).poisson().unwrap().growth().d;
    let reference: Vec<f64> = today.iter().map(|t| d * t).collect();
    let whole = Species::new(k, matter, matter, matter, Some(&reference)).unwrap();
    let conditions = InitialConditions {
        linear: Linear::from_power(Table::new(&linear[0], &linear[2]).unwrap(), 0.96).unwrap(),
        box_size: 2000.0,
        ..conditions(Order::First, Some(whole))
    };
    let mut fft = serial::<f64>(N);
    let scratch = memory(initial_conditions_scratch(conditions.parts(), &fft, None).unwrap());
    let (mut x, mut v) = (vec![0.0; 3 * N * N * N], vec![0.0; 3 * N * N * N]);
    let position = &mut Components::triples(&mut x).unwrap();
    let velocity = &mut Components::triples(&mut v).unwrap();
    initial_conditions(position, velocity, &conditions, &mut fft, None, scratch, &Serial).unwrap();
    // V = T, so velocities are a H times displacements, and have no lattice to lose digits against.
    let speed = conditions.motion().unwrap().velocity;
    let unit = core::f64::consts::TAU / conditions.box_size;
    let volume = conditions.box_size.powi(3);
    let own = |k: f64| {
        let row = linear[0].partition_point(|&row| row <= k) - 1;
        let t = (k / linear[0][row]).ln() / (linear[0][row + 1] / linear[0][row]).ln();
        (linear[4][row].ln() * (1.0 - t) + linear[4][row + 1].ln() * t).exp()
    };
    let mut plain: f64 = 0.0;
    for (mode, value) in divergence(&v) {
        let k = unit * mode.iter().map(|m| (m * m) as f64).sum::<f64>().sqrt();
        let power = (value[0] * value[0] + value[1] * value[1]) * (unit / speed).powi(2) * volume;
        let today = own_today(&linear, k) * d * d;
        plain = plain.max((today / own(k) - 1.0).abs());
        // What 88 rows leave between them where the ratio changes by 1%, and straight lines between the rows of P.
        assert!((power / own(k) - 1.0).abs() < 1e-3, "{k}: {}", power / own(k));
    }
    // Scaled back with the background's growth it is not: the radiation that it lacks makes 1% in power.
    assert!(plain > 0.01, "{plain}");
}

fn own_today(linear: &[Vec<f64>], k: f64) -> f64 {
    let row = linear[0].partition_point(|&row| row <= k) - 1;
    let t = (k / linear[0][row]).ln() / (linear[0][row + 1] / linear[0][row]).ln();
    (linear[2][row].ln() * (1.0 - t) + linear[2][row + 1].ln() * t).exp()
}
