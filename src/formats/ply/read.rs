//! Reads PLY, text or binary of either byte order: a triangle mesh if it has faces or triangle strips, else
//! points.

use std::collections::VecDeque;
use std::io::Read;

use crate::drivers::{AnyInput, Events};
use crate::lines::polygon::{RESTART, fan, strips};
use crate::ply::header::{Encoding, PlyHeader, Property, Role, Sort};
use crate::raw::byte_order::ByteOrder;
use crate::raw::sample::SampleType;
use crate::source::mesh_events::{Element, Elements, MeshEvents};
use crate::source::patches::Order;
use crate::source::vertices::{VertexPoints, Vertices};
use crate::text::lines::Lines;
use crate::twin::tokens::{expect_no_field, fields, next_field, parse_decimal};
use spmesh_base::error::{Error, Result};
use spmesh_base::limits::{PLY_LIST_MAX, PLY_STRIPS_MAX};
use spmesh_stream::model::bounds::Point;
use spmesh_stream::{Coordinates, Header, Kind};

/// Reads PLY: a triangle mesh, in which polygons become fans around their first vertex, or points of `dims`
/// dimensions. Messages call the input `name`.
///
/// Memory: one patch or batch, and triangles that precede their vertices.
///
/// # Errors
/// If the header is damaged or states no vertices with x, y and z. Every later error is
/// [`spmesh_base::error::ErrorKind::Malformed`] (or I/O) and names input and place.
pub fn open_ply(input: AnyInput, name: &str, dims: u8) -> Result<Events> {
    let rows = Rows::open(input, name)?;
    if rows.header.rows(Sort::Face) > 0 || rows.header.rows(Sort::Strip) > 0 {
        return Ok(Box::new(MeshEvents::new(PlyElements { rows, triangles: VecDeque::new() })));
    }
    Ok(points(rows, dims))
}

/// Reads the vertices of PLY as points of `dims` dimensions, and ignores everything else. Messages call the
/// input `name`.
pub(crate) fn open_vertices(input: AnyInput, name: &str, dims: u8) -> Result<Events> {
    Ok(points(Rows::open(input, name)?, dims))
}

fn points(rows: Rows<AnyInput>, dims: u8) -> Events {
    let mut header = Header::new(Kind::Points, Coordinates::F64, dims, dims == 2);
    header.points = Some(rows.header.rows(Sort::Vertex));
    // Properties that cannot be attributes are skipped.
    header.attributes = rows.header.attributes().unwrap_or_default();
    let kept = if header.attributes.is_empty() { Kept::None } else { Kept::OfVertices };
    let rows = Rows { kept, ..rows };
    Box::new(VertexPoints::new(PlyVertices { rows }, header))
}

/// The vertices of a PLY.
struct PlyVertices {
    rows: Rows<AnyInput>,
}

impl Vertices for PlyVertices {
    fn next_vertex(&mut self) -> Result<Option<Point>> {
        loop {
            match self.rows.next()? {
                Some(Row::Vertex(point)) => return Ok(Some(point)),
                Some(Row::Face(_) | Row::Strips(_)) => {}
                None => return Ok(None),
            }
        }
    }

    fn row(&self) -> &[u8] {
        &self.rows.attributes
    }

    fn locate(&self, error: Error) -> Error {
        self.rows.locate(error)
    }
}

struct PlyElements {
    rows: Rows<AnyInput>,
    /// Remaining triangles of the last polygon or strip read.
    triangles: VecDeque<[u64; 3]>,
}

impl PlyElements {
    fn check(&self, corners: &[u64]) -> Result<()> {
        let vertices = self.rows.header.rows(Sort::Vertex);
        match corners.iter().find(|&&corner| corner >= vertices && corner != RESTART) {
            Some(corner) => Err(Error::malformed(format!("face with vertex {corner} of {vertices}"))),
            None => Ok(()),
        }
    }
}

impl Elements for PlyElements {
    fn order(&self) -> Order {
        Order::AtEnd
    }

    fn next_element(&mut self, _vertices: u64) -> Result<Option<Element>> {
        loop {
            if let Some(triangle) = self.triangles.pop_front() {
                return Ok(Some(Element::Triangle(triangle, [false; 3])));
            }
            match self.rows.next()? {
                None => return Ok(None),
                Some(Row::Vertex(point)) => return Ok(Some(Element::Vertex(point))),
                Some(Row::Face(corners)) => {
                    self.check(&corners)?;
                    self.triangles = fan(&corners)?;
                }
                Some(Row::Strips(corners)) => {
                    self.check(&corners)?;
                    self.triangles = strips(&corners)?;
                }
            }
        }
    }

    fn check_counts(&self, _: u64, _: u64) -> Result<bool> {
        Ok(false)
    }

    fn lost(&self) -> Option<String> {
        let attributes = self.rows.header.attributes().unwrap_or_default();
        let names = attributes.names();
        (!attributes.is_empty()).then(|| format!("attributes of a mesh in PLY are not read: {names} dropped"))
    }

    fn locate(&self, error: Error) -> Error {
        self.rows.locate(error)
    }
}

/// A row that is used.
pub(crate) enum Row {
    Vertex(Point),
    Face(Vec<u64>),
    Strips(Vec<u64>),
}

/// The rows after the header, in the order of the file.
pub(crate) struct Rows<R: Read> {
    lines: Lines<R>,
    pub(crate) header: PlyHeader,
    table: usize,
    row: u64,
    /// Whose attributes are read, and those of the last row.
    pub(crate) kept: Kept,
    pub(crate) attributes: Vec<u8>,
}

/// Whose attributes are read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kept {
    None,
    OfVertices,
    All,
}

impl<R: Read> Rows<R> {
    /// Reads the header.
    pub(crate) fn open(input: R, name: impl Into<String>) -> Result<Self> {
        let mut lines = Lines::new(input, name);
        let header = PlyHeader::read(&mut lines).map_err(|e| lines.locate(e))?;
        Ok(Rows { lines, header, table: 0, row: 0, kept: Kept::None, attributes: Vec::new() })
    }

    /// The next vertex, face or row of strips; rows of other elements are skipped.
    pub(crate) fn next(&mut self) -> Result<Option<Row>> {
        while let Some(table) = self.header.tables.get(self.table) {
            if self.row == table.rows {
                (self.table, self.row) = (self.table + 1, 0);
                continue;
            }
            self.row += 1;
            self.attributes.clear();
            let keeps = match table.sort {
                Sort::Vertex => self.kept != Kept::None,
                Sort::Face => self.kept == Kept::All,
                Sort::Strip | Sort::Other => false,
            };
            let attributes = keeps.then_some(&mut self.attributes);
            let (point, corners) = match self.header.encoding {
                Encoding::Ascii => read_text_row(&mut self.lines, &table.properties, attributes)?,
                Encoding::Binary(order) => {
                    read_binary_row(self.lines.input(), &table.properties, order, attributes)?
                }
            };
            match table.sort {
                Sort::Vertex => return Ok(Some(Row::Vertex(point))),
                Sort::Face => return Ok(Some(Row::Face(corners))),
                Sort::Strip => return Ok(Some(Row::Strips(corners))),
                Sort::Other => {}
            }
        }
        self.expect_end_of_input()?;
        Ok(None)
    }

    /// Checks that nothing follows: with a count that is too low, the remaining rows would be lost silently.
    fn expect_end_of_input(&mut self) -> Result<()> {
        let goes_on = match self.header.encoding {
            Encoding::Ascii => loop {
                match self.lines.next_line()? {
                    None => break false,
                    Some(line) if line.trim_ascii().is_empty() => {}
                    Some(_) => break true,
                }
            },
            Encoding::Binary(_) => {
                let mut rest = self.lines.input().take(1);
                std::io::copy(&mut rest, &mut std::io::sink()).map_err(|e| Error::io("reading", e))? > 0
            }
        };
        if goes_on {
            Err(Error::malformed("the file goes on after the rows that the header states"))
        } else {
            Ok(())
        }
    }

    pub(crate) fn locate(&self, error: Error) -> Error {
        match self.header.encoding {
            Encoding::Ascii => self.lines.locate(error),
            Encoding::Binary(_) => {
                self.lines.locate(error.at(format!("element {}, row {}", self.table + 1, self.row)))
            }
        }
    }
}

/// The values of a row, collected property by property.
#[derive(Default)]
struct RowValues {
    point: Point,
    corners: Vec<u64>,
}

impl RowValues {
    fn add(&mut self, role: Role, value: f64) -> Result<()> {
        match role {
            Role::Axis(_) if !value.is_finite() => Err(Error::malformed(format!("coordinate {value}"))),
            Role::Axis(axis) => {
                self.point[axis] = value;
                Ok(())
            }
            Role::Strips if value == -1.0 => {
                self.corners.push(RESTART);
                Ok(())
            }
            Role::Corners | Role::Strips
                if (0.0..RESTART as f64).contains(&value) && value.fract() == 0.0 =>
            {
                self.corners.push(value as u64);
                Ok(())
            }
            Role::Corners | Role::Strips => Err(Error::malformed(format!("vertex number {value}"))),
            Role::Length | Role::Attribute | Role::Other => Ok(()),
        }
    }

    /// Takes the values of a property, each from `next`.
    fn property(
        &mut self,
        property: &Property,
        mut next: impl FnMut(Role, SampleType) -> Result<f64>,
    ) -> Result<()> {
        let &Property { role, length, scalar } = property;
        let Some(length) = length else { return self.add(role, next(role, scalar)?) };
        let length = next(Role::Length, length)?;
        let most = if role == Role::Strips { PLY_STRIPS_MAX } else { PLY_LIST_MAX };
        if !(length >= 0.0 && length <= most as f64 && length.fract() == 0.0) {
            return Err(Error::malformed(format!("list of {length} values, the maximum is {most}")));
        }
        (0..length as u64).try_for_each(|_| self.add(role, next(role, scalar)?))
    }
}

/// Reads a row; appends its attributes if they are asked for.
fn read_text_row<R: Read>(
    lines: &mut Lines<R>,
    properties: &[Property],
    mut attributes: Option<&mut Vec<u8>>,
) -> Result<(Point, Vec<u64>)> {
    let mut values = RowValues::default();
    let line = lines.next_line()?.ok_or_else(truncated)?;
    let mut fields = fields(line);
    for property in properties {
        values.property(property, |role, scalar| match (role, &mut attributes) {
            (Role::Attribute, Some(attributes)) => {
                let field = next_field(&mut fields)?;
                scalar.parse_stored(field, attributes).map(|()| 0.0)
            }
            // A skipped value need not be a finite number.
            (Role::Attribute | Role::Other, _) => next_field(&mut fields).map(|_| 0.0),
            _ => parse_decimal(next_field(&mut fields)?),
        })?;
    }
    expect_no_field(&mut fields)?;
    Ok((values.point, values.corners))
}

fn read_binary_row(
    input: &mut impl Read,
    properties: &[Property],
    order: ByteOrder,
    mut attributes: Option<&mut Vec<u8>>,
) -> Result<(Point, Vec<u64>)> {
    let mut values = RowValues::default();
    for property in properties {
        values.property(property, |role, scalar| {
            let mut bytes = [0; 8];
            let bytes = &mut bytes[..scalar.len()];
            input.read_exact(bytes).map_err(|e| match e.kind() {
                std::io::ErrorKind::UnexpectedEof => truncated(),
                _ => Error::io("reading", e),
            })?;
            if let (Role::Attribute, Some(attributes)) = (role, &mut attributes) {
                let start = attributes.len();
                attributes.extend_from_slice(bytes);
                if order == ByteOrder::Big {
                    attributes[start..].reverse();
                }
            }
            Ok(scalar.number(bytes, order))
        })?;
    }
    Ok((values.point, values.corners))
}

fn truncated() -> Error {
    Error::malformed("truncated: the header states more rows")
}
