//! Sums over the particles of each group: what a catalogue is made of, and what processes add up where groups reach over their borders.
//!
//! Positions and velocities are summed as differences from those of one particle of the group, positions to their nearest image; so nothing
//! cancels, and a group may lie on the edge of the box. Groups are taken to be smaller than L/2.

use core::sync::atomic::{AtomicBool, Ordering};

use super::members::Members;
use super::periodic::{check_box, check_finite, difference, place};
use super::slabs::{check_map, final_label};
use super::sort::Record;
use crate::exec::Exec;
use crate::pm::columns::Positions;
use crate::real::Real;
use crate::sort::sort_by_key;
use crate::status::{Error, Result};
use crate::within::Within;

/// Sums over particles of one group.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C)]
pub struct HaloSums {
    /// The group.
    pub label: u64,
    /// Particles summed.
    pub members: u64,
    /// Position of one of them, in [0, L).
    pub reference: [f64; 3],
    /// Its velocity.
    pub reference_velocity: [f64; 3],
    /// Sum of d, the difference of each particle's nearest image from the reference.
    pub position: [f64; 3],
    /// Sum of d^2.
    pub position_squared: f64,
    /// Sum of u, the difference of each particle's velocity from the reference's.
    pub velocity: [f64; 3],
    /// Sum of u^2.
    pub velocity_squared: f64,
    /// Least d on each axis.
    pub low: [f64; 3],
    /// Largest d on each axis.
    pub high: [f64; 3],
}

fn square([x, y, z]: [f64; 3]) -> f64 {
    (x * x + y * y) + z * z
}

impl HaloSums {
    /// Sums over the particles of some records, in their order, of one group and not none.
    pub(super) fn of<T: Real>(
        label: u64,
        records: &[Record],
        position: &Positions<'_, T>,
        velocity: Option<&Positions<'_, T>>,
        box_size: f64,
    ) -> Self {
        let read = |record: &Record| {
            let i = record[2] as usize;
            // SAFETY: records are of particles that there are, and there are as many velocities.
            unsafe {
                (
                    place(position, i, box_size).map(T::to_f64),
                    velocity.map_or([0.0; 3], |velocity| velocity.get(i).map(T::to_f64)),
                )
            }
        };
        let Some(first) = records.first() else { return Self::default() };
        let (reference, reference_velocity) = read(first);
        let mut sums =
            Self { label, members: records.len() as u64, reference, reference_velocity, ..Self::default() };
        for record in records {
            let (place, speed) = read(record);
            let d = [0, 1, 2].map(|axis| difference(place[axis], reference[axis], box_size));
            let u = [0, 1, 2].map(|axis| speed[axis] - reference_velocity[axis]);
            for axis in 0..3 {
                sums.position[axis] += d[axis];
                sums.velocity[axis] += u[axis];
                sums.low[axis] = sums.low[axis].min(d[axis]);
                sums.high[axis] = sums.high[axis].max(d[axis]);
            }
            sums.position_squared += square(d);
            sums.velocity_squared += square(u);
        }
        sums
    }

    /// Adds sums of other particles of the group, and keeps the reference.
    fn add(&mut self, other: &Self, box_size: f64) {
        let n = other.members as f64;
        let s = [0, 1, 2].map(|axis| difference(other.reference[axis], self.reference[axis], box_size));
        let t = [0, 1, 2].map(|axis| other.reference_velocity[axis] - self.reference_velocity[axis]);
        let dot = |a: [f64; 3], b: [f64; 3]| (a[0] * b[0] + a[1] * b[1]) + a[2] * b[2];
        self.position_squared += other.position_squared + 2.0 * dot(s, other.position) + n * square(s);
        self.velocity_squared += other.velocity_squared + 2.0 * dot(t, other.velocity) + n * square(t);
        for axis in 0..3 {
            self.position[axis] += other.position[axis] + n * s[axis];
            self.velocity[axis] += other.velocity[axis] + n * t[axis];
            self.low[axis] = self.low[axis].min(other.low[axis] + s[axis]);
            self.high[axis] = self.high[axis].max(other.high[axis] + s[axis]);
        }
        self.members += other.members;
    }

    /// Everything, so that only equals are interchangeable.
    fn key(&self) -> (u64, u64, [[u64; 3]; 7]) {
        let all = [
            self.reference,
            self.reference_velocity,
            self.position,
            self.velocity,
            self.low,
            self.high,
            [self.position_squared, self.velocity_squared, 0.0],
        ];
        (self.label, self.members, all.map(|triple| triple.map(f64::to_bits)))
    }

    /// Finite, of one particle or more, with its reference in the box?
    pub(super) fn is_sound(&self, box_size: f64) -> bool {
        let triples = [
            self.reference_velocity,
            self.position,
            self.velocity,
            self.low,
            self.high,
            [self.position_squared, self.velocity_squared, 0.0],
        ];
        self.members > 0
            && self.reference.iter().all(|x| (0.0..box_size).contains(x))
            && triples.as_flattened().iter().all(|x| x.is_finite())
    }
}

/// What sums and catalogues check alike.
pub(super) fn check<T: Real>(
    labels: &[u64],
    position: &Positions<'_, T>,
    velocity: Option<&Positions<'_, T>>,
    box_size: f64,
    n_min: u64,
) -> Result<()> {
    check_box::<T>(box_size)?;
    if n_min == 0 {
        return Err(Error::Range);
    }
    let particles = position.len();
    if labels.len() != particles || velocity.is_some_and(|velocity| velocity.len() != particles) {
        return Err(Error::Length);
    }
    Ok(())
}

/// Sums over the particles of each group that has at least `n_min` of them here, and of each, however few, whose label is in `map`, under its
/// final label.
///
/// `sums`: in order of their label; `particles / n_min` of them, and as many as the map has entries, are always enough. `labels`,
/// `position` and `velocity`, if wanted: of the process's own particles, without ghosts. `map`: from [`fof_merge`](super::fof_merge); empty
/// for a whole box. Returns how many there are: groups here, of which several may be parts of one with one final label.
///
/// `scratch`: see [`halos_scratch`](super::halos_scratch).
///
/// # Errors
/// `Length`, also if `sums` is too short; `NotFinite`; `Range` for `n_min` = 0 or the box; `Table` for the map; `Overflow`, `Scratch`,
/// `Alignment`; `Hook`, after which sums are undefined, as they are after `NotFinite` for velocities whose squares no number holds.
///
/// The same bits for any number of threads.
///
/// # Example
/// ```
/// use fixpair::exec::Serial;
/// use fixpair::halos::fof_labels;
/// use fixpair::pm::Positions;
/// # #[repr(align(64))] struct Memory([u8; 1 << 16]);
/// # let mut memory = Memory([0; 1 << 16]);
/// # let scratch = &mut memory.0;
///
/// let position = Positions::triples(&[9.9_f64, 5.0, 5.0, 0.1, 5.0, 5.0, 5.0, 5.0, 5.0])?; // two are friends over the edge
/// let mut labels = [0; 3];
/// fof_labels(&mut labels, &position, None, 10.0, 0.5, scratch, &Serial)?;
/// use fixpair::halos::{HaloSums, halo_sums};
///
/// let mut sums = [HaloSums::default(); 2];
/// let groups = halo_sums(&mut sums, &labels, &position, None, 10.0, 2, &[], scratch, &Serial)?;
/// assert!(groups == 1 && sums[0].members == 2); // of this process
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn halo_sums<T: Real>(
    sums: &mut [HaloSums],
    labels: &[u64],
    position: &Positions<'_, T>,
    velocity: Option<&Positions<'_, T>>,
    box_size: f64,
    n_min: u64,
    map: &[[u64; 2]],
    scratch: &mut [u8],
    exec: &dyn Exec,
) -> Result<usize> {
    check(labels, position, velocity, box_size, n_min)?;
    check_map(map)?;
    let keep = |label, members| members >= n_min || final_label(map, label).is_some();
    let members = Members::new(labels, &keep, scratch, exec)?;
    let groups = members.groups();
    let sums = sums.get_mut(..groups).ok_or(Error::Length)?;
    check_finite(position, exec)?;
    velocity.map_or(Ok(()), |velocity| check_finite(velocity, exec))?;
    let lost = AtomicBool::new(false);
    members.write(sums, exec, &|label, records| {
        let label = final_label(map, label).unwrap_or(label);
        let sums = HaloSums::of(label, records, position, velocity, box_size);
        if !sums.is_sound(box_size) {
            lost.store(true, Ordering::Relaxed);
        }
        sums
    })?;
    if lost.into_inner() {
        return Err(Error::NotFinite);
    }
    sort_by_key(sums, |sums| sums.label);
    Ok(groups)
}

/// Adds up sums of the same label, from all processes: the first entries become one for each group, in order of their label. Returns how many.
///
/// # Errors
/// `NotFinite` for a number in `sums`; `Range` for the box, for a reference outside it, or for no members; `Overflow` for 2^64 members and more. Nothing
/// is then changed.
///
/// The same bits whatever the order of the sums; other than those of [`halos`](super::halos) of the whole by rounding.
///
/// # Example
/// ```
/// use fixpair::exec::Serial;
/// use fixpair::halos::fof_labels;
/// use fixpair::pm::Positions;
/// # #[repr(align(64))] struct Memory([u8; 1 << 16]);
/// # let mut memory = Memory([0; 1 << 16]);
/// # let scratch = &mut memory.0;
///
/// let position = Positions::triples(&[9.9_f64, 5.0, 5.0, 0.1, 5.0, 5.0, 5.0, 5.0, 5.0])?; // two are friends over the edge
/// let mut labels = [0; 3];
/// fof_labels(&mut labels, &position, None, 10.0, 0.5, scratch, &Serial)?;
/// use fixpair::halos::{HaloSums, halo_sums, halo_sums_merge};
///
/// let mut sums = [HaloSums::default(); 2];
/// halo_sums(&mut sums[..1], &labels, &position, None, 10.0, 2, &[], scratch, &Serial)?;
/// sums[1] = sums[0]; // another process's part of the group
/// assert_eq!(halo_sums_merge(&mut sums, 10.0)?, 1);
/// assert_eq!(sums[0].members, 4);
/// # Ok::<(), fixpair::status::Error>(())
/// ```
pub fn halo_sums_merge(sums: &mut [HaloSums], box_size: f64) -> Result<usize> {
    check_sums(sums, box_size)?;
    sums.iter().try_fold(0_u64, |total, one| total.checked_add(one.members)).ok_or(Error::Overflow)?;
    sort_by_key(sums, HaloSums::key);
    let mut groups = 0;
    for i in 0..sums.len() {
        let one = sums.at(i);
        match sums.part_mut(..groups).last_mut() {
            Some(last) if last.label == one.label => last.add(&one, box_size),
            _ => {
                sums.put(groups, one);
                groups += 1;
            }
        }
    }
    Ok(groups)
}

pub(super) fn check_sums(sums: &[HaloSums], box_size: f64) -> Result<()> {
    check_box::<f64>(box_size)?;
    for one in sums {
        if one.reference.iter().any(|x| !x.is_finite()) {
            return Err(Error::NotFinite);
        }
        if !one.is_sound(box_size) {
            let outside = one.members == 0 || one.reference.iter().any(|x| !(0.0..box_size).contains(x));
            return Err(if outside { Error::Range } else { Error::NotFinite });
        }
    }
    Ok(())
}
