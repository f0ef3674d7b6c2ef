//! Sorting in place, without a panic and without memory.
//!
//! Quicksort with the median of three or of nine as pivot. Slices that halve too slowly fall back to a heap, so the cost is O(n log n) for any
//! values, and short ones are finished by insertion. Equal keys end in no particular order, but always in the same. (The language's own
//! `sort_unstable` compiles to code with panics, for comparisons that contradict each other.)

use crate::within::Within;

/// Slices of this length at most are sorted by insertion.
const SHORT: usize = 20;
/// From this length on the pivot is the median of nine.
const LONG: usize = 128;

/// Sorts values by increasing key.
pub(crate) fn sort_by_key<T: Copy + Default, K: Ord>(values: &mut [T], key: impl Fn(&T) -> K) {
    // Twice as deep as halving would be.
    let depth = 2 * (usize::BITS - values.len().leading_zeros());
    quick_sort(values, &key, None, depth);
}

/// `floor`: a value that none of these comes before.
fn quick_sort<T: Copy + Default, K: Ord>(
    mut values: &mut [T],
    key: &impl Fn(&T) -> K,
    mut floor: Option<T>,
    mut depth: u32,
) {
    while values.len() > SHORT {
        if depth == 0 {
            return heap_sort(values, key);
        }
        depth -= 1;
        let pivot_at = choose_pivot(values, key);
        let pivot = values.at(pivot_at);
        let pivot_key = key(&pivot);
        if floor.is_some_and(|floor| key(&floor) >= pivot_key) {
            // Values equal to the pivot are the least here, and in their places once they are in front.
            let equal = partition(values, |value| key(value) <= pivot_key);
            values = values.part_mut(equal..);
            floor = None;
            continue;
        }
        swap(values, 0, pivot_at);
        let less = partition(values.part_mut(1..), |value| key(value) < pivot_key);
        swap(values, 0, less);
        let Some((low, high)) = values.split_at_mut_checked(less) else { return };
        quick_sort(low, key, floor, depth);
        values = high.part_mut(1..);
        floor = Some(pivot);
    }
    insertion_sort(values, key);
}

#[inline(always)]
fn swap<T: Copy + Default>(values: &mut [T], a: usize, b: usize) {
    let value = values.at(a);
    values.put(a, values.at(b));
    values.put(b, value);
}

fn choose_pivot<T: Copy + Default, K: Ord>(values: &[T], key: &impl Fn(&T) -> K) -> usize {
    let median = |a: usize, b: usize, c: usize| {
        let less = |i: usize, j: usize| key(&values.at(i)) < key(&values.at(j));
        let (low, high) = if less(b, a) { (b, a) } else { (a, b) };
        if less(c, low) {
            low
        } else if less(high, c) {
            high
        } else {
            c
        }
    };
    let last = values.len() - 1;
    if values.len() < LONG {
        return median(0, last / 2, last);
    }
    let near = |i: usize| median(i - 1, i, i + 1);
    median(near(1), near(last / 2), near(last - 1))
}

/// Moves the values that belong to the front there, and returns how many there are. Without a branch on what a value is.
#[inline(always)]
fn partition<T: Copy + Default>(values: &mut [T], is_front: impl Fn(&T) -> bool) -> usize {
    let mut front = 0;
    for i in 0..values.len() {
        let value = values.at(i);
        values.put(i, values.at(front));
        values.put(front, value);
        front += usize::from(is_front(&value));
    }
    front
}

fn insertion_sort<T: Copy + Default, K: Ord>(values: &mut [T], key: &impl Fn(&T) -> K) {
    for i in 1..values.len() {
        let value = values.at(i);
        let value_key = key(&value);
        let mut at = i;
        while at > 0 {
            let before = values.at(at - 1);
            if key(&before) <= value_key {
                break;
            }
            values.put(at, before);
            at -= 1;
        }
        values.put(at, value);
    }
}

fn heap_sort<T: Copy + Default, K: Ord>(values: &mut [T], key: &impl Fn(&T) -> K) {
    for root in (0..values.len() / 2).rev() {
        sink(values, root, key);
    }
    for end in (1..values.len()).rev() {
        swap(values, 0, end);
        sink(values.part_mut(..end), 0, key);
    }
}

/// Lets a value sink until none below it in the heap comes after it.
fn sink<T: Copy + Default, K: Ord>(values: &mut [T], mut at: usize, key: &impl Fn(&T) -> K) {
    let value = values.at(at);
    let value_key = key(&value);
    while 2 * at + 1 < values.len() {
        let left = 2 * at + 1;
        let right = values.get(left + 1).is_some_and(|right| key(&values.at(left)) < key(right));
        let child = left + usize::from(right);
        if key(&values.at(child)) <= value_key {
            break;
        }
        values.put(at, values.at(child));
        at = child;
    }
    values.put(at, value);
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::cell::Cell;
    use std::vec::Vec;

    /// Numbers below a bound, by a linear congruence.
    fn numbers(len: usize, bound: u64) -> Vec<u64> {
        let mut state = 7_u64;
        let mut next = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 33) % bound
        };
        (0..len).map(|_| next()).collect()
    }

    /// Values that pivots are good, bad and useless for.
    fn orders(len: usize) -> [Vec<u64>; 8] {
        let n = len as u64;
        [
            numbers(len, 1 << 31),
            numbers(len, 2 + n / 8),
            numbers(len, 2),
            (0..n).collect(),
            (0..n).rev().collect(),
            (0..n).map(|i| if i < n / 2 { i } else { n - i }).collect(),
            (0..n).map(|i| i % 7).collect(),
            std::vec![3; len],
        ]
    }

    #[test]
    fn every_order_is_sorted_as_the_language_sorts_it() {
        for len in (0..70).chain([127, 128, 129, 1000, 4099]) {
            for values in orders(len) {
                let mut expected = values.clone();
                expected.sort_unstable();
                let mut sorted = values.clone();
                sort_by_key(&mut sorted, |&value| value);
                assert_eq!(sorted, expected, "{len} values");
                let mut sorted = values;
                heap_sort(&mut sorted, &|&value: &u64| value);
                assert_eq!(sorted, expected, "{len} values by a heap");
            }
        }
    }

    #[test]
    fn records_move_with_their_keys() {
        let mut records: Vec<[u64; 2]> = (0..).zip(numbers(5000, 100)).map(|(i, key)| [key, i]).collect();
        let mut expected = records.clone();
        expected.sort_by_key(|record| record[0]);
        sort_by_key(&mut records, |record| (record[0], record[1]));
        assert_eq!(records, expected);
    }

    /// An order made while it is sorted (McIlroy 1999): each value is decided as late as possible, and so that the pivot is bad.
    #[test]
    fn no_order_costs_more_than_n_log_n() {
        let len = 1 << 12;
        let log = 12;
        let keys: Vec<Cell<u64>> = (0..len).map(|_| Cell::new(u64::MAX)).collect();
        let (solid, candidate, compared) = (Cell::new(0), Cell::new(0), Cell::new(0_u64));
        struct Late<'a>(&'a dyn Fn(usize, usize) -> core::cmp::Ordering, usize);
        impl PartialEq for Late<'_> {
            fn eq(&self, other: &Self) -> bool {
                self.cmp(other).is_eq()
            }
        }
        impl Eq for Late<'_> {}
        impl PartialOrd for Late<'_> {
            fn partial_cmp(&self, other: &Self) -> Option<core::cmp::Ordering> {
                Some(self.cmp(other))
            }
        }
        impl Ord for Late<'_> {
            fn cmp(&self, other: &Self) -> core::cmp::Ordering {
                (self.0)(self.1, other.1)
            }
        }
        let freeze = |i: usize| {
            keys[i].set(solid.get());
            solid.set(solid.get() + 1);
        };
        let compare = |a: usize, b: usize| {
            compared.set(compared.get() + 1);
            if a != b && keys[a].get() == u64::MAX && keys[b].get() == u64::MAX {
                freeze(if a == candidate.get() { a } else { b });
            }
            if keys[a].get() == u64::MAX {
                candidate.set(a);
            } else if keys[b].get() == u64::MAX {
                candidate.set(b);
            }
            keys[a].get().cmp(&keys[b].get())
        };
        let mut order: Vec<usize> = (0..len).collect();
        sort_by_key(&mut order, |&i| Late(&compare, i));
        assert!(order.is_sorted_by_key(|&i| keys[i].get()));
        // 2 log n partitions of all values, then a heap, which compares 2 log n times a value.
        assert!(compared.get() < 5 * log * len as u64, "{} comparisons", compared.get());
    }
}
