//! P(k) of every seed, the mean, and linear theory; below, the same over linear theory.

use super::{GREY, Suite, colour, columns, half_title, k_axis, over};
use crate::axes::{Axes, Axis, Key};
use crate::drawing::{Colour, Drawing, Pen};
use crate::statistics::{Kind, band};
use crate::suite::{Amplitude, Half, Phase, Variant};

pub(super) fn draw(suite: &Suite) -> Drawing {
    let (mut drawing, areas) = columns([310.0, 170.0]);
    let bins = suite.bins();
    let top = bins.theory.iter().copied().fold(0.0, f64::max);
    let bottom = bins.theory.iter().copied().fold(f64::INFINITY, f64::min);
    let reach = spread(suite);
    for (half, [upper, lower]) in [Half::Gaussian, Half::Local].into_iter().zip(areas) {
        let first = half == Half::Gaussian;
        let x = k_axis(suite);
        let power = Axes { area: upper, x, y: Axis::logarithmic(0.5 * bottom, 4.0 * top) };
        let ratio = Axes { area: lower, x, y: Axis::linear(1.0 - reach, 1.0 + reach) };
        for (amplitude, kind) in [(Amplitude::Normal, Kind::Normal), (Amplitude::Fixed, Kind::Fixed)] {
            let shade = colour(amplitude);
            let thin = Pen::solid(shade.fade(0.35), 0.7);
            for seed in 0..suite.seeds.len() {
                let one = suite.get(seed, Variant { amplitude, phase: Phase::Original, half });
                power.line(&mut drawing, &bins.k, &one.power, thin);
                ratio.line(&mut drawing, &bins.k, &over(&one.power, &bins.theory), thin);
            }
            let mean = band(suite, kind, half).mean;
            power.line(&mut drawing, &bins.k, &mean, Pen::solid(shade, 2.0));
            ratio.line(&mut drawing, &bins.k, &over(&mean, &bins.theory), Pen::solid(shade, 2.0));
        }
        let linear = Pen::dashed(Colour::BLACK, 1.4);
        power.line(&mut drawing, &bins.k, &bins.theory, linear);
        ratio.level(&mut drawing, 1.0, linear);
        for sign in [-1.0, 1.0] {
            ratio.line(&mut drawing, &bins.k, &sigma(suite, sign), Pen::dashed(GREY, 1.2));
        }
        power.title(&mut drawing, &half_title(suite, half));
        if first {
            let entries = [
                (Key::Line(Pen::solid(colour(Amplitude::Normal).fade(0.5), 0.8)), "Normal, each seed"),
                (Key::Line(Pen::solid(colour(Amplitude::Normal), 2.0)), "Normal, mean"),
                (Key::Line(Pen::solid(colour(Amplitude::Fixed), 2.0)), "Fixed, each seed and mean"),
                (Key::Line(linear), "linear theory"),
            ];
            power.legend(&mut drawing, &entries, [false, true]);
        } else {
            let entry = (Key::Line(Pen::dashed(GREY, 1.0)), "1 ± √(2/*N*_{k})");
            ratio.legend(&mut drawing, &[entry], [true, true]);
        }
        let label = |text| if first { text } else { "" };
        power.frame(&mut drawing, "", label("*P*(*k*)  [(Mpc/*h*)^{3}],  *z* = 32"));
        ratio.frame(&mut drawing, "*k*  [*h*/Mpc]", label("*P* / *P*_{linear}"));
    }
    drawing
}

/// One sigma_th above or below one.
fn sigma(suite: &Suite, sign: f64) -> Vec<f64> {
    suite.bins().modes.iter().map(|&modes| 1.0 + sign * (2.0 / modes as f64).sqrt()).collect()
}

/// Half the height of the panel of ratios: nearly all of the first bin, which scatters most.
fn spread(suite: &Suite) -> f64 {
    2.2 * (2.0 / suite.bins().modes[0] as f64).sqrt()
}
