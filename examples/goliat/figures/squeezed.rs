//! f_NL from the bispectrum: original against inverted seed by seed, and what each way of estimating it scatters.

use super::{FIXED, GREY, MARGIN_TOP, NORMAL, Suite, colour, holding, shade};
use crate::axes::{Axes, Axis, Key, MARGIN_BOTTOM, MARGIN_LEFT};
use crate::drawing::{Area, Colour, Drawing, Pen};
use crate::statistics::{Kind, differences, error_of_mean, estimates, mean};
use crate::suite::{Amplitude, Half, Phase, Variant};
use crate::text::{self, Anchor, Lettering};

const PANEL: f64 = 400.0;
const NAMES: f64 = 225.0;
const RIGHT: f64 = 430.0;

pub(super) fn draw(suite: &Suite) -> Drawing {
    let width = MARGIN_LEFT + PANEL + NAMES + RIGHT + 18.0;
    let mut drawing = Drawing::new(width, MARGIN_TOP + PANEL + MARGIN_BOTTOM);
    draw_pairs(&mut drawing, suite, Area::new(MARGIN_LEFT, MARGIN_TOP, PANEL, PANEL));
    draw_strips(&mut drawing, suite, Area::new(MARGIN_LEFT + PANEL + NAMES, MARGIN_TOP, RIGHT, PANEL));
    drawing
}

fn draw_pairs(drawing: &mut Drawing, suite: &Suite, area: Area) {
    let value = |seed, variant| suite.get(seed, variant).early.fnl;
    let all = (0..suite.seeds.len()).flat_map(|seed| Variant::all().map(|variant| value(seed, variant)));
    let fnl = suite.configuration.fnl;
    let axis = holding(all.chain([0.0, fnl]), 0.08);
    let axes = Axes { area, x: axis, y: axis };
    for truth in [0.0, fnl] {
        let grey = Pen::dashed(GREY.fade(0.7), 1.0);
        axes.level(drawing, truth, grey);
        axes.upright(drawing, truth, grey);
    }
    // Below the points, so that it hides none.
    let local = format!("Normal, *f*_{{NL}} = {fnl}");
    let fixed_local = format!("Fixed, *f*_{{NL}} = {fnl}");
    let entries = [
        (Key::Disc(NORMAL.fade(0.0)), "Normal, *f*_{NL} = 0"),
        (Key::Disc(FIXED.fade(0.0)), "Fixed, *f*_{NL} = 0"),
        (Key::Disc(NORMAL.fade(0.55)), local.as_str()),
        (Key::Disc(FIXED.fade(0.55)), fixed_local.as_str()),
    ];
    axes.legend(drawing, &entries, [false, false]);
    for half in [Half::Gaussian, Half::Local] {
        for amplitude in [Amplitude::Normal, Amplitude::Fixed] {
            // f_NL = 0 is hollow.
            let opacity = if half == Half::Gaussian { 0.0 } else { 0.55 };
            for seed in 0..suite.seeds.len() {
                let [x, y] = [Phase::Original, Phase::Inverted]
                    .map(|phase| value(seed, Variant { amplitude, phase, half }));
                drawing.disc(axes.place(x, y), 4.0, colour(amplitude).fade(opacity));
            }
        }
    }
    axes.title(drawing, "Each seed");
    axes.frame(drawing, "*f*_{NL} measured, Original", "*f*_{NL} measured, Inverted");
}

/// A row of the right panel: a name, the estimates minus the truth, and a colour.
struct Strip {
    name: String,
    errors: Vec<f64>,
    colour: Colour,
}

fn strips(suite: &Suite) -> Vec<Strip> {
    let fnl = suite.configuration.fnl;
    let read = |kind, half| estimates(suite, kind, half, |one| one.early.fnl);
    let strip = |name: String, values: Vec<f64>, truth: f64, colour| Strip {
        name,
        errors: values.into_iter().map(|value| value - truth).collect(),
        colour,
    };
    let mut rows = Vec::new();
    for half in [Half::Gaussian, Half::Local] {
        let truth = suite.configuration.fnl_of(half);
        for kind in Kind::ALL {
            rows.push(strip(
                format!("{}, *f*_{{NL}} = {truth}", kind.name()),
                read(kind, half),
                truth,
                shade(kind),
            ));
        }
    }
    let halves = |kind| (read(kind, Half::Local), read(kind, Half::Gaussian));
    let (local, gaussian) = halves(Kind::Normal);
    rows.push(strip(
        format!("Normal, different seeds, {fnl} − 0"),
        differences(&local, &gaussian, false),
        fnl,
        GREY,
    ));
    for kind in Kind::ALL {
        let (local, gaussian) = halves(kind);
        let name = format!("{}, Matched, {fnl} − 0", kind.name());
        rows.push(strip(name, differences(&local, &gaussian, true), fnl, shade(kind)));
    }
    rows
}

fn draw_strips(drawing: &mut Drawing, suite: &Suite, area: Area) {
    let rows = strips(suite);
    let x = holding(rows.iter().flat_map(|row| row.errors.iter().copied()).chain([0.0]), 0.06);
    let axes = Axes { area, x, y: Axis::blank() };
    axes.upright(drawing, 0.0, Pen::dashed(GREY.fade(0.7), 1.0));
    for (i, row) in rows.iter().enumerate() {
        let height = area.top + area.height * (i as f64 + 0.5) / rows.len() as f64;
        let across = |value| area.left + x.fraction(value) * area.width;
        for &error in &row.errors {
            drawing.disc([across(error), height], 3.0, row.colour.fade(0.25));
        }
        // The mean with its error, above the points.
        let (centre, error) = (mean(&row.errors), error_of_mean(&row.errors));
        let bar = Pen::solid(Colour::BLACK, 1.6);
        drawing.line(&[[across(centre - error), height], [across(centre + error), height]], bar);
        drawing.line(&[[across(centre), height - 6.0], [across(centre), height + 6.0]], bar);
        let at = [area.left - 8.0, height + 4.0];
        text::write(drawing, &row.name, at, &Lettering::new(12.0, Anchor::End));
        if i == 4 || i == 8 {
            let edge = height - 0.5 * area.height / rows.len() as f64;
            drawing.line(&[[area.left, edge], [area.right(), edge]], Pen::solid(GREY.fade(0.5), 0.8));
        }
    }
    axes.title(drawing, "Estimate of *f*_{NL} minus truth; mean and its error in black");
    axes.frame(drawing, "*f*_{NL} measured − true", "");
}
