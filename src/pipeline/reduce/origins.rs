//! Where the residuals of merged parts come from, for messages.

use std::io::Read;

use super::misfit::Misfit;
use spmesh_base::error::{Error, ErrorKind};
use spmesh_stream::{Event, StreamReader};

/// The blocks that residual points and walls come from, in the order in which they are united.
///
/// Memory: one entry for each block of residual points or walls.
#[derive(Debug, Default)]
pub(super) struct Origins {
    names: Vec<String>,
    points: Vec<Start>,
    walls: Vec<Start>,
    counts: [u64; 2],
}

/// How the user finds the fault.
const REMEDY: &str = "spinfo --audit says what is wrong with the part";

/// The first residual point or wall of a block.
#[derive(Debug)]
struct Start {
    first: u64,
    /// Number of the input.
    input: usize,
    /// Where the block is in it.
    place: String,
}

impl Origins {
    /// Begins the next input.
    pub(super) fn begin(&mut self, name: &str) {
        self.names.push(name.to_string());
    }

    /// Takes note of a block of the input that was begun last; `corners` is the number of corners of a wall.
    pub(super) fn note<R: Read>(&mut self, event: &Event, corners: usize, reader: &StreamReader<R>) {
        let (starts, count, new) = match event {
            Event::ResidualPoints(points) => (&mut self.points, &mut self.counts[0], points.len()),
            Event::Walls(walls) => (&mut self.walls, &mut self.counts[1], walls.len() / corners),
            _ => return,
        };
        if new > 0 {
            starts.push(Start { first: *count, input: self.names.len() - 1, place: reader.place() });
            *count += new as u64;
        }
    }

    /// Adds input and block to an error about a point or a wall of the united residual.
    pub(super) fn locate(&self, error: Error, misfit: Option<Misfit>) -> Error {
        let point = |number: u32| self.find(&self.points, u64::from(number));
        match misfit.filter(|_| error.kind() == ErrorKind::Malformed) {
            None => error,
            Some(Misfit::Wall(wall)) => at(error.noting(REMEDY), self.find(&self.walls, wall as u64)),
            Some(Misfit::Point(number)) => at(error.noting(REMEDY), point(number)),
            Some(Misfit::Points([one, other])) => {
                let note = point(other).map_or(String::new(), |(name, place)| format!("of {name}: {place}"));
                at(error.noting(&format!("the other point is {note}")), point(one))
            }
        }
    }

    /// Name of the input and place of the block of a point or wall.
    fn find<'a>(&'a self, starts: &'a [Start], number: u64) -> Option<(&'a str, &'a str)> {
        let block = starts.partition_point(|start| start.first <= number).checked_sub(1)?;
        let Start { input, place, .. } = &starts[block];
        Some((&self.names[*input], place))
    }
}

fn at(error: Error, origin: Option<(&str, &str)>) -> Error {
    match origin {
        Some((name, place)) => error.at(place).of_input(name),
        None => error,
    }
}
