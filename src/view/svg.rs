//! Elements and attributes of SVG.

use super::canvas::Pixels;
use data_encoding::BASE64;
use spmesh_delaunay::predicates::Point2;

/// Text escaped for XML, without the characters that XML forbids.
pub(super) fn escape(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for character in text.chars() {
        match character {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            '\u{fffe}' | '\u{ffff}' => {}
            _ if character.is_control() => escaped.push(' '),
            _ => escaped.push(character),
        }
    }
    escaped
}

/// A length with at most two decimals.
pub(super) fn length(value: f64) -> String {
    let text = format!("{value:.2}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".to_string() } else { text.to_string() }
}

/// A place in a path.
pub(super) fn place([x, y]: Point2) -> String {
    format!("{} {}", length(x), length(y))
}

/// A closed polygon in a path.
pub(super) fn ring(places: &[Point2]) -> String {
    let mut path = String::new();
    for (number, &at) in places.iter().enumerate() {
        path.push(if number == 0 { 'M' } else { 'L' });
        path += &place(at);
    }
    path + "Z"
}

/// A part of a picture, clipped to polygons, each by the even-odd rule.
pub(super) fn clipped<'a>(
    part: &str,
    polygons: impl Iterator<Item = &'a Vec<Vec<Point2>>>,
    place: impl Fn(Point2) -> Point2,
) -> String {
    let mut text = "<clipPath id=\"mask\">\n".to_string();
    for polygon in polygons {
        let rings =
            polygon.iter().map(|vertices| ring(&vertices.iter().map(|&at| place(at)).collect::<Vec<_>>()));
        text += &format!("<path clip-rule=\"evenodd\" d=\"{}\"/>\n", rings.collect::<String>());
    }
    text + "</clipPath>\n<g clip-path=\"url(#mask)\">\n" + part + "</g>\n"
}

/// A line in a path.
pub(super) fn line([from, to]: [Point2; 2]) -> String {
    format!("M{}L{}", place(from), place(to))
}

/// The `text-anchor` of SVG.
#[derive(Debug, Clone, Copy)]
pub(super) enum Anchor {
    Start,
    Middle,
    End,
}

/// A line of text.
pub(super) fn text([x, y]: Point2, size: u32, anchor: Anchor, words: &str) -> String {
    let anchor = match anchor {
        Anchor::Start => "",
        Anchor::Middle => " text-anchor=\"middle\"",
        Anchor::End => " text-anchor=\"end\"",
    };
    let [x, y] = [x, y].map(length);
    format!("<text x=\"{x}\" y=\"{y}\" font-size=\"{size}\"{anchor}>{}</text>\n", escape(words))
}

/// An upper estimate of the width of text, from the mean width of characters. Units: lengths of the picture.
pub(super) fn text_width(size: u32, words: &str) -> f64 {
    /// Slightly above the mean width of the letters of DejaVu Sans.
    const MEAN: f64 = 0.62;
    MEAN * f64::from(size) * words.chars().count() as f64
}

/// An image at a place; a pixel is one length of the picture.
pub(super) fn image([x, y]: Point2, pixels: &Pixels) -> String {
    let data = BASE64.encode(&pixels.png);
    let (x, y, width, height) = (length(x), length(y), pixels.width, pixels.height);
    format!(
        "<image x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\" href=\"data:image/png;base64,{data}\"/>\n"
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_cannot_leave_its_element() {
        assert_eq!(escape("a<b>&\"c\"\n\u{1}é"), "a&lt;b&gt;&amp;&quot;c&quot;  é");
    }

    #[test]
    fn lengths_are_short() {
        assert_eq!([1.0, 0.5, -0.001, 100.0, 1.239].map(length), ["1", "0.5", "0", "100", "1.24"]);
        assert_eq!(ring(&[[0.0, 1.0], [2.5, 3.0], [4.0, 0.0]]), "M0 1L2.5 3L4 0Z");
    }
}
