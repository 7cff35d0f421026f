//! Molecular structures in memory, compact enough for millions of atoms.

use std::num::NonZeroU16;

use crate::molecules::assemblies::Assemblies;
use crate::molecules::classes::Class;
use crate::molecules::elements::Element;
use crate::molecules::names::{Name, Names};
use crate::molecules::periodic_box::StatedBox;
use spmesh_stream::Coordinates;
use spmesh_stream::model::points::Point3;

/// A molecular structure, or points without names.
#[derive(Debug, Clone)]
pub struct Structure {
    /// Name in messages: the path of the file, or "stdin".
    pub name: String,
    /// How the points of all models are stored: as 32-bit integers in units of 0.001 Å (or of a smaller power
    /// of ten of which all coordinates of the input are multiples), or else as world coordinates.
    pub coordinates: Coordinates,
    /// The models that have atoms, at least one, in the order of the file. A file without models has one with
    /// number 1.
    pub models: Vec<Model>,
    /// The residues that atoms refer to.
    pub residues: Vec<Residue>,
    /// The texts that residues and atoms refer to.
    pub names: Names,
    /// The biological assemblies that the file states.
    pub assemblies: Assemblies,
    /// The space group of a crystal, if the file states one beside P 1: its atoms are then only a part of
    /// what is in the box.
    pub space_group: Option<String>,
    /// Oddities of the input, as sentences.
    pub warnings: Vec<String>,
}

/// One model: in ensembles another copy of the same molecule, in other files anything.
#[derive(Debug, Clone, Default)]
pub struct Model {
    /// Number stated by the file.
    pub number: i64,
    /// Positions of the atoms, in stored coordinates; all finite.
    pub points: Vec<Point3>,
    /// The atoms, one per point; empty if the input has points without names.
    pub atoms: Vec<Atom>,
    /// Labels of points without names, if the input has any.
    pub labels: Vec<u64>,
    /// The periodic box.
    pub periodic_box: StatedBox,
}

impl Model {
    /// The number and the box.
    pub(crate) fn without_atoms(&self) -> Model {
        Model { number: self.number, periodic_box: self.periodic_box.clone(), ..Model::default() }
    }
}

/// The data of an atom, in 32 bytes. Its position is the point with the same index.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Atom {
    /// Serial number; if the file states none that can be parsed, the serial number of the atom before plus
    /// one.
    pub serial: u64,
    /// Index of its residue in [`Structure::residues`].
    pub residue: u32,
    /// Name within the residue ("CA"), without the blanks around it.
    pub name: Name,
    /// Element symbol as the file states it; empty if it does not.
    pub element: Name,
    /// Alternate location; empty if the atom has only one.
    pub altloc: Name,
    /// Share of the molecules in which the atom is here; 1 if not stated.
    pub occupancy: f32,
    /// Whether the record is HETATM: ligands, ions, water, modified residues.
    pub is_hetatm: bool,
    /// Atomic number of its element, as the file states it or else as the names of atom and residue tell; 0
    /// if they do not.
    pub atomic_number: u8,
    /// See [`Atom::radius`]; one more, so that 0 is none.
    pub(crate) radius: Option<NonZeroU16>,
}

impl Atom {
    /// Its radius in steps of 0.001 Å, if the file states it.
    pub fn radius(&self) -> Option<u32> {
        self.radius.map(|steps| u32::from(steps.get()) - 1)
    }

    /// Whether it is hydrogen, or deuterium or tritium.
    pub fn is_hydrogen(&self) -> bool {
        self.atomic_number == 1
    }
}

/// A residue: the data that the atoms of a monomer, ligand or water molecule share.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Residue {
    /// Chain, as named by the authors; the segment, if a PDB file names no chain.
    pub chain: Name,
    /// Number of its chain, from 1 in the order of the file: chains of one name may differ.
    pub chain_number: u32,
    /// Name ("ALA", "HOH").
    pub name: Name,
    /// Number within the chain, as counted by the authors; `None` if not stated.
    pub number: Option<i32>,
    /// Insertion code; mostly empty.
    pub insertion_code: Name,
    /// Part of the chain, as mmCIF names it (`label_asym_id`); otherwise the chain.
    pub subchain: Name,
    /// Segment (columns 73 to 76 of PDB), as its first atom has it; mostly empty.
    pub segment: Name,
    /// What it belongs to.
    pub class: Class,
}

/// All data of one atom, with its texts.
#[derive(Debug, Clone, Copy)]
pub struct AtomView<'s> {
    /// The structure it belongs to.
    pub structure: &'s Structure,
    /// Number of its model.
    pub model: i64,
    /// The atom.
    pub atom: &'s Atom,
    /// Its position, in stored coordinates.
    pub point: Point3,
}

impl<'s> AtomView<'s> {
    /// Its residue.
    pub fn residue(&self) -> &'s Residue {
        &self.structure.residues[self.atom.residue as usize]
    }

    /// Name of its chain.
    pub fn chain(&self) -> &'s str {
        self.structure.names.text(self.residue().chain)
    }

    /// Part of its chain, as mmCIF names it; otherwise the chain.
    pub fn subchain(&self) -> &'s str {
        self.structure.names.text(self.residue().subchain)
    }

    /// Segment of its residue.
    pub fn segment(&self) -> &'s str {
        self.structure.names.text(self.residue().segment)
    }

    /// Name of its residue.
    pub fn residue_name(&self) -> &'s str {
        self.structure.names.text(self.residue().name)
    }

    /// Number of its residue.
    pub fn residue_number(&self) -> Option<i32> {
        self.residue().number
    }

    /// Insertion code of its residue.
    pub fn insertion_code(&self) -> &'s str {
        self.structure.names.text(self.residue().insertion_code)
    }

    /// Its name.
    pub fn name(&self) -> &'s str {
        self.structure.names.text(self.atom.name)
    }

    /// The symbol of its element as chemists write it, "Zn"; what the file states if that is no element.
    /// Deuterium stays "D".
    pub fn element(&self) -> &'s str {
        let stated = self.structure.names.text(self.atom.element);
        match Element::of_number(usize::from(self.atom.atomic_number)) {
            Some(element) if !stated.eq_ignore_ascii_case("D") => element.symbol(),
            _ => stated,
        }
    }

    /// Its alternate location.
    pub fn altloc(&self) -> &'s str {
        self.structure.names.text(self.atom.altloc)
    }
}
