//! The figures, in the style of the paper: Normal in red, Fixed in blue, their inverted in magenta and
//! cyan; a light shade is the scatter of one simulation, a dark one the error of the mean.

mod bias;
mod bispectrum;
mod histograms;
mod multipoles;
mod pairs;
mod posteriors;
mod ratio;
mod scatter;
mod slice;
mod spectra;
mod squeezed;

use crate::Failure;
use crate::axes::{Axes, Axis, Key, MARGIN_BOTTOM, MARGIN_LEFT};
use crate::drawing::{Area, Colour, Drawing, Pen};
use crate::fnl::Analysis;
use crate::statistics::{Band, Kind};
use crate::suite::{Amplitude, Half, Suite};

const NORMAL: Colour = Colour::new(214, 39, 40);
const FIXED: Colour = Colour::new(31, 88, 180);
const NORMAL_PAIRED: Colour = Colour::new(226, 119, 194);
const FIXED_PAIRED: Colour = Colour::new(23, 170, 200);
const GREY: Colour = Colour::new(110, 110, 110);

/// File name without extension, and drawing, of each figure.
///
/// # Errors
/// If the suite lacks the slices or multipoles of its first seed, and those of kernels.
pub(crate) fn all(
    suite: &Suite,
    analysis: Option<&Analysis>,
) -> Result<Vec<(&'static str, Drawing)>, Failure> {
    let mut figures = vec![
        ("spectra", spectra::draw(suite)),
        ("scatter", scatter::draw(suite)),
        ("slice", slice::draw(suite)?),
        ("ratio", ratio::draw(suite)),
        ("squeezed", squeezed::draw(suite)),
        ("bispectrum", bispectrum::draw(suite)),
        ("multipoles", multipoles::draw(suite)?),
    ];
    if let Some(analysis) = analysis {
        figures.extend([
            ("bias", bias::draw(suite, analysis)?),
            ("posteriors", posteriors::draw(suite, analysis)?),
            ("pairs", pairs::draw(suite, analysis)?),
            ("histograms", histograms::draw(suite, analysis)?),
        ]);
    }
    Ok(figures)
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

/// The line of each type where all four are compared.
const fn pen(kind: Kind) -> Pen {
    match kind {
        Kind::Normal | Kind::Fixed => Pen::solid(shade(kind), 1.8),
        Kind::NormalPaired | Kind::FixedPaired => Pen::dashed(shade(kind), 1.8),
    }
}

/// The colour of each type where all four are compared.
const fn shade(kind: Kind) -> Colour {
    match kind {
        Kind::Normal => NORMAL,
        Kind::NormalPaired => NORMAL_PAIRED,
        Kind::Fixed => FIXED,
        Kind::FixedPaired => FIXED_PAIRED,
    }
}

/// An axis that holds all values, if there are any, and a margin.
fn holding(values: impl Iterator<Item = f64>, margin: f64) -> Axis {
    let (low, high) = values
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| (low.min(value), high.max(value)));
    if low > high {
        return Axis::linear(0.0, 1.0);
    }
    let room = margin * (high - low);
    Axis::linear(low - room, high + room)
}

/// All of k with a little room at the ends.
fn k_axis(suite: &Suite) -> Axis {
    let k = &suite.bins().k;
    Axis::logarithmic(0.85 * k[0], 1.15 * k[k.len() - 1])
}

/// Spectrum over theory, bin by bin.
fn over(power: &[f64], theory: &[f64]) -> Vec<f64> {
    power.iter().zip(theory).map(|(power, theory)| power / theory).collect()
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

/// Lowest sigma/sigma_th of the figures.
const FLOOR: f64 = 1e-6;

/// Sigma/sigma_th of both halves, with room for a legend.
fn scatter_axis(bands: &[[Band; 4]; 2]) -> Axis {
    let ratios = bands.iter().flatten().flat_map(|band| &band.ratio);
    let lowest = ratios.fold(0.1, |low: f64, &ratio| low.min(ratio.max(FLOOR)));
    Axis::logarithmic(0.5 * lowest, 3.0 * lowest.powf(-0.4))
}

/// Sigma/sigma_th of the four types.
fn draw_scatter(drawing: &mut Drawing, k: &[f64], axes: &Axes, bands: &[Band; 4], half: Half) {
    let mut floored = false;
    for (kind, band) in Kind::ALL.into_iter().zip(bands) {
        floored |= band.ratio.iter().any(|&ratio| ratio < FLOOR);
        let ratio: Vec<_> = band.ratio.iter().map(|ratio| ratio.max(FLOOR)).collect();
        axes.line(drawing, k, &ratio, pen(kind));
    }
    axes.level(drawing, 1.0, Pen::dashed(Colour::BLACK, 1.0));
    if floored {
        axes.note(drawing, "at 10^{-6}: none but rounding", 0.09);
    }
    let first = half == Half::Gaussian;
    // Half of the legend in each panel leaves room for the curves.
    let kinds = if first { [Kind::Normal, Kind::NormalPaired] } else { [Kind::Fixed, Kind::FixedPaired] };
    axes.legend(drawing, &kinds.map(|kind| (Key::Line(pen(kind)), kind.name())), [true, false]);
    axes.frame(drawing, "*k*  [*h*/Mpc]", if first { "*σ* / *σ*_{th}  per simulation" } else { "" });
}
