//! From mode numbers to modes: single ones, and blocks along l in the form that becomes vector instructions.
//!
//! Both go through the same inlined functions, so their bits agree.

use super::philox::{key_of, rounds};
use super::realisation::{Amplitude, Phase, Realisation};
use crate::math::{neg_ln, sin_cos_turns, sqrt, sqrt_in_place};
use crate::real::Real;
use crate::within::Within;

/// Modes in a block: a few vector iterations of each stage, handed over in the first-level cache; more would be
/// wasted at the end of short rows.
const LANES: usize = 16;

/// The fourth counter word: this use of the generator ("whit"). Other uses of one seed take other tags.
const DOMAIN: u32 = u32::from_be_bytes(*b"whit");

/// sqrt(pi)/2, the mean of the Rayleigh distribution of unit mean square.
pub(super) const RAYLEIGH_MEAN: f64 = 0.886_226_925_452_758;
/// sqrt(2/pi), the mean modulus of a standard normal number.
pub(super) const NORMAL_MEAN: f64 = 0.797_884_560_802_865_4;

/// What two uniforms become.
#[derive(Clone, Copy)]
pub(super) struct Shape {
    amplitude: Amplitude,
    inverted: bool,
}

impl Shape {
    pub(super) const fn new(realisation: &Realisation) -> Self {
        Self { amplitude: realisation.amplitude, inverted: matches!(realisation.phase, Phase::Inverted) }
    }

    /// A complex mode of unit mean square.
    #[inline(always)]
    pub(super) fn complex(&self, u1: f64, u2: f64) -> [f64; 2] {
        let modulus = match self.amplitude {
            Amplitude::Normal => sqrt(neg_ln(u2)),
            Amplitude::Fixed => 1.0,
            Amplitude::FixedToMean => RAYLEIGH_MEAN,
        };
        let (sine, cosine) = sin_cos_turns(u1);
        [modulus * cosine, modulus * sine].map(|x| if self.inverted { -x } else { x })
    }

    /// A self-conjugate mode: a real number, Normal of mean square `power`.
    pub(super) fn real(&self, u1: f64, u2: f64, power: f64) -> [f64; 2] {
        let cosine = sin_cos_turns(u1).1;
        let sign = if cosine < 0.0 { -1.0 } else { 1.0 };
        let x = match self.amplitude {
            Amplitude::Normal => sqrt(2.0 * power * neg_ln(u2)) * cosine,
            Amplitude::Fixed => sign,
            Amplitude::FixedToMean => sign * NORMAL_MEAN,
        };
        if self.inverted { [-x, -0.0] } else { [x, 0.0] }
    }

    /// Real and imaginary parts of a block of complex modes.
    #[inline(always)]
    pub(super) fn block<const N: usize>(&self, u1: &[f64; N], u2: &[f64; N]) -> [[f64; N]; 2] {
        let sign = if self.inverted { -1.0 } else { 1.0 };
        let mut modulus = [sign; N];
        match self.amplitude {
            Amplitude::Normal => {
                for lane in 0..N {
                    modulus[lane] = neg_ln(u2[lane]);
                }
                sqrt_in_place(&mut modulus);
                modulus = modulus.map(|x| sign * x);
            }
            Amplitude::Fixed => {}
            Amplitude::FixedToMean => modulus = [sign * RAYLEIGH_MEAN; N],
        }
        let (mut re, mut im) = ([0.0; N], [0.0; N]);
        for lane in 0..N {
            let (sine, cosine) = sin_cos_turns(u1[lane]);
            re[lane] = modulus[lane] * cosine;
            im[lane] = modulus[lane] * sine;
        }
        [re, im]
    }
}

/// What a mode of the native scheme depends on besides its number.
#[derive(Clone, Copy)]
pub(super) struct Draw {
    key: [u32; 2],
    shape: Shape,
}

impl Draw {
    pub(super) const fn new(realisation: &Realisation) -> Self {
        Self { key: key_of(realisation.seed), shape: Shape::new(realisation) }
    }

    /// u1 in [0, 1) and u2 in (0, 1], multiples of 2^-53, of the mode (i, j, l).
    ///
    /// The counter is (i, l, j, domain): the first round multiplies words 0 and 2 only, so with l in word 1 most of the first
    /// three rounds is common to a row and is computed once.
    #[inline(always)]
    fn uniforms(&self, i: i32, j: i32, l: u64) -> (f64, f64) {
        let words = rounds(
            [u64::from(i.cast_unsigned()), l, u64::from(j.cast_unsigned()), u64::from(DOMAIN)],
            self.key,
        );
        (uniform(words[0], words[1], 0), uniform(words[2], words[3], 1))
    }

    /// The mode (i, j, l), itself the representative of its pair.
    #[inline(always)]
    pub(super) fn complex(&self, i: i32, j: i32, l: u32) -> [f64; 2] {
        let (u1, u2) = self.uniforms(i, j, u64::from(l));
        self.shape.complex(u1, u2)
    }

    /// The self-conjugate mode (i, j, l): a real number of unit variance.
    pub(super) fn real(&self, i: i32, j: i32, l: u32) -> [f64; 2] {
        let (u1, u2) = self.uniforms(i, j, u64::from(l));
        self.shape.real(u1, u2, 1.0)
    }

    /// The modes (i, j, first ..) with l between the self-conjugate planes, each times `colour[l^2]` if there is one.
    #[inline(always)]
    pub(super) fn row<T: Real>(
        &self,
        i: i32,
        j: i32,
        first: u32,
        colour: Option<&[f64]>,
        out: &mut [[T; 2]],
    ) {
        let mut l = u64::from(first);
        for out in out.chunks_mut(LANES) {
            self.block(i, j, l, colour, out);
            l += LANES as u64;
        }
    }

    #[inline(always)]
    fn block<T: Real>(&self, i: i32, j: i32, first: u64, colour: Option<&[f64]>, out: &mut [[T; 2]]) {
        debug_assert!(out.len() <= LANES);
        let mut u1 = [0.0; LANES];
        let mut u2 = [0.0; LANES];
        for lane in 0..LANES {
            (u1[lane], u2[lane]) = self.uniforms(i, j, first + lane as u64);
        }
        let [re, im] = self.shape.block(&u1, &u2);
        if let Some(colour) = colour {
            for (lane, mode) in out.iter_mut().enumerate() {
                let l = first as usize + lane;
                *mode = [re.at(lane), im.at(lane)].map(|x| T::from_f64(x * colour.at(l * l)));
            }
        } else {
            for (lane, mode) in out.iter_mut().enumerate() {
                *mode = [re[lane], im[lane]].map(T::from_f64);
            }
        }
    }
}

/// (the upper 53 bits of `high`:`low`, plus `plus`) / 2^53, exactly; the words in the low halves of the arguments.
#[inline(always)]
fn uniform(low: u64, high: u64, plus: u64) -> f64 {
    /// Bits of 2^20, where numbers are 2^-32 apart, and of 1/2, where they are 2^-53 apart.
    const UPPER: u64 = 0x4130_0000_0000_0000;
    const LOWER: u64 = 0x3FE0_0000_0000_0000;
    const WORD: u64 = 0xFFFF_FFFF;
    let upper = f64::from_bits(UPPER | (high & WORD)) - (f64::from_bits(UPPER) + 0.5);
    upper + f64::from_bits((LOWER + plus) + ((low & WORD) >> 11))
}
