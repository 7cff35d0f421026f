//! Makes the levels of a pyramid one after the other: chooses vertices, cuts triangles into tiles, and writes
//! these.

use std::io::Read;
use std::path::PathBuf;

use foldhash::{HashMap, HashMapExt};

use super::buckets::{Buckets, Triangle, rounded};
use super::earth::ToPlaces;
use super::layer::Layer;
use super::quantized::power_of;
use super::scheme::{Place, STEPS, Scheme, Tile};
use super::tile_mesh::TileMesh;
use super::tileset::Tileset;
use crate::meshing::Meshing;
use crate::simplify::{CELL_POINTS, Simplification};
use spmesh_base::error::{Error, Result};
use spmesh_formats::crs::System;
use spmesh_stream::model::bounds::Point;
use spmesh_stream::{Crs, Event, LiveVertices, StreamReader};

/// What is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Target {
    /// Quantized-mesh 1.0, with `layer.json`.
    QuantizedMesh,
    /// 3D Tiles 1.1 of glTF, with `tileset.json`.
    Tiles3d,
}

/// How a pyramid is made.
#[derive(Debug, Clone)]
pub struct Options {
    /// How levels divide the Earth.
    pub scheme: Scheme,
    /// What is written.
    pub target: Target,
    /// Greatest vertical distance of a vertex of the mesh from the finest level. Units: those of its
    /// elevations.
    pub tolerance: f64,
    /// The finest level; the first one that is assumed to be as fine as the tolerance if `None`.
    pub level_max: Option<u32>,
    /// Whether vertices get normals.
    pub has_normals: bool,
    /// Whether a page that shows quantized meshes is written beside them.
    pub has_page: bool,
    /// The coordinate reference system, if not that of the mesh.
    pub crs: Option<Crs>,
    /// Where everything is written.
    pub folder: PathBuf,
}

/// What a level has become.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LevelStats {
    /// Its number.
    pub level: u32,
    /// The tolerance that its vertices were chosen with.
    pub tolerance: f64,
    /// Number of its vertices before they were cut.
    pub chosen: u64,
    /// Number of its tiles.
    pub tiles: u64,
    /// Triangles in them.
    pub triangles: u64,
    /// Bytes of them.
    pub bytes: u64,
}

/// A tile that is ready to be written.
pub(super) struct Ready<'t> {
    pub(super) level: u32,
    pub(super) tile: Tile,
    pub(super) mesh: &'t TileMesh,
    /// Sums of normals of triangles.
    pub(super) normals: Option<Vec<Point>>,
    /// Heights are multiples of this power of two.
    pub(super) power: u32,
    /// The least and the greatest height of the level. Units: metres.
    pub(super) heights: [f64; 2],
}

enum Writer {
    Layer(Layer),
    Tileset(Tileset),
}

/// The finest level that there can be.
pub const LEVEL_MAX: u32 = 23;

/// The error that viewers see in a level is this many times its tolerance, for what lies between vertices.
pub(super) const SAFETY: f64 = 4.0;

/// Reads a mesh and writes its pyramid. Calls `progress` with the number of each level, and the number of
/// vertices that are done in it. Returns the levels, and notices for the user.
///
/// Memory: that of [`Simplification`], and 32 MiB with some 100 bytes for each tile. Disk: besides that of
/// [`Simplification`], 24 bytes for each triangle of a level in a tile.
///
/// # Errors
/// Usage, if the coordinate reference system is not known or not supported, or an option is out of its range;
/// those of [`Simplification`]; if writing fails.
pub fn write<R: Read>(
    reader: &mut StreamReader<R>,
    meshing: Meshing,
    options: &Options,
    progress: &mut dyn FnMut(u32, u64),
) -> Result<(Vec<LevelStats>, Vec<String>)> {
    let system = System::of(options.crs.as_ref().unwrap_or(&reader.header().crs));
    let (to_places, notice) = ToPlaces::of(&system).map_err(|e| e.of_input(reader.name()))?;
    let metres = to_places.height_unit().abs();
    let plan = plan(options, metres)?;
    // No surface is farther from the mesh than all its heights are apart: greater tolerances choose the same.
    let coordinates = reader.header().coordinates;
    let heights =
        reader.header().bounds.map(|bounds| [bounds.min, bounds.max].map(|p| coordinates.to_world(p)[2]));
    let relief = heights.map_or(f64::INFINITY, |[low, high]| (high - low) * metres);
    if options.has_page && options.target != Target::QuantizedMesh {
        return Err(Error::usage("the page shows quantized meshes: leave --html out, or write these"));
    }
    let temp_dir = meshing.temp_dir.clone();
    let mut writer = Writer::new(options, &plan)?;
    let mut simplification =
        Simplification::read(reader, meshing, CELL_POINTS, |vertices| progress(0, vertices))?;
    let mut stats: Vec<LevelStats> = Vec::new();
    let (mut chosen, mut last) = (0, f64::INFINITY);
    for (level, &tolerance) in (0..).zip(&plan) {
        let needed = tolerance.min(relief);
        if needed < last || level == 0 {
            let mut progress = |_, points| progress(level, points);
            chosen = simplification.refine(needed / metres, &mut progress)?.chosen;
            last = needed;
        }
        let mut buckets = Buckets::new(options.scheme, level, temp_dir.as_deref())?;
        cut(&mut simplification.mesh()?, &to_places, &mut buckets)?;
        let mut of_level = LevelStats { level, tolerance, chosen, tiles: 0, triangles: 0, bytes: 0 };
        writer.level(options, level, &buckets, &mut of_level)?;
        stats.push(of_level);
    }
    let first = writer.end()?;
    stats.retain(|of_level| of_level.level >= first);
    Ok((stats, notice.into_iter().collect()))
}

/// The tolerance of each level. Units: metres.
fn plan(options: &Options, metres: f64) -> Result<Vec<f64>> {
    let finest = options.tolerance * metres;
    if !(0.0..f64::INFINITY).contains(&finest) {
        return Err(Error::usage(format!("the tolerance is {}: give a number from 0 on", options.tolerance)));
    }
    let usual = |level: u32| options.scheme.assumed_error(level) / SAFETY;
    let last = match options.level_max {
        Some(level) if level > LEVEL_MAX => {
            return Err(Error::usage(format!("level {level} is beyond {LEVEL_MAX}, the finest one")));
        }
        Some(level) => level,
        None => (0..LEVEL_MAX).find(|&level| usual(level) <= finest).unwrap_or(LEVEL_MAX),
    };
    Ok((0..=last).map(|level| if level == last { finest } else { usual(level).max(finest) }).collect())
}

/// Puts the triangles of a mesh into tiles.
fn cut<R: Read>(reader: &mut StreamReader<R>, to_places: &ToPlaces, buckets: &mut Buckets) -> Result<()> {
    let coordinates = reader.header().coordinates;
    let mut live: LiveVertices<Place> = LiveVertices::new();
    let mut failed = None;
    while let Some(event) = reader.next_event()? {
        let Event::Patch(patch) = event else { continue };
        let local = live.enter(&patch, |_, point| {
            to_places.place(coordinates.to_world(point)).unwrap_or_else(|error| {
                failed.get_or_insert(error);
                [0.0; 3]
            })
        })?;
        if let Some(error) = failed {
            return Err(error);
        }
        for triangle in patch.triangles() {
            buckets.add(triangle.map(|corner| local[corner as usize].1))?;
        }
    }
    Ok(())
}

impl Writer {
    fn new(options: &Options, plan: &[f64]) -> Result<Writer> {
        Ok(match options.target {
            Target::QuantizedMesh => Writer::Layer(Layer::new(options, plan.len() as u32)?),
            Target::Tiles3d => Writer::Tileset(Tileset::new(options, plan)?),
        })
    }

    fn level(
        &mut self,
        options: &Options,
        level: u32,
        buckets: &Buckets,
        stats: &mut LevelStats,
    ) -> Result<()> {
        let mut tiles = buckets.tiles();
        let [low, high] = tiles
            .iter()
            .map(|tile| tile.1)
            .reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])])
            .unwrap_or_default();
        let is_quantized = options.target == Target::QuantizedMesh;
        if is_quantized && level == 0 {
            // Viewers start with all tiles of the first level.
            let roots = (0..options.scheme.columns(0)).map(|x| (Tile { x, y: 0 }, [low; 2]));
            let missing: Vec<_> = roots.filter(|root| !tiles.iter().any(|tile| tile.0 == root.0)).collect();
            tiles.extend(missing);
            tiles.sort_unstable();
        }
        let power =
            if is_quantized { tiles.iter().map(|tile| power_of(tile.1)).max().unwrap_or(0) } else { 0 };
        let mesh_of = |tile: Tile| {
            let mut triangles = buckets.triangles(tile, power)?;
            if triangles.is_empty() {
                triangles = flat(rounded(low, power));
            }
            Ok(TileMesh::new(options.scheme, level, tile, &triangles))
        };
        let mut on_border: HashMap<[u64; 3], Point> = HashMap::new();
        if options.has_normals {
            for &(tile, _) in &tiles {
                let mesh: TileMesh = mesh_of(tile)?;
                let normals = mesh.normals();
                for (number, key) in mesh.on_border() {
                    let sum = on_border.entry(key).or_default();
                    *sum = [0, 1, 2].map(|i| sum[i] + normals[number][i]);
                }
            }
        }
        let heights = [low, high].map(|height| f64::from(height) / super::buckets::HEIGHT_STEPS);
        for &(tile, _) in &tiles {
            let mesh = mesh_of(tile)?;
            let normals = options.has_normals.then(|| {
                let mut normals = mesh.normals();
                mesh.on_border().for_each(|(number, key)| normals[number] = on_border[&key]);
                normals
            });
            stats.tiles += 1;
            stats.triangles += mesh.corners.len() as u64 / 3;
            let ready = Ready { level, tile, mesh: &mesh, normals, power, heights };
            stats.bytes += match self {
                Writer::Layer(layer) => layer.tile(&ready)?,
                Writer::Tileset(tileset) => tileset.tile(&ready)?,
            };
        }
        match self {
            Writer::Layer(layer) => layer.end_level(tiles.into_iter().map(|tile| tile.0)),
            Writer::Tileset(tileset) => tileset.end_level(),
        }
        Ok(())
    }

    /// Returns the first level that is written.
    fn end(self) -> Result<u32> {
        match self {
            Writer::Layer(layer) => layer.end().map(|()| 0),
            Writer::Tileset(tileset) => tileset.end(),
        }
    }
}

/// A square at one height, for a tile in which all triangles are smaller than a step.
fn flat(height: i32) -> Vec<Triangle> {
    let end = STEPS as i32;
    let [a, b, c, d] = [[0, 0], [end, 0], [end, end], [0, end]].map(|[u, v]| [u, v, height]);
    vec![[a, b, c], [a, c, d]]
}
