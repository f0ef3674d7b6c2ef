//! The cases of groups, halos and spherical overdensities.

use fixpair::cosmology::Cosmology;
use fixpair::exec::Serial;
use fixpair::halos::{
    Density, Halo, HaloSums, Overdensity, Shrink, Sphere, fof_labels, fof_labels_scratch, fof_merge,
    fof_relabel, halo_count, halo_sums, halo_sums_merge, halos, halos_finish, halos_scratch, linking_length,
    particle_mass, refine_centres, spheres, spheres_scratch,
};
use fixpair::pm::Positions;
use fixpair::real::Real;
use fixpair::scratch::Layout;

use crate::vectors::{BOX, Cases, Hash, noise};
use crate::vectors_real::Memory;

const PARTICLES: usize = 400;

/// The first of them lie in clumps.
const CLUMPED: usize = 300;
const CLUMPS: usize = 10;
const THREADED: usize = 350;

const MASS: f64 = 1e10;
const LEAST_MEMBERS: u64 = 10;

/// Where the second slab begins.
const BORDER: f64 = 80.0;

const DENSITIES: [f64; 3] = [50.0, 200.0, 1000.0];

/// What is the same in both precisions.
pub(crate) fn halo_scalars(cases: &mut Cases) {
    let length = linking_length(0.2, BOX, PARTICLES as u64).expect("a length");
    let mass = particle_mass(0.27, BOX, PARTICLES as u64).expect("a mass");
    let kinds = [Overdensity::Mean(200.0), Overdensity::Critical(200.0), Overdensity::Virial];
    let delta = kinds.map(|kind| kind.over_mean(&Cosmology::goliat(), 0.5).expect("a density"));
    cases.add("linking_length", Hash::new().doubles(&[length]));
    cases.add("particle_mass", Hash::new().doubles(&[mass]));
    cases.add("overdensity", Hash::new().doubles(&delta));
    cases.add("halos_scratch", sizes(Hash::new(), halos_scratch(PARTICLES).expect("scratch")));
}

fn sizes(hash: Hash, layout: Layout) -> Hash {
    hash.integers(&[layout.size as u64, layout.align as u64])
}

/// Component `axis` of particle `i`: ten clumps, one of them on a corner of the box, a thread through the box, and a background.
fn place(i: usize, axis: usize) -> f64 {
    if (CLUMPED..THREADED).contains(&i) {
        return [BOX * (i - CLUMPED) as f64 / 50.0, 77.0, 33.0][axis];
    }
    let clump = i % CLUMPS;
    let centre = if clump == 0 { 0.0 } else { BOX * (noise(7 * clump + axis) + 1.0) / 2.0 };
    let around = centre + 4.0 * noise(3 * i + axis + 9000);
    if i < CLUMPED { around } else { BOX * (noise(3 * i + axis) + 1.0) / 2.0 }
}

fn id(i: usize) -> u64 {
    (i as u64 * 7919) % 100_003
}

fn of_halos(hash: Hash, halos: &[Halo]) -> Hash {
    halos.iter().fold(hash, |hash, halo| {
        hash.integers(&[halo.label, halo.members])
            .doubles(&[halo.mass])
            .doubles(&halo.centre)
            .doubles(&halo.velocity)
            .doubles(&[halo.radius])
            .doubles(&halo.extent)
            .doubles(&[halo.velocity_dispersion])
    })
}

fn of_sums(hash: Hash, sums: &[HaloSums]) -> Hash {
    sums.iter().fold(hash, |hash, sums| {
        hash.integers(&[sums.label, sums.members])
            .doubles(&sums.reference)
            .doubles(&sums.reference_velocity)
            .doubles(&sums.position)
            .doubles(&[sums.position_squared])
            .doubles(&sums.velocity)
            .doubles(&[sums.velocity_squared])
            .doubles(&sums.low)
            .doubles(&sums.high)
    })
}

fn labels_of<T: Real>(places: &[T], ids: Option<&[u64]>, length: f64) -> Vec<u64> {
    let count = places.len() / 3;
    let layout = fof_labels_scratch::<T>(count).expect("scratch");
    let mut labels = vec![0; count];
    let places = Positions::triples(places).expect("triples");
    let mut scratch = Memory::new(layout);
    let scratch = scratch.bytes(layout.size);
    fof_labels(&mut labels, &places, ids, BOX, length, scratch, &Serial).expect("labels");
    labels
}

pub(crate) fn halo_cases<T: Real>(add: &mut dyn FnMut(&str, Hash)) {
    let of = |from: fn(usize, usize) -> f64| -> Vec<T> {
        (0..3 * PARTICLES).map(|i| T::from_f64(from(i / 3, i % 3))).collect()
    };
    let places = of(place);
    let speeds = of(|i, axis| 300.0 * noise(3 * i + axis + 5000));
    let ids: Vec<u64> = (0..PARTICLES).map(id).collect();
    let length = linking_length(0.2, BOX, PARTICLES as u64).expect("a length");
    let labels = labels_of(&places, None, length);
    let named = labels_of(&places, Some(&ids), length);
    let layout = fof_labels_scratch::<T>(PARTICLES).expect("scratch");
    add("fof_labels", sizes(Hash::new(), layout).integers(&labels).integers(&named));

    let [position, velocity] = [&places, &speeds].map(|of| Positions::triples(of).expect("triples"));
    let layout = halos_scratch(PARTICLES).expect("scratch");
    let mut memory = Memory::new(layout);
    let mut list = [Halo::default(); PARTICLES / LEAST_MEMBERS as usize];
    let mut hash = Hash::new();
    let mut count = 0;
    for velocity in [None, Some(&velocity)] {
        let scratch = memory.bytes(layout.size);
        count = halos(&mut list, &named, &position, velocity, BOX, LEAST_MEMBERS, MASS, scratch, &Serial)
            .expect("halos");
        hash = of_halos(hash, &list[..count]);
    }
    assert!(count >= CLUMPS / 2, "there are {count} halos to speak of");
    let groups = halo_count(&named, LEAST_MEMBERS, memory.bytes(layout.size), &Serial).expect("a count");
    assert_eq!(groups, count);
    add("halo_count", Hash::new().integers(&[groups as u64]));
    add("halos", hash);
    let mut sums = [HaloSums::default(); PARTICLES / LEAST_MEMBERS as usize];
    let scratch = memory.bytes(layout.size);
    let groups =
        halo_sums(&mut sums, &named, &position, Some(&velocity), BOX, LEAST_MEMBERS, &[], scratch, &Serial)
            .expect("sums");
    assert_eq!(groups, count);
    add("halo_sums", of_sums(Hash::new(), &sums[..groups]));
    slabs(add, &places, &speeds, &ids, length, &list[..count]);

    let layout = spheres_scratch::<T>(PARTICLES).expect("scratch");
    let mut memory = Memory::new(layout);
    let mut centres: Vec<[f64; 3]> = list[..count].iter().map(|halo| halo.centre).collect();
    let radii: Vec<f64> = list[..count].iter().map(|halo| (2.0 * halo.radius).min(20.0)).collect();
    let shrink = Shrink { factor: 0.975, n_min: 5 };
    let scratch = memory.bytes(layout.size);
    refine_centres(&mut centres, &radii, &position, BOX, &shrink, scratch, &Serial).expect("centres");
    add("refine_centres", Hash::new().doubles(centres.as_flattened()));
    let density = Density { box_size: BOX, particles_total: PARTICLES as u64, particle_mass: MASS, n_min: 5 };
    let mut found = vec![Sphere::default(); 3 * count];
    let scratch = memory.bytes(layout.size);
    spheres(&mut found, &centres, &DENSITIES, &position, &density, scratch, &Serial).expect("spheres");
    assert!(found.iter().any(|sphere| sphere.members > 0));
    let hash = found.iter().fold(sizes(Hash::new(), layout), |hash, sphere| {
        hash.integers(&[sphere.members]).doubles(&[sphere.mass, sphere.radius])
    });
    add("spheres", hash);
}

/// Two ranks with ghosts from each other.
fn slabs<T: Real>(
    add: &mut dyn FnMut(&str, Hash),
    places: &[T],
    speeds: &[T],
    ids: &[u64],
    length: f64,
    whole: &[Halo],
) {
    let home = |i: usize| {
        let x = places[3 * i].to_f64();
        if x < 0.0 { x + BOX } else { x }
    };
    let rank_of = |i: usize| usize::from(home(i) >= BORDER);
    // A little more than the linking length: more ghosts than needed do no harm.
    let near = |i: usize| {
        let (x, l) = (home(i), 1.001 * length);
        (x - BORDER).abs() <= l || x <= l || BOX - x <= l
    };
    let own = [0, 1].map(|rank| (0..PARTICLES).filter(|&i| rank_of(i) == rank).collect::<Vec<_>>());
    let ghosts =
        [0, 1].map(|rank| (0..PARTICLES).filter(|&i| rank_of(i) != rank && near(i)).collect::<Vec<_>>());
    let pick = |of: &[T], which: &[usize]| -> Vec<T> {
        which.iter().flat_map(|&i| of[3 * i..3 * i + 3].to_vec()).collect()
    };
    let mut labels = [0, 1].map(|rank| {
        let all: Vec<usize> = own[rank].iter().chain(&ghosts[rank]).copied().collect();
        let ids: Vec<u64> = all.iter().map(|&i| ids[i]).collect();
        labels_of(&pick(places, &all), Some(&ids), length)
    });
    let mut pairs = Vec::new();
    for rank in 0..2 {
        for (g, &i) in ghosts[rank].iter().enumerate() {
            let there = own[1 - rank].iter().position(|&j| j == i).expect("its owner has it");
            pairs.push([labels[rank][own[rank].len() + g], labels[1 - rank][there]]);
        }
    }
    let mut map = vec![[0; 2]; 2 * pairs.len()];
    let entries = fof_merge(&mut map, &pairs).expect("a map");
    let map = &map[..entries];
    let mut sums = Vec::new();
    let mut hash = Hash::new().integers(map.as_flattened());
    for rank in 0..2 {
        let count = own[rank].len();
        labels[rank].truncate(count);
        let (x, v) = (pick(places, &own[rank]), pick(speeds, &own[rank]));
        let [x, v] = [&x, &v].map(|of| Positions::triples(of).expect("triples"));
        let mut here = vec![HaloSums::default(); count / LEAST_MEMBERS as usize + entries];
        let layout = halos_scratch(count).expect("scratch");
        let mut scratch = Memory::new(layout);
        let scratch = scratch.bytes(layout.size);
        let groups =
            halo_sums(&mut here, &labels[rank], &x, Some(&v), BOX, LEAST_MEMBERS, map, scratch, &Serial)
                .expect("sums");
        sums.extend_from_slice(&here[..groups]);
        fof_relabel(&mut labels[rank], map, &Serial).expect("labels");
        hash = hash.integers(&labels[rank]);
    }
    add("fof_labels.slabs", hash);
    let groups = halo_sums_merge(&mut sums, BOX).expect("sums");
    let mut list = vec![Halo::default(); groups];
    let count = halos_finish(&mut list, &sums[..groups], BOX, LEAST_MEMBERS, MASS).expect("halos");
    let names = |halos: &[Halo]| halos.iter().map(|halo| (halo.label, halo.members)).collect::<Vec<_>>();
    assert_eq!(names(&list[..count]), names(whole));
    add("halos.slabs", of_halos(of_sums(Hash::new(), &sums[..groups]), &list[..count]));
}
