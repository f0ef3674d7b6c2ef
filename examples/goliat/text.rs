//! Text as outlines of an embedded font, so that a figure looks the same on a machine without fonts.
//!
//! Three marks shape a label: `*k*` is slanted, `^{3}` is raised and `_{NL}` is lowered.

use std::sync::LazyLock;

use tiny_skia::{PathBuilder, Transform};
use ttf_parser::{Face, OutlineBuilder};

use crate::drawing::{Colour, Drawing};

static UPRIGHT: LazyLock<Face<'static>> = LazyLock::new(|| embedded(dejavu::sans::regular()));
static SLANTED: LazyLock<Face<'static>> = LazyLock::new(|| embedded(dejavu::sans::oblique()));

fn embedded(bytes: &'static [u8]) -> Face<'static> {
    Face::parse(bytes, 0).expect("the font is part of the program")
}

/// Where the given point lies on the line of text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Anchor {
    Start,
    Middle,
    End,
}

/// Size, colour, anchor, and whether the text climbs from the bottom to the top.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Lettering {
    pub(crate) size: f64,
    pub(crate) colour: Colour,
    pub(crate) anchor: Anchor,
    pub(crate) upwards: bool,
}

impl Lettering {
    pub(crate) const fn new(size: f64, anchor: Anchor) -> Self {
        Self { size, colour: Colour::BLACK, anchor, upwards: false }
    }

    pub(crate) const fn upwards(self) -> Self {
        Self { upwards: true, ..self }
    }
}

/// Characters of one style: slanted or not, relative size, and height above the base line in units of the size.
struct Glyph {
    character: char,
    slanted: bool,
    size: f64,
    rise: f64,
}

fn parse(label: &str) -> Vec<Glyph> {
    let mut glyphs = Vec::new();
    let (mut slanted, mut size, mut rise) = (false, 1.0, 0.0);
    let mut characters = label.chars().peekable();
    while let Some(character) = characters.next() {
        match character {
            '*' => slanted = !slanted,
            '^' | '_' if characters.peek() == Some(&'{') => {
                characters.next();
                size = 0.7;
                rise = if character == '^' { 0.38 } else { -0.16 };
            }
            '}' if size < 1.0 => (size, rise) = (1.0, 0.0),
            // A hyphen before a digit is a minus sign.
            '-' if characters.peek().is_some_and(char::is_ascii_digit) => {
                glyphs.push(Glyph { character: '\u{2212}', slanted, size, rise });
            }
            _ => glyphs.push(Glyph { character, slanted, size, rise }),
        }
    }
    glyphs
}

fn face(glyph: &Glyph) -> &'static Face<'static> {
    if glyph.slanted { &SLANTED } else { &UPRIGHT }
}

fn advance(glyph: &Glyph) -> f64 {
    let face = face(glyph);
    let id = face.glyph_index(glyph.character).unwrap_or_default();
    f64::from(face.glyph_hor_advance(id).unwrap_or(0)) / f64::from(face.units_per_em()) * glyph.size
}

/// Length of the line of text, in units of the drawing.
pub(crate) fn width(label: &str, size: f64) -> f64 {
    parse(label).iter().map(advance).sum::<f64>() * size
}

/// Writes `label` with its base line through `at`.
pub(crate) fn write(drawing: &mut Drawing, label: &str, at: [f64; 2], lettering: &Lettering) {
    let offset = match lettering.anchor {
        Anchor::Start => 0.0,
        Anchor::Middle => -0.5,
        Anchor::End => -1.0,
    };
    let mut right = offset * width(label, lettering.size);
    let mut outline = Outline(PathBuilder::new(), Transform::identity());
    for glyph in parse(label) {
        let face = face(&glyph);
        let scale = (lettering.size * glyph.size / f64::from(face.units_per_em())) as f32;
        let up = (lettering.size * glyph.rise) as f32;
        let along = Transform::from_row(scale, 0.0, 0.0, -scale, right as f32, -up);
        let turn = if lettering.upwards { Transform::from_rotate(-90.0) } else { Transform::identity() };
        outline.1 = along.post_concat(turn).post_translate(at[0] as f32, at[1] as f32);
        if let Some(id) = face.glyph_index(glyph.character) {
            face.outline_glyph(id, &mut outline);
        }
        right += advance(&glyph) * lettering.size;
    }
    if let Some(path) = outline.0.finish() {
        drawing.fill(path, lettering.colour);
    }
}

/// Collects the outlines of glyphs, moved to their place.
struct Outline(PathBuilder, Transform);

impl Outline {
    fn place<const N: usize>(&self, points: [(f32, f32); N]) -> [tiny_skia::Point; N] {
        let mut points = points.map(|(x, y)| tiny_skia::Point::from_xy(x, y));
        self.1.map_points(&mut points);
        points
    }
}

impl OutlineBuilder for Outline {
    fn move_to(&mut self, x: f32, y: f32) {
        let [a] = self.place([(x, y)]);
        self.0.move_to(a.x, a.y);
    }

    fn line_to(&mut self, x: f32, y: f32) {
        let [a] = self.place([(x, y)]);
        self.0.line_to(a.x, a.y);
    }

    fn quad_to(&mut self, x1: f32, y1: f32, x: f32, y: f32) {
        let [a, b] = self.place([(x1, y1), (x, y)]);
        self.0.quad_to(a.x, a.y, b.x, b.y);
    }

    fn curve_to(&mut self, x1: f32, y1: f32, x2: f32, y2: f32, x: f32, y: f32) {
        let [a, b, c] = self.place([(x1, y1), (x2, y2), (x, y)]);
        self.0.cubic_to(a.x, a.y, b.x, b.y, c.x, c.y);
    }

    fn close(&mut self) {
        self.0.close();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn marks_take_no_room_and_a_raised_glyph_is_smaller() {
        assert_eq!(width("k", 10.0), width("^{k", 10.0) / 0.7);
        assert_eq!(width("a b", 12.0), width("a", 12.0) + width(" ", 12.0) + width("b", 12.0));
    }

    #[test]
    fn the_font_has_every_symbol_of_the_figures() {
        for character in "σδΔ±√−→ρ×·⟨⟩≤".chars() {
            assert!(UPRIGHT.glyph_index(character).is_some(), "{character}");
        }
    }
}
