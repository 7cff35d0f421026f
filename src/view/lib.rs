//! `spview`: pictures of streams.
//!
//! [`draw()`] goes from events to pictures. `request` checks that a stream can be drawn as the options ask. A
//! `scene` is the `sheet` of paper, with its title, legend and scale, and the `projection` of the world on
//! it; `frame` says where the map is in the world. `style` says what triangles and points look like, with the
//! colours of `colour_map`; `stretch` finds the range that they span.
//!
//! A `layer` keeps `triangles` or `points` as long as they are few, to be drawn one by one, and paints more
//! of them on the pixels of a `canvas`. `depth_sort` orders triangles that are seen obliquely. `front` holds
//! the live vertices, `cells` the cells of a finalization. `configurations` draws knots and centroid
//! triangulations. A [`Picture`] is SVG; `page` wraps it in an HTML page that pans and zooms.
//!
//! `render` turns the SVG of pictures alone into pixels: `element` refuses what it does not know, `pen` is
//! what elements inherit, `outlines` are the shapes, `glyphs` text in the `font`, and `clip` clips.
//!
//! `flags`, with the feature of this name, has the command line.
//!
//! `solid` draws surfaces of files in space from any side.
//!
//! Memory: triangles or points, as long as they are drawn one by one; for more of them, the pixels of the
//! picture and the live vertices. Residual points, configurations and the edges on lines of a constrained
//! mesh are held whole.

mod canvas;
mod cells;
mod clip;
mod configurations;
mod copies;
mod depth_sort;
mod drawing;
mod element;
mod extent;
#[cfg(feature = "flags")]
pub mod flags;
mod font;
pub mod frame;
mod front;
mod glyphs;
mod layer;
mod options;
mod outlines;
mod page;
mod pen;
mod picture;
mod points;
mod projection;
mod render;
mod request;
mod scene;
mod sheet;
mod shown;
mod solid;
mod stretch;
mod style;
mod svg;
mod ticks;
mod triangles;
mod units;

pub use drawing::{Take, draw};
pub use extent::Extent;
pub use options::{Fill, Form, Moments, Options, When};
pub use picture::Picture;
pub use solid::{SolidOptions, draw_solid};
