//! What a node passes up: points that are not done, and walls around the holes.

use crate::bounds::Point;
use crate::predicates::Point2;

/// Id of a point that has not been written yet.
pub(super) const UNWRITTEN: u64 = u64::MAX;

/// Points that a node has to triangulate, with walls around what is final already.
///
/// The raw points of a leaf are a residual too, one without walls whose points are all unwritten.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Residual {
    /// x and y of each point.
    pub(super) xy: Vec<Point2>,
    /// Elevation of each point; zero where the stream has none.
    pub(super) elevation: Vec<f64>,
    /// Vertex id of each point, or [`UNWRITTEN`].
    pub(super) ids: Vec<u64>,
    /// Directed edges between the points: left of each lies a final triangle, right of it none.
    pub(super) walls: Vec<[u32; 2]>,
    /// Number of points, first of all, that come right from the stream. Only these may coincide.
    pub(super) raw: usize,
    /// Triangles that were not final at the node that left this residual.
    pub(super) active: usize,
}

impl Residual {
    pub(super) fn with_capacity(points: usize, walls: usize) -> Self {
        Residual {
            xy: Vec::with_capacity(points),
            elevation: Vec::with_capacity(points),
            ids: Vec::with_capacity(points),
            walls: Vec::with_capacity(walls),
            raw: 0,
            active: 0,
        }
    }

    pub(super) fn len(&self) -> usize {
        self.xy.len()
    }

    pub(super) fn is_empty(&self) -> bool {
        self.xy.is_empty()
    }

    pub(super) fn push(&mut self, point: Point, id: u64) {
        // Adding zero makes -0.0 the same point as 0.0 in every bit.
        self.xy.push([point[0] + 0.0, point[1] + 0.0]);
        self.elevation.push(point[2]);
        self.ids.push(id);
    }

    /// Adds a point right from the stream; none may have come in another way before.
    pub(super) fn push_raw(&mut self, point: Point) {
        debug_assert_eq!(self.raw, self.len());
        self.push(point, UNWRITTEN);
        self.raw += 1;
    }

    pub(super) fn point(&self, index: usize) -> Point {
        let [x, y] = self.xy[index];
        [x, y, self.elevation[index]]
    }

    /// Takes over the points and walls of `other`, which a node has left.
    pub(super) fn append(&mut self, other: &Residual) {
        debug_assert_eq!(other.raw, 0);
        let first = self.len() as u32;
        self.xy.extend_from_slice(&other.xy);
        self.elevation.extend_from_slice(&other.elevation);
        self.ids.extend_from_slice(&other.ids);
        self.walls.extend(other.walls.iter().map(|wall| wall.map(|end| end + first)));
        self.active += other.active;
    }
}

/// The union of `parts`, in their order.
pub(super) fn union(parts: &[Residual]) -> Residual {
    if let [one] = parts {
        return one.clone();
    }
    let points = parts.iter().map(Residual::len).sum();
    let mut all = Residual::with_capacity(points, parts.iter().map(|part| part.walls.len()).sum());
    parts.iter().for_each(|part| all.append(part));
    all
}
