//! The noise of N-GenIC and FastPM as their papers and programs have it: one generator of floating-point numbers, the
//! whole table of seeds, one mode after the other.

use std::vec;
use std::vec::Vec;

use crate::math::{neg_ln, sin_cos_turns, sqrt};
use crate::noise::{Amplitude, Nyquist, Phase, Realisation, Scheme, Selection};

/// ranlxd1 in double precision.
pub(crate) struct Ranlxd1 {
    x: [f64; 12],
    borrow: f64,
    /// The word that the next update changes, and the word that was read last.
    next: usize,
    read: usize,
    /// Where the present dozen began.
    block: usize,
}

const ONE_BIT: f64 = 1.0 / (1_u64 << 48) as f64;

impl Ranlxd1 {
    /// `seed` below 2^31.
    pub(crate) fn new(seed: u32) -> Self {
        let seed = if seed == 0 { 1 } else { seed };
        let mut bits: [bool; 31] = core::array::from_fn(|k| seed >> k & 1 == 1);
        let (mut i, mut j) = (0, 18);
        let x = core::array::from_fn(|_| {
            let mut word = 0.0;
            for _ in 0..48 {
                word = 2.0 * word + if bits[i] { 0.0 } else { 1.0 };
                bits[i] ^= bits[j];
                (i, j) = ((i + 1) % 31, (j + 1) % 31);
            }
            word * ONE_BIT
        });
        Self { x, borrow: 0.0, next: 0, read: 11, block: 0 }
    }

    pub(crate) fn uniform(&mut self) -> f64 {
        self.read = (self.read + 1) % 12;
        if self.read == self.block {
            for _ in 0..202 {
                let (r, s) = (self.next, (self.next + 7) % 12);
                let difference = self.x[s] - self.x[r] - self.borrow;
                self.borrow = if difference < 0.0 { ONE_BIT } else { 0.0 };
                self.x[r] = if difference < 0.0 { difference + 1.0 } else { difference };
                self.next = (r + 1) % 12;
            }
            self.read = self.next;
            self.block = self.next;
        }
        self.x[self.read]
    }
}

/// The seeds of all (i, j), row by row.
pub(crate) fn seed_table(n: usize, seed: u32) -> Vec<u32> {
    let mut table = vec![0; n * n];
    let mut stream = Ranlxd1::new(seed);
    let mut set = |i: usize, j: usize| table[i * n + j] = (2_147_483_647.0 * stream.uniform()) as u32;
    let m = |i: usize| n - 1 - i;
    for i in 0..n / 2 {
        (0..i).for_each(|j| set(i, j));
        (0..=i).for_each(|j| set(j, i));
        (0..i).for_each(|j| set(m(i), j));
        (0..=i).for_each(|j| set(m(j), i));
        (0..i).for_each(|j| set(i, m(j)));
        (0..=i).for_each(|j| set(j, m(i)));
        (0..i).for_each(|j| set(m(i), m(j)));
        (0..=i).for_each(|j| set(m(j), m(i)));
    }
    table
}

/// All modes of the half space: that of (i, j, l) is at (i n + j)(n/2 + 1) + l.
pub(crate) fn modes(n: usize, choice: &Realisation) -> Vec<[f64; 2]> {
    let table = seed_table(n, choice.seed as u32);
    let half = n / 2;
    let negative = |m: usize| (n - m) % n;
    let mut modes = vec![[0.0; 2]; n * n * (half + 1)];
    for i in 0..n {
        for j in 0..n {
            let (ci, cj) = (negative(i), negative(j));
            let mirrored = ci < i || ci == i && cj < j;
            let mut own = Ranlxd1::new(table[i * n + j]);
            let mut other = Ranlxd1::new(table[ci * n + cj]);
            for l in 0..=half {
                let [own, other] = [&mut own, &mut other].map(draw);
                let on_plane = l == 0 || l == half;
                let conjugate = mirrored && on_plane;
                let (u1, u2) = if conjugate { other } else { own };
                let self_conjugate = (ci, cj) == (i, j) && on_plane;
                let nyquist = i == half || j == half || l == half;
                if (i, j, l) == (0, 0, 0)
                    || nyquist && (choice.nyquist == Nyquist::Zero || choice.scheme == Scheme::NGenIc)
                    || cut(n, [i.min(ci), j.min(cj), l], choice)
                {
                    continue;
                }
                let [re, im] = if self_conjugate { real(u1, u2, choice) } else { complex(u1, u2, choice) };
                modes[(i * n + j) * (half + 1) + l] = [re, if conjugate { -im } else { im }];
            }
        }
    }
    modes
}

fn draw(stream: &mut Ranlxd1) -> (f64, f64) {
    let u1 = stream.uniform();
    let mut u2 = stream.uniform();
    while u2 == 0.0 {
        u2 = stream.uniform();
    }
    (u1, u2)
}

/// Are the mode numbers, without their signs, outside the selection?
fn cut(n: usize, mode: [usize; 3], choice: &Realisation) -> bool {
    let sample = if choice.sample == 0 { n } else { choice.sample as usize };
    match choice.selection {
        Selection::Cube => mode.iter().any(|&m| m > sample / 2),
        Selection::Sphere => mode.iter().map(|m| m * m).sum::<usize>() > (sample / 2) * (sample / 2),
    }
}

fn complex(u1: f64, u2: f64, choice: &Realisation) -> [f64; 2] {
    let modulus = match choice.amplitude {
        Amplitude::Normal => sqrt(neg_ln(u2)),
        Amplitude::Fixed => 1.0,
        Amplitude::FixedToMean => libm::sqrt(core::f64::consts::PI) / 2.0,
    };
    let (sine, cosine) = sin_cos_turns(u1);
    let sign = if choice.phase == Phase::Inverted { -1.0 } else { 1.0 };
    [sign * modulus * cosine, sign * modulus * sine]
}

fn real(u1: f64, u2: f64, choice: &Realisation) -> [f64; 2] {
    let cosine = sin_cos_turns(u1).1;
    let x = match choice.amplitude {
        Amplitude::Normal => sqrt(neg_ln(u2)) * cosine,
        Amplitude::Fixed => cosine.signum(),
        Amplitude::FixedToMean => cosine.signum() * libm::sqrt(core::f64::consts::FRAC_2_PI),
    };
    if choice.phase == Phase::Inverted { [-x, -0.0] } else { [x, 0.0] }
}
