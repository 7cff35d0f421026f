//! PQR: records of PDB whose atoms are fields with blanks between them, with a charge and a radius at the
//! end. Columns do not count, but many files keep those of PDB as far as the coordinates.

use std::num::NonZeroU16;

use crate::molecules::builder::Record;
use crate::molecules::decimal::Number;
use crate::molecules::pdb::{columns, symbol_len};
use crate::molecules::serial::residue_number;
use crate::twin::tokens::unexpected;
use spmesh_base::error::{Error, Result};

/// Fields of an atom behind those of its residue: coordinates, charge and radius.
const NUMBERS: usize = 5;

/// Greatest radius in steps of 0.001 Å: beyond all atoms.
const STEPS_MAX: f64 = 65_000.0;

/// Greatest radius of an atom, in Å, in a file that is recognized.
const RADIUS_MAX: f64 = 10.0;

/// Atoms at the start of a file that tell whether it is PQR.
const ATOMS_SEEN: usize = 100;

/// What is behind ATOM or HETATM.
fn after_name(line: &str) -> Option<&str> {
    let start = |name: &str| line.get(..name.len()).filter(|word| word.eq_ignore_ascii_case(name));
    let name = start("HETATM").or(start("ATOM"))?;
    Some(&line[name.len()..])
}

/// Whether one of the first atoms is a record of PQR, and none of PDB.
pub(crate) fn is_pqr<'a>(lines: impl Iterator<Item = &'a [u8]>) -> bool {
    let atoms =
        lines.filter_map(|line| std::str::from_utf8(line).ok().filter(|line| after_name(line).is_some()));
    atoms.take(ATOMS_SEEN).any(is_atom)
}

/// Whether the last five fields are numbers that are not at the places of PDB, where occupancy and B factor
/// would be charge and radius.
fn is_atom(line: &str) -> bool {
    let fields: Vec<&str> = after_name(line).unwrap_or_default().split_ascii_whitespace().collect();
    let Some(at) = fields.len().checked_sub(NUMBERS).filter(|at| (4..=5).contains(at)) else { return false };
    let are_numbers = fields[at..].iter().all(|field| Number::parse(field.as_bytes()).is_some());
    let is_number = |start: usize, end: usize| columns(line, start, end).parse::<f64>().is_ok();
    let may_be = |start: usize, end: usize| columns(line, start, end).is_empty() || is_number(start, end);
    let has_place = is_number(30, 38) && is_number(38, 46) && is_number(46, 54);
    let is_pdb = line.is_ascii() && has_place && may_be(54, 60) && may_be(60, 66);
    let has_two_places = |field: &str| field.split_once('.').is_some_and(|(_, places)| places.len() == 2);
    let may_be_shares = fields[at + 3..].iter().all(|field| has_two_places(field) && !field.starts_with('-'));
    let is_radius = fields[at + 4].parse::<f64>().is_ok_and(|radius| (0.0..=RADIUS_MAX).contains(&radius));
    are_numbers && is_radius && !is_pdb && !may_be_shares
}

/// The atom of a line, which ends in `line`.
pub(crate) fn atom(text: &[u8], line: u64, is_hetatm: bool) -> Result<Record<'_>> {
    let is_plain = text.iter().all(|byte| matches!(byte, b' '..=b'~' | b'\t'));
    let plain = std::str::from_utf8(text).ok().filter(|_| is_plain);
    let text = plain.ok_or_else(|| unexpected(text, "printable ASCII"))?;
    let fields: Vec<&str> = after_name(text).unwrap_or_default().split_ascii_whitespace().collect();
    let names = fields.len().checked_sub(NUMBERS).map(|at| fields.split_at(at));
    let (&[serial, name, residue_name, ref place @ ..], numbers) = names.unwrap_or_default() else {
        return Err(wrong_count(fields.len()));
    };
    let (chain, number) = match *place {
        [number] => number.split_at(number.find(|c: char| !c.is_ascii_alphabetic()).unwrap_or(0)),
        [chain, number] => (chain, number),
        _ => return Err(wrong_count(fields.len())),
    };
    let (number, insertion_code) =
        number.split_at(number.trim_end_matches(|c: char| c.is_ascii_alphabetic()).len());
    let residue_number =
        residue_number(number).ok_or_else(|| unexpected(number.as_bytes(), "the number of a residue"))?;
    let parse = |at: usize, what: &str| {
        let field = numbers[at].as_bytes();
        Number::parse(field).ok_or_else(|| unexpected(field, &format!("a number for {what}")))
    };
    parse(3, "the charge")?;
    Ok(Record {
        line,
        serial: serial.parse().ok(),
        name,
        element: "",
        altloc: "",
        chain,
        subchain: "",
        entity: "",
        segment: "",
        residue_name,
        residue_number: Some(residue_number),
        insertion_code,
        occupancy: 1.0,
        is_hetatm,
        symbol_len: if columns(text, 12, 16) == name { symbol_len(text) } else { 0 },
        place: [parse(0, "x")?, parse(1, "y")?, parse(2, "z")?],
        radius: Some(radius(parse(4, "the radius")?, numbers[4])?),
    })
}

fn wrong_count(count: usize) -> Error {
    Error::malformed(format!(
        "found {count} fields behind the name of the record, expected serial number, atom, residue, chain \
         (or none), number, x, y, z, charge and radius"
    ))
}

/// A radius, rounded to steps of 0.001 Å, as an atom has it.
fn radius(number: Number, field: &str) -> Result<NonZeroU16> {
    let steps = (1000.0 * number.value()).round();
    let is_radius = (0.0..=STEPS_MAX).contains(&steps);
    let radius = is_radius.then(|| NonZeroU16::new(steps as u16 + 1)).flatten();
    radius.ok_or_else(|| unexpected(field.as_bytes(), "a radius of 0 to 65 Å"))
}
