//! Reads the XYZ format of chemistry: frames of a count, a comment, and lines `element x y z`.

use std::io::Read;

use crate::molecules::builder::{Record, StructureBuilder, printable};
use crate::molecules::decimal::Number;
use crate::text::lines::Lines;
use crate::twin::tokens::{expect_no_field, fields, next_field, parse_integer, unexpected};
use spmesh_base::error::{Error, Result};

/// Reads all frames, each as a model. Atoms are numbered from 1 in each frame; their name is their element.
pub(crate) fn read(lines: &mut Lines<impl Read>, builder: &mut StructureBuilder) -> Result<()> {
    let mut frame = 0;
    while let Some(atoms) = read_count(lines).map_err(|e| lines.locate(e))? {
        frame += 1;
        builder.start_model(frame);
        if lines.next_line()?.is_none() {
            return Err(lines.locate(truncated("the comment of the frame")));
        }
        let first = lines.number();
        for serial in 1..=atoms {
            let Some(line) = lines.next_line()? else {
                return Err(lines.locate(truncated(&format!("atom {serial} of {atoms}"))));
            };
            read_atom(line, [serial, first + serial], builder).map_err(|e| lines.locate(e))?;
        }
    }
    builder.end(lines.unended());
    Ok(())
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
fn read_atom(text: &[u8], [serial, line]: [u64; 2], builder: &mut StructureBuilder) -> Result<()> {
    let mut fields = fields(text);
    let element = printable(next_field(&mut fields)?, "an element")?;
    let mut place = [Number::Float(0.0); 3];
    for (number, axis) in place.iter_mut().zip(["x", "y", "z"]) {
        let field = next_field(&mut fields)?;
        *number = Number::parse(field).ok_or_else(|| unexpected(field, &format!("a number for {axis}")))?;
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
        residue_name: "",
        residue_number: None,
        insertion_code: "",
        occupancy: 1.0,
        is_hetatm: false,
        symbol_len: 0,
        place,
    })
}

fn truncated(expected: &str) -> Error {
    Error::malformed(format!("truncated: expected {expected}"))
}
