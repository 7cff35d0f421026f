//! A picture that is complete: SVG, and what is made of it.

use std::io::Write;
use std::sync::Arc;

use resvg::tiny_skia::{Color, Pixmap, Transform};
use resvg::usvg::{self, fontdb};

use super::canvas::too_large;
use super::frame::Frame;
use super::page::{self, Page};
use spmesh_core::error::{Error, Result};

/// The font of pictures, so that they look the same everywhere: Latin letters of DejaVu Sans.
const FONT: &[u8] = include_bytes!("DejaVuSans-latin.ttf");

/// A picture.
#[derive(Debug)]
pub struct Picture {
    /// What it shows.
    pub title: String,
    /// The picture as SVG: a group `map` with what is shown, and a group `furniture` with what explains it.
    pub svg: String,
    /// Where it is in the world; `None` if it is seen from one side.
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
    /// If it is too large.
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
