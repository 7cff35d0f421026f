//! A complete picture: SVG, rendered as PNG or wrapped in a page.

use std::io::Write;
use std::sync::Arc;

use resvg::tiny_skia::{Color, Pixmap, Transform};
use resvg::usvg::{self, fontdb};

use super::canvas::too_large;
use super::frame::Frame;
use super::page::{self, Page};
use spmesh_core::error::{Error, Result};

/// The Latin letters of DejaVu Sans. An embedded font makes pictures look the same everywhere.
const FONT: &[u8] = include_bytes!("DejaVuSans-latin.ttf");

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
        let mut fonts = fontdb::Database::new();
        fonts.load_font_data(FONT.to_vec());
        let options = usvg::Options { fontdb: Arc::new(fonts), ..usvg::Options::default() };
        let failed = |what: String| Error::usage(format!("the picture cannot be rendered: {what}"));
        let tree = usvg::Tree::from_str(&self.svg, &options).map_err(|error| failed(error.to_string()))?;
        let size = tree.size().to_int_size();
        let mut pixmap = Pixmap::new(size.width(), size.height()).ok_or_else(too_large)?;
        pixmap.fill(Color::WHITE);
        resvg::render(&tree, Transform::identity(), &mut pixmap.as_mut());
        pixmap.encode_png().map_err(|error| failed(error.to_string()))
    }
}
