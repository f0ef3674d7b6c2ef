//! One plane of the density of the first seed: Normal and Fixed, original and inverted, and what f_NL adds.

use super::{MARGIN_TOP, Suite};
use crate::Failure;
use crate::axes::{Axes, Axis, MARGIN_BOTTOM, MARGIN_LEFT};
use crate::drawing::{Area, Colour, Drawing, Pen};
use crate::suite::{Amplitude, Half, Phase, Variant};
use crate::text::{self, Anchor, Lettering};

const PANEL: f64 = 260.0;
const GAP: f64 = 28.0;
const BAR: f64 = 14.0;
const ROW_GAP: f64 = 34.0;

/// Diverging from blue over white to red, with even steps of lightness on both sides.
const COLOURS: [[u8; 3]; 9] = [
    [12, 34, 92],
    [35, 84, 155],
    [85, 143, 194],
    [167, 202, 226],
    [246, 246, 244],
    [243, 190, 160],
    [219, 116, 88],
    [174, 42, 46],
    [92, 8, 28],
];

/// The colour of `value` on a scale from -1 to 1, clamped.
fn shade(value: f64) -> [u8; 3] {
    let place = (value.clamp(-1.0, 1.0) + 1.0) * 0.5 * (COLOURS.len() - 1) as f64;
    let below = (place as usize).min(COLOURS.len() - 2);
    let part = place - below as f64;
    std::array::from_fn(|i| {
        let (a, b) = (f64::from(COLOURS[below][i]), f64::from(COLOURS[below + 1][i]));
        (a + part * (b - a)).round() as u8
    })
}

pub(super) fn draw(suite: &Suite) -> Result<Drawing, Failure> {
    let width = MARGIN_LEFT + 3.0 * (PANEL + GAP) + 6.0;
    let height = MARGIN_TOP + 2.0 * PANEL + ROW_GAP + MARGIN_BOTTOM + 72.0;
    let mut drawing = Drawing::new(width, height);
    let slice = |amplitude, phase, half| {
        let slice = suite.get(0, Variant { amplitude, phase, half }).early.slice.as_deref();
        let cells = suite.configuration.size * suite.configuration.size;
        slice.filter(|slice| slice.len() == cells).ok_or("the first seed has no slice of its density")
    };
    let half = Half::Local;
    let mut panels = Vec::new();
    for amplitude in [Amplitude::Normal, Amplitude::Fixed] {
        let original = slice(amplitude, Phase::Original, half)?.to_vec();
        let inverted = slice(amplitude, Phase::Inverted, half)?.to_vec();
        let gaussian = slice(amplitude, Phase::Original, Half::Gaussian)?;
        let difference = original.iter().zip(gaussian).map(|(local, gaussian)| local - gaussian).collect();
        panels.push([original, inverted, difference]);
    }
    let limit = |columns: [usize; 2]| {
        let values = panels.iter().flat_map(|row| columns.map(|column| &row[column])).flatten();
        let (sum, count) =
            values.fold((0.0, 0), |(sum, count), &value| (sum + f64::from(value).powi(2), count + 1));
        // Three standard deviations in two digits, so that the colour bar ends on a round number.
        two_digits(3.0 * (sum / f64::from(count.max(1))).sqrt())
    };
    let (field, change) = (limit([0, 1]), limit([2, 2]));

    let length = suite.configuration.length;
    let fnl = suite.configuration.fnl;
    let titles = [
        format!("Original, *f*_{{NL}} = {fnl}"),
        format!("Inverted, *f*_{{NL}} = {fnl}"),
        format!("Original, *f*_{{NL}} = {fnl} minus 0"),
    ];
    for (row, name) in ["Normal", "Fixed"].into_iter().enumerate() {
        for column in 0..3 {
            let left = MARGIN_LEFT + column as f64 * (PANEL + GAP);
            let area = Area::new(left, MARGIN_TOP + row as f64 * (PANEL + ROW_GAP), PANEL, PANEL);
            let scale = if column == 2 { change } else { field };
            // Rows of an image run downwards, y upwards.
            let values = panels[row][column].chunks(suite.configuration.size).rev().flatten();
            let pixels = values.map(|&value| shade(f64::from(value) / scale)).collect();
            drawing.image(&area, suite.configuration.size, pixels);
            let axes = Axes { area, x: Axis::linear(0.0, length), y: Axis::linear(0.0, length) };
            let x_label = if row == 1 { "*x*  [Mpc/*h*]" } else { "" };
            axes.frame(&mut drawing, x_label, if column == 0 { "*y*  [Mpc/*h*]" } else { "" });
            axes.title(&mut drawing, &format!("{name}: {}", titles[column]));
        }
    }
    let top = height - 42.0;
    let bar = Area::new(MARGIN_LEFT + 0.25 * PANEL, top, 1.5 * PANEL + GAP, BAR);
    colour_bar(&mut drawing, &bar, field, "Density contrast *δ* at *z* = 32");
    let bar = Area::new(MARGIN_LEFT + 2.0 * (PANEL + GAP), top, PANEL, BAR);
    colour_bar(&mut drawing, &bar, change, "Matched difference of *δ* at *z* = 32");
    Ok(drawing)
}

fn two_digits(value: f64) -> f64 {
    if value > 0.0 && value.is_finite() {
        let unit = 10f64.powf(value.log10().floor() - 1.0);
        (value / unit).round() * unit
    } else {
        1.0
    }
}

fn colour_bar(drawing: &mut Drawing, area: &Area, limit: f64, label: &str) {
    const STEPS: usize = 256;
    let pixels = (0..STEPS).map(|i| shade(2.0 * i as f64 / (STEPS - 1) as f64 - 1.0)).collect();
    drawing.image(area, STEPS, pixels);
    drawing.outline(area, Pen::solid(Colour::BLACK, 1.0));
    for (place, value) in [(0.0, -limit), (0.5, 0.0), (1.0, limit)] {
        let at = [area.left + place * area.width, area.bottom() + 16.0];
        let text = if value == 0.0 { String::from("0") } else { short(value) };
        text::write(drawing, &text, at, &Lettering::new(12.0, Anchor::Middle));
    }
    let at = [area.left + 0.5 * area.width, area.top - 8.0];
    text::write(drawing, label, at, &Lettering::new(12.0, Anchor::Middle));
}

/// Two digits, as a decimal where that is short.
fn short(value: f64) -> String {
    if value.abs() >= 1e-3 {
        let decimals = (1.0 - value.abs().log10().floor()).max(0.0) as usize;
        format!("{value:.decimals$}")
    } else {
        let power = value.abs().log10().floor();
        format!("{:.1} × 10^{{{power}}}", value / 10f64.powf(power))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_run_from_end_to_end_and_clamp() {
        assert_eq!([shade(-5.0), shade(0.0), shade(1.0)], [COLOURS[0], COLOURS[4], COLOURS[8]]);
    }

    #[test]
    fn limits_have_two_digits() {
        assert!((two_digits(0.012_67) - 0.013).abs() < 1e-15);
        assert_eq!(two_digits(0.0), 1.0);
        assert_eq!([short(0.24), short(-1.3e-4)], ["0.24", "-1.3 × 10^{-4}"]);
    }
}
