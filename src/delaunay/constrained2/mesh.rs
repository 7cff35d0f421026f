//! The mesh of a region: triangles with neighbours, and flips.

use crate::predicates::{Point2, Predicates2, Sign};
use foldhash::HashMap;

/// No triangle, no segment.
pub(super) const NONE: u32 = u32::MAX;

/// A triangle, counterclockwise. What has the place of a vertex is opposite to it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Triangle {
    pub(super) vertices: [u32; 3],
    /// The triangles across the sides; [`NONE`] at the border.
    pub(super) neighbours: [u32; 3],
    /// The segments that the sides are on; [`NONE`] for most.
    pub(super) segments: [u32; 3],
}

/// A vertex. A point where triangles of the region meet without a common edge has a vertex for each of these
/// fans, so a turn around a vertex meets all of its triangles.
#[derive(Debug, Clone, Copy)]
pub(super) struct Vertex {
    pub(super) place: Point2,
    pub(super) point: u32,
    pub(super) triangle: u32,
}

/// A side of a triangle.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Side {
    pub(super) triangle: u32,
    /// The place of the vertex opposite to it.
    pub(super) place: usize,
}

/// Triangles of a region with a border.
#[derive(Debug, Clone, Default)]
pub(super) struct Mesh {
    pub(super) vertices: Vec<Vertex>,
    pub(super) triangles: Vec<Triangle>,
    /// The vertices of each triangle at the start.
    pub(super) origins: Vec<[u32; 3]>,
    /// Points and their vertices, in order.
    pub(super) points: Vec<[u32; 2]>,
    /// Sides that may not be locally Delaunay.
    pub(super) doubtful: Vec<Side>,
}

impl Mesh {
    /// The vertices of a point.
    pub(super) fn copies(&self, point: u32) -> Vec<u32> {
        let start = self.points.partition_point(|&[other, _]| other < point);
        self.points[start..].iter().take_while(|&&[other, _]| other == point).map(|&[_, v]| v).collect()
    }

    pub(super) fn place(&self, vertex: u32) -> Point2 {
        self.vertices[vertex as usize].place
    }

    pub(super) fn triangle(&self, number: u32) -> &Triangle {
        &self.triangles[number as usize]
    }

    /// The place of a vertex in a triangle that has it.
    pub(super) fn place_in(&self, triangle: u32, vertex: u32) -> usize {
        let vertices = self.triangle(triangle).vertices;
        vertices.iter().position(|&other| other == vertex).expect("the triangle has the vertex")
    }

    /// The side of the neighbour that a side is; `None` at the border.
    pub(super) fn across(&self, side: Side) -> Option<Side> {
        let Triangle { vertices, neighbours, .. } = *self.triangle(side.triangle);
        let neighbour = neighbours[side.place];
        if neighbour == NONE {
            return None;
        }
        let start = vertices[(side.place + 1) % 3];
        // The neighbour has the side in the other direction, so it ends where this one starts.
        let place = (self.place_in(neighbour, start) + 1) % 3;
        Some(Side { triangle: neighbour, place })
    }

    /// The first that `found` returns for a triangle at a vertex, which it takes as the side opposite to the
    /// vertex. Turns in both directions at once, from the triangle that was written last: what is near it is
    /// found soon, also at a vertex of many triangles.
    pub(super) fn find_around<T>(&self, vertex: u32, mut found: impl FnMut(Side) -> Option<T>) -> Option<T> {
        let at = |triangle: u32| Side { triangle, place: self.place_in(triangle, vertex) };
        let first = at(self.vertices[vertex as usize].triangle);
        if let Some(value) = found(first) {
            return Some(value);
        }
        let mut ways = [Some(first); 2];
        while ways != [None; 2] {
            for way in 0..2 {
                let Some(Side { triangle, place }) = ways[way] else { continue };
                let next = self.across(Side { triangle, place: (place + way + 1) % 3 });
                ways[way] = next.map(|side| at(side.triangle));
                let Some(side) = ways[way] else { continue };
                if let Some(value) = found(side) {
                    return Some(value);
                }
                // Both ways have met, around the whole vertex.
                if ways[1 - way] == ways[way] {
                    return None;
                }
            }
        }
        None
    }

    /// Writes triangle `number` and makes its neighbours and vertices refer to it. Each neighbour comes as
    /// the side that this side is for it.
    pub(super) fn set(
        &mut self,
        number: u32,
        vertices: [u32; 3],
        across: [Option<Side>; 3],
        segments: [u32; 3],
    ) {
        let neighbours = across.map(|side| side.map_or(NONE, |side| side.triangle));
        self.triangles[number as usize] = Triangle { vertices, neighbours, segments };
        for side in across.into_iter().flatten() {
            self.triangles[side.triangle as usize].neighbours[side.place] = number;
        }
        for vertex in vertices {
            self.vertices[vertex as usize].triangle = number;
        }
    }

    /// Flips sides until all that may be flipped are locally Delaunay.
    ///
    /// A side that is not locally Delaunay is the diagonal of a strictly convex quadrilateral, also if the
    /// perturbation decides: four points on a circle are in convex position.
    pub(super) fn restore(&mut self, predicates: &mut impl Predicates2) {
        while let Some(side) = self.doubtful.pop() {
            let triangle = *self.triangle(side.triangle);
            if triangle.segments[side.place] != NONE {
                continue;
            }
            let Some(other) = self.across(side) else { continue };
            let [a, b, c] = [0, 1, 2].map(|turn| self.place(triangle.vertices[(side.place + turn) % 3]));
            let apex = self.triangle(other.triangle).vertices[other.place];
            if predicates.incircle_perturbed(a, b, c, self.place(apex)) == Sign::Positive {
                self.flip(side, other);
            }
        }
    }

    /// Replaces the edge of two sides by the other diagonal.
    fn flip(&mut self, side: Side, other: Side) {
        let (first, second) = (*self.triangle(side.triangle), *self.triangle(other.triangle));
        let [i, j] = [side.place, other.place];
        // The quadrilateral is a, b, d, c, counterclockwise; the edge b c becomes a d.
        let [a, b, c] = [0, 1, 2].map(|turn| first.vertices[(i + turn) % 3]);
        let d = second.vertices[j];
        let outer = |triangle: u32, place: usize| {
            let place = place % 3;
            let segment = self.triangle(triangle).segments[place];
            (self.across(Side { triangle, place }), segment)
        };
        let (ca, ab) = (outer(side.triangle, i + 1), outer(side.triangle, i + 2));
        let (bd, dc) = (outer(other.triangle, j + 1), outer(other.triangle, j + 2));
        let [t, u] = [side.triangle, other.triangle];
        self.set(t, [a, b, d], [bd.0, None, ab.0], [bd.1, NONE, ab.1]);
        self.set(u, [a, d, c], [dc.0, ca.0, None], [dc.1, ca.1, NONE]);
        self.triangles[t as usize].neighbours[1] = u;
        self.triangles[u as usize].neighbours[2] = t;
        let sides = [(t, 0), (t, 2), (u, 0), (u, 1)];
        self.doubtful.extend(sides.map(|(triangle, place)| Side { triangle, place }));
    }
}

/// The mesh of triangles of `points`, see [`super::Region::new`].
pub(super) fn mesh_of(points: &[Point2], triangles: &[[u32; 3]]) -> Mesh {
    let neighbours = neighbours_of(triangles);
    let unknown = |_: &[u32; 3]| [NONE; 3];
    let mut mesh = Mesh { origins: triangles.iter().map(unknown).collect(), ..Mesh::default() };
    for (number, corners) in (0..).zip(triangles) {
        for (place, &point) in corners.iter().enumerate() {
            if mesh.origins[number as usize][place] == NONE {
                let vertex = mesh.vertices.len() as u32;
                mesh.vertices.push(Vertex { place: points[point as usize], point, triangle: number });
                mesh.points.push([point, vertex]);
                name_fan(&mut mesh.origins, triangles, &neighbours, [number, place as u32], vertex);
            }
        }
    }
    mesh.points.sort_unstable();
    let whole = |(&vertices, &neighbours)| Triangle { vertices, neighbours, segments: [NONE; 3] };
    mesh.triangles = mesh.origins.iter().zip(&neighbours).map(whole).collect();
    mesh
}

/// For each triangle the triangles across its sides.
fn neighbours_of(triangles: &[[u32; 3]]) -> Vec<[u32; 3]> {
    let mut neighbours = vec![[NONE; 3]; triangles.len()];
    let mut open: HashMap<[u32; 2], (u32, usize)> = HashMap::default();
    for (number, corners) in (0..).zip(triangles) {
        for place in 0..3 {
            let [from, to] = [corners[(place + 1) % 3], corners[(place + 2) % 3]];
            match open.remove(&[to, from]) {
                Some((other, other_place)) => {
                    neighbours[number as usize][place] = other;
                    neighbours[other as usize][other_place] = number;
                }
                None => {
                    open.insert([from, to], (number, place));
                }
            }
        }
    }
    neighbours
}

/// Gives the corner `[triangle, place]`, and all that a turn around its point reaches, the name `vertex`.
fn name_fan(
    names: &mut [[u32; 3]],
    triangles: &[[u32; 3]],
    neighbours: &[[u32; 3]],
    [start, place]: [u32; 2],
    vertex: u32,
) {
    let point = triangles[start as usize][place as usize];
    // Counterclockwise, the next triangle is across the side opposite to the next vertex; clockwise, the
    // other.
    for turn in [1, 2] {
        let mut triangle = start;
        loop {
            let corners = triangles[triangle as usize];
            let place = corners.iter().position(|&corner| corner == point).expect("the fan has the point");
            names[triangle as usize][place] = vertex;
            triangle = neighbours[triangle as usize][(place + turn) % 3];
            if triangle == NONE || triangle == start {
                break;
            }
        }
    }
}
