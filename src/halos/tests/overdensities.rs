//! Spherical overdensities against all distances and against profiles in closed form.

use super::spheres::{Density, Sphere, radius};
use super::*;
use crate::cosmology::Cosmology;
use crate::reference;

fn grown<T: Real>(
    places: &[[T; 3]],
    centres: &[[f64; 3]],
    deltas: &[f64],
    density: &Density,
    exec: &dyn Exec,
) -> Result<Vec<Sphere>> {
    let mut out = vec![Sphere::default(); centres.len() * deltas.len()];
    let mut memory = Memory::new(spheres_scratch::<T>(places.len())?);
    let x = Positions::triples(places.as_flattened())?;
    spheres(&mut out, centres, deltas, &x, density, memory.get(), exec)?;
    Ok(out)
}

fn density(particles: usize, n_min: u64) -> Density {
    Density { box_size: 1.0, particles_total: particles as u64, particle_mass: 3.0, n_min }
}

#[test]
fn spheres_are_those_of_all_distances() {
    let mut random = Random(31);
    let deltas = [200.0, 30.0, 2.0];
    let (mut found, mut thin) = (0, 0);
    for _ in 0..80 {
        let particles = 1 + random.below(500);
        let places = clumps::<f32>(&mut random, particles);
        let centres: Vec<[f64; 3]> = (0..10)
            .map(|i| {
                let place = places[random.below(particles)].map(f64::from);
                if i < 7 { place } else { place.map(|x| home(x + 0.02 * random.normal(), 1.0)) }
            })
            .collect();
        let n_min = 1 + random.below(20) as u64;
        let spheres = grown(&places, &centres, &deltas, &density(particles, n_min), &Serial).unwrap();
        for (i, sphere) in spheres.iter().enumerate() {
            let of = |k| radius(k, deltas[i % 3], 1.0, particles as u64);
            let expected = reference::fof::members(&places, centres[i / 3], 1.0, n_min, of);
            assert_eq!(sphere.members, expected.unwrap_or(0));
            let full = Sphere {
                members: sphere.members,
                mass: 3.0 * sphere.members as f64,
                radius: of(sphere.members),
            };
            assert_eq!(*sphere, expected.map_or(Sphere::default(), |_| full));
            found += usize::from(expected.is_some());
            thin += usize::from(expected.is_none());
        }
    }
    assert!(found > 500 && thin > 300, "{found} dense, {thin} not");
}

#[test]
fn a_singular_isothermal_sphere_has_the_radius_of_its_closed_form() {
    // M(<r) = r/step: one particle at each multiple of the step, to the edge of the halo.
    let mut random = Random(32);
    let (members, step) = (4000, 5e-5);
    let centre = [0.999, 0.5, 0.001];
    let places: Vec<[f64; 3]> = (1..=members)
        .map(|i| {
            let direction = [random.normal(), random.normal(), random.normal()];
            let norm = direction.iter().map(|x| x * x).sum::<f64>().sqrt();
            [0, 1, 2].map(|axis| home(centre[axis] + step * i as f64 * direction[axis] / norm, 1.0))
        })
        .collect();
    let total = 20_000_u64;
    let density = Density { box_size: 1.0, particles_total: total, particle_mass: 1.0, n_min: 20 };
    for delta in [100.0, 200.0, 500.0] {
        let sphere = grown(&places, &[centre], &[delta], &density, &Serial).unwrap()[0];
        // r/step = (4 pi/3) r^3 delta N.
        let expected = (3.0 / (4.0 * std::f64::consts::PI * delta * total as f64 * step)).sqrt();
        // Counts are whole: k <= c k^(1/3) < k + 1 holds first up to 3/2 below the root, that is half a step of radius.
        assert!((sphere.members as f64 - expected / step).abs() <= 1.5, "{sphere:?}, {expected}");
        assert!((sphere.radius - expected).abs() <= 0.51 * step, "{sphere:?}, {expected}");
        let mean = sphere.members as f64 / (4.0 / 3.0 * std::f64::consts::PI * sphere.radius.powi(3));
        assert!((mean / (delta * total as f64) - 1.0).abs() < 1e-14, "the mean density is exact to rounding");
    }
}

#[test]
fn spheres_and_refined_centres_are_the_same_bits_on_any_number_of_threads() {
    let mut random = Random(33);
    let places = clumps::<f32>(&mut random, 40_000);
    let centres: Vec<[f64; 3]> = (0..200).map(|i| places[100 * i].map(f64::from)).collect();
    let run = |exec: &dyn Exec| {
        let spheres = grown(&places, &centres, &[200.0, 500.0], &density(40_000, 20), exec).unwrap();
        (spheres, refined(&places, &centres, 0.05, exec).unwrap())
    };
    let expected = run(&Serial);
    for threads in [2, 5] {
        assert!(run(&Threads::new(threads).unwrap()) == expected);
    }
}

fn refined<T: Real>(
    places: &[[T; 3]],
    centres: &[[f64; 3]],
    radius: f64,
    exec: &dyn Exec,
) -> Result<Vec<[f64; 3]>> {
    let mut centres = centres.to_vec();
    let mut memory = Memory::new(spheres_scratch::<T>(places.len())?);
    let x = Positions::triples(places.as_flattened())?;
    let radii = vec![radius; centres.len()];
    let shrink = Shrink { factor: 0.95, n_min: 50 };
    refine_centres(&mut centres, &radii, &x, 1.0, &shrink, memory.get(), exec)?;
    Ok(centres)
}

#[test]
fn shrinking_spheres_find_the_peak_beside_a_companion() {
    // An isothermal halo on the edge of the box, and a looser companion of half its mass that draws the centre of mass away.
    let mut random = Random(34);
    let mut halo = |members: usize, centre: [f64; 3], size: f64| -> Vec<[f64; 3]> {
        let mut place = || {
            let direction = [random.normal(), random.normal(), random.normal()];
            let norm = direction.iter().map(|x| x * x).sum::<f64>().sqrt();
            let r = size * random.unit();
            [0, 1, 2].map(|axis| home(centre[axis] + r * direction[axis] / norm, 1.0))
        };
        (0..members).map(|_| place()).collect()
    };
    let peak = [0.999, 0.5, 0.001];
    let mut places = halo(2000, peak, 0.01);
    places.extend(halo(1000, [0.019, 0.5, 0.001], 0.02));
    let away = [0.005, 0.5, 0.001];
    let centre = refined(&places, &[away, [0.4; 3]], 0.04, &Serial).unwrap();
    // The last sphere has 50 of 2000 particles, a radius of 0.025 sizes: its centre is nearer to the peak than that.
    for axis in 0..3 {
        let apart = (centre[0][axis] - peak[axis]).abs();
        assert!(apart.min(1.0 - apart) < 0.025 * 0.01, "{centre:?}");
    }
    assert_eq!(centre[1], [0.4; 3], "where there is nothing a centre stays");
}

#[test]
fn overdensities_are_those_of_bryan_and_norman() {
    let flat = Cosmology::flat(0.3, 0.05, 0.7, 1.0);
    let at = |overdensity: Overdensity, a| overdensity.over_mean(&flat, a).unwrap();
    // Delta_c = 18 pi^2 - 82 0.7 - 39 0.49 = 101.14.
    assert!((at(Overdensity::Virial, 1.0) - 101.142_6 / 0.3).abs() < 1e-2);
    assert!((at(Overdensity::Virial, 1e-4) - 18.0 * std::f64::consts::PI.powi(2)).abs() < 1e-6);
    assert!((at(Overdensity::Critical(200.0), 1.0) - 200.0 / 0.3).abs() < 1e-9);
    assert_eq!(at(Overdensity::Mean(200.0), 0.5), 200.0);
    let open = Cosmology { omega_de: 0.0, ..flat };
    let expected = 18.0 * std::f64::consts::PI.powi(2) - 60.0 * 0.7 - 32.0 * 0.49;
    assert!((Overdensity::Virial.over_mean(&open, 1.0).unwrap() - expected / 0.3).abs() < 1e-9);
    let curved = Cosmology { omega_de: 0.6, ..flat };
    assert_eq!(Overdensity::Virial.over_mean(&curved, 1.0), Err(Error::Range));
    assert_eq!(Overdensity::Mean(0.0).over_mean(&flat, 1.0), Err(Error::Range));
    assert_eq!(Overdensity::Critical(f64::NAN).over_mean(&flat, 1.0), Err(Error::NotFinite));
}

#[test]
fn a_particle_of_the_paper_has_its_mass() {
    // arXiv:2204.11103: 5.58e11 Msun/h for 512^3 in 1 Gpc/h, Om = 0.27.
    let mass = particle_mass(0.27, 1000.0, 1 << 27).unwrap();
    assert!((mass / 5.58e11 - 1.0).abs() < 1e-3, "{mass:e}");
    assert!((overdensity::CRITICAL_DENSITY / 2.775_366_27e11 - 1.0).abs() < 1e-8);
    assert_eq!(particle_mass(0.27, 1000.0, 0), Err(Error::Range));
    assert_eq!(particle_mass(f64::NAN, 1000.0, 1), Err(Error::NotFinite));
}

#[test]
fn what_is_wrong_is_refused() {
    let places = [[0.5_f64; 3]; 4];
    let refused = |centre: f64, delta: f64, density: Density| {
        grown(&places, &[[centre; 3]], &[delta], &density, &Serial).unwrap_err()
    };
    let good = density(4, 1);
    assert_eq!(refused(f64::NAN, 200.0, good), Error::NotFinite);
    assert_eq!(refused(0.5, 1.9, good), Error::Range);
    assert_eq!(refused(0.5, 200.0, Density { n_min: 0, ..good }), Error::Range);
    assert_eq!(refused(0.5, 200.0, Density { particles_total: 3, ..good }), Error::Range);
    assert_eq!(refused(0.5, 200.0, Density { particle_mass: -1.0, ..good }), Error::Range);
    assert_eq!(refused(0.5, 200.0, Density { box_size: 0.0, ..good }), Error::Range);
    assert_eq!(
        grown(&[[f64::NAN; 3]], &[[0.5; 3]], &[200.0], &density(1, 1), &Serial),
        Err(Error::NotFinite)
    );
    assert_eq!(refined(&places, &[[0.5; 3]], -0.1, &Serial), Err(Error::Range));
    assert_eq!(refined(&places, &[[0.4; 3]], 9.0, &Serial), refined(&places, &[[0.4; 3]], 0.25, &Serial));
    assert_eq!(refined(&places, &[[0.5; 3]], f64::NAN, &Serial), Err(Error::NotFinite));
    assert_eq!(grown(&places, &[], &[], &good, &Serial), Ok(vec![]));
}
