//! Reads OBJ: `v` and `f` lines; other statements are skipped.

use std::collections::VecDeque;

use crate::drivers::{AnyInput, Events};
use crate::historical::read_sma::{check_count, parse_count};
use crate::lines::polygon::fan;
use crate::source::mesh_events::{Element, Elements, MeshEvents, resolve};
use crate::source::patches::Order;
use crate::source::vertices::{VertexPoints, Vertices};
use crate::text::lines::Lines;
use crate::twin::tokens::{fields, parse_decimals, parse_signed, unexpected};
use spmesh_base::error::{Error, Result};
use spmesh_stream::model::bounds::Point;
use spmesh_stream::{Coordinates, Header, Kind};

/// Statements of OBJ that do not affect vertices or triangles.
const PASSED_OVER: [&[u8]; 17] = [
    b"vn",
    b"vt",
    b"vp",
    b"g",
    b"o",
    b"s",
    b"usemtl",
    b"mtllib",
    b"l",
    b"p",
    b"mg",
    b"lod",
    b"bevel",
    b"usemap",
    b"maplib",
    b"shadow_obj",
    b"trace_obj",
];

/// Reads OBJ as a triangle mesh; polygons become fans around their first vertex. Messages call the input
/// `name`.
///
/// Errors come with the events: [`spmesh_base::error::ErrorKind::Malformed`] (or I/O), with input and line.
///
/// Memory: one patch, and the triangles that precede their vertices.
pub fn open_obj(input: AnyInput, name: &str) -> Events {
    let lines = Lines::new(input, name);
    Box::new(MeshEvents::new(ObjElements { lines, triangles: VecDeque::new() }))
}

/// Reads the vertices of OBJ as points of `dims` dimensions. Messages call the input `name`.
pub(crate) fn open_vertices(input: AnyInput, name: &str, dims: u8) -> Result<Events> {
    let header = Header::new(Kind::Points, Coordinates::F64, dims, dims == 2);
    let vertices = ObjVertices { lines: Lines::new(input, name), vertices: 0, stated: None };
    Ok(Box::new(VertexPoints::new(vertices, header)))
}

/// The position of a vertex; colours and weights after it are ignored.
fn parse_vertex(line: &[u8]) -> Result<Point> {
    let mut coordinates = fields(line).skip(1);
    if fields(line).nth(3).is_none() {
        return Err(unexpected(line, "v and three numbers"));
    }
    parse_decimals(&mut coordinates)
}

/// The vertices of an OBJ or an SMA.
struct ObjVertices {
    lines: Lines<AnyInput>,
    vertices: u64,
    /// The number of vertices that the comments of an SMA state.
    stated: Option<u64>,
}

impl Vertices for ObjVertices {
    fn next_vertex(&mut self) -> Result<Option<Point>> {
        while let Some(line) = self.lines.next_line()? {
            let mut fields = fields(line);
            match fields.next() {
                Some(b"v") => {
                    self.vertices += 1;
                    return parse_vertex(line).map(Some);
                }
                // `x` finalizes a vertex, in an SMA mesh.
                None | Some(b"f" | b"x") => {}
                Some(b"#") => {
                    if let (Some(b"nverts"), Some(count)) = (fields.next(), fields.next()) {
                        self.stated = parse_count(count)?;
                    }
                }
                Some(other) if other[0] == b'#' || PASSED_OVER.contains(&other) => {}
                Some(other) => return Err(unexpected(other, "a statement of a polygonal OBJ")),
            }
        }
        check_count("vertices", self.stated, self.vertices)?;
        Ok(None)
    }

    fn locate(&self, error: Error) -> Error {
        self.lines.locate(error)
    }
}

struct ObjElements {
    lines: Lines<AnyInput>,
    /// Remaining triangles of the last polygon read.
    triangles: VecDeque<[u64; 3]>,
}

impl Elements for ObjElements {
    fn order(&self) -> Order {
        Order::AtEnd
    }

    fn next_element(&mut self, vertices: u64) -> Result<Option<Element>> {
        loop {
            if let Some(triangle) = self.triangles.pop_front() {
                return Ok(Some(Element::Triangle(triangle, [false; 3])));
            }
            let Some(line) = self.lines.next_line()? else { return Ok(None) };
            let mut fields = fields(line);
            match fields.next() {
                Some(b"v") => return Ok(Some(Element::Vertex(parse_vertex(line)?))),
                Some(b"f") => {
                    let corners: Result<Vec<u64>> =
                        fields.map(|field| parse_corner(field, vertices)).collect();
                    self.triangles = fan(&corners?)?;
                }
                None => {}
                Some(other) if other[0] == b'#' || PASSED_OVER.contains(&other) => {}
                Some(other) => return Err(unexpected(other, "a statement of a polygonal OBJ")),
            }
        }
    }

    fn check_counts(&self, _: u64, _: u64) -> Result<bool> {
        Ok(false)
    }

    fn locate(&self, error: Error) -> Error {
        self.lines.locate(error)
    }
}

/// The vertex of a corner `v`, `v/vt`, `v//vn` or `v/vt/vn`.
fn parse_corner(field: &[u8], vertices: u64) -> Result<u64> {
    let vertex = field.split(|&byte| byte == b'/').next().unwrap_or_default();
    resolve(parse_signed(vertex)?, vertices)
}
