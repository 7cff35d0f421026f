//! What a node triangulates, and what it passes up: points that are not done, and walls around the holes.

use crate::bounds::Point;
use crate::predicates::Point2;

/// Key of a point that is no vertex yet.
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
    /// Number of points, first of all, that come right from the stream. Only these may coincide.
    pub(super) raw: usize,
    /// For each point behind the raw ones, a number that orders vertices as the stream does, or [`UNWRITTEN`].
    pub(super) keys: Vec<u64>,
    /// Directed edges between the points: left of each lies a final triangle, right of it none.
    pub(super) walls: Vec<[u32; 2]>,
    /// Triangles that were not final at the node that left this residual.
    pub(super) active: usize,
}

impl Residual {
    pub(super) fn with_capacity(points: usize, walls: usize) -> Self {
        Residual {
            xy: Vec::with_capacity(points),
            elevation: Vec::with_capacity(points),
            raw: 0,
            keys: Vec::with_capacity(points),
            walls: Vec::with_capacity(walls),
            active: 0,
        }
    }

    pub(super) fn len(&self) -> usize {
        self.xy.len()
    }

    pub(super) fn is_empty(&self) -> bool {
        self.xy.is_empty()
    }

    /// Empties all arrays, keeping their memory.
    pub(super) fn clear(&mut self) {
        self.xy.clear();
        self.elevation.clear();
        self.raw = 0;
        self.keys.clear();
        self.walls.clear();
        self.active = 0;
    }

    /// Adds a point that a node has left.
    pub(super) fn push(&mut self, point: Point, key: u64) {
        self.xy.push(plane(&point));
        self.elevation.push(point[2]);
        self.keys.push(key);
    }

    /// Adds points right from the stream; none may have come in another way before.
    pub(super) fn extend_raw(&mut self, points: &[Point]) {
        debug_assert_eq!(self.raw, self.len());
        // By an eighth, not twofold: so much more memory would lie idle in each leaf under way.
        let growth = points.len().max(self.len() / 8);
        if self.xy.capacity() - self.len() < points.len() {
            self.xy.reserve_exact(growth);
            self.elevation.reserve_exact(growth);
        }
        self.xy.extend(points.iter().map(plane));
        self.elevation.extend(points.iter().map(|point| point[2]));
        self.raw += points.len();
    }

    pub(super) fn point(&self, index: usize) -> Point {
        let [x, y] = self.xy[index];
        [x, y, self.elevation[index]]
    }

    /// Key of a point; raw ones are unwritten.
    pub(super) fn key(&self, index: usize) -> u64 {
        index.checked_sub(self.raw).map_or(UNWRITTEN, |index| self.keys[index])
    }

    /// Takes over the raw points of `other`; none may have come in another way before.
    pub(super) fn append_raw(&mut self, other: &Residual) {
        debug_assert!(self.raw == self.len() && other.raw == other.len());
        self.xy.extend_from_slice(&other.xy);
        self.elevation.extend_from_slice(&other.elevation);
        self.raw += other.raw;
    }

    /// Takes over the points and walls of `other`, which a node has left.
    pub(super) fn append(&mut self, other: &Residual) {
        debug_assert_eq!(other.raw, 0);
        let first = self.len() as u32;
        self.xy.extend_from_slice(&other.xy);
        self.elevation.extend_from_slice(&other.elevation);
        self.keys.extend_from_slice(&other.keys);
        self.walls.extend(other.walls.iter().map(|wall| wall.map(|end| end + first)));
        self.active += other.active;
    }
}

/// The union of `parts`, in their order.
pub(super) fn union(parts: &[Residual]) -> Residual {
    let points = parts.iter().map(Residual::len).sum();
    let mut all = Residual::with_capacity(points, parts.iter().map(|part| part.walls.len()).sum());
    parts.iter().for_each(|part| all.append(part));
    all
}

/// x and y. Adding zero makes -0.0 the same point as 0.0 in every bit.
fn plane(point: &Point) -> Point2 {
    [point[0] + 0.0, point[1] + 0.0]
}
