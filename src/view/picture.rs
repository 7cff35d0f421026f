//! A complete picture and its place in the world: SVG, rendered as PNG or wrapped in a page.

use std::io::Write;

use quick_xml::escape::escape;

use super::pen::failed;
use super::render::render;
use spmesh_base::error::{Error, Result};
use spmesh_delaunay::predicates::Point2;

/// A picture.
#[derive(Debug)]
pub struct Picture {
    /// The name of the stream, and what is shown of it.
    pub title: String,
    /// The picture as SVG: the group `map`, and the group `furniture` with title, legend and scale.
    pub svg: String,
    /// Where the map is in the world; `None` for an oblique view.
    pub frame: Option<Frame>,
}

impl Picture {
    /// The picture on a page that pans and zooms, as one file of HTML that needs nothing else. Its content
    /// policy blocks everything outside of the file, and all scripts but its own.
    ///
    /// The view box begins at zero. The page zooms the group `map`, which has no transform. A path in the
    /// group `scale` is the scale bar; a text there is its length in world units, a blank, and the name of
    /// the unit.
    ///
    /// # Errors
    /// If writing fails.
    pub fn html(&self, output: &mut impl Write) -> Result<()> {
        let frame = self.frame.map_or_else(String::new, |Frame { left, top, unit }| {
            format!(" data-left=\"{left:?}\" data-top=\"{top:?}\" data-unit=\"{unit:?}\"")
        });
        write!(
            output,
            include_str!("page.html"),
            title = escape(&self.title),
            frame = frame,
            style = include_str!("page.css"),
            svg = self.svg,
            script = include_str!("page.js"),
        )
        .map_err(|error| Error::io("writing the page", error))
    }

    /// The picture as PNG.
    ///
    /// # Errors
    /// If the picture is too large.
    pub fn png(&self) -> Result<Vec<u8>> {
        render(&self.svg)?.encode_png().map_err(failed)
    }
}

/// The map from a picture to world coordinates: `x = left + unit * across`, `y = top - unit * down`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Frame {
    /// The abscissa of the picture's left side. Units: those of the world.
    pub left: f64,
    /// The ordinate of the picture's upper side. Units: those of the world.
    pub top: f64,
    /// World units for one length of the picture.
    pub unit: f64,
}

impl Frame {
    /// The place in the picture of a place in the world: across and down.
    pub fn place(&self, [x, y]: Point2) -> Point2 {
        [(x - self.left) / self.unit, (self.top - y) / self.unit]
    }

    /// The place in the world of a place in the picture.
    pub fn world(&self, [across, down]: Point2) -> Point2 {
        [self.left + self.unit * across, self.top - self.unit * down]
    }
}
