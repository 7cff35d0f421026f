//! Lines of text as paths of the rasterizer.

use tiny_skia::{Path, PathBuilder};

use super::element::failed;
use super::font::{Dot, Font};
use super::svg::Anchor;
use spmesh_base::error::Result;

/// A line of text at a place.
pub(super) struct Words<'a> {
    /// The place of the anchor, on the baseline.
    pub(super) at: [f32; 2],
    pub(super) size: f32,
    pub(super) anchor: Anchor,
    pub(super) text: &'a str,
}

impl Words<'_> {
    /// The outline of the text; `None` if nothing is to be seen. A character that the font lacks is a box.
    pub(super) fn outline(&self, font: &Font) -> Result<Option<Path>> {
        let mut builder = PathBuilder::new();
        self.draw(font, &mut builder).ok_or_else(|| failed("the font is damaged"))?;
        Ok(builder.finish())
    }

    fn draw(&self, font: &Font, builder: &mut PathBuilder) -> Option<()> {
        // As in any SVG, words are one blank apart.
        let words: Vec<&str> = self.text.split(' ').filter(|word| !word.is_empty()).collect();
        let glyphs: Vec<u16> = words.join(" ").chars().map(|character| font.glyph(character)).collect();
        let scale = self.size / font.units;
        let advances: Option<Vec<f32>> =
            glyphs.iter().map(|&glyph| Some(scale * font.advance(glyph)?)).collect();
        let advances = advances?;
        let width: f32 = advances.iter().sum();
        let [x, y] = self.at;
        let mut x = match self.anchor {
            Anchor::Start => x,
            Anchor::Middle => x - width / 2.0,
            Anchor::End => x - width,
        };
        for (&glyph, advance) in glyphs.iter().zip(advances) {
            for contour in font.contours(glyph)? {
                let place = |dot: Dot| Dot { x: x + scale * dot.x, y: y - scale * dot.y, ..dot };
                draw(builder, &contour.into_iter().map(place).collect::<Vec<Dot>>())?;
            }
            x += advance;
        }
        Some(())
    }
}

/// Draws a contour that begins on the curve. Halfway between two points off the curve, there is one on it.
fn draw(builder: &mut PathBuilder, dots: &[Dot]) -> Option<()> {
    let start = dots.first().filter(|dot| dot.is_on)?;
    builder.move_to(start.x, start.y);
    let mut control: Option<Dot> = None;
    for dot in dots[1..].iter().chain([start]) {
        match control.replace(*dot) {
            Some(off) if dot.is_on => builder.quad_to(off.x, off.y, dot.x, dot.y),
            Some(off) => builder.quad_to(off.x, off.y, (off.x + dot.x) / 2.0, (off.y + dot.y) / 2.0),
            None if dot.is_on => builder.line_to(dot.x, dot.y),
            None => {}
        }
        control = control.filter(|dot| !dot.is_on);
    }
    builder.close();
    Some(())
}
