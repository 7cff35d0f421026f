//! Reads the text twin of a stream (`formats/text.md`).

use std::io::Read;

use super::events::EventSource;
use super::lines::Lines;
use super::patches::patch_of_ids;
use super::statements::{expect_no_field, fields, next_field, parse_decimals, parse_integer, unexpected};
use super::twin_configurations::{self, ConfigurationLine, OpenLines};
use super::twin_functions::{self, FunctionGroup, FunctionLine};
use super::twin_header::TwinHeader;
use super::twin_rows::parse_row;
use super::twin4::{self, Group4, Statement4};
use spmesh_core::error::{Error, Result};
use spmesh_core::limits::BLOCK_PAYLOAD_MAX;
use spmesh_model::bounds::Point;
use spmesh_model::cells::CellCode;
use spmesh_stream::{
    ConfigurationBlock, Coordinates, Event, Header, Kind, Patch, Tally, Totals, check_place,
};

/// Greatest number of lines that become one event.
const BATCH_MAX: usize = 4096;

/// One line, parsed. Vertices and residual points are counted from 0 here.
enum Statement {
    Vertex(Point),
    Cell(CellCode),
    Patch,
    /// A triangle uses the first three.
    Simplex([u64; 4]),
    Final(u64),
    Label(u64),
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

/// The lines of a patch, with ids instead of local indices.
#[derive(Default)]
struct PatchLines {
    new: Vec<Point>,
    /// Ids of all simplices, concatenated.
    simplices: Vec<u64>,
    finalized: Vec<u64>,
}

impl PatchLines {
    /// Length in bytes of the payload without imported vertices.
    fn len_min(&self, header: &Header) -> usize {
        24 + self.new.len() * header.point_len() + self.simplices.len() * 4 + self.finalized.len() * 4
    }
}

/// Lines that become the next event.
enum Group {
    Empty,
    Points(Vec<Point>),
    Cells(Vec<CellCode>),
    Patch(PatchLines),
    Labels(Vec<u64>),
    Residual(Vec<(Option<u64>, Point)>),
    /// Corners of all walls, concatenated.
    Walls(Vec<u32>),
    Four(Group4),
    Configurations(ConfigurationBlock),
    Functions(FunctionGroup),
}

/// Reads a text twin. Memory: one line, and the lines of one block.
///
/// Every error is [`spmesh_core::error::ErrorKind::Malformed`] (or I/O) and names input and line.
pub struct TwinSource<R> {
    lines: Lines<R>,
    header: Header,
    held: Option<Statement>,
    group: Group,
    /// Rows of the points of the group, and of the last event.
    group_rows: Vec<u8>,
    rows: Vec<u8>,
    open: OpenLines,
    tally: Tally,
    ended: bool,
}

impl<R: Read> TwinSource<R> {
    /// Reads the header. Messages call the input `name`.
    ///
    /// # Errors
    /// If the input is not a text twin, or its header is incomplete or breaks a rule.
    pub fn new(input: R, name: impl Into<String>) -> Result<Self> {
        let mut lines = Lines::new(input, name);
        let mut header = TwinHeader::default();
        let mut is_first_content = false;
        while let Some(line) = lines.next_line()? {
            let parsed = match header_statement(line) {
                Some(rest) => header.line(rest),
                None => {
                    is_first_content = is_content(line);
                    Ok(())
                }
            };
            parsed.map_err(|e| lines.locate(e))?;
            if is_first_content {
                break;
            }
        }
        let header = header.finish().map_err(|e| lines.locate(e))?;
        let tally = Tally::new(&header);
        let (group, open) = (Group::Empty, OpenLines::default());
        let (group_rows, rows) = (Vec::new(), Vec::new());
        let mut source =
            TwinSource { lines, header, held: None, group, group_rows, rows, open, tally, ended: false };
        if is_first_content {
            source.held =
                parse_statement(source.lines.current(), &source.header).map_err(|e| source.locate(e))?;
        }
        Ok(source)
    }

    fn read_statement(&mut self) -> Result<Statement> {
        loop {
            let Some(line) = self.lines.next_line()? else {
                return Err(Error::malformed("truncated: the text ends without the line \"# end\""));
            };
            if let Some(statement) = parse_statement(line, &self.header)? {
                return Ok(statement);
            }
        }
    }

    fn advance(&mut self) -> Result<Event> {
        loop {
            let statement = match self.held.take() {
                Some(statement) => statement,
                None => self.read_statement()?,
            };
            if !self.group.takes(&statement) {
                self.held = Some(statement);
                return self.take_group();
            }
            if let Statement::End(stated) = statement {
                self.open.check_closed()?;
                self.tally.check_end(&self.header, &stated)?;
                self.expect_end_of_input()?;
                self.ended = true;
                return Ok(Event::End(stated));
            }
            self.push(statement)?;
        }
    }

    /// Checks that each point of the group has its row, if the header lists attributes.
    fn check_rows(&self) -> Result<()> {
        let rows_len = self.group.points() * self.header.attributes.row_len();
        if self.group_rows.len() == rows_len {
            return Ok(());
        }
        Err(Error::malformed("a line \"a\" with the attributes of the point before is missing"))
    }

    /// Adds the row of the last point of the group.
    fn push_row(&mut self, row: &[u8]) -> Result<()> {
        self.group_rows.extend_from_slice(row);
        if self.group_rows.len() > self.group.points() * self.header.attributes.row_len() {
            return Err(Error::malformed("attributes without a point before them"));
        }
        if matches!(self.group, Group::Patch(_)) && self.group_rows.len() > BLOCK_PAYLOAD_MAX {
            return Err(too_long());
        }
        Ok(())
    }

    /// Adds a statement to the group, or starts a group with it.
    fn push(&mut self, statement: Statement) -> Result<()> {
        if let Statement::Row(row) = &statement {
            return self.push_row(row);
        }
        self.check_rows()?;
        let is_mesh = self.header.kind.vertices_per_simplex() > 0;
        let is_points = self.header.kind == Kind::Points
            || self.header.kind.has_knots() && !self.open.is_begun() && !self.has_functions();
        let is_partial = self.header.kind.is_partial();
        let is_tetrahedral = self.header.kind == Kind::TetrahedralMesh;
        let Totals { residual_points, walls, simplices, vertices, .. } = *self.tally.totals();
        let kind = self.header.kind.name();
        let misplaced = || Error::malformed(format!("a {kind} cannot have this line here"));
        match (&mut self.group, statement) {
            (Group::Points(points), Statement::Vertex(point)) => points.push(point),
            (Group::Cells(cells), Statement::Cell(cell)) => cells.push(cell),
            (Group::Patch(patch), Statement::Vertex(point)) => patch.new.push(point),
            (Group::Patch(patch), Statement::Simplex(ids)) => {
                patch.simplices.extend_from_slice(&ids[..self.header.kind.vertices_per_simplex()]);
            }
            (Group::Patch(patch), Statement::Final(id)) => patch.finalized.push(id),
            (Group::Labels(labels), Statement::Label(label)) => labels.push(label),
            (Group::Residual(points), Statement::Residual(id, point)) => points.push((id, point)),
            (Group::Walls(walls), Statement::Wall(wall)) => {
                let corners = self.header.kind.vertices_per_wall();
                walls.extend(check_wall(&wall[..corners], residual_points)?);
            }
            (Group::Four(group), Statement::Four(statement)) => group.push(statement)?,
            (Group::Configurations(block), Statement::Configuration(line)) => self.open.push(block, line)?,
            (Group::Functions(group), Statement::Function(line)) => group.push(line)?,
            (Group::Empty, statement) => {
                self.group = match statement {
                    Statement::Vertex(_) if is_points => Group::Points(Vec::new()),
                    Statement::Cell(_) if is_points => Group::Cells(Vec::new()),
                    Statement::Patch if is_mesh && residual_points == 0 => {
                        Group::Patch(PatchLines::default())
                    }
                    Statement::Label(_) if is_tetrahedral => Group::Labels(Vec::new()),
                    Statement::Residual(..) if is_partial && walls == 0 => Group::Residual(Vec::new()),
                    Statement::Wall(_) if is_partial => Group::Walls(Vec::new()),
                    Statement::Function(ref first) => Group::Functions(
                        FunctionGroup::start(first, self.tally.totals()).ok_or_else(misplaced)?,
                    ),
                    Statement::Configuration(ref first) if !self.has_functions() => Group::Configurations(
                        self.open
                            .start(first)?
                            .ok_or_else(|| Error::malformed("a degree starts with a line \"degree\""))?,
                    ),
                    Statement::Four(ref first) if Group4::can_start(&self.header, first, simplices > 0) => {
                        Group::Four(Group4::start(&self.header, first, vertices))
                    }
                    _ => return Err(misplaced()),
                };
                if !matches!(statement, Statement::Patch) {
                    return self.push(statement);
                }
            }
            _ => unreachable!("the group takes the statement"),
        }
        match &self.group {
            Group::Patch(patch) if patch.len_min(&self.header) > BLOCK_PAYLOAD_MAX => Err(too_long()),
            _ => Ok(()),
        }
    }

    /// The event of the group, checked by the rules of streams.
    fn take_group(&mut self) -> Result<Event> {
        self.check_rows()?;
        self.rows.clear();
        std::mem::swap(&mut self.group_rows, &mut self.rows);
        let vertices = self.tally.totals().vertices;
        let event = match std::mem::replace(&mut self.group, Group::Empty) {
            Group::Empty => unreachable!("the empty group takes every statement"),
            Group::Points(points) => Event::Points(points),
            Group::Cells(cells) => Event::Cells(cells),
            Group::Patch(lines) => Event::Patch(self.patch_of(vertices, lines)?),
            Group::Labels(labels) => Event::Labels(labels),
            Group::Residual(points) => {
                let mut named = points.iter().filter_map(|&(id, _)| id);
                if let Some(id) = named.find(|&id| id >= vertices) {
                    return Err(Error::malformed(format!(
                        "residual point is vertex {}, which is none",
                        id + 1
                    )));
                }
                Event::ResidualPoints(points)
            }
            Group::Walls(walls) => Event::Walls(walls),
            Group::Four(group) => group.finish()?,
            Group::Configurations(block) => Event::Configurations(block),
            Group::Functions(group) => group.finish(),
        };
        self.tally.count(&event)?;
        Ok(event)
    }

    /// Whether functions or coefficients have begun. Knots and configurations precede them.
    fn has_functions(&self) -> bool {
        let Totals { vertices, residual_points, .. } = self.tally.totals();
        self.header.kind.has_knots() && vertices + residual_points > 0
    }

    fn patch_of(&self, first_id: u64, lines: PatchLines) -> Result<Patch> {
        let len_min = lines.len_min(&self.header);
        let PatchLines { new, simplices, finalized } = lines;
        let end = first_id + new.len() as u64;
        if let Some(id) = simplices.iter().chain(&finalized).find(|&&id| id >= end) {
            return Err(Error::malformed(format!("vertex {} of {end}", id + 1)));
        }
        let patch = patch_of_ids(first_id, new, &simplices, &finalized);
        if len_min + patch.imported.len() * 8 > BLOCK_PAYLOAD_MAX {
            return Err(too_long());
        }
        if patch.finalized.windows(2).any(|pair| pair[0] == pair[1]) {
            return Err(Error::malformed("the patch finalizes a vertex twice"));
        }
        Ok(patch)
    }

    fn expect_end_of_input(&mut self) -> Result<()> {
        while let Some(line) = self.lines.next_line()? {
            if !line.trim_ascii().is_empty() {
                return Err(Error::malformed("the text goes on after its end"));
            }
        }
        Ok(())
    }
}

impl<R: Read> EventSource for TwinSource<R> {
    fn header(&self) -> &Header {
        &self.header
    }

    fn next_event(&mut self) -> Result<Option<Event>> {
        if self.ended {
            return Ok(None);
        }
        self.advance().map(Some).map_err(|e| self.locate(e))
    }

    fn rows(&self) -> &[u8] {
        &self.rows
    }

    fn locate(&self, error: Error) -> Error {
        self.lines.locate(error)
    }
}

impl Group {
    /// Number of its points that have rows.
    fn points(&self) -> usize {
        match self {
            Group::Points(points) => points.len(),
            Group::Patch(patch) => patch.new.len(),
            Group::Residual(points) => points.len(),
            _ => 0,
        }
    }

    /// Whether the statement belongs to the group's event.
    fn takes(&self, statement: &Statement) -> bool {
        match (self, statement) {
            (Group::Empty, _) => true,
            (Group::Points(_) | Group::Patch(_) | Group::Residual(_), Statement::Row(_)) => true,
            (Group::Points(points), Statement::Vertex(_)) => points.len() < BATCH_MAX,
            (Group::Cells(cells), Statement::Cell(_)) => cells.len() < BATCH_MAX,
            (Group::Patch(_), Statement::Vertex(_) | Statement::Simplex(_) | Statement::Final(_)) => true,
            (Group::Labels(labels), Statement::Label(_)) => labels.len() < BATCH_MAX,
            (Group::Residual(points), Statement::Residual(..)) => points.len() < BATCH_MAX,
            (Group::Walls(walls), Statement::Wall(_)) => walls.len() < BATCH_MAX,
            (Group::Four(group), Statement::Four(statement)) => group.takes(statement, BATCH_MAX),
            (Group::Configurations(block), Statement::Configuration(line)) => {
                twin_configurations::takes(block, line)
            }
            (Group::Functions(group), Statement::Function(line)) => group.takes(line, BATCH_MAX),
            _ => false,
        }
    }
}

/// The part of a header line after `#spmesh`; `None` for other lines.
fn header_statement(line: &[u8]) -> Option<&[u8]> {
    let rest = line.trim_ascii_start().strip_prefix(b"#spmesh")?;
    (rest.is_empty() || matches!(rest[0], b' ' | b'\t')).then_some(rest)
}

/// Whether a line is a statement of content or the end.
fn is_content(line: &[u8]) -> bool {
    let mut fields = fields(line);
    match fields.next() {
        None => false,
        Some(b"#") => matches!(fields.next(), Some(b"patch" | b"end")),
        Some(first) => first[0] != b'#',
    }
}

/// The statement of a line; `None` for empty lines and comments.
fn parse_statement(line: &[u8], header: &Header) -> Result<Option<Statement>> {
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
    let statement = match next_field(fields)? {
        word if header.kind.is_4d() && word != b"#" => Statement::Four(twin4::parse(word, fields, header)?),
        word if header.kind.has_knots() && !matches!(word, b"v" | b"#") => {
            match (twin_configurations::parse(word, fields)?, header.kind) {
                (Some(line), _) => Statement::Configuration(line),
                (None, Kind::Configurations) if word == b"coefficient" => {
                    return Err(unexpected(word, statements_of(header.kind)));
                }
                (None, kind) => match twin_functions::parse(word, fields)? {
                    Some(line) => Statement::Function(line),
                    None => return Err(unexpected(word, statements_of(kind))),
                },
            }
        }
        b"v" => Statement::Vertex(parse_point(fields, header)?),
        b"f" if per_simplex == 3 => Statement::Simplex(parse_simplex(fields, 3)?),
        b"c" if per_simplex == 4 => Statement::Simplex(parse_simplex(fields, 4)?),
        b"a" if !header.attributes.is_empty() => Statement::Row(parse_row(fields, &header.attributes)?),
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
        b"w" if header.kind.is_partial() => {
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
        Kind::Configurations => "v, degree, in, on, line, function, term or a comment",
        Kind::Splines => "v, degree, in, on, line, function, term, coefficient or a comment",
        Kind::Points4 | Kind::Cells4 | Kind::Simplices4 => "an end or a comment",
    }
}

/// Converts world coordinates to a stored point and checks it against the header.
fn parse_point<'a>(fields: &mut impl Iterator<Item = &'a [u8]>, header: &Header) -> Result<Point> {
    let world = parse_decimals::<3>(fields)?;
    let (coordinates, axes) = (&header.coordinates, header.coordinates_per_point());
    let mut stored = coordinates.to_stored(world);
    stored[axes..].fill(0.0);
    if let Some(z) = world[axes..].iter().find(|&&z| z != 0.0) {
        return Err(Error::malformed(format!(
            "z is {z}, but the points of this stream have none: expected 0"
        )));
    }
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
    check_place(header, stored)?;
    Ok(stored)
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

/// A wall between distinct residual points.
fn check_wall(wall: &[u64], residual_points: u64) -> Result<Vec<u32>> {
    let known = |&corner: &u64| u32::try_from(corner).ok().filter(|_| corner < residual_points);
    let corners: Option<Vec<u32>> = wall.iter().map(known).collect();
    let is_sound = |corners: &Vec<u32>| (1..corners.len()).all(|i| !corners[..i].contains(&corners[i]));
    corners
        .filter(is_sound)
        .ok_or_else(|| Error::malformed(format!("wall between no {} residual points", wall.len())))
}

fn too_long() -> Error {
    Error::malformed(format!("the patch is longer than a block of {BLOCK_PAYLOAD_MAX} bytes"))
}
