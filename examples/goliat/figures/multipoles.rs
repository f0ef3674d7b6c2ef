//! Multipoles of the first seed's particles in redshift space over linear theory in real space, and Kaiser's values.

use super::{Suite, colour, columns, half_title, k_axis, over};
use crate::Failure;
use crate::axes::{Axes, Axis, Key};
use crate::drawing::{Colour, Drawing, Pen};
use crate::suite::{Amplitude, Half, Phase, Variant};

pub(super) fn draw(suite: &Suite) -> Result<Drawing, Failure> {
    let (mut drawing, areas) = columns([330.0]);
    let bins = suite.bins();
    for (half, [area]) in [Half::Gaussian, Half::Local].into_iter().zip(areas) {
        let axes = Axes { area, x: k_axis(suite), y: Axis::linear(-0.3, 2.9) };
        let theory = Pen::dashed(Colour::BLACK, 1.2);
        for amplitude in [Amplitude::Normal, Amplitude::Fixed] {
            let variant = Variant { amplitude, phase: Phase::Original, half };
            let multipoles =
                suite.get(0, variant).early.multipoles.as_ref().ok_or("the first seed has no multipoles")?;
            for (l, power) in multipoles.iter().enumerate() {
                axes.line(&mut drawing, &bins.k, &over(power, &bins.theory), pen(amplitude, l));
            }
        }
        for linear in &suite.configuration.linear_multipoles {
            axes.line(&mut drawing, &bins.k, &over(linear, &bins.theory), theory);
        }
        axes.title(&mut drawing, &half_title(suite, half));
        if half == Half::Gaussian {
            let lines = ["*P*_{0}, Fixed", "*P*_{2}, Fixed", "*P*_{4}, Fixed"];
            let fixed = [0, 1, 2].map(|l| (Key::Line(pen(Amplitude::Fixed, l)), lines[l]));
            axes.legend(&mut drawing, &fixed, [true, false]);
        } else {
            let entries = [
                (Key::Line(pen(Amplitude::Normal, 0)), "the same, Normal"),
                (Key::Line(theory), "linear theory (Kaiser)"),
            ];
            axes.legend(&mut drawing, &entries, [true, false]);
        }
        let label =
            if half == Half::Gaussian { "*P*_{ℓ}(*k*) / *P*_{linear}(*k*),  first seed" } else { "" };
        axes.frame(&mut drawing, "*k*  [*h*/Mpc]", label);
    }
    Ok(drawing)
}

/// Higher multipoles in lighter and broken lines.
fn pen(amplitude: Amplitude, order: usize) -> Pen {
    let shade = colour(amplitude);
    match order {
        0 => Pen::solid(shade, 1.8),
        1 => Pen::dashed(shade, 1.8),
        _ => Pen::solid(shade.fade(0.55), 1.4),
    }
}
