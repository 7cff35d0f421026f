//! Atoms as balls: exposed areas, volumes and contacts of their cells, as tables.

mod accessibility;
mod burials;
mod groups;
mod parts;
mod pictures;
mod pockets;
mod tables;
mod values;

pub use accessibility::Maxima;
pub use groups::NamedRadii;
pub use parts::Between;
pub use pictures::{ColourBy, PictureForm, PictureOptions};

use std::io::Write;
use std::num::NonZeroUsize;
use std::sync::Arc;

use self::burials::BurialTable;
use self::pictures::Picture;
use self::pockets::PocketTable;
use super::identity::Origin;
use super::{Product, Report};
use crate::balls::{
    Balls, Cell, Cells, PeriodicCells, contacts_between, measure, measure_in_box, molecular_surface, pockets,
};
use crate::cells::SiteFace;
pub(super) use groups::Groups;
use spmesh_base::error::{Error, Result};
use spmesh_delaunay::predicates::Point3;
use spmesh_formats::molecules::{AtomView, Radii, RadiusOrigin, Selected};
use spmesh_formats::sink::TableSink;
use tables::{CellTable, ContactTable};

/// Steps of a radius in 1 Å.
const STEPS: f64 = 1000.0;

/// How atoms become balls, and what is measured of these.
#[derive(Debug, Clone)]
pub struct BallOptions {
    /// Radii of atoms.
    pub radii: Arc<Radii>,
    /// Added to each radius, in steps of 0.001 Å: that of the probe that rolls over the molecule.
    pub probe: u32,
    /// What a row is about.
    pub level: Level,
    /// Whether rows of cells have the area of the surface.
    pub areas: bool,
    /// Whether rows of cells have the volume.
    pub volumes: bool,
    /// Whether areas are also divided into polar and apolar, main chain and side chain.
    pub by_kind: bool,
    /// Whether rows have the derivatives of all areas, and of all volumes, by the place of the atom.
    pub gradients: bool,
    /// With which areas of residues theirs are compared.
    pub relative: Option<Maxima>,
    /// Which contacts have rows.
    pub contacts: ContactFilter,
    /// Rows of pockets are about their mouths.
    pub mouths: bool,
    /// A mesh takes the place of the table.
    pub picture: Option<PictureOptions>,
    /// Radii of heavy atoms include their hydrogens.
    pub has_united_radii: bool,
    /// Threads that measure a structure.
    pub threads: NonZeroUsize,
    /// The flags that asked for all this, for the summary of a sweep.
    pub text: String,
}

/// Which contacts have rows.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ContactFilter {
    /// Least area of a row, in Å².
    pub min_area: f64,
    /// Greatest distance of the centres of two atoms, in Å.
    pub within: Option<f64>,
    /// What must differ between the two atoms.
    pub between: Option<Between>,
}

/// What a row of a table is about.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "flags", derive(clap::ValueEnum))]
pub enum Level {
    /// Each atom.
    #[default]
    Atom,
    /// Each residue.
    Residue,
    /// Each chain.
    Chain,
    /// All atoms together.
    Molecule,
}

impl Level {
    /// Its name, which heads the column of names.
    pub fn name(self) -> &'static str {
        match self {
            Level::Atom => "atom",
            Level::Residue => "residue",
            Level::Chain => "chain",
            Level::Molecule => "molecule",
        }
    }
}

/// Selected atoms as balls.
#[derive(Clone, Copy)]
pub(super) struct Molecule<'s> {
    pub(super) origin: Origin<'s>,
    pub(super) selected: &'s Selected<'s>,
    /// World units per stored unit.
    pub(super) scale: f64,
    /// The vectors of the periodic box that repeats them, if there is one, in stored units.
    pub(super) periodic_box: Option<[Point3; 3]>,
}

impl Molecule<'_> {
    /// Radii of all atoms with the probe, in stored units: integers where coordinates are.
    pub(super) fn radii(&self, options: &BallOptions, report: &mut Report) -> Result<Vec<f64>> {
        let Some(atoms) = options.radii.of_atoms(self.selected) else {
            let message = "points have no elements, and so no radii: give a structure (PDB, mmCIF, XYZ)";
            return Err(Error::usage(message));
        };
        let mut radius = |(atom, steps, origin): (AtomView<'_>, u32, RadiusOrigin)| {
            let is_united = options.has_united_radii && origin == RadiusOrigin::Table;
            report.hydrogens += u64::from(atom.atom.is_hydrogen() && is_united);
            report.radii.add(origin);
            self.length(steps + options.probe)
        };
        atoms.map(|found| found.map(&mut radius)).collect()
    }

    fn radii_of_cells(&self, options: &BallOptions, report: &mut Report) -> Result<Vec<f64>> {
        report.is_of_cells = true;
        report.vertices = report.atoms;
        self.radii(options, report)
    }

    /// Steps of a radius in stored units.
    fn length(&self, steps: u32) -> f64 {
        if self.scale == 1.0 {
            return f64::from(steps) / STEPS;
        }
        // The unit of structures is 0.001 Å or a lesser power of ten, so this is an integer for them.
        f64::from(steps) * (1.0 / (STEPS * self.scale)).round()
    }

    /// The weights of all atoms: squares of their radii, in stored units.
    pub(super) fn weights(&self, options: &BallOptions, report: &mut Report) -> Result<Vec<f64>> {
        Ok(self.radii(options, report)?.into_iter().map(|radius| radius * radius).collect())
    }

    /// Writes a mesh of the surface, of contacts or of pockets. The output is opened at first.
    pub(super) fn draw(
        &self,
        product: Product,
        picture: PictureOptions,
        options: &BallOptions,
        report: &mut Report,
        output: &mut impl Write,
    ) -> Result<()> {
        let radii = self.radii_of_cells(options, report)?;
        let balls = Balls { centres: self.selected.points(), radii: &radii };
        if picture.form.is_of_atoms() {
            if product == Product::Pockets {
                return values::write_spheres(self, options, balls, output);
            }
            let cells = self.cells(product, options, balls)?;
            return values::write(self, options, picture.form, &cells, output);
        }
        report.left_out = Picture { molecule: self, options, picture, balls }.write(product, output)?;
        Ok(())
    }

    /// Measures the balls, and writes the rows of a table: of cells, of the molecular surface, of contacts,
    /// or of pockets. The output is opened when they are measured.
    pub(super) fn write<'o>(
        &self,
        product: Product,
        options: &BallOptions,
        report: &mut Report,
        open: impl FnOnce() -> Result<&'o mut TableSink>,
    ) -> Result<()> {
        let radii = self.radii_of_cells(options, report)?;
        let balls = Balls { centres: self.selected.points(), radii: &radii };
        if product == Product::Pockets {
            let found = pockets(balls)?;
            let groups = Groups::new(self.selected, options.level);
            return PocketTable {
                molecule: self,
                level: options.level,
                mouths: options.mouths,
                groups: &groups,
            }
            .write(&found, open()?);
        }
        if product == Product::BuriedAreas {
            return BurialTable { molecule: self, options }.write(balls, open);
        }
        if product == Product::ContactAreas {
            return self.write_contacts(balls, options, report, open);
        }
        let cells = self.cells(product, options, balls)?;
        report.without_cell = cells.iter().filter(|cell| cell.volume == 0.0).count() as u64;
        let groups = Groups::new(self.selected, options.level);
        CellTable { molecule: self, options, groups: &groups }.write(balls, &cells, open()?)
    }

    /// What is measured of each atom.
    fn cells(&self, product: Product, options: &BallOptions, balls: Balls<'_>) -> Result<Vec<Cell>> {
        if product == Product::Surface {
            molecular_surface(balls, self.length(options.probe), options.threads)
        } else if let Some(vectors) = self.periodic_box {
            Ok(measure_in_box(balls, vectors, None, options.threads)?.cells)
        } else {
            Ok(measure(balls, None, options.threads)?.cells)
        }
    }

    /// Writes contacts: all, or those between parts alone.
    fn write_contacts<'o>(
        &self,
        balls: Balls<'_>,
        options: &BallOptions,
        report: &mut Report,
        open: impl FnOnce() -> Result<&'o mut TableSink>,
    ) -> Result<()> {
        let between = options.contacts.between.as_ref();
        let parts = between.map(|between| between.parts(self.selected)).transpose()?;
        let groups = Groups::new(self.selected, options.level);
        let table = ContactTable { molecule: self, options, groups: &groups };
        let without = |cells: &[Cell]| cells.iter().filter(|cell| cell.volume == 0.0).count() as u64;
        if let Some(vectors) = self.periodic_box {
            let PeriodicCells { cells, contacts } =
                measure_in_box(balls, vectors, Some(0.0), options.threads)?;
            report.without_cell = without(&cells);
            let differ = |face: &SiteFace| {
                let [p, q] = face.sites.map(|ball| ball as usize);
                parts.as_ref().is_none_or(|parts| parts[p] != parts[q])
            };
            return table.write(contacts.into_iter().filter(differ), open()?);
        }
        if let Some(parts) = parts {
            let found = contacts_between(balls, &parts, options.threads)?;
            return table.write(table.faces(found.iter()), open()?);
        }
        let Cells { cells, contacts } = measure(balls, Some(0.0), options.threads)?;
        report.without_cell = without(&cells);
        table.write(table.faces(contacts.iter()), open()?)
    }
}

impl BallOptions {
    /// The line with the names of the columns of a table.
    pub(super) fn columns(&self, product: Product, is_periodic: bool) -> String {
        match product {
            Product::Pockets => self::pockets::columns(self),
            Product::ContactAreas => tables::contact_columns(self, is_periodic),
            Product::BuriedAreas => burials::columns(self),
            _ => tables::cell_columns(self),
        }
    }
}
