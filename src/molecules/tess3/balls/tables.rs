//! Rows of cells and of contacts.

use std::collections::BTreeMap;

use super::groups::{Groups, Key, key};
use super::{BallOptions, ContactFilter, Level, Molecule};
use crate::balls::{Cell, Contact, Contacts};
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

pub(super) fn contact_columns(options: &BallOptions) -> String {
    let name = options.level.name();
    let rest = if options.level == Level::Atom { "serial1 serial2 distance area" } else { "contacts area" };
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
    pub(super) fn write(&self, contacts: &Contacts, rows: &mut TableSink) -> Result<()> {
        let wanted =
            contacts.iter().filter(|contact| is_wanted(self.molecule, &self.options.contacts, contact));
        if self.options.level == Level::Atom {
            for contact in wanted.filter(|contact| self.area(contact) >= self.options.contacts.min_area) {
                self.row_of_atoms(contact, rows)?;
            }
            return Ok(());
        }
        let mut sums: BTreeMap<[u32; 2], (u64, f64)> = BTreeMap::new();
        for contact in wanted {
            let mut pair = contact.balls.map(|ball| self.groups.of(ball));
            pair.sort_unstable();
            if pair[0] != pair[1] {
                let (count, area) = sums.entry(pair).or_default();
                *count += 1;
                *area += self.area(contact);
            }
        }
        for (pair, (count, area)) in sums {
            if area >= self.options.contacts.min_area {
                self.start_row(pair, rows)?;
                rows.integer(count)?;
                rows.number(area);
                rows.end()?;
            }
        }
        Ok(())
    }

    fn area(&self, contact: &Contact) -> f64 {
        contact.area * self.molecule.scale.powi(2)
    }

    /// Distance of the centres, in Å.
    fn distance(&self, contact: &Contact) -> f64 {
        distance_of(self.molecule, contact)
    }

    fn row_of_atoms(&self, contact: &Contact, rows: &mut TableSink) -> Result<()> {
        self.start_row(contact.balls, rows)?;
        for ball in contact.balls {
            rows.integer(self.molecule.selected.label(ball as usize))?;
        }
        rows.number(self.distance(contact));
        rows.number(self.area(contact));
        rows.end()
    }

    fn start_row(&self, pair: [u32; 2], rows: &mut TableSink) -> Result<()> {
        rows.integer(self.molecule.number)?;
        pair.iter().for_each(|&group| rows.field(self.groups.name(group)));
        Ok(())
    }
}

/// Whether a contact passes a filter, up to its area.
pub(super) fn is_wanted(molecule: &Molecule<'_>, filter: &ContactFilter, contact: &Contact) -> bool {
    let differ = |level| {
        let [p, q]: [Option<Key>; 2] =
            contact.balls.map(|ball| Some(key(&molecule.selected.atom(ball as usize)?, level)));
        p != q
    };
    filter.within.is_none_or(|most| distance_of(molecule, contact) <= most)
        && filter.between.is_none_or(differ)
}

/// Distance of the centres of two atoms, in Å.
fn distance_of(molecule: &Molecule<'_>, contact: &Contact) -> f64 {
    distance(contact.balls.map(|ball| molecule.selected.points()[ball as usize])) * molecule.scale
}
