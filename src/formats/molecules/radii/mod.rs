//! Van der Waals radii of atoms, from tables of the literature and from files.
//!
//! Radii are exact multiples of 0.001 Å. Those of the tables "protor" and "united" belong to heavy atoms with
//! their hydrogens, so hydrogens are usually left out with them; those of "bondi" and "charmm" belong to
//! single atoms.

mod charmm;
mod file;
mod finder;
mod residues;

use std::collections::HashMap;
use std::io::Read;
use std::path::Path;

pub use finder::RadiusFinder;

use self::charmm::CHARMM;
pub(crate) use self::residues::is_known;
use self::residues::{Group, PROTOR, UNITED, UNITED_ELEMENTS};
use crate::molecules::elements::Element;
use crate::molecules::guess::Labels;
use crate::molecules::model::{AtomView, Structure};
use crate::molecules::selection::Selected;
use spmesh_base::error::{Error, Result};
use spmesh_base::inputs;
use spmesh_base::limits::RADII_LEN_MAX;

/// Number of steps of a radius in 1 Å.
const STEPS: f64 = 1000.0;

/// Stands for any residue or any atom.
const ANY: &str = "*";

/// Van der Waals radii by residue and atom, or by element.
#[derive(Debug, Clone, Default)]
pub struct Radii {
    /// Radii in steps of 0.001 Å, by the names of residue and atom, either of which may be [`ANY`].
    by_name: HashMap<[String; 2], u32>,
    by_element: HashMap<Element, u32>,
    /// Where atoms are looked up that have no radius above.
    fallback: Fallback,
    /// Radius of atoms that have none there either.
    rest: Option<u32>,
    /// Whether radii that a file of atoms states come before these.
    prefers_own: bool,
}

/// Where the radius of an atom is from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RadiusOrigin {
    /// A table, or a line of a file of radii.
    Table,
    /// The file of the atoms.
    Own,
    /// The line `else` of a file of radii.
    Else,
}

/// Radii of atoms that a table does not have.
#[derive(Debug, Clone, Default)]
enum Fallback {
    /// None: such an atom is an error.
    #[default]
    None,
    /// Those of elements.
    Elements,
    /// Those of another table.
    Table(Box<Radii>),
}

/// Counts of atoms whose radii are not those of a table.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct RadiusCounts {
    own: u64,
    rest: u64,
}

impl RadiusCounts {
    /// Counts an atom.
    pub fn add(&mut self, origin: RadiusOrigin) {
        self.own += u64::from(origin == RadiusOrigin::Own);
        self.rest += u64::from(origin == RadiusOrigin::Else);
    }

    /// The counts in sentences.
    pub fn notices(self) -> impl Iterator<Item = String> {
        let own = (self.own > 0).then(|| format!("radii of atoms that the file states: {}", self.own));
        let rest = (self.rest > 0).then(|| format!("atoms with the radius of \"else\": {}", self.rest));
        own.into_iter().chain(rest)
    }
}

/// Radii, and the file that they are from.
#[derive(Debug, Clone)]
pub struct LoadedRadii {
    /// The radii.
    pub radii: Radii,
    /// The content of the file; `None` for a table.
    pub file: Option<Vec<u8>>,
}

impl Radii {
    /// Names of the tables.
    pub const NAMES: [&str; 5] = ["protor", "bondi", "united", "charmm", "own"];

    /// The table of a name:
    ///
    /// * `protor`: by residue and atom for amino acids, nucleotides and water (Tsai, Taylor, Chothia and
    ///   Gerstein 1999); other atoms, and hydrogens, as in `bondi`.
    /// * `bondi`: by element, including hydrogen (Bondi 1964, Mantina and others 2009; metals that neither
    ///   has from Hu, Zhou and Robertson 2009).
    /// * `united`: by residue and atom for amino acids, by element for other heavy atoms (Chothia 1976, as in
    ///   the program NACCESS); other elements, and hydrogens, as in `bondi`.
    /// * `charmm`: by residue and atom, hydrogens too, for amino acids, nucleotides, water and ions (the
    ///   force field CHARMM36m); other atoms as in `bondi`.
    /// * `own`: those that the file of the atoms states, as PQR files do; of other files those of `protor`.
    ///
    /// The radii of `protor` and `united` include those of hydrogens, which are usually left out with them
    /// ([`Atoms::Heavy`](crate::molecules::Atoms::Heavy)).
    pub fn named(name: &str) -> Option<Radii> {
        Some(match name {
            "own" => Radii { prefers_own: true, ..Radii::of_tables(PROTOR, &[]) },
            "protor" => Radii::of_tables(PROTOR, &[]),
            "bondi" => Radii::of_tables(&[], &[]),
            "united" => Radii::of_tables(UNITED, UNITED_ELEMENTS),
            "charmm" => Radii::of_tables(CHARMM, &[]),
            _ => return None,
        })
    }

    fn of_tables(groups: &[Group], elements: &[(&str, u32)]) -> Radii {
        let mut by_name = HashMap::new();
        for group in groups {
            for residue in group.residues() {
                by_name
                    .extend(group.atoms().map(|(atom, radius)| ([residue, atom].map(String::from), radius)));
            }
        }
        let element = |&(symbol, radius): &(&str, u32)| Some((Element::of_symbol(symbol)?, radius));
        let by_element = elements.iter().filter_map(element).collect();
        Radii { by_name, by_element, fallback: Fallback::Elements, ..Radii::default() }
    }

    /// Reads the radii in the file `path`. Each line has one of these forms, with radii in Å; text after `#`
    /// is a comment.
    ///
    /// * `RESIDUE ATOM RADIUS`: of an atom by its name. `*` or `ANY` stands for any residue or any atom.
    ///   `* ATOM` leaves out ions, whose atom has the name of the residue, so that `* CA` is no calcium.
    /// * `ELEMENT RADIUS`: of an element. Deuterium is hydrogen.
    /// * `table NAME`: for all atoms that the file has no radius for, the table of this name.
    /// * `else RADIUS`: for all atoms that have no radius by the other lines, nor by the table.
    ///
    /// Lines may have any order. Where several fit an atom, the first of these counts: residue and atom, the
    /// residue with any atom, the atom of any residue, the element, any atom of any residue. Upper and lower
    /// case are the same.
    ///
    /// # Errors
    /// If the file cannot be read; [`spmesh_base::error::ErrorKind::Malformed`], with file and line, if a
    /// line has another form, a radius has more than three decimal places, is negative or above 100 Å, or two
    /// lines give different radii to the same atoms.
    pub fn read(path: &Path) -> Result<Radii> {
        let name = path.display().to_string();
        let input = inputs::open(path).map_err(|e| e.of_input(&name))?;
        Radii::read_from(input, &name)
    }

    /// As [`Radii::read`], from any reader. Messages call the input `name`.
    ///
    /// # Errors
    /// As [`Radii::read`].
    pub fn read_from(input: impl Read, name: &str) -> Result<Radii> {
        file::read(input).map_err(|e| e.of_input(name))
    }

    /// The table of this name, or the radii in the file of this name, which is read once.
    ///
    /// # Errors
    /// Usage, if it is neither; those of [`Radii::read`].
    pub fn load(name: &str) -> Result<LoadedRadii> {
        if let Some(radii) = Radii::named(name) {
            return Ok(LoadedRadii { radii, file: None });
        }
        let input = inputs::open(Path::new(name)).map_err(|e| {
            let tables = Radii::NAMES.join(", ");
            Error::usage(format!("--radii {name}: {e}; expected a file of radii, or one of {tables}"))
        })?;
        let content = inputs::content(input, RADII_LEN_MAX).map_err(|e| e.of_input(name))?;
        let content = content.ok_or_else(|| {
            let message = format!("more than {} MB: this is no file of radii", RADII_LEN_MAX >> 20);
            Error::malformed(message).of_input(name)
        })?;
        let radii = Radii::read_from(&content[..], name)?;
        Ok(LoadedRadii { radii, file: Some(content) })
    }

    /// Finds the radii of the atoms of `structure`.
    pub fn finder<'s>(&'s self, structure: &'s Structure) -> RadiusFinder<'s> {
        RadiusFinder::new(self, structure)
    }

    /// The selected atoms, each with its radius in steps of 0.001 Å and where that is from; `None` if they
    /// are points without names.
    ///
    /// An item is an error as [`RadiusFinder::steps_of`].
    pub fn of_atoms<'s>(
        &'s self,
        selected: &'s Selected<'s>,
    ) -> Option<impl Iterator<Item = Result<(AtomView<'s>, u32, RadiusOrigin)>>> {
        let mut finder = self.finder(selected.atom(0)?.structure);
        let atoms = (0..selected.points().len()).filter_map(|index| selected.atom(index));
        Some(atoms.map(move |atom| finder.find(&atom).map(|(steps, origin)| (atom, steps, origin))))
    }

    /// The radius of an atom, in steps of 0.001 Å.
    fn find(&self, labels: &Labels, element: Option<Element>) -> Option<u32> {
        let named = |residue: &str, atom: &str| self.by_name.get(&[residue, atom].map(String::from)).copied();
        let of_element = || element.and_then(|element| self.by_element.get(&element).copied());
        let Labels { residue, atom, .. } = *labels;
        named(residue, atom)
            .or_else(|| named(residue, ANY))
            .or_else(|| if labels.is_single() { None } else { named(ANY, atom) })
            .or_else(of_element)
            .or_else(|| named(ANY, ANY))
            .or_else(|| match &self.fallback {
                Fallback::None => None,
                Fallback::Elements => element?.radius(),
                Fallback::Table(table) => table.find(labels, element),
            })
    }
}
