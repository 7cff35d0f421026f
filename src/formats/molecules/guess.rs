//! The element of an atom: as the file states it, or else as the atom's name tells.

use std::collections::HashMap;

use foldhash::fast::FixedState;

use crate::molecules::elements::Element;
use crate::molecules::names::{Name, Names};
use crate::molecules::radii::is_known;

/// Atomic numbers of atoms, by the names of residue, atom and element, and by the columns of the name.
/// Different ones are few.
#[derive(Debug, Default)]
pub(crate) struct Elements {
    known: HashMap<([Name; 3], u8), u8, FixedState>,
}

impl Elements {
    /// The atomic number of an atom; 0 if its names do not tell it.
    pub(crate) fn number(&mut self, names: &Names, texts: [Name; 3], symbol_len: u8) -> u8 {
        *self.known.entry((texts, symbol_len)).or_insert_with(|| {
            let [residue, atom, element] = texts.map(|name| looked_up(names.text(name)));
            let labels = Labels { residue: &residue, atom: &atom };
            let found = if element.is_empty() { labels.element(symbol_len) } else { stated(&element) };
            found.map_or(0, Element::number)
        })
    }
}

/// A name of a residue or an atom as it is looked up: in upper case, and with the prime of atoms of sugars
/// that older files write as an asterisk.
pub(crate) fn looked_up(name: &str) -> String {
    name.to_ascii_uppercase().replace('*', "'")
}

/// The names of an atom, as they are looked up.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Labels<'a> {
    /// Name of the residue.
    pub(crate) residue: &'a str,
    /// Name of the atom.
    pub(crate) atom: &'a str,
}

/// Names that CHARMM gives to ions, and their elements.
const IONS: [(&str, &str); 9] = [
    ("SOD", "NA"),
    ("POT", "K"),
    ("CLA", "CL"),
    ("CAL", "CA"),
    ("CES", "CS"),
    ("LIT", "LI"),
    ("RUB", "RB"),
    ("BAR", "BA"),
    ("IOD", "I"),
];

/// Names of atoms of modified amino acids that are also symbols. Some programs write them where symbols of
/// two letters start; these elements, with these names, hardly occur in residues of several atoms.
const NO_SYMBOLS: [&str; 5] = ["CA", "CD", "CE", "ND", "NE"];

impl Labels<'_> {
    /// Whether the atom has the name of its residue: it is an ion or another single atom.
    pub(crate) fn is_single(&self) -> bool {
        !self.atom.is_empty() && letters(self.atom) == letters(self.residue)
    }

    /// The element; `None` if the labels do not tell it.
    ///
    /// A name tells the element if the residue is one of proteins, nucleic acids or water, or if it is also
    /// the name of the residue. Otherwise the columns of a PDB record count, where symbols of two letters
    /// start one column before others: `symbol_len` has the letters of the symbol, or 0.
    fn element(&self, symbol_len: u8) -> Option<Element> {
        let name = letters(self.atom);
        if is_known(self.residue) {
            return if name == "SE" { Element::of_symbol(name) } else { of_start(name, 1) };
        }
        if self.is_single() {
            let ion = IONS.iter().find(|(ion, _)| *ion == self.atom);
            return Element::of_symbol(ion.map_or(name, |(_, symbol)| symbol));
        }
        match symbol_len {
            1 => of_start(name, 1),
            // Nor do helium and holmium, with any name.
            2 if NO_SYMBOLS.contains(&self.atom) || matches!(name, "HE" | "HO") => of_start(name, 1),
            2 => of_start(name, 2).or_else(|| of_start(name, 1)),
            // Names that fill their columns are mostly those of hydrogens and of atoms of large ligands.
            _ if name.starts_with(['H', 'C', 'N', 'O', 'P', 'S', 'D']) && !name.starts_with("CL") => {
                of_start(name, 1)
            }
            _ => of_start(name, 2).or_else(|| of_start(name, 1)),
        }
    }
}

/// The element that a file states: a symbol, perhaps with a number or a charge, or an atomic number.
fn stated(element: &str) -> Option<Element> {
    match element.parse() {
        Ok(number) => Element::of_number(number),
        Err(_) => Element::of_symbol(letters(element))
            .filter(|_| !element.starts_with(|c: char| c.is_ascii_digit())),
    }
}

/// The letters of a name before other characters, without digits at the start: the names of hydrogens may
/// start with one.
fn letters(name: &str) -> &str {
    let name = name.trim_start_matches(|c: char| c.is_ascii_digit());
    let end = name.find(|c: char| !c.is_ascii_alphabetic()).unwrap_or(name.len());
    &name[..end]
}

/// The element whose symbol is the first `len` letters.
fn of_start(letters: &str, len: usize) -> Option<Element> {
    Element::of_symbol(letters.get(..len)?)
}
