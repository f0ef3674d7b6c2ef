//! Halos of particles, counted in bins of their number of particles.
//!
//! Groups of friends with b = 0.2; and around each group, spheres of 200 times the mean density: a group's centre of mass is moved to its
//! densest place by shrinking spheres, and of spheres whose centre lies in a larger one only the larger counts.

use fixpair::exec::Exec;
use fixpair::halos::{
    Density, Halo, Shrink, Sphere, fof_labels, fof_labels_scratch, halos, halos_scratch, linking_length,
    refine_centres, spheres, spheres_scratch,
};
use fixpair::pm::Positions;

use crate::Failure;
use crate::memory::Memory;
use crate::run::Snapshot;

/// Fewest particles of a group, and of a sphere.
pub(crate) const LEAST: u64 = 20;

/// Overdensity of spheres, over mean matter.
const OVERDENSITY: f64 = 200.0;

/// Edges of the bins, in particles: five a decade, one of them 100.
pub(crate) fn edges() -> Vec<u64> {
    (-3..=15).map(|i| (100.0 * 10_f64.powf(0.2 * f64::from(i))).round() as u64).collect()
}

/// Halos in each bin: groups of friends, and spheres.
pub(crate) type Counts = [Vec<u64>; 2];

/// Finds the halos of a snapshot.
pub(crate) fn count(snapshot: &Snapshot<'_>, exec: &dyn Exec) -> Result<Counts, Failure> {
    let groups = groups(snapshot, exec)?;
    let members: Vec<u64> = groups.iter().map(|halo| halo.members).collect();
    Ok([histogram(&members), histogram(&masses(snapshot, &groups, exec)?)])
}

fn histogram(members: &[u64]) -> Vec<u64> {
    let edges = edges();
    let within = |edge: &[u64]| members.iter().filter(|&&n| (edge[0]..edge[1]).contains(&n)).count() as u64;
    edges.windows(2).map(within).collect()
}

fn groups(snapshot: &Snapshot<'_>, exec: &dyn Exec) -> Result<Vec<Halo>, Failure> {
    let position = Positions::triples(snapshot.position)?;
    let (box_size, particles) = (snapshot.box_size, position.len());
    let mut labels = vec![0; particles];
    let length = linking_length(0.2, box_size, particles as u64)?;
    let mut scratch = Memory::new(fof_labels_scratch::<f32>(particles)?);
    fof_labels(&mut labels, &position, None, box_size, length, scratch.bytes(), exec)?;
    drop(scratch);
    let mut groups = vec![Halo::default(); particles / LEAST as usize];
    let mut scratch = Memory::new(halos_scratch(particles)?);
    // Masses are kept in particles.
    let found = halos(&mut groups, &labels, &position, None, box_size, LEAST, 1.0, scratch.bytes(), exec)?;
    groups.truncate(found);
    Ok(groups)
}

/// Particles of the spheres of halos that are not part of larger ones.
fn masses(snapshot: &Snapshot<'_>, groups: &[Halo], exec: &dyn Exec) -> Result<Vec<u64>, Failure> {
    let position = Positions::triples(snapshot.position)?;
    let (box_size, particles) = (snapshot.box_size, position.len());
    let mut centres: Vec<_> = groups.iter().map(|halo| halo.centre).collect();
    let radii: Vec<_> = groups.iter().map(|halo| 2.0 * halo.radius).collect();
    let shrink = Shrink { factor: 0.9, n_min: LEAST };
    let mut scratch = Memory::new(spheres_scratch::<f32>(particles)?);
    refine_centres(&mut centres, &radii, &position, box_size, &shrink, scratch.bytes(), exec)?;
    drop(scratch);
    let density = Density { box_size, particles_total: particles as u64, particle_mass: 1.0, n_min: LEAST };
    let mut found = vec![Sphere::default(); centres.len()];
    let mut scratch = Memory::new(spheres_scratch::<f32>(particles)?);
    spheres(&mut found, &centres, &[OVERDENSITY], &position, &density, scratch.bytes(), exec)?;
    Ok(distinct(&found, &centres, box_size))
}

/// Members of the spheres whose centre is in no larger sphere: by cells of the largest diameter, so that only neighbours meet.
fn distinct(spheres: &[Sphere], centres: &[[f64; 3]], box_size: f64) -> Vec<u64> {
    let reach = spheres.iter().map(|sphere| sphere.radius).fold(0.0, f64::max);
    // No more cells than spheres: memory is theirs.
    let most = (spheres.len() as f64).cbrt() as usize;
    let side = ((box_size / reach) as usize).min(most).max(1);
    let cell = |centre: &[f64; 3]| centre.map(|x| ((x / box_size * side as f64) as usize).min(side - 1));
    let index = |[x, y, z]: [usize; 3]| (x * side + y) * side + z;
    let mut cells = vec![Vec::new(); side.pow(3)];
    let mut order: Vec<usize> = (0..spheres.len()).collect();
    order.sort_by_key(|&i| (std::cmp::Reverse(spheres[i].members), i));
    let mut members = Vec::new();
    for i in order {
        let home = cell(&centres[i]);
        let hidden = neighbours(home, side).any(|near| {
            cells[index(near)].iter().any(|&larger: &usize| {
                let square: f64 = (0..3)
                    .map(|axis| {
                        let d = (centres[i][axis] - centres[larger][axis]).abs();
                        d.min(box_size - d).powi(2)
                    })
                    .sum();
                square < spheres[larger].radius.powi(2)
            })
        });
        if !hidden && spheres[i].members > 0 {
            cells[index(home)].push(i);
            members.push(spheres[i].members);
        }
    }
    members
}

/// A cell and those around it, each once.
fn neighbours(home: [usize; 3], side: usize) -> impl Iterator<Item = [usize; 3]> {
    let around = move |axis: usize| {
        let mut near = [side - 1, 0, 1].map(|step| (home[axis] + step) % side).to_vec();
        near.sort_unstable();
        near.dedup();
        near
    };
    let [x, y, z] = [0, 1, 2].map(around);
    x.into_iter().flat_map(move |x| {
        let z = z.clone();
        y.clone().into_iter().flat_map(move |y| z.clone().into_iter().map(move |z| [x, y, z]))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sphere_counts_unless_its_centre_is_in_a_larger_one() {
        let sphere = |members, radius| Sphere { members, mass: 0.0, radius };
        let spheres = [sphere(30, 1.0), sphere(100, 2.0), sphere(25, 1.0), sphere(0, 0.0), sphere(40, 1.5)];
        // The first is across the periodic border from the second; the last has the second's border in it, but not its centre.
        let centres = [[99.5, 0.5, 50.0], [0.5, 0.5, 50.0], [20.0; 3], [30.0; 3], [3.0, 0.5, 50.0]];
        assert_eq!(distinct(&spheres, &centres, 100.0), [100, 40, 25]);
    }

    #[test]
    fn every_cell_has_its_neighbours_once() {
        assert_eq!(neighbours([0, 0, 0], 1).count(), 1);
        assert_eq!(neighbours([0, 1, 0], 2).count(), 8);
        assert_eq!(neighbours([4, 0, 2], 5).count(), 27);
    }

    #[test]
    fn bins_begin_at_one_hundred_particles() {
        assert!(edges().contains(&100));
        assert!(edges()[0] >= LEAST);
        assert_eq!(histogram(&[99, 100, 100, 157]).iter().sum::<u64>(), 4);
    }
}
