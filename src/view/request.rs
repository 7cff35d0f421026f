//! Which options suit which stream.

use super::options::{Fill, Moments, Options};
use spmesh_base::error::{Error, Result};
use spmesh_stream::{Header, Kind};

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
