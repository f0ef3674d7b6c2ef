//! Axes: from numbers to places on the sheet, ticks, frames, legends, and what is drawn between them.

use crate::drawing::{Area, Colour, Drawing, Pen};
use crate::text::{self, Anchor, Lettering};

const TICK_SIZE: f64 = 12.0;
const LABEL_SIZE: f64 = 14.0;
const LEGEND_SIZE: f64 = 12.0;

/// Room that tick labels and the axis label take to the left of a frame and below it.
pub(crate) const MARGIN_LEFT: f64 = 72.0;
pub(crate) const MARGIN_BOTTOM: f64 = 48.0;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Scale {
    Linear,
    Logarithmic,
    /// Linear from 0 to 1, without ticks.
    Blank,
}

/// The range of one axis.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Axis {
    low: f64,
    high: f64,
    scale: Scale,
}

/// A place on an axis; only long ticks have labels.
pub(crate) struct Tick {
    value: f64,
    label: Option<String>,
}

impl Axis {
    /// A linear axis; an empty range is widened.
    pub(crate) fn linear(low: f64, high: f64) -> Self {
        let (low, high) = if high > low { (low, high) } else { (low - 1.0, low + 1.0) };
        Self { low, high, scale: Scale::Linear }
    }

    /// A logarithmic axis; both ends must be positive, an empty range is widened.
    pub(crate) fn logarithmic(low: f64, high: f64) -> Self {
        let low = if low > 0.0 { low } else { f64::MIN_POSITIVE };
        Self { low, high: if high > low { high } else { 10.0 * low }, scale: Scale::Logarithmic }
    }

    /// An axis for things that are not numbers: from 0 to 1, without ticks.
    pub(crate) const fn blank() -> Self {
        Self { low: 0.0, high: 1.0, scale: Scale::Blank }
    }

    /// 0 at the low end, 1 at the high end.
    pub(crate) fn fraction(&self, value: f64) -> f64 {
        if self.scale == Scale::Logarithmic {
            (value / self.low).ln() / (self.high / self.low).ln()
        } else {
            (value - self.low) / (self.high - self.low)
        }
    }

    fn ticks(&self) -> Vec<Tick> {
        let ticks = match self.scale {
            Scale::Linear => self.even_ticks(),
            Scale::Logarithmic => self.decades(),
            Scale::Blank => Vec::new(),
        };
        let inside = |tick: &Tick| (-1e-9..=1.0 + 1e-9).contains(&self.fraction(tick.value));
        ticks.into_iter().filter(inside).collect()
    }

    fn decades(&self) -> Vec<Tick> {
        let (first, last) = (self.low.log10().floor() as i32, self.high.log10().ceil() as i32);
        // Over many decades only some carry a label.
        let every = ((last - first) / 7 + 1).max(1);
        // Over less than two decades their halves and fifths carry one too, all as decimals.
        let narrow = self.high < 100.0 * self.low && first > -4 && last < 5;
        (first..=last)
            .flat_map(|power| (1..10).map(move |digit| (power, digit)))
            .map(|(power, digit)| Tick {
                value: f64::from(digit) * 10f64.powi(power),
                label: match (narrow, digit, power) {
                    (true, 1 | 2 | 5, _) => {
                        Some(format!("{0:.1$}", f64::from(digit) * 10f64.powi(power), -power.min(0) as usize))
                    }
                    (false, 1, 0) => Some(String::from("1")),
                    (false, 1, 1) if every == 1 => Some(String::from("10")),
                    (false, 1, _) if power.rem_euclid(every) == 0 => Some(format!("10^{{{power}}}")),
                    _ => None,
                },
            })
            .collect()
    }

    fn even_ticks(&self) -> Vec<Tick> {
        let step = round_step((self.high - self.low) / 5.0);
        let decimals = (-step.log10().floor()).max(0.0) as usize;
        let (first, last) = ((self.low / step).ceil() as i64, (self.high / step).floor() as i64);
        (first..=last)
            .map(|i| {
                let value = i as f64 * step;
                Tick { value, label: Some(format!("{value:.decimals$}")) }
            })
            .collect()
    }
}

/// The nearest of 1, 2, 5 times a power of ten that is not below `step`.
fn round_step(step: f64) -> f64 {
    let power = 10f64.powf(step.log10().floor());
    [1.0, 2.0, 5.0, 10.0]
        .map(|digit| digit * power)
        .into_iter()
        .find(|&round| round >= step * 0.999)
        .unwrap_or(step)
}

/// Two axes and the frame between them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Axes {
    pub(crate) area: Area,
    pub(crate) x: Axis,
    pub(crate) y: Axis,
}

/// One line of a legend.
pub(crate) enum Key {
    Line(Pen),
    Band(Colour),
    Disc(Colour),
}

impl Axes {
    /// The place of a pair of numbers on the sheet.
    pub(crate) fn place(&self, x: f64, y: f64) -> [f64; 2] {
        [
            self.area.left + self.x.fraction(x) * self.area.width,
            self.area.bottom() - self.y.fraction(y) * self.area.height,
        ]
    }

    /// The curve through the points, cut at the frame.
    pub(crate) fn line(&self, drawing: &mut Drawing, x: &[f64], y: &[f64], pen: Pen) {
        drawing.clip(&self.area);
        let points: Vec<_> = x.iter().zip(y).map(|(&x, &y)| self.place(x, y)).collect();
        drawing.line(&points, pen);
        drawing.unclip();
    }

    /// The area between two curves, cut at the frame.
    pub(crate) fn band(&self, drawing: &mut Drawing, x: &[f64], low: &[f64], high: &[f64], colour: Colour) {
        drawing.clip(&self.area);
        let there = x.iter().zip(low).map(|(&x, &y)| self.place(x, y));
        let back = x.iter().zip(high).rev().map(|(&x, &y)| self.place(x, y));
        drawing.polygon(&there.chain(back).collect::<Vec<_>>(), colour);
        drawing.unclip();
    }

    /// Straight lines (x, y, x, y), cut at the frame.
    pub(crate) fn segments(&self, drawing: &mut Drawing, segments: &[[f64; 4]], pen: Pen) {
        drawing.clip(&self.area);
        let place = |&[x0, y0, x1, y1]: &[f64; 4]| [self.place(x0, y0), self.place(x1, y1)];
        drawing.lines(&segments.iter().map(place).collect::<Vec<_>>(), pen);
        drawing.unclip();
    }

    /// Discs (x, y, error) with bars of their errors, cut at the frame.
    pub(crate) fn points(&self, drawing: &mut Drawing, points: &[[f64; 3]], colour: Colour) {
        drawing.clip(&self.area);
        let bar = Pen::solid(colour.fade(1.0), 1.2);
        for &[x, y, error] in points {
            drawing.line(&[self.place(x, y - error), self.place(x, y + error)], bar);
            drawing.disc(self.place(x, y), 3.5, Colour::WHITE);
            drawing.disc(self.place(x, y), 3.5, colour);
        }
        drawing.unclip();
    }

    /// A straight line at one height, from end to end.
    pub(crate) fn level(&self, drawing: &mut Drawing, y: f64, pen: Pen) {
        self.line(drawing, &[self.x.low, self.x.high], &[y, y], pen);
    }

    /// A straight line at one x, from the bottom to the top.
    pub(crate) fn upright(&self, drawing: &mut Drawing, x: f64, pen: Pen) {
        self.line(drawing, &[x, x], &[self.y.low, self.y.high], pen);
    }

    /// The frame, its ticks on all four sides and the labels; an empty label also drops its axis' numbers.
    pub(crate) fn frame(&self, drawing: &mut Drawing, x_label: &str, y_label: &str) {
        let pen = Pen::solid(Colour::BLACK, 1.0);
        let area = self.area;
        drawing.outline(&area, pen);
        for tick in self.x.ticks() {
            let x = area.left + self.x.fraction(tick.value) * area.width;
            let length = if tick.label.is_some() { 6.0 } else { 3.0 };
            drawing.line(&[[x, area.bottom()], [x, area.bottom() - length]], pen);
            drawing.line(&[[x, area.top], [x, area.top + length]], pen);
            if let Some(label) = tick.label.filter(|_| !x_label.is_empty()) {
                let lettering = Lettering::new(TICK_SIZE, Anchor::Middle);
                text::write(drawing, &label, [x, area.bottom() + 18.0], &lettering);
            }
        }
        for tick in self.y.ticks() {
            let y = area.bottom() - self.y.fraction(tick.value) * area.height;
            let length = if tick.label.is_some() { 6.0 } else { 3.0 };
            drawing.line(&[[area.left, y], [area.left + length, y]], pen);
            drawing.line(&[[area.right(), y], [area.right() - length, y]], pen);
            if let Some(label) = tick.label.filter(|_| !y_label.is_empty()) {
                let lettering = Lettering::new(TICK_SIZE, Anchor::End);
                text::write(drawing, &label, [area.left - 7.0, y + 0.36 * TICK_SIZE], &lettering);
            }
        }
        let lettering = Lettering::new(LABEL_SIZE, Anchor::Middle);
        text::write(drawing, x_label, [area.left + 0.5 * area.width, area.bottom() + 40.0], &lettering);
        let middle = [area.left - MARGIN_LEFT + 20.0, area.top + 0.5 * area.height];
        text::write(drawing, y_label, middle, &lettering.upwards());
    }

    /// A heading above the frame.
    pub(crate) fn title(&self, drawing: &mut Drawing, title: &str) {
        let at = [self.area.left + 0.5 * self.area.width, self.area.top - 9.0];
        text::write(drawing, title, at, &Lettering::new(LABEL_SIZE, Anchor::Middle));
    }

    /// A note in the frame, from its left edge; `height` is 0 at the bottom and 1 at the top.
    pub(crate) fn note(&self, drawing: &mut Drawing, note: &str, height: f64) {
        let at = [self.area.left + 12.0, self.area.bottom() - height * self.area.height];
        text::write(drawing, note, at, &Lettering::new(LEGEND_SIZE, Anchor::Start));
    }

    /// A legend on a white ground in the corner of the frame that `corner` names: [right, bottom].
    pub(crate) fn legend(&self, drawing: &mut Drawing, entries: &[(Key, &str)], corner: [bool; 2]) {
        const LINE: f64 = 18.0;
        const SAMPLE: f64 = 26.0;
        let widest = entries.iter().map(|(_, name)| text::width(name, LEGEND_SIZE)).fold(0.0, f64::max);
        let (width, height) = (widest + SAMPLE + 22.0, LINE * entries.len() as f64 + 8.0);
        let left = if corner[0] { self.area.right() - width - 10.0 } else { self.area.left + 10.0 };
        let top = if corner[1] { self.area.bottom() - height - 10.0 } else { self.area.top + 10.0 };
        drawing.rectangle(&Area::new(left, top, width, height), Colour::WHITE.fade(0.85));
        for (row, (key, name)) in entries.iter().enumerate() {
            let y = top + 4.0 + LINE * (row as f64 + 0.5);
            let start = left + 8.0;
            match *key {
                Key::Line(pen) => drawing.line(&[[start, y], [start + SAMPLE, y]], pen),
                Key::Band(colour) => drawing.rectangle(&Area::new(start, y - 5.0, SAMPLE, 10.0), colour),
                Key::Disc(colour) => drawing.disc([start + 0.5 * SAMPLE, y], 4.0, colour),
            }
            let at = [start + SAMPLE + 6.0, y + 0.36 * LEGEND_SIZE];
            text::write(drawing, name, at, &Lettering::new(LEGEND_SIZE, Anchor::Start));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(axis: &Axis) -> Vec<String> {
        axis.ticks().into_iter().filter_map(|tick| tick.label).collect()
    }

    #[test]
    fn ticks_are_round_numbers_within_the_axis() {
        assert_eq!(labels(&Axis::linear(-0.1, 1.05)), ["0.0", "0.5", "1.0"]);
        assert_eq!(labels(&Axis::linear(0.0, 500.0)), ["0", "100", "200", "300", "400", "500"]);
        assert_eq!(labels(&Axis::logarithmic(0.005, 15.0)), ["10^{-2}", "10^{-1}", "1", "10"]);
        assert_eq!(labels(&Axis::logarithmic(0.009, 0.3)), ["0.01", "0.02", "0.05", "0.1", "0.2"]);
        assert!(labels(&Axis::blank()).is_empty());
    }

    #[test]
    fn ends_of_an_axis_are_at_zero_and_one() {
        for axis in [Axis::linear(2.0, 5.0), Axis::logarithmic(2.0, 5.0)] {
            assert_eq!((axis.fraction(2.0), axis.fraction(5.0)), (0.0, 1.0));
        }
    }
}
