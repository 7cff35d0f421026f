//! SVG as pixels: exactly the elements and attributes that pictures have. Anything else is an error, so that
//! no picture loses a part unnoticed.

use std::collections::HashMap;

use super::canvas::too_large;
use super::font::Font;
use super::outlines::{Words, outline};
use super::pen::{Element, Pen, failed};
use super::svg::Anchor;
use data_encoding::BASE64;
use quick_xml::Reader;
use quick_xml::escape::resolve_predefined_entity;
use quick_xml::events::{BytesStart, Event};
use spmesh_base::error::Result;
use tiny_skia::{Color, FillRule, Mask, Path, Pixmap, PixmapPaint, PremultipliedColorU8, Transform};

/// The pixels of a picture, on white.
///
/// Cost: that of filling and stroking each shape alone. Memory: 4 bytes for each pixel, and within a clip
/// that of [`Hidden`].
pub(super) fn render(svg: &str) -> Result<Pixmap> {
    let mut reader = Reader::from_str(svg);
    // Then each element has a start and an end.
    reader.config_mut().expand_empty_elements = true;
    let font = Font::embedded().ok_or_else(|| failed("the font is damaged"))?;
    let mut sheet = Sheet { reader, font, clips: HashMap::new() };
    let start = sheet.child()?.ok_or_else(|| failed("there is no element"))?;
    let mut root = Element::of(&start)?;
    let mut pixmap = blank(&mut root)?;
    let pen = Pen::new().within(&mut root)?;
    root.finish()?;
    sheet.draw(pen, &mut pixmap)?;
    Ok(pixmap)
}

/// A white sheet of the size that the root states.
fn blank(root: &mut Element) -> Result<Pixmap> {
    if root.name != "svg" {
        return Err(failed(format!("the element <{}>", root.name)));
    }
    let (width, height) = (root.need("width")?, root.need("height")?);
    // A length of the picture is a pixel.
    if root.need("viewBox")? != format!("0 0 {width} {height}") {
        return Err(failed("the viewBox has not the size of the picture"));
    }
    let side = |text: &str| text.parse::<f64>().map(|side| side.ceil() as u32).map_err(failed);
    let mut pixmap = Pixmap::new(side(&width)?, side(&height)?).ok_or_else(too_large)?;
    pixmap.fill(Color::WHITE);
    Ok(pixmap)
}

/// What is left of the text of a picture, and what was found so far.
struct Sheet<'a> {
    reader: Reader<&'a [u8]>,
    font: Font,
    clips: HashMap<String, Shapes>,
}

impl<'a> Sheet<'a> {
    /// The next child of an element; `None` at the end of the element.
    fn child(&mut self) -> Result<Option<BytesStart<'a>>> {
        loop {
            match self.reader.read_event().map_err(failed)? {
                Event::Start(start) => return Ok(Some(start)),
                Event::End(_) => return Ok(None),
                Event::Text(text) if text.trim_ascii().is_empty() => {}
                other => return Err(failed(format!("{other:?}"))),
            }
        }
    }

    /// The words in an element, up to its end.
    fn words(&mut self) -> Result<String> {
        let mut words = String::new();
        loop {
            match self.reader.read_event().map_err(failed)? {
                Event::Text(text) => words += &text,
                Event::GeneralRef(name) => {
                    words += resolve_predefined_entity(&name).ok_or_else(|| failed(format!("{name:?}")))?;
                }
                Event::End(_) => return Ok(words),
                other => return Err(failed(format!("{other:?}"))),
            }
        }
    }

    /// Reads the end of an element that has no content.
    fn end(&mut self) -> Result<()> {
        match self.child()? {
            Some(start) => Err(failed(format!("the element <{}>", start.name().into_inner()))),
            None => Ok(()),
        }
    }

    /// Draws the children of an element that has this pen.
    fn draw(&mut self, pen: Pen, pixmap: &mut Pixmap) -> Result<()> {
        while let Some(start) = self.child()? {
            let mut element = Element::of(&start)?;
            match element.name {
                "title" => self.words().and_then(|_| element.finish())?,
                "clipPath" => self.define(element)?,
                "g" => self.group(element, pen, pixmap)?,
                "text" => self.text(element, pen, pixmap)?,
                "image" => self.image(element, pixmap)?,
                _ => {
                    let (pen, path) = (pen.within(&mut element)?, outline(&mut element)?);
                    element.finish()?;
                    self.end()?;
                    path.iter().for_each(|path| pen.draw(path, pixmap));
                }
            }
        }
        Ok(())
    }

    fn group(&mut self, mut element: Element, pen: Pen, pixmap: &mut Pixmap) -> Result<()> {
        let pen = pen.within(&mut element)?;
        let hidden = match element.take("clip-path") {
            Some(name) => {
                let id = name.strip_prefix("url(#").and_then(|name| name.strip_suffix(')'));
                let shapes = id.and_then(|id| self.clips.get(id)).ok_or_else(|| failed(name))?;
                Some(Hidden::by(shapes, pixmap).ok_or_else(too_large)?)
            }
            None => None,
        };
        element.finish()?;
        self.draw(pen, pixmap)?;
        if let Some(hidden) = hidden {
            hidden.restore(pixmap);
        }
        Ok(())
    }

    /// Keeps the shapes of a clip for the groups that name it.
    fn define(&mut self, mut element: Element) -> Result<()> {
        let id = element.need("id")?.into_owned();
        element.finish()?;
        let mut shapes = Shapes::new();
        while let Some(start) = self.child()? {
            let mut element = Element::of(&start)?;
            let even_odd = |text: &str| (text == "evenodd").then_some(FillRule::EvenOdd);
            let rule = element.meaning("clip-rule", even_odd)?.unwrap_or(FillRule::Winding);
            let path = outline(&mut element)?;
            element.finish()?;
            self.end()?;
            shapes.extend(path.map(|path| (path, rule)));
        }
        self.clips.insert(id, shapes);
        Ok(())
    }

    fn text(&mut self, mut element: Element, pen: Pen, pixmap: &mut Pixmap) -> Result<()> {
        let pen = pen.within(&mut element)?;
        let at = [element.number("x", 0.0)?, element.number("y", 0.0)?];
        let size = element.number("font-size", 16.0)?;
        let anchor = element.meaning("text-anchor", |text| match text {
            "start" => Some(Anchor::Start),
            "middle" => Some(Anchor::Middle),
            "end" => Some(Anchor::End),
            _ => None,
        })?;
        element.finish()?;
        let words = self.words()?;
        let words = Words { at, size, anchor: anchor.unwrap_or(Anchor::Start), text: &words };
        words.outline(&self.font)?.iter().for_each(|path| pen.draw(path, pixmap));
        Ok(())
    }

    /// Draws an image of pixels, each of which becomes one of the picture.
    fn image(&mut self, mut element: Element, pixmap: &mut Pixmap) -> Result<()> {
        let [x, y] = [element.number("x", 0)?, element.number("y", 0)?];
        let size = [element.number("width", 0)?, element.number("height", 0)?];
        let link = element.need("href")?;
        element.finish()?;
        self.end()?;
        let data = link.strip_prefix("data:image/png;base64,").ok_or_else(|| failed("an image elsewhere"))?;
        let png = BASE64.decode(data.as_bytes()).map_err(failed)?;
        let image = Pixmap::decode_png(&png).map_err(failed)?;
        if [image.width(), image.height()] != size {
            return Err(failed("an image of another size"));
        }
        pixmap.draw_pixmap(x, y, image.as_ref(), &PixmapPaint::default(), Transform::identity(), None);
        Ok(())
    }
}

/// Shapes, of which a clip shows what any of them covers.
pub(super) type Shapes = Vec<(Path, FillRule)>;

/// The pixels that a clip hides, in whole or in part, as they were before anything was drawn in it.
///
/// Shapes are drawn in a clip as if there were none; then these pixels come back. If each shape was drawn
/// through a mask instead, those that share a pixel at the border of the clip would cover more of it than the
/// clip leaves open. A clip within another one needs nothing more: each takes back what is outside of it.
///
/// Memory: a byte for each pixel of the picture, and 4 bytes for each that is hidden.
pub(super) struct Hidden {
    mask: Mask,
    /// The hidden pixels, in the order of the mask.
    before: Vec<PremultipliedColorU8>,
}

impl Hidden {
    /// The pixels that a clip hides; `None` if the picture is too large for a mask.
    pub(super) fn by(shapes: &Shapes, pixmap: &Pixmap) -> Option<Hidden> {
        let mut mask = Mask::new(pixmap.width(), pixmap.height())?;
        for (path, rule) in shapes {
            mask.fill_path(path, *rule, true, Transform::identity());
        }
        let is_hidden = |open: &u8| *open < u8::MAX;
        let mut before = Vec::with_capacity(mask.data().iter().filter(|open| is_hidden(open)).count());
        let pixels = mask.data().iter().zip(pixmap.pixels());
        before.extend(pixels.filter(|(open, _)| is_hidden(open)).map(|(_, pixel)| *pixel));
        Some(Hidden { mask, before })
    }

    /// Brings back the pixels.
    pub(super) fn restore(self, pixmap: &mut Pixmap) {
        let pixels = self.mask.data().iter().zip(pixmap.pixels_mut());
        let hidden = pixels.filter(|(open, _)| **open < u8::MAX);
        for ((open, pixel), before) in hidden.zip(self.before) {
            *pixel = mix(before, *pixel, *open);
        }
    }
}

/// A pixel of which a part shows what is drawn: `open` of 255.
fn mix(before: PremultipliedColorU8, drawn: PremultipliedColorU8, open: u8) -> PremultipliedColorU8 {
    let part = u32::from(open);
    let mixed = |a: u8, b: u8| ((u32::from(a) * (255 - part) + u32::from(b) * part + 127) / 255) as u8;
    let (red, green) = (mixed(before.red(), drawn.red()), mixed(before.green(), drawn.green()));
    let (blue, alpha) = (mixed(before.blue(), drawn.blue()), mixed(before.alpha(), drawn.alpha()));
    // No colour exceeds its opacity, because none did before.
    PremultipliedColorU8::from_rgba(red, green, blue, alpha).unwrap_or(before)
}
