//! Posteriors on the mean with the error of one simulation: of b_g where f_NL = 0, and of b_g and p where it is not (the paper's Figures 3 and 6).

use super::{GREY, MARGIN_RIGHT, MARGIN_TOP, PANEL_WIDTH, Suite, half_title, holding, pen, shade};
use crate::Failure;
use crate::axes::{Axes, Axis, Key, MARGIN_BOTTOM, MARGIN_LEFT};
use crate::bias::{Case, Fit};
use crate::drawing::{Area, Colour, Drawing, Pen};
use crate::fnl::Analysis;
use crate::statistics::Kind;
use crate::suite::Half;

const HEIGHT: f64 = 380.0;
/// Of the error of the mean.
const ALL: Colour = Colour::new(44, 140, 60);

pub(super) fn draw(suite: &Suite, analysis: &Analysis) -> Result<Drawing, Failure> {
    let width = 2.0 * (MARGIN_LEFT + PANEL_WIDTH) + MARGIN_RIGHT;
    let mut drawing = Drawing::new(width, MARGIN_TOP + HEIGHT + MARGIN_BOTTOM);
    let area = |column: f64| {
        Area::new(MARGIN_LEFT + column * (PANEL_WIDTH + MARGIN_LEFT), MARGIN_TOP, PANEL_WIDTH, HEIGHT)
    };
    draw_bias(&mut drawing, suite, analysis, area(0.0))?;
    draw_contours(&mut drawing, suite, analysis, area(1.0))?;
    Ok(drawing)
}

fn draw_bias(drawing: &mut Drawing, suite: &Suite, analysis: &Analysis, area: Area) -> Result<(), Failure> {
    let mut curves = Vec::new();
    for row in &analysis.rows {
        let of = &row.halves[0];
        if let Some(fit) = &of.mean[Case::Bias as usize] {
            let measured = of.by_measured.as_ref().map(|fit| fit.density(0)).transpose()?;
            curves.push((row.kind, *fit.b_g(), fit.density(0)?, measured));
        }
    }
    let regions = || curves.iter().map(|(_, b_g, ..)| b_g);
    let x = holding(
        regions().flat_map(|of| [of.centre - 3.2 * of.half_width, of.centre + 3.2 * of.half_width]),
        0.0,
    );
    let highest = |density: &[f64]| density.iter().copied().fold(0.0, f64::max);
    let high = curves.iter().fold(0.0, |high: f64, (_, _, one, _)| high.max(highest(&one.density)));
    let axes = Axes { area, x, y: Axis::linear(0.0, 1.6 * high) };
    let mut names = Vec::new();
    for (kind, b_g, density, measured) in &curves {
        axes.line(drawing, &density.x, &density.density, pen(*kind));
        if let Some(of) = measured {
            let dots = Pen { colour: shade(*kind), width: 1.2, dashes: &[1.5, 3.0] };
            axes.line(drawing, &of.x, &of.density, dots);
        }
        names.push((*kind, format!("{}: {:.2} ± {:.2}", kind.name(), b_g.centre, b_g.half_width)));
    }
    let entries: Vec<_> = names.iter().map(|(kind, name)| (Key::Line(pen(*kind)), name.as_str())).collect();
    axes.legend(drawing, &entries, [false, false]);
    let dots = Pen { colour: GREY, width: 1.2, dashes: &[1.5, 3.0] };
    axes.legend(drawing, &[(Key::Line(dots), "measured *σ*(*k*)")], [true, false]);
    axes.title(drawing, &half_title(suite, Half::Gaussian));
    axes.frame(drawing, "*b*_{g}", "density of the posterior");
    Ok(())
}

fn draw_contours(
    drawing: &mut Drawing,
    suite: &Suite,
    analysis: &Analysis,
    area: Area,
) -> Result<(), Failure> {
    let kinds = [Kind::Normal, Kind::Fixed, Kind::FixedPaired];
    let fits = kinds
        .map(|kind| (pen(kind), analysis.row(kind).halves[1].mean[Case::Universality as usize].as_ref()));
    let all = analysis.row(Kind::FixedPaired).halves[1].all.as_ref();
    let names = ["Normal", "Fixed", "Fixed-Paired", "the mean of all Fixed"];
    let mut curves = Vec::new();
    for ((pen, fit), name) in fits.into_iter().chain([(Pen::solid(ALL, 1.8), all)]).zip(names) {
        if let Some(fit) = fit {
            let label = |fit: &Fit| {
                format!("{name}: *p* = {:.2} ± {:.2}", fit.second().centre, fit.second().half_width)
            };
            curves.push((pen, label(fit), [fit.contour(1.0)?, fit.contour(4.0)?]));
        }
    }
    // (p, b_g) from (b_g, p).
    let turned = |segments: &[[f64; 4]]| -> Vec<[f64; 4]> {
        segments.iter().map(|&[a, b, c, d]| [b, a, d, c]).collect()
    };
    let outer = || curves.iter().flat_map(|(_, _, [_, outer])| outer);
    let x = holding(outer().flat_map(|of| [of[1], of[3]]).chain([1.0]), 0.05);
    let (low, high) = outer()
        .flat_map(|of| [of[0], of[2]])
        .fold((f64::INFINITY, 0.0f64), |(low, high), b| (low.min(b), high.max(b)));
    // Room for the legend above.
    let axes = Axes { area, x, y: Axis::linear(low - 0.05 * (high - low), high + 0.45 * (high - low)) };
    axes.upright(drawing, 1.0, Pen::dashed(GREY.fade(0.7), 1.0));
    for (pen, _, [inner, outer]) in &curves {
        axes.segments(drawing, &turned(inner), Pen::solid(pen.colour, 1.8));
        axes.segments(drawing, &turned(outer), Pen::solid(pen.colour.fade(0.7), 1.0));
    }
    let entries: Vec<_> =
        curves.iter().map(|(pen, name, _)| (Key::Line(Pen::solid(pen.colour, 1.8)), name.as_str())).collect();
    axes.legend(drawing, &entries, [true, false]);
    axes.title(drawing, &format!("{},  Δ*χ*^{{2}} = 1 and 4", half_title(suite, Half::Local)));
    axes.frame(drawing, "*p*", "*b*_{g}");
    Ok(())
}
