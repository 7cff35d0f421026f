//! Points that come after the kernel has run, one by one.

mod cavity;

use super::MAX_POINTS;
use super::half_edge::{HalfEdge, NONE, WORDS, next, number_of, previous};
use super::triangulation::Triangulation;
use crate::error::{Error, Result};
use crate::points::is_finite;
use crate::predicates::{FiniteFloatPredicates, Point2, Predicates2, Sign, lexicographic};
use crate::walk::{Arrival, walk_from_either};
use cavity::{Cavity, Edge};
use std::sync::OnceLock;

/// Starts are found after √n / 16 far walks in a triangulation of n points: to find them takes about as long
/// as these walks did, and so pays for itself.
const FAR_WALKS: usize = 16;

/// Walks that begin far from a point, since starts were found for them.
#[derive(Debug, Clone, Default)]
pub(super) struct FarWalks {
    walks: usize,
    /// How many points there were then.
    count: usize,
}

/// Where a walk to a point ends.
enum Found {
    Vertex(u32),
    /// Inside of the triangle, or on an edge that is not on the hull.
    Inside(u32),
    /// On this half-edge, which is on the hull.
    OnHull(HalfEdge),
    /// Beyond this half-edge, which is on the hull.
    Beyond(HalfEdge),
}

impl Triangulation {
    /// Inserts a point, and returns its index, which is the number of points before.
    ///
    /// The triangles are those that [`triangulate`](super::triangulate) finds for all points, whatever the
    /// order in which they came; their numbers change. A point equal to another is no new vertex, as there.
    ///
    /// # Errors
    /// If a coordinate is not finite, or there are [`MAX_POINTS`] points already. Nothing is changed then.
    ///
    /// Cost: O(1) for points that are spread evenly, amortised. The walk starts at the point inserted last,
    /// or, if that is far, at the nearest of many triangles, of 2 bytes per point; the first far walks take
    /// O(sqrt n) steps. A point beyond the hull, or on it, costs O(h) more for h vertices of the hull; one on
    /// the line of all others, O(n).
    ///
    /// ```
    /// let mut mesh = spmesh_delaunay::delaunay2::triangulate(&[[0.0, 0.0], [4.0, 0.0], [0.0, 4.0]])?;
    /// assert_eq!(mesh.insert([1.0, 1.0])?, 3);
    /// assert_eq!(mesh.simplices().count(), 3);
    /// assert_eq!(mesh.insert([1.0, 1.0])?, 4);
    /// assert_eq!(mesh.representatives()[4], 3);
    /// # Ok::<(), spmesh_delaunay::Error>(())
    /// ```
    pub fn insert(&mut self, point: Point2) -> Result<u32> {
        let last = self.points.len().saturating_sub(1) as u32;
        self.insert_near(point, last)
    }

    /// Inserts a point as [`Triangulation::insert`] does; the walk to it starts at point `near`, which is
    /// best a neighbour. Any index will do, also one that no point has.
    ///
    /// # Errors
    /// As of [`Triangulation::insert`].
    pub fn insert_near(&mut self, point: Point2, near: u32) -> Result<u32> {
        let count = self.points.len();
        if count >= MAX_POINTS {
            return Err(Error::TooManyPoints { count: count + 1, most: MAX_POINTS });
        }
        if !is_finite(&point) {
            return Err(Error::not_finite(count, &point));
        }
        let mut predicates = FiniteFloatPredicates::default();
        let index = count as u32;
        if self.triangles.triangles().is_empty() {
            self.insert_on_line(index, point, &mut predicates);
        } else {
            let found = self.find(point, near, &mut predicates);
            self.insert_at(index, point, found, &mut predicates);
        }
        Ok(index)
    }

    /// Adds the point to the arrays by index, as a vertex.
    fn push(&mut self, point: Point2) {
        self.points.push(point);
        self.triangles.triangle_of_vertex.push(NONE);
    }

    fn push_duplicate(&mut self, index: u32, point: Point2, vertex: u32) {
        self.push(point);
        self.triangles.duplicates.push([index, vertex]);
    }

    /// Inserts vertex `q` where it was found.
    fn insert_at(&mut self, q: u32, at: Point2, found: Found, predicates: &mut FiniteFloatPredicates) {
        let triangles = self.triangles.triangles();
        let edge = |h| Edge::of(triangles, h);
        // The edges of the hull that the new vertex replaces: the place of the first, and how many.
        let mut replaced = None;
        let (inside, edges) = match found {
            Found::Vertex(vertex) => return self.push_duplicate(q, at, vertex),
            Found::Inside(number) => {
                let h = number * WORDS as u32;
                (Some(number), [h + 2, h + 1, h].map(edge).to_vec())
            }
            Found::OnHull(h) => {
                replaced = Some([self.place_on_hull(edge(h).from), 1]);
                (Some(number_of(h)), [previous(h), next(h)].map(edge).to_vec())
            }
            Found::Beyond(h) => {
                let [first, count] = self.visible(self.place_on_hull(edge(h).from), at, predicates);
                replaced = Some([first, count]);
                (None, (first..first + count).map(|place| self.hull_edge(place)).collect())
            }
        };
        let cavity = Cavity::open(triangles, &self.points, at, inside, edges, predicates);
        self.push(at);
        cavity.fill(&mut self.triangles, q, replaced.is_none());
        if let Some([first, count]) = replaced {
            self.replace_on_hull(first, count, q);
        }
    }

    /// Inserts vertex `q` while there are no triangles. The first point off the line makes a fan.
    fn insert_on_line(&mut self, q: u32, at: Point2, predicates: &mut FiniteFloatPredicates) {
        let line = &self.triangles.hull;
        let point = |v: u32| self.points[v as usize];
        let side = match line[..] {
            [first, .., last] => predicates.orient2d(point(first), point(last), at),
            _ => Sign::Zero,
        };
        if side == Sign::Zero {
            match line.binary_search_by(|&v| lexicographic(point(v), at)) {
                Ok(place) => return self.push_duplicate(q, at, self.triangles.hull[place]),
                Err(place) => self.triangles.hull.insert(place, q),
            }
            return self.push(at);
        }
        self.push(at);
        if side == Sign::Negative {
            self.triangles.hull.reverse();
        }
        let edge = |ends: &[u32]| Edge { from: ends[0], to: ends[1], across: NONE };
        let border = self.triangles.hull.windows(2).map(edge).collect();
        Cavity::of_border(border).fill(&mut self.triangles, q, false);
        self.triangles.hull.push(q);
    }

    /// Finds the place of a point, from a triangle at point `near`, or a nearer one.
    fn find(&mut self, at: Point2, near: u32, predicates: &mut FiniteFloatPredicates) -> Found {
        let first = self.triangles.triangle_of_vertex.get(near as usize).copied().unwrap_or(NONE);
        // A duplicate has no triangle.
        let first = if first == NONE { 0 } else { first };
        self.renew_starts();
        let mut is_far = false;
        let far = || {
            is_far = true;
            self.starts.get().map(|starts| starts.near(at))
        };
        let arrival = walk_from_either(self, first, far, at, predicates);
        self.far_walks.walks += usize::from(is_far);
        match arrival.expect("a walk without a limit ends") {
            Arrival::Inside(number, sides) => self.found_in(number, sides),
            Arrival::Outside(number, side) => Found::Beyond(number * WORDS as u32 + side as u32),
        }
    }

    /// Finds starts for walks if there were so many far ones that it pays.
    fn renew_starts(&mut self) {
        let (FarWalks { walks, count: before }, count) = (&self.far_walks, self.points.len());
        if *walks >= count.isqrt().div_ceil(FAR_WALKS).max(1) && count >= 2 * before {
            self.far_walks = FarWalks { walks: 0, count };
            self.starts = OnceLock::new();
            self.starts();
        }
    }

    /// The place of a point in a closed triangle, from its sides of the edges.
    fn found_in(&self, number: u32, signs: [Sign; 3]) -> Found {
        let triangle = &self.triangles.triangles()[number as usize];
        let on = |side: &usize| signs[*side] == Sign::Zero;
        match signs.iter().filter(|&&sign| sign == Sign::Zero).count() {
            2 => Found::Vertex(triangle.vertices[(0..3).find(|side| !on(side)).expect("one of three")]),
            1 => {
                let side = (0..3).find(on).expect("one of three");
                let is_on_hull = triangle.neighbours[side] == NONE;
                let h = number * WORDS as u32 + side as u32;
                if is_on_hull { Found::OnHull(h) } else { Found::Inside(number) }
            }
            _ => Found::Inside(number),
        }
    }

    fn place_on_hull(&self, vertex: u32) -> usize {
        self.triangles.hull.iter().position(|&v| v == vertex).expect("a vertex of the hull")
    }

    /// The vertex of the hull at a place, which may exceed the last one by up to a turn.
    fn hull_vertex(&self, place: usize) -> u32 {
        let hull = &self.triangles.hull;
        hull[if place < hull.len() { place } else { place - hull.len() }]
    }

    /// The edge of the hull that starts at a place, seen from outside.
    fn hull_edge(&self, place: usize) -> Edge {
        let [from, to] = [place, place + 1].map(|place| self.hull_vertex(place));
        let number = self.triangles.triangle_of_vertex[from as usize];
        let vertices = self.triangles.triangles()[number as usize].vertices;
        let corner = vertices.iter().position(|&v| v == from).expect("the triangle has the vertex");
        Edge { from: to, to: from, across: number * WORDS as u32 + (corner as u32 + 2) % 3 }
    }

    /// The edges of the hull that a point is strictly beyond, one of which starts at a place: the place of
    /// the first, and how many.
    fn visible(&self, place: usize, at: Point2, predicates: &mut FiniteFloatPredicates) -> [usize; 2] {
        let len = self.triangles.hull.len();
        let mut sees = |place: usize| {
            let [a, b] = [place, place + 1].map(|place| self.points[self.hull_vertex(place) as usize]);
            predicates.orient2d(a, b, at) == Sign::Negative
        };
        // A point beyond all edges does not exist.
        let before = (1..len).find(|&back| !sees((place + len - back) % len)).expect("a hidden edge") - 1;
        let after = (1..len).find(|&ahead| !sees((place + ahead) % len)).expect("a hidden edge");
        [(place + len - before) % len, before + after]
    }

    /// Puts vertex `q` in place of the vertices of the hull between some edges, which follow each other.
    fn replace_on_hull(&mut self, mut first: usize, count: usize, q: u32) {
        let hull = &mut self.triangles.hull;
        if first + count > hull.len() {
            hull.rotate_left(first);
            first = 0;
        }
        hull.splice(first + 1..first + count, [q]);
    }
}
