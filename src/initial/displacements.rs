//! From the modes of the linear density to displacements of first, second or third order.
//!
//! Two fields carry all orders: x = q + first + second, v = a H (f1 first + f2 second). A displacement of another growth rate f is divided between
//! them, (f - f1)/(f2 - f1) of it in the second, so that both its place and its velocity are right.

use super::lpt::{InverseGradient, second_order_products, second_order_squares};
use super::modes::{ByTable, Factor, add_modes, map_modes, scale_by_table};
use super::particles::Step;
use super::realise::apart;
use super::shifted::half_cells_length;
use super::third::{THIRD_ORDER_MESHES, add_transverse, second_order_exact, third_order_sources};
use crate::exec::Exec;
use crate::fft::Fft3;
use crate::mesh::Brick;
use crate::real::Real;
use crate::status::{Error, Result};
use crate::walk::walk;
use crate::within::Within;

/// Order of the displacements.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(i32)]
pub enum Order {
    /// Zel'dovich.
    First = 1,
    /// 2LPT.
    #[default]
    Second = 2,
    /// 3LPT, with products that never alias.
    Third = 3,
}

impl TryFrom<i32> for Order {
    type Error = Error;

    /// `Choice` for any number but 1, 2 and 3.
    fn try_from(number: i32) -> Result<Self> {
        let orders = [Self::First, Self::Second, Self::Third];
        orders.into_iter().find(|&order| order as i32 == number).ok_or(Error::Choice)
    }
}

/// How the density moves particles: everything that depends on the cosmology and the starting time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion {
    /// Side of the box.
    pub box_size: f64,
    /// a H: velocity over displacement where f = 1.
    pub velocity: f64,
    /// f1, f2.
    pub rates: [f64; 2],
    /// D2/D^2, near -3/7.
    pub second_order: f64,
    /// D3a/D^3, D3b/D^3, D3c/D^3, near -1/3, 5/21, 1/7.
    pub third_order: [f64; 3],
    /// f3a, f3b, f3c.
    pub third_rates: [f64; 3],
}

impl Motion {
    /// Velocities over the two fields.
    ///
    /// ```
    /// use fixpair::initial::displacements::Motion;
    ///
    /// let motion = Motion {
    ///     box_size: 1000.0,
    ///     velocity: 100.0, // a H
    ///     rates: [1.0, 2.0],
    ///     second_order: -3.0 / 7.0,
    ///     third_order: [0.0; 3],
    ///     third_rates: [3.0; 3],
    /// };
    /// assert_eq!((motion.step().first_velocity, motion.step().second_velocity), (100.0, 200.0));
    /// ```
    #[must_use]
    pub fn step(&self) -> Step {
        let [first_velocity, second_velocity] = self.rates.map(|rate| self.velocity * rate);
        Step { box_size: self.box_size, first_velocity, second_velocity }
    }

    /// What of a displacement with this rate goes into each of the two fields.
    fn shares(&self, rate: f64) -> [f64; 2] {
        let second = (rate - self.rates[0]) / (self.rates[1] - self.rates[0]);
        [1.0 - second, second]
    }

    fn check(&self, two_fields: bool) -> Result<()> {
        let numbers = [self.box_size, self.velocity, self.second_order];
        if numbers.into_iter().chain(self.third_order).any(|x| !x.is_finite()) {
            return Err(Error::NotFinite);
        }
        let mut shares = self.third_rates.iter().flat_map(|&rate| self.shares(rate));
        let told_apart = shares.all(f64::is_finite) && self.second_order != 0.0;
        if told_apart || !two_fields { Ok(()) } else { Err(Error::Range) }
    }
}

/// First order of one species: what each of the two fields holds of it, over the density of total matter, by integer |n|^2.
#[derive(Clone, Copy, Debug)]
pub struct FirstOrder<'a> {
    first: &'a [f64],
    second: &'a [f64],
}

impl<'a> FirstOrder<'a> {
    /// From T_s/T_m and V_s/T_m (see [`crate::cosmology::species`]), which are overwritten.
    ///
    /// # Example
    /// ```
    /// use fixpair::initial::displacements::{FirstOrder, Motion};
    /// # let motion = Motion {
    /// #     box_size: 1.0, velocity: 1.0, rates: [1.0, 2.0], second_order: -3.0 / 7.0, third_order: [0.0; 3], third_rates: [3.0; 3],
    /// # };
    ///
    /// let (mut density, mut velocity) = ([1.0; 4], [1.0; 4]); // a species like matter, in a universe of f1 = 1
    /// let _ = FirstOrder::new(&mut density, &mut velocity, &motion);
    /// assert_eq!((density, velocity), ([1.0; 4], [0.0; 4])); // all of it is in the first field
    /// ```
    pub fn new(density: &'a mut [f64], velocity: &'a mut [f64], motion: &Motion) -> Self {
        let [f1, f2] = motion.rates;
        for (density, velocity) in density.iter_mut().zip(velocity.iter_mut()) {
            *velocity = (*velocity - f1 * *density) / (f2 - f1);
            *density -= *velocity;
        }
        Self { first: density, second: velocity }
    }
}

/// Arrays that are overwritten on the way to displacements.
pub struct Work<'a, T> {
    /// As long as `fine`, else `fft`, asks.
    pub source: &'a mut [T],
    /// [`rest_length`] reals.
    pub rest: &'a mut [T],
    /// [`table_length`] entries.
    pub table: &'a mut [[f64; 2]],
}

/// Meshes of the sources of the third order.
const SOURCES: usize = 5;

/// Reals of `rest` in [`Work`]: at first order none, or two meshes for a species; at second two, or one of `fine` if that is more; at third 17.
///
/// ```
/// # use fixpair::{exec::Serial, fft::{Tables, Transform}, mesh::{Brick, Space}};
/// # #[repr(align(64))] struct Memory([u8; 1 << 16]);
/// # let (mut tables, mut work) = (Memory([0; 1 << 16]), Memory([0; 1 << 16]));
/// # let tables = Tables::<f64>::new(8, &mut tables.0)?;
/// # let mut fft = Transform::new(&tables, Brick::whole(8, Space::Configuration)?, &mut work.0, &Serial)?;
/// use fixpair::initial::displacements::{Order, rest_length};
///
/// assert!(rest_length::<f64>(Order::Second, false, &fft, None) >= rest_length::<f64>(Order::First, false, &fft, None));
/// # Ok::<(), fixpair::status::Error>(())
/// ```
#[must_use]
pub fn rest_length<T: Real>(
    order: Order,
    species: bool,
    fft: &dyn Fft3<T>,
    fine: Option<&(dyn Fft3<T> + '_)>,
) -> usize {
    match order {
        Order::First => {
            if species {
                2 * apart(fft)
            } else {
                0
            }
        }
        Order::Second => (2 * apart(fft)).max(fine.map_or(0, Fft3::length)),
        Order::Third => (SOURCES + THIRD_ORDER_MESHES) * apart(fft),
    }
}

/// Entries of `table` in [`Work`]: N/2 + 1 at third order.
///
/// ```
/// use fixpair::initial::displacements::{Order, table_length};
///
/// assert!(table_length(Order::Third, 8) > table_length(Order::Second, 8)); // half cells
/// ```
#[must_use]
pub const fn table_length(order: Order, n: usize) -> usize {
    if matches!(order, Order::Third) { half_cells_length(n) } else { 0 }
}

/// Takes one component of the two fields, each on the cells of the mesh.
pub type Place<'a, T> = dyn FnMut(usize, &[T], Option<&[T]>) -> Result<()> + 'a;

/// Displacements from the modes of the linear density, one axis after the other, each handed to `place`.
///
/// `density`: modes of total matter on the Fourier brick of `fft`; changed by a species and at third order. `fine`: a transform of
/// side 3N/2 or more for products of the second order without aliasing; not used at third order, whose products never alias.
///
/// # Errors
/// `Length` for short arrays, `NotFinite` for the motion, `Range` where its two fields cannot be told apart (f1 = f2, or D2 = 0), or what `fft`, `exec` and `place` return. Where `place`
/// fails the rest is done all the same, for transforms may be collective.
///
/// Cost: 3 transforms at first order, 6 with a species or of higher order, and for the sources at second order 7, or 8 of `fine`; at third 192.
///
/// # Example
/// ```
/// # use fixpair::{exec::Serial, fft::{Fft3, Tables, Transform}, mesh::{Brick, Space}};
/// # #[repr(align(64))] struct Memory([u8; 1 << 16]);
/// # let (mut tables, mut work) = (Memory([0; 1 << 16]), Memory([0; 1 << 16]));
/// # let tables = Tables::<f64>::new(8, &mut tables.0)?;
/// # let mut fft = Transform::new(&tables, Brick::whole(8, Space::Configuration)?, &mut work.0, &Serial)?;
/// use fixpair::initial::displacements::{Motion, Order, Work, displacements};
///
/// let mut delta = vec![0.0; fft.length()];
/// delta[2] = 0.01; // the mode (0, 0, 1) and its conjugate: delta(z) = 0.02 cos(2 pi z/L)
/// let rates = ([1.0, 2.0], [3.0; 3]); // of an Einstein-de Sitter universe
/// let third_order = [-1.0 / 3.0, 5.0 / 21.0, 1.0 / 7.0];
/// let motion =
///     Motion { box_size: 1.0, velocity: 1.0, rates: rates.0, second_order: -3.0 / 7.0, third_order, third_rates: rates.1 };
/// let (mut source, mut largest) = (vec![0.0; fft.length()], [0.0_f64; 3]);
/// let work = Work { source: &mut source, rest: &mut [], table: &mut [] };
/// let mut place = |axis: usize, first: &[f64], _: Option<&[f64]>| {
///     largest[axis] = first.iter().fold(0.0, |largest, psi| psi.abs().max(largest));
///     Ok(())
/// };
/// displacements(&mut delta, Order::First, &motion, None, &mut fft, None, work, &mut place, &Serial)?;
/// assert!(largest[0] == 0.0 && (largest[2] - 0.02 / std::f64::consts::TAU).abs() < 1e-12); // delta L/(2 pi)
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn displacements<T: Real>(
    density: &mut [T],
    order: Order,
    motion: &Motion,
    species: Option<&FirstOrder<'_>>,
    fft: &mut dyn Fft3<T>,
    fine: Option<&mut (dyn Fft3<T> + '_)>,
    work: Work<'_, T>,
    place: &mut Place<'_, T>,
    exec: &dyn Exec,
) -> Result<()> {
    motion.check(order != Order::First || species.is_some())?;
    let (modes, length) = (*fft.fourier(), fft.length());
    let long = rest_length(order, species.is_some(), fft, fine.as_deref());
    if work.rest.len() < long || work.source.len() < length || density.len() < length {
        return Err(Error::Length);
    }
    let unit = motion.box_size / core::f64::consts::TAU;
    if order == Order::Third {
        return third_order(density, motion, species, fft, work, place, exec);
    }
    let Work { source, rest, .. } = work;
    if order == Order::First && species.is_none() {
        let fields = Fields { first: density, second: None, curl: None, unit };
        return fields.place([&mut source[..length], &mut []], fft, place, exec);
    }
    // The second field lacks a factor yet: the products were left un-normalised, and their 1/m^3 is folded in there.
    let (brick, scale) = if order == Order::First {
        source.fill(T::ZERO);
        (modes, unit)
    } else {
        let brick = second_order(source, rest, density, fft, fine, exec)?;
        let m = brick.n() as f64;
        (brick, -motion.second_order * unit / (m * m * m))
    };
    if let Some(species) = species {
        let share = Share { table: ByTable(species.second), scale: unit / scale };
        add_modes(source, &brick, density, &modes, &share, exec)?;
        scale_by_table(density, &modes, species.first, exec)?;
    }
    let fields = Fields { first: density, second: Some((source, &brick, scale)), curl: None, unit };
    fields.place(two_meshes(rest, length, apart(fft)), fft, place, exec)
}

fn two_meshes<T>(rest: &mut [T], length: usize, apart: usize) -> [&mut [T]; 2] {
    let (one, two) = rest.split_at_mut_checked(apart).unwrap_or_default();
    [one.part_mut(..length), two.part_mut(..length)]
}

/// S, un-normalised, in `source`; returns where its modes lie.
fn second_order<T: Real>(
    source: &mut [T],
    rest: &mut [T],
    density: &[T],
    fft: &mut dyn Fft3<T>,
    fine: Option<&mut (dyn Fft3<T> + '_)>,
    exec: &dyn Exec,
) -> Result<Brick> {
    let (modes, apart) = (*fft.fourier(), apart(fft));
    if let Some(fine) = fine {
        second_order_squares(density, &modes, fine, [source, rest], exec)?;
        return Ok(*fine.fourier());
    }
    let (a, b) = rest.split_at_mut_checked(apart).ok_or(Error::Length)?;
    second_order_products(density, &modes, fft, [source, a, b], exec)?;
    Ok(modes)
}

fn third_order<T: Real>(
    density: &mut [T],
    motion: &Motion,
    species: Option<&FirstOrder<'_>>,
    fft: &mut dyn Fft3<T>,
    work: Work<'_, T>,
    place: &mut Place<'_, T>,
    exec: &dyn Exec,
) -> Result<()> {
    let (modes, length, apart) = (*fft.fourier(), fft.length(), apart(fft));
    let Work { source, rest, table } = work;
    let second = source.part_mut(..length);
    let (sources, meshes) = rest.split_at_mut_checked(SOURCES * apart).ok_or(Error::Length)?;
    let mut sources = pieces::<T, SOURCES>(sources, length, apart)?;
    let [a, b, c, d, e, f, ..] = pieces::<T, THIRD_ORDER_MESHES>(meshes, length, apart)?;
    second_order_exact(second, density, fft, [a, b, c, d, e, f], table, exec)?;
    let out = sources.each_mut().map(|mesh| &mut **mesh);
    let twelve = pieces(meshes, length, apart)?;
    third_order_sources(out, density, second, fft, twelve, table, exec)?;

    let [det, mixed, curl @ ..] = sources.each_ref().map(|mesh| &**mesh);
    let [d3a, d3b, d3c] = motion.third_order;
    let [a, b, c] = motion.third_rates.map(|rate| motion.shares(rate));
    combine(second, -motion.second_order, [det, mixed], [d3a * a[1], d3b * b[1]], &modes, exec)?;
    if let Some(species) = species {
        let share = Share { table: ByTable(species.second), scale: 1.0 };
        add_modes(second, &modes, density, &modes, &share, exec)?;
        scale_by_table(density, &modes, species.first, exec)?;
    }
    combine(density, 1.0, [det, mixed], [d3a * a[0], d3b * b[0]], &modes, exec)?;
    let unit = motion.box_size / core::f64::consts::TAU;
    let curl = Some((curl, c.map(|share| d3c * unit * share)));
    let fields = Fields { first: density, second: Some((second, &modes, unit)), curl, unit };
    fields.place(two_meshes(meshes, length, apart), fft, place, exec)
}

/// `K` meshes of `length` reals that begin `apart` reals from each other.
fn pieces<T, const K: usize>(array: &mut [T], length: usize, apart: usize) -> Result<[&mut [T]; K]> {
    let mut meshes = array.chunks_mut(apart.max(1)).filter_map(|mesh| mesh.get_mut(..length));
    let mut short = false;
    let found = core::array::from_fn(|_| {
        meshes.next().unwrap_or_else(|| {
            short = true;
            Default::default()
        })
    });
    if short { Err(Error::Length) } else { Ok(found) }
}

/// to <- scale to + sum of weight term.
fn combine<T: Real>(
    to: &mut [T],
    scale: f64,
    terms: [&[T]; 2],
    weights: [f64; 2],
    brick: &Brick,
    exec: &dyn Exec,
) -> Result<()> {
    walk::<T, 1, 2>(exec, brick, [to], terms, &|_, [to], [one, two]| {
        for ((to, one), two) in to.iter_mut().zip(one).zip(two) {
            let sum = weights[0] * one.to_f64() + weights[1] * two.to_f64();
            *to = T::from_f64(scale * to.to_f64() + sum);
        }
    })
}

/// `scale` times a table by |n|^2.
struct Share<'a> {
    table: ByTable<'a>,
    scale: f64,
}

impl Factor for Share<'_> {
    const IMAGINARY: bool = false;

    #[inline(always)]
    fn at(&self, n: [f64; 3]) -> f64 {
        self.scale * self.table.at(n)
    }
}

/// The modes of the two fields: of their divergences, and of what is transverse.
struct Fields<'a, T> {
    /// On the Fourier brick of the transform; its factor is `unit`.
    first: &'a [T],
    /// On a brick of its own, with a factor of its own.
    second: Option<(&'a [T], &'a Brick, f64)>,
    /// C, and its factor in each of the two fields.
    curl: Option<([&'a [T]; 3], [f64; 2])>,
    unit: f64,
}

impl<T: Real> Fields<'_, T> {
    /// Component by component to cells, in `meshes`, and from there to `place`.
    fn place(
        &self,
        meshes: [&mut [T]; 2],
        fft: &mut dyn Fft3<T>,
        place: &mut Place<'_, T>,
        exec: &dyn Exec,
    ) -> Result<()> {
        let modes = *fft.fourier();
        let [one, two] = meshes;
        let mut outcome = Ok(());
        for axis in 0..3 {
            map_modes(one, &modes, self.first, &modes, &InverseGradient::new(axis, self.unit), exec)?;
            self.add_curl(one, 0, axis, &modes, exec)?;
            fft.inverse(one)?;
            if let Some((second, brick, scale)) = self.second {
                map_modes(two, &modes, second, brick, &InverseGradient::new(axis, scale), exec)?;
                self.add_curl(two, 1, axis, &modes, exec)?;
                fft.inverse(two)?;
            }
            let two = self.second.map(|_| &*two);
            outcome = outcome.and(place(axis, one, two));
        }
        outcome
    }

    /// i (n x C)_axis/|n|^2.
    fn add_curl(
        &self,
        to: &mut [T],
        field: usize,
        axis: usize,
        modes: &Brick,
        exec: &dyn Exec,
    ) -> Result<()> {
        self.curl.map_or(Ok(()), |(curl, scale)| add_transverse(to, curl, axis, scale[field], modes, exec))
    }
}
