//! The grid of a stream, on which lines are noded.

use super::Target;
use super::changes::{ChangeKind, Changes};
use spmesh_core::error::{Error, Result};
use spmesh_crs::{Horizontal, System};
use spmesh_geometry::noding::LineVertex;
use spmesh_io::source::Breakline;
use spmesh_model::points::Point2;
use spmesh_stream::Coordinates;

/// Bits of coordinates of lines for streams of f64.
const F64_BITS: i32 = 40;

/// Moves of vertices that are counted, in metres, and in degrees.
const MOVE_METRES: f64 = 0.0005;
const MOVE_DEGREES: f64 = 5e-9;

/// A grid of integers.
pub(crate) struct Grid {
    coordinates: Coordinates,
    /// For coordinates of f64: a power of two, the distance of neighbours.
    step: f64,
    /// Moves of vertices that are counted, in world units.
    move_min: f64,
}

impl Grid {
    pub(crate) fn of<'a>(target: &Target, lines: impl Iterator<Item = &'a Breakline>) -> Grid {
        let step = match target.coordinates {
            Coordinates::I32 { .. } => 1.0,
            Coordinates::F64 => step(lines),
        };
        let move_min = match System::of(&target.crs).horizontal {
            Some(system) if system.is_angular() => MOVE_DEGREES,
            Some(Horizontal { unit, .. }) => MOVE_METRES / unit.size,
            None => MOVE_METRES,
        };
        Grid { coordinates: target.coordinates, step, move_min }
    }

    /// A vertex on the grid.
    ///
    /// # Errors
    /// Usage, if it lies beyond the grid.
    pub(crate) fn vertex(
        &self,
        world: Point2,
        z: Option<f64>,
        line: u32,
        changes: &mut Changes,
    ) -> Result<LineVertex> {
        let [x, y] = world;
        let stored = self.coordinates.to_stored([x, y, z.unwrap_or(0.0)]);
        let is_known = [true, true, z.is_some()];
        for axis in 0..3 {
            if is_known[axis] && !self.coordinates.can_store(stored[axis]) {
                return Err(self.beyond(axis, [x, y, z.unwrap_or(0.0)][axis]));
            }
        }
        let place = [stored[0], stored[1]].map(|value| (value / self.step).round() as i64);
        let moved = self.world(place);
        if (moved[0] - x).hypot(moved[1] - y) > self.move_min {
            changes.note(ChangeKind::Rounded, line, || world);
        }
        Ok(LineVertex { place, z: z.map(|_| stored[2]) })
    }

    /// Stored coordinates of a place of the grid: exact.
    pub(crate) fn stored(&self, place: [i64; 2]) -> Point2 {
        place.map(|value| value as f64 * self.step)
    }

    /// World coordinates of a place of the grid.
    pub(crate) fn world(&self, place: [i64; 2]) -> Point2 {
        let [x, y] = self.stored(place);
        let [x, y, _] = self.coordinates.to_decimal([x, y, 0.0]);
        [x, y]
    }

    fn beyond(&self, axis: usize, world: f64) -> Error {
        let name = ["x", "y", "z"][axis];
        let range = [i32::MIN, i32::MAX].map(|end| self.coordinates.to_decimal([f64::from(end); 3])[axis]);
        Error::usage(format!(
            "a vertex of a line has {name} {world}, but the points are on a grid that ends at {} and {}: the lines may \
             have another system (transform them, for example with ogr2ogr -t_srs), or the points a coarser grid \
             (spfinalize --scale)",
            range[0], range[1]
        ))
    }
}

/// The distance of neighbours on the grid for coordinates of f64: 2^(e - 40), where 2^e is the least power of
/// two above all magnitudes.
fn step<'a>(lines: impl Iterator<Item = &'a Breakline>) -> f64 {
    let values = lines.flat_map(|line| &line.vertices).flatten();
    let most = values.fold(0.0f64, |most, value| most.max(value.abs()));
    // The exponent of a normal number; the least one for others.
    let exponent = ((most.to_bits() >> 52) as i32 - 1023).max(f64::MIN_EXP + F64_BITS) + 1;
    2f64.powi(exponent - F64_BITS)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_step_follows_the_greatest_coordinate() {
        let of = |most: f64| {
            let vertices = vec![[0.5, -most]];
            let line = Breakline { vertices, elevations: vec![None], polygon: None, position: String::new() };
            step([line].iter())
        };
        assert_eq!((of(1.0), of(0.99), of(5_000_000.0)), (2f64.powi(-39), 2f64.powi(-40), 2f64.powi(-17)));
        assert!(of(0.0) > 0.0 && of(f64::MAX).is_finite() && f64::MAX / of(f64::MAX) <= 2f64.powi(40));
    }
}
