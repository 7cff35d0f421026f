//! How shapes are filled and stroked: the attributes of SVG that elements inherit.

use tiny_skia::{FillRule, LineCap, LineJoin, Paint, Path, Pixmap, Stroke, Transform};

use super::element::Element;
use spmesh_base::error::Result;
use spmesh_formats::raster::colour_map::Colour;

/// What an area is filled with.
#[derive(Debug, Clone, Copy)]
enum Shade {
    Nothing,
    /// The colour of the element that is drawn, which may differ from that of the element that says so.
    Current,
    Of(Colour),
}

/// What shapes are drawn with.
#[derive(Debug, Clone, Copy)]
pub(super) struct Pen {
    current: Colour,
    fill: Shade,
    stroke: Shade,
    width: f32,
    opacity: f32,
    join: LineJoin,
    cap: LineCap,
}

impl Pen {
    /// The pen of an element that inherits nothing.
    pub(super) fn new() -> Pen {
        Pen {
            current: [0; 3],
            fill: Shade::Of([0; 3]),
            stroke: Shade::Nothing,
            width: 1.0,
            opacity: 1.0,
            join: LineJoin::Miter,
            cap: LineCap::Butt,
        }
    }

    /// The pen of an element within one that has this pen.
    pub(super) fn within(self, element: &mut Element) -> Result<Pen> {
        Ok(Pen {
            current: element.meaning("color", colour)?.unwrap_or(self.current),
            fill: element.meaning("fill", shade)?.unwrap_or(self.fill),
            stroke: element.meaning("stroke", shade)?.unwrap_or(self.stroke),
            width: element.number("stroke-width", self.width)?,
            opacity: element.number("stroke-opacity", self.opacity)?,
            join: element.meaning("stroke-linejoin", join)?.unwrap_or(self.join),
            cap: element.meaning("stroke-linecap", cap)?.unwrap_or(self.cap),
        })
    }

    /// Fills and strokes a shape.
    pub(super) fn draw(&self, path: &Path, pixmap: &mut Pixmap) {
        if let Some(paint) = self.paint(self.fill, 1.0) {
            pixmap.fill_path(path, &paint, FillRule::Winding, Transform::identity(), None);
        }
        if let Some(paint) = self.paint(self.stroke, self.opacity) {
            let (width, line_join, line_cap) = (self.width, self.join, self.cap);
            let stroke = Stroke { width, line_join, line_cap, ..Stroke::default() };
            pixmap.stroke_path(path, &paint, &stroke, Transform::identity(), None);
        }
    }

    fn paint(&self, shade: Shade, opacity: f32) -> Option<Paint<'static>> {
        let [red, green, blue] = match shade {
            Shade::Nothing => return None,
            Shade::Current => self.current,
            Shade::Of(colour) => colour,
        };
        let mut paint = Paint::default();
        // Conversion saturates.
        paint.set_color_rgba8(red, green, blue, (255.0 * opacity + 0.5) as u8);
        Some(paint)
    }
}

fn shade(text: &str) -> Option<Shade> {
    match text {
        "none" => Some(Shade::Nothing),
        "currentColor" => Some(Shade::Current),
        _ => colour(text).map(Shade::Of),
    }
}

/// A colour as `#rgb` or `#rrggbb`.
fn colour(text: &str) -> Option<Colour> {
    let digits = text.strip_prefix('#')?.chars().map(|digit| digit.to_digit(16).map(|digit| digit as u8));
    match digits.collect::<Option<Vec<u8>>>()?[..] {
        [r, g, b] => Some([r, g, b].map(|digit| 17 * digit)),
        [r, red, g, green, b, blue] => Some([16 * r + red, 16 * g + green, 16 * b + blue]),
        _ => None,
    }
}

fn join(text: &str) -> Option<LineJoin> {
    (text == "round").then_some(LineJoin::Round)
}

fn cap(text: &str) -> Option<LineCap> {
    (text == "round").then_some(LineCap::Round)
}
