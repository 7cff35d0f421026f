//! What PDB files state of their molecules before the atoms. Damaged records are skipped: atoms do not depend
//! on them.

use crate::molecules::builder::StructureBuilder;
use crate::molecules::pdb::{LINE_LEN, columns};
use crate::molecules::periodic_box::PeriodicBox;
use crate::molecules::residue_names::{Kind, kind};
use crate::molecules::serial::residue_number;

/// Columns of the residues in a line of a sequence, counted from 0: each takes four.
const RESIDUES: std::ops::Range<usize> = 19..70;

/// Reads a line of a sequence (SEQRES).
pub(crate) fn sequence(line: &[u8], builder: &mut StructureBuilder) {
    let Some(text) = text(line) else { return };
    let chain = builder.intern(columns(text, 11, 12));
    for start in RESIDUES.step_by(4) {
        let name = columns(text, start, start + 3);
        if !name.is_empty() {
            let name = builder.intern(name);
            builder.annotations.sequences.insert((chain, name));
        }
    }
}

/// Reads the record of a modified residue (MODRES). Files also have such records for sugars, whose standard
/// residue is none of a polymer.
pub(crate) fn modified_residue(line: &[u8], builder: &mut StructureBuilder) {
    let Some(text) = text(line) else { return };
    if kind(columns(text, 24, 27)) == Kind::Polymer {
        let chain = builder.intern(columns(text, 16, 17));
        let insertion_code = builder.intern(columns(text, 22, 23));
        let name = builder.intern(columns(text, 12, 15));
        let site = (chain, residue_number(columns(text, 18, 22)), insertion_code, name);
        builder.annotations.modified.insert(site);
    }
}

/// Reads the record of the unit cell (CRYST1). Structures that are not of crystals have the cell of 1 Å; in
/// simulations without a box it is zero.
pub(crate) fn unit_cell(line: &[u8], number: u64, builder: &mut StructureBuilder) {
    const COLUMNS: [(usize, usize); 6] = [(6, 15), (15, 24), (24, 33), (33, 40), (40, 47), (47, 54)];
    let Some(text) = text(line) else { return };
    let numbers = COLUMNS.map(|(start, end)| columns(text, start, end).parse().unwrap_or(f64::NAN));
    let stated = PeriodicBox::of_unit_cell(numbers);
    builder.set_box(stated.map(|stated| stated.map_err(|e| e.at(format!("line {number}")))));
    builder.set_space_group(columns(text, 55, 66));
}

/// The text of the used columns of a line, if it is ASCII.
pub(crate) fn text(line: &[u8]) -> Option<&str> {
    let line = &line[..line.len().min(LINE_LEN)];
    line.is_ascii().then(|| std::str::from_utf8(line).ok())?
}
