//! The cases of shapes of primordial non-Gaussianity.

use fixpair::exec::Serial;
use fixpair::fft::Fft3;
use fixpair::initial::shape::{Quadratic, Shape, ShapeRow, add_quadratic, add_quadratic_scratch};
use fixpair::mesh::{Brick, Space};
use fixpair::noise::{Realisation, white_modes_coloured};
use fixpair::real::Real;

use crate::vectors::{Cases, FINE, Hash, N, SEED, mode_tables};
use crate::vectors_real::{elements, with_transform};

/// A host's own kernel.
const OWN: [ShapeRow; 3] = [
    ShapeRow { coefficient: 1.5, s_out: 0.5, s_a: -1.25, s_b: 0.75 },
    ShapeRow { coefficient: -2.0, s_out: 0.5, s_a: -1.0, s_b: 0.5 },
    ShapeRow { coefficient: 0.25, s_out: 1.0, s_a: -0.5, s_b: -0.5 },
];

pub(crate) fn shape_rows(cases: &mut Cases) {
    let of = |row: &ShapeRow| [row.coefficient, row.s_out, row.s_a, row.s_b];
    let all = Shape::ALL.into_iter().flat_map(|shape| shape.rows().iter().flat_map(of));
    cases.add("shape_rows", Hash::new().doubles(&all.collect::<Vec<_>>()));
}

pub(crate) fn shape_cases<T: Real>(add: &mut dyn FnMut(&str, Hash)) {
    let [amplitude, _] = mode_tables();
    let brick = Brick::whole(N, Space::Fourier).expect("a brick");
    let mut gaussian = vec![T::ZERO; brick.reals()];
    white_modes_coloured(&mut gaussian, &brick, &Realisation::new(SEED), &amplitude, &Serial).expect("modes");
    let cases = [
        ("local", Shape::Local.rows(), FINE),
        ("equilateral", Shape::Equilateral.rows(), FINE),
        ("orthogonal", Shape::Orthogonal.rows(), FINE),
        ("orthogonal_lss", Shape::OrthogonalLss.rows(), FINE),
        ("folded", Shape::Folded.rows(), FINE),
        ("own", &OWN[..], N),
    ];
    for (name, rows, side) in cases {
        let mut phi = gaussian.clone();
        let layout = with_transform::<T, _>(side, 0, |work| {
            let [mut one, mut two] = [(); 2].map(|()| vec![T::ZERO; work.length()]);
            let (mut sum, mut table) = (vec![T::ZERO; brick.reals()], vec![0.0; amplitude.len()]);
            let term = Quadratic { f_nl: 5000.0, rows, n_s: 0.96 };
            let meshes = [&mut one[..], &mut two[..]];
            add_quadratic(&mut phi, &brick, &term, work, meshes, &mut sum, &mut table, &Serial)
                .expect("modes");
            add_quadratic_scratch(&brick, work).expect("scratch")
        });
        let hash = Hash::new().integers(&[layout.size as u64, layout.align as u64]);
        add(&format!("add_shape.{name}"), elements(hash, &phi, &brick));
    }
}
