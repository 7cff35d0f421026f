//! The grid of a stream, on which lines are noded.

use super::Target;
use super::changes::{ChangeKind, Changes};
use spmesh_base::error::{Error, Result};
use spmesh_delaunay::noding::LineVertex;
use spmesh_formats::crs::{Horizontal, System};
use spmesh_formats::source::Breakline;
use spmesh_stream::Coordinates;
use spmesh_stream::model::points::Point2;

/// Coordinates of lines for streams of f64 have fewer steps than this.
const F64_STEPS: f64 = (1u64 << 42) as f64;

/// Moves of vertices that are counted, in metres, and in degrees.
const MOVE_METRES: f64 = 0.0005;
const MOVE_DEGREES: f64 = 5e-9;

/// A grid of integers.
pub(crate) struct Grid {
    coordinates: Coordinates,
    /// Neighbours are 10^-digits units apart.
    digits: i32,
    /// Moves of vertices that are counted, in world units.
    move_min: f64,
    /// The greatest magnitude of coordinates of lines, if the digits follow from it.
    most: Option<f64>,
}

impl Grid {
    pub(crate) fn of<'a>(target: &Target, lines: impl Iterator<Item = &'a Breakline>) -> Grid {
        let (digits, most) = match target.coordinates {
            Coordinates::I32 { .. } => (0, None),
            Coordinates::F64 => {
                let most = most(lines);
                (digits(most), Some(most))
            }
        };
        let move_min = match System::of(&target.crs).horizontal {
            Some(system) if system.is_angular() => MOVE_DEGREES,
            Some(Horizontal { unit, .. }) => MOVE_METRES / unit.size,
            None => MOVE_METRES,
        };
        Grid { coordinates: target.coordinates, digits, move_min, most }
    }

    /// What to say if a coordinate is so great that its steps move other vertices.
    pub(crate) fn notice(&self) -> Option<String> {
        let (most, step) = (self.most?, self.step());
        (step > 2.0 * self.move_min).then(|| {
            format!(
                "a coordinate of lines is as great as {most:?}: lines are rounded to steps of {step:?}. If \
                 it is a mistake, leave out this vertex"
            )
        })
    }

    /// Checks that a line keeps some length, if steps are greater than lines should need.
    pub(crate) fn check_length(&self, world: &[(Point2, Option<f64>)], on_grid: &[LineVertex]) -> Result<()> {
        let has_length = world.iter().any(|vertex| vertex.0 != world[0].0);
        let is_lost = has_length && on_grid.iter().all(|vertex| vertex.place == on_grid[0].place);
        match self.notice().filter(|_| is_lost) {
            Some(notice) => Err(Error::usage(format!("the line would become one place: {notice}"))),
            None => Ok(()),
        }
    }

    /// A vertex on the grid.
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
        let place = [stored[0], stored[1]].map(|value| scaled(value, self.digits).round() as i64);
        let moved = self.world(place);
        if (moved[0] - x).hypot(moved[1] - y) > self.move_min {
            changes.note(ChangeKind::Rounded, line, || world);
        }
        Ok(LineVertex { place, z: z.map(|_| stored[2]) })
    }

    /// The distance of neighbours, in stored units.
    pub(crate) fn step(&self) -> f64 {
        scaled(1.0, -self.digits)
    }

    /// Stored coordinates of a place of the grid: the numbers nearest to its decimals. So a vertex is at the
    /// place of a point that has the same decimals.
    pub(crate) fn stored(&self, place: [i64; 2]) -> Point2 {
        place.map(|value| scaled(value as f64, -self.digits))
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
            "a vertex of a line has {name} {world:?}, but the points are on a grid that ends at {} and {}: \
             the lines may have another system (transform them, for example with ogr2ogr -t_srs), or the \
             points a coarser grid (spfinalize --scale)",
            range[0], range[1]
        ))
    }
}

/// A number times a power of ten, rounded once if the power is at most 22, which is exact.
fn scaled(value: f64, power: i32) -> f64 {
    if power < 0 { value / 10f64.powi(-power) } else { value * 10f64.powi(power) }
}

/// The greatest magnitude of coordinates.
fn most<'a>(lines: impl Iterator<Item = &'a Breakline>) -> f64 {
    let values = lines.flat_map(|line| &line.vertices).flatten();
    values.fold(0.0, |most, value| most.max(value.abs()))
}

/// Decimal places of the grid for coordinates of f64: as many as the greatest magnitude leaves.
fn digits(most: f64) -> i32 {
    (-300..=300).rev().find(|&digits| scaled(most, digits) < F64_STEPS).unwrap_or(-300)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_digits_follow_the_greatest_coordinate() {
        assert_eq!((digits(1.0), digits(4_100_000.0), digits(0.5), digits(1e20)), (12, 6, 12, -8));
        let grid = Grid { coordinates: Coordinates::F64, digits: 6, move_min: 0.0, most: None };
        let vertex = grid.vertex([499_991.708, 0.1], None, 0, &mut Changes::new(false)).unwrap();
        assert_eq!(grid.stored(vertex.place), [499_991.708, 0.1]);
    }
}
