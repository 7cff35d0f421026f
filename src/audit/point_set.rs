//! Whether the vertices of a mesh are exactly the positions of given points.

use super::check::{Check, Ledger, Violation};
use crate::bounds::Point;
use crate::error::{Error, Result};
use crate::stream::Coordinates;

/// The distinct x and y of points, and which of them a mesh has.
///
/// Memory: 8 bytes per point of integer coordinates, 16 of others, and a bit.
pub struct PointSet {
    coordinates: Coordinates,
    keys: Keys,
    found: Vec<u64>,
}

enum Keys {
    I32(Vec<u64>),
    F64(Vec<u128>),
}

impl PointSet {
    /// No points, in stored coordinates of this encoding.
    #[must_use]
    pub fn new(coordinates: Coordinates) -> Self {
        let keys = match coordinates {
            Coordinates::I32 { .. } => Keys::I32(Vec::new()),
            Coordinates::F64 => Keys::F64(Vec::new()),
        };
        PointSet { coordinates, keys, found: Vec::new() }
    }

    /// Adds points; repeated positions count once.
    pub fn extend(&mut self, points: &[Point]) {
        match &mut self.keys {
            Keys::I32(keys) => keys.extend(points.iter().map(|&point| key_i32(point))),
            Keys::F64(keys) => keys.extend(points.iter().map(|&point| key_f64(point))),
        }
    }

    /// Puts the positions in order. `mesh` is the encoding of the mesh that will be compared.
    ///
    /// # Errors
    /// Usage, if the mesh stores its coordinates in another way, so that they cannot be equal.
    pub fn finish(mut self, mesh: &Coordinates) -> Result<Self> {
        if !same_plane(&self.coordinates, mesh) {
            return Err(Error::usage(
                "the points have another coordinate type, scale or offset than the mesh: cannot compare",
            ));
        }
        let len = match &mut self.keys {
            Keys::I32(keys) => sort_distinct(keys),
            Keys::F64(keys) => sort_distinct(keys),
        };
        self.found = vec![0; len.div_ceil(64)];
        Ok(self)
    }

    /// Takes the vertex `id` off the points that are still to come.
    pub(super) fn take(
        &mut self,
        id: Option<u64>,
        at: Point,
        ledger: &mut Ledger,
    ) -> std::result::Result<(), Violation> {
        ledger.add(Check::Points, 1);
        let place = match &self.keys {
            Keys::I32(keys) => keys.binary_search(&key_i32(at)),
            Keys::F64(keys) => keys.binary_search(&key_f64(at)),
        };
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
        let len = match &self.keys {
            Keys::I32(keys) => keys.len(),
            Keys::F64(keys) => keys.len(),
        };
        let Some(i) = (0..len).find(|i| self.found[i / 64] >> (i % 64) & 1 == 0) else { return Ok(()) };
        let at = match &self.keys {
            Keys::I32(keys) => [(keys[i] >> 32) as u32, keys[i] as u32].map(|half| f64::from(half as i32)),
            Keys::F64(keys) => [(keys[i] >> 64) as u64, keys[i] as u64].map(f64::from_bits),
        };
        let message = "the mesh has no vertex at the position of a given point";
        Err(Violation::new(Check::Points, message).with(None, [at[0], at[1], 0.0]))
    }
}

/// Whether x and y mean the same in both encodings.
fn same_plane(a: &Coordinates, b: &Coordinates) -> bool {
    match (a, b) {
        (Coordinates::F64, Coordinates::F64) => true,
        (Coordinates::I32 { scale: s, offset: o }, Coordinates::I32 { scale: t, offset: p }) => {
            s[..2] == t[..2] && o[..2] == p[..2]
        }
        _ => false,
    }
}

fn sort_distinct<T: Ord>(keys: &mut Vec<T>) -> usize {
    keys.sort_unstable();
    keys.dedup();
    keys.len()
}

fn key_i32(point: Point) -> u64 {
    u64::from(point[0] as i32 as u32) << 32 | u64::from(point[1] as i32 as u32)
}

/// The bits, with one zero: adding 0 turns -0 into 0 and changes nothing else.
fn key_f64(point: Point) -> u128 {
    u128::from((point[0] + 0.0).to_bits()) << 64 | u128::from((point[1] + 0.0).to_bits())
}
