//! Reads the surface in a PLY file into memory, with its normals and colours, to be drawn.

use std::collections::VecDeque;
use std::io::Read;

use crate::lines::polygon::{fan, strips};
use crate::ply::header::Sort;
use crate::ply::read::{Kept, Row, Rows};
use spmesh_base::error::{Error, Result};
use spmesh_stream::model::attributes::{Attributes, Column, NumberType};
use spmesh_stream::model::bounds::Point;

/// A surface in memory, to be drawn.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Surface {
    /// Places of the vertices.
    pub points: Vec<Point>,
    /// Normals of the vertices; empty if they have none.
    pub normals: Vec<Point>,
    /// Corners of the triangles.
    pub triangles: Vec<[u32; 3]>,
    /// For each triangle the colour of its face, or else the mean of those of its corners; `None` if neither
    /// has one.
    pub colours: Vec<Option<[u8; 3]>>,
}

impl Surface {
    fn add(&mut self, triangles: &VecDeque<[u64; 3]>, colour: Option<[u8; 3]>) {
        for triangle in triangles {
            self.triangles.push(triangle.map(|corner| u32::try_from(corner).unwrap_or(u32::MAX)));
            self.colours.push(colour);
        }
    }
}

/// Reads the vertices, faces and triangle strips of PLY with normals and colours. Polygons become fans.
///
/// # Errors
/// As [`crate::ply::read::open_ply`]; also if a face has a vertex that does not exist.
///
/// Memory: 60 bytes per vertex and 20 per triangle, as they arrive.
pub fn read_ply_surface<R: Read>(input: R, name: impl Into<String>) -> Result<Surface> {
    let mut rows = Rows::open(input, name)?;
    rows.kept = Kept::All;
    let attributes = |sort| rows.header.attributes_of(sort).map_err(|e| rows.locate(Error::malformed(e)));
    let [vertex, face] = [attributes(Sort::Vertex)?, attributes(Sort::Face)?].map(|of| Drawn::of(&of));
    let mut surface = Surface::default();
    let mut of_vertices: Vec<Option<[u8; 3]>> = Vec::new();
    loop {
        let next = rows.next();
        let Some(row) = next.map_err(|e| rows.locate(e))? else { break };
        match row {
            Row::Vertex(point) => {
                surface.points.push(point);
                surface.normals.extend(vertex.normal(&rows.attributes));
                of_vertices.push(vertex.colour(&rows.attributes));
            }
            Row::Face(corners) => {
                let triangles = fan(&corners).map_err(|e| rows.locate(e))?;
                surface.add(&triangles, face.colour(&rows.attributes));
            }
            Row::Strips(corners) => surface.add(&strips(&corners).map_err(|e| rows.locate(e))?, None),
        }
    }
    for (triangle, colour) in surface.triangles.iter().zip(&mut surface.colours) {
        let mut corners = [None; 3];
        for (corner, &vertex) in corners.iter_mut().zip(triangle) {
            *corner = *of_vertices.get(vertex as usize).ok_or_else(|| {
                let vertices = of_vertices.len();
                rows.locate(Error::malformed(format!("face with vertex {vertex} of {vertices}")))
            })?;
        }
        *colour = colour.or_else(|| mean(corners));
    }
    Ok(surface)
}

fn mean(colours: [Option<[u8; 3]>; 3]) -> Option<[u8; 3]> {
    let [a, b, c] = colours;
    let (a, b, c) = (a?, b?, c?);
    Some([0, 1, 2].map(|i| ((u16::from(a[i]) + u16::from(b[i]) + u16::from(c[i])) / 3) as u8))
}

/// Attributes that a picture shows.
struct Drawn {
    normal: Option<[Column; 3]>,
    colour: Option<[Column; 3]>,
}

impl Drawn {
    fn of(attributes: &Attributes) -> Self {
        let columns = |names: [&str; 3]| -> Option<[Column; 3]> {
            let [a, b, c] = names.map(|name| attributes.column(name).ok());
            Some([a?, b?, c?])
        };
        let is_colour =
            attributes.find("rgb").is_some_and(|(attribute, _)| attribute.number == NumberType::U8);
        let colour = columns(["red", "green", "blue"]).filter(|_| is_colour);
        Drawn { normal: columns(["nx", "ny", "nz"]), colour }
    }

    fn normal(&self, row: &[u8]) -> Option<Point> {
        self.normal.as_ref().map(|columns| columns.each_ref().map(|column| column.of(row, 0)))
    }

    fn colour(&self, row: &[u8]) -> Option<[u8; 3]> {
        self.colour.as_ref().map(|columns| columns.each_ref().map(|column| column.of(row, 0) as u8))
    }
}
