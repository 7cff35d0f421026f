//! Molecular structures in memory: models of atoms, compact enough for millions of them.

use super::names::{Name, Names};
use spmesh_model::points::Point3;
use spmesh_stream::Coordinates;

/// A molecular structure, or points without names.
#[derive(Debug, Clone)]
pub struct Structure {
    /// What messages call it: the path of the file, or "stdin".
    pub name: String,
    /// How the points of all models are stored: integers in units of 0.001 Å (or of a smaller power of ten
    /// that all coordinates of the input are multiples of) in 32 bits, or else the numbers themselves.
    pub coordinates: Coordinates,
    /// The models that have atoms, one or more, in the order of the file; a file that names none has one of
    /// number 1.
    pub models: Vec<Model>,
    /// The residues that atoms refer to.
    pub residues: Vec<Residue>,
    /// The texts that residues and atoms refer to.
    pub names: Names,
    /// What is odd in the input, as sentences.
    pub warnings: Vec<String>,
}

/// One model: the same molecule again in ensembles, something else in other files.
#[derive(Debug, Clone, Default)]
pub struct Model {
    /// Number that the file gives it.
    pub number: i64,
    /// Where the atoms are, in stored coordinates; all finite.
    pub points: Vec<Point3>,
    /// The atoms, as many as points; none if the input has points without names.
    pub atoms: Vec<Atom>,
}

/// What is known of an atom but its place, which is the point of the same index: 32 bytes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Atom {
    /// Serial number; where the file has none that can be read, that of the atom before plus one.
    pub serial: u64,
    /// Index of its residue in [`Structure::residues`].
    pub residue: u32,
    /// Name within the residue ("CA"), without the blanks around it.
    pub name: Name,
    /// Element symbol as the file states it; empty if it does not.
    pub element: Name,
    /// Alternate location; empty if there is one location only.
    pub altloc: Name,
    /// Share of the molecules in which the atom is here; 1 if not stated.
    pub occupancy: f32,
    /// Whether the record is HETATM: ligands, ions, water, modified residues.
    pub is_hetatm: bool,
}

/// A residue: what the atoms of a monomer, ligand or molecule of water have in common.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Residue {
    /// Chain, as the authors call it.
    pub chain: Name,
    /// Name ("ALA", "HOH").
    pub name: Name,
    /// Number within the chain, as the authors count; `None` if not stated.
    pub number: Option<i32>,
    /// Insertion code; empty mostly.
    pub insertion_code: Name,
}

/// All that is known of one atom, with its texts.
#[derive(Debug, Clone, Copy)]
pub struct AtomView<'s> {
    /// The structure it belongs to.
    pub structure: &'s Structure,
    /// Number of its model.
    pub model: i64,
    /// The atom.
    pub atom: &'s Atom,
    /// Its place, in stored coordinates.
    pub point: Point3,
}

impl<'s> AtomView<'s> {
    /// Its residue.
    #[must_use]
    pub fn residue(&self) -> &'s Residue {
        &self.structure.residues[self.atom.residue as usize]
    }

    /// Name of its chain.
    #[must_use]
    pub fn chain(&self) -> &'s str {
        self.structure.names.text(self.residue().chain)
    }

    /// Name of its residue.
    #[must_use]
    pub fn residue_name(&self) -> &'s str {
        self.structure.names.text(self.residue().name)
    }

    /// Number of its residue.
    #[must_use]
    pub fn residue_number(&self) -> Option<i32> {
        self.residue().number
    }

    /// Insertion code of its residue.
    #[must_use]
    pub fn insertion_code(&self) -> &'s str {
        self.structure.names.text(self.residue().insertion_code)
    }

    /// Its name.
    #[must_use]
    pub fn name(&self) -> &'s str {
        self.structure.names.text(self.atom.name)
    }

    /// Its element.
    #[must_use]
    pub fn element(&self) -> &'s str {
        self.structure.names.text(self.atom.element)
    }

    /// Its alternate location.
    #[must_use]
    pub fn altloc(&self) -> &'s str {
        self.structure.names.text(self.atom.altloc)
    }
}
