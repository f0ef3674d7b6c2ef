//! Walking bricks: the loop that every kernel on cells or modes shares.
//!
//! A chunk is one index of the brick's outermost axis. Inside it the kernel sees *runs*: stretches along z that lie
//! together in memory (a whole row where z is innermost, else single elements), with the mesh index at which they begin.

use crate::exec::{Exec, Shared};
use crate::mesh::Brick;
use crate::real::Real;
use crate::status::{Error, Result};
use crate::within::Within;

/// A stretch of elements along z.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Run {
    /// Mesh indices of the first element.
    pub index: [usize; 3],
    /// Its offset in the array, in elements.
    pub offset: usize,
    /// Elements.
    pub length: usize,
}

/// Chunks of a brick.
///
/// ```
/// use fixpair::mesh::{Brick, Space};
/// use fixpair::walk::chunks;
///
/// assert!(chunks(&Brick::whole(64, Space::Fourier)?) >= 1); // whatever the threads
/// # Ok::<(), fixpair::status::Error>(())
/// ```
#[must_use]
pub fn chunks(brick: &Brick) -> usize {
    if brick.is_empty() { 0 } else { brick.count().at(brick.axes_by_stride()[2]) }
}

/// Calls `visit` for the runs of one chunk, in order of their address.
///
/// ```
/// use fixpair::mesh::{Brick, Space};
/// use fixpair::walk::{chunks, runs};
///
/// let (brick, mut elements) = (Brick::whole(8, Space::Fourier)?, 0);
/// for chunk in 0..chunks(&brick) {
///     runs(&brick, chunk, |run| elements += run.length);
/// }
/// assert_eq!(elements, brick.elements());
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn runs(brick: &Brick, chunk: usize, mut visit: impl FnMut(Run)) {
    let (start, count, stride) = (brick.start(), brick.count(), brick.stride());
    let axes = brick.axes_by_stride();
    let outer = axes[2];
    let joined = outer != 2 && (stride[2] == 1 || count[2] == 1);
    let (middle, inner) = if joined { (1 - outer, 2) } else { (axes[1], axes[0]) };
    let (steps, length) = if joined { (1, count[2]) } else { (count.at(inner), 1) };
    for m in 0..count.at(middle) {
        for i in 0..steps {
            let mut local = [0; 3];
            local.put(outer, chunk);
            local.put(middle, m);
            local.put(inner, i);
            visit(Run {
                index: [start[0] + local[0], start[1] + local[1], start[2] + local[2]],
                offset: (0..3).map(|axis| local[axis] * stride[axis]).sum(),
                length,
            });
        }
    }
}

/// Visits every run of meshes that share a brick: `write` meshes may be changed, `read` meshes may not.
///
/// # Errors
/// `Length` if an array cannot hold the brick; else as [`Exec::parallel_for`].
///
/// # Example
/// ```
/// use fixpair::exec::Serial;
/// use fixpair::mesh::{Brick, Space};
/// use fixpair::walk::walk;
///
/// let cells = Brick::whole(4, Space::Configuration)?;
/// let (mut out, from) = (vec![0.0_f32; cells.reals()], vec![2.0_f32; cells.reals()]);
/// walk(&Serial, &cells, [&mut out], [&from], &|_, [out], [from]| {
///     out.iter_mut().zip(from).for_each(|(out, from)| *out = 3.0 * from);
/// })?;
/// assert_eq!(out[0], 6.0);
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn walk<T: Real, const W: usize, const R: usize>(
    exec: &dyn Exec,
    brick: &Brick,
    write: [&mut [T]; W],
    read: [&[T]; R],
    body: &(dyn Fn(Run, [&mut [T]; W], [&[T]; R]) + Sync),
) -> Result<()> {
    walk_sum::<T, W, R, 0>(exec, brick, write, read, &mut [], &|run, w, r, _| body(run, w, r)).map(|_| ())
}

/// As [`walk`], and sums `S` numbers over the brick: each chunk into its own entry of `partial` (at least
/// [`chunks`] long unless S = 0), then the chunks in order. The result does not depend on the threads.
///
/// # Errors
/// As [`walk`]; `Scratch` if `partial` is too short.
///
/// # Example
/// ```
/// use fixpair::exec::Serial;
/// use fixpair::mesh::{Brick, Space};
/// use fixpair::walk::{chunks, walk_sum};
///
/// let cells = Brick::whole(4, Space::Configuration)?;
/// let (mesh, mut partial) = (vec![2.0_f32; cells.reals()], vec![[0.0]; chunks(&cells)]);
/// let [sum] = walk_sum::<f32, 0, 1, 1>(&Serial, &cells, [], [&mesh], &mut partial, &|_, [], [row], sum| {
///     sum[0] += row.iter().map(|&x| f64::from(x)).sum::<f64>();
/// })?;
/// assert_eq!(sum, 128.0); // the same on any number of threads
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn walk_sum<T: Real, const W: usize, const R: usize, const S: usize>(
    exec: &dyn Exec,
    brick: &Brick,
    write: [&mut [T]; W],
    read: [&[T]; R],
    partial: &mut [[f64; S]],
    body: &(dyn Fn(Run, [&mut [T]; W], [&[T]; R], &mut [f64; S]) + Sync),
) -> Result<[f64; S]> {
    let width = brick.space().width();
    let chunks = chunks(brick);
    for mesh in &write {
        brick.check_length(mesh)?;
    }
    for mesh in &read {
        brick.check_length(mesh)?;
    }
    if S > 0 && partial.len() < chunks {
        return Err(Error::Scratch);
    }
    let meshes = write.map(Shared::new);
    let sums = Shared::new(partial);
    exec.parallel_for(chunks, &|chunk| {
        let mut sum = [0.0; S];
        runs(brick, chunk, |run| {
            let (start, length) = (run.offset * width, run.length * width);
            // SAFETY: runs of a brick are inside it and disjoint (its axes nest), `check_length` put the brick inside
            // each array, the arrays are distinct exclusive borrows, and each chunk runs once.
            let w = core::array::from_fn(|i| unsafe { meshes[i].part(start, length) });
            let r = core::array::from_fn(|i| read[i].part(start..start + length));
            body(run, w, r, &mut sum);
        });
        if S > 0 {
            // SAFETY: one entry a chunk, and `partial` has at least as many entries as chunks.
            let entry = unsafe { sums.part(chunk, 1) };
            entry.fill(sum);
        }
    })?;
    let mut total = [0.0; S];
    if S > 0 {
        for sum in partial.part(..chunks) {
            for (t, s) in total.iter_mut().zip(sum) {
                *t += s;
            }
        }
    }
    Ok(total)
}

#[cfg(test)]
mod tests {
    use std::vec;
    use std::vec::Vec;

    use super::*;
    use crate::exec::{Serial, Threads};
    use crate::mesh::Space;

    fn layouts() -> [Brick; 6] {
        [
            Brick::whole(6, Space::Configuration).unwrap(),
            Brick::slab(6, Space::Fourier, 2, 1).unwrap(),
            Brick::transposed_slab(6, 1, 4).unwrap(),
            Brick::general(6, Space::Fourier, [1, 2, 1], [3, 2, 3], [1, 3, 6]).unwrap(),
            Brick::general(6, Space::Configuration, [0, 3, 0], [6, 1, 6], [1, 0, 7]).unwrap(),
            Brick::general(6, Space::Configuration, [2, 3, 4], [1, 5 - 3, 1], [9, 1, 7]).unwrap(),
        ]
    }

    #[test]
    fn every_element_is_visited_once_at_its_address() {
        let pool = Threads::new(3).unwrap();
        for brick in layouts() {
            let width = brick.space().width();
            let mut data = vec![-1.0; brick.reals()];
            walk::<f64, 1, 0>(&pool, &brick, [&mut data], [], &|run, [mesh], []| {
                assert_eq!(mesh.len(), run.length * width);
                for z in 0..run.length {
                    let [x, y, z0] = run.index;
                    assert_eq!(mesh[z * width], -1.0);
                    mesh[z * width] = (x * 100 + y * 10 + z0 + z) as f64;
                }
            })
            .unwrap();
            let (s, c, stride) = (brick.start(), brick.count(), brick.stride());
            for x in 0..c[0] {
                for y in 0..c[1] {
                    for z in 0..c[2] {
                        let address = width * (x * stride[0] + y * stride[1] + z * stride[2]);
                        let expect = (s[0] + x) * 100 + (s[1] + y) * 10 + s[2] + z;
                        assert_eq!(data[address], expect as f64, "{brick:?}");
                    }
                }
            }
        }
    }

    #[test]
    fn sums_do_not_depend_on_threads() {
        let brick = Brick::whole(12, Space::Configuration).unwrap();
        let data: Vec<f32> = (0..brick.reals()).map(|i| (i as f32).sin()).collect();
        let sum = |exec: &dyn Exec| {
            let mut partial = [[0.0; 1]; 12];
            walk_sum::<f32, 0, 1, 1>(exec, &brick, [], [&data], &mut partial, &|_, [], [mesh], sum| {
                sum[0] += mesh.iter().map(|&x| f64::from(x)).sum::<f64>();
            })
            .unwrap()[0]
        };
        for threads in [1, 2, 5] {
            assert_eq!(sum(&Threads::new(threads).unwrap()).to_bits(), sum(&Serial).to_bits());
        }
    }

    #[test]
    fn short_arrays_are_refused() {
        let brick = Brick::whole(4, Space::Fourier).unwrap();
        let mut short = vec![0.0; brick.reals() - 1];
        assert_eq!(walk::<f64, 1, 0>(&Serial, &brick, [&mut short], [], &|_, _, _| ()), Err(Error::Length));
    }
}
