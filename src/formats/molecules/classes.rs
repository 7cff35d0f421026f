//! Classes of residues: polymer, water, ion, ligand. What the file states decides, and otherwise names do.

use std::collections::{HashMap, HashSet};

use foldhash::fast::FixedState;

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
    pub(crate) element: Name,
    pub(crate) is_hetatm: bool,
    /// Whether all of its atoms have one name: they are locations of one atom.
    pub(crate) is_single: bool,
}

type Map<K, V> = HashMap<K, V, FixedState>;
type Set<K> = HashSet<K, FixedState>;

/// Chain, number, insertion code and name of a residue.
type Site = (Name, Option<i32>, Name, Name);

/// What a file states of its molecules, beside the atoms.
#[derive(Debug, Default)]
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
    /// Sets the class of each residue.
    pub(crate) fn classify(&self, residues: &mut [Residue], details: &[Detail], names: &Names) {
        // A TER is that of the residue before it.
        let ends: Set<usize> = self.chain_ends.iter().filter_map(|&count| count.checked_sub(1)).collect();
        let mut starts = self.model_starts.clone();
        starts.retain(|&start| start < residues.len());
        starts.push(residues.len());
        // Names are few.
        let mut kinds: Map<Name, Kind> = Map::default();
        let mut start = 0;
        for end in starts {
            let mut chains: Map<Name, Chain> = Map::default();
            for index in (start..end).filter(|index| ends.contains(index)) {
                let chain: &mut Chain = chains.entry(residues[index].chain).or_default();
                (chain.end, chain.ends) = (Some(index), chain.ends + 1);
            }
            for index in start..end {
                let chain = chains.entry(residues[index].chain).or_default();
                let residue = &mut residues[index];
                let kind = *kinds.entry(residue.name).or_insert_with(|| kind(names.text(residue.name)));
                residue.class = self.class(residue, &details[index], (chain.part(index), kind), names);
                chain.has_polymer |= residue.class == Class::Polymer;
            }
            start = end;
        }
    }

    fn class(&self, residue: &Residue, detail: &Detail, at: (Part, Kind), names: &Names) -> Class {
        let (part, kind) = at;
        let is_ion = || detail.is_single && is_ion_atom(names, residue.name, detail.atom, detail.element);
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
