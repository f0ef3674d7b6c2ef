//! The power spectrum of modes.
//!
//! P(k) = V <|f_k|^2> for modes with f(x) = sum_k f_k exp(+i k.x) in a box of volume V; the cross spectrum is V <Re f_k g_k*>.
//! Bins are given by integers |n|^2, so that no mode lies on an edge by rounding: bin b holds `edge[b] <= |n|^2 < edge[b+1]`.
//! N_modes counts both k and -k: 26, 66, 158, 234, 410, 470 for the unit shells b^2 <= |n|^2 < (b+1)^2, b = 1..6.

use crate::exec::{Exec, Shared};
use crate::mesh::{Brick, Space};
use crate::real::Real;
use crate::scratch::{Arena, Layout};
use crate::status::{Error, Result};
use crate::walk::{chunks, runs};

/// Raw sums of one bin.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C)]
pub struct Bin {
    /// Modes, counting k and -k; 0 where no mode falls into the bin.
    pub modes: u64,
    /// Sum of |n| over them: times (2 pi/L)/modes it is the mean k.
    pub wavenumber: f64,
    /// Sum of Re f_k g_k* over them: times V/modes it is P(k).
    pub power: f64,
}

/// Scratch of [`power_sums`]: the bins of each chunk, and the bin of each |n|^2 up to the last edge.
///
/// # Errors
/// `Brick` for a brick of configuration space, `Table` if the edges are not increasing, `Overflow` if the bytes do not fit the address space.
pub fn power_sums_scratch(brick: &Brick, edges: &[u64]) -> Result<Layout> {
    brick.check_space(Space::Fourier)?;
    check_edges(edges)?;
    let bins = edges.len() - 1;
    let cells = chunks(brick).checked_mul(bins).ok_or(Error::Overflow)?;
    Layout::EMPTY.and::<[f64; 3]>(cells)?.and::<u32>(lookup_length(brick, edges)?)
}

fn check_edges(edges: &[u64]) -> Result<()> {
    let increasing = edges.windows(2).all(|pair| pair[0] < pair[1]);
    if edges.len() < 2 || !increasing || u32::try_from(edges.len()).is_err() {
        Err(Error::Table)
    } else {
        Ok(())
    }
}

/// |n|^2 beyond the mesh's corner need no entry.
fn lookup_length(brick: &Brick, edges: &[u64]) -> Result<usize> {
    let half = brick.n() as u64 / 2;
    let corner = 3 * half * half + 1;
    usize::try_from(edges[edges.len() - 1].min(corner)).map_err(|_| Error::Overflow)
}

/// Sums |f_k|^2, or Re f_k g_k* where a second field is given, over the modes of a brick, bin by bin.
///
/// `bins`: one fewer than `edges`, overwritten; add the bins of other bricks of the same mesh to get the whole mesh's.
/// `edges`: increasing values of |n|^2, n = k L/(2 pi).
///
/// # Errors
/// `Table` for edges that are not increasing, `Brick` for a brick of configuration space, `Length`, `Scratch`, `Alignment`;
/// `NotFinite` if a sum is NaN or infinite (the bins are then untouched).
///
/// Cost: one pass over each field; sums in f64 in an order that does not depend on threads.
pub fn power_sums<T: Real>(
    bins: &mut [Bin],
    edges: &[u64],
    f: &[T],
    g: Option<&[T]>,
    brick: &Brick,
    scratch: &mut [u8],
    exec: &dyn Exec,
) -> Result<()> {
    brick.check_space(Space::Fourier)?;
    let g = g.unwrap_or(f);
    brick.check_length(f)?;
    brick.check_length(g)?;
    let layout = power_sums_scratch(brick, edges)?;
    let count = edges.len() - 1;
    if bins.len() != count {
        return Err(Error::Length);
    }
    let mut arena = Arena::new(scratch, layout)?;
    let partial = arena.take::<[f64; 3]>(chunks(brick) * count)?;
    let lookup = arena.take::<u32>(lookup_length(brick, edges)?)?;
    partial.fill([0.0; 3]);
    let mut bin = 0;
    for (square, entry) in lookup.iter_mut().enumerate() {
        while bin < edges.len() && edges[bin] <= square as u64 {
            bin += 1;
        }
        // Entry 0 is below the first edge; the last edge is beyond the table.
        *entry = bin as u32;
    }
    let lookup = &*lookup;
    {
        let shared = Shared::new(partial);
        exec.parallel_for(chunks(brick), &|chunk| {
            // SAFETY: each chunk has `count` entries of its own and runs once.
            let sums = unsafe { shared.part(chunk * count, count) };
            runs(brick, chunk, |run| {
                let (x, y) = (Brick::mode(brick.n(), run.index[0]), Brick::mode(brick.n(), run.index[1]));
                let square = (x * x + y * y) as usize;
                let at = 2 * run.offset..2 * (run.offset + run.length);
                let pairs = f[at.clone()].chunks_exact(2).zip(g[at].chunks_exact(2));
                for (m, (f, g)) in pairs.enumerate() {
                    let z = run.index[2] + m;
                    let square = square + z * z;
                    let bin = lookup.get(square).map_or(0, |&bin| bin as usize);
                    if bin > 0 {
                        // The planes l = 0 and l = n/2 hold both members of each pair, the others one.
                        let weight = if z == 0 || 2 * z == brick.n() { 1.0 } else { 2.0 };
                        let product = f[0].to_f64() * g[0].to_f64() + f[1].to_f64() * g[1].to_f64();
                        let sum = &mut sums[bin - 1];
                        sum[0] += weight;
                        sum[1] += weight * libm::sqrt(square as f64);
                        sum[2] += weight * product;
                    }
                }
            });
        })?;
    }
    let total = |bin: usize| {
        partial
            .chunks_exact(count)
            .fold([0.0; 3], |sum, chunk| core::array::from_fn(|i| sum[i] + chunk[bin][i]))
    };
    if (0..count).any(|bin| !total(bin)[2].is_finite()) {
        return Err(Error::NotFinite);
    }
    for (i, bin) in bins.iter_mut().enumerate() {
        let [modes, wavenumber, power] = total(i);
        *bin = Bin { modes: modes as u64, wavenumber, power };
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use std::vec;
    use std::vec::Vec;

    use super::*;
    use crate::exec::{Serial, Threads};

    fn unit_shells(count: u64) -> Vec<u64> {
        (1..=count + 1).map(|b| b * b).collect()
    }

    fn sums(f: &[f64], brick: &Brick, edges: &[u64], exec: &dyn Exec) -> Result<Vec<Bin>> {
        let mut scratch = vec![0_u8; power_sums_scratch(brick, edges)?.size + 64];
        let skip = scratch.as_ptr().align_offset(64);
        let mut bins = vec![Bin::default(); edges.len() - 1];
        power_sums(&mut bins, edges, f, None, brick, &mut scratch[skip..], exec)?;
        Ok(bins)
    }

    #[test]
    fn unit_shells_hold_the_published_numbers_of_modes() {
        let brick = Brick::whole(16, Space::Fourier).unwrap();
        let bins = sums(&vec![1.0; brick.reals()], &brick, &unit_shells(6), &Serial).unwrap();
        assert_eq!(bins.iter().map(|b| b.modes).collect::<Vec<_>>(), [26, 66, 158, 234, 410, 470]);
        assert!(bins.iter().all(|b| b.power == 2.0 * b.modes as f64));
    }

    #[test]
    fn layouts_and_threads_give_the_same_modes() {
        let whole = Brick::whole(12, Space::Fourier).unwrap();
        let field: Vec<f64> = (0..whole.reals()).map(|i| libm::sin(i as f64)).collect();
        let edges = unit_shells(5);
        let one = sums(&field, &whole, &edges, &Serial).unwrap();
        for threads in [2, 5] {
            assert_eq!(sums(&field, &whole, &edges, &Threads::new(threads).unwrap()).unwrap(), one);
        }
        let mut added = vec![Bin::default(); 5];
        for x in 0..12 {
            let slab = Brick::slab(12, Space::Fourier, x, 1).unwrap();
            let part = &field[x * whole.stride()[0] * 2..][..slab.reals()];
            for (sum, bin) in added.iter_mut().zip(sums(part, &slab, &edges, &Serial).unwrap()) {
                sum.modes += bin.modes;
                sum.wavenumber += bin.wavenumber;
                sum.power += bin.power;
            }
        }
        assert_eq!(added, one, "slabs of one plane are the chunks of the whole mesh");
    }

    #[test]
    fn bad_edges_and_fields_are_refused() {
        let brick = Brick::whole(4, Space::Fourier).unwrap();
        let mut field = vec![0.0; brick.reals()];
        assert_eq!(sums(&field, &brick, &[1], &Serial), Err(Error::Table));
        assert_eq!(sums(&field, &brick, &[4, 4], &Serial), Err(Error::Table));
        assert_eq!(sums(&field[1..], &brick, &[1, 4], &Serial), Err(Error::Length));
        field[2] = f64::NAN;
        assert_eq!(sums(&field, &brick, &[1, 4], &Serial), Err(Error::NotFinite));
    }
}
