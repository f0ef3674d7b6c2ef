//! One call from a seed to particles.

pub use super::displacements::Order;
use super::displacements::{FirstOrder, Motion, Place, Work, displacements, rest_length, table_length};
use super::particles::{Components, displace};
use super::png::Local;
use super::realise::{Field, FieldWork, linear_density, shape_rest};
use super::shape::{Quadratic, ShapeRow};
use crate::cosmology::background::Cosmology;
use crate::cosmology::growth::Growth;
use crate::cosmology::mode_table::{alpha_table, mode_table_length, potential_amplitude_table};
use crate::cosmology::poisson::{Convention, Poisson};
use crate::cosmology::power::Linear;
use crate::cosmology::species::{Ratio, Species, species_table};
use crate::exec::Exec;
use crate::fft::Fft3;
use crate::noise::{Nyquist, Realisation};
use crate::real::Real;
use crate::scratch::{Arena, Layout};
use crate::status::{Error, Result};
use crate::walk::chunks;

/// A universe, and when and how large to start it.
#[derive(Clone, Copy, Debug)]
pub struct InitialConditions<'a> {
    /// Which realisation.
    pub realisation: Realisation,
    /// Background of the simulation that will run.
    pub cosmology: Cosmology,
    /// Linear spectrum of z = 0, scaled back with the growth of `cosmology`.
    pub linear: Linear<'a>,
    /// Redshift of the particles.
    pub redshift: f64,
    /// Side of the box in Mpc/h.
    pub box_size: f64,
    /// f_NL of `shape`, and local g_NL.
    pub local: Local,
    /// The kernel that f_NL multiplies: [`super::shape::Shape::rows`], or the caller's own.
    pub shape: &'a [ShapeRow],
    /// In which convention f_NL and g_NL are given.
    pub convention: Convention,
    /// 1LPT, 2LPT or 3LPT.
    pub order: Order,
    /// Which species the particles are; none for all matter as one.
    pub species: Option<Species<'a>>,
}

/// What of [`InitialConditions`] decides how much scratch they take.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Parts {
    /// 1LPT, 2LPT or 3LPT.
    pub order: Order,
    /// f_NL is local.
    pub local: bool,
    /// The particles are one species of several.
    pub species: bool,
}

impl From<Order> for Parts {
    /// Local f_NL, and all matter as one.
    fn from(order: Order) -> Self {
        Self { order, local: true, species: false }
    }
}

impl<'a> InitialConditions<'a> {
    /// What scratch depends on.
    ///
    /// ```
    /// use fixpair::cosmology::{Convention, Cosmology, EisensteinHu, Linear, Wiggles};
    /// use fixpair::initial::conditions::{InitialConditions, Order};
    /// use fixpair::initial::{png::Local, shape::Shape};
    /// use fixpair::noise::{Amplitude, Realisation};
    ///
    /// let cosmology = Cosmology::goliat();
    /// let fit = EisensteinHu::new(&cosmology, Wiggles::With)?;
    /// let conditions = InitialConditions {
    ///     realisation: Realisation { amplitude: Amplitude::Fixed, ..Realisation::new(1) },
    ///     linear: Linear::from_eisenstein_hu(fit, 0.96, 1.0)?.with_sigma8(0.8)?,
    ///     cosmology,
    ///     redshift: 32.0,
    ///     box_size: 1000.0,
    ///     local: Local { f_nl: 100.0, g_nl: 0.0 },
    ///     shape: Shape::Local.rows(),
    ///     species: None,
    ///     convention: Convention::Cmb,
    ///     order: Order::Second,
    /// };
    /// assert!(conditions.parts().local); // f_NL is not 0
    /// # Ok::<(), fixpair::status::Error>(())
    /// ```
    #[must_use]
    pub fn parts(&self) -> Parts {
        let local = ShapeRow::local(self.shape).is_some();
        Parts { order: self.order, local, species: self.species.is_some() }
    }

    /// Are there two fields of displacements, or one?
    pub(crate) fn has_second_field(&self) -> bool {
        self.order != Order::First || self.species.is_some()
    }

    fn check(&self) -> Result<()> {
        self.local.check()?;
        let quadratic = Quadratic { f_nl: self.local.f_nl, rows: self.shape, n_s: self.linear.n_s() };
        quadratic.check()?;
        if !self.redshift.is_finite() || !self.box_size.is_finite() {
            return Err(Error::NotFinite);
        }
        if self.redshift <= -1.0 || self.box_size <= 0.0 {
            return Err(Error::Range);
        }
        Ok(())
    }

    fn scale_factor(&self) -> f64 {
        1.0 / (1.0 + self.redshift)
    }

    /// alpha, P_Phi and growth at the starting time.
    ///
    /// # Errors
    /// `NotFinite` or `Range` for parameters out of range.
    ///
    /// # Example
    /// ```
    /// use fixpair::cosmology::{Convention, Cosmology, EisensteinHu, Linear, Wiggles};
    /// use fixpair::initial::conditions::{InitialConditions, Order};
    /// use fixpair::initial::{png::Local, shape::Shape};
    /// use fixpair::noise::{Amplitude, Realisation};
    ///
    /// let cosmology = Cosmology::goliat();
    /// let fit = EisensteinHu::new(&cosmology, Wiggles::With)?;
    /// let conditions = InitialConditions {
    ///     realisation: Realisation { amplitude: Amplitude::Fixed, ..Realisation::new(1) },
    ///     linear: Linear::from_eisenstein_hu(fit, 0.96, 1.0)?.with_sigma8(0.8)?,
    ///     cosmology,
    ///     redshift: 32.0,
    ///     box_size: 1000.0,
    ///     local: Local { f_nl: 100.0, g_nl: 0.0 },
    ///     shape: Shape::Local.rows(),
    ///     species: None,
    ///     convention: Convention::Cmb,
    ///     order: Order::Second,
    /// };
    /// assert!(conditions.poisson()?.alpha(0.01)? > 0.0); // at the redshift of the particles
    /// # Ok::<(), fixpair::status::Error>(())
    /// ```
    pub fn poisson(&self) -> Result<Poisson<'a>> {
        self.check()?;
        Poisson::new(&self.cosmology, self.linear, self.scale_factor(), self.convention)
    }

    /// What displacements and velocities take from the cosmology; in km/s per Mpc/h.
    ///
    /// # Errors
    /// As [`InitialConditions::poisson`].
    ///
    /// # Example
    /// ```
    /// use fixpair::cosmology::{Convention, Cosmology, EisensteinHu, Linear, Wiggles};
    /// use fixpair::initial::conditions::{InitialConditions, Order};
    /// use fixpair::initial::{png::Local, shape::Shape};
    /// use fixpair::noise::{Amplitude, Realisation};
    ///
    /// let cosmology = Cosmology::goliat();
    /// let fit = EisensteinHu::new(&cosmology, Wiggles::With)?;
    /// let conditions = InitialConditions {
    ///     realisation: Realisation { amplitude: Amplitude::Fixed, ..Realisation::new(1) },
    ///     linear: Linear::from_eisenstein_hu(fit, 0.96, 1.0)?.with_sigma8(0.8)?,
    ///     cosmology,
    ///     redshift: 32.0,
    ///     box_size: 1000.0,
    ///     local: Local { f_nl: 100.0, g_nl: 0.0 },
    ///     shape: Shape::Local.rows(),
    ///     species: None,
    ///     convention: Convention::Cmb,
    ///     order: Order::Second,
    /// };
    /// let motion = conditions.motion()?;
    /// assert_eq!(motion.box_size, 1000.0);
    /// assert!(motion.velocity > 0.0);
    /// # Ok::<(), fixpair::status::Error>(())
    /// ```
    pub fn motion(&self) -> Result<Motion> {
        self.start().map(|(_, motion)| motion)
    }

    /// Both of the above, by one integration of growth.
    pub(crate) fn start(&self) -> Result<(Poisson<'a>, Motion)> {
        let poisson = self.poisson()?;
        let motion = self.motion_of(poisson.growth())?;
        Ok((poisson, motion))
    }

    fn motion_of(&self, growth: Growth) -> Result<Motion> {
        let a = self.scale_factor();
        let hubble = 100.0 * self.cosmology.expansion(a)?;
        let Growth { d, f, d2, f2, d3a, f3a, d3b, f3b, d3c, f3c } = growth;
        Ok(Motion {
            box_size: self.box_size,
            velocity: a * hubble,
            rates: [f, f2],
            second_order: d2 / (d * d),
            third_order: [d3a, d3b, d3c].map(|d3| d3 / (d * d * d)),
            third_rates: [f3a, f3b, f3c],
        })
    }
}

/// Lengths of the arrays in scratch, in the order in which they lie there.
struct Sizes {
    tables: [usize; 5],
    half_cells: usize,
    partial: usize,
    density: usize,
    mesh: usize,
    rest: usize,
}

impl Sizes {
    fn new<T: Real>(parts: Parts, fft: &dyn Fft3<T>, fine: Option<&(dyn Fft3<T> + '_)>) -> Result<Self> {
        let Parts { order, local, species } = parts;
        let (n, work) = (fft.configuration().n(), fine.unwrap_or(fft));
        let table = mode_table_length(n)?;
        let [of_shape, of_species] = [!local, species].map(|there| if there { table } else { 0 });
        let for_shape = if local { 0 } else { shape_rest(fft, work) };
        Ok(Self {
            tables: [table, table, of_shape, of_species, of_species],
            half_cells: table_length(order, n),
            partial: chunks(work.configuration()),
            density: fft.length(),
            mesh: work.length().max(fft.length()),
            rest: rest_length(order, species, fft, fine).max(for_shape),
        })
    }

    fn layout<T: Real>(&self) -> Result<Layout> {
        let tables = self.tables.iter().try_fold(Layout::EMPTY, |layout, &table| layout.and::<f64>(table))?;
        tables
            .and::<[f64; 2]>(self.half_cells)?
            .and::<[f64; 1]>(self.partial)?
            .and::<T>(self.density)?
            .and::<T>(self.mesh)?
            .and::<T>(self.rest)
    }
}

/// Scratch of [`initial_conditions`], in meshes of `fft` (n) and of `fine` (m; n again without one):
///
/// | | local f_NL | other shapes |
/// |---|---|---|
/// | first order | n + m | 2 n + 2 m |
/// | first order of a species | 3 n + m | 3 n + m, or 2 n + 2 m if that is more |
/// | second order | n + m + the larger of 2 n and m | the same, or 2 n + 2 m if that is more |
/// | third order | 18 n + m | the same |
///
/// And 8 bytes for each |n|^2 up to 3 (N/2)^2 in two tables, one more for a shape, two more for a species, 16 for each of N/2 + 1 at third order, and 8
/// for each chunk. In bytes a cell, second order, local, with a `fine` of 3/2 the side: 63 in f64, 32 in f32; without it 33 and 17. Third order
/// without it: 155 and 78.
///
/// # Errors
/// `Overflow` if the bytes do not fit the address space.
///
/// # Example
/// ```
/// use fixpair::cosmology::{Convention, Cosmology, EisensteinHu, Linear, Wiggles};
/// use fixpair::initial::conditions::{InitialConditions, Order};
/// use fixpair::initial::{png::Local, shape::Shape};
/// use fixpair::noise::{Amplitude, Realisation};
///
/// let cosmology = Cosmology::goliat();
/// let fit = EisensteinHu::new(&cosmology, Wiggles::With)?;
/// let conditions = InitialConditions {
///     realisation: Realisation { amplitude: Amplitude::Fixed, ..Realisation::new(1) },
///     linear: Linear::from_eisenstein_hu(fit, 0.96, 1.0)?.with_sigma8(0.8)?,
///     cosmology,
///     redshift: 32.0,
///     box_size: 1000.0,
///     local: Local { f_nl: 100.0, g_nl: 0.0 },
///     shape: Shape::Local.rows(),
///     species: None,
///     convention: Convention::Cmb,
///     order: Order::Second,
/// };
/// # use fixpair::{exec::Serial, fft::{Tables, Transform}, mesh::{Brick, Space}};
/// # #[repr(align(64))] struct Memory([u8; 1 << 16]);
/// # let (mut tables, mut work) = (Memory([0; 1 << 16]), Memory([0; 1 << 16]));
/// # let tables = Tables::<f64>::new(8, &mut tables.0)?;
/// # let mut fft = Transform::new(&tables, Brick::whole(8, Space::Configuration)?, &mut work.0, &Serial)?;
/// use fixpair::initial::conditions::initial_conditions_scratch;
///
/// let layout = initial_conditions_scratch(conditions.parts(), &fft, None)?; // products alias
/// assert!(layout.size > 0);
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn initial_conditions_scratch<T: Real>(
    parts: Parts,
    fft: &dyn Fft3<T>,
    fine: Option<&(dyn Fft3<T> + '_)>,
) -> Result<Layout> {
    Sizes::new(parts, fft, fine)?.layout::<T>()
}

/// Positions and velocities of a Fixed, Paired or Matched universe with primordial non-Gaussianity: noise -> fix -> invert -> colour ->
/// PNG -> transfer -> displace.
///
/// `position` in Mpc/h, in [0, L); `velocity`: peculiar, in km/s (Gadget files store it divided by sqrt(a)). One particle for each cell
/// of `fft`, in the order of [`super::particles`]. `fine`: a transform for products without aliasing, of side 3N/2 or more, 2N
/// or more with g_NL; without it f_NL, g_NL and the second order alias. The third order, and the second where there is a third, never do.
///
/// # Errors
/// Those of the stages; outputs are untouched unless it is `Hook`, or `NotFinite` because the fields overflow.
///
/// Cost: with f_NL and second order 15 transforms, or 6 of `fft` and 10 of `fine`; one noise field, and about 33 passes. At third order 198 transforms
/// of `fft`, and those of f_NL.
///
/// # Example
/// ```
/// use fixpair::cosmology::{Convention, Cosmology, EisensteinHu, Linear, Wiggles};
/// use fixpair::initial::conditions::{InitialConditions, Order};
/// use fixpair::initial::{png::Local, shape::Shape};
/// use fixpair::noise::{Amplitude, Realisation};
///
/// let cosmology = Cosmology::goliat();
/// let fit = EisensteinHu::new(&cosmology, Wiggles::With)?;
/// let conditions = InitialConditions {
///     realisation: Realisation { amplitude: Amplitude::Fixed, ..Realisation::new(1) },
///     linear: Linear::from_eisenstein_hu(fit, 0.96, 1.0)?.with_sigma8(0.8)?,
///     cosmology,
///     redshift: 32.0,
///     box_size: 1000.0,
///     local: Local { f_nl: 100.0, g_nl: 0.0 },
///     shape: Shape::Local.rows(),
///     species: None,
///     convention: Convention::Cmb,
///     order: Order::Second,
/// };
/// # use fixpair::{exec::Serial, fft::{Tables, Transform}, mesh::{Brick, Space}};
/// # #[repr(align(64))] struct Memory([u8; 1 << 16]);
/// # let (mut tables, mut work) = (Memory([0; 1 << 16]), Memory([0; 1 << 16]));
/// # let tables = Tables::<f64>::new(8, &mut tables.0)?;
/// # let mut fft = Transform::new(&tables, Brick::whole(8, Space::Configuration)?, &mut work.0, &Serial)?;
/// use fixpair::initial::conditions::initial_conditions;
/// use fixpair::initial::particles::Components;
/// # let mut memory = Memory([0; 1 << 16]);
/// # let scratch = &mut memory.0; // of initial_conditions_scratch bytes
///
/// let (mut x, mut v) = ([0.0; 3 * 512], [0.0; 3 * 512]); // Mpc/h, km/s
/// let (mut position, mut velocity) = (Components::triples(&mut x)?, Components::triples(&mut v)?);
/// initial_conditions(&mut position, &mut velocity, &conditions, &mut fft, None, scratch, &Serial)?;
/// assert!(x.iter().all(|x| (0.0..1000.0).contains(x)) && v[0] != 0.0);
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn initial_conditions<T: Real>(
    position: &mut Components<'_, T>,
    velocity: &mut Components<'_, T>,
    conditions: &InitialConditions<'_>,
    fft: &mut dyn Fft3<T>,
    fine: Option<&mut (dyn Fft3<T> + '_)>,
    scratch: &mut [u8],
    exec: &dyn Exec,
) -> Result<()> {
    let cells = *fft.configuration();
    position.check_length(cells.elements())?;
    velocity.check_length(cells.elements())?;
    let start = conditions.start()?;
    let step = start.1.step();
    let mut place = |axis: usize, first: &[T], second: Option<&[T]>| {
        displace(position, velocity, first, second, &cells, axis, &step, exec)
    };
    displaced(conditions, &start, fft, fine, scratch, &mut place, exec)
}

/// All but the last stage, which is `place`; from what [`InitialConditions::start`] says.
pub(crate) fn displaced<T: Real>(
    conditions: &InitialConditions<'_>,
    (poisson, motion): &(Poisson<'_>, Motion),
    fft: &mut dyn Fft3<T>,
    mut fine: Option<&mut (dyn Fft3<T> + '_)>,
    scratch: &mut [u8],
    place: &mut Place<'_, T>,
    exec: &dyn Exec,
) -> Result<()> {
    let (n, box_size) = (fft.configuration().n(), conditions.box_size);
    if let Some(fine) = fine.as_deref() {
        let least = conditions.local.dealiased_side(n).max(3 * n / 2);
        if fine.configuration().n() < least {
            return Err(Error::Brick);
        }
    }
    let sizes = Sizes::new(conditions.parts(), fft, fine.as_deref())?;
    let mut arena = Arena::new(scratch, sizes.layout::<T>()?)?;
    let [potential_amplitude, transfer, powers, density_ratio, velocity_ratio] =
        arena.take_each::<f64, 5>(sizes.tables)?;
    let half_cells = arena.take::<[f64; 2]>(sizes.half_cells)?;
    let partial = arena.take::<[f64; 1]>(sizes.partial)?;
    let density = arena.take::<T>(sizes.density)?;
    let mesh = arena.take::<T>(sizes.mesh)?;
    let rest = arena.take::<T>(sizes.rest)?;
    potential_amplitude_table(exec, poisson, n, box_size, potential_amplitude)?;
    alpha_table(exec, poisson, n, box_size, transfer)?;
    let first_order = match &conditions.species {
        None => None,
        Some(species) => {
            if species.has_own_growth() {
                species_table(exec, species, Ratio::Matter, n, box_size, density_ratio)?;
                transfer.iter_mut().zip(&*density_ratio).for_each(|(alpha, ratio)| *alpha *= ratio);
            }
            species_table(exec, species, Ratio::Density, n, box_size, density_ratio)?;
            species_table(exec, species, Ratio::Velocity, n, box_size, velocity_ratio)?;
            Some(FirstOrder::new(density_ratio, velocity_ratio, motion))
        }
    };
    let field = Field {
        // Displacements have no Nyquist modes, and not every scheme has them.
        realisation: Realisation { nyquist: Nyquist::Zero, ..conditions.realisation },
        potential_amplitude,
        local: conditions.local,
        shape: conditions.shape,
        n_s: conditions.linear.n_s(),
        transfer,
    };
    let work = FieldWork { mesh: &mut *mesh, rest: &mut *rest, table: powers, partial };
    linear_density(density, &field, fft, fine.as_deref_mut(), work, exec)?;
    let work = Work { source: mesh, rest, table: half_cells };
    displacements(density, conditions.order, motion, first_order.as_ref(), fft, fine, work, place, exec)
}
