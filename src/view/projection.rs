//! How places of the world come on the sheet: seen from above, or from above one side.

use super::frame::Frame;
use super::sheet::Sheet;
use spmesh_core::error::Result;
use spmesh_geometry::predicates::Point2;
use spmesh_model::bounds::{Bounds, Point};

/// How far what is seen from one side is turned, and how far above the horizon the eye is. Units: radians.
const TURN: f64 = 0.5;
const ABOVE: f64 = 0.65;
/// The range of elevations is drawn as high as this part of the diagonal of the plan.
const HEIGHT: f64 = 0.25;

/// Around what is seen, so that nothing of lines and dots on its border is lost. Units: those of the picture.
pub(super) const PAD: f64 = 6.0;

/// Where the eye is.
#[derive(Debug, Clone, Copy)]
pub(super) enum View {
    /// Above.
    Plan(Frame),
    /// Above one side.
    Oblique(Oblique),
}

/// A parallel view from above one side.
#[derive(Debug, Clone, Copy)]
pub(super) struct Oblique {
    /// The middle of the plan, and the least elevation.
    middle: Point,
    /// Units of the plan for one of the elevations.
    lift: f64,
    /// From coordinates across and up to the sheet.
    frame: Frame,
}

impl View {
    /// A view of a box from above, with so much around it.
    ///
    /// # Errors
    /// As [`Sheet::of`].
    pub(super) fn plan(min: Point2, max: Point2, pad: f64, width: u32) -> Result<(Sheet, View)> {
        let (sheet, frame) = Sheet::of(min, max, pad, width)?;
        Ok((sheet, View::Plan(frame)))
    }

    /// A view of a box from above one side, of which some points show what is to be seen of it.
    ///
    /// # Errors
    /// As [`Sheet::of`].
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

    /// Where a point is on the sheet, and how far away it is, compared with others.
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

    /// If it is from one side: from the world to the plan as the eye sees it, to the right, and away from it.
    pub(super) fn turn(&self) -> Option<impl Fn(Point) -> Point2> {
        match *self {
            View::Plan(_) => None,
            View::Oblique(oblique) => Some(move |at: Point| oblique.turned(at)),
        }
    }

    /// The frame of what is seen from above.
    pub(super) fn frame(&self) -> Option<Frame> {
        match self {
            View::Plan(frame) => Some(*frame),
            View::Oblique(_) => None,
        }
    }
}

impl Oblique {
    /// Places of the plan after the turn: to the right, and away from the eye.
    fn turned(&self, at: Point) -> Point2 {
        let ([x, y], (sine, cosine)) = ([0, 1].map(|axis| at[axis] - self.middle[axis]), TURN.sin_cos());
        [cosine * x - sine * y, sine * x + cosine * y]
    }

    /// Across and up on the plane of the picture, and away from the eye.
    fn flat(&self, at: Point) -> [f64; 3] {
        let ([across, behind], height) = (self.turned(at), self.lift * (at[2] - self.middle[2]));
        let (sine, cosine) = ABOVE.sin_cos();
        [across, behind * sine + height * cosine, behind * cosine - height * sine]
    }
}
