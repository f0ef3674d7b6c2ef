//! The paper's Figure 2: the scatter of the power spectra of halos and matter at z = 1 against theory.

use super::{Suite, columns, half_title, k_axis, pen};
use crate::axes::{Axes, Axis, Key};
use crate::drawing::{Colour, Drawing, Pen};
use crate::late_statistics::{Tracer, groups, have_halos, late_band, mean_k};
use crate::statistics::{Kind, quadratic_mean};
use crate::suite::Half;

pub(super) fn draw(suite: &Suite) -> Drawing {
    let (mut drawing, areas) = columns([270.0, 270.0]);
    let groups = groups(&suite.bins().k);
    let k: Vec<f64> = groups.iter().map(|range| mean_k(suite.bins(), range)).collect();
    // Averages over groups of bins: of one bin, sigma is known to 1/sqrt(2 (seeds - 1)).
    let ratio = |tracer, kind, half| -> Vec<f64> {
        let band = late_band(suite, tracer, kind, half);
        groups.iter().map(|range| quadratic_mean(&band.ratio[range.clone()])).collect()
    };
    for (half, areas) in [Half::Gaussian, Half::Local].into_iter().zip(areas) {
        for (tracer, area) in Tracer::ALL.into_iter().zip(areas) {
            let first = half == Half::Gaussian;
            let there = tracer == Tracer::Matter || have_halos(suite);
            let curves = |half| Kind::ALL.map(|kind| ratio(tracer, kind, half));
            let both = if there { [Half::Gaussian, Half::Local].map(curves) } else { Default::default() };
            let values = || both.iter().flatten().flatten().copied();
            let (low, high) = (values().fold(0.5, f64::min), values().fold(2.0, f64::max));
            let axes = Axes { area, x: k_axis(suite), y: Axis::logarithmic(0.7 * low, 1.6 * high) };
            axes.level(&mut drawing, 1.0, Pen::dashed(Colour::BLACK, 1.0));
            if there {
                for (kind, curve) in Kind::ALL.into_iter().zip(&both[half as usize]) {
                    axes.line(&mut drawing, &k, curve, pen(kind));
                }
            } else {
                axes.note(&mut drawing, "too few halos", 0.5);
            }
            if tracer == Tracer::Halos {
                axes.title(&mut drawing, &half_title(suite, half));
                let kinds =
                    if first { [Kind::Normal, Kind::NormalPaired] } else { [Kind::Fixed, Kind::FixedPaired] };
                axes.legend(
                    &mut drawing,
                    &kinds.map(|kind| (Key::Line(pen(kind)), kind.name())),
                    [true, true],
                );
            }
            let label = match tracer {
                _ if !first => "",
                Tracer::Halos => "halos,  *σ* / *σ*_{th}",
                Tracer::Matter => "matter,  *σ* / *σ*_{th}",
            };
            axes.frame(&mut drawing, if tracer == Tracer::Matter { "*k*  [*h*/Mpc]" } else { "" }, label);
        }
    }
    drawing
}
