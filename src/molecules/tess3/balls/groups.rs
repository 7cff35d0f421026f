//! Balls as a user names them: radii by a table or a file, and atoms that share a row.

use std::collections::HashMap;
use std::sync::Arc;

use super::Level;
use crate::tess3::tables::{AtomNames, push_residue};
use data_encoding::HEXLOWER;
use sha2::{Digest, Sha256};
use spmesh_base::error::Result;
use spmesh_formats::molecules::{AtomView, Radii, Selected};

/// The groups of the selected atoms, numbered as they first appear.
pub(in crate::tess3) struct Groups {
    /// For each atom its group; empty if each atom is one.
    of_atoms: Vec<u32>,
    /// Number of atoms of each group; empty if each atom is one.
    pub(in crate::tess3) sizes: Vec<u32>,
    names: Names,
}

enum Names {
    Atoms(AtomNames),
    Texts(Vec<String>),
}

impl Groups {
    pub(in crate::tess3) fn new(selected: &Selected<'_>, level: Level) -> Groups {
        if level == Level::Atom {
            let names = Names::Atoms(AtomNames::new(selected));
            return Groups { of_atoms: Vec::new(), sizes: Vec::new(), names };
        }
        let mut groups = Groups { of_atoms: Vec::new(), sizes: Vec::new(), names: Names::Texts(Vec::new()) };
        let mut known: HashMap<Key, u32> = HashMap::new();
        let mut texts = Vec::new();
        for index in 0..selected.points().len() {
            let Some(atom) = selected.atom(index) else { continue };
            let group = *known.entry(key(&atom, level)).or_insert_with(|| {
                texts.push(name(&atom, level));
                groups.sizes.push(0);
                texts.len() as u32 - 1
            });
            groups.of_atoms.push(group);
            groups.sizes[group as usize] += 1;
        }
        groups.names = Names::Texts(texts);
        groups
    }

    pub(in crate::tess3) fn of(&self, atom: u32) -> u32 {
        self.of_atoms.get(atom as usize).copied().unwrap_or(atom)
    }

    pub(in crate::tess3) fn name(&self, group: u32) -> &str {
        match &self.names {
            Names::Atoms(names) => names.name(group as usize),
            Names::Texts(texts) => &texts[group as usize],
        }
    }
}

/// What atoms of a group have in common.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(super) enum Key {
    Residue(u32),
    Chain(u32),
    All,
}

pub(super) fn key(atom: &AtomView<'_>, level: Level) -> Key {
    match level {
        Level::Residue => Key::Residue(atom.atom.residue),
        Level::Chain => Key::Chain(atom.residue().chain_number),
        Level::Atom | Level::Molecule => Key::All,
    }
}

fn name(atom: &AtomView<'_>, level: Level) -> String {
    match level {
        Level::Atom | Level::Molecule => "all".to_string(),
        Level::Chain => atom.chain().to_string(),
        Level::Residue => {
            let mut text = String::new();
            push_residue(&mut text, atom);
            text
        }
    }
}

/// Radii, and what they were called.
#[derive(Debug, Clone)]
pub struct NamedRadii {
    /// The radii.
    pub radii: Arc<Radii>,
    /// The name of the table; for a file also its SHA-256, so that a changed file has another text.
    pub text: String,
}

impl NamedRadii {
    /// The table of this name, or the radii in the file of this name, which is read once.
    ///
    /// # Errors
    /// Those of [`Radii::load`].
    pub fn load(name: &str) -> Result<NamedRadii> {
        let loaded = Radii::load(name)?;
        let text = match loaded.file {
            Some(content) => format!("{name} ({})", HEXLOWER.encode(&Sha256::digest(&content))),
            None => name.to_string(),
        };
        Ok(NamedRadii { radii: Arc::new(loaded.radii), text })
    }
}
