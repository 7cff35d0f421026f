//! Options of a run.

use std::num::NonZeroUsize;
use std::path::PathBuf;

use super::budget::Budget;
use super::spool::Spooling;
use super::thin::Thin;
use spmesh_base::error::{Error, Result};
use spmesh_base::limits::{OCTREE_DEPTH_MAX, QUADTREE_DEPTH_MAX};
use spmesh_stream::Weighted;

/// Approximate number of points in a leaf, unless the user chooses another.
pub const CELL_POINTS: u64 = 20_000;

/// Approximate number of points in a region, unless the user chooses another.
pub const REGION_POINTS: u64 = 1_000_000;

/// Which cells are leaves of the finalization tree.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Leaves {
    /// Cells that hold at most `cell_points` (or cannot be divided) and whose parent holds more; none deeper
    /// than `level_max`. Sparse siblings thus collapse into their parent (option m of the thesis).
    Collapsed {
        /// Most points in a leaf that could be divided.
        cell_points: u64,
        /// Deepest level, if it is limited.
        level_max: Option<u8>,
    },
    /// All occupied cells of one level: the grid of 2^k x 2^k cells of the thesis.
    Level(u8),
}

impl Leaves {
    /// Leaves of points that come in regions, which may be larger.
    pub(super) fn of_regions(self) -> Leaves {
        match self {
            Leaves::Collapsed { cell_points, level_max } => {
                Leaves::Collapsed { cell_points: cell_points.min(CELL_POINTS), level_max }
            }
            Leaves::Level(_) => self,
        }
    }
}

/// When points of space come in overlapping regions instead of cells.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum WhenRegions {
    /// If a sample of them lies on a surface, and they are too many for one region.
    Auto,
    /// Always.
    Always,
    /// Never.
    #[default]
    Never,
}

/// Regions, and the work on them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct InRegions {
    /// When points come in regions.
    pub when: WhenRegions,
    /// About how many points a region has, those of other regions included.
    pub points: u64,
    /// Threads that find the regions of points.
    pub threads: NonZeroUsize,
}

impl InRegions {
    /// Cells only.
    pub const NEVER: InRegions =
        InRegions { when: WhenRegions::Never, points: REGION_POINTS, threads: NonZeroUsize::MIN };
}

/// The order of the points in the result.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Order {
    /// The points of a leaf stand together, in input order, right before its tag.
    Chunked,
    /// All points keep their order; tags are inserted.
    Preserved,
}

/// Options of a run.
#[derive(Debug, Clone)]
pub struct Options {
    /// Which cells become leaves.
    pub leaves: Leaves,
    /// The order of the points in the result.
    pub order: Order,
    /// Whether the blocks of the result are compressed.
    pub compress: bool,
    /// Whether only one point per cell is kept.
    pub thin: Option<Thin>,
    /// Memory for counters, leaves and waiting points.
    pub budget: Budget,
    /// Folder for waiting points that exceed the budget, and for points that are kept for later passes; the
    /// system's folder for temporary files if `None`.
    pub temp_dir: Option<PathBuf>,
    /// When decoded points are kept for later passes.
    pub spooling: Spooling,
    /// Whether points of space come in regions: only in [`Order::Chunked`] and without weights.
    pub regions: InRegions,
    /// What the header says of the weights of points.
    pub weighted: Option<Weighted>,
}

impl Options {
    /// Checks the options against the number of dimensions.
    pub(super) fn check(&self, dims: u8) -> Result<()> {
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
            _ if self.regions.when == WhenRegions::Always => self.check_regions(dims),
            _ => Ok(()),
        }
    }
}

impl Options {
    /// Whether points may come in regions.
    pub(super) fn may_have_regions(&self, dims: u8) -> bool {
        self.regions.when != WhenRegions::Never && self.check_regions(dims).is_ok()
    }

    fn check_regions(&self, dims: u8) -> Result<()> {
        let why = match (dims, self.order, self.weighted) {
            (2, ..) => "points in regions are points of space: give --octree",
            (_, Order::Preserved, _) => "points in regions cannot keep their order",
            (_, _, Some(_)) => "points in regions have no weights",
            _ => return Ok(()),
        };
        Err(Error::usage(why))
    }
}

/// Deepest level of a tree.
pub(super) fn depth_max(dims: u8) -> u8 {
    if dims == 2 { QUADTREE_DEPTH_MAX } else { OCTREE_DEPTH_MAX }
}
