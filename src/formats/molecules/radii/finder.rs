//! Finds the radii of many atoms of one structure.

use std::collections::HashMap;

use foldhash::fast::FixedState;

use crate::molecules::elements::Element;
use crate::molecules::guess::{Labels, looked_up};
use crate::molecules::model::{AtomView, Structure};
use crate::molecules::names::Name;
use crate::molecules::radii::{Radii, RadiusOrigin, STEPS};
use spmesh_base::error::{Error, Result};

/// The texts of an atom that tell its radius.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
struct Kind {
    residue: Name,
    atom: Name,
    atomic_number: u8,
}

/// Finds the radii of the atoms of one structure, by [`Radii::finder`].
///
/// Cost: a table of texts is searched for the first atom of each kind (residue name, atom name, element); for
/// others, a hash of three integers is looked up. Memory: 24 bytes per kind.
#[derive(Debug)]
pub struct RadiusFinder<'s> {
    radii: &'s Radii,
    structure: &'s Structure,
    /// Radii of the kinds so far, in steps of 0.001 Å.
    known: HashMap<Kind, (u32, RadiusOrigin), FixedState>,
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
        self.find(atom).map(|(steps, _)| steps)
    }

    /// As [`RadiusFinder::steps_of`], and where the radius is from.
    pub(crate) fn find(&mut self, atom: &AtomView<'_>) -> Result<(u32, RadiusOrigin)> {
        debug_assert!(std::ptr::eq(atom.structure, self.structure), "names are those of one structure");
        if let Some(steps) = atom.atom.radius().filter(|_| self.radii.prefers_own) {
            return Ok((steps, RadiusOrigin::Own));
        }
        let kind = Kind {
            residue: atom.residue().name,
            atom: atom.atom.name,
            atomic_number: atom.atom.atomic_number,
        };
        match self.known.get(&kind) {
            Some(&found) => Ok(found),
            None => self.find_first(kind, atom),
        }
    }

    /// Finds the radius of the first atom of a kind.
    #[cold]
    fn find_first(&mut self, kind: Kind, atom: &AtomView<'_>) -> Result<(u32, RadiusOrigin)> {
        let [residue, name] = [atom.residue_name(), atom.name()].map(looked_up);
        let labels = Labels { residue: &residue, atom: &name };
        let element = Element::of_number(usize::from(kind.atomic_number));
        let of_table = self.radii.find(&labels, element).map(|steps| (steps, RadiusOrigin::Table));
        let found = of_table.or(self.radii.rest.map(|steps| (steps, RadiusOrigin::Else)));
        let found = found.ok_or_else(|| unknown(atom, element.is_some()))?;
        self.known.insert(kind, found);
        Ok(found)
    }
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
    let remedy = format!(
        "state it in a file for --radii, by a line \"{residue} {name} RADIUS\", or \"else RADIUS\" for all \
         such atoms, below \"table protor\" or another"
    );
    Error::usage(format!("no radius for atom {} {name} in {place}: {remedy}", atom.atom.serial))
        .of_input(&atom.structure.name)
}
