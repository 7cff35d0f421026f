//! Spatial finalization of points (thesis 5.2): from points in any order to a stream that says, as early as
//! the input allows, which cells of the plane or of space no later point lies in.
//!
//! Pass 1 finds the bounding box, or takes it from the headers of the input. Pass 2 counts points per cell
//! (`count`), on a grid as fine as the memory for counters allows; crowded cells are counted again, finer
//! (`survey`). The counts decide the leaves of the finalization tree (`plan`). Pass 3 writes the points and
//! tags a leaf when its counter reaches zero (`emit`): either in input order, or chunked, and then points
//! wait in pages (`pages`) within the memory budget, and beyond it in a temporary file (`spill`).
//!
//! How many points wait in memory and how many on disk does not show in the result. Counters are 64 bits wide.

mod budget;
mod buffer;
pub mod cell_grid;
mod count;
mod emit;
mod locate;
mod pages;
mod plan;
mod read_ahead;
mod spill;
mod spool;
mod stats;
mod survey;
mod work;

use std::io::Write;
use std::path::PathBuf;

pub use budget::Budget;
pub use spool::Spooling;
pub use stats::Stats;

use spmesh_core::error::{Error, ErrorKind, Result};
use spmesh_core::limits::{OCTREE_DEPTH_MAX, QUADTREE_DEPTH_MAX};
use spmesh_io::source::{Description, Input, PointReader};
use work::Work;

/// Points that a leaf holds about, unless the user says otherwise.
pub const CELL_POINTS: u64 = 20_000;

/// An input that can be read from its start as often as needed, the same every time.
pub trait Passes {
    /// What is known before reading.
    fn description(&self) -> &Description;

    /// Starts a pass.
    ///
    /// # Errors
    /// If the input cannot be opened.
    fn read(&self) -> Result<Box<dyn PointReader + '_>>;

    /// Whether decoding costs more than writing decoded points to disk and reading them back.
    fn is_costly(&self) -> bool {
        false
    }

    /// What messages call the input, if it has a name.
    fn name(&self) -> Option<String> {
        None
    }
}

/// Which cells are leaves of the finalization tree.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Leaves {
    /// Cells that hold at most `cell_points` (or cannot be divided) and whose parent holds more; none deeper
    /// than `level_max`. Sparse siblings are thus collapsed into their parent (option m of the thesis).
    Collapsed {
        /// Most points in a leaf that could be divided.
        cell_points: u64,
        /// Deepest level, if it is limited.
        level_max: Option<u8>,
    },
    /// All occupied cells of one level: the grid of 2^k x 2^k cells of the thesis.
    Level(u8),
}

/// The order of the points in the result.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Order {
    /// The points of a leaf stand together, in input order, right before its tag.
    Chunked,
    /// All points keep their order; tags are inserted.
    Preserved,
}

/// What to do.
#[derive(Debug, Clone)]
pub struct Options {
    /// Which cells become leaves.
    pub leaves: Leaves,
    /// In which order points are written.
    pub order: Order,
    /// Memory for counters, leaves and waiting points.
    pub budget: Budget,
    /// Where waiting points go when the budget is used up, and points that are kept for later passes; the
    /// system's folder for temporary files if `None`.
    pub temp_dir: Option<PathBuf>,
    /// When decoded points are kept for later passes.
    pub spooling: Spooling,
}

impl Options {
    fn check(&self, dims: u8) -> Result<()> {
        let depth_max = depth_max(dims);
        match self.leaves {
            Leaves::Level(level) | Leaves::Collapsed { level_max: Some(level), .. } if level > depth_max => {
                Err(Error::usage(format!(
                    "level {level} is too deep: the deepest in {dims} dimensions is {depth_max}"
                )))
            }
            Leaves::Collapsed { cell_points: 0, .. } => {
                Err(Error::usage("a leaf must be allowed to hold at least one point"))
            }
            _ => Ok(()),
        }
    }
}

/// Deepest level of a tree.
fn depth_max(dims: u8) -> u8 {
    if dims == 2 { QUADTREE_DEPTH_MAX } else { OCTREE_DEPTH_MAX }
}

/// The passes over the input.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Pass {
    /// Finding the bounding box.
    Bounds,
    /// Counting points per cell.
    Count,
    /// Counting the points of crowded cells on a finer grid.
    Refine,
    /// Writing points and tags.
    Write,
}

impl Pass {
    /// Name for people and for JSON.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Pass::Bounds => "bounds",
            Pass::Count => "count",
            Pass::Refine => "refine",
            Pass::Write => "write",
        }
    }
}

/// Hears of the work while it goes on; `()` does not listen.
pub trait Observer {
    /// A pass starts; the input has `total` points, where that is known.
    fn pass(&mut self, _pass: Pass, _total: Option<u64>) {}

    /// So many points of the pass are done.
    fn done(&mut self, _points: u64) {}

    /// Something that the user should know.
    fn notice(&mut self, _message: &str) {}
}

impl Observer for () {}

/// Reads `input` two or more times and writes its finalized point stream, END included, to `output`.
///
/// Without points the stream has neither bounds nor tree. Where the extent of the points is so large that no
/// cube around them is finite, it has no tree, no tags, and keeps the input order.
///
/// Memory: the budget, on any input, and a few batches of the reader.
///
/// # Errors
/// What the input fails with; [`spmesh_core::error::ErrorKind::Malformed`] if it changes between passes;
/// [`spmesh_core::error::ErrorKind::Memory`] if the budget is too small for the counters or leaves asked for;
/// I/O if output or temporary file cannot be written.
pub fn run<P: Passes + ?Sized, W: Write>(
    input: &P,
    options: &Options,
    observer: &mut dyn Observer,
    output: W,
) -> Result<Stats> {
    options.check(input.description().dims)?;
    let mut work = Work::new(input, options, observer);
    work.write(options, output).map_err(|error| match input.name() {
        // What has no name by now and breaks promises is the input as a whole.
        Some(name) if error.kind() == ErrorKind::Malformed => error.of_input(name),
        _ => error,
    })?;
    Ok(work.stats)
}

impl Passes for Input {
    fn description(&self) -> &Description {
        Input::description(self)
    }

    fn read(&self) -> Result<Box<dyn PointReader + '_>> {
        Input::read(self)
    }

    fn is_costly(&self) -> bool {
        Input::is_costly(self)
    }

    fn name(&self) -> Option<String> {
        Some(Input::name(self))
    }
}
