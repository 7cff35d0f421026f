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

#[cfg(test)]
mod tests {
    use super::*;

    const SIDE: u32 = 100;

    fn sheet(content: &str) -> String {
        format!("<svg width=\"{SIDE}\" height=\"{SIDE}\" viewBox=\"0 0 {SIDE} {SIDE}\">{content}</svg>\n")
    }

    /// The columns and rows of what is not white: first and last, and the share of black in all pixels.
    fn ink(content: &str) -> ([f32; 4], f32) {
        let pixmap = render(&sheet(content)).unwrap();
        let (mut reach, mut sum) = ([f32::INFINITY, f32::INFINITY, 0.0, 0.0], 0.0);
        for (at, pixel) in (0..).zip(pixmap.pixels()).filter(|(_, pixel)| pixel.green() < 255) {
            let [x, y] = [at % SIDE, at / SIDE].map(|number: u32| number as f32);
            reach = [reach[0].min(x), reach[1].min(y), reach[2].max(x + 1.0), reach[3].max(y + 1.0)];
            sum += 1.0 - f32::from(pixel.green()) / 255.0;
        }
        (reach, sum)
    }

    #[test]
    fn what_is_unknown_is_an_error() {
        for content in [
            "<ellipse cx=\"9\" cy=\"9\" rx=\"3\" ry=\"2\"/>",
            "<use href=\"#a\"/>",
            "<g transform=\"scale(2)\"/>",
            "<g opacity=\"0.5\"/>",
            "<g clip-path=\"url(#missing)\"/>",
            "<rect width=\"9\" height=\"9\" rx=\"2\"/>",
            "<rect width=\"50%\" height=\"9\"/>",
            "<rect width=\"9\" height=\"9\" fill=\"red\"/>",
            "<rect width=\"9\" height=\"9\" fill=\"#12345\"/>",
            "<rect width=\"9\" height=\"9\"><title>x</title></rect>",
            "<circle r=\"4\" stroke-dasharray=\"1\"/>",
            "<path/>",
            "<path d=\"M0 0C1 1 2 2 3 3\"/>",
            "<path d=\"M0 0 5 5\"/>",
            "<path d=\"M0\"/>",
            "<path d=\"M0 0L1 1Z2\"/>",
            "<path d=\"M0 0L1 1\" stroke=\"#000\" stroke-linejoin=\"bevel\"/>",
            "<path d=\"M0 0L1 1\" stroke=\"#000\" stroke-linecap=\"square\"/>",
            "<text font-weight=\"bold\">x</text>",
            "<text text-anchor=\"left\">x</text>",
            "<text>x<tspan>y</tspan></text>",
            "<text>&nbsp;</text>",
            "<image width=\"1\" height=\"1\" href=\"picture.png\"/>",
            "<clipPath><rect width=\"9\" height=\"9\"/></clipPath>",
            "<clipPath id=\"a\"><text>x</text></clipPath>",
            "<clipPath id=\"a\"><path clip-rule=\"odd\" d=\"M0 0\"/></clipPath>",
            "<!-- a remark -->",
            "words",
            "<g>",
        ] {
            let error = render(&sheet(content)).expect_err(content);
            assert!(error.to_string().contains("the picture cannot be rendered: "), "{error}");
        }
        for whole in ["", "<g/>", "<svg width=\"9\" height=\"9\" viewBox=\"0 0 9 8\"/>", "<svg"] {
            assert!(render(whole).is_err(), "{whole}");
        }
    }

    #[test]
    fn text_is_where_its_anchor_says() {
        // In units of 1/2048: an H reaches from 201 to 1339 across and to 1493 up; its advance is 1540.
        let scale = 20.0 / 2048.0;
        let width = scale * 2.0 * 1540.0;
        for (anchor, before) in [("start", 0.0), ("middle", 0.5 * width), ("end", width)] {
            let text = format!("<text x=\"50\" y=\"60\" font-size=\"20\" text-anchor=\"{anchor}\">HH</text>");
            let left = 50.0 - before;
            let expected =
                [left + scale * 201.0, 60.0 - scale * 1493.0, left + scale * (1540.0 + 1339.0), 60.0];
            let (reach, sum) = ink(&text);
            let differs = reach.iter().zip(expected).any(|(found, at)| (found - at).abs() > 1.0);
            assert!(!differs, "{anchor}: {reach:?}, not {expected:?}");
            // Two stems of 202 units and a bar of 170 between them.
            let area = 2.0 * scale * scale * (2.0 * 202.0 * 1493.0 + 734.0 * 170.0);
            assert!((sum - area).abs() < 0.05 * area, "{anchor}: {sum}, not {area}");
        }
        let plain = ink("<text x=\"9\" y=\"60\">a &lt;&amp;&quot; b</text>");
        assert_eq!(
            plain,
            ink("<text x=\"9\" y=\"60\" text-anchor=\"start\">  a   &lt;&amp;&quot; b </text>")
        );
    }

    #[test]
    fn clips_within_clips_show_what_is_in_both() {
        let clips = "<clipPath id=\"window\"><rect x=\"10\" y=\"20\" width=\"60\" height=\"50\"/></clipPath>\
                     <clipPath id=\"mask\">\
                     <path clip-rule=\"evenodd\" d=\"M40 0L90 0L90 90L40 90ZM50 30L60 30L60 40L50 40Z\"/>\
                     <path clip-rule=\"evenodd\" d=\"M0 60L20 60L20 90L0 90Z\"/></clipPath>";
        let all = "<rect width=\"100\" height=\"100\"/>";
        let within = |id: &str, content: &str| format!("<g clip-path=\"url(#{id})\">{content}</g>");
        let shown = |content: &str| ink(&format!("{clips}{content}"));
        assert_eq!(shown(&within("window", all)), ([10.0, 20.0, 70.0, 70.0], 60.0 * 50.0));
        let area = 30.0 * 50.0 - 10.0 * 10.0 + 10.0 * 10.0;
        assert_eq!(shown(&within("window", &within("mask", all))), ([10.0, 20.0, 70.0, 70.0], area));
        // What was drawn before stays, and what comes after is not clipped.
        let dot = "<rect x=\"2\" y=\"2\" width=\"1\" height=\"1\"/>";
        let group = within("window", "<rect width=\"100\" height=\"21\"/>");
        assert_eq!(shown(&format!("{dot}{group}{dot}")), ([2.0, 2.0, 70.0, 21.0], 61.0));
    }

    #[test]
    fn shapes_in_a_clip_cover_no_more_of_its_border_than_one() {
        let clip = "<clipPath id=\"a\"><path d=\"M10.5 0L90 0L90 90L10.5 90Z\"/></clipPath>";
        let shapes = |count: usize| {
            let shape = "<rect width=\"100\" height=\"100\"/>".repeat(count);
            ink(&format!("{clip}<g clip-path=\"url(#a)\">{shape}</g>"))
        };
        assert_eq!(shapes(1), shapes(5));
        assert!((shapes(1).1 - 79.5 * 90.0).abs() < 1.0);
    }

    #[test]
    fn what_a_group_says_holds_within_it() {
        let square = "<path d=\"M10 10h10v10l-10 0z\" color=\"#fff\"/>";
        assert_eq!(ink(square).1, 100.0);
        assert_eq!(ink(&format!("<g fill=\"currentColor\">{square}</g>")).1, 0.0);
        assert_eq!(ink(&format!("<g fill=\"none\">{square}</g>")).1, 0.0);
        let stroked = format!("<g fill=\"none\" stroke=\"#000\" stroke-width=\"2\"><g>{square}</g></g>");
        assert_eq!(ink(&stroked), ([9.0, 9.0, 21.0, 21.0], 144.0 - 64.0));
        let (reach, sum) = ink("<circle cx=\"50\" cy=\"50\" r=\"20\"/>");
        assert_eq!(reach, [30.0, 30.0, 70.0, 70.0]);
        assert!((sum - 400.0 * std::f32::consts::PI).abs() < 2.0);
    }
}
