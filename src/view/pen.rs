//! Attributes of SVG: each must be taken, so that none is left out unseen. Those that elements inherit say
//! how shapes are filled and stroked.

use std::borrow::Cow;
use std::fmt::Display;
use std::str::FromStr;

use quick_xml::XmlVersion;
use quick_xml::events::BytesStart;
use spmesh_base::error::{Error, Result};
use spmesh_formats::raster::colour_map::Colour;
use tiny_skia::{FillRule, LineCap, LineJoin, Paint, Path, Pixmap, Stroke, Transform};

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

/// Attributes that change no pixel. Names and roles are for pages. Strokes keep their width with
/// `vector-effect`, but nothing is scaled here. All text is in the embedded font.
const SILENT: [&str; 6] = ["id", "class", "role", "xmlns", "font-family", "vector-effect"];

/// An element with the attributes that were not taken yet.
pub(super) struct Element<'a> {
    pub(super) name: &'a str,
    attributes: Vec<(&'a str, Cow<'a, str>)>,
}

impl<'a> Element<'a> {
    /// The element that a tag starts.
    pub(super) fn of(start: &'a BytesStart) -> Result<Element<'a>> {
        let mut attributes = Vec::new();
        for attribute in start.attributes() {
            let attribute = attribute.map_err(failed)?;
            let value = attribute.normalized_value(XmlVersion::Implicit1_0).map_err(failed)?;
            attributes.push((attribute.key.into_inner(), value));
        }
        Ok(Element { name: start.name().into_inner(), attributes })
    }

    /// The value of an attribute, if the element has it.
    pub(super) fn take(&mut self, name: &str) -> Option<Cow<'a, str>> {
        let at = self.attributes.iter().position(|(known, _)| *known == name)?;
        Some(self.attributes.swap_remove(at).1)
    }

    /// The value of an attribute that the element must have.
    pub(super) fn need(&mut self, name: &str) -> Result<Cow<'a, str>> {
        let value = self.take(name);
        value.ok_or_else(|| failed(format!("an element <{}> without {name}", self.name)))
    }

    /// The number that an attribute states, or a default.
    pub(super) fn number<T: FromStr>(&mut self, name: &str, default: T) -> Result<T> {
        let Some(value) = self.take(name) else { return Ok(default) };
        value.parse().map_err(|_| failed(format!("the attribute {name}=\"{value}\"")))
    }

    /// What an attribute means, if the element has it.
    pub(super) fn meaning<T>(&mut self, name: &str, of: impl FnOnce(&str) -> Option<T>) -> Result<Option<T>> {
        let Some(value) = self.take(name) else { return Ok(None) };
        of(&value).map(Some).ok_or_else(|| failed(format!("the attribute {name}=\"{value}\"")))
    }

    /// Checks that all attributes are taken.
    pub(super) fn finish(self) -> Result<()> {
        match self.attributes.iter().find(|(name, _)| !SILENT.contains(name)) {
            Some((name, _)) => Err(failed(format!("the attribute {name} of <{}>", self.name))),
            None => Ok(()),
        }
    }
}

/// The error of a picture that the renderer does not understand.
pub(super) fn failed(what: impl Display) -> Error {
    Error::usage(format!("the picture cannot be rendered: {what}"))
}
