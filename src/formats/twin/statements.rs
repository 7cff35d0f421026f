//! Parses the lines of the text twin of a stream.

use crate::twin::read_configurations::{self, ConfigurationLine};
use crate::twin::read_functions::{self, FunctionLine};
use crate::twin::read4::{self, Statement4};
use crate::twin::regions::parse_point_region;
use crate::twin::rows::parse_row;
use crate::twin::tokens::{expect_no_field, fields, next_field, parse_decimals, parse_integer, unexpected};
use spmesh_base::error::{Error, Result};
use spmesh_stream::model::bounds::Point;
use spmesh_stream::model::cells::CellCode;
use spmesh_stream::{Coordinates, Header, Kind, PointRegion, Segment, Totals, check_place};

/// One line, parsed. Vertices and residual points are counted from 0 here.
pub(crate) enum Statement {
    Vertex(Point),
    Cell(CellCode),
    Region(PointRegion),
    Patch,
    /// A triangle uses the first three.
    Simplex([u64; 4]),
    Final(u64),
    /// A new vertex, and its id in all parts.
    Origin(u64, u64),
    /// A finalized vertex that other parts use.
    Kept(u64),
    Label(u64),
    Segment(Segment),
    /// Triangle, corner and segment.
    Side([u64; 3]),
    OpenSegment(u32),
    Residual(Option<u64>, Point),
    /// The attributes of the point before.
    Row(Vec<u8>),
    /// In the plane, a wall uses the first two.
    Wall([u64; 3]),
    Four(Statement4),
    Configuration(ConfigurationLine),
    Function(FunctionLine),
    End(Totals),
}

/// The part of a header line after `#spmesh`; `None` for other lines.
pub(crate) fn header_statement(line: &[u8]) -> Option<&[u8]> {
    let rest = line.trim_ascii_start().strip_prefix(b"#spmesh")?;
    (rest.is_empty() || matches!(rest[0], b' ' | b'\t')).then_some(rest)
}

/// Whether a line is a statement of content or the end.
pub(crate) fn is_content(line: &[u8]) -> bool {
    let mut fields = fields(line);
    match fields.next() {
        None => false,
        Some(b"#") => matches!(fields.next(), Some(b"patch" | b"end")),
        Some(first) => first[0] != b'#',
    }
}

/// The statement of a line; `None` for empty lines and comments.
pub(crate) fn parse_statement(line: &[u8], header: &Header) -> Result<Option<Statement>> {
    if !is_content(line) {
        return match header_statement(line) {
            None => Ok(None),
            Some(_) => {
                Err(Error::malformed("a line of the header (#spmesh) after the first line of content"))
            }
        };
    }
    let mut fields = fields(line);
    let fields = &mut fields;
    let per_simplex = header.kind.vertices_per_simplex();
    let is_constrained = header.constrained.is_some();
    let statement = match next_field(fields)? {
        word if header.kind.is_4d() && word != b"#" => Statement::Four(read4::parse(word, fields, header)?),
        word if header.kind.has_knots() && !matches!(word, b"v" | b"#") => {
            match (read_configurations::parse(word, fields)?, header.kind) {
                (Some(line), _) => Statement::Configuration(line),
                (None, Kind::Configurations) if word == b"coefficient" => {
                    return Err(unexpected(word, statements_of(header.kind)));
                }
                (None, kind) => match read_functions::parse(word, fields)? {
                    Some(line) => Statement::Function(line),
                    None => return Err(unexpected(word, statements_of(kind))),
                },
            }
        }
        b"v" => Statement::Vertex(parse_point(fields, header)?),
        b"f" if per_simplex == 3 => Statement::Simplex(parse_simplex(fields, 3)?),
        b"c" if per_simplex == 4 => Statement::Simplex(parse_simplex(fields, 4)?),
        b"a" if !header.attributes.is_empty() => Statement::Row(parse_row(fields, &header.attributes)?),
        b"segment" if is_constrained => Statement::Segment(parse_segment(fields, header)?),
        b"side" if is_constrained => Statement::Side(parse_side(fields)?),
        b"open" if is_constrained => Statement::OpenSegment(parse_open_segment(next_field(fields)?)?),
        b"label" => Statement::Label(parse_integer(next_field(fields)?)?),
        b"x" => match next_field(fields)? {
            b"cell" => Statement::Cell(parse_cell(next_field(fields)?, header)?),
            vertex => Statement::Final(parse_number(vertex)?),
        },
        b"r" => {
            let vertex = next_field(fields)?;
            let vertex = (vertex != b"-").then(|| parse_number(vertex)).transpose()?;
            Statement::Residual(vertex, parse_point(fields, header)?)
        }
        b"region" if header.kind == Kind::RegionPoints => Statement::Region(parse_point_region(fields)?),
        b"from" if header.part.is_some() => {
            Statement::Origin(parse_number(next_field(fields)?)?, parse_number(next_field(fields)?)?)
        }
        b"kept" if header.part.is_some() => Statement::Kept(parse_number(next_field(fields)?)?),
        b"w" if header.kind.has_region() => {
            let mut wall = [0; 3];
            for corner in &mut wall[..header.kind.vertices_per_wall()] {
                *corner = parse_number(next_field(fields)?)?;
            }
            Statement::Wall(wall)
        }
        b"#" => match next_field(fields)? {
            b"patch" => Statement::Patch,
            _ => Statement::End(parse_end(fields)?),
        },
        other if is_constrained => {
            return Err(unexpected(other, "segment, v, f, side, x, open or a comment"));
        }
        other => return Err(unexpected(other, statements_of(header.kind))),
    };
    expect_no_field(fields)?;
    Ok(Some(statement))
}

/// The statements allowed in streams of a kind, for messages.
fn statements_of(kind: Kind) -> &'static str {
    match kind {
        Kind::Points => "v, x or a comment",
        Kind::TriangleMesh => "v, f, x or a comment",
        Kind::PartialTriangleMesh => "v, f, x, r, w or a comment",
        Kind::TetrahedralMesh => "v, c, x, label or a comment",
        Kind::PartialTetrahedralMesh => "v, c, x, r, w or a comment",
        Kind::TriangleResidual | Kind::TetrahedralResidual => "r, w or a comment",
        Kind::Configurations => "v, degree, in, on, line, function, term or a comment",
        Kind::Splines => "v, degree, in, on, line, function, term, coefficient or a comment",
        Kind::RegionPoints => "region, v or a comment",
        Kind::Points4 | Kind::Cells4 | Kind::Simplices4 => "an end or a comment",
    }
}

/// Converts world coordinates to a stored point and checks it against the header.
fn parse_point<'a>(fields: &mut impl Iterator<Item = &'a [u8]>, header: &Header) -> Result<Point> {
    let world = parse_decimals::<3>(fields)?;
    let axes = header.coordinates_per_point();
    if let Some(z) = world[axes..].iter().find(|&&z| z != 0.0) {
        return Err(Error::malformed(format!(
            "z is {z}, but the points of this stream have none: expected 0"
        )));
    }
    let stored = stored_of(world, axes, header)?;
    check_place(header, stored)?;
    Ok(stored)
}

/// Converts the first `axes` world coordinates to stored ones; the others become 0.
fn stored_of(world: Point, axes: usize, header: &Header) -> Result<Point> {
    let coordinates = &header.coordinates;
    let mut stored = coordinates.to_stored(world);
    stored[axes..].fill(0.0);
    if let Coordinates::I32 { .. } = header.coordinates {
        // Adding 0.0 turns a -0.0 from rounding into the integer 0.
        stored = stored.map(|value| value + 0.0);
    }
    for axis in 0..axes {
        let (value, world) = (stored[axis], world[axis]);
        if !coordinates.can_store(value) {
            return Err(Error::malformed(format!("coordinate {world} does not fit the header's encoding")));
        }
        if !coordinates.is_decimal_of(axis, world, value) {
            let nearest = coordinates.to_decimal(stored)[axis];
            let message =
                format!("coordinate {world} is not on the grid of the header, next to it is {nearest}");
            return Err(Error::malformed(message));
        }
    }
    Ok(stored)
}

fn parse_segment<'a>(fields: &mut impl Iterator<Item = &'a [u8]>, header: &Header) -> Result<Segment> {
    let line = next_field(fields)?;
    let line = u32::try_from(parse_integer(line)?).map_err(|_| unexpected(line, "the number of a line"))?;
    let [x0, y0, x1, y1] = parse_decimals::<4>(fields)?;
    let [[x0, y0, _], [x1, y1, _]] =
        [stored_of([x0, y0, 0.0], 2, header)?, stored_of([x1, y1, 0.0], 2, header)?];
    Ok(Segment { line, ends: [[x0, y0], [x1, y1]] })
}

/// Triangle, corner and segment, each counted from 0.
fn parse_side<'a>(fields: &mut impl Iterator<Item = &'a [u8]>) -> Result<[u64; 3]> {
    let mut number = || parse_number(next_field(fields)?);
    Ok([number()?, number()?, number()?])
}

fn parse_open_segment(field: &[u8]) -> Result<u32> {
    u32::try_from(parse_number(field)?).map_err(|_| unexpected(field, "the number of a segment"))
}

/// `count` different vertices.
fn parse_simplex<'a>(fields: &mut impl Iterator<Item = &'a [u8]>, count: usize) -> Result<[u64; 4]> {
    let mut simplex = [0; 4];
    for i in 0..count {
        simplex[i] = parse_number(next_field(fields)?)?;
        if simplex[..i].contains(&simplex[i]) {
            return Err(Error::malformed("simplex uses a vertex twice"));
        }
    }
    Ok(simplex)
}

fn parse_cell(field: &[u8], header: &Header) -> Result<CellCode> {
    let Some(tree) = &header.tree else {
        return Err(Error::malformed("cell tag in a stream without a finalization tree"));
    };
    let cell = CellCode(parse_integer(field)?);
    tree.is_valid(cell).then_some(cell).ok_or_else(|| unexpected(field, "a location code of the tree"))
}

/// A number that counts from 1, converted to count from 0.
fn parse_number(field: &[u8]) -> Result<u64> {
    parse_integer(field)?.checked_sub(1).ok_or_else(|| unexpected(field, "a number from 1 on"))
}

fn parse_end<'a>(fields: &mut impl Iterator<Item = &'a [u8]>) -> Result<Totals> {
    let mut total = |name: &str| {
        let found = next_field(fields)?;
        if found != name.as_bytes() {
            return Err(unexpected(found, name));
        }
        parse_integer(next_field(fields)?)
    };
    Ok(Totals {
        points: total("points")?,
        cells: total("cells")?,
        vertices: total("vertices")?,
        simplices: total("simplices")?,
        merged: total("merged")?,
        residual_points: total("residual")?,
        walls: total("walls")?,
    })
}
