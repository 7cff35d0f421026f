//! Triangulates a component of waiting triangles anew.

use super::divided;
use super::held::{Held, Holding};
use super::leaving::OfAreas;
use super::near::Lines;
use foldhash::HashMap;
use spmesh_base::error::{Error, Result};
use spmesh_delaunay::constrained2::{Host, Piece, Region};
use spmesh_delaunay::network::{Network, NetworkSegment, elevation_between};
use spmesh_delaunay::order::{Curve, SpatialOrder};
use spmesh_delaunay::predicates::{Extent, Point2, lexicographic};
use spmesh_pipeline::lines::is_far;
use spmesh_stream::model::bounds::Point;
use spmesh_stream::{Coordinates, Segment};
use std::cmp::Ordering;

/// A component of the constrained triangulation.
#[derive(Debug, Default)]
pub(super) struct Strip {
    /// Numbers of its corners in [`Holding`].
    pub(super) corners: Vec<u32>,
    /// The places of corners, then of new vertices.
    pub(super) places: Vec<Point2>,
    /// Vertices that the mesh did not have, and their numbers in the network; they come after the corners.
    /// Ends of clipped segments have no number.
    pub(super) new: Vec<(Option<u32>, Point)>,
    /// Segments that were clipped.
    pub(super) clipped: Vec<Segment>,
    /// Points are corners, then new vertices.
    pub(super) pieces: Vec<Piece>,
    /// Segments that leave the region before they reach a vertex.
    pub(super) open: Vec<u32>,
    /// Vertices with elevations that are far from those of the triangle that they are in.
    pub(super) far: u64,
    /// For each piece whether the part of a ring crosses it that leaves the mesh; empty if there is none.
    pub(super) crossed: Vec<OfAreas>,
}

/// The constrained triangulation of `triangles`. Clipped segments are numbered from `first_clipped`.
///
/// Vertices with elevations come first, and the segments, as far as they lead from one vertex on them to the
/// next. The others take their elevation from this surface. So a shore whose vertices are in the mesh already
/// bounds its water, whether its file states elevations or not; those that divide it get theirs before.
pub(super) fn triangulate(
    triangles: &[Held],
    holding: &Holding,
    lines: &mut Lines,
    coordinates: &Coordinates,
    first_clipped: u32,
) -> Result<Strip> {
    let mut work = Work::new(triangles, holding);
    let mut region = Region::new(&work.places, &work.triangles);
    let vertices = work.new_vertices(triangles, lines);
    let divided = divided::elevations(lines, &work.segments);
    let (mut far, mut soft) = (0, Vec::new());
    for new in vertices {
        let stated = lines.network.vertices[new.vertex as usize].z;
        let Some(z) = stated.or(divided.get(&new.vertex).map(|&z| coordinates.rounded(z))) else {
            soft.push(new);
            continue;
        };
        far += u64::from(stated.is_some() && is_far(coordinates, z, work.range_of(new.triangle)));
        work.add(&new, z, lines, &mut region);
    }
    if !soft.is_empty() {
        let parts = work.parts(triangles, lines);
        // What leads to a vertex that is still missing is no leaving part.
        work.constrain(&parts, lines, &mut region)?;
        work.open.clear();
        let elevations: Vec<f64> =
            soft.iter().map(|new| work.elevation_of(new, lines, &region, coordinates)).collect();
        for (new, z) in soft.iter().zip(elevations) {
            work.add(new, z, lines, &mut region);
        }
    }
    let parts = work.parts(triangles, lines);
    work.constrain(&parts, lines, &mut region)?;
    let clipped = work.clip(first_clipped, lines, &mut region, coordinates)?;
    let (pieces, crossed) = (region.pieces().collect(), lines.rings.leaving(triangles, &region, lines));
    let Work { corners, places, new, open, .. } = work;
    Ok(Strip { corners, places, new, clipped, pieces, open, far, crossed })
}

/// As many vertices are inserted in any order.
const FEW: usize = 12;

/// A vertex to be inserted.
#[derive(Clone, Copy)]
struct New {
    vertex: u32,
    /// The triangle that it is in.
    triangle: u32,
}

/// Vertices of a triangle follow each other along a curve, so the way from one to the next is short.
fn along_curve(mut vertices: Vec<New>, network: &Network) -> Vec<New> {
    if vertices.len() > FEW {
        let places: Vec<Point2> =
            vertices.iter().map(|new| network.vertices[new.vertex as usize].place).collect();
        let extent = Extent::of(&places);
        let mut order = SpatialOrder::default();
        let sorted = order.sort(&places, &extent, Curve::Hilbert);
        vertices = sorted.map(|index| vertices[index as usize]).collect();
    }
    vertices.sort_by_key(|new| new.triangle);
    vertices
}

/// A segment, and the points of the region on it.
struct Part {
    segment: u32,
    on: Vec<u32>,
}

/// The order of segments by their first ends, then around these: so the next one at a vertex is found soon.
/// It need not be exact.
fn around(network: &Network, a: u32, b: u32) -> Ordering {
    let [a, b] = [a, b].map(|segment| &network.segments[segment as usize]);
    let slope = |segment: &NetworkSegment| {
        // The first end is the lesser one.
        let [p, q] = network.places(segment);
        (q[1] - p[1]) / (q[0] - p[0])
    };
    a.ends[0].cmp(&b.ends[0]).then_with(|| slope(a).total_cmp(&slope(b)))
}

/// The points of a region.
pub(super) struct Work {
    corners: Vec<u32>,
    pub(super) places: Vec<Point2>,
    pub(super) elevations: Vec<f64>,
    pub(super) triangles: Vec<[u32; 3]>,
    /// The segments of the network in the region, in order.
    pub(super) segments: Vec<u32>,
    pub(super) new: Vec<(Option<u32>, Point)>,
    /// The points of new vertices.
    points: HashMap<u32, u32>,
    open: Vec<u32>,
}

impl Work {
    fn new(triangles: &[Held], holding: &Holding) -> Work {
        let mut corners: Vec<u32> = triangles.iter().flat_map(|held| held.corners).collect();
        corners.sort_unstable();
        corners.dedup();
        let point = |&corner: &u32| holding.vertex(corner).point;
        let mut segments: Vec<u32> = triangles.iter().flat_map(|held| &held.segments).copied().collect();
        segments.sort_unstable();
        segments.dedup();
        let local = |corner: u32| corners.binary_search(&corner).expect("a corner of a triangle") as u32;
        Work {
            places: corners.iter().map(point).map(|[x, y, _]| [x, y]).collect(),
            elevations: corners.iter().map(point).map(|[_, _, z]| z).collect(),
            triangles: triangles.iter().map(|held| held.corners.map(local)).collect(),
            corners,
            segments,
            new: Vec::new(),
            points: HashMap::default(),
            open: Vec::new(),
        }
    }

    pub(super) fn places_of(&self, triangle: u32) -> [Point2; 3] {
        self.triangles[triangle as usize].map(|point| self.places[point as usize])
    }

    /// The least and the greatest elevation of the corners of a triangle.
    fn range_of(&self, triangle: u32) -> [f64; 2] {
        let of = self.triangles[triangle as usize].map(|point| self.elevations[point as usize]);
        of.iter().fold([of[0]; 2], |[least, most], &z| [least.min(z), most.max(z)])
    }

    /// The vertices of the network that are in triangles of the region, in their order.
    fn new_vertices(&self, triangles: &[Held], lines: &mut Lines) -> Vec<New> {
        let mut vertices: Vec<New> = Vec::new();
        for (triangle, held) in (0..).zip(triangles) {
            for &vertex in &held.vertices {
                let place = lines.network.vertices[vertex as usize].place;
                if lines.is_in(self.places_of(triangle), place) {
                    vertices.push(New { vertex, triangle });
                }
            }
        }
        // A vertex on an edge is in both of its triangles.
        vertices.sort_unstable_by_key(|new| (new.vertex, new.triangle));
        vertices.dedup_by_key(|new| new.vertex);
        along_curve(vertices, lines.network)
    }

    /// Inserts a vertex with its elevation.
    fn add(&mut self, new: &New, z: f64, lines: &mut Lines, region: &mut Region) {
        let place = lines.network.vertices[new.vertex as usize].place;
        let number = self.places.len() as u32;
        self.places.push(place);
        self.elevations.push(z);
        self.new.push((Some(new.vertex), [place[0], place[1], z]));
        self.points.insert(new.vertex, number);
        lines.find(new.vertex, z);
        region.insert(number, place, new.triangle, lines.predicates());
    }

    /// The segments in the region, with the points on them.
    fn parts(&self, triangles: &[Held], lines: &mut Lines) -> Vec<Part> {
        let mut pairs: Vec<[u32; 2]> = Vec::new();
        for (held, corners) in triangles.iter().zip(&self.triangles) {
            for &segment in &held.segments {
                let on = corners.iter().filter(|&&corner| lines.is_on(segment, self.places[corner as usize]));
                pairs.extend(on.map(|&corner| [segment, corner]));
            }
        }
        if !self.points.is_empty() {
            for &segment in &self.segments {
                let ends = lines.network.segments[segment as usize].ends;
                let new = ends.iter().filter_map(|end| self.points.get(end));
                pairs.extend(new.map(|&point| [segment, point]));
            }
        }
        pairs.sort_unstable();
        pairs.dedup();
        let parts = pairs
            .chunk_by(|a, b| a[0] == b[0])
            .map(|pairs| Part { segment: pairs[0][0], on: pairs.iter().map(|pair| pair[1]).collect() });
        let mut parts: Vec<Part> = parts.collect();
        parts.sort_by(|a, b| around(lines.network, a.segment, b.segment));
        parts
    }

    fn constrain(&mut self, parts: &[Part], lines: &mut Lines, region: &mut Region) -> Result<()> {
        for part in parts {
            let [_, to] = lines.network.places(&lines.network.segments[part.segment as usize]);
            let done = region.constrain(part.segment, to, &part.on, lines.predicates());
            if done.map_err(Error::of_computation)? {
                self.open.push(part.segment);
            }
        }
        Ok(())
    }

    fn elevation_of(&self, new: &New, lines: &mut Lines, region: &Region, coordinates: &Coordinates) -> f64 {
        let place = lines.network.vertices[new.vertex as usize].place;
        self.elevation(place, new.triangle, lines, region, coordinates)
    }

    /// The elevation of the surface at a place in a triangle. It does not depend on the order of triangles
    /// and corners.
    pub(super) fn elevation(
        &self,
        place: Point2,
        triangle: u32,
        lines: &mut Lines,
        region: &Region,
        coordinates: &Coordinates,
    ) -> f64 {
        let mut points = match region.host(place, triangle, lines.predicates()) {
            Host::Point(point) => return self.elevations[point as usize],
            Host::Edge(points) => points.to_vec(),
            Host::Triangle(points) => points.to_vec(),
        };
        points.sort_by(|&a, &b| lexicographic(self.places[a as usize], self.places[b as usize]));
        coordinates.rounded(match points[..] {
            [a, b] => {
                let of = |values: &[f64]| [a, b].map(|point| values[point as usize]);
                let ends = [a, b].map(|point| self.places[point as usize]);
                elevation_between(ends, of(&self.elevations), place)
            }
            [a, b, c] => self.within([a, b, c], place),
            _ => unreachable!("an edge or a triangle"),
        })
    }

    fn difference(&self, from: u32, to: Point2) -> Point2 {
        let from = self.places[from as usize];
        [to[0] - from[0], to[1] - from[1]]
    }

    /// The elevation in a triangle.
    fn within(&self, [a, b, c]: [u32; 3], place: Point2) -> f64 {
        let [u, v] = [b, c].map(|point| self.difference(a, self.places[point as usize]));
        let w = self.difference(a, place);
        let cross = |p: Point2, q: Point2| p[0] * q[1] - p[1] * q[0];
        let [low, second, third] = [a, b, c].map(|point| self.elevations[point as usize]);
        let z = low + ((second - low) * cross(w, v) + (third - low) * cross(u, w)) / cross(u, v);
        z.clamp(low.min(second).min(third), low.max(second).max(third))
    }
}
