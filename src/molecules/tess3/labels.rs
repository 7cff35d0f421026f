//! What the labels in a table do not tell: residues and chains that share theirs, and molecules that a user
//! may not expect.

use std::collections::HashMap;
use std::hash::Hash;

use super::{Between, Level, Options, Product};
use spmesh_formats::molecules::{AtomView, Class, Selected};

/// Counts of what the labels in a table do not tell.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Labels {
    /// Residues whose label another has, too.
    pub residues: u64,
    /// Chains whose name another has, too.
    pub chains: u64,
    /// Atoms of ligands, ions and water among others, if the user asked for no classes.
    pub others: [u64; 3],
}

impl Labels {
    pub(super) fn of(selected: &Selected<'_>, options: &Options) -> Labels {
        let balls = options.balls.as_ref();
        let is_table = balls.is_none_or(|balls| balls.picture.is_none());
        let level = balls.map_or(Level::Atom, |balls| balls.level);
        let is_by_chain = balls.is_some_and(|balls| balls.contacts.between == Some(Between::Chains));
        let (mut residues, mut chains, mut classes) = (Shared::default(), Shared::default(), [0; 4]);
        for atom in (0..selected.points().len()).filter_map(|index| selected.atom(index)) {
            let residue = atom.residue();
            if is_table && matches!(level, Level::Atom | Level::Residue) {
                let label = (residue.chain, residue.name, residue.number, residue.insertion_code);
                residues.put(label, atom.atom.residue);
            }
            if level == Level::Chain || is_by_chain {
                chains.put(residue.chain, residue.chain_number);
            }
            classes[place(&atom)] += 1;
        }
        let [polymer, others @ ..] = classes;
        let is_open = options.selection.classes.is_empty() && options.product != Product::Tetrahedra;
        let others = if is_open && polymer > 0 { others } else { [0; 3] };
        Labels { residues: residues.count(), chains: chains.count(), others }
    }

    /// The counts in sentences.
    pub(super) fn warnings(&self) -> Vec<String> {
        let mut texts = Vec::new();
        for (count, what) in [(self.residues, "residues"), (self.chains, "chains")] {
            if count > 0 {
                texts.push(format!("{count} {what} share their labels: serial numbers tell atoms apart"));
            }
        }
        let named = self.others.iter().zip(["ligands", "ions", "water"]).filter(|&(&count, _)| count > 0);
        let counts: Vec<String> = named.map(|(count, name)| format!("{count} of {name}")).collect();
        if !counts.is_empty() {
            let counts = counts.join(", ");
            texts.push(format!("atoms that are not of polymers count, too: {counts}; see --classes polymer"));
        }
        texts
    }
}

fn place(atom: &AtomView<'_>) -> usize {
    match atom.residue().class {
        Class::Polymer => 0,
        Class::Ligand => 1,
        Class::Ion => 2,
        Class::Water => 3,
    }
}

/// Things by their labels.
struct Shared<L> {
    last: Option<u32>,
    things: HashMap<L, Vec<u32>>,
}

impl<L> Default for Shared<L> {
    fn default() -> Self {
        Shared { last: None, things: HashMap::new() }
    }
}

impl<L: Eq + Hash> Shared<L> {
    /// Adds a thing, which may be there already.
    fn put(&mut self, label: L, thing: u32) {
        if self.last.replace(thing) != Some(thing) {
            self.things.entry(label).or_default().push(thing);
        }
    }

    /// The number of things whose label others have, too.
    fn count(mut self) -> u64 {
        let count = |things: &mut Vec<u32>| {
            things.sort_unstable();
            things.dedup();
            if things.len() > 1 { things.len() as u64 } else { 0 }
        };
        self.things.values_mut().map(count).sum()
    }
}
