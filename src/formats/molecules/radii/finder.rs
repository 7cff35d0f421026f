//! Finds the radii of many atoms of one structure.

use std::collections::HashMap;

use foldhash::fast::FixedState;

use crate::molecules::model::{AtomView, Structure};
use crate::molecules::names::Name;
use crate::molecules::radii::elements::Element;
use crate::molecules::radii::guess::Labels;
use crate::molecules::radii::{Radii, STEPS, looked_up};
use spmesh_base::error::{Error, Result};

/// The texts of an atom that tell its radius.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
struct Kind {
    residue: Name,
    atom: Name,
    element: Name,
    symbol_len: u8,
}

/// Finds the radii of the atoms of one structure, by [`Radii::finder`].
///
/// Cost: a table of texts is searched for the first atom of each kind (residue name, atom name, element); for
/// others, a hash of four integers is looked up. Memory: 24 bytes per kind.
#[derive(Debug)]
pub struct RadiusFinder<'s> {
    radii: &'s Radii,
    structure: &'s Structure,
    /// Radii of the kinds so far, in steps of 0.001 Å.
    known: HashMap<Kind, u32, FixedState>,
}

impl<'s> RadiusFinder<'s> {
    pub(crate) fn new(radii: &'s Radii, structure: &'s Structure) -> Self {
        RadiusFinder { radii, structure, known: HashMap::default() }
    }

    /// The radius of an atom of the structure, in Å: the f64 nearest to a multiple of 0.001.
    ///
    /// # Errors
    /// As [`RadiusFinder::steps_of`].
    #[inline]
    pub fn of(&mut self, atom: &AtomView<'_>) -> Result<f64> {
        Ok(f64::from(self.steps_of(atom)?) / STEPS)
    }

    /// The radius of an atom of the structure, in steps of 0.001 Å: exact.
    ///
    /// # Errors
    /// [`spmesh_base::error::ErrorKind::Usage`], with the atom and a remedy, if it has no radius.
    ///
    /// # Panics
    /// In debug builds, if the atom is of another structure.
    #[inline]
    pub fn steps_of(&mut self, atom: &AtomView<'_>) -> Result<u32> {
        debug_assert!(std::ptr::eq(atom.structure, self.structure), "names are those of one structure");
        let kind = Kind {
            residue: atom.residue().name,
            atom: atom.atom.name,
            element: atom.atom.element,
            symbol_len: atom.atom.symbol_len,
        };
        match self.known.get(&kind) {
            Some(&steps) => Ok(steps),
            None => self.find(kind, atom),
        }
    }

    /// Finds the radius of the first atom of a kind.
    #[cold]
    fn find(&mut self, kind: Kind, atom: &AtomView<'_>) -> Result<u32> {
        let texts = looked_up_texts(atom);
        let labels = labels(&texts, atom);
        let element = labels.element();
        let steps = self.radii.find(&labels, element).ok_or_else(|| unknown(atom, element.is_some()))?;
        self.known.insert(kind, steps);
        Ok(steps)
    }
}

impl AtomView<'_> {
    /// Atomic number of its element, as the file states it or its names tell; 0 if they do not.
    pub fn atomic_number(&self) -> u8 {
        labels(&looked_up_texts(self), self).element().map_or(0, Element::number)
    }
}

/// Names of residue and atom, and the element, as they are looked up.
fn looked_up_texts(atom: &AtomView<'_>) -> [String; 3] {
    [atom.residue_name(), atom.name(), atom.element()].map(looked_up)
}

fn labels<'t>([residue, name, element]: &'t [String; 3], atom: &AtomView<'_>) -> Labels<'t> {
    Labels { residue, atom: name, element, symbol_len: atom.atom.symbol_len }
}

/// An error about an atom without a radius.
fn unknown(atom: &AtomView<'_>, has_element: bool) -> Error {
    let or_any = |text: &str| if text.is_empty() { "*".to_string() } else { text.to_string() };
    let (residue, name) = (or_any(atom.residue_name()), or_any(atom.name()));
    let number = atom.residue_number().map_or(String::new(), |number| format!(" {number}"));
    let code = atom.insertion_code();
    let chain = if atom.chain().is_empty() { String::new() } else { format!(" of chain {}", atom.chain()) };
    let element = match atom.element() {
        "" if has_element => String::new(),
        "" => ", of unknown element".to_string(),
        element => format!(", element {element}"),
    };
    let place = format!("residue {residue}{number}{code}{chain}{element}");
    let remedy = format!("state it in a file for --radii, by a line \"{residue} {name} RADIUS\"");
    Error::usage(format!("no radius for atom {} {name} in {place}: {remedy}", atom.atom.serial))
        .of_input(&atom.structure.name)
}
