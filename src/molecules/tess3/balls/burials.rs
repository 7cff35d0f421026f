//! Rows of areas that parts of a molecule bury.

use std::collections::BTreeMap;

use super::groups::Groups;
use super::parts::Between;
use super::{BallOptions, Level, Molecule};
use crate::balls::{Balls, Burial, buried};
use crate::tess3::identity;
use crate::tess3::identity::Origin;
use spmesh_base::error::Result;
use spmesh_formats::molecules::Class;
use spmesh_formats::sink::TableSink;

/// The level of the columns that identify a part.
fn level_of_parts(between: &Between) -> Level {
    match between {
        Between::Chains => Level::Chain,
        Between::Classes | Between::Residues => Level::Residue,
        Between::Listed(_) => Level::Molecule,
    }
}

/// Between what areas are buried: chains by default.
fn between(options: &BallOptions) -> &Between {
    options.contacts.between.as_ref().unwrap_or(&Between::Chains)
}

pub(super) fn columns(options: &BallOptions) -> String {
    let parts = level_of_parts(between(options));
    let mut columns = vec![Origin::COLUMNS.to_string()];
    if is_of_pairs(options) {
        ["1", "2"].iter().for_each(|end| columns.extend(identity::columns(parts, "", end)));
        columns.push("atoms1 atoms2 buried1 buried2 buried".into());
    } else {
        columns.extend(identity::columns(options.level, "", ""));
        columns.extend((options.level != Level::Atom).then(|| "atoms".into()));
        columns.push("buried".into());
        columns.extend(identity::columns(parts, "partner_", ""));
    }
    columns.join(" ")
}

/// A row is about two parts, not about an atom or a residue of one.
fn is_of_pairs(options: &BallOptions) -> bool {
    !matches!(options.level, Level::Atom | Level::Residue)
}

/// The table of what parts bury.
pub(super) struct BurialTable<'t> {
    pub(super) molecule: &'t Molecule<'t>,
    pub(super) options: &'t BallOptions,
}

impl BurialTable<'_> {
    /// Measures balls, and writes the rows.
    pub(super) fn write<'o>(
        &self,
        balls: Balls<'_>,
        open: impl FnOnce() -> Result<&'o mut TableSink>,
    ) -> Result<()> {
        let selected = self.molecule.selected;
        let between = between(self.options);
        let units = between.units(selected)?;
        let class =
            |unit: u32| selected.atom(units.named(unit).atom as usize).map(|atom| atom.residue().class);
        let wanted = |[p, q]: [u32; 2]| !matches!(between, Between::Classes) || class(p) != class(q);
        let found = buried(balls, &units.of_atoms, wanted, self.options.threads)?;
        let groups = Groups::new(selected, self.options.level);
        let rows = open()?;
        for burial in &found {
            if is_of_pairs(self.options) {
                self.pair(burial, &units, rows)?;
            } else {
                [0, 1].iter().try_for_each(|&side| self.side(burial, side, &units, &groups, rows))?;
            }
        }
        Ok(())
    }

    /// A row of two parts.
    fn pair(&self, burial: &Burial, units: &Groups, rows: &mut TableSink) -> Result<()> {
        let areas = burial.areas().map(|area| self.area(area));
        let mean = 0.5 * (areas[0] + areas[1]);
        if mean < self.options.contacts.min_area {
            return Ok(());
        }
        self.molecule.origin.start_row(rows)?;
        burial.parts.iter().try_for_each(|&unit| self.unit(unit, units, rows))?;
        burial.lost.iter().try_for_each(|lost| rows.integer(lost.len()))?;
        areas.iter().for_each(|&area| rows.number(area));
        rows.number(mean);
        rows.end()
    }

    /// The rows of atoms or residues of one part, with the other part.
    fn side(
        &self,
        burial: &Burial,
        side: usize,
        units: &Groups,
        groups: &Groups,
        rows: &mut TableSink,
    ) -> Result<()> {
        let mut sums: BTreeMap<u32, (u32, f64)> = BTreeMap::new();
        for &(atom, area) in burial.lost[side].iter().filter(|&&(_, area)| area > 0.0) {
            let (atoms, sum) = sums.entry(groups.of(atom)).or_default();
            *atoms += 1;
            *sum += self.area(area);
        }
        let level = self.options.level;
        for (group, (atoms, area)) in sums {
            if area < self.options.contacts.min_area {
                continue;
            }
            self.molecule.origin.start_row(rows)?;
            groups.named(group).write(self.molecule.selected, level, level, rows)?;
            if level != Level::Atom {
                rows.integer(atoms)?;
            }
            rows.number(area);
            self.unit(burial.parts[1 - side], units, rows)?;
            rows.end()?;
        }
        Ok(())
    }

    /// The columns of a part: of a chain of polymers those of the chain.
    fn unit(&self, unit: u32, units: &Groups, rows: &mut TableSink) -> Result<()> {
        let selected = self.molecule.selected;
        let between = between(self.options);
        let level = level_of_parts(between);
        let named = units.named(unit);
        let is_chain = matches!(between, Between::Classes)
            && selected.atom(named.atom as usize).is_some_and(|atom| atom.residue().class == Class::Polymer);
        named.write(selected, level, if is_chain { Level::Chain } else { level }, rows)
    }

    fn area(&self, area: f64) -> f64 {
        area * self.molecule.scale.powi(2)
    }
}
