//! Reads PDB: records of fixed columns.
//!
//! Reads files of many programs, not only of the archive: lines may end after the coordinates, and serial and
//! residue numbers may exceed their columns in the usual ways (hybrid-36, hexadecimal, one column more,
//! asterisks). An ambiguous coordinate is an error.

use std::io::Read;

use crate::molecules::builder::{Oddity, Record, StructureBuilder};
use crate::molecules::decimal::Number;
use crate::molecules::pdb_assemblies::Remark350;
use crate::molecules::pdb_header;
use crate::molecules::pqr;
use crate::molecules::serial::{Serials, residue_number};
use crate::text::lines::{Lines, quote};
use crate::twin::tokens::unexpected;
use spmesh_base::error::{Error, Result};

/// First columns of x, y and z, counted from 0.
const PLACE: [(usize, &str); 3] = [(30, "x"), (38, "y"), (46, "z")];

/// Width of a coordinate in columns.
const WIDTH: usize = 8;

/// Number of columns that are used.
pub(crate) const LINE_LEN: usize = 80;

/// Reads all records. Atoms are those of PQR if `is_pqr`.
pub(crate) fn read(lines: &mut Lines<impl Read>, builder: &mut StructureBuilder, is_pqr: bool) -> Result<()> {
    let mut reader = PdbReader::new(is_pqr);
    while lines.next_line()?.is_some() {
        reader.read_line(lines, builder)?;
    }
    builder.end(lines.unended());
    Ok(())
}

/// Whether a line is only a part of the name of an atom's record.
fn is_part_of_name(line: &[u8]) -> bool {
    !line.is_empty() && (b"ATOM".starts_with(line) || b"HETATM".starts_with(line))
}

/// Reads records line by line.
pub(crate) struct PdbReader {
    serials: Serials,
    remark: Remark350,
    is_pqr: bool,
    /// Whether the last model has ended.
    is_closed: bool,
    /// Number of the line, counted from 1.
    number: u64,
}

impl PdbReader {
    pub(crate) fn new(is_pqr: bool) -> PdbReader {
        let (serials, remark) = (Serials::default(), Remark350::default());
        PdbReader { serials, remark, is_pqr, is_closed: false, number: 0 }
    }

    /// Whether the last model has ended.
    pub(crate) fn is_closed(&self) -> bool {
        self.is_closed
    }

    /// Begins a model in a structure of its own.
    pub(crate) fn end_model(&mut self) {
        (self.is_closed, self.serials) = (false, Serials::default());
    }

    /// Reads the current line of `lines`.
    pub(crate) fn read_line(
        &mut self,
        lines: &Lines<impl Read>,
        builder: &mut StructureBuilder,
    ) -> Result<()> {
        let line = lines.current();
        self.number += 1;
        self.line(line, builder).map_err(|e| lines.locate(e))?;
        if is_part_of_name(line) && !lines.is_ended() {
            return Err(lines.locate(Error::malformed("truncated: the file ends inside of a record")));
        }
        Ok(())
    }

    fn line(&mut self, line: &[u8], builder: &mut StructureBuilder) -> Result<()> {
        if line.contains(&b'\r') {
            return Err(Error::malformed(
                "carriage return inside of a line: lines must end with LF or CR LF",
            ));
        }
        match record_name(line) {
            b"ATOM" => return self.atom(line, false, builder),
            b"HETATM" => return self.atom(line, true, builder),
            b"MODEL" => self.start_model(line, builder),
            b"ENDMDL" | b"END" => self.is_closed = true,
            b"TER" => builder.end_chain(),
            b"SEQRES" => pdb_header::sequence(line, builder),
            b"REMARK" => {
                if let Some(text) =
                    pdb_header::text(line).and_then(|text| text[6..].trim_start().strip_prefix("350"))
                {
                    self.remark.line(text, builder);
                }
            }
            b"MODRES" => pdb_header::modified_residue(line, builder),
            b"CRYST1" => pdb_header::unit_cell(line, self.number, builder),
            _ => {}
        }
        Ok(())
    }

    fn start_model(&mut self, line: &[u8], builder: &mut StructureBuilder) {
        let number = line.get(5..).and_then(|rest| std::str::from_utf8(rest).ok()?.trim().parse().ok());
        let number = number.unwrap_or_else(|| {
            builder.note(Oddity::Model, self.number);
            builder.next_model_number()
        });
        builder.start_model(number);
        (self.is_closed, self.serials) = (false, Serials::default());
    }

    /// Starts a model for an atom behind the end of one.
    fn reopen(&mut self, builder: &mut StructureBuilder) {
        if std::mem::take(&mut self.is_closed) {
            builder.note(Oddity::Model, self.number);
            let number = builder.next_model_number();
            builder.start_model(number);
            self.serials = Serials::default();
        }
    }

    fn atom(&mut self, line: &[u8], is_hetatm: bool, builder: &mut StructureBuilder) -> Result<()> {
        if self.is_pqr {
            self.reopen(builder);
            return builder.push(&pqr::atom(line, self.number, is_hetatm)?);
        }
        let place = place(line)?;
        let text = ascii(line)?;
        self.reopen(builder);
        let serial = self.serials.parse(serial_text(text, is_hetatm));
        if serial.is_none() {
            builder.note(Oddity::Serial, self.number);
        }
        let (residue, insertion_code) = residue_texts(text);
        let residue_number = residue_number(residue);
        if residue_number.is_none() && !residue.is_empty() {
            builder.note(Oddity::ResidueNumber, self.number);
        }
        let occupancy = columns(text, 54, 60);
        let share = occupancy.parse().ok().filter(|share: &f32| share.is_finite());
        if share.is_none() && !occupancy.is_empty() {
            builder.note(Oddity::Occupancy, self.number);
        }
        let element = columns(text, 76, 78);
        let (chain, segment) = (columns(text, 21, 22), segment(text));
        builder.push(&Record {
            line: self.number,
            serial,
            name: columns(text, 12, 16),
            // Older files have their PDB code and a line number in the last columns.
            element: if element.bytes().all(|byte| byte.is_ascii_alphabetic()) { element } else { "" },
            altloc: columns(text, 16, 17),
            chain: if chain.is_empty() { segment } else { chain },
            subchain: "",
            entity: "",
            segment,
            // The format leaves column 21 empty; residue names of four letters are widely used.
            residue_name: columns(text, 17, 21),
            residue_number,
            insertion_code,
            occupancy: share.unwrap_or(1.0),
            is_hetatm,
            symbol_len: symbol_len(text),
            place,
            radius: None,
        })
    }
}

/// Whether a line begins a model.
pub(crate) fn is_model(line: &[u8]) -> bool {
    record_name(line) == b"MODEL"
}

/// The name of the record if it is used, in upper case; the line may have it in lower case.
fn record_name(line: &[u8]) -> &'static [u8] {
    let is = |name: &[u8], len: usize| {
        line.get(..name.len()).is_some_and(|start| start.eq_ignore_ascii_case(name))
            && line[name.len()..line.len().min(len)]
                .iter()
                .all(|byte| matches!(byte, b' ' | b'\t' | b'0'..=b'9'))
    };
    match line.first() {
        Some(b'A' | b'a') if is(b"ATOM", 6) => b"ATOM",
        Some(b'H' | b'h') if is(b"HETATM", 6) => b"HETATM",
        Some(b'M' | b'm') if is(b"MODEL", 6) => b"MODEL",
        Some(b'E' | b'e') if is(b"ENDMDL", 6) => b"ENDMDL",
        Some(b'E' | b'e') if is(b"END", 6) => b"END",
        Some(b'T' | b't') if is(b"TER", 6) => b"TER",
        Some(b'S' | b's') if is(b"SEQRES", 6) => b"SEQRES",
        Some(b'M' | b'm') if is(b"MODRES", 6) => b"MODRES",
        Some(b'C' | b'c') if is(b"CRYST1", 6) => b"CRYST1",
        Some(b'R' | b'r') if is(b"REMARK", 6) => b"REMARK",
        _ => b"",
    }
}

/// The coordinates of an atom.
fn place(line: &[u8]) -> Result<[Number; 3]> {
    let end = PLACE[2].0 + WIDTH;
    if line.len() < end {
        let axis = PLACE.iter().find(|&&(start, _)| line.len() < start + WIDTH);
        let &(start, axis) = axis.expect("the line ends before the last axis");
        return Err(Error::malformed(format!(
            "the line ends after column {}, expected {axis} in columns {} to {}",
            line.len(),
            start + 1,
            start + WIDTH
        )));
    }
    let mut place = [Number::Float(0.0); 3];
    for (number, (start, axis)) in place.iter_mut().zip(PLACE) {
        let field = &line[start..start + WIDTH];
        let expected = || format!("{axis} in columns {} to {}", start + 1, start + WIDTH);
        *number = Number::parse(field.trim_ascii()).ok_or_else(|| unexpected(field, &expected()))?;
        if !is_apart(line, start) {
            return Err(overflow(line, &expected()));
        }
    }
    if is_apart(line, end) { Ok(place) } else { Err(overflow(line, "z in columns 47 to 54")) }
}

/// Whether the number that starts at `start` is separate from the characters before it. Numbers of eight
/// columns with three decimal places may touch; other numbers that touch may have overflowed their columns.
fn is_apart(line: &[u8], start: usize) -> bool {
    let is_part = |byte: u8| byte.is_ascii_digit() || byte == b'.';
    let starts_within = line.get(start).is_some_and(|&byte| is_part(byte));
    let before = line[start - 1];
    !starts_within || !(is_part(before) || before == b'-') || (start > PLACE[0].0 && line[start - 4] == b'.')
}

fn overflow(line: &[u8], expected: &str) -> Error {
    let coordinates = quote(line[PLACE[0].0 - 1..].trim_ascii_end());
    Error::malformed(format!(
        "coordinates run over their columns in {coordinates}, expected {expected}: write mmCIF instead"
    ))
}

/// The used columns as ASCII text, one byte per column.
fn ascii(line: &[u8]) -> Result<&str> {
    let line = &line[..line.len().min(LINE_LEN)];
    let is_printable = |byte: &u8| matches!(byte, b' '..=b'~');
    // Nearly all lines are printable: without an early exit the loop is vectorized.
    if !line.iter().fold(true, |all, byte| all & is_printable(byte)) {
        let at = line.iter().position(|byte| !is_printable(byte)).expect("one is not");
        let found = format!("byte {:#04x} in column {}", line[at], at + 1);
        return Err(Error::malformed(format!("{found}, expected printable ASCII")));
    }
    Ok(std::str::from_utf8(line).expect("printable ASCII"))
}

/// The text of columns counted from 0, cut off at the end of the line, without surrounding blanks.
pub(crate) fn columns(line: &str, start: usize, end: usize) -> &str {
    let end = end.min(line.len());
    line.get(start..end).unwrap_or_default().trim_ascii()
}

/// The segment, as programs for simulations name it in columns 73 to 76; empty if there is none. Older files
/// have the code of the entry there, before the number of the line.
fn segment(line: &str) -> &str {
    let behind = columns(line, 76, LINE_LEN);
    let is_numbered = !behind.is_empty() && behind.bytes().all(|byte| byte.is_ascii_digit());
    if is_numbered { "" } else { columns(line, 72, 76) }
}

/// Letters of the element's symbol in the name, columns 13 to 16: symbols of two letters start in column 13,
/// others in column 14, after a blank or a number. Names of four characters fill all columns and do not tell.
pub(crate) fn symbol_len(line: &str) -> u8 {
    match line.as_bytes()[12..16] {
        [b' ' | b'0'..=b'9', ..] => 1,
        [_, .., b' '] => 2,
        _ => 0,
    }
}

/// The text of the serial number: columns 7 to 11, and the adjacent columns into which numbers overflow.
fn serial_text(line: &str, is_hetatm: bool) -> &str {
    let start = if is_hetatm { 6 } else { 4 };
    let goes_on = line.as_bytes()[10..12].iter().all(u8::is_ascii_digit);
    columns(line, start, if goes_on { 12 } else { 11 })
}

/// The texts of residue number and insertion code. A digit in the code's column belongs to the number.
fn residue_texts(line: &str) -> (&str, &str) {
    if line.as_bytes()[26].is_ascii_digit() {
        (columns(line, 22, 27), "")
    } else {
        (columns(line, 22, 26), columns(line, 26, 27))
    }
}
