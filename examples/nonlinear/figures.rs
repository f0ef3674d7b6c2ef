//! The figures: P(k) over HMcode, and numbers of halos over fits to simulations, at both redshifts.

use crate::axes::{Axes, Axis, Key, MARGIN_BOTTOM, MARGIN_LEFT};
use crate::drawing::{Area, Colour, Drawing, Pen};
use crate::measure::{Bin, Results};
use crate::report::{HALO_CLAIM, HALO_REACH, POWER_CLAIM, POWER_REACH, name};
use crate::theory::{Model, REDSHIFTS};

const RUN: Colour = Colour::new(31, 88, 180);
const CLAIM: Colour = Colour::new(110, 110, 110);
const OTHER: [Colour; 2] = [Colour::new(214, 39, 40), Colour::new(230, 140, 20)];

/// File name without extension, and drawing, of each figure that there are numbers for.
pub(crate) fn all(results: &Results) -> Vec<(&'static str, Drawing)> {
    let mut figures = Vec::new();
    if !results.power.is_empty() {
        figures.push(("power", power(results)));
    }
    if !results.halos.is_empty() {
        figures.push(("halos", halos(results)));
    }
    figures
}

/// A sheet with two frames side by side, one for each redshift.
fn sheet() -> (Drawing, [Area; 2]) {
    const WIDTH: f64 = 380.0;
    const HEIGHT: f64 = 300.0;
    let area =
        |column: f64| Area::new(MARGIN_LEFT + column * (WIDTH + 0.5 * MARGIN_LEFT), 36.0, WIDTH, HEIGHT);
    let areas = [area(0.0), area(1.0)];
    (Drawing::new(areas[1].right() + 20.0, areas[1].bottom() + MARGIN_BOTTOM + 8.0), areas)
}

/// A grey band of +-`part` about 1 where x is between `low` and `high`.
fn claim(drawing: &mut Drawing, axes: &Axes, [low, high]: [f64; 2], part: f64) {
    let levels = [1.0 - part, 1.0 + part];
    let [bottom, top] = levels.map(|level| [level; 2]);
    axes.band(drawing, &[low, high], &bottom, &top, CLAIM.fade(0.25));
    axes.level(drawing, 1.0, Pen::dashed(Colour::BLACK, 1.0));
}

fn power(results: &Results) -> Drawing {
    let (mut drawing, areas) = sheet();
    for (((power, z), area), first) in results.power.iter().zip(REDSHIFTS).zip(areas).zip([true, false]) {
        let k: Vec<f64> = power.theory.iter().map(|means| means.k).collect();
        let (low, high) = (0.8 * k[0], 1.1 * k[k.len() - 1]);
        let axes = Axes { area, x: Axis::logarithmic(low, high), y: Axis::linear(0.65, 1.25) };
        claim(&mut drawing, &axes, [low, POWER_REACH], POWER_CLAIM);
        for (model, colour) in (1..Model::ALL.len()).zip(OTHER) {
            let ratio: Vec<f64> =
                power.theory.iter().map(|means| means.nonlinear[model] / means.nonlinear[0]).collect();
            axes.line(&mut drawing, &k, &ratio, Pen::dashed(colour, 1.4));
        }
        let linear: Vec<f64> = power.theory.iter().map(|means| means.linear / means.nonlinear[0]).collect();
        axes.line(&mut drawing, &k, &linear, Pen::dashed(CLAIM, 1.0));
        let ratio: Vec<f64> = (0..k.len()).map(|shell| power.ratio(shell)).collect();
        if let Some(error) = &power.error {
            let around = |sign: f64| -> Vec<f64> {
                ratio.iter().zip(error).map(|(ratio, error)| ratio * (1.0 + sign * error)).collect()
            };
            axes.band(&mut drawing, &k, &around(-1.0), &around(1.0), RUN.fade(0.3));
        }
        axes.line(&mut drawing, &k, &ratio, Pen::solid(RUN, 2.0));
        axes.title(&mut drawing, &format!("*z* = {z}"));
        if first {
            let entries = [
                (Key::Line(Pen::solid(RUN, 2.0)), "fixed pair of runs"),
                (Key::Line(Pen::dashed(OTHER[0], 1.4)), Model::ALL[1].name()),
                (Key::Line(Pen::dashed(OTHER[1], 1.4)), Model::ALL[2].name()),
                (Key::Line(Pen::dashed(CLAIM, 1.0)), "linear theory"),
                (Key::Band(CLAIM.fade(0.25)), "claim"),
            ];
            axes.legend(&mut drawing, &entries, [false, true]);
        }
        let label = if first { "*P* / *P*_{HMcode-2020}" } else { "" };
        axes.frame(&mut drawing, "*k* [*h*/Mpc]", label);
    }
    drawing
}

fn halos(results: &Results) -> Drawing {
    let (mut drawing, areas) = sheet();
    let shades = [RUN, OTHER[0]];
    for (output, (z, area)) in REDSHIFTS.into_iter().zip(areas).enumerate() {
        let told = |bin: &&Bin| bin.expected >= 10.0;
        let all = results.halos.iter().flat_map(|halos| &halos.bins[output]);
        let masses = || all.clone().filter(told).map(|bin| bin.mass);
        let (low, high) = (masses().fold(f64::MAX, f64::min), masses().fold(0.0, f64::max));
        let x = Axis::logarithmic(0.8 * low, 1.25 * high);
        let axes = Axes { area, x, y: Axis::linear(0.0, 1.8) };
        let least = all.clone().find(|bin| bin.particles >= HALO_REACH).map_or(low, |bin| bin.mass);
        claim(&mut drawing, &axes, [least, 1.25 * high], HALO_CLAIM);
        for (halos, shade) in results.halos.iter().zip(shades) {
            let bins: Vec<_> = halos.bins[output].iter().filter(told).collect();
            let ratios: Vec<f64> = bins.iter().map(|bin| bin.ratio()).collect();
            let masses: Vec<f64> = bins.iter().map(|bin| bin.mass).collect();
            axes.line(&mut drawing, &masses, &ratios, Pen::solid(shade, 1.4));
            for bin in bins {
                let ends = [bin.ratio() - bin.error(), bin.ratio() + bin.error()];
                axes.line(&mut drawing, &[bin.mass; 2], &ends, Pen::solid(shade, 1.2));
                drawing.disc(axes.place(bin.mass, bin.ratio().clamp(0.0, 1.8)), 3.0, shade);
            }
        }
        axes.title(&mut drawing, &format!("*z* = {z}"));
        if output == 0 {
            let names: Vec<_> = results.halos.iter().map(|halos| name(halos.fit).join(" / ")).collect();
            let mut entries: Vec<_> =
                names.iter().zip(shades).map(|(name, shade)| (Key::Disc(shade), name.as_str())).collect();
            entries.push((Key::Band(CLAIM.fade(0.25)), "claim: 100 particles and more"));
            axes.legend(&mut drawing, &entries, [false, false]);
        }
        let label = if output == 0 { "*N* found / *N* of the fit" } else { "" };
        axes.frame(&mut drawing, "*M* [Msun/*h*]", label);
    }
    drawing
}
