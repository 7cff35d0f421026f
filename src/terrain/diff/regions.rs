//! Polygons by which volumes are told apart.
//!
//! A polygon is what is below its upper edges and not below its lower ones. So the volume of a piece in it is
//! a sum over edges: that below the edge's line and to the left of its right end, minus that below it and to
//! the left of its left end. Each of these terms is rounded by itself and depends on nothing but the piece, a
//! line and an end. Terms of a border that polygons have in common cancel, and those of parts of a horizontal
//! edge make that of the whole one.

use super::Real;
use super::overlap::Vertex;
use super::piece::{Corner, Figures, Piece};
use spmesh_base::error::{Error, Result};
use spmesh_delaunay::noding::{COORDINATE_MAX, LineVertex, NodingChange, NodingOptions, node_lines};
use spmesh_delaunay::predicates::Pair;
use spmesh_formats::source::Polygon;

use super::grid::Grid;

/// A place in units of polygons.
type Place = [i64; 2];

/// A closed box in units of polygons.
#[derive(Debug, Clone, Copy)]
struct Area {
    min: Place,
    max: Place,
}

impl Area {
    fn of(bounds: &[[i64; 2]; 2], parts: i64) -> Area {
        let [min, max] = bounds.map(|corner| corner.map(|value| value * parts));
        Area { min, max }
    }
}

/// An edge of a polygon, from its left end to its right one.
#[derive(Debug, Clone, Copy)]
struct Edge {
    ends: [Place; 2],
    /// Whether the polygon is below it.
    is_upper: bool,
}

/// The polygons of a comparison; the whole plane if there are none.
#[derive(Debug)]
pub(super) struct Regions {
    polygons: Vec<Vec<Edge>>,
    parts: i64,
}

/// The polygons near a box.
#[derive(Debug, Clone)]
pub(super) struct Near {
    parts: i64,
    /// Those that contain all of it.
    pub(super) around: Vec<usize>,
    /// Those with edges in it, and of these the edges that are not to the left, to the right or below.
    crossing: Vec<(usize, Vec<Edge>)>,
}

impl Regions {
    /// Polygons on a grid.
    ///
    /// # Errors
    /// Usage, if edges of a polygon cross each other.
    pub(super) fn new(polygons: &[Polygon], grid: &Grid) -> Result<Regions> {
        let edges = |(number, polygon): (usize, &Polygon)| {
            let place = |&world: &[f64; 2]| grid.place(world);
            let rings: Vec<Vec<Place>> =
                polygon.iter().map(|ring| ring.iter().map(place).collect()).collect();
            check(&rings).map_err(|problem| {
                let what = format!("polygon {} {problem}", number + 1);
                Error::usage(format!("{what}: repair it, for example with ogr2ogr -makevalid"))
            })?;
            Ok(edges_of(&rings))
        };
        let polygons = polygons.iter().enumerate().map(edges).collect::<Result<_>>()?;
        Ok(Regions { polygons, parts: grid.parts })
    }

    /// Number of results: one for each polygon, or one for the plane.
    pub(super) fn count(&self) -> usize {
        self.polygons.len().max(1)
    }

    /// The polygons near a box of vertices.
    pub(super) fn near(&self, bounds: &[[i64; 2]; 2]) -> Near {
        let area = Area::of(bounds, self.parts);
        let mut near = Near { parts: self.parts, around: Vec::new(), crossing: Vec::new() };
        if self.polygons.is_empty() {
            near.around.push(0);
        }
        self.polygons.iter().enumerate().for_each(|(number, edges)| near.look_at(number, edges, &area));
        near
    }
}

impl Near {
    /// Whether no edge is near.
    pub(super) fn is_plain(&self) -> bool {
        self.crossing.is_empty()
    }

    /// The polygons near a box in this one.
    pub(super) fn within(&self, bounds: &[[i64; 2]; 2]) -> Near {
        let area = Area::of(bounds, self.parts);
        let mut near = Near { parts: self.parts, around: self.around.clone(), crossing: Vec::new() };
        self.crossing.iter().for_each(|(number, edges)| near.look_at(*number, edges, &area));
        near
    }

    fn look_at(&mut self, number: usize, edges: &[Edge], area: &Area) {
        if edges.iter().any(|edge| edge.meets(area)) {
            let edges = edges.iter().filter(|edge| edge.is_over(area)).copied().collect();
            self.crossing.push((number, edges));
        } else if edges.iter().filter(|edge| edge.is_above(area.min)).count() % 2 == 1 {
            self.around.push(number);
        }
    }

    /// Passes the figures of the parts of a piece to `add`, with the number of the polygon, and whether they
    /// are added. Corners of the piece count from `origin`, and its box is the one of these polygons.
    pub(super) fn divide(
        &self,
        piece: &Piece,
        origin: &Vertex,
        mut add: impl FnMut(usize, &Figures<Real>, bool),
    ) {
        if !self.around.is_empty() {
            let whole = piece.figures();
            self.around.iter().for_each(|&number| add(number, &whole, true));
        }
        for (number, edges) in &self.crossing {
            for edge in edges {
                for (end, is_right) in [(edge.ends[1], true), (edge.ends[0], false)] {
                    let part = edge.below(piece, end, origin, self.parts);
                    add(*number, &part.figures(), edge.is_upper == is_right);
                }
            }
        }
    }
}

impl Edge {
    fn is_vertical(&self) -> bool {
        self.ends[0][0] == self.ends[1][0]
    }

    fn side(&self, place: Place) -> i128 {
        side(self.ends[0], self.ends[1], place)
    }

    /// Whether it may have a place in common with a box.
    fn meets(&self, Area { min, max }: &Area) -> bool {
        let [p, q] = self.ends;
        let overlaps =
            (0..2).all(|axis| p[axis].min(q[axis]) <= max[axis] && min[axis] <= p[axis].max(q[axis]));
        let mut sides =
            [[min[0], min[1]], [max[0], min[1]], [max[0], max[1]], [min[0], max[1]]].map(|at| self.side(at));
        sides.sort_unstable();
        overlaps && sides[0] <= 0 && sides[3] >= 0
    }

    /// Whether its terms for a piece in a box may be other than zero.
    fn is_over(&self, Area { min, max }: &Area) -> bool {
        let [p, q] = self.ends;
        p[0] <= max[0] && min[0] <= q[0] && p[1].max(q[1]) >= min[1]
    }

    /// Whether it is above a place.
    fn is_above(&self, place: Place) -> bool {
        let [p, q] = self.ends;
        p[0] <= place[0] && place[0] < q[0] && self.side(place) < 0
    }

    /// The part of a piece that is below the line of the edge and to the left of an end of it.
    fn below(&self, piece: &Piece, end: Place, origin: &Vertex, parts: i64) -> Piece {
        if self.is_vertical() {
            return Piece::default();
        }
        let near = |place: Place| {
            [0, 1].map(|axis| {
                let units = i128::from(place[axis]) - i128::from(origin[axis]) * i128::from(parts);
                Real::from(units) * Pair(1.0 / parts as f64, 0.0)
            })
        };
        let [[px, py], [qx, qy], [right, _]] = [self.ends[0], self.ends[1], end].map(near);
        let part = piece.part(|corner| right - corner.place[0], false);
        // The line of a horizontal edge must not depend on where it begins and ends.
        if self.ends[0][1] == self.ends[1][1] {
            return part.part(|corner| py - corner.place[1], false);
        }
        let (dx, dy) = (qx - px, qy - py);
        part.part(|&Corner { place: [x, y], .. }| dy * (x - px) - dx * (y - py), false)
    }
}

/// Twice the area of a triangle, positive if it is counterclockwise.
fn side(p: Place, q: Place, at: Place) -> i128 {
    let [[dx, dy], [x, y]] =
        [q, at].map(|end| [0, 1].map(|axis| i128::from(end[axis]) - i128::from(p[axis])));
    dx * y - dy * x
}

fn ring_edges(ring: &[Place]) -> impl Iterator<Item = [Place; 2]> {
    ring.iter().zip(ring.iter().cycle().skip(1)).map(|(&from, &to)| [from, to])
}

/// The edges of rings that do not cross. A ring has its inside on the left, or on the right if it is
/// clockwise or a hole.
fn edges_of(rings: &[Vec<Place>]) -> Vec<Edge> {
    let directed = |[from, to]: [Place; 2]| if from[0] <= to[0] { [from, to] } else { [to, from] };
    let plain = |ring: &Vec<Place>| -> Vec<Edge> {
        ring_edges(ring).map(|ends| Edge { ends: directed(ends), is_upper: false }).collect()
    };
    let each: Vec<Vec<Edge>> = rings.iter().map(plain).collect();
    let mut edges = Vec::new();
    for (number, ring) in rings.iter().enumerate() {
        let twice: i128 = ring_edges(ring).map(|[p, q]| side(ring[0], p, q)).sum();
        let others = each.iter().enumerate().filter(|(other, _)| *other != number);
        let depth = others.filter(|(_, other)| is_in(ring, other)).count();
        let is_left = (twice > 0) == (depth % 2 == 0);
        edges.extend(ring_edges(ring).map(|ends| {
            let goes_right = ends[0][0] < ends[1][0];
            Edge { ends: directed(ends), is_upper: goes_right != is_left }
        }));
    }
    edges
}

/// Whether a ring is inside of another one, which it does not cross: by a vertex that is not on its border.
fn is_in(ring: &[Place], other: &[Edge]) -> bool {
    let on_border = |&place: &Place| {
        let at = Area { min: place, max: place };
        other.iter().any(|edge| edge.meets(&at))
    };
    let free = ring.iter().copied().find(|place| !on_border(place));
    free.is_some_and(|place| other.iter().filter(|edge| edge.is_above(place)).count() % 2 == 1)
}

/// Checks that rings touch themselves and each other in single places at most.
fn check(rings: &[Vec<Place>]) -> std::result::Result<(), String> {
    let Some(&[left, low]) = rings.iter().flatten().min() else { return Ok(()) };
    let mut vertices = Vec::new();
    let mut starts = Vec::new();
    for ring in rings {
        starts.push(vertices.len() as u32);
        let near = |&[x, y]: &Place| LineVertex { place: [x - left, y - low], z: None };
        vertices.extend(ring.iter().chain(ring.first()).map(near));
    }
    if vertices.iter().flat_map(|vertex| vertex.place).any(|value| value.abs() > COORDINATE_MAX) {
        return Err("is too large for the grid of the mesh".into());
    }
    let mut problem = None;
    let options = NodingOptions { round_elevations: false, crossings_max: 1000, bytes_max: u64::MAX };
    let mut note = |change, _, _: Place| {
        if matches!(change, NodingChange::Crossing | NodingChange::Overlap | NodingChange::Spike) {
            problem = Some("has edges that cross or cover each other");
        }
    };
    let noded = node_lines(vertices.into(), &starts, &options, &mut note);
    noded.map_err(|error| format!("has edges that cross each other ({error})"))?;
    problem.map_or(Ok(()), |problem| Err(problem.to_string()))
}
