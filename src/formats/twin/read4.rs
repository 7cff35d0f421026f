//! Reads the lines of text twins of four dimensions (`formats/text.md`).

use crate::twin::tokens::{expect_no_field, next_field, parse_decimals, parse_integer, unexpected};
use spmesh_base::error::{Error, Result};
use spmesh_stream::model::cells4::{Cell4, Cells4, Point4};
use spmesh_stream::{
    Event, Header, Kind, Points4, check_neighbour_count, check_value, check_vertex_count, check_word_count,
};

/// Number of words from which a group of cells takes no further cell.
const BATCH_WORDS: usize = 1 << 16;

/// One line, parsed. Points and cells are counted from 0 here.
pub(crate) enum Statement4 {
    Vertex(Point4, Option<f64>),
    /// Start of a cell, with its vertices.
    Cell {
        is_infinite: bool,
        vertices: Vec<u32>,
    },
    /// Neighbours of the cell.
    Neighbours(Vec<u32>),
    /// Continuation of the list before.
    More(Vec<u32>),
    Simplex([u32; 5]),
}

/// Parses the statement of `word` and the `fields` after it.
pub(crate) fn parse<'a>(
    word: &[u8],
    fields: &mut impl Iterator<Item = &'a [u8]>,
    header: &Header,
) -> Result<Statement4> {
    let statement = match (word, header.kind) {
        (b"v4", _) => parse_vertex(fields, header.has_elevation)?,
        (b"c4" | b"i4", Kind::Cells4) => {
            Statement4::Cell { is_infinite: word == b"i4", vertices: parse_numbers(fields)? }
        }
        (b"n4", Kind::Cells4) => Statement4::Neighbours(parse_numbers(fields)?),
        (b"+4", Kind::Cells4) => Statement4::More(parse_numbers(fields)?),
        (b"s4", Kind::Simplices4) => {
            let mut simplex = [0; 5];
            for vertex in &mut simplex {
                *vertex = parse_number(next_field(fields)?)?;
            }
            Statement4::Simplex(simplex)
        }
        (word, Kind::Cells4) => return Err(unexpected(word, "v4, c4, i4, n4, +4 or a comment")),
        (word, Kind::Simplices4) => return Err(unexpected(word, "v4, s4 or a comment")),
        (word, _) => return Err(unexpected(word, "v4 or a comment")),
    };
    expect_no_field(fields)?;
    Ok(statement)
}

fn parse_vertex<'a>(fields: &mut impl Iterator<Item = &'a [u8]>, has_value: bool) -> Result<Statement4> {
    let point = parse_decimals::<4>(fields)?;
    if !has_value {
        return Ok(Statement4::Vertex(point, None));
    }
    let value = match next_field(fields)? {
        b"nan" => f64::NAN,
        field => parse_decimals::<1>(&mut std::iter::once(field))?[0],
    };
    check_value(value)?;
    Ok(Statement4::Vertex(point, Some(value)))
}

fn parse_numbers<'a>(fields: &mut impl Iterator<Item = &'a [u8]>) -> Result<Vec<u32>> {
    fields.map(parse_number).collect()
}

/// A number that counts from 1, converted to a u32 that counts from 0.
fn parse_number(field: &[u8]) -> Result<u32> {
    let number = parse_integer(field)?.checked_sub(1).and_then(|number| u32::try_from(number).ok());
    number.ok_or_else(|| unexpected(field, "a number from 1 to 2^32"))
}

/// Lines that become the next event.
pub(crate) enum Group4 {
    Points(Points4),
    Cells(CellLines),
    Simplices(Vec<[u32; 5]>),
}

impl Group4 {
    /// Whether `first` may start a group; points come before everything else.
    pub(crate) fn can_start(header: &Header, first: &Statement4, has_simplices: bool) -> bool {
        match first {
            Statement4::Vertex(..) => !has_simplices,
            Statement4::Cell { .. } => header.kind == Kind::Cells4,
            Statement4::Simplex(_) => header.kind == Kind::Simplices4,
            Statement4::Neighbours(_) | Statement4::More(_) => false,
        }
    }

    /// The empty group that `first` starts after `points` points.
    pub(crate) fn start(header: &Header, first: &Statement4, points: u64) -> Self {
        match first {
            Statement4::Vertex(..) => Group4::Points(Points4::new(header.has_elevation)),
            Statement4::Simplex(_) => Group4::Simplices(Vec::new()),
            _ => Group4::Cells(CellLines { points, ..CellLines::default() }),
        }
    }

    /// Whether the statement belongs to the group's event.
    pub(crate) fn takes(&self, statement: &Statement4, batch_max: usize) -> bool {
        match (self, statement) {
            (Group4::Points(points), Statement4::Vertex(..)) => points.points.len() < batch_max,
            (Group4::Cells(cells), Statement4::Cell { .. }) => cells.words < BATCH_WORDS,
            (Group4::Cells(_), Statement4::Neighbours(_) | Statement4::More(_)) => true,
            (Group4::Simplices(simplices), Statement4::Simplex(_)) => simplices.len() < batch_max,
            _ => false,
        }
    }

    /// Adds a statement that the group takes.
    pub(crate) fn push(&mut self, statement: Statement4) -> Result<()> {
        match (self, statement) {
            (Group4::Points(points), Statement4::Vertex(point, value)) => {
                points.points.push(point);
                if let (Some(values), Some(value)) = (&mut points.values, value) {
                    values.push(value);
                }
                Ok(())
            }
            (Group4::Cells(cells), statement) => cells.push(statement),
            (Group4::Simplices(simplices), Statement4::Simplex(simplex)) => {
                simplices.push(simplex);
                Ok(())
            }
            _ => unreachable!("the group takes the statement"),
        }
    }

    /// The group's event.
    pub(crate) fn finish(self) -> Result<Event> {
        match self {
            Group4::Points(points) => Ok(Event::Points4(points)),
            Group4::Simplices(simplices) => Ok(Event::Simplices4(simplices)),
            Group4::Cells(mut cells) => {
                cells.close()?;
                Ok(Event::Cells4(cells.done))
            }
        }
    }
}

/// Cells, of which the last may be incomplete.
#[derive(Default)]
pub(crate) struct CellLines {
    done: Cells4,
    open: Option<OpenCell>,
    words: usize,
    /// Number of points before the cells.
    points: u64,
}

struct OpenCell {
    is_infinite: bool,
    vertices: Vec<u32>,
    neighbours: Option<Vec<u32>>,
}

impl CellLines {
    fn push(&mut self, statement: Statement4) -> Result<()> {
        match (statement, &mut self.open) {
            (Statement4::Cell { is_infinite, vertices }, _) => {
                self.close()?;
                self.words += vertices.len();
                self.open = Some(OpenCell { is_infinite, vertices, neighbours: None });
            }
            (Statement4::Neighbours(numbers), Some(cell)) if cell.neighbours.is_none() => {
                self.words += numbers.len();
                cell.neighbours = Some(numbers);
            }
            (Statement4::More(numbers), Some(cell)) => {
                self.words += numbers.len();
                cell.neighbours.as_mut().unwrap_or(&mut cell.vertices).extend(numbers);
                cell.check_words(self.points)?;
            }
            _ => return Err(Error::malformed("a cell has one line c4 or i4, and then one line n4")),
        }
        Ok(())
    }

    /// Adds the open cell, if there is one, to the others.
    fn close(&mut self) -> Result<()> {
        let Some(OpenCell { is_infinite, vertices, neighbours }) = self.open.take() else { return Ok(()) };
        let neighbours =
            neighbours.ok_or_else(|| Error::malformed("a cell is not followed by its line n4"))?;
        self.done.push(Cell4 { is_infinite, vertices: &vertices, neighbours: &neighbours });
        Ok(())
    }
}

impl OpenCell {
    /// Checks the lists so far. One that is broken over lines is checked before the next line is read.
    fn check_words(&self, points: u64) -> Result<()> {
        let (vertices, neighbours) = (self.vertices.len() as u64, self.neighbours.as_ref().map(Vec::len));
        if let Some(neighbours) = neighbours {
            check_neighbour_count(self.is_infinite, vertices, neighbours as u64)?;
        } else {
            check_vertex_count(self.is_infinite, vertices, points)?;
        }
        check_word_count(2 + vertices + neighbours.unwrap_or(0) as u64)
    }
}
