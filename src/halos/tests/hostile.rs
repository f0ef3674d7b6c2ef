//! Particles as no simulation should have them: right answers or a status, in bounded time.

use super::*;

/// A catalogue of all particles as one group, or why not.
fn one_group<T: Real>(places: &[[T; 3]], speeds: &[[T; 3]], mass: f64) -> Result<Vec<Halo>> {
    let mut halos_of = vec![Halo::default(); places.len()];
    let labels = vec![0; places.len()];
    let position = Positions::triples(places.as_flattened())?;
    let velocity = Positions::triples(speeds.as_flattened())?;
    let mut memory = Memory::new(halos_scratch(places.len())?);
    let count =
        halos(&mut halos_of, &labels, &position, Some(&velocity), 1.0, 1, mass, memory.get(), &Serial)?;
    halos_of.truncate(count);
    Ok(halos_of)
}

fn grown(places: &[[f64; 3]], centre: [f64; 3], n_min: u64) -> Result<Sphere> {
    let mut sphere = [Sphere::default()];
    let position = Positions::triples(places.as_flattened())?;
    let mut memory = Memory::new(spheres_scratch::<f64>(places.len())?);
    let density =
        Density { box_size: 1.0, particles_total: 1 + places.len() as u64, particle_mass: 2.0, n_min };
    spheres(&mut sphere, &[centre], &[200.0], &position, &density, memory.get(), &Serial)?;
    Ok(sphere[0])
}

#[test]
fn a_quarter_of_a_million_particles_in_one_cell_cost_no_pairs() {
    // All pairs would be 3 10^10 distances, minutes.
    let mut random = Random(5);
    let particles = 1 << 18;
    let places: Vec<[f32; 3]> =
        (0..particles).map(|_| [0.25, 0.5, 0.75].map(|x| x + 0.004 * random.unit() as f32)).collect();
    let labels = labels_of(&places, None, 1.0, 0.01, &Serial).unwrap();
    assert!(labels.iter().all(|&label| label == 0));
    let halos = one_group(&places, &places, 1.0).unwrap();
    assert_eq!(halos[0].members, particles as u64);
    assert!(halos[0].extent.iter().all(|&extent| extent <= 0.004 + 1e-6));
}

#[test]
fn coincident_particles_have_one_sphere_and_one_centre() {
    let places = vec![[0.1, 0.2, 0.3]; 5000];
    let sphere = grown(&places, places[0], 10).unwrap();
    // All lie at distance 0, and 5000 are as dense as 200 times the mean at a radius that a box of 1 holds.
    assert_eq!(sphere.members, 5000);
    let volume = 4.0 / 3.0 * core::f64::consts::PI * sphere.radius.powi(3);
    assert!((5000.0 / volume / (200.0 * 5001.0) - 1.0).abs() < 1e-14);
    let mut centres = [[0.1 + 1e-3, 0.2, 0.3]];
    let position = Positions::triples(places.as_flattened()).unwrap();
    let mut memory = Memory::new(spheres_scratch::<f64>(places.len()).unwrap());
    let shrink = Shrink { factor: 0.9, n_min: 10 };
    refine_centres(&mut centres, &[0.05], &position, 1.0, &shrink, memory.get(), &Serial).unwrap();
    for axis in 0..3 {
        // A mean of equal numbers.
        assert!((centres[0][axis] - places[0][axis]).abs() < 1e-15);
    }
}

#[test]
fn none_and_one_particle_are_a_simulation_too() {
    assert_eq!(labels_of::<f64>(&[], None, 1.0, 0.1, &Serial), Ok(vec![]));
    assert_eq!(labels_of(&[[0.5_f32; 3]], Some(&[u64::MAX]), 1.0, 0.1, &Serial), Ok(vec![u64::MAX]));
    assert_eq!(one_group::<f64>(&[], &[], 1.0), Ok(vec![]));
    let alone = one_group(&[[0.5, 0.25, 0.0]], &[[1.0, -2.0, 3.0]], 7.0).unwrap()[0];
    assert_eq!((alone.members, alone.mass, alone.radius, alone.velocity_dispersion), (1, 7.0, 0.0, 0.0));
    assert_eq!((alone.centre, alone.velocity), ([0.5, 0.25, 0.0], [1.0, -2.0, 3.0]));
    assert_eq!(grown(&[], [0.5; 3], 1), Ok(Sphere::default()));
    assert_eq!(grown(&[[0.0; 3]], [0.5; 3], 1), Ok(Sphere::default()), "too far away");
    assert_eq!(grown(&[[0.0; 3]], [1.0, 0.0, 0.0], 1).unwrap().members, 1);
}

#[test]
fn places_at_the_ends_of_the_number_range_are_in_the_box() {
    let tiny = f32::MIN_POSITIVE * f32::EPSILON;
    for x in [0.0, -0.0, tiny, -tiny, 1.0, 1.0_f32.next_down(), 1e30, -1e30, f32::MAX, f32::MIN] {
        let home = [x, 0.5, 0.5];
        // Powers of two apart: a remainder by 1 of a large f32 is 0, and so is what rounds to the far edge.
        let there = if x > 0.5 && x < 1.0 { [x, 0.5, 0.5] } else { [0.0, 0.5, 0.5] };
        let far = [0.5_f32; 3];
        let labels = labels_of(&[there, home, far], None, 1.0, 0.1, &Serial).unwrap();
        assert_eq!(labels, [0, 0, 2], "{x:e}");
        let halo = one_group(&[home], &[far], 1.0).unwrap()[0];
        assert!((0.0..1.0).contains(&halo.centre[0]), "{x:e}");
    }
}

#[test]
fn velocities_are_summed_or_refused() {
    let places = [[0.5_f32; 3]; 2];
    let fast = one_group(&places, &[[f32::MAX; 3], [f32::MIN; 3]], 1.0).unwrap()[0];
    let expected = f64::from(f32::MAX) * 3.0_f64.sqrt();
    assert!((fast.velocity_dispersion / expected - 1.0).abs() < 1e-14);
    assert_eq!(fast.velocity, [0.0; 3]);
    // Their squares are beyond the numbers.
    let places = [[0.5_f64; 3]; 2];
    for speed in [1e160, 1e200, f64::MAX] {
        let speeds = [[speed; 3], [-speed; 3]];
        assert_eq!(one_group(&places, &speeds, 1.0), Err(Error::NotFinite), "{speed:e}");
        let mut sums = [HaloSums::default(); 2];
        let position = Positions::triples(places.as_flattened()).unwrap();
        let velocity = Positions::triples(speeds.as_flattened()).unwrap();
        let mut memory = Memory::new(halos_scratch(2).unwrap());
        let scratch = memory.get();
        let result = halo_sums(&mut sums, &[3; 2], &position, Some(&velocity), 1.0, 1, &[], scratch, &Serial);
        assert_eq!(result, Err(Error::NotFinite), "{speed:e}");
    }
    assert_eq!(one_group(&places, &[[0.0; 3]; 2], 1e300), Err(Error::Range), "2^64 particles are too heavy");
}

#[test]
fn what_32_bits_cannot_number_is_refused() {
    for particles in [1 << 32, 10_000_000_000, usize::MAX] {
        assert_eq!(fof_labels_scratch::<f64>(particles), Err(Error::Overflow));
        assert_eq!(spheres_scratch::<f32>(particles), Err(Error::Overflow));
        assert_eq!(halos_scratch(particles), Err(Error::Overflow));
    }
    let most = u32::MAX as usize;
    assert!(fof_labels_scratch::<f64>(most).is_ok_and(|layout| layout.size < 36 * most + 5_300_000));
    assert!(halos_scratch(most).is_ok_and(|layout| layout.size < 12 * most + 5_300_000));
    assert!(spheres_scratch::<f32>(most).is_ok_and(|layout| layout.size < 24 * most + 5_300_000));
}
