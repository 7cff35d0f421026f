//! Tiles in quantized-mesh 1.0, and `layer.json`, which says which there are.
//!
//! Sources: the specification of quantized-mesh-1.0 with its extensions; TileJSON 2.1 and the members beside
//! it that viewers of terrain read (`available`, `metadataAvailability`).

use std::path::PathBuf;

use serde_json::json;

use super::available::{Rectangle, below, of_levels, rectangles};
use super::pyramid::{Options, Ready};
use super::quantized::{append_metadata, encode};
use super::scheme::{Scheme, Tile};
use super::{start, write_description, write_tile, written};
use spmesh_base::error::Result;

/// Tiles of every so many levels say which tiles there are below.
const METADATA_LEVELS: u32 = 10;

const ENDING: &str = "terrain";

pub(super) struct Layer {
    folder: PathBuf,
    scheme: Scheme,
    has_normals: bool,
    has_page: bool,
    levels: u32,
    available: Vec<Vec<Rectangle>>,
    /// Tiles that wait for what is below them.
    held: Vec<(u32, Tile, Vec<u8>)>,
    bounds: [f64; 4],
}

impl Layer {
    pub(super) fn new(options: &Options, levels: u32) -> Result<Layer> {
        start(&options.folder, "layer.json")?;
        let Options { folder, scheme, has_normals, has_page, .. } = options.clone();
        let bounds = [f64::INFINITY, f64::INFINITY, f64::NEG_INFINITY, f64::NEG_INFINITY];
        Ok(Layer {
            folder,
            scheme,
            has_normals,
            has_page,
            levels,
            available: Vec::new(),
            held: Vec::new(),
            bounds,
        })
    }

    /// Writes a tile, and returns its length.
    pub(super) fn tile(&mut self, ready: &Ready) -> Result<u64> {
        let bytes = encode(ready.mesh, ready.power, ready.normals.as_deref());
        let len = bytes.len() as u64;
        if ready.level + 1 == self.levels {
            let [west, south, east, north] = &mut self.bounds;
            for &[longitude, latitude, _] in &ready.mesh.places {
                (*west, *south) = (west.min(longitude), south.min(latitude));
                (*east, *north) = (east.max(longitude), north.max(latitude));
            }
        }
        if ready.level.is_multiple_of(METADATA_LEVELS) {
            self.held.push((ready.level, ready.tile, bytes));
        } else {
            write_tile(&self.folder, ready.level, ready.tile, ENDING, &bytes)?;
        }
        Ok(len)
    }

    pub(super) fn end_level(&mut self, tiles: impl Iterator<Item = Tile>) {
        self.available.push(rectangles(tiles));
    }

    pub(super) fn end(self) -> Result<()> {
        for (level, tile, mut bytes) in self.held {
            let first = level as usize + 1;
            let last = self.available.len().min(first + METADATA_LEVELS as usize);
            append_metadata(&mut bytes, &below(tile, &self.available[first..last]));
            write_tile(&self.folder, level, tile, ENDING, &bytes)?;
        }
        let mut extensions = vec!["metadata"];
        if self.has_normals {
            extensions.insert(0, "octvertexnormals");
        }
        if self.has_page {
            written(&self.folder.join("index.html"), include_bytes!("page.html"))?.commit_unsynced()?;
        }
        let is_empty = self.bounds[0] > self.bounds[2];
        let is_geographic = self.scheme == Scheme::Geographic;
        let layer = json!({
            "tilejson": "2.1.0",
            "name": "terrain",
            "version": "1.0.0",
            "format": "quantized-mesh-1.0",
            "scheme": "tms",
            "projection": if is_geographic { "EPSG:4326" } else { "EPSG:3857" },
            "tiles": ["{z}/{x}/{y}.terrain"],
            "minzoom": 0,
            "maxzoom": self.levels - 1,
            "bounds": if is_empty { [-180.0, -90.0, 180.0, 90.0] } else { self.bounds },
            "extensions": extensions,
            "metadataAvailability": METADATA_LEVELS,
            "available": of_levels(&self.available),
        });
        write_description(&self.folder, "layer.json", layer.to_string().as_bytes())
    }
}
