//! Which triangles.

use super::shells::check_edges;
use crate::status::{Error, Result};
use crate::within::Within;

/// Three shells, counted from 0.
pub type Triangle = [u32; 3];

/// Slack of the closing rule for centres: above the rounding of c_i + c_j, below any step between shells.
const SLACK: f64 = 1e-9;

/// The shells of a triangle in increasing order.
#[inline]
pub(super) fn sorted([a, b, c]: Triangle) -> Triangle {
    let (low, high) = (a.min(b), a.max(b));
    [low.min(c), low.max(high.min(c)), high.max(c)]
}

/// `Range` for a shell that does not exist, `Overflow` for more triangles than 2^30.
pub(super) fn check_triangles(triangles: &[Triangle], shells: usize) -> Result<()> {
    if triangles.len() > 1 << 30 {
        return Err(Error::Overflow);
    }
    if triangles.iter().flatten().any(|&shell| shell as usize >= shells) { Err(Error::Range) } else { Ok(()) }
}

/// Can these shells, in increasing order, close a triangle?
fn closes(edges: &[u64], centres: Option<&[f64]>, [i, j, k]: [usize; 3]) -> bool {
    match centres {
        Some(c) => c.at(k) <= (c.at(i) + c.at(j)) * (1.0 + SLACK),
        None => {
            // sqrt(c) <= sqrt(a) + sqrt(b) in integers, for the largest a, b and the smallest c.
            let (a, b, c) = (edges.at(i + 1) - 1, edges.at(j + 1) - 1, edges.at(k));
            c.checked_sub(a).and_then(|c| c.checked_sub(b)).is_none_or(|c| {
                let square = u128::from(c) * u128::from(c);
                square.div_ceil(4) <= u128::from(a) * u128::from(b)
            })
        }
    }
}

fn check(edges: &[u64], centres: Option<&[f64]>) -> Result<usize> {
    check_edges(edges)?;
    let shells = edges.len() - 1;
    if let Some(centres) = centres {
        if centres.len() != shells {
            return Err(Error::Length);
        }
        if centres.iter().any(|c| !c.is_finite()) {
            return Err(Error::NotFinite);
        }
        if centres.first().is_some_and(|&c| c < 0.0) || centres.windows(2).any(|pair| pair[0] >= pair[1]) {
            return Err(Error::Table);
        }
    }
    Ok(shells)
}

/// All closed triangles i <= j <= k, in lexicographic order.
fn each(shells: usize, edges: &[u64], centres: Option<&[f64]>, mut visit: impl FnMut(Triangle)) {
    for i in 0..shells {
        for j in i..shells {
            // What closes with k closes with every smaller one.
            for k in (j..shells).take_while(|&k| closes(edges, centres, [i, j, k])) {
                visit([i as u32, j as u32, k as u32]);
            }
        }
    }
}

/// How many triangles [`closed_triangles`] lists.
///
/// # Errors
/// `Table` for edges or centres that do not increase, `Length` unless there is one centre a shell, `NotFinite` for centres.
///
/// # Example
/// ```
/// use fixpair::estimate::bispectrum::closed_triangle_count;
/// use fixpair::estimate::edges::uniform_edges;
///
/// let (mut edges, centres) = ([0; 41], core::array::from_fn::<_, 40, _>(|i| i as f64 + 1.0));
/// uniform_edges(&mut edges, 1.5, 3.0)?;
/// assert_eq!(closed_triangle_count(&edges, Some(&centres))?, 6350); // the paper's
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn closed_triangle_count(edges: &[u64], centres: Option<&[f64]>) -> Result<usize> {
    let shells = check(edges, centres)?;
    let mut count = 0;
    each(shells, edges, centres, |_| count += 1);
    Ok(count)
}

/// Lists all triangles of shells i <= j <= k that close, in lexicographic order.
///
/// With `centres`, one for each shell in any unit, those with c_k <= c_i + c_j (within 1e-9 of it): for shells of one width centred on its
/// multiples, or counted by their floor, that is k <= i + j counted from 1, and 40 shells close 6350 triangles. Without, all in which
/// some mode numbers may close: sqrt(lo_k) <= sqrt(hi_i - 1) + sqrt(hi_j - 1).
///
/// # Errors
/// As [`closed_triangle_count`]; `Length` unless `triangles` is as long as that says.
///
/// # Example
/// ```
/// use fixpair::estimate::bispectrum::closed_triangles;
///
/// let mut triangles = [[0; 3]; 4];
/// closed_triangles(&mut triangles, &[1, 4, 9], Some(&[1.0, 2.0]))?;
/// assert_eq!(triangles, [[0, 0, 0], [0, 0, 1], [0, 1, 1], [1, 1, 1]]);
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn closed_triangles(triangles: &mut [Triangle], edges: &[u64], centres: Option<&[f64]>) -> Result<()> {
    if triangles.len() != closed_triangle_count(edges, centres)? {
        return Err(Error::Length);
    }
    let mut places = triangles.iter_mut();
    each(edges.len() - 1, edges, centres, |triangle| {
        if let Some(place) = places.next() {
            *place = triangle;
        }
    });
    Ok(())
}

/// Lists the squeezed slice of a shell: (shell, j, j) for j = shell .. shells - 1. For shell 0 of the shells of arXiv:2204.11103 that is its
/// k3 = Delta k.
///
/// # Errors
/// `Range` for a shell that does not exist, `Length` unless `triangles` has shells - shell entries.
///
/// # Example
/// ```
/// use fixpair::estimate::bispectrum::squeezed_triangles;
///
/// let mut triangles = [[0; 3]; 3];
/// squeezed_triangles(&mut triangles, 0, 3)?; // (Delta k, k, k)
/// assert_eq!(triangles, [[0, 0, 0], [0, 1, 1], [0, 2, 2]]);
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn squeezed_triangles(triangles: &mut [Triangle], shell: usize, shells: usize) -> Result<()> {
    if shell >= shells || u32::try_from(shells).is_err() {
        return Err(Error::Range);
    }
    if triangles.len() != shells - shell {
        return Err(Error::Length);
    }
    for (triangle, j) in triangles.iter_mut().zip(shell..) {
        *triangle = [shell as u32, j as u32, j as u32];
    }
    Ok(())
}
