//! The space of quadratic splines over the convex hull of given places. The border is pulled apart, so that
//! functions sum to one on the whole hull.

use super::mesh::Mesh;
use crate::bases::Basis;
use spmesh_base::error::Result;
use spmesh_configurations::special::{Features, Function, features};
use spmesh_configurations::{self as configurations, Configurations, Knots, Rule};
use spmesh_delaunay::predicates::Point2;

/// Places of knots with their triangulation, and the functions of degree 2 over them.
#[derive(Debug)]
pub struct SplineSpace {
    /// The triangulation of the places.
    pub mesh: Mesh,
    /// The places, and after them the copies that pull some of them apart.
    pub knots: Knots,
    /// Delaunay configurations of degree 1, except where features change them.
    pub configurations: Configurations,
    /// Functions as sums of B-splines; the B-splines of knots at one place are collected.
    pub functions: Vec<Function>,
    /// The basis that evaluates the functions.
    pub basis: Basis,
}

impl SplineSpace {
    /// The space over distinct places.
    ///
    /// # Errors
    /// Places on one line, coordinates that are not finite, and those of [`features`] and
    /// [`Basis::of_functions`].
    pub fn of(places: Vec<Point2>) -> Result<SplineSpace> {
        SplineSpace::with_features(places, Features::default())
    }

    /// The space over distinct places, with features between some of them.
    ///
    /// # Errors
    /// Those of [`SplineSpace::of`].
    pub fn with_features(places: Vec<Point2>, sharp: Features) -> Result<SplineSpace> {
        let mesh = Mesh::of(places)?;
        let places = Knots::new(mesh.points().to_vec())?;
        let corners = [sharp.corners, mesh.hull().to_vec()].concat();
        let special = features(&places, &Features { corners, ..sharp })?;
        let mut all = special.generate(&Rule::Delaunay, 1)?;
        let configurations = all.swap_remove(1);
        let links = configurations::links(&special.knots, &configurations)?;
        let functions = special.functions(&links)?;
        let basis = Basis::of_functions(&special.knots, &configurations, &functions)?;
        Ok(SplineSpace { mesh, knots: special.knots, configurations, functions, basis })
    }
}
