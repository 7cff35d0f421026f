//! The Delaunay tetrahedralization of a sample, with tetrahedra at infinity, and the Voronoi vertices.

use std::borrow::Cow;
use std::collections::HashMap;

use super::outward::Outward;
use spmesh_base::error::{Error, Result};
use spmesh_delaunay as delaunay;
use spmesh_delaunay::delaunay3::{Kernel, Tetrahedralization, Tetrahedron};
use spmesh_delaunay::predicates::sphere::SphereBounds;
use spmesh_delaunay::predicates::{FiniteFloatPredicates3, Point3, Predicates3, Sign};
use spmesh_delaunay::simplex::TETRAHEDRON_FACETS;

/// Stands for the vertex at infinity.
pub(super) const INFINITE: u32 = u32::MAX;

/// Stands for no neighbour yet.
const NONE: u32 = u32::MAX;

/// Most tetrahedra for each point, those that insertions have deleted among them, beside a number that any
/// few points may have. Points on surfaces have about ten.
pub(super) const PER_POINT_MAX: usize = 16;
const TETRAHEDRA_MIN: usize = 1 << 12;

/// A tetrahedron of the sample. One at infinity has its facet of the hull first, counterclockwise as seen
/// from outside.
#[derive(Debug, Clone, Copy)]
pub(super) struct Cell {
    pub(super) vertices: [u32; 4],
    pub(super) neighbours: [u32; 4],
}

/// The ball of a tetrahedron: a vertex of the Voronoi diagram, if it is finite.
#[derive(Debug, Clone, Copy)]
pub(super) struct Ball {
    /// About where its centre is.
    pub(super) centre: Point3,
    /// How far off that may be, in all directions; infinite if nothing is known.
    pub(super) error: f64,
    /// About the square of the radius.
    pub(super) square: f64,
    /// Squares of distances up to which points are inside for certain, and from which they are outside.
    inner: f64,
    outer: f64,
    /// The box that certainly has the centre, if one has.
    pub(super) place: Option<u32>,
}

/// Relative error of squares of distances and their differences, with much to spare.
pub(super) const ROUNDING: f64 = 64.0 * f64::EPSILON;

const UNKNOWN: Ball = Ball {
    centre: [0.0; 3],
    error: f64::INFINITY,
    square: 0.0,
    inner: -1.0,
    outer: f64::INFINITY,
    place: None,
};

impl Ball {
    fn of(corners: [Point3; 4]) -> Ball {
        let Some(centre) = SphereBounds::FLOAT.centre(corners) else { return UNKNOWN };
        let error = centre.error.iter().sum::<f64>();
        let [least, greatest] = centre.radii;
        let inner = (least - 2.0 * error).max(0.0);
        let outer = greatest + 2.0 * error;
        // Nothing is known where a square overflows, or the radius may be zero.
        if !(outer * outer).is_finite() || least <= 0.0 {
            return UNKNOWN;
        }
        Ball {
            centre: centre.at,
            error,
            square: least * greatest,
            inner: inner * inner * (1.0 - ROUNDING) - f64::MIN_POSITIVE,
            outer: outer * outer * (1.0 + ROUNDING) + f64::MIN_POSITIVE,
            place: None,
        }
    }
}

/// The Voronoi diagram of a sample.
///
/// Memory: about 700 bytes for each point of the sample.
#[derive(Debug)]
pub(crate) struct Diagram {
    pub(super) points: Vec<Point3>,
    /// Where each point is among those that were given.
    pub(super) given: Vec<u32>,
    pub(super) cells: Vec<Cell>,
    /// The balls of the finite tetrahedra, which are the first.
    pub(super) balls: Vec<Ball>,
}

/// What an insertion of a point would meet: buffers of one thread.
#[derive(Debug, Default)]
pub(super) struct Search {
    /// For each tetrahedron the number of the last search that tested it, and whether it was in conflict.
    tested: Vec<u32>,
    number: u32,
    predicates: FiniteFloatPredicates3,
    /// The tetrahedra in conflict with the point.
    pub(super) conflicts: Vec<u32>,
    /// Facets between these, by their place, and others.
    pub(super) border: Vec<[u32; 2]>,
    /// Where the next search begins.
    last: u32,
}

impl Diagram {
    /// The diagram of points that are all different; `None` if they lie in a plane, or have so many
    /// tetrahedra as only points on curves have.
    ///
    /// # Errors
    /// Those of the kernel.
    pub(crate) fn of(points: &[Point3]) -> Result<Option<Diagram>> {
        let mut mesh = Tetrahedralization::default();
        let mut kernel = Kernel::new();
        kernel.tetrahedra_max = PER_POINT_MAX * points.len() + TETRAHEDRA_MIN;
        match kernel.triangulate(Cow::Borrowed(points), &mut mesh) {
            Err(delaunay::Error::TooManyTetrahedra(_)) => return Ok(None),
            done => done.map_err(Error::of_computation)?,
        }
        drop(kernel);
        if mesh.tetrahedra().is_empty() {
            return Ok(None);
        }
        let points: Vec<Point3> = mesh.vertices().iter().map(|vertex| vertex.at).collect();
        let given = mesh.vertices().iter().map(|vertex| vertex.index).collect();
        // Along the curve of the vertices, so that what is near is near in memory, too: insertion has
        // scattered them.
        let tetrahedra = mesh.tetrahedra();
        let mut order: Vec<u32> = (0..tetrahedra.len() as u32).collect();
        order.sort_unstable_by_key(|&old| tetrahedra[old as usize].vertices.into_iter().max());
        let mut places = vec![0; order.len()];
        (0..).zip(&order).for_each(|(new, &old)| places[old as usize] = new);
        let beyond = |tetrahedron: &Tetrahedron, side| {
            tetrahedron.neighbour(side).map_or(NONE, |corner| places[corner.tetrahedron as usize])
        };
        let mut cells: Vec<Cell> = order
            .iter()
            .map(|&old| &tetrahedra[old as usize])
            .map(|tetrahedron| Cell {
                vertices: tetrahedron.vertices,
                neighbours: std::array::from_fn(|side| beyond(tetrahedron, side)),
            })
            .collect();
        drop(mesh);
        let corners = |cell: &Cell| cell.vertices.map(|vertex| points[vertex as usize]);
        let balls = cells.iter().map(|cell| Ball::of(corners(cell))).collect();
        close(&mut cells);
        Ok(Some(Diagram { points, given, cells, balls }))
    }

    /// Bytes that it takes.
    pub(crate) fn bytes(&self) -> u64 {
        let cells = self.cells.len() * (size_of::<Cell>() + 2 * size_of::<u32>());
        (cells + size_of_val(&*self.balls) + size_of_val(&*self.points) + size_of_val(&*self.given)) as u64
    }

    /// Whether a tetrahedron is at infinity.
    #[inline]
    pub(super) fn is_infinite(&self, cell: u32) -> bool {
        cell as usize >= self.balls.len()
    }

    /// The facet of a tetrahedron opposite to a corner, or that of the hull of one at infinity.
    #[inline]
    pub(super) fn facet(&self, cell: u32, corner: usize) -> [Point3; 3] {
        let vertices = &self.cells[cell as usize].vertices;
        TETRAHEDRON_FACETS[corner].map(|i| self.points[vertices[i] as usize])
    }

    /// The vertex of a tetrahedron that is at `point`, if one is.
    fn vertex_at(&self, cell: u32, point: Point3) -> Option<u32> {
        let mut vertices = self.cells[cell as usize].vertices.into_iter();
        vertices.find(|&vertex| vertex != INFINITE && self.points[vertex as usize] == point)
    }

    /// Finds the tetrahedra in conflict with a point, or those around it if it is one of the sample; returns
    /// whether it is.
    pub(super) fn search(&self, point: Point3, search: &mut Search) -> bool {
        let start = self.walk(point, search);
        let vertex = self.vertex_at(start, point);
        self.flood(start, search, |cell, predicates| match vertex {
            Some(vertex) => self.cells[cell as usize].vertices.contains(&vertex),
            None => self.is_met(cell, point, predicates),
        });
        vertex.is_some()
    }

    /// Finds the tetrahedra that points up to `radius` from `centre` may be in conflict with, while `goes_on`
    /// holds for the box of each.
    ///
    /// Those that the ball around `centre` meets are connected, since it is convex, and have all of them.
    pub(super) fn search_near(
        &self,
        centre: Point3,
        radius: f64,
        search: &mut Search,
        mut goes_on: impl FnMut(Option<u32>) -> bool,
    ) {
        let start = self.walk(centre, search);
        let place = |cell: u32| self.balls.get(cell as usize).and_then(|ball| ball.place);
        let mut searches = goes_on(place(start));
        self.flood(start, search, |cell, _| {
            let is_met = searches && !self.is_far(cell, centre, radius);
            searches &= !is_met || goes_on(place(cell));
            is_met
        });
    }

    /// Whether points up to `radius` from `centre` are certainly not in conflict with a tetrahedron.
    #[inline]
    fn is_far(&self, cell: u32, centre: Point3, radius: f64) -> bool {
        let Some(ball) = self.balls.get(cell as usize) else {
            return self.is_inside_hull(cell, centre, radius);
        };
        let reach = ball.outer.sqrt() + radius;
        // False for a NaN.
        square_of_distance(centre, ball.centre) > reach * reach * (1.0 + ROUNDING)
    }

    /// Finds the tetrahedra around `start` for which `is_met` holds, and the facets where they end.
    #[inline]
    fn flood(
        &self,
        start: u32,
        search: &mut Search,
        mut is_met: impl FnMut(u32, &mut FiniteFloatPredicates3) -> bool,
    ) {
        if search.tested.len() != self.cells.len() || search.number > u32::MAX / 2 - 2 {
            search.tested.clear();
            search.tested.resize(self.cells.len(), 0);
            search.number = 0;
        }
        search.number += 1;
        search.conflicts.clear();
        search.border.clear();
        search.last = start;
        let (outside, inside) = (2 * search.number, 2 * search.number + 1);
        search.tested[start as usize] = inside;
        search.conflicts.push(start);
        let mut next = 0;
        while let Some(&cell) = search.conflicts.get(next) {
            next += 1;
            for beyond in self.cells[cell as usize].neighbours {
                let tested = search.tested[beyond as usize];
                if tested == inside {
                    continue;
                }
                if tested != outside && is_met(beyond, &mut search.predicates) {
                    search.tested[beyond as usize] = inside;
                    search.conflicts.push(beyond);
                } else {
                    search.tested[beyond as usize] = outside;
                    search.border.push([cell, beyond]);
                }
            }
        }
    }

    /// Whether a ball certainly lies inside of a facet of the hull.
    fn is_inside_hull(&self, cell: u32, centre: Point3, radius: f64) -> bool {
        let outward = Outward::of(self, cell);
        let (mut depth, mut error, mut length) = (0.0, 0.0, 0.0);
        for (axis, at) in centre.into_iter().enumerate() {
            let Outward { normal, error: off, from } = outward;
            let way = from[axis] - at;
            depth += normal[axis] * way;
            let size = from[axis].abs() + at.abs();
            error += off[axis] * way.abs() + ROUNDING * normal[axis].abs() * size;
            length += (normal[axis].abs() + off[axis]) * radius;
        }
        depth > (error + length) * (1.0 + ROUNDING) + f64::MIN_POSITIVE
    }

    /// A tetrahedron that has the point, or one at infinity whose facet it lies beyond.
    fn walk(&self, point: Point3, search: &mut Search) -> u32 {
        let mut cell = search.last;
        if self.is_infinite(cell) {
            cell = self.cells[cell as usize].neighbours[3];
        }
        // In a Delaunay tetrahedralization this walk meets no tetrahedron twice.
        while !self.is_infinite(cell) {
            let is_beyond = |side: &usize| {
                let [a, b, c] = self.facet(cell, *side);
                search.predicates.orient3d(point, a, b, c) == Sign::Negative
            };
            let Some(side) = (0..4).find(is_beyond) else { break };
            cell = self.cells[cell as usize].neighbours[side];
        }
        cell
    }

    /// Whether a tetrahedron is in conflict with a point that is none of the sample.
    #[inline]
    fn is_met(&self, cell: u32, point: Point3, predicates: &mut FiniteFloatPredicates3) -> bool {
        let Some(ball) = self.balls.get(cell as usize) else {
            return self.is_met_at_infinity(cell, point, predicates);
        };
        let square = square_of_distance(point, ball.centre);
        if square < ball.inner {
            return true;
        }
        if square > ball.outer {
            return false;
        }
        let [a, b, c, d] = self.cells[cell as usize].vertices.map(|vertex| self.points[vertex as usize]);
        predicates.insphere_perturbed(a, b, c, d, point) == Sign::Positive
    }

    #[cold]
    fn is_met_at_infinity(&self, cell: u32, point: Point3, predicates: &mut FiniteFloatPredicates3) -> bool {
        let Cell { vertices: [a, b, c, _], neighbours } = self.cells[cell as usize];
        let [a, b, c] = [a, b, c].map(|vertex| self.points[vertex as usize]);
        match predicates.orient3d(point, a, b, c) {
            Sign::Negative => true,
            Sign::Positive => false,
            Sign::Zero => self.is_met(neighbours[3], point, predicates),
        }
    }
}

#[inline]
pub(super) fn square_of_distance(p: Point3, q: Point3) -> f64 {
    let [x, y, z] = [p[0] - q[0], p[1] - q[1], p[2] - q[2]];
    x * x + y * y + z * z
}

/// Adds the tetrahedra at infinity.
fn close(cells: &mut Vec<Cell>) {
    // By the vertices of an edge of the hull: one at infinity, and the corner opposite to the facet there.
    let mut open: HashMap<[u32; 2], (u32, usize)> = HashMap::new();
    for inside in 0..cells.len() {
        for (side, facet) in TETRAHEDRON_FACETS.iter().enumerate() {
            if cells[inside].neighbours[side] != NONE {
                continue;
            }
            let added = cells.len() as u32;
            let [a, b, c] = facet.map(|i| cells[inside].vertices[i]);
            let neighbours = [NONE, NONE, NONE, inside as u32];
            cells[inside].neighbours[side] = added;
            cells.push(Cell { vertices: [a, b, c, INFINITE], neighbours });
            for (corner, [p, q]) in [[b, c], [c, a], [a, b]].into_iter().enumerate() {
                match open.remove(&[p.min(q), p.max(q)]) {
                    Some((other, its_corner)) => {
                        cells[added as usize].neighbours[corner] = other;
                        cells[other as usize].neighbours[its_corner] = added;
                    }
                    None => {
                        open.insert([p.min(q), p.max(q)], (added, corner));
                    }
                }
            }
        }
    }
    debug_assert!(open.is_empty(), "the hull is closed");
}
