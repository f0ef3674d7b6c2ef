//! Groups that reach over the borders of processes.
//!
//! Each process passes [`fof_labels`](super::fof_labels) its own particles followed by ghosts: copies, with their ids, of all particles of other
//! processes within the linking length of its region, periodically. Then for each ghost there are two labels: the one that it has here, and the
//! one that its owner gave it. Both are of one group. All such pairs together ([`fof_merge`]) tell which labels are to be replaced
//! by which, and [`fof_relabel`] replaces them. The results are the labels of the whole.
//!
//! A link over a border is found if one of the two processes has a copy of the other's particle, so ghosts of one side of each border suffice.

use crate::exec::{Exec, for_each_piece};
use crate::status::{Error, Result};

/// Works out the final label of each label that occurs in `pairs` of labels of one group, in any order and repeated at will.
///
/// `map`: twice as long as `pairs` or longer; its first entries become [label, final label], with labels increasing. Returns how many.
///
/// # Errors
/// `Length` if the map is too short.
///
/// Cost: a sort of all labels and two searches a pair. No scratch.
///
/// # Example
/// ```
/// use fixpair::halos::fof_merge;
///
/// let mut map = [[0; 2]; 4]; // two a pair
/// let entries = fof_merge(&mut map, &[[7, 3], [9, 7]])?; // labels of one group on either side of a border
/// assert_eq!(map[..entries], [[3, 3], [7, 3], [9, 3]]);
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn fof_merge(map: &mut [[u64; 2]], pairs: &[[u64; 2]]) -> Result<usize> {
    if map.len() / 2 < pairs.len() {
        return Err(Error::Length);
    }
    let all = &mut map[..2 * pairs.len()];
    for (to, label) in all.iter_mut().zip(pairs.as_flattened()) {
        *to = [*label, 0];
    }
    all.sort_unstable();
    let mut labels = 0;
    for i in 0..all.len() {
        if i == 0 || all[i][0] != all[labels - 1][0] {
            all[labels] = [all[i][0], labels as u64];
            labels += 1;
        }
    }
    let sets = &mut all[..labels];
    // Second numbers are places in the list, of a label of the same group that is not larger.
    fn root(sets: &mut [[u64; 2]], mut i: usize) -> usize {
        while sets[i][1] != i as u64 {
            let next = sets[sets[i][1] as usize][1];
            sets[i][1] = next;
            i = next as usize;
        }
        i
    }
    for pair in pairs {
        let [a, b] = pair.map(|label| sets.partition_point(|entry| entry[0] < label));
        let (a, b) = (root(sets, a), root(sets, b));
        sets[a.max(b)][1] = a.min(b) as u64;
    }
    for i in 0..labels {
        sets[i][1] = root(sets, i) as u64;
    }
    for i in 0..labels {
        sets[i][1] = sets[sets[i][1] as usize][0];
    }
    Ok(labels)
}

/// The final label of a label that the map holds.
pub(super) fn final_label(map: &[[u64; 2]], label: u64) -> Option<u64> {
    map.binary_search_by_key(&label, |entry| entry[0]).ok().map(|at| map[at][1])
}

/// `Table` unless labels increase.
pub(super) fn check_map(map: &[[u64; 2]]) -> Result<()> {
    if map.is_sorted_by(|a, b| a[0] < b[0]) { Ok(()) } else { Err(Error::Table) }
}

/// Labels looked up by one chunk.
const CHUNK: usize = 1 << 14;

/// Replaces the labels that `map` holds by their final ones; others stay.
///
/// # Errors
/// `Table` unless the labels of the map increase; `Hook`, after which some labels are replaced.
///
/// Cost: a binary search a particle.
///
/// # Example
/// ```
/// use fixpair::halos::fof_relabel;
///
/// let mut labels = [7, 2];
/// fof_relabel(&mut labels, &[[7, 3]], &fixpair::exec::Serial)?; // the group that began at 7 goes on at 3
/// assert_eq!(labels, [3, 2]);
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn fof_relabel(labels: &mut [u64], map: &[[u64; 2]], exec: &dyn Exec) -> Result<()> {
    check_map(map)?;
    for_each_piece(exec, labels, CHUNK, &|_, labels| {
        for label in labels {
            *label = final_label(map, *label).unwrap_or(*label);
        }
    })
}
