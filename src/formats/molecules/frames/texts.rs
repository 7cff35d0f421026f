//! Texts that hold one structure after the other: each frame is a structure of its own.

use super::{Content, Frames};
use crate::drivers::AnyInput;
use crate::molecules::builder::StructureBuilder;
use crate::molecules::pdb::{PdbReader, is_model};
use crate::molecules::{gro, xyz};
use crate::text::lines::Lines;
use spmesh_base::error::Result;
use spmesh_base::limits::STRUCTURE_LINE_MAX;

/// Reads a frame; false at the end of the input.
type ReadFrame = fn(&mut Lines<AnyInput>, &mut StructureBuilder) -> Result<bool>;

pub(crate) fn open_gro(input: AnyInput, name: &str) -> Result<Box<dyn Frames>> {
    Ok(Box::new(TextFrames { lines: lines(input, name), name: name.to_string(), read: gro::read_frame }))
}

pub(crate) fn open_xyz(input: AnyInput, name: &str) -> Result<Box<dyn Frames>> {
    Ok(Box::new(TextFrames { lines: lines(input, name), name: name.to_string(), read: xyz::read_frame }))
}

pub(crate) fn open_pdb(input: AnyInput, name: &str) -> Result<Box<dyn Frames>> {
    Ok(Box::new(PdbFrames::new(lines(input, name), name, false)))
}

pub(crate) fn open_pqr(input: AnyInput, name: &str) -> Result<Box<dyn Frames>> {
    Ok(Box::new(PdbFrames::new(lines(input, name), name, true)))
}

fn lines(input: AnyInput, name: &str) -> Lines<AnyInput> {
    Lines::with_longest(input, name, STRUCTURE_LINE_MAX)
}

/// Frames that say how many lines they have: GRO, XYZ.
struct TextFrames {
    lines: Lines<AnyInput>,
    name: String,
    read: ReadFrame,
}

impl Frames for TextFrames {
    fn next(&mut self, _: Option<u64>) -> Result<Option<Content>> {
        let mut builder = StructureBuilder::default();
        if !(self.read)(&mut self.lines, &mut builder)? {
            return Ok(None);
        }
        builder.end(self.lines.unended());
        builder.finish(&self.name).map(|structure| Some(Content::Structure(Box::new(structure))))
    }
}

/// Models of PDB, from one end of a model to the next. What comes before the first holds for all.
struct PdbFrames {
    lines: Lines<AnyInput>,
    name: String,
    reader: PdbReader,
    builder: StructureBuilder,
    /// Whether the current line begins the next model.
    is_begun: bool,
}

impl PdbFrames {
    fn new(lines: Lines<AnyInput>, name: &str, is_pqr: bool) -> PdbFrames {
        let (reader, builder) = (PdbReader::new(is_pqr), StructureBuilder::default());
        PdbFrames { lines, name: name.to_string(), reader, builder, is_begun: false }
    }

    /// Reads up to the end of a model that has atoms; false if there is none.
    fn read(&mut self) -> Result<bool> {
        while self.is_begun || self.lines.next_line()?.is_some() {
            let has_atoms = self.builder.has_atoms();
            self.is_begun = has_atoms && is_model(self.lines.current());
            if self.is_begun {
                return Ok(true);
            }
            self.reader.read_line(&self.lines, &mut self.builder)?;
            if has_atoms && self.reader.is_closed() {
                return Ok(true);
            }
        }
        self.builder.end(self.lines.unended());
        Ok(self.builder.has_atoms())
    }
}

impl Frames for PdbFrames {
    fn next(&mut self, _: Option<u64>) -> Result<Option<Content>> {
        if !self.read()? {
            return Ok(None);
        }
        let next = self.builder.next_frame();
        let builder = std::mem::replace(&mut self.builder, next);
        self.reader.end_model();
        builder.finish(&self.name).map(|structure| Some(Content::Structure(Box::new(structure))))
    }
}
