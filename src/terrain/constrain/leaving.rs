//! Rings of areas that leave the mesh.
//!
//! A ring has no edge between the last vertex on it and the border, so it divides the triangles there. They
//! stay whole: what is cut off lies beyond the ring, and each edge of the new border is on a segment, or
//! belongs to a triangle that a ring crosses.

use super::held::Held;
use super::near::Lines;
use spmesh_delaunay::constrained2::Region;
use spmesh_delaunay::predicates::{FiniteFloatPredicates, Predicates2, Sign};
use spmesh_pipeline::lines::Areas;
use spmesh_stream::model::points::Point2;

/// Whether something belongs to the hull, and to the holes.
pub(super) type OfAreas = [bool; 2];

/// The segments that are borders of areas.
#[derive(Debug, Default)]
pub(super) struct Rings {
    /// For each segment; empty if there are no areas.
    areas: Vec<OfAreas>,
}

impl Rings {
    /// The borders of areas among this number of segments.
    pub(super) fn new(areas: &Areas, segments: usize) -> Rings {
        let polygons = [&areas.hull, &areas.holes];
        if polygons.iter().all(|polygons| polygons.is_none()) {
            return Rings::default();
        }
        let mut of = vec![[false; 2]; segments];
        for (area, polygons) in polygons.into_iter().enumerate() {
            for &segment in polygons.iter().flatten().flatten() {
                of[segment as usize][area] = true;
            }
        }
        Rings { areas: of }
    }

    /// Whether a segment is a border of an area.
    pub(super) fn is_border(&self, segment: u32) -> bool {
        self.areas.get(segment as usize).is_some_and(|of| *of != [false; 2])
    }

    /// For each triangle of a region whether the part of a ring crosses it that leaves the mesh; empty if
    /// there is none. All vertices and segments are in the region.
    pub(super) fn leaving(&self, triangles: &[Held], region: &Region, lines: &mut Lines) -> Vec<OfAreas> {
        if self.areas.is_empty() {
            return Vec::new();
        }
        let open = self.open(triangles, lines);
        let mut crossed = Vec::new();
        if open.is_empty() {
            return crossed;
        }
        for entry in region.border() {
            for &segment in &open {
                let ends = lines.network.places(&lines.network.segments[segment as usize]);
                let Some(inwards) = crossing(entry.ends, ends, lines.predicates()) else { continue };
                crossed.resize(region.pieces().len(), [false; 2]);
                for triangle in region.crossed(&entry, inwards, lines.predicates()) {
                    let of = &mut crossed[triangle as usize];
                    (0..2).for_each(|area| of[area] |= self.areas[segment as usize][area]);
                }
            }
        }
        crossed
    }

    /// The segments of rings in a region that leave the mesh: those that stay inside have both of their ends
    /// in the region.
    fn open(&self, triangles: &[Held], lines: &Lines) -> Vec<u32> {
        let is_ring = |segment: &u32| self.is_border(*segment);
        let is_open = |segment: &u32| {
            let ends = lines.network.segments[*segment as usize].ends;
            !ends.iter().all(|&end| lines.is_found(end))
        };
        let segments = triangles.iter().flat_map(|held| &held.segments).copied();
        let mut open: Vec<u32> = segments.filter(is_ring).filter(is_open).collect();
        open.sort_unstable();
        open.dedup();
        open
    }
}

/// Whether a segment crosses a side that has the mesh on its left: its ends, first the one on the right.
pub(super) fn crossing(
    [u, v]: [Point2; 2],
    [p, q]: [Point2; 2],
    predicates: &mut FiniteFloatPredicates,
) -> Option<[Point2; 2]> {
    let is_apart = |axis: usize| {
        p[axis].max(q[axis]) < u[axis].min(v[axis]) || p[axis].min(q[axis]) > u[axis].max(v[axis])
    };
    if is_apart(0) || is_apart(1) {
        return None;
    }
    let mut signs = |[a, b]: [Point2; 2], places: [Point2; 2]| places.map(|at| predicates.orient2d(a, b, at));
    let inwards = match signs([u, v], [p, q]) {
        [Sign::Negative, Sign::Positive] => [p, q],
        [Sign::Positive, Sign::Negative] => [q, p],
        _ => return None,
    };
    let [first, second] = signs(inwards, [u, v]);
    // Seen along the segment, the side begins on the left.
    ([first, second] == [Sign::Positive, Sign::Negative]).then_some(inwards)
}
