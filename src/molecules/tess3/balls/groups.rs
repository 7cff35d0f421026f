//! Balls as a user names them: radii by a table or a file, and atoms that share a row.

use std::collections::HashMap;
use std::sync::Arc;

use super::Level;
use crate::tess3::identity::Named;
use data_encoding::HEXLOWER;
use sha2::{Digest, Sha256};
use spmesh_base::error::Result;
use spmesh_formats::molecules::{AtomView, Class, Name, Radii, Selected};

/// The groups of the selected atoms, numbered as they first appear.
pub(in crate::tess3) struct Groups {
    /// For each atom its group; empty if each atom is one.
    pub(super) of_atoms: Vec<u32>,
    /// Number of atoms of each group; empty if each atom is one.
    pub(in crate::tess3) sizes: Vec<u32>,
    named: Vec<Named>,
}

impl Groups {
    pub(in crate::tess3) fn new(selected: &Selected<'_>, level: Level) -> Groups {
        if level == Level::Atom {
            return Groups { of_atoms: Vec::new(), sizes: Vec::new(), named: Vec::new() };
        }
        Groups::by(selected, |atom| key(atom, level))
    }

    /// The groups of atoms with the same key.
    pub(super) fn by(selected: &Selected<'_>, key: impl Fn(&AtomView<'_>) -> Key) -> Groups {
        let mut groups = Groups { of_atoms: Vec::new(), sizes: Vec::new(), named: Vec::new() };
        let mut known: HashMap<Key, (u32, Name)> = HashMap::new();
        for index in 0..selected.points().len() {
            let Some(atom) = selected.atom(index) else { continue };
            let subchain = atom.residue().subchain;
            let &mut (group, first) = known.entry(key(&atom)).or_insert_with(|| {
                groups.named.push(Named::atom(index as u32));
                groups.sizes.push(0);
                (groups.sizes.len() as u32 - 1, subchain)
            });
            groups.named[group as usize].is_one_part &= subchain == first;
            groups.of_atoms.push(group);
            groups.sizes[group as usize] += 1;
        }
        groups
    }

    /// Exchanges the numbers of two groups, of which there are no others.
    pub(super) fn swap(&mut self) {
        self.of_atoms.iter_mut().for_each(|group| *group = 1 - *group);
        self.sizes.reverse();
        self.named.reverse();
    }

    pub(in crate::tess3) fn of(&self, atom: u32) -> u32 {
        self.of_atoms.get(atom as usize).copied().unwrap_or(atom)
    }

    /// What identifies a group.
    pub(in crate::tess3) fn named(&self, group: u32) -> Named {
        self.named.get(group as usize).copied().unwrap_or(Named::atom(group))
    }
}

/// What atoms of a group have in common.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(super) enum Key {
    Residue(u32),
    Chain(u32),
    Class(Class),
    /// Whether a list of residues has it.
    Listed(bool),
    All,
}

pub(super) fn key(atom: &AtomView<'_>, level: Level) -> Key {
    match level {
        Level::Residue => Key::Residue(atom.atom.residue),
        Level::Chain => Key::Chain(atom.residue().chain_number),
        Level::Atom | Level::Molecule => Key::All,
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
