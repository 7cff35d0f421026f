//! Reads GRO, the structures of GROMACS: frames of a title, a count, atoms in columns, and the vectors of the
//! box. Lengths are in nm; those of structures are in Å.
//!
//! Source: the reference manual of GROMACS, "File formats", gro. Chains have no names there.

use std::io::Read;

use crate::molecules::builder::{Oddity, Record, StructureBuilder, printable};
use crate::molecules::decimal::Number;
use crate::molecules::periodic_box::PeriodicBox;
use crate::text::lines::Lines;
use crate::twin::tokens::{fields, parse_integer, parse_signed, unexpected};
use spmesh_base::error::{Error, Result};

/// Columns of the residue, of the atom's name and of its number, before the coordinates.
const NAMES_LEN: usize = 20;

/// Numbers of five columns start again from 0 after 99,999.
const TURN: u64 = 100_000;

/// Greatest width of a coordinate in columns.
const WIDTH_MAX: usize = 40;

/// Reads all frames, each as a model.
pub(crate) fn read(lines: &mut Lines<impl Read>, builder: &mut StructureBuilder) -> Result<()> {
    while read_frame(lines, builder)? {}
    Ok(())
}

/// Reads a frame as the next model; false at the end of the input.
pub(crate) fn read_frame(lines: &mut Lines<impl Read>, builder: &mut StructureBuilder) -> Result<bool> {
    let Some(atoms) = read_count(lines)? else { return Ok(false) };
    builder.start_model(builder.next_model_number());
    let (mut width, mut last) = (None, 0);
    for at in 1..=atoms {
        let number = lines.number() + 1;
        let Some(line) = lines.next_line()? else {
            return Err(lines.locate(truncated(&format!("atom {at} of {atoms}"))));
        };
        let wanted = match width {
            Some(width) => width,
            None => *width.insert(
                width_of(line).ok_or_else(|| unexpected(line, COLUMNS)).map_err(|e| lines.locate(e))?,
            ),
        };
        let line = lines.current();
        last = read_atom(line, wanted, [last, number], builder).map_err(|e| lines.locate(e))?;
    }
    let Some(line) = lines.next_line()? else {
        return Err(lines.locate(truncated("the vectors of the box")));
    };
    let vectors = box_of(line).map_err(|e| lines.locate(e))?;
    let stated = PeriodicBox::of_vectors(vectors);
    builder.set_box_of(false, stated.map(|stated| stated.map_err(|e| lines.locate(e))));
    Ok(true)
}

/// The number of atoms in the next frame, below its title; `None` if only blank lines are left.
fn read_count(lines: &mut Lines<impl Read>) -> Result<Option<u64>> {
    let Some(mut title) = lines.next_line()?.map(|line| line.trim_ascii().is_empty()) else {
        return Ok(None);
    };
    while let Some(line) = lines.next_line()? {
        let count = line.trim_ascii();
        if !count.is_empty() || !title {
            return parse_integer(count).map(Some).map_err(|e| lines.locate(e));
        }
        title = true;
    }
    if title { Ok(None) } else { Err(lines.locate(truncated("the number of atoms"))) }
}

const COLUMNS: &str = "the coordinates of an atom, three numbers of equal width from column 21 on";

/// The width of coordinates in columns, by the places of their decimal points in the first atom.
fn width_of(line: &[u8]) -> Option<usize> {
    let mut points = line.iter().skip(NAMES_LEN).enumerate().filter(|(_, byte)| **byte == b'.');
    let [a, b, c] = [points.next()?.0, points.next()?.0, points.next()?.0];
    let is_even = b - a == c - b && (2..=WIDTH_MAX).contains(&(b - a));
    is_even.then_some(b - a)
}

/// Whether a text is GRO: a title, a count, and an atom in its columns.
pub(crate) fn is_gro(head: &[u8]) -> bool {
    let mut lines = head.split(|&byte| byte == b'\n').map(<[u8]>::trim_ascii_end).skip(1);
    let has_count = lines.next().is_some_and(|line| parse_integer(line.trim_ascii()).is_ok_and(|n| n > 0));
    let is_atom = |line: &[u8]| {
        let is_number = |start, end| parse_integer(columns(line, start, end)).is_ok();
        let is_coordinate = |field: &[u8]| {
            !field.is_empty() && std::str::from_utf8(field).is_ok_and(|f| f.parse::<f64>().is_ok())
        };
        let has_name = columns(line, 5, 10).iter().any(u8::is_ascii_alphabetic);
        let place = width_of(line).map(|width| place(width).map(|(start, end)| columns(line, start, end)));
        has_name
            && parse_signed(columns(line, 0, 5)).is_ok()
            && (is_number(15, 20) || columns(line, 15, 20) == b"*****")
            && place.is_some_and(|place| place.into_iter().all(is_coordinate))
    };
    has_count && lines.next().is_some_and(is_atom)
}

/// First column of each coordinate, and the one behind its last, counted from 0.
fn place(width: usize) -> [(usize, usize); 3] {
    [0, 1, 2].map(|axis| (NAMES_LEN + axis * width, NAMES_LEN + (axis + 1) * width))
}

/// Columns of a line, as far as it has them, without surrounding blanks.
fn columns(line: &[u8], start: usize, end: usize) -> &[u8] {
    line.get(start..end.min(line.len())).unwrap_or_default().trim_ascii()
}

/// Reads an atom, whose coordinates are `width` columns wide. Velocities behind them are not used. Takes the
/// serial number of the atom before and the number of the line; returns the serial number.
fn read_atom(
    line: &[u8],
    width: usize,
    [before, number]: [u64; 2],
    builder: &mut StructureBuilder,
) -> Result<u64> {
    let mut coordinates = [Number::Float(0.0); 3];
    for ((coordinate, (start, end)), axis) in coordinates.iter_mut().zip(place(width)).zip(["x", "y", "z"]) {
        let expected = || format!("{axis} in columns {} to {end}", start + 1);
        let field = line.get(start..end).ok_or_else(|| {
            let len = line.len();
            Error::malformed(format!("the line ends after column {len}, expected {}", expected()))
        })?;
        let found = Number::parse(field.trim_ascii()).ok_or_else(|| unexpected(field, &expected()))?;
        *coordinate = found.tenfold();
    }
    let residue = columns(line, 0, 5);
    let residue_number = std::str::from_utf8(residue).ok().and_then(|text| text.parse().ok());
    if residue_number.is_none() && !residue.is_empty() {
        builder.note(Oddity::ResidueNumber, number);
    }
    let serial = match parse_integer(columns(line, 15, 20)) {
        Ok(serial) if serial == (before + 1) % TURN => before + 1,
        Ok(serial) => serial,
        Err(_) => {
            builder.note(Oddity::Serial, number);
            before + 1
        }
    };
    builder.push(&Record {
        line: number,
        serial: Some(serial),
        name: printable(columns(line, 10, 15), "the name of an atom")?,
        element: "",
        altloc: "",
        chain: "",
        subchain: "",
        entity: "",
        segment: "",
        residue_name: printable(columns(line, 5, 10), "the name of a residue")?,
        residue_number,
        insertion_code: "",
        occupancy: 1.0,
        is_hetatm: false,
        symbol_len: 0,
        place: coordinates,
        radius: None,
    })?;
    Ok(serial)
}

/// The vectors of the box in Å, of three lengths or nine components: the diagonal, then the others by rows.
fn box_of(line: &[u8]) -> Result<[[f64; 3]; 3]> {
    let numbers = box_fields(line).into_iter().map(|field| Some(Number::parse(field)?.tenfold().value()));
    match numbers.collect::<Option<Vec<f64>>>().as_deref() {
        Some(&[ax, by, cz]) => Ok([[ax, 0.0, 0.0], [0.0, by, 0.0], [0.0, 0.0, cz]]),
        Some(&[ax, by, cz, ay, az, bx, bz, cx, cy]) => Ok([[ax, ay, az], [bx, by, bz], [cx, cy, cz]]),
        _ => Err(unexpected(line, "three or nine numbers of the box")),
    }
}

/// The numbers in the line of the box. Those that fill their columns touch, and all have as many decimals.
fn box_fields(line: &[u8]) -> Vec<&[u8]> {
    let line = line.trim_ascii_end();
    let separate: Vec<&[u8]> = fields(line).collect();
    let is_point = |byte: &u8| *byte == b'.';
    let Some(last) = line.iter().rposition(is_point).filter(|_| !matches!(separate.len(), 3 | 9)) else {
        return separate;
    };
    let (mut start, places) = (0, line.len() - last);
    let ends = (0..=last).filter(|&at| is_point(&line[at])).map(|at| at + places);
    ends.map(|end| line[std::mem::replace(&mut start, end)..end].trim_ascii()).collect()
}

fn truncated(expected: &str) -> Error {
    Error::malformed(format!("truncated: expected {expected}"))
}
