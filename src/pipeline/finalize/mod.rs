//! Spatial finalization of points (thesis 5.2): from points in any order to a stream that tells, as early as
//! the input allows, which cells of the plane or of space contain no later point.
//!
//! Pass 1 finds the bounding box, or takes it from the headers of the input. Pass 2 counts points per cell
//! (`counters`), on a grid as fine as the memory for counters allows; crowded cells are counted again on
//! finer grids (`count_pass`). The counts decide the leaves of the finalization tree (`plan`). Pass 3 writes
//! the points, and tags a leaf when its counter reaches zero (`emit`). The points keep their order, or come
//! in chunks; then they wait in pages of memory (`pages`) within the budget, and beyond it in a temporary
//! file (`spill`). Cells that get no points for long may wait there in any case (`cold`).
//!
//! If points are to be thinned, a pass before these finds which ones are kept (`thin`).
//!
//! Polygons may say which points count (`select`), and the points near shores tell the levels of water
//! (`shores`).
//!
//! Points may be added to those of the input, such as the vertices of lines (`added`), which are compared
//! with those around them (`relief`). A [`Recipe`] is a whole run over files.
//!
//! The result does not depend on how many points wait in memory or on disk. Counters have 64 bits.

mod added;
mod banks;
mod batch;
mod budget;
mod buffer;
pub mod cell_grid;
mod cold;
mod count_pass;
mod counters;
mod emit;
mod flatten;
mod in_regions;
mod locate;
mod no_points;
mod options;
mod pages;
mod passes;
mod plan;
mod recipe;
mod relief;
mod run;
mod scatter;
mod select;
mod shores;
mod spill;
mod spool;
mod thin;
mod weigh;
mod work;

pub use banks::Banks;
pub use budget::Budget;
pub use flatten::Flatten;
pub use options::{CELL_POINTS, InRegions, Leaves, Options, Order, REGION_POINTS, WhenRegions};
pub use passes::{Observer, Pass, Passes};
pub use recipe::{Drops, LineStats, Outcome, Recipe};
pub use run::{Stats, run};
pub use spool::Spooling;
pub use thin::{Thin, ThinBy};
pub use weigh::Weighing;
