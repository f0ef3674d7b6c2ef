//! Fixed over Normal, with its scatter; below, sigma of the four types over sigma_th.

use super::{FIXED, FIXED_PAIRED, NORMAL, NORMAL_PAIRED, Suite, columns, half_title, k_axis};
use crate::axes::{Axes, Axis, Key};
use crate::drawing::{Colour, Drawing, Pen};
use crate::statistics::{Band, Kind, band};
use crate::suite::{Amplitude, Half, Phase, Variant};

/// Lowest sigma/sigma_th of the figure.
const FLOOR: f64 = 1e-6;

const fn pen(kind: Kind) -> Pen {
    match kind {
        Kind::Normal => Pen::solid(NORMAL, 1.8),
        Kind::NormalPaired => Pen::dashed(NORMAL_PAIRED, 1.8),
        Kind::Fixed => Pen::solid(FIXED, 1.8),
        Kind::FixedPaired => Pen::dashed(FIXED_PAIRED, 1.8),
    }
}

pub(super) fn draw(suite: &Suite) -> Drawing {
    let (mut drawing, areas) = columns([240.0, 260.0]);
    let ratios =
        [Half::Gaussian, Half::Local].map(|half| Kind::ALL.map(|kind| band(suite, kind, half).ratio));
    let lowest = ratios.iter().flatten().flatten().fold(0.1, |low: f64, &ratio| low.min(ratio.max(FLOOR)));
    for (half, [upper, lower]) in [Half::Gaussian, Half::Local].into_iter().zip(areas) {
        let bands = Kind::ALL.map(|kind| band(suite, kind, half));
        let x = k_axis(suite);
        let reach = 1.6 * bands[0].deviation[0] / bands[0].mean[0];
        let means = Axes { area: upper, x, y: Axis::linear(1.0 - reach, 1.0 + reach) };
        let scatter = Axes { area: lower, x, y: Axis::logarithmic(0.5 * lowest, 3.0 * lowest.powf(-0.4)) };
        draw_means(&mut drawing, suite, half, &means, &bands);
        draw_scatter(&mut drawing, suite, &scatter, &bands, half);
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
            let power = &suite.get(seed, Variant { amplitude, phase: Phase::Original, half }).power;
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

fn draw_scatter(drawing: &mut Drawing, suite: &Suite, axes: &Axes, bands: &[Band; 4], half: Half) {
    let k = &suite.bins().k;
    let mut floored = false;
    for (kind, band) in Kind::ALL.into_iter().zip(bands) {
        floored |= band.ratio.iter().any(|&ratio| ratio < FLOOR);
        let ratio: Vec<_> = band.ratio.iter().map(|ratio| ratio.max(FLOOR)).collect();
        axes.line(drawing, k, &ratio, pen(kind));
    }
    axes.level(drawing, 1.0, Pen::dashed(Colour::BLACK, 1.0));
    if floored {
        axes.note(drawing, "at 10^{-6}: none but rounding", 0.09);
    }
    let first = half == Half::Gaussian;
    // Half of the legend in each panel leaves room for the curves.
    let kinds = if first { [Kind::Normal, Kind::NormalPaired] } else { [Kind::Fixed, Kind::FixedPaired] };
    axes.legend(drawing, &kinds.map(|kind| (Key::Line(pen(kind)), kind.name())), [true, false]);
    axes.frame(drawing, "*k*  [*h*/Mpc]", if first { "*σ* / *σ*_{th}  per simulation" } else { "" });
}
