//! The bias of halos of the mean of Normal and of Fixed simulations, and its best fits (the paper's Figures 4 and 5).

use fixpair::variance::bias::{Spectrum, measured_bias};

use super::{FIXED, GREY, NORMAL, Suite, columns};
use crate::Failure;
use crate::axes::{Axes, Axis, Key};
use crate::bias::Case;
use crate::drawing::{Colour, Drawing, Pen};
use crate::fnl::{Analysis, Row};
use crate::statistics::Kind;

/// Shown beyond the bins that are fitted.
const BEYOND: f64 = 2.5;

/// Dashes of each case.
const fn pen(case: Case, colour: Colour) -> Pen {
    match case {
        Case::Bias => Pen::solid(colour, 1.6),
        Case::Universality => Pen { colour: Colour::BLACK, width: 1.6, dashes: &[7.0, 4.0] },
        Case::Fnl => Pen { colour, width: 3.0, dashes: &[1.5, 3.5] },
    }
}

/// k, b and its error with sigma of one simulation, where P > 0.
fn points(suite: &Suite, row: &Row, half: usize, count: usize) -> Vec<[f64; 3]> {
    let (bins, scatter) = (suite.bins(), &row.halves[half].scatter);
    let of = |i: usize| {
        let (mut b, mut error) = ([0.0], [0.0]);
        let one = i..i + 1;
        let (power, sigma) = (&scatter.power[one.clone()], &scatter.sigma[one.clone()]);
        measured_bias(&mut b, &mut error, Spectrum::HaloHalo, power, sigma, &bins.late_theory[one]).ok()?;
        Some([bins.k[i], b[0], error[0]])
    };
    (0..count).filter_map(of).collect()
}

pub(super) fn draw(suite: &Suite, analysis: &Analysis) -> Result<Drawing, Failure> {
    let (mut drawing, areas) = columns([380.0]);
    let (bins, k_max) = (suite.bins(), suite.configuration.k_max);
    let count = bins.k.partition_point(|&k| k < BEYOND * k_max);
    let rows = [Kind::Normal, Kind::Fixed].map(|kind| analysis.row(kind));
    let all = rows.map(|row| [0, 1].map(|half| points(suite, row, half, count)));
    let fitted = all.iter().flatten().flatten().filter(|[k, ..]| *k <= k_max);
    let (low, high) = fitted.fold((f64::INFINITY, 0.0f64), |(low, high), [_, b, error]| {
        (low.min(b - error), high.max(b + error))
    });
    let room = 0.12 * (high - low);
    let x = Axis::logarithmic(0.85 * bins.k[0], 1.1 * bins.k[count - 1]);
    for (((row, points), [area]), colour) in rows.into_iter().zip(&all).zip(areas).zip([NORMAL, FIXED]) {
        let axes = Axes { area, x, y: Axis::linear((low - 2.0 * room).max(0.0), high + room) };
        axes.upright(&mut drawing, k_max, Pen { colour: GREY, width: 1.2, dashes: &[2.0, 3.0] });
        let [gaussian, local] = [0, 1].map(|half| &row.halves[half].mean);
        if let Some(fit) = &gaussian[Case::Bias as usize] {
            let b_g = fit.b_g();
            let ends = [0.85 * bins.k[0], k_max];
            axes.band(&mut drawing, &ends, &[b_g.low; 2], &[b_g.high; 2], GREY.fade(0.3));
        }
        for case in Case::ALL {
            if let Some(fit) = &local[case as usize] {
                axes.line(
                    &mut drawing,
                    &bins.k[..count],
                    &fit.bias(&bins.late_alpha[..count])?,
                    pen(case, colour),
                );
            }
        }
        let [gaussian, local] = points;
        axes.points(&mut drawing, gaussian, colour.fade(0.0));
        // A little to the side, so that both bars are seen.
        let shifted: Vec<_> = local.iter().map(|[k, b, error]| [1.012 * k, *b, *error]).collect();
        axes.points(&mut drawing, &shifted, colour);
        let first = row.kind == Kind::Normal;
        axes.title(&mut drawing, if first { "Normal" } else { "Fixed" });
        let fnl = suite.configuration.fnl;
        let local = format!("*f*_{{NL}} = {fnl}, mean of all");
        let known = format!("(i) *b*_{{g}} free;  *p* = 1, *f*_{{NL}} = {fnl}");
        let known_too = format!("(ii) *b*_{{g}}, *p* free;  *f*_{{NL}} = {fnl}");
        let entries = if first {
            vec![
                (Key::Disc(colour), local.as_str()),
                (Key::Disc(colour.fade(0.0)), "*f*_{NL} = 0, mean of all"),
                (Key::Band(GREY.fade(0.3)), "*f*_{NL} = 0: *b*_{g} to 68%"),
            ]
        } else {
            vec![
                (Key::Line(pen(Case::Bias, colour)), known.as_str()),
                (Key::Line(pen(Case::Universality, colour)), known_too.as_str()),
                (Key::Line(pen(Case::Fnl, colour)), "(iii) *b*_{g}, *f*_{NL} free;  *p* = 1"),
            ]
        };
        axes.legend(&mut drawing, &entries, [true, true]);
        axes.frame(
            &mut drawing,
            "*k*  [*h*/Mpc]",
            if first { "*b*(*k*) = (*P*_{h} / *P*_{lin})^{1/2},  *z* = 1" } else { "" },
        );
    }
    Ok(drawing)
}
