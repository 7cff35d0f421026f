//! `spview`: pictures of streams.
//!
//! [`draw()`] goes from events to pictures. `options` are checked to suit the stream.
//! `projection` maps the world to the `sheet` of paper, with its title, legend and scale. `style` says what
//! triangles and points look like, with the colours of `colour_map`; `shown` finds the range that they span.
//!
//! A `layer` keeps `triangles` or `points` as long as they are few, to be drawn one by one, and paints more
//! of them on the pixels of a `canvas`. `depth_sort` orders triangles that are seen obliquely. `front` holds
//! the live vertices, `cells` the cells of a finalization. `configurations` draws knots and centroid
//! triangulations. A [`Picture`] is SVG, also on an HTML page that pans and zooms.
//!
//! `render` turns the SVG of pictures alone into pixels, and clips: `pen` is what elements inherit, and
//! refuses what it does not know; `outlines` are the shapes, and text in the `font`.
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
mod configurations;
mod copies;
mod depth_sort;
mod drawing;
mod extent;
#[cfg(feature = "flags")]
pub mod flags;
mod font;
mod front;
mod layer;
mod options;
mod outlines;
mod pen;
mod picture;
mod points;
mod projection;
mod render;
mod sheet;
mod shown;
mod solid;
mod style;
mod svg;
mod ticks;
mod triangles;

pub use drawing::{Take, draw};
pub use extent::Extent;
pub use options::{Fill, Form, Moments, Options, When};
pub use picture::{Frame, Picture};
pub use solid::{SolidOptions, draw_solid};
