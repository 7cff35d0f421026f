//! Knots from files: points, streams of configurations, or splines.

use super::breaklines;
use super::frame::Frame;
use super::layout::Layout;
use super::options::Options;
use crate::fitting::SplineSpace;
use spmesh_base::error::{Error, Result};
use spmesh_delaunay::delaunay2::distinct;
use spmesh_delaunay::predicates::Point2;
use spmesh_formats::source::{Input, Opened};

/// The layout of functions over given knots.
pub(super) fn layout(source: Opened, name: &str, options: &Options) -> Result<Layout> {
    let degree = options.degree;
    match source {
        Opened::Events(_) if !options.polylines.is_empty() => {
            let what =
                "configurations have their functions already: give knots as points, or features to configgen";
            Err(Error::usage(what).of_input(name))
        }
        Opened::Events(source) => Layout::read(source, name, degree).map(|(layout, _)| layout),
        Opened::Points(input) => {
            if let Some(degree) = degree.filter(|&degree| degree != 2) {
                let what = format!(
                    "points as knots are for splines of degree 2: for degree {degree}, make \
                     configurations with configgen"
                );
                return Err(Error::usage(what).of_input(name));
            }
            of_points(&input, options).map_err(|error| error.of_input(name))
        }
    }
}

fn of_points(input: &Input, options: &Options) -> Result<Layout> {
    let description = input.description();
    let (frame, place) = Frame::of(description.coordinates, description.crs.clone());
    let (mut reader, mut batch, mut places) = (input.read()?, Vec::new(), Vec::new());
    loop {
        reader.next_batch(&mut batch)?;
        if batch.is_empty() {
            break;
        }
        places.extend(batch.iter().map(|&[x, y, _]| place([x, y])));
    }
    let places = without_copies(&places);
    if options.polylines.is_empty() {
        return Ok(Layout::of_space(SplineSpace::of(places)?, frame));
    }
    // Vertices of polylines are not on a grid, so coordinates of the world are used.
    let places: Vec<Point2> = places.into_iter().map(|stored| frame.to_world(stored)).collect();
    Ok(Layout::of_space(breaklines::space(&places, options)?, Frame::world(frame.crs)))
}

/// The first point at each place.
pub(super) fn without_copies(places: &[Point2]) -> Vec<Point2> {
    let firsts = distinct(places);
    let own = places.iter().zip(0..).zip(firsts).filter(|((_, id), first)| id == first);
    own.map(|((&place, _), _)| place).collect()
}
