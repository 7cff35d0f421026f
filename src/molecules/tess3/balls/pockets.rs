//! Rows of pockets and voids, and of what is around them.

use std::collections::BTreeSet;

use super::groups::Groups;
use super::{BallOptions, Level, Molecule};
use crate::balls::Pocket;
use crate::tess3::identity::{self, Origin};
use spmesh_base::error::Result;
use spmesh_formats::sink::TableSink;

pub(super) fn columns(options: &BallOptions) -> String {
    let start = format!("{} pocket {}", Origin::COLUMNS, if options.mouths { "mouth" } else { "kind" });
    match (options.mouths, options.level) {
        (true, Level::Molecule) => format!("{start} area atoms"),
        (false, Level::Molecule) => format!("{start} volume area mouths mouth_area depth atoms tetrahedra"),
        (_, level) => format!("{start} {}", identity::columns(level, "", "").join(" ")),
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
        self.molecule.origin.start_row(rows)?;
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
                self.molecule.origin.start_row(rows)?;
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
        self.groups.named(group).write(self.molecule.selected, self.level, self.level, rows)?;
        rows.end()
    }
}
