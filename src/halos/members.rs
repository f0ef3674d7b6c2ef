//! Particles by group: labels sorted, and the groups among them that are wanted.

use super::periodic::span;
use super::sort::{Buckets, Record, Sizes, key, sort};
use crate::exec::{Exec, Shared, for_each_piece};
use crate::scratch::{Arena, Layout};
use crate::status::Result;
use crate::within::Within;

/// 12 bytes a particle, and counters.
pub(super) fn layout(particles: usize) -> Result<Layout> {
    let sizes = Sizes::new(particles)?;
    sizes.and_counters(Layout::EMPTY.and::<Record>(particles)?)?.and::<u32>(sizes.buckets + 1)
}

/// Records of one group lie together, in the order of their particles.
pub(super) struct Members<'a> {
    records: &'a [Record],
    starts: &'a [u32],
    /// First group of each bucket, and how many there are.
    firsts: &'a [u32],
    keep: &'a (dyn Fn(u64, u64) -> bool + Sync),
}

impl<'a> Members<'a> {
    /// Sorts labels, and counts the groups that `keep`, called with label and members, wants.
    pub(super) fn new(
        labels: &[u64],
        keep: &'a (dyn Fn(u64, u64) -> bool + Sync),
        scratch: &'a mut [u8],
        exec: &dyn Exec,
    ) -> Result<Self> {
        let particles = labels.len();
        let mut arena = Arena::new(scratch, layout(particles)?)?;
        let sizes = Sizes::new(particles)?;
        let records = arena.take::<Record>(particles)?;
        let counters = sizes.counters_of(&mut arena)?;
        let firsts = arena.take::<u32>(sizes.buckets + 1)?;
        let starts = sort(records, counters, labels, &sizes, Buckets::Hashed, exec)?;
        firsts.put(sizes.buckets, 0);
        let mut members = Self { records, starts, firsts: &[], keep };
        for_each_piece(exec, firsts.part_mut(..sizes.buckets), 1, &|bucket, first| {
            first.fill(members.of_bucket(bucket).count() as u32);
        })?;
        let mut groups = 0;
        for first in firsts.iter_mut() {
            groups += core::mem::replace(first, groups);
        }
        members.firsts = firsts;
        Ok(members)
    }

    /// Groups that are wanted.
    pub(super) fn groups(&self) -> usize {
        self.firsts.last().map_or(0, |&groups| groups as usize)
    }

    /// The wanted groups of a bucket: labels and records.
    fn of_bucket(&self, bucket: usize) -> impl Iterator<Item = (u64, &[Record])> {
        let mut rest = self.records.part(span(self.starts, bucket));
        let groups = core::iter::from_fn(move || {
            let label = key(rest.first()?);
            let members = rest.iter().take_while(|record| key(record) == label).count();
            let (group, others) = rest.split_at_checked(members)?;
            rest = others;
            Some((label, group))
        });
        groups.filter(|(label, records)| (self.keep)(*label, records.len() as u64))
    }

    /// Writes what `make` makes of each group, in an order that the labels alone determine.
    pub(super) fn write<G: Send>(
        &self,
        to: &mut [G],
        exec: &dyn Exec,
        make: &(dyn Fn(u64, &[Record]) -> G + Sync),
    ) -> Result<()> {
        debug_assert_eq!(to.len(), self.groups());
        let to = Shared::new(to);
        exec.parallel_for(self.starts.len() - 1, &|bucket| {
            for (group, (label, records)) in (self.firsts.at(bucket) as usize..).zip(self.of_bucket(bucket)) {
                // SAFETY: groups were counted by bucket, so each place is written once.
                unsafe { to.part(group, 1)[0] = make(label, records) };
            }
        })
    }
}
