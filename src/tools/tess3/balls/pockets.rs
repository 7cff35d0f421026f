//! Rows of pockets and voids, and of what is around them.

use std::collections::BTreeSet;

use super::groups::Groups;
use super::{BallOptions, Level, Molecule};
use spmesh_core::error::Result;
use spmesh_geometry::balls::Pocket;
use spmesh_io::sink::TableSink;

pub(super) fn columns(options: &BallOptions) -> String {
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
    pub(super) groups: &'t Groups,
}

impl PocketTable<'_> {
    /// Pockets are numbered from 1, the largest first.
    pub(super) fn write(&self, pockets: &[Pocket], rows: &mut TableSink) -> Result<()> {
        for (number, pocket) in (1..).zip(pockets) {
            if self.level == Level::Molecule {
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
        rows.field(if pocket.mouths == 0 { "void" } else { "pocket" });
        Ok(())
    }

    fn end_pocket(&self, pocket: &Pocket, rows: &mut TableSink) -> Result<()> {
        let scale = self.molecule.scale;
        rows.number(pocket.volume * scale.powi(3))?;
        rows.number(pocket.area * scale.powi(2))?;
        rows.integer(pocket.mouths)?;
        rows.number(pocket.mouth_area * scale.powi(2))?;
        rows.number(pocket.depth * scale)?;
        rows.integer(pocket.balls.len())?;
        rows.integer(pocket.tetrahedra)?;
        rows.end()
    }

    /// A row for each atom, residue or chain around a pocket.
    fn write_around(&self, number: u32, pocket: &Pocket, rows: &mut TableSink) -> Result<()> {
        let groups: BTreeSet<u32> = pocket.balls.iter().map(|&ball| self.groups.of(ball)).collect();
        for group in groups {
            self.start_row(number, pocket, rows)?;
            rows.field(self.groups.name(group));
            if self.level == Level::Atom {
                rows.integer(self.molecule.selected.label(group as usize))?;
            }
            rows.end()?;
        }
        Ok(())
    }
}
