//! Alternate locations that are asked for and not there.

use crate::molecules::model::Structure;
use crate::molecules::names::Name;
use crate::molecules::selection::{Altlocs, Models, Selection};

/// Most names of locations in a message.
const SHOWN: usize = 20;

impl Structure {
    /// A sentence, if the selection names a location that no atom of its models and chains has; atoms with
    /// alternate locations are then in none of them.
    pub fn missing_location(&self, selection: &Selection) -> Option<String> {
        let Altlocs::Named(wanted) = &selection.altlocs else { return None };
        let there = self.locations(selection);
        if there.iter().any(|&name| self.names.text(name) == wanted) {
            return None;
        }
        let mut names: Vec<&str> = there.iter().take(SHOWN).map(|&name| self.names.text(name)).collect();
        if there.len() > SHOWN {
            names.push("...");
        }
        let lacks = format!("no atom has the alternate location {wanted:?}");
        Some(match names.is_empty() {
            true => format!("{lacks}, nor any other"),
            false => format!("{lacks}, only {}: other locations are left out", names.join(", ")),
        })
    }

    /// The names of all locations in the models and chains of a selection, in the order in which they appear.
    fn locations(&self, selection: &Selection) -> Vec<Name> {
        let models = self.models.iter().enumerate().filter(|&(place, model)| match selection.models {
            Models::First => place == 0,
            Models::One(number) => model.number == number,
            Models::Range(first, last) => (first..=last).contains(&model.number),
            Models::All | Models::Joined => true,
        });
        let there = self.chains();
        // Chains that are not there yet are copies in an assembly.
        let is_by_chain =
            !selection.chains.is_empty() && selection.chains.iter().all(|chain| there.contains(&&**chain));
        let is_of_chain = |residue: u32| {
            let chain = self.names.text(self.residues[residue as usize].chain);
            !is_by_chain || selection.chains.iter().any(|wanted| wanted == chain)
        };
        let mut names = Vec::new();
        for atom in models.flat_map(|(_, model)| &model.atoms) {
            if !atom.altloc.is_empty() && !names.contains(&atom.altloc) && is_of_chain(atom.residue) {
                names.push(atom.altloc);
            }
        }
        names
    }
}
