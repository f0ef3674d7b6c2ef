//! Forces and the potential of masses in cells against the textbook's formula for each mode.

use core::ptr::null;

use crate::c::*;
use crate::hooks::{double, layout, scratch_for};
use crate::input::Input;
use crate::memory::Memory;
use crate::pm::{Difference, ForceLaw, Window};
use crate::reference::force::field;
use crate::same::close;

pub fn run(data: &[u8]) {
    let input = &mut Input::new(data);
    // A mesh of side 2 has no force: all its modes but the mean are at n/2. One of side 4 has them at a quarter of the circle alone, where sin(2 theta) = 0.
    let n = [4, 6, 4, 6][input.few(4)];
    let [laplacian, gradient, window, power] = [3, 3, 5, 2].map(|count| input.few(count));
    let box_size = [1.0, 100.0, 1e4][input.few(3)];
    let split_scale = [0.0, 0.5, 1.25][input.few(3)] * box_size / n as f64;
    let differences = [Difference::Exact, Difference::TwoPoint, Difference::FourPoint];
    let windows = [
        Window::NearestGridPoint,
        Window::CloudInCell,
        Window::TriangularShapedCloud,
        Window::PiecewiseCubicSpline,
    ];
    let law = ForceLaw {
        laplacian: differences[laplacian],
        gradient: differences[gradient],
        window: (window > 0).then(|| (windows[window - 1], power as u32 + 1)),
        split_scale,
    };
    let asked = fixpair_force_law {
        struct_size: size_of::<fixpair_force_law>(),
        laplacian: laplacian as i32,
        gradient: gradient as i32,
        window: window as i32,
        window_power: power as i32 + 1,
        split_scale,
    };
    let mut random = input.random();
    let masses: Vec<f64> = (0..n * n * n).map(|_| 0.5 + random.unit()).collect();
    let mass: f64 = masses.iter().sum();
    let fft = double(n);
    let [x, y, _] = fft.configuration.stride;
    let at = |c: usize| c / (n * n) * x + c / n % n * y + c % n;
    let mut meshes = [0; 3].map(|_| Memory::new(fft.length, |_| 0.0));
    masses.iter().enumerate().for_each(|(c, &value)| meshes[0].values_mut()[at(c)] = value);
    let mut layout = layout();
    must!(fixpair_force_scratch(&mut layout, n));
    let scratch = scratch_for(&mut Input::new(&[]), 0, layout);
    let (Some(forward), Some(inverse)) = (fft.forward, fft.inverse) else {
        unreachable!("the built-in transform has both")
    };
    // SAFETY: `length` reals of the layout that the transform says.
    assert_eq!(unsafe { forward(fft.context, meshes[0].pointer()) }, 0);
    let (work, work_len) = (scratch.pointer().cast(), scratch.len());
    let brick = &fft.fourier;
    let [first, second, third] = [0, 1, 2].map(|mesh| meshes[mesh].pointer());
    let compared: &[usize] = match input.few(3) {
        0 => {
            must!(fixpair_forces_f64(
                first,
                second,
                third,
                fft.length,
                brick,
                &asked,
                box_size,
                mass,
                work,
                work_len,
                null()
            ));
            &[0, 1, 2]
        }
        1 => {
            for axis in [1, 2] {
                must!(fixpair_force_f64(
                    meshes[axis].pointer(),
                    first,
                    fft.length,
                    brick,
                    axis,
                    &asked,
                    box_size,
                    mass,
                    work,
                    work_len,
                    null()
                ));
            }
            &[1, 2]
        }
        _ => {
            must!(fixpair_potential_f64(
                first,
                fft.length,
                brick,
                &asked,
                box_size,
                mass,
                work,
                work_len,
                null()
            ));
            &[3]
        }
    };
    for &which in compared {
        let mesh = &meshes[which % 3];
        let expected = field(which, n, box_size, &masses, &law);
        // SAFETY: as above.
        assert_eq!(unsafe { inverse(fft.context, mesh.pointer()) }, 0);
        // Two transforms of a small mesh on either side, some epsilons of the largest value each. Where the field is nothing but rounding, as
        // a gradient of one cell's neighbours may be, that of the modes, which are of the size of the masses times L or L^2.
        let largest = expected.iter().fold(0.0, |most: f64, value| most.max(value.abs()));
        let unit = if which == 3 { box_size * box_size } else { box_size };
        for (c, &value) in expected.iter().enumerate() {
            close(
                mesh.values()[at(c)],
                value,
                1e-13 * largest + 1e-17 * unit,
                format_args!("field {which} of {law:?}"),
            );
        }
    }
}
