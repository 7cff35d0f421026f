//! Polygons that say which points count.

use std::path::PathBuf;

use super::{Target, systems};
use crate::polygons::Rings;
use spmesh_base::error::{Error, Result};
use spmesh_formats::source::{Breakline, name_of, read_polygons as read_file};
use spmesh_stream::Coordinates;
use spmesh_stream::model::points::Point2;

/// Reads the polygons of files, in the stored coordinates of `target`; and messages for the user.
///
/// Vertices are rounded to the grid of the stream, as those of lines are, also beyond its range. Coordinates
/// of f64 are not rounded.
///
/// # Errors
/// Those of reading; usage, if the system of a file differs from that of the stream; malformed, if a line is
/// no ring, or a ring is not closed.
pub fn read_polygons(paths: &[PathBuf], target: &Target) -> Result<(Vec<Rings>, Vec<String>)> {
    let (mut polygons, mut notices) = (Vec::new(), Vec::new());
    for path in paths {
        let file = read_file(path)?;
        let name = name_of(path);
        notices.extend(systems::check(&name, &file.crs, &target.crs)?);
        for same in file.lines.chunk_by(|a, b| a.polygon == b.polygon) {
            let ring = |line: &Breakline| {
                let ring = ring(line, &target.coordinates);
                ring.map_err(|error| error.at(&*line.position).of_input(&name))
            };
            polygons.push(same.iter().map(ring).collect::<Result<_>>()?);
        }
    }
    Ok((polygons, notices))
}

/// Checks that a line is a closed ring of a polygon.
pub(crate) fn check_ring(line: &Breakline) -> Result<()> {
    if line.polygon.is_none() {
        return Err(Error::malformed("found a line, expected polygons"));
    }
    let ([x, y], [u, v]) = (line.vertices[0], line.vertices[line.vertices.len() - 1]);
    if [x, y] == [u, v] {
        return Ok(());
    }
    let remedy = "repeat its first position at the end";
    Err(Error::malformed(format!("a ring starts at {x}, {y} and ends at {u}, {v}: {remedy}")))
}

/// The stored vertices of a ring, without the last one, which repeats the first.
pub(crate) fn ring(line: &Breakline, coordinates: &Coordinates) -> Result<Vec<Point2>> {
    check_ring(line)?;
    let stored = |&[x, y]: &Point2| {
        let [u, v, _] = coordinates.to_stored([x, y, 0.0]);
        if u.is_finite() && v.is_finite() {
            return Ok([u, v]);
        }
        Err(Error::malformed(format!("a vertex at {x:?}, {y:?} is too far away from the points")))
    };
    let vertices = &line.vertices[..line.vertices.len().max(2) - 1];
    vertices.iter().map(stored).collect()
}
