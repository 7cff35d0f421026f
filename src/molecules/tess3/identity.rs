//! Columns that say what a row is of. They are the same in all tables, so that tables can be joined.

use super::Level;
use spmesh_base::error::Result;
use spmesh_formats::molecules::{AtomView, Selected};
use spmesh_formats::sink::TableSink;

/// What all rows of a model have in common.
#[derive(Debug, Clone, Copy)]
pub(super) struct Origin<'s> {
    /// The file, as it was given; "stdin" without one.
    pub(super) file: &'s str,
    /// Number that the file gives the model.
    pub(super) model: i64,
}

impl Origin<'_> {
    /// The names of its columns, which come first.
    pub(super) const COLUMNS: &'static str = "file model";

    /// Starts a row.
    pub(super) fn start_row(&self, rows: &mut TableSink) -> Result<()> {
        rows.field(self.file);
        rows.integer(self.model)
    }
}

/// A column of an atom, a residue or a chain.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Field {
    Chain,
    LabelChain,
    Segment,
    ResidueNumber,
    InsertionCode,
    ResidueName,
    Class,
    AtomName,
    Element,
    Altloc,
    Serial,
}

const FIELDS: [(Field, &str); 11] = [
    (Field::Chain, "chain"),
    (Field::LabelChain, "label_chain"),
    (Field::Segment, "segment"),
    (Field::ResidueNumber, "residue_number"),
    (Field::InsertionCode, "insertion_code"),
    (Field::ResidueName, "residue_name"),
    (Field::Class, "class"),
    (Field::AtomName, "atom_name"),
    (Field::Element, "element"),
    (Field::Altloc, "altloc"),
    (Field::Serial, "serial"),
];

/// The fields that identify what a row of this level is about.
fn fields(level: Level) -> &'static [(Field, &'static str)] {
    match level {
        Level::Atom => &FIELDS,
        Level::Residue => &FIELDS[..7],
        Level::Chain => &FIELDS[..2],
        Level::Molecule => &[],
    }
}

/// The names of the columns of a level, between `before` and `after`: those of the second atom of a contact
/// end with 2.
pub(super) fn columns(level: Level, before: &str, after: &str) -> Vec<String> {
    fields(level).iter().map(|(_, name)| format!("{before}{name}{after}")).collect()
}

/// What a group of atoms is called: by its first atom.
#[derive(Debug, Clone, Copy)]
pub(super) struct Named {
    /// Index of the atom in the selection.
    pub(super) atom: u32,
    /// All of its atoms are in one part of the chain.
    pub(super) is_one_part: bool,
}

impl Named {
    pub(super) fn atom(atom: u32) -> Named {
        Named { atom, is_one_part: true }
    }

    /// Writes the fields of a level. Those that only a lower level than `known` has do not apply: a chain may
    /// stand in rows of residues.
    pub(super) fn write(
        self,
        selected: &Selected<'_>,
        level: Level,
        known: Level,
        rows: &mut TableSink,
    ) -> Result<()> {
        let view = selected.atom(self.atom as usize);
        // A chain of polymers is of one class.
        let is_known = |pair| fields(known).contains(pair) || pair.0 == Field::Class && known == Level::Chain;
        for pair in fields(level) {
            match &view {
                _ if pair.0 == Field::Serial => rows.integer(selected.label(self.atom as usize))?,
                Some(view) if is_known(pair) => self.field(view, pair.0, rows)?,
                _ => rows.nothing(),
            }
        }
        Ok(())
    }

    fn field(self, atom: &AtomView<'_>, field: Field, rows: &mut TableSink) -> Result<()> {
        let text = match field {
            Field::Chain => atom.chain(),
            Field::LabelChain if !self.is_one_part => {
                rows.nothing();
                return Ok(());
            }
            Field::LabelChain => atom.subchain(),
            Field::Segment => atom.segment(),
            Field::InsertionCode => atom.insertion_code(),
            Field::ResidueName => atom.residue_name(),
            Field::Class => atom.residue().class.name(),
            Field::AtomName => atom.name(),
            Field::Element => atom.element(),
            Field::Altloc => atom.altloc(),
            Field::ResidueNumber => match atom.residue_number() {
                Some(number) => return rows.integer(number),
                None => {
                    rows.nothing();
                    return Ok(());
                }
            },
            Field::Serial => return rows.integer(atom.atom.serial),
        };
        rows.field(text);
        Ok(())
    }
}
