//! Rows of pockets and voids, and of what is around them.

use std::collections::BTreeSet;
use std::io::Write;

use super::groups::Groups;
use super::{BallOptions, Level, Molecule};
use crate::rows::Rows;
use spmesh_core::error::Result;
use spmesh_geometry::balls::Pocket;

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
    pub(super) fn write(&self, pockets: &[Pocket], output: &mut impl Write) -> Result<()> {
        let mut rows = Rows::new(output);
        for (number, pocket) in (1..).zip(pockets) {
            if self.level == Level::Molecule {
                self.start_row(number, pocket, &mut rows)?;
                self.end_pocket(pocket, &mut rows)?;
            } else {
                self.write_around(number, pocket, &mut rows)?;
            }
        }
        rows.finish()
    }

    fn start_row<W: Write>(&self, number: u32, pocket: &Pocket, rows: &mut Rows<'_, W>) -> Result<()> {
        rows.start(self.molecule.number)?;
        rows.integer(number)?;
        rows.field(if pocket.mouths.is_empty() { "void" } else { "pocket" });
        Ok(())
    }

    fn end_pocket<W: Write>(&self, pocket: &Pocket, rows: &mut Rows<'_, W>) -> Result<()> {
        let scale = self.molecule.scale;
        rows.number(pocket.volume * scale.powi(3))?;
        rows.number(pocket.area * scale.powi(2))?;
        rows.integer(pocket.mouths.len())?;
        rows.number(pocket.mouth_area() * scale.powi(2))?;
        rows.number(pocket.depth * scale)?;
        rows.integer(pocket.balls.len())?;
        rows.integer(pocket.tetrahedra.len())?;
        rows.end()
    }

    /// A row for each atom, residue or chain around a pocket.
    fn write_around<W: Write>(&self, number: u32, pocket: &Pocket, rows: &mut Rows<'_, W>) -> Result<()> {
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
