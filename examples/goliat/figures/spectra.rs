//! The paper's Figure 1: power spectra of halos and matter at z = 1, Fixed against Normal and Inverted against Original.

use super::{FIXED, FIXED_PAIRED, GREY, NORMAL, NORMAL_PAIRED, Suite, columns, half_title, k_axis};
use crate::axes::{Axes, Axis, Key};
use crate::drawing::{Colour, Drawing, Pen};
use crate::late_statistics::{Tracer, groups, have_halos, late_band, mean_k, relative, spread};
use crate::statistics::Kind;
use crate::suite::{Amplitude, Half, Phase, Variant};

/// Whose mean is compared with that of Normal-Original, and how it is drawn.
const OTHERS: [(Amplitude, Phase, Colour, &str); 3] = [
    (Amplitude::Normal, Phase::Inverted, NORMAL_PAIRED, "Normal, Inverted"),
    (Amplitude::Fixed, Phase::Original, FIXED, "Fixed"),
    (Amplitude::Fixed, Phase::Inverted, FIXED_PAIRED, "Fixed, Inverted"),
];

pub(super) fn draw(suite: &Suite) -> Drawing {
    let (mut drawing, areas) = columns([300.0, 190.0, 190.0]);
    let tracers = Tracer::ALL.map(|tracer| (tracer, tracer == Tracer::Matter || have_halos(suite)));
    for (half, [upper, middle, lower]) in [Half::Gaussian, Half::Local].into_iter().zip(areas) {
        let first = half == Half::Gaussian;
        let label = |text| if first { text } else { "" };
        let x = k_axis(suite);
        let power = Axes { area: upper, x, y: power_axis(suite) };
        for (tracer, there) in tracers {
            if there {
                draw_power(&mut drawing, suite, &power, tracer, half);
            }
        }
        let linear = Pen::dashed(Colour::BLACK, 1.2);
        power.line(&mut drawing, &suite.bins().k, &suite.bins().late_theory, linear);
        power.title(&mut drawing, &half_title(suite, half));
        let entries = if first {
            vec![
                (Key::Line(Pen::solid(NORMAL, 2.0)), "Normal: halos (thick), matter"),
                (Key::Line(Pen::solid(FIXED, 2.0)), "Fixed: halos (thick), matter"),
                (Key::Line(linear), "linear theory"),
            ]
        } else {
            vec![
                (Key::Band(NORMAL.fade(0.15)), "*σ* of one Normal"),
                (Key::Band(GREY.fade(0.3)), "*σ* of the mean"),
            ]
        };
        power.legend(&mut drawing, &entries, [false, true]);
        if !first {
            let keys = OTHERS.map(|(_, phase, colour, name)| (Key::Line(pen(phase, colour)), name));
            power.legend(&mut drawing, &keys, [true, false]);
        }
        power.frame(&mut drawing, "", label("*P*(*k*)  [(Mpc/*h*)^{3}],  *z* = 1"));

        for ((tracer, there), area) in tracers.into_iter().zip([middle, lower]) {
            let reach = reach(suite, tracer, there);
            let axes = Axes { area, x, y: Axis::linear(1.0 - reach, 1.0 + reach) };
            if there {
                draw_ratios(&mut drawing, suite, &axes, tracer, half);
            } else {
                axes.note(&mut drawing, "too few halos", 0.5);
            }
            let name = match tracer {
                Tracer::Halos => "halos,  *P* / *P*_{Normal}",
                Tracer::Matter => "matter,  *P* / *P*_{Normal}",
            };
            axes.frame(
                &mut drawing,
                if tracer == Tracer::Matter { "*k*  [*h*/Mpc]" } else { "" },
                label(name),
            );
        }
    }
    drawing
}

const fn pen(phase: Phase, colour: Colour) -> Pen {
    match phase {
        Phase::Original => Pen::solid(colour, 2.0),
        Phase::Inverted => Pen::dashed(colour, 1.8),
    }
}

fn power_axis(suite: &Suite) -> Axis {
    let bins = suite.bins();
    let lowest = bins.late_theory.iter().copied().fold(f64::INFINITY, f64::min);
    let band = |tracer| late_band(suite, tracer, Kind::Normal, Half::Local).mean;
    let highest = Tracer::ALL.into_iter().flat_map(band).fold(0.0, f64::max);
    Axis::logarithmic(0.5 * lowest, 3.0 * highest)
}

fn draw_power(drawing: &mut Drawing, suite: &Suite, axes: &Axes, tracer: Tracer, half: Half) {
    let k = &suite.bins().k;
    let width = if tracer == Tracer::Halos { 2.2 } else { 1.2 };
    // A logarithm takes no spectrum that noise has made negative.
    let positive =
        |values: Vec<f64>| -> Vec<f64> { values.into_iter().map(|value| value.max(1e-3)).collect() };
    for (kind, colour) in [(Kind::Normal, NORMAL), (Kind::Fixed, FIXED)] {
        let band = late_band(suite, tracer, kind, half);
        if kind == Kind::Normal {
            let around = |sign: f64| {
                positive(
                    band.mean.iter().zip(&band.deviation).map(|(mean, sigma)| mean + sign * sigma).collect(),
                )
            };
            axes.band(drawing, k, &around(-1.0), &around(1.0), colour.fade(0.15));
        }
        axes.line(drawing, k, &positive(band.mean), Pen::solid(colour, width));
    }
}

/// Half the height of a panel of ratios: what is drawn in it, from the second group on; the first scatters most.
fn reach(suite: &Suite, tracer: Tracer, there: bool) -> f64 {
    if !there {
        return 1.0;
    }
    let groups = groups(&suite.bins().k);
    let most = groups.iter().skip(1).flat_map(|range| {
        [Half::Gaussian, Half::Local].map(|half| {
            let ratios = OTHERS.map(|(amplitude, phase, ..)| {
                let ratio = relative(suite, tracer, Variant { amplitude, phase, half }, range);
                (ratio.value - 1.0).abs()
            });
            ratios.into_iter().fold(spread(suite, tracer, half, range), f64::max)
        })
    });
    1.15 * most.fold(0.01, f64::max)
}

fn draw_ratios(drawing: &mut Drawing, suite: &Suite, axes: &Axes, tracer: Tracer, half: Half) {
    let groups = groups(&suite.bins().k);
    let k: Vec<f64> = groups.iter().map(|range| mean_k(suite.bins(), range)).collect();
    let sigma: Vec<f64> = groups.iter().map(|range| spread(suite, tracer, half, range)).collect();
    let around = |width: f64| -> Vec<f64> { sigma.iter().map(|sigma| 1.0 + width * sigma).collect() };
    let error = (suite.seeds.len() as f64).sqrt().recip();
    axes.band(drawing, &k, &around(-1.0), &around(1.0), NORMAL.fade(0.15));
    axes.band(drawing, &k, &around(-error), &around(error), GREY.fade(0.3));
    axes.level(drawing, 1.0, Pen::dashed(Colour::BLACK, 1.0));
    for (amplitude, phase, colour, _) in OTHERS {
        let ratio: Vec<f64> = groups
            .iter()
            .map(|range| relative(suite, tracer, Variant { amplitude, phase, half }, range).value)
            .collect();
        axes.line(drawing, &k, &ratio, pen(phase, colour));
    }
}
