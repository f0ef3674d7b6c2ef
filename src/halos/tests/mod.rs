//! What the tests of halos share.

mod catalogues;
mod groups;
mod hostile;
mod overdensities;
mod sets;
mod slabs;

use std::vec;
use std::vec::Vec;

use super::*;
use crate::exec::{Exec, Serial, Threads};
use crate::pm::Positions;
use crate::real::Real;
use crate::reference::built::Memory;
use crate::scratch::Layout;
use crate::status::{Error, Result};

/// Numbers in no order.
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let x = self.0;
        (x ^ (x >> 29)).wrapping_mul(0xbf58_476d_1ce4_e5b9) >> 20
    }

    /// In [0, 1).
    fn unit(&mut self) -> f64 {
        self.next() as f64 / (1_u64 << 44) as f64
    }

    fn below(&mut self, n: usize) -> usize {
        (self.unit() * n as f64) as usize
    }

    /// Normal, roughly.
    fn normal(&mut self) -> f64 {
        (0..12).map(|_| self.unit()).sum::<f64>() - 6.0
    }
}

fn home<T: Real>(x: f64, box_size: f64) -> T {
    let x = T::from_f64(x.rem_euclid(box_size));
    if x.to_f64() < box_size { x } else { T::ZERO }
}

fn labels_of<T: Real>(
    places: &[[T; 3]],
    ids: Option<&[u64]>,
    box_size: f64,
    length: f64,
    exec: &dyn Exec,
) -> Result<Vec<u64>> {
    let mut labels = vec![u64::MAX; places.len()];
    let mut memory = Memory::new(fof_labels_scratch::<T>(places.len())?);
    let positions = Positions::triples(places.as_flattened())?;
    fof_labels(&mut labels, &positions, ids, box_size, length, memory.get(), exec)?;
    Ok(labels)
}

/// Particles of a box of side 1: clumps of all densities, in a thin background.
fn clumps<T: Real>(random: &mut Random, particles: usize) -> Vec<[T; 3]> {
    let mut places = Vec::with_capacity(particles);
    while places.len() < particles {
        let centre = [random.unit(), random.unit(), random.unit()];
        let members = 1 + random.below(1 + particles / 8);
        let size = 0.2 * random.unit().powi(4);
        for _ in 0..members.min(particles - places.len()) {
            places.push(centre.map(|x| home(x + size * random.normal(), 1.0)));
        }
        places.push([random.unit(), random.unit(), random.unit()].map(|x| home(x, 1.0)));
    }
    places.truncate(particles);
    places
}
