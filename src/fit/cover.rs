//! Quadratic functions over the convex hull of places: the border pulled apart, so that they sum to one on all of it.

use super::mesh::Mesh;
use crate::config::special::{Features, features};
use crate::config::{self, Knots, Rule};
use crate::error::Result;
use crate::predicates::Point2;
use crate::spline::Basis;

/// Places of knots with their triangulation, and the functions of degree 2 over them.
#[derive(Debug)]
pub struct Cover {
    /// The triangulation of places.
    pub mesh: Mesh,
    /// Functions over Delaunay configurations, of which those of knots at one place are collected.
    pub basis: Basis,
}

impl Cover {
    /// Over distinct places.
    ///
    /// Errors: places on one line, coordinates that are not finite, and those of [`features`] and [`Basis::of_functions`].
    pub fn of(places: Vec<Point2>) -> Result<Cover> {
        let mesh = Mesh::of(places)?;
        let knots = Knots::new(mesh.points().to_vec())?;
        let corners = mesh.hull().to_vec();
        let special = features(&knots, &Features { corners, ..Features::default() })?;
        let all = special.generate(&Rule::Delaunay, 1)?;
        let links = config::links(&special.knots, &all[1])?;
        let functions = special.functions(&links)?;
        let basis = Basis::of_functions(&special.knots, &all[1], &functions)?;
        Ok(Cover { mesh, basis })
    }
}
