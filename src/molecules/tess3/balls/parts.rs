//! The parts of a molecule between which contacts are wanted, or that bury areas of each other.

use std::fmt;

use super::Level;
use super::groups::{Groups, Key, key};
use spmesh_base::error::{Error, Result};
use spmesh_formats::molecules::{AtomView, Class, ResidueList, Selected};

/// What must differ between two atoms.
#[derive(Debug, Clone, PartialEq)]
pub enum Between {
    /// Their residue.
    Residues,
    /// Their chain.
    Chains,
    /// Their class: polymer, ligand, ion or water.
    Classes,
    /// One is in these residues, the other is not.
    Listed(ResidueList),
}

/// As a user writes it.
impl fmt::Display for Between {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Between::Residues => f.write_str("residues"),
            Between::Chains => f.write_str("chains"),
            Between::Classes => f.write_str("classes"),
            Between::Listed(list) => list.fmt(f),
        }
    }
}

impl Between {
    /// The part of each atom: different parts are what contacts are between.
    ///
    /// # Errors
    /// Usage, if a list names residues that there are none of.
    pub(super) fn parts(&self, selected: &Selected<'_>) -> Result<Vec<u32>> {
        let groups = match self {
            Between::Residues => Groups::new(selected, Level::Residue),
            Between::Chains => Groups::new(selected, Level::Chain),
            Between::Classes => Groups::by(selected, |atom| Key::Class(atom.residue().class)),
            Between::Listed(list) => listed(list, selected)?,
        };
        Ok(groups.of_atoms)
    }

    /// What buries areas: as the parts, but with classes each chain of polymers and each other residue.
    ///
    /// # Errors
    /// As [`Between::parts`].
    pub(super) fn units(&self, selected: &Selected<'_>) -> Result<Groups> {
        Ok(match self {
            Between::Residues => Groups::new(selected, Level::Residue),
            Between::Chains => Groups::new(selected, Level::Chain),
            Between::Classes => Groups::by(selected, unit),
            Between::Listed(list) => listed(list, selected)?,
        })
    }
}

fn unit(atom: &AtomView<'_>) -> Key {
    let is_polymer = atom.residue().class == Class::Polymer;
    key(atom, if is_polymer { Level::Chain } else { Level::Residue })
}

/// The residues of the list are the first part, all others the second.
fn listed(list: &ResidueList, selected: &Selected<'_>) -> Result<Groups> {
    let members = list.members(selected.structure())?;
    let is_member = |atom: &AtomView<'_>| members[atom.atom.residue as usize];
    let mut groups = Groups::by(selected, |atom| Key::Listed(is_member(atom)));
    let first = selected.atom(0).is_some_and(|atom| is_member(&atom));
    match (first, groups.sizes.len()) {
        (true, _) => {}
        (false, 2) => groups.swap(),
        _ => return Err(Error::usage(format!("no atom that was selected is in the residues {list}"))),
    }
    Ok(groups)
}
