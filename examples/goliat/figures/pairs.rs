//! Where each simulation and pair lies in the plane of f_NL and b_g, matched ones joined, and the contours of the likelihood of the mean (the paper's
//! Figure 7).

use super::{GREY, Suite, columns, holding, shade};
use crate::Failure;
use crate::axes::{Axes, Key};
use crate::drawing::{Drawing, Pen};
use crate::fnl::Analysis;
use crate::statistics::Kind;

const GAP: f64 = 36.0;
const KINDS: [Kind; 3] = [Kind::Normal, Kind::Fixed, Kind::FixedPaired];

pub(super) fn draw(suite: &Suite, analysis: &Analysis) -> Result<Drawing, Failure> {
    let (mut drawing, [[left], [mut right]]) = columns([440.0]);
    // Apart, so that the numbers at their ends do not meet.
    right.left += GAP;
    right.width -= GAP;
    let mut contours = Vec::new();
    for kind in KINDS {
        for half in [0, 1] {
            if let Some(fit) = &analysis.row(kind).halves[half].one {
                contours.push((kind, half, [fit.contour(1.0)?, fit.contour(4.0)?]));
            }
        }
    }
    // b_g and f_NL of both halves of a seed.
    let places = |kind: Kind| -> Vec<[[f64; 2]; 2]> {
        let row = analysis.row(kind);
        let each = |half: usize, seed: usize| {
            row.halves[half].each[seed].as_ref().map_or([f64::NAN; 2], |each| [each.fnl.peak, each.b_g.peak])
        };
        row.seeds.iter().map(|&seed| [0, 1].map(|half| each(half, seed))).collect()
    };
    let fnl = suite.configuration.fnl;
    let points = || KINDS.into_iter().flat_map(places).flatten();
    let lines = || contours.iter().flat_map(|(_, _, [_, outer])| outer);
    let x = holding(
        points().map(|[x, _]| x).chain(lines().flat_map(|of| [of[1], of[3]])).chain([0.0, fnl]),
        0.05,
    );
    let y = holding(points().map(|[_, y]| y).chain(lines().flat_map(|of| [of[0], of[2]])), 0.05);

    for area in [left, right] {
        let axes = Axes { area, x, y };
        for truth in [0.0, fnl] {
            axes.upright(&mut drawing, truth, Pen::dashed(GREY.fade(0.7), 1.0));
        }
    }
    let axes = Axes { area: left, x, y };
    for kind in KINDS {
        let joint = Pen::solid(shade(kind).fade(0.45), 1.0);
        for [gaussian, local] in places(kind) {
            axes.line(&mut drawing, &[gaussian[0], local[0]], &[gaussian[1], local[1]], joint);
        }
    }
    for kind in KINDS {
        for place in places(kind) {
            for (half, [x, y]) in place.into_iter().enumerate() {
                let opacity = if half == 0 { 0.0 } else { 0.7 };
                drawing.disc(axes.place(x, y), 4.0, shade(kind).fade(opacity));
            }
        }
    }
    let names = KINDS.map(|kind| (Key::Disc(shade(kind).fade(0.7)), kind.name()));
    axes.legend(&mut drawing, &names, [true, false]);
    let halves = format!("hollow: *f*_{{NL}} = 0;  full: {fnl};  joined: Matched");
    axes.note(&mut drawing, &halves, 0.04);
    axes.title(&mut drawing, "Each simulation or pair");
    axes.frame(&mut drawing, "*f*_{NL}", "*b*_{g}");

    let axes = Axes { area: right, x, y };
    for (kind, half, [inner, outer]) in &contours {
        for (segments, width) in [(inner, 2.0), (outer, 1.1)] {
            let turned: Vec<_> = segments.iter().map(|&[a, b, c, d]| [b, a, d, c]).collect();
            // Not by dashes: segments are shorter.
            let colour = if *half == 0 { shade(*kind).fade(0.45) } else { shade(*kind) };
            axes.segments(&mut drawing, &turned, Pen::solid(colour, width));
        }
    }
    axes.note(&mut drawing, &format!("pale: *f*_{{NL}} = 0;  full: {fnl}"), 0.04);
    axes.title(&mut drawing, "The mean with the error of one:  Δ*χ*^{2} = 1 and 4");
    axes.frame(&mut drawing, "*f*_{NL}", "");
    Ok(drawing)
}
