//! What is refused.

use super::*;

#[test]
fn bad_lists_are_refused() {
    let edges = [1, 4, 9, 16];
    let mut triangles = [[0; 3]; 2];
    for (edges, centres, error) in [
        (&[1_u64][..], None, Error::Table),
        (&[1, 1], None, Error::Table),
        (&[4, 1], None, Error::Table),
        (&edges, Some(&[1.0, 2.0][..]), Error::Length),
        (&edges, Some(&[1.0, 1.0, 2.0]), Error::Table),
        (&edges, Some(&[-1.0, 1.0, 2.0]), Error::Table),
        (&edges, Some(&[1.0, f64::NAN, 2.0]), Error::NotFinite),
        (&edges, None, Error::Length),
    ] {
        assert_eq!(closed_triangles(&mut triangles, edges, centres), Err(error));
    }
    assert_eq!(squeezed_triangles(&mut triangles, 3, 3), Err(Error::Range));
    assert_eq!(squeezed_triangles(&mut triangles, 0, 3), Err(Error::Length));

    let counting = |triangles: &[Triangle], edges: &[u64], n| counts(triangles, edges, n, &Serial);
    assert_eq!(counting(&[[0, 1, 3]], &edges, 8), Err(Error::Range), "no such shell");
    assert_eq!(counting(&[[0, 1, 2]], &[1, 4, 9, 17], 8), Err(Error::Range), "beyond n/2");
    assert_eq!(counting(&[[0, 0, 0]], &[2, 1], 8), Err(Error::Table));
    assert_eq!(counting(&[[0, 0, 0]], &edges, 9), Err(Error::MeshSize));
    let scratch = memory(triangle_counts_scratch(&edges, 8, &[[0; 3]]).unwrap());
    assert_eq!(triangle_counts(&mut [0; 2], &[[0; 3]], &edges, 8, scratch, &Serial), Err(Error::Length));
    assert_eq!(
        triangle_counts(&mut [0], &[[0; 3]], &edges, 8, &mut scratch[64..], &Serial),
        Err(Error::Scratch)
    );

    let n = 8;
    let data = modes::<f64>(n, 1);
    let summing = |triangles: &[Triangle], edges: &[u64], meshes| {
        whole(triangles, edges, &data, n, meshes, &Serial).map(|_| ())
    };
    assert_eq!(summing(&[[0, 1, 3]], &edges, 3), Err(Error::Range));
    assert_eq!(summing(&[[0, 1, 2]], &edges, 2), Err(Error::Length));
    assert_eq!(summing(&[[0, 1, 2]], &[1, 4, 9, 20], 3), Err(Error::Range));
    let mut brick = Brick::whole(n, Space::Fourier).unwrap();
    let mut out = data.clone();
    assert_eq!(shell_modes(&mut out[1..], &data, &brick, 1, 4, &Serial), Err(Error::Length));
    assert_eq!(shell_modes(&mut out, &data, &brick, 4, 4, &Serial), Err(Error::Table));
    assert_eq!(shell_modes(&mut out, &data, &brick, 4, 17, &Serial), Err(Error::Range));
    assert_eq!(out, data);
    brick = Brick::whole(n, Space::Configuration).unwrap();
    assert_eq!(shell_modes(&mut out, &data, &brick, 1, 4, &Serial), Err(Error::Brick));

    let scratch = memory(bispectrum_sums_scratch::<f64>(&brick, 2, 1).unwrap());
    let mut sums = [ExactSum::ZERO];
    let mut add = |triangle: Triangle, fields: &[&[f64]], scratch: &mut [u8]| {
        bispectrum_sums(&mut sums, &[triangle], fields, &brick, scratch, &Serial)
    };
    assert_eq!(add([0, 0, 2], &[&data, &data], scratch), Err(Error::Range));
    assert_eq!(add([0, 0, 1], &[&data, &data[..9]], scratch), Err(Error::Length));
    assert_eq!(add([0, 0, 1], &[&data, &data], &mut scratch[64..]), Err(Error::Scratch));
    assert_eq!(add([0, 0, 0], &[&data, &[]], scratch), Ok(()), "a field that nobody asks for");
}

#[test]
fn what_is_not_finite_is_never_silent() {
    let n = 8;
    let brick = Brick::whole(n, Space::Configuration).unwrap();
    let scratch = memory(bispectrum_sums_scratch::<f32>(&brick, 2, 2).unwrap());
    let good = vec![1.0_f32; brick.reals()];
    for (bad, error) in
        [(f32::NAN, Error::NotFinite), (f32::INFINITY, Error::NotFinite), (1e30, Error::NotFinite)]
    {
        let mut field = good.clone();
        field[(7 * n + 3) * (n + 2) + 5] = bad;
        let mut sums = [ExactSum::ZERO; 2];
        let list = [[0, 0, 0], [1, 1, 0]];
        let added = bispectrum_sums(&mut sums, &list, &[&good, &field], &brick, scratch, &Serial);
        assert_eq!(added, Err(error), "{bad}");
        assert_eq!(sums, [ExactSum::ZERO; 2], "untouched");
    }
    let mut bad = modes::<f64>(n, 1);
    bad[2 * (n / 2 + 1)] = f64::NAN;
    assert_eq!(whole(&[[0, 1, 1]], &[1, 4, 9], &bad, n, 3, &Serial).err(), Some(Error::NotFinite));
    let mut lost = ExactSum::ZERO;
    lost.add(f64::NAN);
    let mut values = [1.0];
    assert_eq!(bispectrum_values(&mut values, &[lost]), Err(Error::NotFinite));
    assert_eq!(bispectrum_values(&mut values, &[]), Err(Error::Length));
    assert_eq!(values, [1.0]);
}
