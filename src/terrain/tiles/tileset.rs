//! Tiles as glTF, and `tileset.json` of 3D Tiles 1.1, which says where they are.
//!
//! Source: OGC 22-025r4, "3D Tiles". A viewer takes the axes of glTF to those of the Earth: what it has as x,
//! -z and y is X, Y and Z.

use std::f64::consts::TAU;
use std::path::PathBuf;

use foldhash::{HashMap, HashMapExt};
use serde_json::{Value, json};

use super::earth::SEMI_MAJOR;
use super::pyramid::{Options, Ready, SAFETY};
use super::scheme::{Scheme, Tile};
use super::tile_mesh::{TileMesh, direction};
use super::{start, write_description, write_tile};
use spmesh_base::error::Result;
use spmesh_formats::cad::glb::{Glb, upright};
use spmesh_stream::model::bounds::{Bounds, Point};

/// A level with more tiles is not the first one.
const ROOTS_MAX: usize = 4;

const NAME: &str = "tileset.json";

/// What is known of a tile.
#[derive(Debug, Clone, Copy)]
struct Node {
    /// Least and greatest height.
    heights: [f64; 2],
    has_content: bool,
}

pub(super) struct Tileset {
    folder: PathBuf,
    scheme: Scheme,
    /// Of each level, the error that viewers see.
    errors: Vec<f64>,
    /// The tiles of each level.
    levels: Vec<HashMap<Tile, Node>>,
    /// The first level that is written, once that is known.
    first: Option<u32>,
    /// Until then, the tiles of the level before, and those of this level.
    before: Vec<(Tile, Vec<u8>)>,
    held: Vec<(Tile, Vec<u8>)>,
}

impl Tileset {
    pub(super) fn new(options: &Options, tolerances: &[f64]) -> Result<Tileset> {
        start(&options.folder, NAME)?;
        Ok(Tileset {
            folder: options.folder.clone(),
            scheme: options.scheme,
            errors: tolerances.iter().map(|tolerance| SAFETY * tolerance).collect(),
            levels: Vec::new(),
            first: None,
            before: Vec::new(),
            held: Vec::new(),
        })
    }

    /// Writes a tile, and returns its length.
    pub(super) fn tile(&mut self, ready: &Ready) -> Result<u64> {
        let level = ready.level as usize;
        if self.levels.len() == level {
            self.levels.push(HashMap::new());
        }
        let bounds = Bounds::of_points(&ready.mesh.places).unwrap_or(Bounds::of_point([0.0; 3]));
        let heights = [bounds.min[2], bounds.max[2]];
        self.levels[level].insert(ready.tile, Node { heights, has_content: true });
        let bytes = glb(ready.mesh, ready.normals.as_deref(), self.grid(ready))?;
        let len = bytes.len() as u64;
        self.held.push((ready.tile, bytes));
        if self.first.is_none() && self.held.len() > ROOTS_MAX {
            self.begin(ready.level)?;
        }
        if self.first.is_some() {
            self.write(ready.level)?;
        }
        Ok(len)
    }

    /// The grid of positions in a level: a power of two, of which the differences in a tile are at most 2^23
    /// multiples.
    fn grid(&self, ready: &Ready) -> f64 {
        let width = TAU * SEMI_MAJOR / f64::from(self.scheme.columns(ready.level));
        let extent = 2.0 * width + ready.heights[1] - ready.heights[0];
        (extent.log2().ceil() - 23.0).exp2()
    }

    /// The level before this one is the first, if there is one.
    fn begin(&mut self, level: u32) -> Result<()> {
        let held = std::mem::replace(&mut self.held, std::mem::take(&mut self.before));
        let first = if self.held.is_empty() { level } else { level - 1 };
        self.first = Some(first);
        self.write(first)?;
        self.held = held;
        Ok(())
    }

    fn write(&mut self, level: u32) -> Result<()> {
        for (tile, bytes) in self.held.drain(..) {
            write_tile(&self.folder, level, tile, "glb", &bytes)?;
        }
        Ok(())
    }

    pub(super) fn end_level(&mut self) {
        self.before = std::mem::take(&mut self.held);
    }

    /// Returns the first level that is written.
    pub(super) fn end(mut self) -> Result<u32> {
        if self.first.is_none() {
            self.begin(self.levels.len() as u32)?;
        }
        let first = self.first.unwrap_or(0) as usize;
        // What is below a tile is within its heights.
        for level in (first + 1..self.levels.len()).rev() {
            let (above, below) = self.levels.split_at_mut(level);
            for (tile, node) in &below[0] {
                let parent = Tile { x: tile.x / 2, y: tile.y / 2 };
                let of_parent =
                    above[level - 1].entry(parent).or_insert(Node { has_content: false, ..*node });
                of_parent.heights[0] = of_parent.heights[0].min(node.heights[0]);
                of_parent.heights[1] = of_parent.heights[1].max(node.heights[1]);
            }
        }
        let mut roots: Vec<Tile> =
            self.levels.get(first).map(|level| level.keys().copied().collect()).unwrap_or_default();
        roots.sort_unstable();
        let mut volume = [
            f64::INFINITY,
            f64::INFINITY,
            f64::NEG_INFINITY,
            f64::NEG_INFINITY,
            f64::INFINITY,
            f64::NEG_INFINITY,
        ];
        for &root in &roots {
            let [[west, south], [east, north]] = self.scheme.corners(first as u32, root);
            let heights = self.levels[first][&root].heights;
            volume = [
                volume[0].min(west),
                volume[1].min(south),
                volume[2].max(east),
                volume[3].max(north),
                volume[4].min(heights[0]),
                volume[5].max(heights[1]),
            ];
        }
        let error = 2.0 * self.errors.get(first).copied().unwrap_or(0.0);
        let mut output = String::new();
        let asset = "{\"version\":\"1.1\",\"generator\":\"spmesh\"}";
        output += &format!("{{\"asset\":{asset},\"geometricError\":{error},\"root\":");
        self.node(&mut output, &volume_of(volume), error, None, (first, &roots));
        output += "}\n";
        write_description(&self.folder, NAME, output.as_bytes())?;
        Ok(first as u32)
    }

    /// Writes a node with its children, which are of a level.
    fn node(
        &self,
        output: &mut String,
        volume: &Value,
        error: f64,
        content: Option<String>,
        (level, children): (usize, &[Tile]),
    ) {
        let content = content.map_or(String::new(), |uri| format!(",\"content\":{{\"uri\":\"{uri}\"}}"));
        *output += &format!(
            "{{\"boundingVolume\":{volume},\"geometricError\":{error},\"refine\":\"REPLACE\"{content}"
        );
        for (number, &child) in children.iter().enumerate() {
            *output += if number == 0 { ",\"children\":[" } else { "," };
            let Node { heights: [low, high], has_content } = self.levels[level][&child];
            let [[west, south], [east, north]] = self.scheme.corners(level as u32, child);
            let is_last = level + 1 == self.levels.len();
            let error = if is_last { 0.0 } else { self.errors[level] };
            let below = if is_last { Vec::new() } else { self.below(level + 1, child) };
            let uri = has_content.then(|| format!("{level}/{}/{}.glb", child.x, child.y));
            let volume = volume_of([west, south, east, north, low, high]);
            self.node(output, &volume, error, uri, (level + 1, &below));
        }
        *output += if children.is_empty() { "}" } else { "]}" };
    }

    fn below(&self, level: usize, tile: Tile) -> Vec<Tile> {
        let four =
            [[0, 0], [1, 0], [0, 1], [1, 1]].map(|[x, y]| Tile { x: 2 * tile.x + x, y: 2 * tile.y + y });
        four.into_iter().filter(|tile| self.levels[level].contains_key(tile)).collect()
    }
}

/// A region, from degrees and metres.
fn volume_of([west, south, east, north, low, high]: [f64; 6]) -> Value {
    let [west, south, east, north] = [west, south, east, north].map(f64::to_radians);
    json!({"region": [west, south, east, north, low, high]})
}

/// A tile as GLB, with positions that are multiples of `grid` in all tiles.
fn glb(mesh: &TileMesh, normals: Option<&[Point]>, grid: f64) -> Result<Vec<u8>> {
    let snapped: Vec<Point> = mesh.positions.iter().map(|place| place.map(|x| (x / grid).round())).collect();
    let bounds = Bounds::of_points(&snapped).unwrap_or(Bounds::of_point([0.0; 3]));
    let centre = [0, 1, 2].map(|axis| (0.5 * (bounds.min[axis] + bounds.max[axis])).round());
    let local: Vec<[f32; 3]> = snapped
        .iter()
        .map(|place| upright([0, 1, 2].map(|axis| ((place[axis] - centre[axis]) * grid) as f32)))
        .collect();
    let along = |axis: usize, best: fn(f32, f32) -> f32, first: f32| {
        local.iter().map(|place| place[axis]).fold(first, best)
    };
    let glb = Glb {
        vertices: local.len() as u64,
        corners: mesh.corners.len() as u64,
        min: [0, 1, 2].map(|axis| along(axis, f32::min, f32::INFINITY)),
        max: [0, 1, 2].map(|axis| along(axis, f32::max, f32::NEG_INFINITY)),
        translation: upright(centre.map(|x| x * grid)),
        has_normals: normals.is_some(),
        extras: Value::Null,
    };
    let mut bytes = Vec::new();
    glb.start(&mut bytes)?;
    bytes.extend(local.as_flattened().iter().flat_map(|x| x.to_le_bytes()));
    if let Some(normals) = normals {
        let unit = |number: usize| direction(normals[number], mesh.positions[number]).map(|x| x as f32);
        (0..normals.len())
            .for_each(|number| bytes.extend(upright(unit(number)).map(f32::to_le_bytes).as_flattened()));
    }
    bytes.extend(mesh.corners.iter().flat_map(|corner| corner.to_le_bytes()));
    Ok(bytes)
}
