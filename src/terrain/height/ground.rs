//! The mesh of the ground.

use std::io::Read;
use std::path::Path;

use super::block_writer::BlockWriter;
use super::blocks::{Blocks, LoadedBlock, Triangle};
use super::boxes::Box2;
use crate::surface::is_counterclockwise;
use spmesh_base::error::{Error, Result};
use spmesh_delaunay::predicates::FiniteFloatPredicates;
use spmesh_formats::crs::{System, differences};
use spmesh_stream::model::bounds::Bounds;
use spmesh_stream::{Coordinates, Crs, Event, LiveVertices, StreamReader, check_surface};

/// Memory for vertices that are not final, at least. Units: bytes.
const MEMORY_MIN: u64 = 1 << 20;

/// The triangles of a mesh, in a temporary file.
///
/// Memory: 48 bytes for each two thousand triangles, and 40 MB while it is read. Disk: 13 bytes for each
/// triangle, 19 if its coordinates are floating-point numbers.
#[derive(Debug)]
pub struct Ground {
    blocks: Blocks,
    coordinates: Coordinates,
    crs: Crs,
    name: String,
    /// The box of the world in which all of its triangles were read; everywhere if `None`.
    window: Option<Bounds>,
}

impl Ground {
    /// Reads a triangle mesh with elevations; calls `progress` with the number of vertices read. The
    /// temporary file is in `temp_dir`, or in the system's folder for temporary files. `memory` is for
    /// vertices that are not final. Units: bytes.
    ///
    /// # Errors
    /// If the input is no triangle mesh with elevations, is malformed or truncated; if the temporary file
    /// fails; memory, if more vertices are not final than it has room for.
    pub fn read<R: Read>(
        reader: &mut StreamReader<R>,
        temp_dir: Option<&Path>,
        memory: u64,
        progress: impl FnMut(u64),
    ) -> Result<Ground> {
        Ground::read_where(reader, temp_dir, memory, |_| true, progress)
    }

    /// [`Ground::read`], of the triangles that `keeps` holds for alone; their corners are in stored
    /// coordinates.
    ///
    /// # Errors
    /// As [`Ground::read`].
    pub fn read_where<R: Read>(
        reader: &mut StreamReader<R>,
        temp_dir: Option<&Path>,
        memory: u64,
        keeps: impl Fn(&Triangle) -> bool,
        mut progress: impl FnMut(u64),
    ) -> Result<Ground> {
        let header = reader.header().clone();
        check_surface(&header, true).map_err(|e| e.of_input(reader.name()))?;
        let is_integer = matches!(header.coordinates, Coordinates::I32 { .. });
        let mut blocks = BlockWriter::new(is_integer, temp_dir)?;
        let (mut live, mut triangles) = (LiveVertices::within(memory.max(MEMORY_MIN)), Vec::new());
        let mut predicates = FiniteFloatPredicates::default();
        while let Some(event) = reader.next_event()? {
            let Event::Patch(patch) = event else { continue };
            let mut take = || -> Result<()> {
                let vertices = live.enter(&patch, |_, stored| stored)?;
                triangles.clear();
                for triangle in patch.triangles() {
                    let corners = triangle.map(|local| vertices[local as usize].1);
                    if keeps(&corners)
                        && is_counterclockwise(corners.map(|[x, y, _]| [x, y]), &mut predicates)?
                    {
                        triangles.push(triangle);
                    }
                }
                blocks.add(vertices.iter().map(|&(_, vertex)| vertex), triangles.iter().copied())
            };
            take().map_err(|error| reader.locate(error))?;
            progress(reader.totals().vertices);
        }
        let blocks = blocks.finish()?;
        let name = reader.name().to_string();
        Ok(Ground { blocks, coordinates: header.coordinates, crs: header.crs, name, window: None })
    }

    /// The same ground, of which all triangles were read in this box of the world alone: the one that headers
    /// of points state.
    #[must_use]
    pub fn within(self, window: Option<Bounds>) -> Ground {
        Ground { window: window.map(|window| self.coordinates.widened(&window)), ..self }
    }

    /// Refuses a box of points that leaves the window: triangles below them may be missing.
    ///
    /// # Errors
    /// Malformed, as a header states another box.
    pub(super) fn check_window(&self, points: &Box2) -> Result<()> {
        let Some(window) = self.window else { return Ok(()) };
        let [min, max] = [points.min, points.max].map(|[x, y]| self.coordinates.to_world([x, y, 0.0]));
        let is_inside = (0..2).all(|axis| window.min[axis] <= min[axis] && max[axis] <= window.max[axis]);
        if is_inside {
            return Ok(());
        }
        Err(Error::malformed(
            "points lie outside of the box that the header states, where parts of the ground are not known: \
             write the file again with a right header",
        ))
    }

    /// How its stored coordinates are encoded.
    pub fn coordinates(&self) -> &Coordinates {
        &self.coordinates
    }

    /// Its coordinate reference system.
    pub fn crs(&self) -> &Crs {
        &self.crs
    }

    /// Its name in messages.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Refuses points in another coordinate reference system. Points without one take that of the ground.
    ///
    /// # Errors
    /// Usage, if the systems differ.
    pub fn check_system(&self, crs: &Crs) -> Result<()> {
        let found = differences(&System::of(&self.crs), &System::of(crs)).join("; ");
        if found.is_empty() {
            return Ok(());
        }
        let what = format!("the coordinate reference system of {} is another one ({found})", self.name);
        Err(Error::usage(format!("{what}: reproject one of them")))
    }

    /// Its triangles.
    pub(crate) fn blocks(&self) -> &Blocks {
        &self.blocks
    }

    /// Calls `found` with its triangles that may meet a box: all that do.
    ///
    /// # Errors
    /// If the temporary file fails.
    pub(crate) fn for_each_near(&self, bounds: &Box2, mut found: impl FnMut(Triangle)) -> Result<()> {
        let mut block = LoadedBlock::default();
        for number in self.blocks.that(|of_block| of_block.meets(bounds)) {
            self.blocks.read(number, &mut block)?;
            block.triangles().filter(|triangle| Box2::of(triangle).meets(bounds)).for_each(&mut found);
        }
        Ok(())
    }

    /// Number of its triangles.
    pub fn triangles(&self) -> u64 {
        self.blocks.triangles()
    }
}
