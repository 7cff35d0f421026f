//! Chooses one of the alternate locations of each atom.

use std::collections::{HashMap, HashSet};
use std::hash::Hash;

use foldhash::fast::FixedState;

use crate::molecules::model::{Atom, Residue};
use crate::molecules::names::Name;

/// The conformer of a residue to choose.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Preference {
    /// The first conformer.
    First,
    /// The conformer with the highest mean occupancy; of equal ones the first.
    MostOccupied,
}

type Map<K, V> = HashMap<K, V, FixedState>;

/// A place in a chain: number of the chain, number, insertion code and name of the residue. Residues with
/// different names at one place are alternatives too.
type Site = (u32, Option<i32>, Name, Name);

/// A conformer at a site.
#[derive(Debug, Clone, Copy)]
struct Conformer {
    altloc: Name,
    occupancies: f64,
    atoms: f64,
}

impl Conformer {
    /// Mean occupancy of its atoms.
    fn mean(&self) -> f64 {
        self.occupancies / self.atoms
    }
}

/// For each atom, whether it belongs to one conformer of the model. The conformer has all atoms with a single
/// location and the atoms of the preferred conformer at each site. If the preferred conformer lacks an atom
/// of its residue, the conformer has that atom's preferred location among the others.
pub(crate) fn one_conformer(residues: &[Residue], atoms: &[Atom], preference: Preference) -> Vec<bool> {
    let residue = |atom: &Atom| residues[atom.residue as usize];
    let mut wanted: Vec<bool> = atoms.iter().map(|atom| atom.altloc.is_empty()).collect();
    let alternatives: Vec<usize> = (0..atoms.len()).filter(|&index| !wanted[index]).collect();
    let chosen =
        choose(alternatives.iter().map(|&index| (site(&residue(&atoms[index])), &atoms[index])), preference);

    let (mut complete, mut chosen_residues) = (HashSet::new(), HashSet::new());
    for &index in &alternatives {
        let (atom, residue) = (&atoms[index], residue(&atoms[index]));
        if chosen[&site(&residue)] == atom.altloc {
            wanted[index] = true;
            complete.insert((residue, atom.name));
            chosen_residues.insert(residue);
        }
    }
    let mut substitutes: Map<(Residue, Name), usize> = Map::default();
    for &index in &alternatives {
        let (atom, residue) = (&atoms[index], residue(&atoms[index]));
        if complete.contains(&(residue, atom.name)) || !chosen_residues.contains(&residue) {
            continue;
        }
        let best = substitutes.entry((residue, atom.name)).or_insert(index);
        if preference == Preference::MostOccupied && atom.occupancy > atoms[*best].occupancy {
            *best = index;
        }
    }
    substitutes.values().for_each(|&index| wanted[index] = true);
    wanted
}

/// The place of a residue. Residues without a number are distinguished by name.
fn site(residue: &Residue) -> Site {
    let name = if residue.number.is_none() { residue.name } else { Name::EMPTY };
    (residue.chain_number, residue.number, residue.insertion_code, name)
}

/// The preferred alternate location at each site.
fn choose<'a, S: Copy + Hash + Eq>(
    alternatives: impl Iterator<Item = (S, &'a Atom)>,
    preference: Preference,
) -> Map<S, Name> {
    let mut conformers: Vec<(S, Conformer)> = Vec::new();
    let mut indices: Map<(S, Name), usize> = Map::default();
    for (site, &Atom { altloc, occupancy, .. }) in alternatives {
        let index = *indices.entry((site, altloc)).or_insert(conformers.len());
        if index == conformers.len() {
            conformers.push((site, Conformer { altloc, occupancies: 0.0, atoms: 0.0 }));
        }
        conformers[index].1.occupancies += f64::from(occupancy);
        conformers[index].1.atoms += 1.0;
    }
    let mut preferred: Map<S, Conformer> = Map::default();
    for (site, conformer) in conformers {
        let best = preferred.entry(site).or_insert(conformer);
        if preference == Preference::MostOccupied && conformer.mean() > best.mean() {
            *best = conformer;
        }
    }
    preferred.into_iter().map(|(site, conformer)| (site, conformer.altloc)).collect()
}
