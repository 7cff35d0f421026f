//! The coordinate frame of knots: stored coordinates and world coordinates.

use super::anisotropy::Stretch;
use crate::bases::Jet;
use spmesh_base::error::{Error, Result};
use spmesh_delaunay::predicates::Point2;
use spmesh_formats::crs::{System, differences};
use spmesh_stream::{Coordinates, Crs};

/// The coordinate frame of knots. Steps along x and y are equal, so that directions and shapes are the same
/// as in the world.
#[derive(Debug, Clone, PartialEq)]
pub struct Frame {
    /// How knots are stored.
    pub coordinates: Coordinates,
    /// Coordinate reference system.
    pub crs: Crs,
    /// Units of x and y that one unit of values is.
    unit_of_z: f64,
    /// During a fit, how stored coordinates are stretched.
    stretch: Option<Stretch>,
}

impl Frame {
    fn new(coordinates: Coordinates, crs: Crs) -> Frame {
        let unit_of_z = System::of(&crs).vertical_ratio().unwrap_or(1.0);
        Frame { coordinates, crs, unit_of_z, stretch: None }
    }

    /// The frame of world coordinates.
    pub fn world(crs: Crs) -> Frame {
        Frame::new(Coordinates::F64, crs)
    }

    /// The frame of stretched world coordinates, in which a spline is fitted.
    pub(super) fn stretched(crs: Crs, stretch: Stretch) -> Frame {
        let stretch = (stretch.ratio != 1.0).then_some(stretch);
        Frame { stretch, ..Frame::world(crs) }
    }

    /// How coordinates are stretched.
    pub(super) fn stretch(&self) -> Option<Stretch> {
        self.stretch
    }

    /// The side of cells of the grid that knots are moved to, if coordinates are stretched.
    pub(super) fn grid_step(&self) -> f64 {
        self.stretch.map_or(0.0, |stretch| stretch.step())
    }

    /// The frame of stored coordinates if their steps are equal, and of world coordinates otherwise; and the
    /// map from stored points to points of the frame.
    pub(super) fn of(coordinates: Coordinates, crs: Crs) -> (Frame, impl Fn(Point2) -> Point2) {
        let is_even = match coordinates {
            Coordinates::F64 => true,
            Coordinates::I32 { scale, .. } => scale[0] == scale[1],
        };
        let frame = if is_even { Frame::new(coordinates, crs) } else { Frame::world(crs) };
        let place = move |stored: Point2| if is_even { stored } else { to_world(&coordinates, stored) };
        (frame, place)
    }

    /// The stored coordinates of a place in the world, not rounded to the grid of knots.
    #[inline]
    pub fn to_stored(&self, world: Point2) -> Point2 {
        match self.coordinates {
            Coordinates::F64 => self.stretch.map_or(world, |stretch| stretch.apply(world)),
            Coordinates::I32 { scale, offset } => {
                [0, 1].map(|axis| (world[axis] - offset[axis]) / scale[axis])
            }
        }
    }

    /// The world coordinates of a stored place.
    pub fn to_world(&self, stored: Point2) -> Point2 {
        to_world(&self.coordinates, stored)
    }

    /// The world coordinates of a stored place as users read them.
    pub fn to_decimal(&self, [x, y]: Point2) -> Point2 {
        let [x, y, _] = self.coordinates.to_decimal([x, y, 0.0]);
        [x, y]
    }

    /// Length of a step of stored coordinates. Units: those of the world.
    pub fn step(&self) -> f64 {
        match self.coordinates {
            Coordinates::F64 => 1.0,
            Coordinates::I32 { scale, .. } => scale[0],
        }
    }

    /// Converts a jet with respect to stored coordinates to world coordinates. Values are the same in both.
    pub fn jet_to_world(&self, jet: Jet) -> Jet {
        let step = self.step();
        Jet {
            value: jet.value,
            gradient: jet.gradient.map(|slope| slope / step),
            hessian: jet.hessian.map(|bend| bend / (step * step)),
        }
    }

    /// A jet in world coordinates, with values in the unit of x and y.
    pub(super) fn jet_in_one_unit(&self, jet: Jet) -> Jet {
        let jet = self.jet_to_world(jet);
        Jet {
            gradient: jet.gradient.map(|slope| slope * self.unit_of_z),
            hessian: jet.hessian.map(|bend| bend * self.unit_of_z),
            ..jet
        }
    }

    /// Adopts the reference system of the points if the reference system of the knots is unknown.
    pub(super) fn join(&mut self, crs: &Crs) -> Result<()> {
        match (&self.crs, crs) {
            (_, Crs::Unknown) => Ok(()),
            (Crs::Unknown, known) => {
                *self = Frame { stretch: self.stretch, ..Frame::new(self.coordinates, known.clone()) };
                Ok(())
            }
            (own, other) if own == other => Ok(()),
            (own, other) => {
                let (own, other) = (System::of(own), System::of(other));
                let found = differences(&own, &other);
                if found.is_empty() {
                    return Ok(());
                }
                let name = |system: &System| system.name().unwrap_or_else(|| "another system".into());
                Err(Error::usage(format!(
                    "knots are in {} and points in {} ({}): bring them into one system first, or state it with --crs",
                    name(&own),
                    name(&other),
                    found.join("; ")
                )))
            }
        }
    }
}

fn to_world(coordinates: &Coordinates, [x, y]: Point2) -> Point2 {
    let [x, y, _] = coordinates.to_world([x, y, 0.0]);
    [x, y]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stored_places_are_those_of_the_world() {
        let coordinates = Coordinates::I32 { scale: [0.25, 0.25, 0.01], offset: [100.0, -8.0, 0.0] };
        let (frame, place) = Frame::of(coordinates, Crs::Unknown);
        assert_eq!(place([2.0, 3.0]), [2.0, 3.0]);
        assert_eq!(frame.to_world([2.0, 3.0]), [100.5, -7.25]);
        assert_eq!(frame.to_stored([100.5, -7.25]), [2.0, 3.0]);
        let jet = frame.jet_to_world(Jet { value: 1.0, gradient: [1.0, 2.0], hessian: [1.0, 0.0, 2.0] });
        assert_eq!(jet, Jet { value: 1.0, gradient: [4.0, 8.0], hessian: [16.0, 0.0, 32.0] });
        let uneven = Coordinates::I32 { scale: [0.25, 0.5, 0.01], offset: [0.0; 3] };
        let (frame, place) = Frame::of(uneven, Crs::Unknown);
        assert_eq!((frame.coordinates, place([2.0, 3.0])), (Coordinates::F64, [0.5, 1.5]));
    }

    #[test]
    fn systems_must_be_one() {
        let wkt = |code| Crs::Wkt(format!("PROJCS[\"x\",AUTHORITY[\"EPSG\",\"{code}\"]]"));
        let mut frame = Frame::world(Crs::Unknown);
        frame.join(&wkt(1)).unwrap();
        assert_eq!(frame.crs, wkt(1));
        frame.join(&Crs::Unknown).unwrap();
        frame.join(&wkt(1)).unwrap();
        let message = frame.join(&wkt(2)).unwrap_err().to_string();
        assert!(message.contains("EPSG:1 and points in EPSG:2"), "{message}");
    }
}
