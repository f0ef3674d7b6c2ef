//! Estimates of f_NL, and of its matched difference, as histograms, with the posterior of the mean (the paper's Figure 8).

use std::f64::consts::TAU;

use super::{GREY, MARGIN_RIGHT, MARGIN_TOP, Suite, holding, pen, shade};
use crate::Failure;
use crate::axes::{Axes, Axis, Key, MARGIN_BOTTOM, MARGIN_LEFT};
use crate::bias_report::gaussian_difference;
use crate::drawing::{Area, Drawing, Pen};
use crate::fnl::{Analysis, Row};
use crate::statistics::{Kind, deviation, mean};

const KINDS: [Kind; 3] = [Kind::Normal, Kind::Fixed, Kind::FixedPaired];
const PANEL: f64 = 330.0;
const HEIGHT: f64 = 330.0;
const GAP: f64 = 44.0;

/// Edges and heights, of unit area: bins of 0.8 deviations about the mean, whatever the type scatters.
fn histogram(values: &[f64]) -> Option<(Vec<f64>, Vec<f64>)> {
    let (centre, width) = (mean(values), 0.8 * deviation(values));
    let place = |value: f64| ((value - centre) / width + 0.5).floor();
    let places: Vec<f64> = values.iter().map(|&value| place(value)).collect();
    let (low, high) = places.iter().fold((0.0f64, 0.0f64), |(low, high), &at| (low.min(at), high.max(at)));
    if !(width > 0.0 && high - low < 100.0) {
        return None;
    }
    let count = (high - low) as usize + 1;
    let mut heights = vec![0.0; count];
    places.iter().for_each(|at| heights[(at - low) as usize] += 1.0 / (values.len() as f64 * width));
    Some(((0..=count).map(|i| centre + width * (low + i as f64 - 0.5)).collect(), heights))
}

/// A histogram as a curve.
fn steps(edges: &[f64], heights: &[f64]) -> [Vec<f64>; 2] {
    let x = edges.iter().flat_map(|&edge| [edge; 2]).collect();
    let inner = heights.iter().flat_map(|&height| [height; 2]);
    [x, std::iter::once(0.0).chain(inner).chain([0.0]).collect()]
}

/// What is drawn of one type in one panel.
struct Curves {
    kind: Kind,
    steps: [Vec<f64>; 2],
    posterior: [Vec<f64>; 2],
}

fn curves(row: &Row, panel: usize) -> Result<Option<Curves>, Failure> {
    let differences = row.differences();
    let values = if panel == 2 { &differences } else { &row.fnl[panel] };
    let Some((edges, heights)) = (values.len() >= 2).then(|| histogram(values)).flatten() else {
        return Ok(None);
    };
    let posterior = if panel == 2 {
        let gauss = |[centre, sigma]: [f64; 2]| {
            let x: Vec<f64> = (-80..=80).map(|i| centre + sigma * f64::from(i) / 20.0).collect();
            let density = |x: &f64| (-0.5 * ((x - centre) / sigma).powi(2)).exp() / (sigma * TAU.sqrt());
            let y = x.iter().map(density).collect();
            [x, y]
        };
        gaussian_difference(row).map(gauss).unwrap_or_default()
    } else {
        match &row.halves[panel].one {
            None => Default::default(),
            Some(fit) => fit.density(1).map(|density| [density.x, density.density])?,
        }
    };
    Ok(Some(Curves { kind: row.kind, steps: steps(&edges, &heights), posterior }))
}

pub(super) fn draw(suite: &Suite, analysis: &Analysis) -> Result<Drawing, Failure> {
    let width = MARGIN_LEFT + 3.0 * PANEL + 2.0 * GAP + MARGIN_RIGHT;
    let mut drawing = Drawing::new(width, MARGIN_TOP + HEIGHT + MARGIN_BOTTOM);
    let fnl = suite.configuration.fnl;
    let labels = [
        (String::from("*f*_{NL}"), String::from("*f*_{NL} = 0"), 0.0),
        (String::from("*f*_{NL}"), format!("*f*_{{NL}} = {fnl}"), fnl),
        (String::from("Δ*f*_{NL}"), format!("Matched: *f*_{{{fnl}}} − *f*_{{0}}"), fnl),
    ];
    for (panel, (label, title, truth)) in labels.into_iter().enumerate() {
        let left = MARGIN_LEFT + panel as f64 * (PANEL + GAP);
        let area = Area::new(left, MARGIN_TOP, PANEL, HEIGHT);
        let all: Vec<Curves> = KINDS
            .into_iter()
            .filter_map(|kind| curves(analysis.row(kind), panel).transpose())
            .collect::<Result<_, _>>()?;
        // Tails of a posterior that are too low to be seen need no room.
        let seen = |of: &Curves| -> Vec<f64> {
            let top = of.posterior[1].iter().copied().fold(0.0, f64::max);
            let visible = of.posterior[0].iter().zip(&of.posterior[1]).filter(|(_, y)| **y > 0.01 * top);
            visible.map(|(x, _)| *x).chain(of.steps[0].iter().copied()).collect()
        };
        let x = holding(all.iter().flat_map(seen).chain([truth]), 0.02);
        let high =
            all.iter().flat_map(|of| of.steps[1].iter().chain(&of.posterior[1])).copied().fold(0.0, f64::max);
        let axes = Axes { area, x, y: Axis::linear(0.0, if panel == 0 { 1.4 } else { 1.1 } * high) };
        axes.upright(&mut drawing, truth, Pen::dashed(GREY.fade(0.7), 1.0));
        for of in &all {
            let [x, y] = &of.steps;
            axes.band(&mut drawing, x, &vec![0.0; x.len()], y, shade(of.kind).fade(0.15));
            axes.line(&mut drawing, x, y, Pen::solid(shade(of.kind).fade(0.8), 1.0));
        }
        for of in &all {
            axes.line(&mut drawing, &of.posterior[0], &of.posterior[1], Pen { dashes: &[], ..pen(of.kind) });
        }
        if panel == 0 {
            let names: Vec<_> =
                KINDS.map(|kind| (Key::Band(shade(kind).fade(0.6)), kind.name())).into_iter().collect();
            axes.legend(&mut drawing, &names, [false, false]);
        }
        axes.title(&mut drawing, &title);
        axes.frame(&mut drawing, &label, if panel == 0 { "density" } else { "" });
    }
    Ok(drawing)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_histogram_has_unit_area_and_holds_all_values() {
        let values = [1.0, 2.0, 2.5, 3.0, 9.0];
        let (edges, heights) = histogram(&values).unwrap();
        assert_eq!(edges.len(), heights.len() + 1);
        let area: f64 =
            heights.iter().zip(edges.windows(2)).map(|(height, edge)| height * (edge[1] - edge[0])).sum();
        assert!((area - 1.0).abs() < 1e-12 && edges[0] <= 1.0 && edges[heights.len()] >= 9.0);
        assert!(histogram(&[2.0, 2.0]).is_none());
        let [x, y] = steps(&edges, &heights);
        assert!(x.len() == y.len() && y[0] == 0.0);
    }
}
