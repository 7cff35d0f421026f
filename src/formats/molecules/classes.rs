//! Classes of residues: polymer, water, ion, ligand. What the file states decides, and otherwise names do.

use std::collections::{HashMap, HashSet};

use foldhash::fast::FixedState;

use crate::molecules::identity::{Link, number_chains};
use crate::molecules::model::Residue;
use crate::molecules::names::{Name, Names};
use crate::molecules::residue_names::{Kind, is_ion_atom, kind};

/// What a residue belongs to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Class {
    /// A chain of amino acids or nucleotides; modified residues and caps belong to it.
    Polymer,
    /// Water, heavy water too.
    Water,
    /// A single atom of a metal or halogen. Ions of several atoms are ligands.
    Ion,
    /// Anything else: small molecules, sugars, noble gases.
    #[default]
    Ligand,
}

impl Class {
    /// Its name, as `--classes` takes it.
    pub fn name(self) -> &'static str {
        match self {
            Class::Polymer => "polymer",
            Class::Water => "water",
            Class::Ion => "ion",
            Class::Ligand => "ligand",
        }
    }
}

/// An entity of mmCIF, by its type.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Entity {
    Polymer,
    Water,
    Other,
}

/// What is known of a residue only while a file is read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Detail {
    /// Entity that its atoms name; mostly empty, except in mmCIF.
    pub(crate) entity: Name,
    /// Name and element of its first atom, and whether that is a HETATM record.
    pub(crate) atom: Name,
    pub(crate) atomic_number: u8,
    pub(crate) is_hetatm: bool,
    /// Whether all of its atoms have one name: they are locations of one atom.
    pub(crate) is_single: bool,
}

type Map<K, V> = HashMap<K, V, FixedState>;
type Set<K> = HashSet<K, FixedState>;

/// Chain, number, insertion code and name of a residue.
type Site = (Name, Option<i32>, Name, Name);

/// What a file states of its molecules, beside the atoms.
#[derive(Debug, Clone, Default)]
pub(crate) struct Annotations {
    /// mmCIF: the type of each entity.
    pub(crate) entities: Map<Name, Entity>,
    /// mmCIF: the entity of each subchain.
    pub(crate) entity_of: Map<Name, Name>,
    /// PDB: chains and the residues in their sequences (SEQRES).
    pub(crate) sequences: Set<(Name, Name)>,
    /// PDB: modified residues of polymers (MODRES).
    pub(crate) modified: Set<Site>,
    /// PDB: for each TER, the number of residues before it.
    pub(crate) chain_ends: Vec<usize>,
    /// For each model, the number of residues before it.
    pub(crate) model_starts: Vec<usize>,
}

impl Annotations {
    /// The same without what belongs to the atoms of one frame.
    pub(crate) fn of_next_frame(&self) -> Annotations {
        Annotations { chain_ends: Vec::new(), model_starts: Vec::new(), ..self.clone() }
    }

    /// Numbers the chains of the residues.
    pub(crate) fn number_chains(&self, residues: &mut [Residue], details: &[Detail], names: &Names) {
        let mut kinds = Kinds::new(names);
        let link = |index: usize, name| Link { kind: kinds.of(name), is_hetatm: details[index].is_hetatm };
        number_chains(residues, &self.model_starts, &self.ends(), link);
    }

    /// The last residues before a TER.
    fn ends(&self) -> Set<usize> {
        self.chain_ends.iter().filter_map(|&count| count.checked_sub(1)).collect()
    }

    /// Sets the class of each residue.
    pub(crate) fn classify(&self, residues: &mut [Residue], details: &[Detail], names: &Names) {
        let mut chains: Map<u32, Chain> = Map::default();
        let mut ends: Vec<usize> = self.ends().into_iter().filter(|&index| index < residues.len()).collect();
        ends.sort_unstable();
        for index in ends {
            let chain = chains.entry(residues[index].chain_number).or_default();
            (chain.end, chain.ends) = (Some(index), chain.ends + 1);
        }
        let mut kinds = Kinds::new(names);
        for (index, (residue, detail)) in residues.iter_mut().zip(details).enumerate() {
            let chain = chains.entry(residue.chain_number).or_default();
            let at = (chain.part(index), kinds.of(residue.name));
            residue.class = self.class(residue, detail, at, names);
            chain.has_polymer |= residue.class == Class::Polymer;
        }
    }

    fn class(&self, residue: &Residue, detail: &Detail, at: (Part, Kind), names: &Names) -> Class {
        let (part, kind) = at;
        let is_ion = || detail.is_single && is_ion_atom(names.text(residue.name), detail.atomic_number);
        let of_subchain = || self.entity_of.get(&residue.subchain).copied().unwrap_or_default();
        let entity = if detail.entity.is_empty() { of_subchain() } else { detail.entity };
        match self.entities.get(&entity) {
            Some(Entity::Polymer) => Class::Polymer,
            Some(Entity::Water) => Class::Water,
            _ if kind == Kind::Water => Class::Water,
            None if self.is_in_polymer(residue, detail, at) => Class::Polymer,
            _ if is_ion() => Class::Ion,
            None if part == Part::BeforeEnd => Class::Polymer,
            _ => Class::Ligand,
        }
    }

    /// Whether sequences or names tell that the residue is one of a polymer.
    fn is_in_polymer(&self, residue: &Residue, detail: &Detail, (part, kind): (Part, Kind)) -> bool {
        // Amino acids and nucleotides may also be ligands; those follow the end of the chain.
        if detail.is_hetatm && part == Part::Behind {
            return false;
        }
        let site = (residue.chain, residue.number, residue.insertion_code, residue.name);
        kind == Kind::Polymer
            || self.sequences.contains(&(residue.chain, residue.name))
            || self.modified.contains(&site)
    }
}

/// What the names of residues tell, which are few.
struct Kinds<'n> {
    names: &'n Names,
    known: Map<Name, Kind>,
}

impl<'n> Kinds<'n> {
    fn new(names: &'n Names) -> Self {
        Kinds { names, known: Map::default() }
    }

    fn of(&mut self, residue: Name) -> Kind {
        *self.known.entry(residue).or_insert_with(|| kind(self.names.text(residue)))
    }
}

/// A chain in one model.
#[derive(Debug, Clone, Copy, Default)]
struct Chain {
    /// Index of the residue before its last TER.
    end: Option<usize>,
    /// Number of its TER. Files with several in a chain separate molecules of any kind by them.
    ends: usize,
    /// Whether a residue of a polymer was seen.
    has_polymer: bool,
}

/// Where in its chain a residue is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Part {
    /// The chain has no TER or several, or nothing of a polymer so far.
    Unknown,
    /// Between the first residue of a polymer and the TER.
    BeforeEnd,
    /// Behind the last TER.
    Behind,
}

impl Chain {
    fn part(&self, index: usize) -> Part {
        match self.end {
            Some(end) if index > end => Part::Behind,
            Some(_) if self.has_polymer && self.ends == 1 => Part::BeforeEnd,
            _ => Part::Unknown,
        }
    }
}
