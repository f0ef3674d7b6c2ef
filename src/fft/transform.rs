//! The built-in transform of a whole mesh: rows and columns of each plane while it is in cache, then the columns of x.
//!
//! Cost: 5/2 N log2 N floating-point operations by the usual count (N = n^3), and two sweeps that read and write the
//! mesh, one per half: 4 N numbers moved at the least. No square or block of the mesh is copied: passes read columns
//! straight from the mesh into the workspace and store the last pass straight back.
//!
//! Error: at most 0.45 epsilon sqrt(log2 N) of the r.m.s. value in the r.m.s., 8 times that in the worst place.

use core::any::TypeId;

use super::Fft3;
use super::access::{Access, Columns, Scattered, Swapped};
#[cfg(target_arch = "x86_64")]
use super::avx2::{F32x8, F64x4};
use super::lanes::{COMPLEX_BYTES, Lanes, Portable};
use super::passes;
use super::rows::{self, Rows};
use super::tables::Tables;
use crate::exec::{Exec, Shared};
use crate::mesh::{Brick, Space};
use crate::real::Real;
use crate::scratch::{ALIGN, Arena, Layout};
use crate::simd::Simd;
use crate::status::{Error, Result};

/// Most pieces that a sweep over the mesh is cut into. Each has a part of the workspace of its own.
const CHUNKS: usize = 64;

/// Modes of padding after each x plane ([`Brick::whole_padded`]) with which the built-in transform is fastest: none,
/// except where planes would begin a multiple of 1 KiB apart and their columns share a few sets of the cache.
///
/// ```
/// use fixpair::fft::recommended_padding;
///
/// assert_eq!((recommended_padding::<f64>(64), recommended_padding::<f64>(96)), (4, 0));
/// ```
#[must_use]
pub fn recommended_padding<T: Real>(n: usize) -> usize {
    let mode = 2 * size_of::<T>();
    let plane = (n / 2 + 1).wrapping_mul(n).wrapping_mul(mode);
    if plane.is_multiple_of(1024) { ALIGN / mode } else { 0 }
}

/// The transform of one whole mesh, by one call at a time. Several transforms may share their tables.
///
/// The bits of the result depend on the data, n, the number type and the SIMD path, and on nothing else: not on the
/// executor, its threads, the padding or the alignment of the mesh.
pub struct Transform<'a, T: Real> {
    tables: &'a Tables<'a, T>,
    configuration: Brick,
    fourier: Brick,
    workspace: &'a mut [u8],
    exec: &'a dyn Exec,
    simd: Simd,
}

impl<'a, T: Real> Transform<'a, T> {
    /// Bytes of work that transforms of side n need: 4096 (n + 2), whatever the number type and the executor.
    ///
    /// # Errors
    /// `MeshSize`, `Overflow` as [`Tables::layout`].
    ///
    /// # Example
    /// ```
    /// use fixpair::fft::Transform;
    ///
    /// assert_eq!(Transform::<f64>::workspace(64)?.size, 4096 * 66);
    /// # Ok::<(), fixpair::status::Error>(())
    /// ```
    pub fn workspace(n: usize) -> Result<Layout> {
        Tables::<T>::layout(n)?;
        Layout::EMPTY.and::<u8>(CHUNKS * COMPLEX_BYTES * (n + 2))
    }

    /// A transform of meshes whose cells lie as `configuration` says: the whole mesh, rows of n + 2 reals, planes at an
    /// even number of reals of at least n (n + 2) apart, as [`Brick::whole`] and [`Brick::whole_padded`] make them.
    ///
    /// # Errors
    /// `Brick` if the brick is otherwise or of another side than the tables; `Scratch`, `Alignment` if the workspace is
    /// not as [`Transform::workspace`] says.
    ///
    /// # Example
    /// ```
    /// use fixpair::exec::Serial;
    /// use fixpair::fft::{Fft3, Tables, Transform};
    /// use fixpair::mesh::{Brick, Space};
    /// # #[repr(align(64))] struct Memory([u8; 1 << 16]);
    /// # let (mut tables, mut work) = (Memory([0; 1 << 16]), Memory([0; 1 << 16]));
    /// # let (tables, work) = (&mut tables.0, &mut work.0);
    ///
    /// let tables = Tables::<f64>::new(8, tables)?;
    /// let mut fft = Transform::new(&tables, Brick::whole(8, Space::Configuration)?, work, &Serial)?;
    /// let mut data = vec![0.0; fft.length()];
    /// data[0] = 1.0; // one cell
    /// fft.forward(&mut data)?;
    /// assert!((data[0] - 1.0).abs() < 1e-15 && (data[2] - 1.0).abs() < 1e-15); // every mode is 1
    /// # Ok::<(), fixpair::status::Error>(())
    /// ```
    pub fn new(
        tables: &'a Tables<'a, T>,
        configuration: Brick,
        workspace: &'a mut [u8],
        exec: &'a dyn Exec,
    ) -> Result<Self> {
        let n = tables.n();
        let [plane, row, cell] = configuration.stride();
        let cells = configuration.space() == Space::Configuration && configuration.n() == n;
        if !cells || !configuration.is_whole() || cell != 1 || row != n + 2 || !plane.is_multiple_of(2) {
            return Err(Error::Brick);
        }
        let padding = plane.checked_sub(n * (n + 2)).ok_or(Error::Brick)? / 2;
        let fourier = Brick::whole_padded(n, Space::Fourier, padding)?;
        let layout = Self::workspace(n)?;
        let workspace = Arena::new(workspace, layout)?.take::<u8>(layout.size)?;
        Ok(Self { tables, configuration, fourier, workspace, exec, simd: Simd::detect() })
    }

    /// The same transform by another code path, where the processor has it. Paths differ by rounding.
    ///
    /// ```
    /// # use fixpair::{exec::Serial, fft::{Fft3, Tables, Transform}, mesh::{Brick, Space}};
    /// # #[repr(align(64))] struct Memory([u8; 1 << 16]);
    /// # let (mut tables, mut work) = (Memory([0; 1 << 16]), Memory([0; 1 << 16]));
    /// # let tables = Tables::<f64>::new(8, &mut tables.0)?;
    /// # let fft = Transform::new(&tables, Brick::whole(8, Space::Configuration)?, &mut work.0, &Serial)?;
    /// use fixpair::simd::Simd;
    ///
    /// let mut fft = fft.with_simd(Simd::Portable); // the bits of processors without AVX2
    /// let mut cells = vec![1.0; fft.length()];
    /// fft.forward(&mut cells)?;
    /// assert_eq!(cells[0], 512.0);
    /// # Ok::<(), fixpair::status::Error>(())
    /// ```
    #[must_use]
    pub fn with_simd(mut self, simd: Simd) -> Self {
        self.simd = if simd == Simd::detect() { simd } else { Simd::Portable };
        self
    }

    fn run(&mut self, direction: Direction, data: &mut [T]) -> Result<()> {
        if data.len() != self.length() {
            return Err(Error::Length);
        }
        let n = self.tables.n();
        let data = Shared::new(data);
        let workspace = Shared::new(self.workspace);
        let sweep = Sweep {
            tables: self.tables,
            data: data.as_ptr(),
            plane: self.configuration.stride()[0],
            workspace: workspace.as_ptr(),
            line: COMPLEX_BYTES * (n + 2),
        };
        // SAFETY: the mesh and the workspace are exclusively ours and as large as `new` and the check above say, and the
        // processor has the lanes of `simd`, says `detect`.
        unsafe {
            if let Some(sweep) = sweep.of::<f32>() {
                match self.simd {
                    #[cfg(target_arch = "x86_64")]
                    Simd::Avx2 => sweep.run::<F32x8>(direction, self.exec),
                    _ => sweep.run::<Portable<f32, 4>>(direction, self.exec),
                }
            } else if let Some(sweep) = sweep.of::<f64>() {
                match self.simd {
                    #[cfg(target_arch = "x86_64")]
                    Simd::Avx2 => sweep.run::<F64x4>(direction, self.exec),
                    _ => sweep.run::<Portable<f64, 2>>(direction, self.exec),
                }
            } else {
                Err(Error::Choice)
            }
        }
    }
}

impl<T: Real> Fft3<T> for Transform<'_, T> {
    fn configuration(&self) -> &Brick {
        &self.configuration
    }

    fn fourier(&self) -> &Brick {
        &self.fourier
    }

    fn length(&self) -> usize {
        self.fourier.reals()
    }

    fn forward(&mut self, data: &mut [T]) -> Result<()> {
        self.run(Direction::Forward, data)
    }

    fn inverse(&mut self, data: &mut [T]) -> Result<()> {
        self.run(Direction::Inverse, data)
    }
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Direction {
    Forward,
    Inverse,
}

/// What the chunks of one call share.
#[derive(Clone, Copy)]
struct Sweep<'a, T> {
    tables: &'a Tables<'a, T>,
    data: *mut T,
    /// Reals from plane to plane.
    plane: usize,
    workspace: *mut u8,
    /// Bytes of workspace of a chunk.
    line: usize,
}

// SAFETY: chunks write disjoint planes or columns and disjoint parts of the workspace.
unsafe impl<T: Sync> Sync for Sweep<'_, T> {}

impl<'a, T: Real> Sweep<'a, T> {
    /// This sweep, if `E` is the type of its numbers.
    fn of<E: Real>(&self) -> Option<&Sweep<'a, E>> {
        if TypeId::of::<T>() == TypeId::of::<E>() {
            // SAFETY: the types are the same.
            Some(unsafe { &*core::ptr::from_ref(self).cast::<Sweep<'a, E>>() })
        } else {
            None
        }
    }

    /// # Safety
    /// `data` is a mesh of side n with planes `plane` apart, `workspace` has `CHUNKS` lines, both are nobody else's, and
    /// the processor has the lanes.
    unsafe fn run<V: Lanes<Element = T>>(&self, direction: Direction, exec: &dyn Exec) -> Result<()> {
        let n = self.tables.n();
        let (groups, blocks) = (n.div_ceil(V::COUNT), (n * (n / 2 + 1)).div_ceil(V::COUNT));
        let share = |items: usize, body: &(dyn Fn(usize, *mut T) + Sync)| {
            let each = items.div_ceil(CHUNKS).max(1);
            exec.parallel_for(items.div_ceil(each), &|chunk| {
                // SAFETY: there are at most CHUNKS chunks, and each has a line, aligned to a cache line.
                let work = unsafe { self.workspace.add(chunk * self.line) };
                (chunk * each..items.min((chunk + 1) * each)).for_each(|item| body(item, work.cast()));
            })
        };
        let planes = |group: usize, work: *mut T| {
            // SAFETY: groups are disjoint planes; each chunk runs once, with a line of its own.
            unsafe {
                match direction {
                    Direction::Forward => self.planes_forward::<V>(group, work),
                    Direction::Inverse => self.planes_inverse::<V>(group, work),
                }
            }
        };
        let columns = |block: usize, work: *mut T| {
            // SAFETY: blocks are disjoint columns; each chunk runs once, with a line of its own.
            unsafe { self.x_columns::<V>(direction, block, work) }
        };
        match direction {
            Direction::Forward => share(groups, &planes).and_then(|()| share(blocks, &columns)),
            Direction::Inverse => share(blocks, &columns).and_then(|()| share(groups, &planes)),
        }
    }

    /// Rows and columns of as many planes as there are lanes.
    ///
    /// # Safety
    /// As [`Sweep::run`]; the planes of `group` are inside the mesh and nobody else's, and `work` is a line.
    unsafe fn planes_forward<V: Lanes<Element = T>>(&self, group: usize, work: *mut T) {
        let n = self.tables.n();
        let planes = group * V::COUNT..n.min((group + 1) * V::COUNT);
        for x in planes.clone() {
            // SAFETY: rows y .. y + count lie in plane x.
            unsafe {
                let plane = self.data.add(x * self.plane);
                for y in (0..n).step_by(V::COUNT) {
                    let first = plane.add(y * (n + 2));
                    rows::forward::<V>(
                        self.tables,
                        Rows { first, stride: n + 2, count: V::COUNT.min(n - y) },
                        work,
                    );
                }
                self.y_columns::<V>(Direction::Forward, plane, work);
            }
        }
        // SAFETY: the caller's.
        unsafe { self.y_leftovers::<V>(Direction::Forward, planes, work) }
    }

    /// Undoes `planes_forward`.
    ///
    /// # Safety
    /// As `planes_forward`.
    unsafe fn planes_inverse<V: Lanes<Element = T>>(&self, group: usize, work: *mut T) {
        let n = self.tables.n();
        let planes = group * V::COUNT..n.min((group + 1) * V::COUNT);
        // SAFETY: the caller's.
        unsafe { self.y_leftovers::<V>(Direction::Inverse, planes.clone(), work) }
        for x in planes {
            // SAFETY: rows y .. y + count lie in plane x.
            unsafe {
                let plane = self.data.add(x * self.plane);
                self.y_columns::<V>(Direction::Inverse, plane, work);
                for y in (0..n).step_by(V::COUNT) {
                    let first = plane.add(y * (n + 2));
                    rows::inverse::<V>(
                        self.tables,
                        Rows { first, stride: n + 2, count: V::COUNT.min(n - y) },
                        work,
                    );
                }
            }
        }
    }

    /// Columns along y of one plane, as many at a time as there are lanes.
    ///
    /// # Safety
    /// As `planes_forward`.
    unsafe fn y_columns<V: Lanes<Element = T>>(&self, direction: Direction, plane: *mut T, work: *mut T) {
        let n = self.tables.n();
        let columns = n / 2 + 1;
        for z in (0..columns - columns % V::COUNT).step_by(V::COUNT) {
            // SAFETY: the columns z .. z + V::COUNT lie in the plane.
            unsafe {
                let columns = Columns {
                    first: plane.add(2 * z),
                    stride: n + 2,
                    fetch_next_pair: (z / V::COUNT).is_multiple_of(2),
                };
                self.column::<V, _>(direction, columns, work);
            }
        }
    }

    /// The columns along y that fill no vector: the same one of several planes side by side.
    ///
    /// # Safety
    /// As `planes_forward`.
    unsafe fn y_leftovers<V: Lanes<Element = T>>(
        &self,
        direction: Direction,
        planes: core::ops::Range<usize>,
        work: *mut T,
    ) {
        let n = self.tables.n();
        let columns = n / 2 + 1;
        for z in columns - columns % V::COUNT..columns {
            // SAFETY: column z of each of at most V::COUNT planes.
            unsafe {
                let first = self.data.add(planes.start * self.plane + 2 * z);
                let columns = Scattered { first, stride: n + 2, lanes: planes.len(), apart: self.plane };
                self.column::<V, _>(direction, columns, work);
            }
        }
    }

    /// A block of columns along x. They are neighbours across the ends of rows.
    ///
    /// # Safety
    /// As [`Sweep::run`]; the columns of `block` begin inside the mesh and are nobody else's, and `work` is a line.
    unsafe fn x_columns<V: Lanes<Element = T>>(&self, direction: Direction, block: usize, work: *mut T) {
        let n = self.tables.n();
        let first = block * V::COUNT;
        let lanes = (n * (n / 2 + 1) - first).min(V::COUNT);
        // SAFETY: columns first .. first + lanes lie in each plane.
        unsafe {
            let first = self.data.add(2 * first);
            if lanes == V::COUNT {
                self.column::<V, _>(
                    direction,
                    Columns { first, stride: self.plane, fetch_next_pair: block.is_multiple_of(2) },
                    work,
                );
            } else {
                self.column::<V, _>(
                    direction,
                    Scattered { first, stride: self.plane, lanes, apart: 2 },
                    work,
                );
            }
        }
    }

    /// # Safety
    /// The n elements of `columns` are nobody else's, `work` is a line, and the processor has the lanes.
    #[inline(always)]
    unsafe fn column<V: Lanes<Element = T>, A: Access<V>>(
        &self,
        direction: Direction,
        columns: A,
        work: *mut T,
    ) {
        let plan = &self.tables.columns;
        // SAFETY: the caller's.
        unsafe {
            match direction {
                Direction::Forward => passes::transform::<V, _, _>(plan, columns, columns, work),
                Direction::Inverse => {
                    passes::transform::<V, _, _>(plan, Swapped(columns), Swapped(columns), work);
                }
            }
        }
    }
}
