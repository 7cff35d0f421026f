//! Names of atoms as the tables have them.

use std::fmt::Write;

use spmesh_formats::molecules::{AtomView, Selected};

/// The names of all selected atoms, one behind the other.
#[derive(Debug, Default)]
pub(super) struct AtomNames {
    text: String,
    ends: Vec<usize>,
}

impl AtomNames {
    /// The names of the atoms: `chain/residue/number/atom`. The number includes its insertion code.
    /// `/location` follows if an atom has alternate locations. Points without names have their numbers.
    pub(super) fn new(selected: &Selected<'_>) -> Self {
        let mut names = AtomNames::default();
        for index in 0..selected.points().len() {
            names.push(selected.atom(index), selected.label(index));
        }
        names
    }

    /// The name of the atom at `index` of the selection.
    pub(super) fn name(&self, index: usize) -> &str {
        let start = index.checked_sub(1).map_or(0, |before| self.ends[before]);
        &self.text[start..self.ends[index]]
    }

    fn push(&mut self, atom: Option<AtomView<'_>>, label: u64) {
        let text = &mut self.text;
        match atom {
            None => write!(text, "{label}").expect("a string takes all"),
            Some(atom) => {
                text.push_str(atom.chain());
                text.push('/');
                text.push_str(atom.residue_name());
                text.push('/');
                if let Some(number) = atom.residue_number() {
                    write!(text, "{number}").expect("a string takes all");
                }
                text.push_str(atom.insertion_code());
                text.push('/');
                text.push_str(atom.name());
                if !atom.altloc().is_empty() {
                    text.push('/');
                    text.push_str(atom.altloc());
                }
            }
        }
        self.ends.push(text.len());
    }
}
