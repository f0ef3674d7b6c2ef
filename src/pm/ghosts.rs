//! Cells that two regions share: folding ghost planes after a deposit, filling them before a read-out.
//!
//! The library moves nothing between processes; the host does, plane by plane. With x slabs, each process deposits into a region with ghosts
//! ([`Region::with_ghosts`]; set it to zero first), then for each of its planes a, which is plane (start + a) mod n of the mesh:
//!
//! - if it owns the plane, [`add_cells`] with that plane as source and its slab as target;
//! - else it sends the plane to the owner, who calls [`add_cells`] with the same source region (start on axis 0 that plane, count 1).
//!
//! One call with the whole region instead of a plane adds all planes that the process owns, so only those of others need a loop. Any
//! thickness of slabs is right, since a plane goes straight to its owner. Before a read-out owners send the same planes the other way, and
//! [`copy_cells`] puts them in place. For pencils, y planes are exchanged first, then x planes with their y ghosts.

use super::region::Region;
use crate::exec::{Exec, Shared};
use crate::real::Real;
use crate::status::{Error, Result};
use crate::within::Within;

/// A stretch of indices on one axis that two regions share.
#[derive(Clone, Copy, Default)]
struct Stretch {
    target: usize,
    source: usize,
    length: usize,
}

/// Adds the cells of `source` to the cells of `target` that are the same cells of the mesh. Others stay as they are.
///
/// # Errors
/// `Brick` if the meshes differ in n, `Length`, `Hook`.
///
/// Cost: one pass over the shared cells.
///
/// # Example
/// ```
/// use fixpair::pm::Region;
///
/// let stride = [80, 10, 1];
/// let (mine, other) = (Region::new(8, [0; 3], [4, 8, 8], stride)?, Region::new(8, [3, 0, 0], [2, 8, 8], stride)?);
/// use fixpair::pm::add_cells;
///
/// let (mut cells, ghosts) = (vec![1.0_f64; mine.reals()], vec![2.0; other.reals()]); // ghosts came from a neighbour
/// add_cells(&mut cells, &mine, &ghosts, &other, &fixpair::exec::Serial)?; // what both hold
/// assert_eq!((cells[0], cells[3 * 80]), (1.0, 3.0));
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn add_cells<T: Real>(
    target: &mut [T],
    target_region: &Region,
    source: &[T],
    source_region: &Region,
    exec: &dyn Exec,
) -> Result<()> {
    each_shared(target, target_region, source, source_region, exec, |to, from| *to += from)
}

/// Sets the cells of `target` that `source` holds too. Others stay as they are.
///
/// # Errors
/// As [`add_cells`].
///
/// Cost: one pass over the shared cells.
///
/// # Example
/// ```
/// use fixpair::pm::Region;
///
/// let stride = [80, 10, 1];
/// let (mine, other) = (Region::new(8, [0; 3], [4, 8, 8], stride)?, Region::new(8, [3, 0, 0], [2, 8, 8], stride)?);
/// use fixpair::pm::copy_cells;
///
/// let (mut cells, from) = (vec![1.0_f64; mine.reals()], vec![2.0; other.reals()]);
/// copy_cells(&mut cells, &mine, &from, &other, &fixpair::exec::Serial)?;
/// assert_eq!((cells[0], cells[3 * 80]), (1.0, 2.0));
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn copy_cells<T: Real>(
    target: &mut [T],
    target_region: &Region,
    source: &[T],
    source_region: &Region,
    exec: &dyn Exec,
) -> Result<()> {
    each_shared(target, target_region, source, source_region, exec, |to, from| *to = from)
}

/// The indices of one axis that both regions hold. Two arcs of a ring share two stretches at most.
fn shared(target: &Region, source: &Region, axis: usize) -> [Stretch; 2] {
    let n = target.n();
    let (held, wanted) = (source.count()[axis], target.count()[axis]);
    // Target index i is source index (i + ahead) mod n.
    let ahead = (target.start()[axis] + n - source.start()[axis]).checked_rem(n).unwrap_or(0);
    let until_edge = wanted.min(n - ahead);
    let first = Stretch { target: 0, source: ahead, length: until_edge.min(held.saturating_sub(ahead)) };
    let second = Stretch { target: until_edge, source: 0, length: (wanted - until_edge).min(held) };
    [first, second]
}

fn each_shared<T: Real>(
    target: &mut [T],
    target_region: &Region,
    source: &[T],
    source_region: &Region,
    exec: &dyn Exec,
    put: impl Fn(&mut T, T) + Sync,
) -> Result<()> {
    if target_region.n() != source_region.n() {
        return Err(Error::Brick);
    }
    target_region.check_length(target)?;
    source_region.check_length(source)?;
    if target_region.is_empty() || source_region.is_empty() {
        return Ok(());
    }
    let [x, y, z] = [0, 1, 2].map(|axis| shared(target_region, source_region, axis));
    let (to, from) = (target_region.stride(), source_region.stride());
    let target = Shared::new(target);
    let planes = x[0].length + x[1].length;
    exec.parallel_for(planes, &|plane| {
        let (x, plane) = if plane < x[0].length { (x[0], plane) } else { (x[1], plane - x[0].length) };
        for y in y {
            for row in 0..y.length {
                // Where nothing is shared, its place need not be in either array.
                for z in z.into_iter().filter(|z| z.length > 0) {
                    let start = (x.target + plane) * to[0] + (y.target + row) * to[1] + z.target * to[2];
                    let read = (x.source + plane) * from[0] + (y.source + row) * from[1] + z.source * from[2];
                    if to[2] == 1 && from[2] == 1 {
                        // SAFETY: the stretch lies inside the target, whose length is checked, and planes hold different cells.
                        let cells = unsafe { target.part(start, z.length) };
                        for (to, &from) in cells.iter_mut().zip(source.part(read..read + z.length)) {
                            put(to, from);
                        }
                    } else {
                        for i in 0..z.length {
                            // SAFETY: as above.
                            let cell = unsafe { target.part(start + i * to[2], 1) };
                            cell.iter_mut().for_each(|cell| put(cell, source.at(read + i * from[2])));
                        }
                    }
                }
            }
        }
    })
}
