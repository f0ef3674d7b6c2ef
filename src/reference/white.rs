//! One mode of white noise, straight from its definition.

use crate::noise::philox::philox4x32_10;
use crate::noise::{Amplitude, Nyquist, Phase, Realisation};

/// The unit mode at signed mode numbers (i, j, l) of a mesh of side n, -n/2 < i, j <= n/2, any l; n/2 and -n/2 are one mode.
pub(crate) fn white_mode(n: i64, mode: [i64; 3], choice: &Realisation) -> [f64; 2] {
    let half = n / 2;
    let fold = |m: i64| if m == -half { half } else { m };
    let mode = mode.map(fold);
    let partner = mode.map(|m| fold(-m));
    if mode == [0; 3] || mode.contains(&half) && choice.nyquist == Nyquist::Zero {
        return [0.0; 2];
    }
    let sign = if choice.phase == Phase::Inverted { -1.0 } else { 1.0 };
    if mode == partner {
        let (u1, u2) = uniforms(mode, choice.seed);
        let cosine = libm::cos(core::f64::consts::TAU * u1);
        let x = match choice.amplitude {
            Amplitude::Normal => libm::sqrt(-2.0 * libm::log(u2)) * cosine,
            Amplitude::Fixed => cosine.signum(),
            Amplitude::FixedToMean => cosine.signum() * libm::sqrt(core::f64::consts::FRAC_2_PI),
        };
        return [sign * x, 0.0];
    }
    // Of a pair, that one is drawn which has the first positive number among l, j, i that is not its own negative.
    let own = |m: i64| m == 0 || m == half;
    let deciding = [mode[2], mode[1], mode[0]].into_iter().find(|&m| !own(m)).unwrap();
    let (drawn, conjugate) = if deciding > 0 { (mode, 1.0) } else { (partner, -1.0) };
    let (u1, u2) = uniforms(drawn, choice.seed);
    let modulus = match choice.amplitude {
        Amplitude::Normal => libm::sqrt(-libm::log(u2)),
        Amplitude::Fixed => 1.0,
        Amplitude::FixedToMean => libm::sqrt(core::f64::consts::PI) / 2.0,
    };
    let angle = core::f64::consts::TAU * u1;
    [sign * modulus * libm::cos(angle), conjugate * sign * modulus * libm::sin(angle)]
}

/// u1 in [0, 1) and u2 in (0, 1].
pub(crate) fn uniforms([i, j, l]: [i64; 3], seed: u64) -> (f64, f64) {
    let counter = [i as u32, l as u32, j as u32, 0x7768_6974];
    let words = philox4x32_10(counter, [seed as u32, (seed >> 32) as u32]).map(u64::from);
    let first = (words[1] << 32 | words[0]) >> 11;
    let second = (words[3] << 32 | words[2]) >> 11;
    let scale = 1.0 / (1_u64 << 53) as f64;
    (first as f64 * scale, (second + 1) as f64 * scale)
}
