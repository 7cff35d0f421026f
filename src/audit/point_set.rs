//! Whether the vertices of a mesh are exactly the positions of given points.

use super::check::{Check, Ledger, Violation};
use spmesh_base::error::{Error, Result};
use spmesh_stream::Coordinates;
use spmesh_stream::model::bounds::Point;

/// The distinct positions of points, in the plane or in space, and which of them a mesh has.
///
/// Memory: 4 bytes per integer coordinate, 8 per other, and a bit per point.
pub struct PointSet {
    coordinates: Coordinates,
    keys: Keys,
    found: Vec<u64>,
}

/// Sorted keys of positions.
enum Keys {
    I32InPlane(Vec<[i32; 2]>),
    F64InPlane(Vec<[u64; 2]>),
    I32InSpace(Vec<[i32; 3]>),
    F64InSpace(Vec<[u64; 3]>),
}

/// The same expression for the keys of any type.
macro_rules! of_keys {
    ($keys:expr, $bound:ident => $result:expr) => {
        match $keys {
            Keys::I32InPlane($bound) => $result,
            Keys::F64InPlane($bound) => $result,
            Keys::I32InSpace($bound) => $result,
            Keys::F64InSpace($bound) => $result,
        }
    };
}

impl PointSet {
    /// No points, in stored coordinates of this encoding, in two or three dimensions.
    pub fn new(coordinates: Coordinates, dims: u8) -> Self {
        let keys = match (coordinates, dims) {
            (Coordinates::I32 { .. }, 3) => Keys::I32InSpace(Vec::new()),
            (Coordinates::I32 { .. }, _) => Keys::I32InPlane(Vec::new()),
            (Coordinates::F64, 3) => Keys::F64InSpace(Vec::new()),
            (Coordinates::F64, _) => Keys::F64InPlane(Vec::new()),
        };
        PointSet { coordinates, keys, found: Vec::new() }
    }

    /// Adds points; repeated positions count once.
    pub fn extend(&mut self, points: &[Point]) {
        of_keys!(&mut self.keys, keys => add_keys(keys, points));
    }

    /// Sorts the positions. `mesh` is the encoding of the mesh that will be compared.
    ///
    /// # Errors
    /// Usage, if the mesh stores its coordinates in another way, so that they cannot be equal.
    pub fn finish(mut self, mesh: &Coordinates) -> Result<Self> {
        if !same_positions(&self.coordinates, mesh, self.keys.dims()) {
            return Err(Error::usage(
                "the points have another coordinate type, scale or offset than the mesh: cannot compare",
            ));
        }
        let len = of_keys!(&mut self.keys, keys => sort_distinct(keys));
        self.found = vec![0; len.div_ceil(64)];
        Ok(self)
    }

    /// Removes the vertex `id` from the points that are still missing.
    pub(super) fn take(
        &mut self,
        id: Option<u64>,
        at: Point,
        ledger: &mut Ledger,
    ) -> std::result::Result<(), Violation> {
        ledger.add(Check::Points, 1);
        let place = of_keys!(&self.keys, keys => keys.binary_search(&Key::of(at)));
        let Ok(i) = place else {
            let message = "a vertex is at the position of no given point";
            return Err(Violation::new(Check::Points, message).with(id, at));
        };
        if self.found[i / 64] >> (i % 64) & 1 == 1 {
            let message = "a vertex is at the position of an earlier vertex";
            return Err(Violation::new(Check::Points, message).with(id, at));
        }
        self.found[i / 64] |= 1 << (i % 64);
        Ok(())
    }

    /// Proves that every point was taken.
    pub(super) fn check_complete(&self) -> std::result::Result<(), Violation> {
        let len = of_keys!(&self.keys, keys => keys.len());
        let Some(i) = (0..len).find(|i| self.found[i / 64] >> (i % 64) & 1 == 0) else { return Ok(()) };
        let at = of_keys!(&self.keys, keys => keys[i].position());
        let message = "the mesh has no vertex at the position of a given point";
        Err(Violation::new(Check::Points, message).with(None, at))
    }
}

impl Keys {
    fn dims(&self) -> usize {
        match self {
            Keys::I32InPlane(_) | Keys::F64InPlane(_) => 2,
            Keys::I32InSpace(_) | Keys::F64InSpace(_) => 3,
        }
    }
}

/// Whether coordinates mean the same in both encodings.
pub(super) fn same_positions(a: &Coordinates, b: &Coordinates, dims: usize) -> bool {
    match (a, b) {
        (Coordinates::F64, Coordinates::F64) => true,
        (Coordinates::I32 { scale: s, offset: o }, Coordinates::I32 { scale: t, offset: p }) => {
            s[..dims] == t[..dims] && o[..dims] == p[..dims]
        }
        _ => false,
    }
}

fn add_keys<K: Key>(keys: &mut Vec<K>, points: &[Point]) {
    keys.extend(points.iter().map(|&point| K::of(point)));
}

fn sort_distinct<T: Ord>(keys: &mut Vec<T>) -> usize {
    keys.sort_unstable();
    keys.dedup();
    keys.len()
}

/// A position in a form that has an order.
trait Key {
    fn of(point: Point) -> Self;
    fn position(self) -> Point;
}

impl<const D: usize> Key for [i32; D] {
    fn of(point: Point) -> Self {
        std::array::from_fn(|axis| point[axis] as i32)
    }

    fn position(self) -> Point {
        std::array::from_fn(|axis| self.get(axis).map_or(0.0, |&value| f64::from(value)))
    }
}

/// The bits, with one zero: adding 0 turns -0 into 0 and changes nothing else.
impl<const D: usize> Key for [u64; D] {
    fn of(point: Point) -> Self {
        std::array::from_fn(|axis| (point[axis] + 0.0).to_bits())
    }

    fn position(self) -> Point {
        std::array::from_fn(|axis| self.get(axis).map_or(0.0, |&bits| f64::from_bits(bits)))
    }
}
