//! Builds a structure from atoms, in the order of a file.

use std::num::NonZeroU16;

use crate::molecules::assemblies::Assemblies;
use crate::molecules::classes::{Annotations, Class, Detail};
use crate::molecules::decimal::{Number, Quantum};
use crate::molecules::guess::Elements;
use crate::molecules::identity::Residues;
use crate::molecules::model::{Atom, Model, Residue, Structure};
use crate::molecules::names::{Name, Names};
use crate::molecules::periodic_box::{PeriodicBox, StatedBox};
use spmesh_base::error::{Error, Result};

/// An atom as stated by a file.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Record<'a> {
    /// Line in which it ends, counted from 1.
    pub(crate) line: u64,
    /// `None` if the file states none that can be parsed.
    pub(crate) serial: Option<u64>,
    pub(crate) name: &'a str,
    pub(crate) element: &'a str,
    pub(crate) altloc: &'a str,
    pub(crate) chain: &'a str,
    /// Part of the chain, and its entity, if the file names them.
    pub(crate) subchain: &'a str,
    pub(crate) entity: &'a str,
    /// Segment, as some PDB files name them.
    pub(crate) segment: &'a str,
    pub(crate) residue_name: &'a str,
    pub(crate) residue_number: Option<i32>,
    pub(crate) insertion_code: &'a str,
    pub(crate) occupancy: f32,
    pub(crate) is_hetatm: bool,
    /// Letters of the element's symbol at the start of the name, as the columns of the name in a PDB record
    /// tell; 0 if they do not, and in other formats.
    pub(crate) symbol_len: u8,
    pub(crate) place: [Number; 3],
    /// As [`Atom::radius`] has it.
    pub(crate) radius: Option<NonZeroU16>,
}

/// An oddity that is counted, and reported once at the end.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Oddity {
    /// A serial number that cannot be parsed.
    Serial,
    /// A residue number that cannot be parsed.
    ResidueNumber,
    /// An occupancy that is not a number.
    Occupancy,
    /// A model whose number cannot be parsed, or atoms between models.
    Model,
}

const ODDITIES: [(Oddity, &str, &str); 4] = [
    (Oddity::Serial, "serial numbers cannot be read", "they are counted on from the atom before"),
    (Oddity::ResidueNumber, "residue numbers cannot be read", "they are left out"),
    (Oddity::Occupancy, "occupancies are no numbers", "they are taken for 1"),
    (Oddity::Model, "models have no number, or no MODEL record", "they are counted on from the model before"),
];

/// A structure under construction. Memory: its content.
#[derive(Debug, Default)]
pub(crate) struct StructureBuilder {
    quantum: Quantum,
    models: Vec<Model>,
    /// Index of the model that receives atoms.
    model: usize,
    residues: Vec<Residue>,
    /// Which of them an atom is of.
    places: Residues,
    elements: Elements,
    /// What is known of each residue until its class is.
    details: Vec<Detail>,
    /// What the file states of its molecules.
    pub(crate) annotations: Annotations,
    pub(crate) assemblies: Assemblies,
    /// That of the atoms that follow.
    periodic_box: StatedBox,
    space_group: Option<String>,
    names: Names,
    /// First line and count of each oddity.
    oddities: [(u64, u64); ODDITIES.len()],
    warnings: Vec<String>,
    /// Line of the last atom.
    last_line: u64,
}

impl StructureBuilder {
    /// A structure without atoms for the next frame of a file: what the file states holds on.
    pub(crate) fn next_frame(&self) -> StructureBuilder {
        StructureBuilder {
            annotations: self.annotations.of_next_frame(),
            assemblies: self.assemblies.clone(),
            names: self.names.clone(),
            periodic_box: self.periodic_box.clone(),
            space_group: self.space_group.clone(),
            ..StructureBuilder::default()
        }
    }

    /// Whether it has an atom.
    pub(crate) fn has_atoms(&self) -> bool {
        self.models.iter().any(|model| !model.points.is_empty())
    }

    /// Starts a model.
    pub(crate) fn start_model(&mut self, number: i64) {
        self.model = self.models.len();
        self.models.push(Model { number, ..Model::default() });
        self.places.end();
        self.annotations.model_starts.push(self.residues.len());
    }

    /// Continues the last model with this number, or starts a new one.
    pub(crate) fn resume_model(&mut self, number: i64) {
        if self.models.get(self.model).is_some_and(|model| model.number == number) {
            return;
        }
        match self.models.iter().rposition(|model| model.number == number) {
            Some(model) => {
                self.model = model;
                self.places.end();
            }
            None => self.start_model(number),
        }
    }

    /// Number for a model without a number of its own.
    pub(crate) fn next_model_number(&self) -> i64 {
        self.models.last().map_or(1, |model| model.number.saturating_add(1))
    }

    /// The name of `text`.
    pub(crate) fn intern(&mut self, text: &str) -> Name {
        self.names.intern(text)
    }

    /// Ends the chain of the last residue.
    pub(crate) fn end_chain(&mut self) {
        self.places.end();
        self.annotations.chain_ends.push(self.residues.len());
    }

    /// Takes the box of the models that follow, `None` if they have none.
    pub(crate) fn set_box(&mut self, stated: Option<Result<PeriodicBox>>) {
        self.periodic_box = stated.map(|stated| stated.map_err(|fault| fault.to_string()));
    }

    /// As [`StructureBuilder::set_box`], for a box that is stated behind the atoms of all models, or of the
    /// last one.
    pub(crate) fn set_box_of(&mut self, is_of_all: bool, stated: Option<Result<PeriodicBox>>) {
        self.set_box(stated);
        let first = if is_of_all { 0 } else { self.model };
        for model in self.models.iter_mut().skip(first) {
            model.periodic_box = self.periodic_box.clone();
        }
    }

    /// Takes the space group of a crystal. That without symmetry is none.
    pub(crate) fn set_space_group(&mut self, name: &str) {
        let letters: String = name.chars().filter(|c| !c.is_whitespace()).collect();
        self.space_group = (!matches!(&letters[..], "" | "P1")).then(|| name.trim().to_string());
    }

    /// Counts an oddity in `line`.
    pub(crate) fn note(&mut self, oddity: Oddity, line: u64) {
        let (first, count) = &mut self.oddities[oddity as usize];
        if *count == 0 {
            *first = line;
        }
        *count += 1;
    }

    /// Adds a sentence to the warnings.
    pub(crate) fn warn(&mut self, warning: impl Into<String>) {
        self.warnings.push(warning.into());
    }

    /// Warns if the last atom's line is `unended`, the line without a line end: it may have lost its last
    /// columns.
    pub(crate) fn end(&mut self, unended: Option<u64>) {
        if unended.is_some_and(|line| line == self.last_line) {
            self.warn("the last atom's line has no line end: the file may have been cut off there");
        }
    }

    /// Adds an atom to the model.
    pub(crate) fn push(&mut self, record: &Record) -> Result<()> {
        if self.models.is_empty() {
            self.start_model(1);
        }
        self.last_line = record.line;
        let name = self.names.intern(record.name);
        let element = self.names.intern(record.element);
        let altloc = self.names.intern(record.altloc);
        let residue_name = self.names.intern(record.residue_name);
        let atomic_number =
            self.elements.number(&self.names, [residue_name, name, element], record.symbol_len);
        let detail = Detail {
            entity: self.names.intern(record.entity),
            atom: name,
            atomic_number,
            is_hetatm: record.is_hetatm,
            is_single: true,
        };
        let residue = self.residue(record, [residue_name, altloc], detail)?;
        let point = self.quantum.store(record.place, &mut self.models);
        let model = &mut self.models[self.model];
        if model.points.is_empty() {
            model.periodic_box = self.periodic_box.clone();
        }
        let after_last = || model.atoms.last().map_or(1, |atom| atom.serial.saturating_add(1));
        let atom = Atom {
            serial: record.serial.unwrap_or_else(after_last),
            residue,
            name,
            element,
            altloc,
            occupancy: record.occupancy,
            is_hetatm: record.is_hetatm,
            atomic_number,
            radius: record.radius,
        };
        model.points.push(point);
        model.atoms.push(atom);
        Ok(())
    }

    /// Index of the residue of an atom, which is a new one if this is its first.
    fn residue(&mut self, record: &Record, [name, altloc]: [Name; 2], detail: Detail) -> Result<u32> {
        let chain = self.names.intern(record.chain);
        let residue = Residue {
            chain,
            chain_number: 0,
            name,
            number: record.residue_number,
            insertion_code: self.names.intern(record.insertion_code),
            subchain: if record.subchain.is_empty() { chain } else { self.names.intern(record.subchain) },
            segment: Name::EMPTY,
            class: Class::default(),
        };
        let segment = self.names.intern(record.segment);
        let next = u32::try_from(self.residues.len())
            .map_err(|_| Error::malformed("more than 2^32 residues, the maximum"))?;
        let labels = (residue, segment, detail.entity);
        let index = self.places.place(labels, [detail.atom, altloc], next);
        match self.details.get_mut(index as usize) {
            Some(first) => first.is_single &= first.atom == detail.atom,
            None => {
                self.residues.push(Residue { segment, ..residue });
                self.details.push(detail);
            }
        }
        Ok(index)
    }

    /// The finished structure. Messages call it `name`.
    pub(crate) fn finish(mut self, name: &str) -> Result<Structure> {
        self.models.retain(|model| !model.points.is_empty());
        if self.models.is_empty() {
            return Err(Error::malformed("found no atom").of_input(name));
        }
        for (oddity, what, remedy) in ODDITIES {
            let (line, count) = self.oddities[oddity as usize];
            if count > 0 {
                self.warnings.push(format!("{count} {what}, the first in line {line}: {remedy}"));
            }
        }
        let (residues, details) = (&mut self.residues, &self.details);
        self.annotations.number_chains(residues, details, &self.names);
        self.annotations.classify(residues, details, &self.names);
        Ok(Structure {
            name: name.to_string(),
            coordinates: self.quantum.coordinates(),
            models: self.models,
            residues: self.residues,
            names: self.names,
            assemblies: self.assemblies,
            space_group: self.space_group,
            warnings: self.warnings,
        })
    }
}

/// A name from a file, if it is printable text without line ends and tabs.
pub(crate) fn printable<'a>(bytes: &'a [u8], what: &str) -> Result<&'a str> {
    let is_printable = bytes.iter().all(|&byte| byte >= b' ' && byte != 0x7f);
    let text = if is_printable { std::str::from_utf8(bytes).ok() } else { None };
    text.ok_or_else(|| crate::twin::tokens::unexpected(bytes, &format!("{what} in printable characters")))
}
