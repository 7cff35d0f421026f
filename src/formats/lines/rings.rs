//! Polygons of files, as closed rings.

use std::path::PathBuf;

use crate::lines::{Breakline, Reading, read, text_or_wkt};
use crate::source::origin::name_of;
use spmesh_base::error::{Error, Result};
use spmesh_stream::model::points::Point2;
use spmesh_stream::{Coordinates, Crs};

/// A polygon: its rings, by the even-odd rule. A ring does not repeat its first vertex at the end.
pub type Polygon = Vec<Vec<Point2>>;

/// Reads the polygons of files for points with these coordinates and this system, in stored coordinates; and
/// messages for the user. Formats are those of [`super::read_breaklines`], and WKT: any number of `POLYGON`
/// and `MULTIPOLYGON`. Third coordinates are ignored.
///
/// Vertices are rounded to the grid of the points, as those of lines are, also beyond its range. Coordinates
/// of f64 are not rounded. All of them may take so many bytes of memory, at
/// [`spmesh_base::limits::LINE_VERTEX_BYTES`] a vertex.
///
/// # Errors
/// Those of [`super::read_breaklines`]; usage, if the system of a file differs from that of the points;
/// malformed, if a line is no ring, or a ring is not closed.
pub fn read_polygons(
    paths: &[PathBuf],
    coordinates: &Coordinates,
    crs: &Crs,
    memory: u64,
) -> Result<(Vec<Polygon>, Vec<String>)> {
    let (mut polygons, mut notices) = (Vec::new(), Vec::new());
    let mut reading = Reading::within(memory);
    for path in paths {
        let name = name_of(path);
        let file = read(path, text_or_wkt, &reading).map_err(|error| error.of_input(&name))?;
        notices.extend(file.system.check(&name, crs)?);
        notices.extend(file.layers.clone());
        reading.vertices_max -= file.lines.iter().map(|line| line.vertices.len()).sum::<usize>();
        for same in file.lines.chunk_by(|a, b| a.polygon == b.polygon) {
            let ring = |line: &Breakline| {
                let ring = line.ring(coordinates);
                ring.map_err(|error| file.noting_layers(error.at(&*line.position).of_input(&name)))
            };
            polygons.push(same.iter().map(ring).collect::<Result<_>>()?);
        }
    }
    Ok((polygons, notices))
}

impl Breakline {
    /// Checks that the line is a closed ring of a polygon.
    ///
    /// # Errors
    /// Malformed, if it is none.
    pub fn check_ring(&self) -> Result<()> {
        if self.polygon.is_none() {
            return Err(Error::malformed("found a line, expected polygons"));
        }
        let ([x, y], [u, v]) = (self.vertices[0], self.vertices[self.vertices.len() - 1]);
        if [x, y] == [u, v] {
            return Ok(());
        }
        let remedy = "repeat its first position at the end";
        Err(Error::malformed(format!("a ring starts at {x}, {y} and ends at {u}, {v}: {remedy}")))
    }

    /// The stored vertices of a ring, without the last one, which repeats the first.
    fn ring(&self, coordinates: &Coordinates) -> Result<Vec<Point2>> {
        self.check_ring()?;
        let stored = |&[x, y]: &Point2| {
            let [u, v, _] = coordinates.to_stored([x, y, 0.0]);
            if u.is_finite() && v.is_finite() {
                return Ok([u, v]);
            }
            Err(Error::malformed(format!("a vertex at {x:?}, {y:?} is too far away from the points")))
        };
        let vertices = &self.vertices[..self.vertices.len().max(2) - 1];
        vertices.iter().map(stored).collect()
    }
}
