//! Points that are not finalized yet, with walls around the holes: the input of a node, and its output for
//! the node above.

use spmesh_stream::GlobalId;
use spmesh_stream::model::bounds::Point;

/// Key of a point that is not a vertex yet.
pub(super) const UNWRITTEN: u64 = u64::MAX;

/// The highest bits of the key of a vertex of another part, which this stream does not have yet.
const FOREIGN: u64 = 1 << 62;

/// The key of a vertex that other parts of the mesh have.
pub(super) fn foreign_key(id: GlobalId) -> u64 {
    FOREIGN | id.0
}

/// The vertex of other parts that a key stands for, if it does.
#[inline]
pub(super) fn foreign_id(key: u64) -> Option<GlobalId> {
    (key >> 62 == 1).then_some(GlobalId(key & !FOREIGN))
}

/// Points of D dimensions that a node has to triangulate, with walls around the simplices that are final
/// already.
///
/// The raw points of a leaf are a residual too: it has no walls, and all its points are unwritten.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Residual<const D: usize> {
    /// The D coordinates of each point that the geometry uses.
    pub(super) at: Vec<[f64; D]>,
    /// Elevation of each point of the plane, zero if the stream has none; empty in space.
    pub(super) elevation: Vec<f64>,
    /// The row of each point; empty if the stream has no attributes.
    pub(super) rows: Vec<u8>,
    /// Number of points that no node has triangulated yet. They are the first ones; only they may coincide.
    pub(super) raw: usize,
    /// For each point after the raw ones, a number that orders vertices as the stream does, or [`UNWRITTEN`].
    pub(super) keys: Vec<u64>,
    /// Facets with a final simplex on one side only, as D points each. An edge has its final triangle on its
    /// left; a triangle is counterclockwise as seen from the opposite corner of its final tetrahedron.
    pub(super) walls: Vec<[u32; D]>,
    /// Simplices that were not final at the node that left this residual.
    pub(super) active: usize,
    /// Number of points that the last node below left: that of the child that left the most.
    pub(super) left: usize,
}

/// Residuals of at least this many points are only triangulated again when more points have joined them.
const FEW: usize = 1_000;

impl<const D: usize> Residual<D> {
    /// Whether points have an elevation beside their geometry.
    const HAS_ELEVATION: bool = D == 2;

    pub(super) fn with_capacity(points: usize, walls: usize) -> Self {
        Residual {
            at: Vec::with_capacity(points),
            elevation: Vec::with_capacity(if Self::HAS_ELEVATION { points } else { 0 }),
            rows: Vec::new(),
            raw: 0,
            keys: Vec::with_capacity(points),
            walls: Vec::with_capacity(walls),
            active: 0,
            left: 0,
        }
    }

    /// Whether there are hardly more points than one of the nodes below has left.
    pub(super) fn has_hardly_grown(&self) -> bool {
        self.left >= FEW && self.len() < 2 * self.left
    }

    pub(super) fn len(&self) -> usize {
        self.at.len()
    }

    pub(super) fn is_empty(&self) -> bool {
        self.at.is_empty()
    }

    /// Empties all arrays, keeping their memory.
    pub(super) fn clear(&mut self) {
        self.at.clear();
        self.elevation.clear();
        self.rows.clear();
        self.raw = 0;
        self.keys.clear();
        self.walls.clear();
        self.active = 0;
        self.left = 0;
    }

    /// Adds a point that a node has left.
    pub(super) fn push(&mut self, point: Point, row: &[u8], key: u64) {
        self.at.push(geometry(&point));
        if Self::HAS_ELEVATION {
            self.elevation.push(point[2]);
        }
        self.rows.extend_from_slice(row);
        self.keys.push(key);
    }

    /// Adds points from the stream, with the row of each if there are attributes. All points so far must be
    /// raw.
    pub(super) fn extend_raw(&mut self, points: &[Point], rows: &[u8]) {
        debug_assert_eq!(self.raw, self.len());
        // Grow by an eighth: doubling would leave up to half of the memory of each leaf under way idle.
        let growth = points.len().max(self.len() / 8);
        if self.at.capacity() - self.len() < points.len() {
            self.at.reserve_exact(growth);
            if Self::HAS_ELEVATION {
                self.elevation.reserve_exact(growth);
            }
            self.rows.reserve_exact(growth * (rows.len() / points.len()));
        }
        self.at.extend(points.iter().map(geometry));
        if Self::HAS_ELEVATION {
            self.elevation.extend(points.iter().map(|point| point[2]));
        }
        self.rows.extend_from_slice(rows);
        self.raw += points.len();
    }

    /// Removes the last `count` points, all raw, and gives back their memory.
    pub(super) fn split_off(&mut self, count: usize) -> Self {
        let (kept, row_len) = (self.len() - count, self.row_len());
        let mut last = Residual { at: self.at.split_off(kept), raw: count, ..Residual::default() };
        self.at.shrink_to_fit();
        if Self::HAS_ELEVATION {
            last.elevation = self.elevation.split_off(kept);
            self.elevation.shrink_to_fit();
        }
        last.rows = self.rows.split_off(kept * row_len);
        self.rows.shrink_to_fit();
        self.raw = kept;
        last
    }

    /// Removes points, all raw; the others keep their order.
    pub(super) fn remove(&mut self, points: impl Iterator<Item = u32>) {
        let row_len = self.row_len();
        let mut is_gone = vec![false; self.len()];
        points.for_each(|point| is_gone[point as usize] = true);
        let mut kept = is_gone.iter().map(|&gone| !gone);
        self.at.retain(|_| kept.next().unwrap_or(true));
        let mut kept = is_gone.iter().map(|&gone| !gone);
        self.elevation.retain(|_| kept.next().unwrap_or(true));
        if row_len > 0 {
            let kept = self.rows.chunks_exact(row_len).zip(&is_gone).filter(|&(_, &gone)| !gone);
            self.rows = kept.flat_map(|(row, _)| row).copied().collect();
        }
        self.raw = self.at.len();
        if self.at.len() < self.at.capacity() / 4 {
            self.at.shrink_to_fit();
            self.elevation.shrink_to_fit();
        }
    }

    pub(super) fn point(&self, index: usize) -> Point {
        let at = &self.at[index];
        if Self::HAS_ELEVATION { [at[0], at[1], self.elevation[index]] } else { [at[0], at[1], at[2]] }
    }

    /// Bytes of a row; 0 without attributes, and without points.
    pub(super) fn row_len(&self) -> usize {
        self.rows.len().checked_div(self.len()).unwrap_or(0)
    }

    /// The row of a point; empty without attributes.
    pub(super) fn row(&self, index: usize) -> &[u8] {
        let len = self.row_len();
        &self.rows[index * len..][..len]
    }

    /// Gives point `to` the row of point `from`.
    pub(super) fn copy_row(&mut self, from: usize, to: usize) {
        let len = self.row_len();
        self.rows.copy_within(from * len..(from + 1) * len, to * len);
    }

    /// Key of a point; raw ones are unwritten.
    pub(super) fn key(&self, index: usize) -> u64 {
        index.checked_sub(self.raw).map_or(UNWRITTEN, |index| self.keys[index])
    }

    /// Adds the raw points of `other`, if it has any. All points so far must then be raw.
    pub(super) fn append_raw(&mut self, other: &Self) {
        debug_assert!(other.raw == 0 || self.raw == self.len());
        self.at.extend_from_slice(&other.at[..other.raw]);
        if Self::HAS_ELEVATION {
            self.elevation.extend_from_slice(&other.elevation[..other.raw]);
        }
        self.rows.extend_from_slice(&other.rows[..other.raw * other.row_len()]);
        self.raw += other.raw;
    }

    /// Adds the points of `other` that nodes have left, and its walls. Its raw points are here already, the
    /// first of them at `first_raw`.
    fn append_left(&mut self, other: &Self, first_raw: usize) {
        let first = self.len();
        self.at.extend_from_slice(&other.at[other.raw..]);
        if Self::HAS_ELEVATION {
            self.elevation.extend_from_slice(&other.elevation[other.raw..]);
        }
        self.rows.extend_from_slice(&other.rows[other.raw * other.row_len()..]);
        self.keys.extend_from_slice(&other.keys);
        let here = |corner: u32| match (corner as usize).checked_sub(other.raw) {
            Some(left) => (first + left) as u32,
            None => first_raw as u32 + corner,
        };
        self.walls.extend(other.walls.iter().map(|wall| wall.map(here)));
        self.active += other.active;
    }

    /// Adds all `parts` in their order: first the raw points of all of them, then the points that nodes have
    /// left. If any part has raw points, all points so far must be raw. Frees each part as soon as it is
    /// copied.
    pub(super) fn unite(&mut self, parts: Vec<Self>) {
        self.reserve(&parts);
        self.left = parts.iter().map(|part| part.left).fold(self.left, usize::max);
        let mut left = Vec::new();
        for part in parts {
            let first_raw = self.raw;
            self.append_raw(&part);
            if part.raw < part.len() {
                left.push((part, first_raw));
            }
        }
        for (part, first_raw) in left {
            self.append_left(&part, first_raw);
        }
    }

    /// Allocates exactly the memory for all `parts`, because they can be large.
    fn reserve(&mut self, parts: &[Self]) {
        let points = parts.iter().map(Residual::len).sum();
        self.at.reserve_exact(points);
        if Self::HAS_ELEVATION {
            self.elevation.reserve_exact(points);
        }
        self.rows.reserve_exact(parts.iter().map(|part| part.rows.len()).sum());
        self.keys.reserve_exact(parts.iter().map(|part| part.keys.len()).sum());
        self.walls.reserve_exact(parts.iter().map(|part| part.walls.len()).sum());
    }
}

/// The union of `parts`, in their order.
pub(super) fn union<const D: usize>(parts: Vec<Residual<D>>) -> Residual<D> {
    let mut all = Residual::default();
    all.unite(parts);
    all
}

/// The coordinates that the geometry uses. Adding zero turns -0.0 into 0.0, so that equal numbers have equal
/// bits.
fn geometry<const D: usize>(point: &Point) -> [f64; D] {
    std::array::from_fn(|axis| point[axis] + 0.0)
}
