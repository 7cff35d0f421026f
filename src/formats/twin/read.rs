//! Reads the text twin of a stream (`formats/text.md`).

use std::io::Read;

use crate::source::events::EventSource;
use crate::source::patches::patch_of_ids;
use crate::text::lines::Lines;
use crate::twin::header::TwinHeader;
use crate::twin::read_configurations::{self, OpenLines};
use crate::twin::read_functions::FunctionGroup;
use crate::twin::read4::Group4;
use crate::twin::statements::{Statement, header_statement, is_content, parse_statement};
use spmesh_base::error::{Error, Result};
use spmesh_base::limits::BLOCK_PAYLOAD_MAX;
use spmesh_stream::model::bounds::Point;
use spmesh_stream::model::cells::CellCode;
use spmesh_stream::{
    ConfigurationBlock, Event, GlobalId, Header, Kind, Origin, Patch, PointRegion, Segment, Tally, Totals,
    check_residual_id,
};

/// Greatest number of lines that become one event.
const BATCH_MAX: usize = 4096;

/// The lines of a patch, with ids instead of local indices.
#[derive(Default)]
struct PatchLines {
    new: Vec<Point>,
    /// Ids of all simplices, concatenated.
    simplices: Vec<u64>,
    finalized: Vec<u64>,
    /// Triangle, corner and segment of each side.
    sides: Vec<[u64; 3]>,
    /// New vertices that other parts have, and their ids in all parts.
    origins: Vec<[u64; 2]>,
    /// Finalized vertices that other parts use.
    kept: Vec<u64>,
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
    /// Its one line.
    Region(Option<PointRegion>),
    Patch(PatchLines),
    Labels(Vec<u64>),
    Segments(Vec<Segment>),
    OpenSegments(Vec<u32>),
    Residual(Vec<(Option<u64>, Point)>),
    /// Corners of all walls, concatenated.
    Walls(Vec<u32>),
    Four(Group4),
    Configurations(ConfigurationBlock),
    Functions(FunctionGroup),
}

/// Reads a text twin. Memory: one line, and the lines of one block.
///
/// Every error is [`spmesh_base::error::ErrorKind::Malformed`] (or I/O) and names input and line.
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
    /// Whether a segment is open: no patch and no segment follows.
    has_open_segments: bool,
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
        let mut source = TwinSource {
            lines,
            header,
            held: None,
            group,
            group_rows,
            rows,
            open,
            tally,
            has_open_segments: false,
            ended: false,
        };
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
        let is_mesh = self.header.kind.vertices_per_simplex() > 0 && !self.header.kind.is_residual();
        let is_points = matches!(self.header.kind, Kind::Points | Kind::RegionPoints)
            || self.header.kind.has_knots() && !self.open.is_begun() && !self.has_functions();
        let is_partial = self.header.kind.has_region();
        let is_tetrahedral = self.header.kind == Kind::TetrahedralMesh;
        let Totals { residual_points, walls, simplices, vertices, .. } = *self.tally.totals();
        let kind = self.header.kind.name();
        let misplaced = || Error::malformed(format!("a {kind} cannot have this line here"));
        match (&mut self.group, statement) {
            (Group::Points(points), Statement::Vertex(point)) => points.push(point),
            (Group::Cells(cells), Statement::Cell(cell)) => cells.push(cell),
            (Group::Region(line), Statement::Region(region)) => *line = Some(region),
            (Group::Patch(patch), Statement::Vertex(point)) => patch.new.push(point),
            (Group::Patch(patch), Statement::Simplex(ids)) => {
                patch.simplices.extend_from_slice(&ids[..self.header.kind.vertices_per_simplex()]);
            }
            (Group::Patch(patch), Statement::Final(id)) => patch.finalized.push(id),
            (Group::Patch(patch), Statement::Origin(vertex, id)) => patch.origins.push([vertex, id]),
            (Group::Patch(patch), Statement::Kept(id)) => patch.kept.push(id),
            (Group::Labels(labels), Statement::Label(label)) => labels.push(label),
            (Group::Segments(segments), Statement::Segment(segment)) => segments.push(segment),
            (Group::Patch(patch), Statement::Side(side)) => patch.sides.push(side),
            (Group::OpenSegments(open), Statement::OpenSegment(segment)) => open.push(segment),
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
                    Statement::Region(_) => Group::Region(None),
                    Statement::Patch if is_mesh && residual_points == 0 && !self.has_open_segments => {
                        Group::Patch(PatchLines::default())
                    }
                    Statement::Label(_) if is_tetrahedral => Group::Labels(Vec::new()),
                    Statement::Segment(_) if !self.has_open_segments => Group::Segments(Vec::new()),
                    Statement::OpenSegment(_) => {
                        self.has_open_segments = true;
                        Group::OpenSegments(Vec::new())
                    }
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
        self.header.weights().map_or(Ok(()), |weights| weights.check(&self.rows))?;
        let vertices = self.tally.totals().vertices;
        let event = match std::mem::replace(&mut self.group, Group::Empty) {
            Group::Empty => unreachable!("the empty group takes every statement"),
            Group::Points(points) => Event::Points(points),
            Group::Cells(cells) => Event::Cells(cells),
            Group::Region(region) => Event::Region(region.expect("its line started the group")),
            Group::Patch(lines) => Event::Patch(self.patch_of(vertices, lines)?),
            Group::Labels(labels) => Event::Labels(labels),
            Group::Segments(segments) => Event::Segments(segments),
            Group::OpenSegments(open) => Event::OpenSegments(open),
            Group::Residual(points) => {
                let mut named = points.iter().filter_map(|&(id, _)| id);
                if let Some(id) = named.find(|&id| check_residual_id(&self.header, vertices, id).is_err()) {
                    let message = format!("residual point is vertex {}, which is none", id + 1);
                    return Err(Error::malformed(message));
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
        let PatchLines { new, simplices, finalized, sides, origins, kept } = lines;
        let end = first_id + new.len() as u64;
        if let Some(id) = simplices.iter().chain(&finalized).find(|&&id| id >= end) {
            return Err(Error::malformed(format!("vertex {} of {end}", id + 1)));
        }
        let mut patch = patch_of_ids(first_id, new, &simplices, &finalized);
        patch.sides = self.sides_of(sides)?;
        name_shared(&mut patch, &origins, &kept)?;
        if len_min + patch.imported.len() * 8 > BLOCK_PAYLOAD_MAX {
            return Err(too_long());
        }
        if patch.finalized.windows(2).any(|pair| pair[0] == pair[1]) {
            return Err(Error::malformed("the patch finalizes a vertex twice"));
        }
        Ok(patch)
    }

    /// Sides with the numbers of triangles in the patch.
    fn sides_of(&self, sides: Vec<[u64; 3]>) -> Result<Vec<[u32; 3]>> {
        if sides.len() * 12 > BLOCK_PAYLOAD_MAX {
            return Err(Error::malformed(format!(
                "the sides are longer than a block of {BLOCK_PAYLOAD_MAX} bytes"
            )));
        }
        let first = self.tally.totals().simplices;
        let local = |&[triangle, place, segment]: &[u64; 3]| {
            let triangle = triangle.checked_sub(first)?;
            Some([triangle.try_into().ok()?, place.try_into().ok()?, segment.try_into().ok()?])
        };
        let number = |side: &[u64; 3]| {
            local(side).ok_or_else(|| {
                Error::malformed(format!(
                    "side {} of triangle {} is not in its patch",
                    side[1] + 1,
                    side[0] + 1
                ))
            })
        };
        sides.iter().map(number).collect()
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
            (
                Group::Patch(_),
                Statement::Vertex(_)
                | Statement::Simplex(_)
                | Statement::Final(_)
                | Statement::Side(_)
                | Statement::Origin(..)
                | Statement::Kept(_),
            ) => true,
            (Group::Labels(labels), Statement::Label(_)) => labels.len() < BATCH_MAX,
            (Group::Segments(segments), Statement::Segment(_)) => segments.len() < BATCH_MAX,
            (Group::OpenSegments(open), Statement::OpenSegment(_)) => open.len() < BATCH_MAX,
            (Group::Residual(points), Statement::Residual(..)) => points.len() < BATCH_MAX,
            (Group::Walls(walls), Statement::Wall(_)) => walls.len() < BATCH_MAX,
            (Group::Four(group), Statement::Four(statement)) => group.takes(statement, BATCH_MAX),
            (Group::Configurations(block), Statement::Configuration(line)) => {
                read_configurations::takes(block, line)
            }
            (Group::Functions(group), Statement::Function(line)) => group.takes(line, BATCH_MAX),
            _ => false,
        }
    }
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

/// Says of a patch which of its vertices other parts have, as `[vertex, id]`, and which ones they use.
fn name_shared(patch: &mut Patch, origins: &[[u64; 2]], kept: &[u64]) -> Result<()> {
    let none = |id: u64| Error::malformed(format!("vertex {} is not one of the patch", id + 1));
    for &[vertex, id] in origins {
        let local = vertex.checked_sub(patch.first_id).filter(|&local| local < patch.new.len() as u64);
        let local = local.ok_or_else(|| none(vertex))? as u32;
        patch.origins.push(Origin { local, id: GlobalId(id) });
    }
    for &id in kept {
        let local = match id.checked_sub(patch.first_id) {
            Some(local) if local < patch.new.len() as u64 => local as usize,
            Some(_) => return Err(none(id)),
            None => patch.new.len() + patch.imported.binary_search(&id).map_err(|_| none(id))?,
        };
        patch.kept.push(local as u32);
    }
    Ok(())
}

fn too_long() -> Error {
    Error::malformed(format!("the patch is longer than a block of {BLOCK_PAYLOAD_MAX} bytes"))
}
