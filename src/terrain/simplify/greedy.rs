//! Greedy insertion (Garland and Heckbert, 1995): of all points that are too far from the triangulation, the
//! farthest becomes a vertex, until none is.

use std::cmp::{Ordering, Reverse};
use std::collections::BinaryHeap;

use super::plane::Plane;
use spmesh_base::error::{Error, Result};
use spmesh_delaunay::delaunay2::{Kernel, Triangulation};
use spmesh_delaunay::predicates::{FiniteFloatPredicates, Point2, Predicates2, Sign};
use spmesh_stream::model::bounds::Point;

fn twice([x, y, _]: &Point) -> Error {
    Error::malformed(format!("two vertices are at ({x:?}, {y:?}) in stored coordinates"))
}

/// No point.
const NONE: u32 = u32::MAX;

/// How far points may be from the surface.
#[derive(Debug, Clone, Copy)]
pub(super) struct Limit {
    /// Most vertical distance. Units: stored ones.
    pub(super) tolerance: f64,
    /// Whether coordinates are integers.
    pub(super) is_integer: bool,
}

/// The points to insert into the Delaunay triangulation of `seeds`, such that all are near enough to it then,
/// in the order in which they are inserted. It follows from the order of seeds and points.
///
/// Domain: seeds are distinct and not on one line; points are in their hull.
///
/// # Errors
/// Malformed, if a point is outside, or two are at one place.
pub(super) fn choose(seeds: &[Point], points: &[Point], limit: Limit) -> Result<Vec<Point>> {
    if points.is_empty() {
        return Ok(Vec::new());
    }
    let places = seeds.iter().map(|&[x, y, _]| [x, y]).collect();
    let mesh =
        Triangulation::by(&mut Kernel::new(), places).map_err(|error| Error::malformed(error.to_string()))?;
    let heights = seeds.iter().map(|&[.., z]| z).collect();
    let mut greedy = Greedy {
        limit,
        points,
        lists: vec![Points::default(); mesh.triangles().len()],
        mesh,
        heights,
        next: vec![NONE; points.len()],
        waiting: BinaryHeap::new(),
        predicates: FiniteFloatPredicates::default(),
        star: Vec::new(),
    };
    if !greedy.locate()? {
        return Ok(Vec::new());
    }
    let mut chosen = Vec::new();
    while let Some(Farthest { distance, point: Reverse(point), triangle }) = greedy.waiting.pop() {
        let list = &greedy.lists[triangle as usize];
        // Others are of triangles that are no more.
        if (list.farthest, list.distance) == (point, distance) {
            chosen.push(points[point as usize]);
            greedy.insert(point, triangle)?;
        }
    }
    Ok(chosen)
}

/// The points in a triangle.
#[derive(Debug, Clone, Copy)]
struct Points {
    /// The first of the list.
    first: u32,
    /// The one to insert, and its distance.
    farthest: u32,
    distance: f64,
}

impl Default for Points {
    fn default() -> Points {
        Points { first: NONE, farthest: NONE, distance: 0.0 }
    }
}

/// A point that is too far from the triangle that it is in. The greatest is the next one to insert.
#[derive(Debug, PartialEq)]
struct Farthest {
    distance: f64,
    point: Reverse<u32>,
    triangle: u32,
}

impl Eq for Farthest {}

impl PartialOrd for Farthest {
    fn partial_cmp(&self, other: &Farthest) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Farthest {
    fn cmp(&self, other: &Farthest) -> Ordering {
        self.distance.total_cmp(&other.distance).then(self.point.cmp(&other.point))
    }
}

struct Greedy<'p> {
    limit: Limit,
    points: &'p [Point],
    mesh: Triangulation,
    /// Elevations of the vertices.
    heights: Vec<f64>,
    /// The points in each triangle, as lists through `next`.
    lists: Vec<Points>,
    next: Vec<u32>,
    waiting: BinaryHeap<Farthest>,
    predicates: FiniteFloatPredicates,
    star: Vec<Ray>,
}

/// A triangle at the new vertex, and its side there that is clockwise.
struct Ray {
    triangle: u32,
    end: Point2,
    plane: Plane,
}

impl Greedy<'_> {
    /// Puts the points into their triangles. Returns whether one is too far.
    fn locate(&mut self) -> Result<bool> {
        let Some(first) = self.points.first() else { return Ok(false) };
        let mut near = self.mesh.starts().near([first[0], first[1]]);
        let mut plane = (NONE, None);
        for (number, point) in (0..).zip(self.points) {
            let Some(triangle) = self.mesh.triangle_at([point[0], point[1]], &mut near) else {
                return Err(Error::malformed("a vertex is outside of the hull of all vertices"));
            };
            let corners = self.mesh.triangles()[triangle as usize].vertices;
            let at_corner =
                corners.into_iter().map(|corner| self.vertex(corner)).find(|c| c[..2] == point[..2]);
            match at_corner {
                Some(corner) if corner[2] == point[2] => continue,
                Some(_) => return Err(twice(point)),
                None => {}
            }
            if plane.0 != triangle {
                plane = (triangle, Some(self.plane(triangle)));
            }
            let distance = plane.1.map_or(0.0, |plane| plane.distance(point, self.limit.is_integer));
            self.put(number, triangle, distance);
        }
        (0..self.lists.len() as u32).for_each(|triangle| self.wait(triangle));
        Ok(!self.waiting.is_empty())
    }

    /// Puts a point on the list of a triangle.
    #[inline]
    fn put(&mut self, point: u32, triangle: u32, distance: f64) {
        let list = &mut self.lists[triangle as usize];
        self.next[point as usize] = list.first;
        list.first = point;
        if distance > self.limit.tolerance
            && (list.farthest == NONE || (distance, Reverse(point)) > (list.distance, Reverse(list.farthest)))
        {
            (list.distance, list.farthest) = (distance, point);
        }
    }

    /// Lets the farthest point of a triangle wait for its turn.
    fn wait(&mut self, triangle: u32) {
        let Points { farthest, distance, .. } = self.lists[triangle as usize];
        if farthest != NONE {
            self.waiting.push(Farthest { distance, point: Reverse(farthest), triangle });
        }
    }

    fn vertex(&self, vertex: u32) -> Point {
        let [x, y] = self.mesh.points()[vertex as usize];
        [x, y, self.heights[vertex as usize]]
    }

    fn plane(&self, triangle: u32) -> Plane {
        let vertices = self.mesh.triangles()[triangle as usize].vertices;
        Plane::of(vertices.map(|vertex| self.vertex(vertex)))
    }

    /// Makes a point a vertex, and puts those of the triangles that it replaces into the new ones.
    fn insert(&mut self, point: u32, triangle: u32) -> Result<()> {
        let at @ [x, y, z] = self.points[point as usize];
        let before = self.lists.len() as u32;
        let near = self.mesh.triangles()[triangle as usize].vertices[0];
        let vertex = self.mesh.insert_near([x, y], near).map_err(|e| Error::malformed(e.to_string()))?;
        self.heights.push(z);
        self.lists.resize(self.mesh.triangles().len(), Points::default());
        self.look_around(vertex, at);
        if self.star.is_empty() {
            return Err(twice(&at));
        }
        // Triangles that are no more gave their numbers to new ones.
        let mut lists = Vec::with_capacity(self.star.len());
        for ray in self.star.iter().filter(|ray| ray.triangle < before) {
            lists.push(std::mem::take(&mut self.lists[ray.triangle as usize]).first);
        }
        for mut other in lists {
            while other != NONE {
                let next = self.next[other as usize];
                if other != point {
                    self.move_point(other, at);
                }
                other = next;
            }
        }
        (0..self.star.len()).for_each(|turn| self.wait(self.star[turn].triangle));
        Ok(())
    }

    /// Finds the triangles at a new vertex.
    fn look_around(&mut self, vertex: u32, at: Point) {
        let mut star = std::mem::take(&mut self.star);
        star.clear();
        star.extend(self.mesh.arrays().corners_of(vertex).map(|corner| {
            let vertices = self.mesh.triangles()[corner.triangle as usize].vertices;
            let [from, to] = [1, 2].map(|turn| self.vertex(vertices[(corner.corner as usize + turn) % 3]));
            let plane = Plane::of([at, from, to]);
            Ray { triangle: corner.triangle, end: [from[0], from[1]], plane }
        }));
        self.star = star;
    }

    /// Puts a point into the triangle at the new vertex `at` that contains it: the last one whose clockwise
    /// side it is to the left of, or on.
    fn move_point(&mut self, number: u32, at: Point) {
        let (point, origin) = (self.points[number as usize], [at[0], at[1]]);
        let place = [point[0], point[1]];
        let last = self.star.len() - 1;
        let (mut found, mut was_left) = (last, false);
        for (turn, ray) in self.star.iter().enumerate() {
            let is_left = is_left_of(&mut self.predicates, origin, ray.end, place);
            if was_left && !is_left {
                found = turn - 1;
                break;
            }
            was_left = is_left;
        }
        let Ray { triangle, plane, .. } = self.star[found];
        self.put(number, triangle, plane.distance(&point, self.limit.is_integer));
    }
}

/// Whether a place is to the left of a ray, or on its line.
#[inline]
fn is_left_of(predicates: &mut FiniteFloatPredicates, origin: Point2, end: Point2, place: Point2) -> bool {
    predicates.orient2d(origin, end, place) != Sign::Negative
}
