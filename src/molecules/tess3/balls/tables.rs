//! Rows of cells and of contacts.

use std::collections::BTreeMap;

use super::accessibility::{KINDS, kinds};
use super::groups::Groups;
use super::{BallOptions, Level, Molecule};
use crate::balls::{Balls, Cell, Contact, Gradient, gradients};
use crate::cells::SiteFace;
use crate::tess3::identity::{self, Origin};
use crate::tess3::tables::{distance, pair_columns};
use spmesh_base::error::Result;
use spmesh_formats::sink::TableSink;

pub(super) fn cell_columns(options: &BallOptions) -> String {
    let mut columns = vec![Origin::COLUMNS.to_string()];
    columns.extend(identity::columns(options.level, "", ""));
    columns.extend((options.level != Level::Atom).then(|| "atoms".to_string()));
    columns.extend(options.areas.then(|| "area".to_string()));
    columns.extend(KINDS.into_iter().filter(|_| options.by_kind).map(str::to_string));
    columns.extend(options.relative.map(|_| "relative".to_string()));
    columns.extend(options.volumes.then(|| "volume".to_string()));
    let parts = [(options.areas, "area"), (options.volumes, "volume")];
    for (_, name) in parts.into_iter().filter(|(is_given, _)| options.gradients && *is_given) {
        columns.extend(["dx", "dy", "dz"].map(|by| format!("{name}_{by}")));
    }
    columns.join(" ")
}

pub(super) fn contact_columns(options: &BallOptions, is_periodic: bool) -> String {
    let rest = match (options.level, is_periodic) {
        (Level::Atom, false) => "distance area",
        (Level::Atom, true) => "shift_a shift_b shift_c distance area",
        _ => "contacts area",
    };
    format!("{} {} {rest}", Origin::COLUMNS, pair_columns(options.level))
}

/// What a row of cells sums.
#[derive(Clone, Copy, Default)]
struct Sum {
    atoms: u32,
    cell: Cell,
    /// Areas of atoms by their kinds.
    kinds: [f64; KINDS.len()],
}

impl Sum {
    fn add(&mut self, cell: &Cell, kinds: &[bool; KINDS.len()]) {
        self.atoms += 1;
        self.cell.area += cell.area;
        self.cell.volume += cell.volume;
        for (sum, &is_kind) in self.kinds.iter_mut().zip(kinds) {
            *sum += if is_kind { cell.area } else { 0.0 };
        }
    }
}

pub(super) struct CellTable<'t> {
    pub(super) molecule: &'t Molecule<'t>,
    pub(super) options: &'t BallOptions,
    pub(super) groups: &'t Groups,
}

impl CellTable<'_> {
    pub(super) fn write(&self, balls: Balls<'_>, cells: &[Cell], rows: &mut TableSink) -> Result<()> {
        let kinds = if self.options.by_kind { kinds(self.molecule) } else { Vec::new() };
        let kind = |atom: u32| kinds.get(atom as usize).copied().unwrap_or_default();
        let count = if self.options.level == Level::Atom { cells.len() } else { self.groups.sizes.len() };
        let found = if self.options.gradients { gradients(balls, self.options.threads)? } else { Vec::new() };
        let mut sums = vec![Sum::default(); count];
        for (atom, cell) in (0..).zip(cells) {
            sums[self.groups.of(atom) as usize].add(cell, &kind(atom));
        }
        (0..).zip(&sums).try_for_each(|(group, sum)| {
            self.row(group, sum, rows)?;
            self.gradient(found.get(group as usize), rows);
            rows.end()
        })
    }

    fn row(&self, group: u32, sum: &Sum, rows: &mut TableSink) -> Result<()> {
        let Molecule { origin, selected, scale, .. } = *self.molecule;
        let (level, square) = (self.options.level, scale.powi(2));
        origin.start_row(rows)?;
        let named = self.groups.named(group);
        named.write(selected, level, level, rows)?;
        if level != Level::Atom {
            rows.integer(sum.atoms)?;
        }
        if self.options.areas {
            rows.number(sum.cell.area * square);
        }
        if self.options.by_kind {
            sum.kinds.iter().for_each(|area| rows.number(area * square));
        }
        if let Some(maxima) = self.options.relative {
            let residue = selected.atom(named.atom as usize).map_or("", |atom| atom.residue_name());
            match maxima.of(residue) {
                Some(most) => rows.number(sum.cell.area * square / most),
                None => rows.nothing(),
            }
        }
        if self.options.volumes {
            rows.number(sum.cell.volume * scale.powi(3));
        }
        Ok(())
    }

    /// The derivatives at an atom, if they are wanted.
    fn gradient(&self, gradient: Option<&Gradient>, rows: &mut TableSink) {
        let Some(Gradient { area, volume }) = gradient else { return };
        let scale = self.molecule.scale;
        let wanted = [(self.options.areas, area, scale), (self.options.volumes, volume, scale.powi(2))];
        for (_, by, scale) in wanted.into_iter().filter(|(is_wanted, ..)| *is_wanted) {
            by.iter().for_each(|c| rows.number(c * scale));
        }
    }
}

pub(super) struct ContactTable<'t> {
    pub(super) molecule: &'t Molecule<'t>,
    pub(super) options: &'t BallOptions,
    pub(super) groups: &'t Groups,
}

impl ContactTable<'_> {
    /// Contacts without a box as faces.
    pub(super) fn faces<'c>(
        &self,
        contacts: impl Iterator<Item = &'c Contact>,
    ) -> impl Iterator<Item = SiteFace> {
        contacts.map(|contact| SiteFace {
            sites: contact.balls,
            shift: [0; 3],
            distance: distance_of(self.molecule, contact.balls),
            area: contact.area,
        })
    }

    /// Writes those of the faces that are within the greatest distance and have the least area.
    pub(super) fn write(&self, faces: impl Iterator<Item = SiteFace>, rows: &mut TableSink) -> Result<()> {
        let filter = &self.options.contacts;
        let mut sums: BTreeMap<[u32; 2], (u64, f64)> = BTreeMap::new();
        for face in faces {
            let area = face.area * self.molecule.scale.powi(2);
            let distance = face.distance * self.molecule.scale;
            if filter.within.is_some_and(|most| distance > most) {
                continue;
            }
            if self.options.level == Level::Atom {
                if area >= filter.min_area {
                    self.row_of_atoms(&face, [distance, area], rows)?;
                }
                continue;
            }
            let mut pair = face.sites.map(|ball| self.groups.of(ball));
            pair.sort_unstable();
            if pair[0] != pair[1] {
                let (count, sum) = sums.entry(pair).or_default();
                *count += 1;
                *sum += area;
            }
        }
        for (pair, (count, area)) in sums {
            if area >= filter.min_area {
                self.start_row(pair, rows)?;
                rows.integer(count)?;
                rows.number(area);
                rows.end()?;
            }
        }
        Ok(())
    }

    fn row_of_atoms(&self, face: &SiteFace, numbers: [f64; 2], rows: &mut TableSink) -> Result<()> {
        self.start_row(face.sites, rows)?;
        if self.molecule.periodic_box.is_some() {
            face.shift.iter().try_for_each(|&boxes| rows.integer(boxes))?;
        }
        numbers.iter().for_each(|&number| rows.number(number));
        rows.end()
    }

    fn start_row(&self, pair: [u32; 2], rows: &mut TableSink) -> Result<()> {
        self.molecule.origin.start_row(rows)?;
        let level = self.options.level;
        pair.iter()
            .try_for_each(|&group| self.groups.named(group).write(self.molecule.selected, level, level, rows))
    }
}

/// Distance of the centres of two atoms, in stored units.
pub(super) fn distance_of(molecule: &Molecule<'_>, atoms: [u32; 2]) -> f64 {
    distance(atoms.map(|atom| molecule.selected.points()[atom as usize]))
}
