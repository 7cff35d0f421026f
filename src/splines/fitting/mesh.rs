//! Triangulated points: location, linear interpolation, and the quadratic splines over their hull.

use crate::bases::Basis;
use spmesh_base::error::{Error, Result};
use spmesh_configurations::special::{Features, Function, features};
use spmesh_configurations::{self as configurations, Configurations, Displacement, Knots, Rule};
use spmesh_delaunay::delaunay2::{Kernel, Triangulation};
use spmesh_delaunay::predicates::{Point2, area};

/// The Delaunay triangulation of points.
#[derive(Debug)]
pub struct Mesh {
    triangulation: Triangulation,
}

impl Mesh {
    /// Triangulates points that are not all on one line; of coincident points, the first counts.
    ///
    /// # Errors
    /// Coordinates that are not finite; no triangle.
    pub fn of(points: Vec<Point2>) -> Result<Mesh> {
        let triangulation = Triangulation::by(&mut Kernel::new(), points).map_err(Error::of_computation)?;
        if triangulation.triangles().is_empty() {
            let count = triangulation.points().len();
            let what = format!("{count} points on one line: three that are not are needed");
            return Err(Error::usage(what));
        }
        Ok(Mesh { triangulation })
    }

    /// The points, in the order given.
    pub fn points(&self) -> &[Point2] {
        self.triangulation.points()
    }

    /// Vertices of the hull, counterclockwise, including vertices on its edges.
    pub(super) fn hull(&self) -> &[u32] {
        &self.triangulation.arrays().hull
    }

    pub(super) fn triangles_len(&self) -> usize {
        self.triangulation.triangles().len()
    }

    /// The corners of a triangle, counterclockwise.
    #[inline]
    pub(super) fn vertices(&self, triangle: u32) -> [u32; 3] {
        self.triangulation.triangles()[triangle as usize].vertices
    }

    pub(super) fn corners(&self, triangle: u32) -> [Point2; 3] {
        self.vertices(triangle).map(|vertex| self.points()[vertex as usize])
    }

    pub(super) fn border_edges(&self, triangle: u32) -> impl Iterator<Item = [Point2; 2]> {
        let corners = self.corners(triangle);
        self.sides(triangle, false).map(move |ends| ends.map(|end| corners[end]))
    }

    /// The edges that a triangle shares with another one, as pairs of places among its corners.
    pub(super) fn inner_edges(&self, triangle: u32) -> impl Iterator<Item = [usize; 2]> {
        self.sides(triangle, true)
    }

    fn sides(&self, triangle: u32, is_inner: bool) -> impl Iterator<Item = [usize; 2]> {
        let triangle = &self.triangulation.triangles()[triangle as usize];
        let is_wanted = move |side: &usize| triangle.neighbour(*side).is_some() == is_inner;
        (0..3).filter(is_wanted).map(|side| [(side + 1) % 3, (side + 2) % 3])
    }

    /// A triangle that contains x, if there is one: the walk starts at `near`, and sets it to the last
    /// triangle.
    ///
    /// Cost: proportional to the number of triangles between.
    pub(super) fn locate(&self, x: Point2, near: &mut u32) -> Option<u32> {
        self.triangulation.triangle_at(x, near)
    }

    /// The value at x of the function that is linear on triangles and has these values at points; `None`
    /// outside of the hull.
    ///
    /// The search starts from the triangle `near`, at first 0, and sets it to the triangle found.
    ///
    /// # Panics
    /// If there are fewer values than points.
    pub fn interpolate(&self, values: &[f64], x: Point2, near: &mut u32) -> Option<f64> {
        let triangle = self.locate(x, near)?;
        let [a, b, c] = self.corners(triangle);
        let shares = [area(x, b, c), area(a, x, c), area(a, b, x)];
        let whole: f64 = shares.iter().sum();
        let of_vertices = self.vertices(triangle).map(|vertex| values[vertex as usize]);
        Some(shares.iter().zip(of_vertices).map(|(share, value)| share * value).sum::<f64>() / whole)
    }
}

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

    /// The space over distinct places, whose border is pulled apart as that of a linear map of them is.
    ///
    /// # Errors
    /// Those of [`SplineSpace::of`].
    pub fn displaced(places: Vec<Point2>, displacement: Displacement) -> Result<SplineSpace> {
        SplineSpace::new(places, Features::default(), displacement)
    }

    /// The space over distinct places, with features between some of them.
    ///
    /// # Errors
    /// Those of [`SplineSpace::of`].
    pub fn with_features(places: Vec<Point2>, sharp: Features) -> Result<SplineSpace> {
        SplineSpace::new(places, sharp, Displacement::default())
    }

    fn new(places: Vec<Point2>, sharp: Features, displacement: Displacement) -> Result<SplineSpace> {
        let mesh = Mesh::of(places)?;
        let places = Knots::new(mesh.points().to_vec())?.displaced(displacement);
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
