//! The places where lines pass edges.

use super::decimals::Decimals;
use spmesh_base::error::{Error, Result};
use spmesh_delaunay::predicates::Point2;
use spmesh_stream::Coordinates;

/// Digits of a place beyond those of the step of integer coordinates.
const DIGITS: i32 = 2;

/// Number of parts of a step that these digits distinguish.
const PARTS: f64 = 100.0;

/// A vertex of the mesh with its rank.
#[derive(Debug, Clone, Copy)]
pub(super) struct Vertex {
    pub(super) id: u64,
    /// Its place in stored coordinates.
    pub(super) at: Point2,
    /// Its elevation in the world.
    pub(super) elevation: f64,
    /// The highest level at or below it.
    pub(super) rank: i64,
}

/// The plane of the places of lines. For integer coordinates, places are integers in hundredths of the step;
/// otherwise they are world coordinates.
#[derive(Debug)]
pub(super) struct Plane {
    grid: Option<[Decimals; 2]>,
}

impl Plane {
    pub(super) fn new(coordinates: &Coordinates) -> Plane {
        let grid = match coordinates {
            Coordinates::F64 => None,
            Coordinates::I32 { scale, offset } => {
                Some([0, 1].map(|axis| Decimals::new(offset[axis], scale[axis], DIGITS)))
            }
        };
        Plane { grid }
    }

    /// The place on an edge with an elevation. It does not depend on the order of the ends, and is monotone
    /// in the elevation.
    ///
    /// Domain: the elevation is between those of the ends, which differ.
    #[inline]
    pub(super) fn place(&self, p: &Vertex, q: &Vertex, elevation: f64) -> Result<Point2> {
        self.unrounded(p, q, elevation).map(|place| self.rounded(place))
    }

    /// As [`Plane::place`], before it is rounded to the digits of places.
    #[inline]
    pub(super) fn unrounded(&self, p: &Vertex, q: &Vertex, elevation: f64) -> Result<Point2> {
        let [p, q] = if (p.at, p.elevation) < (q.at, q.elevation) { [p, q] } else { [q, p] };
        let at = if elevation == p.elevation {
            p.at
        } else if elevation == q.elevation {
            q.at
        } else {
            let height = q.elevation - p.elevation;
            // NaN instead of a quotient by infinity, which would be zero.
            let share = if height.is_finite() { (elevation - p.elevation) / height } else { f64::NAN };
            [0, 1].map(|axis| between(p.at[axis], q.at[axis], share))
        };
        if !at.iter().all(|value| value.is_finite()) {
            let what = "coordinates are too great to interpolate between: shift and scale them";
            return Err(Error::usage(what));
        }
        Ok(if self.grid.is_some() { at.map(|value| value * PARTS) } else { at })
    }

    /// A place with the digits that places have.
    #[inline]
    pub(super) fn rounded(&self, place: Point2) -> Point2 {
        if self.grid.is_some() { place.map(f64::round) } else { place }
    }

    /// A place in world coordinates.
    #[inline]
    pub(super) fn to_world(&self, place: Point2) -> Point2 {
        match &self.grid {
            Some(grid) => [0, 1].map(|axis| grid[axis].at(place[axis] as i64)),
            None => place,
        }
    }
}

/// Interpolates between two numbers; the result stays between them and is monotone in the share. NaN if the
/// difference overflows.
fn between(from: f64, to: f64, share: f64) -> f64 {
    let value = from + share * (to - from);
    if value.is_finite() && share.is_finite() { value.clamp(from.min(to), from.max(to)) } else { f64::NAN }
}

/// The map from stored to world elevations.
#[derive(Debug)]
pub(super) struct Elevations {
    grid: Option<Decimals>,
}

impl Elevations {
    pub(super) fn new(coordinates: &Coordinates) -> Elevations {
        let grid = match coordinates {
            Coordinates::F64 => None,
            Coordinates::I32 { scale, offset } => Some(Decimals::new(offset[2], scale[2], 0)),
        };
        Elevations { grid }
    }

    /// The world elevation of a stored elevation. 30 steps of 0.01 give exactly the f64 0.3, so that they lie
    /// on the level 0.3.
    pub(super) fn to_world(&self, stored: f64) -> f64 {
        self.grid.map_or(stored, |grid| grid.at(stored as i64))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn vertex(at: Point2, elevation: f64) -> Vertex {
        Vertex { id: 0, at, elevation, rank: 0 }
    }

    #[test]
    fn places_do_not_depend_on_the_direction_and_keep_the_order() {
        let plane = Plane::new(&Coordinates::F64);
        let (p, q) = (vertex([0.1, 7e5], 3.3), vertex([0.7, -1e-3], 11.9));
        let mut last = [0.1, 7e5];
        for step in 0..=1000 {
            let elevation = if step == 1000 { 11.9 } else { 3.3 + 8.6 * f64::from(step) / 1000.0 };
            let place = plane.place(&p, &q, elevation).unwrap();
            assert_eq!(place, plane.place(&q, &p, elevation).unwrap());
            assert!(place[0] >= last[0] && place[1] <= last[1], "{step}");
            last = place;
        }
        assert_eq!(last, q.at);
    }

    #[test]
    fn integer_coordinates_have_two_more_digits() {
        let coordinates = Coordinates::I32 { scale: [0.01, 0.01, 0.1], offset: [500_000.0, -3.5, 0.0] };
        let plane = Plane::new(&coordinates);
        let place = plane.place(&vertex([0.0, 1.0], 0.0), &vertex([1.0, 2.0], 3.0), 1.0).unwrap();
        assert_eq!(plane.to_world(place), [500_000.003_3, -3.4867]);
        assert_eq!(Elevations::new(&coordinates).to_world(3.0), 0.3);
    }

    #[test]
    fn differences_out_of_range_are_refused() {
        let plane = Plane::new(&Coordinates::F64);
        for (p, q) in [
            (vertex([-1e308, 0.0], 0.0), vertex([1e308, 0.0], 2.0)),
            (vertex([0.0, 0.0], -1e308), vertex([1.0, 0.0], 1e308)),
        ] {
            let error = plane.place(&p, &q, 1.0).unwrap_err();
            assert!(error.exit_code() == 2 && error.to_string().contains("too great"), "{error}");
        }
    }
}
