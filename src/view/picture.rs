//! A complete picture: SVG, rendered as PNG or wrapped in a page.

use std::io::Write;

use super::element::failed;
use super::frame::Frame;
use super::page::{self, Page};
use super::render::render;
use spmesh_base::error::Result;

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
    /// The picture on a page that pans and zooms, as one file of HTML.
    ///
    /// # Errors
    /// If writing fails.
    pub fn html(&self, output: &mut impl Write) -> Result<()> {
        page::write(output, &Page { title: &self.title, svg: &self.svg, frame: self.frame.as_ref() })
    }

    /// The picture as PNG.
    ///
    /// # Errors
    /// If the picture is too large.
    pub fn png(&self) -> Result<Vec<u8>> {
        render(&self.svg)?.encode_png().map_err(failed)
    }
}
