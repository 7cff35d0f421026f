//! Molecules frame by frame: trajectories, whose atoms another file names, and texts that hold one structure
//! after the other. Memory: one frame.

pub(crate) mod dcd;
mod range;
pub(crate) mod texts;
pub(crate) mod trr;
mod words;
pub(crate) mod xtc;

#[cfg(test)]
mod tests;

use std::collections::VecDeque;
use std::io::Read;
use std::path::Path;
use std::time::{Duration, Instant};

pub use range::FrameRange;

use crate::detect;
use crate::drivers::{AnyInput, Format};
use crate::molecules::model::{Model, Structure};
use crate::molecules::periodic_box::{PeriodicBox, StatedBox};
use crate::molecules::selection::Selection;
use crate::molecules::{finished, opened, plain_with_head};
use spmesh_base::error::{Error, Result};
use spmesh_stream::Coordinates;
use spmesh_stream::model::points::Point3;

/// A source of frames.
pub(crate) trait Frames: Send {
    /// The next frame; `None` at the end. `atoms` is the number that it must have, if that is known.
    fn next(&mut self, atoms: Option<u64>) -> Result<Option<Content>>;

    /// Passes over a frame; false at the end.
    fn skip(&mut self) -> Result<bool> {
        Ok(self.next(None)?.is_some())
    }

    /// Where the reader is, for messages.
    fn position(&self) -> Option<String> {
        None
    }
}

/// What a frame holds.
#[derive(Debug)]
pub enum Content {
    /// Positions of atoms that another file names.
    Points(Positions),
    /// A model of a structure whose residues are known.
    Model(Model),
    /// A structure with one model.
    Structure(Box<Structure>),
}

/// Positions of atoms, as a structure stores them, and the periodic box.
#[derive(Debug)]
pub struct Positions {
    points: Vec<Point3>,
    coordinates: Coordinates,
    periodic_box: StatedBox,
}

impl Positions {
    fn new(
        (points, coordinates): (Vec<Point3>, Coordinates),
        stated: Option<Result<PeriodicBox>>,
    ) -> Positions {
        let periodic_box = stated.map(|stated| stated.map_err(|fault| fault.to_string()));
        Positions { points, coordinates, periodic_box }
    }

    fn of_model(model: Model, coordinates: Coordinates) -> Positions {
        Positions { points: model.points, coordinates, periodic_box: model.periodic_box }
    }
}

/// A frame.
#[derive(Debug)]
pub struct Frame {
    /// Its place in the file, from 0.
    pub place: u64,
    /// Its number: its place or, of models, that of the file.
    pub number: i64,
    /// What it holds.
    pub content: Content,
    /// The time that reading it took.
    pub read: Duration,
}

/// The frames of a file, in a range of them.
pub struct FrameReader {
    frames: Box<dyn Frames>,
    /// Name in messages.
    name: String,
    range: FrameRange,
    /// Number of the next frame.
    next: u64,
    /// The structure that names the atoms, if the frames do not.
    topology: Option<Structure>,
    /// Frames have the numbers of models.
    are_models: bool,
}

impl FrameReader {
    /// Opens the frames of `path`; "-" is standard input. `topology` names the atoms: its first model.
    ///
    /// # Errors
    /// If the file cannot be read; usage, if its frames do not name their atoms, and no topology does;
    /// malformed, if the file has no frames.
    pub fn open(
        path: &Path,
        format: Option<Format>,
        range: FrameRange,
        topology: Option<&Structure>,
    ) -> Result<FrameReader> {
        let (input, name) = opened(path)?;
        FrameReader::of_input(input, name, format, range, topology)
    }

    /// As [`FrameReader::open`], from any reader. Messages call the input `name`.
    ///
    /// # Errors
    /// As [`FrameReader::open`].
    pub fn of_input(
        input: impl Read + Send + 'static,
        name: String,
        format: Option<Format>,
        range: FrameRange,
        topology: Option<&Structure>,
    ) -> Result<FrameReader> {
        // Atoms are those of the frames.
        let of_frames =
            |topology: &Structure| Structure { name: name.clone(), ..first_model(topology.clone()) };
        let topology = topology.map(of_frames);
        let (head, input) = plain_with_head(input, &name)?;
        let format = format.map_or_else(|| detect::detect(&head), Ok).map_err(|e| e.of_input(&name))?;
        let Some(open) = format.row().frames else {
            if format.row().atoms.is_none() {
                let message = format!("this is {}, which has no frames of atoms", format.name());
                return Err(Error::malformed(message).of_input(&name));
            }
            return Ok(FrameReader::of_structure(finished(format, input, &name)?, range, topology));
        };
        if topology.is_none() && format.row().atoms.is_none() {
            let message = format!("{} names no atoms: give a structure that does, --top FILE", format.name());
            return Err(Error::usage(message).of_input(&name));
        }
        let frames = open(input, &name).map_err(|e| e.of_input(&name))?;
        Ok(FrameReader { frames, name, range, next: 0, topology, are_models: false })
    }

    /// The models of a structure that is in memory, as frames.
    fn of_structure(mut structure: Structure, range: FrameRange, topology: Option<Structure>) -> FrameReader {
        let models = std::mem::take(&mut structure.models).into();
        let name = structure.name.clone();
        let frames = InMemory { models, coordinates: structure.coordinates };
        let topology = Some(topology.unwrap_or(structure));
        FrameReader { frames: Box::new(frames), name, range, next: 0, topology, are_models: false }
    }

    /// The selected models of a structure, with the numbers of the file.
    ///
    /// # Errors
    /// Usage, if the structure has none.
    pub fn of_models(mut structure: Structure, selection: &Selection) -> Result<FrameReader> {
        let wanted = structure.models_of(selection)?;
        let mut place = 0..;
        structure.models.retain(|_| place.next().is_some_and(|place| wanted.contains(&place)));
        let frames = FrameReader::of_structure(structure, FrameRange::default(), None);
        Ok(FrameReader { are_models: true, ..frames })
    }

    /// Name of the input in messages.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Whether the range has one frame.
    pub fn is_single(&self) -> bool {
        self.range.is_single()
    }

    /// The structure that names the atoms of frames of points and of models.
    pub fn topology(&self) -> Option<&Structure> {
        self.topology.as_ref()
    }

    /// The next frame of the range; `None` after the last.
    ///
    /// # Errors
    /// If reading fails; malformed, with the frame, if the file is damaged or was cut off; usage, if the range
    /// has no frame, or a frame has another number of atoms than the topology.
    pub fn next_frame(&mut self) -> Result<Option<Frame>> {
        let started = Instant::now();
        while !self.range.contains(self.next) {
            if self.range.is_past(self.next) || !self.frames.skip().map_err(|e| self.locate(e))? {
                return self.ended();
            }
            self.next += 1;
        }
        let model = self.topology.as_ref().and_then(|topology| topology.models.first());
        let atoms = model.map(|model| model.points.len() as u64);
        let Some(content) = self.frames.next(atoms).map_err(|e| self.locate(e))? else {
            return self.ended();
        };
        let place = self.next;
        self.next += 1;
        let content = match (content, atoms) {
            (Content::Structure(structure), Some(_)) => {
                let coordinates = structure.coordinates;
                let model = first_model(*structure).models.swap_remove(0);
                Content::Points(Positions::of_model(model, coordinates))
            }
            (content, _) => content,
        };
        if let (Content::Points(positions), Some(atoms)) = (&content, atoms) {
            check_count(positions.points.len() as u64, atoms)
                .map_err(|e| e.at(format!("frame {place}")).of_input(&self.name))?;
        }
        let number = match &content {
            Content::Model(model) if self.are_models => model.number,
            _ => place as i64,
        };
        Ok(Some(Frame { place, number, content, read: started.elapsed() }))
    }

    /// The end, unless no frame was in the range.
    fn ended(&self) -> Result<Option<Frame>> {
        if self.next > self.range.first() {
            return Ok(None);
        }
        let message = match self.next {
            0 => return Err(Error::malformed("found no frame").of_input(&self.name)),
            frames => format!("has {frames} frames, counted from 0: none is in {}", self.range),
        };
        Err(Error::usage(message).of_input(&self.name))
    }

    /// Adds the frame and the place to an error.
    fn locate(&self, error: Error) -> Error {
        let position = self.frames.position().map_or(String::new(), |position| format!(" at {position}"));
        error.at(format!("frame {}{position}", self.next)).of_input(&self.name)
    }
}

/// Checks the number of atoms of a frame against that of the topology.
///
/// # Errors
/// Usage, with both numbers.
pub(crate) fn check_count(found: u64, expected: u64) -> Result<()> {
    if found == expected {
        return Ok(());
    }
    Err(Error::usage(format!("the frame has {found} atoms, the topology {expected}: they do not fit")))
}

/// The structure without all models but the first.
fn first_model(mut structure: Structure) -> Structure {
    structure.models.truncate(1);
    structure
}

impl Frame {
    /// Puts the atoms in the place of those of `structure`, which is the topology or what an earlier frame of
    /// the same file made of it.
    ///
    /// # Panics
    /// If the frame needs a topology, and there is none.
    pub fn put(self, structure: &mut Option<Structure>) -> &mut Structure {
        let Frame { number, content, .. } = self;
        let structure = match content {
            Content::Structure(own) => structure.insert(first_model(*own)),
            Content::Points(Positions { points, coordinates, periodic_box }) => {
                let structure = structure.as_mut().expect("points have a topology");
                structure.coordinates = coordinates;
                let model = &mut structure.models[0];
                (model.points, model.periodic_box) = (points, periodic_box);
                structure
            }
            Content::Model(model) => {
                let structure = structure.as_mut().expect("models have residues");
                structure.models = vec![model];
                structure
            }
        };
        structure.models[0].number = number;
        structure
    }
}

/// Models that are in memory.
struct InMemory {
    models: VecDeque<Model>,
    coordinates: Coordinates,
}

impl Frames for InMemory {
    fn next(&mut self, atoms: Option<u64>) -> Result<Option<Content>> {
        let Some(model) = self.models.pop_front() else { return Ok(None) };
        Ok(Some(match atoms {
            Some(_) => Content::Points(Positions::of_model(model, self.coordinates)),
            None => Content::Model(model),
        }))
    }
}

/// What opens the frames of an input. Messages call it the second argument.
pub(crate) type OpenFrames = fn(AnyInput, &str) -> Result<Box<dyn Frames>>;
