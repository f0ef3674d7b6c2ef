//! The bispectrum's sums and counts as sums over triples of modes, k1 + k2 + k3 = 0 modulo n as a mesh has it.

use std::vec::Vec;

/// All mode numbers |n_a| < n/2 with lo <= |n|^2 < hi.
pub(crate) fn shell(n: usize, lo: u64, hi: u64) -> Vec<[i64; 3]> {
    let half = n as i64 / 2;
    let range = || 1 - half..half;
    range()
        .flat_map(|i| range().flat_map(move |j| range().map(move |l| [i, j, l])))
        .filter(|m| (lo..hi).contains(&(m.iter().map(|a| (a * a) as u64).sum())))
        .collect()
}

/// delta of a mode number, from rows of n/2 + 1 modes.
fn at(modes: &[f64], n: usize, mode: [i64; 3]) -> [f64; 2] {
    let (sign, [i, j, l]) = if mode[2] < 0 { (-1.0, mode.map(|a| -a)) } else { (1.0, mode) };
    let index = |a: i64| a.rem_euclid(n as i64) as usize;
    let place = 2 * ((index(i) * n + index(j)) * (n / 2 + 1) + l as usize);
    [modes[place], sign * modes[place + 1]]
}

/// The ordered triples of three shells that close modulo n, and the real part of the sum of their products.
pub(crate) fn triples(modes: &[f64], n: usize, shells: [&[[i64; 3]]; 3]) -> (u64, f64) {
    let (mut count, mut sum) = (0, 0.0);
    for a in shells[0] {
        let f = at(modes, n, *a);
        for b in shells[1] {
            let side = n as i64;
            let third = core::array::from_fn(|axis| {
                let m = (-a[axis] - b[axis]).rem_euclid(side);
                if 2 * m >= side { m - side } else { m }
            });
            if shells[2].binary_search(&third).is_ok() {
                let (g, h) = (at(modes, n, *b), at(modes, n, third));
                let product = [f[0] * g[0] - f[1] * g[1], f[0] * g[1] + f[1] * g[0]];
                count += 1;
                sum += product[0] * h[0] - product[1] * h[1];
            }
        }
    }
    (count, sum)
}
