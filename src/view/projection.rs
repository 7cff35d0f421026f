//! The part of the world that a picture shows, and its projection onto the sheet: from above, or oblique.

use super::picture::Frame;
use super::sheet::Sheet;
use spmesh_base::error::Result;
use spmesh_delaunay::predicates::Point2;
use spmesh_formats::raster::Window;
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

/// A sheet, and the view of the world on it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Scene {
    pub(super) sheet: Sheet,
    pub(super) view: View,
    /// The part of the plane that is visible; all of it if `None`.
    window: Option<Window>,
    /// The margin inside the map. Units: lengths of the picture.
    pad: f64,
}

impl Scene {
    /// A box of the world from above, with a margin of `pad` around it; or just the window, if there is one.
    pub(super) fn plan(bounds: &Bounds, window: Option<Window>, pad: f64, width: u32) -> Result<Scene> {
        let [min, max] = [bounds.min, bounds.max].map(|[x, y, _]| [x, y]);
        let (min, max, pad) = window.map_or((min, max, pad), |Window { min, max }| (min, max, 0.0));
        let (sheet, view) = View::plan(min, max, pad, width)?;
        Ok(Scene { sheet, view, window, pad })
    }

    /// An oblique view with room for all of a box of the world.
    pub(super) fn oblique(bounds: &Bounds, width: u32) -> Result<Scene> {
        let corner = |number: usize| {
            [0, 1, 2].map(|axis| if number >> axis & 1 == 0 { bounds.min[axis] } else { bounds.max[axis] })
        };
        Scene::oblique_of(bounds, (0..8).map(corner), width)
    }

    /// An oblique view of a box, with room for the given points in it.
    pub(super) fn oblique_of(
        bounds: &Bounds,
        points: impl Iterator<Item = Point>,
        width: u32,
    ) -> Result<Scene> {
        let (sheet, view) = View::oblique(bounds, points, width)?;
        Ok(Scene { sheet, view, window: None, pad: PAD })
    }

    /// The left, upper, right and lower side of the map on the sheet, without its margin.
    pub(super) fn sides(&self) -> [f64; 4] {
        let ([x, y], [width, height]) = (self.sheet.corner, self.sheet.size.map(|size| size as f64));
        [x + self.pad, y + self.pad, x + width - self.pad, y + height - self.pad]
    }

    /// Whether something with these corners may be visible.
    pub(super) fn may_show(&self, corners: &[Point]) -> bool {
        let Some(Window { min, max }) = self.window else { return true };
        (0..2).all(|axis| {
            corners.iter().any(|corner| corner[axis] >= min[axis])
                && corners.iter().any(|corner| corner[axis] <= max[axis])
        })
    }
}
