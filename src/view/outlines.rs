//! Shapes and text of SVG as paths of the rasterizer.

use super::font::{Dot, Font};
use super::pen::{Element, failed};
use super::svg::Anchor;
use spmesh_base::error::Result;
use tiny_skia::{Path, PathBuilder, Rect};

/// How far the arms of a cubic curve reach along the tangents of a quarter of a circle of radius 1.
const ARM: f32 = 0.552_284_8;

/// The outline of a shape; `None` if it has no extent.
pub(super) fn outline(element: &mut Element) -> Result<Option<Path>> {
    match element.name {
        "path" => path(&element.need("d")?),
        "rect" => {
            let mut number = |name| element.number(name, 0.0);
            let [x, y, width, height] = [number("x")?, number("y")?, number("width")?, number("height")?];
            let rectangle = Rect::from_xywh(x, y, width, height);
            Ok(rectangle.filter(|_| width > 0.0 && height > 0.0).map(PathBuilder::from_rect))
        }
        "circle" => {
            let mut number = |name| element.number(name, 0.0);
            Ok(circle([number("cx")?, number("cy")?], number("r")?))
        }
        name => Err(failed(format!("the element <{name}>"))),
    }
}

/// The path of an attribute `d`: commands M, L, h, l, v and Z, each with its numbers.
fn path(data: &str) -> Result<Option<Path>> {
    let mut builder = PathBuilder::new();
    let (mut start, mut at) = ([0.0; 2], [0.0; 2]);
    let mut rest = data.chars();
    while let Some(command) = rest.next() {
        let text = rest.as_str();
        let end = text.find(|letter: char| letter.is_ascii_alphabetic()).unwrap_or(text.len());
        let (text, others) = text.split_at(end);
        rest = others.chars();
        match command {
            'M' | 'L' => at = numbers(text)?,
            'l' => at = moved(at, numbers(text)?),
            'h' => at = moved(at, [numbers::<1>(text)?[0], 0.0]),
            'v' => at = moved(at, [0.0, numbers::<1>(text)?[0]]),
            'Z' | 'z' => {
                let [] = numbers(text)?;
                builder.close();
                at = start;
                continue;
            }
            _ => return Err(failed(format!("the command {command} of a path"))),
        }
        let [x, y] = at.map(|number| number as f32);
        if command == 'M' {
            builder.move_to(x, y);
            start = at;
        } else {
            builder.line_to(x, y);
        }
    }
    Ok(builder.finish())
}

fn moved(at: [f64; 2], by: [f64; 2]) -> [f64; 2] {
    [at[0] + by[0], at[1] + by[1]]
}

/// As many numbers as a command takes.
fn numbers<const COUNT: usize>(text: &str) -> Result<[f64; COUNT]> {
    let mut found = [0.0; COUNT];
    let mut parts = text.split_ascii_whitespace();
    for number in &mut found {
        let part = parts.next().and_then(|part| part.parse().ok());
        *number = part.ok_or_else(|| failed(format!("the numbers {text:?} of a path")))?;
    }
    if parts.next().is_some() {
        return Err(failed(format!("the numbers {text:?} of a path")));
    }
    Ok(found)
}

/// A circle as four cubic curves.
fn circle([x, y]: [f32; 2], radius: f32) -> Option<Path> {
    if radius <= 0.0 {
        return None;
    }
    let mut builder = PathBuilder::new();
    builder.move_to(x + radius, y);
    for [from, to] in [
        [[1.0, 0.0], [0.0, 1.0]],
        [[0.0, 1.0], [-1.0, 0.0]],
        [[-1.0, 0.0], [0.0, -1.0]],
        [[0.0, -1.0], [1.0, 0.0]],
    ] {
        let on = |p: [f32; 2], q: [f32; 2], share: f32| {
            [x + radius * (p[0] + share * q[0]), y + radius * (p[1] + share * q[1])]
        };
        let [[ax, ay], [bx, by], [cx, cy]] = [on(from, to, ARM), on(to, from, ARM), on(to, from, 0.0)];
        builder.cubic_to(ax, ay, bx, by, cx, cy);
    }
    builder.close();
    builder.finish()
}

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
