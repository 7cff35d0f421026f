//! What a picture shows, when pictures are taken, and which options suit which stream.

use std::sync::Arc;

use spmesh_base::error::{Error, Result};
use spmesh_formats::raster::{Light, Window};
use spmesh_formats::source::Mask;
use spmesh_stream::model::bounds::Bounds;
use spmesh_stream::{Crs, Header, Kind, Totals};

/// What triangles and points show.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Fill {
    /// Nothing.
    None,
    /// The elevation.
    Elevation,
    /// The brightness of the triangle in some light.
    Hillshade,
    /// The elevation and the brightness.
    Relief,
    /// The position in the stream.
    Time,
    /// The value of an attribute, in a plan.
    Attribute,
    /// The colour that points have as an attribute, in a plan.
    Colour,
}

/// Whether something is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum When {
    /// If single items can be told apart.
    Auto,
    /// In any case.
    Always,
    /// In no case.
    Never,
}

/// How triangles and points are drawn.
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
    /// The name of the stream in the title.
    pub name: String,
    /// What triangles and points show; depends on the stream if `None`.
    pub fill: Option<Fill>,
    /// The attribute that they show instead, as `spmesh_stream::model::attributes::Attributes::column` takes
    /// it, or the name of one with three components, which is a colour.
    pub colour_by: Option<String>,
    /// Edges of triangles.
    pub edges: When,
    /// Cells of finalized points.
    pub cells: bool,
    /// One by one or as pixels.
    pub form: Form,
    /// Width of the picture. Units: pixels.
    pub width: u32,
    /// The part of the plane that is drawn; everything if `None`.
    pub bounds: Option<Window>,
    /// The box of the stream in the world, if its header does not state it and
    /// [`Extent::read`](crate::Extent::read) found it.
    pub extent: Option<Bounds>,
    /// The counts in the title, if the stream is a window of a mesh.
    pub whole: Option<Totals>,
    /// Seen obliquely, with elevations, rather than from above.
    pub oblique: bool,
    /// Whether the view is oblique, with elevations, rather than from above.
    pub light: Light,
    /// Triangles with a longer edge are left out. Units: those of the world.
    pub kill: Option<f64>,
    /// Triangles outside of the concave outline are left out: a chain of triangles leads to them from the
    /// convex hull in which every crossed edge is longer than this. Units: those of the world.
    pub concave: Option<f64>,
    /// Only what is inside of these polygons is shown, in a view from above.
    pub mask: Option<Arc<Mask>>,
    /// The range of elevations or values that the colours span; that of `stretch` if `None`.
    pub range: Option<[f64; 2]>,
    /// The percentiles of the visible elevations or values that the colours span; the range of the stream if
    /// `None`.
    pub stretch: Option<[f64; 2]>,
    /// The elevation at which the two halves of a diverging colour map meet.
    pub middle: Option<f64>,
    /// The coordinate reference system, if not that of the stream; it names the units.
    pub crs: Option<Crs>,
    /// The order of the centroid triangulation of configurations; the greatest if `None`.
    pub order: Option<usize>,
    /// The set of knots of configurations whose link is drawn.
    pub set: Option<Vec<u32>>,
    /// Draws copies of a knot in configurations around their place instead of on each other.
    pub apart: bool,
}

impl Options {
    /// The defaults for a stream of some name: a width of 1,000 pixels, light from the north-west, and
    /// colours from 2 to 98 percent.
    pub fn new(name: impl Into<String>) -> Options {
        Options {
            name: name.into(),
            fill: None,
            colour_by: None,
            edges: When::Auto,
            cells: true,
            form: Form::Auto,
            width: 1_000,
            bounds: None,
            extent: None,
            whole: None,
            oblique: false,
            light: Light::from(315.0, 45.0),
            kill: None,
            concave: None,
            mask: None,
            range: None,
            stretch: Some([2.0, 98.0]),
            middle: None,
            crs: None,
            order: None,
            set: None,
            apart: false,
        }
    }
}

/// When pictures are taken, in numbers of triangles, or of points in a stream of points.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Moments {
    /// The last picture is taken after this number; at the end if `None`.
    pub at: Option<u64>,
    /// Further pictures are taken after each multiple of this number.
    pub every: Option<u64>,
}

/// Checks that a stream can be drawn as the options ask.
pub(super) fn check(header: &Header, options: &Options, moments: &Moments) -> Result<()> {
    let kind = header.kind;
    let refuse = |what: String| Err(Error::usage(what));
    if kind.is_4d() {
        let name = kind.name();
        return refuse(format!(
            "{name} cannot be seen from above: make a mesh of one moment with dd4 --slice"
        ));
    }
    if kind.vertices_per_simplex() == 4 {
        let name = kind.name();
        return refuse(format!(
            "a {name} hides itself if seen from above: convert it to VTU with spconvert, for programs that \
             draw \
             in space"
        ));
    }
    if kind == Kind::RegionPoints {
        return refuse(format!(
            "this is a stream of kind {}, expected points or a triangle mesh",
            kind.name()
        ));
    }
    if kind.has_knots() {
        return check_of_knots(options, moments);
    }
    if options.order.is_some() || options.set.is_some() {
        let name = kind.name();
        return refuse(format!("--order and --set are for configurations, this is a stream of kind {name}"));
    }
    check_outline(kind, options, moments)?;
    let has_elevation = header.dims == 3 || header.has_elevation;
    let fill = options.fill;
    let what = if !has_elevation && (options.oblique || !matches!(fill, None | Some(Fill::None | Fill::Time)))
    {
        "points have no elevation: give points x y z to spfinalize, or use --fill time"
    } else if kind == Kind::Points
        && (options.oblique || matches!(fill, Some(Fill::Hillshade | Fill::Relief)))
    {
        "points are no surface: make one with spdelaunay2d, or use --fill elevation"
    } else if options.oblique && options.bounds.is_some() {
        "--bounds is for views from above: leave out --oblique"
    } else {
        return Ok(());
    };
    refuse(what.to_string())
}

/// Checks that the outline of triangles can be found.
fn check_outline(kind: Kind, options: &Options, moments: &Moments) -> Result<()> {
    let has_limit = options.kill.is_some() || options.concave.is_some();
    let what = if kind == Kind::Points && has_limit {
        "points have no edges: --kill and --concave are for triangle meshes"
    } else if options.concave.is_some() && *moments != Moments::default() {
        "the outline is known at the end of the stream: leave out --concave, or --at and --snapshot"
    } else if options.mask.is_some() && options.oblique {
        "--mask is for views from above: leave out --oblique"
    } else {
        return Ok(());
    };
    Err(Error::usage(what))
}

fn check_of_knots(options: &Options, moments: &Moments) -> Result<()> {
    let has_outline = options.kill.is_some() || options.concave.is_some() || options.mask.is_some();
    let is_plain =
        *moments == Moments::default() && !options.oblique && options.fill.is_none() && !has_outline;
    let what = "configurations are drawn whole, from above and in colours of their own: leave out --at, \
                --snapshot, --oblique, --fill, --kill, --concave and --mask";
    if is_plain { Ok(()) } else { Err(Error::usage(what)) }
}
