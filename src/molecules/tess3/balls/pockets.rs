//! Rows of pockets and voids, and of what is around them.

use std::collections::BTreeSet;

use super::groups::Groups;
use super::{BallOptions, Level, Molecule};
use crate::balls::Pocket;
use spmesh_base::error::Result;
use spmesh_formats::sink::TableSink;

pub(super) fn columns(options: &BallOptions) -> String {
    match (options.mouths, options.level) {
        (true, Level::Molecule) => "model pocket mouth area atoms".into(),
        (true, Level::Atom) => "model pocket mouth atom serial".into(),
        (true, level) => format!("model pocket mouth {}", level.name()),
        (false, Level::Molecule) => {
            "model pocket kind volume area mouths mouth_area depth atoms tetrahedra".into()
        }
        (false, Level::Atom) => "model pocket kind atom serial".into(),
        (false, level) => format!("model pocket kind {}", level.name()),
    }
}

/// The table of pockets, or of what is around them.
pub(super) struct PocketTable<'t> {
    pub(super) molecule: &'t Molecule<'t>,
    pub(super) level: Level,
    /// Rows are about mouths.
    pub(super) mouths: bool,
    pub(super) groups: &'t Groups,
}

impl PocketTable<'_> {
    /// Pockets are numbered from 1, the largest first.
    pub(super) fn write(&self, pockets: &[Pocket], rows: &mut TableSink) -> Result<()> {
        for (number, pocket) in (1..).zip(pockets) {
            if self.mouths {
                self.write_mouths(number, pocket, rows)?;
            } else if self.level == Level::Molecule {
                self.start_row(number, pocket, rows)?;
                self.end_pocket(pocket, rows)?;
            } else {
                self.write_around(number, pocket, rows)?;
            }
        }
        Ok(())
    }

    fn start_row(&self, number: u32, pocket: &Pocket, rows: &mut TableSink) -> Result<()> {
        rows.integer(self.molecule.number)?;
        rows.integer(number)?;
        rows.field(if pocket.mouths.is_empty() { "void" } else { "pocket" });
        Ok(())
    }

    fn end_pocket(&self, pocket: &Pocket, rows: &mut TableSink) -> Result<()> {
        let scale = self.molecule.scale;
        rows.number(pocket.volume * scale.powi(3));
        rows.number(pocket.area * scale.powi(2));
        rows.integer(pocket.mouths.len())?;
        rows.number(pocket.mouth_area() * scale.powi(2));
        rows.number(pocket.depth * scale);
        rows.integer(pocket.balls.len())?;
        rows.integer(pocket.tetrahedra.len())?;
        rows.end()
    }

    /// A row for each atom, residue or chain around a pocket.
    fn write_around(&self, number: u32, pocket: &Pocket, rows: &mut TableSink) -> Result<()> {
        for group in self.groups_of(&pocket.balls) {
            self.start_row(number, pocket, rows)?;
            self.end_group(group, rows)?;
        }
        Ok(())
    }

    /// A row for each mouth of a pocket, or for each atom, residue or chain at it.
    fn write_mouths(&self, number: u32, pocket: &Pocket, rows: &mut TableSink) -> Result<()> {
        for (place, mouth) in (1u32..).zip(&pocket.mouths) {
            let start = |rows: &mut TableSink| {
                rows.integer(self.molecule.number)?;
                rows.integer(number)?;
                rows.integer(place)
            };
            if self.level == Level::Molecule {
                start(rows)?;
                rows.number(mouth.area * self.molecule.scale.powi(2));
                rows.integer(mouth.balls.len())?;
                rows.end()?;
                continue;
            }
            for group in self.groups_of(&mouth.balls) {
                start(rows)?;
                self.end_group(group, rows)?;
            }
        }
        Ok(())
    }

    fn groups_of(&self, balls: &[u32]) -> BTreeSet<u32> {
        balls.iter().map(|&ball| self.groups.of(ball)).collect()
    }

    fn end_group(&self, group: u32, rows: &mut TableSink) -> Result<()> {
        rows.field(self.groups.name(group));
        if self.level == Level::Atom {
            rows.integer(self.molecule.selected.label(group as usize))?;
        }
        rows.end()
    }
}
