//! The figures, in the style of the paper's appendix: Normal in red, Fixed in blue, their inverted in magenta and
//! cyan; a light shade is the scatter of one simulation, a dark one the error of the mean.

mod power;
mod ratio;
mod slice;
mod squeezed;

use crate::Failure;
use crate::axes::{Axis, MARGIN_BOTTOM, MARGIN_LEFT};
use crate::drawing::{Area, Colour, Drawing};
use crate::suite::{Amplitude, Half, Suite};

const NORMAL: Colour = Colour::new(214, 39, 40);
const FIXED: Colour = Colour::new(31, 88, 180);
const NORMAL_PAIRED: Colour = Colour::new(226, 119, 194);
const FIXED_PAIRED: Colour = Colour::new(23, 170, 200);
const GREY: Colour = Colour::new(110, 110, 110);

/// File name without extension, and drawing, of each figure.
///
/// # Errors
/// If the suite lacks the slices of its first seed.
pub(crate) fn all(suite: &Suite) -> Result<[(&'static str, Drawing); 4], Failure> {
    Ok([
        ("slice", slice::draw(suite)?),
        ("power", power::draw(suite)),
        ("ratio", ratio::draw(suite)),
        ("squeezed", squeezed::draw(suite)),
    ])
}

const fn colour(amplitude: Amplitude) -> Colour {
    match amplitude {
        Amplitude::Normal => NORMAL,
        Amplitude::Fixed => FIXED,
    }
}

fn half_title(suite: &Suite, half: Half) -> String {
    format!("*f*_{{NL}} = {}", suite.configuration.fnl_of(half))
}

/// All of k with a little room at the ends.
fn k_axis(suite: &Suite) -> Axis {
    let k = &suite.bins().k;
    Axis::logarithmic(0.85 * k[0], 1.15 * k[k.len() - 1])
}

const PANEL_WIDTH: f64 = 420.0;
const MARGIN_TOP: f64 = 34.0;
const MARGIN_RIGHT: f64 = 18.0;

/// Two columns of panels that touch, f_NL = 0 to the left, of the given heights from the top.
fn columns<const ROWS: usize>(heights: [f64; ROWS]) -> (Drawing, [[Area; ROWS]; 2]) {
    let width = MARGIN_LEFT + 2.0 * PANEL_WIDTH + MARGIN_RIGHT;
    let drawing = Drawing::new(width, MARGIN_TOP + heights.iter().sum::<f64>() + MARGIN_BOTTOM);
    let areas = [0.0, 1.0].map(|column| {
        let mut top = MARGIN_TOP;
        heights.map(|height| {
            let area = Area::new(MARGIN_LEFT + column * PANEL_WIDTH, top, PANEL_WIDTH, height);
            top += height;
            area
        })
    });
    (drawing, areas)
}
