//! Two meshes, half a cell apart.

use super::*;

/// F_k = sum over cells of m exp(-i k.x) of one mode of a mesh.
fn mode(mesh: &[f64], n: usize, k: [i64; 3]) -> [f64; 2] {
    let mut sum = [0.0; 2];
    for (c, m) in mesh.iter().enumerate() {
        let cell = [c / (n * n), c / n % n, c % n];
        let turns: i64 = (0..3).map(|axis| k[axis] * cell[axis] as i64).sum();
        let angle = -core::f64::consts::TAU * turns as f64 / n as f64;
        sum[0] += m * libm::cos(angle);
        sum[1] += m * libm::sin(angle);
    }
    sum
}

#[test]
fn interlacing_removes_odd_images_and_leaves_the_rest() {
    let n = 8;
    let brick = Brick::whole(n, Space::Fourier).unwrap();
    let region = region_of(n);
    for window in [Window::CloudInCell, Window::TriangularShapedCloud] {
        // Weights of a lattice four times finer are a plane wave with n + 1 periods along x, or n - 2 along z and n + 1 along y.
        for (wave, image, odd) in
            [([n as i64 + 1, 1, 0], [1, 1, 0], true), ([1, n as i64 + 2, n as i64 + 3], [1, 2, 3], false)]
        {
            let fine = 4 * n;
            let mut triples = Vec::new();
            let mut w = Vec::new();
            for c in 0..fine * fine * fine {
                let q = [c / (fine * fine), c / fine % fine, c % fine];
                let turns: i64 = (0..3).map(|axis| wave[axis] * q[axis] as i64).sum();
                triples.extend(q.map(|q| q as f64 / 4.0));
                w.push(libm::cos(core::f64::consts::TAU * turns as f64 / fine as f64));
            }
            let spectrum = |shift: f64| {
                let mesh = put(&region, &triples, Some(&w), &cells(n, window, shift), &Serial).unwrap();
                let mut modes = vec![0.0; brick.reals()];
                for x in 0..n {
                    for y in 0..n {
                        for z in 0..=n / 2 {
                            let k = [Brick::mode(n, x), Brick::mode(n, y), z as i64];
                            let at = 2 * ((x * n + y) * (n / 2 + 1) + z);
                            modes[at..at + 2].copy_from_slice(&mode(&mesh, n, k));
                        }
                    }
                }
                modes
            };
            let mut modes = spectrum(0.0);
            let before = modes.clone();
            interlace(&mut modes, &spectrum(0.5), &brick, &Serial).unwrap();
            let at = |k: [usize; 3]| 2 * ((k[0] * n + k[1]) * (n / 2 + 1) + k[2]);
            let image = at(image);
            let norm = w.len() as f64 / 2.0;
            // Two images of a cubic sinc are small.
            assert!(before[image].abs() > 1e-8 * norm, "the image is there");
            if odd {
                assert!(modes[image].abs() < 1e-12 * norm && modes[image + 1].abs() < 1e-12 * norm);
            } else {
                assert!((modes[image] - before[image]).abs() < 1e-12 * norm);
                assert!((modes[image + 1] - before[image + 1]).abs() < 1e-12 * norm);
            }
            // A Nyquist mode keeps half of the first mesh's.
            let nyquist = at([n / 2, 1, 1]);
            assert_eq!(modes[nyquist].to_bits(), (0.5 * before[nyquist]).to_bits());
        }
    }
}

#[test]
fn interlacing_agrees_between_bricks_and_with_its_definition() {
    let n = 144;
    let brick = Brick::general(n, Space::Fourier, [70, 5, 0], [4, 3, 73], [3 * 73, 73, 1]).unwrap();
    let modes: Vec<f64> = random(brick.reals(), 11);
    let shifted: Vec<f64> = random(brick.reals(), 12);
    let mut out = modes.clone();
    interlace(&mut out, &shifted, &brick, &Threads::new(3).unwrap()).unwrap();
    let mut portable = modes.clone();
    interlace_with(Simd::Portable, &mut portable, &shifted, &brick, &Serial).unwrap();
    assert_eq!(bits(&out), bits(&portable));
    for c in 0..4 * 3 * 73 {
        let [x, y, z] = [70 + c / (3 * 73), 5 + c / 73 % 3, c % 73];
        let k = (Brick::mode(n, x) + y as i64 + z as i64) as f64;
        let angle = -core::f64::consts::PI * k / n as f64;
        let nyquist = x == 72 || z == 72;
        let (cosine, sine) = if nyquist { (0.0, 0.0) } else { (libm::cos(angle), libm::sin(angle)) };
        let (re, im) = (shifted[2 * c], shifted[2 * c + 1]);
        let expect = [
            0.5 * (modes[2 * c] + cosine * re - sine * im),
            0.5 * (modes[2 * c + 1] + sine * re + cosine * im),
        ];
        assert!((out[2 * c] - expect[0]).abs() < 1e-14 && (out[2 * c + 1] - expect[1]).abs() < 1e-14);
    }
    // Runs of single modes, z outermost.
    let turned = Brick::general(n, Space::Fourier, [70, 5, 0], [4, 3, 73], [3, 1, 12]).unwrap();
    let turn = |data: &[f64]| {
        let mut turned = vec![0.0; data.len()];
        for c in 0..4 * 3 * 73 {
            let at = 3 * (c / (3 * 73)) + c / 73 % 3 + 12 * (c % 73);
            turned[2 * at..2 * at + 2].copy_from_slice(&data[2 * c..2 * c + 2]);
        }
        turned
    };
    let mut other = turn(&modes);
    interlace(&mut other, &turn(&shifted), &turned, &Serial).unwrap();
    for (a, b) in other.iter().zip(turn(&out)) {
        assert!((a - b).abs() < 1e-15);
    }
}

#[test]
fn a_mode_is_interlaced_alike_in_every_brick() {
    let n = 300;
    // Rows that begin inside a block of phases, alone and with l outermost.
    let row = |l: usize, count: usize, stride| {
        Brick::general(n, Space::Fourier, [7, n - 3, l], [1, 2, count], stride).unwrap()
    };
    let whole = row(0, n / 2 + 1, [0, n / 2 + 1, 1]);
    let modes: Vec<f64> = random(whole.reals(), 51);
    let shifted: Vec<f64> = random(whole.reals(), 52);
    let mut expected = modes.clone();
    interlace(&mut expected, &shifted, &whole, &Serial).unwrap();
    for part in [row(30, 100, [0, 100, 1]), row(61, 90, [0, 1, 2])] {
        let at = |mode: usize, l: usize| 2 * (mode * part.stride()[1] + l * part.stride()[2]);
        let from = |mode: usize, l: usize| 2 * (mode * (n / 2 + 1) + part.start()[2] + l);
        let mut here = [vec![0.0; part.reals()], vec![0.0; part.reals()]];
        for (mesh, from_mesh) in here.iter_mut().zip([&modes, &shifted]) {
            for (mode, l) in (0..2).flat_map(|mode| (0..part.count()[2]).map(move |l| (mode, l))) {
                mesh[at(mode, l)..at(mode, l) + 2]
                    .copy_from_slice(&from_mesh[from(mode, l)..from(mode, l) + 2]);
            }
        }
        let [mut here, shifted] = here;
        interlace(&mut here, &shifted, &part, &Serial).unwrap();
        for (mode, l) in (0..2).flat_map(|mode| (0..part.count()[2]).map(move |l| (mode, l))) {
            for part in 0..2 {
                let (here, there) = (here[at(mode, l) + part], expected[from(mode, l) + part]);
                assert_eq!(here.to_bits(), there.to_bits(), "{mode} {l}");
            }
        }
    }
}
