//! Rows of pockets and voids, and of what is around them.

use std::collections::BTreeSet;

use super::groups::Groups;
use super::{BallOptions, Level, Molecule};
use crate::balls::Pocket;
use spmesh_base::error::Result;
use spmesh_formats::sink::TableSink;

pub(super) fn columns(options: &BallOptions) -> String {
    if options.mouths {
        return match options.level {
            Level::Molecule => "model\tpocket\tmouth\tarea\tatoms\n".to_string(),
            Level::Atom => "model\tpocket\tmouth\tatom\tserial\n".to_string(),
            level => format!("model\tpocket\tmouth\t{}\n", level.name()),
        };
    }
    match options.level {
        Level::Molecule => {
            "model\tpocket\tkind\tvolume\tarea\tmouths\tmouth_area\tdepth\tatoms\ttetrahedra\n".to_string()
        }
        Level::Atom => "model\tpocket\tkind\tatom\tserial\n".to_string(),
        level => format!("model\tpocket\tkind\t{}\n", level.name()),
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
