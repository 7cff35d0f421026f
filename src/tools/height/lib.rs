//! `spheight`: heights of points above a triangle mesh of the ground.
//!
//! `ground` puts the triangles of the mesh into blocks of neighbours (`blocks`), in a temporary file. For a batch of
//! points, the blocks around them come back one by one, and each triangle meets the points near it
//! (`point_grid`). `surface` has the elevation at a place of a triangle; `nearest` finds the place nearest to a
//! point outside of the mesh. `files` reads and writes LAS and LAZ files; `points`
//! holds heights for `spcanopy`.

mod blocks;
mod files;
mod ground;
mod nearest;
mod point_grid;
mod points;
mod surface;

pub use files::{Counts, FileOptions, HeightPlace, write_heights};
pub use ground::{Ground, Outside, Unit};
pub use points::{HeightPoints, LayerReader};
