//! What is cut from the border of the mesh: all outside of a hull, holes, and triangles with long edges.

use super::leaving::OfAreas;
use foldhash::HashMap;
use spmesh_base::error::Result;
use spmesh_delaunay::network::Network;
use spmesh_delaunay::predicates::lexicographic;
use spmesh_formats::outline::{ConcaveOutline, EdgeLimit, Inside, Waiting};
use spmesh_pipeline::lines::Areas;
use spmesh_pipeline::polygons::Polygons;
use spmesh_stream::Coordinates;
use spmesh_stream::model::bounds::Point;
use spmesh_stream::model::points::Point2;
use std::path::PathBuf;

/// How the border is cut.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct CutOptions {
    /// Remove triangles at edges of the border that are longer and on no segment, until there is none. In
    /// world units.
    pub kill: Option<f64>,
    /// For triangles that `kill` may remove, which wait until the end. Units: bytes.
    pub memory: u64,
    /// Where they wait beyond that; the system's folder for temporary files if `None`.
    pub temp_dir: Option<PathBuf>,
}

/// Decides which triangles stay.
#[derive(Debug)]
pub(super) struct Cut {
    hull: Option<Polygons>,
    holes: Option<Polygons>,
    limit: EdgeLimit,
    outline: Option<ConcaveOutline>,
    is_cut: bool,
    /// Triangles that were removed.
    pub(super) removed: u64,
    /// Triangles that stay because a ring divides them where it leaves the mesh.
    pub(super) divided: u64,
    /// Edges on segments of which one triangle is decided, by the segment and the lesser end: whether it
    /// stays.
    edges: HashMap<(u32, [u64; 2]), bool>,
    /// Segments with an edge of which no triangle stays.
    pub(super) open: Vec<u32>,
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
        let area = |polygons: &Option<Vec<Vec<u32>>>| polygons.as_ref().map(|it| union(network, it));
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
            is_cut: areas.hull.is_some() || areas.holes.is_some() || options.kill.is_some(),
            removed: 0,
            divided: 0,
            edges: HashMap::default(),
            open: Vec::new(),
        }
    }

    /// Whether triangles may be removed, and the greatest length of edges at the border, in stored units, or
    /// 0.
    pub(super) fn claim(&self) -> (bool, f64) {
        (self.is_cut, self.limit.stored_length())
    }

    /// Whether a triangle is inside of the hull and of no hole. `on` are the segments of its sides. Areas
    /// whose rings cross it, as `crossed` says, do not cut it off.
    #[inline]
    pub(super) fn keeps(
        &mut self,
        corners: [Point2; 3],
        on: [Option<u32>; 3],
        [in_hull, off_holes]: OfAreas,
    ) -> bool {
        if self.hull.is_none() && self.holes.is_none() {
            return true;
        }
        let contains = |area: &Polygons| area.has_triangle(corners);
        let is_kept = (in_hull || self.hull.as_ref().is_none_or(contains))
            && (off_holes || !self.holes.as_ref().is_some_and(contains));
        if !is_kept {
            self.removed += 1;
            self.note(corners, on, false);
        }
        self.divided += u64::from(is_kept && (in_hull || off_holes));
        is_kept
    }

    /// Notes on which segments a triangle has sides that stays or was removed.
    pub(super) fn note(&mut self, corners: [Point2; 3], on: [Option<u32>; 3], is_kept: bool) {
        for (place, segment) in on.into_iter().enumerate() {
            let Some(segment) = segment else { continue };
            let [a, b] = [1, 2].map(|turn| corners[(place + turn) % 3]);
            let least = if lexicographic(a, b).is_lt() { a } else { b };
            // -0 and +0 are one place.
            let key = (segment, least.map(|x| (x + 0.0).to_bits()));
            match self.edges.remove(&key) {
                Some(other) if !other && !is_kept => self.open.push(segment),
                Some(_) => (),
                None => {
                    self.edges.insert(key, is_kept);
                }
            }
        }
    }

    /// Whether triangles may be removed.
    #[inline]
    pub(super) fn is_cut(&self) -> bool {
        self.is_cut
    }

    /// Keeps a triangle until the end if it may be removed, and returns whether it did. Vertices have their
    /// ids in the output; `on` are the segments of the sides opposite to them.
    pub(super) fn waits(
        &mut self,
        ids: [u64; 3],
        corners: [Point2; 3],
        on: [Option<u32>; 3],
    ) -> Result<bool> {
        let Some(outline) = &mut self.outline else {
            self.note_kept(corners, on);
            return Ok(false);
        };
        let mut is_long = self.limit.long_edges(corners);
        // The edge behind corner i is opposite to the corner after next.
        (0..3).for_each(|edge| is_long[edge] &= on[(edge + 2) % 3].is_none());
        let waits = outline.take_edges(is_long, Waiting { ids, corners: packed(corners, on), number: 0 })?;
        if !waits {
            self.note_kept(corners, on);
        }
        Ok(waits)
    }

    #[inline]
    fn note_kept(&mut self, corners: [Point2; 3], on: [Option<u32>; 3]) {
        if self.is_cut && on != [None; 3] {
            self.note(corners, on, true);
        }
    }

    /// Whether a triangle that waits has this vertex of the output.
    pub(super) fn holds(&self, id: u64) -> bool {
        self.outline.as_ref().is_some_and(|outline| outline.holds(id))
    }

    /// Ends the mesh: the triangles that waited, and their vertices, in order.
    pub(super) fn finish(&mut self) -> Result<Option<(Inside, Vec<u64>)>> {
        let Some(mut outline) = self.outline.take() else { return Ok(None) };
        let vertices = outline.take_vertices();
        Ok(Some((outline.finish()?, vertices)))
    }

    /// Notes whether a triangle that waited stays. Returns the segments of its sides.
    pub(super) fn decide(&mut self, triangle: &Waiting, is_kept: bool) -> [Option<u32>; 3] {
        let (corners, on) = unpacked(triangle.corners);
        self.note(corners, on, is_kept);
        self.removed += u64::from(!is_kept);
        on
    }

    /// The segments with an edge of which no triangle stays.
    pub(super) fn take_open(&mut self) -> Vec<u32> {
        let mut open = std::mem::take(&mut self.open);
        open.extend(self.edges.drain().filter(|(_, is_kept)| !is_kept).map(|((segment, _), _)| segment));
        open
    }
}

/// The union of polygons whose borders are segments of a network.
fn union(network: &Network, polygons: &[Vec<u32>]) -> Polygons {
    let numbered = (0..).zip(polygons);
    Polygons::of_edges(numbered.flat_map(|(polygon, segments)| {
        segments.iter().map(move |&segment| (polygon, network.places(&network.segments[segment as usize])))
    }))
}

/// Corners and segments in the place of the corners of a triangle that waits.
fn packed([a, b, c]: [Point2; 3], on: [Option<u32>; 3]) -> [Point; 3] {
    let segments = on.map(|segment| segment.map_or(NONE, f64::from));
    [segments, [a[0], a[1], b[0]], [b[1], c[0], c[1]]]
}

fn unpacked([segments, first, second]: [Point; 3]) -> ([Point2; 3], [Option<u32>; 3]) {
    let corners = [[first[0], first[1]], [first[2], second[0]], [second[1], second[2]]];
    (corners, segments.map(|segment| (segment != NONE).then_some(segment as u32)))
}
