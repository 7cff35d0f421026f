//! The projection of the world onto the sheet: from above, or oblique.

use super::frame::Frame;
use super::sheet::Sheet;
use spmesh_base::error::Result;
use spmesh_delaunay::predicates::Point2;
use spmesh_stream::model::bounds::{Bounds, Point};

/// The rotation of an oblique view, and the height of the eye above the horizon. Units: radians.
const TURN: f64 = 0.5;
const ABOVE: f64 = 0.65;
/// The drawn height of the range of elevations, as a part of the diagonal of the plan.
const HEIGHT: f64 = 0.25;

/// The margin inside the map, so that lines and dots on the border are not cut. Units: lengths of the
/// picture.
pub(super) const PAD: f64 = 6.0;

/// From where the world is seen.
#[derive(Debug, Clone, Copy)]
pub(super) enum View {
    /// From above.
    Plan(Frame),
    /// Obliquely.
    Oblique(Oblique),
}

/// An oblique parallel projection.
#[derive(Debug, Clone, Copy)]
pub(super) struct Oblique {
    /// The middle of the plan, and the least elevation.
    middle: Point,
    /// Units of the plan for one unit of elevation.
    lift: f64,
    /// From across and up, in the plane of the picture, to the sheet.
    frame: Frame,
}

impl View {
    /// A view of a box from above, with a margin of `pad` around it.
    pub(super) fn plan(min: Point2, max: Point2, pad: f64, width: u32) -> Result<(Sheet, View)> {
        let (sheet, frame) = Sheet::of(min, max, pad, width)?;
        Ok((sheet, View::Plan(frame)))
    }

    /// An oblique view of a box, with room for the given points in it.
    pub(super) fn oblique(
        bounds: &Bounds,
        points: impl Iterator<Item = Point>,
        width: u32,
    ) -> Result<(Sheet, View)> {
        let [x, y, rise] = [0, 1, 2].map(|axis| bounds.max[axis] - bounds.min[axis]);
        let lift = if rise > 0.0 { HEIGHT * x.hypot(y) / rise } else { 0.0 };
        let middle = [0, 1].map(|axis| bounds.min[axis].midpoint(bounds.max[axis]));
        let mut oblique = Oblique {
            middle: [middle[0], middle[1], bounds.min[2]],
            lift: if lift.is_finite() { lift } else { 0.0 },
            frame: Frame { left: 0.0, top: 0.0, unit: 1.0 },
        };
        let seen = points.map(|at| oblique.flat(at)).map(|[across, up, _]| [across, up, 0.0]);
        let seen = seen.map(Bounds::of_point).reduce(Bounds::union).unwrap_or(Bounds::of_point([0.0; 3]));
        let [min, max] = [seen.min, seen.max].map(|[across, up, _]| [across, up]);
        let (sheet, frame) = Sheet::of(min, max, PAD, width)?;
        oblique.frame = frame;
        Ok((sheet, View::Oblique(oblique)))
    }

    /// The place of a point on the sheet, and its depth, which serves only to compare points.
    pub(super) fn place(&self, at: Point) -> [f64; 3] {
        match self {
            View::Plan(frame) => {
                let [x, y] = frame.place([at[0], at[1]]);
                [x, y, 0.0]
            }
            View::Oblique(oblique) => {
                let [across, up, away] = oblique.flat(at);
                let [x, y] = oblique.frame.place([across, up]);
                [x, y, away / oblique.frame.unit]
            }
        }
    }

    /// For an oblique view: the map from the world to the turned plan, to the right of the eye and away from
    /// it.
    pub(super) fn turn(&self) -> Option<impl Fn(Point) -> Point2> {
        match *self {
            View::Plan(_) => None,
            View::Oblique(oblique) => Some(move |at: Point| oblique.turned(at)),
        }
    }

    /// The frame of a view from above.
    pub(super) fn frame(&self) -> Option<Frame> {
        match self {
            View::Plan(frame) => Some(*frame),
            View::Oblique(_) => None,
        }
    }
}

impl Oblique {
    /// The place in the turned plan: to the right of the eye, and away from it.
    fn turned(&self, at: Point) -> Point2 {
        let ([x, y], (sine, cosine)) = ([0, 1].map(|axis| at[axis] - self.middle[axis]), TURN.sin_cos());
        [cosine * x - sine * y, sine * x + cosine * y]
    }

    /// Across and up in the plane of the picture, and away from the eye.
    fn flat(&self, at: Point) -> [f64; 3] {
        let ([across, behind], height) = (self.turned(at), self.lift * (at[2] - self.middle[2]));
        let (sine, cosine) = ABOVE.sin_cos();
        [across, behind * sine + height * cosine, behind * cosine - height * sine]
    }
}
