//! Ground on shores that is below the water, of which files state the levels.

use std::path::PathBuf;

use super::shores::{Raise, SHORE_BYTES};
use crate::lines::{self, Levels, Lines, Near, Sources, Target};
use crate::polygons::{Polygons, Side};
use spmesh_base::error::{Error, Result};
use spmesh_base::limits::LINE_VERTEX_BYTES;
use spmesh_delaunay::predicates::Point2;
use spmesh_stream::{Coordinates, Crs};

/// Water whose levels are stated, and the ground up to a distance from it.
#[derive(Debug)]
pub struct Banks {
    water: Polygons,
    shores: Raise,
}

impl Banks {
    /// Reads lakes and rivers for a surface in the system `crs`, with the ground up to `width` away from
    /// them. They may take so many bytes of memory. Also returns messages for the user.
    ///
    /// # Errors
    /// Those of [`lines::read`]; usage, if the level of some water is not stated.
    pub fn read(files: &[PathBuf], width: f64, crs: &Crs, memory: u64) -> Result<(Banks, Vec<String>)> {
        let target = Target { coordinates: Coordinates::F64, crs: crs.clone(), has_elevation: true };
        // Each vertex has an edge, and this an entry among polygons and among shores.
        let memory = memory / (LINE_VERTEX_BYTES + 2 * SHORE_BYTES) * LINE_VERTEX_BYTES;
        let sources = Sources { water: files, ..Sources::default() };
        let Lines { network, water, changes, .. } =
            lines::read(&sources, &target, &lines::Options::default().within(memory))?;
        if let Some(polygon) = water.without_level() {
            let message = "no level is stated: write all levels first, with spfinalize --levels";
            return Err(Error::usage(format!("{}: {message}", polygon.position)));
        }
        let near = vec![Near::default(); water.polygons.len()];
        let levels = Levels::find(&network, &water, &near, lines::MEDIAN, &target)?;
        let banks = Banks {
            water: Polygons::of_edges(water.edges(&network).into_iter()),
            shores: Raise::of(&network, &water, &levels, width, target.coordinates),
        };
        Ok((banks, changes.notices.into_iter().chain(levels.notices).collect()))
    }

    /// How far ground of this elevation is below the water at the nearest place of a shore; `None` in water,
    /// far from it, and where the ground is not lower. The difference is exact in f32, in which rasters hold
    /// elevations.
    pub fn depth(&self, place: Point2, elevation: f32) -> Option<f32> {
        let level = self.shores.level(place)? as f32;
        let depth = level - elevation;
        (depth > 0.0 && self.water.side(place) == Side::Outside).then_some(depth)
    }
}
