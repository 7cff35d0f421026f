//! `spheight`: heights of points above a triangle mesh of the ground.
//!
//! `ground` puts the triangles of the mesh into blocks of neighbours, in a temporary file (`block_writer`).
//! For a batch of points, `heights` reads the blocks around them one by one (`blocks`), and each triangle
//! meets the points near it (`point_grid`). `surface` has the elevation at a place of a triangle; `nearest`
//! finds the place nearest to a point outside of the mesh. `files` reads and writes LAS and LAZ files, `text`
//! text and streams; `points` holds heights for `spcanopy`.

mod block_writer;
mod blocks;
mod boxes;
mod files;
mod ground;
mod heights;
mod nearest;
mod point_grid;
mod points;
mod surface;
mod text;

pub(crate) use blocks::{Blocks, LoadedBlock, Triangle};
pub(crate) use boxes::Box2;
pub use files::{Counts, FileOptions, HeightPlace, write_heights};
pub(crate) use files::{rewrite, stored_point};
pub use ground::Ground;
pub use heights::{Heights, Outside, Slopes, Unit};
pub(crate) use points::unit_of;
pub use points::{HeightCounts, HeightPoints, LayerReader, Surface};
pub use text::{write_stream_heights, write_text_heights};

/// A warning if most of some points are `below` the ground, which happens when z is not the elevation that it
/// is taken for.
pub fn about_below(below: u64, points: u64) -> Option<String> {
    let is_odd = below > points / 2;
    is_odd.then(|| {
        let why = "their z may be heights already, or in another unit";
        format!("{below} of {points} points are below the ground: {why}")
    })
}
