//! What is cut from the border of the mesh: all outside of a hull, holes, and triangles with long edges.

use super::area::Area;
use spmesh_core::error::Result;
use spmesh_io::outline::{ConcaveOutline, EdgeLimit, Inside, Waiting};
use spmesh_lines::Areas;
use spmesh_model::network::Network;
use spmesh_model::points::Point2;
use spmesh_stream::Coordinates;
use std::path::PathBuf;

/// How the border is cut.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct CutOptions {
    /// Remove triangles at edges of the border that are longer and on no segment, until there is none. In world
    /// units.
    pub kill: Option<f64>,
    /// For triangles that `kill` may remove, which wait until the end. Units: bytes.
    pub memory: u64,
    /// Where they wait beyond that; the system's folder for temporary files if `None`.
    pub temp_dir: Option<PathBuf>,
}

/// Decides which triangles stay.
#[derive(Debug)]
pub(super) struct Cut {
    hull: Option<Area>,
    holes: Option<Area>,
    limit: EdgeLimit,
    outline: Option<ConcaveOutline>,
    /// Triangles that were removed.
    pub(super) removed: u64,
}

/// No segment, where triangles that wait name those of their sides.
const NONE: f64 = -1.0;

impl Cut {
    pub(super) fn new(
        network: &Network,
        areas: &Areas,
        coordinates: &Coordinates,
        options: &CutOptions,
    ) -> Cut {
        let area = |polygons: &Option<Vec<Vec<u32>>>| polygons.as_ref().map(|it| Area::new(network, it));
        let outline = options.kill.map(|length| {
            ConcaveOutline::new(length, coordinates, options.memory, options.temp_dir.as_deref())
                .with_vertices()
                .of_flag("--kill")
        });
        Cut {
            hull: area(&areas.hull),
            holes: area(&areas.holes),
            limit: EdgeLimit::new(options.kill, coordinates),
            outline,
            removed: 0,
        }
    }

    /// Whether triangles may be removed, and the greatest length of edges at the border, in stored units, or 0.
    pub(super) fn claim(&self) -> (bool, f64) {
        let is_cut = self.hull.is_some() || self.holes.is_some() || self.outline.is_some();
        (is_cut, self.limit.stored_length())
    }

    /// Whether a triangle is inside of the hull and of no hole.
    #[inline]
    pub(super) fn keeps(&mut self, corners: [Point2; 3]) -> bool {
        let is_kept = self.hull.as_mut().is_none_or(|hull| hull.contains(corners))
            && !self.holes.as_mut().is_some_and(|holes| holes.contains(corners));
        self.removed += u64::from(!is_kept);
        is_kept
    }

    /// Whether triangles may have to wait.
    #[inline]
    pub(super) fn may_wait(&self) -> bool {
        self.outline.is_some()
    }

    /// Keeps a triangle until the end if it may be removed, and returns whether it did. Vertices have their ids in
    /// the output; `on` are the segments of the sides opposite to them.
    ///
    /// # Errors
    /// As [`ConcaveOutline::take_edges`].
    pub(super) fn waits(
        &mut self,
        ids: [u64; 3],
        corners: [Point2; 3],
        on: [Option<u32>; 3],
    ) -> Result<bool> {
        let Some(outline) = &mut self.outline else { return Ok(false) };
        let mut is_long = self.limit.long_edges(corners);
        // The edge behind corner i is opposite to the corner after next.
        (0..3).for_each(|edge| is_long[edge] &= on[(edge + 2) % 3].is_none());
        let named = on.map(|segment| segment.map_or(NONE, f64::from));
        outline.take_edges(is_long, Waiting { ids, corners: [named; 3], number: 0 })
    }

    /// Whether a triangle that waits has this vertex of the output.
    pub(super) fn holds(&self, id: u64) -> bool {
        self.outline.as_ref().is_some_and(|outline| outline.holds(id))
    }

    /// Ends the mesh: the triangles that waited and stay, and the vertices of all that waited, in order.
    ///
    /// # Errors
    /// If the temporary file cannot be read.
    pub(super) fn finish(&mut self) -> Result<Option<(Inside, Vec<u64>)>> {
        let Some(mut outline) = self.outline.take() else { return Ok(None) };
        let vertices = outline.take_vertices();
        let inside = outline.finish()?;
        self.removed += inside.outside;
        Ok(Some((inside, vertices)))
    }
}

/// The segments of the sides of a triangle that waited.
pub(super) fn segments_of(triangle: &Waiting) -> [Option<u32>; 3] {
    triangle.corners[0].map(|segment| (segment != NONE).then_some(segment as u32))
}
