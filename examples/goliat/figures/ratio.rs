//! Fixed over Normal, with its scatter; below, sigma of the four types over sigma_th.

use super::{FIXED, NORMAL, Suite, columns, draw_scatter, half_title, k_axis, scatter_axis};
use crate::axes::{Axes, Axis, Key};
use crate::drawing::{Colour, Drawing, Pen};
use crate::statistics::{Band, Kind, band};
use crate::suite::{Amplitude, Half, Phase, Variant};

pub(super) fn draw(suite: &Suite) -> Drawing {
    let (mut drawing, areas) = columns([240.0, 260.0]);
    let halves = [Half::Gaussian, Half::Local];
    let bands = halves.map(|half| Kind::ALL.map(|kind| band(suite, kind, half)));
    let (x, y) = (k_axis(suite), scatter_axis(&bands));
    for ((half, bands), [upper, lower]) in halves.into_iter().zip(&bands).zip(areas) {
        let reach = 1.6 * bands[0].deviation[0] / bands[0].mean[0];
        let means = Axes { area: upper, x, y: Axis::linear(1.0 - reach, 1.0 + reach) };
        draw_means(&mut drawing, suite, half, &means, bands);
        draw_scatter(&mut drawing, &suite.bins().k, &Axes { area: lower, x, y }, bands, half);
    }
    drawing
}

fn draw_means(drawing: &mut Drawing, suite: &Suite, half: Half, axes: &Axes, bands: &[Band; 4]) {
    let [normal, _, fixed, _] = bands;
    let k = &suite.bins().k;
    let count = suite.seeds.len() as f64;
    let around = |centre: &[f64], width: &[f64], sign: f64| -> Vec<f64> {
        centre.iter().zip(width).map(|(centre, width)| centre + sign * width).collect()
    };
    let relative: Vec<_> =
        normal.deviation.iter().zip(&normal.mean).map(|(sigma, mean)| sigma / mean).collect();
    let one = vec![1.0; k.len()];
    axes.band(drawing, k, &around(&one, &relative, -1.0), &around(&one, &relative, 1.0), NORMAL.fade(0.15));

    for (amplitude, shade) in [(Amplitude::Normal, NORMAL), (Amplitude::Fixed, FIXED)] {
        for seed in 0..suite.seeds.len() {
            let power = &suite.get(seed, Variant { amplitude, phase: Phase::Original, half }).early.power;
            let ratio: Vec<_> = power.iter().zip(&normal.mean).map(|(power, mean)| power / mean).collect();
            axes.line(drawing, k, &ratio, Pen::solid(shade.fade(0.3), 0.6));
        }
    }

    // The two means share phases but not moduli: their relative errors add in squares.
    let ratio: Vec<_> = fixed.mean.iter().zip(&normal.mean).map(|(fixed, normal)| fixed / normal).collect();
    let error: Vec<_> = (0..k.len())
        .map(|i| {
            let fixed = fixed.deviation[i] / fixed.mean[i];
            ratio[i] * (relative[i].powi(2) + fixed.powi(2)).sqrt() / count.sqrt()
        })
        .collect();
    axes.band(drawing, k, &around(&ratio, &error, -1.0), &around(&ratio, &error, 1.0), FIXED.fade(0.35));
    axes.line(drawing, k, &ratio, Pen::solid(FIXED, 2.0));
    axes.level(drawing, 1.0, Pen::dashed(Colour::BLACK, 1.2));
    axes.title(drawing, &half_title(suite, half));
    let first = half == Half::Gaussian;
    if first {
        let entries = [
            (Key::Line(Pen::solid(FIXED, 2.0)), "Fixed / Normal, means"),
            (Key::Band(FIXED.fade(0.35)), "its error"),
            (Key::Band(NORMAL.fade(0.15)), "σ of one Normal simulation"),
        ];
        axes.legend(drawing, &entries, [true, true]);
    } else {
        let entries = [
            (Key::Line(Pen::solid(NORMAL.fade(0.4), 0.8)), "each Normal / mean Normal"),
            (Key::Line(Pen::solid(FIXED.fade(0.6), 0.8)), "each Fixed / mean Normal"),
        ];
        axes.legend(drawing, &entries, [true, true]);
    }
    axes.frame(drawing, "", if first { "*P* / *P*_{Normal}" } else { "" });
}
