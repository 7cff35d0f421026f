//! Reads the XYZ format of chemistry: frames of a count, a comment, and lines `element x y z`.

use std::io::Read;

use crate::molecules::builder::{Record, StructureBuilder, printable};
use crate::molecules::decimal::Number;
use crate::molecules::periodic_box::PeriodicBox;
use crate::text::lines::Lines;
use crate::twin::tokens::{expect_no_field, fields, next_field, parse_integer, unexpected};
use spmesh_base::error::{Error, Result};

/// Reads all frames, each as a model. Atoms are numbered from 1 in each frame; their name is their element.
pub(crate) fn read(lines: &mut Lines<impl Read>, builder: &mut StructureBuilder) -> Result<()> {
    while read_frame(lines, builder)? {}
    builder.end(lines.unended());
    Ok(())
}

/// Reads a frame as the next model; false at the end of the input.
pub(crate) fn read_frame(lines: &mut Lines<impl Read>, builder: &mut StructureBuilder) -> Result<bool> {
    let Some(atoms) = read_count(lines).map_err(|e| lines.locate(e))? else { return Ok(false) };
    builder.start_model(builder.next_model_number());
    let Some(comment) = lines.next_line()? else {
        return Err(lines.locate(truncated("the comment of the frame")));
    };
    let stated = lattice(comment);
    let columns = value(comment, b"properties").map_or(Ok(Columns::USUAL), Columns::parse);
    let columns = columns.map_err(|e| lines.locate(e))?;
    builder.set_box(stated.map(|stated| stated.map_err(|e| lines.locate(e))));
    let first = lines.number();
    for serial in 1..=atoms {
        let Some(line) = lines.next_line()? else {
            return Err(lines.locate(truncated(&format!("atom {serial} of {atoms}"))));
        };
        read_atom(line, columns, [serial, first + serial], builder).map_err(|e| lines.locate(e))?;
    }
    Ok(true)
}

/// The box that the comment of a frame states, if it states one.
fn lattice(comment: &[u8]) -> Option<Result<PeriodicBox>> {
    let text = value(comment, b"lattice")?;
    let is_false = |field: &[u8]| field.first().is_some_and(|letter| letter.eq_ignore_ascii_case(&b'f'));
    if fields(value(comment, b"pbc").unwrap_or_default()).any(is_false) {
        return Some(Err(Error::malformed("the frame does not repeat along all three vectors (pbc)")));
    }
    let number = |field: &[u8]| Some(Number::parse(field)?.value());
    let numbers: Option<Vec<f64>> = fields(text).map(number).collect();
    let numbers = numbers.filter(|numbers| numbers.len() == 9);
    let numbers = numbers.ok_or_else(|| unexpected(text, "the nine numbers of three vectors in Lattice"));
    Some(numbers.and_then(|numbers| PeriodicBox::from_numbers(&numbers)))
}

/// The value of a key in the comment of extended XYZ, `key=value` or `key="value"`, without its quotes.
fn value<'c>(comment: &'c [u8], key: &[u8]) -> Option<&'c [u8]> {
    let starts = |at: usize| {
        let is_first = at == 0 || comment[at - 1].is_ascii_whitespace();
        let found = comment.get(at..at + key.len());
        is_first
            && found.is_some_and(|found| found.eq_ignore_ascii_case(key))
            && comment.get(at + key.len()) == Some(&b'=')
    };
    let at = (0..comment.len()).find(|&at| starts(at))?;
    let rest = &comment[at + key.len() + 1..];
    let is_end = |&byte: &u8| byte.is_ascii_whitespace();
    Some(match rest.first() {
        Some(quote @ (b'"' | b'\'')) => rest[1..].split(|byte| byte == quote).next().unwrap_or_default(),
        _ => &rest[..rest.iter().position(is_end).unwrap_or(rest.len())],
    })
}

/// Columns of an atom, counted from 0.
#[derive(Debug, Clone, Copy)]
struct Columns {
    /// Of the element, if there is one.
    element: Option<usize>,
    /// Of x, before y and z.
    x: usize,
}

impl Columns {
    /// Those of a file that does not state them.
    const USUAL: Columns = Columns { element: Some(0), x: 1 };

    /// The columns of a list `name:type:count:...`: types are S, R, I and L.
    fn parse(list: &[u8]) -> Result<Columns> {
        let parts: Vec<&[u8]> = list.split(|&byte| byte == b':').collect();
        let expected = "NAME:TYPE:COUNT:... with pos:R:3 in Properties";
        let (mut end, mut symbol, mut number, mut x) = (0usize, None, None, None);
        for property in parts.chunks(3) {
            let &[name, kind, count] = property else { return Err(unexpected(list, expected)) };
            let columns = std::str::from_utf8(count).ok().and_then(|count| count.parse::<u16>().ok());
            let columns = columns.filter(|&columns| columns > 0 && !name.is_empty());
            let is_type = matches!(kind, b"S" | b"R" | b"I" | b"L");
            let Some(columns) = columns.filter(|_| is_type) else { return Err(unexpected(list, expected)) };
            let place = match (name.to_ascii_lowercase().as_slice(), kind, columns) {
                (b"species" | b"element" | b"elements", b"S", 1) => &mut symbol,
                (b"z" | b"numbers" | b"atomic_number", b"I", 1) => &mut number,
                (b"pos" | b"positions", b"R" | b"I", 3) => &mut x,
                (b"species" | b"pos" | b"positions", ..) => return Err(unexpected(list, expected)),
                _ => &mut None,
            };
            if place.replace(end).is_some() {
                return Err(unexpected(list, "each name once in Properties"));
            }
            end += usize::from(columns);
        }
        let x = x.ok_or_else(|| unexpected(list, expected))?;
        Ok(Columns { element: symbol.or(number), x })
    }
}

/// The number of atoms in the next frame; `None` if there is no frame.
fn read_count(lines: &mut Lines<impl Read>) -> Result<Option<u64>> {
    while let Some(line) = lines.next_line()? {
        let mut fields = fields(line);
        if let Some(count) = fields.next() {
            expect_no_field(&mut fields)?;
            return parse_integer(count).map(Some);
        }
    }
    Ok(None)
}

/// Reads an atom; `serial` is its number in the frame, and `line` in the file.
fn read_atom(
    text: &[u8],
    columns: Columns,
    [serial, line]: [u64; 2],
    builder: &mut StructureBuilder,
) -> Result<()> {
    let mut element = "";
    let mut place = [Number::Float(0.0); 3];
    let mut fields = fields(text);
    for column in 0..=columns.element.unwrap_or(0).max(columns.x + 2) {
        let field = next_field(&mut fields)?;
        if columns.element == Some(column) {
            element = printable(field, "an element")?;
        }
        let axis =
            column.checked_sub(columns.x).and_then(|axis| place.get_mut(axis).zip(["x", "y", "z"].get(axis)));
        if let Some((number, axis)) = axis {
            *number =
                Number::parse(field).ok_or_else(|| unexpected(field, &format!("a number for {axis}")))?;
        }
    }
    builder.push(&Record {
        line,
        serial: Some(serial),
        name: element,
        element,
        altloc: "",
        chain: "",
        subchain: "",
        entity: "",
        segment: "",
        residue_name: "",
        residue_number: None,
        insertion_code: "",
        occupancy: 1.0,
        is_hetatm: false,
        symbol_len: 0,
        place,
        radius: None,
    })
}

fn truncated(expected: &str) -> Error {
    Error::malformed(format!("truncated: expected {expected}"))
}
