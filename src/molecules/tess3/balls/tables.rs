//! Rows of cells and of contacts.

use std::collections::BTreeMap;

use super::groups::{Groups, Key, key};
use super::{BallOptions, ContactFilter, Level, Molecule};
use crate::balls::{Cell, Contacts};
use crate::cells::SiteFace;
use crate::tess3::tables::distance;
use spmesh_base::error::Result;
use spmesh_formats::sink::TableSink;

pub(super) fn cell_columns(options: &BallOptions) -> String {
    let mut columns = vec!["model", options.level.name()];
    columns.push(if options.level == Level::Atom { "serial" } else { "atoms" });
    columns.extend(options.areas.then_some("area"));
    columns.extend(options.volumes.then_some("volume"));
    columns.join(" ")
}

pub(super) fn contact_columns(options: &BallOptions, is_periodic: bool) -> String {
    let name = options.level.name();
    let rest = match (options.level, is_periodic) {
        (Level::Atom, false) => "serial1 serial2 distance area",
        (Level::Atom, true) => "serial1 serial2 shift_a shift_b shift_c distance area",
        _ => "contacts area",
    };
    format!("model {name}1 {name}2 {rest}")
}

pub(super) struct CellTable<'t> {
    pub(super) molecule: &'t Molecule<'t>,
    pub(super) options: &'t BallOptions,
    pub(super) groups: &'t Groups,
}

impl CellTable<'_> {
    pub(super) fn write(&self, cells: &[Cell], rows: &mut TableSink) -> Result<()> {
        if self.options.level == Level::Atom {
            for (atom, cell) in (0..).zip(cells) {
                let serial = self.molecule.selected.label(atom as usize);
                self.row(atom, serial, cell, rows)?;
            }
            return Ok(());
        }
        let mut sums = vec![Cell::default(); self.groups.sizes.len()];
        for (atom, cell) in (0..).zip(cells) {
            let sum = &mut sums[self.groups.of(atom) as usize];
            sum.area += cell.area;
            sum.volume += cell.volume;
        }
        for ((group, sum), &atoms) in (0..).zip(&sums).zip(&self.groups.sizes) {
            self.row(group, u64::from(atoms), sum, rows)?;
        }
        Ok(())
    }

    fn row(&self, group: u32, count: u64, cell: &Cell, rows: &mut TableSink) -> Result<()> {
        rows.integer(self.molecule.number)?;
        rows.field(self.groups.name(group));
        rows.integer(count)?;
        let scale = self.molecule.scale;
        if self.options.areas {
            rows.number(cell.area * scale.powi(2));
        }
        if self.options.volumes {
            rows.number(cell.volume * scale.powi(3));
        }
        rows.end()
    }
}

pub(super) struct ContactTable<'t> {
    pub(super) molecule: &'t Molecule<'t>,
    pub(super) options: &'t BallOptions,
    pub(super) groups: &'t Groups,
}

impl ContactTable<'_> {
    /// Contacts without a box as faces.
    pub(super) fn faces(&self, contacts: &Contacts) -> impl Iterator<Item = SiteFace> {
        contacts.iter().map(|contact| SiteFace {
            sites: contact.balls,
            shift: [0; 3],
            distance: distance_of(self.molecule, contact.balls),
            area: contact.area,
        })
    }

    pub(super) fn write(&self, faces: impl Iterator<Item = SiteFace>, rows: &mut TableSink) -> Result<()> {
        let filter = &self.options.contacts;
        let mut sums: BTreeMap<[u32; 2], (u64, f64)> = BTreeMap::new();
        for face in faces {
            let area = face.area * self.molecule.scale.powi(2);
            let distance = face.distance * self.molecule.scale;
            if !is_wanted(self.molecule, filter, face.sites, distance) {
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
        for ball in face.sites {
            rows.integer(self.molecule.selected.label(ball as usize))?;
        }
        if self.molecule.periodic_box.is_some() {
            face.shift.iter().try_for_each(|&boxes| rows.integer(boxes))?;
        }
        numbers.iter().for_each(|&number| rows.number(number));
        rows.end()
    }

    fn start_row(&self, pair: [u32; 2], rows: &mut TableSink) -> Result<()> {
        rows.integer(self.molecule.number)?;
        pair.iter().for_each(|&group| rows.field(self.groups.name(group)));
        Ok(())
    }
}

/// Whether a contact of two atoms at a distance in Å passes a filter, up to its area.
pub(super) fn is_wanted(
    molecule: &Molecule<'_>,
    filter: &ContactFilter,
    atoms: [u32; 2],
    distance: f64,
) -> bool {
    let differ = |level| {
        let [p, q]: [Option<Key>; 2] =
            atoms.map(|atom| Some(key(&molecule.selected.atom(atom as usize)?, level)));
        p != q
    };
    filter.within.is_none_or(|most| distance <= most) && filter.between.is_none_or(differ)
}

/// Distance of the centres of two atoms, in stored units.
pub(super) fn distance_of(molecule: &Molecule<'_>, atoms: [u32; 2]) -> f64 {
    distance(atoms.map(|atom| molecule.selected.points()[atom as usize]))
}
