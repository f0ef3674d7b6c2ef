//! A figure as a list of shapes, from which both the SVG and the PNG are written.
//!
//! Units are pixels of the SVG; x runs to the right and y downwards. A clip holds until the next one.

use std::fmt::Write as _;

use tiny_skia::{
    Color, FillRule, FilterQuality, LineCap, LineJoin, Mask, Paint, Path, PathBuilder, PathSegment, Pixmap,
    PixmapPaint, StrokeDash, Transform,
};

use crate::Failure;

/// Pixels of the PNG for one unit of the drawing.
const PNG_SCALE: f32 = 2.0;

/// sRGB with an opacity from 0 to 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Colour {
    pub(crate) red: u8,
    pub(crate) green: u8,
    pub(crate) blue: u8,
    pub(crate) opacity: f32,
}

impl Colour {
    pub(crate) const BLACK: Self = Self::new(0, 0, 0);
    pub(crate) const WHITE: Self = Self::new(255, 255, 255);

    pub(crate) const fn new(red: u8, green: u8, blue: u8) -> Self {
        Self { red, green, blue, opacity: 1.0 }
    }

    pub(crate) const fn fade(self, opacity: f32) -> Self {
        Self { opacity, ..self }
    }
}

/// A rectangle with its sides along the axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Area {
    pub(crate) left: f64,
    pub(crate) top: f64,
    pub(crate) width: f64,
    pub(crate) height: f64,
}

impl Area {
    pub(crate) const fn new(left: f64, top: f64, width: f64, height: f64) -> Self {
        Self { left, top, width, height }
    }

    pub(crate) const fn right(&self) -> f64 {
        self.left + self.width
    }

    pub(crate) const fn bottom(&self) -> f64 {
        self.top + self.height
    }

    fn path(&self) -> Option<Path> {
        let rectangle = tiny_skia::Rect::from_xywh(
            self.left as f32,
            self.top as f32,
            self.width as f32,
            self.height as f32,
        )?;
        Some(PathBuilder::from_rect(rectangle))
    }
}

/// How a line is drawn: colour, width, and the lengths of dashes and gaps (empty for a solid line).
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pen {
    pub(crate) colour: Colour,
    pub(crate) width: f32,
    pub(crate) dashes: &'static [f32],
}

impl Pen {
    pub(crate) const fn solid(colour: Colour, width: f32) -> Self {
        Self { colour, width, dashes: &[] }
    }

    pub(crate) const fn dashed(colour: Colour, width: f32) -> Self {
        Self { colour, width, dashes: &[6.0, 4.0] }
    }
}

enum Shape {
    Fill(Path, Colour),
    Stroke(Path, Pen),
    Image { area: Area, columns: usize, pixels: Vec<[u8; 3]> },
    Clip(Option<Area>),
}

/// A sheet of the given size with the shapes on it, in the order in which they cover each other.
pub(crate) struct Drawing {
    width: f64,
    height: f64,
    shapes: Vec<Shape>,
}

impl Drawing {
    /// A white sheet.
    pub(crate) fn new(width: f64, height: f64) -> Self {
        let mut drawing = Self { width, height, shapes: Vec::new() };
        drawing.rectangle(&Area::new(0.0, 0.0, width, height), Colour::WHITE);
        drawing
    }

    /// Limits what follows to `area`.
    pub(crate) fn clip(&mut self, area: &Area) {
        self.shapes.push(Shape::Clip(Some(*area)));
    }

    /// Ends the limit.
    pub(crate) fn unclip(&mut self) {
        self.shapes.push(Shape::Clip(None));
    }

    pub(crate) fn fill(&mut self, path: Path, colour: Colour) {
        self.shapes.push(Shape::Fill(path, colour));
    }

    pub(crate) fn rectangle(&mut self, area: &Area, colour: Colour) {
        if let Some(path) = area.path() {
            self.fill(path, colour);
        }
    }

    pub(crate) fn outline(&mut self, area: &Area, pen: Pen) {
        if let Some(path) = area.path() {
            self.shapes.push(Shape::Stroke(path, pen));
        }
    }

    /// Straight lines from point to point.
    pub(crate) fn line(&mut self, points: &[[f64; 2]], pen: Pen) {
        if let Some(path) = connect(points, false) {
            self.shapes.push(Shape::Stroke(path, pen));
        }
    }

    /// Straight lines apart from each other; where they meet their colours do not add up.
    pub(crate) fn lines(&mut self, lines: &[[[f64; 2]; 2]], pen: Pen) {
        let mut builder = PathBuilder::new();
        for [from, to] in lines {
            builder.move_to(from[0] as f32, from[1] as f32);
            builder.line_to(to[0] as f32, to[1] as f32);
        }
        if let Some(path) = builder.finish() {
            self.shapes.push(Shape::Stroke(path, pen));
        }
    }

    /// The area within the points.
    pub(crate) fn polygon(&mut self, points: &[[f64; 2]], colour: Colour) {
        if let Some(path) = connect(points, true) {
            self.fill(path, colour);
        }
    }

    /// A disc with a thin rim of the full colour.
    pub(crate) fn disc(&mut self, centre: [f64; 2], radius: f64, colour: Colour) {
        if let Some(path) = PathBuilder::from_circle(centre[0] as f32, centre[1] as f32, radius as f32) {
            self.fill(path.clone(), colour);
            self.shapes.push(Shape::Stroke(path, Pen::solid(colour.fade(1.0), 0.8)));
        }
    }

    /// Square pixels, rows from the top, stretched over `area`.
    pub(crate) fn image(&mut self, area: &Area, columns: usize, pixels: Vec<[u8; 3]>) {
        self.shapes.push(Shape::Image { area: *area, columns, pixels });
    }

    /// The drawing as an SVG document that needs no font and no other file.
    pub(crate) fn svg(&self) -> Result<String, Failure> {
        let (width, height) = (self.width, self.height);
        let mut text = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" \
             viewBox=\"0 0 {width} {height}\">\n"
        );
        let (mut clips, mut open) = (0, false);
        for shape in &self.shapes {
            match shape {
                Shape::Fill(path, colour) => {
                    writeln!(text, "<path d=\"{}\" fill={}/>", commands(path), paint("fill", *colour))?;
                }
                Shape::Stroke(path, pen) => {
                    let dashes: Vec<_> = pen.dashes.iter().map(ToString::to_string).collect();
                    writeln!(
                        text,
                        "<path d=\"{}\" fill=\"none\" stroke={} stroke-width=\"{}\" stroke-dasharray=\"{}\" \
                         stroke-linejoin=\"round\"/>",
                        commands(path),
                        paint("stroke", pen.colour),
                        pen.width,
                        if dashes.is_empty() { String::from("none") } else { dashes.join(" ") },
                    )?;
                }
                Shape::Image { area, columns, pixels } => {
                    let png = pixmap(*columns, pixels)?.encode_png()?;
                    writeln!(
                        text,
                        "<image {} preserveAspectRatio=\"none\" style=\"image-rendering:pixelated\" \
                         href=\"data:image/png;base64,{}\"/>",
                        place(area),
                        base64(&png),
                    )?;
                }
                Shape::Clip(area) => {
                    if open {
                        text.push_str("</g>\n");
                    }
                    open = area.is_some();
                    if let Some(area) = area {
                        clips += 1;
                        let place = place(area);
                        writeln!(text, "<clipPath id=\"c{clips}\"><rect {place}/></clipPath>")?;
                        writeln!(text, "<g clip-path=\"url(#c{clips})\">")?;
                    }
                }
            }
        }
        text.push_str(if open { "</g>\n</svg>\n" } else { "</svg>\n" });
        Ok(text)
    }

    /// The drawing as a PNG file.
    pub(crate) fn png(&self) -> Result<Vec<u8>, Failure> {
        let width = (self.width as f32 * PNG_SCALE) as u32;
        let height = (self.height as f32 * PNG_SCALE) as u32;
        let mut sheet = Pixmap::new(width, height).ok_or("a figure has no size")?;
        let zoom = Transform::from_scale(PNG_SCALE, PNG_SCALE);
        let mut mask = None;
        for shape in &self.shapes {
            match shape {
                Shape::Fill(path, colour) => {
                    sheet.fill_path(path, &solid(*colour), FillRule::Winding, zoom, mask.as_ref());
                }
                Shape::Stroke(path, pen) => {
                    let stroke = tiny_skia::Stroke {
                        width: pen.width,
                        line_cap: LineCap::Butt,
                        line_join: LineJoin::Round,
                        dash: StrokeDash::new(pen.dashes.to_vec(), 0.0),
                        ..Default::default()
                    };
                    sheet.stroke_path(path, &solid(pen.colour), &stroke, zoom, mask.as_ref());
                }
                Shape::Image { area, columns, pixels } => {
                    let picture = pixmap(*columns, pixels)?;
                    let stretch = Transform::from_row(
                        area.width as f32 / picture.width() as f32,
                        0.0,
                        0.0,
                        area.height as f32 / picture.height() as f32,
                        area.left as f32,
                        area.top as f32,
                    );
                    let paint = PixmapPaint { quality: FilterQuality::Nearest, ..Default::default() };
                    let whole = stretch.post_concat(zoom);
                    sheet.draw_pixmap(0, 0, picture.as_ref(), &paint, whole, mask.as_ref());
                }
                Shape::Clip(area) => {
                    mask = area.and_then(|area| {
                        let mut mask = Mask::new(width, height)?;
                        mask.fill_path(&area.path()?, FillRule::Winding, false, zoom);
                        Some(mask)
                    });
                }
            }
        }
        Ok(sheet.encode_png()?)
    }
}

/// Breaks the line where a point is not finite, so that a gap in the data is a gap in the picture.
fn connect(points: &[[f64; 2]], close: bool) -> Option<Path> {
    let mut builder = PathBuilder::new();
    let mut pen_down = false;
    for &[x, y] in points {
        let finite = x.is_finite() && y.is_finite();
        match (finite, pen_down) {
            (true, true) => builder.line_to(x as f32, y as f32),
            (true, false) => builder.move_to(x as f32, y as f32),
            (false, _) => {}
        }
        pen_down = finite;
    }
    if close {
        builder.close();
    }
    builder.finish()
}

fn solid(colour: Colour) -> Paint<'static> {
    let mut paint = Paint { anti_alias: true, ..Default::default() };
    let mut shade = Color::from_rgba8(colour.red, colour.green, colour.blue, 255);
    shade.set_alpha(colour.opacity);
    paint.set_color(shade);
    paint
}

fn pixmap(columns: usize, pixels: &[[u8; 3]]) -> Result<Pixmap, Failure> {
    let columns = columns.max(1);
    let rows = pixels.len() / columns;
    let mut picture =
        Pixmap::new(u32::try_from(columns)?, u32::try_from(rows)?).ok_or("an image is empty")?;
    for (target, &[red, green, blue]) in picture.data_mut().chunks_exact_mut(4).zip(pixels) {
        target.copy_from_slice(&[red, green, blue, 255]);
    }
    Ok(picture)
}

fn place(area: &Area) -> String {
    format!(
        "x=\"{:.2}\" y=\"{:.2}\" width=\"{:.2}\" height=\"{:.2}\"",
        area.left, area.top, area.width, area.height
    )
}

fn paint(kind: &str, colour: Colour) -> String {
    let Colour { red, green, blue, opacity } = colour;
    if opacity < 1.0 {
        format!("\"#{red:02x}{green:02x}{blue:02x}\" {kind}-opacity=\"{opacity}\"")
    } else {
        format!("\"#{red:02x}{green:02x}{blue:02x}\"")
    }
}

/// The path in the language of SVG.
fn commands(path: &Path) -> String {
    let mut text = String::new();
    for segment in path.segments() {
        let (letter, points) = match segment {
            PathSegment::MoveTo(a) => ('M', vec![a]),
            PathSegment::LineTo(a) => ('L', vec![a]),
            PathSegment::QuadTo(a, b) => ('Q', vec![a, b]),
            PathSegment::CubicTo(a, b, c) => ('C', vec![a, b, c]),
            PathSegment::Close => ('Z', vec![]),
        };
        text.push(letter);
        let numbers: Vec<_> = points.iter().map(|point| format!("{:.2} {:.2}", point.x, point.y)).collect();
        text.push_str(&numbers.join(" "));
    }
    text
}

/// RFC 4648 with padding.
fn base64(bytes: &[u8]) -> String {
    const LETTERS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for group in bytes.chunks(3) {
        let word = (0..3).fold(0, |word, i| word << 8 | usize::from(*group.get(i).unwrap_or(&0)));
        for i in 0..4 {
            let letter = if i <= group.len() { LETTERS[word >> (18 - 6 * i) & 63] } else { b'=' };
            text.push(char::from(letter));
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base64_gives_the_vectors_of_rfc_4648() {
        for (plain, code) in
            [("", ""), ("f", "Zg=="), ("fo", "Zm8="), ("foo", "Zm9v"), ("foobar", "Zm9vYmFy")]
        {
            assert_eq!(base64(plain.as_bytes()), code);
        }
    }

    #[test]
    fn both_formats_hold_the_whole_drawing() {
        let mut drawing = Drawing::new(20.0, 10.0);
        drawing.clip(&Area::new(0.0, 0.0, 10.0, 10.0));
        drawing.rectangle(&Area::new(5.0, 0.0, 15.0, 10.0), Colour::BLACK);
        drawing.unclip();
        let svg = drawing.svg().unwrap();
        assert!(svg.starts_with("<svg") && svg.ends_with("</svg>\n"));
        assert_eq!(svg.matches("<g ").count(), svg.matches("</g>").count());
        let sheet = Pixmap::decode_png(&drawing.png().unwrap()).unwrap();
        let shade = |x, y| sheet.pixel(x, y).unwrap().red();
        // White, black, and white again where the clip cuts the rectangle.
        assert_eq!([shade(4, 10), shade(15, 10), shade(30, 10)], [255, 0, 255]);
    }
}
