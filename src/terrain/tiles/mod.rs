//! `sptiles`: pyramids of tiles for viewers of the Earth. Why tiles fit together: `docs/theory/tiles.md`.
//!
//! `pyramid` makes the levels: `simplify` chooses the vertices of each, `earth` places them, `clip` cuts
//! triangles along the borders of `scheme`, and `buckets` holds the parts of each tile. `tile_mesh` indexes a
//! tile, which `layer` writes by `quantized`, or `tileset` as glTF. `available` says which tiles there are.

mod available;
mod buckets;
mod clip;
mod earth;
mod layer;
mod pyramid;
mod quantized;
mod scheme;
mod tile_mesh;
mod tileset;

pub use pyramid::{LEVEL_MAX, LevelStats, Options, Target, write};
pub use scheme::Scheme;

use std::io::Write;
use std::path::Path;

use scheme::Tile;
use spmesh_base::error::{Error, Result};
use spmesh_base::output::{Output, create_folder, sync_files};

/// Makes the folder of a pyramid, which its description of this name will make whole.
///
/// # Errors
/// Usage, if an earlier pyramid is there: replaced tile by tile, it would be neither until the end.
fn start(folder: &Path, description: &str) -> Result<()> {
    create_folder(folder)?;
    if folder.join(description).symlink_metadata().is_ok() {
        let what = format!("a pyramid with {description} is there: remove the folder, or give another one");
        return Err(Error::usage(what).of_input(folder.display().to_string()));
    }
    Ok(())
}

/// Writes the file of a tile, as LEVEL/X/Y.ENDING in a folder.
/// It counts only if the description of the pyramid is there, which `write_description` writes.
fn write_tile(folder: &Path, level: u32, tile: Tile, ending: &str, bytes: &[u8]) -> Result<()> {
    let folder = folder.join(format!("{level}/{}", tile.x));
    create_folder(&folder)?;
    written(&folder.join(format!("{}.{ending}", tile.y)), bytes)?.commit_unsynced()
}

/// Writes the file that makes the pyramid in a folder whole.
fn write_description(folder: &Path, name: &str, bytes: &[u8]) -> Result<()> {
    sync_files(folder)?;
    written(&folder.join(name), bytes)?.commit()
}

fn written(path: &Path, bytes: &[u8]) -> Result<Output> {
    let mut output = Output::create(path, true)?;
    output.write_all(bytes).map_err(|e| Error::io("writing", e))?;
    Ok(output)
}
