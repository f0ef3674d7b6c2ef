//! Groups that reach over the borders of processes.
//!
//! Each process passes [`fof_labels`](super::fof_labels) its own particles followed by ghosts: copies, with their ids, of all particles of other
//! processes within the linking length of its region, periodically. Then for each ghost there are two labels: the one that it has here, and the
//! one that its owner gave it. Both are of one group. All such pairs together ([`fof_merge`]) tell which labels are to be replaced
//! by which, and [`fof_relabel`] replaces them. The results are the labels of the whole.
//!
//! A link over a border is found if one of the two processes has a copy of the other's particle, so ghosts of one side of each border suffice.

use crate::exec::{Exec, for_each_piece};
use crate::sort::sort_by_key;
use crate::status::{Error, Result};
use crate::within::Within;

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
    let all = map.get_mut(..2 * pairs.len()).ok_or(Error::Length)?;
    for (to, label) in all.iter_mut().zip(pairs.as_flattened()) {
        *to = [*label, 0];
    }
    sort_by_key(all, |entry| entry[0]);
    let mut labels = 0;
    for i in 0..all.len() {
        let [label, _] = all.at(i);
        if i == 0 || label != all.at(labels - 1)[0] {
            all.put(labels, [label, labels as u64]);
            labels += 1;
        }
    }
    let sets = all.part_mut(..labels);
    // Second numbers are places in the list, of a label of the same group that is not larger.
    fn root(sets: &mut [[u64; 2]], mut i: usize) -> usize {
        loop {
            let [label, parent] = sets.at(i);
            if parent == i as u64 {
                return i;
            }
            let [_, next] = sets.at(parent as usize);
            sets.put(i, [label, next]);
            i = next as usize;
        }
    }
    for pair in pairs {
        let [a, b] = pair.map(|label| sets.partition_point(|entry| entry[0] < label));
        let (a, b) = (root(sets, a), root(sets, b));
        if let Some([_, parent]) = sets.get_mut(a.max(b)) {
            *parent = a.min(b) as u64;
        }
    }
    for i in 0..labels {
        let root = root(sets, i) as u64;
        sets.put(i, [sets.at(i)[0], root]);
    }
    for i in 0..labels {
        let [label, root] = sets.at(i);
        sets.put(i, [label, sets.at(root as usize)[0]]);
    }
    Ok(labels)
}

/// The final label of a label that the map holds.
pub(super) fn final_label(map: &[[u64; 2]], label: u64) -> Option<u64> {
    map.binary_search_by_key(&label, |entry| entry[0]).ok().map(|at| map.at(at)[1])
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
