//! `spdem`: triangles in, a raster out.
//!
//! A cell has the value of the triangle that its centre is in; triangles are drawn as they arrive, in any order. `axis` and
//! `centers` say where centres are, `span` which of them are in a triangle, exactly; `search` finds those that are hard to find. `facet` is the plane of a
//! triangle. `tile` has cells, `canvas` all tiles, of which some are in a temporary file; `painter` draws. `ending` has what is left when all
//! triangles have come, of which `fill` fills holes.

mod axis;
mod canvas;
mod centers;
mod ending;
mod facet;
mod fill;
mod painter;
mod search;
mod span;
mod tile;

use std::io::{Read, Seek, Write};

use crate::surface::check_input;
use canvas::TilePlace;
use ending::Ending;
use fill::Filler;
use painter::{Handover, Painter};
use spmesh_core::error::{Error, Result};
use spmesh_geometry::predicates::{Point2, PredicateCounts, Predicates2};
use spmesh_io::raster::{
    self, Grid, Light, RasterFile, RasterFormat, RasterOptions, Reduction, TILE, Tiles, Window,
};
use spmesh_model::bounds::Point;
use spmesh_stream::{Crs, Event, Header, LiveVertices, Patch, StreamReader};

/// What cells have.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Attribute {
    /// The elevation at the centre.
    Elevation,
    /// The angle of the triangle with the horizontal, in degrees.
    Slope,
    /// The direction of steepest descent, in degrees clockwise from north; nothing where a triangle is level.
    Aspect,
    /// How bright the triangle is in some light, from 0 to 255.
    Hillshade(Light),
}

/// What is drawn, and with how much memory.
#[derive(Debug, Clone)]
pub struct Options {
    /// What cells have.
    pub attribute: Attribute,
    /// Triangles with an edge that is longer are left out. Units: those of the world.
    pub kill: Option<f64>,
    /// Cells without data are filled from data that are at most so many cells away.
    pub fill: Option<u32>,
    /// Bytes for tiles; others wait in a temporary file.
    pub memory: u64,
    /// How the raster is written.
    pub raster: RasterOptions,
}

/// Figures of a run.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Stats {
    /// Vertices of the mesh.
    pub vertices: u64,
    /// Triangles of the mesh.
    pub triangles: u64,
    /// Triangles left out because of a long edge.
    pub killed: u64,
    /// Most vertices that were live at once.
    pub width: u64,
    /// Cells of the raster.
    pub cells: u64,
    /// Cells with a value.
    pub known: u64,
    /// Cells that were filled from data around them.
    pub filled: u64,
    /// How many times a tile went to the temporary file.
    pub spilled: u64,
    /// Bytes of the temporary file.
    pub spilled_bytes: u64,
    /// Bytes read.
    pub input_bytes: u64,
    /// Decisions on which side of edges centres are.
    pub predicates: PredicateCounts,
}

/// What a mesh covers, in world coordinates.
///
/// # Errors
/// Usage, if it is no mesh that can be drawn, or the header does not say it.
pub fn window(header: &Header) -> Result<Window> {
    check_input(header)?;
    let Some(bounds) = header.bounds else {
        return Err(Error::usage("the header does not say where the mesh is: give --bounds"));
    };
    let [min, max] = [bounds.min, bounds.max].map(|corner| facet::place(header.coordinates.to_world(corner)));
    Ok(Window { min, max })
}

/// Writes the raster of a triangle mesh with elevations; `progress` is told how many vertices are read.
///
/// A centre on an edge or a vertex belongs to one triangle, as if it were moved to the right and a little up by less than any
/// number; on the border of the mesh, to a triangle there. Which cells have a value, and which triangle they have it from, is decided
/// exactly, and does not depend on the order of triangles; where it is a tie on the border, the least value counts.
///
/// Memory: `options.memory` for tiles, 24 bytes for each tile of the grid, and the vertices that are not final. Tiles are written
/// when all their cells have a value.
///
/// # Errors
/// If the input is no triangle mesh with elevations, is malformed or ends too early; if elevations do not fit 32 bits; if there are
/// too many tiles; if writing fails.
pub fn rasterize<R: Read, W: Write + Seek>(
    reader: &mut StreamReader<R>,
    output: &mut W,
    grid: &Grid,
    options: &Options,
    progress: impl FnMut(u64),
) -> Result<Stats> {
    let header = reader.header().clone();
    check_input(&header).map_err(|e| e.of_input(reader.name()))?;
    let filler = options.fill.map(Filler::new).transpose()?;
    let mut painter = Painter::new(*grid, &header.coordinates, options)?;
    let file = options.file(*grid, &header.crs);
    let (mut width, mut known, mut filled) = (0, 0, 0);
    match options.raster.format {
        RasterFormat::Ascii => {
            width = read(reader, &mut painter, None, progress)?;
            let mut ending = Ending::new(&mut painter.canvas, filler);
            let band_width = (grid.columns as usize).next_multiple_of(TILE);
            let mut band = vec![f32::NAN; band_width * TILE];
            raster::write_rows(output, &file, |row, values| {
                let row = row as usize;
                if row.is_multiple_of(TILE) {
                    ending.band(row / TILE, &mut band)?;
                }
                values.copy_from_slice(&band[row % TILE * band_width..][..values.len()]);
                known += ending::count_known(values);
                Ok(())
            })?;
            filled = ending.filled;
        }
        RasterFormat::GeoTiff => raster::write_tiles(output, &file, |tiles| {
            let mut write = |tiles: &mut Tiles, [column, row]: TilePlace, values: &[f32]| {
                known += ending::count_known(values);
                tiles.tile(column, row, values)
            };
            let mut complete = |at: TilePlace, values: &[f32]| write(tiles, at, values);
            width = read(reader, &mut painter, Some(&mut complete), progress)?;
            let mut ending = Ending::new(&mut painter.canvas, filler);
            ending.hand_over(tiles, |tiles, [column, row], values| tiles.read(column, row, values), write)?;
            filled = ending.filled;
            Ok(())
        })?,
    }
    let totals = reader.totals();
    Ok(Stats {
        vertices: totals.vertices,
        triangles: totals.simplices,
        killed: painter.killed,
        width,
        cells: grid.cells(),
        known,
        filled,
        spilled: painter.canvas.spilled,
        spilled_bytes: painter.canvas.spill_len(),
        input_bytes: reader.bytes_read(),
        predicates: *painter.predicates.counts(),
    })
}

/// Draws all triangles of a stream; its width.
fn read<R: Read>(
    reader: &mut StreamReader<R>,
    painter: &mut Painter,
    mut complete: Option<&mut Handover>,
    mut progress: impl FnMut(u64),
) -> Result<u64> {
    let coordinates = reader.header().coordinates;
    let to_drawn = |stored: Point| [stored[0], stored[1], coordinates.to_world(stored)[2]];
    let mut live = LiveVertices::new();
    while let Some(event) = reader.next_event()? {
        if let Event::Patch(patch) = event {
            let drawn = draw(&patch, to_drawn, &mut live, painter, complete.as_deref_mut());
            drawn.map_err(|error| reader.locate(error))?;
            progress(reader.totals().vertices);
        }
    }
    Ok(live.live_max() as u64)
}

/// Draws the triangles of a patch.
fn draw(
    patch: &Patch,
    to_drawn: impl Fn(Point) -> Point,
    live: &mut LiveVertices<Point>,
    painter: &mut Painter,
    mut complete: Option<&mut Handover>,
) -> Result<()> {
    let vertices = live.enter(patch, |_, stored| to_drawn(stored))?;
    if let Some((_, [.., elevation])) = vertices.iter().find(|(_, [.., z])| z.abs() > f64::from(f32::MAX)) {
        let what =
            format!("elevation {elevation:e} is too great for a raster, which has 32 bits: scale elevations");
        return Err(Error::usage(what));
    }
    for triangle in patch.triangles() {
        painter.draw(triangle.map(|local| vertices[local as usize].1), complete.as_deref_mut())?;
    }
    Ok(())
}

impl Options {
    /// The file that the raster becomes.
    fn file<'a>(&'a self, grid: Grid, crs: &'a Crs) -> RasterFile<'a> {
        // The mean of north-east and north-west is no south.
        let reduction = match self.attribute {
            Attribute::Aspect => Reduction::First,
            _ => Reduction::Mean,
        };
        let are_elevations = self.attribute == Attribute::Elevation;
        // Holes are filled from tiles that have been written.
        let is_staged = self.fill.is_some();
        RasterFile { options: &self.raster, grid, crs, are_elevations, reduction, is_staged }
    }
}

impl Attribute {
    /// What all of a plane has in common, if it does, from its gradient in world coordinates.
    ///
    /// # Errors
    /// Usage, if the gradient is out of the range of numbers.
    fn of_plane(self, gradient: Point2) -> Result<Option<f32>> {
        let value = match self {
            Attribute::Elevation => return Ok(None),
            _ if !gradient.iter().all(|part| part.is_finite()) => return Err(out_of_range()),
            Attribute::Slope => raster::slope(gradient),
            Attribute::Aspect => raster::aspect(gradient),
            Attribute::Hillshade(light) => light.shade(gradient),
        };
        Ok(Some(value as f32))
    }
}

fn out_of_range() -> Error {
    Error::usage("coordinates are too great or too small to interpolate between: shift and scale them")
}
