//! Segments that leave the mesh, up to its border.
//!
//! The place where a segment crosses the border is no place of the grid, as a rule. The nearest place of the
//! grid on this side becomes a vertex, and the way to it from the last vertex on the segment a segment of its
//! own. Rings of areas are left as they are: they cut the mesh.
//!
//! Triangles must wait whose circles contain the new vertex. It is close to the hull of the mesh, so such a
//! circle reaches beyond what is known of the hull, and near the segment. Borders that are inside of the
//! hull, of meshes that are not convex, get no new vertices.

use std::cmp::Ordering;
use std::collections::BTreeMap;

use super::leaving::crossing;
use super::near::Lines;
use super::strip::Work;
use spmesh_base::error::{Error, Result};
use spmesh_delaunay::constrained2::Region;
use spmesh_delaunay::network::{NetworkSegment, elevation_between};
use spmesh_delaunay::predicates::Point2;
use spmesh_stream::{Coordinates, Segment};

/// Steps of the grid from the border to the new vertex: the first that suits is taken.
const STEPS: [f64; 12] = [0.0, 1.0, 2.0, 3.0, 4.0, 6.0, 8.0, 16.0, 32.0, 64.0, 128.0, 256.0];

/// With its rounding, the new vertex is nearer to the border than so many steps.
pub(super) const STEPS_MAX: f64 = 258.0;

/// Where a segment comes into the mesh.
struct Entry {
    at: Point2,
    /// A step of the grid along the segment.
    step: Point2,
}

impl Entry {
    /// Where the way from one place to another crosses a side.
    fn new(side: [Point2; 2], [from, to]: [Point2; 2], step: f64) -> Entry {
        let way = [to[0] - from[0], to[1] - from[1]];
        let [u, v] = side.map(|end| way[0] * (end[1] - from[1]) - way[1] * (end[0] - from[0]));
        let at = [0, 1].map(|axis| side[0][axis] + u / (u - v) * (side[1][axis] - side[0][axis]));
        Entry { at, step: way.map(|value| value / way[0].hypot(way[1]) * step) }
    }

    /// How far along the segment a place is, in steps.
    fn along(&self, place: Point2) -> f64 {
        (0..2).map(|axis| (place[axis] - self.at[axis]) * self.step[axis]).sum()
    }
}

/// A place that may become the end of a segment: the triangle that it was in, and its elevation.
struct End {
    place: Point2,
    triangle: u32,
    z: f64,
}

impl Work {
    /// Makes the ways to the border edges, of those segments in the region that leave the mesh. All vertices
    /// and segments are in the region. Returns new segments, which are numbered from `first`.
    pub(super) fn clip(
        &mut self,
        first: u32,
        lines: &mut Lines,
        region: &mut Region,
        coordinates: &Coordinates,
    ) -> Result<Vec<Segment>> {
        let mut clipped: Vec<Segment> = Vec::new();
        // All triangles are in the region that a segment divides, so an end that is in the mesh was found.
        let is_found = |end: u32| lines.is_found(end);
        let ends = |segment: u32| lines.network.segments[segment as usize].ends;
        let is_left =
            |&segment: &u32| !lines.rings.is_border(segment) && !ends(segment).into_iter().all(is_found);
        let leaving: Vec<u32> = self.segments.iter().copied().filter(is_left).collect();
        if leaving.is_empty() {
            return Ok(clipped);
        }
        for (segment, entries) in entries(region, &leaving, lines) {
            let NetworkSegment { line, ends, .. } = lines.network.segments[segment as usize];
            let ends = ends.map(|end| lines.network.vertices[end as usize].place);
            let mut on: Vec<u32> = (0..self.places.len() as u32).collect();
            on.retain(|&point| lines.is_on(segment, self.places[point as usize]));
            let has_edges = on.len() > 1;
            // Without a vertex on it, a segment has two ends at the border.
            let is_lost = on.is_empty() && entries.len() < 2;
            for entry in entries.into_iter().filter(|_| !is_lost) {
                let along = |point: &u32| entry.along(self.places[*point as usize]);
                let next = on.iter().copied().min_by(|a, b| along(a).total_cmp(&along(b)));
                let end = self.end(segment, &entry, next, (&clipped, &*region), lines, coordinates);
                let Some(end) = end else { continue };
                let is_end = next.is_some_and(|next| ends.contains(&self.places[next as usize]));
                // A vertex amid a segment that has edges belongs to no other segment.
                let is_own = (is_end || has_edges) && lines.is_on(segment, end.place);
                if !is_own && !is_end && has_edges {
                    continue;
                }
                let point = self.places.len() as u32;
                self.add_end(&end, region, lines);
                on.push(point);
                let Some(next) = next else { continue };
                let number = if is_own { segment } else { first + clipped.len() as u32 };
                region
                    .constrain(number, end.place, &[next], lines.predicates())
                    .map_err(Error::of_computation)?;
                if !is_own {
                    clipped.push(Segment { line, ends: [self.places[next as usize], end.place] });
                }
            }
        }
        Ok(clipped)
    }

    /// The end of a segment at the border: the first place behind it that suits. `next` is the vertex after
    /// it.
    fn end(
        &self,
        segment: u32,
        entry: &Entry,
        next: Option<u32>,
        (clipped, region): (&[Segment], &Region),
        lines: &mut Lines,
        coordinates: &Coordinates,
    ) -> Option<End> {
        let step = lines.network.step;
        // Decimals are quotients of integers.
        let per_unit = if step < 1.0 { (1.0 / step).round() } else { 1.0 / step };
        for steps in STEPS {
            let place = [0, 1].map(|axis| entry.at[axis] + steps * entry.step[axis]);
            let place = place.map(|value| (value * per_unit).round() / per_unit);
            let is_short =
                next.is_some_and(|next| entry.along(place) >= entry.along(self.places[next as usize]));
            if is_short || !lines.holds(place, segment) || self.is_taken(place, segment, clipped, lines) {
                continue;
            }
            let corners = |triangle: &u32| self.places_of(*triangle);
            let triangle = (0..self.triangles.len() as u32).find(|it| lines.is_in(corners(it), place));
            let Some(triangle) = triangle else { continue };
            if next.is_none_or(|next| region.sees(next, place, lines.predicates())) {
                let z = self.elevation_on(segment, place, triangle, region, lines, coordinates);
                return Some(End { place, triangle, z });
            }
        }
        None
    }

    /// Whether a place has a vertex, or is on another segment of the region.
    fn is_taken(&self, place: Point2, own: u32, clipped: &[Segment], lines: &mut Lines) -> bool {
        self.places.contains(&place)
            || self.segments.iter().any(|&segment| segment != own && lines.is_on(segment, place))
            || clipped.iter().any(|it| lines.is_between(it.ends, place))
    }

    /// The elevation of a segment, or else that of the surface.
    fn elevation_on(
        &self,
        segment: u32,
        place: Point2,
        triangle: u32,
        region: &Region,
        lines: &mut Lines,
        coordinates: &Coordinates,
    ) -> f64 {
        let segment = &lines.network.segments[segment as usize];
        match lines.network.elevations(segment) {
            Some(elevations) => {
                coordinates.rounded(elevation_between(lines.network.places(segment), elevations, place))
            }
            None => self.elevation(place, triangle, lines, region, coordinates),
        }
    }

    fn add_end(&mut self, end: &End, region: &mut Region, lines: &mut Lines) {
        let &End { place, triangle, z } = end;
        let point = self.places.len() as u32;
        self.places.push(place);
        self.elevations.push(z);
        self.new.push((None, [place[0], place[1], z]));
        region.insert(point, place, triangle, lines.predicates());
    }
}

/// The places where segments that leave the mesh come into it, from one end or the other.
fn entries(region: &Region, leaving: &[u32], lines: &mut Lines) -> BTreeMap<u32, Vec<Entry>> {
    let mut entries: BTreeMap<u32, Vec<Entry>> = BTreeMap::new();
    for side in region.border() {
        for segment in lines.near_side(side.ends, leaving) {
            let ends = lines.network.places(&lines.network.segments[segment as usize]);
            if let Some(inwards) = crossing(side.ends, ends, lines.predicates()) {
                let entry = Entry::new(side.ends, inwards, lines.network.step);
                if !lines.hull.contains(entry.at, 0.0) {
                    entries.entry(segment).or_default().push(entry);
                }
            }
        }
    }
    entries
        .values_mut()
        .for_each(|two| two.sort_by(|a, b| a.at.partial_cmp(&b.at).unwrap_or(Ordering::Equal)));
    entries
}
