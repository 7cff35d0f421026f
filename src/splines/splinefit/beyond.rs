//! Where splines have values: no farther from points than a distance, and outside of their domain if they are
//! extrapolated.

use super::layout::Spline;
use super::points::Points;
use crate::bases::{Jet, Scratch};
use spmesh_base::error::{Error, Result};
use spmesh_delaunay::delaunay2::{Kernel, Triangulation};
use spmesh_delaunay::predicates::Point2;

/// Limits of a spline other than its domain.
#[derive(Debug, Default)]
pub struct Beyond {
    /// Points, and how far from the nearest one there are values. Units: those of the world.
    near: Option<(Triangulation, f64)>,
    /// The corners of the domain, in stored coordinates, if the spline goes on outside.
    border: Option<Vec<Point2>>,
}

/// How far inside of its border the domain is evaluated, as parts of the way to its middle: the first one
/// that is inside whatever the rounding counts.
const INSIDE: [f64; 3] = [1e-12, 1e-9, 1e-6];

impl Beyond {
    /// Whether there are limits other than the domain.
    pub(super) fn is_any(&self) -> bool {
        self.near.is_some() || self.border.is_some()
    }

    /// Whether a place in the world is too far from all points.
    pub(super) fn is_far(&self, world: Point2) -> bool {
        self.near.as_ref().is_some_and(|(points, distance)| {
            let nearest = points.nearest(world).map(|id| points.points()[id as usize]);
            nearest.is_none_or(|point| (point[0] - world[0]).hypot(point[1] - world[1]) > *distance)
        })
    }
}

impl Spline {
    /// The same spline without values farther than `distance` from all points.
    ///
    /// Memory: a triangulation of all points.
    ///
    /// # Errors
    /// If points cannot be read or triangulated.
    pub fn near(self, points: &Points, distance: f64) -> Result<Spline> {
        let mut places = Vec::new();
        points.for_each(|_, one| places.push(one.point))?;
        let mesh = Triangulation::by(&mut Kernel::new(), places).map_err(Error::of_computation)?;
        let beyond = Beyond { near: Some((mesh, distance)), ..self.beyond };
        Ok(Spline { beyond, ..self })
    }

    /// The same spline continued outside of its domain: with the value and the gradient of the nearest place
    /// of its border, linearly.
    #[must_use]
    pub fn extrapolated(self) -> Spline {
        let border = Some(self.layout.basis.domain_corners());
        Spline { beyond: Beyond { border, ..self.beyond }, ..self }
    }

    /// The jet at a stored place outside of the domain, if the spline goes on there.
    pub(super) fn jet_outside(&self, at: Point2, scratch: &mut Scratch) -> Option<Jet> {
        let border = self.beyond.border.as_ref()?;
        let count = border.len() as f64;
        let middle = [0, 1].map(|axis| border.iter().map(|corner| corner[axis]).sum::<f64>() / count);
        let sides = border.iter().zip(border.iter().cycle().skip(1));
        let square = |p: &Point2| (p[0] - at[0]).powi(2) + (p[1] - at[1]).powi(2);
        let nearest = sides.map(|(&p, &q)| on_side([p, q], at));
        let nearest = nearest.min_by(|a, b| square(a).total_cmp(&square(b)))?;
        let inside =
            INSIDE.map(|part| [0, 1].map(|axis| nearest[axis] + part * (middle[axis] - nearest[axis])));
        let basis = &self.layout.basis;
        let start = inside.into_iter().find(|&place| basis.is_in_domain(place))?;
        let Jet { value, gradient, .. } = basis.jet(&self.coefficients, start, scratch);
        let rise = gradient[0] * (at[0] - start[0]) + gradient[1] * (at[1] - start[1]);
        Some(Jet { value: value + rise, gradient, ..Jet::default() })
    }
}

/// The place of a side that is nearest to a point.
fn on_side([p, q]: [Point2; 2], at: Point2) -> Point2 {
    let way = [q[0] - p[0], q[1] - p[1]];
    let square = way[0] * way[0] + way[1] * way[1];
    let along = (way[0] * (at[0] - p[0]) + way[1] * (at[1] - p[1])) / square;
    let part = if along.is_finite() { along.clamp(0.0, 1.0) } else { 0.0 };
    [p[0] + part * way[0], p[1] + part * way[1]]
}
