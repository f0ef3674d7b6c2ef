//! The squeezed bispectrum B(Delta k, k, k), mean and scatter, and linear theory; below, sigma of the four types over that of a Gaussian
//! field.

use super::{FIXED, NORMAL, Suite, columns, draw_scatter, half_title, scatter_axis};
use crate::axes::{Axes, Axis, Key};
use crate::drawing::{Colour, Drawing, Pen};
use crate::statistics::{Band, Kind, squeezed_band};
use crate::suite::Half;

pub(super) fn draw(suite: &Suite) -> Drawing {
    let (mut drawing, areas) = columns([260.0, 260.0]);
    let halves = [Half::Gaussian, Half::Local];
    let bands = halves.map(|half| Kind::ALL.map(|kind| squeezed_band(suite, kind, half)));
    let slice = &suite.bins().squeezed;
    let k = &slice.k;
    let x = Axis::logarithmic(0.9 * k[0], 1.1 * k[k.len() - 1]);
    let scatter = scatter_axis(&bands);
    // k^2 B is nearly level. One and a half sigma of one simulation fit, and the signal with most of one.
    let theory =
        |fnl: f64| scaled(k, &slice.template.iter().map(|template| fnl * template).collect::<Vec<_>>());
    let fnl = suite.configuration.fnl;
    let [most, signal] = [&scaled(k, &slice.sigma), &theory(fnl)]
        .map(|y| y.iter().fold(0.0, |most: f64, y| most.max(y.abs())));
    let reach = (signal + 0.8 * most).max(1.5 * most);
    let y = Axis::linear(-reach, reach);
    for ((half, bands), [upper, lower]) in halves.into_iter().zip(&bands).zip(areas) {
        let axes = Axes { area: upper, x, y };
        draw_means(&mut drawing, &axes, k, bands, suite.seeds.len());
        let linear = Pen::dashed(Colour::BLACK, 1.4);
        axes.line(&mut drawing, k, &theory(suite.configuration.fnl_of(half)), linear);
        axes.title(&mut drawing, &half_title(suite, half));
        let first = half == Half::Gaussian;
        let entries = if first {
            vec![
                (Key::Line(Pen::solid(NORMAL, 2.0)), "Normal, mean"),
                (Key::Band(NORMAL.fade(0.35)), "its error"),
                (Key::Band(NORMAL.fade(0.13)), "*σ* of one simulation"),
            ]
        } else {
            vec![
                (Key::Line(Pen::solid(FIXED, 2.0)), "Fixed, mean"),
                (Key::Line(Pen::solid(FIXED.fade(0.6), 1.0)), "± *σ* of one simulation"),
                (Key::Line(linear), "linear theory"),
            ]
        };
        axes.legend(&mut drawing, &entries, [true, true]);
        let label = "*k*^{2} *B*(*Δk*, *k*, *k*)  [(Mpc/*h*)^{4}]";
        axes.frame(&mut drawing, "", if first { label } else { "" });
        draw_scatter(&mut drawing, k, &Axes { area: lower, x, y: scatter }, bands, half);
    }
    drawing
}

fn scaled(k: &[f64], values: &[f64]) -> Vec<f64> {
    k.iter().zip(values).map(|(k, value)| k * k * value).collect()
}

fn draw_means(
    drawing: &mut Drawing,
    axes: &Axes,
    k: &[f64],
    [normal, _, fixed, _]: &[Band; 4],
    seeds: usize,
) {
    let around = |band: &Band, width: f64| -> Vec<f64> {
        let values: Vec<_> =
            band.mean.iter().zip(&band.deviation).map(|(mean, deviation)| mean + width * deviation).collect();
        scaled(k, &values)
    };
    // Of the mean, in units of sigma.
    let error = (seeds as f64).sqrt().recip();
    axes.band(drawing, k, &around(normal, -1.0), &around(normal, 1.0), NORMAL.fade(0.13));
    for sign in [-1.0, 1.0] {
        axes.line(drawing, k, &around(fixed, sign), Pen::solid(FIXED.fade(0.6), 1.0));
    }
    axes.band(drawing, k, &around(normal, -error), &around(normal, error), NORMAL.fade(0.35));
    axes.line(drawing, k, &scaled(k, &normal.mean), Pen::solid(NORMAL, 2.0));
    axes.line(drawing, k, &scaled(k, &fixed.mean), Pen::solid(FIXED, 2.0));
}
