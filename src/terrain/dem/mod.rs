//! `spdem`: triangles in, a raster out.
//!
//! A cell has the value of the triangle that contains its centre. Triangles are drawn as they arrive, in any
//! order, by the `rasterizer`. `axis` places the centres. `span` finds exactly the centres in a triangle,
//! with the help of `search` where rounding leaves doubts. `facet` is the plane of a triangle. A `tile` holds
//! cells; `tile_cache` holds all tiles, some of them in a temporary file. After the last triangle, `flush`
//! passes on the remaining tiles, whose holes `fill` fills; `derived` has the slopes there. `cell_mask` finds
//! the cells in polygons. For `--sample`, `covering` passes triangles to a thread, where `cut` cuts them at
//! the sides of cells and `coverage` holds what each cell has got. `natural` interpolates by natural
//! neighbours, in the `circle` of each triangle. Complete tiles go through `stages`: `neighbours` derives
//! slopes from the cells of elevations.

mod axis;
mod cell_mask;
mod circle;
mod coverage;
mod covering;
mod cut;
mod derived;
mod facet;
mod fill;
mod flush;
mod highest;
mod natural;
mod neighbours;
mod options;
mod rasterizer;
mod relief;
mod search;
mod span;
mod stages;
mod surroundings;
mod tile;
mod tile_cache;

use std::io::{Read, Seek, Write};

pub use highest::Highest;
pub use options::{Interpolation, Method, Options, Quantity, Sample};

use crate::files::{Destination, TilePlace, TileStore, TileTarget, tiles_of};
use crate::surface::check_input;
use coverage::Coverage;
use covering::Covering;
use fill::Filler;
use flush::Flush;
use natural::Natural;
use neighbours::Neighbours;
use rasterizer::{Rasterizer, TileSink};
use relief::Derivation;
use spmesh_base::error::{Error, Result};
use spmesh_delaunay::predicates::{PredicateCounts, Predicates2};
use spmesh_formats::crs::System;
use spmesh_formats::raster::{Gradient, Grid, Window};
use spmesh_stream::model::attributes::Column;
use spmesh_stream::model::bounds::Point;
use spmesh_stream::{Event, Header, LiveVertices, Patch, StreamReader};
use stages::Stages;
use surroundings::Surroundings;

/// Counts of a run.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Stats {
    /// Vertices of the mesh.
    pub vertices: u64,
    /// Triangles of the mesh.
    pub triangles: u64,
    /// Triangles left out because of a long edge.
    pub killed: u64,
    /// Triangles left out because a corner has no known value.
    pub unknown: u64,
    /// Triangles outside of the concave outline.
    pub outside: u64,
    /// The high-water mark of live vertices.
    pub width: u64,
    /// Cells of the raster.
    pub cells: u64,
    /// Cells with a value.
    pub known: u64,
    /// Cells filled from data around them.
    pub filled: u64,
    /// Number of tiles written to the temporary file.
    pub spilled: u64,
    /// Bytes of the temporary file.
    pub spilled_bytes: u64,
    /// Bytes read.
    pub input_bytes: u64,
    /// Orientation tests of centres against edges.
    pub predicates: PredicateCounts,
    /// What the user should know of the coordinate reference system.
    pub notices: Vec<String>,
}

/// The window that a mesh covers, in world coordinates.
///
/// # Errors
/// Usage, if the header has no bounds.
pub fn window(header: &Header) -> Result<Window> {
    let Some(bounds) = header.bounds else {
        if header.points == Some(0) {
            let what = "there are no points, so cells have no place: give --bounds for a raster without \
                        data, or look whether the input has the points that its filters keep (such as \
                        --keep-class 2)";
            return Err(Error::usage(what));
        }
        return Err(Error::usage("the header does not say where the mesh is: give --bounds"));
    };
    let [min, max] = [bounds.min, bounds.max].map(|corner| facet::place(header.coordinates.to_world(corner)));
    Ok(Window { min, max })
}

/// Writes the raster of a triangle mesh with elevations; calls `progress` with the number of vertices read.
///
/// A centre on an edge or a vertex belongs to one triangle: the one that it would be in after an
/// infinitesimal move to the right and a much smaller one up. On the border of the mesh, it belongs to a
/// triangle there. Which cells have a value, and from which triangle, is decided exactly and does not depend
/// on the order of triangles. Among several triangles on the border, the least value counts.
///
/// Memory: `options.memory` for tiles, 24 bytes for each tile of the grid, and the live vertices. A tile is
/// written as soon as all its cells have a value.
///
/// # Errors
/// If the input is not a triangle mesh with elevations, is malformed or truncated; if elevations overflow
/// f32; if there are too many tiles; if writing fails.
pub fn rasterize<R: Read, W: Write + Seek>(
    reader: &mut StreamReader<R>,
    output: Destination<W>,
    grid: &Grid,
    options: &Options,
    progress: impl FnMut(u64),
) -> Result<Stats> {
    let header = reader.header().clone();
    let column = check(&header, &options.quantity).map_err(|e| e.of_input(reader.name()))?;
    if options.natural && (header.constrained.is_some() || header.part.is_some()) {
        let what = "natural neighbours are those of a whole Delaunay mesh, and this one is constrained, cut or a part";
        return Err(Error::usage(what).of_input(reader.name()));
    }
    let around = options.surroundings(grid, &header);
    // Before anything is made for each tile.
    tiles_of(&around.drawn)?;
    let crs = options.crs.as_ref().unwrap_or(&header.crs);
    let unit_of_z = options.unit_of_z(&System::of(crs), &header).map_err(|e| e.of_input(reader.name()))?;
    let reference = options.reference(crs);
    let file = options.file(*grid, &reference);
    let run = Run { around: &around, options, column, unit_of_z };
    let draw = |target: &mut dyn TileTarget, memory| run.draw(reader, target, memory, progress);
    let place = (&around.drawn, &around.raster);
    let (stats, [spilled, spilled_bytes]) = output.write_part(&file, place, options.memory, draw)?;
    Ok(Stats {
        cells: grid.cells(),
        spilled: stats.spilled + spilled,
        spilled_bytes: stats.spilled_bytes + spilled_bytes,
        notices: reference.notices,
        ..stats
    })
}

/// What the tiles of a raster follow from.
struct Run<'r> {
    around: &'r Surroundings,
    options: &'r Options,
    /// The attribute that is drawn.
    column: Option<Column>,
    /// Units of x and y that one unit of z is.
    unit_of_z: f64,
}

impl Run<'_> {
    /// Passes all tiles with values to a target, each once and complete, in any order.
    fn draw<R: Read>(
        &self,
        reader: &mut StreamReader<R>,
        target: &mut dyn TileTarget,
        memory: u64,
        progress: impl FnMut(u64),
    ) -> Result<Stats> {
        let (options, grid) = (self.options, self.around.drawn);
        let filler = options.fill.map(Filler::new).transpose()?;
        let differences = options.differences();
        let for_drawing = if differences.is_some() { memory / 2 } else { memory };
        let for_cells = if options.natural { for_drawing / 2 } else { for_drawing };
        let temp_dir = options.raster.temp_dir.as_deref();
        let coordinates = reader.header().coordinates;
        let mut rasterizer = Rasterizer::new(grid, &coordinates, options, self.unit_of_z, for_cells)?;
        if options.natural {
            let base = reader.header().bounds.map_or(0.0, |bounds| coordinates.to_world(bounds.min)[2]);
            let memory = for_drawing - for_cells;
            let natural = Natural::new(rasterizer.centers(), &grid, base, memory, temp_dir)?;
            rasterizer.natural = Some(natural);
        }
        if options.sample.is_whole() {
            // The header states nothing of attributes.
            let bounds = reader.header().bounds.filter(|_| self.column.is_none());
            let greatest = bounds.map(|bounds| {
                let [low, high] =
                    [bounds.min, bounds.max].map(|corner| coordinates.to_world(corner)[2].abs());
                low.max(high)
            });
            let coverage = Coverage::new(options.sample, &grid, greatest, for_drawing, temp_dir)?;
            rasterizer.covering = Some(Covering::start(coverage, grid, coordinates)?);
        }
        let neighbours = differences.map(|differences| -> Result<Neighbours> {
            let store = TileStore::new(1, memory - for_drawing, temp_dir);
            let gradient = Gradient::new(differences, grid.step / rasterizer.unit_of_z);
            let derivation = Derivation::new(&options.quantity, gradient, reader.header())?;
            Ok(Neighbours::new(derivation, rasterizer.cache.tiles(), store))
        });
        let neighbours = neighbours.transpose().map_err(|e| e.of_input(reader.name()))?;
        // Holes are filled from the elevations around them, so these stay until the end.
        let is_written_early = rasterizer.heights.is_none()
            && rasterizer.natural.is_none()
            && (neighbours.is_none() || options.fill.is_none());
        let mut stages = Stages::new(neighbours, target, self.around, options.banks.as_deref());
        let mut complete = |at: TilePlace, values: &[f32]| stages.take(at, values);
        let sink: Option<&mut TileSink> = if is_written_early { Some(&mut complete) } else { None };
        let width =
            read(reader, self.column.as_ref(), &mut rasterizer, options.vertices_memory, sink, progress)?;
        let mut covered = [0; 2];
        if let Some(covering) = rasterizer.covering.take() {
            covered = covering.finish()?.finish(&rasterizer.cache, &mut stages)?;
        }
        if let Some(mut natural) = rasterizer.natural.take() {
            natural.put(&mut rasterizer.cache)?;
            covered = natural.spilled();
        }
        let mut flush = Flush::new(&mut rasterizer, filler, options, self.around)?;
        flush.write_rest(&mut stages)?;
        let filled = flush.filled;
        let [known, spilled, spilled_bytes] = stages.finish()?;
        let totals = reader.totals();
        Ok(Stats {
            vertices: totals.vertices,
            triangles: totals.simplices,
            killed: rasterizer.killed,
            unknown: rasterizer.unknown,
            outside: rasterizer.outside,
            width,
            known,
            filled,
            spilled: rasterizer.cache.spilled + spilled + covered[0],
            spilled_bytes: rasterizer.cache.spill_len() + spilled_bytes + covered[1],
            input_bytes: reader.bytes_read(),
            predicates: *rasterizer.predicates.counts(),
            notices: Vec::new(),
            cells: 0,
        })
    }
}

/// Checks that a stream holds triangles with what is to be drawn; returns the column of an attribute.
///
/// # Errors
/// Usage, if not.
pub fn check(header: &Header, quantity: &Quantity) -> Result<Option<Column>> {
    let Quantity::Attribute(choice, _) = quantity else {
        check_input(header, true)?;
        return Ok(None);
    };
    check_input(header, false)?;
    let column = header.attributes.column(choice).map_err(|what| {
        Error::usage(format!("{what}: spfinalize --attributes takes attributes of points along"))
    })?;
    Ok(Some(column))
}

/// Draws all triangles of a stream and returns its width. Values are those of `column`, or elevations.
fn read<R: Read>(
    reader: &mut StreamReader<R>,
    column: Option<&Column>,
    rasterizer: &mut Rasterizer,
    vertices_memory: Option<u64>,
    mut complete: Option<&mut TileSink>,
    mut progress: impl FnMut(u64),
) -> Result<u64> {
    let coordinates = reader.header().coordinates;
    let mut live = LiveVertices::within(vertices_memory.unwrap_or(u64::MAX));
    while let Some(event) = reader.next_event()? {
        if let Event::Patch(patch) = event {
            let rows = reader.rows();
            let value_of = |id: u64, stored: Point| match column {
                None => coordinates.to_world(stored)[2],
                Some(column) => column.of(rows, (id - patch.first_id) as usize),
            };
            let to_drawn = |id, stored: Point| [stored[0], stored[1], value_of(id, stored)];
            let drawn = draw(&patch, to_drawn, &mut live, rasterizer, complete.as_deref_mut());
            drawn.map_err(|error| reader.locate(error))?;
            progress(reader.totals().vertices);
        }
    }
    rasterizer.draw_inside(complete)?;
    Ok(live.live_max() as u64)
}

/// Draws the triangles of a patch.
fn draw(
    patch: &Patch,
    to_drawn: impl Fn(u64, Point) -> Point,
    live: &mut LiveVertices<Point>,
    rasterizer: &mut Rasterizer,
    mut complete: Option<&mut TileSink>,
) -> Result<()> {
    let vertices = live.enter(patch, to_drawn)?;
    if let Some((_, [.., elevation])) = vertices.iter().find(|(_, [.., z])| z.abs() > f64::from(f32::MAX)) {
        let what =
            format!("elevation {elevation:e} is too great for a raster, which has 32 bits: scale elevations");
        return Err(Error::usage(what));
    }
    for triangle in patch.triangles() {
        rasterizer.take(triangle.map(|local| &vertices[local as usize]), complete.as_deref_mut())?;
    }
    Ok(())
}
