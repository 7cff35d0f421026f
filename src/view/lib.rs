//! `spview`: pictures of streams.
//!
//! A picture is SVG; PNG is that SVG, rendered, and `page` puts it on a page that pans and zooms. `request` says what can be asked of which stream, `drawing` goes from
//! events to pictures. `stage` says what is seen: `sheet` has what
//! stands around the map, `projection` how the world comes on it, and `frame` where it is in the world. `look` says what triangles and
//! points look like, with the colours of `ramp`. `layer` keeps those that are few, for `triangles` and `dots` to draw, and paints
//! others on the pixels of `canvas`. `hiding` puts triangles in order that are seen from one side. `front` has the vertices that are live, `cells` those of a finalization, and
//! `configurations` draws what its name says.
//!
//! Memory: triangles or points, as long as they are drawn one by one; for more of them the pixels of the picture, and the vertices
//! that are not final. Residual points and configurations are held as a whole.

mod canvas;
mod cells;
mod configurations;
mod dots;
mod drawing;
pub mod frame;
mod front;
mod hiding;
mod layer;
mod look;
mod page;
mod picture;
mod projection;
mod ramp;
mod request;
mod sheet;
mod stage;
mod svg;
mod ticks;
mod triangles;

use std::io::Read;

pub use drawing::{Take, draw};
pub use picture::Picture;

use spmesh_core::error::Result;
use spmesh_io::raster::{Light, Window};
use spmesh_model::bounds::Bounds;
use spmesh_stream::{Event, StreamReader, Totals};

/// What the inside of triangles, or a point, shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Fill {
    /// Nothing.
    None,
    /// The elevation.
    Elevation,
    /// How bright the triangle is in some light.
    Hillshade,
    /// Both.
    Relief,
    /// The position in the stream.
    Time,
}

/// Whether something is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum When {
    /// If it can be told apart.
    Auto,
    /// In any case.
    Always,
    /// In no case.
    Never,
}

/// How triangles and points come into a picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Form {
    /// One by one, unless there are too many.
    Auto,
    /// One by one.
    Vector,
    /// As pixels.
    Raster,
}

/// What a picture shows, and how.
#[derive(Debug, Clone)]
pub struct Options {
    /// What the title calls the stream.
    pub name: String,
    /// What triangles and points show; chosen by what there is if `None`.
    pub fill: Option<Fill>,
    /// Edges of triangles.
    pub edges: When,
    /// Cells of finalized points.
    pub cells: bool,
    /// One by one or as pixels.
    pub form: Form,
    /// Width of the picture. Units: pixels.
    pub width: u32,
    /// The part of the plane that is seen; all that there is if `None`.
    pub bounds: Option<Window>,
    /// Where the stream lies in the world, if its header does not say it and a survey did.
    pub surveyed: Option<Bounds>,
    /// Seen from above one side, with elevations.
    pub oblique: bool,
    /// Light of shades.
    pub light: Light,
    /// The elevations that colours are for; all that there are if `None`.
    pub range: Option<[f64; 2]>,
    /// The elevation that colours of two sorts meet at.
    pub middle: Option<f64>,
    /// The order of the centroid triangulation of configurations; the greatest if `None`.
    pub order: Option<usize>,
    /// The set of knots of configurations whose link is drawn.
    pub set: Option<Vec<u32>>,
}

impl Options {
    /// What is chosen if nothing is said, for a stream of some name: 1,000 pixels, and light from the north-west.
    #[must_use]
    pub fn new(name: impl Into<String>) -> Options {
        Options {
            name: name.into(),
            fill: None,
            edges: When::Auto,
            cells: true,
            form: Form::Auto,
            width: 1_000,
            bounds: None,
            surveyed: None,
            oblique: false,
            light: Light::from(315.0, 45.0),
            range: None,
            middle: None,
            order: None,
            set: None,
        }
    }
}

/// When pictures are taken: counts of triangles, or of points in a stream of points.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Moments {
    /// After so many, and none later; at the end if `None`.
    pub at: Option<u64>,
    /// After each of so many, too.
    pub every: Option<u64>,
}

/// What there is to know of a stream when it has been read once.
#[derive(Debug, Clone, Copy)]
pub struct Survey {
    /// The box of its points, in world coordinates.
    pub bounds: Option<Bounds>,
    /// What END says.
    pub totals: Totals,
}

/// Reads a stream to learn where it lies, and how long it is.
///
/// # Errors
/// As [`StreamReader::next_event`].
pub fn survey<R: Read>(reader: &mut StreamReader<R>) -> Result<Survey> {
    let coordinates = reader.header().coordinates;
    let mut survey = Survey { bounds: None, totals: Totals::default() };
    while let Some(event) = reader.next_event()? {
        let found = match &event {
            Event::Points(points) => Bounds::of_points(points),
            Event::Patch(patch) => Bounds::of_points(&patch.new),
            Event::ResidualPoints(points) => {
                points.iter().map(|(_, at)| Bounds::of_point(*at)).reduce(Bounds::union)
            }
            Event::End(totals) => {
                survey.totals = *totals;
                None
            }
            _ => None,
        };
        if let Some(Bounds { min, max }) = found {
            let [min, max] = [min, max].map(|corner| coordinates.to_world(corner));
            let found = Bounds { min, max };
            survey.bounds = Some(survey.bounds.map_or(found, |all| all.union(found)));
        }
    }
    Ok(survey)
}
