//! `spsimplify`: the Delaunay triangulation of some vertices of a mesh, to which all others are near. What is
//! defined, and why it depends on the set of vertices alone: `docs/theory/simplification.md`.
//!
//! `cells` puts the vertices into cells of a quadtree; `hull` has those that cannot go. `rounds` triangulates
//! what is chosen so far, and in each cell `greedy` adds points that are too far from that, by `plane`, until
//! none is. `vertices` holds the chosen ones.

mod cells;
mod greedy;
mod hull;
mod plane;
mod rounds;
mod vertices;

use std::io::{Read, Write};
use std::num::NonZeroUsize;

use crate::meshing::Meshing;
pub use cells::CELL_POINTS;
use cells::{Cells, Codec, Piles};
use greedy::Limit;
use rounds::Work;
use spmesh_base::error::{Error, Result};
use spmesh_formats::source::Description;
use spmesh_stream::model::attributes::Attributes;
use spmesh_stream::{Coordinates, Event, StreamReader, check_surface};
use vertices::Vertices;

/// A mesh, and which of its vertices were chosen so far.
///
/// Memory: that of [`Meshing`]; about 50 MB for each thread; the corners of the hull. Disk: twice the
/// vertices, and a few times those that are chosen.
pub struct Simplification {
    cells: Cells,
    chosen: Vertices,
    meshing: Meshing,
    coordinates: Coordinates,
}

/// What was chosen.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Stats {
    /// Vertices of the mesh.
    pub vertices: u64,
    /// Those that were chosen.
    pub chosen: u64,
    /// How often what was chosen was triangulated, and compared with all others.
    pub rounds: u64,
}

impl Simplification {
    /// Reads the vertices of a mesh into cells with at most `cell_points` each, usually [`CELL_POINTS`];
    /// calls `progress` with their number so far. Its triangles do not matter: they follow from the vertices.
    ///
    /// # Errors
    /// Usage, if the input is no triangle mesh with elevations, or is constrained or cut; those of reading;
    /// if temporary files fail.
    pub fn read<R: Read>(
        reader: &mut StreamReader<R>,
        meshing: Meshing,
        cell_points: u64,
        mut progress: impl FnMut(u64),
    ) -> Result<Simplification> {
        let header = reader.header().clone();
        check_surface(&header, true).map_err(|e| e.of_input(reader.name()))?;
        if header.constrained.is_some() {
            let what = "this mesh has breaklines or was cut, and its simplification would lose that: simplify the \
                        mesh that spdelaunay2d writes, and give the lines to spconstrain after that";
            return Err(Error::usage(what).of_input(reader.name()));
        }
        let folder = meshing.temp_dir.as_deref();
        let codec = Codec::of(&header.coordinates);
        let mut piles = Piles::new(codec, cell_points, folder)?;
        while let Some(event) = reader.next_event()? {
            if let Event::Patch(patch) = event {
                piles.add(&patch.new)?;
                progress(reader.totals().vertices);
            }
        }
        let threads = NonZeroUsize::new(meshing.threads).unwrap_or(NonZeroUsize::MIN);
        let cells = piles.into_cells(folder, threads).map_err(|e| e.of_input(reader.name()))?;
        let description = Description {
            coordinates: header.coordinates,
            dims: 2,
            has_elevation: header.has_elevation,
            crs: header.crs,
            stated_bounds: None,
            attributes: Attributes::default(),
            stated_points: None,
        };
        let chosen = Vertices::new(codec, description, folder)?;
        Ok(Simplification { cells, chosen, meshing, coordinates: header.coordinates })
    }

    /// Chooses more vertices, until all others are at most `tolerance` above or below the triangulation of
    /// the chosen ones. Units: those of elevations in the world. Calls `progress` with the number of the
    /// round, and of the vertices that it has looked at.
    ///
    /// # Errors
    /// Usage, if the tolerance is negative or no number; malformed, if two vertices are at one place; those
    /// of triangulating; if temporary files fail.
    pub fn refine(&mut self, tolerance: f64, progress: &mut dyn FnMut(u64, u64)) -> Result<Stats> {
        // Comparisons with NaN are false.
        if !(0.0..f64::INFINITY).contains(&tolerance) {
            return Err(Error::usage(format!("the tolerance is {tolerance}: give a number from 0 on")));
        }
        let (tolerance, is_integer) = match self.coordinates {
            Coordinates::I32 { scale, .. } => (tolerance / scale[2], true),
            Coordinates::F64 => (tolerance, false),
        };
        let work =
            Work { cells: &self.cells, limit: Limit { tolerance, is_integer }, meshing: &self.meshing };
        let rounds = work.choose(&mut self.chosen, progress)?;
        Ok(Stats { vertices: self.cells.points, chosen: self.chosen.len(), rounds })
    }

    /// Writes the triangulation of what was chosen so far, which may be compressed.
    ///
    /// # Errors
    /// Those of triangulating and writing.
    pub fn write(&self, compress: bool, output: impl Write + Send) -> Result<()> {
        self.meshing.write(&self.chosen, compress, output)
    }
}
