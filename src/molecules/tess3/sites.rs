//! Tables of Voronoi and Laguerre cells and their faces.

use super::balls::{Groups, Molecule};
use super::identity::{self, Named, Origin};
use super::tables::pair_columns;
use super::{Level, Product, Report};
use crate::cells::{SiteCell, SiteFace, Sites, State, cells};
use spmesh_base::error::Result;
use spmesh_formats::sink::TableSink;
use std::num::NonZeroUsize;

/// The line with the names of the columns of cells at a level, or of faces.
pub(super) fn columns(product: Product, has_radii: bool, is_periodic: bool) -> String {
    let level = match product {
        Product::SiteCells(level) => level,
        _ => Level::Atom,
    };
    let names = match (product, level) {
        (Product::SiteFaces, _) => pair_columns(level),
        _ => identity::columns(level, "", "").join(" "),
    };
    let values = match (product, level) {
        (Product::SiteFaces, _) if is_periodic => "shift_a shift_b shift_c distance face area",
        (Product::SiteFaces, _) => "distance face area",
        (_, Level::Atom) if has_radii => "cell volume area faces",
        (_, Level::Atom) => "cell volume area faces density",
        _ => "atoms cell volume",
    };
    [Origin::COLUMNS, &names, values]
        .into_iter()
        .filter(|part| !part.is_empty())
        .collect::<Vec<_>>()
        .join(" ")
}

/// Measures the cells of atoms, of these radii unless there are none, and writes the rows of a table, which
/// is opened when they are measured.
pub(super) fn write<'o>(
    product: Product,
    molecule: &Molecule<'_>,
    radii: &[f64],
    threads: NonZeroUsize,
    report: &mut Report,
    open: impl FnOnce() -> Result<&'o mut TableSink>,
) -> Result<()> {
    let sites = Sites { points: molecule.selected.points(), radii, periodic_box: molecule.periodic_box };
    let found = cells(sites, product == Product::SiteFaces, threads)?;
    let count = |state: State| found.cells.iter().filter(|cell| cell.state == state).count() as u64;
    report.vertices = report.atoms - count(State::Duplicate);
    report.without_cell = count(State::Empty);
    report.unbounded = count(State::Unbounded);
    report.flat = count(State::Flat);
    let table = SiteTable { molecule, has_radii: !radii.is_empty() };
    match product {
        Product::SiteFaces => table.write_faces(&found.faces, open()?),
        Product::SiteCells(level @ (Level::Residue | Level::Chain | Level::Molecule)) => {
            table.write_sums(&found.cells, level, open()?)
        }
        _ => table.write_cells(&found.cells, open()?),
    }
}

struct SiteTable<'t> {
    molecule: &'t Molecule<'t>,
    has_radii: bool,
}

impl SiteTable<'_> {
    fn start_row(&self, named: &[Named], level: Level, rows: &mut TableSink) -> Result<()> {
        self.molecule.origin.start_row(rows)?;
        named.iter().try_for_each(|named| named.write(self.molecule.selected, level, level, rows))
    }

    fn write_cells(&self, cells: &[SiteCell], rows: &mut TableSink) -> Result<()> {
        for (atom, cell) in (0..).zip(cells) {
            self.start_row(&[Named::atom(atom)], Level::Atom, rows)?;
            rows.field(cell.state.name());
            self.volume(cell.state, cell.volume, rows);
            if is_known(cell.state) {
                rows.number(cell.area * self.molecule.scale.powi(2));
            } else {
                rows.nothing();
            }
            if cell.state == State::Flat {
                rows.nothing();
            } else {
                rows.integer(cell.faces)?;
            }
            if !self.has_radii {
                match cell.density() {
                    Some(density) => rows.number(density / self.molecule.scale.powi(3)),
                    None => rows.nothing(),
                }
            }
            rows.end()?;
        }
        Ok(())
    }

    /// Rows of the cells of groups together.
    fn write_sums(&self, cells: &[SiteCell], level: Level, rows: &mut TableSink) -> Result<()> {
        let groups = Groups::new(self.molecule.selected, level);
        let mut sums = vec![(State::Bounded, 0.0); groups.sizes.len()];
        for (atom, cell) in (0..).zip(cells) {
            let (state, volume) = &mut sums[groups.of(atom) as usize];
            *volume += cell.volume;
            if !is_known(cell.state) {
                *state = cell.state;
            }
        }
        for ((group, (state, volume)), &atoms) in (0..).zip(sums).zip(&groups.sizes) {
            self.start_row(&[groups.named(group)], level, rows)?;
            rows.integer(atoms)?;
            rows.field(state.name());
            self.volume(state, volume, rows);
            rows.end()?;
        }
        Ok(())
    }

    fn volume(&self, state: State, volume: f64, rows: &mut TableSink) {
        if is_known(state) {
            rows.number(volume * self.molecule.scale.powi(3));
        } else {
            rows.nothing();
        }
    }

    fn write_faces(&self, faces: &[SiteFace], rows: &mut TableSink) -> Result<()> {
        for face in faces {
            self.start_row(&face.sites.map(Named::atom), Level::Atom, rows)?;
            if self.molecule.periodic_box.is_some() {
                face.shift.iter().try_for_each(|&boxes| rows.integer(boxes))?;
            }
            rows.number(face.distance * self.molecule.scale);
            if face.area.is_finite() {
                rows.field(State::Bounded.name());
                rows.number(face.area * self.molecule.scale.powi(2));
            } else {
                rows.field(State::Unbounded.name());
                rows.nothing();
            }
            rows.end()?;
        }
        Ok(())
    }
}

/// Whether the volume of a cell is a number.
fn is_known(state: State) -> bool {
    !matches!(state, State::Unbounded | State::Flat)
}
